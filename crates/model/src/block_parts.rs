//! What blocks of elements may have in addition to their forces.

use crate::{
    BlockContext, BlockEnergy, ElementBlock, HistoryField, Mat3, NodalView, NodalViewMut, Operator,
    Program, ProgramError, Quad, Rayleigh, SavedState, Stress, Vec3,
};

/// Damping of a block of elements: forces that depend on velocities.
pub trait DampedBlock {
    /// Coefficients of Rayleigh damping of its elements.
    fn damping(&self) -> Rayleigh;
    /// Whether [`forces`](ElementBlock::forces) reads velocities, with an addition to the stiffness damping coefficient (s)
    /// and with or without energy bookkeeping. If not, the velocity of the context may be empty. True by default.
    fn reads_velocity(&self, _damping_shift: f64, _ledger: bool) -> bool {
        true
    }
}

/// Stiffness of a block of elements: linear operators of nodal vectors.
pub trait BlockStiffness: ElementBlock {
    /// Writes the product of a stiffness operator and a nodal vector, both in the order of
    /// [`nodes`](ElementBlock::nodes).
    fn apply(&self, operator: Operator, x: NodalView, out: NodalViewMut);
    /// Adds the nodal 3 x 3 diagonal blocks of a stiffness operator (N/m), in the order of
    /// [`nodes`](ElementBlock::nodes).
    ///
    /// By default they are those of [every matrix](Self::each_matrix).
    fn diagonal(&self, operator: Operator, out: &mut [Mat3]) {
        self.each_matrix(operator, &mut |nodes, matrix| {
            let size = 3 * nodes.len();
            for (place, &node) in nodes.iter().enumerate() {
                let entry = |i, j| matrix[(3 * place + i) * size + 3 * place + j];
                out[node as usize] += Mat3::from_fn(entry);
            }
        });
    }
    /// Calls a function with every element stiffness matrix of an operator: indices in [`nodes`](ElementBlock::nodes) of
    /// the nodes that the matrix couples, and its entries (N/m), row by row, three rows and three columns per node.
    ///
    /// By default there is one matrix for all nodes of the block, each column from
    /// [`apply`](Self::apply): right for a few nodes, expensive for many.
    fn each_matrix(&self, operator: Operator, visit: &mut dyn FnMut(&[u32], &[f64])) {
        let count = self.nodes().len();
        let mut unit = vec![Quad::<f64>::default(); count];
        let mut forces = unit.clone();
        let size = 3 * count;
        let mut matrix = vec![0.0; size * size];
        for column in 0..size {
            unit[column / 3].values[column % 3] = 1.0;
            self.apply(
                operator,
                NodalView::F64(&unit),
                NodalViewMut::F64(&mut forces),
            );
            unit[column / 3].values[column % 3] = 0.0;
            for row in 0..size {
                matrix[row * size + column] = forces[row / 3].values[row % 3];
            }
        }
        let every: Vec<u32> = (0..count as u32).collect();
        visit(&every, &matrix);
    }
    /// Whether [`forces`](ElementBlock::forces) are the product of the elastic stiffness, [`Operator::Elastic`], with the displacement since
    /// the reference displacement, and nothing else. False by default, which is right for every block.
    fn is_linear_elastic(&self) -> bool {
        false
    }
}

/// Results of a block of elements: energies, stresses, forces of elements and shown history variables.
pub trait BlockOutput: ElementBlock {
    /// Energies (J): elastic and hourglass energy at the context's displacement, and accumulated dissipation.
    fn energy(&self, context: &BlockContext) -> BlockEnergy;
    /// Adds the mean change of stress (Pa) over the volume of each element at a displacement (m) of the block's nodes,
    /// from the committed history variables, in the order of [`elements`](ElementBlock::elements). By
    /// default nothing is added, which is right for blocks without elements of the mesh.
    fn add_stress(&self, _displacement: NodalView, _out: &mut [Stress]) {}
    /// Stress (Pa) on the faces of an element at the natural coordinates r = 1, s = 1 and t = 1 less its mean stress, at a
    /// displacement (m) of the block's nodes from the committed history variables; on the opposite faces it has the other
    /// sign. None, the default, where the stress of elements does not vary within them, or is that of several points.
    fn surface_stresses(&self, _index: usize, _displacement: NodalView) -> Option<[Stress; 3]> {
        None
    }
    /// Element value of a history variable after the last [`forces`](ElementBlock::forces), committed or not, of the
    /// element with an index in [`elements`](ElementBlock::elements); none if its law has no such variable.
    ///
    /// By default it is the mean over the integration points of the committed [`history`](StatefulBlock::history),
    /// which is right for blocks whose history variables change only at a commit. Blocks with water in their pores also answer
    /// [`PORE_PRESSURE`](crate::PORE_PRESSURE) and [`PORE_PRESSURE_RATIO`](crate::PORE_PRESSURE_RATIO).
    fn shown_history(&self, index: usize, variable: &str) -> Option<f64> {
        let fields = self.stateful()?.history();
        let field = fields.iter().find(|field| field.name == variable)?;
        let values = field
            .values
            .get(index * field.points..(index + 1) * field.points)?;
        Some(values.iter().sum::<f64>() / field.points as f64)
    }
    /// The internal forces of single elements; none by default: section forces leave the elements of the block out.
    fn element_forces(&self) -> Option<&dyn ElementForces> {
        None
    }
}

