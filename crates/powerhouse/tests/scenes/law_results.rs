//! History variables of laws and energies of plasticity and damage in results.

use powerhouse::engine::observe::Column;
use powerhouse::material::{
    MohrCoulomb, MohrCoulombParameters, PlasticDamage, PlasticDamageParameters, Softening, presets,
};
use powerhouse::{Error, Material, Remark, RunNotes};

use super::support::*;

/// The paper's rock, weak enough to yield under the cube's wave.
fn weak() -> MohrCoulombParameters {
    MohrCoulombParameters {
        cohesion: 2.0e4,
        tension_strength: Some(1.0e4),
        ..presets::PAPER_ROCK
    }
}

/// Rock that cracks and crushes early.
fn cracking() -> Material {
    let rates = |rate| Softening::Rates {
        share: 1.0,
        rate,
        threshold: 0.0,
    };
    let law = PlasticDamage::new(PlasticDamageParameters {
        surface: MohrCoulomb::new(weak()).unwrap(),
        tension: rates(2e4),
        compression: rates(5e3),
        stiffness_recovery: 1.0,
        residual_stiffness: 1e-2,
    });
    Material::from(law.unwrap())
}

/// With plasticity and damage the energy balance closes to rounding, plastic and damage energies never decrease, closing
/// cracks give no energy back, and the integration error of a step decreases with the step.
#[test]
fn energies_of_plastic_flow_and_damage_are_reported() {
    let energies = |share: f64| {
        let scene = cube_scene_made_of(cube(), &["rock"], &cracking());
        let mut plan = scene.output().clone();
        plan.energies = Some(0.01);
        let scene = scene
            .with_output(plan)
            .with_step(powerhouse::TimeStep::OfStable(share));
        let results = run(scene.with_energy_residual(powerhouse::ResidualLimit::Share(1e-9)));
        let residual = results.energy_residual().unwrap();
        assert!(residual.largest < 1e-9, "{residual:?}");
        assert!(residual.share_of_input.unwrap() < 1e-9, "{residual:?}");
        let column = |name: &str| results.energies().column(name).unwrap().values.clone();
        let rising = |values: &[f64], sign: f64| {
            assert!(
                values
                    .windows(2)
                    .all(|pair| sign * (pair[1] - pair[0]) >= 0.0)
            );
            sign * values.last().unwrap()
        };
        let plastic = rising(&column("plastic"), 1.0);
        let damage = rising(&column("damage"), 1.0);
        assert!(plastic > 0.0 && damage > 0.0);
        assert!(column("recovery").iter().all(|energy| *energy == 0.0));
        column("integration").last().unwrap().abs() / (plastic + damage)
    };
    let (coarse, fine) = (energies(1.0), energies(0.25));
    assert!(coarse < 0.1, "{coarse}");
    // Of first order in the step: a quarter; a half proves that it falls.
    assert!(fine < 0.5 * coarse, "{fine} after {coarse}");
}

