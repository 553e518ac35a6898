//! Elastic domains of laws, in which the engine need not evaluate them.

use powerhouse_material_damage::{
    ConeFit, DampingBand, DruckerPrager, DruckerPragerParameters, ElastoPlastic, FlatDamping,
    HoekBrown, LeeFenves, Mazars, MohrCoulomb, MohrCoulombParameters, ReferenceFrequency,
    RelaxationSpectrum, TwoSurface, presets,
};
use powerhouse_model::{ConstitutiveLaw, Lane, LawInput, Scalar, Strain, Stress};

use super::hoek_brown::tunnel;
use super::random::Random;
use super::softening_plasticity::softening;

/// A point without history.
struct Fresh<'a, S, M> {
    law: &'a M,
    initial: Stress<S>,
}

impl<S, M: ConstitutiveLaw> Fresh<'_, S, M>
where
    S: Lane<Scalar = S, Token = ()> + Scalar,
{
    /// Whether the stress is that of the medium, to the bit but for the sign of zero, and the history
    /// stays zero.
    fn is_elastic(&self, strain: Strain<S>) -> bool {
        let blank = vec![S::from_f64(0.0); self.law.history().len()];
        let mut new = blank.clone();
        let input = LawInput::new(strain, &blank).with_initial(self.initial);
        let stress = self
            .law
            .stress_change(&input.with_size(S::from_f64(0.5)), &mut new);
        let unchanged = new.iter().all(|h| h.to_f64() == 0.0);
        unchanged && stress == self.change(strain)
    }
    fn change(&self, strain: Strain<S>) -> Stress<S> {
        let medium = self.law.medium();
        let [lambda, shear] = [medium.lambda(), medium.shear()].map(S::from_f64);
        Stress::elastic(lambda, shear, &strain)
    }
    fn is_inside(&self, strain: Strain<S>) -> bool {
        let domain = self.law.elastic_domain().unwrap();
        domain.contains(&(self.initial + self.change(strain)))
    }
}

/// Follows random directions from random pressures, to where the law first is not elastic, and
/// samples closely there. The domain is elastic; it contains a share of the elastic part of the paths.
fn holds<S, M: ConstitutiveLaw>(law: &M, pressure: f64, share: f64)
where
    S: Lane<Scalar = S, Token = ()> + Scalar,
{
    let mut random = Random(3);
    let (mut elastic, mut inside) = (0.0, 0.0);
    for _ in 0..300 {
        let pressed = S::from_f64(-pressure * (0.5 + 0.5 * random.six()[0]));
        let zero = S::from_f64(0.0);
        let initial = Stress([pressed, pressed, pressed, zero, zero, zero]);
        let point = Fresh { law, initial };
        let direction = random.six();
        let along = |size: f64| Strain(direction.map(|x| S::from_f64(size * x)));
        let (mut low, mut high) = (0.0, 1.0);
        if point.is_elastic(along(high)) {
            // Under increasing pressure a frictional surface never yields.
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if point.is_elastic(along(middle)) {
                low = middle;
            } else {
                high = middle;
            }
        }
        for k in -300..300_i32 {
            let size = low * (1.0 + f64::from(k) * S::EPSILON);
            let strain = along(size);
            if point.is_inside(strain) {
                assert!(point.is_elastic(strain), "{} {size:e} {k}", law.name());
            }
        }
        for k in 0..100 {
            let strain = along(low * 0.01 * f64::from(k));
            elastic += 1.0;
            if point.is_inside(strain) {
                assert!(point.is_elastic(strain), "{} {k}", law.name());
                inside += 1.0;
            }
        }
    }
    assert!(elastic > 1e4, "{}", law.name());
    assert!(
        inside > share * elastic,
        "{}: {inside} of {elastic}",
        law.name()
    );
}

/// Inside the domain that a law states, a point without history returns the stress of its
/// medium bit by bit, and no history, however close to the surface; the domain is most of the elastic one.
#[test]
fn laws_are_elastic_in_their_domain() {
    fn both<M: ConstitutiveLaw>(law: &M, pressure: f64, share: f64) {
        holds::<f64, _>(law, pressure, share);
        holds::<f32, _>(law, pressure, share);
    }
    let cone = DruckerPragerParameters {
        medium: presets::PAPER_ROCK.medium,
        friction: 42.0,
        dilation: 10.0,
        cohesion: 1.05e6,
        fit: ConeFit::Inscribed,
    };
    let cone = ElastoPlastic::new(DruckerPrager::new(cone).unwrap());
    both(&cone, 3e6, 0.99);
    let cut = MohrCoulombParameters {
        tension_strength: Some(0.5e6),
        ..presets::PAPER_ROCK
    };
    both(
        &ElastoPlastic::new(MohrCoulomb::new(cut).unwrap()),
        3e6,
        0.7,
    );
    let whole = MohrCoulomb::new(presets::PAPER_ROCK).unwrap();
    both(&ElastoPlastic::new(whole), 3e6, 0.7);
    both(
        &ElastoPlastic::new(HoekBrown::new(tunnel(0.5)).unwrap()),
        20e6,
        0.6,
    );
    let listed = TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap();
    both(&ElastoPlastic::new(listed), 3e6, 0.7);
    both(&softening(10.0), 3e6, 0.7);
    both(&presets::paper_concrete().unwrap(), 3e6, 0.7);
    both(
        &FlatDamping::none(presets::paper_concrete().unwrap()),
        3e6,
        0.7,
    );
    both(
        &Mazars::new(presets::PAPER_CONCRETE_MAZARS).unwrap(),
        0.5e6,
        0.6,
    );
    both(
        &LeeFenves::new(presets::PAPER_CONCRETE_LEE_FENVES).unwrap(),
        3e6,
        0.7,
    );
}

/// A damped law has no elastic domain: its stress depends on the past.
#[test]
fn damped_laws_have_no_elastic_domain() {
    let band = DampingBand {
        ratio: 0.05,
        lowest: 0.5,
        highest: 20.0,
        mechanisms: 2,
    };
    let spectrum = RelaxationSpectrum::fit(band).unwrap();
    let rock = ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK).unwrap());
    let damped = FlatDamping::new(rock, spectrum, ReferenceFrequency::Centre).unwrap();
    assert_eq!(damped.elastic_domain(), None);
    assert_eq!(damped.for_step(1e-4).elastic_domain(), None);
}
