//! Boundary advice: input taken from a scene, recommendation, and use of the printed tables in scenes.

use std::sync::Arc;

use powerhouse::boundary::{Spreading, ViscousSpring};
use powerhouse::engine::observe::Motion;
use powerhouse::io::write_gmsh;
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind, first_hit_corner,
};
use powerhouse::{Boundary, FileScene, Material, OutputPlan, Part, Registry, RunHooks, Scene};
use powerhouse_study::advice::{BoundaryKind, BoundaryProblem, Excitation, Obstacle};
use powerhouse_study::{BoundaryAdvice, OpeningSlice, StudyError, advise_boundary, advise_box};
use powerhouse_test_support::TestFolder;

const ROCK: ElasticMedium = ElasticMedium {
    young: 9.0e9,
    poisson: 0.27,
    density: 2750.0,
};

const OPENING: OpeningSlice = OpeningSlice {
    radius: 2.0,
    depth: 4.0,
    half_width: 12.0,
    height: 12.0,
    fine: 1.0,
    coarse: [1.0; 2],
    growth: 1.0,
};

/// A slice with an opening under a P wave, as a file.
const TEXT: &str = r#"
title = "opening"
[mesh]
file = "opening.msh"
[[material]]
name = "rock"
law = "elastic"
young = 9.0e9
poisson = 0.27
density = 2750
[[part]]
set = "rock"
material = "rock"
[[support]]
kind = "roller"
set = "front"
[[support]]
kind = "roller"
set = "back"
[[wave]]
kind = "p"
incidence = 10
pulse = { kind = "smooth", displacement = 0.01, duration = 0.06 }
[time]
duration = 0.12
[[output.history]]
name = "surface"
at = [0, 0, 0]
"#;

const BOUNDARY: &str = r#"
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "bottom"]
scatterer = [0, 0, -4]
"#;

struct Folder(TestFolder);

impl Folder {
    fn new(name: &str, mesh: &Mesh) -> Self {
        let folder = TestFolder::new(&format!("advice-{name}"));
        write_gmsh(folder.join("opening.msh"), mesh).unwrap();
        Self(folder)
    }
    fn read(&self, boundary: &str) -> FileScene {
        let text = format!("{TEXT}{boundary}");
        let path = self.0.join("scene.toml");
        FileScene::from_toml(text, path, &Registry::default()).unwrap()
    }
}

fn histories(scene: FileScene) -> Vec<Vec<f64>> {
    let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let columns = results.histories().columns.clone().into_iter();
    columns.map(|column| column.values).collect()
}

/// A cube without a structure, whose field is declared as plane waves or not.
fn cube(known: bool) -> Scene {
    let (low, high) = (Vec3::new(0.0, 0.0, -90.0), Vec3::new(90.0, 90.0, 0.0));
    let mesh = Mesh::box_of_hexes(low, high, [6; 3], "rock").unwrap();
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, ROCK, 0.0);
    parameters.incidence = Angle::from_degrees(20.0);
    parameters.reference = first_hit_corner(&low, &high, &parameters.direction());
    let pulse = Arc::new(SmoothPulse::new(0.01, 0.2).unwrap());
    let wave = PlaneWave::new(parameters, pulse).unwrap();
    let faces = ["left", "right", "front", "back", "bottom"];
    let scene = Scene::new("cube", mesh)
        .part(Part::new("rock", Material::from(LinearElastic::new(ROCK))))
        .with_boundary(Boundary::new(ViscousSpring::default(), faces))
        .with_duration(0.4);
    if known {
        scene.with_plane_waves(vec![wave]).unwrap()
    } else {
        scene.with_field(wave)
    }
}

