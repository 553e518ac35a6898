//! Isolated pairs: closing, sticking, what is refused.

use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Frictionless, Joint, Paper, PaperParameters, Tied,
};
use powerhouse_model::{Bond, ContactLaw, ContactState, JointConstraint, JointPair, Mat3, Vec3};

use super::{Bodies, Noise, oblique};

fn inclined() -> JointPair {
    JointPair::new([0, 1], Vec3::new(0.2, -0.7, 0.4), 0.3)
}

/// The forces that a joint takes over into the next stage balance those that press its sides together and do not make them
/// slip, whatever the angle between the facets of the pair, whose area is then above the projected one.
#[test]
fn forces_of_a_joint_balance_its_loads() {
    for ratio in [1.0, 1.2, 2.5] {
        let vector = Vec3::new(0.2, -0.7, 0.4);
        let pair = JointPair::of_facets([0, 1], vector, ratio * vector.norm());
        let push = pair.normal * 60.0 + pair.tangent * 7.0;
        let load = |body: usize| if body == 0 { push } else { -push };
        let law = BondedCoulomb::unbonded(0.5, 0.4).unwrap();
        let mut joint = Joint::new("folded", vec![pair], law).unwrap();
        let mut bodies = Bodies::at_rest(&[2.0, 3.0], 1e-3);
        for _ in 0..3 {
            bodies.step(&mut joint, load).unwrap();
        }
        let mut forces = vec![Vec3::zeros(); 2];
        joint.add_joint_forces(&mut forces);
        for (body, force) in forces.into_iter().enumerate() {
            let left = (force + load(body)).norm();
            assert!(left < 1e-12 * push.norm(), "{ratio} {body}: {force}");
        }
    }
}

/// A bonded pair closes a gap and stops all relative motion at once and to rounding, and keeps the
/// sum of effective mass times velocity, for mass ratios from 1e-6 to 1e6, with and without a dashpot
/// at an angle.
#[test]
fn a_bonded_pair_closes_for_any_mass_ratio() {
    for dashpot in [0.0, 4.0e3] {
        for ratio in [1e-6, 1e-3, 0.5, 1.0, 7.0, 1e3, 1e6] {
            let mut noise = Noise(7);
            let mut bodies = Bodies::at_rest(&[3.0, 3.0 * ratio], 1e-3);
            bodies.dashpot[1] = oblique(dashpot * ratio);
            bodies.velocity = vec![noise.vector(), noise.vector()];
            let mut joint = Joint::new("tie", vec![inclined()], Tied).unwrap();
            // One step apart, along the normal alone: a stuck pair keeps its tangential offset.
            bodies.displacement[1] = inclined().normal * 1e-3;
            let momentum =
                |b: &Bodies| b.effective(0) * b.velocity[0] + b.effective(1) * b.velocity[1];
            let free = bodies.clone();
            bodies.step(&mut joint, |_| Vec3::zeros()).unwrap();
            let gap = bodies.displacement[1] - bodies.displacement[0];
            assert!(gap.norm() < 1e-17, "{ratio}: {gap}");
            // The dashpot takes its part of the momentum in the prediction.
            let old = Mat3::identity() * free.mass[1] - free.dashpot[1] * (0.5 * free.step);
            let before = free.effective(0) * free.velocity[0] + old * free.velocity[1];
            let scale = free.effective(0).amax() + free.effective(1).amax();
            assert!(
                (momentum(&bodies) - before).norm() < 1e-14 * scale,
                "{ratio} {dashpot}"
            );
        }
    }
}

/// Sides that move as one from the start have the same velocity to the last bit for ever.
#[test]
fn a_stuck_pair_never_drifts() {
    for dashpot in [0.0, 50.0] {
        let mut noise = Noise(3);
        let mut bodies = Bodies::at_rest(&[2.0, 5.0], 1e-3);
        bodies.dashpot[0] = oblique(dashpot);
        let mut joint = Joint::new("tie", vec![inclined()], Tied).unwrap();
        let mut most = 0.0_f64;
        for _ in 0..1000 {
            let force = [noise.vector(), noise.vector()];
            bodies.step(&mut joint, |body| force[body]).unwrap();
            assert_eq!(bodies.velocity[0], bodies.velocity[1]);
            most = most.max(bodies.kinetic());
        }
        assert_eq!(bodies.displacement[0], bodies.displacement[1]);
        assert!(bodies.residual(0.0).abs() < 1e-13 * most);
    }
}

