//! Parameter sweeps: the runs of all cases of a scene, sequentially or several in parallel.
//!
//! The construction stages before the motion are computed once for all cases that share them, and stored in a file for
//! a later continuation of the sweep. A case that is finished, with the same software version, keys of scene and case,
//! and files, is not run again; the fingerprint of these inputs is written to its folder last. Cases may be added or
//! removed. A case whose results another run has replaced is run again. A case that was interrupted or killed goes on from
//! its last checkpoint, to the same bits.
//!
//! Several processes, on one machine or many, may run the sweep of a scene in the same folder simultaneously: each takes the
//! next case that no other computes, and all return the outcomes of all cases. The locks are those of the operating
//! system, so that a process that is killed hinders no other, on a file system whose locks all machines see.
//!
//! ```no_run
//! use powerhouse_study::sweep::{NoProgress, Sweep};
//! let sweep = Sweep::of_file("scene.toml", None)?;
//! for outcome in sweep.run(None, &mut NoProgress)? {
//!     println!("{}: {} steps", outcome.name, outcome.steps);
//! }
//! # Ok::<(), powerhouse_study::StudyError>(())
//! ```

mod at_rest;
mod case;
mod contact;
mod coverage;
mod damage;
mod entry;
mod ground;
mod input;
mod outcome;
mod pictures;
mod processes;
mod ranks;
mod record_set;
mod sections;
mod spectra;
mod statistics;
mod table;
mod workers;

use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use powerhouse::engine::ExplicitOnRanks;
use powerhouse::io::{TableColumn, write_summary, write_table, write_whole};
use powerhouse::model::ParameterError;
use powerhouse::wavefield::TimeHistory;
use powerhouse::{
    CheckpointFiles, CheckpointInterval, FileScene, Message, ProgressHook, Registry, RunNotes,
    SceneFile, SceneSpec, StageSink,
};

use crate::json::read_json;
use crate::ranks::RunRanks;
use crate::variant::Variant;
use crate::{CheckpointEvent, StudyError, store};
use at_rest::BodyStore;
pub(crate) use case::of_stages;
use case::{CaseControl, Claim};
pub use contact::{JointAndLining, JointCase};
pub use coverage::Coverage;
pub use damage::PartDamage;
pub use entry::CaseEntry;
pub use input::{CaseInput, CaseWave};
pub use outcome::{CaseOutcome, DamageOutcome, Peak};
use processes::SharedFolder;
pub use record_set::STATISTICS;
use record_set::SweepSet;
pub use sections::{SectionExtremes, Utilisation};
pub use spectra::{FitAtPeriod, SetSpectra, SpectrumOfRecord, TargetSpectrum};
pub use statistics::{
    FigureStatistics, FragilityResult, FragilityRun, ScaleStatistics, SectionEnvelope,
    SetStatistics, fractile,
};

/// Name of the outcome file in the folder of a case.
pub const OUTCOME: &str = "outcome.json";
/// Name of the table of all cases in the folder of the sweep.
pub(crate) const TABLE: &str = "sweep.csv";
/// Name of the list of cases in their order, with the fingerprint that each must have.
pub const CASES: &str = "cases.json";

/// Wall time between two looks at what other processes compute.
const LOOK: Duration = Duration::from_secs(1);

/// Prefix of the names of record files.
pub const RECORD: &str = "record-";

