//! Errors of invalid nodes, elements, groups and counts.

use powerhouse_io::gmsh::{GmshFault, GmshPlace};
use powerhouse_model::MeshError;

use super::sample::{FORMATS, Format, Sample, edit, fault};

/// The fault of the tower after a change, in every format.
fn changed(change: impl Fn(&mut Sample)) -> Vec<(Format, Vec<u8>, GmshPlace, GmshFault)> {
    let mut sample = Sample::tower();
    change(&mut sample);
    let of = |format| {
        let file = sample.file(format);
        let (place, fault) = fault(&file);
        (format, file, place, fault)
    };
    FORMATS.into_iter().map(of).collect()
}

/// The fault is this one, in every format; in a text its line starts with that number.
fn always(wanted: GmshFault, section: &str, starts: &str, change: impl Fn(&mut Sample)) {
    for (format, file, place, fault) in changed(change) {
        assert_eq!(fault, wanted, "{format:?}");
        assert_eq!(place.section, section, "{format:?}");
        if format.is_text() {
            let text = String::from_utf8(file).unwrap();
            let line = text.lines().nth(place.line.unwrap() - 1).unwrap();
            assert!(line.starts_with(starts), "{format:?}: '{line}'");
        } else {
            assert_eq!(place.line, None);
            assert!(place.offset < file.len());
        }
    }
}

fn mesh(error: MeshError) -> GmshFault {
    GmshFault::Mesh(error)
}

/// A fault of a node names the node and its position in the file.
#[test]
fn faults_of_nodes() {
    let node = 207;
    let twice = mesh(MeshError::DuplicateNode { node });
    always(twice, "$Nodes", "207", |s| s.nodes.push((207, [9.0; 3])));
    for value in [f64::INFINITY, f64::NEG_INFINITY] {
        let endless = mesh(MeshError::CoordinateNotFinite {
            node,
            axis: 'y',
            value,
        });
        always(endless, "$Nodes", "", |s| {
            s.nodes.iter_mut().find(|n| n.0 == 207).unwrap().1[1] = value;
        });
    }
    for (_, _, place, fault) in
        changed(|s| s.nodes.iter_mut().find(|n| n.0 == 2).unwrap().1[2] = f64::NAN)
    {
        assert_eq!(place.section, "$Nodes");
        assert!(matches!(
            fault,
            GmshFault::Mesh(MeshError::CoordinateNotFinite { node: 2, axis: 'z', value }) if value.is_nan()
        ));
    }
    let zero = GmshFault::Zero { what: "node" };
    always(zero, "$Nodes", "0", |s| s.nodes[5].0 = 0);
}

/// A fault of an element names the element and its position in the file.
#[test]
fn faults_of_elements() {
    let dangling = mesh(MeshError::DanglingNode {
        element: 25,
        node: 999,
    });
    always(dangling, "$Elements", "25", |s| {
        s.elements[4].nodes[3] = 999
    });
    let dangling = mesh(MeshError::DanglingNode {
        element: 19,
        node: 999,
    });
    always(dangling, "$Elements", "19", |s| {
        s.elements[2].nodes[1] = 999
    });
    let repeated = mesh(MeshError::RepeatedNode {
        element: 31,
        node: 107,
    });
    always(repeated, "$Elements", "31", |s| {
        s.elements[6].nodes[2] = 107
    });
    let twice = mesh(MeshError::DuplicateElement { element: 25 });
    always(twice, "$Elements", "25", |s| s.elements[6].tag = 25);
    let same = mesh(MeshError::CoincidentElements {
        first: 34,
        second: 37,
    });
    always(same, "$Elements", "37", |s| {
        s.element(4, 3, &[2], &[50, 51, 52, 2]);
    });
    let zero = GmshFault::Zero { what: "element" };
    always(zero, "$Elements", "0", |s| s.elements[4].tag = 0);
}

/// Inverted and flat elements are found on reading, with their position in the file.
#[test]
fn faults_of_shape() {
    for (_, _, place, fault) in changed(|s| s.elements[7].nodes.swap(0, 1)) {
        assert_eq!(place.section, "$Elements");
        assert!(matches!(
            fault,
            GmshFault::Mesh(MeshError::Inverted { element: 34, .. })
        ));
    }
    let flat = |s: &mut Sample| s.nodes.iter_mut().find(|n| n.0 == 2).unwrap().1[2] = 3.25;
    for (format, file, place, fault) in changed(flat) {
        assert!(matches!(
            fault,
            GmshFault::Mesh(MeshError::Inverted { element: 34, .. })
        ));
        if format.is_text() {
            let text = String::from_utf8(file).unwrap();
            let line = text.lines().nth(place.line.unwrap() - 1).unwrap();
            assert!(line.starts_with("34 "), "{line}");
        }
    }
}

