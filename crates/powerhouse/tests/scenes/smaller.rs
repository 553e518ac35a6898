//! Reduced models: halves of symmetric bodies, slices, parts and refinements of meshes.

use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::SolidKernel;
use powerhouse::engine::observe::Motion;
use powerhouse::io::write_gmsh;
use powerhouse::material::{ElastoPlastic, LinearElastic, MohrCoulomb, presets};
use powerhouse::model::{Axis, Mesh, Vec3};
use powerhouse::wavefield::{Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind};
use powerhouse::{
    Boundary, Error, FileScene, Material, Mirror, MirrorError, OutputPlan, Parity, Part, Registry,
    Remark, RenderFault as _, Results, Scene, TimeStep,
};

use super::support::*;

const PLACES: [(&str, [f64; 3]); 3] = [
    ("middle", [150.0, 150.0, 0.0]),
    ("aside", [50.0, 100.0, -50.0]),
    ("deep", [250.0, 50.0, -200.0]),
];

/// The cube, or its half up to y = 150 m, under a wave.
fn body(half: bool, kind: WaveKind, [incidence, azimuth]: [f64; 2]) -> Scene {
    let width = if half { 150.0 } else { 300.0 };
    let (low, high) = (Vec3::new(0.0, 0.0, -300.0), Vec3::new(300.0, width, 0.0));
    let cells = [6, if half { 3 } else { 6 }, 6];
    let mesh = Mesh::box_of_hexes(low, high, cells, "rock").unwrap();
    let mut parameters = PlaneWaveParameters::vertical(kind, ROCK, 0.0);
    parameters.incidence = Angle::from_degrees(incidence);
    parameters.azimuth = Angle::from_degrees(azimuth);
    // The edge that is hit first.
    let first = if azimuth == 180.0 { 300.0 } else { 0.0 };
    parameters.reference = Vec3::new(first, 0.0, -300.0);
    let pulse = Arc::new(SmoothPulse::new(0.01, 0.4).unwrap());
    let sides: &[&str] = if half {
        &["left", "right", "front", "bottom"]
    } else {
        &SIDES
    };
    let mut boundary = Boundary::new(ViscousSpring::default(), sides.iter().copied());
    boundary.scatterer = Some(Vec3::new(150.0, 150.0, -60.0));
    let rock = Material::from(LinearElastic::new(ROCK));
    let output = PLACES
        .iter()
        .fold(OutputPlan::default(), |output, (name, place)| {
            output.history(name, Vec3::from(*place), Motion::DISPLACEMENT)
        });
    Scene::new("body", mesh)
        .part(Part::new("rock", rock).with_kernel(SolidKernel::Hex8Full))
        .with_plane_waves(vec![PlaneWave::new(parameters, pulse).unwrap()])
        .unwrap()
        .with_boundary(boundary)
        .with_step(TimeStep::Seconds(0.01))
        .with_duration(0.8)
        .with_output(output)
}

fn mirrored(scene: Scene, parity: Parity) -> Scene {
    let mesh = scene.mesh();
    let nodes = mesh.nodes_of_facets(mesh.facet_set("back").unwrap());
    let normal = Vec3::new(0.0, -2.0, 0.0);
    scene.mirror(Mirror {
        nodes,
        normal,
        parity,
    })
}

/// The largest difference of two runs over the largest motion.
fn apart(one: &Results, other: &Results) -> f64 {
    let (mut difference, mut peak) = (0.0_f64, 0.0_f64);
    assert_eq!(one.histories().times, other.histories().times);
    for (a, b) in one
        .histories()
        .columns
        .iter()
        .zip(&other.histories().columns)
    {
        assert_eq!(a.name, b.name);
        for (a, b) in a.values.iter().zip(&b.values) {
            difference = difference.max((a - b).abs());
            peak = peak.max(b.abs());
        }
    }
    difference / peak
}

/// Half of a body moves as the whole where the waves are symmetric about the plane (P and SV along it)
/// or antisymmetric (SH along it, SV straight up across it).
#[test]
fn half_a_body_moves_as_the_whole() {
    use Parity::{Antisymmetric, Symmetric};
    for (kind, angles, parity) in [
        (WaveKind::SV, [20.0, 0.0], Symmetric),
        (WaveKind::P, [35.0, 180.0], Symmetric),
        (WaveKind::SH, [40.0, 0.0], Antisymmetric),
        (WaveKind::SV, [0.0, 90.0], Antisymmetric),
    ] {
        let whole = run(body(false, kind, angles));
        let half = run(mirrored(body(true, kind, angles), parity));
        let apart = apart(&half, &whole);
        assert!(apart < 1e-10, "{kind} {angles:?}: {apart:e}");
    }
}

