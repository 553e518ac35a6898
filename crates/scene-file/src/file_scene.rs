//! Scenes from files.

use core::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use powerhouse_scene::{
    Error, Fault, FirstOfSet, Places, ResidualLimit, Scene, SceneText, Simulation, Subject, remark,
};

use crate::engine::gpu_engine;
use crate::resolve::{self, Draft};
use crate::spans::FilePlaces;
use crate::spec::{EngineName, Registered, SceneFile, SceneSpec};
use crate::{CheckpointPlan, InputOverview, KeyChange, Registry};

/// Which scene of a file is read: the scene itself or one of its cases, with changed keys.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneChoice {
    /// Name of a case; none for the scene itself.
    pub case: Option<String>,
    /// Changed keys, in the order in which they are changed.
    pub changes: Vec<KeyChange>,
}

/// Scene together with what only its file knows: text, case, changed keys, registry of names, and what the file asks of
/// programs that run it.
///
/// It is a [`Scene`] wherever one is read. A scene that was composed in Rust becomes one [`from`](Self::from) it, without a
/// file; [`map`](Self::map) changes the scene and keeps the rest.
///
/// ```
/// use powerhouse_scene_file::{FileScene, Registry};
/// let refused = FileScene::from_toml("title = 3", "tunnel.toml", &Registry::default());
/// assert!(refused.is_err_and(|fault| fault.to_string().starts_with("tunnel.toml:1:9")));
/// ```
pub struct FileScene {
    scene: Scene,
    source: Option<Arc<SceneText>>,
    spec: Option<Arc<SceneSpec>>,
    cases: Vec<String>,
    cases_on_request: Vec<String>,
    case: Option<String>,
    changes: Vec<String>,
    input: InputOverview,
    registry: Option<Registry>,
    self_check: Option<f64>,
    checkpoints: CheckpointPlan,
    directory: Option<PathBuf>,
}

impl Deref for FileScene {
    type Target = Scene;
    fn deref(&self) -> &Scene {
        &self.scene
    }
}

impl From<Scene> for FileScene {
    fn from(scene: Scene) -> Self {
        Self {
            scene,
            source: None,
            spec: None,
            cases: Vec::new(),
            cases_on_request: Vec::new(),
            case: None,
            changes: Vec::new(),
            input: InputOverview::default(),
            registry: None,
            self_check: None,
            checkpoints: CheckpointPlan::default(),
            directory: None,
        }
    }
}

