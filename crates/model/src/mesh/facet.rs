//! Normals, areas and tributary areas of facets.

use std::collections::BTreeMap;

use super::{Facet, Mesh};
use crate::Vec3;

/// Geometry of one facet.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetGeometry {
    /// Mesh indices of its nodes, counter-clockwise seen from outside.
    pub nodes: Vec<u32>,
    /// Outward vector area (m2): unit normal times area, exact for warped quadrilaterals.
    pub vector_area: Vec3,
    /// The share of the vector area of each node, `integral of N_a n dA` (m2).
    pub shares: Vec<Vec3>,
    /// Centroid of its nodes (m).
    pub centroid: Vec3,
}

impl FacetGeometry {
    /// Area (m2), of a warped facet that of its mean plane.
    pub fn area(&self) -> f64 {
        self.vector_area.norm()
    }
    /// Outward unit normal of the mean plane.
    pub fn normal(&self) -> Vec3 {
        self.vector_area.normalize()
    }
}

/// What a node has of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeTributary {
    /// Mesh index of the node.
    pub node: u32,
    /// Outward unit normal, weighted by area.
    pub normal: Vec3,
    /// Area that belongs to the node (m2).
    pub area: f64,
}

impl Mesh {
    /// Geometry of a facet.
    ///
    /// # Panics
    /// If the facet does not belong to this mesh.
    pub fn facet_geometry(&self, facet: Facet) -> FacetGeometry {
        let of_element = self.nodes_of(facet.element);
        let side = self.kind(facet.element).sides()[facet.side as usize];
        let nodes: Vec<u32> = side.iter().map(|&i| of_element[i as usize]).collect();
        let corners: Vec<Vec3> = nodes.iter().map(|&n| self.positions[n as usize]).collect();
        let shares = if corners.len() == 3 {
            let vector = 0.5 * (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
            vec![vector / 3.0; 3]
        } else {
            quadrilateral_shares(&corners)
        };
        FacetGeometry {
            vector_area: shares.iter().sum(),
            centroid: corners.iter().sum::<Vec3>() / corners.len() as f64,
            nodes,
            shares,
        }
    }

    /// What each node has of a face made of facets, in rising order of nodes.
    ///
    /// # Panics
    /// If a facet does not belong to this mesh.
    pub fn tributary_areas(&self, facets: &[Facet]) -> Vec<NodeTributary> {
        let mut sums: BTreeMap<u32, Vec3> = BTreeMap::new();
        for &facet in facets {
            let geometry = self.facet_geometry(facet);
            for (&node, &share) in geometry.nodes.iter().zip(&geometry.shares) {
                *sums.entry(node).or_default() += share;
            }
        }
        sums.into_iter()
            .map(|(node, vector)| NodeTributary {
                node,
                normal: vector.normalize(),
                area: vector.norm(),
            })
            .collect()
    }
}

/// `integral of N_a (dx/dr x dx/ds) dr ds` by 2 x 2 Gauss points, which is exact here.
fn quadrilateral_shares(corners: &[Vec3]) -> Vec<Vec3> {
    const SIGNS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let g = 1.0 / 3.0_f64.sqrt();
    let mut shares = vec![Vec3::zeros(); 4];
    for (sr, ss) in SIGNS {
        let (r, s) = (sr * g, ss * g);
        let mut along_r = Vec3::zeros();
        let mut along_s = Vec3::zeros();
        for (a, (ra, sa)) in SIGNS.iter().enumerate() {
            along_r += corners[a] * (0.25 * ra * (1.0 + sa * s));
            along_s += corners[a] * (0.25 * sa * (1.0 + ra * r));
        }
        let vector = along_r.cross(&along_s);
        for (a, (ra, sa)) in SIGNS.iter().enumerate() {
            shares[a] += vector * (0.25 * (1.0 + ra * r) * (1.0 + sa * s));
        }
    }
    shares
}
