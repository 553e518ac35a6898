//! Convergence studies: the results of a scene on two or three meshes, extrapolated to vanishing element size.
//!
//! A [`Convergence`] runs a scene on its own mesh and on finer ones, refined or from other files, with the time step that
//! each mesh permits. Each peak, spectral value, mean and share is reported with its values, the observed order of
//! convergence, the extrapolated value and an error band.
//!
//! ```no_run
//! use powerhouse_study::convergence::Convergence;
//! use powerhouse_study::sweep::NoProgress;
//! let study = Convergence::of_file("data/scenes/cavern_small.toml", None, None)?;
//! let report = study.run(None, &mut NoProgress)?;
//! for figure in &report.figures {
//!     println!("{}: {:?}", figure.name, figure.estimate);
//! }
//! # Ok::<(), powerhouse_study::StudyError>(())
//! ```
//!
//! # Why so
//! *Mesh and time step are refined together*, since a stable step is proportional to the element size: the estimate includes
//! the error of the integration in time. It does not include that of the absorbing boundary, which a larger box shows, nor
//! that of the geometry where a refined mesh keeps the chords of curved walls.
//!
//! *Peaks and spectra are compared, not samples.* Where cracking, yielding or slip amplify a change of the waves by a millionth,
//! samples of two runs differ by as much as the motion itself, and peaks and spectra by less.
//!
//! *All meshes but the finest are run again under waves larger by 1e-6* where laws or joints have history variables: the
//! change of a result, its scatter, limits its error band. The finest mesh costs sixteen times the next and is
//! assumed to scatter no more.
//!
//! *The formal order is 2 for motions in scenes without history variables and 1 for all other results*: stresses are element
//! means, and a front of yielding, cracking or slip advances from element to element.

mod estimate;
mod figures;
mod report;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use powerhouse::model::{Mesh, ParameterError};
use powerhouse::{CheckpointInterval, FileScene, Registry, SceneFile, SceneSpec};

use crate::StudyError;
use crate::cost::StepTimer;
use crate::perturbation::{PERTURBATION, enlarge_waves, is_path_dependent};
use crate::sweep::{Sweep, SweepWatch};
use crate::trade::check_same_loads;
pub use estimate::{Estimate, Trend};
use report::RunFigures;
pub use report::read as read_report;
pub use report::{ComparedFigure, ConvergenceReport, MeshLevel};

/// Formal orders of convergence of motions in linear scenes and of all other results.
const FORMAL_ORDERS: [f64; 2] = [2.0, 1.0];
/// Numbers of meshes that are compared.
const MESHES: [usize; 2] = [2, 4];
/// Name of the folder of a study in that of the scene.
const FOLDER: &str = "converge";

/// Convergence study of a scene file.
pub struct Convergence {
    /// The scene, or its case under study.
    spec: SceneSpec,
    registry: Registry,
    folder: PathBuf,
    title: String,
    /// Finer meshes, the coarsest first.
    finer: FinerMeshes,
    duration: Option<f64>,
    perturbed: bool,
    checkpoint_interval: Option<CheckpointInterval>,
}

/// Finer meshes of a study.
#[derive(Clone, Debug)]
enum FinerMeshes {
    /// So many uniform refinements of the scene's mesh.
    Refined(usize),
    /// Files that take the place of the scene's mesh file, relative to the folder of the scene.
    Files(Vec<PathBuf>),
}

/// Run of a study.
struct LevelRun {
    /// The scene as a case with the name of the run.
    spec: SceneSpec,
    /// Index of its mesh.
    mesh: usize,
    perturbed: bool,
}

impl LevelRun {
    fn name(&self) -> &str {
        self.spec.case().unwrap_or_default()
    }
}

/// Runs of a convergence study, whose scene is valid on every mesh.
pub struct PlannedRuns<'a> {
    study: &'a Convergence,
    runs: Vec<LevelRun>,
    levels: Vec<MeshLevel>,
}

