//! Predicted costs of stages and savings of changes, compared with changed scenes.

use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::{StaticOptions, Support};
use powerhouse::material::{ElastoPlastic, LinearElastic, MohrCoulomb, presets};
use powerhouse::model::{Axis, ElasticMedium, Mesh, PeriodicPairs, Rayleigh, Vec3};
use powerhouse::wavefield::{Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind};
use powerhouse::{
    Boundary, Damping, FileScene, Material, Mirror, Parity, Part, Registry, Scene, SceneStage,
    TimeStep,
};
use powerhouse_study::check;
use powerhouse_study::saving::{Change, Saving};

const ROCK: ElasticMedium = ElasticMedium {
    young: 9.0e9,
    poisson: 0.27,
    density: 2750.0,
};
const SIDES: [&str; 5] = ["left", "right", "front", "back", "bottom"];
const TOP: Vec3 = Vec3::new(30.0, 30.0, 0.0);

/// Ground of 60 m, 60 m deep, under a P wave that comes straight up, its faces at a share of 30 m from the
/// axis, in bricks of 5 m.
fn ground(share: f64) -> Mesh {
    let across = Vec3::new(30.0 * share, 30.0 * share, 0.0);
    let low = TOP - across - Vec3::new(0.0, 0.0, 60.0 * share);
    let cells = |length: f64| (length / 5.0).round() as usize;
    let wide = cells(60.0 * share);
    Mesh::box_of_hexes(low, TOP + across, [wide, wide, wide], "rock").unwrap()
}

fn rock() -> Material {
    Material::from(LinearElastic::new(ROCK))
}

fn scene(mesh: Mesh, faces: &[&str]) -> Scene {
    scene_of(ROCK, mesh, faces)
}

fn scene_of(medium: ElasticMedium, mesh: Mesh, faces: &[&str]) -> Scene {
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::P, medium, 0.0);
    parameters.reference = mesh.bounding_box().0;
    let pulse = Arc::new(SmoothPulse::new(0.01, 0.2).unwrap());
    let wave = PlaneWave::new(parameters, pulse).unwrap();
    let boundary = Boundary::new(ViscousSpring::default(), faces.iter().copied());
    Scene::new("ground", mesh)
        .with_plane_waves(vec![wave])
        .unwrap()
        .with_boundary(boundary.with_scatterer(TOP - Vec3::new(0.0, 0.0, 15.0)))
        .with_duration(0.4)
}

/// Steps and elements of a run.
fn counts(scene: impl Into<FileScene>) -> [f64; 2] {
    let scene = scene.into();
    let duration = scene.duration();
    let mut simulation = scene.prepare().unwrap();
    let step = simulation.step().unwrap();
    let elements = simulation.mesh().element_count() as f64;
    [(duration / step).ceil() + 1.0, elements]
}

fn of(savings: &[Saving], change: impl Fn(&Change) -> bool) -> &Saving {
    let found = savings.iter().find(|saving| change(&saving.change));
    found.unwrap_or_else(|| panic!("{savings:?}"))
}

/// Half of a symmetric body and a step equal to the stable one have the predicted numbers of elements and steps, and no
/// more than three changes are named, the best first.
#[test]
fn halves_and_stable_steps_save_as_predicted() {
    let whole = || scene(ground(1.0), &SIDES).part(Part::new("rock", rock()));
    let slow = || whole().with_step(TimeStep::OfStable(0.6));
    let report = check(slow()).unwrap();
    let savings = &report.savings;
    assert_eq!(savings.len(), 3);
    assert!(savings.is_sorted_by(|a, b| a.time <= b.time));
    let [steps, elements] = counts(slow());

    let faster = of(savings, |change| *change == Change::WholeStep);
    let found = counts(whole())[0] / steps;
    assert!(
        (found / faster.steps - 1.0).abs() < 0.02,
        "{found} {faster:?}"
    );
    assert_eq!((faster.time, faster.elements), (faster.steps, 1.0));

    let half = of(
        savings,
        |change| matches!(change, Change::Half { axis: Axis::X, at } if (at - 30.0).abs() < 1e-9),
    );
    let (low, high) = (Vec3::new(30.0, 0.0, -60.0), Vec3::new(60.0, 60.0, 0.0));
    let mesh = Mesh::box_of_hexes(low, high, [6, 12, 12], "rock").unwrap();
    let nodes = mesh.nodes_of_facets(mesh.facet_set("left").unwrap());
    let mirror = Mirror {
        nodes,
        normal: Vec3::x(),
        parity: Parity::Symmetric,
    };
    let halved = scene(mesh, &["right", "front", "back", "bottom"]);
    let halved = halved.part(Part::new("rock", rock())).mirror(mirror);
    let found = counts(halved.with_step(TimeStep::OfStable(0.6)));
    assert_eq!(found[1] / elements, half.elements);
    assert!((found[0] / steps - half.steps).abs() < 0.02);
    assert_eq!(half.time, half.elements);
    assert!(
        savings
            .iter()
            .all(|saving| saving.error.share.is_none_or(|share| share > 0.0))
    );
}

