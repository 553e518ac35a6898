//! The eight-node brick with one point and hourglass stiffness.

use powerhouse_model::{
    ElementKernel, ElementKind, Geometry, Lane, ParameterError, Strain, Stress, Vec3,
};

use super::hexahedron::{self, MODE_NUMBERS};
use super::vectors::{
    Matrix, cross, difference, dot, outer_sum, product, scaled, scaled_sum, strain_of,
    stress_matrix, sum,
};

const INVERSE_VOLUME: usize = MODE_NUMBERS;
const RESISTANCE: usize = MODE_NUMBERS + 1;

/// The uniform-strain brick: mean gradient over the volume, stiffness against hourglass modes.
///
/// The displacement gradient is the exact mean over the trilinear brick, `(1/V) integral of
/// grad N dV = (1/V) dV/dx_a`, so that distorted meshes pass the patch test. With the modes `X_k` of the
/// corner positions (`x = X_0 + r X_1 + s X_2 + t X_3 + st X_4 + tr X_5 + rs X_6 + rst X_7`),
/// ```text
/// V / 8 = X1.(X2 x X3) + (X1.(X6 x X5) + X5.(X4 x X3) + X6.(X2 x X4)) / 3
/// g_k   = d(V/8) / dX_k        grad u = (1/V) sum_k S_k (x) g_k,  k = 1..6
/// ```
/// where `S_k` is the sum of the nodal displacements with the signs of mode `k`; `X7` does not
/// enter. The hourglass strains are those of Flanagan and Belytschko, orthogonal to all linear
/// fields,
/// ```text
/// q_a = S_a - 8 grad u X_a,  a = 4..7,
/// energy = 1/2 c sum_a |q_a|^2,  c = (hourglass / 2) (lambda + 2 G) sum_k |g_k|^2 / V
/// ```
/// which is their elastic hourglass stiffness: `q_a / sqrt 8` works against
/// `(hourglass / 2) (lambda + 2 G) V B:B` with the mean gradient matrix `B`.
///
/// Source: D. P. Flanagan and T. Belytschko, A uniform strain hexahedron and quadrilateral with
/// orthogonal hourglass control, Int. J. Numer. Meth. Engng 17 (1981) 679-706.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hex8OnePoint {
    /// Hourglass coefficient (1), from 0.001 to 1; 0.1 by default. A cube in pure bending has its true
    /// stiffness near `0.22 E / (lambda + 2 G)`; lower values are softer. Below 0.01 a mesh may
    /// show the modes.
    pub hourglass: f64,
}

impl Hex8OnePoint {
    /// With the default hourglass coefficient.
    pub const DEFAULT: Self = Self { hourglass: 0.1 };

    /// With a hourglass coefficient from 0.001 to 1.
    ///
    /// # Errors
    /// If it is outside.
    pub fn new(hourglass: f64) -> Result<Self, ParameterError> {
        ParameterError::check("hourglass", hourglass, 1e-3, 1.0)?;
        Ok(Self { hourglass })
    }
}

