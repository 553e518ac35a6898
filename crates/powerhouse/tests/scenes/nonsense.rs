//! Implausible values in well-formed scenes are errors with their position, or warnings with the name of the item.

use std::fs;

use powerhouse::boundary::{Viscous, ViscousSpring};
use powerhouse::engine::Support;
use powerhouse::io::write_gmsh;
use powerhouse::material::LinearElastic;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{
    Boundary, Error, FileScene, Material, Part, Problem, Registry, Remark, RenderFault as _, Scene,
    SceneFault, SceneStage, remark,
};

use super::support::*;

/// Fault of the cube's scene with a passage replaced.
pub(crate) fn fault(variants: &Variants, old: &str, new: &str) -> Box<SceneFault> {
    match variants.read(old, new) {
        Err(Error::Scene(fault)) => fault,
        Err(other) => panic!("{new}: {other}"),
        Ok(_) => panic!("{new} was accepted"),
    }
}

fn warnings(remarks: &[Remark]) -> Vec<Remark> {
    let warnings = remarks.iter().filter(|remark| remark.is_warning());
    warnings.cloned().collect()
}

pub(crate) fn warnings_of(scene: impl Into<FileScene>) -> Vec<Remark> {
    warnings(scene.into().prepare().unwrap().remarks())
}

/// A name that is repeated in any list of names of a scene is an error at its second position, and so is a table that
/// equals an earlier one of its list.
#[test]
fn nothing_is_listed_twice() {
    let variants = Variants::new("listed-twice");
    let faces = "[\"left\", \"right\", \"front\", \"back\", \"bottom\"]";
    let first = "\"left\", \"left\", ";
    let load = "[[load]]\nkind = \"pressure\"\nset = \"top\"\npressure = 1e5\n";
    let roller = "[[support]]\nkind = \"roller\"\nset = \"bottom\"\n";
    for (old, new, list) in [
        ("\"left\", ", first.to_owned(), "faces"),
        (
            "kind = \"viscous-spring\"",
            "kind = \"viscous-spring\"\ninput = { incident-only = [\"bottom\", \"bottom\"] }".into(),
            "incident-only",
        ),
        (
            "at = [150, 150, 0]",
            "at = [150, 150, 0]\nquantities = [\"velocity\", \"velocity\"]".into(),
            "quantities",
        ),
        (
            "[[output.history]]",
            "[output.envelope]\nsets = [\"rock\", \"rock\"]\n[[output.history]]".into(),
            "sets",
        ),
        (
            "[time]",
            "[[stage]]\nname = \"a\"\nexcavate = [\"rock\", \"rock\"]\n[time]".into(),
            "excavate",
        ),
        (
            "[time]",
            "[[stage]]\nname = \"a\"\ncast = [\"rock\", \"rock\"]\n[time]".into(),
            "cast",
        ),
        (
            "[time]",
            "[[stage]]\nname = \"a\"\npart = [{ set = \"rock\", material = \"granite\" }, { set = \"rock\", material = \"granite\" }]\n[time]".into(),
            "part",
        ),
        (
            "[time]",
            format!("[[case]]\nname = \"a\"\nfaces = {}\n[time]", faces.replacen("\"left\", ", first, 1)),
            "faces",
        ),
        (
            "[time]",
            "[[case]]\nname = \"a\"\ncontinuous = [\"seam\", \"seam\"]\n[time]".into(),
            "continuous",
        ),
        (
            "[time]",
            "[[case]]\nname = \"a\"\nmaterial = [{ name = \"granite\", young = 1e10 }, { name = \"granite\", young = 2e10 }]\n[time]".into(),
            "material",
        ),
        ("[time]", format!("{load}{load}[time]"), "load"),
        ("[time]", format!("{roller}{roller}[time]"), "support"),
        ("[boundary]", format!("{WAVE}[boundary]"), "wave"),
        ("title =", "allow = [\"magnitudes\", \"magnitudes\"]\ntitle =".into(), "allow"),
    ] {
        let fault = fault(&variants, old, &new);
        match fault.problem() {
            Problem::Repeated { list: found, .. } | Problem::SameEntry { list: found } => {
                assert_eq!(found, list, "{new}: {fault}");
            }
            other => panic!("{new}: {other}"),
        }
    }
}

