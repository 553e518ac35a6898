//! Trade studies: cost and error of the numerical options of a scene, measured by running it with them.
//!
//! A [`Trade`] runs a window of a scene with its most accurate options, changes one [`Factor`] at a time, and then runs
//! the most promising combinations. Errors are relative L2 differences of the scene's histories from the finest run, or
//! from the incident field where that is the closed-form solution; the error of the reference itself is estimated. The
//! cost of a whole run is extrapolated from the wall time of its steps.
//!
//! ```no_run
//! use powerhouse_study::trade::{Goal, NoProgress, Trade};
//! let mut trade = Trade::of_file("data/scenes/cavern_small.toml", None)?;
//! let report = trade.run(Goal::Error(0.02), None, &mut NoProgress)?;
//! for &index in &report.front {
//!     let case = &report.cases[index];
//!     println!("{}: {:.1} s, error {:.4}", case.name, case.cost.wall_time(), case.error);
//! }
//! # Ok::<(), powerhouse_study::StudyError>(())
//! ```
//!
//! # Sensitive dependence on the input
//! With cracking, impact or slip the motion of a scene may depend sensitively on its input: two runs that differ only
//! by rounding then diverge completely. The error of such a history does not characterise a numerical option. Where
//! laws or joints have history variables and there are incident waves, the reference is therefore repeated in a
//! perturbation test, under waves of 1 + 1e-6 times the amplitude, far below the accuracy of any record. Histories that change by
//! more than half of the permitted error (by a hundredth without one) are reported with this change and excluded.
//!
//! History variables are measured against at least a tenth of the largest norm of the same variable, since the relative
//! error of an insignificant value is meaningless.
//!
//! # Why so
//! *The mesh is fixed*, or refined once on request. All other options are compared on the same mesh or a part of it;
//! on elements of half the size this would take sixteen times as long. One additional run estimates the error of the
//! mesh itself: motions converge with second order, so that the error is four thirds of the difference. Stresses are
//! element means of first order; they are used if there is no motion. With softening and cracking the order is lower
//! and the error greater; a rim of zero width becomes thinner.
//!
//! *One factor at a time, then few combinations.* Nine factors have thousands of combinations. Their errors come from
//! different sources and are nearly independent, so that single changes predict combinations well enough to choose the
//! next run; only combinations that were run are reported.

mod case;
mod closed_form;
pub(crate) mod factor;
mod finer_mesh;
mod ground;
mod misfit;
mod plan;
mod quantity;
mod repeat;
mod report;
mod window;
mod written;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use powerhouse::engine::StaticError;
use powerhouse::io::TableColumn;
use powerhouse::{CheckpointInterval, FileScene, Registry, SceneFile, SceneSpec};

use crate::mark::inputs;
use crate::perturbation::{PERTURBATION, is_path_dependent};
use crate::price::pareto_front;
use crate::{StudyError, cost};
pub use case::CaseCost;
pub(crate) use case::columns;
use case::{BodyCache, TradeRun, TradeRunner};
pub(crate) use factor::factors;
pub use factor::{Factor, Level};
pub(crate) use finer_mesh::check_same_loads;
use finer_mesh::{OF_HALF_THE_SIZE, REFINED};
pub(crate) use misfit::{Misfit, misfits};
use plan::{Design, ErrorAndCost};
use quantity::Compared;
pub use quantity::Quantity;
use repeat::Perturbed;
pub use report::{
    Goal, MeshError, NoProgress, Reference, SensitiveHistory, TradeCase, TradeReport, TradeWatch,
};
use window::window;

/// Greatest number of combinations that are run beyond single changes.
const MOST_COMBINATIONS: usize = 6;

/// Trade study of cost against error over the numerical options of a scene file.
pub struct Trade {
    path: PathBuf,
    spec: SceneSpec,
    inputs: Vec<Vec<u8>>,
    registry: Registry,
    factors: Vec<Factor>,
    title: String,
    folder: PathBuf,
    duration: f64,
    window: f64,
    /// Whether laws or joints have history variables.
    path_dependent: bool,
    reference: Reference,
    compared: Compared,
    mesh_error: bool,
    exhaustive: bool,
    /// Relative increase of the waves in the perturbation test; `None` if all histories count.
    perturbation: Option<f64>,
    /// Wall time between two checkpoints, in place of the scene's.
    checkpoint_interval: Option<CheckpointInterval>,
}

