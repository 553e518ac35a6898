//! Snapshots in one VTKHDF file.

use std::path::{Path, PathBuf};

use hdf5_pure::{AttrValue, File};
use powerhouse_io::{
    FieldPrecision, IoError, VtkHdf, VtuField, VtuGrid, VtuNumbers, VtuWriter, read_vtu,
};
use powerhouse_model::{Mesh, Vec3};

fn folder(name: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("powerhouse-vtkhdf-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A bar of 3 by 1 by 1 bricks with a set.
fn bar() -> Mesh {
    let mut mesh =
        Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(3.0, 1.0, 1.0), [3, 1, 1], "rock").unwrap();
    mesh.set_element_set("a/b", vec![1, 2]).unwrap();
    mesh.set_element_set("a_b", vec![0]).unwrap();
    mesh
}

/// The bar at a time: displacement, damage in single precision and a state, of which the last element may be inactive.
fn instant(file: &Path, mesh: &Mesh, time: f64, is_whole: bool) -> VtuGrid {
    let mut writer = VtuWriter::new(mesh, FieldPrecision::Single).unwrap();
    if !is_whole {
        writer.set_present(mesh, &[true, true, false]);
    }
    let motion: Vec<f64> = (0..3 * mesh.node_count())
        .map(|i| time + i as f64)
        .collect();
    let damage = [0.1, 0.2, 0.3].map(|damage| damage * time);
    let field = |name, components, numbers, unit, values| VtuField {
        name,
        components,
        numbers,
        unit,
        values,
    };
    let in_elements = [
        field("damage", 1, VtuNumbers::Real, "1", &damage),
        field("state", 1, VtuNumbers::Whole, "1", &[0.0, 2.0, 1.0]),
    ];
    let at_nodes = [field("displacement", 3, VtuNumbers::Real, "m", &motion)];
    writer.write(file, time, &at_nodes, &in_elements).unwrap();
    read_vtu(file).unwrap()
}

/// All steps have their fields, in the types of the files; mesh, numbers and sets are there once, and every offset points to
/// the part of its step.
#[test]
fn every_step_is_there_with_its_offsets() {
    let folder = folder("steps");
    let mesh = bar();
    let vtu = folder.join("one.vtu");
    let times = [0.5, 1.0, 2.0];
    let mut all = VtkHdf::new(instant(&vtu, &mesh, times[0], true), &vtu).unwrap();
    for time in &times[1..] {
        all.add(&instant(&vtu, &mesh, *time, false), &vtu).unwrap();
    }
    let path = folder.join("all.vtkhdf");
    all.write(&path).unwrap();
    let file = File::open(&path).unwrap();
    let read = |name: &str| file.dataset(&format!("VTKHDF/{name}")).unwrap();
    let whole = |name: &str| read(name).read_i64().unwrap();
    assert_eq!(read("Steps/Values").read_f64().unwrap(), times);
    let nodes = mesh.node_count();
    assert_eq!(whole("NumberOfPoints"), [nodes as i64]);
    assert_eq!(
        (whole("NumberOfCells"), whole("Offsets")),
        (vec![3], vec![0, 8, 16, 24])
    );
    assert_eq!(read("Types").read_u8().unwrap(), [12; 3]);
    let motion = read("PointData/displacement");
    assert_eq!(motion.shape().unwrap(), [3 * nodes as u64, 3]);
    let values = motion.read_f32().unwrap();
    let damage = read("CellData/damage").read_f32().unwrap();
    for (step, time) in times.into_iter().enumerate() {
        let start = whole("Steps/PointDataOffsets/displacement")[step] as usize;
        // The first node is one of active elements.
        assert_eq!(f64::from(values[3 * start + 2]), time + 2.0);
        let start = whole("Steps/CellDataOffsets/damage")[step] as usize;
        assert!((f64::from(damage[start + 1]) - 0.2 * time).abs() < 1e-6);
        assert_eq!(damage[start + 2].is_nan(), step > 0);
    }
    assert_eq!(
        read("CellData/state").read_i32().unwrap()[..6],
        [0, 2, 1, 0, 2, -1]
    );
    assert_eq!(
        read("CellData/present").read_u8().unwrap(),
        [1, 1, 1, 1, 1, 0, 1, 1, 0]
    );
    assert_eq!(whole("CellData/set a_b"), [0, 1, 1]);
    assert_eq!(whole("CellData/set a_b_2"), [1, 0, 0]);
    // Single precision and integers of 32 bits: three numbers at a node, two in an element; three times that.
    assert_eq!(all.memory(3), 3 * 3 * 4 * (3 * nodes as u64 + 2 * 3));
    for constant in [
        "PointDataOffsets/node_tag",
        "CellDataOffsets/set a_b",
        "PointOffsets",
    ] {
        assert_eq!(whole(&format!("Steps/{constant}")), [0; 3], "{constant}");
    }
    let attributes = motion.attrs().unwrap();
    assert_eq!(
        attributes.get("units"),
        Some(&AttrValue::AsciiString("m".into()))
    );
    std::fs::remove_dir_all(folder).unwrap();
}

/// Instants that do not go on from the first one are refused by the name of their file.
#[test]
fn other_instants_are_refused() {
    let folder = folder("others");
    let mesh = bar();
    let vtu = folder.join("one.vtu");
    let mut all = VtkHdf::new(instant(&vtu, &mesh, 1.0, true), &vtu).unwrap();
    let mut refused = |next: &VtuGrid| match all.add(next, Path::new("next.vtu")) {
        Err(IoError::Grid { file, reason }) if file == Path::new("next.vtu") => reason,
        other => panic!("{other:?}"),
    };
    let earlier = instant(&vtu, &mesh, 1.0, true);
    assert!(refused(&earlier).contains("1 s is not after 1 s"));
    let longer =
        Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 1.0, 1.0), [3, 1, 1], "rock").unwrap();
    assert!(refused(&instant(&vtu, &longer, 2.0, true)).contains("mesh"));
    let mut fewer = instant(&vtu, &mesh, 2.0, true);
    fewer.in_elements.pop();
    assert!(refused(&fewer).contains("fields"));
    let mut timeless = instant(&vtu, &mesh, 2.0, true);
    timeless.time = None;
    assert!(refused(&timeless).contains("no time"));
    std::fs::remove_dir_all(folder).unwrap();
}
