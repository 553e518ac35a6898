//! A scene: everything that a run needs, composed from names or from Rust.

mod body;
mod boundary;
mod file;
mod joints;
mod medium;
mod memory;
mod mirror;
mod prepare;
mod region;
mod rim;
mod soundness;
mod spans;
mod surroundings;

pub(crate) use body::Piece;
pub use boundary::Boundary;
pub(crate) use file::read_text;
pub use memory::LawMemory;
pub use mirror::{Mirror, MirrorError, Parity};
pub(crate) use prepare::field_motion;
pub use region::RegionError;
pub(crate) use spans::{NOT_AT_REST, SceneSpans, StageSpans};
pub(crate) use surroundings::box_corners;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use powerhouse_contact::JointSurface;
use powerhouse_explicit_core::{Leapfrog, PeriodicPairs, Precision, Prescribed, Support};
use powerhouse_model::{
    Constraint, ContactLaw, IncidentField, Mesh, ModelError, NodalLoad, TimeFunction,
    TimeIntegrator, Vec3,
};

use powerhouse_wavefield::{PlaneWave, Superposition, TimeHistory};

use crate::acting::{SharedFunction, StagedLoad};
use crate::output::{OutputPlan, ResultFolder};
use crate::{Error, InSituStress, Part, Remark, SceneBolts, SceneJoint, SceneStage, SceneText};

/// Nodes with prescribed motion, shared by all models of a scene.
pub(crate) struct PrescribedMotion {
    pub(crate) nodes: Vec<u32>,
    pub(crate) direction: Vec3,
    pub(crate) displacement: SharedFunction,
}

impl From<Prescribed> for PrescribedMotion {
    fn from(prescribed: Prescribed) -> Self {
        Self {
            nodes: prescribed.nodes,
            direction: prescribed.direction,
            displacement: prescribed.displacement.into(),
        }
    }
}

/// Time step of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeStep {
    /// Stable step times this factor, above 0 and at most 1.
    OfStable(f64),
    /// Given step (s); an error if it is above the stable step.
    Seconds(f64),
}

/// Tolerance of the energy balance of a run: relative residual above which it stops, over the largest energy stored or
/// put in until then.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ResidualLimit {
    /// Default of the precision: 1e-7 in double, 1e-4 in mixed, 1e-2 in single.
    #[default]
    OfPrecision,
    /// Given tolerance, above 0 and at most 1.
    Share(f64),
    /// No check: the balance is computed only if energies are recorded, and never stops the run.
    Unchecked,
}

/// Initial motion of the body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InitialMotion {
    /// Zero displacement and velocity.
    #[default]
    Rest,
    /// Motion of the free field at the start.
    Field,
}

