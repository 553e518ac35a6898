//! Scenes: what is composed anew for every check and run.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use numpy::PyReadonlyArray1;
use powerhouse::model::ElasticMedium;
use powerhouse::wavefield::TimeHistory;
use powerhouse::{Error, FileScene as Composed, Registry, ResultFolder};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::alarm::Alarm;
use crate::check::Check;
use crate::fault::{self, Failure, exception, text_of};
use crate::functions::Function;
use crate::laws::{self, Law};
use crate::mesh::Mesh;
use crate::results::Results;
use crate::run::{Order, interval, run};
use crate::steps::Steps;
use crate::studies::{self, SweepOrder, Trade, TradeOrder};
use crate::waiting::wait_for;

/// Name of the mesh generator that returns a mesh of arrays.
pub(crate) const ARRAYS: &str = "arrays";

/// Text of a scene, and what its names mean.
#[derive(Clone)]
pub(crate) struct Source {
    text: String,
    path: PathBuf,
    case: Option<String>,
    registry: Registry,
    functions: Vec<Function>,
    laws: Vec<Law>,
    /// Whether the text is that of the file at the path.
    pub(crate) is_file: bool,
}

impl Source {
    /// The scene, with mesh and records as their files are now; the alarm is raised by an exception of a function of it.
    pub(crate) fn compose(&self, alarm: &Arc<Alarm>) -> Result<Composed, Error> {
        let (text, path) = (self.text.clone(), self.path.clone());
        let registry = self.registry(alarm);
        let scene = match &self.case {
            Some(case) => Composed::case_from_toml(text, path, case, &registry),
            None => Composed::from_toml(text, path, &registry),
        }?;
        let mut functions = self.functions.iter();
        functions.try_fold(scene, |scene, function| function.add_to(scene, alarm))
    }

    /// Checks that the results in a folder would not take the place of the scene file.
    pub(crate) fn keep_file(&self, folder: &Path) -> Result<(), Error> {
        if self.is_file {
            ResultFolder::new(folder).keep_scene(&self.path)
        } else {
            Ok(())
        }
    }

    /// What names of the scene mean; the alarm is raised by an exception of a law.
    fn registry(&self, alarm: &Arc<Alarm>) -> Registry {
        laws::register(self.registry.clone(), &self.laws, alarm)
    }

    /// The path of the scene file and what its names mean, for a study.
    fn for_study(&self, py: Python<'_>, alarm: &Arc<Alarm>) -> PyResult<(PathBuf, Registry)> {
        let reason = match (self.is_file, &self.case) {
            (false, _) => {
                "a study needs a scene file, from which another one can continue: write `scene.text` to a file, and its meshes and records"
            }
            (true, Some(_)) => "a study needs the whole scene file: leave out the case",
            (true, None) if !self.functions.is_empty() => {
                "a study has no loads or fields of functions: it reads the scene file"
            }
            (true, None) => return Ok((self.path.clone(), self.registry(alarm))),
        };
        Err(exception(py, "InputError", reason))
    }
}

/// A law in Python: name, function, history variables (name and unit), whether it uses locations, version.
type LawArguments = (String, Py<PyAny>, Vec<(String, String)>, bool, String);

/// Laws in Python under names that are not those of the software.
fn own_laws(py: Python<'_>, laws: Vec<LawArguments>, known: &Registry) -> PyResult<Vec<Law>> {
    let laws = laws
        .into_iter()
        .map(|(name, function, history, locations, version)| {
            if known.law_names().any(|known| known == name) {
                let message =
                    format!("laws: '{name}' is a law of the software; choose another name");
                return Err(exception(py, "InputError", &message));
            }
            Ok(Law::new(name, (function, version), history, locations))
        });
    laws.collect()
}

/// A scene: text in TOML, mesh and records.
#[pyclass(frozen, module = "powerhouse_fe._core")]
pub(crate) struct Scene {
    source: Source,
    title: String,
    duration: f64,
    folder: PathBuf,
    cases: Vec<String>,
    threads: Option<usize>,
    mesh: Arc<powerhouse::model::Mesh>,
}

impl Scene {
    fn new(source: Source, composed: &Composed) -> Self {
        Self {
            title: composed.title().to_owned(),
            duration: composed.duration(),
            folder: composed.result_folder(),
            cases: composed.case_names().to_vec(),
            threads: composed.threads(),
            mesh: composed.mesh().clone(),
            source,
        }
    }

