//! Ties: groups of nodes with a common motion.

use std::collections::BTreeMap;

use powerhouse_model::{
    Constraint, ConstraintParts, ConstraintWork, DividedConstraint, DividedWork, Mat3, ModelError,
    PredictedMotion, RestrictedConstraint, RunError, Vec3,
};

use crate::ContactError;

/// Constraint that holds the nodes of each pair together.
///
/// Pairs that share nodes form a group. With the effective masses `A_i` of its nodes a group
/// takes the velocity `(sum A_i)^-1 sum A_i v_i*`, and its nodes the displacement that the same
/// mean gives: for one pair this is the impulse `-W^-1 (g/dt + w)`, `W = A_i^-1 + A_j^-1`, of gap
/// `g` and relative predicted velocity `w`. Afterwards the displacements of a group are equal
/// (nodes that started equal stay so to the last bit), and the sum of `A_i v_i` is kept.
///
/// A node held by a support in a direction (its inverse mass is zero there) holds its group; where
/// supports hold two nodes of a group, that of the first one listed is taken.
///
/// Displacements are tied, not positions: a small initial distance of a pair remains.
#[derive(Clone, Debug)]
pub struct TiedPairs {
    name: String,
    nodes: Vec<u32>,
    /// Indices in `nodes`, group after group.
    members: Vec<u32>,
    /// End of each group in `members`.
    ends: Vec<u32>,
    /// The first member of each group, and the work of the group in the last step.
    first: Vec<u32>,
    work: Vec<ConstraintWork>,
}

impl TiedPairs {
    /// Ties between the nodes of each pair (mesh indices), and so between all nodes that pairs connect.
    ///
    /// # Errors
    /// [`ContactError::Empty`] or [`ContactError::SelfPair`], as a [`ModelError::Refused`].
    pub fn new(name: impl Into<String>, pairs: &[[u32; 2]]) -> Result<Self, ModelError> {
        if pairs.is_empty() {
            return Err(ContactError::Empty.into());
        }
        if let Some([node, _]) = pairs.iter().find(|[i, j]| i == j) {
            return Err(ContactError::SelfPair { node: *node }.into());
        }
        Ok(Self::of_groups(
            name.into(),
            &ConstraintParts::connected_by(pairs),
        ))
    }

    fn of_groups(name: String, groups: &ConstraintParts) -> Self {
        let mut nodes = groups.nodes().to_vec();
        nodes.sort_unstable();
        let index: BTreeMap<u32, u32> = nodes.iter().copied().zip(0..).collect();
        let members: Vec<u32> = groups.nodes().iter().map(|node| index[node]).collect();
        let ends = groups.iter().scan(0, |end, group| {
            *end += group.len() as u32;
            Some(*end)
        });
        let first = groups.iter().filter_map(|group| group.first());
        Self {
            name,
            ends: ends.collect(),
            first: first.map(|node| index[node]).collect(),
            work: vec![ConstraintWork::default(); groups.len()],
            nodes,
            members,
        }
    }

    /// Number of groups of nodes with a common motion.
    pub fn group_count(&self) -> usize {
        self.ends.len()
    }
}

impl Constraint for TiedPairs {
    fn name(&self) -> &str {
        &self.name
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn divided(&self) -> Option<&dyn DividedConstraint> {
        Some(self)
    }
    fn restricted(&mut self) -> Option<&mut dyn RestrictedConstraint> {
        Some(self)
    }
    fn ties(&self) -> Vec<[u32; 2]> {
        let mut ties = Vec::new();
        let mut start = 0;
        for &end in &self.ends {
            let group = &self.members[start..end as usize];
            let nodes = group.iter().map(|&member| self.nodes[member as usize]);
            let others = nodes.clone().skip(1);
            ties.extend(nodes.zip(others).map(|(a, b)| [a, b]));
            start = end as usize;
        }
        ties
    }
    fn correct(&mut self, mut motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        let mut total = ConstraintWork::default();
        let mut start = 0;
        for (&end, work) in self.ends.iter().zip(&mut self.work) {
            let impact = join(&self.members[start..end as usize], &mut motion);
            *work = ConstraintWork::default().with_impact(impact);
            total += *work;
            start = end as usize;
        }
        Ok(total)
    }
}

impl DividedConstraint for TiedPairs {
    fn parts(&self) -> ConstraintParts {
        let mut start = 0;
        let groups = self.ends.iter().map(|&end| {
            let group = &self.members[start..end as usize];
            start = end as usize;
            group.iter().map(|&m| self.nodes[m as usize]).collect()
        });
        let groups: Vec<Vec<u32>> = groups.collect();
        ConstraintParts::merged(groups.iter().map(|group| &group[..]))
    }
    fn divided_work(&self) -> Option<DividedWork<'_>> {
        Some(DividedWork {
            nodes: &self.first,
            work: &self.work,
        })
    }
}

