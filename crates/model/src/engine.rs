//! Interfaces of time integration and observation.

use crate::{JointView, ModelError, ParameterError, Reach, RunError, StateError, Stress, Vec3};

/// Time discretisation of mass-proportional damping.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MassDampingRule {
    /// Implicit: damping force of the mean of old and new velocity, solved with the nodal diagonal.
    Implicit,
    /// Lagged (explicit): damping force of the old velocity.
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

/// Options of the force evaluation of a time integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ForceTerms {
    /// Increment of every stiffness damping coefficient (s).
    pub damping_shift: f64,
    /// Whether stresses, energies or history variables are read before the drift; the engine sets it in its steps.
    pub shown: bool,
    /// Whether forces may be evaluated again in the same step before the drift.
    pub repeats: bool,
}

impl ForceTerms {
    /// The forces of the equation of motion, without changes.
    pub const PLAIN: Self = Self {
        damping_shift: 0.0,
        shown: false,
        repeats: true,
    };
    /// Options with an increment of every stiffness damping coefficient (s).
    pub fn shifted(damping_shift: f64) -> Self {
        Self {
            damping_shift,
            ..Self::PLAIN
        }
    }
    /// The same forces, which may be repeated in their step if `repeats` is true.
    ///
    /// A scheme that evaluates forces no more than once before it drifts says that they are not: elements may then overwrite their
    /// committed history variables, which halves the memory that they touch. Further evaluations in the same step, or after an
    /// error, start from the overwritten variables, as after a drift.
    #[must_use]
    pub fn with_repeats(self, repeats: bool) -> Self {
        Self { repeats, ..self }
    }
}

/// Highest frequency and damping coefficients of a model, input of the stability limit of a scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FrequencyLimits {
    /// Highest angular frequency of the undamped assembled model, or an upper bound of it (rad/s).
    pub highest: f64,
    /// Upper bound of the effective stiffness damping coefficient at the highest frequency (s): the
    /// largest of any block, or less where the damped blocks do not reach that frequency.
    pub most_stiffness_damping: f64,
    /// Least stiffness damping coefficient of any block (s).
    pub least_stiffness_damping: f64,
    /// Largest mass damping coefficient of any block (1/s).
    pub most_mass_damping: f64,
}

impl FrequencyLimits {
    /// Limits of an undamped model with a highest angular frequency (rad/s).
    pub fn undamped(highest: f64) -> Self {
        Self {
            highest,
            most_stiffness_damping: 0.0,
            least_stiffness_damping: 0.0,
            most_mass_damping: 0.0,
        }
    }
    /// Sets the least and the largest stiffness damping coefficient (s) and the largest mass damping coefficient
    /// (1/s).
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

/// Operations of which an explicit time integration scheme is composed; implemented by engines only.
///
/// A step from `t` to `t + dt` is [`forces`](Self::forces) at `t`, [`kick`](Self::kick),
/// [`constrain`](Self::constrain), [`drift`](Self::drift).
pub trait Dynamics {
    /// Present time (s), that of the displacement.
    fn time(&self) -> f64;
    /// Evaluates all nodal forces at the present displacement and velocity, in a step of length `step` (s).
    ///
    /// # Errors
    /// The first element whose forces cannot be computed.
    fn forces(&mut self, terms: ForceTerms, step: f64) -> Result<(), RunError>;
    /// Velocity update: solves for the new velocity of every node, with dashpots and springs implicit.
    ///
    /// # Errors
    /// If the motion is no longer finite.
    fn kick(&mut self, mass_damping: MassDampingRule, step: f64) -> Result<(), RunError>;
    /// Corrects the new velocities by the constraints (joints).
    ///
    /// # Errors
    /// The first constraint that cannot be satisfied.
    fn constrain(&mut self, step: f64) -> Result<(), RunError>;
    /// Displacement update: advances displacement and time by a step, and commits the history variables.
    fn drift(&mut self, step: f64);
}

/// An explicit time integration scheme.
///
/// ```
/// use powerhouse_model::*;
/// /// The central difference method without damping.
/// struct Plain;
/// impl TimeIntegrator for Plain {
///     fn name(&self) -> &'static str { "plain" }
///     fn stable_step(&self, limits: &FrequencyLimits) -> Result<f64, RunError> { Ok(2.0 / limits.highest) }
///     fn check(&self, _limits: &FrequencyLimits, _step: f64) -> Result<(), RunError> { Ok(()) }
///     fn step(&self, dynamics: &mut dyn Dynamics, step: f64) -> Result<(), RunError> {
///         dynamics.forces(ForceTerms::PLAIN.with_repeats(false), step)?;
///         dynamics.kick(MassDampingRule::Implicit, step)?;
///         dynamics.constrain(step)?;
///         dynamics.drift(step);
///         Ok(())
///     }
/// }
/// assert_eq!(Plain.stable_step(&FrequencyLimits::undamped(4.0)).unwrap(), 0.5);
/// ```
pub trait TimeIntegrator: Send + Sync {
    /// Name of the scheme in scenes and reports.
    fn name(&self) -> &'static str;
    /// Largest stable step (s), damping included.
    ///
    /// # Errors
    /// If the scheme is unstable at every step under this damping.
    fn stable_step(&self, limits: &FrequencyLimits) -> Result<f64, RunError>;
    /// Checks the stability of a step (s) before the run.
    ///
    /// # Errors
    /// If the step is above the stability limit, or the scheme is unstable under this damping.
    fn check(&self, limits: &FrequencyLimits, step: f64) -> Result<(), RunError>;
    /// Takes one time step of length `step` (s): forces, kick and constraints, and at last one
    /// [`drift`](Dynamics::drift), in which observers are called and time and step number advance.
    ///
    /// # Errors
    /// A failed operation, which ends the run.
    fn step(&self, dynamics: &mut dyn Dynamics, step: f64) -> Result<(), RunError>;
}

/// Fields that an observer reads beside displacement and velocity; an engine may omit the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Fields {
    /// Whether the observer reads nodal accelerations (m/s2), which the engine otherwise may not compute.
    pub acceleration: bool,
    /// Whether the observer reads stresses of elements (Pa), which the engine otherwise may not compute.
    pub stress: bool,
    /// Whether energies of the energy balance are read.
    pub energy: bool,
}

