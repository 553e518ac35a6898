//! Tangents against difference quotients.

use powerhouse_material_damage::{
    ConeFit, DampingBand, DruckerPrager, DruckerPragerParameters, ElastoPlastic, FlatDamping,
    HoekBrown, LeeFenves, LeeFenvesParameters, Mazars, MohrCoulomb, MohrCoulombParameters,
    PlasticDamage, PlasticDamageParameters, ReferenceFrequency, RelaxationSpectrum, Softening,
    TwoSurface, presets,
};
use powerhouse_model::{ConstitutiveLaw, LawInput, Strain, Stress};

use super::hoek_brown::tunnel;
use super::random::Random;
use super::softening_plasticity::softening;

/// Compares the tangent of a law in an element of 0.2 m with difference quotients at random strains.
fn check(law: &impl ConstitutiveLaw, amplitude: f64) {
    let variables = law.history().len();
    let young = law.medium().young;
    let mut random = Random(101);
    let (mut compared, mut flowing) = (0, 0);
    for case in 0..300 {
        // Plastic strain of a step before, or none; and an initial stress.
        let initial = Stress(random.six().map(|x| 2.0e4 * x));
        let is_sound = case % 4 == 0;
        let size = if is_sound { 1.0e-3 } else { 1.0 };
        let strain = random.six().map(|x| size * amplitude * x);
        let mut old = vec![0.0; variables];
        let none = old.clone();
        let input = LawInput::new(Strain(strain), &none)
            .with_initial(initial)
            .with_size(0.2);
        law.stress_change(&input, &mut old);
        let size = 0.1 * size * amplitude;
        let strain: [f64; 6] = core::array::from_fn(|i| strain[i] + size * random.signed());
        let respond = |strain: [f64; 6]| {
            let mut new = vec![0.0; variables];
            let input = LawInput::new(Strain(strain), &old)
                .with_initial(initial)
                .with_size(0.2);
            (law.stress_change(&input, &mut new), new)
        };
        let (here, new) = respond(strain);
        let input = LawInput::new(Strain(strain), &old)
            .with_initial(initial)
            .with_size(0.2);
        let tangent = law.tangent(&input).unwrap();
        let step = 1.0e-6 * amplitude;
        for column in 0..6 {
            let moved = |by: f64| {
                let mut strain = strain;
                strain[column] += by;
                respond(strain).0
            };
            let (after, before) = (moved(step), moved(-step));
            let sides: [[f64; 6]; 2] = [
                core::array::from_fn(|i| (after.0[i] - here.0[i]) / step),
                core::array::from_fn(|i| (here.0[i] - before.0[i]) / step),
            ];
            // At a kink there is no derivative.
            if (0..6).any(|i| (sides[0][i] - sides[1][i]).abs() > 1e-3 * young) {
                continue;
            }
            compared += 1;
            flowing += usize::from(new != old);
            for row in 0..6 {
                let quotient = 0.5 * (sides[0][row] + sides[1][row]);
                let error = (tangent[row][column] - quotient).abs();
                assert!(
                    error < 1e-5 * young,
                    "{} {case}: {row} {column}: {} {quotient}",
                    law.name(),
                    tangent[row][column]
                );
            }
        }
    }
    assert!(
        compared > 1200 && flowing > 400,
        "{}: {compared} {flowing}",
        law.name()
    );
}

/// The tangents of all surfaces are the derivatives of their returns, on faces, edges and apex,
/// elastic too, under an initial stress and after flow.
#[test]
fn tangents_are_derivatives() {
    for dilation in [0.0, 10.0, 42.0] {
        let plane = MohrCoulombParameters {
            dilation,
            tension_strength: Some(0.5e6),
            ..presets::PAPER_ROCK
        };
        check(
            &ElastoPlastic::new(MohrCoulomb::new(plane).unwrap()),
            1.0e-3,
        );
        let cone = DruckerPragerParameters {
            medium: presets::PAPER_ROCK.medium,
            friction: 42.0,
            dilation,
            cohesion: 1.05e6,
            fit: ConeFit::Inscribed,
        };
        check(
            &ElastoPlastic::new(DruckerPrager::new(cone).unwrap()),
            1.0e-3,
        );
    }
    let listed = TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap();
    check(&ElastoPlastic::new(listed), 5.0e-4);
    for share in [0.0, 0.5, 1.0] {
        let surface = HoekBrown::new(tunnel(share)).unwrap();
        check(&ElastoPlastic::new(surface), 1.0e-3);
    }
}

/// The tangents of laws that soften and crack are their derivatives too, whether a point loads or
/// unloads, in tension, compression and between, and with damping in series.
#[test]
fn tangents_of_damage_are_derivatives() {
    for dilation in [0.0, 10.0] {
        check(&softening(dilation), 1.0e-3);
    }
    check(&presets::paper_concrete().unwrap(), 3.0e-4);
    let listed = PlasticDamage::new(PlasticDamageParameters {
        surface: TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap(),
        tension: Softening::Rates {
            share: 0.9,
            rate: 5.0e3,
            threshold: 2.0e-5,
        },
        compression: Softening::Rates {
            share: 0.95,
            rate: 500.0,
            threshold: 1.0e-5,
        },
        stiffness_recovery: 0.7,
        residual_stiffness: 1.0e-3,
    });
    check(&listed.unwrap(), 5.0e-4);
    for (limit, damage) in [(16.7e6, 1.0), (9.0e6, 0.6)] {
        let law = LeeFenves::new(LeeFenvesParameters {
            compression_limit: limit,
            tension_damage: damage,
            ..presets::PAPER_CONCRETE_LEE_FENVES
        });
        check(&law.unwrap(), 4.0e-4);
    }
    check(
        &Mazars::new(presets::PAPER_CONCRETE_MAZARS).unwrap(),
        2.0e-4,
    );
    let band = DampingBand {
        ratio: 0.05,
        lowest: 0.5,
        highest: 20.0,
        mechanisms: 2,
    };
    let spectrum = RelaxationSpectrum::fit(band).unwrap();
    let concrete = presets::paper_concrete().unwrap();
    let damped = FlatDamping::new(concrete, spectrum, ReferenceFrequency::Centre).unwrap();
    check(&damped, 3.0e-4);
    check(&damped.for_step(1.0e-3), 3.0e-4);
}
