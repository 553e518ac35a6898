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
//! added inertia, with their mean by mass. A velocity that is prescribed is part of `v*`. Where all `P_i` are diagonal, as
//! they are but for oblique dashpots and supports, each direction is computed by itself.
//!
//! # Constraints
//! Groups of a fibre may be nodes of one constraint. The response of node `i` to an impulse of the constraint at node `j` is
//! `P_i` where they are one, plus `(a / s) m_i P_i W^-1 m_j P_j`; the other groups follow: for changes `dv_j` of the nodes
//! of the constraint `q = (I - (a / s) sum_k m_k^2 P_k)^-1 sum_j m_j dv_j`, with the sum over the other groups `k`.

use core::ops::Range;

use powerhouse_model::{Checksum, Mat3, NodeCoupling, Vec3};
use rayon::prelude::*;

use crate::inverse_root::InverseRoots;
use crate::node_group::{Coefficients, NodeGroup};

/// Groups and fibres per parallel task.
const TASK: usize = 1024;
const FIBRES_PER_TASK: usize = 256;
/// No member.
const NONE: u32 = u32::MAX;
/// Eigenvalue of the common motion of a fibre below which supports hold all of it.
const HELD: f64 = 1e-12;

/// Linear map of velocities or impulses: a matrix, or the diagonal of one.
trait Map: Copy + core::fmt::Debug + Send + Sync {
    /// A symmetric matrix times a number.
    fn scaled(matrix: &Mat3, factor: f64) -> Self;
    fn times(&self, other: &Self) -> Self;
    fn apply(&self, vector: &Vec3) -> Vec3;
    /// Inverse of what is left of the identity, `I - sum`; its eigenvalues are positive.
    fn inverse_of_remainder(parts: impl Iterator<Item = Self>) -> Self;
    fn matrix(&self) -> Mat3;
}

impl Map for Vec3 {
    fn scaled(matrix: &Mat3, factor: f64) -> Self {
        matrix.diagonal() * factor
    }
    fn times(&self, other: &Self) -> Self {
        self.component_mul(other)
    }
    #[inline(always)]
    fn apply(&self, vector: &Vec3) -> Vec3 {
        self.component_mul(vector)
    }
    fn inverse_of_remainder(parts: impl Iterator<Item = Self>) -> Self {
        let rest = parts.fold(Self::repeat(1.0), |rest, part| rest - part);
        rest.map(|rest| 1.0 / rest)
    }
    fn matrix(&self) -> Mat3 {
        Mat3::from_diagonal(self)
    }
}

impl Map for Mat3 {
    fn scaled(matrix: &Mat3, factor: f64) -> Self {
        matrix * factor
    }
    fn times(&self, other: &Self) -> Self {
        self * other
    }
    fn apply(&self, vector: &Vec3) -> Vec3 {
        self * vector
    }
    fn inverse_of_remainder(parts: impl Iterator<Item = Self>) -> Self {
        let rest = parts.fold(Self::identity(), |rest, part| rest - part);
        rest.try_inverse().unwrap_or_else(Self::identity)
    }
    fn matrix(&self) -> Mat3 {
        *self
    }
}

/// A fibre of groups.
#[derive(Clone, Debug)]
struct GroupFibre {
    /// Its groups among the members of all fibres, those of a constraint first.
    members: Range<usize>,
    /// Those of a constraint.
    bound: Range<usize>,
    /// Added inertia over mass (1).
    added: f64,
    /// Mass (kg).
    mass: f64,
}

/// A group of a fibre.
#[derive(Clone, Copy, Debug)]
struct Member<M> {
    group: u32,
    fibre: u32,
    /// Mass (kg).
    mass: f64,
    /// `(a / s) m P` (1/kg).
    gain: M,
}

/// Maps of a fibre for a length of step.
#[derive(Clone, Copy, Debug)]
struct FibreMaps<M> {
    /// `W^-1`.
    inner: M,
    /// `(I - (a / s) sum_k m_k^2 P_k)^-1` over the groups that are not of a constraint.
    outer: M,
}

