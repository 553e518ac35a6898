//! Joints of many pairs, which threads share.

use powerhouse_contact::{BondedCoulomb, BondedCoulombParameters, Joint};
use powerhouse_model::{
    Constraint, ConstraintParts, ContactLaw, ContactState, DividedConstraint, JointPair,
    JointRecord, Vec3,
};

use super::history::counting;
use super::{Bodies, Noise};

/// Number of pairs, enough for several threads.
const PAIRS: usize = 2500;
/// Interval at which a pair shares a node with the one before.
const SHARED: usize = 60;

/// Nodes of each pair: two of its own, but for those that share one.
fn nodes_of_pairs() -> Vec<[u32; 2]> {
    let shares = |pair: usize| pair % SHARED == SHARED - 1;
    let pairs = (0..PAIRS as u32).map(|pair| {
        if shares(pair as usize) {
            [2 * pair - 1, 2 * pair + 1]
        } else {
            [2 * pair, 2 * pair + 1]
        }
    });
    pairs.collect()
}

fn joint<L: ContactLaw>(pairs: impl Iterator<Item = usize>, law: L) -> Joint<L> {
    let nodes = nodes_of_pairs();
    let pair = |index: usize| {
        let lean = 0.1 * (index as f64).sin();
        JointPair::new(
            nodes[index],
            Vec3::new(lean, 0.2, 1.0).normalize(),
            1.0 + lean,
        )
    };
    Joint::new("joint", pairs.map(pair).collect(), law).unwrap()
}

/// Bodies of different masses that are pressed together and shaken for some steps.
fn shaken(joint: &mut dyn Constraint) -> Bodies {
    let mut noise = Noise(41);
    let masses: Vec<f64> = (0..2 * PAIRS).map(|_| 2.0 + noise.next()).collect();
    let mut bodies = Bodies::at_rest(&masses, 1e-3);
    for _ in 0..30 {
        let forces: Vec<Vec3> = (0..2 * PAIRS).map(|_| noise.vector() * 40.0).collect();
        let pressed = |body: usize| Vec3::z() * if body.is_multiple_of(2) { 30.0 } else { -30.0 };
        bodies
            .step(joint, |body| pressed(body) + forces[body])
            .unwrap();
    }
    bodies
}

fn bits(vectors: &[Vec3]) -> Vec<[u64; 3]> {
    vectors
        .iter()
        .map(|v| [0, 1, 2].map(|c| v[c].to_bits()))
        .collect()
}

fn bits_of_records(records: &[JointRecord]) -> Vec<[u64; 6]> {
    let of = |r: &JointRecord| {
        let [x, y, z] = [0, 1, 2].map(|c| r.traction[c].to_bits());
        [
            x,
            y,
            z,
            r.friction.to_bits(),
            r.impact.to_bits(),
            r.state.slip.to_bits(),
        ]
    };
    records.iter().map(of).collect()
}

/// One, two and four threads give the same bits of motion, records, history variables and work, and each pair moves as
/// it does in a joint of its own.
fn check<L: ContactLaw + Clone>(law: L) {
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let mut all = joint(0..PAIRS, law.clone());
        let bodies = pool.build().unwrap().install(|| shaken(&mut all));
        (bodies, all)
    };
    let (one, of_one) = with_threads(1);
    let states = of_one.records().iter().map(|record| record.state.contact);
    for wanted in [ContactState::Stick, ContactState::Slide, ContactState::Open] {
        assert!(states.clone().any(|state| state == wanted), "{wanted:?}");
    }
    assert!(of_one.isolated_count() > 2300);
    for threads in [2, 4] {
        let (bodies, other) = with_threads(threads);
        assert_eq!(bits(&one.velocity), bits(&bodies.velocity));
        assert_eq!(bits(&one.displacement), bits(&bodies.displacement));
        assert_eq!(one.work, bodies.work);
        assert_eq!(
            bits_of_records(of_one.records()),
            bits_of_records(other.records())
        );
        for pair in (0..PAIRS).step_by(97) {
            assert_eq!(of_one.history_of(pair), other.history_of(pair));
        }
    }
    let some: Vec<usize> = (0..PAIRS)
        .filter(|pair| pair % 7 == 3 && pair % SHARED < 50)
        .collect();
    let mut alone = joint(some.iter().copied(), law.clone());
    let bodies = shaken(&mut alone);
    for (record, &pair) in bits_of_records(alone.records()).iter().zip(&some) {
        assert_eq!(
            [*record],
            bits_of_records(&of_one.records()[pair..=pair])[..]
        );
        let nodes = [2 * pair, 2 * pair + 1];
        let of = |bodies: &Bodies| bits(&nodes.map(|node| bodies.velocity[node]));
        assert_eq!(of(&one), of(&bodies), "pair {pair}");
    }
}

/// Threads do not change a bit, with a law without history variables.
#[test]
fn threads_change_no_bit() {
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 20.0,
        tensile_strength: 10.0,
        static_friction: 0.6,
        dynamic_friction: 0.4,
        cohesion_loss: true,
    });
    check(law.unwrap());
}

/// Threads do not change a bit, with a law that has history variables.
#[test]
fn threads_change_no_bit_of_history() {
    check(counting(3.0));
}

/// The parts of a joint are its pairs, and those that share a node together; each node is in one.
#[test]
fn parts_of_a_joint_are_connected_pairs() {
    let joint = joint(0..PAIRS, BondedCoulomb::unbonded(0.5, 0.5).unwrap());
    let parts = joint.parts();
    assert_eq!(parts.len(), PAIRS - PAIRS / SHARED);
    let shared = 2 * SHARED as u32;
    let first = [shared - 4, shared - 3, shared - 1];
    assert!(parts.iter().any(|part| part == first));
    let mut nodes = joint.nodes().to_vec();
    nodes.sort_unstable();
    assert_eq!(parts.nodes(), nodes);
    assert_eq!(parts, ConstraintParts::connected_by(&nodes_of_pairs()));
}