/// Position and size of the scatterer, distances of the faces, spreading, waves and frequency band are taken from a
/// scene.
#[test]
fn the_problem_is_taken_from_the_scene() {
    let folder = Folder::new("problem", &OPENING.mesh().unwrap());
    let problem = BoundaryProblem::of(&folder.read(BOUNDARY)).unwrap();
    assert!((problem.radius.unwrap() - 2.0).abs() < 1e-9);
    assert!((problem.depth.unwrap() - 4.0).abs() < 1e-9);
    let expected = [[Some(12.0), Some(12.0)], [None, None], [Some(8.0), None]];
    for (found, expected) in problem
        .distances
        .iter()
        .flatten()
        .zip(expected.iter().flatten())
    {
        assert_eq!(found.is_some(), expected.is_some());
        assert!((found.unwrap_or(0.0) - expected.unwrap_or(0.0)).abs() < 1e-9);
    }
    assert_eq!(problem.spreading, Spreading::Cylindrical);
    let Excitation::Waves { waves, band } = &problem.excitation else {
        panic!("waves come in")
    };
    assert_eq!((waves.len(), waves[0].kind), (1, WaveKind::P));
    assert!((waves[0].incidence.degrees() - 10.0).abs() < 1e-12);
    // The spectrum of a cubic spline of 0.06 s is zero at 4/0.06 = 67 Hz, and hardly more before.
    assert!((15.0..67.0).contains(&band.highest), "{}", band.highest);
    let energies: f64 = band.lines.iter().map(|line| line.1).sum();
    assert!((energies - 1.0).abs() < 1e-12);
    assert!(band.lines.windows(2).all(|pair| pair[0].0 < pair[1].0));
}

/// The best boundary comes first, none is recommended if none meets the permitted error, and a scene with the printed
/// table has the recommended boundary.
#[test]
fn the_table_gives_the_recommended_boundary() {
    let folder = Folder::new("table", &OPENING.mesh().unwrap());
    let advice =
        |error: f64| -> BoundaryAdvice { advise_boundary(&folder.read(BOUNDARY), error).unwrap() };
    let generous = advice(0.9);
    let named = generous.recommended().unwrap().clone();
    assert!(
        generous
            .candidates
            .iter()
            .all(|c| c.predicted >= named.predicted)
    );
    assert!(named.predicted > 1e-4, "{}", named.predicted);
    let table = generous.table().unwrap();
    let pasted = histories(folder.read(&table));
    let mut scene = folder.read(BOUNDARY);
    let mut boundary = scene.boundary().unwrap().clone();
    boundary.condition = generous.condition(&named.kind).unwrap();
    scene = scene.map(|scene| scene.with_boundary(boundary));
    assert_eq!(pasted, histories(scene), "{table}");
    assert!(generous.to_string().contains(&table));

    // Nothing meets a billionth: the best error is reported, without a table.
    let strict = advice(1e-9);
    assert!(strict.recommended().is_none() && strict.table().is_none());
    assert_eq!(strict.candidates[0].kind, named.kind);
    assert!(
        strict.reason().contains("no boundary meets"),
        "{}",
        strict.reason()
    );
}

/// Faces come as near as the permitted error allows; the scene with the printed key has them there, and its difference
/// from the whole scene is within the permitted error.
#[test]
fn a_box_is_as_small_as_the_error_permits() {
    let wide = OpeningSlice {
        half_width: 20.0,
        height: 20.0,
        ..OPENING
    };
    let folder = Folder::new("box", &wide.mesh().unwrap());
    let whole = folder.read(BOUNDARY);
    let generous = advise_box(&whole, 0.9).unwrap();
    let near = generous.nearer.as_ref().unwrap();
    assert!(near.predicted > generous.unchanged);
    let limit = 0.5 * (near.predicted + generous.unchanged);
    let strict = advise_box(&whole, limit).unwrap();
    let far = strict.nearer.as_ref().unwrap();
    assert!(far.predicted <= limit && near.predicted <= 0.9);
    assert!(near.share < far.share && near.elements < far.elements);
    // No face absorbs above the ground, or before and behind the slice.
    assert_eq!(far.within[1], None);
    assert_eq!(far.within[2].unwrap()[1], whole.mesh().bounding_box().1.z);
    let table = strict.table().unwrap();
    let key = table.strip_prefix("[mesh]\n").unwrap();
    assert!(strict.to_string().contains(&table));

    let read = |key: &str| {
        let mesh = "[mesh]\nfile = \"opening.msh\"\n";
        let text = format!("{TEXT}{BOUNDARY}").replace(mesh, &format!("{mesh}{key}"));
        // The wave has the same reference point for any box.
        let text = text.replace(
            "incidence = 10\n",
            "incidence = 10\nreference = [-20, 0, -20]\n",
        );
        FileScene::from_toml(text, folder.0.join("scene.toml"), &Registry::default()).unwrap()
    };
    let small = read(key);
    assert_eq!(small.mesh().element_count(), far.elements);
    let [x, _, z] = BoundaryProblem::of(&small).unwrap().distances;
    for (own, whole) in [(x[0], 20.0), (x[1], 20.0), (z[0], 16.0)] {
        let own = own.unwrap();
        assert!((own - far.share * whole).abs() <= 0.6, "{own} {whole}");
    }
    let (small, whole) = (histories(small), histories(read("")));
    let (mut apart, mut all) = (0.0_f64, 0.0_f64);
    for (small, whole) in small.iter().zip(&whole) {
        for (small, whole) in small.iter().zip(whole) {
            apart += (small - whole).powi(2);
            all += whole.powi(2);
        }
    }
    let error = (apart / all).sqrt();
    // Both have an error.
    let permitted = limit + strict.unchanged;
    assert!(error <= permitted, "{error} {permitted}");

    let refused = advise_box(&read(""), 1e-9).unwrap();
    assert!(refused.nearer.is_none() && refused.table().is_none());
    assert!(refused.to_string().contains("no nearer faces"));
}

