//! Single precision under an initial stress.

use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, HoekBrown, LeeFenves,
    MohrCoulomb, MohrCoulombParameters, TwoSurface, YieldSurface, presets,
};
use powerhouse_model::{ConstitutiveLaw, Lane, LawInput, Strain, Stress};

use super::hoek_brown::tunnel;

/// Follows a shear vibration that makes changes of 1e-6 of an initial stress of 10 MPa in a step.
fn vibrate<L: Lane<Token = ()>>(
    law: &impl ConstitutiveLaw,
    initial: [f64; 6],
) -> (Vec<[f64; 6]>, f64) {
    let number = |value: f64| L::splat((), value);
    let initial = Stress(initial.map(number));
    let shear = law.medium().shear();
    let amplitude = 1.0e5 / shear;
    let mut old = vec![number(0.0); law.history().len()];
    let mut new = old.clone();
    let stresses = (0..200_000)
        .map(|step| {
            // 10 Pa a step where it is fastest.
            let phase = 1.0e-4 * f64::from(step);
            let strain = amplitude * phase.sin();
            let strain = [0.3 * strain, 0.0, -0.3 * strain, 0.0, 0.0, strain].map(number);
            let input = LawInput::new(Strain(strain), &old).with_initial(initial);
            let stress = law.stress_change(&input, &mut new);
            core::mem::swap(&mut old, &mut new);
            stress.0.map(|s| s.extract(0))
        })
        .collect();
    (stresses, old[6].extract(0))
}

/// Largest difference of stress changes over the largest change, up to the middle and to the end,
/// and the plastic strain.
fn error(law: &impl ConstitutiveLaw, initial: [f64; 6]) -> ([f64; 2], f64) {
    let (exact, plastic) = vibrate::<f64>(law, initial);
    let (single, _) = vibrate::<f32>(law, initial);
    let size = exact.iter().flatten();
    let size = size.fold(0.0_f64, |most, s| most.max(s.abs()));
    let worst = |end: usize| {
        let pairs = exact[..end].iter().flatten();
        let pairs = pairs.zip(single[..end].iter().flatten());
        pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / size
    };
    ([worst(100_000), worst(200_000)], plastic)
}

/// Principal stresses with a least of -10 MPa that are 50 kPa within a surface.
fn near_yield(surface: &impl YieldSurface) -> [f64; 6] {
    let at = |lateral: f64| [lateral, lateral - 1.0e5, -1.0e7];
    let (mut low, mut high) = (-9.0e6, 2.0e6);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if surface.excess(&at(middle)) < -5.0e4 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let [xx, yy, zz] = at(low);
    [xx, yy, zz, 0.0, 0.0, 0.0]
}

fn check<S: YieldSurface>(surface: S) {
    let law = ElastoPlastic::new(surface.clone());
    let rounding = f64::from(f32::EPSILON);
    let isotropic = [-1.0e7, -1.0e7, -1.0e7, 0.0, 0.0, 0.0];
    let ([_, elastic], plastic) = error(&law, isotropic);
    assert!(elastic < 4.0 * rounding && plastic == 0.0, "{elastic:e}");
    let ([half, whole], plastic) = error(&law, near_yield(&surface));
    println!(
        "{}: single precision at yield {half:.1e}, {whole:.1e}",
        law.name()
    );
    // A few rounding errors of 10 MPa over a change of 0.1 MPa.
    let limit = 20.0 * rounding * 1.0e7 / 1.0e5;
    assert!(
        plastic > 1.0e-7 && whole < limit,
        "{whole:e} of {limit:e}, {plastic:e}"
    );
}

/// Under an initial stress of 10 MPa steps of a millionth of it are resolved in single precision: to
/// its rounding while elastic, and on the yield surface to the rounding of the initial stress,
/// with no drift over two hundred thousand steps.
#[test]
fn small_steps_survive_a_large_initial_stress() {
    let p = MohrCoulombParameters {
        dilation: 10.0,
        tension_strength: None,
        ..presets::PAPER_ROCK
    };
    check(MohrCoulomb::new(p).unwrap());
    check(HoekBrown::new(tunnel(0.3)).unwrap());
    check(TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap());
    check(
        DruckerPrager::new(DruckerPragerParameters {
            medium: p.medium,
            friction: 42.0,
            dilation: 10.0,
            cohesion: 1.05e6,
            fit: ConeFit::Inscribed,
        })
        .unwrap(),
    );
}

/// The same holds of concrete that cracks and crushes: under an initial stress of 10 MPa near the
/// surface, the error of single precision does not grow in the second hundred thousand steps.
#[test]
fn damaged_concrete_does_not_drift() {
    let law = LeeFenves::new(presets::PAPER_CONCRETE_LEE_FENVES).unwrap();
    let at = |lateral: f64| [lateral, lateral - 1.0e5, -1.0e7, 0.0, 0.0, 0.0];
    let (mut low, mut high) = (-9.0e6, 2.0e6);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        // 50 kPa within.
        if law.yield_function(&Stress(at(middle)), &[0.0; 13], 1.0) < -5.0e4 / 16.7e6 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let ([half, whole], plastic) = error(&law, at(low));
    println!("lee-fenves: single precision at yield {half:.1e}, {whole:.1e}");
    let limit = 20.0 * f64::from(f32::EPSILON) * 1.0e7 / 1.0e5;
    assert!(
        plastic > 1.0e-7 && whole < limit,
        "{whole:e} of {limit:e}, {plastic:e}"
    );
}
