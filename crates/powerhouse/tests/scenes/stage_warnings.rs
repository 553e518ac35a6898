//! Ineffective requests and inconsistent stages are errors or warnings.

use powerhouse::{Error, Remark, Results, Scene, remark};

use super::stages::{MATERIALS, ROLLERS, TRENCH, folder, mesh, read};
use super::support::{Folder, run};

/// The trench without bolts.
fn trench() -> String {
    let stages = TRENCH
        .replace("bolts = [\"nail\"]\n", "")
        .replace("bolts = [\"anchors\"]\n", "");
    [MATERIALS, ROLLERS, &stages].concat()
}

/// The ground in static equilibrium, all of its own material.
fn ground() -> String {
    let of_rock = "part = [{ set = \"lining\", material = \"rock\" }]\n";
    [MATERIALS, &ROLLERS.replace(of_rock, "")].concat()
}

fn prepared(folder: &Folder, text: &str) -> Result<(), Error> {
    read(folder, text).and_then(Scene::prepare).map(drop)
}

/// A history at inactive elements of the run is an error at its name, however its location is given; on a wall, in cast
/// elements, and over the rest of a set it is accepted.
#[test]
fn places_where_nothing_is_are_refused() {
    let mesh = mesh();
    let folder = folder(&mesh);
    let text = trench();
    let inner = mesh.element_set("inner").unwrap();
    let node_within = mesh.node_tags()[(0..mesh.node_count())
        .find(|&n| {
            (mesh.positions()[n] - powerhouse::model::Vec3::new(8.0, 4.0, 12.0)).norm() < 1e-9
        })
        .unwrap()];
    let element = mesh.element_tags()[inner[0] as usize];
    let name = "\n[[output.history]]\nname = \"lost\"\n";
    let relative = "\n[[output.relative]]\nname = \"lost\"\nfrom = [2, 4, 12]\n";
    for (place, is_there) in [
        (format!("{name}at = [7, 5, 10]\n"), false),
        (
            format!("{name}at = [7, 5, 10]\nquantities = [\"stress\"]\n"),
            false,
        ),
        (format!("{name}element = {element}\n"), false),
        (format!("{name}set = \"inner\"\n"), true),
        (format!("{name}set = \"trench\"\n"), true),
        (format!("{name}at = [8, 5, 10]\n"), true),
        (
            format!("{name}at = [8, 5, 10]\nquantities = [\"stress\"]\n"),
            true,
        ),
        (format!("{name}node = {node_within}\n"), true),
        (
            format!("{name}at = [5, 5, 10]\nquantities = [\"stress\"]\n"),
            true,
        ),
        (format!("{relative}at = [7, 5, 10]\n"), false),
        (format!("{relative}at = [8, 5, 10]\n"), true),
    ] {
        let whole = format!("{text}{place}");
        let line = 1 + whole
            .lines()
            .position(|line| line == "name = \"lost\"")
            .unwrap();
        match prepared(&folder, &whole) {
            Ok(()) => assert!(is_there, "{place}"),
            Err(Error::Scene(fault)) => {
                assert!(!is_there, "{place}: {fault}");
                assert!(fault.to_string().contains("no active element"), "{fault}");
                assert_eq!(fault.position().0, line, "{fault}");
            }
            Err(other) => panic!("{place}: {other}"),
        }
    }
    // Without its stages all elements are active.
    let open = text.find("\n[[stage]]").unwrap();
    let in_situ = text.find("[in_situ_stress]").unwrap()..text.find("[boundary]").unwrap();
    let mut plain = text[..open].to_owned();
    plain.replace_range(in_situ, "");
    prepared(&folder, &format!("{plain}{name}at = [7, 5, 10]\n")).unwrap();
}

/// A temporary material of a part without active elements is an error: it would have no effect.
#[test]
fn a_material_of_what_is_not_there_is_refused() {
    let folder = folder(&mesh());
    // The lining is never excavated, so that it is inactive before it is cast.
    let stages = "[[stage]]\nname = \"room\"\nexcavate = [\"inner\"]\n[[stage]]\nname = \"support\"\ncast = [\"lining\"]\n";
    let text = [MATERIALS, ROLLERS, stages].concat();
    let Err(Error::Scene(fault)) = prepared(&folder, &text) else {
        panic!("accepted");
    };
    let told = fault.to_string();
    assert!(
        told.contains("no element of part 'lining' is active"),
        "{told}"
    );
    let line = 1 + text
        .lines()
        .position(|line| line.starts_with("part = ["))
        .unwrap();
    assert_eq!(fault.position().0, line, "{told}");
    // In the stage that casts it, and where it is excavated first, it has a material.
    let cast = text.replacen(
        "part = [{ set = \"lining\", material = \"rock\" }]\n",
        "",
        1,
    );
    prepared(&folder, &cast).unwrap();
    let soft = "cast = [\"lining\"]\npart = [{ set = \"lining\", material = \"rock\" }]\n";
    prepared(&folder, &cast.replacen("cast = [\"lining\"]\n", soft, 1)).unwrap();
    prepared(&folder, &trench()).unwrap();
}

