//! The mesh of a bay in which every element has nodes of its own.

use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse_model::{ElementBlock, EngineError, Mesh, MeshArrays, MeshError};

use crate::subdomain::Numbering;

/// A mesh whose elements have nodes of their own: one element of each node of another mesh keeps it, the other ones have copies.
pub(crate) struct Copies {
    /// The mesh; the copies follow the nodes of the other mesh.
    pub(crate) mesh: Mesh,
    /// Node of the other mesh of each node.
    of: Vec<u32>,
    /// Element of each node; the largest number for a node without one.
    pub(super) element_of: Vec<u32>,
}

impl Copies {
    /// The copies of a mesh, of whose elements some are `absent`: those that are not keep the nodes first.
    pub(crate) fn new(mesh: &Mesh, absent: &[bool]) -> Result<Self, MeshError> {
        let count = mesh.node_count();
        let mut of: Vec<u32> = (0..count as u32).collect();
        let mut element_of = vec![u32::MAX; count];
        let elements = 0..mesh.element_count() as u32;
        let mut offsets = vec![0];
        offsets.extend(elements.clone().scan(0, |end, element| {
            *end += mesh.nodes_of(element).len() as u32;
            Some(*end)
        }));
        let mut connectivity = vec![0; offsets.last().map_or(0, |end| *end as usize)];
        let is_absent = |element: u32| absent[element as usize];
        let (last, first): (Vec<u32>, Vec<u32>) = elements.clone().partition(|e| is_absent(*e));
        for element in first.into_iter().chain(last) {
            let start = offsets[element as usize] as usize;
            for (own, &node) in (start..).zip(mesh.nodes_of(element)) {
                let keeper = &mut element_of[node as usize];
                connectivity[own] = if *keeper == u32::MAX {
                    *keeper = element;
                    node
                } else {
                    of.push(node);
                    element_of.push(element);
                    of.len() as u32 - 1
                };
            }
        }
        let positions = of.iter().map(|&node| mesh.positions()[node as usize]);
        let mut tags = mesh.node_tags().to_vec();
        let last = tags.iter().copied().max().unwrap_or(0);
        tags.extend((1..=(of.len() - count) as u64).map(|number| last.saturating_add(number)));
        let mut own = Mesh::from_arrays(MeshArrays {
            positions: Arc::new(positions.collect::<Vec<_>>()),
            node_tags: Arc::new(tags),
            kinds: elements.map(|element| mesh.kind(element)).collect(),
            element_tags: Arc::new(mesh.element_tags().to_vec()),
            offsets: Arc::new(offsets),
            connectivity: Arc::new(connectivity),
        })?;
        for (name, elements) in mesh.element_sets() {
            own.set_element_set(name, elements.clone())?;
        }
        Ok(Self {
            mesh: own,
            of,
            element_of,
        })
    }

    /// Node of the other mesh of each node of this one.
    pub(crate) fn originals(&self) -> &[u32] {
        &self.of
    }

    /// Engine numbers of each copy and of its node of the other mesh.
    pub(crate) fn ties(&self, numbering: &Numbering) -> Vec<[u32; 2]> {
        let local = |node: usize| numbering.local_of[node];
        let copies = (0..self.of.len()).zip(&self.of);
        let copies = copies.filter(|(copy, node)| *copy != **node as usize);
        copies
            .map(|(copy, &node)| [local(node as usize), local(copy)])
            .collect()
    }
}

/// Nodes of a bay on which embedded elements act: each moves as a node of the mesh.
pub(crate) struct Carriers {
    /// Number of nodes of the mesh.
    count: usize,
    /// Engine numbers of a node of the mesh and of the one that carries embedded elements at it, by mesh index.
    carrier_of: BTreeMap<u32, [u32; 2]>,
}

impl Carriers {
    /// Those of a mesh before there are embedded elements.
    pub(crate) fn of(mesh: &Mesh) -> Self {
        Self {
            count: mesh.node_count(),
            carrier_of: BTreeMap::new(),
        }
    }

    /// Engine numbers of the carriers of the nodes of a block.
    ///
    /// # Errors
    /// [`EngineError::BlockNode`] for a node that the mesh does not have.
    pub(crate) fn nodes_of(
        &mut self,
        block: &dyn ElementBlock,
        numbering: &mut Numbering,
    ) -> Result<Vec<u32>, EngineError> {
        let mut carriers = Vec::with_capacity(block.nodes().len());
        for &node in block.nodes() {
            if node as usize >= self.count {
                return Err(EngineError::BlockNode {
                    set: block.label().into(),
                    node,
                });
            }
            let [_, carrier] = *self.carrier_of.entry(node).or_insert_with(|| {
                let added = numbering.append() as usize;
                [node as usize, added].map(|index| numbering.local_of[index])
            });
            carriers.push(carrier);
        }
        Ok(carriers)
    }

    /// Engine numbers of each node of the mesh and of its carrier.
    pub(crate) fn ties(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.carrier_of.values().copied()
    }
}

#[cfg(test)]
mod tests {
    use powerhouse_model::Vec3;

    use super::*;

    /// Elements have nodes of their own at the places of those of the mesh, and elements that are present keep these.
    #[test]
    fn every_element_has_nodes_of_its_own() {
        let high = Vec3::new(2.0, 3.0, 1.0);
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), high, [2, 3, 1], "rock").unwrap();
        let mut absent = vec![false; mesh.element_count()];
        absent[0] = true;
        let copies = Copies::new(&mesh, &absent).unwrap();
        let mut seen = std::collections::BTreeSet::new();
        for element in 0..mesh.element_count() as u32 {
            let both = copies
                .mesh
                .nodes_of(element)
                .iter()
                .zip(mesh.nodes_of(element));
            for (&own, &node) in both {
                assert!(seen.insert(own));
                assert_eq!(copies.originals()[own as usize], node);
                assert_eq!(copies.element_of[own as usize], element);
                let [a, b] = [&copies.mesh, &mesh].map(Mesh::positions);
                assert_eq!(a[own as usize], b[node as usize]);
            }
        }
        assert_eq!(seen.len(), 8 * mesh.element_count());
        assert_eq!(copies.mesh.node_count(), seen.len());
        // The node in the middle of the absent element and three others is kept by one of these.
        let shared = mesh.nodes_of(0).iter().find(|node| {
            let sharing = (1..6).filter(|e| mesh.nodes_of(*e).contains(node));
            sharing.count() == 3
        });
        assert_ne!(copies.element_of[*shared.unwrap() as usize], 0);
        assert_eq!(copies.mesh.element_set("rock"), mesh.element_set("rock"));
    }
}
