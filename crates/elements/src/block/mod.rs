//! Blocks of elements of one kernel and one law, computed in lanes.

mod account;
mod any_law;
mod at_once;
mod batches;
mod capabilities;
mod element_forces;
mod exchange;
mod factory;
mod fault;
mod finish;
mod frequency;
mod history;
mod law;
mod law_forms;
mod linearised;
mod locations;
mod memory;
mod nodal;
mod numbers;
mod operations;
mod own;
mod pore_water;
#[cfg(feature = "programs")]
mod program;
mod remaining;
mod saved;
mod spared;
mod survey;
mod transfer;
mod water_pressure;

use std::cell::Cell;
use std::sync::{Arc, Mutex, PoisonError};

use powerhouse_model::{
    BlockContext, BlockOutput, BlockStiffness, DampedBlock, ElementBlock, ElementFault,
    ElementKernel, FrequencyBound, KernelArithmetic, NodalView, NodalViewMut, Operator,
    ProgrammedBlock, Quad, Rayleigh, StatefulBlock, Vec3,
};

use crate::lanes::{Arrangement, Lanes};
use account::{Account, StepSums};
use batches::Batches;
use exchange::Exchanges;
use history::History;
use law::HistoryAccess;
use law_forms::LawForms;
use locations::Locations;
use memory::Connectivity;
use nodal::{add, difference, doubled, in_double, is_narrower};
use numbers::AlignedNumbers;
use operations::{Elastic, EnergyBookkeeping, LawState, Material, Moduli, Rates, Rest, StepTerms};
use survey::{Shown, Summary, Survey};
use transfer::NodeScalar;

pub use any_law::AnyLaw;
pub use factory::solid;
pub(crate) use factory::{coordinate_rounding, of_any_law};
pub use pore_water::{Drainage, PoreWater};
pub use water_pressure::WaterPressure;

thread_local! {
    /// Displacements from which a block computes, where they are not those of the step: one buffer per thread, which
    /// stays in its cache from block to block.
    static SCRATCH: Cell<Vec<Quad<f64>>> = const { Cell::new(Vec::new()) };
    /// Buffers between kernels and laws, likewise.
    static EXCHANGES: Cell<Exchanges> = Cell::default();
}

