//! Physical curves, plane meshes, degenerate solids, and files of other programs.

use powerhouse_io::gmsh::GmshFault;
use powerhouse_io::{GmshMesh, MeshOptions, parse_gmsh, parse_gmsh_with};
use powerhouse_model::ElementKind;

use super::sample::{FORMATS, Format, Random, Sample, fault};

fn bars(sample: &Sample, names: &[&str]) -> Vec<GmshMesh> {
    let read = |format: Format| {
        let options = MeshOptions::default().with_bars(names);
        parse_gmsh_with(&sample.file(format), options).unwrap_or_else(|error| panic!("{error}"))
    };
    FORMATS.into_iter().map(read).collect()
}

/// Lines of a physical group are bars where it is named as one; else they are left out and counted, and nothing else
/// changes.
#[test]
fn curves_are_bars_where_they_are_named() {
    let sample = Sample::tower();
    let whole = sample.mesh();
    for gmsh in bars(&sample, &["other", "bolt"]) {
        assert_eq!((&gmsh.mesh, gmsh.report.curve_elements), (&whole, 0));
    }
    let mut without = sample.clone();
    without.elements.retain(|e| e.dimension != 1);
    for gmsh in bars(&sample, &["rock mass"]) {
        // What is left of the curve is a set of its nodes.
        let nodes = gmsh.mesh.node_set("bolt").unwrap();
        let tags: Vec<u64> = nodes
            .iter()
            .map(|&node| gmsh.mesh.node_tags()[node as usize])
            .collect();
        assert_eq!(tags, [214, 300]);
        let mut expected = without.mesh();
        expected.set_node_set("bolt", nodes.to_vec()).unwrap();
        assert_eq!(gmsh.mesh, expected);
        assert_eq!(
            (gmsh.report.curve_elements, gmsh.report.dropped_elements),
            (1, 0)
        );
        assert!(gmsh.mesh.element_set("bolt").is_err());
    }
}

/// Curves of two groups on the same nodes, in either direction, are one bar of both sets; a second line of one group
/// is a duplicate.
#[test]
fn curves_on_the_same_nodes_are_one_bar() {
    let mut sample = Sample::tower();
    sample.element(1, 2, &[12], &[214, 300]);
    for format in FORMATS {
        let gmsh = parse_gmsh(&sample.file(format)).unwrap();
        let bolt = gmsh.mesh.element_set("bolt").unwrap();
        assert_eq!(bolt.len(), 1, "{format:?}");
        assert_eq!(gmsh.mesh.element_set("physical_1_12").unwrap(), bolt);
        assert_eq!(
            gmsh.mesh.element_count(),
            Sample::tower().mesh().element_count()
        );
        let copies = matches!(format, Format::Text2 | Format::Binary2(_));
        assert_eq!(gmsh.report.merged_elements, 1 + usize::from(copies));
    }
    for gmsh in bars(&sample, &[]) {
        assert_eq!(gmsh.mesh.element_count(), 4);
    }
    sample.elements.last_mut().unwrap().groups = vec![9];
    assert!(parse_gmsh(&sample.file(Format::Text4)).is_err());
}

/// A mesh without solids is refused as such with the way to some, whether its curves have names or not.
#[test]
fn a_plane_mesh_has_no_solids() {
    for named in [true, false] {
        let mut sample = Sample::tower();
        sample.elements.retain(|e| e.dimension < 3);
        if !named {
            sample.elements.retain(|e| e.dimension != 1);
        }
        for format in FORMATS {
            let (_, fault) = fault(&sample.file(format));
            let lines = usize::from(named);
            assert_eq!(
                fault,
                GmshFault::NoSolids {
                    facets: 2,
                    lines,
                    points: 1
                },
                "{format:?}"
            );
            assert!(fault.to_string().contains("Extrude"), "{fault}");
        }
    }
}

