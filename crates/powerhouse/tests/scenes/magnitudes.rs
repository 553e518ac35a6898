//! Quantities outside their usual range.

use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::{
    Error, FileScene, Material, Part, Problem, Registry, Remark, RenderFault as _, Scene,
};

use super::nonsense::{fault, warnings_of};
use super::support::*;

/// A quantity outside its usual range is an error with key, value, range and the probable unit; where the scene allows
/// it, it is a warning, and nothing else changes.
#[test]
fn magnitudes_beyond_the_usual_are_refused() {
    let variants = Variants::new("magnitudes");
    for (old, new, told) in [
        (
            "young = 9.0e9",
            "young = 9",
            "young = 9 Pa is outside the usual range of 1e5 to 1.2e12 Pa; 9 GPa would be 9e9 Pa",
        ),
        (
            "density = 2750",
            "density = 2.75",
            "2.75 t/m3 would be 2750 kg/m3",
        ),
        (
            "poisson = 0.27",
            "poisson = -0.99",
            "poisson = -0.99 is outside the usual range",
        ),
        (
            "poisson = 0.27",
            "poisson = 0.49999",
            "poisson = 0.49999 is outside the usual range",
        ),
        (
            "displacement = 0.01",
            "displacement = 10",
            "10 mm would be 0.01 m",
        ),
        ("duration = 0.6", "duration = 1e9", "duration = 1e9 s"),
        (
            "scatterer = [150, 150, 0]",
            "scatterer = [150, 1e300, 0]",
            "scatterer = 1e300 m",
        ),
        (
            "[time]",
            "[[load]]\nkind = \"gravity\"\nacceleration = 1\n[time]",
            "1 g would be 9.807 m/s2",
        ),
        ("title", "self_check = 2\ntitle", "2 % would be 0.02"),
        (
            "file = \"cube.msh\"",
            "file = \"cube.msh\"\nscale = 1000",
            "diagonal of the body = 5.196e5 m",
        ),
        (
            "file = \"cube.msh\"",
            "file = \"cube.msh\"\nscale = 1e-4",
            "diagonal of the body = 0.05196 m",
        ),
    ] {
        let fault = fault(&variants, old, new);
        assert!(fault.to_string().contains(told), "{new}: {fault}");
        assert!(
            fault.render(false).contains("allow = [\"magnitudes\"]"),
            "{new}"
        );
    }
    let allowed = "allow = [\"magnitudes\"]\n";
    let text = CUBE.replace("title", &format!("{allowed}title"));
    let folder = variants.0.join("cube.toml");
    let read = |old: &str, new: &str| {
        let text = text.replacen(old, new, 1);
        FileScene::from_toml(text, &folder, &Registry::default())
            .unwrap()
            .into_scene()
    };
    assert_eq!(warnings_of(read("0.27", "0.27")), []);
    let found = warnings_of(read("density = 2750", "density = 27"));
    assert!(
        found
            .iter()
            .any(|warning| matches!(warning, Remark::Magnitude(m) if m.name == "density"))
    );
    assert!(found.iter().all(Remark::is_warning));
}

/// Scenes composed in Rust have the same usual ranges: media, size of the body, gravity, duration.
#[test]
fn composed_scenes_have_usual_magnitudes() {
    let box_of =
        |size: f64| Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(size), [2; 3], "rock").unwrap();
    let scene = |size: f64, medium: ElasticMedium| {
        let rock = Material::from(LinearElastic::new(medium));
        Scene::new("box", box_of(size)).part(Part::new("rock", rock))
    };
    let down = |g: f64| Vec3::new(0.0, 0.0, -g);
    let medium = |young, density| ElasticMedium {
        young,
        density,
        ..ROCK
    };
    assert!(scene(10.0, ROCK).prepare().is_ok());
    for (scene, name) in [
        (scene(10.0, medium(30.0, 2500.0)), "young"),
        (scene(10.0, medium(30e9, 2.5)), "density"),
        (scene(1e6, ROCK), "diagonal"),
        (scene(1e-3, ROCK), "diagonal"),
        (scene(10.0, ROCK).with_duration(1e9), "duration"),
        (
            scene(10.0, ROCK).gravity(down(1e6), |_: f64| 1.0),
            "gravity",
        ),
    ] {
        match scene.prepare().map(|_| ()) {
            Err(Error::Magnitude { magnitude, .. }) => {
                assert!(magnitude.name.contains(name), "{magnitude}");
            }
            other => panic!("{name}: {other:?}"),
        }
    }
    let found = warnings_of(scene(1e6, ROCK).allow_magnitudes());
    assert!(
        matches!(&found[0], Remark::Magnitude(m) if m.name.contains("diagonal")),
        "{found:?}"
    );
}

