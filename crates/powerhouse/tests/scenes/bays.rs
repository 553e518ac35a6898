//! Bays of an endless row with delayed sides, under waves of any azimuth.

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{Error, FileScene, Registry, Results, RunHooks};

use super::support::Folder;

/// A bay of ground, 30 m long, with a core of concrete in a part of it, under an SV wave along the row.
const BAY: &str = r#"
title = "bay"
mesh = { file = "bay.msh" }
support = [{ kind = "delayed", from = "front", to = "back" }]
[[material]]
name = "granite"
law = "elastic"
young = 9.0e9
poisson = 0.27
density = 2750
[[material]]
name = "concrete"
law = "elastic"
young = 25e9
poisson = 0.17
density = 2500
[[part]]
set = "rock"
material = "granite"
kernel = "hex8-natural"
[[part]]
set = "core"
material = "concrete"
kernel = "hex8-natural"
[[wave]]
kind = "sv"
incidence = 15
azimuth = 90
pulse = { kind = "smooth", displacement = 0.01, duration = 0.3 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "bottom"]
scatterer = [0, 0, -40]
[time]
duration = 0.4
[output]
every = 0.01
energies = 0.05
[[output.history]]
name = "front"
at = [0, -15, 0]
[[output.history]]
name = "back"
at = [0, 15, 0]
"#;

/// A bay with a core of a half length (m).
fn mesh(half: f64) -> Mesh {
    let (low, high) = (Vec3::new(-60.0, -15.0, -80.0), Vec3::new(60.0, 15.0, 0.0));
    let mut mesh = Mesh::box_of_hexes(low, high, [12, 6, 8], "rock").unwrap();
    let all = 0..mesh.element_count() as u32;
    let (core, rest): (Vec<u32>, Vec<u32>) = all.partition(|element| {
        let x = mesh.centroid(*element);
        x.x.abs() < 20.0 && (-50.0..-30.0).contains(&x.z) && x.y.abs() < half
    });
    mesh.set_element_set("core", core).unwrap();
    mesh.set_element_set("rock", rest).unwrap();
    mesh
}

fn scene(text: &str) -> Result<FileScene, Error> {
    scene_on(&mesh(9.0), text)
}

fn scene_on(mesh: &Mesh, text: &str) -> Result<FileScene, Error> {
    let folder = Folder::new("bays");
    write_gmsh(folder.join("bay.msh"), mesh).unwrap();
    FileScene::from_toml(
        text.to_owned(),
        folder.join("bay.toml"),
        &Registry::default(),
    )
}

fn run(text: &str) -> Results {
    let simulation = scene(text).unwrap().into_scene().prepare().unwrap();
    simulation.run(RunHooks::default()).unwrap()
}

/// A scene of a bay runs, says which time its results have, closes its balance of energies with a column of the delay, and the two
/// ends have the same motion: that of the time in the middle.
#[test]
fn a_bay_runs_and_says_what_its_times_are() {
    let simulation = scene(BAY).unwrap().into_scene().prepare().unwrap();
    let remarks = simulation.remarks().iter().map(|remark| remark.to_string());
    let remarks: Vec<String> = remarks.collect();
    let of_times = remarks.iter().find(|text| text.contains("endless row"));
    // 30 m, and sin(15) over 1135 m/s.
    assert!(
        of_times.is_some_and(|text| text.contains("2.2") && text.contains("6.8")),
        "{remarks:?}"
    );
    let results = run(BAY);
    assert!(results.run.energy_residual < 1e-7);
    let delay = results
        .run
        .energies
        .iter()
        .find(|(name, _)| *name == "delay");
    assert!(delay.is_some());
    let table = results.histories();
    let column = |name: &str| &table.column(name).unwrap().values;
    assert_eq!(column("front.ux"), column("back.ux"));
    let largest = column("front.uy")
        .iter()
        .fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(largest > 1e-3, "{largest}");
}

