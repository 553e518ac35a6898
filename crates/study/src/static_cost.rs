//! What the stages before a run will cost.
//!
//! # Why so
//! *The first corrections of the scene's own stages are taken and timed*: what one takes depends on the
//! mesh, the laws, bolts, joints and the machine, and all of these are then in the figure. Stages that are
//! through before the time for this is up are known, not predicted.
//!
//! *How many corrections follow is not known before they are taken*: it depends on how far the ground
//! yields. Each is taken to gain so many digits as it did in the mean of staged scenes that were measured
//! (a lined cavern took 3 corrections an increment, the stages of a machine bay 2, 55, 30, 20, 19 and 12),
//! or as it does in the increment that is under way: that is the uncertain part, and the figure says by how
//! much.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use powerhouse::engine::{StaticMethod, StaticProgress};
use powerhouse::{CompletedStage, Error, Scene, Simulation, StageSink};

use crate::StudyError;

/// What the stages before a run will cost.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticCost {
    /// Wall time of all stages, the writing of their results aside.
    pub wall_time: Duration,
    /// So many times shorter or longer it may be: 1 if the stages were gone through.
    pub uncertainty: f64,
    /// Corrections that were taken and timed.
    pub timed: u32,
    /// Corrections that are expected in all, those among them.
    pub corrections: u32,
    /// Stages that come to rest by dynamic relaxation, whose steps nobody knows before: their time is
    /// not in the figure.
    pub unknown: Vec<String>,
    /// The most memory that is held while the stages are gone through (bytes), within a third.
    pub memory: u64,
}

/// Stages are gone through for so long, or until the first correction is done.
const TRIAL: Duration = Duration::from_millis(2500);
/// Digits that a correction gains where nothing yields: the linear solver leaves a hundredth.
const ELASTIC_DIGITS: f64 = 2.0;
/// Digits that a correction gains where ground yields, in the mean of the scenes of the example
/// `cost_model`.
const YIELDING_DIGITS: f64 = 0.5;
/// What is out of balance at the start of an increment over the load, in the mean of the same scenes:
/// the load of a stage is all that acts on the body, what it changes is a part of it.
const FIRST_RESIDUAL: f64 = 0.03;
/// By how much the number of corrections may differ from that.
const UNCERTAINTY: f64 = 3.0;
/// After so many corrections of an increment their own gain tells of those to come, and it counts within
/// these bounds.
const TELLING: u32 = 4;
const LEAST_DIGITS: f64 = 0.05;

/// What is known of a stage before it is gone through.
#[derive(Clone, Debug, PartialEq)]
struct Plan {
    name: String,
    increments: u32,
    /// The share of the load that comes.
    release: f64,
    tolerance: f64,
    /// Digits that a correction gains; none if one correction does it all.
    digits: Option<f64>,
    relaxes: bool,
}

impl Plan {
    /// Corrections from forces out of balance, over the load, to the gate; each gains some digits.
    fn corrections_from(&self, residual: f64, gained: Option<f64>) -> u32 {
        let digits = (residual / self.tolerance).log10();
        match gained {
            _ if digits <= 0.0 => 0,
            None => 1,
            // Rounding asks for no correction more.
            Some(gained) => (digits / gained - 1e-9).ceil() as u32,
        }
    }
    /// What corrections of the increment under way will gain, if those that were seen say so.
    fn gain_now(&self, seen: Option<f64>) -> Option<f64> {
        self.digits.map(|digits| seen.unwrap_or(digits))
    }
    /// Corrections of an increment of which nothing is known, after others that gained so much: between
    /// these and the mean.
    fn corrections(&self, seen: Option<f64>) -> u32 {
        let gained = self
            .digits
            .map(|digits| (digits * seen.unwrap_or(digits)).sqrt());
        self.corrections_from(FIRST_RESIDUAL, gained).max(1)
    }
}

/// The stages of a scene as they are planned.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plans(Vec<Plan>);

