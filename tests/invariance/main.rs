//! What must not change the result.

mod bits;
mod bonded_cavern;
mod books;
mod direction;
mod joints;
mod laws;
