//! Water in the ground from stage to stage: levels that change, water that cannot flow, and what results say of both.

use std::sync::{Arc, Mutex};

use nalgebra::{Matrix4, Rotation3, Vector4};
use powerhouse::engine::{SolidKernel, StaticOptions, StressField, Support, WaterPressure};
use powerhouse::io::write_gmsh;
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, Mesh, Stress, Vec3};
use powerhouse::{
    CompletedStage, Error, FileScene, InSituStress, Material, Part, Registry, Results, Scene,
    SceneStage, StageSink, StageWater,
};

use super::support::{Folder, run};

pub(super) const GRAVITY: f64 = 9.81;
pub(super) const WATER: f64 = 1000.0 * GRAVITY;
pub(super) const HEIGHT: f64 = 12.0;
/// Constrained modulus of the sand (Pa), and bulk modulus of water over its porosity.
pub(super) const SAND: f64 = 40e6 * 0.7 / (1.3 * 0.4);
pub(super) const PORES: f64 = 2.2e9 / 0.4;

pub(super) const COLUMN: &str = r#"
title = "column"
[mesh]
file = "column.msh"
[[material]]
name = "sand"
law = "elastic"
young = 40e6
poisson = 0.3
density = 2000
pore_water = { porosity = 0.4, level = 9 }
[[material]]
name = "clay"
law = "elastic"
young = 60e6
poisson = 0.25
density = 2000
[[part]]
set = "low"
material = "sand"
[[part]]
set = "plug"
material = "sand"
[[part]]
set = "upper"
material = "sand"
[[load]]
kind = "gravity"
[in_situ_stress]
kind = "ground"
level = 12
density = 2000
lateral = 0.5
water = { level = 9 }
[boundary]
kind = "viscous"
faces = ["left", "right", "front", "back", "bottom"]
[time]
duration = 0.02
[output]
every = 0.005
[[stage]]
name = "ground"
tolerance = 1e-12
support = [
    { kind = "roller", set = "left" },
    { kind = "roller", set = "right" },
    { kind = "roller", set = "front" },
    { kind = "roller", set = "back" },
    { kind = "roller", set = "bottom" },
]
"#;

/// A column of ground with bricks of 1 m height in three parts, turned about the vertical, and its scenes.
pub(super) struct Column {
    pub(super) folder: Folder,
    turn: Rotation3<f64>,
    kernel: &'static str,
}

impl Column {
    pub(super) fn new(turn: f64, cells: [usize; 2], kernel: &'static str) -> Self {
        let size = Vec3::new(3.0, 2.0, HEIGHT);
        let cells = [cells[0], cells[1], HEIGHT as usize];
        let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, cells, "all").unwrap();
        for (name, low, high) in [
            ("low", 0.0, 6.0),
            ("plug", 6.0, 8.0),
            ("upper", 8.0, HEIGHT),
        ] {
            let box_of = [Vec3::new(0.0, 0.0, low), Vec3::new(3.0, 2.0, high)];
            let elements = mesh.elements_in_box(&box_of[0], &box_of[1]);
            mesh.set_element_set(name, elements).unwrap();
        }
        let low = mesh.element_set("low").unwrap().to_vec();
        let mut floor = mesh.boundary_facets_of(|element| low.contains(&element));
        floor.retain(|facet| mesh.facet_geometry(*facet).normal().z > 0.9);
        mesh.set_facet_set("floor", floor).unwrap();
        let turn = Rotation3::from_axis_angle(&Vec3::z_axis(), turn);
        let mesh = mesh.map_positions(|x| turn * x).unwrap();
        let folder = Folder::new("water-stages");
        write_gmsh(folder.join("column.msh"), &mesh).unwrap();
        Self {
            folder,
            turn,
            kernel,
        }
    }
    pub(super) fn read(&self, text: &str) -> Result<FileScene, Error> {
        let mut text = text.to_owned();
        for z in [2.5, 5.5, 7.5, 10.5] {
            let at = self.turn * Vec3::new(0.7, 0.6, z);
            let [x, y] = [at.x, at.y];
            text.push_str(&format!(
                "[[output.history]]\nname = \"z{z}\"\nat = [{x:.17}, {y:.17}, {z}]\n\
                 quantities = [\"displacement\", \"stress\", \"state\"]\n"
            ));
        }
        let kernel = format!("[[part]]\nkernel = \"{}\"\n", self.kernel);
        let text = text.replace("[[part]]\n", &kernel);
        FileScene::from_toml(text, self.folder.join("column.toml"), &Registry::default())
    }
    pub(super) fn run(&self, text: &str) -> Results {
        run(self.read(text).unwrap())
    }
}

