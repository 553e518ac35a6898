//! What a block has in addition to its forces: damping, stiffness, results, state and program.

use powerhouse_model::{
    BlockContext, BlockEnergy, BlockOutput, BlockStiffness, DampedBlock, ElementForces,
    ElementKernel, HistoryField, KernelArithmetic, Mat3, NodalView, NodalViewMut, Operator,
    Program, ProgramError, ProgrammedBlock, Rayleigh, SavedState, StateError, StatefulBlock,
    Stress, Vec3,
};

use super::Block;
use super::nodal::{doubled, in_double};
use super::numbers::AlignedNumbers;
use super::transfer::NodeScalar;

impl<K, S, const N: usize, const P: usize> DampedBlock for Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    fn damping(&self) -> Rayleigh {
        self.damping
    }
    fn reads_velocity(&self, damping_shift: f64, ledger: bool) -> bool {
        let damping = self.damping.stiffness + damping_shift;
        let of_law = damping != 0.0 || self.follows_flow() || (ledger && !self.is_linear());
        of_law && !self.spares_law(damping)
    }
}

impl<K, S, const N: usize, const P: usize> BlockStiffness for Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    fn apply(&self, operator: Operator, x: NodalView, out: NodalViewMut) {
        match x {
            NodalView::F64(x) => self.apply_to(operator, x, out),
            NodalView::F32(x) => self.apply_to(operator, &doubled(x), out),
        }
    }
    fn diagonal(&self, operator: Operator, out: &mut [Mat3]) {
        self.add_diagonal(operator, out);
    }
    fn each_matrix(&self, operator: Operator, visit: &mut dyn FnMut(&[u32], &[f64])) {
        self.visit_matrices(operator, visit);
    }
    fn is_linear_elastic(&self) -> bool {
        self.is_linear() && self.damping.stiffness == 0.0
    }
}

impl<K, S, const N: usize, const P: usize> BlockOutput for Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    fn energy(&self, context: &BlockContext) -> BlockEnergy {
        let mut energy = self.account.spent();
        for summary in self.survey(&self.since_reference(context.displacement)) {
            energy.elastic += summary.elastic;
            if self.kernel.hourglass_is_bending() {
                energy.bending += summary.hourglass
            } else {
                energy.hourglass += summary.hourglass
            }
        }
        energy
    }
    fn add_stress(&self, displacement: NodalView, out: &mut [Stress]) {
        let survey = self.survey(&self.since_reference(displacement));
        for (out, summary) in out.iter_mut().zip(&survey) {
            *out = *out + summary.stress;
        }
    }
    fn surface_stresses(&self, index: usize, displacement: NodalView) -> Option<[Stress; 3]> {
        self.surface_stresses_of(index, displacement)
    }
    fn shown_history(&self, index: usize, variable: &str) -> Option<f64> {
        let of_law = || (self.history).element_value(&self.arrangement, index, variable);
        self.shown_of_water(index, variable).or_else(of_law)
    }
    fn element_forces(&self) -> Option<&dyn ElementForces> {
        Some(self)
    }
}

impl<K, S, const N: usize, const P: usize> ElementForces for Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    fn write_forces(
        &self,
        index: usize,
        displacement: NodalView,
        initial: &Stress,
        out: &mut [Vec3],
    ) {
        self.write_forces_of(index, displacement, initial, out);
    }
}

impl<K, S, const N: usize, const P: usize> StatefulBlock for Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    fn commit(&mut self) {
        self.history.commit();
        self.shown_mut().begin(&[]);
        if self.law.is_stepping() || !self.follows_flow() {
            self.committed_displacement = None;
        } else if let Some(committed) = &mut self.committed_displacement {
            committed.clone_from(&self.static_displacement);
        }
    }
    fn history(&self) -> Vec<HistoryField> {
        self.history.fields(&self.arrangement, &self.elements)
    }
    fn set_history(&mut self, fields: &[HistoryField]) {
        let (arrangement, elements) = (self.arrangement, &self.elements);
        self.history.set_fields(&arrangement, elements, fields);
        self.forces_at_rest = None;
        self.restart();
    }
    fn set_active(&mut self, active: &[bool]) {
        let some_are_off = active.iter().any(|active| !active);
        self.active = some_are_off.then(|| active.to_vec());
        self.forces_at_rest = None;
        self.restart();
    }
    fn set_reference_displacement(&mut self, displacement: NodalView) {
        self.reference = Some(in_double(displacement));
        self.committed_displacement = None;
        self.restart();
    }
    fn set_initial_stress(&mut self, stress: &[Stress]) {
        if self.is_linear() {
            // The change of stress of a linear law does not depend on the initial stress.
            return;
        }
        let padded = self.connectivity.as_slice().len();
        self.initial = AlignedNumbers::zeros(6 * padded);
        for element in 0..padded {
            let from = element.min(stress.len() - 1);
            let mut stress = stress[from];
            if let Some(pressure) = self.pore_pressures.get(from) {
                stress.0[..3]
                    .iter_mut()
                    .for_each(|normal| *normal += pressure);
            }
            for i in 0..6 {
                let index = self.arrangement.place(element, i, 6);
                self.initial.as_mut_slice()[index] = S::from_f64(stress.0[i]);
            }
        }
        self.restart();
    }
    fn add_forces_of(&self, stress: &[Stress], out: &mut [Vec3]) {
        self.add_forces_of_stress(stress, out);
    }
    fn saved(&self) -> Option<&dyn SavedState> {
        Some(self)
    }
    fn saved_mut(&mut self) -> Option<&mut dyn SavedState> {
        Some(self)
    }
}

impl<K, S, const N: usize, const P: usize> SavedState for Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        self.encoded()
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        self.restore(saved)
    }
}

impl<K, S, const N: usize, const P: usize> ProgrammedBlock for Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    #[cfg(feature = "programs")]
    fn program(&self, step: f64, forks: usize) -> Result<Program, ProgramError> {
        self.recorded(step, forks)
    }
    #[cfg(not(feature = "programs"))]
    fn program(&self, _step: f64, _forks: usize) -> Result<Program, ProgramError> {
        Err(ProgramError::LeftOut {
            name: self.label.to_string(),
        })
    }
    #[cfg(feature = "programs")]
    fn program_inputs(
        &self,
        index: usize,
        displacement: NodalView,
        velocity: NodalView,
    ) -> Vec<f64> {
        self.inputs_of(index, displacement, velocity)
    }
    #[cfg(not(feature = "programs"))]
    fn program_inputs(
        &self,
        _index: usize,
        _displacement: NodalView,
        _velocity: NodalView,
    ) -> Vec<f64> {
        Vec::new()
    }
}
