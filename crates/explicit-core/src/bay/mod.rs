//! Bays of an endless row under waves of any azimuth: what repeats with a period along y.
//!
//! A row of equal bays of the length `L` along y, under a wave of the slowness `s` along y, moves by `u = U(x, y, z, t - s y)` with a `U`
//! of the period `L`, whatever its laws. In `tau = t - s y` the strain is that of `U` with `-s V` in addition to its derivative along y,
//! and the equation of motion `d/dtau (rho V + s t_y) = div sigma`, `t_y` the stress on sections normal to y.
//!
//! # Scheme
//! Every element has nodes of its own, the *copies*, which belong to the group of their node of the mesh. A copy at the distance `o`
//! along y from the middle of its element has the displacement `U - s o V`, so that kernels and laws make the strain `-s V` themselves; and
//! the sum of `o` times the forces of the copies is `T`, the nodal sum of `t_y`. With the elastic stiffness `K` of the
//! elements the equation of linear bodies is
//!
//! `(M - s^2 A) V' + D V + K U = F`, `D_ij = s (y_i - y_j) K_ij`,
//!
//! `A` the sum of `o_i K_ij o_j` of each element, shared out as its mass is. `D` is skew: it takes no energy. It stands with the
//! mean of the velocities before and after a step, and the new velocities are those of the whole system (page of `skew`). So
//! the stable step is that of the plain leapfrog with the inertia `M - s^2 A`.
//!
//! Laws that are not linear have forces that are less than those of `K` by `r`. They are evaluated at a velocity that is extrapolated from
//! the last two, the linear part of which is taken off again, and `s d(sum of o r)/dtau` is its change in the last two steps. With that of one
//! step a motion that alternates from step to step would grow where a share `a` of the mass is `s^2 A` and `a / (1 - a)` exceeds half (`r` of all
//! of `K`, as of elements that have cracked); with that of two steps where it exceeds 1.24, for less than all of `K` never earlier. This counts no joints.
//!
//! Embedded elements, such as bolts, act on nodes of their own, which move as their node of the mesh does, without a delay: right for elements
//! across y.
//!
//! Constraints change the new velocities of their nodes after `D` has acted. What they changed in the step before stands for it there: bonds and
//! contacts of a step add to those before in the ratio of `dt/2 D` to the mass, which is below one.

mod copies;
mod ledger;
mod plan;
mod skew;
mod step;

use powerhouse_model::{MassDampingRule, Mat3, Mesh, Vec3};
use serde::{Deserialize, Serialize};

pub(crate) use copies::{Carriers, Copies};
pub(crate) use ledger::BayEnergy;
pub(crate) use plan::{BayPlan, check_bay};
use skew::Skew;

/// Motion of a bay that goes beyond displacements and velocities, by group.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct BayMotion {
    /// Velocity (m/s) one and a half steps before the present time; empty before the first step.
    before: Vec<Vec3>,
    /// Velocity (m/s) at which the last forces were found; empty before them and in linear bays.
    predicted: Vec<Vec3>,
    /// Sum of `o r` (N m) at the times of the last two forces, the later one first; likewise.
    relaxed: [Vec<Vec3>; 2],
    /// Velocity (m/s) of the groups of constraints before constraints in the last step changed it; empty before the first step.
    free: Vec<Vec3>,
    /// `D V` (N) of the last two steps, the later one first; empty before them.
    turned: [Vec<Vec3>; 2],
}

/// A bay of an endless row.
pub(crate) struct Bay {
    /// The mesh in which every element has nodes of its own.
    pub(crate) mesh: Mesh,
    /// Slowness along y (s/m).
    slowness: f64,
    /// Engine number of the first node of the mesh of each group.
    leads: Vec<u32>,
    /// Group of each engine node, and its distance along y from the middle of its element (m).
    place: Vec<(u32, f64)>,
    /// The matrix `D`.
    skew: Skew,
    /// Rule and length of step (s), and the effective mass of each group at them (kg); none before the first step.
    inertia: (Option<(MassDampingRule, f64)>, Vec<Mat3>),
    /// What each group has less of mass (kg): the largest of `s^2 A` along any axis.
    taken: Vec<f64>,
    /// Whether all elements are linear.
    is_linear: bool,
    /// Motion in the course of a run.
    pub(crate) motion: BayMotion,
    /// Force (N) of each group in the present step beside those of elements and loads; empty in linear bays.
    excess: Vec<Vec3>,
}
