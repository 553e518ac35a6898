//! Internal forces of single elements, for section forces.

use powerhouse_model::{ElementKernel, Geometry, NodalView, Stress, Vec3};

use super::Block;
use super::transfer::NodeScalar;

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
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
        let mut numbers = vec![0.0; self.kernel.geometry_len()];
        self.geometry_of(element, &mut numbers);
        let geometry = Geometry::<f64>::new((), &numbers);
        let nodal = self.connectivity.as_slice()[element].map(|local| {
            let now = displacement.vector(local as usize);
            let from = self.reference.as_ref();
            let from = from.map_or(Vec3::zeros(), |from| from[local as usize].to_vector());
            (now - from).into()
        });
        let modes = self.kernel.modes(&nodal);
        let strains = self.kernel.strains(geometry, &modes);
        let changes = match self.law.current() {
            Some(law) => self.at_points(element, &strains, |input, new| {
                law.stress_change(input, new)
            }),
            None => strains
                .map(|strain| Stress::elastic(self.moduli.lambda, self.moduli.shear, &strain)),
        };
        let stresses = changes.map(|change| *initial + change);
        let modulus = match self.law.current() {
            Some(law) => self.hourglass_modulus(law, element, &strains),
            None => self.moduli.hourglass,
        };
        let forces = self.kernel.forces(geometry, &stresses, modulus, &modes);
        for (out, force) in out.iter_mut().zip(self.kernel.nodal_forces(&forces)) {
            *out = Vec3::from(force);
        }
    }
}
