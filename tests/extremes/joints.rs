//! Joints at the ends of all ranges, in a body.

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse_elements::SolidKernel;
use powerhouse_model::{
    BlockOptions, BoundaryParts, ElasticMedium, EnergyCheck, Mat3, Mesh, NodalImpedance,
    RunOptions, StepChoice, Support, Vec3,
};
use powerhouse_tests::elastic;

/// Two blocks on each other, the upper one so many times as dense and stiff, in some motion. The sides
/// of the joint may have dashpots at an angle that outweigh their mass by a factor.
fn blocks(ratio: f64, strength: f64, friction: f64, dashpot: f64, fixed: bool) -> (Model, f64) {
    let size = Vec3::new(2.0, 2.0, 2.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [2, 2, 4], "all").unwrap();
    let half = |below: bool| -> Vec<u32> {
        let inside = |&e: &u32| (mesh.centroid(e).z < 1.0) == below;
        (0..mesh.element_count() as u32).filter(inside).collect()
    };
    let (lower, upper) = (half(true), half(false));
    let split = mesh.split_between(&lower, &upper).unwrap();
    let options = SurfaceOptions::within(1e-6).unwrap();
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options);
    let pairs = surface.unwrap().pairs;
    let mesh = split.mesh;
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion: strength,
        tensile_strength: strength,
        static_friction: friction,
        dynamic_friction: friction,
        cohesion_loss: true,
    })
    .unwrap();
    let medium = |ratio: f64| ElasticMedium::new(9e9 * ratio, 0.2, 2700.0 * ratio).unwrap();
    let step = 4e-5;
    let along = Vec3::new(1.0, 2.0, -0.5).normalize();
    let mut dampers = BoundaryParts::default();
    for pair in pairs.iter().filter(|_| dashpot > 0.0) {
        for (node, ratio) in pair.nodes.into_iter().zip([1.0, ratio]) {
            // About the mass of the node.
            let mass = 2700.0 * ratio * pair.area * 0.25;
            dampers.impedance.push(NodalImpedance::new(
                node,
                Mat3::zeros(),
                along * along.transpose() * (dashpot * mass / step),
            ));
        }
    }
    let held: Vec<u32> = pairs.iter().map(|pair| pair.nodes[0]).collect();
    let kernel = || SolidKernel::Hex8OnePoint(Default::default());
    let block = BlockOptions::default;
    let mut builder = Model::builder(&mesh)
        .elements(lower, elastic("lower", kernel(), medium(1.0), block()))
        .elements(upper, elastic("upper", kernel(), medium(ratio), block()))
        .boundary(dampers)
        .constraint(Box::new(Joint::new("joint", pairs, law).unwrap()))
        .threads(1);
    if fixed {
        builder = builder.support(Support::fixed(held));
    }
    let mut model = builder.build().unwrap();
    let noise = |p: &Vec3, k: f64| (12.9898 * p.x + 78.233 * p.y + 37.719 * p.z + k).sin();
    let of = |p: &Vec3| Vec3::new(noise(p, 0.1), noise(p, 0.7), noise(p, 1.9));
    let velocity: Vec<Vec3> = mesh.positions().iter().map(of).collect();
    let rest = vec![Vec3::zeros(); velocity.len()];
    model.set_initial(&rest, &velocity).unwrap();
    (model, step)
}

/// For bodies from 1e-6 to 1e6 times as heavy as each other, friction 0 and 10, strength 0 and
/// infinite, one side held, and dashpots at an angle that outweigh the masses a million times, no energy
/// appears and none is lost: the balance closes to 1e-10 of what the motion began with. (The work of a
/// dashpot is known to as many digits less as it outweighs the mass by.)
#[test]
fn joints_keep_their_energy_at_the_ends_of_all_ranges() {
    let mut moved = 0.0_f64;
    for ratio in [1e-6, 1.0, 1e6] {
        for (strength, friction) in [(0.0, 0.0), (0.0, 10.0), (f64::INFINITY, 0.5)] {
            for (dashpot, fixed) in [(0.0, false), (0.0, true), (1.0, false), (1e6, false)] {
                let name = format!("{ratio:e} {strength} {friction} {dashpot:e} {fixed}");
                let (mut model, step) = blocks(ratio, strength, friction, dashpot, fixed);
                let options = RunOptions::steps(1_000)
                    .with_step(StepChoice::Fixed(step))
                    .with_energy(EnergyCheck::every(50));
                let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {});
                let report = report.unwrap_or_else(|error| panic!("{name}: {error}"));
                assert!(
                    report.energy_residual < 1e-10,
                    "{name}: {}",
                    report.energy_residual
                );
                let energy =
                    |name: &str| report.energies.iter().find(|(n, _)| *n == name).unwrap().1;
                assert!(
                    energy("kinetic") <= energy("initial") * (1.0 + 1e-10),
                    "{name}"
                );
                // Velocities turn in every step where a dashpot outweighs the mass; the account is
                // taken between two halves of a step, which then do opposite work.
                let overdamped = dashpot > 1.0;
                let columns = ["friction", "impact", "dashpots"];
                for lost in &columns[..if overdamped { 2 } else { 3 }] {
                    let (lost, initial) = (energy(lost), energy("initial"));
                    assert!(lost > -1e-10 * initial, "{name}: {lost:e} of {initial:e}");
                }
                let nodes = 0..model.mesh().node_count() as u32;
                let speeds = nodes.map(|node| model.velocity(node).norm());
                moved = speeds.fold(moved, f64::max);
                assert!(moved.is_finite(), "{name}");
            }
        }
    }
    assert!(moved > 0.1, "{moved}");
}
