//! Nodes at the corner of a block, with a pair for each of its faces.

use powerhouse_contact::{BondedCoulomb, Joint};
use powerhouse_model::{
    Bond, Constraint, ContactState, JointHistory, JointPair, JointRecord, JointState, Mat3,
    PredictedMotion, StepTime, Vec3,
};

use crate::Noise;

const FRICTION: f64 = 0.8;

/// Three faces at right angles, or at an angle to each other.
fn corner(noise: &mut Noise, slant: f64) -> Vec<JointPair> {
    [Vec3::x(), Vec3::y(), Vec3::z()]
        .map(|normal| {
            let normal = normal + noise.vector() * slant;
            JointPair::new([0, 1], normal, 2.0_f64.powf(noise.next()))
        })
        .to_vec()
}

/// From any state and for any motion the faces of a corner are solved together: no side enters the
/// other, no pair pulls, none bears more shear than its friction, and what slides is held back.
#[test]
fn corners_are_solved_whatever_they_do() {
    let mut noise = Noise(17);
    for trial in 0..20_000 {
        let slant = [0.0, 0.3][trial % 2];
        let pairs = corner(&mut noise, slant);
        let law = BondedCoulomb::unbonded(FRICTION, FRICTION).unwrap();
        let mut joint = Joint::new("corner", pairs.clone(), law).unwrap();
        let record = |noise: &mut Noise| {
            let contacts = [ContactState::Stick, ContactState::Slide, ContactState::Open];
            let contact = contacts[((noise.next() + 1.0) * 1.5) as usize % 3];
            JointRecord::new(JointState::new(contact, Bond::Broken))
                .with_traction(Vec3::new(-noise.next().abs(), 0.0, 0.0))
                .with_anchor([0.0; 2])
        };
        let records = (0..3).map(|_| record(&mut noise)).collect();
        assert!(joint.restore(&JointHistory::new("corner", vec![[0, 1]; 3], records)));
        let step = 1e-2;
        let masses = [Mat3::identity() / 3.0, Mat3::identity() / 5.0];
        // What rounding leaves is closed along one face's normal, and is a slip along the others.
        let left = noise.vector() * 10.0_f64.powf(-10.0 - 4.0 * noise.next());
        let (here, rest) = ([Vec3::zeros(), left], [Vec3::zeros(); 2]);
        let predicted = [Vec3::zeros(), noise.vector()];
        let mut velocity = predicted;
        let when = StepTime {
            number: 0,
            time: 0.0,
            step,
        };
        let motion = PredictedMotion::new(when, &here, &rest, &mut velocity, &masses);
        joint
            .correct(motion)
            .unwrap_or_else(|e| panic!("{trial}: {e}"));
        let apart = velocity[1] - velocity[0];
        // Most end at 1e-11; the longest of 2e4 sweeps may still change the motion by 5e-6.
        let loose = 5e-6;
        let size = predicted[1].norm();
        for (pair, record) in pairs.iter().zip(joint.records()) {
            let across = (apart + left / step).dot(&pair.normal);
            assert!(
                across > -loose * size - left.norm() / step,
                "{trial}: enters at {across:e}"
            );
            let traction = record.traction;
            let shear = traction.y.hypot(traction.z);
            let limit = loose * size / (step * masses[1][(0, 0)]);
            assert!(traction.x <= limit, "{trial}: pulls {}", traction.x);
            assert!(
                shear <= -FRICTION * traction.x + limit,
                "{trial}: {traction}"
            );
        }
        // The forces only take energy from the motion.
        let energy = |v: &[Vec3; 2]| 1.5 * v[0].norm_squared() + 2.5 * v[1].norm_squared();
        assert!(
            energy(&velocity) <= energy(&predicted) * (1.0 + loose),
            "{trial}"
        );
    }
}
