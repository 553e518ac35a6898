//! Faults of stages, bolts and the in-situ stress.

use powerhouse::Error;

use super::{SOUND, fault_of, read};

/// A sound scene with an in-situ stress, bolts and stages.
fn staged() -> String {
    SOUND.replace("[time]", STAGES) + "\n"
}

const GROUND: &str = "kind = \"ground\"\nlevel = 0\ndensity = 2750\nlateral = 0.6";

const STAGES: &str = r#"[in_situ_stress]
kind = "ground"
level = 0
density = 2750
lateral = 0.6

[[bolt]]
name = "roof"
diameter = 0.025
lines = [[[0, 0, -60], [0, 0, -55]]]

[[stage]]
name = "ground"

[[stage.part]]
set = "rock"
material = "rock"

[[stage.support]]
kind = "roller"
set = "bottom"

[[stage]]
name = "lining"
cast = ["lining"]
bolts = ["roof"]

[[stage.load]]
kind = "pressure"
set = "intrados"
pressure = 1e5

[time]"#;

/// A fault of stages, bolts or the in-situ stress is reported with its position when the scene is read.
#[test]
fn faults_of_stages_have_their_place() {
    let sound = staged();
    let scene = read(&sound).unwrap();
    assert_eq!(scene.stages().len(), 2);
    assert_eq!(
        scene.stage_overviews().unwrap()[1].bolts,
        [("roof".into(), 1)]
    );
    for (old, new, message) in [
        ("level = 0", "§lvel = 0", "unknown key 'lvel'"),
        (
            "kind = \"ground\"",
            "kind = §\"grund\"",
            "'grund' is not permitted here",
        ),
        ("lateral = 0.6", "lateral = §-0.6", "a number of 0 or above"),
        (
            GROUND,
            "kind = \"layers\"\nlevel = 0\nlayers = §[]",
            "found no layers, expected at least one",
        ),
        (
            GROUND,
            "kind = \"layers\"\nlevel = 0\nlayers = [{ bottom = §4, density = 2000, lateral = 1 }, { density = 2700, lateral = 0.5 }]",
            "a lower end below 0 m",
        ),
        (
            GROUND,
            "kind = \"layers\"\nlevel = 0\nlayers = [{ bottom = -4, density = 2000, lateral = 1 }, { bottom = §-9, density = 2700, lateral = 0.5 }]",
            "a last layer without `bottom`",
        ),
        (
            GROUND,
            "kind = \"layers\"\nlevel = 0\nlayers = §[{ density = 2000, lateral = 1 }, { density = 2700, lateral = 0.5 }]",
            "layer 1 of 2 without `bottom`",
        ),
        ("diameter = 0.025", "diameter = §0", "a number above 0"),
        (
            "name = \"roof\"\ndiameter",
            "name = §\"roof\"\nsection = 1e-4\ndiameter",
            "exactly one of diameter, section",
        ),
        (
            "name = \"roof\"\ndiameter = 0.025\nlines",
            "name = §\"roof\"\ndiameter = 0.025\npattern = { facets = \"top\", along = [1, 0, 0], spacing = [1, 1], length = 3 }\nlines",
            "exactly one of lines, pattern",
        ),
        (
            "diameter = 0.025\n",
            "diameter = 0.025\ngrout = { stiffness = 1e9 }\npretension = §1e5\n",
            "pretension = 100000",
        ),
        (
            "name = \"roof\"\ndiameter = 0.025\nlines = [[[0, 0, -60], [0, 0, -55]]]",
            "name = §\"roof\"\ndiameter = 0.025\nlines = [[[0, 0, -60], [0, 0, 5]]]",
            "bolts 'roof'",
        ),
        (
            "lines = [[[0, 0, -60], [0, 0, -55]]]",
            "pattern = { facets = §\"roof\", along = [0, 1, 0], spacing = [1, 1], length = 3 }",
            "there is no facet set 'roof'",
        ),
        (
            "cast = [\"lining\"]",
            "cast = [§\"linning\"]",
            "there is no element set 'linning'",
        ),
        (
            "[[stage.load]]",
            "[[stage]]\nname = \"again\"\ncast = [§\"lining\"]\n[[stage.load]]",
            "cannot be cast: it is active already",
        ),
        (
            "[[stage.load]]",
            "[[stage]]\nname = \"out\"\nexcavate = [§\"rock\"]\n[[stage.load]]",
            "the bolts 'roof' cross it",
        ),
        (
            "bolts = [\"roof\"]",
            "bolts = [§\"rof\"]",
            "there are no bolts 'rof'",
        ),
        (
            "bolts = [\"roof\"]",
            "bolts = [\"roof\", §\"roof\"]",
            "'roof' is repeated in the list 'bolts'",
        ),
        (
            "bolts = [\"roof\"]",
            "bolts = [\"roof\"]\ntied = [§\"seam\"]",
            "there is no joint 'seam'",
        ),
        (
            "bolts = [\"roof\"]",
            "bolts = [\"roof\"]\ngrouted = [§\"seam\"]",
            "there is no joint 'seam'",
        ),
        (
            "name = \"lining\"",
            "name = §\"ground\"",
            "another stage has the same name",
        ),
        ("cast =", "release = §1.5\ncast =", "above 0 and at most 1"),
        ("cast =", "increments = §0\ncast =", "a whole number"),
        ("cast =", "tolerance = §2\ncast =", "tolerance = 2"),
        (
            "set = \"rock\"\nmaterial = \"rock\"\n\n[[stage.support",
            "set = §\"left\"\nmaterial = \"rock\"\n\n[[stage.support",
            "there is no part 'left'",
        ),
        (
            "set = \"rock\"\nmaterial = \"rock\"\n\n[[stage.support",
            "set = \"rock\"\nmaterial = §\"rok\"\n\n[[stage.support",
            "there is no material 'rok'",
        ),
        (
            "kind = \"roller\"",
            "kind = §\"periodic\"",
            "'periodic' is not permitted here",
        ),
        ("set = \"bottom\"", "set = §\"botom\"", "'botom'"),
        (
            "set = \"intrados\"",
            "set = §\"intrado\"",
            "there is no facet set 'intrado'",
        ),
        (
            "pressure = 1e5",
            "pressure = 1e5\nremoved_in = §\"linning\"",
            "no stage 'linning' that could remove the load",
        ),
        (
            "pressure = 1e5",
            "pressure = 1e5\nremoved_in = §\"lining\"",
            "stage 'lining' cannot remove the load: it acts from stage 'lining' on",
        ),
        (
            "pressure = 1e5",
            "pressure = 1e5\nremoved_in = §\"ground\"",
            "stage 'ground' cannot remove the load",
        ),
        (
            "[in_situ_stress]",
            "[[load]]\nkind = \"nodal\"\nset = \"top\"\nforce = [0, 0, 1]\nremoved_in = §\"ground\"\n[in_situ_stress]",
            "it acts from stage 'ground' on",
        ),
        (
            "[in_situ_stress]",
            "[[load]]\nkind = \"gravity\"\n§removed_in = \"lining\"\n[in_situ_stress]",
            "unknown key 'removed_in'",
        ),
        (
            "duration = 20",
            "duration = 20\ninitial = §\"field\"",
            "starts at rest",
        ),
    ] {
        let fault = fault_of(&sound, old, new);
        assert!(fault.to_string().contains(message), "{new}: {fault}");
    }
    let idle = sound.replace("bolts = [\"roof\"]\n", "");
    let fault = fault_of(&idle, "name = \"roof\"", "name = §\"roof\"");
    assert!(fault.to_string().contains("no stage installs"), "{fault}");
    // Without a stage the ground cannot reach static equilibrium.
    let from = sound.find("[[stage]]").unwrap();
    let until = sound.find("[time]").unwrap();
    let none = [&sound[..from], &sound[until..]].concat();
    let Err(Error::Scene(fault)) = read(&none) else {
        panic!("an in-situ stress without a stage was accepted")
    };
    assert!(
        fault.to_string().contains("only in a scene with stages"),
        "{fault}"
    );
    let line = none[..none.find("[in_situ_stress]").unwrap()]
        .matches('\n')
        .count()
        + 1;
    assert_eq!(fault.position().0, line, "{fault}");
    // A preload would be counted in addition to the traction of the stages.
    let joint = "[[joint]]\nname = \"contact\"\nbetween = [\"rock\", \"lining\"]\nlaw = \"tied\"\npreload = §{ kind = \"pressure\", pressure = 1e5 }\n[[bolt]]";
    let fault = fault_of(&sound, "[[bolt]]", joint);
    assert!(fault.to_string().contains("counted twice"), "{fault}");
}
