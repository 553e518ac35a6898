//! Whole models against closed forms.

mod column;
mod joints;
mod sphere;
