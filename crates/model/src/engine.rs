//! Time integration and observation.

use crate::{JointView, ModelError, ParameterError, RunError, Stress, Vec3};

/// How mass-proportional damping enters a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MassDampingRule {
    /// On the mean of the old and new velocity, solved for in the nodal diagonal.
    Implicit,
    /// On the old velocity.
    Lagged,
}

impl MassDampingRule {
    /// Coefficients (kg) of the new and of the old velocity in the momentum balance of a node with a mass (kg)
    /// and a mass damping coefficient times the step (kg).
    #[inline]
    pub fn effective_mass(self, mass: f64, damping: f64) -> (f64, f64) {
        match self {
            Self::Implicit => (mass + 0.5 * damping, mass - 0.5 * damping),
            Self::Lagged => (mass, mass - damping),
        }
    }
    /// The velocity to which the damping force is proportional: of the old one and the mean of the old and
    /// the new one.
    #[inline]
    pub fn damped_velocity<V>(self, old: V, mean: V) -> V {
        match self {
            Self::Implicit => mean,
            Self::Lagged => old,
        }
    }
}

/// Which forces an integrator wants.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ForceTerms {
    /// Added to every stiffness damping coefficient (s).
    pub damping_shift: f64,
    /// Whether the step asks for no other forces and moves by these before it ends.
    pub once: bool,
}

impl ForceTerms {
    /// The forces of the equation of motion as it stands.
    pub const PLAIN: Self = Self {
        damping_shift: 0.0,
        once: false,
    };
    /// With every stiffness damping coefficient shifted (s).
    pub fn shifted(damping_shift: f64) -> Self {
        Self {
            damping_shift,
            ..Self::PLAIN
        }
    }
    /// The same, for forces that a step asks for once and moves by before it ends: elements may write
    /// the new history variables over the old ones, which halves the memory that they touch. Forces that are
    /// asked for all the same, or after an error, go on from there, as after a drift.
    #[must_use]
    pub fn once(self) -> Self {
        Self { once: true, ..self }
    }
}

/// What an engine knows about its spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FrequencyLimits {
    /// Highest angular frequency of the undamped assembled model, or a bound on it (rad/s).
    pub highest: f64,
    /// Stiffness damping coefficient that bounds the model's at the highest frequency (s): the
    /// largest of any block, or less where the damped blocks do not reach that frequency.
    pub most_stiffness_damping: f64,
    /// Least stiffness damping coefficient of any block (s).
    pub least_stiffness_damping: f64,
    /// Largest mass damping coefficient (1/s).
    pub most_mass_damping: f64,
}

impl FrequencyLimits {
    /// Limits of an undamped model (rad/s).
    pub fn undamped(highest: f64) -> Self {
        Self {
            highest,
            most_stiffness_damping: 0.0,
            least_stiffness_damping: 0.0,
            most_mass_damping: 0.0,
        }
    }
    /// The same with damping: least and most stiffness damping (s), most mass damping (1/s).
    #[must_use]
    pub fn with_damping(
        mut self,
        least_stiffness: f64,
        most_stiffness: f64,
        most_mass: f64,
    ) -> Self {
        self.least_stiffness_damping = least_stiffness;
        self.most_stiffness_damping = most_stiffness;
        self.most_mass_damping = most_mass;
        self
    }
}

/// The operations that an explicit scheme is composed of; an engine offers them.
///
/// A step from `t` to `t + dt` is [`forces`](Self::forces) at `t`, [`kick`](Self::kick),
/// [`constrain`](Self::constrain), [`drift`](Self::drift).
pub trait Dynamics {
    /// Time of the displacement (s).
    fn time(&self) -> f64;
    /// Evaluates all forces at the present displacement and velocity.
    ///
    /// # Errors
    /// The element that failed.
    fn forces(&mut self, terms: ForceTerms, step: f64) -> Result<(), RunError>;
    /// Solves every node for its new velocity, dashpots and springs implicit.
    ///
    /// # Errors
    /// If the motion is no longer finite.
    fn kick(&mut self, mass_damping: MassDampingRule, step: f64) -> Result<(), RunError>;
    /// Lets constraints and supports correct the new velocity.
    ///
    /// # Errors
    /// The constraint that failed.
    fn constrain(&mut self, step: f64) -> Result<(), RunError>;
    /// Moves the nodes and the time, and commits the history.
    fn drift(&mut self, step: f64);
}

