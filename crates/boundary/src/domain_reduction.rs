//! Domain reduction method: the free field is applied in a layer of elements inside the mesh.

use std::collections::BTreeMap;

use powerhouse_model::{
    AbsorbingBoundary, BoundaryParts, BoundarySite, ElementBlock, FieldMotion, IncidentField, Mesh,
    ModelError, NodalLoad, Operator, Vec3,
};

use crate::BoundaryError;
use crate::field_load::{FieldForces, field_load};

/// Stiffness between the inner and the outer nodes of one element of the layer.
#[derive(Clone, Debug)]
struct Coupling {
    /// Indices of the inner and of the outer nodes in the layer's list of nodes.
    inner: Vec<u32>,
    outer: Vec<u32>,
    /// `K_be` (N/m): a row per inner node and axis, a column per outer node and axis.
    stiffness: Vec<f64>,
}

/// Layer of elements around a region in which the domain reduction method applies the free field.
///
/// Its elements are those outside the region that share nodes with it; their nodes on the region are
/// its inner side, all others its outer side. They must be elastic and undamped, and of the field's
/// medium: only then is the field a solution of their equations.
#[derive(Clone, Debug)]
pub struct ReductionLayer {
    nodes: Vec<u32>,
    positions: Vec<Vec3>,
    inner: Vec<bool>,
    couplings: Vec<Coupling>,
}

impl ReductionLayer {
    /// Elements of the layer around the region `inside`, as mesh indices in rising order.
    ///
    /// # Panics
    /// If an element does not belong to the mesh.
    ///
    /// ```
    /// use powerhouse_boundary::ReductionLayer;
    /// use powerhouse_model::{Mesh, Vec3};
    /// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(5.0), [5, 5, 5], "rock")?;
    /// let middle = mesh.elements_in_box(&Vec3::repeat(2.0), &Vec3::repeat(3.0));
    /// assert_eq!(ReductionLayer::elements(&mesh, &middle).len(), 26);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    #[must_use]
    pub fn elements(mesh: &Mesh, inside: &[u32]) -> Vec<u32> {
        let on_region = nodes_on(mesh, inside);
        let mut is_inside = vec![false; mesh.element_count()];
        for &element in inside {
            is_inside[element as usize] = true;
        }
        let touches = |element: &u32| {
            let nodes = mesh.nodes_of(*element);
            !is_inside[*element as usize] && nodes.iter().any(|&node| on_region[node as usize])
        };
        (0..mesh.element_count() as u32).filter(touches).collect()
    }

    /// Layer around the region `inside` (mesh indices of its elements). The block holds exactly the
    /// layer's [`elements`](Self::elements).
    ///
    /// # Errors
    /// [`BoundaryError::Layer`] if the block holds other elements, or if the layer has none.
    ///
    /// # Panics
    /// If an element or a node does not belong to the mesh.
    pub fn new(
        mesh: &Mesh,
        inside: &[u32],
        block: &dyn ElementBlock,
    ) -> Result<Self, BoundaryError> {
        let expected = Self::elements(mesh, inside);
        let mut found = block.elements().to_vec();
        found.sort_unstable();
        if expected.is_empty() || expected != found {
            return Err(BoundaryError::Layer {
                expected: expected.len(),
                found: found.len(),
            });
        }
        let nodes = mesh.nodes_of_elements(&expected);
        let index = |node: u32| nodes.partition_point(|&other| other < node) as u32;
        let on_region = nodes_on(mesh, inside);
        let mut couplings = Vec::with_capacity(expected.len());
        block.each_matrix(Operator::Elastic, &mut |local, matrix| {
            let of_mesh: Vec<u32> = (local.iter())
                .map(|&local| block.nodes()[local as usize])
                .collect();
            let (inner, outer): (Vec<usize>, Vec<usize>) =
                (0..of_mesh.len()).partition(|&corner| on_region[of_mesh[corner] as usize]);
            let size = 3 * of_mesh.len();
            let rows = inner.iter().flat_map(|corner| 3 * corner..3 * corner + 3);
            let columns = || outer.iter().flat_map(|corner| 3 * corner..3 * corner + 3);
            let stiffness = rows
                .flat_map(|row| columns().map(move |column| matrix[row * size + column]))
                .collect();
            let indices = |corners: &[usize]| corners.iter().map(|&c| index(of_mesh[c])).collect();
            couplings.push(Coupling {
                inner: indices(&inner),
                outer: indices(&outer),
                stiffness,
            });
        });
        Ok(Self {
            positions: (nodes.iter())
                .map(|&node| mesh.positions()[node as usize])
                .collect(),
            inner: nodes.iter().map(|&node| on_region[node as usize]).collect(),
            nodes,
            couplings,
        })
    }

