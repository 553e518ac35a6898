//! Warnings that a check of a scene finds before its run.

use crate::block::Folder;
use powerhouse::boundary::Viscous;
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{Boundary, FileScene, Material, Part, Scene};
use powerhouse_study::{Warning, check, warnings};

const GROUND: &str = r#"
title = "ground"
[mesh]
file = "mesh.msh"
[[material]]
name = "rock"
law = "elastic"
young = 9e9
poisson = 0.27
density = 2750
[[part]]
set = "rock"
material = "rock"
[[load]]
kind = "gravity"
[in_situ_stress]
kind = "ground"
level = 120
density = 2750
lateral = 0.5
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "front", "back", "bottom"]
scatterer = [60, 60, 60]
[[stage]]
name = "ground"
support = [
    { kind = "roller", set = "left", normal = [1, 0, 0] },
    { kind = "roller", set = "right", normal = [1, 0, 0] },
    { kind = "roller", set = "front", normal = [0, 1, 0] },
    { kind = "roller", set = "back", normal = [0, 1, 0] },
    { kind = "roller", set = "bottom", normal = [0, 0, 1] },
]
[time]
duration = 0.05
"#;

/// A check states which share of the load an in-situ stress leaves unbalanced, in one increment or in several; none if it
/// is in equilibrium.
#[test]
fn a_check_finds_a_stress_out_of_balance() {
    let found = |name: &str, changes: &[(&str, &str)]| {
        let mut text = GROUND.to_owned();
        for (old, new) in changes {
            assert!(text.contains(old), "{old}");
            text = text.replacen(old, new, 1);
        }
        let folder = Folder::new(name, &text, 3);
        let report = check(FileScene::from_file(folder.scene()).unwrap()).unwrap();
        report.warnings.iter().find_map(|warning| match warning {
            Warning::Unbalanced { stage, share } => Some((stage.clone(), *share)),
            _ => None,
        })
    };
    assert_eq!(found("balanced", &[]), None);
    let lighter = ("density = 2750\nlateral", "density = 2200\nlateral");
    let stage = "name = \"ground\"\n";
    let four = (stage, "name = \"ground\"\nincrements = 4\n");
    for (name, changes) in [("once", &[lighter][..]), ("in-four", &[lighter, four])] {
        let (stage, share) = found(name, changes).unwrap();
        assert_eq!(stage, "ground");
        assert!((share - 0.2).abs() < 0.03, "{name}: {share}");
    }
}

/// Parts of a mesh that share no nodes are named by their sets, the largest first.
#[test]
fn separate_parts_of_a_mesh_are_named() {
    let size = Vec3::new(30.0, 20.0, 20.0);
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [3, 2, 2], "all").unwrap();
    let every = 0..mesh.element_count() as u32;
    let (left, right): (Vec<u32>, Vec<u32>) = every.partition(|&e| mesh.centroid(e).x < 10.0);
    mesh.set_element_set("left", left.clone()).unwrap();
    mesh.set_element_set("right", right.clone()).unwrap();
    let scene = |mesh: Mesh| {
        let rock = Material::from(LinearElastic::new(media::ROCK));
        Scene::new("apart", mesh).part(Part::new("all", rock))
    };
    let texts = |mesh: Mesh| -> Vec<String> {
        let found = warnings(&scene(mesh)).unwrap();
        found.iter().map(ToString::to_string).collect()
    };
    let apart = mesh.split_between(&left, &right).unwrap().mesh;
    let named =
        "2 parts that share no nodes: 8 elements of 'all', 'right'; 4 elements of 'all', 'left'";
    assert!(texts(apart).iter().any(|text| text.contains(named)));
    assert!(
        !texts(mesh)
            .iter()
            .any(|text| text.contains("share no nodes"))
    );
}

/// A check lists the boxes of the mesh and of its sets, and warns of a results folder in which nothing can be written.
#[test]
fn a_check_lists_sets_and_tries_the_folder() {
    let folder = Folder::new("tried", GROUND, 3);
    let scene = FileScene::from_file(folder.scene()).unwrap();
    let report = check(scene.with_directory(folder.out())).unwrap();
    let unwritable = |warning: &Warning| matches!(warning, Warning::Folder { .. });
    assert!(!report.warnings.iter().any(unwritable) && !folder.out().exists());
    assert_eq!(report.extent, (Vec3::zeros(), Vec3::repeat(120.0)));
    let of = |name: &str| report.sets.iter().find(|set| set.set == name).unwrap();
    assert_eq!((of("rock").of, of("rock").count), ("elements", 27));
    let top = of("top");
    assert_eq!((top.of, top.count), ("facets", 9));
    assert_eq!(
        (top.low, top.high),
        (Vec3::z() * 120.0, Vec3::repeat(120.0))
    );
    let in_file = folder.scene().join("results");
    let scene = FileScene::from_file(folder.scene()).unwrap();
    let report = check(scene.with_directory(&in_file)).unwrap();
    let named = in_file.display().to_string();
    assert!(
        report.warnings.iter().any(
            |warning| matches!(warning, Warning::Folder { reason } if reason.contains(&named))
        )
    );
}