impl Trade {
    /// Creates the trade study of a scene file; results are written to a folder, by default `trade` in that of the scene.
    ///
    /// # Errors
    /// An invalid scene; [`StudyError::NoHistories`] for a scene without recorded histories.
    pub fn of_file(path: impl AsRef<Path>, folder: Option<PathBuf>) -> Result<Self, StudyError> {
        Self::of_file_with(path, folder, &Registry::default())
    }
    /// The same with the names of a registry: its own kernels of bricks, and boundaries that do without keys, are
    /// levels. Finished runs count until its [version](powerhouse::Registry::with_version) changes.
    ///
    /// # Errors
    /// As [`of_file`](Self::of_file).
    pub fn of_file_with(
        path: impl AsRef<Path>,
        folder: Option<PathBuf>,
        registry: &Registry,
    ) -> Result<Self, StudyError> {
        let path = path.as_ref();
        let file = SceneFile::read(path)?;
        let scene = FileScene::of_case(&file, None, registry)?;
        let spec = file.spec(None)?;
        let compared = Compared::of(&scene);
        if compared.quantities.is_empty() {
            return Err(StudyError::NoHistories);
        }
        let own = scene.result_folder().join("trade");
        let mut factors = factor::factors(&scene, &spec);
        let ground = ground::ground(&scene, &spec, registry);
        let after = [factor::KERNEL, factor::STEP, factor::BOUNDARY];
        let index = factors
            .iter()
            .take_while(|factor| after.contains(&factor.name));
        let index = index.count();
        factors.splice(index..index, ground);
        Ok(Self {
            inputs: inputs(&spec)?,
            factors,
            title: scene.title().to_owned(),
            folder: folder.unwrap_or(own),
            duration: scene.duration(),
            window: window(&scene),
            path_dependent: is_path_dependent(&scene),
            reference: Reference::Finest,
            compared,
            mesh_error: false,
            exhaustive: false,
            perturbation: Some(PERTURBATION),
            checkpoint_interval: None,
            path: path.into(),
            spec,
            registry: registry.clone(),
        })
    }
    /// Sets the window (s), the first part of the scene that is run; at most the duration of the scene, to which longer
    /// ones are cut. By default it contains half of the intensity of the records.
    #[must_use]
    pub fn window(mut self, duration: f64) -> Self {
        self.window = duration.min(self.duration);
        self
    }
    /// Sets the reference of the errors, by default the finest run.
    #[must_use]
    pub fn with_reference(mut self, reference: Reference) -> Self {
        self.reference = reference;
        self
    }
    /// Restricts the errors to histories of some quantities, by default all that the scene records.
    ///
    /// # Errors
    /// [`StudyError::NotRecorded`] for a quantity that the scene does not record; [`StudyError::NoHistories`] for an empty
    /// list.
    pub fn comparing(mut self, quantities: &[Quantity]) -> Result<Self, StudyError> {
        if quantities.is_empty() {
            return Err(StudyError::NoHistories);
        }
        let recorded = &self.compared.recorded;
        if let Some(missing) = quantities
            .iter()
            .find(|quantity| !recorded.contains(quantity))
        {
            let quantity = missing.name();
            return Err(StudyError::NotRecorded { quantity });
        }
        self.compared.quantities = quantities.to_vec();
        Ok(self)
    }
    /// Restricts the study to the named factors; the others keep the scene's own level.
    ///
    /// # Errors
    /// [`StudyError::NoSuchFactor`] for an unknown name.
    pub fn only(mut self, names: &[impl AsRef<str>]) -> Result<Self, StudyError> {
        let known = |name: &str| self.factors.iter().any(|factor| factor.name == name);
        if let Some(name) = names.iter().map(AsRef::as_ref).find(|name| !known(name)) {
            return Err(StudyError::NoSuchFactor {
                name: name.into(),
                available: self.factors.iter().map(|factor| factor.name).collect(),
            });
        }
        let is_chosen = |name: &str| names.iter().any(|other| other.as_ref() == name);
        let factors = self.factors.into_iter().map(|factor| {
            if is_chosen(factor.name) {
                factor
            } else {
                factor.fixed()
            }
        });
        self.factors = factors.collect();
        Ok(self)
    }
    /// Runs every combination of levels, in place of the most promising ones.
    #[must_use]
    pub fn exhaustive(mut self) -> Self {
        self.exhaustive = true;
        self
    }
    /// Adds a run of the reference with elements of half the size, which estimates the error of the mesh. It takes about
    /// sixteen times as long as the reference.
    #[must_use]
    pub fn with_mesh_error(mut self) -> Self {
        self.mesh_error = true;
        self
    }
    /// Includes all histories in the errors, also those with sensitive dependence on the input: no perturbation test.
    #[must_use]
    pub fn with_every_history(mut self) -> Self {
        self.perturbation = None;
        self
    }
    /// Sets the wall time between two checkpoints of a run, in place of that of the scene's `[checkpoint]`, which is 10
    /// minutes by default.
    #[must_use]
    pub fn with_checkpoint_interval(mut self, interval: CheckpointInterval) -> Self {
        self.checkpoint_interval = Some(interval);
        self
    }
    /// Factors of the study, the most important first.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }
    /// Folder of the results.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Runs all unfinished combinations of the study, writes a table and a plot, and, if a run meets the goal, writes the
    /// scene of that run beside the original.
    ///
    /// `stop` is the cancellation flag. Where the stages do not reach the finest tolerance, the scene's own tolerance
    /// becomes the finest. After an error finished runs are kept, and another study continues from there, inside the
    /// unfinished run from its last checkpoint.
    ///
    /// # Errors
    /// A reference that is invalid or fails; [`StudyError::NoClosedForm`]; [`StudyError::StillHistories`];
    /// [`StudyError::AllHistoriesSensitive`]; [`StudyError::Interrupted`] after a cancellation.
    pub fn run(
        &mut self,
        goal: Goal,
        stop: Option<&Arc<AtomicBool>>,
        watch: &mut dyn TradeWatch,
    ) -> Result<TradeReport, StudyError> {
        let alone = plan::alone(&self.factors);
        if self.reference == Reference::ClosedForm {
            // A missing closed form is an error before anything runs.
            let scene = self.scene(&alone[0])?;
            let known = closed_form::closed_form((&scene, &self.spec), &[])?;
            if self.compared.among(known).len() < 2 {
                let reason = "only displacements and velocities have closed forms";
                return Err(StudyError::NoClosedForm { reason });
            }
        }
        if self.mesh_error {
            // An invalid refined scene is an error before anything runs.
            self.refined()?;
        }
        let most = if self.exhaustive {
            plan::all(&self.factors).len()
        } else {
            alone.len() + MOST_COMBINATIONS
        };
        let again = usize::from(self.perturbed().is_some());
        let _lock = powerhouse::ResultFolder::new(&self.folder).lock()?;
        self.announce(most + again, watch)?;
        let mut runner = TradeRunner {
            stop,
            window: self.window,
            duration: self.duration,
            checkpoint_interval: self.checkpoint_interval,
            bodies: BodyCache::default(),
        };
        let mut cases: Vec<TradeCase> = Vec::new();
        let mut known: Vec<(Design, ErrorAndCost)> = Vec::new();
        let (mut failed, mut failures) = (Vec::new(), Vec::new());
        let mut reference: Option<Vec<TableColumn>> = None;
        let (mut begun, mut sensitive) = (0, Vec::new());
        let mut pending = alone.into_iter();
        let (mut combinations, mut of_reference) = (0, None);
        let mut rest = None;
        loop {
            let design = match pending.next() {
                Some(design) => design,
                None => {
                    if combinations == 0 {
                        of_reference = self.error_of_reference(&cases);
                    }
                    combinations += 1;
                    let next = if self.exhaustive {
                        rest.get_or_insert_with(|| self.rest(&known, &failed))
                            .next()
                    } else {
                        let goal = (goal, of_reference.unwrap_or(0.0));
                        plan::next(&self.factors, (&known, &failed), goal)
                            .filter(|_| combinations <= MOST_COMBINATIONS)
                    };
                    match next {
                        Some(design) => design,
                        None => break,
                    }
                }
            };
            let name = self.name(&design);
            begun += 1;
            watch.begins(&name, begun);
            let finished = match self.finish(&design, &mut runner, watch, &name) {
                // A level may be invalid for a scene, but not the reference.
                Err(error @ StudyError::Scene(_)) if !cases.is_empty() => {
                    watch.fails(&name, &error);
                    failures.push((name, error.to_string()));
                    failed.push(design);
                    continue;
                }
                Err(StudyError::Scene(error)) => {
                    let finest = self.give_up_finer_statics(&error);
                    let error = StudyError::from(error);
                    let Some(finest) = finest else {
                        return Err(error);
                    };
                    let name = format!("statics {finest}");
                    watch.fails(&name, &error);
                    failures.push((name, error.to_string()));
                    pending = plan::alone(&self.factors).into_iter();
                    continue;
                }
                finished => finished?,
            };
            let first = reference.is_none();
            let reference = match &reference {
                Some(reference) => reference,
                None => reference.insert(self.reference_of(&finished)?),
            };
            let misfit = misfit::misfit(reference, &finished.histories, &sensitive);
            let case = TradeCase {
                name,
                levels: design.clone(),
                cost: finished.cost,
                error: misfit.error,
                worst: misfit.name,
            };
            watch.ends(&case);
            let (error, cost) = (case.error, case.cost.wall_time());
            known.push((design, ErrorAndCost { error, cost }));
            cases.push(case);
            // Only now the finest tolerance of stages is known.
            if first && let Some(spec) = self.perturbed() {
                begun += 1;
                watch.begins(repeat::PERTURBED, begun);
                let again = Perturbed::new(spec, reference, goal);
                match self.sensitive_histories(again, &mut runner, watch) {
                    Ok(found) => sensitive = found,
                    // Under slightly larger waves a run may fail.
                    Err(error @ StudyError::Scene(_)) => {
                        watch.fails(repeat::PERTURBED, &error);
                        failures.push((repeat::PERTURBED.into(), error.to_string()));
                    }
                    Err(error) => return Err(error),
                }
            }
        }
        let chosen = plan::best(&known, (goal, of_reference.unwrap_or(0.0)));
        let mut report = TradeReport {
            title: self.title.clone(),
            factors: self.factors.clone(),
            front: Vec::new(),
            cases,
            sensitive,
            failed: failures,
            reference_error: of_reference,
            mesh: None,
            partial_window: (self.path_dependent && self.window < self.duration)
                .then_some(self.window),
            chosen,
            files: Vec::new(),
        };
        report.front = pareto_front(&report.pareto_points());
        self.write(&mut report)?;
        if self.mesh_error {
            watch.begins(REFINED.0, begun + 1);
            let spec = self.refined()?;
            match self.error_of_mesh((spec, &report.sensitive), &mut runner, watch) {
                Ok(mesh) => report.mesh = Some(mesh),
                // Elements of half the size may be invalid for a law.
                Err(error @ StudyError::Scene(_)) => {
                    watch.fails(REFINED.0, &error);
                    report.failed.push((REFINED.0.into(), error.to_string()));
                }
                Err(error) => return Err(error),
            }
            self.write(&mut report)?;
        }
        Ok(report)
    }

