//! Sweeps: cases of a scene, their shared stages, what is not run again.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use powerhouse::io::{read_table, write_gmsh};
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{BodyAtRest, Error, RunHooks, Scene};
use powerhouse_study::sweep::{CaseOutcome, Silent, Sweep, SweepWatch};
use powerhouse_study::{StudyError, read_outcomes, registry, sensitivity, write_report};

const BAY: &str = "size = \"coarse\"\n[dimensions]\nbelow = 50\n";

/// A slice of ground in a scene of its own folder: elastic, one stage, two cases and one without joint.
const SCENE: &str = r#"
title = "bay"
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
[[part]]
set = "void"
material = "rock"
[[part]]
set = "structure"
material = "rock"
[[joint]]
name = "seam"
between = ["rock", "structure"]
law = "bonded-coulomb"
cohesion = 1e6
tensile_strength = 1e6
static_friction = 0.8
dynamic_friction = 0.7
[[load]]
kind = "gravity"
[[support]]
kind = "roller"
set = "front"
[[support]]
kind = "roller"
set = "back"
[in_situ_stress]
kind = "ground"
level = 24
density = 2750
lateral = 0.37
[[bolt]]
name = "pins"
diameter = 0.025
lines = [[[4, 3, 23], [4.2, 3, 14]], [[20, 3, 23], [19, 3, 15]]]
[[stage]]
name = "opening"
excavate = ["void"]
bolts = ["pins"]
tied = ["seam"]
tolerance = 1e-3
support = [
    { kind = "roller", set = "left" },
    { kind = "roller", set = "right" },
    { kind = "roller", set = "bottom" },
]
[[wave]]
kind = "p"
incidence = 0
pulse = { kind = "smooth", displacement = 0.01, duration = 0.1 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "bottom"]
scatterer = [12, 3, 12]
[time]
duration = 0.05
[output]
every = 0.005
[[output.history]]
name = "A"
set = "point_A"
quantities = ["displacement"]
[[output.history]]
name = "O1"
set = "point_O1"
quantities = ["acceleration"]
[[output.section]]
name = "waist"
set = "structure"
at = [12, 3, 8]
normal = [0, 0, 1]
along = [0, 1, 0]
[[output.joint]]
name = "seam-side"
joint = "seam"
low = [8, -1, 5]
high = [10, 7, 13]
quantities = ["state"]
[[output.relative]]
name = "A-O1"
set = "point_A"
from_set = "point_O1"
[[case]]
name = "steep"
[[case]]
name = "slanted"
wave = [{ kind = "p", incidence = 20, pulse = { kind = "smooth", displacement = 0.01, duration = 0.1 } }]
[[case]]
name = "continuous"
continuous = ["seam"]
"#;

