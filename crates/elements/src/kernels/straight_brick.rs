//! Bricks with 2 x 2 x 2 integration points whose edges are parallel.

use powerhouse_model::{
    ElementKernel, ElementKind, Geometry, Hourglass, Lane, ModalKernel, Strain, Stress, Vec3,
};

use super::hex8_integrated::{Hex8BBar, Hex8Full};
use super::hexahedron::{self, GAUSS};
use super::parallelepiped::is_parallelepiped;
use super::positions;
use super::vectors::{
    Matrix, dot, outer_sum, product, scaled, scaled_sum, strain_of, stress_matrix, sum,
};
use crate::block::coordinate_rounding;

/// Natural coordinate of the integration points, and its square.
const G: f64 = GAUSS[6][0];
const SQUARE: f64 = 1.0 / 3.0;

/// [`Hex8Full`] and [`Hex8BBar`] for parallelepipeds, in particular for boxes along the axes.
///
/// The Jacobian is the same at all points, so that the gradient of a displacement with the modes `S_k` is a
/// polynomial with constant tensors,
/// ```text
/// grad u = sum_k d_k (x) g_k      d_1 = S1 + t S5 + s S6 + st S7, and so on,
///        = G_0 + r G_r + s G_s + t G_t + st G_st + tr G_tr + rs G_rs
/// ```
/// whose seven parts are orthogonal: with `r^2`, `s^2` and `t^2` equal to 1/3 at every point the elastic energy is
/// ```text
/// V (W(G_0) + (W(G_r) + W(G_s) + W(G_t)) / 3 + (W(G_st) + W(G_tr) + W(G_rs)) / 9)
/// ```
/// and no point has to be visited. In a box along the axes these are the eight symmetric modes, each of which
/// couples three numbers at most. With mean dilatation all parts but the first have the bulk modulus zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct StraightBrick {
    /// Whether the edges along r, s, t are along x, y, z.
    pub(super) along_axes: bool,
    /// Whether the dilatation is that of the mean ([`Hex8BBar`]).
    pub(super) mean_dilatation: bool,
}

/// Gradients `g_k` and volume: three and one numbers along the axes, otherwise nine and one.
struct Shape<L> {
    gradients: Matrix<L>,
    volume: L,
}

/// Values at the four points of a face of `a + x p + y q + xy r` with `x` and `y` of either sign; `x` changes first.
#[inline(always)]
fn on_face<L: Lane>(a: L, p: L, q: L, r: L) -> [L; 4] {
    let (less, more, low, high) = (a - p, a + p, q - r, q + r);
    [less - low, more - high, less + low, more + high]
}

/// The transpose of [`on_face`].
#[inline(always)]
fn of_face<L: Lane>([a, b, c, d]: [L; 4]) -> [L; 4] {
    let (low, high) = (a + b, c + d);
    let (rise_low, rise_high) = (b - a, d - c);
    [
        low + high,
        rise_low + rise_high,
        high - low,
        rise_high - rise_low,
    ]
}

/// Modes of the derivatives along r, s, t: those of `1`, of the first and the second other coordinate, and of their
/// product.
const MODES_OF: [[usize; 4]; 3] = [[1, 6, 5, 7], [2, 6, 4, 7], [3, 5, 4, 7]];

/// Index on the face of [`on_face`], for each derivative, of each point.
const ON_FACE: [[usize; 8]; 3] = {
    let mut indices = [[0; 8]; 3];
    let mut p = 0;
    while p < 8 {
        let r = (GAUSS[p][0] > 0.0) as usize;
        let s = (GAUSS[p][1] > 0.0) as usize;
        let t = (GAUSS[p][2] > 0.0) as usize;
        indices[0][p] = s + 2 * t;
        indices[1][p] = r + 2 * t;
        indices[2][p] = r + 2 * s;
        p += 1;
    }
    indices
};

impl StraightBrick {
    #[inline(always)]
    fn shape<L: Lane>(&self, geometry: &Geometry<L>) -> Shape<L> {
        if self.along_axes {
            let zero = geometry.constant(0.0);
            let [a, b, c] = geometry.vector(0);
            Shape {
                gradients: [[a, zero, zero], [zero, b, zero], [zero, zero, c]],
                volume: geometry.get(3),
            }
        } else {
            Shape {
                gradients: [geometry.vector(0), geometry.vector(3), geometry.vector(6)],
                volume: geometry.get(9),
            }
        }
    }
}

