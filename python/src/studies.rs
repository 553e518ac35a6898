//! Studies of scene files: sweeps over their cases, and trades of error against cost.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use powerhouse::model::Progress;
use powerhouse::{CheckpointInterval, ProgressHook, Registry, Remark, RunNotes};
use powerhouse_study::sweep::{CaseOutcome, Sweep, SweepWatch};
use powerhouse_study::trade::{
    Goal, MeshError, Quantity, Reference, SensitiveHistory, Trade as Study, TradeCase, TradeReport,
    TradeWatch,
};
use powerhouse_study::{CheckpointEvent, StudyError};
use powerhouse_wang_2019::Comparison;
use pyo3::prelude::*;

use crate::alarm::Alarm;
use crate::fault::{exception, of_study, text_of, with};
use crate::waiting::wait_with;

/// Steps done and planned, and the time (s).
type Now = (u64, u64, f64);

/// What a study has said since it was last looked at, and the runs that go on.
#[derive(Default)]
struct Said {
    lines: Vec<String>,
    running: BTreeMap<String, Now>,
}

/// What a study says, for the thread that waits.
#[derive(Clone, Default)]
struct News(Arc<Mutex<Said>>);

impl News {
    fn locked(&self) -> MutexGuard<'_, Said> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
    fn say(&self, line: String) {
        self.locked().lines.push(line);
    }
    /// A hook that keeps the progress of a run under its name.
    fn hook(&self, name: &str) -> ProgressHook<'static> {
        let (news, name) = (self.clone(), name.to_owned());
        Box::new(move |now: Progress| {
            let now = (now.done, now.planned, now.time);
            news.locked().running.insert(name.clone(), now);
        })
    }
    fn ended(&self, name: &str) {
        self.locked().running.remove(name);
    }
    /// Calls a function of Python with the new lines and the progress of the runs.
    fn report(&self, py: Python<'_>, callback: Option<&Py<PyAny>>) -> PyResult<()> {
        let (lines, running) = {
            let mut news = self.locked();
            (core::mem::take(&mut news.lines), news.running.clone())
        };
        match callback {
            Some(callback) => callback.call1(py, (lines, running)).map(drop),
            None => Ok(()),
        }
    }
}

impl SweepWatch for News {
    fn begins(&mut self, case: &str, number: usize, of: usize) {
        self.say(format!("case {number} of {of}: {case}"));
    }
    fn reused(&mut self, case: &str) {
        self.say(format!("  {case}: finished before"));
    }
    fn warns(&mut self, case: &str, notes: &RunNotes, lock: Option<&str>) {
        if let Some(remark) = lock {
            self.say(format!("  {case}: {remark}"));
        }
        let remarks = notes.remarks.iter().filter(|remark| remark.is_warning());
        for warning in remarks.map(Remark::message).chain(notes.warnings.clone()) {
            self.say(format!("  {case}: warning: {}", warning.text));
        }
    }
    fn self_check(&mut self, case: &str, error: f64) {
        self.say(format!(
            "  {case}: relative error {error:.4} of the free field"
        ));
    }
    fn checkpoint(&mut self, case: &str, event: CheckpointEvent) {
        self.say(format!("  {case}: {event}"));
    }
    fn equilibrated(&mut self, case: &str, took: Duration) {
        self.say(format!("  {case}: stages took {:.1} s", took.as_secs_f64()));
    }
    fn progress(&mut self, case: &str) -> Option<ProgressHook<'static>> {
        Some(self.hook(case))
    }
    fn ends(&mut self, outcome: &CaseOutcome) {
        self.ended(&outcome.name);
        let CaseOutcome {
            name,
            steps,
            step,
            wall_time,
            ..
        } = outcome;
        self.say(format!(
            "  {name}: {steps} steps of {step:.4e} s in {wall_time:.1} s"
        ));
    }
    fn fails(&mut self, case: &str, error: &StudyError) {
        self.ended(case);
        self.say(format!("  {case}: {error}"));
    }
}

impl TradeWatch for News {
    fn before(&mut self, runs: usize, window: f64, at_most: Duration) {
        let all = at_most.as_secs_f64();
        self.say(format!(
            "at most {runs} runs of {window} s, together at most {all:.1} s without stages"
        ));
    }
    fn begins(&mut self, name: &str, number: usize) {
        self.say(format!("run {number}: {name}"));
    }
    fn reused(&mut self, _name: &str) {
        self.say("  finished before".into());
    }
    fn checkpoint(&mut self, _name: &str, event: CheckpointEvent) {
        self.say(format!("  {event}"));
    }
    fn progress(&mut self) -> Option<ProgressHook<'static>> {
        Some(self.hook("run"))
    }
    fn sensitive_histories(&mut self, sensitive: &[SensitiveHistory]) {
        for other in sensitive {
            let (name, change) = (&other.history, 100.0 * other.change);
            self.say(format!(
                "  excluded for sensitive dependence on the input: {name} {change:.2} %"
            ));
        }
    }
    fn fails(&mut self, _name: &str, error: &StudyError) {
        self.say(format!("  {error}"));
    }
    fn ends(&mut self, case: &TradeCase) {
        let (error, worst, whole) = (case.error, &case.worst, case.cost.wall_time());
        self.say(format!(
            "  error {error:.2e} ({worst}), whole run {whole:.1} s"
        ));
    }
    fn mesh_error(&mut self, mesh: &MeshError) {
        let (error, worst) = (mesh.error, &mesh.worst);
        self.say(format!(
            "  estimated error of the mesh {error:.2e} ({worst})"
        ));
    }
}

