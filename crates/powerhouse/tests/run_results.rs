//! Results and result files of runs, including failed ones.

use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::Ended;
use powerhouse::engine::observe::{CrossSection, Motion};
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{
    Cadence, Fields, Flow, Mesh, ModelError, Observer, ParameterError, RunError, StepView, Vec3,
};
use powerhouse::wavefield::{PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind};
use powerhouse::{
    Boundary, Error, FileScene, FolderError, Material, OutputPlan, Part, Registry, Remark,
    ResidualLimit, ResultFolder, Results, RunHooks, RunNotes, Scene, SnapshotRequest, remark,
};

use powerhouse_test_support::TestFolder as Folder;

const SIDES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

/// A cube of rock of 300 m under a vertical P wave, for 0.3 s.
fn cube() -> Scene {
    let (low, high) = (Vec3::new(0.0, 0.0, -300.0), Vec3::new(300.0, 300.0, 0.0));
    let mesh = Mesh::box_of_hexes(low, high, [4; 3], "rock").unwrap();
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::P, media::ROCK, 0.0);
    parameters.reference = low;
    let pulse = Arc::new(SmoothPulse::new(0.01, 0.4).unwrap());
    let top = Vec3::new(150.0, 150.0, 0.0);
    Scene::new("cube", mesh)
        .part(Part::new(
            "rock",
            Material::from(LinearElastic::new(media::ROCK)),
        ))
        .with_field(PlaneWave::new(parameters, pulse).unwrap())
        .with_boundary(Boundary::new(ViscousSpring::default(), SIDES).with_scatterer(top))
        .with_duration(0.3)
        .with_output(
            OutputPlan::default()
                .history("top", top, Motion::ALL)
                .with_energies(0.01),
        )
}

fn run(scene: Scene) -> Result<Results, Error> {
    scene.prepare()?.run(RunHooks::default())
}

/// A run checks its energy balance unless the check is off: it reports the residual, and stops with the name of the set
/// where the residual exceeds the tolerance.
#[test]
fn the_energy_balance_is_checked() {
    let results = run(cube()).unwrap();
    let residual = results.energy_residual().unwrap();
    assert!(residual.largest > 0.0 && residual.largest < 1e-12);
    assert!(residual.share_of_input.unwrap() < 1e-12);
    let names: Vec<&str> = results
        .energy_terms()
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    for name in ["kinetic", "elastic", "dashpots", "springs", "loads"] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
    assert!(!names.contains(&"friction") && !names.contains(&"residual"));

    // Also without a history of energies.
    for plan in [cube().output().clone(), OutputPlan::default()] {
        let share = ResidualLimit::Share(1e-3 * residual.largest);
        let scene = cube().with_output(plan.clone()).with_energy_residual(share);
        match run(scene) {
            Err(Error::Failed {
                error: RunError::EnergyResidual { set, residual, .. },
                results,
            }) => {
                assert!(set == "rock" && residual.abs() < 1e-12);
                // What limited the step, a shorter one, and where to look.
                let stable = results.run.stable.unwrap();
                let [limit, shorter, place] = &results.advice[..] else {
                    panic!("{:?}", results.advice)
                };
                let element = format!("element {} of set 'rock'", stable.element);
                assert!(
                    limit.contains(&element) && limit.contains("100 %"),
                    "{limit}"
                );
                let half = format!("{:.4e} s", 0.5 * results.run.step);
                assert!(shorter.contains(&half), "{shorter}");
                assert!(place.contains("set 'rock'"), "{place}");
            }
            other => panic!("{other:?}"),
        }
        let unchecked = cube()
            .with_output(plan)
            .with_energy_residual(ResidualLimit::Unchecked);
        assert_eq!(run(unchecked).unwrap().run.ended, Ended::Completed);
    }
    for wrong in [0.0, 1.5, f64::NAN] {
        let scene = cube().with_energy_residual(ResidualLimit::Share(wrong));
        assert!(matches!(
            scene.prepare(),
            Err(Error::Parameter(ParameterError { .. }))
        ));
    }
}

