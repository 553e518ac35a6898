//! Every fault of a scene file is reported once, with its position, before the computation.

mod stages;

use std::path::PathBuf;

use powerhouse::{Error, FileScene, Problem, Registry, RenderFault as _, SceneFault, SceneFile};

/// A scene without fault; the mesh and the record are those of the coarse cavern.
const SOUND: &str = r#"title = "test"

[mesh]
file = "../meshes/cavern_small.msh"

[[material]]
name = "rock"
law = "elastic"
young = 9.0e9
poisson = 0.27
density = 2750

[[part]]
set = "rock"
material = "rock"

[[part]]
set = "lining"
material = "rock"
kernel = "hex8-full"

[[record]]
name = "el-centro"
file = "../records/el_centro_1940_ns.csv"
units = "m/s2"
cut = [0, 20]
baseline = { kind = "velocity-polynomial", order = 5 }
peak = 1.7
convention = "incident"

[[wave]]
kind = "sv"
incidence = 30
record = "el-centro"

[boundary]
kind = "viscous-spring"
faces = ["left", "right", "front", "back", "bottom"]

[time]
duration = 20

[[output.history]]
name = "crown"
at = [0, 0, -60]
"#;

fn read(text: &str) -> Result<FileScene, Error> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/test.toml");
    FileScene::from_toml(text, path, &Registry::default())
}

/// Fault of the sound scene with one passage replaced. `new` has a `§` at the expected position of the fault.
fn fault(old: &str, new: &str) -> Box<SceneFault> {
    fault_of(SOUND, old, new)
}

fn fault_of(sound: &str, old: &str, new: &str) -> Box<SceneFault> {
    assert!(sound.contains(old), "{old}");
    let marked = sound.replacen(old, new, 1);
    let (before, after) = marked.split_once('§').expect("a marked place");
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap().chars().count() + 1;
    match read(&format!("{before}{after}")) {
        Err(Error::Scene(fault)) => {
            assert_eq!(fault.position(), (line, column), "{new}: {fault}");
            fault
        }
        Err(other) => panic!("{new}: {other}"),
        Ok(_) => panic!("{new} was accepted"),
    }
}

/// Every scene of the following tests differs from one that is accepted.
#[test]
fn the_sound_scene_is_accepted() {
    let scene = read(SOUND).unwrap();
    assert_eq!(scene.parts().len(), 2);
    assert!(scene.field().is_some());
    // The record and its format.
    assert_eq!(scene.remarks().len(), 2);
}

