//! Joints of node pairs and their laws.

mod cohesive;
mod joint;
mod laws;
mod surface;
