//! Six-node wedge.

use powerhouse_model::{
    ElementKernel, ElementKind, Geometry, Hourglass, Lane, ModalKernel, Strain, Stress, Vec3,
};

use super::positions;
use super::vectors::{
    Matrix, cofactors, difference, outer_sum, product, scaled, scaled_sum, strain_of,
    stress_matrix, sum,
};

/// Geometry numbers of one element: five modes of the position, without the constant one.
const MODE_NUMBERS: usize = 15;
/// Factor of the determinant of the Jacobian, whose columns are computed times 2, and weight 1/6 of a point.
const SCALE: f64 = 1.0 / 48.0;

const G: f64 = 0.577_350_269_189_625_8;
const NEAR: f64 = 1.0 / 6.0;
const FAR: f64 = 2.0 / 3.0;

/// Integration points: triangle coordinates r, s in `r, s >= 0, r + s <= 1` and height t in `[-1, 1]`.
const POINTS: [[f64; 3]; 6] = [
    [NEAR, NEAR, -G],
    [FAR, NEAR, -G],
    [NEAR, FAR, -G],
    [NEAR, NEAR, G],
    [FAR, NEAR, G],
    [NEAR, FAR, G],
];

/// Six-node wedge (triangular prism) with three integration points in the triangle times two along its height.
///
/// Its modes are those of `1, r, s, t, rt, st` with the triangle coordinates `r, s` of the corners 1 and 2 and
/// the height `t`; it has no hourglass modes. It is too stiff in bending and as the material becomes
/// incompressible.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wedge6;

/// Twice the coefficients of `1, r, s, t, rt, st` in the interpolation of six corner values.
#[inline(always)]
fn modes<L: Lane>(v: &[[L; 3]; 6]) -> [[L; 3]; 6] {
    let sums = [sum(v[0], v[3]), sum(v[1], v[4]), sum(v[2], v[5])];
    let heights = [
        difference(v[3], v[0]),
        difference(v[4], v[1]),
        difference(v[5], v[2]),
    ];
    [
        sums[0],
        difference(sums[1], sums[0]),
        difference(sums[2], sums[0]),
        heights[0],
        difference(heights[1], heights[0]),
        difference(heights[2], heights[0]),
    ]
}

/// Derivatives along r, s, t at a point, times 2, of a field with the modes `m` (without the constant one).
#[inline(always)]
fn columns<L: Lane>(m: &[[L; 3]; 5], point: [f64; 3]) -> [[L; 3]; 3] {
    let any = m[0][0];
    let (r, s, t) = natural(point, any);
    [
        scaled_sum(m[3], t, m[0]),
        scaled_sum(m[4], t, m[1]),
        scaled_sum(m[4], s, scaled_sum(m[3], r, m[2])),
    ]
}

#[inline(always)]
fn natural<L: Lane>([r, s, t]: [f64; 3], any: L) -> (L, L, L) {
    (any.constant(r), any.constant(s), any.constant(t))
}

#[inline(always)]
fn jacobian<L: Lane>(position: &[[L; 3]; 5], point: [f64; 3]) -> (Matrix<L>, L) {
    cofactors(columns(position, point))
}

#[inline(always)]
fn position_modes<L: Lane>(geometry: &Geometry<L>) -> [[L; 3]; 5] {
    [
        geometry.vector(0),
        geometry.vector(3),
        geometry.vector(6),
        geometry.vector(9),
        geometry.vector(12),
    ]
}

/// Modes of the corner positions, without the constant one.
fn modes_of_corners(corners: &[Vec3; 6]) -> [[f64; 3]; 5] {
    let relative = corners.map(|corner| {
        let corner = corner - corners[0];
        [corner.x, corner.y, corner.z]
    });
    let [_, rest @ ..] = modes(&relative);
    rest
}

