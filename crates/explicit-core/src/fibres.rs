//! Fibres: groups of nodes whose motion relative to each other has added inertia (selective mass scaling).
//!
//! # Velocity update
//! A fibre of groups with masses `m_i`, the sum `s` and the added inertia `a` has in each direction the inertia
//! `diag((1 + a) m) - (a / s) m m^T`: what its groups have by themselves, and a product of two vectors. Each group is
//! updated by itself first, with the inertia `(1 + a) m_i` and whatever it has of dashpots, springs and supports, from
//! `v-` to `v*`; its response to an impulse is `P_i`. The product is then made good (Woodbury 1950):
//!
//! `v+_i = v*_i + (a / s) m_i P_i q`, `q = W^-1 sum_j m_j (v*_j - v-_j)`, `W = I - (a / s) sum_j m_j^2 P_j`.
//!
//! Without dashpots and supports this is `dv_i <- mean + (dv_i - mean) / (1 + a)` of the changes of velocity without
//! added inertia, with their mean by mass. A velocity that is prescribed is part of `v*`.
//!
//! # Constraints
//! One group of a fibre may be a node of a constraint. Its response to an impulse of the constraint is
//! `P + (a / s) m^2 P W^-1 P`; the others follow what the constraint has changed.

use core::ops::Range;

use powerhouse_model::{Checksum, Mat3, Vec3};
use rayon::prelude::*;

use crate::groups::{Coefficients, NodeGroup};

/// Groups per parallel task.
const TASK: usize = 1024;
/// Eigenvalue of the common motion of a fibre below which supports hold all of it.
const HELD: f64 = 1e-12;

/// A fibre of groups.
#[derive(Clone, Debug)]
struct GroupFibre {
    /// Its groups among the members of all fibres; one of a constraint is the first.
    members: Range<usize>,
    /// Added inertia over mass (1).
    added: f64,
    /// Mass (kg).
    mass: f64,
}

/// A group of a fibre.
#[derive(Clone, Copy, Debug)]
struct Member {
    group: u32,
    fibre: u32,
    /// Mass (kg).
    mass: f64,
    /// `(a / s) m P` (1/kg).
    gain: Mat3,
}

/// Matrices of a fibre for a length of step.
#[derive(Clone, Copy, Debug)]
struct FibreMatrices {
    /// `W^-1`.
    inner: Mat3,
    /// `q` per change of velocity that a constraint makes at the first group (kg).
    of_constraint: Mat3,
    /// Response of the first group to an impulse of a constraint (1/kg).
    response: Mat3,
}

/// All fibres of a model.
#[derive(Debug, Default)]
pub(crate) struct Fibres {
    all: Vec<GroupFibre>,
    /// Fibres with a node of a constraint.
    constrained: Vec<u32>,
    /// The groups of all fibres, fibre by fibre.
    members: Vec<Member>,
    /// Indices of the members in rising order of their groups.
    order: Vec<u32>,
    matrices: Vec<FibreMatrices>,
    /// `q` of the present step, by fibre (N s).
    pulls: Vec<Vec3>,
    /// Velocity (m/s) of the first group before constraints, of the fibres of `constrained`.
    predicted: Vec<Vec3>,
}

