//! Programs that are recorded from laws have their bits, replayed and compiled.

mod compiled;
mod laws;
mod own;
