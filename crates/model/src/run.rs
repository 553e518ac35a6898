//! Options and reports of dynamic runs.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::{CheckpointSink, HourglassShare, RunError, SavedRun, StableStep, StepProfile};

/// Duration of a run, as time or number of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// Duration (s); the last output state is the first one at or past this time after the start of the run.
    Seconds(f64),
    /// Number of time steps; the last output state is that at the start of the last one.
    Steps(u64),
}

/// Choice of the time step of a run; engines provide all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum StepChoice {
    /// The stable step of the model (with a safety factor of 0.98).
    #[default]
    Stable,
    /// A given step (s); refused if it is above the stability limit.
    Fixed(f64),
    /// A given step (s) without a check of stability, for studies of stability.
    Unchecked(f64),
}

/// Check of the energy balance during a run.
///
/// The balance costs time in every step: the blocks integrate their dissipation, and with
/// `by_set` the nodal work of each element set is recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct EnergyCheck {
    /// Number of steps between two readings, 1 or above; the last step is read too.
    pub every: u64,
    /// Largest permitted residual, relative to the largest stored energy or external work so far (1), above which the run
    /// fails; `None` for the default, 1e-7 in double precision, 1e-4 in mixed, 1e-2 in single. What rounding leaves of great
    /// works that cancel is no residual, unless the limit is below 64 rounding errors of a number.
    pub limit: Option<f64>,
    /// Whether each element set has its own balance, so that an error names the set that causes it; otherwise
    /// the error names the set whose energy changed most.
    pub by_set: bool,
}

impl EnergyCheck {
    /// A check every `steps` steps, with balances by set and the default limit.
    pub fn every(steps: u64) -> Self {
        Self {
            every: steps,
            limit: None,
            by_set: true,
        }
    }
    /// The same with a largest permitted residual over the largest energy stored or put in so far (1).
    #[must_use]
    pub fn with_limit(mut self, limit: f64) -> Self {
        self.limit = Some(limit);
        self
    }
    /// The same, with a balance of each element set if `by_set` is true.
    #[must_use]
    pub fn with_by_set(mut self, by_set: bool) -> Self {
        self.by_set = by_set;
        self
    }
}

/// Options of a run: duration, time step, divergence bound, energy check, cancellation.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RunOptions {
    /// Duration of the run.
    pub length: Length,
    /// Choice of the time step.
    pub step: StepChoice,
    /// Bound on each component of velocity (m/s), beyond which the motion counts as diverged. By
    /// default the speed at which strains reach the order of one, far beyond the theory
    /// of small strains: the greatest product of half an element's frequency and its diagonal.
    pub speed_limit: Option<f64>,
    /// Check of the energy balance, if any. The balance begins with the run; it is computed without a check
    /// where an observer reads energies.
    pub energy: Option<EnergyCheck>,
    /// Cancellation flag: once true, the run ends after one more step with complete output.
    pub stop: Option<Arc<AtomicBool>>,
    /// Whether the wall time of the parts of a step is measured ([`RunReport::profile`]); the motion is the same to the
    /// bit, and steps take some per cent longer. False by default.
    pub profile: bool,
    /// Receiver of the state of the run between two steps, when it asks for one, and when the cancellation flag is set:
    /// then before the step that ends the run.
    pub checkpoints: Option<Arc<dyn CheckpointSink>>,
    /// State from which the run goes on to the same bits as one that was not interrupted. The model is built as that of
    /// the run that saved the state was, and has moved no further; the duration counts from the start of that run. The
    /// step, whose choice must be the same, is that of the saved state to the bit and is not computed again.
    pub resume: Option<Arc<SavedRun>>,
}

impl RunOptions {
    /// Options of a run of a duration (s) with the stable step.
    pub fn seconds(duration: f64) -> Self {
        Self::of(Length::Seconds(duration))
    }
    /// Options of a run of `count` steps with the stable step.
    pub fn steps(count: u64) -> Self {
        Self::of(Length::Steps(count))
    }
    fn of(length: Length) -> Self {
        Self {
            length,
            step: StepChoice::Stable,
            speed_limit: None,
            energy: None,
            stop: None,
            profile: false,
            checkpoints: None,
            resume: None,
        }
    }
    /// Sets the [receiver of checkpoints](Self::checkpoints).
    #[must_use]
    pub fn with_checkpoints(mut self, sink: Arc<dyn CheckpointSink>) -> Self {
        self.checkpoints = Some(sink);
        self
    }
    /// Sets the [saved state](Self::resume) from which the run goes on.
    #[must_use]
    pub fn with_resume(mut self, saved: Arc<SavedRun>) -> Self {
        self.resume = Some(saved);
        self
    }
    /// The same options with or without a measurement of the wall time of the parts of a step.
    #[must_use]
    pub fn with_profile(mut self, profile: bool) -> Self {
        self.profile = profile;
        self
    }
    /// The same options with another choice of the time step: stable, or given (s).
    #[must_use]
    pub fn with_step(mut self, step: StepChoice) -> Self {
        self.step = step;
        self
    }
    /// The same options with a bound on each component of velocity (m/s), above which the run fails as diverged.
    #[must_use]
    pub fn with_speed_limit(mut self, limit: f64) -> Self {
        self.speed_limit = Some(limit);
        self
    }
    /// The same options with a check of the energy balance, whose failure ends the run.
    #[must_use]
    pub fn with_energy(mut self, check: EnergyCheck) -> Self {
        self.energy = Some(check);
        self
    }
    /// The same options with a cancellation flag ([`stop`](Self::stop)).
    #[must_use]
    pub fn with_stop(mut self, stop: Arc<AtomicBool>) -> Self {
        self.stop = Some(stop);
        self
    }
}

