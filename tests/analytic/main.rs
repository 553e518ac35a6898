//! Whole models against closed forms.

mod column;
mod damping;
mod joints;
mod sphere;
