//! Trade studies: factors, runs, files, reuse of earlier runs.

use std::path::Path;
use std::time::Duration;

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{FileScene, Registry, RunHooks};
use powerhouse_study::StudyError;
use powerhouse_study::trade::{
    Factor, Goal, NoProgress, Quantity, Reference, Trade, TradeCase, TradeWatch,
};

use crate::block::Folder;

/// A block of ground under a wave.
pub(crate) const SCENE: &str = r#"
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
pulse = { kind = "smooth", displacement = 0.01, duration = 0.25 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "front", "back", "bottom"]
scatterer = [60, 60, 120]
[time]
duration = 0.4
[output]
every = 0.004
[[output.history]]
name = "top"
at = [60, 60, 120]
quantities = ["displacement", "velocity"]
"#;

impl Folder {
    fn trade(&self) -> Trade {
        Trade::of_file(self.scene(), Some(self.out())).unwrap()
    }
}

/// Counts the progress callbacks.
#[derive(Default)]
struct Counted {
    announced: Option<(usize, f64, Duration)>,
    begun: usize,
    kept: usize,
}

impl TradeWatch for Counted {
    fn before(&mut self, runs: usize, window: f64, at_most: Duration) {
        assert_eq!(self.begun, 0);
        self.announced = Some((runs, window, at_most));
    }
    fn begins(&mut self, _name: &str, _number: usize) {
        self.begun += 1;
    }
    fn reused(&mut self, _name: &str) {
        self.kept += 1;
    }
}

/// The relative L2 difference of the displacement of the point on top.
fn difference(scene: &Path, reference: &Path) -> f64 {
    let motion = |path: &Path| {
        let scene = FileScene::from_file_with(path, &Registry::default()).unwrap();
        scene
            .prepare()
            .unwrap()
            .run(RunHooks::default())
            .unwrap()
            .histories()
            .clone()
    };
    let (found, reference) = (motion(scene), motion(reference));
    let (mut difference, mut size) = (0.0, 0.0);
    for name in ["top.ux", "top.uy", "top.uz"] {
        let (a, b) = (found.column(name).unwrap(), reference.column(name).unwrap());
        for (time, value) in reference.times.iter().zip(&b.values) {
            let after = found
                .times
                .partition_point(|t| t < time)
                .clamp(1, found.times.len() - 1);
            let (start, end) = (found.times[after - 1], found.times[after]);
            let share = (time - start) / (end - start);
            let at = a.values[after - 1] + share * (a.values[after] - a.values[after - 1]);
            difference += (at - value).powi(2);
            size += value.powi(2);
        }
    }
    f64::sqrt(difference / size)
}

