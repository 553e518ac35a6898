//! Partition of the elements of a mesh into blocks.

use powerhouse_model::{Checksum, EngineError, Mesh, Vec3};
use serde::{Deserialize, Serialize};

use crate::numbering::{Incidence, reverse_cuthill_mckee};

/// Elements and nodes of one block of a [`Partition`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct PartitionBlock {
    /// Index of the element set among those that were divided.
    pub set: usize,
    /// Level of local time stepping: the block takes steps of `dt / 2^level`. Zero for all blocks at present.
    pub level: u8,
    /// Mesh indices of its elements in the order of computation.
    pub elements: Vec<u32>,
    /// Mesh indices of its nodes: first those that it owns, then those that it borrows from other blocks.
    pub nodes: Vec<u32>,
    /// Number of nodes that it owns.
    pub owned: usize,
    /// Estimated cost of a step of each element, in units of
    /// [`BlockFactory::relative_cost`](powerhouse_model::BlockFactory::relative_cost).
    pub element_cost: f64,
}

impl PartitionBlock {
    /// Nodes (mesh indices) that belong to this block: it is the first block that has them.
    pub fn owned_nodes(&self) -> &[u32] {
        &self.nodes[..self.owned]
    }
    /// Nodes (mesh indices) that belong to blocks before this one, and orphan nodes in the last block.
    pub fn borrowed_nodes(&self) -> &[u32] {
        &self.nodes[self.owned..]
    }
    /// Estimated cost of a step, in the unit of [`element_cost`](Self::element_cost).
    pub fn cost(&self) -> f64 {
        self.elements.len() as f64 * self.element_cost
    }
}

/// Partition of the elements of a mesh into blocks, in the global order of the blocks.
///
/// It is a function of mesh, element sets with their costs, and block size alone: neither the number of threads nor the order of
/// nodes and elements in the mesh file changes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Partition {
    /// The blocks. The forces at a node are summed in this order.
    pub blocks: Vec<PartitionBlock>,
    /// Orphan nodes (mesh indices): all their elements are absent. They are the last nodes of the last block.
    pub orphans: Vec<u32>,
    /// Nodes (mesh indices) without any element.
    pub unused: Vec<u32>,
}

/// Element sets to be divided into blocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ElementSets<'a> {
    /// Names of the sets, for errors.
    pub(crate) labels: &'a [&'a str],
    /// Mesh indices of the elements of each set.
    pub(crate) elements: &'a [&'a [u32]],
    /// Estimated cost of a step of an element of each set.
    pub(crate) costs: &'a [f64],
    /// Whether each element of the mesh is absent.
    pub(crate) absent: &'a [bool],
}

impl Partition {
    /// Divides element sets into blocks of at most `size` elements.
    ///
    /// A set is bisected across its longest extent until its blocks are small: compact blocks share few
    /// nodes with others, and each shared node costs a slot. Within a block, elements and nodes are in
    /// reverse Cuthill-McKee order, so that the elements of a SIMD batch are neighbours. A node
    /// is owned by the first block that has it.
    pub(crate) fn new(mesh: &Mesh, sets: ElementSets, size: usize) -> Result<Self, EngineError> {
        check_cover(mesh, sets.labels, sets.elements, sets.absent)?;
        let order = reverse_cuthill_mckee(mesh, &Incidence::of(mesh));
        let mut rank = vec![0u32; order.len()];
        for (i, &node) in order.iter().enumerate() {
            rank[node as usize] = i as u32;
        }
        let key = |element: u32| {
            let ranks = mesh.nodes_of(element).iter().map(|&n| rank[n as usize]);
            ranks.fold((u32::MAX, 0), |(low, high), r| (low.min(r), high.max(r)))
        };
        let mut blocks: Vec<((u32, u32), PartitionBlock)> = Vec::new();
        for (set, elements) in sets.elements.iter().enumerate() {
            let mut sorted: Vec<SortedElement> = (elements.iter())
                .map(|&element| SortedElement {
                    centroid: mesh.centroid(element),
                    key: key(element),
                    tag: mesh.element_tags()[element as usize],
                    element,
                })
                .collect();
            bisect(&mut sorted, elements.len().div_ceil(size), &mut |block| {
                block.sort_unstable_by_key(|entry| (entry.key, entry.tag));
                blocks.push((
                    block[0].key,
                    PartitionBlock {
                        set,
                        level: 0,
                        elements: block.iter().map(|entry| entry.element).collect(),
                        nodes: Vec::new(),
                        owned: 0,
                        element_cost: sets.costs[set],
                    },
                ));
            });
        }
        blocks.sort_by_key(|(first, block)| (block.level, *first, block.set));
        let blocks = blocks.into_iter().map(|(_, block)| block).collect();
        let mut partition = Self {
            blocks,
            orphans: Vec::new(),
            unused: Vec::new(),
        };
        partition.assign_nodes(mesh, &rank, sets.absent);
        Ok(partition)
    }

