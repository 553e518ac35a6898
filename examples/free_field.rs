//! A wave crosses a block of ground without any structure, and the computed motion of the surface
//! is compared with the closed form.
//!
//! Builds on nothing. After example 1 of Wang, Chen & Xiao (2019): a cube of 1200 m in 40^3
//! elements under a free surface, viscous-spring boundaries on the other five faces.
//!
//! ```text
//!            free surface, z = 1200 m
//!        +-----------x-----------+      x  monitoring point, the centre
//!        |                       |
//!   =))  |     E  10 GPa         |  ((=     =))  springs, dashpots and input forces
//!        |     nu 0.3            |
//!   =))  |     rho 3000 kg/m3    |  ((=
//!        |                       |
//!        +-----------------------+
//!      ^    ^  ^^   ^^   ^^   ^^
//!     /   wave front, `a` from the horizontal
//!    / a   travels up and to the right from the corner that it hits first
//! ```
//!
//! Two inputs at the bottom are compared: the full free field (the default here), and the
//! incident wave alone, as the paper has it.
//!
//! Run: `cargo run --release --example free_field`

use std::process::ExitCode;
use std::sync::Arc;

use powerhouse::boundary::{AxisParameters, InputMode, ViscousSpring};
use powerhouse::engine::observe::Motion;
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, FieldMotion, IncidentField, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, RaisedCosinePulse, Signal, SmoothPulse, WaveKind,
    ZeroMeanPulse, first_hit_corner,
};
use powerhouse::{Boundary, InitialMotion, Material, OutputPlan, Part, RunHooks, Scene};
use powerhouse_examples::Figures;

/// Edge of the cube (m) and elements along it.
const EDGE: f64 = 1200.0;
const ELEMENTS: usize = 40;

/// One incident wave.
struct Case {
    kind: WaveKind,
    incidence: f64,
    azimuth: f64,
    signal: Arc<dyn Signal>,
    /// When the run starts and how long it lasts (s).
    start: f64,
    duration: f64,
    initial: InitialMotion,
}

impl Case {
    /// A wave whose pulse begins after the run, from rest.
    fn new(kind: WaveKind, incidence: f64, signal: impl Signal + 'static) -> Self {
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

    fn field(&self, medium: ElasticMedium) -> Result<PlaneWave, Box<dyn std::error::Error>> {
        let mut parameters = PlaneWaveParameters::vertical(self.kind, medium, EDGE);
        parameters.incidence = Angle::from_degrees(self.incidence);
        parameters.azimuth = Angle::from_degrees(self.azimuth);
        let direction = parameters.direction();
        parameters.reference = first_hit_corner(&Vec3::zeros(), &Vec3::repeat(EDGE), &direction);
        Ok(PlaneWave::new(parameters, self.signal.clone())?)
    }

    /// The relative L2 error of the displacement at the centre of the surface over the whole run,
    /// the full free field on every face.
    fn error(&self) -> Result<f64, Box<dyn std::error::Error>> {
        self.error_with(ViscousSpring::default())
    }

    /// The same with another boundary.
    fn error_with(&self, boundary: ViscousSpring) -> Result<f64, Box<dyn std::error::Error>> {
        let rock = ElasticMedium::new(10.0e9, 0.3, 3000.0)?;
        let field = self.field(rock)?;
        let centre = Vec3::new(EDGE / 2.0, EDGE / 2.0, EDGE);
        let sampler = field.prepare(&[centre])?;

        let cube = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(EDGE), [ELEMENTS; 3], "rock")?;
        let results = Scene::new("free field", cube)
            .part(Part::new("rock", Material::from(LinearElastic::new(rock))))
            .boundary(
                Boundary::new(boundary, ["left", "right", "front", "back", "bottom"])
                    .scatterer(centre),
            )
            .field(field)
            .start(self.start, self.initial)
            .duration(self.duration)
            .output(OutputPlan::default().history("surface", centre, Motion::DISPLACEMENT))
            .prepare()?
            .run(RunHooks::default())?;

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
        Ok((difference / reference).sqrt())
    }
}

fn figures() -> Result<Figures, Box<dyn std::error::Error>> {
    let mut figures = Figures::default();

    // The paper's two waves; a pulse of 0.8 s that comes back to rest.
    for (name, kind, limit) in [("p15", WaveKind::P, 0.006), ("sv15", WaveKind::SV, 0.02)] {
        let case = Case::new(kind, 15.0, RaisedCosinePulse::new(1.0, 0.8)?);
        let full = case.error()?;
        figures.at_most(&format!("free_field.{name}.rel_l2"), full, limit);
        // The paper's springs: r is the cube's edge on every face.
        let incident_only = case.error_with(ViscousSpring {
            axes: [AxisParameters::new(0.8, 1.1, Some(EDGE))?; 3],
            input: InputMode::IncidentOnly {
                faces: vec!["bottom".into()],
            },
            ..ViscousSpring::default()
        })?;
        figures.report(
            &format!("free_field.{name}.incident_only.rel_l2"),
            incident_only,
            "the paper's input at the bottom, which takes reflected waves for scattered ones",
        );
        // A pulse of the same duration, but narrower, is harder on the same mesh.
        let narrow = Case::new(kind, 15.0, SmoothPulse::new(1.0, 0.8)?);
        figures.report(
            &format!("free_field.{name}.narrow.rel_l2"),
            narrow.error()?,
            "a cubic B-spline pulse of 0.8 s",
        );
    }

    // A horizontally polarised wave that crosses the box on a skew course.
    let mut skew = Case::new(WaveKind::SH, 30.0, RaisedCosinePulse::new(1.0, 0.8)?);
    skew.azimuth = 37.0;
    figures.at_most("free_field.sh30.rel_l2", skew.error()?, 0.03);

    // Past the critical angle (32.3 degrees here) the surface begins to move before the wave
    // arrives: the run starts from the motion that the field then has.
    let mut past_critical = Case::new(WaveKind::SV, 40.0, ZeroMeanPulse::new(1.0, 1.6)?);
    past_critical.start = -1.0;
    past_critical.duration = 5.5;
    past_critical.initial = InitialMotion::Field;
    let error = past_critical.error()?;
    figures.at_most("free_field.sv40.rel_l2", error, 0.03);

    Ok(figures)
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    Ok(figures()?.verdict())
}

#[cfg(test)]
mod tests {
    /// Every figure meets its limit.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(super::figures().unwrap().missed(), 0);
    }
}