/// A trade study predicts its cost, finds the cheapest run within an error and writes its scene, and another study runs
/// nothing again. The written scene has the predicted error in a whole run.
#[test]
fn the_scene_of_a_trade_keeps_its_promise() {
    let folder = Folder::new("error", SCENE, 8);
    let mut trade = folder.trade();
    let names: Vec<&str> = trade.factors().iter().map(|factor| factor.name).collect();
    assert_eq!(
        names,
        [
            "kernel",
            "step",
            "boundary",
            "ground",
            "input",
            "precision",
            "output"
        ]
    );
    let mut watch = Counted::default();
    let report = trade.run(Goal::Error(0.03), None, &mut watch).unwrap();
    let (runs, window, at_most) = watch.announced.unwrap();
    assert!(runs >= watch.begun && at_most > Duration::ZERO);
    assert_eq!((window, watch.kept), (0.4, 0));
    // The reference and eleven single changes at least.
    assert!(report.cases.len() > 11, "{}", report.cases.len());
    assert_eq!(
        (report.cases[0].error, report.cases[0].name.as_str()),
        (0.0, "reference")
    );
    let error_of = |name: &str| {
        let found = |case: &&TradeCase| case.name == name;
        report
            .cases
            .iter()
            .find(found)
            .map(|case| case.error)
            .unwrap()
    };
    // A number format costs the accuracy of its digits, the incident wave alone at the bottom much more.
    assert!(error_of("precision mixed") < 1e-4);
    assert!(error_of("precision mixed") < error_of("precision f32"));
    assert!(error_of("input incident wave at the bottom") > 0.03);
    let of_reference = report.reference_error.unwrap();
    assert!(of_reference > 0.0 && of_reference < 0.03);
    let chosen = &report.cases[report.chosen.unwrap()];
    assert!(chosen.error + of_reference <= 0.03);
    assert!(report.front.contains(&report.chosen.unwrap()));
    let cheaper = report
        .cases
        .iter()
        .filter(|case| case.error + of_reference <= 0.03);
    assert!(
        cheaper
            .into_iter()
            .all(|case| case.cost.wall_time() >= chosen.cost.wall_time())
    );
    assert!(report.files.iter().all(|file| file.is_file()));

    let mut again = Counted::default();
    let same = folder
        .trade()
        .run(Goal::Error(0.03), None, &mut again)
        .unwrap();
    assert_eq!((again.kept, &same), (again.begun, &report));

    // The finest form of the scene, written by hand.
    let finest = folder.0.join("finest.toml");
    let text = SCENE
        .replace(
            "material = \"rock\"\n[[wave]]",
            "material = \"rock\"\nkernel = \"hex8-full\"\n[[wave]]",
        )
        .replace("duration = 0.4", "duration = 0.4\nsafety = 0.5");
    std::fs::write(&finest, text).unwrap();
    let error = difference(&report.files[0], &finest);
    assert!(error <= 0.03, "{error}");
}

/// Compared with the closed form the finest run has the error of its mesh, which a run on smaller elements estimates as
/// well; less ground has a smaller error. A field of another medium has no closed form.
#[test]
fn ground_without_a_structure_has_a_closed_form() {
    let folder = Folder::new("closed", SCENE, 8);
    let trade = folder
        .trade()
        .window(0.2)
        .with_reference(Reference::ClosedForm);
    let mut trade = trade.with_mesh_error();
    let report = trade.run(Goal::Front, None, &mut NoProgress).unwrap();
    let finest = &report.cases[0];
    // Eight bricks to the shortest wavelength of the pulse.
    assert!(
        finest.error > 1e-4 && finest.error < 0.05,
        "{}",
        finest.error
    );
    assert_eq!((report.reference_error, report.chosen), (Some(0.0), None));
    // The estimate without a closed form is the error of the mesh; some of the error is that of the boundary.
    let printed = report.mesh.as_ref().unwrap().error / finest.error;
    assert!((printed - 1.0).abs() < 0.25, "{printed}");
    // Of ground alone less is as good: waves have a shorter way to go wrong, and pass when they would.
    // By itself: which combinations are run depends on what they cost here.
    let of_ground =
        |case: &&TradeCase| case.name.starts_with("ground faces at") && !case.name.contains(", ");
    let less: Vec<f64> = (report.cases.iter().filter(of_ground))
        .map(|case| case.error / finest.error)
        .collect();
    assert!(
        less.len() == 3 && less.iter().all(|error| *error < 1.0),
        "{less:?}"
    );
    let damped = SCENE.replace(
        "material = \"rock\"\n[[wave]]",
        "material = \"rock\"\ndamping = { kind = \"rayleigh\", ratio = 0.05, frequencies = [2, 10] }\nelastic_rim = 0\n[[wave]]",
    );
    let folder = Folder::new("damped", &damped, 8);
    let mut trade = folder
        .trade()
        .window(0.01)
        .with_reference(Reference::ClosedForm);
    assert!(
        trade
            .factors()
            .iter()
            .any(|factor| factor.name == "damping")
    );
    let refused = trade.run(Goal::Front, None, &mut NoProgress).unwrap_err();
    assert!(
        matches!(refused, StudyError::NoClosedForm { .. }),
        "{refused}"
    );
}

