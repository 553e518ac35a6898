//! The free-field check of a scene with layered ground.

use std::path::Path;

use powerhouse::model::{ElasticMedium, Vec3};
use powerhouse::wavefield::{StationField, StationParameters};
use powerhouse::{RunHooks, Scene};
use powerhouse_study::{FreeFieldCheck, StudyError};

fn site() -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/layered_site.toml");
    Scene::from_file(file).unwrap()
}

/// The box of a layered site has its layers, each with rows of its own, and moves like the layered field: within
/// 4 % of displacement and 6 % of velocity at 17 elements to the wavelength in clay.
#[test]
fn the_box_of_a_layered_site_has_its_layers() {
    let check = FreeFieldCheck::of(&site()).unwrap();
    let report = check.run(0.0, RunHooks::default()).unwrap();
    println!("{report:?}");
    assert_eq!(report.cells, [25, 1, 15]);
    assert!(report.damped.is_none());
    let displacement = report.points.iter().map(|point| point.displacement);
    assert!(displacement.fold(0.0, f64::max) < 0.04 && report.largest() < 0.06);
}

/// Motions at stations have no stress, which the boundary of the box needs: the check refuses them by name.
#[test]
fn a_field_without_stress_is_refused() {
    let field = StationField::new(StationParameters {
        name: "site.h5drm".into(),
        positions: vec![Vec3::zeros()],
        inner: None,
        medium: ElasticMedium::new(1e9, 0.25, 2000.0).unwrap(),
        start: 0.0,
        step: 0.1,
        samples: 2,
        has_velocity: false,
        motion: vec![0.0; 6],
        tolerance: 0.01,
    });
    let error = FreeFieldCheck::of(&site().with_field(field.unwrap())).err();
    let Some(StudyError::FieldWithoutStress { field }) = error else {
        panic!("not refused: {error:?}")
    };
    assert_eq!(field, "site.h5drm");
}
