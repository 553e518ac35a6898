//! Dynamic runs: time loop, observers, energy check, termination.

use std::sync::atomic::Ordering;
use std::time::Instant;

use powerhouse_model::{
    Cadence, CheckpointSink, Dynamics, Ended, EnergyCheck, Flow, ForceTerms, Length,
    MassDampingRule, Observer, ParameterError, Precision, Progress, Reach, RunError, RunFailure,
    RunOptions, RunReport, StableStep, StateError, StepChoice, StepView, TimeIntegrator,
};

use crate::Model;
use crate::device::DeviceRun;
use crate::profile::{Phase, Profiler};
use crate::ranks::{Decision, Gathered, Wanted};
use crate::saved::{Readings, restore_observers};
use crate::view::View;

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
    // On other ranks than rank 0 observers have seen nothing.
    let at_work = match model.ranks.team.rank() {
        0 => observers,
        _ => &mut [],
    };
    for observer in at_work {
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
/// `progress` is called after every step, or after all that a device took at once.
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

/// Largest residual of the energy balance of a slice with laws that are not linear: where a material flows or cracks, its tractions
/// follow the momentum by an error of the first order in the step, some thousandths at steps near the stable one.
const DELAYED_LIMIT: f64 = 0.01;

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
    let resumed = options.resume.as_deref();
    let restored = resumed.map(|saved| model.restore_run(saved)).transpose();
    let restored = model.ranks.agree(restored)?;
    let (step, stable) = choose_step(model, integrator, options, resumed.map(|saved| saved.step))?;
    let planned = match options.length {
        Length::Steps(count) => count,
        // The last output state is the first at or past the end.
        Length::Seconds(duration) => (duration / step - 1e-6).ceil().max(0.0) as u64 + 1,
    };
    model.ranks.check_same_run(step, planned, observers)?;
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
    if let (Some(saved), Some(restored)) = (resumed, &restored) {
        let mut put = model.restore_ledger(restored, saved.new_observers);
        // On other ranks than rank 0 observers see nothing.
        if put.is_ok() && !saved.new_observers && model.ranks.team.rank() == 0 {
            put = restore_observers(saved, observers);
        }
        model.ranks.agree(put)?;
    }
    if options.profile {
        let (blocks, constraints) = (model.blocks.len(), model.constraints.len());
        model.profiler = Some(Box::new(Profiler::new(blocks, constraints)));
    }
    let device = model.load_device(integrator, step, options.profile);
    let device = device.inspect_err(|_| {
        // A run that is refused leaves nothing open.
        model.close_ledger();
        model.profiler = None;
    })?;
    let keeps = model.ranks.team.rank() == 0 && options.checkpoints.is_some();
    let keeps = model.ranks.team.least(u64::from(!keeps)) == 0;
    let started = Instant::now();
    let mut time_loop = TimeLoop {
        reach: observers.iter().map(|observer| observer.reach()).collect(),
        observers,
        energy: options.energy,
        readings: restored
            .map(|restored| restored.readings)
            .unwrap_or_default(),
        last: false,
        stopped_by: None,
        failure: None,
        keeps,
        device,
        done: resumed.map_or(0, |saved| saved.done),
        model,
    };
    let result = time_loop.run(integrator, options, step, planned, progress);
    let result = time_loop.model.settle(result);
    let wall = started.elapsed();
    let TimeLoop {
        model,
        readings,
        done,
        ..
    } = time_loop;
    let Readings {
        energies,
        residual,
        mut hourglass,
        fibres,
    } = readings;
    if model.ledger.is_none() {
        hourglass = model.hourglass_shares();
    }
    model.close_ledger();
    let profile = model.profiler.take().map(|profiler| {
        let constraints = model.constraints.iter();
        let names: Vec<&str> = constraints.map(|bound| bound.constraint.name()).collect();
        profiler.report(done, wall, &model.blocks, &names)
    });
    let mut report = RunReport::new(done, step, model.time());
    report.profile = profile;
    report.device = model.device_share();
    report.stable = stable;
    report.energies = energies;
    report.energy_residual = residual;
    report.hourglass = hourglass;
    report.fibre_energies = fibres;
    report.unsolved = (model.bay.as_ref()).and_then(|bay| bay.motion.unsolved);
    let completed = result.map(|ended| report.ended = ended);
    Ok((report, completed))
}

