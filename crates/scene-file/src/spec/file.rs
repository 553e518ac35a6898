//! Scene files: text and tables, parsed once.

use core::ops::Range;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::former::FormerKey;
use super::node::Node;
use super::{Allowance, At, RecordCase, SceneSpec, decode, former, record_set, survey};
use crate::registry::OutputKind;
use crate::{KeyChange, Registry, resolve};
use powerhouse_laws::Material;
use powerhouse_model::{AbsorbingBoundary, ContactLaw};
use powerhouse_scene::internal::{NamedThing, check_names};
use powerhouse_scene::magnitude::Magnitude;
use powerhouse_scene::{Error, Fault, Problem, SceneFault, SceneText};
use powerhouse_wavefield::{DesignSpectrum, TimeHistory};

/// Largest size of a scene file (bytes).
const LARGEST: u64 = 64 << 20;

/// What a registry makes of the tables of a scene, in their order.
pub(crate) struct Registered {
    pub(crate) materials: Vec<Material>,
    pub(crate) joint_laws: Vec<Box<dyn ContactLaw>>,
    pub(crate) boundary: Option<Arc<dyn AbsorbingBoundary>>,
    pub(crate) outputs: Vec<OutputKind>,
    /// Quantities of the file outside their usual range.
    pub(crate) unusual: Vec<Magnitude>,
}

/// Scene file: its text and its tables, of which every value has its byte range.
///
/// The text is parsed once; the scene and its cases are read from the tables.
///
/// ```no_run
/// use powerhouse_scene_file::{FileScene, Registry, SceneFile};
/// let file = SceneFile::read("data/scenes/cavern_small.toml")?;
/// let mut spec = file.spec(None)?;
/// spec.precision = powerhouse_scene_file::spec::Precision::Mixed;
/// let scene = FileScene::from_spec(spec, &Registry::default())?;
/// # Ok::<(), powerhouse_scene::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SceneFile {
    text: Arc<SceneText>,
    /// Tables as they are written, but for former names of keys, and with the cases of a set of records.
    tables: Arc<Node>,
    /// Cases of a set of records.
    record_cases: Arc<[RecordCase]>,
    former: Arc<[FormerKey]>,
    /// Changes of keys, with which the text was read.
    changes: Vec<String>,
}

