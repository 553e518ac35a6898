//! Trades: what accuracy costs a scene, found by running it over what it leaves to choose.
//!
//! A [`Trade`] runs a window of a scene in its most accurate form, changes one [`Factor`] at a time, and
//! then tries the combinations that promise most. Errors are relative L2 differences of the scene's
//! histories from the finest run, or from the field that comes in where that is the closed form; the
//! reference's own error is estimated. What a whole run costs follows from the time of its steps.
//!
//! ```no_run
//! use powerhouse_study::trade::{Goal, Silent, Trade};
//! let trade = Trade::of_file("data/scenes/cavern_small.toml", None)?;
//! let report = trade.run(Goal::Error(0.02), None, &mut Silent)?;
//! for &place in &report.front {
//!     let case = &report.cases[place];
//!     println!("{}: {:.1} s, error {:.4}", case.name, case.cost.wall_time(), case.error);
//! }
//! # Ok::<(), powerhouse_study::StudyError>(())
//! ```
//!
//! # Why so
//! *The mesh stays*, its elements cut in half once if that is asked for. What is compared is everything
//! else on the same mesh, and less of it; all of that on smaller elements would take sixteen times as long.
//! One more run tells what the mesh itself costs in accuracy: of a scheme of second order elements half the
//! size leave a quarter of the error, so that it is four thirds of the difference. Where strength and cracks
//! decide, the order is lower and the error greater.
//!
//! *One factor at a time, then few combinations.* Seven factors have hundreds of combinations. Their
//! errors come from different sources and hardly know of each other, so that single changes predict
//! combinations well enough to choose the next run; what is written is always one that was run.

mod case;
mod closed_form;
mod factor;
mod misfit;
mod plan;
mod quantity;
mod report;
mod written;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use powerhouse::io::TableColumn;
use powerhouse::wavefield::TimeHistory;
use powerhouse::{Registry, Scene};
use toml::{Table, Value};

use crate::mark::{Mark, inputs};
use crate::price::price_front;
use crate::{StudyError, cost, registry};
pub use case::CaseCost;
use case::{Bench, Finished};
pub(crate) use factor::factors;
pub use factor::{Factor, Level};
use plan::{Design, Outlook};
use quantity::Compared;
pub use quantity::Quantity;
pub use report::{Goal, Reference, Silent, TradeCase, TradeReport, TradeWatch};

/// Share of a record's intensity that a window holds, and what is added of the duration for the waves
/// to cross the body.
const SHARE_OF_INTENSITY: f64 = 0.5;
const SHARE_ADDED: f64 = 0.1;
/// Elements half the size: so many times as many, and as many times the steps.
const OF_HALF_THE_SIZE: (u32, u32) = (8, 2);
/// Error of a mesh over the difference from one of half the size, of second order.
const SECOND_ORDER: f64 = 4.0 / 3.0;
/// The name of that run and of its folder.
const REFINED: (&str, &str) = ("reference on elements half the size", "refined");
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
    reference: Reference,
    compared: Compared,
    mesh_error: bool,
    exhaustive: bool,
}