/// Ground of 24 m by 6 m by 24 m times a scale, with a structure at its heart and a void above that.
fn slice(scale: f64) -> Mesh {
    let size = Vec3::new(24.0, 6.0, 24.0);
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [8, 2, 8], "rock").unwrap();
    let within = |mesh: &Mesh, low: f64, high: f64| {
        mesh.elements_in_box(&Vec3::new(9.0, 0.0, low), &Vec3::new(15.0, 6.0, high))
    };
    let (structure, void) = (within(&mesh, 6.0, 12.0), within(&mesh, 12.0, 18.0));
    let all = 0..mesh.element_count() as u32;
    let rock = all
        .filter(|e| !structure.contains(e) && !void.contains(e))
        .collect();
    for (name, elements) in [("rock", rock), ("structure", structure), ("void", void)] {
        mesh.set_element_set(name, elements).unwrap();
    }
    for (name, z) in [("point_A", 18.0), ("point_O1", 6.0)] {
        let at = Vec3::new(12.0, 3.0, z);
        let nodes = mesh.nodes_in_box(&at, &at);
        mesh.set_node_set(name, nodes).unwrap();
    }
    mesh.map_positions(|position| position * scale).unwrap()
}

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("powerhouse-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        std::fs::write(path.join("bay.toml"), BAY).unwrap();
        std::fs::write(path.join("scene.toml"), SCENE).unwrap();
        write_gmsh(path.join("mesh.msh"), &slice(1.0)).unwrap();
        Self(path)
    }
    /// The scene of a bay, without what looks at places of the slice.
    fn bay() -> String {
        let place = |text: &str| SCENE.find(text).unwrap();
        let (bolt, stage) = (place("[[bolt]]"), place("[[stage]]"));
        let (section, relative) = (place("[[output.section]]"), place("[[output.relative]]"));
        let kept = [
            &SCENE[..bolt],
            &SCENE[stage..section].replace("bolts = [\"pins\"]\n", ""),
            &SCENE[relative..],
        ];
        kept.concat().replace(
            "file = \"mesh.msh\"",
            "generator = \"bay\"\nfile = \"bay.toml\"",
        )
    }
    fn scene(&self) -> PathBuf {
        self.0.join("scene.toml")
    }
    fn sweep(&self) -> Sweep {
        Sweep::of_file(self.scene(), Some(self.0.join("out"))).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Counts what a sweep tells.
#[derive(Default)]
struct Count {
    kept: Vec<String>,
    at_rest: Vec<String>,
    ended: Vec<String>,
}

impl SweepWatch for Count {
    fn kept(&mut self, case: &str) {
        self.kept.push(case.into());
    }
    fn at_rest(&mut self, case: &str, _took: Duration) {
        self.at_rest.push(case.into());
    }
    fn ends(&mut self, outcome: &CaseOutcome) {
        self.ended.push(outcome.name.clone());
    }
}

/// Cases run one after the other; the stages are gone through once for those that share joints and
/// faces; finished cases are not run again, until an input changes.
#[test]
fn finished_cases_are_kept_and_stages_are_shared() {
    let folder = Folder::new("sweep");
    let mut count = Count::default();
    let first = folder.sweep().run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["steep", "slanted", "continuous"]);
    assert_eq!(count.at_rest, ["steep", "continuous"]);
    assert_eq!((first[0].joints.len(), first[2].joints.len()), (1, 0));
    assert_eq!(first[0].relative[0].name, "A-O1");
    assert!(first.iter().all(|case| case.relative[0].value > 1e-4));

    let mut count = Count::default();
    let again = folder.sweep().run(None, &mut count).unwrap();
    assert_eq!((count.kept.len(), count.ended.len()), (3, 0));
    assert_eq!(again, first);

    // One case is lost: that one alone is run again, and comes to the same motion.
    std::fs::remove_file(folder.0.join("out/slanted/finished.json")).unwrap();
    let mut count = Count::default();
    let mended = folder.sweep().run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["slanted"]);
    assert_eq!(mended[1].relative, first[1].relative);
    // From the body that the first sweep left.
    assert!(count.at_rest.is_empty(), "{:?}", count.at_rest);

    // Another case that comes in shares a body only if nothing differs that acts before the motion.
    let softer = "[[case]]\nname = \"softer\"\nmaterial = [{ name = \"rock\", young = 8e9 }]\n\
                  [[case]]\nname = \"stiffer\"\nboundary = { a = 0.5 }\n";
    std::fs::write(folder.scene(), format!("{SCENE}{softer}")).unwrap();
    let mut count = Count::default();
    let sweep = folder
        .sweep()
        .only(&["softer", "stiffer"].map(str::to_owned));
    sweep.unwrap().run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["softer", "stiffer"]);
    assert_eq!(count.at_rest, ["softer"]);
    // The table holds all that is finished.
    let table = std::fs::read_to_string(folder.0.join("out/sweep.csv")).unwrap();
    let named = |line: &str| line.split(',').next().unwrap().to_owned();
    let names: Vec<String> = table.lines().map(named).collect();
    let all = ["steep", "slanted", "continuous", "softer", "stiffer"];
    assert_eq!(names[0], "case");
    assert_eq!(names[1..], all);

    // Cases that were added, a remark and another number of threads make no other job.
    let same = format!("threads = 1\n# A remark.\n{SCENE}{softer}");
    std::fs::write(folder.scene(), same).unwrap();
    let mut count = Count::default();
    folder.sweep().run(None, &mut count).unwrap();
    assert_eq!(
        (count.kept, count.ended.len()),
        (all.map(str::to_owned).to_vec(), 0)
    );
    // A key of a case makes another one of that case alone.
    let stiffer = softer.replace("a = 0.5", "a = 0.6");
    std::fs::write(folder.scene(), format!("{SCENE}{stiffer}")).unwrap();
    let mut count = Count::default();
    folder.sweep().run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["stiffer"]);

    // An edited mesh is another job.
    write_gmsh(folder.0.join("mesh.msh"), &slice(1.1)).unwrap();
    let mut count = Count::default();
    let only = folder.sweep().only(&["steep".into()]).unwrap();
    only.run(None, &mut count).unwrap();
    assert_eq!(count.ended, ["steep"]);
    assert_eq!(count.at_rest, ["steep"]);
}