/// Bricks with repeated nodes are the wedges and tetrahedra that they are, quadrilaterals the triangles, node for node.
#[test]
fn solids_with_repeated_nodes_are_what_they_are() {
    let whole = Sample::tower();
    let mut sample = whole.clone();
    for element in &mut sample.elements {
        let n = &element.nodes;
        let (number, nodes) = match element.type_number {
            6 => (5, vec![n[0], n[1], n[2], n[2], n[3], n[4], n[5], n[5]]),
            4 => (5, vec![n[0], n[1], n[2], n[2], n[3], n[3], n[3], n[3]]),
            2 => (3, vec![n[0], n[1], n[1], n[2]]),
            _ => continue,
        };
        (element.type_number, element.nodes) = (number, nodes);
    }
    for format in FORMATS {
        let gmsh = parse_gmsh(&sample.file(format)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(gmsh.mesh, whole.mesh(), "{format:?}");
        assert_eq!(gmsh.report.collapsed_elements, 2);
    }
    // A repetition that leaves no solid is a fault.
    sample.elements[4].nodes[6] = sample.elements[4].nodes[0];
    let (_, fault) = fault(&sample.file(Format::Text4));
    assert!(fault.to_string().contains("twice"), "{fault}");
}

/// Versions 2 and 2.1, however they are written, are read as 2.2; a byte order mark of UTF-8 changes nothing.
#[test]
fn versions_and_marks_are_read() {
    let sample = Sample::tower();
    let text = String::from_utf8(sample.file(Format::Text2)).unwrap();
    for version in ["2", "2.0", "2.1", "2.2", "2.200000"] {
        let file = text.replacen("2.2 0 8", &format!("{version} 0 8"), 1);
        assert_eq!(
            parse_gmsh(file.as_bytes()).unwrap().mesh,
            sample.mesh(),
            "{version}"
        );
    }
    for format in FORMATS {
        let file = [&b"\xef\xbb\xbf"[..], &sample.file(format)].concat();
        assert_eq!(parse_gmsh(&file).unwrap().mesh, sample.mesh(), "{format:?}");
    }
}

/// A file of another program is named, with the way to a mesh.
#[test]
fn files_of_other_programs_are_named() {
    for (bytes, name, way) in [
        (&b"CDF\x02\0\0\0\0"[..], "Exodus", "from_meshio"),
        (b"\x89HDF\r\n\x1a\n\0\0ENS_MAA", "MED", "gmsh FILE"),
        (
            b"<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\">",
            "VTU",
            "from_meshio",
        ),
        (b"/COM,ANSYS RELEASE", "ANSYS", "from_meshio"),
        (b"$ a deck\n*KEYWORD\n*NODE\n", "LS-DYNA", "from_meshio"),
        (b"* FLAC3D grid\nG 1 0 0 0\n", "FLAC3D", "from_meshio"),
        (b"    -1\n  2411\n", "UNV", "gmsh FILE"),
        (b"MeshVersionFormatted 2\n", "Medit", "gmsh FILE"),
        (b"*NODE\n1, 0, 0, 0\n", "Abaqus", "input file"),
    ] {
        let message = fault(bytes).1.to_string();
        assert!(
            message.contains(name) && message.contains(way),
            "{name}: {message}"
        );
    }
}

/// Of 200 files with damaged bytes of degenerate solids and curves none makes the reader panic, and none has another
/// number of solids than the file says.
#[test]
fn mutations_of_degenerate_files_never_panic() {
    let mut sample = Sample::tower();
    for element in sample.elements.iter_mut().filter(|e| e.type_number == 6) {
        let n = &element.nodes;
        (element.type_number, element.nodes) =
            (5, vec![n[0], n[1], n[2], n[2], n[3], n[4], n[5], n[5]]);
    }
    sample.element(1, 2, &[12], &[214, 300]);
    let mut random = Random(41);
    for format in FORMATS {
        let file = sample.file(format);
        for _ in 0..200 {
            let mut bytes = file.clone();
            let place = random.below(bytes.len());
            bytes[place] = if format.is_text() {
                b"0123456789 .-\n"[random.below(14)]
            } else {
                random.below(256) as u8
            };
            if let Ok(read) = parse_gmsh(&bytes) {
                let mesh = &read.mesh;
                let solids =
                    (0..mesh.element_count() as u32).filter(|&e| mesh.kind(e) != ElementKind::Bar2);
                assert!(solids.count() <= 4);
            }
        }
    }
}
