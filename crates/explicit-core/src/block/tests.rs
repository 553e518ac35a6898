//! What every block must do, whatever its kernel, law, precision and width.

use nalgebra::{DMatrix, SymmetricEigen};
use powerhouse_model::{
    BlockContext, ConstitutiveLaw, ElasticMedium, ElementBlock, ElementFault, ElementKind,
    HistoryVariable, Lane, LawInput, Mat3, Mesh, NodalScalar, NodalView, NodalViewMut, Numbering,
    Operator, Quad, Strain, Stress, Vec3,
};

use crate::{
    BlockOptions, BlockPart, Hex8OnePoint, LaneWidth, Precision, Rayleigh, SolidKernel, solid,
};

/// `lambda tr(e) I + 2 G e`.
#[derive(Clone)]
struct Linear(ElasticMedium);

impl ConstitutiveLaw for Linear {
    const LINEAR: bool = true;

    fn name(&self) -> &str {
        "linear"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &[]
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new: &mut [L]) -> Stress<L> {
        let any = input.strain.0[0];
        Stress::elastic(
            any.constant(self.0.lambda()),
            any.constant(self.0.shear()),
            &input.strain,
        )
    }
}

/// A law with memory: isotropic damage `d = k / (k + 1e-3)` by the largest norm `k` of the strain
/// so far; the norm of the initial stress over a modulus counts as strain.
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
        &[HistoryVariable {
            name: "largest_strain",
            unit: "1",
        }]
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
        let elastic = Stress::elastic(
            any.constant(self.0.lambda()),
            any.constant(self.0.shear()),
            &input.strain,
        );
        elastic * kept
    }
}

fn rock() -> ElasticMedium {
    ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap()
}

/// Repeatable numbers in `[-1, 1]`.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// A box of 3 x 3 x 3 cells of 2 m whose inner nodes, and outer ones within their faces, are moved
/// without order.
fn distorted_box(kind: ElementKind) -> Mesh {
    let (low, high, cells) = (Vec3::zeros(), Vec3::repeat(6.0), [3, 3, 3]);
    let mesh = match kind {
        ElementKind::Hex8 => Mesh::box_of_hexes(low, high, cells, "rock"),
        ElementKind::Wedge6 => Mesh::box_of_wedges(low, high, cells, "rock"),
        _ => Mesh::box_of_tets(low, high, cells, "rock"),
    };
    let noise = std::cell::RefCell::new(Noise(7));
    let moved = mesh.unwrap().map_positions(|x| {
        let shift = noise.borrow_mut().vector() * 0.3;
        let inside = |i: usize| x[i] > 0.1 && x[i] < 5.9;
        Vec3::from_fn(|i, _| x[i] + if inside(i) { shift[i] } else { 0.0 })
    });
    moved.unwrap()
}

/// A block of a whole mesh, its nodes numbered backwards.
struct Fixture {
    mesh: Mesh,
    numbering: Numbering,
    block: Box<dyn ElementBlock>,
}

