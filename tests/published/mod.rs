//! What others measured and published, computed here: the figures of `docs/validated.md`.

mod beam;
mod bolts;
mod concrete;
mod dam;
mod page;
mod ring;
mod tunnels;
mod waves;

use std::path::PathBuf;

use powerhouse::{FileScene, KeyChange, Registry, Results, RunHooks};

/// A file of `data/published/`.
fn published(file: &str) -> PathBuf {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/published");
    PathBuf::from(folder).join(file)
}

/// The text of a file of `data/published/` with changed keys, as `--set` changes them.
fn changed(file: &str, changes: &[String]) -> String {
    let text = std::fs::read_to_string(published(file)).unwrap();
    let changes: Vec<KeyChange> = changes.iter().map(|text| text.parse().unwrap()).collect();
    KeyChange::apply(&text, None, &changes).unwrap()
}

/// Results of a scene of `data/published/` with changed keys.
fn run(file: &str, changes: &[String]) -> Results {
    let scene = FileScene::from_toml(
        changed(file, changes),
        published(file),
        &Registry::default(),
    );
    let simulation = scene.unwrap().into_scene().prepare().unwrap();
    simulation.run(RunHooks::default()).unwrap()
}

/// The value of a curve at `x`, on straight lines between its points of rising abscissas.
fn at(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let after = xs
        .partition_point(|&other| other <= x)
        .clamp(1, xs.len() - 1);
    let (x0, x1) = (xs[after - 1], xs[after]);
    ys[after - 1] + (ys[after] - ys[after - 1]) * (x - x0) / (x1 - x0)
}

/// Index of the greatest value.
fn greatest(values: &[f64]) -> usize {
    (0..values.len())
        .max_by(|&a, &b| values[a].total_cmp(&values[b]))
        .expect("values")
}
