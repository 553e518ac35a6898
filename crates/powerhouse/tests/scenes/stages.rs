//! Construction stages before a run: equivalence of file and Rust, effects, and result files.

use std::sync::{Arc, Mutex};

use powerhouse::boundary::ViscousSpring;
use powerhouse::contact::{BondedCoulomb, JointSurface, SurfaceOptions};
use powerhouse::engine::observe::Motion;
use powerhouse::engine::{
    BoltLine, BoltParameters, BoltPattern, FacePressure, NodalForce, Profile, StaticError,
    StaticOptions, StressField, Support,
};
use powerhouse::io::{read_table, write_gmsh};
use powerhouse::material::LinearElastic;
use powerhouse::model::{Bond, ElasticMedium, Mesh, Stress, Vec3};
use powerhouse::{
    BoltLayout, Boundary, CompletedStage, Error, FileScene, InSituStress, Material, OutputPlan,
    Part, Preload, Registry, ResultFolder, Results, RunHooks, RunNotes, Scene, SceneBolts,
    SceneJoint, SceneStage, StageSink, StagingError,
};

use super::support::{Folder, SIDES, run};

const ROCK: ElasticMedium = ElasticMedium {
    young: 2.0e9,
    poisson: 0.25,
    density: 2600.0,
};
const CONCRETE: ElasticMedium = ElasticMedium {
    young: 25.0e9,
    poisson: 0.2,
    density: 2400.0,
};

/// Ground with a trench of 4 m by 4 m, in which one half may become a lining, over a seam.
pub(crate) fn mesh() -> Mesh {
    let size = Vec3::new(12.0, 10.0, 12.0);
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [6, 5, 6], "all").unwrap();
    let within = |mesh: &Mesh, low: [f64; 3], high: [f64; 3]| {
        mesh.elements_in_box(&low.into(), &high.into())
    };
    let trench = within(&mesh, [4.0, 0.0, 8.0], [8.0, 10.0, 12.0]);
    let lining = within(&mesh, [4.0, 0.0, 8.0], [6.0, 10.0, 12.0]);
    let inner = within(&mesh, [6.0, 0.0, 8.0], [8.0, 10.0, 12.0]);
    let lower = within(&mesh, [0.0; 3], [12.0, 10.0, 4.0]);
    let is_upper = |element: &u32| !lower.contains(element) && !trench.contains(element);
    let upper = (0..mesh.element_count() as u32).filter(is_upper).collect();
    for (name, elements) in [
        ("trench", trench),
        ("lining", lining),
        ("inner", inner),
        ("lower", lower.clone()),
        ("upper", upper),
    ] {
        mesh.set_element_set(name, elements).unwrap();
    }
    mesh
}

pub(crate) const MATERIALS: &str = r#"
title = "trench"
[mesh]
file = "trench.msh"
[[material]]
name = "rock"
law = "elastic"
young = 2e9
poisson = 0.25
density = 2600
[[material]]
name = "concrete"
law = "elastic"
young = 25e9
poisson = 0.2
density = 2400
[[part]]
set = "lower"
material = "rock"
[[part]]
set = "upper"
material = "rock"
[[part]]
set = "inner"
material = "rock"
[[part]]
set = "lining"
material = "concrete"
[[load]]
kind = "gravity"
[in_situ_stress]
kind = "ground"
level = 12
density = 2600
lateral = 0.5
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "front", "back", "bottom"]
scatterer = [6, 5, 10]
[time]
duration = 0.4
[output]
every = 0.01
[[output.history]]
name = "corner"
at = [2, 4, 12]
"#;

pub(crate) const BOLTS: &str = r#"
[[bolt]]
name = "anchors"
diameter = 0.025
pretension = 5e4
pattern = { facets = "top", along = [0, 1, 0], spacing = [2, 2], length = 5 }
[[bolt]]
name = "nail"
section = 4e-4
young = 210e9
lines = [[[9, 5, 12], [10, 4, 6.5]]]
"#;

