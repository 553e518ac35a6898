//! What must not change the result.

mod bits;
mod direction;
mod joints;
