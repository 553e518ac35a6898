//! Laws in rotated frames, and energy along random paths.

use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, HoekBrown, LeeFenves,
    LeeFenvesParameters, Mazars, MohrCoulomb, MohrCoulombParameters, PlasticDamage,
    PlasticDamageParameters, Softening, TwoSurface, presets,
};
use powerhouse_model::{ConstitutiveLaw, LawInput, Mat3, Strain, Stress};
use proptest::prelude::*;

use super::hoek_brown::tunnel;
use super::random::Random;
use super::softening_plasticity::softening;

fn mohr_coulomb(dilation: f64) -> MohrCoulomb {
    MohrCoulomb::new(MohrCoulombParameters {
        dilation,
        ..presets::PAPER_ROCK
    })
    .unwrap()
}

fn cone() -> DruckerPrager {
    DruckerPrager::new(DruckerPragerParameters {
        medium: presets::PAPER_ROCK.medium,
        friction: 42.0,
        dilation: 10.0,
        cohesion: 1.05e6,
        fit: ConeFit::Inscribed,
    })
    .unwrap()
}

fn listed() -> TwoSurface {
    TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap()
}

fn damaging() -> PlasticDamage<TwoSurface> {
    let by_energy = |energy| Softening::FractureEnergy {
        energy,
        threshold: 0.0,
    };
    PlasticDamage::new(PlasticDamageParameters {
        surface: listed(),
        tension: by_energy(133.0),
        compression: by_energy(36.0e3),
        stiffness_recovery: 1.0,
        residual_stiffness: 1.0e-3,
    })
    .unwrap()
}

fn lee_fenves() -> LeeFenves {
    LeeFenves::new(LeeFenvesParameters {
        compression_limit: 9.0e6,
        tension_damage: 0.6,
        ..presets::PAPER_CONCRETE_LEE_FENVES
    })
    .unwrap()
}

fn rotated(turn: &Mat3, tensor: &Stress) -> Stress {
    Stress::from_matrix(&(turn * tensor.matrix() * turn.transpose()))
}

/// Follows three strains in one frame and in another.
fn isotropic(law: &impl ConstitutiveLaw, amplitude: f64) {
    let mut random = Random(91);
    let count = law.history().len();
    let mut flowed = 0;
    for _ in 0..100 {
        let turn = random.rotation();
        let initial = Stress(random.six().map(|x| 2.0e5 * x));
        let turned_initial = rotated(&turn, &initial);
        let mut old = [vec![0.0; count], vec![0.0; count]];
        for _ in 0..3 {
            let half = Stress(random.six().map(|x| amplitude * x));
            let twice = |tensor: Stress| {
                let strain: [f64; 6] = core::array::from_fn(|i| {
                    if i < 3 {
                        tensor.0[i]
                    } else {
                        2.0 * tensor.0[i]
                    }
                });
                Strain(strain)
            };
            let strains = [twice(half), twice(rotated(&turn, &half))];
            let mut new = old.clone();
            let mut respond = |frame: usize, initial: Stress| {
                let input = LawInput::new(strains[frame], &old[frame]).with_initial(initial);
                let input = input.with_size(0.2);
                initial + law.stress_change(&input, &mut new[frame])
            };
            let here = rotated(&turn, &respond(0, initial)).matrix();
            let there = respond(1, turned_initial).matrix();
            let error = (here - there).norm();
            assert!(
                error < 1e-10 * here.norm().max(1.0e6),
                "{}: {error:e}",
                law.name()
            );
            flowed += usize::from(new[0] != old[0]);
            old = new;
        }
    }
    assert!(flowed > 100, "{}: {flowed}", law.name());
}

