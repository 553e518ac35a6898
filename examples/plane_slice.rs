//! A slice of a plane problem compared with the whole body: the same results at the cost of one layer of elements.
//!
//! Builds on `cavity_scattering`. A long opening of constant section in homogeneous ground, under waves normal to its axis: all
//! slices have the same motion. With rollers on its cuts one layer of elements is sufficient; in a scene the key
//! `slice = { across = "y", at = 0 }` of the mesh selects it.
//!
//! ```text
//!          y
//!        /                       ----------------
//!      ----------------        /   slice         |  one element thick, both cuts on rollers
//!    /   whole       /|       /---------------- /
//!   /---------------/ |       |      .--.      |
//!   |      .--.     | |       |      `--'      |
//!   |      `--'     |/         ----------------
//!    ---------------
//! ```
//!
//! Run: `cargo run --release --example plane_slice`

use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use powerhouse::boundary::{Spreading, ViscousSpring};
use powerhouse::engine::Support;
use powerhouse::engine::observe::Motion;
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{Axis, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind, first_hit_corner,
};
use powerhouse::{
    Boundary, Material, OutputPlan, Part, ResidualLimit, RunHooks, Scene, Simulation, TimeStep,
};
use powerhouse_examples::{Figures, Outcome};
use powerhouse_study::{OpeningSlice, grown};

const RADIUS: f64 = 5.0;
const DEPTH: f64 = 15.0;

/// Ground around an opening, with a number of layers of elements of an edge (m).
fn whole(edge: f64, layers: usize) -> Outcome<Mesh> {
    let opening = OpeningSlice {
        radius: RADIUS,
        depth: DEPTH,
        half_width: 60.0,
        height: 60.0,
        fine: edge,
        coarse: [edge; 2],
        growth: 1.0,
    };
    Ok(grown(&opening.mesh()?, "back", &vec![edge; layers - 1])?)
}

/// The scene of a mesh under an SV wave at 20 degrees, with rollers on its ends.
fn simulation(mesh: Mesh, step: Option<f64>) -> Outcome<Simulation> {
    let (low, high) = mesh.bounding_box();
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, media::ROCK, 0.0);
    parameters.incidence = Angle::from_degrees(20.0);
    parameters.reference = first_hit_corner(&low, &high, &parameters.direction());
    let pulse = Arc::new(SmoothPulse::new(0.01, 0.05)?);
    let ends = [mesh.facet_set("front")?, mesh.facet_set("back")?].concat();
    let held = Support::roller(mesh.nodes_of_facets(&ends), Vec3::y());
    let springs = ViscousSpring {
        spreading: Spreading::Cylindrical,
        ..ViscousSpring::default()
    };
    let boundary = Boundary::new(springs, ["left", "right", "bottom"]);
    let output = OutputPlan::default()
        .history("surface", Vec3::new(0.0, low.y, 0.0), Motion::ALL)
        .history("crown", Vec3::new(0.0, low.y, RADIUS - DEPTH), Motion::ALL);
    let scene = Scene::new("ground", mesh)
        .part(Part::new(
            "rock",
            Material::from(LinearElastic::new(media::ROCK)),
        ))
        .support(held)
        .with_plane_waves(vec![PlaneWave::new(parameters, pulse)?])?
        .with_boundary(boundary.with_scatterer(Vec3::new(0.0, 0.0, -DEPTH)))
        .with_duration(0.15)
        .with_energy_residual(ResidualLimit::Unchecked)
        .with_threads(1)
        .with_output(output);
    let scene = match step {
        Some(step) => scene.with_step(TimeStep::Seconds(step)),
        None => scene,
    };
    Ok(scene.prepare()?)
}

/// Largest difference between slice and whole body over the largest motion of the same quantity.
fn difference(edge: f64, layers: usize) -> Outcome<f64> {
    let mesh = whole(edge, layers)?;
    let slice = mesh.plane_slice(Axis::Y, (0.5 + (layers / 2) as f64) * edge)?;
    // One step for both, below the stable steps of both.
    let step = 0.98 * simulation(mesh.clone(), None)?.step()?;
    let [whole, slice] = [mesh, slice].map(|mesh| -> Outcome<_> {
        let results = simulation(mesh, Some(step))?.run(RunHooks::default())?;
        Ok(results.histories().clone())
    });
    let (whole, slice) = (whole?, slice?);
    let mut worst = 0.0_f64;
    for (found, expected) in slice.columns.iter().zip(&whole.columns) {
        if expected.name.ends_with('y') {
            continue;
        }
        let peak = expected
            .values
            .iter()
            .fold(0.0_f64, |peak, u| peak.max(u.abs()));
        for (found, expected) in found.values.iter().zip(&expected.values) {
            let apart = (found - expected).abs() / peak;
            worst = if apart <= worst { worst } else { apart };
        }
    }
    Ok(worst)
}

/// Ratios of the numbers of elements and of the wall times of a step, whole body over slice.
fn ratios(edge: f64, layers: usize) -> Outcome<[f64; 2]> {
    let mesh = whole(edge, layers)?;
    let slice = mesh.plane_slice(Axis::Y, 0.5 * edge)?;
    let elements = mesh.element_count() as f64 / slice.element_count() as f64;
    let [mut whole, mut slice] = [simulation(mesh, None)?, simulation(slice, None)?];
    // The least of several alternating trials.
    let mut times = [Duration::MAX; 2];
    for _ in 0..20 {
        for (time, simulation) in times.iter_mut().zip([&mut whole, &mut slice]) {
            *time = (*time).min(simulation.time_steps(5)?);
        }
    }
    Ok([elements, times[0].as_secs_f64() / times[1].as_secs_f64()])
}

fn figures(edge: f64, layers: usize) -> Outcome<Figures> {
    let mut figures = Figures::default();
    figures.at_most("plane_slice.difference", difference(edge, layers)?, 1.0e-10);
    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
    let mut figures = figures(1.0, 8)?;
    let [elements, cost] = ratios(0.4, 8)?;
    figures.report("plane_slice.elements", elements, "whole over slice");
    figures.report("plane_slice.cost", cost, "time of a step, whole over slice");
    let off = (cost / elements - 1.0).abs();
    figures.at_most("plane_slice.cost_off_elements", off, 0.25);
    Ok(figures.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slice has the motion of the whole body within rounding.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(figures(2.5, 3).unwrap().missed(), 0);
    }
}
