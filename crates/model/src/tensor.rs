//! Symmetric tensors of second order.

use crate::{Lane, Mat3, Vec3, array};

macro_rules! symmetric_tensor {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name<L = f64>(pub [L; 6]);

        impl<L: Lane> $name<L> {
            /// The zero tensor.
            #[inline(always)]
            pub fn zero(token: L::Token) -> Self {
                Self([L::splat(token, 0.0); 6])
            }
        }

        impl Default for $name<f64> {
            fn default() -> Self {
                Self([0.0; 6])
            }
        }

        impl<L: Lane> core::ops::Add for $name<L> {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(array(|i| self.0[i] + other.0[i]))
            }
        }

        impl<L: Lane> core::ops::Sub for $name<L> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(array(|i| self.0[i] - other.0[i]))
            }
        }

        impl<L: Lane> core::ops::Mul<L> for $name<L> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, factor: L) -> Self {
                Self(array(|i| self.0[i] * factor))
            }
        }
    };
}

symmetric_tensor! {
    /// A stress tensor (Pa), tension positive, with the components xx yy zz xy yz zx.
    Stress
}
symmetric_tensor! {
    /// A small strain tensor with the components xx yy zz and the engineering shear strains xy yz zx (twice the tensor
    /// components).
    Strain
}

/// Principal values and directions of a symmetric tensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principal {
    /// Principal values in falling order.
    pub values: [f64; 3],
    /// Principal directions, unit vectors in the order of the values.
    pub directions: [Vec3; 3],
}

impl Stress {
    /// The stress as a symmetric 3 x 3 matrix (Pa).
    pub fn matrix(&self) -> Mat3 {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz)
    }
    /// A stress from the upper triangle of a matrix (Pa).
    pub fn from_matrix(matrix: &Mat3) -> Self {
        Self([
            matrix[(0, 0)],
            matrix[(1, 1)],
            matrix[(2, 2)],
            matrix[(0, 1)],
            matrix[(1, 2)],
            matrix[(2, 0)],
        ])
    }
    /// Traction vector on a plane with unit normal `normal` (Pa).
    #[inline]
    pub fn traction(&self, normal: &Vec3) -> Vec3 {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        Vec3::new(
            xx * normal.x + xy * normal.y + zx * normal.z,
            xy * normal.x + yy * normal.y + yz * normal.z,
            zx * normal.x + yz * normal.y + zz * normal.z,
        )
    }
    /// Mean normal stress (Pa), a third of the trace.
    pub fn mean(&self) -> f64 {
        (self.0[0] + self.0[1] + self.0[2]) / 3.0
    }
    /// Principal stresses (Pa) and their directions.
    pub fn principal(&self) -> Principal {
        let eigen = self.matrix().symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        Principal {
            values: order.map(|i| eigen.eigenvalues[i]),
            directions: order.map(|i| eigen.eigenvectors.column(i).into_owned()),
        }
    }
}

impl Strain {
    /// The small strain of a displacement gradient `gradient[(i, j)] = du_i/dx_j`.
    pub fn from_gradient(gradient: &Mat3) -> Self {
        Self([
            gradient[(0, 0)],
            gradient[(1, 1)],
            gradient[(2, 2)],
            gradient[(0, 1)] + gradient[(1, 0)],
            gradient[(1, 2)] + gradient[(2, 1)],
            gradient[(2, 0)] + gradient[(0, 2)],
        ])
    }
}

impl<L: Lane> Stress<L> {
    /// Mean stress, and `sqrt(J2)` with the second invariant `J2` of the deviator (Pa).
    #[inline(always)]
    pub fn mean_and_shear(&self) -> (L, L) {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        let mean = (xx + yy + zz) * xx.constant(1.0 / 3.0);
        let (x, y, z) = (xx - mean, yy - mean, zz - mean);
        let normal = x.mul_add(x, y.mul_add(y, z * z)) * xx.constant(0.5);
        let shear = xy.mul_add(xy, yz.mul_add(yz, zx * zx));
        (mean, (normal + shear).sqrt())
    }
    /// Inner product `sigma : epsilon` with a strain (J/m3).
    #[inline(always)]
    pub fn work(&self, strain: &Strain<L>) -> L {
        let (s, e) = (&self.0, &strain.0);
        let mut sum = s[0] * e[0];
        for i in 1..6 {
            sum = s[i].mul_add(e[i], sum);
        }
        sum
    }
    /// Isotropic elastic stress `lambda tr(e) I + 2 G e` (Pa) of a strain, with Lamé's parameters (Pa).
    #[inline(always)]
    pub fn elastic(lambda: L, shear: L, strain: &Strain<L>) -> Self {
        let e = &strain.0;
        let volumetric = lambda * (e[0] + e[1] + e[2]);
        let double = shear + shear;
        Self([
            double.mul_add(e[0], volumetric),
            double.mul_add(e[1], volumetric),
            double.mul_add(e[2], volumetric),
            shear * e[3],
            shear * e[4],
            shear * e[5],
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_stresses_rebuild_the_tensor() {
        let stress = Stress([3.0, -1.0, 2.0, 0.5, -0.25, 1.5]);
        let principal = stress.principal();
        let mut rebuilt = Mat3::zeros();
        for i in 0..3 {
            let d = principal.directions[i];
            rebuilt += principal.values[i] * d * d.transpose();
        }
        assert!((rebuilt - stress.matrix()).norm() < 1e-14);
        assert!(principal.values[0] >= principal.values[1]);
        assert!(principal.values[1] >= principal.values[2]);
    }

    #[test]
    fn elastic_stress_follows_hooke() {
        let strain = Strain([1e-3, 0.0, 0.0, 2e-3, 0.0, 0.0]);
        let stress = Stress::elastic(2.0e9, 1.0e9, &strain);
        assert_eq!(stress.0, [4.0e6, 2.0e6, 2.0e6, 2.0e6, 0.0, 0.0]);
    }
}
