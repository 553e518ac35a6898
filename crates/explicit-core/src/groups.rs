//! Groups of constrained nodes: nodes with boundary impedance, supports, prescribed motion, ties or constraints;
//! the nodes of a group have one common motion.
//!
//! # Order of the groups
//! Groups are stored in one list, in four consecutive ranges:
//! 1. the nodes of constraints (joints), constraint by constraint in the order of the constraint's nodes, so that
//!    each constraint takes its velocities as one slice; there are [`ConstrainedNodes::count`] of them;
//! 2. all other groups in rising order of their lead nodes;
//! 3. those nodes of fibres that were plain or roller nodes without ([`FibreNodes`]), in rising order;
//! 4. roller nodes (one node fixed along coordinate axes, with a mass only), in rising order.
//!
//! Groups of the first three ranges have their velocity updated here, before the pass over all nodes; their number is
//! [`Groups::kicked`], which is the length of [`GroupMotion::next`] and [`GroupMotion::previous`]. Roller nodes are
//! updated by the pass itself ([`RollerNodes`]) and have no entry there. [`GroupMotion`]'s `displacement` covers
//! the first range, its `stretch` the second and third. The order is made by `GroupPlan::finish`.

use core::ops::Range;

use powerhouse_model::{DeviceGroup, MassDampingRule, Mat3, NodeCoupling, Vec3};

use rayon::prelude::*;

use crate::condition::Condition;
use crate::constrained::{ConstrainedMotion, ConstrainedNodes};
use crate::diagonal_group::DiagonalGroup;
use crate::effective_mass::inverse;
use crate::fibre_nodes::FibreNodes;
use crate::fibres::Fibres;
use crate::gather::{CHUNK, SlotTable};
use crate::nodes::{NodalArrays, Storage};
use crate::roller_nodes::{RollerNode, RollerNodes};
use crate::tiled::TILE;

/// Pseudo-mass of an orphan node (one without active elements), over the least mass of a node of the model.
const ORPHAN_MASS: f64 = 1e-12;

/// A group of nodes with one common motion: mass, impedance and boundary conditions. Most groups have one member.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeGroup {
    /// Engine nodes; the first one is the lead, which carries the group's values in nodal vectors.
    pub(crate) members: Vec<u32>,
    /// Mass (kg).
    pub(crate) mass: f64,
    /// Mass damping (kg/s).
    pub(crate) mass_damping: f64,
    /// Dashpot to the ground (N s/m).
    pub(crate) dashpot: Mat3,
    /// Spring to the ground (N/m).
    pub(crate) spring: Mat3,
    /// Skew coupling of y with x and z at the faces of a delayed slice (N s/m).
    pub(crate) gyroscopic: Mat3,
    /// Fixed and prescribed directions.
    pub(crate) condition: Condition,
    /// Inertia that its fibre adds to its own motion, over the mass (1); zero without a fibre.
    pub(crate) added: f64,
}

/// Matrices of the velocity update in one step, with the effective mass `A = M + dt/2 C + dt^2/4 K`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coefficients {
    /// New velocity per old velocity: `P (M - dt/2 C + dt^2/4 K)`.
    pub(crate) carry: Mat3,
    /// `P`, the inverse of `A` in the free directions, zero in the fixed ones (1/kg).
    pub(crate) inverse: Mat3,
    /// Map from the prescribed velocities along the condition's directions to the velocity of the node.
    pub(crate) lift: Mat3,
}

pub(crate) fn is_diagonal(matrix: &Mat3) -> bool {
    *matrix == Mat3::from_diagonal(&matrix.diagonal())
}

/// The coordinate axis along which a unit vector lies; none for an oblique one.
fn axis_of(direction: &Vec3) -> Option<usize> {
    let axis = direction.iamax();
    (direction.abs().sum() == direction[axis].abs()).then_some(axis)
}

impl NodeGroup {
    /// Impulse (N s) of inertia, dashpot and spring in a step between two velocities (m/s),
    /// `A v+ - (M - dt/2 C + dt^2/4 K) v-`.
    pub(crate) fn impulse(
        &self,
        (rule, step): (MassDampingRule, f64),
        before: &Vec3,
        after: &Vec3,
    ) -> Vec3 {
        let (mass, old) = self.effective_mass(rule, step);
        let spring = self.spring * (after - before) * (0.25 * step * step);
        let dashpot = self.dashpot * (after + before) * (0.5 * step);
        after * mass - before * old + dashpot + spring
    }