/// The columns on which the closed forms hold to rounding: several kernels, directions and bricks.
pub(super) fn columns() -> [Column; 3] {
    [
        Column::new(0.0, [2, 1], "hex8-natural"),
        Column::new(0.6, [1, 2], "hex8-full"),
        Column::new(-1.1, [1, 1], "hex8-eas"),
    ]
}

pub(super) fn first(results: &Results, column: &str) -> f64 {
    let found = results.histories().column(column);
    found.unwrap_or_else(|| panic!("{column}")).values[0]
}

pub(super) fn close(found: f64, expected: f64, size: f64, what: &str) {
    let off = (found - expected).abs() / size;
    assert!(off < 1e-8, "{what}: {found} for {expected}, {off:e}");
}

/// Largest displacement of the run after the stages (m).
pub(super) fn moved(results: &Results) -> f64 {
    let columns = results.histories().columns.iter();
    let displacements = columns.filter(|c| c.name.contains(".u"));
    let values = displacements.flat_map(|c| c.values.iter());
    values.fold(0.0_f64, |most, u| most.max(u.abs()))
}

/// A load on an undrained column is borne by the water but for a small part; in the drained stage after it the pressure is
/// gone, and the skeleton bears it.
#[test]
fn an_undrained_column_bears_a_load_by_its_water() {
    let load = 5e4;
    let undrained = format!(
        "{COLUMN}[[stage]]\nname = \"fill\"\nundrained = true\ntolerance = 1e-12\n\
         load = [{{ kind = \"pressure\", set = \"top\", pressure = {load} }}]\n"
    );
    let later = format!("{undrained}[[stage]]\nname = \"later\"\ntolerance = 1e-12\n");
    for column in columns() {
        let strain = load / (SAND + PORES);
        let rise = PORES * strain;
        let results = column.run(&undrained);
        let settled = results.stages[1].largest_displacement.0;
        close(
            settled,
            strain * HEIGHT,
            strain * HEIGHT,
            "undrained settlement",
        );
        for z in [2.5, 5.5, 7.5, 10.5] {
            let at = |name: &str| first(&results, &format!("z{z}.{name}"));
            let total = -2000.0 * GRAVITY * (HEIGHT - z);
            let pressure = WATER * (9.0_f64 - z).max(0.0);
            let at_rest = total + pressure;
            close(at("zz"), total - load, load, "total stress");
            close(at("pore_pressure"), pressure + rise, load, "pressure");
            close(at("excess_pore_pressure"), rise, load, "excess");
            close(
                at("effective_zz"),
                at_rest - SAND * strain,
                load,
                "effective",
            );
            let side = 0.5 * at_rest - 0.3 / 0.7 * SAND * strain;
            close(at("effective_yy"), side, load, "effective, at the side");
            close(at("pore_pressure_ratio"), -rise / at_rest, 1.0, "ratio");
        }
        assert!(moved(&results) < 1e-13, "{:e}", moved(&results));
        let results = column.run(&later);
        let whole = load * HEIGHT / SAND;
        let rest = results.stages[2].largest_displacement.0;
        close(rest, whole - strain * HEIGHT, whole, "consolidation");
        for z in [2.5, 10.5] {
            let at = |name: &str| first(&results, &format!("z{z}.{name}"));
            let total = -2000.0 * GRAVITY * (HEIGHT - z);
            let pressure = WATER * (9.0_f64 - z).max(0.0);
            close(at("zz"), total - load, load, "total stress");
            close(at("pore_pressure"), pressure, load, "pressure");
            close(
                at("effective_zz"),
                total - load + pressure,
                load,
                "effective",
            );
            assert_eq!(at("pore_pressure_ratio"), 0.0);
        }
        assert!(moved(&results) < 1e-13, "{:e}", moved(&results));
    }
}