/// Fibres with one kind of maps.
#[derive(Debug)]
struct FibreSet<M> {
    all: Vec<GroupFibre>,
    /// Fibres with nodes of constraints, in the order of these.
    constrained: Vec<u32>,
    /// The groups of all fibres, fibre by fibre.
    members: Vec<Member<M>>,
    /// Indices of the members in rising order of their groups.
    order: Vec<u32>,
    /// Index of the member that each node of constraints is; [`NONE`] where it is none.
    member_of: Vec<u32>,
    maps: Vec<FibreMaps<M>>,
    /// `q` of the present step, by fibre (N s): first of the predicted velocities, then of what constraints have changed.
    pulls: Vec<Vec3>,
    /// Velocity (m/s) before constraints, of the nodes of constraints in the order of `constrained`.
    predicted: Vec<Vec3>,
}

impl<M> Default for FibreSet<M> {
    fn default() -> Self {
        Self {
            all: Vec::new(),
            constrained: Vec::new(),
            members: Vec::new(),
            order: Vec::new(),
            member_of: Vec::new(),
            maps: Vec::new(),
            pulls: Vec::new(),
            predicted: Vec::new(),
        }
    }
}

/// All fibres of a model.
#[derive(Debug, Default)]
pub(crate) struct Fibres {
    /// Those all of whose groups have diagonal matrices.
    diagonal: FibreSet<Vec3>,
    full: FibreSet<Mat3>,
}

/// Evaluates an expression on both sets of fibres.
macro_rules! on_both {
    ($fibres:expr, $set:ident => $body:expr) => {{
        {
            let $set = &mut $fibres.diagonal;
            $body;
        }
        let $set = &mut $fibres.full;
        $body;
    }};
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
        for (own, added) in fibres {
            let of_group = |group: &u32| &groups[*group as usize];
            if own.iter().all(|group| of_group(group).is_diagonal()) {
                found.diagonal.push(own, *added, groups, constrained)
            } else {
                found.full.push(own, *added, groups, constrained)
            }
        }
        on_both!(found, set => set.finish(constrained));
        found
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.diagonal.all.is_empty() && self.full.all.is_empty()
    }

    /// A checksum of the groups of all fibres and of their added inertia.
    pub(crate) fn fingerprint(&self) -> u64 {
        let mut sum = Checksum::default();
        self.diagonal.add_to(&mut sum);
        self.full.add_to(&mut sum);
        sum.value()
    }

    /// Computes the maps from the matrices of the groups.
    pub(crate) fn prepare(&mut self, coefficients: &[Coefficients]) {
        on_both!(self, set => set.prepare(coefficients));
    }

    /// What an impulse at a node of a constraint adds to its own velocity, beyond the response of its group by itself
    /// (1/kg); zero without a fibre.
    pub(crate) fn response(&self, group: usize, coefficients: &[Coefficients]) -> Mat3 {
        let diagonal = self.diagonal.response(group, coefficients);
        let found = diagonal.or_else(|| self.full.response(group, coefficients));
        found.unwrap_or_else(Mat3::zeros)
    }

    /// Couplings of the nodes of a constraint, whose groups these are.
    pub(crate) fn couplings(
        &self,
        own: &Range<usize>,
        coefficients: &[Coefficients],
    ) -> Vec<NodeCoupling> {
        let mut found = self.diagonal.couplings(own, coefficients);
        found.extend(self.full.couplings(own, coefficients));
        found
    }

    /// Couples the new velocities (m/s) of the groups, which each has by itself, given those before.
    pub(crate) fn couple(&mut self, previous: &[Vec3], next: &mut [Vec3]) {
        on_both!(self, set => set.couple(previous, next));
    }

    /// Lets the other groups of fibres follow what a constraint, whose groups these are, has changed in new velocities
    /// (m/s).
    pub(crate) fn follow(&mut self, own: &Range<usize>, next: &mut [Vec3]) {
        on_both!(self, set => set.follow(own, next));
    }

    /// Impulse (N s) of a constraint at one of its nodes beyond that on its group by itself, after the others have
    /// [followed](Self::follow); zero without a fibre.
    pub(crate) fn of_constraint(&self, group: usize) -> Vec3 {
        let diagonal = self.diagonal.of_constraint(group);
        let found = diagonal.or_else(|| self.full.of_constraint(group));
        found.unwrap_or_else(Vec3::zeros)
    }

    /// Impulse (N s) of the inertia of a group between two velocities (m/s) of all groups, beyond that of the group by
    /// itself; zero without a fibre.
    pub(crate) fn of_inertia(&self, group: usize, previous: &[Vec3], next: &[Vec3]) -> Vec3 {
        let diagonal = self.diagonal.of_inertia(group, previous, next);
        let found = diagonal.or_else(|| self.full.of_inertia(group, previous, next));
        found.unwrap_or_else(Vec3::zeros)
    }

    /// Kinetic energy of the added inertia of every fibre (J), `1/2 v- . M v+`, and `1/8 (v+ - v-) . M (v+ - v-)`; and
    /// that of its mass at the mean velocity.
    pub(crate) fn kinetic(&self, previous: &[Vec3], next: &[Vec3]) -> Vec<[f64; 3]> {
        let mut all = self.diagonal.kinetic(previous, next);
        all.extend(self.full.kinetic(previous, next));
        all
    }

    /// Multiplies a vector of the leads of groups, in their free directions, by the root of the inverse of the inertia
    /// that fibres have with unit masses, `(1 + a) I - a u u^T` with `u_i^2 = m_i / s`: with the inverse roots of the
    /// masses on both sides its square is the inverse inertia of the model. Of fibres with an added mass see
    /// [`directed_inverse_root`].
    pub(crate) fn apply_inverse_root(
        &self,
        groups: &[NodeGroup],
        roots: &InverseRoots,
        vector: &mut [Vec3],
    ) {
        self.diagonal.apply_inverse_root(groups, roots, vector);
        self.full.apply_inverse_root(groups, roots, vector);
    }

    /// The groups of fibres of which one has an added mass that differs by direction.
    pub(crate) fn groups_beside_directed(&self, groups: &[NodeGroup]) -> Vec<u32> {
        let mut found = self.diagonal.groups_beside_directed(groups);
        found.extend(self.full.groups_beside_directed(groups));
        found
    }
}