/// Everything that a run needs: a mesh, its parts, what acts on it, and what is wanted of it.
///
/// A scene is read from a file ([`Scene::from_file`]) or composed here; both give the same type.
/// ```
/// use powerhouse::boundary::ViscousSpring;
/// use powerhouse::material::{LinearElastic, media};
/// use powerhouse::model::{Mesh, Vec3};
/// use powerhouse::wavefield::{PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind};
/// use powerhouse::{Boundary, Material, Part, Scene};
/// use std::sync::Arc;
///
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(400.0), [4, 4, 4], "rock")?;
/// let pulse = Arc::new(SmoothPulse::new(0.01, 0.8)?);
/// let wave = PlaneWave::new(PlaneWaveParameters::vertical(WaveKind::P, media::ROCK, 400.0), pulse)?;
/// let scene = Scene::new("box", mesh)
///     .part(Part::new("rock", Material::from(LinearElastic::new(media::ROCK))))
///     .field(wave)
///     .boundary(Boundary::new(
///         ViscousSpring::default(),
///         ["left", "right", "front", "back", "bottom"],
///     ).scatterer(Vec3::new(200.0, 200.0, 400.0)))
///     .duration(0.2);
/// let mut simulation = scene.prepare()?;
/// assert!(simulation.stable_step()?.step > 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Scene {
    pub(crate) title: String,
    pub(crate) mesh: Arc<Mesh>,
    pub(crate) parts: Vec<Part>,
    pub(crate) field: Option<Arc<dyn IncidentField>>,
    /// Plane waves whose sum is the field, if the field is such a sum.
    pub(crate) waves: Vec<PlaneWave>,
    pub(crate) boundary: Option<Boundary>,
    pub(crate) supports: Vec<Support>,
    pub(crate) mirrors: Vec<Mirror>,
    pub(crate) periodic: Vec<PeriodicPairs>,
    pub(crate) prescribed: Vec<PrescribedMotion>,
    pub(crate) loads: Vec<StagedLoad>,
    pub(crate) weights: Vec<(Vec3, SharedFunction)>,
    pub(crate) constraints: Vec<Box<dyn Constraint>>,
    pub(crate) joints: Vec<SceneJoint>,
    pub(crate) in_situ_stress: Option<InSituStress>,
    pub(crate) bolts: Vec<SceneBolts>,
    pub(crate) stages: Vec<SceneStage>,
    pub(crate) duration: f64,
    pub(crate) start: f64,
    pub(crate) initial: InitialMotion,
    pub(crate) step: TimeStep,
    pub(crate) integrator: Box<dyn TimeIntegrator>,
    pub(crate) precision: Precision,
    pub(crate) residual: ResidualLimit,
    pub(crate) threads: Option<usize>,
    pub(crate) magnitudes_allowed: bool,
    pub(crate) output: OutputPlan,
    pub(crate) self_check: Option<f64>,
    pub(crate) remarks: Vec<Remark>,
    pub(crate) records: BTreeMap<String, TimeHistory>,
    pub(crate) source: Option<Arc<SceneText>>,
    pub(crate) places: SceneSpans,
    pub(crate) directory: Option<PathBuf>,
    /// Names of the cases in the scene file.
    pub(crate) cases: Vec<String>,
    pub(crate) cases_on_request: Vec<String>,
    /// Name of the case that the scene is, if any.
    pub(crate) case: Option<String>,
}

