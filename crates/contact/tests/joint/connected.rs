//! Pairs that share nodes: joints that meet at a line, corners.

use powerhouse_contact::{BondedCoulomb, BondedCoulombParameters, Joint, Tied};
use powerhouse_model::{
    Bond, ContactLaw, ContactState, JointConstraint, JointHistory, JointInput, JointPair,
    JointRecord, JointResponse, JointState, RunError, Vec3,
};

use super::{Bodies, Noise, oblique};

/// Three bodies around a line, at 30, 150 and 270 degrees, their interfaces half-way between them.
fn triple(law: impl ContactLaw + Clone) -> Joint<impl ContactLaw> {
    let normal = |degrees: f64| {
        let angle = degrees.to_radians();
        Vec3::new(angle.cos(), angle.sin(), 0.0)
    };
    let pair = |nodes, degrees| vec![JointPair::new(nodes, normal(degrees), 1.0)];
    let joint = |name, nodes, degrees| Joint::new(name, pair(nodes, degrees), law.clone()).unwrap();
    Joint::join(vec![
        joint("a-b", [0, 1], 180.0),
        joint("b-c", [1, 2], 300.0),
        joint("c-a", [2, 0], 60.0),
    ])
    .unwrap()
}

/// Three bonded bodies get their common velocity at once, to the last bit, for masses from 1e-6 to
/// 1e6 of each other: no sweep, no drift.
#[test]
fn a_bonded_line_moves_as_one() {
    for masses in [
        [1.0, 1.0, 1.0],
        [1.0, 1e-6, 1.0],
        [1e6, 1.0, 1e6],
        [1.0, 1e6, 1e-6],
    ] {
        let mut noise = Noise(23);
        let mut bodies = Bodies::at_rest(&masses, 1e-3);
        bodies.dashpot[1] = oblique(30.0);
        let mut joint = triple(Tied);
        for _ in 0..200 {
            let force = [noise.vector(), noise.vector(), noise.vector()];
            bodies
                .step(&mut joint, |body| force[body] * masses[body])
                .unwrap();
            assert_eq!(bodies.velocity[0], bodies.velocity[1]);
            assert_eq!(bodies.velocity[0], bodies.velocity[2]);
        }
        let scale = bodies.kinetic();
        assert!(bodies.residual(0.0).abs() < 1e-10 * scale, "{masses:?}");
        assert_eq!(joint.joints()[0].most_sweeps, 0);
    }
}

/// At a line where three bodies rub, every pair obeys Coulomb's law and the balance closes.
#[test]
fn a_rubbing_line_obeys_every_pair() {
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 2.0,
        tensile_strength: 1.0,
        static_friction: 0.6,
        dynamic_friction: 0.4,
        cohesion_loss: true,
    })
    .unwrap();
    let mut joint = triple(law);
    let mut bodies = Bodies::at_rest(&[1.0, 2.0, 0.5], 0.01);
    let mut noise = Noise(29);
    let place = [30.0_f64, 150.0, 270.0].map(f64::to_radians);
    let mut states = [0; 3];
    for _ in 0..5_000 {
        // Bodies are drawn to the line, and shaken.
        let force: Vec<Vec3> = (0..3)
            .map(|body| {
                let outwards = Vec3::new(place[body].cos(), place[body].sin(), 0.0);
                noise.vector() * 6.0 - outwards * 4.0 - bodies.displacement[body] * 20.0
            })
            .collect();
        bodies.step(&mut joint, |body| force[body]).unwrap();
        for (pair, record) in joint.pairs().iter().zip(joint.records()) {
            let [first, second] = pair.nodes.map(|node| node as usize);
            let after = pair.to_local(&(bodies.velocity[second] - bodies.velocity[first]));
            let gap = pair
                .to_local(&(bodies.displacement[second] - bodies.displacement[first]))
                .x;
            assert!(gap > -1e-9, "{gap}");
            let traction = record.traction;
            if record.state.bond == Bond::Intact {
                assert!(after.norm() < 1e-9);
                continue;
            }
            let (shear, strength) = (traction.y.hypot(traction.z), -0.6 * traction.x);
            assert!(
                traction.x <= 0.0 && shear <= strength * (1.0 + 1e-9),
                "{traction}"
            );
            match record.state.contact {
                ContactState::Stick => states[0] += 1,
                ContactState::Slide => states[1] += 1,
                ContactState::Open => {
                    states[2] += 1;
                    assert_eq!(traction.x, 0.0);
                }
            }
        }
    }
    assert!(states.iter().all(|&count| count > 200), "{states:?}");
    let spent = bodies.work.friction + bodies.work.impact;
    assert!(spent > 0.0 && bodies.residual(0.0).abs() < 1e-9 * spent);
    assert!(joint.joints()[0].worst_residual <= 1e-8);
}

