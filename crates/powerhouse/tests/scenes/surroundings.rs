//! Checks of the surroundings: start of the field, its medium, open sides, free surface.

use std::sync::Arc;

use powerhouse::boundary::{InputMode, Viscous, ViscousSpring};
use powerhouse::contact::{JointSurface, SurfaceOptions, Tied};
use powerhouse::engine::{EngineError, FacePressure, Profile, Rayleigh, SolidKernel, Support};
use powerhouse::io::write_gmsh;
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{Facet, FieldMotion, IncidentField, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, Site, SmoothPulse, WaveKind, ZeroMeanPulse,
};
use powerhouse::{
    Boundary, Error, FileScene, InitialMotion, Material, Part, Registry, Remark, RenderFault as _,
    Scene, SceneJoint, Simulation, remark,
};

use super::support::*;

/// A scene from the text of the cube with some passages replaced.
fn read(name: &str, changes: &[(&str, &str)]) -> Result<Scene, Error> {
    let folder = Folder::new(name);
    write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
    let mut text = CUBE.to_owned();
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replacen(old, new, 1);
    }
    FileScene::from_toml(text, folder.join("cube.toml"), &Registry::default())
        .map(FileScene::into_scene)
}

fn padding(scene: &Scene) -> Option<f64> {
    scene.remarks().iter().find_map(|remark| match remark {
        Remark::QuietStart(remark::QuietStart { padding, .. }) => Some(*padding),
        _ => None,
    })
}

const PAST: &str = "[[wave]]\nkind = \"sv\"\nincidence = 42\npulse = { kind = \"zero-mean\", displacement = 0.01, duration = 0.4 }\n";
const BELOW: &str = "[[wave]]\nkind = \"p\"\nincidence = 10\narrival = 0.3\npulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 }\n";

/// If one wave must be delayed so that the body starts at rest, all are delayed by the same time: their sum is that of
/// the delayed wave and the other one with the same shift.
#[test]
fn a_quiet_start_keeps_waves_in_step() {
    let past = read("step-past", &[(WAVE, PAST)]).unwrap();
    let below = read("step-below", &[(WAVE, BELOW)]).unwrap();
    let both = read("step-both", &[(WAVE, &[PAST, BELOW].concat())]).unwrap();
    assert_eq!(padding(&below), None);
    let later = padding(&both).unwrap();
    assert!(later > 0.1, "{later}");
    assert_eq!(padding(&past), Some(later));
    let points = [Vec3::new(150.0, 150.0, 0.0), Vec3::new(20.0, 70.0, -200.0)];
    let motion = |scene: &Scene, time: f64| {
        let sampler = scene.field().unwrap().prepare(&points).unwrap();
        let mut motion = [FieldMotion::default(); 2];
        sampler.add_motion(time, &mut motion);
        motion.map(|m| m.displacement)
    };
    let mut largest = 0.0_f64;
    for time in [0.1, 0.2, 0.3, 0.4, 0.5, 0.6].map(|t| t + later) {
        let (past, below) = (motion(&past, time), motion(&below, time - later));
        for ((sum, past), below) in motion(&both, time).iter().zip(past).zip(below) {
            assert!((sum - (past + below)).norm() < 1e-12, "{time}: {sum}");
            largest = largest.max(below.norm().min(past.norm()));
        }
    }
    assert!(largest > 1e-3, "both move: {largest}");
}

/// A body that starts at rest in a field that is not negligible is an error, at the key concerned; with the initial
/// motion of the field it is accepted.
#[test]
fn a_moving_field_is_no_start_from_rest() {
    for (name, old, new, key) in [
        ("early-start", "[time]\n", "[time]\nstart = 0.25\n", "start"),
        (
            "early-arrival",
            "azimuth = 30\n",
            "arrival = -0.2\n",
            "arrival",
        ),
        (
            "early-reference",
            "azimuth = 30\n",
            "reference = [150, 150, -50]\n",
            "reference",
        ),
    ] {
        let Err(Error::Scene(fault)) = read(name, &[(old, new)]) else {
            panic!("{name} was accepted")
        };
        let (line, _) = fault.position();
        let shown = fault.render(false);
        assert!(shown.contains("starts at rest"), "{shown}");
        assert!(shown.contains("initial = \"field\""), "{shown}");
        assert!(shown.contains(&format!("{line} | {key} =")), "{shown}");
        let with_field = "duration = 0.6\ninitial = \"field\"";
        assert!(read(name, &[(old, new), ("duration = 0.6", with_field)]).is_ok());
    }
    // A wave that is early but still negligible is accepted.
    let quiet = "arrival = -0.0005\n";
    assert!(read("early-quiet", &[("azimuth = 30\n", quiet)]).is_ok());
}

