//! The free-field check of a scene with layered ground.

use std::path::Path;

use powerhouse::{RunHooks, Scene};
use powerhouse_study::FreeFieldCheck;

/// The box of a layered site has its layers, each with rows of its own, and moves like the layered field: within
/// 4 % of displacement and 6 % of velocity at 17 elements to the wavelength in clay.
#[test]
fn the_box_of_a_layered_site_has_its_layers() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/layered_site.toml");
    let scene = Scene::from_file(file).unwrap();
    let check = FreeFieldCheck::of(&scene).unwrap();
    let report = check.run(0.0, RunHooks::default()).unwrap();
    println!("{report:?}");
    assert_eq!(report.cells, [25, 1, 15]);
    assert!(report.damped.is_none());
    let displacement = report.points.iter().map(|point| point.displacement);
    assert!(displacement.fold(0.0, f64::max) < 0.04 && report.largest() < 0.06);
}