    /// After an error of a stage that does not reach its tolerance, drops the levels of `statics` finer than the scene's
    /// own; returns the name of the dropped finest level, if there was one.
    fn give_up_finer_statics(&mut self, error: &powerhouse::Error) -> Option<String> {
        let (_, reason) = error.equilibrium_failure()?;
        if !matches!(
            reason,
            StaticError::NotConverged { .. } | StaticError::LinearSolver { .. }
        ) {
            return None;
        }
        let mut factors = self.factors.iter_mut();
        let statics = factors.find(|factor| factor.name == factor::STATICS)?;
        let finest = statics.levels.first()?.name.clone();
        *statics = statics.as_given_at_best()?;
        Some(finest)
    }

    /// The remaining combinations without levels that failed alone, sorted so that those with the same body follow each
    /// other.
    fn rest(
        &self,
        known: &[(Design, ErrorAndCost)],
        failed: &[Design],
    ) -> std::vec::IntoIter<Design> {
        let has = |design: &Design, failing: &Design| {
            let mut levels = design.iter().zip(failing);
            levels.all(|(level, failing)| *failing == 0 || failing == level)
        };
        let mut rest: Vec<Design> = plan::unknown(&self.factors, known, failed)
            .filter(|design| !failed.iter().any(|failing| has(design, failing)))
            .collect();
        rest.sort_by_cached_key(|design| self.body_of(design));
        rest.into_iter()
    }

