//! Kinematic constraints and joints, which correct a predicted motion.

use crate::{
    ConstraintParts, JointHistory, JointView, Mat3, Renewal, RunError, SavedState, StateError,
    StepTime, Vec3,
};

/// Motion of a constraint's nodes as the integrator predicts it without the constraint.
///
/// All slices are in the order of [`Constraint::nodes`]. A constraint changes `velocity` by
/// `step * inverse_mass * force`, and that of [coupled](CoupledConstraint::couple) nodes by what these forces do to them, nothing
/// else; the engine then moves the nodes.
#[non_exhaustive]
pub struct PredictedMotion<'a> {
    /// Number of the step, from 0.
    pub number: u64,
    /// Time at the start of the step (s).
    pub time: f64,
    /// Length of the step (s).
    pub step: f64,
    /// Displacement at the start of the step (m), that of construction stages included.
    pub displacement: &'a [Vec3],
    /// Velocity before the step (m/s), half a step before `time`.
    pub previous: &'a [Vec3],
    /// Predicted velocity (m/s), half a step after `time`; corrected in place.
    pub velocity: &'a mut [Vec3],
    /// Inverse of the effective mass `M + dt/2 C + dt^2/4 K` of each node (1/kg), zero along directions in
    /// which a support holds the node.
    pub inverse_mass: &'a [Mat3],
}

impl<'a> PredictedMotion<'a> {
    /// Predicted motion in a time step from displacements (m), velocities before the step and predicted
    /// ones (m/s) and inverse effective masses (1/kg): for engines, and for tests of a constraint without
    /// an engine.
    pub fn new(
        StepTime { number, time, step }: StepTime,
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

/// Work of the forces of a constraint in one step (J); positive where energy leaves the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ConstraintWork {
    /// Energy dissipated by friction in the step (J), less the work of dilation against the pressure.
    pub friction: f64,
    /// Energy dissipated by breaking bonds in the step (J).
    pub bond: f64,
    /// Energy stored by bonds that fail gradually in the step (J); negative where they return it.
    pub stored: f64,
    /// Kinetic energy lost by impact without rebound in the step (J).
    pub impact: f64,
    /// Work in the step (J) that the body does on the outside through the constraint, such as against a preload or a
    /// prescribed motion; negative where the outside puts energy in.
    pub external: f64,
}

impl ConstraintWork {
    /// Sets the energy dissipated by friction in the step (J).
    #[must_use]
    pub const fn with_friction(self, friction: f64) -> Self {
        Self { friction, ..self }
    }
    /// Sets the energy dissipated by the bonds that break in the step (J).
    #[must_use]
    pub const fn with_bond(self, bond: f64) -> Self {
        Self { bond, ..self }
    }
    /// Sets the energy stored by bonds in the step (J).
    #[must_use]
    pub const fn with_stored(self, stored: f64) -> Self {
        Self { stored, ..self }
    }
    /// Sets the kinetic energy lost by impact in the step (J).
    #[must_use]
    pub const fn with_impact(self, impact: f64) -> Self {
        Self { impact, ..self }
    }
    /// The same work with the part that the body does on the outside (J).
    #[must_use]
    pub const fn with_external(self, external: f64) -> Self {
        Self { external, ..self }
    }
}

impl core::ops::AddAssign for ConstraintWork {
    fn add_assign(&mut self, other: Self) {
        self.friction += other.friction;
        self.bond += other.bond;
        self.stored += other.stored;
        self.impact += other.impact;
        self.external += other.external;
    }
}

/// Work of a constraint in its last step, divided among some of its nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DividedWork<'a> {
    /// Indices in [`Constraint::nodes`], such as that of the first node of each pair; one may occur several times.
    pub nodes: &'a [u32],
    /// Work of the step that is accounted at each of them (J).
    pub work: &'a [ConstraintWork],
}

/// Coupling of two nodes of a constraint by inertia that they share, as in a [fibre](crate::Fibre): an impulse on either
/// moves the other, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeCoupling {
    /// Indices of the nodes in [`Constraint::nodes`].
    pub nodes: [u32; 2],
    /// Velocity of the first node per impulse on the second (1/kg); its transpose is that of the second per impulse on
    /// the first.
    pub response: Mat3,
}