/// A body without a scatterer needs no more than dashpots; the keys of each kind contain its parameters.
#[test]
fn without_a_scatterer_dashpots_suffice() {
    let advice = advise_boundary(&cube(true).into(), 0.05).unwrap();
    assert_eq!(advice.problem.radius, None);
    assert_eq!(advice.recommended().unwrap().kind, BoundaryKind::Viscous);
    assert!(
        advice
            .candidates
            .iter()
            .all(|candidate| candidate.predicted == 0.0)
    );
    assert!(advice.reason().contains("has no scatterer"));
    assert!(advice.table().unwrap().contains("kind = \"viscous\""));
    // Springs of 4 G/r stand in for a distance of (lambda + 2 G) r/(4 G (1 + A)).
    let kind = BoundaryKind::StaticSprings;
    let surroundings = powerhouse_study::advice::Surroundings {
        medium: ROCK,
        spreading: Spreading::Spherical,
        distances: [45.0; 3],
    };
    let face = kind.face(&surroundings, 45.0).unwrap();
    assert!((face.normal_spring / (4.0 * ROCK.shear() / 45.0) - 1.0).abs() < 1e-12);
}

/// A scene without a prediction is an error with its reason.
#[test]
fn missing_input_of_a_prediction_is_an_error() {
    let refused = |scene: FileScene| advise_boundary(&scene, 0.05).unwrap_err();
    assert!(matches!(
        refused(cube(false).into()),
        StudyError::UnknownField
    ));
    let mesh = || Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(3.0), [3; 3], "rock").unwrap();
    let rock = || Part::new("rock", Material::from(LinearElastic::new(ROCK)));
    let bare = Scene::new("bare", mesh()).part(rock());
    assert!(matches!(refused(bare.into()), StudyError::NoBoundary));
    let still = Scene::new("still", mesh())
        .part(rock())
        .with_boundary(Boundary::new(ViscousSpring::default(), ["bottom"]))
        .with_output(OutputPlan::default().history("top", Vec3::repeat(3.0), Motion::ALL));
    assert!(matches!(refused(still.into()), StudyError::NoExcitation));
    let narrow = OpeningSlice {
        half_width: 4.4,
        fine: 0.25,
        coarse: [0.25; 2],
        ..OPENING
    };
    let folder = Folder::new("narrow", &narrow.mesh().unwrap());
    assert!(matches!(
        refused(folder.read(BOUNDARY)),
        StudyError::NearFace { distance, least } if (distance - 4.4).abs() < 1e-9 && least > 4.0
    ));
    for wrong in [0.0, -0.1, 1.5, f64::NAN] {
        assert!(
            advise_boundary(&cube(true).into(), wrong).is_err(),
            "{wrong}"
        );
    }
}