impl<M: Map> FibreSet<M> {
    fn push(&mut self, own: &[u32], added: f64, groups: &[NodeGroup], constrained: usize) {
        let (start, index) = (self.members.len(), self.all.len() as u32);
        self.members.extend(own.iter().map(|&group| Member {
            group,
            fibre: index,
            mass: groups[group as usize].mass,
            gain: M::scaled(&Mat3::zeros(), 0.0),
        }));
        let bound = own.partition_point(|&group| (group as usize) < constrained);
        let masses = self.members[start..].iter().map(|member| member.mass);
        self.all.push(GroupFibre {
            members: start..self.members.len(),
            bound: start..start + bound,
            added,
            mass: masses.sum(),
        });
        if bound > 0 {
            self.constrained.push(index);
        }
    }

    fn finish(&mut self, constrained: usize) {
        let members = &self.members;
        self.order = (0..members.len() as u32).collect();
        (self.order).sort_unstable_by_key(|&index| members[index as usize].group);
        self.member_of = vec![NONE; constrained];
        for (index, member) in (0..).zip(members) {
            if let Some(own) = self.member_of.get_mut(member.group as usize) {
                *own = index;
            }
        }
        let all = &self.all;
        let first = |fibre: &u32| members[all[*fibre as usize].members.start].group;
        self.constrained.sort_unstable_by_key(first);
        let bound = (self.constrained.iter()).map(|&fibre| all[fibre as usize].bound.len());
        self.predicted = vec![Vec3::zeros(); bound.sum()];
        self.pulls = vec![Vec3::zeros(); all.len()];
    }

    fn add_to(&self, sum: &mut Checksum) {
        for fibre in &self.all {
            sum.add_number(fibre.members.len() as u64);
            sum.add_number(fibre.added.to_bits());
        }
        for member in &self.members {
            sum.add_number(member.group.into());
        }
    }

    fn prepare(&mut self, coefficients: &[Coefficients]) {
        for member in &mut self.members {
            let GroupFibre { added, mass, .. } = self.all[member.fibre as usize];
            let response = &coefficients[member.group as usize].inverse;
            member.gain = M::scaled(response, added / mass * member.mass);
        }
        let members = &self.members;
        let inverse_without = |own: Range<usize>| {
            let own = members[own].iter();
            M::inverse_of_remainder(own.map(|member| {
                member
                    .gain
                    .times(&M::scaled(&Mat3::identity(), member.mass))
            }))
        };
        let of = |fibre: &GroupFibre| FibreMaps {
            inner: inverse_without(fibre.members.clone()),
            outer: inverse_without(fibre.bound.end..fibre.members.end),
        };
        self.maps = self.all.par_iter().map(of).collect();
    }