impl Fixture {
    fn new<M: ConstitutiveLaw>(kernel: SolidKernel, law: M, options: BlockOptions) -> Self {
        Self::of(distorted_box(kernel.kind()), kernel, law, options)
    }
    fn of<M: ConstitutiveLaw>(
        mesh: Mesh,
        kernel: SolidKernel,
        law: M,
        options: BlockOptions,
    ) -> Self {
        let count = mesh.node_count() as u32;
        let backwards: Vec<u32> = (0..count).rev().collect();
        let numbering = Numbering {
            engine_of: backwards.clone(),
            mesh_of: backwards,
        };
        let elements: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let nodes: Vec<u32> = (0..count).collect();
        let part = BlockPart::new(&mesh, &elements, &numbering, &nodes);
        let block = kernel.factory("rock", law, options).build(&part).unwrap();
        Self {
            mesh,
            numbering,
            block,
        }
    }
    /// A nodal field in engine numbering.
    fn field<A: NodalScalar>(&self, mut value: impl FnMut(&Vec3) -> Vec3) -> Vec<Quad<A>> {
        let positions = self.mesh.positions();
        let of = |&node: &u32| Quad::from_vector(&value(&positions[node as usize]));
        self.numbering.mesh_of.iter().map(of).collect()
    }
    fn noise(&self, seed: u64, amplitude: f64) -> Vec<Quad<f64>> {
        let mut noise = Noise(seed);
        self.field(|_| noise.vector() * amplitude)
    }
    fn forces(&mut self, u: &[Quad<f64>], v: &[Quad<f64>]) -> Vec<Vec3> {
        let context = BlockContext::new((0, 0.0, 1e-4), NodalView::F64(u), NodalView::F64(v));
        self.forces_at(&context).unwrap()
    }
    fn forces_at(&mut self, context: &BlockContext) -> Result<Vec<Vec3>, ElementFault> {
        let count = self.block.nodes().len();
        match context.displacement {
            NodalView::F64(_) => {
                let mut out = vec![Quad::default(); count];
                self.block.forces(context, NodalViewMut::F64(&mut out))?;
                Ok(out.iter().map(|q| q.to_vector()).collect())
            }
            NodalView::F32(_) => {
                let mut out = vec![Quad::default(); count];
                self.block.forces(context, NodalViewMut::F32(&mut out))?;
                Ok(out.iter().map(|q| q.to_vector()).collect())
            }
        }
    }
    fn apply(&self, operator: Operator, x: &[Quad<f64>]) -> Vec<Vec3> {
        let mut out = vec![Quad::default(); x.len()];
        self.block
            .apply(operator, NodalView::F64(x), NodalViewMut::F64(&mut out));
        out.iter().map(|q| q.to_vector()).collect()
    }
    fn stress(&self, u: &[Quad<f64>]) -> Vec<Stress> {
        let mut out = vec![Stress::default(); self.block.elements().len()];
        self.block.add_stress(NodalView::F64(u), &mut out);
        out
    }
    fn masses(&self) -> Vec<f64> {
        let mut masses = vec![0.0; self.block.nodes().len()];
        self.block.add_mass(&mut masses);
        masses
    }
}

fn options(precision: Precision, lanes: LaneWidth, stiffness: f64) -> BlockOptions {
    BlockOptions {
        precision,
        lanes,
        damping: Rayleigh {
            mass: 0.0,
            stiffness,
        },
    }
}

fn zeros(count: usize) -> Vec<Quad<f64>> {
    vec![Quad::default(); count]
}

fn largest(forces: &[Vec3]) -> f64 {
    forces.iter().fold(0.0, |m, f| m.max(f.norm()))
}

const GRADIENT: Mat3 = Mat3::new(1.1, -0.4, 0.3, 0.8, -0.6, 0.9, -0.2, 0.5, 0.7);

/// The patch test: under a linear displacement a distorted mesh has the exact stress everywhere
/// and no force at its inner nodes.
#[test]
fn patch_test_on_distorted_meshes() {
    for kernel in SolidKernel::ALL {
        let mut fixture = Fixture::new(kernel, Linear(rock()), BlockOptions::default());
        let u = fixture.field(|x| GRADIENT * x * 1e-3);
        let forces = fixture.forces(&u, &zeros(u.len()));
        let scale = largest(&forces);
        for (force, &mesh_node) in forces.iter().zip(&fixture.numbering.mesh_of) {
            let x = fixture.mesh.positions()[mesh_node as usize];
            if (0..3).all(|i| x[i] > 0.1 && x[i] < 5.9) {
                assert!(force.norm() < 1e-13 * scale, "{} {force}", kernel.name());
            }
        }
        let exact = Stress::elastic(
            rock().lambda(),
            rock().shear(),
            &Strain::from_gradient(&(GRADIENT * 1e-3)),
        );
        for stress in fixture.stress(&u) {
            assert!((stress - exact).0.iter().all(|s| s.abs() < 1e-12 * 9e9));
        }
    }
}

