//! Effect of the hourglass resistance of one-point bricks on results, and its report.

use powerhouse::engine::HourglassShare;
use powerhouse::io::write_gmsh;
use powerhouse::model::{FieldMotion, Mesh, Vec3};
use powerhouse::{FileScene, Registry, Remark, Results, Scene, Topic, remark};

use super::support::{Folder, run};

fn scene(mesh: &Mesh, text: String) -> Scene {
    let folder = Folder::new("hourglass");
    write_gmsh(folder.join("body.msh"), mesh).unwrap();
    let path = folder.join("body.toml");
    FileScene::from_toml(text, path, &Registry::default())
        .unwrap()
        .into_scene()
}

/// Shares of hourglass work in the warnings of a run, by set.
fn warned(results: &Results, mesh: &Mesh) -> Vec<(Option<String>, String, f64)> {
    let warnings = results.warnings(mesh).into_iter();
    let found = warnings.filter_map(|warning| match warning {
        Remark::Hourglass(remark::Hourglass { stage, set, share }) => Some((stage, set, share)),
        _ => None,
    });
    found.collect()
}

/// A strip one element thick, held at its left end under a pressure of 1e4 Pa on its top, with the stress in the middle of
/// its top.
fn strip(kernel: &str) -> (Results, Mesh) {
    let high = Vec3::new(8.0, 1.0, 1.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), high, [8, 1, 1], "strip").unwrap();
    let text = format!(
        r#"
title = "strip"
[mesh]
file = "body.msh"
[[material]]
name = "rock"
law = "elastic"
young = 9e9
poisson = 0.2
density = 2700
[[part]]
set = "strip"
material = "rock"
kernel = "{kernel}"
[[support]]
kind = "fixed"
set = "left"
[[load]]
kind = "pressure"
set = "top"
pressure = 1e4
[[stage]]
name = "bending"
[time]
duration = 0.02
[[output.history]]
name = "top"
at = [4.5, 0.5, 1]
stress_at_point = true
quantities = ["stress"]
[[output.history]]
name = "mean"
at = [4.5, 0.5, 1]
quantities = ["stress"]
"#
    );
    (run(scene(&mesh, text)), mesh)
}

/// The bending stiffness of a strip one element thick is that of its hourglass resistance, which is reported for the
/// stage and for the run; full integration has none, and that of the material in bending is no resistance.
#[test]
fn hourglass_work_above_its_limit_is_reported() {
    for (kernel, expected) in [
        ("hex8-one-point", true),
        ("hex8-full", false),
        ("hex8-natural", false),
    ] {
        let (results, mesh) = strip(kernel);
        let warnings = results.warnings(&mesh);
        let of_energy = warnings.iter().filter(|w| w.topic() == Topic::Energy);
        assert_eq!(of_energy.count(), if expected { 2 } else { 0 });
        let found = warned(&results, &mesh);
        assert_eq!(found.len(), if expected { 2 } else { 0 }, "{found:?}");
        for (_, set, share) in &found {
            assert!(set == "strip" && *share > 0.02, "{set} {share}");
        }
        if expected {
            assert_eq!(found[0].0.as_deref(), Some("bending"));
            assert!(found[1].0.is_none());
        }
    }
}

/// In a strip of bricks that bend as their material the energy is that of bending, and the stress at the surface is that of
/// the moment of the loads, which the mean over the element is not.
#[test]
fn the_stress_at_a_surface_has_the_moment_of_the_loads() {
    let (results, _) = strip("hex8-natural");
    let last = |name: &str| -> f64 {
        let table = results.energies();
        *table.column(name).unwrap().values.last().unwrap()
    };
    assert!(last("bending") > 10.0 * last("elastic") && last("hourglass") == 0.0);
    // Loads of the nodes at 5, 6, 7 and 8 m about 4.5 m, over a sixth of the section.
    let moment = 1e4 * (0.5 + 1.5 + 2.5 + 0.5 * 3.5);
    let column = |name: &str| results.histories().column(name).unwrap().values[0];
    let (found, mean) = (column("top.xx"), column("mean.xx"));
    assert!(
        (found / (6.0 * moment) - 1.0).abs() < 1e-4,
        "{found} {moment}"
    );
    assert!(mean.abs() < 1e-2 * found, "{mean}");
}

