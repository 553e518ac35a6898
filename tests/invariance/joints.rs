//! Joints do not know how the body lies in space.

use core::f64::consts::TAU;

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_elements::{NodalForce, SolidKernel};
use powerhouse_material_damage::media;
use powerhouse_model::{
    BlockOptions, BoundaryParts, Dynamics, EnergyCheck, ForceTerms, JointRecord, MassDampingRule,
    Mat3, Mesh, NodalImpedance, Rayleigh, RunOptions, RunReport, StepChoice, Support, Vec3,
};
use powerhouse_tests::elastic;

/// Two blocks of rock on each other with a bond that cracks and then rubs, dashpots on all nodes of
/// one side face, Rayleigh damping, pressed together and shaken; the whole of it turned. The joint
/// takes its pairs in their order or backwards.
fn blocks(turn: &Mat3, backwards: bool) -> Model {
    let size = Vec3::new(2.0, 2.0, 4.0);
    let size_z = size.z;
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [3, 3, 6], "rock").unwrap();
    let straight = mesh.clone();
    let half = |below: bool| -> Vec<u32> {
        let inside = |&e: &u32| (straight.centroid(e).z < 2.0) == below;
        (0..straight.element_count() as u32)
            .filter(inside)
            .collect()
    };
    let split = mesh.split_between(&half(true), &half(false)).unwrap();
    let straight = split.mesh.positions().to_vec();
    let mesh = split.mesh.map_positions(|p| turn * p).unwrap();
    let options = SurfaceOptions::within(1e-6).unwrap();
    let surface = JointSurface::between(&mesh, &split.first, &split.second, &options).unwrap();
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: 2e5,
        tensile_strength: 1e5,
        static_friction: 0.6,
        dynamic_friction: 0.4,
        cohesion_loss: true,
    })
    .unwrap();
    let mut pairs = surface.pairs;
    if backwards {
        pairs.reverse();
    }
    let joint = Joint::new("joint", pairs, law).unwrap();
    let mut dampers = BoundaryParts::default();
    for (node, p) in straight.iter().enumerate().filter(|(_, p)| p.x == 0.0) {
        let along = (turn * Vec3::new(1.0, 0.4, 0.3)).normalize();
        dampers.impedance.push(NodalImpedance::new(
            node as u32,
            Mat3::zeros(),
            along * along.transpose() * (1e5 * (1.0 + p.z)),
        ));
    }
    let mut block = BlockOptions::default();
    block.damping = Rayleigh {
        mass: 5.0,
        stiffness: 2e-6,
    };
    let kernel = SolidKernel::Hex8OnePoint(Default::default());
    let level = |z: f64| -> Vec<u32> {
        let at = |node: &u32| straight[*node as usize].z == z;
        (0..straight.len() as u32).filter(at).collect()
    };
    let force = |direction: Vec3, size: f64, constant: f64, frequency: f64| {
        let history = move |t: f64| constant + (TAU * frequency * t).sin();
        let force = turn * direction * size;
        Box::new(NodalForce::new(level(size_z), force, Box::new(history)))
    };
    Model::builder(&mesh)
        .elements("rock", elastic("rock", kernel, media::ROCK, block))
        .boundary(dampers)
        .support(Support::fixed(level(0.0)))
        .load(force(-Vec3::z(), 5e4, 0.6, 12.0))
        .load(force(Vec3::new(1.0, 0.3, 0.0), 3e4, 0.0, 7.0))
        .constraint(Box::new(joint))
        .threads(1)
        .build()
        .unwrap()
}

