//! The operations of a step of a slice.

use powerhouse_model::{ForceTerms, MassDampingRule, Quad, RunError, StepTime, Vec3};
use rayon::prelude::*;

use super::linear::{Inert, kicked};
use super::{DelayedMotion, DelayedSlice, Part, Works};
use crate::Model;
use crate::gather::CHUNK;
use crate::node_group::NodeGroup;
use crate::nodes::{NodalArrays, Nodes, with_nodes};
use crate::subdomain::Subdomain;

/// Forces on a group: applied ones less internal ones (N), and its `T` (N m).
#[derive(Clone, Copy)]
struct GroupForces {
    applied: Vec3,
    internal: Vec3,
    traction: Vec3,
}

/// Displacement (m) and velocity (m/s) of a group at a moment of a step.
type Moment = fn(&DelayedMotion, usize) -> [Vec3; 2];

/// New velocity and momentum of a group along some axes, and its `T` along the others.
#[derive(Clone, Copy, Default)]
struct Kicked {
    velocity: Vec3,
    momentum: Vec3,
    traction: Vec3,
}

impl DelayedSlice {
    /// Displacement (m) and velocity (m/s) of a node, whose group and side are given, from those of its group.
    fn of_side(&self, sign: f64, [u, v]: [Vec3; 2]) -> [Vec3; 2] {
        [u + v * (sign * self.slowness * self.half), v]
    }

    /// Displacement (m) and velocity (m/s) of a local node, for readers; none before the first step.
    pub(crate) fn motion_of(&self, node: usize) -> Option<[Vec3; 2]> {
        let motion = self.motion.as_ref()?;
        let (group, sign) = self.place[node];
        let own = if self.is_centred {
            motion.centred(group as usize)
        } else {
            motion.now(group as usize)
        };
        Some(self.of_side(sign, own))
    }

    /// Displacement (m) of the nodes of a block, in the block's order, for readers.
    pub(crate) fn displacement_of_block(
        &self,
        subdomain: &Subdomain,
        nodes: &Nodes,
        block: usize,
    ) -> Vec<Quad<f64>> {
        if self.motion.is_none() {
            return with_nodes!(nodes, arrays => subdomain.values(block, &arrays.displacement));
        }
        let of = |node: &u32| {
            self.motion_of(*node as usize)
                .map_or_else(Vec3::zeros, |[u, _]| u)
        };
        let own = subdomain.nodes_of(block).iter().map(of);
        own.map(|u| Quad::from_vector(&u)).collect()
    }

    /// Velocities (m/s) of a local node half a step before and after the present time; none before the first step.
    pub(crate) fn velocities_around(&self, node: usize) -> Option<(Vec3, Vec3)> {
        let motion = self.motion.as_ref()?;
        Some(motion.around(self.place[node].0 as usize))
    }
}

impl Model {
    /// The slice and the arrays of nodes, which are in double precision.
    pub(super) fn slice_parts(
        &mut self,
    ) -> Option<(&mut DelayedSlice, &mut NodalArrays<f64>, &[NodeGroup])> {
        match (&mut self.delayed, &mut self.nodes) {
            (Some(slice), Nodes::F64(arrays)) => Some((slice, arrays, &self.groups.groups)),
            _ => None,
        }
    }

    /// Gives all nodes the displacement that the slice has at a moment of a step, for the forces there, and the mean velocity since
    /// the forces before: that of the sides follows the velocities along some axes, which are new since then, beside their
    /// displacement.
    fn place_slice(&mut self, moment: Moment, new: Option<Part>) {
        let Some((slice, arrays, _)) = self.slice_parts() else {
            return;
        };
        let Some(motion) = &slice.motion else {
            return;
        };
        let lever = slice.slowness * slice.half / (0.5 * motion.step);
        let moved = |group: usize, sign: f64| match new {
            Some(part) => part.of(motion.velocity(group) - motion.before(group)) * (sign * lever),
            None => Vec3::zeros(),
        };
        arrays
            .displacement
            .par_chunks_mut(CHUNK)
            .zip(arrays.velocity.par_chunks_mut(CHUNK))
            .zip(slice.place.par_chunks(CHUNK))
            .for_each(|((displacement, velocity), place)| {
                let nodes = displacement.iter_mut().zip(velocity).zip(place);
                for ((displacement, velocity), &(group, sign)) in nodes {
                    let [u, v] = slice.of_side(sign, moment(motion, group as usize));
                    *displacement = Quad::from_vector(&u);
                    *velocity = Quad::from_vector(&(v + moved(group as usize, sign)));
                }
            });
    }