pub(crate) const ROLLERS: &str = r#"
[[stage]]
name = "ground"
part = [{ set = "lining", material = "rock" }]
support = [
    { kind = "roller", set = "left", normal = [1, 0, 0] },
    { kind = "roller", set = "right", normal = [1, 0, 0] },
    { kind = "roller", set = "front", normal = [0, 1, 0] },
    { kind = "roller", set = "back", normal = [0, 1, 0] },
    { kind = "roller", set = "bottom", normal = [0, 0, 1] },
]
"#;

pub(crate) const TRENCH: &str = r#"
[[stage]]
name = "trench"
excavate = ["trench"]
release = 0.6
increments = 2
bolts = ["nail"]
[[stage]]
name = "support"
tolerance = 1e-10
cast = ["lining"]
bolts = ["anchors"]
load = [{ kind = "pressure", set = "top", pressure = 2e4 }]
"#;

const PUSH: &str = r#"
[[load]]
kind = "nodal"
set = "top"
force = [1e4, 0, 0]
function = { kind = "ricker", frequency = 10, delay = 0.1 }
"#;

pub(crate) fn folder(mesh: &Mesh) -> Folder {
    let folder = Folder::new("stages");
    write_gmsh(folder.join("trench.msh"), mesh).unwrap();
    folder
}

pub(crate) fn read(folder: &Folder, text: &str) -> Result<Scene, Error> {
    let path = folder.join("trench.toml");
    FileScene::from_toml(text, path, &Registry::default()).map(FileScene::into_scene)
}

/// The scene without bolts and stages, composed in Rust.
fn ground(mesh: Mesh) -> Scene {
    let rock = Material::from(LinearElastic::new(ROCK));
    let concrete = Material::from(LinearElastic::new(CONCRETE));
    let corner = Vec3::new(2.0, 4.0, 12.0);
    let mut output = OutputPlan::default().history("corner", corner, Motion::ALL);
    output.every = 0.01;
    let field = StressField::geostatic(12.0, 2600.0 * 9.81, [0.5, 0.5]).unwrap();
    Scene::new("trench", mesh)
        .part(Part::new("lower", rock.clone()))
        .part(Part::new("upper", rock.clone()))
        .part(Part::new("inner", rock))
        .part(Part::new("lining", concrete))
        .gravity(Vec3::new(0.0, 0.0, -9.81), |_: f64| 1.0)
        .with_in_situ_stress(InSituStress::Field(field))
        .with_boundary(
            Boundary::new(ViscousSpring::default(), SIDES)
                .with_scatterer(Vec3::new(6.0, 5.0, 10.0)),
        )
        .with_duration(0.4)
        .with_output(output)
}

/// The first stage on rollers.
fn on_rollers(mesh: &Mesh) -> SceneStage {
    let axes = [Vec3::x(), Vec3::x(), Vec3::y(), Vec3::y(), Vec3::z()];
    let stage = SceneStage::new("ground").part("lining", Material::from(LinearElastic::new(ROCK)));
    SIDES.iter().zip(axes).fold(stage, |stage, (side, normal)| {
        let nodes = mesh.nodes_of_facets(mesh.facet_set(side).unwrap());
        stage.support(Support::roller(nodes, normal))
    })
}