/// The motion of ground with loads, supports or openings differs from the incident field.
#[test]
fn disturbed_ground_has_no_closed_form() {
    let refused = |folder: &Folder| {
        let mut trade = folder
            .trade()
            .window(0.01)
            .with_reference(Reference::ClosedForm);
        match trade.run(Goal::Front, None, &mut NoProgress) {
            Err(StudyError::NoClosedForm { reason }) => reason,
            other => panic!("{other:?}"),
        }
    };
    for (name, section, reason) in [
        ("loaded", "[[load]]\nkind = \"gravity\"\n", "loads"),
        (
            "held",
            "[[support]]\nkind = \"fixed\"\nset = \"top\"\n",
            "fixed",
        ),
    ] {
        let folder = Folder::new(name, &format!("{SCENE}{section}"), 8);
        assert!(refused(&folder).contains(reason), "{name}");
    }
    let hollow = Folder::new("hollow", SCENE, 8);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(120.0), [8, 8, 8], "rock").unwrap();
    let (low, high) = (Vec3::new(40.0, -1.0, 40.0), Vec3::new(80.0, 121.0, 80.0));
    let taken = mesh.elements_in_box(&low, &high);
    assert_eq!(taken.len(), 32);
    let all = 0..mesh.element_count() as u32;
    let kept: Vec<u32> = all.filter(|element| !taken.contains(element)).collect();
    write_gmsh(hollow.0.join("mesh.msh"), &mesh.of_elements(&kept).unwrap()).unwrap();
    assert!(refused(&hollow).contains("opening"));
}

/// Every combination of the chosen factors is run, and these runs are reused by a study of more factors; errors are those
/// of the compared quantities. Unknown factors and missing histories are errors before a run.
#[test]
fn all_combinations_of_some_factors_are_run() {
    let folder = Folder::new("every", SCENE, 8);
    let trade = || folder.trade().window(0.2);
    let every = || trade().only(&["kernel", "precision"]).unwrap().exhaustive();
    let mut watch = Counted::default();
    let report = every().run(Goal::Front, None, &mut watch).unwrap();
    let names: Vec<&str> = report.cases.iter().map(|case| case.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "reference",
            "kernel hex8-natural",
            "kernel hex8-one-point",
            "precision mixed",
            "precision f32",
            "kernel hex8-natural, precision mixed",
            "kernel hex8-natural, precision f32",
            "kernel hex8-one-point, precision mixed",
            "kernel hex8-one-point, precision f32",
        ]
    );
    assert_eq!(watch.announced.map(|(runs, ..)| runs), Some(9));
    assert_eq!(report.partial_window, None, "no history variables");

    // The scene's own step is not the finest: with all factors its runs differ, and are not reused for these.
    let mut watch = Counted::default();
    let mut with_step = trade().only(&["kernel", "step"]).unwrap();
    let of_step = with_step.run(Goal::Front, None, &mut watch).unwrap();
    assert!(of_step.cases[0].cost.steps > 3 * report.cases[0].cost.steps / 2);
    let step = |case: &&TradeCase| case.name == "step 1 of the stable";
    let same = of_step.cases.iter().find(step).unwrap();
    assert_eq!(same.cost.steps, report.cases[0].cost.steps);
    assert!(watch.kept > 0 && watch.kept < watch.begun);

    let of = |quantity| every().comparing(&[quantity]).unwrap();
    let velocity = of(Quantity::Velocity)
        .run(Goal::Front, None, &mut NoProgress)
        .unwrap();
    let displacement = of(Quantity::Displacement)
        .run(Goal::Front, None, &mut NoProgress)
        .unwrap();
    for ((all, v), u) in report
        .cases
        .iter()
        .zip(&velocity.cases)
        .zip(&displacement.cases)
        .skip(1)
    {
        assert_eq!(
            (v.worst.as_str(), u.worst.as_str()),
            ("top [m/s]", "top [m]")
        );
        assert!(
            u.error != v.error && all.error == u.error.max(v.error),
            "{all:?} {v:?} {u:?}"
        );
    }
    let early = trade().window(0.01).run(Goal::Front, None, &mut NoProgress);
    let refused = early.unwrap_err();
    assert!(
        matches!(refused, StudyError::StillHistories { window: 0.01 }),
        "{refused}"
    );
    assert_eq!(report.reference_error, None);
    let stress = "quantities = [\"displacement\", \"stress\"]";
    let with_stress = SCENE.replace("quantities = [\"displacement\", \"velocity\"]", stress);
    let of_stress = Folder::new("stress", &with_stress, 8);
    let closed = of_stress.trade().with_reference(Reference::ClosedForm);
    let mut closed = closed.comparing(&[Quantity::Stress]).unwrap();
    let refused = closed.run(Goal::Front, None, &mut NoProgress).unwrap_err();
    assert!(
        matches!(refused, StudyError::NoClosedForm { .. }),
        "{refused}"
    );
    let refused = trade().comparing(&[Quantity::Stress]).err().unwrap();
    assert!(
        matches!(refused, StudyError::NotRecorded { quantity: "stress" }),
        "{refused}"
    );
    let refused = trade().only(&["kernels"]).err().unwrap();
    assert!(
        refused
            .to_string()
            .contains("no factor 'kernels'; available: kernel, step"),
        "{refused}"
    );
}

