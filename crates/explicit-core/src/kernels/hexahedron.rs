//! What the hexahedra share: the modes of eight corners, and the Jacobian in terms of them.

use powerhouse_model::{Lane, Vec3};

use super::vectors::{cofactors, difference, sum};

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

/// Numbers of one element: seven modes of the position, the constant one left out.
pub(super) const MODE_NUMBERS: usize = 21;

/// Sums of eight corner values with the signs of `1, r, s, t, st, tr, rs, rst`.
///
/// With `S` the result, the trilinear interpolation is
/// `(S0 + r S1 + s S2 + t S3 + st S4 + tr S5 + rs S6 + rst S7) / 8`.
#[inline(always)]
pub(super) fn modes<L: Lane>(v: &[[L; 3]; 8]) -> [[L; 3]; 8] {
    // Edges along r, each as sum and difference; then faces along s; then along t.
    let sums = [
        sum(v[0], v[1]),
        sum(v[3], v[2]),
        sum(v[4], v[5]),
        sum(v[7], v[6]),
    ];
    let differences = [
        difference(v[1], v[0]),
        difference(v[2], v[3]),
        difference(v[5], v[4]),
        difference(v[6], v[7]),
    ];
    let (one, s) = ends(&sums);
    let (r, rs) = ends(&differences);
    [
        sum(one[0], one[1]),
        sum(r[0], r[1]),
        sum(s[0], s[1]),
        difference(one[1], one[0]),
        difference(s[1], s[0]),
        difference(r[1], r[0]),
        sum(rs[0], rs[1]),
        difference(rs[1], rs[0]),
    ]
}

/// Sums and differences along s, on the bottom and on the top.
#[inline(always)]
fn ends<L: Lane>(v: &[[L; 3]; 4]) -> ([[L; 3]; 2], [[L; 3]; 2]) {
    (
        [sum(v[0], v[1]), sum(v[2], v[3])],
        [difference(v[1], v[0]), difference(v[3], v[2])],
    )
}

/// The transpose of [`modes`], for modal forces without a constant part.
#[inline(always)]
pub(super) fn nodal_forces<L: Lane>(f: &[[L; 3]; 8]) -> [[L; 3]; 8] {
    let minus = [-f[3][0], -f[3][1], -f[3][2]];
    let (one, r) = ([minus, f[3]], [difference(f[1], f[5]), sum(f[1], f[5])]);
    let (s, rs) = (
        [difference(f[2], f[4]), sum(f[2], f[4])],
        [difference(f[6], f[7]), sum(f[6], f[7])],
    );
    let [v0, v1, v2, v3] = face(one[0], r[0], s[0], rs[0]);
    let [v4, v5, v6, v7] = face(one[1], r[1], s[1], rs[1]);
    [v0, v1, v2, v3, v4, v5, v6, v7]
}

#[inline(always)]
fn face<L: Lane>(one: [L; 3], r: [L; 3], s: [L; 3], rs: [L; 3]) -> [[L; 3]; 4] {
    let (low, high) = (difference(one, s), sum(one, s));
    let (low_r, high_r) = (difference(r, rs), sum(r, rs));
    [
        difference(low, low_r),
        sum(low, low_r),
        sum(high, high_r),
        difference(high, high_r),
    ]
}

/// The modes of the corner positions, the constant one left out, side by side.
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

/// Derivatives along r, s, t at a point, times 8, of what has the modes `m` (constant left out).
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

/// Adds the forces `t` that work on [`columns`] to modal forces: its transpose.
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
