//! Shapes and sizes of elements.

use powerhouse_material_damage::media;
use powerhouse_model::Vec3;

use super::cell::Row;
use super::trial::{Trial, body, elastic, irregular};

/// Where a point of the irregular body goes.
type Map = fn(Vec3) -> Vec3;

/// How steep an edge is in bodies that are leant on one side so that angles of 5 degrees come about.
fn lean() -> f64 {
    1.0 / 5.0_f64.to_radians().tan()
}

/// Edges of 0.1 mm, 1 m and 10 km along an axis that had steps of 2 m.
fn graded(x: f64) -> f64 {
    match x {
        x if x <= 2.0 => 0.5e-4 * x,
        x if x <= 4.0 => 1e-4 + 0.5 * (x - 2.0),
        x => 1.0001 + 5e3 * (x - 4.0),
    }
}

pub(super) fn rows() -> Vec<Row> {
    let irregular_bodies: [(&str, Map); 7] = [
        ("plates, aspect 1:1000", |p| Vec3::new(p.x, p.y, 1e-3 * p.z)),
        ("needles, aspect 1:1000", |p| {
            Vec3::new(1e-3 * p.x, 1e-3 * p.y, p.z)
        }),
        ("plates, aspect 1:1e6", |p| Vec3::new(p.x, p.y, 1e-6 * p.z)),
        ("volumes of 1e-12 m3", |p| 0.5e-4 * p),
        ("volumes of 1e12 m3", |p| 0.5e4 * p),
        ("elements inside out", |p| Vec3::new(p.x, p.y, -p.z)),
        ("elements without volume", |p| Vec3::new(p.x, p.y, 0.0)),
    ];
    let regular_bodies: [(&str, Map); 4] = [
        ("dihedral angles of 5 degrees", |p| {
            Vec3::new(p.x + lean() * p.z, p.y, p.z)
        }),
        ("dihedral angles of 5 degrees about two axes", |p| {
            Vec3::new(p.x + lean() * p.z, p.y + lean() * p.z, p.z)
        }),
        ("edges of 1e-4, 1 and 1e4 m side by side", |p| {
            Vec3::new(graded(p.x), p.y, p.z)
        }),
        ("volumes of 1e-12 to 1e12 m3 in one body", |p| p.map(graded)),
    ];
    let of_irregular = irregular_bodies.map(|(name, map)| {
        Row::new(name, move |column| {
            Trial::of(column).play(|damping| {
                let mesh = irregular(column)?.map_positions(map)?;
                body(column, &mesh, &elastic(media::ROCK), damping)
            })
        })
    });
    let of_regular = regular_bodies.map(|(name, map)| {
        Row::new(name, move |column| {
            Trial::of(column).play(|damping| {
                let mesh = column
                    .boxed(Vec3::repeat(6.0), [3; 3])?
                    .map_positions(map)?;
                body(column, &mesh, &elastic(media::ROCK), damping)
            })
        })
    });
    of_irregular.into_iter().chain(of_regular).collect()
}
