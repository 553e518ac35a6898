//! Meshes of Abaqus input files in scenes.

use powerhouse::model::{ElementKind, Vec3};
use powerhouse::{FileScene, Registry, Remark, remark};
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
        let told = Remark::from(remark::MeshKeywords { skipped });
        assert!(scene.remarks().contains(&told), "{keys}");
        scene.with_directory(folder.join("out")).prepare().unwrap();
    }
}

/// A mesh is read by its content, whatever its name; what it has otherwise than the mesh is a remark, and what is
/// left out a warning.
#[test]
fn what_an_input_file_has_beside_the_mesh_is_reported() {
    let folder = TestFolder::new("abaqus-told");
    let springs = "*ELEMENT, TYPE=SPRINGA\n31, 1, 2\n32, 1, 2\n*SURFACE, NAME=left";
    let text = BAR.replacen("*SURFACE, NAME=left", springs, 1);
    let text = text
        .replacen("1, 0., 0., 0.", "1,0.", 1)
        .replacen("C3D8R", "C3D8RP", 1);
    std::fs::write(folder.join("bar.msh"), format!("** a comment\n{text}")).unwrap();
    let told = scene(&folder, "bar.msh", "").unwrap();
    let left_out = vec![("SPRINGA".to_owned(), 2)];
    let (coupled, omitted) = (2, 1);
    let warning = Remark::from(remark::MeshLeftOut {
        left_out,
        coupled,
        omitted,
    });
    assert!(
        warning.is_warning() && told.remarks().contains(&warning),
        "{:?}",
        told.remarks()
    );
    for passage in ["2 SPRINGA", "2 elements have temperatures", "1 nodes"] {
        assert!(warning.to_string().contains(passage), "{warning}");
    }
    let at = |from: &str| BAR.find(from).unwrap();
    let part = &BAR[at("*NODE")..at("*MATERIAL")];
    let instance = |name: &str, z: f64| {
        format!("*INSTANCE, NAME={name}, PART=bar\n0, 0, {z}\n*END INSTANCE\n")
    };
    let sets = "*ELSET, ELSET=rock\na.rock, b.rock\n*SURFACE, NAME=left\na.1, S1\n";
    let model = format!(
        "*PART, NAME=bar\n{part}*END PART\n*ASSEMBLY, NAME=all\n{}{}{sets}*END ASSEMBLY\n",
        instance("a", 0.0),
        instance("b", 5.0)
    );
    std::fs::write(folder.join("model.inp"), model).unwrap();
    let told = scene(&folder, "model.inp", "").unwrap();
    assert_eq!(told.mesh().element_set("rock").unwrap(), [0, 1, 2, 3]);
    let instances = vec![("a".to_owned(), 0), ("b".to_owned(), 100)];
    let (curves, collapsed) = (0, 0);
    let fact = Remark::from(remark::MeshContent {
        curves,
        collapsed,
        instances,
    });
    assert!(
        !fact.is_warning() && told.remarks().contains(&fact),
        "{:?}",
        told.remarks()
    );
}

/// Curves of a Gmsh file are bars where a part names them, and are left out elsewhere.
#[test]
fn curves_are_bars_of_parts_alone() {
    let folder = TestFolder::new("curves");
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n3 1 \"rock\"\n2 2 \"left\"\n1 3 \"edge\"\n$EndPhysicalNames\n\
        $Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n\
        $Elements\n3\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 3 2 2 1 1 4 8 5\n3 1 2 3 1 1 2\n$EndElements\n";
    std::fs::write(folder.join("cube.msh"), mesh).unwrap();
    let told = scene(&folder, "cube.msh", "").unwrap();
    assert_eq!(told.mesh().element_count(), 1);
    let (curves, collapsed, instances) = (1, 0, Vec::new());
    let fact = Remark::from(remark::MeshContent {
        curves,
        collapsed,
        instances,
    });
    assert!(told.remarks().contains(&fact), "{:?}", told.remarks());
    let bars = "[mesh]\nfile = \"cube.msh\"\n[[part]]\nset = \"edge\"\nmaterial = \"m\"\n";
    let text = format!("title = \"bar\"\n{bars}{REST}");
    let with_bars = FileScene::from_toml(&text, folder.join("scene.toml"), &Registry::default());
    match with_bars {
        Ok(scene) => assert_eq!(scene.mesh().element_count(), 2),
        // The material of a bar may need more than that of a solid.
        Err(error) => assert!(!error.to_string().contains("no element set"), "{error}"),
    }
}

/// What is not read is refused with the file, the line and the way out; a set that the file does not have, with its sets.
#[test]
fn faults_of_an_input_file_name_their_line() {
    let folder = TestFolder::new("abaqus-refused");
    for (from, to, passages) in [
        (
            "C3D8R",
            "B31",
            &["bar.inp", "line 14 in *ELEMENT", "type B31", "C3D8I"][..],
        ),
        ("*SURFACE", "*INCLUDE, INPUT=a.inp\n*SURFACE", &["a.inp"]),
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