/// Cases side by side come to the same bits as one after the other, go through stages that they share once,
/// and stand in the table in the order of the scene.
#[test]
fn cases_run_side_by_side() {
    let folder = Folder::new("side-by-side");
    let mut count = Count::default();
    let together = folder.sweep().side_by_side(NonZeroUsize::new(2).unwrap());
    let together = together.run(None, &mut count).unwrap();
    assert_eq!((count.ended.len(), count.at_rest.len()), (3, 2));
    let table = std::fs::read(folder.0.join("out/sweep.csv")).unwrap();
    let alone = Folder::new("one-by-one");
    let apart = alone.sweep().run(None, &mut Silent).unwrap();
    let timeless = |outcomes: Vec<CaseOutcome>| -> Vec<CaseOutcome> {
        let with_time = |case| CaseOutcome {
            wall_time: 0.0,
            ..case
        };
        outcomes.into_iter().map(with_time).collect()
    };
    assert_eq!(timeless(together), timeless(apart));
    let names = |table: &[u8]| -> Vec<String> {
        let lines = String::from_utf8_lossy(table);
        let named = |line: &str| line.split(',').next().unwrap().to_owned();
        lines.lines().map(named).collect()
    };
    let other = std::fs::read(alone.0.join("out/sweep.csv")).unwrap();
    assert_eq!(names(&table), names(&other));
}

/// What the ground alone does at the places of the relative displacements is what a body does that is
/// ground all over.
#[test]
fn the_ground_alone_moves_as_the_waves() {
    let folder = Folder::new("ground");
    let place = |text: &str| SCENE.find(text).unwrap();
    let (joint, support) = (place("[[joint]]"), place("[[support]]"));
    let (stress, wave) = (place("[in_situ_stress]"), place("[[wave]]"));
    let (watched, relative) = (place("[[output.joint]]"), place("[[output.relative]]"));
    let continuous = place("[[case]]\nname = \"continuous\"");
    let ground = [
        &SCENE[..joint],
        &SCENE[support..stress],
        &SCENE[wave..watched],
        &SCENE[relative..continuous],
    ];
    let longer = ground
        .concat()
        .replace("duration = 0.05\n", "duration = 0.15\n");
    std::fs::write(folder.scene(), longer).unwrap();
    let cases = folder.sweep().run(None, &mut Silent).unwrap();
    assert_eq!(cases.len(), 2);
    for case in &cases {
        let (moved, ground) = (&case.relative[0], &case.ground[0]);
        assert_eq!(moved.name, ground.name);
        assert!(
            (moved.value / ground.value - 1.0).abs() < 0.02 && ground.value > 1e-4,
            "{}: {moved:?} {ground:?}",
            case.name
        );
        assert!((moved.time - ground.time).abs() <= 0.0051);
    }
}