impl RestrictedConstraint for TiedPairs {
    fn keep_parts(&mut self, kept: &[bool]) {
        let parts = self.parts();
        let parts = parts.iter().zip(kept).filter(|(_, kept)| **kept);
        let kept = ConstraintParts::merged(parts.map(|(nodes, _)| nodes));
        *self = Self::of_groups(core::mem::take(&mut self.name), &kept);
    }
}

/// Gives the members of one group their common motion; returns the energy lost by it (J).
fn join(members: &[u32], motion: &mut PredictedMotion) -> f64 {
    let mut masses = members.iter().map(|&m| &motion.inverse_mass[m as usize]);
    let (velocity, displacement) = if masses.all(is_diagonal) {
        mean_motion::<Vec3>(members, motion)
    } else {
        mean_motion::<Mat3>(members, motion)
    };
    let after = |motion: &PredictedMotion, member: usize| {
        velocity + (displacement - motion.displacement[member]) / motion.step
    };
    let first = members[0] as usize;
    let together = members[1..].iter().map(|&m| m as usize).all(|member| {
        motion.displacement[member] == motion.displacement[first]
            && motion.previous[member] == motion.previous[first]
    });
    if together {
        // No part of the group has moved against another, and none does now.
        for &member in members {
            motion.velocity[member as usize] = velocity;
        }
        return 0.0;
    }
    let loss = lost_energy(members, motion, |member| after(motion, member));
    for &member in members {
        motion.velocity[member as usize] = after(motion, member as usize);
    }
    loss
}

/// Means of the predicted velocity and of the displacement, weighted by effective mass.
fn mean_motion<B: InverseMass>(members: &[u32], motion: &PredictedMotion) -> (Vec3, Vec3) {
    let first = members[0] as usize;
    let mut inverse_mass = B::from_matrix(&motion.inverse_mass[first]);
    let mut velocity = motion.velocity[first];
    let mut displacement = motion.displacement[first];
    for &member in &members[1..] {
        let member = member as usize;
        let added = B::from_matrix(&motion.inverse_mass[member]);
        let [own, other] = inverse_mass.mean_weights(&added);
        velocity = own.apply(&velocity) + other.apply(&motion.velocity[member]);
        displacement += other.apply(&(motion.displacement[member] - displacement));
        inverse_mass = other.times(&added);
    }
    (velocity, displacement)
}

/// Inverse effective mass, or a weight made of such: a matrix, or the diagonal of one.
trait InverseMass: Sized {
    fn from_matrix(matrix: &Mat3) -> Self;
    fn apply(&self, vector: &Vec3) -> Vec3;
    fn times(&self, other: &Self) -> Self;
    /// Weights of the mean of two velocities by effective mass: with inverse masses `B1`,
    /// `B2` and `W = B1 + B2` they are `B2 W^-1` and `B1 W^-1`. Where neither can move the first
    /// is taken.
    fn mean_weights(&self, other: &Self) -> [Self; 2];
}

impl InverseMass for Vec3 {
    #[inline(always)]
    fn from_matrix(matrix: &Mat3) -> Self {
        matrix.diagonal()
    }
    #[inline(always)]
    fn apply(&self, vector: &Vec3) -> Vec3 {
        self.component_mul(vector)
    }
    #[inline(always)]
    fn times(&self, other: &Self) -> Self {
        self.component_mul(other)
    }
    #[inline(always)]
    fn mean_weights(&self, other: &Self) -> [Self; 2] {
        let sum = self + other;
        let share = |part: f64, whole: f64, held: f64| {
            if whole > 0.0 { part / whole } else { held }
        };
        [
            other.zip_map(&sum, |part, whole| share(part, whole, 1.0)),
            self.zip_map(&sum, |part, whole| share(part, whole, 0.0)),
        ]
    }
}

