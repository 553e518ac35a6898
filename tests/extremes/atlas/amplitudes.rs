//! Motions of extreme amplitudes, and motions on top of a rigid displacement.

use powerhouse::engine::{Model, run};
use powerhouse_material_damage::media;
use powerhouse_model::{RunError, RunOptions, StepChoice, Vec3};

use super::cell::{Cell, Found, Refusal, Row};
use super::column::Column;
use super::trial::{Trial, body, elastic, irregular, random_velocities};

pub(super) fn rows() -> Vec<Row> {
    let scaled = [-900, -100, -60, 60, 100, 400].map(|exponent| {
        Row::new(
            format!("amplitudes times 2^{exponent}, the same bits"),
            move |column| same_bits(column, exponent),
        )
    });
    let moved = [1e4, 1e9].map(|offset| {
        Row::new(
            format!("a rigid offset of {offset:e} wave amplitudes"),
            move |column| offset_by(column, offset),
        )
    });
    scaled.into_iter().chain(moved).collect()
}

/// A body with the column's scheme and number format.
fn resting(column: &Column) -> Result<Model, Refusal> {
    Trial::of(column)
        .model(|damping| body(column, &irregular(column)?, &elastic(media::ROCK), damping))
}

/// Displacements after some steps from an initial motion, or the reason of a refusal.
fn displacements(
    column: &Column,
    (steps, speed_limit): (u64, f64),
    start: impl Fn(&Model) -> (Vec<Vec3>, Vec<Vec3>),
) -> Result<Result<Vec<Vec3>, Refusal>, RunError> {
    let moving = || -> Result<(Model, f64), Refusal> {
        let mut model = resting(column)?;
        let (displacement, velocity) = start(&model);
        model.set_initial(&displacement, &velocity)?;
        let step = model.stable_step(column.integrator())?.step;
        Ok((model, step))
    };
    let (mut model, step) = match moving() {
        Ok(moving) => moving,
        Err(refusal) => return Ok(Err(refusal)),
    };
    // Any amplitude is admissible for a medium that is linear at every strain; energies, whose squares exceed
    // the range of numbers, are not computed.
    let options = RunOptions::steps(steps)
        .with_step(StepChoice::Fixed(step))
        .with_speed_limit(speed_limit);
    run(
        &mut model,
        column.integrator(),
        &options,
        &mut [],
        &mut |_| {},
    )?;
    let nodes = 0..model.mesh().node_count() as u32;
    Ok(Ok(nodes.map(|node| model.displacement(node)).collect()))
}

/// Linear motion scales bit for bit by a power of two.
fn same_bits(column: &Column, exponent: i32) -> Found {
    let at = |factor: f64| {
        displacements(column, (300, f64::MAX), |model| {
            let nodes = model.mesh().node_count();
            let velocity = random_velocities(nodes, factor);
            (vec![Vec3::zeros(); nodes], velocity)
        })
    };
    let factor = 2.0_f64.powi(exponent);
    let plain = at(1.0).map_err(|error| error.to_string())?;
    let scaled = at(factor).map_err(|error| error.to_string())?;
    let (plain, scaled) = match (plain, scaled) {
        (Ok(plain), Ok(scaled)) => (plain, scaled),
        (Err(refusal), _) => return Err(refusal.to_string()),
        (_, Err(refusal)) => return Ok(Cell::Refused(refusal.to_string())),
    };
    let differ = plain
        .iter()
        .zip(&scaled)
        .position(|(a, b)| a * factor != *b);
    match differ {
        None => Ok(Cell::Stable),
        Some(node) => Err(format!(
            "node {node}: {} times {factor:e} is {}",
            plain[node], scaled[node]
        )),
    }
}

/// A wave of 1 mm has the same effect on a rigidly displaced body.
fn offset_by(column: &Column, offset: f64) -> Found {
    const WAVE: f64 = 1e-3;
    let at = |offset: Vec3| {
        displacements(column, (300, 1e4), move |model| {
            let positions = model.mesh().positions().iter();
            let shape =
                |p: &Vec3| Vec3::new((0.5 * p.z).sin(), (0.4 * p.x).cos(), (0.3 * p.y).sin());
            let displacement = positions.map(|p| offset + WAVE * shape(p)).collect();
            (displacement, vec![Vec3::zeros(); model.mesh().node_count()])
        })
    };
    let away = offset * WAVE * Vec3::new(0.6, -0.7, 0.4);
    let at_home = at(Vec3::zeros()).map_err(|error| error.to_string())?;
    let elsewhere = at(away).map_err(|error| error.to_string())?;
    let (at_home, elsewhere) = match (at_home, elsewhere) {
        (Ok(at_home), Ok(elsewhere)) => (at_home, elsewhere),
        (Err(refusal), _) => return Err(refusal.to_string()),
        (_, Err(refusal)) => return Ok(Cell::Refused(refusal.to_string())),
    };
    let pairs = at_home.iter().zip(&elsewhere);
    let worst = pairs.fold(0.0_f64, |worst, (a, b)| worst.max((b - away - a).norm()));
    // Rounding error of the displacement in the nodes' number format, summed over all steps, and that of the
    // strains and their waves.
    let digits = match column.precision {
        powerhouse_model::Precision::F32 => f64::from(f32::EPSILON),
        _ => f64::EPSILON,
    };
    let elements = match column.precision {
        powerhouse_model::Precision::F64 => 0.0,
        _ => 300.0 * f64::from(f32::EPSILON) * WAVE,
    };
    let permitted = 300.0 * digits * (offset * WAVE + WAVE) + elements;
    if worst <= permitted {
        Ok(Cell::Stable)
    } else {
        Err(format!("differs by {worst:e} m, {permitted:e} permitted"))
    }
}
