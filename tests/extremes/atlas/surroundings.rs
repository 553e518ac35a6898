//! Boundaries, and the waves and records that enter through them.

use std::sync::Arc;

use powerhouse::engine::{BuildModel, Model};
use powerhouse_boundary::{AxisParameters, ViscousSpring};
use powerhouse_material_damage::media;
use powerhouse_model::{AbsorbingBoundary, BoundarySite, IncidentField, Rayleigh, Vec3};
use powerhouse_wavefield::{
    Angle, EndDisplacement, PlaneWave, PlaneWaveParameters, Signal, SmoothPulse, TimeHistory,
    WaveKind, critical_angle, first_hit_corner,
};

use super::cell::{Refusal, Row};
use super::column::{Column, SET};
use super::trial::{Trial, elastic, shaken};

const SIZE: Vec3 = Vec3::new(30.0, 30.0, 20.0);
const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];
/// Peak displacement of the incident waves (m), and greatest permitted displacement of the ground: the surface
/// coefficients of rock are below 6 at every angle.
const AMPLITUDE: f64 = 0.01;
const MOST: f64 = 10.0 * AMPLITUDE;

/// A box of rock with springs and dashpots on all sides but its top, from a centre at a distance (m) if
/// one is given, under a field if there is one.
fn ground(
    column: &Column,
    distance: Option<f64>,
    field: Option<&dyn IncidentField>,
    damping: Rayleigh,
) -> Result<Model, Refusal> {
    let mesh = column.boxed(SIZE, [3, 3, 2])?;
    let mut faces = Vec::new();
    for face in FACES {
        faces.push((face, mesh.facet_set(face)?));
    }
    let middle = Vec3::new(15.0, 15.0, 20.0);
    let site = BoundarySite::from_mesh(&mesh, &faces, |_| media::ROCK, middle, field);
    let boundary = ViscousSpring {
        axes: [AxisParameters::new(0.8, 1.1, distance)?; 3],
        ..ViscousSpring::default()
    };
    let model = Model::builder(&mesh)
        .elements(SET, column.factory(&elastic(media::ROCK), damping))
        .boundary(boundary.build(&site)?)
        .threads(1)
        .build()?;
    Ok(model)
}

/// A wave at an incidence.
fn wave(
    kind: WaveKind,
    incidence: Angle,
    signal: impl Signal + 'static,
) -> Result<PlaneWave, Refusal> {
    let mut parameters = PlaneWaveParameters::vertical(kind, media::ROCK, SIZE.z);
    (parameters.incidence, parameters.azimuth) = (incidence, Angle::from_degrees(37.0));
    parameters.reference = first_hit_corner(&Vec3::zeros(), &SIZE, &parameters.direction());
    Ok(PlaneWave::new(parameters, Arc::new(signal))?)
}

pub(super) fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for share in [0.0, 0.01, 1.0, 1e5, 1e6] {
        let name = format!("viscous springs, r = {share} of the box, shaken");
        rows.push(Row::new(name, move |column| {
            Trial::of(column).play(|damping| {
                let distance = Some(share * SIZE.x);
                shaken(ground(column, distance, None, damping)?, 1.0)
            })
        }));
    }
    rows.extend(incidences());
    for (name, duration) in [
        ("a pulse shorter than a hundredth of an element", 1e-4),
        ("a pulse shorter than an element", 4e-3),
        ("a pulse longer than the run", 1e3),
    ] {
        rows.push(driven(name, move || {
            let pulse = SmoothPulse::new(AMPLITUDE, duration)?;
            wave(WaveKind::SV, Angle::from_degrees(20.0), pulse)
        }));
    }
    rows.extend(records());
    rows
}

/// A row: a box under a wave.
fn driven(
    name: impl Into<String>,
    wave: impl Fn() -> Result<PlaneWave, Refusal> + Sync + 'static,
) -> Row {
    Row::new(name, move |column| {
        Trial::of(column)
            .steps(400)
            .within(MOST)
            .play(|damping| ground(column, None, Some(&wave()?), damping))
    })
}

fn incidences() -> Vec<Row> {
    let critical = critical_angle(&media::ROCK).radians();
    let mut angles = Vec::new();
    for kind in [WaveKind::P, WaveKind::SV, WaveKind::SH] {
        for degrees in [0.0, 89.0, 89.9, 89.999, 90.0] {
            angles.push((
                format!("{kind} at {degrees} degrees"),
                kind,
                Angle::from_degrees(degrees),
            ));
        }
    }
    for (name, beside) in [
        ("1e-12 below the", -1e-12),
        ("at the", 0.0),
        ("1e-12 above the", 1e-12),
    ] {
        let angle = Angle::from_radians(critical + beside);
        angles.push((format!("SV {name} critical angle"), WaveKind::SV, angle));
    }
    let row = |(name, kind, angle): (String, WaveKind, Angle)| {
        driven(name, move || {
            wave(kind, angle, SmoothPulse::new(AMPLITUDE, 0.1)?)
        })
    };
    angles.into_iter().map(row).collect()
}

/// Acceleration of one sign, twice as long of the other and again of the first, each `samples` long between
/// samples of zero: zero velocity and displacement at the end.
fn there_and_back(samples: usize, step: f64) -> Vec<f64> {
    let peak = AMPLITUDE / (samples as f64 * step).powi(2);
    let mut history = vec![0.0];
    for (value, count) in [(peak, samples), (-peak, 2 * samples), (peak, samples)] {
        history.extend(vec![value; count]);
        history.push(0.0);
    }
    history
}

fn records() -> Vec<Row> {
    type Samples = fn() -> Vec<f64>;
    let records: [(&str, f64, Samples, f64); 6] = [
        ("a record of one sample", 0.01, || vec![1.0], 0.0),
        ("a record of two samples", 0.01, || vec![1.0, -1.0], 0.0),
        (
            "a record of two samples, its displacement declared",
            0.01,
            || vec![1.0, -1.0],
            1e-4 / 6.0,
        ),
        (
            "a record of constant acceleration",
            0.01,
            || vec![1.0; 100],
            0.0,
        ),
        (
            "a record with steps",
            1e-3,
            || there_and_back(50, 1e-3),
            0.0,
        ),
        (
            "a record of 1e6 samples",
            1e-7,
            || there_and_back(249_999, 1e-7),
            0.0,
        ),
    ];
    let row = |(name, step, samples, end): (&'static str, f64, Samples, f64)| {
        driven(name, move || {
            let history = TimeHistory::new(step, samples())?;
            let signal = history.into_signal(EndDisplacement::Declared(end))?;
            wave(WaveKind::SV, Angle::from_degrees(20.0), signal)
        })
    };
    records.map(row).into()
}