/// The masses of a mesh sum to density times volume to round-off.
#[test]
fn masses_sum_to_density_times_volume() {
    for kernel in SolidKernel::ALL {
        let fixture = Fixture::new(kernel, Linear(rock()), BlockOptions::default());
        let mass: f64 = fixture.masses().iter().sum();
        let exact = 2750.0 * 216.0;
        assert!((mass - exact).abs() < 1e-14 * exact, "{mass}");
    }
}

/// One element under gravity, `integral of N rho g dV` at its nodes, accelerates by g at every
/// node to round-off.
#[test]
fn one_element_falls_with_g() {
    const G: f64 = 9.81;
    for kernel in SolidKernel::ALL {
        let box_mesh = distorted_box(kernel.kind());
        let mut builder = Mesh::builder();
        let nodes: Vec<u64> = (1..).take(kernel.kind().node_count()).collect();
        for (&tag, &node) in nodes.iter().zip(box_mesh.nodes_of(0)) {
            builder.node(tag, box_mesh.positions()[node as usize]);
        }
        builder.element(1, kernel.kind(), &nodes, &["rock"]);
        let mesh = builder.build().unwrap();
        let mut fixture = Fixture::of(mesh, kernel, Linear(rock()), BlockOptions::default());
        let rest = zeros(nodes.len());
        let internal = fixture.forces(&rest, &rest);
        let masses = fixture.masses();
        for (force, mass) in internal.iter().zip(&masses) {
            let acceleration = (Vec3::new(0.0, 0.0, -G * mass) - force) / *mass;
            assert!((acceleration - Vec3::new(0.0, 0.0, -G)).norm() < 1e-15 * G);
        }
    }
}

/// Everything that a block computes has the same bits in lanes of one and of many, for every
/// kernel and precision, damped, with and without memory, with elements switched off.
#[test]
fn lane_width_leaves_no_trace() {
    fn bits<M: ConstitutiveLaw>(
        kernel: SolidKernel,
        law: M,
        precision: Precision,
        lanes: LaneWidth,
    ) -> Vec<u64> {
        let mut fixture = Fixture::new(kernel, law, options(precision, lanes, 2e-4));
        let (u, v) = (fixture.noise(1, 1e-3), fixture.noise(2, 1e-1));
        let single = |values: &[Quad<f64>]| -> Vec<Quad<f32>> {
            let round = |q: &Quad<f64>| Quad::from_vector(&q.to_vector());
            values.iter().map(round).collect()
        };
        let (u32s, v32s) = (single(&u), single(&v));
        let views = match precision {
            Precision::F32 => (NodalView::F32(&u32s), NodalView::F32(&v32s)),
            _ => (NodalView::F64(&u), NodalView::F64(&v)),
        };
        let count = fixture.block.elements().len();
        let stresses: Vec<Stress> = (0..count)
            .map(|e| Stress([e as f64 * 1e4, -2e6, 0.0, 1e5, 0.0, 3e5]))
            .collect();
        fixture.block.set_initial_stress(&stresses);
        let active: Vec<bool> = (0..count).map(|e| e % 5 != 3).collect();
        fixture.block.set_active(&active);
        let mut numbers = Vec::new();
        for step in 0..3 {
            let context = BlockContext::new((step, 0.0, 1e-4), views.0, views.1).with_ledger(true);
            for force in fixture.forces_at(&context).unwrap() {
                numbers.extend(force.iter());
            }
            let energy = fixture.block.energy(&context);
            numbers.extend([energy.elastic, energy.hourglass, energy.damping]);
            numbers.push(energy.plastic);
            fixture.block.commit();
            fixture.block.set_reference_displacement(views.1);
            let mut mean = vec![Stress::default(); count];
            fixture.block.add_stress(views.0, &mut mean);
            numbers.extend(mean.iter().flat_map(|stress| stress.0));
        }
        for field in fixture.block.history() {
            numbers.extend(field.values);
        }
        let bounds = fixture.block.frequency_bounds();
        numbers.extend(bounds.iter().map(|bound| bound.frequency));
        assert!(numbers.iter().all(|number| number.is_finite()));
        numbers.iter().map(|number| number.to_bits()).collect()
    }
    for kernel in SolidKernel::ALL {
        for precision in [Precision::F64, Precision::Mixed, Precision::F32] {
            let of = |lanes| bits(kernel, Linear(rock()), precision, lanes);
            assert_eq!(of(LaneWidth::One), of(LaneWidth::Native), "{kernel:?}");
            let of = |lanes| bits(kernel, Softening(rock()), precision, lanes);
            assert_eq!(of(LaneWidth::One), of(LaneWidth::Native), "{kernel:?}");
        }
    }
}

