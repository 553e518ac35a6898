//! H5DRM files of a layered site, whose motions were computed by another program.

use super::differences;
use super::support::*;
use powerhouse::RenderFault as _;

fn path(name: &str) -> String {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/motions");
    format!("file = \"{data}/{name}\", factor = {FACTOR}")
}

fn sample() -> String {
    path("two_layer_sv15.h5drm")
}

/// File of another writer: rows of vertical, east, north, no velocities.
fn other_writer() -> String {
    format!(
        "{}, rows = [\"-z\", \"x\", \"y\"]",
        path("two_layer_sv15_other_writer.h5drm")
    )
}

/// Motions of files are those of the wave at all stations.
#[test]
fn motions_of_files_are_those_of_the_wave() {
    let site = Site::new("h5drm-field");
    let linear = format!("{}, interpolation = \"linear\"", sample());
    for (keys, limit) in [(sample(), 1e-4), (linear, 1e-2), (other_writer(), 1e-2)] {
        let scene = site.read(&keys).unwrap();
        let [at, between] = differences(&**scene.field().unwrap(), FACTOR);
        println!("{keys}: at samples {at:.1e}, between {between:.1e}");
        assert!(at < 1e-5 && between < limit, "{at} {between}");
    }
}

/// Runs that files drive are the run that the wave drives through the same layer.
#[test]
fn runs_by_files_are_the_run_by_the_wave() {
    Site::new("h5drm-run").compare_runs(&[&sample(), &other_writer()], 1.0);
}

/// Rows in another order than those of the control point are refused with the key that says what they are.
#[test]
fn rows_in_another_order_are_refused() {
    let site = Site::new("h5drm-rows");
    let error = site
        .read(&path("two_layer_sv15_other_writer.h5drm"))
        .err()
        .unwrap();
    let powerhouse::Error::Scene(fault) = error else {
        panic!("not at its place: {error}")
    };
    let text = fault.render(false);
    for part in [
        "rows 1, 2, 3 are their rows 2, 3, 1",
        "rows = [\"-z\", \"x\", \"y\"]",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}
