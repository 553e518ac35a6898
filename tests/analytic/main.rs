//! Whole models against closed forms.

mod column;
mod sphere;