/// Observer that fails at a given step.
struct Fails {
    at: u64,
}

impl Observer for Fails {
    fn name(&self) -> &str {
        "doubter"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(1)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        if view.number() == self.at {
            return Err(ParameterError::check("warning", 1.0, 0.0, 0.5)
                .unwrap_err()
                .into());
        }
        Ok(Flow::Continue)
    }
}

/// A failed run returns the results recorded until then; its summary states the failure.
#[test]
fn a_failed_run_keeps_what_it_recorded() {
    let folder = Folder::new("failed");
    let simulation = cube().prepare().unwrap();
    let mesh = simulation.mesh().clone();
    let hooks = RunHooks::default().with_observer(Fails { at: 9 });
    let Err(Error::Failed { error, results }) = simulation.run(hooks) else {
        panic!("the observer's failure went unheard")
    };
    assert!(matches!(&error, RunError::Observer { name, step: 9, .. } if name == "doubter"));
    // An observer's error says it all.
    assert!(results.advice.is_empty(), "{:?}", results.advice);
    assert_eq!(results.run.steps, 9);
    assert_eq!(results.run.ended, Ended::Failed(error.to_string()));
    let times = &results.histories().times;
    assert!(times.len() >= 9, "{times:?}");
    assert_eq!(
        results.histories().column("top.uz").unwrap().values.len(),
        times.len()
    );

    let results_of = ResultFolder::new(&folder);
    results_of
        .write(("cube", &mesh), &results, &RunNotes::default(), None)
        .unwrap();
    let summary = std::fs::read_to_string(folder.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["ended"], "failed");
    assert_eq!(summary["failure"], error.to_string());
    assert!(folder.join("histories.csv").exists());
}

/// Results of an earlier run are removed before the next one; other files in the folder are kept.
#[test]
fn old_results_do_not_mix_with_new_ones() {
    let folder = Folder::new("mix");
    let results_of = ResultFolder::new(&folder);
    let go = |snapshots: bool| {
        let mut scene = cube();
        let mut plan = scene.output().clone();
        plan.snapshots = snapshots.then_some(SnapshotRequest::new(0.1));
        scene = scene.with_output(plan);
        let simulation = scene.prepare().unwrap();
        let mesh = simulation.mesh().clone();
        results_of.create().unwrap();
        results_of.clear().unwrap();
        let hooks = RunHooks::default().with_snapshots(results_of.snapshots(&simulation).unwrap());
        let results = simulation.run(hooks).unwrap();
        let files = results_of.write(("cube", &mesh), &results, &RunNotes::default(), None);
        files.unwrap().contains(&folder.join("snapshots.pvd"))
    };
    assert!(go(true));
    assert!(
        folder.join("snapshots/snapshots_00003.vtu").exists()
            && folder.join("plots/top.svg").exists()
    );
    for own in ["notes.txt", "scene.toml", "plots/notes.txt"] {
        std::fs::write(folder.join(own), "mine").unwrap();
    }
    std::fs::rename(folder.join("plots/top.svg"), folder.join("plots/old.svg")).unwrap();
    assert!(!go(false));
    assert!(
        !folder.join("snapshots.pvd").exists()
            && !folder.join("snapshots/snapshots_00000.vtu").exists()
    );
    assert!(!folder.join("plots/old.svg").exists() && folder.join("plots/top.svg").exists());
    for own in ["notes.txt", "scene.toml", "plots/notes.txt"] {
        assert!(folder.join(own).exists(), "{own}");
    }
}

/// Files of other programs are kept, even if their names are those of results.
#[test]
fn a_folder_of_others_is_left_alone() {
    let folder = Folder::new("others");
    std::fs::create_dir_all(folder.join("pictures")).unwrap();
    let theirs = ["summary.json", "histories.csv", "pictures/holiday.png"];
    for file in theirs {
        std::fs::write(folder.join(file), "{\"software\": \"another\"}").unwrap();
    }
    ResultFolder::new(&folder).clear().unwrap();
    assert!(theirs.iter().all(|file| folder.join(file).exists()));
}