/// No law has a preferred direction: rotated strains under a rotated initial stress give the
/// rotated stress, after flow and damage too.
#[test]
fn laws_have_no_preferred_direction() {
    isotropic(&ElastoPlastic::new(mohr_coulomb(10.0)), 1.0e-3);
    isotropic(&ElastoPlastic::new(cone()), 1.0e-3);
    isotropic(&ElastoPlastic::new(listed()), 3.0e-4);
    isotropic(
        &ElastoPlastic::new(HoekBrown::new(tunnel(0.5)).unwrap()),
        1.0e-3,
    );
    isotropic(&softening(10.0), 1.0e-3);
    isotropic(&damaging(), 3.0e-4);
    isotropic(&lee_fenves(), 3.0e-4);
    isotropic(
        &Mazars::new(presets::PAPER_CONCRETE_MAZARS).unwrap(),
        1.0e-4,
    );
}

/// A straight piece of a path: rate of strain per step.
fn pieces() -> impl Strategy<Value = Vec<([f64; 6], f64)>> {
    let rate = proptest::array::uniform6(-1.0..1.0_f64);
    proptest::collection::vec((rate, -7.0..-4.5_f64), 200)
}

/// Follows the pieces, 25 steps each, and checks that flow and damage dissipate energy in every step.
/// `damage` is the index of `D` in the history, if there is one.
fn takes(law: &impl ConstitutiveLaw, path: &[([f64; 6], f64)], damage: Option<usize>) {
    let initial = Stress([-1.0e6, -0.5e6, -1.0e6, 0.1e6, 0.0, 0.0]);
    let mut old = vec![0.0; law.history().len()];
    let mut new = old.clone();
    let mut strain = Strain::default();
    let mut sum = 0.0;
    for (rate, exponent) in path {
        for _ in 0..25 {
            for i in 0..6 {
                strain.0[i] = 0.995 * strain.0[i] + 10.0_f64.powf(*exponent) * rate[i];
            }
            let input = LawInput::new(strain, &old)
                .with_initial(initial)
                .with_size(0.2);
            let stress = law.stress_change(&input, &mut new);
            assert!(stress.0.iter().chain(&new).all(|x| x.is_finite()));
            let flowed = Strain(core::array::from_fn(|i| new[i] - old[i]));
            assert!(damage.is_none_or(|index| (0.0..1.0).contains(&new[index])));
            let plastic = (initial + stress).work(&flowed);
            // Rounding of plastic strains of a thousandth under ten megapascals.
            assert!(plastic >= -1e-11, "{}: {plastic:e}", law.name());
            let energy = law.energy(&input, &new).unwrap();
            assert!(energy.damage >= 0.0 && energy.recovered == 0.0);
            // By the two damage variables that make up `D`.
            let parts = damage.map_or(0..0, |index| index - 2..index);
            assert!(parts.clone().all(|part| new[part] >= old[part]));
            let grew = parts.clone().any(|part| new[part] > old[part]);
            assert!((energy.plastic - plastic.max(0.0)).abs() <= 1e-9 * plastic.abs() + 1e-11);
            assert!(grew || energy.damage == 0.0);
            sum += plastic;
            core::mem::swap(&mut old, &mut new);
        }
    }
    assert!(sum > 0.0, "{} never flowed", law.name());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20, ..ProptestConfig::default() })]

    /// Neither flow nor growing damage generates energy, on any path: a hundred thousand steps for
    /// each law.
    #[test]
    fn flow_and_damage_dissipate_energy(path in pieces()) {
        takes(&ElastoPlastic::new(mohr_coulomb(0.0)), &path, None);
        takes(&ElastoPlastic::new(mohr_coulomb(42.0)), &path, None);
        takes(&ElastoPlastic::new(cone()), &path, None);
        takes(&ElastoPlastic::new(listed()), &path, None);
        takes(&ElastoPlastic::new(HoekBrown::new(tunnel(0.0)).unwrap()), &path, None);
        takes(&ElastoPlastic::new(HoekBrown::new(tunnel(1.0)).unwrap()), &path, None);
        takes(&softening(10.0), &path, None);
        takes(&presets::paper_concrete().unwrap(), &path, Some(10));
        takes(&damaging(), &path, Some(10));
        takes(&lee_fenves(), &path, Some(10));
    }
}
