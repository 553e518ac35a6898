//! The command `powerhouse`: run and check scenes, drive points of their materials.
//!
//! Exit status: 0 if all is well, 1 if a check warns, advice finds nothing or a report lacks something, 2 if
//! something is refused or fails, 130 if a run was interrupted, by Ctrl-C, SIGTERM or SIGHUP (its output is
//! complete up to there). A reader of the output that goes away changes neither files nor status.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod advise;
mod check;
mod drive;
mod mesh;
mod page;
mod progress;
mod report;
mod run;
mod stop;
mod sweep;
mod terminal;
mod trade;

use std::io::IsTerminal;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use powerhouse::{Error, Scene};
use powerhouse_study::StudyError;
use terminal::{say, warn_aside};

/// Explicit dynamic analysis of underground structures under waves that arrive at an angle.
#[derive(Parser)]
#[command(
    version,
    after_help = EXIT_STATUS
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scene and write its results.
    #[command(after_help = AFTER_A_KILL)]
    Run {
        /// The scene file.
        scene: PathBuf,
        /// The folder for results, in place of the scene's own.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// The case of the scene, in place of the scene itself.
        #[arg(long, value_name = "NAME")]
        case: Option<String>,
    },
    /// Tell what a run of a scene would be, without running it.
    Check {
        /// The scene file.
        scene: PathBuf,
        /// Compute the scene's box without the structure and compare it with the field that comes
        /// in.
        #[arg(long)]
        free_field: bool,
        /// The case of the scene, in place of the scene itself.
        #[arg(long, value_name = "NAME")]
        case: Option<String>,
    },
    /// Say which choice a scene needs for a stated error.
    Advise {
        #[command(subcommand)]
        choice: Choice,
    },
    /// Lead one point of a material along a path of strain and stress.
    Drive {
        /// A file with a `[[material]]` table, such as a scene.
        law: PathBuf,
        /// The file of the path.
        path: PathBuf,
        /// The material's name, where the file has several.
        #[arg(long, value_name = "NAME")]
        material: Option<String>,
        /// The folder for `point.csv` and `point.svg`; `results/` and the path's name by default.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Make the mesh of a machine bay and write it for Gmsh and ParaView.
    Mesh {
        /// The file of the bay: its size and dimensions.
        bay: PathBuf,
        /// The Gmsh file, beside which a VTU file and a picture come; by default the bay's name in the
        /// working directory.
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Run the cases of a scene, one after the other or side by side; cases that are finished are not run
    /// again.
    Sweep {
        /// The scene file with its `[[case]]` tables.
        scene: PathBuf,
        /// The folder for results, in place of the scene's own; each case has a folder in it.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Run only this case, or these: the option may stand several times.
        #[arg(long = "case", value_name = "NAME")]
        cases: Vec<String>,
        /// The duration of every case (s), in place of the scene's.
        #[arg(long, value_name = "SECONDS", value_parser = seconds)]
        duration: Option<f64>,
        /// How many cases run at once, each with its share of the cores and the memory of one.
        #[arg(long, value_name = "CASES", default_value = "1")]
        jobs: NonZeroUsize,
    },
    /// Find what accuracy costs a scene: run a window of it over kernels, precisions, steps, boundaries
    /// and what else it leaves to choose, and write the scene of the choice that meets a goal.
    Trade(trade::Wishes),
    /// Write one HTML page of the results of a sweep or a run; of a sweep, print what its cases say to the
    /// conclusions of Wang, Chen & Xiao (2019) and what single choices do.
    Report {
        /// The folder of the results.
        folder: PathBuf,
    },
    /// Print the JSON schema of scene files, for editors.
    Schema,
}

#[derive(Subcommand)]
enum Choice {
    /// The cheapest absorbing boundary, with its predicted error and cost, and the table for the scene.
    Boundary {
        /// The scene file.
        scene: PathBuf,
        /// The permitted error: of displacement and velocity, over the run, at the worst place.
        #[arg(long, value_name = "SHARE", default_value = "5%", value_parser = advise::share)]
        error: f64,
        /// The case of the scene, in place of the scene itself.
        #[arg(long, value_name = "NAME")]
        case: Option<String>,
    },
    /// How near the absorbing faces may come, with the predicted error, and the key for the scene.
    Box {
        /// The scene file.
        scene: PathBuf,
        /// The permitted error: of displacement and velocity, over the run, at the worst place.
        #[arg(long, value_name = "SHARE", default_value = "5%", value_parser = advise::share)]
        error: f64,
        /// The case of the scene, in place of the scene itself.
        #[arg(long, value_name = "NAME")]
        case: Option<String>,
    },
}

/// What the exit status says, as `--help` shows it.
const EXIT_STATUS: &str = "\
Exit status:
  0    all is well; also if the reader of the output has gone away, as in `powerhouse run ... | head -1`
  1    a check warns, advice finds nothing, a trade finds no run that meets the goal, or a report lacks results
  2    refused or failed; `check`, `advise` and `schema` also if what they print cannot be written (full disk)
  130  interrupted by Ctrl-C, SIGTERM or SIGHUP: output is complete up to there; a second signal ends at once";

/// What a kill leaves behind, as `run --help` shows it.
const AFTER_A_KILL: &str = "\
Files are written whole or not at all. Snapshots and stages are written as they come, everything else when the
run ends: of a run that is killed (SIGKILL, power failure) snapshots and stages stay, without histories, section
forces, energies, envelopes and pictures, and there is no summary.json that says `completed`. A run cannot go on from
there; a sweep keeps its finished cases. Interrupt a run (Ctrl-C, SIGTERM) to have all files up to there.";

/// What a command ends with.
type Outcome = Result<ExitCode, Box<dyn std::error::Error>>;

/// The exit status of a check that warns.
const WARNED: u8 = 1;
/// The exit status of what is refused or fails.
const FAILED: u8 = 2;
/// The exit status of an interrupted run.
const INTERRUPTED: u8 = 130;

fn main() -> ExitCode {
    let command = Arguments::parse().command;
    let only_prints = matches!(
        command,
        Command::Check { .. } | Command::Advise { .. } | Command::Schema
    );
    let outcome = match command {
        Command::Run { scene, out, case } => run::run(&scene, case.as_deref(), out),
        Command::Check {
            scene,
            free_field: false,
            case,
        } => check::check(&scene, case.as_deref()),
        Command::Check {
            scene,
            free_field: true,
            case,
        } => check::free_field(&scene, case.as_deref()),
        Command::Advise {
            choice: Choice::Boundary { scene, error, case },
        } => advise::boundary(&scene, case.as_deref(), error),
        Command::Advise {
            choice: Choice::Box { scene, error, case },
        } => advise::ground(&scene, case.as_deref(), error),
        Command::Drive {
            law,
            path,
            material,
            out,
        } => drive::drive(&law, &path, material.as_deref(), out),
        Command::Sweep {
            scene,
            out,
            cases,
            duration,
            jobs,
        } => sweep::sweep(&scene, out, &cases, duration, jobs),
        Command::Trade(wishes) => trade::trade(wishes),
        Command::Report { folder } => page::page(&folder),
        Command::Mesh { bay, out } => mesh::mesh(&bay, out),
        Command::Schema => {
            say!("{:#}", powerhouse_study::registry().schema().to_value());
            Ok(ExitCode::SUCCESS)
        }
    };
    let status = outcome.unwrap_or_else(|error| {
        warn_aside!("{}", explain(error.as_ref()));
        ExitCode::from(FAILED)
    });
    terminal::settle(status, only_prints)
}

/// A time that can be run: finite and above zero.
fn seconds(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && seconds > 0.0 => Ok(seconds),
        _ => Err("a time in seconds, finite and above 0, such as 2.5".into()),
    }
}

/// Reads a scene, or a case of it.
fn read(path: &Path, case: Option<&str>) -> Result<Scene, Error> {
    let registry = powerhouse_study::registry();
    match case {
        Some(case) => Scene::case_from_file_with(path, case, &registry),
        None => Scene::from_file_with(path, &registry),
    }
}

/// A fault of a scene file with the lines that it points at, any other error in one line.
fn explain(error: &(dyn std::error::Error + 'static)) -> String {
    let own = match error.downcast_ref::<StudyError>() {
        Some(StudyError::Scene(error)) => Some(error),
        _ => error.downcast_ref::<Error>(),
    };
    match own {
        Some(Error::Scene(fault)) => fault.render(std::io::stderr().is_terminal()),
        _ => format!("error: {error}"),
    }
}