/// History variables of laws are recorded in histories, envelopes and snapshots by name, and the summary contains the
/// largest damage and its location; from a file and from Rust.
#[test]
fn history_variables_are_recorded() {
    let variants = Variants::new("laws-state");
    let keys = "law = \"plastic-damage\"\npreset = \"paper-rock\"\ncohesion = 2e4\ntensile_strength = 1e4\ntension = { rate = 2e4 }\ncompression = { rate = 5e3 }\nresidual_stiffness = 0.01\n";
    let text = undamped(keys)
        + "quantities = [\"displacement\", \"velocity\", \"acceleration\", \"state\"]\n[output.envelope]\nquantities = [\"state\"]\nevery = 0.05\n[output.snapshots]\nquantities = [\"displacement\", \"state\"]\nevery = 0.2\n";
    let path = variants.0.join("cube.toml");
    let scene =
        powerhouse::FileScene::from_toml(text, path, &powerhouse::Registry::default()).unwrap();
    let out = powerhouse::ResultFolder::new(variants.0.join("out"));
    let mesh = scene.mesh().clone();
    let simulation = scene.prepare().unwrap();
    let hooks = powerhouse::RunHooks::default().with_snapshots(out.snapshots(&simulation).unwrap());
    let results = simulation.run(hooks).unwrap();
    let twin = cube_scene_made_of(cube(), &["rock"], &cracking());
    let mut plan = twin.output().clone();
    plan = plan.state("surface", powerhouse::model::Vec3::new(150.0, 150.0, 0.0));
    let twin = run(twin.with_output(plan));
    assert_eq!(results.histories(), twin.histories());
    for name in ["damage", "plastic_strain_zx", "yield_state"] {
        let column = results
            .histories()
            .column(&format!("surface.{name}"))
            .unwrap();
        assert!(column.values.iter().any(|v| *v != 0.0), "{name}");
    }
    let last = |results: &powerhouse::Results, name: &str| {
        let state = results.state.as_ref().unwrap();
        let (_, field) = state.peaks.iter().find(|(v, _)| v.name == name).unwrap();
        field.values.clone()
    };
    // A variable that never decreases has the same envelope with any sampling interval.
    let torn = last(&results, "damage_tension");
    assert_eq!(torn, last(&twin, "damage_tension"));
    assert!(torn.iter().all(|d| (0.0..1.0).contains(d)) && torn.iter().any(|d| *d > 0.1));
    out.write(("cube", &mesh), &results, &RunNotes::default(), None)
        .unwrap();
    let summary = std::fs::read_to_string(out.path().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let peaks = summary["peaks"].as_array().unwrap();
    let peak = peaks
        .iter()
        .find(|peak| peak["name"] == "damage_tension")
        .unwrap();
    let most = torn.iter().copied().fold(0.0, f64::max);
    // Numbers of JSON are read to a rounding.
    assert!((peak["value"].as_f64().unwrap() - most).abs() < 1e-12);
    let place = torn.iter().position(|d| *d == most).unwrap();
    let element = mesh.element_tags()[results.state.as_ref().unwrap().elements[place] as usize];
    assert_eq!(peak["place"], format!("element {element}"));
    for (file, names) in [
        ("state.vtu", ["damage_tension", "damage_type"]),
        ("snapshots/snapshots_00001.vtu", ["damage", "yield_state"]),
    ] {
        let bytes = std::fs::read(out.path().join(file)).unwrap();
        let head = String::from_utf8_lossy(&bytes);
        for name in names {
            assert!(head.contains(&format!("Name=\"{name}\"")), "{file}: {name}");
        }
    }
    assert!(out.path().join("pictures/damage_tension.png").exists());
}

/// State variables belong to elements: a request at a node is an error with its position.
#[test]
fn nodes_have_no_state() {
    let variants = Variants::new("laws-nodes");
    let old = "at = [150, 150, 0]";
    let Err(Error::Scene(fault)) = variants.read(old, "node = 1\nquantities = [\"state\"]") else {
        panic!("a node has a state");
    };
    assert!(
        fault.to_string().contains("stress or state at a node"),
        "{fault}"
    );
}

/// A state history of an element without history variables has a warning with its name; one of an element with history
/// variables has none.
#[test]
fn a_state_request_without_history_variables_is_reported() {
    let variants = Variants::new("laws-no-state");
    let wanted = "quantities = [\"displacement\", \"state\"]\n";
    let remarks = |law: &str| -> Vec<String> {
        let text = CUBE.replacen(ELASTIC, law, 1) + wanted;
        let path = variants.0.join("cube.toml");
        let scene = powerhouse::FileScene::from_toml(text, path, &powerhouse::Registry::default());
        let simulation = scene.unwrap().prepare().unwrap();
        let warnings = simulation
            .remarks()
            .iter()
            .filter(|remark| remark.is_warning());
        warnings.map(ToString::to_string).collect()
    };
    let told = |remarks: Vec<String>| {
        remarks
            .iter()
            .filter(|told| told.contains("has no history variables"))
            .count()
    };
    assert!(
        remarks(ELASTIC)
            .iter()
            .any(|told| told.starts_with("history 'surface' requests the state of element"))
    );
    assert_eq!(told(remarks(ELASTIC)), 1);
    let yields = "law = \"mohr-coulomb\"\npreset = \"paper-rock\"\n";
    assert_eq!(told(remarks(yields)), 0);
}

/// Energy that closing cracks give, and the error of the time integration of laws, are warned of where they are of the size
/// of what plastic flow and damage take.
#[test]
fn energy_of_closing_cracks_is_warned_of() {
    let warning = |[plastic, damage, recovery, integration]: [f64; 4]| {
        let scene = cube_scene();
        let plan = scene.output().clone().with_energies(0.1);
        let mut results = run(scene.with_output(plan));
        let mut tables = results.tables.iter_mut();
        let energies = tables.find(|table| table.form.name == "energies").unwrap();
        energies.rows.times = vec![0.0, 1.0];
        energies.rows.columns = [
            ("plastic", plastic),
            ("damage", damage),
            ("recovery", recovery),
            ("integration", integration),
        ]
        .map(|(name, value)| Column::new(name, "J", vec![0.0, value]))
        .into();
        let warnings = results.warnings(&cube());
        let found = warnings
            .iter()
            .find(|remark| matches!(remark, Remark::CrackEnergy(_)));
        found.map(|remark| (remark.is_warning(), remark.to_string()))
    };
    let (is_warning, text) = warning([2.0, 3.0, -4.0, 0.0]).unwrap();
    assert!(
        is_warning && text.contains("4.00e0 J") && text.contains("5.00e0 J"),
        "{text}"
    );
    assert!(warning([2.0, 3.0, 0.0, 0.6]).is_some() && warning([2.0, 3.0, 0.0, -0.6]).is_some());
    for sound in [[2.0, 3.0, -2.0, 0.3], [0.0; 4]] {
        assert_eq!(warning(sound), None);
    }
}
