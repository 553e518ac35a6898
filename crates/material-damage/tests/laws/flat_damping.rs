//! Constant damping over a band, alone and in series with plastic flow.

use core::f64::consts::TAU;

use nalgebra::Complex;
use powerhouse_material_damage::{
    DampingBand, ElastoPlastic, FlatDamping, LeeFenves, LinearElastic, Mazars, MazarsParameters,
    MazarsTension, MohrCoulomb, PlasticDamage, PlasticDamageParameters, ReferenceFrequency,
    RelaxationSpectrum, SofteningPlasticity, SofteningPlasticityParameters, StrengthFall,
    YieldSurface, media, presets,
};
use powerhouse_model::{ConstitutiveLaw, ElasticMedium, HistoryKind, LawInput, Strain, Stress};

use super::random::Random;

fn band(ratio: f64, lowest: f64, highest: f64, mechanisms: usize) -> DampingBand {
    DampingBand {
        ratio,
        lowest,
        highest,
        mechanisms,
    }
}

/// The fitted frequencies, weights and deviations are those of an independent minimax fit
/// (a linear program of the deviations, solved anew for every step of the frequencies).
#[test]
fn the_fit_is_the_minimax_one() {
    // ratio, band, frequencies, weights, largest deviation (given to two digits).
    type Row = (f64, [f64; 2], &'static [f64], &'static [f64], f64);
    let table: &[Row] = &[
        (
            0.05,
            [0.5, 20.0],
            &[0.89923, 13.429],
            &[0.204518, 0.253807],
            0.082,
        ),
        (
            0.005,
            [0.5, 20.0],
            &[0.47904, 3.17978, 21.204],
            &[0.015723, 0.011276, 0.016223],
            0.012,
        ),
        (
            0.05,
            [0.5, 20.0],
            &[0.51306, 3.34114, 22.782],
            &[0.164642, 0.135480, 0.225007],
            0.012,
        ),
        (
            0.10,
            [0.5, 20.0],
            &[0.55151, 3.52640, 24.721],
            &[0.344098, 0.327389, 0.640035],
            0.012,
        ),
        (
            0.05,
            [0.5, 20.0],
            &[0.36358, 1.71319, 6.35143, 31.754],
            &[0.149766, 0.101074, 0.110498, 0.216813],
            0.002,
        ),
        (
            0.05,
            [0.1, 50.0],
            &[0.36957, 17.315],
            &[0.278101, 0.359809],
            0.29,
        ),
        (
            0.10,
            [0.1, 50.0],
            &[0.12854, 0.97185, 6.54307, 53.784],
            &[0.364476, 0.370432, 0.472045, 0.885133],
            0.022,
        ),
    ];
    for &(ratio, [lowest, highest], frequencies, weights, deviation) in table {
        let fit = RelaxationSpectrum::fit(band(ratio, lowest, highest, weights.len())).unwrap();
        for (mechanism, (frequency, weight)) in
            fit.mechanisms().iter().zip(frequencies.iter().zip(weights))
        {
            let offset = (mechanism.frequency / frequency - 1.0).abs();
            let size = (mechanism.weight / weight - 1.0).abs();
            assert!(offset < 1.0e-4 && size < 1.0e-4, "{fit:?}");
        }
        let half_digit = if deviation > 0.1 { 0.005 } else { 0.0005 };
        assert!((fit.deviation() - deviation).abs() < half_digit, "{fit:?}");
    }
}

/// Over a wide range of bands and ratios a fit is found whose deviation alternates between equal
/// extremes, which makes it the best there is, and which falls with the number of mechanisms.
#[test]
fn every_permitted_band_is_fitted() {
    for ratio in [1.0e-5, 0.01, 0.05, 0.2] {
        for width in [2.0, 10.0, 100.0, 1000.0] {
            let mut last = f64::INFINITY;
            for mechanisms in 2..=4 {
                let fit = RelaxationSpectrum::fit(band(ratio, 0.3, 0.3 * width, mechanisms));
                let fit = fit.unwrap();
                let looks = 4000;
                let mut extremes: Vec<f64> = Vec::new();
                for i in 0..=looks {
                    let frequency = 0.3 * width.powf(f64::from(i) / f64::from(looks));
                    let error = fit.damping_ratio(frequency) / ratio - 1.0;
                    match extremes.last_mut() {
                        Some(last) if *last * error > 0.0 => {
                            if error.abs() > last.abs() {
                                *last = error;
                            }
                        }
                        _ => extremes.push(error),
                    }
                }
                assert_eq!(extremes.len(), 2 * mechanisms + 1, "{fit:?} {extremes:?}");
                for extreme in &extremes {
                    let size = extreme.abs() / fit.deviation();
                    assert!((size - 1.0).abs() < 1.0e-3, "{fit:?} {extremes:?}");
                }
                assert!(fit.deviation() < last, "{fit:?}");
                last = fit.deviation();
            }
        }
    }
}

