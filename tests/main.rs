//! Whole models, and the shape of the workspace.

mod analytic;
mod architecture;
mod convergence;
mod extremes;
mod invariance;
mod oracle;
mod published;
mod regression;
