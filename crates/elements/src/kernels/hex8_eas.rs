//! Eight-node brick with eight integration points and the bending strains of its material.

use powerhouse_model::{
    ElasticMedium, ElementKernel, ElementKind, Geometry, HistoryKernel, Hourglass, Lane,
    ModalKernel, OwnStep, Scalar, Strain, Stress, Vec3,
};

use super::hexahedron::{self, GAUSS, HexahedronModes};
use super::mean_gradient::{self, NUMBERS, SHRINK, Shape, VOLUME};
use super::natural_frame::{NaturalFrame, PLANES, linear};
use super::positions;
use super::vectors::{cross, dot, product, scaled, scaled_sum, strain_of, stress_matrix};

/// Natural coordinate of the integration points.
const G: f64 = GAUSS[6][0];
/// Share of the stresses across a plate below which their signed sum is zero: the plates of an elastic brick bear none.
const ROUNDING: f64 = 1e-10;
/// The same in rounding errors of the number format.
const MOST_ROUNDED: f64 = 64.0;
/// Least derivative of that sum by the strain across, over that of the undamaged medium, by which static states approach zero.
const LEAST_SLOPE: f64 = 0.01;

/// Eight-node brick with 2 x 2 x 2 integration points whose strains vary as those of
/// [`Hex8Natural`](super::Hex8Natural), to which it is equal while the material is elastic.
///
/// With the curvatures `k` of the three plates of the natural frame and `a^i, a^j` dual to `g_i, g_j` in the plane of a
/// plate with the normal `n_k`, the strain at a point with natural coordinates `xi = +-1/sqrt 3` is
/// ```text
/// e = mean + sum_k xi_k (k_ii a^i a^i + k_jj a^j a^j + k_ij (a^i a^j + a^j a^i) + alpha_k n_k n_k)
///   + sum_i xi_j xi_k e_i (t_i t_i - nu (I - t_i t_i)),   e_i = g_i.q_[123] / (8 |g_i|^2),   t_i = g_i / |g_i|
/// alpha_k = - lambda / (lambda + 2 G) A:k + a_k
/// ```
/// and every point has an eighth of the volume, so that distorted meshes pass the patch test. The three numbers `a_k` are
/// the element's own history: once in every step they follow the stress across the plates, which they bring to zero,
/// ```text
/// a_k <- a_k - R_k / ((lambda + 2 G) V / 3),   R_k = sum_p (V / 8) xi_k n_k.sigma_p n_k
/// ```
/// so that plastic flow and cracks in the layers of points are not held across. One layer of bricks forms a hinge near the
/// exact load; bricks of one point hold nearly four times of it.
///
/// In the manner of J. C. Simo and M. S. Rifai, A class of mixed assumed strain methods and the method of incompatible
/// modes, Int. J. Numer. Meth. Engng 29 (1990) 1595-1638, with the strains of M. A. Puso, Int. J. Numer. Meth. Engng 49
/// (2000) 1029-1064.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hex8Eas {
    poisson: f64,
    constrained: f64,
}

impl Hex8Eas {
    /// Name of the kernel.
    pub(super) const NAME: &'static str = "hex8-eas";
    /// Number of history variables of an element: the strains `a_k` that a step used, and those of the next one.
    pub(super) const HISTORY: usize = 6;

    /// The brick for a material with an undamaged medium.
    pub fn new(medium: &ElasticMedium) -> Self {
        Self {
            poisson: medium.poisson,
            constrained: medium.constrained(),
        }
    }
    /// `lambda / (lambda + 2 G)`.
    fn contraction(&self) -> f64 {
        self.poisson / (1.0 - self.poisson)
    }
    /// Derivative of the signed sum of stresses across a plate by its own strain, of the undamaged medium (Pa).
    fn slope(&self) -> f64 {
        8.0 * G * self.constrained
    }
    /// Sums of the stresses across each plate with the signs of its coordinate; zero within their rounding.
    #[inline(always)]
    fn across<L: Lane>(&self, geometry: &Geometry<L>, stresses: &[Stress<L>; 8]) -> [L; 3] {
        let frame = NaturalFrame::new(linear(geometry));
        let zero = geometry.constant(0.0);
        let rounding = zero.constant(ROUNDING.max(MOST_ROUNDED * L::Scalar::EPSILON));
        let sums = Modes::of_points(stresses);
        let mut sums_across = [zero; 3];
        for k in 0..3 {
            let plate = Plate::new(&frame, k);
            let across = plate.across(&sums.linear[k]);
            let mut size = zero;
            for stress in stresses {
                size = size + plate.across(&stress.0).abs();
            }
            sums_across[k] = across.select((size * rounding).less(across.abs()), zero);
        }
        sums_across
    }
}