/// Tetrahedra with midpoints along the absorbing faces are warned of, with their number and the way out; those of four nodes
/// are warned of as too stiff, with the way out; bricks, and tetrahedra away from the faces, are not.
#[test]
fn tetrahedra_that_carry_the_waves_are_warned_of() {
    let size = Vec3::new(30.0, 20.0, 20.0);
    let tets = Mesh::box_of_tets(Vec3::zeros(), size, [3, 2, 2], "rock").unwrap();
    let bricks = Mesh::box_of_hexes(Vec3::zeros(), size, [3, 2, 2], "rock").unwrap();
    let found = |mesh: Mesh, faces: &[&str]| -> Vec<Warning> {
        let rock = Material::from(LinearElastic::new(media::ROCK));
        let mut scene = Scene::new("ringing", mesh).part(Part::new("rock", rock));
        if !faces.is_empty() {
            let boundary = Boundary::new(Viscous::default(), faces.iter().copied());
            scene = scene.with_boundary(boundary);
        }
        warnings(&scene).unwrap()
    };
    let rings = |warning: &Warning| matches!(warning, Warning::Ringing { .. });
    let ten = tets.with_midpoints().unwrap();
    let expected = Warning::Ringing {
        set: "rock".into(),
        tetrahedra: 72,
        elements: 72,
    };
    let warned = found(ten.clone(), &["bottom"]);
    assert!(warned.contains(&expected));
    assert!(expected.to_string().contains("Mesh with bricks or wedges"));
    assert!(!found(ten, &[]).iter().any(rings));
    assert!(!found(bricks, &["bottom"]).iter().any(rings));
    let four = found(tets, &["bottom"]);
    assert!(!four.iter().any(rings));
    let stiff = four
        .iter()
        .find(|warning| matches!(warning, Warning::Tetrahedra { .. }));
    assert!(stiff.unwrap().to_string().contains("`order = 2`"));
}

/// Parts that flow with a dilation far below their friction are warned of by `check`, with the ways out, unless the dilation is
/// above two thirds of the friction, the law is a cone, or something damps high frequencies; flat damping does not.
#[test]
fn ill_posed_flow_is_warned_of() {
    let found = |law: &str, damping: &str| {
        let rock = "law = \"elastic\"\nyoung = 9e9\npoisson = 0.27\ndensity = 2750\n";
        assert!(GROUND.contains(rock));
        let text = GROUND.replacen(
            rock,
            &format!("young = 9e9\npoisson = 0.27\ndensity = 2750\ncohesion = 1e6\n{law}\n"),
            1,
        );
        let part = "set = \"rock\"\nmaterial = \"rock\"\n";
        let text = text.replacen(part, &format!("{part}elastic_rim = 0\n{damping}\n"), 1);
        let folder = Folder::new("flow", &text, 4);
        let scene = FileScene::from_file(folder.scene()).unwrap().into_scene();
        let warnings = warnings(&scene).unwrap();
        warnings.into_iter().find_map(|warning| match warning {
            Warning::IllPosed { .. } => Some(warning.to_string()),
            _ => None,
        })
    };
    let mohr_coulomb =
        |dilation: f64| format!("law = \"mohr-coulomb\"\nfriction = 42\ndilation = {dilation}");
    let flat = "damping = { kind = \"flat\", ratio = 0.03, band = [0.5, 20] }";
    for damping in ["", flat] {
        let text = found(&mohr_coulomb(0.0), damping).unwrap();
        for way in [
            "'rock'",
            "kind = \"high\"",
            "dilation",
            "drucker-prager",
            "5 % of the stable step",
        ] {
            assert!(text.contains(way), "{text}");
        }
        assert!(found(&mohr_coulomb(8.0), damping).is_some());
        assert_eq!(found(&mohr_coulomb(30.0), damping), None);
        assert_eq!(found(&mohr_coulomb(42.0), damping), None);
        let cone = "law = \"drucker-prager\"\nfriction = 42";
        assert_eq!(found(cone, damping), None);
    }
    let high = "damping = { kind = \"flat\", ratio = 0.03, band = [0.5, 20], high = 0.05 }";
    for damping in [
        "damping = { kind = \"high\", ratio = 0.03 }",
        high,
        "damping = { kind = \"coefficients\", mass = 0, stiffness = 1e-5 }",
    ] {
        assert_eq!(found(&mohr_coulomb(0.0), damping), None, "{damping}");
    }
}
