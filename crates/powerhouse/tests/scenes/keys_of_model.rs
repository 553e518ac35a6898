//! Supports, loads, time and boundary: every key of a scene file is equivalent to its counterpart in Rust.

use core::f64::consts::{PI, TAU};

use powerhouse::boundary::{AxisParameters, InputMode, Spreading, Viscous, ViscousSpring};
use powerhouse::engine::{
    FacePressure, FaceTraction, NodalForce, OneSided, PeriodicPairs, Precision, Prescribed,
    Profile, Rayleigh, SolidKernel, Support,
};
use powerhouse::material::LinearElastic;
use powerhouse::model::{Facet, TimeFunction, Vec3};
use powerhouse::{Boundary, InitialMotion, Material, Part, Scene, TimeStep};

use super::support::*;

fn facets(set: &str) -> Vec<Facet> {
    cube().facet_set(set).unwrap().to_vec()
}

fn nodes(set: &str) -> Vec<u32> {
    let mesh = cube();
    mesh.nodes_of_facets(mesh.facet_set(set).unwrap())
}

type Function = Box<dyn TimeFunction>;

fn ramp() -> Function {
    Box::new(|t: f64| (t / 0.1).clamp(0.0, 1.0))
}

fn sine() -> Function {
    Box::new(|t: f64| (TAU * 4.0 * t).sin())
}

fn ricker() -> Function {
    Box::new(|t: f64| {
        let a = (PI * 5.0 * (t - 0.2)).powi(2);
        (1.0 - 2.0 * a) * (-a).exp()
    })
}

/// Every load and function of time of a file equals that of the engine.
#[test]
fn loads() {
    let variants = Variants::new("loads");
    let mesh = cube();
    let water = |density: f64, level: f64| Profile::Depth {
        gradient: density * 9.81,
        level,
    };
    let table = |t: f64| 2e5 * (t / 0.2).min(1.0);
    let down = Vec3::new(0.0, 0.0, -9.81);
    let traction = Vec3::new(1e5, 0.0, -2e5);
    let pressure = |set: &str, profile, history| {
        cube_scene().load(FacePressure::new(&mesh, &facets(set), profile, history).unwrap())
    };
    let pulled = |profile, history| {
        let load = FaceTraction::new(&mesh, &facets("top"), traction, profile, history);
        cube_scene().load(load.unwrap())
    };
    let cases: Vec<(&str, Scene)> = vec![
        (
            "kind = \"water\"\nset = \"left\"\nlevel = -50\nfunction = { kind = \"ramp\", duration = 0.1 }",
            pressure("left", water(1000.0, -50.0), ramp()),
        ),
        (
            "kind = \"water\"\nset = \"top\"\nlevel = 12.5\ndensity = 1100",
            pressure("top", water(1100.0, 12.5), Box::new(|_: f64| 1.0)),
        ),
        (
            "kind = \"pressure\"\nset = \"top\"\npressure = 2e5\nfunction = { kind = \"table\", times = [0, 0.2], values = [0, 1] }",
            pressure("top", Profile::Uniform, Box::new(table)),
        ),
        (
            "kind = \"traction\"\nset = \"top\"\ntraction = [1e5, 0, -2e5]\nfunction = { kind = \"sine\", frequency = 4 }",
            pulled(Profile::Uniform, sine()),
        ),
        (
            "kind = \"traction\"\nset = \"top\"\ntraction = [1e5, 0, -2e5]\nlevel = 10",
            pulled(
                Profile::Depth {
                    gradient: 1.0,
                    level: 10.0,
                },
                Box::new(|_: f64| 1.0),
            ),
        ),
        (
            "kind = \"nodal\"\nset = \"top\"\nforce = [0, 3e8, 0]\nfunction = { kind = \"ricker\", frequency = 5, delay = 0.2 }",
            cube_scene().load(NodalForce::new(
                nodes("top"),
                Vec3::new(0.0, 3e8, 0.0),
                ricker(),
            )),
        ),
        (
            "kind = \"gravity\"",
            cube_scene().gravity(down, |_: f64| 1.0),
        ),
        (
            "kind = \"gravity\"\nacceleration = 3.7\nfunction = { kind = \"constant\" }",
            cube_scene().gravity(Vec3::new(0.0, 0.0, -3.7), |_: f64| 1.0),
        ),
    ];
    for (keys, twin) in cases {
        let new = format!("[[load]]\n{keys}\n[time]");
        variants.equal(("[time]", &new), twin);
    }
}

