//! Blocks: many elements of one kernel and one law, computed in lanes.

mod accounts;
mod error;
mod factory;
mod frequency;
mod linearised;
mod numbers;
mod operations;
#[cfg(test)]
mod tests;
mod transfer;

use std::sync::Arc;

use powerhouse_model::{
    BlockContext, BlockEnergy, ConstitutiveLaw, ElementBlock, ElementFault, ElementKernel,
    FrequencyBound, HistoryField, Mat3, NodalView, NodalViewMut, Operator, Quad, Stress, Vec3,
};

use crate::Rayleigh;
use crate::lanes::{Arrangement, BatchScalar, Lanes, dispatch};
use accounts::{Account, HeldEnergy, MeanStress, StepWork};
use numbers::AlignedNumbers;
use operations::{Displacement, Elastic, LawState, Material, Moduli, Visit, Visitor};
use transfer::Batches;

pub use error::BlockError;
pub use factory::solid;

/// The history variables of all points, before and after the step.
struct History<S> {
    variables: usize,
    old: AlignedNumbers<S>,
    new: AlignedNumbers<S>,
}

impl<S: BatchScalar> History<S> {
    fn new(variables: usize, numbers: usize) -> Self {
        Self {
            variables,
            old: AlignedNumbers::zeros(numbers),
            new: AlignedNumbers::zeros(numbers),
        }
    }
}

/// Elements with a kernel of `N` nodes and `P` points and a law, in the scalar `S`.
struct Block<K, M, S, const N: usize, const P: usize> {
    label: Arc<str>,
    kernel: K,
    law: M,
    moduli: Moduli,
    damping: Rayleigh,
    lanes: Lanes,
    arrangement: Arrangement,
    /// Mesh indices of the elements.
    elements: Vec<u32>,
    /// Engine numbers of the nodes, by place.
    nodes: Vec<u32>,
    /// Engine numbers of the nodes of each element, whole batches.
    engine: Vec<[u32; N]>,
    /// Places of the nodes of each element, whole batches.
    places: Vec<[u32; N]>,
    geometry: AlignedNumbers<S>,
    /// Cube roots of the volumes (m).
    sizes: AlignedNumbers<S>,
    /// Lumped masses of each element (kg).
    masses: Vec<[f64; N]>,
    /// Bounds of each element (rad/s).
    frequencies: Vec<f64>,
    active: Option<Vec<bool>>,
    /// Where strain is measured from (m), by place.
    reference: Option<Vec<Quad<f64>>>,
    /// Initial stresses (Pa), empty if there are none.
    initial: AlignedNumbers<S>,
    history: History<S>,
    /// Displacement at the last forces (m), by place, for laws that are not linear.
    present: Vec<Quad<f64>>,
    account: Account<S>,
}

