//! A joint: pairs, a law, and what has become of them.

mod account;
mod group;
mod isolated;
mod matrices;
mod solve;

use std::collections::{HashMap, VecDeque};

use powerhouse_model::{
    Bond, Constraint, ConstraintWork, ContactLaw, ContactState, JointHistory, JointPair,
    JointRecord, JointState, JointView, Mat3, ModelError, PredictedMotion, Renewal, RunError, Vec3,
};

use crate::ContactError;
use crate::connected::connected_pairs;
use group::Group;
use isolated::{IsolatedPair, Tile, alike};
use solve::Effort;

/// What a pair starts with beside its geometry.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    /// Distance of the sides without displacement (m).
    gap: f64,
    /// Relative displacement (m), local and with the gap, that counts as none: where the pair was closed
    /// anew.
    origin: Vec3,
    /// Traction in the static state that displacements are counted from (Pa), local.
    preload: Vec3,
}

/// A pair whose sides start apart.
const APART: JointState = JointState {
    contact: ContactState::Open,
    bond: Bond::Never,
    slip: 0.0,
};

/// Whether a law pulls sides together that are apart and were never bonded.
fn pulls<L: ContactLaw>(law: &L) -> bool {
    law.admissible(Vec3::x(), &APART).0.x > 0.0
}

/// One joint of a constraint.
#[derive(Clone, Debug)]
struct Member<L> {
    name: String,
    law: L,
    /// Where its pairs end.
    end: usize,
    /// Its isolated pairs, for the step in use.
    tiles: Vec<Tile>,
}

/// The law of each pair.
struct Laws<'a, L>(&'a [Member<L>]);

impl<L> Laws<'_, L> {
    fn of(&self, pair: usize) -> &L {
        let place = self.0.partition_point(|member| member.end <= pair);
        &self.0[place].law
    }
}

/// Node pairs across a joint, and the law of their tractions.
///
/// In every step the engine predicts velocities without the joint; the joint finds for each pair the
/// force that would close its gap and stop its slip (Wang, Chen & Xiao 2019, Eqs. 18 to 21), lets
/// the law cut it down, and changes the velocities by what is left. Nothing is penalised and the
/// stable step does not change.
///
/// Displacements are small: normals and tributary areas stay those of the start. Distances count
/// from the start, too: a small initial distance of the two nodes of a pair is none unless
/// [`with_gaps`](Self::with_gaps) says so.
///
/// ```
/// use powerhouse_contact::{BondedCoulomb, Joint};
/// use powerhouse_model::{Constraint, JointPair, Mat3, PredictedMotion, Vec3};
/// // A mass of 2 kg on the ground, pressed by 20 N and pushed by 13 N, with friction 0.5.
/// let pair = JointPair::new([0, 1], Vec3::z(), 1.0);
/// let mut joint = Joint::new("base", vec![pair], BondedCoulomb::unbonded(0.5, 0.5)?)?;
/// let (step, inverse_mass) = (1e-3, [Mat3::zeros(), Mat3::identity() / 2.0]);
/// let (rest, mut velocity) = ([Vec3::zeros(); 2], [Vec3::zeros(), Vec3::new(6.5, 0.0, -10.0) * step]);
/// let motion = PredictedMotion::new((0, 0.0, step), &rest, &rest, &mut velocity, &inverse_mass);
/// joint.correct(motion)?;
/// // (13 N - 0.5 * 20 N) / 2 kg during one step.
/// assert!((velocity[1] - Vec3::new(1.5, 0.0, 0.0) * step).norm() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Joint<L> {
    name: String,
    members: Vec<Member<L>>,
    /// Mesh indices, each once, in the order of the pairs: what a pass over them reads lies side by
    /// side.
    nodes: Vec<u32>,
    pairs: Vec<JointPair>,
    sides: Vec<Side>,
    records: Vec<JointRecord>,
    /// Places of the pairs' nodes in `nodes`.
    places: Vec<[u32; 2]>,
    /// Pairs that nodes connect.
    connected: Vec<Vec<u32>>,
    isolated_count: usize,
    groups: Vec<Group>,
    effort: Effort,
    /// The step (s) that it is prepared for.
    prepared: Option<f64>,
}

