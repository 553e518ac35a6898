//! Runs of scenes from files and from Rust, with user-defined types, to complete output.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::observe::Motion;
use powerhouse::engine::{Ended, Hex8Full, SolidKernel, Support};
use powerhouse::io::{read_table, write_gmsh};
use powerhouse::material::LinearElastic;
use powerhouse::model::{
    ElasticMedium, ElementKind, HistoryVariable, LawInput, Mesh, PointLaw, Stress, Vec3,
};
use powerhouse::{
    Error, FileScene, InitialMotion, Kernel, Material, OutputPlan, Part, Registry,
    RenderFault as _, ResultFolder, Results, RunHooks, Scene, SnapshotRequest, TimeStep,
};

use super::support::*;

/// A physical curve of a mesh file names an edge: it is not part of the body, changes nothing, and its nodes can be
/// supported.
#[test]
fn a_curve_names_an_edge() {
    let folder = Folder::new("curve");
    let mesh = cube();
    let mut builder = Mesh::builder();
    for (tag, position) in mesh.node_tags().iter().zip(mesh.positions()) {
        builder.node(*tag, *position);
    }
    let tags = |nodes: &[u32]| -> Vec<u64> {
        let tag = |node: &u32| mesh.node_tags()[*node as usize];
        nodes.iter().map(tag).collect()
    };
    for element in 0..mesh.element_count() as u32 {
        let tag = mesh.element_tags()[element as usize];
        let nodes = tags(mesh.nodes_of(element));
        builder.element(tag, mesh.kind(element), &nodes, &["rock"]);
    }
    for (name, facets) in mesh.facet_sets() {
        for facet in facets {
            builder.facet(name, &tags(&mesh.facet_nodes(*facet)));
        }
    }
    let edge = mesh.nodes_in_box(&Vec3::new(0.0, 0.0, 0.0), &Vec3::new(300.0, 0.0, 0.0));
    for (i, ends) in tags(&edge).windows(2).enumerate() {
        builder.element(10_000 + i as u64, ElementKind::Bar2, ends, &["edge"]);
    }
    write_gmsh(folder.join("cube.msh"), &builder.build().unwrap()).unwrap();
    let read = |scene: &str| {
        let path = folder.join("cube.toml");
        std::fs::write(&path, scene).unwrap();
        FileScene::from_file(&path).unwrap().into_scene()
    };
    let peak = |results: Results| {
        let column = results.histories().column("surface.ux").unwrap();
        column.values.iter().fold(0.0_f64, |peak, u| peak.max(*u))
    };
    // The numbering may change, and with it the last digits of the stable step.
    let (with, without) = (peak(run(read(CUBE))), peak(run(cube_scene())));
    assert!((with / without - 1.0).abs() < 1e-3);
    let held = "[[support]]\nset = \"edge\"\nkind = \"fixed\"\n[time]";
    let probe = "[[output.history]]\nname = \"edge\"\nset = \"edge\"\n";
    let held = run(read(&(CUBE.replace("[time]", held) + probe)));
    let moved = |name: &str| {
        let column = held.histories().column(name).unwrap();
        column.values.iter().any(|&u| u != 0.0)
    };
    assert!(!moved("edge.ux") && moved("surface.ux"));
    // As a part it would need a kernel, and there is none for bars.
    let part = "[[part]]\nset = \"edge\"\nmaterial = \"granite\"\n[boundary]";
    let text = CUBE.replace("[boundary]", part);
    let read = FileScene::from_toml(text, folder.join("cube.toml"), &Registry::default())
        .map(FileScene::into_scene);
    let Err(Error::Scene(fault)) = read else {
        panic!("a part of bars was accepted")
    };
    assert!(
        fault.to_string().contains("for which there is no kernel"),
        "{fault}"
    );
    assert!(fault.render(false).contains("set = \"edge\""), "{fault}");
}

