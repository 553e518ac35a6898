//! What every block must do, whatever its kernel, law, precision and width.

mod added_mass;
mod boxes;
mod elastic;
mod grout;
mod hand_over;
mod hinge;
mod invariance;
mod location;
mod mixed;
mod natural;
mod pore_water;
mod remaining;
mod saved;
mod shown;
mod state;
mod tet10;
mod water;

use nalgebra::{DMatrix, SymmetricEigen};
use powerhouse_model::{
    BlockContext, BlockEnergy, BlockOptions, BlockPart, ConstitutiveLaw, ElasticMedium,
    ElementBlock, ElementFault, ElementKind, HistoryVariable, Lane, LaneWidth, LawEnergy, LawInput,
    Mat3, Mesh, MeshError, NodalScalar, NodalView, NodalViewMut, Operator, Precision, Quad,
    RemainingStiffness, StepTime, Strain, Stress, Vec3,
};

use powerhouse_elements::{AnyLaw, Hex8OnePoint, SolidKernel};

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

/// A law with history: isotropic damage `d = k / (k + 1e-3)` by the largest norm `k` of the strain
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
        let elastic = Stress::elastic(
            any.constant(self.0.lambda()),
            any.constant(self.0.shear()),
            &input.strain,
        );
        elastic * kept
    }
    /// What is lost is damage.
    #[inline(always)]
    fn remaining_stiffness<L: Lane>(
        &self,
        input: &LawInput<L>,
        new: &[L],
        _change: &Stress<L>,
    ) -> RemainingStiffness<L> {
        let any = input.strain.0[0];
        let kept = any.constant(1e-3) / (new[0] + any.constant(1e-3));
        RemainingStiffness::whole(any)
            .with_undamaged(kept)
            .with_hourglass(kept)
    }
}

/// Perfect plasticity of von Mises up to a deviatoric strain, in elements without initial stress.
#[derive(Clone)]
struct Yielding(ElasticMedium, f64);

impl Yielding {
    /// Deviatoric part of a strain less a plastic one, components with engineering shears.
    #[inline(always)]
    fn elastic<L: Lane>(strain: &Strain<L>, plastic: &[L]) -> [L; 6] {
        let mut elastic = strain.0;
        for i in 0..6 {
            elastic[i] = elastic[i] - plastic[i];
        }
        elastic
    }
    #[inline(always)]
    fn stress<L: Lane>(&self, elastic: [L; 6]) -> Stress<L> {
        let any = elastic[0];
        let (lambda, shear) = (self.0.lambda(), self.0.shear());
        Stress::elastic(any.constant(lambda), any.constant(shear), &Strain(elastic))
    }
}

impl ConstitutiveLaw for Yielding {
    fn name(&self) -> &str {
        "yielding"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &'static [HistoryVariable] {
        const {
            &[
                HistoryVariable::component("plastic_xx", "1"),
                HistoryVariable::component("plastic_yy", "1"),
                HistoryVariable::component("plastic_zz", "1"),
                HistoryVariable::component("plastic_xy", "1"),
                HistoryVariable::component("plastic_yz", "1"),
                HistoryVariable::component("plastic_zx", "1"),
            ]
        }
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new: &mut [L]) -> Stress<L> {
        let trial = Self::elastic(&input.strain, input.history);
        let any = trial[0];
        let mean = (trial[0] + trial[1] + trial[2]) * any.constant(1.0 / 3.0);
        let mut deviator = trial;
        for normal in &mut deviator[..3] {
            *normal = *normal - mean;
        }
        let mut square = any.constant(0.0);
        for i in 0..6 {
            let weight = any.constant(if i < 3 { 1.0 } else { 0.5 });
            square = (deviator[i] * weight).mul_add(deviator[i], square);
        }
        let (one, most) = (any.constant(1.0), any.constant(self.1));
        let size = square.sqrt();
        let beyond = most.less(size);
        let flow = (one - most / size.select(beyond, one)).select(beyond, any.constant(0.0));
        let mut elastic = trial;
        for i in 0..6 {
            new[i] = deviator[i].mul_add(flow, input.history[i]);
            elastic[i] = input.strain.0[i] - new[i];
        }
        self.stress(elastic)
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new: &[L]) -> Option<LawEnergy<L>> {
        let elastic = Self::elastic(&input.strain, new);
        let stress = self.stress(elastic);
        let mut grown = elastic;
        for i in 0..6 {
            grown[i] = new[i] - input.history[i];
        }
        let half = elastic[0].constant(0.5);
        let stored = stress.work(&Strain(elastic)) * half;
        Some(LawEnergy::stored(stored).with_plastic(stress.work(&Strain(grown))))
    }
    #[inline(always)]
    fn remaining_stiffness<L: Lane>(
        &self,
        input: &LawInput<L>,
        new: &[L],
        _change: &Stress<L>,
    ) -> RemainingStiffness<L> {
        let mut grown = input.strain.0;
        for i in 0..6 {
            grown[i] = new[i] - input.history[i];
        }
        RemainingStiffness::whole(grown[0]).with_plastic_strain_increment(grown)
    }
}

