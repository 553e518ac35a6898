//! Convergence studies: meshes, extrapolated results, scatter, reuse of finished runs, refusals.

use std::path::PathBuf;

use powerhouse::io::write_gmsh;
use powerhouse::model::{Mesh, Vec3};
use powerhouse_report::{read_outcomes, write_report};
use powerhouse_study::StudyError;
use powerhouse_study::convergence::{ComparedFigure, Convergence, ConvergenceReport, Trend};
use powerhouse_study::sweep::{CaseOutcome, NoProgress, SweepWatch};
use powerhouse_test_support::TestFolder;

/// A block of ground under an oblique pulse.
const SCENE: &str = r#"
title = "block"
[mesh]
file = "mesh-5.msh"
[[material]]
name = "rock"
LAW
[[part]]
set = "rock"
material = "rock"
elastic_rim = 0
[[wave]]
kind = "sv"
incidence = 20
factor = 2
pulse = { kind = "smooth", displacement = 0.02, duration = 0.4 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "front", "back", "bottom"]
scatterer = [60, 60, 120]
[time]
duration = 0.3
[output]
every = 0.01
[[output.history]]
name = "inside"
at = [60, 60, 72]
quantities = ["displacement", "acceleration", "stress", "state"]
[[case]]
name = "strong"
wave = [{ kind = "p", incidence = 20, factor = 4, pulse = { kind = "smooth", displacement = 0.02, duration = 0.4 } }]
"#;

const ELASTIC: &str = "law = \"elastic\"\nyoung = 9e9\npoisson = 0.27\ndensity = 2750";
const YIELDING: &str = "law = \"mohr-coulomb\"\npreset = \"paper-rock\"";

/// A folder with the scene and boxes of 5, 8 and 10 elements along each edge.
fn folder(name: &str, law: &str) -> (TestFolder, PathBuf) {
    let folder = TestFolder::new(&format!("convergence-{name}"));
    for count in [5, 8, 10] {
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(120.0), [count; 3], "rock");
        write_gmsh(folder.join(format!("mesh-{count}.msh")), &mesh.unwrap()).unwrap();
    }
    let scene = folder.join("scene.toml");
    std::fs::write(&scene, SCENE.replace("LAW", law)).unwrap();
    (folder, scene)
}

fn figure<'r>(report: &'r ConvergenceReport, name: &str) -> &'r ComparedFigure {
    let found = report.figures.iter().find(|figure| figure.name == name);
    found.unwrap_or_else(|| panic!("no '{name}' in {:?}", report.figures))
}

/// Names of the runs that were computed, and of those that were reused.
#[derive(Default)]
struct Log {
    computed: Vec<String>,
    reused: Vec<String>,
}

impl SweepWatch for Log {
    fn reused(&mut self, case: &str) {
        self.reused.push(case.into());
    }
    fn ends(&mut self, outcome: &CaseOutcome) {
        self.computed.push(outcome.name.clone());
    }
}

/// The bands of three meshes contain the results of a fourth, to which extrapolated results of nearly second order are closer than
/// those of the third; the three runs are reused for the study of four.
#[test]
fn extrapolated_results_are_those_of_finer_meshes() {
    let (folder, scene) = folder("three", ELASTIC);
    // The whole pulse, with its peaks between few steps.
    let text = SCENE.replace("LAW", ELASTIC);
    let text = text.replace("duration = 0.3", "duration = 0.6");
    let text = text.replace("every = 0.01", "every = 0.002");
    std::fs::write(&scene, text).unwrap();
    let study = |meshes: usize| {
        let study = Convergence::of_file(&scene, None, Some(folder.join("out"))).unwrap();
        study.with_meshes(meshes).unwrap()
    };
    let mut log = Log::default();
    let three = study(3).run(None, &mut log).unwrap();
    assert_eq!(log.computed, ["mesh-1", "mesh-2", "mesh-3"]);
    let elements: Vec<usize> = three.meshes.iter().map(|mesh| mesh.elements).collect();
    assert_eq!(elements, [125, 1000, 8000]);
    assert!(
        three
            .meshes
            .iter()
            .all(|mesh| (mesh.size * (mesh.elements as f64).cbrt() - 120.0).abs() < 1e-9)
    );
    let mut log = Log::default();
    let four = study(4).run(None, &mut log).unwrap();
    assert_eq!(log.reused, ["mesh-1", "mesh-2", "mesh-3"]);
    assert_eq!(log.computed, ["mesh-4"]);
    let mut near_formal = 0;
    for figure in three.figures.iter().filter(|figure| !figure.negligible) {
        let finer = self::figure(&four, &figure.name);
        let (own, finest) = (figure.values[2], finer.values[3]);
        assert_eq!(figure.values[..], finer.values[..3]);
        let Some(band) = figure.estimate.band else {
            continue;
        };
        // A peak of stress between two samples, 2 ms apart, is up to this higher than both.
        let between_samples = 0.5 * (core::f64::consts::PI * 0.002 / 0.4).powi(2) * own.abs();
        assert!(
            (own - finest).abs() <= band + between_samples,
            "{figure:?} {finest}"
        );
        // Of lower orders errors of several kinds are mixed, which no single order extrapolates.
        let before = (own - finest).abs();
        let is_formal = figure.estimate.order.is_some_and(|order| order > 1.5);
        if is_formal && before > between_samples {
            near_formal += 1;
            let extrapolated = figure.estimate.extrapolated.unwrap();
            let after = (extrapolated - finest).abs();
            assert!(after < before, "{figure:?} {finest}");
        }
    }
    assert!(near_formal >= 2, "{:#?}", three.figures);
    assert_eq!(figure(&three, "peak of inside.ux").scatter, None);
    assert!(!three.scatter_unknown);
}

