//! Observers.

mod observe;
