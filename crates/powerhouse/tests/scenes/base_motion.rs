//! Prescribed motions by records: their delay, and its report.

use powerhouse::engine::Prescribed;
use powerhouse::io::write_gmsh;
use powerhouse::material::LinearElastic;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::wavefield::{
    BaselineCorrection, EndDisplacement, RecordSignal, Signal, TimeHistory,
};
use powerhouse::{
    Error, FileScene, Material, Part, Registry, Remark, RenderFault as _, Results, RunHooks, Scene,
    SceneStage, remark,
};

use super::support::{Folder, ROCK, Variants, WAVE};

const STEP: f64 = 0.02;

const COLUMN: &str = r#"
title = "column"
[mesh]
file = "column.msh"
[[material]]
name = "rock"
law = "elastic"
young = 2e9
poisson = 0.25
density = 2600
[[part]]
set = "rock"
material = "rock"
[output]
every = 0.05
[[output.history]]
name = "base"
at = [0, 0, 0]
"#;

/// Burst of 20 s that grows up to a time (s), with a drift that a filter removes.
fn record(swell: f64) -> TimeHistory {
    let at = |i: usize| {
        let t = i as f64 * STEP;
        let envelope = (-((t - swell) / 2.0).powi(2)).exp();
        envelope * ((7.0 * t).sin() + 0.4 * (2.3 * t).cos() + 0.03)
    };
    TimeHistory::new(STEP, (0..1000).map(at).collect()).unwrap()
}

fn filtered(history: &TimeHistory, corner: f64) -> (RecordSignal, f64) {
    let correction = BaselineCorrection::HighPass { corner, order: 2 };
    let (history, report) = history.corrected(correction).unwrap();
    let signal = history.into_signal(EndDisplacement::Zero).unwrap();
    (signal, report.leading_pad)
}

/// Reads the scene of a column whose base moves by records, each along an axis: of a corner frequency (Hz)
/// of their filters and a time (s) to which they swell.
fn column(records: &[(usize, f64, f64)], duration: f64) -> Scene {
    let folder = Folder::new("base");
    let (high, counts) = (Vec3::new(10.0, 10.0, 60.0), [1, 1, 3]);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), high, counts, "rock").unwrap();
    write_gmsh(folder.join("column.msh"), &mesh).unwrap();
    let mut text = format!("{COLUMN}[time]\nduration = {duration}\n");
    for &(axis, corner, swell) in records {
        let samples = record(swell).acceleration().into_iter();
        let lines: String = samples.map(|a| format!("{a:e}\n")).collect();
        std::fs::write(folder.join(format!("{axis}.txt")), lines).unwrap();
        let direction = Vec3::ith(axis, 1.0);
        let [x, y, z] = direction.into();
        text += &format!(
            "[[record]]\nname = \"r{axis}\"\nfile = \"{axis}.txt\"\nunits = \"m/s2\"\n\
             time_step = {STEP}\nconvention = \"incident\"\n\
             baseline = {{ kind = \"high-pass\", corner = {corner}, order = 2 }}\n\
             [[support]]\nkind = \"prescribed\"\nset = \"bottom\"\ndirection = [{x}, {y}, {z}]\n\
             record = \"r{axis}\"\n"
        );
    }
    FileScene::from_toml(text, folder.join("column.toml"), &Registry::default())
        .unwrap()
        .into_scene()
}

fn run(scene: Scene) -> (Vec<Remark>, Results) {
    let simulation = scene.prepare().unwrap();
    let remarks = simulation.remarks().to_vec();
    (remarks, simulation.run(RunHooks::default()).unwrap())
}

fn padding(remarks: &[Remark]) -> Option<f64> {
    remarks.iter().find_map(|remark| match remark {
        Remark::DelayedMotion(remark::DelayedMotion { padding, .. }) => Some(*padding),
        _ => None,
    })
}

