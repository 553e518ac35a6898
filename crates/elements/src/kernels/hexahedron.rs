//! Common functions of the hexahedra: modes of eight corners, and the Jacobian in terms of them.

use powerhouse_model::{Lane, ModalKernel, Vec3};

use super::vectors::cofactors;

/// Signs of the natural coordinates at the corners, in Gmsh's order.
pub(super) const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Geometry numbers of one element: seven modes of the position, without the constant one.
pub(super) const MODE_NUMBERS: usize = 21;

/// Sums of eight corner values with the signs of `1, r, s, t, st, tr, rs, rst`.
///
/// With `S` the result, the trilinear interpolation is
/// `(S0 + r S1 + s S2 + t S3 + st S4 + tr S5 + rs S6 + rst S7) / 8`.
#[inline(always)]
pub(super) fn modes<L: Lane>(v: &[[L; 3]; 8]) -> [[L; 3]; 8] {
    let mut modes = *v;
    for i in 0..3 {
        // Edges along r, each as sum and difference; then faces along s; then along t.
        let sums = [
            v[0][i] + v[1][i],
            v[3][i] + v[2][i],
            v[4][i] + v[5][i],
            v[7][i] + v[6][i],
        ];
        let r = [
            v[1][i] - v[0][i],
            v[2][i] - v[3][i],
            v[5][i] - v[4][i],
            v[6][i] - v[7][i],
        ];
        let (one, s) = (
            [sums[0] + sums[1], sums[2] + sums[3]],
            [sums[1] - sums[0], sums[3] - sums[2]],
        );
        let (r, rs) = ([r[0] + r[1], r[2] + r[3]], [r[1] - r[0], r[3] - r[2]]);
        modes[0][i] = one[0] + one[1];
        modes[1][i] = r[0] + r[1];
        modes[2][i] = s[0] + s[1];
        modes[3][i] = one[1] - one[0];
        modes[4][i] = s[1] - s[0];
        modes[5][i] = r[1] - r[0];
        modes[6][i] = rs[0] + rs[1];
        modes[7][i] = rs[1] - rs[0];
    }
    modes
}

/// Nodal forces from modal forces without a constant part, the transpose of [`modes`].
#[inline(always)]
pub(super) fn nodal_forces<L: Lane>(f: &[[L; 3]; 8]) -> [[L; 3]; 8] {
    let mut forces = *f;
    for i in 0..3 {
        let (r, s) = (
            [f[1][i] - f[5][i], f[1][i] + f[5][i]],
            [f[2][i] - f[4][i], f[2][i] + f[4][i]],
        );
        let (t, rs) = ([-f[3][i], f[3][i]], [f[6][i] - f[7][i], f[6][i] + f[7][i]]);
        for face in 0..2 {
            let (low, high) = (t[face] - s[face], t[face] + s[face]);
            let (low_r, high_r) = (r[face] - rs[face], r[face] + rs[face]);
            forces[4 * face][i] = low - low_r;
            forces[4 * face + 1][i] = low + low_r;
            forces[4 * face + 2][i] = high + high_r;
            forces[4 * face + 3][i] = high - high_r;
        }
    }
    forces
}

/// Deformation modes of hexahedra, of kernels whose elastic forces follow from strains and stresses.
pub(super) struct HexahedronModes;

impl<const P: usize> ModalKernel<8, P> for HexahedronModes {
    #[inline(always)]
    fn modes<L: Lane>(&self, nodal: &[[L; 3]; 8]) -> [[L; 3]; 8] {
        modes(nodal)
    }
    #[inline(always)]
    fn nodal_forces<L: Lane>(&self, modal: &[[L; 3]; 8]) -> [[L; 3]; 8] {
        nodal_forces(modal)
    }
}

/// Modes of the corner positions, without the constant one.
pub(super) fn position_modes(corners: &[Vec3; 8]) -> [[f64; 3]; 7] {
    let centre: Vec3 = corners.iter().sum::<Vec3>() / 8.0;
    let relative = corners.map(|corner| {
        let corner = corner - centre;
        [corner.x, corner.y, corner.z]
    });
    let [_, rest @ ..] = modes(&relative);
    rest
}

/// Shares of the volume by row sums, `integral of N_a dV / V`, exact with 2 x 2 x 2 Gauss points.
pub(super) fn node_shares(corners: &[Vec3; 8]) -> [f64; 8] {
    let position = position_modes(corners);
    let mut shares = [0.0; 8];
    let mut volume = 0.0;
    for point in GAUSS {
        let (_, weight) = cofactors(columns(&position, point, 1.0));
        volume += weight;
        for (share, signs) in shares.iter_mut().zip(CORNERS) {
            let shape: f64 = (0..3).map(|i| 0.5 * (1.0 + signs[i] * point[i])).product();
            *share += shape * weight;
        }
    }
    shares.map(|share| share / volume)
}

const G: f64 = 0.577_350_269_189_625_8;

/// The 2 x 2 x 2 Gauss points, in the order of the corners; each has weight one.
pub(super) const GAUSS: [[f64; 3]; 8] = {
    let mut points = CORNERS;
    let mut i = 0;
    while i < 8 {
        points[i] = [G * CORNERS[i][0], G * CORNERS[i][1], G * CORNERS[i][2]];
        i += 1;
    }
    points
};

#[inline(always)]
fn natural<L: Lane>([r, s, t]: [f64; 3], any: L) -> (L, L, L) {
    (any.constant(r), any.constant(s), any.constant(t))
}

/// Derivatives along r, s, t at a point, times 8, of a field with the modes `m` (without the constant one).
#[inline(always)]
pub(super) fn columns<L: Lane>(m: &[[L; 3]; 7], point: [f64; 3], one: L) -> [[L; 3]; 3] {
    let (r, s, t) = natural(point, one);
    let [m1, m2, m3, m4, m5, m6, m7] = *m;
    let mut columns = [m1, m2, m3];
    for i in 0..3 {
        columns[0][i] = t.mul_add(s.mul_add(m7[i], m5[i]), s.mul_add(m6[i], m1[i]));
        columns[1][i] = t.mul_add(r.mul_add(m7[i], m4[i]), r.mul_add(m6[i], m2[i]));
        columns[2][i] = s.mul_add(r.mul_add(m7[i], m4[i]), r.mul_add(m5[i], m3[i]));
    }
    columns
}

/// Adds the modal forces of forces `t` that are work-conjugate to [`columns`]: its transpose.
#[inline(always)]
pub(super) fn add_columns<L: Lane>(t3: [[L; 3]; 3], point: [f64; 3], f: &mut [[L; 3]; 8]) {
    let (r, s, t) = natural(point, t3[0][0]);
    for i in 0..3 {
        let [a, b, c] = [t3[0][i], t3[1][i], t3[2][i]];
        let (sa, rb) = (s * a, r * b);
        f[1][i] = f[1][i] + a;
        f[2][i] = f[2][i] + b;
        f[3][i] = f[3][i] + c;
        f[4][i] = f[4][i] + t.mul_add(b, s * c);
        f[5][i] = f[5][i] + t.mul_add(a, r * c);
        f[6][i] = f[6][i] + (sa + rb);
        f[7][i] = f[7][i] + t.mul_add(sa + rb, r * s * c);
    }
}
