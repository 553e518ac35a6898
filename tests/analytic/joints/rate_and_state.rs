//! Rate-and-state friction as a contact law of one's own, against its closed form in velocity steps.
//!
//! The coefficient of friction depends on the slip rate `V` and on the state `theta` (s), the mean age of
//! contacts (Dieterich 1979; Ruina 1983):
//!
//! `mu = mu0 + a ln(V / V0) + b ln(V0 theta / Dc)`, `d theta / dt = 1 - V theta / Dc`
//!
//! in the form that stays finite at `V = 0` (Rice & Ben-Zion 1996):
//! `mu = a asinh(V / (2 V0) exp((mu0 + b ln(V0 theta / Dc)) / a))`, which needs no floor of the velocity.

use powerhouse_model::{
    ContactLaw, ContactState, HistoryVariable, JointInput, JointResponse, JointState, Vec3,
};

use super::block::Block;

/// Rate-and-state friction with the ageing law.
#[derive(Clone, Copy, Debug)]
struct RateAndState {
    /// Friction coefficient `mu0` at the reference slip rate in the steady state.
    reference: f64,
    /// Reference slip rate `V0` (m/s).
    rate: f64,
    /// Direct effect `a` and evolution effect `b`.
    direct: f64,
    evolution: f64,
    /// Characteristic slip `Dc` (m).
    slip: f64,
}

const STATE: [HistoryVariable; 1] = [HistoryVariable::amount("theta", "s")];

impl RateAndState {
    /// Slip rate (m/s) at which the shear strength under a pressure (Pa) is a shear traction (Pa).
    fn slip_rate(&self, shear: f64, pressure: f64, theta: f64) -> f64 {
        let state = self.reference + self.evolution * (self.rate * theta / self.slip).ln();
        let root = (shear / (pressure * self.direct)).sinh();
        2.0 * self.rate * root * (-state / self.direct).exp()
    }
    /// Shear strength (Pa) that belongs to the slip rate which it leaves of the trial: the root of
    /// `trial - tau = V(tau) / compliance`.
    fn strength(&self, normal: f64, input: &JointInput) -> f64 {
        let (pressure, theta) = (-normal, input.history[0]);
        if pressure <= 0.0 || input.compliance <= 0.0 {
            // Without a step there is no slip: what holds is held.
            return if pressure > 0.0 {
                input.trial_shear()
            } else {
                0.0
            };
        }
        let (mut low, mut high) = (0.0, input.trial_shear());
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            let rate = self.slip_rate(middle, pressure, theta);
            if (input.trial_shear() - middle) * input.compliance > rate {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

impl ContactLaw for RateAndState {
    fn name(&self) -> &str {
        "rate-and-state"
    }
    fn initial(&self) -> JointState {
        JointState::default()
    }
    fn history(&self) -> &[HistoryVariable] {
        &STATE
    }
    /// The steady state at the reference slip rate.
    fn initial_history(&self, history: &mut [f64]) {
        history[0] = self.slip / self.rate;
    }
    fn admissible(&self, input: &JointInput, new_history: &mut [f64]) -> JointResponse {
        let trial = input.trial;
        let age = |rate: f64| {
            // Exact for a constant slip rate in the step.
            let decay = rate * input.step / self.slip;
            let share = if decay > 0.0 {
                -(-decay).exp_m1() / decay
            } else {
                1.0
            };
            input.history[0] * (-decay).exp() + input.step * share
        };
        if trial.x > 0.0 {
            new_history[0] = age(0.0);
            let open = input.state.with_contact(ContactState::Open);
            return JointResponse::new(Vec3::zeros(), open);
        }
        let (shear, strength) = (input.trial_shear(), self.strength(trial.x, input));
        let share = if shear > 0.0 { strength / shear } else { 1.0 };
        let traction = Vec3::new(trial.x, trial.y * share, trial.z * share);
        let [first, second] = input.slip_rate_after(&traction);
        new_history[0] = age(first.hypot(second));
        let contact = if traction == trial {
            ContactState::Stick
        } else {
            ContactState::Slide
        };
        JointResponse::new(traction, input.state.with_contact(contact))
    }
    fn sliding_strength(&self, normal: f64, input: &JointInput) -> f64 {
        self.strength(normal, input)
    }
}

const LAW: RateAndState = RateAndState {
    reference: 0.6,
    rate: 1e-2,
    direct: 0.01,
    evolution: 0.016,
    slip: 1e-3,
};

/// Pressing force (N) and step (s).
const PRESSING: f64 = 1e6;
const STEP: f64 = 1e-4;

/// A block so heavy that friction does not change its slip rate by more than some millionths, in the
/// steady state at the reference slip rate.
fn steady() -> Block<RateAndState> {
    let mut block = Block::new(LAW, 1e10, STEP);
    for _ in 0..100 {
        block.drive(LAW.rate, PRESSING);
    }
    assert!((block.friction() - LAW.reference).abs() < 1e-7);
    block
}

/// Slip rate stepped from `V0` to `V1` and back: friction changes at once by `a ln(V1/V0)`, then decays
/// over the slip `Dc` towards `mu0 + (a - b) ln(V1/V0)`, with `theta = Dc/V1 (1 + (V1/V0 - 1) exp(-D/Dc))`
/// after the slip `D`; all to 1e-6, by one pass and by sweeps.
#[test]
fn friction_follows_velocity_steps() {
    for connected in [false, true] {
        for ratio in [10.0, 0.1] {
            let mut block = steady();
            if connected {
                block = block.connected();
            }
            let (rate, log) = (LAW.rate * ratio, ratio.ln());
            let start = block.record().state.slip;
            block.drive(rate, PRESSING);
            let peak = LAW.reference + LAW.direct * log;
            assert!(
                (block.friction() - peak).abs() < 1e-6,
                "{}",
                block.friction()
            );
            let mut slip = block.record().state.slip - start;
            assert!((slip / (rate * STEP) - 1.0).abs() < 1e-4);
            while slip < 14.0 * LAW.slip {
                block.drive(rate, PRESSING);
                // The state at the start of the step.
                let decayed = 1.0 + (ratio - 1.0) * (-slip / LAW.slip).exp();
                let state = (decayed / ratio).ln();
                let expected = peak + LAW.evolution * state;
                let error = (block.friction() - expected).abs();
                assert!(error < 1e-6, "{ratio} {slip}: {error:e}");
                slip = block.record().state.slip - start;
            }
            let last = LAW.reference + (LAW.direct - LAW.evolution) * log;
            assert!(
                (block.friction() - last).abs() < 1e-6,
                "{}",
                block.friction()
            );
            let theta = block.joint.history_of(0)[0];
            assert!((theta * rate / LAW.slip - 1.0).abs() < 1e-4, "{theta}");
        }
    }
}

/// A contact that is held for a time `t` ages, `theta = Dc/V0 + t`, and is stronger by
/// `b ln(1 + V0 t / Dc)` when it slips again at the reference slip rate.
#[test]
fn contacts_grow_stronger_with_age() {
    let mut block = steady();
    let hold = 10_000;
    for _ in 0..hold {
        block.drive(0.0, PRESSING);
    }
    let age = LAW.slip / LAW.rate + f64::from(hold) * STEP;
    let theta = block.joint.history_of(0)[0];
    assert!((theta / age - 1.0).abs() < 1e-6, "{theta} {age}");
    block.drive(LAW.rate, PRESSING);
    let expected = LAW.reference + LAW.evolution * (age * LAW.rate / LAW.slip).ln();
    assert!(
        (block.friction() - expected).abs() < 1e-6,
        "{}",
        block.friction()
    );
}
