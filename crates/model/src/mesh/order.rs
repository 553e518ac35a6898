//! Change of the order of elements.

use std::collections::HashMap;
use std::sync::Arc;

use super::{ElementKind, Mesh, MeshError, Vec3};

impl Mesh {
    /// The mesh with a node at the midpoint of every edge of its tetrahedra, which become those of ten nodes; other elements
    /// are unchanged.
    ///
    /// Old nodes keep their indices and numbers; new ones follow, numbered from the greatest number on. Elements, facets and
    /// sets are the same; new nodes belong to the node sets that contain both ends of their edge.
    ///
    /// # Errors
    /// [`MeshError::NoTetrahedra`]; [`MeshError::SidesDoNotFit`] if they share nodes with solids of another kind;
    /// [`MeshError::Numbers`], [`MeshError::TooLarge`].
    ///
    /// ```
    /// use powerhouse_model::{ElementKind, Mesh, Vec3};
    /// let mesh = Mesh::box_of_tets(Vec3::zeros(), Vec3::repeat(2.0), [1, 1, 1], "rock")?;
    /// let mesh = mesh.with_midpoints()?;
    /// assert_eq!((mesh.node_count(), mesh.kind(0)), (27, ElementKind::Tet10));
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn with_midpoints(&self) -> Result<Self, MeshError> {
        let is_tetrahedron = |kind: &ElementKind| kind.first_order() == ElementKind::Tet4;
        if !self.kinds.iter().any(is_tetrahedron) {
            return Err(MeshError::NoTetrahedra);
        }
        let mut mesh = Self {
            positions: self.positions.clone(),
            node_tags: self.node_tags.clone(),
            element_tags: self.element_tags.clone(),
            offsets: vec![0].into(),
            node_sets: self.node_sets.clone(),
            element_sets: self.element_sets.clone(),
            facet_sets: self.facet_sets.clone(),
            ..Self::default()
        };
        let greatest = self.node_tags.iter().copied().max().unwrap_or(0);
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        for element in 0..self.element_count() as u32 {
            let nodes = self.nodes_of(element);
            mesh.connectivity.extend(nodes.iter().copied());
            let kind = match self.kind(element) {
                ElementKind::Tet4 => ElementKind::Tet10,
                kind => kind,
            };
            if self.kind(element) == ElementKind::Tet4 {
                for ends in kind.edges_with_midpoint() {
                    let mut ends = ends.map(|end| nodes[usize::from(end)]);
                    ends.sort_unstable();
                    let count = mesh.positions.len();
                    let middle = *middles.entry(ends).or_insert(count as u32);
                    mesh.connectivity.push(middle);
                    if middle as usize == count {
                        let [a, b] = ends.map(|end| self.positions[end as usize]);
                        let added = (count + 1 - self.node_count()) as u64;
                        let tag = greatest.checked_add(added);
                        mesh.positions.push((a + b) * 0.5);
                        let tag = tag.ok_or(MeshError::Numbers { what: "node" })?;
                        mesh.node_tags.push(tag);
                    }
                }
            }
            let count = mesh.connectivity.len();
            if count >= u32::MAX as usize {
                let what = "element corners";
                return Err(MeshError::TooLarge { what, count });
            }
            mesh.kinds.push(kind);
            mesh.offsets.push(count as u32);
        }
        for nodes in Arc::make_mut(&mut mesh.node_sets).values_mut() {
            let has = |node: &u32| nodes.binary_search(node).is_ok();
            let between = middles.iter().filter(|(ends, _)| ends.iter().all(has));
            let mut added: Vec<u32> = between.map(|(_, &middle)| middle).collect();
            added.sort_unstable();
            // New nodes have higher indices than all nodes before.
            nodes.extend(added);
        }
        mesh.check_shared_nodes()?;
        Ok(mesh)
    }

    /// The mesh with every node between two corners of an element that is farther from the midpoint of its edge than
    /// [`STRAIGHT`](Self::STRAIGHT) permits moved there.
    #[must_use]
    pub fn with_straight_edges(mut self) -> Self {
        let mut moved: Vec<(u32, Vec3)> = Vec::new();
        for element in 0..self.element_count() as u32 {
            let (kind, nodes) = (self.kind(element), self.nodes_of(element));
            let first = kind.first_order().node_count();
            for (i, ends) in kind.edges_with_midpoint().iter().enumerate() {
                let mut ends = ends.map(|end| nodes[usize::from(end)]);
                ends.sort_unstable();
                let [a, b] = ends.map(|end| self.positions[end as usize]);
                let (node, middle) = (nodes[first + i], (a + b) * 0.5);
                let offset = (middle - self.positions[node as usize]).norm();
                if offset > Self::STRAIGHT * (b - a).norm() {
                    moved.push((node, middle));
                }
            }
        }
        for (node, middle) in moved {
            self.positions[node as usize] = middle;
        }
        self
    }
}