fn found(text: &str) -> (Results, Vec<Remark>) {
    let mesh = mesh();
    let folder = folder(&mesh);
    let results = run(read(&folder, text).unwrap());
    let warnings = results.warnings(&mesh);
    (results, warnings)
}

/// An in-situ stress that is not in equilibrium with gravity has a warning with the unbalanced force over the load; one in
/// equilibrium, and a first stage with excavation, have none.
#[test]
fn a_stress_that_contradicts_gravity_is_warned_of() {
    let share_of = |text: &str| {
        let (results, warnings) = found(text);
        let told = warnings.iter().find_map(|warning| match warning {
            Remark::Unbalanced(remark::Unbalanced { share, stage, .. }) => {
                assert_eq!(stage, "ground");
                assert!(warning.is_warning());
                Some(*share)
            }
            _ => None,
        });
        (results.stages[0].solution.unbalanced, told)
    };
    let text = ground();
    // The lining is lighter than the ground that the stress is of.
    let (share, told) = share_of(&text);
    assert!(share < 0.02 && told.is_none(), "{share:e}");
    // A density that is a fifth too small: this share of the weight is unbalanced.
    let lighter = text.replacen(
        "level = 12\ndensity = 2600",
        "level = 12\ndensity = 2080",
        1,
    );
    assert_ne!(lighter, text);
    let (share, told) = share_of(&lighter);
    assert!((share - 0.2).abs() < 0.03 && told == Some(share), "{share}");
    let dug = lighter.replacen(
        "name = \"ground\"\n",
        "name = \"ground\"\nexcavate = [\"trench\"]\n",
        1,
    );
    assert!(share_of(&dug).1.is_none());
}

/// Accelerations with too long sampling intervals have warnings, in histories and envelopes; those with sufficient ones
/// have none.
#[test]
fn rare_samples_are_warned_of() {
    let push = "[[load]]\nkind = \"nodal\"\nset = \"top\"\nforce = [1e4, 0, 0]\nfunction = { kind = \"ricker\", frequency = 10, delay = 0.15 }\n";
    for (every, rare) in [(0.002, false), (0.006, false), (0.06, true)] {
        let text = [&ground(), push].concat().replacen(
            "every = 0.01\n",
            &format!("every = {every}\nenvelope = {{ quantities = [\"acceleration\"], every = {every} }}\n"),
            1,
        );
        let (_, warnings) = found(&text);
        let of_history = warnings.iter().any(
            |warning| matches!(warning, Remark::Undersampled(remark::Undersampled { name, .. }) if name == "corner"),
        );
        let of_envelope = warnings
            .iter()
            .any(|warning| matches!(warning, Remark::SparseEnvelope(_)));
        assert_eq!(
            [of_history, of_envelope],
            [rare; 2],
            "{every}: {warnings:?}"
        );
    }
}

/// Stages without stress and loads, and stress of weight without gravity, are warned of with the keys that give both, before anything
/// is computed; ground with both has no such warning, nor has a uniform stress, which needs no weight.
#[test]
fn ground_without_weight_or_stress_is_warned_of() {
    let folder = folder(&mesh());
    let whole = [MATERIALS, ROLLERS].concat();
    let gravity = "[[load]]\nkind = \"gravity\"\n";
    let stress = "[in_situ_stress]\nkind = \"ground\"\nlevel = 12\ndensity = 2600\nlateral = 0.5\n";
    assert!(whole.contains(gravity) && whole.contains(stress));
    let uniform = "[in_situ_stress]\nkind = \"linear\"\nlevel = 12\nstress = [-1e5, -1e5, -1e5, 0, 0, 0]\ngradient = [0, 0, 0, 0, 0, 0]\n";
    let weightless = whole.replace(gravity, "");
    for (text, expected) in [
        (whole.clone(), None),
        (whole.replace(stress, ""), None),
        (weightless.clone(), Some(remark::WeightlessGround {}.into())),
        (
            weightless.replace(stress, ""),
            Some(remark::IdleStages {}.into()),
        ),
        (weightless.replace(stress, uniform), None),
    ] {
        let scene = read(&folder, &text).unwrap();
        let is_lack = |remark: &&Remark| {
            matches!(remark, Remark::IdleStages(_) | Remark::WeightlessGround(_))
        };
        let found = scene.remarks().iter().find(is_lack).cloned();
        assert_eq!(found, expected, "{text}");
        let texts = found.map(|remark| (remark.is_warning(), remark.to_string()));
        assert!(texts.is_none_or(|(warning, text)| warning && text.contains("`gravity`")));
    }
}