/// A scene from a file and the same one composed in Rust give the same bits.
#[test]
fn file_and_builder_are_equal() {
    let folder = Folder::new("equal");
    write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
    let path = folder.join("cube.toml");
    std::fs::write(&path, CUBE).unwrap();
    let from_file = run(FileScene::from_file(&path).unwrap().into_scene());
    let from_rust = run(cube_scene());
    assert_eq!(from_file.run.steps, from_rust.run.steps);
    assert_eq!(from_file.histories(), from_rust.histories());
    // The motion is not zero.
    let peak = from_file
        .histories()
        .column("surface.ux")
        .unwrap()
        .values
        .iter();
    assert!(peak.fold(0.0_f64, |most, u| most.max(u.abs())) > 0.01);
}

/// A user-defined law, kernel and boundary can be named in a scene file after registration and are used in the run: a law
/// equal to the elastic one gives the same motion.
#[test]
fn registered_types_run_from_files() {
    #[derive(Clone)]
    struct Granite(ElasticMedium);
    impl PointLaw for Granite {
        fn name(&self) -> &str {
            "granite"
        }
        fn medium(&self) -> ElasticMedium {
            self.0
        }
        fn history(&self) -> &'static [HistoryVariable] {
            &[]
        }
        fn stress_change(&self, input: &LawInput<f64>, _new: &mut [f64]) -> Stress {
            Stress::elastic(self.0.lambda(), self.0.shear(), &input.strain)
        }
    }
    #[derive(serde::Deserialize, schemars::JsonSchema)]
    #[serde(deny_unknown_fields)]
    struct Grade {
        /// Young's modulus in GPa.
        gigapascal: f64,
    }
    let mut registry = Registry::default();
    registry.add_law("granite", |grade: Grade| {
        let medium = ElasticMedium::new(1e9 * grade.gigapascal, 0.27, 2750.0)?;
        Ok(Material::from_point_law(Granite(medium)))
    });
    registry.add_kernel("my-brick", Kernel::own(Hex8Full));
    registry.add_boundary("my-springs", |_: Empty| {
        Ok(Arc::new(ViscousSpring::default()))
    });
    #[derive(serde::Deserialize, schemars::JsonSchema)]
    #[serde(deny_unknown_fields)]
    struct Empty {}

    let folder = Folder::new("registered");
    write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
    let text = CUBE
        .replace(
            "law = \"elastic\"\nyoung = 9.0e9\npoisson = 0.27\ndensity = 2750",
            "law = \"granite\"\ngigapascal = 9",
        )
        .replace("hex8-full", "my-brick")
        .replace("viscous-spring", "my-springs");
    let scene = FileScene::from_toml(text.clone(), folder.join("cube.toml"), &registry)
        .unwrap()
        .into_scene();
    let (own, built_in) = (run(scene), run(cube_scene()));
    for (own, built_in) in own
        .histories()
        .columns
        .iter()
        .zip(&built_in.histories().columns)
    {
        let scale = built_in
            .values
            .iter()
            .fold(0.0_f64, |most, u| most.max(u.abs()));
        for (a, b) in own.values.iter().zip(&built_in.values) {
            assert!((a - b).abs() <= 1e-9 * scale, "{}", own.name);
        }
    }
    // A parameter that the law's check rejects is reported with its position.
    let wrong = text.replace("gigapascal = 9", "gigapascal = -9");
    let Err(Error::Scene(fault)) =
        FileScene::from_toml(wrong, "cube.toml", &registry).map(FileScene::into_scene)
    else {
        panic!("a negative modulus was accepted")
    };
    assert!(fault.to_string().contains("young = -9000000000"), "{fault}");
}

