//! Files that Gmsh itself wrote.

use powerhouse_io::gmsh::{ByteOrder, Encoding, GmshVersion};
use powerhouse_io::read_gmsh;
use powerhouse_model::Mesh;

fn data(name: &str) -> String {
    format!("{}/../../data/meshes/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn sizes(mesh: &Mesh, names: &[&str]) -> Vec<usize> {
    let size = |name: &&str| mesh.facet_set(name).unwrap().len();
    names.iter().map(size).collect()
}

/// The cavern's mesh has all its nodes, elements and named sets, as its generator lists them.
#[test]
fn the_cavern_is_read_whole() {
    let faces = [
        "left", "right", "front", "back", "bottom", "top", "intrados",
    ];
    let gmsh = read_gmsh(data("cavern.msh")).unwrap();
    let mesh = &gmsh.mesh;
    assert_eq!(mesh.node_count(), 17_865);
    assert_eq!(mesh.element_count(), 15_792);
    assert_eq!(mesh.element_set("rock").unwrap().len(), 15_280);
    assert_eq!(mesh.element_set("lining").unwrap().len(), 512);
    assert_eq!(sizes(mesh, &faces), [546, 546, 632, 632, 624, 624, 448]);
    assert_eq!(gmsh.report.version, GmshVersion::Four);
    assert_eq!(gmsh.report.encoding, Encoding::Text);
    assert_eq!(gmsh.report.dropped_nodes, 0);
    assert_eq!(gmsh.report.quality.parts, 1);
    let area: f64 = (mesh.facet_set("intrados").unwrap().iter())
        .map(|&facet| mesh.facet_geometry(facet).area())
        .sum();
    assert!((area - 6_073.7).abs() < 0.05, "{area}");

    let small = read_gmsh(data("cavern_small.msh")).unwrap().mesh;
    assert_eq!((small.node_count(), small.element_count()), (4_572, 3_792));
    assert_eq!(sizes(&small, &faces), [216, 216, 216, 216, 252, 252, 128]);
}

/// The files that Gmsh writes of one mesh in each of its formats give one mesh: elements in two groups once,
/// a group without a name, a point of no element dropped, periodic pairs skipped.
#[test]
fn all_formats_of_gmsh_give_one_mesh() {
    let little = Encoding::Binary(ByteOrder::Little);
    for (name, version, encoding) in [
        ("41_text", GmshVersion::Four, Encoding::Text),
        ("41_binary", GmshVersion::Four, little),
        ("22_text", GmshVersion::Two, Encoding::Text),
        ("22_binary", GmshVersion::Two, little),
    ] {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/gmsh/data");
        let gmsh = read_gmsh(format!("{folder}/two_layers_{name}.msh")).unwrap();
        let (mesh, report) = (&gmsh.mesh, &gmsh.report);
        assert_eq!((report.version, report.encoding), (version, encoding));
        assert_eq!(
            (mesh.node_count(), mesh.element_count()),
            (27, 10),
            "{name}"
        );
        assert_eq!(mesh.element_set("rock mass").unwrap(), [2, 3, 4, 5]);
        assert_eq!(mesh.element_set("both").unwrap(), [2, 3, 4, 5, 6, 7, 8, 9]);
        assert_eq!(mesh.element_set("physical_1_4").unwrap(), [0, 1]);
        assert_eq!(mesh.facet_set("bottom é").unwrap().len(), 4);
        assert_eq!(mesh.node_set("probe").unwrap(), [0]);
        for element in mesh.element_set("both").unwrap() {
            let node = mesh.nodes_of(*element)[6] as usize;
            let diagonal =
                mesh.positions()[node] - mesh.positions()[mesh.nodes_of(*element)[0] as usize];
            assert_eq!(diagonal.as_slice(), [0.5, 0.5, 1.0], "{name}");
        }
    }
}

/// A partitioned mesh in one file, with facets between partitions and lists of elements beside them, is the same mesh; a file of one partition is
/// refused.
#[test]
fn partitions_in_one_file_make_one_mesh() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/gmsh/data");
    let read = |name: &str| read_gmsh(format!("{folder}/two_layers_{name}.msh"));
    let whole = read("41_text").unwrap().mesh;
    // Version 2.2 numbers the nodes anew: corners are compared by their places, in halves of a metre.
    let corners = |mesh: &Mesh, set: &str| {
        let of = |&element: &u32| {
            let place =
                |&node: &u32| mesh.positions()[node as usize].map(|x| (2.0 * x).round() as i64);
            let mut corners: Vec<[i64; 3]> = (mesh.nodes_of(element).iter())
                .map(|node| place(node).into())
                .collect();
            corners.sort_unstable();
            corners
        };
        let mut found: Vec<_> = mesh.element_set(set).unwrap().iter().map(of).collect();
        found.sort_unstable();
        found
    };
    for name in ["41_parts", "22_parts"] {
        let mesh = read(name)
            .unwrap_or_else(|error| panic!("{name}: {error}"))
            .mesh;
        assert_eq!(
            (mesh.node_count(), mesh.element_count()),
            (27, 10),
            "{name}"
        );
        for set in ["rock mass", "both", "physical_1_4"] {
            assert_eq!(corners(&mesh, set), corners(&whole, set), "{name} {set}");
        }
        assert_eq!(sizes(&mesh, &["bottom é"]), [4], "{name}");
        let volume = mesh.volume_of(mesh.element_set("both").unwrap());
        assert!((volume - 2.0).abs() < 1e-12, "{name} {volume}");
    }
    let part = read("41_part").unwrap_err().to_string();
    assert!(
        part.contains("the elements of partition 2 alone of 3"),
        "{part}"
    );
}