impl Fields {
    /// The same, with accelerations read if `read` is true.
    #[must_use]
    pub fn with_acceleration(mut self, read: bool) -> Self {
        self.acceleration = read;
        self
    }
    /// The same, with element stresses read if `read` is true.
    #[must_use]
    pub fn with_stress(mut self, read: bool) -> Self {
        self.stress = read;
        self
    }
    /// The same, with the energies of the energy balance read if `read` is true.
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
    /// Interval in steps, at least 1; the first step is included.
    Steps(u64),
    /// Interval in seconds, above zero: the first step at or past every multiple of it.
    Seconds(f64),
    /// Interval in seconds, above zero: the steps before and at or past every multiple of it, between which values at the
    /// multiple are interpolated; of a step that falls on the multiple that one alone.
    Around(f64),
    /// Every step that the host takes: those that a device takes are not withheld from it.
    HostSteps,
}

/// Share of a step by which times count as reached early.
const EARLY: f64 = 1e-6;

/// Number of whole intervals up to a time.
fn intervals(time: f64, interval: f64, step: f64) -> f64 {
    ((time + EARLY * step) / interval).floor()
}

/// Multiple of an interval, as the number nearest to its fifteen decimal digits: 3 times 0.1 is 0.3.
fn multiple(count: f64, interval: f64) -> f64 {
    let exact = count * interval;
    format!("{exact:.14e}").parse().unwrap_or(exact)
}

impl Cadence {
    /// Accepts an interval of at least one step, or of a positive time.
    ///
    /// # Errors
    /// [`ParameterError`] for `cadence`.
    pub fn check(self) -> Result<(), ParameterError> {
        match self {
            Self::Steps(steps) => ParameterError::check("cadence", steps as f64, 1.0, f64::MAX),
            Self::Seconds(time) | Self::Around(time) => {
                ParameterError::check("cadence", time, f64::MIN_POSITIVE, f64::MAX)
            }
            Self::HostSteps => Ok(()),
        }
    }
    /// Whether an observer is called at a step of a number, a time (s) and a length (s). Times count as
    /// reached a millionth of a step early.
    pub fn is_due(self, number: u64, time: f64, step: f64) -> bool {
        let passes = |interval, time| {
            intervals(time, interval, step) > intervals(time - step, interval, step)
        };
        match self {
            Self::Steps(every) => number.is_multiple_of(every.max(1)),
            Self::Seconds(interval) if interval > step => number == 0 || passes(interval, time),
            Self::Around(interval) if interval > step => {
                let next = time + step;
                let is_on = next - intervals(next, interval, step) * interval <= EARLY * step;
                number == 0 || passes(interval, time) || (passes(interval, next) && !is_on)
            }
            Self::Seconds(_) | Self::Around(_) | Self::HostSteps => true,
        }
    }
    /// The multiple of the interval in seconds (s) that a step reaches as the first one; none if it reaches none, and of
    /// cadences without an interval above the length of the step.
    ///
    /// ```
    /// use powerhouse_model::Cadence;
    /// let reached = |number: u64, step: f64| Cadence::Around(0.1).multiple(number, number as f64 * step, step);
    /// assert_eq!([reached(4, 0.07), reached(5, 0.07)], [None, Some(0.3)]);
    /// ```
    pub fn multiple(self, number: u64, time: f64, step: f64) -> Option<f64> {
        let (Self::Seconds(interval) | Self::Around(interval)) = self else {
            return None;
        };
        let reaches = interval > step && Self::Seconds(interval).is_due(number, time, step);
        reaches.then(|| multiple(intervals(time, interval, step), interval))
    }
    /// Number of whole intervals (s) up to a time (s) in a run with a step (s), by which [`is_due`](Self::is_due) finds the
    /// steps at or past the multiples of an interval in seconds.
    pub fn whole_intervals(interval: f64, time: f64, step: f64) -> f64 {
        intervals(time, interval, step)
    }
    /// Whether times (s) are the same to a millionth of a step (s).
    pub fn is_same_time(one: f64, other: f64, step: f64) -> bool {
        (one - other).abs() <= EARLY * step
    }
}