/// The base has the motion of the filtered record from its original start on, after a smooth ramp; where the lead of the
/// filter is not negligible before, all records are delayed by the least sufficient time, which is reported.
#[test]
fn the_base_moves_from_the_start_of_its_record() {
    const QUIET: f64 = 1e-4;
    for records in [
        vec![(0, 2.0, 10.0)],
        vec![(1, 0.2, 6.0)],
        vec![(0, 0.2, 6.0), (2, 1.0, 9.0)],
    ] {
        let (remarks, results) = run(column(&records, 30.0));
        let padding = padding(&remarks).unwrap_or(0.0);
        let (mut most_before, mut most_just_before) = (0.0_f64, 0.0_f64);
        for &(axis, corner, swell) in &records {
            let (signal, lead) = filtered(&record(swell), corner);
            let name = ["base.ux", "base.uy", "base.uz"][axis];
            let column = results.histories().column(name).unwrap();
            let peak = signal.report().peak_displacement;
            // Rows between steps are on the chord of the two.
            let chord = signal.report().peak_acceleration * results.run.step.powi(2) / 8.0;
            for (time, found) in results.histories().times.iter().zip(&column.values) {
                let expected = signal.motion(time + lead - padding).displacement;
                // Ramp over half a period of the corner frequency, while the motion is small.
                let share = if *time < 0.5 / corner { QUIET } else { 1e-9 };
                let error = (found - expected).abs();
                assert!(
                    error < share * peak + chord,
                    "{name} {time} {found} {expected}"
                );
            }
            // A sudden displacement would be an impact.
            let velocity = results
                .histories()
                .column(&name.replace(".u", ".v"))
                .unwrap();
            let early = results.histories().times.iter().zip(&velocity.values);
            let early = early.filter(|(time, _)| **time < 0.5 / corner);
            let blow = early.fold(0.0_f64, |most, (_, v)| most.max(v.abs()));
            assert!(
                blow < 1e-3 * signal.report().peak_velocity,
                "{name}: {blow}"
            );
            let most = column
                .values
                .iter()
                .fold(0.0_f64, |most, u| most.max(u.abs()));
            assert!(most > 0.5 * peak, "{name}: {most} of {peak}");
            let report = signal.report();
            let level = |time: f64| {
                let motion = signal.motion(time);
                let displacement = (motion.displacement / report.peak_displacement).abs();
                displacement.max((motion.velocity / report.peak_velocity).abs())
            };
            let start = lead - padding + 0.5 / corner;
            let before = (0..=(start / STEP) as usize).map(|i| level(start - i as f64 * STEP));
            most_before = before.fold(most_before, f64::max);
            most_just_before = most_just_before.max(level(start + STEP)).max(level(start));
        }
        assert!(most_before < QUIET, "{most_before}");
        if padding > 0.0 {
            assert!(most_just_before >= QUIET, "{padding}: {most_just_before}");
        }
        assert_eq!(padding > 0.0, records[0].1 < 1.0, "{padding}");
    }
}

/// The remark of a record contains its lead, and a run that ends before most of a record has arrived has a warning with
/// the sufficient time.
#[test]
fn leads_and_ends_are_said() {
    let said = |duration: f64| {
        let scene = column(&[(0, 0.5, 12.0)], duration).prepare().unwrap();
        let lines = scene
            .remarks()
            .iter()
            .map(|remark| (remark.is_warning(), remark.to_string()));
        lines.collect::<Vec<_>>()
    };
    let (_, lead) = filtered(&record(12.0), 0.5);
    let record = |line: &&(bool, String)| line.1.starts_with("record 'r0': PGA");
    let lines = said(20.0);
    let line = &lines.iter().find(record).unwrap().1;
    assert!(
        line.contains(&format!(
            "extends it by {lead:.3} s before its original start"
        )),
        "{line}"
    );
    let short = |line: &&(bool, String)| line.0 && line.1.contains("before record 'r0' ends at");
    assert!(!lines.iter().any(|line| short(&line)), "{lines:?}");
    let lines = said(8.0);
    let line = &lines.iter().find(short).unwrap().1;
    assert!(line.contains("the run ends at 8.000 s"), "{line}");
}

