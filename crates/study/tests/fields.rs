//! Pictures of fields in files that are given.

use std::path::{Path, PathBuf};

use powerhouse::io::{FieldPrecision, PvdCollection, VtuField, VtuNumbers, VtuWriter};
use powerhouse::model::{Mesh, Vec3};
use powerhouse_report::fields::{
    Animation, DeformationFactor, FieldLine, FieldPicture, FieldQuantity, RecordedFields,
};
use powerhouse_study::StudyError;
use powerhouse_test_support::TestFolder;

/// A bar of 10 by 4 by 4 m of two sets, `left` up to x = 5 m.
fn bar() -> Mesh {
    let mut mesh =
        Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(10.0, 4.0, 4.0), [10, 4, 4], "all").unwrap();
    let all = 0..mesh.element_count() as u32;
    let left = all.filter(|&e| mesh.centroid(e).x < 5.0).collect();
    mesh.set_element_set("left", left).unwrap();
    mesh
}

/// Snapshots of the bar at whole seconds: displacements, and a stress of which xx is the time and zz is x.
fn snapshots(folder: &Path, times: usize, motion: impl Fn(Vec3, f64) -> Vec3) -> RecordedFields {
    let mesh = bar();
    let writer = VtuWriter::new(&mesh, FieldPrecision::Double).unwrap();
    let mut collection = PvdCollection::new(folder.join("snapshots.pvd"), writer);
    for time in (0..times).map(|time| time as f64) {
        let moved = mesh.positions().iter().map(|x| motion(*x, time));
        let moved: Vec<f64> = moved.flat_map(|u| [u.x, u.y, u.z]).collect();
        let elements = 0..mesh.element_count() as u32;
        let stress: Vec<f64> = elements
            .flat_map(|e| [time, 0.0, mesh.centroid(e).x, 0.0, 0.0, 0.0])
            .collect();
        let field = |name, components, unit, values| VtuField {
            name,
            components,
            numbers: VtuNumbers::Real,
            unit,
            values,
        };
        let at_nodes = [field("displacement", 3, "m", &moved)];
        collection
            .add(time, &at_nodes, &[field("stress", 6, "Pa", &stress)])
            .unwrap();
    }
    RecordedFields::at(folder).unwrap()
}

fn drawn(picture: &FieldPicture, fields: &RecordedFields, file: PathBuf) -> Vec<u8> {
    picture.write(fields, fields.nearest(None), &file).unwrap();
    std::fs::read(file).unwrap()
}

/// A body that moves as a whole is drawn as one at rest, one that is stretched is not; the automatic factor is the round one
/// that is stated.
#[test]
fn deformation_is_relative_to_the_mean_motion() {
    let folder = TestFolder::new("fields-deformed");
    let picture_of = |name: &str, factor, motion: &dyn Fn(Vec3) -> Vec3| {
        let fields = snapshots(&folder.join(name), 1, |x, _| motion(x));
        let mut picture = FieldPicture::new("stress.zz");
        picture.size = [300, 200];
        picture.deformation = Some(factor);
        let file = folder.join(name).join("one.png");
        drawn(&picture, &fields, file)
    };
    let factor = DeformationFactor::Factor(100.0);
    let still = picture_of("still", factor, &|_| Vec3::zeros());
    assert_eq!(
        still,
        picture_of("moved", factor, &|_| Vec3::new(3.0, 2.0, 1.0))
    );
    let stretched = |size: f64| move |x: Vec3| Vec3::new(size * x.x, 0.0, 0.0);
    let small = picture_of("small", factor, &stretched(1e-3));
    assert_ne!(still, small);
    // Diagonal 11.5 m: a twentieth is 0.57 m, and displacements are up to 5 mm, so that the factor is 100.
    assert_eq!(
        small,
        picture_of("automatic", DeformationFactor::Automatic, &stretched(1e-3))
    );
}

/// Snapshots are found by time; the sets, the quantities and an empty folder are what they are said to be.
#[test]
fn instants_and_sets_are_found() {
    let folder = TestFolder::new("fields-instants");
    let fields = snapshots(&folder.join("run"), 5, |x, t| 1e-3 * t * x);
    assert_eq!(fields.len(), 5);
    assert_eq!(fields.nearest(Some(1.4)), 1);
    assert_eq!(fields.nearest(Some(1e9)), 4);
    assert_eq!(fields.nearest(None), 4);
    assert_eq!(fields.between(Some(1.0), Some(3.5)), [1, 2, 3]);
    let of = |sets: &[&str]| {
        let mut picture = FieldPicture::new("stress.greatest");
        picture.size = [300, 200];
        picture.sets = sets.iter().map(|set| (*set).to_owned()).collect();
        drawn(&picture, &fields, folder.join("set.png"))
    };
    assert_ne!(of(&["left"]), of(&[]));
    assert!(matches!(
        RecordedFields::at(folder.join("run/snapshots/snapshots_00003.vtu"))
            .map(|one| one.times().next()),
        Ok(Some(3.0))
    ));
    assert_eq!(
        RecordedFields::at(folder.join("run/snapshots.pvd"))
            .unwrap()
            .len(),
        5
    );
    assert!(matches!(
        RecordedFields::at(folder.join("none-here").parent().unwrap()),
        Err(StudyError::NoSnapshots { .. })
    ));
}

