//! What boundaries cost: what they return of plane waves, where they let a body drift, time per node
//! and step.
//!
//! Builds on `absorbing_box`. Before a boundary is chosen: by how much it errs, at which angles and
//! frequencies, and what it takes. Reflection is measured with P and SV waves in a strip that is
//! periodic along the face and compared with the closed forms of
//! `powerhouse::boundary::reflection`; the tables in that crate's documentation come from here.
//! Drift is that after a million steps in each precision, which take most of the time.
//!
//! Run: `cargo run --release --example boundary_price`

use std::process::ExitCode;
use std::time::Duration;

use powerhouse::boundary::reflection::{PlaneWave, reflection};
use powerhouse::boundary::{AxisParameters, FaceCoefficients, InputMode, Viscous, ViscousSpring};
use powerhouse::engine::observe::{Motion, Place};
use powerhouse::engine::{NodalForce, Precision};
use powerhouse::material::LinearElastic;
use powerhouse::model::{AbsorbingBoundary, ElasticMedium, Mesh, Vec3};
use powerhouse::{
    Boundary, Material, OutputPlan, Part, ResidualLimit, RunHooks, Scene, Simulation, TimeStep,
};
use powerhouse_examples::strip::Arriving;
use powerhouse_examples::{Figures, Outcome};

/// Distance from what scatters (m).
const DISTANCE: f64 = 50.0;
/// Frequencies, as `w r / cp`.
const NUMBERS: [f64; 3] = [1.0, 2.0, 5.0];
/// Angles from the normal (degrees).
const ANGLES: [f64; 6] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0];

/// The boundaries, and B of their dashpots; springs have A = 0.8.
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

/// Prints a table of what a boundary returns of one wave; the largest difference from the closed
/// form.
fn reflections(
    speed_ratio: Option<f64>,
    wave: PlaneWave,
    angles: &[f64],
    numbers: &[f64],
) -> Outcome<f64> {
    let medium = rock()?;
    let face = coefficients(speed_ratio)?;
    let mut worst = 0.0_f64;
    println!("| degrees | w r / cp | returned P | closed form | returned SV | closed form |");
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

/// A cube of so many bricks of 2 m along an edge, under a free surface.
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

/// What is left of a push of 20 ms on the surface after so many steps, over its peak: the mean
/// displacement of the surface, and how far it still moves in the last tenth of the run.
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
    let output = OutputPlan {
        every: 4.0 * step,
        ..OutputPlan::default()
    };
    let boundary = Boundary::new(condition(speed_ratio, None)?, FACES).scatterer(middle);
    let results = scene
        .boundary(boundary)
        .load(NodalForce::new(loaded, force, Box::new(push)))
        .precision(precision)
        .threads(1)
        .step(TimeStep::Seconds(step))
        .duration(step * steps as f64)
        .energy_residual(ResidualLimit::Unchecked)
        .output(output.history("top", Place::NodeSet("top".into()), Motion::DISPLACEMENT))
        .prepare()?
        .run(RunHooks::default())?;
    let column = results.histories.column("top.uz").ok_or("no column")?;
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

/// The least time that a step takes in some tries.
fn time_of_step(simulation: &mut Simulation) -> Outcome<Duration> {
    let mut least = Duration::MAX;
    for _ in 0..200 {
        least = least.min(simulation.time_steps(10)? / 10);
    }
    Ok(least)
}

/// The cost of a boundary at one of its nodes and steps (ns), and the stable step with it over that
/// without.
fn cost(speed_ratio: Option<f64>) -> Outcome<[f64; 2]> {
    let cells = 16;
    let mut free = cube(cells)?.0.threads(1).prepare()?;
    let (scene, middle) = cube(cells)?;
    let boundary = Boundary::new(condition(speed_ratio, None)?, FACES).scatterer(middle);
    let mut bounded = scene.boundary(boundary).threads(1).prepare()?;
    let ratio = bounded.stable_step()?.step / free.stable_step()?.step;
    let [with, without] = [time_of_step(&mut bounded)?, time_of_step(&mut free)?];
    let nodes = ((cells + 1).pow(3) - cells * (cells - 1).pow(2)) as f64;
    Ok([
        1.0e9 * (with.as_secs_f64() - without.as_secs_f64()) / nodes,
        ratio,
    ])
}

/// Reflections at some angles and numbers, and what is left of a push after so many steps.
fn figures(angles: &[f64], numbers: &[f64], steps: usize) -> Outcome<Figures> {
    let mut figures = Figures::default();
    for (name, speed_ratio) in BOUNDARIES {
        for (of, wave) in [("p", PlaneWave::P), ("sv", PlaneWave::Sv)] {
            println!("{name}, {of} wave arrives:");
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
        let [nanoseconds, ratio] = cost(speed_ratio)?;
        let figure = |of: &str| format!("boundary_price.{name}.{of}");
        figures.report(
            &figure("nanoseconds"),
            nanoseconds,
            "per node and step, one thread",
        );
        figures.report(
            &figure("stable_step"),
            ratio,
            "over that without a boundary",
        );
    }
    Ok(figures.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At some angles, before and past the critical one, every figure meets its limit.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(figures(&[0.0, 45.0], &[1.0], 2000).unwrap().missed(), 0);
    }
}