/// Of the files that a summary lists those below its folder are removed, but for the scene; a table that a killed run has begun, too.
#[test]
fn a_summary_names_no_file_elsewhere() {
    let folder = Folder::new("listed");
    std::fs::create_dir_all(folder.join("out/lists")).unwrap();
    let kept = ["kept.csv", "out/scene.toml", "out/notes.csv"];
    let gone = ["out/own.csv", "out/lists/own.csv"];
    for file in kept.iter().chain(&gone) {
        std::fs::write(folder.join(file), "1").unwrap();
    }
    let outside = folder.join("kept.csv");
    let files = [
        "",
        "..",
        "../kept.csv",
        &outside.to_string_lossy(),
        "scene.toml",
        "lists/own.csv",
    ];
    let summary = format!(
        "{{\"software\": \"powerhouse 0\", \"files\": {files:?}, \"tables\": [\"own.csv\"]}}"
    );
    std::fs::write(folder.join("out/summary.json"), summary).unwrap();
    ResultFolder::new(folder.join("out")).clear().unwrap();
    assert!(kept.iter().all(|file| folder.join(file).exists()));
    assert!(!gone.iter().any(|file| folder.join(file).exists()));
}

/// A results folder is created and tested before a run; one that cannot be created is an error with its path.
#[test]
fn a_folder_is_tried_before_a_run() {
    let folder = Folder::new("tried");
    let results_of = ResultFolder::new(folder.join("deep/er"));
    results_of.create().unwrap();
    assert_eq!(std::fs::read_dir(results_of.path()).unwrap().count(), 0);
    std::fs::write(folder.join("file"), "").unwrap();
    let in_the_way = ResultFolder::new(folder.join("file"));
    let error = in_the_way.create().unwrap_err();
    assert!(error.to_string().contains("file"), "{error}");
}

/// A scene file sets the tolerance of the energy balance; an invalid one is reported with its position.
#[test]
fn a_file_sets_the_limit_of_the_balance() {
    let text = |limit: &str| {
        let mesh = "data/meshes/cavern_small.msh";
        let mesh = std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR"))
            .join("../..")
            .join(mesh);
        format!(
            "title = \"t\"\nenergy_residual = {limit}\n[mesh]\nfile = '{}'\n\
             [[material]]\nname = \"m\"\nlaw = \"elastic\"\nyoung = 1e9\npoisson = 0.2\ndensity = 2000\n\
             [[part]]\nset = \"rock\"\nmaterial = \"m\"\n[[part]]\nset = \"lining\"\nmaterial = \"m\"\n\
             [[load]]\nkind = \"gravity\"\n[time]\nduration = 0.02\n",
            mesh.display()
        )
    };
    let read = |limit: &str| {
        FileScene::from_toml(text(limit), "t.toml", &Registry::default()).map(FileScene::into_scene)
    };
    for limit in ["\"auto\"", "\"off\"", "1e-6"] {
        assert!(run(read(limit).unwrap()).is_ok(), "{limit}");
    }
    assert!(matches!(
        run(read("1e-300").unwrap()),
        Err(Error::Failed {
            error: RunError::EnergyResidual { .. },
            ..
        })
    ));
    for wrong in ["\"none\"", "0.0", "2", "nan"] {
        match read(wrong) {
            Err(Error::Scene(fault)) => assert_eq!(fault.position(), (2, 19), "{fault}"),
            _ => panic!("{wrong} was accepted"),
        }
    }
}