/// Component `c` of the derivatives along r, s, t at the points of a face, each times a factor.
#[inline(always)]
fn derivatives<L: Lane>(modes: &[[L; 3]; 8], factors: [L; 3]) -> [[[L; 4]; 3]; 3] {
    let zero = factors[0].constant(0.0);
    let mut derivatives = [[[zero; 4]; 3]; 3];
    for k in 0..3 {
        let [one, first, second, both] = MODES_OF[k];
        let linear = factors[k] * factors[k].constant(G);
        let square = factors[k] * factors[k].constant(SQUARE);
        for c in 0..3 {
            derivatives[k][c] = on_face(
                modes[one][c] * factors[k],
                modes[first][c] * linear,
                modes[second][c] * linear,
                modes[both][c] * square,
            );
        }
    }
    derivatives
}

/// Modal forces of forces that are work-conjugate to [`derivatives`]: its transpose.
#[inline(always)]
fn forces_of<L: Lane>(conjugate: &[[[L; 4]; 3]; 3], factors: [L; 3]) -> [[L; 3]; 8] {
    let zero = factors[0].constant(0.0);
    let mut forces = [[zero; 3]; 8];
    for k in 0..3 {
        let linear = factors[k] * factors[k].constant(G);
        let square = factors[k] * factors[k].constant(SQUARE);
        for c in 0..3 {
            let parts = of_face(conjugate[k][c]);
            let weights = [factors[k], linear, linear, square];
            for m in 0..4 {
                let force = &mut forces[MODES_OF[k][m]][c];
                *force = parts[m].mul_add(weights[m], *force);
            }
        }
    }
    forces
}

/// Adds a third of the mean of all traces and takes a third of the own one from the normal components.
#[inline(always)]
fn average_traces<L: Lane>(tensors: &mut [[L; 6]; 8]) {
    let third = tensors[0][0].constant(1.0 / 3.0);
    let mut thirds = [third; 8];
    for p in 0..8 {
        thirds[p] = third * (tensors[p][0] + tensors[p][1] + tensors[p][2]);
    }
    let mut mean = thirds[0];
    for p in 1..8 {
        mean = mean + thirds[p];
    }
    mean = mean * mean.constant(0.125);
    for p in 0..8 {
        let shift = mean - thirds[p];
        for i in 0..3 {
            tensors[p][i] = tensors[p][i] + shift;
        }
    }
}

/// Stress of a displacement gradient in a medium with Lame's constants `lambda` and `shear`.
#[inline(always)]
fn elastic_stress<L: Lane>(lambda: L, shear: L, gradient: &Matrix<L>) -> Matrix<L> {
    stress_matrix(&Stress::elastic(lambda, shear, &strain_of(gradient)))
}

/// Elastic forces on the modes of a parallelepiped; `higher` is Lame's first constant of the parts of the gradient that
/// vary.
#[inline(always)]
fn skewed_forces<L: Lane>(
    shape: &Shape<L>,
    [lambda, higher, shear]: [L; 3],
    modes: &[[L; 3]; 8],
) -> [[L; 3]; 8] {
    let [g1, g2, g3] = shape.gradients;
    let [_, s1, s2, s3, s4, s5, s6, s7] = *modes;
    let v = shape.volume;
    let third = v * v.constant(1.0 / 3.0);
    let ninth = v * v.constant(1.0 / 9.0);
    let whole = outer_sum([s1, s2, s3], shape.gradients);
    let whole = elastic_stress(lambda * v, shear * v, &whole);
    let (linear, of_shear) = (higher * third, shear * third);
    let r = elastic_stress(linear, of_shear, &outer_sum([s6, s5], [g2, g3]));
    let s = elastic_stress(linear, of_shear, &outer_sum([s6, s4], [g1, g3]));
    let t = elastic_stress(linear, of_shear, &outer_sum([s5, s4], [g1, g2]));
    let both = (higher + shear) * ninth;
    let of_shear = shear * ninth;
    let squares = of_shear * (dot(g1, g1) + dot(g2, g2) + dot(g3, g3));
    let mut last = scaled(s7, squares);
    for g in [g1, g2, g3] {
        last = scaled_sum(g, both * dot(s7, g), last);
    }
    [
        [v.constant(0.0); 3],
        product(&whole, g1),
        product(&whole, g2),
        product(&whole, g3),
        sum(product(&s, g3), product(&t, g2)),
        sum(product(&r, g3), product(&t, g1)),
        sum(product(&r, g2), product(&s, g1)),
        last,
    ]
}

