//! Joint: node pairs, contact law, and state of the pairs.

mod bookkeeping;
mod capabilities;
mod group;
mod history;
mod initial;
mod isolated;
mod matrices;
mod relaxation;
mod saved;
mod solve;
mod strips;

use core::ops::Range;
use std::collections::HashMap;

use powerhouse_model::{
    Bond, Constraint, ConstraintParts, ConstraintWork, ContactLaw, ContactState, CoupledConstraint,
    DividedConstraint, JointConstraint, JointPair, JointRecord, JointState, Mat3, ModelError,
    NodeCoupling, PredictedMotion, RestrictedConstraint, RunError, SavedState, Vec3,
};

use crate::ContactError;
use crate::connected::connected_pairs;
use group::{Couplings, Group};
use history::{PairHistories, initial_history};
use isolated::{IsolatedPair, isotropic_masses};
use relaxation::Start;
use solve::Effort;
use strips::Strip;

/// Initial conditions of a pair.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    /// Distance of the sides without displacement (m).
    gap: f64,
    /// Relative displacement (m), local and with the gap, from which opening and slip count: that at which
    /// the pair was closed anew.
    origin: Vec3,
    /// Traction in the static state from which displacements count (Pa), local.
    preload: Vec3,
}

impl Side {
    /// Traction (Pa, local) along directions in which no motion determines it: that which acts without the joint, and that
    /// of the stress beside it.
    fn undetermined(&self, record: &JointRecord) -> Vec3 {
        self.preload + record.reference.map_or_else(Vec3::zeros, Vec3::from)
    }
}

/// State of a pair with an initial gap.
const APART: JointState = JointState::new(ContactState::Open, Bond::Never);

/// One of the joints of a constraint.
#[derive(Clone, Debug)]
struct Member<L> {
    name: String,
    law: L,
    /// Index of its first pair, and of the first that is not its own.
    start: usize,
    end: usize,
    /// Number of history variables of its law.
    variables: usize,
    /// Index of its first history variable among those of the constraint.
    history_start: usize,
    /// Its isolated pairs, for the step in use.
    strips: Vec<Strip>,
}

impl<L> Member<L> {
    /// Indices of its pairs.
    fn pairs(&self) -> Range<usize> {
        self.start..self.end
    }
    /// Indices of the history variables of one of its pairs.
    fn history_of(&self, pair: usize) -> Range<usize> {
        let start = self.history_start + (pair - self.start) * self.variables;
        start..start + self.variables
    }
    /// Indices of its history variables.
    fn history(&self) -> Range<usize> {
        self.history_start..self.history_start + (self.end - self.start) * self.variables
    }
    /// Relative displacement from which opening and slip of a pair count. A law without history, such as a
    /// tie, holds a pair that has dilated before at its dilation.
    fn origin(&self, record: &JointRecord) -> Vec3 {
        let mut origin = record.origin();
        if self.variables == 0 && record.dilation != 0.0 {
            origin.x += record.dilation;
        }
        origin
    }
}

/// Joints of a constraint, by the pairs that they own.
struct Members<'a, L>(&'a [Member<L>]);

impl<'a, L> Members<'a, L> {
    fn of(&self, pair: usize) -> &'a Member<L> {
        let index = self.0.partition_point(|member| member.end <= pair);
        &self.0[index]
    }
}

