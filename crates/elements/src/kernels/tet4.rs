//! Four-node tetrahedron.

use powerhouse_model::{
    ElementKernel, ElementKind, Geometry, Hourglass, Lane, ModalKernel, Strain, Stress, Vec3,
};

use super::positions;
use super::vectors::{difference, linear_gradients, outer_sum, strain_of, sum, uniform_forces};

const VOLUME: usize = 9;

/// Constant-strain tetrahedron with four nodes.
///
/// Its modes are the displacements of the corners 1, 2, 3 relative to corner 0. It is stiff, and it locks in
/// plastic flow and as the material becomes incompressible: use it only where bricks and wedges cannot mesh
/// the volume.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tet4;

impl ElementKernel<4, 1> for Tet4 {
    fn name(&self) -> &'static str {
        "tet4"
    }
    fn kind(&self) -> ElementKind {
        ElementKind::Tet4
    }
    #[inline(always)]
    fn geometry_len(&self) -> usize {
        VOLUME + 1
    }
    fn geometry(&self, corners: &[Vec3; 4], out: &mut [f64]) {
        let [a, b, c] = [1, 2, 3].map(|i| corners[i] - corners[0]);
        let determinant = a.dot(&b.cross(&c));
        for (i, cofactor) in [b.cross(&c), c.cross(&a), a.cross(&b)].iter().enumerate() {
            out[3 * i..3 * i + 3].copy_from_slice((cofactor / determinant).as_slice());
        }
        out[VOLUME] = determinant / 6.0;
    }
    fn point_positions(&self, corners: &[Vec3; 4]) -> [Vec3; 1] {
        positions(ElementKind::Tet4, corners, [[0.25; 3]])
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 1] {
        [geometry.get(VOLUME)]
    }
    fn node_shares(&self, _corners: &[Vec3; 4]) -> [f64; 4] {
        [0.25; 4]
    }
    #[inline(always)]
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 4]) -> [Strain<L>; 1] {
        let gradients = linear_gradients(&geometry);
        let gradient = outer_sum([modes[1], modes[2], modes[3]], gradients);
        [strain_of(&gradient)]
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 1],
        _hourglass: &Hourglass<L>,
        _modes: &[[L; 3]; 4],
    ) -> [[L; 3]; 4] {
        let gradients = linear_gradients(&geometry);
        let [f1, f2, f3] = uniform_forces(&stresses[0], geometry.get(VOLUME), gradients);
        [[geometry.constant(0.0); 3], f1, f2, f3]
    }
    #[inline(always)]
    fn modal(&self) -> Option<&impl ModalKernel<4, 1>> {
        Some(self)
    }
}

impl ModalKernel<4, 1> for Tet4 {
    #[inline(always)]
    fn modes<L: Lane>(&self, nodal: &[[L; 3]; 4]) -> [[L; 3]; 4] {
        let first = nodal[0];
        [
            first,
            difference(nodal[1], first),
            difference(nodal[2], first),
            difference(nodal[3], first),
        ]
    }
    #[inline(always)]
    fn nodal_forces<L: Lane>(&self, modal: &[[L; 3]; 4]) -> [[L; 3]; 4] {
        let [_, f1, f2, f3] = *modal;
        let all = sum(sum(f1, f2), f3);
        [[-all[0], -all[1], -all[2]], f1, f2, f3]
    }
}
