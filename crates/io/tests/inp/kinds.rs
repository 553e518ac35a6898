//! Element types: order of nodes, faces, second order.

use powerhouse_io::inp::InpFault;
use powerhouse_io::{MeshOptions, parse_inp, parse_inp_with, read_gmsh, read_inp, write_gmsh};
use powerhouse_model::{ElementKind, Mesh, MeshError, Vec3};

use super::sample::{fault, read, text_of, type_of};

const EXTENT: Vec3 = Vec3::new(2.0, 1.0, 3.0);

/// Boxes of 2 x 1 x 3 m of each kind of solid.
fn boxes() -> Vec<Mesh> {
    let (low, counts) = (Vec3::zeros(), [2, 1, 2]);
    let tets = Mesh::box_of_tets(low, EXTENT, counts, "rock").unwrap();
    let ten = tets.with_midpoints().unwrap();
    vec![
        Mesh::box_of_hexes(low, EXTENT, counts, "rock").unwrap(),
        Mesh::box_of_wedges(low, EXTENT, counts, "rock").unwrap(),
        Mesh::box_of_pyramids(low, EXTENT, counts, "rock").unwrap(),
        tets,
        ten,
    ]
}

/// Local nodes, from 1, of the faces S1, S2 ... of a type, as the documentation of the format lists them.
fn faces(kind: ElementKind) -> &'static [&'static [usize]] {
    match kind {
        ElementKind::Hex8 => &[
            &[1, 2, 3, 4],
            &[5, 8, 7, 6],
            &[1, 5, 6, 2],
            &[2, 6, 7, 3],
            &[3, 7, 8, 4],
            &[4, 8, 5, 1],
        ],
        ElementKind::Wedge6 => &[
            &[1, 2, 3],
            &[4, 6, 5],
            &[1, 4, 5, 2],
            &[2, 5, 6, 3],
            &[3, 6, 4, 1],
        ],
        ElementKind::Pyramid5 => &[
            &[1, 2, 3, 4],
            &[1, 5, 2],
            &[2, 5, 3],
            &[3, 5, 4],
            &[4, 5, 1],
        ],
        _ => &[&[1, 2, 3], &[1, 4, 2], &[2, 4, 3], &[3, 4, 1]],
    }
}

