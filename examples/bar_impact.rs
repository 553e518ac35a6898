//! Impact of a bar on an equal bar, and on a rigid wall.
//!
//! Builds on `joint_slip`. Two equal bars are in contact for `2 L / c` under half the pressure `rho c v` and
//! exchange their velocities; a bar rebounds from a rigid wall after the same time under `rho c v`.
//!
//! ```text
//!          v = 1 m/s                          v = 1 m/s
//!     +===========>+===========+         +===========>|/
//!     0           L|           2L                      |/
//! ```
//!
//! The masses of a closing node pair lose their relative kinetic energy. This impact loss is a column of its own in the
//! energy balance and vanishes with the element size.
//!
//! Run: `cargo run --release --example bar_impact`

use std::error::Error;
use std::process::ExitCode;

use powerhouse::contact::{Frictionless, Joint};
use powerhouse::engine::{BuildModel, Support};
use powerhouse::model::{ElasticMedium, Vec3};
use powerhouse_examples::Figures;
use powerhouse_examples::column::{Column, watch};

type Outcome<T> = Result<T, Box<dyn Error>>;

const LENGTH: f64 = 10.0;
const YOUNG: f64 = 9e9;
const DENSITY: f64 = 2750.0;

/// Results of an impact.
struct Meeting {
    /// Duration of contact (s).
    duration: f64,
    /// Mean contact pressure over that time (Pa).
    pressure: f64,
    /// Mean velocities of the struck and the striking bar at the end (m/s, along the initial velocity).
    velocities: [f64; 2],
    /// Impact loss over the initial energy.
    loss: f64,
}

/// Computes the impact of a bar with a number of elements on another bar or a wall.
fn meet(bricks: usize, wall: bool) -> Outcome<Meeting> {
    let medium = ElasticMedium::new(YOUNG, 0.0, DENSITY)?;
    let struck = if wall { 1 } else { bricks };
    let brick = LENGTH / bricks as f64;
    let column = Column::new(&[(struck, medium), (bricks, medium)], brick)?;
    let joint = Joint::new("contact", column.joints[0].pairs.clone(), Frictionless)?;
    let mut builder = column.along(2).constraint(Box::new(joint));
    let below = column
        .mesh
        .nodes_of_elements(column.mesh.element_set("part 0")?);
    if wall {
        builder = builder.support(Support::fixed(below.clone()));
    }
    let mut model = builder.build()?;
    let nodes = 0..column.mesh.node_count() as u32;
    let strikes = |node: u32| below.binary_search(&node).is_err();
    let speed = |node: u32| {
        if strikes(node) {
            -Vec3::z()
        } else {
            Vec3::zeros()
        }
    };
    let velocity: Vec<Vec3> = nodes.clone().map(speed).collect();
    model.set_initial(&vec![Vec3::zeros(); velocity.len()], &velocity)?;
    let wave = (YOUNG / DENSITY).sqrt();
    let step = 0.5 * brick / wave;
    let (seen, report) = watch(&mut model, &[], (3.0 * LENGTH / wave, step))?;
    let mean = |pairs: &Vec<_>| -> f64 {
        let pressure = |pair: &powerhouse::model::JointRecord| -pair.traction.x;
        pairs.iter().map(pressure).sum::<f64>() / pairs.len() as f64
    };
    let pressures: Vec<f64> = seen.pairs.iter().map(mean).collect();
    let touching: Vec<usize> = (0..pressures.len())
        .filter(|&k| pressures[k] > 0.0)
        .collect();
    let (Some(first), Some(last)) = (touching.first(), touching.last()) else {
        return Err("the bars have not met".into());
    };
    let duration = (last + 1 - first) as f64 * step;
    let velocity = |striking: bool| {
        let own = || nodes.clone().filter(|&node| strikes(node) == striking);
        let momentum: f64 = own().map(|n| model.mass(n) * model.velocity(n).z).sum();
        -momentum / own().map(|n| model.mass(n)).sum::<f64>()
    };
    let energy = |name: &str| report.energies.iter().find(|(column, _)| *column == name);
    let energy = |name: &str| energy(name).map_or(0.0, |(_, value)| *value);
    Ok(Meeting {
        duration,
        pressure: pressures.iter().sum::<f64>() * step / duration,
        velocities: [velocity(false), velocity(true)],
        loss: energy("impact") / energy("initial"),
    })
}

fn figures() -> Outcome<Figures> {
    let mut figures = Figures::default();
    let wave = (YOUNG / DENSITY).sqrt();
    for (name, wall) in [("bars", false), ("wall", true)] {
        let expected = Meeting {
            duration: 2.0 * LENGTH / wave,
            pressure: DENSITY * wave * if wall { 1.0 } else { 0.5 },
            velocities: if wall { [0.0, -1.0] } else { [1.0, 0.0] },
            loss: 0.0,
        };
        let found = meet(200, wall)?;
        let figure = |what: &str| format!("bar_impact.{name}.{what}");
        println!(
            "{name}: {:.5} ms (exact {:.5}), {:.4} MPa (exact {:.4}), velocities {:.4?}",
            found.duration * 1e3,
            expected.duration * 1e3,
            found.pressure * 1e-6,
            expected.pressure * 1e-6,
            found.velocities
        );
        let duration = (found.duration / expected.duration - 1.0).abs();
        figures.at_most(&figure("duration.error"), duration, 5e-3);
        let pressure = (found.pressure / expected.pressure - 1.0).abs();
        figures.at_most(&figure("stress.error"), pressure, 1e-2);
        let velocities = found.velocities.iter().zip(expected.velocities);
        let velocities = velocities.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        figures.at_most(&figure("velocity.error"), velocities, 1e-2);
        let coarse = meet(100, wall)?;
        figures.report(
            &figure("loss"),
            found.loss,
            "share of the energy lost at the joint",
        );
        figures.at_most(
            &figure("loss_over_half_mesh"),
            found.loss / coarse.loss,
            0.55,
        );
    }
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
