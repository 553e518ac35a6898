//! Groups of connected pairs: pairs that share nodes, have nodes that inertia couples, or whose effective masses differ
//! between directions.

use std::collections::HashMap;

use nalgebra::{DMatrix, DVector};
use powerhouse_model::{
    ConstraintWork, ContactLaw, ContactState, JointInput, JointPair, JointRecord, JointState, Mat3,
    NodeCoupling, PredictedMotion, Vec3,
};

use super::bookkeeping::{PairStep, bond_energy, update_by_step};
use super::isolated::held_back;
use super::matrices::Matrices;
use super::solve::{Contact, Effort, solve};
use super::{Members, Side};

/// Couplings of the nodes of a joint by inertia that they share, by the node on which an impulse acts.
#[derive(Debug)]
pub(super) struct Couplings(HashMap<u32, Vec<(u32, Mat3)>>);

impl Couplings {
    pub(super) fn new(couplings: &[NodeCoupling]) -> Self {
        let mut moved: HashMap<u32, Vec<(u32, Mat3)>> = HashMap::new();
        for NodeCoupling {
            nodes: [first, second],
            response,
        } in couplings
        {
            let mut add = |by, of, response| moved.entry(by).or_default().push((of, response));
            add(*second, *first, *response);
            add(*first, *second, response.transpose());
        }
        Self(moved)
    }

    /// Whether a node is coupled with others.
    pub(super) fn has(&self, node: u32) -> bool {
        self.0.contains_key(&node)
    }

    /// Nodes that an impulse on a node moves beside it, with their velocities per impulse (1/kg).
    fn moved_by(&self, node: u32) -> &[(u32, Mat3)] {
        self.0.get(&node).map_or(&[], |moved| &moved[..])
    }
}

/// Node that impulses on a pair move, beside those of the pair.
#[derive(Clone, Copy, Debug)]
struct Moved {
    /// Index among the pairs of the group.
    pair: u32,
    node: u32,
    /// Velocity per impulse (1/kg).
    response: Mat3,
}

/// Group of pairs that nodes connect.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// Indices among the pairs of the joint.
    pairs: Vec<u32>,
    /// Indices of their nodes among those of the joint.
    nodes: Vec<[u32; 2]>,
    /// Inverse effective masses of the nodes (1/kg).
    inverse_mass: Vec<[Mat3; 2]>,
    moved: Vec<Moved>,
    /// Relative velocities of pairs per impulses on pairs, `G` (1/kg).
    coupling: DMatrix<f64>,
    matrices: Matrices,
    /// Spanning trees of the nodes, one for each set of pairs that nodes connect: pairs in an order in which each but the
    /// first of a set shares a node with an earlier one, and the node of each that follows the other one.
    branches: Vec<Branch>,
}

/// Pair of a spanning tree, one node of which takes the velocity of the other where all pairs of the
/// group stick.
#[derive(Clone, Copy, Debug)]
struct Branch {
    /// Index among the pairs of the group.
    pair: u32,
    /// Side of the node that follows: 0 or 1.
    follower: u8,
}

/// Change of a velocity, over its size and that of its changes by impulses, that rounding explains.
const ALIGNED: f64 = 1e-9;

impl Group {
    /// Group of pairs with the indices of their nodes.
    pub(super) fn new(pairs: Vec<u32>, nodes: Vec<[u32; 2]>) -> Self {
        let none = DMatrix::zeros(0, 0);
        Self {
            inverse_mass: Vec::new(),
            moved: Vec::new(),
            matrices: Matrices::new(&none, &[]),
            coupling: none,
            branches: Vec::new(),
            pairs,
            nodes,
        }
    }

