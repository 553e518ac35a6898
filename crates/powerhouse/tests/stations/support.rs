//! A site of two layers over rock, a wave in it, and scenes of a box of its upper layer that its motions shake.

use std::path::Path;
use std::sync::Arc;

use powerhouse::io::{TableColumn, write_gmsh, write_table};
use powerhouse::model::{ElasticMedium, FieldMotion, IncidentField, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, Ground, GroundLayer, LayeredWave, LayeredWaveParameters, Ricker, RickerQuantity,
    WaveKind,
};
use powerhouse::{Error, FileScene, Registry, Results, RunHooks, Scene};
use powerhouse_test_support::TestFolder;

pub(crate) const STEP: f64 = 0.01;
pub(crate) const SAMPLES: usize = 300;
/// Incident displacement (m), over that of the samples of one metre.
pub(crate) const FACTOR: f64 = 0.005;
/// Region inside the layer: 4 x 3 x 2 bricks of 5 m.
const REGION: [[f64; 3]; 2] = [[-10.0, -7.5, -10.0], [10.0, 7.5, 0.0]];

const SCENE: &str = r#"
title = "site"
[mesh]
file = "site.msh"
[[material]]
name = "soil"
law = "elastic"
young = {YOUNG}
poisson = {POISSON}
density = 1800
[[part]]
set = "soil"
material = "soil"
[boundary]
kind = "viscous"
faces = ["left", "right", "front", "back", "bottom"]
region = { box = [[-10, -7.5, -10], [10, 7.5, 0]] }
stations = { {KEYS} }
[time]
duration = {DURATION}
[output]
every = 0.005
[[output.history]]
name = "surface"
at = [0, 2.5, 0]
[[output.history]]
name = "corner"
at = [10, 7.5, 0]
[[output.history]]
name = "below"
at = [-5, -2.5, -10]
[[output.history]]
name = "outside"
at = [25, 2.5, 0]
"#;

fn medium(density: f64, s_speed: f64, p_speed: f64) -> ElasticMedium {
    let (s, p) = (s_speed * s_speed, p_speed * p_speed);
    let poisson = (p - 2.0 * s) / (2.0 * (p - s));
    ElasticMedium::new(2.0 * density * s * (1.0 + poisson), poisson, density).unwrap()
}

fn soil() -> ElasticMedium {
    medium(1800.0, 200.0, 500.0)
}

/// SV wave at 15 degrees, a Ricker pulse of 3 Hz at 1 s at the top of the rock, times a factor (m).
pub(crate) fn wave(factor: f64) -> LayeredWave {
    let layers = vec![
        GroundLayer::new(-20.0, soil()),
        GroundLayer::new(-40.0, medium(2000.0, 400.0, 1000.0)),
    ];
    let ground = Ground::new(0.0, layers, medium(2300.0, 900.0, 2000.0)).unwrap();
    let mut parameters = LayeredWaveParameters::vertical(WaveKind::SV, ground, -40.0);
    parameters.incidence = Angle::from_degrees(15.0);
    parameters.reference = Vec3::new(0.0, 0.0, -40.0);
    let signal = Ricker::new(RickerQuantity::Displacement, factor, 3.0, 1.0).unwrap();
    LayeredWave::new(parameters, Arc::new(signal)).unwrap()
}

/// Folder with the mesh of the box, in which scenes and files of motions lie.
pub(crate) struct Site {
    pub(crate) folder: TestFolder,
    pub(crate) mesh: Mesh,
}

impl Site {
    pub(crate) fn new(name: &str) -> Self {
        let folder = TestFolder::new(&format!("stations-{name}"));
        let (low, high) = (Vec3::new(-30.0, -27.5, -20.0), Vec3::new(30.0, 27.5, 0.0));
        let mesh = Mesh::box_of_hexes(low, high, [12, 11, 4], "soil").unwrap();
        write_gmsh(folder.join("site.msh"), &mesh).unwrap();
        Self { folder, mesh }
    }

    /// Places of the nodes of the layer, and whether they are of the region.
    pub(crate) fn layer(&self) -> Vec<(Vec3, bool)> {
        let [low, high] = REGION.map(Vec3::from);
        let within = |at: &Vec3, by: f64| {
            (0..3).all(|axis| low[axis] - by <= at[axis] && at[axis] <= high[axis] + by)
        };
        let is_open = |at: &Vec3| {
            // Inside of the region's surface, whose top is free.
            low.x < at.x && at.x < high.x && low.y < at.y && at.y < high.y && low.z < at.z
        };
        let nodes = self.mesh.positions().iter();
        let nodes = nodes.filter(|at| within(at, 5.001) && !is_open(at));
        nodes.map(|at| (*at, within(at, 0.001))).collect()
    }

