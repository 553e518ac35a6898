//! Sides that meet and part.

use powerhouse_contact::{BondedCoulomb, BondedCoulombParameters, Frictionless, Joint};
use powerhouse_model::{Bond, ContactState, JointPair, Vec3};

use super::{Bodies, Noise};

/// Two masses that meet stay together until they are pulled apart, and lose
/// `m1 m2 / (m1 + m2) (v1 - v2)^2 / 2`, which is reported.
#[test]
fn the_loss_of_an_impact_is_reported() {
    let pair = JointPair::new([0, 1], Vec3::x(), 1.0);
    let mut joint = Joint::new("joint", vec![pair], Frictionless).unwrap();
    let mut bodies = Bodies::at_rest(&[2.0, 6.0], 1e-3);
    bodies.velocity = vec![Vec3::x() * 3.0, -Vec3::x()];
    let initial = bodies.kinetic();
    bodies.step(&mut joint, |_| Vec3::zeros()).unwrap();
    assert_eq!(bodies.velocity, [Vec3::zeros(); 2]);
    let expected = 0.5 * 1.5 * 16.0;
    assert!((bodies.work.impact - expected).abs() < 1e-14 * expected);
    assert!(bodies.residual(initial).abs() < 1e-14 * initial);
}

/// Under random forces a bond breaks and the sides part, meet, slide and stick many times; energies
/// close to rounding, friction and impact never give energy in the whole, and no overlap outlasts
/// its step.
#[test]
fn the_balance_of_a_rattling_pair_closes() {
    let pair = JointPair::new([0, 1], Vec3::new(0.3, 0.5, 1.0), 0.7);
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 3.0,
        tensile_strength: 2.0,
        static_friction: 0.7,
        dynamic_friction: 0.5,
        cohesion_loss: true,
    })
    .unwrap();
    for preload in [0.0, 0.4] {
        let joint = Joint::new("joint", vec![pair], law).unwrap();
        let mut joint = joint.with_preload(|pair| -pair.normal * preload).unwrap();
        let mut bodies = Bodies::at_rest(&[1.0, 3.0], 0.01);
        let mut noise = Noise(11);
        let mut opened = 0;
        for _ in 0..20_000 {
            let offset = bodies.displacement[1] - bodies.displacement[0];
            let force = noise.vector() * 8.0 - offset * 20.0;
            let sign = |body: usize| 2.0 * body as f64 - 1.0;
            bodies.step(&mut joint, |body| force * sign(body)).unwrap();
            let gap = (bodies.displacement[1] - bodies.displacement[0]).dot(&pair.normal);
            assert!(gap > -1e-13, "{gap}");
            opened += u32::from(gap > 1e-6);
        }
        let record = &joint.records()[0];
        assert!(opened > 100, "{opened}");
        assert!(record.state.bond == Bond::Broken && record.first_crack.is_some());
        assert!(record.friction > 0.0 && record.impact > 0.0 && record.first_slip.is_some());
        assert!((record.friction - bodies.work.friction).abs() < 1e-12 * record.friction);
        assert!(
            bodies.residual(0.0).abs() < 1e-12 * bodies.work.impact,
            "{bodies:?}"
        );
        assert_eq!(bodies.work.external == 0.0, preload == 0.0);
    }
}

/// A block of 1 kg, held down by a force, on a base that shakes up and down by `A sin(w t)`, leaves
/// it whenever the base falls away faster than the force can pull it along, at the yield ratio
/// `r = F / A`. The largest gap is that of the closed form, `A / w^2` times the slip of Newmark's
/// block (0.5: 1.265762), to 1 %, cycle after cycle; so it is if a preload takes the place of the force.
#[test]
fn a_block_leaves_its_base_and_comes_back() {
    let (amplitude, ratio, expected) = (3.0, 0.5, 1.265762);
    let omega = 4.0 * core::f64::consts::PI;
    for preloaded in [false, true] {
        let pair = JointPair::new([0, 1], Vec3::z(), 2.0);
        let joint = Joint::new("base", vec![pair], Frictionless).unwrap();
        let force = Vec3::z() * (ratio * amplitude);
        let preload = if preloaded {
            force / 2.0
        } else {
            Vec3::zeros()
        };
        let mut joint = joint.with_preload(|_| -preload).unwrap();
        let mut bodies = Bodies::at_rest(&[1.0, 1.0], 1e-4);
        bodies.fixed[0] = true;
        bodies.velocity[1].z = -amplitude / omega;
        let mut largest: f64 = 0.0;
        for _ in 0..25_000 {
            let end = bodies.time() + 0.5 * bodies.step;
            let base = Vec3::z() * (-amplitude / omega * (omega * end).cos());
            let pull = if preloaded { Vec3::zeros() } else { -force };
            bodies
                .step(&mut joint, |body| if body == 0 { base } else { pull })
                .unwrap();
            largest = largest.max(joint.records()[0].opening);
        }
        let found = largest * omega * omega / amplitude;
        assert!(
            (found / expected - 1.0).abs() < 1e-2,
            "{preloaded}: {found}"
        );
        assert_eq!(joint.records()[0].peak_opening, largest);
        assert!(joint.records()[0].impact > 0.0);
    }
}

/// Sides that are pulled apart count as open in every step from then on, and as cracked, whatever the preload: with supports
/// along their tangents, whose pairs are solved in groups, and without.
#[test]
fn sides_that_have_parted_are_open() {
    let mut noise = Noise(5);
    for round in 0..60 {
        let normal = noise.vector().normalize();
        let pair = JointPair::new([0, 1], normal, 0.25);
        let pressure = 1e6 * (2.5 + noise.vector().x);
        let law = BondedCoulomb::unbonded(0.6, 0.6).unwrap();
        let joint = Joint::new("joint", vec![pair], law).unwrap();
        let mut joint = joint.with_preload(|pair| -pair.normal * pressure).unwrap();
        let mut bodies = Bodies::at_rest(&[300.0, 700.0], 1e-4);
        if round % 2 == 0 {
            bodies.free = normal * normal.transpose();
        }
        let pull = normal * (1.6 * pressure * pair.area);
        let mut parted = 0;
        for _ in 0..40 {
            let gap = (bodies.displacement[1] - bodies.displacement[0]).dot(&normal);
            let sign = |body: usize| 2.0 * body as f64 - 1.0;
            bodies.step(&mut joint, |body| pull * sign(body)).unwrap();
            let record = &joint.records()[0];
            if gap > 1e-9 {
                parted += 1;
                assert_eq!(
                    record.state.contact,
                    ContactState::Open,
                    "{round}: {record:?}"
                );
                assert!(record.first_crack.is_some());
            }
        }
        assert!(parted > 30, "{parted}");
    }
}