/// Where all elements are alike, or all straight, a block computes what it computes in a mesh where
/// one element of another shape keeps it from noticing.
#[test]
fn equal_shapes_leave_no_trace() {
    for kernel in SolidKernel::ALL {
        let (low, high) = (Vec3::new(20.0, -3.0, 7.0), Vec3::new(20.3, -2.6, 7.9));
        let generator = match kernel.kind() {
            ElementKind::Hex8 => Mesh::box_of_hexes,
            ElementKind::Wedge6 => Mesh::box_of_wedges,
            _ => Mesh::box_of_tets,
        };
        let regular = generator(low, high, [3, 3, 3], "rock").unwrap();
        let count = regular.node_count();
        let moved = regular.clone().map_positions(|x| {
            let corner = (x - high).norm() < 1e-9;
            if corner { x + Vec3::repeat(0.05) } else { x }
        });
        let moved = moved.unwrap();
        let of = |mesh: Mesh| {
            let mut fixture = Fixture::of(mesh, kernel, Linear(rock()), BlockOptions::default());
            let u = fixture.noise(6, 1e-3);
            let rest = zeros(u.len());
            let mut masses = fixture.masses();
            let mut bounds: Vec<f64> = fixture
                .block
                .frequency_bounds()
                .iter()
                .map(|bound| bound.frequency)
                .collect();
            // Only the last cell has another shape.
            let elements = fixture.mesh.element_count() as u32;
            let touched: Vec<u32> = (elements - elements / 27..elements)
                .flat_map(|element| fixture.mesh.nodes_of(element).to_vec())
                .collect();
            let mut forces = fixture.forces(&u, &rest);
            for node in touched {
                let place = fixture.numbering.engine_of[node as usize] as usize;
                forces[place] = Vec3::zeros();
                masses[place] = 0.0;
            }
            bounds.truncate(bounds.len() - bounds.len() / 27);
            (forces, masses, bounds)
        };
        let (regular, moved) = (of(regular), of(moved));
        let scale = largest(&regular.0);
        for place in 0..count {
            assert!((regular.0[place] - moved.0[place]).norm() < 1e-12 * scale);
            assert!((regular.1[place] - moved.1[place]).abs() < 1e-10 * 2750.0 * 1e-3);
        }
        for (a, b) in regular.2.iter().zip(&moved.2) {
            assert!((a - b).abs() < 1e-8 * a, "{} {a} {b}", kernel.name());
        }
    }
}

/// The bound of an element is its highest frequency, from above, to 1e-6.
#[test]
fn frequency_bounds_are_eigenvalues() {
    for kernel in SolidKernel::ALL {
        let whole = distorted_box(kernel.kind());
        for element in [0, 5, 13] {
            let mut builder = Mesh::builder();
            let nodes: Vec<u64> = (1..).take(kernel.kind().node_count()).collect();
            for (&tag, &node) in nodes.iter().zip(whole.nodes_of(element)) {
                builder.node(tag, whole.positions()[node as usize]);
            }
            builder.element(1, kernel.kind(), &nodes, &["rock"]);
            let mesh = builder.build().unwrap();
            let fixture = Fixture::of(mesh, kernel, Linear(rock()), BlockOptions::default());
            let masses = fixture.masses();
            let size = 3 * nodes.len();
            let mut matrix = DMatrix::zeros(size, size);
            for column in 0..size {
                let mut unit = zeros(nodes.len());
                unit[column / 3].values[column % 3] = 1.0;
                for (a, force) in fixture.apply(Operator::Elastic, &unit).iter().enumerate() {
                    let scale = 1.0 / (masses[a] * masses[column / 3]).sqrt();
                    for i in 0..3 {
                        matrix[(3 * a + i, column)] = force[i] * scale;
                    }
                }
            }
            let exact = SymmetricEigen::new(matrix).eigenvalues.max().sqrt();
            let bound = fixture.block.frequency_bounds()[0].frequency;
            assert!(bound >= exact * (1.0 - 1e-12), "{bound} {exact}");
            assert!(bound <= exact * (1.0 + 1e-6), "{bound} {exact}");
        }
    }
}