/// Node pairs of a joint with their contact law and state, as a constraint on the predicted motion.
///
/// In every step the engine predicts velocities without the joint; the joint computes for each pair the
/// force that would close its gap and stop its slip (Wang, Chen & Xiao 2019, Eqs. 18 to 21), the law
/// reduces it to an admissible one, and the velocities change by that. There is no penalty stiffness and
/// the stable step does not change.
///
/// Displacements are small: normals and tributary areas stay those of the start. Distances count
/// from the start, too: a small initial distance of the two nodes of a pair is no gap unless
/// [`with_gaps`](Self::with_gaps) makes it one.
///
/// ```
/// use powerhouse_contact::{BondedCoulomb, Joint};
/// use powerhouse_model::{Constraint, JointPair, Mat3, PredictedMotion, StepTime, Vec3};
/// // A mass of 2 kg on the ground, pressed by 20 N and pushed by 13 N, with friction 0.5.
/// let pair = JointPair::new([0, 1], Vec3::z(), 1.0);
/// let mut joint = Joint::new("base", vec![pair], BondedCoulomb::unbonded(0.5, 0.5)?)?;
/// let (step, inverse_mass) = (1e-3, [Mat3::zeros(), Mat3::identity() / 2.0]);
/// let (rest, mut velocity) = ([Vec3::zeros(); 2], [Vec3::zeros(), Vec3::new(6.5, 0.0, -10.0) * step]);
/// let when = StepTime { number: 0, time: 0.0, step };
/// let motion = PredictedMotion::new(when, &rest, &rest, &mut velocity, &inverse_mass);
/// joint.correct(motion)?;
/// // (13 N - 0.5 * 20 N) / 2 kg during one step.
/// assert!((velocity[1] - Vec3::new(1.5, 0.0, 0.0) * step).norm() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Joint<L> {
    name: String,
    members: Vec<Member<L>>,
    /// Mesh indices, each once, in the order of the pairs, so that the data of a pass over them are
    /// contiguous.
    nodes: Vec<u32>,
    pairs: Vec<JointPair>,
    sides: Vec<Side>,
    records: Vec<JointRecord>,
    /// History variables of the laws, member by member and pair by pair.
    history: Vec<f64>,
    /// Indices in `nodes` of the nodes of each pair.
    pair_nodes: Vec<[u32; 2]>,
    /// The first of them.
    first_nodes: Vec<u32>,
    /// Work of each pair in the last step.
    work: Vec<ConstraintWork>,
    /// Couplings of its nodes by inertia that they share.
    couplings: Vec<NodeCoupling>,
    /// Sets of pairs that nodes connect, directly or by couplings.
    connected: Vec<Vec<u32>>,
    isolated_count: usize,
    groups: Vec<Group>,
    effort: Effort,
    /// Length of the step (s) that it is prepared for.
    prepared: Option<f64>,
    /// Name of the joint whose softening the step does not resolve, with its [ratio](ContactLaw::softening_ratio).
    unresolved: Option<(String, f64)>,
    /// State at the start of an increment of a dynamic relaxation, during it.
    start: Option<Start>,
    /// States and history variables of the pairs that were kept, and the effort until then.
    kept: (Vec<JointRecord>, Vec<f64>, Effort),
}

/// Largest [ratio](ContactLaw::softening_ratio) of softening that a step resolves.
const MOST_SOFTENING: f64 = 3.0;

impl<L: ContactLaw> Joint<L> {
    /// Joint of some pairs in the initial state of the law.
    ///
    /// # Errors
    /// [`ContactError::Empty`], [`ContactError::SelfPair`] or [`ContactError::Pair`], as a
    /// [`ModelError::Refused`].
    pub fn new(name: impl Into<String>, pairs: Vec<JointPair>, law: L) -> Result<Self, ModelError> {
        if pairs.is_empty() {
            return Err(ContactError::Empty.into());
        }
        for pair in &pairs {
            let [first, second] = pair.nodes;
            if first == second {
                return Err(ContactError::SelfPair { node: first }.into());
            }
            let unit = |v: &Vec3| (v.norm_squared() - 1.0).abs() < 1e-9;
            let square = pair.normal.dot(&pair.tangent).abs() < 1e-9;
            let sound = |area: f64| area.is_finite() && area > 0.0;
            let sound = sound(pair.area) && sound(pair.projected_area);
            if !(sound && square && unit(&pair.normal) && unit(&pair.tangent)) {
                let area = pair.area;
                return Err(ContactError::Pair {
                    first,
                    second,
                    area,
                }
                .into());
            }
        }
        let record = JointRecord::new(law.initial());
        let history = initial_history(&law, pairs.len());
        let name = name.into();
        Ok(Self::assemble(
            vec![Member {
                name: name.clone(),
                variables: law.history().len(),
                law,
                start: 0,
                end: pairs.len(),
                history_start: 0,
                strips: Vec::new(),
            }],
            name,
            vec![Side::default(); pairs.len()],
            (vec![record; pairs.len()], history),
            pairs,
        ))
    }

    fn assemble(
        members: Vec<Member<L>>,
        name: String,
        sides: Vec<Side>,
        (records, history): (Vec<JointRecord>, Vec<f64>),
        pairs: Vec<JointPair>,
    ) -> Self {
        let of_pairs: Vec<[u32; 2]> = pairs.iter().map(|pair| pair.nodes).collect();
        let parts = ConstraintParts::connected_by(&of_pairs);
        let (mut nodes, mut index_of) = (Vec::new(), HashMap::new());
        let mut index = |node: u32| {
            *index_of.entry(node).or_insert_with(|| {
                nodes.push(node);
                nodes.len() as u32 - 1
            })
        };
        let pair_nodes: Vec<[u32; 2]> = of_pairs.iter().map(|pair| pair.map(&mut index)).collect();
        Self {
            first_nodes: pair_nodes.iter().map(|&[first, _]| first).collect(),
            work: vec![ConstraintWork::default(); pairs.len()],
            pair_nodes,
            connected: connected_pairs(&of_pairs, &parts),
            couplings: Vec::new(),
            name,
            members,
            nodes,
            pairs,
            sides,
            records,
            history,
            isolated_count: 0,
            groups: Vec::new(),
            effort: Effort::default(),
            prepared: None,
            unresolved: None,
            start: None,
            kept: Default::default(),
        }
    }

