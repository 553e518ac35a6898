//! VTU and PVD files that are read again.

use std::path::PathBuf;

use powerhouse_io::{
    FieldPrecision, IoError, PvdCollection, VtuField, VtuNumbers, VtuWriter, read_pvd, read_vtu,
};
use powerhouse_model::{ElementKind, Mesh, Vec3};

fn folder(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("powerhouse-read-{}-{name}", std::process::id()))
}

fn field<'a>(name: &'a str, components: usize, unit: &'a str, values: &'a [f64]) -> VtuField<'a> {
    VtuField {
        name,
        components,
        numbers: VtuNumbers::Real,
        unit,
        values,
    }
}

/// A brick with a wedge beside it, a pyramid and a tetrahedron on top, and a bar; numbers with gaps; sets with names that
/// XML escapes, one of them over two kinds.
fn mixture() -> Mesh {
    let mut builder = Mesh::builder();
    let corner = |i: usize| Vec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
    for (tag, i) in [
        (10, 0),
        (11, 1),
        (12, 3),
        (13, 2),
        (14, 4),
        (15, 5),
        (16, 7),
        (17, 6),
    ] {
        builder.node(tag, corner(i));
    }
    builder.node(20, Vec3::new(2.0, 0.0, 0.0));
    builder.node(21, Vec3::new(2.0, 0.0, 1.0));
    builder.node(22, Vec3::new(0.5, 0.5, 2.0));
    builder.node(23, Vec3::new(0.5, -1.0, 2.0));
    builder.element(
        7,
        ElementKind::Hex8,
        &[10, 11, 12, 13, 14, 15, 16, 17],
        &["rock"],
    );
    builder.element(
        9,
        ElementKind::Wedge6,
        &[11, 20, 12, 15, 21, 16],
        &["rock", "a & b"],
    );
    builder.element(12, ElementKind::Pyramid5, &[14, 15, 16, 17, 22], &["top"]);
    builder.element(13, ElementKind::Tet4, &[14, 23, 15, 22], &["top"]);
    builder.element(30, ElementKind::Bar2, &[10, 22], &["bolt"]);
    builder.build().unwrap()
}

/// Kinds, nodes, numbers, sets, time, units and fields of a mesh of all kinds are those that were written; tetrahedra with
/// midpoints, too.
#[test]
fn a_mesh_with_fields_is_read_as_it_was_written() {
    let tens = Mesh::box_of_tets(Vec3::zeros(), Vec3::repeat(1.0), [2, 1, 1], "rock").unwrap();
    for (name, mesh) in [
        ("mixture", mixture()),
        ("tens", tens.with_midpoints().unwrap()),
    ] {
        let file = folder(name).with_extension("vtu");
        let moved: Vec<f64> = (0..3 * mesh.node_count())
            .map(|i| (i as f64).sin())
            .collect();
        let stress: Vec<f64> = (0..6 * mesh.element_count())
            .map(|i| (i as f64).cos())
            .collect();
        let writer = VtuWriter::new(&mesh, FieldPrecision::Double).unwrap();
        let at_nodes = [field("displacement", 3, "m", &moved)];
        let in_elements = [
            field("stress", 6, "Pa", &stress),
            field("a < b", 6, "", &stress),
        ];
        writer.write(&file, 0.25, &at_nodes, &in_elements).unwrap();
        let grid = read_vtu(&file).unwrap();
        std::fs::remove_file(&file).unwrap();
        assert_eq!(grid.time, Some(0.25));
        assert_eq!(grid.present, None);
        assert_eq!(grid.mesh.positions(), mesh.positions());
        assert_eq!(grid.mesh.node_tags(), mesh.node_tags());
        assert_eq!(grid.mesh.element_tags(), mesh.element_tags());
        assert_eq!(grid.mesh.element_sets(), mesh.element_sets());
        for element in 0..mesh.element_count() as u32 {
            assert_eq!(grid.mesh.kind(element), mesh.kind(element));
            assert_eq!(grid.mesh.nodes_of(element), mesh.nodes_of(element));
        }
        let [read] = &grid.at_nodes[..] else { panic!() };
        assert_eq!(
            (&*read.name, &*read.unit, read.components),
            ("displacement", "m", 3)
        );
        assert_eq!(read.values, moved);
        let names: Vec<(&str, &str)> = (grid.in_elements.iter())
            .map(|field| (&*field.name, &*field.unit))
            .collect();
        assert_eq!(names, [("stress", "Pa"), ("a < b", "")]);
        assert_eq!(grid.in_elements[0].values, stress);
    }
}