/// Outcome of a study on another thread.
///
/// # Errors
/// The exception of the study, of a signal or of the callback.
fn made<T: Send>(
    py: Python<'_>,
    alarm: &Arc<Alarm>,
    callback: Option<&Py<PyAny>>,
    work: impl FnOnce(&mut News) -> Result<T, StudyError> + Send,
    interrupted: &str,
) -> PyResult<T> {
    let news = News::default();
    let mut of_work = news.clone();
    let look = |py: Python<'_>| news.report(py, callback);
    let stop = || alarm.stop.store(true, Ordering::Relaxed);
    let (outcome, raised) = wait_with(py, move || work(&mut of_work), look, stop);
    if let Some(error) = alarm.take() {
        return Err(error);
    }
    match (outcome, raised) {
        (Ok(found), None) => {
            news.report(py, callback)?;
            Ok(found)
        }
        (Ok(_), Some(error)) => Err(error),
        (Err(StudyError::Interrupted), Some(error))
            if !error.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) =>
        {
            Err(error)
        }
        (Err(StudyError::Interrupted), _) => {
            let error = exception(py, "Interrupted", interrupted);
            Err(with(py, error, "results", py.None()))
        }
        (Err(error), _) => Err(of_study(py, &error)),
    }
}

/// Arguments of a sweep.
pub(crate) struct SweepOrder {
    pub(crate) folder: Option<PathBuf>,
    pub(crate) cases: Option<Vec<String>>,
    pub(crate) duration: Option<f64>,
    pub(crate) jobs: NonZeroUsize,
    pub(crate) checkpoint_every: Option<CheckpointInterval>,
}

/// Runs the cases of a scene file; returns the folder of the results and the names of the cases.
///
/// # Errors
/// The exception of the first case that fails.
pub(crate) fn sweep(
    py: Python<'_>,
    (path, registry): (PathBuf, Registry),
    order: SweepOrder,
    alarm: &Arc<Alarm>,
    callback: Option<&Py<PyAny>>,
) -> PyResult<(String, Vec<String>)> {
    let work = |news: &mut News| {
        let mut sweep = Sweep::of_file_with(path, order.folder, &registry)?;
        if let Some(cases) = &order.cases {
            sweep = sweep.only(cases)?;
        }
        if let Some(duration) = order.duration {
            sweep = sweep.with_duration(duration)?;
        }
        if let Some(interval) = order.checkpoint_every {
            sweep = sweep.with_checkpoint_interval(interval);
        }
        let sweep = sweep.side_by_side(order.jobs);
        sweep.run(Some(&alarm.stop), news)?;
        Ok((text_of(sweep.folder()), sweep.cases().to_vec()))
    };
    let interrupted = "interrupted: finished cases and checkpoints of the others are kept, and another sweep continues from there";
    made(py, alarm, callback, work, interrupted)
}

/// Arguments of a trade study.
pub(crate) struct TradeOrder {
    pub(crate) folder: Option<PathBuf>,
    pub(crate) goal: Goal,
    pub(crate) reference: Reference,
    pub(crate) window: Option<f64>,
    pub(crate) quantities: Option<Vec<Quantity>>,
    pub(crate) factors: Option<Vec<String>>,
    /// Whether all histories count, every combination is run, and the error of the mesh is estimated.
    pub(crate) every_history: bool,
    pub(crate) every_combination: bool,
    pub(crate) mesh: bool,
    pub(crate) checkpoint_every: Option<CheckpointInterval>,
}