/// A fault is reported with line, column and message.
#[test]
fn every_fault_has_its_place() {
    for (old, new, message) in [
        // Syntax.
        ("[mesh]", "[mesh§", "unclosed table"),
        // Keys that do not exist: at the top, in a section, in an open table, in a tagged one.
        ("title", "§titel", "unknown key 'titel'"),
        ("cut =", "§cutt =", "unknown key 'cutt'"),
        ("density =", "§densty =", "unknown key 'densty'"),
        (
            "faces =",
            "§distanze = 3\nfaces =",
            "unknown key 'distanze'",
        ),
        ("order =", "§ordre =", "unknown key 'ordre'"),
        // Keys that are missing.
        (
            "[time]\nduration = 20",
            "§[time]",
            "the key 'duration' is missing",
        ),
        (
            "{ kind = \"velocity-polynomial\", ",
            "§{ ",
            "the key 'kind' is missing",
        ),
        // Values of a wrong type.
        (
            "peak = 1.7",
            "peak = §\"1.7\"",
            "found the text \"1.7\", expected a number above 0",
        ),
        ("name = \"rock\"", "name = §3", "expected a text in quotes"),
        ("[0, 0, -60]", "§[0, 0]", "expected a list of length 3"),
        (
            "{ kind = \"velocity-polynomial\", order = 5 }",
            "§\"mean\"",
            "expected a table with the key 'kind'",
        ),
        // Impossible values.
        (
            "poisson = 0.27",
            "poisson = §0.5",
            "expected a number above -1 and below 0.5",
        ),
        (
            "young = 9.0e9",
            "young = §-9.0e9",
            "expected a number above 0",
        ),
        (
            "density = 2750",
            "density = §nan",
            "expected a number above 0",
        ),
        (
            "incidence = 30",
            "incidence = §300",
            "expected an angle of 0 to 180 degrees",
        ),
        (
            "duration = 20",
            "duration = 20\nstep = §0",
            "expected \"auto\" or a number of seconds above 0",
        ),
        (
            "{ kind = \"velocity-polynomial\", order = 5 }",
            "§{ kind = \"velocity-polynomial\", order = 50 }",
            "order = 50 is outside",
        ),
        (
            "cut = [0, 20]",
            "cut = §[0, 200]",
            "a cut that ends at 200 s, expected at most 31.18 s, the end of the record",
        ),
        (
            "kind = \"sv\"",
            "kind = §\"sx\"",
            "'sx' is not permitted here",
        ),
        // Names that are not defined.
        (
            "set = \"lining\"",
            "set = §\"linig\"",
            "there is no element set 'linig'",
        ),
        (
            "\"left\", \"right\"",
            "\"left\", §\"rigth\"",
            "there is no facet set 'rigth'",
        ),
        (
            "material = \"rock\"",
            "material = §\"rok\"",
            "there is no material 'rok'",
        ),
        (
            "law = \"elastic\"",
            "law = §\"elastik\"",
            "there is no law 'elastik'",
        ),
        (
            "kernel = \"hex8-full\"",
            "kernel = §\"hex20\"",
            "there is no kernel 'hex20'",
        ),
        (
            "kind = \"viscous-spring\"",
            "kind = §\"springs\"",
            "there is no boundary 'springs'",
        ),
        (
            "record = \"el-centro\"",
            "record = §\"kobe\"",
            "there is no record 'kobe'",
        ),
        (
            "\"../meshes/cavern_small.msh\"",
            "§\"nothing.msh\"",
            "nothing.msh",
        ),
        (
            "\"../records/el_centro_1940_ns.csv\"",
            "§\"nothing.csv\"",
            "nothing.csv",
        ),
        // Errors of other crates.
        (
            "kind = \"sv\"\nincidence = 30",
            "kind = \"p\"\nincidence = §90",
            "P incidence of 90 degrees is above 89",
        ),
        (
            "name = \"el-centro\"",
            "name = §\"el-centro\"\nend_displacement = 1",
            "end displacement",
        ),
        (
            "convention = \"incident\"",
            "convention = §\"surface-y\"",
            "the surface moves by 0.0000",
        ),
        ("[0, 0, -60]", "§[0, 0, -70]", "lies in no element"),
        // Inconsistent keys.
        (
            "30\nrecord = \"el-centro\"",
            "§30",
            "exactly one of record, pulse",
        ),
        (
            "\"crown\"",
            "§\"crown\"\nset = \"top\"",
            "exactly one of at, node, set",
        ),
        ("set = \"lining\"", "set = §\"rock\"", "belongs to 2 parts"),
    ] {
        let told = fault(old, new).to_string();
        assert!(told.contains(message), "{new}: {told}");
        assert!(told.contains("data/scenes/test.toml:"), "{told}");
    }
}

/// A graphics processor is refused by a program that was compiled without it, with the place of the key; with it the balance of
/// energies is refused where the scene asks for it, and otherwise left out with a warning.
#[test]
fn an_engine_is_there_or_refused() {
    let (title, [cpu, gpu]) = (
        r#"title = "test""#,
        ["cpu", "gpu"].map(|name| format!("title = \"test\"\nengine = §\"{name}\"")),
    );
    assert!(read(&SOUND.replacen(title, &cpu.replace('§', ""), 1)).is_ok());
    if cfg!(feature = "gpu") {
        let scene = read(&SOUND.replacen(title, &gpu.replace('§', ""), 1)).unwrap();
        assert!(!scene.engine().balances_energy());
        let with_limit = format!("{gpu}\nenergy_residual = 1e-6");
        let message = fault(title, &with_limit).to_string();
        assert!(message.contains("energy_residual"), "{message}");
    } else {
        let message = fault(title, &gpu).to_string();
        assert!(message.contains("--features gpu"), "{message}");
    }
}

