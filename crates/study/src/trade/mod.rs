//! Trades: what accuracy costs a scene, found by running it over what it leaves to choose.
//!
//! A [`Trade`] runs a window of a scene in its most accurate form, changes one [`Factor`] at a time, and
//! then tries the combinations that promise most. Errors are relative L2 differences of the scene's
//! histories from the finest run, or from the field that comes in where that is the closed form; the
//! reference's own error is estimated. What a whole run costs follows from the time of its steps.
//!
//! ```no_run
//! use powerhouse_study::trade::{Goal, Silent, Trade};
//! let mut trade = Trade::of_file("data/scenes/cavern_small.toml", None)?;
//! let report = trade.run(Goal::Error(0.02), None, &mut Silent)?;
//! for &place in &report.front {
//!     let case = &report.cases[place];
//!     println!("{}: {:.1} s, error {:.4}", case.name, case.cost.wall_time(), case.error);
//! }
//! # Ok::<(), powerhouse_study::StudyError>(())
//! ```
//!
//! # What no choice repeats
//! Cracks, impacts and slip can make of a scene one whose motion depends on the last digit: from then on two
//! runs that differ in nothing but rounding have as little in common as two records of one earthquake. An
//! error of such a history tells nothing of a choice. Where laws or joints have history variables, the reference is
//! therefore run once more under waves, if some come in, that are larger by a millionth, far less than the
//! accuracy of any record; histories that change by more than half of the error that is asked for (by a
//! hundredth where none is) are named with this change and left out.
//!
//! History variables of laws counts against a tenth at least of the largest of the same variable: of a place that next
//! to nothing happens to an error relative to its own size says as little.
//!
//! # Why so
//! *The mesh stays*, its elements cut in half once if that is asked for. What is compared is everything
//! else on the same mesh, and less of it; all of that on smaller elements would take sixteen times as long.
//! One more run tells what the mesh itself costs in accuracy: motions are of second order, elements half the
//! size leave a quarter of their error, so that it is four thirds of the difference. Stresses are means of
//! elements, half of whose difference from the stress at a point is left; they count if no motion does. Where
//! strength and cracks decide, the order is lower and the error greater; a rim of no width gets thinner.
//!
//! *One factor at a time, then few combinations.* Nine factors have thousands of combinations. Their
//! errors come from different sources and hardly know of each other, so that single changes predict
//! combinations well enough to choose the next run; what is written is always one that was run.

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
use powerhouse::{Registry, Scene};
use toml::Table;

use crate::mark::{Mark, inputs};
use crate::price::price_front;
use crate::{StudyError, cost, registry};
pub use case::CaseCost;
pub(crate) use case::columns;
use case::{Bodies, Finished, TradeRunner};
pub(crate) use factor::factors;
pub use factor::{Factor, Level};
use finer_mesh::{OF_HALF_THE_SIZE, REFINED};
pub(crate) use misfit::{Misfit, misfits};
use plan::{Design, ErrorAndCost};
use quantity::Compared;
pub use quantity::Quantity;
use repeat::Perturbed;
pub use report::{
    Goal, MeshError, Reference, Silent, TradeCase, TradeReport, TradeWatch, Unrepeated,
};
use window::window;

/// Combinations that are run at most beyond single changes.
const MOST_COMBINATIONS: usize = 6;

/// A scene file and what it leaves to choose.
pub struct Trade {
    path: PathBuf,
    file: Table,
    inputs: Vec<Vec<u8>>,
    registry: Registry,
    factors: Vec<Factor>,
    title: String,
    folder: PathBuf,
    duration: f64,
    window: f64,
    /// Whether what yields, cracks or slips may go on doing so.
    path_dependent: bool,
    reference: Reference,
    compared: Compared,
    mesh_error: bool,
    exhaustive: bool,
    /// Share by which waves are changed to see what repeats; none if all histories count.
    nudge: Option<f64>,
}

