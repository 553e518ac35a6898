//! Internal forces of single elements, for section forces.

use powerhouse_model::{
    ElementKernel, Geometry, Hourglass, KernelArithmetic, NodalView, Strain, Stress, Vec3,
};

use super::Block;
use super::transfer::NodeScalar;

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    /// Geometry numbers and modal displacements of an element at a displacement, in double precision.
    fn element_at(&self, element: usize, displacement: NodalView) -> (Vec<f64>, [[f64; 3]; N]) {
        let mut numbers = vec![0.0; self.kernel.geometry_len()];
        self.geometry_of(element, &mut numbers);
        let nodal = self.connectivity.as_slice()[element].map(|local| {
            let now = displacement.vector(local as usize);
            let from = self.reference.as_ref();
            let from = from.map_or(Vec3::zeros(), |from| from[local as usize].to_vector());
            (now - from).into()
        });
        (numbers, self.kernel.modes(&nodal))
    }

    /// Hourglass moduli of an element at some strains, from the committed history variables.
    fn moduli_at(&self, element: usize, strains: &[Strain; P]) -> [f64; 3] {
        match self.law.current() {
            Some(law) => self.hourglass_moduli(law, element, strains),
            None => self.moduli.hourglass,
        }
    }

    /// Writes the internal nodal forces of an element at a displacement, from the committed history variables
    /// and an initial stress; computed in double precision.
    pub(super) fn write_forces_of(
        &self,
        element: usize,
        displacement: NodalView,
        initial: &Stress,
        out: &mut [Vec3],
    ) {
        if !self.is_active(element) {
            out.fill(Vec3::zeros());
            return;
        }
        let (numbers, modes) = self.element_at(element, displacement);
        let geometry = Geometry::<f64>::new((), &numbers);
        let own = self.history.own_of_element(&self.arrangement, element);
        let mut strains = self.kernel.strains(geometry, &modes);
        if !own.is_empty() {
            self.kernel.add_own_strains(geometry, &own, &mut strains);
        }
        let changes = match self.law.current() {
            Some(law) => self.at_points(element, &strains, |input, new| {
                law.stress_change(input, new)
            }),
            None => strains
                .map(|strain| Stress::elastic(self.moduli.lambda, self.moduli.shear, &strain)),
        };
        let stresses = changes.map(|change| *initial + change);
        let moduli = self.moduli_at(element, &strains);
        let hourglass = Hourglass::new(moduli).with_history(&own);
        let forces = (self.kernel).forces(geometry, &stresses, &hourglass, &modes);
        for (out, force) in out.iter_mut().zip(self.kernel.nodal_forces(&forces)) {
            *out = Vec3::from(force);
        }
    }

    /// Stress on three faces of an element less that at its points, at a displacement, from the committed history
    /// variables.
    pub(super) fn surface_stresses_of(
        &self,
        element: usize,
        displacement: NodalView,
    ) -> Option<[Stress; 3]> {
        if !self.is_active(element) {
            return None;
        }
        let (numbers, modes) = self.element_at(element, displacement);
        let geometry = Geometry::<f64>::new((), &numbers);
        let own = self.history.own_of_element(&self.arrangement, element);
        let moduli = self.moduli_at(element, &self.kernel.strains(geometry, &modes));
        let hourglass = Hourglass::new(moduli).with_history(&own);
        (self.kernel).surface_stresses(geometry, &hourglass, &modes)
    }
}
