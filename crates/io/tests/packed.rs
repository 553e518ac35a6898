//! Packed mesh files: written, mapped, changed, shortened and damaged.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use powerhouse_io::{PackedMeshFault, read_packed_mesh, write_packed_mesh};
use powerhouse_model::{ElementKind, Mesh, Vec3};

/// A folder that is removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let name = format!("powerhouse-packed-{name}-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }
    fn file(&self) -> PathBuf {
        self.0.join("mesh.phm")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A wedge, a tetrahedron on it and a bar, with sparse numbers and sets of all kinds.
fn mixed() -> Mesh {
    let mut builder = Mesh::builder();
    let points = [
        (70, [0.0, 0.0, 0.0]),
        (3, [1.0, 0.0, 0.0]),
        (5_000_000_000, [0.0, 1.0, 0.0]),
        (9, [0.0, 0.0, 1.0]),
        (11, [1.0, 0.0, 1.0]),
        (12, [0.0, 1.0, 1.25]),
        (1, [0.3, 0.3, 2.0]),
    ];
    for (tag, position) in points {
        builder.node(tag, Vec3::from(position));
    }
    let wedge = [70, 3, 5_000_000_000, 9, 11, 12];
    builder.element(40, ElementKind::Wedge6, &wedge, &["rock", "all of it"]);
    builder.element(
        7,
        ElementKind::Tet4,
        &[9, 11, 12, 1],
        &["all of it", "Überbau"],
    );
    builder.element(8, ElementKind::Bar2, &[70, 1], &["bolts"]);
    builder.facet("floor", &[70, 3, 5_000_000_000]);
    builder.facet("wall", &[70, 3, 11, 9]);
    builder.node_set("crown", &[1, 12]);
    builder.build().unwrap()
}

#[test]
fn a_mapped_mesh_is_the_mesh_that_was_written() {
    let folder = Folder::new("equal");
    let boxes = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(3.0, 2.0, 1.0), [3, 2, 1], "rock");
    for mesh in [mixed(), boxes.unwrap(), mixed().with_straight_edges()] {
        write_packed_mesh(folder.file(), &mesh, None).unwrap();
        let (mapped, _) = read_packed_mesh(folder.file()).unwrap();
        assert_eq!(mapped, mesh);
        assert_eq!(mapped.boundary_facets(), mesh.boundary_facets());
    }
}

#[test]
fn a_changed_mesh_leaves_the_file_as_it_is() {
    let folder = Folder::new("changed");
    let mesh = mixed();
    write_packed_mesh(folder.file(), &mesh, None).unwrap();
    let (mapped, _) = read_packed_mesh(folder.file()).unwrap();
    let twice = mapped.clone().map_positions(|x| x * 2.0).unwrap();
    assert_eq!(twice.positions()[1], mesh.positions()[1] * 2.0);
    assert_eq!(mapped, mesh);
    // A new file takes the place of the one that is in use.
    write_packed_mesh(folder.file(), &twice, None).unwrap();
    assert_eq!(mapped, mesh);
    assert_eq!(read_packed_mesh(folder.file()).unwrap().0, twice);
}

#[test]
fn every_changed_byte_and_every_shortened_file_is_refused() {
    let folder = Folder::new("damaged");
    let (file, mesh) = (folder.file(), mixed());
    let source = folder.0.join("mesh.msh");
    fs::write(&source, "text").unwrap();
    write_packed_mesh(&file, &mesh, Some(&source)).unwrap();
    let sound = fs::read(&file).unwrap();
    for place in 0..sound.len() {
        let mut damaged = sound.clone();
        damaged[place] ^= 0x41;
        fs::write(&file, &damaged).unwrap();
        let error = read_packed_mesh(&file).unwrap_err();
        let message = error.to_string();
        assert!(message.contains("mesh.phm: "), "{message}");
        let expected = matches!(
            (place, error.fault),
            (0..16, PackedMeshFault::NotPacked)
                | (16..20, PackedMeshFault::Version { .. })
                | (24..56, PackedMeshFault::Length { .. })
                | (20..24 | 56.., PackedMeshFault::Checksum { .. })
        );
        assert!(expected, "{place}: {message}");
    }
    for length in (0..sound.len()).step_by(7) {
        fs::write(&file, &sound[..length]).unwrap();
        let error = read_packed_mesh(&file).unwrap_err();
        match error.fault {
            PackedMeshFault::NotPacked => assert!(length < 128),
            PackedMeshFault::Length { found, expected } => {
                assert_eq!((found, expected), (length as u64, sound.len() as u64));
            }
            other => panic!("{length}: {other}"),
        }
    }
}