/// A cancelled run has complete output up to its end.
#[test]
fn a_stopped_run_leaves_complete_output() {
    let folder = Folder::new("stopped");
    let results = ResultFolder::new(folder.join("out"));
    let mut scene = cube_scene();
    let mut plan = scene.output().clone();
    plan.energies = Some(0.05);
    plan.snapshots = Some(SnapshotRequest::new(0.05));
    plan.envelope = Some(powerhouse::EnvelopeRequest::new(0.01).with_stress(true));
    scene = scene.with_output(plan);
    let simulation = scene.prepare().unwrap();
    let mesh = simulation.mesh().clone();
    let stop = Arc::new(AtomicBool::new(false));
    let raised = stop.clone();
    let hooks = RunHooks::default()
        .with_stop(stop)
        .with_snapshots(results.snapshots(&simulation).unwrap())
        .with_progress(move |progress| {
            if progress.done == 20 {
                raised.store(true, Ordering::Relaxed);
            }
        });
    let found = simulation.run(hooks).unwrap();
    assert_eq!((found.run.steps, &found.run.ended), (21, &Ended::Stopped));
    let files = results
        .write(
            ("cube", &mesh),
            &found,
            &powerhouse::RunNotes::default(),
            Some(CUBE),
        )
        .unwrap();
    let names: Vec<String> = files
        .iter()
        .map(|file| {
            file.strip_prefix(results.path())
                .unwrap()
                .display()
                .to_string()
        })
        .collect();
    for name in [
        "summary.json",
        "scene.toml",
        "histories.csv",
        "energies.csv",
        "plots/surface.svg",
        "plots/energies.svg",
        "envelope.vtu",
        "pictures/largest-displacement.png",
        "pictures/least-principal-stress.png",
        "snapshots.pvd",
    ] {
        assert!(
            names.contains(&name.to_owned()),
            "{name} is not among {names:?}"
        );
    }
    assert!(files.iter().all(|file| file.metadata().unwrap().len() > 0));
    let table = read_table(&results.path().join("histories.csv")).unwrap();
    assert_eq!(table[0].name, "time");
    assert_eq!(table[0].values.len(), found.histories().times.len());
    let summary = std::fs::read_to_string(results.path().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["ended"], "stopped");
    assert_eq!(summary["steps"], 21);
}

/// Inconsistent items of a scene are errors before the run, with their names.
#[test]
fn misfits_are_refused_by_name() {
    let rock = || Material::from(LinearElastic::new(ROCK));
    let no_part = Scene::new("none", cube()).prepare();
    assert!(matches!(
        no_part,
        Err(Error::PartCount {
            element: 1,
            count: 0,
            sets,
        }) if sets == ["rock"]
    ));
    let twice = Scene::new("twice", cube())
        .part(Part::new("rock", rock()))
        .part(Part::new("rock", rock()));
    assert!(matches!(
        twice.prepare(),
        Err(Error::PartCount {
            element: 1,
            count: 2,
            sets,
        }) if sets == ["rock", "rock"]
    ));
    let set = Scene::new("set", cube())
        .part(Part::new("rok", rock()))
        .prepare();
    assert!(set.is_err_and(|error| error.to_string().contains("'rok'")));
    let share = cube_scene().with_step(TimeStep::OfStable(1.5)).prepare();
    assert!(share.is_err_and(|error| error.to_string().contains("share = 1.5")));
    let idle = Part::new("rock", rock()).with_kernel(SolidKernel::Wedge6);
    let idle = Scene::new("idle", cube()).part(idle).prepare();
    assert!(matches!(idle, Err(Error::UnusedKernel { kernel, .. }) if kernel == "wedge6"));
    let field = Scene::new("field", cube())
        .part(Part::new("rock", rock()))
        .with_start_time(0.0)
        .with_initial_motion(InitialMotion::Field);
    assert!(matches!(field.prepare(), Err(Error::NoField)));
    let mut step = cube_scene()
        .with_step(TimeStep::Seconds(1.0))
        .prepare()
        .unwrap();
    assert!(matches!(step.step(), Err(Error::Run(_))));
}

/// A body that starts with the motion of a wave inside continues it: the error at the surface decreases with the square
/// of the element size.
#[test]
fn a_body_may_start_with_the_field() {
    let error = |elements| {
        let scene = cube_scene_on(cube_of(elements))
            .with_start_time(0.25)
            .with_initial_motion(InitialMotion::Field)
            .with_duration(0.35);
        let field = scene.field().unwrap().clone();
        let sampler = field.prepare(&[Vec3::new(150.0, 150.0, 0.0)]).unwrap();
        let results = run(scene);
        let found = &results.histories().column("surface.ux").unwrap().values;
        let (mut missed, mut all) = (0.0, 0.0);
        for (&time, found) in results.histories().times.iter().zip(found) {
            let mut exact = [Default::default()];
            sampler.add_motion(time, &mut exact);
            let exact = exact[0].displacement.x;
            missed += (found - exact).powi(2);
            all += exact * exact;
        }
        (missed / all).sqrt()
    };
    let [coarse, fine] = [6, 12].map(error);
    let order = (coarse / fine).log2();
    assert!((order - 2.0).abs() < 0.3, "{coarse} {fine}: order {order}");
}