/// Stages from a file equal those composed in Rust: same bits in the stages and in the run.
#[test]
fn stages_of_a_file_are_those_of_rust() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let text = [MATERIALS, PUSH, BOLTS, ROLLERS, TRENCH].concat();
    let file = run(read(&folder, &text).unwrap());
    let steel = |area: f64, young: f64, pretension: f64| BoltParameters {
        young,
        area,
        pretension,
        ..BoltParameters::steel(1.0).unwrap()
    };
    let top = mesh.facet_set("top").unwrap();
    // The remaining top surface where the trench is excavated and half of it is filled.
    let inner = mesh.element_set("inner").unwrap();
    let there = |facet: &&powerhouse::model::Facet| !inner.contains(&facet.element);
    let pressed: Vec<_> = top.iter().filter(there).copied().collect();
    let pressure = FacePressure::new(&mesh, &pressed, Profile::Uniform, Box::new(|_: f64| 2e4));
    let ricker = |t: f64| {
        let a = (core::f64::consts::PI * 10.0 * (t - 0.1)).powi(2);
        (1.0 - 2.0 * a) * (-a).exp()
    };
    let nodes = mesh.nodes_of_facets(top);
    let push = NodalForce::new(nodes, Vec3::new(1e4, 0.0, 0.0), Box::new(ricker));
    let twin = ground(mesh.clone())
        .load(push)
        .with_bolts(SceneBolts {
            name: "anchors".into(),
            layout: BoltLayout::Pattern {
                facets: "top".into(),
                pattern: BoltPattern {
                    along: Vec3::y(),
                    spacing: [2.0, 2.0],
                    length: 5.0,
                },
            },
            parameters: steel(0.25 * core::f64::consts::PI * 0.025_f64.powi(2), 200e9, 5e4),
        })
        .with_bolts(SceneBolts {
            name: "nail".into(),
            layout: BoltLayout::Lines(vec![BoltLine {
                head: Vec3::new(9.0, 5.0, 12.0),
                toe: Vec3::new(10.0, 4.0, 6.5),
            }]),
            parameters: steel(4e-4, 210e9, 0.0),
        })
        .stage(on_rollers(&mesh))
        .stage(
            SceneStage::new("trench")
                .excavate("trench")
                .install("nail")
                .with_options(
                    StaticOptions::default()
                        .with_release(0.6)
                        .with_increments(2),
                ),
        )
        .stage(
            SceneStage::new("support")
                .cast("lining")
                .install("anchors")
                .load(pressure.unwrap())
                .with_options(StaticOptions::default().with_tolerance(1e-10)),
        );
    let twin = run(twin);
    assert_eq!(file.stages, twin.stages);
    assert_eq!(file.hand_over, twin.hand_over);
    assert_eq!(file.histories(), twin.histories());
    assert_eq!(file.bolts, twin.bolts);
    let [ground, trench, support] = &file.stages[..] else {
        panic!("{:?}", file.stages)
    };
    // The in-situ stress is in equilibrium with gravity; only the push, constant with its initial value, moves the body.
    assert!(ground.largest_displacement.0 < 1e-7, "{ground:?}");
    assert_eq!(
        (trench.excavated, trench.cast, trench.solution.increments),
        (20, 0, 2)
    );
    assert!(trench.largest_displacement.0 > 1e-5, "{trench:?}");
    assert_eq!((support.excavated, support.cast), (0, 10));
    assert!(support.solution.residual <= 1e-10);
    let moves = file.histories().column("corner.ux").unwrap();
    assert!(moves.values.iter().any(|u| u.abs() > 1e-5));
    let [nail, anchors] = &file.bolts[..] else {
        panic!("{:?}", file.bolts)
    };
    assert_eq!(
        (nail.name.as_str(), anchors.name.as_str()),
        ("nail", "anchors")
    );
    assert!(anchors.greatest().unwrap().1 > 4e4);
}