/// Motion before the start of a record, from a filter or for a within motion, delays all waves.
#[test]
fn what_precedes_a_record_is_waited_for() {
    for (name, treatment) in [
        (
            "lead",
            "baseline = { kind = \"high-pass\", corner = 0.5, order = 2 }\nconvention = \"incident\"",
        ),
        (
            "within",
            "convention = { within = { depth = 60, component = \"x\", regularisation = 0.2 } }",
        ),
    ] {
        let folder = Folder::new(name);
        write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
        let sine =
            |i: usize| (0.2 * i as f64).sin() * (std::f64::consts::PI * i as f64 / 314.0).sin();
        let lines: Vec<String> = (0..=314).map(|i| format!("{}", sine(i))).collect();
        std::fs::write(folder.join("r.txt"), lines.join("\n")).unwrap();
        let record = format!(
            "[[record]]\nname = \"r\"\nfile = \"r.txt\"\nunits = \"m/s2\"\ntime_step = 0.01\nend_displacement = 0\n{treatment}\n"
        );
        let record = if name == "lead" {
            record
        } else {
            record.replace(
                "end_displacement = 0",
                "baseline = { kind = \"velocity-polynomial\", order = 3 }",
            )
        };
        let wave = "[[wave]]\nkind = \"sv\"\nincidence = 20\nrecord = \"r\"\n";
        let text = CUBE.replace(WAVE, &[&record, wave].concat());
        let scene = FileScene::from_toml(text, folder.join("s.toml"), &Registry::default())
            .unwrap()
            .into_scene();
        assert!(
            padding(&scene).unwrap() > 0.05,
            "{name}: {:?}",
            padding(&scene)
        );
        scene.prepare().unwrap();
    }
}

fn vertical(kind: WaveKind) -> PlaneWaveParameters {
    let mut parameters = PlaneWaveParameters::vertical(kind, ROCK, 0.0);
    parameters.reference = Vec3::new(0.0, 0.0, -300.0);
    parameters
}

fn wave(parameters: PlaneWaveParameters) -> PlaneWave {
    PlaneWave::new(parameters, Arc::new(SmoothPulse::new(0.01, 0.4).unwrap())).unwrap()
}

fn scene_of(field: impl IncidentField + 'static, faces: &[&str]) -> Scene {
    Scene::new("cube", cube())
        .part(Part::new("rock", Material::from(LinearElastic::new(ROCK))))
        .with_field(field)
        .with_boundary(Boundary::new(
            ViscousSpring::default(),
            faces.iter().copied(),
        ))
        .with_duration(0.6)
}

fn warnings(simulation: &Simulation) -> Vec<&Remark> {
    let remarks = simulation.remarks().iter();
    remarks.filter(|remark| remark.is_warning()).collect()
}

/// Scenes composed in Rust have the checks of scenes from files: start, medium, damped rims.
#[test]
fn composed_scenes_are_guarded_too() {
    let scene = || scene_of(wave(vertical(WaveKind::SV)), &SIDES);
    assert!(warnings(&scene().prepare().unwrap()).is_empty());
    let early = scene()
        .with_start_time(0.2)
        .with_initial_motion(InitialMotion::Rest)
        .prepare();
    assert!(matches!(
        early,
        Err(Error::NotAtRest { level, time: 0.2, .. }) if level > 0.1
    ));
    assert!(
        scene()
            .with_start_time(0.2)
            .with_initial_motion(InitialMotion::Field)
            .prepare()
            .is_ok()
    );
    // Past the critical angle the field begins before its pulse.
    let mut parameters = vertical(WaveKind::SV);
    parameters.incidence = Angle::from_degrees(42.0);
    let pulse = Arc::new(ZeroMeanPulse::new(0.01, 0.4).unwrap());
    let forerunner = PlaneWave::new(parameters, pulse).unwrap();
    assert!(matches!(
        scene_of(forerunner, &SIDES).prepare(),
        Err(Error::NotAtRest { .. })
    ));
    let mut parameters = vertical(WaveKind::SV);
    parameters.medium = media::CONCRETE;
    let foreign = scene_of(wave(parameters), &SIDES).prepare();
    assert!(matches!(foreign, Err(Error::ForeignMedium { count, .. }) if count > 100));
    let damping = Rayleigh {
        mass: 0.1,
        stiffness: 0.0,
    };
    let damped = Scene::new("damped", cube())
        .part(Part::new("rock", Material::from(LinearElastic::new(ROCK))).with_damping(damping))
        .with_field(wave(vertical(WaveKind::P)))
        .with_boundary(Boundary::new(ViscousSpring::default(), SIDES))
        .prepare()
        .unwrap();
    let rim = Remark::from(remark::DampedRim { set: "rock".into() });
    assert_eq!(warnings(&damped), [&rim]);
    // No scatterer is given.
    let position = Vec3::new(150.0, 150.0, -150.0);
    assert!(
        damped
            .remarks()
            .contains(&Remark::from(remark::Scatterer { position }))
    );
}

