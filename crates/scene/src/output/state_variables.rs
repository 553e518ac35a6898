//! History variables of the laws of a scene, by element.

use std::collections::HashSet;

use powerhouse_laws::Material;
use powerhouse_model::{
    Cadence, EFFECTIVE_STRESS, HistoryVariable, Mesh, ModelError, PORE_PRESSURE,
    PORE_PRESSURE_RATIO,
};
use powerhouse_observe::StatePeaks;

use super::OutputPlan;
use crate::{Error, Scene};

/// Interval longer than any run (s), by which values are sampled at the start and end only.
const BEYOND_END: f64 = f64::MAX;

/// History variables of the laws of a scene, by element.
#[derive(Clone, Debug, Default)]
pub(crate) struct StateVariables {
    /// All variables that results show, without repetitions of names.
    pub(crate) variables: Vec<HistoryVariable>,
    /// The history variables of laws among them.
    pub(crate) of_laws: Vec<HistoryVariable>,
    /// Variables of the law of each part that results show.
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
            of_laws: Vec::new(),
            of_parts: Vec::new(),
            part_of: vec![0; mesh.element_count()],
        };
        for (number, (part, rim)) in (1..).zip(scene.parts.iter().zip(rims)) {
            let of_law = part.material.history();
            let with_history = match of_law {
                [] => &[],
                _ => mesh.element_set(&part.set)?,
            };
            for element in with_history.iter().filter(|element| !rim.contains(element)) {
                found.part_of[*element as usize] = number;
            }
            add_variables(&mut found.of_laws, of_law);
            let of_part = shown_variables(&part.material);
            add_variables(&mut found.variables, &of_part);
            found.of_parts.push(of_part);
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

/// Variables of a material that results show: the history variables of its law and, with water in its pores, what follows from
/// them.
pub(crate) fn shown_variables(material: &Material) -> Vec<HistoryVariable> {
    let mut variables = material.history().to_vec();
    if material.pore_water().is_some() {
        variables.extend([PORE_PRESSURE, PORE_PRESSURE_RATIO]);
        variables.extend(EFFECTIVE_STRESS);
    }
    variables
}

/// Adds variables with names that are not there yet.
pub(crate) fn add_variables(all: &mut Vec<HistoryVariable>, further: &[HistoryVariable]) {
    for variable in further {
        if all.iter().all(|known| known.name != variable.name) {
            all.push(*variable);
        }
    }
}
