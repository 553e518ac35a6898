//! Sweeps: cases of a scene, shared stages, reuse of finished cases.

mod bodies;
mod checkpoints;
mod coverage;
mod finished;
mod processes;
mod ranks;
mod record_sets;
mod report;
mod running;
mod sections;
mod thirty;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use powerhouse::io::{read_table, write_gmsh};
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{EquilibratedBody, Error, Registry, ResultFolder, RunHooks, RunNotes, Scene};
use powerhouse_report::{
    ReportCase, ReportItem, ReportSection, ReportTable, read_outcomes, report_gaps, sensitivity,
    write_report, write_report_with,
};
use powerhouse_study::StudyError;
use powerhouse_study::sweep::{CaseOutcome, NoProgress, Sweep, SweepWatch};
use powerhouse_test_support::TestFolder;

/// A slice of ground in a scene of its own folder: elastic, one stage, two cases and one without joint.
const SCENE: &str = r#"
title = "bay"
[mesh]
file = "mesh.msh"
[[material]]
name = "rock"
law = "elastic"
young = 9e9
poisson = 0.27
density = 2750
[[part]]
set = "rock"
material = "rock"
[[part]]
set = "void"
material = "rock"
[[part]]
set = "structure"
material = "rock"
[[joint]]
name = "seam"
between = ["rock", "structure"]
law = "bonded-coulomb"
cohesion = 1e6
tensile_strength = 1e6
static_friction = 0.8
dynamic_friction = 0.7
[[load]]
kind = "gravity"
[[support]]
kind = "roller"
set = "front"
[[support]]
kind = "roller"
set = "back"
[in_situ_stress]
kind = "ground"
level = 24
density = 2750
lateral = 0.37
[[bolt]]
name = "pins"
diameter = 0.025
lines = [[[4, 3, 23], [4.2, 3, 14]], [[20, 3, 23], [19, 3, 15]]]
[[stage]]
name = "opening"
excavate = ["void"]
bolts = ["pins"]
tied = ["seam"]
tolerance = 1e-3
support = [
    { kind = "roller", set = "left" },
    { kind = "roller", set = "right" },
    { kind = "roller", set = "bottom" },
]
[[wave]]
kind = "p"
incidence = 0
pulse = { kind = "smooth", displacement = 0.01, duration = 0.1 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "bottom"]
scatterer = [12, 3, 12]
[time]
duration = 0.05
[output]
every = 0.005
[[output.history]]
name = "A"
set = "point_A"
quantities = ["displacement"]
[[output.history]]
name = "O1"
set = "point_O1"
quantities = ["acceleration"]
[[output.section]]
name = "waist"
set = "structure"
at = [12, 3, 8]
normal = [0, 0, 1]
along = [0, 1, 0]
[[output.joint]]
name = "seam-side"
joint = "seam"
low = [8, -1, 5]
high = [10, 7, 13]
quantities = ["state"]
[[output.relative]]
name = "A-O1"
set = "point_A"
from_set = "point_O1"
[[case]]
name = "steep"
[[case]]
name = "slanted"
wave = [{ kind = "p", incidence = 20, pulse = { kind = "smooth", displacement = 0.01, duration = 0.1 } }]
[[case]]
name = "continuous"
continuous = ["seam"]
"#;

/// The scene without joint, stages and bolts, up to the watched joints, and with another end.
fn ground(rest: &str) -> String {
    let place = |text: &str| SCENE.find(text).unwrap();
    let (joint, support) = (place("[[joint]]"), place("[[support]]"));
    let (stress, wave) = (place("[in_situ_stress]"), place("[[wave]]"));
    let watched = place("[[output.joint]]");
    let kept = [
        &SCENE[..joint],
        &SCENE[support..stress],
        &SCENE[wave..watched],
        rest,
    ];
    kept.concat()
}

/// Ground of 24 m by 6 m by 24 m times a scale, with a structure at its heart and a void above that.
fn slice(scale: f64) -> Mesh {
    layers(2)
        .map_positions(|position| position * scale)
        .unwrap()
}

/// The same with a number of layers of 3 m along y.
fn layers(count: usize) -> Mesh {
    let size = Vec3::new(24.0, 3.0 * count as f64, 24.0);
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [8, count, 8], "rock").unwrap();
    let within = |mesh: &Mesh, low: f64, high: f64| {
        mesh.elements_in_box(&Vec3::new(9.0, 0.0, low), &Vec3::new(15.0, size.y, high))
    };
    let (structure, void) = (within(&mesh, 6.0, 12.0), within(&mesh, 12.0, 18.0));
    let all = 0..mesh.element_count() as u32;
    let rock = all
        .filter(|e| !structure.contains(e) && !void.contains(e))
        .collect();
    for (name, elements) in [("rock", rock), ("structure", structure), ("void", void)] {
        mesh.set_element_set(name, elements).unwrap();
    }
    for (name, z) in [("point_A", 18.0), ("point_O1", 6.0)] {
        let at = Vec3::new(12.0, 3.0, z);
        let nodes = mesh.nodes_in_box(&at, &at);
        mesh.set_node_set(name, nodes).unwrap();
    }
    mesh
}

/// Built-in names, and the mesh generator `layers`, which reads their number from a file.
fn registry() -> Registry {
    let mut registry = Registry::default();
    registry.add_mesh_generator("layers", |file: &Path| {
        let text = std::fs::read_to_string(file)?;
        let count = text.trim().parse();
        count.map(layers).map_err(std::io::Error::other)
    });
    registry
}

struct Folder(TestFolder);

impl Folder {
    fn new(name: &str) -> Self {
        let path = TestFolder::new(name);
        std::fs::write(path.join("layers.txt"), "2").unwrap();
        std::fs::write(path.join("scene.toml"), SCENE).unwrap();
        write_gmsh(path.join("mesh.msh"), &slice(1.0)).unwrap();
        Self(path)
    }
    /// The scene with a generated mesh.
    fn generated() -> String {
        SCENE.replace(
            "file = \"mesh.msh\"",
            "generator = \"layers\"\nfile = \"layers.txt\"",
        )
    }
    fn scene(&self) -> PathBuf {
        self.0.join("scene.toml")
    }
    fn sweep(&self) -> Sweep {
        Sweep::of_file_with(self.scene(), Some(self.0.join("out")), &registry()).unwrap()
    }
}

/// Counts the progress callbacks of a sweep.
#[derive(Default)]
struct Count {
    kept: Vec<String>,
    at_rest: Vec<String>,
    ended: Vec<String>,
    failed: Vec<String>,
    /// Errors of the free field.
    checked: Vec<f64>,
}

impl SweepWatch for Count {
    fn reused(&mut self, case: &str) {
        self.kept.push(case.into());
    }
    fn fails(&mut self, case: &str, _error: &StudyError) {
        self.failed.push(case.into());
    }
    fn self_check(&mut self, _case: &str, error: f64) {
        self.checked.push(error);
    }
    fn equilibrated(&mut self, case: &str, _took: Duration) {
        self.at_rest.push(case.into());
    }
    fn ends(&mut self, outcome: &CaseOutcome) {
        self.ended.push(outcome.name.clone());
    }
}
