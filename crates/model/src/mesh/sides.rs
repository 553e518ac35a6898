//! Adjacency of element sides with the same nodes.

use super::{Facet, Mesh};

/// Table of facets in buckets by their lowest node; eight bytes a facet, four a node.
pub(super) struct SideTable {
    /// Start of the bucket of each node.
    starts: Vec<u32>,
    /// Facets, inside a bucket in the order of their sorted nodes, then of the facets themselves.
    facets: Vec<Facet>,
}

/// Sorted nodes of a side; missing ones are `u32::MAX`.
type Key = [u32; 6];

fn key_of(nodes: impl Iterator<Item = u32>) -> Option<Key> {
    let mut key = [u32::MAX; 6];
    for (i, node) in nodes.enumerate() {
        *key.get_mut(i)? = node;
    }
    key.sort_unstable();
    Some(key)
}

impl Mesh {
    fn side_key(&self, facet: Facet) -> Key {
        let nodes = self.nodes_of(facet.element);
        let side = self.kind(facet.element).sides()[facet.side as usize];
        let mut key = [u32::MAX; 6];
        for (entry, &corner) in key.iter_mut().zip(side) {
            *entry = nodes[corner as usize];
        }
        key.sort_unstable();
        key
    }

    fn all_sides(&self) -> impl Iterator<Item = Facet> + '_ {
        (0..self.element_count() as u32).flat_map(|element| {
            (0..self.kind(element).sides().len() as u8).map(move |side| Facet { element, side })
        })
    }

    /// The facets of the surface of the mesh, cavities included: sides of elements without a neighbour, in
    /// rising order.
    ///
    /// A quadrilateral side next to two triangles counts as surface, and so do the triangles.
    pub fn boundary_facets(&self) -> Vec<Facet> {
        SideTable::of_all(self).alone(self)
    }

    /// The facets of the surface of the chosen elements, as [`boundary_facets`](Self::boundary_facets): their sides without
    /// a chosen neighbour.
    ///
    /// ```
    /// use powerhouse_model::{Mesh, Vec3};
    /// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 1.0, 1.0), [2, 1, 1], "rock")?;
    /// assert_eq!(mesh.boundary_facets().len(), 10);
    /// assert_eq!(mesh.boundary_facets_of(|element| element == 0).len(), 6);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn boundary_facets_of(&self, chosen: impl Fn(u32) -> bool) -> Vec<Facet> {
        SideTable::of(self, |facet| chosen(facet.element)).alone(self)
    }

    /// The chosen sides without a chosen neighbour, in rising order; `chosen` decides by the sorted nodes of a side.
    pub(super) fn alone_among(&self, chosen: impl Fn(&[u32]) -> bool) -> Vec<Facet> {
        SideTable::of_nodes(self, chosen).alone(self)
    }
}

impl SideTable {
    /// The table of all sides of all solid elements.
    pub(super) fn of_all(mesh: &Mesh) -> Self {
        Self::of(mesh, |_| true)
    }

    /// The table of the sides all of whose nodes are chosen.
    pub(super) fn with_all_nodes(mesh: &Mesh, chosen: impl Fn(u32) -> bool) -> Self {
        Self::of_nodes(mesh, |nodes| nodes.iter().all(|&node| chosen(node)))
    }

    /// The table of the sides that are chosen by their sorted nodes.
    fn of_nodes(mesh: &Mesh, chosen: impl Fn(&[u32]) -> bool) -> Self {
        Self::of(mesh, |facet| {
            let key = mesh.side_key(facet);
            chosen(&key[..key.partition_point(|&node| node != u32::MAX)])
        })
    }

    fn of(mesh: &Mesh, chosen: impl Fn(Facet) -> bool) -> Self {
        let sides = || mesh.all_sides().filter(|&facet| chosen(facet));
        let mut starts = vec![0_u32; mesh.node_count() + 1];
        for facet in sides() {
            starts[mesh.side_key(facet)[0] as usize + 1] += 1;
        }
        for node in 0..mesh.node_count() {
            starts[node + 1] += starts[node];
        }
        let nothing = Facet {
            element: 0,
            side: 0,
        };
        let mut facets = vec![nothing; starts[mesh.node_count()] as usize];
        let mut next = starts.clone();
        for facet in sides() {
            let end = &mut next[mesh.side_key(facet)[0] as usize];
            facets[*end as usize] = facet;
            *end += 1;
        }
        for node in 0..mesh.node_count() {
            let bucket = starts[node] as usize..starts[node + 1] as usize;
            facets[bucket].sort_unstable_by_key(|&facet| (mesh.side_key(facet), facet));
        }
        Self { starts, facets }
    }

    /// All facets with these nodes, given in any order: none, one on the surface, two inside.
    pub(super) fn with_nodes(&self, mesh: &Mesh, nodes: &[u32]) -> &[Facet] {
        let Some(key) = key_of(nodes.iter().copied()).filter(|key| key[2] != u32::MAX) else {
            return &[];
        };
        let lowest = key[0] as usize;
        let bucket = &self.facets[self.starts[lowest] as usize..self.starts[lowest + 1] as usize];
        let from = bucket.partition_point(|&facet| mesh.side_key(facet) < key);
        let to = bucket.partition_point(|&facet| mesh.side_key(facet) <= key);
        &bucket[from..to]
    }

    /// Pairs of facets with the same nodes.
    pub(super) fn neighbours(&self, mesh: &Mesh) -> Vec<[Facet; 2]> {
        self.facets
            .chunk_by(|&a, &b| mesh.side_key(a) == mesh.side_key(b))
            .filter_map(|run| <[Facet; 2]>::try_from(run).ok())
            .collect()
    }

    fn alone(&self, mesh: &Mesh) -> Vec<Facet> {
        let mut alone: Vec<Facet> = self
            .facets
            .chunk_by(|&a, &b| mesh.side_key(a) == mesh.side_key(b))
            .filter(|run| run.len() == 1)
            .map(|run| run[0])
            .collect();
        alone.sort_unstable();
        alone
    }
}
