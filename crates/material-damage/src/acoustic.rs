//! Growth of short waves in a material that flows.

use core::f64::consts::PI;

use powerhouse_model::{ConstitutiveLaw, LawInput, Strain, Stress};

type Stiffness = nalgebra::Matrix6<f64>;

/// Least and greatest stress (Pa) at which yielding is sought.
const STRESSES: [f64; 2] = [1.0, 1e13];
/// Relative difference from the elastic stress from which on a point yields.
const YIELDS: f64 = 1e-9;
/// Stress behind the yield point over that at it, where the tangent is evaluated.
const BEHIND: f64 = 1.0 + 1e-5;
/// Directions of waves to a half turn: every degree. Every second one misses up to 1.2 % of a rate.
const DIRECTIONS: usize = 180;

/// Rate at which plane waves grow in a material that flows, per wave number (m/s): zero if the flow is well posed; none for a
/// law that never yields so, or without a [tangent](ConstitutiveLaw::tangent).
///
/// Where the acoustic tensor `n . T . n` of the tangent `T` has an eigenvalue `q` that is negative or complex for a direction `n`,
/// a wave of wave number `k` along it grows as `exp(k t |Im sqrt(q / density)|)`: the shorter the faster, so that a mesh makes noise
/// of its own element size, whatever the time step (R. Hill (1962), J. Mech. Phys. Solids 10; J. R. Rice (1976), The localization
/// of plastic deformation). Flow with a dilation far below the friction does so; associated flow does not.
///
/// The state is that of plane-strain compression in which the material yields first, as between the faces of an opening. Softening, by
/// which every crack localises, and which the width of a band governs, is left out: the tangent is that of ideal plasticity with the same
/// surface and flow, `T = C - D / max(1, tr(C^-1 D))` of the law's `C - D`.
pub fn growth_of_flow<M: ConstitutiveLaw>(law: &M) -> Option<f64> {
    let medium = law.medium();
    let history = vec![0.0; law.history().len()];
    let elastic = Stiffness::from_fn(|row, column| {
        let mut unit = Strain::default();
        unit.0[column] = 1.0;
        Stress::elastic(medium.lambda(), medium.shear(), &unit).0[row]
    });
    let compliance = elastic.try_inverse()?;
    let strain = |stress: f64| {
        let uniaxial = nalgebra::Vector6::new(-1.0, -medium.poisson, 0.0, 0.0, 0.0, 0.0);
        let strain = compliance * uniaxial * stress;
        Strain(core::array::from_fn(|i| strain[i]))
    };
    let yields = |stress: f64| {
        let strain = strain(stress);
        let mut new = history.clone();
        let found = law.stress_change(&LawInput::new(strain, &history), &mut new);
        let expected = Stress::elastic(medium.lambda(), medium.shear(), &strain);
        let off = (0..6).map(|i| (found.0[i] - expected.0[i]).abs());
        off.fold(0.0, f64::max) > YIELDS * stress
    };
    let [mut low, mut high] = STRESSES;
    if yields(low) || !yields(high) {
        return None;
    }
    while high > low * (1.0 + 1e-12) {
        let middle = (low * high).sqrt();
        if middle <= low || middle >= high {
            break;
        }
        if yields(middle) {
            high = middle
        } else {
            low = middle
        }
    }
    let tangent = law.tangent(&LawInput::new(strain(BEHIND * high), &history))?;
    let lost = elastic - Stiffness::from_fn(|row, column| tangent[row][column]);
    let ideal = elastic - lost / (compliance * lost).trace().max(1.0);
    Some(growth(&ideal) / medium.density.sqrt())
}

/// Greatest imaginary part of the root of an eigenvalue of the acoustic tensor of a tangent (Pa) over all directions.
fn growth(tangent: &Stiffness) -> f64 {
    let angle = |index: usize| index as f64 * PI / DIRECTIONS as f64;
    let directions =
        (0..DIRECTIONS).flat_map(|turn| (0..=DIRECTIONS / 2).map(move |rise| (turn, rise)));
    directions.fold(0.0, |most: f64, (turn, rise)| {
        let (sine, cosine) = angle(turn).sin_cos();
        let (up, along) = angle(rise).sin_cos();
        let [x, y, z] = [cosine, sine * along, sine * up];
        let strains = nalgebra::Matrix6x3::from_row_slice(&[
            x, 0.0, 0.0, //
            0.0, y, 0.0, //
            0.0, 0.0, z, //
            y, x, 0.0, //
            0.0, z, y, //
            z, 0.0, x,
        ]);
        let acoustic: nalgebra::Matrix3<f64> = strains.transpose() * tangent * strains;
        let eigenvalues = acoustic.complex_eigenvalues();
        let size = acoustic.norm();
        let growths = eigenvalues.iter().map(|value| {
            // Rounding of a double or vanishing eigenvalue.
            let exact = value.im.abs() > 1e-6 * size || value.re < -1e-9 * size;
            if exact { value.sqrt().im.abs() } else { 0.0 }
        });
        growths.fold(most, f64::max)
    })
}
