//! Laws, kernels, boundaries, joint laws, outputs and mesh generators by name.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use powerhouse_elements::PoreWater;
use powerhouse_model::{AbsorbingBoundary, ContactLaw, Engine, Mesh, ModelError};
use powerhouse_observe::HistorySampler;
use powerhouse_wavefield::{KnownLayeredWaves, TimeHistory};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::builtin;
use crate::resolve::pore_water::{PressureKeys, water_pressure};
use crate::spec::{
    At, BoundarySection, JointSection, Material as MaterialTable, OwnOutput, Parameters, SceneSpec,
    WATER_BULK_MODULUS,
};
use powerhouse_laws::Material;
use powerhouse_scene::internal::standard_engine;
use powerhouse_scene::{Fault, Kernel};

/// Constitutive laws, element kernels, absorbing boundaries, joint laws, kinds of output, mesh generators and records in
/// memory by the names that scenes give them.
///
/// A scene keeps the registry that it was read with, so that checks, advice and savings of the scene know the
/// same names; sweeps and trades of a file are given one. A clone shares what is registered.
///
/// ```
/// use powerhouse_laws::Material;
/// use powerhouse_scene_file::Registry;
/// use powerhouse_material_damage::LinearElastic;
/// use powerhouse_model::ElasticMedium;
///
/// /// Rock whose Young's modulus follows from its rating.
/// #[derive(serde::Deserialize, schemars::JsonSchema)]
/// #[serde(deny_unknown_fields)]
/// struct Rated {
///     /// Rock mass rating, 20 to 85.
///     rating: f64,
///     /// Density (kg/m3).
///     density: f64,
/// }
/// let mut registry = Registry::default();
/// registry.add_law("rated-rock", |rated: Rated| {
///     // Serafim and Pereira (1983): E = 10^((RMR - 10) / 40) GPa.
///     let young = 1e9 * 10f64.powf((rated.rating - 10.0) / 40.0);
///     Ok(Material::from(LinearElastic::new(ElasticMedium::new(young, 0.25, rated.density)?)))
/// });
/// assert!(registry.law_names().any(|name| name == "rated-rock"));
/// ```
#[derive(Clone)]
pub struct Registry {
    laws: BTreeMap<String, Entry<Material>>,
    boundaries: BTreeMap<String, Entry<Arc<dyn AbsorbingBoundary>>>,
    kernels: BTreeMap<String, Kernel>,
    joint_laws: BTreeMap<String, Entry<Box<dyn ContactLaw>>>,
    outputs: BTreeMap<String, Entry<OutputKind>>,
    mesh_generators: BTreeMap<String, MeshGenerator>,
    records: BTreeMap<PathBuf, Arc<TimeHistory>>,
    /// Waves of the scenes that were read with these names, for others of the same ground and motion.
    pub(crate) known_waves: KnownLayeredWaves,
    built_in: BuiltIn,
    version: String,
    engine: Arc<dyn Engine>,
    /// Whether a program has set the engine.
    own_engine: bool,
}

/// Names of the boundaries and kernels that come with the software and were not replaced.
#[derive(Clone, Default)]
struct BuiltIn {
    boundaries: BTreeSet<String>,
    kernels: BTreeSet<String>,
}

/// Function from a mesh to the sampler of an output.
pub(crate) type OutputKind =
    Arc<dyn Fn(&Mesh) -> Result<Arc<dyn HistorySampler>, ModelError> + Send + Sync>;
/// Function from a file to a mesh.
type MeshGenerator = Arc<dyn Fn(&Path) -> Result<Mesh, Refusal> + Send + Sync>;
/// Why a mesh generator refuses a file.
type Refusal = Box<dyn std::error::Error + Send + Sync>;

type Build<T> = Arc<dyn Fn(&Parameters) -> Result<T, Fault> + Send + Sync>;

struct Entry<T> {
    build: Build<T>,
    schema: fn(&mut SchemaGenerator) -> Schema,
}

impl<T> Clone for Entry<T> {
    fn clone(&self) -> Self {
        Self {
            build: self.build.clone(),
            schema: self.schema,
        }
    }
}

impl<T> Entry<T> {
    fn new<P, F>(build: F) -> Self
    where
        P: DeserializeOwned + JsonSchema,
        F: Fn(P) -> Result<T, ModelError> + Send + Sync + 'static,
    {
        Self {
            build: Arc::new(move |parameters| {
                build(parameters.decode_by_schema(&toml::Table::new())?)
                    .map_err(|error| placed(parameters, error))
            }),
            schema: P::json_schema,
        }
    }
}