/// Dual vectors of a plate and the square of its normal.
struct Plate<L> {
    dual: [[L; 3]; 2],
    /// `n n`, components xx yy zz xy yz zx.
    normal: [L; 6],
}

impl<L: Lane> Plate<L> {
    #[inline(always)]
    fn new(frame: &NaturalFrame<L>, k: usize) -> Self {
        let (i, j) = PLANES[k];
        let [ii, jj, ij] = frame.planes[k];
        let (a, b) = (frame.x[i], frame.x[j]);
        let n = cross(a, b);
        let inverse = n[0].constant(1.0) / dot(n, n);
        let m = scaled(n, inverse);
        Self {
            dual: [
                scaled_sum(a, ii, scaled(b, ij)),
                scaled_sum(b, jj, scaled(a, ij)),
            ],
            normal: [
                n[0] * m[0],
                n[1] * m[1],
                n[2] * m[2],
                n[0] * m[1],
                n[1] * m[2],
                n[2] * m[0],
            ],
        }
    }

    /// Adds the strain of curvatures `k_ii, k_jj, k_ij`, which contracts the normal by a share, to a strain with
    /// engineering shears.
    #[inline(always)]
    fn add_strain(&self, [ii, jj, ij]: [L; 3], trace: L, strain: &mut [L; 6]) {
        let [a, b] = self.dual;
        let first = scaled_sum(a, ii, scaled(b, ij));
        let second = scaled_sum(a, ij, scaled(b, jj));
        for c in 0..6 {
            let (m, n) = COMPONENTS[c];
            let plane = a[m].mul_add(first[n], b[m] * second[n]);
            let part = trace.mul_add(self.normal[c], plane);
            strain[c] = strain[c] + if c < 3 { part } else { part + part };
        }
    }

    /// Stress across the plate.
    #[inline(always)]
    fn across(&self, stress: &[L; 6]) -> L {
        let mut sum = stress[0] * self.normal[0];
        for c in 1..6 {
            let part = stress[c] * self.normal[c];
            sum = sum + if c < 3 { part } else { part + part };
        }
        sum
    }
}

/// Row and column of the components xx yy zz xy yz zx.
const COMPONENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// A field of stress or strain that is `m + r E_r + s E_s + t E_t + st H_r + tr H_s + rs H_t` in signs of the points.
struct Modes<L> {
    mean: [L; 6],
    linear: [[L; 6]; 3],
    products: [[L; 6]; 3],
}