    /// Nodes of the layer, as mesh indices in rising order.
    #[must_use]
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Positions of the nodes (m), in their order.
    #[must_use]
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Whether each of the nodes belongs to the region: to the inner side of the layer.
    #[must_use]
    pub fn inner(&self) -> &[bool] {
        &self.inner
    }

    /// Effective nodal forces of a field, as loads.
    fn loads(&self, field: &dyn IncidentField) -> Result<Vec<Box<dyn NodalLoad>>, ModelError> {
        field.check_layer(&self.positions, &self.inner)?;
        let mut loads: Vec<Box<dyn NodalLoad>> = Vec::new();
        for couplings in self.couplings.chunks(ELEMENTS_PER_LOAD) {
            let touched = couplings
                .iter()
                .flat_map(|c| c.inner.iter().chain(&c.outer));
            let mut own: BTreeMap<u32, u32> = touched.map(|&index| (index, 0)).collect();
            for (number, own) in own.values_mut().enumerate() {
                *own = number as u32;
            }
            let renumbered = |indices: &[u32]| indices.iter().map(|index| own[index]).collect();
            let of_nodes = || own.keys().map(|&index| index as usize);
            let points: Vec<Vec3> = of_nodes().map(|index| self.positions[index]).collect();
            let nodes = of_nodes().map(|index| self.nodes[index]).collect();
            let couplings: Vec<Coupling> = (couplings.iter())
                .map(|coupling| Coupling {
                    inner: renumbered(&coupling.inner),
                    outer: renumbered(&coupling.outer),
                    stiffness: coupling.stiffness.clone(),
                })
                .collect();
            let sampler = field.prepare(&points)?;
            loads.push(field_load(field.name(), nodes, sampler, couplings));
        }
        Ok(loads)
    }
}

/// Number of elements per load.
const ELEMENTS_PER_LOAD: usize = 64;

/// Flags of the mesh nodes that belong to any of the elements.
fn nodes_on(mesh: &Mesh, elements: &[u32]) -> Vec<bool> {
    let mut on = vec![false; mesh.node_count()];
    for &element in elements {
        for &node in mesh.nodes_of(element) {
            on[node as usize] = true;
        }
    }
    on
}

impl FieldForces for Vec<Coupling> {
    fn add(&self, motion: &[FieldMotion], forces: &mut [Vec3]) {
        let moved = |index: u32| motion[index as usize].displacement;
        for coupling in self {
            let mut numbers = coupling.stiffness.iter();
            for &inner in &coupling.inner {
                let of_inner = moved(inner);
                for axis in 0..3 {
                    let mut force = 0.0;
                    for &outer in &coupling.outer {
                        let of_outer = moved(outer);
                        for (other, number) in (0..3).zip(&mut numbers) {
                            force += number * of_outer[other];
                            forces[outer as usize][other] += number * of_inner[axis];
                        }
                    }
                    forces[inner as usize][axis] -= force;
                }
            }
        }
    }
}

/// Domain reduction method: effective forces in a layer of elements bring the free field into the
/// mesh, and only scattered waves reach the absorbing boundary outside.
///
/// Inside the layer nodes carry the whole motion, outside it the scattered part alone. The layer's
/// stiffness `K`, split between its inner side b and its outer side e, turns the free field `u0`
/// into effective forces
///
/// `P_b = -K_be u0_e`, `P_e = K_eb u0_b`
///
/// (masses are lumped and couple nothing). Where the body inside is the ground of the field, and the
/// field is that of the mesh, the scattered part is zero; with a field in closed form it is the
/// difference between the two, which falls with the square of the element size.
///
/// Suited to deep or wide meshes: the field does not travel through the mesh, so that its numerical
/// dispersion does not accumulate, and only scattered waves meet the boundary. Not suited where
/// total motion is wanted outside the layer: results there lack the field.
///
/// Source: J. Bielak, K. Loukakis, Y. Hisada, C. Yoshimura (2003), Bull. Seism. Soc. Am. 93,
/// Eqs. 7-9.
pub struct DomainReduction {
    layer: ReductionLayer,
    outside: Box<dyn AbsorbingBoundary>,
}

impl DomainReduction {
    /// Boundary of a layer that applies the free field and an absorbing boundary around it.
    pub fn new(layer: ReductionLayer, outside: impl AbsorbingBoundary + 'static) -> Self {
        Self {
            layer,
            outside: Box::new(outside),
        }
    }
}

impl AbsorbingBoundary for DomainReduction {
    fn name(&self) -> &str {
        "domain-reduction"
    }
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
        let (faces, nodes) = (site.faces.clone(), site.nodes.clone());
        let silent = BoundarySite::new(faces, nodes, site.scatterer, None);
        let mut parts = self.outside.build(&silent)?;
        if let Some(field) = site.field {
            parts.loads.extend(self.layer.loads(field)?);
        }
        Ok(parts)
    }
}
