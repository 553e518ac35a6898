//! The lined cavern of `data/scenes/cavern_small.toml`, its first seconds.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use powerhouse::{FileScene, Results, RunHooks};

/// Duration of the run (s); the strong motion begins after 1.5 s.
const DURATION: f64 = 3.0;
/// Interval of the stored samples.
const EVERY: usize = 20;
/// Permitted change of a sample over the largest of its unit. Accelerations are the least accurate: rounding of
/// displacements of 0.2 m leaves a noise of 1e-9, as those normal to the plane of motion show, which are zero
/// by symmetry; an undamped body keeps it. Any change of method changes samples by far more.
const TOLERANCE: f64 = 1e-8;

fn shelf() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("regression")
}

fn run() -> Results {
    let scene = shelf().join("../../data/scenes/cavern_small.toml");
    let scene = FileScene::from_file(scene)
        .unwrap()
        .into_scene()
        .with_duration(DURATION);
    scene.prepare().unwrap().run(RunHooks::default()).unwrap()
}

/// Time, histories and section forces as text, one column each, with its unit.
fn table(results: &Results) -> String {
    let (histories, sections) = (results.histories(), results.sections());
    let columns = || histories.columns.iter().chain(&sections.columns);
    let mut text = String::from("time (s)");
    for column in columns() {
        write!(text, ",{} ({})", column.name, column.unit).unwrap();
    }
    for row in (0..histories.times.len()).step_by(EVERY) {
        write!(text, "\n{}", histories.times[row]).unwrap();
        for column in columns() {
            write!(text, ",{}", column.values[row]).unwrap();
        }
    }
    text + "\n"
}

/// Names and columns of a table.
fn parse(text: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns = vec![Vec::new(); names.len()];
    for line in lines {
        for (column, number) in columns.iter_mut().zip(line.split(',')) {
            column.push(number.parse().unwrap());
        }
    }
    (names, columns)
}

/// Histories and section forces of the cavern are the stored ones.
///
/// After an intended change of the method, `POWERHOUSE_STORE=1` stores the new ones, and `LOG.md` states the
/// reason.
#[test]
fn the_cavern_moves_as_before() {
    let file = shelf().join("cavern_small.csv");
    let found = table(&run());
    if std::env::var_os("POWERHOUSE_STORE").is_some() {
        std::fs::write(&file, &found).unwrap();
    }
    let stored = std::fs::read_to_string(&file).expect("stored with POWERHOUSE_STORE=1");
    let ((names, stored), (found_names, found)) = (parse(&stored), parse(&found));
    assert_eq!(names, found_names);
    let unit = |name: &str| name.split_once(" (").unwrap().1.to_owned();
    let mut peaks = BTreeMap::<String, f64>::new();
    for (name, stored) in names.iter().zip(&stored) {
        let peak = peaks.entry(unit(name)).or_default();
        *peak = stored.iter().fold(*peak, |peak, x| peak.max(x.abs()));
    }
    for ((name, stored), found) in names.iter().zip(&stored).zip(&found) {
        assert_eq!(stored.len(), found.len(), "{name}");
        let peak = peaks[&unit(name)];
        assert!(peak > 0.0, "nothing moves");
        for (row, (stored, found)) in stored.iter().zip(found).enumerate() {
            assert!(
                (stored - found).abs() <= TOLERANCE * peak,
                "{name}, row {row}: {stored:e} was stored, {found:e} is found"
            );
        }
    }
}
