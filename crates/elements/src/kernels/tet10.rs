//! Ten-node composite tetrahedron.

use powerhouse_model::{
    ElasticMedium, ElementKernel, ElementKind, Geometry, Hourglass, Lane, ModalKernel, Strain,
    Stress, Vec3,
};

use super::positions;
use super::tet4::Tet4;
use super::vectors::{
    Matrix, difference, linear_gradients, outer_sum, product, scaled, scaled_sum, strain_of,
    stress_matrix, sum,
};

/// Index of the quarter of the volume among the geometry numbers, which follows the gradients of three corner coordinates.
const QUARTER: usize = 9;
/// Corner coordinates of an integration point: of the three corners that are far from it, and what the near one has more.
const FAR: f64 = 0.138_196_601_125_010_5;
const MORE: f64 = 0.447_213_595_499_957_9;
/// Weights of the curvature of an edge, of the opposite one and of the sums at the corners, in the gradient at a corner.
const OWN: f64 = MORE * 80.0 / 24.0;
const OPPOSITE: f64 = MORE * 10.0 / 24.0;
const OTHERS: f64 = -MORE * 2.0 / 24.0;
const HERE: f64 = MORE * 8.0 / 24.0;
/// Weight of the sums at the corners in the gradient at every point.
const EVERYWHERE: f64 = 3.0 * FAR;
/// Modes of the edges between two corners.
const EDGES: [[usize; 4]; 4] = [[0, 4, 6, 7], [4, 0, 5, 9], [6, 5, 0, 8], [7, 9, 8, 0]];
/// The mode of the opposite edge, by that of an edge.
const OPPOSITE_EDGE: [usize; 10] = [0, 0, 0, 0, 8, 7, 9, 5, 4, 6];

/// Composite tetrahedron with ten nodes and four integration points, for straight edges.
///
/// Twelve tetrahedra of constant strain, four at the corners and eight around the centroid, whose displacement is the mean of
/// those at the six midpoints; their displacement gradient is projected on the linear functions of position. At corner
/// `a`, with the other corners `b, c, d`, `ab` the node between `a` and `b`, and the corner coordinate `l_b`,
/// ```text
/// D_ab = (-51 u_a - 9 u_b + 70 u_ab - 8 (u_ac + u_ad) - 2 (u_bc + u_bd) + 10 u_cd) / 24
/// grad u at a = sum_b D_ab (x) grad l_b
/// ```
/// which the four points interpolate, each with a quarter of the volume. Lumped masses are the sums over the parts, 1/32 at a
/// corner and 7/48 at a midpoint, and a uniform traction on a side has a twelfth of its force at a corner and a quarter at a
/// midpoint: all positive, unlike those of the quadratic tetrahedron, whose stable step is a third shorter.
///
/// The volumetric strain at a point is its mean over the element plus a share of its difference from the mean,
/// ```text
/// tr e_p <- mean + blend (tr e_p - mean),   blend^2 = (1 - 2 nu) / (1 + nu)
/// ```
/// so that of the elastic energy `G` works on the local strain and `lambda` on its mean: the element does not lock as the
/// material becomes incompressible, and without any local part it would have three more modes without stiffness. A thin
/// part bends with one layer of elements.
///
/// The modes are the displacements of the corners 1, 2, 3 relative to corner 0 and those of the midpoints relative to the
/// means of their ends.
///
/// In the manner of P. Thoutireddy, J. F. Molinari, E. A. Repetto and M. Ortiz, Tetrahedral composite finite elements, Int.
/// J. Numer. Meth. Engng 53 (2002) 1337-1351.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tet10 {
    pub(super) blend: f64,
}

impl Tet10 {
    /// Name of the kernel.
    pub(super) const NAME: &'static str = "tet10";
    /// Number of integration points.
    pub(super) const POINTS: usize = 4;

    /// The tetrahedron for a material with an undamaged medium.
    pub fn new(medium: &ElasticMedium) -> Self {
        let square = (1.0 - 2.0 * medium.poisson) / (1.0 + medium.poisson);
        Self {
            blend: square.clamp(0.0, 1.0).sqrt(),
        }
    }

