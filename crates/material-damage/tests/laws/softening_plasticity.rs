//! Softening plasticity against closed forms and an independent return.

use powerhouse_material_damage::{
    Control, ElastoPlastic, MaterialError, MohrCoulomb, MohrCoulombParameters, PointDriver,
    PrincipalAxes, SofteningOf, SofteningPlasticity, SofteningPlasticityParameters, StrengthFall,
    YieldSurface, presets,
};
use powerhouse_model::{ConstitutiveLaw, LawInput, Strain, Stress};

use super::exhaustive::{cut_off_faces, passive_ratio, search, shear_faces};
use super::random::Random;

const ENERGY: f64 = 2.0e3;
const RESIDUAL: f64 = 0.2;

fn plane(dilation: f64) -> MohrCoulombParameters {
    MohrCoulombParameters {
        dilation,
        tension_strength: Some(0.5e6),
        ..presets::PAPER_ROCK
    }
}

pub(crate) fn softening(dilation: f64) -> SofteningPlasticity<MohrCoulomb> {
    let law = SofteningPlasticity::new(SofteningPlasticityParameters {
        surface: MohrCoulomb::new(plane(dilation)).unwrap(),
        fall: StrengthFall::FractureEnergy { energy: ENERGY },
        residual_strength: RESIDUAL,
    });
    law.unwrap()
}

/// `2 c sqrt(N)` of the paper's rock.
fn strength() -> f64 {
    2.0 * 1.05e6 * passive_ratio(42.0).sqrt()
}

/// In uniaxial compression the stress is the softened strength at the plastic shortening, whatever
/// the size of the element, the dilation and the steps; and the strain is elastic and plastic.
#[test]
fn uniaxial_compression_follows_the_curve() {
    for dilation in [0.0, 10.0, 42.0] {
        for size in [0.1, 0.5, 1.0] {
            let rate = size * (1.0 - RESIDUAL) * strength() / ENERGY;
            for steps in [100, 400] {
                let law = softening(dilation);
                law.check_size(size).unwrap();
                let mut point = PointDriver::new(law).with_size(size).unwrap();
                let end = Control::uniaxial(-1.0e-3 - 4.0 / rate);
                let path = point.advance(end, steps).unwrap();
                let mut fallen: f64 = 1.0;
                for record in path.iter().filter(|record| record.history[7] > 0.0) {
                    let k = record.history[7];
                    let share = RESIDUAL + (1.0 - RESIDUAL) * (-rate * k).exp();
                    let (stress, strain) = (record.stress.0[2], record.strain.0[2]);
                    let error = (stress + strength() * share).abs();
                    assert!(error < 1e-10 * strength(), "{size} {k:e}: {stress}");
                    assert!((stress / presets::PAPER_ROCK.medium.young - k - strain).abs() < 1e-12);
                    assert!((record.history[8] - (1.0 - share)).abs() < 1e-12);
                    assert!(record.stress.0[0].abs() < 1e-8 * strength());
                    fallen = fallen.min(share);
                }
                assert!(fallen < 0.25, "{fallen}");
            }
        }
    }
}

/// The work of a band in excess of its residual strength is the fracture energy, for every size that does
/// not snap back; the largest such size is the one at which the softening slope is Young's modulus.
#[test]
fn the_energy_is_that_of_the_band() {
    let law = softening(0.0);
    let young = presets::PAPER_ROCK.medium.young;
    let largest = ENERGY * young / ((1.0 - RESIDUAL) * strength()).powi(2);
    assert!((law.largest_size().unwrap() / largest - 1.0).abs() < 1e-12);
    for size in [0.01, 0.1, 0.99 * largest] {
        let mut point = PointDriver::new(law).with_size(size).unwrap();
        let rate = size * (1.0 - RESIDUAL) * strength() / ENERGY;
        point
            .advance(Control::uniaxial(-strength() / young), 1)
            .unwrap();
        point
            .advance(Control::uniaxial(-20.0 / rate), 20_000)
            .unwrap();
        let state = point.state();
        let held = 0.5 * state.stress.0[2].powi(2) / young;
        let residual = RESIDUAL * strength() * state.history[7];
        let taken = (state.work - held - residual) * size / ENERGY;
        // Trapezoidal work of 20,000 steps of a thousandth of the decay.
        assert!((taken - 1.0).abs() < 1e-5, "{size}: {taken}");
    }
    assert_eq!(
        law.check_size(1.01 * largest),
        Err(MaterialError::SnapBack {
            of: SofteningOf::Shear,
            size: 1.01 * largest,
            largest: law.largest_size().unwrap()
        })
    );
}