    /// Assigns the nodes of the mesh to the blocks.
    fn assign_nodes(&mut self, mesh: &Mesh, rank: &[u32], absent: &[bool]) {
        const FREE: u32 = u32::MAX;
        // Position of each node in the order of owners.
        let mut position = vec![FREE; mesh.node_count()];
        let mut next = 0;
        for block in &mut self.blocks {
            let elements = block.elements.iter();
            let mut touched: Vec<u32> = elements
                .flat_map(|&element| mesh.nodes_of(element).iter().copied())
                .collect();
            touched.sort_unstable_by_key(|&node| rank[node as usize]);
            touched.dedup();
            let (owned, mut borrowed): (Vec<u32>, Vec<u32>) =
                (touched.into_iter()).partition(|&node| position[node as usize] == FREE);
            for &node in &owned {
                position[node as usize] = next;
                next += 1;
            }
            borrowed.sort_unstable_by_key(|&node| position[node as usize]);
            block.owned = owned.len();
            block.nodes = owned;
            block.nodes.extend(borrowed);
        }
        let mut had = vec![false; mesh.node_count()];
        for (element, _) in absent.iter().enumerate().filter(|(_, absent)| **absent) {
            for &node in mesh.nodes_of(element as u32) {
                had[node as usize] = true;
            }
        }
        // In an order that does not depend on the order of nodes in the file.
        let mut without: Vec<u32> = (0..mesh.node_count() as u32)
            .filter(|&node| position[node as usize] == FREE)
            .collect();
        without.sort_by_key(|&node| mesh.node_tags()[node as usize]);
        (self.orphans, self.unused) = without.into_iter().partition(|&node| had[node as usize]);
        if let Some(last) = self.blocks.last_mut() {
            last.nodes.extend_from_slice(&self.orphans);
        }
    }

    /// A 64-bit fingerprint of the partition: a hash of the user's numbers of elements and nodes of all blocks, in
    /// order. Equal for equal partitions of meshes that differ in the order of nodes and elements alone.
    pub fn fingerprint(&self, mesh: &Mesh) -> u64 {
        let mut hash = Checksum::default();
        for block in &self.blocks {
            hash.add_number(block.set as u64);
            hash.add_number(u64::from(block.level));
            hash.add_number(block.elements.len() as u64);
            for &element in &block.elements {
                hash.add_number(mesh.element_tags()[element as usize]);
            }
            hash.add_number(block.owned as u64);
            hash.add_number(block.nodes.len() as u64);
            for &node in &block.nodes {
                // Copies of nodes in a bay have their index.
                let tag = mesh.node_tags().get(node as usize).copied();
                hash.add_number(tag.unwrap_or(u64::from(node)));
            }
        }
        hash.value()
    }
}

/// An element with its sort keys.
#[derive(Clone, Copy)]
struct SortedElement {
    centroid: Vec3,
    /// Least and greatest rank of its nodes.
    key: (u32, u32),
    /// The user's number.
    tag: u64,
    element: u32,
}

/// Divides elements into nearly equal parts by recursive bisection across the longest extent.
fn bisect(
    elements: &mut [SortedElement],
    parts: usize,
    emit: &mut impl FnMut(&mut [SortedElement]),
) {
    if elements.is_empty() {
        return;
    }
    if parts <= 1 {
        emit(elements);
        return;
    }
    let first = elements[0].centroid;
    let (low, high) = elements.iter().fold((first, first), |(low, high), entry| {
        (low.inf(&entry.centroid), high.sup(&entry.centroid))
    });
    let axis = (high - low).imax();
    let half = parts / 2;
    let middle = elements.len() * half / parts;
    elements.select_nth_unstable_by(middle, |a, b| {
        let along = a.centroid[axis].total_cmp(&b.centroid[axis]);
        along.then(a.key.cmp(&b.key)).then(a.tag.cmp(&b.tag))
    });
    let (left, right) = elements.split_at_mut(middle);
    bisect(left, half, emit);
    bisect(right, parts - half, emit);
}