impl<L: Lane> Modes<L> {
    /// Values at the points.
    #[inline(always)]
    fn at_points(&self) -> [[L; 6]; 8] {
        let mut points = [self.mean; 8];
        for c in 0..6 {
            let [r, s, t] = [self.linear[0][c], self.linear[1][c], self.linear[2][c]];
            let [st, tr, rs] = [
                self.products[0][c],
                self.products[1][c],
                self.products[2][c],
            ];
            for face in 0..2 {
                let low = face == 0;
                let mean = if low {
                    self.mean[c] - t
                } else {
                    self.mean[c] + t
                };
                let along_r = if low { r - tr } else { r + tr };
                let along_s = if low { s - st } else { s + st };
                let (less, more) = (mean - along_s, mean + along_s);
                let (back, ahead) = (along_r - rs, along_r + rs);
                points[4 * face][c] = less - back;
                points[4 * face + 1][c] = less + back;
                points[4 * face + 2][c] = more + ahead;
                points[4 * face + 3][c] = more - ahead;
            }
        }
        points
    }
    /// Sums of values at the points with the signs of the modes: the transpose of [`at_points`](Self::at_points).
    #[inline(always)]
    fn of_points(points: &[Stress<L>; 8]) -> Self {
        let zero = points[0].0[0].constant(0.0);
        let mut sums = Self {
            mean: [zero; 6],
            linear: [[zero; 6]; 3],
            products: [[zero; 6]; 3],
        };
        for c in 0..6 {
            let mut faces = [[zero; 4]; 2];
            for face in 0..2 {
                let [a, b, d, e] = [
                    points[4 * face].0[c],
                    points[4 * face + 1].0[c],
                    points[4 * face + 2].0[c],
                    points[4 * face + 3].0[c],
                ];
                let (low, high) = (a + b, d + e);
                let (low_r, high_r) = (b - a, d - e);
                faces[face] = [low + high, low_r + high_r, high - low, high_r - low_r];
            }
            let [low, high] = faces;
            sums.mean[c] = low[0] + high[0];
            sums.linear[0][c] = low[1] + high[1];
            sums.linear[1][c] = low[2] + high[2];
            sums.linear[2][c] = high[0] - low[0];
            sums.products[0][c] = high[2] - low[2];
            sums.products[1][c] = high[1] - low[1];
            sums.products[2][c] = low[3] + high[3];
        }
        sums
    }
}

impl ElementKernel<8, 8> for Hex8Eas {
    fn name(&self) -> &'static str {
        Self::NAME
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
    fn point_positions(&self, corners: &[Vec3; 8]) -> [Vec3; 8] {
        positions(ElementKind::Hex8, corners, GAUSS)
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 8] {
        [geometry.get(VOLUME) * geometry.constant(0.125); 8]
    }
    fn node_shares(&self, corners: &[Vec3; 8]) -> [f64; 8] {
        hexahedron::node_shares(corners)
    }
    #[inline(always)]
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 8]) -> [Strain<L>; 8] {
        let shape = Shape::new(&geometry);
        let gradient = shape.mean_gradient(modes);
        let q = shape.hourglass_strains(&gradient, modes);
        let frame = NaturalFrame::new(linear(&geometry));
        let zero = geometry.constant(0.0);
        let poisson = zero.constant(self.poisson);
        let contraction = zero.constant(-self.contraction());
        let mut field = Modes {
            mean: strain_of(&gradient).0,
            linear: [[zero; 6]; 3],
            products: [[zero; 6]; 3],
        };
        let shrink = geometry.get(SHRINK);
        let (first, second) = (shrink * zero.constant(G), shrink * zero.constant(1.0 / 3.0));
        let curvatures = frame.curvatures(&q);
        for k in 0..3 {
            let curvatures = scaled(curvatures[k], first);
            let trace = frame.trace(curvatures, k) * contraction;
            Plate::new(&frame, k).add_strain(curvatures, trace, &mut field.linear[k]);
            let x = frame.x[k];
            let e = second * frame.inverse[k] * dot(x, q[3]);
            let less = e * poisson;
            let t = scaled(x, (e + less) * frame.inverse[k]);
            for c in 0..6 {
                let (m, n) = COMPONENTS[c];
                let part = x[m] * t[n];
                field.products[k][c] = if c < 3 { part - less } else { part + part };
            }
        }
        let points = field.at_points();
        let mut strains = [Strain([zero; 6]); 8];
        for p in 0..8 {
            strains[p] = Strain(points[p]);
        }
        strains
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 8],
        _hourglass: &Hourglass<L>,
        _modes: &[[L; 3]; 8],
    ) -> [[L; 3]; 8] {
        let frame = NaturalFrame::new(linear(&geometry));
        let sums = Modes::of_points(stresses);
        let zero = geometry.constant(0.0);
        let volume = geometry.get(VOLUME);
        let shrink = geometry.get(SHRINK) * volume;
        let first = shrink * zero.constant(0.125 * G);
        let second = shrink * zero.constant(0.125 / 3.0);
        let poisson = zero.constant(self.poisson);
        let contraction = zero.constant(-self.contraction());
        let mut plates = frame.planes;
        let mut last = [zero; 3];
        for k in 0..3 {
            let plate = Plate::new(&frame, k);
            let stress = stress_matrix(&Stress(sums.linear[k]));
            let [a, b] = plate.dual;
            let (of_a, of_b) = (product(&stress, a), product(&stress, b));
            let across = plate.across(&sums.linear[k]) * contraction;
            let [ii, jj, ij] = frame.planes[k];
            plates[k] = [
                across.mul_add(ii, dot(a, of_a)) * first,
                across.mul_add(jj, dot(b, of_b)) * first,
                across.mul_add(ij, dot(a, of_b)) * first,
            ];
            let x = frame.x[k];
            let of_x = product(&stress_matrix(&Stress(sums.products[k])), x);
            let [xx, yy, zz, ..] = sums.products[k];
            let along = dot(x, of_x) * frame.inverse[k];
            let less = poisson * (xx + yy + zz);
            let force = along.mul_add(poisson, along) - less;
            last = scaled_sum(x, force * second * frame.inverse[k], last);
        }
        let mut resisted = frame.distributed(&plates);
        resisted[3] = last;
        let mut mean = sums.mean;
        for c in 0..6 {
            mean[c] = mean[c] * zero.constant(0.125);
        }
        Shape::new(&geometry).forces(&geometry, &Stress(mean), &resisted)
    }
    #[inline(always)]
    fn modal(&self) -> Option<&impl ModalKernel<8, 8>> {
        Some(&HexahedronModes)
    }
    #[inline(always)]
    fn history(&self) -> Option<&impl HistoryKernel<8, 8>> {
        Some(self)
    }
}

