//! Structures that run through absorbing faces: tunnels whose lining ends on two faces of layered rock.

use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::SolidKernel;
use powerhouse::engine::observe::Motion;
use powerhouse::io::write_gmsh;
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, Ground, GroundLayer, LayeredWave, LayeredWaveParameters, Ricker, RickerQuantity,
    WaveKind,
};
use powerhouse::{
    Boundary, Error, FileScene, LayerError, Material, OutputPlan, Part, Registry, Remark,
    RenderFault as _, RunHooks, Scene, ThroughError, TimeStep, remark,
};
use powerhouse_test_support::TestFolder;

/// Medium of a density (kg/m3) and of wave speeds (m/s).
fn medium(density: f64, cs: f64, cp: f64) -> ElasticMedium {
    let (shear, constrained) = (density * cs * cs, density * cp * cp);
    let lambda = constrained - 2.0 * shear;
    let poisson = lambda / (2.0 * (lambda + shear));
    ElasticMedium::new(2.0 * shear * (1.0 + poisson), poisson, density).unwrap()
}

/// Weathered rock down to 20 m.
fn weathered() -> ElasticMedium {
    medium(2200.0, 500.0, 1000.0)
}

fn rock() -> ElasticMedium {
    medium(2500.0, 1000.0, 1900.0)
}

fn concrete() -> ElasticMedium {
    ElasticMedium::new(30e9, 0.2, 2500.0).unwrap()
}

/// Duration of the runs (s).
const DURATION: f64 = 1.0;
/// Section of the ground across the tunnel (m): half its width, and its depth.
const SECTION: [f64; 2] = [40.0, 60.0];
/// Edge of all elements, and thickness of the lining (m).
const SIZE: f64 = 2.0;
/// Least and greatest z of the opening (m), and half its width.
const OPENING: [f64; 3] = [-34.0, -26.0, 4.0];

/// Body of a length (m) about y = 0 with a tunnel along y.
fn body(length: f64) -> Mesh {
    let [half, depth] = SECTION;
    let low = Vec3::new(-half, -0.5 * length, -depth);
    let high = Vec3::new(half, 0.5 * length, 0.0);
    let cells = [2.0 * half, length, depth].map(|extent| (extent / SIZE).round() as usize);
    let mesh = Mesh::box_of_hexes(low, high, cells, "all").unwrap();
    let [bottom, top, width] = OPENING;
    let lies_in = |mesh: &Mesh, element: u32, margin: f64| {
        let centroid = mesh.centroid(element);
        centroid.x.abs() < width + margin && (bottom - margin..top + margin).contains(&centroid.z)
    };
    let kept = (0..mesh.element_count() as u32).filter(|&e| !lies_in(&mesh, e, 0.0));
    let mut mesh = mesh.of_elements(&kept.collect::<Vec<_>>()).unwrap();
    let part = |element: u32| match (lies_in(&mesh, element, SIZE), mesh.centroid(element).z) {
        (true, _) => "lining",
        (false, z) if z > -20.0 => "weathered",
        (false, _) => "rock",
    };
    let parts: Vec<&str> = (0..mesh.element_count() as u32).map(part).collect();
    for name in ["lining", "weathered", "rock"] {
        let elements = (0u32..).zip(&parts).filter(|(_, part)| **part == name);
        let elements = elements.map(|(element, _)| element).collect();
        mesh.set_element_set(name, elements).unwrap();
    }
    mesh
}

fn wave(kind: WaveKind, incidence: f64, azimuth: f64) -> LayeredWave {
    let above = vec![GroundLayer::new(-20.0, weathered())];
    let ground = Ground::new(0.0, above, rock()).unwrap();
    let mut parameters = LayeredWaveParameters::vertical(kind, ground, -SECTION[1]);
    parameters.incidence = Angle::from_degrees(incidence);
    parameters.azimuth = Angle::from_degrees(azimuth);
    parameters.reference = Vec3::new(0.0, 0.0, -SECTION[1]);
    parameters.arrival = 0.1;
    parameters.until = Some(3.0);
    let ricker = Ricker::new(RickerQuantity::Displacement, 0.01, 5.0, 0.3).unwrap();
    LayeredWave::new(parameters, Arc::new(ricker)).unwrap()
}