    /// Whether the group has no dashpot, spring, mass damping or prescribed motion, whose forces do work.
    pub(crate) fn is_bare(&self) -> bool {
        let still = self.dashpot == Mat3::zeros() && self.spring == Mat3::zeros();
        still && self.mass_damping == 0.0 && self.condition.prescribed.is_empty()
    }

    /// Contributions (kg) of mass and mass damping to `A` and to the factor of the old velocity; of a group in a
    /// fibre, those by itself.
    pub(crate) fn effective_mass(&self, rule: MassDampingRule, step: f64) -> (f64, f64) {
        let damping = self.mass_damping * step;
        rule.effective_mass(self.mass * (1.0 + self.added), damping)
    }

    /// Inverse pseudo-mass (1/kg) of a group of orphan nodes, which constraints use in place of
    /// [`Coefficients::inverse`]; none for a group with mass. The pseudo-mass is negligible beside `least` (kg), the
    /// least mass of a node of the model, so that the node follows its partner and carries no force.
    pub(crate) fn orphan_inverse(&self, least: f64) -> Option<Mat3> {
        let nothing = || Mat3::identity() / (ORPHAN_MASS * least);
        (self.mass <= 0.0).then(|| self.condition.project(&nothing()).0)
    }

    /// Whether the group is one node with a positive mass and no fixed direction, dashpot or spring.
    pub(crate) fn has_scalar_mass(&self) -> bool {
        let free = self.condition.directions().is_empty();
        let alone = self.members.len() == 1 && self.mass > 0.0;
        alone && free && self.dashpot == Mat3::zeros() && self.spring == Mat3::zeros()
    }

    /// The coordinate axes along which the group is fixed, if it is one node with a mass only that is fixed along
    /// coordinate axes or not at all, and has no fibre; none for any other group.
    pub(crate) fn held_axes(&self) -> Option<[bool; 3]> {
        self.axes().filter(|_| self.added == 0.0)
    }

    /// Whether the group is a node of a fibre that would be a roller node or a plain one without.
    pub(crate) fn is_fibre_node(&self) -> bool {
        self.added > 0.0 && self.mass > 0.0 && self.axes().is_some()
    }

    /// The same axes with a fibre or without.
    fn axes(&self) -> Option<[bool; 3]> {
        let free = self.dashpot == Mat3::zeros() && self.spring == Mat3::zeros();
        let alone = self.members.len() == 1 && self.condition.prescribed.is_empty();
        if !alone || !free {
            return None;
        }
        let mut held = [false; 3];
        for direction in self.condition.directions() {
            held[axis_of(direction)?] = true;
        }
        Some(held)
    }

    /// Whether all its matrices are diagonal: dashpot and spring are, and fixed and prescribed directions are coordinate
    /// axes.
    pub(crate) fn is_diagonal(&self) -> bool {
        let along_axes = |direction| axis_of(direction).is_some();
        let matrices = [&self.dashpot, &self.spring];
        matrices.into_iter().all(is_diagonal) && self.condition.directions().iter().all(along_axes)
    }

    fn coefficients(&self, rule: MassDampingRule, step: f64) -> Coefficients {
        if self.mass <= 0.0 {
            // An orphan node: dashpots and springs that it may have are ignored.
            let zeros = Mat3::zeros();
            let (carry, inverse) = (zeros, zeros);
            let lift = self.condition.project(&inverse).1;
            return Coefficients {
                carry,
                inverse,
                lift,
            };
        }
        let (mass, old) = self.effective_mass(rule, step);
        if let (true, Some(held)) = (self.is_fibre_node(), self.axes()) {
            let free = Vec3::from(held.map(|held| if held { 0.0 } else { 1.0 }));
            return Coefficients {
                carry: Mat3::from_diagonal(&(free * (old / mass))),
                inverse: Mat3::from_diagonal(&(free / mass)),
                lift: Mat3::zeros(),
            };
        }
        let spring = self.spring * (0.25 * step * step);
        let added = self.dashpot * (0.5 * step) + spring;
        let (inverse, lift) = self.condition.project(&inverse(mass, &added));
        // The factor of the old velocity is `mass + old + 2 spring - A`, and `P A` is known: nothing
        // cancels where a dashpot far outweighs the mass.
        let kept = Mat3::identity() * (mass + old) + spring * 2.0;
        Coefficients {
            carry: inverse * kept - self.condition.kept(&lift),
            inverse,
            lift,
        }
    }
}