/// A cube's bound is that of the closed form for nu: `w = sqrt((3 lambda + 2 G) / rho) 2 / h`.
#[test]
fn the_bound_of_a_cube_is_known() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(0.5), [1, 1, 1], "rock").unwrap();
    let kernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::DEFAULT);
    let fixture = Fixture::of(mesh, kernel, Linear(rock()), BlockOptions::default());
    let stiffness = 3.0 * rock().lambda() + 2.0 * rock().shear();
    let exact = 2.0 / 0.5 * (stiffness / 2750.0).sqrt();
    let bound = fixture.block.frequency_bounds()[0].frequency;
    assert!((bound - exact).abs() < 1e-8 * exact, "{bound} {exact}");
}

/// The elastic operator is symmetric, and its nodal diagonal is that of the operator.
#[test]
fn the_diagonal_is_that_of_the_operator() {
    for kernel in SolidKernel::ALL {
        let fixture = Fixture::new(kernel, Linear(rock()), BlockOptions::default());
        let count = fixture.block.nodes().len();
        let mut diagonal = vec![Mat3::zeros(); count];
        fixture.block.diagonal(Operator::Elastic, &mut diagonal);
        for node in [0, 21, count - 1] {
            for j in 0..3 {
                let mut unit = zeros(count);
                unit[node].values[j] = 1.0;
                let column = fixture.apply(Operator::Elastic, &unit)[node];
                let error = (column - diagonal[node].column(j)).norm();
                assert!(error < 1e-13 * diagonal[node].norm());
            }
        }
        let (x, y) = (fixture.noise(3, 1.0), fixture.noise(4, 1.0));
        let dot = |a: &[Quad<f64>], b: &[Vec3]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a.to_vector().dot(b)).sum()
        };
        let (xy, yx) = (
            dot(&x, &fixture.apply(Operator::Elastic, &y)),
            dot(&y, &fixture.apply(Operator::Elastic, &x)),
        );
        assert!((xy - yx).abs() < 1e-12 * dot(&x, &fixture.apply(Operator::Elastic, &x)));
    }
}

/// Stiffness damping is the elastic operator on the velocity, shifted as asked.
#[test]
fn stiffness_damping_works_on_the_velocity() {
    for kernel in SolidKernel::ALL {
        let damped = options(Precision::F64, LaneWidth::Native, 3e-3);
        let mut linear = Fixture::new(kernel, Linear(rock()), damped);
        let mut softening = Fixture::new(kernel, Softening(rock()), damped);
        let v = linear.noise(5, 1.0);
        let rest = zeros(v.len());
        let context = BlockContext::new((0, 0.0, 1e-4), NodalView::F64(&rest), NodalView::F64(&v))
            .with_damping_shift(-1e-3);
        let expected = linear.apply(Operator::Elastic, &v);
        for fixture in [&mut linear, &mut softening] {
            let forces = fixture.forces_at(&context).unwrap();
            for (force, product) in forces.iter().zip(&expected) {
                assert!((force - product * 2e-3).norm() < 1e-15 * largest(&expected));
            }
        }
    }
}