/// Block of elements with a kernel of `N` nodes and `P` integration points and a law, in the scalar `S`.
struct Block<K, S: NodeScalar, const N: usize, const P: usize> {
    label: Arc<str>,
    kernel: K,
    law: LawForms<S>,
    moduli: Moduli,
    damping: Rayleigh,
    lanes: Lanes,
    arrangement: Arrangement,
    /// Mesh indices of the elements.
    elements: Vec<u32>,
    /// Mesh indices of the nodes.
    nodes: Vec<u32>,
    /// Local node indices of each element, whole batches.
    connectivity: Connectivity<N>,
    geometry: AlignedNumbers<S>,
    /// Six numbers of [`Extents`](powerhouse_model::Extents) per element (m2), of one batch if all elements
    /// are alike; empty for linear laws.
    extents: AlignedNumbers<S>,
    /// Locations of the integration points, if the law uses them.
    locations: Option<Locations<S>>,
    /// Lumped masses (kg) and frequency bound (rad/s) of each element, or of one if all elements are alike.
    masses: Vec<[f64; N]>,
    frequencies: Vec<f64>,
    active: Option<Vec<bool>>,
    /// Reference displacement of strain (m), by local node index.
    reference: Option<Vec<Quad<f64>>>,
    /// Initial stresses (Pa), effective ones where there is water in pores; empty if there are none.
    initial: AlignedNumbers<S>,
    /// Initial pressure of the water in the pores of each element (Pa); empty if there is none.
    pore_pressures: Vec<f64>,
    history: History<S>,
    /// Displacement (m) of the last static forces since the reference, on which secant and tangent stiffness
    /// depend; empty before.
    static_displacement: Vec<Quad<f64>>,
    /// That of the last committed static state, from which the elements' own histories follow; none if it is not known.
    committed_displacement: Option<Vec<Quad<f64>>>,
    account: Account<S>,
    /// What is known of the present step, if it is shown.
    shown: Mutex<Shown>,
    /// Whether the law is that of a linear skeleton with water in its pores.
    is_linear_ground: bool,
    /// Forces (N) that such ground has without displacement since its reference in dynamic steps, by local node index, and
    /// empty if all are zero; none if they are not known.
    forces_at_rest: Option<Vec<Quad<f64>>>,
}

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    fn batches(&self) -> Batches<'_, S, N> {
        Batches {
            elements: self.elements.len(),
            connectivity: &self.connectivity,
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

    /// Whether the elements have histories of their own that follow from increments of the motion.
    fn follows_flow(&self) -> bool {
        !self.is_linear() && self.moduli.resist() && self.kernel.own_history() > 0
    }

    /// Whether the elements condense strains of their own, with which each step begins from a prediction.
    fn condenses(&self) -> bool {
        !self.moduli.resist() && self.kernel.own_history() > 0
    }

    /// What is known of the present step.
    fn shown_mut(&mut self) -> &mut Shown {
        (self.shown.get_mut()).unwrap_or_else(PoisonError::into_inner)
    }

    /// Declares that the state has changed otherwise than by a step.
    fn restart(&mut self) {
        self.account.restart();
        self.shown_mut().begin(&[]);
    }

    fn is_active(&self, element: usize) -> bool {
        self.active.as_ref().is_none_or(|active| active[element])
    }

    /// Writes forces of a step, with energy bookkeeping if sums are given; returns whether all is finite.
    ///
    /// The damping force of a linear law is the elastic force of the velocity, which is therefore added to
    /// the displacement of the nodes.
    fn write_forces(
        &mut self,
        displacement: &[Quad<f64>],
        velocity: NodalView,
        terms: StepTerms,
        sums: Option<&mut StepSums>,
        mut out: NodalViewMut,
    ) -> bool {
        let StepTerms {
            step,
            damping,
            rests,
            shown,
        } = terms;
        let damped = damping != 0.0;
        let follows = self.law.is_stepping() && self.follows_flow();
        let spares_law = self.spares_law(damping);
        let needs_velocity =
            !spares_law && (damped || follows || (sums.is_some() && !self.is_linear()));
        if is_narrower::<S>(&out.view()) {
            // Nodes in lower precision than elements: few blocks, whose forces are rounded after their sum.
            let mut forces = vec![Quad::default(); displacement.len()];
            let velocity = if needs_velocity {
                in_double(velocity)
            } else {
                Vec::new()
            };
            let (velocity, sum) = (NodalView::F64(&velocity), NodalViewMut::F64(&mut forces));
            let finite = self.write_forces(displacement, velocity, terms, sums, sum);
            out.set(&forces);
            return finite;
        }
        out.clear();
        // Only static states are linearised: the displacement of a dynamic step is not stored.
        let stores = !self.is_linear() && !self.law.is_stepping();
        if !spares_law {
            self.forces_at_rest = None;
        }
        let adds_velocity = self.is_linear() && damped;
        let mut changed = Vec::new();
        if stores || adds_velocity || self.reference.is_some() {
            changed = if stores {
                core::mem::take(&mut self.static_displacement)
            } else {
                SCRATCH.take()
            };
            changed.clear();
            changed.extend_from_slice(displacement);
        }
        if adds_velocity {
            match velocity {
                NodalView::F64(velocity) => add(&mut changed, velocity, damping),
                NodalView::F32(velocity) => add(&mut changed, velocity, damping),
            }
        }
        if let Some(reference) = &self.reference {
            for (value, &from) in changed.iter_mut().zip(reference) {
                *value = difference(*value, from);
            }
        }
        let nodes = if changed.is_empty() {
            displacement
        } else {
            &changed
        };
        let is_shown = shown && !self.is_linear();
        let mut shown = core::mem::take(self.shown_mut());
        shown.begin(if is_shown { nodes } else { &[] });
        let finite = if self.is_linear() {
            self.elastic(nodes, self.moduli, Some(out), None)
        } else if spares_law {
            self.forces_without_law(nodes, out)
        } else {
            let mut account = core::mem::take(&mut self.account);
            let mut history = core::mem::take(&mut self.history);
            let batches = self.batches().count(self.arrangement.width);
            let elements = self.connectivity.as_slice().len();
            let bookkeeping = sums.map(|sums| EnergyBookkeeping {
                previous: account.previous_step((elements, P), batches, damped),
                sums,
            });
            let rates = needs_velocity.then_some(Rates {
                step,
                velocity,
                damping,
                bookkeeping,
            });
            let mut still = None;
            if stores && self.follows_flow() {
                // The first state is the committed one.
                let known = self.committed_displacement.take();
                still = Some(known.unwrap_or_else(|| nodes.to_vec()));
            }
            let access = HistoryAccess::Write(&mut history);
            let rest = Rest {
                still: still.as_deref(),
                relaxes: rests,
            };
            // The strains of elements that condense, and of states at rest, are others after the forces.
            let keeps = is_shown && !stores && !self.condenses();
            let survey = keeps.then(|| {
                shown.is_whole = self.law.elastic_domain().is_none();
                (shown.summaries).resize(self.elements.len(), Summary::default());
                Survey {
                    out: &mut shown.summaries,
                    of_spared: false,
                }
            });
            let finite = self.material(nodes, (access, rest), rates, Some(out), survey);
            self.committed_displacement = still;
            (self.account, self.history) = (account, history);
            finite
        };
        *self.shown_mut() = shown;
        if stores {
            self.static_displacement = changed;
        } else if !changed.is_empty() {
            SCRATCH.set(changed);
        }
        finite
    }

    /// Forces and summaries of the elastic stiffness at nodal displacements by local index.
    fn elastic(
        &self,
        nodes: &[Quad<f64>],
        moduli: Moduli,
        out: Option<NodalViewMut>,
        survey: Option<&mut [Summary]>,
    ) -> bool {
        let operation = Elastic::<K, S, N, P> {
            kernel: &self.kernel,
            batches: self.batches(),
            moduli,
            nodes,
            out,
            survey,
        };
        self.lanes.dispatch(operation)
    }

    /// Forces and summaries of the law at nodal displacements by local index.
    fn material(
        &self,
        nodes: &[Quad<f64>],
        (history, rest): (HistoryAccess<S>, Rest),
        rates: Option<Rates<S>>,
        out: Option<NodalViewMut>,
        survey: Option<Survey>,
    ) -> bool {
        let Some(law) = self.law.current() else {
            let survey = survey.map(|survey| survey.out);
            return self.elastic(nodes, self.moduli, out, survey);
        };
        let of_spared = survey.as_ref().is_some_and(|survey| survey.of_spared);
        let spares = out.is_some() || of_spared;
        let mut exchanges = EXCHANGES.take();
        let writes = matches!(history, HistoryAccess::Write(_));
        let operation = Material::<K, S, N, P> {
            kernel: &self.kernel,
            law,
            domain: self.law.elastic_domain().filter(|_| spares),
            lanes: self.lanes,
            batches: self.batches(),
            moduli: self.moduli,
            state: self.law_state(),
            locations: self.locations.as_ref(),
            history,
            exchange: S::exchange(&mut exchanges),
            nodes,
            still: rest.still,
            relaxes: writes && rest.relaxes && self.kernel.own_history() > 0,
            rates,
            out,
            survey,
        };
        let finite = self.lanes.dispatch(operation);
        EXCHANGES.set(exchanges);
        finite
    }

    /// Displacement relative to the reference, by local node index.
    fn since_reference(&self, displacement: NodalView) -> Vec<Quad<f64>> {
        let mut local = in_double(displacement);
        if let Some(reference) = &self.reference {
            for (value, &from) in local.iter_mut().zip(reference) {
                *value = difference(*value, from);
            }
        }
        local
    }

    /// Mean stress and stored energies of each element at a displacement relative to the reference (by local
    /// node index), from the committed history variables; in a step that is shown the law is not evaluated again.
    fn survey(&self, nodes: &[Quad<f64>]) -> Vec<Summary> {
        if self.is_linear() {
            return self.elastic_survey(nodes);
        }
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        let is_shown = shown.is_of(nodes);
        let mut summaries = Vec::new();
        if is_shown {
            summaries = core::mem::take(&mut shown.summaries);
        }
        if !(is_shown && shown.is_whole) {
            let of_spared = !summaries.is_empty();
            summaries.resize(self.elements.len(), Summary::default());
            let out = &mut summaries;
            let access = (HistoryAccess::Read(&self.history), Rest::default());
            self.material(nodes, access, None, None, Some(Survey { out, of_spared }));
        }
        if is_shown {
            shown.is_whole = true;
            shown.summaries.clone_from(&summaries);
        }
        summaries
    }

    /// The same of the initial stiffness.
    fn elastic_survey(&self, nodes: &[Quad<f64>]) -> Vec<Summary> {
        let mut survey = vec![Summary::default(); self.elements.len()];
        self.elastic(nodes, self.moduli, None, Some(&mut survey));
        survey
    }

    fn forces_of(
        &mut self,
        context: &BlockContext,
        displacement: &[Quad<f64>],
        mut out: NodalViewMut,
    ) -> Result<(), ElementFault> {
        let damping = self.coefficient(context);
        self.law.prepare(context.step);
        // What reads it and inactive elements keep the committed history; otherwise new variables overwrite it.
        self.history
            .set_in_place(!is_read(context) && self.active.is_none());
        let spares_law = self.spares_law(damping);
        let mut sums = self.sums_of(context);
        let balanced = (context.ledger && !spares_law).then_some(&mut sums);
        let terms = StepTerms {
            step: context.step,
            damping,
            rests: context.rests,
            shown: context.shown,
        };
        let velocity = context.velocity;
        let finite = self.write_forces(displacement, velocity, terms, balanced, out.reborrow());
        if !finite && let Some(fault) = self.fault(context).or_else(|| self.fault_of(out.view())) {
            return Err(fault);
        }
        if spares_law {
            self.show_pressures(context, displacement);
        } else if context.ledger {
            self.book_step(context, &sums);
        }
        Ok(())
    }

    fn apply_to(&self, operator: Operator, x: &[Quad<f64>], mut out: NodalViewMut) {
        out.clear();
        let takes_blocks = |law: &dyn law::BatchLaw<S>| law.takes_blocks();
        let is_initial = matches!(operator, Operator::Elastic | Operator::Static);
        if is_initial || self.law.static_form().is_none_or(takes_blocks) {
            let moduli = self.moduli_of(operator);
            if is_narrower::<S>(&out.view()) {
                let mut sums = vec![Quad::default(); x.len()];
                self.elastic(x, moduli, Some(NodalViewMut::F64(&mut sums)), None);
                out.set(&sums);
            } else {
                self.elastic(x, moduli, Some(out), None);
            }
            return;
        }
        self.each_element(operator, |element, forces| {
            let nodes = &self.connectivity.as_slice()[element];
            let nodal = nodes.map(|local| x[local as usize].to_vector().into());
            for (&local, force) in nodes.iter().zip(forces(&nodal)) {
                out.add(local as usize, &Vec3::from(force));
            }
        });
    }
}