impl<K, M, S, const N: usize, const P: usize> Block<K, M, S, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
    S: BatchScalar,
{
    fn batches(&self) -> Batches<'_, S, N> {
        Batches {
            elements: self.elements.len(),
            engine: &self.engine,
            places: &self.places,
            active: self.active.as_deref(),
            geometry: self.geometry.as_slice(),
            geometry_len: self.kernel.geometry_len(),
        }
    }

    fn law_state(&self) -> LawState<'_, S> {
        LawState {
            initial: self.initial.as_slice(),
            size: self.sizes.as_slice(),
            variables: self.history.variables,
            history: self.history.old.as_slice(),
            arrangement: self.arrangement,
        }
    }

    fn from_reference<'a, A: BatchScalar>(&'a self, nodes: &'a [Quad<A>]) -> Displacement<'a, A> {
        Displacement {
            nodes,
            reference: self.reference.as_deref(),
        }
    }

    fn coefficient(&self, context: &BlockContext) -> f64 {
        self.damping.stiffness + context.damping_shift
    }

    /// Forces of one storage; yields whether all is finite.
    fn write_forces<A: BatchScalar>(
        &mut self,
        displacement: &[Quad<A>],
        velocity: &[Quad<A>],
        coefficient: f64,
        out: &mut [Quad<A>],
    ) -> bool {
        out.fill(Quad::default());
        let damping = (coefficient != 0.0).then_some((velocity, coefficient));
        if self.law.is_linear() {
            let operation = Elastic::<K, A, S, N, P> {
                kernel: &self.kernel,
                batches: self.batches(),
                moduli: self.moduli,
                displacement: self.from_reference(displacement),
                damping,
                out,
            };
            return dispatch(self.lanes, operation);
        }
        self.present.clear();
        let present = self.nodes.iter().map(|&n| displacement[n as usize]);
        self.present
            .extend(present.map(|value| Quad::from_vector(&value.to_vector())));
        let mut new_history = core::mem::replace(&mut self.history.new, AlignedNumbers::zeros(0));
        let operation = Material::<K, M, A, S, N, P> {
            kernel: &self.kernel,
            law: &self.law,
            batches: self.batches(),
            moduli: self.moduli,
            state: self.law_state(),
            displacement: self.from_reference(displacement),
            damping,
            new_history: new_history.as_mut_slice(),
            out,
        };
        let finite = dispatch(self.lanes, operation);
        self.history.new = new_history;
        finite
    }

    /// Shows the fields at a displacement to a visitor.
    fn visit<A: BatchScalar, V: Visitor<S, N, P>>(
        &self,
        displacement: &[Quad<A>],
        visitor: &mut V,
    ) {
        let operation = Visit::<K, M, A, S, V, N, P> {
            kernel: &self.kernel,
            law: &self.law,
            batches: self.batches(),
            moduli: self.moduli,
            state: self.law_state(),
            displacement: self.from_reference(displacement),
            visitor,
        };
        dispatch(self.lanes, operation);
    }

    /// Books the work of the step that ends at the context.
    fn account_for<A: BatchScalar>(
        &mut self,
        context: &BlockContext,
        displacement: &[Quad<A>],
        velocity: &[Quad<A>],
    ) {
        let linear = self.law.is_linear();
        let damping = self.coefficient(context);
        if linear && damping == 0.0 {
            return;
        }
        let mut account = core::mem::take(&mut self.account);
        let follows = context.number > 0 && account.number == Some(context.number - 1);
        if account.velocity.is_empty() {
            account.velocity = vec![Quad::default(); self.nodes.len()];
            let numbers = if linear { 0 } else { self.engine.len() * P * 6 };
            account.stress = AlignedNumbers::zeros(numbers);
        }
        let mut step_work = StepWork {
            kernel: &self.kernel,
            moduli: self.moduli,
            linear,
            arrangement: self.arrangement,
            step: context.step,
            damping,
            velocity,
            velocity_before: &account.velocity,
            stress: account.stress.as_mut_slice(),
            work: 0.0,
            dissipated: 0.0,
            elastic: 0.0,
        };
        self.visit(displacement, &mut step_work);
        let (work, dissipated, elastic) = (step_work.work, step_work.dissipated, step_work.elastic);
        if follows {
            account.work += work;
            account.damping += dissipated;
        } else {
            // The account rests between here and where it was: what is held now is its new start.
            account.elastic_at_start = elastic - account.work + account.plastic;
        }
        account.plastic = account.work - (elastic - account.elastic_at_start);
        account.number = Some(context.number);
        for (value, &node) in account.velocity.iter_mut().zip(&self.nodes) {
            *value = Quad::from_vector(&velocity[node as usize].to_vector());
        }
        self.account = account;
    }

    /// The first element whose nodes or stresses are not numbers.
    fn fault<A: BatchScalar>(
        &self,
        displacement: &[Quad<A>],
        velocity: &[Quad<A>],
    ) -> Option<ElementFault> {
        let mut stresses = vec![Stress::default(); self.elements.len()];
        self.mean_stresses(displacement, &mut stresses);
        let finite = |values: &[Quad<A>], node: u32| {
            let vector = values[node as usize].to_vector();
            vector.iter().all(|component| component.is_finite())
        };
        let reason = |element: usize| {
            let nodes = &self.engine[element];
            if !nodes.iter().all(|&node| finite(displacement, node)) {
                Some("a node's displacement is not finite")
            } else if !nodes.iter().all(|&node| finite(velocity, node)) {
                Some("a node's velocity is not finite")
            } else if !stresses[element].0.iter().all(|s| s.is_finite()) {
                Some("its stress is not finite")
            } else {
                None
            }
        };
        (0..self.elements.len())
            .filter(|&element| self.is_active(element))
            .find_map(|element| {
                reason(element).map(|reason| ElementFault {
                    element: self.elements[element],
                    reason: reason.into(),
                })
            })
    }

    fn is_active(&self, element: usize) -> bool {
        self.active.as_ref().is_none_or(|active| active[element])
    }

    fn mean_stresses<A: BatchScalar>(&self, displacement: &[Quad<A>], out: &mut [Stress]) {
        let mut visitor = MeanStress {
            kernel: &self.kernel,
            arrangement: self.arrangement,
            out,
        };
        self.visit(displacement, &mut visitor);
    }

    fn held_energy<A: BatchScalar>(&self, displacement: &[Quad<A>]) -> (f64, f64) {
        let mut visitor = HeldEnergy {
            kernel: &self.kernel,
            moduli: self.moduli,
            linear: self.law.is_linear(),
            arrangement: self.arrangement,
            elastic: 0.0,
            hourglass: 0.0,
        };
        self.visit(displacement, &mut visitor);
        (visitor.elastic, visitor.hourglass)
    }

    fn forces_of<A: BatchScalar>(
        &mut self,
        context: &BlockContext,
        displacement: &[Quad<A>],
        velocity: &[Quad<A>],
        out: &mut [Quad<A>],
    ) -> Result<(), ElementFault> {
        let coefficient = self.coefficient(context);
        if !self.write_forces(displacement, velocity, coefficient, out)
            && let Some(fault) = self.fault(displacement, velocity)
        {
            return Err(fault);
        }
        if context.ledger {
            self.account_for(context, displacement, velocity);
        }
        Ok(())
    }

    fn apply_to<A: BatchScalar>(&self, operator: Operator, x: &[Quad<A>], out: &mut [Quad<A>]) {
        out.fill(Quad::default());
        if operator == Operator::Elastic || self.law.is_linear() {
            let operation = Elastic::<K, A, S, N, P> {
                kernel: &self.kernel,
                batches: self.batches(),
                moduli: self.moduli,
                displacement: Displacement {
                    nodes: x,
                    reference: None,
                },
                damping: None,
                out,
            };
            dispatch(self.lanes, operation);
            return;
        }
        self.each_element(operator, |element, forces| {
            let nodal = self.engine[element].map(|n| x[n as usize].to_vector().into());
            for (&place, force) in self.places[element].iter().zip(forces(&nodal)) {
                let sum = &mut out[place as usize];
                *sum = Quad::from_vector(&(sum.to_vector() + Vec3::from(force)));
            }
        });
    }
}