    /// Starts the motion of a slice from displacements and velocities of the nodes, unless it goes on with the same step.
    fn start_slice(&mut self, step: f64) -> Result<(), RunError> {
        let sums = &self.loads.sums;
        if let Some(slice) = &mut self.delayed
            && slice.free.is_empty()
        {
            let free = |(group, bare): (usize, &bool)| *bare && !sums.acts_on(group);
            slice.free = slice.bare.iter().enumerate().map(free).collect();
            let others = (0..).zip(&slice.free).filter(|(_, free)| !**free);
            slice.loaded = others.map(|(group, _)| group).collect();
        }
        let Some((slice, arrays, groups)) = self.slice_parts() else {
            return Ok(());
        };
        let goes_on = |motion: &DelayedMotion| motion.step == step;
        if slice.motion.as_ref().is_some_and(goes_on) {
            return Ok(());
        }
        let mut motion = DelayedMotion::still(groups.len(), step);
        for (group, &[low, high]) in slice.sides.iter().enumerate() {
            let of = |node: u32| {
                let known = slice.motion_of(node as usize);
                known.unwrap_or_else(|| {
                    let node = node as usize;
                    [&arrays.displacement, &arrays.velocity].map(|all| all[node].to_vector())
                })
            };
            let ([a, mut velocity], [b, _]) = (of(low), of(high));
            for (velocity, held) in velocity.iter_mut().zip(slice.held[group]) {
                if held {
                    *velocity = 0.0;
                }
            }
            let displacement = (a + b) * 0.5;
            motion.plane.displacement[group] = [displacement.x, displacement.z];
            motion.plane.velocity[group] = [velocity.x, velocity.z];
            motion.axial.displacement[group] = displacement.y + 0.5 * step * velocity.y;
            motion.axial.velocity[group] = velocity.y;
        }
        (motion.plane.before).clone_from(&motion.plane.velocity);
        (motion.axial.before).clone_from(&motion.axial.velocity);
        slice.is_centred = false;
        slice.motion = Some(motion);
        if slice.is_linear {
            Ok(())
        } else {
            self.start_momentum(step)
        }
    }

    /// Momentum and `T` at the start, from the forces there.
    fn start_momentum(&mut self, step: f64) -> Result<(), RunError> {
        self.place_slice(DelayedMotion::at_start, None);
        self.evaluate(ForceTerms::PLAIN, self.half_step(0, step))?;
        // The forces are those of the start, not of a step.
        self.uncommitted = false;
        let tractions = self.all_forces(|_, _, acting| acting.traction);
        let Some((slice, _, groups)) = self.slice_parts() else {
            return Ok(());
        };
        let slowness = slice.slowness;
        let Some(motion) = &mut slice.motion else {
            return Ok(());
        };
        let momenta = groups.iter().zip(&tractions).enumerate();
        let momenta = momenta.map(|(g, (group, t))| motion.velocity(g) * group.mass + t * slowness);
        let momenta: Vec<Vec3> = momenta.collect();
        let divided = |vectors: &[Vec3]| vectors.iter().map(|v| ([v.x, v.z], v.y)).unzip();
        (motion.plane.momentum, motion.axial.momentum) = divided(&momenta);
        (motion.plane.traction, motion.axial.traction) = divided(&tractions);
        Ok(())
    }

    /// A function of the forces on each group of the last evaluation.
    fn all_forces<T: Send>(
        &self,
        of: impl Fn((&DelayedSlice, &DelayedMotion), usize, GroupForces) -> T + Sync,
    ) -> Vec<T> {
        let (Some(slice), Nodes::F64(arrays)) = (&self.delayed, &self.nodes) else {
            return Vec::new();
        };
        let Some(motion) = &slice.motion else {
            return Vec::new();
        };
        let (sums, slots) = (&self.loads.sums, &self.subdomain.slots);
        let groups = (0..slice.sides.len()).into_par_iter().with_min_len(256);
        let acting = |group: usize| {
            let [low, high] = slice.sides[group].map(|node| arrays.internal(slots, node as usize));
            let spread = slice.lumping.spread(group, |g| motion.velocity(g));
            let acting = GroupForces {
                applied: sums.on_group(group),
                internal: low + high,
                traction: (high - low) * slice.half + spread * slice.slowness,
            };
            of((slice, motion), group, acting)
        };
        groups.map(acting).collect()
    }

