//! One run of a trade, and what it came to.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use powerhouse::engine::Ended;
use powerhouse::engine::observe::HistoryTable;
use powerhouse::io::{TableColumn, read_table, write_summary, write_table};
use powerhouse::{EquilibratedBody, RunHooks, Scene};
use serde::{Deserialize, Serialize};

use super::TradeWatch;
use crate::StudyError;
use crate::cost::Account;
use crate::mark::Mark;

const COST: &str = "cost.json";
const HISTORIES: &str = "histories.csv";
const MARK: &str = "finished.json";

/// What a run costs, from a window of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseCost {
    /// Length of a step (s).
    pub step: f64,
    /// Wall time of a step (s).
    pub time_of_step: f64,
    /// Wall time of what comes before the steps: model, stable step, stages (s).
    pub before: f64,
    /// Steps of the whole run.
    pub steps: u64,
    /// Memory of the whole run (bytes), as predicted.
    pub memory: u64,
}

impl CaseCost {
    /// Wall time of the whole run (s).
    pub fn wall_time(&self) -> f64 {
        self.before + self.time_of_step * self.steps as f64
    }
}

/// A run with what it recorded.
pub(super) struct Finished {
    pub(super) cost: CaseCost,
    pub(super) histories: Vec<TableColumn>,
}

/// The instants at which the first and the last step were done, and how many lie between.
#[derive(Clone, Copy, Default)]
struct Clock {
    first: Option<(Instant, u64)>,
    last: Option<(Instant, u64)>,
}

/// Where and how long the runs of a trade go.
pub(super) struct TradeRunner<'a> {
    pub(super) stop: Option<&'a Arc<AtomicBool>>,
    /// Duration of a run (s), and of the scene's own.
    pub(super) window: f64,
    pub(super) duration: f64,
    pub(super) bodies: Bodies,
}

/// Bodies that have gone through their stages, by what decides of them: the first one, that of the reference,
/// and the last; each is as large as a model.
#[derive(Default)]
pub(super) struct Bodies(Vec<(String, StagingOutcome)>);

/// A body at rest and the wall time of its stages (s).
#[derive(Clone)]
struct StagingOutcome {
    body: EquilibratedBody,
    took: f64,
}

impl Bodies {
    fn get(&self, name: &str) -> Option<&StagingOutcome> {
        let known = self.0.iter().find(|(other, _)| other == name);
        known.map(|(_, body)| body)
    }
    fn keep(&mut self, name: &str, body: StagingOutcome) {
        self.0.truncate(1);
        self.0.push((name.to_owned(), body));
    }
}

impl TradeRunner<'_> {
    /// What was found before from the same files, if it was finished.
    pub(super) fn kept(&self, folder: &Path, mark: &Mark) -> Result<Option<Finished>, StudyError> {
        if !mark.is_in(&folder.join(MARK)) {
            return Ok(None);
        }
        let file = folder.join(COST);
        let text = std::fs::read(&file).map_err(|source| StudyError::Read {
            file: file.clone(),
            source,
        })?;
        let cost =
            serde_json::from_slice(&text).map_err(|source| StudyError::Outcome { file, source })?;
        let histories = read_table(&folder.join(HISTORIES)).map_err(powerhouse::Error::from)?;
        Ok(Some(Finished { cost, histories }))
    }

    /// Runs a scene for the window; its body at rest is that of `body`, if one is known.
    pub(super) fn run(
        &mut self,
        scene: Scene,
        body: &str,
        watch: &mut dyn TradeWatch,
    ) -> Result<Finished, StudyError> {
        let started = Instant::now();
        let account = Account::of(&scene)?;
        let mut simulation = scene.with_duration(self.window).prepare()?;
        let step = simulation.step()?;
        let composed = started.elapsed().as_secs_f64();
        let rested = match self.bodies.get(body) {
            Some(known) => Some(known.clone()),
            None => {
                let started = Instant::now();
                let found = simulation.equilibrate(self.stop, None);
                let found = found.map_err(|error| match error {
                    powerhouse::Error::Interrupted { .. } => StudyError::Interrupted,
                    error => error.into(),
                })?;
                let took = started.elapsed().as_secs_f64();
                let found = found.map(|body| StagingOutcome { body, took });
                if let Some(found) = &found {
                    self.bodies.keep(body, found.clone());
                }
                found
            }
        };
        // A run of its own goes through its stages, whoever has done so here.
        let before = composed + rested.as_ref().map_or(0.0, |rested| rested.took);
        let clock = Arc::new(Mutex::new(Clock::default()));
        let (ticks, mut told) = (clock.clone(), watch.progress());
        let mut hooks = RunHooks::default().with_progress(move |progress| {
            let now = Some((Instant::now(), progress.done));
            let mut clock = ticks.lock().unwrap_or_else(PoisonError::into_inner);
            clock.first = clock.first.or(now);
            clock.last = now;
            if let Some(told) = &mut told {
                told(progress);
            }
        });
        hooks.stop = self.stop.cloned();
        hooks.equilibrated_body = rested.map(|rested| rested.body);
        let results = simulation.run(hooks)?;
        let stopped = self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed));
        if stopped && results.run.ended != Ended::Completed {
            return Err(StudyError::Interrupted);
        }
        let clock = *clock.lock().unwrap_or_else(PoisonError::into_inner);
        let time_of_step = match (clock.first, clock.last) {
            (Some((first, one)), Some((last, all))) if all > one => {
                (last - first).as_secs_f64() / (all - one) as f64
            }
            _ => results.wall_time.as_secs_f64() / results.run.steps.max(1) as f64,
        };
        let steps = (self.duration / step).ceil() as u64 + 1;
        Ok(Finished {
            cost: CaseCost {
                step,
                time_of_step,
                before,
                steps,
                memory: account.memory(steps),
            },
            histories: columns(&results.histories),
        })
    }

    /// Keeps what a run came to; its mark goes last.
    pub(super) fn keep(
        &self,
        folder: &Path,
        mark: &Mark,
        finished: &Finished,
    ) -> Result<(), StudyError> {
        let write = || -> Result<(), powerhouse::io::IoError> {
            write_summary(&folder.join(COST), &finished.cost)?;
            write_table(&folder.join(HISTORIES), &finished.histories)?;
            write_summary(&folder.join(MARK), mark)
        };
        std::fs::create_dir_all(folder).map_err(|source| StudyError::Read {
            file: folder.into(),
            source,
        })?;
        Ok(write().map_err(powerhouse::Error::from)?)
    }
}

/// A table of histories with its times in front.
pub(crate) fn columns(table: &HistoryTable) -> Vec<TableColumn> {
    let mut columns = vec![TableColumn::new("time", "s", table.times.clone())];
    let others = table.columns.iter();
    columns.extend(others.map(|c| TableColumn::new(c.name.clone(), c.unit, c.values.clone())));
    columns
}
