//! Hooke's law.

use powerhouse_model::{
    ConstitutiveLaw, ElasticMedium, HistoryVariable, Lane, LawEnergy, LawInput, Strain, Stress,
};

use crate::ElasticInSeries;
use crate::energy::Step;
use crate::surface::stiffened;

/// Isotropic linear elastic law without history.
///
/// `sigma = lambda tr(epsilon) I + 2 G epsilon`
///
/// Valid at small strain; without a strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic {
    medium: ElasticMedium,
    lambda: f64,
    shear: f64,
}

impl LinearElastic {
    /// Law of the given medium.
    pub fn new(medium: ElasticMedium) -> Self {
        Self {
            medium,
            lambda: medium.lambda(),
            shear: medium.shear(),
        }
    }
}

impl ConstitutiveLaw for LinearElastic {
    const LINEAR: bool = true;

    fn name(&self) -> &str {
        "linear-elastic"
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &[]
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
        let token = input.strain.0[0].token();
        let lambda = L::splat(token, self.lambda);
        let shear = L::splat(token, self.shear);
        Stress::elastic(lambda, shear, &input.strain)
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, _new_history: &[L]) -> Option<LawEnergy<L>> {
        let step = Step {
            medium: &self.medium,
            input,
            elastic: input.strain,
            flowed: None,
            damage: [input.strain.0[0].constant(0.0); 2],
        };
        Some(step.energy())
    }
    fn tangent(&self, _input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        let mut rows = [[0.0; 6]; 6];
        for column in 0..6 {
            let mut unit = Strain::default();
            unit.0[column] = 1.0;
            let stress = Stress::elastic(self.lambda, self.shear, &unit);
            for row in 0..6 {
                rows[row][column] = stress.0[row];
            }
        }
        Some(rows)
    }
}

impl ElasticInSeries for LinearElastic {
    fn with_stiffness(&self, factor: f64) -> Self {
        Self::new(stiffened(&self.medium, factor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media;
    use powerhouse_model::{Mat3, Scalar, Vec3};

    fn stress<L: Lane>(law: &LinearElastic, strain: [L; 6]) -> [L; 6] {
        law.stress_change(&LawInput::new(Strain(strain), &[]), &mut [])
            .0
    }

    /// In uniaxial stress the axial stress is Young's modulus times the strain, and the lateral stress
    /// is zero.
    #[test]
    fn uniaxial_stress_is_young_times_stretch() {
        let medium = media::ROCK;
        let law = LinearElastic::new(medium);
        let side = -medium.poisson * 1.0e-3;
        let [xx, yy, zz, xy, yz, zx] = stress(&law, [1.0e-3, side, side, 0.0, 0.0, 0.0]);
        let expected = medium.young * 1.0e-3;
        assert!((xx - expected).abs() < 1e-14 * expected);
        // lambda and 2 G cancel: the remainder is the rounding error of the stress of each.
        assert!(yy.abs() < 1e-14 * expected && zz.abs() < 1e-14 * expected);
        assert_eq!([xy, yz, zx], [0.0; 3]);
    }

    /// Under equal strains in all directions the stress is three bulk moduli times the strain, without shear.
    #[test]
    fn hydrostatic_stress_is_three_bulk_moduli_times_stretch() {
        let medium = media::CONCRETE;
        let law = LinearElastic::new(medium);
        let result = stress(&law, [-2.0e-4, -2.0e-4, -2.0e-4, 0.0, 0.0, 0.0]);
        let expected = -3.0 * medium.bulk() * 2.0e-4;
        for value in &result[..3] {
            assert!((value - expected).abs() < 1e-14 * expected.abs());
        }
        assert_eq!(result[3..], [0.0; 3]);
    }

    /// The stress of each engineering shear strain is the shear modulus times that strain alone.
    #[test]
    fn shear_stress_is_shear_modulus_times_engineering_strain() {
        let medium = media::ROCK;
        let law = LinearElastic::new(medium);
        for component in 3..6 {
            let mut strain = [0.0; 6];
            strain[component] = 5.0e-5;
            let mut expected = [0.0; 6];
            expected[component] = medium.shear() * 5.0e-5;
            assert_eq!(stress(&law, strain), expected);
        }
    }

    /// The law has no preferred direction: the stress of a rotated strain is the rotated stress.
    #[test]
    fn the_law_is_isotropic() {
        let law = LinearElastic::new(media::ROCK);
        let strain = Mat3::new(
            3.0e-4, -1.0e-4, 2.0e-4, //
            -1.0e-4, -2.0e-4, 0.5e-4, //
            2.0e-4, 0.5e-4, 1.0e-4,
        );
        let axis = Vec3::new(0.3, -0.5, 0.8).normalize();
        let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_unchecked(axis), 0.7);
        let turn = turn.matrix();
        let direct = Stress(stress(&law, Strain::from_gradient(&strain).0)).matrix();
        let turned_strain = turn * strain * turn.transpose();
        let turned = Stress(stress(&law, Strain::from_gradient(&turned_strain).0)).matrix();
        assert!((turned - turn * direct * turn.transpose()).norm() < 1e-14 * direct.norm());
    }

    /// The single-precision lane is the same function, up to its rounding.
    #[test]
    fn single_precision_agrees_with_double() {
        let law = LinearElastic::new(media::CONCRETE);
        let strain = [3.0e-4, -1.0e-4, 2.0e-4, 5.0e-5, -7.0e-5, 1.0e-4];
        let double = stress(&law, strain);
        let single = stress(&law, strain.map(f32::from_f64));
        let scale = double.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
        for (wide, narrow) in double.iter().zip(single) {
            assert!((wide - f64::from(narrow)).abs() < 4.0 * f64::from(f32::EPSILON) * scale);
        }
    }

    /// The tangent is the derivative of the stress, which for a linear law is the stress of each unit
    /// strain.
    #[test]
    fn the_tangent_maps_strain_to_stress() {
        let law = LinearElastic::new(media::ROCK);
        let strain = [3.0e-4, -1.0e-4, 2.0e-4, 5.0e-5, -7.0e-5, 1.0e-4];
        let direct = stress(&law, strain);
        let tangent = law.tangent(&LawInput::new(Strain(strain), &[])).unwrap();
        for row in 0..6 {
            let product: f64 = (0..6).map(|i| tangent[row][i] * strain[i]).sum();
            assert!((product - direct[row]).abs() < 1e-14 * 1.0e7);
        }
    }
}
