//! Section forces around a lining.

use powerhouse::io::{TableColumn, read_table, write_gmsh};
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{Error, FileScene, ResultFolder, RunHooks, RunNotes};

use super::support::*;

/// Inner and outer radius (m).
const RADII: [f64; 2] = [4.0, 5.0];
const PRESSURE: f64 = 1.0e6;

const SCENE: &str = r#"
title = "quarter of a ring"
[mesh]
file = "ring.msh"
[[material]]
name = "concrete"
law = "elastic"
young = 30e9
poisson = 0.2
density = 2500
[[part]]
set = "lining"
material = "concrete"
[[support]]
kind = "roller"
set = "front"
[[support]]
kind = "roller"
set = "back"
[[support]]
kind = "roller"
set = "bottom"
[[support]]
kind = "roller"
set = "top"
[[load]]
kind = "pressure"
set = "right"
pressure = 1e6
[[stage]]
name = "pressed"
tolerance = 1e-8
[time]
duration = 1e-3
[output]
every = 1e-4
[[output.ring]]
name = "lining"
set = "lining"
centre = [0, 0.5, 0]
axis = [0, 1, 0]
rays = 16
"#;

/// A quarter of a ring about y: `top` is its end above the centre, `bottom` that beside it, `right` its outer face.
fn quarter() -> Mesh {
    let low = Vec3::new(RADII[0], 0.0, 0.0);
    let high = Vec3::new(RADII[1], 1.0, 1.0);
    let block = Mesh::box_of_hexes(low, high, [6, 1, 48], "lining").unwrap();
    let turned = |at: Vec3| {
        let angle = std::f64::consts::FRAC_PI_2 * at.z;
        Vec3::new(at.x * angle.cos(), at.y, at.x * angle.sin())
    };
    block.map_positions(turned).unwrap()
}

fn column<'t>(table: &'t [TableColumn], name: &str) -> &'t [f64] {
    let found = table.iter().find(|column| column.name == name);
    &found.unwrap_or_else(|| panic!("{name}")).values
}

/// Around a thick ring under pressure from outside the normal force is the pressure times the outer radius, the moment that of the
/// stresses of Lame, the shear force none, in the table as in the sections, which have no plots of their own.
#[test]
fn forces_around_a_ring_under_pressure_are_those_of_lame() {
    let folder = Folder::new("ring-of-lame");
    write_gmsh(folder.join("ring.msh"), &quarter()).unwrap();
    let path = folder.join("ring.toml");
    let bars = "reinforcement = { concrete_strength = 30e6, bars = [2e-3, 2e-3], cover = 0.05, yield_stress = 435e6 }\n";
    std::fs::write(&path, format!("{SCENE}{bars}")).unwrap();
    let simulation = FileScene::from_file(&path).unwrap().prepare().unwrap();
    let announced = powerhouse::result_files(&simulation);
    let notes = RunNotes::new(simulation.remarks().to_vec());
    let mesh = simulation.mesh().clone();
    let results = simulation.run(RunHooks::default()).unwrap();
    let out = ResultFolder::new(folder.join("out"));
    out.write(("ring", &mesh), &results, &notes, None).unwrap();
    let file = |name: &str| folder.join("out").join(name);
    let table = read_table(&file("rings/lining.csv")).unwrap();

    assert_eq!(column(&table, "angle"), [0.0, 22.5, 45.0, 67.5, 90.0]);
    let [a, b] = RADII;
    let axial = -PRESSURE * b;
    // sigma = -p b2/(b2 - a2) (1 + a2/r2), times the distance from the middle towards the centre.
    let whole = -PRESSURE * b * b / (b * b - a * a);
    let middle = 0.5 * (a + b);
    let moment = whole * a * a * (middle * (1.0 / a - 1.0 / b) - (b / a).ln());
    let uses = results.section_uses();
    for (row, &angle) in column(&table, "angle").iter().enumerate() {
        let at = |name: &str| column(&table, name)[row];
        assert!((at("thickness") - (b - a)).abs() < 2e-3, "{angle}");
        for value in ["start", "least", "greatest"] {
            let found = at(&format!("axial_per_metre.{value}"));
            assert!((found / axial - 1.0).abs() < 2e-3, "{angle}: {found}");
            let found = at(&format!("moment_per_metre.{value}"));
            assert!(
                (found / moment - 1.0).abs() < 0.05,
                "{angle}: {found} {moment}"
            );
            let found = at(&format!("shear_per_metre.{value}"));
            // At the ends the load on half of a brick is within the length over which forces are taken.
            let half = 0.5 * std::f64::consts::FRAC_PI_2 * b / 48.0;
            assert!(found.abs() < 1.01 * PRESSURE * half, "{angle}: {found}");
        }
        let name = &results.section_rings[0].sections[row].1;
        let used = uses.iter().find(|of| of.section == *name).unwrap();
        let close = (at("utilisation") - used.utilisation).abs() < 1e-6 * used.utilisation;
        assert!(close, "{angle}");
    }
    let singles = read_table(&file("sections.csv")).unwrap();
    let first = column(&singles, "lining-045.axial_per_metre")[0];
    let of_ring = column(&table, "axial_per_metre.start")[2];
    assert!((first / of_ring - 1.0).abs() < 1e-6);
    assert!(!file("plots/lining-045.svg").exists());
    for name in ["rings/lining.csv", "plots/ring-lining.svg"] {
        assert!(file(name).is_file(), "{name}");
        assert!(announced.iter().any(|known| known == name), "{name}");
    }
    out.clear().unwrap();
    assert!(!file("rings/lining.csv").exists());
}