    /// Removes pairs, in the state of those that remain.
    fn retain(&mut self, keep: impl Fn(&JointPair) -> bool) {
        let kept: Vec<bool> = self.pairs.iter().map(keep).collect();
        let (mut members, mut history) = (Vec::with_capacity(self.members.len()), Vec::new());
        let mut end = 0;
        for mut member in core::mem::take(&mut self.members) {
            let history_start = history.len();
            let start = end;
            for pair in member.pairs().filter(|&pair| kept[pair]) {
                history.extend_from_slice(&self.history[member.history_of(pair)]);
                end += 1;
            }
            (member.start, member.end, member.history_start) = (start, end, history_start);
            members.push(member);
        }
        let (sides, records) = (of_kept(&self.sides, &kept), of_kept(&self.records, &kept));
        let (name, effort) = (core::mem::take(&mut self.name), self.effort);
        let pairs = of_kept(&self.pairs, &kept);
        *self = Self::assemble(members, name, sides, (records, history), pairs);
        self.effort = effort;
    }

    /// Joins several joints to one constraint: joints that share nodes, such as those that meet at a line,
    /// have to be solved together, since a node belongs to one constraint of a model. Each keeps its name, law and
    /// state. With laws of different types `L` is `Box<dyn ContactLaw>`.
    ///
    /// # Errors
    /// [`ContactError::Empty`] for no joints, [`ContactError::SameName`].
    pub fn join(joints: Vec<Self>) -> Result<Self, ModelError> {
        let (mut members, mut pairs) = (Vec::<Member<L>>::new(), Vec::new());
        let (mut sides, mut records, mut history) = (Vec::new(), Vec::new(), Vec::new());
        for joint in joints {
            for member in joint.members {
                if members.iter().any(|other| other.name == member.name) {
                    return Err(ContactError::SameName { name: member.name }.into());
                }
                members.push(Member {
                    start: member.start + pairs.len(),
                    end: member.end + pairs.len(),
                    history_start: member.history_start + history.len(),
                    ..member
                });
            }
            pairs.extend(joint.pairs);
            sides.extend(joint.sides);
            records.extend(joint.records);
            history.extend(joint.history);
        }
        let names: Vec<&str> = members.iter().map(|member| member.name.as_str()).collect();
        if names.is_empty() {
            return Err(ContactError::Empty.into());
        }
        let name = names.join(" + ");
        let state = (records, history);
        Ok(Self::assemble(members, name, sides, state, pairs))
    }

    /// The joint whose softening a step (s) resolves worst, if it does not resolve it.
    fn unresolved_by(&self, step: f64, inverse_mass: &[Mat3]) -> Option<(String, f64)> {
        let mut worst: Option<(String, f64)> = None;
        for member in &self.members {
            for index in member.pairs() {
                let masses = self.pair_nodes[index].map(|node| &inverse_mass[node as usize]);
                let mobility = (masses[0] + masses[1]).diagonal().max();
                let pair = &self.pairs[index];
                let compliance = step * step * mobility * pair.projected_area;
                let ratio = member.law.softening_ratio(compliance, pair.spacing);
                let most = worst.as_ref().map_or(MOST_SOFTENING, |(_, most)| *most);
                if ratio >= most {
                    worst = Some((member.name.clone(), ratio));
                }
            }
        }
        worst
    }

    /// Node pairs.
    pub fn pairs(&self) -> &[JointPair] {
        &self.pairs
    }
    /// Contact states, tractions, peak values and energies of the pairs.
    pub fn records(&self) -> &[JointRecord] {
        &self.records
    }
    /// History variables of the law of a pair, by the index of the pair; empty for a law without.
    ///
    /// # Panics
    /// If there is no such pair.
    pub fn history_of(&self, pair: usize) -> &[f64] {
        &self.history[Members(&self.members).of(pair).history_of(pair)]
    }
    /// Number of pairs that are solved in one pass, each by itself; zero until an engine has prepared the joint with the
    /// masses of its nodes.
    pub fn isolated_count(&self) -> usize {
        self.isolated_count
    }
}

