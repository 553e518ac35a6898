//! Observers.

mod observe;
mod roughness;