/// Internal forces of single elements of a block.
pub trait ElementForces {
    /// Writes the internal forces (N) of one element, given by its index in [`elements`](ElementBlock::elements), at
    /// its nodes in the mesh's order.
    ///
    /// They are the forces of an initial stress (Pa) and of the change of stress at a displacement (m) of the block's
    /// nodes from the committed history variables, and hourglass forces, without stiffness damping.
    fn write_forces(
        &self,
        index: usize,
        displacement: NodalView,
        initial: &Stress,
        out: &mut [Vec3],
    );
}

/// State of a block of elements between two steps: active elements, reference displacement, initial stress and history
/// variables.
pub trait StatefulBlock {
    /// Commits the history variables of the last [`forces`](ElementBlock::forces).
    fn commit(&mut self);
    /// Committed history variables of all elements, one field per variable.
    fn history(&self) -> Vec<HistoryField>;
    /// Sets committed history variables from fields, those of the block's own elements and variables.
    fn set_history(&mut self, fields: &[HistoryField]);
    /// Activates and deactivates elements, in the order of [`elements`](ElementBlock::elements).
    fn set_active(&mut self, active: &[bool]);
    /// Sets the reference displacement (m) of the block's nodes, from which strain and hourglass deformation
    /// are measured: elements that are cast later are free of stress in the deformed body.
    fn set_reference_displacement(&mut self, displacement: NodalView);
    /// Sets the initial stress (Pa) of each element, in the order of [`elements`](ElementBlock::elements).
    fn set_initial_stress(&mut self, stress: &[Stress]);
    /// Adds the nodal forces (N) of uniform element stresses (Pa), such as initial stresses: stresses in the
    /// order of [`elements`](ElementBlock::elements), forces in that of [`nodes`](ElementBlock::nodes).
    ///
    /// By default nothing is added, which is right for blocks that bear no initial stress, such as bolts
    /// and boundary elements; a block with initial stress must override it, or the initial stress is not
    /// in equilibrium.
    fn add_forces_of(&self, _stress: &[Stress], _out: &mut [Vec3]) {}
    /// Its state as bytes, with the committed history variables, from which a block of the same elements goes on in a resumed
    /// run. None by default: the engine then keeps the [`history`](Self::history), which suffices for blocks whose energies
    /// follow from it.
    ///
    /// The bytes are in the order of [`elements`](ElementBlock::elements), so that blocks of other lane widths can restore
    /// them.
    fn saved(&self) -> Option<&dyn SavedState> {
        None
    }
    /// The same state, to be restored; none by default.
    fn saved_mut(&mut self) -> Option<&mut dyn SavedState> {
        None
    }
}

/// Program of the elements of a block: the arithmetic of one element for other processors.
pub trait ProgrammedBlock {
    /// Program of one element of the block in a dynamic step of a length (s): the arithmetic of [`forces`](ElementBlock::forces)
    /// from the displacement of its nodes to their forces, without ledger, for other processors.
    ///
    /// Its inputs and outputs have names, with nodes, components, integration points and history variables. Inputs are
    /// `displacement` of the nodes (m), that of the elements' first node subtracted where elements are computed in single
    /// precision; `velocity` likewise (m/s), if damping or flow needs it; the numbers of `geometry`; with a law that is not linear
    /// also `initial` stress (Pa), `extents` (m2), `history` of every point and `element_history`. Outputs are `force` (N)
    /// and the new histories. With a linear law the `displacement` is that with the velocity, times the coefficient of stiffness damping,
    /// added. The displacement is that since the reference displacement. `forks` is the number of forks at most.
    ///
    /// # Errors
    /// What has no program, with the reason.
    fn program(&self, step: f64, forks: usize) -> Result<Program, ProgramError>;
    /// Inputs of the [program](Self::program) for an element, given by its index in [`elements`](ElementBlock::elements), in the order
    /// of their names: at a displacement (m) and a velocity (m/s) of the block's nodes, from the committed history variables.
    fn program_inputs(
        &self,
        index: usize,
        displacement: NodalView,
        velocity: NodalView,
    ) -> Vec<f64>;
}

