//! A circular cavity under the surface of a half-space, as a slice in plane strain, for the examples
//! of scattering.

pub mod compare;

use std::sync::Arc;

use powerhouse::boundary::{AxisParameters, DomainReduction, Spreading, ViscousSpring};
use powerhouse::engine::observe::{HistoryTable, Motion, ObservationPoint};
use powerhouse::engine::{Precision, SolidKernel, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{AbsorbingBoundary, ElasticMedium, Mesh, ParameterError, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, Ricker, RickerQuantity, Signal, WaveKind,
};
use powerhouse::{
    Boundary, InitialMotion, Material, OutputPlan, Part, RunHooks, Scene, TimeStep, reduction_layer,
};
use powerhouse_study::OpeningSlice;

use crate::Outcome;

/// Radius a of the cavity (m).
pub const RADIUS: f64 = 2.0;
/// Depth of its centre (m).
pub const DEPTH: f64 = 1.5 * RADIUS;
/// Samples per `a / cs`.
pub const SAMPLES: usize = 10;
/// Stations on the surface: x = a/10 times -40 to 40.
pub const STATIONS: core::ops::RangeInclusive<i32> = -40..=40;
/// Angles on the wall from +x (degrees).
pub const WALL: [i32; 3] = [90, 0, -90];

/// The rock of example 2 of Wang, Chen & Xiao (2019).
///
/// # Errors
/// None: its numbers are in range.
pub fn rock() -> Result<ElasticMedium, ParameterError> {
    ElasticMedium::new(9.0e9, 0.3456, 2750.0)
}

/// Travel time of an S wave along the radius of the cavity (s).
///
/// # Errors
/// None: see [`rock`].
pub fn unit_of_time() -> Result<f64, ParameterError> {
    Ok(RADIUS / rock()?.s_speed())
}

/// Peak of the incident displacement (m).
pub const PEAK: f64 = 1.0e-3;

/// The pulse of the reference, which arrives at the surface at 6 a/cs.
///
/// # Errors
/// None: see [`rock`].
pub fn pulse() -> Outcome<Arc<dyn Signal>> {
    let unit = unit_of_time()?;
    let shape = RickerQuantity::Displacement;
    Ok(Arc::new(Ricker::new(shape, PEAK, 0.25 / unit, 6.0 * unit)?))
}

/// Extent and mesh density of the model; lengths in radii of the cavity.
#[derive(Clone, Copy, Debug)]
pub struct CavityModel {
    /// Element edge around the cavity.
    pub edge: f64,
    /// Longest element edges far to the sides and far below.
    pub far: [f64; 2],
    /// Distance from the cavity to the sides.
    pub half_width: f64,
    /// Distance from the surface to the bottom.
    pub height: f64,
    /// Coefficient B of the boundary's dashpots.
    pub speed_ratio: f64,
    /// Kernel of the elements; the default kernel if `None`.
    pub kernel: Option<SolidKernel>,
    /// Number format.
    pub precision: Precision,
    /// Extent of the region to the sides and downwards, around which the wave enters through a layer of
    /// elements; if `None` it enters through the boundary.
    pub layer: Option<f64>,
}

/// Incident wave; times in `a / cs`.
#[derive(Clone)]
pub struct Incoming {
    /// Wave type.
    pub kind: WaveKind,
    /// Angle of incidence from the vertical (degrees).
    pub degrees: f64,
    /// Incident displacement at the surface above the cavity.
    pub signal: Arc<dyn Signal>,
    /// Start of the signal.
    pub begin: f64,
    /// End of the run.
    pub end: f64,
}

impl CavityModel {
    /// Fine mesh in a large box.
    pub const BEST: Self = Self {
        edge: 0.05,
        far: [0.4, 0.08],
        half_width: 32.0,
        height: 12.0,
        speed_ratio: 1.0,
        kernel: None,
        precision: Precision::F64,
        layer: None,
    };

    /// Generates the mesh.
    ///
    /// # Errors
    /// A box too small for the cavity.
    pub fn mesh(&self) -> Outcome<Mesh> {
        let slice = OpeningSlice {
            radius: RADIUS,
            depth: DEPTH,
            half_width: self.half_width * RADIUS,
            height: self.height * RADIUS,
            fine: self.edge * RADIUS,
            coarse: self.far.map(|edge| edge * RADIUS),
            growth: 1.0 + 0.5 * self.edge,
        };
        Ok(slice.mesh()?)
    }

    /// Displacement histories of the stations, `s-40.ux` and so on, and of the wall, `w90.ux` and so on,
    /// under a wave.
    ///
    /// # Errors
    /// Any error of the scene or its run.
    pub fn motion(&self, wave: &Incoming) -> Outcome<HistoryTable> {
        let mesh = self.mesh()?;
        let rock = rock()?;
        let mut parameters = PlaneWaveParameters::vertical(wave.kind, rock, 0.0);
        parameters.incidence = Angle::from_degrees(wave.degrees);
        let sine = wave.degrees.to_radians().sin();
        let field = PlaneWave::new(parameters, wave.signal.clone())?;

        // Rollers on both cuts: plane strain. Scattered waves spread cylindrically.
        let cuts = [mesh.facet_set("front")?, mesh.facet_set("back")?].concat();
        let plane_strain = Support::roller(mesh.nodes_of_facets(&cuts), Vec3::y());
        let springs = ViscousSpring {
            axes: [AxisParameters::new(0.8, self.speed_ratio, None)?; 3],
            spreading: Spreading::Cylindrical,
            ..ViscousSpring::default()
        };
        let mut part = Part::new("rock", Material::from(LinearElastic::new(rock)));
        part.kernel = self.kernel.map(Into::into);
        let condition: Box<dyn AbsorbingBoundary> = match self.layer {
            None => Box::new(springs),
            Some(reach) => {
                let reach = reach * RADIUS;
                let (low, high) = (
                    Vec3::new(-reach, 0.0, -reach),
                    Vec3::new(reach, self.edge * RADIUS, 0.0),
                );
                let inside = mesh.elements_in_box(&low, &high);
                let layer = reduction_layer(&mesh, &inside, &part)?;
                Box::new(DomainReduction::new(layer, springs))
            }
        };
        let boundary = Boundary::new(condition, ["left", "right", "bottom"])
            .with_scatterer(Vec3::new(0.0, 0.0, -DEPTH));

        let unit = unit_of_time()?;
        let sample = unit / SAMPLES as f64;
        // Arrival time of an S wave at the farthest corner.
        let ahead = (self.height + self.half_width * sine).ceil();
        let mut output = OutputPlan::default().with_every(sample);
        for station in STATIONS {
            let place = Vec3::new(0.1 * RADIUS * f64::from(station), 0.0, 0.0);
            output = output.history(&format!("s{station}"), place, Motion::DISPLACEMENT);
        }
        for degrees in WALL {
            let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
            let place = Vec3::new(RADIUS * cosine, 0.0, RADIUS * sine - DEPTH);
            let spot = ObservationPoint::at(place).within(0.1 * RADIUS);
            output = output.history(&format!("w{degrees}"), spot, Motion::DISPLACEMENT);
        }
        let mut simulation = Scene::new("cavity", mesh)
            .part(part)
            .support(plane_strain)
            .with_boundary(boundary)
            .with_field(field)
            .with_precision(self.precision)
            .with_start_time((wave.begin - ahead) * unit)
            .with_initial_motion(InitialMotion::Field)
            .with_duration((wave.end - wave.begin + ahead) * unit)
            .with_output(output)
            .prepare()?;
        // A whole number of steps between samples.
        let stable = simulation.stable_step()?.step;
        simulation.set_step(TimeStep::Seconds(sample / (sample / stable).ceil()));
        Ok(simulation.run(RunHooks::default())?.histories().clone())
    }
}
