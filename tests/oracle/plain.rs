//! Elements of any kernel and law, one after another and one integration point after another.

use std::collections::HashMap;

use powerhouse_model::{
    BlockContext, BlockEnergy, BlockFactory, BlockOptions, BlockOutput, BlockPart, ConstitutiveLaw,
    DampedBlock, ElementBlock, ElementFault, ElementKernel, ElementKind, Extents, FrequencyBound,
    Geometry, HistoryField, Hourglass, KernelArithmetic, LawInput, ModelError, NodalView,
    NodalViewMut, Quad, Rayleigh, StatefulBlock, Strain, Stress, Vec3,
};

/// Factory of plain blocks of a kernel and a law, with Rayleigh damping.
pub(crate) struct Plain<K, M> {
    pub(crate) set: &'static str,
    pub(crate) kernel: K,
    pub(crate) law: M,
    pub(crate) damping: Rayleigh,
}

/// What a block knows of one element.
struct Element<const N: usize> {
    /// Indices of the nodes among those of the block.
    nodes: [usize; N],
    numbers: Vec<f64>,
    masses: [f64; N],
    extents: Extents<f64>,
    /// History variables of all points, committed and new.
    history: Vec<f64>,
    new_history: Vec<f64>,
}

struct PlainBlock<K, M, const N: usize, const P: usize> {
    set: &'static str,
    kernel: K,
    law: M,
    damping: Rayleigh,
    hourglass: [f64; 3],
    elements: Vec<u32>,
    nodes: Vec<u32>,
    parts: Vec<Element<N>>,
}

impl<K, M, const N: usize, const P: usize> BlockFactory for Typed<K, M, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
{
    fn label(&self) -> &str {
        self.0.set
    }
    fn kind(&self) -> ElementKind {
        self.0.kernel.kind()
    }
    fn options(&self) -> BlockOptions {
        let mut options = BlockOptions::default();
        options.damping = self.0.damping;
        options
    }
    fn build(&self, part: &BlockPart) -> Result<Box<dyn ElementBlock>, ModelError> {
        let Plain {
            set,
            kernel,
            law,
            damping,
        } = &self.0;
        let medium = law.medium();
        let index_of: HashMap<u32, usize> = part.nodes.iter().copied().zip(0..).collect();
        let parts = part.elements.iter().map(|&element| {
            let own = part.mesh.nodes_of(element);
            let corners: [Vec3; N] =
                core::array::from_fn(|a| part.mesh.positions()[own[a] as usize]);
            let mut numbers = vec![0.0; kernel.geometry_len()];
            kernel.geometry(&corners, &mut numbers);
            let volumes = kernel.volumes(Geometry::<f64>::new((), &numbers));
            let mass = medium.density * volumes.iter().sum::<f64>();
            let count = P * law.history().len();
            Element {
                nodes: core::array::from_fn(|a| index_of[&own[a]]),
                masses: kernel.node_shares(&corners).map(|share| share * mass),
                extents: Extents::of_element(kernel.kind(), &corners),
                numbers,
                history: vec![0.0; count],
                new_history: vec![0.0; count],
            }
        });
        let moduli = kernel.hourglass_moduli(&medium);
        Ok(Box::new(PlainBlock::<K, M, N, P> {
            set,
            kernel: kernel.clone(),
            law: law.clone(),
            damping: *damping,
            hourglass: moduli.unwrap_or_default(),
            elements: part.elements.to_vec(),
            nodes: part.nodes.to_vec(),
            parts: parts.collect(),
        }))
    }
}

/// A factory with the numbers of nodes and integration points of its kernel.
struct Typed<K, M, const N: usize, const P: usize>(Plain<K, M>);

impl<K, M: ConstitutiveLaw> Plain<K, M> {
    pub(crate) fn boxed<const N: usize, const P: usize>(self) -> Box<dyn BlockFactory>
    where
        K: ElementKernel<N, P>,
    {
        Box::new(Typed::<K, M, N, P>(self))
    }
}

impl<K, M, const N: usize, const P: usize> PlainBlock<K, M, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
{
    /// Modal values of the nodes of an element.
    fn modes(&self, element: &Element<N>, values: &NodalView) -> [[f64; 3]; N] {
        let nodal: [[f64; 3]; N] = element.nodes.map(|node| values.vector(node).into());
        self.kernel.modes(&nodal)
    }
    /// Change of stress at each point, and the new history variables.
    fn stresses(
        &self,
        law: &M,
        element: &Element<N>,
        strains: &[Strain; P],
    ) -> ([Stress; P], Vec<f64>) {
        let count = law.history().len();
        let mut new = vec![0.0; P * count];
        let stresses = core::array::from_fn(|p| {
            let own = p * count..(p + 1) * count;
            let input = LawInput::new(strains[p], &element.history[own.clone()])
                .with_extents(element.extents);
            law.stress_change(&input, &mut new[own])
        });
        (stresses, new)
    }
}

