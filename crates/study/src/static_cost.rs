//! Predicted cost of the construction stages before a run.
//!
//! # Why so
//! *The first corrections of the scene's own stages are computed and timed*: the time of a correction depends on mesh,
//! laws, bolts, joints and machine, all of which are then included. Stages that are completed within the trial are
//! known, not predicted.
//!
//! *The number of further corrections is not known in advance*: it depends on the extent of yielding. Each correction
//! is assumed to reduce the residual as in the mean of measured staged scenes (a lined cavern took 3 corrections per
//! increment, the stages of a machine bay 2, 55, 30, 20, 19 and 12), or as in the current increment. This is the
//! uncertain part, which the prediction states.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use powerhouse::engine::{StaticMethod, StaticProgress};
use powerhouse::{CompletedStage, Error, Scene, Simulation, StageSink};

use crate::StudyError;

/// Predicted cost of the construction stages before a run.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticCost {
    /// Predicted wall time of all stages, without the writing of their results.
    pub wall_time: Duration,
    /// Uncertainty factor of the wall time, which may be shorter or longer by it; 1 if all stages were completed.
    pub uncertainty: f64,
    /// Number of corrections that were computed and timed.
    pub timed: u32,
    /// Predicted number of all corrections, including the timed ones.
    pub corrections: u32,
    /// Names of the stages by dynamic relaxation, whose number of steps cannot be predicted and whose time is not
    /// included.
    pub unknown: Vec<String>,
    /// Predicted peak memory during the stages (bytes), within a third.
    pub memory: u64,
    /// Unbalanced force at the start of the first stage over the load; none of a stage by dynamic relaxation, or
    /// without load.
    pub unbalanced: Option<f64>,
}

/// Duration of the trial, which lasts at least until the first correction.
const TRIAL: Duration = Duration::from_millis(2500);
/// Decades by which a correction reduces the residual without yielding: the linear solver leaves a hundredth.
const ELASTIC_DECADES: f64 = 2.0;
/// Decades by which a correction reduces the residual where ground yields, in the mean of the scenes of the example
/// `cost_model`.
const YIELDING_DECADES: f64 = 0.5;
/// Residual at the start of an increment over the load, in the mean of the same scenes; the load is that on the whole
/// body, of which a stage changes a part.
const FIRST_RESIDUAL: f64 = 0.03;
/// Uncertainty factor of the number of corrections.
const UNCERTAINTY: f64 = 3.0;
/// Number of corrections of an increment from which on their own rate is used for the prediction, and its least value.
const ENOUGH_CORRECTIONS: u32 = 4;
const LEAST_DECADES: f64 = 0.05;

/// Options of a stage on which the number of its corrections depends.
#[derive(Clone, Debug, PartialEq)]
struct StagePlan {
    name: String,
    increments: u32,
    /// Released share of the load.
    release: f64,
    tolerance: f64,
    /// Decades by which a correction reduces the residual; `None` if one correction suffices.
    decades: Option<f64>,
    relaxes: bool,
}

impl StagePlan {
    /// Number of corrections from a residual to the tolerance, at a number of decades per correction.
    fn corrections_from(&self, residual: f64, rate: Option<f64>) -> u32 {
        let decades = (residual / self.tolerance).log10();
        match rate {
            _ if decades <= 0.0 => 0,
            None => 1,
            // Rounding must not add a correction.
            Some(rate) => (decades / rate - 1e-9).ceil() as u32,
        }
    }
    /// Decades per correction in the current increment: as observed, if known.
    fn current_rate(&self, observed: Option<f64>) -> Option<f64> {
        self.decades.map(|decades| observed.unwrap_or(decades))
    }
    /// Number of corrections of a later increment, at the geometric mean of the observed and the assumed rate.
    fn corrections(&self, observed: Option<f64>) -> u32 {
        let rate = self
            .decades
            .map(|decades| (decades * observed.unwrap_or(decades)).sqrt());
        self.corrections_from(FIRST_RESIDUAL, rate).max(1)
    }
}

/// Options of all stages of a scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StagePlans(Vec<StagePlan>);

impl StagePlans {
    /// Collects the options of the stages of a scene.
    pub(crate) fn of(scene: &Scene) -> Result<Self, StudyError> {
        let yields = scene
            .parts()
            .iter()
            .any(|part| !part.material.history().is_empty());
        let path_dependent = scene.law_memory()?.numbers > 0;
        let stages = scene.stage_overviews()?;
        let bolted = stages.iter().any(|stage| !stage.bolts.is_empty());
        let plans = stages.into_iter().map(|stage| StagePlan {
            name: stage.name,
            increments: stage.options.increments,
            release: stage.options.release,
            tolerance: stage.options.tolerance,
            decades: match (yields, path_dependent || bolted) {
                (true, _) => Some(YIELDING_DECADES),
                (false, true) => Some(ELASTIC_DECADES),
                (false, false) => None,
            },
            relaxes: stage.options.method == StaticMethod::DynamicRelaxation,
        });
        Ok(Self(plans.collect()))
    }
}