/// Motion of the groups, input of the pass over all nodes; see the order of groups above.
#[derive(Default)]
pub(crate) struct GroupMotion {
    /// Node and group of all members, in rising order of nodes.
    members: Vec<(u32, u32)>,
    /// Range of the members in each chunk of nodes.
    chunks: Vec<Range<u32>>,
    /// The roller nodes.
    pub(crate) roller_nodes: RollerNodes,
    /// Displacement (m) of the nodes of constraints, by group.
    displacement: Vec<Vec3>,
    /// Length (s) of the last step, if `displacement` plus this step times `next` is the present displacement; none if
    /// nodes have been moved otherwise.
    moved: Option<f64>,
    /// Velocity before the step (m/s), by group without roller nodes.
    pub(crate) previous: Vec<Vec3>,
    /// Velocity after the step (m/s), by group without roller nodes.
    pub(crate) next: Vec<Vec3>,
    /// Elongation (m) of the springs of the groups after those of constraints.
    stretch: Vec<Vec3>,
}

impl GroupMotion {
    fn new(groups: &[NodeGroup], constrained: usize, node_count: usize) -> Self {
        let is_roller = |group: &NodeGroup| group.held_axes().is_some();
        let others = &groups[constrained..];
        let kicked = constrained + others.iter().take_while(|group| !is_roller(group)).count();
        let roller_nodes = (groups[kicked..].iter())
            .filter_map(|group| {
                let (node, held) = (group.members[0], group.held_axes()?);
                Some(RollerNode { node, held })
            })
            .collect();
        let mut members: Vec<(u32, u32)> = groups[..kicked]
            .iter()
            .enumerate()
            .flat_map(|(g, group)| group.members.iter().map(move |&node| (node, g as u32)))
            .collect();
        members.sort_unstable();
        let bound = |node: usize| members.partition_point(|&(n, _)| (n as usize) < node) as u32;
        let chunks = (0..node_count.div_ceil(CHUNK))
            .map(|chunk| bound(chunk * CHUNK)..bound((chunk + 1) * CHUNK))
            .collect();
        Self {
            chunks,
            members,
            roller_nodes: RollerNodes::new(roller_nodes, node_count),
            displacement: vec![Vec3::zeros(); constrained],
            moved: None,
            previous: vec![Vec3::zeros(); kicked],
            next: vec![Vec3::zeros(); kicked],
            stretch: vec![Vec3::zeros(); kicked - constrained],
        }
    }

    /// Node and group of the members in a chunk of nodes.
    #[inline]
    pub(crate) fn members_in(&self, chunk: usize) -> &[(u32, u32)] {
        let range = &self.chunks[chunk];
        &self.members[range.start as usize..range.end as usize]
    }

    /// Records that all nodes have moved by exactly a step (s) with the velocity after it.
    pub(crate) fn has_moved(&mut self, step: f64) {
        self.moved = Some(step);
    }

    /// Marks the stored displacement as outdated, because nodes have been moved otherwise.
    pub(crate) fn invalidate(&mut self) {
        self.moved = None;
    }

    /// Displacement and velocities of the groups of a constraint.
    pub(crate) fn of(&mut self, groups: Range<usize>) -> ConstrainedMotion<'_> {
        ConstrainedMotion {
            displacement: &mut self.displacement[groups.clone()],
            previous: &mut self.previous[groups.clone()],
            next: &mut self.next[groups],
        }
    }
}

/// All groups of a model, with the matrices of the present length of step.
#[derive(Default)]
pub(crate) struct Groups {
    pub(crate) groups: Vec<NodeGroup>,
    pub(crate) motion: GroupMotion,
    pub(crate) coefficients: Vec<Coefficients>,
    diagonal: Vec<DiagonalGroup>,
    /// Nodes of constraints; their groups come first.
    constrained: ConstrainedNodes,
    /// Displacement (m) from which the springs are measured.
    pub(crate) origin: Vec<Vec3>,
    /// Indices of the groups with a prescribed motion.
    pub(crate) prescribed: Vec<u32>,
    /// Nodes of fibres whose groups are the last of those that are kicked.
    fibre_nodes: FibreNodes,
    pub(crate) fibres: Fibres,
}

