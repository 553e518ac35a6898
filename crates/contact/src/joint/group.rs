//! Pairs that share nodes, or whose effective masses differ between directions.

use nalgebra::{DMatrix, DVector};
use powerhouse_model::{
    ConstraintWork, ContactLaw, JointPair, JointRecord, Mat3, PredictedMotion, Vec3,
};

use super::account::{PairStep, book};
use super::isolated::held_back;
use super::matrices::Matrices;
use super::solve::{Contact, Effort, solve};
use super::{Laws, Side};

/// Pairs connected by nodes.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// Places among the joint's pairs.
    pairs: Vec<u32>,
    /// Places of their nodes among the joint's.
    nodes: Vec<[u32; 2]>,
    /// Inverse effective masses of those (1/kg).
    inverse_mass: Vec<[Mat3; 2]>,
    /// Relative velocity per impulse, `G` (1/kg).
    coupling: DMatrix<f64>,
    matrices: Matrices,
    /// Pairs in an order in which each but the first hangs on an earlier one, and which node of
    /// each follows the other one.
    branches: Vec<Branch>,
}

/// A pair whose second node follows the first where all pairs of its group stick.
#[derive(Clone, Copy, Debug)]
struct Branch {
    /// Place among the group's pairs.
    pair: u32,
    /// Which of its nodes follows: 0 or 1.
    follower: u8,
}

impl Group {
    /// A group of pairs with the places of their nodes.
    pub(super) fn new(pairs: Vec<u32>, nodes: Vec<[u32; 2]>) -> Self {
        let none = DMatrix::zeros(0, 0);
        Self {
            inverse_mass: Vec::new(),
            matrices: Matrices::new(&none, &[]),
            coupling: none,
            branches: Vec::new(),
            pairs,
            nodes,
        }
    }

    /// How many pairs it has.
    pub(super) fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    /// Takes the inverse effective masses of all nodes of the joint.
    pub(super) fn prepare(&mut self, pairs: &[JointPair], inverse_mass: &[Mat3]) {
        let of = |node: u32| inverse_mass[node as usize];
        self.inverse_mass = self.nodes.iter().map(|nodes| nodes.map(of)).collect();
        let frames: Vec<Mat3> = (self.pairs.iter())
            .map(|&pair| {
                let pair = &pairs[pair as usize];
                let second = pair.normal.cross(&pair.tangent);
                Mat3::from_columns(&[pair.normal, pair.tangent, second]).transpose()
            })
            .collect();
        let count = self.pairs.len();
        let mut coupling = DMatrix::zeros(3 * count, 3 * count);
        for (a, own) in self.nodes.iter().enumerate() {
            for (b, other) in self.nodes.iter().enumerate() {
                let mut sum = Mat3::zeros();
                for (i, node) in own.iter().enumerate() {
                    for j in (0..2).filter(|&j| other[j] == *node) {
                        let sign = if i == j { 1.0 } else { -1.0 };
                        sum += of(*node) * sign;
                    }
                }
                let block = frames[a] * sum * frames[b].transpose();
                coupling.view_mut((3 * a, 3 * b), (3, 3)).copy_from(&block);
            }
        }
        for a in 0..count {
            // A direction in which supports hold both nodes; what is left there is rounding.
            let trace: f64 = (3 * a..3 * a + 3).map(|row| coupling[(row, row)]).sum();
            for row in 3 * a..3 * a + 3 {
                if coupling[(row, row)] < 1e-12 * trace {
                    coupling.row_mut(row).fill(0.0);
                    coupling.column_mut(row).fill(0.0);
                }
            }
        }
        self.coupling = coupling;
        self.matrices = Matrices::new(&self.coupling, &vec![true; count]);
        self.branches = branches(
            &self.nodes,
            |node| of(node).trace(),
            |node| movable(&of(node)),
        );
    }