/// Fault of an error at the key whose name it has, or at the whole table.
pub(crate) fn placed(parameters: &Parameters, error: ModelError) -> Fault {
    let key = match &error {
        ModelError::Parameter(parameter) => parameter.name,
        ModelError::Refused { part, .. } => part,
        _ => "",
    };
    let span = parameters.span_of(key);
    match error {
        // The cause begins with the name of the key, or the fault is one of the whole table.
        ModelError::Refused { part, source } if source.to_string().starts_with(&part) => {
            Fault::refused(span, source)
        }
        error => Fault::refused(span, error),
    }
}

impl Default for Registry {
    /// The laws, boundaries, joint laws and kernels that come with the software.
    fn default() -> Self {
        let mut registry = Self {
            laws: BTreeMap::new(),
            boundaries: BTreeMap::new(),
            kernels: BTreeMap::new(),
            joint_laws: BTreeMap::new(),
            outputs: BTreeMap::new(),
            mesh_generators: BTreeMap::new(),
            records: BTreeMap::new(),
            known_waves: KnownLayeredWaves::default(),
            built_in: BuiltIn::default(),
            version: String::new(),
            engine: standard_engine(),
            own_engine: false,
        };
        builtin::register(&mut registry);
        registry.built_in = BuiltIn {
            boundaries: registry.boundaries.keys().cloned().collect(),
            kernels: registry.kernels.keys().cloned().collect(),
        };
        registry
    }
}