fn refused(scene: Scene) -> MirrorError {
    match scene.prepare().err() {
        Some(Error::Mirror(error)) => error,
        Some(other) => panic!("{other}"),
        None => panic!("accepted"),
    }
}

/// An invalid symmetry plane is an error with its cause: waves or gravity of another parity, plastic rock, nodes that are
/// not on a plane, an absorbing face in it.
#[test]
fn halves_that_are_not_the_whole_are_refused() {
    use Parity::{Antisymmetric, Symmetric};
    for (kind, angles, parity) in [
        (WaveKind::SV, [20.0, 30.0], Symmetric),
        (WaveKind::SV, [20.0, 0.0], Antisymmetric),
        (WaveKind::SH, [20.0, 0.0], Symmetric),
        (WaveKind::SV, [0.0, 45.0], Symmetric),
        (WaveKind::P, [0.0, 0.0], Antisymmetric),
    ] {
        let found = refused(mirrored(body(true, kind, angles), parity));
        assert!(
            matches!(&found, MirrorError::Parity { what, deviation, .. }
                if what.starts_with("the field") && *deviation > 0.1),
            "{found}"
        );
    }
    let sh = || mirrored(body(true, WaveKind::SH, [40.0, 0.0]), Antisymmetric);
    let heavy = sh().gravity(Vec3::new(0.0, 0.0, -9.81), |_: f64| 1.0);
    assert!(matches!(refused(heavy), MirrorError::Parity { what, .. } if what == "a weight"));
    let yielding = ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK).unwrap());
    let mut mesh = (**sh().mesh()).clone();
    mesh.set_element_set("core", vec![40]).unwrap();
    let rest: Vec<u32> = (0..108).filter(|e| *e != 40).collect();
    mesh.set_element_set("rest", rest).unwrap();
    let yields = Scene::new("yields", mesh)
        .part(Part::new("rest", Material::from(LinearElastic::new(ROCK))))
        .part(Part::new("core", Material::from(yielding)));
    let found = refused(mirrored(yields, Antisymmetric));
    assert!(
        matches!(&found, MirrorError::Nonlinear { what } if what == "part 'core'"),
        "{found}"
    );

    let sv = || body(true, WaveKind::SV, [20.0, 0.0]);
    let on = |nodes: Vec<u32>, normal: Vec3| {
        sv().mirror(Mirror {
            nodes,
            normal,
            parity: Symmetric,
        })
    };
    let nodes_of = |face: &str| {
        let scene = sv();
        let mesh = scene.mesh();
        mesh.nodes_of_facets(mesh.facet_set(face).unwrap())
    };
    assert!(matches!(
        refused(on(Vec::new(), Vec3::y())),
        MirrorError::Nothing
    ));
    assert!(matches!(
        refused(on(nodes_of("back"), Vec3::zeros())),
        MirrorError::Nothing
    ));
    let found = refused(on(nodes_of("back"), Vec3::x()));
    assert!(matches!(found, MirrorError::OffPlane { .. }), "{found}");
    let found = refused(on(nodes_of("front"), Vec3::y()));
    assert!(
        matches!(&found, MirrorError::Absorbs { face } if face == "front"),
        "{found}"
    );
    let mesh = sv().mesh().clone();
    let within = mesh.nodes_in_box(&Vec3::new(0.0, 50.0, -300.0), &Vec3::new(300.0, 50.0, 0.0));
    let found = refused(on(within, Vec3::y()));
    assert!(matches!(found, MirrorError::BothSides { .. }), "{found}");
}

const FACES: &str = "faces = [\"left\", \"right\", \"front\", \"back\", \"bottom\"]";

/// The cube's scene as a file with some passages replaced.
fn read(variants: &Variants, changes: &[(&str, &str)]) -> Result<Scene, Error> {
    let mut text = CUBE.to_owned();
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replacen(old, new, 1);
    }
    FileScene::from_toml(text, variants.0.join("cube.toml"), &Registry::default())
        .map(FileScene::into_scene)
}

