//! The operations of a step of a slice whose elements are all linear: one evaluation of them in a step.

use powerhouse_model::{ForceTerms, Quad, RunError, Vec3};
use rayon::prelude::*;

use super::{DelayedSlice, Part};
use crate::Model;
use crate::gather::CHUNK;
use crate::node_group::NodeGroup;
use crate::nodes::Nodes;
use crate::profile::Phase;

impl DelayedSlice {
    /// Computes the coefficients of groups without dashpot, spring and damping for a length of step (s), unless they are in use.
    fn prepare(&mut self, step: f64) {
        let gain = (0..self.sides.len()).map(|group| {
            let inertia = self.inertia(group);
            let moves = |axis: usize| self.mass[group] > 0.0 && !self.held[group][axis];
            core::array::from_fn(|axis| {
                if moves(axis) {
                    step / inertia[axis]
                } else {
                    0.0
                }
            })
        });
        if self.coupling.gain.0 != step {
            self.coupling.gain = (step, gain.collect());
        }
    }
}

impl Model {
    /// Forces of the elements, with x and z at the present time and y half a step later, and loads at the present time.
    pub(super) fn linear_forces(&mut self, terms: ForceTerms, step: f64) -> Result<(), RunError> {
        if let Some((slice, arrays, _)) = self.slice_parts() {
            slice.prepare(step);
            if let Some(motion) = &slice.motion {
                let (plane, axial) = (&motion.plane.displacement, &motion.axial.displacement);
                arrays
                    .displacement
                    .par_chunks_mut(CHUNK)
                    .zip(slice.place.par_chunks(CHUNK))
                    .for_each(|(displacement, place)| {
                        for (displacement, &(group, _)) in displacement.iter_mut().zip(place) {
                            let [x, z] = plane[group as usize];
                            *displacement = Quad::new(x, axial[group as usize], z);
                        }
                    });
            }
        }
        self.evaluate(terms, self.present_step(step))
    }

    /// New velocities of x and z.
    pub(super) fn kick_plane(&mut self, step: f64) {
        let limit = self.speed_limit;
        let (groups, origin) = (&self.groups.groups, &self.groups.origin);
        let (sums, slots) = (&self.loads.sums, &self.subdomain.slots);
        let (Some(slice), Nodes::F64(arrays)) = (&mut self.delayed, &self.nodes) else {
            return;
        };
        let (Some(motion), coupling) = (&mut slice.motion, &mut slice.coupling) else {
            return;
        };
        let (sides, free) = (&slice.sides, &slice.free);
        let (bare, held) = (&slice.bare, &slice.held);
        let (mass, lumping, s) = (&slice.mass, &slice.lumping, slice.slowness);
        let mut force = core::mem::take(&mut coupling.force);
        let known = &*coupling;
        let gain = &known.gain.1;
        let axial = &motion.axial.velocity;
        let plane = &mut motion.plane;
        let (old, displacement) = (&plane.velocity, &plane.displacement);
        let sound = plane
            .before
            .par_chunks_mut(CHUNK)
            .zip(force.par_chunks_mut(CHUNK))
            .enumerate()
            .map(|(chunk, (new, force))| {
                let mut sound = true;
                for (group, (new, force)) in (chunk * CHUNK..).zip(new.iter_mut().zip(force)) {
                    // Plain numbers: builds of the least optimisation spend half of a step in vectors.
                    let [mut x, mut y, mut z] = [0.0; 3];
                    for node in sides[group] {
                        for slot in slots.of(node as usize) {
                            let values = &arrays.forces[*slot as usize].values;
                            x -= values[0];
                            y += values[1];
                            z -= values[2];
                        }
                    }
                    *force = y;
                    let turned = known.across(group, axial);
                    x -= turned[0];
                    z -= turned[1];
                    if !free[group] {
                        let applied = sums.on_group(group);
                        x += applied.x;
                        z += applied.z;
                    }
                    let before = old[group];
                    *new = if bare[group] {
                        let gain = &gain[group];
                        [before[0] + gain[0] * x, before[1] + gain[2] * z]
                    } else {
                        let [u_x, u_z] = displacement[group];
                        let stretch = Vec3::new(u_x, 0.0, u_z) - Part::Plane.of(origin[group]);
                        let inertia = inertia_of(mass[group], lumping.rigidity(group), s);
                        let own = Inert {
                            group: &groups[group],
                            inertia,
                            held: held[group],
                        };
                        let before = Vec3::new(before[0], 0.0, before[1]);
                        let force = Vec3::new(x, 0.0, z);
                        let new = linear(Part::Plane, own, (force, stretch), before, step);
                        [new.x, new.z]
                    };
                    sound &= new[0].abs() <= limit && new[1].abs() <= limit;
                }
                sound
            })
            .reduce(|| true, |a, b| a && b);
        core::mem::swap(&mut plane.before, &mut plane.velocity);
        coupling.force = force;
        self.end_update(Part::Plane, sound, step);
    }