/// After stages with excavation, lining, bolts, a load and a seam the body does not move when its supports become
/// absorbing faces without input; its stress is that of the ground. The same holds for a seam through periodic sides.
#[test]
fn a_staged_body_without_input_does_not_move() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let seam = r#"
[[joint]]
name = "seam"
between = ["lower", "upper"]
law = "bonded-coulomb"
static_friction = 0.7
"#;
    let stressed = "quantities = [\"displacement\", \"velocity\", \"stress\"]";
    let text = [MATERIALS, BOLTS, seam, ROLLERS, TRENCH].concat();
    let text = text.replace("at = [2, 4, 12]", &format!("at = [2, 4, 0]\n{stressed}"));
    let text = text.replace("duration = 0.4", "duration = 3");
    let mut endless = text.clone();
    for (old, new) in [
        (r#""front", "back", "#, ""),
        (
            r#"    { kind = "roller", set = "back", normal = [0, 1, 0] },"#,
            "",
        ),
        (
            "[time]",
            "[[support]]\nkind = \"periodic\"\nfrom = \"front\"\nto = \"back\"\n[time]",
        ),
    ] {
        assert!(endless.contains(old), "{old}");
        endless = endless.replace(old, new);
    }
    for text in [text, endless] {
        let found = run(read(&folder, &text).unwrap());
        assert!(found.run.steps > 1000, "{}", found.run.steps);
        for component in ["ux", "uy", "uz", "vx", "vy", "vz"] {
            let column = found
                .histories()
                .column(&format!("corner.{component}"))
                .unwrap();
            let most = column
                .values
                .iter()
                .fold(0.0_f64, |most, v| most.max(v.abs()));
            assert!(most < 1e-10, "{component}: {most:e}");
        }
        let weight = 2600.0 * 9.81 * 11.0;
        let vertical = found.histories().column("corner.zz").unwrap().values[0];
        assert!(
            (vertical / -weight - 1.0).abs() < 0.3,
            "{vertical:e} {weight:e}"
        );
        assert!(found.hand_over.unwrap().difference < 1e-9);
        assert!(found.joints[0].records.iter().all(|r| r.state.slip == 0.0));
    }
}

/// Recorded result of a stage.
struct Seen {
    name: String,
    stress: Vec<Stress>,
    absent: usize,
    /// Number of node pairs of joints with bond.
    bonded: usize,
}

/// Sink that records all stages.
#[derive(Default)]
struct Shown(Arc<Mutex<Vec<Seen>>>);

impl StageSink for Shown {
    fn completed(&mut self, stage: &CompletedStage) -> Result<(), Error> {
        let joints = stage.state.joints.iter();
        let records = joints.flat_map(|joint| &joint.records);
        let seen = Seen {
            name: stage.report.name.clone(),
            stress: stage.stress.to_vec(),
            absent: stage.state.absent.len(),
            bonded: records
                .filter(|record| record.state.bond == Bond::Intact)
                .count(),
        };
        self.0.lock().unwrap().push(seen);
        Ok(())
    }
}

/// Runs a scene; returns the recorded stages and the results.
fn seen(scene: Scene) -> (Vec<Seen>, Results) {
    let shown = Shown::default();
    let kept = shown.0.clone();
    let hooks = RunHooks::default().with_stages(Box::new(shown));
    let found = scene.prepare().unwrap().run(hooks).unwrap();
    let kept = core::mem::take(&mut *kept.lock().unwrap());
    (kept, found)
}

/// The result of a stage contains the in-situ stress, the active elements and the bolts; elements that are first cast in
/// a stage are inactive before.
#[test]
fn stages_are_shown_as_they_reach_equilibrium() {
    let mesh = mesh();
    let field = StressField {
        surface: 12.0,
        at_surface: Stress([-1e4, -2e4, 0.0, 0.0, 0.0, 0.0]),
        gradient: Stress([-1.2e4, -1.5e4, -2600.0 * 9.81, 0.0, 0.0, 0.0]),
        ends: false,
    };
    let scene = ground(mesh.clone())
        .with_in_situ_stress(InSituStress::Elements(field.of_elements(&mesh)))
        .stage(on_rollers(&mesh))
        .stage(
            SceneStage::new("filled")
                .cast("inner")
                .part("lining", Material::from(LinearElastic::new(CONCRETE))),
        );
    let overviews = scene.stage_overviews().unwrap();
    let counts: Vec<[usize; 4]> = (overviews.iter())
        .map(|stage| [stage.excavated, stage.cast, stage.present, stage.supports])
        .collect();
    assert_eq!(counts, [[0, 0, 170, 5], [0, 10, 180, 0]]);
    assert_eq!(
        overviews[0].materials,
        [("lining".into(), "linear-elastic".into())]
    );
    let (kept, _) = seen(scene);
    let [ground, filled] = &kept[..] else {
        panic!("{} stages", kept.len())
    };
    assert_eq!((ground.name.as_str(), ground.absent), ("ground", 10));
    assert_eq!((filled.name.as_str(), filled.absent), ("filled", 0));
    // At the foot of a far corner, where the effect of the trench is small.
    let foot = mesh.elements_in_box(&Vec3::zeros(), &Vec3::repeat(2.0))[0];
    let expected = field.at(&mesh.centroid(foot));
    for (found, expected) in ground.stress[foot as usize]
        .0
        .iter()
        .zip(expected.0)
        .take(3)
    {
        assert!(
            (found - expected).abs() < 0.2 * expected.abs(),
            "{found:e} {expected:e}"
        );
    }
    // Cast elements have no in-situ stress: at their top, where their own weight is small, less than half of it.
    let inner = mesh.element_set("inner").unwrap();
    for &element in inner {
        assert_eq!(ground.stress[element as usize], Stress::default());
        let place = mesh.centroid(element);
        if place.z > 10.0 {
            let (found, of_ground) = (filled.stress[element as usize], field.at(&place));
            assert!(found.0[0] > 0.5 * of_ground.0[0], "{found:?} {of_ground:?}");
        }
    }
}