/// A facet of two absorbing faces, or one face listed twice in Rust, is an error with names and element.
#[test]
fn no_facet_absorbs_twice() {
    let mut mesh = cube();
    let all: Vec<_> = ["left", "front"]
        .iter()
        .flat_map(|face| mesh.facet_set(face).unwrap().to_vec())
        .collect();
    mesh.set_facet_set("around", all).unwrap();
    for faces in [["left", "left"], ["front", "around"], ["around", "left"]] {
        let scene = cube_scene_on(mesh.clone());
        let scene = scene.with_boundary(Boundary::new(Viscous::default(), faces));
        let error = scene.prepare().map(|_| ()).unwrap_err();
        let named = matches!(&error, Error::SharedFacet { first, second, .. }
            if *first == faces[0] && *second == faces[1]);
        assert!(named, "{faces:?}: {error}");
    }
}

/// A list that is too long is an error with its position, and so is a list in place of a table.
#[test]
fn lists_have_the_length_that_is_needed() {
    let variants = Variants::new("long-lists");
    for (old, new, expected) in [
        (
            "at = [150, 150, 0]",
            "at = [150, 150, 0, 99]",
            "a list of length 3",
        ),
        (
            "scatterer = [150, 150, 0]",
            "scatterer = [150, 150, 0, 0, 0]",
            "a list of length 3",
        ),
        (
            "[time]",
            "[[support]]\nkind = \"roller\"\nset = \"left\"\nnormal = [1, 0, 0, 0]\n[time]",
            "a list of length 3",
        ),
        (
            "kernel = \"hex8-full\"",
            "damping = { kind = \"flat\", ratio = 0.05, band = [1, 10, 20] }",
            "a list of length 2",
        ),
        (
            "file = \"cube.msh\"",
            "file = \"cube.msh\"\nwithin = { x = [0, 100, 200] }",
            "a list of length 2",
        ),
        (
            "[mesh]\nfile = \"cube.msh\"",
            "mesh = [\"cube.msh\"]",
            "a table",
        ),
    ] {
        let fault = fault(&variants, old, new);
        assert!(fault.to_string().contains(expected), "{new}: {fault}");
    }
}

/// Empty or invisible names and titles, distances and intervals beyond the body and the run, and frequencies in the
/// wrong order are errors.
#[test]
fn what_is_of_no_use_is_refused() {
    let variants = Variants::new("of-no-use");
    for (old, new, told) in [
        (
            "name = \"surface\"",
            "name = \"\"".to_owned(),
            "found nothing",
        ),
        ("title = \"cube\"", "title = \" \"".into(), "found nothing"),
        ("title = \"cube\"", "title = \"a\\u0000b\"".into(), "U+0000"),
        ("name = \"surface\"", "name = \"a\\nb\"".into(), "U+000A"),
        (
            "name = \"surface\"",
            format!("name = \"{}\"", "x".repeat(300)),
            "300 characters",
        ),
        (
            "kernel = \"hex8-full\"",
            "elastic_rim = 1000".into(),
            "the diagonal of the body",
        ),
        (
            "kernel = \"hex8-full\"",
            "elastic_rim = 1e300".into(),
            "elastic_rim = 1e300 m is outside the usual range",
        ),
        (
            "at = [150, 150, 0]",
            "at = [150, 150, 0]\nwithin = 600".into(),
            "the diagonal of the body",
        ),
        (
            "kernel = \"hex8-full\"",
            "damping = { kind = \"rayleigh\", ratio = 0.05, frequencies = [10, 1] }".into(),
            "the lower frequency first",
        ),
    ] {
        let fault = fault(&variants, old, &new);
        assert!(fault.to_string().contains(told), "{new}: {fault}");
    }
}

