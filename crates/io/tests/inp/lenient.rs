//! Degenerate solids, shells on solids, springs, and what CalculiX permits.

use powerhouse_io::inp::InpFault;
use powerhouse_model::{ElementKind, Mesh};

use super::sample::{HOUSE, edit, fault, read};

/// Nodes of a brick of 2 x 3 x 4 m.
const BRICK: &str = "*NODE
1, 0, 0, 0
2, 2, 0, 0
3, 2, 3, 0
4, 0, 3, 0
5, 0, 0, 4
6, 2, 0, 4
7, 2, 3, 4
8, 0, 3, 4
";

fn solid(kind: &str, nodes: &[u64], rest: &str) -> String {
    let nodes: Vec<String> = nodes.iter().map(u64::to_string).collect();
    format!(
        "{BRICK}*ELEMENT, TYPE={kind}, ELSET=rock\n1, {}\n{rest}",
        nodes.join(", ")
    )
}

fn volume(mesh: &Mesh) -> f64 {
    mesh.volume_of(mesh.element_set("rock").unwrap())
}

/// Bricks, wedges and pyramids with repeated nodes are the wedges, pyramids and tetrahedra that they are, with their
/// volumes; faces keep their corners, and those without an area are left out.
#[test]
fn solids_with_repeated_nodes_are_what_they_are() {
    let whole = 24.0;
    for (kind, nodes, expected, share) in [
        (
            "C3D8R",
            vec![1, 2, 3, 3, 5, 6, 7, 7],
            ElementKind::Wedge6,
            1.0 / 2.0,
        ),
        (
            "C3D8",
            vec![1, 2, 2, 4, 5, 6, 6, 8],
            ElementKind::Wedge6,
            1.0 / 2.0,
        ),
        (
            "C3D8",
            vec![1, 2, 3, 4, 5, 6, 6, 5],
            ElementKind::Wedge6,
            1.0 / 2.0,
        ),
        (
            "C3D8",
            vec![1, 2, 3, 4, 5, 5, 5, 5],
            ElementKind::Pyramid5,
            1.0 / 3.0,
        ),
        (
            "C3D8I",
            vec![1, 2, 3, 3, 5, 5, 5, 5],
            ElementKind::Tet4,
            1.0 / 6.0,
        ),
        ("C3D6", vec![1, 2, 4, 5, 5, 5], ElementKind::Tet4, 1.0 / 6.0),
        ("C3D5", vec![1, 2, 3, 3, 5], ElementKind::Tet4, 1.0 / 6.0),
    ] {
        let inp = read(&solid(kind, &nodes, ""));
        assert_eq!(
            (inp.mesh.kind(0), inp.report.collapsed_elements),
            (expected, 1),
            "{nodes:?}"
        );
        assert!(
            (volume(&inp.mesh) - share * whole).abs() < 1e-12 * whole,
            "{nodes:?}"
        );
    }
    // Faces of a brick in the order of the format, by their corners.
    let corners: [[usize; 4]; 6] = [
        [0, 1, 2, 3],
        [4, 5, 6, 7],
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
    ];
    for nodes in [
        [1, 2, 3, 3, 5, 6, 7, 7],
        [1, 2, 3, 4, 5, 5, 5, 5],
        [1, 2, 3, 3, 5, 5, 5, 5],
    ] {
        for (face, corners) in corners.iter().enumerate() {
            let rest = format!("*SURFACE, NAME=side\nrock, S{}\n", face + 1);
            let inp = read(&solid("C3D8", &nodes, &rest));
            let mut expected = corners.map(|corner| nodes[corner]).to_vec();
            expected.sort_unstable();
            expected.dedup();
            let mesh = &inp.mesh;
            match mesh.facet_set("side") {
                Ok(&[facet]) => {
                    let side = mesh.kind(0).sides()[usize::from(facet.side)].iter();
                    let own = side.map(|&local| mesh.nodes_of(0)[usize::from(local)]);
                    let mut own: Vec<u64> =
                        own.map(|node| mesh.node_tags()[node as usize]).collect();
                    own.sort_unstable();
                    assert_eq!(own, expected, "{nodes:?} S{}", face + 1);
                }
                Err(_) => assert!(expected.len() < 3, "{nodes:?} S{}", face + 1),
                Ok(other) => panic!("{other:?}"),
            }
        }
    }
    let (_, twice) = fault(&solid("C3D8", &[1, 2, 3, 4, 5, 6, 7, 1], ""));
    assert!(twice.to_string().contains("node 1 twice"), "{twice}");
}

