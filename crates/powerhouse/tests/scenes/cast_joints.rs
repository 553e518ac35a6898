//! Joints of what is cast against stressed rock, or grouted when both sides are there.

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{FileScene, Registry, RunHooks};

use super::support::Folder;

const SCENE: &str = r#"
title = "fill"
[mesh]
file = "fill.msh"
[[material]]
name = "rock"
law = "elastic"
young = 1e9
poisson = 0.25
density = 2500
[[part]]
set = "rock"
material = "rock"
[[part]]
set = "fill"
material = "rock"
[[joint]]
name = "joint"
between = ["rock", "fill"]
law = "bonded-coulomb"
static_friction = 0.8
cohesion = 1e6
tensile_strength = 1e6
[in_situ_stress]
kind = "linear"
level = 0
stress = [-2e6, -1.5e6, -1e6, 0, 0, 0]
gradient = [0, 0, 0, 0, 0, 0]
"#;

/// Rock of 8 x 4 x 8 m with bricks of some size, and the fill of a notch in its top or of a shaft down to its bottom.
fn folder(name: &str, cells: usize, depth: f64) -> Folder {
    let folder = Folder::new(name);
    let (low, high) = (Vec3::new(-4.0, 0.0, -8.0), Vec3::new(4.0, 4.0, 0.0));
    let count = [2 * cells, cells, 2 * cells];
    let mut mesh = Mesh::box_of_hexes(low, high, count, "all").unwrap();
    let elements = 0..mesh.element_count() as u32;
    let (fill, rock): (Vec<u32>, Vec<u32>) = elements.partition(|&element| {
        let at = mesh.centroid(element);
        at.x.abs() < 2.0 && at.z > -depth
    });
    mesh.set_element_set("rock", rock).unwrap();
    mesh.set_element_set("fill", fill).unwrap();
    write_gmsh(folder.join("fill.msh"), &mesh).unwrap();
    folder
}

/// The greatest traction of a pair at the end of the stages and of a short run, in which nothing acts (Pa).
fn greatest(folder: &Folder, stages: &str) -> f64 {
    let rollers = ["left", "right", "front", "back", "bottom", "top"];
    let rollers = rollers.map(|set| format!("{{ kind = \"roller\", set = \"{set}\" }}"));
    let text = format!(
        "{SCENE}[[stage]]\nname = \"rock\"\nsupport = [{}]\ntied = [\"joint\"]\n{stages}[time]\nduration = 0.002\n",
        rollers.join(", ")
    );
    let scene = FileScene::from_toml(text, folder.join("fill.toml"), &Registry::default()).unwrap();
    let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let records = &results.joints[0].records;
    assert!(records.len() > 10);
    (records.iter()).fold(0.0, |most, record| record.traction.norm().max(most))
}

/// What is cast into a notch, or a shaft, of rock under stress bears nothing, at its edges and at rollers either: all tractions of
/// its joint are zero, on meshes of two sizes, whether the joint was tied or left alone while its side was away.
#[test]
fn what_is_cast_late_has_no_traction() {
    for (cells, depth) in [(2, 4.0), (4, 4.0), (4, 6.0), (2, 8.0)] {
        let folder = folder(&format!("cast-{cells}-{depth}"), cells, depth);
        let stages = "[[stage]]\nname = \"open\"\nexcavate = [\"fill\"]\ntied = [\"joint\"]\n\
                      [[stage]]\nname = \"cast\"\ncast = [\"fill\"]\ngrouted = [\"joint\"]\n";
        for stages in [stages, &stages.replace("grouted = [\"joint\"]\n", "")] {
            let found = greatest(&folder, stages);
            assert!(found < 1e-6 * 2e6, "{cells} {depth}: {found}");
        }
    }
}

/// While nothing was removed, the joint has the traction of the rock after its tie is gone.
#[test]
fn what_was_there_keeps_its_traction() {
    let folder = folder("kept-traction", 2, 4.0);
    let found = greatest(&folder, "[[stage]]\nname = \"free\"\n");
    assert!((found - 2e6).abs() < 1e-3 * 2e6, "{found}");
}
