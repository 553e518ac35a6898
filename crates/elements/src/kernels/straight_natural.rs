//! One-point bricks with hourglass forces of the material in bending, whose edges are parallel.

use powerhouse_model::{
    ElasticMedium, ElementKernel, ElementKind, Geometry, HistoryKernel, Hourglass, HourglassKernel,
    Lane, ModalKernel, OwnStep, Strain, Stress, Vec3,
};

use super::hex8_natural::Hex8Natural;
use super::hexahedron::{self, HexahedronModes};
use super::natural_frame::{self, NaturalFrame, linear};
use super::positions;
use super::vectors::{Matrix, cross, dot, outer_sum, scaled, strain_of, uniform_forces};

/// [`Hex8Natural`] for parallelepipeds, in particular for boxes along the axes: the hourglass strains are the plain sums
/// `S_4..S_7`, and in a box each plate couples two numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct StraightNatural {
    /// Whether the edges along r, s, t are along x, y, z.
    pub(super) along_axes: bool,
}

impl StraightNatural {
    /// Gradients `g_k / V` of the linear modes.
    #[inline(always)]
    fn gradients<L: Lane>(&self, geometry: &Geometry<L>) -> Matrix<L> {
        if self.along_axes {
            let zero = geometry.constant(0.0);
            let [a, b, c] = geometry.vector(0);
            [[a, zero, zero], [zero, b, zero], [zero, zero, c]]
        } else {
            let [r, s, t] = linear(geometry);
            [cross(s, t), cross(t, r), cross(r, s)]
        }
    }
    #[inline(always)]
    fn volume<L: Lane>(&self, geometry: &Geometry<L>) -> L {
        geometry.get(self.numbers() - 1)
    }
    /// Three gradients along the axes, or three vectors `X_k / sqrt V`; and the volume.
    #[inline(always)]
    fn numbers(&self) -> usize {
        if self.along_axes { 4 } else { 10 }
    }
    /// Hourglass forces, conjugate to the hourglass strains.
    #[inline(always)]
    fn resisted<L: Lane>(
        &self,
        geometry: &Geometry<L>,
        moduli: &[L; 3],
        strains: &[[L; 3]; 4],
    ) -> [[L; 3]; 4] {
        if self.along_axes {
            boxed_forces(geometry.vector(0), geometry.get(3), moduli, strains)
        } else {
            NaturalFrame::new(linear(geometry)).forces(moduli, strains)
        }
    }
    /// The natural frame of a brick.
    #[inline(always)]
    fn frame<L: Lane>(&self, geometry: &Geometry<L>) -> NaturalFrame<L> {
        if self.along_axes {
            let volume = self.volume(geometry);
            let eighth = volume.constant(0.125) / volume.sqrt();
            let [a, b, c] = geometry.vector(0);
            let zero = geometry.constant(0.0);
            NaturalFrame::new([
                [eighth / a, zero, zero],
                [zero, eighth / b, zero],
                [zero, zero, eighth / c],
            ])
        } else {
            NaturalFrame::new(linear(geometry))
        }
    }
}

#[inline(always)]
fn hourglass_strains<L: Lane>(modes: &[[L; 3]; 8]) -> [[L; 3]; 4] {
    [modes[4], modes[5], modes[6], modes[7]]
}

/// Hourglass forces of a box with gradients along the axes.
#[inline(always)]
fn boxed_forces<L: Lane>(
    g: [L; 3],
    volume: L,
    [plate, shear, young]: &[L; 3],
    strains: &[[L; 3]; 4],
) -> [[L; 3]; 4] {
    let third = volume * volume.constant(1.0 / 3.0);
    let (l, m) = (*plate * third, *shear * third);
    let p = l + (m + m);
    let mut forces = *strains;
    let mut twists = g;
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        // In the plate across direction `i` the strain `jj` is component `j` of mode `k`, `kk` component `k` of mode `j`.
        let (first, second) = (strains[k][j] * g[j], strains[j][k] * g[k]);
        forces[k][j] = p.mul_add(first, l * second) * g[j];
        forces[j][k] = p.mul_add(second, l * first) * g[k];
        twists[i] = m * strains[j][j].mul_add(g[k], strains[k][k] * g[j]);
    }
    forces[0][0] = twists[1].mul_add(g[2], twists[2] * g[1]);
    forces[1][1] = twists[2].mul_add(g[0], twists[0] * g[2]);
    forces[2][2] = twists[0].mul_add(g[1], twists[1] * g[0]);
    let ninth = *young * (third * third.constant(1.0 / 3.0));
    for i in 0..3 {
        forces[3][i] = ninth * (g[i] * g[i]) * strains[3][i];
    }
    forces
}