/// An SV wave at 60 degrees in ground of Poisson's ratio 0.49, in a slice of 600 m by 300 m with elements of 10
/// m: three points of the surface follow the closed form to 0.06 (0.215 with the resistance of the whole of
/// lambda + 2 G).
#[test]
fn shear_waves_in_nearly_incompressible_ground_follow_the_closed_form() {
    let error = surface_error("hex8-one-point", 0.49);
    assert!(error <= 0.06, "{error}");
}

/// With bricks that bend as their material the error at Poisson's ratio 0.49 is at most 1.3 times that at 0.27, which is that of
/// the faces and of ten elements in a wavelength.
#[test]
fn natural_bricks_do_not_lock_in_nearly_incompressible_ground() {
    let [usual, high] = [0.27, 0.49].map(|poisson| surface_error("hex8-natural", poisson));
    assert!(high <= 1.3 * usual && usual < 0.08, "{usual} {high}");
}

/// Error of three points of the surface against the closed form, for a kernel and a Poisson's ratio.
fn surface_error(kernel: &str, poisson: f64) -> f64 {
    let (low, high) = (Vec3::new(0.0, 0.0, -300.0), Vec3::new(600.0, 10.0, 0.0));
    let mesh = Mesh::box_of_hexes(low, high, [60, 1, 30], "rock").unwrap();
    let shear = 2750.0 * 1150.0_f64.powi(2);
    let text = format!(
        r#"
title = "slice"
[mesh]
file = "body.msh"
[[material]]
name = "rock"
law = "elastic"
young = {young}
poisson = {poisson}
density = 2750
[[part]]
set = "rock"
material = "rock"
kernel = "{kernel}"
[[support]]
kind = "roller"
set = "front"
[[support]]
kind = "roller"
set = "back"
[[wave]]
kind = "sv"
incidence = 60
azimuth = 0
pulse = {{ kind = "ricker", displacement = 0.01, frequency = 5 }}
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "bottom"]
scatterer = [300, 5, 0]
[time]
duration = 1.6
[output]
every = 2e-3
[[output.history]]
name = "a"
at = [150, 0, 0]
[[output.history]]
name = "b"
at = [300, 0, 0]
[[output.history]]
name = "c"
at = [450, 0, 0]
"#,
        young = 2.0 * (1.0 + poisson) * shear
    );
    let scene = scene(&mesh, text);
    let field = scene.field().unwrap().clone();
    let results = run(scene);
    let points = [150.0, 300.0, 450.0].map(|x| Vec3::new(x, 0.0, 0.0));
    let sampler = field.prepare(&points).unwrap();
    let (mut error, mut size) = (0.0, 0.0);
    let columns = ["a.ux", "b.ux", "c.ux", "a.uz", "b.uz", "c.uz"];
    let columns = columns.map(|name| &results.histories().column(name).unwrap().values);
    for (row, time) in results.histories().times.iter().enumerate() {
        let mut motion = [FieldMotion::default(); 3];
        sampler.add_motion(*time, &mut motion);
        for (point, motion) in motion.iter().enumerate() {
            let exact = [motion.displacement.x, motion.displacement.z];
            for (component, exact) in exact.iter().enumerate() {
                error += (columns[3 * component + point][row] - exact).powi(2);
                size += exact.powi(2);
            }
        }
    }
    (error / size).sqrt()
}

/// The wall of a hole in rock of Mohr and Coulomb with associated flow, 30 MPa far off and none inside, on a
/// quarter of a ring of 60 x 24 one-point bricks to 20 radii by dynamic relaxation, closes as Salencon's closed
/// form says to 6 %, or the share of hourglass work is reported: it keeps the wall back.
#[test]
#[ignore = "a minute: cargo test --test powerhouse a_hole_in_associated_rock -- --ignored"]
fn a_hole_in_associated_rock_is_warned_of() {
    let (error, is_warned) = hole("hex8-one-point", 15);
    assert!(error.abs() <= 0.06 || is_warned, "{error}");
}

