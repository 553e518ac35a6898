//! Programs of elements have the bits of their blocks.

use powerhouse_elements::{AnyLaw, SolidKernel};
use powerhouse_material_damage::{
    DampingBand, ElastoPlastic, FlatDamping, LinearElastic, MohrCoulomb, ReferenceFrequency,
    RelaxationSpectrum, media, presets,
};
use powerhouse_model::{
    BlockContext, BlockOptions, BlockPart, ElementKind, Lane, Mesh, NodalView, NodalViewMut,
    NumberFormat, Precision, ProgramError, Quad, Rayleigh, Scalar, StepTime, Stress, Vec3,
};
use powerhouse_program::{Replay, cuda_number};

/// Length of the steps (s).
const STEP: f64 = 1e-4;
/// Steps, of which the last but one turns back.
const STEPS: usize = 5;

/// Deterministic numbers between -1 and 1.
fn noise(index: usize) -> f64 {
    let mut bits = (index as u64).wrapping_add(0x9E37_79B9_7F4A_7C15);
    for factor in [0xBF58_476D_1CE4_E5B9_u64, 0x94D0_49BB_1331_11EB] {
        bits = (bits ^ (bits >> 29)).wrapping_mul(factor);
    }
    (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A box of some 500 elements of a kind: distorted, or with edges along the axes.
fn mesh(kind: ElementKind, distortion: f64) -> Mesh {
    let (generate, cells): (fn(_, _, _, &str) -> _, _) = match kind {
        ElementKind::Hex8 => (Mesh::box_of_hexes, [8, 8, 8]),
        ElementKind::Wedge6 => (Mesh::box_of_wedges, [8, 8, 4]),
        ElementKind::Pyramid5 => (Mesh::box_of_pyramids, [5, 5, 4]),
        _ => (Mesh::box_of_tets, [5, 5, 4]),
    };
    let high = Vec3::from(cells.map(|count| 0.2 * f64::from(count)));
    let cells = cells.map(|count| count as usize);
    let mesh = generate(Vec3::zeros(), high, cells, "rock").unwrap();
    let shift = |x: &Vec3| Vec3::new((9.0 * x.y).sin(), (7.0 * x.z).cos(), (8.0 * x.x).sin());
    let mesh = mesh.map_positions(|x| x + distortion * shift(&x)).unwrap();
    match kind {
        ElementKind::Tet10 => mesh.with_midpoints().unwrap(),
        _ => mesh,
    }
}

/// Integration points, and those of elements of which the history changed.
#[derive(Debug, Default)]
struct Compared {
    points: usize,
    changed: usize,
}

/// Nodal values of an element in a step.
fn nodal(nodes: usize, element: u32, step: usize, size: f64) -> Vec<Quad<f64>> {
    let turn = if step + 1 == STEPS { -1.0 } else { step as f64 };
    let first = 64 * element as usize;
    let values = (0..nodes).map(|node| Vec3::from_fn(|i, _| noise(3 * (first + node) + i)));
    values
        .map(|value| Quad::from_vector(&(value * size * turn)))
        .collect()
}

/// Compares forces and histories of the elements of a mesh, one block for each, with those of the program of the first
/// one, which is that of all.
fn compare<S: Scalar + Lane<Scalar = S, Token = (), Mask = bool>>(
    kernel: SolidKernel,
    law: &AnyLaw,
    options: BlockOptions,
    mesh: &Mesh,
    compared: &mut Compared,
) {
    let block_of = |element: u32| {
        let (elements, nodes) = ([element], mesh.nodes_of(element));
        let part = BlockPart::new(mesh, &elements, nodes);
        let factory = kernel.factory("rock", law.clone(), options);
        let mut block = factory.build(&part).unwrap();
        block.set_initial_stress(&[Stress([-2.0e6, -1.5e6, -1.0e6, 2.0e5, 0.0, -1.0e5])]);
        block
    };
    let program = block_of(0).program(STEP, 1).unwrap();
    let mut replay = Replay::<S>::new(&program).unwrap();
    for element in 0..mesh.element_count() as u32 {
        let nodes = mesh.nodes_of(element);
        let mut block = block_of(element);
        let mut found = vec![S::default(); program.outputs().len()];
        let size = 10.0_f64.powf(-4.0 + 1.25 * noise(element as usize));
        for step in 1..=STEPS {
            let u = nodal(nodes.len(), element, step, size);
            let v = nodal(nodes.len(), element, step, size / STEP);
            let (u, v) = (NodalView::F64(&u), NodalView::F64(&v));
            let inputs = block.programmed().unwrap().program_inputs(0, u, v);
            let inputs: Vec<S> = inputs.into_iter().map(S::from_f64).collect();
            let mut out = vec![Quad::<f64>::default(); nodes.len()];
            let when = StepTime {
                number: step as u64,
                time: step as f64 * STEP,
                step: STEP,
            };
            let context = BlockContext::new(when, u, v);
            block.forces(&context, NodalViewMut::F64(&mut out)).unwrap();
            block.commit();
            replay.run(&inputs, &mut found).unwrap();
            let (forces, history) = found.split_at(3 * nodes.len());
            let case = format!("{} {} {step}: {options:?}", kernel.name(), program.name());
            for (node, force) in out.iter().enumerate() {
                for i in 0..3 {
                    // Nodal forces are sums from zero on, of which none is a negative zero.
                    let sum = 0.0 + forces[3 * node + i].to_f64();
                    let expected = force.values[i];
                    assert_eq!(
                        sum.to_bits(),
                        expected.to_bits(),
                        "{case}: {sum} {expected}"
                    );
                }
            }
            // In the order of the program: point by point, then those of the element.
            let after = block.programmed().unwrap().program_inputs(0, u, v);
            let after = &after[after.len() - history.len()..];
            for (new, committed) in history.iter().zip(after) {
                assert_eq!(new.to_f64().to_bits(), committed.to_bits(), "{case}");
            }
            let before = &inputs[inputs.len() - history.len()..];
            let changed = before.iter().zip(history).any(|(old, new)| old != new);
            compared.points += kernel.points();
            compared.changed += kernel.points() * usize::from(changed);
        }
    }
}

/// Compares all kernels with a law, with and without stiffness damping, in double and single precision, of bricks
/// of any shape and along the axes.
fn check(law: impl Into<AnyLaw>, nonlinear: bool) {
    let law = law.into();
    for kernel in SolidKernel::ALL {
        let mut compared = Compared::default();
        for (stiffness, distortion) in [(0.0, 0.03), (2e-5, 0.03), (2e-5, 0.0)] {
            let mesh = mesh(kernel.kind(), distortion);
            let mut options = BlockOptions::default();
            options.damping = Rayleigh {
                mass: 0.0,
                stiffness,
            };
            compare::<f64>(kernel, &law, options, &mesh, &mut compared);
            options.precision = Precision::Mixed;
            compare::<f32>(kernel, &law, options, &mesh, &mut compared);
        }
        assert!(compared.points >= 15_000, "{} {compared:?}", kernel.name());
        let least = if nonlinear { compared.points / 2 } else { 0 };
        assert!(compared.changed >= least, "{} {compared:?}", kernel.name());
    }
}

fn rock() -> ElastoPlastic<MohrCoulomb> {
    ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK).unwrap())
}

