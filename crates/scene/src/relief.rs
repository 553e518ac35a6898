//! Surfaces that are not flat inside the body: hills and canyons.

use std::collections::{BTreeSet, HashMap};

use powerhouse_model::{Facet, MeshError};
use powerhouse_wavefield::Site;

use crate::surroundings::SIDE_TOLERANCE;
use crate::{Remark, Scene, remark};

/// Greatest vertical component of the normal of a side.
const UPRIGHT: f64 = 0.707;

impl Scene {
    /// Height z of the free surface of the half-space in which the waves of the field travel (m), the lowest of several; none
    /// for a full space, and for a field that is given otherwise.
    pub fn surface(&self) -> Option<f64> {
        let of_waves = self.plane_waves().iter();
        let of_waves = of_waves.filter_map(|wave| match wave.parameters().site {
            Site::HalfSpace { surface } => Some(surface),
            Site::FullSpace => None,
        });
        let of_layers = self.layered_waves().iter();
        let of_layers = of_layers.map(|wave| wave.parameters().ground.surface());
        of_waves.chain(of_layers).reduce(f64::min)
    }

    /// Height z (m) of the surface of the ground around the body: that of the upper edge of its absorbing sides, or of the
    /// mesh if no side absorbs.
    ///
    /// # Errors
    /// A set that does not exist.
    pub fn level_of_sides(&self) -> Result<f64, MeshError> {
        let (low, high) = self.mesh.bounding_box();
        let mut level = f64::NEG_INFINITY;
        for (_, facets) in self.absorbing_facets()? {
            for facet in facets {
                if self.mesh.facet_geometry(*facet).normal().z.abs() < UPRIGHT {
                    let nodes = self.mesh.facet_nodes(*facet).into_iter();
                    let heights = nodes.map(|node| self.mesh.positions()[node as usize].z);
                    level = heights.fold(level, f64::max);
                }
            }
        }
        let is_top = high.z - level <= SIDE_TOLERANCE * (high - low).norm();
        Ok(if is_top || level == f64::NEG_INFINITY {
            high.z
        } else {
            level
        })
    }

    /// Whether nodes (mesh indices) lie above the free surface of the field, where the field is not defined.
    pub(super) fn above_field(&self) -> impl Fn(u32) -> bool {
        let (low, high) = self.mesh.bounding_box();
        let rounding = SIDE_TOLERANCE * (high - low).norm();
        let limit = self
            .surface()
            .map_or(f64::INFINITY, |surface| surface + rounding);
        move |node| self.mesh.positions()[node as usize].z > limit
    }

    /// Remark about a surface that is not flat: free facets that hang together with the surface at the absorbing faces, and
    /// reach above or below it.
    pub(super) fn relief(&self, faces: &[(&str, &[Facet])], free: &[Facet]) -> Option<Remark> {
        let surface = self.surface()?;
        let (low, high) = self.mesh.bounding_box();
        let tolerance = SIDE_TOLERANCE * (high - low).norm();
        let height = |node: u32| self.mesh.positions()[node as usize].z;
        let of_faces = faces
            .iter()
            .flat_map(|(_, facets)| self.mesh.nodes_of_facets(facets));
        let rim = of_faces.filter(|&node| (height(node) - surface).abs() <= tolerance);
        let mut ahead: Vec<u32> = rim.collect();
        let mut facets_of: HashMap<u32, Vec<usize>> = HashMap::new();
        let nodes: Vec<Vec<u32>> = free.iter().map(|f| self.mesh.facet_nodes(*f)).collect();
        for (facet, nodes) in nodes.iter().enumerate() {
            for &node in nodes {
                facets_of.entry(node).or_default().push(facet);
            }
        }
        let mut reached: BTreeSet<u32> = ahead.iter().copied().collect();
        let (mut lowest, mut highest) = (surface, surface);
        while let Some(node) = ahead.pop() {
            for &facet in facets_of.get(&node).into_iter().flatten() {
                for &next in &nodes[facet] {
                    if reached.insert(next) {
                        (lowest, highest) = (lowest.min(height(next)), highest.max(height(next)));
                        ahead.push(next);
                    }
                }
            }
        }
        let is_flat = highest - surface <= tolerance && surface - lowest <= tolerance;
        (!is_flat).then_some(Remark::from(remark::Relief {
            surface,
            lowest,
            highest,
        }))
    }
}
