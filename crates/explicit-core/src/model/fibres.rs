//! Fibres of a model: which groups of nodes they take.

use std::collections::BTreeMap;

use powerhouse_model::{EngineError, Fibre, FrequencyBound, Mat3, ModelError, NodeCoupling, Vec3};

use super::Model;
use crate::fibres::Fibres;
use crate::groups::Groups;
use crate::node_group::NodeGroup;

/// A fibre by the lead nodes of its groups, in rising order, with its added inertia over mass (1).
type LeadFibre = (Vec<u32>, f64);

impl Model {
    /// Bounds on the frequency of every active element of the mesh by itself, with its own mass; none of a model on
    /// several ranks or with a device, which cannot have fibres.
    pub fn element_frequencies(&self) -> Option<Vec<FrequencyBound>> {
        if !self.takes_fibres() {
            return None;
        }
        let count = self.mesh.element_count();
        let bounds = self
            .blocks
            .iter()
            .flat_map(|block| block.frequency_bounds());
        Some(
            bounds
                .filter(|bound| (bound.element as usize) < count)
                .collect(),
        )
    }

    /// Whether the model can have fibres: on one rank and without a device.
    pub(crate) fn takes_fibres(&self) -> bool {
        self.ranks.is_single() && self.device.is_none()
    }

    /// Sets the [fibres](Fibre) of the model, in place of those before, and so its stable step. Those with common
    /// nodes, or nodes that move as one, are one; those without relative motion are left out.
    ///
    /// # Errors
    /// [`EngineError::FibreNode`] for a node without mass, nodes of two constraints in one fibre, or two of a constraint
    /// that cannot be solved so ([`coupled`](powerhouse_model::Constraint::coupled)); [`EngineError::UnknownNode`]; an added inertia out of range; a model on several ranks or with a device.
    pub fn set_fibres(&mut self, fibres: &[Fibre]) -> Result<(), ModelError> {
        let is_wanted = fibres.iter().any(|fibre| fibre.added > 0.0);
        if is_wanted && !self.ranks.is_single() {
            return Err(self.ranks.one_rank_only("a model with fibres").into());
        }
        if is_wanted && self.device.is_some() {
            let reason = "they are computed on the host alone";
            return Err(ModelError::refused("fibres", reason));
        }
        if is_wanted && self.is_delayed() {
            let reason = "a slice or bay under waves along y takes none; leave them out";
            return Err(ModelError::refused("fibres", reason));
        }
        let lead_of = self.leads();
        let found = self.fibres_of_leads(fibres, &lead_of)?;
        // Of a model that is refused these fibres the constraints are prepared for those before again.
        self.prepared = None;
        self.couple_constraints(&found)?;
        self.complete_kick();
        self.regroup(&found);
        self.spectrum = None;
        Ok(())
    }

    /// The lead node of each node's group, for a node without a group itself.
    fn leads(&self) -> Vec<u32> {
        let mut lead_of: Vec<u32> = (0..self.mass.len() as u32).collect();
        for group in &self.groups.groups {
            for &member in &group.members {
                lead_of[member as usize] = group.members[0];
            }
        }
        lead_of
    }

    fn fibres_of_leads(
        &self,
        fibres: &[Fibre],
        lead_of: &[u32],
    ) -> Result<Vec<LeadFibre>, EngineError> {
        let count = self.mesh.node_count();
        let groups = self.groups.groups.iter();
        let tied: Vec<Vec<u32>> = groups
            .filter(|group| group.members.len() > 1)
            .map(|group| {
                let nodes = group.members.iter().map(|&node| self.mesh_node(node));
                nodes.filter(|&node| (node as usize) < count).collect()
            })
            .collect();
        let merged = Fibre::merged(fibres, tied.iter().map(|nodes| &nodes[..]), count)?;
        let mut found = Vec::new();
        for fibre in merged.into_iter().filter(|fibre| fibre.added > 0.0) {
            let local = |&node: &u32| self.subdomain.numbering.local(node as usize);
            let mut leads = Vec::with_capacity(fibre.nodes.len());
            for node in &fibre.nodes {
                match local(node).filter(|&local| self.mass[local] > 0.0) {
                    Some(local) => leads.push(lead_of[local]),
                    None => {
                        return Err(EngineError::FibreNode {
                            node: self.mesh.node_tags()[*node as usize],
                            reason: "it has no mass",
                        });
                    }
                }
            }
            leads.sort_unstable();
            leads.dedup();
            let constraint_of = |lead: &u32| {
                let group = self.group_of[*lead as usize]? as usize;
                let mut all = self.constraints.iter();
                all.position(|bound| bound.groups().contains(&group))
            };
            let mut bound = leads.iter().map(|lead| (lead, constraint_of(lead)));
            let first = bound.find_map(|(_, constraint)| constraint);
            if let Some((&node, _)) = bound.find(|(_, own)| own.is_some() && *own != first) {
                return Err(EngineError::FibreNode {
                    node: self.node_tag(node as usize),
                    reason: "a node of another joint is in the same one",
                });
            }
            if leads.len() > 1 {
                found.push((leads, fibre.added));
            }
        }
        Ok(found)
    }