    /// The same scene with one more function.
    fn with(&self, function: Function) -> Self {
        let mut source = self.source.clone();
        source.functions.push(function);
        Self {
            source,
            title: self.title.clone(),
            duration: self.duration,
            folder: self.folder.clone(),
            cases: self.cases.clone(),
            threads: self.threads,
            mesh: self.mesh.clone(),
        }
    }
}

#[pymethods]
impl Scene {
    /// The scene of a file, or a case of it.
    #[staticmethod]
    fn from_file(
        py: Python<'_>,
        path: PathBuf,
        case: Option<String>,
        laws: Vec<LawArguments>,
    ) -> PyResult<Self> {
        let registry = powerhouse_wang_2019::registry();
        let laws = own_laws(py, laws, &registry)?;
        let all = laws::register(registry.clone(), &laws, &Arc::default());
        let found = wait_for(py, || {
            let composed = match &case {
                Some(case) => Composed::case_from_file_with(&path, case, &all),
                None => Composed::from_file_with(&path, &all),
            }?;
            let text = composed.source().map(|source| source.text.clone());
            let source = Source {
                text: text.unwrap_or_default(),
                path: path.clone(),
                case: case.clone(),
                registry: registry.clone(),
                functions: Vec::new(),
                laws: laws.clone(),
                is_file: true,
            };
            Ok::<_, Error>(Self::new(source, &composed))
        })?;
        found.map_err(|error| fault::of(py, &error))
    }
    /// The scene of a text in TOML, with paths relative to the folder of `path`, a mesh in place of a file, and records in
    /// place of files: path, time step (s), accelerations (m/s2).
    #[staticmethod]
    fn from_text(
        py: Python<'_>,
        text: String,
        path: PathBuf,
        case: Option<String>,
        mesh: Option<PyRef<'_, Mesh>>,
        records: Vec<(PathBuf, f64, PyReadonlyArray1<'_, f64>)>,
        laws: Vec<LawArguments>,
    ) -> PyResult<Self> {
        let mut registry = powerhouse_wang_2019::registry();
        let laws = own_laws(py, laws, &registry)?;
        if let Some(mesh) = mesh {
            let mesh = mesh.mesh.clone();
            registry.add_mesh_generator(ARRAYS, move |_: &Path| {
                Ok::<_, Error>(powerhouse::model::Mesh::clone(&mesh))
            });
        }
        for (path, step, values) in records {
            let samples = values.as_array().to_vec();
            let history = TimeHistory::new(step, samples).map_err(|error| {
                let message = format!("record '{}': {error}", path.display());
                exception(py, "InputError", &message)
            })?;
            registry.add_record(path, history);
        }
        let source = Source {
            text,
            path,
            case,
            registry,
            functions: Vec::new(),
            laws,
            is_file: false,
        };
        let found = wait_for(py, || {
            let composed = source.compose(&Arc::default())?;
            Ok::<_, Error>(Self::new(source.clone(), &composed))
        })?;
        found.map_err(|error| fault::of(py, &error))
    }
    /// The title.
    #[getter]
    fn title(&self) -> &str {
        &self.title
    }
    /// The text in TOML, to which lines and columns of messages refer.
    #[getter]
    fn text(&self) -> &str {
        &self.source.text
    }
    /// Path of the file, or that under which the text was given.
    #[getter]
    fn path(&self) -> String {
        text_of(&self.source.path)
    }
    /// Name of the case that the scene is, if any.
    #[getter]
    fn case(&self) -> Option<&str> {
        self.source.case.as_deref()
    }
    /// Names of the cases.
    #[getter]
    fn cases(&self) -> Vec<String> {
        self.cases.clone()
    }
    /// Duration of the dynamic run (s).
    #[getter]
    fn duration(&self) -> f64 {
        self.duration
    }
    /// Folder into which the command would write the results.
    #[getter]
    fn folder(&self) -> String {
        text_of(&self.folder)
    }
    /// The mesh.
    #[getter]
    fn mesh(&self) -> Mesh {
        Mesh {
            mesh: self.mesh.clone(),
        }
    }
    /// Checks the scene.
    fn check(&self, py: Python<'_>) -> PyResult<Check> {
        let (source, alarm) = (self.source.clone(), Arc::new(Alarm::default()));
        let found = wait_for(py, || {
            let scene = source.compose(&alarm)?;
            Ok::<_, Failure>(powerhouse_study::check(scene)?)
        })?;
        if let Some(error) = alarm.take() {
            return Err(error);
        }
        match found {
            Ok(report) => Ok(Check::new(&report)),
            Err(failure) => Err(failure.exception(py)),
        }
    }
    /// Runs the scene and returns its results; writes files if there is a folder.
    fn run(
        &self,
        py: Python<'_>,
        folder: Option<PathBuf>,
        progress: Option<Py<PyAny>>,
        threads: Option<usize>,
        checkpoint_every: Option<String>,
        restart: bool,
    ) -> PyResult<Results> {
        let checkpoint_every = interval(checkpoint_every.as_deref())
            .map_err(|message| exception(py, "InputError", &message))?;
        let order = Order {
            source: self.source.clone(),
            folder,
            threads,
            checkpoint_every,
            restart,
        };
        run(py, order, progress)
    }
    /// The scene with forces (N) at the nodes of a set that a function of time (s) and positions (m) returns.
    fn with_load(&self, py: Python<'_>, set: String, function: Py<PyAny>) -> PyResult<Self> {
        if let Err(error) = self.mesh.nodes_of_set(&set) {
            return Err(exception(py, "InputError", &error.to_string()));
        }
        let function = Arc::new(function);
        Ok(self.with(Function::Load { set, function }))
    }
    /// The scene in a free field in a medium (Pa, 1, kg/m3) that a function of time (s) and points (m) returns.
    fn with_field(
        &self,
        py: Python<'_>,
        function: Py<PyAny>,
        young: f64,
        poisson: f64,
        density: f64,
    ) -> PyResult<Self> {
        let medium = ElasticMedium::new(young, poisson, density)
            .map_err(|error| exception(py, "InputError", &error.to_string()))?;
        let function = Arc::new(function);
        Ok(self.with(Function::Field { medium, function }))
    }
    /// Runs the cases of the scene file; returns the folder of the results and the names of the cases.
    fn sweep(
        &self,
        py: Python<'_>,
        folder: Option<PathBuf>,
        cases: Option<Vec<String>>,
        duration: Option<f64>,
        jobs: usize,
        checkpoint_every: Option<String>,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<(String, Vec<String>)> {
        let refused = |message: String| exception(py, "InputError", &message);
        let jobs = NonZeroUsize::new(jobs)
            .ok_or_else(|| refused("jobs: found 0, expected 1 or more".into()))?;
        let order = SweepOrder {
            folder,
            cases,
            duration,
            jobs,
            checkpoint_every: interval(checkpoint_every.as_deref()).map_err(refused)?,
        };
        let alarm = Arc::new(Alarm::default());
        let of_file = self.source.for_study(py, &alarm)?;
        studies::sweep(py, of_file, order, &alarm, callback.as_ref())
    }
    /// Makes the trade study of the scene file.
    fn trade(
        &self,
        py: Python<'_>,
        folder: Option<PathBuf>,
        goal: (Option<f64>, Option<f64>),
        reference: String,
        window: Option<f64>,
        quantities: Option<Vec<String>>,
        factors: Option<Vec<String>>,
        every_history: bool,
        every_combination: bool,
        mesh: bool,
        checkpoint_every: Option<String>,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<Trade> {
        let refused = |message: String| exception(py, "InputError", &message);
        let quantities = quantities.map(|names| {
            let names = names.iter();
            names.map(|name| TradeOrder::quantity(name)).collect()
        });
        let order = TradeOrder {
            folder,
            goal: TradeOrder::goal(goal.0, goal.1).map_err(refused)?,
            reference: TradeOrder::reference(&reference).map_err(refused)?,
            window,
            quantities: quantities.transpose().map_err(refused)?,
            factors,
            every_history,
            every_combination,
            mesh,
            checkpoint_every: interval(checkpoint_every.as_deref()).map_err(refused)?,
        };
        let alarm = Arc::new(Alarm::default());
        let of_file = self.source.for_study(py, &alarm)?;
        studies::trade(py, of_file, order, &alarm, callback.as_ref())
    }
    /// Starts a run that waits at every step, or at every one of some steps.
    fn simulation(
        &self,
        py: Python<'_>,
        folder: Option<PathBuf>,
        every: u64,
        threads: Option<usize>,
        restart: bool,
    ) -> PyResult<Steps> {
        if every == 0 {
            let message =
                "every: found 0, expected 1 or more, the number of steps from one to the next";
            return Err(exception(py, "InputError", message));
        }
        let order = Order {
            source: self.source.clone(),
            folder,
            threads: threads.or(self.threads),
            checkpoint_every: None,
            restart,
        };
        let counts = (self.mesh.node_count(), self.mesh.element_count());
        Ok(Steps::start(order, every, counts))
    }
}

/// The keys of a scene as text in TOML.
#[pyfunction]
pub(crate) fn toml_of(keys: &Bound<'_, PyDict>) -> PyResult<String> {
    crate::keys::text(keys)
}
