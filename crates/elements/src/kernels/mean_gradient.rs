//! Mean displacement gradient and hourglass strains of a brick with any corners.

use powerhouse_model::{Geometry, Lane, Stress, Vec3};

use super::hexahedron;
use super::vectors::{
    Matrix, cross, cross_sum, dot, dot_sum, outer_sum, scaled, scaled_sum, stress_matrix,
};

/// Indices of the geometry numbers: `X_k / sqrt V` of the linear modes, `8 X_a` of the others.
pub(super) const LINEAR: usize = 0;
const BENT: usize = 9;
pub(super) const VOLUME: usize = 21;
/// Index of `1 / (8 sqrt V)`, which turns `8 X_a` into `X_a / sqrt V`.
pub(super) const SHRINK: usize = 22;
/// Number of these numbers.
pub(super) const NUMBERS: usize = 23;

/// Writes the geometry numbers of a brick; returns `sum_k |g_k|^2` of its volume gradients.
pub(super) fn geometry(corners: &[Vec3; 8], out: &mut [f64]) -> f64 {
    let x = hexahedron::position_modes(corners).map(|mode| scaled(mode, 0.125));
    let bent = [x[3], x[4], x[5], x[6]];
    let g = volume_gradients([x[0], x[1], x[2]], &bent, 1.0);
    // V/8 is of third degree in the modes, hence sum_k X_k . d(V/8)/dX_k = 3 V/8.
    let thrice: f64 = (0..6).map(|k| dot(x[k], g[k])).sum();
    let volume = 8.0 / 3.0 * thrice;
    let root = volume.sqrt();
    for k in 0..7 {
        let scale = if k < 3 { 1.0 / root } else { 8.0 };
        out[3 * k..3 * k + 3].copy_from_slice(&scaled(x[k], scale));
    }
    out[VOLUME] = volume;
    out[SHRINK] = 0.125 / root;
    g.iter().map(|g| dot(*g, *g)).sum()
}

/// Volume gradients `d(V/8) / dX_k` for `k = 1..6`, where the last three `X_k` are given as multiples by
/// `1 / shrink`.
#[inline(always)]
fn volume_gradients<L: Lane>([x1, x2, x3]: [[L; 3]; 3], y: &[[L; 3]; 4], shrink: L) -> [[L; 3]; 6] {
    let [y4, y5, y6, _] = *y;
    let third = shrink * shrink.constant(1.0 / 3.0);
    let squared = third * shrink;
    [
        scaled_sum(cross(y6, y5), squared, cross(x2, x3)),
        scaled_sum(cross(y4, y6), squared, cross(x3, x1)),
        scaled_sum(cross(y5, y4), squared, cross(x1, x2)),
        scaled(cross_sum([x3, y6], [y5, x2]), third),
        scaled(cross_sum([x1, y4], [y6, x3]), third),
        scaled(cross_sum([y5, x2], [x1, y4]), third),
    ]
}

/// Shape of an element: `g_k / V` and `8 X_a`.
pub(super) struct Shape<L> {
    gradients: [[L; 3]; 6],
    bent: [[L; 3]; 4],
}

impl<L: Lane> Shape<L> {
    #[inline(always)]
    pub(super) fn new(geometry: &Geometry<L>) -> Self {
        let linear = [
            geometry.vector(LINEAR),
            geometry.vector(LINEAR + 3),
            geometry.vector(LINEAR + 6),
        ];
        let bent = [
            geometry.vector(BENT),
            geometry.vector(BENT + 3),
            geometry.vector(BENT + 6),
            geometry.vector(BENT + 9),
        ];
        Self {
            gradients: volume_gradients(linear, &bent, geometry.get(SHRINK)),
            bent,
        }
    }
    /// Mean displacement gradient.
    #[inline(always)]
    pub(super) fn mean_gradient(&self, modes: &[[L; 3]; 8]) -> Matrix<L> {
        let [_, s1, s2, s3, s4, s5, s6, _] = *modes;
        outer_sum([s1, s2, s3, s4, s5, s6], self.gradients)
    }
    /// Hourglass strains `q_a`.
    #[inline(always)]
    pub(super) fn hourglass_strains(
        &self,
        gradient: &Matrix<L>,
        modes: &[[L; 3]; 8],
    ) -> [[L; 3]; 4] {
        let mut strains = [modes[4], modes[5], modes[6], modes[7]];
        for i in 0..3 {
            let [x, y, z] = gradient[i];
            for a in 0..4 {
                let bent = self.bent[a];
                let less = (-z).mul_add(bent[2], strains[a][i]);
                strains[a][i] = (-x).mul_add(bent[0], (-y).mul_add(bent[1], less));
            }
        }
        strains
    }
    /// Modal forces of a mean stress and of hourglass forces `Q_a`, conjugate to the hourglass strains.
    #[inline(always)]
    pub(super) fn forces(
        &self,
        geometry: &Geometry<L>,
        stress: &Stress<L>,
        resisted: &[[L; 3]; 4],
    ) -> [[L; 3]; 8] {
        let volume = geometry.get(VOLUME);
        let stress = stress_matrix(stress);
        let g = &self.gradients;
        let mut forces = [[geometry.constant(0.0); 3]; 8];
        for i in 0..3 {
            // The mean gradient carries the stress, less what the hourglass forces take from it:
            // P = V sigma - sum_a Q_a (x) 8 X_a.
            let mut carried = scaled(stress[i], volume);
            for a in 0..4 {
                carried = scaled_sum(self.bent[a], -resisted[a][i], carried);
            }
            let q = [resisted[0][i], resisted[1][i], resisted[2][i]];
            for k in 0..3 {
                forces[1 + k][i] = dot(carried, g[k]);
                forces[4 + k][i] = dot_sum(carried, g[3 + k], q[k]);
            }
            forces[7][i] = resisted[3][i];
        }
        forces
    }
}
