//! Temporary loads, which a later stage removes.

use std::sync::{Arc, Mutex};

use powerhouse::engine::{NodalForce, StaticOptions};
use powerhouse::model::Vec3;
use powerhouse::{CompletedStage, Error, Scene, SceneStage, StageSink};

use super::stages::{MATERIALS, ROLLERS, folder, mesh, read};
use super::support::run;

/// A pressure and a jack that act in one stage.
const PRESSED: &str = r#"
[[stage]]
name = "pressed"
tolerance = 1e-12
load = [
    { kind = "pressure", set = "top", pressure = 3e5, removed_in = "off" },
    { kind = "nodal", set = "top", force = [2e5, 0, 1e5], removed_in = "off" },
]
"#;

/// Stage that removes them.
const OFF: &str = r#"
[[stage]]
name = "off"
tolerance = 1e-12
increments = 3
"#;

/// Load of the scene, from Rust or a file, that the last stage removes.
const PUSH: &str = r#"
[[load]]
kind = "nodal"
set = "top"
force = [1e5, 0, 0]
function = { kind = "sine", frequency = 5 }
"#;

/// Sink that records the displacement of all nodes after each stage (m).
#[derive(Clone, Default)]
struct Displacements(Arc<Mutex<Vec<Vec<Vec3>>>>);

impl StageSink for Displacements {
    fn completed(&mut self, stage: &CompletedStage) -> Result<(), Error> {
        let displacement = stage.state.displacement.clone();
        self.0.lock().unwrap().push(displacement);
        Ok(())
    }
}

fn displacements(scene: Scene) -> Vec<Vec<Vec3>> {
    let seen = Displacements::default();
    let sink = Box::new(seen.clone());
    let simulation = scene.prepare().unwrap();
    simulation.equilibrate(None, Some(sink)).unwrap();
    let seen = seen.0.lock().unwrap();
    seen.clone()
}

/// The largest distance (m) of two displacements of one node.
fn apart(one: &[Vec3], other: &[Vec3]) -> f64 {
    let pairs = one.iter().zip(other);
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Rollers, and the materials of the run.
fn rollers() -> String {
    let own = ROLLERS.replace(
        "part = [{ set = \"lining\", material = \"rock\" }]",
        "tolerance = 1e-12",
    );
    assert_ne!(own, ROLLERS);
    own
}

/// Removal of temporary loads restores an elastic body within 1e-8, in proportion to the release factor, from a file and
/// from Rust.
#[test]
fn an_elastic_body_returns_when_loads_are_taken_off() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let text = [MATERIALS, &rollers(), PRESSED, OFF].concat();
    let found = displacements(read(&folder, &text).unwrap());
    let [ground, pressed, off] = &found[..] else {
        panic!("{} stages", found.len())
    };
    let moved = apart(ground, pressed);
    assert!(moved > 1e-4, "{moved:e}");
    assert!(
        apart(ground, off) < 1e-8 * moved,
        "{:e}",
        apart(ground, off)
    );
    // A release factor of one half leaves half of the loads.
    let half = text.replace("increments = 3", "release = 0.5");
    let found = displacements(read(&folder, &half).unwrap());
    let middle: Vec<Vec3> = ground
        .iter()
        .zip(pressed)
        .map(|(a, b)| 0.5 * (a + b))
        .collect();
    assert!(apart(&found[2], &middle) < 1e-8 * moved);
    // In Rust.
    let top = mesh.nodes_of_facets(mesh.facet_set("top").unwrap());
    let jack = NodalForce::new(top, Vec3::new(2e5, 0.0, 1e5), Box::new(|_: f64| 1.0));
    let tight = StaticOptions::default().with_tolerance(1e-12);
    let jacked = SceneStage::new("jacked").with_options(tight);
    let scene = read(&folder, &[MATERIALS, &rollers()].concat()).unwrap();
    let scene = scene.stage(jacked.temporary_load(jack, "after"));
    let found = displacements(scene.stage(SceneStage::new("after").with_options(tight)));
    let moved = apart(ground, &found[1]);
    assert!(moved > 1e-4, "{moved:e}");
    assert!(apart(ground, &found[2]) < 1e-8 * moved);
}