/// The stress amplitude and phase of a point under harmonic strain, as a complex modulus (Pa),
/// after its transients.
fn measured(law: &impl ConstitutiveLaw, frequency: f64, step: f64) -> Complex<f64> {
    let law = law.for_step(step);
    let mut old = vec![0.0; law.history().len()];
    let mut new = old.clone();
    let cycle = (1.0 / (frequency * step)).round() as usize;
    let step_angle = TAU / cycle as f64;
    // Transients of the slowest mechanism decay within seconds.
    let first = cycle * (20.0 * frequency).ceil() as usize;
    let mut sum = Complex::new(0.0, 0.0);
    for number in 0..first + cycle {
        let angle = step_angle * number as f64;
        let mut strain = Strain::default();
        strain.0[3] = 1.0e-6 * angle.cos();
        let stress = law.stress_change(&LawInput::new(strain, &old), &mut new);
        core::mem::swap(&mut old, &mut new);
        if number >= first {
            sum += Complex::from_polar(stress.0[3], -angle);
        }
    }
    sum * (2.0 / cycle as f64 / 1.0e-6)
}

/// Damping of 5 % over 0.5 to 20 Hz by three mechanisms is 5 +- 0.5 % by the loss factor
/// throughout, in steps as a mesh of rock takes them, and waves at the reference frequency have
/// the speed of the medium.
#[test]
fn the_discrete_point_is_damped_evenly() {
    let medium = media::ROCK;
    let spectrum = RelaxationSpectrum::fit(band(0.05, 0.5, 20.0, 3)).unwrap();
    let law = FlatDamping::new(
        LinearElastic::new(medium),
        spectrum,
        ReferenceFrequency::Centre,
    );
    let law = law.unwrap();
    for frequency in [0.5, 0.8, 1.6, 3.2, 6.4, 12.5, 20.0] {
        let modulus = measured(&law, frequency, 5.0e-4);
        let ratio = 0.5 * modulus.im / modulus.re;
        let speed = 1.0 / (modulus / medium.shear()).sqrt().inv().re;
        println!(
            "{frequency:5.1} Hz: {:.3} % of critical, speed {speed:.4} of the medium's",
            100.0 * ratio
        );
        assert!((ratio - 0.05).abs() < 0.005, "{frequency}: {ratio}");
        assert!((speed / law.velocity(frequency) - 1.0).abs() < 1.0e-3);
    }
    let centre = law.spectrum().unwrap().centre();
    assert!((law.velocity(centre) - 1.0).abs() < 1.0e-12);
}

/// The discrete modulus tends to the closed form with the second power of the step.
#[test]
fn the_discrete_modulus_converges() {
    let medium = media::ROCK;
    let spectrum = RelaxationSpectrum::fit(band(0.05, 0.5, 20.0, 2)).unwrap();
    let exact = spectrum.modulus(4.0) * medium.shear();
    let law = FlatDamping::new(
        LinearElastic::new(medium),
        spectrum,
        ReferenceFrequency::Static,
    );
    let law = law.unwrap();
    let error = |step: f64| (measured(&law, 4.0, step) - exact).norm();
    let slope = (error(1.0e-2) / error(2.5e-3)).log2() / 2.0;
    assert!((slope - 2.0).abs() < 0.1, "{slope}");
}