    /// New velocities of y, with loads half a step after the present time.
    pub(super) fn kick_axial(&mut self, step: f64) {
        let start = self.clock();
        let spent = self.profiler.as_deref().map(|profile| &profile.loads);
        self.loads.evaluate(self.time, spent);
        let limit = self.speed_limit;
        let (groups, origin, sums) = (&self.groups.groups, &self.groups.origin, &self.loads.sums);
        let Some(slice) = &mut self.delayed else {
            return;
        };
        let (Some(motion), coupling) = (&mut slice.motion, &slice.coupling) else {
            return;
        };
        let (bare, free, held) = (&slice.bare, &slice.free, &slice.held);
        let (mass, lumping, s) = (&slice.mass, &slice.lumping, slice.slowness);
        let (gain, plane) = (&coupling.gain.1, &motion.plane.velocity);
        let axial = &mut motion.axial;
        let (old, displacement) = (&axial.velocity, &axial.displacement);
        let sound = axial
            .before
            .par_chunks_mut(CHUNK)
            .enumerate()
            .map(|(chunk, new)| {
                let mut sound = true;
                for (group, new) in (chunk * CHUNK..).zip(new) {
                    let mut force = -coupling.force[group] - coupling.along(group, plane);
                    if !free[group] {
                        force += sums.on_group(group).y;
                    }
                    *new = if bare[group] {
                        old[group] + gain[group][1] * force
                    } else {
                        let stretch = displacement[group] - origin[group].y;
                        let inertia = inertia_of(mass[group], lumping.rigidity(group), s);
                        let own = Inert {
                            group: &groups[group],
                            inertia,
                            held: held[group],
                        };
                        let vectors = [force, stretch, old[group]].map(|y| y * Vec3::y());
                        let [force, stretch, before] = vectors;
                        linear(Part::Axial, own, (force, stretch), before, step).y
                    };
                    sound &= new.abs() <= limit;
                }
                sound
            })
            .reduce(|| true, |a, b| a && b);
        core::mem::swap(&mut axial.before, &mut axial.velocity);
        self.end_update(Part::Axial, sound, step);
        self.spent(Phase::Nodes, start);
    }
}

/// A group with its inertia (kg) along each axis, and which axes are fixed.
#[derive(Clone, Copy)]
pub(super) struct Inert<'a> {
    pub(super) group: &'a NodeGroup,
    pub(super) inertia: Vec3,
    pub(super) held: [bool; 3],
}

/// Inertia of a group (kg) along each axis, `M - s^2 A`, from mass and `A`.
pub(super) fn inertia_of(mass: f64, rigidity: Vec3, slowness: f64) -> Vec3 {
    Vec3::repeat(mass) - rigidity * (slowness * slowness)
}

/// New velocity (m/s) of a group along some axes, from its force without dashpot and spring (N), the elongation of the spring (m) and
/// the velocity before; all have components along these axes alone.
fn linear(part: Part, own: Inert, (force, stretch): (Vec3, Vec3), before: Vec3, step: f64) -> Vec3 {
    if own.group.mass <= 0.0 {
        return Vec3::zeros();
    }
    let force = force - part.of(own.group.spring * stretch);
    let impulse = own.inertia.component_mul(&before) + force * step;
    let [velocity, _] = kicked(part, own, (impulse, before), step);
    velocity
}

/// New velocity (m/s) of a group along some axes, from the impulse (N s) that its inertia (kg) would take alone and the velocity
/// before; with the impulse that dashpots, springs and mass damping take.
pub(super) fn kicked(
    part: Part,
    own: Inert,
    (impulse, before): (Vec3, Vec3),
    step: f64,
) -> [Vec3; 2] {
    let group = own.group;
    // Dashpots act on the mean velocity, springs by average acceleration, as everywhere in the engine.
    let damped = |v: &Vec3| part.of(group.dashpot * v + v * group.mass_damping) * (0.5 * step);
    let sprung = |v: &Vec3| part.of(group.spring * v) * (0.25 * step * step);
    let right = impulse - damped(&before) + sprung(&before);
    let after = solve(part, own, right, step);
    [after, damped(&(before + after)) + sprung(&(after - before))]
}

/// Velocity (m/s) along some axes from the impulse (N s) that the inertia (kg) of a group, with dashpots and springs, takes;
/// zero along fixed axes.
fn solve(part: Part, own: Inert, impulse: Vec3, step: f64) -> Vec3 {
    let Inert {
        group,
        inertia,
        held,
    } = own;
    let (half, quarter) = (0.5 * step, 0.25 * step * step);
    let entry = |i: usize, j: usize| {
        let own = if i == j {
            inertia[i] + half * group.mass_damping
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
