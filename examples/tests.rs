//! The tests of the examples, each of which is a module here and a program of its own.

// What only its `main` calls.
#![allow(dead_code)]

mod absorbing_box;
mod bar_impact;
mod boundary_advice;
mod boundary_price;
mod cavern;
mod cavity_scattering;
mod concrete_cycle;
mod cost_model;
mod domain_reduction;
mod free_field;
mod joint_slip;
mod own_boundary;
mod own_law;
mod own_loop;
mod plane_slice;
mod scene_classes;
mod spherical_cavity;
mod staged_tunnel;
mod verification;
mod wang_2019;