/// Single precision on differences loses nothing to a large common displacement; forces agree with
/// double precision to the rounding of single.
#[test]
fn mixed_precision_sees_only_differences() {
    for kernel in SolidKernel::ALL {
        let of = |precision| {
            let options = options(precision, LaneWidth::Native, 0.0);
            let mut fixture = Fixture::new(kernel, Linear(rock()), options);
            let mut noise = Noise(11);
            let u = fixture.field(|_| noise.vector() * 1e-6 + Vec3::new(40.0, -30.0, 20.0));
            fixture.forces(&u, &zeros(u.len()))
        };
        let (exact, mixed) = (of(Precision::F64), of(Precision::Mixed));
        let error = exact.iter().zip(&mixed).map(|(a, b)| (a - b).norm());
        let error = error.fold(0.0, f64::max) / largest(&exact);
        assert!(error < 2e-6, "{} {error}", kernel.name());
    }
}

/// The history is tried as often as wanted and becomes old only when committed.
#[test]
fn history_is_committed_apart() {
    let kernel = SolidKernel::Hex8Full;
    let mut fixture = Fixture::new(kernel, Softening(rock()), BlockOptions::default());
    let (small, large) = (fixture.noise(1, 1e-4), fixture.noise(1, 1e-2));
    let rest = zeros(small.len());
    let before = fixture.forces(&small, &rest);
    let tried = fixture.forces(&large, &rest);
    assert_eq!(fixture.forces(&small, &rest), before);
    assert_eq!(fixture.forces(&large, &rest), tried);
    fixture.block.commit();
    let after = fixture.forces(&small, &rest);
    assert!(largest(&after) < 0.5 * largest(&before));

    let saved = fixture.block.history();
    assert_eq!((saved[0].points, saved[0].values.len()), (8, 27 * 8));
    let mut other = Fixture::new(kernel, Softening(rock()), BlockOptions::default());
    other.block.set_history(&saved);
    assert_eq!(other.forces(&small, &rest), after);
    assert_eq!(other.block.history(), saved);
}

/// Switched-off elements have neither force, mass, stress, energy nor bound, and keep their
/// history.
#[test]
fn inactive_elements_are_not_there() {
    let kernel = SolidKernel::Wedge6;
    let mut fixture = Fixture::new(kernel, Softening(rock()), BlockOptions::default());
    let u = fixture.noise(1, 1e-3);
    let rest = zeros(u.len());
    let all = fixture.forces(&u, &rest);
    let count = fixture.block.elements().len();
    let mut sum = vec![Vec3::zeros(); u.len()];
    let mut mass = vec![0.0; u.len()];
    for share in 0..2 {
        let active: Vec<bool> = (0..count).map(|e| e % 2 == share).collect();
        fixture.block.set_active(&active);
        for (sum, force) in sum.iter_mut().zip(fixture.forces(&u, &rest)) {
            *sum += force;
        }
        fixture.block.add_mass(&mut mass);
        assert_eq!(fixture.block.frequency_bounds().len(), count / 2);
        let stress = fixture.stress(&u);
        assert!((0..count).all(|e| (stress[e] != Stress::default()) == active[e]));
        fixture.block.commit();
        let history = &fixture.block.history()[0].values;
        let grown = |e: usize| history[6 * e..6 * e + 6].iter().all(|&h| h > 0.0);
        assert!((0..count).all(|e| grown(e) == (e % 2 <= share)));
        fixture.block.set_active(&vec![true; count]);
        fixture.block.set_history(&[powerhouse_model::HistoryField {
            name: "largest_strain".into(),
            elements: fixture.block.elements().to_vec(),
            points: 6,
            values: (0..6 * count)
                .map(|i| {
                    if (i / 6) % 2 <= share {
                        history[i]
                    } else {
                        0.0
                    }
                })
                .collect(),
        }]);
    }
    let scale = largest(&all);
    for (sum, force) in sum.iter().zip(&all) {
        assert!((sum - force).norm() < 1e-13 * scale);
    }
    assert!((mass.iter().sum::<f64>() - 2750.0 * 216.0).abs() < 1e-8);
}