/// A held side holds the other and is not moved, and two held sides are left alone.
#[test]
fn held_sides_stay_where_they_are() {
    let mut bodies = Bodies::at_rest(&[2.0, 3.0], 1e-3);
    bodies.fixed[0] = true;
    let mut joint = Joint::new("tie", vec![inclined()], Tied).unwrap();
    let pull = |body: usize| Vec3::repeat(body as f64);
    bodies.step(&mut joint, pull).unwrap();
    assert_eq!(bodies.velocity, [Vec3::zeros(); 2]);
    let pressure = -3.0_f64.sqrt().powi(2) / 0.3;
    assert!((joint.records()[0].traction.norm() + pressure * 3.0_f64.sqrt() / 3.0).abs() < 1e-12);

    bodies.fixed[1] = true;
    let mut joint = Joint::new("tie", vec![inclined()], Tied).unwrap();
    let moved = |body: usize| Vec3::repeat(1.0 + body as f64);
    bodies.step(&mut joint, moved).unwrap();
    assert_eq!(bodies.velocity, [moved(0), moved(1)]);
    assert_eq!(joint.isolated_count(), 0);
}

/// At the ends of a slice supports hold both sides along a tangent. Pairs there are corrected in one
/// pass like all others, and move as they would without these supports; those with a traction along
/// that tangent, which no motion answers, are not.
#[test]
fn pairs_held_along_a_tangent_slide_across_it() {
    let law = || BondedCoulomb::unbonded(0.5, 0.4).unwrap();
    for (k, preload) in [(0, 0.0), (1, 0.0), (2, 0.0), (5, -0.5)] {
        let angle = 0.4 * f64::from(k);
        let pair = JointPair::new([0, 1], Vec3::new(angle.sin(), 0.0, angle.cos()), 2.0);
        let static_traction = |_: &JointPair| pair.normal * -3.0 + Vec3::y() * preload;
        let make = || {
            let joint = Joint::new("joint", vec![pair], law()).unwrap();
            joint.with_preload(static_traction).unwrap()
        };
        let (mut held, mut free) = (make(), make());
        let mut slice = Bodies::at_rest(&[2.0, 3.0], 1e-2);
        let mut whole = slice.clone();
        slice.free = Mat3::identity() - Vec3::y() * Vec3::y().transpose();
        let mut slid = false;
        for step in 0..60 {
            let phase = 0.2 * f64::from(step);
            let force = |body: usize| {
                let along = Vec3::new(phase.sin(), 0.0, phase.cos());
                along * (6.0 - 9.0 * body as f64)
            };
            slice.step(&mut held, force).unwrap();
            assert!(slice.velocity.iter().all(|v| v.y.abs() < 1e-16));
            if preload != 0.0 {
                continue;
            }
            whole.step(&mut free, force).unwrap();
            slid |= free.records()[0].state.contact == ContactState::Slide;
            for (a, b) in slice.velocity.iter().zip(&whole.velocity) {
                assert!((a - b).norm() < 1e-14, "{a} {b}");
            }
            let (a, b) = (held.records()[0].traction, free.records()[0].traction);
            assert!((a - b).norm() < 1e-13, "{a} {b}");
        }
        assert_eq!(held.isolated_count(), usize::from(preload == 0.0));
        assert!(slid || preload != 0.0);
    }
}

/// An initial gap must be closed before anything is felt; then the sides stop each other there.
#[test]
fn a_gap_is_closed_before_anything_is_felt() {
    let pair = JointPair::new([0, 1], Vec3::z(), 1.0);
    let joint = Joint::new("gap", vec![pair], Frictionless).unwrap();
    let mut joint = joint.with_gaps(|_| 2.5e-3).unwrap();
    let mut bodies = Bodies::at_rest(&[1.0, 1.0], 1e-3);
    bodies.fixed[0] = true;
    bodies.velocity[1] = -Vec3::z();
    for velocity in [-1.0, -1.0, -0.5] {
        assert_eq!(joint.records()[0].state.contact, ContactState::Open);
        bodies.step(&mut joint, |_| Vec3::zeros()).unwrap();
        assert!((bodies.velocity[1].z - velocity).abs() < 1e-15);
    }
    assert!((bodies.displacement[1].z + 2.5e-3).abs() < 1e-18);
    assert_eq!(joint.records()[0].state.contact, ContactState::Slide);
    assert!((joint.records()[0].peak_opening - 2.5e-3).abs() < 1e-18);
}