/// Shells and plane elements on sides of solids are facets, of their own sets and of those that name them, as in the
/// files that Gmsh writes.
#[test]
fn shells_on_solids_are_facets() {
    let shells = "*ELEMENT, TYPE=CPS4, ELSET=Surface1\n11, 1, 2, 3, 4\n12, 2, 1, 5, 6\n\
                  *ELEMENT, TYPE=S3R, ELSET=Surface2\n13, 5, 9, 6\n*NSET";
    let sets = "*ELSET, ELSET=BOTTOM\n11,\n*ELSET, ELSET=mixed\n11, 1\n*SURFACE, NAME=skin\n13, SPOS\nwalls, S2\n*MATERIAL";
    let text = edit(&edit(HOUSE, "*NSET", shells), "*MATERIAL", sets);
    let inp = read(&text);
    let (mesh, house) = (&inp.mesh, read(HOUSE).mesh);
    assert_eq!(mesh.element_count(), house.element_count());
    assert_eq!(mesh.node_count(), house.node_count());
    assert_eq!((inp.report.elements, inp.report.facet_elements), (5, 3));
    assert_eq!(
        mesh.facet_set("BOTTOM").unwrap(),
        house.facet_set("floor").unwrap()
    );
    assert_eq!(mesh.facet_set("Surface1").unwrap().len(), 2);
    assert_eq!(mesh.facet_set("Surface2").unwrap().len(), 1);
    assert_eq!(mesh.facet_set("Surface2").unwrap()[0].element, 1);
    assert_eq!(
        mesh.facet_set("mixed").unwrap(),
        house.facet_set("floor").unwrap()
    );
    assert_eq!(mesh.element_set("mixed").unwrap(), [0]);
    // The skin has the facet of the shell, and the face of the brick, which is not on the surface of the whole.
    assert_eq!(mesh.facet_set("skin").unwrap().len(), 2);
    assert!(mesh.element_set("Surface1").is_err() && mesh.element_set("BOTTOM").is_err());
    assert_eq!(inp.report.ungrouped_elements, 0);
    let alone = edit(&text, "13, 5, 9, 6", "13, 1, 9, 6");
    let (place, lost) = fault(&alone);
    assert_eq!(
        lost,
        InpFault::Shell {
            element: 13,
            name: "S3"
        }
    );
    assert!(
        alone
            .lines()
            .nth(place.line - 1)
            .unwrap()
            .starts_with("13, 1")
    );
    let plane = format!("{BRICK}*ELEMENT, TYPE=CPS4, ELSET=a\n1, 1, 2, 3, 4\n");
    assert_eq!(fault(&plane).1, InpFault::NoSolids { facets: 1 });
    assert!(fault(&plane).1.to_string().contains("Extrude"));
    for (member, face) in [("walls", "SPOS"), ("11", "S1")] {
        let wrong = edit(&text, "13, SPOS", &format!("{member}, {face}"));
        assert!(fault(&wrong).1.to_string().contains("S1 to S6"), "{face}");
    }
}

/// Springs, dashpots and masses are left out and counted, and sets may name them; elements with further unknowns are
/// read by their shape and counted.
#[test]
fn springs_are_left_out_and_counted() {
    let springs = "*ELEMENT, TYPE=SPRINGA, ELSET=springs\n101, 1, 77\n102, 2, 77\n\
                   *ELEMENT, TYPE=DashpotA\n103, 1, 77\n*ELEMENT, TYPE=MASS, ELSET=m\n104, 77\n*NSET";
    let text = edit(HOUSE, "*NSET", springs).replace("walls, roof", "walls, roof, 101, 103");
    let inp = read(&text);
    let house = read(HOUSE);
    assert_eq!(inp.mesh, house.mesh);
    let counted = [("DASHPOTA", 1), ("MASS", 1), ("SPRINGA", 2)]
        .map(|(name, count)| (name.to_string(), count));
    assert_eq!(inp.report.left_out, counted);
    let number = edit(&text, "roof, 101", "roof, 105");
    assert!(fault(&number).1.to_string().contains("element 105"));
    for (name, coupled) in [("C3D8T", 1), ("C3D8RP", 1), ("C3D8RH", 0)] {
        let inp = read(&edit(HOUSE, "TYPE=C3D8R", &format!("TYPE={name}")));
        assert_eq!(
            (&inp.mesh, inp.report.coupled_elements),
            (&house.mesh, coupled),
            "{name}"
        );
    }
}

/// Coordinates that are omitted are zero and counted; elements go on in the next line without a comma; a byte order
/// mark changes nothing.
#[test]
fn files_of_calculix_are_read() {
    let house = read(HOUSE).mesh;
    let text = edit(HOUSE, "1, 0., 0., 0.", "1, 0.");
    let text = edit(&text, "5, 0., 0., 1.", "5, , , 1.");
    let text = edit(&text, "2, 1., 0., 0.", "2, 1.,");
    let inp = read(&text);
    assert_eq!((&inp.mesh, inp.report.omitted_coordinates), (&house, 3));
    for lines in [
        "1, 1, 2, 3, 4\n5, 6, 7, 8",
        "1, 1, 2, 3, 4,\n5, 6\n7\n8",
        "1\n1, 2, 3, 4, 5, 6, 7, 8",
    ] {
        assert_eq!(
            read(&edit(HOUSE, "1, 1, 2, 3, 4, 5, 6, 7, 8", lines)).mesh,
            house,
            "{lines}"
        );
    }
    // A line that is too short does not take its nodes from the next element.
    let two = "1, 1, 2, 3, 4, 5, 6, 7\n3, 1, 2, 3, 4, 5, 6, 7, 8";
    assert!(
        fault(&edit(HOUSE, "1, 1, 2, 3, 4, 5, 6, 7, 8", two))
            .1
            .to_string()
            .contains("last node")
    );
    assert_eq!(read(&format!("\u{feff}{HOUSE}")).mesh, house);
    let gmsh = fault("$MeshFormat\n2.2 0 8\n").1.to_string();
    assert!(gmsh.contains("Gmsh mesh"), "{gmsh}");
}
