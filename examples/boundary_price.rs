//! Errors and costs of absorbing boundaries: reflection of plane waves, drift, time per node and step.
//!
//! Builds on `absorbing_box`. The basis for the choice of a boundary: its errors by angle and frequency, and its
//! cost. Reflection is measured with P and SV waves in a strip that is
//! periodic along the face and compared with the closed forms of
//! `powerhouse::boundary::reflection`; the tables in that crate's documentation are generated here. Costs are measured
//! relative to an elastic step of the same run. Drift is measured after a million steps in each number format, which take
//! most of the time.
//!
//! Run: `cargo run --release --example boundary_price`

use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use powerhouse::boundary::reflection::{BodyWave, reflection};
use powerhouse::boundary::{
    AxisParameters, FaceCoefficients, InputMode, ReductionLayer, Viscous, ViscousSpring,
};
use powerhouse::engine::observe::{Motion, Place};
use powerhouse::engine::{NodalForce, Precision};
use powerhouse::material::LinearElastic;
use powerhouse::model::{AbsorbingBoundary, ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::{self, Angle, PlaneWaveParameters, SmoothPulse, WaveKind};
use powerhouse::{
    Boundary, InitialMotion, Material, OutputPlan, Part, ResidualLimit, RunHooks, Scene,
    Simulation, TimeStep,
};
use powerhouse_examples::strip::Arriving;
use powerhouse_examples::{Figures, Outcome};

/// Distance from the scatterer (m).
const DISTANCE: f64 = 50.0;
/// Frequencies, as `w r / cp`.
const NUMBERS: [f64; 3] = [1.0, 2.0, 5.0];
/// Angles from the normal (degrees).
const ANGLES: [f64; 6] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0];

/// The boundaries, with B of their dashpots; springs have A = 0.8.
const BOUNDARIES: [(&str, Option<f64>); 3] = [
    ("viscous", None),
    ("springs_b11", Some(1.1)),
    ("springs_b10", Some(1.0)),
];

const PRECISIONS: [(&str, Precision); 3] = [
    ("f64", Precision::F64),
    ("mixed", Precision::Mixed),
    ("f32", Precision::F32),
];

fn rock() -> Outcome<ElasticMedium> {
    Ok(ElasticMedium::new(1.0e10, 0.25, 2700.0)?)
}

fn condition(
    speed_ratio: Option<f64>,
    distance: Option<f64>,
) -> Outcome<Box<dyn AbsorbingBoundary>> {
    let input = InputMode::Nothing;
    Ok(match speed_ratio {
        None => Box::new(Viscous { input }),
        Some(b) => Box::new(ViscousSpring {
            axes: [AxisParameters::new(0.8, b, distance)?; 3],
            input,
            ..ViscousSpring::default()
        }),
    })
}

fn coefficients(speed_ratio: Option<f64>) -> Outcome<FaceCoefficients> {
    let rock = rock()?;
    Ok(match speed_ratio {
        None => FaceCoefficients::viscous(&rock),
        Some(b) => FaceCoefficients::viscous_spring(&rock, 0.8, b, DISTANCE),
    })
}

/// Prints a table of the reflection coefficients of a boundary for one wave; returns the largest difference from the
/// closed form.
fn reflections(
    speed_ratio: Option<f64>,
    wave: BodyWave,
    angles: &[f64],
    numbers: &[f64],
) -> Outcome<f64> {
    let medium = rock()?;
    let face = coefficients(speed_ratio)?;
    let mut worst = 0.0_f64;
    println!("| degrees | w r / cp | reflected P | closed form | reflected SV | closed form |");
    for &degrees in angles {
        for &number in numbers {
            let frequency = number * medium.p_speed() / DISTANCE;
            let arriving = Arriving {
                medium,
                wave,
                degrees,
                frequency,
            };
            let found = arriving.returned(&|| condition(speed_ratio, Some(DISTANCE)))?;
            let closed = reflection(&medium, &face, wave, degrees.to_radians(), frequency)?;
            let closed = [closed.p.norm(), closed.sv.norm()];
            println!(
                "| {degrees} | {number} | {:.4} | {:.4} | {:.4} | {:.4} |",
                found[0], closed[0], found[1], closed[1]
            );
            for (found, closed) in found.iter().zip(closed) {
                let difference = (found - closed).abs();
                worst = if difference <= worst {
                    worst
                } else {
                    difference
                };
            }
        }
    }
    Ok(worst)
}