/// The same of a box along the axes, mode by mode.
#[inline(always)]
fn aligned_forces<L: Lane>(
    [a, b, c, volume]: [L; 4],
    [lambda, higher, shear]: [L; 3],
    modes: &[[L; 3]; 8],
) -> [[L; 3]; 8] {
    let [_, s1, s2, s3, s4, s5, s6, s7] = *modes;
    let g = [a, b, c];
    let third = volume.constant(1.0 / 3.0);
    let mut forces = [[volume.constant(0.0); 3]; 8];
    // The mean gradient.
    let (l, m) = (lambda * volume, shear * volume);
    let normal = [s1[0] * a, s2[1] * b, s3[2] * c];
    let pressure = l * (normal[0] + normal[1] + normal[2]);
    let twice = m + m;
    for i in 0..3 {
        forces[1 + i][i] = twice.mul_add(normal[i], pressure) * g[i];
    }
    let linear = [s1, s2, s3];
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let shearing = m * linear[i][j].mul_add(g[i], linear[j][i] * g[j]);
        forces[1 + i][j] = shearing * g[i];
        forces[1 + j][i] = shearing * g[j];
    }
    // Parts along r, s, t: two normal strains each, with one shear of either, and one shear in common. Mode `4 + i`
    // is the product of the coordinates `j` and `k`.
    let bent = [s4, s5, s6];
    let m = m * third;
    let (l, squares) = (higher * volume * third, [m * a * a, m * b * b, m * c * c]);
    let p = l + (m + m);
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        // Along coordinate `i` the strain `jj` grows with component `j` of mode `k`, `kk` with component `k` of mode `j`.
        let (first, second) = (bent[k][j] * g[j], bent[j][k] * g[k]);
        let along_j = p.mul_add(first, l * second) * g[j];
        let along_k = p.mul_add(second, l * first) * g[k];
        forces[4 + k][j] = squares[i].mul_add(bent[k][j], along_j);
        forces[4 + j][k] = squares[i].mul_add(bent[j][k], along_k);
    }
    // Shear `jk` along coordinate `i`.
    let twists = [
        m * s6[2].mul_add(b, s5[1] * c),
        m * s4[0].mul_add(c, s6[2] * a),
        m * s5[1].mul_add(a, s4[0] * b),
    ];
    forces[4][0] = twists[1].mul_add(c, twists[2] * b);
    forces[5][1] = twists[2].mul_add(a, twists[0] * c);
    forces[6][2] = twists[0].mul_add(b, twists[1] * a);
    // Products of two coordinates.
    let all = squares[0] + squares[1] + squares[2];
    let more = l + m;
    for i in 0..3 {
        let stiffness = more.mul_add(g[i] * g[i], all) * third;
        forces[7][i] = stiffness * s7[i];
    }
    forces
}