impl Default for Hex8OnePoint {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// `d(V/8) / dX_k` for `k = 1..6`.
#[inline(always)]
fn volume_gradients<L: Lane>(x: &[[L; 3]; 7]) -> [[L; 3]; 6] {
    let third = x[0][0].constant(1.0 / 3.0);
    let [x1, x2, x3, x4, x5, x6, _] = *x;
    [
        scaled_sum(cross(x6, x5), third, cross(x2, x3)),
        scaled_sum(cross(x4, x6), third, cross(x3, x1)),
        scaled_sum(cross(x5, x4), third, cross(x1, x2)),
        scaled(sum(cross(x3, x5), cross(x6, x2)), third),
        scaled(sum(cross(x1, x6), cross(x4, x3)), third),
        scaled(sum(cross(x5, x1), cross(x2, x4)), third),
    ]
}

/// The position modes of a batch.
#[inline(always)]
fn position_modes<L: Lane>(geometry: &Geometry<L>) -> [[L; 3]; 7] {
    [
        geometry.vector(0),
        geometry.vector(3),
        geometry.vector(6),
        geometry.vector(9),
        geometry.vector(12),
        geometry.vector(15),
        geometry.vector(18),
    ]
}

/// Mean displacement gradient.
#[inline(always)]
fn mean_gradient<L: Lane>(
    geometry: &Geometry<L>,
    g: &[[L; 3]; 6],
    modes: &[[L; 3]; 8],
) -> Matrix<L> {
    let inverse = geometry.get(INVERSE_VOLUME);
    let s = [modes[1], modes[2], modes[3], modes[4], modes[5], modes[6]];
    let rows = outer_sum(s, *g);
    [
        scaled(rows[0], inverse),
        scaled(rows[1], inverse),
        scaled(rows[2], inverse),
    ]
}

/// The hourglass strains `q_a`, and the positions `8 X_a` that they are measured with.
#[inline(always)]
fn hourglass_strains<L: Lane>(
    x: &[[L; 3]; 7],
    gradient: &Matrix<L>,
    modes: &[[L; 3]; 8],
) -> ([[L; 3]; 4], [[L; 3]; 4]) {
    let eight = x[0][0].constant(8.0);
    let mut strains = [modes[4], modes[5], modes[6], modes[7]];
    let mut positions = [x[3], x[4], x[5], x[6]];
    for a in 0..4 {
        positions[a] = scaled(positions[a], eight);
        strains[a] = difference(strains[a], product(gradient, positions[a]));
    }
    (strains, positions)
}

impl ElementKernel<8, 1> for Hex8OnePoint {
    fn name(&self) -> &'static str {
        "hex8-one-point"
    }
    fn kind(&self) -> ElementKind {
        ElementKind::Hex8
    }
    #[inline(always)]
    fn geometry_len(&self) -> usize {
        MODE_NUMBERS + 2
    }
    fn geometry(&self, corners: &[Vec3; 8], out: &mut [f64]) {
        let x = hexahedron::position_modes(corners).map(|mode| scaled(mode, 0.125));
        out[..MODE_NUMBERS].copy_from_slice(x.as_flattened());
        let g = volume_gradients(&x);
        // V/8 is of third degree in the modes, hence sum_k X_k . d(V/8)/dX_k = 3 V/8.
        let thrice: f64 = (0..6).map(|k| dot(x[k], g[k])).sum();
        let volume = 8.0 / 3.0 * thrice;
        let squares: f64 = g.iter().map(|g| dot(*g, *g)).sum();
        out[INVERSE_VOLUME] = 1.0 / volume;
        out[RESISTANCE] = 0.5 * self.hourglass * squares / volume;
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 1] {
        [geometry.constant(1.0) / geometry.get(INVERSE_VOLUME)]
    }
    fn node_shares(&self, corners: &[Vec3; 8]) -> [f64; 8] {
        hexahedron::node_shares(corners)
    }
    #[inline(always)]
    fn modes<L: Lane>(&self, nodal: &[[L; 3]; 8]) -> [[L; 3]; 8] {
        hexahedron::modes(nodal)
    }
    #[inline(always)]
    fn nodal_forces<L: Lane>(&self, modal: &[[L; 3]; 8]) -> [[L; 3]; 8] {
        hexahedron::nodal_forces(modal)
    }
    #[inline(always)]
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 8]) -> [Strain<L>; 1] {
        let g = volume_gradients(&position_modes(&geometry));
        [strain_of(&mean_gradient(&geometry, &g, modes))]
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 1],
        modulus: L,
        modes: &[[L; 3]; 8],
    ) -> [[L; 3]; 8] {
        let x = position_modes(&geometry);
        let g = volume_gradients(&x);
        let gradient = mean_gradient(&geometry, &g, modes);
        let (strains, positions) = hourglass_strains(&x, &gradient, modes);
        let resistance = modulus * geometry.get(RESISTANCE);
        let mut resisted = strains;
        for a in 0..4 {
            resisted[a] = scaled(strains[a], resistance);
        }

        // The mean gradient carries the stress, less what the hourglass forces take from it:
        // P = sigma - (1/V) sum_a Q_a (x) 8 X_a.
        let mut taken = outer_sum(resisted, positions);
        let minus = -geometry.get(INVERSE_VOLUME);
        let stress = stress_matrix(&stresses[0]);
        for i in 0..3 {
            taken[i] = scaled_sum(taken[i], minus, stress[i]);
        }
        let zero = geometry.constant(0.0);
        [
            [zero; 3],
            product(&taken, g[0]),
            product(&taken, g[1]),
            product(&taken, g[2]),
            sum(product(&taken, g[3]), resisted[0]),
            sum(product(&taken, g[4]), resisted[1]),
            sum(product(&taken, g[5]), resisted[2]),
            resisted[3],
        ]
    }
    #[inline(always)]
    fn hourglass_energy<L: Lane>(
        &self,
        geometry: Geometry<L>,
        modulus: L,
        modes: &[[L; 3]; 8],
    ) -> Option<L> {
        let x = position_modes(&geometry);
        let gradient = mean_gradient(&geometry, &volume_gradients(&x), modes);
        let (q, _) = hourglass_strains(&x, &gradient, modes);
        let squares = (dot(q[0], q[0]) + dot(q[1], q[1])) + (dot(q[2], q[2]) + dot(q[3], q[3]));
        let half = geometry.constant(0.5);
        Some(half * modulus * geometry.get(RESISTANCE) * squares)
    }
}
