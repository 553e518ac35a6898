//! Dynamic runs: time loop, observers, energy check, termination.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use powerhouse_model::{
    Cadence, Dynamics, Flow, ForceTerms, HistoryUpdate, MassDampingRule, Observer, ParameterError,
    Precision, RunError, StepView, TimeIntegrator,
};

use crate::view::View;
use crate::{HourglassShare, Model, StableStep};

/// Duration of a run, as time or number of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// Duration (s); the last output state is the first one at or past this time after the start of the run.
    Seconds(f64),
    /// Number of time steps; the last output state is that at the start of the last one.
    Steps(u64),
}

/// Choice of the time step of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
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
    /// fails; `None` for the default, 1e-7 in double precision, 1e-4 in mixed, 1e-2 in single.
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
    /// Duration of the run, in seconds or in time steps.
    pub length: Length,
    /// Choice of the time step: the stable one, or a given one with or without a check of stability.
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
        }
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

/// Reason for the end of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All planned steps were done.
    Completed,
    /// The observer of this name returned [`Flow::Stop`]; the output is complete up to that step.
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
}

/// A failed run: the error, and the report of the steps before it.
#[derive(Debug)]
pub struct RunFailure {
    /// Error that ended the run, with its step, time, and element or set where it has one.
    pub error: RunError,
    /// Report of the steps until then; none if the run was refused before its first step.
    pub report: Option<Box<RunReport>>,
}

/// Integrates a model in time as [`run`] does; a failure comes with the report of the steps before it.
///
/// # Errors
/// As [`run`].
pub fn run_reporting(
    model: &mut Model,
    integrator: &dyn TimeIntegrator,
    options: &RunOptions,
    observers: &mut [Box<dyn Observer>],
    progress: &mut (dyn FnMut(Progress) + Send),
) -> Result<RunReport, RunFailure> {
    let outcome = model.in_pool(|model| run_steps(model, integrator, options, observers, progress));
    let mut finished = Ok(());
    for observer in observers {
        let result = observer.finish();
        if finished.is_ok() {
            finished = result.map_err(|source| failed(observer.name(), model.number, source));
        }
    }
    let refused = |error| RunFailure {
        error,
        report: None,
    };
    let (mut report, completed) = outcome.map_err(refused)?;
    match completed.and(finished) {
        Ok(()) => Ok(report),
        Err(error) => {
            report.ended = Ended::Failed(error.to_string());
            Err(RunFailure {
                error,
                report: Some(Box::new(report)),
            })
        }
    }
}

/// Integrates a model in time and calls observers.
///
/// In a step from `t` to `t + dt` observers receive the state at `t`, when the velocities before and after are
/// both known. The run therefore ends one step after the last output state, and a continued run
/// repeats no state. Observers receive the last step whatever their cadence, and
/// [`Observer::finish`] is called in every case.
///
/// `progress` is called after every step.
///
/// # Errors
/// An option out of range or an unstable step, before the first step; a divergence, a failed element, constraint or
/// observer, or an energy residual above its limit, during the run.
pub fn run(
    model: &mut Model,
    integrator: &dyn TimeIntegrator,
    options: &RunOptions,
    observers: &mut [Box<dyn Observer>],
    progress: &mut (dyn FnMut(Progress) + Send),
) -> Result<RunReport, RunError> {
    run_reporting(model, integrator, options, observers, progress).map_err(|failure| failure.error)
}

fn failed(name: &str, step: u64, source: powerhouse_model::ModelError) -> RunError {
    RunError::Observer {
        name: name.into(),
        step,
        source: Box::new(source),
    }
}

