//! A dilatant joint as a contact law of one's own, in a direct shear test under constant normal load.
//!
//! Asperities of the angle `psi` ride up on each other until the slip reaches a limit; until then the
//! friction angle is `phi + psi` (Patton 1966), after it `phi`. The opening `tan(psi) min(slip, limit)`
//! is a history variable, and the opening at which the joint is closed.

use powerhouse_model::{
    ContactLaw, ContactState, HistoryVariable, JointInput, JointResponse, JointState, Vec3,
};

use super::block::Block;

/// Coulomb friction with dilation up to a limiting slip.
#[derive(Clone, Copy, Debug)]
struct Dilatant {
    /// Basic friction angle `phi` and dilation angle `psi` (rad).
    friction: f64,
    dilation: f64,
    /// Slip at which dilation ends (m).
    limit: f64,
}

const OPENING: [HistoryVariable; 1] = [HistoryVariable::amount("dilation_opening", "m")];

impl Dilatant {
    fn dilates(&self, state: &JointState) -> bool {
        state.slip < self.limit
    }
    /// Friction coefficient after a slip.
    fn coefficient(&self, state: &JointState) -> f64 {
        let asperities = if self.dilates(state) {
            self.dilation
        } else {
            0.0
        };
        (self.friction + asperities).tan()
    }
}

impl ContactLaw for Dilatant {
    fn name(&self) -> &str {
        "dilatant"
    }
    fn initial(&self) -> JointState {
        JointState::default()
    }
    fn history(&self) -> &[HistoryVariable] {
        &OPENING
    }
    fn admissible(&self, input: &JointInput, new_history: &mut [f64]) -> JointResponse {
        let (trial, state) = (input.trial, &input.state);
        let opening = input.history[0];
        if trial.x > 0.0 {
            let open = state.with_contact(ContactState::Open);
            return JointResponse::new(Vec3::zeros(), open).with_dilation(opening);
        }
        let (shear, friction) = (input.trial_shear(), self.coefficient(state));
        let excess = shear + friction * trial.x;
        if excess <= 0.0 {
            let stuck = state.with_contact(ContactState::Stick);
            return JointResponse::new(trial, stuck).with_dilation(opening);
        }
        // Opening by `tan(psi)` times the slip of this step raises the pressure, and with it friction.
        let slope = if self.dilates(state) {
            self.dilation.tan()
        } else {
            0.0
        };
        let slip = excess * input.compliance * input.step / (1.0 + friction * slope);
        // From the accumulated slip, so that an error of one step is not carried on.
        let new = self.dilation.tan() * (state.slip + slip).min(self.limit);
        let normal = input.normal_opened_by(new - opening);
        let share = (friction * -normal / shear).min(1.0);
        new_history[0] = new;
        let traction = Vec3::new(normal, trial.y * share, trial.z * share);
        let slid = state.with_contact(ContactState::Slide);
        JointResponse::new(traction, slid).with_dilation(new)
    }
    fn sliding_strength(&self, normal: f64, input: &JointInput) -> f64 {
        self.coefficient(&input.state) * (-normal).max(0.0)
    }
}

const LAW: Dilatant = Dilatant {
    friction: 0.5,
    dilation: 0.25,
    limit: 0.01,
};

const MASS: f64 = 1.0;
/// Pressing force (N), step (s), and acceleration of the slip while the joint dilates (m/s2).
const PRESSING: f64 = 1e3;
const STEP: f64 = 1e-3;
const ACCELERATION: f64 = 0.5;

/// Force along the joint (N) that accelerates the block so: friction acts on the pressing force and on the
/// inertia of the block that is lifted.
fn push() -> f64 {
    let friction = (LAW.friction + LAW.dilation).tan();
    friction * PRESSING + MASS * ACCELERATION * (1.0 + friction * LAW.dilation.tan())
}

