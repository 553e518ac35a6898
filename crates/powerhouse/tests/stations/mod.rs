//! Motions at stations from a file: the field that they are, runs that they drive, and what is refused.

#[cfg(feature = "h5drm")]
mod h5drm;
mod refused;
mod support;

use powerhouse::Remark;
use powerhouse::model::{FieldMotion, IncidentField, Vec3};

use support::*;

/// A field between samples and at them, at all stations, over its peak, against the wave from which it was sampled.
fn differences(field: &dyn IncidentField, factor: f64) -> [f64; 2] {
    let points = field.stations().unwrap().to_vec();
    let (found, exact) = (
        field.prepare(&points).unwrap(),
        wave(factor).prepare(&points).unwrap(),
    );
    let (mut differences, mut peak) = ([0.0_f64; 2], 0.0_f64);
    for tenth in 0..10 * (SAMPLES - 1) {
        let time = 0.1 * STEP * tenth as f64;
        let mut motions = [(); 2].map(|()| vec![FieldMotion::default(); points.len()]);
        found.add_motion(time, &mut motions[0]);
        exact.add_motion(time, &mut motions[1]);
        let between = usize::from(tenth % 10 != 0);
        for (found, exact) in motions[0].iter().zip(&motions[1]) {
            let off = (found.displacement - exact.displacement).norm();
            differences[between] = differences[between].max(off);
            peak = peak.max(exact.displacement.norm());
        }
    }
    differences.map(|difference| difference / peak)
}

/// Motions of a table are those of its wave: at the samples to the digits of the table, between them by the interpolation.
#[test]
fn a_table_of_a_wave_is_the_wave_at_its_samples_and_nearly_between_them() {
    let site = Site::new("field");
    site.write_table("wave.csv", |_, _, _| {});
    for (keys, limit) in [("", 1e-4), (", interpolation = \"linear\"", 1e-2)] {
        let scene = site.read(&format!("file = \"wave.csv\"{keys}")).unwrap();
        let [at, between] = differences(&**scene.field().unwrap(), FACTOR);
        println!("at samples {at:.1e}, between {between:.1e}");
        assert!(at < 1e-10 && between < limit, "{at} {between}");
    }
}

/// A run that a table drives is the run that its wave drives through the same layer.
#[test]
fn a_run_by_a_table_is_the_run_by_its_wave() {
    let site = Site::new("run");
    site.write_table("wave.csv", |_, _, _| {});
    site.compare_runs(
        &[
            "file = \"wave.csv\"",
            "file = \"wave.csv\", interpolation = \"linear\"",
        ],
        1.0,
    );
}

/// Coordinates and rows in other axes, from another origin, in km, and with a factor, give the same field.
#[test]
fn axes_rows_scale_origin_and_factor_are_those_of_the_scene() {
    let site = Site::new("axes");
    site.write_table("wave.csv", |_, _, _| {});
    // North, east, down from (10, 20, -3) m in km; motions down, east, north in twice their size.
    site.write_table("turned.csv", |_, place, motion| {
        let at = *place - Vec3::new(10.0, 20.0, -3.0);
        *place = Vec3::new(at.y, at.x, -at.z) * 1e-3;
        for vector in motion.chunks_mut(3) {
            let [x, y, z] = [vector[0], vector[1], vector[2]].map(|u| 2.0 * u);
            vector.copy_from_slice(&[-z, x, y]);
        }
    });
    let keys = "file = \"turned.csv\", scale = 1000, axes = [\"y\", \"x\", \"-z\"], origin = [10, 20, -3], rows = [\"-z\", \"x\", \"y\"], factor = 0.5, tolerance = 0.01";
    let (plain, turned) = (
        site.read("file = \"wave.csv\"").unwrap(),
        site.read(keys).unwrap(),
    );
    let (plain, turned) = (plain.field().unwrap(), turned.field().unwrap());
    let points = plain.stations().unwrap();
    let mut motions = [plain, turned].map(|field| {
        let mut motion = vec![FieldMotion::default(); points.len()];
        field
            .prepare(points)
            .unwrap()
            .add_motion(1.234, &mut motion);
        motion
    });
    let turned = motions[1].drain(..).collect::<Vec<_>>();
    let peak = motions[0]
        .iter()
        .map(|m| m.displacement.norm())
        .fold(0.0, f64::max);
    assert!(peak > 1e-3);
    for (plain, turned) in motions[0].iter().zip(&turned) {
        assert!((plain.displacement - turned.displacement).norm() < 1e-12 * peak);
        assert!((plain.velocity - turned.velocity).norm() < 1e-9 * peak);
    }
}

/// A run that goes on after the motions says what is held, and what was taken from the file is reported.
#[test]
fn what_is_taken_and_what_is_held_is_reported() {
    let site = Site::new("window");
    site.write_table("wave.csv", |_, _, _| {});
    let remarks = |duration: f64| {
        let scene = site.read_for("file = \"wave.csv\"", duration).unwrap();
        let remarks = scene.prepare().unwrap().remarks().to_vec();
        let of =
            |remark: &&Remark| matches!(remark, Remark::Stations(_) | Remark::StationWindow(_));
        remarks
            .iter()
            .filter(of)
            .map(|r| (r.is_warning(), r.to_string()))
            .collect::<Vec<_>>()
    };
    let told = remarks(2.5);
    assert_eq!(told.len(), 1);
    let (is_warning, text) = &told[0];
    for part in [
        "156 stations of 'wave.csv'",
        "along x, y, z times 1 m",
        "300 samples",
        "a cubic through",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!is_warning);
    let told = remarks(3.5);
    assert!(
        told[1].0
            && told[1]
                .1
                .contains("the displacements of the last sample are held"),
        "{told:?}"
    );
}
