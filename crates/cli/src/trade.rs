//! `powerhouse trade`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::{Args, ValueEnum};
use powerhouse::ProgressHook;
use powerhouse_study::StudyError;
use powerhouse_study::trade::{
    Goal, MeshError, Quantity, Reference, Trade, TradeCase, TradeReport, TradeWatch, Unrepeated,
};

use crate::progress::Display;
use crate::terminal::say;
use crate::{INTERRUPTED, Outcome, WARNED, stop};

/// What is wished of a trade.
#[derive(Args)]
pub(crate) struct Wishes {
    /// The scene file.
    scene: PathBuf,
    /// What errors are measured against.
    #[arg(long, value_enum, default_value_t = Against::Finest)]
    reference: Against,
    /// The wall time that a whole run may take, such as 2min: the most accurate choice is written.
    #[arg(long, value_name = "TIME", value_parser = budget, conflicts_with = "error")]
    budget: Option<f64>,
    /// The relative error that is permitted, such as 1%: the cheapest choice is written.
    #[arg(long, value_name = "SHARE", value_parser = error)]
    error: Option<f64>,
    /// The first seconds that are run, in place of those until half of the records has come.
    #[arg(long, value_name = "SECONDS", value_parser = crate::seconds)]
    window: Option<f64>,
    /// The histories whose errors count, such as displacement,relative; all that the scene records by default.
    #[arg(long = "of", value_name = "QUANTITY", value_parser = quantity, value_delimiter = ',')]
    quantities: Vec<Quantity>,
    /// Count all of these histories. By default those are left out, and named, that waves larger by a
    /// millionth change by half of the error that is asked for: no choice repeats them.
    #[arg(long)]
    every_history: bool,
    /// The factors that are left to choose, such as kernel,precision; the scene decides on the others.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    factors: Vec<String>,
    /// Run every combination of all levels, in place of those that promise most.
    #[arg(long)]
    every_combination: bool,
    /// Also run the reference on elements half the size, which tells the error of the mesh and takes sixteen
    /// times as long.
    #[arg(long)]
    mesh: bool,
    /// The folder for results, in place of `trade` in the scene's own.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Wishes {
    fn goal(&self) -> Goal {
        match (self.error, self.budget) {
            (Some(error), _) => Goal::Error(error),
            (None, Some(budget)) => Goal::Budget(budget),
            (None, None) => Goal::Front,
        }
    }

    fn trade(self) -> Result<Trade, StudyError> {
        let reference = match self.reference {
            Against::Finest => Reference::Finest,
            Against::ClosedForm => Reference::ClosedForm,
        };
        let mut trade = Trade::of_file(&self.scene, self.out)?.against(reference);
        if let Some(window) = self.window {
            trade = trade.window(window);
        }
        if !self.quantities.is_empty() {
            trade = trade.comparing(&self.quantities)?;
        }
        if !self.factors.is_empty() {
            trade = trade.only(&self.factors)?;
        }
        if self.every_combination {
            trade = trade.exhaustive();
        }
        if self.every_history {
            trade = trade.with_every_history();
        }
        if self.mesh {
            trade = trade.with_mesh_error();
        }
        Ok(trade)
    }
}

/// What the errors of a trade are measured against.
#[derive(Clone, Copy, ValueEnum)]
enum Against {
    /// The most accurate of the runs.
    Finest,
    /// The field that comes in: for ground without a structure.
    ClosedForm,
}

/// Tells on the terminal how a trade goes.
struct Told {
    display: Option<Display>,
}

impl Told {
    /// Takes away what shows the progress of a run.
    fn clear(&mut self) {
        if let Some(display) = self.display.take() {
            display.clear();
        }
    }
}

impl TradeWatch for Told {
    fn before(&mut self, runs: usize, window: f64, at_most: Duration) {
        say!(
            "at most {runs} runs of {window} s, {} in all, stages aside",
            time(at_most.as_secs_f64())
        );
    }
    fn begins(&mut self, name: &str, place: usize) {
        self.clear();
        say!("run {place}: {name}");
    }
    fn kept(&mut self, _name: &str) {
        say!("  finished before");
    }
    fn progress(&mut self) -> Option<ProgressHook<'static>> {
        let display = Display::new("run");
        let hook = display.hook();
        self.display = Some(display);
        Some(hook)
    }
    fn sets_aside(&mut self, unrepeated: &[Unrepeated]) {
        self.clear();
        match unrepeated {
            [] => say!("  repeats all histories"),
            several => say!("  {}", left_out(several)),
        }
    }
    fn fails(&mut self, _name: &str, error: &StudyError) {
        self.clear();
        say!("  {error}");
    }
    fn ends(&mut self, case: &TradeCase) {
        self.clear();
        let cost = &case.cost;
        say!(
            "  error {:.2e} ({}), whole run {}: {} steps of {:.3e} s, {:.3e} s each",
            case.error,
            case.worst,
            time(cost.wall_time()),
            cost.steps,
            cost.step,
            cost.time_of_step
        );
    }
    fn tells_mesh(&mut self, mesh: &MeshError) {
        self.clear();
        say!(
            "  the mesh errs by about {:.2e} ({})",
            mesh.error,
            mesh.worst
        );
    }
}

