//! Nodes at the corner of a block, with a pair for each of its faces.

use powerhouse_contact::{BondedCoulomb, Cohesive, CohesiveParameters, Joint, StrengthReduction};
use powerhouse_model::{
    Bond, Constraint, ContactState, JointConstraint, JointHistory, JointPair, JointRecord,
    JointState, Mat3, PredictedMotion, StepTime, Vec3,
};

use super::{Bodies, Noise};

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

/// The faces of a corner fail gradually under forces of any direction, two or three of them, at any angle to each other: every
/// step has a solution, and the bonds take no more than their energies.
#[test]
fn cohesive_corners_are_solved_while_they_fail() {
    let mut noise = Noise(29);
    for trial in 0..800 {
        let normals = [Vec3::x(), Vec3::z(), Vec3::y()];
        let faces = 2 + trial % 2;
        let slant = [0.0, 0.3, 0.9][trial % 3];
        let area = 3.0 * 2.0_f64.powf(noise.next());
        let pairs: Vec<JointPair> = (normals[..faces].iter())
            .map(|normal| JointPair::new([0, 1], normal + noise.vector() * slant, area))
            .collect();
        let law = Cohesive::new(CohesiveParameters {
            tensile_strength: 0.3e6,
            cohesion: 0.8e6,
            opening_energy: 100.0,
            shear_energy: 1000.0,
            mode_exponent: 2.0,
            static_friction: 0.84,
            dynamic_friction: [0.755, 0.84, 0.3][trial % 3],
            reduction: StrengthReduction::None,
        })
        .unwrap();
        let mut joint = Joint::new("corner", pairs, law).unwrap();
        let mut bodies = Bodies::at_rest(&[2e4, 2e4 * 4.0_f64.powf(noise.next())], 1.37e-4);
        // On a plane of symmetry, as at the ends of a slice.
        if trial % 5 < 2 {
            bodies.free = Mat3::identity() - Vec3::y() * Vec3::y().transpose();
        }
        let size = 3e6 * area * 4.0_f64.powf(noise.next());
        let pressed = Vec3::new(1.0, 0.0, 1.0) * [0.0, 1.0, 3.0][trial % 3];
        let mut push = Vec3::zeros();
        for number in 0..600 {
            if number % 40 == 0 {
                push = (noise.vector() * 1.5 - pressed) * size;
            }
            let forces = |body: usize| if body == 0 { push * 0.5 } else { push * -0.5 };
            bodies
                .step(&mut joint, forces)
                .unwrap_or_else(|e| panic!("{trial} {number}: {e}"));
        }
        for (pair, record) in joint.records().iter().enumerate() {
            let dissipated = joint.history_of(pair)[3];
            assert!(
                (0.0..=1000.0 * (1.0 + 1e-9)).contains(&dissipated),
                "{record:?}"
            );
        }
    }
}
