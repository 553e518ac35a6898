//! `powerhouse sweep`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use indicatif::MultiProgress;
use powerhouse::{CheckpointInterval, Message, ProgressHook, Remark, RunNotes, StageSink};
use powerhouse_study::sweep::{CaseOutcome, Peak, Sweep, SweepWatch};
use powerhouse_study::{CheckpointEvent, StudyError};

use crate::progress::Display;
use crate::ranks::Place;
use crate::run::Stages;
use crate::terminal::say;
use crate::{INTERRUPTED, Outcome, stop};

/// Progress output of a sweep on the terminal.
#[derive(Default)]
pub(crate) struct SweepOutput {
    bars: MultiProgress,
    /// Progress displays by case.
    displays: BTreeMap<String, Display>,
    /// Whether several cases run in parallel, also in other processes on the same terminal.
    several: bool,
    /// Warnings that were printed before.
    warned: BTreeSet<String>,
}

impl SweepOutput {
    /// Prints around the bars.
    fn say(&self, text: &str) {
        self.bars.suspend(|| say!("{text}"));
    }
    /// Prints the warnings of a case that no case before had, and the number of the others.
    fn warn(&mut self, case: &str, warnings: &[Message]) {
        let mut repeated = 0;
        for Message { text, .. } in warnings {
            // Most cases of a sweep have the same warnings.
            if self.warned.insert(text.clone()) {
                self.say(&format!("  {case}: warning: {text}"))
            } else {
                repeated += 1
            }
        }
        if repeated > 0 {
            self.say(&format!(
                "  {case}: {repeated} warning(s) as of cases before"
            ));
        }
    }
    /// Removes all progress bars.
    pub(crate) fn clear_all(&self) {
        self.displays.values().for_each(Display::clear);
    }
    /// Removes the progress bar of a case.
    fn clear(&mut self, case: &str) {
        if let Some(display) = self.displays.remove(case) {
            display.clear();
        }
    }
}

impl SweepWatch for SweepOutput {
    fn begins(&mut self, case: &str, number: usize, of: usize) {
        self.say(&format!("case {number} of {of}: {case}"));
    }
    fn reused(&mut self, case: &str) {
        self.say(&format!("  {case}: finished before"));
    }
    fn replaces(&mut self, case: &str) {
        self.say(&format!(
            "  {case}: its finished results are those of other inputs (scene, files, duration or program), and will be replaced"
        ));
    }
    fn warns(&mut self, case: &str, notes: &RunNotes, lock: Option<&str>) {
        if let Some(remark) = lock {
            self.say(&format!("  {case}: {remark}"));
        }
        let remarks = notes.remarks.iter().filter(|remark| remark.is_warning());
        let warnings = remarks.map(Remark::message).chain(notes.warnings.clone());
        let warnings: Vec<_> = warnings.collect();
        self.warn(case, &warnings);
    }
    fn warns_of_results(&mut self, case: &str, warnings: &[Message]) {
        self.warn(case, warnings);
    }
    fn self_check(&mut self, case: &str, error: f64) {
        self.say(&format!(
            "  {case}: relative error {error:.4} of the free field"
        ));
    }
    fn checkpoint(&mut self, case: &str, event: CheckpointEvent) {
        self.say(&format!("  {case}: {event}"));
    }
    fn equilibrated(&mut self, case: &str, took: Duration) {
        self.say(&format!(
            "  {case}: stages took {:.1} s",
            took.as_secs_f64()
        ));
    }
    fn progress(&mut self, case: &str) -> Option<ProgressHook<'static>> {
        let prefix = if self.several { case } else { "run" };
        let display = Display::among(&self.bars, prefix);
        let hook = display.hook();
        self.displays.insert(case.into(), display);
        Some(hook)
    }
    fn stages(&mut self, case: &str, files: Box<dyn StageSink>) -> Box<dyn StageSink> {
        let prefix = if self.several {
            format!("{case}: ")
        } else {
            String::new()
        };
        Box::new(Stages::new(files, &self.bars, &prefix))
    }
    fn ends(&mut self, outcome: &CaseOutcome) {
        self.clear(&outcome.name);
        self.say(&summary(outcome));
    }
    fn fails(&mut self, case: &str, error: &StudyError) {
        self.clear(case);
        self.say(&format!("  {case}: {error}"));
    }
    fn waits(&mut self, cases: &[&str]) {
        self.say(&format!(
            "waits for cases that other processes compute: {}",
            cases.join(", ")
        ));
    }
    fn waits_for_stages(&mut self, case: &str) {
        self.say(&format!(
            "  {case}: waits for the stages, which another process computes"
        ));
    }
}

