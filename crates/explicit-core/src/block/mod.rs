//! Blocks: many elements of one kernel and one law, computed in lanes.

mod account;
mod batches;
mod element_forces;
mod exchange;
mod factory;
mod frequency;
mod history;
mod law;
mod law_forms;
mod linearised;
mod memory;
mod numbers;
mod operations;
mod remaining;
mod survey;
#[cfg(test)]
mod tests;
mod transfer;

use std::cell::Cell;
use std::sync::Arc;

use powerhouse_model::{
    BlockContext, BlockEnergy, ElementBlock, ElementFault, ElementKernel, FrequencyBound,
    HistoryField, Mat3, NodalView, NodalViewMut, Operator, Quad, Stress, Vec3,
};

use crate::Rayleigh;
use crate::lanes::{Arrangement, BatchScalar, Lanes};
use account::{Account, StepSums};
use batches::Batches;
use exchange::Exchanges;
use history::History;
use law::Memory;
use law_forms::LawForms;
use memory::Places;
use numbers::AlignedNumbers;
use operations::{Elastic, EnergyBookkeeping, LawState, Material, Moduli, Rates};
use survey::Summary;
use transfer::{BlockNodes, Locals, NodeScalar, copy_nodes};

pub use factory::solid;
pub(crate) use factory::{Erased, coordinate_rounding, erased};

thread_local! {
    /// Where blocks keep their nodes' values while they compute a step: one piece of memory per
    /// thread, which stays in its cache from block to block.
    static SCRATCH: Cell<Locals> = const { Cell::new(Locals::NONE) };
    /// What passes between kernels and laws, likewise.
    static EXCHANGES: Cell<Exchanges> = Cell::default();
}