impl ElementKernel<8, 1> for StraightNatural {
    fn name(&self) -> &'static str {
        Hex8Natural.name()
    }
    fn kind(&self) -> ElementKind {
        ElementKind::Hex8
    }
    #[inline(always)]
    fn geometry_len(&self) -> usize {
        self.numbers()
    }
    fn geometry(&self, corners: &[Vec3; 8], out: &mut [f64]) {
        let x = hexahedron::position_modes(corners).map(|mode| Vec3::from(mode) / 8.0);
        let g = [x[1].cross(&x[2]), x[2].cross(&x[0]), x[0].cross(&x[1])];
        let volume = 8.0 * x[0].dot(&g[0]);
        for k in 0..3 {
            if self.along_axes {
                out[k] = g[k][k] / volume;
            } else {
                let scaled = x[k] / volume.sqrt();
                out[3 * k..3 * k + 3].copy_from_slice(scaled.as_slice());
            }
        }
        out[self.numbers() - 1] = volume;
    }
    fn point_positions(&self, corners: &[Vec3; 8]) -> [Vec3; 1] {
        positions(ElementKind::Hex8, corners, [[0.0; 3]])
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 1] {
        [self.volume(&geometry)]
    }
    fn node_shares(&self, _corners: &[Vec3; 8]) -> [f64; 8] {
        [0.125; 8]
    }
    #[inline(always)]
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 8]) -> [Strain<L>; 1] {
        if self.along_axes {
            let [a, b, c] = geometry.vector(0);
            let [_, r, s, t, ..] = *modes;
            return [Strain([
                r[0] * a,
                s[1] * b,
                t[2] * c,
                s[0].mul_add(b, r[1] * a),
                t[1].mul_add(c, s[2] * b),
                r[2].mul_add(a, t[0] * c),
            ])];
        }
        let linear = [modes[1], modes[2], modes[3]];
        [strain_of(&outer_sum(linear, self.gradients(&geometry)))]
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 1],
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; 8],
    ) -> [[L; 3]; 8] {
        let volume = self.volume(&geometry);
        let [f1, f2, f3] = if self.along_axes {
            let [xx, yy, zz, xy, yz, zx] = stresses[0].0;
            let g = scaled(geometry.vector(0), volume);
            [
                scaled([xx, xy, zx], g[0]),
                scaled([xy, yy, yz], g[1]),
                scaled([zx, yz, zz], g[2]),
            ]
        } else {
            uniform_forces(&stresses[0], volume, self.gradients(&geometry))
        };
        let strains = natural_frame::elastic_part(hourglass_strains(modes), hourglass.history);
        let [f4, f5, f6, f7] = self.resisted(&geometry, &hourglass.moduli, &strains);
        [[volume.constant(0.0); 3], f1, f2, f3, f4, f5, f6, f7]
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

impl HourglassKernel<8, 1> for StraightNatural {
    fn hourglass_moduli(&self, medium: &ElasticMedium) -> [f64; 3] {
        Hex8Natural.hourglass_moduli(medium)
    }
    #[inline(always)]
    fn hourglass_energy<L: Lane>(
        &self,
        geometry: Geometry<L>,
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; 8],
    ) -> L {
        let strains = natural_frame::elastic_part(hourglass_strains(modes), hourglass.history);
        let forces = self.resisted(&geometry, &hourglass.moduli, &strains);
        let mut work = dot(forces[0], strains[0]);
        for a in 1..4 {
            work = work + dot(forces[a], strains[a]);
        }
        work * work.constant(0.5)
    }
    fn hourglass_is_bending(&self) -> bool {
        true
    }
    #[inline(always)]
    fn least_hourglass_share(&self) -> f64 {
        Hex8Natural.least_hourglass_share()
    }
    fn surface_stresses(
        &self,
        geometry: Geometry<f64>,
        hourglass: &Hourglass<f64>,
        modes: &[[f64; 3]; 8],
    ) -> Option<[Stress; 3]> {
        let strains = natural_frame::elastic_part(hourglass_strains(modes), hourglass.history);
        let shrink = 0.125 / self.volume(&geometry).sqrt();
        let frame = self.frame(&geometry);
        Some(frame.surface_stresses(&hourglass.moduli, &strains, shrink))
    }
}

impl HistoryKernel<8, 1> for StraightNatural {
    #[inline(always)]
    fn own_history(&self) -> usize {
        Hex8Natural.own_history()
    }
    #[inline(always)]
    fn own_history_after<L: Lane>(
        &self,
        geometry: Geometry<L>,
        step: &OwnStep<L, 8, 1>,
        new: &mut [L],
    ) {
        let (strains, moved) = (hourglass_strains(step.modes), hourglass_strains(step.moved));
        self.frame(&geometry).flow(step, &strains, &moved, new);
    }
}
