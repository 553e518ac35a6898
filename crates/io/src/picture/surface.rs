//! Visible part of a mesh and its numbers.

use powerhouse_model::{Facet, Mesh, Vec3};

use super::colour::{Rgb, set_colour};
use super::{FacetField, Picture, PictureField};

/// Relative length below which a distance counts as zero beside coordinates.
const ROUNDING: f64 = 1e-12;

/// Facet that is drawn.
pub(super) struct Patch {
    /// Element of which it is a side.
    pub(super) element: u32,
    /// Corners in order around it.
    pub(super) nodes: Vec<u32>,
}

/// Surface that is drawn.
pub(super) struct Surface {
    pub(super) patches: Vec<Patch>,
    /// Elements without sides, which are bars.
    pub(super) bars: Vec<u32>,
    /// Positions of all nodes (m), with the displacements if there are any.
    pub(super) positions: Vec<Vec3>,
}

impl Surface {
    pub(super) fn new(picture: &Picture) -> Self {
        let mesh = picture.mesh;
        // Centroids in the plane, but for rounding, are visible: a slice may be cut in its middle.
        let (low, high) = mesh.bounding_box();
        let rounding = ROUNDING * low.norm().max(high.norm());
        let before = |position: Vec3| {
            (picture.section.as_ref()).is_none_or(|section| {
                let beyond = (position - section.point).dot(&section.normal);
                beyond <= rounding * section.normal.norm()
            }) && picture.close_up.is_none_or(|[low, high]| {
                (0..3).all(|axis| (low[axis]..=high[axis]).contains(&position[axis]))
            })
        };
        if let PictureField::Facets(field) = picture.field {
            let centre = |nodes: &[u32]| -> Vec3 {
                let corners = nodes.iter().map(|&node| field.positions[node as usize]);
                corners.sum::<Vec3>() / nodes.len() as f64
            };
            let in_sight = field.facets.iter().filter(|nodes| before(centre(nodes)));
            let patch = |nodes: &Vec<u32>| Patch {
                element: 0,
                nodes: nodes.clone(),
            };
            return Self {
                patches: in_sight.map(patch).collect(),
                bars: Vec::new(),
                positions: field.positions.clone(),
            };
        }
        let is_there =
            |element: u32| (picture.present).is_none_or(|present| present[element as usize]);
        let in_sight = |element: u32| is_there(element) && before(mesh.centroid(element));
        let elements = 0..mesh.element_count() as u32;
        let bars = elements.filter(|&e| mesh.kind(e).sides().is_empty() && in_sight(e));
        let mut positions = mesh.positions().to_vec();
        if let Some(deformation) = &picture.deformation {
            for (position, displacement) in positions.iter_mut().zip(deformation.displacement) {
                *position += displacement * deformation.factor;
            }
        }
        let facets = mesh.boundary_facets_of(in_sight);
        let patch = |&facet: &Facet| Patch {
            element: facet.element,
            nodes: mesh.facet_nodes(facet).to_vec(),
        };
        Self {
            patches: facets.iter().map(patch).collect(),
            bars: bars.collect(),
            positions,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.patches.is_empty() && self.bars.is_empty()
    }

    /// Visible nodes, some of them several times.
    pub(super) fn nodes<'a>(&'a self, mesh: &'a Mesh) -> impl Iterator<Item = u32> + 'a {
        let of_patches = self.patches.iter().flat_map(|patch| &patch.nodes);
        let of_bars = self.bars.iter().flat_map(|&bar| mesh.nodes_of(bar));
        of_patches.chain(of_bars).copied()
    }

    /// Least and greatest visible number of the field; `None` for a picture of sets.
    pub(super) fn range(&self, picture: &Picture) -> Option<[f64; 2]> {
        let spread = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [low.min(value), high.max(value)]
            })
        };
        match picture.field {
            PictureField::Sets => None,
            PictureField::Nodal(values) => Some(spread(
                &mut self.nodes(picture.mesh).map(|node| values[node as usize]),
            )),
            PictureField::Facets(FacetField { values, .. }) => Some(spread(
                &mut self.nodes(picture.mesh).map(|node| values[node as usize]),
            )),
            PictureField::Elemental(values) => {
                let patches = self.patches.iter().map(|patch| patch.element);
                let elements = patches.chain(self.bars.iter().copied());
                Some(spread(&mut elements.map(|e| values[e as usize])))
            }
        }
    }
}

/// Colour of each element's set; of several, the first by name.
pub(super) fn colours_of_sets(mesh: &Mesh) -> Vec<Rgb> {
    let mut colours = vec![set_colour(None); mesh.element_count()];
    for (number, elements) in mesh.element_sets().values().enumerate().rev() {
        for &element in elements {
            colours[element as usize] = set_colour(Some(number));
        }
    }
    colours
}
