//! Splitting of a mesh along an internal surface, as for joints.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::sides::SideTable;
use super::{Facet, Mesh, MeshError};

/// Result of splitting a mesh along the common facets of two element lists.
#[derive(Clone, Debug, PartialEq)]
pub struct Split {
    /// The split mesh, with duplicated nodes on the surface.
    pub mesh: Mesh,
    /// The common facets as sides of elements of the first list, in rising order.
    pub first: Vec<Facet>,
    /// The common facets as sides of elements of the second list, in the order of `first`.
    pub second: Vec<Facet>,
    /// Mesh indices of each duplicated node and its copy.
    pub copies: Vec<[u32; 2]>,
}

impl Mesh {
    /// Splits the mesh along the common facets of two lists of elements (mesh indices).
    ///
    /// A node of these facets is duplicated if the split separates the elements around it; elements with a common
    /// facet that is not split stay connected. The split is open where it reaches the surface of the
    /// mesh or another split, and closed along its edges inside the body; splits that meet along a line
    /// may be made one after the other. The elements of the first list keep their nodes.
    ///
    /// Copies follow all nodes, in the order of the duplicated nodes; they are numbered from the
    /// greatest node number on and belong to the node sets of the originals. Element and facet sets
    /// are unchanged, because elements keep their indices. Bars keep their nodes.
    ///
    /// # Errors
    /// [`MeshError::SharedElement`] for an element in both lists, [`MeshError::NoCommonFacets`],
    /// [`MeshError::TooLarge`].
    ///
    /// # Panics
    /// If an element does not belong to the mesh.
    ///
    /// ```
    /// use powerhouse_model::{Mesh, Vec3};
    /// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(2.0, 1.0, 1.0), [2, 1, 1], "rock")?;
    /// let split = mesh.split_between(&[0], &[1])?;
    /// assert_eq!(split.mesh.node_count(), 12 + 4);
    /// assert_eq!(split.mesh.check()?.parts, 2);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn split_between(&self, first: &[u32], second: &[u32]) -> Result<Split, MeshError> {
        let mut side = vec![Side::Neither; self.element_count()];
        for &element in first {
            side[element as usize] = Side::First;
        }
        for &element in second {
            if side[element as usize] == Side::First {
                let element = self.element_tags[element as usize];
                return Err(MeshError::SharedElement { element });
            }
            side[element as usize] = Side::Second;
        }
        let neighbours = SideTable::of_all(self).neighbours(self);
        let crosses = |[a, b]: &[Facet; 2]| {
            let of = |facet: &Facet| side[facet.element as usize];
            match (of(a), of(b)) {
                (Side::First, Side::Second) => Some([*a, *b]),
                (Side::Second, Side::First) => Some([*b, *a]),
                _ => None,
            }
        };
        let mut cut: Vec<[Facet; 2]> = neighbours.iter().filter_map(crosses).collect();
        cut.sort_unstable();
        if cut.is_empty() {
            return Err(MeshError::NoCommonFacets);
        }
        let mut around: BTreeMap<u32, Surroundings> = BTreeMap::new();
        for facet in cut.iter().flatten() {
            for node in self.facet_nodes(*facet) {
                around.entry(node).or_default();
            }
        }
        for element in 0..self.element_count() as u32 {
            for node in self.nodes_of(element) {
                if let Some(surroundings) = around.get_mut(node) {
                    surroundings.elements.push(element);
                }
            }
        }
        for pair in &neighbours {
            let is_cut = crosses(pair).is_some();
            for node in self.facet_nodes(pair[0]) {
                if let Some(surroundings) = around.get_mut(&node) {
                    surroundings
                        .contacts
                        .push((pair.map(|facet| facet.element), is_cut));
                }
            }
        }
        let mut mesh = self.clone();
        let mut copies = Vec::new();
        let mut tag = self.node_tags.iter().copied().max().unwrap_or(0);
        for (&node, surroundings) in &around {
            for part in surroundings.parted(&side) {
                if mesh.positions.len() + 1 >= u32::MAX as usize {
                    let (what, count) = ("nodes", mesh.positions.len() + 1);
                    return Err(MeshError::TooLarge { what, count });
                }
                let copy = mesh.positions.len() as u32;
                tag += 1;
                mesh.positions.push(self.positions[node as usize]);
                mesh.node_tags.push(tag);
                copies.push([node, copy]);
                for element in part {
                    let element = element as usize;
                    let range = self.offsets[element] as usize..self.offsets[element + 1] as usize;
                    for corner in &mut mesh.connectivity[range] {
                        if *corner == node {
                            *corner = copy;
                        }
                    }
                }
            }
        }
        for nodes in Arc::make_mut(&mut mesh.node_sets).values_mut() {
            let own = copies
                .iter()
                .filter(|[node, _]| nodes.binary_search(node).is_ok());
            let added: Vec<u32> = own.map(|[_, copy]| *copy).collect();
            // Copies have higher indices than all nodes before.
            nodes.extend(added);
        }
        Ok(Split {
            mesh,
            first: cut.iter().map(|pair| pair[0]).collect(),
            second: cut.iter().map(|pair| pair[1]).collect(),
            copies,
        })
    }
}

/// The list that contains an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    First,
    Second,
    Neither,
}

/// The elements around a node of the split.
#[derive(Clone, Debug, Default)]
struct Surroundings {
    /// Mesh indices of the elements, in rising order.
    elements: Vec<u32>,
    /// Pairs of elements with a common facet at the node, and whether the facet is split.
    contacts: Vec<([u32; 2], bool)>,
}

impl Surroundings {
    /// Connected components: for each element the least index of an element connected with it, through split facets too
    /// if `with_cut`.
    fn components(&self, with_cut: bool) -> Vec<usize> {
        let index = |element: u32| self.elements.partition_point(|&other| other < element);
        let mut component: Vec<usize> = (0..self.elements.len()).collect();
        // For a few elements repeated passes are as fast as union-find.
        let mut changed = true;
        while changed {
            changed = false;
            for &([a, b], is_cut) in &self.contacts {
                let (a, b) = (index(a), index(b));
                let least = component[a].min(component[b]);
                if (with_cut || !is_cut) && component[a] != component[b] {
                    (component[a], component[b]) = (least, least);
                    changed = true;
                }
            }
        }
        component
    }

    /// The groups of elements that need a copy of the node.
    fn parted(&self, side: &[Side]) -> Vec<Vec<u32>> {
        let (whole, open) = (self.components(true), self.components(false));
        let mut parts: BTreeMap<(usize, usize), Vec<u32>> = BTreeMap::new();
        for (index, &element) in self.elements.iter().enumerate() {
            parts
                .entry((whole[index], open[index]))
                .or_default()
                .push(element);
        }
        let is_first = |part: &[u32]| part.iter().any(|&e| side[e as usize] == Side::First);
        let mut keepers: BTreeMap<usize, usize> = BTreeMap::new();
        for (&(whole, open), part) in &parts {
            // The first list keeps the node; among parts without it, the one with the first element.
            let keeper = keepers.entry(whole).or_insert(open);
            if is_first(part) && !is_first(&parts[&(whole, *keeper)]) {
                *keeper = open;
            }
        }
        let copied = parts
            .into_iter()
            .filter(|((whole, open), _)| keepers[whole] != *open);
        copied.map(|(_, part)| part).collect()
    }
}