impl Registry {
    /// Adds or replaces a constitutive law. `build` converts the keys of a `[[material]]` table into a material; the
    /// type of its argument defines the keys, as [`keys`](powerhouse_model::keys) describes. An error is reported at the key that
    /// [`ParameterError::name`](powerhouse_model::ParameterError::name) or the part of [`ModelError::Refused`] names,
    /// or at the whole table.
    pub fn add_law<P, F>(&mut self, name: impl Into<String>, build: F)
    where
        P: DeserializeOwned + JsonSchema,
        F: Fn(P) -> Result<Material, ModelError> + Send + Sync + 'static,
    {
        self.laws.insert(name.into(), Entry::new(build));
    }
    /// Adds a constitutive law that is built of a table, with the schema of its keys.
    pub(crate) fn add_law_of_table(
        &mut self,
        name: impl Into<String>,
        build: impl Fn(&Parameters) -> Result<Material, Fault> + Send + Sync + 'static,
        schema: fn(&mut SchemaGenerator) -> Schema,
    ) {
        let build = Arc::new(build);
        self.laws.insert(name.into(), Entry { build, schema });
    }
    /// Adds or replaces an absorbing boundary, as [`add_law`](Self::add_law).
    pub fn add_boundary<P, F>(&mut self, name: impl Into<String>, build: F)
    where
        P: DeserializeOwned + JsonSchema,
        F: Fn(P) -> Result<Arc<dyn AbsorbingBoundary>, ModelError> + Send + Sync + 'static,
    {
        let name = name.into();
        self.built_in.boundaries.remove(&name);
        self.boundaries.insert(name, Entry::new(build));
    }
    /// Adds or replaces an element kernel under the name that parts of a scene give.
    pub fn add_kernel(&mut self, name: impl Into<String>, kernel: Kernel) {
        let name = name.into();
        self.built_in.kernels.remove(&name);
        self.kernels.insert(name, kernel);
    }
    /// Adds or replaces a contact law of joints, as [`add_law`](Self::add_law); its keys belong to a `[[joint]]` table.
    pub fn add_joint_law<P, F>(&mut self, name: impl Into<String>, build: F)
    where
        P: DeserializeOwned + JsonSchema,
        F: Fn(P) -> Result<Box<dyn ContactLaw>, ModelError> + Send + Sync + 'static,
    {
        self.joint_laws.insert(name.into(), Entry::new(build));
    }
    /// Adds or replaces a kind of output, which `[[output.own]]` tables of a scene request by their key `kind`. `build` is called
    /// with the keys of the table, as in [`add_law`](Self::add_law), and the mesh; the columns of its sampler are among the
    /// histories of a run, and so in its tables, plots, reports and checkpoints.
    ///
    /// ```
    /// use powerhouse_observe::HistorySampler;
    /// use powerhouse_model::{ModelError, Reach, Selection, StepView};
    /// use powerhouse_scene_file::{Registry, schemars};
    /// use std::sync::Arc;
    /// #[derive(serde::Deserialize, schemars::JsonSchema)]
    /// #[serde(deny_unknown_fields)]
    /// struct SpeedKeys {
    ///     /// Set of the nodes.
    ///     set: String,
    /// }
    /// struct Speed(Vec<u32>);
    /// impl HistorySampler for Speed {
    ///     fn columns(&self) -> Vec<(String, &'static str)> {
    ///         vec![("speed".into(), "m/s")]
    ///     }
    ///     fn reach(&self) -> Reach {
    ///         Reach::NONE.with_nodes(Selection::These(self.0.clone()))
    ///     }
    ///     fn sample(&self, view: &dyn StepView, row: &mut Vec<f64>) -> Result<(), ModelError> {
    ///         let speeds = self.0.iter().map(|&node| view.velocity(node).norm());
    ///         row.push(speeds.fold(0.0, f64::max));
    ///         Ok(())
    ///     }
    /// }
    /// let mut registry = Registry::default();
    /// registry.add_output("greatest-speed", |keys: &SpeedKeys, mesh| {
    ///     let nodes = mesh.nodes_of_set(&keys.set)?;
    ///     Ok(Arc::new(Speed(nodes)) as Arc<dyn HistorySampler>)
    /// });
    /// assert_eq!(registry.output_names().collect::<Vec<_>>(), ["greatest-speed"]);
    /// ```
    pub fn add_output<P, F>(&mut self, kind: impl Into<String>, build: F)
    where
        P: DeserializeOwned + JsonSchema + Send + Sync + 'static,
        F: Fn(&P, &Mesh) -> Result<Arc<dyn HistorySampler>, ModelError> + Send + Sync + 'static,
    {
        let build = Arc::new(build);
        let of_keys = move |keys: P| {
            let build = build.clone();
            Ok(Arc::new(move |mesh: &Mesh| build(&keys, mesh)) as OutputKind)
        };
        self.outputs.insert(kind.into(), Entry::new(of_keys));
    }
    /// Adds or replaces a mesh generator, which builds a mesh from an input file. A scene names both in its `[mesh]` table
    /// (`generator`, `file`); none is built in. `generate` is called when a scene is read, with the path of the file.
    pub fn add_mesh_generator<F, E>(&mut self, name: impl Into<String>, generate: F)
    where
        F: Fn(&Path) -> Result<Mesh, E> + Send + Sync + 'static,
        E: Into<Box<dyn std::error::Error + Send + Sync>>,
    {
        let generate = move |file: &Path| generate(file).map_err(Into::into);
        self.mesh_generators.insert(name.into(), Arc::new(generate));
    }
    /// Adds or replaces a record in memory, an acceleration in m/s2, which is read in place of the file of a path: of what
    /// a `[[record]]` table names as `file`, letter by letter. Keys of the table about the form of a file are then refused
    /// (`time_step`, and `units` other than `m/s2`).
    pub fn add_record(&mut self, file: impl Into<PathBuf>, record: TimeHistory) {
        self.records.insert(file.into(), Arc::new(record));
    }
    /// Sets a text that says which version of its own laws, boundaries and kernels a program registers.
    /// Sweeps and trades repeat finished runs when it changes; they cannot see that the code behind a name
    /// has changed.
    #[must_use]
    pub fn with_version(mut self, version: impl Into<String>) -> Self {
        self.version = version.into();
        self
    }
    /// Version of a program's own laws, boundaries and kernels; empty unless it was set.
    pub fn version(&self) -> &str {
        &self.version
    }
    /// Sets the engine that computes the scenes read with this registry.
    #[must_use]
    pub fn with_engine(mut self, engine: Arc<dyn Engine>) -> Self {
        self.engine = engine;
        self.own_engine = true;
        self
    }
    /// Whether a program has set the engine, in place of the standard one.
    pub(crate) fn has_own_engine(&self) -> bool {
        self.own_engine
    }
    /// The engine that computes the scenes read with this registry, unless they ask for another one.
    pub fn engine(&self) -> &Arc<dyn Engine> {
        &self.engine
    }
    /// Names of the boundaries that were added to, or replace, those of the software.
    pub fn added_boundary_names(&self) -> impl Iterator<Item = &str> {
        let built_in = &self.built_in.boundaries;
        self.boundary_names()
            .filter(|name| !built_in.contains(*name))
    }
    /// Names of the kernels that were added to, or replace, those of the software.
    pub fn added_kernel_names(&self) -> impl Iterator<Item = &str> {
        let built_in = &self.built_in.kernels;
        self.kernel_names().filter(|name| !built_in.contains(*name))
    }
    /// The kernel registered under a name; none if there is none.
    pub fn kernel_named(&self, name: &str) -> Option<&Kernel> {
        self.kernels.get(name)
    }
    /// The boundary of a name with none of its own keys given; none if there is no such boundary, or if it
    /// does not do without keys.
    pub fn boundary_without_keys(&self, name: &str) -> Option<Arc<dyn AbsorbingBoundary>> {
        let entry = self.boundaries.get(name)?;
        (entry.build)(&Parameters::default()).ok()
    }
    /// Names of the keys of a boundary, in rising order, beside those of [every boundary](crate::keys::BOUNDARY); none
    /// if there is no such boundary.
    pub fn boundary_keys(&self, name: &str) -> Option<Vec<String>> {
        let entry = self.boundaries.get(name)?;
        let schema = (entry.schema)(&mut SchemaGenerator::default());
        let properties = schema.get("properties").and_then(Value::as_object);
        let mut keys: Vec<String> =
            properties.map_or(Vec::new(), |map| map.keys().cloned().collect());
        keys.sort_unstable();
        Some(keys)
    }

