//! Accelerations and spectra of blocks that leave their base and land on it.

use powerhouse::engine::observe::HistoryTable;
use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::wavefield::TimeHistory;
use powerhouse::{FileScene, Registry, Remark, Results, Scene};

use super::support::{Folder, run};

/// The upper part of a column of eleven metres, under its weight and a vertical wave that throws it up.
struct Thrown {
    /// Its height (m).
    height: f64,
    pulse: &'static str,
    /// Keys of the joint below it.
    joint: &'static str,
    duration: f64,
}

/// A block that lands.
const LANDING: Thrown = Thrown {
    height: 1.0,
    pulse: "{ kind = \"ricker\", displacement = 0.02, frequency = 4, delay = 0.6 }",
    joint: "law = \"bonded-coulomb\"\nstatic_friction = 0.6",
    duration: 1.6,
};

/// A bar of half the column's height that hits the other half, in which waves travel to and fro meanwhile.
const HITTING: Thrown = Thrown {
    height: 5.0,
    pulse: "{ kind = \"ricker\", displacement = 0.006, frequency = 9, delay = 0.6 }",
    ..LANDING
};

/// A bar under a harmonic wave, which tears its bond and then hits in each of its cycles.
const CRACKED: Thrown = Thrown {
    height: 4.0,
    pulse: "{ kind = \"burst\", displacement = 0.012, frequency = 6, cycles = 5 }",
    joint: "law = \"cohesive\"\ntensile_strength = 5e4\ncohesion = 1e5\nopening_energy = 5\n\
        static_friction = 0.6\ndynamic_friction = 0.6",
    duration: 2.0,
};

/// Results with so many bricks to a metre, a share of the stable step and keys of the output.
fn thrown(of: &Thrown, bricks: usize, safety: f64, keys: &str) -> Results {
    run(thrown_scene(of, bricks, safety, keys))
}

fn thrown_scene(of: &Thrown, bricks: usize, safety: f64, keys: &str) -> Scene {
    let Thrown {
        height,
        pulse,
        joint,
        duration,
    } = of;
    let folder = Folder::new("thrown");
    let (low, high) = (Vec3::new(0.0, 0.0, -11.0), Vec3::new(1.0, 1.0, 0.0));
    let mut mesh = Mesh::box_of_hexes(low, high, [1, 1, 11 * bricks], "all").unwrap();
    let elements = 0..mesh.element_count() as u32;
    let (below, above) = elements.partition(|&element| mesh.centroid(element).z < -height);
    mesh.set_element_set("rock", below).unwrap();
    mesh.set_element_set("block", above).unwrap();
    write_gmsh(folder.join("thrown.msh"), &mesh).unwrap();
    let text = format!(
        r#"
title = "thrown"
mesh = {{ file = "thrown.msh" }}
material = [{{ name = "rock", law = "elastic", young = 9e9, poisson = 0.2, density = 2500 }}]
part = [{{ set = "rock", material = "rock" }}, {{ set = "block", material = "rock" }}]
load = [{{ kind = "gravity", function = {{ kind = "ramp", duration = 0.2 }} }}]
wave = [{{ kind = "p", incidence = 0, pulse = {pulse} }}]
boundary = {{ kind = "viscous-spring", faces = ["bottom"], scatterer = [0.5, 0.5, 0] }}
support = [
    {{ kind = "roller", set = "left" }}, {{ kind = "roller", set = "right" }},
    {{ kind = "roller", set = "front" }}, {{ kind = "roller", set = "back" }},
]
time = {{ duration = {duration}, safety = {safety} }}
[[joint]]
name = "bed"
between = ["rock", "block"]
{joint}
[output]
{keys}
[[output.history]]
name = "top"
node = {}
"#,
        mesh.node_tags()[mesh.node_count() - 1]
    );
    let path = folder.join("thrown.toml");
    let scene = FileScene::from_toml(text, path, &Registry::default()).unwrap();
    scene.into_scene()
}

/// Response spectrum (5 %) of the vertical acceleration at some frequencies (Hz), of samples that are refined or not.
fn spectrum(table: &HistoryTable, refined: usize) -> Vec<f64> {
    let step =
        (table.times[table.times.len() - 1] - table.times[0]) / (table.times.len() - 1) as f64;
    let motion = table.column("top.az").unwrap().values.clone();
    let history = TimeHistory::new(step, motion)
        .unwrap()
        .refined(refined)
        .unwrap();
    let frequencies = [1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 14.0, 20.0, 28.0, 40.0, 50.0];
    let periods = frequencies.map(|frequency: f64| 1.0 / frequency);
    let found = history.response_spectrum(0.05, &periods).unwrap();
    found.iter().map(|response| response.acceleration).collect()
}