    /// Blends the volumetric parts of tensors at the points with their mean; the operation is its own transpose.
    #[inline(always)]
    fn blended<L: Lane>(&self, tensors: [[L; 6]; 4]) -> [[L; 6]; 4] {
        let mut blended = tensors;
        let quarter = tensors[0][0].constant(0.25);
        let share = quarter.constant((1.0 - self.blend) / 3.0);
        let mut traces = [quarter; 4];
        for p in 0..4 {
            let [xx, yy, zz, ..] = tensors[p];
            traces[p] = (xx + yy) + zz;
        }
        let mean = ((traces[0] + traces[1]) + (traces[2] + traces[3])) * quarter;
        for p in 0..4 {
            let shift = (mean - traces[p]) * share;
            for i in 0..3 {
                blended[p][i] = blended[p][i] + shift;
            }
        }
        blended
    }
}

/// Sums of the modes of the three edges at each corner.
#[inline(always)]
fn sums_at_corners<L: Lane>(m: &[[L; 3]; 10]) -> [[L; 3]; 4] {
    let mut sums = [m[0]; 4];
    for a in 0..4 {
        let [b, c, d] = others(a);
        sums[a] = sum(m[EDGES[a][b]], sum(m[EDGES[a][c]], m[EDGES[a][d]]));
    }
    sums
}

/// The corners but one.
#[inline(always)]
fn others(corner: usize) -> [usize; 3] {
    const OF: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
    OF[corner]
}