/// Progress of a run, passed to the progress callback after every step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Number of steps done in this run.
    pub done: u64,
    /// Number of steps planned for this run.
    pub planned: u64,
    /// Present time (s), that of the displacement.
    pub time: f64,
}

impl Progress {
    /// The progress of a run: steps done of those planned, at a time (s).
    pub fn new(done: u64, planned: u64, time: f64) -> Self {
        Self {
            done,
            planned,
            time,
        }
    }
}

/// Reason for the end of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All planned steps were done.
    Completed,
    /// The observer of this name returned [`Flow::Stop`](crate::Flow::Stop); the output is complete up to that step.
    Observer(String),
    /// The cancellation flag was set; the output is complete up to the step after it.
    Stopped,
    /// An error with this message ended the run; only in the report of a [`RunFailure`].
    Failed(String),
}

/// Report of a run: steps, stable step, energies.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RunReport {
    /// Number of steps done in this run.
    pub steps: u64,
    /// Length of a time step (s).
    pub step: f64,
    /// Time of the displacement at the end (s).
    pub time: f64,
    /// The stable step of the model; none for [`StepChoice::Unchecked`].
    pub stable: Option<StableStep>,
    /// Reason for the end of the run.
    pub ended: Ended,
    /// Last reading of the energy balance (J), by column; empty if there was none.
    pub energies: Vec<(&'static str, f64)>,
    /// Largest absolute residual of the energy balance at its readings, relative to the largest stored energy or external
    /// work until then (1); zero without readings.
    pub energy_residual: f64,
    /// Hourglass and internal work of each element set: the maxima over the readings of the energy balance; without
    /// readings the stored energies at the end.
    pub hourglass: Vec<HourglassShare>,
    /// Wall time of the parts of the steps, if it was measured; none of engines that cannot.
    pub profile: Option<StepProfile>,
    /// Device that took steps beside the host, and how many of them; none without one.
    pub device: Option<DeviceShare>,
    /// Largest kinetic energy of the added inertia of [fibres](crate::Fibre), and of their masses, over the readings of
    /// the energy balance (J); zero without them.
    pub fibre_energies: [f64; 2],
    /// Steps whose equations had to be solved by iterations, and were not; none of engines and models without them.
    pub unsolved: Option<UnsolvedSteps>,
}

/// Steps of a run whose equations were not solved in the permitted number of iterations, so that the best solution that was found was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct UnsolvedSteps {
    /// Number of such steps.
    pub steps: u64,
    /// Largest difference of the velocities that were taken from those that follow from them, over the motion (1).
    pub worst: f64,
    /// Time (s) of the step that has it.
    pub time: f64,
}

impl UnsolvedSteps {
    /// These steps and one more at a time (s), with its difference over the motion (1).
    pub fn with(earlier: Option<Self>, time: f64, difference: f64) -> Self {
        let one = Self {
            steps: 1,
            worst: difference,
            time,
        };
        let Some(earlier) = earlier else {
            return one;
        };
        let worse = if difference > earlier.worst {
            one
        } else {
            earlier
        };
        Self {
            steps: earlier.steps + 1,
            ..worse
        }
    }
}

/// Share of a device in the steps of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DeviceShare {
    /// Name of the device.
    pub name: String,
    /// Number of steps that it took; the host took the others.
    pub steps: u64,
}

impl DeviceShare {
    /// The share of a device: its name and its number of steps.
    pub fn new(name: impl Into<String>, steps: u64) -> Self {
        Self {
            name: name.into(),
            steps,
        }
    }
}

impl RunReport {
    /// The report of a completed run of `steps` steps of length `step` (s) to a time (s), without energies.
    pub fn new(steps: u64, step: f64, time: f64) -> Self {
        Self {
            steps,
            step,
            time,
            stable: None,
            ended: Ended::Completed,
            energies: Vec::new(),
            profile: None,
            device: None,
            energy_residual: 0.0,
            hourglass: Vec::new(),
            fibre_energies: [0.0; 2],
            unsolved: None,
        }
    }
}

/// A failed run: the error, and the report of the steps before it.
#[derive(Debug)]
pub struct RunFailure {
    /// The error that ended the run.
    pub error: RunError,
    /// Report of the steps until then; none if the run was refused before its first step.
    pub report: Option<Box<RunReport>>,
}
