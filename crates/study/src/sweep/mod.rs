//! Sweeps: the cases of a scene, one after the other or some side by side.
//!
//! The stages before the motion are gone through once for all cases that share them, and kept in a file
//! for a sweep that goes on later. A case that was finished before, by the same version and from the same
//! keys of the scene and of the case and the same files, is not run again: its mark stands in its folder,
//! and goes there last. Other cases may come and go. Results that another run has replaced count no more.
//!
//! ```no_run
//! use powerhouse_study::sweep::{Silent, Sweep};
//! let sweep = Sweep::of_file("data/scenes/wang_2019.toml", None)?;
//! for outcome in sweep.run(None, &mut Silent)? {
//!     println!("{}: {} steps", outcome.name, outcome.steps);
//! }
//! # Ok::<(), powerhouse_study::StudyError>(())
//! ```

mod at_rest;
mod case;
mod contact;
mod coverage;
mod damage;
mod finished;
mod ground;
mod input;
mod outcome;
mod pictures;
mod table;
mod workers;

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use powerhouse::io::{TableColumn, write_summary, write_table, write_whole};
use powerhouse::model::ParameterError;
use powerhouse::wavefield::TimeHistory;
use powerhouse::{ProgressHook, Registry, ResultFolder, RunNotes, Scene, StageSink};

use crate::mark::Mark;
use crate::{StudyError, registry};
use at_rest::Bodies;
use case::CaseControl;
pub use contact::{JointAndLining, JointCase};
pub use coverage::Coverage;
pub use damage::PartDamage;
pub(crate) use finished::Listed;
pub use input::{CaseInput, CaseWave};
pub use outcome::{CaseOutcome, DamageOutcome, Peak};

/// The file of a case's outcome in its folder.
pub(crate) const OUTCOME: &str = "outcome.json";
/// The file of its mark.
pub(crate) const MARK: &str = "finished.json";
/// The table of all cases in the folder of the sweep.
pub(crate) const TABLE: &str = "sweep.csv";
/// The file of the cases in their order, with the mark that each must bear.
pub(crate) const CASES: &str = "cases.json";

/// The start of the names of the files of records.
pub(crate) const RECORD: &str = "record-";

/// Is told how a sweep goes, of cases side by side by turns.
pub trait SweepWatch: Send {
    /// A case begins: its name, its place from 1, how many there are.
    fn begins(&mut self, _case: &str, _place: usize, _of: usize) {}
    /// A case was finished before.
    fn kept(&mut self, _case: &str) {}
    /// What was found of a case before it runs, and of the lock of its folder.
    fn warns(&mut self, _case: &str, _notes: &RunNotes, _lock: Option<&str>) {}
    /// The free field of a case errs by so much: its scene asks for the check.
    fn self_check(&mut self, _case: &str, _error: f64) {}
    /// The body has gone through its stages for this case and those like it.
    fn at_rest(&mut self, _case: &str, _took: Duration) {}
    /// The hook for the steps of a case.
    fn progress(&mut self, _case: &str) -> Option<ProgressHook<'static>> {
        None
    }
    /// What is shown the stages, with the files that they write.
    fn stages(&mut self, _case: &str, files: Box<dyn StageSink>) -> Box<dyn StageSink> {
        files
    }
    /// A case is finished.
    fn ends(&mut self, _outcome: &CaseOutcome) {}
    /// A case is refused or fails, while others may still run.
    fn fails(&mut self, _case: &str, _error: &StudyError) {}
}

/// Hears nothing.
pub struct Silent;

impl SweepWatch for Silent {}

/// The cases of a scene file.
pub struct Sweep {
    scene: PathBuf,
    /// What stood in the file when the sweep began.
    text: String,
    registry: Registry,
    /// Those that it runs.
    cases: Vec<String>,
    /// All that the scene has.
    all: Vec<String>,
    folder: PathBuf,
    /// The mark of each case.
    marks: BTreeMap<String, Mark>,
    duration: Option<f64>,
    /// How many cases run at once.
    at_once: NonZeroUsize,
    /// The records as they enter the waves.
    records: Vec<(String, TimeHistory)>,
}

impl Sweep {
    /// The cases of a scene file; results go to a folder, by default that of the scene.
    ///
    /// # Errors
    /// A scene that cannot be read, [`StudyError::NoCases`].
    pub fn of_file(path: impl AsRef<Path>, folder: Option<PathBuf>) -> Result<Self, StudyError> {
        Self::of_file_with(path, folder, &registry())
    }
    /// The same with the names of a registry. Finished cases of an earlier sweep are taken as they are, also
    /// if the code of a registered law has changed, unless the
    /// [version](powerhouse::Registry::with_version) of the registry has.
    ///
    /// # Errors
    /// As [`of_file`](Self::of_file).
    pub fn of_file_with(
        path: impl AsRef<Path>,
        folder: Option<PathBuf>,
        registry: &Registry,
    ) -> Result<Self, StudyError> {
        let path = path.as_ref();
        let scene = Scene::from_file_with(path, registry)?;
        if scene.case_names().is_empty() {
            let file = path.into();
            return Err(StudyError::NoCases { file });
        }
        let own = scene.result_folder().path().to_path_buf();
        let text = scene.source().map_or("", |source| &source.text);
        let marks = Mark::of_cases((path, text), scene.case_names(), None, registry.version())?;
        let records = scene.records().iter();
        let records = records.map(|(name, history)| (name.clone(), history.clone()));
        Ok(Self {
            records: records.collect(),
            marks,
            text: text.to_owned(),
            scene: path.into(),
            cases: (scene.case_names().iter())
                .filter(|case| !scene.cases_on_request().contains(case))
                .cloned()
                .collect(),
            all: scene.case_names().to_vec(),
            folder: folder.unwrap_or(own),
            registry: registry.clone(),
            duration: None,
            at_once: NonZeroUsize::MIN,
        })
    }