/// Says which histories count nowhere, and why.
fn left_out(unrepeated: &[Unrepeated]) -> String {
    let named = unrepeated
        .iter()
        .map(|other| format!("{} {:.2} %", other.history, 100.0 * other.change));
    format!(
        "left out, since waves larger by a millionth change them so much that no choice repeats them: {}",
        named.collect::<Vec<String>>().join(", ")
    )
}

/// A time (s) in the unit that suits it.
fn time(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{s:.1} s"),
        s if s < 5400.0 => format!("{:.1} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// Reads a time with its unit, such as `90s`, `2min` or `1.5h`; a bare number is in seconds.
fn budget(text: &str) -> Result<f64, String> {
    let units = [("min", 60.0), ("h", 3600.0), ("s", 1.0)];
    let unit = units.iter().find(|(unit, _)| text.ends_with(unit));
    let (number, scale) = unit.map_or((text, 1.0), |(unit, scale)| {
        (text.trim_end_matches(unit), *scale)
    });
    positive(number, scale).ok_or_else(|| "a time such as 90s, 2min or 1.5h".into())
}

/// Reads the name of what histories are of.
fn quantity(text: &str) -> Result<Quantity, String> {
    let known = Quantity::ALL
        .into_iter()
        .find(|known| known.keyword() == text);
    known.ok_or_else(|| format!("one of {}", Quantity::ALL.map(Quantity::keyword).join(", ")))
}

/// Reads an error, such as `2%` or `0.02`.
fn error(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    positive(number, scale).ok_or_else(|| "an error such as 2% or 0.02".into())
}

fn positive(number: &str, scale: f64) -> Option<f64> {
    let value = scale * number.trim().parse::<f64>().ok()?;
    (value.is_finite() && value > 0.0).then_some(value)
}

/// Runs a scene over what it leaves to choose; the exit status is 1 if no run meets the goal.
pub(crate) fn trade(wishes: Wishes) -> Outcome {
    let goal = wishes.goal();
    let mut trade = wishes.trade()?;
    for factor in trade.factors() {
        let names: Vec<&str> = factor
            .levels
            .iter()
            .map(|level| level.name.as_str())
            .collect();
        say!("{}: {}", factor.name, names.join(" | "));
    }
    let mut told = Told { display: None };
    let found = trade.run(goal, Some(&stop::flag()?), &mut told);
    told.clear();
    match found {
        Ok(report) => {
            tell(&report);
            Ok(if goal != Goal::Front && report.chosen.is_none() {
                say!("no run meets what was asked for");
                ExitCode::from(WARNED)
            } else {
                ExitCode::SUCCESS
            })
        }
        Err(StudyError::Interrupted) => {
            say!("interrupted: what is finished stays, another trade goes on from there");
            Ok(ExitCode::from(INTERRUPTED))
        }
        Err(error) => Err(error.into()),
    }
}

fn tell(report: &TradeReport) {
    say!("\nfront, the cheapest first");
    for &place in &report.front {
        let case = &report.cases[place];
        say!(
            "  {:>9}  error {:.2e}  {:5.0} MB  {}",
            time(case.cost.wall_time()),
            case.error,
            case.cost.memory as f64 / 1e6,
            case.name
        );
    }
    match report.reference_error {
        Some(error) => say!("error of the reference {error:.1e}, on this mesh"),
        None => say!("error of the reference unknown: no other step was run"),
    }
    if let Some(mesh) = &report.mesh {
        say!(
            "error of the mesh about {:.1e} ({})",
            mesh.error,
            mesh.worst
        );
    }
    if !report.unrepeated.is_empty() {
        say!("{}", left_out(&report.unrepeated));
    }
    if let Some(window) = report.foreseen {
        say!(
            "errors are those of the first {window} s: what yields, cracks or slips later may err by more"
        );
    }
    if let Some(case) = report.chosen.map(|place| &report.cases[place]) {
        say!("chosen: {}", case.name);
    }
    say!("\nfiles");
    for file in &report.files {
        say!("  {}", file.display());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Budgets and errors are read with their units; what is none is refused.
    #[test]
    fn budgets_and_errors_have_units() {
        assert_eq!(budget("2min"), Ok(120.0));
        assert_eq!(budget("90s"), Ok(90.0));
        assert_eq!(budget("1.5h"), Ok(5400.0));
        assert_eq!(budget("7"), Ok(7.0));
        assert_eq!(error("2%"), Ok(0.02));
        assert_eq!(error("0.02"), Ok(0.02));
        for wrong in ["", "-1s", "nan", "0", "2 weeks"] {
            assert!(budget(wrong).is_err(), "{wrong}");
        }
        assert!(error("all").is_err());
    }
}