impl InverseMass for Mat3 {
    fn from_matrix(matrix: &Mat3) -> Self {
        *matrix
    }
    fn apply(&self, vector: &Vec3) -> Vec3 {
        self * vector
    }
    fn times(&self, other: &Self) -> Self {
        self * other
    }
    fn mean_weights(&self, other: &Self) -> [Self; 2] {
        let (inverse, held) = pseudo_inverse(&(self + other));
        [other * inverse + held, self * inverse]
    }
}

/// Work that the impulses `p_i = A_i (v_i+ - v_i*)` of a group take from the body,
/// `-sum p_i . (v_i- + v_i+)/2` (J).
///
/// The impulses add up to zero, so motion may be taken relative to the member of the greatest
/// mass: if a support holds it, its own impulse is not known and not needed.
fn lost_energy(members: &[u32], motion: &PredictedMotion, after: impl Fn(usize) -> Vec3) -> f64 {
    let mobility = |member: &usize| motion.inverse_mass[*member].trace();
    let mean = |member: usize| 0.5 * (motion.previous[member] + after(member));
    let all = || members.iter().map(|&member| member as usize);
    let Some(anchor) = all().min_by(|a, b| mobility(a).total_cmp(&mobility(b))) else {
        return 0.0;
    };
    let work = all().filter(|&member| member != anchor).map(|member| {
        let mass = pseudo_inverse(&motion.inverse_mass[member]).0;
        let impulse = mass * (after(member) - motion.velocity[member]);
        impulse.dot(&(mean(member) - mean(anchor)))
    });
    -work.sum::<f64>()
}

fn is_diagonal(matrix: &Mat3) -> bool {
    [(0, 1), (1, 2), (0, 2)]
        .iter()
        .all(|&entry| matrix[entry] == 0.0)
}

/// Pseudo-inverse of a symmetric positive semi-definite matrix, and the projector on its null space.
fn pseudo_inverse(matrix: &Mat3) -> (Mat3, Mat3) {
    // One factorisation where it can be had; only held directions need eigenvectors.
    if let Some(inverse) = matrix.try_inverse()
        && inverse.amax() * matrix.amax() < 1.0e8
    {
        return (inverse, Mat3::zeros());
    }
    let eigen = matrix.symmetric_eigen();
    let least = 1.0e-12 * eigen.eigenvalues.amax();
    let mut inverse = Mat3::zeros();
    let mut held = Mat3::zeros();
    for (value, vector) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        let projector = vector * vector.transpose();
        if *value > least {
            inverse += projector / *value;
        } else {
            held += projector;
        }
    }
    (inverse, held)
}

#[cfg(test)]
mod tests {
    use super::*;
    use powerhouse_model::StepTime;

    /// Group of nodes with all input of a constraint.
    #[derive(Clone)]
    struct Nodes {
        displacement: Vec<Vec3>,
        previous: Vec<Vec3>,
        velocity: Vec<Vec3>,
        inverse_mass: Vec<Mat3>,
    }

    impl Nodes {
        /// Nodes in some motion of their own, with these effective masses.
        fn moving(masses: &[Mat3]) -> Self {
            let wave = |i: usize, phase: f64| {
                let angle = 2.3 * i as f64 + phase;
                Vec3::new(angle.sin(), (1.7 * angle).cos(), (0.6 * angle).sin())
            };
            let count = masses.len();
            Self {
                displacement: (0..count).map(|i| 1.0e-3 * wave(i, 0.3)).collect(),
                previous: (0..count).map(|i| wave(i, 0.9)).collect(),
                velocity: (0..count).map(|i| wave(i, 1.1)).collect(),
                inverse_mass: masses
                    .iter()
                    .map(|mass| mass.try_inverse().unwrap())
                    .collect(),
            }
        }
        fn correct(&mut self, tie: &mut TiedPairs, step: f64) -> ConstraintWork {
            tie.correct(PredictedMotion::new(
                StepTime {
                    number: 0,
                    time: 0.0,
                    step,
                },
                &self.displacement,
                &self.previous,
                &mut self.velocity,
                &self.inverse_mass,
            ))
            .unwrap()
        }
        /// The largest distance of two nodes after a step.
        fn gap_after(&self, step: f64) -> f64 {
            let end = |i: usize| self.displacement[i] + step * self.velocity[i];
            (1..self.velocity.len())
                .map(|i| (end(i) - end(0)).norm())
                .fold(0.0, f64::max)
        }
    }

