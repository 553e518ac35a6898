//! Meshes of several kinds of elements, and what pyramids cost.

use super::*;

/// A box of cells of 2 m, whose nodes are all moved without order: bricks, a column of wedges through the whole height, cells
/// of six pyramids inside, and at a corner cells whose outer pyramids are pairs of tetrahedra.
fn mixed() -> Mesh {
    let cells = [4, 3, 3];
    let high = Vec3::from(cells.map(|count| 2.0 * count as f64));
    let bricks = Mesh::box_of_hexes(Vec3::zeros(), high, cells, "rock").unwrap();
    let mut noise = Noise(23);
    let mut builder = Mesh::builder();
    for (tag, position) in (1..).zip(bricks.positions()) {
        builder.node(tag, position + noise.vector() * 0.3);
    }
    let (mut next_node, mut tag) = (bricks.node_count() as u64 + 1, 0);
    let surface = bricks.boundary_facets();
    for element in 0..bricks.element_count() as u32 {
        let nodes: Vec<u64> = bricks
            .nodes_of(element)
            .iter()
            .map(|&n| 1 + u64::from(n))
            .collect();
        let [i, j, k] = [0, 1, 2].map(|axis| (bricks.centroid(element)[axis] / 2.0) as usize);
        let mut add = |kind, nodes: &[u64], set: &str| {
            tag += 1;
            builder.element(tag, kind, nodes, &[set]);
        };
        if (i, j) == (0, 0) {
            let wedges = [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]];
            for wedge in wedges {
                add(ElementKind::Wedge6, &wedge.map(|a| nodes[a]), "wedges");
            }
        } else if [(1, 1, 1), (2, 1, 1), (3, 2, 2), (3, 1, 2)].contains(&(i, j, k)) {
            let apex = next_node;
            next_node += 1;
            for side in 0..6 {
                let facet = powerhouse_model::Facet { element, side };
                let base = bricks.facet_nodes(facet);
                let [a, b, c, d] = [3, 2, 1, 0].map(|i| 1 + u64::from(base[i]));
                if surface.contains(&facet) {
                    add(ElementKind::Tet4, &[a, b, c, apex], "tets");
                    add(ElementKind::Tet4, &[a, c, d, apex], "tets");
                } else {
                    add(ElementKind::Pyramid5, &[a, b, c, d, apex], "pyramids");
                }
            }
            builder.node(apex, bricks.centroid(element) + noise.vector() * 0.3);
        } else {
            add(ElementKind::Hex8, &nodes, "bricks");
        }
    }
    builder.build().unwrap()
}

/// The patch test in a mesh of bricks of every kernel, wedges, pyramids and tetrahedra: under a linear displacement no force
/// at inner nodes, and masses that add up to that of the box.
#[test]
fn kinds_join_without_a_trace() {
    let mesh = mixed();
    mesh.check().unwrap();
    let all: Vec<u32> = (0..mesh.node_count() as u32).collect();
    let mut outer = vec![false; all.len()];
    for facet in mesh.boundary_facets() {
        for node in mesh.facet_nodes(facet) {
            outer[node as usize] = true;
        }
    }
    assert!(outer.iter().filter(|outer| !**outer).count() > 12);
    for brick in SolidKernel::ALL
        .into_iter()
        .filter(|k| k.kind() == ElementKind::Hex8)
    {
        let (mut sums, mut masses) = (vec![Vec3::zeros(); all.len()], vec![0.0; all.len()]);
        for (set, kernel) in [
            ("bricks", brick),
            ("wedges", SolidKernel::Wedge6),
            ("pyramids", SolidKernel::Pyramid5),
            ("tets", SolidKernel::Tet4),
        ] {
            let elements = mesh.element_set(set).unwrap();
            assert!(elements.len() > 5, "{set}");
            let part = BlockPart::new(&mesh, elements, &all);
            let factory = kernel.factory(set, Linear(rock()), BlockOptions::default());
            let mut fixture = Fixture {
                mesh: mesh.clone(),
                block: factory.build(&part).unwrap(),
            };
            let u = fixture.field(|x| GRADIENT * x * 1e-3);
            for (sum, force) in sums.iter_mut().zip(fixture.forces(&u, &zeros(u.len()))) {
                *sum += force;
            }
            fixture.block.add_mass(&mut masses);
        }
        let scale = largest(&sums);
        for (node, force) in sums.iter().enumerate().filter(|(node, _)| !outer[*node]) {
            assert!(
                force.norm() < 1e-13 * scale,
                "{} {node} {force}",
                brick.name()
            );
        }
        let elements: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let exact = 2750.0 * mesh.volume_of(&elements);
        assert!((masses.iter().sum::<f64>() / exact - 1.0).abs() < 1e-13);
    }
}

/// A right pyramid has 3/16 of its mass at each corner of its base and 1/4 at the apex, and its step over the time of a P wave
/// along an edge of the base falls with the height of the apex; that of a cube is 0.82.
#[test]
fn flat_pyramids_have_short_steps() {
    let medium = ElasticMedium::new(9.0e9, 0.2, 2750.0).unwrap();
    for (height, expected) in [(0.25, 0.22), (0.5, 0.42), (1.0, 0.71)] {
        let mut builder = Mesh::builder();
        for (tag, [r, s, t]) in (1..).zip(ElementKind::Pyramid5.natural_corners()) {
            builder.node(tag, Vec3::new(1.5 * r, 1.5 * s, 1.5 * height * t));
        }
        builder.element(1, ElementKind::Pyramid5, &[1, 2, 3, 4, 5], &["rock"]);
        let mesh = builder.build().unwrap();
        let options = BlockOptions::default();
        let fixture = Fixture::of(mesh, SolidKernel::Pyramid5, Linear(medium), options);
        let masses = fixture.masses();
        let all: f64 = masses.iter().sum();
        for (node, share) in [(0, 3.0 / 16.0), (3, 3.0 / 16.0), (4, 0.25)] {
            assert!((masses[fixture.place(node)] / all - share).abs() < 1e-14);
        }
        let step = 2.0 / fixture.block.frequency_bounds()[0].frequency;
        let found = step * medium.p_speed() / 3.0;
        assert!((found - expected).abs() < 0.01, "{height} {found}");
    }
}