/// The pairs of a line break one after the other: pulled body by body, only the bonds of that body
/// break, though all three share its motion before.
#[test]
fn only_overloaded_bonds_of_a_line_break() {
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 1e9,
        tensile_strength: 100.0,
        static_friction: 0.6,
        dynamic_friction: 0.4,
        cohesion_loss: true,
    })
    .unwrap();
    let mut joint = triple(law);
    let mut bodies = Bodies::at_rest(&[1.0; 3], 1e-3);
    let outwards = Vec3::new(30.0_f64.to_radians().cos(), 0.5, 0.0);
    for number in 0..100 {
        let pull = outwards * f64::from(number) * 10.0;
        let others = -pull / 2.0;
        bodies
            .step(&mut joint, |body| if body == 0 { pull } else { others })
            .unwrap();
    }
    let bonds: Vec<Bond> = joint
        .records()
        .iter()
        .map(|record| record.state.bond)
        .collect();
    assert_eq!(bonds, [Bond::Broken, Bond::Intact, Bond::Broken]);
    assert_eq!(bodies.velocity[1], bodies.velocity[2]);
}

/// Two pairs on the same two nodes, one for each face of a corner: the inner body can leave the
/// corner along neither face's normal inwards, and slides along an edge that both faces share.
#[test]
fn a_corner_has_a_pair_for_each_face() {
    let pairs = vec![
        JointPair::new([0, 1], Vec3::x(), 1.0),
        JointPair::new([0, 1], Vec3::y(), 1.0),
    ];
    let law = BondedCoulomb::unbonded(0.3, 0.3).unwrap();
    let mut joint = Joint::new("corner", pairs, law).unwrap();
    let mut bodies = Bodies::at_rest(&[1.0, 1.0], 1e-3);
    bodies.fixed[0] = true;
    // Pressed into the corner by 10 N on each face and pushed along the edge by 9 N, against
    // friction of 3 N from each face.
    let push = Vec3::new(-10.0, -10.0, 9.0);
    for _ in 0..100 {
        let force = |body: usize| if body == 0 { Vec3::zeros() } else { push };
        bodies.step(&mut joint, force).unwrap();
    }
    let expected = Vec3::new(0.0, 0.0, 3.0 * 0.1);
    assert!(
        (bodies.velocity[1] - expected).norm() < 1e-9,
        "{}",
        bodies.velocity[1]
    );
}

/// A joint with a law of each kind: what is joined keeps its names, laws and records apart, and a
/// record that is put back lets it go on with the same bits.
#[test]
fn joined_joints_keep_their_records_apart() {
    let boxed = |law: Box<dyn ContactLaw>, name: &str, nodes| {
        Joint::new(name, vec![JointPair::new(nodes, Vec3::z(), 1.0)], law).unwrap()
    };
    let make = || {
        let friction = BondedCoulomb::unbonded(0.2, 0.1).unwrap();
        Joint::join(vec![
            boxed(Box::new(friction), "lower", [0, 1]),
            boxed(Box::new(Tied), "upper", [1, 2]),
            boxed(Box::new(friction), "aside", [3, 4]),
        ])
        .unwrap()
    };
    let mut joint = make();
    let mut bodies = Bodies::at_rest(&[1.0, 2.0, 3.0, 4.0, 5.0], 1e-3);
    let force = |body: usize| Vec3::new(0.1 * body as f64, 0.0, 2.0 - body as f64);
    for _ in 0..50 {
        bodies.step(&mut joint, force).unwrap();
    }
    let names: Vec<_> = joint
        .joints()
        .iter()
        .map(|view| (view.name.to_owned(), view.law.to_owned()))
        .collect();
    let expected = [
        ("lower", "bonded-coulomb"),
        ("upper", "tied"),
        ("aside", "bonded-coulomb"),
    ];
    assert_eq!(names, expected.map(|(a, b)| (a.to_owned(), b.to_owned())));
    assert_eq!(joint.isolated_count(), 1);

    let (mut again, mut twin) = (make(), bodies.clone());
    let kept: Vec<JointHistory> = joint.joints().iter().map(JointHistory::from).collect();
    for history in &kept {
        assert!(again.restore(history));
    }
    let other = |change: &dyn Fn(&mut JointHistory)| {
        let mut history = kept[0].clone();
        change(&mut history);
        !make().restore(&history)
    };
    assert!(other(&|history| history.name = "none".into()));
    assert!(other(&|history| history.nodes[0] = [0, 2]));
    assert!(other(&|history| {
        history.records.clear();
        history.nodes.clear();
    }));
    assert!(other(&|history| {
        history.records.push(history.records[0]);
        history.nodes.push([3, 4]);
    }));
    for _ in 0..50 {
        bodies.step(&mut joint, force).unwrap();
        twin.step(&mut again, force).unwrap();
    }
    assert_eq!(bodies.displacement, twin.displacement);
    assert_eq!(joint.records(), again.records());
    // Closed pairs take their tractions for references where they are to keep them.
    again.keep_tractions();
    for (kept, record) in again.records().iter().zip(joint.records()) {
        let is_open = record.state.contact == ContactState::Open;
        let traction = (!is_open).then(|| record.traction.into());
        assert_eq!(kept.reference, traction);
    }
}

