//! Node groups of a model: ties, impedance, supports, prescribed motion and constraints by node.

use std::collections::BTreeMap;

use powerhouse_model::{
    AddedMass, Constraint, ConstraintParts, EngineError, Mat3, Mesh, NodalImpedance, Prescribed,
    Support, Vec3,
};

use crate::node_group::NodeGroup;
use crate::ranks::ABSENT;
use crate::subdomain::Numbering;

pub(super) fn engine_node(part: &str, node: u32, numbers: &[u32]) -> Result<u32, EngineError> {
    let found = numbers.get(node as usize).copied();
    found.ok_or_else(|| EngineError::UnknownNode {
        part: part.into(),
        node,
        count: numbers.len(),
    })
}

pub(super) fn engine_nodes(
    part: &str,
    nodes: &[u32],
    numbers: &[u32],
    mesh: &Mesh,
) -> Result<Vec<u32>, EngineError> {
    let engine: Vec<u32> = nodes
        .iter()
        .map(|&node| engine_node(part, node, numbers))
        .collect::<Result<_, _>>()?;
    let mut sorted = nodes.to_vec();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(EngineError::NodeTwice {
            part: part.into(),
            node: tag(mesh, pair[0]),
        }),
        None => Ok(engine),
    }
}

/// The user's number of a mesh node; an additional node has its index.
pub(super) fn tag(mesh: &Mesh, node: u32) -> u64 {
    let tags = mesh.node_tags();
    tags.get(node as usize).copied().unwrap_or(u64::from(node))
}

/// Node groups under construction.
pub(super) struct GroupPlan<'a> {
    mesh: &'a Mesh,
    numbering: &'a Numbering,
    /// Whether each engine node is one of this rank: conditions of others need no group.
    is_here: &'a [bool],
    /// Union-find over engine nodes.
    parent: Vec<u32>,
    /// Contributions of each node to its group; nodes without a group have no entry.
    nodes: BTreeMap<u32, NodeGroup>,
}