impl Groups {
    /// Groups in the order that the module page states; `constrained` are the engine nodes of constraints.
    pub(crate) fn new(groups: Vec<NodeGroup>, constrained: &[u32], slots: &SlotTable) -> Self {
        let motion = GroupMotion::new(&groups, constrained.len(), slots.node_count());
        let kicked = &groups[..motion.next.len()];
        let others = &kicked[constrained.len()..];
        let last = others
            .iter()
            .rev()
            .take_while(|group| group.is_fibre_node());
        let of_fibres = &kicked[kicked.len() - last.count()..];
        Self {
            fibre_nodes: FibreNodes::new(of_fibres, slots),
            motion,
            constrained: ConstrainedNodes::new(constrained, &groups, slots),
            coefficients: Vec::new(),
            diagonal: Vec::new(),
            origin: vec![Vec3::zeros(); groups.len()],
            prescribed: (0..groups.len() as u32)
                .filter(|&g| !groups[g as usize].condition.prescribed.is_empty())
                .collect(),
            groups,
            fibres: Fibres::default(),
        }
    }

    /// Number of groups whose velocity is updated before the pass over the nodes: all but the roller nodes.
    pub(crate) fn kicked(&self) -> usize {
        self.motion.next.len()
    }

    /// The group of each node, without roller nodes.
    pub(crate) fn kicked_of(&self, group_of: &[Option<u32>]) -> Vec<Option<u32>> {
        group_of
            .iter()
            .map(|&group| self.if_kicked(group))
            .collect()
    }

    /// The group, unless it is that of a roller node.
    #[inline]
    pub(crate) fn if_kicked(&self, group: Option<u32>) -> Option<u32> {
        group.filter(|&group| (group as usize) < self.kicked())
    }

    /// Computes the matrices for a length of step (s).
    pub(crate) fn prepare(&mut self, rule: MassDampingRule, step: f64) {
        self.coefficients = self.groups[..self.kicked()]
            .par_iter()
            .map(|group| group.coefficients(rule, step))
            .collect();
        self.diagonal = (self.groups.iter().zip(&self.coefficients))
            .map(|(group, matrices)| DiagonalGroup::new(group, matrices, step))
            .collect();
        self.constrained.prepare(&self.groups, rule, step);
        let last = self.coefficients.len() - self.fibre_nodes.count();
        (self.fibre_nodes).prepare(&self.coefficients[last..], step);
        self.fibres.prepare(&self.coefficients);
    }

    /// Number of nodes of constraints, whose groups come first.
    pub(crate) fn constrained(&self) -> usize {
        self.constrained.count()
    }

    /// Response (1/kg) of a group of a constraint to its impulse, in the free directions.
    pub(crate) fn response(&self, group: usize) -> Mat3 {
        self.coefficients[group].inverse + self.fibres.response(group, &self.coefficients)
    }

    /// Couplings of the nodes of a constraint by fibres, whose groups these are.
    pub(crate) fn couplings(&self, own: &Range<usize>) -> Vec<NodeCoupling> {
        self.fibres.couplings(own, &self.coefficients)
    }

    /// Impulse (N s) by which a constraint has changed the predicted velocity of a group by `change` (m/s), once the
    /// groups of its fibre have followed.
    pub(crate) fn correction(
        &self,
        group: usize,
        prepared: (MassDampingRule, f64),
        change: &Vec3,
    ) -> Vec3 {
        let own = match self.constrained.scalar_mass(group) {
            Some(mass) => change * mass,
            None => self.groups[group].impulse(prepared, &Vec3::zeros(), change),
        };
        own + self.fibres.of_constraint(group)
    }

    /// Impulse (N s) of inertia, dashpot and spring of a group in the present step, `A v+ - (M - dt/2 C + dt^2/4 K) v-`.
    pub(crate) fn impulse(&self, group: usize, prepared: (MassDampingRule, f64)) -> Vec3 {
        let GroupMotion { previous, next, .. } = &self.motion;
        let own = self.groups[group].impulse(prepared, &previous[group], &next[group]);
        own + self.fibres.of_inertia(group, previous, next)
    }

    /// Couples the predicted velocities of the groups of fibres.
    pub(crate) fn couple_fibres(&mut self) {
        let GroupMotion { previous, next, .. } = &mut self.motion;
        self.fibres.couple(previous, next);
    }

    /// Lets the groups of fibres follow what a constraint, whose groups these are, has changed.
    pub(crate) fn follow_constraint(&mut self, own: &Range<usize>) {
        self.fibres.follow(own, &mut self.motion.next);
    }

