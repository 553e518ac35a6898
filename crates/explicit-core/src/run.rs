//! The run: steps, observers, and what ends it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use powerhouse_model::{
    Cadence, Dynamics, Flow, ForceTerms, MassDampingRule, Observer, ParameterError, RunError,
    StepView, TimeIntegrator,
};

use crate::view::View;
use crate::{HourglassShare, Model, Precision, StableStep};

/// How long a run lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// Until the first step at or past this time (s) after the run's start has been shown.
    Seconds(f64),
    /// So many steps.
    Steps(u64),
}

/// Which step a run takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum StepChoice {
    /// The stable step of the model.
    #[default]
    Stable,
    /// This step (s); refused if it is above the stable one.
    Fixed(f64),
    /// This step (s), stable or not; for studies of stability.
    Unchecked(f64),
}

/// A check of the energy ledger while the run goes on.
///
/// The ledger costs time at every step: the blocks account for their dissipation, and with
/// `by_set` each set's nodal work is booked.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct EnergyCheck {
    /// Steps between two readings.
    pub every: u64,
    /// Largest permitted residual over the largest energy held or put in so far; by default 1e-7
    /// in double precision, 1e-4 in mixed, 1e-2 in single.
    pub limit: Option<f64>,
    /// Whether each set's balance is kept, so that a fault names its set with certainty; without,
    /// it names the set whose energy changed most.
    pub by_set: bool,
}

impl EnergyCheck {
    /// A reading every so many steps, with balances by set and the default limit.
    pub fn every(steps: u64) -> Self {
        Self {
            every: steps,
            limit: None,
            by_set: true,
        }
    }
    /// The same with a largest permitted residual over the largest energy held or put in so far.
    #[must_use]
    pub fn with_limit(mut self, limit: f64) -> Self {
        self.limit = Some(limit);
        self
    }
    /// The same with or without a balance of each set.
    #[must_use]
    pub fn with_by_set(mut self, by_set: bool) -> Self {
        self.by_set = by_set;
        self
    }
}

/// What a run is to do.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RunOptions {
    /// How long.
    pub length: Length,
    /// The step.
    pub step: StepChoice,
    /// Bound on each component of velocity (m/s), beyond which the motion counts as diverged. By
    /// default the speed at which strains reach the order of one, far beyond any use of a theory
    /// of small strains: the greatest product of half an element's frequency and its diagonal.
    pub speed_limit: Option<f64>,
    /// Whether the energy ledger is checked on the way. It is kept without a check where an
    /// observer asks for energies. It begins with the run.
    pub energy: Option<EnergyCheck>,
    /// Raised from outside, it ends the run after one more step; the output is complete.
    pub stop: Option<Arc<AtomicBool>>,
}

impl RunOptions {
    /// A run of some time (s) with the stable step.
    pub fn seconds(duration: f64) -> Self {
        Self::of(Length::Seconds(duration))
    }
    /// A run of so many steps with the stable step.
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
    /// The same with a step.
    #[must_use]
    pub fn with_step(mut self, step: StepChoice) -> Self {
        self.step = step;
        self
    }
    /// The same with a bound on the speed (m/s).
    #[must_use]
    pub fn with_speed_limit(mut self, limit: f64) -> Self {
        self.speed_limit = Some(limit);
        self
    }
    /// The same with a check of the energy ledger.
    #[must_use]
    pub fn with_energy(mut self, check: EnergyCheck) -> Self {
        self.energy = Some(check);
        self
    }
    /// The same with a flag that ends the run.
    #[must_use]
    pub fn with_stop(mut self, stop: Arc<AtomicBool>) -> Self {
        self.stop = Some(stop);
        self
    }
}

/// Where a run stands.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Steps done in this run.
    pub done: u64,
    /// Steps that this run is to have.
    pub planned: u64,
    /// Time of the displacement (s).
    pub time: f64,
}

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ended {
    /// It was to end there.
    Completed,
    /// An observer of this name had seen enough.
    Observer(String),
    /// It was stopped from outside.
    Stopped,
    /// An error with this message ended it; only reports of a [`RunFailure`] say so.
    Failed(String),
}