/// The same on a sector of three of the bricks, which by symmetry is the ring.
#[test]
fn a_sector_of_a_hole_is_warned_of() {
    let (error, is_warned) = hole("hex8-one-point", 3);
    assert!(error.abs() <= 0.06 || is_warned, "{error}");
}

/// With bricks that bend as their material, and flow with it, the wall closes to 3 %.
#[test]
fn a_hole_in_associated_rock_closes_with_natural_bricks() {
    let (error, is_warned) = hole("hex8-natural", 3);
    assert!(error.abs() <= 0.03 && !is_warned, "{error}");
}

/// Error of the closure of the wall, and whether of hourglass resistance is warned, with so many bricks of a kernel around
/// the hole, of six degrees each.
fn hole(kernel: &str, around: usize) -> (f64, bool) {
    let high = Vec3::new(1.0, 1.0, 0.1);
    let unit = Mesh::box_of_hexes(Vec3::zeros(), high, [24, around, 1], "rock").unwrap();
    let whole = (6.0 * around as f64).to_radians();
    let mesh = unit.map_positions(|x| {
        let (radius, angle) = (20.0_f64.powf(x.x), x.y * whole);
        Vec3::new(radius * angle.cos(), radius * angle.sin(), x.z)
    });
    let mesh = mesh.unwrap();
    let rollers: String = ["front", "back", "bottom", "top"]
        .map(|set| format!("[[support]]\nkind = \"roller\"\nset = \"{set}\"\n"))
        .concat();
    let text = format!(
        r#"
title = "hole"
[mesh]
file = "body.msh"
[[material]]
name = "rock"
law = "mohr-coulomb"
young = 9e9
poisson = 0.27
density = 2750
friction = 42
dilation = 42
cohesion = 1.05e6
[[part]]
set = "rock"
material = "rock"
kernel = "{kernel}"
{rollers}
[[load]]
kind = "pressure"
set = "right"
pressure = 30e6
[in_situ_stress]
kind = "linear"
level = 0
stress = [-30e6, -30e6, -30e6, 0, 0, 0]
gradient = [0, 0, 0, 0, 0, 0]
[[stage]]
name = "hole"
method = "dynamic-relaxation"
increments = 10
tolerance = 1e-6
[time]
duration = 1e-3
"#
    );
    let simulation = scene(&mesh, text).prepare().unwrap();
    let body = simulation.equilibrate(None, None).unwrap().unwrap();
    let nodes = mesh.positions().iter().zip(&body.state().displacement);
    let at_wall = nodes.filter(|(x, _)| (x.x.hypot(x.y) - 1.0).abs() < 1e-9);
    let inward: Vec<f64> = at_wall
        .map(|(x, u)| -(x.x * u.x + x.y * u.y) / x.x.hypot(x.y))
        .collect();
    let found = inward.iter().sum::<f64>() / inward.len() as f64;

    let (far, poisson) = (30.0e6, 0.27);
    let shear = 9.0e9 / (2.0 * (1.0 + poisson));
    let n = (66.0_f64.to_radians()).tan().powi(2);
    let share = 2.0 * 1.05e6 * n.sqrt() / (n - 1.0);
    let plastic = (2.0 / (n + 1.0) * (far + share) / share).powf(1.0 / (n - 1.0));
    let outer = (1.0 - poisson) * (n * n - 1.0) / (2.0 * n) * share * plastic.powf(2.0 * n);
    let inner = ((1.0 - poisson) * (n * n + 1.0) / (2.0 * n) - poisson) * share;
    let expected = ((2.0 * poisson - 1.0) * (far + share) + outer + inner) / (2.0 * shear);
    let error = found / expected - 1.0;
    let hourglass = &body.stages()[0].hourglass;
    let is_warned = hourglass
        .iter()
        .any(|set| set.share() > HourglassShare::LIMIT);
    (error, is_warned)
}