impl<'a> GroupPlan<'a> {
    pub(super) fn new(mesh: &'a Mesh, numbering: &'a Numbering, is_here: &'a [bool]) -> Self {
        let node_count = is_here.len();
        Self {
            mesh,
            numbering,
            is_here,
            parent: (0..node_count as u32).collect(),
            nodes: BTreeMap::new(),
        }
    }
    fn numbers(&self) -> &'a [u32] {
        &self.numbering.local_of[..self.mesh.node_count()]
    }
    fn tag_of(&self, engine: u32) -> u64 {
        tag(self.mesh, self.numbering.mesh_of[engine as usize])
    }
    fn root(&self, mut node: u32) -> u32 {
        while self.parent[node as usize] != node {
            node = self.parent[node as usize];
        }
        node
    }
    /// The group of a node, its tied nodes included; all ties must have been added before.
    fn entry(&mut self, engine: u32) -> &mut NodeGroup {
        let root = self.root(engine);
        self.nodes.entry(root).or_default()
    }

    pub(super) fn tie(&mut self, pairs: &[(u32, u32)]) -> Result<(), EngineError> {
        for &(a, b) in pairs {
            let a = engine_node("a periodic pair", a, self.numbers())?;
            let b = engine_node("a periodic pair", b, self.numbers())?;
            let (a, b) = (self.root(a), self.root(b));
            self.parent[a.max(b) as usize] = a.min(b);
        }
        Ok(())
    }

    /// Ties pairs of engine nodes.
    pub(super) fn tie_copies(&mut self, ties: &[[u32; 2]]) {
        for ties in ties {
            let [a, b] = ties.map(|node| self.root(node));
            self.parent[a.max(b) as usize] = a.min(b);
        }
    }

    /// Takes inertia (kg) by direction from each engine node, in its group: the largest of a group is to be taken from its mass
    /// later, and what is less in other directions has a mass of its own.
    pub(super) fn reduce_masses(&mut self, lost: &[Vec3]) {
        for (node, lost) in (0..).zip(lost) {
            let less = Vec3::repeat(lost.max()) - lost;
            self.entry(node).directed_mass += Mat3::from_diagonal(&less);
        }
    }

    pub(super) fn add_impedance(
        &mut self,
        engine: u32,
        item: &NodalImpedance,
        delayed: bool,
    ) -> Result<(), EngineError> {
        for (what, matrix) in [("spring", &item.spring), ("dashpot", &item.dashpot)] {
            if !is_positive_semidefinite(matrix) {
                let node = self.tag_of(engine);
                return Err(EngineError::Impedance { what, node });
            }
        }
        let turned = item.gyroscopic + item.gyroscopic.transpose();
        let skew = turned.amax() <= 1e-9 * item.gyroscopic.amax();
        if !skew || !(delayed || item.gyroscopic == Mat3::zeros()) {
            return Err(EngineError::Gyroscopic {
                node: self.tag_of(engine),
            });
        }
        if !self.is_here[engine as usize] {
            return Ok(());
        }
        let group = self.entry(engine);
        group.gyroscopic += item.gyroscopic;
        group.spring += item.spring;
        group.dashpot += item.dashpot;
        Ok(())
    }

    pub(super) fn add_mass(&mut self, engine: u32, item: &AddedMass) -> Result<(), EngineError> {
        if !is_positive_semidefinite(&item.mass) {
            let (node, reason) = (
                self.tag_of(engine),
                "it is not symmetric and positive semi-definite",
            );
            return Err(EngineError::AddedMass { node, reason });
        }
        if self.is_here[engine as usize] && item.mass != Mat3::zeros() {
            self.entry(engine).directed_mass += item.mass;
        }
        Ok(())
    }

    pub(super) fn hold(&mut self, support: &Support) -> Result<(), EngineError> {
        let directions = support.directions()?;
        for &node in support.nodes() {
            let engine = engine_node("a support", node, self.numbers())?;
            if !self.is_here[engine as usize] {
                continue;
            }
            let group = self.entry(engine);
            for &direction in &directions {
                group.condition.hold(direction);
            }
        }
        Ok(())
    }

    pub(super) fn prescribe(
        &mut self,
        prescribed: &Prescribed,
        motion: usize,
    ) -> Result<(), EngineError> {
        let direction = EngineError::check_direction("a prescribed motion", prescribed.direction)?;
        for &node in &prescribed.nodes {
            let engine = engine_node("a prescribed motion", node, self.numbers())?;
            if !self.is_here[engine as usize] {
                continue;
            }
            if !self.entry(engine).condition.prescribe(direction, motion) {
                let node = self.tag_of(engine);
                return Err(EngineError::SupportConflict { node });
            }
        }
        Ok(())
    }

    /// Engine nodes of each constraint.
    pub(super) fn constrain(
        &mut self,
        constraints: &[Box<dyn Constraint>],
    ) -> Result<Vec<Vec<u32>>, EngineError> {
        let mut owner: BTreeMap<u32, &str> = BTreeMap::new();
        let mut all = Vec::new();
        for constraint in constraints {
            let part = format!("constraint '{}'", constraint.name());
            let nodes = engine_nodes(&part, constraint.nodes(), self.numbers(), self.mesh)?;
            self.check_parts(constraint.as_ref())?;
            for &node in &nodes {
                if let Some(first) = owner.insert(self.root(node), constraint.name()) {
                    return Err(EngineError::ConstrainedTwice {
                        node: self.tag_of(node),
                        first: first.into(),
                        second: constraint.name().into(),
                    });
                }
                if self.is_here[node as usize] {
                    self.entry(node);
                }
            }
            all.push(nodes);
        }
        Ok(all)
    }

    /// Refuses a constraint whose parts do not have each of its nodes once.
    fn check_parts(&self, constraint: &dyn Constraint) -> Result<(), EngineError> {
        let (mut own, parts) = (constraint.nodes().to_vec(), ConstraintParts::of(constraint));
        let mut of_parts = parts.nodes().to_vec();
        own.sort_unstable();
        of_parts.sort_unstable();
        if own == of_parts {
            return Ok(());
        }
        let first = own.iter().zip(&of_parts).find(|(a, b)| a != b);
        let rest = own.len().min(of_parts.len());
        let longer = own.get(rest).or(of_parts.get(rest)).copied();
        let node = first.map(|(&a, &b)| a.min(b)).or(longer);
        Err(EngineError::ConstraintParts {
            constraint: constraint.name().into(),
            node: tag(self.mesh, node.unwrap_or_default()),
        })
    }

    /// The groups, and the group of each node, in the order that the page of [`crate::groups`] states: nodes of
    /// constraints first, then others in rising order of leads, roller nodes last. Groups have the numbers that nodes have
    /// on this rank, which also order masses and damping; groups of other ranks are left out.
    pub(super) fn finish(
        mut self,
        (mass, damping): (&[f64], &[f64]),
        constrained: &[Vec<u32>],
        on_rank: impl Fn(u32) -> u32,
    ) -> (Vec<NodeGroup>, Vec<Option<u32>>) {
        let nodes = 0..self.parent.len() as u32;
        // A tied node forms a group even without other conditions; its root has a lower number.
        for node in nodes.clone() {
            let root = self.root(node);
            if root != node {
                self.nodes.entry(root).or_default();
            }
        }
        for node in nodes {
            let root = self.root(node);
            let node = on_rank(node);
            if node == ABSENT {
                continue;
            }
            if let Some(group) = self.nodes.get_mut(&root) {
                group.members.push(node);
                group.mass += mass[node as usize];
                group.mass_damping += damping.get(node as usize).copied().unwrap_or(0.0);
            }
        }
        let here = (self.nodes.values()).filter(|group| !group.members.is_empty());
        let mut groups = Vec::with_capacity(here.count());
        for &node in constrained.iter().flatten() {
            groups.extend(self.nodes.remove(&self.root(node)));
        }
        let others = self.nodes.into_values();
        let others = others.filter(|group| !group.members.is_empty());
        let (roller_nodes, others): (Vec<_>, Vec<_>) =
            others.partition(|group| group.held_axes().is_some());
        groups.extend(others);
        groups.extend(roller_nodes);
        let mut group_of = vec![None; mass.len()];
        for (g, group) in groups.iter().enumerate() {
            for &node in &group.members {
                group_of[node as usize] = Some(g as u32);
            }
        }
        (groups, group_of)
    }
}

fn is_positive_semidefinite(matrix: &Mat3) -> bool {
    let scale = matrix.amax();
    let symmetric = (matrix - matrix.transpose()).amax() <= 1e-9 * scale;
    scale.is_finite() && symmetric && matrix.symmetric_eigenvalues().min() >= -1e-9 * scale
}
