//! Packs of points against single points.

use powerhouse_material_damage::{
    ConeFit, DampingBand, DruckerPrager, DruckerPragerParameters, ElastoPlastic, FlatDamping,
    HoekBrown, LeeFenves, LeeFenvesParameters, Mazars, MohrCoulomb, MohrCoulombParameters,
    ReferenceFrequency, RelaxationSpectrum, TwoSurface, presets,
};
use powerhouse_model::{ConstitutiveLaw, Lane, LawInput, Scalar, Strain, Stress};

use super::hoek_brown::tunnel;
use super::packs::Pack;
use super::random::Random;
use super::softening_plasticity::softening;

/// Follows random cyclic strains of four points, in packs and one at a time, under an initial stress; the
/// initial content of the new history is a number in the one and NaN in the other.
fn same_bits<S, M: ConstitutiveLaw>(law: &M, amplitude: f64)
where
    S: Lane<Scalar = S, Token = (), Mask = bool> + Scalar,
{
    let mut random = Random(7);
    let variables = law.history().len();
    let zero = S::splat((), 0.0);
    let mut old = vec![Pack::<S, 4>([zero; 4]); variables];
    let mut yielded = 0;
    for step in 0..400 {
        // The first lane stays small, the last is large: lanes yield at different steps. All grow,
        // so that plastic flow goes on.
        let strains: [[S; 6]; 4] = core::array::from_fn(|lane| {
            let size = amplitude * [0.01, 0.3, 1.0, 3.0][lane] * (1.0 + 0.01 * f64::from(step));
            random.six().map(|x| S::from_f64(size * x))
        });
        let initial = S::from_f64(-1.0e6);
        let input_strain = Strain(core::array::from_fn(|i| {
            Pack(core::array::from_fn(|lane| strains[lane][i]))
        }));
        let at = |i: usize| if i < 3 { initial } else { zero };
        let wide_initial = Stress(core::array::from_fn(|i| Pack([at(i); 4])));
        let mut new = vec![Pack([S::from_f64(7.0); 4]); variables];
        let input = LawInput::new(input_strain, &old).with_initial(wide_initial);
        let wide = law.stress_change(&input.with_size(Pack([S::from_f64(0.5); 4])), &mut new);
        for lane in 0..4 {
            let single_old: Vec<S> = old.iter().map(|h| h.0[lane]).collect();
            let mut single_new = vec![S::from_f64(f64::NAN); variables];
            let input = LawInput::new(Strain(strains[lane]), &single_old)
                .with_initial(Stress(core::array::from_fn(at)))
                .with_size(S::from_f64(0.5));
            let single = law.stress_change(&input, &mut single_new);
            for i in 0..6 {
                let pair = [wide.0[i].0[lane].to_f64(), single.0[i].to_f64()];
                assert_eq!(
                    pair[0].to_bits(),
                    pair[1].to_bits(),
                    "{step} {lane} {i} {pair:?}"
                );
            }
            for h in 0..variables {
                let pair = [new[h].0[lane].to_f64(), single_new[h].to_f64()];
                assert_eq!(
                    pair[0].to_bits(),
                    pair[1].to_bits(),
                    "{step} {lane} {h} {pair:?}"
                );
            }
            yielded += usize::from(single_new[0] != single_old[0]);
        }
        old = new;
    }
    assert!(
        yielded > 40,
        "{}: only {yielded} points yielded",
        law.name()
    );
}

/// Mohr-Coulomb: many points at once are the same bits as one at a time, in both precisions.
#[test]
fn mohr_coulomb_is_the_same_wide_and_scalar() {
    for dilation in [0.0, 42.0] {
        let p = MohrCoulombParameters {
            dilation,
            tension_strength: Some(0.5e6),
            ..presets::PAPER_ROCK
        };
        let law = ElastoPlastic::new(MohrCoulomb::new(p).unwrap());
        same_bits::<f64, _>(&law, 1.0e-3);
        same_bits::<f32, _>(&law, 1.0e-3);
    }
}