fn farthest(one: &[f64], other: &[f64]) -> f64 {
    let pairs = one.iter().zip(other);
    pairs.fold(0.0, |most: f64, (a, b)| most.max((a / b - 1.0).abs()))
}

/// Spectra from 1 to 50 Hz, the greatest acceleration of the band and the sum of the rows of a block that lands do not depend on the
/// interval of the histories, nor on mesh and step by more than 3 %, while instants do: their peak grows with the mesh, and their
/// spectra are wrong by more than a quarter.
#[test]
fn spectra_of_a_landing_are_those_of_every_step() {
    let every = |every: f64| format!("every = {every}");
    let finest = thrown(&LANDING, 10, 0.5, &every(0.01));
    let opened = finest.joint_outcomes[0].peak_opening.0;
    assert!(opened > 1e-3, "{opened}");
    let exact = spectrum(finest.accelerations(), 4);
    let mut instants = Vec::new();
    for (bricks, safety) in [(2, 1.0), (2, 0.45), (5, 1.0)] {
        let found = thrown(&LANDING, bricks, safety, &every(0.01));
        let off = farthest(&spectrum(found.accelerations(), 4), &exact);
        println!("figure landing.spectra_{bricks}_{safety} {off:.4}");
        assert!(off < 0.03, "{bricks} {safety}: {off}");
        instants.push(
            found
                .histories()
                .column("top.az")
                .unwrap()
                .instant_peak()
                .unwrap()
                .0,
        );
        for other in [0.0025, 0.04] {
            let same = thrown(&LANDING, bricks, safety, &every(other));
            assert_eq!(same.accelerations(), found.accelerations(), "{other}");
            // Means add up to the velocity.
            let (times, rows) = (
                &same.histories().times,
                same.histories().column("top.az").unwrap(),
            );
            let count = times.iter().take_while(|time| **time < 1.4).count();
            let sum: f64 = rows.values[1..count].iter().sum::<f64>() * other;
            let first = rows.values[0] * 0.5 * other;
            let velocity = same.histories().column("top.vz").unwrap();
            let end = 0.5 * (velocity.values[count - 1] + velocity.values[count]);
            assert!((sum + first - end).abs() < 0.02, "{other}: {sum} {end}");
        }
    }
    let greatest = |of: f64| instants.iter().map(|a| a.abs()).fold(0.0, f64::max) > of;
    assert!(greatest(2.0 * exact[10]), "{instants:?} {exact:?}");
    let picked = thrown(&LANDING, 2, 1.0, "every = 0.01\nacceleration = \"instant\"");
    assert!(picked.accelerations().times.is_empty());
    let off = farthest(&spectrum(picked.histories(), 1)[..8], &exact[..8]);
    println!("figure landing.spectra_of_instants {off:.4}");
    assert!(off > 0.25, "{off}");
}

/// Spectra from 1 to 50 Hz of a bar that hits and of one that is torn off by a harmonic wave depend on mesh and step by less than 3 %.
#[test]
fn spectra_of_bars_that_hit_converge() {
    for (name, of) in [("hitting", &HITTING), ("cracked", &CRACKED)] {
        let finest = thrown(of, 10, 0.5, "every = 0.01");
        let opened = finest.joint_outcomes[0].peak_opening.0;
        assert!(opened > 1e-3, "{name}: {opened}");
        let exact = spectrum(finest.accelerations(), 4);
        for (bricks, safety) in [(2, 1.0), (2, 0.45), (5, 1.0)] {
            let found = thrown(of, bricks, safety, "every = 0.01");
            let off = farthest(&spectrum(found.accelerations(), 4), &exact);
            println!("figure {name}.spectra_{bricks}_{safety} {off:.4}");
            assert!(off < 0.03, "{name} {bricks} {safety}: {off}");
        }
    }
}

/// Rows that do not show the frequencies of a motion are warned of with what their spectra are worth, by the rule of means and of
/// instants.
#[test]
fn rows_of_a_landing_are_warned_of() {
    for (keys, expected) in [
        ("every = 0.02", "hold up to 100 Hz"),
        ("every = 0.02\nband = 60", "hold up to 60 Hz"),
        (
            "every = 0.02\nacceleration = \"instant\"",
            "wrong by more than a factor of ten",
        ),
    ] {
        let scene = thrown_scene(&LANDING, 2, 1.0, keys);
        let mesh = scene.mesh().clone();
        let warnings = run(scene).warnings(&mesh);
        let mut texts = warnings
            .iter()
            .filter(|w| matches!(w, Remark::Undersampled(_)));
        let text = texts.next().unwrap().to_string();
        assert!(
            text.contains("spectra") && text.contains(expected),
            "{text}"
        );
    }
}
