//! Five-node pyramid.

use powerhouse_model::{
    ElasticMedium, ElementKernel, ElementKind, Geometry, HistoryKernel, Hourglass, HourglassKernel,
    Lane, OwnStep, Strain, Stress, Vec3,
};

use super::hex8_natural::Hex8Natural;
use super::hexahedron;
use super::positions;
use super::vectors::sum;

/// Uniform-strain pyramid with five nodes: a [`Hex8Natural`] of which the four nodes of the top are one.
///
/// Its sides are those of bricks and tetrahedra, so that it joins them without a gap, and with them it passes the patch test.
/// Lumped masses are row sums, 3/16 at each corner of the base of a right pyramid and 1/4 at the apex. The stable step falls
/// with the height of the apex: to half of that of a cube on the same base at a height of half an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pyramid5;

const BRICK: Hex8Natural = Hex8Natural;

/// Values at the nodes of the brick.
#[inline(always)]
fn of_brick<T: Copy>(of_pyramid: &[T; 5]) -> [T; 8] {
    let [a, b, c, d, apex] = *of_pyramid;
    [a, b, c, d, apex, apex, apex, apex]
}

/// Modes of the brick.
#[inline(always)]
fn modes_of_brick<L: Lane>(nodal: &[[L; 3]; 5]) -> [[L; 3]; 8] {
    hexahedron::modes(&of_brick(nodal))
}

impl ElementKernel<5, 1> for Pyramid5 {
    fn name(&self) -> &'static str {
        "pyramid5"
    }
    fn kind(&self) -> ElementKind {
        ElementKind::Pyramid5
    }
    #[inline(always)]
    fn geometry_len(&self) -> usize {
        BRICK.geometry_len()
    }
    fn geometry(&self, corners: &[Vec3; 5], out: &mut [f64]) {
        BRICK.geometry(&of_brick(corners), out);
    }
    fn point_positions(&self, corners: &[Vec3; 5]) -> [Vec3; 1] {
        let centre = ElementKind::Pyramid5.natural_centre();
        positions(ElementKind::Pyramid5, corners, [centre.into()])
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 1] {
        BRICK.volumes(geometry)
    }
    fn node_shares(&self, corners: &[Vec3; 5]) -> [f64; 5] {
        let [a, b, c, d, apex @ ..] = BRICK.node_shares(&of_brick(corners));
        [a, b, c, d, apex.iter().sum()]
    }
    #[inline(always)]
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 5]) -> [Strain<L>; 1] {
        BRICK.strains(geometry, &modes_of_brick(modes))
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 1],
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; 5],
    ) -> [[L; 3]; 5] {
        let modal = BRICK.forces(geometry, stresses, hourglass, &modes_of_brick(modes));
        let [a, b, c, d, e, f, g, h] = hexahedron::nodal_forces(&modal);
        [a, b, c, d, sum(sum(e, f), sum(g, h))]
    }
    #[inline(always)]
    fn hourglass(&self) -> Option<&impl HourglassKernel<5, 1>> {
        Some(self)
    }
    #[inline(always)]
    fn history(&self) -> Option<&impl HistoryKernel<5, 1>> {
        Some(self)
    }
}

impl HourglassKernel<5, 1> for Pyramid5 {
    fn hourglass_moduli(&self, medium: &ElasticMedium) -> [f64; 3] {
        BRICK.hourglass_moduli(medium)
    }
    #[inline(always)]
    fn hourglass_energy<L: Lane>(
        &self,
        geometry: Geometry<L>,
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; 5],
    ) -> L {
        BRICK.hourglass_energy(geometry, hourglass, &modes_of_brick(modes))
    }
    fn hourglass_is_bending(&self) -> bool {
        BRICK.hourglass_is_bending()
    }
    #[inline(always)]
    fn least_hourglass_share(&self) -> f64 {
        BRICK.least_hourglass_share()
    }
    fn surface_stresses(
        &self,
        geometry: Geometry<f64>,
        hourglass: &Hourglass<f64>,
        modes: &[[f64; 3]; 5],
    ) -> Option<[Stress; 3]> {
        BRICK.surface_stresses(geometry, hourglass, &modes_of_brick(modes))
    }
}

impl HistoryKernel<5, 1> for Pyramid5 {
    #[inline(always)]
    fn own_history(&self) -> usize {
        BRICK.own_history()
    }
    #[inline(always)]
    fn own_history_after<L: Lane>(
        &self,
        geometry: Geometry<L>,
        step: &OwnStep<L, 5, 1>,
        new: &mut [L],
    ) {
        let (modes, moved) = (modes_of_brick(step.modes), modes_of_brick(step.moved));
        let mut of_brick = OwnStep::new(step.history, &modes, step.stresses);
        of_brick.moved = &moved;
        of_brick.moduli = step.moduli;
        of_brick.elastic_share = step.elastic_share;
        of_brick.kept = step.kept;
        BRICK.own_history_after(geometry, &of_brick, new);
    }
}