/// Yield holds for the total stress, the viscous part included: amplitudes of 3 and 10 yield
/// strains at 10 Hz never leave the surface.
#[test]
fn the_strength_is_never_exceeded() {
    let surface = MohrCoulomb::new(presets::PAPER_ROCK).unwrap();
    let spectrum = RelaxationSpectrum::fit(band(0.05, 0.5, 20.0, 3)).unwrap();
    let rock = ElastoPlastic::new(surface);
    let law = FlatDamping::new(rock, spectrum, ReferenceFrequency::Centre).unwrap();
    let law = law.for_step(5.0e-4);
    for amplitude in [3.0, 10.0] {
        let strain_at_yield = 0.5e6 / surface.medium().shear();
        let mut old = vec![0.0; law.history().len()];
        let mut new = old.clone();
        let mut flowed = 0;
        for number in 0..2000 {
            let strain =
                amplitude * strain_at_yield * (TAU * 10.0 * 5.0e-4 * f64::from(number)).sin();
            let strain = Strain([0.2 * strain, 0.0, -0.3 * strain, 0.0, strain, 0.0]);
            let stress = law.stress_change(&LawInput::new(strain, &old), &mut new);
            core::mem::swap(&mut old, &mut new);
            let axes = powerhouse_material_damage::PrincipalAxes::of(&stress);
            let size = axes.values[0].abs().max(axes.values[2].abs()).max(1.0e6);
            assert!(surface.excess(&axes.values) < 1.0e-10 * size, "{stress:?}");
            flowed += usize::from(new[7] != 0.0);
        }
        assert!(flowed > 500, "{flowed}");
    }
}

/// A law without a time step is that of its springs, with moduli softer by the square of
/// the static wave speed and the same strengths, bit for bit; an initial stress without strain does
/// not relax in any number of steps.
#[test]
fn static_stress_is_that_of_the_springs() {
    let mut random = Random(3);
    let spectrum = RelaxationSpectrum::fit(band(0.05, 0.5, 20.0, 2)).unwrap();
    let surface = MohrCoulomb::new(presets::PAPER_ROCK).unwrap();
    let rock = ElastoPlastic::new(surface);
    let damped = FlatDamping::new(rock, spectrum.clone(), ReferenceFrequency::Centre).unwrap();
    let softer = spectrum.velocity(spectrum.centre()).powi(-2);
    let springs = ElastoPlastic::new(surface.with_stiffness(softer));
    let own = rock.history().len();
    for _ in 0..100 {
        let strain = Strain(random.six().map(|x| 1.0e-3 * x));
        let (old, mut new) = (vec![0.0; own + 12], vec![0.0; own + 12]);
        let stress = damped.stress_change(&LawInput::new(strain, &old), &mut new);
        let mut plain = vec![0.0; own];
        let expected = springs.stress_change(&LawInput::new(strain, &old[..own]), &mut plain);
        assert_eq!(stress.0, expected.0);
        assert_eq!(new[..own], plain);
    }
    let law = damped.for_step(1.0e-3);
    let initial = Stress([-1.0e6, -2.0e6, -3.0e6, 0.0, 2.0e5, 0.0]);
    let mut old = vec![0.0; own + 12];
    let mut new = old.clone();
    for _ in 0..1000 {
        let input = LawInput::new(Strain::default(), &old).with_initial(initial);
        assert_eq!(law.stress_change(&input, &mut new).0, [0.0; 6]);
        core::mem::swap(&mut old, &mut new);
    }
}

/// A state in equilibrium, elastic, yielding or cracked, is constant in steps of any length: stress and
/// history are those of the static law, to rounding.
#[test]
fn an_equilibrium_state_is_constant_in_steps_of_any_length() {
    fn stays(law: &impl ConstitutiveLaw, size: f64) {
        let count = law.history().len();
        let mut random = Random(23);
        for _ in 0..20 {
            let strain = Strain(random.six().map(|x| size * x));
            let (zero, mut rest) = (vec![0.0; count], vec![0.0; count]);
            let still = law.stress_change(&LawInput::new(strain, &zero).with_size(0.3), &mut rest);
            let largest = still.0.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
            for step in [1.0e-6, 1.0e-3, 1.0] {
                let law = law.for_step(step);
                let (mut old, mut new) = (rest.clone(), rest.clone());
                for _ in 0..100 {
                    let input = LawInput::new(strain, &old).with_size(0.3);
                    let stress = law.stress_change(&input, &mut new);
                    core::mem::swap(&mut old, &mut new);
                    for i in 0..6 {
                        let change = (stress.0[i] - still.0[i]).abs();
                        assert!(change < 1.0e-12 * largest, "{step}: {stress:?} {still:?}");
                    }
                }
                // The yield state may change, the other variables may not.
                for (variable, (now, then)) in law.history().iter().zip(old.iter().zip(&rest)) {
                    let stays = (now - then).abs() < 1.0e-11 * then.abs().max(size);
                    assert!(stays || variable.kind == HistoryKind::Flags, "{variable:?}");
                }
            }
        }
    }
    let spectrum = RelaxationSpectrum::fit(band(0.05, 0.5, 20.0, 3)).unwrap();
    for reference in [ReferenceFrequency::Centre, ReferenceFrequency::Static] {
        let elastic = LinearElastic::new(media::ROCK);
        stays(
            &FlatDamping::new(elastic, spectrum.clone(), reference).unwrap(),
            1.0e-4,
        );
        let rock = ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK).unwrap());
        stays(
            &FlatDamping::new(rock, spectrum.clone(), reference).unwrap(),
            1.0e-3,
        );
        let concrete = presets::paper_concrete().unwrap();
        stays(
            &FlatDamping::new(concrete, spectrum.clone(), reference).unwrap(),
            3.0e-4,
        );
        stays(
            &FlatDamping::new(lee_fenves(), spectrum.clone(), reference).unwrap(),
            3.0e-4,
        );
        stays(
            &FlatDamping::new(softening_rock(), spectrum.clone(), reference).unwrap(),
            1.0e-3,
        );
        for tension in TENSIONS {
            stays(
                &FlatDamping::new(mazars(tension), spectrum.clone(), reference).unwrap(),
                3.0e-4,
            );
        }
    }
}