    fn member(&self, group: usize) -> Option<&Member<M>> {
        if let Some(&index) = self.member_of.get(group) {
            return self.members.get(index as usize);
        }
        let key = |index: &u32| self.members[*index as usize].group as usize;
        let place = self.order.binary_search_by_key(&group, key).ok()?;
        Some(&self.members[self.order[place] as usize])
    }

    fn response(&self, group: usize, coefficients: &[Coefficients]) -> Option<Mat3> {
        let member = self.member(group)?;
        Some(self.between(member, member, coefficients))
    }

    /// Velocity of a member per impulse on one of its fibre, both of a constraint, beyond that of the group by itself
    /// (1/kg).
    fn between(
        &self,
        first: &Member<M>,
        second: &Member<M>,
        coefficients: &[Coefficients],
    ) -> Mat3 {
        let maps = &self.maps[first.fibre as usize];
        let of_second = coefficients[second.group as usize].inverse * second.mass;
        first.gain.times(&maps.inner).matrix() * of_second
    }

    fn couplings(&self, own: &Range<usize>, coefficients: &[Coefficients]) -> Vec<NodeCoupling> {
        let mut found = Vec::new();
        for fibre in self.constrained_of(own) {
            let bound = &self.members[self.all[fibre as usize].bound.clone()];
            for (i, first) in bound.iter().enumerate() {
                for second in &bound[i + 1..] {
                    found.push(NodeCoupling {
                        nodes: [first, second].map(|member| member.group - own.start as u32),
                        response: self.between(first, second, coefficients),
                    });
                }
            }
        }
        found
    }

    /// Fibres with nodes of a constraint, whose groups these are.
    fn constrained_of(&self, own: &Range<usize>) -> impl Iterator<Item = u32> {
        let first =
            |fibre: &u32| self.members[self.all[*fibre as usize].members.start].group as usize;
        let all = self.constrained.iter().copied();
        let own = own.clone();
        all.filter(move |fibre| own.contains(&first(fibre)))
    }

    fn couple(&mut self, previous: &[Vec3], next: &mut [Vec3]) {
        if self.all.is_empty() {
            return;
        }
        let (members, order) = (&self.members, &self.order);
        let new = &*next;
        (self.pulls.par_iter_mut().zip(&self.all).zip(&self.maps))
            .with_min_len(FIBRES_PER_TASK)
            .for_each(|((pull, fibre), maps)| {
                let mut changed = Vec3::zeros();
                for member in &members[fibre.members.clone()] {
                    let g = member.group as usize;
                    changed += (new[g] - previous[g]) * member.mass;
                }
                *pull = maps.inner.apply(&changed);
            });
        let pulls = &self.pulls;
        let place = |group: usize| {
            order.partition_point(|&index| (members[index as usize].group as usize) < group)
        };
        (next.par_chunks_mut(TASK).enumerate()).for_each(|(task, next)| {
            let start = task * TASK;
            for &index in &order[place(start)..place(start + next.len())] {
                let member = &members[index as usize];
                let pull = &pulls[member.fibre as usize];
                next[member.group as usize - start] += member.gain.apply(pull);
            }
        });
        let bound = (self.constrained.iter()).flat_map(|&f| self.all[f as usize].bound.clone());
        for (predicted, index) in self.predicted.iter_mut().zip(bound) {
            *predicted = next[members[index].group as usize];
        }
    }

    fn follow(&mut self, own: &Range<usize>, next: &mut [Vec3]) {
        let mut start = 0;
        for &index in &self.constrained {
            let fibre = &self.all[index as usize];
            let bound = &self.members[fibre.bound.clone()];
            let predicted = &self.predicted[start..start + bound.len()];
            start += bound.len();
            if !own.contains(&(bound[0].group as usize)) {
                continue;
            }
            let mut changed = Vec3::zeros();
            for (member, before) in bound.iter().zip(predicted) {
                changed += (next[member.group as usize] - before) * member.mass;
            }
            let pull = self.maps[index as usize].outer.apply(&changed);
            self.pulls[index as usize] = pull;
            if pull != Vec3::zeros() {
                for member in &self.members[fibre.bound.end..fibre.members.end] {
                    next[member.group as usize] += member.gain.apply(&pull);
                }
            }
        }
    }

