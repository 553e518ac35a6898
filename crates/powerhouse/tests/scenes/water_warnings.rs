//! Warnings about water in the ground that is not what is meant, and about slices of ground in stages.

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{FileScene, Registry, Remark, WaterReason};

use super::support::Folder;

/// Saturated soil below z = -10 m, in equilibrium.
const GROUND: &str = r#"
title = "ground"
mesh = { file = "ground.msh" }
[[material]]
name = "soil"
law = "mohr-coulomb"
young = 60e6
poisson = 0.3
density = 2000
cohesion = 5e3
friction = 30
pore_water = { porosity = 0.4, level = -10 }
[[part]]
set = "rock"
material = "soil"
[in_situ_stress]
kind = "ground"
level = 0
density = 2000
lateral = 0.5
water = { level = -10 }
[[load]]
kind = "gravity"
[[support]]
kind = "fixed"
set = "bottom"
[[support]]
kind = "roller"
set = "front"
[[support]]
kind = "roller"
set = "back"
[[stage]]
name = "ground"
[time]
duration = 0.05
"#;

/// A slice 4 m thick, whose upper 10 m right of the middle are another set.
fn mesh() -> Mesh {
    let (low, high) = (Vec3::new(-100.0, -2.0, -100.0), Vec3::new(100.0, 2.0, 0.0));
    let mut mesh = Mesh::box_of_hexes(low, high, [20, 1, 10], "rock").unwrap();
    let all = 0..mesh.element_count() as u32;
    let is_fill = |element: &u32| {
        let at = mesh.centroid(*element);
        at.x > 0.0 && at.z > -10.0
    };
    let (fill, rock): (Vec<u32>, Vec<u32>) = all.partition(is_fill);
    mesh.set_element_set("fill", fill).unwrap();
    mesh.set_element_set("rock", rock).unwrap();
    mesh
}

/// A part of the fill with the material of the rest or an elastic one.
fn fill(material: &str) -> String {
    let own = "[[material]]\nname = \"fill\"\nlaw = \"elastic\"\nyoung = 3e7\npoisson = 0.3\ndensity = 1800\n";
    format!("{own}[[part]]\nset = \"fill\"\nmaterial = \"{material}\"\n")
}

fn scene(changes: &[(&str, &str)]) -> FileScene {
    let mut text = format!("{GROUND}{}", fill("soil"));
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    let folder = Folder::new("water-warnings");
    write_gmsh(folder.join("ground.msh"), &mesh()).unwrap();
    let path = folder.join("ground.toml");
    FileScene::from_toml(text, path, &Registry::default()).unwrap()
}

/// The warnings about water in a scene.
fn warnings(changes: &[(&str, &str)]) -> Vec<String> {
    let scene = scene(changes);
    let remarks = scene.remarks().iter();
    let warnings = remarks.filter(|remark| matches!(remark, Remark::WaterWarning(_)));
    warnings
        .map(|remark| {
            assert!(remark.is_warning());
            remark.to_string()
        })
        .collect()
}

const WATER: &str = "pore_water = { porosity = 0.4, level = -10 }";
const SOFT: &str = "pore_water = { porosity = 0.4, level = -10, bulk_modulus = 2.2 }";
const PORES: &str = "pore_water = { porosity = 1, level = -10 }";
const IN_SITU: &str = "\nwater = { level = -10 }";

