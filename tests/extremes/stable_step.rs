//! Long runs at the reported step, and runs just beyond the limit.

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse_boundary::{AxisParameters, InputMode, ViscousSpring};
use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions, TiedPairs,
    pair_nodes,
};
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::media;
use powerhouse_model::{ElementKind, Mesh, RunError, RunOptions, StepChoice, Vec3};
use powerhouse_tests::{Ground, elastic};

const SIZE: Vec3 = Vec3::new(10.0, 8.0, 6.0);
const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];

/// A pseudo-random number from -1 to 1 from an index.
pub(crate) fn scatter(index: usize) -> f64 {
    let x = (index as f64 * 12.9898 + 0.37).sin() * 43758.547;
    2.0 * (x - x.floor()) - 1.0
}

/// A small box of elements of very different shapes.
fn irregular(kernel: SolidKernel) -> Ground {
    let mut ground = Ground::boxed(SIZE, [5, 4, 3], media::ROCK, kernel).mapped(|p| {
        let bend = |a: f64, b: f64| 0.35 * (1.3 * a + 0.7 * b).sin();
        Vec3::new(
            p.x + bend(p.y, p.z),
            p.y + bend(p.z, p.x),
            p.z * (1.0 + 0.05 * p.x),
        )
    });
    ground.threads = Some(1);
    ground
}

/// Gives every node a random velocity of at most 1 m/s along each axis.
fn shake(model: &mut Model) {
    let nodes = model.mesh().node_count();
    let random = |i: usize| Vec3::new(scatter(3 * i), scatter(3 * i + 1), scatter(3 * i + 2));
    let velocity: Vec<Vec3> = (0..nodes).map(random).collect();
    model
        .set_initial(&vec![Vec3::zeros(); nodes], &velocity)
        .unwrap();
}

fn fastest(model: &Model) -> f64 {
    let nodes = 0..model.mesh().node_count() as u32;
    nodes
        .map(|node| model.velocity(node).norm())
        .fold(0.0, f64::max)
}

fn run_for(model: &mut Model, steps: u64, step: StepChoice) -> Result<(), RunError> {
    let options = RunOptions::steps(steps).with_step(step);
    run(model, &Leapfrog, &options, &mut [], &mut |_| {}).map(|_| ())
}

/// At the reported step the motion from random velocities stays bounded over a hundred thousand steps without
/// damping, for every kernel.
///
/// All energy can concentrate at one node at most for a moment; a growth of one part in a thousand per thousand
/// steps would be detected.
#[test]
fn the_reported_step_is_stable() {
    for kernel in SolidKernel::ALL {
        let ground = irregular(kernel);
        let mut model = ground.free().build().unwrap();
        shake(&mut model);
        run_for(&mut model, 100_000, StepChoice::Stable).unwrap();
        assert!(
            fastest(&model) < 20.0,
            "{}: {}",
            kernel.name(),
            fastest(&model)
        );
    }
}

/// At 1.01 of the limit the motion grows without bound; the run is stopped at the step where it
/// happens, naming an element and its set.
#[test]
fn a_step_beyond_the_limit_is_stopped() {
    for kernel in SolidKernel::ALL {
        let ground = irregular(kernel);
        let mut model = ground.free().build().unwrap();
        let limit = model.stable_step(&Leapfrog).unwrap().assembled_limit;
        assert!(run_for(&mut model, 1, StepChoice::Fixed(1.01 * limit)).is_err());
        shake(&mut model);
        let error = run_for(&mut model, 20_000, StepChoice::Unchecked(1.01 * limit)).unwrap_err();
        let RunError::Diverged {
            step, element, set, ..
        } = error
        else {
            panic!("{}: {error}", kernel.name());
        };
        assert!(step > 0 && step < 20_000);
        assert!(ground.mesh.element_tags().contains(&element));
        assert_eq!(set, "ground");
    }
}

/// Springs and dashpots of a boundary do not reduce the time step, even ten times too stiff and close to the
/// scatterer: they are implicit at their node.
#[test]
fn boundaries_cost_no_step() {
    let ground = irregular(SolidKernel::Hex8OnePoint(Default::default()));
    let free = ground
        .free()
        .build()
        .unwrap()
        .stable_step(&Leapfrog)
        .unwrap();
    let strong = AxisParameters::new(0.0, 10.0, Some(0.01)).unwrap();
    let boundary = ViscousSpring {
        axes: [strong; 3],
        input: InputMode::Nothing,
        ..ViscousSpring::default()
    };
    let mut model = ground
        .with_boundary(&boundary, &FACES, None)
        .build()
        .unwrap();
    assert_eq!(model.stable_step(&Leapfrog).unwrap().step, free.step);
    shake(&mut model);
    run_for(&mut model, 100_000, StepChoice::Stable).unwrap();
    assert!(fastest(&model) < 1.0, "{}", fastest(&model));
}

