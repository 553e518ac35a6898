//! Kinds of output that a program registers.

use std::sync::Arc;

use powerhouse::engine::observe::{EnergyHistory, HistorySampler};
use powerhouse::io::TableColumn;
use powerhouse::model::{Cadence, ModelError, Reach, Selection, StepView};
use powerhouse::schemars::JsonSchema;
use powerhouse::{
    Error, FileScene, OutputItem, OutputPrice, OutputScale, OutputSite, Problem, Recorder,
    Registry, ResultFolder, RunHooks, RunNotes, Scene, TableForm, TablePeaks, TablePlots,
};
use serde::Deserialize;

use super::support::*;

/// Keys of the output.
#[derive(Deserialize, JsonSchema)]
#[schemars(crate = "powerhouse::schemars")]
#[serde(deny_unknown_fields)]
struct FastestKeys {
    /// Set of the nodes.
    set: String,
    /// Factor on the speed.
    factor: Option<f64>,
}

/// Greatest speed among some nodes, times a factor.
struct Fastest {
    nodes: Vec<u32>,
    factor: f64,
    /// Whether a row has too many values.
    too_many: bool,
}

impl HistorySampler for Fastest {
    fn columns(&self) -> Vec<(String, &'static str)> {
        vec![("speed".into(), "m/s")]
    }
    fn reach(&self) -> Reach {
        Reach::NONE.with_nodes(Selection::These(self.nodes.clone()))
    }
    fn sample(&self, view: &dyn StepView, row: &mut Vec<f64>) -> Result<(), ModelError> {
        let speeds = self.nodes.iter().map(|&node| view.velocity(node).norm());
        let greatest = self.factor * speeds.fold(0.0, f64::max);
        row.push(greatest);
        if self.too_many {
            row.push(greatest);
        }
        Ok(())
    }
}

fn registry() -> Registry {
    let mut registry = Registry::default();
    registry.add_output("fastest", |keys: &FastestKeys, mesh| {
        let nodes = mesh.nodes_of_set(&keys.set);
        let nodes = nodes.map_err(|error| ModelError::refused("set", error))?;
        let factor = keys.factor.unwrap_or(1.0);
        let too_many = factor < 0.0;
        Ok(Arc::new(Fastest {
            nodes,
            factor,
            too_many,
        }) as Arc<dyn HistorySampler>)
    });
    registry
}

/// The cube with a request.
fn with(keys: &str) -> String {
    format!("{CUBE}quantities = [\"velocity\"]\n[[output.own]]\nname = \"top\"\n{keys}")
}

/// A registered output is a column of the histories, with its keys, and is sampled with them.
#[test]
fn a_registered_output_is_among_the_histories() {
    let folder = Folder::new("own-output");
    powerhouse::io::write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
    let of = |keys: &str| {
        let scene =
            FileScene::from_toml(with(keys), folder.join("scene.toml"), &registry()).unwrap();
        let results = scene.prepare().unwrap().run(RunHooks::default());
        results.map(|results| results.histories().clone())
    };
    let table = of("kind = \"fastest\"\nset = \"top\"\nfactor = 2\n").unwrap();
    let names: Vec<&str> = table.columns.iter().map(|column| &*column.name).collect();
    assert_eq!(
        names,
        ["surface.vx", "surface.vy", "surface.vz", "top.speed"]
    );
    let speed = table.column("top.speed").unwrap();
    assert_eq!(speed.unit, "m/s");
    let point = |row: usize| {
        let of = |axis: &str| table.column(&format!("surface.v{axis}")).unwrap().values[row];
        ["x", "y", "z"]
            .map(of)
            .iter()
            .map(|v| v * v)
            .sum::<f64>()
            .sqrt()
    };
    // The point of the history is a node of the set.
    let above =
        (0..table.times.len()).all(|row| speed.values[row] >= 2.0 * point(row) * (1.0 - 1e-9));
    assert!(above && speed.values.iter().any(|&value| value > 0.0));

    let wrong = of("kind = \"fastest\"\nset = \"top\"\nfactor = -1\n").unwrap_err();
    assert!(
        wrong
            .to_string()
            .contains("'top' has 2 values for 1 columns"),
        "{wrong}"
    );
}

/// An output that is not registered, an unknown key, a set that is not there and a name that is used twice are errors with
/// line and column.
#[test]
fn requests_of_own_outputs_are_checked() {
    let folder = Folder::new("own-output-faults");
    powerhouse::io::write_gmsh(folder.join("cube.msh"), &cube()).unwrap();
    let refused = |text: String, registry: &Registry| {
        let error = FileScene::from_toml(text, folder.join("scene.toml"), registry)
            .err()
            .unwrap();
        error.to_string()
    };
    let fastest = "kind = \"fastest\"\nset = \"top\"\n";
    let unknown = refused(with(fastest), &Registry::default());
    assert!(
        unknown.contains("there is no output 'fastest'"),
        "{unknown}"
    );
    let slowest = refused(with("kind = \"slowest\"\n"), &registry());
    assert!(
        slowest.contains("there is no output 'slowest'"),
        "{slowest}"
    );
    let text = with("kind = \"fastest\"\nset = \"roof\"\n");
    let line = text.lines().count();
    let missing = refused(text, &registry());
    assert!(
        missing.contains("roof") && missing.contains(&format!(":{line}:7")),
        "{missing}"
    );
    let text = with(&format!("{fastest}spee = 1\n"));
    let line = text.lines().count();
    let error = FileScene::from_toml(text, folder.join("scene.toml"), &registry());
    let Some(Error::Scene(fault)) = error.err() else {
        panic!("an unknown key is permitted");
    };
    assert_eq!(fault.position(), (line, 1));
    let Problem::UnknownKey { key, permitted } = fault.problem() else {
        panic!("{fault}");
    };
    let permitted: Vec<&str> = permitted.iter().map(String::as_str).collect();
    assert_eq!(
        (key.as_str(), &permitted[..]),
        ("spee", &["set", "factor", "name", "kind"][..])
    );
    let twice = with(fastest).replace("name = \"top\"", "name = \"surface\"");
    let twice = refused(twice, &registry());
    assert!(twice.contains("'surface' is defined twice"), "{twice}");
}

