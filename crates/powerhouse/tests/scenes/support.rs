//! A cube of rock under a wave, as a file and in Rust.

use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::SolidKernel;
use powerhouse::engine::observe::Motion;
use powerhouse::io::write_gmsh;
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind, first_hit_corner,
};
use powerhouse::{
    Boundary, Error, FileScene, Material, OutputPlan, Part, Registry, Results, RunHooks, Scene,
};

pub(crate) use powerhouse_test_support::TestFolder as Folder;

pub(crate) const ROCK: ElasticMedium = ElasticMedium {
    young: 9.0e9,
    poisson: 0.27,
    density: 2750.0,
};
pub(crate) const SIDES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

pub(crate) fn cube() -> Mesh {
    cube_of(6)
}

/// The cube with some elements along each edge.
pub(crate) fn cube_of(elements: usize) -> Mesh {
    let (low, high) = (Vec3::new(0.0, 0.0, -300.0), Vec3::new(300.0, 300.0, 0.0));
    Mesh::box_of_hexes(low, high, [elements; 3], "rock").unwrap()
}

/// The scene of [`cube_scene`] as a file.
pub(crate) const CUBE: &str = r#"
title = "cube"
[mesh]
file = "cube.msh"
[[material]]
name = "granite"
law = "elastic"
young = 9.0e9
poisson = 0.27
density = 2750
[[part]]
set = "rock"
material = "granite"
kernel = "hex8-full"
[[wave]]
kind = "sv"
incidence = 20
azimuth = 30
pulse = { kind = "smooth", displacement = 0.01, duration = 0.4 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "front", "back", "bottom"]
scatterer = [150, 150, 0]
[time]
duration = 0.6
[output]
every = 0.01
[[output.history]]
name = "surface"
at = [150, 150, 0]
"#;

/// Keys of the material of the cube.
pub(crate) const ELASTIC: &str =
    "law = \"elastic\"\nyoung = 9.0e9\npoisson = 0.27\ndensity = 2750\n";

/// The cube's scene with another law, without the damping that a preset has by default.
pub(crate) fn undamped(law: &str) -> String {
    let kernel = "kernel = \"hex8-full\"\n";
    assert!(CUBE.contains(ELASTIC) && CUBE.contains(kernel));
    let scene = CUBE.replacen(ELASTIC, law, 1);
    scene.replacen(kernel, &format!("{kernel}damping = \"none\"\n"), 1)
}

/// The wave of the cube.
pub(crate) const WAVE: &str = "[[wave]]\nkind = \"sv\"\nincidence = 20\nazimuth = 30\npulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 }\n";

/// The same scene composed in Rust.
pub(crate) fn cube_scene() -> Scene {
    cube_scene_on(cube())
}

pub(crate) fn cube_scene_on(mesh: Mesh) -> Scene {
    cube_scene_of(mesh, &["rock"])
}

/// The same with rock in several sets.
pub(crate) fn cube_scene_of(mesh: Mesh, sets: &[&str]) -> Scene {
    cube_scene_made_of(mesh, sets, &Material::from(LinearElastic::new(ROCK)))
}

/// The same of another material.
pub(crate) fn cube_scene_made_of(mesh: Mesh, sets: &[&str], material: &Material) -> Scene {
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, ROCK, 0.0);
    parameters.incidence = Angle::from_degrees(20.0);
    parameters.azimuth = Angle::from_degrees(30.0);
    let (low, high) = mesh.bounding_box();
    parameters.reference = first_hit_corner(&low, &high, &parameters.direction());
    let pulse = Arc::new(SmoothPulse::new(0.01, 0.4).unwrap());
    let centre = Vec3::new(150.0, 150.0, 0.0);
    let mut output = OutputPlan::default().history("surface", centre, Motion::ALL);
    output.every = 0.01;
    let part = |set: &&str| Part::new(*set, material.clone()).with_kernel(SolidKernel::Hex8Full);
    sets.iter()
        .map(part)
        .fold(Scene::new("cube", mesh), Scene::part)
        .with_field(PlaneWave::new(parameters, pulse).unwrap())
        .with_boundary(Boundary::new(ViscousSpring::default(), SIDES).with_scatterer(centre))
        .with_duration(0.6)
        .with_output(output)
}

pub(crate) fn run(scene: impl Into<FileScene>) -> Results {
    scene
        .into()
        .prepare()
        .unwrap()
        .run(RunHooks::default())
        .unwrap()
}

/// A folder with the cube's mesh in which variants of its scene are read.
pub(crate) struct Variants(pub(crate) Folder);

impl Variants {
    pub(crate) fn new(name: &str) -> Self {
        let folder = Folder::new(name);
        write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
        Self(folder)
    }
    /// The cube's scene with a passage replaced.
    pub(crate) fn read(&self, old: &str, new: &str) -> Result<FileScene, Error> {
        assert!(CUBE.contains(old), "{old}");
        self.read_text(&CUBE.replacen(old, new, 1))
    }
    /// Reads a variant from its whole text.
    pub(crate) fn read_text(&self, text: &str) -> Result<FileScene, Error> {
        FileScene::from_toml(text, self.0.join("cube.toml"), &Registry::default())
    }
    /// Runs the variant and its counterpart in Rust, and compares the bits.
    pub(crate) fn equal(&self, (old, new): (&str, &str), twin: Scene) {
        let scene = self.read(old, new).unwrap_or_else(|e| panic!("{new}: {e}"));
        let (file, twin) = (run(scene), run(twin));
        assert_eq!(file.run.steps, twin.run.steps, "{new}");
        assert!(!file.histories().times.is_empty(), "{new}");
        assert_eq!(file.histories(), twin.histories(), "{new}");
        let columns = file.histories().columns.iter();
        let moves = |values: &[f64]| values.iter().any(|&u| u != 0.0);
        assert!(columns.clone().any(|c| moves(&c.values)), "{new}");
    }
}
