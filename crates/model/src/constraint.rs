//! Kinematic constraints and joints, which correct a predicted motion.

use crate::{
    ConstraintParts, JointHistory, JointView, Mat3, Renewal, RunError, StateError, StepTime, Vec3,
};

/// Motion of a constraint's nodes as the integrator predicts it without the constraint.
///
/// All slices are in the order of [`Constraint::nodes`]. A constraint changes `velocity` by
/// `step * inverse_mass * force`, and that of [coupled](Constraint::couple) nodes by what these forces do to them, nothing
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
/// by static solutions, of dynamic relaxation in every iteration; it may change velocities by
/// `step * inverse_mass * force` only.
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
    /// Its parts: nodes that must be corrected together, each of [`nodes`](Self::nodes) in one part; by default all in one, which
    /// is right for any constraint.
    fn parts(&self) -> ConstraintParts {
        ConstraintParts::whole(self.nodes())
    }
    /// Restricts the constraint to some of its [parts](Self::parts), for a process that has no nodes of the others:
    /// `kept` says of each part whether it remains. The nodes of those parts keep their order. Returns whether the
    /// constraint is now that of these parts alone; by default it cannot be restricted. A constraint of one part need not
    /// be, since it is present as a whole or not at all.
    fn keep_parts(&mut self, _kept: &[bool]) -> bool {
        false
    }
    /// Prepares for steps of a length (s) and inverse effective masses (1/kg, in the order of
    /// [`nodes`](Self::nodes)). Called before the first step and whenever they change, so that what
    /// depends on them alone is computed once.
    fn prepare(&mut self, _step: f64, _inverse_mass: &[Mat3]) {}
    /// Sets the couplings between its nodes, in place of those before: from the next [`prepare`](Self::prepare) on an
    /// impulse changes the velocities of coupled nodes, too, and coupled nodes are in one [part](Self::parts). Returns
    /// whether it is solved so; by default only without couplings.
    fn couple(&mut self, couplings: &[NodeCoupling]) -> bool {
        couplings.is_empty()
    }
    /// Corrects the predicted velocities and returns the work of its forces in this step, from which the energy balance is
    /// computed.
    ///
    /// # Errors
    /// If the condition cannot be met within the constraint's own cap on iterations; it ends the run.
    fn correct(&mut self, motion: PredictedMotion) -> Result<ConstraintWork, RunError>;
    /// Work in the last [corrected](Self::correct) step divided among its nodes, that of a part among nodes of this part: where
    /// several processes have a part, one of them accounts its work. None by default: the work of a constraint that is not
    /// divided is accounted at its first node, and it cannot be restricted to parts in a run with an energy balance.
    fn divided_work(&self) -> Option<DividedWork<'_>> {
        None
    }
    /// Adds the forces (N, in the order of [`nodes`](Self::nodes)) of its joints on their nodes in the present state, which are
    /// equal and opposite on both sides: area times what their tractions exceed those that act without them. Adds none by
    /// default.
    fn add_joint_forces(&self, _out: &mut [Vec3]) {}
    /// Lets the closed pairs of its joints without a [reference](crate::JointRecord::reference) take their present tractions
    /// for it: what forces leave open stays as it is. By default nothing changes.
    fn keep_tractions(&mut self) {}
    /// Pairs of nodes (mesh indices) that it holds together whatever the force, beside those of its
    /// joints that stick; static solutions take the nodes of such a pair for one. None by default.
    fn ties(&self) -> Vec<[u32; 2]> {
        Vec::new()
    }
    /// Views of the joints that it consists of; none by default.
    fn joints(&self) -> Vec<JointView<'_>> {
        Vec::new()
    }
    /// Sets the pairs of a joint to the state of an earlier run, whatever the order of its pairs
    /// then; closed pairs without a reference traction take their own for it. Returns whether it has a joint of that name
    /// with these pairs. Has none by default.
    fn restore(&mut self, _history: &JointHistory) -> bool {
        false
    }
    /// Begins an increment of a dynamic relaxation from given states of its joints, to its [end](Self::end_relaxation): its
    /// steps are no motion in time, so that damage of bonds, slip and peaks count from these states to the present displacement and
    /// not along the way. By default they count as in time.
    fn begin_relaxation(&mut self, _start: &[JointHistory]) {}
    /// Sets the share (1) of the damage since the beginning that the following steps of the relaxation take back: all in steps from rest,
    /// and in motion what damping takes off the velocity, so that sides that bounce do not find their bond again. By default nothing
    /// changes.
    fn take_back(&mut self, _share: f64) {}
    /// Ends an increment of a dynamic relaxation. By default nothing changes.
    fn end_relaxation(&mut self) {}
    /// Starts a joint anew, by name, at a displacement (m, in the order of [`nodes`](Self::nodes)) from
    /// which its opening and slip count from then on; returns whether it has a joint of that name. Has
    /// none by default.
    fn renew(&mut self, _joint: &str, _renewal: Renewal, _displacement: &[Vec3]) -> bool {
        false
    }
    /// State of the constraint between two steps as bytes, with that of its joints, from which an equal constraint goes
    /// on in a resumed run. None by default: a constraint without joints and other history has none, and the engine keeps
    /// the joints of one that has no state of its own by their [views](Self::joints).
    ///
    /// # Errors
    /// A state that cannot be saved.
    fn save_state(&self) -> Result<Option<Vec<u8>>, StateError> {
        Ok(None)
    }
    /// Restores, of a state that a constraint of some [parts](Self::parts) of an equal one [saved](Self::save_state), what
    /// belongs to its own parts; others keep theirs.
    ///
    /// # Errors
    /// A state of another constraint; by default every one.
    fn restore_parts(&mut self, _saved: &[u8]) -> Result<(), StateError> {
        Err(StateError::Unexpected)
    }
    /// Restores a state that an equal constraint [saved](Self::save_state).
    ///
    /// # Errors
    /// A state of another constraint; by default every one.
    fn restore_state(&mut self, _saved: &[u8]) -> Result<(), StateError> {
        Err(StateError::Unexpected)
    }
}
