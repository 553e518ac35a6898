//! A scene: everything that a run needs, composed from names or from Rust.

use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse_contact::JointSurface;
#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    Constraint, ContactLaw, Engine, Mesh, NodalLoad, PeriodicPairs, Precision, Prescribed, Support,
    TimeFunction, TimeIntegrator, Vec3,
};

use powerhouse_wavefield::TimeHistory;

use crate::acting::{SharedFunction, StagedLoad};
use crate::engine::{Leapfrog, standard_engine};
use crate::in_use::InUse;
use crate::{
    Boundary, Error, FibreOptions, InSituStress, Mirror, OutputPlan, Part, Places, Remark,
    SceneBolts, SceneField, SceneJoint, SceneStage, Subject, WaterBeside, places::placed, remark,
};

/// Nodes with prescribed motion, shared by all models of a scene.
pub struct PrescribedMotion {
    /// The nodes (mesh indices).
    pub nodes: Vec<u32>,
    /// Direction of the motion.
    pub direction: Vec3,
    /// Displacement along it (m) as a function of time (s).
    pub displacement: SharedFunction,
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
    /// Share of the stable step (1), above 0 and at most 1.
    OfStable(f64),
    /// Length (s); an error if it is above the stable step.
    Seconds(f64),
}

/// Largest permitted residual of the energy balance, over the largest energy held or put in until then; a run
/// stops above it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ResidualLimit {
    /// Default of the precision: 1e-7 in double, 1e-4 in mixed, 1e-2 in single.
    #[default]
    OfPrecision,
    /// A share above 0 and at most 1.
    Share(f64),
    /// No limit: the balance is not computed unless energies are recorded.
    Unchecked,
}

#[cfg(feature = "keys")]
powerhouse_model::keys::words_or_number! {
    ResidualLimit { "auto" => OfPrecision, "off" => Unchecked, number => Share }
    "\"auto\", \"off\" or a number above 0 and at most 1", |x| x > 0.0 && x <= 1.0,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1 }
}

/// Motion of the body at the start of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "keys", derive(Deserialize, Serialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(rename_all = "kebab-case"))]
pub enum InitialMotion {
    /// Zero displacement and velocity.
    #[default]
    Rest,
    /// Displacement and velocity of the incident field.
    Field,
}