/// Keys of the law of the test, which takes any number.
#[derive(serde::Deserialize, schemars::JsonSchema)]
struct AnyNumbers {
    #[serde(rename = "tensile_strength")]
    _tensile_strength: Option<f64>,
    #[serde(rename = "fracture_energy")]
    _fracture_energy: Option<f64>,
    #[serde(rename = "friction")]
    _friction: Option<f64>,
}

/// A value in a mistaken unit is an error with the unit that was probably meant, and what it would be in that unit is
/// accepted; so are zero where a quantity may vanish, and numbers of both signs where they may be negative.
#[test]
fn mistaken_units_are_named() {
    let variants = Variants::new("units");
    let mut registry = Registry::default();
    registry.add_law("any-numbers", |_: AnyNumbers| {
        Ok(Material::from(LinearElastic::new(ROCK)))
    });
    // The magnitude that is refused, if any is: its text, and its value in the probable unit.
    let refused = |keys: &str| {
        let text = CUBE.replacen("[time]", &format!("{keys}\n[time]"), 1);
        let scene = FileScene::from_toml(text, variants.0.join("cube.toml"), &registry)
            .map(FileScene::into_scene);
        match scene.map(|_| ()) {
            Err(Error::Scene(fault)) => match fault.problem() {
                Problem::Magnitude(magnitude) => Some(magnitude.clone()),
                _ => None,
            },
            _ => None,
        }
    };
    let law = "[[material]]\nname = \"other\"\nlaw = \"any-numbers\"";
    let elastic = "[[material]]\nname = \"other\"\nlaw = \"elastic\"\nyoung = 9e9\npoisson = 0.2\ndensity = 2700";
    let joint = "[[joint]]\nname = \"j\"\nbetween = [\"a\", \"b\"]\nlaw = \"frictionless\"";
    let bolt = "[[bolt]]\nname = \"b\"";
    let record = "[[record]]\nname = \"r\"\nfile = \"r.at2\"\nconvention = \"incident\"";
    let gravity = "[[load]]\nkind = \"gravity\"";
    for (table, key, value, told) in [
        (elastic, "young", 30.0, "30 GPa would be 3e10 Pa"),
        (elastic, "young", 25_000.0, "25000 MPa would be 2.5e10 Pa"),
        (elastic, "density", 2.5, "2.5 t/m3 would be 2500 kg/m3"),
        (elastic, "density", 27.0, "27 kN/m3 would be 2753 kg/m3"),
        (law, "tensile_strength", 1.05, "1.05 MPa would be 1.05e6 Pa"),
        (law, "fracture_energy", 0.133, "0.133 N/mm would be 133 N/m"),
        (law, "friction", 0.7, "0.7 rad would be 40.11 degrees"),
        (record, "peak", 0.17, "0.17 g would be 1.667 m/s2"),
        (record, "peak", 170.0, "170 cm/s2 would be 1.7 m/s2"),
        (record, "time_step", 5.0, "5 ms would be 0.005 s"),
        (joint, "gap", 5.0, "5 mm would be 0.005 m"),
        (bolt, "diameter", 25.0, "25 mm would be 0.025 m"),
        (bolt, "pretension", 250.0, "250 kN would be 2.5e5 N"),
        (gravity, "acceleration", 1.0, "1 g would be 9.807 m/s2"),
    ] {
        let with = |value: f64| {
            let others = table.lines().filter(|line| !line.starts_with(key));
            let others: Vec<&str> = others.collect();
            refused(&format!("{}\n{key} = {value:?}", others.join("\n")))
        };
        let magnitude = with(value).unwrap_or_else(|| panic!("{key} = {value} was accepted"));
        assert!(magnitude.to_string().contains(told), "{magnitude}");
        assert_eq!(magnitude.name, key);
        let right = magnitude.probable_unit.unwrap().value;
        assert_eq!(with(right), None, "{key} = {right}");
    }
    assert_eq!(refused(&format!("{law}\ntensile_strength = 0")), None);
    let signed = "[[record]]\nname = \"r\"\nfile = \"r.at2\"\nconvention = \"incident\"\nend_displacement = -3";
    assert_eq!(refused(signed), None);
    let beyond = refused(&elastic.replacen("9e9", "1e300", 1)).unwrap();
    assert_eq!(beyond.probable_unit, None);
}
