//! Facets of a joint of which both sides are present.

use std::collections::HashMap;

use powerhouse_model::Mesh;

use crate::{JointFacet, JointSurface};

impl JointSurface {
    /// Facets of which both sides are present, where elements of the mesh have been excavated or are not cast yet:
    /// the element of the first side, and another present element with all nodes that face those of the facet. A facet
    /// whose sides share all nodes needs the first alone.
    ///
    /// `present` has one entry per element of the mesh.
    ///
    /// # Panics
    /// If the surface belongs to another mesh, or `present` has fewer entries than the mesh elements.
    pub fn present_facets(&self, mesh: &Mesh, present: &[bool]) -> Vec<&JointFacet> {
        let nodes = self.pairs.iter().map(|pair| (pair.nodes[1], Vec::new()));
        let mut beside: HashMap<u32, Vec<u32>> = nodes.collect();
        let elements = 0..mesh.element_count() as u32;
        for element in elements.filter(|&element| present[element as usize]) {
            for node in mesh.nodes_of(element) {
                if let Some(elements) = beside.get_mut(node) {
                    elements.push(element);
                }
            }
        }
        let has_second_side = |facet: &JointFacet| {
            let pairs = facet.pairs.iter().flatten();
            let facing: Vec<u32> = pairs
                .map(|&pair| self.pairs[pair as usize].nodes[1])
                .collect();
            let Some((node, others)) = facing.split_first() else {
                return true;
            };
            beside[node].iter().any(|&element| {
                let nodes = mesh.nodes_of(element);
                element != facet.first.element && others.iter().all(|other| nodes.contains(other))
            })
        };
        let facets = self.facets.iter();
        facets
            .filter(|facet| present[facet.first.element as usize] && has_second_side(facet))
            .collect()
    }
}
