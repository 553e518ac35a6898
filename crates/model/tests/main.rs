//! What all crates share.

mod mesh;