impl Trade {
    /// The trade of a scene file; results go to a folder, by default `trade` in the scene's own.
    ///
    /// # Errors
    /// A scene that cannot be read; [`StudyError::NoHistories`] for one that records nothing to compare.
    pub fn of_file(path: impl AsRef<Path>, folder: Option<PathBuf>) -> Result<Self, StudyError> {
        let (path, registry) = (path.as_ref(), registry());
        let scene = Scene::from_file_with(path, &registry)?;
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
        Ok(Self {
            inputs: inputs(path, &text)?,
            factors: factor::factors(&scene, &file),
            title: scene.title().to_owned(),
            folder: folder.unwrap_or(own),
            duration: scene.run_duration(),
            window: window(&scene),
            reference: Reference::Finest,
            compared,
            mesh_error: false,
            exhaustive: false,
            path: path.into(),
            file,
            registry,
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
        let recorded = &self.compared.quantities;
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
    /// # Errors
    /// A reference that is refused or fails; [`StudyError::NoClosedForm`]; [`StudyError::StillHistories`];
    /// [`StudyError::Interrupted`] if it
    /// was stopped from outside: what was finished until then stays, and another trade goes on from
    /// there.
    pub fn run(
        &self,
        goal: Goal,
        stop: Option<&Arc<AtomicBool>>,
        watch: &mut dyn TradeWatch,
    ) -> Result<TradeReport, StudyError> {
        let alone = plan::alone(&self.factors);
        if self.reference == Reference::ClosedForm {
            // Whether there is one shows before anything runs.
            closed_form::closed_form(&self.scene(&alone[0])?, &[])?;
        }
        let most = match self.exhaustive {
            true => plan::all(&self.factors).len(),
            false => alone.len() + MOST_COMBINATIONS,
        };
        self.announce(most, watch)?;
        let mut bench = Bench {
            stop,
            window: self.window,
            duration: self.duration,
            bodies: BTreeMap::new(),
        };
        let mut cases: Vec<TradeCase> = Vec::new();
        let mut known: Vec<(Design, Outlook)> = Vec::new();
        let (mut failed, mut failures) = (Vec::new(), Vec::new());
        let mut reference: Option<Vec<TableColumn>> = None;
        let mut pending = alone.into_iter();
        let (mut combinations, mut of_reference) = (0, 0.0);
        loop {
            let design = match pending.next() {
                Some(design) => design,
                None => {
                    if combinations == 0 {
                        of_reference = self.error_of_reference(&cases);
                    }
                    combinations += 1;
                    let next = match self.exhaustive {
                        true => plan::unknown(&self.factors, &known, &failed).next(),
                        false => plan::next(&self.factors, (&known, &failed), (goal, of_reference))
                            .filter(|_| combinations <= MOST_COMBINATIONS),
                    };
                    match next {
                        Some(design) => design,
                        None => break,
                    }
                }
            };
            let name = self.name(&design);
            watch.begins(&name, cases.len() + failed.len() + 1);
            let finished = match self.finish(&design, &mut bench, watch, &name) {
                // Not every level suits every scene; the reference must.
                Err(error @ StudyError::Scene(_)) if !cases.is_empty() => {
                    watch.fails(&name, &error);
                    failures.push((name, error.to_string()));
                    failed.push(design);
                    continue;
                }
                finished => finished?,
            };
            let reference = match &reference {
                Some(reference) => reference,
                None => reference.insert(self.reference_of(&finished)?),
            };
            let misfit = misfit::misfit(reference, &finished.histories);
            let case = TradeCase {
                name,
                levels: design.clone(),
                cost: finished.cost,
                error: misfit.error,
                worst: misfit.name,
            };
            watch.ends(&case);
            let (error, cost) = (case.error, case.cost.wall_time());
            known.push((design, Outlook { error, cost }));
            cases.push(case);
        }
        let chosen = plan::best(&known, (goal, of_reference));
        let place = cases.len() + failed.len() + 1;
        let refined = match self.mesh_error {
            true => self.refined(&mut bench, watch, place),
            false => Ok(None),
        };
        let refined = refined.or_else(|error| match error {
            // Half the size may be too small for a law, or for memory; what was found stays.
            StudyError::Scene(_) => {
                watch.fails(REFINED.0, &error);
                failures.push((REFINED.0.into(), error.to_string()));
                Ok(None)
            }
            error => Err(error),
        })?;
        let mut report = TradeReport {
            title: self.title.clone(),
            factors: self.factors.clone(),
            front: Vec::new(),
            cases,
            failed: failures,
            reference_error: of_reference,
            refined,
            chosen,
            files: Vec::new(),
        };
        report.front = price_front(&report.prices());
        self.write(&mut report)?;
        Ok(report)
    }

    /// Says what the runs will cost: none takes longer than the finest.
    fn announce(&self, runs: usize, watch: &mut dyn TradeWatch) -> Result<(), StudyError> {
        let finest = self
            .scene(&vec![0; self.factors.len()])?
            .duration(self.window);
        let mut simulation = finest.prepare()?;
        let steps = self.window / simulation.step()?;
        let of_one = cost::time_of_step(&mut simulation)?.mul_f64(steps);
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
        bench: &mut Bench,
        watch: &mut dyn TradeWatch,
        name: &str,
    ) -> Result<Finished, StudyError> {
        let chosen = self.factors.iter().zip(design);
        let places = chosen.map(|(factor, &level)| factor.levels[level].place().to_string());
        let levels: Vec<String> = places.collect();
        // Stages know of elements and their numbers, not of steps and waves.
        let of_body = self.factors.iter().zip(&levels);
        let of_body =
            of_body.filter(|(factor, _)| !["step", "input", "output"].contains(&factor.name));
        let body: Vec<&str> = of_body.map(|(_, level)| level.as_str()).collect();
        let folder = levels.join("-");
        self.finish_file(
            &self.text_of(design)?,
            (&folder, &body.join("-")),
            bench,
            (watch, name),
        )
    }

    /// What a scene's file came to, from a folder of its own; its body at rest is known by a name.
    fn finish_file(
        &self,
        text: &str,
        (folder, body): (&str, &str),
        bench: &mut Bench,
        (watch, name): (&mut dyn TradeWatch, &str),
    ) -> Result<Finished, StudyError> {
        let folder = self.folder.join(folder);
        let mark = Mark::of(text, &self.inputs, Some(self.window));
        if let Some(kept) = bench.kept(&folder, &mark)? {
            watch.kept(name);
            return Ok(kept);
        }
        let scene = Scene::from_toml(text, &self.path, &self.registry)?;
        let finished = bench.run(scene, body, watch)?;
        bench.keep(&folder, &mark, &finished)?;
        // As another trade would find it: a number may lose its last bit in a file.
        Ok(bench.kept(&folder, &mark)?.unwrap_or(finished))
    }

    /// The reference on elements half the size, and what its own mesh costs it in accuracy.
    fn refined(
        &self,
        bench: &mut Bench,
        watch: &mut dyn TradeWatch,
        place: usize,
    ) -> Result<Option<TradeCase>, StudyError> {
        let (name, folder) = REFINED;
        let design = vec![0; self.factors.len()];
        let coarse = self.finish(&design, bench, &mut Silent, name)?;
        let mut file = self.file_of(&design);
        if let Some(Value::Table(mesh)) = file.get_mut("mesh") {
            let own = mesh.get("refine").and_then(Value::as_integer);
            mesh.insert("refine".into(), (own.unwrap_or(0) + 1).into());
        }
        let text = self.written(&file)?;
        watch.begins(name, place);
        let fine = self.finish_file(&text, (folder, folder), bench, (watch, name))?;
        let truth = self.compared.among(fine.histories);
        let misfit = misfit::misfit(&truth, &coarse.histories);
        let case = TradeCase {
            name: name.into(),
            levels: design,
            cost: fine.cost,
            error: SECOND_ORDER * misfit.error,
            worst: misfit.name,
        };
        watch.ends(&case);
        Ok(Some(case))
    }

    /// The histories that others are compared with.
    fn reference_of(&self, finest: &Finished) -> Result<Vec<TableColumn>, StudyError> {
        let columns = match self.reference {
            Reference::Finest => finest.histories.clone(),
            Reference::ClosedForm => {
                let scene = self.scene(&vec![0; self.factors.len()])?;
                let times = finest.histories.first();
                closed_form::closed_form(&scene, times.map_or(&[][..], |time| &time.values))?
            }
        };
        let compared = self.compared.among(columns);
        let mut values = compared.iter().skip(1).flat_map(|column| &column.values);
        if values.all(|value| *value == 0.0) {
            let window = self.window;
            return Err(StudyError::StillHistories { window });
        }
        Ok(compared)
    }

    /// The error of the finest run, on its mesh: schemes are of second order, so that a step twice as
    /// long differs by three times what is left.
    fn error_of_reference(&self, cases: &[TradeCase]) -> f64 {
        if self.reference == Reference::ClosedForm {
            return 0.0;
        }
        let Some(place) = self.factors.iter().position(|factor| factor.name == "step") else {
            return 0.0;
        };
        let coarser = cases.iter().find(|case| {
            let others = case.levels.iter().enumerate().filter(|(i, _)| *i != place);
            case.levels[place] == 1 && others.into_iter().all(|(_, level)| *level == 0)
        });
        coarser.map_or(0.0, |case| case.error / 3.0)
    }
}

/// Time until half of the records' intensity has come, and a tenth of the duration more; the duration
/// if that is shorter, or waves are pulses.
fn window(scene: &Scene) -> f64 {
    let until = |history: &TimeHistory| {
        let samples = history.acceleration();
        let whole: f64 = samples.iter().map(|a| a * a).sum();
        let mut sum = 0.0;
        let place = samples.iter().position(|a| {
            sum += a * a;
            sum >= SHARE_OF_INTENSITY * whole
        });
        place.unwrap_or(samples.len()) as f64 * history.step()
    };
    let duration = scene.run_duration();
    let latest = scene.records().values().map(until).reduce(f64::max);
    latest.map_or(duration, |latest| {
        duration.min(latest + SHARE_ADDED * duration)
    })
}