/// A ring that meets no lining is refused at its key, as are a number of rays out of range and a repeated name.
#[test]
fn rings_that_meet_nothing_are_refused_at_their_key() {
    let folder = Folder::new("ring-refused");
    write_gmsh(folder.join("ring.msh"), &quarter()).unwrap();
    let path = folder.join("ring.toml");
    for (old, new, wanted) in [
        (
            "centre = [0, 0.5, 0]",
            "centre = [600, 0.5, 100]",
            "no ray from its centre",
        ),
        (
            "centre = [0, 0.5, 0]",
            "centre = [4.5, 0.5, 0.5]",
            "its centre lies in element",
        ),
        (
            "centre = [0, 0.5, 0]",
            "centre = [60, 0.5, 2]",
            "its centre is not within the lining",
        ),
        ("rays = 16", "rays = 2", "expected 4 to 360 rays"),
        ("axis = [0, 1, 0]", "axis = [0, 0, 0]", "an axis of zero"),
        (
            "set = \"lining\"\ncentre",
            "set = \"shell\"\ncentre",
            "shell",
        ),
    ] {
        assert!(SCENE.contains(old), "{old}");
        std::fs::write(&path, SCENE.replace(old, new)).unwrap();
        let Err(Error::Scene(fault)) = FileScene::from_file(&path) else {
            panic!("{new} was accepted");
        };
        let text = fault.to_string();
        assert!(text.contains(wanted), "{new}: {text}");
    }
}

/// Bars that do not fit the thickness of a ring's sections are refused at the reinforcement, as are those of a section.
#[test]
fn a_reinforcement_that_does_not_fit_is_refused_at_its_key() {
    let folder = Folder::new("ring-reinforcement");
    write_gmsh(folder.join("ring.msh"), &quarter()).unwrap();
    let path = folder.join("ring.toml");
    let bars = "concrete_strength = 30e6, bars = [2e-3, 2e-3], cover = 0.7, yield_stress = 435e6";
    let section = "[[output.section]]\nname = \"foot-1\"\nset = \"lining\"\nat = [4.5, 0.5, 0.1]\n\
                   normal = [0, 0, 1]\nalong = [0, 1, 0]\n";
    for (of, text) in [
        (
            "lining-000",
            format!("{SCENE}reinforcement = {{ {bars} }}\n"),
        ),
        (
            "foot-1",
            format!("{SCENE}{section}reinforcement = {{ {bars} }}\n"),
        ),
    ] {
        std::fs::write(&path, &text).unwrap();
        let error = FileScene::from_file(&path)
            .unwrap()
            .prepare()
            .err()
            .unwrap();
        let Error::Scene(fault) = error else {
            panic!("{error}");
        };
        let line = text
            .lines()
            .position(|line| line.starts_with("reinforcement"));
        let (line, message) = (line.unwrap() + 1, fault.to_string());
        for wanted in [format!(":{line}:"), of.into(), "cover".into()] {
            assert!(message.contains(&wanted), "{wanted}: {message}");
        }
    }
}