/// Programs of elastic elements have the bits of their blocks.
#[test]
fn programs_of_elastic_elements_have_their_bits() {
    check(LinearElastic::new(media::ROCK), false);
}

/// Programs of elements that yield, crack and relax have the bits of their blocks, in forces and histories, those of the
/// elements as a whole included.
#[test]
fn programs_of_yielding_elements_have_their_bits() {
    check(rock(), true);
    check(presets::paper_concrete().unwrap(), true);
    let band = DampingBand {
        ratio: 0.05,
        lowest: 0.5,
        highest: 20.0,
        mechanisms: 2,
    };
    let spectrum = RelaxationSpectrum::fit(band).unwrap();
    check(
        FlatDamping::new(rock(), spectrum, ReferenceFrequency::Centre).unwrap(),
        true,
    );
}

/// Elements of a law that is evaluated point by point are refused by its name.
#[test]
fn elements_of_a_point_law_are_refused_by_name() {
    use powerhouse_model::{ElasticMedium, HistoryVariable, LawInput, PointAdapter, PointLaw};
    struct Own;
    impl PointLaw for Own {
        fn name(&self) -> &str {
            "own"
        }
        fn medium(&self) -> ElasticMedium {
            media::ROCK
        }
        fn history(&self) -> &'static [HistoryVariable] {
            &[]
        }
        fn stress_change(&self, _input: &LawInput<f64>, _new: &mut [f64]) -> Stress {
            Stress([0.0; 6])
        }
    }
    let mesh = mesh(ElementKind::Hex8, 0.0);
    let nodes = mesh.nodes_of(0).to_vec();
    let part = BlockPart::new(&mesh, &[0], &nodes);
    let law = PointAdapter::new(Own);
    let factory = SolidKernel::Hex8Full.factory("rock", law, BlockOptions::default());
    let block = factory.build(&part).unwrap();
    let law = "own".to_owned();
    assert_eq!(block.program(STEP, 1), Err(ProgramError::OnePoint { law }));
}

/// Numbers of programs in CUDA C keep their sign, those without bound too, and negative ones are in parentheses.
#[test]
fn numbers_keep_their_sign() {
    for (format, suffix) in [(NumberFormat::F64, ""), (NumberFormat::F32, "f")] {
        for (value, text) in [
            (f64::INFINITY, format!("infinity_of(0.0{suffix})")),
            (f64::NEG_INFINITY, format!("(-infinity_of(0.0{suffix}))")),
            (-2.5, format!("(-2.5{suffix})")),
            (2.5, format!("2.5{suffix}")),
        ] {
            assert_eq!(cuda_number(format, value), text);
        }
    }
}