    /// Writes the motions of the wave at the nodes of the layer as a table, after a change of the side, the place and the six
    /// numbers of a motion of each station by its index.
    pub(crate) fn write_table(&self, name: &str, change: impl Fn(usize, &mut Vec3, &mut [f64])) {
        let mut table = Table::of(self);
        for station in 0..table.places.len() {
            let mut place = table.places[station];
            for row in station * SAMPLES..(station + 1) * SAMPLES {
                place = table.places[station];
                change(station, &mut place, &mut table.motion[6 * row..6 * row + 6]);
            }
            table.places[station] = place;
        }
        table.write(&self.folder.join(name));
    }

    pub(crate) fn read(&self, keys: &str) -> Result<Scene, Error> {
        self.read_for(keys, 2.5)
    }

    pub(crate) fn read_for(&self, keys: &str, duration: f64) -> Result<Scene, Error> {
        self.read_changed(keys, duration, |text| text)
    }

    pub(crate) fn read_changed(
        &self,
        keys: &str,
        duration: f64,
        change: impl Fn(String) -> String,
    ) -> Result<Scene, Error> {
        let text = SCENE.replace("{KEYS}", keys);
        let text = text.replace("{DURATION}", &duration.to_string());
        let text = text.replace("{YOUNG}", &soil().young.to_string());
        let text = change(text.replace("{POISSON}", &soil().poisson.to_string()));
        FileScene::from_toml(text, self.folder.join("site.toml"), &Registry::default())
            .map(FileScene::into_scene)
    }

    /// Compares runs by files with that by the wave: the first with the limit of cubics, the second with that of straight
    /// lines. `least` is the least that the wave must move the surface, over the factor.
    pub(crate) fn compare_runs(&self, keys: &[&str], least: f64) {
        let by_wave = self.read(keys[0]).unwrap();
        let by_wave = run(by_wave.with_layered_waves(vec![wave(FACTOR)]).unwrap());
        for (keys, limit) in keys.iter().zip([1e-4, 1e-2]) {
            let by_file = run(self.read(keys).unwrap());
            let (mut worst, mut peak) = (0.0_f64, 0.0_f64);
            for name in ["surface", "corner", "below", "outside"] {
                for axis in ["ux", "uy", "uz"] {
                    let of = |results: &Results| {
                        let column = results.histories().column(&format!("{name}.{axis}"));
                        column.unwrap().values.clone()
                    };
                    for (a, b) in of(&by_file).iter().zip(of(&by_wave)) {
                        worst = worst.max((a - b).abs());
                        peak = peak.max(b.abs());
                    }
                }
            }
            println!("{keys}: {:.1e} of the peak, {peak:.4} m", worst / peak);
            assert!(peak > least * FACTOR, "{peak}");
            assert!(worst < limit * peak, "{keys}: {}", worst / peak);
        }
    }
}

pub(crate) fn run(scene: Scene) -> Results {
    scene.prepare().unwrap().run(RunHooks::default()).unwrap()
}

/// Table of motions: of every station its place and side, and six numbers for each sample.
pub(crate) struct Table {
    pub(crate) places: Vec<Vec3>,
    pub(crate) inner: Vec<bool>,
    pub(crate) motion: Vec<f64>,
}

impl Table {
    pub(crate) fn of(site: &Site) -> Self {
        let (places, inner): (Vec<Vec3>, Vec<bool>) = site.layer().into_iter().unzip();
        let sampler = wave(FACTOR).prepare(&places).unwrap();
        let mut motion = vec![0.0; 6 * SAMPLES * places.len()];
        for sample in 0..SAMPLES {
            let mut moved = vec![FieldMotion::default(); places.len()];
            sampler.add_motion(STEP * sample as f64, &mut moved);
            for (station, moved) in moved.iter().enumerate() {
                let at = 6 * (station * SAMPLES + sample);
                motion[at..at + 3].copy_from_slice(moved.displacement.as_slice());
                motion[at + 3..at + 6].copy_from_slice(moved.velocity.as_slice());
            }
        }
        Self {
            places,
            inner,
            motion,
        }
    }

    pub(crate) fn station_at(&self, place: [f64; 3]) -> usize {
        let is_there = |at: &Vec3| (at - Vec3::from(place)).norm() < 1e-9;
        self.places.iter().position(is_there).unwrap()
    }

    pub(crate) fn write(&self, path: &Path) {
        let rows = self.places.len() * SAMPLES;
        let column = |name: &str, unit: &str, of: &dyn Fn(usize) -> f64| {
            TableColumn::new(name, unit, (0..rows).map(of).collect())
        };
        let mut columns: Vec<TableColumn> = ["x", "y", "z"]
            .into_iter()
            .enumerate()
            .map(|(axis, name)| column(name, "m", &|row| self.places[row / SAMPLES][axis]))
            .collect();
        columns.push(column("inner", "1", &|row| {
            f64::from(u8::from(self.inner[row / SAMPLES]))
        }));
        columns.push(column("time", "s", &|row| STEP * (row % SAMPLES) as f64));
        for (number, name) in ["ux", "uy", "uz", "vx", "vy", "vz"].into_iter().enumerate() {
            let unit = if number < 3 { "m" } else { "m/s" };
            columns.push(column(name, unit, &|row| self.motion[6 * row + number]));
        }
        write_table(path, &columns).unwrap();
    }
}