/// Where a law has history variables all meshes but the finest are run again, and every result has a scatter; the report shows
/// them. A case of the scene is studied with its own keys.
#[test]
fn scatter_is_measured_where_laws_have_a_history() {
    let (folder, scene) = folder("yielding", YIELDING);
    let out = folder.join("out");
    let study = Convergence::of_file(&scene, Some("strong"), Some(out.clone())).unwrap();
    let study = study
        .with_finer_files(&["mesh-8.msh".into()])
        .unwrap()
        .with_duration(0.2)
        .unwrap();
    let mut log = Log::default();
    let report = study.run(None, &mut log).unwrap();
    assert_eq!(log.computed, ["mesh-1", "mesh-1-perturbed", "mesh-2"]);
    let elements: Vec<usize> = report.meshes.iter().map(|mesh| mesh.elements).collect();
    assert_eq!(elements, [125, 512]);
    let motion = figure(&report, "peak of inside.uz");
    assert_eq!(motion.estimate.trend, Trend::Assumed);
    // A wave larger by 1e-6 changes a steady motion by about a millionth.
    let change = motion.scatter.unwrap() / motion.values[0];
    assert!((1e-7..1e-5).contains(&change), "{change:e}");
    let outcomes = read_outcomes(&out).unwrap();
    let factors = outcomes.iter().map(|case| case.input.waves[0].factor);
    assert_eq!(factors.collect::<Vec<_>>(), [4.0, 4.0 * (1.0 + 1e-6), 4.0]);
    let names: Vec<&str> = report.figures.iter().map(|f| f.name.as_str()).collect();
    assert!(
        names.contains(&"peak of inside.equivalent_plastic_strain"),
        "{names:?}"
    );
    assert!(!names.iter().any(|name| name.contains("_xx")), "{names:?}");
    let page = std::fs::read_to_string(write_report(&out).unwrap()).unwrap();
    assert!(page.contains("Convergence") && page.contains("order assumed"));
    assert!(page.contains("two meshes show no order of convergence"));
    assert!(page.contains("assumed to scatter no more"));
    let table = std::fs::read_to_string(&report.files[0]).unwrap();
    assert!(
        table.contains("125 elements of 24.0 m,512 elements of 15.0 m"),
        "{table}"
    );
    // Without a second run the scatter is unknown, and the report says so.
    let study = Convergence::of_file(&scene, Some("strong"), Some(out)).unwrap();
    let study = study.with_finer_files(&["mesh-8.msh".into()]).unwrap();
    let study = study.with_duration(0.2).unwrap().without_perturbation();
    let report = study.run(None, &mut NoProgress).unwrap();
    assert!(report.scatter_unknown);
    assert_eq!(figure(&report, "peak of inside.uz").scatter, None);
}

/// Meshes that are not finer, numbers of meshes out of range and unknown cases are refused before anything runs.
#[test]
fn unsuitable_meshes_are_refused() {
    let (folder, scene) = folder("refused", ELASTIC);
    let study = || Convergence::of_file(&scene, None, Some(folder.join("out"))).unwrap();
    for meshes in [0, 1, 5] {
        let refused = study().with_meshes(meshes).err().unwrap().to_string();
        assert!(refused.contains("meshes"), "{refused}");
    }
    let coarser = study()
        .with_finer_files(&["mesh-10.msh".into(), "mesh-8.msh".into()])
        .unwrap();
    let refused = coarser.run(None, &mut NoProgress).unwrap_err();
    assert!(
        matches!(&refused, StudyError::NotFiner { mesh, size, coarser }
            if mesh == "mesh-3" && *size > *coarser),
        "{refused}"
    );
    let missing = study().with_finer_files(&["none.msh".into()]).unwrap();
    let refused = missing.run(None, &mut NoProgress).unwrap_err().to_string();
    assert!(refused.contains("none.msh"), "{refused}");
    let unknown = Convergence::of_file(&scene, Some("weak"), None)
        .err()
        .unwrap();
    assert!(unknown.to_string().contains("weak"), "{unknown}");
    assert!(!folder.join("out").exists());
}

/// A load at each node of a set is another load on a finer mesh.
#[test]
fn nodal_loads_that_grow_are_refused() {
    let (folder, scene) = folder("load", ELASTIC);
    let text = SCENE.replace("LAW", ELASTIC)
        + "[[load]]\nkind = \"nodal\"\nset = \"top\"\nforce = [0, 0, 1e3]\n";
    std::fs::write(&scene, text).unwrap();
    let study = Convergence::of_file(&scene, None, Some(folder.join("out"))).unwrap();
    let refused = study.run(None, &mut NoProgress).unwrap_err();
    assert!(
        matches!(&refused, StudyError::MoreLoad { set, nodes: 36, more: 121 } if set == "top"),
        "{refused}"
    );
}
