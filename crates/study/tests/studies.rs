//! Checks of scenes with known results.

use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::observe::Motion;
use powerhouse::engine::{PeriodicPairs, Rayleigh, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, Ricker, RickerQuantity, Signal, SmoothPulse, WaveKind,
    first_hit_corner,
};
use powerhouse::{
    Boundary, FileScene, Material, OutputPlan, Part, Registry, Remark, RunHooks, Scene,
    SnapshotRequest, remark,
};
use powerhouse_study::{FreeFieldCheck, FreeFieldReport, StudyError, Warning, check, warnings};

const ROCK: ElasticMedium = ElasticMedium {
    young: 9.0e9,
    poisson: 0.27,
    density: 2750.0,
};

/// A cube of 300 m under an SV wave at 20 degrees, cut into so many cells along an edge. The pulse is
/// smooth to all orders: one of velocities that fall with the third power of frequency, such as
/// a cubic spline, has an error of velocity that falls with the power 3/2 of the size only.
fn cube(cells: usize) -> (Mesh, PlaneWave) {
    let pulse = Ricker::new(RickerQuantity::Displacement, 0.01, 2.0, 0.75);
    cube_under(cells, Arc::new(pulse.unwrap()))
}

fn cube_under(cells: usize, pulse: Arc<dyn Signal>) -> (Mesh, PlaneWave) {
    let (low, high) = (Vec3::new(0.0, 0.0, -300.0), Vec3::new(300.0, 300.0, 0.0));
    let mesh = Mesh::box_of_hexes(low, high, [cells; 3], "rock").unwrap();
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, ROCK, 0.0);
    parameters.incidence = Angle::from_degrees(20.0);
    parameters.reference = first_hit_corner(&low, &high, &parameters.direction());
    (mesh, PlaneWave::new(parameters, pulse).unwrap())
}

fn rock() -> Part {
    Part::new("rock", Material::from(LinearElastic::new(ROCK)))
}

fn scene(cells: usize, faces: &[&str]) -> Scene {
    let (mesh, wave) = cube(cells);
    Scene::new("cube", mesh)
        .part(rock())
        .with_field(wave)
        .with_boundary(
            Boundary::new(ViscousSpring::default(), faces.iter().copied())
                .with_scatterer(Vec3::new(150.0, 150.0, -100.0)),
        )
        .with_duration(1.5)
}

const SIDES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

fn free_field(scene: &Scene) -> FreeFieldReport {
    let check = FreeFieldCheck::of(scene).unwrap();
    check.run(0.0, RunHooks::default()).unwrap()
}

/// The error of the free field is that of the elements: it falls with the square of their size, at
/// the surface and at the structure.
#[test]
fn the_free_field_error_falls_with_the_square_of_the_size() {
    let (coarse, fine) = (
        free_field(&scene(12, &SIDES)),
        free_field(&scene(24, &SIDES)),
    );
    assert_eq!((coarse.cells, fine.cells), ([12; 3], [24; 3]));
    for (coarse, fine) in coarse.points.iter().zip(&fine.points) {
        for (coarse, fine) in [
            (coarse.displacement, fine.displacement),
            (coarse.velocity, fine.velocity),
        ] {
            let slope = (coarse / fine).log2();
            assert!((slope - 2.0).abs() < 0.15, "{coarse} {fine}: slope {slope}");
        }
    }
    let largest = coarse.largest();
    assert!(coarse.require(largest).is_ok());
    assert!(matches!(
        coarse.require(0.9 * largest),
        Err(StudyError::TooCoarse { error, .. }) if error == largest
    ));
}

/// The free-field box takes over absorbing faces of any names, one or several.
#[test]
fn faces_may_have_any_names() {
    let (mut mesh, wave) = cube(6);
    let mut outer = Vec::new();
    for side in SIDES {
        outer.extend_from_slice(mesh.facet_set(side).unwrap());
    }
    mesh.set_facet_set("outer", outer).unwrap();
    let scene_with_one = Scene::new("cube", mesh)
        .part(rock())
        .with_field(wave)
        .with_boundary(
            Boundary::new(ViscousSpring::default(), ["outer"])
                .with_scatterer(Vec3::new(150.0, 150.0, -100.0)),
        )
        .with_duration(1.5);
    let (one, five) = (free_field(&scene_with_one), free_field(&scene(6, &SIDES)));
    // Edges sum their faces in another order: rounding is all that may differ.
    for (one, five) in one.points.iter().zip(&five.points) {
        assert!((one.velocity - five.velocity).abs() < 1e-9 * five.velocity);
    }
}

