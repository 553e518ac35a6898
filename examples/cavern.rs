//! A lined cavern under an obliquely incident earthquake, composed in Rust.
//!
//! Builds on all earlier examples. The model of `data/scenes/cavern_small.toml` without a scene file, for its first two
//! seconds; both must give the same numbers.
//!
//! ```text
//!      z = 0      ----------------x----------------   surface
//!                 |                               |
//!      z = -60    |            .-----.            |   crown
//!            =))  |     x = -10|     |10          |  ((=
//!      z = -92    |            '-----'            |   floor
//!                 |        lining, 1.5 m          |
//!      z = -150   ---------------------------------
//!                    ^^^^^^^^^^^^^^^^^^^^^^^^^^^
//!                    El Centro 1940, SV at 30 degrees
//! ```
//!
//! Run from the top of the project: `cargo run --release --example cavern`

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::SolidKernel;
use powerhouse::engine::observe::Motion;
use powerhouse::io::{AccelerationUnit, RecordOptions, read_gmsh, read_record};
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::Vec3;
use powerhouse::wavefield::{
    Angle, BaselineCorrection, EndDisplacement, PlaneWave, PlaneWaveParameters, TimeHistory,
    WaveKind, first_hit_corner,
};
use powerhouse::{Boundary, FileScene, Material, OutputPlan, Part, Results, RunHooks, Scene};
use powerhouse_examples::Figures;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

const DURATION: f64 = 2.0;

/// The record: first 20 s, corrected, scaled to 1.7 m/s2.
fn record(data: &Path) -> Outcome<powerhouse::wavefield::RecordSignal> {
    let options = RecordOptions {
        unit: Some(AccelerationUnit::MetrePerSecondSquared),
        ..RecordOptions::default()
    };
    let record = read_record(&data.join("records/el_centro_1940_ns.csv"), &options)?;
    let history = TimeHistory::new(record.step, record.samples)?.truncated(20.0, 0.0)?;
    let (history, report) =
        history.corrected(BaselineCorrection::VelocityPolynomial { order: 5 })?;
    println!(
        "baseline: end velocity {:.2e} -> {:.2e} m/s, largest change {:.2e} m/s2",
        report.before.end_velocity, report.after.end_velocity, report.largest_change
    );
    Ok(history
        .scaled_to_peak(1.7)?
        .into_signal(EndDisplacement::Zero)?)
}

/// The scene without a file.
fn composed(data: &Path) -> Outcome<Scene> {
    let mesh = read_gmsh(data.join("meshes/cavern_small.msh"))?.mesh;
    let (low, high) = mesh.bounding_box();
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, media::ROCK, high.z);
    parameters.incidence = Angle::from_degrees(30.0);
    parameters.reference = first_hit_corner(&low, &high, &parameters.direction());
    let wave = PlaneWave::new(parameters, Arc::new(record(data)?))?;
    let concrete = Material::from(LinearElastic::new(media::CONCRETE));
    let (crown, floor) = (Vec3::new(0.0, 0.0, -60.0), Vec3::new(0.0, 0.0, -92.0));
    let faces = ["left", "right", "front", "back", "bottom"];
    Ok(Scene::new("lined cavern", mesh)
        .part(
            Part::new("rock", Material::from(LinearElastic::new(media::ROCK)))
                .with_kernel(SolidKernel::Hex8OnePoint(Default::default())),
        )
        .part(Part::new("lining", concrete).with_kernel(SolidKernel::Hex8Full))
        .with_field(wave)
        .with_boundary(
            Boundary::new(ViscousSpring::paper(), faces).with_scatterer(Vec3::new(0.0, 0.0, -76.0)),
        )
        .with_output(
            OutputPlan::default()
                .history("crown", crown, Motion::ALL)
                .relative("crown-to-floor", crown, floor),
        ))
}

/// Samples of the horizontal displacement of the crown.
fn crown(results: &Results) -> Outcome<&[f64]> {
    let column = results
        .histories()
        .column("crown.ux")
        .ok_or("no history of the crown")?;
    Ok(&column.values)
}

fn figures() -> Outcome<Figures> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    let scene = composed(&data)?.with_duration(DURATION);
    let mesh = scene.mesh().clone();
    let from_rust = scene.prepare()?.run(RunHooks::default())?;
    print!("{}", from_rust.peaks(&mesh));

    let scene = FileScene::from_file(data.join("scenes/cavern_small.toml"))?
        .into_scene()
        .with_duration(DURATION);
    let from_file = scene.prepare()?.run(RunHooks::default())?;
    let (a, b) = (crown(&from_rust)?, crown(&from_file)?);
    let unequal = a
        .iter()
        .zip(b)
        .filter(|(a, b)| a.to_bits() != b.to_bits())
        .count();
    let mut figures = Figures::default();
    let missing = a.len().abs_diff(b.len());
    figures.at_most(
        "cavern.samples_unlike_scene_file",
        (unequal + missing) as f64,
        0.0,
    );
    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
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
