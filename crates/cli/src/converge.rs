//! `powerhouse converge`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use powerhouse::CheckpointInterval;
use powerhouse_study::StudyError;
use powerhouse_study::convergence::{ComparedFigure, Convergence, ConvergenceReport};

use crate::sweep::SweepOutput;
use crate::terminal::say;
use crate::{INTERRUPTED, Outcome, WARNED, stop};

/// Arguments of `powerhouse converge`.
#[derive(Args)]
pub(crate) struct ConvergeArguments {
    /// Scene file.
    scene: PathBuf,
    /// Name of a case, which is studied in place of the scene itself.
    #[arg(long, value_name = "NAME")]
    case: Option<String>,
    /// Number of meshes, 2 to 4: the scene's own and uniform refinements of it, each of which takes sixteen times as long as
    /// the one before. Three show an order of convergence.
    #[arg(long, value_name = "NUMBER", default_value = "2")]
    meshes: usize,
    /// File of a finer mesh, in place of refinements, as the key `file` of the scene's mesh; may be repeated, from the
    /// coarsest to the finest.
    #[arg(long = "finer", value_name = "FILE", conflicts_with = "meshes")]
    finer: Vec<PathBuf>,
    /// Duration of the runs (s), in place of that of the scene.
    #[arg(long, value_name = "SECONDS", value_parser = crate::seconds)]
    duration: Option<f64>,
    /// Permitted relative error, such as 5%: the exit status is 1 if the error band of a result is wider.
    #[arg(long, value_name = "SHARE", value_parser = crate::advise::share)]
    error: Option<f64>,
    /// Leave out the runs under waves larger by 1e-6, which show the scatter of results.
    #[arg(long)]
    once: bool,
    /// Folder of the results, in place of `converge` in the scene's own.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Wall time between two checkpoints of a run, such as 30s, 10min or 1h, in place of the scene's; `never` writes none
    /// but that of an interruption. Ten minutes by default.
    #[arg(long, value_name = "TIME")]
    checkpoint_every: Option<CheckpointInterval>,
}

impl ConvergeArguments {
    fn study(&self) -> Result<Convergence, StudyError> {
        let registry = powerhouse_wang_2019::registry();
        let mut study = Convergence::of_file_with(
            &self.scene,
            self.case.as_deref(),
            self.out.clone(),
            &registry,
        )?;
        study = if self.finer.is_empty() {
            study.with_meshes(self.meshes)?
        } else {
            study.with_finer_files(&self.finer)?
        };
        if let Some(duration) = self.duration {
            study = study.with_duration(duration)?;
        }
        if let Some(interval) = self.checkpoint_every {
            study = study.with_checkpoint_interval(interval);
        }
        if self.once {
            study = study.without_perturbation();
        }
        Ok(study)
    }
}

/// Runs the convergence study of a scene.
pub(crate) fn converge(arguments: ConvergeArguments) -> Outcome {
    let study = arguments.study()?;
    let planned = study.plan()?;
    let predicted = planned.predicted_time()?;
    say!(
        "all runs together take about {:.0} s without stages",
        predicted.as_secs_f64()
    );
    let mut output = SweepOutput::default();
    let done = planned.run(Some(&stop::flag()?), &mut output);
    output.clear_all();
    let report = match done {
        Ok(report) => report,
        Err(StudyError::Interrupted) => {
            say!(
                "interrupted: finished runs and checkpoints of the others are kept, and another study continues from there"
            );
            return Ok(ExitCode::from(INTERRUPTED));
        }
        Err(error) => return Err(error.into()),
    };
    print(&report);
    Ok(verdict(&report, arguments.error))
}

/// Prints the results that are not negligible.
fn print(report: &ConvergenceReport) {
    for mesh in &report.meshes {
        say!(
            "{}: {} elements of {:.3} m",
            mesh.case,
            mesh.elements,
            mesh.size
        );
    }
    for figure in report.figures.iter().filter(|figure| !figure.negligible) {
        say!("  {}", line(figure));
    }
    let negligible = report.figures.iter().filter(|figure| figure.negligible);
    match negligible.count() {
        0 => {}
        count => say!("  {count} more below a thousandth of the largest of their kind"),
    }
    for limit in report.limits() {
        say!("note: {limit}");
    }
    for file in &report.files {
        say!("wrote {}", file.display());
    }
}

/// A result in one line.
fn line(figure: &ComparedFigure) -> String {
    let unit = match figure.unit.as_str() {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let values: Vec<String> = (figure.values.iter())
        .map(|value| format!("{value:.4e}"))
        .collect();
    let estimate = &figure.estimate;
    let mut text = format!("{}: {}{unit}", figure.name, values.join(", "));
    if let Some(value) = estimate.extrapolated {
        text += &format!("; extrapolated {value:.4e}");
    }
    text += &match figure.relative_band() {
        band if band.is_finite() => format!("; within {:.1} %", 100.0 * band),
        _ => "; error unknown".to_owned(),
    };
    text += &format!(" ({}", estimate.trend.text());
    if let Some(order) = estimate.order {
        text += &format!(", order {order:.1}");
    }
    if let Some(scatter) = figure.scatter.filter(|scatter| *scatter > 0.0) {
        let finest = figure.values.last().copied().unwrap_or(0.0);
        text += &format!(", scatter {:.1e} %", 100.0 * scatter / finest.abs());
    }
    text + ")"
}

/// The exit status, with a sentence on results whose band is wider than permitted, or unknown.
fn verdict(report: &ConvergenceReport, permitted: Option<f64>) -> ExitCode {
    let wide = report.wider_than(permitted.unwrap_or(f64::MAX)).count();
    let all = report.figures.iter().filter(|figure| !figure.negligible);
    let all = all.count();
    if wide == 0 {
        return ExitCode::SUCCESS;
    }
    match permitted {
        Some(share) => say!(
            "{wide} of {all} results have an error band wider than {} %, or none",
            percent(share)
        ),
        None => say!("{wide} of {all} results do not converge on these meshes"),
    }
    ExitCode::from(WARNED)
}

/// A share in percent, without the rounding of a product.
fn percent(share: f64) -> f64 {
    (1e14 * share).round() / 1e12
}
