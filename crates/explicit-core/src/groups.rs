//! Nodes that need more than a mass: impedances, supports, prescribed motion, ties, constraints.

use core::ops::Range;

use powerhouse_model::{MassDampingRule, Mat3, Vec3};

use rayon::prelude::*;

use crate::gather::{CHUNK, SlotTable};
use crate::nodes::{NodalArrays, Storage};
use crate::support::Condition;

/// What a group of nodes that move as one has. Most groups have one member.
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    /// Engine nodes, the lead first.
    pub(crate) members: Vec<u32>,
    /// Mass (kg).
    pub(crate) mass: f64,
    /// Mass damping (kg/s).
    pub(crate) mass_damping: f64,
    /// Dashpot to the ground (N s/m).
    pub(crate) dashpot: Mat3,
    /// Spring to the ground (N/m).
    pub(crate) spring: Mat3,
    /// Directions in which the motion is held or prescribed.
    pub(crate) condition: Condition,
}

/// The matrices of one step, `A = M + dt/2 C + dt^2/4 K`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coefficients {
    /// New velocity per old velocity: `P (M - dt/2 C + dt^2/4 K)`.
    pub(crate) carry: Mat3,
    /// `P`, the inverse of `A` in the free directions, zero in the held ones (1/kg).
    pub(crate) inverse: Mat3,
    /// Velocity along the condition's directions to the velocity of the node.
    pub(crate) lift: Mat3,
}

impl Group {
    /// Effective mass `A` and the factor of the old velocity (kg).
    pub(crate) fn effective(&self, rule: MassDampingRule, step: f64) -> (Mat3, Mat3) {
        let spring = self.spring * (0.25 * step * step);
        let half = self.dashpot * (0.5 * step);
        let mass = Mat3::identity() * self.mass;
        let damping = Mat3::identity() * (self.mass_damping * step);
        match rule {
            MassDampingRule::Implicit => (
                mass + half + damping * 0.5 + spring,
                mass - half - damping * 0.5 + spring,
            ),
            MassDampingRule::Lagged => (mass + half + spring, mass - half - damping + spring),
        }
    }

    fn coefficients(&self, rule: MassDampingRule, step: f64) -> Coefficients {
        let (effective, old) = self.effective(rule, step);
        // Symmetric positive definite: mass is positive, damping and spring are not negative.
        let inverse = effective.try_inverse().unwrap_or_else(Mat3::zeros);
        let (inverse, lift) = self.condition.project(&inverse);
        Coefficients {
            carry: inverse * old,
            inverse,
            lift,
        }
    }
}

/// What the pass over all nodes needs to know of the groups.
#[derive(Default)]
pub(crate) struct GroupMotion {
    /// Node and group, in rising order of nodes.
    members: Vec<(u32, u32)>,
    /// Members in each chunk of nodes.
    chunks: Vec<Range<u32>>,
    /// Velocity before the step (m/s), by group.
    pub(crate) previous: Vec<Vec3>,
    /// Velocity after the step (m/s), by group.
    pub(crate) next: Vec<Vec3>,
}

impl GroupMotion {
    fn new(groups: &[Group], node_count: usize) -> Self {
        let mut members: Vec<(u32, u32)> = groups
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
            previous: vec![Vec3::zeros(); groups.len()],
            next: vec![Vec3::zeros(); groups.len()],
        }
    }

    /// Node and group of the members in a chunk of nodes.
    #[inline]
    pub(crate) fn members_in(&self, chunk: usize) -> &[(u32, u32)] {
        let range = &self.chunks[chunk];
        &self.members[range.start as usize..range.end as usize]
    }
}

/// What the kick of a group needs if all its matrices are diagonal and it has one member, as
/// on the faces of a box: a line and a half of cache instead of eight.
#[derive(Clone, Copy, Debug)]
struct Light {
    lead: u32,
    diagonal: bool,
    carry: Vec3,
    /// `P` times the step (s/kg).
    response: Vec3,
    spring: Vec3,
}

impl Light {
    fn new(group: &Group, matrices: &Coefficients, step: f64) -> Self {
        let is_diagonal = |m: &Mat3| *m == Mat3::from_diagonal(&m.diagonal());
        let all = [&matrices.carry, &matrices.inverse, &group.spring];
        Self {
            lead: group.members[0],
            diagonal: group.members.len() == 1 && all.into_iter().all(is_diagonal),
            carry: matrices.carry.diagonal(),
            response: matrices.inverse.diagonal() * step,
            spring: group.spring.diagonal(),
        }
    }
}

/// All groups of a model, with the matrices of the step in use.
#[derive(Default)]
pub(crate) struct Groups {
    pub(crate) groups: Vec<Group>,
    pub(crate) motion: GroupMotion,
    pub(crate) coefficients: Vec<Coefficients>,
    light: Vec<Light>,
    /// Displacement (m) from which the springs are measured.
    pub(crate) origin: Vec<Vec3>,
    /// Groups with a prescribed motion.
    pub(crate) driven: Vec<u32>,
}

impl Groups {
    pub(crate) fn new(groups: Vec<Group>, node_count: usize) -> Self {
        Self {
            motion: GroupMotion::new(&groups, node_count),
            coefficients: Vec::new(),
            light: Vec::new(),
            origin: vec![Vec3::zeros(); groups.len()],
            driven: (0..groups.len() as u32)
                .filter(|&g| !groups[g as usize].condition.prescribed.is_empty())
                .collect(),
            groups,
        }
    }

    /// Prepares the matrices of a step.
    pub(crate) fn prepare(&mut self, rule: MassDampingRule, step: f64) {
        self.coefficients = self
            .groups
            .par_iter()
            .map(|group| group.coefficients(rule, step))
            .collect();
        self.light = (self.groups.iter().zip(&self.coefficients))
            .map(|(group, matrices)| Light::new(group, matrices, step))
            .collect();
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
            light,
            origin,
            ..
        } = self;
        motion
            .next
            .par_iter_mut()
            .zip(&mut motion.previous)
            .zip(light)
            .zip(origin)
            .enumerate()
            .with_min_len(256)
            .for_each(|(g, (((next, previous), light), origin))| {
                let lead = light.lead as usize;
                let mut force = applied(g) - arrays.internal(slots, lead);
                let stretch = arrays.displacement[lead].to_vector() - *origin;
                *previous = arrays.velocity[lead].to_vector();
                if light.diagonal {
                    force -= light.spring.component_mul(&stretch);
                    *next =
                        light.carry.component_mul(previous) + light.response.component_mul(&force);
                } else {
                    let (group, matrices) = (&groups[g], &coefficients[g]);
                    for &node in &group.members[1..] {
                        force -= arrays.internal(slots, node as usize);
                    }
                    force -= group.spring * stretch;
                    *next = matrices.carry * *previous + matrices.inverse * (force * step);
                }
            });
    }

    /// Adds the prescribed motion: `displacement` gives the value of each motion (m) at the end
    /// of the step, `present` the displacement of a node now.
    pub(crate) fn drive(
        &mut self,
        displacement: &[f64],
        present: impl Fn(usize) -> Vec3,
        step: f64,
    ) {
        for &g in &self.driven {
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