/// A step of a length (s), at time zero.
fn when(number: u64, step: f64) -> StepTime {
    StepTime {
        number,
        time: 0.0,
        step,
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
    distorted(kind, [3, 3, 3])
}

/// The same of any number of cells.
fn distorted(kind: ElementKind, cells: [usize; 3]) -> Mesh {
    let (low, high) = (
        Vec3::zeros(),
        Vec3::from(cells.map(|count| 2.0 * count as f64)),
    );
    let mesh = generator(kind)(low, high, cells, "rock");
    let noise = std::cell::RefCell::new(Noise(7));
    let moved = mesh.unwrap().map_positions(|x| {
        let shift = noise.borrow_mut().vector() * 0.3;
        let inside = |i: usize| x[i] > 0.1 && x[i] < high[i] - 0.1;
        Vec3::from_fn(|i, _| x[i] + if inside(i) { shift[i] } else { 0.0 })
    });
    of_kind(kind, moved.unwrap())
}

type Generator = fn(Vec3, Vec3, [usize; 3], &str) -> Result<Mesh, MeshError>;

/// The generator of a mesh of elements of a kind, of which [`of_kind`] makes those with midpoints.
fn generator(kind: ElementKind) -> Generator {
    match kind {
        ElementKind::Hex8 => Mesh::box_of_hexes,
        ElementKind::Wedge6 => Mesh::box_of_wedges,
        ElementKind::Pyramid5 => Mesh::box_of_pyramids,
        _ => Mesh::box_of_tets,
    }
}

/// The mesh, with midpoints if the kind has them.
fn of_kind(kind: ElementKind, mesh: Mesh) -> Mesh {
    match kind {
        ElementKind::Tet10 => mesh.with_midpoints().unwrap(),
        _ => mesh,
    }
}

/// A block of a whole mesh, whose nodes are in the reverse order of the mesh.
struct Fixture {
    mesh: Mesh,
    block: Box<dyn ElementBlock>,
}

impl Fixture {
    fn new(kernel: SolidKernel, law: impl Into<AnyLaw>, options: BlockOptions) -> Self {
        Self::of(distorted_box(kernel.kind()), kernel, law, options)
    }
    fn of(mesh: Mesh, kernel: SolidKernel, law: impl Into<AnyLaw>, options: BlockOptions) -> Self {
        let backwards: Vec<u32> = (0..mesh.node_count() as u32).rev().collect();
        let elements: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let part = BlockPart::new(&mesh, &elements, &backwards);
        let block = kernel.factory("rock", law, options).build(&part).unwrap();
        Self { mesh, block }
    }
    /// Index of a mesh node among the nodes of the block.
    fn place(&self, node: u32) -> usize {
        let mut nodes = self.block.nodes().iter();
        nodes.position(|&other| other == node).unwrap()
    }
    /// A nodal field in the order of the block's nodes.
    fn field<A: NodalScalar>(&self, mut value: impl FnMut(&Vec3) -> Vec3) -> Vec<Quad<A>> {
        let positions = self.mesh.positions();
        let of = |&node: &u32| Quad::from_vector(&value(&positions[node as usize]));
        self.block.nodes().iter().map(of).collect()
    }
    fn noise(&self, seed: u64, amplitude: f64) -> Vec<Quad<f64>> {
        let mut noise = Noise(seed);
        self.field(|_| noise.vector() * amplitude)
    }
    fn forces(&mut self, u: &[Quad<f64>], v: &[Quad<f64>]) -> Vec<Vec3> {
        let context = BlockContext::new(when(0, 1e-4), NodalView::F64(u), NodalView::F64(v));
        self.forces_at(&context).unwrap()
    }
    /// Forces of a body at rest, in a step of no length.
    fn static_forces(&mut self, u: &[Quad<f64>]) -> Vec<Vec3> {
        let rest = zeros(u.len());
        let views = [NodalView::F64(u), NodalView::F64(&rest)];
        let context = BlockContext::new(when(0, 0.0), views[0], views[1]);
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
    /// Two hundred steps of free motion from a displacement with some velocity: the kinetic energy and that of the elements at the
    /// start (J), the greatest change of their sum over it, and the energies of the elements at the end.
    fn free_motion(&mut self, mut u: Vec<Quad<f64>>) -> (f64, f64, BlockEnergy) {
        let masses = self.masses();
        let mut v = self.noise(8, 0.5);
        let step = 2e-5;
        let mut totals = Vec::new();
        let mut spent = BlockEnergy::default();
        for number in 0..200 {
            let context =
                BlockContext::new(when(number, step), NodalView::F64(&u), NodalView::F64(&v))
                    .with_ledger(true);
            let forces = self.forces_at(&context).unwrap();
            let mut kinetic = 0.0;
            let mut next = v.clone();
            for (n, force) in forces.iter().enumerate() {
                let (before, mass) = (v[n].to_vector(), masses[n]);
                let after = before - force * (step / mass);
                kinetic += 0.5 * mass * before.dot(&after);
                next[n] = Quad::from_vector(&after);
            }
            spent = self.block.energy(&context);
            totals.push(kinetic + spent.total());
            v = next;
            for (u, v) in u.iter_mut().zip(&v) {
                *u = Quad::from_vector(&(u.to_vector() + v.to_vector() * step));
            }
            self.block.commit();
        }
        let first = totals[0];
        let changes = totals.iter().map(|total| (total - first).abs());
        (first, changes.fold(0.0, f64::max) / first, spent)
    }
}

fn options(precision: Precision, lanes: LaneWidth, stiffness: f64) -> BlockOptions {
    let mut options = BlockOptions::default();
    options.precision = precision;
    options.lanes = lanes;
    options.damping.stiffness = stiffness;
    options
}

fn zeros(count: usize) -> Vec<Quad<f64>> {
    vec![Quad::default(); count]
}

fn largest(forces: &[Vec3]) -> f64 {
    forces.iter().fold(0.0, |m, f| m.max(f.norm()))
}

const GRADIENT: Mat3 = Mat3::new(1.1, -0.4, 0.3, 0.8, -0.6, 0.9, -0.2, 0.5, 0.7);