/// What is cast in a deformed state is free of stress and hourglass force there, and answers to
/// what comes after as if it had been cast undeformed.
#[test]
fn strain_is_measured_from_the_reference() {
    for kernel in SolidKernel::ALL {
        for precision in [Precision::F64, Precision::Mixed] {
            let options = options(precision, LaneWidth::Native, 0.0);
            let mut fixture = Fixture::new(kernel, Linear(rock()), options);
            let (deformed, more) = (fixture.noise(1, 0.1), fixture.noise(2, 1e-3));
            let rest = zeros(more.len());
            let expected = fixture.forces(&more, &rest);
            fixture
                .block
                .set_reference_displacement(NodalView::F64(&deformed));
            assert_eq!(largest(&fixture.forces(&deformed, &rest)), 0.0);
            let both: Vec<Quad<f64>> = deformed
                .iter()
                .zip(&more)
                .map(|(a, b)| Quad::from_vector(&(a.to_vector() + b.to_vector())))
                .collect();
            let forces = fixture.forces(&both, &rest);
            let tolerance = if precision == Precision::F64 {
                1e-12
            } else {
                2e-6
            };
            for (force, expected_force) in forces.iter().zip(&expected) {
                let error = (force - expected_force).norm() / largest(&expected);
                assert!(error < tolerance, "{error}");
            }
        }
    }
}

/// A law that is told an initial stress answers to it, and only the change is scattered.
#[test]
fn initial_stress_reaches_the_law() {
    let kernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::DEFAULT);
    let mut fixture = Fixture::new(kernel, Softening(rock()), BlockOptions::default());
    let u = fixture.noise(1, 1e-4);
    let rest = zeros(u.len());
    let fresh = fixture.forces(&u, &rest);
    fixture
        .block
        .set_initial_stress(&vec![Stress([-9e7, -9e7, -9e7, 0.0, 0.0, 0.0]); 27]);
    assert!(largest(&fixture.forces(&u, &rest)) < 0.5 * largest(&fresh));
    assert_eq!(largest(&fixture.forces(&rest, &rest)), 0.0);
}

/// Free motion keeps the sum of kinetic, elastic, hourglass, plastic and damping energy to
/// round-off: each term comes from the elements.
#[test]
fn the_ledger_closes() {
    fn residual<M: ConstitutiveLaw>(kernel: SolidKernel, law: M, stiffness: f64) -> f64 {
        let damped = options(Precision::F64, LaneWidth::Native, stiffness);
        let mut fixture = Fixture::new(kernel, law, damped);
        let masses = fixture.masses();
        let mut u = zeros(masses.len());
        let mut v = fixture.noise(8, 0.5);
        let step = 2e-5;
        let mut totals = Vec::new();
        let mut spent = 0.0;
        for number in 0..200 {
            let context =
                BlockContext::new((number, 0.0, step), NodalView::F64(&u), NodalView::F64(&v))
                    .with_ledger(true);
            let forces = fixture.forces_at(&context).unwrap();
            let mut kinetic = 0.0;
            let mut next = v.clone();
            for (n, force) in forces.iter().enumerate() {
                let (before, mass) = (v[n].to_vector(), masses[n]);
                let after = before - force * (step / mass);
                kinetic += 0.5 * mass * before.dot(&after);
                next[n] = Quad::from_vector(&after);
            }
            let energy = fixture.block.energy(&context);
            totals.push(kinetic + energy.total());
            spent = energy.plastic + energy.damping;
            v = next;
            for (u, v) in u.iter_mut().zip(&v) {
                *u = Quad::from_vector(&(u.to_vector() + v.to_vector() * step));
            }
            fixture.block.commit();
        }
        let first = totals[0];
        if stiffness > 0.0 || !fixture.block.history().is_empty() {
            assert!(spent > 0.01 * first, "{spent} of {first}");
        }
        let worst = totals.iter().map(|total| (total - first).abs());
        worst.fold(0.0, f64::max) / first
    }
    for kernel in SolidKernel::ALL {
        for stiffness in [0.0, 2e-5] {
            let linear = residual(kernel, Linear(rock()), stiffness);
            assert!(linear < 1e-12, "{} {linear}", kernel.name());
            let softening = residual(kernel, Softening(rock()), stiffness);
            assert!(softening < 1e-12, "{} {softening}", kernel.name());
        }
    }
}

