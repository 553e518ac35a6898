//! The state of the whole body, gathered from the ranks.

use powerhouse_model::{
    EngineError, HistoryField, HistoryVariable, JointHistory, JointPair, JointRecord, JointView,
    ModelError, Vec3,
};
use serde::{Deserialize, Serialize};

use crate::Model;

/// A joint of the whole body, of which a rank may have some pairs.
pub(crate) struct WholeJoint {
    name: String,
    law: String,
    pairs: Vec<JointPair>,
    variables: Vec<HistoryVariable>,
}

/// State of the pairs of a joint of the whole body.
#[derive(Clone, Default)]
pub(crate) struct JointValues {
    records: Vec<JointRecord>,
    history: Vec<f64>,
    most_sweeps: u32,
    worst_residual: f64,
}

/// State of some pairs of a joint, as a rank sends it.
#[derive(Serialize, Deserialize)]
pub(crate) struct SentJoint {
    /// Index of the joint among those of the whole body, and of its pairs.
    joint: u32,
    pairs: Vec<u32>,
    records: Vec<JointRecord>,
    history: Vec<f64>,
    most_sweeps: u32,
    worst_residual: f64,
}

impl WholeJoint {
    pub(crate) fn of(view: &JointView) -> Self {
        Self {
            name: view.name.into(),
            law: view.law.into(),
            pairs: view.pairs.to_vec(),
            variables: view.variables.to_vec(),
        }
    }
    pub(crate) fn view<'a>(&'a self, values: &'a JointValues) -> JointView<'a> {
        JointView::new(&self.name, &self.law, &self.pairs, &values.records)
            .with_history(&self.variables, &values.history)
            .with_effort(values.most_sweeps, values.worst_residual)
    }
}

/// States of all joints from those that the ranks have sent.
pub(crate) fn joint_values(joints: &[WholeJoint], sent: Vec<Vec<SentJoint>>) -> Vec<JointValues> {
    let mut all: Vec<JointValues> = (joints.iter())
        .map(|joint| JointValues {
            records: vec![JointRecord::default(); joint.pairs.len()],
            history: vec![0.0; joint.pairs.len() * joint.variables.len()],
            ..JointValues::default()
        })
        .collect();
    for sent in sent.into_iter().flatten() {
        let Some(values) = all.get_mut(sent.joint as usize) else {
            continue;
        };
        values.most_sweeps = values.most_sweeps.max(sent.most_sweeps);
        values.worst_residual = values.worst_residual.max(sent.worst_residual);
        let variables = sent.history.len() / sent.pairs.len().max(1);
        for (index, (&pair, record)) in sent.pairs.iter().zip(sent.records).enumerate() {
            let pair = pair as usize;
            values.records[pair] = record;
            let own = &sent.history[index * variables..(index + 1) * variables];
            values.history[pair * variables..(pair + 1) * variables].copy_from_slice(own);
        }
    }
    all
}

/// Bytes of a node or element: its mesh index and numbers.
pub(crate) fn write(index: u32, numbers: &[f64], bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&index.to_le_bytes());
    for number in numbers {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
}

/// The indices and numbers that [`write`] wrote, `N` numbers each.
pub(crate) fn read<const N: usize>(bytes: &[u8]) -> impl Iterator<Item = (usize, [f64; N])> + '_ {
    let length = size_of::<u32>() + N * size_of::<f64>();
    bytes.chunks_exact(length).filter_map(|bytes| {
        let (index, numbers) = bytes.split_first_chunk::<4>()?;
        let (numbers, _) = numbers.as_chunks::<8>();
        let number = |i: usize| numbers.get(i).copied().map(f64::from_le_bytes);
        let all = core::array::from_fn(|i| number(i).unwrap_or_default());
        Some((u32::from_le_bytes(*index) as usize, all))
    })
}

impl Model {
    /// Numbers of every node of the body, by mesh index with additional nodes of boundaries, from those of the nodes (local
    /// numbers) of each rank.
    pub(crate) fn of_all_nodes<const N: usize>(
        &self,
        of: impl Fn(usize) -> [f64; N],
    ) -> Vec<[f64; N]> {
        self.by_node(&self.ranks.team.of_all(&self.own_nodes(of)))
    }

    /// The same on rank 0, and nothing on the others.
    pub(crate) fn of_all_nodes_at_first<const N: usize>(
        &self,
        of: impl Fn(usize) -> [f64; N],
    ) -> Vec<[f64; N]> {
        let team = &self.ranks.team;
        let sent = team.at_first(&self.own_nodes(of));
        match team.rank() {
            0 => self.by_node(&sent),
            _ => Vec::new(),
        }
    }

    /// Numbers of the nodes that this rank owns, as they are sent.
    fn own_nodes<const N: usize>(&self, of: impl Fn(usize) -> [f64; N]) -> Vec<u8> {
        let subdomain = &self.subdomain;
        let mut own = Vec::new();
        for local in subdomain.node_ranges.ranges().iter().cloned().flatten() {
            write(subdomain.numbering.mesh_of[local], &of(local), &mut own);
        }
        own
    }