fn check_cover(
    mesh: &Mesh,
    labels: &[&str],
    sets: &[&[u32]],
    absent: &[bool],
) -> Result<(), EngineError> {
    const FREE: u32 = u32::MAX;
    if sets.iter().all(|set| set.is_empty()) {
        return Err(EngineError::NoElements);
    }
    let mut owner = vec![FREE; mesh.element_count()];
    for (set, elements) in sets.iter().enumerate() {
        for &element in *elements {
            let set_of = owner.get_mut(element as usize).ok_or_else(|| {
                powerhouse_model::MeshError::SetOutOfRange {
                    what: "element",
                    name: labels[set].into(),
                    number: u64::from(element),
                }
            })?;
            if *set_of != FREE {
                return Err(EngineError::ElementTwice {
                    element: mesh.element_tags()[element as usize],
                    first: labels[*set_of as usize].into(),
                    second: labels[set].into(),
                });
            }
            *set_of = set as u32;
        }
    }
    // Bars without a set are lines of the mesh, not a gap in the body.
    let left_out = |element: &u32| {
        let index = *element as usize;
        owner[index] == FREE && !absent[index] && mesh.kind(*element).is_solid()
    };
    let mut unassigned = (0..mesh.element_count() as u32).filter(left_out);
    match unassigned.next() {
        Some(first) => Err(EngineError::ElementUnassigned {
            element: mesh.element_tags()[first as usize],
            count: 1 + unassigned.count(),
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use powerhouse_model::ElementKind;

    /// A distorted box of bricks in two sets, with nodes and elements written in an order of their own.
    fn body(shuffle: impl Fn(usize, usize) -> usize) -> Mesh {
        let mut builder = Mesh::builder();
        let (nx, ny, nz) = (5_u64, 4_u64, 3_u64);
        let tag = |i: u64, j: u64, k: u64| 1 + i + (nx + 1) * (j + (ny + 1) * k);
        let nodes = ((nx + 1) * (ny + 1) * (nz + 1)) as usize;
        for n in 0..nodes {
            let n = shuffle(n, nodes) as u64;
            let (i, j, k) = (
                n % (nx + 1),
                n / (nx + 1) % (ny + 1),
                n / ((nx + 1) * (ny + 1)),
            );
            let bend = 0.05 * ((i * j + k) % 3) as f64;
            builder.node(n + 1, Vec3::new(i as f64 + bend, j as f64, k as f64));
        }
        let elements = (nx * ny * nz) as usize;
        for e in 0..elements {
            let e = shuffle(e, elements) as u64;
            let (i, j, k) = (e % nx, e / nx % ny, e / (nx * ny));
            let ring =
                |k| [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| tag(i, j, k));
            let corners = [ring(k), ring(k + 1)].concat();
            let set = if k == 0 { "base" } else { "rock" };
            builder.element(e + 1, ElementKind::Hex8, &corners, &[set]);
        }
        builder.build().unwrap()
    }

    fn divided(mesh: &Mesh, size: usize) -> Partition {
        let lists = ["base", "rock"].map(|set| mesh.element_set(set).unwrap());
        let sets = ElementSets {
            labels: &["base", "rock"],
            elements: &lists,
            costs: &[1.0, 2.0],
            absent: &vec![false; mesh.element_count()],
        };
        Partition::new(mesh, sets, size).unwrap()
    }

    /// Every element belongs to one block, every node to one owner before all blocks that borrow it, and blocks
    /// keep to their size.
    #[test]
    fn elements_and_nodes_belong_to_one_block() {
        for size in [1, 7, 1000] {
            let mesh = body(|n, _| n);
            let partition = divided(&mesh, size);
            let mut elements = vec![0; mesh.element_count()];
            let mut owner = vec![None; mesh.node_count()];
            for (index, block) in partition.blocks.iter().enumerate() {
                assert!(block.elements.len() <= size && block.cost() > 0.0);
                for &element in &block.elements {
                    elements[element as usize] += 1;
                    for node in mesh.nodes_of(element) {
                        assert!(block.nodes.contains(node));
                    }
                }
                for &node in block.owned_nodes() {
                    assert_eq!(owner[node as usize].replace(index), None);
                }
                for &node in block.borrowed_nodes() {
                    assert!(owner[node as usize].is_some_and(|owner| owner < index));
                }
            }
            assert!(elements.iter().all(|&count| count == 1));
            assert!(owner.iter().all(Option::is_some));
        }
    }

    /// The partition depends on the body, not on the order in which a file lists its nodes and elements.
    #[test]
    fn the_order_of_a_file_changes_no_block() {
        let mesh = body(|n, _| n);
        let others = [
            body(|n, count| count - 1 - n),
            body(|n, count| (n * 7 + 3) % count),
        ];
        for size in [4, 13, 1000] {
            let fingerprint = divided(&mesh, size).fingerprint(&mesh);
            for other in &others {
                assert_eq!(divided(other, size).fingerprint(other), fingerprint);
            }
            let smaller = divided(&mesh, size / 3).fingerprint(&mesh);
            assert!(size == 1000 || smaller != fingerprint);
        }
    }
}
