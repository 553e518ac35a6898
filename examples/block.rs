//! A cube of ground under a free surface with one incident plane wave, for examples of the free field.

use std::sync::Arc;
use std::time::Instant;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::observe::Motion;
use powerhouse::engine::{Precision, SolidKernel};
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, FieldMotion, IncidentField, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, Signal, WaveKind, first_hit_corner,
};
use powerhouse::{Boundary, InitialMotion, Material, OutputPlan, Part, RunHooks, Scene, TimeStep};

use crate::Outcome;
use crate::prices::Measured;

/// Edge of the cube (m).
pub const EDGE: f64 = 1200.0;

/// Numerical options of a run of the cube.
#[derive(Clone, Debug)]
pub struct Choices {
    /// Number of elements along an edge.
    pub elements: usize,
    /// Kernel of the elements; the default kernel if `None`.
    pub kernel: Option<SolidKernel>,
    /// Number format.
    pub precision: Precision,
    /// Time step over the stable step.
    pub step: f64,
    /// Absorbing boundary on all faces but the surface.
    pub boundary: ViscousSpring,
}

impl Default for Choices {
    /// 40 elements along an edge, and the defaults of scenes.
    fn default() -> Self {
        Self {
            elements: 40,
            kernel: None,
            precision: Precision::F64,
            step: 1.0,
            boundary: ViscousSpring::default(),
        }
    }
}

/// Incident plane wave with the window of the run.
#[derive(Clone)]
pub struct BlockWave {
    /// Wave type.
    pub kind: WaveKind,
    /// Angle of incidence from the vertical, and azimuth (degrees).
    pub incidence: f64,
    /// Azimuth (degrees).
    pub azimuth: f64,
    /// Displacement (m) at the corner where the wave arrives first.
    pub signal: Arc<dyn Signal>,
    /// Start time of the run (s).
    pub start: f64,
    /// Duration of the run (s).
    pub duration: f64,
    /// Initial motion.
    pub initial: InitialMotion,
}

impl BlockWave {
    /// A wave whose pulse arrives after the start of the run, from rest.
    pub fn new(kind: WaveKind, incidence: f64, signal: impl Signal + 'static) -> Self {
        Self {
            kind,
            incidence,
            azimuth: 0.0,
            signal: Arc::new(signal),
            start: 0.0,
            duration: 4.0,
            initial: InitialMotion::Rest,
        }
    }

    fn field(&self, medium: ElasticMedium) -> Outcome<PlaneWave> {
        let mut parameters = PlaneWaveParameters::vertical(self.kind, medium, EDGE);
        parameters.incidence = Angle::from_degrees(self.incidence);
        parameters.azimuth = Angle::from_degrees(self.azimuth);
        let direction = parameters.direction();
        parameters.reference = first_hit_corner(&Vec3::zeros(), &Vec3::repeat(EDGE), &direction);
        Ok(PlaneWave::new(parameters, self.signal.clone())?)
    }

    /// Runs the cube and returns the relative L2 error of the displacement at the centre of the surface, with
    /// the wall time.
    ///
    /// # Errors
    /// Any error of the scene or its run.
    pub fn run(&self, choices: &Choices) -> Outcome<Measured> {
        let rock = ElasticMedium::new(10.0e9, 0.3, 3000.0)?;
        let field = self.field(rock)?;
        let centre = Vec3::new(EDGE / 2.0, EDGE / 2.0, EDGE);
        let sampler = field.prepare(&[centre])?;

        let cells = [choices.elements; 3];
        let cube = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(EDGE), cells, "rock")?;
        let mut part = Part::new("rock", Material::from(LinearElastic::new(rock)));
        part.kernel = choices.kernel.map(Into::into);
        let faces = ["left", "right", "front", "back", "bottom"];
        let simulation = Scene::new("free field", cube)
            .part(part)
            .with_boundary(Boundary::new(choices.boundary.clone(), faces).with_scatterer(centre))
            .with_field(field)
            .with_precision(choices.precision)
            .with_step(TimeStep::OfStable(choices.step))
            .with_start_time(self.start)
            .with_initial_motion(self.initial)
            .with_duration(self.duration)
            .with_output(OutputPlan::default().history("surface", centre, Motion::DISPLACEMENT))
            .prepare()?;
        let started = Instant::now();
        let results = simulation.run(RunHooks::default())?;
        let seconds = started.elapsed().as_secs_f64();

        let (mut difference, mut reference) = (0.0, 0.0);
        for (row, &time) in results.histories().times.iter().enumerate() {
            let mut exact = [FieldMotion::default()];
            sampler.add_motion(time, &mut exact);
            for (axis, column) in results.histories().columns.iter().enumerate() {
                let exact = exact[0].displacement[axis];
                difference += (column.values[row] - exact).powi(2);
                reference += exact.powi(2);
            }
        }
        let error = f64::sqrt(difference / reference);
        Ok(Measured { error, seconds })
    }
}
