//! Content of a file, of either version, before conversion to a mesh.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use powerhouse_model::{MeshError, Vec3};

use super::error::{GmshFault, Located};
use super::shape::Shape;
use crate::degenerate::collapsed;

/// Nodes in the order of the file.
#[derive(Debug, Default)]
pub(super) struct RawNodes {
    pub(super) tags: Vec<u64>,
    pub(super) positions: Vec<Vec3>,
    /// Offsets of each node's number and position (bytes).
    pub(super) offsets: Vec<NodeOffsets>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct NodeOffsets {
    pub(super) tag: usize,
    pub(super) position: usize,
}

/// One element of the file; its nodes are in [`RawElements::nodes`].
#[derive(Clone, Copy, Debug)]
pub(super) struct RawElement {
    pub(super) tag: u64,
    pub(super) shape: Shape,
    /// Number of its geometric entity.
    pub(super) entity: i32,
    pub(super) groups: GroupList,
    /// Index of its first node.
    pub(super) first: usize,
    pub(super) offset: usize,
}

/// Elements in the order of the file.
#[derive(Debug, Default)]
pub(super) struct RawElements {
    pub(super) elements: Vec<RawElement>,
    pub(super) nodes: Vec<u64>,
    /// Partitions that own elements, of version 2.2.
    pub(super) partitions: BTreeSet<i32>,
    /// Offset of the content of the section (bytes).
    pub(super) start: usize,
}

impl RawElements {
    pub(super) fn nodes_of(&self, element: &RawElement) -> &[u64] {
        &self.nodes[element.first..element.first + element.shape.node_count()]
    }
}

/// Physical groups of an element, as an index into [`GroupLists`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub(super) struct GroupList(u32);

impl GroupList {
    /// Empty list of groups.
    pub(super) const NONE: Self = Self(0);
    pub(super) fn is_none(self) -> bool {
        self == Self::NONE
    }
}

/// Combinations of groups that occur, each once.
#[derive(Debug)]
pub(super) struct GroupLists {
    lists: Vec<Vec<i32>>,
    index: HashMap<Vec<i32>, GroupList>,
}

impl Default for GroupLists {
    fn default() -> Self {
        Self {
            lists: vec![Vec::new()],
            index: HashMap::from([(Vec::new(), GroupList::NONE)]),
        }
    }
}

impl GroupLists {
    /// List of these numbers, in any order; signs, which state orientations, are dropped.
    pub(super) fn intern(&mut self, groups: impl IntoIterator<Item = i32>) -> GroupList {
        let mut groups: Vec<i32> = groups.into_iter().map(i32::saturating_abs).collect();
        groups.sort_unstable();
        groups.dedup();
        if let Some(list) = self.index.get(&groups) {
            return *list;
        }
        let list = GroupList(self.lists.len() as u32);
        self.lists.push(groups.clone());
        self.index.insert(groups, list);
        list
    }
    pub(super) fn groups(&self, list: GroupList) -> &[i32] {
        &self.lists[list.0 as usize]
    }
}

/// Names of physical groups by dimension and number.
pub(super) type GroupNames = BTreeMap<(usize, i32), String>;

/// Content of a file.
#[derive(Debug, Default)]
pub(super) struct RawMesh {
    pub(super) nodes: RawNodes,
    pub(super) elements: RawElements,
    pub(super) lists: GroupLists,
    pub(super) names: GroupNames,
    /// Number of elements that repeat another one in a second group.
    pub(super) merged: usize,
    /// Number of solids with repeated nodes that were replaced by what they are.
    pub(super) collapsed: usize,
    /// Names of the skipped sections.
    pub(super) skipped: Vec<String>,
}

impl RawMesh {
    /// Makes wedges, pyramids and tetrahedra of solids with repeated nodes, and triangles of such quadrilaterals.
    pub(super) fn collapse(&mut self) {
        for element in &mut self.elements.elements {
            let nodes = &mut self.elements.nodes[element.first..][..element.shape.node_count()];
            if (1..nodes.len()).all(|at| !nodes[..at].contains(&nodes[at])) {
                continue;
            }
            if let Some(solid) = element
                .shape
                .element()
                .and_then(|kind| collapsed(kind, nodes))
                && let Some(shape) = Shape::of_element(solid.kind)
            {
                let own = solid.nodes();
                nodes[..own.len()].copy_from_slice(own);
                element.shape = shape;
                self.collapsed += 1;
            } else if element.shape == Shape::Quadrilateral4 {
                let next = (0..4).find(|&at| nodes[at] == nodes[(at + 1) % 4]);
                if let Some(at) = next {
                    nodes.rotate_left(at);
                    nodes.copy_within(2.., 1);
                    element.shape = Shape::Triangle3;
                }
            }
        }
    }

    /// Checks numbers and positions as far as they do not depend on the use of the elements.
    pub(super) fn validate(&self) -> Result<(), Located> {
        let known = self.validate_nodes()?;
        let mut seen = HashSet::with_capacity(self.elements.elements.len());
        for element in &self.elements.elements {
            let fault = |fault: GmshFault| Located::new("$Elements", element.offset, fault);
            if !seen.insert(element.tag) {
                let element = element.tag;
                return Err(fault(MeshError::DuplicateElement { element }.into()));
            }
            let nodes = self.elements.nodes_of(element);
            for (local, &node) in nodes.iter().enumerate() {
                let element = element.tag;
                if !known.contains(&node) {
                    return Err(fault(MeshError::DanglingNode { element, node }.into()));
                }
                if nodes[..local].contains(&node) {
                    return Err(fault(MeshError::RepeatedNode { element, node }.into()));
                }
            }
        }
        Ok(())
    }

    fn validate_nodes(&self) -> Result<HashSet<u64>, Located> {
        let nodes = &self.nodes;
        let mut known = HashSet::with_capacity(nodes.tags.len());
        for ((&node, position), at) in nodes.tags.iter().zip(&nodes.positions).zip(&nodes.offsets) {
            if !known.insert(node) {
                let fault = MeshError::DuplicateNode { node };
                return Err(Located::new("$Nodes", at.tag, fault));
            }
            for (axis, &value) in ['x', 'y', 'z'].into_iter().zip(position) {
                if !value.is_finite() {
                    let fault = MeshError::CoordinateNotFinite { node, axis, value };
                    return Err(Located::new("$Nodes", at.position, fault));
                }
            }
        }
        Ok(known)
    }
}