/// Input that would be ignored, or cannot be computed, is an error with its position.
#[test]
fn nothing_is_taken_and_ignored() {
    let history = "[[output.history]]\nname = \"crown\"\nat = [0, 0, -60]\n";
    for (old, new, message) in [
        (
            "[0, 0, -60]\n",
            "[0, 0, -60]\nquantities = §[]\n",
            "found an empty list",
        ),
        (
            "at = [0, 0, -60]\n",
            "set = \"top\"\nquantities = [\"velocity\", §\"stress\"]\n",
            "found stress or state at a node or set",
        ),
        (
            "at = [0, 0, -60]\n",
            "element = 2400\nquantities = [§\"velocity\"]\n",
            "found motion of an element",
        ),
        (
            "at = [0, 0, -60]\n",
            "element = §1000000\n",
            "no element '1000000'",
        ),
        (
            "at = [0, 0, -60]\n",
            "node = §1000000\n",
            "no node '1000000'",
        ),
        (
            "at = [0, 0, -60]\n",
            "set = \"top\"\nwithin = §0.1\n",
            "the key 'at' is missing",
        ),
        (
            "\"crown\"",
            "§\"crown\"\nelement = 2400",
            "exactly one of at, node, set, element",
        ),
        (
            history,
            "[[output.relative]]\nname = §\"a\"\nat = [0, 0, -60]\n",
            "exactly one of from, from_node, from_set",
        ),
        (
            history,
            "[output.envelope]\nquantities = §[]\n",
            "found an empty list",
        ),
        ("cut = [0, 20]", "taper = §1", "the key 'cut' is missing"),
        (
            "kernel = \"hex8-full\"",
            "kernel = §\"wedge6\"",
            "the kernel 'wedge6' is not for any element",
        ),
        (
            "file = \"../records",
            "length = §\"cut\"\nfile = \"../records",
            "the key 'components' is missing",
        ),
        (
            "name = \"el-centro\"\n",
            "name = §\"el-centro\"\ncomponents = { x = \"a\" }\n",
            "exactly one of file, components",
        ),
        (
            "record = \"el-centro\"",
            "record = \"el-centro\"\ncomponent = §\"x\"",
            "there is no record 'el-centro.x'",
        ),
        (
            "title",
            "threads = §0\ntitle",
            "expected a whole number above 0",
        ),
        (
            "[time]",
            "[[support]]\nkind = \"roller\"\nset = \"left\"\nnormal = §[0, 0, 0]\n[time]",
            "expected a direction",
        ),
        (
            "[time]",
            "[[support]]\nkind = \"roller\"\nset = §\"intrados\"\n[time]",
            "found facets with different normals",
        ),
        (
            "[time]",
            "[[support]]\nkind = \"prescribed\"\nset = \"left\"\ndisplacement = 1\ndirection = §[0, 0, 0]\n[time]",
            "expected a direction",
        ),
        (
            "[time]",
            "§[[support]]\nkind = \"prescribed\"\nset = \"left\"\ndirection = [1, 0, 0]\n[time]",
            "exactly one of displacement, record",
        ),
    ] {
        let told = fault(old, new).to_string();
        assert!(told.contains(message), "{new}: {told}");
    }
    let wave = "[[wave]]\nkind = \"sv\"\nincidence = 30\nrecord = \"el-centro\"\n";
    let still = SOUND.replace(wave, "");
    let told = fault_of(
        &still,
        "duration = 20",
        "duration = 20\ninitial = §\"field\"",
    );
    assert!(told.to_string().contains("no field"), "{told}");
}