impl<L: ContactLaw> Joint<L> {
    /// A joint of these pairs in the initial state of the law.
    ///
    /// # Errors
    /// [`ContactError::Empty`], [`ContactError::SelfPair`] or [`ContactError::Pair`], as the refusal
    /// of a model's part.
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
        let record = JointRecord {
            state: law.initial(),
            ..JointRecord::default()
        };
        let name = name.into();
        Ok(Self::assemble(
            vec![Member {
                name: name.clone(),
                law,
                end: pairs.len(),
                tiles: Vec::new(),
            }],
            name,
            vec![Side::default(); pairs.len()],
            vec![record; pairs.len()],
            pairs,
        ))
    }

    fn assemble(
        members: Vec<Member<L>>,
        name: String,
        sides: Vec<Side>,
        records: Vec<JointRecord>,
        pairs: Vec<JointPair>,
    ) -> Self {
        let of_pairs: Vec<[u32; 2]> = pairs.iter().map(|pair| pair.nodes).collect();
        let (mut nodes, mut place_of) = (Vec::new(), HashMap::new());
        let mut place = |node: u32| {
            *place_of.entry(node).or_insert_with(|| {
                nodes.push(node);
                nodes.len() as u32 - 1
            })
        };
        Self {
            places: of_pairs.iter().map(|pair| pair.map(&mut place)).collect(),
            connected: connected_pairs(&of_pairs),
            name,
            members,
            nodes,
            pairs,
            sides,
            records,
            isolated_count: 0,
            groups: Vec::new(),
            effort: Effort::default(),
            prepared: None,
        }
    }

    /// Several joints as one constraint: joints that share nodes, such as those that meet at a line,
    /// have to be solved together. Each keeps its name, law and records. With laws of different
    /// types `L` is `Box<dyn ContactLaw>`.
    ///
    /// # Errors
    /// [`ContactError::Empty`] for no joints, [`ContactError::SameName`].
    pub fn join(joints: Vec<Self>) -> Result<Self, ModelError> {
        let (mut members, mut pairs) = (Vec::<Member<L>>::new(), Vec::new());
        let (mut sides, mut records) = (Vec::new(), Vec::new());
        for joint in joints {
            for member in joint.members {
                if members.iter().any(|other| other.name == member.name) {
                    return Err(ContactError::SameName { name: member.name }.into());
                }
                let end = member.end + pairs.len();
                members.push(Member { end, ..member });
            }
            pairs.extend(joint.pairs);
            sides.extend(joint.sides);
            records.extend(joint.records);
        }
        let names: Vec<&str> = members.iter().map(|member| member.name.as_str()).collect();
        if names.is_empty() {
            return Err(ContactError::Empty.into());
        }
        let name = names.join(" + ");
        Ok(Self::assemble(members, name, sides, records, pairs))
    }

    /// Sets the traction `sigma n` on the first side (Pa) in the static state from which
    /// displacements are counted, for each pair. The law sees the sum of it and what the motion adds.
    ///
    /// # Errors
    /// [`ContactError::Preload`] for one that the law does not admit, or across a gap.
    pub fn with_preload(
        mut self,
        traction: impl Fn(&JointPair) -> Vec3,
    ) -> Result<Self, ModelError> {
        let laws = Laws(&self.members);
        for (index, (pair, side)) in self.pairs.iter().zip(&mut self.sides).enumerate() {
            let preload = pair.to_local(&traction(pair));
            let record = &mut self.records[index];
            let (admitted, _) = laws.of(index).admissible(preload, &record.state);
            let across_gap = side.gap > 0.0 && preload != Vec3::zeros();
            // A NaN is refused here, too.
            if admitted != preload || across_gap {
                let [first, second] = pair.nodes;
                return Err(ContactError::Preload {
                    first,
                    second,
                    normal: preload.x,
                    shear: preload.y.hypot(preload.z),
                }
                .into());
            }
            side.preload = preload;
            record.traction = preload;
        }
        self.prepared = None;
        Ok(self)
    }

    /// Sets the distance of the sides (m) in the state from which displacements are counted, for
    /// each pair. A pair apart has no bond.
    ///
    /// # Errors
    /// [`ContactError::Gap`] for one that is negative or not finite, that the law would close by
    /// pulling, or across which there is a preload.
    pub fn with_gaps(mut self, gap: impl Fn(&JointPair) -> f64) -> Result<Self, ModelError> {
        let laws = Laws(&self.members);
        for (index, (pair, side)) in self.pairs.iter().zip(&mut self.sides).enumerate() {
            let gap = gap(pair);
            let refused =
                |gap: f64| gap > 0.0 && (pulls(laws.of(index)) || side.preload != Vec3::zeros());
            if !(gap.is_finite() && gap >= 0.0) || refused(gap) {
                let [first, second] = pair.nodes;
                return Err(ContactError::Gap { first, second, gap }.into());
            }
            side.gap = gap;
            if gap > 0.0 {
                self.records[index].state = APART;
            }
        }
        self.prepared = None;
        Ok(self)
    }

    /// Takes the bond from the pairs for which `unbonded` says so, as where a joint was cracked
    /// before.
    ///
    /// # Errors
    /// [`ContactError::NoBond`] for one without a bond, or whose law pulls whatever its bond.
    pub fn without_bond(
        mut self,
        unbonded: impl Fn(&JointPair) -> bool,
    ) -> Result<Self, ModelError> {
        let laws = Laws(&self.members);
        for (index, pair) in self
            .pairs
            .iter()
            .enumerate()
            .filter(|(_, pair)| unbonded(pair))
        {
            let state = &mut self.records[index].state;
            if state.bond != Bond::Intact || pulls(laws.of(index)) {
                let [first, second] = pair.nodes;
                return Err(ContactError::NoBond { first, second }.into());
            }
            state.bond = Bond::Never;
        }
        Ok(self)
    }

    /// The pairs.
    pub fn pairs(&self) -> &[JointPair] {
        &self.pairs
    }
    /// Their contact states and history variables.
    pub fn records(&self) -> &[JointRecord] {
        &self.records
    }
    /// How many pairs are corrected in one pass, each by itself, once masses are known.
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
        let mut isolated = Vec::new();
        self.groups.clear();
        for connected in &self.connected {
            let places: Vec<[u32; 2]> =
                connected.iter().map(|&p| self.places[p as usize]).collect();
            if let ([index], [nodes]) = (&connected[..], &places[..]) {
                let masses = nodes.map(|node| &inverse_mass[node as usize]);
                let (pair, side) = (self.pairs[*index as usize], self.sides[*index as usize]);
                if let Some(inverse_mass) = alike(&pair, &side, masses) {
                    if inverse_mass[0] + inverse_mass[1] > 0.0 {
                        isolated.push(IsolatedPair {
                            index: *index,
                            nodes: *nodes,
                            pair,
                            side,
                            inverse_mass,
                        });
                    }
                    continue;
                }
            }
            let mut group = Group::new(connected.clone(), places);
            group.prepare(&self.pairs, inverse_mass);
            self.groups.push(group);
        }
        isolated.sort_by_key(|pair| pair.index);
        self.isolated_count = isolated.len();
        let mut start = 0;
        for member in &mut self.members {
            let end = isolated.partition_point(|pair| (pair.index as usize) < member.end);
            member.tiles = Tile::all(&isolated[start..end], step).collect();
            start = end;
        }
    }

    fn correct(&mut self, mut motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        if self.prepared != Some(motion.step) {
            self.prepare(motion.step, motion.inverse_mass);
        }
        let mut work = ConstraintWork::default();
        for member in &self.members {
            let records = &mut self.records;
            let part = isolated::correct(&member.law, &member.tiles, records, &mut motion);
            work.friction += part.friction;
            work.bond += part.bond;
            work.impact += part.impact;
            work.external += part.external;
        }
        let laws = Laws(&self.members);
        for group in &mut self.groups {
            let geometry = (&self.pairs[..], &self.sides[..]);
            let records = &mut self.records;
            let effort = group.correct(&laws, geometry, records, &mut motion, &mut work);
            let effort = effort.map_err(|left| RunError::Constraint {
                name: self.name.clone(),
                step: motion.number,
                reason: format!(
                    "{} connected pairs are not solved after {} sweeps: the last one changed the \
                     motion by {:.1e} of what they do to it",
                    group.pair_count(),
                    left.sweeps,
                    left.residual
                ),
            })?;
            self.effort.sweeps = self.effort.sweeps.max(effort.sweeps);
            self.effort.residual = self.effort.residual.max(effort.residual);
        }
        Ok(work)
    }

    fn joints(&self) -> Vec<JointView<'_>> {
        let mut start = 0;
        let view = |member| {
            let Member { name, law, end, .. }: &Member<L> = member;
            let range = core::mem::replace(&mut start, *end)..*end;
            JointView {
                name,
                law: law.name(),
                pairs: &self.pairs[range.clone()],
                records: &self.records[range],
                most_sweeps: self.effort.sweeps,
                worst_residual: self.effort.residual,
            }
        };
        self.members.iter().map(view).collect()
    }

    fn restore(&mut self, history: &JointHistory) -> bool {
        let mut start = 0;
        for member in &self.members {
            let range = core::mem::replace(&mut start, member.end)..member.end;
            if member.name == history.name {
                let found = in_order_of(&self.pairs[range.clone()], history);
                return found.is_some_and(|records| {
                    for (side, record) in self.sides[range.clone()].iter_mut().zip(&records) {
                        // What is prepared holds the origins of pairs.
                        if side.origin != record.origin() {
                            side.origin = record.origin();
                            self.prepared = None;
                        }
                    }
                    self.records[range].copy_from_slice(&records);
                    true
                });
            }
        }
        false
    }

    fn renew(&mut self, joint: &str, renewal: Renewal, displacement: &[Vec3]) -> bool {
        let mut start = 0;
        for member in &self.members {
            let range = core::mem::replace(&mut start, member.end)..member.end;
            if member.name != joint {
                continue;
            }
            for index in range {
                let [first, second] = self.places[index].map(|node| displacement[node as usize]);
                let mut closed_at = self.pairs[index].to_local(&(second - first));
                let (side, record) = (&mut self.sides[index], &mut self.records[index]);
                if renewal == Renewal::Grouted {
                    closed_at.x += side.gap;
                    *record = JointRecord {
                        state: member.law.initial(),
                        traction: side.preload,
                        ..JointRecord::default()
                    };
                }
                side.origin = closed_at;
                record.closed_at = Some(closed_at.into());
            }
            self.prepared = None;
            return true;
        }
        false
    }
}

/// The records of an earlier run in the order of these pairs; none if they are not the same pairs.
fn in_order_of(pairs: &[JointPair], history: &JointHistory) -> Option<Vec<JointRecord>> {
    let mut of_nodes: HashMap<[u32; 2], VecDeque<JointRecord>> = HashMap::new();
    for (nodes, record) in history.nodes.iter().zip(&history.records) {
        of_nodes.entry(*nodes).or_default().push_back(*record);
    }
    let next = |pair: &JointPair| of_nodes.get_mut(&pair.nodes)?.pop_front();
    let found: Option<Vec<JointRecord>> = pairs.iter().map(next).collect();
    found.filter(|found| found.len() == history.records.len())
}