/// The report of the steps done with the error that ended them early, if any; an error if the run is refused before
/// its first step.
fn run_steps(
    model: &mut Model,
    integrator: &dyn TimeIntegrator,
    options: &RunOptions,
    observers: &mut [Box<dyn Observer>],
    progress: &mut (dyn FnMut(Progress) + Send),
) -> Result<(RunReport, Result<(), RunError>), RunError> {
    if let Length::Seconds(duration) = options.length {
        ParameterError::check("duration", duration, 0.0, f64::MAX)?;
    }
    if let Some(limit) = options.speed_limit {
        ParameterError::check("speed limit", limit, f64::MIN_POSITIVE, f64::MAX)?;
    }
    let (step, stable) = choose_step(model, integrator, options.step)?;
    let planned = match options.length {
        Length::Steps(count) => count,
        // The last output state is the first at or past the end.
        Length::Seconds(duration) => (duration / step - 1e-6).ceil().max(0.0) as u64 + 1,
    };
    model.speed_limit = match options.speed_limit {
        Some(limit) => limit,
        None => match model.spectrum().reference_speed {
            speed if speed > 0.0 => speed,
            _ => f64::MAX,
        },
    };
    let wanted = observers.iter().any(|observer| observer.fields().energy);
    if options.energy.is_some() || wanted {
        model.open_ledger(options.energy.is_some_and(|check| check.by_set));
    }
    let mut time_loop = TimeLoop {
        observers,
        energy: options.energy,
        energies: Vec::new(),
        residual: 0.0,
        hourglass: Vec::new(),
        last: false,
        stopped_by: None,
        failure: None,
        done: 0,
        model,
    };
    let result = time_loop.run(integrator, options, step, planned, progress);
    let TimeLoop {
        model,
        energies,
        residual,
        mut hourglass,
        done,
        ..
    } = time_loop;
    if model.ledger.is_none() {
        hourglass = model.hourglass_shares();
    }
    model.close_ledger();
    let mut report = RunReport {
        steps: done,
        step,
        time: model.time(),
        stable,
        ended: Ended::Completed,
        energies,
        energy_residual: residual,
        hourglass,
    };
    let completed = result.map(|ended| report.ended = ended);
    Ok((report, completed))
}

fn choose_step(
    model: &mut Model,
    integrator: &dyn TimeIntegrator,
    choice: StepChoice,
) -> Result<(f64, Option<StableStep>), RunError> {
    match choice {
        StepChoice::Stable => {
            let stable = model.stable_step(integrator)?;
            Ok((stable.step, Some(stable)))
        }
        StepChoice::Fixed(step) => {
            let limits = model.frequency_limits();
            integrator.check(&limits, step)?;
            Ok((step, Some(model.stable_step(integrator)?)))
        }
        StepChoice::Unchecked(step) => {
            ParameterError::check("step", step, f64::MIN_POSITIVE, f64::MAX)?;
            Ok((step, None))
        }
    }
}

/// Driver of the time loop: calls observers in every step between the update of velocities and that of
/// displacements.
struct TimeLoop<'a> {
    model: &'a mut Model,
    observers: &'a mut [Box<dyn Observer>],
    energy: Option<EnergyCheck>,
    /// Last reading of the energy ledger, and largest residual so far.
    energies: Vec<(&'static str, f64)>,
    residual: f64,
    hourglass: Vec<HourglassShare>,
    last: bool,
    stopped_by: Option<String>,
    failure: Option<RunError>,
    done: u64,
}