    /// Number of pairs.
    pub(super) fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    /// Builds the matrices for inverse effective masses and couplings of all nodes of the joint.
    pub(super) fn prepare(
        &mut self,
        pairs: &[JointPair],
        inverse_mass: &[Mat3],
        couplings: &Couplings,
    ) {
        let of = |node: u32| inverse_mass[node as usize];
        // Velocity of a node per impulse on another.
        let response = |node: u32, by: u32| {
            if node == by {
                return Some(of(node));
            }
            let mut moved = couplings.moved_by(by).iter();
            moved
                .find(|(other, _)| *other == node)
                .map(|(_, response)| *response)
        };
        self.moved.clear();
        for (pair, nodes) in (0..).zip(&self.nodes) {
            for (by, sign) in nodes.iter().zip([1.0, -1.0]) {
                let moved = couplings.moved_by(*by).iter();
                self.moved.extend(moved.map(|(node, response)| Moved {
                    pair,
                    node: *node,
                    response: response * sign,
                }));
            }
        }
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
                    for (j, by) in other.iter().enumerate() {
                        if let Some(response) = response(*node, *by) {
                            sum += response * if i == j { 1.0 } else { -1.0 };
                        }
                    }
                }
                let block = frames[a] * sum * frames[b].transpose();
                coupling.view_mut((3 * a, 3 * b), (3, 3)).copy_from(&block);
            }
        }
        for a in 0..count {
            // A direction in which supports hold both nodes: nothing but rounding.
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

    /// Corrects the motion of the nodes of the group, and sets the work of its pairs; returns the effort.
    ///
    /// # Errors
    /// Sweeps and residual if the solution has not converged.
    pub(super) fn correct<L: ContactLaw>(
        &mut self,
        members: &Members<L>,
        (pairs, sides): (&[JointPair], &[Side]),
        (records, history): (&mut [JointRecord], &mut [f64]),
        motion: &mut PredictedMotion,
        works: &mut [ConstraintWork],
    ) -> Result<Effort, Effort> {
        let count = self.pairs.len();
        let (rate, step) = (1.0 / motion.step, motion.step);
        let (mut excess, mut impulses) = (DVector::zeros(3 * count), DVector::zeros(3 * count));
        let mut reference = DVector::zeros(3 * count);
        let mut offsets = Vec::with_capacity(count);
        let mut before = Vec::with_capacity(count);
        let mut contacts = Vec::with_capacity(count);
        for (a, (&index, nodes)) in self.pairs.iter().zip(&self.nodes).enumerate() {
            let index = index as usize;
            let (pair, side, record) = (&pairs[index], &sides[index], &records[index]);
            let mut offset = pair.to_local(&relative(motion.displacement, nodes));
            offset.x += side.gap;
            offset -= side.origin;
            let member = members.of(index);
            let mut held = held_back(&offset, record);
            if member.variables > 0 {
                held.x -= record.dilation;
            }
            let hold = held * rate;
            let wanted = pair.to_local(&relative(motion.velocity, nodes)) + hold;
            excess.fixed_rows_mut::<3>(3 * a).copy_from(&wanted);
            // The impulses of the last step are a good start.
            let per_traction = pair.projected_area * step;
            let start = (record.traction - side.preload) * per_traction;
            impulses.fixed_rows_mut::<3>(3 * a).copy_from(&start);
            let nearest = (side.undetermined(record) - side.preload) * per_traction;
            reference.fixed_rows_mut::<3>(3 * a).copy_from(&nearest);
            let old = pair.to_local(&relative(motion.previous, nodes));
            let mobility = 0.5
                * [1, 2]
                    .map(|c| self.coupling[(3 * a + c, 3 * a + c)])
                    .iter()
                    .sum::<f64>();
            let input = JointInput::new(record.traction, &record.state)
                .with_history(&history[member.history_of(index)])
                .with_motion(offset.x, [old.y, old.z])
                .with_shear_displacement([offset.y, offset.z], old.x)
                .with_spacing(pair.spacing)
                .with_dilation(record.dilation)
                .with_step(motion.time, step, mobility * per_traction)
                .with_site(pair.position, pair.projected_area);
            contacts.push(Contact::new(&member.law, input, side.preload, per_traction));
            before.push(old);
            offsets.push((offset, hold));
        }
        let matrices = &mut self.matrices;
        let effort = solve(
            (&self.coupling, matrices),
            &mut contacts,
            (&excess, &reference),
            &mut impulses,
        )?;

        self.apply(&impulses, pairs, motion);
        if contacts.iter().all(|contact| contact.held) {
            self.align(&offsets, &impulses, pairs, motion);
        }
        let mut changed = Vec::new();
        for (a, nodes) in self.nodes.iter().enumerate() {
            let index = self.pairs[a] as usize;
            let (pair, contact) = (&pairs[index], &contacts[a]);
            let traction = contact.traction(&impulses.fixed_rows::<3>(3 * a).into_owned());
            let after = pair.to_local(&relative(motion.velocity, nodes));
            let (record, work) = (&mut records[index], &mut works[index]);
            *work = ConstraintWork::default();
            let mut step = PairStep {
                time: motion.time,
                length: step,
                area: pair.projected_area,
                preload: contact.preload,
                offset: offsets[a].0,
                before: before[a],
                after,
                state: contact.outcome(),
                traction,
                dilation: 0.0,
                bond: None,
            };
            let slots = members.of(index).history_of(index);
            if slots.is_empty() {
                update_by_step::<false>(record, &step, work);
                continue;
            }
            let left = after + offsets[a].1;
            let (dilation, new) = advance(contact, &record.state, &step, &left);
            step.dilation = dilation;
            let (law, old) = (&members.of(index).law, &history[slots.clone()]);
            step.bond = bond_energy(law, old, &new, step.area);
            changed.push((slots, new));
            update_by_step::<true>(record, &step, work);
        }
        for (slots, new) in changed {
            history[slots].copy_from_slice(&new);
        }
        Ok(effort)
    }

    /// Changes the velocities by the impulses.
    fn apply(&self, impulses: &DVector<f64>, pairs: &[JointPair], motion: &mut PredictedMotion) {
        for (a, nodes) in self.nodes.iter().enumerate() {
            let local: Vec3 = impulses.fixed_rows::<3>(3 * a).into_owned();
            let impulse = pairs[self.pairs[a] as usize].to_global(&local);
            let [first, second] = &self.inverse_mass[a];
            motion.velocity[nodes[0] as usize] += first * impulse;
            motion.velocity[nodes[1] as usize] -= second * impulse;
        }
        for moved in &self.moved {
            let local: Vec3 = impulses
                .fixed_rows::<3>(3 * moved.pair as usize)
                .into_owned();
            let impulse = pairs[self.pairs[moved.pair as usize] as usize].to_global(&local);
            motion.velocity[moved.node as usize] += moved.response * impulse;
        }
    }

    /// Gives nodes that all stick together the same velocity, to the last bit. Pairs that cannot all be held back to where they
    /// stuck, as pairs of several normals that slipped on the way, keep the velocities of their impulses.
    fn align(
        &self,
        offsets: &[(Vec3, Vec3)],
        impulses: &DVector<f64>,
        pairs: &[JointPair],
        motion: &mut PredictedMotion,
    ) {
        let speeds = (self.inverse_mass.iter().enumerate()).map(|(a, [first, second])| {
            let impulse: Vec3 = impulses.fixed_rows::<3>(3 * a).into_owned();
            let impulse = pairs[self.pairs[a] as usize].to_global(&impulse);
            (first * impulse).norm().max((second * impulse).norm())
        });
        let most = ALIGNED * speeds.fold(0.0, f64::max);
        for branch in &self.branches {
            let a = branch.pair as usize;
            let [first, second] = self.nodes[a].map(|node| node as usize);
            let after = -pairs[self.pairs[a] as usize].to_global(&offsets[a].1);
            let [from, of] = match branch.follower {
                1 => [motion.velocity[first] + after, motion.velocity[second]],
                _ => [motion.velocity[second] - after, motion.velocity[first]],
            };
            if (from - of).norm() <= most + ALIGNED * (from.norm() + after.norm()) {
                motion.velocity[if branch.follower == 1 { second } else { first }] = from;
            }
        }
    }
}