    /// Names of the constitutive laws.
    pub fn law_names(&self) -> impl Iterator<Item = &str> {
        self.laws.keys().map(String::as_str)
    }
    /// Names of the absorbing boundaries.
    pub fn boundary_names(&self) -> impl Iterator<Item = &str> {
        self.boundaries.keys().map(String::as_str)
    }
    /// Names of the element kernels.
    pub fn kernel_names(&self) -> impl Iterator<Item = &str> {
        self.kernels.keys().map(String::as_str)
    }

    pub(crate) fn material(&self, table: &MaterialTable) -> Result<Material, Fault> {
        let entry = look_up(&self.laws, "law", &table.law)?;
        let material: Material = (entry.build)(&table.parameters)?;
        let Some(given) = &table.pore_water else {
            return Ok(material);
        };
        let bulk_modulus = given
            .bulk_modulus
            .as_ref()
            .map_or(WATER_BULK_MODULUS, |k| k.get());
        let water = PoreWater::new(bulk_modulus, given.porosity.get());
        let water = water.map_err(|error| Fault::refused(given.span(), error))?;
        let keys = PressureKeys::new(&given.level, &given.pressures, given.density);
        let pressure = water_pressure(given.span(), keys)?;
        Ok(material.with_pore_water(match pressure {
            Some(pressure) => water.with_pressure(pressure),
            None => water,
        }))
    }
    pub(crate) fn boundary(
        &self,
        section: &BoundarySection,
    ) -> Result<Arc<dyn AbsorbingBoundary>, Fault> {
        let entry = look_up(&self.boundaries, "boundary", &section.kind)?;
        (entry.build)(&section.parameters)
    }
    pub(crate) fn joint_law(&self, section: &JointSection) -> Result<Box<dyn ContactLaw>, Fault> {
        let entry = look_up(&self.joint_laws, "joint law", &section.law)?;
        (entry.build)(&section.parameters)
    }
    pub(crate) fn output(&self, request: &OwnOutput) -> Result<OutputKind, Fault> {
        let entry = look_up(&self.outputs, "output", &request.kind)?;
        (entry.build)(&request.parameters)
    }
    pub(crate) fn kernel(&self, name: &At<String>) -> Result<&Kernel, Fault> {
        look_up(&self.kernels, "kernel", name)
    }

    pub(crate) fn mesh_generator(&self, name: &At<String>) -> Result<&MeshGenerator, Fault> {
        look_up(&self.mesh_generators, "mesh generator", name)
    }

    pub(crate) fn record(&self, file: &Path) -> Option<&TimeHistory> {
        self.records.get(file).map(Arc::as_ref)
    }

    /// Names of the mesh generators.
    pub fn mesh_generator_names(&self) -> impl Iterator<Item = &str> {
        self.mesh_generators.keys().map(String::as_str)
    }
    /// Names of the kinds of output that a program has added.
    pub fn output_names(&self) -> impl Iterator<Item = &str> {
        self.outputs.keys().map(String::as_str)
    }
    /// Names of the contact laws of joints.
    pub fn joint_law_names(&self) -> impl Iterator<Item = &str> {
        self.joint_laws.keys().map(String::as_str)
    }