    /// Forces of a slice at the present time.
    pub(crate) fn slice_forces(&mut self, terms: ForceTerms, step: f64) -> Result<(), RunError> {
        if let Some(fault) = self.fault.take() {
            return Err(fault);
        }
        self.start_slice(step)?;
        if self.is_linear_slice() {
            return self.linear_forces(terms, step);
        }
        self.place_slice(DelayedMotion::now, Some(Part::Axial));
        self.evaluate(terms, self.half_step(0, step))?;
        // History variables of the half step before are committed now.
        if let Some(slice) = &mut self.delayed {
            slice.lumping.follow_damage(&self.blocks);
        }
        Ok(())
    }

    /// The half of the present step between the forces at the present time (0) or half a step later (1) and those before: elements
    /// count both.
    fn half_step(&self, half: u64, step: f64) -> StepTime {
        StepTime {
            number: 2 * self.number + half,
            time: self.time,
            step: 0.5 * step,
        }
    }

    /// Whether the elements of a slice are all linear.
    fn is_linear_slice(&self) -> bool {
        self.delayed.as_ref().is_some_and(|slice| slice.is_linear)
    }

    /// New velocities of x and z of a slice, half a step after the present time.
    pub(crate) fn kick_slice(&mut self, rule: MassDampingRule, step: f64) {
        self.prepared = Some((rule, step));
        if self.is_linear_slice() {
            self.kick_plane(step)
        } else {
            self.update_slice(Part::Plane, step)
        }
        if let Some(slice) = &mut self.delayed {
            slice.is_centred = true;
        }
        self.begin_slice_balance(step);
    }

    /// Moves x and z of a slice by the step, evaluates the forces half a step after the present time, and updates y.
    pub(crate) fn drift_slice(&mut self, step: f64) {
        let start = self.time;
        if let Some(slice) = &mut self.delayed {
            slice.work.end_plane();
            slice.is_centred = false;
            if let Some(motion) = &mut slice.motion {
                let plane = &mut motion.plane;
                for (u, v) in plane.displacement.iter_mut().zip(&plane.velocity) {
                    u[0] += step * v[0];
                    u[1] += step * v[1];
                }
            }
        }
        self.time = start + 0.5 * step;
        if self.is_linear_slice() {
            self.kick_axial(step)
        } else {
            self.evaluate_axial(step)
        }
        if let Some((slice, ..)) = self.slice_parts()
            && let Some(motion) = &mut slice.motion
        {
            let axial = &mut motion.axial;
            for (u, v) in axial.displacement.iter_mut().zip(&axial.velocity) {
                *u += step * v;
            }
        }
        self.uncommitted = true;
        self.time = start + step;
        self.number += 1;
    }

    /// Evaluates the forces of a slice half a step after the present time, and updates y.
    fn evaluate_axial(&mut self, step: f64) {
        self.place_slice(DelayedMotion::half_step_later, Some(Part::Plane));
        self.uncommitted = true;
        let terms = ForceTerms::PLAIN.with_repeats(false);
        match self.evaluate(terms, self.half_step(1, step)) {
            Ok(()) => self.update_slice(Part::Axial, step),
            Err(fault) => self.fault = Some(fault),
        }
    }

    /// Updates velocity, momentum and `T` along some axes.
    fn update_slice(&mut self, part: Part, step: f64) {
        let (groups, origin) = (&self.groups.groups, &self.groups.origin);
        let kicked = self.all_forces(|(slice, motion), index, acting| {
            if slice.bare[index] {
                return kick_mass(part, (slice, motion), index, &acting, step);
            }
            let stretch = motion.displacement(index) - origin[index];
            let own = (&groups[index], index);
            kick(part, (slice, motion), own, (&acting, &stretch), step)
        });
        let limit = self.speed_limit;
        let sound = kicked
            .iter()
            .all(|k| k.velocity.iter().all(|v| v.abs() <= limit));
        if let Some((slice, ..)) = self.slice_parts()
            && let Some(motion) = &mut slice.motion
        {
            let (plane, axial) = (&mut motion.plane, &mut motion.axial);
            match part {
                Part::Plane => {
                    core::mem::swap(&mut plane.before, &mut plane.velocity);
                    for (g, kicked) in kicked.iter().enumerate() {
                        plane.velocity[g] = [kicked.velocity.x, kicked.velocity.z];
                        plane.momentum[g] = [kicked.momentum.x, kicked.momentum.z];
                        axial.traction[g] = kicked.traction.y;
                    }
                }
                Part::Axial => {
                    core::mem::swap(&mut axial.before, &mut axial.velocity);
                    for (g, kicked) in kicked.iter().enumerate() {
                        axial.velocity[g] = kicked.velocity.y;
                        axial.momentum[g] = kicked.momentum.y;
                        plane.traction[g] = [kicked.traction.x, kicked.traction.z];
                    }
                }
            }
        }
        self.end_update(part, sound, step);
    }