/// An unsupported body under gravity has a warning with its parts, also with dashpots around it; gravity without a stage
/// has a warning where the body is supported; with a stage there is no such warning.
#[test]
fn what_falls_is_warned_of() {
    let weight = |scene: Scene| scene.gravity(Vec3::new(0.0, 0.0, -9.81), |_: f64| 1.0);
    let rock = || Material::from(LinearElastic::new(ROCK));
    let bare = || weight(Scene::new("cube", cube()).part(Part::new("rock", rock())));
    let bottom = |normal: Vec3| {
        let mesh = cube();
        Support::roller(mesh.nodes_of_set("bottom").unwrap(), normal)
    };
    let falls = |scene: Scene| {
        let found = warnings_of(scene);
        found.contains(&Remark::from(remark::UnsupportedBody {
            sets: vec!["rock".into()],
        }))
    };
    let swings = |scene: Scene| warnings_of(scene).contains(&remark::SuddenGravity {}.into());
    assert!(falls(bare()));
    assert!(falls(
        bare().with_boundary(Boundary::new(Viscous::default(), SIDES))
    ));
    assert!(falls(bare().support(bottom(Vec3::x()))));
    let centre = Vec3::new(150.0, 150.0, 0.0);
    let springs = || Boundary::new(ViscousSpring::default(), SIDES).with_scatterer(centre);
    for held in [
        bare().with_boundary(springs()),
        bare().support(bottom(Vec3::z())),
        bare().support(bottom(Vec3::new(0.3, 0.0, 1.0))),
    ] {
        assert!(swings(held));
    }
    let staged = bare().stage(SceneStage::new("ground").support(bottom(Vec3::z())));
    assert_eq!(warnings_of(staged), []);
    // A ramp applies gravity slowly.
    let slow = Scene::new("cube", cube()).part(Part::new("rock", rock()));
    let slow = slow.gravity(Vec3::new(0.0, 0.0, -9.81), |t: f64| (t / 10.0).min(1.0));
    assert_eq!(warnings_of(slow.support(bottom(Vec3::z()))), []);
    // One of two bodies is unsupported.
    let two = halves_apart();
    let held = two.nodes_of_set("bottom").unwrap();
    let part = |set: &str| Part::new(set, rock());
    let scene = Scene::new("two", two)
        .part(part("lower"))
        .part(part("upper"));
    let scene = weight(scene).support(Support::roller(held, Vec3::z()));
    assert_eq!(
        warnings_of(scene),
        [Remark::from(remark::UnsupportedBody {
            sets: vec!["upper".into()]
        })]
    );
}

/// Two boxes of 300 m by 300 m one above the other that share no node.
fn halves_apart() -> Mesh {
    let mut mesh = cube();
    let all = 0..mesh.element_count() as u32;
    let (lower, upper): (Vec<u32>, Vec<u32>) = all.partition(|&e| mesh.centroid(e).z < -150.0);
    mesh.set_element_set("lower", lower.clone()).unwrap();
    mesh.set_element_set("upper", upper.clone()).unwrap();
    mesh.split_between(&lower, &upper).unwrap().mesh
}

/// The cube's scene as a slice in plane strain between rollers, with other keys at will.
fn slice(variants: &Variants, faces: &str, more: &str) -> Vec<Remark> {
    let mesh = Mesh::box_of_hexes(
        Vec3::new(0.0, 0.0, -300.0),
        Vec3::new(300.0, 50.0, 0.0),
        [6, 1, 6],
        "rock",
    );
    write_gmsh(variants.0.join("slice.msh"), &mesh.unwrap()).unwrap();
    let rollers = "[[support]]\nkind = \"roller\"\nset = \"front\"\n[[support]]\nkind = \"roller\"\nset = \"back\"\n";
    let text = CUBE
        .replace("cube.msh", "slice.msh")
        .replace(
            "\"left\", \"right\", \"front\", \"back\", \"bottom\"",
            faces,
        )
        .replace("azimuth = 30\n", "")
        .replace(
            "\"viscous-spring\"",
            "\"viscous-spring\"\nspreading = \"cylindrical\"",
        )
        .replace("at = [150, 150, 0]", "at = [150, 25, 0]")
        .replace("[time]", &format!("{rollers}{more}[time]"));
    let path = variants.0.join("slice.toml");
    let scene = FileScene::from_toml(text, path, &Registry::default()).unwrap();
    scene.prepare().unwrap().remarks().to_vec()
}

/// In a slice between rollers the other sides are as free as in a block: a missing absorbing face and a free surface
/// with traction of the field have warnings, although all nodes of the slice are on rollers.
#[test]
fn slices_have_free_sides() {
    let variants = Variants::new("slices");
    let all = "\"left\", \"right\", \"bottom\"";
    let open = |remarks: &[Remark]| -> Vec<&'static str> {
        let sides = remarks.iter().filter_map(|remark| match remark {
            Remark::OpenSide(remark::OpenSide { side, .. }) => Some(*side),
            _ => None,
        });
        sides.collect()
    };
    let sound = slice(&variants, all, "");
    assert!(sound.iter().all(|remark| !remark.is_warning()), "{sound:?}");
    assert_eq!(
        open(&slice(&variants, "\"left\", \"bottom\"", "")),
        ["right"]
    );
    assert_eq!(
        open(&slice(&variants, "\"left\", \"right\"", "")),
        ["bottom"]
    );
    let buried = slice(&variants, all, "[ground]\nsurface = 100\n");
    assert!(
        buried
            .iter()
            .any(|remark| matches!(remark, Remark::LoadedSurface(_))),
        "{buried:?}"
    );
}

