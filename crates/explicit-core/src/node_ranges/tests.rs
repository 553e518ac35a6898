//! What the engine sums over a body has the same bits in any order of its ranges and for any number of threads.

use powerhouse_elements::{NodalForce, SolidKernel};
use powerhouse_model::{
    BlockEnergy, BlockOptions, BoundaryParts, Constant, ConstitutiveLaw, Constraint,
    ConstraintWork, ElasticMedium, EnergyCheck, HistoryVariable, Lane, LawInput, Mat3, Mesh,
    ModelSpec, NodalImpedance, PredictedMotion, Prescribed, Rayleigh, RunError, RunOptions,
    StaticMethod, StaticOptions, Stress, Support, Vec3,
};

use super::NodeRanges;
use crate::gather::SlotTable;
use crate::ledger::total_energy;
use crate::ranks::Communicator;
use crate::{BuildModel, Leapfrog, Model, run};

impl NodeRanges {
    /// The same ranges in another order.
    fn shuffled(&self, seed: u64) -> Self {
        let mut all = self.0.clone();
        shuffle(&mut all, seed);
        Self(all)
    }
}

fn shuffle<T>(all: &mut [T], seed: u64) {
    let mut state = seed;
    for last in (1..all.len()).rev() {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        all.swap(last, (state >> 33) as usize % (last + 1));
    }
}

/// Elastic at first, softer with the largest norm of strain so far.
#[derive(Clone)]
struct Softening(ElasticMedium);

impl ConstitutiveLaw for Softening {
    fn name(&self) -> &str {
        "softening"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &'static [HistoryVariable] {
        const { &[HistoryVariable::amount("largest_strain", "1")] }
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new: &mut [L]) -> Stress<L> {
        let any = input.strain.0[0];
        let mut square = any.constant(0.0);
        for strain in input.strain.0 {
            square = strain.mul_add(strain, square);
        }
        new[0] = input.history[0].max(square.sqrt());
        let kept = any.constant(1e-3) / (new[0] + any.constant(1e-3));
        let (lambda, shear) = (self.0.lambda(), self.0.shear());
        Stress::elastic(any.constant(lambda), any.constant(shear), &input.strain) * kept
    }
}

/// Holds two nodes together.
struct Glue([u32; 2]);

impl Constraint for Glue {
    fn name(&self) -> &str {
        "glue"
    }
    fn nodes(&self) -> &[u32] {
        &self.0
    }
    fn correct(&mut self, motion: PredictedMotion) -> Result<ConstraintWork, RunError> {
        let compliance = motion.inverse_mass[0] + motion.inverse_mass[1];
        let gap = motion.velocity[1] - motion.velocity[0];
        let impulse = compliance.try_inverse().unwrap_or_default() * gap;
        motion.velocity[0] += motion.inverse_mass[0] * impulse;
        motion.velocity[1] -= motion.inverse_mass[1] * impulse;
        let before = motion.previous[1] - motion.previous[0];
        let after = motion.velocity[1] - motion.velocity[0];
        Ok(ConstraintWork::default().with_impact(0.5 * impulse.dot(&(before + after))))
    }
}

/// A box of 480 bricks without equal edges.
fn uneven_box() -> Mesh {
    let size = Vec3::new(20.0, 16.0, 12.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [10, 8, 6], "rock").unwrap();
    let wave = |p: Vec3| 0.2 * Vec3::new(p.y.sin(), (1.3 * p.z).sin(), (0.7 * p.x).sin());
    mesh.map_positions(|p| p + wave(p)).unwrap()
}

/// The nodes of a facet set.
fn face(mesh: &Mesh, name: &str) -> Vec<u32> {
    mesh.nodes_of_set(name).unwrap()
}

/// The body in twelve blocks, with mass damping.
fn body(mesh: &Mesh, threads: usize) -> ModelSpec<'_> {
    let rock = Softening(ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap());
    let mut options = BlockOptions::default();
    options.damping = Rayleigh {
        mass: 5.0,
        stiffness: 0.0,
    };
    let rock = SolidKernel::ONE_POINT.factory("rock", rock, options);
    Model::builder(mesh)
        .elements("rock", rock)
        .threads(threads)
        .block_size(40)
}

