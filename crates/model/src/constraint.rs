//! Conditions that correct a predicted motion.

use crate::{JointHistory, JointView, Mat3, Renewal, RunError, Vec3};

/// The motion that the integrator predicts without the constraint, at the constraint's own nodes.
///
/// All slices are in the order of [`Constraint::nodes`]. A constraint changes `velocity` by
/// `step * inverse_mass * force`, nothing else; the engine then moves the nodes.
#[non_exhaustive]
pub struct PredictedMotion<'a> {
    /// Step number.
    pub number: u64,
    /// Time at the step's start (s).
    pub time: f64,
    /// Length of the step (s).
    pub step: f64,
    /// Displacement at the step's start (m).
    pub displacement: &'a [Vec3],
    /// Velocity before the step (m/s), half a step before `time`.
    pub previous: &'a [Vec3],
    /// Predicted velocity (m/s), half a step after `time`; corrected in place.
    pub velocity: &'a mut [Vec3],
    /// Inverse of the effective mass `M + dt/2 C + dt^2/4 K` of each node (1/kg), zero for a node
    /// that a support holds in a direction.
    pub inverse_mass: &'a [Mat3],
}

impl<'a> PredictedMotion<'a> {
    /// A motion, for engines and for tests of a constraint without an engine.
    pub fn new(
        (number, time, step): (u64, f64, f64),
        displacement: &'a [Vec3],
        previous: &'a [Vec3],
        velocity: &'a mut [Vec3],
        inverse_mass: &'a [Mat3],
    ) -> Self {
        Self {
            number,
            time,
            step,
            displacement,
            previous,
            velocity,
            inverse_mass,
        }
    }
}

/// What the forces of a constraint did in one step, all in J; positive where energy left the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConstraintWork {
    /// Dissipated by friction.
    pub friction: f64,
    /// Dissipated by breaking bonds.
    pub bond: f64,
    /// Lost where masses meet without rebound.
    pub impact: f64,
    /// Work of the constraint's forces on the body, negative of what is put in from outside.
    pub external: f64,
}

/// A condition on the motion of some nodes.
///
/// ```
/// use powerhouse_model::{Constraint, ConstraintWork, PredictedMotion, RunError, Vec3};
/// /// Holds nodes in place.
/// struct Held(Vec<u32>);
/// impl Constraint for Held {
///     fn name(&self) -> &str { "held" }
///     fn nodes(&self) -> &[u32] { &self.0 }
///     fn correct(&mut self, motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
///         motion.velocity.fill(Vec3::zeros());
///         Ok(ConstraintWork::default())
///     }
/// }
/// ```
pub trait Constraint: Send {
    /// The constraint's name in reports.
    fn name(&self) -> &str;
    /// Mesh indices of the nodes it reads and corrects, each at most once.
    fn nodes(&self) -> &[u32];
    /// Told before the first step, and whenever the step (s) and with it the inverse effective
    /// masses (1/kg, in the order of [`nodes`](Self::nodes)) change, so that what depends on them
    /// alone is computed once.
    fn prepare(&mut self, _step: f64, _inverse_mass: &[Mat3]) {}
    /// Corrects the predicted velocities.
    ///
    /// # Errors
    /// If the condition cannot be met within the constraint's own cap.
    fn correct(&mut self, motion: PredictedMotion) -> Result<ConstraintWork, RunError>;
    /// Pairs of nodes (mesh indices) that it holds together whatever the force, beside those of its
    /// joints that stick; static solutions take them for one. None by default.
    fn ties(&self) -> Vec<[u32; 2]> {
        Vec::new()
    }
    /// The joints that it consists of; none by default.
    fn joints(&self) -> Vec<JointView<'_>> {
        Vec::new()
    }
    /// Puts the pairs of a joint into the state of an earlier run, whatever the order of its pairs
    /// then; says whether it has a joint of that name with these pairs.
    fn restore(&mut self, _history: &JointHistory) -> bool {
        false
    }
    /// Starts a joint anew, by name, at a displacement (m, in the order of [`nodes`](Self::nodes)) from
    /// which its opening and slip count from then on; says whether it has a joint of that name. Has
    /// none by default.
    fn renew(&mut self, _joint: &str, _renewal: Renewal, _displacement: &[Vec3]) -> bool {
        false
    }
}
