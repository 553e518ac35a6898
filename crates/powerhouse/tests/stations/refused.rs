//! Files and scenes that are refused, by name and before the run.

use powerhouse::boundary::ViscousSpring;
use powerhouse::{Boundary, Error, RenderFault as _, Scene};

use super::support::*;

/// Text of the error of reading or preparing a scene, at a key of its file.
fn fault(scene: Result<Scene, Error>, wanted: &str) -> String {
    match scene.and_then(Scene::prepare) {
        Ok(_) => panic!("{wanted}: not refused"),
        Err(Error::Scene(fault)) => fault.render(false),
        Err(error) => panic!("{wanted}: not at its place: {error}"),
    }
}

fn refused(scene: Result<Scene, Error>, wanted: &[&str]) {
    let text = fault(scene, wanted[0]);
    for part in wanted {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(text.contains("stations = "), "{text}");
}

/// A file without one of the nodes of the layer names the node, the nearest station and the distance.
#[test]
fn a_node_without_a_station_is_named() {
    let site = Site::new("short");
    let mut table = Table::of(&site);
    let missing = table.station_at([10.0, 2.5, -10.0]);
    table.places.remove(missing);
    table.inner.remove(missing);
    table
        .motion
        .drain(6 * SAMPLES * missing..6 * SAMPLES * (missing + 1));
    table.write(&site.folder.join("short.csv"));
    refused(
        site.read("file = \"short.csv\""),
        &[
            "1 of 156 nodes have no station within 0.001 m",
            "(10.0000, 2.5000, -10.0000) m is 5.0000 m from",
        ],
    );
}

/// A station on the wrong side of the layer is named.
#[test]
fn a_wrong_flag_is_named() {
    let site = Site::new("flags");
    let mut table = Table::of(&site);
    let changed = table.station_at([15.0, 2.5, -10.0]);
    table.inner[changed] = true;
    table.write(&site.folder.join("flags.csv"));
    let wanted = [
        "the node at (15.0000, 2.5000, -10.0000) m is on the outer side of the layer, its station on the inner side (1 such nodes)",
    ];
    refused(site.read("file = \"flags.csv\""), &wanted);
}

/// Wrong units, axes and sampling are named.
#[test]
fn wrong_units_are_named() {
    let site = Site::new("units");
    site.write_table("wave.csv", |_, _, _| {});
    let file = "file = \"wave.csv\"";
    refused(
        site.read(&format!("{file}, scale = 1000")),
        &[
            "156 of 156 nodes",
            "30000.0000 x 25000.0000 x 15000.0000 m",
            "in km taken as m",
        ],
    );
    refused(
        site.read(&format!("{file}, axes = [\"y\", \"x\", \"z\"]")),
        &["nodes have no station within 0.001 m"],
    );
    refused(
        site.read(&format!("{file}, axes = [\"y\", \"-y\", \"z\"]")),
        &["one direction along each of x, y and z"],
    );
    refused(
        site.read(&format!("{file}, factor = 100")),
        &["peak acceleration of the stations = ", "cm/s2"],
    );
    // Velocities in another unit, or of other components.
    site.write_table("cm.csv", |_, _, motion| {
        motion[3..].iter_mut().for_each(|v| *v *= 100.0)
    });
    refused(
        site.read("file = \"cm.csv\""),
        &["is not that of its displacement"],
    );
    site.write_table("swapped.csv", |_, _, motion| motion.swap(3, 4));
    refused(
        site.read("file = \"swapped.csv\""),
        &["their components in one order"],
    );
    assert!(
        site.read("file = \"swapped.csv\", interpolation = \"linear\"")
            .is_ok()
    );
}

/// Stations need a region, are the only field, and their file must be there.
#[test]
fn scenes_that_do_not_fit_are_refused() {
    let site = Site::new("scenes");
    site.write_table("wave.csv", |_, _, _| {});
    let changed =
        |change: &dyn Fn(String) -> String| site.read_changed("file = \"wave.csv\"", 2.5, change);
    let without = |text: String| {
        text.lines()
            .filter(|line| !line.starts_with("region"))
            .map(|line| format!("{line}\n"))
            .collect()
    };
    refused(
        changed(&without),
        &["the key 'region' is missing", "have no stress"],
    );
    let beside = |text: String| {
        format!(
            "{text}[[wave]]\nkind = \"p\"\nincidence = 0\npulse = {{ kind = \"smooth\", displacement = 0.001, duration = 0.3 }}\n"
        )
    };
    refused(changed(&beside), &["stations beside a [[wave]]"]);
    let smaller = |text: String| text.replace("[10, 7.5, 0]] }", "[5, 7.5, 0]] }");
    refused(changed(&smaller), &["nodes have no station"]);
    let text = fault(
        changed(&|text| text.replace("duration = ", "start = 1.2\nduration = ")),
        "start",
    );
    assert!(text.contains("of its peak then"), "{text}");
    refused(site.read("file = \"none.csv\""), &["none.csv"]);
    #[cfg(not(feature = "h5drm"))]
    refused(
        site.read("file = \"none.h5drm\""),
        &["compile it with `--features h5drm`"],
    );
}

/// A field without stress is refused by boundaries that it would enter through, from Rust too.
#[test]
fn springs_and_dashpots_refuse_a_field_without_stress() {
    let site = Site::new("stress");
    site.write_table("wave.csv", |_, _, _| {});
    let scene = site.read("file = \"wave.csv\"").unwrap();
    let faces = ["left", "right", "front", "back", "bottom"];
    let scene = scene.with_boundary(Boundary::new(ViscousSpring::default(), faces));
    let error = scene.prepare().err().unwrap().to_string();
    assert!(
        error.contains("'wave.csv' has motions and no stress"),
        "{error}"
    );
}