fn lee_fenves() -> LeeFenves {
    LeeFenves::new(presets::eurocode_lee_fenves(30.0).unwrap()).unwrap()
}

fn softening_rock() -> SofteningPlasticity<MohrCoulomb> {
    SofteningPlasticity::new(SofteningPlasticityParameters {
        surface: MohrCoulomb::new(presets::PAPER_ROCK).unwrap(),
        fall: StrengthFall::FractureEnergy { energy: 2.0e3 },
        residual_strength: 0.2,
    })
    .unwrap()
}

const TENSIONS: [MazarsTension; 3] = [
    MazarsTension::FractureEnergy { energy: 150.0 },
    MazarsTension::FallingStress { energy: 100.0 },
    MazarsTension::Rates {
        share: 0.9,
        rate: 1.5e4,
    },
];

fn mazars(tension: MazarsTension) -> Mazars {
    Mazars::new(MazarsParameters {
        medium: ElasticMedium::new(30.0e9, 0.2, 2400.0).unwrap(),
        threshold: 1.0e-4,
        tension,
        compression_share: 1.2,
        compression_rate: 1500.0,
        residual_stiffness: 1.0e-6,
    })
    .unwrap()
}

/// Concrete that has softened in statics does not regain strength in the motion that follows: pulled on at once, up to three
/// times as far, its stress never exceeds that at the start of the motion.
#[test]
fn a_crack_of_statics_does_not_heal_in_the_motion() {
    let spectrum = RelaxationSpectrum::fit(band(0.08, 0.5, 20.0, 3)).unwrap();
    let law = FlatDamping::new(lee_fenves(), spectrum, ReferenceFrequency::Centre).unwrap();
    let pulled = |strain: f64| Strain([strain, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for opened in [2.0e-4, 4.0e-4, 8.0e-4] {
        let mut old = vec![0.0; law.history().len()];
        let mut new = old.clone();
        let input = LawInput::new(pulled(opened), &old).with_size(0.3);
        let start = law.stress_change(&input, &mut new).0[0];
        core::mem::swap(&mut old, &mut new);
        let moving = law.for_step(1.0e-5);
        for number in 1..=200 {
            let strain = pulled(opened * (1.0 + 0.01 * f64::from(number)));
            let input = LawInput::new(strain, &old).with_size(0.3);
            let stress = moving.stress_change(&input, &mut new).0[0];
            core::mem::swap(&mut old, &mut new);
            assert!(
                stress <= start * (1.0 + 1e-12),
                "{opened}: {stress} {start}"
            );
        }
    }
}

/// The work that random motions do on a damped point from rest is never negative, whatever the
/// law and the step: elastic, with plastic flow, with damage.
#[test]
fn the_work_of_any_motion_is_not_negative() {
    fn least_work<M: ConstitutiveLaw>(law: &M, size: f64, step: f64) -> f64 {
        let law = law.for_step(step);
        let mut random = Random(11);
        let mut least = f64::INFINITY;
        for _ in 0..20 {
            let mut old = vec![0.0; law.history().len()];
            let mut new = old.clone();
            let (mut work, mut scale) = (0.0, 0.0);
            let mut strain = Strain::default();
            let mut stress = Stress([0.0; 6]);
            let mut rate = [0.0; 6];
            for _ in 0..500 {
                let kick = random.six();
                let mut next = strain;
                for i in 0..6 {
                    rate[i] = 0.95 * rate[i] + 0.05 * size * kick[i];
                    next.0[i] = 0.98 * next.0[i] + rate[i];
                }
                let change = Strain(core::array::from_fn(|i| next.0[i] - strain.0[i]));
                let input = LawInput::new(next, &old).with_size(0.3);
                let after = law.stress_change(&input, &mut new);
                core::mem::swap(&mut old, &mut new);
                let done = 0.5 * (stress + after).work(&change);
                work += done;
                scale += done.abs();
                least = least.min(work / scale);
                (strain, stress) = (next, after);
            }
        }
        least
    }
    let spectrum = RelaxationSpectrum::fit(band(0.1, 0.5, 20.0, 3)).unwrap();
    let reference = ReferenceFrequency::Centre;
    for step in [1.0e-4, 1.0e-2, 1.0] {
        let elastic = LinearElastic::new(media::ROCK);
        let elastic = FlatDamping::new(elastic, spectrum.clone(), reference).unwrap();
        let least = least_work(&elastic, 1.0e-4, step);
        assert!(least > -1.0e-12, "elastic, {step}: {least:e}");
        let rock = ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK).unwrap());
        let rock = FlatDamping::new(rock, spectrum.clone(), reference).unwrap();
        let least = least_work(&rock, 1.0e-3, step);
        assert!(least > -1.0e-12, "plastic, {step}: {least:e}");
        // Without recovery: cracks that close give energy back, damped or not.
        let concrete = *presets::paper_concrete().unwrap().parameters();
        let concrete = PlasticDamage::new(PlasticDamageParameters {
            stiffness_recovery: 0.0,
            ..concrete
        });
        let concrete = FlatDamping::new(concrete.unwrap(), spectrum.clone(), reference).unwrap();
        let least = least_work(&concrete, 1.0e-4, step);
        assert!(least > -1.0e-12, "damaged, {step}: {least:e}");
    }
}