/// Cases with keys of their own in the tables of a scene: they are the scene with these keys, come to rest
/// and run by themselves; a table that the scene does not have, and a key or value that it cannot have, is
/// shown where it stands when the sweep begins.
#[test]
fn a_case_may_change_keys_of_tables() {
    let folder = Folder::new("changed");
    let case = r#"
[[case]]
name = "other"
varies = "many things"
material = [{ name = "rock", young = 8e9 }]
part = [{ set = "structure", damping = { kind = "rayleigh", ratio = 0.05, frequencies = [2, 20] } }]
joint = [{ name = "seam", cohesion = 1e3, dynamic_friction = 0.2 }]
bolt = [{ name = "pins", diameter = 0.05 }]
stage = [{ name = "opening", tolerance = 2e-3 }]
boundary = { a = 0.5 }
time = { duration = 0.02, safety = 0.5 }
"#;
    let text = format!("{SCENE}{case}");
    std::fs::write(folder.scene(), &text).unwrap();
    let of = |name: &str| Scene::case_from_file_with(folder.scene(), name, &registry()).unwrap();
    let (own, scene) = (of("other"), of("steep"));
    let young = |scene: &Scene| scene.parts()[0].material.medium().young;
    assert_eq!((young(&own), young(&scene)), (8e9, 9e9));
    assert_eq!((own.run_duration(), scene.run_duration()), (0.02, 0.05));
    // All of it: the case moves as the scene with these keys written out, to the last bit.
    let written_out = SCENE
        .replace("young = 9e9", "young = 8e9")
        .replace("cohesion = 1e6", "cohesion = 1e3")
        .replace("dynamic_friction = 0.7", "dynamic_friction = 0.2")
        .replace("diameter = 0.025", "diameter = 0.05")
        .replace("tolerance = 1e-3", "tolerance = 2e-3")
        .replace("duration = 0.05", "duration = 0.02\nsafety = 0.5")
        .replace(
            "kind = \"viscous-spring\"",
            "kind = \"viscous-spring\"\na = 0.5",
        )
        .replace(
            "set = \"structure\"\nmaterial = \"rock\"",
            "set = \"structure\"\nmaterial = \"rock\"\n\
             damping = { kind = \"rayleigh\", ratio = 0.05, frequencies = [2, 20] }",
        );
    let run = |scene: Scene| scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let changed = run(own);
    std::fs::write(folder.scene(), written_out).unwrap();
    let twin = run(of("steep"));
    assert_eq!(changed.histories, twin.histories);
    assert_eq!(changed.bolts, twin.bolts);
    assert_ne!(changed.histories, run(scene.duration(0.02)).histories);

    let refused = |change: &dyn Fn(&str) -> String| {
        std::fs::write(folder.scene(), change(&text)).unwrap();
        let refused = Sweep::of_file(folder.scene(), None).err().unwrap();
        refused.to_string()
    };
    let lost =
        refused(&|text| text.replace("name = \"seam\", cohesion", "name = \"gap\", cohesion"));
    assert!(lost.contains("no joint 'gap'"), "{lost}");
    let key = refused(&|text| text.replace("young = 8e9", "yong = 8e9"));
    assert!(key.contains("unknown key 'yong'"), "{key}");
    let value = refused(&|text| text.replace("young = 8e9", "young = -8e9"));
    let line = text
        .lines()
        .position(|line| line.contains("young = 8e9"))
        .unwrap()
        + 1;
    assert!(value.contains(&format!("scene.toml:{line}:")), "{value}");
    let nameless = refused(&|text| text.replace("name = \"pins\", diameter", "diameter"));
    assert!(nameless.contains("'name'"), "{nameless}");
}

/// A body at rest comes back from its file to the last bit; a file that is cut short, damaged, or none at
/// all is refused by name.
#[test]
fn a_body_comes_back_from_its_file() {
    let folder = Folder::new("body");
    let scene = Scene::case_from_file_with(folder.scene(), "steep", &registry()).unwrap();
    let body = scene.prepare().unwrap().bring_to_rest(None, None);
    let body = body.unwrap().unwrap();
    let file = folder.0.join("rest.body");
    body.write(&file).unwrap();
    let back = BodyAtRest::read(&file).unwrap();
    assert_eq!(back, body);
    assert!(!body.state().joints.is_empty() && !body.state().history.is_empty());
    let bytes = std::fs::read(&file).unwrap();
    let mut damaged = bytes.clone();
    damaged[bytes.len() / 2] ^= 1;
    for bad in [&bytes[..bytes.len() - 9], &damaged, b"powerhouse"] {
        std::fs::write(&file, bad).unwrap();
        let refused = BodyAtRest::read(&file);
        assert!(
            matches!(refused, Err(Error::NotABody { .. })),
            "{refused:?}"
        );
    }
    let none = BodyAtRest::read(&folder.0.join("none"));
    assert!(matches!(none, Err(Error::Read { .. })));
}