    /// Reports the predicted cost of all runs, none of which takes longer than the finest.
    fn announce(&self, runs: usize, watch: &mut dyn TradeWatch) -> Result<(), StudyError> {
        let finest = self.scene(&vec![0; self.factors.len()])?;
        let finest = finest.map(|scene| scene.with_duration(self.window));
        let mut simulation = finest.prepare()?;
        let steps = self.window / simulation.step()?;
        let of_one = cost::StepTimer::of(&mut simulation)?
            .time_of_step()?
            .mul_f64(steps);
        let (all, refined) = if self.mesh_error {
            (runs + 1, of_one * OF_HALF_THE_SIZE.0 * OF_HALF_THE_SIZE.1)
        } else {
            (runs, Duration::ZERO)
        };
        watch.before(all, self.window, of_one * runs as u32 + refined);
        Ok(())
    }

    /// The specification with the levels of a design.
    fn spec_of(&self, design: &Design) -> SceneSpec {
        let mut spec = self.spec.clone();
        for (factor, &level) in self.factors.iter().zip(design) {
            factor.levels[level].apply(&mut spec);
        }
        spec
    }

    fn scene(&self, design: &Design) -> Result<FileScene, StudyError> {
        Ok(FileScene::from_spec(self.spec_of(design), &self.registry)?)
    }