/// A side that is neither absorbing nor supported has a warning with its area; a supported one has none.
#[test]
fn a_forgotten_side_is_warned_of() {
    let open = scene_of(
        wave(vertical(WaveKind::SV)),
        &["left", "right", "front", "bottom"],
    );
    let simulation = open.prepare().unwrap();
    let found = warnings(&simulation);
    let [Remark::OpenSide(remark::OpenSide { side: "back", area })] = found[..] else {
        panic!("{found:?}")
    };
    assert!((area - 9e4).abs() < 1e-6, "{area}");
    let mesh = cube();
    let back = mesh.nodes_of_facets(mesh.facet_set("back").unwrap());
    let held = scene_of(
        wave(vertical(WaveKind::SV)),
        &["left", "right", "front", "bottom"],
    )
    .support(Support::roller(back, Vec3::y()));
    assert!(warnings(&held.prepare().unwrap()).is_empty());
}

/// A field whose free surface is not that of the mesh, or that has none, has a warning; so has a mesh whose surface is
/// not plane along the absorbing faces, but not a hill inside.
#[test]
fn the_surface_of_the_field_is_that_of_the_mesh() {
    let share = |scene: Scene| {
        let simulation = scene.prepare().unwrap();
        match warnings(&simulation)[..] {
            [] => None,
            [Remark::LoadedSurface(remark::LoadedSurface { share, .. })] => Some(*share),
            ref others => panic!("{others:?}"),
        }
    };
    let field = |incidence: f64, surface: f64| {
        let mut parameters = vertical(WaveKind::P);
        parameters.incidence = Angle::from_degrees(incidence);
        parameters.site = Site::HalfSpace { surface };
        wave(parameters)
    };
    assert_eq!(share(scene_of(field(30.0, 0.0), &SIDES)), None);
    assert!(share(scene_of(field(30.0, 40.0), &SIDES)).unwrap() > 0.3);
    let mut parameters = vertical(WaveKind::P);
    parameters.site = Site::FullSpace;
    assert!(share(scene_of(wave(parameters), &SIDES)).unwrap() > 0.3);
    let six = ["left", "right", "front", "back", "bottom", "top"];
    assert_eq!(share(scene_of(wave(parameters), &six)), None);
    // A valley of 20 m along the left side, and one in the middle.
    let valley = |at: f64| {
        let lowered = |x: Vec3| {
            let share = (1.0 - (x.x - at).abs() / 100.0).max(0.0);
            x - Vec3::new(0.0, 0.0, 20.0 * share * (1.0 + x.z / 300.0))
        };
        let mesh = cube().map_positions(lowered).unwrap();
        let rock = Material::from(LinearElastic::new(ROCK));
        Scene::new("valley", mesh)
            .part(Part::new("rock", rock).with_kernel(SolidKernel::Hex8Full))
            .with_field(field(30.0, 0.0))
            .with_boundary(Boundary::new(Viscous::default(), SIDES))
            .with_duration(0.6)
    };
    assert!(share(valley(0.0)).unwrap() > 0.03);
    let hidden = cube().map_positions(|x| {
        let share = (1.0 - (x.x - 150.0).abs() / 100.0) * (1.0 - (x.y - 150.0).abs() / 100.0);
        let inside = (x.x - 150.0).abs() < 100.0 && (x.y - 150.0).abs() < 100.0;
        let share = if inside { share } else { 0.0 };
        x - Vec3::new(0.0, 0.0, 20.0 * share * (1.0 + x.z / 300.0))
    });
    let inside = Scene::new("hollow", hidden.unwrap())
        .part(Part::new("rock", Material::from(LinearElastic::new(ROCK))))
        .with_field(field(30.0, 0.0))
        .with_boundary(Boundary::new(Viscous::default(), SIDES))
        .with_duration(0.6);
    assert_eq!(share(inside), None);
}