/// The error predicted for the unchanged scene is that of its own B, 1 by default.
#[test]
fn predictions_use_the_dashpots_of_the_scene() {
    for (depth, half_width) in [(4.0, 12.0)] {
        let opening = OpeningSlice {
            depth,
            half_width,
            height: depth + 10.0,
            ..OPENING
        };
        let folder = Folder::new("default", &opening.mesh().unwrap());
        let read = |ratio: &str| {
            let boundary = BOUNDARY.replace("-4]", &format!("-{depth}]\n{ratio}"));
            let text = format!("{TEXT}{boundary}").replace("incidence = 10", "incidence = 30");
            let path = folder.0.join("scene.toml");
            FileScene::from_toml(text, path, &Registry::default()).unwrap()
        };
        let advice = advise_boundary(&read(""), 0.9).unwrap();
        let error = |speed_ratio: f64| {
            let kind = BoundaryKind::Springs { speed_ratio };
            let found = advice.candidates.iter().find(|c| c.kind == kind);
            found.unwrap().predicted
        };
        assert_ne!(error(1.0), error(1.1));
        for (ratio, expected) in [
            ("", 1.0),
            ("speed_ratio = \"paper\"", 1.1),
            ("speed_ratio = 1.1", 1.1),
        ] {
            // For an error that the present faces exceed, no nearer ones are tried.
            let found = advise_box(&read(ratio), 1e-6).unwrap().unchanged;
            assert_eq!(found, error(expected), "{ratio}");
        }
    }
}

/// A mesh whose elements are not in plane layers is not reduced, since its new faces would have steps. The reason is
/// reported. (One in plane layers is reduced:
/// `a_box_is_as_small_as_the_error_permits`.)
#[test]
fn a_box_with_steps_is_not_offered() {
    let wide = OpeningSlice {
        half_width: 20.0,
        height: 20.0,
        ..OPENING
    };
    let plane = wide.mesh().unwrap();
    // The outer faces and the surroundings of the opening stay.
    let wavy = |p: Vec3| {
        let inside = (p.z * (p.z + 20.0) / 100.0) * (1.0 - (p.x / 20.0).powi(2));
        let far = ((p.x.hypot(p.z + 4.0) - 4.0) / 3.0).clamp(0.0, 1.0);
        p + Vec3::z() * (inside * far * 1.1 * (1.3 * p.x).sin())
    };
    let folder = Folder::new("wavy", &plane.map_positions(wavy).unwrap());
    let advice = advise_box(&folder.read(BOUNDARY), 0.9).unwrap();
    assert!(advice.table().is_none(), "{advice}");
    let steps = matches!(&advice.obstacle, Some(Obstacle::Steps { face }) if face == "bottom");
    assert!(steps, "{:?}", advice.obstacle);
    assert!(advice.to_string().contains("would have steps"), "{advice}");
}

/// Sums of lengths that are too short by rounding are accepted, as for any mesh whose dimensions are not whole numbers;
/// faces only at the bottom are an error of their own.
#[test]
fn rounding_and_faces_at_the_bottom_are_distinguished() {
    let mut short = 0;
    for i in 0..400 {
        let (depth, height) = (20.1 + 0.0137 * f64::from(i), 59.37);
        let below: f64 = height - depth;
        let (radius, square) = (2.0615, 4.123);
        let slice = OpeningSlice {
            radius,
            depth,
            height: depth + below,
            half_width: 16.0,
            coarse: [4.0, below - square],
            ..OPENING
        };
        if slice.height < slice.depth + square + slice.coarse[1] {
            short += 1;
            assert!(slice.mesh().is_ok(), "{slice:?}");
        }
    }
    assert!(short > 0);
    let folder = Folder::new("bottom", &OPENING.mesh().unwrap());
    let bottom = BOUNDARY.replace("[\"left\", \"right\", \"bottom\"]", "[\"bottom\"]");
    let text = format!("{TEXT}{bottom}").replace("incidence = 10", "incidence = 0");
    let path = folder.0.join("scene.toml");
    let scene = FileScene::from_toml(text, path, &Registry::default()).unwrap();
    let refused = advise_boundary(&scene, 0.05).unwrap_err();
    assert!(
        matches!(&refused, StudyError::NoSides { faces } if faces == &["bottom"]),
        "{refused}"
    );
}