/// Neither half nor slice is named where waves or parts have no mirror image, or a face absorbs along it.
#[test]
fn halves_need_a_mirror_image() {
    let mut mesh = ground(1.0);
    let corner = mesh.elements_in_box(&Vec3::new(0.0, 0.0, -60.0), &Vec3::new(30.0, 60.0, 0.0));
    let rest = (0..mesh.element_count() as u32).filter(|e| !corner.contains(e));
    let rest = rest.collect();
    mesh.set_element_set("corner", corner).unwrap();
    mesh.set_element_set("rest", rest).unwrap();
    let one_sided = scene(mesh, &SIDES)
        .part(Part::new("corner", rock()))
        .part(Part::new("rest", rock()));
    let savings = check(one_sided).unwrap().savings;
    let along = |axis: Axis| {
        let named = |saving: &&Saving| matches!(saving.change, Change::Half { axis: other, .. } if other == axis);
        savings.iter().find(named)
    };
    assert!(
        along(Axis::X).is_none() && along(Axis::Y).is_some(),
        "{savings:?}"
    );
    assert!(
        !savings
            .iter()
            .any(|saving| matches!(saving.change, Change::Slice { .. }))
    );
}

/// A long body under waves along it needs one layer with delayed sides, whose elements and steps are those that are predicted; not where
/// a wave is past its critical angle, the section is not constant or damping follows the stiffness.
#[test]
fn a_long_body_under_waves_along_it_is_a_slice() {
    let along = |mesh: Mesh, incidence: f64, faces: &[&str]| {
        let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, ROCK, 0.0);
        parameters.reference = mesh.bounding_box().0;
        parameters.incidence = Angle::from_degrees(incidence);
        parameters.azimuth = Angle::from_degrees(70.0);
        let pulse = Arc::new(SmoothPulse::new(0.01, 0.2).unwrap());
        let wave = PlaneWave::new(parameters, pulse).unwrap();
        let boundary = Boundary::new(ViscousSpring::default(), faces.iter().copied());
        Scene::new("ground", mesh)
            .with_plane_waves(vec![wave])
            .unwrap()
            .with_boundary(boundary.with_scatterer(TOP - Vec3::new(0.0, 0.0, 15.0)))
            .with_duration(0.4)
    };
    let part = || Part::new("rock", rock());
    let proposed = |scene: Scene| {
        let savings = check(scene).unwrap().savings;
        let is_slice = |saving: &Saving| matches!(saving.change, Change::DelayedSlice { .. });
        savings.into_iter().find(is_slice)
    };
    for incidence in [10.0, 25.0, 31.0] {
        let [steps, elements] = counts(along(ground(1.0), incidence, &SIDES).part(part()));
        let saving = proposed(along(ground(1.0), incidence, &SIDES).part(part())).unwrap();
        let Change::DelayedSlice { at, .. } = saving.change else {
            panic!("{saving:?}");
        };
        let layer = ground(1.0).plane_slice(Axis::Y, at).unwrap();
        let [front, back] =
            ["front", "back"].map(|side| layer.nodes_of_facets(layer.facet_set(side).unwrap()));
        let pairs = PeriodicPairs::by_translation(&layer, &front, &back, 1e-6).unwrap();
        let slice = along(layer, incidence, &["left", "right", "bottom"]).part(part());
        let found = counts(slice.with_delayed_sides(pairs));
        assert_eq!(found[1] / elements, saving.elements);
        let ratio = found[0] / steps / saving.steps;
        assert!((0.85..1.1).contains(&ratio), "{incidence}: {ratio}");
        assert!(saving.time < 0.5, "{saving}");
    }
    assert!(proposed(along(ground(1.0), 45.0, &SIDES).part(part())).is_none());
    let damped = part().with_damping(Damping::Rayleigh(Rayleigh {
        mass: 0.0,
        stiffness: 1e-4,
    }));
    assert!(proposed(along(ground(1.0), 25.0, &SIDES).part(damped)).is_none());
    let mut mesh = ground(1.0);
    let corner = mesh.elements_in_box(&Vec3::new(0.0, 0.0, -60.0), &Vec3::new(30.0, 30.0, 0.0));
    let rest = (0..mesh.element_count() as u32).filter(|e| !corner.contains(e));
    let rest = rest.collect();
    mesh.set_element_set("corner", corner).unwrap();
    mesh.set_element_set("rest", rest).unwrap();
    let parts = ["corner", "rest"].map(|set| Part::new(set, rock()));
    let [corner, rest] = parts;
    assert!(proposed(along(mesh, 25.0, &SIDES).part(corner).part(rest)).is_none());

    // A bay of equal sections is a slice, too; not one with supports or pairs that a slice does not take.
    let ends = |mesh: &Mesh, names: [&str; 2]| {
        let [from, to] = names.map(|side| mesh.nodes_of_facets(mesh.facet_set(side).unwrap()));
        PeriodicPairs::by_translation(mesh, &from, &to, 1e-6).unwrap()
    };
    let bay = |incidence: f64, faces: &[&str]| {
        let mesh = ground(1.0);
        let pairs = ends(&mesh, ["front", "back"]);
        let scene = along(mesh, incidence, faces).part(part());
        scene.with_delayed_sides(pairs)
    };
    let faces = ["left", "right", "bottom"];
    for incidence in [10.0, 25.0] {
        let [steps, elements] = counts(bay(incidence, &faces));
        let saving = proposed(bay(incidence, &faces)).unwrap();
        let Change::DelayedSlice { at, has_ends: true } = saving.change else {
            panic!("{saving:?}");
        };
        let layer = ground(1.0).plane_slice(Axis::Y, at).unwrap();
        let pairs = ends(&layer, ["front", "back"]);
        let slice = along(layer, incidence, &faces).part(part());
        let found = counts(slice.with_delayed_sides(pairs));
        assert_eq!(found[1] / elements, saving.elements);
        let ratio = found[0] / steps / saving.steps;
        assert!((0.85..1.1).contains(&ratio), "{incidence}: {ratio}");
        assert!(saving.time < 0.1, "{saving}");
    }
    let other = ends(&ground(1.0), ["left", "right"]);
    assert!(proposed(bay(25.0, &["bottom"]).with_periodic_pairs(other.clone())).is_none());
    let long = along(ground(1.0), 25.0, &["bottom"]).part(part());
    assert!(proposed(long.with_periodic_pairs(other)).is_none());
    let bottom = ground(1.0);
    let bottom = bottom.nodes_of_facets(bottom.facet_set("bottom").unwrap());
    let held = |nodes| {
        along(ground(1.0), 25.0, &["left", "right"])
            .part(part())
            .support(Support::fixed(nodes))
    };
    assert!(proposed(held(bottom)).is_none());
}

