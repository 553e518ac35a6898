//! The operations of a step of a slice.

use powerhouse_model::{ForceTerms, HistoryUpdate, MassDampingRule, Quad, RunError, Vec3};
use rayon::prelude::*;

use super::{DelayedMotion, DelayedSlice, Works};
use crate::Model;
use crate::gather::CHUNK;
use crate::node_group::NodeGroup;
use crate::nodes::{NodalArrays, Nodes};

/// Forces on a group: applied ones less internal ones (N), and its `T` (N m).
#[derive(Clone, Copy)]
struct GroupForces {
    applied: Vec3,
    internal: Vec3,
    traction: Vec3,
}

/// New velocity and momentum of a group along some axes, and its `T` along the others.
#[derive(Clone, Copy, Default)]
struct Kicked {
    velocity: Vec3,
    momentum: Vec3,
    traction: Vec3,
}

/// The axes that are updated together.
#[derive(Clone, Copy)]
enum Part {
    Plane,
    Axial,
}

impl Part {
    /// The components along the axes, others zero.
    fn of(self, vector: Vec3) -> Vec3 {
        match self {
            Self::Plane => Vec3::new(vector.x, 0.0, vector.z),
            Self::Axial => Vec3::new(0.0, vector.y, 0.0),
        }
    }
    fn put(self, from: &Vec3, to: &mut Vec3) {
        match self {
            Self::Plane => (to.x, to.z) = (from.x, from.z),
            Self::Axial => to.y = from.y,
        }
    }
    fn other(self) -> Self {
        match self {
            Self::Plane => Self::Axial,
            Self::Axial => Self::Plane,
        }
    }
}

impl DelayedSlice {
    /// The displacement of a side whose displacement has `s h / 2 V` with a sign.
    fn side(&self, sign: f64, [u, v]: [Vec3; 2]) -> Vec3 {
        u + v * (sign * self.slowness * self.half)
    }

    /// Gives the nodes of all pairs their motion, from displacement (m) and velocity (m/s) of each group.
    fn put(&self, arrays: &mut NodalArrays<f64>, of: impl Fn(usize) -> [Vec3; 2] + Sync) {
        arrays
            .displacement
            .par_chunks_mut(CHUNK)
            .zip(arrays.velocity.par_chunks_mut(CHUNK))
            .zip(self.place.par_chunks(CHUNK))
            .for_each(|((displacement, velocity), place)| {
                let nodes = displacement.iter_mut().zip(velocity).zip(place);
                for ((displacement, velocity), &(group, sign)) in nodes {
                    let motion = of(group as usize);
                    *displacement = Quad::from_vector(&self.side(sign, motion));
                    *velocity = Quad::from_vector(&motion[1]);
                }
            });
    }
}

impl Model {
    /// The slice and the arrays of nodes, which are in double precision.
    fn slice_parts(&mut self) -> Option<(&mut DelayedSlice, &mut NodalArrays<f64>, &[NodeGroup])> {
        match (&mut self.delayed, &mut self.nodes) {
            (Some(slice), Nodes::F64(arrays)) => Some((slice, arrays, &self.groups.groups)),
            _ => None,
        }
    }

    /// Gives all nodes the motion that the slice has at a moment of a step.
    fn place_slice(&mut self, moment: fn(&DelayedMotion, usize) -> [Vec3; 2]) {
        if let Some((slice, arrays, _)) = self.slice_parts()
            && let Some(motion) = &slice.motion
        {
            slice.put(arrays, |group| moment(motion, group));
        }
    }