/// A body with every kind of nodal work: loads, dashpots, springs, a prescribed motion, rollers and a constraint.
fn shaken(mesh: &Mesh, threads: usize) -> Model {
    let impedance = ["left", "right"].map(|name| face(mesh, name)).concat();
    let impedance = impedance.iter().map(|&node| {
        let spring = Mat3::new(3e7, 1e6, 0.0, 1e6, 2e7, 0.0, 0.0, 0.0, 1e7);
        NodalImpedance::new(node, spring, spring * 0.02)
    });
    let pulse = |t: f64| (900.0 * t).sin();
    let (front, top) = (face(mesh, "front"), face(mesh, "top"));
    body(mesh, threads)
        .boundary(BoundaryParts::default().with_impedance(impedance))
        .support(Support::roller(front, Vec3::y()))
        .load(Box::new(NodalForce::new(
            top,
            Vec3::new(1e6, 2e5, -3e6),
            Box::new(pulse),
        )))
        .gravity(Vec3::new(0.0, 0.0, -9.81), Box::new(Constant(1.0)))
        .prescribed(Prescribed {
            nodes: face(mesh, "bottom"),
            direction: Vec3::z(),
            displacement: Box::new(|t: f64| 1e-4 * (1.0 - (400.0 * t).cos())),
        })
        .constraint(Box::new(Glue([300, 390])))
        .build()
        .unwrap()
}

/// Names and values of the highest eigenvalue and of all energies of a short run.
fn dynamic_results(mesh: &Mesh, threads: usize, seed: Option<u64>) -> Vec<(String, f64)> {
    let mut model = shaken(mesh, threads);
    assert!(model.block_count() >= 12 && model.subdomain.node_ranges.ranges().len() >= 12);
    if let Some(seed) = seed {
        model.subdomain.node_ranges = model.subdomain.node_ranges.shuffled(seed);
    }
    let highest = model.in_pool(|model| model.highest_eigenvalue(|_| 1.0));
    let check = EnergyCheck::every(3).with_by_set(true);
    let options = RunOptions::steps(60).with_energy(check);
    let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    assert!(report.energy_residual < 1e-12, "{}", report.energy_residual);
    let energies = report.energies.iter();
    let mut found: Vec<(String, f64)> = energies.map(|&(name, e)| (name.into(), e)).collect();
    found.extend([
        ("eigenvalue".into(), highest.value),
        ("bound of the eigenvalue".into(), highest.residual),
        ("largest residual".into(), report.energy_residual),
    ]);
    found
}

/// Names and values of static solutions: accelerated corrections by conjugate gradients, and dynamic relaxation.
fn static_results(mesh: &Mesh, threads: usize, seed: Option<u64>) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    for method in [
        StaticMethod::ConjugateGradients,
        StaticMethod::DynamicRelaxation,
    ] {
        let mut model = body(mesh, threads)
            .support(Support::fixed(face(mesh, "bottom")))
            .gravity(Vec3::new(3.0, 2.0, -9.81), Box::new(Constant(20.0)))
            .build()
            .unwrap();
        if let Some(seed) = seed {
            model.subdomain.node_ranges = model.subdomain.node_ranges.shuffled(seed);
        }
        let options = (StaticOptions::default())
            .with_method(method)
            .with_tolerance(1e-5);
        let report = model.equilibrate(&options, &mut |_| {}).unwrap();
        assert!(report.corrections > 2 || report.steps > 100, "{report:?}");
        let carried = model.hand_over(1.0).unwrap().carried_forces;
        found.extend([
            (format!("{method:?} load"), report.load),
            (format!("{method:?} residual"), report.residual),
            (format!("{method:?} carried"), carried),
        ]);
        let displacement = model.displacements();
        let components = displacement.iter().flat_map(|u| [u.x, u.y, u.z]);
        found.extend(components.map(|u| (format!("{method:?} displacement"), u)));
    }
    found
}

