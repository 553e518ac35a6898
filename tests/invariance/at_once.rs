//! Laws that are evaluated for all points of a block at once have the bits of the same laws in lanes.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use powerhouse_elements::{AnyLaw, SolidKernel};
use powerhouse_model::{
    BlockContext, BlockLaw, BlockLawInput, BlockOptions, BlockPart, ConstitutiveLaw, ElasticMedium,
    ElementBlock, ElementKind, HistoryVariable, Lane, LawInput, Mat3, Mesh, NodalView,
    NodalViewMut, Operator, Precision, Quad, StepTime, Stress, Vec3, point_stress_change,
};

/// Damage `k / (k + 1e-3)` by the largest norm `k` of the strain so far; the initial stress over Young's modulus counts
/// as strain.
#[derive(Clone)]
struct Softening(ElasticMedium);

impl ConstitutiveLaw for Softening {
    fn name(&self) -> &str {
        "softening"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &[HistoryVariable] {
        const { &[HistoryVariable::amount("largest_strain", "1")] }
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new: &mut [L]) -> Stress<L> {
        let any = input.strain.0[0];
        let young = any.constant(self.0.young);
        let mut square = any.constant(0.0);
        for i in 0..6 {
            let initial = input.initial.0[i] / young;
            square = input.strain.0[i].mul_add(input.strain.0[i], square);
            square = initial.mul_add(initial, square);
        }
        new[0] = input.history[0].max(square.sqrt());
        let kept = any.constant(1e-3) / (new[0] + any.constant(1e-3));
        let (lambda, shear) = (any.constant(self.0.lambda()), any.constant(self.0.shear()));
        Stress::elastic(lambda, shear, &input.strain) * kept
    }
}

/// The same for all points at once; counts its calls.
struct InBlocks(Softening, Arc<AtomicUsize>);

impl BlockLaw for InBlocks {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn medium(&self) -> ElasticMedium {
        self.0.medium()
    }
    fn history(&self) -> &[HistoryVariable] {
        self.0.history()
    }
    fn stress_changes(&self, points: &BlockLawInput, stresses: &mut [Stress], new: &mut [f64]) {
        self.1.fetch_add(1, Ordering::Relaxed);
        for (point, (stress, new)) in stresses.iter_mut().zip(new.chunks_mut(1)).enumerate() {
            let input = LawInput::new(points.strains[point], points.history_of(point))
                .with_initial(points.initial[point])
                .with_extents(points.extents[point]);
            *stress = point_stress_change(&self.0, &input, new);
        }
    }
}

/// A block of distorted elements of a kernel.
struct Fixture {
    nodes: usize,
    block: Box<dyn ElementBlock>,
}

/// A block with the law in lanes, one with it for all points at once, and the number of its calls.
fn both(kernel: SolidKernel, precision: Precision) -> ([Fixture; 2], Arc<AtomicUsize>) {
    let mesh_of = match kernel.kind() {
        ElementKind::Hex8 => Mesh::box_of_hexes,
        ElementKind::Wedge6 => Mesh::box_of_wedges,
        ElementKind::Pyramid5 => Mesh::box_of_pyramids,
        _ => Mesh::box_of_tets,
    };
    let mesh = mesh_of(Vec3::zeros(), Vec3::repeat(6.0), [3; 3], "rock").unwrap();
    let twisted = |x: Vec3| {
        let (y, z) = ((0.7 * x.y).sin(), (0.9 * x.z).cos());
        x + Vec3::new(0.2 * y * z, 0.2 * (0.8 * x.x).sin() * z, 0.1 * y)
    };
    let mesh = mesh.map_positions(twisted).unwrap();
    let mesh = match kernel.kind() {
        ElementKind::Tet10 => mesh.with_midpoints().unwrap(),
        _ => mesh,
    };
    let mut options = BlockOptions::default();
    options.precision = precision;
    options.damping.stiffness = 1e-5;
    let calls = Arc::new(AtomicUsize::new(0));
    let rock = ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap();
    let in_blocks = AnyLaw::of_blocks(InBlocks(Softening(rock), calls.clone()));
    let fixture = |law: AnyLaw| {
        let nodes: Vec<u32> = (0..mesh.node_count() as u32).collect();
        let elements: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let part = BlockPart::new(&mesh, &elements, &nodes);
        let block = kernel.factory("rock", law, options).build(&part).unwrap();
        let nodes = nodes.len();
        Fixture { nodes, block }
    };
    let lanes = fixture(AnyLaw::new(Softening(rock)));
    ([lanes, fixture(in_blocks)], calls)
}

/// Nodal vectors without order.
fn noise(nodes: usize, seed: u64, amplitude: f64) -> Vec<Quad<f64>> {
    let mut bits = seed;
    let mut next = || {
        bits = bits
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        amplitude * ((bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    };
    (0..nodes)
        .map(|_| Quad::new(next(), next(), next()))
        .collect()
}

impl Fixture {
    fn forces(&mut self, context: &BlockContext) -> Vec<Vec3> {
        let mut out = vec![Quad::default(); self.nodes];
        let found = self.block.forces(context, NodalViewMut::F64(&mut out));
        found.unwrap();
        out.iter().map(|q: &Quad<f64>| q.to_vector()).collect()
    }
    fn stress(&self, u: &[Quad<f64>]) -> Vec<Stress> {
        let mut out = vec![Stress::default(); self.block.elements().len()];
        self.block.add_stress(NodalView::F64(u), &mut out);
        out
    }
}

fn at(number: u64, step: f64) -> StepTime {
    StepTime {
        number,
        time: 0.0,
        step,
    }
}

/// Forces, stresses, energies, histories and saved states are those of lanes, bit by bit, with buffered and in-place
/// updates, initial stress and damping, in dynamic steps and static states; a block is one call.
#[test]
fn a_law_for_a_block_has_the_bits_of_one_in_lanes() {
    for kernel in SolidKernel::ALL {
        let name = kernel.name();
        let ([mut lanes, mut at_once], calls) = both(kernel, Precision::F64);
        let count = lanes.block.elements().len();
        let initial: Vec<Stress> = (0..count)
            .map(|e| Stress([1e5 * e as f64, -3e5, 2e5, 1e4, 0.0, -2e4]))
            .collect();
        lanes.block.set_initial_stress(&initial);
        at_once.block.set_initial_stress(&initial);
        for number in 0..8 {
            let u = noise(lanes.nodes, number, 1e-4 * (1.0 + number as f64));
            let v = noise(lanes.nodes, number + 9, 1e-2);
            // The last two states are static.
            let step = if number < 6 { 1e-4 } else { 0.0 };
            let views = (NodalView::F64(&u), NodalView::F64(&v));
            let context = BlockContext::new(at(number, step), views.0, views.1)
                .with_repeats(number % 2 == 0)
                .with_ledger(number < 6);
            let before = calls.load(Ordering::Relaxed);
            let found = at_once.forces(&context);
            // Elements with strains of their own are brought to equilibrium in static states by several calls.
            let made = calls.load(Ordering::Relaxed) - before;
            assert!(
                made == 1 || (step == 0.0 && made < 40),
                "{name}: {made} calls"
            );
            assert_eq!(found, lanes.forces(&context), "{name}, {number}");
            assert_eq!(at_once.stress(&u), lanes.stress(&u), "{name}, {number}");
            for fixture in [&mut lanes, &mut at_once] {
                fixture.block.commit();
            }
            assert_eq!(at_once.block.history(), lanes.block.history(), "{name}");
            let energies = [&lanes, &at_once].map(|fixture| fixture.block.energy(&context));
            assert_eq!(energies[1], energies[0], "{name}, {number}");
        }
        assert!(at_once.block.history()[0].values.iter().all(|h| *h > 0.0));
        let saved = lanes.block.saved().unwrap().save_state().unwrap();
        assert!(
            at_once.block.saved().unwrap().save_state().unwrap() == saved,
            "{name}"
        );
        let ([_, mut other], _) = both(kernel, Precision::F64);
        other.block.set_initial_stress(&initial);
        other
            .block
            .saved_mut()
            .unwrap()
            .restore_state(&saved)
            .unwrap();
        let (u, v) = (noise(lanes.nodes, 20, 1e-3), noise(lanes.nodes, 21, 0.0));
        let context = BlockContext::new(at(9, 1e-4), NodalView::F64(&u), NodalView::F64(&v));
        assert_eq!(other.forces(&context), lanes.forces(&context), "{name}");
    }
}

/// In mixed precision the law computes in double precision what kernels do in single precision.
#[test]
fn a_law_for_a_block_serves_mixed_precision() {
    let ([mut lanes, mut at_once], _) = both(SolidKernel::Hex8Full, Precision::Mixed);
    let (u, v) = (noise(lanes.nodes, 1, 1e-3), noise(lanes.nodes, 2, 0.0));
    let context = BlockContext::new(at(0, 1e-4), NodalView::F64(&u), NodalView::F64(&v));
    let (expected, found) = (lanes.forces(&context), at_once.forces(&context));
    let norm = |forces: &[Vec3]| forces.iter().fold(0.0_f64, |m, f| m.max(f.norm()));
    let apart: Vec<Vec3> = found.iter().zip(&expected).map(|(a, b)| a - b).collect();
    assert!(norm(&apart) < 1e-5 * norm(&expected));
    assert!(found != expected, "the law computed in single precision");
}

/// Static solutions iterate with the stiffness of the medium, without a call of the law.
#[test]
fn operators_are_those_of_the_medium() {
    let ([_, mut at_once], calls) = both(SolidKernel::Hex8Full, Precision::F64);
    let (u, v) = (noise(at_once.nodes, 1, 1e-2), noise(at_once.nodes, 2, 0.0));
    let context = BlockContext::new(at(0, 0.0), NodalView::F64(&u), NodalView::F64(&v));
    at_once.forces(&context);
    let before = calls.load(Ordering::Relaxed);
    let x = noise(at_once.nodes, 3, 1.0);
    let applied = |operator: Operator| {
        let mut out = vec![Quad::<f64>::default(); x.len()];
        let block = &at_once.block;
        block.apply(operator, NodalView::F64(&x), NodalViewMut::F64(&mut out));
        let mut diagonal = vec![Mat3::zeros(); x.len()];
        block.diagonal(operator, &mut diagonal);
        let vectors: Vec<Vec3> = out.iter().map(|q| q.to_vector()).collect();
        (vectors, diagonal)
    };
    let elastic = applied(Operator::Elastic);
    assert!(elastic.0.iter().any(|force| force.norm() > 0.0));
    assert!(applied(Operator::Secant) == elastic);
    assert!(applied(Operator::Tangent) == elastic);
    assert_eq!(calls.load(Ordering::Relaxed), before);
}