/// The forecast of a bay has the nodes that each of its elements has for itself, and says that steps take longer once a law yields.
#[test]
fn a_bay_costs_more_than_periodic_ends() {
    let yields = ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK).unwrap());
    for (material, iterates) in [(rock(), false), (Material::from(yields), true)] {
        let mesh = ground(1.0);
        let elements = mesh.element_count() as u64;
        let [from, to] =
            ["front", "back"].map(|side| mesh.nodes_of_facets(mesh.facet_set(side).unwrap()));
        let pairs = PeriodicPairs::by_translation(&mesh, &from, &to, 1e-6).unwrap();
        let body = || {
            let part = Part::new("rock", material.clone());
            scene(mesh.clone(), &["left", "right", "bottom"]).part(part)
        };
        let delayed = check(body().with_delayed_sides(pairs.clone())).unwrap();
        let periodic = check(body().with_periodic_pairs(pairs)).unwrap();
        let more = delayed.cost.memory.saturating_sub(periodic.cost.memory);
        assert!(more > 600 * 8 * elements, "{more} bytes");
        for (report, expected) in [(&delayed, iterates), (&periodic, false)] {
            assert_eq!(report.cost.iterates, expected);
            let told = report.to_string().contains("takes several iterations");
            assert_eq!(told, expected);
        }
    }
}