/// The initial state of a joint is checked against its law and pairs, each fault at its key.
#[test]
fn starts_of_joints_have_their_place() {
    let joint = "[[joint]]\nname = \"bond\"\nbetween = [\"rock\", \"lining\"]\nlaw = \"bonded-coulomb\"\ncohesion = 1e6\ntensile_strength = 5e5\nstatic_friction = 0.8\n[time]";
    let bonded = SOUND.replace("[time]", joint);
    assert_eq!(read(&bonded).unwrap().joints().count(), 1);
    let rubbing = bonded.replace("cohesion = 1e6\ntensile_strength = 5e5\n", "");
    for (sound, keys, message) in [
        // Preloads: the kinds, their keys, what the law does not admit, NaN.
        (
            &bonded,
            "preload = §3e5",
            "expected a table with the key 'kind'",
        ),
        (
            &bonded,
            "preload = { kind = §\"weight\" }",
            "'weight' is not permitted here",
        ),
        (
            &bonded,
            "preload = { kind = \"pressure\", §depth = 3 }",
            "unknown key 'depth'",
        ),
        (
            &bonded,
            "preload = { kind = \"pressure\", pressure = §nan }",
            "expected a finite number",
        ),
        (
            &bonded,
            "preload = { kind = \"traction\", traction = §[0, 1e5] }",
            "expected a list of length 3",
        ),
        (
            &bonded,
            "preload = { kind = \"ground\", level = 0, density = §0, lateral = 0.5 }",
            "expected a number above 0",
        ),
        (
            &bonded,
            "preload = { kind = \"ground\", level = 0, density = 2700, lateral = §-1 }",
            "expected a number of 0 or above",
        ),
        (
            &bonded,
            "preload = §{ kind = \"pressure\", pressure = -6e5 }",
            "6.0000e5 Pa across the joint",
        ),
        (
            &rubbing,
            "preload = §{ kind = \"stress\", stress = [-1e6, -1e6, -2e7, 0, 0, 0] }",
            "does not admit the initial traction",
        ),
        (
            &rubbing,
            "gap = 0.01\npreload = §{ kind = \"pressure\", pressure = 1e5 }",
            "a pair with a gap has none",
        ),
        // Gaps: no negative ones, none of a bond.
        (
            &rubbing,
            "gap = §-0.01",
            "expected \"meshed\" or a number of 0 or above",
        ),
        (
            &rubbing,
            "gap = §\"wide\"",
            "expected \"meshed\" or a number of 0 or above",
        ),
        (
            &bonded,
            "gap = 0.01\nunbonded = [§{ set = \"rock\" }]",
            "has no bond",
        ),
        // Zones: exactly one key, names that exist, at least one pair with a bond.
        (&bonded, "unbonded = §3", "expected a list"),
        (
            &bonded,
            "unbonded = [§{}]",
            "exactly one of at, node, set, low",
        ),
        (
            &bonded,
            "unbonded = [§{ set = \"rock\", node = 3 }]",
            "exactly one of at, node, set, low",
        ),
        (
            &bonded,
            "unbonded = [§{ low = [0, 0, 0] }]",
            "the key 'high' is missing",
        ),
        (
            &bonded,
            "unbonded = [{ set = \"rock\", within = §1 }]",
            "the key 'at' is missing",
        ),
        (
            &bonded,
            "unbonded = [{ set = §\"rok\" }]",
            "no node, facet or element set 'rok'",
        ),
        (
            &bonded,
            "unbonded = [{ node = §1000000 }]",
            "no node '1000000'",
        ),
        (
            &bonded,
            "unbonded = [{ set = \"lining\" }, §{ set = \"top\" }]",
            "joint 'bond' has no node pair in set 'top'",
        ),
        (
            &bonded,
            "unbonded = [§{ at = [0, 0, -60] }]",
            "the nearest is 1.5",
        ),
        (
            &bonded,
            "unbonded = [§{ low = [1, 1, 1], high = [2, 2, 2] }]",
            "no node pair in the box from (1, 1, 1) m to (2, 2, 2) m",
        ),
        (
            &rubbing,
            "unbonded = [§{ set = \"lining\" }]",
            "has no bond",
        ),
    ] {
        let told = fault_of(sound, "law = \"bonded", &format!("{keys}\nlaw = \"bonded"));
        let told = told.to_string();
        assert!(told.contains(message), "{keys}: {told}");
    }
    let tied = bonded.replace(
        "bonded-coulomb\"\ncohesion = 1e6\ntensile_strength = 5e5\nstatic_friction = 0.8",
        "tied\"",
    );
    for keys in ["gap = §0.01", "unbonded = [§{ set = \"lining\" }]"] {
        let told = fault_of(&tied, "law = \"tied", &format!("{keys}\nlaw = \"tied"));
        assert!(told.to_string().contains("joint 'bond', nodes "), "{told}");
    }
}

