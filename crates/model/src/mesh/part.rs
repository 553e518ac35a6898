//! Submeshes: the mesh of some elements, or of those in a box.

use std::collections::{BTreeSet, HashMap};

use super::{Axis, Facet, Mesh, MeshError, Vec3};

/// Share of the mesh's diagonal below which coordinates count as equal.
const TOLERANCE: f64 = 1e-6;

impl Mesh {
    /// The submesh of some elements (mesh indices), with the numbers of elements and nodes.
    ///
    /// Sets keep their members in the submesh and may become empty; facets of other elements are removed.
    ///
    /// # Errors
    /// [`MeshError::Empty`] if no elements are given, [`MeshError::SetOutOfRange`] if one does not exist.
    ///
    /// ```
    /// use powerhouse_model::{Mesh, Vec3};
    /// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 1.0, 1.0), [4, 1, 1], "rock")?;
    /// let part = mesh.of_elements(&[0, 1, 3])?;
    /// assert_eq!((part.element_count(), part.node_count()), (3, 20));
    /// assert_eq!(part.facet_set("top")?.len(), 3);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn of_elements(&self, kept: &[u32]) -> Result<Self, MeshError> {
        let kept: BTreeSet<u32> = kept.iter().copied().collect();
        if let Some(&last) = kept.last()
            && last as usize >= self.element_count()
        {
            return Err(MeshError::SetOutOfRange {
                what: "element",
                name: "part".into(),
                number: last.into(),
            });
        }
        let kept: Vec<u32> = kept.into_iter().collect();
        let nodes = self.nodes_of_elements(&kept);
        let number = |node: &u32| self.node_tags[*node as usize];
        let mut builder = Self::builder();
        for &node in &nodes {
            builder.node(number(&node), self.positions[node as usize]);
        }
        for &element in &kept {
            let corners: Vec<u64> = self.nodes_of(element).iter().map(number).collect();
            let tag = self.element_tags[element as usize];
            builder.element(tag, self.kind(element), &corners, &[] as &[&str]);
        }
        let mut part = builder.build()?;
        let index = |all: &[u32], one: &u32| all.binary_search(one).ok().map(|index| index as u32);
        for (name, elements) in &*self.element_sets {
            let left = elements.iter().filter_map(|e| index(&kept, e)).collect();
            part.set_element_set(name, left)?;
        }
        for (name, set) in &*self.node_sets {
            let left = set.iter().filter_map(|node| index(&nodes, node)).collect();
            part.set_node_set(name, left)?;
        }
        for (name, facets) in &*self.facet_sets {
            let left = facets.iter().filter_map(|facet| {
                let element = index(&kept, &facet.element)?;
                Some(Facet { element, ..*facet })
            });
            part.set_facet_set(name, left.collect())?;
        }
        Ok(part)
    }

    /// The submesh of the elements whose [centroids](Self::centroid) lie in a closed box (m), as
    /// [`of_elements`](Self::of_elements), with the facet sets of its new outer faces.
    ///
    /// A facet set that covers a whole plane side of the mesh covers the new side of the submesh in its place, so that
    /// boundary conditions on the set remain valid. Other facet sets and node sets keep their members in the submesh.
    /// Where layers of elements are not plane the new side has steps.
    ///
    /// # Errors
    /// [`MeshError::NothingWithin`] if the box contains no solid element.
    ///
    /// ```
    /// use powerhouse_model::{Mesh, Vec3};
    /// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(8.0), [8; 3], "rock")?;
    /// let near = mesh.within(&Vec3::new(2.0, 0.0, 3.0), &Vec3::repeat(8.0))?;
    /// assert_eq!(near.element_count(), 6 * 8 * 5);
    /// assert_eq!(near.bounding_box().0, Vec3::new(2.0, 0.0, 3.0));
    /// assert_eq!(near.facet_set("left")?.len(), 8 * 5);
    /// assert_eq!(near.facet_set("bottom")?.len(), 6 * 8);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn within(&self, low: &Vec3, high: &Vec3) -> Result<Self, MeshError> {
        let kept = self.elements_in_box(low, high);
        if !kept.iter().any(|&element| self.kind(element).is_solid()) {
            return Err(MeshError::NothingWithin {
                low: (*low).into(),
                high: (*high).into(),
            });
        }
        let mut part = self.of_elements(&kept)?;
        let sides = self.cut_sides(&kept, (low, high));
        for (name, facets) in &*self.facet_sets {
            let mut left: BTreeSet<Facet> = part.facet_set(name)?.iter().copied().collect();
            let own: BTreeSet<&Facet> = facets.iter().collect();
            for side in sides.iter().filter(|side| side.is_covered_by(&own)) {
                left.extend(&side.new);
            }
            part.set_facet_set(name, left.into_iter().collect())?;
        }
        Ok(part)
    }

    /// The plane sides of the mesh with the facets of the submesh that replace them: each
    /// facet without its former neighbour belongs to the side beyond which that neighbour lies farthest.
    fn cut_sides(&self, kept: &[u32], (low, high): (&Vec3, &Vec3)) -> Vec<CutSide> {
        let (least, greatest) = self.bounding_box();
        let tolerance = TOLERANCE * (greatest - least).norm();
        let is_kept = |element: u32| kept.binary_search(&element).is_ok();
        let sorted = |facet: Facet| {
            let mut nodes = self.facet_nodes(facet).to_vec();
            nodes.sort_unstable();
            nodes
        };
        let surface: BTreeSet<Facet> = self.boundary_facets().into_iter().collect();
        let mut exposed: HashMap<Vec<u32>, Facet> = (self.boundary_facets_of(is_kept).into_iter())
            .filter(|facet| !surface.contains(facet))
            .map(|facet| (sorted(facet), facet))
            .collect();
        let mut sides: Vec<CutSide> = [Axis::X, Axis::Y, Axis::Z]
            .into_iter()
            .flat_map(|axis| {
                let ends = [
                    (-1.0, least[axis.index()], low[axis.index()]),
                    (1.0, greatest[axis.index()], high[axis.index()]),
                ];
                ends.map(|(sign, plane, bound)| (axis, sign, plane, bound))
            })
            .map(|(axis, sign, plane, bound)| CutSide {
                axis,
                sign,
                bound,
                old: self.facets_on_plane(axis, plane, tolerance),
                new: Vec::new(),
            })
            .collect();
        for element in (0..self.element_count() as u32).filter(|&element| !is_kept(element)) {
            let centroid = self.centroid(element);
            for side in 0..self.kind(element).sides().len() as u8 {
                let Some(facet) = exposed.remove(&sorted(Facet { element, side })) else {
                    continue;
                };
                let beyond =
                    |side: &CutSide| side.sign * (centroid[side.axis.index()] - side.bound);
                let farthest = sides
                    .iter_mut()
                    .max_by(|a, b| beyond(a).total_cmp(&beyond(b)));
                if let (Some(side), Ok(index)) = (farthest, kept.binary_search(&facet.element)) {
                    let element = index as u32;
                    side.new.push(Facet { element, ..facet });
                }
            }
        }
        sides
    }
}

/// A plane side of a mesh, and its replacement in the submesh.
struct CutSide {
    axis: Axis,
    /// Sign of its outward normal along the axis.
    sign: f64,
    /// Bound of the box at this side (m).
    bound: f64,
    /// Facets of the side in the mesh.
    old: Vec<Facet>,
    /// Facets of the submesh that replace them.
    new: Vec<Facet>,
}

impl CutSide {
    /// Whether a facet set covers the whole side.
    fn is_covered_by(&self, facets: &BTreeSet<&Facet>) -> bool {
        !self.old.is_empty() && self.old.iter().all(|old| facets.contains(old))
    }
}
