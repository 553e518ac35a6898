//! Slices under waves of any azimuth: all nodes are in delayed pairs.
//!
//! A body that does not change along y, under a wave of the slowness `s` along y, moves by `u = U(x, z, t - s y)`, whatever
//! its laws. In `tau = t - s y` its equation of motion is `d/dtau (rho V + s t_y) = div sigma`, `t_y` the stress
//! `(s_xy, s_yy, s_yz)` on sections normal to y and `sigma` that of the strain of `U` with `-s V` as its derivative along
//! y. The momentum `P = M V + s T`, `T` the nodal sums of `t_y`, is the primary unknown.
//!
//! # Scheme
//! `T` depends on the velocity, and couples x and z with y alone. y is therefore half a step later than x and z: at the time
//! `n` of a step `u_x, u_z` and `v_y` are known, half a step before it `v_x, v_z` and half a step after it `u_y`.
//! 1. At `n` the forces give `P_x, P_z` half a step later. `T_x, T_z` there follow from those at `n`, which have the
//!    velocity before the step, and those before: `2 T - T_before` has the gradient of `u_y` at the right time, and
//!    `s A (v_before - v)` is the change by the velocity, `A` the sum of `T` per velocity.
//! 2. Half a step later the forces give `P_y` at `n + 1` alike.
//!
//! A slice all of whose elements are linear takes one evaluation in a step, with the products of a matrix in place of `T`
//! (page of `coupling`): the same scheme, to rounding.
//!
//! Every part is a central difference. Linear bodies have their stable step at `2 / w`, `w` the highest frequency of the
//! gyroscopic operator, which the page of `spectrum` derives, and conserve an energy to rounding (page of `ledger`).
//!
//! # Why so
//! *The sides of the slice have the displacements `U +- (s h / 2) V`*, so that element kernels and laws make the strain `-s V`
//! along y themselves; forces of both sides add up to those of the section, and `h / 2` times their difference is `T`.
//!
//! *`T` is lumped as the mass is.* Its part that depends on velocities is a consistent matrix; with a lumped mass the
//! scheme would become unstable from `s c_p` of about 0.73 on. The matrices of the elements give its exact rows.

mod coupling;
mod ledger;
mod linear;
mod lumping;
mod motion;
mod plan;
mod spectrum;
mod step;
mod stiff;

pub(crate) use coupling::Coupling;
pub(crate) use ledger::{DelayedWork, Works};
pub(crate) use lumping::Lumping;
pub(crate) use motion::{DelayedMotion, Part};
pub(crate) use plan::{Axes, check_delayed, pair_up, pairs_of_nodes, slowest};

/// A slice whose sides are delayed against each other: its pairs, by group, and its motion.
pub(crate) struct DelayedSlice {
    /// Slowness along y (s/m).
    pub(crate) slowness: f64,
    /// Half the distance of the sides (m).
    pub(crate) half: f64,
    /// Nodes of each group, that of the smaller y first.
    pub(crate) sides: Vec<[u32; 2]>,
    /// Group of each node, and the sign with which its displacement has `s h / 2 V`.
    pub(crate) place: Vec<(u32, f64)>,
    /// Mass of each group (kg).
    pub(crate) mass: Vec<f64>,
    /// Whether each group has neither dashpot, spring, skew coupling nor mass damping.
    pub(crate) bare: Vec<bool>,
    /// Whether each group is bare and has no load; empty before the first step.
    pub(crate) free: Vec<bool>,
    /// The others.
    pub(crate) loaded: Vec<u32>,
    /// Fixed axes of each group.
    pub(crate) held: Vec<Axes>,
    /// What makes `T` a lumped quantity.
    pub(crate) lumping: Lumping,
    /// Elastic matrices between pairs.
    pub(crate) coupling: Coupling,
    /// Whether all elements are linear, so that the matrices stand for `T`.
    pub(crate) is_linear: bool,
    /// Whether readers see the motion between the new velocities of x and z and the new displacements.
    pub(crate) is_centred: bool,
    /// Motion in the course of a run; none before its first step.
    pub(crate) motion: Option<DelayedMotion>,
    /// Works of nodal forces of the present step and of all steps.
    pub(crate) work: DelayedWork,
}
