//! Eight-node bricks with 2 x 2 x 2 integration points, without and with mean dilatation.

use powerhouse_model::{
    ElementKernel, ElementKind, Geometry, Hourglass, Lane, ModalKernel, Strain, Stress, Vec3,
};

use super::hexahedron::{self, GAUSS, HexahedronModes, MODE_NUMBERS};
use super::positions;
use super::vectors::{Matrix, cofactors, outer_sum, product, scaled, strain_of, stress_matrix};

/// Factor of the determinant of the Jacobian, whose columns are computed times 8.
const SCALE: f64 = 1.0 / 512.0;

/// Trilinear eight-node brick with 2 x 2 x 2 Gauss points.
///
/// It has no hourglass modes, is exact for parallelepipeds, too stiff in bending, and locks as the material
/// becomes incompressible; [`Hex8BBar`] does not lock there.
///
/// Its geometry numbers are the modes of the corner positions; Jacobians are formed at every use, which is
/// faster than reading them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hex8Full;

/// Trilinear eight-node brick with 2 x 2 x 2 Gauss points and the mean dilatation of the element (B-bar).
///
/// The volumetric part of the strain at each point is replaced by its mean over the volume:
/// `e = dev(e_p) + (1/3) I (1/V) sum_p tr(e_p) V_p`.
///
/// Source: T. J. R. Hughes, Generalization of selective integration procedures to anisotropic and
/// nonlinear media, Int. J. Numer. Meth. Engng 15 (1980) 1413-1418.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hex8BBar;

/// Cofactors and determinant of the Jacobian at a point.
#[inline(always)]
fn jacobian<L: Lane>(position: &[[L; 3]; 7], point: [f64; 3]) -> (Matrix<L>, L) {
    cofactors(hexahedron::columns(position, point, position[0][0]))
}

#[inline(always)]
fn position_modes<L: Lane>(geometry: &Geometry<L>) -> [[L; 3]; 7] {
    let mut modes = [[geometry.constant(0.0); 3]; 7];
    for k in 0..7 {
        modes[k] = geometry.vector(3 * k);
    }
    modes
}

#[inline(always)]
fn without_constant<L: Lane>(modes: &[[L; 3]; 8]) -> [[L; 3]; 7] {
    let [_, m1, m2, m3, m4, m5, m6, m7] = *modes;
    [m1, m2, m3, m4, m5, m6, m7]
}

#[inline(always)]
fn volumes<L: Lane>(geometry: &Geometry<L>) -> [L; 8] {
    let position = position_modes(geometry);
    let scale = geometry.constant(SCALE);
    let mut volumes = [scale; 8];
    for p in 0..8 {
        volumes[p] = scale * jacobian(&position, GAUSS[p]).1;
    }
    volumes
}