const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

/// A cube with a number of 2 m elements along an edge, under a free surface.
fn cube(cells: usize) -> Outcome<(Scene, Vec3)> {
    let edge = 2.0 * cells as f64;
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(edge), [cells; 3], "rock")?;
    let middle = Vec3::new(0.5 * edge, 0.5 * edge, edge);
    let rock = Material::from(LinearElastic::new(rock()?));
    Ok((
        Scene::new("cube", mesh).part(Part::new("rock", rock)),
        middle,
    ))
}

/// Drift after a push of 20 ms on the surface and a number of steps, over its peak: mean displacement of the surface, and
/// its change in the last tenth of the run.
fn drift(speed_ratio: Option<f64>, precision: Precision, steps: usize) -> Outcome<[f64; 2]> {
    let (scene, middle) = cube(6)?;
    let around = [middle.add_scalar(-0.1), middle.add_scalar(0.1)];
    let loaded = scene.mesh().nodes_in_box(&around[0], &around[1]);
    let push = |time: f64| match time / 0.02 {
        x if x < 1.0 => (core::f64::consts::PI * x).sin().powi(2),
        _ => 0.0,
    };
    let force = Vec3::new(0.0, 0.0, -1.0e6);
    let step = 5.0e-4;
    let output = OutputPlan::default().with_every(4.0 * step);
    let boundary = Boundary::new(condition(speed_ratio, None)?, FACES).with_scatterer(middle);
    let results = scene
        .with_boundary(boundary)
        .load(NodalForce::new(loaded, force, Box::new(push)))
        .with_precision(precision)
        .with_threads(1)
        .with_step(TimeStep::Seconds(step))
        .with_duration(step * steps as f64)
        .with_energy_residual(ResidualLimit::Unchecked)
        .with_output(output.history("top", Place::NodeSet("top".into()), Motion::DISPLACEMENT))
        .prepare()?
        .run(RunHooks::default())?;
    let column = results.histories().column("top.uz").ok_or("no column")?;
    let values = &column.values;
    let largest = |of: &[f64], from: f64| {
        let sizes = of.iter().map(|u| (u - from).abs());
        sizes.fold(
            0.0,
            |most: f64, size| if size <= most { most } else { size },
        )
    };
    let peak = largest(values, 0.0);
    let last = values.last().copied().unwrap_or(f64::NAN);
    let still_moves = largest(&values[values.len() * 9 / 10..], last);
    Ok([last.abs() / peak, still_moves / peak])
}

/// The least wall time of a step in several trials.
fn time_of_step(simulation: &mut Simulation) -> Outcome<Duration> {
    let mut least = Duration::MAX;
    for _ in 0..200 {
        least = least.min(simulation.time_steps(10)? / 10);
    }
    Ok(least)
}

/// Cost of a boundary, measured against the same body without it.
struct Cost {
    /// Time per absorbing node and step (ns).
    nanoseconds: f64,
    /// Ratio of that time to the time of an elastic element and step.
    of_brick: f64,
    /// Ratio of the stable steps with and without the boundary.
    stable_step: f64,
}

fn cost(speed_ratio: Option<f64>) -> Outcome<Cost> {
    let cells = 16;
    let mut free = cube(cells)?.0.with_threads(1).prepare()?;
    let (scene, middle) = cube(cells)?;
    let boundary = Boundary::new(condition(speed_ratio, None)?, FACES).with_scatterer(middle);
    let mut bounded = scene.with_boundary(boundary).with_threads(1).prepare()?;
    let stable_step = bounded.stable_step()?.step / free.stable_step()?.step;
    let times = [time_of_step(&mut bounded)?, time_of_step(&mut free)?];
    let [with, without] = times.map(|time| 1.0e9 * time.as_secs_f64());
    let nodes = ((cells + 1).pow(3) - cells * (cells - 1).pow(2)) as f64;
    let nanoseconds = (with - without) / nodes;
    Ok(Cost {
        nanoseconds,
        of_brick: nanoseconds / (without / cells.pow(3) as f64),
        stable_step,
    })
}