/// Input of a run: a mesh, its parts, boundary conditions, loads, construction stages and output requests.
///
/// `with_x` sets what `x` returns (or adds to it, where `x` is a list under a plural name); a method named by a
/// singular noun adds one item to the list of the plural: [`part`](Self::part) to [`parts`](Self::parts),
/// [`support`](Self::support) to [`supports`](Self::supports).
///
/// ```
/// use powerhouse_boundary::ViscousSpring;
/// use powerhouse_material_damage::{LinearElastic, media};
/// use powerhouse_model::{Mesh, Vec3};
/// use powerhouse_wavefield::{PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind};
/// use powerhouse_scene::{Boundary, Part, Scene};
/// use powerhouse_laws::Material;
/// use std::sync::Arc;
///
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(400.0), [4, 4, 4], "rock")?;
/// let pulse = Arc::new(SmoothPulse::new(0.01, 0.8)?);
/// let wave = PlaneWave::new(PlaneWaveParameters::vertical(WaveKind::P, media::ROCK, 400.0), pulse)?;
/// let scene = Scene::new("box", mesh)
///     .part(Part::new("rock", Material::from(LinearElastic::new(media::ROCK))))
///     .with_field(wave)
///     .with_boundary(Boundary::new(
///         ViscousSpring::default(),
///         ["left", "right", "front", "back", "bottom"],
///     ).with_scatterer(Vec3::new(200.0, 200.0, 400.0)))
///     .with_duration(0.2);
/// let mut simulation = scene.prepare()?;
/// assert!(simulation.stable_step()?.step > 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Scene {
    #[doc(hidden)]
    pub title: String,
    #[doc(hidden)]
    pub mesh: Arc<Mesh>,
    #[doc(hidden)]
    pub parts: Vec<Part>,
    #[doc(hidden)]
    pub field: Option<SceneField>,
    #[doc(hidden)]
    pub boundary: Option<Boundary>,
    #[doc(hidden)]
    pub supports: Vec<Support>,
    #[doc(hidden)]
    pub mirrors: Vec<Mirror>,
    #[doc(hidden)]
    pub periodic: Vec<PeriodicPairs>,
    #[doc(hidden)]
    pub delayed: Option<PeriodicPairs>,
    #[doc(hidden)]
    pub prescribed: Vec<PrescribedMotion>,
    #[doc(hidden)]
    pub loads: Vec<StagedLoad>,
    #[doc(hidden)]
    pub weights: Vec<(Vec3, SharedFunction)>,
    #[doc(hidden)]
    pub waters: Vec<WaterBeside>,
    #[doc(hidden)]
    pub constraints: Vec<Box<dyn Constraint>>,
    #[doc(hidden)]
    pub joints: Vec<SceneJoint>,
    #[doc(hidden)]
    pub in_situ_stress: Option<InSituStress>,
    #[doc(hidden)]
    pub bolts: Vec<SceneBolts>,
    #[doc(hidden)]
    pub stages: Vec<SceneStage>,
    #[doc(hidden)]
    pub duration: f64,
    #[doc(hidden)]
    pub start: f64,
    #[doc(hidden)]
    pub initial: InitialMotion,
    #[doc(hidden)]
    pub step: TimeStep,
    #[doc(hidden)]
    pub fibres: Option<FibreOptions>,
    /// Whether simulations say what fibres cost.
    #[doc(hidden)]
    pub prices_fibres: bool,
    #[doc(hidden)]
    pub integrator: Box<dyn TimeIntegrator>,
    #[doc(hidden)]
    pub precision: Precision,
    #[doc(hidden)]
    pub residual: ResidualLimit,
    #[doc(hidden)]
    pub threads: Option<usize>,
    #[doc(hidden)]
    pub magnitudes_allowed: bool,
    #[doc(hidden)]
    pub in_use: Option<InUse>,
    #[doc(hidden)]
    pub output: OutputPlan,
    #[doc(hidden)]
    pub remarks: Vec<Remark>,
    #[doc(hidden)]
    pub records: BTreeMap<String, TimeHistory>,
    #[doc(hidden)]
    pub record_arrivals: BTreeMap<String, f64>,
    /// Places of its values in what the user wrote.
    #[doc(hidden)]
    pub places: Option<Arc<dyn Places>>,
    #[doc(hidden)]
    pub engine: Arc<dyn Engine>,
}