/// Views of one call that differ in storage are a fault of the engine's author.
const ONE_STORAGE: &str = "all nodal views of one call have the same storage";

impl<K, M, S, const N: usize, const P: usize> ElementBlock for Block<K, M, S, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
    S: BatchScalar,
{
    fn label(&self) -> &str {
        &self.label
    }
    fn elements(&self) -> &[u32] {
        &self.elements
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        match (context.displacement, context.velocity, out) {
            (NodalView::F64(u), NodalView::F64(v), NodalViewMut::F64(out)) => {
                self.forces_of(context, u, v, out)
            }
            (NodalView::F32(u), NodalView::F32(v), NodalViewMut::F32(out)) => {
                self.forces_of(context, u, v, out)
            }
            _ => panic!("{ONE_STORAGE}"),
        }
    }
    fn commit(&mut self) {
        core::mem::swap(&mut self.history.old, &mut self.history.new);
    }
    fn apply(&self, operator: Operator, x: NodalView, out: NodalViewMut) {
        match (x, out) {
            (NodalView::F64(x), NodalViewMut::F64(out)) => self.apply_to(operator, x, out),
            (NodalView::F32(x), NodalViewMut::F32(out)) => self.apply_to(operator, x, out),
            _ => panic!("{ONE_STORAGE}"),
        }
    }
    fn diagonal(&self, operator: Operator, out: &mut [Mat3]) {
        self.add_diagonal(operator, out);
    }
    fn add_mass(&self, out: &mut [f64]) {
        for (element, masses) in self.masses.iter().enumerate() {
            if self.is_active(element) {
                for (&place, mass) in self.places[element].iter().zip(masses) {
                    out[place as usize] += mass;
                }
            }
        }
    }
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        (0..self.elements.len())
            .filter(|&element| self.is_active(element))
            .map(|element| FrequencyBound {
                element: self.elements[element],
                frequency: self.frequencies[element],
                stiffness_damping: self.damping.stiffness,
            })
            .collect()
    }
    fn stiffness_damping(&self) -> f64 {
        self.damping.stiffness
    }
    fn mass_damping(&self) -> f64 {
        self.damping.mass
    }
    fn set_active(&mut self, active: &[bool]) {
        let some_are_off = active.iter().any(|active| !active);
        self.active = some_are_off.then(|| active.to_vec());
        self.account.number = None;
    }
    fn set_reference_displacement(&mut self, displacement: NodalView) {
        let values = self.nodes.iter().map(|&n| displacement.vector(n as usize));
        self.reference = Some(values.map(|value| Quad::from_vector(&value)).collect());
        self.account.number = None;
    }
    fn set_initial_stress(&mut self, stress: &[Stress]) {
        if self.law.is_linear() {
            // The change of stress of a linear law does not depend on where it starts.
            return;
        }
        self.initial = AlignedNumbers::zeros(6 * self.engine.len());
        for element in 0..self.engine.len() {
            let stress = &stress[element.min(stress.len() - 1)];
            for i in 0..6 {
                let place = self.arrangement.place(element, i, 6);
                self.initial.as_mut_slice()[place] = S::from_f64(stress.0[i]);
            }
        }
        self.account.number = None;
    }
    fn add_stress(&self, displacement: NodalView, out: &mut [Stress]) {
        match displacement {
            NodalView::F64(u) => self.mean_stresses(u, out),
            NodalView::F32(u) => self.mean_stresses(u, out),
        }
    }
    fn energy(&self, context: &BlockContext) -> BlockEnergy {
        let (elastic, hourglass) = match context.displacement {
            NodalView::F64(u) => self.held_energy(u),
            NodalView::F32(u) => self.held_energy(u),
        };
        BlockEnergy {
            elastic,
            hourglass,
            plastic: self.account.plastic,
            damping: self.account.damping,
            ..BlockEnergy::default()
        }
    }
    fn history(&self) -> Vec<HistoryField> {
        let variables = self.history.variables;
        let old = self.history.old.as_slice();
        let field = |(h, variable): (usize, &powerhouse_model::HistoryVariable)| HistoryField {
            name: variable.name.into(),
            elements: self.elements.clone(),
            points: P,
            values: (0..self.elements.len() * P)
                .map(|i| {
                    let index = (i % P) * variables + h;
                    old[self.arrangement.place(i / P, index, P * variables)].to_f64()
                })
                .collect(),
        };
        self.law.history().iter().enumerate().map(field).collect()
    }
    fn set_history(&mut self, fields: &[HistoryField]) {
        let variables = self.history.variables;
        for (h, variable) in self.law.history().iter().enumerate() {
            for field in fields {
                if field.name != variable.name || field.points != P {
                    continue;
                }
                let row_of: std::collections::HashMap<u32, usize> =
                    field.elements.iter().copied().zip(0..).collect();
                for (element, mesh_element) in self.elements.iter().enumerate() {
                    let Some(&row) = row_of.get(mesh_element) else {
                        continue;
                    };
                    for p in 0..P {
                        let place =
                            self.arrangement
                                .place(element, p * variables + h, P * variables);
                        let value = S::from_f64(field.values[row * P + p]);
                        self.history.old.as_mut_slice()[place] = value;
                        self.history.new.as_mut_slice()[place] = value;
                    }
                }
            }
        }
        self.account.number = None;
    }
}
