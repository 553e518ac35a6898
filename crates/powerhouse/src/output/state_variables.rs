//! History variables of the laws of a scene, by element.

use std::collections::HashSet;

use powerhouse_model::{Cadence, HistoryVariable, Mesh, ModelError};
use powerhouse_observe::StatePeaks;

use super::OutputPlan;
use crate::{Error, Scene};

/// Interval longer than any run (s), by which values are sampled at the start and end only.
const BEYOND_END: f64 = f64::MAX;

/// History variables of the laws of a scene, by element.
#[derive(Clone, Debug, Default)]
pub(crate) struct StateVariables {
    /// All history variables, without repetitions of names.
    pub(crate) variables: Vec<HistoryVariable>,
    /// History variables of the law of each part.
    of_parts: Vec<Vec<HistoryVariable>>,
    /// Index of the part of each element; `None` for rims and elements without part.
    part_of: Vec<Option<usize>>,
}

impl StateVariables {
    /// History variables of the parts of a scene; rims are elastic and have none.
    pub(crate) fn of(scene: &Scene, rims: &[HashSet<u32>]) -> Result<Self, Error> {
        let mesh = &scene.mesh;
        let mut found = Self {
            variables: Vec::new(),
            of_parts: Vec::new(),
            part_of: vec![None; mesh.element_count()],
        };
        for (index, (part, rim)) in scene.parts.iter().zip(rims).enumerate() {
            let of_part = part.material.history();
            found.of_parts.push(of_part.to_vec());
            for &element in mesh.element_set(&part.set)? {
                if !rim.contains(&element) {
                    found.part_of[element as usize] = Some(index);
                }
            }
            for variable in of_part {
                if found.variables.iter().all(|v| v.name != variable.name) {
                    found.variables.push(*variable);
                }
            }
        }
        Ok(found)
    }
    /// History variables of the law of an element.
    pub(crate) fn of_element(&self, element: u32) -> &[HistoryVariable] {
        self.part_of[element as usize].map_or(&[], |part| &self.of_parts[part])
    }
    /// Observer of the envelopes of history variables; `None` if no law has any.
    pub(crate) fn peaks(
        &self,
        plan: &OutputPlan,
        mesh: &Mesh,
    ) -> Result<Option<StatePeaks>, Error> {
        if self.variables.is_empty() {
            return Ok(None);
        }
        let has_variables = |&element: &u32| !self.of_element(element).is_empty();
        let elements = (0..mesh.element_count() as u32).filter(has_variables);
        let elements: Vec<u32> = elements.collect();
        let cadence = Cadence::Seconds(plan.state.every.unwrap_or(BEYOND_END));
        let peaks = StatePeaks::new(mesh, &elements, &self.variables, cadence);
        Ok(Some(peaks.map_err(ModelError::from)?))
    }
}