/// Materials that yield, joints and flat damping are taken by bays, other than by slices; what they do not take is refused by name.
#[test]
fn what_a_bay_takes_and_what_it_does_not() {
    let yielding = BAY.replacen(
        "law = \"elastic\"\nyoung = 9.0e9",
        "law = \"mohr-coulomb\"\nfriction = 40\ncohesion = 1e5\nyoung = 9.0e9",
        1,
    );
    let yielding_core = BAY.replacen(
        "law = \"elastic\"\nyoung = 25e9",
        "law = \"mohr-coulomb\"\nfriction = 40\ncohesion = 1e6\nyoung = 25e9",
        1,
    );
    let slack = yielding.replacen("incidence = 15", "incidence = 12", 1);
    let damped = slack.replacen(
        "kernel = \"hex8-natural\"\n",
        "kernel = \"hex8-natural\"\ndamping = { kind = \"flat\", ratio = 0.02, band = [0.5, 20] }\n",
        1,
    );
    let jointed = BAY.replacen(
        "[[wave]]",
        "[[joint]]\nname = \"skin\"\nbetween = [\"rock\", \"core\"]\nlaw = \"bonded-coulomb\"\ncohesion = 0\ntensile_strength = 0\nstatic_friction = 0.6\ndynamic_friction = 0.6\n[[wave]]",
        1,
    );
    let bolted = |toe: &str| {
        let bolt = format!(
            "[[bolt]]\nname = \"nail\"\nsection = 4e-2\nyoung = 210e9\nlines = [[[-40, 1, -60], {toe}]]\n[[stage]]\nname = \"ground\"\nbolts = [\"nail\"]\nsupport = [{{ kind = \"fixed\", set = \"bottom\" }}]\n[time]"
        );
        BAY.replacen("[time]", &bolt, 1)
    };
    let across = bolted("[-20, 1, -55]");
    for text in [&slack, &damped, &jointed, &across] {
        let results = run(text);
        assert!(results.run.energy_residual < 0.01);
        assert!(results.run.time > 0.39);
    }
    // The joint of a core that runs through crosses both ends.
    let through = scene_on(&mesh(20.0), &jointed).unwrap().into_scene();
    let through = through.prepare().unwrap().run(RunHooks::default()).unwrap();
    assert!(through.run.energy_residual < 0.01);
    for (text, message) in [
        // A material that yields is limited to 0.9 of the speed along the row, others to 0.95.
        (
            yielding_core.replacen("incidence = 15", "incidence = 18.7", 1),
            "must be below 0.9;",
        ),
        (
            BAY.replacen("incidence = 15", "incidence = 20", 1),
            "must be below 0.95",
        ),
        (bolted("[-40, 9, -60]"), "runs along y"),
        (
            BAY.replacen("title = ", "precision = \"mixed\"\ntitle = ", 1),
            "double precision",
        ),
        (
            BAY.replacen(
                "from = \"front\", to = \"back\"",
                "from = \"left\", to = \"right\"",
                1,
            ),
            "delayed ends are normal to y",
        ),
    ] {
        let refused = match scene(&text) {
            Err(error) => error.to_string(),
            Ok(scene) => scene.into_scene().prepare().err().unwrap().to_string(),
        };
        assert!(refused.contains(message), "{message}: {refused}");
    }
}

/// A case may have a precision of its own, as a bay needs where the scene is computed in mixed precision.
#[test]
fn a_case_has_its_own_precision() {
    let folder = Folder::new("bays-precision");
    write_gmsh(folder.join("bay.msh"), &mesh(9.0)).unwrap();
    let text = BAY.replacen("title = ", "precision = \"mixed\"\ntitle = ", 1);
    let cases = "[[case]]\nname = \"mixed\"\n[[case]]\nname = \"double\"\nprecision = \"f64\"\n";
    let prepared = |case: &str| {
        let text = format!("{text}{cases}");
        let (path, registry) = (folder.join("bay.toml"), Registry::default());
        FileScene::case_from_toml(text, path, case, &registry)?
            .into_scene()
            .prepare()
    };
    let refused = prepared("mixed").err().unwrap().to_string();
    assert!(refused.contains("double precision"), "{refused}");
    prepared("double").unwrap();
}

/// A bay that is excavated, lined and bolted in stages, from a stress of the ground that grows with depth, moves under nearly vertical waves as the same body with periodic
/// ends does under vertical ones. What is cast begins at the displacement of its stage.
#[test]
fn a_bay_is_excavated_and_lined() {
    let mut mesh = mesh(20.0);
    let core = mesh.element_set("core").unwrap().to_vec();
    let (void, lining) = (core.iter()).partition(|&&e| mesh.centroid(e).x.abs() < 10.0);
    mesh.set_element_set("void", void).unwrap();
    mesh.set_element_set("lining", lining).unwrap();
    let stages = r#"
[[load]]
kind = "gravity"
[in_situ_stress]
kind = "ground"
level = 0
density = 2750
lateral = 0.4
[[bolt]]
name = "nail"
section = 4e-2
young = 210e9
lines = [[[-40, 1, -60], [-20, 1, -55]]]
[[stage]]
name = "ground"
part = [{ set = "lining", material = "granite" }]
support = [{ kind = "roller", set = "left" }, { kind = "roller", set = "right" }, { kind = "roller", set = "front" }, { kind = "roller", set = "back" }, { kind = "roller", set = "bottom" }]
[[stage]]
name = "heading"
excavate = ["void", "lining"]
bolts = ["nail"]
release = 0.6
[[stage]]
name = "lining"
cast = ["lining"]
[time]
"#;
    let parts = r#"[[part]]
set = "void"
material = "granite"
kernel = "hex8-natural"
[[part]]
set = "lining"
"#;
    let text = BAY
        .replacen("[time]\n", stages.trim_start(), 1)
        .replacen("[[part]]\nset = \"core\"\n", parts, 1)
        .replacen("at = [0, 15, 0]", "at = [15, 0, -40]", 1);
    let run = |text: &str| {
        let simulation = scene_on(&mesh, text).unwrap().into_scene().prepare();
        simulation.unwrap().run(RunHooks::default()).unwrap()
    };
    let flat = "damping = { kind = \"flat\", ratio = 0.02, band = [0.5, 20] }\n";
    for damping in ["", flat] {
        let kernel = "kernel = \"hex8-natural\"\n";
        let text = text.replace(kernel, &format!("{kernel}{damping}"));
        let delayed = run(&text.replacen("incidence = 15", "incidence = 0.1", 1));
        let periodic = run(&text
            .replacen("incidence = 15", "incidence = 0", 1)
            .replacen("delayed", "periodic", 1));
        // Laws and bolts begin with the forces that hold the body.
        assert_eq!(delayed.run.unsolved, None);
        let [tables_a, tables_b] = [delayed.histories(), periodic.histories()];
        for column in ["front.uy", "back.uy"] {
            let [a, b] = [&tables_a, &tables_b].map(|t| &t.column(column).unwrap().values);
            let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            let largest = b.iter().fold(0.0_f64, |most, b| most.max(b.abs()));
            let apart = apart.fold(0.0, f64::max);
            assert!(
                apart < 0.01 * largest,
                "{damping}{column}: {apart} of {largest}"
            );
        }
    }
}