    /// Starts the motion of a slice from displacements and velocities of the nodes, unless it goes on with the same step.
    fn start_slice(&mut self, step: f64) -> Result<(), RunError> {
        let Some((slice, arrays, groups)) = self.slice_parts() else {
            return Ok(());
        };
        if slice
            .motion
            .as_ref()
            .is_some_and(|motion| motion.step == step)
        {
            return Ok(());
        }
        let mut motion = DelayedMotion {
            step,
            momentum: vec![Vec3::zeros(); groups.len()],
            traction: vec![Vec3::zeros(); groups.len()],
            ..DelayedMotion::default()
        };
        for &[low, high] in &slice.sides {
            let [low, high] = [low, high].map(|node| node as usize);
            let [a, b] = [low, high].map(|node| arrays.displacement[node].to_vector());
            let velocity = arrays.velocity[low].to_vector();
            let mut displacement = (a + b) * 0.5;
            displacement.y += 0.5 * step * velocity.y;
            motion.displacement.push(displacement);
            motion.velocity.push(velocity);
        }
        motion.before.clone_from(&motion.velocity);
        slice.motion = Some(motion);
        self.place_slice(DelayedMotion::at_start);
        self.evaluate(ForceTerms::PLAIN, 0.5 * step)?;
        // The forces are those of the start, not of a step.
        self.uncommitted = false;
        let tractions = self.all_forces(|_, _, acting| acting.traction);
        let Some((slice, _, groups)) = self.slice_parts() else {
            return Ok(());
        };
        let slowness = slice.slowness;
        if let Some(motion) = &mut slice.motion {
            let states = motion
                .momentum
                .iter_mut()
                .zip(&motion.velocity)
                .zip(&tractions);
            for (((momentum, velocity), traction), group) in states.zip(groups) {
                *momentum = velocity * group.mass + traction * slowness;
            }
            motion.traction = tractions;
        }
        self.place_slice(DelayedMotion::now);
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
            let spread = slice.lumping.spread(group, |g| motion.velocity[g]);
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
        self.evaluate(terms, 0.5 * step)?;
        // History variables of the half step before are committed now.
        if let Some(slice) = &mut self.delayed {
            slice.lumping.follow_damage(&self.blocks);
        }
        Ok(())
    }

    /// New velocities of x and z of a slice, half a step after the present time.
    pub(crate) fn kick_slice(&mut self, rule: MassDampingRule, step: f64) {
        self.prepared = Some((rule, step));
        self.update_slice(Part::Plane, step);
        self.place_slice(DelayedMotion::centred);
        self.begin_slice_balance(step);
        let Some(motion) = self
            .delayed
            .as_ref()
            .and_then(|slice| slice.motion.as_ref())
        else {
            return;
        };
        let views = self
            .groups
            .motion
            .previous
            .iter_mut()
            .zip(&mut self.groups.motion.next);
        for (group, (previous, next)) in views.enumerate() {
            let (before, after) = (motion.before[group], motion.velocity[group]);
            // The new velocity of y is not known yet: its acceleration is that of the step before.
            let change = 0.5 * (after.y - before.y);
            *previous = Vec3::new(before.x, after.y - change, before.z);
            *next = Vec3::new(after.x, after.y + change, after.z);
        }
    }

    /// Moves x and z of a slice by the step, evaluates the forces half a step after the present time, and updates y.
    pub(crate) fn drift_slice(&mut self, step: f64) {
        let start = self.time;
        if let Some(slice) = &mut self.delayed {
            slice.work.end_plane();
        }
        if let Some(motion) = self
            .delayed
            .as_mut()
            .and_then(|slice| slice.motion.as_mut())
        {
            for (u, v) in motion.displacement.iter_mut().zip(&motion.velocity) {
                u.x += step * v.x;
                u.z += step * v.z;
            }
        }
        self.place_slice(DelayedMotion::half_step_later);
        self.uncommitted = true;
        self.time = start + 0.5 * step;
        let terms = ForceTerms::PLAIN.with_history_update(HistoryUpdate::InPlace);
        let evaluated = self.evaluate(terms, 0.5 * step);
        self.time = start;
        match evaluated {
            Ok(()) => self.update_slice(Part::Axial, step),
            Err(fault) => self.fault = Some(fault),
        }
        if let Some(motion) = self
            .delayed
            .as_mut()
            .and_then(|slice| slice.motion.as_mut())
        {
            for (u, v) in motion.displacement.iter_mut().zip(&motion.velocity) {
                u.y += step * v.y;
            }
        }
        self.place_slice(DelayedMotion::now);
        self.uncommitted = true;
        self.time = start + step;
        self.number += 1;
    }

