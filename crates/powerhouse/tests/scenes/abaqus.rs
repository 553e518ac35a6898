//! Meshes of Abaqus input files in scenes.

use powerhouse::model::{ElementKind, Vec3};
use powerhouse::{FileScene, Registry, Remark, SceneRemark};
use powerhouse_test_support::TestFolder;

/// A bar of two cubes of 1 m along x, with sets, surfaces and a material that is not read.
const BAR: &str = "\
*NODE, NSET=every
1, 0., 0., 0.
2, 0., 1., 0.
3, 0., 1., 1.
4, 0., 0., 1.
11, 1., 0., 0.
12, 1., 1., 0.
13, 1., 1., 1.
14, 1., 0., 1.
21, 2., 0., 0.
22, 2., 1., 0.
23, 2., 1., 1.
24, 2., 0., 1.
*ELEMENT, TYPE=C3D8R, ELSET=rock
1, 1, 2, 3, 4, 11, 12, 13, 14
2, 11, 12, 13, 14, 21, 22, 23, 24
*SURFACE, NAME=left
1, S1
*SURFACE, NAME=right
2, S2
*MATERIAL, NAME=granite
*DENSITY
2700.
";

const REST: &str = r#"
[[material]]
name = "m"
law = "elastic"
young = 9e9
poisson = 0.25
density = 2700
[[part]]
set = "rock"
material = "m"
[[load]]
kind = "pressure"
set = "left"
pressure = 1e5
[time]
duration = 0.001
"#;

fn scene(folder: &TestFolder, file: &str, keys: &str) -> Result<FileScene, powerhouse::Error> {
    let text = format!("title = \"bar\"\n[mesh]\nfile = \"{file}\"\n{keys}\n{REST}");
    FileScene::from_toml(&text, folder.join("scene.toml"), &Registry::default())
}

/// The mesh of an input file is scaled, cut and refined as every other, its sets are those of parts and loads, a remark lists
/// the keywords that were skipped, and the scene runs.
#[test]
fn an_input_file_is_a_mesh() {
    let folder = TestFolder::new("abaqus");
    std::fs::write(folder.join("bar.inp"), BAR).unwrap();
    std::fs::write(folder.join("BAR.INP"), BAR).unwrap();
    for (file, keys, elements, volume) in [
        ("bar.inp", "", 2, 2.0),
        ("BAR.INP", "", 2, 2.0),
        ("bar.inp", "scale = 0.5", 2, 0.25),
        ("bar.inp", "within = { x = [0, 1] }", 1, 1.0),
        ("bar.inp", "slice = { across = \"x\", at = 0.5 }", 1, 1.0),
        ("bar.inp", "refine = 1", 16, 2.0),
        ("bar.inp", "order = 1\nstraighten = true", 2, 2.0),
    ] {
        let scene = scene(&folder, file, keys).unwrap();
        let mesh = scene.mesh();
        let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
        assert_eq!(all.len(), elements, "{keys}");
        assert!((mesh.volume_of(&all) - volume).abs() < 1e-12, "{keys}");
        assert_eq!(mesh.kind(0), ElementKind::Hex8);
        assert_eq!(mesh.element_set("rock").unwrap(), all, "{keys}");
        let left = mesh.facet_set("left").unwrap().iter();
        let area: Vec3 = left
            .map(|&facet| mesh.facet_geometry(facet).vector_area)
            .sum();
        let side = if keys.contains("scale") { 0.25 } else { 1.0 };
        assert!((area + Vec3::x() * side).norm() < 1e-12, "{keys}: {area:?}");
        let skipped = ["*DENSITY", "*MATERIAL"].map(String::from).to_vec();
        let told = Remark::Scene(SceneRemark::MeshKeywords { skipped });
        assert!(scene.remarks().contains(&told), "{keys}");
        scene.with_directory(folder.join("out")).prepare().unwrap();
    }
}

/// What is not read is refused with the file, the line and the way out; a set that the file does not have, with its sets.
#[test]
fn faults_of_an_input_file_name_their_line() {
    let folder = TestFolder::new("abaqus-refused");
    for (from, to, passages) in [
        (
            "C3D8R",
            "S4R",
            &["bar.inp", "line 14 in *ELEMENT", "type S4R", "C3D8I"][..],
        ),
        (
            "*SURFACE",
            "*INCLUDE, INPUT=a.inp\n*SURFACE",
            &["line 17 in *INCLUDE", "in the place of"],
        ),
        (
            "ELSET=rock",
            "ELSET=granite",
            &["there is no element set 'rock'"],
        ),
        (
            "2, 11, 12, 13, 14,",
            "2, 12, 11, 13, 14,",
            &["line 16", "element 2 is inverted"],
        ),
    ] {
        std::fs::write(folder.join("bar.inp"), BAR.replacen(from, to, 1)).unwrap();
        let error = scene(&folder, "bar.inp", "").err().unwrap().to_string();
        for passage in passages {
            assert!(error.contains(passage), "{to}: {error}");
        }
    }
}