impl Scene {
    /// Scene of a mesh without parts, waves or loads: duration one second, leapfrog scheme, double precision.
    pub fn new(title: impl Into<String>, mesh: Mesh) -> Self {
        Self {
            title: title.into(),
            mesh: Arc::new(mesh),
            parts: Vec::new(),
            field: None,
            waves: Vec::new(),
            boundary: None,
            supports: Vec::new(),
            mirrors: Vec::new(),
            periodic: Vec::new(),
            prescribed: Vec::new(),
            loads: Vec::new(),
            weights: Vec::new(),
            constraints: Vec::new(),
            joints: Vec::new(),
            in_situ_stress: None,
            bolts: Vec::new(),
            stages: Vec::new(),
            duration: 1.0,
            start: 0.0,
            initial: InitialMotion::Rest,
            step: TimeStep::OfStable(1.0),
            integrator: Box::new(Leapfrog),
            precision: Precision::F64,
            residual: ResidualLimit::OfPrecision,
            threads: None,
            magnitudes_allowed: false,
            output: OutputPlan::default(),
            self_check: None,
            remarks: Vec::new(),
            records: BTreeMap::new(),
            source: None,
            places: SceneSpans::default(),
            directory: None,
            cases: Vec::new(),
            cases_on_request: Vec::new(),
            case: None,
        }
    }
    /// Adds a part; every element of the mesh must belong to exactly one.
    #[must_use]
    pub fn part(mut self, part: Part) -> Self {
        self.parts.push(part);
        self
    }
    /// Sets the motion of the site without the structure.
    #[must_use]
    pub fn field(mut self, field: impl IncidentField + 'static) -> Self {
        self.field = Some(Arc::new(field));
        self.waves.clear();
        self
    }
    /// The same for the sum of plane waves, which studies of the scene then know one by one.
    ///
    /// # Errors
    /// No wave, or waves in different media.
    pub fn plane_waves(mut self, waves: Vec<PlaneWave>) -> Result<Self, Error> {
        let fields = waves.iter().cloned();
        let fields = fields.map(|wave| Box::new(wave) as Box<dyn IncidentField>);
        let sum = Superposition::new(fields.collect()).map_err(ModelError::from)?;
        self.field = Some(Arc::new(sum));
        self.waves = waves;
        Ok(self)
    }
    /// The same for a field that another scene has too.
    #[must_use]
    pub fn shared_field(mut self, field: Arc<dyn IncidentField>) -> Self {
        self.field = Some(field);
        self.waves.clear();
        self
    }
    /// Sets where the mesh ends.
    #[must_use]
    pub fn boundary(mut self, boundary: Boundary) -> Self {
        self.boundary = Some(boundary);
        self
    }
    /// Adds nodes that are held.
    #[must_use]
    pub fn support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }
    /// Adds a symmetry plane, at which half of the body is modelled.
    #[must_use]
    pub fn mirror(mut self, mirror: Mirror) -> Self {
        self.supports.extend(mirror.supports());
        self.mirrors.push(mirror);
        self
    }
    /// Adds nodes that move as one.
    #[must_use]
    pub fn periodic(mut self, pairs: PeriodicPairs) -> Self {
        self.periodic.push(pairs);
        self
    }
    /// Adds nodes whose motion is given.
    #[must_use]
    pub fn prescribed(mut self, prescribed: Prescribed) -> Self {
        self.prescribed.push(prescribed.into());
        self
    }
    /// Adds a load.
    #[must_use]
    pub fn load(mut self, load: impl NodalLoad + 'static) -> Self {
        self.loads.push(StagedLoad::new(Box::new(load), None));
        self
    }
    /// Adds a temporary load that a stage, given by name, removes. Its removal is applied in the increments of that
    /// stage, multiplied by the release factor. It does not act in the dynamic run.
    #[must_use]
    pub fn temporary_load(
        mut self,
        load: impl NodalLoad + 'static,
        removed_in: impl Into<String>,
    ) -> Self {
        let removed_in = Some(removed_in.into());
        (self.loads).push(StagedLoad::new(Box::new(load), removed_in));
        self
    }
    /// Adds gravity: an acceleration of all masses (m/s2), multiplied by a function of time.
    #[must_use]
    pub fn gravity(mut self, acceleration: Vec3, history: impl TimeFunction + 'static) -> Self {
        self.weights.push((acceleration, Arc::new(history)));
        self
    }
    /// Adds a joint with a unique name. Joints with common nodes are solved together.
    #[must_use]
    pub fn joint(mut self, joint: SceneJoint) -> Self {
        self.joints.push(joint);
        self
    }
    /// Adds a condition that corrects predicted velocities.
    #[must_use]
    pub fn constraint(mut self, constraint: impl Constraint + 'static) -> Self {
        self.constraints.push(Box::new(constraint));
        self
    }
    /// Sets the stress of the ground before the first stage.
    #[must_use]
    pub fn in_situ_stress(mut self, stress: InSituStress) -> Self {
        self.in_situ_stress = Some(stress);
        self
    }
    /// Adds a bolt group, which a stage installs.
    #[must_use]
    pub fn bolts(mut self, bolts: SceneBolts) -> Self {
        self.bolts.push(bolts);
        self
    }
    /// Adds a stage through which the body goes before it moves, after those that it has.
    #[must_use]
    pub fn stage(mut self, stage: SceneStage) -> Self {
        self.stages.push(stage);
        self
    }
    /// Sets how long the run lasts (s).
    #[must_use]
    pub fn duration(mut self, duration: f64) -> Self {
        self.duration = duration;
        self
    }
    /// Sets the time at which the run starts (s), and how.
    #[must_use]
    pub fn start(mut self, time: f64, motion: InitialMotion) -> Self {
        (self.start, self.initial) = (time, motion);
        self
    }
    /// Sets the time step.
    #[must_use]
    pub fn step(mut self, step: TimeStep) -> Self {
        self.step = step;
        self
    }
    /// Sets the scheme.
    #[must_use]
    pub fn integrator(mut self, integrator: impl TimeIntegrator + 'static) -> Self {
        self.integrator = Box::new(integrator);
        self
    }
    /// Sets the number format.
    #[must_use]
    pub fn precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }
    /// Sets the residual of the energy balance at which a run stops.
    #[must_use]
    pub fn energy_residual(mut self, limit: ResidualLimit) -> Self {
        self.residual = limit;
        self
    }
    /// Computes with so many threads instead of all, at most those of the machine; the bits of results do
    /// not depend on it.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }
    /// Sets what is recorded.
    #[must_use]
    pub fn output(mut self, output: OutputPlan) -> Self {
        self.output = output;
        self
    }

    /// Sets the largest permitted error of the free field, which the command `powerhouse run` checks
    /// before it runs a scene.
    #[must_use]
    pub fn require_free_field(mut self, error: f64) -> Self {
        self.self_check = Some(error);
        self
    }
    /// Adds a record, so that checks take its frequency content into account; it is not used for the field.
    #[must_use]
    pub fn record(mut self, name: impl Into<String>, history: TimeHistory) -> Self {
        self.records.insert(name.into(), history);
        self
    }
    /// Sets the folder for the files of a run.
    #[must_use]
    pub fn directory(mut self, path: impl Into<PathBuf>) -> Self {
        self.directory = Some(path.into());
        self
    }

    /// The title.
    pub fn title(&self) -> &str {
        &self.title
    }
    /// The mesh.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }
    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }
    /// The motion of the site without the structure.
    pub fn incident_field(&self) -> Option<&Arc<dyn IncidentField>> {
        self.field.as_ref()
    }
    /// The plane waves that it is the sum of; none if it is given otherwise.
    pub fn incident_waves(&self) -> &[PlaneWave] {
        &self.waves
    }
    /// Where the mesh ends.
    pub fn absorbing_boundary(&self) -> Option<&Boundary> {
        self.boundary.as_ref()
    }
    /// How long the run lasts (s).
    pub fn run_duration(&self) -> f64 {
        self.duration
    }
    /// The time at which it starts (s).
    pub fn start_time(&self) -> f64 {
        self.start
    }
    /// Threads that compute; all if none.
    pub fn thread_count(&self) -> Option<usize> {
        self.threads
    }
    /// How the body moves then.
    pub fn initial_motion(&self) -> InitialMotion {
        self.initial
    }
    /// The number format.
    pub fn number_format(&self) -> Precision {
        self.precision
    }
    /// Nodes that are held.
    pub fn supports(&self) -> &[Support] {
        &self.supports
    }
    /// Nodes that move as one.
    pub fn periodic_pairs(&self) -> &[PeriodicPairs] {
        &self.periodic
    }
    /// The stages through which the body goes before it moves.
    pub fn stages(&self) -> &[SceneStage] {
        &self.stages
    }
    /// Whether a field, a load, a weight or a prescribed motion acts on it.
    pub fn is_driven(&self) -> bool {
        self.field.is_some()
            || self.loads.iter().any(|load| load.removed_in.is_none())
            || !self.weights.is_empty()
            || !self.prescribed.is_empty()
    }
    /// Whether forces that last act on it: weight, or what its stages leave.
    pub fn is_loaded_for_good(&self) -> bool {
        !self.weights.is_empty() || !self.stages.is_empty()
    }
    /// What is recorded.
    pub fn output_plan(&self) -> &OutputPlan {
        &self.output
    }
    /// The largest permitted error of the free field, if a run is to check it first.
    pub fn self_check(&self) -> Option<f64> {
        self.self_check
    }
    /// Processed records of the scene file, by name.
    pub fn records(&self) -> &BTreeMap<String, TimeHistory> {
        &self.records
    }
    /// Path and text of the scene file; `None` for a scene composed in Rust.
    pub fn source(&self) -> Option<&Arc<SceneText>> {
        self.source.as_ref()
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
    /// Results folder of a run: as given in the scene, or `results/` with the name of the scene file; a case has a
    /// subfolder of its name.
    pub fn result_folder(&self) -> ResultFolder {
        let named = || {
            let stem = self
                .source
                .as_ref()
                .and_then(|source| source.path.file_stem());
            Path::new("results").join(stem.unwrap_or("scene".as_ref()))
        };
        let folder = self.directory.clone().unwrap_or_else(named);
        ResultFolder::new(match &self.case {
            Some(case) => folder.join(case),
            None => folder,
        })
    }
    /// Names, surfaces and laws of the joints.
    pub fn joints(&self) -> impl Iterator<Item = (&str, &JointSurface, &dyn ContactLaw)> {
        let joints = self.joints.iter();
        joints.map(|joint| (joint.name.as_str(), &joint.surface, joint.law.as_ref()))
    }
    /// What was found while the scene was composed.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }
}
