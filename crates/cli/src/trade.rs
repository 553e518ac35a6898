//! `powerhouse trade`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::{Args, ValueEnum};
use powerhouse::{CheckpointInterval, ProgressHook};
use powerhouse_study::trade::{
    Goal, MeshError, Quantity, Reference, SensitiveHistory, Trade, TradeCase, TradeReport,
    TradeWatch,
};
use powerhouse_study::{CheckpointEvent, StudyError};

use crate::advise::number;
use crate::progress::Display;
use crate::terminal::say;
use crate::{INTERRUPTED, Outcome, WARNED, stop};

/// Arguments of `powerhouse trade`.
#[derive(Args)]
pub(crate) struct TradeArguments {
    /// Scene file.
    scene: PathBuf,
    /// Reference of the errors.
    #[arg(long, value_enum, default_value_t = ReferenceArgument::Finest)]
    reference: ReferenceArgument,
    /// Permitted wall time of a whole run, such as 2min: the scene of the most accurate combination is written.
    #[arg(long, value_name = "TIME", value_parser = budget, conflicts_with = "error")]
    budget: Option<f64>,
    /// Permitted relative error, such as 1%: the scene of the cheapest combination is written.
    #[arg(long, value_name = "SHARE", value_parser = error)]
    error: Option<f64>,
    /// Duration of the runs (s); by default they contain half of the intensity of the records.
    #[arg(long, value_name = "SECONDS", value_parser = crate::seconds)]
    window: Option<f64>,
    /// Quantities whose errors count, such as displacement,relative; by default all that the scene records.
    #[arg(long = "of", value_name = "QUANTITY", value_parser = quantity, value_delimiter = ',')]
    quantities: Vec<Quantity>,
    /// Count all histories. By default histories that change by more than half of the permitted error under waves of
    /// 1 + 1e-6 times the amplitude are excluded and named, since they depend sensitively on the input.
    #[arg(long)]
    every_history: bool,
    /// Factors that are varied, such as kernel,precision; the others keep the scene's own level.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    factors: Vec<String>,
    /// Run every combination of all levels, in place of the most promising ones.
    #[arg(long)]
    every_combination: bool,
    /// Also run the reference with elements of half the size, which estimates the error of the mesh and takes sixteen
    /// times as long.
    #[arg(long)]
    mesh: bool,
    /// Folder of the results, in place of `trade` in the scene's own.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Wall time between two checkpoints of a run, such as 30s, 10min or 1h, in place of the scene's; `never` writes none
    /// but that of an interruption. Ten minutes by default.
    #[arg(long, value_name = "TIME")]
    checkpoint_every: Option<CheckpointInterval>,
}

impl TradeArguments {
    fn goal(&self) -> Goal {
        match (self.error, self.budget) {
            (Some(error), _) => Goal::Error(error),
            (None, Some(budget)) => Goal::Budget(budget),
            (None, None) => Goal::Front,
        }
    }