fn scene(length: f64, wave: LayeredWave, lining: ElasticMedium, through: &[&str]) -> Scene {
    let [bottom, top, width] = OPENING;
    let edge = 0.5 * SIZE;
    let middle = 0.5 * (bottom + top);
    let mut output = OutputPlan::default().with_every(4e-3);
    // Mid-side and corner of the ring at mid-length.
    for (name, point) in [
        ("crown", Vec3::new(0.0, 0.0, top + edge)),
        ("side", Vec3::new(width + edge, 0.0, middle)),
        ("corner", Vec3::new(width + edge, 0.0, top + edge)),
        ("foot", Vec3::new(-width - edge, 0.0, bottom - edge)),
    ] {
        output = output.stress_at(name, point);
    }
    output = output.history("moves", Vec3::new(0.0, 0.0, top), Motion::ALL);
    let boundary = Boundary::new(
        ViscousSpring::default(),
        ["left", "right", "front", "back", "bottom"],
    );
    let part = |set: &str, medium| {
        Part::new(set, Material::from(LinearElastic::new(medium)))
            .with_kernel(SolidKernel::Hex8Natural)
    };
    Scene::new("tunnel", body(length))
        .part(part("lining", lining))
        .part(part("weathered", weathered()))
        .part(part("rock", rock()))
        .with_layered_waves(vec![wave])
        .unwrap()
        .with_boundary(
            boundary
                .with_scatterer(Vec3::new(0.0, 0.0, middle))
                .with_through(through.iter().copied()),
        )
        .with_step(TimeStep::Seconds(3e-4))
        .with_duration(DURATION)
        .with_output(output)
}

/// Histories of stress in the lining, and of its motion, at mid-length: columns one after the other.
fn run(scene: Scene) -> [Vec<f64>; 2] {
    let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let columns = &results.histories().columns;
    ["s", "v"].map(|of| {
        let own = columns.iter().filter(|column| {
            let (_, quantity) = column.name.split_once('.').unwrap();
            quantity.starts_with(of)
        });
        own.flat_map(|column| column.values.iter().copied())
            .collect()
    })
}

/// Relative L2 difference of histories at mid-length of a box from those of a longer one.
fn differences(short: &[Vec<f64>; 2], long: &[Vec<f64>; 2]) -> [f64; 2] {
    core::array::from_fn(|k| {
        assert_eq!(short[k].len(), long[k].len());
        assert!(!long[k].is_empty());
        let missed = short[k].iter().zip(&long[k]).map(|(a, b)| (a - b).powi(2));
        let all = long[k].iter().map(|b| b * b);
        (missed.sum::<f64>() / all.sum::<f64>()).sqrt()
    })
}

/// The same for a tunnel of a length (m) against one three times as long: of stresses and of velocities.
fn difference(length: f64, kind: WaveKind, incidence: f64, azimuth: f64) -> [f64; 2] {
    let of = |length: f64| {
        let wave = wave(kind, incidence, azimuth);
        run(scene(length, wave, concrete(), &["lining"]))
    };
    let [short, long] = [length, 3.0 * length].map(of);
    differences(&short, &long)
}

/// Fails unless the stress of a lining that ends on two faces, and its motion, are at mid-length those of a tunnel three
/// times as long to 5 %, two widths of the tunnel apart from the faces, under a wave from below across the tunnel.
fn check_ends(kind: WaveKind) {
    let found = difference(48.0, kind, 15.0, 0.0);
    println!("figure through.{kind}_across {found:?}");
    assert!(
        found.iter().all(|share| *share <= 0.05),
        "{kind}: {found:?}"
    );
}

#[test]
fn a_lining_through_two_faces_is_that_of_a_long_tunnel() {
    check_ends(WaveKind::SV);
}

/// The same for SH: `cargo test --release --test powerhouse in_sh -- --ignored`.
#[test]
#[ignore = "takes a minute"]
fn a_lining_through_two_faces_is_that_of_a_long_tunnel_in_sh() {
    check_ends(WaveKind::SH);
}

/// What the ends cost at other distances of the middle from them, and under waves along the tunnel; for the table of the documentation.
#[test]
#[ignore = "minutes; prints the table of the documentation"]
fn ends_of_a_lining_at_several_distances() {
    for length in [12.0, 24.0, 48.0, 72.0] {
        for (kind, azimuth) in [
            (WaveKind::SV, 0.0),
            (WaveKind::SH, 0.0),
            (WaveKind::SV, 90.0),
            (WaveKind::SH, 90.0),
        ] {
            let found = difference(length, kind, 15.0, azimuth);
            println!("figure through.{length}_{kind}_{azimuth} {found:?}");
        }
    }
}

/// A part of the ground's own medium that is said to run through the faces moves to the bit as the ground does.
#[test]
fn ground_through_a_face_is_ground() {
    let of = |through: &[&str]| {
        let wave = wave(WaveKind::SV, 15.0, 0.0);
        run(scene(8.0, wave, rock(), through))
    };
    let (named, unnamed) = (of(&["lining"]), of(&[]));
    assert_eq!(named, unnamed);
    assert!(named[0].iter().any(|value| *value != 0.0));
}