/// Symmetry planes in a file equal those of Rust, and a wave that is not symmetric is an error at them.
#[test]
fn planes_of_symmetry_in_files() {
    let variants = Variants::new("mirror");
    let faces = "faces = [\"left\", \"right\", \"front\", \"bottom\"]";
    for (kind, parity) in [
        ("symmetry", Parity::Symmetric),
        ("antisymmetry", Parity::Antisymmetric),
    ] {
        let wave = if kind == "symmetry" { "sv" } else { "sh" };
        let support = "[time]\nstep = 0.01\n";
        let table = format!("[[support]]\nkind = \"{kind}\"\nset = \"back\"\n{support}");
        let of_wave = format!("kind = \"{wave}\"\nincidence = 20\nazimuth = 0");
        let changes = [
            (
                "kind = \"sv\"\nincidence = 20\nazimuth = 30",
                of_wave.as_str(),
            ),
            (FACES, faces),
            ("[time]\n", table.as_str()),
        ];
        let file = run(read(&variants, &changes).unwrap());
        let changes = [changes[0], changes[1], ("[time]\n", support)];
        let twin = run(mirrored(read(&variants, &changes).unwrap(), parity));
        // The normal of a facet set is longer than one of Rust, that is all.
        assert!(apart(&file, &twin) < 1e-12, "{kind}");
    }
    let table = "[[support]]\nkind = \"symmetry\"\nset = \"back\"\n[time]\n";
    let skew = read(&variants, &[(FACES, faces), ("[time]\n", table)]).unwrap();
    let Some(Error::Scene(fault)) = skew.prepare().err() else {
        panic!("accepted")
    };
    let shown = fault.render(false);
    assert!(
        shown.contains("is not symmetric about this plane"),
        "{shown}"
    );
    assert!(shown.contains("[[support]]"), "{shown}");
}

/// A part of a mesh by coordinates equals that of the mesh; one outside is an error with its position.
#[test]
fn a_scene_may_have_less_ground() {
    let variants = Variants::new("within");
    let file = "file = \"cube.msh\"";
    let with = |within: &str| format!("{file}\nwithin = {{ {within} }}");
    let whole = read(&variants, &[]).unwrap();
    let key = with("x = [60, 400], z = [-200, 0]");
    let scene = read(&variants, &[(file, key.as_str())]).unwrap();
    let (low, high) = (
        Vec3::new(60.0, f64::NEG_INFINITY, -200.0),
        Vec3::new(400.0, f64::INFINITY, 0.0),
    );
    let part = whole.mesh().within(&low, &high).unwrap();
    assert!(part.element_count() < whole.mesh().element_count());
    assert_eq!(scene.mesh().element_tags(), part.element_tags());
    assert_eq!(scene.mesh().facet_sets(), part.facet_sets());
    // Items on nodes that are cut off have no effect, with a warning.
    let mut mesh = Mesh::clone(whole.mesh());
    mesh.set_node_set("corner", vec![0]).unwrap();
    write_gmsh(variants.0.join("corner.msh"), &mesh).unwrap();
    let held = "[[support]]\nkind = \"fixed\"\nset = \"corner\"\n[time]\n";
    let remarks = |keys: &str| {
        let file = [(file, keys), ("[time]\n", held)];
        let scene = read(&variants, &file).unwrap();
        let of_corner =
            |remark: &&Remark| remark.is_warning() && remark.to_string().contains("'corner'");
        scene.remarks().iter().filter(of_corner).count()
    };
    assert_eq!(remarks("file = \"corner.msh\""), 0);
    assert_eq!(
        remarks("file = \"corner.msh\"\nwithin = { x = [60, 400] }"),
        1
    );
    for (within, wanted) in [
        ("y = [900, 990]", "no solid element"),
        ("w = [0, 1]", "unknown"),
    ] {
        let key = with(within);
        let Err(Error::Scene(fault)) = read(&variants, &[(file, key.as_str())]) else {
            panic!("accepted")
        };
        let shown = fault.render(false);
        assert!(
            shown.contains(wanted) && shown.contains("within ="),
            "{shown}"
        );
    }
}