fn choose_step(
    model: &mut Model,
    integrator: &dyn TimeIntegrator,
    options: &RunOptions,
    resumed: Option<f64>,
) -> Result<(f64, Option<StableStep>), RunError> {
    // The step of a resumed run is the same to the bit: a choice that gives another one is that of another run.
    let (step, stable) = match options.step {
        StepChoice::Stable => {
            let stable = model.stable_step(integrator)?;
            (stable.step, Some(stable))
        }
        StepChoice::Fixed(step) => {
            let limits = model.frequency_limits();
            integrator.check(&limits, step)?;
            (step, Some(model.stable_step(integrator)?))
        }
        StepChoice::Unchecked(step) => {
            ParameterError::check("step", step, f64::MIN_POSITIVE, f64::MAX)?;
            (step, None)
        }
    };
    match resumed {
        Some(saved) if saved.to_bits() != step.to_bits() => Err(RunError::State {
            part: "the run".into(),
            source: StateError::Foreign {
                what: "the time step (s)",
                found: saved.to_string(),
                expected: step.to_string(),
            },
        }),
        _ => Ok((step, stable)),
    }
}

/// Driver of the time loop: calls observers in every step between the update of velocities and that of
/// displacements.
struct TimeLoop<'a> {
    model: &'a mut Model,
    observers: &'a mut [Box<dyn Observer>],
    /// What each of them reads.
    reach: Vec<Reach>,
    energy: Option<EnergyCheck>,
    readings: Readings,
    last: bool,
    stopped_by: Option<String>,
    failure: Option<RunError>,
    /// Whether rank 0 has a receiver of checkpoints.
    keeps: bool,
    /// Steps that a device takes, if the model has one.
    device: Option<DeviceRun>,
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
        let sink = options.checkpoints.as_ref();
        let first = self.done;
        while self.done < planned {
            let (done, model) = (self.done, &mut *self.model);
            let now = Progress::new(done, planned, model.time);
            let is_due = || done > first && sink.is_some_and(|sink| sink.is_due(&now));
            let decision = model.ranks.agree_to_stop(raised(), is_due, done)?;
            let stopped = decision == Decision::Stop;
            if decision != Decision::GoOn {
                // The next step is the last one of a run that stops, but not of one that goes on.
                self.checkpoint(options, step)?;
            }
            self.last = stopped || self.done + 1 == planned;
            let unseen = if self.last || done == first {
                0
            } else {
                self.unseen_steps(step, planned, sink.map(AsRef::as_ref))
            };
            let taken = if self.leave_to_device(unseen, step)? {
                unseen
            } else {
                integrator.step(self, step)?;
                1
            };
            if let Some(failure) = self.failure.take() {
                return Err(failure);
            }
            if let Some(fault) = self.model.fault.take() {
                return Err(fault);
            }
            self.done += taken;
            let reached = Progress::new(self.done, planned, self.model.time);
            progress(reached);
            if let Some(name) = self.stopped_by.take() {
                return Ok(Ended::Observer(name));
            }
            if stopped {
                return Ok(Ended::Stopped);
            }
            let is_due = self.model.ranks.is_single() && self.done < planned;
            if is_due && sink.is_some_and(|sink| sink.is_due(&reached)) {
                self.checkpoint(options, step)?;
            }
        }
        Ok(Ended::Completed)
    }

    /// Number of steps from the present one on that a device can take, because nothing of them is seen, and no state is kept before
    /// their end.
    fn unseen_steps(&self, step: f64, planned: u64, sink: Option<&dyn CheckpointSink>) -> u64 {
        let Some(device) = &self.device else {
            return 0;
        };
        if self.done < device.host_until {
            return 0;
        }
        let most = device.most.min(planned - 1 - self.done);
        let (mut number, mut time) = (self.model.number, self.model.time);
        let is_seen = |number, time| {
            let cadences = self.observers.iter().map(|observer| observer.cadence());
            let mut asked = cadences.filter(|cadence| *cadence != Cadence::HostSteps);
            asked.any(|cadence| cadence.is_due(number, time, step))
        };
        let mut count = 0;
        while count < most && !is_seen(number, time) {
            count += 1;
            number += 1;
            time += step;
            let reached = Progress::new(self.done + count, planned, time);
            if sink.is_some_and(|sink| sink.is_due(&reached)) {
                break;
            }
        }
        count
    }

    /// Leaves a number of steps to the device, if there are any; returns whether it took them.
    fn leave_to_device(&mut self, count: u64, step: f64) -> Result<bool, RunError> {
        if count == 0 {
            return Ok(false);
        }
        let taken = self.model.advance_on_device(count, step)?;
        if let (false, Some(device)) = (taken, &mut self.device) {
            // The host repeats them and names the element.
            device.host_until = self.done + count;
        }
        Ok(taken)
    }

    /// Passes the present state of the run to the receiver of checkpoints, if there is one.
    fn checkpoint(&mut self, options: &RunOptions, step: f64) -> Result<(), RunError> {
        if !self.keeps {
            return Ok(());
        }
        self.model.ranks.agree_to_go_on()?;
        let saved = (self.model).save_run((self.done, step), &self.readings, self.observers)?;
        let sink = options.checkpoints.as_ref();
        let Some(sink) = sink.filter(|_| self.model.ranks.team.rank() == 0) else {
            return Ok(());
        };
        let taken = sink.take(saved);
        taken.map_err(|source| failed("checkpoint", self.model.number, source))
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

    /// Whether an observer is due in this step that reads more than motion.
    fn is_observed(&self, step: f64) -> bool {
        let mut observers = self.observers.iter().zip(&self.reach);
        observers.any(|(observer, reach)| {
            let fields = observer.fields();
            let reads_more = fields.stress || fields.energy || !reach.is_motion_alone();
            reads_more && self.is_due(observer.cadence(), step)
        })
    }

    /// Reads and checks the energy ledger if it is due.
    fn read_energies(&mut self, step: f64) -> Result<(), RunError> {
        if !self.reads_energies(step) {
            return Ok(());
        }
        self.model.ranks.agree_to_go_on()?;
        let limit = self.energy.and_then(|check| check.limit);
        let is_exact = || self.model.is_linear() && self.model.constraints.is_empty();
        let yields = || self.model.is_delayed() && !is_exact();
        let limit = limit.unwrap_or(match self.model.precision {
            Precision::F64 if yields() => DELAYED_LIMIT,
            Precision::F64 => 1e-7,
            Precision::Mixed => 1e-4,
            Precision::F32 => 1e-2,
        });
        let Some(reading) = self.model.read_ledger(step, limit) else {
            return Ok(());
        };
        self.readings.energies = reading.columns;
        self.readings.hourglass = reading.hourglass;
        for (most, energy) in self.readings.fibres.iter_mut().zip(reading.fibres) {
            *most = most.max(energy);
        }
        let residual = &mut self.readings.residual;
        *residual = residual.max(reading.residual.abs());
        if self.energy.is_none() || reading.residual.abs() <= limit {
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
        let start = self.model.clock();
        self.read_energies(step)?;
        self.model.spent(Phase::EnergyBalance, start);
        let start = self.model.clock();
        let observed = self.call_observers(step);
        self.model.spent(Phase::Observers, start);
        observed
    }

    fn call_observers(&mut self, step: f64) -> Result<(), RunError> {
        let due: Vec<bool> = (self.observers.iter())
            .map(|observer| self.is_due(observer.cadence(), step))
            .collect();
        if !due.contains(&true) {
            return Ok(());
        }
        let energies = &self.readings.energies;
        if self.model.ranks.is_single() {
            let view = View::new(self.model, step, energies);
            self.stopped_by = show(self.observers, &due, &view)?;
            return Ok(());
        }
        self.model.ranks.agree_to_go_on()?;
        let observers = self.observers.iter().map(|observer| observer.as_ref());
        let all = observers.zip(&self.reach).zip(&due);
        let wanted = Wanted::of(all.filter(|(_, due)| **due).map(|(read, _)| read));
        // Rank 0 alone has observers at work.
        let gathered = Gathered::of(self.model, step, wanted, energies);
        let shown = gathered.map(|view| {
            let stopped_by = show(self.observers, &due, &view)?;
            match view.missing() {
                None => Ok(stopped_by),
                Some(what) => Err(self.model.ranks.run_on_one_rank_only(what)),
            }
        });
        self.stopped_by = self.model.ranks.follow_first(shown)?;
        Ok(())
    }
}

/// Calls the observers that are due; if one stops the run, the others too, for which the step is the last one. Returns the
/// name of the observer that stopped it.
fn show(
    observers: &mut [Box<dyn Observer>],
    due: &[bool],
    view: &dyn StepView,
) -> Result<Option<String>, RunError> {
    let mut stopped_by = None;
    for round in [true, false] {
        let wanted = observers.iter_mut().zip(due);
        for (observer, _) in wanted.filter(|(_, due)| **due == round) {
            match observer.observe(view) {
                Ok(Flow::Continue) => {}
                Ok(Flow::Stop) => stopped_by = Some(observer.name().into()),
                Err(source) => return Err(failed(observer.name(), view.number(), source)),
            }
        }
        if stopped_by.is_none() {
            break;
        }
    }
    Ok(stopped_by)
}

impl Dynamics for TimeLoop<'_> {
    fn time(&self) -> f64 {
        self.model.time()
    }
    fn forces(&mut self, mut terms: ForceTerms, step: f64) -> Result<(), RunError> {
        // Elements are read in the first step, in which the energy balance begins, in steps for observers, and after the last one
        // from the model.
        let is_end = self.done == 0 || self.last;
        terms.shown = is_end || self.is_observed(step) || self.reads_energies(step);
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