/// The mesh is not reduced where something is recorded, loaded or moved, where springs have given distances, and where
/// waves enter through a region; a nodal load on more nodes is not that of the same scene.
#[test]
fn ground_stays_where_it_is_needed() {
    let history = "[[output.history]]\n";
    let replaced = |old: &str, new: &str| {
        assert!(SCENE.contains(old));
        SCENE.replace(old, new)
    };
    let recorded = |place: &str| {
        let more = format!("{history}name = \"far\"\n{place}\n{history}");
        replaced(history, &more)
    };
    let load = |set: &str| {
        let load =
            format!("[[load]]\nkind = \"nodal\"\nset = \"{set}\"\nforce = [1, 0, 0]\n[time]");
        replaced("[time]", &load)
    };
    for (name, scene, left) in [
        ("bare", SCENE.to_owned(), 3),
        ("node", recorded("node = 1"), 0),
        ("set", recorded("set = \"top\""), 0),
        (
            "element",
            recorded("element = 1\nquantities = [\"stress\"]"),
            0,
        ),
        (
            "middle",
            recorded("at = [60, 60, 40]\nquantities = [\"stress\"]"),
            1,
        ),
        ("load", load("top"), 0),
        (
            "distance",
            replaced("scatterer = [60, 60, 120]", "distance = 70"),
            0,
        ),
    ] {
        let folder = Folder::new(&format!("ground-{name}"), &scene, 8);
        let trade = folder.trade();
        let ground = trade
            .factors()
            .iter()
            .find(|factor| factor.name == "ground");
        let levels = ground.map_or(0, |factor| factor.levels.len() - 1);
        assert_eq!(levels, left, "{name}");
    }
    let folder = Folder::new("loaded", &load("top"), 8);
    let mut trade = folder.trade().window(0.1).with_mesh_error();
    let refused = trade.run(Goal::Front, None, &mut NoProgress).unwrap_err();
    assert!(
        matches!(
            refused,
            StudyError::MoreLoad {
                nodes: 81,
                more: 289,
                ..
            }
        ),
        "{refused}"
    );
}

/// A level that is invalid for a scene is reported and left out; the others are run.
#[test]
fn a_level_that_fails_is_left_out() {
    // Single precision cannot balance energies so well.
    let strict = SCENE.replace(
        "title = \"block\"",
        "title = \"block\"\nenergy_residual = 1e-9",
    );
    let folder = Folder::new("failing", &strict, 8);
    let report = folder
        .trade()
        .run(Goal::Front, None, &mut NoProgress)
        .unwrap();
    let failed: Vec<&str> = report
        .failed
        .iter()
        .map(|(name, _)| name.as_str())
        .collect();
    assert!(failed.contains(&"precision f32"), "{failed:?}");
    assert!(
        report
            .failed
            .iter()
            .all(|(_, why)| why.contains("energy balance"))
    );
    let named = |factor: &Factor| factor.name == "precision";
    let precision = report.factors.iter().position(named).unwrap();
    let within = |case: &TradeCase| case.levels[precision] == 2;
    assert!(!report.cases.iter().any(within) && report.cases.len() > 5);
}

