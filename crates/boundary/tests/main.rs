//! Absorbing boundaries and the input of the free field.

mod coefficients;
mod column;
mod delayed;
mod domain_reduction;
mod input;
mod reflection;