/// The summary of an outcome in several lines.
fn summary(outcome: &CaseOutcome) -> String {
    let mut text = format!(
        "  {}: {} steps of {:.4e} s in {:.1} s",
        outcome.name, outcome.steps, outcome.step, outcome.wall_time
    );
    line(
        &mut text,
        &PeakLine {
            heading: "principal stress",
            peaks: &outcome.stresses,
            scale: 1e-6,
            unit: "MPa",
        },
    );
    line(
        &mut text,
        &PeakLine {
            heading: "relative displacement",
            peaks: &outcome.relative,
            scale: 1e3,
            unit: "mm",
        },
    );
    for damage in &outcome.damage {
        let _ = write!(
            text,
            "\n  {}: at most {:.3} in element {}, above 0.1 in {} of {} elements",
            damage.name, damage.greatest, damage.element, damage.damaged, damage.of
        );
    }
    for joint in &outcome.joints {
        let _ = write!(
            text,
            "\n  joint {}: slipped {:.1} %, opened {:.1} %, bond broken {:.1} % of {:.0} m2",
            joint.name,
            100.0 * joint.slipped,
            100.0 * joint.opened,
            100.0 * joint.broken,
            joint.area
        );
    }
    text
}

/// Peaks under a heading, in a unit that is `scale` times the SI unit.
struct PeakLine<'a> {
    heading: &'a str,
    peaks: &'a [Peak],
    scale: f64,
    unit: &'a str,
}

/// Adds peaks in a line.
fn line(text: &mut String, line: &PeakLine) {
    let PeakLine {
        heading,
        scale,
        unit,
        ..
    } = line;
    let peaks: Vec<String> = (line.peaks.iter())
        .map(|peak| format!("{} {:.3}", peak.name, scale * peak.value))
        .collect();
    if !peaks.is_empty() {
        let _ = write!(text, "\n  {heading} ({unit}): {}", peaks.join(", "));
    }
}

/// How the cases of a sweep are run.
pub(crate) struct Schedule {
    /// Number of cases that run in parallel.
    pub(crate) jobs: NonZeroUsize,
    /// Wall time between two checkpoints of a case, in place of the scene's.
    pub(crate) checkpoint_every: Option<CheckpointInterval>,
}

/// Runs the cases of a scene.
pub(crate) fn sweep(
    scene: &Path,
    out: Option<PathBuf>,
    cases: &[String],
    duration: Option<f64>,
    (schedule, place): (Schedule, &Place),
) -> Outcome {
    let mut sweep = Sweep::of_file_with(scene, out, &powerhouse_wang_2019::registry())?;
    if !cases.is_empty() {
        sweep = sweep.only(cases)?;
    }
    if let Some(duration) = duration {
        sweep = sweep.with_duration(duration)?;
    }
    if let Some(interval) = schedule.checkpoint_every {
        sweep = sweep.with_checkpoint_interval(interval);
    }
    sweep = sweep.side_by_side(schedule.jobs);
    if let Some(engine) = place.engine() {
        sweep = sweep.on_ranks(engine.clone());
    }
    let started = Instant::now();
    let mut output = SweepOutput {
        several: schedule.jobs > NonZeroUsize::MIN
            || powerhouse::mpi::processes().is_some_and(|count| count > 1),
        ..SweepOutput::default()
    };
    let done = sweep.run(Some(&stop::flag()?), &mut output);
    output.clear_all();
    match done {
        Ok(outcomes) => {
            if let Some(statistics) = sweep.statistics()? {
                say!("{}", statistics.to_string().trim_end());
            }
            say!(
                "{} cases in {:.1} s; results in {}",
                outcomes.len(),
                started.elapsed().as_secs_f64(),
                sweep.folder().display()
            );
            Ok(ExitCode::SUCCESS)
        }
        Err(StudyError::Interrupted) => {
            say!(
                "interrupted: finished cases and checkpoints of the others are kept, and another sweep continues from there"
            );
            Ok(ExitCode::from(INTERRUPTED))
        }
        Err(error) => Err(error.into()),
    }
}