/// Supports that restrain the free field reflect it: an oblique wave between side rollers has a warning, a vertical one
/// that they leave free has none.
#[test]
fn rollers_against_the_field_are_warned_of() {
    let variants = Variants::new("against-the-field");
    let sides = |normal: &str| {
        format!(
            "[[support]]\nkind = \"roller\"\nset = \"left\"\nnormal = {normal}\n[[support]]\nkind = \"roller\"\nset = \"right\"\nnormal = {normal}\n"
        )
    };
    let held = |remarks: &[Remark]| {
        warnings(remarks)
            .into_iter()
            .find_map(|warning| match warning {
                Remark::RestrainedField(remark::RestrainedField { share, .. }) => Some(share),
                _ => None,
            })
    };
    let across = slice(&variants, "\"bottom\"", &sides("[1, 0, 0]"));
    assert!(held(&across).is_some_and(|share| share > 0.5), "{across:?}");
    // Out of the plane nothing moves.
    let free = slice(&variants, "\"bottom\"", &sides("[0, 1, 0]"));
    assert_eq!(held(&free), None, "{free:?}");
}

/// An absorbing face on the free surface of a half-space has a warning with its name; below the surface, or in a full
/// space, it has none.
#[test]
fn an_absorbing_surface_is_warned_of() {
    let variants = Variants::new("absorbing-surface");
    let found = |ground: &str| {
        let scene = variants.read("\"bottom\"]", "\"bottom\", \"top\"]");
        let source = scene
            .unwrap()
            .source()
            .unwrap()
            .text
            .replace("[boundary]", ground)
            .replace("[150, 150, 0]\n[time]", "[150, 150, -150]\n[time]");
        let path = variants.0.join("top.toml");
        let scene = FileScene::from_toml(source, path, &Registry::default()).unwrap();
        warnings_of(scene)
    };
    assert_eq!(
        found("[boundary]"),
        [Remark::from(remark::AbsorbingSurface {
            face: "top".into()
        })]
    );
    assert_eq!(found("[ground]\nsurface = 50\n[boundary]"), []);
    assert_eq!(found("[ground]\nspace = \"full-space\"\n[boundary]"), []);
}

/// An output interval shorter than the time step becomes the step, and one longer than the run records its start and
/// end only: either has one warning.
#[test]
fn intervals_that_do_not_fit_the_run_are_warned_of() {
    let variants = Variants::new("intervals");
    let mut simulation = variants
        .read("every = 0.01", "every = 1e-5")
        .unwrap()
        .prepare()
        .unwrap();
    assert_eq!(warnings(simulation.remarks()), []);
    let step = simulation.step().unwrap();
    simulation.step().unwrap();
    let expected = Remark::from(remark::ShortInterval {
        what: "histories",
        interval: 1e-5,
        step,
    });
    assert_eq!(warnings(simulation.remarks()), [expected]);
    let mut simulation = variants
        .read("every = 0.01", "every = 0.1")
        .unwrap()
        .prepare()
        .unwrap();
    simulation.step().unwrap();
    assert_eq!(warnings(simulation.remarks()), []);
    let mut simulation = variants
        .read("every = 0.01", "energies = 0.7")
        .unwrap()
        .prepare()
        .unwrap();
    simulation.step().unwrap();
    simulation.step().unwrap();
    let expected = Remark::from(remark::LongInterval {
        what: "energies",
        interval: 0.7,
        duration: 0.6,
    });
    assert_eq!(warnings(simulation.remarks()), [expected]);
}

/// A number of threads above that of the machine is reduced to it, with a warning.
#[test]
fn threads_are_those_of_the_machine() {
    let variants = Variants::new("threads");
    for wanted in ["1000000", "9223372036854775807"] {
        let scene = variants
            .read("title", &format!("threads = {wanted}\ntitle"))
            .unwrap();
        let found = warnings_of(scene);
        let [Remark::Threads(remark::Threads { available, .. })] = found[..] else {
            panic!("{found:?}")
        };
        assert!(available >= 1 && found[0].is_warning());
    }
    assert_eq!(
        warnings_of(variants.read("title", "threads = 1\ntitle").unwrap()),
        []
    );
}