/// Level ground settles by what the drawdown adds to the effective stress, and rises again with the water; under water that
/// rises above the ground it swells by what was without pressure before.
#[test]
fn level_ground_settles_with_the_water_and_rises_again() {
    let stage = |name: &str, keys: &str| {
        format!("[[stage]]\nname = \"{name}\"\ntolerance = 1e-12\n{keys}\n")
    };
    let text = [
        COLUMN,
        &stage("drawdown", "water = [{ level = 5 }]"),
        &stage("flood", "water = [{ level = 9 }]"),
    ];
    // 4 m of water over 5 m, and a triangle above.
    let settlement = WATER * (4.0 * 5.0 + 8.0) / SAND;
    for column in columns() {
        let drawn = column.run(&text[..2].concat());
        let found = drawn.stages[1].largest_displacement.0;
        close(found, settlement, settlement, "settlement");
        for (z, lost, left) in [
            (2.5, 4.0, 2.5),
            (5.5, 3.5, 0.0),
            (7.5, 1.5, 0.0),
            (10.5, 0.0, 0.0),
        ] {
            let at = |name: &str| first(&drawn, &format!("z{z}.{name}"));
            let total = -2000.0 * GRAVITY * (HEIGHT - z);
            let before = WATER * (9.0_f64 - z).max(0.0);
            close(at("zz"), total, -total, "total stress");
            close(at("pore_pressure"), WATER * left, -total, "pressure");
            close(
                at("effective_zz"),
                total + WATER * left,
                -total,
                "effective",
            );
            let side = 0.5 * (total + before) - 0.3 / 0.7 * WATER * lost;
            close(at("effective_xx"), side, -total, "effective, at the side");
            close(at("xx"), side - WATER * left, -total, "total, at the side");
        }
        assert!(moved(&drawn) < 1e-13, "{:e}", moved(&drawn));
        let flooded = column.run(&text.concat());
        let found = flooded.stages[2].largest_displacement.0;
        close(found, settlement, settlement, "heave");
        let still = first(&flooded, "z2.5.effective_zz");
        let expected = -2000.0 * GRAVITY * 9.5 + WATER * 6.5;
        close(still, expected, -expected, "effective");

        let lake =
            "water = [{ level = 15 }]\nload = [{ kind = \"water\", set = \"top\", level = 15 }]";
        let lake = column.run(&[COLUMN, &stage("lake", lake)].concat());
        let heave = WATER * (3.0 * 9.0 + 4.5) / SAND;
        close(lake.stages[1].largest_displacement.0, heave, heave, "lake");
        let at = |name: &str| first(&lake, &format!("z10.5.{name}"));
        let total = -2000.0 * GRAVITY * 1.5 - 3.0 * WATER;
        close(at("zz"), total, -total, "under a lake");
        close(at("pore_pressure"), 4.5 * WATER, -total, "under a lake");
        assert!(moved(&lake) < 1e-13, "{:e}", moved(&lake));
    }
}