/// A stage without static equilibrium ends the run with an error at its position in the file.
#[test]
fn a_stage_without_rest_is_named() {
    let folder = folder(&mesh());
    let floating = "[[stage]]\nname = \"ground\"\n[[stage]]\nname = \"more\"\n";
    let text = [MATERIALS, floating].concat();
    let simulation = read(&folder, &text).unwrap().prepare().unwrap();
    let Err(Error::Scene(fault)) = simulation.run(RunHooks::default()) else {
        panic!("a body without supports reached equilibrium")
    };
    let line = text
        .lines()
        .position(|line| line == "name = \"ground\"")
        .unwrap()
        + 1;
    assert_eq!(fault.position(), (line, 8), "{fault}");
    assert!(fault.to_string().contains("freely"), "{fault}");
    let error = Error::from(*fault);
    assert!(
        matches!(
            error.equilibrium_failure(),
            Some(("ground", StaticError::Floating { .. }))
        ),
        "{error}"
    );
}

/// Joints may be tied in a stage whatever their law, and then have the initial state of their law; they may be grouted
/// where the bond was missing.
#[test]
fn stages_close_joints() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let slippery = r#"
[[joint]]
name = "seam"
between = ["lower", "upper"]
law = "frictionless"
"#;
    let pairs = 7 * 6;
    // With its own material from the start, so that nothing changes at the start of the run.
    let rollers = ROLLERS.replace("part = [{ set = \"lining\", material = \"rock\" }]\n", "");
    let text = [MATERIALS, slippery, &rollers].concat();
    let tied = text.replace("name = \"ground\"", "name = \"ground\"\ntied = [\"seam\"]");
    let (kept, found) = seen(read(&folder, &tied).unwrap());
    assert_eq!(kept[0].bonded, pairs);
    let joint = &found.joints[0];
    assert_eq!(
        (joint.law.as_str(), joint.records.len()),
        ("frictionless", pairs)
    );
    assert!(
        joint
            .records
            .iter()
            .all(|record| record.state.bond == Bond::Never)
    );
    assert!(joint.records.iter().all(|record| record.traction.x < 0.0));

    let grouted = r#"
[[joint]]
name = "seam"
between = ["lower", "upper"]
law = "bonded-coulomb"
cohesion = 1e6
tensile_strength = 1e6
static_friction = 0.7
unbonded = [{ low = [0, 0, 0], high = [6, 10, 12] }]
"#;
    let bonds = |stages: &str| -> usize {
        let text = [MATERIALS, grouted, &rollers, stages].concat();
        let found = run(read(&folder, &text).unwrap());
        let records = found.joints[0].records.iter();
        records
            .filter(|record| record.state.bond == Bond::Intact)
            .count()
    };
    let without = bonds("");
    assert!(without > 0 && without < pairs, "{without}");
    assert_eq!(
        bonds("[[stage]]\nname = \"grout\"\ngrouted = [\"seam\"]\n"),
        pairs
    );
}