/// A box with an unsupported side has no free field for comparison.
#[test]
fn an_open_side_is_an_error_by_name() {
    let open = FreeFieldCheck::of(&scene(4, &["left", "front", "back", "bottom"]));
    assert!(matches!(open, Err(StudyError::OpenFace { face: "right" })));
    let (mesh, _) = cube(4);
    let still = FreeFieldCheck::of(&Scene::new("still", mesh).part(rock()));
    assert!(matches!(still, Err(StudyError::NoField)));
}

/// A part resolves ten elements per shear wavelength; a run takes as many stable steps as the duration needs, and one
/// more.
#[test]
fn a_check_reports_resolved_frequencies_and_steps() {
    let report = check(scene(16, &SIDES)).unwrap();
    let carried = &report.resolution[0];
    assert_eq!(carried.set, "rock");
    assert!((carried.longest_edge - 18.75).abs() < 1e-12);
    assert!((carried.frequency - ROCK.s_speed() / 187.5).abs() < 1e-12);
    assert_eq!(report.cost.step, report.stable.step);
    assert_eq!(
        report.cost.steps,
        (1.5 / report.cost.step).ceil() as u64 + 1
    );
    assert_eq!((report.nodes, report.elements), (4913, 4096));
    assert_eq!(report.warnings, []);
    // A cube's element bound is 0.758 h/cp at this ratio; the assembled limit lies above it.
    let bound = 0.758 * 18.75 / ROCK.p_speed();
    assert!((report.stable.element_bound / bound - 1.0).abs() < 0.02);
    assert!(report.stable.assembled_limit > 1.1 * bound);
}

/// There are warnings for a pulse or a record with unresolved frequencies, for a scene without excitation, and for a
/// field that arrives after the run.
#[test]
fn the_input_is_compared_with_the_resolution() {
    let printed = warnings(&scene(4, &SIDES)).unwrap();
    assert!(
        matches!(&printed[..], [Warning::Unresolved { set, share, frequency, .. }]
            if set == "rock" && *share > 0.5 && (frequency - ROCK.s_speed() / 750.0).abs() < 1e-9),
        "{printed:?}"
    );
    let (mesh, _) = cube(4);
    let undriven = Scene::new("undriven", mesh).part(rock());
    assert_eq!(warnings(&undriven).unwrap(), [Warning::NoExcitation]);
    // The pulse needs a quarter of a second to the surface.
    let (mesh, wave) = cube_under(4, Arc::new(SmoothPulse::new(0.01, 0.5).unwrap()));
    let early = Scene::new("early", mesh)
        .part(rock())
        .with_field(wave)
        .with_boundary(Boundary::new(ViscousSpring::default(), SIDES).with_scatterer(Vec3::zeros()))
        .with_duration(0.01);
    let printed = warnings(&early).unwrap();
    assert!(
        printed.contains(&Warning::StillField { duration: 0.01 }),
        "{printed:?}"
    );
    assert!(matches!(
        FreeFieldCheck::of(&early),
        Err(StudyError::StillField { .. })
    ));
}

/// An error of NaN is never accepted.
#[test]
fn an_error_of_nan_is_not_accepted() {
    let mut report = free_field(&scene(4, &SIDES));
    report.points[0].velocity = f64::NAN;
    assert!(report.largest().is_nan());
    assert!(matches!(
        report.require(f64::INFINITY),
        Err(StudyError::TooCoarse { .. })
    ));
}

