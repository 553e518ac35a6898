//! Scenes from files and from Rust: what they accept, and what runs of them give.

mod joints;
mod keys_of_ground;
mod keys_of_model;
mod keys_of_output;
mod runs;
mod support;
mod surroundings;
