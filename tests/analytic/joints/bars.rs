//! Bars that meet.

use powerhouse::engine::BuildModel;
use powerhouse_contact::{Frictionless, Joint};
use powerhouse_model::{ElasticMedium, Support, Vec3};

use super::{Column, watched};

const LENGTH: f64 = 10.0;

/// E 9 GPa, 2750 kg/m3, no lateral strain.
fn medium() -> ElasticMedium {
    ElasticMedium::new(9e9, 0.0, 2750.0).unwrap()
}

/// What a run has found: how long the bars touch (s), their mean stress (Pa, pressure positive), and
/// the mean velocities of the lower and the upper bar at the end (m/s).
struct Meeting {
    duration: f64,
    pressure: f64,
    velocities: [f64; 2],
}

/// A bar of 10 m that moves down at 1 m/s onto an equal one at rest, or onto a rigid wall.
fn meet(wall: bool) -> Meeting {
    let bricks = 200;
    let lower = if wall { 1 } else { bricks };
    let brick = LENGTH / bricks as f64;
    let column = Column::new(&[(lower, medium()), (bricks, medium())], brick);
    let joint = Joint::new("contact", column.surfaces[0].pairs.clone(), Frictionless).unwrap();
    let mut builder = column.along(2).constraint(Box::new(joint));
    let below: Vec<u32> = column
        .mesh
        .nodes_of_elements(column.mesh.element_set("part 0").unwrap());
    if wall {
        builder = builder.support(Support::fixed(below.clone()));
    }
    let mut model = builder.build().unwrap();
    let count = column.mesh.node_count();
    let is_below = |node: u32| below.contains(&node);
    let of = |node: u32| {
        if is_below(node) {
            Vec3::zeros()
        } else {
            -Vec3::z()
        }
    };
    let velocity: Vec<Vec3> = (0..count as u32).map(of).collect();
    model
        .set_initial(&vec![Vec3::zeros(); count], &velocity)
        .unwrap();
    let speed = (9e9 / 2750.0_f64).sqrt();
    let step = 0.5 * brick / speed;
    let (seen, report) = watched(&mut model, &[], (3.0 * LENGTH / speed, step));
    assert!(report.energy_residual < 1e-10, "{}", report.energy_residual);
    let pressures: Vec<f64> = seen
        .records
        .iter()
        .map(|records| {
            records
                .iter()
                .map(|r| -r.traction.x / records.len() as f64)
                .sum()
        })
        .collect();
    let first = pressures.iter().position(|&p| p > 0.0).unwrap();
    let last = pressures.iter().rposition(|&p| p > 0.0).unwrap();
    let duration = (last + 1 - first) as f64 * step;
    let impulse: f64 = pressures.iter().sum::<f64>() * step;
    let mean = |below: bool| {
        let nodes = || (0..count as u32).filter(|&node| is_below(node) == below);
        let momentum: f64 = nodes().map(|n| model.mass(n) * model.velocity(n).z).sum();
        momentum / nodes().map(|n| model.mass(n)).sum::<f64>()
    };
    Meeting {
        duration,
        pressure: impulse / duration,
        velocities: [mean(true), mean(false)],
    }
}

/// Equal bars touch for 2 L / c, under half the pressure `rho c v`, and exchange their velocities.
#[test]
fn equal_bars_exchange_their_velocities() {
    let meeting = meet(false);
    let Meeting {
        duration,
        pressure,
        velocities,
    } = meeting;
    assert!((duration / 11.05542e-3 - 1.0).abs() < 5e-3, "{duration}");
    assert!((pressure / 2.487469e6 - 1.0).abs() < 1e-2, "{pressure}");
    assert!(
        (velocities[0] + 1.0).abs() < 1e-2 && velocities[1].abs() < 1e-2,
        "{velocities:?}"
    );
}

/// On a rigid wall a bar touches for 2 L / c under the pressure `rho c v` and turns back.
#[test]
fn a_bar_turns_back_from_a_rigid_wall() {
    let meeting = meet(true);
    assert!(
        (meeting.duration / 11.05542e-3 - 1.0).abs() < 5e-3,
        "{}",
        meeting.duration
    );
    assert!(
        (meeting.pressure / 4.974937e6 - 1.0).abs() < 1e-2,
        "{}",
        meeting.pressure
    );
    assert!(
        (meeting.velocities[1] - 1.0).abs() < 1e-2,
        "{}",
        meeting.velocities[1]
    );
}