impl Fibres {
    /// From the groups of each fibre, in rising order, with its added inertia over mass (1); the first `constrained`
    /// groups are nodes of constraints.
    pub(crate) fn new(
        fibres: &[(Vec<u32>, f64)],
        groups: &[NodeGroup],
        constrained: usize,
    ) -> Self {
        let mut found = Self::default();
        for (index, (own, added)) in (0..).zip(fibres) {
            let start = found.members.len();
            found.members.extend(own.iter().map(|&group| Member {
                group,
                fibre: index,
                mass: groups[group as usize].mass,
                gain: Mat3::zeros(),
            }));
            found.all.push(GroupFibre {
                members: start..found.members.len(),
                added: *added,
                mass: found.members[start..]
                    .iter()
                    .map(|member| member.mass)
                    .sum(),
            });
            if (own[0] as usize) < constrained {
                found.constrained.push(index);
            }
        }
        found.order = (0..found.members.len() as u32).collect();
        let members = &found.members;
        (found.order).sort_unstable_by_key(|&index| members[index as usize].group);
        found.pulls = vec![Vec3::zeros(); found.all.len()];
        found.predicted = vec![Vec3::zeros(); found.constrained.len()];
        found
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// A checksum of the groups of all fibres and of their added inertia.
    pub(crate) fn fingerprint(&self) -> u64 {
        let mut sum = Checksum::default();
        for fibre in &self.all {
            sum.add_number(fibre.members.len() as u64);
            sum.add_number(fibre.added.to_bits());
        }
        for member in &self.members {
            sum.add_number(member.group.into());
        }
        sum.value()
    }

    /// Computes the matrices from those of the groups.
    pub(crate) fn prepare(&mut self, coefficients: &[Coefficients]) {
        for member in &mut self.members {
            let GroupFibre { added, mass, .. } = self.all[member.fibre as usize];
            member.gain =
                coefficients[member.group as usize].inverse * (added / mass * member.mass);
        }
        let members = &self.members;
        let of = |fibre: &GroupFibre| {
            let own = &members[fibre.members.clone()];
            let kept = own.iter().fold(Mat3::identity(), |kept, member| {
                kept - member.gain * member.mass
            });
            let inner = inverse(&kept);
            let first = &own[0];
            let around = first.gain * inner * first.mass;
            let follows = inverse(&(Mat3::identity() + around));
            let alone = coefficients[first.group as usize].inverse;
            FibreMatrices {
                inner,
                of_constraint: inner * follows * first.mass,
                response: alone + around * alone,
            }
        };
        self.matrices = self.all.par_iter().map(of).collect();
    }

    fn member(&self, group: usize) -> Option<&Member> {
        let key = |index: &u32| self.members[*index as usize].group as usize;
        let place = self.order.binary_search_by_key(&group, key).ok()?;
        Some(&self.members[self.order[place] as usize])
    }

    /// Response (1/kg) of a node of a constraint to its impulse; none for a group without a fibre.
    pub(crate) fn response(&self, group: usize) -> Option<Mat3> {
        let member = self.member(group)?;
        Some(self.matrices[member.fibre as usize].response)
    }

    /// Couples the new velocities (m/s) of the groups, which each has by itself, given those before.
    pub(crate) fn couple(&mut self, previous: &[Vec3], next: &mut [Vec3]) {
        if self.all.is_empty() {
            return;
        }
        let (members, order) = (&self.members, &self.order);
        let new = &*next;
        (self.pulls.par_iter_mut().zip(&self.all).zip(&self.matrices))
            .with_min_len(64)
            .for_each(|((pull, fibre), matrices)| {
                let changed = members[fibre.members.clone()].iter().map(|member| {
                    let g = member.group as usize;
                    (new[g] - previous[g]) * member.mass
                });
                *pull = matrices.inner * changed.sum::<Vec3>();
            });
        let pulls = &self.pulls;
        let place = |group: usize| {
            order.partition_point(|&index| (members[index as usize].group as usize) < group)
        };
        (next.par_chunks_mut(TASK).enumerate()).for_each(|(task, next)| {
            let start = task * TASK;
            for &index in &order[place(start)..place(start + next.len())] {
                let member = &members[index as usize];
                next[member.group as usize - start] += member.gain * pulls[member.fibre as usize];
            }
        });
        for (predicted, &fibre) in self.predicted.iter_mut().zip(&self.constrained) {
            let first = self.all[fibre as usize].members.start;
            *predicted = next[members[first].group as usize];
        }
    }

    /// Lets the other groups of fibres follow what constraints have changed in new velocities (m/s).
    pub(crate) fn follow(&self, next: &mut [Vec3]) {
        for (predicted, &fibre) in self.predicted.iter().zip(&self.constrained) {
            let own = &self.members[self.all[fibre as usize].members.clone()];
            let change = next[own[0].group as usize] - predicted;
            if change != Vec3::zeros() {
                let pull = self.matrices[fibre as usize].of_constraint * change;
                for member in &own[1..] {
                    next[member.group as usize] += member.gain * pull;
                }
            }
        }
    }

    /// Impulse (N s) that a constraint needs for a change of the velocity (m/s) of a node beyond that of its group by
    /// itself, because the other groups of the fibre follow; zero without a fibre.
    pub(crate) fn of_constraint(&self, group: usize, change: &Vec3) -> Vec3 {
        self.member(group).map_or_else(Vec3::zeros, |member| {
            let pull = self.matrices[member.fibre as usize].of_constraint * change;
            self.beyond(member, pull)
        })
    }

    /// Impulse (N s) of the inertia of a group between two velocities (m/s) of all groups, beyond that of the group by
    /// itself; zero without a fibre.
    pub(crate) fn of_inertia(&self, group: usize, previous: &[Vec3], next: &[Vec3]) -> Vec3 {
        self.member(group).map_or_else(Vec3::zeros, |member| {
            let own = &self.members[self.all[member.fibre as usize].members.clone()];
            let changed = own.iter().map(|other| {
                let g = other.group as usize;
                (next[g] - previous[g]) * other.mass
            });
            self.beyond(member, changed.sum())
        })
    }

    /// The impulse (N s) of a member in the product of vectors, for a change of the momentum of its fibre (N s).
    fn beyond(&self, member: &Member, changed: Vec3) -> Vec3 {
        let GroupFibre { added, mass, .. } = self.all[member.fibre as usize];
        changed * (-added / mass * member.mass)
    }

    /// Kinetic energy of the added inertia of every fibre (J), `1/2 v- . M v+`, and `1/8 (v+ - v-) . M (v+ - v-)`; and
    /// that of its mass at the mean velocity.
    pub(crate) fn kinetic(&self, previous: &[Vec3], next: &[Vec3]) -> Vec<[f64; 3]> {
        let of = |fibre: &GroupFibre| {
            let own = &self.members[fibre.members.clone()];
            let mean = |velocity: &[Vec3]| {
                let momenta = own.iter().map(|m| velocity[m.group as usize] * m.mass);
                momenta.sum::<Vec3>() / fibre.mass
            };
            let (mean_before, mean_after) = (mean(previous), mean(next));
            let (mut across, mut squares, mut of_mass) = (0.0, 0.0, 0.0);
            for member in own {
                let g = member.group as usize;
                of_mass += 0.125 * member.mass * (previous[g] + next[g]).norm_squared();
                let (before, after) = (previous[g] - mean_before, next[g] - mean_after);
                across += member.mass * before.dot(&after);
                squares += member.mass * (after - before).norm_squared();
            }
            let of_added = [0.5 * across, 0.125 * squares].map(|energy| fibre.added * energy);
            [of_added[0], of_added[1], of_mass]
        };
        self.all.par_iter().map(of).collect()
    }

    /// Multiplies a vector of the leads of groups, in their free directions, by the root of the inverse of the inertia
    /// that fibres have with unit masses, `(1 + a) I - a u u^T` with `u_i^2 = m_i / s`: with the inverse roots of the
    /// masses on both sides its square is the inverse inertia of the model.
    pub(crate) fn apply_inverse_root(&self, groups: &[NodeGroup], vector: &mut [Vec3]) {
        for fibre in &self.all {
            let own = self.members[fibre.members.clone()].iter().map(|member| {
                let root = (member.mass / fibre.mass).sqrt();
                (&groups[member.group as usize], root)
            });
            // The product of `u` with itself in the free directions: one along those that are free everywhere.
            let (mut common, mut sum) = (Mat3::zeros(), Vec3::zeros());
            for (group, root) in own.clone() {
                common += group.condition.project(&Mat3::identity()).0 * (root * root);
                sum += vector[group.members[0] as usize] * root;
            }
            let alone = 1.0 / (1.0 + fibre.added).sqrt();
            let eigen = common.symmetric_eigen();
            let mut shared = Vec3::zeros();
            for (&value, axis) in eigen
                .eigenvalues
                .iter()
                .zip(eigen.eigenvectors.column_iter())
            {
                if value > HELD {
                    let together = 1.0 / (1.0 + fibre.added * (1.0 - value)).sqrt();
                    shared += axis * (axis.dot(&sum) * (together - alone) / value);
                }
            }
            for (group, root) in own {
                let lead = &mut vector[group.members[0] as usize];
                *lead = *lead * alone + group.condition.free(shared * root);
            }
        }
    }
}

/// Inverse of a matrix whose eigenvalues are positive.
fn inverse(matrix: &Mat3) -> Mat3 {
    matrix.try_inverse().unwrap_or_else(Mat3::identity)
}