/// A trial anywhere, after flow or before, returns to where an exhaustive search over the faces of the
/// softened surface with bisection of the shortening does; none lies outside it.
#[test]
fn returns_solve_the_return_equations() {
    let mut random = Random(211);
    for number in 0..400_u32 {
        let dilation = [0.0, 10.0, 42.0][number as usize % 3];
        let law = softening(dilation);
        let p = *law.parameters().surface.parameters();
        let size = 0.05 + random.unit();
        let rate = size * (1.0 - RESIDUAL) * strength() / ENERGY;
        let share = |k: f64| RESIDUAL + (1.0 - RESIDUAL) * (-rate * k).exp();
        let before = [0.0, 2.0e-3 * random.unit()][number as usize / 3 % 2];
        let mut old = [0.0; 11];
        (old[7], old[8]) = (before, 1.0 - share(before));
        let scale = 10.0_f64.powf(-4.0 + 2.5 * random.unit());
        let strain = random.six().map(|x| scale * x);
        let mut new = [0.0; 11];
        let input = LawInput::new(Strain(strain), &old).with_size(size);
        let stress = law.stress_change(&input, &mut new);
        let medium = p.medium;
        let (lambda, shear) = (medium.lambda(), medium.shear());
        let elastic = Stress::elastic(lambda, shear, &Strain(strain));
        let trial = PrincipalAxes::of(&elastic).values;
        let surface = |s: f64| {
            let (n, m) = (passive_ratio(42.0), passive_ratio(dilation));
            let mut faces = shear_faces(n, m, s * strength());
            faces.extend(cut_off_faces(s * 0.5e6));
            search(&faces, &medium, p.cohesion, dilation == 42.0, trial)
        };
        let shortened = |s: f64| {
            let returned = surface(s);
            let loss: [f64; 3] = core::array::from_fn(|i| trial[i] - returned[i]);
            let sum: f64 = loss.iter().sum();
            let strains =
                loss.map(|x| (x - medium.poisson / (1.0 + medium.poisson) * sum) / (2.0 * shear));
            strains.iter().map(|e| (-e).max(0.0)).sum::<f64>()
        };
        let (mut low, mut high) = (before, before + shortened(RESIDUAL));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if before + shortened(share(middle)) > middle {
                low = middle;
            } else {
                high = middle;
            }
        }
        let expected = surface(share(high));
        let found = PrincipalAxes::of(&stress).values;
        let scale = p
            .cohesion
            .max(trial.iter().fold(0.0_f64, |m, t| m.max(t.abs())));
        for i in 0..3 {
            let error = (found[i] - expected[i]).abs();
            assert!(
                error < 1e-8 * scale,
                "{number}: {found:?} {expected:?} of {trial:?}"
            );
        }
        assert!(
            (new[7] - high).abs() < 1e-8 * high.max(1e-6),
            "{number}: {} {high}",
            new[7]
        );
        // The surface of the new strength, in its own scale.
        let left = 1.0 - new[8];
        let outside = left * law.parameters().surface.excess(&found.map(|s| s / left));
        let size = found.iter().fold(p.cohesion, |m, s| m.max(s.abs()));
        let steep = passive_ratio(42.0);
        assert!(outside < 1e-12 * steep * size, "{number}: {outside:e}");
    }
}

/// The end of a straight path does not depend on the number of increments where flow keeps its
/// direction; with all strength left the law is perfectly plastic.
#[test]
fn increments_do_not_matter() {
    let end = |steps: usize| {
        let mut point = PointDriver::new(softening(10.0)).with_size(0.5).unwrap();
        let path = point
            .advance(Control::triaxial(-1.0e6, -8.0e-3), steps)
            .unwrap();
        path.last().unwrap().clone()
    };
    let whole = end(1);
    for steps in [10, 1000] {
        let parts = end(steps);
        for i in 0..6 {
            assert!((parts.stress.0[i] - whole.stress.0[i]).abs() < 1e-8 * strength());
        }
        for (a, b) in parts.history.iter().zip(&whole.history) {
            assert!((a - b).abs() < 1e-8);
        }
    }
    let residual = SofteningPlasticity::new(SofteningPlasticityParameters {
        residual_strength: 1.0,
        ..*softening(10.0).parameters()
    })
    .unwrap();
    let perfect = ElastoPlastic::new(MohrCoulomb::new(plane(10.0)).unwrap());
    let mut random = Random(5);
    for _ in 0..200 {
        let strain = Strain(random.six().map(|x| 2.0e-3 * x));
        let stresses = [
            residual.stress_change(&LawInput::new(strain, &[0.0; 11]), &mut [0.0; 11]),
            perfect.stress_change(&LawInput::new(strain, &[0.0; 8]), &mut [0.0; 8]),
        ];
        assert_eq!(stresses[0], stresses[1]);
    }
}

/// Tensile opening alone does not soften; parameters out of range are refused by name.
#[test]
fn opening_does_not_soften_and_ranges_are_checked() {
    let mut point = PointDriver::new(softening(0.0)).with_size(0.5).unwrap();
    let path = point.advance(Control::uniaxial(2.0e-3), 50).unwrap();
    let last = path.last().unwrap();
    assert!((last.stress.0[2] - 0.5e6).abs() < 1e-6 && last.history[8] == 0.0);
    let with = |fall, residual_strength| {
        let surface = MohrCoulomb::new(plane(0.0)).unwrap();
        let law = SofteningPlasticity::new(SofteningPlasticityParameters {
            surface,
            fall,
            residual_strength,
        });
        match law {
            Err(MaterialError::Parameter(error)) => error.name,
            _ => "",
        }
    };
    let energy = |energy| StrengthFall::FractureEnergy { energy };
    assert_eq!(with(energy(0.0), 0.5), "energy");
    assert_eq!(with(StrengthFall::Rate(f64::NAN), 0.5), "rate");
    assert_eq!(with(energy(1.0), 0.0), "residual_strength");
    assert_eq!(with(energy(1.0), 1.1), "residual_strength");
}