/// Progress callbacks of a sweep.
///
/// Calls come from the threads of the cases, one at a time: those of parallel cases are interleaved, and every case waits
/// for their return. The hooks and sinks that they return are called by the thread of their case, without waiting for
/// others. For each case [`begins`](Self::begins) comes first and one of [`reused`](Self::reused), [`ends`](Self::ends) and
/// [`fails`](Self::fails) last.
pub trait SweepWatch: Send {
    /// Called when a case begins, with its name, its number from 1 and the number of cases.
    fn begins(&mut self, _case: &str, _number: usize, _of: usize) {}
    /// Called when the results of an earlier run of a case, or of another process, are reused, so that it is not run.
    fn reused(&mut self, _case: &str) {}
    /// Called before the finished results of a case are replaced that are those of other inputs: another form of the scene or
    /// its files, another duration, or another version of the program.
    fn replaces(&mut self, _case: &str) {}
    /// Called before a case runs, with its remarks and warnings, and a remark on the lock of its folder if there is one.
    fn warns(&mut self, _case: &str, _notes: &RunNotes, _lock: Option<&str>) {}
    /// Called before a case [ends](Self::ends) or fails in its run, with the warnings about its results, of which there may be none.
    fn warns_of_results(&mut self, _case: &str, _warnings: &[Message]) {}
    /// Called after the free-field check of a case, if the scene requests one, with its largest relative error of velocity
    /// (1), also if it is above the limit.
    fn self_check(&mut self, _case: &str, _error: f64) {}
    /// Called when a case goes on from a checkpoint, or one cannot be used or written.
    fn checkpoint(&mut self, _case: &str, _event: CheckpointEvent) {}
    /// Called when the body of a case has reached static equilibrium after its stages, with their wall time; not where the
    /// body of another case or of an earlier sweep is taken.
    fn equilibrated(&mut self, _case: &str, _took: Duration) {}
    /// Returns the progress hook for the time steps of a case, before its dynamic run; `None`, the default, for no
    /// progress.
    fn progress(&mut self, _case: &str) -> Option<ProgressHook<'static>> {
        None
    }
    /// Returns the sink for the stages of a case that are computed; it must forward to `files`, which writes their results
    /// and is returned by default.
    fn stages(&mut self, _case: &str, files: Box<dyn StageSink>) -> Box<dyn StageSink> {
        files
    }
    /// Called when a case has been run and its results are written, with its outcome.
    fn ends(&mut self, _outcome: &CaseOutcome) {}
    /// Called when a case is invalid, fails or is cancelled ([`StudyError::Interrupted`]), while others may still run.
    fn fails(&mut self, _case: &str, _error: &StudyError) {}
    /// Called before this process waits for cases that others compute, which have not [begun](Self::begins) here, since
    /// nothing else is left to it; not again for the same cases.
    fn waits(&mut self, _cases: &[&str]) {}
    /// Called before a case waits for the stages that another process computes.
    fn waits_for_stages(&mut self, _case: &str) {}
}

/// Whether a folder is that of a sweep, of which a case has begun: it has the table or the list of cases.
pub fn is_sweep(folder: impl AsRef<Path>) -> bool {
    [TABLE, CASES]
        .iter()
        .any(|name| folder.as_ref().join(name).is_file())
}

/// Progress callbacks that do nothing.
pub struct NoProgress;

impl SweepWatch for NoProgress {}

/// Parameter sweep over the cases of a scene file.
pub struct Sweep {
    /// The scene file at the beginning of the sweep.
    file: SceneFile,
    /// Whether the cases are those of the file, which must then not be edited while they run.
    in_file: bool,
    registry: Registry,
    /// Cases to run.
    cases: Vec<String>,
    /// All cases of the scene, in their order.
    all: Vec<Variant>,
    folder: PathBuf,
    /// Number of cases that run in parallel.
    at_once: NonZeroUsize,
    /// Wall time between two checkpoints, in place of the scene's.
    checkpoint_interval: Option<CheckpointInterval>,
    ranks: RunRanks,
    /// Records as used by the waves.
    records: Vec<(String, TimeHistory)>,
    /// Set of records, of whose cases statistics are made.
    set: Option<SweepSet>,
}

