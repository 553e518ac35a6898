//! The laws, at one point, and the programs recorded from them.

mod law_programs;
mod laws;
// Its `main` is called where it is a program.
#[allow(dead_code)]
#[path = "../examples/one_element.rs"]
mod one_element;