    fn trade(self) -> Result<Trade, StudyError> {
        let reference = match self.reference {
            ReferenceArgument::Finest => Reference::Finest,
            ReferenceArgument::ClosedForm => Reference::ClosedForm,
        };
        let registry = powerhouse_wang_2019::registry();
        let trade = Trade::of_file_with(&self.scene, self.out, &registry)?;
        let mut trade = trade.with_reference(reference);
        if let Some(interval) = self.checkpoint_every {
            trade = trade.with_checkpoint_interval(interval);
        }
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

/// Reference of the errors of a trade study.
#[derive(Clone, Copy, ValueEnum)]
enum ReferenceArgument {
    /// The most accurate run.
    Finest,
    /// The incident field, for ground without a structure.
    ClosedForm,
}

/// Progress output of a trade study on the terminal.
struct TradeOutput {
    display: Option<Display>,
}

impl TradeOutput {
    /// Removes the progress display of a run.
    fn clear(&mut self) {
        if let Some(display) = self.display.take() {
            display.clear();
        }
    }
}

impl TradeWatch for TradeOutput {
    fn before(&mut self, runs: usize, window: f64, at_most: Duration) {
        say!(
            "at most {runs} runs of {window} s, together at most {} without stages",
            time(at_most.as_secs_f64())
        );
    }
    fn begins(&mut self, name: &str, number: usize) {
        self.clear();
        say!("run {number}: {name}");
    }
    fn reused(&mut self, _name: &str) {
        say!("  finished before");
    }
    fn checkpoint(&mut self, _name: &str, event: CheckpointEvent) {
        self.clear();
        say!("  {event}");
    }
    fn progress(&mut self) -> Option<ProgressHook<'static>> {
        let display = Display::new("run");
        let hook = display.hook();
        self.display = Some(display);
        Some(hook)
    }
    fn sensitive_histories(&mut self, sensitive: &[SensitiveHistory]) {
        self.clear();
        match sensitive {
            [] => say!("  no history depends sensitively on the input"),
            several => say!("  {}", excluded(several)),
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
    fn mesh_error(&mut self, mesh: &MeshError) {
        self.clear();
        say!(
            "  estimated error of the mesh {:.2e} ({})",
            mesh.error,
            mesh.worst
        );
    }
}

/// The line on the excluded histories, with the reason.
fn excluded(sensitive: &[SensitiveHistory]) -> String {
    let named = sensitive
        .iter()
        .map(|other| format!("{} {:.2} %", other.history, 100.0 * other.change));
    format!(
        "excluded for sensitive dependence on the input, with their changes under waves of 1 + 1e-6 times the amplitude: {}",
        named.collect::<Vec<String>>().join(", ")
    )
}

/// A duration (s) as text in a suitable unit.
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

/// Reads the name of a quantity.
fn quantity(text: &str) -> Result<Quantity, String> {
    let known = Quantity::ALL
        .into_iter()
        .find(|known| known.keyword() == text);
    known.ok_or_else(|| format!("one of {}", Quantity::ALL.map(Quantity::keyword).join(", ")))
}

/// Reads a relative error, such as `2%` or `0.02`.
fn error(text: &str) -> Result<f64, String> {
    let error = number(text).filter(|error| error.is_finite() && *error > 0.0);
    error.ok_or_else(|| "an error such as 2% or 0.02".into())
}

fn positive(number: &str, scale: f64) -> Option<f64> {
    let value = scale * number.trim().parse::<f64>().ok()?;
    (value.is_finite() && value > 0.0).then_some(value)
}

/// Runs the trade study of a scene; the exit status is 1 if no run meets the goal.
pub(crate) fn trade(arguments: TradeArguments) -> Outcome {
    let goal = arguments.goal();
    let mut trade = arguments.trade()?;
    for factor in trade.factors() {
        let names: Vec<&str> = factor
            .levels
            .iter()
            .map(|level| level.name.as_str())
            .collect();
        say!("{}: {}", factor.name, names.join(" | "));
    }
    let mut output = TradeOutput { display: None };
    let found = trade.run(goal, Some(&stop::flag()?), &mut output);
    output.clear();
    match found {
        Ok(report) => {
            print(&report);
            Ok(if goal != Goal::Front && report.chosen.is_none() {
                say!("no run meets the goal");
                ExitCode::from(WARNED)
            } else {
                ExitCode::SUCCESS
            })
        }
        Err(StudyError::Interrupted) => {
            say!(
                "interrupted: finished runs and the checkpoint of the last are kept, and another trade study continues from there"
            );
            Ok(ExitCode::from(INTERRUPTED))
        }
        Err(error) => Err(error.into()),
    }
}

/// Prints the results of a trade study.
fn print(report: &TradeReport) {
    say!("\nPareto front, the cheapest first");
    for &index in &report.front {
        let case = &report.cases[index];
        say!(
            "  {:>9}  error {:.2e}  {:5.0} MB  {}",
            time(case.cost.wall_time()),
            case.error,
            case.cost.memory as f64 / 1e6,
            case.name
        );
    }
    match report.reference_error {
        Some(error) => say!("error of the reference {error:.1e}, without that of the mesh"),
        None => say!("error of the reference unknown: no other time step was run"),
    }
    if let Some(mesh) = &report.mesh {
        say!(
            "estimated error of the mesh {:.1e} ({})",
            mesh.error,
            mesh.worst
        );
    }
    if !report.sensitive.is_empty() {
        say!("{}", excluded(&report.sensitive));
    }
    if let Some(window) = report.partial_window {
        say!(
            "errors are those of the first {window} s: later yielding, cracking or slip may increase them"
        );
    }
    if let Some(case) = report.chosen.map(|index| &report.cases[index]) {
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

    /// Budgets and errors are read with their units; other text is an error.
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
