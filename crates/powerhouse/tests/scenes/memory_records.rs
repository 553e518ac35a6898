//! Records in memory, in place of files.

use powerhouse::wavefield::TimeHistory;
use powerhouse::{Error, FileScene, Registry, Scene};

use super::support::*;

/// A wave by a record that a table names by the file `motion`.
const RECORD: &str = r#"
[[record]]
name = "motion"
file = "motion"
convention = "incident"
baseline = { kind = "velocity-polynomial", order = 3 }
KEYS
[[wave]]
kind = "sv"
incidence = 20
azimuth = 30
record = "motion"
"#;

fn samples() -> Vec<f64> {
    let sample =
        |i: u32| (f64::from(i) * 0.1).sin() * (f64::from(i) / 60.0 * std::f64::consts::PI).sin();
    (0..=60).map(sample).collect()
}

fn read(folder: &Variants, keys: &str, registry: &Registry) -> Result<Scene, Error> {
    let text = CUBE.replacen(WAVE, &RECORD.replace("KEYS", keys), 1);
    FileScene::from_toml(text, folder.0.join("cube.toml"), registry).map(FileScene::into_scene)
}

/// A record in memory is that of a file with the same samples, to the bit; one that is registered under another path is not
/// read in its place.
#[test]
fn a_record_in_memory_takes_the_place_of_a_file() {
    let variants = Variants::new("memory-records");
    let lines: Vec<String> = samples().iter().map(f64::to_string).collect();
    std::fs::write(variants.0.join("motion"), lines.join("\n")).unwrap();
    let file = "time_step = 0.01\nunits = \"m/s2\"";
    let of_file = read(&variants, file, &Registry::default()).unwrap();
    std::fs::remove_file(variants.0.join("motion")).unwrap();

    let mut registry = Registry::default();
    registry.add_record("motion", TimeHistory::new(0.01, samples()).unwrap());
    let in_memory = read(&variants, "", &registry).unwrap();
    assert_eq!(in_memory.records(), of_file.records());
    let (in_memory, of_file) = (run(in_memory), run(of_file));
    assert_eq!(in_memory.histories(), of_file.histories());

    let mut elsewhere = Registry::default();
    elsewhere.add_record("other", TimeHistory::new(0.01, samples()).unwrap());
    let Err(Error::Scene(fault)) = read(&variants, file, &elsewhere) else {
        panic!("a record without a file was accepted");
    };
    assert_eq!(fault.position().0, 18, "{fault}");
}

/// Keys about the form of a file are refused at a record in memory.
#[test]
fn keys_about_files_are_refused() {
    let variants = Variants::new("memory-record-keys");
    let mut registry = Registry::default();
    registry.add_record("motion", TimeHistory::new(0.01, samples()).unwrap());
    assert!(read(&variants, "units = \"m/s2\"", &registry).is_ok());
    for (keys, key) in [
        ("units = \"g\"", "units"),
        ("time_step = 0.01", "time_step"),
    ] {
        let Err(Error::Scene(fault)) = read(&variants, keys, &registry) else {
            panic!("{keys} was accepted");
        };
        assert!(
            fault
                .to_string()
                .contains(&format!("`{key}` is about a file")),
            "{fault}"
        );
    }
}
