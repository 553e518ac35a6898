//! A cube of ground under a free surface that one plane wave crosses, for examples of the free field.

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
use crate::prices::Priced;

/// Edge of the cube (m).
pub const EDGE: f64 = 1200.0;

/// What a run of the cube leaves to choose.
#[derive(Clone, Debug)]
pub struct Choices {
    /// Bricks along an edge.
    pub elements: usize,
    /// Their kernel; the default of bricks without one.
    pub kernel: Option<SolidKernel>,
    /// The number format.
    pub precision: Precision,
    /// The step, as a share of the stable one.
    pub step: f64,
    /// The boundary on all faces but the surface.
    pub boundary: ViscousSpring,
}

impl Default for Choices {
    /// 40 bricks along an edge, and what scenes have by default.
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

/// One incident wave.
#[derive(Clone)]
pub struct BlockWave {
    /// Its kind.
    pub kind: WaveKind,
    /// Its angle from the vertical, and that of its course about it (degrees).
    pub incidence: f64,
    /// See `incidence`.
    pub azimuth: f64,
    /// Its displacement (m) at the corner that it hits first.
    pub signal: Arc<dyn Signal>,
    /// When the run starts and how long it lasts (s).
    pub start: f64,
    /// See `start`.
    pub duration: f64,
    /// How it starts.
    pub initial: InitialMotion,
}

impl BlockWave {
    /// A wave whose pulse begins after the run, from rest.
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

    /// The relative L2 error of the displacement at the centre of the surface over the whole run, and
    /// what the run took.
    ///
    /// # Errors
    /// What keeps the scene from running.
    pub fn run(&self, choices: &Choices) -> Outcome<Priced> {
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
        for (row, &time) in results.histories.times.iter().enumerate() {
            let mut exact = [FieldMotion::default()];
            sampler.add_motion(time, &mut exact);
            for (axis, column) in results.histories.columns.iter().enumerate() {
                let exact = exact[0].displacement[axis];
                difference += (column.values[row] - exact).powi(2);
                reference += exact.powi(2);
            }
        }
        let error = f64::sqrt(difference / reference);
        Ok(Priced { error, seconds })
    }
}
