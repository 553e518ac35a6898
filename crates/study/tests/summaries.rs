//! Summaries of runs, as reports read them.

use std::path::Path;

use powerhouse::{FileScene, ResultFolder};
use powerhouse_report::{report_gaps, write_report};
use powerhouse_study::{SceneRun, StudyError};
use serde_json::Value;

use crate::block::Folder;
use crate::trade::SCENE;

/// The text of the report of a folder whose summary is replaced.
fn page_of(out: &Path, summary: &Value) -> Result<String, StudyError> {
    std::fs::write(out.join("summary.json"), summary.to_string()).unwrap();
    write_report(out).map(|page| std::fs::read_to_string(page).unwrap())
}

/// A report has the figures of the summary; one that is missing, or has another name, is an error with the name of key and
/// file, never a zero. A figure that was no finite number is none on the page, either, and a run without results has none.
#[test]
fn a_missing_figure_is_an_error_by_its_name() {
    let folder = Folder::new("missing-figure", SCENE, 3);
    let out = folder.out();
    let scene = FileScene::from_file(folder.scene()).unwrap();
    let ran = SceneRun::new(scene, ResultFolder::new(&out))
        .run(&mut ())
        .unwrap();
    ran.write().unwrap();
    ran.close().unwrap();
    drop(ran);
    let sound = std::fs::read(out.join("summary.json")).unwrap();
    let sound: Value = serde_json::from_slice(&sound).unwrap();
    let steps = format!("<td>{}</td>", sound["steps"]);
    assert!(page_of(&out, &sound).unwrap().contains(&steps));
    for (within, key) in [
        ("", "steps"),
        ("", "step"),
        ("", "end_time"),
        ("", "wall_time"),
        ("", "nodes"),
        ("", "elements"),
        ("", "peaks"),
        ("", "energies"),
        ("", "path_dependent"),
        ("/peaks/0", "name"),
        ("/peaks/0", "unit"),
        ("/peaks/0", "value"),
        ("/peaks/0", "time"),
        ("/energies/0", "value"),
    ] {
        let mut other = sound.clone();
        let keys = other.pointer_mut(within).and_then(Value::as_object_mut);
        let keys = keys.unwrap();
        let value = keys.remove(key).unwrap();
        keys.insert(format!("{key}_of_another_name"), value);
        let error = page_of(&out, &other).unwrap_err().to_string();
        let named = error.contains(&format!("missing field `{key}`"));
        assert!(
            named && error.contains("summary.json"),
            "{within}/{key}: {error}"
        );
    }
    let mut diverged = sound.clone();
    let peak = diverged.pointer_mut("/peaks/0").unwrap();
    (peak["value"], peak["below_rounding"]) = (Value::Null, false.into());
    let page = page_of(&out, &diverged).unwrap();
    assert!(page.contains("NaN</td>"));
    let begun = serde_json::json!({
        "title": "block", "software": "powerhouse", "ended": "incomplete", "failure": "it goes on",
    });
    let page = page_of(&out, &begun).unwrap();
    assert!(page.contains("the run is incomplete: it goes on"));
    assert!(!page.contains("steps") && !page.contains("wall time"));
    assert_eq!(
        report_gaps(&out).unwrap(),
        ["the run is incomplete: it goes on"]
    );
}