/// A refined mesh equals that of the mesh, after the part and the slice; more than three refinements are an error with its
/// position, and so is an element number that no longer exists.
#[test]
fn a_scene_may_have_smaller_elements() {
    let variants = Variants::new("refine");
    let file = "file = \"cube.msh\"";
    let with = |keys: &str| read(&variants, &[(file, format!("{file}\n{keys}").as_str())]);
    let whole = read(&variants, &[]).unwrap();
    let same = |scene: &Scene, mesh: &Mesh| {
        assert_eq!(scene.mesh().positions(), mesh.positions());
        assert_eq!(scene.mesh().element_tags(), mesh.element_tags());
        assert_eq!(scene.mesh().facet_sets(), mesh.facet_sets());
    };
    let once = whole.mesh().refined().unwrap();
    same(&with("refine = 1").unwrap(), &once);
    same(&with("refine = 0").unwrap(), whole.mesh());
    let low = Vec3::new(60.0, f64::NEG_INFINITY, f64::NEG_INFINITY);
    let part = whole.mesh().within(&low, &Vec3::repeat(f64::INFINITY));
    let scene = with("refine = 1\nwithin = { x = [60, 1e9] }").unwrap();
    same(&scene, &part.unwrap().refined().unwrap());
    let scene = with("refine = 1\nslice = { across = \"y\", at = 160 }").unwrap();
    let layer = whole.mesh().plane_slice(Axis::Y, 160.0).unwrap();
    same(&scene, &layer.refined().unwrap());
    let element = format!("element = {}", whole.mesh().element_tags()[12]);
    let history = format!("[[output.history]]\nname = \"e\"\n{element}\n[[output.history]]\n");
    let by_number = |keys: &str| {
        let file = (file, format!("{file}\n{keys}"));
        read(
            &variants,
            &[(file.0, &file.1), ("[[output.history]]\n", &history)],
        )
    };
    assert!(by_number("").is_ok());
    let Err(Error::Scene(fault)) = by_number("refine = 1") else {
        panic!("accepted an element that has become eight")
    };
    assert!(fault.render(false).contains(&element));
    for refused in ["refine = 4", "refine = -1", "refine = 0.5"] {
        let Err(Error::Scene(fault)) = with(refused) else {
            panic!("accepted {refused}")
        };
        let shown = fault.render(false);
        assert!(shown.contains(refused), "{shown}");
    }
}

/// A slice of a plane strain problem moves as the whole body: equal histories within 1e-10 with one sixth of the elements;
/// a slice outside the mesh is an error with its position.
#[test]
fn a_slice_moves_as_the_whole() {
    let variants = Variants::new("slice");
    let held = "[[support]]\nkind = \"roller\"\nset = \"front\"\n[[support]]\nkind = \"roller\"\nset = \"back\"\n[time]\nstep = 0.01\n";
    let plane = [
        ("azimuth = 30", "azimuth = 0"),
        (FACES, "faces = [\"left\", \"right\", \"bottom\"]"),
        (
            "kind = \"viscous-spring\"",
            "kind = \"viscous-spring\"\nspreading = \"cylindrical\"",
        ),
        ("[time]\n", held),
    ];
    let file = "file = \"cube.msh\"";
    let sliced = |at: &str| format!("{file}\nslice = {{ across = \"y\", at = {at} }}");
    let whole = read(&variants, &plane).unwrap();
    let at = sliced("160");
    let slice = read(&variants, &[&plane[..], &[(file, at.as_str())]].concat()).unwrap();
    assert_eq!(
        6 * slice.mesh().element_count(),
        whole.mesh().element_count()
    );
    let output = |y: f64| {
        let at = Vec3::new(150.0, y, -50.0);
        OutputPlan::default().history("place", at, Motion::ALL)
    };
    // Both locations are of a plane strain problem: any y is equivalent.
    let apart = apart(
        &run(slice.with_output(output(150.0))),
        &run(whole.with_output(output(50.0))),
    );
    assert!(apart < 1e-10, "{apart:e}");
    let beside = sliced("400");
    let Err(Error::Scene(fault)) = read(&variants, &[(file, beside.as_str())]) else {
        panic!("accepted")
    };
    let shown = fault.render(false);
    assert!(
        shown.contains("cuts no element") && shown.contains("slice ="),
        "{shown}"
    );
}
