//! Joints do not know how the body lies in space.

use core::f64::consts::TAU;

use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_explicit_core::{
    BlockOptions, EnergyCheck, Leapfrog, Model, NodalForce, Rayleigh, RunOptions, SolidKernel,
    StepChoice, Support, run,
};
use powerhouse_material_damage::media;
use powerhouse_model::{BoundaryParts, Mat3, Mesh, NodalImpedance, Vec3};
use powerhouse_tests::elastic;

/// Two blocks of rock on each other with a bond that cracks and then rubs, dashpots on all nodes of
/// one side face, Rayleigh damping, pressed together and shaken; the whole of it turned. Returns
/// displacements turned back.
fn blocks(turn: &Mat3) -> Vec<Vec3> {
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
    let joint = Joint::new("joint", surface.pairs, law).unwrap();
    let mut dampers = BoundaryParts::default();
    for (node, p) in straight.iter().enumerate().filter(|(_, p)| p.x == 0.0) {
        let along = (turn * Vec3::new(1.0, 0.4, 0.3)).normalize();
        dampers.impedance.push(NodalImpedance {
            node: node as u32,
            spring: Mat3::zeros(),
            dashpot: along * along.transpose() * (1e5 * (1.0 + p.z)),
        });
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
    let mut model = Model::builder(&mesh)
        .elements("rock", elastic("rock", kernel, media::ROCK, block))
        .boundary(dampers)
        .support(Support::fixed(level(0.0)))
        .load(force(-Vec3::z(), 5e4, 0.6, 12.0))
        .load(force(Vec3::new(1.0, 0.3, 0.0), 3e4, 0.0, 7.0))
        .constraint(Box::new(joint))
        .threads(1)
        .build()
        .unwrap();
    let options = RunOptions::steps(2_000)
        .with_step(StepChoice::Fixed(1e-4))
        .with_energy(EnergyCheck::every(20));
    let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
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
    (0..straight.len() as u32)
        .map(|node| back * model.displacement(node))
        .collect()
}

/// Turning the whole model, dashpots at an angle and all, turns its motion: to 1e-10 of it, through
/// cracks, slip, opening and impacts.
#[test]
fn a_turned_model_moves_the_same() {
    let straight = blocks(&Mat3::identity());
    let axis = nalgebra::Unit::new_normalize(Vec3::new(0.3, -0.7, 0.5));
    let turn = nalgebra::Rotation3::from_axis_angle(&axis, 1.1).into_inner();
    let turned = blocks(&turn);
    let size = straight.iter().map(|u| u.norm()).fold(0.0, f64::max);
    let differences = straight.iter().zip(&turned).map(|(a, b)| (a - b).norm());
    let worst = differences.fold(0.0, f64::max) / size;
    assert!(worst < 1e-10, "{worst:e}");
}