/// Water that rises under the tight floor of a pit lifts the floor where it may move, and presses against it where it is held.
#[test]
fn water_lifts_the_floor_of_a_pit() {
    let tight = |set: &str| {
        let old = format!("set = \"{set}\"\nmaterial = \"sand\"");
        (old.clone(), old.replace("sand", "clay"))
    };
    let pit = [tight("plug"), tight("upper")]
        .iter()
        .fold(COLUMN.to_owned(), |text, (old, new)| {
            assert!(text.contains(old));
            text.replace(old, new)
        });
    let pit = pit
        + "[[stage]]\nname = \"dewatering\"\ntolerance = 1e-12\nwater = [{ set = \"low\", level = 4 }]\n\
           [[stage]]\nname = \"pit\"\ntolerance = 1e-12\nexcavate = [\"upper\"]\n";
    let free = "[[stage]]\nname = \"recovery\"\ntolerance = 1e-12\nwater = [{ level = 9 }]\n";
    let held = format!("{free}support = [{{ kind = \"fixed\", set = \"plug\" }}]\n");
    // 5 m of water over 4 m, and from 5 m to 3 m above.
    let lost = WATER * (5.0 * 4.0 + 4.0 * 2.0);
    let (heave, unloaded) = (lost / SAND, 2000.0 * GRAVITY * 4.0);
    for column in columns() {
        // Histories above the pit have nothing to record.
        let text = pit.replace("duration = 0.02", "duration = 0.01");
        let up = column.stages(&format!("{text}{free}"));
        let down = up[1].0.iter().map(|u| u.z).fold(0.0, f64::min);
        close(down, -heave, heave, "settlement");
        let floor = |stage: usize| up[stage].1;
        close(floor(3) - floor(2), heave, heave, "heave");
        let total = |stage: &Shown| stage.2[column.lowest()].0[2];
        close(total(&up[3]) - total(&up[2]), 0.0, unloaded, "total stress");
        let still = column.stages(&format!("{text}{held}"));
        close(still[3].1 - still[2].1, 0.0, heave, "held floor");
        let rise = total(&still[2]) - total(&still[3]);
        close(rise, lost / 6.0, lost / 6.0, "uplift");
    }
}

/// A pit that is excavated under water has the pressure of the water on its floor: the ground below loses effective stress by the weight
/// under water alone.
#[test]
fn a_pit_is_excavated_under_water() {
    let pit = format!(
        "{COLUMN}[[stage]]\nname = \"pit\"\ntolerance = 1e-12\nexcavate = [\"plug\", \"upper\"]\n\
         load = [{{ kind = \"water\", set = \"floor\", level = 9 }}]\n"
    );
    let lost = 2000.0 * GRAVITY * 6.0 - 3.0 * WATER;
    let heave = lost * 6.0 / SAND;
    for column in columns() {
        let found = column.stages(&pit);
        let up = found[1].0.iter().map(|u| u.z).fold(0.0, f64::max);
        close(up, heave, heave, "heave");
        let (z, low) = (0.5, column.lowest());
        let total = -2000.0 * GRAVITY * (6.0 - z) - 3.0 * WATER;
        close(found[1].2[low].0[2], total, -total, "total stress");
        close(found[1].3[low], WATER * (9.0 - z), -total, "pressure");
    }
}

/// Displacements (m), the height that the top of the plug has moved by (m), total stresses and pressures of the elements (Pa) of a
/// stage.
type Shown = (Vec<Vec3>, f64, Vec<Stress>, Vec<f64>);

/// Sink that keeps them.
#[derive(Clone, Default)]
struct Seen(Arc<Mutex<Vec<Shown>>>);

impl StageSink for Seen {
    fn completed(&mut self, stage: &CompletedStage) -> Result<(), Error> {
        let positions = stage.mesh.positions().iter();
        let top = positions.clone().position(|x| (x.z - 8.0).abs() < 1e-9);
        let displacement = stage.state.displacement.clone();
        let up = top.map_or(0.0, |node| displacement[node].z);
        let (stress, pressure) = (stage.stress.to_vec(), stage.pore_pressure.to_vec());
        self.0
            .lock()
            .unwrap()
            .push((displacement, up, stress, pressure));
        Ok(())
    }
}

fn stages_of(scene: Scene) -> Vec<Shown> {
    let seen = Seen::default();
    let simulation = scene.prepare().unwrap();
    simulation
        .equilibrate(None, Some(Box::new(seen.clone())))
        .unwrap();
    core::mem::take(&mut *seen.0.lock().unwrap())
}

impl Column {
    /// The stages of a scene without histories.
    fn stages(&self, text: &str) -> Vec<Shown> {
        let kernel = format!("[[part]]\nkernel = \"{}\"\n", self.kernel);
        let text = text.replace("[[part]]\n", &kernel);
        let path = self.folder.join("column.toml");
        let scene = FileScene::from_toml(text, path, &Registry::default()).unwrap();
        stages_of(scene.into_scene())
    }
    /// An element at the bottom.
    fn lowest(&self) -> usize {
        0
    }
}

