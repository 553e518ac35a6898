//! Names of results and of what has result files.

use powerhouse::contact::{Frictionless, JointSurface};
use powerhouse::engine::BoltParameters;
use powerhouse::engine::observe::{JointQuantities, Motion};
use powerhouse::model::Vec3;
use powerhouse::{
    BoltLayout, Error, JointRequest, JointZone, NameError, OutputPlan, RenderFault as _, RunNotes,
    SceneBolts, SceneJoint, SceneStage,
};

use super::nonsense::fault;
use super::support::*;

/// Two results never have the same file: the second name is an error with its position before the run; a comma and
/// quotes in a name are permitted.
#[test]
fn names_of_results_are_checked_before_the_run() {
    let variants = Variants::new("names");
    let two = |first: &str, second: &str| {
        let more = format!(
            "name = \"{first}\"\nat = [150, 150, -10]\n[[output.history]]\nname = \"{second}\""
        );
        variants.read("name = \"surface\"", &more)
    };
    for (first, second) in [("a b", "a-b"), ("Crown", "crown"), ("a, b", "a\\\" b")] {
        let Err(Error::Scene(fault)) = two(first, second) else {
            panic!("{first} and {second} were accepted")
        };
        assert!(
            fault.to_string().contains("would both have the file"),
            "{fault}"
        );
        let (line, _) = fault.position();
        assert!(
            fault
                .render(false)
                .contains(&format!("{line} | name = \"{second}\"")),
            "{fault}"
        );
    }
    assert!(two("crown, left", "\\\"crown\\\"").is_ok());
    let composed = |name: &str| {
        let mut scene = cube_scene();
        let mut plan = scene.output().clone();
        plan = plan.history(name, Vec3::new(150.0, 150.0, -50.0), Default::default());
        scene = scene.with_output(plan);
        scene.prepare().map(|_| ()).unwrap_err()
    };
    assert!(matches!(
        composed("SURFACE"),
        Error::Name(NameError::Shared { .. })
    ));
    assert!(matches!(
        composed("a\nb"),
        Error::Name(NameError::Control { .. })
    ));
    let case = "[[case]]\nname = \"../up\"\n[time]";
    let told = fault(&variants, "[time]", case).to_string();
    assert!(told.contains("cannot be the name of a folder"), "{told}");
}

/// Histories whose names have commas and quotes are written and read back by their names.
#[test]
fn names_with_commas_reach_their_files() {
    let variants = Variants::new("commas");
    let scene = variants
        .read("name = \"surface\"", "name = \"crown, \\\"left\\\"\"")
        .unwrap();
    let mesh = scene.mesh().clone();
    let results = run(scene);
    let folder = powerhouse::ResultFolder::new(variants.0.join("out"));
    folder
        .write(("cube", &mesh), &results, &RunNotes::default(), None)
        .unwrap();
    let table = powerhouse::io::read_table(&folder.path().join("histories.csv")).unwrap();
    assert_eq!(table[1].name, "crown, \"left\".ux");
    assert_eq!(table[1].values, results.histories().columns[0].values);
}

/// What has a name in a scene.
#[derive(Clone, Copy)]
enum Named {
    History,
    Joint,
    JointZone,
    Bolts,
    Stage,
}

/// Error of the names of a scene, none if they are accepted.
fn error_of(names: &[(Named, &str)]) -> Option<NameError> {
    let mut scene = cube_scene();
    let mut plan = OutputPlan::default();
    for &(what, name) in names {
        match what {
            Named::History => plan = plan.history(name, Vec3::zeros(), Motion::ALL),
            Named::Joint => {
                let surface = JointSurface {
                    pairs: Vec::new(),
                    facets: Vec::new(),
                    worst_gap: 0.0,
                    worst_nodes: [0; 2],
                };
                scene = scene.joint(SceneJoint::new(name, surface, Frictionless));
            }
            Named::JointZone => plan.joints.push(JointRequest::new(
                name,
                "joint",
                JointZone::All,
                JointQuantities::ALL,
            )),
            Named::Bolts => {
                scene = scene.with_bolts(SceneBolts {
                    name: name.into(),
                    layout: BoltLayout::Lines(Vec::new()),
                    parameters: BoltParameters::steel(0.025).unwrap(),
                });
            }
            Named::Stage => scene = scene.stage(SceneStage::new(name)),
        }
    }
    match scene.with_output(plan).prepare() {
        Err(Error::Name(error)) => Some(error),
        _ => None,
    }
}

/// Two names never have the same file, whatever they name; one name of two joints, or of a joint and a zone, is an
/// error too. Files of stages have numbers.
#[test]
fn two_names_never_share_a_file() {
    use Named::{Bolts, History, Joint, JointZone, Stage};
    for (first, second) in [
        ((Joint, "seam"), (History, "joint-seam")),
        ((JointZone, "seam."), (Joint, "seam-")),
        ((Bolts, "roof"), (History, "bolts roof")),
        ((Joint, "Seam"), (Joint, "seam")),
    ] {
        let error = error_of(&[first, second]);
        assert!(matches!(error, Some(NameError::Shared { .. })), "{error:?}");
        assert_eq!(error_of(&[first, (second.0, "another")]), None);
    }
    for second in [Joint, JointZone] {
        let error = error_of(&[(Joint, "x"), (second, "x")]);
        assert_eq!(error, Some(NameError::Twice { name: "x".into() }));
    }
    // The plot of the energies.
    assert!(error_of(&[(History, "Energies")]).is_some());
    assert_eq!(error_of(&[(Stage, "a b"), (Stage, "a-b")]), None);
    assert_eq!(error_of(&[(History, "crown, left \"x\"")]), None);
}

/// A name is one line that shows, and not too long for a file; results may have the names of paths, cases not.
#[test]
fn a_name_is_one_line_that_shows() {
    for name in ["", "  ", "a\nb", "a\0b", &"x".repeat(201)] {
        assert!(error_of(&[(Named::History, name)]).is_some(), "{name:?}");
    }
    assert_eq!(error_of(&[(Named::History, &"x".repeat(200))]), None);
    let variants = Variants::new("paths");
    for name in ["..", "../up", "a\\b"] {
        assert_eq!(error_of(&[(Named::History, name)]), None, "{name:?}");
        let case = format!("[[case]]\nname = '{name}'\n[time]");
        let fault = fault(&variants, "[time]", &case).to_string();
        assert!(
            fault.contains("cannot be the name of a folder"),
            "{name:?}: {fault}"
        );
    }
}