/// An animation has one scale of colours: its last picture is that which is drawn alone with the range of all.
#[test]
fn an_animation_has_one_scale() {
    let folder = TestFolder::new("fields-animation");
    let fields = snapshots(&folder.join("run"), 3, |x, t| 1e-3 * t * x);
    let mut picture = FieldPicture::new("stress.xx");
    picture.size = [300, 200];
    let file = folder.join("moving.png");
    let instants = vec![0, 1, 2];
    let animation = Animation {
        instants,
        seconds: 0.1,
    };
    picture.animate(&fields, &animation, &file).unwrap();
    let moving = std::fs::read(&file).unwrap();
    // The first picture of an APNG is that of a PNG: with the range of all times (Pa shown as MPa).
    picture.range = Some([0.0, 2e-6]);
    let one = folder.join("one.png");
    picture.write(&fields, 0, &one).unwrap();
    let one = std::fs::read(one).unwrap();
    let data = |bytes: &[u8]| {
        let start = bytes.windows(4).position(|name| name == b"IDAT").unwrap();
        let length = u32::from_be_bytes(bytes[start - 4..start].try_into().unwrap()) as usize;
        bytes[start..start + length].to_vec()
    };
    assert_eq!(data(&moving), data(&one));
}

/// Few integers have a colour each, with a legend; many of them, reals, and integers with given ends have a scale.
#[test]
fn few_integers_have_a_colour_each() {
    let folder = TestFolder::new("fields-integers");
    let picture = |count: f64, numbers, range| {
        let name = format!("{count} {numbers:?} {range:?}");
        let mesh = bar();
        let writer = VtuWriter::new(&mesh, FieldPrecision::Double).unwrap();
        let file = folder.join(&name).join("snapshots.pvd");
        let elements = 0..mesh.element_count() as u32;
        let values: Vec<f64> = elements
            .map(|e| mesh.centroid(e).x.floor() % count)
            .collect();
        let field = VtuField {
            name: "state",
            components: 1,
            numbers,
            unit: "1",
            values: &values,
        };
        PvdCollection::new(file, writer)
            .add(0.0, &[], &[field])
            .unwrap();
        let mut picture = FieldPicture::new("state");
        picture.size = [300, 200];
        picture.range = range;
        let fields = RecordedFields::at(folder.join(&name)).unwrap();
        drawn(&picture, &fields, folder.join(&name).join("one.png"))
    };
    let (whole, real) = (VtuNumbers::Whole, VtuNumbers::Real);
    assert_ne!(picture(3.0, whole, None), picture(3.0, real, None));
    assert_eq!(picture(10.0, whole, None), picture(10.0, real, None));
    let range = Some([0.0, 2.0]);
    assert_eq!(picture(3.0, whole, range), picture(3.0, real, range));
}

/// Along a line with a corner a linear field is exact, one in elements is that of the element around each point, and points
/// outside are left out and counted.
#[test]
fn values_along_a_line_are_those_of_the_field() {
    let folder = TestFolder::new("fields-line");
    let fields = snapshots(&folder.join("run"), 1, |x, _| {
        Vec3::new(x.z - 2.0 * x.x, 0.0, 0.0)
    });
    let grid = fields.read(0).unwrap();
    let line = FieldLine {
        corners: vec![
            Vec3::new(2.25, 1.0, 1.0),
            Vec3::new(8.25, 1.0, 1.0),
            Vec3::new(8.25, 1.0, 7.0),
        ],
        points: 25,
    };
    let quantities = ["displacement.x", "stress.zz"].map(|name| FieldQuantity(name.into()));
    let found = line.table(&grid, &quantities, fields.file(0)).unwrap();
    let table = found.columns;
    // Points are half a metre apart; the second part leaves the bar at z = 4 m, half way: 3.5 to 6 m up are outside.
    assert_eq!(found.outside, 6);
    assert_eq!(table[0].values.len(), 19);
    // The gap is where the distance between two points is more than that of the line, and nowhere else.
    let distances = table[0].values.windows(2);
    let apart = distances.map(|pair| pair[1] - pair[0] > 0.6);
    let gaps: Vec<usize> = (1..)
        .zip(apart)
        .filter(|(_, gap)| *gap)
        .map(|(row, _)| row)
        .collect();
    assert_eq!(found.gaps, gaps);
    for row in 0..19 {
        let [x, z] = [table[1].values[row], table[3].values[row]];
        assert!((table[4].values[row] - (z - 2.0 * x)).abs() < 1e-12);
        assert_eq!(table[5].values[row], x.floor() + 0.5);
    }
    let point = FieldLine {
        corners: vec![Vec3::repeat(1.0); 2],
        points: 5,
    };
    assert!(matches!(
        point.table(&grid, &quantities, fields.file(0)),
        Err(StudyError::Line { .. })
    ));
}
