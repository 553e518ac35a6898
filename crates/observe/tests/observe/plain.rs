//! Blocks of any kernel, one element after another: enough to apply its elastic operator.

use std::collections::HashMap;

use powerhouse_model::{
    BlockContext, BlockEnergy, BlockFactory, BlockOptions, BlockOutput, BlockPart, BlockStiffness,
    ElasticMedium, ElementBlock, ElementFault, ElementForces, ElementKernel, ElementKind,
    FrequencyBound, Geometry, Hourglass, KernelArithmetic, ModelError, NodalView, NodalViewMut,
    Operator, Quad, Stress, Vec3,
};

/// Makes plain blocks.
pub(crate) struct Plain<K, const N: usize, const P: usize> {
    pub(crate) kernel: K,
    pub(crate) medium: ElasticMedium,
}

impl<K: ElementKernel<N, P>, const N: usize, const P: usize> BlockFactory for Plain<K, N, P> {
    fn label(&self) -> &str {
        "plain"
    }
    fn kind(&self) -> ElementKind {
        self.kernel.kind()
    }
    fn options(&self) -> BlockOptions {
        BlockOptions::default()
    }
    fn build(&self, part: &BlockPart) -> Result<Box<dyn ElementBlock>, ModelError> {
        let place_of: HashMap<u32, usize> = part.nodes.iter().copied().zip(0..).collect();
        let mut places = Vec::new();
        let mut geometries = Vec::new();
        for &element in part.elements {
            if part.mesh.kind(element) != self.kernel.kind() {
                return Err(ModelError::refused("plain", "another kind of element"));
            }
            let nodes = part.mesh.nodes_of(element);
            let corners: [Vec3; N] =
                core::array::from_fn(|a| part.mesh.positions()[nodes[a] as usize]);
            let mut numbers = vec![0.0; self.kernel.geometry_len()];
            self.kernel.geometry(&corners, &mut numbers);
            geometries.push(numbers);
            places.push(core::array::from_fn(|a| place_of[&nodes[a]]));
        }
        Ok(Box::new(PlainBlock::<K, N, P> {
            kernel: self.kernel.clone(),
            medium: self.medium,
            elements: part.elements.to_vec(),
            nodes: part.nodes.to_vec(),
            places,
            geometries,
        }))
    }
}

struct PlainBlock<K, const N: usize, const P: usize> {
    kernel: K,
    medium: ElasticMedium,
    elements: Vec<u32>,
    nodes: Vec<u32>,
    places: Vec<[usize; N]>,
    geometries: Vec<Vec<f64>>,
}

impl<K: ElementKernel<N, P>, const N: usize, const P: usize> PlainBlock<K, N, P> {
    /// Modes and stresses of an element.
    fn state(&self, element: usize, x: &NodalView) -> ([[f64; 3]; N], [Stress; P]) {
        let nodal: [[f64; 3]; N] = core::array::from_fn(|a| {
            x.vector(self.nodes[self.places[element][a]] as usize)
                .into()
        });
        let geometry = Geometry::<f64>::new((), &self.geometries[element]);
        let modes = self.kernel.modes(&nodal);
        let strains = self.kernel.strains(geometry, &modes);
        let (lambda, shear) = (self.medium.lambda(), self.medium.shear());
        (
            modes,
            strains.map(|strain| Stress::elastic(lambda, shear, &strain)),
        )
    }
    /// Nodal forces of an element.
    fn forces_of(&self, element: usize, x: &NodalView) -> [[f64; 3]; N] {
        let (modes, stresses) = self.state(element, x);
        let geometry = Geometry::<f64>::new((), &self.geometries[element]);
        let hourglass = Hourglass::new([self.medium.constrained(), 0.0, 0.0]);
        let forces = self.kernel.forces(geometry, &stresses, &hourglass, &modes);
        self.kernel.nodal_forces(&forces)
    }
}

impl<K: ElementKernel<N, P>, const N: usize, const P: usize> ElementBlock for PlainBlock<K, N, P> {
    fn label(&self) -> &str {
        "plain"
    }
    fn elements(&self) -> &[u32] {
        &self.elements
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        self.apply(Operator::Elastic, context.displacement, out);
        Ok(())
    }
    fn add_mass(&self, _out: &mut [f64]) {}
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        Vec::new()
    }
    fn stiffness(&self) -> Option<&dyn BlockStiffness> {
        Some(self)
    }
    fn output(&self) -> Option<&dyn BlockOutput> {
        Some(self)
    }
}

impl<K: ElementKernel<N, P>, const N: usize, const P: usize> BlockStiffness
    for PlainBlock<K, N, P>
{
    fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
        let NodalViewMut::F64(out) = out else {
            panic!("plain blocks compute in double precision");
        };
        let mut sums = vec![Vec3::zeros(); out.len()];
        for (element, places) in self.places.iter().enumerate() {
            for (&place, force) in places.iter().zip(self.forces_of(element, &x)) {
                sums[place] += Vec3::from(force);
            }
        }
        for (out, sum) in out.iter_mut().zip(sums) {
            *out = Quad::from_vector(&sum);
        }
    }
}

impl<K: ElementKernel<N, P>, const N: usize, const P: usize> BlockOutput for PlainBlock<K, N, P> {
    fn energy(&self, _context: &BlockContext) -> BlockEnergy {
        BlockEnergy::default()
    }
    fn element_forces(&self) -> Option<&dyn ElementForces> {
        Some(self)
    }
}

impl<K: ElementKernel<N, P>, const N: usize, const P: usize> ElementForces for PlainBlock<K, N, P> {
    fn write_forces(
        &self,
        index: usize,
        displacement: NodalView,
        _initial: &Stress,
        out: &mut [Vec3],
    ) {
        for (out, force) in out.iter_mut().zip(self.forces_of(index, &displacement)) {
            *out = Vec3::from(force);
        }
    }
}
