//! Lines of text of reports, as the command prints them.

use core::fmt::Write;
use std::time::Duration;

use powerhouse::engine::StableStep;
use powerhouse::model::{LimitingTerm, StepProfile};
use powerhouse::{Remark, ResumedRun, merge_messages};

/// Appends a line to a text; a `String` takes every line.
macro_rules! line {
    ($out:expr, $($text:tt)*) => { { let _ = writeln!($out, $($text)*); } };
}
pub(crate) use line;

pub use crate::rounded::rounded;

/// Lines of remarks: facts, then warnings, those that differ in a name alone as one line.
pub fn of_remarks<'r>(remarks: impl IntoIterator<Item = &'r Remark>) -> String {
    let mut out = String::new();
    let (warnings, facts): (Vec<&Remark>, Vec<&Remark>) =
        remarks.into_iter().partition(|remark| remark.is_warning());
    for fact in merge_messages(facts.into_iter().map(Remark::message)) {
        line!(out, "{}", fact.text);
    }
    for warning in merge_messages(warnings.into_iter().map(Remark::message)) {
        line!(out, "warning: {}", warning.text);
    }
    out
}

/// Lines of the time step of a run (s) and of the stable step with the element that limits it.
pub fn of_step(stable: &StableStep, step: f64) -> String {
    let mut out = String::new();
    line!(
        out,
        "step {step:.4e} s; stable up to {:.4e} s, limited by the {} of element {} in '{}' ({} elements with a similar limit)",
        stable.step,
        match stable.term {
            LimitingTerm::Stiffness => "size and stiffness",
            term => term.name(),
        },
        stable.element,
        stable.set,
        stable.similar_elements,
    );
    if let Some(next) = stable.next_set_bound {
        line!(
            out,
            "without the limiting elements in '{}' the step could be {:.2} times as long",
            stable.set,
            next / stable.element_bound
        );
    }
    out
}

/// Lines of the shares of the parts of a step; those below a share (%) together.
pub fn of_profile(profile: &StepProfile, least: f64) -> String {
    let mut out = String::new();
    let mut rest = 0.0;
    for row in &profile.rows {
        let share = 100.0 * row.seconds / profile.seconds;
        if share >= least {
            line!(out, "  {share:5.1} %  {}", row.part);
        } else {
            rest += share;
        }
    }
    if rest > 0.0 {
        line!(out, "  {rest:5.1} %  all other parts");
    }
    out
}

/// A duration as text in seconds, minutes or hours.
pub fn duration(time: Duration) -> String {
    match time.as_secs_f64() {
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.1} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// What results of joints depend on after the first of some times (s) at which a pair slid or opened; `None` without one.
pub fn after_first_slip(times: impl IntoIterator<Item = f64>) -> Option<String> {
    let first = times.into_iter().reduce(f64::min)?;
    Some(format!(
        "joints slid or opened from {first:.3} s on: after that small differences of mesh, step and rounding may grow, most of all in slips, openings, accelerations, and moments beside the joint; `powerhouse converge` measures how far"
    ))
}

/// A number of bytes as text.
pub fn bytes(count: u64) -> String {
    match count as f64 {
        b if b < 1e6 => format!("{:.0} kB", b / 1e3),
        b if b < 1e9 => format!("{:.0} MB", b / 1e6),
        b => format!("{:.1} GB", b / 1e9),
    }
}

/// The state from which a run goes on that has left a checkpoint, in words: `from t = ...`.
pub fn start_of(found: &ResumedRun) -> String {
    match (&found.run, &found.body) {
        (Some(run), _) => format!("from t = {:.6} s, after {} steps", run.time, run.done),
        _ if found.solution.is_some() => "within the solution of a stage".into(),
        (None, Some(body)) => {
            let last = body.stages().last().map_or("", |stage| stage.name.as_str());
            format!("after the stage '{last}'")
        }
        (None, None) => "from its start".into(),
    }
}