impl Scene {
    /// Scene of a mesh without parts, waves or loads: from rest at time 0 over one second with the stable step, leapfrog
    /// scheme, double precision, on all threads of the machine.
    pub fn new(title: impl Into<String>, mesh: Mesh) -> Self {
        Self {
            title: title.into(),
            mesh: Arc::new(mesh),
            parts: Vec::new(),
            field: None,
            boundary: None,
            supports: Vec::new(),
            mirrors: Vec::new(),
            periodic: Vec::new(),
            delayed: None,
            prescribed: Vec::new(),
            loads: Vec::new(),
            weights: Vec::new(),
            waters: Vec::new(),
            constraints: Vec::new(),
            joints: Vec::new(),
            in_situ_stress: None,
            bolts: Vec::new(),
            stages: Vec::new(),
            duration: 1.0,
            start: 0.0,
            initial: InitialMotion::Rest,
            step: TimeStep::OfStable(1.0),
            fibres: None,
            prices_fibres: false,
            integrator: Box::new(Leapfrog),
            precision: Precision::F64,
            residual: ResidualLimit::OfPrecision,
            threads: None,
            magnitudes_allowed: false,
            in_use: None,
            output: OutputPlan::default(),
            remarks: Vec::new(),
            records: BTreeMap::new(),
            record_arrivals: BTreeMap::new(),
            places: None,
            engine: standard_engine(),
        }
    }
    /// Sets the engine that computes the scene, in place of the standard one.
    #[must_use]
    pub fn with_engine(mut self, engine: Arc<dyn Engine>) -> Self {
        self.engine = engine;
        self
    }
    /// Adds a part; every solid element of the mesh must belong to exactly one, every bar to at most one.
    #[must_use]
    pub fn part(mut self, part: Part) -> Self {
        self.parts.push(part);
        self
    }
    /// Sets the absorbing boundary: condition, faces, scatterer and region.
    #[must_use]
    pub fn with_boundary(mut self, boundary: Boundary) -> Self {
        self.boundary = Some(boundary);
        self
    }
    /// Adds a support: nodes that are held in some or all directions, in all stages and in the run.
    #[must_use]
    pub fn support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }
    /// Adds a symmetry plane, at which half of the body is modelled, with its supports.
    #[must_use]
    pub fn mirror(mut self, mirror: Mirror) -> Self {
        self.supports.extend(mirror.supports());
        self.mirrors.push(mirror);
        self
    }
    /// Adds pairs of nodes that move as one (periodic boundary conditions).
    #[must_use]
    pub fn with_periodic_pairs(mut self, pairs: PeriodicPairs) -> Self {
        self.periodic.push(pairs);
        self
    }
    /// Adds nodes with a prescribed motion, a displacement along one direction as a function of time; in stages its value
    /// at the start of the run.
    #[must_use]
    pub fn prescribed(mut self, prescribed: Prescribed) -> Self {
        self.prescribed.push(prescribed.into());
        self
    }
    /// Adds a load that acts in all stages, with its value at the start of the run, and in the run.
    #[must_use]
    pub fn load(mut self, load: impl NodalLoad + 'static) -> Self {
        self.loads.push(StagedLoad::new(Box::new(load), None));
        self
    }
    /// Adds a temporary load that acts from the first stage on until another stage, given by name, removes it. Its removal
    /// is applied in the increments of that stage, multiplied by the release factor. It does not act in the dynamic run.
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
    /// Adds gravity: an acceleration of all masses (m/s2), multiplied by a function of time; in stages by its value at the
    /// start of the run.
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
    /// Adds a constraint, which corrects predicted velocities; not permitted in a scene with stages.
    #[must_use]
    pub fn constraint(mut self, constraint: impl Constraint + 'static) -> Self {
        self.constraints.push(Box::new(constraint));
        self
    }
    /// Sets the in-situ stress of the ground before the first stage; the scene needs a stage.
    #[must_use]
    pub fn with_in_situ_stress(mut self, stress: InSituStress) -> Self {
        self.in_situ_stress = Some(stress);
        self
    }
    /// Adds a bolt group, which one stage must install.
    #[must_use]
    pub fn with_bolts(mut self, bolts: SceneBolts) -> Self {
        self.bolts.push(bolts);
        self
    }
    /// Adds a construction stage before the motion, after those that the scene has.
    #[must_use]
    pub fn stage(mut self, stage: SceneStage) -> Self {
        self.stages.push(stage);
        self
    }
    /// Sets the time step of the dynamic run: a share of the stable step, or a length (s).
    #[must_use]
    pub fn with_step(mut self, step: TimeStep) -> Self {
        self.step = step;
        self
    }
    /// Sets the time integration scheme of the dynamic run, such as `Leapfrog` (the default) or `OneSided`.
    #[must_use]
    pub fn with_integrator(mut self, integrator: impl TimeIntegrator + 'static) -> Self {
        self.integrator = Box::new(integrator);
        self
    }
    /// Sets the number format of elements and nodes in the dynamic run; stages are computed in double precision.
    #[must_use]
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }
    /// Sets the largest permitted residual of the energy balance, over the largest energy until then, above which the run
    /// fails.
    #[must_use]
    pub fn with_energy_residual(mut self, limit: ResidualLimit) -> Self {
        self.residual = limit;
        self
    }
    /// Sets the number of threads, at most those of the machine; the bits of results do not depend on it.
    #[must_use]
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }
    /// Sets the output requests, in place of all earlier ones.
    #[must_use]
    pub fn with_output(mut self, output: OutputPlan) -> Self {
        self.output = output;
        self
    }

    /// Adds a record, so that checks take its frequency content into account; it is not used for the field.
    #[must_use]
    pub fn record(mut self, name: impl Into<String>, history: TimeHistory) -> Self {
        self.records.insert(name.into(), history);
        self
    }

    /// The engine that computes the scene.
    pub fn engine(&self) -> &Arc<dyn Engine> {
        &self.engine
    }

    /// The title.
    pub fn title(&self) -> &str {
        &self.title
    }
    /// The mesh.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }
    /// The parts: element sets with their material and kernel.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }
    /// The absorbing boundary; none for a body without.
    pub fn boundary(&self) -> Option<&Boundary> {
        self.boundary.as_ref()
    }
    /// Duration of the run (s).
    pub fn duration(&self) -> f64 {
        self.duration
    }
    /// Time at which the run starts (s).
    pub fn start_time(&self) -> f64 {
        self.start
    }
    /// Number of threads; none for all of the machine.
    pub fn threads(&self) -> Option<usize> {
        self.threads
    }
    /// Motion of the body at the start of the run.
    pub fn initial_motion(&self) -> InitialMotion {
        self.initial
    }
    /// Time step of the run.
    pub fn step(&self) -> TimeStep {
        self.step
    }
    /// Time integration scheme.
    pub fn integrator(&self) -> &dyn TimeIntegrator {
        self.integrator.as_ref()
    }
    /// Largest permitted residual of the energy balance, above which the run fails.
    pub fn energy_residual(&self) -> ResidualLimit {
        self.residual
    }
    /// Stress of the ground before the first stage.
    pub fn in_situ_stress(&self) -> Option<&InSituStress> {
        self.in_situ_stress.as_ref()
    }
    /// Bolts, which stages install.
    pub fn bolts(&self) -> &[SceneBolts] {
        &self.bolts
    }
    /// Symmetry planes, at which half of the body is modelled.
    pub fn mirrors(&self) -> &[Mirror] {
        &self.mirrors
    }
    /// Number format of the elements and nodes.
    pub fn precision(&self) -> Precision {
        self.precision
    }
    /// Supports: nodes that are held in some or all directions.
    pub fn supports(&self) -> &[Support] {
        &self.supports
    }
    /// Pairs of nodes that move as one (periodic boundary conditions).
    pub fn periodic_pairs(&self) -> &[PeriodicPairs] {
        &self.periodic
    }
    /// Construction stages before the motion, in their order.
    pub fn stages(&self) -> &[SceneStage] {
        &self.stages
    }
    /// Whether an incident field, a load that no stage removes, a weight or a prescribed motion acts on the body in the
    /// run, of the scene itself or of a stage.
    pub fn is_driven(&self) -> bool {
        let stays = |loads: &[StagedLoad]| loads.iter().any(|load| load.removed_in.is_none());
        let of_stage = |stage: &SceneStage| stays(&stage.loads) || !stage.weights.is_empty();
        self.field.is_some()
            || stays(&self.loads)
            || !self.weights.is_empty()
            || !self.prescribed.is_empty()
            || self.stages.iter().any(of_stage)
    }
    /// Warning about stages that lack the stress or the weight of the ground.
    pub fn lacking_ground(&self) -> Option<Remark> {
        if self.stages.is_empty() {
            return None;
        }
        let weighs =
            !self.weights.is_empty() || self.stages.iter().any(|stage| !stage.weights.is_empty());
        let loaded = weighs
            || !self.loads.is_empty()
            || !self.prescribed.is_empty()
            || self.stages.iter().any(|stage| !stage.loads.is_empty());
        match &self.in_situ_stress {
            None if !loaded => Some(remark::IdleStages {}.into()),
            Some(stress) if !weighs && stress.grows_with_depth() => {
                Some(remark::WeightlessGround {}.into())
            }
            _ => None,
        }
    }
    /// Sets the places of the values of the scene in what its user wrote, which its errors show.
    #[must_use]
    pub fn with_places(mut self, places: Arc<dyn Places>) -> Self {
        self.places = Some(places);
        self
    }
    /// An error about the scene with its place in what the user wrote, if it is known.
    pub(crate) fn placed(&self, subject: Subject, error: Error) -> Error {
        placed(self.places.as_ref(), subject, error)
    }
    /// Whether permanent forces act on the body: it has weight or construction stages.
    pub fn is_loaded_for_good(&self) -> bool {
        !self.weights.is_empty() || !self.stages.is_empty()
    }
    /// Output requests.
    pub fn output(&self) -> &OutputPlan {
        &self.output
    }
    /// Processed records of the scene file, by name.
    pub fn records(&self) -> &BTreeMap<String, TimeHistory> {
        &self.records
    }
    /// Times of the first sample (s) of the records of the waves at the reference points of these, by name: extensions by
    /// filters and the delay of a quiet start are in them. Of several waves of a record the latest.
    pub fn record_arrivals(&self) -> &BTreeMap<String, f64> {
        &self.record_arrivals
    }
    /// Names, surfaces and laws of the joints.
    pub fn joints(&self) -> impl Iterator<Item = (&str, &JointSurface, &dyn ContactLaw)> {
        let joints = self.joints.iter();
        joints.map(|joint| (joint.name.as_str(), &joint.surface, joint.law.as_ref()))
    }
    /// Remarks and warnings that were found while the scene was composed.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }
}