/// If a stage cannot reach a finer tolerance than that of the scene, the scene's own tolerance is the finest.
#[test]
fn an_unreachable_tolerance_is_dropped() {
    // Half a per cent more than the ground bears in uniaxial compression, 2 c cos(phi) / (1 - sin(phi)).
    let stage = r#"
[[stage]]
name = "press"
tolerance = 0.02
support = [{ kind = "roller", set = "bottom" }, { kind = "roller", set = "left" }, { kind = "roller", set = "front" }]
load = [{ kind = "pressure", set = "top", pressure = 3.4815e6 }]
[[wave]]"#;
    let weak = "law = \"mohr-coulomb\"\ncohesion = 1e6\nfriction = 30\ndilation = 0";
    let staged = SCENE.replace("[[wave]]", stage);
    let staged = staged.replace("law = \"elastic\"", weak);
    let folder = Folder::new("unreached", &staged, 8);
    let run = || {
        let trade = folder.trade().window(0.3);
        let mut trade = trade.only(&["statics", "input"]).unwrap();
        trade.run(Goal::Front, None, &mut NoProgress).unwrap()
    };
    let report = run();
    let names: Vec<&str> = report.cases.iter().map(|case| case.name.as_str()).collect();
    assert_eq!(
        names[..2],
        ["reference", "input incident wave at the bottom"]
    );
    assert!(names.contains(&"statics a hundred times"), "{names:?}");
    // Rock may yield later.
    assert_eq!(report.partial_window, Some(0.3));
    let [(name, why)] = report.failed.as_slice() else {
        panic!("{:?}", report.failed);
    };
    assert_eq!(name, "statics a hundredth");
    assert!(why.contains("unbalanced forces"), "{why}");
    // A study that continues from the reference computes the stages of its second run with the same tolerance.
    let folders = std::fs::read_dir(folder.out()).unwrap();
    let nudged = folders.map(|entry| entry.unwrap().path());
    let mut nudged = nudged.filter(|path| path.to_string_lossy().ends_with("-nudged"));
    std::fs::remove_dir_all(nudged.next().unwrap()).unwrap();
    assert_eq!(run().sensitive, report.sensitive);
}

/// A reference whose stage fails for another reason than its tolerance is not repeated with a coarser one.
#[test]
fn a_failed_reference_is_reported_at_once() {
    let floating = "[[stage]]\nname = \"nothing\"\ntolerance = 0.02\n[[wave]]";
    let folder = Folder::new("floating", &SCENE.replace("[[wave]]", floating), 8);
    let mut watch = Failures::default();
    let mut trade = folder.trade().only(&["statics"]).unwrap();
    let error = trade.run(Goal::Front, None, &mut watch).err().unwrap();
    assert!(error.to_string().contains("freely"), "{error}");
    assert_eq!(watch.0, 0, "{error}");
}

/// Counts the failed runs.
#[derive(Default)]
struct Failures(usize);

impl TradeWatch for Failures {
    fn fails(&mut self, _name: &str, _error: &StudyError) {
        self.0 += 1;
    }
}

/// A scene without recorded histories is an error.
#[test]
fn a_scene_without_histories_is_an_error() {
    let bare = SCENE.split("[[output.history]]").next().unwrap();
    let folder = Folder::new("bare", bare, 8);
    let refused = Trade::of_file(folder.scene(), None).err().unwrap();
    assert!(matches!(refused, StudyError::NoHistories), "{refused}");
}