    /// JSON schema of scene files, for editors, including the keys of all registered laws and boundaries.
    pub fn schema(&self) -> Schema {
        let mut generator = SchemaGenerator::default();
        let laws = choices(&self.laws, &mut generator);
        let boundaries = choices(&self.boundaries, &mut generator);
        let joint_laws = choices(&self.joint_laws, &mut generator);
        let outputs = choices(&self.outputs, &mut generator);
        let mut root = generator.into_root_schema_for::<SceneSpec>();
        let kernels = json!({ "enum": self.kernels.keys().collect::<Vec<_>>() });
        for (table, key, choices) in [
            ("Material", "law", laws),
            ("BoundarySection", "kind", boundaries),
            ("JointSection", "law", joint_laws),
            ("OwnOutput", "kind", outputs),
        ] {
            if let Some(table) = definition(&mut root, table) {
                open_table(table, key, choices);
            }
        }
        if let Some(kernel) =
            definition(&mut root, "Part").and_then(|part| part.pointer_mut("/properties/kernel"))
        {
            merge(kernel, kernels);
        }
        root.ensure_object()
            .values_mut()
            .for_each(document_variants);
        root
    }
}

fn look_up<'r, T>(
    entries: &'r BTreeMap<String, T>,
    what: &'static str,
    name: &At<String>,
) -> Result<&'r T, Fault> {
    let unknown = || name.unknown(what, entries.keys().cloned().collect());
    entries.get(name.as_str()).ok_or_else(unknown)
}

/// Schema of the keys of each registered entry, by name.
fn choices<T>(
    entries: &BTreeMap<String, Entry<T>>,
    generator: &mut SchemaGenerator,
) -> Vec<(String, Value)> {
    entries
        .iter()
        .map(|(name, entry)| {
            let mut schema = (entry.schema)(generator);
            // Further keys are rejected for the whole table, not for the keys of this entry alone.
            schema.remove("additionalProperties");
            let mut schema = schema.to_value();
            nest(&mut schema);
            (name.clone(), schema)
        })
        .collect()
}

/// Gives the schema of a table the tables within, of which keys are named `table.key`, and leaves keys that follow from
/// others out of the required ones.
fn nest(schema: &mut Value) {
    let keys = schema.get_mut("properties").and_then(Value::as_object_mut);
    let all = keys.map(core::mem::take).unwrap_or_default();
    if let Some(required) = schema.get_mut("required").and_then(Value::as_array_mut) {
        let given = |key: &str| all.get(key).is_some_and(|key| key.get("x-like").is_none());
        required.retain(|key| key.as_str().is_some_and(given));
    }
    for (name, key) in all {
        match name.split_once('.') {
            None => schema["properties"][name] = key,
            Some((table, within)) => {
                let table = &mut schema["properties"][table];
                table["description"] = "Table of the keys below.".into();
                table["additionalProperties"] = false.into();
                table["properties"][within] = key;
            }
        }
    }
}

fn definition<'s>(root: &'s mut Schema, name: &str) -> Option<&'s mut Value> {
    root.pointer_mut(&format!("/$defs/{name}"))
}

/// Makes the permitted keys of a table depend on the value of `key`.
fn open_table(table: &mut Value, key: &str, choices: Vec<(String, Value)>) {
    let names: Vec<&String> = choices.iter().map(|(name, _)| name).collect();
    if let Some(property) = table.pointer_mut(&format!("/properties/{key}")) {
        merge(property, json!({ "enum": names }));
    }
    let conditions: Vec<Value> = choices
        .iter()
        .map(|(name, schema)| json!({ "if": { "properties": { key: { "const": name } } }, "then": schema }))
        .collect();
    merge(
        table,
        json_schema!({ "allOf": conditions, "unevaluatedProperties": false }).to_value(),
    );
}

/// Copies the documentation of an enum variant to its only key, where editors show it.
fn document_variants(schema: &mut Value) {
    if let Some(Value::Array(variants)) = schema.get_mut("oneOf") {
        for variant in variants {
            let Some(description) = variant.get("description").cloned() else {
                continue;
            };
            let properties = variant.get_mut("properties").and_then(Value::as_object_mut);
            if let Some(properties) = properties.filter(|all| all.len() == 1) {
                for key in properties.values_mut().filter_map(Value::as_object_mut) {
                    key.entry("description").or_insert(description.clone());
                }
            }
        }
    }
    match schema {
        Value::Object(fields) => fields.values_mut().for_each(document_variants),
        Value::Array(items) => items.iter_mut().for_each(document_variants),
        _ => {}
    }
}

fn merge(into: &mut Value, from: Value) {
    if let (Value::Object(into), Value::Object(from)) = (into, from) {
        into.extend(from);
    }
}