/// The bricks of the box are as long as the longest edge behind the absorbing faces, whatever is
/// finer inside.
#[test]
fn the_box_is_as_coarse_as_the_rock_at_its_coarsest() {
    let graded = |scale: f64| {
        let (mesh, wave) = cube(12);
        // Edges of 25 m, stretched in the lower half and compressed in the upper one.
        let mesh = mesh
            .map_positions(|x| {
                let depth = -x.z;
                let bent = if depth < 150.0 {
                    depth * (2.0 - scale)
                } else {
                    150.0 * (2.0 - scale) + (depth - 150.0) * scale
                };
                Vec3::new(x.x, x.y, -bent)
            })
            .unwrap();
        let scatterer = Vec3::new(150.0, 150.0, -100.0);
        let boundary = Boundary::new(ViscousSpring::default(), SIDES).with_scatterer(scatterer);
        Scene::new("graded", mesh)
            .part(rock())
            .with_field(wave)
            .with_boundary(boundary)
            .with_duration(1.5)
    };
    let cells = |scene: &Scene| free_field(scene).cells;
    assert_eq!(cells(&graded(1.0)), [12; 3]);
    assert_eq!(cells(&graded(1.5)), [8; 3]);
}

/// A slice has a free-field check, too: roller supports or periodic pairs of whole sides are applied to the box, and the
/// wave in its plane travels as in the block.
#[test]
fn slices_are_checked() {
    let in_plane = ["left", "right", "bottom"];
    let sliced = |hold: &dyn Fn(Scene, &Mesh) -> Scene| {
        let whole = scene(12, &in_plane);
        let mesh = Mesh::clone(whole.mesh());
        hold(whole, &mesh)
    };
    let nodes = |mesh: &Mesh, side: &str| mesh.nodes_of_facets(mesh.facet_set(side).unwrap());
    let rollers = sliced(&|mut scene, mesh| {
        for side in ["front", "back"] {
            scene = scene.support(Support::roller(nodes(mesh, side), Vec3::y()));
        }
        scene
    });
    let periodic = sliced(&|scene, mesh| {
        let (front, back) = (nodes(mesh, "front"), nodes(mesh, "back"));
        scene.with_periodic_pairs(PeriodicPairs::by_translation(mesh, &front, &back, 1e-6).unwrap())
    });
    let block = free_field(&scene(12, &SIDES));
    for slice in [rollers, periodic] {
        let found = free_field(&slice);
        assert_eq!(found.cells, block.cells);
        for (found, block) in found.points.iter().zip(&block.points) {
            assert!(
                found.velocity < 1.3 * block.velocity,
                "{} {}",
                found.velocity,
                block.velocity
            );
        }
    }
    assert!(matches!(
        FreeFieldCheck::of(&sliced(&|scene, _| scene)),
        Err(StudyError::OpenFace { face: "front" })
    ));
    // A support of a part of a side does not hold it.
    let part = sliced(&|scene, mesh| {
        let mut some = nodes(mesh, "front");
        some.pop();
        scene.support(Support::roller(some, Vec3::y()))
    });
    assert!(matches!(
        FreeFieldCheck::of(&part),
        Err(StudyError::OpenFace { face: "front" })
    ));
}

/// For damped ground the check is elastic, and the error with damping is reported separately.
#[test]
fn damping_is_reported_separately() {
    let elastic = free_field(&scene(12, &SIDES));
    assert_eq!(elastic.damped, None);
    let (mesh, wave) = cube(12);
    let rayleigh = Rayleigh::from_ratio(0.05, 1.0, 10.0).unwrap();
    let scatterer = Vec3::new(150.0, 150.0, -100.0);
    let damped = Scene::new("damped", mesh)
        .part(rock().with_damping(rayleigh))
        .with_field(wave)
        .with_boundary(Boundary::new(ViscousSpring::default(), SIDES).with_scatterer(scatterer))
        .with_duration(1.5);
    let damped = free_field(&damped);
    assert_eq!(damped.points, elastic.points);
    let with = &damped.damped.unwrap()[0];
    assert!(with.velocity > 2.0 * elastic.points[0].velocity, "{with:?}");
    assert!(with.velocity < 0.5);
}

