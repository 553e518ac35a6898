//! Cracks in bricks of any shape, and stiffness-proportional damping beside them.

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{Error, FileScene, Registry, Remark, Results, Scene, remark};

use super::support::{Folder, run};

/// One brick of the paper's concrete on a support of a kind, stretched along z by 2 mm in a time (s).
fn pulled(height: f64, (base, duration): (&str, f64), keys: &str) -> Result<Scene, Error> {
    let folder = Folder::new("crack-band");
    let high = Vec3::new(1.0, 1.0, height);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), high, [1, 1, 1], "bar").unwrap();
    write_gmsh(folder.join("bar.msh"), &mesh).unwrap();
    let text = format!(
        r#"
title = "bar"
energy_residual = 1e-9
[mesh]
file = "bar.msh"
[[material]]
name = "concrete"
law = "plastic-damage"
preset = "paper-c25"
[[part]]
set = "bar"
material = "concrete"
{keys}
[[support]]
kind = "{base}"
set = "bottom"
[[support]]
kind = "prescribed"
set = "top"
direction = [0, 0, 1]
displacement = 2e-3
function = {{ kind = "ramp", duration = {duration} }}
[time]
duration = {duration}
[output]
every = 1e-3
energies = 1e-3
[[output.history]]
name = "p"
at = [0.5, 0.5, 0.1]
quantities = ["stress", "state"]
"#
    );
    FileScene::from_toml(text, folder.join("bar.toml"), &Registry::default())
        .map(FileScene::into_scene)
}

const FULL: &str = "kernel = \"hex8-full\"";
const DAMPED: &str = "damping = { kind = \"rayleigh\", ratio = 0.05, frequencies = [1, 10] }";

fn column<'a>(results: &'a Results, name: &str) -> &'a [f64] {
    &results.energies().column(name).unwrap().values
}

fn last(results: &Results, name: &str) -> f64 {
    *column(results, name).last().unwrap()
}

/// Damping that removes the oscillations of a crack with a negligible force in the loading.
const CALM: &str = "damping = { kind = \"rayleigh\", ratio = 0.2, frequencies = [100, 1000] }";

/// Energy dissipated by plasticity and damage, minus the recovered energy (J).
fn fracture(results: &Results) -> f64 {
    ["plastic", "damage", "recovery"]
        .map(|name| last(results, name))
        .iter()
        .sum()
}

/// A brick of concrete that is cracked by 2 mm dissipates its fracture energy within 2 %, for aspect ratios of 1, 4 and
/// 1/4, with eight points or one, free across the loading; results contain the crack band width.
#[test]
fn bricks_of_any_length_take_their_fracture_energy() {
    for height in [1.0, 4.0, 0.25] {
        for kernel in [FULL, ""] {
            let results =
                run(pulled(height, ("roller", 0.4), &format!("{kernel}\n{CALM}")).unwrap());
            let ratio = fracture(&results) / 133.0;
            assert!(
                (0.98..1.02).contains(&ratio),
                "{height} m {kernel}: {ratio}"
            );
            let width = results.histories().column("p.crack_band_width").unwrap();
            let width = width.values.last().unwrap();
            assert!((width / height - 1.0).abs() < 1e-6, "{width} of {height}");
        }
    }
}

/// A brick with snap-back along its longest extent is an error.
#[test]
fn snap_back_is_looked_for_along_the_longest_extent() {
    let told = pulled(8.0, ("roller", 0.4), FULL)
        .unwrap()
        .prepare()
        .err()
        .unwrap();
    let told = told.to_string();
    for passage in ["8.0000 m wide along its greatest extent", "snaps back"] {
        assert!(told.contains(passage), "{told}");
    }
}

/// Stiffness-proportional damping of a cracking brick decreases with its stiffness: finally its stress and that of the
/// law are below a hundredth of the strength, it dissipates much less than fracture, the energy balance closes, and a
/// warning states which outputs do not contain its stress.
#[test]
fn stiffness_damping_fades_with_the_stiffness() {
    for (duration, most) in [(0.04, 2.7), (0.4, 0.3)] {
        for kernel in [FULL, ""] {
            let scene = pulled(1.0, ("fixed", duration), &format!("{kernel}\n{DAMPED}")).unwrap();
            let simulation = scene.prepare().unwrap();
            let warned = simulation.remarks().iter().any(|remark| {
                matches!(remark, Remark::DampedHistory(remark::DampedHistory { set, law }) if set == "bar" && law == "plastic-damage")
                    && remark.is_warning()
            });
            assert!(warned);
            let results = simulation.run(Default::default()).unwrap();
            let share = last(&results, "stiffness damping") / fracture(&results);
            assert!(share > 0.0 && share <= most, "{duration} s: {share}");
            // Energy of the loading at the sides.
            let work = column(&results, "prescribed motion");
            let times = &results.energies().times;
            let last = times.iter().rposition(|time| *time < duration).unwrap();
            let time = times[last] - times[last - 1];
            let carried = (work[last] - work[last - 1]) / (2.0e-3 / duration * time);
            let strength = 1.006e6;
            assert!(
                (carried / strength).abs() <= 0.01,
                "{duration} s: {carried}"
            );
        }
    }
}