/// Every support of a file equals that of the engine.
#[test]
fn supports() {
    let variants = Variants::new("kept");
    let mesh = cube();
    let prescribed = |history: Function| {
        cube_scene().prescribed(Prescribed {
            nodes: nodes("top"),
            direction: Vec3::new(1.0, 0.0, 1.0),
            displacement: history,
        })
    };
    for (keys, twin) in [
        (
            "kind = \"fixed\"\nset = \"right\"",
            cube_scene().support(Support::fixed(nodes("right"))),
        ),
        (
            "kind = \"roller\"\nset = \"right\"\nnormal = [1, 2, 0]",
            cube_scene().support(Support::roller(nodes("right"), Vec3::new(1.0, 2.0, 0.0))),
        ),
        (
            "kind = \"prescribed\"\nset = \"top\"\ndirection = [1, 0, 1]\ndisplacement = 0.002\nfunction = { kind = \"sine\", frequency = 4 }",
            prescribed(Box::new(|t: f64| 0.002 * (TAU * 4.0 * t).sin())),
        ),
        (
            "kind = \"periodic\"\nfrom = \"front\"\nto = \"back\"",
            cube_scene().with_periodic_pairs(
                PeriodicPairs::by_translation(&mesh, &nodes("front"), &nodes("back"), 1e-3)
                    .unwrap(),
            ),
        ),
    ] {
        let new = format!("[[support]]\n{keys}\n[time]");
        variants.equal(("[time]", &new), twin);
    }
}

fn damped(damping: Rayleigh) -> Scene {
    let scene = cube_scene();
    let boundary = scene.boundary().unwrap().clone();
    let rock = Material::from(LinearElastic::new(ROCK));
    Scene::new("cube", cube())
        .part(
            Part::new("rock", rock)
                .with_kernel(SolidKernel::Hex8Full)
                .with_damping(damping),
        )
        .with_shared_field(scene.field().unwrap().clone())
        .with_boundary(boundary)
        .with_duration(0.6)
        .with_output(scene.output().clone())
}

/// Damping, scheme, step, start, precision and threads of a file equal those of Rust.
#[test]
fn time_and_numbers() {
    let variants = Variants::new("time");
    let by_stiffness = Rayleigh {
        mass: 0.2,
        stiffness: 0.04,
    };
    let coefficients = "damping = { kind = \"coefficients\", mass = 0.2, stiffness = 0.04 }\n";
    let kernel = "kernel = \"hex8-full\"\n";
    let of_time = "duration = 0.6\n";
    for ((old, new), twin) in [
        (
            (kernel, format!("{kernel}{coefficients}")),
            damped(by_stiffness),
        ),
        (
            (
                kernel,
                format!(
                    "{kernel}damping = {{ kind = \"rayleigh\", ratio = 0.03, frequencies = [1, 10] }}\n"
                ),
            ),
            damped(Rayleigh::from_ratio(0.03, 1.0, 10.0).unwrap()),
        ),
        (
            (of_time, format!("{of_time}safety = 0.7\n")),
            cube_scene().with_step(TimeStep::OfStable(0.7)),
        ),
        (
            (of_time, format!("{of_time}step = 0.01\n")),
            cube_scene().with_step(TimeStep::Seconds(0.01)),
        ),
        (
            (of_time, format!("{of_time}step = \"auto\"\n")),
            cube_scene(),
        ),
        (
            (of_time, format!("{of_time}start = -0.1\n")),
            cube_scene()
                .with_start_time(-0.1)
                .with_initial_motion(InitialMotion::Rest),
        ),
        (
            (
                of_time,
                format!("{of_time}start = 0.2\ninitial = \"field\"\n"),
            ),
            cube_scene()
                .with_start_time(0.2)
                .with_initial_motion(InitialMotion::Field),
        ),
        (
            ("title", "threads = 1\ntitle".into()),
            cube_scene().with_threads(1),
        ),
        (
            ("title", "precision = \"mixed\"\ntitle".into()),
            cube_scene().with_precision(Precision::Mixed),
        ),
        (
            ("title", "precision = \"f32\"\ntitle".into()),
            cube_scene().with_precision(Precision::F32),
        ),
        (("title", "precision = \"f64\"\ntitle".into()), cube_scene()),
    ] {
        variants.equal((old, &new), twin);
    }
    // Threads change no bit of a result.
    let threads = |new| variants.read("title", new).unwrap().threads();
    assert_eq!(threads("threads = 3\ntitle"), Some(3));
    assert_eq!(threads("title"), None);
    let old = "kernel = \"hex8-full\"\n";
    let text = CUBE.replace(old, &format!("{old}{coefficients}"));
    let text = text.replace(of_time, &format!("{of_time}scheme = \"one-sided\"\n"));
    variants.equal(
        (CUBE, &text),
        damped(by_stiffness).with_integrator(OneSided),
    );
}