/// A body with a constant section needs one layer, nearer faces leave the predicted number of elements, and a few thin
/// elements that limit the step are found: without them it grows as predicted.
#[test]
fn slices_nearer_faces_and_larger_elements_save_as_predicted() {
    let inside = |mesh: &mut Mesh| {
        let (low, high) = (Vec3::new(20.0, 0.0, -20.0), Vec3::new(40.0, 60.0, -10.0));
        let lining = mesh.elements_in_box(&low, &high);
        let rest = (0..mesh.element_count() as u32).filter(|e| !lining.contains(e));
        let rest = rest.collect();
        mesh.set_element_set("lining", lining).unwrap();
        mesh.set_element_set("ground", rest).unwrap();
    };
    let faces = ["left", "right", "bottom"];
    let slender = |mesh: Mesh| {
        let held = |side: &str| {
            let nodes = mesh.nodes_of_facets(mesh.facet_set(side).unwrap());
            Support::roller(nodes, Vec3::y())
        };
        let (front, back) = (held("front"), held("back"));
        scene(mesh, &faces)
            .part(Part::new("ground", rock()))
            .part(Part::new("lining", rock()))
            .support(front)
            .support(back)
    };
    let long = |share: f64| {
        let mut mesh = ground(share);
        inside(&mut mesh);
        mesh
    };
    let [steps, elements] = counts(slender(long(1.0)));
    let savings = check(slender(long(1.0))).unwrap().savings;
    let slice = of(&savings, |change| {
        matches!(change, Change::Slice { axis: Axis::Y, .. })
    });
    let layer = long(1.0).plane_slice(Axis::Y, 30.0).unwrap();
    let found = counts(slender(layer));
    assert!(
        (found[1] / elements - slice.elements).abs() < 1e-12,
        "{slice:?}"
    );
    assert!(
        (found[0] / steps - slice.steps).abs() < 0.02,
        "{found:?} {steps}"
    );

    // Without waves that travel across it there is no slice; nearer faces remain.
    let mut mesh = long(1.0);
    // A layer of bricks half as thick, in one of twelve columns, and its set.
    let thin = mesh.elements_in_box(&Vec3::new(20.0, 0.0, -20.0), &Vec3::new(40.0, 5.0, -10.0));
    let few = mesh.element_set("lining").unwrap().iter().copied();
    let few = few.filter(|element| !thin.contains(element)).collect();
    mesh.set_element_set("thin", thin).unwrap();
    mesh.set_element_set("lining", few).unwrap();
    let stiff = ElasticMedium {
        young: 4.0 * ROCK.young,
        ..ROCK
    };
    let with = |young: ElasticMedium| {
        let stiff = Material::from(LinearElastic::new(young));
        slender(mesh.clone()).part(Part::new("thin", stiff))
    };
    let savings = check(with(stiff)).unwrap().savings;
    let larger = of(
        &savings,
        |change| matches!(change, Change::LargerElements { set, count: 8, .. } if set == "thin"),
    );
    // Twice the speed of waves: twice as large they would not limit the step.
    assert!(
        matches!(larger.change, Change::LargerElements { times, .. } if (times - 2.0).abs() < 0.01)
    );
    let found = counts(with(ROCK))[0] / counts(with(stiff))[0];
    assert!(
        (found / larger.steps - 1.0).abs() < 0.1,
        "{found} {larger:?}"
    );
}

/// Nearer faces leave the predicted number of elements. Their error is predicted where that takes no longer than the run: not where P
/// waves are seven times as fast as shear waves.
#[test]
fn nearer_faces_leave_the_predicted_elements() {
    let of_ground = |share: f64, medium: ElasticMedium| {
        let mut mesh = ground(share);
        let (low, high) = (Vec3::new(25.0, 25.0, -20.0), Vec3::new(35.0, 35.0, -10.0));
        let lining = mesh.elements_in_box(&low, &high);
        let rest = (0..mesh.element_count() as u32).filter(|e| !lining.contains(e));
        let rest = rest.collect();
        mesh.set_element_set("lining", lining).unwrap();
        mesh.set_element_set("ground", rest).unwrap();
        let rock = || Material::from(LinearElastic::new(medium));
        scene_of(medium, mesh, &SIDES)
            .part(Part::new("ground", rock()))
            .part(Part::new("lining", rock()))
    };
    let of_share = |share| of_ground(share, ROCK);
    let is_nearer =
        |change: &Change| matches!(change, Change::NearerFaces { share } if *share == 0.75);
    let report = check(of_share(1.0)).unwrap();
    let nearer = of(&report.savings, is_nearer);
    // The sides are 30 m from the middle of the structure, the lower face is 45 m below it; the surface
    // stays. Elements across a new face are kept, too.
    let [steps, elements] = counts(of_share(1.0));
    let found = counts(of_share(0.75));
    let (low, high) = (Vec3::new(7.5, 7.5, -48.75), Vec3::new(52.5, 52.5, 0.0));
    let left = of_share(1.0).mesh().within(&low, &high).unwrap();
    let left = left.element_count() as f64 / elements;
    assert!((nearer.elements - left).abs() < 1e-12, "{nearer:?} {left}");
    assert!(left < 0.6 && found[1] / elements < left, "{left}");
    assert!((found[0] / steps - nearer.steps).abs() < 0.05);
    let error = nearer.error.share.unwrap();
    assert!(error > 0.0 && error < 1.0);
    let soft = ElasticMedium {
        poisson: 0.49,
        ..ROCK
    };
    let report = check(of_ground(1.0, soft)).unwrap();
    let nearer = of(&report.savings, is_nearer);
    assert!(
        nearer.error.share.is_none() && nearer.error.source.contains("takes longer than the run"),
        "{nearer:?}"
    );
}