/// Whether the state with which a step begins is read after its forces.
fn is_read(context: &BlockContext) -> bool {
    context.shown || context.repeats
}

/// The entry of an element in a list with one entry per element, or with one in all.
fn of_element<T>(list: &[T], element: usize) -> &T {
    if list.len() == 1 {
        &list[0]
    } else {
        &list[element]
    }
}

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
        &self.nodes
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        let converted;
        let displacement = match context.displacement {
            NodalView::F64(displacement) => displacement,
            NodalView::F32(displacement) => {
                converted = doubled(displacement);
                &converted
            }
        };
        self.forces_of(context, displacement, out)
    }
    fn add_mass(&self, out: &mut [f64]) {
        for element in 0..self.elements.len() {
            if self.is_active(element) {
                let nodes = &self.connectivity.as_slice()[element];
                for (&local, mass) in nodes.iter().zip(of_element(&self.masses, element)) {
                    out[local as usize] += mass;
                }
            }
        }
    }
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        (0..self.elements.len())
            .filter(|&element| self.is_active(element))
            .map(|element| {
                let frequency = *of_element(&self.frequencies, element);
                FrequencyBound::new(self.elements[element], frequency)
                    .with_stiffness_damping(self.damping.stiffness)
            })
            .collect()
    }
    fn damped(&self) -> Option<&dyn DampedBlock> {
        Some(self)
    }
    fn stiffness(&self) -> Option<&dyn BlockStiffness> {
        Some(self)
    }
    fn output(&self) -> Option<&dyn BlockOutput> {
        Some(self)
    }
    fn stateful(&self) -> Option<&dyn StatefulBlock> {
        Some(self)
    }
    fn stateful_mut(&mut self) -> Option<&mut dyn StatefulBlock> {
        Some(self)
    }
    fn programmed(&self) -> Option<&dyn ProgrammedBlock> {
        Some(self)
    }
}