/// A lining with damping in a joint, in rock that yields, at a speed of P waves near the limit: what breaks must not let motions grow that
/// alternate from step to step.
#[test]
fn a_damped_lining_that_breaks_keeps_its_balance() {
    let x = [
        -16.5, -12.1, -8.25, -5.5, -3.3, -2.75, -1.1, 1.1, 2.75, 3.3, 5.5, 8.25, 12.1, 16.5,
    ];
    let y = [0.0, 0.99, 1.65, 3.3];
    let z = [
        -27.5, -23.1, -19.25, -17.05, -15.4, -14.85, -13.2, -11.55, -11.0, -8.8, -6.05, -2.75, 0.0,
    ];
    let cells = [13, 3, 12];
    let high = Vec3::new(13.0, 3.0, 12.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), high, cells, "rock").unwrap();
    let place = |at: Vec3| {
        let of = |values: &[f64], at: f64| values[at.round() as usize];
        Vec3::new(of(&x, at.x), of(&y, at.y), of(&z, at.z))
    };
    let mut mesh = mesh.map_positions(place).unwrap();
    let within = |element: u32, half: f64, low: f64, high: f64| {
        let at = mesh.centroid(element);
        at.x.abs() < half && (low..high).contains(&at.z)
    };
    let all = 0..mesh.element_count() as u32;
    let (core, rock): (Vec<u32>, Vec<u32>) = all.partition(|e| within(*e, 3.3, -15.4, -11.0));
    let (void, lining) = (core.iter()).partition(|&&e| within(e, 2.75, -14.85, -11.55));
    for (name, set) in [("rock", rock), ("void", void), ("lining", lining)] {
        mesh.set_element_set(name, set).unwrap();
    }
    let text = r#"
title = "lining"
mesh = { file = "bay.msh" }
support = [{ kind = "delayed", from = "front", to = "back" }]
material = [
    { name = "rock", law = "mohr-coulomb", young = 9e9, poisson = 0.25, density = 2400, cohesion = 0.4e6, friction = 35, dilation = 25, tensile_strength = 0.2e6 },
    { name = "concrete", law = "plastic-damage", preset = "C25", surface = "mohr-coulomb", tension = { fracture_energy = 280 } },
    { name = "air", law = "elastic", young = 1e6, poisson = 0.2, density = 200 },
]
part = [
    { set = "rock", material = "rock", elastic_rim = 6, damping = { kind = "flat", ratio = 0.02, band = [0.5, 20] } },
    { set = "lining", material = "concrete", kernel = "hex8-eas" },
    { set = "void", material = "air" },
]
[[joint]]
name = "skin"
between = ["rock", "lining"]
law = "bonded-coulomb"
cohesion = 0.3e6
tensile_strength = 0.3e6
static_friction = 0.7
dynamic_friction = 0.6
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "bottom"]
scatterer = [0, 1.65, -13]
[[wave]]
kind = "sv"
incidence = 12
azimuth = 90
pulse = { kind = "ricker", frequency = 6, displacement = 0.04 }
reference = [0, 0, -27.5]
[time]
duration = 0.3
[output]
energies = 0.005
"#;
    let simulation = scene_on(&mesh, text).unwrap().into_scene().prepare();
    let results = simulation.unwrap().run(RunHooks::default()).unwrap();
    assert!(results.run.energy_residual < 1e-4);
    let damage = results
        .run
        .energies
        .iter()
        .find(|(name, _)| *name == "damage");
    assert!(
        damage.is_some_and(|(_, energy)| *energy > 1e3),
        "{damage:?}"
    );
}
