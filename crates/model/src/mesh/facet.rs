//! Geometry of facets: normals, areas, tributary areas.

use std::collections::BTreeMap;

use super::{Facet, Mesh};
use crate::Vec3;

/// Geometry of one facet: nodes, areas and centroid.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetGeometry {
    /// Mesh indices of its nodes, counter-clockwise seen from outside.
    pub nodes: Vec<u32>,
    /// Outward vector area (m2): unit normal times area, exact for warped quadrilaterals.
    pub vector_area: Vec3,
    /// Vector area tributary to each node, `integral of N_a n dA` (m2), exact.
    pub shares: Vec<Vec3>,
    /// Area tributary to each node, `integral of N_a dA` (m2), exact for plane
    /// parallelograms and triangles, by 2 x 2 Gauss points for others. On a triangle with midpoints, where `N_a` is linear in
    /// each of its four parts, a twelfth of the area at a corner and a quarter at a midpoint.
    pub areas: Vec<f64>,
    /// Mean position of the nodes of the facet (m).
    pub centroid: Vec3,
}

impl FacetGeometry {
    /// Area (m2), of a warped facet that of its mean plane.
    pub fn area(&self) -> f64 {
        self.vector_area.norm()
    }
    /// Outward unit normal of the mean plane; zero if the facet has no area.
    pub fn normal(&self) -> Vec3 {
        unit_or_zero(&self.vector_area)
    }
}

/// Tributary area of a node on a face, with the mean normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeTributary {
    /// Mesh index of the node.
    pub node: u32,
    /// Outward unit normal, weighted by area; zero where the normals of the facets cancel.
    pub normal: Vec3,
    /// Tributary area `integral of N_a dA` (m2); the areas of all nodes add up to
    /// that of the face, also of a folded one.
    pub area: f64,
}

impl Mesh {
    /// Volume of an element (m3), by the divergence theorem on its sides, which is exact for bilinear ones;
    /// zero for bars.
    ///
    /// # Panics
    /// If the element does not belong to this mesh.
    pub fn volume(&self, element: u32) -> f64 {
        let sides = 0..self.kind(element).sides().len() as u8;
        let middle = self.centroid(element);
        let flux = |side: u8| -> f64 {
            let geometry = self.facet_geometry(Facet { element, side });
            let nodes = geometry.nodes.iter().zip(&geometry.shares);
            nodes
                .map(|(&node, share)| share.dot(&(self.positions[node as usize] - middle)))
                .sum()
        };
        sides.map(flux).sum::<f64>() / 3.0
    }

    /// Total volume of some elements (m3).
    ///
    /// # Panics
    /// If one does not belong to this mesh.
    pub fn volume_of(&self, elements: &[u32]) -> f64 {
        elements.iter().map(|&element| self.volume(element)).sum()
    }

    /// Geometry of a facet.
    ///
    /// # Panics
    /// If the facet does not belong to this mesh.
    pub fn facet_geometry(&self, facet: Facet) -> FacetGeometry {
        let nodes = self.facet_nodes(facet);
        let corners: Vec<Vec3> = nodes.iter().map(|&n| self.positions[n as usize]).collect();
        let (shares, areas) = match corners[..] {
            [a, b, c] => {
                let vector = 0.5 * (b - a).cross(&(c - a));
                (vec![vector / 3.0; 3], vec![vector.norm() / 3.0; 3])
            }
            [a, _, b, _, c, _] => {
                let vector = 0.5 * (b - a).cross(&(c - a));
                let parts = [12.0, 4.0, 12.0, 4.0, 12.0, 4.0];
                let area = vector.norm();
                (
                    parts.map(|part| vector / part).to_vec(),
                    parts.map(|part| area / part).to_vec(),
                )
            }
            _ => quadrilateral_shares(&corners),
        };
        FacetGeometry {
            vector_area: shares.iter().sum(),
            centroid: corners.iter().sum::<Vec3>() / corners.len() as f64,
            nodes,
            shares,
            areas,
        }
    }

    /// Mesh indices of the nodes of a facet, counter-clockwise seen from outside; corners and midpoints in turn, if it has
    /// midpoints.
    ///
    /// # Panics
    /// If the facet does not belong to this mesh.
    pub fn facet_nodes(&self, facet: Facet) -> Vec<u32> {
        let of_element = self.nodes_of(facet.element);
        let side = self.kind(facet.element).sides()[facet.side as usize];
        side.iter().map(|&i| of_element[i as usize]).collect()
    }

    /// Mesh indices of the corners of a facet, counter-clockwise seen from outside.
    ///
    /// # Panics
    /// If the facet does not belong to this mesh.
    pub fn facet_corners(&self, facet: Facet) -> Vec<u32> {
        let nodes = self.facet_nodes(facet);
        match nodes.len() {
            6 => nodes.into_iter().step_by(2).collect(),
            _ => nodes,
        }
    }

    /// Tributary areas of the nodes of a face made of facets, in rising order of nodes.
    ///
    /// # Panics
    /// If a facet does not belong to this mesh.
    pub fn tributary_areas(&self, facets: &[Facet]) -> Vec<NodeTributary> {
        let mut sums: BTreeMap<u32, (Vec3, f64)> = BTreeMap::new();
        for &facet in facets {
            let geometry = self.facet_geometry(facet);
            for (i, &node) in geometry.nodes.iter().enumerate() {
                let sum = sums.entry(node).or_default();
                sum.0 += geometry.shares[i];
                sum.1 += geometry.areas[i];
            }
        }
        sums.into_iter()
            .map(|(node, (vector, area))| NodeTributary {
                node,
                // The sum of opposite normals is rounding, not a direction.
                normal: if vector.norm() > 1e-12 * area {
                    vector.normalize()
                } else {
                    Vec3::zeros()
                },
                area,
            })
            .collect()
    }
}

fn unit_or_zero(vector: &Vec3) -> Vec3 {
    vector.try_normalize(0.0).unwrap_or_default()
}

/// `integral of N_a (dx/dr x dx/ds) dr ds` and `integral of N_a |dx/dr x dx/ds| dr ds` by 2 x 2
/// Gauss points: the first integrand is of second degree in each coordinate, so that it is exact.
fn quadrilateral_shares(corners: &[Vec3]) -> (Vec<Vec3>, Vec<f64>) {
    const SIGNS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let g = 1.0 / 3.0_f64.sqrt();
    let mut shares = vec![Vec3::zeros(); 4];
    let mut areas = vec![0.0; 4];
    for (sr, ss) in SIGNS {
        let (r, s) = (sr * g, ss * g);
        let mut along_r = Vec3::zeros();
        let mut along_s = Vec3::zeros();
        for (corner, (ra, sa)) in corners.iter().zip(SIGNS) {
            along_r += corner * (0.25 * ra * (1.0 + sa * s));
            along_s += corner * (0.25 * sa * (1.0 + ra * r));
        }
        let vector = along_r.cross(&along_s);
        for (a, (ra, sa)) in SIGNS.into_iter().enumerate() {
            let shape = 0.25 * (1.0 + ra * r) * (1.0 + sa * s);
            shares[a] += vector * shape;
            areas[a] += vector.norm() * shape;
        }
    }
    (shares, areas)
}