impl Trade {
    /// The trade of a scene file; results go to a folder, by default `trade` in the scene's own.
    ///
    /// # Errors
    /// A scene that cannot be read; [`StudyError::NoHistories`] for one that records nothing to compare.
    pub fn of_file(path: impl AsRef<Path>, folder: Option<PathBuf>) -> Result<Self, StudyError> {
        Self::of_file_with(path, folder, &registry())
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
        let scene = Scene::from_file_with(path, registry)?;
        let compared = Compared::of(&scene);
        if compared.quantities.is_empty() {
            return Err(StudyError::NoHistories);
        }
        let text = scene.source().map_or("", |source| &source.text).to_owned();
        let file: Table = toml::from_str(&text).map_err(|source| StudyError::BayFile {
            file: path.into(),
            source: Box::new(source),
        })?;
        let own = scene.result_folder().path().join("trade");
        let mut factors = factor::factors(&scene, &file);
        let ground = ground::ground(&scene, (&file, path), registry);
        let after = [factor::KERNEL, factor::STEP, factor::BOUNDARY];
        let place = factors
            .iter()
            .take_while(|factor| after.contains(&factor.name));
        let place = place.count();
        factors.splice(place..place, ground);
        Ok(Self {
            inputs: inputs(path, &text)?,
            factors,
            title: scene.title().to_owned(),
            folder: folder.unwrap_or(own),
            duration: scene.duration(),
            window: window(&scene),
            path_dependent: scene.joints().next().is_some()
                || scene.parts().iter().any(|part| !part.material.is_linear()),
            reference: Reference::Finest,
            compared,
            mesh_error: false,
            exhaustive: false,
            nudge: Some(repeat::NUDGE),
            path: path.into(),
            file,
            registry: registry.clone(),
        })
    }
    /// The same over the first seconds (s) of the run, its whole duration at most, instead of those until
    /// half of the records' intensity has come.
    #[must_use]
    pub fn window(mut self, duration: f64) -> Self {
        self.window = duration.min(self.duration);
        self
    }
    /// The same with errors measured against something else.
    #[must_use]
    pub fn against(mut self, reference: Reference) -> Self {
        self.reference = reference;
        self
    }
    /// The same with errors of these quantities alone, in place of all that the scene records.
    ///
    /// # Errors
    /// [`StudyError::NotRecorded`] for one that the scene does not record, [`StudyError::NoHistories`] without
    /// any.
    pub fn comparing(mut self, quantities: &[Quantity]) -> Result<Self, StudyError> {
        if quantities.is_empty() {
            return Err(StudyError::NoHistories);
        }
        let recorded = &self.compared.recorded;
        if let Some(missing) = quantities.iter().find(|asked| !recorded.contains(asked)) {
            let quantity = missing.name();
            return Err(StudyError::NotRecorded { quantity });
        }
        self.compared.quantities = quantities.to_vec();
        Ok(self)
    }
    /// The same with only these factors left to choose; the scene decides on the others.
    ///
    /// # Errors
    /// [`StudyError::NoSuchFactor`].
    pub fn only(mut self, names: &[impl AsRef<str>]) -> Result<Self, StudyError> {
        let known = |name: &str| self.factors.iter().any(|factor| factor.name == name);
        if let Some(name) = names.iter().map(AsRef::as_ref).find(|name| !known(name)) {
            return Err(StudyError::NoSuchFactor {
                name: name.into(),
                available: self.factors.iter().map(|factor| factor.name).collect(),
            });
        }
        let is_left = |name: &str| names.iter().any(|other| other.as_ref() == name);
        let factors = self
            .factors
            .into_iter()
            .map(|factor| match is_left(factor.name) {
                true => factor,
                false => factor.fixed(),
            });
        self.factors = factors.collect();
        Ok(self)
    }
    /// The same with every combination of levels run, in place of those that promise most.
    #[must_use]
    pub fn exhaustive(mut self) -> Self {
        self.exhaustive = true;
        self
    }
    /// The same with one more run, of the reference on elements half the size: it tells the error of the
    /// mesh, and takes about sixteen times as long as the reference.
    #[must_use]
    pub fn with_mesh_error(mut self) -> Self {
        self.mesh_error = true;
        self
    }
    /// The same with all histories counted, those that no choice repeats included.
    #[must_use]
    pub fn with_every_history(mut self) -> Self {
        self.nudge = None;
        self
    }
    /// What the scene leaves to choose, what matters most first.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }
    /// The folder of the results.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Runs what is not finished yet, writes a table and a picture, and beside the scene, if a run meets
    /// the goal, the scene of that run.
    ///
    /// Where a body does not come to rest as closely as the finest tolerance of its stages asks, the
    /// scene's own is the finest from then on.
    ///
    /// # Errors
    /// A reference that is refused or fails; [`StudyError::NoClosedForm`]; [`StudyError::StillHistories`];
    /// [`StudyError::NothingRepeats`]; [`StudyError::Interrupted`] if it was stopped from outside: what was
    /// finished until then stays, and another trade goes on from there.
    pub fn run(
        &mut self,
        goal: Goal,
        stop: Option<&Arc<AtomicBool>>,
        watch: &mut dyn TradeWatch,
    ) -> Result<TradeReport, StudyError> {
        let alone = plan::alone(&self.factors);
        if self.reference == Reference::ClosedForm {
            // Whether there is one shows before anything runs.
            let known = closed_form::closed_form((&self.scene(&alone[0])?, &self.file), &[])?;
            if self.compared.among(known).len() < 2 {
                let reason = "only displacements and velocities have one";
                return Err(StudyError::NoClosedForm { reason });
            }
        }
        if self.mesh_error {
            // Whether it can be read shows before anything runs.
            self.refined_text()?;
        }
        let most = match self.exhaustive {
            true => plan::all(&self.factors).len(),
            false => alone.len() + MOST_COMBINATIONS,
        };
        let again = usize::from(self.nudged_text()?.is_some());
        let _lock = powerhouse::ResultFolder::new(&self.folder).lock()?;
        self.announce(most + again, watch)?;
        let mut runner = TradeRunner {
            stop,
            window: self.window,
            duration: self.duration,
            bodies: Bodies::default(),
        };
        let mut cases: Vec<TradeCase> = Vec::new();
        let mut known: Vec<(Design, ErrorAndCost)> = Vec::new();
        let (mut failed, mut failures) = (Vec::new(), Vec::new());
        let mut reference: Option<Vec<TableColumn>> = None;
        let (mut begun, mut unrepeated) = (0, Vec::new());
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
                // Not every level suits every scene; the reference must.
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
            let misfit = misfit::misfit(reference, &finished.histories, &unrepeated);
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
            // Now that the finest tolerance of stages is known.
            if first && let Some(text) = self.nudged_text()? {
                begun += 1;
                watch.begins(repeat::NUDGED, begun);
                let again = Perturbed::new(&text, reference, goal);
                match self.unrepeated(again, &mut runner, watch) {
                    Ok(found) => unrepeated = found,
                    // What hardly gets through may not with hardly more.
                    Err(error @ StudyError::Scene(_)) => {
                        watch.fails(repeat::NUDGED, &error);
                        failures.push((repeat::NUDGED.into(), error.to_string()));
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
            unrepeated,
            failed: failures,
            reference_error: of_reference,
            mesh: None,
            foreseen: (self.path_dependent && self.window < self.duration).then_some(self.window),
            chosen,
            files: Vec::new(),
        };
        report.front = price_front(&report.prices());
        self.write(&mut report)?;
        if self.mesh_error {
            watch.begins(REFINED.0, begun + 1);
            let text = self.refined_text()?;
            match self.error_of_mesh((&text, &report.unrepeated), &mut runner, watch) {
                Ok(mesh) => report.mesh = Some(mesh),
                // Half the size may be too small for a law.
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

    /// Where the error is a stage that does not come to rest as closely as it shall, takes what the scene
    /// asks of its stages for the finest; gives the name of what was finest, if that was finer.
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

    /// What is left of all combinations, those one after the other that share a body: without levels that
    /// failed alone.
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

    /// Says what the runs will cost: none takes longer than the finest.
    fn announce(&self, runs: usize, watch: &mut dyn TradeWatch) -> Result<(), StudyError> {
        let finest = self
            .scene(&vec![0; self.factors.len()])?
            .with_duration(self.window);
        let mut simulation = finest.prepare()?;
        let steps = self.window / simulation.step()?;
        let of_one = cost::Clock::of(&mut simulation)?
            .time_of_step()?
            .mul_f64(steps);
        let (all, refined) = match self.mesh_error {
            true => (runs + 1, of_one * OF_HALF_THE_SIZE.0 * OF_HALF_THE_SIZE.1),
            false => (runs, Duration::ZERO),
        };
        watch.before(all, self.window, of_one * runs as u32 + refined);
        Ok(())
    }

    /// The file of a design.
    fn file_of(&self, design: &Design) -> Table {
        let mut file = self.file.clone();
        for (factor, &level) in self.factors.iter().zip(design) {
            factor.levels[level].apply(&mut file);
        }
        file
    }

    fn text_of(&self, design: &Design) -> Result<String, StudyError> {
        self.written(&self.file_of(design))
    }

    fn written(&self, file: &Table) -> Result<String, StudyError> {
        toml::to_string(file).map_err(|source| StudyError::Unwritable {
            file: self.path.clone(),
            source: Box::new(source),
        })
    }

    fn scene(&self, design: &Design) -> Result<Scene, StudyError> {
        let text = self.text_of(design)?;
        Ok(Scene::from_toml(text, &self.path, &self.registry)?)
    }

    /// The levels in which a design differs from the reference.
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

    /// What a design came to: as it was found before, or now.
    fn finish(
        &self,
        design: &Design,
        runner: &mut TradeRunner,
        watch: &mut dyn TradeWatch,
        name: &str,
    ) -> Result<Finished, StudyError> {
        let folder = self.places(design, |_| true);
        let body = self.body_of(design);
        let text = self.text_of(design)?;
        self.finish_file(&text, (&folder, &body), runner, (watch, name))
    }

    /// The places of a design's levels among all that the scene allows, of some factors.
    fn places(&self, design: &Design, counts: impl Fn(&Factor) -> bool) -> String {
        let chosen = self.factors.iter().zip(design);
        let chosen = chosen.filter(|(factor, _)| counts(factor));
        let places = chosen.map(|(factor, &level)| factor.levels[level].place().to_string());
        places.collect::<Vec<String>>().join("-")
    }

    /// What decides of a design's body at rest: stages know of elements and their numbers, not of steps and
    /// waves.
    fn body_of(&self, design: &Design) -> String {
        self.places(design, |factor| {
            ![factor::STEP, factor::INPUT, factor::OUTPUT].contains(&factor.name)
        })
    }

    /// What a scene's file came to, from a folder of its own; its body at rest is known by a name.
    fn finish_file(
        &self,
        text: &str,
        (folder, body): (&str, &str),
        runner: &mut TradeRunner,
        (watch, name): (&mut dyn TradeWatch, &str),
    ) -> Result<Finished, StudyError> {
        let folder = self.folder.join(folder);
        let mark = Mark::of(
            text,
            &self.inputs,
            Some(self.window),
            self.registry.version(),
        );
        if let Some(kept) = runner.kept(&folder, &mark)? {
            watch.kept(name);
            return Ok(kept);
        }
        let scene = Scene::from_toml(text, &self.path, &self.registry)?;
        let finished = runner.run(scene, body, watch)?;
        runner.keep(&folder, &mark, &finished)?;
        // As another trade would find it: a number may lose its last bit in a file.
        Ok(runner.kept(&folder, &mark)?.unwrap_or(finished))
    }

    /// The histories that others are compared with.
    fn reference_of(&self, finest: &Finished) -> Result<Vec<TableColumn>, StudyError> {
        let columns = match self.reference {
            Reference::Finest => finest.histories.clone(),
            Reference::ClosedForm => {
                let scene = self.scene(&vec![0; self.factors.len()])?;
                let times = finest.histories.first();
                let times = times.map_or(&[][..], |time| &time.values);
                closed_form::closed_form((&scene, &self.file), times)?
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

    /// The error of the finest run, on its mesh: schemes are of second order, so that a step twice as
    /// long differs by three times what is left; none if there was no such step.
    fn error_of_reference(&self, cases: &[TradeCase]) -> Option<f64> {
        if self.reference == Reference::ClosedForm {
            return Some(0.0);
        }
        let place = self
            .factors
            .iter()
            .position(|factor| factor.name == factor::STEP)?;
        let coarser = cases.iter().find(|case| {
            let others = case.levels.iter().enumerate().filter(|(i, _)| *i != place);
            case.levels[place] == 1 && others.into_iter().all(|(_, level)| *level == 0)
        });
        Some(coarser?.error / 3.0)
    }
}
