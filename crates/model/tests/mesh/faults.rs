use powerhouse_model::{ElementKind, Facet, Mesh, MeshBuilder, MeshError, Vec3};

const CUBE: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];
const ORDER: [u64; 8] = [11, 12, 13, 14, 15, 16, 17, 18];

/// Nodes 11 to 18 on the unit cube, and one hexahedron, number 5, on them.
fn cube() -> MeshBuilder {
    let mut builder = nodes();
    builder.element(5, ElementKind::Hex8, &ORDER, &["rock"]);
    builder
}

fn nodes() -> MeshBuilder {
    let mut builder = Mesh::builder();
    for (tag, position) in ORDER.into_iter().zip(CUBE) {
        builder.node(tag, Vec3::from(position));
    }
    builder
}

/// Every number that does not fit is named, each fault by its own variant.
#[test]
fn numbers_that_do_not_fit_are_named() {
    assert_eq!(nodes().build(), Err(MeshError::Empty));
    assert_eq!(Mesh::builder().build(), Err(MeshError::Empty));

    let mut builder = cube();
    builder.node(13, Vec3::zeros());
    assert_eq!(builder.build(), Err(MeshError::DuplicateNode { node: 13 }));

    let mut builder = cube();
    builder.element(5, ElementKind::Bar2, &[11, 12], &["bolts"]);
    assert_eq!(
        builder.build(),
        Err(MeshError::DuplicateElement { element: 5 })
    );

    for reversed in [false, true] {
        let mut order = ORDER;
        if reversed {
            order.reverse();
        }
        let mut builder = cube();
        builder.element(3, ElementKind::Bar2, &[11, 12], &["bolts"]);
        builder.element(6, ElementKind::Hex8, &order, &["rock"]);
        let coincident = MeshError::CoincidentElements {
            first: 5,
            second: 6,
        };
        assert_eq!(builder.build(), Err(coincident));
    }

    for (axis, value) in [
        ('x', f64::NAN),
        ('y', f64::INFINITY),
        ('z', f64::NEG_INFINITY),
    ] {
        let mut builder = cube();
        let axes = ['x', 'y', 'z'];
        let position = Vec3::from_fn(|i, _| if axes[i] == axis { value } else { 0.0 });
        builder.node(19, position);
        match builder.build() {
            Err(MeshError::CoordinateNotFinite {
                node: 19,
                axis: named,
                value: shown,
            }) => {
                assert_eq!((named, shown.to_bits()), (axis, value.to_bits()));
            }
            other => panic!("{other:?}"),
        }
    }

    let mut builder = nodes();
    builder.element(5, ElementKind::Tet4, &[11, 12, 12, 15], &["rock"]);
    assert_eq!(
        builder.build(),
        Err(MeshError::RepeatedNode {
            element: 5,
            node: 12
        })
    );

    let mut builder = nodes();
    builder.element(5, ElementKind::Tet4, &[11, 12, u64::MAX, 15], &["rock"]);
    let dangling = MeshError::DanglingNode {
        element: 5,
        node: u64::MAX,
    };
    assert_eq!(builder.build(), Err(dangling));

    let mut builder = nodes();
    builder.element(5, ElementKind::Wedge6, &[11, 12, 13, 15], &["rock"]);
    let count = MeshError::NodeCount {
        element: 5,
        kind: "wedge6",
        found: 4,
        expected: 6,
    };
    assert_eq!(builder.build(), Err(count));
}

