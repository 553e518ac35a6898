//! Eight-node brick with one integration point and hourglass stiffness.

use powerhouse_model::{
    ElasticMedium, ElementKernel, ElementKind, Geometry, Hourglass, HourglassKernel, Lane,
    ModalKernel, ParameterError, Strain, Stress, Vec3,
};

use super::hexahedron::{self, HexahedronModes};
use super::mean_gradient::{self, NUMBERS, Shape, VOLUME};
use super::positions;
use super::vectors::{dot, scaled, strain_of};

/// Index of the hourglass factor `c / (lambda + 2 G)`.
const RESISTANCE: usize = NUMBERS;

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
        let squares = mean_gradient::geometry(corners, out);
        out[RESISTANCE] = 0.5 * self.hourglass * squares / out[VOLUME];
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
    fn strains<L: Lane>(&self, geometry: Geometry<L>, modes: &[[L; 3]; 8]) -> [Strain<L>; 1] {
        [strain_of(&Shape::new(&geometry).mean_gradient(modes))]
    }
    #[inline(always)]
    fn forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; 1],
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; 8],
    ) -> [[L; 3]; 8] {
        let shape = Shape::new(&geometry);
        let gradient = shape.mean_gradient(modes);
        let mut resisted = shape.hourglass_strains(&gradient, modes);
        let resistance = hourglass.moduli[0] * geometry.get(RESISTANCE);
        for resisted in &mut resisted {
            *resisted = scaled(*resisted, resistance);
        }
        shape.forces(&geometry, &stresses[0], &resisted)
    }
    #[inline(always)]
    fn modal(&self) -> Option<&impl ModalKernel<8, 1>> {
        Some(&HexahedronModes)
    }
    #[inline(always)]
    fn hourglass(&self) -> Option<&impl HourglassKernel<8, 1>> {
        Some(self)
    }
}

impl HourglassKernel<8, 1> for Hex8OnePoint {
    fn hourglass_moduli(&self, medium: &ElasticMedium) -> [f64; 3] {
        let most = self.most_shear / self.hourglass * medium.shear();
        [medium.constrained().min(most), 0.0, 0.0]
    }
    #[inline(always)]
    fn hourglass_energy<L: Lane>(
        &self,
        geometry: Geometry<L>,
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; 8],
    ) -> L {
        let shape = Shape::new(&geometry);
        let q = shape.hourglass_strains(&shape.mean_gradient(modes), modes);
        let squares = (dot(q[0], q[0]) + dot(q[1], q[1])) + (dot(q[2], q[2]) + dot(q[3], q[3]));
        let half = geometry.constant(0.5);
        half * hourglass.moduli[0] * geometry.get(RESISTANCE) * squares
    }
}
