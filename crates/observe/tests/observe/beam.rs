//! Beams of solids along x, with any kernel, and their static deflection.

use powerhouse_elements::{Hex8BBar, Hex8Full, Pyramid5, SolidKernel, Tet4, Tet10, Wedge6};
use powerhouse_model::{
    BlockFactory, BlockOptions, BlockPart, Cadence, ConstitutiveLaw, ElasticMedium, ElementBlock,
    ElementKernel, HistoryVariable, Lane, LawInput, Mesh, NodalView, NodalViewMut, Operator,
    Precision, Quad, Stress, Vec3,
};
use powerhouse_observe::{CrossSection, SectionForces};

use super::Fields;
use super::plain::Plain;

/// Hooke's law.
#[derive(Clone)]
struct Linear(ElasticMedium);

impl ConstitutiveLaw for Linear {
    fn name(&self) -> &str {
        "linear"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &[]
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
        let one = input.strain.0[0].constant(1.0);
        let (lambda, shear) = (self.0.lambda(), self.0.shear());
        Stress::elastic(one.constant(lambda), one.constant(shear), &input.strain)
    }
}

/// A kernel by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kernel {
    OnePoint,
    Full,
    BBar,
    Wedge,
    Tet,
    Pyramid,
    Ten,
}

pub(crate) const KERNELS: [Kernel; 7] = [
    Kernel::OnePoint,
    Kernel::Full,
    Kernel::BBar,
    Kernel::Wedge,
    Kernel::Tet,
    Kernel::Pyramid,
    Kernel::Ten,
];

impl Kernel {
    pub(crate) fn factory(self, medium: ElasticMedium) -> Box<dyn BlockFactory> {
        match self {
            Self::OnePoint => one_point(medium, Precision::F64),
            Self::Full => plain(Hex8Full, medium),
            Self::BBar => plain(Hex8BBar, medium),
            Self::Wedge => plain(Wedge6, medium),
            Self::Tet => plain(Tet4, medium),
            Self::Pyramid => plain(Pyramid5, medium),
            Self::Ten => plain(Tet10::new(&medium), medium),
        }
    }
    /// A box of the kernel's elements.
    pub(crate) fn mesh(self, low: Vec3, high: Vec3, cells: [usize; 3]) -> Mesh {
        let generator = match self {
            Self::Wedge => Mesh::box_of_wedges,
            Self::Tet | Self::Ten => Mesh::box_of_tets,
            Self::Pyramid => Mesh::box_of_pyramids,
            _ => Mesh::box_of_hexes,
        };
        let mesh = generator(low, high, cells, "beam").unwrap();
        match self {
            Self::Ten => mesh.with_midpoints().unwrap(),
            _ => mesh,
        }
    }
}

fn plain<K: ElementKernel<N, P>, const N: usize, const P: usize>(
    kernel: K,
    medium: ElasticMedium,
) -> Box<dyn BlockFactory> {
    Box::new(Plain { kernel, medium })
}

/// The engine's own blocks of one-point bricks.
pub(crate) fn one_point(medium: ElasticMedium, precision: Precision) -> Box<dyn BlockFactory> {
    let mut options = BlockOptions::default();
    options.precision = precision;
    SolidKernel::ONE_POINT.factory("beam", Linear(medium), options)
}

/// A body of one set, as one block.
pub(crate) struct Body {
    pub(crate) mesh: Mesh,
    pub(crate) medium: ElasticMedium,
    pub(crate) block: Box<dyn ElementBlock>,
}

impl Body {
    pub(crate) fn new(mesh: Mesh, kernel: Kernel, medium: ElasticMedium) -> Self {
        Self::of(mesh, &*kernel.factory(medium), medium)
    }

    pub(crate) fn of(mesh: Mesh, factory: &dyn BlockFactory, medium: ElasticMedium) -> Self {
        let every: Vec<u32> = (0..mesh.node_count() as u32).collect();
        let elements: Vec<u32> = (0..mesh.element_count() as u32).collect();
        let part = BlockPart::new(&mesh, &elements, &every);
        let block = factory.build(&part).unwrap();
        Self {
            mesh,
            medium,
            block,
        }
    }

    fn stiffness_times(&self, x: &[Vec3]) -> Vec<Vec3> {
        let x: Vec<Quad<f64>> = x.iter().map(Quad::from_vector).collect();
        let mut out = vec![Quad::<f64>::default(); x.len()];
        let (x, y) = (NodalView::F64(&x), NodalViewMut::F64(&mut out));
        self.block.apply(Operator::Elastic, x, y);
        out.into_iter().map(Quad::to_vector).collect()
    }

    /// The displacement under nodal forces with some nodes held, by conjugate gradients.
    pub(crate) fn deflection(&self, held: &[u32], forces: &[Vec3]) -> Vec<Vec3> {
        let release = |values: &mut [Vec3]| {
            for &node in held {
                values[node as usize] = Vec3::zeros();
            }
        };
        let dot = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
        let mut residual = forces.to_vec();
        release(&mut residual);
        let mut displacement = vec![Vec3::zeros(); residual.len()];
        let mut direction = residual.clone();
        let start = dot(&residual, &residual);
        let mut square = start;
        for _ in 0..20 * residual.len() {
            if square <= 1e-24 * start {
                return displacement;
            }
            let mut image = self.stiffness_times(&direction);
            release(&mut image);
            let step = square / dot(&direction, &image);
            for i in 0..residual.len() {
                displacement[i] += step * direction[i];
                residual[i] -= step * image[i];
            }
            let next = dot(&residual, &residual);
            for i in 0..residual.len() {
                direction[i] = residual[i] + direction[i] * (next / square);
            }
            square = next;
        }
        panic!("no convergence: {square:e} of {start:e}");
    }

    /// The section forces of a cut at a displacement: the nine columns in their order.
    pub(crate) fn section(&self, cut: &CrossSection, displacement: &[Vec3]) -> Vec<f64> {
        let mut observer = SectionForces::new(Cadence::Steps(1)).unwrap();
        observer
            .add_section(&self.mesh, cut, self.elements())
            .unwrap();
        self.observed(observer, displacement)
    }

    pub(crate) fn elements(&self) -> &[u32] {
        self.mesh.element_set("beam").unwrap()
    }

    /// What an observer records of one step.
    pub(crate) fn observed(&self, mut observer: SectionForces, displacement: &[Vec3]) -> Vec<f64> {
        let recording = observer.recording();
        let nodes: Vec<Quad<f64>> = displacement.iter().map(Quad::from_vector).collect();
        let mut view = Fields::at_rest(self.mesh.node_count());
        view.forces = Box::new(|element, out| {
            let (place, nodes) = (element as usize, NodalView::F64(&nodes));
            let initial = Stress::default();
            let forces = self
                .block
                .output()
                .and_then(|output| output.element_forces());
            forces.is_some_and(|forces| {
                forces.write_forces(place, nodes, &initial, out);
                true
            })
        });
        view.show(&mut observer, 0.0);
        let table = recording.copy();
        table
            .columns
            .iter()
            .map(|column| column.values[0])
            .collect()
    }
}

/// A cut across x with the width along y.
pub(crate) fn cut_at(x: f64) -> CrossSection {
    CrossSection {
        name: "cut".into(),
        point: Vec3::new(x, 0.0, 0.0),
        normal: Vec3::x(),
        along: Vec3::y(),
        within: None,
    }
}