/// Elements with a kernel of `N` nodes and `P` points and a law, in the scalar `S`.
struct Block<K, S, const N: usize, const P: usize> {
    label: Arc<str>,
    kernel: K,
    law: LawForms<S>,
    moduli: Moduli,
    damping: Rayleigh,
    lanes: Lanes,
    arrangement: Arrangement,
    /// Mesh indices of the elements.
    elements: Vec<u32>,
    nodes: BlockNodes,
    /// Places of the nodes of each element, whole batches.
    places: Places<N>,
    geometry: AlignedNumbers<S>,
    /// Six numbers of [`Extents`](powerhouse_model::Extents) per element (m2), of one batch if all elements
    /// are alike; empty for linear laws.
    extents: AlignedNumbers<S>,
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
    /// What the last static forces were computed from, if the law's tangent depends on it.
    locals: Locals,
    account: Account<S>,
}

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    fn batches(&self) -> Batches<'_, S, N> {
        Batches {
            elements: self.elements.len(),
            places: &self.places,
            active: self.active.as_deref(),
            geometry: self.geometry.as_slice(),
            arrangement: self.arrangement,
        }
    }

    fn law_state(&self) -> LawState<'_, S> {
        LawState {
            initial: self.initial.as_slice(),
            extents: self.extents.as_slice(),
        }
    }

    fn is_linear(&self) -> bool {
        self.law.static_form().is_none()
    }

    fn coefficient(&self, context: &BlockContext) -> f64 {
        self.damping.stiffness + context.damping_shift
    }

    fn is_active(&self, element: usize) -> bool {
        self.active.as_ref().is_none_or(|active| active[element])
    }

    /// Writes forces in a step of a length (s) with a coefficient of stiffness damping (s), and what the
    /// law did in it if that is to be booked; yields whether all is finite.
    ///
    /// The damping of a linear law is the elastic force of the velocity, so that it is added to
    /// the displacement of the nodes.
    fn write_forces<A: NodeScalar>(
        &mut self,
        displacement: &[Quad<f64>],
        velocity: &[Quad<A>],
        (step, damping): (f64, f64),
        booked: Option<&mut StepSums>,
        out: &mut [Quad<A>],
    ) -> bool {
        let damped = damping != 0.0;
        let moves = damped || (booked.is_some() && !self.is_linear());
        if const { size_of::<A>() < size_of::<S>() } {
            // Nodes in fewer digits than elements: few blocks, whose forces are rounded once they are summed.
            let mut sums = vec![Quad::default(); out.len()];
            let velocity = if moves { doubled(velocity) } else { Vec::new() };
            let finite = self.write_forces::<f64>(
                displacement,
                &velocity,
                (step, damping),
                booked,
                &mut sums,
            );
            for (out, sum) in out.iter_mut().zip(sums) {
                *out = Quad::from_vector(&sum.to_vector());
            }
            return finite;
        }
        out.fill(Quad::default());
        // A step is not linearised: its nodes need not be kept.
        let keeps = !self.is_linear() && !self.law.is_stepping();
        let mut locals = if keeps {
            core::mem::take(&mut self.locals)
        } else {
            SCRATCH.take()
        };
        let (local, rates) = A::local(&mut locals);
        copy_nodes(displacement, &self.nodes, local);
        if moves {
            copy_nodes(velocity, &self.nodes, rates);
        }
        if self.is_linear() && damped {
            for (value, &rate) in local.iter_mut().zip(&*rates) {
                *value = sum(*value, rate, damping);
            }
        }
        if let Some(reference) = &self.reference {
            for (value, &from) in local.iter_mut().zip(reference) {
                *value = difference(*value, from);
            }
        }
        let finite = if self.is_linear() {
            self.elastic(local, Some(out), None)
        } else {
            let mut account = core::mem::take(&mut self.account);
            let mut history = core::mem::take(&mut self.history);
            let batches = self.batches().count(self.arrangement.width);
            let elements = self.places.as_slice().len();
            let books = booked.map(|sums| EnergyBookkeeping {
                kept: account.of_batches((elements, P), batches),
                sums,
            });
            let rates = moves.then_some(Rates {
                step,
                velocity: rates,
                damping,
                books,
            });
            let memory = Memory::Write(&mut history);
            let finite = self.material(local, memory, rates, Some(out), None);
            (self.account, self.history) = (account, history);
            finite
        };
        if keeps {
            self.locals = locals;
        } else {
            SCRATCH.set(locals);
        }
        finite
    }

    /// The elastic operator on nodes by place.
    fn elastic<A: BatchScalar>(
        &self,
        nodes: &[Quad<f64>],
        out: Option<&mut [Quad<A>]>,
        survey: Option<&mut [Summary]>,
    ) -> bool {
        let operation = Elastic::<K, A, S, N, P> {
            kernel: &self.kernel,
            batches: self.batches(),
            moduli: self.moduli,
            nodes,
            out,
            survey,
        };
        self.lanes.dispatch(operation)
    }

    /// The law on nodes by place.
    fn material<A: BatchScalar>(
        &self,
        nodes: &[Quad<f64>],
        history: Memory<S>,
        rates: Option<Rates<A, S>>,
        out: Option<&mut [Quad<A>]>,
        survey: Option<&mut [Summary]>,
    ) -> bool {
        let Some(law) = self.law.now() else {
            return self.elastic(nodes, out, survey);
        };
        let mut exchanges = EXCHANGES.take();
        let operation = Material::<K, A, S, N, P> {
            kernel: &self.kernel,
            law,
            domain: self.law.elastic_domain().filter(|_| survey.is_none()),
            lanes: self.lanes,
            batches: self.batches(),
            moduli: self.moduli,
            state: self.law_state(),
            history,
            exchange: S::exchange(&mut exchanges),
            nodes,
            rates,
            out,
            survey,
        };
        let finite = self.lanes.dispatch(operation);
        EXCHANGES.set(exchanges);
        finite
    }

    /// A displacement by place, since the reference.
    fn since_reference(&self, displacement: NodalView) -> Vec<Quad<f64>> {
        let mut local = by_place(&self.nodes.numbers, displacement);
        if let Some(reference) = &self.reference {
            for (value, &from) in local.iter_mut().zip(reference) {
                *value = difference(*value, from);
            }
        }
        local
    }

    /// What is known of each element at a displacement since the reference (by place), under the
    /// committed history.
    fn survey(&self, nodes: &[Quad<f64>]) -> Vec<Summary> {
        if self.is_linear() {
            return self.elastic_survey(nodes);
        }
        let mut survey = vec![Summary::default(); self.elements.len()];
        let memory = Memory::Read(&self.history);
        self.material::<f64>(nodes, memory, None, None, Some(&mut survey));
        survey
    }

    /// The same under the initial stiffness.
    fn elastic_survey(&self, nodes: &[Quad<f64>]) -> Vec<Summary> {
        let mut survey = vec![Summary::default(); self.elements.len()];
        self.elastic::<f64>(nodes, None, Some(&mut survey));
        survey
    }

    /// The first element whose nodes or stresses are not numbers.
    fn fault(&self, context: &BlockContext) -> Option<ElementFault> {
        let displacement = self.since_reference(context.displacement);
        let velocity = by_place(&self.nodes.numbers, context.velocity);
        let survey = self.survey(&displacement);
        let finite = |values: &[Quad<f64>], place: u32| {
            let vector = values[place as usize].to_vector();
            vector.iter().all(|component| component.is_finite())
        };
        let reason = |element: usize| {
            let places = &self.places.as_slice()[element];
            if !places.iter().all(|&place| finite(&displacement, place)) {
                Some("a node's displacement is not finite")
            } else if !places.iter().all(|&place| finite(&velocity, place)) {
                Some("a node's velocity is not finite")
            } else if !survey[element].stress.0.iter().all(|s| s.is_finite()) {
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

    /// The first element with a force that is not a number, for stresses that were none under a history
    /// that was written over since.
    fn fault_of<A: NodeScalar>(&self, forces: &[Quad<A>]) -> Option<ElementFault> {
        let finite = |place: &u32| {
            let force = forces[*place as usize].to_vector();
            force.iter().all(|component| component.is_finite())
        };
        let element = (0..self.elements.len()).find(|&element| {
            self.is_active(element) && !self.places.as_slice()[element].iter().all(finite)
        });
        element.map(|element| ElementFault {
            element: self.elements[element],
            reason: "a force of its nodes is not finite".into(),
        })
    }

    fn forces_of<A: NodeScalar>(
        &mut self,
        context: &BlockContext,
        displacement: &[Quad<f64>],
        velocity: &[Quad<A>],
        out: &mut [Quad<A>],
    ) -> Result<(), ElementFault> {
        let damping = self.coefficient(context);
        self.law.prepare(context.step);
        // What is switched off keeps its old history.
        self.history
            .write_over(context.once && self.active.is_none());
        let mut sums = StepSums::default();
        let booked = context.ledger.then_some(&mut sums);
        let terms = (context.step, damping);
        let finite = self.write_forces(displacement, velocity, terms, booked, out);
        if !finite && let Some(fault) = self.fault(context).or_else(|| self.fault_of(out)) {
            return Err(fault);
        }
        if context.ledger {
            self.book_step(context, &sums);
        }
        Ok(())
    }

    fn apply_to<A: NodeScalar>(&self, operator: Operator, x: &[Quad<A>], out: &mut [Quad<A>]) {
        out.fill(Quad::default());
        if operator == Operator::Elastic || self.is_linear() {
            if const { size_of::<A>() < size_of::<S>() } {
                let mut sums = vec![Quad::default(); out.len()];
                self.apply_to::<f64>(operator, &doubled(x), &mut sums);
                for (out, sum) in out.iter_mut().zip(sums) {
                    *out = Quad::from_vector(&sum.to_vector());
                }
            } else {
                let numbers = self.nodes.numbers.iter();
                let local = numbers.map(|&node| Quad::from_vector(&x[node as usize].to_vector()));
                self.elastic(&local.collect::<Vec<_>>(), Some(out), None);
            }
            return;
        }
        self.each_element(operator, |element, forces| {
            let nodal = self.places.as_slice()[element].map(|place| {
                let node = self.nodes.numbers[place as usize];
                x[node as usize].to_vector().into()
            });
            for (&place, force) in self.places.as_slice()[element].iter().zip(forces(&nodal)) {
                let sum = &mut out[place as usize];
                *sum = Quad::from_vector(&(sum.to_vector() + Vec3::from(force)));
            }
        });
    }
}

/// The same values in double precision.
fn doubled<A: NodeScalar>(values: &[Quad<A>]) -> Vec<Quad<f64>> {
    let values = values.iter();
    values
        .map(|value| Quad::from_vector(&value.to_vector()))
        .collect()
}

/// `a + factor b`.
fn sum<A: NodeScalar>(a: Quad<f64>, b: Quad<A>, factor: f64) -> Quad<f64> {
    Quad::from_vector(&(a.to_vector() + b.to_vector() * factor))
}

/// `a - b`.
fn difference(a: Quad<f64>, b: Quad<f64>) -> Quad<f64> {
    Quad::from_vector(&(a.to_vector() - b.to_vector()))
}

/// Nodal values by place.
fn by_place(nodes: &[u32], view: NodalView) -> Vec<Quad<f64>> {
    let values = nodes.iter().map(|&node| view.vector(node as usize));
    values.map(|value| Quad::from_vector(&value)).collect()
}

/// Views of one call that differ in storage are a fault of the engine's author.
const ONE_STORAGE: &str = "velocities and forces of one call have the same storage";

impl<K, S, const N: usize, const P: usize> ElementBlock for Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    fn label(&self) -> &str {
        &self.label
    }
    fn elements(&self) -> &[u32] {
        &self.elements
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes.numbers
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        let converted;
        let u = match context.displacement {
            NodalView::F64(u) => u,
            NodalView::F32(u) => {
                converted = doubled(u);
                &converted
            }
        };
        match (context.velocity, out) {
            (NodalView::F64(v), NodalViewMut::F64(out)) => self.forces_of(context, u, v, out),
            (NodalView::F32(v), NodalViewMut::F32(out)) => self.forces_of(context, u, v, out),
            _ => panic!("{ONE_STORAGE}"),
        }
    }
    fn commit(&mut self) {
        self.history.commit();
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
    fn each_matrix(&self, operator: Operator, show: &mut dyn FnMut(&[u32], &[f64])) {
        self.show_matrices(operator, show);
    }
    fn add_mass(&self, out: &mut [f64]) {
        for (element, masses) in self.masses.iter().enumerate() {
            if self.is_active(element) {
                for (&place, mass) in self.places.as_slice()[element].iter().zip(masses) {
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
        self.account.rest();
    }
    fn set_reference_displacement(&mut self, displacement: NodalView) {
        self.reference = Some(by_place(&self.nodes.numbers, displacement));
        self.account.rest();
    }
    fn set_initial_stress(&mut self, stress: &[Stress]) {
        if self.is_linear() {
            // The change of stress of a linear law does not depend on where it starts.
            return;
        }
        self.initial = AlignedNumbers::zeros(6 * self.places.as_slice().len());
        for element in 0..self.places.as_slice().len() {
            let stress = &stress[element.min(stress.len() - 1)];
            for i in 0..6 {
                let place = self.arrangement.place(element, i, 6);
                self.initial.as_mut_slice()[place] = S::from_f64(stress.0[i]);
            }
        }
        self.account.rest();
    }
    fn add_forces_of(&self, stress: &[Stress], out: &mut [Vec3]) {
        self.add_forces_of_stress(stress, out);
    }
    fn add_stress(&self, displacement: NodalView, out: &mut [Stress]) {
        let survey = self.survey(&self.since_reference(displacement));
        for (out, summary) in out.iter_mut().zip(&survey) {
            *out = *out + summary.stress;
        }
    }
    fn element_forces(
        &self,
        place: usize,
        displacement: NodalView,
        initial: &Stress,
        out: &mut [Vec3],
    ) -> bool {
        self.write_forces_of(place, displacement, initial, out);
        true
    }
    fn energy(&self, context: &BlockContext) -> BlockEnergy {
        let mut energy = self.account.spent();
        for summary in self.survey(&self.since_reference(context.displacement)) {
            energy.elastic += summary.elastic;
            energy.hourglass += summary.hourglass;
        }
        energy
    }
    fn history(&self) -> Vec<HistoryField> {
        self.history.fields(&self.arrangement, &self.elements)
    }
    fn set_history(&mut self, fields: &[HistoryField]) {
        let (arrangement, elements) = (self.arrangement, &self.elements);
        self.history.set_fields(&arrangement, elements, fields);
        self.account.rest();
    }
    fn shown_history(&self, place: usize, variable: &str) -> Option<f64> {
        self.history.shown(&self.arrangement, place, variable)
    }
}
