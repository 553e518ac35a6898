//! A block of ground under a pulse, in a folder of its own.

use std::path::PathBuf;
use std::process::{Child, Command, Output};

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse_test_support::TestFolder;

const SCENE: &str = r#"
title = "block"
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
[[wave]]
kind = "sv"
incidence = 20
pulse = { kind = "smooth", displacement = 0.02, duration = 0.25 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "front", "back", "bottom"]
scatterer = [60, 60, 120]
[time]
duration = 0.3
[output]
every = 0.01
energies = 0.01
[[output.history]]
name = "inside"
at = [60, 60, 60]
quantities = ["displacement", "acceleration"]
[output.snapshots]
every = 0.1
"#;

/// A block of 120 m in a folder that goes away with it.
pub(crate) struct Block {
    pub(crate) folder: TestFolder,
}

impl Block {
    /// The block with a change of its scene.
    pub(crate) fn new(name: &str, change: impl Fn(String) -> String) -> Self {
        Self::of_cells(name, 6, change)
    }
    /// The block with a number of elements along each edge.
    pub(crate) fn of_cells(name: &str, cells: usize, change: impl Fn(String) -> String) -> Self {
        let folder = TestFolder::new(&format!("cli-block-{name}"));
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(120.0), [cells; 3], "rock");
        write_gmsh(folder.join("mesh.msh"), &mesh.unwrap()).unwrap();
        std::fs::write(folder.join("scene.toml"), change(SCENE.into())).unwrap();
        Self { folder }
    }
    /// The scene's file.
    pub(crate) fn scene(&self) -> String {
        self.folder.join("scene.toml").display().to_string()
    }
    /// The folder of results.
    pub(crate) fn out(&self) -> PathBuf {
        self.folder.join("out")
    }
    pub(crate) fn out_text(&self) -> String {
        self.out().display().to_string()
    }
    /// Runs the command with its scene.
    pub(crate) fn powerhouse(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_powerhouse"));
        command.args(arguments).output().unwrap()
    }
}

/// The text of a stream.
pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Sends a signal to a process, such as `-INT`.
#[cfg(unix)]
pub(crate) fn signal(process: &Child, signal: &str) {
    let mut kill = Command::new("kill");
    let id = process.id().to_string();
    assert!(kill.args([signal, &id]).status().unwrap().success());
}