/// A preload acts before any motion: it is carried by the static state, so that a pair at rest
/// stays at rest, and a pair that opens or slides is moved by its release.
#[test]
fn a_preload_is_part_of_the_traction() {
    let pair = JointPair::new([0, 1], Vec3::z(), 2.0);
    let law = BondedCoulomb::unbonded(0.5, 0.4).unwrap();
    let preload = Vec3::new(0.0, 40.0, -100.0);
    let joint = || {
        Joint::new("joint", vec![pair], law)
            .unwrap()
            .with_preload(|_| preload)
    };
    let mut still = joint().unwrap();
    let mut bodies = Bodies::at_rest(&[1.0, 1.0], 1e-3);
    bodies.step(&mut still, |_| Vec3::zeros()).unwrap();
    assert_eq!(bodies.velocity, [Vec3::zeros(); 2]);
    assert_eq!(still.records()[0].traction, pair.to_local(&preload));

    // Pulled apart by more than the preload, it opens: the release of the preload moves the sides
    // together, so that they part under what is left.
    let mut open = joint().unwrap();
    let pull = |body: usize| Vec3::z() * (201.0 * (2.0 * body as f64 - 1.0));
    bodies.step(&mut open, pull).unwrap();
    assert_eq!(open.records()[0].traction, Vec3::zeros());
    let expected = Vec3::new(0.0, 80.0, 201.0 - 200.0) * 1e-3;
    assert!(
        (bodies.velocity[1] - expected).norm() < 1e-14,
        "{}",
        bodies.velocity[1]
    );
    assert!(bodies.residual(0.0).abs() < 1e-14);

    let error = Joint::new("joint", vec![pair], law)
        .unwrap()
        .with_preload(|_| Vec3::new(0.0, 60.0, -100.0))
        .unwrap_err();
    assert!(error.to_string().contains("does not admit"), "{error}");
}

/// What a joint cannot be made of is refused before a run.
#[test]
fn senseless_joints_are_refused() {
    let refused = |pairs: Vec<JointPair>| Joint::new("joint", pairs, Tied).unwrap_err().to_string();
    assert!(refused(Vec::new()).contains("no pairs"));
    assert!(refused(vec![JointPair::new([4, 4], Vec3::z(), 1.0)]).contains("index 4"));
    for pair in [
        JointPair::new([0, 1], Vec3::zeros(), 1.0),
        JointPair::new([0, 1], Vec3::z(), 0.0),
        JointPair::new([0, 1], Vec3::z(), f64::NAN),
    ] {
        assert!(refused(vec![pair]).contains("area"));
    }
    let pair = || vec![inclined()];
    let tied = Joint::new("joint", pair(), Tied).unwrap();
    assert!(tied.clone().with_gaps(|_| 1e-3).is_err());
    assert!(tied.clone().with_gaps(|_| -1e-3).is_err());
    assert!(Joint::join(vec![tied.clone(), tied.clone()]).is_err());
    // A law that never lets go has no bond to lose, and one without a bond neither.
    let message = "nodes with indices 0 and 1 has no bond";
    let refused = tied.without_bond(|_| true).unwrap_err().to_string();
    assert!(refused.contains(message), "{refused}");
    let rubbing = BondedCoulomb::unbonded(0.5, 0.4).unwrap();
    let rubbing = Joint::new("joint", pair(), rubbing).unwrap();
    let refused = rubbing.clone().without_bond(|_| true).unwrap_err();
    assert!(refused.to_string().contains(message), "{refused}");
    // No traction across a gap, whichever is said first.
    let press = |pair: &JointPair| -pair.normal;
    let apart = rubbing.clone().with_gaps(|_| 1e-3).unwrap();
    assert!(apart.with_preload(press).is_err());
    let pressed = rubbing.with_preload(press).unwrap();
    assert!(pressed.clone().with_gaps(|_| 0.0).is_ok());
    assert!(pressed.with_gaps(|_| 1e-3).is_err());
}

/// The bond is taken where it is said, and only there.
#[test]
fn a_bond_is_taken_where_it_is_said() {
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 1.0,
        tensile_strength: 1.0,
        static_friction: 0.5,
        dynamic_friction: 0.5,
        cohesion_loss: true,
    });
    let pairs = [[0, 1], [2, 3]].map(|nodes| JointPair::new(nodes, Vec3::z(), 1.0));
    let joint = Joint::new("joint", pairs.to_vec(), law.unwrap()).unwrap();
    let joint = joint.without_bond(|pair| pair.nodes[0] == 2).unwrap();
    let bonds: Vec<Bond> = joint.records().iter().map(|r| r.state.bond).collect();
    assert_eq!(bonds, [Bond::Intact, Bond::Never]);
}

