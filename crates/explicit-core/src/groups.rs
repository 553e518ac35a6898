//! Groups of constrained nodes: nodes with boundary impedance, added mass, supports, prescribed motion, ties or
//! constraints; the nodes of a group have one common motion.
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

use crate::constrained::{ConstrainedMotion, ConstrainedNodes};
use crate::diagonal_group::DiagonalGroup;
use crate::fibre_nodes::FibreNodes;
use crate::fibres::Fibres;
use crate::gather::{CHUNK, SlotTable};
use crate::node_group::{Coefficients, NodeGroup};
use crate::nodes::{NodalArrays, Storage};
use crate::roller_nodes::{RollerNode, RollerNodes};
use crate::tiled::TILE;

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
                inverse: if diagonal.is_diagonal {
                    Mat3::from_diagonal(&diagonal.response)
                } else {
                    matrices.inverse
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
