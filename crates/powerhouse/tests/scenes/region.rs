//! Domain reduction: waves that enter through the layer of elements around a region.

use powerhouse::boundary::{InputMode, Viscous, ViscousSpring};
use powerhouse::engine::observe::Motion;
use powerhouse::model::Vec3;
use powerhouse::{Boundary, Error, FileScene, OutputPlan, Remark, RenderFault as _, Scene, remark};

use super::support::*;

const LOW: Vec3 = Vec3::new(60.0, 60.0, -160.0);
const HIGH: Vec3 = Vec3::new(240.0, 240.0, 0.0);
const BOX: &str = "region = { box = [[60, 60, -160], [240, 240, 0]] }\n";
const SCATTERER: &str = "scatterer = [150, 150, 0]\n";

fn with_region(keys: &str) -> String {
    format!("{SCATTERER}{keys}")
}

fn entering_around(region: Vec<u32>) -> Scene {
    let centre = Vec3::new(150.0, 150.0, 0.0);
    let boundary = Boundary::new(ViscousSpring::default(), SIDES).with_scatterer(centre);
    cube_scene().with_boundary(boundary.with_region(region))
}

/// A region in a file equals that of Rust, by box and by set, and a run reports the number of elements through which
/// the waves enter.
#[test]
fn a_region_is_that_of_rust() {
    let variants = Variants::new("region");
    let inside = cube().elements_in_box(&LOW, &HIGH);
    let keys = with_region(BOX);
    variants.equal((SCATTERER, &keys), entering_around(inside.clone()));
    let simulation = variants.read(SCATTERER, &keys).unwrap().prepare().unwrap();
    // 4 x 4 x 3 bricks, with their layer 6 x 6 x 4, open at the top.
    let told = Remark::from(remark::Region {
        inside: 48,
        layer: 96,
    });
    assert!(simulation.remarks().contains(&told));
}

/// Inside the layer the motion is that of waves through the faces; outside there is only the discretisation error of
/// these bricks.
#[test]
fn outside_the_layer_hardly_anything_moves() {
    let inside = cube().elements_in_box(&LOW, &HIGH);
    let output = OutputPlan::default()
        .history("inside", Vec3::new(150.0, 150.0, 0.0), Motion::DISPLACEMENT)
        .history("outside", Vec3::new(0.0, 0.0, 0.0), Motion::DISPLACEMENT);
    let peaks = |scene: Scene| {
        let results = run(scene.with_output(output.clone()));
        ["inside", "outside"].map(|name| {
            let column = results.histories().column(&format!("{name}.ux")).unwrap();
            column
                .values
                .iter()
                .fold(0.0_f64, |peak, u| peak.max(u.abs()))
        })
    };
    let (by_faces, by_layer) = (peaks(cube_scene()), peaks(entering_around(inside)));
    assert!(
        (by_layer[0] / by_faces[0] - 1.0).abs() < 0.15,
        "{by_layer:?} {by_faces:?}"
    );
    assert!(by_faces[1] > 0.5 * by_faces[0] && by_layer[1] < 0.3 * by_layer[0]);
}

/// An invalid region is an error with its cause, at the region.
#[test]
fn regions_without_a_layer_are_refused() {
    let variants = Variants::new("regions");
    let lined = |x: f64| format!("region = {{ box = [[{x}, 60, -160], [240, 240, 0]] }}\n");
    for (changes, wanted) in [
        (vec![(SCATTERER, with_region(&lined(20.0)))], "on an absorbing face (20 such nodes)"),
        (
            vec![(SCATTERER, with_region("region = { box = [[0, 0, 1], [9, 9, 2]] }\n"))],
            "the region has 0 of 216 elements",
        ),
        (
            vec![(SCATTERER, with_region("region = { set = \"rock\" }\n"))],
            "the region has 216 of 216 elements",
        ),
        (
            vec![(SCATTERER, with_region("region = { set = \"rok\" }\n"))],
            "there is no element set 'rok'",
        ),
        (
            vec![(SCATTERER, with_region("region = { }\n"))],
            "exactly one of set, box must be given, found 0",
        ),
        (
            vec![(SCATTERER, with_region(BOX)), (WAVE, String::new())],
            "but the scene has no wave",
        ),
        (
            vec![
                (SCATTERER, with_region(BOX)),
                ("duration = 0.6", "duration = 0.6\ninitial = \"field\"".into()),
            ],
            "start at rest",
        ),
        (
            vec![
                (SCATTERER, with_region(BOX)),
                (
                    "kernel = \"hex8-full\"",
                    "kernel = \"hex8-full\"\ndamping = { kind = \"coefficients\", mass = 0.1, stiffness = 0 }\n".into(),
                ),
            ],
            "is damped",
        ),
    ] {
        let mut text = CUBE.to_owned();
        for (old, new) in &changes {
            assert!(text.contains(old), "{old}");
            text = text.replacen(old, new, 1);
        }
        let path = variants.0.join("cube.toml");
        let scene = FileScene::from_toml(text, path, &powerhouse::Registry::default());
        let Some(Error::Scene(fault)) = scene.and_then(FileScene::prepare).err() else {
            panic!("{wanted}: not refused in place")
        };
        let shown = fault.render(false);
        assert!(shown.contains(wanted), "{wanted}: {shown}");
        assert!(shown.contains("region ="), "{wanted}: {shown}");
    }
    let keys = with_region(&format!("{BOX}input = \"nothing\"\n"));
    let Err(Error::Scene(fault)) = variants.read(SCATTERER, &keys) else {
        panic!("two inputs")
    };
    let shown = fault.render(false);
    assert!(shown.contains("exactly one of input, region"), "{shown}");
    // The boundary around a layer has no input, from Rust either.
    let quiet = Viscous {
        input: InputMode::Nothing,
    };
    let inside = cube().elements_in_box(&LOW, &HIGH);
    let scene = cube_scene().with_boundary(Boundary::new(quiet, SIDES).with_region(inside));
    assert!(scene.prepare().is_ok());
}