/// Section forces through linear tetrahedra have a warning with the name of the section and a remedy: in the remarks of
/// the run, in the head of their table and in the summary. Sections through bricks have none, nor have tetrahedra
/// without section.
#[test]
fn sections_through_tetrahedra_are_doubted() {
    let size = Vec3::new(40.0, 30.0, 20.0);
    let bricks = Mesh::box_of_hexes(Vec3::zeros(), size, [4, 3, 2], "rock").unwrap();
    let tetrahedra = Mesh::box_of_tets(Vec3::zeros(), size, [4, 3, 2], "rock").unwrap();
    let cut = CrossSection {
        name: "waist".into(),
        point: Vec3::new(15.0, 15.0, 10.0),
        normal: Vec3::x(),
        along: Vec3::y(),
        within: None,
    };
    for (name, mesh, is_cut, doubted) in [
        ("bricks", bricks, true, false),
        ("tets", tetrahedra.clone(), true, true),
        ("uncut", tetrahedra, false, false),
    ] {
        let folder = Folder::new(&format!("cut-{name}"));
        let rock = Material::from(LinearElastic::new(media::ROCK));
        let plan = OutputPlan::default();
        let plan = if is_cut {
            plan.cut("rock", cut.clone())
        } else {
            plan
        };
        let scene = Scene::new("cut", mesh)
            .part(Part::new("rock", rock))
            .with_duration(0.01)
            .with_output(plan);
        let simulation = scene.prepare().unwrap();
        let notes = RunNotes::new(simulation.remarks().to_vec());
        let told = notes.remarks.iter().filter(|remark| remark.is_warning());
        let told: Vec<String> = told.map(ToString::to_string).collect();
        let says = |text: &str| {
            text.contains("section 'waist' cuts") && text.contains("hexahedra or wedges")
        };
        assert_eq!(
            told.iter().any(|text| says(text)),
            doubted,
            "{name}: {told:?}"
        );
        let mesh = simulation.mesh().clone();
        let results = simulation.run(RunHooks::default()).unwrap();
        let out = ResultFolder::new(&folder);
        out.write(("cut", &mesh), &results, &notes, None).unwrap();
        let read = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap_or_default();
        assert_eq!(says(&read("summary.json")), doubted, "{name}");
        let table = read("sections.csv");
        assert_eq!(
            table.starts_with("# warning: ") && says(&table),
            doubted,
            "{table}"
        );
        if is_cut {
            let columns = powerhouse::io::read_table(&folder.join("sections.csv")).unwrap();
            assert!(columns.len() > 1);
        }
    }
}

/// A ring of concrete about the axis y through (0, 0, -20) m, of mean radius 5 m.
fn ring() -> Mesh {
    let (low, high) = (Vec3::new(0.0, 0.0, 4.8), Vec3::new(1.0, 2.0, 5.2));
    let strip = Mesh::box_of_hexes(low, high, [16, 2, 2], "lining").unwrap();
    strip
        .map_positions(|p| {
            let (sin, cos) = (1.5 * std::f64::consts::PI * p.x).sin_cos();
            Vec3::new(-p.z * cos, p.y, p.z * sin - 20.0)
        })
        .unwrap()
}

/// A section whose plane cuts a face at which the ring ends is warned of by name; one on the face, or beside it, is not.
#[test]
fn a_section_through_an_end_of_a_ring_is_warned_of() {
    for (height, slope, warned) in [
        (0.0, 0.0, false),
        (0.0, 0.5, true),
        (0.05, -0.6, true),
        (0.9, 0.1, false),
    ] {
        let point = Vec3::new(-5.0, 1.0, height - 20.0);
        let cut = CrossSection {
            name: "end".into(),
            point,
            normal: Vec3::new(slope, 0.0, 1.0),
            along: Vec3::y(),
            within: Some((point - Vec3::repeat(3.0), point + Vec3::repeat(3.0))),
        };
        let concrete = Material::from(LinearElastic::new(media::CONCRETE));
        let scene = Scene::new("ring", ring())
            .part(Part::new("lining", concrete))
            .with_duration(0.001)
            .with_output(OutputPlan::default().cut("lining", cut));
        let simulation = scene.prepare().unwrap();
        let remarks = simulation.remarks().iter();
        let texts: Vec<String> = remarks
            .filter(|remark| remark.is_warning())
            .map(ToString::to_string)
            .collect();
        let named = "section 'end' cuts a face at which 'lining' ends";
        assert_eq!(
            texts.iter().any(|text| text.contains(named)),
            warned,
            "{height} {slope}: {texts:?}"
        );
    }
}

