//! A block with a joint across periodic sides.

use std::fmt::Write;

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{FileScene, Registry, Scene};

use super::support::{Folder, run};

const YOUNG: f64 = 2.0e9;
const POISSON: f64 = 0.2;
const DENSITY: f64 = 2300.0;
const PRESSURE: f64 = 2.0e5;
const FRICTION: f64 = 0.6;
/// Greatest displacement of the top (m), and the time in which it comes and goes (s).
const FARTHEST: f64 = 8.0e-4;
const DURATION: f64 = 0.8;

/// Displacement of the top.
fn top(time: f64) -> f64 {
    0.5 * FARTHEST * (1.0 - (std::f64::consts::TAU * time / DURATION).cos())
}

/// Scene of a block whose halves, one above the other, have a frictional joint between them.
fn block(mesh: &Mesh) -> Scene {
    let folder = Folder::new("periodic-joint");
    let mut mesh = mesh.clone();
    let elements = 0..mesh.element_count() as u32;
    let (low, up) = elements.partition(|&element| mesh.centroid(element).z < 0.0);
    mesh.set_element_set("low", low).unwrap();
    mesh.set_element_set("up", up).unwrap();
    write_gmsh(folder.join("block.msh"), &mesh).unwrap();
    let instants = || (0..=200).map(|i| DURATION * f64::from(i) / 200.0);
    let list = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(String::new(), |mut text, value| {
            write!(text, "{value:e}, ").unwrap();
            text
        })
    };
    let times = list(&mut instants());
    let values = list(&mut instants().map(|time| top(time) / FARTHEST));
    let text = format!(
        r#"
title = "block"
mesh = {{ file = "block.msh" }}
material = [{{ name = "rock", law = "elastic", young = {YOUNG}, poisson = {POISSON}, density = {DENSITY} }}]
part = [{{ set = "low", material = "rock" }}, {{ set = "up", material = "rock" }}]
support = [
    {{ kind = "periodic", from = "left", to = "right" }},
    {{ kind = "periodic", from = "front", to = "back" }},
    {{ kind = "fixed", set = "bottom" }},
    {{ kind = "prescribed", set = "top", direction = [1, 0, 0], displacement = {FARTHEST}, function = {{ kind = "table", times = [{times}], values = [{values}] }} }},
    {{ kind = "prescribed", set = "top", direction = [0, 1, 0], displacement = 0 }},
    {{ kind = "prescribed", set = "top", direction = [0, 0, 1], displacement = 0 }},
]
time = {{ duration = {DURATION} }}
[[joint]]
name = "j"
between = ["low", "up"]
law = "bonded-coulomb"
static_friction = {FRICTION}
preload = {{ kind = "pressure", pressure = {PRESSURE} }}
[output]
every = 0.01
joint = [{{ name = "all", joint = "j" }}]
"#
    );
    let path = folder.join("block.toml");
    FileScene::from_toml(text, path, &Registry::default())
        .unwrap()
        .into_scene()
}

/// Slow shear of a frictional block is that of an elastic, perfectly plastic one: `G u / h`, limited to friction times pressure, also on
/// the way back; of bricks and of tetrahedra, whose elements on opposite periodic sides differ.
#[test]
fn a_periodic_block_shears_as_elastic_and_frictional() {
    let (low, high) = (Vec3::new(0.0, 0.0, -1.0), Vec3::new(2.0, 1.5, 1.0));
    let meshes = [
        Mesh::box_of_hexes(low, high, [2, 2, 4], "rock").unwrap(),
        Mesh::box_of_tets(low, high, [3, 2, 4], "rock").unwrap(),
    ];
    let shear_modulus = YOUNG / (2.0 * (1.0 + POISSON));
    let limit = FRICTION * PRESSURE;
    // What the traction changes by while shear waves travel twice through the block.
    let speed = (shear_modulus / DENSITY).sqrt();
    let fastest = FARTHEST * std::f64::consts::PI / DURATION;
    let lag = 0.5 * shear_modulus * fastest * 2.0 * 2.0 / speed;
    assert!(lag < 0.08 * limit);
    for mesh in meshes {
        let results = run(block(&mesh));
        let table = results.joint_histories();
        let column = |name: &str| &table.column(&format!("all.{name}")).unwrap().values;
        let (mut expected, mut before) = (0.0_f64, 0.0);
        let (mut slid, mut greatest) = (0.0_f64, 0.0_f64);
        for (row, &time) in table.times.iter().enumerate() {
            let moved = shear_modulus * (top(time) - before) / 2.0;
            expected = (expected + moved).clamp(-limit, limit);
            before = top(time);
            let found = column("shear")[row];
            let off = (found - expected.abs()).abs();
            assert!(off < lag, "{time}: {found} {expected}");
            let normal = column("normal")[row];
            assert!((normal + PRESSURE).abs() < lag, "{time}: {normal}");
            greatest = greatest.max(found);
            slid = slid.max(column("slip")[row]);
        }
        assert!((greatest / limit - 1.0).abs() < 1e-9, "{greatest} {limit}");
        let forth = FARTHEST - 2.0 * limit / shear_modulus;
        assert!(slid > 0.9 * forth, "{slid} {forth}");
    }
}
