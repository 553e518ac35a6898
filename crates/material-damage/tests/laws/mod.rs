//! Tests of the laws of the crate at one point.

mod acoustic;
mod consistency;
mod crack_band;
mod crack_closure;
mod driver;
mod drucker_prager;
mod elastic_domain;
mod exhaustive;
mod extremes;
mod flat_damping;
mod frames;
mod hoek_brown;
mod lanes;
mod lee_fenves;
mod mazars;
mod mohr_coulomb;
mod packs;
mod plastic_damage;
mod precision;
mod principal;
mod random;
mod softening_plasticity;
mod strain_curves;
mod tangent;
mod two_surface;
