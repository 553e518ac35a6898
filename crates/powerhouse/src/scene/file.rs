//! Reading of scenes from files.

use core::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{InputOverview, ResidualLimit, Scene};
use crate::engine::gpu_engine;
use crate::fault::{Fault, Problem, SceneFault, SceneText};
use crate::format::{Allowance, Case, EngineName, SceneFile};
use crate::magnitude::Magnitude;
use crate::output::{NamedThing, check_names};
use crate::{Error, KeyChange, Registry, SceneRemark, format, resolve};

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
        let path = path.as_ref();
        Self::from_toml(read_text(path)?, path, registry)
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
        let path = path.as_ref();
        let text = KeyChange::apply(&read_text(path)?, choice.case.as_deref(), &choice.changes)?;
        let mut scene = Self::compose(text, path.into(), choice.case.as_deref(), registry)?;
        if !choice.changes.is_empty() {
            scene.changes = choice.changes.iter().map(ToString::to_string).collect();
            let changes = scene.changes.clone();
            scene.remark_once(SceneRemark::ChangedKeys { changes });
        }
        Ok(scene)
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
        let path = path.as_ref();
        Self::compose(read_text(path)?, path.into(), Some(case), registry)
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
        Self::compose(text.into(), path.into(), Some(case), registry)
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
        Self::compose(text.into(), path.into(), None, registry)
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
        let path = path.as_ref();
        let text = KeyChange::apply(&read_text(path)?, None, changes)?;
        let text = Arc::new(SceneText {
            path: path.into(),
            text,
        });
        let refused = |fault| SceneFault::new(text.clone(), fault);
        let keys = Keys::read(&text.text, registry).map_err(refused)?;
        for name in &keys.cases {
            check_case(&text.text, name, registry).map_err(refused)?;
        }
        Ok(keys.cases.len())
    }

    fn compose(
        text: String,
        path: PathBuf,
        case: Option<&str>,
        registry: &Registry,
    ) -> Result<Self, Error> {
        let text = Arc::new(SceneText { path, text });
        let refused = |fault| SceneFault::new(text.clone(), fault);
        let Keys {
            mut file,
            unusual,
            cases,
        } = Keys::read(&text.text, registry).map_err(refused)?;
        if let Some(name) = case {
            if !cases.iter().any(|case| case == name) {
                let (name, available) = (name.into(), cases);
                return Err(Error::NoSuchCase { name, available });
            }
            file = format::decode_case(&text.text, name).map_err(refused)?;
        } else {
            // All cases are checked at once, so that a sweep does not fail in its last case after hours.
            for name in &cases {
                check_case(&text.text, name, registry).map_err(refused)?;
            }
        }
        let mut scene = resolve::compose(&text, &file, registry).map_err(refused)?;
        for former in format::former_keys(&text.text).map_err(refused)? {
            let (table, [former, present]) = (former.table, *former.names);
            scene.remark_once(SceneRemark::FormerKey {
                table,
                former,
                present,
            });
        }
        for (magnitude, _) in unusual {
            scene.remark_once(SceneRemark::Magnitude(magnitude));
        }
        // With the text, faults of the whole scene are reported with line and column.
        let source = Some(text.clone());
        let found = scene.check_magnitudes().and_then(|()| scene.check_names());
        found.map_err(|error| scene.places.put(&source, error))?;
        scene.check_threads();
        scene.input = InputOverview::of(&file, case);
        scene.engine = registry.engine().clone();
        scene.choose_engine(&file, registry).map_err(refused)?;
        scene.directory = file.output.directory;
        scene.cases = cases;
        let on_request = file.cases.iter().filter(|case| case.on_request);
        scene.cases_on_request = on_request.map(|case| case.name.to_string()).collect();
        scene.case = case.map(str::to_owned);
        scene.registry = Some(registry.clone());
        scene.source = Some(text);
        Ok(scene)
    }
}

impl Scene {
    /// Takes the engine that a file asks for. Where it balances no energies, they are neither checked nor recorded, unless the
    /// file asks for it.
    fn choose_engine(&mut self, file: &SceneFile, registry: &Registry) -> Result<(), Fault> {
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

/// Keys of a scene file, checked without its mesh and its records.
struct Keys {
    file: SceneFile,
    /// Numbers outside their usual range, and their places.
    unusual: Vec<(Magnitude, Range<usize>)>,
    /// Names of the cases.
    cases: Vec<String>,
}

impl Keys {
    fn read(text: &str, registry: &Registry) -> Result<Self, Fault> {
        let file = format::decode(text)?;
        let allowed = file.allow.iter().any(|a| **a == Allowance::Magnitudes);
        let unusual = format::survey(text)?;
        // Errors of laws are reported before quantities outside their usual range.
        check_registered(&file, registry)?;
        if let (Some((magnitude, place)), false) = (unusual.first(), allowed) {
            return Err(Fault::of_magnitude(place.clone(), magnitude.clone()));
        }
        let cases = case_names(&file.cases)?;
        Ok(Self {
            file,
            unusual,
            cases,
        })
    }
}

/// Largest size of a scene file (bytes).
const LARGEST: u64 = 64 << 20;

/// Reads the text of a scene or another TOML file.
pub(crate) fn read_text(path: &Path) -> Result<String, Error> {
    let bytes = powerhouse_io::read_whole(path, LARGEST).map_err(|source| Error::Read {
        path: path.into(),
        source,
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let (place, bytes) = (error.utf8_error().valid_up_to(), error.into_bytes());
        let found = match bytes[..] {
            [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "text in UTF-16".to_owned(),
            _ => format!("the byte {:#04x}", bytes[place]),
        };
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let path = path.into();
        let fault = Fault::new(place..place, Problem::Encoding { found });
        SceneFault::new(Arc::new(SceneText { path, text }), fault).into()
    })
}

/// Checks a case without reading mesh or records.
fn check_case(text: &str, name: &str, registry: &Registry) -> Result<(), Fault> {
    check_registered(&format::decode_case(text, name)?, registry)
}

/// Checks the keys of laws and boundaries with the registry.
fn check_registered(file: &SceneFile, registry: &Registry) -> Result<(), Fault> {
    for material in &file.materials {
        registry.material(material)?;
    }
    for joint in &file.joints {
        registry.joint_law(joint)?;
    }
    if let Some(boundary) = &file.boundary {
        registry.boundary(boundary)?;
    }
    Ok(())
}

/// Checks that the names of cases are unique and valid.
fn case_names(cases: &[Case]) -> Result<Vec<String>, Fault> {
    let mut names: Vec<String> = Vec::with_capacity(cases.len());
    for case in cases {
        let name = case.name.to_string();
        if names.contains(&name) {
            let what = "case";
            let problem = Problem::Duplicate { what, name };
            return Err(Fault::new(case.name.span(), problem));
        }
        names.push(name);
    }
    let named = names.iter().map(|name| (NamedThing::Case, name.as_str()));
    check_names(named).map_err(|(place, error)| Fault::refused(cases[place].name.span(), error))?;
    Ok(names)
}