/// Condition on the motion of some nodes, enforced by correcting predicted velocities.
///
/// A node belongs to at most one constraint of a model. [`correct`](Self::correct) is called once in every time step, and
/// by static solutions, of dynamic relaxation in every iteration. Where predicted velocities depend on those of other nodes after
/// the step, as in a bay of an endless row, it is called several times in a step, from the same state; a constraint that has a state without
/// joints is refused there. It may change velocities by
/// `step * inverse_mass * force` only. What a constraint of joints, of parts, of coupled nodes or with a history has in
/// addition is behind a method that returns none by default.
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
    /// Name of the constraint in reports.
    fn name(&self) -> &str;
    /// Mesh indices of the nodes that it reads and corrects, each at most once.
    fn nodes(&self) -> &[u32];
    /// Prepares for steps of a length (s) and inverse effective masses (1/kg, in the order of
    /// [`nodes`](Self::nodes)). Called before the first step and whenever they change, so that what
    /// depends on them alone is computed once.
    fn prepare(&mut self, _step: f64, _inverse_mass: &[Mat3]) {}
    /// Corrects the predicted velocities and returns the work of its forces in this step, from which the energy balance is
    /// computed.
    ///
    /// # Errors
    /// If the condition cannot be met within the constraint's own cap on iterations; it ends the run.
    fn correct(&mut self, motion: PredictedMotion) -> Result<ConstraintWork, RunError>;
    /// Pairs of nodes (mesh indices) that it holds together whatever the force, beside those of its
    /// joints that stick; static solutions take the nodes of such a pair for one. None by default.
    fn ties(&self) -> Vec<[u32; 2]> {
        Vec::new()
    }
    /// Its joints; none by default.
    fn jointed(&self) -> Option<&dyn JointConstraint> {
        None
    }
    /// The same joints, to be changed; none by default.
    fn jointed_mut(&mut self) -> Option<&mut dyn JointConstraint> {
        None
    }
    /// Its division into parts; none by default: its nodes are then one part, which is right for any constraint.
    fn divided(&self) -> Option<&dyn DividedConstraint> {
        None
    }
    /// Its restriction to some of its [parts](DividedConstraint::parts); none, the default, if it cannot be restricted. A
    /// constraint of one part need not be, since it is present as a whole or not at all.
    fn restricted(&mut self) -> Option<&mut dyn RestrictedConstraint> {
        None
    }
    /// Its solution with nodes coupled by inertia; none, the default, if it has none.
    fn coupled(&mut self) -> Option<&mut dyn CoupledConstraint> {
        None
    }
    /// Its state between two steps, with that of its joints, from which an equal constraint goes on in a resumed run. None
    /// by default: a constraint without joints and other history has none, and the engine keeps the joints of one that
    /// has no state of its own by their [views](JointConstraint::joints).
    fn saved(&self) -> Option<&dyn SavedState> {
        None
    }
    /// The same state, to be restored; none by default.
    fn saved_mut(&mut self) -> Option<&mut dyn SavedState> {
        None
    }
}

/// Joints of a constraint, with their tractions and histories: for output, static solutions, stages and restarts.
pub trait JointConstraint {
    /// Views of the joints that the constraint consists of.
    fn joints(&self) -> Vec<JointView<'_>>;
    /// Adds the forces (N, in the order of [`nodes`](Constraint::nodes)) of the joints on their nodes in the present state,
    /// which are equal and opposite on both sides: area times what their tractions exceed those that act without them.
    fn add_joint_forces(&self, out: &mut [Vec3]);
    /// Lets the closed pairs of the joints without a [reference](crate::JointRecord::reference) take their present tractions
    /// for it: what forces leave open stays as it is.
    fn keep_tractions(&mut self);
    /// Sets the pairs of a joint to the state of an earlier run, whatever the order of its pairs
    /// then; closed pairs without a reference traction take their own for it. Returns whether there is a joint of that name
    /// with these pairs.
    fn restore(&mut self, history: &JointHistory) -> bool;
    /// Starts a joint anew, by name, at a displacement (m, in the order of [`nodes`](Constraint::nodes)) from
    /// which its opening and slip count from then on; returns whether there is a joint of that name.
    fn renew(&mut self, joint: &str, renewal: Renewal, displacement: &[Vec3]) -> bool;
    /// Begins an increment of a dynamic relaxation from given states of the joints, to its [end](Self::end_relaxation): its
    /// steps are no motion in time, so that damage of bonds, slip and peaks count from these states to the present displacement and
    /// not along the way. By default they count as in time.
    fn begin_relaxation(&mut self, _start: &[JointHistory]) {}
    /// Sets the share (1) of the damage since the beginning that the following steps of the relaxation take back: all in steps from rest,
    /// and in motion what damping takes off the velocity, so that sides that bounce do not find their bond again. By default nothing
    /// changes.
    fn take_back(&mut self, _share: f64) {}
    /// Ends an increment of a dynamic relaxation. By default nothing changes.
    fn end_relaxation(&mut self) {}
    /// Keeps the state before a step that is [corrected](Constraint::correct) several times.
    fn keep_state(&mut self);
    /// Returns to the state that was kept.
    fn return_to_kept(&mut self);
}

/// Parts of a constraint, each of which several processes may correct by itself, with their work.
pub trait DividedConstraint {
    /// Nodes that must be corrected together, each of [`nodes`](Constraint::nodes) in one part.
    fn parts(&self) -> ConstraintParts;
    /// Work in the last [corrected](Constraint::correct) step divided among the nodes, that of a part among nodes of this part:
    /// where several processes have a part, one of them accounts its work. None by default: the work of a constraint that
    /// is not divided is accounted at its first node, and it cannot be restricted to parts in a run with an energy balance.
    fn divided_work(&self) -> Option<DividedWork<'_>> {
        None
    }
}

/// Restriction of a constraint to some of its parts, for a process that has no nodes of the others.
pub trait RestrictedConstraint {
    /// Restricts the constraint to some of its [parts](DividedConstraint::parts): `kept` says of each part whether it
    /// remains. The nodes of those parts keep their order.
    fn keep_parts(&mut self, kept: &[bool]);
    /// Restores, of a state that a constraint of some parts of an equal one [saved](SavedState::save_state), what
    /// belongs to its own parts; others keep theirs.
    ///
    /// # Errors
    /// A state of another constraint; by default, of constraints without a state, every one.
    fn restore_parts(&mut self, _saved: &[u8]) -> Result<(), StateError> {
        Err(StateError::Unexpected)
    }
}

/// Solution of a constraint some nodes of which are coupled by inertia that they share.
pub trait CoupledConstraint {
    /// Sets the couplings between its nodes, in place of those before: from the next [`prepare`](Constraint::prepare) on an
    /// impulse changes the velocities of coupled nodes, too, and coupled nodes are in one
    /// [part](DividedConstraint::parts).
    fn couple(&mut self, couplings: &[NodeCoupling]);
}