/// A block in direct shear under constant normal load slips with a constant acceleration and opens by
/// `tan(psi)` times its slip, to rounding, until the limiting slip; from then on the opening stays. The
/// energy balance closes, without impact.
#[test]
fn opening_is_slip_times_the_tangent_of_the_dilation_angle() {
    let slope = LAW.dilation.tan();
    let mut block = Block::new(LAW, MASS, STEP);
    let mut dilating = 0;
    while block.record().state.slip < 2.0 * LAW.limit {
        block.push(Vec3::new(push(), 0.0, -PRESSING));
        let record = *block.record();
        let (slip, opening) = (block.displacement.x, block.displacement.z);
        assert!((record.state.slip - slip).abs() < 1e-14);
        assert!(record.state.contact == ContactState::Slide, "{record:?}");
        let expected = slope * slip.min(LAW.limit);
        assert!((opening - expected).abs() < 1e-14, "{opening} {expected}");
        assert!((record.dilation - expected).abs() < 1e-14);
        assert_eq!(block.joint.history_of(0), [record.dilation]);
        if slip < LAW.limit {
            dilating += 1;
            let steps = f64::from(dilating);
            let exact = ACCELERATION * STEP * STEP * steps * (steps + 1.0) / 2.0;
            assert!((slip - exact).abs() < 1e-12, "{slip} {exact}");
            let pressure = PRESSING + MASS * ACCELERATION * slope;
            assert!(
                (record.traction.x / -pressure - 1.0).abs() < 1e-9,
                "{record:?}"
            );
        }
        assert!(
            block.residual().abs() < 1e-10,
            "{slip}: {:e}",
            block.residual()
        );
        assert_eq!(block.work.impact, 0.0);
    }
    assert!(dilating > 100);
}

/// Solved by sweeps, as pairs that share nodes are, the block opens one step later.
#[test]
fn connected_pairs_open_one_step_later() {
    let slope = LAW.dilation.tan();
    let mut block = Block::new(LAW, MASS, STEP).connected();
    while block.record().state.slip < 0.9 * LAW.limit {
        let before = block.record().dilation;
        let slip = block.record().state.slip;
        block.push(Vec3::new(push(), 0.0, -PRESSING));
        let (record, opening) = (block.record(), block.displacement.z);
        assert!((opening - before).abs() < 1e-12, "{opening} {before}");
        // The law does not know the slip of the sweeps before they end: it lags by less than a step.
        let lag = slope * record.state.slip - record.dilation;
        let step = slope * (record.state.slip - slip);
        assert!((0.0..step).contains(&lag), "{lag} {step}");
        assert!(block.residual().abs() < 1e-9, "{:e}", block.residual());
    }
}

/// A block that is taken off while the joint is dilated lands on its asperities again.
#[test]
fn a_dilated_joint_closes_on_its_asperities() {
    let mut block = Block::new(LAW, MASS, STEP);
    while block.record().state.slip < 0.5 * LAW.limit {
        block.push(Vec3::new(push(), 0.0, -PRESSING));
    }
    let opening = block.record().dilation;
    // Stopped, lifted, and pressed again.
    for _ in 0..200 {
        block.push(Vec3::new(-2.0 * block.velocity.x / STEP, 0.0, -PRESSING));
    }
    let dilated = block.record().dilation;
    assert!(dilated >= opening);
    while block.record().state.contact != ContactState::Open {
        block.push(Vec3::new(0.0, 0.0, 10.0));
    }
    for _ in 0..50 {
        block.push(Vec3::new(0.0, 0.0, 10.0));
    }
    assert!(block.displacement.z > 1.001 * dilated);
    for _ in 0..500 {
        block.push(Vec3::new(0.0, 0.0, -100.0));
    }
    assert_eq!(block.record().state.contact, ContactState::Stick);
    assert!((block.displacement.z - dilated).abs() < 1e-14, "{dilated}");
    assert!(block.work.impact > 0.0);
}
