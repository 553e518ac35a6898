//! The command `powerhouse`: runs and checks scenes, sweeps and trade studies, and tests materials at a point.
//!
//! Exit status: 0 on success, 1 if a check has warnings, no choice meets a permitted error, a report has gaps or elements have no program, 2 if
//! an input is invalid or a run fails, 130 if a run was interrupted by Ctrl-C, SIGTERM or SIGHUP (its output is complete
//! up to then). A closed standard output changes neither files nor status.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod advise;
mod changes;
mod check;
mod checkpoint;
mod converge;
#[cfg(test)]
mod documents;
mod drive;
mod emit;
mod forecast;
mod look;
mod look_record;
mod manual;
mod mesh;
mod pack;
mod page;
mod picture;
mod plot;
mod progress;
mod ranks;
mod report;
mod run;
mod starter;
mod stop;
mod sweep;
mod terminal;
mod trade;
mod vtkhdf;

use std::io::IsTerminal;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use changes::Changes;
use clap::{Parser, Subcommand};
use powerhouse::{CheckpointInterval, Error, FileScene, RenderFault as _, SceneChoice};
use powerhouse_study::StudyError;
use terminal::{say, warn_aside};

/// Explicit dynamic analysis of underground structures under obliquely incident waves.
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
    /// Write a scene to begin with, a lined tunnel with its mesh, into a folder.
    New {
        /// Folder, which is made.
        folder: PathBuf,
    },
    /// Run a scene and write its results.
    #[command(after_help = AFTER_A_KILL)]
    Run {
        /// Scene file; with `--resume` and `--from` that of the earlier run by default.
        #[arg(required_unless_present_any = ["resume", "from"])]
        scene: Option<PathBuf>,
        /// Folder of the results, in place of the scene's own.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Name of a case, which is run in place of the scene itself.
        #[arg(long, value_name = "NAME")]
        case: Option<String>,
        #[command(flatten)]
        changes: Changes,
        /// Resume the run with these results from its last checkpoint, to the same results as without an interruption.
        #[arg(long, value_name = "DIR", conflicts_with_all = ["out", "case", "set", "duration"])]
        resume: Option<PathBuf>,
        /// Begin anew in a folder where a run of the same scene was interrupted, whose checkpoint is removed.
        #[arg(long, conflicts_with = "resume")]
        restart: bool,
        /// Start from a state that an earlier run has kept (`keep` of `[checkpoint]`), such as results/bay@5.2s: output,
        /// duration and waves after that time may differ from those of the earlier run.
        #[arg(long, value_name = "DIR@TIME", conflicts_with = "resume", value_parser = checkpoint::kept_at)]
        from: Option<checkpoint::KeptAt>,
        /// Wall time between two checkpoints, such as 30s, 10min or 1h, in place of the scene's; `never` writes none but
        /// that of an interruption. Ten minutes by default.
        #[arg(long, value_name = "TIME")]
        checkpoint_every: Option<CheckpointInterval>,
        /// Measure and print the wall time of the parts of time steps: elements by set, law, damping, joints, output.
        #[arg(long)]
        profile: bool,
        /// Number of threads, in place of the scene's; results do not depend on it.
        #[arg(long, value_name = "COUNT")]
        threads: Option<NonZeroUsize>,
        /// Print warnings and errors alone, on the error stream.
        #[arg(long, conflicts_with = "profile")]
        quiet: bool,
        /// File that receives all that is printed, also with `--quiet`; it may replace a file whose name ends with .log.
        #[arg(long, value_name = "FILE")]
        log: Option<PathBuf>,
    },
    /// Check a scene without running it: mesh, resolved frequencies, stable step, predicted cost, warnings.
    Check {
        /// Scene file.
        scene: PathBuf,
        /// Check only the keys and values of the scene file and of its cases, without reading mesh and records.
        #[arg(long, conflicts_with_all = ["free_field", "ranks", "case"])]
        keys: bool,
        /// Run the scene's box without the structure and compare it with the incident field.
        #[arg(long)]
        free_field: bool,
        /// Number of ranks (processes of `mpirun -n RANKS powerhouse run`) whose elements, messages, cost and memory are
        /// predicted.
        #[arg(long, value_name = "RANKS", conflicts_with = "free_field")]
        ranks: Option<NonZeroUsize>,
        /// Name of a case, which is run in place of the scene itself.
        #[arg(long, value_name = "NAME")]
        case: Option<String>,
        #[command(flatten)]
        changes: Changes,
    },
    /// Recommend an absorbing boundary or an extent of the mesh for a permitted error.
    Advise {
        #[command(subcommand)]
        choice: Choice,
    },
    /// Run a material test at a single integration point along a path of strains and stresses.
    Drive {
        /// File with a `[[material]]` table, such as a scene.
        law: PathBuf,
        /// File of the path.
        path: PathBuf,
        /// Name of the material, if the file has several.
        #[arg(long, value_name = "NAME")]
        material: Option<String>,
        /// Folder of `point.csv` and `point.svg`; by default `results/` followed by the name of the path.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Write the arithmetic of a scene's elements, with their laws and its time step, as CUDA C (and WGSL, of single
    /// precision), for other processors.
    Emit {
        /// Scene file.
        scene: PathBuf,
        /// Folder of the sources, which is made.
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        /// Name of a case, which is taken in place of the scene itself.
        #[arg(long, value_name = "NAME")]
        case: Option<String>,
        #[command(flatten)]
        changes: Changes,
    },
    /// Generate the mesh of a machine bay and write it for Gmsh and ParaView.
    Mesh {
        /// File of the bay with its mesh density and dimensions.
        bay: PathBuf,
        /// Gmsh file, beside which a VTU file and a picture are written; by default named after the bay, in the working
        /// directory.
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Write a mesh file (Gmsh, Abaqus) as packed mesh, which is opened without being read, and of which all ranks of a
    /// machine share one copy.
    Pack {
        /// Mesh file.
        mesh: PathBuf,
        /// Packed mesh (`.phm`); by default named after the mesh file, and beside it.
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Print sizes, quality and sets of a mesh file (Gmsh, Abaqus, packed), and draw its element sets; or format,
    /// peaks and durations of a record, and draw its response spectra.
    Look {
        /// Mesh file, or file of a record.
        file: PathBuf,
        /// PNG file of a picture of a mesh, SVG file of the response spectra of a record.
        #[arg(long, value_name = "FILE")]
        picture: Option<PathBuf>,
        /// Order of the elements of a mesh file: 1 reads those of second order by their corners alone.
        #[arg(long, value_name = "ORDER", value_parser = clap::value_parser!(u32).range(1..=2))]
        order: Option<u32>,
        /// Unit of a record whose file does not declare it, such as m/s2, cm/s2 or g.
        #[arg(long)]
        units: Option<String>,
        /// Time step of a record whose file does not declare it (s).
        #[arg(long, value_name = "SECONDS", value_parser = seconds)]
        time_step: Option<f64>,
    },
    /// Run the cases of a scene, sequentially or in parallel; finished cases are not run again, and unfinished ones go on
    /// from their last checkpoint. Several processes with the same folder share the cases.
    Sweep {
        /// Scene file with `[[case]]` tables.
        scene: PathBuf,
        /// Folder of the results, in place of the scene's own, with a folder for each case.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Name of a case to run, in place of all cases; may be repeated.
        #[arg(long = "case", value_name = "NAME")]
        cases: Vec<String>,
        /// Duration of every case (s), in place of the scene's.
        #[arg(long, value_name = "SECONDS", value_parser = seconds)]
        duration: Option<f64>,
        /// Number of cases that run in parallel; the cores are divided among them, and their memory adds up.
        #[arg(long, value_name = "CASES", default_value = "1")]
        jobs: NonZeroUsize,
        /// Number of processes that compute each case together, of those that `mpirun` has started; by default every process
        /// computes cases of its own.
        #[arg(long, value_name = "RANKS", conflicts_with = "jobs")]
        ranks_per_case: Option<NonZeroUsize>,
        /// Wall time between two checkpoints of a running case, such as 30s, 10min or 1h, in place of the scene's; `never`
        /// writes none but that of an interruption. Ten minutes by default.
        #[arg(long, value_name = "TIME")]
        checkpoint_every: Option<CheckpointInterval>,
    },
    /// Measure cost and error of a scene's numerical options: run a window of it with different kernels, number formats,
    /// steps, boundaries and other options, and write the scene of the combination that meets a goal.
    Trade(trade::TradeArguments),
    /// Run a scene on finer meshes, too, and extrapolate its peaks, spectra, means and shares to vanishing element size, with error
    /// bands.
    Converge(converge::ConvergeArguments),
    /// Write an HTML report of a sweep or a run; for a sweep, also print the sensitivity to single parameters, and for one of the
    /// machine bay of Wang, Chen & Xiao (2019) the test of their conclusions.
    Report {
        /// Folder of the results.
        folder: PathBuf,
    },
    /// Draw histories of a finished run, their response or Fourier spectra, or the growth of their Arias intensity; or fields
    /// of its snapshots along a line.
    Plot(plot::PlotArguments),
    /// Draw a field of the snapshots of a finished run, or of a VTU file of it, deformed or moving if wanted.
    Picture(picture::PictureArguments),
    /// Write all snapshots of a finished run as one VTKHDF file, which ParaView 5.12 and later read.
    Vtkhdf {
        /// Folder of the results of a run with [output.snapshots].
        results: PathBuf,
        /// File; by default `snapshots.vtkhdf` in the folder of the results.
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Print the JSON schema of scene files, for editors.
    Schema,
    /// Print the completions of a shell for this command.
    Completions {
        /// Shell.
        shell: clap_complete::Shell,
    },
    /// Write the manual pages of this command and its subcommands.
    Man {
        /// Folder of the pages.
        folder: PathBuf,
    },
}

#[derive(Subcommand)]
enum Choice {
    /// Recommend the cheapest absorbing boundary, with predicted errors and costs and its table for the scene.
    Boundary {
        /// Scene file.
        scene: PathBuf,
        /// Permitted relative error of displacement and velocity over the run, at the worst recorded point.
        #[arg(long, value_name = "SHARE", default_value = "5%", value_parser = advise::share)]
        error: f64,
        /// Name of a case, which is run in place of the scene itself.
        #[arg(long, value_name = "NAME")]
        case: Option<String>,
    },
    /// Recommend the smallest box of ground, with its predicted error and its key for the scene.
    Box {
        /// Scene file.
        scene: PathBuf,
        /// Permitted relative error of displacement and velocity over the run, at the worst recorded point.
        #[arg(long, value_name = "SHARE", default_value = "5%", value_parser = advise::share)]
        error: f64,
        /// Name of a case, which is run in place of the scene itself.
        #[arg(long, value_name = "NAME")]
        case: Option<String>,
    },
}

/// Explanation of the exit status in `--help`.
const EXIT_STATUS: &str = "\
Exit status:
  0    success; also if the standard output was closed, as in `powerhouse run ... | head -1`
  1    a check has warnings, no boundary or box meets the permitted error, no run of a trade study meets the goal, a
       result of a convergence study does not converge or not within the permitted error, a report has missing results, or
       elements have no program to emit
  2    invalid input or failed run; `check`, `advise` and `schema` also if their output cannot be written (full disk)
  130  interrupted by Ctrl-C, SIGTERM or SIGHUP: output is complete up to then; a second signal ends at once";

/// Explanation of the files of a killed run in `run --help`.
const AFTER_A_KILL: &str = "\
Snapshots, stages and checkpoints are written during the run, as are the new rows of the tables every twenty seconds, all
other files at its end, each atomically: a run that is killed (SIGKILL, power failure) leaves those, without envelopes
and pictures, and with a summary.json that states `incomplete`. `powerhouse run --resume DIR`, with the folder
of its results, goes on from the last checkpoint, or from the last completed stage, to the same files. Interrupt a run
(Ctrl-C, SIGTERM) to obtain all files up to then; it can be resumed, too.";

/// Result of a command: its exit status or an error.
type Outcome = Result<ExitCode, Box<dyn std::error::Error>>;

/// Exit status of a check with warnings.
const WARNED: u8 = 1;
/// Exit status of an invalid input or a failed run.
const FAILED: u8 = 2;
/// Exit status of an interrupted run.
const INTERRUPTED: u8 = 130;

fn main() -> ExitCode {
    let command = Arguments::parse().command;
    let only_prints = matches!(
        command,
        Command::Check { .. }
            | Command::Advise { .. }
            | Command::Look { picture: None, .. }
            | Command::Schema
            | Command::Completions { .. }
    );
    let refused = match command {
        // Each process of a sweep takes cases that no other one computes.
        Command::Run { .. } | Command::Sweep { .. } => Ok(()),
        _ => ranks::refuse_processes(),
    };
    if let Err(error) = refused {
        warn_aside!("{}", explain(error.as_ref()));
        return ExitCode::from(FAILED);
    }
    let outcome = match command {
        Command::Run {
            scene,
            out,
            case,
            changes,
            resume,
            restart,
            from,
            checkpoint_every,
            profile,
            threads,
            quiet,
            log,
        } => {
            if let Some(Err(error)) = log.as_deref().map(terminal::log_to) {
                warn_aside!("error: {error}");
                return ExitCode::from(FAILED);
            }
            if quiet {
                terminal::quieten();
            }
            let choice = match (resume, from) {
                (Some(folder), _) => run::Choice::Resume { folder, scene },
                (None, Some(kept)) => run::Choice::From {
                    kept,
                    scene,
                    of_file: changes.of(case),
                    out,
                    restart,
                },
                (None, None) => run::Choice::Start {
                    scene: scene.unwrap_or_default(),
                    of_file: changes.of(case),
                    out,
                    restart,
                },
            };
            ranks::on_all(|place| {
                let options = run::Options {
                    every: checkpoint_every,
                    threads,
                    profile,
                };
                run::run(choice, options, place)
            })
        }
        Command::Check {
            scene,
            keys,
            free_field,
            ranks,
            case,
            changes,
        } => {
            let of_file = changes.of(case);
            match (keys, free_field) {
                (true, _) => check::keys(&scene, &of_file.changes),
                (false, true) => check::free_field(&scene, &of_file),
                (false, false) => check::check(&scene, &of_file, ranks),
            }
        }
        Command::Advise {
            choice: Choice::Boundary { scene, error, case },
        } => advise::boundary(&scene, case, error),
        Command::Advise {
            choice: Choice::Box { scene, error, case },
        } => advise::ground(&scene, case, error),
        Command::Drive {
            law,
            path,
            material,
            out,
        } => drive::drive(&law, &path, material.as_deref(), out),
        Command::Emit {
            scene,
            out,
            case,
            changes,
        } => emit::emit(&scene, &changes.of(case), &out),
        Command::Sweep {
            scene,
            out,
            cases,
            duration,
            jobs,
            ranks_per_case,
            checkpoint_every,
        } => {
            let schedule = sweep::Schedule {
                jobs,
                checkpoint_every,
            };
            ranks::in_groups(ranks_per_case, |place| {
                sweep::sweep(&scene, out, &cases, duration, (schedule, place))
            })
        }
        Command::Trade(arguments) => trade::trade(arguments),
        Command::Converge(arguments) => converge::converge(arguments),
        Command::Plot(arguments) => plot::plot(arguments),
        Command::Picture(arguments) => picture::picture(arguments),
        Command::Vtkhdf { results, out } => vtkhdf::vtkhdf(&results, out),
        Command::Report { folder } => page::page(&folder),
        Command::New { folder } => starter::new(&folder),
        Command::Mesh { bay, out } => mesh::mesh(&bay, out),
        Command::Pack { mesh, out } => pack::pack(&mesh, out),
        Command::Look {
            file,
            picture,
            order,
            units,
            time_step,
        } if look::is_record(&file) => {
            let record = look_record::LookRecord {
                units,
                time_step,
                picture,
            };
            match order {
                None => look_record::look(&file, &record),
                Some(_) => Err("`--order` is about a mesh file, and this is a record".into()),
            }
        }
        Command::Look {
            file,
            picture,
            order,
            units: None,
            time_step: None,
        } => look::look(&file, picture, order == Some(1)),
        Command::Look { .. } => {
            Err("`--units` and `--time-step` are about a record, and this is a mesh file".into())
        }
        Command::Schema => {
            say!("{:#}", powerhouse_wang_2019::registry().schema().to_value());
            Ok(ExitCode::SUCCESS)
        }
        Command::Completions { shell } => manual::completions(shell),
        Command::Man { folder } => manual::pages(&folder),
    };
    let status = outcome.unwrap_or_else(|error| {
        warn_aside!("{}", explain(error.as_ref()));
        ExitCode::from(FAILED)
    });
    terminal::settle(status, only_prints)
}

/// Reads a duration (s), finite and above zero.
fn seconds(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && seconds > 0.0 => Ok(seconds),
        _ => Err("a time in seconds, finite and above 0, such as 2.5".into()),
    }
}

/// Refuses a file for a drawing of a kind whose name has another ending than that of its format.
fn check_ending(file: &Path, (kind, ending): (&str, &str)) -> Result<(), String> {
    if file.extension().is_some_and(|found| found == ending) {
        Ok(())
    } else {
        Err(format!(
            "{}: the name of a {kind} must end with .{ending}",
            file.display()
        ))
    }
}

/// Reads a scene, or a case of it, with changed keys.
fn read(path: &Path, of_file: &SceneChoice) -> Result<FileScene, Error> {
    let scene = FileScene::from_file_as(path, of_file, &powerhouse_wang_2019::registry());
    if matches!(scene, Err(Error::Scene(_))) && !of_file.changes.is_empty() {
        let changes: Vec<String> = of_file.changes.iter().map(ToString::to_string).collect();
        warn_aside!(
            "note: lines are those of the scene with its changed keys: {}",
            changes.join(", ")
        );
    }
    scene
}

/// Reads a scene, or a case of it, as it is in its file.
fn read_case(path: &Path, case: Option<String>) -> Result<FileScene, Error> {
    let changes = Vec::new();
    read(path, &SceneChoice { case, changes })
}

/// The text of an error: for a fault of a scene file with the lines concerned, otherwise in one line.
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