    fn of_constraint(&self, group: usize) -> Option<Vec3> {
        let member = self.member(group)?;
        Some(self.beyond(member, self.pulls[member.fibre as usize]))
    }

    fn of_inertia(&self, group: usize, previous: &[Vec3], next: &[Vec3]) -> Option<Vec3> {
        let member = self.member(group)?;
        let own = &self.members[self.all[member.fibre as usize].members.clone()];
        let changed = own.iter().map(|other| {
            let g = other.group as usize;
            (next[g] - previous[g]) * other.mass
        });
        Some(self.beyond(member, changed.sum()))
    }

    /// The impulse (N s) of a member in the product of vectors, for a change of the momentum of its fibre (N s).
    fn beyond(&self, member: &Member<M>, changed: Vec3) -> Vec3 {
        let GroupFibre { added, mass, .. } = self.all[member.fibre as usize];
        changed * (-added / mass * member.mass)
    }

    fn kinetic(&self, previous: &[Vec3], next: &[Vec3]) -> Vec<[f64; 3]> {
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

    fn groups_beside_directed(&self, groups: &[NodeGroup]) -> Vec<u32> {
        let members = |fibre: &GroupFibre| &self.members[fibre.members.clone()];
        let is_directed = |member: &Member<M>| groups[member.group as usize].has_directed_mass();
        let found = self.all.iter().map(members);
        let found = found.filter(|members| members.iter().any(is_directed));
        found.flatten().map(|member| member.group).collect()
    }

    fn apply_inverse_root(&self, groups: &[NodeGroup], roots: &InverseRoots, vector: &mut [Vec3]) {
        for fibre in &self.all {
            let members = &self.members[fibre.members.clone()];
            let lead = |member: &Member<M>| groups[member.group as usize].members[0];
            if roots.directed(lead(&members[0])).is_some() {
                let own: Option<Vec<DirectedMember>> = members
                    .iter()
                    .map(|member| {
                        let lead = lead(member);
                        let root = roots.directed(lead)? * member.mass;
                        Some(DirectedMember { lead, root })
                    })
                    .collect();
                if let Some(own) = own {
                    directed_inverse_root(fibre, &own, vector);
                }
                continue;
            }
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
            let (values, axes) = if common == Mat3::from_diagonal(&common.diagonal()) {
                (common.diagonal(), Mat3::identity())
            } else {
                let eigen = common.symmetric_eigen();
                (eigen.eigenvalues, eigen.eigenvectors)
            };
            let mut shared = Vec3::zeros();
            for (&value, axis) in values.iter().zip(axes.column_iter()) {
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

/// A member of a fibre with added mass: its lead node, and its mass times the root of its inverse inertia by itself
/// (kg^1/2).
struct DirectedMember {
    lead: u32,
    root: Mat3,
}

/// Multiplies a vector of leads by what makes the root of the inverse inertia of a fibre of the roots of its groups by
/// themselves, where these have added mass.
///
/// With the inertia `D` of the groups by themselves and `c = a / s` the inverse of `D - c m m^T` is
/// `D^-1/2 (I + c U (I - c U^T U)^-1 U^T) D^-1/2`, `U = D^-1/2 m` (Woodbury 1950). The root of the middle is
/// `I + U S U^T`; for an eigenvalue `g` of `U^T U`, `S` has `(1 / sqrt(1 - c g) - 1) / g`.
fn directed_inverse_root(fibre: &GroupFibre, own: &[DirectedMember], vector: &mut [Vec3]) {
    let (mut gram, mut sum) = (Mat3::zeros(), Vec3::zeros());
    for DirectedMember { lead, root } in own {
        gram += root * root;
        sum += root * vector[*lead as usize];
    }
    let factor = fibre.added / fibre.mass;
    let eigen = gram.symmetric_eigen();
    let mut shared = Vec3::zeros();
    for (&value, axis) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        let share = factor * value;
        if share > HELD {
            shared += axis * (axis.dot(&sum) * (1.0 / (1.0 - share).sqrt() - 1.0) / value);
        }
    }
    for DirectedMember { lead, root } in own {
        vector[*lead as usize] += root * shared;
    }
}
