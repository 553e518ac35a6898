//! Stress of a brick that is linear in its natural coordinates, from hourglass strains.

use powerhouse_model::{ElasticMedium, Geometry, Lane, OwnStep, Stress};

use super::mean_gradient::LINEAR;
use super::vectors::{dot, scaled, scaled_sum};

/// Number of history variables of a brick: the plastic parts of its hourglass strains.
pub(super) const HISTORY: usize = 12;

/// Least share of the increment of hourglass forces that plastic flow leaves.
const LEAST_ELASTIC_SHARE: f64 = 0.02;

/// The directions in the plane of the plate with its thickness along each natural direction.
pub(super) const PLANES: [(usize, usize); 3] = [(1, 2), (2, 0), (0, 1)];

/// Moduli of the hourglass forces: `2 lambda G / (lambda + 2 G)`, shear and Young's modulus.
pub(super) fn moduli(medium: &ElasticMedium) -> [f64; 3] {
    let (lambda, shear) = (medium.lambda(), medium.shear());
    [
        2.0 * lambda * shear / medium.constrained(),
        shear,
        medium.young,
    ]
}

/// Hourglass strains less their plastic parts.
#[inline(always)]
pub(super) fn elastic_part<L: Lane>(mut strains: [[L; 3]; 4], history: &[L]) -> [[L; 3]; 4] {
    if !history.is_empty() {
        for a in 0..4 {
            for i in 0..3 {
                strains[a][i] = strains[a][i] - history[3 * a + i];
            }
        }
    }
    strains
}

/// Natural frame of a batch of bricks, scaled to the volume one: `x_i = X_i / sqrt V`, with which no volume enters the forces.
pub(super) struct NaturalFrame<L> {
    pub(super) x: [[L; 3]; 3],
    /// `A_ii`, `A_jj` and `A_ij` in the plane of each plate.
    pub(super) planes: [[L; 3]; 3],
    /// `1 / |x_i|^2`.
    pub(super) inverse: [L; 3],
}

/// Linear parts of the position of a batch of bricks with any corners, `X_k / sqrt V`.
#[inline(always)]
pub(super) fn linear<L: Lane>(geometry: &Geometry<L>) -> [[L; 3]; 3] {
    [
        geometry.vector(LINEAR),
        geometry.vector(LINEAR + 3),
        geometry.vector(LINEAR + 6),
    ]
}

impl<L: Lane> NaturalFrame<L> {
    #[inline(always)]
    pub(super) fn new(x: [[L; 3]; 3]) -> Self {
        let one = x[0][0].constant(1.0);
        let squares = [dot(x[0], x[0]), dot(x[1], x[1]), dot(x[2], x[2])];
        let mut planes = [squares; 3];
        let mut inverse = squares;
        for k in 0..3 {
            let (i, j) = PLANES[k];
            let mixed = dot(x[i], x[j]);
            let determinant = squares[i].mul_add(squares[j], -(mixed * mixed));
            let factor = one / determinant;
            planes[k] = [squares[j] * factor, squares[i] * factor, -(mixed * factor)];
            inverse[k] = one / squares[k];
        }
        Self { x, planes, inverse }
    }

    /// Curvatures `k_ii, k_jj, k_ij` of each plate, of hourglass strains (eight times those of the interpolation).
    #[inline(always)]
    pub(super) fn curvatures(&self, strains: &[[L; 3]; 4]) -> [[L; 3]; 3] {
        let x = &self.x;
        let half = x[0][0].constant(0.5);
        let mut own = self.inverse;
        for i in 0..3 {
            own[i] = dot(x[i], strains[i]);
        }
        let mut curvatures = self.planes;
        for k in 0..3 {
            let (i, j) = PLANES[k];
            let mixed = (own[i] + own[j]) * half;
            curvatures[k] = [dot(x[i], strains[j]), dot(x[j], strains[i]), mixed];
        }
        curvatures
    }

    /// Trace `A:k` of curvatures of plate `k`.
    #[inline(always)]
    pub(super) fn trace(&self, [ii, jj, both]: [L; 3], k: usize) -> L {
        let [a_ii, a_jj, a_ij] = self.planes[k];
        let mixed = a_ij * both;
        a_ii.mul_add(ii, a_jj.mul_add(jj, mixed + mixed))
    }

    /// Plane stress `s_ii, s_jj, s_ij` of each plate at its coordinate 1, of hourglass strains (eight times those of the
    /// interpolation), times a factor.
    #[inline(always)]
    fn plane_stresses(
        &self,
        [plate, shear, _]: &[L; 3],
        strains: &[[L; 3]; 4],
        factor: f64,
    ) -> [[L; 3]; 3] {
        let factor = plate.constant(factor);
        let (plate, twice) = (*plate * factor, (*shear + *shear) * factor);
        let curvatures = self.curvatures(strains);
        let mut stresses = self.planes;
        for k in 0..3 {
            let [ii, jj, ij] = self.planes[k];
            let [k_ii, k_jj, k_ij] = curvatures[k];
            // B = A k, then s = (plate tr B I + 2 G B) A.
            let b_ii = ii.mul_add(k_ii, ij * k_ij);
            let b_ij = ii.mul_add(k_ij, ij * k_jj);
            let b_ji = ij.mul_add(k_ii, jj * k_ij);
            let b_jj = ij.mul_add(k_ij, jj * k_jj);
            let mean = plate * (b_ii + b_jj);
            let (t_ii, t_jj) = (twice.mul_add(b_ii, mean), twice.mul_add(b_jj, mean));
            let (t_ij, t_ji) = (twice * b_ij, twice * b_ji);
            stresses[k] = [
                t_ii.mul_add(ii, t_ij * ij),
                t_ji.mul_add(ij, t_jj * jj),
                t_ii.mul_add(ij, t_ij * jj),
            ];
        }
        stresses
    }