/// A facet that is no side of a solid and a point away from the mesh are faults.
#[test]
fn faults_of_groups() {
    let nodes = vec![300, 307, 314, 200];
    let lost = mesh(MeshError::FacetWithoutElement {
        name: "base".into(),
        nodes: nodes.clone(),
    });
    always(lost, "$Elements", "19", |s| {
        s.elements[2].nodes = nodes.clone()
    });
    let away = GmshFault::PointWithoutElement {
        group: "tip".into(),
        node: 1,
    };
    always(away, "$Elements", "13", |s| s.elements[0].nodes = vec![1]);
    let only = GmshFault::NoSolids {
        facets: 2,
        lines: 0,
        points: 1,
    };
    always(only, "$Elements", "", |s| {
        s.elements.retain(|e| e.dimension == 2 || e.dimension == 0);
    });
    let none = GmshFault::NoSolids {
        facets: 0,
        lines: 0,
        points: 0,
    };
    always(none, "$Elements", "", |s| s.elements.clear());
}

/// A word that only the second parser of version 4.1 refuses is reported at its position too.
#[test]
fn a_word_that_one_reading_refuses() {
    let (place, fault) = edit(Format::Text4, "34 50 51 52 2\n", "34 50 +51 52 2\n");
    let (what, found) = ("a number", "+51 52 2".into());
    assert_eq!(fault, GmshFault::Expected { what, found });
    let text = String::from_utf8(Sample::tower().file(Format::Text4)).unwrap();
    let line = text.lines().position(|line| line == "34 50 51 52 2");
    assert_eq!(place.line, line.map(|line| line + 1));
}

/// Unsupported element types are named, with their first element.
#[test]
fn other_element_types_are_named() {
    for (number, name, nodes) in [
        (21, "triangle10", 10),
        (29, "tet20", 20),
        (92, "hex64", 64),
        (140, "rare high-order type", 9),
    ] {
        let wanted = GmshFault::UnsupportedElement { name, element: 25 };
        always(wanted, "$Elements", "", |s| {
            s.elements[4].type_number = number;
            s.elements[4].nodes = (0..nodes).map(|n| s.nodes[n % 17].0).collect();
        });
    }
    for number in [0, 141, 999, -5, i32::MIN, i32::MAX] {
        let wanted = GmshFault::ElementType {
            number: number.into(),
        };
        always(wanted, "$Elements", "", |s| {
            s.elements[4].type_number = number
        });
    }
}

/// Elements of second order that are computed by their corners alone are named, each with its own line.
#[test]
fn elements_of_second_order_are_named() {
    for (number, name, nodes) in [
        (17, "a hex20", 20),
        (18, "a wedge15", 15),
        (19, "a pyramid13", 13),
        (12, "a hex27", 27),
    ] {
        let wanted = GmshFault::SecondOrder { name, element: 25 };
        always(wanted, "$Elements", "", |s| {
            s.elements[4].type_number = number;
            let more = 5000..5000 + nodes as u64;
            s.nodes
                .extend(more.clone().map(|tag| (tag, [tag as f64, 0.0, 0.0])));
            s.elements[4].nodes = more.collect();
        });
    }
}

/// Counts that are too small, too large or out of all bounds are faults of their section, found
/// before anything is kept in memory for them.
#[test]
fn wrong_counts() {
    let huge = [1_000, 1_000_000_000, 1 << 31, 1 << 61, u64::MAX];
    for wrong in [0, 1, 16, 18, 25, 40].into_iter().chain(huge) {
        for (format, _, place, fault) in changed(|s| s.stated_nodes = Some(wrong)) {
            assert_eq!(place.section, "$Nodes", "{format:?}, {wrong}: {fault}");
        }
    }
    // Nine records in version 2.2, eight in 4.1.
    for wrong in [0, 1, 7, 10, 30].into_iter().chain(huge) {
        for (format, _, place, fault) in changed(|s| s.stated_elements = Some(wrong)) {
            assert_eq!(place.section, "$Elements", "{format:?}, {wrong}: {fault}");
        }
    }
    for format in FORMATS {
        if matches!(format, Format::Binary2(_) | Format::Binary4(_, 4)) {
            continue;
        }
        let mut sample = Sample::tower();
        sample.stated_nodes = Some(1_000_000_000_000_000_000);
        let (_, fault) = fault(&sample.file(format));
        let what = "nodes";
        let count = 1_000_000_000_000_000_000;
        assert!(
            matches!(fault, GmshFault::Count { what: w, count: c, .. } if w == what && c == count),
            "{format:?}: {fault}"
        );
    }
}

