//! The virtual work of internal forces on a motion, as a linear function of stress and
//! displacement.

use powerhouse_model::{
    ElasticMedium, ElementKind, Mat3, Mesh, ModelError, NodalView, NodalViewMut, Numbering,
    Operator, Quad, StepView, Strain, Stress, Vec3,
};

use crate::{BlockFactory, BlockPart, Precision};

/// How many resultants a section has.
pub(super) const RESULTANTS: usize = 6;

/// Six virtual works, `sum_e sigma_e : S_e + sum_a L_a . (u_a - u_0)`.
#[derive(Clone, Debug)]
pub(super) struct Functional {
    /// Mesh indices of the elements.
    pub(super) elements: Vec<u32>,
    /// `S_e`, the integral of the virtual strain over the element (m3), for each virtual motion.
    strains: Vec<[Strain; RESULTANTS]>,
    /// Mesh indices of the nodes.
    pub(super) nodes: Vec<u32>,
    /// `L_a`, the part of the elastic forces (N/m) that mean stresses do not carry, for each
    /// virtual motion.
    forces: Vec<[Vec3; RESULTANTS]>,
}

impl Functional {
    /// The works of the internal forces of `elements` on virtual motions of their nodes, given by
    /// `virtual_motion(node)` (mesh index).
    ///
    /// The elastic operator `K` is that of the factory's own kernel. As it is symmetric, the work
    /// `w . K u` on a motion `w` is `(K w) . u`, and `K w` is computed once. What mean stresses carry
    /// of it is `(1/V) sum_a u_a . (D S_e) g_a` with the mean gradient `g_a = integral of grad N_a dV`.
    pub(super) fn new(
        mesh: &Mesh,
        elements: Vec<u32>,
        factory: &dyn BlockFactory,
        medium: &ElasticMedium,
        virtual_motion: impl Fn(u32) -> [Vec3; RESULTANTS],
    ) -> Result<Self, ModelError> {
        let nodes = mesh.nodes_of_elements(&elements);
        let motions: Vec<[Vec3; RESULTANTS]> =
            nodes.iter().map(|&node| virtual_motion(node)).collect();
        let mut forces = elastic_forces(mesh, &elements, &nodes, factory, &motions)?;
        let (lambda, shear) = (medium.lambda(), medium.shear());
        let mut strains = Vec::with_capacity(elements.len());
        for &element in &elements {
            let (volume, gradients) = mean_gradients(mesh, element);
            // Every node of an element is among the sorted nodes.
            let places: Vec<usize> = mesh
                .nodes_of(element)
                .iter()
                .map(|node| nodes.partition_point(|other| other < node))
                .collect();
            let strain: [Strain; RESULTANTS] = core::array::from_fn(|k| {
                let terms = places.iter().zip(&gradients);
                let gradient: Mat3 = terms
                    .map(|(&place, g)| motions[place][k] * g.transpose())
                    .sum();
                Strain::from_gradient(&gradient)
            });
            for (k, strain) in strain.iter().enumerate() {
                let stress = Stress::elastic(lambda, shear, strain);
                for (&place, gradient) in places.iter().zip(&gradients) {
                    forces[place][k] -= stress.traction(gradient) / volume;
                }
            }
            strains.push(strain);
        }
        Ok(Self {
            elements,
            strains,
            nodes,
            forces,
        })
    }

    /// Adds the works at a step.
    pub(super) fn add(&self, view: &dyn StepView, works: &mut [f64; RESULTANTS]) {
        for (&element, strains) in self.elements.iter().zip(&self.strains) {
            let stress = view.stress(element);
            for (work, strain) in works.iter_mut().zip(strains) {
                *work += stress.work(strain);
            }
        }
        self.add_nodal(
            |node| view.displacement(node) + view.stage_start(node),
            works,
        );
    }

    /// Adds the works of the elastic forces that mean stresses do not carry, of an absolute displacement.
    ///
    /// They are the same for a displacement less that of one node; less of it, the rounding of a
    /// factory in single precision stays small against the strains.
    pub(super) fn add_nodal(
        &self,
        displacement: impl Fn(u32) -> Vec3,
        works: &mut [f64; RESULTANTS],
    ) {
        let origin = self
            .nodes
            .first()
            .map_or(Vec3::zeros(), |&n| displacement(n));
        for (&node, forces) in self.nodes.iter().zip(&self.forces) {
            let relative = displacement(node) - origin;
            for (work, force) in works.iter_mut().zip(forces) {
                *work += force.dot(&relative);
            }
        }
    }
}