impl SceneFile {
    /// Reads and parses a file.
    ///
    /// # Errors
    /// [`Error::Read`] for a file that cannot be read, [`Error::Scene`] for text that is not TOML.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        Self::parse(read_text(path)?, path)
    }
    /// Reads and parses a file with changed keys, those that a case has for itself included.
    ///
    /// # Errors
    /// As [`read`](Self::read); [`Error::KeyChange`] for a change that cannot be made.
    pub fn read_changed(
        path: impl AsRef<Path>,
        case: Option<&str>,
        changes: &[KeyChange],
    ) -> Result<Self, Error> {
        let path = path.as_ref();
        let mut text = read_text(path)?;
        if !changes.is_empty() {
            text = KeyChange::apply(&text, case, changes)?;
        }
        let mut file = Self::parse(text, path)?;
        file.changes = changes.iter().map(ToString::to_string).collect();
        Ok(file)
    }
    /// Parses a text in TOML. `path` is used in messages; paths in the scene are relative to its folder.
    ///
    /// # Errors
    /// [`Error::Scene`] for text that is not TOML, and for a set of records that is none.
    pub fn parse(text: impl Into<String>, path: impl Into<PathBuf>) -> Result<Self, Error> {
        let (text, path) = (text.into(), path.into());
        let text = Arc::new(SceneText { path, text });
        let parse = || {
            let mut tables = Node::parse(&text.text)?;
            let former = former::rename(&mut tables)?;
            let cases = record_set::expand(&mut tables, text.folder())?;
            Ok((Arc::new(tables), former.into(), cases.into()))
        };
        let (tables, former, record_cases) =
            parse().map_err(|fault| SceneFault::new(text.clone(), fault))?;
        Ok(Self {
            text,
            tables,
            record_cases,
            former,
            changes: Vec::new(),
        })
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.text.path
    }
    /// Text of the file, with changed keys.
    pub fn text(&self) -> &Arc<SceneText> {
        &self.text
    }
    /// Changes of keys with which the file was read, each as `KEY=VALUE`.
    pub fn changes(&self) -> &[String] {
        &self.changes
    }
    /// Cases of the set of records, if the scene has one: record by record, each from the least scale to the greatest.
    pub fn record_cases(&self) -> &[RecordCase] {
        &self.record_cases
    }
    /// Keys under former names.
    pub(crate) fn former_keys(&self) -> &[FormerKey] {
        &self.former
    }

    /// The scene, or the scene with the keys that a case of it changes. Keys of laws, joints and boundaries, and names of
    /// sets, are checked when a [`Scene`](powerhouse_scene::Scene) is made of it.
    ///
    /// # Errors
    /// [`Error::Scene`] with file, line and column for an unknown or missing key, or a value of a wrong type or outside its
    /// range; [`Error::NoSuchCase`].
    pub fn spec(&self, case: Option<&str>) -> Result<SceneSpec, Error> {
        let spec = decode::scene(&self.tables, case).map_err(|fault| self.fault(fault));
        let mut spec = spec.map_err(|error| error.in_case(case))?;
        if let (Some(name), None) = (case, spec.case()) {
            let available = spec.cases.iter().map(|case| case.name.to_string());
            let (name, available) = (name.into(), available.collect());
            return Err(Error::NoSuchCase { name, available });
        }
        spec.file = self.clone();
        Ok(spec)
    }

    /// Checks the keys of the scene and of all its cases without mesh and records; returns the scene, or the one of a case,
    /// and what was made of its tables.
    ///
    /// All cases are checked at once, so that a sweep does not fail in its last case after hours.
    ///
    /// # Errors
    /// As [`spec`](Self::spec), and faults that need the registry.
    pub(crate) fn checked(
        &self,
        case: Option<&str>,
        registry: &Registry,
    ) -> Result<(SceneSpec, Registered), Error> {
        let own = self.spec(None)?;
        let checked = self.check(&own, registry);
        let checked = checked.map_err(|fault| self.fault(fault))?;
        let of_case = |name: &str| {
            let spec = self.spec(Some(name))?;
            let registered = spec.registered(registry);
            let registered = registered.map_err(|fault| self.fault(fault).in_case(Some(name)))?;
            Ok::<_, Error>((spec, registered))
        };
        if let Some(name) = case {
            let (spec, registered) = of_case(name)?;
            let unusual = checked.unusual;
            let registered = Registered {
                unusual,
                ..registered
            };
            return Ok((spec, registered));
        }
        for case in &own.cases {
            of_case(&case.name)?;
        }
        Ok((own, checked))
    }

    /// Checks the keys of the scene without mesh and records; returns what was made of its tables.
    ///
    /// # Errors
    /// The first fault with its byte range.
    pub(crate) fn check(&self, spec: &SceneSpec, registry: &Registry) -> Result<Registered, Fault> {
        let allowed = spec.allow.iter().any(|a| **a == Allowance::Magnitudes);
        let unusual = survey::survey(&self.tables)?;
        // Errors of laws are reported before quantities outside their usual range.
        let registered = spec.registered(registry)?;
        if let (Some((magnitude, place)), false) = (unusual.first(), allowed) {
            return Err(Fault::of_magnitude(place.clone(), magnitude.clone()));
        }
        check_cases(spec)?;
        let unusual = unusual.into_iter().map(|(magnitude, _)| magnitude);
        Ok(Registered {
            unusual: unusual.collect(),
            ..registered
        })
    }

    /// A fault with this text.
    pub(crate) fn fault(&self, fault: Fault) -> Error {
        SceneFault::new(self.text.clone(), fault).into()
    }
}

