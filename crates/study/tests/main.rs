//! Checks, sweeps, trade studies and predictions of whole scenes.

mod advice;
mod block;
mod check_warnings;
mod convergence;
mod costs;
mod fields;
mod grown;
mod joints;
mod layers;
mod meshes;
mod promises;
mod registered;
mod studies;
mod summaries;
mod sweep;
mod trade;