/// What engines ask of any block, also of one that does not have it.
impl dyn ElementBlock + '_ {
    /// Coefficients of Rayleigh damping; zero of a block that is not [damped](ElementBlock::damped).
    pub fn damping(&self) -> Rayleigh {
        self.damped()
            .map_or_else(Rayleigh::default, |damped| damped.damping())
    }
    /// Whether the forces read velocities, with an addition to the stiffness damping coefficient (s) and with or without energy
    /// bookkeeping; a block that is not [damped](ElementBlock::damped) reads none.
    pub fn reads_velocity(&self, damping_shift: f64, ledger: bool) -> bool {
        let damped = self.damped();
        damped.is_some_and(|damped| damped.reads_velocity(damping_shift, ledger))
    }
    /// Writes the product of a stiffness operator and a nodal vector; zero of a block without
    /// [stiffness](ElementBlock::stiffness).
    pub fn apply(&self, operator: Operator, x: NodalView, out: NodalViewMut) {
        match (self.stiffness(), out) {
            (Some(stiffness), out) => stiffness.apply(operator, x, out),
            (None, NodalViewMut::F64(out)) => out.fill(Quad::default()),
            (None, NodalViewMut::F32(out)) => out.fill(Quad::default()),
        }
    }
    /// Adds the nodal diagonal blocks of a stiffness operator (N/m).
    pub fn diagonal(&self, operator: Operator, out: &mut [Mat3]) {
        if let Some(stiffness) = self.stiffness() {
            stiffness.diagonal(operator, out);
        }
    }
    /// Calls a function with every element stiffness matrix of an operator (N/m).
    pub fn each_matrix(&self, operator: Operator, visit: &mut dyn FnMut(&[u32], &[f64])) {
        if let Some(stiffness) = self.stiffness() {
            stiffness.each_matrix(operator, visit);
        }
    }
    /// Energies (J); zero of a block without [output](ElementBlock::output).
    pub fn energy(&self, context: &BlockContext) -> BlockEnergy {
        self.output()
            .map_or_else(BlockEnergy::default, |output| output.energy(context))
    }
    /// Adds the mean change of stress (Pa) of each element.
    pub fn add_stress(&self, displacement: NodalView, out: &mut [Stress]) {
        if let Some(output) = self.output() {
            output.add_stress(displacement, out);
        }
    }
    /// Element value of a history variable, see [`BlockOutput::shown_history`].
    pub fn shown_history(&self, index: usize, variable: &str) -> Option<f64> {
        self.output()?.shown_history(index, variable)
    }
    /// Commits the history variables of the last forces.
    pub fn commit(&mut self) {
        if let Some(stateful) = self.stateful_mut() {
            stateful.commit();
        }
    }
    /// Committed history variables of all elements; a block without a [state](ElementBlock::stateful) has none.
    pub fn history(&self) -> Vec<HistoryField> {
        self.stateful()
            .map_or_else(Vec::new, |stateful| stateful.history())
    }
    /// Sets committed history variables.
    pub fn set_history(&mut self, fields: &[HistoryField]) {
        if let Some(stateful) = self.stateful_mut() {
            stateful.set_history(fields);
        }
    }
    /// Sets the reference displacement (m) of the block's nodes.
    pub fn set_reference_displacement(&mut self, displacement: NodalView) {
        if let Some(stateful) = self.stateful_mut() {
            stateful.set_reference_displacement(displacement);
        }
    }
    /// Sets the initial stress (Pa) of each element.
    pub fn set_initial_stress(&mut self, stress: &[Stress]) {
        if let Some(stateful) = self.stateful_mut() {
            stateful.set_initial_stress(stress);
        }
    }
    /// State as bytes, see [`StatefulBlock::saved`].
    pub fn saved(&self) -> Option<&dyn SavedState> {
        self.stateful()?.saved()
    }
    /// The same state, to be restored.
    pub fn saved_mut(&mut self) -> Option<&mut dyn SavedState> {
        self.stateful_mut()?.saved_mut()
    }
    /// Program of one element, see [`ProgrammedBlock::program`].
    ///
    /// # Errors
    /// What has no program, with the reason.
    pub fn program(&self, step: f64, forks: usize) -> Result<Program, ProgramError> {
        match self.programmed() {
            Some(programmed) => programmed.program(step, forks),
            None => Err(ProgramError::None {
                name: self.label().to_owned(),
            }),
        }
    }
}
