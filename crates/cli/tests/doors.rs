//! The doors through which a scene is run into a folder: the command, a sweep, and Rust.

use std::collections::BTreeMap;
use std::path::Path;

use powerhouse::{FileScene, Message, ResultFolder, RunNotes};
use powerhouse_study::{RunWatch, SceneRun, StudyError};

use crate::block::{Block, text};

const CASE: &str = "straight";
const CASES: &str = r#"
[output.envelope]
quantities = ["displacement"]
[[case]]
name = "straight"
wave = [{ kind = "sv", incidence = 0, pulse = { kind = "smooth", displacement = 0.02, duration = 0.25 } }]
"#;
/// A stage in which the block reaches static equilibrium under its weight.
const STAGE: &str = r#"
[[load]]
kind = "gravity"
[[stage]]
name = "rest"
support = [
    { kind = "roller", set = "left" },
    { kind = "roller", set = "right" },
    { kind = "roller", set = "front" },
    { kind = "roller", set = "back" },
    { kind = "roller", set = "bottom" },
]
"#;

/// A scene, and parts of the warnings that every door must give of it.
struct Row {
    name: &'static str,
    changes: &'static [(&'static str, &'static str)],
    stage: &'static str,
    warns: &'static [&'static str],
}

const ROWS: [Row; 3] = [
    Row {
        name: "single",
        changes: &[
            (
                "title = \"block\"",
                "title = \"block\"\nprecision = \"f32\"",
            ),
            ("every = 0.1", "every = 7"),
        ],
        stage: "",
        warns: &["number format \"f32\"", "snapshots"],
    },
    Row {
        name: "mixed-staged",
        changes: &[(
            "title = \"block\"",
            "title = \"block\"\nprecision = \"mixed\"",
        )],
        stage: STAGE,
        warns: &["number format \"mixed\""],
    },
    Row {
        name: "double",
        changes: &[("every = 0.1", "every = 1e-5")],
        stage: "",
        warns: &["snapshots"],
    },
];

/// The files below a folder by their paths in it, text without the lines of wall times and of the title.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut left = vec![folder.to_path_buf()];
    while let Some(next) = left.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                left.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).unwrap();
            let name = name.to_string_lossy().into_owned();
            let bytes = std::fs::read(&path).unwrap();
            let bytes = match String::from_utf8(bytes) {
                Err(binary) => binary.into_bytes(),
                Ok(text) => {
                    let same = |line: &&str| {
                        !["\"wall_time\"", "\"title\""]
                            .iter()
                            .any(|key| line.trim_start().starts_with(key))
                    };
                    let lines: Vec<&str> = text.lines().filter(same).collect();
                    lines.join("\n").into_bytes()
                }
            };
            found.insert(name, bytes);
        }
    }
    found
}

/// Keeps the warnings with which a run begins.
#[derive(Default)]
struct Heard(Vec<Message>);

impl RunWatch for Heard {
    fn begins(&mut self, notes: &RunNotes) -> Result<(), StudyError> {
        let remarks = notes.remarks.iter().filter(|remark| remark.is_warning());
        self.0.extend(remarks.map(powerhouse::Remark::message));
        self.0.extend(notes.warnings.iter().cloned());
        Ok(())
    }
}

/// A scene has the same result files, byte for byte but for wall times and the title, and the same warnings, whether the
/// command, a sweep or Rust runs it.
#[test]
fn all_doors_have_the_same_files_and_warnings() {
    for row in ROWS {
        let block = Block::of_cells(&format!("doors-{}", row.name), 4, |mut scene| {
            for (from, to) in row.changes {
                assert!(scene.contains(from), "{from}");
                scene = scene.replacen(from, to, 1);
            }
            scene + row.stage + CASES
        });
        let folder = |door: &str| block.folder.join(door);
        let to = |door: &str| folder(door).display().to_string();
        let scene = block.scene();
        let run = ["run", &scene, "--case", CASE, "--out", &to("command")];
        let sweep = ["sweep", &scene, "--case", CASE, "--out", &to("sweep")];
        let [run, sweep] = [run, sweep].map(|arguments| {
            let ended = block.powerhouse(&arguments);
            assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
            text(&ended.stdout)
        });
        let registry = powerhouse_wang_2019::registry();
        let own = FileScene::case_from_file_with(&scene, CASE, &registry).unwrap();
        let mut heard = Heard::default();
        let ran = SceneRun::new(own, ResultFolder::new(folder("rust")));
        let ran = ran.run(&mut heard).unwrap();
        ran.write().unwrap();
        ran.close().unwrap();
        drop(ran);

        let expected = files(&folder("command"));
        assert!(expected.len() > 8, "{:?}", expected.keys());
        let of_rust = files(&folder("rust"));
        let mut of_sweep = files(&folder("sweep").join(CASE));
        assert!(of_rust.keys().eq(expected.keys()));
        for (name, content) in &expected {
            assert!(of_rust[name] == *content, "{}: {name}", row.name);
            let swept = of_sweep.remove(name);
            // Pictures have the title in them.
            assert!(
                swept.as_ref() == Some(content) || (swept.is_some() && name.ends_with(".png")),
                "{}: {name}",
                row.name
            );
        }
        let more: Vec<String> = of_sweep.into_keys().collect();
        assert_eq!(more, ["finished.json", "outcome.json"], "{}", row.name);

        let summary = String::from_utf8_lossy(&expected["summary.json"]).into_owned();
        for passage in row.warns {
            let heard = heard.0.iter().find(|found| found.text.contains(passage));
            let heard = heard.unwrap_or_else(|| panic!("{}: {passage}: {:?}", row.name, heard));
            let quoted = heard.text.replace('"', "\\\"");
            assert!(summary.contains(&quoted), "{}: {summary}", row.name);
            for printed in [&run, &sweep] {
                let warning = format!("warning: {}", heard.text);
                assert!(printed.contains(&warning), "{}: {printed}", row.name);
            }
        }
    }
}
