//! Joints: equivalence of file and Rust, errors, and result files.

use powerhouse::contact::{BondedCoulomb, BondedCoulombParameters, JointSurface, SurfaceOptions};
use powerhouse::io::write_gmsh;
use powerhouse::model::{JointRecord, Mesh};
use powerhouse::{
    Error, FileScene, Registry, Remark, ResultFolder, RunNotes, Scene, SceneJoint, remark,
};

use super::support::*;

/// The cube in two parts, one on the other.
pub(crate) fn halves() -> Mesh {
    let mut mesh = cube();
    for (name, above) in [("lower", false), ("upper", true)] {
        let inside = |&e: &u32| (mesh.centroid(e).z > -150.0) == above;
        let elements = (0..mesh.element_count() as u32).filter(inside).collect();
        mesh.set_element_set(name, elements).unwrap();
    }
    mesh
}

pub(crate) const JOINT: &str = r#"
[[part]]
set = "lower"
material = "granite"
kernel = "hex8-full"
[[part]]
set = "upper"
material = "granite"
kernel = "hex8-full"
[[joint]]
name = "bedding"
between = ["lower", "upper"]
law = "bonded-coulomb"
cohesion = 2e4
tensile_strength = 1e4
static_friction = 0.7
dynamic_friction = 0.5
"#;

pub(crate) const PART: &str =
    "[[part]]\nset = \"rock\"\nmaterial = \"granite\"\nkernel = \"hex8-full\"\n";

pub(crate) fn read(folder: &Folder, joint: &str) -> Result<Scene, Error> {
    assert!(CUBE.contains(PART));
    let text = CUBE.replacen(PART, joint, 1);
    FileScene::from_toml(text, folder.join("cube.toml"), &Registry::default())
        .map(FileScene::into_scene)
}

pub(crate) fn folder(name: &str) -> Folder {
    let folder = Folder::new(name);
    write_gmsh(folder.join("cube.msh"), &halves()).unwrap();
    folder
}

/// The cut mesh and the joint of [`JOINT`], composed in Rust.
pub(crate) fn twin(mesh: &Mesh) -> (Mesh, SceneJoint) {
    let set = |name: &str| mesh.element_set(name).unwrap();
    let split = mesh.split_between(set("lower"), set("upper")).unwrap();
    let options = SurfaceOptions::within(1e-3).unwrap();
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options);
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 2e4,
        tensile_strength: 1e4,
        static_friction: 0.7,
        dynamic_friction: 0.5,
        cohesion_loss: true,
    });
    let joint = SceneJoint::new("bedding", surface.unwrap(), law.unwrap());
    (split.mesh, joint)
}