impl Convergence {
    /// Creates the convergence study of a scene file or of one of its cases, on the scene's mesh and one uniform refinement;
    /// results are written to a folder, by default `converge` in that of the scene.
    ///
    /// # Errors
    /// An invalid scene or an unknown case.
    pub fn of_file(
        path: impl AsRef<Path>,
        case: Option<&str>,
        folder: Option<PathBuf>,
    ) -> Result<Self, StudyError> {
        Self::of_file_with(path, case, folder, &Registry::default())
    }
    /// The same with the names of a registry.
    ///
    /// # Errors
    /// As [`of_file`](Self::of_file).
    pub fn of_file_with(
        path: impl AsRef<Path>,
        case: Option<&str>,
        folder: Option<PathBuf>,
        registry: &Registry,
    ) -> Result<Self, StudyError> {
        let file = SceneFile::read(path)?;
        let scene = FileScene::of_case(&file, case, registry)?;
        let folder = folder.unwrap_or_else(|| scene.result_folder().join(FOLDER));
        Ok(Self {
            spec: file.spec(case)?,
            registry: registry.clone(),
            folder,
            title: scene.title().to_owned(),
            finer: FinerMeshes::Refined(1),
            duration: None,
            perturbed: is_path_dependent(&scene),
            checkpoint_interval: None,
        })
    }
    /// Sets the number of meshes, 2 to 4: the scene's own and uniform refinements of it. Each takes sixteen times as long as the
    /// one before; three show an order of convergence, two do not.
    ///
    /// # Errors
    /// Another number.
    pub fn with_meshes(mut self, meshes: usize) -> Result<Self, StudyError> {
        let [least, most] = MESHES;
        ParameterError::check("meshes", meshes as f64, least as f64, most as f64)?;
        self.finer = FinerMeshes::Refined(meshes - 1);
        Ok(self)
    }
    /// Sets the files of finer meshes, one to three, the coarsest first, in place of refinements: values of the key `file` of the
    /// scene's mesh, relative to its folder. They must have the sets that the scene names.
    ///
    /// # Errors
    /// Another number of files.
    pub fn with_finer_files(mut self, files: &[PathBuf]) -> Result<Self, StudyError> {
        let [least, most] = MESHES;
        let meshes = (files.len() + 1) as f64;
        ParameterError::check("meshes", meshes, least as f64, most as f64)?;
        self.finer = FinerMeshes::Files(files.to_vec());
        Ok(self)
    }
    /// Sets the duration (s) of all runs, above zero and finite, in place of that of the scene.
    ///
    /// # Errors
    /// A duration out of its range.
    pub fn with_duration(mut self, duration: f64) -> Result<Self, StudyError> {
        ParameterError::check("duration", duration, f64::MIN_POSITIVE, f64::MAX)?;
        self.duration = Some(duration);
        Ok(self)
    }
    /// Leaves out the runs under perturbed waves; the scatter of results is then unknown.
    #[must_use]
    pub fn without_perturbation(mut self) -> Self {
        self.perturbed = false;
        self
    }
    /// Sets the wall time between two checkpoints of a run, in place of that of the scene.
    #[must_use]
    pub fn with_checkpoint_interval(mut self, interval: CheckpointInterval) -> Self {
        self.checkpoint_interval = Some(interval);
        self
    }
    /// Folder of the results, in which each run has a folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Plans the runs: reads and checks the scene on every mesh, which for the finest takes time of its own.
    ///
    /// # Errors
    /// A scene that is invalid on one of the meshes; [`StudyError::MoreLoad`]; [`StudyError::NotFiner`].
    pub fn plan(&self) -> Result<PlannedRuns<'_>, StudyError> {
        let runs = self.runs();
        let levels = self.levels(&runs)?;
        Ok(PlannedRuns {
            study: self,
            runs,
            levels,
        })
    }

    /// Plans the runs and [runs](PlannedRuns::run) them.
    ///
    /// # Errors
    /// As [`plan`](Self::plan) and [`PlannedRuns::run`].
    pub fn run(
        &self,
        stop: Option<&Arc<AtomicBool>>,
        watch: &mut dyn SweepWatch,
    ) -> Result<ConvergenceReport, StudyError> {
        self.plan()?.run(stop, watch)
    }

    /// The runs of the study: all meshes from the coarsest, each followed by its perturbed run if there is one.
    fn runs(&self) -> Vec<LevelRun> {
        let own = self.spec.mesh.refine.as_deref().copied().unwrap_or(0);
        let count = match &self.finer {
            FinerMeshes::Refined(count) => *count,
            FinerMeshes::Files(files) => files.len(),
        };
        let mut runs = Vec::new();
        for level in 0..=count {
            let mut spec = self.spec.clone();
            match &self.finer {
                FinerMeshes::Refined(_) if level > 0 => {
                    **spec.mesh.refine.get_or_insert_default() = own + level as u32;
                }
                FinerMeshes::Files(files) if level > 0 => {
                    (*spec.mesh.file).clone_from(&files[level - 1]);
                }
                _ => {}
            }
            let name = format!("mesh-{}", level + 1);
            spec.set_case(&name, (level > 0).then(|| "mesh".to_owned()));
            let mut again = spec.clone();
            runs.push(LevelRun {
                spec,
                mesh: level,
                perturbed: false,
            });
            let is_repeated = self.perturbed && level < count;
            if is_repeated && enlarge_waves(&mut again, PERTURBATION) > 0 {
                let varies = Some("waves larger by 1e-6".to_owned());
                again.set_case(format!("{name}-perturbed"), varies);
                runs.push(LevelRun {
                    spec: again,
                    mesh: level,
                    perturbed: true,
                });
            }
        }
        runs
    }

    fn scene(&self, run: &LevelRun) -> Result<FileScene, StudyError> {
        Ok(FileScene::from_spec(run.spec.clone(), &self.registry)?)
    }

    /// The meshes of the runs.
    ///
    /// # Errors
    /// A scene that is invalid on one of them; [`StudyError::MoreLoad`]; [`StudyError::NotFiner`].
    fn levels(&self, runs: &[LevelRun]) -> Result<Vec<MeshLevel>, StudyError> {
        let plain = runs.iter().filter(|run| !run.perturbed);
        let mut levels: Vec<MeshLevel> = Vec::new();
        let mut coarsest: Option<FileScene> = None;
        for run in plain {
            let scene = self.scene(run)?;
            let mesh = scene.mesh();
            let level = MeshLevel {
                case: run.name().to_owned(),
                elements: mesh.element_count(),
                size: mean_size(mesh),
            };
            if let Some(coarser) = levels.last().filter(|coarser| level.size >= coarser.size) {
                return Err(StudyError::NotFiner {
                    mesh: level.case,
                    size: level.size,
                    coarser: coarser.size,
                });
            }
            levels.push(level);
            match &coarsest {
                Some(coarsest) => check_same_loads(&self.spec, coarsest, &scene)?,
                None => coarsest = Some(scene),
            }
        }
        Ok(levels)
    }
}