/// Fails unless all results have the same bits for one, two and four threads and in several orders of the ranges.
fn check(results: impl Fn(usize, Option<u64>) -> Vec<(String, f64)>) {
    let expected = results(1, None);
    assert!(expected.iter().any(|(_, value)| *value != 0.0));
    for (threads, seed) in [
        (2, None),
        (4, None),
        (1, Some(1)),
        (2, Some(2)),
        (4, Some(3)),
    ] {
        let found = results(threads, seed);
        assert_eq!(found.len(), expected.len());
        for ((name, found), (_, expected)) in found.iter().zip(&expected) {
            let same = found.to_bits() == expected.to_bits();
            assert!(same, "{threads} {seed:?} {name}: {found:e} {expected:e}");
        }
    }
}

/// The highest eigenvalue (Lanczos method) and every column of the energies have the same bits for any number of threads
/// and any order of the ranges.
#[test]
fn eigenvalue_and_energies_do_not_depend_on_the_order_of_ranges() {
    let mesh = uneven_box();
    let found = dynamic_results(&mesh, 1, None);
    for name in [
        "kinetic",
        "time step",
        "mass damping",
        "dashpots",
        "springs",
        "impact",
        "loads",
        "prescribed motion",
    ] {
        let column = found.iter().find(|(other, _)| other == name).unwrap();
        assert!(column.1 != 0.0, "{name} is not in the balance");
    }
    check(|threads, seed| dynamic_results(&mesh, threads, seed));
}

/// Static equilibria have the same bits for any number of threads and any order of the ranges.
#[test]
fn static_equilibria_do_not_depend_on_the_order_of_ranges() {
    let mesh = uneven_box();
    check(|threads, seed| static_results(&mesh, threads, seed));
}

/// The energies of blocks add up to the same bits in any order.
#[test]
fn energies_of_blocks_do_not_depend_on_their_order() {
    let energy = |block: usize| {
        let of = |column: usize| ((17 * block + column) as f64).sin().powi(5);
        let mut energy = BlockEnergy::elastic(of(0));
        energy.hourglass = of(1);
        energy.plastic = of(2);
        energy.damage = of(3);
        energy.recovery = -of(4);
        energy.integration = of(5);
        energy.damping = of(6);
        energy.relaxation = of(7);
        energy.bending = of(8);
        energy
    };
    let mut blocks: Vec<BlockEnergy> = (0..100).map(energy).collect();
    let expected = total_energy(blocks.iter(), &Communicator::default());
    let mut plain = BlockEnergy::default();
    blocks.iter().for_each(|energy| plain += *energy);
    for (found, plain) in [
        (expected.elastic, plain.elastic),
        (expected.hourglass, plain.hourglass),
        (expected.plastic, plain.plastic),
        (expected.damage, plain.damage),
        (expected.recovery, plain.recovery),
        (expected.integration, plain.integration),
        (expected.damping, plain.damping),
        (expected.relaxation, plain.relaxation),
        (expected.bending, plain.bending),
    ] {
        assert!(found != 0.0 && (found - plain).abs() < 1e-13);
    }
    for seed in 0..5 {
        shuffle(&mut blocks, seed);
        assert_eq!(
            total_energy(blocks.iter(), &Communicator::default()),
            expected
        );
    }
}

/// Ranges are those that the blocks own, in pieces that start anew with each block.
#[test]
fn ranges_are_those_of_the_blocks() {
    let blocks: [&[u32]; 3] = [&[0, 1, 2], &[3, 4, 2], &[5, 3, 0]];
    let slots = SlotTable::new(6, blocks.into_iter());
    let found = NodeRanges::of_blocks(&slots, &[3, 3, 3]);
    assert_eq!(found.ranges(), [0..3, 3..5, 5..6]);
    let found = NodeRanges::new([0..5000, 5000..5001, 5001..9097]);
    let expected = [0..4096, 4096..5000, 5000..5001, 5001..9097];
    assert_eq!(found.ranges(), expected);
}
