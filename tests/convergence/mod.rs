//! The error against the element size.

mod oblique_waves;