/// Rollers have the mean normal of their face by default; supports restrain the nodes of their set.
#[test]
fn supports_of_a_scene_hold() {
    let folder = Folder::new("supports");
    write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
    let text = r#"
title = "pressed cube"
[mesh]
file = "cube.msh"
[[material]]
name = "rock"
law = "elastic"
young = 9.0e9
poisson = 0.27
density = 2750
[[part]]
set = "rock"
material = "rock"
damping = { kind = "coefficients", mass = 20, stiffness = 0 }
[[support]]
kind = "roller"
set = "bottom"
[[support]]
kind = "roller"
set = "left"
[[support]]
kind = "fixed"
set = "front"
[[load]]
kind = "pressure"
set = "top"
pressure = 3.0e6
function = { kind = "ramp", duration = 0.2 }
[time]
duration = 0.3
[[output.history]]
name = "bottom"
set = "bottom"
[[output.history]]
name = "left"
set = "left"
[[output.history]]
name = "front"
set = "front"
[[output.history]]
name = "top"
set = "top"
"#;
    let scene = FileScene::from_toml(text, folder.join("s.toml"), &Registry::default())
        .unwrap()
        .into_scene();
    let results = run(scene);
    let peak = |name: &str| {
        let column = results.histories().column(name).unwrap();
        column
            .values
            .iter()
            .fold(0.0_f64, |most, u| most.max(u.abs()))
    };
    // Each holds in its own directions, up to the rounding of the mean normals...
    let rounding = 1e-15 * peak("top.uz");
    for held in ["bottom.uz", "left.ux", "front.ux", "front.uy", "front.uz"] {
        assert!(peak(held) <= rounding, "{held}: {}", peak(held));
    }
    // ... and in no others: rollers slide.
    for free in ["bottom.ux", "bottom.uy", "left.uy", "left.uz"] {
        assert!(peak(free) > 1e9 * rounding, "{free}: {}", peak(free));
    }
    assert!(peak("top.uz") > 1e-3, "{}", peak("top.uz"));
}

/// `Support` of the engine and a scene's own are the same.
#[test]
fn engine_supports_go_into_the_builder() {
    let mesh = cube();
    let nodes = mesh.nodes_of_facets(mesh.facet_set("bottom").unwrap());
    let scene = Scene::new("held", mesh)
        .part(Part::new("rock", Material::from(LinearElastic::new(ROCK))))
        .support(Support::fixed(nodes))
        .gravity(Vec3::new(0.0, 0.0, -9.81), |t: f64| (t / 0.05).min(1.0))
        .with_duration(0.05)
        .with_step(TimeStep::Seconds(0.001))
        .with_output(OutputPlan::default().history(
            "top",
            Vec3::new(150.0, 150.0, 0.0),
            Motion::DISPLACEMENT,
        ));
    let results = run(scene);
    let top = results
        .histories()
        .column("top.uz")
        .unwrap()
        .values
        .last()
        .copied()
        .unwrap();
    // Free fall under a ramp for as long as no wave from the base has arrived, g t^3 / (6 T), which
    // n leapfrog steps find times 1 - 1 / n^2. The mesh lets some of it through ahead of the wave:
    // six elements off, after c t / h = 2 elements of way, 12 * 2^12 / 15! = 4e-8.
    let time = results.histories().times.last().copied().unwrap();
    let steps = (time / 0.001).round();
    let fall = -9.81 * time.powi(3) / (6.0 * 0.05) * (1.0 - 1.0 / (steps * steps));
    assert!((top - fall).abs() < 1e-6 * fall.abs(), "{top} {fall}");
}