/// Sets that point outside the mesh, or have the wrong name, are named with what exists.
#[test]
fn sets_that_point_nowhere_are_named() {
    let mut builder = cube();
    builder.node_set("probes", &[11, (1 << 32) + 11]);
    let lost = MeshError::SetOutOfRange {
        what: "node",
        name: "probes".into(),
        number: (1 << 32) + 11,
    };
    assert_eq!(builder.build(), Err(lost));

    for wrong in [
        &[11, 12, 13, 18][..],
        &[11, 12, 13],
        &[11, 12, 13, 14, 15],
        &[11, 99, 13, 14],
        &[],
    ] {
        let mut builder = cube();
        builder.facet("base", wrong);
        let lost = MeshError::FacetWithoutElement {
            name: "base".into(),
            nodes: wrong.into(),
        };
        assert_eq!(builder.build(), Err(lost));
    }
    let mut builder = cube();
    builder.facet("base", &[13, 11, 12, 14]);
    let mut mesh = builder.build().unwrap();
    assert_eq!(
        mesh.facet_set("base").unwrap(),
        [Facet {
            element: 0,
            side: 0
        }]
    );

    let missing = MeshError::NoSuchSet {
        what: "facet",
        name: "bottom".into(),
        available: vec!["base".into()],
    };
    assert_eq!(mesh.facet_set("bottom"), Err(missing));
    assert!(matches!(
        mesh.node_set("base"),
        Err(MeshError::NoSuchSet { what: "node", .. })
    ));
    let error = mesh.element_set("lining").unwrap_err();
    assert_eq!(
        error.to_string(),
        "there is no element set 'lining'; the mesh has rock"
    );
    let error = mesh.nodes_of_set("lining").unwrap_err();
    assert_eq!(
        error.to_string(),
        "there is no node, facet or element set 'lining'; the mesh has base, rock"
    );
    let nodes = |mesh: &Mesh, set| mesh.nodes_of_set(set).unwrap();
    assert_eq!(nodes(&mesh, "rock"), [0, 1, 2, 3, 4, 5, 6, 7]);
    let facets = mesh.facet_set("base").unwrap();
    assert_eq!(nodes(&mesh, "base"), mesh.nodes_of_facets(facets));
    // A node set comes before a facet set of the same name.
    mesh.set_node_set("base", vec![2]).unwrap();
    assert_eq!(nodes(&mesh, "base"), [2]);

    let range = |what, number| MeshError::SetOutOfRange {
        what,
        name: "s".into(),
        number,
    };
    assert_eq!(mesh.set_node_set("s", vec![8, 2]), Err(range("node", 8)));
    assert_eq!(mesh.set_element_set("s", vec![1]), Err(range("element", 1)));
    assert_eq!(
        mesh.set_facet_set(
            "s",
            vec![Facet {
                element: 1,
                side: 0
            }]
        ),
        Err(range("facet", 1))
    );
    let side = MeshError::NoSuchSide {
        name: "s".into(),
        element: 5,
        side: 6,
        sides: 6,
    };
    assert_eq!(
        mesh.set_facet_set(
            "s",
            vec![Facet {
                element: 0,
                side: 6
            }]
        ),
        Err(side)
    );
    mesh.set_node_set("s", vec![3, 1, 3]).unwrap();
    assert_eq!(mesh.node_set("s").unwrap(), [1, 3]);
}

/// Inverted, flat and pointless elements are named with the corner, bars without length too.
#[test]
fn elements_without_volume_are_named() {
    let spoiled = |tag: u64, position: [f64; 3]| {
        let mut builder = Mesh::builder();
        for (node, place) in ORDER.into_iter().zip(CUBE) {
            builder.node(node, Vec3::from(if node == tag { position } else { place }));
        }
        builder.element(5, ElementKind::Hex8, &ORDER, &["rock"]);
        builder.build().unwrap().check().unwrap_err()
    };
    // Pulled through the cube, flat against the base, onto its neighbour.
    for position in [[-0.5, -0.5, -0.5], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]] {
        let error = spoiled(17, position);
        assert!(
            matches!(error, MeshError::Inverted { element: 5, .. }),
            "{error:?}"
        );
    }
    let mut builder = nodes();
    builder.element(9, ElementKind::Tet4, &[11, 12, 13, 14], &["rock"]);
    match builder.build().unwrap().check() {
        Err(MeshError::Inverted {
            element: 9,
            scaled_jacobian,
            ..
        }) => {
            assert_eq!(scaled_jacobian, 0.0);
        }
        other => panic!("{other:?}"),
    }
    let mut builder = cube();
    builder.node(21, Vec3::from(CUBE[0]));
    builder.element(6, ElementKind::Bar2, &[11, 21], &["bolts"]);
    assert_eq!(
        builder.build().unwrap().check(),
        Err(MeshError::NoLength { element: 6 })
    );
}

/// Coordinates near the largest number give an error, not a silent NaN.
#[test]
fn overflow_is_a_fault() {
    let mesh = cube()
        .build()
        .unwrap()
        .map_positions(|p| p * 1e200)
        .unwrap();
    assert!(matches!(
        mesh.check(),
        Err(MeshError::Inverted { element: 5, .. })
    ));
}

/// Nodes without elements and parts without connection are named.
#[test]
fn what_hangs_nowhere_is_named() {
    let mut builder = cube();
    builder.node(31, Vec3::zeros()).node(30, Vec3::zeros());
    let orphan = MeshError::OrphanNode { node: 31, count: 2 };
    assert_eq!(builder.build().unwrap().check(), Err(orphan));

    let mut builder = cube();
    builder.node(41, Vec3::new(5.0, 0.0, 0.0));
    builder.node(42, Vec3::new(6.0, 0.0, 0.0));
    builder.element(4, ElementKind::Bar2, &[41, 42], &["bolts"]);
    let mesh = builder.build().unwrap();
    assert_eq!(mesh.check().unwrap().parts, 2);
    let apart = MeshError::Disconnected {
        parts: 2,
        element: 4,
    };
    assert_eq!(mesh.check_connected(), Err(apart));
}