impl ElementKernel<8, 8> for StraightBrick {
    fn name(&self) -> &'static str {
        if self.mean_dilatation {
            Hex8BBar.name()
        } else {
            Hex8Full.name()
        }
    }
    fn kind(&self) -> ElementKind {
        ElementKind::Hex8
    }
    #[inline(always)]
    fn geometry_len(&self) -> usize {
        if self.along_axes { 4 } else { 10 }
    }
    fn geometry(&self, corners: &[Vec3; 8], out: &mut [f64]) {
        let x = hexahedron::position_modes(corners).map(|mode| Vec3::from(mode) / 8.0);
        let g = [x[1].cross(&x[2]), x[2].cross(&x[0]), x[0].cross(&x[1])];
        let volume = 8.0 * x[0].dot(&g[0]);
        for k in 0..3 {
            let gradient = g[k] / volume;
            if self.along_axes {
                out[k] = gradient[k];
            } else {
                out[3 * k..3 * k + 3].copy_from_slice(gradient.as_slice());
            }
        }
        out[self.geometry_len() - 1] = volume;
    }
    fn point_positions(&self, corners: &[Vec3; 8]) -> [Vec3; 8] {
        positions(ElementKind::Hex8, corners, GAUSS)
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 8] {
        let volume = self.shape(&geometry).volume;
        [volume * volume.constant(0.125); 8]
    }
    fn node_shares(&self, _corners: &[Vec3; 8]) -> [f64; 8] {
        [0.125; 8]
    }
    #[inline(always)]
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 8]) -> [Strain<L>; 8] {
        let one = geometry.constant(1.0);
        let mut strains = [[one; 6]; 8];
        let gradients = self.shape(&geometry).gradients;
        if self.along_axes {
            let factors = [gradients[0][0], gradients[1][1], gradients[2][2]];
            let d = derivatives(modes, factors);
            for p in 0..8 {
                let [r, s, t] = [ON_FACE[0][p], ON_FACE[1][p], ON_FACE[2][p]];
                strains[p] = [
                    d[0][0][r],
                    d[1][1][s],
                    d[2][2][t],
                    d[0][1][r] + d[1][0][s],
                    d[1][2][s] + d[2][1][t],
                    d[2][0][t] + d[0][2][r],
                ];
            }
        } else {
            let d = derivatives(modes, [one; 3]);
            for p in 0..8 {
                let mut columns = [[one; 3]; 3];
                for k in 0..3 {
                    for c in 0..3 {
                        columns[k][c] = d[k][c][ON_FACE[k][p]];
                    }
                }
                strains[p] = strain_of(&outer_sum(columns, gradients)).0;
            }
        }
        if self.mean_dilatation {
            average_traces(&mut strains);
        }
        let mut at_points = [Strain([one; 6]); 8];
        for p in 0..8 {
            at_points[p] = Strain(strains[p]);
        }
        at_points
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 8],
        _hourglass: &Hourglass<L>,
        _modes: &[[L; 3]; 8],
    ) -> [[L; 3]; 8] {
        let zero = geometry.constant(0.0);
        let Shape { gradients, volume } = self.shape(&geometry);
        let weight = volume * volume.constant(0.125);
        let mut tensors = [[zero; 6]; 8];
        for p in 0..8 {
            tensors[p] = stresses[p].0;
        }
        if self.mean_dilatation {
            average_traces(&mut tensors);
        }
        let mut conjugate = [[[zero; 4]; 3]; 3];
        for p in 0..8 {
            let stress = stress_matrix(&Stress(tensors[p]));
            for k in 0..3 {
                let traction = if self.along_axes {
                    stress[k]
                } else {
                    product(&stress, gradients[k])
                };
                for c in 0..3 {
                    let sum = &mut conjugate[k][c][ON_FACE[k][p]];
                    *sum = *sum + traction[c];
                }
            }
        }
        let mut factors = [weight; 3];
        if self.along_axes {
            for k in 0..3 {
                factors[k] = weight * gradients[k][k];
            }
        }
        forces_of(&conjugate, factors)
    }
    #[inline(always)]
    fn modal(&self) -> Option<&impl ModalKernel<8, 8>> {
        Some(self)
    }
}

impl ModalKernel<8, 8> for StraightBrick {
    #[inline(always)]
    fn modes<L: Lane>(&self, nodal: &[[L; 3]; 8]) -> [[L; 3]; 8] {
        hexahedron::modes(nodal)
    }
    #[inline(always)]
    fn nodal_forces<L: Lane>(&self, modal: &[[L; 3]; 8]) -> [[L; 3]; 8] {
        hexahedron::nodal_forces(modal)
    }
    #[inline(always)]
    fn elastic_forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        [lambda, shear]: [L; 2],
        modes: &[[L; 3]; 8],
    ) -> Option<[[L; 3]; 8]> {
        let higher = if self.mean_dilatation {
            shear * shear.constant(-2.0 / 3.0)
        } else {
            lambda
        };
        let moduli = [lambda, higher, shear];
        Some(if self.along_axes {
            let [a, b, c] = geometry.vector(0);
            aligned_forces([a, b, c, geometry.get(3)], moduli, modes)
        } else {
            skewed_forces(&self.shape(&geometry), moduli, modes)
        })
    }
}

/// Whether a brick is a box whose edges along r, s, t are along x, y, z, within the rounding of the coordinates.
pub(super) fn is_along_axes(corners: &[Vec3; 8]) -> bool {
    let tolerance = 8.0 * coordinate_rounding(corners);
    let [r, s, t, ..] = hexahedron::position_modes(corners);
    let oblique = [r[1], r[2], s[2], s[0], t[0], t[1]];
    is_parallelepiped(corners) && oblique.iter().all(|x| x.abs() <= tolerance)
}
