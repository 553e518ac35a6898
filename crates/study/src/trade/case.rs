//! One run of a trade study, with its cost and histories.

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
use crate::cost::CostModel;
use crate::mark::Fingerprint;

const COST: &str = "cost.json";
const HISTORIES: &str = "histories.csv";
const MARK: &str = "finished.json";

/// Cost of a whole run, measured over the window of a trade study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseCost {
    /// Length of the time step (s).
    pub step: f64,
    /// Mean wall time of a step (s).
    pub time_of_step: f64,
    /// Wall time before the first step (s): assembly of the model, stable step, construction stages (also where their
    /// result was reused).
    pub before: f64,
    /// Number of steps of the whole run.
    pub steps: u64,
    /// Predicted memory of the whole run (bytes).
    pub memory: u64,
}

impl CaseCost {
    /// Predicted wall time of the whole run (s).
    pub fn wall_time(&self) -> f64 {
        self.before + self.time_of_step * self.steps as f64
    }
}

/// Cost and histories of a finished run.
pub(super) struct TradeRun {
    pub(super) cost: CaseCost,
    pub(super) histories: Vec<TableColumn>,
}

/// Instants after the first and the last step, with the numbers of steps done.
#[derive(Clone, Copy, Default)]
struct StepTimes {
    first: Option<(Instant, u64)>,
    last: Option<(Instant, u64)>,
}

/// Common settings of the runs of a trade study, with the cache of equilibrated bodies.
pub(super) struct TradeRunner<'a> {
    pub(super) stop: Option<&'a Arc<AtomicBool>>,
    /// Duration of a run (s), and of the whole scene (s).
    pub(super) window: f64,
    pub(super) duration: f64,
    pub(super) bodies: BodyCache,
}

/// Cache of equilibrated bodies by the factors on which they depend: that of the reference and the last one, since
/// each is as large as a model.
#[derive(Default)]
pub(super) struct BodyCache(Vec<(String, StagingOutcome)>);

/// A body in static equilibrium and the wall time of its stages (s).
#[derive(Clone)]
struct StagingOutcome {
    body: EquilibratedBody,
    took: f64,
}

impl BodyCache {
    fn get(&self, name: &str) -> Option<&StagingOutcome> {
        let known = self.0.iter().find(|(other, _)| other == name);
        known.map(|(_, body)| body)
    }
    fn store(&mut self, name: &str, body: StagingOutcome) {
        self.0.truncate(1);
        self.0.push((name.to_owned(), body));
    }
}

impl TradeRunner<'_> {
    /// The results of an earlier run with the same fingerprint, if there are any.
    pub(super) fn finished(
        &self,
        folder: &Path,
        fingerprint: &Fingerprint,
    ) -> Result<Option<TradeRun>, StudyError> {
        if !fingerprint.is_in(&folder.join(MARK)) {
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
        Ok(Some(TradeRun { cost, histories }))
    }

    /// Runs a scene over the window, from the cached body with the key `body` if there is one.
    pub(super) fn run(
        &mut self,
        scene: Scene,
        body: &str,
        watch: &mut dyn TradeWatch,
    ) -> Result<TradeRun, StudyError> {
        let started = Instant::now();
        let model = CostModel::of(&scene)?;
        let mut simulation = scene.with_duration(self.window).prepare()?;
        let step = simulation.step()?;
        let composed = started.elapsed().as_secs_f64();
        let equilibrated = match self.bodies.get(body) {
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
                    self.bodies.store(body, found.clone());
                }
                found
            }
        };
        // The cost includes the stages, even where their result came from the cache.
        let before = composed + equilibrated.as_ref().map_or(0.0, |found| found.took);
        let clock = Arc::new(Mutex::new(StepTimes::default()));
        let (times, mut hook) = (clock.clone(), watch.progress());
        let mut hooks = RunHooks::default().with_progress(move |progress| {
            let now = Some((Instant::now(), progress.done));
            let mut clock = times.lock().unwrap_or_else(PoisonError::into_inner);
            clock.first = clock.first.or(now);
            clock.last = now;
            if let Some(hook) = &mut hook {
                hook(progress);
            }
        });
        hooks.stop = self.stop.cloned();
        hooks.equilibrated_body = equilibrated.map(|found| found.body);
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
        Ok(TradeRun {
            cost: CaseCost {
                step,
                time_of_step,
                before,
                steps,
                memory: model.memory(steps),
            },
            histories: columns(&results.histories),
        })
    }

    /// Writes the results of a run, its fingerprint last.
    pub(super) fn store(
        &self,
        folder: &Path,
        fingerprint: &Fingerprint,
        finished: &TradeRun,
    ) -> Result<(), StudyError> {
        let write = || -> Result<(), powerhouse::io::IoError> {
            write_summary(&folder.join(COST), &finished.cost)?;
            write_table(&folder.join(HISTORIES), &finished.histories)?;
            write_summary(&folder.join(MARK), fingerprint)
        };
        std::fs::create_dir_all(folder).map_err(|source| StudyError::Read {
            file: folder.into(),
            source,
        })?;
        Ok(write().map_err(powerhouse::Error::from)?)
    }
}

/// The columns of a table of histories, after that of time.
pub(crate) fn columns(table: &HistoryTable) -> Vec<TableColumn> {
    let mut columns = vec![TableColumn::new("time", "s", table.times.clone())];
    let others = table.columns.iter();
    columns.extend(others.map(|c| TableColumn::new(c.name.clone(), c.unit, c.values.clone())));
    columns
}