/// A report is one page that needs nothing beside it: it names every case and carries its plots and the
/// scene, forces of sections and bolts, spectra of floors, what damaged the structure, and what the cases
/// say to the paper; that of a single run has its peaks; a folder without results has none.
#[test]
fn a_report_needs_nothing_beside_it() {
    let folder = Folder::new("report");
    let concrete = "[[material]]\nname = \"concrete\"\nlaw = \"plastic-damage\"\n\
                    preset = \"paper-c25\"\n[[part]]\nset = \"structure\"\nmaterial = \"concrete\"";
    let of_rock = "[[part]]\nset = \"structure\"\nmaterial = \"rock\"";
    let stronger = "[[case]]\nname = \"stronger\"\nvaries = \"pulse\"\n\
                    boundary = { a = 0.5 }\n";
    let text = SCENE.replace(of_rock, concrete) + stronger;
    std::fs::write(folder.scene(), text).unwrap();
    let sweep = folder.sweep().lasting(0.03).unwrap();
    sweep.run(None, &mut Silent).unwrap();
    let page = |path: &Path| std::fs::read_to_string(write_report(path).unwrap()).unwrap();
    let sweep = page(&folder.0.join("out"));
    for wanted in [
        "steep",
        "slanted",
        "continuous",
        "A-O1",
        "Before the earthquake",
        "[[case]]",
        "Section forces",
        "<td class=\"text\">waist</td>",
        "Floor response spectra",
        "<td class=\"text\">O1 z</td>",
        "pins",
        "seam-side",
        "steep: structure damage type",
        "steep: joint seam over the run",
        "P at 30 degrees: the joint fails mainly at the arches",
        "open, without SV 0, SV 15, SV 25, SV 30",
        "What single choices do",
        "checksum of all",
    ] {
        assert!(sweep.contains(wanted), "{wanted}");
    }
    let spectra = read_table(&folder.0.join("out/report/floor-spectra-steep.csv")).unwrap();
    assert!(spectra.iter().any(|column| column.name == "O1 z 5 %"));
    let outcomes = read_outcomes(folder.0.join("out")).unwrap();
    assert_eq!(outcomes.len(), 4);
    let steep = &outcomes[0];
    assert_eq!(steep.input.wave(), Some(("p", 0.0)));
    assert_eq!((steep.bolts.len(), steep.bolts_at_rest.len()), (1, 1));
    assert!(steep.bolts[0].value >= steep.bolts_at_rest[0].value);
    let structure = steep.parts.iter().find(|part| part.name == "structure");
    assert!((structure.unwrap().volume - 216.0).abs() < 1e-9);
    assert_eq!(
        (steep.joint_parts.len(), outcomes[2].joint_parts.len()),
        (1, 0)
    );
    assert!(steep.joint_and_lining.is_some() && outcomes[2].joint_and_lining.is_none());
    let varied = sensitivity(&outcomes);
    assert_eq!((&*varied[0].case, &*varied[0].base), ("stronger", "steep"));
    let run = page(&folder.0.join("out/steep"));
    assert!(run.contains("A-O1.ux"));
    for text in [&sweep, &run] {
        assert!(text.contains("src=\"data:image/svg+xml;base64,"));
        assert!(!text.contains("http") && !text.contains("src=\"/") && !text.contains("<script"));
        assert!(text.ends_with("</body></html>\n"));
    }
    let none = write_report(folder.0.join("nothing")).unwrap_err();
    assert!(
        none.to_string().contains("neither a sweep nor a run"),
        "{none}"
    );
}

/// A case from the shared body at rest moves as the case run by itself, to the last bit.
#[test]
fn a_shared_body_moves_as_one_of_its_own() {
    let folder = Folder::new("shared");
    let sweep = folder.sweep().lasting(0.02).unwrap();
    let cases = ["steep", "slanted"].map(str::to_owned);
    sweep.only(&cases).unwrap().run(None, &mut Silent).unwrap();
    let scene = Scene::case_from_file_with(folder.scene(), "slanted", &registry()).unwrap();
    assert_eq!(scene.case(), Some("slanted"));
    let scene = scene.duration(0.02);
    let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let shared = read_table(&folder.0.join("out/slanted/histories.csv")).unwrap();
    for column in &results.histories.columns {
        let found = shared.iter().find(|other| other.name == column.name);
        assert_eq!(found.unwrap().values, column.values, "{}", column.name);
    }
}

/// A body at rest of another scene is refused with the numbers that do not fit.
#[test]
fn a_foreign_body_is_refused() {
    let folder = Folder::new("foreign");
    let case = |name: &str| {
        let scene = Scene::case_from_file_with(folder.scene(), name, &registry()).unwrap();
        scene.prepare().unwrap()
    };
    let body = case("continuous").bring_to_rest(None, None).unwrap();
    let hooks = RunHooks {
        at_rest: body,
        ..RunHooks::default()
    };
    let Err(error) = case("steep").run(hooks) else {
        panic!("a body of another mesh went unseen")
    };
    assert!(matches!(error, Error::ForeignBody { .. }), "{error}");
}

