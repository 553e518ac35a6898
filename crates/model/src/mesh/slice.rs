//! One layer of elements of a mesh extruded along an axis.

use std::collections::{BTreeSet, HashMap};

use super::{Axis, Facet, Mesh, MeshError};

/// Share of the extent along the axis below which coordinates count as equal.
const TOLERANCE: f64 = 1e-6;

impl Mesh {
    /// The plane slice at a coordinate `at` (m): the layer of elements that a plane normal to an axis cuts in a mesh
    /// extruded along it, with their numbers.
    ///
    /// Sets keep their members in the layer and may become empty. Facet sets on the ends of the mesh are moved to the
    /// sides of the layer, so that supports of the ends act on the slice: with rollers on both sides
    /// it is in plane strain.
    ///
    /// # Errors
    /// [`MeshError::NoSlice`]; [`MeshError::NotExtruded`] if an element of the layer extends beyond
    /// it, or if the layer's share of the volume differs from its share of the extent.
    ///
    /// ```
    /// use powerhouse_model::{Axis, Mesh, Vec3};
    /// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 10.0, 2.0), [4, 5, 2], "rock")?;
    /// let slice = mesh.plane_slice(Axis::Y, 5.0)?;
    /// assert_eq!((slice.element_count(), slice.node_count()), (8, 30));
    /// assert_eq!(slice.facet_set("front")?.len(), 8);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn plane_slice(&self, axis: Axis, at: f64) -> Result<Self, MeshError> {
        let (low, high) = self.bounding_box();
        let (low, high) = (low[axis.index()], high[axis.index()]);
        let tolerance = TOLERANCE * (high - low);
        let along = |node: u32| self.positions[node as usize][axis.index()];
        let reach = |element: u32| {
            let coordinates = self.nodes_of(element).iter().map(|&node| along(node));
            coordinates.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(x), b.max(x))
            })
        };
        let is_cut = |&element: &u32| {
            let (from, to) = reach(element);
            self.kind(element).is_solid() && from <= at && at < to
        };
        let kept: Vec<u32> = (0..self.element_count() as u32).filter(is_cut).collect();
        let Some(&first) = kept.first() else {
            return Err(MeshError::NoSlice {
                axis: axis.name(),
                value: at,
                low,
                high,
            });
        };
        let (from, to) = reach(first);
        let is_outside = |&node: &u32| {
            (along(node) - from).abs() > tolerance && (along(node) - to).abs() > tolerance
        };
        let reaches_beyond = |&&element: &&u32| self.nodes_of(element).iter().any(is_outside);
        let layer = self.volume_of(&kept) / (to - from);
        let solids = (0..self.element_count() as u32).filter(|&e| self.kind(e).is_solid());
        let share = layer * (high - low) / self.volume_of(&solids.collect::<Vec<u32>>());
        let beyond = kept.iter().find(reaches_beyond);
        if beyond.is_some() || (share - 1.0).abs() > TOLERANCE {
            return Err(MeshError::NotExtruded {
                axis: axis.name(),
                element: self.element_tags[*beyond.unwrap_or(&first) as usize],
                share,
            });
        }
        self.layer(&kept, axis, [(low, from), (high, to)], tolerance)
    }

    /// The submesh of some elements; facets of facet sets in the end planes of the mesh are replaced by facets of the layer
    /// in the paired planes (m).
    fn layer(
        &self,
        kept: &[u32],
        axis: Axis,
        planes: [(f64, f64); 2],
        tolerance: f64,
    ) -> Result<Self, MeshError> {
        let mut slice = self.of_elements(kept)?;
        let sides = planes.map(|(end, side)| {
            let facets = slice.facets_on_plane(axis, side, tolerance);
            (end, Opposite::new(&slice, axis, &facets, tolerance))
        });
        for (name, facets) in &*self.facet_sets {
            let mut of_slice: BTreeSet<Facet> = slice.facet_set(name)?.iter().copied().collect();
            for (end, side) in &sides {
                let nodes_of = |facet: Facet| self.facet_nodes(facet).into_iter();
                let along = |node: u32| self.positions[node as usize][axis.index()];
                let on_end =
                    |facet: Facet| nodes_of(facet).all(|n| (along(n) - end).abs() <= tolerance);
                let at_end = facets.iter().filter(|&&facet| on_end(facet));
                of_slice.extend(at_end.filter_map(|&facet| side.facing(self, facet)));
            }
            slice.set_facet_set(name, of_slice.into_iter().collect())?;
        }
        Ok(slice)
    }
}

/// Facets of a plane normal to an axis, indexed by their centroids in the plane.
struct Opposite {
    across: [usize; 2],
    cell: f64,
    facets: HashMap<[i64; 2], Facet>,
}

impl Opposite {
    fn new(mesh: &Mesh, axis: Axis, facets: &[Facet], tolerance: f64) -> Self {
        let axis = axis.index();
        let mut opposite = Self {
            across: [(axis + 1) % 3, (axis + 2) % 3],
            // Rounding moves a centroid by less than a cell.
            cell: 2.0 * tolerance,
            facets: HashMap::with_capacity(facets.len()),
        };
        for &facet in facets {
            let cell = opposite.cell_of(mesh, facet);
            opposite.facets.insert(cell, facet);
        }
        opposite
    }

    fn cell_of(&self, mesh: &Mesh, facet: Facet) -> [i64; 2] {
        let centroid = mesh.facet_geometry(facet).centroid;
        self.across
            .map(|axis| (centroid[axis] / self.cell).round() as i64)
    }

    /// The facet opposite to another one along the axis.
    fn facing(&self, mesh: &Mesh, facet: Facet) -> Option<Facet> {
        let [a, b] = self.cell_of(mesh, facet);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [a + i, b + j]));
        around
            .into_iter()
            .find_map(|cell| self.facets.get(&cell).copied())
    }
}
