//! Virtual work of internal forces.

use std::collections::HashMap;

use powerhouse_model::{Mesh, StepView, Vec3};

/// Number of stress resultants of a section.
pub(super) const RESULTANTS: usize = 6;

/// Largest number of nodes of a solid element (tetrahedron with midpoints).
pub(super) const MOST_NODES: usize = 10;

/// Six linear functionals of the internal forces `f` of some elements: virtual works `sum_e sum_a w_a . f_ea`.
#[derive(Clone, Debug)]
pub(super) struct Functional {
    /// Mesh index and number of nodes of each element.
    elements: Vec<(u32, usize)>,
    /// The virtual motions `w` of their nodes, element by element.
    motions: Vec<[Vec3; RESULTANTS]>,
}

impl Functional {
    /// The functionals of virtual motions of nodes, given by `virtual_motion(node)` (mesh index). `original(element)` is the element of the
    /// body of which an element of the mesh is a copy, itself for most: copies of an element have its forces, and the sum of their motions.
    pub(super) fn new(
        mesh: &Mesh,
        elements: &[u32],
        original: impl Fn(u32) -> u32,
        virtual_motion: impl Fn(u32) -> [Vec3; RESULTANTS],
    ) -> Self {
        let mut functional = Self {
            elements: Vec::new(),
            motions: Vec::new(),
        };
        let mut first_of: HashMap<u32, usize> = HashMap::new();
        for &element in elements {
            let nodes = mesh.nodes_of(element);
            let first = *first_of.entry(original(element)).or_insert_with(|| {
                let first = functional.motions.len();
                functional.elements.push((original(element), nodes.len()));
                let still = [Vec3::zeros(); RESULTANTS];
                functional.motions.resize(first + nodes.len(), still);
                first
            });
            for (sums, &node) in functional.motions[first..].iter_mut().zip(nodes) {
                for (sum, motion) in sums.iter_mut().zip(virtual_motion(node)) {
                    *sum += motion;
                }
            }
        }
        functional
    }

    /// Mesh indices of the elements.
    pub(super) fn elements(&self) -> impl Iterator<Item = u32> + '_ {
        self.elements.iter().map(|&(element, _)| element)
    }

    /// The virtual works at a step; none if the engine does not provide element forces.
    pub(super) fn works(&self, view: &dyn StepView) -> Option<[f64; RESULTANTS]> {
        let mut works = [0.0; RESULTANTS];
        let mut forces = [Vec3::zeros(); MOST_NODES];
        let mut motions = self.motions.iter();
        for &(element, nodes) in &self.elements {
            let forces = &mut forces[..nodes];
            if !view.element_forces(element, forces) {
                return None;
            }
            for (force, motions) in forces.iter().zip(&mut motions) {
                for (work, motion) in works.iter_mut().zip(motions) {
                    *work += force.dot(motion);
                }
            }
        }
        Some(works)
    }
}