/// An explicit scheme.
///
/// ```
/// use powerhouse_model::*;
/// /// The central difference, nothing else.
/// struct Plain;
/// impl TimeIntegrator for Plain {
///     fn name(&self) -> &'static str { "plain" }
///     fn stable_step(&self, limits: &FrequencyLimits) -> Result<f64, RunError> { Ok(2.0 / limits.highest) }
///     fn check(&self, _limits: &FrequencyLimits, _step: f64) -> Result<(), RunError> { Ok(()) }
///     fn step(&self, dynamics: &mut dyn Dynamics, step: f64) -> Result<(), RunError> {
///         dynamics.forces(ForceTerms::PLAIN.once(), step)?;
///         dynamics.kick(MassDampingRule::Implicit, step)?;
///         dynamics.constrain(step)?;
///         dynamics.drift(step);
///         Ok(())
///     }
/// }
/// assert_eq!(Plain.stable_step(&FrequencyLimits::undamped(4.0)).unwrap(), 0.5);
/// ```
pub trait TimeIntegrator: Send + Sync {
    /// The scheme's name in scenes and reports.
    fn name(&self) -> &'static str;
    /// The largest stable step (s), damping included.
    ///
    /// # Errors
    /// If the scheme is unstable at every step under this damping.
    fn stable_step(&self, limits: &FrequencyLimits) -> Result<f64, RunError>;
    /// Accepts or refuses a step before the run.
    ///
    /// # Errors
    /// Why the step is refused.
    fn check(&self, limits: &FrequencyLimits, step: f64) -> Result<(), RunError>;
    /// Takes one step.
    ///
    /// # Errors
    /// What stopped the step.
    fn step(&self, dynamics: &mut dyn Dynamics, step: f64) -> Result<(), RunError>;
}

/// Fields that an observer reads beside displacement and velocity; an engine prepares no others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Fields {
    /// Accelerations.
    pub acceleration: bool,
    /// Element stresses.
    pub stress: bool,
    /// The energy ledger.
    pub energy: bool,
}

impl Fields {
    /// The same with or without accelerations.
    #[must_use]
    pub fn with_acceleration(mut self, read: bool) -> Self {
        self.acceleration = read;
        self
    }
    /// The same with or without element stresses.
    #[must_use]
    pub fn with_stress(mut self, read: bool) -> Self {
        self.stress = read;
        self
    }
    /// The same with or without the energy ledger.
    #[must_use]
    pub fn with_energy(mut self, read: bool) -> Self {
        self.energy = read;
        self
    }
}

/// Interval at which an observer is called.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Cadence {
    /// Every so many steps, the first included.
    Steps(u64),
    /// At the first step at or past every multiple of a time (s).
    Seconds(f64),
}

impl Cadence {
    /// Accepts an interval of at least one step, or of a positive time.
    ///
    /// # Errors
    /// [`ParameterError`] for `cadence`.
    pub fn check(self) -> Result<(), ParameterError> {
        match self {
            Self::Steps(steps) => ParameterError::check("cadence", steps as f64, 1.0, f64::MAX),
            Self::Seconds(time) => {
                ParameterError::check("cadence", time, f64::MIN_POSITIVE, f64::MAX)
            }
        }
    }
    /// Whether an observer is called at a step of a number, a time (s) and a length (s). Times count as
    /// reached a millionth of a step early.
    pub fn is_due(self, number: u64, time: f64, step: f64) -> bool {
        match self {
            Self::Steps(every) => number.is_multiple_of(every.max(1)),
            Self::Seconds(interval) if interval > step => {
                let multiple = |t: f64| ((t + 1e-6 * step) / interval).floor();
                number == 0 || multiple(time) > multiple(time - step)
            }
            Self::Seconds(_) => true,
        }
    }
}

/// Whether a run goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// Go on.
    Continue,
    /// Stop after this step; the output is complete.
    Stop,
}