    /// Corrects the motion of the group's nodes; returns what it took.
    ///
    /// # Errors
    /// What was left after the most sweeps.
    pub(super) fn correct<L: ContactLaw>(
        &mut self,
        laws: &Laws<L>,
        (pairs, sides): (&[JointPair], &[Side]),
        records: &mut [JointRecord],
        motion: &mut PredictedMotion,
        work: &mut ConstraintWork,
    ) -> Result<Effort, Effort> {
        let count = self.pairs.len();
        let (rate, step) = (1.0 / motion.step, motion.step);
        let (mut excess, mut impulses) = (DVector::zeros(3 * count), DVector::zeros(3 * count));
        let mut offsets = Vec::with_capacity(count);
        let mut before = Vec::with_capacity(count);
        let mut contacts = Vec::with_capacity(count);
        for (a, (&index, nodes)) in self.pairs.iter().zip(&self.nodes).enumerate() {
            let index = index as usize;
            let (pair, side, record) = (&pairs[index], &sides[index], &records[index]);
            let mut offset = pair.to_local(&relative(motion.displacement, nodes));
            offset.x += side.gap;
            offset -= side.origin;
            let hold = held_back(&offset, record) * rate;
            let wanted = pair.to_local(&relative(motion.velocity, nodes)) + hold;
            excess.fixed_rows_mut::<3>(3 * a).copy_from(&wanted);
            // Where the last step left the impulses is a good start.
            let per_traction = pair.projected_area * step;
            let start = (record.traction - side.preload) * per_traction;
            impulses.fixed_rows_mut::<3>(3 * a).copy_from(&start);
            let law = laws.of(index);
            contacts.push(Contact::new(law, record.state, side.preload, per_traction));
            before.push(pair.to_local(&relative(motion.previous, nodes)));
            offsets.push((offset, hold));
        }
        let matrices = &mut self.matrices;
        let effort = solve(
            &self.coupling,
            matrices,
            &mut contacts,
            &excess,
            &mut impulses,
        )?;

        self.apply(&impulses, pairs, motion);
        if contacts.iter().all(|contact| contact.held) {
            self.align(&offsets, pairs, motion);
        }
        for (a, nodes) in self.nodes.iter().enumerate() {
            let index = self.pairs[a] as usize;
            let (pair, contact) = (&pairs[index], &contacts[a]);
            let traction = contact.traction(&impulses.fixed_rows::<3>(3 * a).into_owned());
            let step = PairStep {
                time: motion.time,
                length: step,
                area: pair.projected_area,
                preload: contact.preload,
                offset: offsets[a].0,
                before: before[a],
                after: pair.to_local(&relative(motion.velocity, nodes)),
                state: contact.outcome(&traction),
                traction,
            };
            book(&mut records[index], &step, work);
        }
        Ok(effort)
    }

    /// Changes velocities by the impulses.
    fn apply(&self, impulses: &DVector<f64>, pairs: &[JointPair], motion: &mut PredictedMotion) {
        for (a, nodes) in self.nodes.iter().enumerate() {
            let local: Vec3 = impulses.fixed_rows::<3>(3 * a).into_owned();
            let impulse = pairs[self.pairs[a] as usize].to_global(&local);
            let [first, second] = &self.inverse_mass[a];
            motion.velocity[nodes[0] as usize] += first * impulse;
            motion.velocity[nodes[1] as usize] -= second * impulse;
        }
    }

    /// Gives nodes that all stick together the same velocity to the last bit.
    fn align(&self, offsets: &[(Vec3, Vec3)], pairs: &[JointPair], motion: &mut PredictedMotion) {
        for branch in &self.branches {
            let a = branch.pair as usize;
            let [first, second] = self.nodes[a].map(|node| node as usize);
            let after = -pairs[self.pairs[a] as usize].to_global(&offsets[a].1);
            if branch.follower == 1 {
                motion.velocity[second] = motion.velocity[first] + after;
            } else {
                motion.velocity[first] = motion.velocity[second] - after;
            }
        }
    }
}

/// The second node's value less the first's.
fn relative(values: &[Vec3], nodes: &[u32; 2]) -> Vec3 {
    values[nodes[1] as usize] - values[nodes[0] as usize]
}

/// Whether a node can move in all directions.
fn movable(inverse_mass: &Mat3) -> bool {
    inverse_mass.symmetric_eigenvalues().min() > 1e-14 * inverse_mass.amax()
}

/// A tree over the nodes of pairs, from the node that is hardest to move; nodes that are held in
/// some direction follow nobody.
fn branches(
    nodes: &[[u32; 2]],
    mobility: impl Fn(u32) -> f64,
    movable: impl Fn(u32) -> bool,
) -> Vec<Branch> {
    let all = nodes.iter().flatten().copied();
    let root = all.min_by(|&a, &b| mobility(a).total_cmp(&mobility(b)).then(a.cmp(&b)));
    let mut reached: Vec<u32> = root.into_iter().collect();
    let mut branches = Vec::new();
    loop {
        let next = nodes
            .iter()
            .enumerate()
            .find_map(|(pair, [first, second])| {
                let has = |node: &u32| reached.contains(node);
                let (follower, node) = match (has(first), has(second)) {
                    (true, false) => (1, *second),
                    (false, true) => (0, *first),
                    _ => return None,
                };
                Some((pair as u32, follower, node))
            });
        let Some((pair, follower, node)) = next else {
            return branches;
        };
        reached.push(node);
        if movable(node) {
            branches.push(Branch { pair, follower });
        }
    }
}
