//! One-point brick for parallelepipeds.

use powerhouse_model::{
    ElasticMedium, ElementKernel, ElementKind, Geometry, Hourglass, HourglassKernel, Lane,
    ModalKernel, Strain, Stress, Vec3,
};

use super::hex8_one_point::Hex8OnePoint;
use super::hexahedron::{self, HexahedronModes};
use super::positions;
use super::vectors::{dot, linear_gradients, outer_sum, scaled, strain_of, uniform_forces};
use crate::block::coordinate_rounding;

/// Index of the volume, after `g_k / V` of the linear modes.
const VOLUME: usize = 9;
/// Index of the hourglass factor `c / (lambda + 2 G)`.
const RESISTANCE: usize = 10;

/// [`Hex8OnePoint`] for parallelepipeds, whose corners have no modes `X_4..X_7`: the gradient has three terms
/// instead of six, and the hourglass strains are the plain sums `S_4..S_7`.
///
/// It reads 11 numbers instead of 24 and needs half of the time.
#[derive(Clone)]
pub(super) struct Parallelepiped(pub(super) Hex8OnePoint);

impl ElementKernel<8, 1> for Parallelepiped {
    fn name(&self) -> &'static str {
        self.0.name()
    }
    fn kind(&self) -> ElementKind {
        ElementKind::Hex8
    }
    #[inline(always)]
    fn geometry_len(&self) -> usize {
        RESISTANCE + 1
    }
    fn geometry(&self, corners: &[Vec3; 8], out: &mut [f64]) {
        let x = hexahedron::position_modes(corners).map(|mode| Vec3::from(mode) / 8.0);
        let g = [x[1].cross(&x[2]), x[2].cross(&x[0]), x[0].cross(&x[1])];
        let volume = 8.0 * x[0].dot(&g[0]);
        for k in 0..3 {
            out[3 * k..3 * k + 3].copy_from_slice((g[k] / volume).as_slice());
        }
        let squares: f64 = g.iter().map(Vec3::norm_squared).sum();
        out[VOLUME] = volume;
        out[RESISTANCE] = 0.5 * self.0.hourglass * squares / volume;
    }
    fn point_positions(&self, corners: &[Vec3; 8]) -> [Vec3; 1] {
        positions(ElementKind::Hex8, corners, [[0.0; 3]])
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 1] {
        [geometry.get(VOLUME)]
    }
    fn node_shares(&self, _corners: &[Vec3; 8]) -> [f64; 8] {
        [0.125; 8]
    }
    #[inline(always)]
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 8]) -> [Strain<L>; 1] {
        let gradient = outer_sum([modes[1], modes[2], modes[3]], linear_gradients(&geometry));
        [strain_of(&gradient)]
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 1],
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; 8],
    ) -> [[L; 3]; 8] {
        let gradients = linear_gradients(&geometry);
        let [f1, f2, f3] = uniform_forces(&stresses[0], geometry.get(VOLUME), gradients);
        let resistance = hourglass.moduli[0] * geometry.get(RESISTANCE);
        [
            [geometry.constant(0.0); 3],
            f1,
            f2,
            f3,
            scaled(modes[4], resistance),
            scaled(modes[5], resistance),
            scaled(modes[6], resistance),
            scaled(modes[7], resistance),
        ]
    }
    #[inline(always)]
    fn modal(&self) -> Option<&impl ModalKernel<8, 1>> {
        Some(&HexahedronModes)
    }
    #[inline(always)]
    fn hourglass(&self) -> Option<&impl HourglassKernel<8, 1>> {
        Some(self)
    }
}

impl HourglassKernel<8, 1> for Parallelepiped {
    fn hourglass_moduli(&self, medium: &ElasticMedium) -> [f64; 3] {
        self.0.hourglass_moduli(medium)
    }
    #[inline(always)]
    fn hourglass_energy<L: Lane>(
        &self,
        geometry: Geometry<L>,
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; 8],
    ) -> L {
        let [_, _, _, _, q4, q5, q6, q7] = *modes;
        let squares = (dot(q4, q4) + dot(q5, q5)) + (dot(q6, q6) + dot(q7, q7));
        let half = geometry.constant(0.5);
        half * hourglass.moduli[0] * geometry.get(RESISTANCE) * squares
    }
}

/// Whether opposite sides are parallel, within the rounding of the coordinates.
pub(super) fn is_parallelepiped(corners: &[Vec3; 8]) -> bool {
    let tolerance = 8.0 * coordinate_rounding(corners);
    let [_, _, _, bent @ ..] = hexahedron::position_modes(corners);
    bent.as_flattened().iter().all(|x| x.abs() <= tolerance)
}