/// Decision of an observer to continue or stop the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// Continue the run.
    Continue,
    /// Stop the run after this step, with complete output.
    Stop,
}

/// State of the body at a time step for observers, in the mesh's numbering; implemented by engines only.
///
/// A view of a body at rest, to test an observer:
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
    /// Number of time steps taken before this one.
    fn number(&self) -> u64;
    /// Present time (s), that of the displacement.
    fn time(&self) -> f64;
    /// Length of the step (s).
    fn step(&self) -> f64;
    /// Number of nodes of the mesh.
    fn node_count(&self) -> usize;
    /// Displacement (m) of a node (mesh index) since the start of the stage.
    fn displacement(&self, node: u32) -> Vec3;
    /// Velocity (m/s) of a node: the mean of those half a step before and after.
    fn velocity(&self, node: u32) -> Vec3;
    /// Acceleration (m/s2) of a node.
    fn acceleration(&self, node: u32) -> Vec3;
    /// Mean stress (Pa) of an element (mesh index), initial stress included; zero for an absent element.
    fn stress(&self, element: u32) -> Stress;
    /// Stress (Pa) at a place with natural coordinates in an element (mesh index), initial stress included: the mean
    /// stress, and in bricks that have one its part that is linear in these coordinates. None, the default, if the engine
    /// does not know the linear part.
    fn stress_at(&self, _element: u32, _natural: &Vec3) -> Option<Stress> {
        None
    }
    /// Writes the internal forces (N) of an element at its nodes, in the mesh's order: those of its
    /// stress, initial stress included, and of hourglass resistance, without stiffness damping. They
    /// resist the motion; zero for an absent element. Returns whether the engine provides element forces; false by
    /// default.
    fn element_forces(&self, _element: u32, _out: &mut [Vec3]) -> bool {
        false
    }
    /// Columns of the energy balance (name, J) at its last reading; empty without an energy ledger.
    fn energies(&self) -> &[(&'static str, f64)];
    /// Value of a history variable of the law in an element, at the forces of this step
    /// ([`HistoryVariable::of_element`](crate::HistoryVariable::of_element)); none if the law has
    /// no such variable, and by default.
    fn history(&self, _element: u32, _variable: &str) -> Option<f64> {
        None
    }
    /// Values of a history variable of an embedded block, such as a set of bolts, by the block's label
    /// and the variable's name, at the step before; none if there is no such block or variable, and by
    /// default.
    fn embedded(&self, _block: &str, _variable: &str) -> Option<Vec<f64>> {
        None
    }
    /// State of the joints of the body; empty by default.
    fn joints(&self) -> Vec<JointView<'_>> {
        Vec::new()
    }
}

/// An observer: it receives the state of the body at its cadence, records or writes output, and may stop the run.
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
    /// Name of the observer in reports.
    fn name(&self) -> &str;
    /// Fields that the observer reads; the same in every step.
    fn fields(&self) -> Fields;
    /// Part of the body that the observer reads, the same in every step; all nodes and elements by default.
    fn reach(&self) -> Reach {
        Reach::default()
    }
    /// Sampling interval, the same throughout the run; the last step is always observed.
    fn cadence(&self) -> Cadence;
    /// Processes the state in a step; returns whether the run continues. Observers are called one after the other, with
    /// the run waiting; if one stops the run, the others receive this step too.
    ///
    /// # Errors
    /// Any error, which fails the run.
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError>;
    /// Completes the output; called once after the last step, also of a stopped or failed run.
    ///
    /// # Errors
    /// Any error, which fails the run.
    fn finish(&mut self) -> Result<(), ModelError> {
        Ok(())
    }
    /// State of the observer between two steps as bytes, such as the samples recorded so far, from which an equal
    /// observer goes on in a resumed run; empty by default, for observers without such a state.
    ///
    /// # Errors
    /// A state that cannot be saved.
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        Ok(Vec::new())
    }
    /// Restores a state that an equal observer [saved](Self::save_state), before the first step of a resumed run.
    ///
    /// # Errors
    /// A state of another observer; by default every state that is not empty.
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        StateError::expect_none(saved)
    }
}