/// A changed scene file has the predicted number of steps: flat damping in place of Rayleigh damping.
#[test]
fn changes_of_a_file_save_as_predicted() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/scenes/cavern_small.toml"
    );
    let text = std::fs::read_to_string(path).unwrap();
    let damped = |damping: &str| {
        let text = text.replace("kernel = \"hex8-full\"", damping);
        FileScene::from_toml(text, path, &Registry::default()).unwrap()
    };
    let rayleigh =
        || damped("damping = { kind = \"rayleigh\", ratio = 0.05, frequencies = [1, 10] }");
    let savings = check(rayleigh()).unwrap().savings;
    let flat = of(&savings, |change| *change == Change::FlatDamping);
    let found = counts(damped(
        "damping = { kind = \"flat\", ratio = 0.05, band = [1, 10] }",
    ))[0];
    let found = found / counts(rayleigh())[0];
    assert!((found / flat.steps - 1.0).abs() < 0.01, "{found} {flat:?}");
    assert!(
        flat.steps < 0.9 && flat.error.share.unwrap() < 0.2,
        "{flat:?}"
    );
}

/// Of a slice under waves along it no change is tried that it refuses: single precision, fibres, flat damping.
#[test]
fn what_a_slice_refuses_is_not_proposed() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/scenes/tunnel_along.toml"
    );
    let scene = FileScene::from_file(path).unwrap();
    assert!(scene.slowness_along_y() > 0.0);
    let report = check(scene).unwrap();
    assert!(report.refused.is_empty(), "{:?}", report.refused);
    let is_other = |saving: &Saving| {
        let refused = [Change::Mixed, Change::Fibres, Change::FlatDamping];
        !refused.contains(&saving.change)
    };
    assert!(report.savings.iter().all(is_other), "{:?}", report.savings);
}

/// Stages that are completed during the timing have their measured time and corrections; their memory is more than that
/// of the run.
#[test]
fn short_stages_are_known_not_predicted() {
    let staged = || {
        let mut mesh = ground(1.0);
        let (low, high) = (Vec3::new(20.0, 20.0, -20.0), Vec3::new(40.0, 40.0, 0.0));
        let pit = mesh.elements_in_box(&low, &high);
        mesh.set_element_set("pit", pit).unwrap();
        let nodes = mesh.nodes_of_facets(mesh.facet_set("bottom").unwrap());
        scene(mesh, &SIDES)
            .part(Part::new("rock", rock()))
            .gravity(Vec3::new(0.0, 0.0, -9.81), |_: f64| 1.0)
            .stage(SceneStage::new("ground").support(Support::fixed(nodes)))
            .stage(
                SceneStage::new("pit")
                    .excavate("pit")
                    .with_options(StaticOptions::default().with_increments(2)),
            )
    };
    let body = staged().prepare().unwrap().equilibrate(None, None);
    let body = body.unwrap().unwrap();
    let corrections: u32 = (body.stages().iter())
        .map(|stage| stage.solution.corrections)
        .sum();
    assert_eq!(corrections, 3);
    let cost = check(staged()).unwrap().cost;
    let stages = cost.stages.unwrap();
    assert_eq!(
        (stages.uncertainty, stages.timed, stages.corrections),
        (1.0, 3, 3)
    );
    assert!(stages.unknown.is_empty() && stages.memory > cost.memory);
    assert!(
        check(scene(ground(0.5), &SIDES).part(Part::new("rock", rock())))
            .unwrap()
            .cost
            .stages
            .is_none()
    );
}