    /// Updates velocity, momentum and `T` along some axes.
    fn update_slice(&mut self, part: Part, step: f64) {
        let (groups, origin) = (&self.groups.groups, &self.groups.origin);
        let kicked = self.all_forces(|(slice, motion), index, acting| {
            if slice.bare[index] {
                return kick_mass(part, (slice, motion), index, &acting, step);
            }
            let stretch = motion.displacement[index] - origin[index];
            let own = (&groups[index], index);
            kick(part, (slice, motion), own, (&acting, &stretch), step)
        });
        self.add_works(part, &kicked, step);
        let limit = self.speed_limit;
        let sound = kicked
            .iter()
            .all(|k| k.velocity.iter().all(|v| v.abs() <= limit));
        let motion = self
            .delayed
            .as_mut()
            .and_then(|slice| slice.motion.as_mut());
        if let Some(motion) = motion {
            for (g, kicked) in kicked.iter().enumerate() {
                let old = motion.velocity[g];
                part.put(&old, &mut motion.before[g]);
                part.put(&kicked.velocity, &mut motion.velocity[g]);
                part.put(&kicked.momentum, &mut motion.momentum[g]);
                part.other().put(&kicked.traction, &mut motion.traction[g]);
            }
        }
        if !sound && self.fault.is_none() {
            self.place_slice(DelayedMotion::now);
            self.fault = Some(self.divergence());
        }
    }
}

impl Model {
    /// Adds the works of all groups along some axes to the energy balance, if one is open.
    fn add_works(&mut self, part: Part, kicked: &[Kicked], step: f64) {
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
        let is_axial = matches!(part, Part::Axial);
        if !is_axial {
            slice.work.begin_step();
        }
        for (index, kicked) in kicked.iter().enumerate() {
            let applied = sums.on_group(index);
            if slice.bare[index] && applied == Vec3::zeros() {
                continue;
            }
            let stretch = motion.displacement[index] - groups.origin[index];
            let velocities = [part.of(motion.velocity[index]), kicked.velocity];
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
    let velocity = motion.velocity[index];
    let rigidity = slice.lumping.rigidity(index);
    let momentum = motion.momentum[index] + (acting.applied - acting.internal) * step;
    let lag = rigidity.component_mul(&velocity) * s;
    let predicted = traction * 2.0 - motion.traction[index] + lag;
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
    let velocity = motion.velocity[index];
    let before = part.of(velocity);
    let rigidity = slice.lumping.rigidity(index);
    let force = acting.applied - acting.internal - group.gyroscopic * velocity;
    let force = part.of(force - group.spring * part.of(*stretch));
    // Dashpots act on the mean velocity, springs by average acceleration, as everywhere in the engine.
    let damped = |v: &Vec3| part.of(group.dashpot * v + v * group.mass_damping) * (0.5 * step);
    let sprung = |v: &Vec3| part.of(group.spring * v) * (0.25 * step * step);
    let old_momentum = part.of(motion.momentum[index]) + force * step;
    let lag = rigidity.component_mul(&before) * s;
    let predicted = part.of(traction * 2.0 - motion.traction[index]) + lag;
    let right = old_momentum - predicted * s - damped(&before) + sprung(&before);
    let mass = slice.inertia(index);
    let after = solve(part, (group, &mass), (right, slice.held[index]), step);
    let momentum = old_momentum - damped(&(before + after)) - sprung(&(after - before));
    Kicked {
        velocity: after,
        momentum,
        traction,
    }
}

/// Velocity (m/s) along some axes from the impulse (N s) that the inertia (kg) of a group, with dashpots and springs, takes;
/// zero along fixed axes.
fn solve(
    part: Part,
    (group, mass): (&NodeGroup, &Vec3),
    (impulse, held): (Vec3, [bool; 3]),
    step: f64,
) -> Vec3 {
    let (half, quarter) = (0.5 * step, 0.25 * step * step);
    let entry = |i: usize, j: usize| {
        let own = if i == j {
            mass[i] + half * group.mass_damping
        } else {
            0.0
        };
        own + half * group.dashpot[(i, j)] + quarter * group.spring[(i, j)]
    };
    let alone = |i: usize| {
        if held[i] {
            0.0
        } else {
            impulse[i] / entry(i, i)
        }
    };
    match part {
        Part::Axial => Vec3::new(0.0, alone(1), 0.0),
        Part::Plane => {
            let across = entry(0, 2);
            if across == 0.0 || held[0] || held[2] {
                return Vec3::new(alone(0), 0.0, alone(2));
            }
            let (xx, zz) = (entry(0, 0), entry(2, 2));
            let determinant = xx * zz - across * across;
            let x = (zz * impulse.x - across * impulse.z) / determinant;
            let z = (xx * impulse.z - across * impulse.x) / determinant;
            Vec3::new(x, 0.0, z)
        }
    }
}
