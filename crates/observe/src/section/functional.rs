//! Virtual work of internal forces.

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
    /// The functionals of virtual motions of nodes, given by `virtual_motion(node)` (mesh index).
    pub(super) fn new(
        mesh: &Mesh,
        elements: &[u32],
        virtual_motion: impl Fn(u32) -> [Vec3; RESULTANTS],
    ) -> Self {
        let nodes = elements.iter().flat_map(|&element| mesh.nodes_of(element));
        Self {
            elements: (elements.iter())
                .map(|&element| (element, mesh.nodes_of(element).len()))
                .collect(),
            motions: nodes.map(|&node| virtual_motion(node)).collect(),
        }
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
