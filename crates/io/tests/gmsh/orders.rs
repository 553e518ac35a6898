//! Pyramids, tetrahedra with midpoints, and elements of second order.

use powerhouse_io::gmsh::GmshFault;
use powerhouse_io::{
    GmshError, MeshOptions, parse_gmsh, parse_gmsh_with, read_gmsh, read_gmsh_with, write_gmsh,
};
use powerhouse_model::{ElementKind, Mesh, MeshError, Vec3};

fn folder(name: &str) -> std::path::PathBuf {
    let folder =
        std::env::temp_dir().join(format!("powerhouse-orders-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Pyramids and tetrahedra with midpoints, with their facets of three, four and six nodes, are the same after writing and
/// reading.
#[test]
fn kinds_survive_a_file() {
    let (low, high) = (Vec3::zeros(), Vec3::new(2.0, 1.0, 3.0));
    let folder = folder("round");
    for mesh in [
        Mesh::box_of_pyramids(low, high, [2, 1, 2], "rock").unwrap(),
        (Mesh::box_of_tets(low, high, [2, 1, 2], "rock").unwrap())
            .with_midpoints()
            .unwrap(),
    ] {
        let path = folder.join("mesh.msh");
        write_gmsh(&path, &mesh).unwrap();
        let read = read_gmsh(&path).unwrap();
        assert_eq!(read.mesh, mesh);
        assert_eq!(
            (read.report.lowered_elements, read.report.curved_nodes),
            (0, 0)
        );
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// A file of tetrahedra with midpoints is, of first order, that of the tetrahedra.
#[test]
fn midpoints_can_be_left_out() {
    let mesh = Mesh::box_of_tets(Vec3::zeros(), Vec3::repeat(1.0), [2, 2, 2], "rock").unwrap();
    let folder = folder("lowered");
    let path = folder.join("mesh.msh");
    write_gmsh(&path, &mesh.with_midpoints().unwrap()).unwrap();
    let read = read_gmsh_with(&path, MeshOptions::default().with_first_order()).unwrap();
    assert_eq!(read.mesh, mesh);
    // Solids and the facets of six sides.
    assert_eq!(read.report.lowered_elements, 48 + 6 * 8);
    assert_eq!(read.report.dropped_nodes, 125 - 27);
    std::fs::remove_dir_all(folder).unwrap();
}

/// A text file of version 2.2 with one solid of a type and all its nodes: corners, then others.
fn one_solid(number: i32, corners: &[[f64; 3]], others: &[[f64; 3]]) -> String {
    let nodes: Vec<&[f64; 3]> = corners.iter().chain(others).collect();
    let mut text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n",
        nodes.len()
    );
    for (i, [x, y, z]) in nodes.iter().enumerate() {
        text += &format!("{} {x:?} {y:?} {z:?}\n", i + 1);
    }
    let tags: Vec<String> = (1..=nodes.len()).map(|tag| tag.to_string()).collect();
    text + &format!(
        "$EndNodes\n$Elements\n1\n8 {number} 2 0 1 {}\n$EndElements\n",
        tags.join(" ")
    )
}

/// Number and name of a type, its kind of first order, its edges, and the number of nodes that follow their midpoints.
type Case<'a> = (i32, &'static str, ElementKind, &'a [[usize; 2]], usize);

/// Elements of second order are refused with their number and line, and read by their corners on request; nodes on their
/// edges that are not midpoints are counted.
#[test]
fn corners_of_second_order_are_read_on_request() {
    let midpoints = |corners: &[[f64; 3]], edges: &[[usize; 2]]| -> Vec<[f64; 3]> {
        let middle =
            |&[a, b]: &[usize; 2]| [0, 1, 2].map(|i| 0.5 * (corners[a][i] + corners[b][i]));
        edges.iter().map(middle).collect()
    };
    // As the manual of the format draws them.
    let hex = [
        [0, 1],
        [0, 3],
        [0, 4],
        [1, 2],
        [1, 5],
        [2, 3],
        [2, 6],
        [3, 7],
        [4, 5],
        [4, 7],
        [5, 6],
        [6, 7],
    ];
    let wedge = [
        [0, 1],
        [0, 2],
        [0, 3],
        [1, 2],
        [1, 4],
        [2, 5],
        [3, 4],
        [3, 5],
        [4, 5],
    ];
    let pyramid = [
        [0, 1],
        [0, 3],
        [0, 4],
        [1, 2],
        [1, 4],
        [2, 3],
        [2, 4],
        [3, 4],
    ];
    let cases: [Case; 6] = [
        (17, "a hex20", ElementKind::Hex8, &hex, 0),
        (12, "a hex27", ElementKind::Hex8, &hex, 7),
        (18, "a wedge15", ElementKind::Wedge6, &wedge, 0),
        (13, "a wedge18", ElementKind::Wedge6, &wedge, 3),
        (19, "a pyramid13", ElementKind::Pyramid5, &pyramid, 0),
        (14, "a pyramid14", ElementKind::Pyramid5, &pyramid, 1),
    ];
    for (number, name, kind, edges, more) in cases {
        let corners = kind.natural_corners();
        let mut others = midpoints(corners, edges);
        others.extend((0..more).map(|i| [0.1 * i as f64, 0.0, 0.0]));
        for bent in [false, true] {
            if bent {
                others[2][1] += 0.125;
            }
            let text = one_solid(number, corners, &others);
            let error = parse_gmsh(text.as_bytes()).unwrap_err();
            let GmshError::Content { place, fault, .. } = &error else {
                panic!("{error}");
            };
            assert_eq!(**fault, GmshFault::SecondOrder { name, element: 8 });
            let line = text
                .lines()
                .position(|line| line.starts_with("8 ") && line.contains(" 2 0 1 "));
            assert_eq!(place.line, line.map(|line| line + 1));
            assert!(error.to_string().contains("order = 1"), "{error}");
            let options = MeshOptions::default().with_first_order();
            let read = parse_gmsh_with(text.as_bytes(), options).unwrap();
            assert_eq!(read.mesh.kind(0), kind);
            assert_eq!(read.mesh.node_count(), kind.node_count());
            let report = read.report;
            assert_eq!(
                (report.lowered_elements, report.curved_nodes),
                (1, usize::from(bent))
            );
            assert_eq!(report.largest_curve, if bent { 0.125 } else { 0.0 });
        }
    }
}

/// A curved edge of a tetrahedron is refused with its element, node, distance and line, and straightened on request, which
/// the report counts.
#[test]
fn curved_edges_are_refused_or_straightened() {
    let corners = ElementKind::Tet4.natural_corners();
    let straight = &ElementKind::Tet10.natural_corners()[4..];
    let mut others = straight.to_vec();
    others[3][0] -= 0.0625;
    let text = one_solid(11, corners, &others);
    let error = parse_gmsh(text.as_bytes()).unwrap_err();
    let GmshError::Content { place, fault, .. } = &error else {
        panic!("{error}");
    };
    let GmshFault::Mesh(MeshError::CurvedEdge {
        element,
        node,
        offset,
        ..
    }) = **fault
    else {
        panic!("{error}");
    };
    assert_eq!(
        (element, node, offset, place.line),
        (8, 8, 0.0625, Some(19))
    );
    let read = parse_gmsh_with(
        text.as_bytes(),
        MeshOptions::default().with_straight_edges(),
    )
    .unwrap();
    let exact = parse_gmsh(one_solid(11, corners, straight).as_bytes()).unwrap();
    assert_eq!(read.mesh, exact.mesh);
    assert_eq!(
        (read.report.curved_nodes, read.report.largest_curve),
        (1, 0.0625)
    );
    assert_eq!(
        (exact.report.curved_nodes, exact.report.largest_curve),
        (0, 0.0)
    );
}

/// Lines of three nodes are no bars but those of first order: beside solids they are left out, and refused where they
/// are named as bars.
#[test]
fn lines_of_three_nodes_are_bars_of_first_order() {
    let corners = ElementKind::Tet4.natural_corners();
    let others = &ElementKind::Tet10.natural_corners()[4..];
    let with_line = |group: i32| {
        let text = one_solid(11, corners, others);
        text.replace(
            "$Elements\n1\n",
            &format!("$Elements\n2\n7 8 2 {group} 1 1 2 5\n"),
        )
    };
    let dropped = parse_gmsh(with_line(0).as_bytes()).unwrap();
    assert_eq!(
        (
            dropped.mesh.element_count(),
            dropped.report.dropped_elements
        ),
        (1, 1)
    );
    let curve = parse_gmsh(with_line(3).as_bytes()).unwrap();
    assert_eq!(
        (curve.mesh.element_count(), curve.report.curve_elements),
        (1, 1)
    );
    let named = MeshOptions::default().with_bars(&["physical_1_3"]);
    let error = parse_gmsh_with(with_line(3).as_bytes(), named)
        .unwrap_err()
        .to_string();
    assert!(error.contains("element 7 is a line3"), "{error}");
    let options = MeshOptions::default().with_first_order();
    let bars = parse_gmsh_with(with_line(3).as_bytes(), options)
        .unwrap()
        .mesh;
    assert_eq!(bars.kind(0), ElementKind::Bar2);
    assert_eq!(bars.nodes_of(0), [0, 1]);
}