    /// Lets constraints know which of their nodes fibres couple, with responses that are yet to be computed.
    fn couple_constraints(&mut self, fibres: &[LeadFibre]) -> Result<(), EngineError> {
        for index in 0..self.constraints.len() {
            let own = self.constraints[index].groups();
            let mut couplings = Vec::new();
            let mut second = None;
            for (leads, _) in fibres {
                let groups = leads.iter().filter_map(|&lead| {
                    let group = self.group_of[lead as usize]?;
                    own.contains(&(group as usize))
                        .then(|| (lead, group - own.start as u32))
                });
                let bound: Vec<(u32, u32)> = groups.collect();
                for (i, &(_, first)) in bound.iter().enumerate() {
                    for &(lead, other) in &bound[i + 1..] {
                        second.get_or_insert(lead);
                        couplings.push(NodeCoupling {
                            nodes: [first, other],
                            response: Mat3::zeros(),
                        });
                    }
                }
            }
            let coupled = self.constraints[index].constraint.coupled();
            let is_solved = coupled.is_some();
            if let Some(coupled) = coupled {
                coupled.couple(&couplings);
            }
            if let (false, Some(node)) = (is_solved, second) {
                return Err(EngineError::FibreNode {
                    node: self.node_tag(node as usize),
                    reason: "its constraint cannot be solved with another of its nodes in the same one",
                });
            }
        }
        Ok(())
    }

    fn mesh_node(&self, node: u32) -> u32 {
        self.subdomain.numbering.mesh_of[node as usize]
    }

    /// Makes a group of each node of a fibre, and plain nodes of those that were groups for a fibre alone.
    fn regroup(&mut self, fibres: &[LeadFibre]) {
        let constrained = self.groups.constrained();
        let nodes_of_constraints: Vec<u32> = (self.constraints.iter())
            .flat_map(|bound| bound.nodes())
            .copied()
            .collect();
        let mut groups = core::mem::take(&mut self.groups.groups);
        let leads = groups.iter().map(|group| group.members[0]);
        let origins = core::mem::take(&mut self.groups.origin);
        let origins: BTreeMap<u32, Vec3> = leads.zip(origins).collect();
        groups.iter_mut().for_each(|group| group.added = 0.0);
        let mut others = groups.split_off(constrained);
        others.retain(|group| group.held_axes() != Some([false; 3]));
        let mut added_of: BTreeMap<u32, f64> = BTreeMap::new();
        for (leads, added) in fibres {
            added_of.extend(leads.iter().map(|&lead| (lead, *added)));
        }
        let all = &added_of;
        for group in groups.iter_mut().chain(&mut others) {
            group.added = all.get(&group.members[0]).copied().unwrap_or(0.0);
        }
        let known: Vec<u32> = (groups.iter().chain(&others))
            .filter(|group| group.added > 0.0)
            .map(|group| group.members[0])
            .collect();
        known.iter().for_each(|lead| {
            added_of.remove(lead);
        });
        others.extend(added_of.into_iter().map(|(node, added)| NodeGroup {
            members: vec![node],
            mass: self.mass[node as usize],
            mass_damping: self.mass_damping.get(node as usize).copied().unwrap_or(0.0),
            added,
            ..NodeGroup::default()
        }));
        others.sort_unstable_by_key(|group| group.members[0]);
        let (rollers, others): (Vec<_>, Vec<_>) =
            (others.into_iter()).partition(|group| group.held_axes().is_some());
        let (of_fibres, others): (Vec<_>, Vec<_>) =
            (others.into_iter()).partition(NodeGroup::is_fibre_node);
        groups.extend(others);
        groups.extend(of_fibres);
        groups.extend(rollers);
        self.group_of.fill(None);
        for (index, group) in (0..).zip(&groups) {
            for &member in &group.members {
                self.group_of[member as usize] = Some(index);
            }
        }
        let of_leads = fibres.iter().map(|(leads, added)| {
            let mut own: Vec<u32> = (leads.iter())
                .filter_map(|&lead| self.group_of[lead as usize])
                .collect();
            own.sort_unstable();
            (own, *added)
        });
        let of_leads: Vec<(Vec<u32>, f64)> = of_leads.collect();
        let of_fibres = Fibres::new(&of_leads, &groups, constrained);
        let origin = |group: &NodeGroup| origins.get(&group.members[0]).copied();
        let origins = (groups.iter())
            .map(|group| origin(group).unwrap_or_default())
            .collect();
        self.groups = Groups::new(groups, &nodes_of_constraints, &self.subdomain.slots);
        (self.groups.fibres, self.groups.origin) = (of_fibres, origins);
        let kicked = self.groups.kicked_of(&self.group_of);
        self.loads.regroup(&kicked, self.groups.kicked());
        self.renew_external();
    }
}