/// For a law without memory in a state of uniform damage the secant is the stress over strain, and
/// the tangent the derivative of the forces.
#[test]
fn secant_and_tangent_follow_the_state() {
    for kernel in SolidKernel::ALL {
        let mut fixture = Fixture::new(kernel, Softening(rock()), BlockOptions::default());
        let gradient = GRADIENT * 1e-3;
        let u = fixture.field(|x| gradient * x);
        let rest = zeros(u.len());
        let forces = fixture.forces(&u, &rest);
        let scale = largest(&forces);
        let secant = fixture.apply(Operator::Secant, &u);
        for (secant, force) in secant.iter().zip(&forces) {
            assert!((secant - force).norm() < 1e-12 * scale);
        }
        let direction = fixture.noise(9, 1e-3);
        let tangent = fixture.apply(Operator::Tangent, &direction);
        let h = 1e-4;
        let mut at = |offset: f64| {
            let moved: Vec<Quad<f64>> = u
                .iter()
                .zip(&direction)
                .map(|(u, d)| Quad::from_vector(&(u.to_vector() + d.to_vector() * offset)))
                .collect();
            fixture.forces(&moved, &rest)
        };
        let (plus, minus) = (at(h), at(-h));
        for ((tangent, plus), minus) in tangent.iter().zip(&plus).zip(&minus) {
            let quotient = (plus - minus) / (2.0 * h);
            assert!(
                (tangent - quotient).norm() < 1e-6 * scale,
                "{}",
                kernel.name()
            );
        }
    }
}

/// A number that is none is reported with the element that met it, at its step.
#[test]
fn a_fault_names_its_element() {
    for precision in [Precision::F64, Precision::Mixed] {
        let options = options(precision, LaneWidth::Native, 1e-4);
        let kernel = SolidKernel::Tet4;
        let mut fixture = Fixture::new(kernel, Linear(rock()), options);
        let rest = zeros(fixture.block.nodes().len());
        let element = 77;
        let node = fixture.mesh.nodes_of(element)[2];
        let touches =
            |fault: &ElementFault, mesh: &Mesh| mesh.nodes_of(fault.element).contains(&node);
        for bad in [f64::NAN, f64::INFINITY] {
            let mut broken = rest.clone();
            broken[fixture.numbering.engine_of[node as usize] as usize].values[1] = bad;
            for (u, v) in [(&broken, &rest), (&rest, &broken)] {
                let context =
                    BlockContext::new((0, 0.0, 1e-4), NodalView::F64(u), NodalView::F64(v));
                let fault = fixture.forces_at(&context).unwrap_err();
                assert!(touches(&fault, &fixture.mesh), "{fault:?}");
            }
        }
    }
}

/// Meshes that do not suit the kernel are refused with the user's numbers.
#[test]
fn unsuitable_parts_are_refused() {
    let build = |mesh: &Mesh, nodes: &[u32]| {
        let identity: Vec<u32> = (0..mesh.node_count() as u32).collect();
        let numbering = Numbering {
            engine_of: identity.clone(),
            mesh_of: identity,
        };
        let elements: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let part = BlockPart::new(mesh, &elements, &numbering, nodes);
        let factory = solid(
            "rock",
            Hex8OnePoint::DEFAULT,
            Linear(rock()),
            BlockOptions::default(),
        );
        factory.build(&part).err().map(|error| error.to_string())
    };
    let hexes = distorted_box(ElementKind::Hex8);
    let all: Vec<u32> = (0..hexes.node_count() as u32).collect();
    assert_eq!(build(&hexes, &all), None);
    let message = build(&hexes, &all[1..]).unwrap();
    assert!(message.contains("element 1 uses node 1"), "{message}");
    let tets = distorted_box(ElementKind::Tet4);
    let message = build(&tets, &all).unwrap();
    assert!(message.contains("element 1 is a tet4"), "{message}");
    let flat = hexes.map_positions(|x| Vec3::new(x.x, x.y, 0.0));
    if let Ok(flat) = flat {
        let message = build(&flat, &all).unwrap();
        assert!(message.contains("volume"), "{message}");
    }
}