/// The schema has the keys of registered outputs.
#[test]
fn the_schema_has_registered_outputs() {
    let schema = registry().schema().to_value().to_string();
    assert!(schema.contains("fastest") && schema.contains("Factor on the speed"));
    let plain = Registry::default().schema().to_value().to_string();
    assert!(!plain.contains("fastest"));
}

/// Item of output of a program's own: a table of energies at long intervals.
#[derive(Debug)]
struct Coarse {
    name: &'static str,
    every: f64,
}

impl OutputItem for Coarse {
    fn record(&self, _site: &OutputSite, into: &mut Recorder) -> Result<(), Error> {
        let energies =
            EnergyHistory::new(Cadence::Seconds(self.every)).map_err(ModelError::from)?;
        let form = TableForm::new(self.name, TablePlots::One, TablePeaks::All);
        into.table(form, energies.recording(), |table| table);
        into.observe(energies);
        let name = self.name;
        into.list(format!("lists/{name}"), None, move |results| {
            let rows = results.table(name).times.len() as f64;
            Some((vec![TableColumn::new("rows", "1", vec![rows])], None))
        });
        Ok(())
    }
    fn price(&self, scale: &OutputScale) -> OutputPrice {
        scale.table(19.0, self.every)
    }
}

fn with_items(items: &[(&'static str, f64)]) -> Scene {
    let scene = cube_scene();
    let mut plan = scene.output().clone().with_energies(0.1);
    for &(name, every) in items {
        plan = plan.item(Arc::new(Coarse { name, every }));
    }
    scene.with_output(plan)
}

/// A table of a program's own is in the results and their peaks, grows on disk, is announced, written with its plot and its list, and
/// removed before the next run, also after one that was killed; its price is that of its numbers.
#[test]
fn an_item_of_a_program_has_its_files() {
    let folder = Folder::new("own-item");
    let out = ResultFolder::new(folder.join("out"));
    let there = |file: &str| out.path().join(file).exists();
    let files = ["coarse.csv", "plots/coarse.svg", "lists/coarse.csv"];
    let scene = with_items(&[("coarse", 0.05)]);
    let [with, without] =
        [&scene, &with_items(&[])].map(|of| of.output_scale().unwrap().price(1000));
    // Times and nineteen columns at so many instants of the run, its start and its end.
    let numbers = 20.0 * ((scene.duration() / 0.05).ceil() + 2.0);
    assert!((with.memory - without.memory - 32.0 * numbers).abs() < 1e-6);
    let simulation = scene.prepare().unwrap();
    let announced = powerhouse::result_files(&simulation);
    assert!(files.iter().all(|file| announced.iter().any(|a| a == file)));
    let mesh = simulation.mesh().clone();
    out.begin(&simulation).unwrap();
    let tables = out.tables().with_interval(std::time::Duration::ZERO);
    let results = simulation.run(RunHooks::default().with_tables(tables));
    let results = results.unwrap();
    assert!(there("coarse.csv") && !there("plots/coarse.svg"));
    let table = results.table("coarse");
    assert!(table.times.len() > 2 && table.times[1] == 0.05);
    let peaks = results.peaks(&mesh);
    assert!(peaks.rows.iter().any(|row| row.name == "kinetic"));

    // As after a run that was killed.
    out.clear().unwrap();
    assert!(!there("coarse.csv"));
    let written = out.write(("cube", &mesh), &results, &RunNotes::default(), None);
    for file in files {
        assert!(there(file) && written.as_ref().unwrap().contains(&out.path().join(file)));
    }
    let list = std::fs::read_to_string(out.path().join("lists/coarse.csv")).unwrap();
    let rows = list.lines().nth(1).unwrap().parse::<f64>().unwrap();
    assert_eq!(rows, table.times.len() as f64);
    out.clear().unwrap();
    assert!(files.iter().all(|file| !there(file)));
}

/// Two tables of one name are refused, as is one that has the name of a table of the software.
#[test]
fn tables_of_one_name_are_refused() {
    for items in [
        &[("energies", 0.1)][..],
        &[("coarse", 0.1), ("coarse", 0.2)],
    ] {
        let error = with_items(items).prepare().err().unwrap().to_string();
        let name = items[0].0;
        let expected = format!("two results have the name '{name}.csv'");
        assert!(error.contains(&expected), "{error}");
    }
    assert!(
        with_items(&[("coarse", 0.1), ("finer", 0.01)])
            .prepare()
            .is_ok()
    );
}
