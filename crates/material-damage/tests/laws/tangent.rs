//! Tangents against difference quotients.

use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, HoekBrown, MohrCoulomb,
    MohrCoulombParameters, TwoSurface, YieldSurface, presets,
};
use powerhouse_model::{ConstitutiveLaw, LawInput, Strain, Stress};

use crate::hoek_brown::tunnel;
use crate::random::Random;

fn check<S: YieldSurface>(surface: S, amplitude: f64) {
    let law = ElastoPlastic::new(surface);
    let young = law.medium().young;
    let mut random = Random(101);
    let (mut compared, mut flowing) = (0, 0);
    for case in 0..300 {
        // Plastic strain of a step before, or none; and an initial stress.
        let initial = Stress(random.six().map(|x| 2.0e4 * x));
        let is_sound = case % 4 == 0;
        let size = if is_sound { 1.0e-3 } else { 1.0 };
        let strain = random.six().map(|x| size * amplitude * x);
        let mut old = [0.0; 8];
        let input = LawInput::new(Strain(strain), &[0.0; 8]).with_initial(initial);
        law.stress_change(&input, &mut old);
        let size = 0.1 * size * amplitude;
        let strain: [f64; 6] = core::array::from_fn(|i| strain[i] + size * random.signed());
        let respond = |strain: [f64; 6]| {
            let mut new = [0.0; 8];
            let input = LawInput::new(Strain(strain), &old).with_initial(initial);
            (law.stress_change(&input, &mut new), new)
        };
        let (here, new) = respond(strain);
        let input = LawInput::new(Strain(strain), &old).with_initial(initial);
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
        check(MohrCoulomb::new(plane).unwrap(), 1.0e-3);
        let cone = DruckerPragerParameters {
            medium: presets::PAPER_ROCK.medium,
            friction: 42.0,
            dilation,
            cohesion: 1.05e6,
            fit: ConeFit::Inscribed,
        };
        check(DruckerPrager::new(cone).unwrap(), 1.0e-3);
    }
    check(
        TwoSurface::new(presets::PAPER_CONCRETE_LISTED).unwrap(),
        5.0e-4,
    );
    for share in [0.0, 0.5, 1.0] {
        check(HoekBrown::new(tunnel(share)).unwrap(), 1.0e-3);
    }
}
