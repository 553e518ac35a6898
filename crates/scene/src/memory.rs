//! Number of history variables of a scene, for estimates of memory.

use powerhouse_model::HistoryVariable;

use crate::output::{add_variables, shown_variables};
use crate::{Error, Scene};

/// Number of stored history variables (internal state variables) of the laws of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LawMemory {
    /// Stored numbers at all integration points together, those of the committed state alone.
    pub numbers: usize,
    /// Number of elements whose law has history variables.
    pub with_history: usize,
    /// Number of elements whose law has history variables in the output.
    pub elements: usize,
    /// History variables in the output, each name once; those of relaxation mechanisms are left out.
    pub variables: Vec<HistoryVariable>,
}

impl Scene {
    /// Number of stored history variables of the laws in the dynamic run: those of relaxation mechanisms included, none in
    /// rims, which are elastic.
    ///
    /// # Errors
    /// Set that does not exist, rim without elements, or flat damping that the law does not permit.
    pub fn law_memory(&self) -> Result<LawMemory, Error> {
        let mut memory = LawMemory::default();
        for (part, rim) in self.parts.iter().zip(self.rims()?) {
            let shown = shown_variables(&part.material);
            let of_point = part.moving_material()?.history().len();
            for element in self.mesh.element_set(&part.set)? {
                if rim.contains(element) {
                    continue;
                }
                let kernel = part.kernel_for(self.mesh.kind(*element));
                if let (Some(kernel), true) = (kernel, of_point > 0) {
                    memory.numbers += of_point * kernel.points() + kernel.own_history();
                    memory.with_history += 1;
                }
                memory.elements += usize::from(!shown.is_empty());
            }
            add_variables(&mut memory.variables, &shown);
        }
        Ok(memory)
    }
}