#[test]
fn what_is_no_packed_mesh_is_refused_with_its_name() {
    let folder = Folder::new("other");
    let missing = read_packed_mesh(folder.file()).unwrap_err();
    assert!(missing.to_string().contains("mesh.phm: "), "{missing}");
    fs::write(folder.file(), "$MeshFormat\n2.2 0 8\n".repeat(20)).unwrap();
    let error = read_packed_mesh(folder.file()).unwrap_err();
    assert!(matches!(error.fault, PackedMeshFault::NotPacked), "{error}");
    let error = read_packed_mesh(&folder.0).unwrap_err();
    assert!(matches!(error.fault, PackedMeshFault::NoFile), "{error}");
}

/// A file that is overwritten in place is found by its user, one that another file replaces is not.
#[test]
fn a_file_overwritten_in_place_is_found() {
    let folder = Folder::new("in-place");
    let file = folder.file();
    write_packed_mesh(&file, &mixed(), None).unwrap();
    let (_, packed) = read_packed_mesh(&file).unwrap();
    packed.check().unwrap();
    write_packed_mesh(&file, &mixed().with_straight_edges(), None).unwrap();
    packed.check().unwrap();
    let (_, packed) = read_packed_mesh(&file).unwrap();
    let bytes = fs::read(&file).unwrap();
    // Times of files may have the resolution of a clock tick.
    std::thread::sleep(std::time::Duration::from_millis(20));
    let write = |bytes: &[u8]| {
        let mut opened = fs::OpenOptions::new().write(true).open(&file).unwrap();
        opened.write_all(bytes).unwrap();
    };
    // The same bytes, with another date.
    write(&bytes);
    packed.check().unwrap();
    let mut other = bytes.clone();
    other[140] ^= 1;
    write(&other);
    let error = packed.check().unwrap_err();
    assert!(matches!(error.fault, PackedMeshFault::Changed), "{error}");
    write(&bytes);
    packed.check().unwrap();
    fs::write(&file, &bytes[..bytes.len() - 8]).unwrap();
    let error = packed.check().unwrap_err();
    assert!(matches!(error.fault, PackedMeshFault::Changed), "{error}");
    assert!(error.to_string().contains("mesh.phm: "), "{error}");
}

/// A mesh file that was changed after it was packed is found, wherever it is; one that was only copied anew is not.
#[test]
fn a_changed_source_is_found() {
    let folder = Folder::new("source");
    let [below, beside] = ["below", "beside"].map(|name| folder.0.join(name));
    for parent in [&below, &beside] {
        fs::create_dir_all(parent).unwrap();
    }
    let source = beside.join("mesh.msh");
    for packed in [
        folder.file(),
        below.join("mesh.phm"),
        beside.join("mesh.phm"),
    ] {
        fs::write(&source, "first").unwrap();
        write_packed_mesh(&packed, &mixed(), Some(&source)).unwrap();
        let changed = || read_packed_mesh(&packed).unwrap().1.changed_source();
        let found = read_packed_mesh(&packed).unwrap().1;
        assert_eq!(found.source().unwrap().length, 5);
        assert_eq!(changed(), None);
        std::thread::sleep(std::time::Duration::from_millis(20));
        fs::write(&source, "first").unwrap();
        assert_eq!(changed(), None);
        fs::write(&source, "other").unwrap();
        let found = changed().unwrap();
        assert!(
            found.ends_with("mesh.msh") && found.exists(),
            "{}",
            found.display()
        );
        fs::write(&source, "longer").unwrap();
        assert!(changed().is_some());
        fs::remove_file(&source).unwrap();
        assert_eq!(changed(), None);
    }
}