/// A wave with a filter lead that is not negligible is an error with a hint on the filter; one without filter has no such
/// hint.
#[test]
fn a_filter_that_rings_too_long_is_named() {
    let variants = Variants::new("rings");
    let lines: String = record(10.0)
        .acceleration()
        .iter()
        .map(|a| format!("{a:e}\n"))
        .collect();
    std::fs::write(variants.0.join("r.txt"), lines).unwrap();
    let refused = |baseline: &str| {
        let keys = format!(
            "[[record]]\nname = \"r\"\nfile = \"r.txt\"\nunits = \"m/s2\"\ntime_step = {STEP}\n\
             convention = \"incident\"\nbaseline = {baseline}\n\
             [[wave]]\nkind = \"sv\"\nincidence = 20\nrecord = \"r\"\n"
        );
        match variants.read(WAVE, &keys) {
            Err(Error::Scene(fault)) => Some(fault.render(false)),
            Err(other) => panic!("{other}"),
            Ok(_) => None,
        }
    };
    let shown = refused("{ kind = \"high-pass\", corner = 0.03, order = 2 }").unwrap();
    assert!(shown.contains("s of padding"), "{shown}");
    assert!(
        shown.contains("`corner`") && shown.contains("velocity-polynomial"),
        "{shown}"
    );
    assert_eq!(
        refused("{ kind = \"velocity-polynomial\", order = 5 }"),
        None
    );
}

/// A prescribed displacement that begins with a jump, or with a velocity, has a warning with its size; one that begins
/// at rest has none, and neither has one that stages hold at its first value.
#[test]
fn sudden_prescribed_motions_are_warned_of() {
    let remarks = |motion: fn(f64) -> f64, start: f64, stages: bool| {
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(4.0, 4.0, 12.0), [1, 1, 3], "rock");
        let mesh = mesh.unwrap();
        let nodes = mesh.nodes_of_facets(mesh.facet_set("bottom").unwrap());
        let mut scene = Scene::new("column", mesh)
            .part(Part::new("rock", Material::from(LinearElastic::new(ROCK))))
            .prescribed(Prescribed {
                nodes,
                direction: Vec3::new(0.0, 2.0, 0.0),
                displacement: Box::new(move |time: f64| motion(time)),
            })
            .with_start_time(start)
            .with_duration(2.0);
        if stages {
            scene = scene.stage(SceneStage::new("held"));
        }
        let simulation = scene.prepare().unwrap();
        let mut sudden = [0.0, 0.0, 0.0];
        for remark in simulation.remarks() {
            match remark {
                Remark::PrescribedJump(remark::PrescribedJump {
                    nodes,
                    displacement,
                    ..
                }) => {
                    assert_eq!(*nodes, 4);
                    sudden[0] += displacement;
                }
                Remark::PrescribedVelocity(remark::PrescribedVelocity {
                    velocity, share, ..
                }) => {
                    sudden[1] += velocity;
                    sudden[2] += share;
                }
                _ => {}
            }
        }
        sudden
    };
    let near = |found: [f64; 3], expected: [f64; 3]| {
        let off = (0..3).map(|i| (found[i] - expected[i]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-3, "{found:?} {expected:?}");
    };
    near(remarks(|_| -0.02, 0.0, false), [-0.02, 0.0, 0.0]);
    near(remarks(|t| 0.3 * t.min(0.5), 0.0, false), [0.0, 0.3, 1.0]);
    near(
        remarks(|t| 0.01 * (12.0 * t).sin(), 0.0, false),
        [0.0, 0.12, 1.0],
    );
    // At a quarter of a period the displacement jumps, but not the velocity.
    near(remarks(|t| 0.01 * t.cos(), 0.0, false), [0.01, 0.0, 0.0]);
    near(
        remarks(|t| 0.5 * (t - 1.0) + 0.4 * (t - 1.0).powi(2), 1.0, false),
        [0.0, 0.5, 0.5 / 2.1],
    );
    near(
        remarks(|t| 0.01 * (1.0 - (12.0 * t).cos()), 0.0, false),
        [0.0; 3],
    );
    near(
        remarks(|t| 0.1 * (-(t - 1.0).powi(2) / 0.02).exp(), 0.0, false),
        [0.0; 3],
    );
    near(remarks(|_| 0.0, 0.0, false), [0.0; 3]);
    near(remarks(|_| -0.02, 0.0, true), [0.0; 3]);
}
