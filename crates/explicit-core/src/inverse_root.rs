//! Root of the inverse inertia of a model, with which its highest frequency is computed.

use powerhouse_model::{Mat3, Vec3};

use crate::Model;
use crate::effective_mass::inverse;
use crate::node_group::NodeGroup;

/// `M^-1/2` of every node (kg^-1/2), without the inertia by which fibres couple nodes.
pub(crate) struct InverseRoots {
    /// Roots of nodes with a mass only; zero at members of groups other than the lead, and without mass.
    scalar: Vec<f64>,
    /// Lead nodes with an added mass, or in a fibre with such a node, in rising order, with their roots in the free
    /// directions.
    directed: Vec<(u32, Mat3)>,
}

impl InverseRoots {
    /// Those of a model.
    pub(crate) fn new(model: &Model) -> Self {
        let groups = &model.groups.groups;
        let mass = |node: usize| match model.group_of[node] {
            None => model.mass[node],
            Some(g) => {
                let group = &groups[g as usize];
                let is_lead = group.members[0] as usize == node;
                if is_lead { group.mass } else { 0.0 }
            }
        };
        let root = |mass: f64| if mass > 0.0 { 1.0 / mass.sqrt() } else { 0.0 };
        let own = groups.iter().filter(|group| group.has_directed_mass());
        let in_fibres = model.groups.fibres.groups_beside_directed(groups);
        let own = own.chain(in_fibres.into_iter().map(|group| &groups[group as usize]));
        let own = own.filter(|group| group.mass > 0.0);
        let mut directed: Vec<(u32, Mat3)> = own
            .map(|group| (group.members[0], inverse_root(group)))
            .collect();
        directed.sort_unstable_by_key(|(lead, _)| *lead);
        directed.dedup_by_key(|(lead, _)| *lead);
        Self {
            scalar: (0..model.mass.len()).map(|node| root(mass(node))).collect(),
            directed,
        }
    }

    /// The root of a node with an added mass, or in a fibre with one.
    pub(crate) fn directed(&self, node: u32) -> Option<&Mat3> {
        let place = self.directed.binary_search_by_key(&node, |(lead, _)| *lead);
        Some(&self.directed[place.ok()?].1)
    }

    /// Product of the root of a node with a vector.
    #[inline]
    pub(crate) fn times(&self, node: usize, vector: &Vec3) -> Vec3 {
        match self.directed(node as u32) {
            Some(root) => root * vector,
            None => vector * self.scalar[node],
        }
    }
}

/// Root of the inverse inertia of a group by itself in its free directions.
fn inverse_root(group: &NodeGroup) -> Mat3 {
    let whole = inverse(group.mass * (1.0 + group.added), &group.directed_mass);
    root(&group.condition.project(&whole).0)
}

/// Root of a symmetric positive semi-definite matrix.
fn root(matrix: &Mat3) -> Mat3 {
    let eigen = matrix.symmetric_eigen();
    let values = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
    eigen.eigenvectors * Mat3::from_diagonal(&values) * eigen.eigenvectors.transpose()
}