    /// Hourglass forces, conjugate to the hourglass strains.
    #[inline(always)]
    pub(super) fn forces(&self, moduli: &[L; 3], strains: &[[L; 3]; 4]) -> [[L; 3]; 4] {
        let x = &self.x;
        let stresses = self.plane_stresses(moduli, strains, 1.0 / 192.0);
        let mut forces = self.distributed(&stresses);
        let uniaxial = moduli[2] * moduli[2].constant(1.0 / 576.0);
        for i in 0..3 {
            let square = self.inverse[i] * self.inverse[i];
            forces[3] = scaled_sum(x[i], uniaxial * square * dot(x[i], strains[3]), forces[3]);
        }
        forces
    }

    /// Forces on the modes of products of two coordinates of plane stresses `s_ii, s_jj, s_ij` of each plate; none on the
    /// last mode.
    #[inline(always)]
    pub(super) fn distributed(&self, stresses: &[[L; 3]; 3]) -> [[L; 3]; 4] {
        let x = &self.x;
        let mut forces = [[x[0][0].constant(0.0); 3]; 4];
        for a in 0..3 {
            // The mode of the product of the coordinates other than `a` belongs to the plates `i` and `j`.
            let (i, j) = PLANES[a];
            // In the plane of plate `i` are the directions `j` and `a`, in that of `j` are `a` and `i`.
            let of_i = stresses[i];
            let of_j = stresses[j];
            let [along_j, shear_i] = [of_i[0], of_i[2]];
            let [along_i, shear_j] = [of_j[1], of_j[2]];
            let along = scaled_sum(x[j], along_j, scaled(x[i], along_i));
            forces[a] = scaled_sum(x[a], shear_i + shear_j, along);
        }
        forces
    }

    /// Energy of the hourglass forces.
    #[inline(always)]
    pub(super) fn energy(&self, moduli: &[L; 3], strains: &[[L; 3]; 4]) -> L {
        work(&self.forces(moduli, strains), strains) * moduli[0].constant(0.5)
    }

    /// Writes the plastic parts of hourglass strains after a step, from the strains and their increments.
    ///
    /// The hourglass forces `Q` of an elastic step become `(1 - b) Q`, with `b` such that forces which have grown in
    /// proportion keep the elastic share of their increment, and `b = 0` where they fell: `b = (1 - r) (Q . dq) / (Q . q)`;
    /// then they relax as all differences of stress within a body that flows. Both bring them towards zero along
    /// themselves, so that plastic energy never falls.
    #[inline(always)]
    pub(super) fn flow<const N: usize, const P: usize>(
        &self,
        step: &OwnStep<L, N, P>,
        strains: &[[L; 3]; 4],
        moved: &[[L; 3]; 4],
        new: &mut [L],
    ) {
        let elastic = elastic_part(*strains, step.history);
        let forces = self.forces(&step.moduli, &elastic);
        let (growth, whole) = (work(&forces, moved), work(&forces, &elastic));
        let (zero, one) = (growth.constant(0.0), growth.constant(1.0));
        let share = step.elastic_share.max(one.constant(LEAST_ELASTIC_SHARE));
        let some = zero.less(whole);
        let ratio = growth.max(zero) / whole.select(some, one);
        let left = (one - (one - share) * ratio.min(one)) * step.kept;
        let flowed = (one - left).select(some, zero);
        for a in 0..4 {
            for i in 0..3 {
                let before = match step.history.get(3 * a + i) {
                    Some(before) => *before,
                    None => zero,
                };
                new[3 * a + i] = elastic[a][i].mul_add(flowed, before);
            }
        }
    }
}

impl NaturalFrame<f64> {
    /// Stress (Pa) at the natural coordinate 1 of each direction less the mean stress, with `1 / (8 sqrt V)`.
    pub(super) fn surface_stresses(
        &self,
        moduli: &[f64; 3],
        strains: &[[f64; 3]; 4],
        shrink: f64,
    ) -> [Stress; 3] {
        let stresses = self.plane_stresses(moduli, strains, shrink);
        core::array::from_fn(|k| {
            let (i, j) = PLANES[k];
            let (a, b) = (self.x[i], self.x[j]);
            let [ii, jj, ij] = stresses[k];
            let component = |m: usize, n: usize| {
                ii * a[m] * a[n] + jj * b[m] * b[n] + ij * (a[m] * b[n] + b[m] * a[n])
            };
            Stress([
                component(0, 0),
                component(1, 1),
                component(2, 2),
                component(0, 1),
                component(1, 2),
                component(2, 0),
            ])
        })
    }
}

/// Work of hourglass forces on hourglass strains.
#[inline(always)]
fn work<L: Lane>(forces: &[[L; 3]; 4], strains: &[[L; 3]; 4]) -> L {
    (dot(forces[0], strains[0]) + dot(forces[1], strains[1]))
        + (dot(forces[2], strains[2]) + dot(forces[3], strains[3]))
}