impl ElementKernel<10, 4> for Tet10 {
    fn name(&self) -> &'static str {
        Self::NAME
    }
    fn kind(&self) -> ElementKind {
        ElementKind::Tet10
    }
    #[inline(always)]
    fn geometry_len(&self) -> usize {
        QUARTER + 1
    }
    fn geometry(&self, corners: &[Vec3; 10], out: &mut [f64]) {
        let [a, b, c, d, ..] = *corners;
        Tet4.geometry(&[a, b, c, d], out);
        out[QUARTER] *= 0.25;
    }
    fn point_positions(&self, corners: &[Vec3; 10]) -> [Vec3; 4] {
        let near = FAR + MORE;
        let points = [
            [FAR; 3],
            [near, FAR, FAR],
            [FAR, near, FAR],
            [FAR, FAR, near],
        ];
        let [a, b, c, d, ..] = *corners;
        positions(ElementKind::Tet4, &[a, b, c, d], points)
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 4] {
        [geometry.get(QUARTER); 4]
    }
    fn node_shares(&self, _corners: &[Vec3; 10]) -> [f64; 10] {
        let (corner, middle) = (1.0 / 32.0, 7.0 / 48.0);
        core::array::from_fn(|a| if a < 4 { corner } else { middle })
    }
    #[inline(always)]
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 10]) -> [Strain<L>; 4] {
        let gradients = linear_gradients(&geometry);
        let constant = |value: f64| geometry.constant(value);
        let sums = sums_at_corners(modes);
        // What all points have: vectors of the corners 1, 2, 3 relative to corner 0.
        let mut common = [modes[1], modes[2], modes[3]];
        for k in 0..3 {
            let relative = difference(sums[k + 1], sums[0]);
            common[k] = scaled_sum(relative, constant(EVERYWHERE), common[k]);
        }
        let mut strains = [[constant(0.0); 6]; 4];
        for p in 0..4 {
            let mut of_corner = sums;
            for b in 0..4 {
                of_corner[b] = scaled(sums[b], constant(if b == p { HERE } else { OTHERS }));
                if b != p {
                    let edge = EDGES[p][b];
                    let opposite = modes[OPPOSITE_EDGE[edge]];
                    of_corner[b] = scaled_sum(modes[edge], constant(OWN), of_corner[b]);
                    of_corner[b] = scaled_sum(opposite, constant(OPPOSITE), of_corner[b]);
                }
            }
            let mut vectors = common;
            for k in 0..3 {
                vectors[k] = sum(common[k], difference(of_corner[k + 1], of_corner[0]));
            }
            strains[p] = strain_of(&outer_sum(vectors, gradients)).0;
        }
        self.blended(strains).map(Strain)
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 4],
        _hourglass: &Hourglass<L>,
        _modes: &[[L; 3]; 10],
    ) -> [[L; 3]; 10] {
        let gradients = linear_gradients(&geometry);
        let constant = |value: f64| geometry.constant(value);
        let volume = geometry.get(QUARTER);
        let zero = [constant(0.0); 3];
        let mut tensors = [[constant(0.0); 6]; 4];
        for p in 0..4 {
            tensors[p] = stresses[p].0;
        }
        let tensors = self.blended(tensors);
        // Forces `tractions[p][b]` of point `p` on the gradient of the coordinate of corner `b`.
        let mut tractions = [[zero; 4]; 4];
        let mut linear = [zero; 4];
        for p in 0..4 {
            let mut stress: Matrix<L> = stress_matrix(&Stress(tensors[p]));
            for i in 0..3 {
                stress[i] = scaled(stress[i], volume);
            }
            for k in 0..3 {
                tractions[p][k + 1] = product(&stress, gradients[k]);
            }
            let [_, a, b, c] = tractions[p];
            let all = sum(sum(a, b), c);
            tractions[p][0] = [-all[0], -all[1], -all[2]];
            for b in 0..4 {
                linear[b] = sum(linear[b], tractions[p][b]);
            }
        }
        let mut at_corners = linear;
        for b in 0..4 {
            // Every point but that of the corner itself has the weight of the others.
            let mut force = scaled(linear[b], constant(EVERYWHERE + OTHERS));
            force = scaled_sum(tractions[b][b], constant(HERE - OTHERS), force);
            at_corners[b] = force;
        }
        let mut forces = [zero; 10];
        [forces[1], forces[2], forces[3]] = [linear[1], linear[2], linear[3]];
        for a in 0..4 {
            for b in a + 1..4 {
                let edge = EDGES[a][b];
                let along = sum(tractions[a][b], tractions[b][a]);
                let opposite = OPPOSITE_EDGE[edge];
                let force = sum(forces[edge], sum(at_corners[a], at_corners[b]));
                forces[edge] = scaled_sum(along, constant(OWN), force);
                forces[opposite] = scaled_sum(along, constant(OPPOSITE), forces[opposite]);
            }
        }
        forces
    }
    #[inline(always)]
    fn modal(&self) -> Option<&impl ModalKernel<10, 4>> {
        Some(self)
    }
}

impl ModalKernel<10, 4> for Tet10 {
    #[inline(always)]
    fn modes<L: Lane>(&self, nodal: &[[L; 3]; 10]) -> [[L; 3]; 10] {
        let half = nodal[0][0].constant(-0.5);
        let mut modes = *nodal;
        for a in 1..4 {
            modes[a] = difference(nodal[a], nodal[0]);
        }
        for a in 0..4 {
            for b in a + 1..4 {
                let middle = EDGES[a][b];
                // Twice half of the differences, so that a common motion leaves no rounding.
                let ends = sum(
                    difference(nodal[a], nodal[middle]),
                    difference(nodal[b], nodal[middle]),
                );
                modes[middle] = scaled(ends, half);
            }
        }
        modes
    }
    #[inline(always)]
    fn nodal_forces<L: Lane>(&self, modal: &[[L; 3]; 10]) -> [[L; 3]; 10] {
        let half = modal[0][0].constant(-0.5);
        let mut forces = *modal;
        let all = sum(sum(modal[1], modal[2]), modal[3]);
        forces[0] = [-all[0], -all[1], -all[2]];
        let curved = sums_at_corners(modal);
        for a in 0..4 {
            forces[a] = scaled_sum(curved[a], half, forces[a]);
        }
        forces
    }
}