/// Invalid bands and reference frequencies are refused by name.
#[test]
fn impossible_bands_are_refused() {
    for (band, name) in [
        (band(0.0, 0.5, 20.0, 2), "ratio"),
        (band(0.3, 0.5, 20.0, 2), "ratio"),
        (band(f64::NAN, 0.5, 20.0, 2), "ratio"),
        (band(0.05, 0.0, 20.0, 2), "lowest"),
        (band(0.05, 0.5, 0.6, 2), "highest"),
        (band(0.05, 0.5, 600.0, 2), "highest"),
        (band(0.05, 0.5, 20.0, 1), "mechanisms"),
        (band(0.05, 0.5, 20.0, 5), "mechanisms"),
    ] {
        assert_eq!(RelaxationSpectrum::fit(band).unwrap_err().name, name);
    }
    let spectrum = RelaxationSpectrum::fit(band(0.05, 0.5, 20.0, 2)).unwrap();
    let law = LinearElastic::new(media::ROCK);
    let refused = FlatDamping::new(law, spectrum, ReferenceFrequency::At(0.0));
    assert_eq!(refused.unwrap_err().name, "reference");
}

/// An undamped law of the damped type equals the law itself to the last bit, in steps too:
/// medium, history, energy and tangent.
#[test]
fn without_damping_the_law_is_as_it_is() {
    let law = presets::paper_concrete().unwrap();
    let bare = FlatDamping::none(law);
    assert_eq!(bare.medium(), law.medium());
    assert_eq!(bare.history(), law.history());
    assert!(bare.spectrum().is_none() && bare.velocity(3.0) == 1.0);
    let mut random = Random(17);
    for other in [bare.clone(), bare.for_step(1.0e-3)] {
        assert!(!other.relaxes());
        let mut old = [0.0; 15];
        for _ in 0..100 {
            let strain = Strain(random.six().map(|x| 3.0e-4 * x));
            let (mut new, mut same) = (old, old);
            let input = LawInput::new(strain, &old).with_size(0.2);
            let stress = law.stress_change(&input, &mut new);
            assert_eq!(other.stress_change(&input, &mut same), stress);
            assert_eq!(same, new);
            assert_eq!(other.energy(&input, &same), law.energy(&input, &new));
            assert_eq!(other.tangent(&input), law.tangent(&input));
            old = new;
        }
        assert!(old[8] > 0.0);
    }
}