/// A joint from a file equals the one composed in Rust: same bits, and it cracks and slips; its tables and facets are
/// written.
#[test]
fn a_joint_of_a_file_is_the_one_of_rust() {
    let folder = folder("joint");
    let (mesh, joint) = twin(&halves());
    let twin = cube_scene_of(mesh, &["lower", "upper"]).joint(joint);
    let scene = read(&folder, JOINT).unwrap();
    let mesh = scene.mesh().clone();
    let (file, twin) = (run(scene), run(twin));
    assert_eq!(file.histories(), twin.histories());
    assert_eq!(file.joint_histories(), twin.joint_histories());
    assert_eq!(file.joints, twin.joints);
    let last = |name: &str| {
        *file
            .joint_histories()
            .column(name)
            .unwrap()
            .values
            .last()
            .unwrap()
    };
    assert!(last("bedding.slip") > 1e-4 && last("bedding.peak_opening") > 1e-4);
    // The energy balance contains the dissipation of the pairs, each kind in its own column, except the step that begins
    // at the end; and it closes.
    let terms = file.energy_terms();
    for name in ["friction", "bond", "impact"] {
        let (_, energy) = terms.iter().find(|(term, _)| *term == name).unwrap();
        let of_pairs = last(&format!("bedding.{name}"));
        let open = (of_pairs - energy) / of_pairs;
        assert!(
            *energy > 0.0 && (-1e-12..1e-3).contains(&open),
            "{name}: {open}"
        );
    }
    let residual = file.energy_residual().unwrap();
    assert!(residual.largest < 1e-10 && residual.share_of_input.unwrap() < 1e-10);
    let [(name, share)] = file.slip_shares(&mesh)[..] else {
        panic!("one joint")
    };
    assert_eq!(name, "bedding");
    assert!((share - last("bedding.peak_opening").max(last("bedding.slip")) / 50.0).abs() < 1e-12);

    let results = ResultFolder::new(folder.join("results"));
    let written = results
        .write(("cube", &mesh), &file, &RunNotes::default(), None)
        .unwrap();
    for name in ["joints.csv", "joints/bedding.vtu"] {
        assert!(
            written.contains(&folder.join("results").join(name)),
            "{written:?}"
        );
    }
    let vtu = std::fs::read(folder.join("results/joints/bedding.vtu")).unwrap();
    let text = String::from_utf8_lossy(&vtu);
    assert!(
        text.contains(r#"NumberOfPoints="144" NumberOfCells="36""#),
        "{}",
        &text[..400]
    );
    assert!(text.contains("time of first slip"));
    results.clear().unwrap();
    assert!(!folder.join("results/joints/bedding.vtu").exists());
}

/// A fault of a joint is reported at its key: sets that do not exist or do not touch, both kinds of sides, an unknown law
/// or key, a parameter out of range, a repeated name.
#[test]
fn faults_of_joints_have_their_place() {
    let folder = folder("joint-faults");
    let twice = format!("{JOINT}{}", &JOINT[JOINT.find("[[joint]]").unwrap()..]);
    for (old, new, at) in [
        ("[\"lower\", \"upper\"]", "[\"lower\", \"lid\"]", "\"lid\""),
        (
            "[\"lower\", \"upper\"]",
            "[\"lower\", \"lower\"]",
            "[\"lower\", \"lower\"]",
        ),
        (
            "law =",
            "facets = [\"top\", \"bottom\"]\nlaw =",
            "\"bedding\"",
        ),
        ("between", "facets", "[\"lower\", \"upper\"]"),
        ("\"bonded-coulomb\"", "\"glue\"", "\"glue\""),
        ("cohesion =", "adhesion =", "adhesion"),
        ("dynamic_friction = 0.5", "dynamic_friction = 0.9", "0.9"),
        ("cohesion = 2e4", "cohesion = -2e4", "-2e4"),
        ("law =", "corner = 120\nlaw =", "120"),
        (JOINT, &twice, "\"bedding\""),
    ] {
        assert!(JOINT.contains(old), "{old}");
        let changed = JOINT.replacen(old, new, 1);
        let error = read(&folder, &changed).err().unwrap();
        let Error::Scene(fault) = &error else {
            panic!("{error}")
        };
        let text = CUBE.replacen(PART, &changed, 1);
        let line = text[..text.rfind(at).unwrap()].matches('\n').count() + 1;
        let message = fault.to_string();
        assert!(
            message.contains(&format!("cube.toml:{line}:")),
            "{new}: {line} {message}"
        );
    }
}

/// Every built-in contact law can be named in a scene, and the schema contains its keys.
#[test]
fn all_laws_of_joints_can_be_named() {
    let registry = Registry::default();
    let names: Vec<&str> = registry.joint_law_names().collect();
    let expected = [
        "bonded-coulomb",
        "cohesive",
        "frictionless",
        "paper",
        "slip-weakening",
        "tied",
    ];
    assert_eq!(names, expected);
    let schema = registry.schema().to_value().to_string();
    for key in [
        "slip_distance",
        "cohesion_loss",
        "between",
        "slip-weakening",
    ] {
        assert!(schema.contains(key), "{key}");
    }
    let folder = folder("joint-laws");
    let (start, end) = (JOINT.find("law = \"bonded").unwrap(), JOINT.len());
    for law in [
        "law = \"tied\"\n",
        "law = \"cohesive\"\ntensile_strength = 1e6\ncohesion = 2e6\nopening_energy = 100\nstatic_friction = 0.8\n",
        "law = \"frictionless\"\n",
        "law = \"paper\"\ncohesion = 1e6\ntensile_strength = 1e6\nstatic_friction = 0.8\n",
        "law = \"slip-weakening\"\nstatic_friction = 0.7\ndynamic_friction = 0.5\nslip_distance = 0.1\n",
    ] {
        let mut text = JOINT.to_owned();
        text.replace_range(start..end, law);
        let scene = read(&folder, &text).unwrap_or_else(|error| panic!("{law}: {error}"));
        let (name, surface, found) = scene.joints().next().unwrap();
        assert_eq!((name, surface.pairs.len()), ("bedding", 49));
        assert!(law.contains(&format!("\"{}\"", found.name())));
    }
}

/// Slip that is large compared with the edges of the joint has a warning after the run and in its summary; small slip has
/// none.
#[test]
fn large_slip_is_warned_of() {
    let folder = folder("joint-slip");
    let runs = |displacement: f64| {
        let text = CUBE.replacen(PART, JOINT, 1);
        // A wave of metres, so that the slip is large.
        let text = text.replacen("[mesh]", "allow = [\"magnitudes\"]\n[mesh]", 1);
        let text = text.replace(
            "displacement = 0.01",
            &format!("displacement = {displacement}"),
        );
        let path = folder.join("cube.toml");
        let scene = FileScene::from_toml(text, path, &Registry::default())
            .unwrap()
            .into_scene();
        let mesh = scene.mesh().clone();
        (run(scene), mesh)
    };
    let (small, mesh) = runs(0.01);
    assert_eq!(small.warnings(&mesh), []);
    let (large, mesh) = runs(20.0);
    let warnings = large.warnings(&mesh);
    let [Remark::LargeSlip(remark::LargeSlip { joint, share })] = &warnings[..] else {
        panic!("{warnings:?}")
    };
    assert_eq!((joint.as_str(), *share), large.slip_shares(&mesh)[0]);
    assert!(*share > 0.1 && warnings[0].is_warning());
}

/// A joint through periodic sides is infinite: bonded, the body moves as without it; where it fails, it slips
/// uniformly.
#[test]
fn a_joint_runs_through_periodic_sides() {
    let folder = folder("joint-endless");
    let endless = "[[support]]\nkind = \"periodic\"\nfrom = \"front\"\nto = \"back\"\n\
                   [[support]]\nkind = \"periodic\"\nfrom = \"left\"\nto = \"right\"\n[time]";
    let scene = |part: &str| -> Scene {
        let mut text = CUBE.to_owned();
        for (old, new) in [
            (PART, part),
            ("incidence = 20", "incidence = 0"),
            (
                r#"["left", "right", "front", "back", "bottom"]"#,
                r#"["bottom"]"#,
            ),
            ("[time]", endless),
            ("duration = 0.6", "duration = 0.6\nstep = 0.005"),
        ] {
            assert!(text.contains(old), "{old}");
            text = text.replacen(old, new, 1);
        }
        FileScene::from_toml(text, folder.join("cube.toml"), &Registry::default())
            .unwrap()
            .into_scene()
    };
    let whole = run(scene(PART));
    let strong = JOINT.replace("cohesion = 2e4", "cohesion = 1e9");
    let bonded = run(scene(
        &strong.replace("tensile_strength = 1e4", "tensile_strength = 1e9"),
    ));
    let columns = whole
        .histories()
        .columns
        .iter()
        .zip(&bonded.histories().columns);
    for (whole, bonded) in columns {
        let scale = whole
            .values
            .iter()
            .fold(0.0_f64, |most, u| most.max(u.abs()));
        for (a, b) in whole.values.iter().zip(&bonded.values) {
            assert!(
                (a - b).abs() <= 1e-9 * scale + 1e-12,
                "{}: {a} {b}",
                whole.name
            );
        }
    }

    // Under pressure, or rounding would open some pairs, which do not slip then.
    let pressed = "preload = { kind = \"pressure\", pressure = 1e4 }\n";
    let slipping = run(scene(&format!("{JOINT}{pressed}")));
    // Of 7 x 7 pairs, the last row and column go with the first.
    let surface = &slipping.joint_surfaces[0];
    assert_eq!((surface.pairs.len(), surface.facets.len()), (36, 36));
    let equal = |area: f64| (area / 2500.0 - 1.0).abs() < 1e-12;
    assert!(surface.pairs.iter().all(|pair| equal(pair.area)));
    let slip = |record: &JointRecord| record.state.slip;
    let slips: Vec<f64> = slipping.joints[0].records.iter().map(slip).collect();
    let least = slips.iter().copied().fold(f64::INFINITY, f64::min);
    let most = slips.iter().copied().fold(0.0, f64::max);
    assert!(
        least > 1e-4 && most - least <= 1e-9 * most,
        "{least} {most}"
    );
}

/// The energy in shear is ten times that in opening, and dynamic friction the static one, where their keys are not given.
#[test]
fn keys_that_are_not_given_follow_from_others() {
    let folder = folder("joint-derived");
    let (start, end) = (JOINT.find("law = \"bonded").unwrap(), JOINT.len());
    let energies = |keys: &str| {
        let mut text = JOINT.to_owned();
        let law = "law = \"cohesive\"\ntensile_strength = 2e4\ncohesion = 3e4\nopening_energy = 2\nstatic_friction = 0.7\n";
        text.replace_range(start..end, &format!("{law}{keys}"));
        run(read(&folder, &text).unwrap()).energies().clone()
    };
    let derived = energies("");
    assert_eq!(
        derived,
        energies("shear_energy = 20\ndynamic_friction = 0.7\n")
    );
    assert_ne!(derived, energies("shear_energy = 30\n"));
    assert_ne!(derived, energies("dynamic_friction = 0.4\n"));
}

/// A bond with fracture energies fails under a wave: what it dissipates is in the column of bonds and between the energies in
/// opening and in shear of the area that has failed, the balance closes, and the strength that the coarse mesh does not
/// resolve is reduced with a warning. The number of threads changes no bit.
#[test]
fn a_bond_with_fracture_energies_fails_gradually() {
    let folder = folder("joint-cohesive");
    let (start, end) = (JOINT.find("law = \"bonded").unwrap(), JOINT.len());
    let with = |keys: &str, threads: usize| {
        let mut text = JOINT.to_owned();
        let law = "law = \"cohesive\"\ntensile_strength = 2e4\ncohesion = 3e4\nopening_energy = 5\n\
                   shear_energy = 20\nstatic_friction = 0.7\ndynamic_friction = 0.5\n";
        text.replace_range(start..end, &format!("{law}{keys}"));
        run(read(&folder, &text).unwrap().with_threads(threads))
    };
    let results = with("", 1);
    let joint = &results.joint_outcomes[0];
    assert!(joint.bond > 0.0 && joint.broken > 0.05, "{joint:?}");
    let failed = joint.broken * joint.area;
    assert!(joint.bond >= 5.0 * failed * (1.0 - 1e-9), "{joint:?}");
    assert!(joint.bond <= 20.0 * joint.area, "{joint:?}");
    let ledger = results
        .energies()
        .columns
        .iter()
        .find(|column| column.name == "bond");
    let ledger = *ledger.unwrap().values.last().unwrap();
    assert!(
        (ledger / joint.bond - 1.0).abs() < 1e-6,
        "{ledger} {}",
        joint.bond
    );
    let residual = results.energy_residual().unwrap().largest;
    assert!(residual < 1e-9, "{residual}");
    let again = with("", 3);
    assert_eq!(again.joint_outcomes, results.joint_outcomes);
    assert_eq!(again.energies(), results.energies());

    let brittle = |keys: &str| {
        let mut text = JOINT.to_owned();
        let law = "law = \"cohesive\"\ntensile_strength = 2e6\ncohesion = 3e6\nopening_energy = 5\nstatic_friction = 0.7\n";
        text.replace_range(start..end, &format!("{law}{keys}"));
        read(&folder, &text).unwrap().prepare().unwrap()
    };
    let reduced = |simulation: &powerhouse::Simulation| {
        let remarks = simulation.remarks().iter();
        let found = remarks.filter_map(|remark| match remark {
            Remark::ReducedStrength(remark::ReducedStrength {
                factor, area, of, ..
            }) => Some((*factor, *area, *of)),
            _ => None,
        });
        found.collect::<Vec<_>>()
    };
    let [(factor, area, of)] = reduced(&brittle(""))[..] else {
        panic!("{:?}", brittle("").remarks());
    };
    assert!(
        (0.001..0.1).contains(&factor) && (area - of).abs() < 1e-6 * of,
        "{factor} {area} {of}"
    );
    assert_eq!(reduced(&brittle("reduce = false\n")), []);
}

/// A joint that slides beside undamped parts is warned of, with the share of the stable step for great coefficients; none with
/// stiffness damping on both sides, or with little friction.
#[test]
fn undamped_parts_beside_friction_are_warned_of() {
    let folder = folder("flutter");
    let warnings = |friction: &str, damping: [&str; 2]| {
        let text = JOINT
            .replace(
                "static_friction = 0.7",
                &format!("static_friction = {friction}"),
            )
            .replace(
                "dynamic_friction = 0.5",
                &format!("dynamic_friction = {friction}"),
            );
        let parts = ["lower", "upper"].into_iter().zip(damping);
        let text = parts.fold(text, |text, (set, damping)| {
            let part = format!("[[part]]\nset = \"{set}\"\n");
            text.replace(&part, &format!("{part}{damping}"))
        });
        let simulation = read(&folder, &text).unwrap().prepare().unwrap();
        let remarks = simulation.remarks().iter();
        let texts = remarks.filter(|remark| matches!(remark, Remark::UndampedFriction(_)));
        texts.map(|remark| remark.to_string()).collect::<Vec<_>>()
    };
    let damped = "damping = { kind = \"rayleigh\", ratio = 0.05, frequencies = [1, 20] }\nelastic_rim = 10\n";
    let none = warnings("0.2", [""; 2]);
    assert!(none.is_empty(), "{none:?}");
    let [both] = &warnings("0.5", [""; 2])[..] else {
        panic!("one joint")
    };
    assert!(
        both.contains("'bedding'") && both.contains("(lower, upper)") && !both.contains("safety"),
        "{both}"
    );
    let [oblique] = &warnings("1", ["", damped])[..] else {
        panic!("one joint")
    };
    assert!(
        oblique.contains("(lower)") && oblique.contains("safety = 0.93"),
        "{oblique}"
    );
    let none = warnings("1", [damped; 2]);
    assert!(none.is_empty(), "{none:?}");
}
