//! The command `powerhouse`.
fn main() {}
