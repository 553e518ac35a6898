//! Steps that are corrected several times from the same state.

use powerhouse_contact::{Cohesive, CohesiveParameters, Joint, StrengthReduction};
use powerhouse_model::{
    Constraint, JointConstraint, JointPair, Mat3, PredictedMotion, StepTime, Vec3,
};

use super::Noise;

/// A bond that fails, with its damage, slip, energies and work, comes out of three corrections from the same state as of the last of them alone.
#[test]
fn a_correction_that_is_taken_back_leaves_nothing() {
    let law = || {
        Cohesive::new(CohesiveParameters {
            tensile_strength: 0.3e6,
            cohesion: 0.8e6,
            opening_energy: 100.0,
            shear_energy: 1000.0,
            mode_exponent: 2.0,
            static_friction: 0.84,
            dynamic_friction: 0.7,
            reduction: StrengthReduction::None,
        })
    };
    // A pair by itself, and two that share a node.
    let pairs = [[0, 1], [2, 3], [2, 4]].map(|nodes| JointPair::new(nodes, Vec3::z(), 1.5));
    let mut noise = Noise(3);
    let (step, masses) = (1e-4, [Mat3::identity() / 1e4; 5]);
    let joint = || Joint::new("bond", pairs.to_vec(), law().unwrap()).unwrap();
    let [mut once, mut often] = [joint(), joint()];
    let mut displacement = [Vec3::zeros(); 5];
    let mut previous = [Vec3::zeros(); 5];
    for number in 0..200 {
        let when = StepTime {
            number,
            time: number as f64 * step,
            step,
        };
        let correct = |joint: &mut Joint<_>, predicted: [Vec3; 5]| {
            let mut velocity = predicted;
            let motion =
                PredictedMotion::new(when, &displacement, &previous, &mut velocity, &masses);
            let work = joint.correct(motion).unwrap();
            (work, velocity)
        };
        let mut predicted = || previous.map(|v| v + noise.vector() * 0.02);
        let (others, last) = ([predicted(), predicted()], predicted());
        let expected = correct(&mut once, last);
        often.keep_state();
        for other in others {
            correct(&mut often, other);
            often.return_to_kept();
        }
        assert_eq!(correct(&mut often, last), expected);
        assert_eq!(often.records(), once.records());
        for pair in 0..pairs.len() {
            assert_eq!(often.history_of(pair), once.history_of(pair));
        }
        previous = expected.1;
        for (displacement, velocity) in displacement.iter_mut().zip(&previous) {
            *displacement += velocity * step;
        }
    }
    let energy: f64 = once.records().iter().map(|record| record.bond_energy).sum();
    assert!(energy > 10.0, "{energy}");
}
