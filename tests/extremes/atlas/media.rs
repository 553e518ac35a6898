//! Media: nearly incompressible ones, auxetic ones, and contrasts.

use powerhouse::engine::{BuildModel, Model};
use powerhouse_material_damage::media;
use powerhouse_model::{ElasticMedium, Rayleigh};

use super::cell::{Refusal, Row};
use super::column::Column;
use super::trial::{Trial, body, elastic, irregular, shaken};

pub(super) fn rows() -> Vec<Row> {
    let ratios = [
        -1.0, -0.999, -0.5, 0.0, 0.49, 0.4999, 0.49999, 0.4999999, 0.5,
    ];
    let poisson = ratios.map(|poisson| {
        Row::new(format!("Poisson's ratio {poisson}"), move |column| {
            Trial::of(column).play(|damping| {
                let medium = ElasticMedium::new(9e9, poisson, 2750.0)?;
                body(column, &irregular(column)?, &elastic(medium), damping)
            })
        })
    });
    let contrasts = [
        ("stiffness 1e6 times across an interface", 1e6, 1.0),
        ("density 1e4 times across an interface", 1.0, 1e4),
        ("both, the denser side stiffer", 1e6, 1e4),
        ("both, the denser side softer", 1e6, 1e-4),
    ];
    let contrasts = contrasts.map(|(name, stiffness, density)| {
        Row::new(name, move |column| {
            Trial::of(column).play(|damping| two_halves(column, (stiffness, density), damping))
        })
    });
    poisson.into_iter().chain(contrasts).collect()
}

/// Rock, and above it a medium with multiples of its stiffness and density.
fn two_halves(
    column: &Column,
    (stiffness, density): (f64, f64),
    damping: Rayleigh,
) -> Result<Model, Refusal> {
    let mesh = irregular(column)?;
    let rock = media::ROCK;
    let other = ElasticMedium::new(rock.young * stiffness, 0.2, rock.density * density)?;
    let all = 0..mesh.element_count() as u32;
    let (lower, upper): (Vec<u32>, Vec<u32>) = all.partition(|&e| mesh.centroid(e).z < 2.2);
    let builder = Model::builder(&mesh)
        .elements(lower, column.factory(&elastic(rock), damping))
        .elements(upper, column.factory(&elastic(other), damping));
    shaken(builder.threads(1).build()?, 1.0)
}