/// What a run did.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RunReport {
    /// Steps done in this run.
    pub steps: u64,
    /// Their length (s).
    pub step: f64,
    /// Time of the displacement at the end (s).
    pub time: f64,
    /// The stable step, unless it was not asked for.
    pub stable: Option<StableStep>,
    /// Why it ended.
    pub ended: Ended,
    /// The last reading of the energy ledger (J), by column; empty if none was kept.
    pub energies: Vec<(&'static str, f64)>,
    /// The largest residual of the ledger over the largest energy held or put in until then.
    pub energy_residual: f64,
    /// What hourglass resistance took of the internal work of each set: where a ledger was kept at most
    /// as far as it was read, else what is held at the end.
    pub hourglass: Vec<HourglassShare>,
}

/// A run that an error ended.
#[derive(Debug)]
pub struct RunFailure {
    /// What ended it.
    pub error: RunError,
    /// What was done until then; none if the run was refused before its first step.
    pub report: Option<Box<RunReport>>,
}

/// Steps a model as [`run`] does, and reports what was done even if it fails on its way.
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
    let outcome = model.in_pool(|model| steps(model, integrator, options, observers, progress));
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
    let (mut report, played) = outcome.map_err(refused)?;
    match played.and(finished) {
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

/// Steps a model, showing it to observers.
///
/// A step from `t` to `t + dt` shows the state at `t`, when the velocities before and after are
/// both known. The run therefore ends one step after the last state shown, and a run that goes on
/// from there shows each state once. Observers are shown the last step whatever their cadence, and
/// finished whatever happens.
///
/// `progress` is called after every step.
///
/// # Errors
/// What refused the step before the run, or what ended it before its time.
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

/// Refuses a run, or gives the report of the steps that it had and what ended them too early.
fn steps(
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
        // The last state shown is the first at or past the end.
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
    let mut stage = TimeLoop {
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
    let result = stage.play(integrator, options, step, planned, progress);
    let TimeLoop {
        model,
        energies,
        residual,
        mut hourglass,
        done,
        ..
    } = stage;
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
    let played = result.map(|ended| report.ended = ended);
    Ok((report, played))
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
    /// The last reading of the ledger, and the worst residual so far.
    energies: Vec<(&'static str, f64)>,
    residual: f64,
    hourglass: Vec<HourglassShare>,
    last: bool,
    stopped_by: Option<String>,
    failure: Option<RunError>,
    done: u64,
}

impl TimeLoop<'_> {
    /// All steps of a run, and why they ended.
    fn play(
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

    /// Whether the ledger is read in this step.
    fn reads_energies(&self, step: f64) -> bool {
        let check = self.energy.map(|check| Cadence::Steps(check.every));
        let of_observers = self.observers.iter().filter(|o| o.fields().energy);
        let mut cadences = of_observers.map(|o| o.cadence()).chain(check);
        cadences.any(|cadence| self.is_due(cadence, step))
    }

    /// Whether an observer is due in this step.
    fn is_shown(&self, step: f64) -> bool {
        let mut observers = self.observers.iter();
        observers.any(|observer| self.is_due(observer.cadence(), step))
    }

    /// Reads the ledger if it is time.
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

    fn show(&mut self, step: f64) -> Result<(), RunError> {
        self.read_energies(step)?;
        let due: Vec<bool> = (self.observers.iter())
            .map(|observer| self.is_due(observer.cadence(), step))
            .collect();
        if !due.contains(&true) {
            return Ok(());
        }
        let view = View::new(self.model, step, &self.energies);
        // If one of those that are due ends the run, the step is the last for the others too.
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
        // Where energies and stresses are asked for, the old history is needed once more: with the first step
        // the ledger begins, and after the last one the model may be asked.
        let [first, shown] = [self.done == 0, self.is_shown(step)];
        let asked = first || self.last || shown || self.reads_energies(step);
        terms.once = terms.once && !asked;
        self.model.forces(terms, step)
    }
    fn kick(&mut self, mass_damping: MassDampingRule, step: f64) -> Result<(), RunError> {
        self.model.kick(mass_damping, step)
    }
    fn constrain(&mut self, step: f64) -> Result<(), RunError> {
        self.model.constrain(step)
    }
    fn drift(&mut self, step: f64) {
        match self.show(step) {
            Ok(()) => self.model.drift(step),
            Err(failure) => {
                self.model.forget();
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