impl FileScene {
    /// Scene of a file, with its mesh and its records; laws, kernels and boundaries are those that come with
    /// the software.
    ///
    /// # Errors
    /// [`Error::Scene`] with file, line and column for a fault in the scene, [`Error::Read`] if the file cannot be
    /// read.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::from_file_with(path, &Registry::default())
    }
    /// Scene of a file whose laws, kernels and boundaries are those of a registry.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file).
    pub fn from_file_with(path: impl AsRef<Path>, registry: &Registry) -> Result<Self, Error> {
        Self::of_case(&SceneFile::read(path)?, None, registry)
    }
    /// Scene of a file, or of a case of it, with changed keys; they are a remark of every check and run of the scene.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file); [`Error::NoSuchCase`]; [`Error::KeyChange`] for a change that cannot be made.
    pub fn from_file_as(
        path: impl AsRef<Path>,
        choice: &SceneChoice,
        registry: &Registry,
    ) -> Result<Self, Error> {
        let case = choice.case.as_deref();
        let file = SceneFile::read_changed(path, case, &choice.changes)?;
        Self::of_case(&file, case, registry)
    }
    /// Scene of a case of a file: the scene with the keys that the case changes.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file), and [`Error::NoSuchCase`].
    pub fn case_from_file_with(
        path: impl AsRef<Path>,
        case: &str,
        registry: &Registry,
    ) -> Result<Self, Error> {
        Self::of_case(&SceneFile::read(path)?, Some(case), registry)
    }
    /// Scene of a case of a text in TOML. `path` is used in messages; paths in the scene are relative to its folder.
    ///
    /// # Errors
    /// [`Error::Scene`], as [`from_file`](Self::from_file), and [`Error::NoSuchCase`].
    pub fn case_from_toml(
        text: impl Into<String>,
        path: impl Into<PathBuf>,
        case: &str,
        registry: &Registry,
    ) -> Result<Self, Error> {
        Self::of_case(&SceneFile::parse(text, path)?, Some(case), registry)
    }
    /// Scene of a text in TOML. `path` is used in messages; paths in the scene are relative to its folder.
    ///
    /// # Errors
    /// [`Error::Scene`], as [`from_file`](Self::from_file).
    pub fn from_toml(
        text: impl Into<String>,
        path: impl Into<PathBuf>,
        registry: &Registry,
    ) -> Result<Self, Error> {
        Self::of_case(&SceneFile::parse(text, path)?, None, registry)
    }
    /// Scene of a parsed file, or of a case of it, with the names of a registry.
    ///
    /// # Errors
    /// [`Error::Scene`], as [`from_file`](Self::from_file), and [`Error::NoSuchCase`].
    pub fn of_case(
        file: &SceneFile,
        case: Option<&str>,
        registry: &Registry,
    ) -> Result<Self, Error> {
        let composed = file
            .checked(case, registry)
            .and_then(|(spec, registered)| Self::compose(spec, registered, registry));
        composed.map_err(|error| error.in_case(case))
    }
    /// Scene of a specification, such as one from a file whose values a program has changed. Faults in changed values are
    /// reported where the file has the former ones.
    ///
    /// # Errors
    /// [`Error::Scene`], as [`from_file`](Self::from_file).
    pub fn from_spec(spec: SceneSpec, registry: &Registry) -> Result<Self, Error> {
        let case = spec.case().map(str::to_owned);
        let checked = spec.file().check(&spec, registry);
        let composed = checked
            .map_err(|fault| spec.file().fault(fault))
            .and_then(|registered| Self::compose(spec, registered, registry));
        composed.map_err(|error| error.in_case(case.as_deref()))
    }

    /// Checks the keys and values of a scene file with changed keys, and of all its cases, without reading mesh and
    /// records; what depends on these is not checked. The number of the cases.
    ///
    /// # Errors
    /// As [`from_file_as`](Self::from_file_as).
    pub fn check_keys(
        path: impl AsRef<Path>,
        changes: &[KeyChange],
        registry: &Registry,
    ) -> Result<usize, Error> {
        let file = SceneFile::read_changed(path, None, changes)?;
        Ok(file.checked(None, registry)?.0.cases.len())
    }

    fn compose(
        spec: SceneSpec,
        mut registered: Registered,
        registry: &Registry,
    ) -> Result<Self, Error> {
        let unusual = core::mem::take(&mut registered.unusual);
        let file = spec.file();
        let refused = |fault| file.fault(fault);
        let case = spec.case().map(str::to_owned);
        let composed = resolve::compose((file.text(), registry), &spec, registered);
        let composed = composed.map_err(refused)?;
        let Draft {
            mut scene,
            places: mut spans,
            self_check,
            checkpoints,
            ..
        } = composed;
        spans.case.clone_from(&case);
        let changes = file.changes().to_vec();
        if !changes.is_empty() {
            let changes = changes.clone();
            scene.remark_once(remark::ChangedKeys { changes });
        }
        for former in file.former_keys() {
            let (table, [former, present]) = (former.table, *former.names);
            scene.remark_once(remark::FormerKey {
                table,
                former,
                present,
            });
        }
        let of_set = file.record_cases();
        let is_of_set = of_set.iter().any(|own| Some(&*own.case) == case.as_deref());
        if let (Some(set), Some(first), false) =
            (spec.record_sets.first(), of_set.first(), is_of_set)
        {
            scene.remark_once(FirstOfSet {
                set: set.name.to_string(),
                first: first.case.clone(),
                cases: of_set.len(),
            });
        }
        for magnitude in unusual {
            scene.remark_once(magnitude);
        }
        // With the text, faults of the whole scene are reported with line and column.
        let text = file.text().clone();
        let places = Arc::new(FilePlaces { text, spans });
        let found = scene.check_magnitudes().and_then(|()| scene.check_names());
        found.map_err(|error| places.placed(Subject::OfError, error))?;
        scene.check_threads();
        scene = scene.with_engine(registry.engine().clone());
        choose_engine(&mut scene, &spec, registry).map_err(refused)?;
        let named = |on_request: &dyn Fn(bool) -> bool| {
            let cases = spec.cases.iter().filter(|case| on_request(case.on_request));
            cases.map(|case| case.name.to_string()).collect()
        };
        Ok(Self {
            scene: scene.with_places(places),
            source: Some(file.text().clone()),
            cases: named(&|_| true),
            cases_on_request: named(&|on_request| on_request),
            case,
            changes,
            input: InputOverview::of(&spec),
            registry: Some(registry.clone()),
            self_check,
            checkpoints,
            directory: spec.output.directory.clone(),
            spec: Some(Arc::new(spec)),
        })
    }
}