impl SceneSpec {
    /// Names of the files on which the scene depends, such as mesh and records, in the order of its keys: all texts in it
    /// that are the path of a file, as seen from the folder of the scene.
    pub fn named_files(&self) -> Vec<String> {
        let table = self.to_table().unwrap_or_default();
        let mut texts = Vec::new();
        table.values().for_each(|value| texts_in(value, &mut texts));
        let folder = self.file().text().folder();
        texts.retain(|text| folder.join(text).is_file());
        texts
    }
    /// Records of the scene, with their components, as its waves have them: read and processed, without its mesh.
    ///
    /// # Errors
    /// [`Error::Scene`] for a record that cannot be read or processed.
    pub fn processed_records(
        &self,
        registry: &Registry,
    ) -> Result<BTreeMap<String, TimeHistory>, Error> {
        let records = resolve::processed_records(self.file().text(), self, registry);
        records.map_err(|fault| self.file().fault(fault).in_case(self.case()))
    }
    /// Spectrum to which a record of the scene is brought, with the band of periods (s); none for a record without one.
    ///
    /// # Errors
    /// [`Error::Scene`] for a spectrum that is not defined.
    pub fn target_spectrum(
        &self,
        record: &str,
    ) -> Result<Option<(DesignSpectrum, [f64; 2])>, Error> {
        let found = resolve::target_spectrum(self, record);
        found.map_err(|fault| self.file().fault(fault).in_case(self.case()))
    }
    /// Makes laws, boundary and outputs of their tables, and checks the names in others.
    fn registered(&self, registry: &Registry) -> Result<Registered, Fault> {
        let (materials, joints) = (self.materials.iter(), self.joints.iter());
        let (boundary, outputs) = (self.boundary.as_ref(), self.output.own.iter());
        let registered = Registered {
            materials: materials
                .map(|table| registry.material(table))
                .collect::<Result<_, _>>()?,
            joint_laws: joints
                .map(|table| registry.joint_law(table))
                .collect::<Result<_, _>>()?,
            boundary: boundary.map(|table| registry.boundary(table)).transpose()?,
            outputs: outputs
                .map(|table| registry.output(table))
                .collect::<Result<_, _>>()?,
            unusual: Vec::new(),
        };
        self.check_references()?;
        Ok(registered)
    }

    /// Checks that materials and records have names of their own, and that those of parts, layers, stages, waves and motions
    /// are there.
    fn check_references(&self) -> Result<(), Fault> {
        let materials: Vec<&At<String>> = self.materials.iter().map(|m| &m.name).collect();
        let records: Vec<&At<String>> = self.records.iter().map(|record| &record.name).collect();
        for (what, names) in [("material", &materials), ("record", &records)] {
            for (index, name) in names.iter().enumerate() {
                if names[..index].contains(name) {
                    return Err(name.duplicate(what));
                }
            }
        }
        let of_stages = self.stages.iter().flat_map(|stage| &stage.parts);
        let of_parts = (self.parts.iter().map(|part| &part.material))
            .chain(self.layers.iter().map(|layer| &layer.material))
            .chain(of_stages.map(|part| &part.material));
        for name in of_parts {
            known("material", name, name, &materials)?;
        }
        let of_waves = self.waves.iter().filter_map(|wave| wave.record.as_ref());
        for name in of_waves.chain(self.motions.iter().map(|motion| &motion.record)) {
            // A component may follow a point.
            let stem = name
                .rsplit_once('.')
                .map_or(name.as_str(), |(stem, _)| stem);
            let is_whole = records.iter().any(|record| ***record == **name);
            known("record", name, if is_whole { name } else { stem }, &records)?;
        }
        Ok(())
    }
}

/// Checks that a name, or what it begins with, is one of a list.
fn known(
    what: &'static str,
    name: &At<String>,
    wanted: &str,
    names: &[&At<String>],
) -> Result<(), Fault> {
    if names.iter().any(|other| other.as_str() == wanted) {
        return Ok(());
    }
    let mut available: Vec<String> = names.iter().map(|other| other.to_string()).collect();
    available.sort_unstable();
    Err(name.unknown(what, available))
}

/// Checks that the names of cases are unique and valid.
fn check_cases(spec: &SceneSpec) -> Result<(), Fault> {
    let cases = &spec.cases;
    for (index, case) in cases.iter().enumerate() {
        if cases[..index].iter().any(|other| other.name == case.name) {
            return Err(case.name.duplicate("case"));
        }
    }
    let named = cases
        .iter()
        .map(|case| (NamedThing::Case, case.name.as_str()));
    check_names(named).map_err(|(place, error)| {
        let span: Range<usize> = cases[place].name.span();
        Fault::refused(span, error)
    })
}

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

/// Collects all texts in a value.
fn texts_in(value: &toml::Value, texts: &mut Vec<String>) {
    match value {
        toml::Value::String(text) => texts.push(text.clone()),
        toml::Value::Array(items) => items.iter().for_each(|item| texts_in(item, texts)),
        toml::Value::Table(table) => table.values().for_each(|item| texts_in(item, texts)),
        _ => {}
    }
}
