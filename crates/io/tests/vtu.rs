//! VTU files, read back by an independent decoder.

use std::io::Read as _;
use std::path::PathBuf;

use flate2::read::ZlibDecoder;
use powerhouse_io::{FieldPrecision, IoError, PvdCollection, VtuField, VtuNumbers, VtuWriter};
use powerhouse_model::{Mesh, Vec3};

fn folder(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("powerhouse-vtu-{}-{name}", std::process::id()))
}

fn small_box() -> Mesh {
    Mesh::box_of_hexes(
        Vec3::zeros(),
        Vec3::new(3.0, 2.0, 1.0),
        [30, 20, 10],
        "rock",
    )
    .unwrap()
}

/// The bytes of a named array.
fn array(file: &[u8], name: &str) -> Vec<u8> {
    let mark = b"<AppendedData encoding=\"raw\">\n_";
    let data = file.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len();
    let xml = std::str::from_utf8(&file[..data - mark.len()]).unwrap();
    let tag = xml
        .lines()
        .find(|l| l.contains(&format!("Name=\"{name}\"")))
        .unwrap();
    let offset = tag
        .split("offset=\"")
        .nth(1)
        .unwrap()
        .split('"')
        .next()
        .unwrap();
    let at = data + offset.parse::<usize>().unwrap();
    let word = |i: usize| {
        u64::from_le_bytes(file[at + 8 * i..at + 8 * i + 8].try_into().unwrap()) as usize
    };
    let (blocks, size, last) = (word(0), word(1), word(2));
    let mut start = at + 8 * (3 + blocks);
    let mut out = Vec::new();
    for block in 0..blocks {
        let length = word(3 + block);
        let before = out.len();
        ZlibDecoder::new(&file[start..start + length])
            .read_to_end(&mut out)
            .unwrap();
        let wanted = if block + 1 == blocks && last > 0 {
            last
        } else {
            size
        };
        assert_eq!(out.len() - before, wanted);
        start += length;
    }
    out
}

fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes
        .chunks(8)
        .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
        .collect()
}

