//! Sets, surfaces and the syntax of keyword lines and data lines.

use powerhouse_model::{ElementKind, Vec3};

use super::sample::{HOUSE, edit, read};

/// The house has its sets, surfaces, and a report of what was left out.
#[test]
fn a_file_is_read_whole() {
    let inp = read(HOUSE);
    let (mesh, report) = (&inp.mesh, &inp.report);
    assert_eq!((mesh.node_count(), mesh.element_count()), (10, 2));
    assert_eq!(
        (mesh.kind(0), mesh.kind(1)),
        (ElementKind::Hex8, ElementKind::Wedge6)
    );
    assert_eq!(mesh.element_set("walls").unwrap(), [0]);
    assert_eq!(mesh.element_set("roof").unwrap(), [1]);
    assert_eq!(mesh.element_set("house").unwrap(), [0, 1]);
    assert_eq!(mesh.node_set("ground").unwrap(), [0, 1, 2, 3]);
    // Without the point that is outside.
    assert_eq!(mesh.node_set("every").unwrap().len(), 10);
    let area = |set: &str| -> Vec3 {
        let facets = mesh.facet_set(set).unwrap().iter();
        facets
            .map(|&facet| mesh.facet_geometry(facet).vector_area)
            .sum()
    };
    assert!((area("floor") + Vec3::z()).norm() < 1e-15);
    assert_eq!(mesh.facet_set("gables").unwrap().len(), 2);
    assert!(area("gables").norm() < 1e-15);
    assert_eq!(
        (report.nodes, report.elements, report.dropped_nodes),
        (11, 2, 1)
    );
    assert_eq!(
        report.skipped_keywords,
        ["*ELASTIC", "*HEADING", "*MATERIAL"]
    );
    assert_eq!(
        (report.ungrouped_elements, report.has_element_sets),
        (0, true)
    );
    assert!((mesh.volume_of(&[0, 1]) - 1.25).abs() < 1e-15);
}

/// Ways to write the same content.
#[test]
fn one_content_has_many_forms() {
    let whole = read(HOUSE);
    for (from, to) in [
        ("*NODE, NSET=every", "*Node ,nset = every"),
        ("*NODE, NSET=every", "*NODE,\nNSET=every"),
        ("*NODE, NSET=every", "*NODE,\n** a comment\n  NSET=every"),
        ("1, 0., 0., 0.\n", "  1 ,0.0,0D0,\t0.E0,\n"),
        ("9, 0.5, 0., 1.5", "9, 5.d-1, -0., 15E-1"),
        (
            "1, 1, 2, 3, 4, 5, 6, 7, 8",
            "1, 1, 2, 3,\n4, 5, 6, 7,\n\n** a comment\n8,",
        ),
        ("1, 4\n", "1, 3, 2\n2, 4, 2\n"),
        ("NSET=ground, GENERATE\n1, 4", "NSET=ground\n1, 2, 3,\n4,"),
        (
            "NSET=ground, GENERATE\n1, 4",
            "NSET=GROUND\n1, 2\n*NSET, NSET=ground\n3, 4, 4, 1",
        ),
        ("walls, roof", "WALLS,\nRoof"),
        ("walls, roof", "walls, 2,"),
        ("walls, S1", "1, s1"),
        (
            "*SURFACE, NAME=floor, TYPE=ELEMENT",
            "*surface, type=element, name=floor",
        ),
    ] {
        let changed = read(&edit(HOUSE, from, to)).mesh;
        let mesh = &whole.mesh;
        assert_eq!(changed.positions(), mesh.positions(), "{to}");
        assert_eq!(changed.element_sets(), mesh.element_sets(), "{to}");
        assert_eq!(changed.facet_sets(), mesh.facet_sets(), "{to}");
        let nodes = |sets: &std::collections::BTreeMap<String, Vec<u32>>| -> Vec<Vec<u32>> {
            let mut lists: Vec<Vec<u32>> = sets.values().cloned().collect();
            lists.sort_unstable();
            lists
        };
        assert_eq!(nodes(changed.node_sets()), nodes(mesh.node_sets()), "{to}");
    }
    let windows = HOUSE.replace('\n', "\r\n");
    assert_eq!(read(&windows), whole);
    assert_eq!(read(HOUSE.trim_end()), whole);
}

/// Elements and sets may be before the nodes, and sets before the elements.
#[test]
fn the_order_of_keywords_is_free() {
    let (head, rest) = HOUSE.split_at(HOUSE.find("*NODE").unwrap());
    let (nodes, rest) = rest.split_at(rest.find("*ELEMENT").unwrap());
    let (elements, rest) = rest.split_at(rest.find("*NSET").unwrap());
    let (sets, rest) = rest.split_at(rest.find("*MATERIAL").unwrap());
    let moved = [head, sets, elements, nodes, rest].concat();
    assert_eq!(read(&moved), read(HOUSE));
}

/// Elements without a set are in `all` or `ungrouped`; internal sets are no sets of elements.
#[test]
fn elements_without_a_set_are_kept() {
    let bare = HOUSE
        .replace(", ELSET=walls", "")
        .replace(", ELSET=roof", "");
    let start = bare.find("*NSET").unwrap();
    let inp = read(&bare[..start]);
    assert_eq!(inp.mesh.element_set("all").unwrap(), [0, 1]);
    assert_eq!(
        (inp.report.ungrouped_elements, inp.report.has_element_sets),
        (2, false)
    );
    let some = format!("{}*ELSET, ELSET=roof\n2\n", &bare[..start]);
    let inp = read(&some);
    assert_eq!(inp.mesh.element_set("ungrouped").unwrap(), [0]);
    assert_eq!(
        (inp.report.ungrouped_elements, inp.report.has_element_sets),
        (1, true)
    );
    let inner = format!("{}*ELSET, ELSET=_s, INTERNAL\n2\n", &bare[..start]);
    let inp = read(&inner);
    assert_eq!(inp.mesh.element_set("all").unwrap(), [0, 1]);
    assert_eq!(inp.mesh.element_set("_s").unwrap(), [1]);
}

/// Names in quotation marks may have commas, blanks and capitals of their own.
#[test]
fn names_in_quotation_marks() {
    let text = HOUSE.replace("walls", "\"East, west\"");
    let mesh = read(&text).mesh;
    assert_eq!(mesh.element_set("East, west").unwrap(), [0]);
    assert_eq!(
        mesh.facet_set("floor").unwrap(),
        read(HOUSE).mesh.facet_set("floor").unwrap()
    );
}

/// Sets without members and surfaces of other types are listed, and not in the mesh.
#[test]
fn what_is_left_out_is_listed() {
    let text = HOUSE.to_owned()
        + "*NSET, NSET=nothing\n*NSET, NSET=point\n77\n*SURFACE, NAME=nodes, TYPE=NODE\nground, 1.\n*STEP\n*NODE PRINT\nU\n*END STEP\n";
    let inp = read(&text);
    assert_eq!(inp.report.empty_sets, ["nothing", "point"]);
    assert!(inp.mesh.node_set("point").is_err());
    assert!(inp.mesh.facet_set("nodes").is_err());
    let skipped = &inp.report.skipped_keywords;
    for keyword in ["*SURFACE, TYPE=NODE", "*STEP", "*NODE PRINT", "*END STEP"] {
        assert!(skipped.iter().any(|own| own == keyword), "{keyword}");
    }
}
