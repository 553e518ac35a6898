use powerhouse_model::{ElementKind, EngineError, Mesh, PeriodicPairs, Vec3};

/// Corners of the six tetrahedra of a unit cube around its diagonal from the corner `start`.
fn tetrahedra(start: usize) -> Vec<[usize; 4]> {
    let orders = [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [0, 2, 1],
        [2, 1, 0],
        [1, 0, 2],
    ];
    let path = |order: [usize; 3]| {
        let mut corners = [start; 4];
        for (step, axis) in order.into_iter().enumerate() {
            corners[step + 1] = corners[step] ^ (1 << axis);
        }
        corners
    };
    orders.map(path).to_vec()
}

/// Two bodies of 2 x 3 x 2 cubes each, above one another along `axis`, of bricks or of tetrahedra around one diagonal of
/// every cube, apart along the plane between them.
fn bodies(axis: usize, diagonal: Option<usize>) -> Mesh {
    let mut counts = [2, 3, 2];
    counts[axis] = 4;
    let stride = [1, 10, 100];
    let number = |i: [usize; 3]| 1 + (0..3).map(|k| i[k] * stride[k]).sum::<usize>() as u64;
    let mut builder = Mesh::builder();
    let each = |ends: [usize; 3]| {
        (0..ends[0])
            .flat_map(move |x| (0..ends[1]).flat_map(move |y| (0..ends[2]).map(move |z| [x, y, z])))
    };
    for i in each(counts.map(|count| count + 1)) {
        builder.node(
            number(i),
            Vec3::new(0.7 * i[0] as f64, i[1] as f64, 1.3 * i[2] as f64),
        );
    }
    let mut tag = 0;
    for cell in each(counts) {
        let body = if cell[axis] < 2 { "low" } else { "up" };
        let at = |corner: usize| number([0, 1, 2].map(|k| cell[k] + (corner >> k & 1)));
        let mut add = |kind, corners: &[usize]| {
            tag += 1;
            let nodes: Vec<u64> = corners.iter().map(|&corner| at(corner)).collect();
            builder.element(tag, kind, &nodes, &[body]);
        };
        match diagonal {
            None => add(ElementKind::Hex8, &[0, 1, 3, 2, 4, 5, 7, 6]),
            Some(start) => {
                for mut corners in tetrahedra(start) {
                    let point = |corner: usize| Vec3::from_fn(|k, _| (corner >> k & 1) as f64);
                    let [a, b, c, d] = corners.map(point);
                    if (b - a).cross(&(c - a)).dot(&(d - a)) < 0.0 {
                        corners.swap(2, 3);
                    }
                    add(ElementKind::Tet4, &corners);
                }
            }
        }
    }
    let mesh = builder.build().unwrap();
    let set = |name| mesh.element_set(name).unwrap();
    mesh.split_between(set("low"), set("up")).unwrap().mesh
}

/// Nodes of two faces that a joint crosses are paired with those on the same side of it, whatever the elements: bricks, and
/// tetrahedra around each diagonal, where the elements at a node and at its partner differ.
#[test]
fn periodic_nodes_are_paired_on_the_same_side_of_a_joint() {
    for axis in 0..3 {
        for diagonal in [None, Some(0), Some(1), Some(2), Some(3)] {
            let mesh = bodies(axis, diagonal);
            let (low, high) = mesh.bounding_box();
            let mut body = vec![""; mesh.node_count()];
            for name in ["low", "up"] {
                for node in mesh.nodes_of_elements(mesh.element_set(name).unwrap()) {
                    body[node as usize] = name;
                }
            }
            for across in (0..3).filter(|across| *across != axis) {
                let face = |plane: f64| -> Vec<u32> {
                    let nodes = 0..mesh.node_count() as u32;
                    nodes
                        .filter(|&n| (mesh.positions()[n as usize][across] - plane).abs() < 1e-9)
                        .collect()
                };
                let (from, to) = (face(low[across]), face(high[across]));
                let found = PeriodicPairs::by_translation(&mesh, &from, &to, 1e-6).unwrap();
                assert_eq!(found.pairs.len(), from.len());
                for (from, to) in found.pairs {
                    assert_eq!(
                        body[from as usize], body[to as usize],
                        "{axis} {across} {diagonal:?}"
                    );
                }
            }
        }
    }
}

/// Coincident nodes on the same side of the surface are refused as such, not as nodes that are apart.
#[test]
fn coincident_nodes_on_the_same_side_are_refused() {
    let mut builder = Mesh::builder();
    for (tag, x) in [(1, 0.0), (2, 0.0), (11, 5.0), (12, 5.0)] {
        builder.node(tag, Vec3::new(x, 0.0, 0.0));
    }
    builder.element(1, ElementKind::Bar2, &[1, 11], &["bar"]);
    builder.element(2, ElementKind::Bar2, &[2, 12], &["bar"]);
    let mesh = builder.build().unwrap();
    let error = PeriodicPairs::by_translation(&mesh, &[0, 1], &[2, 3], 1e-6).unwrap_err();
    assert!(
        matches!(error, EngineError::PeriodicSides { node: 11 | 12 }),
        "{error}"
    );
}