    /// Adds the works of all groups along some axes, whose velocities are new, to the energy balance, if one is open; ends the run
    /// if the new velocities are not `sound`.
    pub(super) fn end_update(&mut self, part: Part, sound: bool, step: f64) {
        self.add_works(part, step);
        if !sound && self.fault.is_none() {
            if let Some(slice) = &mut self.delayed {
                slice.is_centred = false;
            }
            self.fault = Some(self.divergence());
        }
    }

    fn add_works(&mut self, part: Part, step: f64) {
        if self.ledger.is_none() {
            return;
        }
        let (groups, sums) = (&self.groups, &self.loads.sums);
        let Some(slice) = &mut self.delayed else {
            return;
        };
        let Some(motion) = &slice.motion else {
            return;
        };
        let is_axial = part == Part::Axial;
        if !is_axial {
            slice.work.begin_step();
        }
        for index in slice.loaded.iter().map(|group| *group as usize) {
            let applied = sums.on_group(index);
            let stretch = motion.displacement(index) - groups.origin[index];
            let velocities = [motion.before(index), motion.velocity(index)].map(|v| part.of(v));
            let forces = [part.of(applied), part.of(stretch)];
            let halves = Works::of(&groups.groups[index], forces, velocities, step);
            slice.work.add(&halves, is_axial);
        }
    }
}

/// The same as [`kick`] of a group with a mass alone.
fn kick_mass(
    part: Part,
    (slice, motion): (&DelayedSlice, &DelayedMotion),
    index: usize,
    acting: &GroupForces,
    step: f64,
) -> Kicked {
    let traction = acting.traction;
    if slice.mass[index] <= 0.0 {
        return Kicked::default();
    }
    let s = slice.slowness;
    let velocity = motion.velocity(index);
    let rigidity = slice.lumping.rigidity(index);
    let momentum = motion.momentum(index) + (acting.applied - acting.internal) * step;
    let lag = rigidity.component_mul(&velocity) * s;
    let predicted = traction * 2.0 - motion.traction(index) + lag;
    let right = momentum - predicted * s;
    let mass = slice.inertia(index);
    let mut after = part.of(right.component_div(&mass));
    for (velocity, held) in after.iter_mut().zip(slice.held[index]) {
        if held {
            *velocity = 0.0;
        }
    }
    Kicked {
        velocity: after,
        momentum,
        traction,
    }
}

/// New velocity and momentum of a group along some axes.
fn kick(
    part: Part,
    (slice, motion): (&DelayedSlice, &DelayedMotion),
    (group, index): (&NodeGroup, usize),
    (acting, stretch): (&GroupForces, &Vec3),
    step: f64,
) -> Kicked {
    let traction = acting.traction;
    if group.mass <= 0.0 {
        return Kicked::default();
    }
    let s = slice.slowness;
    let velocity = motion.velocity(index);
    let before = part.of(velocity);
    let rigidity = slice.lumping.rigidity(index);
    let force = acting.applied - acting.internal - group.gyroscopic * velocity;
    let force = part.of(force - group.spring * part.of(*stretch));
    let momentum = part.of(motion.momentum(index)) + force * step;
    let lag = rigidity.component_mul(&before) * s;
    let predicted = part.of(traction * 2.0 - motion.traction(index)) + lag;
    let own = Inert {
        group,
        inertia: slice.inertia(index),
        held: slice.held[index],
    };
    let [velocity, lost] = kicked(part, own, (momentum - predicted * s, before), step);
    Kicked {
        velocity,
        momentum: momentum - lost,
        traction,
    }
}
