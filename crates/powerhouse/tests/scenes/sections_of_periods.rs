//! Section forces of bodies that repeat along y: at the ends of a bay, inside of it, and everywhere in a slice.

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{FileScene, Registry, Remark, RunHooks};
use powerhouse_observe::HistoryTable;

use super::support::Folder;

/// Ground with a tube of concrete, under its weight and an SV wave.
const SCENE: &str = r#"
title = "bay"
mesh = { file = "bay.msh" }
support = [{ kind = "delayed", from = "front", to = "back" }]
[[material]]
name = "granite"
law = "elastic"
young = 9.0e9
poisson = 0.27
density = 2750
[[material]]
name = "concrete"
law = "elastic"
young = 25e9
poisson = 0.2
density = 2500
[[part]]
set = "rock"
material = "granite"
kernel = "hex8-full"
[[part]]
set = "core"
material = "concrete"
kernel = "hex8-full"
[[load]]
kind = "gravity"
[[stage]]
name = "ground"
support = [{ kind = "fixed", set = "bottom" }, { kind = "roller", set = "left" }, { kind = "roller", set = "right" }]
[[wave]]
kind = "sv"
incidence = 12
azimuth = 60
reference = [-60, Y, -100]
pulse = { kind = "smooth", displacement = 0.01, duration = 0.2 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "bottom"]
scatterer = [0, 0, -50]
spreading = "cylindrical"
[time]
duration = 0.25
step = 2.5e-4
[output]
every = 0.01
"#;

/// Length of a period (m), which begins at y = -2 m.
const PERIOD: f64 = 4.0;

/// Periods of three layers of elements of 0.8, 2.2 and 1 m, or of one, with a tube that bulges at x > 0 in the second layer of three.
fn mesh(periods: usize, layers: usize) -> Mesh {
    let low = Vec3::new(-60.0, -2.0, -100.0);
    let high = Vec3::new(60.0, -2.0 + PERIOD * periods as f64, 0.0);
    let ground = Mesh::box_of_hexes(low, high, [12, periods * layers, 10], "rock").unwrap();
    let ends = [0.0, 0.8, 3.0, PERIOD];
    let mut mesh = ground
        .map_positions(|p| {
            let layer = (p.y + 2.0) / PERIOD * layers as f64;
            let whole = (layer + 1e-9).floor() as usize;
            let y = match layers {
                1 => p.y,
                _ => -2.0 + PERIOD * (whole / 3) as f64 + ends[whole % 3],
            };
            Vec3::new(p.x, y, p.z)
        })
        .unwrap();
    let is_tube = |at: Vec3| {
        let (x, z) = (at.x.abs(), (at.z + 50.0).abs());
        let along = (at.y + 2.0).rem_euclid(PERIOD);
        let bulges =
            layers == 3 && at.x > 0.0 && at.x < 30.0 && z < 10.0 && (along - 1.9).abs() < 0.1;
        (x < 20.0 && z < 20.0 && (x > 10.0 || z > 10.0)) || bulges
    };
    let all = 0..mesh.element_count() as u32;
    let (core, rest): (Vec<u32>, Vec<u32>) = all.partition(|e| is_tube(mesh.centroid(*e)));
    mesh.set_element_set("core", core).unwrap();
    mesh.set_element_set("rock", rest).unwrap();
    mesh
}

fn scene(mesh: &Mesh, text: &str) -> FileScene {
    let folder = Folder::new("sections-of-periods");
    write_gmsh(folder.join("bay.msh"), mesh).unwrap();
    let (low, high) = mesh.bounding_box();
    let text = text.replacen("Y", &format!("{}", 0.5 * (low.y + high.y)), 1);
    FileScene::from_toml(text, folder.join("bay.toml"), &Registry::default()).unwrap()
}

fn section(name: &str, y: f64) -> String {
    format!(
        "[[output.section]]\nname = \"{name}\"\nset = \"core\"\nat = [0, {y}, -50]\nnormal = [0, 1, 0]\nalong = [1, 0, 0]\n"
    )
}

/// The table of sections normal to y at some places, by their numbers.
fn sections(mesh: &Mesh, text: &str, places: &[f64]) -> HistoryTable {
    let mut text = text.to_owned();
    for (number, y) in places.iter().enumerate() {
        text += &section(&number.to_string(), *y);
    }
    let simulation = scene(mesh, &text).into_scene().prepare().unwrap();
    let results = simulation.run(RunHooks::default()).unwrap();
    results.sections().clone()
}