/// A load that the last stage removes does not act in the run, neither one of a stage nor one of the scene: without input
/// the body does not move.
#[test]
fn what_the_last_stage_takes_off_does_not_act_in_the_run() {
    let folder = folder(&mesh());
    let most = |push: &str| {
        let text = [MATERIALS, push, &rollers(), PRESSED, OFF].concat();
        let text = text.replace("duration = 0.4", "duration = 3");
        let scene = read(&folder, &text).unwrap();
        let found = run(scene);
        assert!(found.run.steps > 500, "{}", found.run.steps);
        let difference = found.hand_over.unwrap().difference;
        assert!(difference < 1e-9, "{difference:e}");
        let columns = ["ux", "uy", "uz"].map(|component| {
            let column = found.histories().column(&format!("corner.{component}"));
            column.unwrap().values.clone()
        });
        let values = columns.iter().flatten();
        values.fold(0.0_f64, |most, value| most.max(value.abs()))
    };
    let removed = format!("{PUSH}removed_in = \"off\"\n");
    assert!(most(&removed) < 1e-10, "{:e}", most(&removed));
    assert!(most(PUSH) > 1e-5, "{:e}", most(PUSH));
}

/// Overviews of stages contain the number of removed loads; a scene whose loads are all removed has no load in the run.
#[test]
fn stages_tell_what_they_take_off() {
    let folder = folder(&mesh());
    let removed = format!("{PUSH}removed_in = \"off\"\n");
    let text = [MATERIALS, &removed, &rollers(), PRESSED, OFF].concat();
    let scene = read(&folder, &text).unwrap();
    let stages = scene.stage_overviews().unwrap();
    let counts: Vec<_> = (stages.iter())
        .map(|stage| (stage.loads, stage.removed_loads))
        .collect();
    assert_eq!(counts, [(0, 0), (2, 0), (0, 3)]);
    let text = text.replace("[[load]]\nkind = \"gravity\"\n", "");
    assert!(!read(&folder, &text).unwrap().is_driven());
    let text = text.replace("removed_in = \"off\"\n\n", "");
    assert!(read(&folder, &text).unwrap().is_driven());
}

/// A weight or a load that a stage brings acts in the run, unless a later stage removes it.
#[test]
fn what_a_stage_brings_drives_the_run() {
    let jack = || NodalForce::new(vec![0], Vec3::x(), Box::new(|_: f64| 1.0));
    let driven = |stage: SceneStage| {
        let scene = Scene::new("staged", mesh()).stage(stage);
        scene.stage(SceneStage::new("off")).is_driven()
    };
    let stage = || SceneStage::new("first");
    assert!(!driven(stage()));
    assert!(driven(stage().gravity(Vec3::z() * -9.81, |_: f64| 1.0)));
    assert!(driven(stage().load(jack())));
    assert!(!driven(stage().temporary_load(jack(), "off")));
}

/// A load composed in Rust that an unknown stage, its own or an earlier one should remove is an error with the name.
#[test]
fn loads_need_a_later_stage_that_takes_them_off() {
    let folder = folder(&mesh());
    let jack = || NodalForce::new(vec![0], Vec3::x(), Box::new(|_: f64| 1.0));
    let scene = || read(&folder, &[MATERIALS, &rollers(), OFF].concat()).unwrap();
    let refused = |scene: Scene| match scene.prepare() {
        Err(error) => error.to_string(),
        Ok(_) => panic!("accepted"),
    };
    let found = refused(scene().stage(SceneStage::new("jack").temporary_load(jack(), "on")));
    assert!(found.contains("no stage 'on'"), "{found}");
    for name in ["jack", "off", "ground"] {
        let stage = SceneStage::new("jack").temporary_load(jack(), name);
        let found = refused(scene().stage(stage));
        assert!(
            found.contains(&format!("'{name}' cannot remove")),
            "{found}"
        );
        assert!(found.contains("'jack' on"), "{found}");
    }
    let found = refused(scene().temporary_load(jack(), "ground"));
    assert!(found.contains("'ground' cannot remove"), "{found}");
    // A scene without stages has none that could.
    let (_, from) = MATERIALS.split_once("[in_situ_stress]").unwrap();
    let (stress, _) = from.split_once("[boundary]").unwrap();
    let bare = MATERIALS.replace(&["[in_situ_stress]", stress].concat(), "");
    let bare = read(&folder, &bare).unwrap();
    let found = refused(bare.temporary_load(jack(), "on"));
    assert!(found.contains("no stage 'on'"), "{found}");
}