/// A mesh of each kind is the one that the Gmsh file of the same mesh gives, and its elements fill the box.
#[test]
fn kinds_are_those_of_the_gmsh_file() {
    let folder = std::env::temp_dir().join(format!("powerhouse-inp-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for mesh in boxes() {
        let name = mesh.kind(0).name();
        let (msh, inp) = (folder.join("mesh.msh"), folder.join("mesh.inp"));
        write_gmsh(&msh, &mesh).unwrap();
        std::fs::write(&inp, text_of(&mesh, "rock")).unwrap();
        let (gmsh, read) = (read_gmsh(&msh).unwrap().mesh, read_inp(&inp).unwrap());
        assert_eq!(read.mesh.positions(), gmsh.positions(), "{name}");
        assert_eq!(read.mesh.node_tags(), gmsh.node_tags(), "{name}");
        assert_eq!(read.mesh.element_tags(), gmsh.element_tags(), "{name}");
        assert_eq!(read.mesh.element_sets(), gmsh.element_sets(), "{name}");
        let mut volume = 0.0;
        for element in 0..gmsh.element_count() as u32 {
            assert_eq!(read.mesh.kind(element), gmsh.kind(element));
            assert_eq!(
                read.mesh.nodes_of(element),
                gmsh.nodes_of(element),
                "{name}"
            );
            assert!(read.mesh.volume(element) > 0.0, "{name}");
            volume += read.mesh.volume(element);
        }
        assert!((volume - 6.0).abs() < 1e-12, "{name}: {volume}");
        assert_eq!(
            (read.report.dropped_nodes, read.report.curved_nodes),
            (0, 0)
        );
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// Each face of an element of each kind has the nodes that the format gives it, and a normal outwards; the faces close.
#[test]
fn faces_are_those_of_the_format() {
    for mesh in boxes() {
        let kind = mesh.kind(0);
        let mut text = text_of(&mesh, "rock");
        let faces = faces(kind);
        for face in 1..=faces.len() {
            text += &format!(
                "*SURFACE, NAME=f{face}\n{}, S{face}\n",
                mesh.element_tags()[0]
            );
        }
        let read = read(&text).mesh;
        let mut sum = Vec3::zeros();
        for (face, local) in faces.iter().enumerate() {
            let set = read.facet_set(&format!("f{}", face + 1)).unwrap();
            assert_eq!(set.len(), 1);
            let mut own = read.facet_corners(set[0]);
            let nodes = mesh.nodes_of(0);
            let mut expected: Vec<u32> = local.iter().map(|&i| nodes[i - 1]).collect();
            own.sort_unstable();
            expected.sort_unstable();
            assert_eq!(own, expected, "{} S{}", kind.name(), face + 1);
            let geometry = read.facet_geometry(set[0]);
            let outwards = geometry.centroid - read.centroid(0);
            assert!(geometry.normal().dot(&outwards) > 0.0, "{}", kind.name());
            sum += geometry.vector_area;
        }
        assert!(sum.norm() < 1e-12, "{}", kind.name());
        let beyond = text + &format!("*SURFACE, NAME=no\nrock, S{}\n", faces.len() + 1);
        match faces.len() {
            6 => assert!(matches!(fault(&beyond).1, InpFault::Expected { .. })),
            sides => assert_eq!(
                fault(&beyond).1,
                InpFault::NoSuchFace {
                    element: mesh.element_tags()[0],
                    name: type_of(kind),
                    face: sides as u8 + 1,
                    sides
                }
            ),
        }
    }
}

/// The top of a box has its area and its normal, whichever kind it is of; a face between two elements is that of one alone.
#[test]
fn surfaces_have_area_and_normal() {
    for mesh in boxes() {
        let mut text = text_of(&mesh, "rock") + "*SURFACE, NAME=top\n";
        for element in 0..mesh.element_count() as u32 {
            let nodes = mesh.nodes_of(element);
            for (face, local) in faces(mesh.kind(element)).iter().enumerate() {
                let on_top = |&i: &usize| mesh.positions()[nodes[i - 1] as usize].z == EXTENT.z;
                if local.iter().all(on_top) {
                    text += &format!("{}, s{}\n", mesh.element_tags()[element as usize], face + 1);
                }
            }
        }
        let read = read(&text).mesh;
        let top = read.facet_set("top").unwrap();
        assert_eq!(
            top,
            mesh.facet_set("top").unwrap(),
            "{}",
            mesh.kind(0).name()
        );
        let areas = top
            .iter()
            .map(|&facet| read.facet_geometry(facet).vector_area);
        let area: Vec3 = areas.sum();
        assert!((area - Vec3::new(0.0, 0.0, 2.0)).norm() < 1e-12, "{area:?}");
    }
}

/// Types that differ by their integration alone are one kind, in capitals or small letters; two-node trusses are bars.
#[test]
fn types_of_one_kind() {
    let meshes = boxes();
    for (mesh, name, others) in [
        (&meshes[0], "C3D8", &["C3D8R", "c3d8i"][..]),
        (&meshes[4], "C3D10", &["C3D10M", "c3d10m"]),
    ] {
        let text = text_of(mesh, "rock");
        for other in others {
            let changed = text.replace(&format!("type={name}"), &format!("type={other}"));
            assert_eq!(read(&changed).mesh, read(&text).mesh, "{other}");
        }
    }
    let bar =
        read("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n*ELEMENT, TYPE=T3D2, ELSET=bolt\n7, 1, 2\n").mesh;
    assert_eq!(
        (bar.kind(0), bar.element_set("bolt").unwrap()),
        (ElementKind::Bar2, &[0][..])
    );
}

/// Tetrahedra of second order lose their midpoints on request; a curved edge is a fault with its line, or is straightened.
#[test]
fn midpoints_are_left_out_or_moved() {
    let (four, ten) = (&boxes()[3], &boxes()[4]);
    let text = text_of(ten, "rock");
    let lowered =
        parse_inp_with(text.as_bytes(), MeshOptions::default().with_first_order()).unwrap();
    assert_eq!(lowered.mesh, read(&text_of(four, "rock")).mesh);
    assert_eq!(lowered.report.lowered_elements, four.element_count());
    assert_eq!(
        lowered.report.dropped_nodes,
        ten.node_count() - four.node_count()
    );

    let middle = ten.nodes_of(0)[4];
    let moved = Vec3::new(0.0, 0.0, 0.125);
    let at = ten.positions()[middle as usize];
    let bent = (ten.clone())
        .map_positions(|x| if x == at { x + moved } else { x })
        .unwrap();
    let text = text_of(&bent, "rock");
    let (place, found) = fault(&text);
    let curved = |fault: &InpFault| match fault {
        InpFault::Mesh(MeshError::CurvedEdge { node, offset, .. }) => Some((*node, *offset)),
        _ => None,
    };
    let node = ten.node_tags()[middle as usize];
    assert_eq!(curved(&found), Some((node, 0.125)), "{found}");
    let line = text.lines().nth(place.line - 1).unwrap();
    assert!(line.contains(&node.to_string()), "{line}");
    let options = MeshOptions::default().with_straight_edges();
    let straight = parse_inp_with(text.as_bytes(), options).unwrap();
    assert_eq!(straight.mesh, read(&text_of(ten, "rock")).mesh);
    assert_eq!(
        (straight.report.curved_nodes, straight.report.largest_curve),
        (1, 0.125)
    );
}

/// Name of a type, its corners, its edges and its volume (m3).
type Case<'a> = (&'static str, &'a [[f64; 3]], &'a [[usize; 2]], f64);

/// Bricks and wedges of second order are refused, and read by their corners on request; their nodes fill two lines.
#[test]
fn corners_of_second_order_are_read_on_request() {
    let brick = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    let wedge = [brick[0], brick[1], brick[3], brick[4], brick[5], brick[7]];
    // From 1, as the documentation of the format numbers them.
    let of_brick = [
        [1, 2],
        [2, 3],
        [3, 4],
        [4, 1],
        [5, 6],
        [6, 7],
        [7, 8],
        [8, 5],
        [1, 5],
        [2, 6],
        [3, 7],
        [4, 8],
    ];
    let of_wedge = [
        [1, 2],
        [2, 3],
        [3, 1],
        [4, 5],
        [5, 6],
        [6, 4],
        [1, 4],
        [2, 5],
        [3, 6],
    ];
    let cases: [Case; 3] = [
        ("C3D20", &brick, &of_brick, 1.0),
        ("C3D20R", &brick, &of_brick, 1.0),
        ("C3D15", &wedge, &of_wedge, 0.5),
    ];
    for (name, corners, edges, volume) in cases {
        let mut text = String::from("*NODE\n");
        let middles = edges
            .iter()
            .map(|&[a, b]| [0, 1, 2].map(|i| 0.5 * (corners[a - 1][i] + corners[b - 1][i])));
        let positions: Vec<[f64; 3]> = corners.iter().copied().chain(middles).collect();
        for (i, [x, y, z]) in positions.iter().enumerate() {
            text += &format!("{}, {x}, {y}, {z}\n", i + 1);
        }
        let tags: Vec<String> = (1..=positions.len()).map(|tag| tag.to_string()).collect();
        let (first, second) = tags.split_at(9);
        text += &format!(
            "*ELEMENT, TYPE={name}\n3, {},\n  {}\n",
            first.join(", "),
            second.join(", ")
        );
        let (place, found) = fault(&text);
        assert_eq!(found, InpFault::SecondOrder { name });
        assert_eq!(place.line, positions.len() + 2);
        let options = MeshOptions::default().with_first_order();
        let read = parse_inp_with(text.as_bytes(), options).unwrap();
        assert_eq!(read.mesh.node_count(), corners.len(), "{name}");
        assert!((read.mesh.volume(0) - volume).abs() < 1e-12, "{name}");
        assert_eq!(
            (read.report.lowered_elements, read.report.curved_nodes),
            (1, 0)
        );
        // A node that is not at the midpoint of its edge is counted.
        let bent = text.replacen("0.5, 0, 0\n", "0.5, 0.1, 0\n", 1);
        let read = parse_inp_with(bent.as_bytes(), options).unwrap();
        assert_eq!(read.report.curved_nodes, 1, "{name}");
    }
}

/// An element whose nodes are in another order is inverted, a fault with its line.
#[test]
fn inverted_elements_are_found() {
    for mesh in boxes().iter().take(4) {
        let text = text_of(mesh, "rock");
        let last = text.lines().last().unwrap();
        let words: Vec<&str> = last.split(", ").collect();
        let mut swapped = words.clone();
        swapped.swap(1, 2);
        let (place, found) = fault(&text.replace(last, &swapped.join(", ")));
        assert!(
            matches!(found, InpFault::Mesh(MeshError::Inverted { .. })),
            "{found}"
        );
        assert_eq!(place.line, text.lines().count());
        assert_eq!(place.keyword, "*ELEMENT");
        assert!(parse_inp(text.as_bytes()).is_ok());
    }
}
