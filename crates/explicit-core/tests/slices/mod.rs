//! Slices under waves of any azimuth.

mod bits;
mod damage;
mod free_field;
mod long_bodies;
mod refusals;
mod steps;
mod tunnels;

pub(crate) use steps::{free, growth, noise};

use std::sync::Arc;

use powerhouse_boundary::ViscousSpring;
use powerhouse_elements::{AnyLaw, SolidKernel};
use powerhouse_explicit_core::{BuildModel, Model};
use powerhouse_material_damage::{
    ElastoPlastic, LinearElastic, Mazars, MazarsParameters, MazarsTension, MohrCoulomb,
    MohrCoulombParameters,
};
use powerhouse_model::{
    AbsorbingBoundary, BlockOptions, BoundarySite, DelayedPairs, ElasticMedium, Mesh, ModelError,
    ModelSpec, PeriodicPairs, Vec3,
};
use powerhouse_wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, Ricker, RickerQuantity, WaveKind,
};

pub(crate) fn rock() -> ElasticMedium {
    ElasticMedium::new(9.0e9, 0.27, 2700.0).unwrap()
}

/// Rock that yields early by Mohr-Coulomb.
pub(crate) fn yielding() -> AnyLaw {
    let surface = MohrCoulomb::new(MohrCoulombParameters {
        medium: rock(),
        friction: 0.3,
        dilation: 0.1,
        cohesion: 6e4,
        tension_strength: None,
    });
    ElastoPlastic::new(surface.unwrap()).into()
}

/// Rock that breaks from a strain (1) on, and keeps a thousandth of its stiffness.
pub(crate) fn brittle(threshold: f64) -> AnyLaw {
    let law = Mazars::new(MazarsParameters {
        medium: rock(),
        threshold,
        tension: MazarsTension::Rates {
            share: 1.0,
            rate: 1.5 / threshold,
        },
        compression_share: 1.0,
        compression_rate: 1.5 / threshold,
        residual_stiffness: 1e-3,
    });
    law.unwrap().into()
}

/// A plane wave in a half-space under z = 0: a Ricker pulse of the displacement that passes the origin at a time (s).
pub(crate) fn wave(
    kind: WaveKind,
    [incidence, azimuth]: [f64; 2],
    (frequency, delay): (f64, f64),
) -> PlaneWave {
    let mut parameters = PlaneWaveParameters::vertical(kind, rock(), 0.0);
    parameters.incidence = Angle::from_degrees(incidence);
    parameters.azimuth = Angle::from_degrees(azimuth);
    let pulse = Ricker::new(RickerQuantity::Displacement, 1e-3, frequency, delay).unwrap();
    PlaneWave::new(parameters, Arc::new(pulse)).unwrap()
}

/// Slowness along y of a wave in rock (s/m).
pub(crate) fn slowness(kind: WaveKind, [incidence, azimuth]: [f64; 2]) -> f64 {
    let speed = kind.speed(&rock());
    incidence.to_radians().sin() * azimuth.to_radians().sin() / speed
}

/// Pairs of the nodes of two faces of a mesh.
pub(crate) fn pairs(mesh: &Mesh) -> Vec<(u32, u32)> {
    let [front, back] =
        ["front", "back"].map(|face| mesh.nodes_of_facets(mesh.facet_set(face).unwrap()));
    PeriodicPairs::by_translation(mesh, &front, &back, 1e-6)
        .unwrap()
        .pairs
}

/// A slice of rock around y = 0 with absorbing sides and bottom, under a wave.
pub(super) fn spec<'a>(
    mesh: &'a Mesh,
    kernel: SolidKernel,
    wave: &PlaneWave,
    slowness: f64,
) -> Result<ModelSpec<'a>, ModelError> {
    let faces = ["left", "right", "bottom"].map(|face| (face, mesh.facet_set(face).unwrap()));
    let site = BoundarySite::from_mesh(mesh, &faces, |_| rock(), Vec3::zeros(), Some(wave));
    let site = site.with_slowness(slowness);
    let parts = ViscousSpring::default().build(&site)?;
    let law = LinearElastic::new(rock());
    Ok(Model::builder(mesh)
        .elements("rock", kernel.factory("rock", law, BlockOptions::default()))
        .boundary(parts)
        .delayed(DelayedPairs {
            pairs: pairs(mesh),
            slowness,
            ..DelayedPairs::default()
        }))
}

/// Motion of the slice at the middle of each pair (m).
pub(super) fn middle(model: &Model, pairs: &[(u32, u32)]) -> Vec<Vec3> {
    let of = |&(a, b): &(u32, u32)| (model.displacement(a) + model.displacement(b)) * 0.5;
    pairs.iter().map(of).collect()
}

/// Builds a model.
pub(super) fn built(spec: ModelSpec) -> Model {
    spec.build().unwrap()
}
