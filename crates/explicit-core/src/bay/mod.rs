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
//! Laws that are not linear have forces that are less than those of `K` by `r`. With the strains `e` half way between two steps, of the displacements
//! there and the velocities of that step, and `r` before and after the present time,
//!
//! `(M - s^2 A) (V+ - V-) / dt + D (V- + V+) / 2 + K U = F + (r- + r+) / 2 + s (sum of o r+ - sum of o r-) / dt`.
//!
//! So laws are evaluated once per step, half way through it, and what `r` does to the motion in a step is `(r- + r+).(e+ - e-) / 2` and the change of
//! `s V.(sum of o r)`: elements whose stiffness is another one than that of `K`, as those that have cracked, keep their energy as those of
//! `K` do, at the same stable step. (With `r` at an extrapolated velocity, and its change in the steps before, motions of the mesh grow by 1 to 30 % per step where some
//! of the elements along y have lost a half of their stiffness or more, and by 1 % where they are 10 % stiffer than `K`.)
//!
//! `r+` depends on the new velocities, and so do the impulses of constraints, which `D` turns as all others. Both are solved together: with the velocities
//! that follow from a guess of them, laws are evaluated and constraints correct the step, from the same state, until guess and answer agree (page of
//! `settle`). The guess goes on as the last two steps did. (With the changes by constraints of the step before in their place a bond
//! between unequal bodies feeds motions of the mesh, at any speed of the motion along y: by 1 % in a step where it has a fifth of that of P waves, by
//! 7 % at 0.7.)
//!
//! Embedded elements, such as bolts, act on nodes of their own, which move as their node of the mesh does, without a delay: right for elements
//! across y.

mod copies;
mod ledger;
mod mixing;
mod plan;
mod settle;
mod skew;
mod step;

use powerhouse_model::{ForceTerms, MassDampingRule, Mat3, Mesh, UnsolvedSteps, Vec3};
use serde::{Deserialize, Serialize};

pub(crate) use copies::{Carriers, Copies};
pub(crate) use ledger::BayEnergy;
use mixing::Mixing;
pub(crate) use plan::{BayPlan, check_bay, check_constraints};
use skew::Skew;

/// Motion of a bay that goes beyond displacements and velocities, by group.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct BayMotion {
    /// Velocity (m/s) one and a half steps before the present time; empty before the first step.
    before: Vec<Vec3>,
    /// What the forces of laws lack of those of the stiffness (N), and the sum of that times the offsets (N m), half way through the last two steps
    /// that have been evaluated, the later one first; empty before them and in linear bays.
    lacking: [Vec<[Vec3; 2]>; 2],
    /// What laws and constraints changed of velocities (m/s) in the last two steps, in the order of the guess; the later one first.
    settled: [Vec<Vec3>; 2],
    /// Length of the last step (s), for which these are.
    step: f64,
    /// `D V` (N) of the last two steps, the later one first; empty before them.
    turned: [Vec<Vec3>; 2],
    /// Steps whose laws and constraints were not solved.
    pub(crate) unsolved: Option<UnsolvedSteps>,
}

/// Solution of a step. Velocities are in m/s.
#[derive(Default)]
struct Solution {
    /// Sum of the velocities of each group before and after the step, as it would be without the skew matrix, constraints, and what laws lack of the
    /// linear forces at the end of the step.
    given: Vec<Vec3>,
    /// Sum as it is if constraints change what is guessed.
    sum: Vec<Vec3>,
    /// Velocities after the step before constraints change them, of the groups that have some.
    free: Vec<Vec3>,
    /// What is known of the velocities that the impulses of laws in the second half of the step make, by group (none in linear bays), and of the changes by
    /// constraints.
    guess: Vec<Vec3>,
    mixing: Mixing,
    best: Best,
    /// What the forces of laws lack of those of the stiffness half a step after the present time, with its moment.
    lacking: Vec<[Vec3; 2]>,
    /// Displacement (m) at which laws have been evaluated, by engine node, and the velocity with which it has changed in the step.
    placed: Vec<Vec3>,
    rates: Vec<Vec3>,
}

/// The guess of a step that differs least from its answer.
struct Best {
    guess: Vec<Vec3>,
    /// Difference of the answer from it, and its size over that of the motion (1).
    left: Vec<Vec3>,
    size: f64,
    /// Share of the difference that the last guess that began here has taken.
    share: f64,
    /// Number of guesses since.
    age: usize,
}

impl Default for Best {
    fn default() -> Self {
        Self {
            guess: Vec::new(),
            left: Vec::new(),
            size: f64::INFINITY,
            share: 1.0,
            age: 0,
        }
    }
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
    /// Solution of the present step.
    solution: Solution,
    /// Terms of the forces of the present step.
    terms: ForceTerms,
}