impl Sweep {
    /// Creates the sweep of a scene file; results are written to a folder, by default that of the scene.
    ///
    /// # Errors
    /// An invalid scene; [`StudyError::NoCases`].
    pub fn of_file(path: impl AsRef<Path>, folder: Option<PathBuf>) -> Result<Self, StudyError> {
        Self::of_file_with(path, folder, &Registry::default())
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
        let file = SceneFile::read(path)?;
        let scene = FileScene::of_case(&file, None, registry)?;
        let own = scene.result_folder();
        let names = scene.case_names().iter();
        let specs = names.map(|name| Ok(file.spec(Some(name))?));
        let specs: Vec<SceneSpec> = specs.collect::<Result<_, StudyError>>()?;
        let mut sweep = Self::of_variants(&scene, specs, folder.unwrap_or(own))?;
        let on_request = scene.cases_on_request();
        sweep.cases.retain(|case| !on_request.contains(case));
        sweep.in_file = true;
        sweep.set = SweepSet::of(&file, registry)?;
        if let Some(set) = &sweep.set {
            sweep.records.retain(|(name, _)| !set.has(name));
            sweep.records.extend(set.histories());
        }
        Ok(sweep)
    }
    /// The sweep of variants of a scene, each with the name of its case.
    ///
    /// # Errors
    /// [`StudyError::NoCases`]; a file of a variant that cannot be read.
    pub(crate) fn of_variants(
        scene: &FileScene,
        specs: Vec<SceneSpec>,
        folder: PathBuf,
    ) -> Result<Self, StudyError> {
        let file = scene
            .spec()
            .map(|spec| spec.file().clone())
            .unwrap_or_default();
        if specs.is_empty() {
            let file = file.path().into();
            return Err(StudyError::NoCases { file });
        }
        let registry = scene.registry().cloned().unwrap_or_default();
        let records = scene.records().iter();
        let records = records.map(|(name, history)| (name.clone(), history.clone()));
        let all = specs.into_iter();
        let all = all.map(|spec| Variant::new(spec, registry.version()));
        let all: Vec<Variant> = all.collect::<Result<_, _>>()?;
        Ok(Self {
            records: records.collect(),
            file,
            in_file: false,
            cases: all
                .iter()
                .map(|variant| variant.name().to_owned())
                .collect(),
            all,
            folder,
            registry,
            at_once: NonZeroUsize::MIN,
            checkpoint_interval: None,
            ranks: RunRanks::default(),
            set: None,
        })
    }

    /// The variant of a case.
    fn variant(&self, case: &str) -> Option<&Variant> {
        self.all.iter().find(|variant| variant.name() == case)
    }
    fn all_names(&self) -> Vec<String> {
        self.all
            .iter()
            .map(|variant| variant.name().to_owned())
            .collect()
    }

    /// Restricts the sweep to the named cases, which may include those that run only on request.
    ///
    /// # Errors
    /// [`StudyError::Scene`] for an unknown case.
    pub fn only(mut self, cases: &[String]) -> Result<Self, StudyError> {
        let available = self.all_names();
        if let Some(name) = cases.iter().find(|name| !available.contains(name)) {
            let name = name.clone();
            return Err(powerhouse::Error::NoSuchCase { name, available }.into());
        }
        let requested = available.into_iter().filter(|case| cases.contains(case));
        self.cases = requested.collect();
        Ok(self)
    }