/// Stage results are written beside the results, and removed before another run writes there.
#[test]
fn stages_are_written() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let seam = r#"
[[joint]]
name = "the seam"
between = ["lower", "upper"]
law = "tied"
"#;
    let text = [MATERIALS, BOLTS, seam, ROLLERS, TRENCH].concat();
    let simulation = read(&folder, &text).unwrap().prepare().unwrap();
    let out = ResultFolder::new(folder.join("out"));
    let (mesh, planned) = (
        simulation.mesh().clone(),
        powerhouse::result_files(&simulation),
    );
    let notes = RunNotes::new(simulation.remarks().to_vec());
    let hooks = RunHooks::default().with_stages(out.stages(&simulation).unwrap());
    let found: Results = simulation.run(hooks).unwrap();
    let written = out.write(("trench", &mesh), &found, &notes, None).unwrap();
    // Every file is in the list of expected files, so that it can be tested before the run.
    for file in &written {
        let name = file.strip_prefix(out.path()).unwrap().to_string_lossy();
        assert!(planned.contains(&name.clone().into_owned()), "{name}");
    }
    let file = |name: &str| out.path().join(name);
    for name in [
        "stages/1-ground.vtu",
        "stages/2-trench.vtu",
        "stages/2-trench-nail.csv",
        "stages/3-support.vtu",
        "stages/3-support-the-seam.vtu",
        "bolts/anchors.csv",
        "bolts.csv",
        "plots/bolts-anchors.svg",
    ] {
        assert!(
            file(name).metadata().is_ok_and(|data| data.len() > 0),
            "{name}"
        );
    }
    assert!(!file("stages/1-ground-nail.csv").exists());
    let table = read_table(&file("stages/3-support-anchors.csv")).unwrap();
    let names: Vec<&str> = table.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["bolt", "element", "from", "to", "axial force"]);
    let lengths = table[3].values.iter().zip(&table[2].values);
    let whole: f64 = lengths.map(|(to, from)| to - from).sum();
    let bolts = table[0].values.last().unwrap();
    assert!((whole - 5.0 * bolts).abs() < 1e-6, "{whole} {bolts}");
    // The run starts from the last stage, and its greatest force is that of its bolts.
    let history = read_table(&file("bolts.csv")).unwrap();
    let anchors = history
        .iter()
        .find(|column| column.name == "anchors.greatest");
    let anchors = &anchors.unwrap().values;
    let most = |values: &[f64]| values.iter().copied().fold(f64::MIN, f64::max);
    assert_eq!(anchors[0], most(&table[4].values));
    let table = read_table(&file("bolts/anchors.csv")).unwrap();
    assert_eq!(table[5].name, "greatest force");
    assert_eq!(most(&table[5].values), most(anchors));
    let summary = std::fs::read_to_string(file("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let of_run = summary["bolts"][1]["greatest_of_run"].as_f64().unwrap();
    assert!((of_run / most(anchors) - 1.0).abs() < 1e-12, "{of_run}");
    assert_eq!(summary["stages"][1]["excavated"], 20);
    assert!(summary["hand_over"]["standing"].as_f64().unwrap() > 1e5);
    assert_eq!(summary["bolts"][0]["name"], "nail");
    out.clear().unwrap();
    assert!(!file("stages/1-ground.vtu").exists() && !file("bolts/anchors.csv").exists());
    assert!(!file("bolts.csv").exists());
    assert!(!file("stages/2-trench-nail.csv").exists());
}

/// Invalid stages of a scene composed in Rust are errors with their name before the run.
#[test]
fn misfits_of_stages_are_refused() {
    let mesh = mesh();
    let refused = |scene: Scene| match scene.prepare() {
        Err(Error::Staging { stage, source }) => (stage, source),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("accepted"),
    };
    let (_, source) = refused(ground(mesh.clone()));
    assert!(matches!(source, StagingError::NoStage { .. }), "{source}");
    let start = powerhouse::InitialMotion::Field;
    let (_, source) = refused(
        ground(mesh.clone())
            .stage(on_rollers(&mesh))
            .with_start_time(0.0)
            .with_initial_motion(start),
    );
    assert_eq!(source, StagingError::InMotion);
    let few = InSituStress::Elements(vec![Stress::default(); 3]);
    let (_, source) = refused(
        ground(mesh.clone())
            .with_in_situ_stress(few)
            .stage(on_rollers(&mesh)),
    );
    let (found, expected) = (3, 180);
    assert_eq!(source, StagingError::StressCount { found, expected });
    let own = powerhouse::contact::TiedPairs::new("own tie", &[[0, 1]]).unwrap();
    let (_, source) = refused(
        ground(mesh.clone())
            .stage(on_rollers(&mesh))
            .constraint(own),
    );
    assert!(matches!(source, StagingError::Constraint { name } if name == "own tie"));
    let (stage, source) = refused(
        ground(mesh.clone())
            .stage(on_rollers(&mesh))
            .stage(SceneStage::new("again").excavate("trench"))
            .stage(SceneStage::new("once more").excavate("inner")),
    );
    assert_eq!(stage.as_deref(), Some("once more"));
    assert!(matches!(source, StagingError::NotActive { set, .. } if set == "inner"));
    let split = mesh.split_between(
        mesh.element_set("lower").unwrap(),
        mesh.element_set("upper").unwrap(),
    );
    let split = split.unwrap();
    let options = SurfaceOptions::within(1e-6).unwrap();
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options);
    let law = BondedCoulomb::unbonded(0.7, 0.7).unwrap();
    let joint = SceneJoint::new("seam", surface.unwrap(), law).with_preload(Preload::Pressure(1e5));
    let (_, source) = refused(
        ground(split.mesh.clone())
            .joint(joint)
            .stage(on_rollers(&split.mesh)),
    );
    assert!(matches!(source, StagingError::Preload { joint } if joint == "seam"));
}