/// Cost (ns) of the input of an SV wave at 30 degrees, against the same body without input: through a layer of elements
/// per element and step, and through the faces per node and step.
fn input_cost() -> Outcome<[f64; 2]> {
    let cells = 16;
    let scene = |region: Option<Vec<u32>>, waves: bool| -> Outcome<Simulation> {
        let (scene, middle) = cube(cells)?;
        let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, rock()?, middle.z);
        parameters.incidence = Angle::from_degrees(30.0);
        let pulse = Arc::new(SmoothPulse::new(1.0e-3, 0.05)?);
        let mut boundary = Boundary::new(Viscous::default(), FACES).with_scatterer(middle);
        boundary.region = region;
        let scene = scene.with_boundary(boundary).with_threads(1);
        let scene = if waves {
            scene.with_plane_waves(vec![wavefield::PlaneWave::new(parameters, pulse)?])?
        } else {
            scene
        };
        Ok(scene
            .with_start_time(-1.0)
            .with_initial_motion(InitialMotion::Rest)
            .with_duration(1.0e3)
            .prepare()?)
    };
    let (free, middle) = cube(cells)?;
    let half = Vec3::new(8.0, 8.0, 16.0);
    let inside = free
        .mesh()
        .elements_in_box(&(middle - half), &(middle + half));
    let layer = ReductionLayer::elements(free.mesh(), &inside).len() as f64;
    let nodes = ((cells + 1).pow(3) - cells * (cells - 1).pow(2)) as f64;
    let mut times = [0.0; 3];
    for (time, (region, waves)) in
        (times.iter_mut()).zip([(None, false), (Some(inside), true), (None, true)])
    {
        *time = 1.0e9 * time_of_step(&mut scene(region, waves)?)?.as_secs_f64();
    }
    let [without, by_layer, by_faces] = times;
    Ok([(by_layer - without) / layer, (by_faces - without) / nodes])
}

/// Reports reflections at several angles and frequencies, and the drift after a number of steps.
fn figures(angles: &[f64], numbers: &[f64], steps: usize) -> Outcome<Figures> {
    let mut figures = Figures::default();
    for (name, speed_ratio) in BOUNDARIES {
        for (of, wave) in [("p", BodyWave::P), ("sv", BodyWave::Sv)] {
            println!("{name}, incident {of} wave:");
            let worst = reflections(speed_ratio, wave, angles, numbers)?;
            let figure = format!("boundary_price.{name}.{of}.reflection_error");
            figures.at_most(&figure, worst, 0.01);
        }
        for (of, precision) in PRECISIONS {
            let [left, moving] = drift(speed_ratio, precision, steps)?;
            let figure = |what: &str| format!("boundary_price.{name}.{of}.{what}");
            figures.report(&figure("drift"), left, "left by a push, over its peak");
            figures.at_most(&figure("late_motion"), moving, 1.0e-3);
        }
    }
    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
    let figures = figures(&ANGLES, &NUMBERS, 1_000_000)?;
    for (name, speed_ratio) in BOUNDARIES {
        let cost = cost(speed_ratio)?;
        let figure = |of: &str| format!("boundary_price.{name}.{of}");
        for (of, value, remark) in [
            (
                "nanoseconds",
                cost.nanoseconds,
                "per node and step, one thread",
            ),
            (
                "of_brick",
                cost.of_brick,
                "a node over an elastic brick of the same run",
            ),
            (
                "stable_step",
                cost.stable_step,
                "over that without a boundary",
            ),
        ] {
            figures.report(&figure(of), value, remark);
        }
    }
    let [by_layer, by_faces] = input_cost()?;
    figures.report(
        "boundary_price.input.layer",
        by_layer,
        "ns per element of the layer and step, an SV wave at 30 degrees by domain reduction",
    );
    figures.report(
        "boundary_price.input.faces",
        by_faces,
        "ns per node and step, the same wave through the faces",
    );
    Ok(figures.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At several angles, below and past the critical one, every figure meets its limit.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(figures(&[0.0, 45.0], &[1.0], 2000).unwrap().missed(), 0);
    }
}