/// Records find their pairs by the nodes, in whatever order the pairs were; those of one pair of nodes
/// at an edge keep theirs.
#[test]
fn records_find_their_pairs_by_nodes() {
    let pair = |nodes, normal| JointPair::new(nodes, normal, 1.0);
    let here = [
        pair([0, 1], Vec3::z()),
        pair([2, 3], Vec3::z()),
        pair([2, 3], Vec3::x()),
    ];
    let mut joint = Joint::new("joint", here.to_vec(), Tied).unwrap();
    let record = |slip: f64| {
        let mut record = JointRecord::default();
        record.state.slip = slip;
        record
    };
    let history = JointHistory::new(
        "joint",
        vec![[2, 3], [0, 1], [2, 3]],
        vec![record(2.0), record(1.0), record(3.0)],
    );
    assert!(joint.restore(&history));
    let slips: Vec<f64> = joint.records().iter().map(|r| r.state.slip).collect();
    assert_eq!(slips, [1.0, 2.0, 3.0]);
}

/// At a corner of a block three patches pair the same two nodes. If the bond of one cracks the others
/// hold the nodes together, which leaves its own traction without an effect: it has none from then on,
/// they carry everything, and nothing moves until they crack too.
#[test]
fn patches_of_a_corner_crack_one_by_one() {
    let law = |strength: f64| {
        BondedCoulomb::new(BondedCoulombParameters {
            cohesion: 1e3,
            tensile_strength: strength,
            static_friction: 0.5,
            dynamic_friction: 0.5,
            cohesion_loss: true,
        })
        .unwrap()
    };
    let sides = [
        ("x", Vec3::x(), 1.0),
        ("y", Vec3::y(), 1e3),
        ("z", Vec3::new(0.1, 0.0, 1.0), 1e3),
    ];
    let joint = |(name, normal, strength)| {
        Joint::new(
            name,
            vec![JointPair::new([0, 1], normal, 1.0)],
            law(strength),
        )
        .unwrap()
    };
    let mut joint = Joint::join(sides.map(joint).to_vec()).unwrap();
    let mut bodies = Bodies::at_rest(&[2.0, 3.0], 1e-3);
    let mut cracked = None;
    for step in 0..2_000 {
        let pull = Vec3::new(1.0, 0.1, -0.3) * (0.01 * step as f64);
        let force = |body: usize| pull * (2.0 * body as f64 - 1.0);
        bodies.step(&mut joint, force).unwrap();
        let [x, y, z] = [0, 1, 2].map(|pair| joint.records()[pair]);
        let apart = (bodies.velocity[1] - bodies.velocity[0]).norm();
        assert!(apart <= 1e-14 * pull.norm(), "{step}: {apart:e}");
        if x.state.bond == Bond::Broken {
            cracked.get_or_insert(step);
            assert_eq!(
                (x.state.contact, x.traction),
                (ContactState::Open, Vec3::zeros())
            );
        }
        assert!(y.state.bond == Bond::Intact && z.state.bond == Bond::Intact);
        // What they carry together is the force between the bodies.
        let carried: Vec3 = (joint.pairs().iter().zip(joint.records()))
            .map(|(pair, record)| pair.to_global(&record.traction))
            .sum();
        let error = (carried - pull).norm();
        assert!(error <= 1e-9 * pull.norm(), "{step}: {error:e}");
    }
    assert!(cracked.is_some_and(|step| step > 10), "{cracked:?}");
}

/// Law with friction that says of a bond that it is intact, whatever it bears.
#[derive(Clone)]
struct Stubborn(BondedCoulomb);

impl ContactLaw for Stubborn {
    fn name(&self) -> &str {
        "stubborn"
    }
    fn initial(&self) -> JointState {
        self.0.initial()
    }
    fn admissible(&self, input: &JointInput, new_history: &mut [f64]) -> JointResponse {
        let mut response = self.0.admissible(input, new_history);
        response.state.bond = Bond::Intact;
        response
    }
    fn sliding_strength(&self, normal: f64, input: &JointInput) -> f64 {
        self.0.sliding_strength(normal, input)
    }
}

/// Connected pairs of a law whose bond never breaks though its strength is exceeded end in an error that names the joint, not
/// in endless sweeps.
#[test]
fn bonds_that_do_not_yield_are_an_error() {
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 2.0,
        tensile_strength: 1.0,
        static_friction: 0.6,
        dynamic_friction: 0.4,
        cohesion_loss: true,
    })
    .unwrap();
    for direction in [Vec3::x(), Vec3::new(0.2, 1.0, -0.5), Vec3::z()] {
        let mut joint = triple(Stubborn(law));
        let mut bodies = Bodies::at_rest(&[1.0, 2.0, 0.5], 0.01);
        let mut found = None;
        for step in 0..1_000 {
            let pull = direction * (0.02 * f64::from(step));
            let force = |body: usize| pull * [1.0, 0.3, -1.3][body];
            if let Err(error) = bodies.step(&mut joint, force) {
                found = Some((step, error));
                break;
            }
        }
        let (step, error) = found.expect("a strength that is exceeded");
        assert!(step > 10, "{step}");
        assert!(
            matches!(&error, RunError::Constraint { name, .. } if name.contains("a-b")),
            "{error}"
        );
    }
}
