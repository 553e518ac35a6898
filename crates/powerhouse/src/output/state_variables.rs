//! History variables of the laws of a scene, and where.

use std::collections::HashSet;

use powerhouse_explicit_core::observe::StatePeaks;
use powerhouse_model::{Cadence, HistoryVariable, Mesh, ModelError};

use super::OutputPlan;
use crate::{Error, Scene};

/// No run lasts so long (s): what is looked at in this interval is seen at its start and end.
const EVER: f64 = f64::MAX;

/// History variables of the laws of a scene, and where.
#[derive(Clone, Debug, Default)]
pub(crate) struct StateVariables {
    /// All variables, each name once.
    pub(crate) variables: Vec<HistoryVariable>,
    /// Those of the law of each element.
    of_parts: Vec<Vec<HistoryVariable>>,
    part_of: Vec<Option<usize>>,
}

impl StateVariables {
    /// The variables of the parts of a scene; rims have no history variables.
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
    /// The variables of the law of an element.
    pub(crate) fn of_element(&self, element: u32) -> &[HistoryVariable] {
        self.part_of[element as usize].map_or(&[], |part| &self.of_parts[part])
    }
    /// The observer of the greatest values; none without history variables.
    pub(crate) fn peaks(
        &self,
        plan: &OutputPlan,
        mesh: &Mesh,
    ) -> Result<Option<StatePeaks>, Error> {
        if self.variables.is_empty() {
            return Ok(None);
        }
        let has_some = |&element: &u32| !self.of_element(element).is_empty();
        let elements = (0..mesh.element_count() as u32).filter(has_some);
        let elements: Vec<u32> = elements.collect();
        let cadence = Cadence::Seconds(plan.state.every.unwrap_or(EVER));
        let peaks = StatePeaks::new(mesh, &elements, &self.variables, cadence);
        Ok(Some(peaks.map_err(ModelError::from)?))
    }
}