/// A joint of which some pairs have no bond, some are apart and some pressed together.
fn started<L: ContactLaw>(joint: Joint<L>) -> Joint<L> {
    let of = |pair: &JointPair, modulus: u32| pair.nodes[0].is_multiple_of(modulus);
    let pressed = |pair: &JointPair| of(pair, 4) && !of(pair, 14);
    let joint = joint.without_bond(|pair| of(pair, 6)).unwrap();
    let joint = joint.with_gaps(|pair| if of(pair, 14) { 1e-3 } else { 0.0 });
    let pressure = |pair: &JointPair| pair.normal * if pressed(pair) { -25.0 } else { 0.0 };
    joint.unwrap().with_preload(pressure).unwrap()
}

/// Pairs that go side by side through a step come out, to the last bit, as each does by itself: for
/// more and fewer pairs than go together, either side the heavier or held, closed, apart and under
/// preload, through slip, opening and closing; also for a law behind a pointer.
#[test]
fn pairs_side_by_side_are_each_as_if_alone() {
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 30.0,
        tensile_strength: 20.0,
        static_friction: 0.6,
        dynamic_friction: 0.4,
        cohesion_loss: true,
    })
    .unwrap();
    for count in [1, 15, 16, 17, 53] {
        let mut noise = Noise(11 + count as u64);
        let mut bodies = Bodies::at_rest(&vec![1.0; 2 * count], 1e-2);
        let mut pairs = Vec::new();
        for index in 0..count as u32 {
            let normal = noise.vector();
            pairs.push(JointPair::new([2 * index, 2 * index + 1], normal, 0.3));
            bodies.mass[2 * index as usize] = 10.0_f64.powf(noise.next());
            bodies.fixed[2 * index as usize + 1] = index % 5 == 3;
        }
        let any: Box<dyn ContactLaw> = Box::new(law);
        let mut together = started(Joint::new("joint", pairs.clone(), any).unwrap());
        let one = |&pair: &JointPair| started(Joint::new("joint", vec![pair], law).unwrap());
        let mut alone: Vec<_> = pairs.iter().map(one).collect();
        let mut apart = bodies.clone();
        let mut stuck_again = false;
        for _ in 0..300 {
            let forces: Vec<Vec3> = (0..2 * count).map(|_| noise.vector() * 12.0).collect();
            bodies.step(&mut together, |body| forces[body]).unwrap();
            // Each joint moves its own two bodies; the others wait for theirs.
            let mut next = apart.clone();
            for (joint, pair) in alone.iter_mut().zip(&pairs) {
                let mut one = apart.clone();
                one.step(joint, |body| forces[body]).unwrap();
                for node in pair.nodes.map(|node| node as usize) {
                    next.velocity[node] = one.velocity[node];
                    next.displacement[node] = one.displacement[node];
                }
                next.number = one.number;
            }
            apart = next;
            stuck_again |= (together.records().iter())
                .any(|r| r.state.contact == ContactState::Stick && r.first_slip.is_some());
        }
        assert_eq!(bodies.velocity, apart.velocity, "{count}");
        let records: Vec<_> = alone.iter().map(|joint| joint.records()[0]).collect();
        assert_eq!(together.records(), records, "{count}");
        if count > 16 {
            let has = |is: fn(&powerhouse_model::JointRecord) -> bool| records.iter().any(is);
            assert!(has(|r| r.first_slip.is_some()) && has(|r| r.first_crack.is_some()));
            // Some stuck again after they had slid.
            assert!(stuck_again);
        }
    }
}

