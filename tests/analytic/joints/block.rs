//! A block on a fixed base, without an engine: what a contact law of one's own is tested with.

use powerhouse_contact::Joint;
use powerhouse_model::{
    Constraint, ConstraintWork, ContactLaw, JointPair, JointRecord, Mat3, PredictedMotion,
    StepTime, Vec3,
};

/// Block on a base of unit area, in leapfrog steps.
pub(crate) struct Block<L> {
    pub(crate) mass: f64,
    pub(crate) step: f64,
    pub(crate) joint: Joint<L>,
    /// Relative inverse masses along x, y and z. If they differ the pair is solved by sweeps, as pairs
    /// that share nodes are.
    pub(crate) mobility: Vec3,
    pub(crate) displacement: Vec3,
    pub(crate) velocity: Vec3,
    /// Work that the joint has reported, and work of the forces (J).
    pub(crate) work: ConstraintWork,
    pub(crate) input: f64,
    number: u64,
}

impl<L: ContactLaw> Block<L> {
    pub(crate) fn new(law: L, mass: f64, step: f64) -> Self {
        let pair = JointPair::new([0, 1], Vec3::z(), 1.0);
        Self {
            mass,
            step,
            joint: Joint::new("base", vec![pair], law).unwrap(),
            mobility: Vec3::repeat(1.0),
            displacement: Vec3::zeros(),
            velocity: Vec3::zeros(),
            work: ConstraintWork::default(),
            input: 0.0,
            number: 0,
        }
    }
    /// The same block, solved as connected pairs are.
    pub(crate) fn connected(mut self) -> Self {
        self.mobility.y = 0.5;
        self
    }
    /// One step under a force (N).
    pub(crate) fn push(&mut self, force: Vec3) {
        let predicted =
            self.velocity + force.component_mul(&self.mobility) * (self.step / self.mass);
        let before = self.velocity;
        self.correct(predicted);
        self.input += force.dot(&(before + self.velocity)) * (0.5 * self.step);
    }
    /// One step with a velocity along x that is imposed before the joint acts (m/s), pressed by a force (N).
    pub(crate) fn drive(&mut self, along: f64, pressing: f64) {
        let down = self.velocity.z - pressing * self.step / self.mass;
        self.correct(Vec3::new(along, 0.0, down));
    }
    fn correct(&mut self, predicted: Vec3) {
        let inverse = Mat3::from_diagonal(&(self.mobility / self.mass));
        let (here, previous) = (
            [Vec3::zeros(), self.displacement],
            [Vec3::zeros(), self.velocity],
        );
        let mut velocity = [Vec3::zeros(), predicted];
        let when = StepTime {
            number: self.number,
            time: self.number as f64 * self.step,
            step: self.step,
        };
        let masses = [Mat3::zeros(), inverse];
        self.joint.prepare(self.step, &masses);
        let motion = PredictedMotion::new(when, &here, &previous, &mut velocity, &masses);
        self.work += self.joint.correct(motion).unwrap();
        assert_eq!(
            self.joint.isolated_count(),
            usize::from(self.mobility.y == 1.0)
        );
        self.velocity = velocity[1];
        self.displacement += self.velocity * self.step;
        self.number += 1;
    }
    pub(crate) fn record(&self) -> &JointRecord {
        &self.joint.records()[0]
    }
    /// Shear traction over pressure.
    pub(crate) fn friction(&self) -> f64 {
        let traction = self.record().traction;
        traction.y.hypot(traction.z) / -traction.x
    }
    /// Energy that is not accounted for (J), of a block that moves along x and z.
    pub(crate) fn residual(&self) -> f64 {
        let kinetic = 0.5 * self.mass * self.velocity.norm_squared();
        let work = &self.work;
        kinetic + work.friction + work.bond + work.impact + work.external - self.input
    }
}