/// Each case has a warning of its own with the figure, and none comes where the water of ground and in-situ stress agree, in tables
/// and levels, where the law of dry ground is linear, and where a load is under open water.
#[test]
fn water_that_is_not_meant_is_warned_of_by_name() {
    let other = "density = 2000\ncohesion = 5e3";
    for (changes, wanted) in [
        (
            vec![(other, "density = 900\ncohesion = 5e3")],
            "of 900 kg/m3 is below that of the water",
        ),
        (vec![(WATER, PORES)], "a porosity of 1 leaves"),
        (vec![(WATER, SOFT)], "1.1e-7 of an isotropic stress"),
        (
            vec![(
                "material = \"soil\"",
                "material = \"soil\"\nkernel = \"hex8-full\"",
            )],
            "'hex8-full' of part 'rock' are too stiff",
        ),
        (
            vec![(IN_SITU, "")],
            "it has 833.9 kPa, and [in_situ_stress] has no water",
        ),
        (
            vec![(WATER, "pore_water = { porosity = 0.4 }")],
            "it has no water, and [in_situ_stress] has 833.9 kPa",
        ),
        (
            vec![(WATER, "")],
            "it has no water, and [in_situ_stress] has 833.9 kPa",
        ),
        (
            vec![
                (WATER, "pore_water = { porosity = 0.4, level = 3 }"),
                (IN_SITU, "\nwater = { level = 3 }"),
            ],
            "z = 3 m is above the ground, which ends at 0 m",
        ),
    ] {
        let found = warnings(&changes);
        let count = if wanted.contains("hex8-full") { 2 } else { 1 };
        assert_eq!(found.len(), count, "{wanted}: {found:#?}");
        assert!(
            found[0].contains(wanted) && found[0].contains("'soil'"),
            "{wanted}: {found:#?}"
        );
    }
    // The difference of ten metres of water is named where both have some.
    let scene = scene(&[(IN_SITU, "\nwater = { level = -20 }")]);
    let found = scene.remarks().iter().find_map(|remark| match remark {
        Remark::WaterWarning(warning) => Some(warning.reason.clone()),
        _ => None,
    });
    let Some(WaterReason::OtherPressure {
        pressures: [Some(own), Some(in_situ)],
        ..
    }) = found
    else {
        panic!("{found:?}");
    };
    assert!((own - in_situ - 98.1e3).abs() < 1.0, "{own} {in_situ}");
    let open = "[[load]]\nkind = \"water\"\nset = \"top\"\nlevel = 3\n[[load]]\nkind = \"gravity\"";
    let linear = "law = \"elastic\"";
    for changes in [
        vec![],
        vec![(
            IN_SITU,
            "\nwater = { pressures = [[0, 0], [-10, 0], [-100, 882.9e3]] }",
        )],
        vec![(
            WATER,
            "pore_water = { porosity = 0.4, pressures = [[0, 0], [-10, 0], [-100, 882.9e3]] }",
        )],
        vec![
            (WATER, ""),
            ("law = \"mohr-coulomb\"", linear),
            ("cohesion = 5e3\nfriction = 30\n", ""),
        ],
        vec![
            (WATER, "pore_water = { porosity = 0.4, level = 3 }"),
            (IN_SITU, "\nwater = { level = 3 }"),
            ("[[load]]\nkind = \"gravity\"", open),
        ],
        vec![(
            "material = \"soil\"",
            "material = \"soil\"\nkernel = \"hex8-b-bar\"",
        )],
    ] {
        let found = warnings(&changes);
        assert!(found.is_empty(), "{changes:?}: {found:#?}");
    }
}

/// Half of the way of the water is that within the section of a slice, not its thickness.
#[test]
fn water_does_not_drain_along_a_slice() {
    let water = "pore_water = { porosity = 0.4, level = -10, permeability = 1e-4 }";
    let scene = scene(&[(WATER, water)]);
    let found = scene.remarks().iter().find_map(|remark| match remark {
        Remark::PoreWater(material) => material.seepage,
        _ => None,
    });
    assert_eq!(found.unwrap().extent, 100.0);
}

/// Fill above the level of an in-situ stress draws its warning, unless it is excavated in the first stage or cast later.
#[test]
fn fill_that_comes_later_has_no_in_situ_stress() {
    let lower = (
        "kind = \"ground\"\nlevel = 0",
        "kind = \"ground\"\nlevel = -10",
    );
    let parts = (
        "set = \"fill\"\nmaterial = \"soil\"",
        "set = \"fill\"\nmaterial = \"fill\"",
    );
    // The rest of the upper row is ground, too, and excavated with the fill.
    let upper = |element: Vec3| element.z > -10.0;
    let with = |stages: &str| {
        let mut mesh = mesh();
        let all = 0..mesh.element_count() as u32;
        let (fill, rock): (Vec<u32>, Vec<u32>) =
            all.partition(|element| upper(mesh.centroid(*element)));
        mesh.set_element_set("fill", fill).unwrap();
        mesh.set_element_set("rock", rock).unwrap();
        let mut text = format!("{GROUND}{}", self::fill("soil"));
        for (old, new) in [lower, parts, ("[[stage]]\nname = \"ground\"\n", stages)] {
            assert!(text.contains(old), "{old}");
            text = text.replace(old, new);
        }
        let folder = Folder::new("later-fill");
        write_gmsh(folder.join("ground.msh"), &mesh).unwrap();
        let path = folder.join("ground.toml");
        let scene = FileScene::from_toml(text, path, &Registry::default()).unwrap();
        let simulation = scene.into_scene().prepare().unwrap();
        let mut remarks = simulation.remarks().iter();
        remarks.any(|remark| matches!(remark, Remark::AboveGround(_)))
    };
    let ground = "[[stage]]\nname = \"ground\"\n";
    assert!(with(ground));
    assert!(!with(&format!(
        "{ground}excavate = [\"fill\"]\n[[stage]]\nname = \"fill\"\ncast = [\"fill\"]\n"
    )));
    assert!(!with(&format!(
        "{ground}[[stage]]\nname = \"fill\"\ncast = [\"fill\"]\n"
    )));
}