/// Histories of joints name a joint, pairs of it and quantities, each fault at its key.
#[test]
fn histories_of_joints_have_their_place() {
    let joint =
        "[[joint]]\nname = \"bond\"\nbetween = [\"rock\", \"lining\"]\nlaw = \"tied\"\n[time]";
    let sound = SOUND.replace("[time]", joint);
    let sound = format!("{sound}[[output.joint]]\nname = \"j\"\njoint = \"bond\"\n");
    assert_eq!(read(&sound).unwrap().output().joints.len(), 1);
    for (old, new, message) in [
        (
            "joint = \"bond\"",
            "joint = §\"bold\"",
            "there is no joint 'bold'",
        ),
        (
            "[[output.joint]]\nname = \"j\"\njoint = \"bond\"",
            "§[[output.joint]]\nname = \"j\"",
            "the key 'joint' is missing",
        ),
        ("\"j\"", "§\"crown\"", "the result 'crown' is defined twice"),
        ("\"j\"", "§\"bond\"", "the result 'bond' is defined twice"),
        (
            "joint = \"bond\"",
            "joint = \"bond\"\nquantities = §[]",
            "found an empty list",
        ),
        (
            "joint = \"bond\"",
            "joint = \"bond\"\nquantities = [\"slip\", §\"stress\"]",
            "'stress' is not permitted here",
        ),
        (
            "\"j\"",
            "§\"j\"\nnode = 3\nset = \"lining\"",
            "exactly one of at, node, set, low",
        ),
        (
            "\"j\"",
            "§\"j\"\nset = \"top\"",
            "joint 'bond' has no node pair in set 'top'",
        ),
        (
            "\"j\"",
            "\"j\"\nset = §\"topp\"",
            "no node, facet or element set 'topp'",
        ),
        ("\"j\"", "\"j\"\nnode = §1000000", "no node '1000000'"),
        ("\"j\"", "\"j\"\nwithin = §1", "the key 'at' is missing"),
        ("\"j\"", "§\"j\"\nat = [0, 0, -60]", "the nearest is 1.5"),
        ("\"j\"", "\"j\"\n§depth = 1", "unknown key 'depth'"),
    ] {
        // The last table: its text occurs also above.
        let start = sound.find("[[output.joint]]").unwrap();
        let (head, tail) = sound.split_at(start);
        assert!(tail.contains(old), "{old}");
        let changed = tail.replacen(old, new, 1);
        let told = fault_of(&format!("{head}{tail}"), tail, &changed).to_string();
        assert!(told.contains(message), "{new}: {told}");
    }
}

/// The free field has one medium: absorbing faces on rock and concrete are an error.
#[test]
fn a_field_has_one_medium() {
    let two = SOUND.replace(
        "set = \"lining\"\nmaterial = \"rock\"",
        "set = \"lining\"\nmaterial = \"concrete\"",
    ) + "[[material]]\nname = \"concrete\"\nlaw = \"elastic\"\nyoung = 25e9\npoisson = 0.17\ndensity = 2500\n";
    let fault = fault_of(&two, "[\"left\"", "[§\"intrados\", \"left\"");
    assert!(
        matches!(fault.problem(), Problem::SeveralMedia { count: 2, .. }),
        "{fault}"
    );
    // The message contains media, faces and remedies.
    let shown = fault.render(false);
    assert!(
        shown.contains("'rock' (left, right, front, back, bottom), 'lining' (intrados)"),
        "{shown}"
    );
    assert!(
        shown.contains("rollers") && shown.contains("`slice`"),
        "{shown}"
    );
}