/// The sides of a joint that reaches the absorbing faces, level, steep or folded, are no free surface on which the field would have
/// to be free of traction.
#[test]
fn sides_of_a_joint_are_no_free_surface() {
    let planes: [fn(Vec3) -> f64; 3] = [
        |x| x.z + 160.0,
        |x| x.x - 130.0,
        |x| (x.z + 160.0).max(130.0 - x.x),
    ];
    for plane in planes {
        let mut mesh = cube();
        let elements = 0..mesh.element_count() as u32;
        let (below, above): (Vec<u32>, Vec<u32>) =
            elements.partition(|&e| plane(mesh.centroid(e)) < 0.0);
        let split = mesh.split_between(&below, &above).unwrap();
        mesh = split.mesh;
        let options = SurfaceOptions::within(1e-6).unwrap();
        let surface = JointSurface::between(&mesh, &split.first, &split.second, &options).unwrap();
        let scene = Scene::new("jointed", mesh)
            .part(Part::new("rock", Material::from(LinearElastic::new(ROCK))))
            .joint(SceneJoint::new("joint", surface, Tied))
            .with_field(wave(vertical(WaveKind::SV)))
            .with_boundary(Boundary::new(Viscous::default(), SIDES))
            .with_duration(0.6);
        let simulation = scene.prepare().unwrap();
        let loaded = |remark: &&Remark| matches!(remark, Remark::LoadedSurface(_));
        assert_eq!(simulation.remarks().iter().find(loaded), None);
    }
}

/// A set inside the body contains its facets from both sides: a pressure on it would cancel, so that it is an error, in a
/// file at the set.
#[test]
fn loads_on_both_sides_are_refused() {
    let mesh = cube();
    let half = |left: bool| {
        let facets = mesh.boundary_facets_of(|e| (mesh.centroid(e).x < 150.0) == left);
        let inside = |f: &Facet| (mesh.facet_geometry(*f).centroid.x - 150.0).abs() < 1e-6;
        facets.into_iter().filter(inside).collect::<Vec<_>>()
    };
    let mut divided = mesh.clone();
    divided.set_facet_set("middle", half(true)).unwrap();
    let folder = Folder::new("both-sides");
    write_gmsh(folder.join("cube.msh"), &divided).unwrap();
    for load in [
        "kind = \"pressure\"\npressure = 1e5\n",
        "kind = \"traction\"\ntraction = [1, 0, 0]\n",
    ] {
        let load = format!("[[load]]\n{load}set = \"middle\"\n[time]");
        let text = CUBE.replace("[time]", &load);
        let read = FileScene::from_toml(text, folder.join("s.toml"), &Registry::default())
            .map(FileScene::into_scene);
        let Err(Error::Scene(fault)) = read else {
            panic!("{load} was accepted")
        };
        let shown = fault.render(false);
        assert!(shown.contains("both sides"), "{shown}");
        assert!(shown.contains("set = \"middle\""), "{shown}");
    }
    let pressed = |facets: &[Facet]| {
        FacePressure::new(&mesh, facets, Profile::Uniform, Box::new(|_: f64| 1.0)).err()
    };
    assert_eq!(pressed(&half(true)), None);
    let both = [half(true), half(false)].concat();
    assert!(matches!(
        pressed(&both),
        Some(EngineError::BothSides { .. })
    ));
}

/// Absorbing faces must be on the surface, and a field needs faces or a region through which it enters.
#[test]
fn faces_inside_and_idle_fields_are_refused() {
    let mut mesh: Mesh = cube();
    let left_half = mesh.boundary_facets_of(|element| mesh.centroid(element).x < 150.0);
    let in_middle = |facet: &Facet| (mesh.facet_geometry(*facet).centroid.x - 150.0).abs() < 1e-6;
    let middle = left_half.into_iter().filter(in_middle).collect();
    mesh.set_facet_set("middle", middle).unwrap();
    let rock = || Part::new("rock", Material::from(LinearElastic::new(ROCK)));
    let inner = Scene::new("inner", mesh)
        .part(rock())
        .with_boundary(Boundary::new(Viscous::default(), ["middle"]));
    let refused = inner.prepare().err();
    assert!(matches!(refused, Some(Error::InnerFacet { face, .. }) if face == "middle"));
    let idle = Scene::new("idle", cube())
        .part(rock())
        .with_field(wave(vertical(WaveKind::SV)));
    assert!(matches!(idle.prepare(), Err(Error::UnusedField { .. })));
    let silent = Viscous {
        input: InputMode::Nothing,
    };
    let silent = Scene::new("silent", cube())
        .part(rock())
        .with_field(wave(vertical(WaveKind::SV)))
        .with_boundary(Boundary::new(silent, SIDES));
    assert!(matches!(silent.prepare(), Err(Error::UnusedField { .. })));
    // In a file the same error is at the wave.
    let nothing = "kind = \"viscous-spring\"\ninput = \"nothing\"";
    let scene = read("nothing", &[("kind = \"viscous-spring\"", nothing)]).unwrap();
    let Err(Error::Scene(fault)) = scene.prepare() else {
        panic!("an idle wave was accepted")
    };
    assert!(fault.render(false).contains("incidence = 20"), "{fault}");
}