/// Ground that is cast below the level comes with its weight alone and without pressure, until a later stage names a level.
#[test]
fn ground_is_cast_without_pressure() {
    let fill = "[[stage]]\nname = \"pit\"\nexcavate = [\"plug\", \"upper\"]\ntolerance = 1e-12\n\
                [[stage]]\nname = \"fill\"\ncast = [\"plug\"]\ntolerance = 1e-12\n";
    let flood =
        "[[stage]]\nname = \"flood\"\nwater = [{ level = 9, set = \"plug\" }]\ntolerance = 1e-12\n";
    for column in columns() {
        let found = column.stages(&format!("{COLUMN}{fill}{flood}"));
        let plug = found[2].3.len() * 6 / 12;
        let weight = 2000.0 * GRAVITY * 1.5;
        let [filled, flooded] =
            [&found[2], &found[3]].map(|stage| (stage.2[plug].0[2], stage.3[plug]));
        close(filled.0, -weight, weight, "total stress of the fill");
        assert_eq!(filled.1, 0.0);
        close(flooded.0, -weight, weight, "total stress of the fill");
        close(flooded.1, WATER * 2.5, weight, "pressure of the fill");
        // What the fill swells by: 3 to 1 m of water over 2 m.
        let swelling = WATER * 4.0 / SAND;
        close(found[3].1 - found[2].1, swelling, swelling, "swelling");
    }
}

/// A lined shaft under a head that rises: Lame's solution, from which the error falls with the square of the brick.
#[test]
fn a_lined_shaft_bears_the_head() {
    let [inner, outside, far] = [2.0, 2.5, 10.0];
    let head = 30.0 * WATER;
    let ground = ElasticMedium::new(40e6, 0.3, 2000.0).unwrap();
    let concrete = ElasticMedium::new(20e9, 0.2, 2400.0).unwrap();
    // Radial displacement A r + B / r on both sides, radial stress 2 (lambda + G) A - 2 G B / r2 in plane strain.
    let along = |medium: &ElasticMedium, r: f64| {
        let bulk = 2.0 * (medium.lambda() + medium.shear());
        [bulk, -2.0 * medium.shear() / (r * r)]
    };
    let [free, [c, d], [a, b]] = [
        along(&concrete, inner),
        along(&concrete, outside),
        along(&ground, outside),
    ];
    let system = Matrix4::new(
        0.0,
        0.0,
        free[0],
        free[1], //
        outside,
        1.0 / outside,
        -outside,
        -1.0 / outside, //
        a,
        b,
        -c,
        -d, //
        far,
        1.0 / far,
        0.0,
        0.0,
    );
    let known = Vector4::new(0.0, 0.0, head, 0.0);
    let constants = system.lu().solve(&known).unwrap();
    let expected = constants[2] * inner + constants[3] / inner;
    let pressure = -(c * constants[2] + d * constants[3]);
    assert!(expected < 0.0 && pressure > 0.0 && pressure < head);
    let errors = [1, 2, 4].map(|fine| {
        let [of_lining, of_ground] = [fine, 6 * fine];
        let cells = [of_lining + of_ground, 4 * fine, 1];
        let unit = Vec3::new((of_lining + of_ground) as f64, 1.0, 0.5);
        let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), unit, cells, "all").unwrap();
        let lining = Vec3::new(of_lining as f64, 1.0, 0.5);
        let lining = mesh.elements_in_box(&Vec3::zeros(), &lining);
        let count = mesh.element_count() as u32;
        let soil = (0..count).filter(|e| !lining.contains(e)).collect();
        mesh.set_element_set("lining", lining).unwrap();
        mesh.set_element_set("soil", soil).unwrap();
        let mesh = mesh
            .map_positions(|x| {
                let beyond = (x.x - of_lining as f64) / of_ground as f64;
                let radius = if beyond > 0.0 {
                    outside * (far / outside).powf(beyond)
                } else {
                    inner + (outside - inner) * x.x / of_lining as f64
                };
                let (sine, cosine) = (0.5 * core::f64::consts::PI * x.y).sin_cos();
                Vec3::new(radius * cosine, radius * sine, x.z)
            })
            .unwrap();
        let nodes = |face: &str| mesh.nodes_of_facets(mesh.facet_set(face).unwrap());
        let water = powerhouse::engine::PoreWater::new(2.2e9, 0.4).unwrap();
        let at = |level: f64| WaterPressure::hydrostatic(level, WATER).unwrap();
        let water = water.with_pressure(at(70.0));
        let soil = Material::from(LinearElastic::new(ground)).with_pore_water(water);
        let field = StressField {
            surface: 0.0,
            at_surface: Stress::default(),
            gradient: Stress::default(),
            ends: false,
        };
        let options = StaticOptions::default().with_tolerance(1e-10);
        let wall = nodes("left")[0] as usize;
        let scene = Scene::new("shaft", mesh.clone())
            .part(Part::new("soil", soil).with_kernel(SolidKernel::Hex8Full))
            .part(
                Part::new("lining", LinearElastic::new(concrete).into())
                    .with_kernel(SolidKernel::Hex8Full),
            )
            .with_in_situ_stress(InSituStress::Field(field))
            .stage(
                SceneStage::new("ground")
                    .support(Support::fixed(nodes("right")))
                    .support(Support::roller(nodes("front"), Vec3::y()))
                    .support(Support::roller(nodes("back"), Vec3::x()))
                    .support(Support::roller(nodes("bottom"), Vec3::z()))
                    .support(Support::roller(nodes("top"), Vec3::z()))
                    .with_options(options),
            )
            .stage(
                SceneStage::new("head")
                    .water(StageWater::new(at(100.0)))
                    .with_options(options),
            );
        let found = stages_of(scene);
        let radial = mesh.positions()[wall].xy().normalize();
        found[1].0[wall].xy().dot(&radial) / expected - 1.0
    });
    assert!(errors[2].abs() < 4e-3, "{errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.7..2.4).contains(&order), "{errors:?}");
    }
}