fn refused(through: &[&str]) -> Error {
    let wave = wave(WaveKind::SV, 15.0, 0.0);
    scene(8.0, wave, concrete(), through)
        .prepare()
        .err()
        .unwrap()
}

/// Without a name a structure in a face is refused with face, media and ways out; names must be those of parts at the faces,
/// and leave ground.
#[test]
fn what_does_not_run_through_is_refused() {
    let unnamed = refused(&[]);
    assert!(
        matches!(&unnamed, Error::Layers(LayerError::OtherMedium { set, .. }) if set == "lining")
    );
    for word in ["face 'front'", "2500 kg/m3", "`through`", "rollers"] {
        assert!(unnamed.to_string().contains(word), "{unnamed}");
    }
    let no_part = refused(&["lining", "dyke"]);
    assert!(
        matches!(&no_part, Error::Through(ThroughError::NoPart { set }) if set == "dyke"),
        "{no_part}"
    );
    let no_ground = refused(&["lining", "rock", "weathered"]);
    assert!(
        matches!(no_ground, Error::Through(ThroughError::NoGround)),
        "{no_ground}"
    );
}

/// The run reports which part runs through which faces, and with what contrast.
#[test]
fn what_runs_through_is_reported() {
    let wave = wave(WaveKind::SV, 15.0, 0.0);
    let simulation = scene(8.0, wave, concrete(), &["lining"]).prepare().unwrap();
    let remark = simulation
        .remarks()
        .iter()
        .find(|r| matches!(r, Remark::Through(_)));
    let Some(Remark::Through(remark::Through {
        set,
        faces,
        share,
        contrast,
        width,
    })) = remark
    else {
        panic!("nothing told")
    };
    assert_eq!(
        (set.as_str(), &faces[..]),
        ("lining", &["front".to_owned(), "back".to_owned()][..])
    );
    // A ring of 80 of the 80 by 60 m less 64.
    assert!((share - 80.0 / (4800.0 - 64.0)).abs() < 1e-9, "{share}");
    let concrete = concrete();
    let expected = concrete.density * concrete.s_speed() / (2500.0 * 1000.0);
    assert!((contrast - expected).abs() < 1e-9, "{contrast}");
    assert_eq!(*width, 12.0);
}

/// Key of a scene file, of ground of one medium: a seam through all faces of a cube.
#[test]
fn a_scene_names_what_runs_through() {
    let folder = TestFolder::new("through");
    let high = Vec3::repeat(40.0);
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), high, [4; 3], "all").unwrap();
    let is_seam = |element: &u32| (10.0..20.0).contains(&mesh.centroid(*element).x);
    let (seam, rock): (Vec<u32>, Vec<u32>) = (0..mesh.element_count() as u32).partition(is_seam);
    mesh.set_element_set("seam", seam).unwrap();
    mesh.set_element_set("rock", rock).unwrap();
    write_gmsh(folder.join("cube.msh"), &mesh).unwrap();
    let part = |name: &str, young: &str| {
        format!(
            "[[material]]\nname = \"{name}\"\nlaw = \"elastic\"\nyoung = {young}\npoisson = 0.25\ndensity = 2600\n[[part]]\nset = \"{name}\"\nmaterial = \"{name}\"\n"
        )
    };
    let text = format!(
        "title = \"seam\"\n[mesh]\nfile = \"cube.msh\"\n{}{}[[wave]]\nkind = \"sv\"\nincidence = 10\npulse = {{ kind = \"ricker\", displacement = 0.01, frequency = 4 }}\n[boundary]\nkind = \"viscous-spring\"\nfaces = [\"left\", \"right\", \"front\", \"back\", \"bottom\"]\nscatterer = [20, 20, 20]\nthrough = [\"seam\"]\n[time]\nduration = 0.2\n",
        part("rock", "20e9"),
        part("seam", "5e9"),
    );
    let read = |text: &str| {
        let path = folder.join("seam.toml");
        let scene = FileScene::from_toml(text, path, &Registry::default());
        scene.map_err(|error| match error {
            Error::Scene(fault) => fault.render(false),
            error => error.to_string(),
        })
    };
    let simulation = read(&text).unwrap().prepare().unwrap();
    let mut remarks = simulation.remarks().iter();
    assert!(
        remarks.any(
            |r| matches!(r, Remark::Through(remark::Through { faces, .. }) if faces.len() == 3)
        )
    );
    simulation.run(RunHooks::default()).unwrap();
    for (through, message) in [
        ("", "`through`"),
        ("through = [\"sea\"]\n", "no part has this element set"),
        (
            "through = [\"seam\", \"rock\"]\n",
            "all parts at the absorbing faces",
        ),
    ] {
        let told = read(&text.replace("through = [\"seam\"]\n", through))
            .err()
            .unwrap();
        assert!(told.contains(message), "{through}: {told}");
    }
}