/// The message contains the line, marks the position, lists permitted values and suggests the nearest one.
#[test]
fn a_fault_is_shown_with_its_line_and_the_nearest_name() {
    let shown = fault("set = \"lining\"", "set = §\"linig\"").render(false);
    let lines: Vec<&str> = shown.lines().collect();
    assert_eq!(lines[0], "error: there is no element set 'linig'");
    assert!(lines[1].ends_with("data/scenes/test.toml:18:7"), "{shown}");
    assert_eq!(lines[3], "18 | set = \"linig\"");
    assert_eq!(lines[4], "   |       ^^^^^^^");
    assert!(shown.contains("did you mean 'lining'?"), "{shown}");
    assert!(shown.contains("available: lining, rock"), "{shown}");
    assert!(!shown.contains('\u{1b}'));
    assert!(fault("title", "§titel").render(true).contains('\u{1b}'));
    // Far from every name nothing is suggested.
    assert!(
        !fault("set = \"lining\"", "set = §\"x\"")
            .render(false)
            .contains("mean")
    );
    let shown = fault(
        "kind = \"sv\"\nincidence = 30",
        "kind = \"p\"\nincidence = §90",
    )
    .render(false);
    assert!(shown.contains("space = \"full-space\""), "{shown}");
}

/// A step above the stable one, and springs without a distance, are found only when the model is built, but also reported
/// with their position.
#[test]
fn what_the_model_refuses_has_a_place_too() {
    let step = SOUND.replace("duration = 20", "duration = 20\nstep = 0.01");
    let mut simulation = read(&step).unwrap().prepare().unwrap();
    let error = simulation.step().unwrap_err().to_string();
    assert!(
        error.contains("test.toml:42:8: a step of 1.000000e-2 s"),
        "{error}"
    );
    for (old, new, message) in [
        (
            "duration = 20",
            "duration = 20\nscheme = §\"one-sided\"",
            "needs stiffness damping",
        ),
        (
            "duration = 20",
            "duration = 20\nstep = 1e-5\nscheme = §\"one-sided\"",
            "needs stiffness damping",
        ),
        (
            "[[output.history]]",
            "[[output.section]]\nname = \"a\"\nset = \"lining\"\nat = §[0, 0, -5]\nnormal = [0, 0, 1]\nalong = [1, 0, 0]\n[[output.history]]",
            "intersects none of its elements",
        ),
        (
            "[[output.history]]",
            "[[output.section]]\nname = \"a\"\nset = \"lining\"\nat = §[0, 0, -60]\nnormal = [1, 0, 0]\nalong = [2, 0, 0]\n[[output.history]]",
            "gives no direction",
        ),
        (
            "[time]",
            "[[support]]\nkind = \"fixed\"\nset = \"left\"\n[[support]]\nkind = \"prescribed\"\nset = \"left\"\ndisplacement = 1\ndirection = §[1, 0, 0]\n[time]",
            "already fixed or prescribed",
        ),
    ] {
        let (before, after) = new.split_once('§').unwrap();
        let marked = SOUND.replacen(old, new, 1);
        let start = marked.find('§').unwrap();
        let (line, column) = (
            marked[..start].matches('\n').count() + 1,
            marked[..start].rsplit('\n').next().unwrap().len() + 1,
        );
        let text = SOUND.replacen(old, &format!("{before}{after}"), 1);
        let prepared = read(&text).unwrap().prepare();
        let error = prepared.and_then(|mut simulation| simulation.step());
        let Err(Error::Scene(fault)) = error else {
            panic!("{new}: {error:?}")
        };
        assert!(fault.to_string().contains(message), "{new}: {fault}");
        assert_eq!(fault.position(), (line, column), "{new}");
    }
    let behind = SOUND.replace("[time]", "scatterer = [0, 0, -150]\n[time]");
    let Err(error) = read(&behind).unwrap().prepare() else {
        panic!("a scatterer on a face was accepted")
    };
    let error = error.to_string();
    assert!(
        error.contains("test.toml:37:8: boundary: face 'bottom'"),
        "{error}"
    );
}