/// A table of pressures by height that is hydrostatic is a level, at the start and in stages; one that is not settles the ground by
/// what it lacks.
#[test]
fn tables_of_pressures_stand_for_levels() {
    let hydrostatic = |level: f64| {
        format!(
            "pressures = [[12, 0], [{level}, 0], [0, {}]]",
            WATER * level
        )
    };
    let stage = |keys: &str| {
        format!("[[stage]]\nname = \"later\"\ntolerance = 1e-12\nwater = [{{ {keys} }}]\n")
    };
    let by_level = format!("{COLUMN}{}", stage("level = 5"));
    let by_table = format!("{COLUMN}{}", stage(&hydrostatic(5.0)));
    let by_table = by_table.replace(
        "porosity = 0.4, level = 9",
        &format!("porosity = 0.4, {}", hydrostatic(9.0)),
    );
    let by_table = by_table.replace(
        "water = { level = 9 }",
        &format!("water = {{ {} }}", hydrostatic(9.0)),
    );
    assert_eq!(by_table.matches("pressures").count(), 3);
    let low = WATER * 9.0 - 4e4;
    let drained = format!(
        "{COLUMN}{}",
        stage("pressures = [[12, 0], [9, 0], [0, 4e4]]")
    );
    for column in columns() {
        let [level, table] = [&by_level, &by_table].map(|text| column.run(text));
        let settled = [&level, &table].map(|results| results.stages[1].largest_displacement.0);
        close(settled[0], settled[1], settled[0], "settlement");
        for (a, b) in level
            .histories()
            .columns
            .iter()
            .zip(&table.histories().columns)
        {
            assert_eq!(a.name, b.name);
            if ["zz", "xx", "yy", "pressure"]
                .iter()
                .any(|end| a.name.ends_with(end))
            {
                close(a.values[0], b.values[0], 2e5, &a.name);
            }
        }
        let settled = column.run(&drained).stages[1].largest_displacement.0;
        let expected = 0.5 * low * 9.0 / SAND;
        close(settled, expected, expected, "seepage");
    }
}