    /// Whether no force does work at a group, but those of a constraint.
    #[inline]
    pub(crate) fn is_bare(&self, group: usize) -> bool {
        self.diagonal[group].is_bare
    }

    /// Diagonal coefficients of a group without constraint and prescribed motion, and the elongation (m) of its spring
    /// at the last velocity update; none if its matrices are not diagonal.
    #[inline]
    pub(crate) fn diagonal_group(&self, group: usize) -> Option<(&DiagonalGroup, &Vec3)> {
        let stretch = &self.motion.stretch[group.checked_sub(self.constrained.count())?];
        let group = &self.diagonal[group];
        (group.is_diagonal && !group.is_prescribed).then_some((group, stretch))
    }

    /// The kicked groups with their present coefficients, for a device.
    pub(crate) fn for_device(&self) -> Vec<DeviceGroup> {
        let all = self.groups[..self.kicked()].iter();
        let own = all.zip(&self.coefficients).zip(&self.diagonal);
        own.zip(&self.origin)
            .map(|(((group, matrices), diagonal), origin)| DeviceGroup {
                members: group.members.clone(),
                is_diagonal: diagonal.is_diagonal,
                carry: matrices.carry,
                inverse: match diagonal.is_diagonal {
                    true => Mat3::from_diagonal(&diagonal.response),
                    false => matrices.inverse,
                },
                spring: group.spring,
                origin: *origin,
            })
            .collect()
    }

    /// Predicts the velocity of every group from the forces on it.
    pub(crate) fn kick<S: Storage>(
        &mut self,
        arrays: &NodalArrays<S>,
        slots: &SlotTable,
        applied: impl Fn(usize) -> Vec3 + Sync,
        step: f64,
    ) {
        let Self {
            groups,
            motion,
            coefficients,
            diagonal,
            constrained,
            origin,
            fibre_nodes,
            ..
        } = self;
        // Velocity before and after the step, and elongation of the spring.
        let kicked = |g: usize| -> [Vec3; 3] {
            let group = &diagonal[g];
            let lead = group.lead as usize;
            let mut force = applied(g) - arrays.internal(slots, lead);
            let stretch = arrays.displacement[lead].to_vector() - origin[g];
            let previous = arrays.velocity[lead].to_vector();
            if group.is_diagonal {
                force -= group.spring.component_mul(&stretch);
                let carried = group.carry.component_mul(&previous);
                let next = carried + group.response.component_mul(&force);
                return [previous, next, stretch];
            }
            let (group, matrices) = (&groups[g], &coefficients[g]);
            for &node in &group.members[1..] {
                force -= arrays.internal(slots, node as usize);
            }
            force -= group.spring * stretch;
            let next = matrices.carry * previous + matrices.inverse * (force * step);
            [previous, next, stretch]
        };
        let moved = motion.moved.take();
        if moved.is_some() {
            core::mem::swap(&mut motion.previous, &mut motion.next);
        }
        let count = constrained.count();
        let (own_previous, other_previous) = motion.previous.split_at_mut(count);
        let (own_next, other_next) = motion.next.split_at_mut(count);
        own_next
            .par_chunks_mut(TILE)
            .zip(own_previous.par_chunks_mut(TILE))
            .zip(motion.displacement.par_chunks_mut(TILE))
            .enumerate()
            .with_min_len(4)
            .for_each(|(tile, ((next, previous), displacement))| {
                let own = ConstrainedMotion {
                    displacement,
                    previous,
                    next,
                };
                constrained.kick((tile, moved), own, arrays, &applied, kicked);
            });
        let others = other_next.len() - fibre_nodes.count();
        let (other_next, next) = other_next.split_at_mut(others);
        let (other_previous, previous) = other_previous.split_at_mut(others);
        fibre_nodes.kick(moved.is_some(), (previous, next), arrays, |node| {
            applied(count + others + node)
        });
        other_next
            .par_iter_mut()
            .zip(other_previous)
            .zip(&mut motion.stretch)
            .enumerate()
            .with_min_len(256)
            .for_each(|(g, ((next, previous), stretch))| {
                [*previous, *next, *stretch] = kicked(count + g);
            });
    }

