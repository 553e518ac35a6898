//! Strains of every magnitude, and NaN.

use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, HoekBrown, LeeFenves,
    PrincipalAxes, TwoSurface, YieldSurface, presets,
};
use powerhouse_model::{ConstitutiveLaw, LawInput, Strain, Stress};

use super::hoek_brown::tunnel;
use super::random::Random;
use super::softening_plasticity::softening;

fn respond(law: &impl ConstitutiveLaw, strain: [f64; 6]) -> (Stress, Vec<f64>) {
    let old = vec![0.0; law.history().len()];
    let mut new = old.clone();
    let stress = law.stress_change(&LawInput::new(Strain(strain), &old), &mut new);
    (stress, new)
}

/// Finite results up to a strain of 1e130, and beyond it finite ones or ones that are visibly not
/// finite; the excess (Pa) is that of the effective stress.
fn check(law: &impl ConstitutiveLaw, excess: impl Fn(&Stress, &[f64]) -> f64) {
    let mut random = Random(41);
    for exponent in [
        -308, -300, -150, -20, -5, -3, 0, 20, 100, 130, 200, 280, 300,
    ] {
        for _ in 0..50 {
            let strain = random.six().map(|x| x * 10.0_f64.powi(exponent));
            let (stress, history) = respond(law, strain);
            let finite = stress.0.iter().all(|s| s.is_finite());
            assert!(finite || exponent > 130, "{}: 1e{exponent}", law.name());
            if finite {
                assert!(history.iter().all(|h| h.is_finite()), "1e{exponent}");
                let size = stress.0.iter().fold(1.0e6_f64, |most, s| most.max(s.abs()));
                let outside = excess(&stress, &history);
                assert!(
                    outside < 1e-11 * size,
                    "1e{exponent}: {outside:e} of {size:e}"
                );
            }
        }
    }
    let (stress, history) = respond(law, [0.0; 6]);
    assert_eq!(
        (stress, history.iter().sum::<f64>()),
        (Stress([0.0; 6]), 0.0)
    );
    for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for component in 0..6 {
            let mut strain = [1.0e-5; 6];
            strain[component] = broken;
            let (stress, _) = respond(law, strain);
            assert!(
                !stress.0.iter().all(|s| s.is_finite()),
                "{broken} at {component}"
            );
        }
    }
}

/// Drucker-Prager: strains of every size give an admissible stress or one that is not finite.
#[test]
fn drucker_prager_is_admissible_or_not_finite() {
    for dilation in [0.0, 42.0] {
        let cone = DruckerPrager::new(DruckerPragerParameters {
            medium: presets::PAPER_ROCK.medium,
            friction: 42.0,
            dilation,
            cohesion: 1.05e6,
            fit: ConeFit::Inscribed,
        })
        .unwrap();
        let law = ElastoPlastic::new(cone);
        check(&law, |stress, _| {
            cone.excess(&PrincipalAxes::of(stress).values)
        });
    }
}

/// The surface of listed strengths: strains of every size give an admissible stress or one that is
/// not finite.
#[test]
fn two_surface_is_admissible_or_not_finite() {
    let surface = TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap();
    check(&ElastoPlastic::new(surface), |stress, _| {
        // The yield function is scaled by the ratio of the strengths.
        surface.excess(&PrincipalAxes::of(stress).values) / 13.0
    });
}

/// Plasticity with damage: strains of every size give an admissible stress or one that is not
/// finite.
#[test]
fn plastic_damage_is_admissible_or_not_finite() {
    let law = presets::paper_concrete().unwrap();
    let surface = law.parameters().surface;
    check(&law, |stress, history| {
        let effective = stress.0.map(|s| s / (1.0 - history[10]));
        // Divided by at least a thousandth: so is the rounding.
        1e-3 * surface.excess(&PrincipalAxes::of(&Stress(effective)).values)
    });
}

/// Softening strength: strains of every size give an admissible stress or one that is not finite.
#[test]
fn softening_plasticity_is_admissible_or_not_finite() {
    let law = softening(10.0);
    let surface = law.parameters().surface;
    check(&law, |stress, history| {
        let left = 1.0 - history[8];
        let scaled = Stress(stress.0.map(|s| s / left));
        left * surface.excess(&PrincipalAxes::of(&scaled).values)
    });
}

/// Lee-Fenves: strains of every size give an admissible stress or one that is not finite.
#[test]
fn lee_fenves_is_admissible_or_not_finite() {
    let law = LeeFenves::new(presets::PAPER_CONCRETE_LEE_FENVES).unwrap();
    check(&law, |stress, history| {
        let effective = Stress(stress.0.map(|s| s / (1.0 - history[10])));
        // Divided by at least a thousandth: so is the rounding; the strength may have fallen to a
        // thousandth too.
        1e-6 * 16.7e6 * law.yield_function(&effective, history, 1.0)
    });
}

/// Hoek-Brown: strains of every size give an admissible stress or one that is not finite.
#[test]
fn hoek_brown_is_admissible_or_not_finite() {
    for share in [0.0, 1.0] {
        let surface = HoekBrown::new(tunnel(share)).unwrap();
        check(&ElastoPlastic::new(surface), |stress, _| {
            surface.excess(&PrincipalAxes::of(stress).values)
        });
    }
}