/// Event during the solution of the stages.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    /// A correction of an increment, up to a share of the load, with the residual after it.
    Corrected {
        number: u32,
        share: f64,
        residual: f64,
    },
    /// Static equilibrium of a stage.
    Equilibrium,
}

/// An event with its time since the start.
type TimedEvent = (Duration, Event);

/// Timer of the stages, which cancels them at the end of the trial.
struct StageTimer {
    started: Instant,
    stop: Arc<AtomicBool>,
    events: Arc<Mutex<Vec<TimedEvent>>>,
}

impl StageTimer {
    fn put(&self, event: Event) {
        let mut events = self.events.lock().unwrap_or_else(PoisonError::into_inner);
        events.push((self.started.elapsed(), event));
        let first = events.first().map_or(Duration::ZERO, |(at, _)| *at);
        let corrected = |(_, event): &TimedEvent| matches!(event, Event::Corrected { number, .. } if *number > 0);
        if self.started.elapsed() - first >= TRIAL && events.iter().any(corrected) {
            self.stop.store(true, Ordering::Relaxed);
        }
    }
}

impl StageSink for StageTimer {
    fn progress(&mut self, _stage: &str, progress: StaticProgress) {
        self.put(Event::Corrected {
            number: progress.correction,
            share: progress.share,
            residual: progress.residual,
        });
    }
    fn completed(&mut self, _stage: &CompletedStage) -> Result<(), Error> {
        self.put(Event::Equilibrium);
        Ok(())
    }
}

/// Predicts the cost of the stages of a simulation, with a given memory (bytes); `None` without stages.
///
/// # Errors
/// A stage that fails to reach static equilibrium within the trial.
pub(crate) fn of(
    simulation: &Simulation,
    plans: &StagePlans,
    memory: u64,
) -> Result<Option<StaticCost>, StudyError> {
    if plans.0.is_empty() {
        return Ok(None);
    }
    let stop = Arc::new(AtomicBool::new(false));
    let events = Arc::new(Mutex::new(Vec::new()));
    let timer = StageTimer {
        started: Instant::now(),
        stop: stop.clone(),
        events: events.clone(),
    };
    match simulation.equilibrate(Some(&stop), Some(Box::new(timer))) {
        Ok(_) | Err(Error::Interrupted { .. }) => {}
        Err(error) => return Err(error.into()),
    }
    let events = events.lock().unwrap_or_else(PoisonError::into_inner);
    Ok(Some(predicted(&events, &plans.0, memory)))
}

/// Decades per correction in the current increment, once it has enough corrections.
fn observed_rate(events: &[TimedEvent]) -> Option<f64> {
    let corrections = events.iter().rev().map_while(|(_, event)| match event {
        Event::Corrected {
            number, residual, ..
        } => Some((*number, *residual)),
        Event::Equilibrium => None,
    });
    let (count, last) = corrections.clone().next()?;
    let (_, first) = corrections.into_iter().find(|(number, _)| *number == 0)?;
    let decades = (first / last).log10() / f64::from(count);
    (count >= ENOUGH_CORRECTIONS).then(|| decades.clamp(LEAST_DECADES, ELASTIC_DECADES))
}