impl HistoryKernel<8, 8> for Hex8Eas {
    #[inline(always)]
    fn own_history(&self) -> usize {
        Self::HISTORY
    }
    #[inline(always)]
    fn own_history_after<L: Lane>(
        &self,
        geometry: Geometry<L>,
        step: &OwnStep<L, 8, 8>,
        new: &mut [L],
    ) {
        let zero = geometry.constant(0.0);
        let rate = zero.constant(-1.0 / self.slope());
        let across = self.across(&geometry, step.stresses);
        for k in 0..3 {
            new[k] = step.history[k];
            new[3 + k] = across[k].mul_add(rate, step.history[k]);
        }
    }
    #[inline(always)]
    fn own_at_start<L: Lane>(&self, history: &mut [L]) {
        for k in 0..3 {
            history[k] = history[3 + k];
        }
    }
    fn own_strains(&self) -> usize {
        3
    }
    #[inline(always)]
    fn add_own_strains<L: Lane>(
        &self,
        geometry: Geometry<L>,
        history: &[L],
        strains: &mut [Strain<L>; 8],
    ) {
        let frame = NaturalFrame::new(linear(&geometry));
        let zero = geometry.constant(0.0);
        let g = zero.constant(G);
        let mut field = Modes {
            mean: [zero; 6],
            linear: [[zero; 6]; 3],
            products: [[zero; 6]; 3],
        };
        for k in 0..3 {
            let plate = Plate::new(&frame, k);
            plate.add_strain([zero; 3], history[k] * g, &mut field.linear[k]);
        }
        let points = field.at_points();
        for p in 0..8 {
            for c in 0..6 {
                strains[p].0[c] = strains[p].0[c] + points[p][c];
            }
        }
    }
    #[inline(always)]
    fn relax_own<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 8],
        history: &mut [L],
        before: &mut [[L; 2]],
    ) -> bool {
        let zero = geometry.constant(0.0);
        let elastic = zero.constant(self.slope());
        let least = zero.constant(LEAST_SLOPE * self.slope());
        let across = self.across(&geometry, stresses);
        let mut any = zero;
        for k in 0..3 {
            let [at, value] = before[k];
            let moved = history[k] - at;
            let known = zero.less(moved.abs());
            let slope = (across[k] - value) / moved.select(known, zero.constant(1.0));
            let slope = slope.max(least).min(elastic).select(known, elastic);
            before[k] = [history[k], across[k]];
            history[k] = history[k] - across[k] / slope;
            any = any + across[k].abs();
        }
        zero.any(zero.less(any))
    }
}