fn advance(model: &mut Model, steps: u64) -> RunReport {
    let options = RunOptions::steps(steps)
        .with_step(StepChoice::Fixed(1e-4))
        .with_energy(EnergyCheck::every(20));
    run(model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap()
}

/// Displacements of all nodes after 2000 steps, turned back.
fn turned_back(turn: &Mat3) -> Vec<Vec3> {
    let mut model = blocks(turn, false);
    let report = advance(&mut model, 2_000);
    // The joint has done all that it can, and nothing is lost.
    let energy = |name: &str| report.energies.iter().find(|(n, _)| *n == name).unwrap().1;
    let joints: Vec<_> = model.joints().collect();
    let cracked = joints[0]
        .records
        .iter()
        .filter(|r| r.first_crack.is_some())
        .count();
    let slid = joints[0]
        .records
        .iter()
        .filter(|r| r.first_slip.is_some())
        .count();
    assert!(cracked > 4 && slid > 4, "{cracked} {slid}");
    assert!(energy("friction") > 0.0 && energy("impact") > 0.0);
    assert!(report.energy_residual < 1e-10, "{}", report.energy_residual);
    let back = turn.transpose();
    (0..model.mesh().node_count() as u32)
        .map(|node| back * model.displacement(node))
        .collect()
}

/// Turning the whole model, dashpots at an angle and all, turns its motion: to 1e-10 of it, through
/// cracks, slip, opening and impacts.
#[test]
fn a_turned_model_moves_the_same() {
    let straight = turned_back(&Mat3::identity());
    let axis = nalgebra::Unit::new_normalize(Vec3::new(0.3, -0.7, 0.5));
    let turn = nalgebra::Rotation3::from_axis_angle(&axis, 1.1).into_inner();
    let turned = turned_back(&turn);
    let size = straight.iter().map(|u| u.norm()).fold(0.0, f64::max);
    let differences = straight.iter().zip(&turned).map(|(a, b)| (a - b).norm());
    let worst = differences.fold(0.0, f64::max) / size;
    assert!(worst < 1e-10, "{worst:e}");
}

/// The records of the joint's pairs in the order of their nodes.
fn records(model: &Model) -> Vec<([u32; 2], JointRecord)> {
    let joint = model.joints().next().unwrap();
    let mut records: Vec<_> = (joint.pairs.iter().map(|pair| pair.nodes))
        .zip(joint.records.iter().copied())
        .collect();
    records.sort_unstable_by_key(|(nodes, _)| *nodes);
    records
}

/// A run that is stopped at any step, before or after cracks and slip, and goes on in another model
/// from its state has the same bits as one that was never stopped, whatever the order of the pairs
/// there: motion, states, slips, energies and first times of the pairs.
#[test]
fn a_joint_goes_on_from_a_state() {
    let identity = Mat3::identity();
    let mut whole = blocks(&identity, false);
    advance(&mut whole, 1_500);
    let expected = whole.state();
    assert!(
        records(&whole)
            .iter()
            .any(|(_, r)| r.friction > 0.0 && r.bond_energy > 0.0)
    );
    for stop in [0, 1, 400, 1_100] {
        let mut first = blocks(&identity, false);
        if stop > 0 {
            advance(&mut first, stop);
        }
        let mut second = blocks(&identity, true);
        second.set_state(&first.state()).unwrap();
        advance(&mut second, 1_500 - stop);
        let found = second.state();
        assert_eq!(found.displacement, expected.displacement, "{stop}");
        assert_eq!(found.velocity, expected.velocity, "{stop}");
        assert_eq!(records(&second), records(&whole), "{stop}");
    }
}

/// A model that is put back to an earlier state, after steps or in the middle of one, goes the same way
/// again, to the last bit.
#[test]
fn a_joint_goes_the_same_way_again() {
    let mut model = blocks(&Mat3::identity(), false);
    advance(&mut model, 400);
    let state = model.state();
    advance(&mut model, 300);
    let expected = model.state();
    assert_ne!(state.displacement, expected.displacement);
    for unfinished in [false, true] {
        if unfinished {
            model.forces(ForceTerms::PLAIN, 1e-4).unwrap();
            model.kick(MassDampingRule::Implicit, 1e-4).unwrap();
        }
        model.set_state(&state).unwrap();
        advance(&mut model, 300);
        assert_eq!(model.state(), expected, "{unfinished}");
    }
}

/// A body that starts in motion, its sides displaced against each other, sticks where it starts, also
/// if a state is taken before the first step.
#[test]
fn a_state_before_the_first_step_does_not_move_the_joint() {
    let identity = Mat3::identity();
    let moved = |model: &mut Model| {
        let nodes = model.mesh().positions();
        let sheared = |p: &Vec3| Vec3::new(if p.z > 2.0 { 1e-6 } else { 0.0 }, 0.0, 0.0);
        let mut displacement: Vec<Vec3> = nodes.iter().map(sheared).collect();
        // The upper side of the joint moves with its block.
        let upper: Vec<u32> = model
            .joints()
            .flat_map(|j| j.pairs.iter().map(|p| p.nodes[1]))
            .collect();
        for node in upper {
            displacement[node as usize].x = 1e-6;
        }
        let still = vec![Vec3::zeros(); displacement.len()];
        model.set_initial(&displacement, &still).unwrap();
    };
    let mut straight = blocks(&identity, false);
    moved(&mut straight);
    let state = straight.state();
    let mut again = blocks(&identity, false);
    again.set_state(&state).unwrap();
    for model in [&mut straight, &mut again] {
        advance(model, 50);
    }
    assert_eq!(straight.state(), again.state());
    for (_, record) in records(&straight) {
        let [x, y] = record.anchor.unwrap();
        // Along the tangents of the pair, in whatever direction they point.
        assert!((x.hypot(y) - 1e-6).abs() < 1e-18, "{x} {y}");
    }
}