/// Positions, cells, tags and fields are read back, over more than one block, in double precision to
/// the bit and in single precision rounded.
#[test]
fn what_is_written_is_read_back() {
    let mesh = small_box();
    let folder = folder("round");
    let values: Vec<f64> = (0..mesh.node_count() * 3)
        .map(|i| (i as f64).sin())
        .collect();
    let stress: Vec<f64> = (0..mesh.element_count() * 6)
        .map(|i| (i as f64).cos())
        .collect();
    let at_nodes = [VtuField {
        name: "displacement",
        components: 3,
        numbers: VtuNumbers::Real,
        unit: "",
        values: &values,
    }];
    let in_elements = [VtuField {
        name: "stress",
        components: 6,
        numbers: VtuNumbers::Real,
        unit: "",
        values: &stress,
    }];
    for precision in [FieldPrecision::Single, FieldPrecision::Double] {
        let file = folder.join("one.vtu");
        let writer = VtuWriter::new(&mesh, precision).unwrap();
        writer.write(&file, 0.5, &at_nodes, &in_elements).unwrap();
        let content = std::fs::read(&file).unwrap();
        let positions: Vec<f64> = mesh
            .positions()
            .iter()
            .flat_map(|p| [p.x, p.y, p.z])
            .collect();
        assert_eq!(doubles(&array(&content, "Points")), positions);
        let connectivity: Vec<u32> = array(&content, "connectivity")
            .chunks(8)
            .map(|b| i64::from_le_bytes(b.try_into().unwrap()) as u32)
            .collect();
        assert_eq!(&connectivity[8 * 77..8 * 78], mesh.nodes_of(77));
        let field = array(&content, "displacement");
        match precision {
            FieldPrecision::Double => assert_eq!(doubles(&field), values),
            FieldPrecision::Single => {
                let singles = field
                    .chunks(4)
                    .map(|b| f32::from_le_bytes(b.try_into().unwrap()));
                assert!(
                    singles
                        .zip(&values)
                        .all(|(single, value)| single == *value as f32)
                );
            }
        }
        assert_eq!(array(&content, "set rock"), vec![1; mesh.element_count()]);
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// After every instant the collection names files that exist, with their times.
#[test]
fn a_collection_is_complete_after_every_instant() {
    let folder = folder("series");
    let writer = VtuWriter::new(&small_box(), FieldPrecision::Single).unwrap();
    let mut series = PvdCollection::new(folder.join("snapshots.pvd"), writer);
    for instant in 0..3 {
        series.add(0.25 * f64::from(instant), &[], &[]).unwrap();
        let text = std::fs::read_to_string(series.file()).unwrap();
        let files: Vec<&str> = text
            .split("file=\"")
            .skip(1)
            .map(|rest| rest.split('"').next().unwrap())
            .collect();
        assert_eq!(files.len(), instant as usize + 1);
        assert!(files.iter().all(|file| folder.join(file).is_file()));
    }
    assert!(
        std::fs::read_to_string(series.file())
            .unwrap()
            .contains("timestep=\"0.5\"")
    );
    std::fs::remove_dir_all(folder).unwrap();
}

/// Integers are read back as integers, whatever the precision of the file; other numbers are refused
/// by name.
#[test]
fn whole_numbers_are_integers() {
    let mesh = small_box();
    let folder = folder("whole");
    let file = folder.join("one.vtu");
    let flags: Vec<f64> = (0..mesh.element_count()).map(|i| (i % 4) as f64).collect();
    fn field(values: &[f64]) -> [VtuField<'_>; 1] {
        [VtuField {
            name: "yield_state",
            components: 1,
            numbers: VtuNumbers::Whole,
            unit: "",
            values,
        }]
    }
    for precision in [FieldPrecision::Single, FieldPrecision::Double] {
        let writer = VtuWriter::new(&mesh, precision).unwrap();
        writer.write(&file, 0.0, &[], &field(&flags)).unwrap();
        let content = std::fs::read(&file).unwrap();
        let head = String::from_utf8_lossy(&content);
        assert!(head.contains("type=\"Int32\" Name=\"yield_state\""));
        let found: Vec<f64> = array(&content, "yield_state")
            .chunks(4)
            .map(|b| f64::from(i32::from_le_bytes(b.try_into().unwrap())))
            .collect();
        assert_eq!(found, flags);
    }
    let writer = VtuWriter::new(&mesh, FieldPrecision::Single).unwrap();
    for value in [0.5, 3e9] {
        let mut faulty = flags.clone();
        faulty[7] = value;
        assert!(matches!(
            writer.write(&file, 0.0, &[], &field(&faulty)),
            Err(IoError::NotWhole { what, index: 7, .. }) if what == "yield_state"
        ));
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// A field that does not fit the mesh, or that holds a number which is not finite, is refused by
/// name before anything is written.
#[test]
fn faulty_fields_are_refused() {
    let mesh = small_box();
    let file = folder("bad").join("bad.vtu");
    let writer = VtuWriter::new(&mesh, FieldPrecision::Single).unwrap();
    let short = [VtuField {
        name: "velocity",
        components: 3,
        numbers: VtuNumbers::Real,
        unit: "",
        values: &[0.0; 3],
    }];
    assert!(matches!(
        writer.write(&file, 0.0, &short, &[]),
        Err(IoError::Length { what, found: 3, .. }) if what == "velocity"
    ));
    let mut values = vec![0.0; mesh.node_count()];
    values[5] = f64::INFINITY;
    let infinite = [VtuField {
        name: "speed",
        components: 1,
        numbers: VtuNumbers::Real,
        unit: "",
        values: &values,
    }];
    assert!(matches!(
        writer.write(&file, 0.0, &infinite, &[]),
        Err(IoError::NotFinite { what, index: 5, .. }) if what == "speed"
    ));
    assert!(!file.exists());
}

/// With inactive elements a file has the field of active ones, and no values of the others: reals are
/// NaN, integers -1, vectors of nodes that only they have zero. Units and the order of components are in
/// the file.
#[test]
fn inactive_elements_have_no_values() {
    let mesh = small_box();
    let folder = folder("present");
    let file = folder.join("one.vtu");
    // The upper half is excavated; its numbers may be anything.
    let present: Vec<bool> = (0..mesh.element_count() as u32)
        .map(|element| mesh.centroid(element).z < 0.5)
        .collect();
    let anything = |count: usize| -> Vec<f64> { (0..count).map(|i| (i as f64).tan()).collect() };
    let mut stress = anything(6 * mesh.element_count());
    let absent = present.iter().position(|is| !is).unwrap();
    stress[6 * absent + 2] = f64::INFINITY;
    let (moved, peak) = (anything(3 * mesh.node_count()), anything(mesh.node_count()));
    let flags = vec![2.0; mesh.element_count()];
    let field = |name, components, numbers, unit, values| VtuField {
        name,
        components,
        numbers,
        unit,
        values,
    };
    let at_nodes = [
        field("displacement", 3, VtuNumbers::Real, "m", &moved[..]),
        field("peak", 1, VtuNumbers::Real, "m/s", &peak),
    ];
    let in_elements = [
        field("stress", 6, VtuNumbers::Real, "Pa", &stress[..]),
        field("flags", 1, VtuNumbers::Whole, "", &flags),
    ];
    let mut writer = VtuWriter::new(&mesh, FieldPrecision::Double).unwrap();
    assert!(writer.write(&file, 0.0, &at_nodes, &in_elements).is_err());
    writer.set_present(&mesh, &present);
    writer.write(&file, 0.0, &at_nodes, &in_elements).unwrap();
    let content = std::fs::read(&file).unwrap();
    let whole = |name: &str| -> Vec<i32> {
        let bytes = array(&content, name);
        let words = bytes
            .chunks(4)
            .map(|b| i32::from_le_bytes(b.try_into().unwrap()));
        words.collect()
    };
    let stresses = doubles(&array(&content, "stress"));
    for (element, &is) in present.iter().enumerate() {
        assert_eq!(whole("present")[element], i32::from(is));
        assert_eq!(whole("flags")[element], if is { 2 } else { -1 });
        for component in 6 * element..6 * element + 6 {
            let value = stresses[component];
            assert!(if is {
                value == stress[component]
            } else {
                value.is_nan()
            });
        }
    }
    let (vectors, peaks) = (
        doubles(&array(&content, "displacement")),
        doubles(&array(&content, "peak")),
    );
    let mut beyond = 0;
    for (node, position) in mesh.positions().iter().enumerate() {
        let is_there = position.z < 0.5 + 1e-9;
        beyond += usize::from(!is_there);
        assert_eq!(peaks[node].is_nan(), !is_there);
        assert_eq!(
            vectors[3 * node + 1],
            if is_there { moved[3 * node + 1] } else { 0.0 }
        );
    }
    assert_eq!(beyond, 31 * 21 * 5);
    let head = String::from_utf8_lossy(&content);
    assert!(head.contains(">Pa</InformationKey>") && head.contains("ComponentName5=\"zx\""));
    let text = head.split("<!-- units\n").nth(1).unwrap();
    let text = text.split(" -->").next().unwrap();
    let is_there = |line: &str| line == "stress: Pa (xx yy zz xy yz zx)";
    assert!(text.lines().any(is_there), "{text}");
    // An array of text in the file is one that meshio does not read.
    assert!(!head.contains("type=\"String\""));
    std::fs::remove_dir_all(folder).unwrap();
}

/// Pyramids are VTK's pyramids; tetrahedra with midpoints are its quadratic tetrahedra, whose midpoints are those of the
/// edges 01, 12, 20, 03, 13, 23 in turn; facets of six nodes are polygons.
#[test]
fn pyramids_and_midpoints_have_their_cells() {
    let path = folder("orders").with_extension("vtu");
    let tets = Mesh::box_of_tets(Vec3::zeros(), Vec3::repeat(1.0), [1; 3], "rock").unwrap();
    let tens = tets.with_midpoints().unwrap();
    let pyramids = Mesh::box_of_pyramids(Vec3::zeros(), Vec3::repeat(1.0), [1; 3], "rock").unwrap();
    for (mesh, kind) in [(&tens, 24_u8), (&pyramids, 14)] {
        let writer = VtuWriter::new(mesh, FieldPrecision::Single).unwrap();
        writer.write(&path, 0.0, &[], &[]).unwrap();
        let file = std::fs::read(&path).unwrap();
        assert!(array(&file, "types").iter().all(|&cell| cell == kind));
        let bytes = array(&file, "connectivity");
        let nodes: Vec<usize> = bytes
            .chunks(8)
            .map(|bytes| u64::from_le_bytes(bytes.try_into().unwrap()) as usize)
            .collect();
        for cell in nodes.chunks(if kind == 24 { 10 } else { 5 }) {
            let at = |i: usize| mesh.positions()[cell[i]];
            if kind == 24 {
                let edges = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
                for (i, [a, b]) in edges.into_iter().enumerate() {
                    assert_eq!(at(4 + i), (at(a) + at(b)) * 0.5);
                }
            } else {
                // The base is seen counter-clockwise from the apex.
                let normal = (at(1) - at(0)).cross(&(at(3) - at(0)));
                assert!(normal.dot(&(at(4) - at(0))) > 0.0);
            }
        }
    }
    let facets: Vec<Vec<u32>> = tens
        .boundary_facets()
        .iter()
        .map(|&f| tens.facet_nodes(f))
        .collect();
    let writer = VtuWriter::of_facets(tens.positions(), &facets, FieldPrecision::Single).unwrap();
    writer.write(&path, 0.0, &[], &[]).unwrap();
    let file = std::fs::read(&path).unwrap();
    assert!(array(&file, "types").iter().all(|&cell| cell == 7));
    std::fs::remove_file(path).unwrap();
}