/// The elastic operator of a block made of the elements alone, on each motion.
fn elastic_forces(
    mesh: &Mesh,
    elements: &[u32],
    nodes: &[u32],
    factory: &dyn BlockFactory,
    motions: &[[Vec3; RESULTANTS]],
) -> Result<Vec<[Vec3; RESULTANTS]>, ModelError> {
    let mut numbering = Numbering {
        engine_of: vec![u32::MAX; mesh.node_count()],
        mesh_of: nodes.to_vec(),
    };
    for (place, &node) in nodes.iter().enumerate() {
        numbering.engine_of[node as usize] = place as u32;
    }
    let places: Vec<u32> = (0..nodes.len() as u32).collect();
    let block = factory.build(&BlockPart::new(mesh, elements, &numbering, &places))?;
    let mut forces = vec![[Vec3::zeros(); RESULTANTS]; nodes.len()];
    for k in 0..RESULTANTS {
        let motion = motions.iter().map(|motion| motion[k]);
        if factory.options().precision == Precision::F32 {
            let motion: Vec<Quad<f32>> = motion.map(|w| Quad::from_vector(&w)).collect();
            let mut out = vec![Quad::<f32>::default(); nodes.len()];
            let (x, y) = (NodalView::F32(&motion), NodalViewMut::F32(&mut out));
            block.apply(Operator::Elastic, x, y);
            for (forces, out) in forces.iter_mut().zip(out) {
                forces[k] = out.to_vector();
            }
        } else {
            let motion: Vec<Quad<f64>> = motion.map(|w| Quad::from_vector(&w)).collect();
            let mut out = vec![Quad::<f64>::default(); nodes.len()];
            let (x, y) = (NodalView::F64(&motion), NodalViewMut::F64(&mut out));
            block.apply(Operator::Elastic, x, y);
            for (forces, out) in forces.iter_mut().zip(out) {
                forces[k] = out.to_vector();
            }
        }
    }
    Ok(forces)
}

/// Volume (m3) and the integrals of the shape functions' gradients (m2) over an element, exact.
fn mean_gradients(mesh: &Mesh, element: u32) -> (f64, Vec<Vec3>) {
    let kind = mesh.kind(element);
    let nodes = mesh.nodes_of(element);
    let mut by_natural = vec![Vec3::zeros(); nodes.len()];
    let mut gradients = vec![Vec3::zeros(); nodes.len()];
    let mut volume = 0.0;
    for (natural, weight) in quadrature(kind) {
        kind.shape_gradients(&natural, &mut by_natural);
        let terms = nodes.iter().zip(&by_natural);
        let jacobian: Mat3 = terms
            .map(|(&node, g)| mesh.positions()[node as usize] * g.transpose())
            .sum();
        volume += weight * jacobian.determinant();
        // Rows of the cofactor matrix: det J times the inverse, transposed.
        let [r, s, t] = [0, 1, 2].map(|i| jacobian.column(i).into_owned());
        let cofactors = Mat3::from_columns(&[s.cross(&t), t.cross(&r), r.cross(&s)]);
        for (gradient, g) in gradients.iter_mut().zip(&by_natural) {
            *gradient += cofactors * g * weight;
        }
    }
    (volume, gradients)
}

/// Points and weights that integrate volume and mean gradients exactly.
fn quadrature(kind: ElementKind) -> Vec<(Vec3, f64)> {
    let g = 1.0 / 3.0_f64.sqrt();
    match kind {
        ElementKind::Tet4 => vec![(kind.natural_centre(), 1.0 / 6.0)],
        ElementKind::Wedge6 => [(1.0, 1.0), (4.0, 1.0), (1.0, 4.0)]
            .into_iter()
            .flat_map(|(r, s)| [-g, g].map(|t| (Vec3::new(r / 6.0, s / 6.0, t), 1.0 / 6.0)))
            .collect(),
        _ => kind
            .natural_corners()
            .iter()
            .map(|&corner| (Vec3::from(corner) * g, 1.0))
            .collect(),
    }
}
