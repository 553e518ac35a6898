//! Scenes on an engine of the user's.

use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::prelude::{
    LinearElastic, Material, Mesh, Motion, OutputPlan, Part, Scene, Vec3, media,
};
use powerhouse::{Boundary, FileScene, Registry, ResidualLimit, Results, RunHooks, TimeStep};
use powerhouse_model::Engine;
use powerhouse_tests::oblique_waves;
use powerhouse_wavefield::WaveKind;

use super::naive::Naive;

/// A box under an oblique wave, on an engine or on the standard one.
fn results(engine: Option<Arc<dyn Engine>>) -> Results {
    let size = Vec3::new(40.0, 30.0, 20.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [4, 3, 2], "rock").unwrap();
    let field = oblique_waves(media::ROCK, size, &[(WaveKind::SV, 20.0)], 37.0, 0.02);
    let top = Vec3::new(20.0, 10.0, 20.0);
    let output = OutputPlan::default().with_every(1e-3);
    let boundary = Boundary::new(
        ViscousSpring::default(),
        ["left", "right", "front", "back", "bottom"],
    );
    let mut scene = Scene::new("box", mesh)
        .part(Part::new(
            "rock",
            Material::from(LinearElastic::new(media::ROCK)),
        ))
        .with_field(field)
        .with_boundary(boundary.with_scatterer(top))
        .with_output(output.history("top", top, Motion::ALL))
        .with_energy_residual(ResidualLimit::Unchecked)
        .with_step(TimeStep::Seconds(5e-4))
        .with_duration(0.05)
        .allow_magnitudes();
    if let Some(engine) = engine {
        scene = scene.with_engine(engine);
    }
    scene.prepare().unwrap().run(RunHooks::default()).unwrap()
}

/// A scene runs on an engine that a user gives, with the histories of the standard one.
#[test]
fn a_scene_runs_on_another_engine() {
    let (standard, naive) = (results(None), results(Some(Arc::new(Naive))));
    let columns = standard.histories().columns.iter();
    for (expected, found) in columns.zip(&naive.histories().columns) {
        assert_eq!(expected.name, found.name);
        let size = expected
            .values
            .iter()
            .fold(0.0_f64, |most, v| most.max(v.abs()));
        let pairs = expected.values.iter().zip(&found.values);
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(
            size > 0.0 && worst < 1e-10 * size,
            "{}: {worst:e} of {size:e}",
            expected.name
        );
    }
    assert!(!standard.histories().columns.is_empty());
    let engines = (&standard.run.stable, &naive.run.stable);
    assert!(
        engines.0.is_some() && engines.1.is_none(),
        "both ran on one engine"
    );
}

/// A registry gives its engine to the scenes that are read with it.
#[test]
fn a_registry_gives_its_engine_to_scenes() {
    let registry = Registry::default().with_engine(Arc::new(Naive));
    assert_eq!(registry.engine().name(), "naive");
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../data/scenes/cavern_small.toml"
    );
    let scene = FileScene::from_file_with(path, &registry).unwrap();
    assert_eq!(scene.engine().name(), "naive");
}