/// A stage that fails leaves the results of those before it: their files, and a summary with the error that lists them.
#[test]
fn a_failed_stage_leaves_the_results_of_those_before() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let seam = r#"
[[joint]]
name = "seam"
between = ["lower", "upper"]
law = "bonded-coulomb"
static_friction = 0.7
"#;
    let pulled = r#"
[[stage]]
name = "pulled"
load = [{ kind = "traction", set = "top", traction = [0, 0, 5e6] }]
"#;
    let text = [MATERIALS, BOLTS, seam, ROLLERS, TRENCH, pulled].concat();
    let simulation = read(&folder, &text).unwrap().prepare().unwrap();
    let results = ResultFolder::new(folder.join("out"));
    results.begin(&simulation).unwrap();
    let completed = Arc::new(Mutex::new(Vec::new()));
    let reports = completed.clone();
    let hooks = RunHooks::default()
        .with_stages(results.stages(&simulation).unwrap())
        .with_stage_hook(move |body| *reports.lock().unwrap() = body.stages().to_vec());
    let error = simulation.run(hooks).unwrap_err();
    assert!(matches!(error, Error::Scene(_)), "{error}");
    let completed = completed.lock().unwrap();
    results.fail("trench", &error, &completed).unwrap();
    let text = std::fs::read_to_string(folder.join("out/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["ended"], "failed");
    assert_eq!(summary["failure"], error.to_string());
    let names = |key: &str, of: fn(&serde_json::Value) -> String| -> Vec<String> {
        summary[key].as_array().unwrap().iter().map(of).collect()
    };
    let name = |stage: &serde_json::Value| stage["name"].as_str().unwrap().to_owned();
    assert_eq!(names("stages", name), ["ground", "trench", "support"]);
    let files = names("files", |file| file.as_str().unwrap().to_owned());
    for file in [
        "1-ground.vtu",
        "2-trench.vtu",
        "3-support.vtu",
        "3-support-anchors.csv",
    ] {
        let file = format!("stages/{file}");
        assert!(
            files.contains(&file) && folder.join("out").join(&file).exists(),
            "{file}"
        );
    }
}