    /// Sets the duration (s) of every case, above zero and finite, in place of that of the scene.
    ///
    /// # Errors
    /// A duration out of its range; a file of the scene that cannot be read again.
    pub fn with_duration(mut self, duration: f64) -> Result<Self, StudyError> {
        ParameterError::check("duration", duration, f64::MIN_POSITIVE, f64::MAX)?;
        let version = self.registry.version();
        let shortened = |variant: &Variant| variant.with_duration(duration, version);
        self.all = self.all.iter().map(shortened).collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// Sets the number of cases that run in parallel, by default 1.
    ///
    /// The cores are divided among the cases unless the scene sets the number of threads; results do not depend on it
    /// in any bit. The memory of all parallel cases adds up. Cases that share stages wait for the one that computes them.
    #[must_use]
    pub fn side_by_side(mut self, cases: NonZeroUsize) -> Self {
        self.at_once = cases;
        self
    }

    /// Sets the wall time between two checkpoints of a running case, in place of that of the scene's `[checkpoint]`, which
    /// is 10 minutes by default. They are in the folder of the case until it is finished.
    #[must_use]
    pub fn with_checkpoint_interval(mut self, interval: CheckpointInterval) -> Self {
        self.checkpoint_interval = Some(interval);
        self
    }

    /// Computes each case on several ranks together, of which this process is one; every rank makes the same sweep and runs
    /// it. Rank 0 returns the outcomes and writes the files, the others return none. Cases run one after the other.
    #[must_use]
    pub fn on_ranks(mut self, engine: Arc<ExplicitOnRanks>) -> Self {
        self.ranks = RunRanks(Some(engine));
        self
    }

    /// Names of the cases that the sweep runs: all but those on request, or those chosen by [`only`](Self::only).
    pub fn cases(&self) -> &[String] {
        &self.cases
    }
    /// Folder of the results, in which each case has a folder with its name.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Runs all unfinished cases, writes the results of each and a table of all, and returns their outcomes. Of a set of records it
    /// writes the [statistics](Self::statistics), too, also if it is stopped.
    ///
    /// `stop` is the cancellation flag. After an error finished cases are kept, and another run continues from there, inside
    /// unfinished cases from their last checkpoint.
    ///
    /// Cases that another process computes in the same folder are passed over. When no others are left, this one waits
    /// until they are finished, and runs those whose process ended before.
    ///
    /// # Errors
    /// A folder in which a single run writes, or a sweep with other inputs ([`StudyError::OtherSweep`]). The first case that
    /// is invalid or fails, after the parallel ones have ended; [`StudyError::Changed`] if the scene file was edited
    /// meanwhile; [`StudyError::Interrupted`] after a cancellation.
    pub fn run(
        &self,
        stop: Option<&Arc<AtomicBool>>,
        watch: &mut dyn SweepWatch,
    ) -> Result<Vec<CaseOutcome>, StudyError> {
        let shared = SharedFolder::enter(&self.folder, || self.write_inputs())?;
        let bodies = BodyStore::in_folder(&self.folder, &shared);
        let watch = Mutex::new(watch);
        let control = CaseControl {
            stop,
            watch: &watch,
        };
        if !self.ranks.leads() {
            self.follow(&control, &bodies)?;
            shared.leave()?;
            return Ok(Vec::new());
        }
        let found = self.lead(&shared, &control, &bodies);
        // The other ranks of the cases end, too; what is wrong with them concerns no result.
        let ended = self.ranks.begin(None);
        let found = found?;
        ended?;
        shared.leave()?;
        Ok(found)
    }

    /// Runs the cases, together with the other ranks if there are any.
    fn lead(
        &self,
        shared: &SharedFolder,
        control: &CaseControl,
        bodies: &BodyStore,
    ) -> Result<Vec<CaseOutcome>, StudyError> {
        let (stop, watch) = (control.stop, control.watch);
        if !shared.is_alone() {
            let _lock = shared.files()?;
            self.join_cases()?;
        }
        let job = |index: usize| {
            let case = &self.cases[index];
            let claim = self.claim(case);
            if matches!(claim, Ok(Claim::Elsewhere)) {
                return Ok(None);
            }
            locked(watch).begins(case, index + 1, self.cases.len());
            let folder = self.folder.join(case);
            let has_other = |own: &Variant| store::has_other(&folder, own.fingerprint());
            if matches!(claim, Ok(Claim::Own(_))) && self.variant(case).is_some_and(has_other) {
                locked(watch).replaces(case);
            }
            let found = claim.and_then(|claim| match claim {
                Claim::Own(lock) => Ok((self.case((case, &lock), control, bodies)?, false)),
                Claim::Finished | Claim::Elsewhere => {
                    // A sweep that was killed right after the end of the case has left its checkpoints.
                    let _ = CheckpointFiles::of(&folder).remove();
                    Ok((CaseOutcome::read(&folder.join(OUTCOME))?, true))
                }
            });
            let (outcome, reused) = found.map_err(|error| {
                // A case that is invalid leaves no folder.
                let _ = std::fs::remove_dir(&folder);
                locked(watch).fails(case, &error);
                error.in_case(case)
            })?;
            let mut watch = locked(watch);
            if reused {
                watch.reused(case)
            } else {
                watch.ends(&outcome)
            }
            self.write_table(shared)?;
            Ok(Some(outcome))
        };
        let named: Mutex<BTreeSet<usize>> = Mutex::default();
        let waits = |left: &[usize]| {
            let mut named = locked(&named);
            if !left.iter().all(|index| named.contains(index)) {
                let cases: Vec<&str> = left.iter().map(|&index| &*self.cases[index]).collect();
                locked(watch).waits(&cases);
                named.extend(left);
            }
            drop(named);
            processes::pause(LOOK, stop)
        };
        let found = workers::side_by_side(self.cases.len(), self.at_once, job, waits);
        // Of an interrupted sweep, too: they say which cases are missing.
        let counted = self.write_statistics(shared);
        let found = found?;
        counted?;
        // Another process may have written it before the last case was finished.
        self.write_table(shared)?;
        Ok(found)
    }

    /// Whether a case was finished, by this run or an earlier one with the same inputs.
    fn is_finished(&self, case: &str) -> bool {
        let is_finished =
            |own: &Variant| store::is_finished(&self.folder.join(case), own.fingerprint());
        self.variant(case).is_some_and(is_finished)
    }

    /// Writes the table of all finished cases, one process and case at a time.
    fn write_table(&self, shared: &SharedFolder) -> Result<(), StudyError> {
        let _lock = shared.files()?;
        table::write(&self.folder.join(TABLE), &self.finished_outcomes()?)
    }

    /// Outcomes of all finished cases, in the order of the scene.
    fn finished_outcomes(&self) -> Result<Vec<CaseOutcome>, StudyError> {
        let finished = self.all.iter().map(Variant::name);
        let finished = finished.filter(|case| self.is_finished(case));
        let read = |case: &str| CaseOutcome::read(&self.folder.join(case).join(OUTCOME));
        finished.map(read).collect()
    }

    /// Adds the cases of this run to those of other processes in the list of cases.
    ///
    /// # Errors
    /// [`StudyError::OtherSweep`] if those have other inputs.
    fn join_cases(&self) -> Result<(), StudyError> {
        let file = self.folder.join(CASES);
        let others: Vec<CaseEntry> = read_json(&file)?;
        let is_same = |other: &CaseEntry| {
            let own = self.variant(other.name());
            own.is_some_and(|own| other.has(own.fingerprint()))
        };
        if !others.iter().all(is_same) {
            let folder = self.folder.clone();
            return Err(StudyError::OtherSweep { folder });
        }
        let names: Vec<&str> = others.iter().map(CaseEntry::name).collect();
        self.write_cases(&names)
    }

    /// Writes the list of cases: those of this run, those finished earlier, and those of other processes.
    fn write_cases(&self, others: &[&str]) -> Result<(), StudyError> {
        let is_listed = |variant: &&Variant| {
            let case = variant.name();
            let is_chosen = self.cases.iter().any(|chosen| chosen == case);
            is_chosen || others.contains(&case) || self.is_finished(case)
        };
        let cases = self.all.iter().filter(is_listed);
        let entries = cases.map(|case| CaseEntry::new(case.name(), case.fingerprint()));
        let entries: Vec<CaseEntry> = entries.collect();
        let file = self.folder.join(CASES);
        Ok(write_summary(&file, &entries).map_err(powerhouse::Error::from)?)
    }

    /// Writes the list of cases and the records.
    fn write_inputs(&self) -> Result<(), StudyError> {
        self.write_cases(&[])?;
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

/// Locks a mutex; data of a panicked case are used as they are.
fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes a text file atomically.
pub fn write_text(file: &Path, text: &str) -> Result<(), StudyError> {
    Ok(write_whole(file, text.as_bytes()).map_err(powerhouse::Error::from)?)
}