    /// The same with some cases alone, those on request among them.
    ///
    /// # Errors
    /// [`StudyError::Scene`] for a name that is no case.
    pub fn only(mut self, cases: &[String]) -> Result<Self, StudyError> {
        if let Some(name) = cases.iter().find(|name| !self.all.contains(name)) {
            let (name, available) = (name.clone(), self.all);
            return Err(powerhouse::Error::NoSuchCase { name, available }.into());
        }
        let asked = self.all.iter().filter(|case| cases.contains(case));
        self.cases = asked.cloned().collect();
        Ok(self)
    }

    /// The same with another duration of every case (s).
    ///
    /// # Errors
    /// A duration that is not above zero and finite; as [`of_file`](Self::of_file): the files are read again.
    pub fn lasting(mut self, duration: f64) -> Result<Self, StudyError> {
        ParameterError::check("duration", duration, f64::MIN_POSITIVE, f64::MAX)?;
        let file = (self.scene.as_path(), self.text.as_str());
        let version = self.registry.version();
        self.marks = Mark::of_cases(file, &self.all, Some(duration), version)?;
        self.duration = Some(duration);
        Ok(self)
    }

    /// The same with so many cases side by side, each with its share of the cores unless the scene says how
    /// many threads it takes; the bits of results do not depend on it. Each takes the memory of one. Cases that
    /// share stages wait for the one that goes through them.
    #[must_use]
    pub fn side_by_side(mut self, cases: NonZeroUsize) -> Self {
        self.at_once = cases;
        self
    }

    /// The names of the cases that it runs: all but those on request, or those that were asked for.
    pub fn cases(&self) -> &[String] {
        &self.cases
    }
    /// The folder of the results, in which each case has one of its name.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Runs the cases that are not finished yet; writes the results of each, and a table of all.
    ///
    /// # Errors
    /// The first case that is refused or fails, when those beside it are finished;
    /// [`StudyError::Changed`] if the scene's file was edited on the way; [`StudyError::Interrupted`] if
    /// it was stopped from outside. What was finished until then stays, and another run goes on from there.
    pub fn run(
        &self,
        stop: Option<&Arc<AtomicBool>>,
        watch: &mut dyn SweepWatch,
    ) -> Result<Vec<CaseOutcome>, StudyError> {
        let lock = ResultFolder::new(&self.folder).lock()?;
        self.write_inputs()?;
        let bodies = Bodies::in_folder(&self.folder);
        let watch = Mutex::new(watch);
        let control = CaseControl {
            stop,
            watch: &watch,
        };
        let found = workers::side_by_side(self.cases.len(), self.at_once, |place| {
            let case = &self.cases[place];
            locked(&watch).begins(case, place + 1, self.cases.len());
            let folder = self.folder.join(case);
            let kept = self.is_finished(case);
            let outcome = if kept {
                CaseOutcome::read(&folder.join(OUTCOME))?
            } else {
                let found = self.case(case, &control, &bodies);
                found.map_err(|error| {
                    locked(&watch).fails(case, &error);
                    error.in_case(case)
                })?
            };
            let mut watch = locked(&watch);
            match kept {
                true => watch.kept(case),
                false => watch.ends(&outcome),
            }
            // Under the lock, so that two do not write at once.
            self.write_table()?;
            Ok(outcome)
        })?;
        lock.release()?;
        Ok(found)
    }

    /// Whether a case was finished, by this run or an earlier one of the same files.
    fn is_finished(&self, case: &str) -> bool {
        let is_finished = |mark| finished::is_finished(&self.folder.join(case), mark);
        self.marks.get(case).is_some_and(is_finished)
    }

    /// Writes the table of all cases that are finished.
    fn write_table(&self) -> Result<(), StudyError> {
        let finished = self.all.iter().filter(|case| self.is_finished(case));
        let read = |case: &String| CaseOutcome::read(&self.folder.join(case).join(OUTCOME));
        let outcomes: Vec<CaseOutcome> = finished.map(read).collect::<Result<_, _>>()?;
        table::write(&self.folder.join(TABLE), &outcomes)
    }

    /// Writes the order of the cases, those of this run and those that were finished before, and the
    /// records.
    fn write_inputs(&self) -> Result<(), StudyError> {
        let told = |case: &&String| self.cases.contains(case) || self.is_finished(case);
        let cases = self.all.iter().filter(told);
        let listed = cases.filter_map(|case| Some(Listed::new(case, self.marks.get(case)?)));
        let listed: Vec<Listed> = listed.collect();
        let file = self.folder.join(CASES);
        write_summary(&file, &listed).map_err(powerhouse::Error::from)?;
        for (name, history) in &self.records {
            let count = history.samples();
            let times = (0..count).map(|sample| sample as f64 * history.step());
            let columns = [
                TableColumn::new("time", "s", times.collect()),
                TableColumn::new(name.clone(), "m/s2", history.acceleration()),
            ];
            let file = self.folder.join(format!("{RECORD}{name}.csv"));
            write_table(&file, &columns).map_err(powerhouse::Error::from)?;
        }
        Ok(())
    }
}

/// What another case left if it broke off is as good.
fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes a text whole or not at all.
pub(crate) fn write_text(file: &Path, text: &str) -> Result<(), StudyError> {
    Ok(write_whole(file, text.as_bytes()).map_err(powerhouse::Error::from)?)
}
