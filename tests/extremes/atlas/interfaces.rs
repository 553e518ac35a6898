//! Joints at the ends of all ranges.

use powerhouse::engine::{BuildModel, Model};
use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_material_damage::media;
use powerhouse_model::{ElasticMedium, Rayleigh, Vec3};

use super::cell::{Refusal, Row};
use super::column::Column;
use super::trial::{Trial, elastic, shaken};

/// A joint between two blocks.
#[derive(Clone, Copy)]
struct Interface {
    /// Tensile and shear strength (Pa).
    strength: f64,
    friction: f64,
    /// Density and stiffness of the upper block over those of the lower one.
    ratio: f64,
}

pub(super) fn rows() -> Vec<Row> {
    let joint = |strength, friction, ratio| Interface {
        strength,
        friction,
        ratio,
    };
    let ends = [
        ("of no strength and no friction", joint(0.0, 0.0, 1.0)),
        ("of no strength, friction 10", joint(0.0, 10.0, 1.0)),
        ("of infinite strength", joint(f64::INFINITY, 0.5, 1.0)),
        ("that breaks on the way", joint(1e6, 0.5, 1.0)),
        (
            "below a body a million times as heavy",
            joint(1e6, 0.5, 1e6),
        ),
        ("below a body a millionth as heavy", joint(1e6, 0.5, 1e-6)),
        ("of negative strength", joint(-1.0, 0.5, 1.0)),
    ];
    let row = |(name, interface): (&'static str, Interface)| {
        Row::new(format!("a joint {name}"), move |column| {
            Trial::of(column).play(|damping| blocks(column, interface, damping))
        })
    };
    ends.map(row).into()
}

/// Two blocks on each other with a joint between them, the upper one so many times as dense and stiff.
fn blocks(column: &Column, interface: Interface, damping: Rayleigh) -> Result<Model, Refusal> {
    let Interface {
        strength,
        friction,
        ratio,
    } = interface;
    let mesh = column.boxed(Vec3::new(2.0, 2.0, 2.0), [2, 2, 4])?;
    let all = 0..mesh.element_count() as u32;
    let (lower, upper): (Vec<u32>, Vec<u32>) = all.partition(|&e| mesh.centroid(e).z < 1.0);
    let split = mesh.split_between(&lower, &upper)?;
    let options = SurfaceOptions::within(1e-6)?;
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options)?;
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: strength,
        tensile_strength: strength,
        static_friction: friction,
        dynamic_friction: friction,
        cohesion_loss: true,
    })?;
    let rock = media::ROCK;
    let other = ElasticMedium::new(rock.young * ratio, rock.poisson, rock.density * ratio)?;
    let model = Model::builder(&split.mesh)
        .elements(lower, column.factory(&elastic(rock), damping))
        .elements(upper, column.factory(&elastic(other), damping))
        .constraint(Box::new(Joint::new("joint", surface.pairs, law)?))
        .threads(1)
        .build()?;
    shaken(model, 1.0)
}