impl Plans {
    /// Those of a scene; none without stages.
    pub(crate) fn of(scene: &Scene) -> Result<Self, StudyError> {
        let yields = scene
            .parts()
            .iter()
            .any(|part| !part.material.history().is_empty());
        let path_dependent = scene.law_memory()?.numbers > 0;
        let stages = scene.stage_overviews()?;
        let bolted = stages.iter().any(|stage| !stage.bolts.is_empty());
        let plans = stages.into_iter().map(|stage| Plan {
            name: stage.name,
            increments: stage.options.increments,
            release: stage.options.release,
            tolerance: stage.options.tolerance,
            digits: match (yields, path_dependent || bolted) {
                (true, _) => Some(YIELDING_DIGITS),
                (false, true) => Some(ELASTIC_DIGITS),
                (false, false) => None,
            },
            relaxes: stage.options.method == StaticMethod::DynamicRelaxation,
        });
        Ok(Self(plans.collect()))
    }
}

/// Something that was seen of stages on their way.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    /// So many corrections of an increment, up to a share of the load, leave forces out of balance.
    Corrected {
        number: u32,
        share: f64,
        residual: f64,
    },
    /// A stage has come to rest.
    AtRest,
}

/// When it was seen.
type Seen = (Duration, Event);

/// Watches stages, and ends them when the time for it is up.
struct Watch {
    started: Instant,
    stop: Arc<AtomicBool>,
    seen: Arc<Mutex<Vec<Seen>>>,
}

impl Watch {
    fn put(&self, event: Event) {
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        seen.push((self.started.elapsed(), event));
        let first = seen.first().map_or(Duration::ZERO, |(at, _)| *at);
        let corrected =
            |(_, event): &Seen| matches!(event, Event::Corrected { number, .. } if *number > 0);
        if self.started.elapsed() - first >= TRIAL && seen.iter().any(corrected) {
            self.stop.store(true, Ordering::Relaxed);
        }
    }
}

impl StageSink for Watch {
    fn progress(&mut self, _stage: &str, progress: StaticProgress) {
        self.put(Event::Corrected {
            number: progress.correction,
            share: progress.share,
            residual: progress.residual,
        });
    }
    fn at_rest(&mut self, _stage: &CompletedStage) -> Result<(), Error> {
        self.put(Event::AtRest);
        Ok(())
    }
}

/// What the stages of a simulation will cost, with the memory that is held meanwhile (bytes); none
/// without stages.
///
/// # Errors
/// A stage that does not come to rest within the trial.
pub(crate) fn of(
    simulation: &Simulation,
    plans: &Plans,
    memory: u64,
) -> Result<Option<StaticCost>, StudyError> {
    if plans.0.is_empty() {
        return Ok(None);
    }
    let stop = Arc::new(AtomicBool::new(false));
    let seen = Arc::new(Mutex::new(Vec::new()));
    let watch = Watch {
        started: Instant::now(),
        stop: stop.clone(),
        seen: seen.clone(),
    };
    match simulation.equilibrate(Some(&stop), Some(Box::new(watch))) {
        Ok(_) | Err(Error::Interrupted { .. }) => {}
        Err(error) => return Err(error.into()),
    }
    let seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
    Ok(Some(predicted(&seen, &plans.0, memory)))
}

/// The digits that a correction gained in the increment under way, once it had enough of them.
fn gained(seen: &[Seen]) -> Option<f64> {
    let corrections = seen.iter().rev().map_while(|(_, event)| match event {
        Event::Corrected {
            number, residual, ..
        } => Some((*number, *residual)),
        Event::AtRest => None,
    });
    let (count, last) = corrections.clone().next()?;
    let (_, first) = corrections.into_iter().find(|(number, _)| *number == 0)?;
    let digits = (first / last).log10() / f64::from(count);
    (count >= TELLING).then(|| digits.clamp(LEAST_DIGITS, ELASTIC_DIGITS))
}

