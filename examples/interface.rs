//! A slipping interface under a shear wave between two columns of rock, for examples of joints.

use std::f64::consts::{PI, TAU};
use std::time::Instant;

use powerhouse::contact::{BondedCoulomb, Joint, Tied};
use powerhouse::engine::{BuildModel, NodalForce};
use powerhouse::material::media;
use powerhouse::model::{BoundaryParts, Constraint, Mat3, NodalImpedance, Vec3};

use crate::Outcome;
use crate::column::{Column, even_step, watch};

/// Transmitted, reflected and absorbed shares of energy at an interface whose shear strength is the share `s` of the
/// wave's shear stress: `th = asin s`,
/// `T = (4/pi) ((th - sin th cos th)/2 + s^2 (pi/2 - th))`,
/// `1 - T - R = (8/pi) (s cos th - s^2 (pi/2 - th))`.
#[must_use]
pub fn closed_form(s: f64) -> [f64; 3] {
    let (th, rest) = (s.asin(), s.acos());
    let transmitted = 4.0 / PI * ((th - s * th.cos()) / 2.0 + s * s * rest);
    let absorbed = 8.0 / PI * (s * th.cos() - s * s * rest);
    [transmitted, 1.0 - transmitted - absorbed, absorbed]
}

/// The shares computed with a column of rock with a number of elements per wavelength, and the wall time (s) of the run
/// with slip.
///
/// # Errors
/// A number of elements that is not a multiple of four; any error of the run.
pub fn computed(s: f64, bricks: usize) -> Outcome<([f64; 3], f64)> {
    // The motion is recorded a quarter of a wavelength from the interface.
    if !bricks.is_multiple_of(4) {
        return Err(format!("{bricks} bricks per wavelength are no multiple of four").into());
    }
    let (frequency, amplitude, friction) = (5.0, 0.1, 0.6);
    let impedance = media::ROCK.density * media::ROCK.s_speed();
    let wavelength = media::ROCK.s_speed() / frequency;
    let parts = [(2 * bricks, media::ROCK), (bricks / 2, media::ROCK)];
    let column = Column::new(&parts, wavelength / bricks as f64)?;
    let (foot, top) = (column.level(0.0), column.level(2.5 * wavelength));
    let watched = [1.75, 2.25].map(|place| column.level(place * wavelength)[0]);
    let seen = |joint: Box<dyn Constraint>| {
        let mut ends = BoundaryParts::default();
        ends.impedance.extend(foot.iter().chain(&top).map(|&node| {
            NodalImpedance::new(node, Mat3::zeros(), Mat3::identity() * (impedance / 4.0))
        }));
        let wave = move |t: f64| amplitude * (TAU * frequency * t).sin();
        let push = Vec3::x() * (2.0 * impedance / 4.0);
        let mut model = column
            .along(0)
            .boundary(ends)
            .load(Box::new(NodalForce::new(
                foot.clone(),
                push,
                Box::new(wave),
            )))
            .constraint(joint)
            .build()?;
        let step = even_step(&mut model, 1.0 / frequency)?;
        let (seen, _) = watch(&mut model, &watched, (6.0 / frequency, step))?;
        Outcome::Ok(seen)
    };
    let pairs = || column.joints[0].pairs.clone();
    let whole = seen(Box::new(Joint::new("bonded", pairs(), Tied)?))?;
    // Constant pressure is a preload: the static state from which the wave starts.
    let pressure = s * impedance * amplitude / friction;
    let joint = Joint::new(
        "slipping",
        pairs(),
        BondedCoulomb::unbonded(friction, friction)?,
    )?
    .with_preload(|_| Vec3::z() * -pressure)?;
    let started = Instant::now();
    let slipping = seen(Box::new(joint))?;
    let seconds = started.elapsed().as_secs_f64();
    // Over the last two cycles.
    let end = whole.times.len() - 1;
    let from = whole
        .times
        .partition_point(|&t| t < whole.times[end] - 2.0 / frequency + 1e-9);
    let sum = |value: &dyn Fn(usize) -> f64| (from..end).map(|k| value(k).powi(2)).sum::<f64>();
    let incident = sum(&|k| whole.velocity[0][k].x);
    let reflected = sum(&|k| slipping.velocity[0][k].x - whole.velocity[0][k].x);
    let transmitted = sum(&|k| slipping.velocity[1][k].x);
    let friction = |k: usize| {
        slipping.pairs[k]
            .iter()
            .map(|pair| pair.friction)
            .sum::<f64>()
    };
    // The incident energy flux is Z V^2 / 2 (W/m2).
    let absorbed = (friction(end) - friction(from)) * frequency / (impedance * amplitude.powi(2));
    let shares = [transmitted / incident, reflected / incident, absorbed];
    Ok((shares, seconds))
}
