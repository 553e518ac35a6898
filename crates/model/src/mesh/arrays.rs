//! Meshes whose numbers lie in the memory of another owner.

use super::build::check_position;
use super::copy_on_write::SharedArray;
use super::{ElementKind, Mesh, MeshError};
use crate::Vec3;

/// The arrays of a mesh, by the index of a node or element; such as those of a mapped file.
pub struct MeshArrays {
    /// Position (m) of each node.
    pub positions: SharedArray<Vec3>,
    /// Number of each node in the user's files, no two the same.
    pub node_tags: SharedArray<u64>,
    /// Kind of each element.
    pub kinds: Vec<ElementKind>,
    /// Number of each element in the user's files, no two the same.
    pub element_tags: SharedArray<u64>,
    /// Place of the first corner of each element in the connectivity, and the number of all corners.
    pub offsets: SharedArray<u32>,
    /// Nodes of all elements.
    pub connectivity: SharedArray<u32>,
}

impl Mesh {
    /// A mesh without sets on the arrays of another owner, which are copied when the mesh is changed.
    ///
    /// That numbers of nodes and elements are used once, and that no two elements have the same nodes, is the owner's
    /// promise; a [builder](Mesh::builder) tests it.
    ///
    /// # Errors
    /// [`MeshError::Empty`], [`MeshError::ArrayLength`], [`MeshError::NodeCount`], [`MeshError::DanglingNode`] with the index
    /// of the node, [`MeshError::CoordinateNotFinite`].
    ///
    /// ```
    /// use std::sync::Arc;
    /// use powerhouse_model::{ElementKind, Mesh, MeshArrays, MeshError, Vec3};
    /// let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::from);
    /// let arrays = |connectivity: Vec<u32>| MeshArrays {
    ///     positions: Arc::new(corners),
    ///     node_tags: Arc::new([11, 12, 13, 14]),
    ///     kinds: vec![ElementKind::Tet4],
    ///     element_tags: Arc::new([1]),
    ///     offsets: Arc::new([0, 4]),
    ///     connectivity: Arc::new(connectivity),
    /// };
    /// assert_eq!(Mesh::from_arrays(arrays(vec![0, 1, 2, 3]))?.nodes_of(0), [0, 1, 2, 3]);
    /// let dangling = MeshError::DanglingNode { element: 1, node: 4 };
    /// assert_eq!(Mesh::from_arrays(arrays(vec![0, 1, 2, 4])), Err(dangling));
    /// # Ok::<(), MeshError>(())
    /// ```
    pub fn from_arrays(arrays: MeshArrays) -> Result<Self, MeshError> {
        let mesh = Self {
            positions: arrays.positions.into(),
            node_tags: arrays.node_tags.into(),
            kinds: arrays.kinds.into(),
            element_tags: arrays.element_tags.into(),
            offsets: arrays.offsets.into(),
            connectivity: arrays.connectivity.into(),
            ..Self::default()
        };
        mesh.check_arrays()?;
        Ok(mesh)
    }

    fn check_arrays(&self) -> Result<(), MeshError> {
        let (nodes, elements) = (self.positions.len(), self.kinds.len());
        if elements == 0 {
            return Err(MeshError::Empty);
        }
        let (tags, element_tags) = (self.node_tags.len(), self.element_tags.len());
        let corners = self.offsets.last().map_or(0, |&end| end as usize);
        for (what, found, expected) in [
            ("numbers of nodes", tags, nodes),
            ("numbers of elements", element_tags, elements),
            ("places of corners", self.offsets.len(), elements + 1),
            ("corners", self.connectivity.len(), corners),
        ] {
            if found != expected {
                return Err(MeshError::ArrayLength {
                    what,
                    found,
                    expected,
                });
            }
        }
        for (&tag, position) in self.node_tags.iter().zip(self.positions.iter()) {
            check_position(tag, position)?;
        }
        let ends = self.offsets.windows(2);
        let each = ends.zip(self.kinds.iter()).zip(self.element_tags.iter());
        for ((ends, &kind), &element) in each {
            let (start, end) = (ends[0] as usize, ends[1] as usize);
            let nodes_of = self.connectivity.get(start..end).unwrap_or_default();
            if nodes_of.len() != kind.node_count() {
                return Err(MeshError::NodeCount {
                    element,
                    kind: kind.name(),
                    found: nodes_of.len(),
                    expected: kind.node_count(),
                });
            }
            if let Some(&node) = nodes_of.iter().find(|&&node| node as usize >= nodes) {
                let node = node.into();
                return Err(MeshError::DanglingNode { element, node });
            }
        }
        Ok(())
    }
}