/// Several faults give one message, and so does text that is not a scene.
#[test]
fn any_text_gives_one_fault() {
    for text in [
        "",
        "\u{feff}",
        "title = 1",
        "a = [",
        "[[mesh]]",
        "material = 3",
        "[boundary]\nkind = 1",
        "title = \"\\q\"",
        "\r\n",
    ] {
        match read(text) {
            Err(Error::Scene(fault)) => assert!(!fault.render(false).is_empty()),
            other => panic!("{text:?}: {:?}", other.err()),
        }
    }
    let cut: Vec<usize> = (0..SOUND.len()).step_by(7).collect();
    for end in cut {
        if let Err(error) = read(&SOUND[..end]) {
            assert!(matches!(error, Error::Scene(_)), "{error}");
        }
    }
}

/// A case that names another kind of boundary drops the keys of the old kind, and keeps those that every kind has.
#[test]
fn a_case_may_name_another_kind_of_boundary() {
    let faces = r#"faces = ["left", "right", "front", "back", "bottom"]"#;
    let more = format!("{faces}\nspreading = \"cylindrical\"\nscatterer = [0, 0, -70]");
    for (kind, keys) in [
        ("viscous", ""),
        ("viscous-spring", ", scatterer = [1, 0, -70]"),
    ] {
        let case =
            format!("[[case]]\nname = \"other\"\nboundary = {{ kind = \"{kind}\"{keys} }}\n");
        let text = format!("{}\n{case}", SOUND.replace(faces, &more));
        read(&text).unwrap();
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/test.toml");
        let file = SceneFile::parse(text, path).unwrap();
        FileScene::of_case(&file, Some("other"), &Registry::default()).unwrap();
        let boundary = file.spec(Some("other")).unwrap().boundary.unwrap();
        assert_eq!((boundary.kind.as_str(), boundary.faces.len()), (kind, 5));
        let x = boundary.scatterer.unwrap()[0].get();
        assert_eq!(x, if keys.is_empty() { 0.0 } else { 1.0 });
        // The same kind keeps its keys.
        let spreads = format!("{:?}", boundary.parameters).contains("cylindrical");
        assert_eq!(spreads, kind == "viscous-spring");
    }
}

/// A fault of a case names the case, wherever it is found; one of the scene itself names none.
#[test]
fn faults_of_cases_name_the_case() {
    let registry = Registry::default();
    for (keys, word) in [
        (
            "boundary = { kind = \"viscous\", spreading = \"cylindrical\" }",
            "spreading",
        ),
        ("boundary = { kind = \"sponge\" }", "sponge"),
        ("material = [{ name = \"rock\", poisson = 0.7 }]", "0.7"),
        (
            "material = [{ name = \"rock\", cohesion = 1e6 }]",
            "cohesion",
        ),
        ("part = [{ set = \"rock\", material = \"salt\" }]", "salt"),
        ("record = [{ name = \"el-centro\", cut = [30, 20] }]", "20"),
        ("time = { durations = 3 }", "durations"),
    ] {
        let text = format!("{SOUND}\n[[case]]\nname = \"changed\"\n{keys}\n");
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/test.toml");
        let read = FileScene::case_from_toml(&text, path, "changed", &registry);
        let error = read.err().unwrap();
        let message = error.to_string();
        assert!(
            message.contains("in the case 'changed': "),
            "{keys}: {message}"
        );
        assert!(message.contains(word), "{keys}: {message}");
        let Error::Scene(fault) = error else {
            panic!("{message}")
        };
        assert_eq!(fault.case(), Some("changed"));
        assert!(fault.render(false).contains("in the case 'changed': "));
        let line = text.lines().position(|line| line == keys).unwrap() + 1;
        assert_eq!(fault.position().0, line, "{keys}");
    }
    let own = read(&SOUND.replace("poisson = 0.27", "poisson = 0.7"))
        .err()
        .unwrap();
    assert!(!own.to_string().contains("case"), "{own}");
}