impl<K, M, const N: usize, const P: usize> ElementBlock for PlainBlock<K, M, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
{
    fn label(&self) -> &str {
        self.set
    }
    fn elements(&self) -> &[u32] {
        &self.elements
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        let NodalViewMut::F64(out) = out else {
            panic!("plain blocks compute in double precision");
        };
        let law = self.law.for_step(context.step);
        let medium = law.medium();
        let coefficient = self.damping.stiffness + context.damping_shift;
        let mut sums = vec![Vec3::zeros(); out.len()];
        for index in 0..self.parts.len() {
            let element = &self.parts[index];
            let geometry = Geometry::<f64>::new((), &element.numbers);
            let mut modes = self.modes(element, &context.displacement);
            let rates = self.modes(element, &context.velocity);
            let strains = self.kernel.strains(geometry, &modes);
            let (mut stresses, new) = self.stresses(&law, element, &strains);
            // Stiffness damping of a linear law: `b K v`.
            let strain_rates = self.kernel.strains(geometry, &rates);
            for (stress, rate) in stresses.iter_mut().zip(&strain_rates) {
                let damped = Stress::elastic(medium.lambda(), medium.shear(), rate);
                for (sum, part) in stress.0.iter_mut().zip(damped.0) {
                    *sum += coefficient * part;
                }
            }
            for (mode, rate) in modes.iter_mut().flatten().zip(rates.iter().flatten()) {
                *mode += coefficient * rate;
            }
            let forces =
                self.kernel
                    .forces(geometry, &stresses, &Hourglass::new(self.hourglass), &modes);
            let forces = self.kernel.nodal_forces(&forces);
            for (&node, force) in element.nodes.iter().zip(forces) {
                sums[node] += Vec3::from(force);
            }
            self.parts[index].new_history = new;
        }
        for (out, sum) in out.iter_mut().zip(sums) {
            *out = Quad::from_vector(&sum);
        }
        Ok(())
    }
    fn add_mass(&self, out: &mut [f64]) {
        for element in &self.parts {
            for (&node, mass) in element.nodes.iter().zip(element.masses) {
                out[node] += mass;
            }
        }
    }
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        Vec::new()
    }
    fn damped(&self) -> Option<&dyn DampedBlock> {
        Some(self)
    }
    fn output(&self) -> Option<&dyn BlockOutput> {
        Some(self)
    }
    fn stateful(&self) -> Option<&dyn StatefulBlock> {
        Some(self)
    }
    fn stateful_mut(&mut self) -> Option<&mut dyn StatefulBlock> {
        Some(self)
    }
}

impl<K, M, const N: usize, const P: usize> DampedBlock for PlainBlock<K, M, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
{
    fn damping(&self) -> Rayleigh {
        self.damping
    }
}

impl<K, M, const N: usize, const P: usize> BlockOutput for PlainBlock<K, M, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
{
    fn energy(&self, _context: &BlockContext) -> BlockEnergy {
        BlockEnergy::default()
    }
    fn add_stress(&self, displacement: NodalView, out: &mut [Stress]) {
        for (element, out) in self.parts.iter().zip(out) {
            let geometry = Geometry::<f64>::new((), &element.numbers);
            let modes = self.modes(element, &displacement);
            let strains = self.kernel.strains(geometry, &modes);
            let (stresses, _) = self.stresses(&self.law, element, &strains);
            let volumes = self.kernel.volumes(geometry);
            let whole: f64 = volumes.iter().sum();
            for (stress, volume) in stresses.iter().zip(volumes) {
                for (sum, part) in out.0.iter_mut().zip(stress.0) {
                    *sum += part * volume / whole;
                }
            }
        }
    }
}

impl<K, M, const N: usize, const P: usize> StatefulBlock for PlainBlock<K, M, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
{
    fn commit(&mut self) {
        for element in &mut self.parts {
            element.history.clone_from(&element.new_history);
        }
    }
    fn history(&self) -> Vec<HistoryField> {
        Vec::new()
    }
    fn set_history(&mut self, _fields: &[HistoryField]) {}
    fn set_active(&mut self, _active: &[bool]) {}
    fn set_reference_displacement(&mut self, _displacement: NodalView) {}
    fn set_initial_stress(&mut self, _stress: &[Stress]) {}
}