/// A section that cuts two sides of a ring has a warning with the centre and extents of both and the values of `half_extent`
/// that take one: in the remarks, in the head of the table of sections and in the summary. With such a value there is
/// none, beyond it there is.
#[test]
fn sections_through_both_sides_of_a_ring_are_warned_of() {
    let scene = |cut: &CrossSection| {
        let concrete = Material::from(LinearElastic::new(media::CONCRETE));
        Scene::new("ring", ring())
            .part(Part::new("lining", concrete))
            .with_duration(0.001)
            .with_output(OutputPlan::default().cut("lining", cut.clone()))
    };
    // The open quarter is below on the left: these planes meet the rest twice.
    for (point, normal) in [
        (Vec3::new(-4.9, 1.0, -19.0), Vec3::z()),
        (Vec3::new(-3.6, 1.0, -16.4), Vec3::new(1.0, 0.0, 1.0)),
    ] {
        let cut = |reach: Option<f64>| CrossSection {
            name: "spring".into(),
            point,
            normal,
            along: Vec3::y(),
            within: reach.map(|reach| (point - Vec3::repeat(reach), point + Vec3::repeat(reach))),
        };
        let divided = |reach: Option<f64>| {
            let simulation = scene(&cut(reach)).prepare().unwrap();
            assert_eq!(simulation.section_geometry().len(), 1);
            let remarks = simulation.remarks().iter();
            let mut found = remarks.filter_map(|remark| match remark {
                Remark::DividedSection(remark::DividedSection {
                    pieces,
                    half_extent,
                    ..
                }) => Some((pieces.clone(), *half_extent)),
                _ => None,
            });
            found.next()
        };
        let (pieces, reach) = divided(None).unwrap();
        assert_eq!(pieces.len(), 2);
        assert!((pieces[0].centroid - pieces[1].centroid).norm() > 9.0);
        let [least, most] = reach.unwrap();
        assert_eq!(divided(Some(least)), None);
        assert_eq!(divided(Some(0.5 * (least + most))), None);
        assert_eq!(divided(Some(most)), None);
        assert!(divided(Some(most + 2.0)).is_some());

        let folder = Folder::new("both-sides");
        let simulation = scene(&cut(None)).prepare().unwrap();
        let notes = RunNotes::new(simulation.remarks().to_vec());
        let mesh = simulation.mesh().clone();
        let results = simulation.run(RunHooks::default()).unwrap();
        let out = ResultFolder::new(&folder);
        out.write(("ring", &mesh), &results, &notes, None).unwrap();
        let read = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap_or_default();
        let centre = pieces[0].centroid;
        let shown = format!("({:.3}, {:.3}, {:.3}) m", centre.x, centre.y, centre.z);
        for text in [read("summary.json"), read("sections.csv")] {
            assert!(text.contains("section 'spring' cuts 2 pieces of 'lining'"));
            assert!(
                text.contains(&shown)
                    && text.contains(&format!("`half_extent` from {least} to {most} m"))
            );
        }
        assert!(read("sections.csv").starts_with("# warning: "));
    }
    // No cube around the centre takes one side alone.
    let point = Vec3::new(0.0, 1.0, -19.0);
    let cut = CrossSection {
        name: "spring".into(),
        point,
        normal: Vec3::z(),
        along: Vec3::y(),
        within: None,
    };
    let simulation = scene(&cut).prepare().unwrap();
    let found = simulation
        .remarks()
        .iter()
        .find(|remark| remark.is_warning());
    let text = found.unwrap().to_string();
    assert!(text.contains("give a point of it as `at`"), "{text}");
}