/// The law of the paper makes the same of a pair by itself and of one that is solved with others, through
/// slip that breaks its bond, tension below its strength that it then bears without shear, and a crack.
#[test]
fn the_law_of_the_paper_is_the_same_for_connected_pairs() {
    let law = Paper::new(PaperParameters {
        cohesion: 4.0e3,
        tensile_strength: 2.0e3,
        static_friction: 0.6,
        dynamic_friction: 0.5,
    })
    .unwrap();
    // Pressure, slip, release, tension below and above the strength, and pressure again (Pa).
    let path = [
        ([-3.0e3, 0.0], 20),
        ([-3.0e3, 7.0e3], 30),
        ([-3.0e3, 0.0], 30),
        ([1.5e3, 0.3e3], 30),
        ([1.9e3, -0.5e3], 30),
        ([2.2e3, 0.0], 10),
        ([-5.0e3, 1.0e3], 60),
    ];
    for direction in [inclined().normal, Vec3::z(), Vec3::new(-1.0, 0.2, 0.0)] {
        let pair = JointPair::new([0, 1], direction, 0.3);
        let go = |unequal: f64| {
            let mut bodies = Bodies::at_rest(&[2.0, 5.0], 1e-3);
            bodies.fixed[0] = true;
            // Masses that differ a little between directions go the way of groups.
            bodies.dashpot[1] = Mat3::from_diagonal(&Vec3::new(0.0, 1.0, 2.0)) * unequal;
            let mut joint = Joint::new("face", vec![pair], law).unwrap();
            let mut seen = Vec::new();
            for ([normal, shear], steps) in path {
                for _ in 0..steps {
                    let force = pair.to_global(&Vec3::new(normal, shear, 0.5 * shear)) * pair.area;
                    let of_body = |body| if body == 1 { force } else { Vec3::zeros() };
                    bodies.step(&mut joint, of_body).unwrap();
                    seen.push(joint.records()[0]);
                }
            }
            assert_eq!(joint.isolated_count(), usize::from(unequal == 0.0));
            seen
        };
        let (alone, group) = (go(0.0), go(1e-6));
        let mut kinds = [false; 3];
        for (step, (a, b)) in alone.iter().zip(&group).enumerate() {
            let states = (a.state.contact, a.state.bond);
            assert_eq!(
                states,
                (b.state.contact, b.state.bond),
                "{step}: {a:?} {b:?}"
            );
            assert!(
                (a.traction - b.traction).norm() < 1.0,
                "{step}: {a:?} {b:?}"
            );
            let broken = a.state.bond == Bond::Broken;
            kinds[0] |= broken && a.state.contact == ContactState::Slide && a.traction.x > 1.0e3;
            kinds[1] |= a.state.contact == ContactState::Open;
            kinds[2] |= broken && a.traction.x < 0.0;
        }
        assert_eq!(kinds, [true; 3]);
    }
}

/// A uniform pressure on facets at an angle reads as itself, whether their pair is solved alone or with
/// others, and so does the pressure at which friction holds it.
#[test]
fn pressure_on_facets_at_an_angle_reads_as_itself() {
    const PRESSURE: f64 = 4.0e3;
    for (degrees, shares) in [
        (36.0_f64, [0.5, 0.5]),
        (20.0, [0.3, 1.1]),
        (40.0, [2.0, 0.1]),
    ] {
        let half = 0.5 * degrees.to_radians();
        let normals =
            [-half, half].map(|angle| Vec3::new(angle.sin(), 0.1, angle.cos()).normalize());
        let vector = normals[0] * shares[0] + normals[1] * shares[1];
        let pair = JointPair::of_facets([0, 1], vector, shares[0] + shares[1]);
        assert!(
            pair.projected_area < pair.area && (pair.projected_area - vector.norm()).abs() < 1e-15
        );
        for unequal in [0.0, 1e-6] {
            for (shear, slides) in [(0.499, false), (0.501, true)] {
                let mut bodies = Bodies::at_rest(&[2.0, 5.0], 1e-3);
                bodies.fixed[0] = true;
                bodies.dashpot[1] = Mat3::from_diagonal(&Vec3::new(0.0, 1.0, 2.0)) * unequal;
                let law = BondedCoulomb::unbonded(0.5, 0.5).unwrap();
                let mut joint = Joint::new("vault", vec![pair], law).unwrap();
                let along = pair.to_global(&Vec3::y());
                let force = (along * shear * vector.norm() - vector) * PRESSURE;
                let of_body = |body| if body == 1 { force } else { Vec3::zeros() };
                bodies.step(&mut joint, of_body).unwrap();
                let record = joint.records()[0];
                assert!(
                    (record.traction.x / -PRESSURE - 1.0).abs() < 1e-6,
                    "{record:?}"
                );
                assert_eq!(
                    record.state.contact == ContactState::Slide,
                    slides,
                    "{record:?}"
                );
            }
        }
    }
}