impl TradeOrder {
    /// A goal from a permitted error (1) or a permitted wall time (s).
    pub(crate) fn goal(error: Option<f64>, budget: Option<f64>) -> Result<Goal, String> {
        let positive = |name: &str, value: f64| {
            if value.is_finite() && value > 0.0 {
                Ok(value)
            } else {
                Err(format!("{name}: found {value}, expected a number above 0"))
            }
        };
        match (error, budget) {
            (Some(_), Some(_)) => Err("error and budget: expected one of them".into()),
            (Some(error), None) => positive("error", error).map(Goal::Error),
            (None, Some(budget)) => positive("budget", budget).map(Goal::Budget),
            (None, None) => Ok(Goal::Front),
        }
    }
    /// A reference by its name.
    pub(crate) fn reference(name: &str) -> Result<Reference, String> {
        match name {
            "finest" => Ok(Reference::Finest),
            "closed-form" => Ok(Reference::ClosedForm),
            _ => Err(format!(
                "there is no reference '{name}'; available: finest, closed-form"
            )),
        }
    }
    /// A quantity by its name.
    pub(crate) fn quantity(name: &str) -> Result<Quantity, String> {
        let mut all = Quantity::ALL.into_iter();
        all.find(|known| known.keyword() == name).ok_or_else(|| {
            let names = Quantity::ALL.map(Quantity::keyword).join(", ");
            format!("there is no quantity '{name}'; available: {names}")
        })
    }
    fn study(self, path: PathBuf, registry: &Registry) -> Result<Study, StudyError> {
        let mut study = Study::of_file_with(path, self.folder, registry)?;
        study = study.with_reference(self.reference);
        if let Some(interval) = self.checkpoint_every {
            study = study.with_checkpoint_interval(interval);
        }
        if let Some(window) = self.window {
            study = study.window(window);
        }
        if let Some(quantities) = &self.quantities {
            study = study.comparing(quantities)?;
        }
        if let Some(factors) = &self.factors {
            study = study.only(factors)?;
        }
        if self.every_combination {
            study = study.exhaustive();
        }
        if self.every_history {
            study = study.with_every_history();
        }
        if self.mesh {
            study = study.with_mesh_error();
        }
        Ok(study)
    }
}

/// Run of a trade study: name, levels, step (s), wall time of a step and before the first (s), steps, memory (bytes), wall
/// time (s), error (1), history with this error.
type Row = (
    String,
    Vec<String>,
    f64,
    f64,
    f64,
    u64,
    u64,
    f64,
    f64,
    String,
);

/// Results of a trade study.
#[pyclass(frozen, get_all, module = "powerhouse_fe._core")]
pub(crate) struct Trade {
    /// Folder of the results.
    folder: String,
    /// Names of the factors.
    factors: Vec<String>,
    /// Finished runs, the reference first.
    cases: Vec<Row>,
    /// Histories that depend sensitively on the input, with their changes (1).
    sensitive: Vec<(String, f64)>,
    /// Names of the runs that failed, with the messages.
    failed: Vec<(String, String)>,
    /// Estimated error of the reference (1).
    reference_error: Option<f64>,
    /// Estimated error of the mesh (1), and the history that has it.
    mesh_error: Option<(f64, String)>,
    /// Duration of the runs (s), if later yielding may increase the errors.
    partial_window: Option<f64>,
    /// Indices of the runs on the Pareto front, the cheapest first.
    front: Vec<usize>,
    /// Index of the run that meets the goal.
    chosen: Option<usize>,
    /// Paths of the written files.
    files: Vec<String>,
}

impl Trade {
    fn new(folder: String, report: TradeReport) -> Self {
        let name =
            |(factor, level): (usize, &usize)| report.factors[factor].levels[*level].name.clone();
        let row = |case: &TradeCase| {
            let cost = &case.cost;
            (
                case.name.clone(),
                case.levels.iter().enumerate().map(name).collect(),
                cost.step,
                cost.time_of_step,
                cost.before,
                cost.steps,
                cost.memory,
                cost.wall_time(),
                case.error,
                case.worst.clone(),
            )
        };
        let sensitive = report.sensitive.iter();
        Self {
            folder,
            factors: report.factors.iter().map(|f| f.name.to_owned()).collect(),
            cases: report.cases.iter().map(row).collect(),
            sensitive: sensitive.map(|s| (s.history.clone(), s.change)).collect(),
            reference_error: report.reference_error,
            mesh_error: report.mesh.map(|mesh| (mesh.error, mesh.worst)),
            partial_window: report.partial_window,
            chosen: report.chosen,
            files: report.files.iter().map(|file| text_of(file)).collect(),
            front: report.front,
            failed: report.failed,
        }
    }
}

/// Makes the trade study of a scene file.
///
/// # Errors
/// The exception of the study.
pub(crate) fn trade(
    py: Python<'_>,
    (path, registry): (PathBuf, Registry),
    order: TradeOrder,
    alarm: &Arc<Alarm>,
    callback: Option<&Py<PyAny>>,
) -> PyResult<Trade> {
    let goal = order.goal;
    let work = |news: &mut News| {
        let mut study = order.study(path, &registry)?;
        for factor in study.factors() {
            let names: Vec<&str> = factor.levels.iter().map(|l| l.name.as_str()).collect();
            news.say(format!("{}: {}", factor.name, names.join(" | ")));
        }
        let report = study.run(goal, Some(&alarm.stop), news)?;
        Ok((text_of(study.folder()), report))
    };
    let interrupted = "interrupted: finished runs and the checkpoint of the last are kept, and another trade study continues from there";
    let (folder, report) = made(py, alarm, callback, work, interrupted)?;
    Ok(Trade::new(folder, report))
}

/// Writes the report of a folder with results; returns its path.
#[pyfunction]
pub(crate) fn write_report(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    let written = py.detach(|| powerhouse_report::write_report_with(&folder, &[&Comparison]));
    match written {
        Ok(file) => Ok(text_of(&file)),
        Err(error) => Err(of_study(py, &error)),
    }
}