impl FileScene {
    /// The scene alone.
    pub fn into_scene(self) -> Scene {
        self.scene
    }
    /// The same with another scene made of its own.
    #[must_use]
    pub fn map(self, change: impl FnOnce(Scene) -> Scene) -> Self {
        Self {
            scene: change(self.scene),
            ..self
        }
    }
    /// Simulation of the scene, as [`Scene::prepare`].
    ///
    /// # Errors
    /// As [`Scene::prepare`].
    pub fn prepare(self) -> Result<Simulation, Error> {
        self.scene.prepare()
    }
    /// Sets the largest permitted relative L2 error of velocity in the free-field check (1), which the command
    /// `powerhouse run` and sweeps make before they run a scene; [`prepare`](Self::prepare) and a simulation do not.
    #[must_use]
    pub fn with_self_check(mut self, error: f64) -> Self {
        self.self_check = Some(error);
        self
    }
    /// Sets the path of the folder for the files of a run, relative to the working directory.
    #[must_use]
    pub fn with_directory(mut self, path: impl Into<PathBuf>) -> Self {
        self.directory = Some(path.into());
        self
    }
    /// Sets the registry of names, as reading a file does: checks and advice of the scene then know the
    /// boundaries and kernels that a program has registered.
    #[must_use]
    pub fn with_registry(mut self, registry: Registry) -> Self {
        self.registry = Some(registry);
        self
    }
    /// The registry that the scene was read with; none for one that was composed without.
    pub fn registry(&self) -> Option<&Registry> {
        self.registry.as_ref()
    }
    /// The largest permitted error of the free field, if a run is to check it first.
    pub fn self_check(&self) -> Option<f64> {
        self.self_check
    }
    /// Path and text of the scene file; `None` for a scene composed in Rust.
    pub fn source(&self) -> Option<&Arc<SceneText>> {
        self.source.as_ref()
    }
    /// The specification that the scene was made of; `None` for a scene composed in Rust.
    pub fn spec(&self) -> Option<&SceneSpec> {
        self.spec.as_deref()
    }
    /// Names of the cases in the scene file.
    pub fn case_names(&self) -> &[String] {
        &self.cases
    }
    /// Names of the cases that a sweep computes on request only.
    pub fn cases_on_request(&self) -> &[String] {
        &self.cases_on_request
    }
    /// Name of the case that the scene is, if any.
    pub fn case(&self) -> Option<&str> {
        self.case.as_deref()
    }
    /// Changed keys of the scene file with which the scene was read, each as `KEY=VALUE`.
    pub fn changes(&self) -> &[String] {
        &self.changes
    }
    /// Results folder of a run: as given in the scene, or `results/` with the name of the scene file; a case has a
    /// subfolder of its name.
    pub fn result_folder(&self) -> PathBuf {
        let named = || {
            let stem = self
                .source
                .as_ref()
                .and_then(|source| source.path.file_stem());
            Path::new("results").join(stem.unwrap_or("scene".as_ref()))
        };
        let folder = self.directory.clone().unwrap_or_else(named);
        match &self.case {
            Some(case) => folder.join(case),
            None => folder,
        }
    }
    /// Checkpoints that the scene requests.
    pub fn checkpoints(&self) -> &CheckpointPlan {
        &self.checkpoints
    }
    /// Sets the checkpoints of a run, and the times whose states are kept after it.
    #[must_use]
    pub fn with_checkpoints(mut self, checkpoints: CheckpointPlan) -> Self {
        self.checkpoints = checkpoints;
        self
    }
    /// Incident waves of the scene's file, and how it differs from other cases; empty if the scene is not from
    /// a file.
    pub fn input(&self) -> &InputOverview {
        &self.input
    }
}

/// Takes the engine that a file asks for. Where it balances no energies, they are neither checked nor recorded, unless the
/// file asks for it.
fn choose_engine(scene: &mut Scene, file: &SceneSpec, registry: &Registry) -> Result<(), Fault> {
    let Some(engine) = (file.engine.as_ref()).filter(|engine| ***engine == EngineName::Gpu) else {
        return Ok(());
    };
    if registry.has_own_engine() {
        let reason = "this run has an engine of its own, such as one of several ranks";
        return Err(Fault::refused(engine.span(), reason));
    }
    scene.engine = gpu_engine().map_err(|reason| Fault::refused(engine.span(), reason))?;
    if scene.engine.balances_energy() {
        return Ok(());
    }
    let reason = "the engine computes no balance of energies";
    if let Some(asked) = &file.output.energies {
        return Err(Fault::refused(asked.span(), reason));
    }
    if let ResidualLimit::Share(_) = scene.residual {
        let reason = format!("{reason}, and `energy_residual` asks for its check");
        return Err(Fault::refused(engine.span(), reason));
    }
    (scene.output.energies, scene.residual) = (None, ResidualLimit::Unchecked);
    let engine = scene.engine.name().to_owned();
    scene.remark_once(remark::NoEnergyBalance { engine });
    Ok(())
}
