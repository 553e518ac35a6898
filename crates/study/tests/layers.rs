//! The free-field check of a scene with layered ground.

use std::path::Path;

use powerhouse::boundary::{ReductionLayer, Viscous};
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::{StationField, StationParameters};
use powerhouse::{Boundary, FileScene, Material, Part, Registry, Remark, RunHooks, Scene};
use powerhouse_study::sweep::{Sweep, SweepWatch};
use powerhouse_study::{FreeFieldCheck, StudyError, check};
use powerhouse_test_support::TestFolder;

fn site() -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/layered_site.toml");
    FileScene::from_file(file).unwrap().into_scene()
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

/// So does the box of a slice with delayed sides under the same wave at an azimuth of 60 degrees.
#[test]
fn the_box_of_a_layered_slice_has_its_layers() {
    let folder = TestFolder::new("layered-slice");
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let scene = std::fs::read_to_string(data.join("scenes/layered_site.toml")).unwrap();
    let mesh = data.join("meshes/layered_site.msh");
    let text = scene.replace("../meshes/layered_site.msh", &mesh.display().to_string());
    let rollers = "[[support]]\nkind = \"roller\"\nset = \"front\"\n[[support]]\nkind = \"roller\"\nset = \"back\"\n";
    let delayed = "[[support]]\nkind = \"delayed\"\nfrom = \"front\"\nto = \"back\"\n";
    assert!(text.contains(rollers));
    let text = text.replacen(rollers, delayed, 1);
    let text = text.replacen("kind = \"sv\"", "kind = \"sv\"\nazimuth = 60", 1);
    std::fs::write(folder.join("slice.toml"), text).unwrap();
    let scene = FileScene::from_file(folder.join("slice.toml"))
        .unwrap()
        .into_scene();
    let check = FreeFieldCheck::of(&scene).unwrap();
    let report = check.run(0.0, RunHooks::default()).unwrap();
    println!("{report:?}");
    assert_eq!(report.cells[1], 1);
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

/// A scene whose waves are known at stations alone is checked as others are: its spectrum is that of a station.
#[test]
fn a_scene_of_stations_is_checked() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(70.0), [7; 3], "rock").unwrap();
    let region = mesh.elements_in_box(&Vec3::new(20.0, 20.0, 30.0), &Vec3::new(50.0, 50.0, 70.0));
    let layer = mesh.nodes_of_elements(&ReductionLayer::elements(&mesh, &region));
    let places = layer.iter().map(|&node| mesh.positions()[node as usize]);
    let positions: Vec<Vec3> = places.collect();
    // A pulse of 0.2 s at all stations at once, after some rest.
    let pulse = |sample: usize| {
        let turn = (sample.saturating_sub(8) as f64 * 0.025).min(1.0) * core::f64::consts::TAU;
        [0.005 * (1.0 - turn.cos()), 0.0, 0.0]
    };
    let motion = (0..60 * positions.len()).flat_map(|index| pulse(index % 60));
    let field = StationField::new(StationParameters {
        name: "pulse.csv".into(),
        inner: None,
        medium: media::ROCK,
        start: 0.0,
        step: 0.005,
        samples: 60,
        has_velocity: false,
        motion: motion.collect(),
        positions,
        tolerance: 0.01,
    });
    let faces = ["left", "right", "front", "back", "bottom"];
    let rock = Material::from(LinearElastic::new(media::ROCK));
    let scene = Scene::new("stations", mesh)
        .part(Part::new("rock", rock))
        .with_field(field.unwrap())
        .with_boundary(Boundary::new(Viscous::default(), faces).with_region(region))
        .with_duration(0.25);
    let report = check(scene).unwrap();
    assert!(!report.resolution.is_empty());
}

/// Cases whose layers soften differently share their stages, in which the ground has the moduli of small strain, and begin in
/// equilibrium; a case with layers, or an in-situ stress, of its own has these.
#[test]
fn cases_of_softened_layers_share_their_stages() {
    let folder = TestFolder::new("softened-cases");
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let scene = std::fs::read_to_string(data.join("scenes/layered_site.toml")).unwrap();
    let mesh = data.join("meshes/layered_site.msh");
    let mut text = scene.replace("../meshes/layered_site.msh", &mesh.display().to_string());
    let curves = "strain_curves = { kind = \"darendeli\", plasticity = 15, pressure = 1e5 }";
    text = text.replacen("bottom = -20 ", &format!("{curves}\nbottom = -20 "), 1);
    let supports = ["left", "right", "front", "back", "bottom"]
        .map(|set| format!("{{ kind = \"roller\", set = \"{set}\" }}"))
        .join(", ");
    text.push_str(&format!(
        "\n[[load]]\nkind = \"gravity\"\n[[stage]]\nname = \"weight\"\nsupport = [{supports}]\n"
    ));
    for (name, size) in [("weak", 1e-4), ("strong", 3e-3)] {
        text.push_str(&format!(
            "[[case]]\nname = \"{name}\"\nwave = [{{ kind = \"sv\", incidence = 15, pulse = {{ kind = \"ricker\", displacement = {size:?}, frequency = 3 }} }}]\n"
        ));
    }
    let path = folder.join("site.toml");
    std::fs::write(&path, &text).unwrap();
    let run = |out: &str| {
        let sweep = Sweep::of_file(&path, Some(folder.join(out))).unwrap();
        let outcomes = sweep.with_duration(0.02).unwrap().run(None, &mut Silent);
        let bodies = std::fs::read_dir(folder.join(out).join("at-rest")).unwrap();
        (outcomes.unwrap().len(), bodies.count())
    };
    assert_eq!(run("shared"), (2, 1));

    text.push_str(
        "[[case]]\nname = \"pressed\"\nin_situ_stress = { kind = \"ground\", level = 0, density = 1900, lateral = 0.5 }\n\
         [[case]]\nname = \"stiff\"\nlayer = [{ material = \"clay\", bottom = -20 }, { material = \"gravel\", bottom = -40 }, { material = \"rock\" }]\n",
    );
    std::fs::write(&path, text).unwrap();
    assert_eq!(run("own"), (4, 2));
    let scene = |case: &str| {
        FileScene::case_from_file_with(&path, case, &Registry::default())
            .unwrap()
            .into_scene()
    };
    let softens = |scene: &Scene| {
        let mut remarks = scene.remarks().iter();
        remarks.any(|remark| matches!(remark, Remark::EquivalentLinear(_)))
    };
    assert!(softens(&scene("weak")) && !softens(&scene("stiff")));
}

struct Silent;

impl SweepWatch for Silent {}