/// A case may have a mesh and supports of its own: here the bay stands in a block, held by nothing but
/// the faces that absorb.
#[test]
fn a_case_may_have_another_mesh_and_other_supports() {
    let folder = Folder::new("block");
    std::fs::write(
        folder.0.join("block.toml"),
        format!("{BAY}[ends]\nrock = 20\ncells = 2\n"),
    )
    .unwrap();
    let case = "[[case]]\nname = \"block\"\nsupport = []\n\
         mesh = { generator = \"bay\", file = \"block.toml\" }\n\
         faces = [\"left\", \"right\", \"front\", \"back\", \"bottom\"]\n";
    std::fs::write(folder.scene(), format!("{}{case}", Folder::bay())).unwrap();
    let of = |name| Scene::case_from_file_with(folder.scene(), name, &registry()).unwrap();
    let (bay, block) = (of("steep"), of("block"));
    let elements = |scene: &Scene| scene.mesh().element_count();
    assert_eq!(elements(&block) * 8, elements(&bay) * 12);
    assert_eq!((bay.supports().len(), block.supports().len()), (2, 0));
    let faces = |scene: &Scene| scene.absorbing_boundary().unwrap().faces.len();
    assert_eq!((faces(&bay), faces(&block)), (3, 5));
}

/// A case on request is left out of a sweep unless it is asked for by name.
#[test]
fn a_case_on_request_waits_until_it_is_asked_for() {
    let folder = Folder::new("request");
    let text = SCENE.replace("name = \"steep\"", "name = \"steep\"\non_request = true");
    std::fs::write(folder.scene(), text).unwrap();
    let sweep = folder.sweep();
    assert!(!sweep.cases().is_empty());
    assert!(!sweep.cases().contains(&"steep".to_owned()));
    let asked = sweep.only(&["steep".into()]).unwrap();
    assert_eq!(asked.cases(), ["steep"]);
    let unknown = folder.sweep().only(&["steeper".into()]).err().unwrap();
    let text = unknown.to_string();
    assert!(
        text.contains("steeper") && text.contains("steep,"),
        "{text}"
    );
}

/// A sweep that is stopped says so, and goes on where it was.
#[test]
fn a_sweep_that_is_stopped_goes_on() {
    let folder = Folder::new("stopped");
    let stop = Arc::new(AtomicBool::new(true));
    let stopped = folder.sweep().run(Some(&stop), &mut Silent);
    assert!(matches!(stopped, Err(StudyError::Interrupted)));
    // Not with another scene, though.
    let sweep = folder.sweep();
    std::fs::write(
        folder.scene(),
        SCENE.replace("lateral = 0.37", "lateral = 0.4"),
    )
    .unwrap();
    let edited = sweep.run(None, &mut Silent);
    assert!(matches!(edited, Err(StudyError::Changed { .. })));
    std::fs::write(folder.scene(), SCENE).unwrap();
    let only = folder.sweep().only(&["steep".into()]).unwrap();
    let done = only.lasting(0.01).unwrap().run(None, &mut Silent).unwrap();
    let past = done[0].end - 0.01;
    assert!((0.0..=2.0 * done[0].step).contains(&past), "{past}");
}

/// Cases are named once and exist, generators too; a scene without cases is no sweep.
#[test]
fn what_is_no_case_is_refused() {
    let folder = Folder::new("refused");
    let write = |change: &dyn Fn(&str) -> String| {
        std::fs::write(folder.scene(), change(&Folder::bay())).unwrap();
        Sweep::of_file(folder.scene(), None)
            .err()
            .map(|error| error.to_string())
    };
    let twice = write(&|text| text.replace("name = \"slanted\"", "name = \"steep\"")).unwrap();
    assert!(
        twice.contains("the case 'steep' is defined twice"),
        "{twice}"
    );
    let unknown = write(&|text| text.replace("generator = \"bay\"", "generator = \"cave\""));
    let unknown = unknown.unwrap();
    assert!(
        unknown.contains("there is no mesh generator 'cave'"),
        "{unknown}"
    );
    let bad = write(&|text| text.replace("bay.toml", "scene.toml")).unwrap();
    assert!(bad.contains("unknown field"), "{bad}");
    let none = write(&|text| text[..text.find("[[case]]").unwrap()].into()).unwrap();
    assert!(none.contains("has no [[case]]"), "{none}");
    assert_eq!(write(&|text| text.into()), None);
    let other = folder.sweep().only(&["flat".into()]).err().unwrap();
    assert!(other.to_string().contains("no case 'flat'"), "{other}");
    let lost = Scene::case_from_file_with(Path::new("lost.toml"), "steep", &registry());
    assert!(matches!(lost, Err(Error::Read { .. })));
}