    fn momentum(masses: &[Mat3], velocity: &[Vec3]) -> Vec3 {
        masses.iter().zip(velocity).map(|(m, v)| m * v).sum()
    }

    fn isotropic(masses: &[f64]) -> Vec<Mat3> {
        masses.iter().map(|&m| m * Mat3::identity()).collect()
    }

    /// A mass of 2 kg whose dashpot is at an angle.
    fn oblique() -> Mat3 {
        let normal = Vec3::new(1.0, 2.0, -0.5).normalize();
        2.0 * Mat3::identity() + 11.0 * normal * normal.transpose()
    }

    /// A pair closes its gap to round-off and keeps the sum of effective mass times velocity, for
    /// mass ratios from 1e-6 to 1e6.
    #[test]
    fn a_pair_closes_for_any_mass_ratio() {
        let step = 1.0e-3;
        for ratio in [1.0e-6, 1.0e-3, 0.5, 1.0, 7.0, 1.0e3, 1.0e6] {
            let masses = isotropic(&[3.0, 3.0 * ratio]);
            let start = Nodes::moving(&masses);
            let mut nodes = start.clone();
            let mut tie = TiedPairs::new("tie", &[[0, 1]]).unwrap();
            nodes.correct(&mut tie, step);
            assert!(nodes.gap_after(step) < 1e-15 * 8.0 * start.gap_after(step).max(1e-3));
            let before = momentum(&masses, &start.velocity);
            let scale = masses.iter().map(|m| m[(0, 0)]).sum::<f64>();
            let change = momentum(&masses, &nodes.velocity) - before;
            assert!(change.norm() < 4e-15 * scale, "ratio {ratio}: {change}");
        }
    }

    /// Nodes with the same displacement and past get the same velocity to the last bit, so that
    /// a bond never drifts; this costs no energy.
    #[test]
    fn a_closed_pair_never_drifts() {
        let mut nodes = Nodes::moving(&[Mat3::identity(), oblique()]);
        nodes.displacement[1] = nodes.displacement[0];
        nodes.previous[1] = nodes.previous[0];
        let mut tie = TiedPairs::new("tie", &[[0, 1]]).unwrap();
        let work = nodes.correct(&mut tie, 1.0e-3);
        assert_eq!(nodes.velocity[0], nodes.velocity[1]);
        assert_eq!(work, ConstraintWork::default());
    }

    /// Where a dashpot makes an effective mass a full matrix the pair closes as well and keeps
    /// the sum of `A v`.
    #[test]
    fn a_pair_at_an_oblique_dashpot_closes() {
        let masses = [5.0 * Mat3::identity(), oblique()];
        let start = Nodes::moving(&masses);
        let mut nodes = start.clone();
        let mut tie = TiedPairs::new("tie", &[[0, 1]]).unwrap();
        nodes.correct(&mut tie, 1.0e-3);
        assert!(nodes.gap_after(1.0e-3) < 1e-14 * start.gap_after(1.0e-3));
        let change = momentum(&masses, &nodes.velocity) - momentum(&masses, &start.velocity);
        assert!(change.norm() < 1e-14 * 20.0);
    }