/// What stages come to, from what was seen of the first of them.
fn predicted(seen: &[Seen], plans: &[Plan], memory: u64) -> StaticCost {
    let (mut setting_up, mut set_up) = (Duration::ZERO, 0);
    let (mut correcting, mut timed) = (Duration::ZERO, 0);
    let (mut before, mut begun) = (Duration::ZERO, false);
    let mut at_rest = 0;
    for (at, event) in seen {
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
            Event::AtRest => {
                correcting += taken;
                (at_rest, begun) = (at_rest + 1, false);
            }
        }
    }
    let gained = gained(seen);
    let known = |plan: &&Plan| !plan.relaxes;
    let mut left = 0;
    let mut unknown: Vec<String> = Vec::new();
    for (place, plan) in plans.iter().enumerate().skip(at_rest) {
        if plan.relaxes {
            unknown.push(plan.name.clone());
            continue;
        }
        let of_increment = plan.release / f64::from(plan.increments);
        let (now, increments) = match seen.last() {
            Some((
                _,
                Event::Corrected {
                    share, residual, ..
                },
            )) if place == at_rest => (
                plan.corrections_from(*residual, plan.gain_now(gained)),
                ((plan.release - share) / of_increment).round() as u32,
            ),
            _ => (0, plan.increments),
        };
        left += now + increments * plan.corrections(gained);
    }
    let to_set_up = plans.iter().filter(known).count().saturating_sub(set_up);
    let each = |sum: Duration, count: usize| sum.div_f64(count.max(1) as f64);
    let later = each(setting_up, set_up).mul_f64(to_set_up as f64)
        + each(correcting, timed as usize).mul_f64(f64::from(left));
    let through = at_rest == plans.len();
    StaticCost {
        wall_time: before + later,
        uncertainty: if through { 1.0 } else { UNCERTAINTY },
        timed,
        corrections: timed + left,
        unknown,
        memory,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(increments: u32, release: f64, digits: Option<f64>) -> Plan {
        Plan {
            name: "stage".into(),
            increments,
            release,
            tolerance: 1e-6,
            digits,
            relaxes: false,
        }
    }

    fn corrected(at: u64, number: u32, share: f64, residual: f64) -> Seen {
        let event = Event::Corrected {
            number,
            share,
            residual,
        };
        (Duration::from_secs(at), event)
    }

    /// Stages that are through cost what they took; of others each increment to come costs the
    /// corrections that its digits ask for, at the pace of those that were timed, and each stage to come
    /// the time to set it up.
    #[test]
    fn stages_to_come_cost_what_the_first_corrections_say() {
        let plans = [plan(2, 0.5, Some(0.5)), plan(1, 1.0, Some(0.5))];
        let rest = |at: u64| (Duration::from_secs(at), Event::AtRest);
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
        // One second to set up, three corrections of two seconds; four digits are left at half a digit
        // each, then an increment and a stage of which nothing is known.
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
        // After a fourth one of two seconds that gains nothing a quarter of a digit is what corrections gain
        // here, and in increments to come something between that and the mean.
        let slow = [&begun[..], &[corrected(9, 4, 0.25, 1e-2)]].concat();
        let gain = (0.25_f64 * YIELDING_DIGITS).sqrt();
        let of_increment = (f64::log10(FIRST_RESIDUAL / 1e-6) / gain).ceil() as u32;
        let cost = predicted(&slow, &plans, 5);
        assert_eq!(cost.corrections, 4 + 16 + 2 * of_increment);
    }

    /// Without history variables one correction does it all; what relaxes is named, not counted.
    #[test]
    fn linear_stages_take_one_correction_and_relaxations_are_named() {
        let relaxing = Plan {
            name: "slides".into(),
            relaxes: true,
            ..plan(1, 1.0, None)
        };
        let plans = [plan(3, 1.0, None), relaxing, plan(2, 1.0, None)];
        let seen = [
            corrected(1, 0, 1.0 / 3.0, 1.0),
            corrected(2, 1, 1.0 / 3.0, 1e-8),
        ];
        let cost = predicted(&seen, &plans, 0);
        assert_eq!((cost.timed, cost.corrections), (1, 5));
        assert_eq!(cost.unknown, ["slides"]);
        // One to set up, one correction; two increments, another stage with two.
        assert_eq!(cost.wall_time, Duration::from_secs(2 + 2 + 1 + 2));
    }
}
