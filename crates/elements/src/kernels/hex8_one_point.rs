//! Eight-node brick with one integration point and hourglass stiffness.

use powerhouse_model::{
    ElementKernel, ElementKind, Geometry, Lane, ParameterError, Strain, Stress, Vec3,
};

use super::hexahedron;
use super::positions;
use super::vectors::{
    Matrix, cross, cross_sum, dot, dot_sum, outer_sum, scaled, scaled_sum, strain_of, stress_matrix,
};

/// Indices of the geometry numbers: `X_k / sqrt V` of the linear modes, `8 X_a` of the others.
const LINEAR: usize = 0;
const BENT: usize = 9;
const VOLUME: usize = 21;
/// Index of `1 / (8 sqrt V)`, which turns `8 X_a` into `X_a / sqrt V`.
const SHRINK: usize = 22;
/// Index of the hourglass factor `c / (lambda + 2 G)`.
const RESISTANCE: usize = 23;

/// Uniform-strain eight-node brick: mean displacement gradient over the volume, with stiffness against
/// hourglass modes.
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
/// `lambda + 2 G` is at most [`most_shear`](Self::most_shear) `G / hourglass`: bending and shear of a nearly
/// incompressible medium cost its shear modulus alone, and a hundred times that would lock them. A shear
/// wave that arrives at 60 degrees in ground of Poisson's ratio 0.49 errs by 0.215 at the surface with the
/// whole of `lambda + 2 G`.
///
/// The hourglass stiffness falls with the share that remains by the law
/// ([`RemainingStiffness::hourglass`](powerhouse_model::RemainingStiffness)), to a hundredth at least.
///
/// Source: D. P. Flanagan and T. Belytschko, A uniform strain hexahedron and quadrilateral with
/// orthogonal hourglass control, Int. J. Numer. Meth. Engng 17 (1981) 679-706.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hex8OnePoint {
    /// Hourglass coefficient (1), from 0.001 to 1; 0.1 by default. A cube in pure bending has its true
    /// stiffness near `0.22 E / (lambda + 2 G)`; lower values are softer. Below 0.01 a mesh may
    /// show the modes.
    pub hourglass: f64,
    /// Upper bound (1) of `hourglass (lambda + 2 G) / G`: 1.5 by default, which Poisson's ratios above 0.464
    /// reach; infinite where a coefficient is given.
    pub most_shear: f64,
}

impl Hex8OnePoint {
    /// The brick with the default hourglass coefficient.
    pub const DEFAULT: Self = Self {
        hourglass: 0.1,
        most_shear: 1.5,
    };

    /// The brick with an hourglass coefficient from 0.001 to 1, for any Poisson's ratio.
    ///
    /// # Errors
    /// A coefficient out of range.
    pub fn new(hourglass: f64) -> Result<Self, ParameterError> {
        ParameterError::check("hourglass", hourglass, 1e-3, 1.0)?;
        Ok(Self {
            hourglass,
            most_shear: f64::INFINITY,
        })
    }
}

impl Default for Hex8OnePoint {
    fn default() -> Self {
        Self::DEFAULT
    }
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
struct Shape<L> {
    gradients: [[L; 3]; 6],
    bent: [[L; 3]; 4],
}

impl<L: Lane> Shape<L> {
    #[inline(always)]
    fn new(geometry: &Geometry<L>) -> Self {
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
    fn mean_gradient(&self, modes: &[[L; 3]; 8]) -> Matrix<L> {
        let [_, s1, s2, s3, s4, s5, s6, _] = *modes;
        outer_sum([s1, s2, s3, s4, s5, s6], self.gradients)
    }
    /// Hourglass strains `q_a`.
    #[inline(always)]
    fn hourglass_strains(&self, gradient: &Matrix<L>, modes: &[[L; 3]; 8]) -> [[L; 3]; 4] {
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
        RESISTANCE + 1
    }
    fn geometry(&self, corners: &[Vec3; 8], out: &mut [f64]) {
        let x = hexahedron::position_modes(corners).map(|mode| scaled(mode, 0.125));
        let bent = [x[3], x[4], x[5], x[6]];
        let g = volume_gradients([x[0], x[1], x[2]], &bent, 1.0);
        // V/8 is of third degree in the modes, hence sum_k X_k . d(V/8)/dX_k = 3 V/8.
        let thrice: f64 = (0..6).map(|k| dot(x[k], g[k])).sum();
        let volume = 8.0 / 3.0 * thrice;
        let squares: f64 = g.iter().map(|g| dot(*g, *g)).sum();
        let root = volume.sqrt();
        for k in 0..7 {
            let scale = if k < 3 { 1.0 / root } else { 8.0 };
            out[3 * k..3 * k + 3].copy_from_slice(&scaled(x[k], scale));
        }
        out[VOLUME] = volume;
        out[SHRINK] = 0.125 / root;
        out[RESISTANCE] = 0.5 * self.hourglass * squares / volume;
    }
    fn point_positions(&self, corners: &[Vec3; 8]) -> [Vec3; 1] {
        positions(ElementKind::Hex8, corners, [[0.0; 3]])
    }
    #[inline(always)]
    fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 1] {
        [geometry.get(VOLUME)]
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
        [strain_of(&Shape::new(&geometry).mean_gradient(modes))]
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 1],
        modulus: L,
        modes: &[[L; 3]; 8],
    ) -> [[L; 3]; 8] {
        let shape = Shape::new(&geometry);
        let gradient = shape.mean_gradient(modes);
        let mut resisted = shape.hourglass_strains(&gradient, modes);
        let resistance = modulus * geometry.get(RESISTANCE);
        let volume = geometry.get(VOLUME);
        let stress = stress_matrix(&stresses[0]);
        let g = &shape.gradients;
        let mut forces = [[geometry.constant(0.0); 3]; 8];
        for i in 0..3 {
            // The mean gradient carries the stress, less what the hourglass forces take from it:
            // P = V sigma - sum_a Q_a (x) 8 X_a.
            let mut carried = scaled(stress[i], volume);
            for a in 0..4 {
                resisted[a][i] = resisted[a][i] * resistance;
                carried = scaled_sum(shape.bent[a], -resisted[a][i], carried);
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
    fn hourglass_modulus(&self, constrained: f64, shear: f64) -> Option<f64> {
        Some(constrained.min(self.most_shear / self.hourglass * shear))
    }
    #[inline(always)]
    fn hourglass_energy<L: Lane>(
        &self,
        geometry: Geometry<L>,
        modulus: L,
        modes: &[[L; 3]; 8],
    ) -> Option<L> {
        let shape = Shape::new(&geometry);
        let q = shape.hourglass_strains(&shape.mean_gradient(modes), modes);
        let squares = (dot(q[0], q[0]) + dot(q[1], q[1])) + (dot(q[2], q[2]) + dot(q[3], q[3]));
        let half = geometry.constant(0.5);
        Some(half * modulus * geometry.get(RESISTANCE) * squares)
    }
}