/// A step as an observer sees it: everything in the mesh's numbering.
///
/// Engines implement it; a view of a body that never moves serves to try an observer:
/// ```
/// use powerhouse_model::{StepView, Stress, Vec3};
/// struct Still(usize);
/// impl StepView for Still {
///     fn number(&self) -> u64 { 0 }
///     fn time(&self) -> f64 { 0.0 }
///     fn step(&self) -> f64 { 1e-4 }
///     fn node_count(&self) -> usize { self.0 }
///     fn displacement(&self, _node: u32) -> Vec3 { Vec3::zeros() }
///     fn velocity(&self, _node: u32) -> Vec3 { Vec3::zeros() }
///     fn acceleration(&self, _node: u32) -> Vec3 { Vec3::zeros() }
///     fn stress(&self, _element: u32) -> Stress { Stress::default() }
///     fn energies(&self) -> &[(&'static str, f64)] { &[] }
/// }
/// ```
pub trait StepView {
    /// Steps taken.
    fn number(&self) -> u64;
    /// Time of the displacement (s).
    fn time(&self) -> f64;
    /// Length of the step (s).
    fn step(&self) -> f64;
    /// Number of nodes of the mesh.
    fn node_count(&self) -> usize;
    /// Displacement (m) at `time` since the start of the stage.
    fn displacement(&self, node: u32) -> Vec3;
    /// Velocity (m/s) at `time`: the mean of the half steps before and after.
    fn velocity(&self, node: u32) -> Vec3;
    /// Acceleration (m/s2) at `time`.
    fn acceleration(&self, node: u32) -> Vec3;
    /// Mean stress (Pa) of an element, the initial stress included if there is one; zero if it belongs
    /// to no block.
    fn stress(&self, element: u32) -> Stress;
    /// Writes the internal forces (N) of an element at its nodes, in the mesh's order: those of its
    /// stress, the initial stress included, and of hourglass resistance, without stiffness damping. They
    /// resist the motion; zero if it belongs to no block. Yields whether they are known; they are not by
    /// default.
    fn element_forces(&self, _element: u32, _out: &mut [Vec3]) -> bool {
        false
    }
    /// Named energies (J), if the ledger is kept.
    fn energies(&self) -> &[(&'static str, f64)];
    /// What an element shows of a history variable of its law, as of the step's forces
    /// ([`HistoryVariable::of_element`](crate::HistoryVariable::of_element)); none if its law has
    /// no such variable, or by default.
    fn history(&self, _element: u32, _variable: &str) -> Option<f64> {
        None
    }
    /// History variables of a block without elements of its own, such as a set of bolts, by the block's label
    /// and the variable's name, as of the step before; none if there is no such block or variable, or by
    /// default.
    fn embedded(&self, _block: &str, _variable: &str) -> Option<Vec<f64>> {
        None
    }
    /// The joints of the body; none by default.
    fn joints(&self) -> Vec<JointView<'_>> {
        Vec::new()
    }
}

/// Sees steps, writes or collects what it wants, may stop or fail the run.
///
/// ```
/// use powerhouse_model::*;
/// struct Peak { node: u32, peak: f64 }
/// impl Observer for Peak {
///     fn name(&self) -> &str { "peak" }
///     fn fields(&self) -> Fields { Fields::default() }
///     fn cadence(&self) -> Cadence { Cadence::Steps(1) }
///     fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
///         self.peak = self.peak.max(view.displacement(self.node).norm());
///         Ok(Flow::Continue)
///     }
/// }
/// ```
pub trait Observer: Send {
    /// The observer's name in reports.
    fn name(&self) -> &str;
    /// What it reads.
    fn fields(&self) -> Fields;
    /// When it wants to be called; the last step is always shown.
    fn cadence(&self) -> Cadence;
    /// Sees a step.
    ///
    /// # Errors
    /// Fails the run.
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError>;
    /// Called once after the last step, also when the run was stopped or failed.
    ///
    /// # Errors
    /// Fails the run.
    fn finish(&mut self) -> Result<(), ModelError> {
        Ok(())
    }
}
