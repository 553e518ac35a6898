//! A crack where a reflected pulse pulls.

use powerhouse::engine::BuildModel;
use powerhouse_contact::{BondedCoulomb, BondedCoulombParameters, Joint};
use powerhouse_material_damage::media;
use powerhouse_model::{Bond, ContactState};

use super::{Column, even_step, watched};

/// A pulse of pressure comes back from a free end as tension. Of joints 5 m apart the one cracks, and
/// at the step, where and when the sum of both first passes the strength: the stress at a depth `d`
/// below the end is `rho c (f(t + d / c) - f(t - d / c))`, f the velocity of the incident wave there.
#[test]
fn a_reflected_pulse_cracks_the_right_joint_at_the_right_step() {
    let medium = media::ROCK;
    let (speed, amplitude, strength) = (medium.p_speed(), 0.1, 0.3e6);
    let impedance = medium.density * speed;
    let (length, brick, spacing) = (60.0, 0.25, 5.0);
    let bricks = (spacing / brick) as usize;
    let levels = 8;
    let mut parts = vec![(400, medium)];
    parts.extend(vec![(bricks, medium); levels]);
    let column = Column::new(&parts, brick);
    let height = 400.0 * brick + spacing * levels as f64;
    // A smooth pulse, so that the mesh does not bend it.
    let pulse = move |t: f64| {
        let x = t * speed / length;
        if (0.0..1.0).contains(&x) {
            amplitude * (core::f64::consts::PI * x).sin().powi(2)
        } else {
            0.0
        }
    };
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 1e9,
        tensile_strength: strength,
        static_friction: 0.5,
        dynamic_friction: 0.5,
        cohesion_loss: true,
    })
    .unwrap();
    let joint = |place: usize| {
        let pairs = column.surfaces[place].pairs.clone();
        Joint::new(format!("joint {place}"), pairs, law).unwrap()
    };
    let mut builder = column.open(column.along(2), 2, [impedance, 0.0], pulse);
    for place in 0..levels {
        builder = builder.constraint(Box::new(joint(place)));
    }
    let mut model = builder.build().unwrap();
    let step = even_step(&mut model, length / speed);
    let (seen, report) = watched(&mut model, &[], ((height + length + 60.0) / speed, step));
    assert!(report.energy_residual < 1e-10);

    // The first joint and step at which the closed form passes the strength.
    let tension = |depth: f64, t: f64| {
        let (up, down) = (t - (height - depth) / speed, t - (height + depth) / speed);
        impedance * (pulse(down) - pulse(up))
    };
    let (number, expected) = (0..seen.times.len())
        .find_map(|number| {
            let over = |place: &usize| {
                let depth = spacing * (levels - place) as f64;
                tension(depth, seen.times[number]) > strength
            };
            (0..levels).find(over).map(|place| (number, place))
        })
        .unwrap();
    let broken = |records: &[powerhouse_model::JointRecord]| {
        records
            .iter()
            .position(|record| record.state.bond == Bond::Broken)
    };
    let first = seen
        .records
        .iter()
        .position(|records| broken(records).is_some())
        .unwrap();
    let place = broken(&seen.records[first]).unwrap() / 4;
    assert_eq!(place, expected);
    assert!(first.abs_diff(number) <= 1, "{first} {number}");
    let record = &seen.records[first][4 * place];
    assert_eq!(record.state.contact, ContactState::Open);
    assert_eq!(record.first_crack, Some(seen.times[first]));
}
