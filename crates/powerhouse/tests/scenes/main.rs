//! Scenes from files and from Rust: what they accept, and what runs of them give.

mod runs;
mod support;
mod surroundings;