impl ElementKernel<6, 6> for Wedge6 {
    fn name(&self) -> &'static str {
        "wedge6"
    }
    fn kind(&self) -> ElementKind {
        ElementKind::Wedge6
    }
    #[inline(always)]
    fn geometry_len(&self) -> usize {
        MODE_NUMBERS
    }
    fn geometry(&self, corners: &[Vec3; 6], out: &mut [f64]) {
        out.copy_from_slice(modes_of_corners(corners).as_flattened());
    }
    fn point_positions(&self, corners: &[Vec3; 6]) -> [Vec3; 6] {
        positions(ElementKind::Wedge6, corners, POINTS)
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 6] {
        let position = position_modes(&geometry);
        let scale = geometry.constant(SCALE);
        let mut volumes = [scale; 6];
        for p in 0..6 {
            volumes[p] = scale * jacobian(&position, POINTS[p]).1;
        }
        volumes
    }
    /// By row sums, `integral of N_a dV / V`, exact with these points.
    fn node_shares(&self, corners: &[Vec3; 6]) -> [f64; 6] {
        let position = modes_of_corners(corners);
        let mut shares = [0.0; 6];
        let mut volume = 0.0;
        for [r, s, t] in POINTS {
            let (_, weight) = jacobian(&position, [r, s, t]);
            volume += weight;
            for (i, area) in [1.0 - r - s, r, s].into_iter().enumerate() {
                shares[i] += weight * area * 0.5 * (1.0 - t);
                shares[i + 3] += weight * area * 0.5 * (1.0 + t);
            }
        }
        shares.map(|share| share / volume)
    }
    #[inline(always)]
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 6]) -> [Strain<L>; 6] {
        let position = position_modes(&geometry);
        let displacement = [modes[1], modes[2], modes[3], modes[4], modes[5]];
        let one = geometry.constant(1.0);
        let mut strains = [Strain([one; 6]); 6];
        for p in 0..6 {
            let (rows, determinant) = jacobian(&position, POINTS[p]);
            let gradient = outer_sum(columns(&displacement, POINTS[p]), rows);
            let inverse = one / determinant;
            strains[p] = strain_of(&[
                scaled(gradient[0], inverse),
                scaled(gradient[1], inverse),
                scaled(gradient[2], inverse),
            ]);
        }
        strains
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 6],
        _hourglass: &Hourglass<L>,
        _modes: &[[L; 3]; 6],
    ) -> [[L; 3]; 6] {
        let position = position_modes(&geometry);
        let mut forces = [[geometry.constant(0.0); 3]; 6];
        for p in 0..6 {
            let (rows, _) = jacobian(&position, POINTS[p]);
            let stress = stress_matrix(&stresses[p]);
            let (r, s, t) = natural(POINTS[p], geometry.constant(0.0));
            let [a, b, c] = [
                product(&stress, rows[0]),
                product(&stress, rows[1]),
                product(&stress, rows[2]),
            ];
            forces[1] = sum(forces[1], a);
            forces[2] = sum(forces[2], b);
            forces[3] = sum(forces[3], c);
            forces[4] = sum(forces[4], scaled_sum(a, t, scaled(c, r)));
            forces[5] = sum(forces[5], scaled_sum(b, t, scaled(c, s)));
        }
        let scale = geometry.constant(SCALE);
        for k in 1..6 {
            forces[k] = scaled(forces[k], scale);
        }
        forces
    }
    #[inline(always)]
    fn modal(&self) -> Option<&impl ModalKernel<6, 6>> {
        Some(self)
    }
}

impl ModalKernel<6, 6> for Wedge6 {
    #[inline(always)]
    fn modes<L: Lane>(&self, nodal: &[[L; 3]; 6]) -> [[L; 3]; 6] {
        modes(nodal)
    }
    #[inline(always)]
    fn nodal_forces<L: Lane>(&self, modal: &[[L; 3]; 6]) -> [[L; 3]; 6] {
        let [_, r, s, t, rt, st] = *modal;
        let (low, height) = (sum(r, s), difference(t, sum(rt, st)));
        [
            [
                -low[0] - height[0],
                -low[1] - height[1],
                -low[2] - height[2],
            ],
            difference(r, rt),
            difference(s, st),
            difference(height, low),
            sum(r, rt),
            sum(s, st),
        ]
    }
}