/// Counts inside the blocks of version 4.1, and the range of numbers at their head.
#[test]
fn wrong_counts_of_blocks() {
    let place = |from: &str, to: &str| edit(Format::Text4, from, to);
    // The head of $Nodes: 5 blocks, 17 nodes, 1 to 321.
    for wrong in [
        "4 17 1 321",
        "6 17 1 321",
        "-5 17 1 321",
        "99999999999 17 1 321",
    ] {
        assert_eq!(place("5 17 1 321", wrong).0.section, "$Nodes", "{wrong}");
    }
    for (wrong, stated) in [("5 17 2 321", (2, 321)), ("5 17 1 400", (1, 400))] {
        let fault = place("5 17 1 321", wrong).1;
        let found = (1, 321);
        assert_eq!(
            fault,
            GmshFault::Range {
                what: "nodes",
                stated,
                found
            }
        );
    }
    for wrong in ["3 1 0 4", "3 1 0 6", "3 1 0 -1", "3 1 0 800000000000000000"] {
        assert_eq!(place("3 1 0 5", wrong).0.section, "$Nodes", "{wrong}");
    }
    for wrong in ["3 3 4 2", "3 3 4 0", "3 3 4 1000000000000000000"] {
        assert_eq!(place("3 3 4 1", wrong).0.section, "$Elements", "{wrong}");
    }
    let (at, fault) = place("3 3 4 1", "2 3 4 1");
    assert_eq!(
        fault,
        GmshFault::Dimension {
            what: "a tet4",
            dimension: 2
        }
    );
    assert_eq!(at.section, "$Elements");
    let fault = place("3 1 0 5", "4 1 0 5").1;
    assert_eq!(
        fault,
        GmshFault::Dimension {
            what: "an entity",
            dimension: 4
        }
    );
    // The head of $Entities: 1 point, 1 curve, 2 surfaces, 3 volumes.
    for wrong in [
        "1 1 2 4",
        "1 1 2 2",
        "1000000000000 1 2 3",
        "1 1 2 -3",
        "1 1 2",
    ] {
        assert_eq!(place("1 1 2 3", wrong).0.section, "$Entities", "{wrong}");
    }
    for wrong in ["0.5 1000000000 4", "0.5 2 4", "0.5 -1 4"] {
        assert_eq!(place("0.5 1 4", wrong).0.section, "$Entities", "{wrong}");
    }
    let fault = edit(
        Format::Text4,
        "\n2 0.5 0.5 0.5 0.5 0.5 0.5 2 1 2",
        "\n1 0.5 0.5 0.5 0.5 0.5 0.5 2 1 2",
    )
    .1;
    assert_eq!(
        fault,
        GmshFault::RepeatedEntity {
            dimension: 3,
            entity: 1
        }
    );
}

/// Words that are not numbers, numbers without a blank between them, and additional numbers are
/// reported at their position.
#[test]
fn words_that_are_no_numbers() {
    for format in [Format::Text2, Format::Text4] {
        for wrong in [
            "x 1.0 0.0",
            "1.0 1.0-2.0 0.0",
            "1.0 1.0 0.0 4.0",
            "1.0 1.0",
            "1,0 1.0 0.0",
        ] {
            let (place, fault) = edit(format, "1.0 1.0 0.1\n", &format!("{wrong}\n"));
            assert_eq!(place.section, "$Nodes", "{wrong}: {fault}");
        }
        for wrong in [
            "50 51 52 2.5",
            "50 51 52 -2",
            "50 51 52",
            "50 51 52 2 2",
            "50 51 5 2 2",
            "fifty 51 52 2",
        ] {
            let (place, fault) = edit(format, "50 51 52 2\n", &format!("{wrong}\n"));
            assert_eq!(place.section, "$Elements", "{wrong}: {fault}");
        }
        let (place, fault) = edit(format, "1.0 1.0 0.1\n", "1.0 abc 0.1\n");
        let GmshFault::Expected { found, .. } = fault else {
            panic!("{fault}");
        };
        assert!(found.starts_with("abc"), "{found}");
        let text = String::from_utf8(Sample::tower().file(format)).unwrap();
        let mut lines = text.lines();
        let line = lines.position(|line| line.ends_with("1.0 1.0 0.1"));
        assert_eq!(place.line, line.map(|line| line + 1));
    }
}
