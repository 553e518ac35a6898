//! History variables of contact laws.

use powerhouse_contact::{BondedCoulomb, Joint};
use powerhouse_model::{
    ContactLaw, ContactState, HistoryVariable, JointConstraint, JointHistory, JointInput,
    JointPair, JointResponse, JointState, Renewal, Vec3,
};

use super::{Bodies, Noise, oblique};

/// Coulomb friction that sums up the slip that its tractions leave, and counts steps from `first` on.
#[derive(Clone)]
pub(crate) struct Counting {
    friction: BondedCoulomb,
    first: f64,
}

const VARIABLES: [HistoryVariable; 2] = [
    HistoryVariable::amount("travelled", "m"),
    HistoryVariable::amount("steps", "1"),
];

pub(crate) fn counting(first: f64) -> Counting {
    let friction = BondedCoulomb::unbonded(0.5, 0.5).unwrap();
    Counting { friction, first }
}

impl ContactLaw for Counting {
    fn name(&self) -> &str {
        "counting"
    }
    fn initial(&self) -> JointState {
        self.friction.initial()
    }
    fn history(&self) -> &[HistoryVariable] {
        &VARIABLES
    }
    fn initial_history(&self, history: &mut [f64]) {
        history.copy_from_slice(&[0.0, self.first]);
    }
    fn admissible(&self, input: &JointInput, new_history: &mut [f64]) -> JointResponse {
        assert_eq!(input.history, new_history);
        let response = self.friction.admissible(input, &mut []);
        if response.state.contact == ContactState::Slide {
            let [first, second] = input.slip_rate_after(&response.traction);
            new_history[0] = input.history[0] + first.hypot(second) * input.step;
        }
        if input.step > 0.0 {
            new_history[1] = input.history[1] + 1.0;
        }
        response
    }
    fn sliding_strength(&self, normal: f64, input: &JointInput) -> f64 {
        self.friction.sliding_strength(normal, input)
    }
}

const PAIRS: usize = 37;

fn pair(index: usize) -> JointPair {
    let nodes = [2 * index as u32, 2 * index as u32 + 1];
    JointPair::new(nodes, Vec3::new(0.1, 0.2, 1.0), 1.0 + index as f64)
}

/// Two joints of pairs apart from each other, the first of twelve; the second counts from 100 on.
fn joints() -> Joint<Counting> {
    let first = Joint::new("first", (0..12).map(pair).collect(), counting(0.0)).unwrap();
    let second = Joint::new("second", (12..PAIRS).map(pair).collect(), counting(100.0)).unwrap();
    Joint::join(vec![first, second]).unwrap()
}

/// Masses that are pressed together and shaken.
fn shaken(bodies: &mut Bodies, joint: &mut Joint<Counting>, noise: &mut Noise, steps: usize) {
    for _ in 0..steps {
        let forces: Vec<Vec3> = (0..bodies.mass.len())
            .map(|_| noise.vector() * 40.0)
            .collect();
        let pressed = |body: usize| Vec3::z() * if body.is_multiple_of(2) { 30.0 } else { -30.0 };
        bodies
            .step(joint, |body| pressed(body) + forces[body])
            .unwrap();
    }
}

fn bodies() -> Bodies {
    let masses: Vec<f64> = (0..2 * PAIRS).map(|body| 1.0 + (body % 5) as f64).collect();
    Bodies::at_rest(&masses, 1e-3)
}

/// Each pair has its own history, whichever joint and tile it is in and whether one pass solves it or
/// sweeps do: the law's own sum of slips is that of the joint, and every step is counted once.
#[test]
fn each_pair_has_its_own_history() {
    for connected in [false, true] {
        let (mut joint, mut bodies) = (joints(), bodies());
        if connected {
            bodies.dashpot.fill(oblique(300.0));
        }
        shaken(&mut bodies, &mut joint, &mut Noise(3), 200);
        assert_eq!(joint.isolated_count(), if connected { 0 } else { PAIRS });
        let mut slid = 0;
        for index in 0..PAIRS {
            let slip = joint.records()[index].state.slip;
            let [travelled, steps] = *joint.history_of(index) else {
                panic!()
            };
            // Sweeps have a compliance of their own, so that slips of the law are near those of the joint.
            let close = if connected { 0.5 } else { 1e-12 };
            assert!(
                (travelled - slip).abs() <= close * slip,
                "{travelled} {slip}"
            );
            assert_eq!(steps, if index < 12 { 200.0 } else { 300.0 });
            slid += u32::from(slip > 0.0);
        }
        assert!(slid > 30, "{slid}");
        let views = joint.joints();
        assert_eq!(views[1].variables, VARIABLES);
        assert_eq!(views[1].history[..2], *joint.history_of(12));
        assert_eq!(views[1].history.len(), 2 * (PAIRS - 12));
    }
}