impl PlannedRuns<'_> {
    /// Predicts the wall time of all runs without stages, from the measured time of a step on the scene's own mesh: it
    /// grows with the number of elements and with that of steps.
    ///
    /// # Errors
    /// A step that cannot be computed.
    pub fn predicted_time(&self) -> Result<Duration, StudyError> {
        let first = &self.levels[0];
        let scene = self.study.scene(&self.runs[0])?;
        let duration = self.study.duration.unwrap_or(scene.duration());
        let scene = scene.map(|scene| scene.with_duration(duration));
        let mut simulation = scene.prepare()?;
        let steps = duration / simulation.step()?;
        let of_one = StepTimer::of(&mut simulation)?
            .time_of_step()?
            .mul_f64(steps);
        let ratio = |run: &LevelRun| {
            let own = &self.levels[run.mesh];
            own.elements as f64 / first.elements as f64 * first.size / own.size
        };
        Ok(of_one.mul_f64(self.runs.iter().map(ratio).sum()))
    }

    /// Runs the scene on all meshes and compares the results. Finished runs of an earlier study are reused, and unfinished ones go
    /// on from their last checkpoint.
    ///
    /// `stop` is the cancellation flag.
    ///
    /// # Errors
    /// A run that fails; [`StudyError::Interrupted`] after a cancellation.
    pub fn run(
        self,
        stop: Option<&Arc<AtomicBool>>,
        watch: &mut dyn SweepWatch,
    ) -> Result<ConvergenceReport, StudyError> {
        let Self {
            study,
            runs,
            levels,
        } = self;
        let scene = study.scene(&runs[0])?;
        let not_compared = figures::not_compared(&scene);
        let is_linear = !is_path_dependent(&scene);
        let specs = runs.iter().map(|run| run.spec.clone()).collect();
        let mut sweep = Sweep::of_variants(&scene, specs, study.folder.clone())?;
        drop(scene);
        if let Some(duration) = study.duration {
            sweep = sweep.with_duration(duration)?;
        }
        if let Some(interval) = study.checkpoint_interval {
            sweep = sweep.with_checkpoint_interval(interval);
        }
        sweep.run(stop, watch)?;
        let results =
            |run: &LevelRun| figures::figures(&study.folder.join(run.name()), &not_compared);
        let (again, plain): (Vec<&LevelRun>, Vec<&LevelRun>) =
            runs.iter().partition(|run| run.perturbed);
        let plain: Vec<_> = plain.into_iter().map(results).collect::<Result<_, _>>()?;
        let perturbed = again.into_iter().map(|run| Ok((run.mesh, results(run)?)));
        let perturbed: Vec<_> = perturbed.collect::<Result<_, StudyError>>()?;
        let figures = RunFigures {
            plain: &plain,
            perturbed: &perturbed,
        };
        let mut report = ConvergenceReport {
            title: study.title.clone(),
            scatter_unknown: !is_linear && perturbed.is_empty(),
            keeps_chords: matches!(study.finer, FinerMeshes::Refined(_)),
            figures: report::compare(&levels, &figures, is_linear),
            meshes: levels,
            files: Vec::new(),
        };
        report.write(&study.folder)?;
        Ok(report)
    }
}

/// The edge of a cube with the mean volume of the solid elements (m).
fn mean_size(mesh: &Mesh) -> f64 {
    let volumes = (0..mesh.element_count() as u32).map(|element| mesh.volume(element));
    let solid: Vec<f64> = volumes.filter(|volume| *volume > 0.0).collect();
    (solid.iter().sum::<f64>() / solid.len().max(1) as f64).cbrt()
}
