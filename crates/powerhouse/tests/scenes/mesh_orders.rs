//! Order of the elements of a mesh: keys, refusals and remarks.

use powerhouse::io::write_gmsh;
use powerhouse::model::{ElementKind, Mesh, Vec3};
use powerhouse::{FileScene, Registry, Remark, Scene, remark};
use powerhouse_test_support::TestFolder;

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
[time]
duration = 0.001
"#;

struct Files(TestFolder);

impl Files {
    /// The mesh of eight cubes of 2 m of tetrahedra, with and without midpoints, and one with a curved edge.
    fn new(name: &str) -> Self {
        let folder = TestFolder::new(name);
        let (low, high) = (Vec3::zeros(), Vec3::repeat(4.0));
        let four = Mesh::box_of_tets(low, high, [2, 2, 2], "rock").unwrap();
        let ten = four.with_midpoints().unwrap();
        let bent = ten.clone().map_positions(|x| {
            if (x - Vec3::new(1.0, 0.0, 0.0)).norm() < 1e-9 {
                x - Vec3::y() * 0.25
            } else {
                x
            }
        });
        write_gmsh(folder.join("four.msh"), &four).unwrap();
        write_gmsh(folder.join("ten.msh"), &ten).unwrap();
        write_gmsh(folder.join("bent.msh"), &bent.unwrap()).unwrap();
        Self(folder)
    }
    fn scene(&self, file: &str, keys: &str) -> Result<FileScene, powerhouse::Error> {
        let text = format!("title = \"orders\"\n[mesh]\nfile = \"{file}.msh\"\n{keys}\n{REST}");
        FileScene::from_toml(&text, self.0.join("scene.toml"), &Registry::default())
    }
}

/// What a scene says about the order of its elements.
fn told(scene: &Scene) -> Vec<Remark> {
    let remarks = scene.remarks().iter();
    let of_order = remarks.filter(|remark| matches!(remark, Remark::MeshOrder(_)));
    of_order.cloned().collect()
}

/// Tetrahedra with midpoints are computed as they are, without them on request, which is said; those of four nodes get them on
/// request; and both scenes run.
#[test]
fn the_order_of_tetrahedra_is_that_of_the_key() {
    let files = Files::new("mesh-orders");
    for (file, keys, kind, lowered) in [
        ("four", "", ElementKind::Tet4, 0),
        ("four", "order = 1", ElementKind::Tet4, 0),
        ("four", "order = 2", ElementKind::Tet10, 0),
        ("four", "refine = 1\norder = 2", ElementKind::Tet10, 0),
        ("ten", "", ElementKind::Tet10, 0),
        ("ten", "order = 2", ElementKind::Tet10, 0),
        // Tetrahedra and the facets of the six sides.
        ("ten", "order = 1", ElementKind::Tet4, 48 + 6 * 8),
        ("bent", "order = 1", ElementKind::Tet4, 48 + 6 * 8),
        ("bent", "straighten = true", ElementKind::Tet10, 0),
    ] {
        let scene = files.scene(file, keys).unwrap();
        assert_eq!(scene.mesh().kind(0), kind, "{file} {keys}");
        let (curved, largest) = if file == "bent" { (1, 0.25) } else { (0, 0.0) };
        let expected = Remark::from(remark::MeshOrder {
            lowered,
            curved,
            largest,
        });
        let any = lowered + curved > 0;
        assert_eq!(
            told(&scene),
            Vec::from_iter(any.then_some(expected)),
            "{file} {keys}"
        );
        scene.with_directory(files.0.join("out")).prepare().unwrap();
    }
    let text = told(&files.scene("bent", "straighten = true").unwrap())[0].to_string();
    assert!(
        text.contains("1 nodes on curved edges, up to 2.500e-1 off the midpoints, were moved"),
        "{text}"
    );
}

/// Curved edges, orders that do not exist and keys about files where there is a generator are refused, with what is permitted.
#[test]
fn what_is_not_computed_is_refused() {
    let files = Files::new("mesh-orders-refused");
    for (file, keys, passages) in [
        (
            "bent",
            "",
            &[
                "bent.msh",
                "line ",
                "element 1 of kind tet10 has a curved edge",
                "2.500e-1 m",
            ][..],
        ),
        ("four", "order = 3", &["order", "[1, 2]"]),
        ("four", "order = 0", &["order", "[1, 2]"]),
        (
            "ten",
            "refine = 1",
            &["tet10, which refinement does not divide"],
        ),
        (
            "ten",
            "generator = \"bay\"\norder = 1",
            &["`order = 1` is about a mesh file"],
        ),
        (
            "ten",
            "generator = \"bay\"\nstraighten = true",
            &["`straighten` is about a mesh file"],
        ),
    ] {
        let error = files.scene(file, keys).err().unwrap().to_string();
        for passage in passages {
            assert!(error.contains(passage), "{file} {keys}: {error}");
        }
    }
}
