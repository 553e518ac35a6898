//! Reverse Cuthill-McKee numbering.

use powerhouse_model::Mesh;

/// Node-to-element incidence, as offsets and a flat list.
pub(crate) struct Incidence {
    offsets: Vec<u32>,
    elements: Vec<u32>,
}

impl Incidence {
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let mut offsets = vec![0u32; mesh.node_count() + 1];
        for element in 0..mesh.element_count() as u32 {
            for &node in mesh.nodes_of(element) {
                offsets[node as usize + 1] += 1;
            }
        }
        for i in 1..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        let mut next = offsets.clone();
        let mut elements = vec![0u32; offsets[mesh.node_count()] as usize];
        for element in 0..mesh.element_count() as u32 {
            for &node in mesh.nodes_of(element) {
                let end = &mut next[node as usize];
                elements[*end as usize] = element;
                *end += 1;
            }
        }
        Self { offsets, elements }
    }

    pub(crate) fn around(&self, node: u32) -> &[u32] {
        let node = node as usize;
        &self.elements[self.offsets[node] as usize..self.offsets[node + 1] as usize]
    }
}

/// Nodes in reverse Cuthill-McKee order (Cuthill & McKee 1969, George 1971), as mesh indices. Ties are broken
/// by the user's number of the node, so that the order of nodes and elements in the mesh file does not matter.
pub(crate) fn reverse_cuthill_mckee(mesh: &Mesh, incidence: &Incidence) -> Vec<u32> {
    let count = mesh.node_count();
    let mut search = Search {
        mesh,
        incidence,
        mark: vec![0; count],
        stamp: 0,
        degree: (0..count as u32)
            .map(|node| incidence.around(node).len() as u32)
            .collect(),
    };
    let mut numbered = vec![false; count];
    let mut order = Vec::with_capacity(count);
    let mut by_degree: Vec<u32> = (0..count as u32).collect();
    by_degree.sort_by_key(|&node| search.key(node));
    for &seed in &by_degree {
        if numbered[seed as usize] {
            continue;
        }
        let start = search.far_end(seed);
        let component = search.levels(start).0;
        for &node in &component {
            numbered[node as usize] = true;
        }
        order.extend_from_slice(&component);
    }
    order.reverse();
    order
}

struct Search<'a> {
    mesh: &'a Mesh,
    incidence: &'a Incidence,
    mark: Vec<u32>,
    stamp: u32,
    degree: Vec<u32>,
}

impl Search<'_> {
    /// Number of elements at a node, and the user's number of the node.
    fn key(&self, node: u32) -> (u32, u64) {
        let tags = self.mesh.node_tags();
        (self.degree[node as usize], tags[node as usize])
    }

    /// Breadth-first order from a node, neighbours by rising degree; the depth and the start of
    /// the last level.
    fn levels(&mut self, start: u32) -> (Vec<u32>, usize, usize) {
        self.stamp += 1;
        let mut order = vec![start];
        self.mark[start as usize] = self.stamp;
        let (mut depth, mut level, mut end) = (0, 0, 1);
        let mut next = 0;
        while next < order.len() {
            if next == end {
                depth += 1;
                level = end;
                end = order.len();
            }
            let first = order.len();
            for &element in self.incidence.around(order[next]) {
                for &neighbour in self.mesh.nodes_of(element) {
                    if self.mark[neighbour as usize] != self.stamp {
                        self.mark[neighbour as usize] = self.stamp;
                        order.push(neighbour);
                    }
                }
            }
            order[first..].sort_by_key(|&node| self.key(node));
            next += 1;
        }
        (order, depth, level)
    }

    /// A pseudo-peripheral node (George & Liu 1979).
    fn far_end(&mut self, seed: u32) -> u32 {
        let mut start = seed;
        let (mut order, mut depth, mut level) = self.levels(start);
        loop {
            let candidate = order[level..]
                .iter()
                .copied()
                .min_by_key(|&node| self.key(node))
                .unwrap_or(start);
            let (next_order, next_depth, next_level) = self.levels(candidate);
            if next_depth <= depth {
                return start;
            }
            (start, order, depth, level) = (candidate, next_order, next_depth, next_level);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use powerhouse_model::{ElementKind, Vec3};

    /// A chain of bars with shuffled node numbers is numbered from end to end.
    #[test]
    fn a_chain_is_numbered_from_end_to_end() {
        let mut builder = Mesh::builder();
        let count = 101_u64;
        let shuffled = |i: u64| (i * 37) % count + 1;
        for i in 0..count {
            builder.node(shuffled(i), Vec3::new(i as f64, 0.0, 0.0));
        }
        for i in 0..count - 1 {
            let ends = [shuffled(i), shuffled(i + 1)];
            builder.element(i + 1, ElementKind::Bar2, &ends, &["chain"]);
        }
        let mesh = builder.build().unwrap();
        let order = reverse_cuthill_mckee(&mesh, &Incidence::of(&mesh));
        for pair in order.windows(2) {
            let step = mesh.positions()[pair[1] as usize] - mesh.positions()[pair[0] as usize];
            assert_eq!(step.norm(), 1.0);
        }
    }

    /// Every node of a mesh in several parts is numbered once.
    #[test]
    fn parts_of_a_mesh_are_all_numbered() {
        let mut builder = Mesh::builder();
        for i in 0..8_u64 {
            builder.node(i + 1, Vec3::new(i as f64, 0.0, 0.0));
        }
        for i in 0..4_u64 {
            builder.element(i + 1, ElementKind::Bar2, &[2 * i + 1, 2 * i + 2], &["bars"]);
        }
        let mesh = builder.build().unwrap();
        let mut order = reverse_cuthill_mckee(&mesh, &Incidence::of(&mesh));
        order.sort_unstable();
        assert_eq!(order, (0..8).collect::<Vec<u32>>());
    }
}
