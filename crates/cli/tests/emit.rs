//! Sources of the programs of a scene's elements.

use std::path::Path;
use std::process::Command;

use powerhouse_test_support::TestFolder;

/// Every element set has a source in CUDA C, elements in single precision (those of the lining are too stiff for it) one in WGSL
/// too, with the names of inputs and outputs; the exit status is 0.
#[test]
fn a_scene_has_sources_of_its_elements() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/tunnel.toml");
    for (precision, languages) in [("f64", &["cu"][..]), ("mixed", &["cu", "wgsl"])] {
        let folder = TestFolder::new("emit");
        let out = folder.join("sources");
        let emitted = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
            .arg("emit")
            .arg(&scene)
            .args(["--set", &format!("precision={precision}"), "--out"])
            .arg(&out)
            .output()
            .unwrap();
        let (said, warned) = (&emitted.stdout, &emitted.stderr);
        let (said, warned) = (
            String::from_utf8_lossy(said),
            String::from_utf8_lossy(warned),
        );
        assert_eq!(emitted.status.code(), Some(0), "{said}{warned}");
        let files = std::fs::read_dir(&out).unwrap();
        let names: Vec<_> = files.map(|file| file.unwrap().file_name()).collect();
        for (set, languages) in [("rock", languages), ("lining", &["cu"])] {
            for language in languages {
                let file = format!("{set}.{language}");
                assert!(names.contains(&file.clone().into()), "{file}: {names:?}");
                assert!(said.contains(&file), "{said}");
                let text = std::fs::read_to_string(out.join(&file)).unwrap();
                for name in ["displacement.7.z", "geometry.0", "force.7.z"] {
                    assert!(text.contains(name), "{file}: {name}");
                }
            }
        }
        let has_wgsl = names
            .iter()
            .any(|name| name.to_string_lossy().ends_with(".wgsl"));
        assert_eq!(has_wgsl, languages.len() > 1, "{names:?}");
    }
}
