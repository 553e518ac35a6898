//! The powerhouse of the paper.

mod bay;
mod conclusions;