/// A tie between a light, soft body and a heavy, stiff one does not reduce the step, and never opens.
#[test]
fn ties_cost_no_step() {
    // Two boxes of 2 x 2 x 2 bricks that touch in the plane z = 1 with nodes of their own.
    let mut builder = Mesh::builder();
    let tag = |body: u64, x: u64, y: u64, z: u64| 1 + 27 * body + x + 3 * y + 9 * z;
    for body in 0..2 {
        for z in 0..3 {
            for y in 0..3 {
                for x in 0..3 {
                    let height = 0.5 * z as f64 + body as f64;
                    let position = Vec3::new(0.5 * x as f64, 0.5 * y as f64, height);
                    builder.node(tag(body, x, y, z), position);
                }
            }
        }
        for cell in 0..8 {
            let (x, y, z) = (cell % 2, cell / 2 % 2, cell / 4);
            let ring = |z| {
                [
                    tag(body, x, y, z),
                    tag(body, x + 1, y, z),
                    tag(body, x + 1, y + 1, z),
                    tag(body, x, y + 1, z),
                ]
            };
            let nodes = [ring(z), ring(z + 1)].concat();
            let set = ["soft", "stiff"][body as usize];
            builder.element(1 + 8 * body + cell, ElementKind::Hex8, &nodes, &[set]);
        }
    }
    let mesh = builder.build().unwrap();
    let soft = powerhouse_model::ElasticMedium::new(1.0e7, 0.3, 20.0).unwrap();
    let side = |body: u64, z: u64| -> Vec<u32> {
        let first = tag(body, 0, 0, z) as u32 - 1;
        (first..first + 9).collect()
    };
    let pairing = pair_nodes(&mesh, &side(0, 2), &side(1, 0), 1e-6).unwrap();
    assert_eq!(pairing.pairs.len(), 9);
    let build = |tied: bool| {
        let kernel = SolidKernel::Hex8OnePoint(Default::default());
        let factory = |set, medium| elastic(set, kernel, medium, Default::default());
        let mut builder = Model::builder(&mesh)
            .elements("soft", factory("soft", soft))
            .elements("stiff", factory("stiff", media::CONCRETE))
            .threads(1);
        if tied {
            let tie = TiedPairs::new("tie", &pairing.pairs).unwrap();
            builder = builder.constraint(Box::new(tie));
        }
        builder.build().unwrap()
    };
    let apart = build(false).stable_step(&Leapfrog).unwrap().step;
    let mut model = build(true);
    let together = model.stable_step(&Leapfrog).unwrap().step;
    assert!((together - apart).abs() < 1e-9 * apart);
    shake(&mut model);
    run_for(&mut model, 100_000, StepChoice::Stable).unwrap();
    assert!(fastest(&model) < 20.0, "{}", fastest(&model));
    for [i, j] in pairing.pairs {
        assert_eq!(model.velocity(i), model.velocity(j));
        // The displacements differ at most by the rounding of the first step, permanently.
        assert!((model.displacement(i) - model.displacement(j)).norm() < 1e-15);
    }
}

/// A joint costs no step: that of two blocks with any joint between them is the one without, to the
/// last bit; and at that step a hundred thousand steps through cracks, slip and impacts stay bounded.
#[test]
fn joints_cost_no_step() {
    let kernel = SolidKernel::Hex8OnePoint(Default::default());
    let ground = irregular(kernel);
    let stable = |model: &mut Model| model.stable_step(&Leapfrog).unwrap();
    let whole = stable(&mut ground.free().build().unwrap());
    let below = |&e: &u32| e < ground.mesh.element_count() as u32 * 2 / 3;
    let (lower, upper): (Vec<u32>, Vec<u32>) =
        (0..ground.mesh.element_count() as u32).partition(below);
    let split = ground.mesh.split_between(&lower, &upper).unwrap();
    let options = SurfaceOptions::within(1e-6).unwrap();
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options);
    let surface = surface.unwrap();
    let build = |strength: Option<f64>| {
        let factory = elastic("ground", kernel, media::ROCK, Default::default());
        let all: Vec<u32> = (0..split.mesh.element_count() as u32).collect();
        let mut builder = Model::builder(&split.mesh)
            .elements(all, factory)
            .threads(1);
        if let Some(strength) = strength {
            let law = BondedCoulomb::new(BondedCoulombParameters {
                cohesion: strength,
                tensile_strength: strength,
                static_friction: 0.7,
                dynamic_friction: 0.5,
                cohesion_loss: true,
            });
            let joint = Joint::new("cut", surface.pairs.clone(), law.unwrap()).unwrap();
            builder = builder.constraint(Box::new(joint));
        }
        builder.build().unwrap()
    };
    let open = stable(&mut build(None));
    // What is cut moves more freely: its limit may fall, but not below that of a single element,
    // which no assembled limit exceeds 1.7 times.
    assert!(open.step > whole.step / 1.7, "{} {}", open.step, whole.step);
    for strength in [0.0, 1e5, f64::INFINITY] {
        let mut model = build(Some(strength));
        let found = stable(&mut model);
        assert_eq!((found.step, found.element), (open.step, open.element));
        shake(&mut model);
        run_for(&mut model, 100_000, StepChoice::Stable).unwrap();
        assert!(fastest(&model) < 20.0, "{strength}: {}", fastest(&model));
        let joint = model.joints().next().unwrap();
        let slid = joint.records.iter().any(|r| r.first_slip.is_some());
        assert_eq!(slid, strength < f64::INFINITY);
    }
}
