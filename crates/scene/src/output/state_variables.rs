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
    /// Index of the part of each element, plus one; zero for elements without history variables.
    part_of: Vec<u32>,
}

impl StateVariables {
    /// History variables of the parts of a scene; rims are elastic and have none.
    pub(crate) fn of(scene: &Scene, rims: &[HashSet<u32>]) -> Result<Self, Error> {
        let mesh = &scene.mesh;
        let mut found = Self {
            variables: Vec::new(),
            of_parts: Vec::new(),
            part_of: vec![0; mesh.element_count()],
        };
        for (number, (part, rim)) in (1..).zip(scene.parts.iter().zip(rims)) {
            let of_part = part.material.history();
            found.of_parts.push(of_part.to_vec());
            let with_history = match of_part {
                [] => &[],
                _ => mesh.element_set(&part.set)?,
            };
            for element in with_history.iter().filter(|element| !rim.contains(element)) {
                found.part_of[*element as usize] = number;
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
        let part = self.part_of[element as usize].checked_sub(1);
        part.map_or(&[], |part| &self.of_parts[part as usize])
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
