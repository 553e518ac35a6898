//! Random meshes in every format.

use powerhouse_io::{GmshError, parse_gmsh, read_gmsh, write_gmsh};
use powerhouse_model::{ElementKind, Mesh, Vec3};

use super::sample::{FORMATS, Random, Sample};

fn path(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// A distorted box of hexes, wedges and tets in random groups, with random numbers in random
/// order, facets on its bottom, bars along an edge, points.
fn random_sample(random: &mut Random) -> Sample {
    let mut sample = Sample::default();
    let cells: [usize; 3] = std::array::from_fn(|_| 1 + random.below(3));
    let nodes = cells.map(|n| n + 1);
    let count = nodes.iter().product::<usize>();
    let mut tags: Vec<u64> = (0..count as u64 + 5)
        .map(|n| 1 + 3 * n + random.bits() % 3)
        .collect();
    random.shuffle(&mut tags);
    let index = |i: usize, j: usize, k: usize| i + nodes[0] * (j + nodes[1] * k);
    let at = |i, j, k| tags[index(i, j, k)];
    let group_count = 1 + random.below(4) as i32;
    for (k, j, i) in grid(nodes) {
        let position = [i, j, k].map(|x| 3.7 * (x as f64 + 0.2 * random.unit()));
        sample.nodes.push((at(i, j, k), position));
    }
    for spare in &tags[count..] {
        sample.nodes.push((*spare, [random.unit(), 0.0, 0.0]));
    }
    random.shuffle(&mut sample.nodes);
    for dimension in 0..4 {
        for group in 1..=group_count {
            sample
                .names
                .push((dimension, group, format!("set {dimension} {group}")));
        }
    }
    for (k, j, i) in grid(cells) {
        let hex = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(a, b)| (i + a, j + b));
        let low = hex.map(|(i, j)| at(i, j, k));
        let high = hex.map(|(i, j)| at(i, j, k + 1));
        // Each group list has its entity.
        let entity = 1 + random.below(3) as i32;
        let groups: Vec<i32> = (1..=group_count)
            .filter(|g| *g == 1 || g % 3 < entity)
            .collect();
        match random.below(3) {
            0 => sample.element(5, entity, &groups, &[low, high].concat()),
            1 => {
                for corner in [[0, 1, 2], [0, 2, 3]] {
                    let wedge = [corner.map(|c| low[c]), corner.map(|c| high[c])];
                    sample.element(6, entity, &groups, &wedge.concat());
                }
            }
            _ => {
                let all = [low, high].concat();
                for tet in [
                    [0, 1, 2, 6],
                    [0, 2, 3, 6],
                    [0, 3, 7, 6],
                    [0, 7, 4, 6],
                    [0, 4, 5, 6],
                    [0, 5, 1, 6],
                ] {
                    sample.element(4, entity, &groups, &tet.map(|c| all[c]));
                }
            }
        }
        if k == 0 && sample.elements.last().unwrap().type_number == 5 {
            sample.element(3, 2, &[1, group_count], &low);
        }
    }
    for i in 0..cells[0] {
        sample.element(1, 5, &[group_count], &[at(i, 0, 0), at(i + 1, 0, 0)]);
    }
    sample.element(15, 9, &[1], &[at(0, 0, 0)]);
    let mut numbers: Vec<u64> = (0..sample.elements.len() as u64)
        .map(|n| 5 + 2 * n)
        .collect();
    random.shuffle(&mut numbers);
    sample
        .elements
        .iter_mut()
        .zip(numbers)
        .for_each(|(element, number)| element.tag = number);
    sample.elements.iter_mut().for_each(|element| {
        element.groups.dedup();
    });
    sample
}

fn grid(counts: [usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..counts[2])
        .flat_map(move |k| (0..counts[1]).flat_map(move |j| (0..counts[0]).map(move |i| (k, j, i))))
}

/// Random meshes are read unchanged from every format, and from the writer.
#[test]
fn random_meshes_come_back() {
    let mut random = Random(11);
    let mut read = 0;
    for round in 0..150 {
        let sample = random_sample(&mut random);
        let mesh = sample.mesh();
        // Tets of neighbouring cells may not fit together, which is no concern here.
        for format in FORMATS {
            let found = parse_gmsh(&sample.file(format)).unwrap_or_else(|e| panic!("{round}: {e}"));
            assert_eq!(found.mesh, mesh, "round {round}, {format:?}");
        }
        let file = path("random.msh");
        write_gmsh(&file, &mesh).unwrap();
        assert_eq!(read_gmsh(&file).unwrap().mesh, mesh, "round {round}");
        read += 1;
    }
    assert_eq!(read, 150);
}

/// The writer keeps numbers, order, positions to the last bit, and elements of several sets.
#[test]
fn the_writer_keeps_all() {
    let mesh = Sample::tower().mesh();
    let file = path("tower.msh");
    write_gmsh(&file, &mesh).unwrap();
    let gmsh = read_gmsh(&file).unwrap();
    assert_eq!(gmsh.mesh, mesh);
    assert_eq!(gmsh.report.dropped_elements, 0);
}

fn tet(base: u64, size: f64, set: &str) -> Mesh {
    let mut builder = Mesh::builder();
    let corners = [
        [0.0; 3],
        [size, 0.0, 0.0],
        [0.0, size, 0.0],
        [0.0, 0.0, size],
    ];
    for (corner, position) in corners.into_iter().enumerate() {
        builder.node(base - corner as u64, Vec3::from(position));
    }
    let nodes = [base, base - 1, base - 2, base - 3];
    builder.element(base, ElementKind::Tet4, &nodes, &[set]);
    builder.facet("face", &nodes[..3]);
    builder.build().unwrap()
}

/// Extreme sizes and numbers are written so that they are read unchanged.
#[test]
fn the_writer_keeps_extremes() {
    for (base, size) in [
        (4, 1e-90),
        (1 << 53, 1e90),
        (u64::MAX - 1, 0.1),
        (9, 1.0 / 3.0),
    ] {
        let mesh = tet(base, size, "rock");
        let file = path("extreme.msh");
        write_gmsh(&file, &mesh).unwrap();
        assert_eq!(read_gmsh(&file).unwrap().mesh, mesh, "{base} {size}");
    }
}

/// What the format cannot represent is refused before a file is written.
#[test]
fn the_writer_refuses_what_it_cannot_represent() {
    for name in ["", "a\"b", "a\nb", "a\rb"] {
        let file = path("refused.msh");
        let refused = write_gmsh(&file, &tet(9, 1.0, name));
        assert!(matches!(refused, Err(GmshError::UnwritableName { name: n, .. }) if n == name));
        assert!(!file.exists());
    }
    let exhausted = write_gmsh(path("refused.msh"), &tet(u64::MAX, 1.0, "rock"));
    assert!(matches!(
        exhausted,
        Err(GmshError::NumbersExhausted {
            largest: u64::MAX,
            ..
        })
    ));
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let nowhere = write_gmsh(folder, &tet(9, 1.0, "rock"));
    assert!(matches!(nowhere, Err(GmshError::File(_))));
}