/// Predicted output and memory are finite, and grow with the requests only up to the number of steps.
#[test]
fn costs_of_any_plan_are_finite() {
    let cost = |every: f64, snapshots: f64| {
        let mut plan =
            OutputPlan::default().history("top", Vec3::new(150.0, 150.0, 0.0), Motion::ALL);
        plan.every = every;
        plan.snapshots = Some(SnapshotRequest::new(snapshots));
        check(scene(4, &SIDES).with_output(plan)).unwrap().cost
    };
    let (each, tiny) = (cost(1e-9, 0.1), cost(f64::MIN_POSITIVE, 0.1));
    assert_eq!((each.output, each.memory), (tiny.output, tiny.memory));
    assert!(each.output > cost(0.1, 0.1).output);
    // One row of ten numbers a step, in the table and its plot.
    let rows = each.steps * 10 * 40;
    assert!(each.output < rows + cost(0.1, 0.1).output, "{each:?}");
}

/// There are warnings for long elements, damping at an absorbing face, and motion with unresolved frequencies.
#[test]
fn a_check_warns() {
    let damped = {
        let (mesh, wave) = cube(4);
        let mesh = mesh
            .map_positions(|x| Vec3::new(x.x, x.y, 0.05 * x.z))
            .unwrap();
        let rayleigh = Rayleigh::from_ratio(0.05, 1.0, 10.0).unwrap();
        Scene::new("flat", mesh)
            .part(rock().with_damping(rayleigh))
            .with_field(wave)
            .with_boundary(
                Boundary::new(ViscousSpring::default(), SIDES)
                    .with_scatterer(Vec3::new(150.0, 150.0, -7.0)),
            )
    };
    let report = check(damped).unwrap();
    assert!(report.warnings.iter().any(
        |warning| matches!(warning, Warning::Aspect { ratio } if (ratio - 20.0).abs() < 1e-9)
    ));
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/scenes/cavern_small.toml"
    );
    let text = std::fs::read_to_string(path).unwrap();
    let text = text.replace(
        "kernel = \"hex8-one-point\"",
        "damping = { kind = \"rayleigh\", ratio = 0.05, frequencies = [1, 10] }",
    );
    let scene = FileScene::from_toml(text.as_str(), path, &Registry::default())
        .unwrap()
        .into_scene();
    let warnings = check(scene).unwrap().warnings;
    assert!(warnings.iter().any(
        |warning| matches!(warning, Warning::Remark(Remark::DampedRim(remark::DampedRim { set })) if set == "rock")
    ));
    let unused = Remark::from(remark::UnusedRecord {
        name: "el-centro-ns".into(),
    });
    assert!(!warnings.contains(&Warning::Remark(unused.clone())));
    let text = text.replace(
        "record = \"el-centro-ns\"",
        "pulse = { kind = \"smooth\", displacement = 0.01, duration = 1 }",
    );
    let scene = FileScene::from_toml(text.as_str(), path, &Registry::default())
        .unwrap()
        .into_scene();
    assert!(scene.remarks().contains(&unused));
    // A case may use it.
    let case = "[[case]]\nname = \"shaken\"\nwave = [{ kind = \"p\", incidence = 0, record = \"el-centro-ns\" }]\n";
    let scene = FileScene::from_toml(text + case, path, &Registry::default())
        .unwrap()
        .into_scene();
    assert!(!scene.remarks().contains(&unused));
    // A run that ends within the strong motion is warned of, unless it is given another duration.
    let is_short = |remark: &Remark| matches!(remark, Remark::TruncatedRecord(_));
    let text = std::fs::read_to_string(path).unwrap();
    let text = text.replace("duration = 20", "duration = 2");
    let scene = FileScene::from_toml(text, path, &Registry::default())
        .unwrap()
        .into_scene();
    assert!(scene.remarks().iter().any(is_short));
    let scene = scene.with_duration(20.0);
    assert!(!scene.remarks().iter().any(is_short));
    // The coarse mesh carries 8 Hz, the record has more.
    assert!(warnings.iter().any(
        |warning| matches!(warning, Warning::Unresolved { set, frequency, .. }
            if set == "rock" && (frequency - 7.97).abs() < 0.01)
    ));
}
