//! Active elements of a model and their reference configurations, from its initial state.

use std::borrow::Cow;
use std::collections::HashMap;

use powerhouse_model::{ElementChoice, EngineError, Mesh, MeshError, Quad, State, Stress, Vec3};

use super::Model;
use super::builder::ElementSet;

/// Active elements of one set with the same reference configuration and precision.
pub(super) struct ElementSubset<'a> {
    /// Index of the set and its factory.
    pub(super) set: usize,
    /// Mesh indices of the elements.
    pub(super) elements: Cow<'a, [u32]>,
    /// Index of their cast in the state; none for elements without a reference displacement.
    pub(super) cast: Option<usize>,
    /// Whether they are computed in double precision regardless of the factory's options.
    pub(super) double: bool,
}

/// Initial state of a model, which determines its active elements.
#[derive(Default)]
pub(super) struct InitialState {
    pub(super) state: Option<State>,
    /// Node of the mesh of each node of the elements; empty where these are the nodes of the mesh.
    pub(super) node_of: Vec<u32>,
}

impl InitialState {
    /// One flag per element of the mesh: whether it is absent.
    pub(super) fn absent(&self, mesh: &Mesh) -> Result<Vec<bool>, EngineError> {
        let mut absent = vec![false; mesh.element_count()];
        for &element in self.state.iter().flat_map(|state| &state.absent) {
            *absent
                .get_mut(element as usize)
                .ok_or_else(|| beyond("absent elements", element))? = true;
        }
        Ok(absent)
    }

    /// The active elements of each set, divided by their casts.
    pub(super) fn subsets<'a>(
        &self,
        mesh: &'a Mesh,
        sets: &'a [ElementSet],
        absent: &[bool],
    ) -> Result<Vec<ElementSubset<'a>>, EngineError> {
        let mut cast_of = vec![None; mesh.element_count()];
        let casts = self.state.iter().flat_map(|state| state.casts.iter());
        for (index, cast) in casts.enumerate() {
            for &element in &cast.elements {
                *cast_of
                    .get_mut(element as usize)
                    .ok_or_else(|| beyond("cast elements", element))? = Some(index);
            }
        }
        let whole = self.state.as_ref().is_none_or(|state| {
            state.absent.is_empty() && state.casts.iter().all(|cast| cast.elements.is_empty())
        });
        let mut subsets = Vec::new();
        for (set, (choice, _)) in sets.iter().enumerate() {
            let elements: &[u32] = match choice {
                ElementChoice::Set(name) => mesh.element_set(name)?,
                ElementChoice::Elements(elements) => elements,
            };
            if whole {
                subsets.push(ElementSubset {
                    set,
                    elements: Cow::Borrowed(elements),
                    cast: None,
                    double: false,
                });
                continue;
            }
            let active = |element: &u32| !absent.get(*element as usize).copied().unwrap_or(false);
            let cast = |element: u32| cast_of.get(element as usize).copied().flatten();
            let mut kinds: Vec<Option<usize>> = elements.iter().map(|&e| cast(e)).collect();
            kinds.sort_unstable();
            kinds.dedup();
            for kind in kinds {
                let own = elements.iter().copied().filter(active);
                subsets.push(ElementSubset {
                    set,
                    elements: own.filter(|&element| cast(element) == kind).collect(),
                    cast: kind,
                    double: false,
                });
            }
        }
        Ok(subsets)
    }

    /// Reference displacement (m) of a cast at some nodes of its elements, at which these are free of stress.
    pub(super) fn reference(&self, cast: usize, nodes: &[u32]) -> Vec<Quad<f64>> {
        let cast = self.state.as_ref().and_then(|state| state.casts.get(cast));
        let moved = cast.map_or(&[][..], |cast| &cast.displacement);
        let of = |node: &u32| {
            let node = self.node_of.get(*node as usize).unwrap_or(node);
            moved.get(*node as usize).copied().unwrap_or_default()
        };
        (nodes.iter())
            .map(|node| Quad::from_vector(&of(node)))
            .collect()
    }
}

fn beyond(name: &str, element: u32) -> EngineError {
    MeshError::SetOutOfRange {
        what: "element",
        name: name.into(),
        number: u64::from(element),
    }
    .into()
}

impl Model {
    /// The mesh whose nodes are those of the blocks of elements: that of the model, or of a bay the one in which every element has
    /// nodes of its own.
    pub(crate) fn mesh_of_elements(&self) -> &Mesh {
        self.bay.as_ref().map_or(&self.mesh, |bay| &bay.mesh)
    }

    /// Internal nodal forces (N, by local node) of the initial stress: the integral of
    /// `B^T sigma_0` over the active elements.
    pub(crate) fn forces_of_initial_stress(&mut self) -> Vec<Vec3> {
        if self.initial.is_empty() {
            return vec![Vec3::zeros(); self.mass.len()];
        }
        self.assembled(|model, index| {
            let block = &model.blocks[index];
            let stresses: Vec<_> = (block.elements().iter())
                .map(|&element| model.initial.stress(element))
                .collect();
            let mut own = vec![Vec3::zeros(); model.subdomain.nodes_of(index).len()];
            if let Some(stateful) = block.stateful() {
                stateful.add_forces_of(&stresses, &mut own);
            }
            let place_of: HashMap<u32, usize> = block.nodes().iter().copied().zip(0..).collect();
            for &element in block.elements() {
                let nodes = model.mesh_of_elements().nodes_of(element);
                let mut forces = vec![Vec3::zeros(); nodes.len()];
                (model.initial).add_forces_of_slope(&model.mesh, element, &mut forces);
                for (node, force) in nodes.iter().zip(forces) {
                    own[place_of[node]] += force;
                }
            }
            own
        })
    }
}

/// Initial stress of the elements of the mesh, and its increase with height.
#[derive(Default)]
pub(crate) struct InitialStress {
    /// At the centroids (Pa), one per element; empty without initial stress.
    pub(crate) at_centroid: Vec<Stress>,
    /// Per height (Pa/m), one per element; empty where it is the same all over each element.
    pub(crate) slope: Vec<Stress>,
}

impl InitialStress {
    pub(crate) fn is_empty(&self) -> bool {
        self.at_centroid.is_empty()
    }
    /// Stress (Pa) at the centroid of an element.
    pub(crate) fn stress(&self, element: u32) -> Stress {
        let stress = self.at_centroid.get(element as usize);
        stress.copied().unwrap_or_default()
    }
    /// Adds the internal forces (N) of the slope to those of the nodes of an element.
    pub(crate) fn add_forces_of_slope(&self, mesh: &Mesh, element: u32, forces: &mut [Vec3]) {
        let slope = self.slope.get(element as usize).copied();
        if let Some(slope) = slope.filter(|slope| *slope != Stress::default()) {
            mesh.add_forces_of_slope(element, &slope, forces);
        }
    }
}