/// A joint that goes on from its kept history, with its pairs in another order then, has the same bits as
/// one that was not interrupted.
#[test]
fn a_joint_goes_on_from_its_history() {
    let (mut joint, mut bodies) = (joints(), bodies());
    let mut noise = Noise(3);
    shaken(&mut bodies, &mut joint, &mut noise, 50);
    let mut again = joints();
    for view in joint.joints() {
        let kept = JointHistory::from(&view);
        assert_eq!(kept.variables, ["travelled", "steps"]);
        // The pairs in reverse, and the variables too.
        let reversed = JointHistory::new(
            kept.name,
            kept.nodes.into_iter().rev().collect(),
            kept.records.into_iter().rev().collect(),
        );
        let history = kept.history.into_iter().rev().collect();
        let variables = vec!["steps".into(), "travelled".into()];
        let reversed = reversed.with_history(variables, history);
        assert!(again.restore(&reversed));
        // A list that does not fit is refused.
        let mut short = reversed.clone();
        short.history.pop();
        assert!(!joints().restore(&short));
    }
    let (mut twin, mut same) = (bodies.clone(), Noise(noise.0));
    shaken(&mut bodies, &mut joint, &mut noise, 50);
    shaken(&mut twin, &mut again, &mut same, 50);
    assert_eq!(bodies.displacement, twin.displacement);
    for index in 0..PAIRS {
        assert_eq!(joint.history_of(index), again.history_of(index));
    }
}

/// A variable that an earlier run did not have is initial; grouting makes all of them so, and taking off a
/// tie leaves them.
#[test]
fn variables_start_anew_where_they_should() {
    let (mut joint, mut bodies) = (joints(), bodies());
    shaken(&mut bodies, &mut joint, &mut Noise(3), 20);
    let mut kept = JointHistory::from(&joint.joints()[1]);
    kept.variables[1] = "other".into();
    let mut again = joints();
    assert!(again.restore(&kept));
    assert_eq!(again.history_of(12)[0], joint.history_of(12)[0]);
    assert_eq!(again.history_of(12)[1], 100.0);
    assert_eq!(joint.history_of(12)[1], 120.0);
    let here = vec![Vec3::zeros(); 2 * PAIRS];
    assert!(joint.renew("second", Renewal::Released, &here));
    assert_eq!(joint.history_of(12)[1], 120.0);
    assert!(joint.renew("second", Renewal::Grouted, &here));
    assert_eq!(*joint.history_of(12), [0.0, 100.0]);
    assert_eq!(joint.history_of(11)[1], 20.0);
}

/// A pair that rides on its asperities when its tie is taken off goes on doing so: it was closed where it is less its dilation
/// along its normal. Grouted, it is closed where it is.
#[test]
fn a_released_pair_keeps_its_dilation() {
    let dilation = |index: usize| 1e-3 * index as f64;
    let mut noise = Noise(11);
    let displacement: Vec<Vec3> = (0..2 * PAIRS).map(|_| noise.vector()).collect();
    let mut kept = JointHistory::from(&joints().joints()[0]);
    for (index, record) in kept.records.iter_mut().enumerate() {
        record.dilation = dilation(index);
    }
    for (renewal, share) in [(Renewal::Released, 1.0), (Renewal::Grouted, 0.0)] {
        let mut joint = joints();
        assert!(joint.restore(&kept));
        assert!(joint.renew("first", renewal, &displacement));
        for index in 0..12 {
            let [first, second] = [0, 1].map(|side| displacement[2 * index + side]);
            let mut expected = pair(index).to_local(&(second - first));
            expected.x -= share * dilation(index);
            let found = Vec3::from(joint.records()[index].closed_at.unwrap());
            assert!((found - expected).norm() < 1e-14, "{index}: {found}");
        }
    }
}
