//! What all crates share.

mod mesh;
mod sockets;
