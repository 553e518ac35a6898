//! What is said of faults of delayed ends, and of bodies that have them.

use powerhouse::model::{Mesh, Vec3};

use super::delayed_sides::{GROUND, scene, scene_on};

/// The ground as a bay of two layers of elements, with so many facets of its front and back left out of their sets.
fn bay(left_out: usize) -> Mesh {
    let (low, high) = (Vec3::new(-100.0, -2.0, -100.0), Vec3::new(100.0, 2.0, 0.0));
    let mut mesh = Mesh::box_of_hexes(low, high, [20, 2, 10], "rock").unwrap();
    for end in ["front", "back"] {
        let facets = mesh.facet_set(end).unwrap()[left_out..].to_vec();
        mesh.set_facet_set(end, facets).unwrap();
    }
    mesh
}

/// What is wrong with delayed ends is named with its line in the scene file: ends across x, an end that absorbs, sets that lack facets, number
/// formats; and a wave past the critical angle before the time at which it arrives.
#[test]
fn faults_of_delayed_ends_are_named_with_their_line() {
    let line_of = |text: &str, what: &str| {
        let before = &text[..text.find(what).unwrap()];
        format!("slice.toml:{}:", before.matches('\n').count() + 1)
    };
    let cases = [
        (
            0,
            "from = \"front\", to = \"back\"",
            "from = \"left\", to = \"right\"",
            "kind = \"delayed\"",
            "normal to y, one of them the other translated along y, and those of 'left' and 'right' are apart by (200, 0, 0) m",
        ),
        (
            0,
            "\"right\", \"bottom\"",
            "\"right\", \"front\", \"bottom\"",
            "faces =",
            "'front' is one of the two delayed ends, and a face that is delayed cannot absorb",
        ),
        (
            10,
            "",
            "",
            "kind = \"delayed\"",
            "must hold all facets of these ends",
        ),
        (
            0,
            "mesh =",
            "precision = \"mixed\"\nmesh =",
            "kind = \"delayed\"",
            "a body with delayed ends under waves along y does not take set 'rock' in single",
        ),
        (
            0,
            "[time]",
            "[[load]]\nkind = \"gravity\"\nfunction = { kind = \"table\", times = [0, 1], values = [0, 1] }\n[time]",
            "kind = \"delayed\"",
            "a body with delayed ends does not take loads that change",
        ),
        (
            0,
            "incidence = 25\n",
            "incidence = 45\narrival = -0.2\n",
            "incidence =",
            "past the critical angle",
        ),
    ];
    let missed = cases
        .into_iter()
        .filter_map(|(left_out, from, to, place, message)| {
            let text = GROUND.replacen(from, to, 1);
            let refused = match scene_on(&bay(left_out), &text) {
                Err(error) => Some(error),
                Ok(scene) => scene.into_scene().prepare().err(),
            };
            let refused = refused.map_or_else(String::new, |error| error.to_string());
            let line = line_of(&text, place);
            let is_named = refused.contains(message) && refused.contains(&line);
            (!is_named).then(|| format!("{message} at {line}: {refused}"))
        });
    let missed: Vec<String> = missed.collect();
    assert!(missed.is_empty(), "{missed:#?}");
    // Both sides of a slice absorb as well as those of a bay.
    let absorbing = GROUND.replacen("\"right\", \"bottom\"", "\"back\", \"bottom\"", 1);
    let refused = scene(&absorbing).err().unwrap().to_string();
    assert!(
        refused.contains("'back' is one of the two delayed ends"),
        "{refused}"
    );
}

/// A point outside of the layer that `slice` takes is refused with the extent of the layer.
#[test]
fn a_point_outside_of_the_layer_is_refused_with_its_extent() {
    let cut = "file = \"slice.msh\", slice = { across = \"y\", at = AT }";
    let refused = |at: &str| {
        let text = GROUND.replacen("file = \"slice.msh\"", &cut.replacen("AT", at, 1), 1);
        scene_on(&bay(0), &text)
            .err()
            .map(|error| error.to_string())
    };
    assert_eq!(refused("0.0"), None);
    let found = refused("-0.1").unwrap();
    assert!(
        found.contains("lies in no element")
            && found.contains("takes the layer of elements from y = -2 to 0 m"),
        "{found}"
    );
}

/// Remarks about a body with delayed ends do not propose them, and the times of a bay under waves against y are earlier ones.
#[test]
fn remarks_know_of_delayed_ends() {
    let remarks = |text: &str| {
        let scene = scene_on(&bay(0), text).unwrap().into_scene();
        let simulation = scene.prepare().unwrap();
        simulation
            .remarks()
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
    };
    let held = "[{ kind = \"roller\", set = \"right\" }, { kind = \"delayed\"";
    let held = GROUND.replacen("[{ kind = \"delayed\"", held, 1).replacen(
        "\"left\", \"right\"",
        "\"left\"",
        1,
    );
    let of_held = remarks(&held);
    let warned = of_held
        .iter()
        .filter(|remark| remark.contains("reflect the incident waves"));
    assert_eq!(warned.clone().count(), 1, "{of_held:?}");
    assert!(
        warned.clone().all(|remark| !remark.contains("delayed")),
        "{of_held:?}"
    );
    for (azimuth, first) in [("60", "later"), ("-60", "earlier")] {
        let of_bay = remarks(&GROUND.replacen("azimuth = 60", &format!("azimuth = {azimuth}"), 1));
        let expected = format!("happens there {first} by 0.");
        assert!(
            of_bay.iter().any(|remark| remark.contains(&expected)),
            "{of_bay:?}"
        );
    }
}
