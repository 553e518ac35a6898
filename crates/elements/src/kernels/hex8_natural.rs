//! Eight-node brick with one integration point that bends as its material does.

use powerhouse_model::{
    ElasticMedium, ElementKernel, ElementKind, Geometry, HistoryKernel, Hourglass, HourglassKernel,
    Lane, ModalKernel, OwnStep, Strain, Stress, Vec3,
};

use super::hexahedron::{self, HexahedronModes};
use super::mean_gradient::{self, NUMBERS, SHRINK, Shape, VOLUME};
use super::natural_frame::{self, NaturalFrame, linear};
use super::positions;
use super::vectors::strain_of;

/// Uniform-strain eight-node brick whose hourglass forces are those of its material in bending.
///
/// Mean displacement gradient and hourglass strains `q_a` are those of [`Hex8OnePoint`](super::Hex8OnePoint), so that
/// distorted meshes pass the patch test. The linear part of the stress follows from the natural frame of the brick
/// without a coefficient: for each of the three natural directions the brick is a plate with its thickness along it, whose
/// curvatures are hourglass strains and whose stress is plane; transverse shear and stress along the thickness
/// vanish. With the positions `g_i = X_i` along r, s, t, `[ij]` the mode of the product of the coordinates `i` and `j`,
/// and `p = q_[ik] / 8`, `r = q_[jk] / 8`,
/// ```text
/// k_ii = g_i.p    k_jj = g_j.r    2 k_ij = g_i.r + g_j.p       curvature of the plate k, covariant
/// A = inverse of the metric g_i.g_j of its plane               m = A:k
/// s = (2 lambda G / (lambda + 2 G)) m A + 2 G A k A            plane stress at coordinate k = 1, contravariant
/// P_[ik] += (V / 3) (s_ii g_i + s_ij g_j)                      P_[jk] += (V / 3) (s_jj g_j + s_ij g_i)
/// P_[123] = (V / 9) E sum_i g_i (g_i.q_[123] / 8) / |g_i|^4    uniaxial stress
/// ```
/// A right brick bends exactly, one layer of them has the bending stiffness of the plate, the brick does not lock as the
/// material becomes incompressible, and its highest frequency is that of the mean gradient alone. The energy of
/// these forces is strain energy of bending, nearly all that a thin ring has.
///
/// The forces fall with the share that remains by the law
/// ([`RemainingStiffness::hourglass`](powerhouse_model::RemainingStiffness)), to a fiftieth at least, and what they lose is
/// energy of damage. Under plastic flow a plastic part of the hourglass strains grows, the element's own history, by as
/// much of their increment as is plastic at the point, and by what flow there relaxes of all differences of stress; what
/// it takes is plastic energy. A hinge needs more: one point
/// flows as a whole or not at all.
///
/// In the manner of T. Belytschko and L. P. Bindeman, Assumed strain stabilization of the eight node hexahedral element,
/// Comput. Methods Appl. Mech. Engng 105 (1993) 225-260, with which it agrees on right bricks, and of M. A. Puso, A highly
/// efficient enhanced assumed strain physically stabilized hexahedral element, Int. J. Numer. Meth. Engng 49 (2000)
/// 1029-1064.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hex8Natural;

impl ElementKernel<8, 1> for Hex8Natural {
    fn name(&self) -> &'static str {
        "hex8-natural"
    }
    fn kind(&self) -> ElementKind {
        ElementKind::Hex8
    }
    #[inline(always)]
    fn geometry_len(&self) -> usize {
        NUMBERS
    }
    fn geometry(&self, corners: &[Vec3; 8], out: &mut [f64]) {
        mean_gradient::geometry(corners, out);
    }
    fn point_positions(&self, corners: &[Vec3; 8]) -> [Vec3; 1] {
        positions(ElementKind::Hex8, corners, [[0.0; 3]])
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 1] {
        [geometry.get(VOLUME)]
    }
    fn node_shares(&self, corners: &[Vec3; 8]) -> [f64; 8] {
        hexahedron::node_shares(corners)
    }
    #[inline(always)]
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 8]) -> [Strain<L>; 1] {
        [strain_of(&Shape::new(&geometry).mean_gradient(modes))]
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 1],
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; 8],
    ) -> [[L; 3]; 8] {
        let shape = Shape::new(&geometry);
        let gradient = shape.mean_gradient(modes);
        let strains = shape.hourglass_strains(&gradient, modes);
        let strains = natural_frame::elastic_part(strains, hourglass.history);
        let resisted = NaturalFrame::new(linear(&geometry)).forces(&hourglass.moduli, &strains);
        shape.forces(&geometry, &stresses[0], &resisted)
    }
    #[inline(always)]
    fn modal(&self) -> Option<&impl ModalKernel<8, 1>> {
        Some(&HexahedronModes)
    }
    #[inline(always)]
    fn hourglass(&self) -> Option<&impl HourglassKernel<8, 1>> {
        Some(self)
    }
    #[inline(always)]
    fn history(&self) -> Option<&impl HistoryKernel<8, 1>> {
        Some(self)
    }
}

impl HourglassKernel<8, 1> for Hex8Natural {
    fn hourglass_moduli(&self, medium: &ElasticMedium) -> [f64; 3] {
        natural_frame::moduli(medium)
    }
    #[inline(always)]
    fn hourglass_energy<L: Lane>(
        &self,
        geometry: Geometry<L>,
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; 8],
    ) -> L {
        let shape = Shape::new(&geometry);
        let strains = shape.hourglass_strains(&shape.mean_gradient(modes), modes);
        let strains = natural_frame::elastic_part(strains, hourglass.history);
        let frame = NaturalFrame::new(linear(&geometry));
        frame.energy(&hourglass.moduli, &strains)
    }
    fn hourglass_is_bending(&self) -> bool {
        true
    }
    #[inline(always)]
    fn least_hourglass_share(&self) -> f64 {
        0.02
    }
    fn surface_stresses(
        &self,
        geometry: Geometry<f64>,
        hourglass: &Hourglass<f64>,
        modes: &[[f64; 3]; 8],
    ) -> Option<[Stress; 3]> {
        let shape = Shape::new(&geometry);
        let strains = shape.hourglass_strains(&shape.mean_gradient(modes), modes);
        let strains = natural_frame::elastic_part(strains, hourglass.history);
        let frame = NaturalFrame::new(linear(&geometry));
        Some(frame.surface_stresses(&hourglass.moduli, &strains, geometry.get(SHRINK)))
    }
}

impl HistoryKernel<8, 1> for Hex8Natural {
    #[inline(always)]
    fn own_history(&self) -> usize {
        natural_frame::HISTORY
    }
    #[inline(always)]
    fn own_history_after<L: Lane>(
        &self,
        geometry: Geometry<L>,
        step: &OwnStep<L, 8, 1>,
        new: &mut [L],
    ) {
        let shape = Shape::new(&geometry);
        let frame = NaturalFrame::new(linear(&geometry));
        let strains = shape.hourglass_strains(&shape.mean_gradient(step.modes), step.modes);
        let moved = shape.hourglass_strains(&shape.mean_gradient(step.moved), step.moved);
        frame.flow(step, &strains, &moved, new);
    }
}
