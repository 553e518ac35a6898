//! Reading of scenes from files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{InputOverview, ResidualLimit, Scene};
use crate::engine::gpu_engine;
use crate::fault::Fault;
use crate::magnitude::Magnitude;
use crate::spec::{EngineName, SceneFile, SceneSpec};
use crate::{Error, KeyChange, Registry, SceneRemark, resolve};

/// Which scene of a file is read: the scene itself or one of its cases, with changed keys.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneChoice {
    /// Name of a case; none for the scene itself.
    pub case: Option<String>,
    /// Changed keys, in the order in which they are changed.
    pub changes: Vec<KeyChange>,
}

impl Scene {
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
            .and_then(|(spec, unusual)| Self::compose(spec, unusual, registry));
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
            .and_then(|unusual| Self::compose(spec, unusual, registry));
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
        unusual: Vec<Magnitude>,
        registry: &Registry,
    ) -> Result<Self, Error> {
        let file = spec.file();
        let refused = |fault| file.fault(fault);
        let mut scene = resolve::compose(file.text(), &spec, registry).map_err(refused)?;
        scene.changes = file.changes().to_vec();
        scene.places.case = spec.case().map(str::to_owned);
        if !scene.changes.is_empty() {
            let changes = scene.changes.clone();
            scene.remark_once(SceneRemark::ChangedKeys { changes });
        }
        for former in file.former_keys() {
            let (table, [former, present]) = (former.table, *former.names);
            scene.remark_once(SceneRemark::FormerKey {
                table,
                former,
                present,
            });
        }
        for magnitude in unusual {
            scene.remark_once(SceneRemark::Magnitude(magnitude));
        }
        // With the text, faults of the whole scene are reported with line and column.
        let source = Some(file.text().clone());
        let found = scene.check_magnitudes().and_then(|()| scene.check_names());
        found.map_err(|error| scene.places.put(&source, error))?;
        scene.check_threads();
        scene.input = InputOverview::of(&spec);
        scene.engine = registry.engine().clone();
        scene.choose_engine(&spec, registry).map_err(refused)?;
        scene.directory.clone_from(&spec.output.directory);
        let named = |on_request: &dyn Fn(bool) -> bool| {
            let cases = spec.cases.iter().filter(|case| on_request(case.on_request));
            cases.map(|case| case.name.to_string()).collect()
        };
        scene.cases = named(&|_| true);
        scene.cases_on_request = named(&|on_request| on_request);
        scene.case = spec.case().map(str::to_owned);
        scene.registry = Some(registry.clone());
        scene.source = source;
        scene.spec = Some(Arc::new(spec));
        Ok(scene)
    }
}

impl Scene {
    /// Takes the engine that a file asks for. Where it balances no energies, they are neither checked nor recorded, unless the
    /// file asks for it.
    fn choose_engine(&mut self, file: &SceneSpec, registry: &Registry) -> Result<(), Fault> {
        let Some(engine) = (file.engine.as_ref()).filter(|engine| ***engine == EngineName::Gpu)
        else {
            return Ok(());
        };
        if registry.has_own_engine() {
            let reason = "this run has an engine of its own, such as one of several ranks";
            return Err(Fault::refused(engine.span(), reason));
        }
        self.engine = gpu_engine().map_err(|reason| Fault::refused(engine.span(), reason))?;
        if self.engine.balances_energy() {
            return Ok(());
        }
        let reason = "the engine computes no balance of energies";
        if let Some(asked) = &file.output.energies {
            return Err(Fault::refused(asked.span(), reason));
        }
        if let ResidualLimit::Share(_) = self.residual {
            let reason = format!("{reason}, and `energy_residual` asks for its check");
            return Err(Fault::refused(engine.span(), reason));
        }
        (self.output.energies, self.residual) = (None, ResidualLimit::Unchecked);
        let engine = self.engine.name().to_owned();
        self.remark_once(SceneRemark::NoEnergyBalance { engine });
        Ok(())
    }
}