/// The predicted cost of stages from the events of the first of them.
fn predicted(events: &[TimedEvent], plans: &[StagePlan], memory: u64) -> StaticCost {
    let (mut setting_up, mut set_up) = (Duration::ZERO, 0);
    let (mut correcting, mut timed) = (Duration::ZERO, 0);
    let (mut before, mut begun) = (Duration::ZERO, false);
    let mut completed = 0;
    for (at, event) in events {
        let taken = *at - before;
        before = *at;
        match event {
            Event::Corrected { .. } if !begun => {
                (setting_up, set_up) = (setting_up + taken, set_up + 1);
                begun = true;
            }
            Event::Corrected { number, .. } => {
                correcting += taken;
                timed += u32::from(*number > 0);
            }
            Event::Equilibrium => {
                correcting += taken;
                (completed, begun) = (completed + 1, false);
            }
        }
    }
    let rate = observed_rate(events);
    let known = |plan: &&StagePlan| !plan.relaxes;
    let mut left = 0;
    let mut unknown: Vec<String> = Vec::new();
    for (index, plan) in plans.iter().enumerate().skip(completed) {
        if plan.relaxes {
            unknown.push(plan.name.clone());
            continue;
        }
        let of_increment = plan.release / f64::from(plan.increments);
        let (now, increments) = match events.last() {
            Some((
                _,
                Event::Corrected {
                    share, residual, ..
                },
            )) if index == completed => (
                plan.corrections_from(*residual, plan.current_rate(rate)),
                ((plan.release - share) / of_increment).round() as u32,
            ),
            _ => (0, plan.increments),
        };
        left += now + increments * plan.corrections(rate);
    }
    let to_set_up = plans.iter().filter(known).count().saturating_sub(set_up);
    let each = |sum: Duration, count: usize| sum.div_f64(count.max(1) as f64);
    let later = each(setting_up, set_up).mul_f64(to_set_up as f64)
        + each(correcting, timed as usize).mul_f64(f64::from(left));
    let is_complete = completed == plans.len();
    let relaxes = plans.first().is_none_or(|plan| plan.relaxes);
    // An increment applies its share of the forces that are unbalanced at the start.
    let unbalanced = match events.first() {
        Some((
            _,
            Event::Corrected {
                number: 0,
                share,
                residual,
            },
        )) if !relaxes => Some(residual / share),
        _ => None,
    };
    StaticCost {
        wall_time: before + later,
        uncertainty: if is_complete { 1.0 } else { UNCERTAINTY },
        timed,
        corrections: timed + left,
        unknown,
        memory,
        unbalanced,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(increments: u32, release: f64, decades: Option<f64>) -> StagePlan {
        StagePlan {
            name: "stage".into(),
            increments,
            release,
            tolerance: 1e-6,
            decades,
            relaxes: false,
        }
    }

    fn corrected(at: u64, number: u32, share: f64, residual: f64) -> TimedEvent {
        let event = Event::Corrected {
            number,
            share,
            residual,
        };
        (Duration::from_secs(at), event)
    }

    /// Completed stages cost their measured time; later increments cost the corrections that their rate requires, at the
    /// measured time per correction, and later stages also the time of their set-up.
    #[test]
    fn later_stages_cost_what_the_first_corrections_predict() {
        let plans = [plan(2, 0.5, Some(0.5)), plan(1, 1.0, Some(0.5))];
        let rest = |at: u64| (Duration::from_secs(at), Event::Equilibrium);
        let through = [
            corrected(1, 0, 0.25, 1e-2),
            corrected(3, 1, 0.25, 1e-7),
            corrected(3, 0, 0.5, 1e-7),
            rest(4),
            corrected(6, 0, 1.0, 1e-7),
            rest(7),
        ];
        let cost = predicted(&through, &plans, 5);
        assert_eq!(cost.wall_time, Duration::from_secs(7));
        assert_eq!(
            (cost.uncertainty, cost.timed, cost.corrections),
            (1.0, 1, 1)
        );
        assert_eq!(cost.memory, 5);
        assert_eq!(cost.unbalanced, Some(0.04));
        // One second of set-up, three corrections of two seconds; four decades are left at half a decade each, then an
        // increment and a stage at the assumed rate.
        let begun = [
            corrected(1, 0, 0.25, 1e-1),
            corrected(3, 1, 0.25, 1e-1),
            corrected(5, 2, 0.25, 1e-2),
            corrected(7, 3, 0.25, 1e-2),
        ];
        let of_increment = (f64::log10(FIRST_RESIDUAL / 1e-6) / 0.5).ceil() as u32;
        let left = 8 + 2 * of_increment;
        let cost = predicted(&begun, &plans, 5);
        assert_eq!((cost.timed, cost.corrections), (3, 3 + left));
        let expected = 7 + 1 + 2 * u64::from(left);
        assert!((cost.wall_time.as_secs_f64() - expected as f64).abs() < 1e-6);
        assert!(cost.uncertainty > 1.0);
        // After a fourth correction without progress the rate is a quarter of a decade here, and the geometric mean of
        // that and the assumed one in later increments.
        let slow = [&begun[..], &[corrected(9, 4, 0.25, 1e-2)]].concat();
        let gain = (0.25_f64 * YIELDING_DECADES).sqrt();
        let of_increment = (f64::log10(FIRST_RESIDUAL / 1e-6) / gain).ceil() as u32;
        let cost = predicted(&slow, &plans, 5);
        assert_eq!(cost.corrections, 4 + 16 + 2 * of_increment);
    }

    /// Without history variables one correction suffices; stages by dynamic relaxation are named, not counted.
    #[test]
    fn linear_stages_take_one_correction_and_relaxations_are_named() {
        let relaxing = StagePlan {
            name: "slides".into(),
            relaxes: true,
            ..plan(1, 1.0, None)
        };
        let plans = [plan(3, 1.0, None), relaxing, plan(2, 1.0, None)];
        let events = [
            corrected(1, 0, 1.0 / 3.0, 1.0),
            corrected(2, 1, 1.0 / 3.0, 1e-8),
        ];
        let cost = predicted(&events, &plans, 0);
        assert_eq!((cost.timed, cost.corrections), (1, 5));
        assert_eq!(cost.unknown, ["slides"]);
        // One second of set-up, one correction; two increments, another stage with two.
        assert_eq!(cost.wall_time, Duration::from_secs(2 + 2 + 1 + 2));
    }
}