    /// The name of a design: the levels in which it differs from the reference.
    fn name(&self, design: &Design) -> String {
        let differ = self
            .factors
            .iter()
            .zip(design)
            .filter(|(_, level)| **level > 0);
        let names: Vec<String> = differ
            .map(|(factor, &level)| format!("{} {}", factor.name, factor.levels[level].name))
            .collect();
        if names.is_empty() {
            return "reference".into();
        }
        names.join(", ")
    }

    /// The indices of a design's levels for some factors, joined by hyphens.
    fn level_indices(&self, design: &Design, counts: impl Fn(&Factor) -> bool) -> String {
        let chosen = self.factors.iter().zip(design);
        let chosen = chosen.filter(|(factor, _)| counts(factor));
        let indices = chosen.map(|(factor, &level)| factor.levels[level].index().to_string());
        indices.collect::<Vec<String>>().join("-")
    }

    /// The key of a design's equilibrated body: the stages depend on all factors but step, input and output.
    fn body_of(&self, design: &Design) -> String {
        self.level_indices(design, |factor| {
            ![factor::STEP, factor::INPUT, factor::OUTPUT].contains(&factor.name)
        })
    }

    /// The reference histories.
    fn reference_of(&self, finest: &TradeRun) -> Result<Vec<TableColumn>, StudyError> {
        let columns = match self.reference {
            Reference::Finest => finest.histories.clone(),
            Reference::ClosedForm => {
                let scene = self.scene(&vec![0; self.factors.len()])?;
                let times = finest.histories.first();
                let times = times.map_or(&[][..], |time| &time.values);
                closed_form::closed_form((&scene, &self.spec), times)?
            }
        };
        let compared = self.compared.among(columns);
        if compared.len() < 2 {
            return Err(StudyError::NoHistories);
        }
        let mut values = compared.iter().skip(1).flat_map(|column| &column.values);
        if values.all(|value| *value == 0.0) {
            let window = self.window;
            return Err(StudyError::StillHistories { window });
        }
        Ok(compared)
    }

    /// The estimated time integration error of the finest run; `None` if no other step was run. Schemes are of second
    /// order, so that a step twice as long differs by three times the error.
    fn error_of_reference(&self, cases: &[TradeCase]) -> Option<f64> {
        if self.reference == Reference::ClosedForm {
            return Some(0.0);
        }
        let index = self
            .factors
            .iter()
            .position(|factor| factor.name == factor::STEP)?;
        let coarser = cases.iter().find(|case| {
            let others = case.levels.iter().enumerate().filter(|(i, _)| *i != index);
            case.levels[index] == 1 && others.into_iter().all(|(_, level)| *level == 0)
        });
        Some(coarser?.error / 3.0)
    }
}
