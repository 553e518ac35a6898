//! Programs of laws have their bits.

use powerhouse_material_damage::{
    ConeFit, DampingBand, DruckerPrager, DruckerPragerParameters, ElasticInSeries, ElastoPlastic,
    FlatDamping, HoekBrown, HoekBrownParameters, LeeFenves, LinearElastic, Mazars, MohrCoulomb,
    PlasticDamage, PlasticDamageParameters, ReferenceFrequency, RelaxationSpectrum,
    SofteningPlasticity, SofteningPlasticityParameters, StrengthFall, TwoSurface, YieldSurface,
    media, presets,
};
use powerhouse_model::{
    ConstitutiveLaw, Extents, Lane, LawInput, Program, ProgramBranch, Scalar, Strain, Stress,
};
use powerhouse_program::{Replay, law_program};

/// Number format of both a law in one lane and its program.
pub(crate) trait Number: Scalar + Lane<Scalar = Self, Token = (), Mask = bool> {}
impl<S: Scalar + Lane<Scalar = S, Token = (), Mask = bool>> Number for S {}

/// Paths of strain, with their initial stress, widths of the element, and strains step by step.
const PATHS: usize = 3000;
/// Steps of each path, of which the last but one turns back.
const STEPS: usize = 5;

/// Deterministic numbers between -1 and 1.
pub(crate) fn noise(index: usize) -> f64 {
    let mut bits = (index as u64).wrapping_add(0x9E37_79B9_7F4A_7C15);
    for factor in [0xBF58_476D_1CE4_E5B9_u64, 0x94D0_49BB_1331_11EB] {
        bits = (bits ^ (bits >> 29)).wrapping_mul(factor);
    }
    (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// What was compared.
#[derive(Debug, Default)]
struct Compared {
    points: usize,
    /// Points of which the history changed.
    changed: usize,
    /// Points of which a bit of stress or history differs.
    different: usize,
}

/// Inputs and outputs of a law in the order of its program, at all points of all paths; compiled once for all visitors.
pub(crate) fn points<S: Number, M: ConstitutiveLaw>(law: &M, visit: &mut dyn FnMut(&[S], &[S])) {
    let count = law.history().len();
    let number = |value: f64| S::from_f64(value);
    for path in 0..PATHS {
        let size = 10.0_f64.powf(-3.75 + 1.75 * noise(7919 * path + 1));
        let mut x = vec![number(0.0); 18 + count];
        for i in 0..6 {
            let initial = 1.0e6 * noise(31 * path + i);
            x[6 + i] = number(if path % 3 == 0 { 0.0 } else { initial });
        }
        let width = 0.15 + 0.1 * noise(53 * path);
        x[12..18].copy_from_slice(&Extents::uniform(number(width)).0);
        for step in 1..=STEPS {
            let turn = if step + 1 == STEPS { -1.0 } else { step as f64 };
            for i in 0..6 {
                x[i] = number(size * turn * noise(17 * path + i + 5));
            }
            let six = |first: usize| core::array::from_fn(|i| x[first + i]);
            let input = LawInput::new(Strain(six(0)), &x[18..])
                .with_initial(Stress(six(6)))
                .with_extents(Extents(six(12)));
            let mut new = vec![number(0.0); count];
            let change = law.stress_change(&input, &mut new);
            let y: Vec<S> = change.0.into_iter().chain(new).collect();
            visit(&x, &y);
            x[18..].copy_from_slice(&y[6..]);
        }
    }
}

/// Whether two numbers have the same bits, or neither is a number.
pub(crate) fn same<S: Number>(a: S, b: S) -> bool {
    let (a, b) = (a.to_f64(), b.to_f64());
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

fn compared<S: Number, M: ConstitutiveLaw>(law: &M, program: &Program) -> Compared {
    let mut replay = Replay::<S>::new(program).unwrap();
    let mut found = vec![S::default(); program.outputs().len()];
    let mut compared = Compared::default();
    points::<S, M>(law, &mut |x, y| {
        replay.run(x, &mut found).unwrap();
        let changed = y[6..]
            .iter()
            .zip(&x[18..])
            .any(|(new, old)| !same(*new, *old));
        compared.points += 1;
        compared.changed += usize::from(changed);
        let differs = found.iter().zip(y).any(|(a, b)| !same(*a, *b));
        compared.different += usize::from(differs);
    });
    compared
}

/// Fails if the program of a law differs from it in a bit, in either precision, with forks or without.
pub(crate) fn check<M: ConstitutiveLaw>(law: M) {
    for forks in [0, 1, 4] {
        let of = [
            compared::<f64, M>(&law, &law_program::<f64, M>(&law, forks).unwrap()),
            compared::<f32, M>(&law, &law_program::<f32, M>(&law, forks).unwrap()),
        ];
        for compared in of {
            let what = format!("{} with {forks} forks: {compared:?}", law.name());
            assert_eq!(compared.different, 0, "{what}");
            assert_eq!(compared.points, PATHS * STEPS, "{what}");
            let least = if law.history().is_empty() {
                0
            } else {
                PATHS * STEPS / 2
            };
            assert!(compared.changed >= least, "{what}");
        }
    }
}

pub(crate) fn mohr_coulomb() -> MohrCoulomb {
    MohrCoulomb::new(presets::PAPER_ROCK).unwrap()
}

fn drucker_prager() -> DruckerPrager {
    let parameters = DruckerPragerParameters {
        medium: media::ROCK,
        friction: 30.0,
        dilation: 10.0,
        cohesion: 1.0e6,
        fit: ConeFit::Inscribed,
    };
    DruckerPrager::new(parameters).unwrap()
}

pub(crate) fn hoek_brown() -> HoekBrown {
    let parameters = HoekBrownParameters {
        medium: media::ROCK,
        intact_strength: 5.0e7,
        intact_constant: 10.0,
        strength_index: 40.0,
        disturbance: 0.0,
        dilation_share: 0.3,
    };
    HoekBrown::new(parameters).unwrap()
}

pub(crate) fn softening<S: YieldSurface>(surface: S) -> SofteningPlasticity<S> {
    let parameters = SofteningPlasticityParameters {
        surface,
        fall: StrengthFall::FractureEnergy { energy: 2.0e4 },
        residual_strength: 0.1,
    };
    SofteningPlasticity::new(parameters).unwrap()
}

/// A law with flat damping, in dynamic steps.
pub(crate) fn damped<M: ElasticInSeries>(law: M, mechanisms: usize) -> FlatDamping<M> {
    let band = DampingBand {
        ratio: 0.05,
        lowest: 0.5,
        highest: 20.0,
        mechanisms,
    };
    let spectrum = RelaxationSpectrum::fit(band).unwrap();
    let damped = FlatDamping::new(law, spectrum, ReferenceFrequency::Centre).unwrap();
    damped.for_step(1e-4)
}

/// Programs of laws without loops have the bits of the laws, in 15,000 points, at least half of them with a history
/// that changes.
#[test]
fn programs_of_laws_have_their_bits() {
    check(LinearElastic::new(media::ROCK));
    check(ElastoPlastic::new(mohr_coulomb()));
    check(ElastoPlastic::new(drucker_prager()));
    check(ElastoPlastic::new(
        TwoSurface::new(presets::PAPER_ROCK_LISTED).unwrap(),
    ));
    check(Mazars::new(presets::PAPER_CONCRETE_MAZARS).unwrap());
    let paper = presets::paper_concrete().unwrap();
    check(paper);
    let listed = PlasticDamageParameters {
        surface: TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap(),
        tension: paper.parameters().tension,
        compression: paper.parameters().compression,
        stiffness_recovery: 0.5,
        residual_stiffness: 1e-3,
    };
    check(PlasticDamage::new(listed).unwrap());
}

/// Programs of laws that find zeros in loops, within each other too, have their bits.
#[test]
fn programs_of_iterated_laws_have_their_bits() {
    check(ElastoPlastic::new(hoek_brown()));
    check(LeeFenves::new(presets::PAPER_CONCRETE_LEE_FENVES).unwrap());
    check(softening(mohr_coulomb()));
    check(softening(drucker_prager()));
    check(softening(hoek_brown()));
}

/// Programs of laws with flat damping have their bits, in dynamic steps and in statics.
#[test]
fn programs_of_damped_laws_have_their_bits() {
    check(damped(LinearElastic::new(media::ROCK), 2));
    check(damped(ElastoPlastic::new(mohr_coulomb()), 3));
    check(damped(
        LeeFenves::new(presets::PAPER_CONCRETE_LEE_FENVES).unwrap(),
        2,
    ));
    check(damped(Mazars::new(presets::PAPER_CONCRETE_MAZARS).unwrap(), 4).for_step(0.0));
    check(FlatDamping::none(presets::paper_concrete().unwrap()));
}

/// An elastic step leaves a program of one fork early: its operations are a fraction of all.
#[test]
fn one_fork_separates_elastic_steps() {
    let program = law_program::<f64, _>(&ElastoPlastic::new(mohr_coulomb()), 1).unwrap();
    assert_eq!(program.branch().ends(), 2);
    assert!(matches!(program.branch(), ProgramBranch::Fork { .. }));
    let all = law_program::<f64, _>(&ElastoPlastic::new(mohr_coulomb()), 0).unwrap();
    assert_eq!(all.branch().ends(), 1);
}