/// Largest difference of a column of sections of two tables, over its largest value.
fn difference(
    (one, own): (&HistoryTable, usize),
    (other, its): (&HistoryTable, usize),
    column: &str,
) -> f64 {
    let values = |table: &HistoryTable, number: usize| {
        let column = table.column(&format!("{number}.{column}")).unwrap();
        column.values.clone()
    };
    let (found, expected) = (values(one, own), values(other, its));
    assert!(found.len() > 20 && found.len() == expected.len());
    let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!(largest > 1e4, "{column}: {largest:e}");
    let apart = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
    apart.fold(0.0, f64::max) / largest
}

/// Sections at both ends of a bay, beside them and inside are those of a bay of two periods at the same places, in its middle and a period
/// later, under weight and waves along the row; with periodic ends under waves across it, too.
#[test]
fn a_bay_shows_the_sections_of_two() {
    let places = [-2.0, -1.9, -1.2, -0.1, 1.6, 2.0];
    let doubled: Vec<f64> = places.iter().flat_map(|y| [*y, y + PERIOD]).collect();
    let periodic =
        SCENE
            .replacen("\"delayed\"", "\"periodic\"", 1)
            .replacen("azimuth = 60", "azimuth = 0", 1);
    for (text, limit) in [(SCENE, 1e-6), (&periodic, 1e-9)] {
        let one = sections(&mesh(1, 3), text, &places);
        let two = sections(&mesh(2, 3), text, &doubled);
        for number in 0..places.len() {
            for column in ["axial", "moment_across"] {
                for its in [2 * number, 2 * number + 1] {
                    let error = difference((&one, number), (&two, its), column);
                    println!("{column} at y = {}: {error:.2e}", doubled[its]);
                    assert!(error < limit, "{column} at y = {}: {error:e}", doubled[its]);
                }
            }
        }
        // The ends are one place, and another one has other forces.
        assert!(difference((&one, 0), (&one, 5), "moment_across") < 1e-9);
        let inside = difference((&one, 0), (&one, 3), "moment_across");
        assert!(inside > 0.01, "{inside}");
    }
}

/// A slice shows the section of its middle at every y of it.
#[test]
fn a_slice_shows_the_section_of_its_middle() {
    let table = sections(&mesh(1, 1), SCENE, &[0.0, -2.0, -1.1, 0.8, 2.0]);
    for number in 1..5 {
        for column in ["axial", "moment_across", "moment_along", "torsion"] {
            let error = difference((&table, number), (&table, 0), column);
            assert!(error < 1e-9, "{column} {number}: {error:e}");
        }
    }
}

/// A relative displacement between places at different y of a bay comes with a warning that has the time between them, one between places at
/// one y without; that of a slice, whose sides have the motion there and then, without.
#[test]
fn a_relative_displacement_along_a_bay_is_warned_of() {
    let relative = |name: &str, y: [f64; 2]| {
        format!(
            "[[output.relative]]\nname = \"{name}\"\nat = [0, {}, 0]\nfrom = [10, {}, -100]\n",
            y[0], y[1]
        )
    };
    let found = |mesh: &Mesh, azimuth: f64| {
        let text = SCENE.replacen("azimuth = 60", &format!("azimuth = {azimuth}"), 1)
            + &relative("along", [-1.0, 2.0])
            + &relative("across", [0.5, 0.5]);
        let simulation = scene(mesh, &text).into_scene().prepare().unwrap();
        let found = simulation
            .remarks()
            .iter()
            .filter_map(|remark| match remark {
                Remark::RelativeInBay(of) => {
                    Some((of.name.clone(), of.apart, of.delay, remark.to_string()))
                }
                _ => None,
            });
        found.collect::<Vec<_>>()
    };
    let speed = (9.0e9_f64 / (2.0 * 1.27 * 2750.0)).sqrt();
    for azimuth in [60.0_f64, -90.0] {
        let slowness = 12f64.to_radians().sin() * azimuth.to_radians().sin() / speed;
        let [(name, apart, delay, text)] = &found(&mesh(1, 3), azimuth)[..] else {
            panic!("{azimuth}");
        };
        assert_eq!((name.as_str(), *apart), ("along", -3.0));
        assert!((delay + 3.0 * slowness).abs() < 1e-9 * slowness.abs());
        let shifted = if azimuth > 0.0 {
            "shifted later"
        } else {
            "shifted earlier"
        };
        let of = format!("{:.3} ms apart", 3e3 * slowness.abs());
        assert!(text.contains(shifted) && text.contains(&of), "{text}");
    }
    assert!(found(&mesh(1, 3), 0.0).is_empty());
    assert!(found(&mesh(1, 1), 60.0).is_empty());
}