/// Drucker-Prager: many points at once are the same bits as one at a time, in both precisions.
#[test]
fn drucker_prager_is_the_same_wide_and_scalar() {
    let p = DruckerPragerParameters {
        medium: presets::PAPER_ROCK.medium,
        friction: 42.0,
        dilation: 10.0,
        cohesion: 1.05e6,
        fit: ConeFit::Inscribed,
    };
    let law = ElastoPlastic::new(DruckerPrager::new(p).unwrap());
    same_bits::<f64, _>(&law, 1.0e-3);
    same_bits::<f32, _>(&law, 1.0e-3);
}

/// The surface of listed strengths: many points at once are the same bits as one at a time, in
/// both precisions.
#[test]
fn two_surface_is_the_same_wide_and_scalar() {
    let law = ElastoPlastic::new(TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap());
    same_bits::<f64, _>(&law, 3.0e-4);
    same_bits::<f32, _>(&law, 3.0e-4);
}

/// Hoek-Brown: many points at once are the same bits as one at a time, in both precisions.
#[test]
fn hoek_brown_is_the_same_wide_and_scalar() {
    for share in [0.0, 0.5] {
        let law = ElastoPlastic::new(HoekBrown::new(tunnel(share)).unwrap());
        same_bits::<f64, _>(&law, 1.0e-3);
        same_bits::<f32, _>(&law, 1.0e-3);
    }
}

/// Plasticity with damage: many points at once are the same bits as one at a time, in both
/// precisions.
#[test]
fn plastic_damage_is_the_same_wide_and_scalar() {
    let law = presets::paper_concrete().unwrap();
    same_bits::<f64, _>(&law, 3.0e-4);
    same_bits::<f32, _>(&law, 3.0e-4);
}

/// Softening strength: many points at once are the same bits as one at a time, in both precisions.
#[test]
fn softening_plasticity_is_the_same_wide_and_scalar() {
    for dilation in [0.0, 42.0] {
        same_bits::<f64, _>(&softening(dilation), 1.0e-3);
        same_bits::<f32, _>(&softening(dilation), 1.0e-3);
    }
}

/// Lee-Fenves: many points at once are the same bits as one at a time, in both precisions.
#[test]
fn lee_fenves_is_the_same_wide_and_scalar() {
    let hardening = LeeFenvesParameters {
        compression_limit: 9.0e6,
        tension_damage: 0.6,
        ..presets::PAPER_CONCRETE_LEE_FENVES
    };
    // The ratio of the strengths is rounded in only one of them.
    for parameters in [hardening, presets::PAPER_CONCRETE_LEE_FENVES] {
        let law = LeeFenves::new(parameters).unwrap();
        same_bits::<f64, _>(&law, 3.0e-4);
        same_bits::<f32, _>(&law, 3.0e-4);
    }
}

/// Mazars: many points at once are the same bits as one at a time, in both precisions.
#[test]
fn mazars_is_the_same_wide_and_scalar() {
    let law = Mazars::new(presets::PAPER_CONCRETE_MAZARS).unwrap();
    same_bits::<f64, _>(&law, 3.0e-5);
    same_bits::<f32, _>(&law, 3.0e-5);
}

/// A damped law: many points at once are the same bits as one at a time, in both precisions.
#[test]
fn a_damped_law_is_the_same_wide_and_scalar() {
    let band = DampingBand {
        ratio: 0.05,
        lowest: 0.5,
        highest: 20.0,
        mechanisms: 3,
    };
    let spectrum = RelaxationSpectrum::fit(band).unwrap();
    let concrete = presets::paper_concrete().unwrap();
    let law = FlatDamping::new(concrete, spectrum, ReferenceFrequency::Centre).unwrap();
    let law = law.for_step(1.0e-3);
    same_bits::<f64, _>(&law, 3.0e-4);
    same_bits::<f32, _>(&law, 3.0e-4);
}
