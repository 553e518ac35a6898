//! Materials from files without a run: warnings about them, and single-point tests.

use powerhouse::Registry;

use super::support::*;

const ELASTIC: &str = "law = \"elastic\"\nyoung = 9.0e9\npoisson = 0.27\ndensity = 2750\n";

/// Strengths that follow from other parameters are compared with the given ones; hardening before the peak has a
/// warning.
#[test]
fn implied_strengths_are_reported() {
    let variants = Variants::new("laws-implied");
    let mass = "law = \"hoek-brown\"\nyoung = 9e9\npoisson = 0.27\ndensity = 2750\nintact_strength = 6e7\nintact_constant = 12\nstrength_index = 55\n";
    let told = |keys: &str| -> Vec<String> {
        let scene = variants.read(ELASTIC, keys).unwrap();
        let warnings = scene.parts()[0].material.warnings();
        warnings.to_vec()
    };
    assert_eq!(told(mass), Vec::<String>::new());
    // s^a = exp(-5 a) with a = 0.504 of 60 MPa.
    let listed = format!("{mass}compressive_strength = 6e7\ntensile_strength = 1e7\n");
    let [tension, compression] = &told(&listed)[..] else {
        panic!("{:?}", told(&listed));
    };
    assert!(
        tension.starts_with("uniaxial tension yields at 1.6"),
        "{tension}"
    );
    assert!(
        compression.contains("strength of 4.826") && compression.contains("6.0000e7"),
        "{compression}"
    );
    let concrete = "law = \"lee-fenves\"\npreset = \"C30\"\n";
    assert_eq!(told(concrete), Vec::<String>::new());
    let hardening = told(&format!(
        "{concrete}compressive_limit = 1.5e7\npoisson = 0.495\n"
    ));
    assert!(
        hardening[0].contains("hardens up to 3.8000e7 Pa"),
        "{hardening:?}"
    );
    assert!(hardening[1].contains("nearly 0.5"), "{hardening:?}");
}

/// Every law of the registry can be tested along a path from a material file alone: it has stress, and all except the
/// elastic one have changed a history variable.
#[test]
fn every_law_is_driven() {
    let folder = Folder::new("laws-driven");
    let rock = "young = 9e9\npoisson = 0.27\ndensity = 2750\n";
    let keys_of = |law: &str| match law {
        "elastic" => rock.to_owned(),
        "hoek-brown" => {
            format!(
                "{rock}intact_strength = 6e7\nintact_constant = 12\nstrength_index = 55\ndilation_share = 1\n"
            )
        }
        _ => "preset = \"paper-c25\"\n".to_owned(),
    };
    let path = folder.join("path.toml");
    std::fs::write(
        &path,
        "size = 0.2\n[[leg]]\nkind = \"cyclic\"\nstrains = [-2e-3, 5e-4]\nsteps = 50\n",
    )
    .unwrap();
    let registry = Registry::default();
    for law in registry.law_names() {
        let file = folder.join("law.toml");
        let keys = keys_of(law);
        let text = format!("[[material]]\nname = \"m\"\nlaw = \"{law}\"\n{keys}");
        std::fs::write(&file, text).unwrap();
        let material = registry.material_of_file(&file, None).unwrap();
        let driven = powerhouse::PointPath::from_file(&path).unwrap();
        let driven = driven
            .drive(&material)
            .unwrap_or_else(|e| panic!("{law}: {e}"));
        let (component, [least, greatest]) = driven.extremes();
        assert_eq!(component, "zz", "{law}");
        assert!(least < -1e6 && greatest > 1e4, "{law}: {least} {greatest}");
        let last = driven.records.last().unwrap();
        let has_changed = last.history.iter().any(|value| *value != 0.0);
        assert_eq!(has_changed, law != "elastic", "{law}");
    }
}

/// Paths have at most a million steps, so that none of them takes the machine's memory: the error names the leg.
#[test]
fn endless_paths_are_refused() {
    let leg =
        |steps: u64| format!("[[leg]]\nkind = \"uniaxial\"\nstrain = 1e-3\nsteps = {steps}\n");
    let read = |text: String| powerhouse::PointPath::from_toml(text, "path.toml");
    let longest = read(leg(600_000) + &leg(400_000)).unwrap();
    assert_eq!(longest.steps(), 1_000_000);
    for (text, line) in [
        (leg(600_000) + &leg(400_001), "path.toml:5"),
        (leg(u64::MAX >> 1) + &leg(1), "path.toml:1"),
        (
            "[[leg]]\nkind = \"cyclic\"\nstrains = [1e-3, 2e-3, 0]\nsteps = 400_000\n".into(),
            "path.toml:1",
        ),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(error.contains(line), "{error}");
        assert!(error.contains("at most 1000000 steps"), "{error}");
    }
}
