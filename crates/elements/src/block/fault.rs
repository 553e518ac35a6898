//! Elements whose forces are not finite.

use powerhouse_model::{BlockContext, ElementFault, ElementKernel, NodalView, Quad};

use super::transfer::NodeScalar;
use super::{Block, in_double};

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    /// The first element of which a nodal value or the stress is not finite.
    pub(super) fn fault(&self, context: &BlockContext) -> Option<ElementFault> {
        let displacement = self.since_reference(context.displacement);
        let velocity = in_double(context.velocity);
        let survey = self.survey(&displacement);
        // Velocities that the block does not read may be missing.
        let finite = |values: &[Quad<f64>], local: u32| {
            values.get(local as usize).is_none_or(|value| {
                let vector = value.to_vector();
                vector.iter().all(|component| component.is_finite())
            })
        };
        let reason = |element: usize| {
            let nodes = &self.connectivity.as_slice()[element];
            if !nodes.iter().all(|&local| finite(&displacement, local)) {
                Some("a node's displacement is not finite")
            } else if !nodes.iter().all(|&local| finite(&velocity, local)) {
                Some("a node's velocity is not finite")
            } else if !survey[element].stress.0.iter().all(|s| s.is_finite()) {
                Some("its stress is not finite")
            } else {
                None
            }
        };
        (0..self.elements.len())
            .filter(|&element| self.is_active(element))
            .find_map(|element| {
                reason(element).map(|reason| ElementFault::new(self.elements[element], reason))
            })
    }

    /// The first element with a nodal force that is not finite: the fault of a stress whose history was
    /// overwritten since.
    pub(super) fn fault_of(&self, forces: NodalView) -> Option<ElementFault> {
        let finite = |local: &u32| {
            let force = forces.vector(*local as usize);
            force.iter().all(|component| component.is_finite())
        };
        let element = (0..self.elements.len()).find(|&element| {
            self.is_active(element) && !self.connectivity.as_slice()[element].iter().all(finite)
        });
        element.map(|element| {
            ElementFault::new(self.elements[element], "a force of its nodes is not finite")
        })
    }
}
