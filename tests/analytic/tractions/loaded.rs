//! Bodies that deform under their weight: a run begins with the tractions that the stage has left.

use powerhouse_elements::SolidKernel;
use powerhouse_model::{StaticMethod, Vec3};

use super::{
    Body, Cut, Held, Law, Random, at_rest, difference, settled, spec, tractions, two_media,
};

const KERNELS: [SolidKernel; 4] = [
    SolidKernel::ONE_POINT,
    SolidKernel::Hex8Full,
    SolidKernel::Hex8Natural,
    SolidKernel::Hex8Eas,
];

/// Every pair of 200 random bodies of two media under their weight has, after two stages, the same traction at the start of a
/// run and after 30 steps at rest, to 1e-9 of the greatest one: with joints through faces, around blocks and at edges;
/// with supports of the stages that stay, go, or stay in part.
#[test]
fn a_run_begins_with_the_tractions_of_the_stage() {
    for seed in 0..200 {
        let mut random = Random::new(seed + 1);
        // Without the steepest, whose bricks are five times as long as wide.
        let cut = random.of(&[&Cut::ALL[..4], &Cut::ALL[5..]].concat());
        let brick = Vec3::from_fn(|_, _| random.between(0.6, 1.7));
        let body = Body::new(cut, [3, 1 + seed as usize % 2, 3], brick, &Vec3::zeros());
        let media = two_media(&mut random);
        let (kernel, law) = (random.of(&KERNELS), random.of(&Law::ALL));
        let weight = random.vector(9.81);
        let whole = matches!(cut, Cut::Block | Cut::Octagon | Cut::Closed);
        // What the stage does not hold on the second side only the joint can.
        let first = if whole || !matches!(law, Law::Friction) {
            Held::FirstSide
        } else {
            Held::Fixed
        };
        let law = if first == Held::FirstSide {
            Law::Tied
        } else {
            law
        };
        let stages = [
            random.of(&[
                Held::Fixed,
                Held::Rollers,
                Held::Ground,
                Held::Prescribed,
                first,
            ]),
            random.of(&[Held::Fixed, Held::Rollers, first]),
        ];
        let last = random.of(&[stages[1], Held::Absorbing, Held::Slice]);
        let law = if stages.contains(&Held::Ground) || cut != Cut::Closed {
            Law::Tied
        } else {
            law
        };
        let what = format!("{seed}: {cut:?} {stages:?} {last:?} {kernel:?} {law:?}");
        let built = |held: Held| {
            let spec = spec(&body, kernel, media, law).gravity(weight, Box::new(|_: f64| 1.0));
            held.on(&body, spec)
        };
        let method = StaticMethod::ConjugateGradients;
        let state = settled(&body, built(stages[0]), method, 1.0e-6);
        let state = settled(&body, built(stages[1]).start(state), method, 1.0e-6);
        let expected = tractions(&body, &state);
        assert!(
            expected.iter().any(|traction| traction.norm() > 0.0),
            "{what}"
        );
        for steps in [1, 30] {
            let error = difference(&at_rest(&body, built(last), &state, steps), &expected);
            assert!(error < 1.0e-9, "{what}, {steps} steps: {error:e}");
        }
    }
}