impl TimeLoop<'_> {
    /// Takes all steps of a run; returns the reason for their end.
    fn run(
        &mut self,
        integrator: &dyn TimeIntegrator,
        options: &RunOptions,
        step: f64,
        planned: u64,
        progress: &mut (dyn FnMut(Progress) + Send),
    ) -> Result<Ended, RunError> {
        let raised = || {
            options
                .stop
                .as_ref()
                .is_some_and(|stop| stop.load(Ordering::Relaxed))
        };
        while self.done < planned {
            let stopped = raised();
            self.last = stopped || self.done + 1 == planned;
            integrator.step(self, step)?;
            if let Some(failure) = self.failure.take() {
                return Err(failure);
            }
            if let Some(fault) = self.model.fault.take() {
                return Err(fault);
            }
            self.done += 1;
            progress(Progress {
                done: self.done,
                planned,
                time: self.model.time,
            });
            if let Some(name) = self.stopped_by.take() {
                return Ok(Ended::Observer(name));
            }
            if stopped {
                return Ok(Ended::Stopped);
            }
        }
        Ok(Ended::Completed)
    }

    fn is_due(&self, cadence: Cadence, step: f64) -> bool {
        self.last || cadence.is_due(self.model.number, self.model.time, step)
    }

    /// Whether the energy ledger is read in this step.
    fn reads_energies(&self, step: f64) -> bool {
        let check = self.energy.map(|check| Cadence::Steps(check.every));
        let of_observers = self.observers.iter().filter(|o| o.fields().energy);
        let mut cadences = of_observers.map(|o| o.cadence()).chain(check);
        cadences.any(|cadence| self.is_due(cadence, step))
    }

    /// Whether an observer is due in this step.
    fn is_observed(&self, step: f64) -> bool {
        let mut observers = self.observers.iter();
        observers.any(|observer| self.is_due(observer.cadence(), step))
    }

    /// Reads and checks the energy ledger if it is due.
    fn read_energies(&mut self, step: f64) -> Result<(), RunError> {
        if !self.reads_energies(step) {
            return Ok(());
        }
        let Some(reading) = self.model.read_ledger(step) else {
            return Ok(());
        };
        self.energies = reading.columns;
        self.hourglass = reading.hourglass;
        self.residual = self.residual.max(reading.residual.abs());
        let Some(check) = self.energy else {
            return Ok(());
        };
        let limit = check.limit.unwrap_or(match self.model.precision {
            Precision::F64 => 1e-7,
            Precision::Mixed => 1e-4,
            Precision::F32 => 1e-2,
        });
        if reading.residual.abs() <= limit {
            return Ok(());
        }
        Err(RunError::EnergyResidual {
            step: self.model.number,
            residual: reading.residual,
            limit,
            set: reading.worst_set,
        })
    }

    /// Calls the observers that are due; if one stops the run, the others receive the step as the last one.
    fn observe(&mut self, step: f64) -> Result<(), RunError> {
        self.read_energies(step)?;
        let due: Vec<bool> = (self.observers.iter())
            .map(|observer| self.is_due(observer.cadence(), step))
            .collect();
        if !due.contains(&true) {
            return Ok(());
        }
        let view = View::new(self.model, step, &self.energies);
        // If an observer that is due stops the run, the step is the last one for the others too.
        for round in [true, false] {
            for (observer, _) in self
                .observers
                .iter_mut()
                .zip(&due)
                .filter(|(_, d)| **d == round)
            {
                match observer.observe(&view) {
                    Ok(Flow::Continue) => {}
                    Ok(Flow::Stop) => self.stopped_by = Some(observer.name().into()),
                    Err(source) => return Err(failed(observer.name(), view.number(), source)),
                }
            }
            if self.stopped_by.is_none() {
                break;
            }
        }
        Ok(())
    }
}

impl Dynamics for TimeLoop<'_> {
    fn time(&self) -> f64 {
        self.model.time()
    }
    fn forces(&mut self, mut terms: ForceTerms, step: f64) -> Result<(), RunError> {
        // Energies and stresses are computed from the committed history variables, which must not be
        // overwritten where they are required: in the first step, in which the energy balance begins, in steps
        // for observers, and in the last one, after which they may be read from the model.
        let [first, shown] = [self.done == 0, self.is_observed(step)];
        if first || self.last || shown || self.reads_energies(step) {
            terms.history_update = HistoryUpdate::Buffered;
        }
        self.model.forces(terms, step)
    }
    fn kick(&mut self, mass_damping: MassDampingRule, step: f64) -> Result<(), RunError> {
        self.model.kick(mass_damping, step)
    }
    fn constrain(&mut self, step: f64) -> Result<(), RunError> {
        self.model.constrain(step)
    }
    fn drift(&mut self, step: f64) {
        match self.observe(step) {
            Ok(()) => self.model.drift(step),
            Err(failure) => {
                self.model.discard_kick();
                self.failure = Some(failure);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cadence in seconds falls on the first step at or past each multiple, once each.
    #[test]
    fn a_cadence_in_seconds_falls_once_on_each_multiple() {
        let step = 0.1;
        let mut time = 0.0;
        let mut due = Vec::new();
        for number in 0..21 {
            if Cadence::Seconds(0.25).is_due(number, time, step) {
                due.push(number);
            }
            time += step;
        }
        assert_eq!(due, [0, 3, 5, 8, 10, 13, 15, 18, 20]);
    }
}