/// A rim that covers its whole part has a warning.
#[test]
fn a_rim_that_is_all_is_warned_of() {
    let variants = Variants::new("whole-rim");
    let found = |rim: &str| warnings_of(variants.read("kernel = \"hex8-full\"", rim).unwrap());
    assert_eq!(
        found("elastic_rim = 200"),
        [Remark::from(remark::WholeRim { set: "rock".into() })]
    );
    assert_eq!(found("elastic_rim = 0"), []);
}

/// Text that is not in UTF-8 is an error with line and column, a scene in UTF-16 by its encoding; an endless device is
/// never read.
#[test]
fn files_are_text_and_have_an_end() {
    let variants = Variants::new("encodings");
    let path = variants.0.join("scene.toml");
    let refused = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        match FileScene::from_file(&path) {
            Err(Error::Scene(fault)) => fault,
            other => panic!("{:?}", other.map(|_| ())),
        }
    };
    let mut bytes = CUBE.as_bytes().to_vec();
    let at = CUBE.find("granite").unwrap() + 2;
    bytes[at] = 0xff;
    let fault = refused(&bytes);
    assert_eq!(fault.position(), (6, 11), "{fault}");
    assert!(fault.to_string().contains("the byte 0xff"), "{fault}");
    fault.render(false);
    let wide: Vec<u8> = CUBE.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let fault = refused(&[&[0xff, 0xfe], &wide[..]].concat());
    assert!(fault.to_string().contains("UTF-16"), "{fault}");
    fault.render(false);
    let devices = ["/dev/zero", "/dev/urandom"];
    for device in devices.iter().filter(|device| fs::metadata(device).is_ok()) {
        let told = FileScene::from_file(device)
            .map(|_| ())
            .unwrap_err()
            .to_string();
        assert!(told.contains("is not a regular file"), "{told}");
        let told = fault_of_file(&variants, "cube.msh", device);
        assert!(told.contains("is not a regular file"), "{told}");
    }
}

fn fault_of_file(variants: &Variants, old: &str, new: &str) -> String {
    fault(variants, old, new).to_string()
}

/// Nodes without elements and elements without physical group in the mesh file are reported.
#[test]
fn unused_nodes_of_a_mesh_are_reported() {
    let variants = Variants::new("left-out");
    let path = variants.0.join("loose.msh");
    let file = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"rock\"\n$EndPhysicalNames\n$Nodes\n6\n1 0 0 0\n2 9 0 0\n3 0 9 0\n4 0 0 9\n5 0 0 -9\n6 5 5 5\n$EndNodes\n$Elements\n3\n1 4 2 1 1 1 2 3 4\n2 4 2 0 2 1 3 2 5\n3 15 2 0 3 6\n$EndElements\n";
    fs::write(&path, file).unwrap();
    let text = "title = \"loose\"\n[mesh]\nfile = \"loose.msh\"\n[[material]]\nname = \"m\"\nlaw = \"elastic\"\nyoung = 9e9\npoisson = 0.25\ndensity = 2700\n[[part]]\nset = \"rock\"\nmaterial = \"m\"\n[[part]]\nset = \"ungrouped\"\nmaterial = \"m\"\n[time]\nduration = 0.1\n";
    let scene =
        FileScene::from_toml(text, variants.0.join("s.toml"), &Registry::default()).unwrap();
    let expected = Remark::from(remark::MeshFile {
        nodes: 1,
        dropped: 1,
        ungrouped: 1,
    });
    let said = scene.remarks().iter();
    let said = said.filter(|remark| matches!(remark, Remark::MeshFile(_)));
    assert_eq!(Vec::from_iter(said), [&expected]);
}

/// A file that is not an accelerogram is an error that identifies it: an empty file, a mesh, a scene, text.
#[test]
fn what_is_no_record_is_named() {
    let variants = Variants::new("no-record");
    let record = "[[record]]\nname = \"r\"\nfile = \"r.at2\"\nconvention = \"incident\"\n[time]";
    for (content, told) in [
        ("", "the file is empty"),
        (" \n\n", "the file is empty"),
        ("$MeshFormat\n2.2 0 8\n", "a Gmsh mesh"),
        (CUBE, "a scene"),
        ("<html></html>", "a page of markup"),
        ("PEER record\nno header\n", "PEER AT2"),
        ("\0\0\u{1}", "bytes that are not text"),
    ] {
        fs::write(variants.0.join("r.at2"), content).unwrap();
        let fault = fault(&variants, "[time]", record).to_string();
        assert!(fault.contains(told), "{content:?}: {fault}");
        assert!(fault.contains("r.at2"), "{fault}");
    }
}
