//! Files that Gmsh itself wrote.

use powerhouse_io::{Encoding, GmshVersion, read_gmsh};
use powerhouse_model::Mesh;

fn data(name: &str) -> String {
    format!("{}/../../data/meshes/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn sizes(mesh: &Mesh, names: &[&str]) -> Vec<usize> {
    let size = |name: &&str| mesh.facet_set(name).unwrap().len();
    names.iter().map(size).collect()
}

/// The cavern's mesh comes with all its nodes, elements and named sets, as its maker lists them.
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