    /// Adds the prescribed velocities: `displacement` is the value of each motion (m) at the end
    /// of the step, `present` the present displacement of a node (m).
    pub(crate) fn prescribe(
        &mut self,
        displacement: &[f64],
        present: impl Fn(usize) -> Vec3,
        step: f64,
    ) {
        for &g in &self.prescribed {
            let group = &self.groups[g as usize];
            let here = present(group.members[0] as usize);
            let velocities: Vec<f64> = group
                .condition
                .prescribed
                .iter()
                .map(|&(direction, motion)| (displacement[motion] - direction.dot(&here)) / step)
                .collect();
            let target = group.condition.target(&velocities);
            self.motion.next[g as usize] += self.coefficients[g as usize].lift * target;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a dashpot at an angle outweighs the mass by up to 1e12 a node still moves across it as
    /// its mass demands, and along it as the dashpot lets it, neither faster nor slower; with a
    /// roller at another angle it keeps to its plane.
    #[test]
    fn a_dashpot_that_outweighs_the_mass_leaves_it_its_digits() {
        let normal = Vec3::new(1.0, 2.0, -0.5).normalize();
        let along = normal * normal.transpose();
        let across = Mat3::identity() - along;
        let (mass, step) = (3.0, 1e-3);
        let rule = MassDampingRule::Implicit;
        for ratio in [1e-3, 1.0, 1e4, 1e8, 1e12] {
            let group = NodeGroup {
                members: vec![0],
                mass,
                dashpot: along * (2.0 * ratio * mass / step),
                ..NodeGroup::default()
            };
            let found = group.coefficients(rule, step);
            let inverse = (across + along / (1.0 + ratio)) / mass;
            let error = (found.inverse - inverse).amax() * mass;
            assert!(error < 1e-14, "{ratio:e}: {error:e}");
            let carry = across + along * ((1.0 - ratio) / (1.0 + ratio));
            let error = (found.carry - carry).amax();
            assert!(error < 1e-14, "{ratio:e}: {error:e}");

            let roller = Vec3::new(0.3, 0.1, 1.0).normalize();
            let mut held = group.clone();
            held.condition.hold(roller);
            let found = held.coefficients(rule, step);
            let free = roller.cross(&normal).normalize();
            let error = (found.carry * free - free).norm();
            assert!(error < 1e-13, "{ratio:e}: {error:e}");
            let error = (found.inverse * free - free / mass).norm();
            assert!(error < 1e-13, "{ratio:e}: {error:e}");
            let velocity = (Mat3::identity() - roller * roller.transpose()) * normal;
            let carried = found.carry * velocity;
            assert!(
                carried.norm() <= velocity.norm() * (1.0 + 1e-13),
                "{ratio:e}"
            );
            assert!(carried.dot(&roller).abs() < 1e-15, "{ratio:e}");
        }
    }

    /// Springs, dashpots and mass damping at angles, a roller and a prescribed motion: the kick obeys
    /// the equation of motion in the free directions, and the impulse of the step says so.
    #[test]
    fn a_kick_obeys_the_equation_of_motion() {
        let axis = |x: f64, y: f64, z: f64| {
            let normal = Vec3::new(x, y, z).normalize();
            normal * normal.transpose()
        };
        let mut group = NodeGroup {
            members: vec![0],
            mass: 2.0,
            mass_damping: 7.0,
            dashpot: axis(1.0, 2.0, -0.5) * 300.0 + axis(0.3, -0.2, 1.0) * 90.0,
            spring: axis(0.2, 1.0, 0.7) * 4e4,
            ..NodeGroup::default()
        };
        let (held, prescribed) = (
            Vec3::new(0.6, 0.0, 0.8),
            Vec3::new(1.0, 1.0, -1.0).normalize(),
        );
        group.condition.hold(held);
        assert!(group.condition.prescribe(prescribed, 0));
        let step = 1e-2;
        let before = held.cross(&prescribed) * 0.7 + group.condition.along(&[0.3]);
        let force = Vec3::new(5.0, -11.0, 3.0);
        for rule in [MassDampingRule::Implicit, MassDampingRule::Lagged] {
            let found = group.coefficients(rule, step);
            let target = found.lift * group.condition.target(&[-0.4]);
            let after = found.carry * before + found.inverse * force * step + target;
            assert!(after.dot(&held).abs() < 1e-15);
            assert!((after.dot(&prescribed) + 0.4).abs() < 1e-15);
            let residual = group.impulse((rule, step), &before, &after) - force * step;
            assert!(group.condition.free(residual).norm() < 1e-14, "{residual}");
        }
    }
}