    /// Numbers by mesh index from those that the ranks have sent.
    fn by_node<const N: usize>(&self, sent: &[Vec<u8>]) -> Vec<[f64; N]> {
        let mut all = vec![[0.0; N]; self.subdomain.numbering.local_of.len()];
        for (node, numbers) in sent.iter().flat_map(|bytes| read(bytes)) {
            if let Some(entry) = all.get_mut(node) {
                *entry = numbers;
            }
        }
        all
    }

    /// The state of the pairs of each joint whose first nodes are owned by this rank.
    pub(crate) fn own_joints(&self) -> Vec<SentJoint> {
        let mut sent = Vec::new();
        let subdomain = &self.subdomain;
        let local = |pair: &JointPair| subdomain.numbering.local(pair.nodes[0] as usize);
        for view in self.joints() {
            let named = |joint: &WholeJoint| joint.name == view.name;
            let Some(index) = self.ranks.joints.iter().position(named) else {
                continue;
            };
            let mut of_joint = SentJoint {
                joint: index as u32,
                pairs: Vec::new(),
                records: Vec::new(),
                history: Vec::new(),
                most_sweeps: view.most_sweeps,
                worst_residual: view.worst_residual,
            };
            let whole = (0..).zip(&self.ranks.joints[index].pairs);
            // The pairs of a rank are in the order of the whole joint.
            let here = whole.filter_map(|(pair, geometry)| Some((pair, local(geometry)?)));
            let variables = view.variables.len();
            for (own, (pair, node)) in here.enumerate() {
                if !subdomain.node_ranges.has(node) {
                    continue;
                }
                of_joint.pairs.push(pair);
                of_joint.records.push(view.records[own]);
                let own = own * variables..(own + 1) * variables;
                of_joint.history.extend_from_slice(&view.history[own]);
            }
            sent.push(of_joint);
        }
        sent
    }

    /// State of all joints of the body, on all ranks.
    pub(crate) fn all_joints(&self) -> Result<Vec<JointValues>, ModelError> {
        let sent = self.ranks.team.all(&self.own_joints())?;
        Ok(joint_values(&self.ranks.joints, sent))
    }

    /// History variables of each block of the body in their global order: its label, whether it is embedded, and its
    /// fields.
    pub(crate) fn all_histories(
        &self,
        which: impl Fn(usize) -> bool,
    ) -> Result<Vec<(String, bool, Vec<HistoryField>)>, ModelError> {
        type Sent = (u32, String, bool, Vec<HistoryField>);
        let numbers = self.ranks.block_numbers.iter();
        let own = self.blocks.iter().zip(numbers).enumerate();
        let own = own.filter(|(index, _)| which(*index));
        let own: Vec<Sent> = own
            .map(|(index, (block, &number))| {
                let embedded = self.is_embedded(index);
                (number, block.label().into(), embedded, block.history())
            })
            .collect();
        let mut all: Vec<Sent> = self.ranks.team.all(&own)?.into_iter().flatten().collect();
        all.sort_by_key(|(number, ..)| *number);
        let all = all.into_iter();
        Ok(all
            .map(|(_, label, embedded, fields)| (label, embedded, fields))
            .collect())
    }

    /// The part of a joint's history that belongs to pairs of this rank; none if this rank has no pair of the joint.
    ///
    /// # Errors
    /// [`EngineError::UnknownJoint`] if the body has no such joint.
    pub(crate) fn here(&self, history: &JointHistory) -> Result<Option<JointHistory>, EngineError> {
        let (name, pairs) = (&history.name, history.records.len());
        let mut joints = self.ranks.joints.iter();
        if !joints.any(|joint| joint.name == *name && joint.pairs.len() == pairs) {
            return Err(EngineError::UnknownJoint {
                name: name.clone(),
                pairs,
            });
        }
        if !self.joints().any(|view| view.name == history.name) {
            return Ok(None);
        }
        let variables = history.variables.len();
        let mut here = JointHistory::new(history.name.clone(), Vec::new(), Vec::new());
        here.variables.clone_from(&history.variables);
        for (pair, (&nodes, record)) in history.nodes.iter().zip(&history.records).enumerate() {
            if self.subdomain.numbering.local(nodes[0] as usize).is_some() {
                here.nodes.push(nodes);
                here.records.push(*record);
                let own = pair * variables..(pair + 1) * variables;
                (here.history).extend_from_slice(history.history.get(own).unwrap_or_default());
            }
        }
        Ok(Some(here))
    }
}

/// A vector of three numbers from the first one of several on.
pub(crate) fn vector(numbers: &[f64], first: usize) -> Vec3 {
    Vec3::new(numbers[first], numbers[first + 1], numbers[first + 2])
}
