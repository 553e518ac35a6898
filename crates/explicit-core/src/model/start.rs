//! Which elements are there, and from where their strain counts.

use std::borrow::Cow;

use powerhouse_model::{Mesh, MeshError, Quad, State, Vec3};

use super::builder::ElementSet;
use super::{ElementChoice, Model};
use crate::EngineError;

/// Elements that one factory makes, all cast at the same time.
pub(super) struct Piece<'a> {
    /// The factory.
    pub(super) set: usize,
    /// Mesh indices.
    pub(super) elements: Cow<'a, [u32]>,
    /// Which of the state's casts they belong to.
    pub(super) cast: Option<usize>,
    /// Whether their arithmetic is in double precision whatever the factory says.
    pub(super) double: bool,
}

/// What a model starts from, as far as it decides of what the model is made.
#[derive(Default)]
pub(super) struct Start {
    pub(super) state: Option<State>,
}

impl Start {
    /// Which elements of the mesh are not there.
    pub(super) fn absent(&self, mesh: &Mesh) -> Result<Vec<bool>, EngineError> {
        let mut absent = vec![false; mesh.element_count()];
        for &element in self.state.iter().flat_map(|state| &state.absent) {
            *absent
                .get_mut(element as usize)
                .ok_or_else(|| beyond("absent elements", element))? = true;
        }
        Ok(absent)
    }

    /// The elements of each set that are there, those that were cast later apart.
    pub(super) fn pieces<'a>(
        &self,
        mesh: &'a Mesh,
        sets: &'a [ElementSet],
        absent: &[bool],
    ) -> Result<Vec<Piece<'a>>, EngineError> {
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
        let mut pieces = Vec::new();
        for (set, (choice, _)) in sets.iter().enumerate() {
            let elements: &[u32] = match choice {
                ElementChoice::Set(name) => mesh.element_set(name)?,
                ElementChoice::Elements(elements) => elements,
            };
            if whole {
                pieces.push(Piece {
                    set,
                    elements: Cow::Borrowed(elements),
                    cast: None,
                    double: false,
                });
                continue;
            }
            let there = |element: &u32| !absent.get(*element as usize).copied().unwrap_or(false);
            let cast = |element: u32| cast_of.get(element as usize).copied().flatten();
            let mut kinds: Vec<Option<usize>> = elements.iter().map(|&e| cast(e)).collect();
            kinds.sort_unstable();
            kinds.dedup();
            for kind in kinds {
                let own = elements.iter().copied().filter(there);
                pieces.push(Piece {
                    set,
                    elements: own.filter(|&element| cast(element) == kind).collect(),
                    cast: kind,
                    double: false,
                });
            }
        }
        Ok(pieces)
    }

    /// The displacement (m) from which the strain of a cast counts, in the engine's numbering.
    pub(super) fn reference(&self, cast: usize, engine_of: &[u32]) -> Vec<Quad<f64>> {
        let mut reference = vec![Quad::default(); engine_of.len()];
        let cast = self.state.as_ref().and_then(|state| state.casts.get(cast));
        let moved = cast.map_or(&[][..], |cast| &cast.displacement);
        for (&engine, u) in engine_of.iter().zip(moved) {
            reference[engine as usize] = Quad::from_vector(u);
        }
        reference
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
    /// Nodal forces (N, engine numbering) that the initial stresses ask for: the integral of
    /// `B^T sigma_0` over the elements that are there.
    pub(crate) fn forces_of_initial_stress(&self) -> Vec<Vec3> {
        let mut forces = vec![Vec3::zeros(); self.mass.len()];
        if self.initial_stress.is_empty() {
            return forces;
        }
        for block in &self.blocks {
            let of_block = block.elements().iter();
            let stresses: Vec<_> = of_block
                .map(|&e| self.initial_stress.get(e as usize).copied())
                .map(Option::unwrap_or_default)
                .collect();
            let mut own = vec![Vec3::zeros(); block.nodes().len()];
            block.add_forces_of(&stresses, &mut own);
            for (&node, force) in block.nodes().iter().zip(own) {
                forces[node as usize] += force;
            }
        }
        forces
    }
}