/// A folder admits one run at a time, which the refusal of a second one names; afterwards the next may start, and the
/// lock file is removed.
#[test]
fn a_folder_has_one_run_at_a_time() {
    let folder = Folder::new("lock-one");
    let results = ResultFolder::new(&folder);
    let first = results.lock().unwrap();
    let refused = results.lock().unwrap_err().to_string();
    let own = format!("another run (process {}, since 20", std::process::id());
    assert!(refused.contains(&own), "{refused}");
    first.release().unwrap();
    let second = results.lock().unwrap();
    assert_eq!(second.remark(), None);
    drop(second);
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
}

/// The lock of a killed run is taken over, with a remark that names the run.
#[test]
fn the_lock_of_a_dead_run_is_taken_over() {
    let folder = Folder::new("lock-dead");
    let dead = "process 1234, since 2001-02-03 04:05:06 UTC";
    std::fs::write(folder.join(".powerhouse-lock"), format!("{dead}\n1.0\n")).unwrap();
    let lock = ResultFolder::new(&folder).lock().unwrap();
    let remark = lock.remark().unwrap();
    assert!(remark.ends_with(&format!("({dead})")), "{remark}");
}

/// A folder that is removed, or replaced by that of another run, is detected.
#[test]
fn a_removed_folder_is_detected() {
    let folder = Folder::new("lock-gone");
    let results = ResultFolder::new(&folder);
    let lock = results.lock().unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(!lock.is_held());
    let other = results.lock().unwrap();
    let refused = lock.release().unwrap_err();
    assert!(matches!(refused, Error::Folder(FolderError::Gone { .. })));
    // Dropping the first lock did not remove the lock file of the other run.
    assert!(other.is_held());
}

/// Tables are on disk while the run goes on, in lines of the final tables, and a summary says that it goes on: a run
/// that is killed leaves them. A file that is removed meanwhile comes again.
#[test]
fn tables_grow_while_the_run_goes_on() {
    let folder = Folder::new("growing-tables");
    let results = ResultFolder::new(&*folder);
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap_or_default();
    let simulation = cube().with_duration(0.9).prepare().unwrap();
    let (title, mesh) = (simulation.title().to_owned(), simulation.mesh().clone());
    results.begin(&simulation).unwrap();
    let mut seen = Vec::new();
    let tables = results.tables().with_interval(std::time::Duration::ZERO);
    let hooks = RunHooks::default()
        .with_tables(tables)
        .with_progress(|now| {
            if now.done.is_multiple_of(4) {
                seen.push((now.time, ["histories.csv", "energies.csv"].map(read)));
            }
            if now.done == 20 {
                let summary = read("summary.json");
                assert!(summary.contains("incomplete"), "{summary}");
                std::fs::remove_file(folder.join("energies.csv")).unwrap();
            }
        });
    let outcome = simulation.run(hooks).unwrap();
    let notes = RunNotes::default();
    results
        .write((&title, &mesh), &outcome, &notes, None)
        .unwrap();
    assert!(seen.len() > 3, "{}", seen.len());
    for (index, name) in ["histories.csv", "energies.csv"].into_iter().enumerate() {
        let end = read(name);
        for (time, texts) in &seen {
            let text = &texts[index];
            assert!(
                end.starts_with(text) && text.ends_with('\n'),
                "{name}, {time} s"
            );
            // The last row is younger than an interval of the output and two steps.
            let last = text.lines().last().unwrap().split(',').next().unwrap();
            let last: f64 = last.parse().unwrap();
            assert!(
                time - last < 0.01 + 2.0 * outcome.run.step,
                "{name}: {last} s of {time} s"
            );
        }
        let rows = |text: &str| text.lines().count();
        assert!(rows(&seen[0].1[index]) < rows(&seen[2].1[index]), "{name}");
    }
}