/// Value at the second node less that at the first.
fn relative(values: &[Vec3], nodes: &[u32; 2]) -> Vec3 {
    values[nodes[1] as usize] - values[nodes[0] as usize]
}

/// Whether a node is free to move in all directions.
fn movable(inverse_mass: &Mat3) -> bool {
    inverse_mass.symmetric_eigenvalues().min() > 1e-14 * inverse_mass.amax()
}

/// New dilation (m) and history variables of a pair of a law with history after a step that is solved, from
/// its committed state; `left` is its relative velocity (m/s) beyond that which closes it and holds it.
///
/// The trial is the traction that would have taken off what is left: the law finds the solution that the
/// sweeps have found with it.
fn advance<L: ContactLaw>(
    contact: &Contact<L>,
    committed: &JointState,
    step: &PairStep,
    left: &Vec3,
) -> (f64, Vec<f64>) {
    let mut input = contact.input;
    (input.state, input.trial) = (*committed, step.traction);
    let compliance = input.compliance;
    if step.state.contact != ContactState::Stick && compliance > 0.0 {
        input.trial += Vec3::new(left.x.max(0.0), left.y, left.z) / compliance;
    }
    let mut new = input.history.to_vec();
    let response = contact.law.admissible(&input, &mut new);
    (response.dilation, new)
}

/// Spanning trees over the nodes of pairs, each from the node of the greatest mass; nodes that are held in
/// some direction follow no other.
fn branches(
    nodes: &[[u32; 2]],
    mobility: impl Fn(u32) -> f64,
    movable: impl Fn(u32) -> bool,
) -> Vec<Branch> {
    let mut reached: Vec<u32> = Vec::new();
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
        if let Some((pair, follower, node)) = next {
            reached.push(node);
            if movable(node) {
                branches.push(Branch { pair, follower });
            }
            continue;
        }
        let rest = nodes.iter().flatten().copied();
        let rest = rest.filter(|node| !reached.contains(node));
        let root = rest.min_by(|&a, &b| mobility(a).total_cmp(&mobility(b)).then(a.cmp(&b)));
        match root {
            Some(root) => reached.push(root),
            None => return branches,
        }
    }
}
