//! Whole models against closed forms.

mod column;
mod damping;
mod equilibrium;
mod joints;
mod sphere;
mod tractions;
mod water_wall;