#[inline(always)]
fn strains<L: Lane>(geometry: &Geometry<L>, modes: &[[L; 3]; 8]) -> [Strain<L>; 8] {
    let position = position_modes(geometry);
    let displacement = without_constant(modes);
    let one = geometry.constant(1.0);
    let mut strains = [Strain([one; 6]); 8];
    for p in 0..8 {
        let (rows, determinant) = jacobian(&position, GAUSS[p]);
        let columns = hexahedron::columns(&displacement, GAUSS[p], one);
        let gradient = outer_sum(columns, rows);
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
fn forces<L: Lane>(geometry: &Geometry<L>, stresses: &[Stress<L>; 8]) -> [[L; 3]; 8] {
    let position = position_modes(geometry);
    let mut forces = [[geometry.constant(0.0); 3]; 8];
    for p in 0..8 {
        let (rows, _) = jacobian(&position, GAUSS[p]);
        let stress = stress_matrix(&stresses[p]);
        let tractions = [
            product(&stress, rows[0]),
            product(&stress, rows[1]),
            product(&stress, rows[2]),
        ];
        hexahedron::add_columns(tractions, GAUSS[p], &mut forces);
    }
    let scale = geometry.constant(SCALE);
    for k in 1..8 {
        forces[k] = scaled(forces[k], scale);
    }
    forces
}

/// Mean over the volume of values at the integration points.
#[inline(always)]
fn volume_mean<L: Lane>(volumes: &[L; 8], values: &[L; 8]) -> L {
    let mut sum = volumes[0] * values[0];
    let mut volume = volumes[0];
    for p in 1..8 {
        sum = volumes[p].mul_add(values[p], sum);
        volume = volume + volumes[p];
    }
    sum / volume
}

/// Additions to the normal components at each point, by which a third of the trace becomes its mean over the
/// volume.
#[inline(always)]
fn volumetric_shifts<L: Lane>(volumes: &[L; 8], tensors: &[[L; 6]; 8]) -> [L; 8] {
    let third = volumes[0].constant(1.0 / 3.0);
    let mut thirds = *volumes;
    for p in 0..8 {
        let [xx, yy, zz, ..] = tensors[p];
        thirds[p] = third * (xx + yy + zz);
    }
    let mean = volume_mean(volumes, &thirds);
    for p in 0..8 {
        thirds[p] = mean - thirds[p];
    }
    thirds
}

macro_rules! integrated_hexahedron {
    ($kernel:ident, $name:literal, $strains:expr, $forces:expr) => {
        impl ElementKernel<8, 8> for $kernel {
            fn name(&self) -> &'static str {
                $name
            }
            fn kind(&self) -> ElementKind {
                ElementKind::Hex8
            }
            #[inline(always)]
            fn geometry_len(&self) -> usize {
                MODE_NUMBERS
            }
            fn geometry(&self, corners: &[Vec3; 8], out: &mut [f64]) {
                out.copy_from_slice(hexahedron::position_modes(corners).as_flattened());
            }
            fn point_positions(&self, corners: &[Vec3; 8]) -> [Vec3; 8] {
                positions(ElementKind::Hex8, corners, GAUSS)
            }
            #[inline(always)]
            fn volumes<L: Lane>(&self, geometry: Geometry<L>) -> [L; 8] {
                volumes(&geometry)
            }
            fn node_shares(&self, corners: &[Vec3; 8]) -> [f64; 8] {
                hexahedron::node_shares(corners)
            }
            #[inline(always)]
            fn strains<L: Lane>(
                &self,
                geometry: Geometry<L>,
                modes: &[[L; 3]; 8],
            ) -> [Strain<L>; 8] {
                $strains(&geometry, modes)
            }
            #[inline(always)]
            fn forces<L: Lane>(
                &self,
                geometry: Geometry<L>,
                stresses: &[Stress<L>; 8],
                _hourglass: &Hourglass<L>,
                _modes: &[[L; 3]; 8],
            ) -> [[L; 3]; 8] {
                $forces(&geometry, stresses)
            }
            #[inline(always)]
            fn modal(&self) -> Option<&impl ModalKernel<8, 8>> {
                Some(&HexahedronModes)
            }
        }
    };
}

/// Strains with the mean dilatation of the element.
#[inline(always)]
fn averaged_strains<L: Lane>(geometry: &Geometry<L>, modes: &[[L; 3]; 8]) -> [Strain<L>; 8] {
    let mut strains = strains(geometry, modes);
    let mut tensors = [strains[0].0; 8];
    for p in 0..8 {
        tensors[p] = strains[p].0;
    }
    let shifts = volumetric_shifts(&volumes(geometry), &tensors);
    for p in 0..8 {
        for i in 0..3 {
            strains[p].0[i] = strains[p].0[i] + shifts[p];
        }
    }
    strains
}

/// Forces that are work-conjugate to the strains with mean dilatation.
#[inline(always)]
fn averaged_forces<L: Lane>(geometry: &Geometry<L>, stresses: &[Stress<L>; 8]) -> [[L; 3]; 8] {
    let mut stresses = *stresses;
    let mut tensors = [stresses[0].0; 8];
    for p in 0..8 {
        tensors[p] = stresses[p].0;
    }
    let shifts = volumetric_shifts(&volumes(geometry), &tensors);
    for p in 0..8 {
        for i in 0..3 {
            stresses[p].0[i] = stresses[p].0[i] + shifts[p];
        }
    }
    forces(geometry, &stresses)
}

integrated_hexahedron!(Hex8Full, "hex8-full", strains, forces);
integrated_hexahedron!(Hex8BBar, "hex8-b-bar", averaged_strains, averaged_forces);