    /// Pairs that share nodes, listed as a chain with a light node in the middle, end with one
    /// common velocity, the mean by mass.
    #[test]
    fn a_group_takes_its_common_velocity_at_once() {
        let masses = isotropic(&[1.0, 1.0e-6, 1.0, 4.0]);
        let mut nodes = Nodes::moving(&masses);
        nodes.displacement.fill(Vec3::new(1.0, 2.0, 3.0));
        let mean = momentum(&masses, &nodes.velocity) / 6.000001;
        let mut tie = TiedPairs::new("tie", &[[1, 0], [1, 2], [3, 2]]).unwrap();
        assert_eq!(tie.group_count(), 1);
        nodes.correct(&mut tie, 1.0e-3);
        for velocity in &nodes.velocity {
            assert_eq!(velocity, &nodes.velocity[0]);
            assert!((velocity - mean).norm() < 4e-15);
        }
    }

    /// Groups that share no node leave each other alone.
    #[test]
    fn separate_pairs_stay_separate() {
        let masses = isotropic(&[1.0, 2.0, 3.0, 4.0]);
        let start = Nodes::moving(&masses);
        let mut both = start.clone();
        let mut tie = TiedPairs::new("tie", &[[0, 2], [3, 1]]).unwrap();
        assert_eq!(tie.group_count(), 2);
        assert_eq!(tie.nodes(), [0, 1, 2, 3]);
        both.correct(&mut tie, 1.0e-3);
        for [i, j] in [[0, 2], [1, 3]] {
            let of = |values: &[Vec3]| vec![values[i], values[j]];
            let mut alone = Nodes {
                displacement: of(&start.displacement),
                previous: of(&start.previous),
                velocity: of(&start.velocity),
                inverse_mass: vec![start.inverse_mass[i], start.inverse_mass[j]],
            };
            let mut pair = TiedPairs::new("pair", &[[0, 1]]).unwrap();
            alone.correct(&mut pair, 1.0e-3);
            assert_eq!(alone.velocity, of(&both.velocity));
        }
    }

    /// A node that a support holds holds its partner, in the directions in which it is held and
    /// in no other.
    #[test]
    fn a_held_node_holds_its_partner() {
        let mut nodes = Nodes::moving(&isotropic(&[2.0, 3.0]));
        nodes.displacement[1] = nodes.displacement[0];
        nodes.inverse_mass[0][(2, 2)] = 0.0;
        nodes.velocity[0].z = 0.0;
        let free = (2.0 * nodes.velocity[0] + 3.0 * nodes.velocity[1]) / 5.0;
        let mut tie = TiedPairs::new("tie", &[[0, 1]]).unwrap();
        nodes.correct(&mut tie, 1.0e-3);
        assert_eq!(nodes.velocity[0], nodes.velocity[1]);
        assert_eq!(nodes.velocity[0].z, 0.0);
        assert!((nodes.velocity[0].xy() - free.xy()).norm() < 1e-15);
        // Both moved by their supports: nothing to do, and no division by zero.
        let moved = Vec3::new(0.1, 0.2, 0.3);
        nodes.inverse_mass = vec![Mat3::zeros(); 2];
        nodes.velocity = vec![moved; 2];
        nodes.correct(&mut tie, 1.0e-3);
        assert_eq!(nodes.velocity, [moved; 2]);
    }

    /// Two masses that meet lose `m1 m2 / (m1 + m2) (v1 - v2)^2 / 2`, and the loss is reported.
    #[test]
    fn the_loss_of_an_impact_is_reported() {
        let masses = isotropic(&[2.0, 6.0]);
        let mut nodes = Nodes::moving(&masses);
        nodes.displacement[1] = nodes.displacement[0];
        nodes.velocity = nodes.previous.clone();
        let meeting = nodes.velocity[1] - nodes.velocity[0];
        let mut tie = TiedPairs::new("tie", &[[0, 1]]).unwrap();
        let work = nodes.correct(&mut tie, 1.0e-3);
        let expected = 0.5 * 1.5 * meeting.norm_squared();
        assert!((work.impact - expected).abs() < 1e-14 * expected);
    }

    /// No pairs, or a node tied to itself, are refused before a run.
    #[test]
    fn senseless_pairs_are_refused() {
        assert!(TiedPairs::new("none", &[]).is_err());
        let error = TiedPairs::new("self", &[[0, 1], [4, 4]]).unwrap_err();
        assert!(error.to_string().contains("index 4"), "{error}");
    }
}