/// Of a body with inactive elements the flags are read; fields are NaN in these.
#[test]
fn inactive_elements_are_known() {
    let mesh = mixture();
    let file = folder("present").with_extension("vtu");
    let mut writer = VtuWriter::new(&mesh, FieldPrecision::Single).unwrap();
    let present = [true, false, true, true, false];
    writer.set_present(&mesh, &present);
    let values = [1.0, f64::NAN, 3.0, 4.0, f64::NAN];
    writer
        .write(&file, 0.0, &[], &[field("damage", 1, "", &values)])
        .unwrap();
    let grid = read_vtu(&file).unwrap();
    std::fs::remove_file(&file).unwrap();
    assert_eq!(grid.present.as_deref(), Some(&present[..]));
    let [damage] = &grid.in_elements[..] else {
        panic!()
    };
    for ((read, written), is_there) in damage.values.iter().zip(values).zip(present) {
        assert!(if is_there {
            *read == written
        } else {
            read.is_nan()
        });
    }
}

/// A collection lists its files with their times and parts; its first file is that of the body.
#[test]
fn a_collection_lists_its_files() {
    let folder = folder("collection");
    let mesh = mixture();
    let writer = VtuWriter::new(&mesh, FieldPrecision::Single).unwrap();
    let of_joint = VtuWriter::of_facets(
        mesh.positions(),
        &[vec![0, 1, 2, 3]],
        FieldPrecision::Single,
    );
    let mut collection = PvdCollection::new(folder.join("snap & shots.pvd"), writer);
    for time in [0.0, 0.5] {
        let of_joint = of_joint.as_ref().unwrap();
        collection
            .add_with(time, &[], &[], &[("joint", of_joint, &[])])
            .unwrap();
    }
    let entries = read_pvd(collection.file()).unwrap();
    let listed: Vec<(f64, usize)> = entries.iter().map(|e| (e.time, e.part)).collect();
    assert_eq!(listed, [(0.0, 0), (0.0, 1), (0.5, 0), (0.5, 1)]);
    assert_eq!(read_vtu(&entries[2].file).unwrap().time, Some(0.5));
    let error = read_vtu(&entries[3].file).unwrap_err().to_string();
    assert!(
        error.contains("joint.vtu: cell 0 is of VTK's type 9"),
        "{error}"
    );
    let error = read_vtu(collection.file()).unwrap_err().to_string();
    assert!(error.contains("there is no appended data"), "{error}");
    let error = read_pvd(&entries[0].file).unwrap_err();
    assert!(matches!(error, IoError::Grid { .. }), "{error}");
    std::fs::remove_dir_all(folder).unwrap();
}

/// Files that are cut off or have other bytes are read or refused with the name of the file, without a panic; where one
/// is read, its fields have the length of its mesh.
#[test]
fn damaged_files_are_refused() {
    let file = folder("damaged").with_extension("vtu");
    let mesh = mixture();
    let values: Vec<f64> = (0..mesh.node_count()).map(|node| node as f64).collect();
    let writer = VtuWriter::new(&mesh, FieldPrecision::Single).unwrap();
    writer
        .write(&file, 0.0, &[field("u", 1, "m", &values)], &[])
        .unwrap();
    let whole = std::fs::read(&file).unwrap();
    let mut refused = 0;
    let mut attempt = |bytes: &[u8]| {
        std::fs::write(&file, bytes).unwrap();
        match read_vtu(&file) {
            Ok(grid) => {
                let fields = grid.at_nodes.iter();
                let expected =
                    |f: &powerhouse_io::FieldOfFile| f.components * grid.mesh.node_count();
                assert!(fields.clone().all(|f| f.values.len() == expected(f)));
            }
            Err(error) => {
                assert!(error.to_string().contains("damaged.vtu: "), "{error}");
                refused += 1;
            }
        }
    };
    // The last bytes are the end of the XML behind the data.
    let end = whole.len() - 40;
    for length in (0..end).step_by(7) {
        attempt(&whole[..length]);
    }
    for place in (0..whole.len()).step_by(3) {
        let mut bytes = whole.clone();
        bytes[place] ^= 1 << (place % 8);
        attempt(&bytes);
    }
    assert!(refused > (0..end).step_by(7).count(), "{refused}");
    std::fs::remove_file(file).unwrap();
}