impl<L: ContactLaw> Constraint for Joint<L> {
    fn name(&self) -> &str {
        &self.name
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    fn prepare(&mut self, step: f64, inverse_mass: &[Mat3]) {
        self.prepared = Some(step);
        // Pairs that are not corrected from now on do no work.
        self.work.fill(ConstraintWork::default());
        let mut isolated = Vec::new();
        self.groups.clear();
        let couplings = Couplings::new(&self.couplings);
        for connected in &self.connected {
            let nodes = connected.iter().map(|&p| self.pair_nodes[p as usize]);
            let pair_nodes: Vec<[u32; 2]> = nodes.collect();
            if let ([index], [nodes]) = (&connected[..], &pair_nodes[..])
                && !couplings.has(nodes[0])
            {
                let masses = nodes.map(|node| &inverse_mass[node as usize]);
                let (pair, side) = (self.pairs[*index as usize], self.sides[*index as usize]);
                let record = &self.records[*index as usize];
                let undetermined = side.undetermined(record);
                if let Some(inverse_mass) = isotropic_masses(&pair, &undetermined, masses) {
                    let moves = inverse_mass[0] + inverse_mass[1] > 0.0;
                    if moves {
                        isolated.push(IsolatedPair {
                            index: *index,
                            nodes: *nodes,
                            pair,
                            side,
                            inverse_mass,
                        });
                    }
                    // Supports hold both nodes of a pair that does not move; it has the traction of the stress beside it.
                    if moves || record.reference.is_none() {
                        continue;
                    }
                }
            }
            let mut group = Group::new(connected.clone(), pair_nodes);
            group.prepare(&self.pairs, inverse_mass, &couplings);
            self.groups.push(group);
        }
        self.unresolved = self.unresolved_by(step, inverse_mass);
        isolated.sort_by_key(|pair| pair.index);
        self.isolated_count = isolated.len();
        let mut start = 0;
        for member in &mut self.members {
            let end = isolated.partition_point(|pair| (pair.index as usize) < member.end);
            member.strips = Strip::all(&isolated[start..end], step, member.variables);
            start = end;
        }
    }

    fn correct(&mut self, mut motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        if self.prepared != Some(motion.step) {
            self.prepare(motion.step, motion.inverse_mass);
        }
        if let Some((name, ratio)) = &self.unresolved {
            return Err(RunError::Constraint {
                name: name.clone(),
                step: motion.number,
                reason: format!(
                    "the time step does not resolve the failure of its bond: step, masses and strengths over fracture energies \
                     give a ratio of {ratio:.1}, and {MOST_SOFTENING} is the most; let the strengths be reduced by the mesh \
                     (`reduce`), raise the fracture energies, or give a shorter step"
                ),
            });
        }
        self.undo_pseudo_motion(motion.displacement);
        for member in &mut self.members {
            let state = (&mut self.records[..], &mut self.work[..]);
            let history = PairHistories {
                variables: member.variables,
                first: member.start,
                values: &mut self.history[member.history()],
            };
            let (law, strips) = (&member.law, &mut member.strips);
            strips::correct(law, strips, state, history, &mut motion);
        }
        let members = Members(&self.members);
        for group in &mut self.groups {
            let geometry = (&self.pairs[..], &self.sides[..]);
            let state = (&mut self.records[..], &mut self.history[..]);
            let effort = group.correct(&members, geometry, state, &mut motion, &mut self.work);
            let effort = effort.map_err(|left| RunError::Constraint {
                name: self.name.clone(),
                step: motion.number,
                reason: format!(
                    "the solution of {} connected pairs has not converged after {} sweeps: the last one \
                     changed the motion by {:.1e} of the change by all their impulses; give a shorter step, a finer mesh at the joint or larger \
                     fracture energies",
                    group.pair_count(),
                    left.sweeps,
                    left.residual
                ),
            })?;
            self.effort.sweeps = self.effort.sweeps.max(effort.sweeps);
            self.effort.residual = self.effort.residual.max(effort.residual);
        }
        let mut work = ConstraintWork::default();
        self.work.iter().for_each(|of_pair| work += *of_pair);
        Ok(work)
    }

    fn jointed(&self) -> Option<&dyn JointConstraint> {
        Some(self)
    }
    fn jointed_mut(&mut self) -> Option<&mut dyn JointConstraint> {
        Some(self)
    }
    fn divided(&self) -> Option<&dyn DividedConstraint> {
        Some(self)
    }
    fn restricted(&mut self) -> Option<&mut dyn RestrictedConstraint> {
        Some(self)
    }
    fn coupled(&mut self) -> Option<&mut dyn CoupledConstraint> {
        Some(self)
    }
    fn saved(&self) -> Option<&dyn SavedState> {
        Some(self)
    }
    fn saved_mut(&mut self) -> Option<&mut dyn SavedState> {
        Some(self)
    }
}

/// The values of the pairs that are kept.
fn of_kept<T: Copy>(values: &[T], kept: &[bool]) -> Vec<T> {
    let pairs = values.iter().zip(kept);
    pairs
        .filter(|(_, kept)| **kept)
        .map(|(value, _)| *value)
        .collect()
}
