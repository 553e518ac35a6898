//! Laws behind pointers, and batches of pairs.

use super::*;
use core::sync::atomic::{AtomicUsize, Ordering};

/// Admits everything and counts its evaluations.
#[derive(Default)]
struct Counting {
    alone: AtomicUsize,
    together: AtomicUsize,
}

impl ContactLaw for Counting {
    fn name(&self) -> &str {
        "counting"
    }
    fn initial(&self) -> JointState {
        JointState::default()
    }
    fn admissible(&self, input: &JointInput, _new_history: &mut [f64]) -> JointResponse {
        self.alone.fetch_add(1, Ordering::Relaxed);
        JointResponse::new(input.trial, input.state)
    }
    fn admit(&self, _inputs: &JointInputs, _responses: &mut JointResponses) {
        self.together.fetch_add(1, Ordering::Relaxed);
    }
    fn sliding_strength(&self, _normal: f64, _input: &JointInput) -> f64 {
        0.0
    }
}

/// Behind every pointer a law is evaluated once for many pairs, and not pair by pair.
#[test]
fn a_law_behind_a_pointer_is_evaluated_once_for_many_pairs() {
    fn evaluate(law: impl ContactLaw) {
        let (mut tractions, mut states) = ([Vec3::zeros(); 3], [JointState::default(); 3]);
        let mut responses = JointResponses::new(&mut tractions, &mut states);
        law.admit(&JointInputs::default(), &mut responses);
    }
    let law = Arc::new(Counting::default());
    evaluate(law.as_ref() as &dyn ContactLaw);
    evaluate(law.clone() as Arc<dyn ContactLaw>);
    evaluate(Box::new(law.clone()) as Box<dyn ContactLaw>);
    let counts = [&law.alone, &law.together].map(|count| count.load(Ordering::Relaxed));
    assert_eq!(counts, [0, 3]);
}

/// Adds the whole input to its history, and returns it as traction and dilation.
struct Adding;

const SUMS: [HistoryVariable; 2] = [
    HistoryVariable::amount("sum", "1"),
    HistoryVariable::amount("constant", "1"),
];

impl ContactLaw for Adding {
    fn name(&self) -> &str {
        "adding"
    }
    fn initial(&self) -> JointState {
        JointState::default()
    }
    fn history(&self) -> &[HistoryVariable] {
        &SUMS
    }
    fn admissible(&self, input: &JointInput, new_history: &mut [f64]) -> JointResponse {
        let rates = input.slip_rate[0] + input.slip_rate[1];
        let site = input.area + input.position.sum() + input.compliance + input.spacing;
        let shear = input.shear_displacement[0] + input.shear_displacement[1];
        let sum = shear
            + input.opening_rate
            + rates
            + site
            + input.opening
            + input.step
            + input.time
            + input.dilation;
        new_history[0] += sum;
        let traction = Vec3::new(sum, input.history[0], input.history[1]);
        JointResponse::new(traction, input.state).with_dilation(sum)
    }
    fn sliding_strength(&self, _normal: f64, _input: &JointInput) -> f64 {
        0.0
    }
}

/// Each pair of a batch gets its own values, and those that are not given are zero, areas one.
#[test]
fn each_pair_of_a_batch_gets_its_own_values() {
    let history = [1.0, 2.0, 3.0, 4.0];
    let inputs = JointInputs {
        variables: 2,
        history: &history,
        slip_rate: [&[0.01, 0.02], &[0.001, 0.002]],
        opening: &[10.0, 20.0],
        compliance: &[100.0, 200.0],
        area: &[1e3, 2e3],
        position: [&[1e4, 2e4], &[1e5, 2e5], &[1e6, 2e6]],
        opening_rate: &[1e-4, 2e-4],
        shear_displacement: [&[1e-5, 2e-5], &[1e-6, 2e-6]],
        spacing: &[1e-7, 2e-7],
        step: 0.5,
        time: 0.25,
    };
    let (mut tractions, mut states) = ([Vec3::zeros(); 2], [JointState::default(); 2]);
    let (mut new, mut dilations) = (history, [1e7, 2e7]);
    let mut responses = JointResponses::new(&mut tractions, &mut states);
    responses = responses.with_history(&mut new, &mut dilations);
    Adding.admit(&inputs, &mut responses);
    for (pair, &dilation) in dilations.iter().enumerate() {
        let sum = (pair + 1) as f64 * 11_111_110.011_111_1 + 0.75;
        assert!((dilation - sum).abs() < 1e-8, "{dilation}");
        let [first, second] = [history[2 * pair], history[2 * pair + 1]];
        assert_eq!(tractions[pair], Vec3::new(dilation, first, second));
        assert_eq!(new[2 * pair], first + dilation);
        assert_eq!(new[2 * pair + 1], second);
    }
    let bare = JointInputs::default();
    let input = bare.of_pair(1, Vec3::x(), &JointState::default(), 0.0);
    assert_eq!(input, JointInput::new(Vec3::x(), &JointState::default()));
}
