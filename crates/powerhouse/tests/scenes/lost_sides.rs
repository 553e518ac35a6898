//! Joints with one side excavated, which carry no traction any more.

use powerhouse::contact::{BondedCoulomb, BondedCoulombParameters, JointSurface, SurfaceOptions};
use powerhouse::engine::observe::Motion;
use powerhouse::engine::{NodalForce, StaticMethod, StaticOptions, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::{
    EquilibratedBody, Material, OutputPlan, Part, RunHooks, Scene, SceneJoint, SceneStage, TimeStep,
};

use super::support::*;

/// Height of the joint, and of the body (m).
const SEAM: f64 = 6.0;
const TOP: f64 = 10.0;

/// Corner of the body that is recorded in the run.
const CORNER: Vec3 = Vec3::new(12.0, 4.0, TOP);

/// Blocks of 12 m by 4 m up to a height, supported on the left.
fn scene(mesh: Mesh, sets: &[&str]) -> Scene {
    let held = mesh.nodes_in_box(&Vec3::new(0.0, 0.0, 0.0), &Vec3::new(0.0, 4.0, TOP));
    let top = mesh.nodes_in_box(&CORNER, &CORNER);
    let push = NodalForce::new(
        top,
        Vec3::new(0.0, 2e5, 1e5),
        Box::new(|time: f64| (200.0 * time).sin()),
    );
    let mut output = OutputPlan::default().history("corner", CORNER, Motion::ALL);
    output.every = 1e-3;
    let scene = Scene::new("lost side", mesh)
        .gravity(Vec3::new(0.0, 0.0, -9.81), |_: f64| 1.0)
        .support(Support::fixed(held))
        .load(push)
        .with_duration(0.06)
        .with_output(output);
    sets.iter().fold(scene, |scene, set| {
        scene.part(Part::new(*set, Material::from(LinearElastic::new(ROCK))))
    })
}

/// The body above the joint alone.
fn upper() -> Scene {
    let (low, high) = (Vec3::new(0.0, 0.0, SEAM), CORNER);
    let mesh = Mesh::box_of_hexes(low, high, [6, 2, 2], "upper").unwrap();
    let stage = SceneStage::new("ground").with_options(exact());
    scene(mesh, &["upper"]).stage(stage)
}

fn exact() -> StaticOptions {
    StaticOptions::default().with_tolerance(1e-10)
}

/// Both bodies, the lower one excavated in a second stage in which the joint may be closed.
fn opened(options: StaticOptions, closed: bool) -> Scene {
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), CORNER, [6, 2, 5], "rock").unwrap();
    let all = 0..mesh.element_count() as u32;
    let (lower, upper): (Vec<u32>, Vec<u32>) = all.partition(|&e| mesh.centroid(e).z < SEAM);
    mesh.set_element_set("lower", lower.clone()).unwrap();
    mesh.set_element_set("upper", upper.clone()).unwrap();
    let split = mesh.split_between(&lower, &upper).unwrap();
    let tolerance = SurfaceOptions::within(1e-6).unwrap();
    let surface =
        JointSurface::between(&split.mesh, &split.first, &split.second, &tolerance).unwrap();
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 1e9,
        tensile_strength: 1e9,
        static_friction: 0.8,
        dynamic_friction: 0.6,
        cohesion_loss: true,
    });
    let stage = SceneStage::new("opening")
        .excavate("lower")
        .with_options(options);
    let stage = if closed { stage.tie("seam") } else { stage };
    scene(split.mesh, &["lower", "upper"])
        .joint(SceneJoint::new("seam", surface, law.unwrap()))
        .stage(SceneStage::new("ground").with_options(exact()))
        .stage(stage)
}

fn at_rest(scene: Scene) -> EquilibratedBody {
    let rested = scene.prepare().unwrap().equilibrate(None, None);
    rested.unwrap().unwrap()
}

/// Displacement of the corner in static equilibrium.
fn sag(scene: Scene) -> Vec3 {
    let corner = scene.mesh().nodes_in_box(&CORNER, &CORNER)[0];
    at_rest(scene).state().displacement[corner as usize]
}

/// With either method, for a closed or bonded joint, the upper body deforms as if it had always been alone; with a release
/// factor of one half, half as much.
#[test]
fn an_excavated_side_bears_nothing_at_rest() {
    let expected = sag(upper());
    assert!(expected.z < -1e-5, "{expected}");
    let relaxed = exact().with_method(StaticMethod::DynamicRelaxation);
    for options in [exact(), relaxed, relaxed.with_increments(3)] {
        for closed in [true, false] {
            let found = sag(opened(options, closed));
            let error = (found - expected).norm() / expected.norm();
            assert!(error < 1e-6, "{options:?} {closed}: {error:e}");
        }
    }
    let half = |options: StaticOptions| sag(opened(options.with_release(0.5), true));
    let (by_gradients, by_relaxation) = (half(exact()), half(relaxed));
    let apart = (by_gradients - by_relaxation).norm() / expected.norm();
    assert!(apart < 1e-6, "{apart:e}");
    assert!((by_gradients - expected).norm() > 0.1 * expected.norm());
}

/// In the run the excavated side carries nothing either: with one step for both bodies, their motions are equal.
#[test]
fn an_excavated_side_holds_nothing_in_motion() {
    let motion = |scene: Scene| {
        let scene = scene.with_step(TimeStep::Seconds(1e-4));
        let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
        let column = |name: &str| results.histories().column(name).unwrap().values.clone();
        ["corner.vy", "corner.vz"].map(column)
    };
    let (alone, opened) = (motion(upper()), motion(opened(exact(), true)));
    for (alone, opened) in alone.iter().zip(&opened) {
        let most = alone.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        assert!(most > 1e-4, "{most:e}");
        for (a, b) in alone.iter().zip(opened) {
            assert!((a - b).abs() < 1e-6 * most, "{a:e} {b:e} {most:e}");
        }
    }
}
