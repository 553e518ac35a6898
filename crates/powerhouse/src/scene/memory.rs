//! Number of history variables of a scene, for estimates of memory.

use powerhouse_model::HistoryVariable;

use super::Scene;
use crate::Error;

/// Numbers of history variables of the laws of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LawMemory {
    /// Total number of history variables at all integration points (one copy).
    pub numbers: usize,
    /// Number of elements whose law has history variables for output.
    pub elements: usize,
    /// Number of different history variables for output: all except those of relaxation mechanisms.
    pub variables: Vec<HistoryVariable>,
}

impl Scene {
    /// Numbers of history variables of the laws, taking rims and relaxation mechanisms into account.
    ///
    /// # Errors
    /// Set that does not exist, rim without elements, or flat damping that the law does not permit.
    pub fn law_memory(&self) -> Result<LawMemory, Error> {
        let mut memory = LawMemory::default();
        for (part, rim) in self.parts.iter().zip(self.rims()?) {
            let shown = part.material.history();
            let of_point = part.moving_material()?.history().len();
            for element in self.mesh.element_set(&part.set)? {
                if rim.contains(element) {
                    continue;
                }
                let kernel = part.kernel_for(self.mesh.kind(*element));
                memory.numbers += of_point * kernel.map_or(0, |kernel| kernel.points());
                memory.elements += usize::from(!shown.is_empty());
            }
            for variable in shown {
                if memory.variables.iter().all(|v| v.name != variable.name) {
                    memory.variables.push(*variable);
                }
            }
        }
        Ok(memory)
    }
}
