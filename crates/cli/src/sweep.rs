//! `powerhouse sweep`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use powerhouse::{ProgressHook, StageSink};
use powerhouse_study::StudyError;
use powerhouse_study::sweep::{CaseOutcome, Peak, Sweep, SweepWatch};

use crate::progress::Display;
use crate::run::Stages;
use crate::{INTERRUPTED, Outcome, stop};

/// Tells on the terminal how a sweep goes.
struct Told {
    display: Option<Display>,
}

impl SweepWatch for Told {
    fn begins(&mut self, case: &str, place: usize, of: usize) {
        println!("case {place} of {of}: {case}");
    }
    fn kept(&mut self, _case: &str) {
        println!("  finished before");
    }
    fn at_rest(&mut self, _case: &str, took: Duration) {
        println!("  stages took {:.1} s", took.as_secs_f64());
    }
    fn progress(&mut self, _case: &str) -> Option<ProgressHook<'static>> {
        let display = Display::new("run");
        let hook = display.hook();
        self.display = Some(display);
        Some(hook)
    }
    fn stages(&mut self, files: Box<dyn StageSink>) -> Box<dyn StageSink> {
        Box::new(Stages(files))
    }
    fn ends(&mut self, outcome: &CaseOutcome) {
        if let Some(display) = self.display.take() {
            display.clear();
        }
        println!(
            "  {} steps of {:.4e} s in {:.1} s",
            outcome.steps, outcome.step, outcome.wall_time
        );
        line("principal stress", &outcome.stresses, 1e-6, "MPa");
        line("relative displacement", &outcome.relative, 1e3, "mm");
        for damage in &outcome.damage {
            println!(
                "  {}: at most {:.3} in element {}, above 0.1 in {} of {} elements",
                damage.name, damage.greatest, damage.element, damage.damaged, damage.of
            );
        }
        for joint in &outcome.joints {
            println!(
                "  joint {}: slipped {:.1} %, opened {:.1} %, bond broken {:.1} % of {:.0} m2",
                joint.name,
                100.0 * joint.slipped,
                100.0 * joint.opened,
                100.0 * joint.broken,
                joint.area
            );
        }
    }
}

/// Peaks in a line.
fn line(what: &str, peaks: &[Peak], scale: f64, unit: &str) {
    let peaks = peaks.iter();
    let peaks: Vec<String> = peaks
        .map(|peak| format!("{} {:.3}", peak.name, scale * peak.value))
        .collect();
    if !peaks.is_empty() {
        println!("  {what} ({unit}): {}", peaks.join(", "));
    }
}

/// Runs the cases of a scene.
pub(crate) fn sweep(
    scene: &Path,
    out: Option<PathBuf>,
    cases: &[String],
    duration: Option<f64>,
) -> Outcome {
    let mut sweep = Sweep::of_file(scene, out)?;
    if !cases.is_empty() {
        sweep = sweep.only(cases)?;
    }
    if let Some(duration) = duration {
        sweep = sweep.lasting(duration)?;
    }
    let started = Instant::now();
    let mut told = Told { display: None };
    let done = sweep.run(Some(&stop::flag()?), &mut told);
    if let Some(display) = told.display.take() {
        display.clear();
    }
    match done {
        Ok(outcomes) => {
            println!(
                "{} cases in {:.1} s; results in {}",
                outcomes.len(),
                started.elapsed().as_secs_f64(),
                sweep.folder().display()
            );
            Ok(ExitCode::SUCCESS)
        }
        Err(StudyError::Interrupted) => {
            println!("interrupted: what is finished stays, another sweep goes on from there");
            Ok(ExitCode::from(INTERRUPTED))
        }
        Err(error) => Err(error.into()),
    }
}