/// Every key of a boundary is the parameter of the boundary.
#[test]
fn boundaries() {
    let variants = Variants::new("boundaries");
    let scene = |boundary: Boundary| {
        let base = cube_scene();
        let field = base.field().unwrap().clone();
        let plan = base.output().clone();
        Scene::new("cube", cube())
            .part(
                Part::new("rock", Material::from(LinearElastic::new(ROCK)))
                    .with_kernel(SolidKernel::Hex8Full),
            )
            .with_shared_field(field)
            .with_boundary(boundary.with_scatterer(Vec3::new(150.0, 150.0, 0.0)))
            .with_duration(0.6)
            .with_output(plan)
    };
    let axis = |a, b, distance| AxisParameters::new(a, b, distance).unwrap();
    let incident_only = InputMode::IncidentOnly {
        faces: vec!["bottom".into()],
    };
    let default = AxisParameters::default();
    for (keys, twin) in [
        (
            "kind = \"viscous\"",
            Boundary::new(Viscous::default(), SIDES),
        ),
        (
            "kind = \"viscous\"\ninput = { incident-only = [\"bottom\"] }",
            Boundary::new(
                Viscous {
                    input: incident_only.clone(),
                },
                SIDES,
            ),
        ),
        (
            "kind = \"viscous-spring\"\ninput = { incident-only = [\"bottom\"] }",
            Boundary::new(
                ViscousSpring {
                    input: incident_only,
                    ..ViscousSpring::default()
                },
                SIDES,
            ),
        ),
        (
            "kind = \"viscous-spring\"\nspeed_ratio = \"paper\"",
            Boundary::new(ViscousSpring::paper(), SIDES),
        ),
        (
            "kind = \"viscous-spring\"\nspeed_ratio = 1\nx = { speed_ratio = \"paper\" }",
            Boundary::new(
                ViscousSpring {
                    axes: [axis(0.8, 1.1, None), default, default],
                    ..ViscousSpring::default()
                },
                SIDES,
            ),
        ),
        (
            "kind = \"viscous-spring\"\nspreading = \"cylindrical\"\ninput = \"full-field\"",
            Boundary::new(
                ViscousSpring {
                    spreading: Spreading::Cylindrical,
                    ..ViscousSpring::default()
                },
                SIDES,
            ),
        ),
        (
            "kind = \"viscous-spring\"\namplitude_ratio = 0.5\nspeed_ratio = 1.2\nx = { amplitude_ratio = 1, distance = 200 }\nz = { speed_ratio = 1.3 }",
            Boundary::new(
                ViscousSpring {
                    axes: [
                        axis(1.0, 1.2, Some(200.0)),
                        axis(0.5, 1.2, None),
                        axis(0.5, 1.3, None),
                    ],
                    ..ViscousSpring::default()
                },
                SIDES,
            ),
        ),
        (
            "kind = \"viscous-spring\"\ndistance = 170\ny = { distance = 180 }",
            Boundary::new(
                ViscousSpring {
                    axes: [170.0, 180.0, 170.0].map(|distance| {
                        axis(default.amplitude_ratio, default.speed_ratio, Some(distance))
                    }),
                    ..ViscousSpring::default()
                },
                SIDES,
            ),
        ),
    ] {
        variants.equal(("kind = \"viscous-spring\"", keys), scene(twin));
    }
}
