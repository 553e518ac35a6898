//! Force evaluation of all batches of a block: elastic, and with a law.

use powerhouse_model::{
    ElasticDomain, ElementKernel, Geometry, LawEnergy, Quad, RemainingStiffness, Strain, Stress,
};

use super::account::{PreviousStep, StepSums};
use super::batches::Batches;
use super::exchange::{Exchange, PointBuffers};
use super::law::{BatchLaw, Evaluation, HistoryAccess, RemainingOutput};
use super::locations::Locations;
use super::numbers::Aligned;
use super::remaining::{LEAST_HOURGLASS_SHARE, damped_share, less, product, times};
use super::survey::{
    FiniteCheck, Summary, complementary_energy, each_lane, earlier, linear_energy, step_work,
    write_all, write_mean,
};
use super::transfer::{gather, scatter};
use crate::lanes::{BatchLane, BatchOperation, BatchScalar, Lanes, MOST_LANES};

/// Elastic constants of the undamaged material (Pa).
#[derive(Clone, Copy, Debug)]
pub(super) struct Moduli {
    pub(super) lambda: f64,
    pub(super) shear: f64,
    /// Hourglass modulus of the undamaged material, zero if there are no hourglass forces.
    pub(super) hourglass: f64,
}

/// Elastic forces of a displacement by local node index; returns whether all is finite.
pub(super) struct Elastic<'a, K, A: BatchScalar, S, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) batches: Batches<'a, S, N>,
    pub(super) moduli: Moduli,
    pub(super) nodes: &'a [Quad<f64>],
    /// Output, if required: forces by local node index.
    pub(super) out: Option<&'a mut [Quad<A>]>,
    /// Output, if required: one summary per element.
    pub(super) survey: Option<&'a mut [Summary]>,
}

impl<K, A, S, const N: usize, const P: usize> BatchOperation<S> for Elastic<'_, K, A, S, N, P>
where
    K: ElementKernel<N, P>,
    A: BatchScalar,
    S: BatchScalar,
{
    type Output = bool;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(mut self, token: L::Token) -> bool {
        let lambda = L::splat(token, self.moduli.lambda);
        let shear = L::splat(token, self.moduli.shear);
        let modulus = L::splat(token, self.moduli.hourglass);
        let mut rows = Aligned([[[S::default(); 4]; MOST_LANES]; N]);
        let mut nodal = [[L::splat(token, 0.0); 3]; N];
        let mut check = FiniteCheck(L::splat(token, 0.0));
        let connectivity = self.batches.connectivity;
        let nodes = connectivity.over(self.nodes);
        let mut out = match self.out.take() {
            Some(out) => Some(connectivity.over_sums(out)),
            None => None,
        };
        for index in 0..self.batches.count(L::WIDTH) {
            let batch = self
                .batches
                .batch(index, L::WIDTH, self.kernel.geometry_len());
            let geometry = Geometry::<L>::new(token, batch.geometry);
            gather::<f64, L, N>(token, nodes.elements(batch.first, L::WIDTH), &mut nodal);
            let modes = self.kernel.modes(&nodal);
            let short = (self.kernel).elastic_forces(geometry, [lambda, shear], &modes);
            let forces = match short {
                // Strains and stresses are not computed.
                Some(forces) if self.survey.is_none() => {
                    check.add_forces(&forces);
                    forces
                }
                short => {
                    let strains = self.kernel.strains(geometry, &modes);
                    let mut stresses = [Stress::zero(token); P];
                    for p in 0..P {
                        stresses[p] = Stress::elastic(lambda, shear, &strains[p]);
                        check.add(&stresses[p]);
                    }
                    if let Some(survey) = self.survey.as_deref_mut() {
                        let volumes = self.kernel.volumes(geometry);
                        write_mean(&volumes, &stresses, &batch, survey);
                        let energy = linear_energy(&volumes, &stresses, &strains);
                        each_lane(energy, &batch, |e, energy| survey[e].elastic = energy);
                        let energy = self.kernel.hourglass_energy(geometry, modulus, &modes);
                        if let Some(energy) = energy {
                            each_lane(energy, &batch, |e, energy| survey[e].hourglass = energy);
                        }
                    }
                    match short {
                        Some(forces) => forces,
                        None => self.kernel.forces(geometry, &stresses, modulus, &modes),
                    }
                }
            };
            let forces = self.kernel.nodal_forces(&forces);
            if let Some(out) = &mut out {
                let out = out.elements(batch.first, L::WIDTH);
                scatter::<A, L, N>(&forces, &batch, &mut rows.0, out);
            }
        }
        check.all_finite()
    }
}

/// Input of a law besides strain and history, for whole batches.
#[derive(Clone, Copy)]
pub(super) struct LawState<'a, S> {
    /// Six initial stresses per element (Pa), or empty.
    pub(super) initial: &'a [S],
    /// Six numbers of the extents per element (m2), or those of one batch if all elements are alike.
    pub(super) extents: &'a [S],
}

/// Velocities, for stiffness damping and for the work of a step.
pub(super) struct Rates<'a, A: BatchScalar, S> {
    /// Length of the step (s).
    pub(super) step: f64,
    /// Velocity by local node index (m/s).
    pub(super) velocity: &'a [Quad<A>],
    /// Stiffness damping coefficient (s).
    pub(super) damping: f64,
    /// Energy bookkeeping of the step, if it is required.
    pub(super) bookkeeping: Option<EnergyBookkeeping<'a, S>>,
}

/// Energy bookkeeping of a step: the increments of energy of the elements that may dissipate.
///
/// It leaves out batches inside their elastic domain at the end of this step and of the previous one, of which
/// the work of a step is the increment of their stored energy.
pub(super) struct EnergyBookkeeping<'a, S> {
    /// State at the previous step.
    pub(super) previous: PreviousStep<'a, S>,
    /// Energies of the step.
    pub(super) sums: &'a mut StepSums,
}

/// Source of the stresses of a batch.
enum Response<L, const P: usize> {
    /// Hooke's law, inside the elastic domain.
    Elastic,
    /// The law, without energies.
    Law,
    /// The law, with energies if it has them.
    LawWithEnergies(Option<[LawEnergy<L>; P]>),
}

/// Changes of stress of a batch, their source, and the remaining stiffness if it is required.
struct BatchStress<L, const P: usize> {
    changes: [Stress<L>; P],
    response: Response<L, P>,
    remaining: Option<[RemainingStiffness<L>; P]>,
}

/// Output of a law that is required besides stresses.
#[derive(Clone, Copy)]
struct Required {
    energy: bool,
    /// Whether stiffness damping acts, which requires all of the remaining stiffness.
    damping: bool,
    /// Whether hourglass forces act, which require the hourglass share of the remaining stiffness.
    hourglass: bool,
}

/// Forces of a nonlinear law; returns whether all is finite.
pub(super) struct Material<'a, K, A: BatchScalar, S, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) law: &'a dyn BatchLaw<S>,
    /// Elastic domain, in which the law need not be evaluated.
    pub(super) domain: Option<&'a ElasticDomain>,
    pub(super) lanes: Lanes,
    pub(super) batches: Batches<'a, S, N>,
    pub(super) moduli: Moduli,
    pub(super) state: LawState<'a, S>,
    /// Locations of the integration points, if the law uses them.
    pub(super) locations: Option<&'a Locations<S>>,
    pub(super) history: HistoryAccess<'a, S>,
    pub(super) exchange: &'a mut Exchange<S>,
    pub(super) nodes: &'a [Quad<f64>],
    pub(super) rates: Option<Rates<'a, A, S>>,
    /// Output, if required: forces by local node index.
    pub(super) out: Option<&'a mut [Quad<A>]>,
    /// Output, if required: one summary per element.
    pub(super) survey: Option<&'a mut [Summary]>,
}

impl<K, A, S, const N: usize, const P: usize> BatchOperation<S> for Material<'_, K, A, S, N, P>
where
    K: ElementKernel<N, P>,
    A: BatchScalar,
    S: BatchScalar,
{
    type Output = bool;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(mut self, token: L::Token) -> bool {
        let mut rows = Aligned([[[S::default(); 4]; MOST_LANES]; N]);
        let mut check = FiniteCheck(L::splat(token, 0.0));
        let rates = self.rates.as_ref();
        let required = Required {
            energy: self.survey.is_some() || rates.is_some_and(|rates| rates.bookkeeping.is_some()),
            damping: rates.is_some_and(|rates| rates.damping != 0.0),
            hourglass: self.moduli.hourglass != 0.0,
        };
        let capacity = self.exchange.prepare(N, P, L::WIDTH);
        let count = self.batches.count(L::WIDTH);
        // Number of the last batches for which the law is still to be evaluated.
        let mut pending = 0;
        for index in 0..count {
            let (modes, strains) = self.deformed::<L>(token, index);
            let elastic = self.elastic_response::<L>(index, &strains);
            let mut end = index;
            if elastic.is_none() {
                self.exchange
                    .store::<L, N, P>(token, pending, &modes, &strains);
                pending += 1;
                end += 1;
            }
            if pending == capacity || (pending > 0 && (elastic.is_some() || end == count)) {
                let first = end - pending;
                let has_energies = self.evaluate::<L>(first, pending, required);
                for batch in 0..pending {
                    let modes = self.exchange.modes::<L, N>(token, batch);
                    let (changes, energies) =
                        self.exchange.response::<L, P>(token, batch, has_energies);
                    let response = if required.energy {
                        Response::LawWithEnergies(energies)
                    } else {
                        Response::Law
                    };
                    let remaining = if required.damping || required.hourglass {
                        Some(self.exchange.remaining::<L, P>(token, batch))
                    } else {
                        None
                    };
                    let stress = BatchStress {
                        changes,
                        response,
                        remaining,
                    };
                    self.finish::<L>(first + batch, modes, stress, &mut rows.0, &mut check);
                }
                pending = 0;
            }
            if let Some(changes) = elastic {
                let stress = BatchStress {
                    changes,
                    response: Response::Elastic,
                    remaining: None,
                };
                self.finish::<L>(index, modes, stress, &mut rows.0, &mut check);
            }
        }
        check.all_finite()
    }
}

impl<K, A, S, const N: usize, const P: usize> Material<'_, K, A, S, N, P>
where
    K: ElementKernel<N, P>,
    A: BatchScalar,
    S: BatchScalar,
{
    /// Modal displacements and strains of a batch.
    #[inline(always)]
    fn deformed<L: BatchLane<Scalar = S>>(
        &self,
        token: L::Token,
        index: usize,
    ) -> ([[L; 3]; N], [Strain<L>; P]) {
        let batch = (self.batches).batch(index, L::WIDTH, self.kernel.geometry_len());
        let geometry = Geometry::<L>::new(token, batch.geometry);
        let nodes = self.batches.connectivity.over(self.nodes);
        let mut nodal = [[L::splat(token, 0.0); 3]; N];
        gather::<f64, L, N>(token, nodes.elements(batch.first, L::WIDTH), &mut nodal);
        let modes = self.kernel.modes(&nodal);
        let strains = self.kernel.strains(geometry, &modes);
        (modes, strains)
    }

    /// Changes of stress of a virgin batch inside the elastic domain, for which the law need not be evaluated.
    #[inline(always)]
    fn elastic_response<L: BatchLane<Scalar = S>>(
        &mut self,
        batch: usize,
        strains: &[Strain<L>; P],
    ) -> Option<[Stress<L>; P]> {
        let domain = self.domain?;
        if let HistoryAccess::Write(history) = &mut self.history {
            history.discard_trial(batch);
        }
        if self.history.get().committed(batch).is_some() {
            return None;
        }
        let zero = strains[0].0[0].constant(0.0);
        let (lambda, shear) = (
            zero.constant(self.moduli.lambda),
            zero.constant(self.moduli.shear),
        );
        let mut initially = Stress([zero; 6]);
        if let Some(initial) = self.state.initial.get(6 * batch * L::WIDTH..)
            && !initial.is_empty()
        {
            for i in 0..6 {
                initially.0[i] = L::load(zero.token(), &initial[i * L::WIDTH..]);
            }
        }
        let mut changes = [initially; P];
        for p in 0..P {
            changes[p] = Stress::elastic(lambda, shear, &strains[p]);
            if !domain.contains(&(initially + changes[p])) {
                return None;
            }
        }
        Some(changes)
    }

    /// Whether a batch had energy bookkeeping at the previous step.
    #[inline(always)]
    fn was_balanced(&self, batch: usize) -> bool {
        let rates = self.rates.as_ref();
        let bookkeeping = rates.and_then(|rates| rates.bookkeeping.as_ref());
        bookkeeping.is_some_and(|bookkeeping| bookkeeping.previous.balanced[batch])
    }

    /// Forces, summaries and energy bookkeeping of a batch with its changes of stress.
    #[inline(always)]
    fn finish<L: BatchLane<Scalar = S>>(
        &mut self,
        index: usize,
        mut modes: [[L; 3]; N],
        stress: BatchStress<L, P>,
        rows: &mut [[[S; 4]; MOST_LANES]; N],
        check: &mut FiniteCheck<L>,
    ) {
        let BatchStress {
            changes: mut stresses,
            response,
            remaining,
        } = stress;
        let token = stresses[0].0[0].token();
        let one = L::splat(token, 1.0);
        // Remaining share of the hourglass stiffness.
        let mut share = one;
        if let (Some(remaining), true) = (&remaining, self.moduli.hourglass != 0.0) {
            share = remaining[0].hourglass;
            for point in &remaining[1..] {
                share = share + point.hourglass;
            }
            share = share * share.constant(1.0 / P as f64);
            share = share.max(share.constant(LEAST_HOURGLASS_SHARE));
        }
        let whole = L::splat(token, self.moduli.hourglass);
        let modulus = whole * share;
        let batch = (self.batches).batch(index, L::WIDTH, self.kernel.geometry_len());
        let geometry = Geometry::<L>::new(token, batch.geometry);
        if let (HistoryAccess::Write(history), true) = (&mut self.history, batch.active.is_some()) {
            for lane in 0..L::WIDTH {
                if !batch.has(batch.arrangement.element_in[lane]) {
                    history.revert_lane(index, lane);
                }
            }
        }
        let volumes = self.kernel.volumes(geometry);
        let by_law = !matches!(response, Response::Elastic);
        let points = match response {
            Response::LawWithEnergies(energies) => Some(energies),
            Response::Elastic if self.was_balanced(index) => Some(None),
            Response::Elastic | Response::Law => None,
        };
        let energy = match &points {
            Some(points) => {
                let points = points.as_ref();
                Some(Energy::over(points, self.moduli, &volumes, &stresses))
            }
            None => None,
        };
        if let (Some(survey), Some(energy)) = (self.survey.as_deref_mut(), &energy) {
            write_mean(&volumes, &stresses, &batch, survey);
            each_lane(energy.sum.stored, &batch, |e, energy| {
                survey[e].elastic = energy;
            });
            if let Some(energy) = self.kernel.hourglass_energy(geometry, modulus, &modes) {
                each_lane(energy, &batch, |e, energy| survey[e].hourglass = energy);
            }
        }
        if let Some(rates) = &mut self.rates
            && (rates.damping != 0.0 || energy.is_some())
        {
            let velocity = self.batches.connectivity.over(rates.velocity);
            let velocity = velocity.elements(batch.first, L::WIDTH);
            let mut nodal = [[L::splat(token, 0.0); 3]; N];
            gather::<A, L, N>(token, velocity, &mut nodal);
            let zero = L::splat(token, 0.0);
            let modal_rates = self.kernel.modes(&nodal);
            let strain_rates = self.kernel.strains(geometry, &modal_rates);
            // Remaining share of the hourglass stiffness at the previous step.
            let of_share = index * L::WIDTH;
            let mut share_before = one;
            if let Some(bookkeeping) = &rates.bookkeeping {
                share_before = L::load(token, &bookkeeping.previous.shares[of_share..]);
            }
            if let (Some(bookkeeping), Some(energy)) = (&mut rates.bookkeeping, energy) {
                let (previous, sums) = (&mut bookkeeping.previous, &mut *bookkeeping.sums);
                let numbers = 6 * P * L::WIDTH;
                let before = &mut previous.stresses[index * numbers..(index + 1) * numbers];
                let enters = !core::mem::replace(&mut previous.balanced[index], by_law);
                if enters {
                    // The step began under Hooke's law.
                    let strains = self.kernel.strains(geometry, &modes);
                    let began = earlier(self.moduli, rates.step, &strains, &strain_rates);
                    write_all(&began, before);
                    let stored = complementary_energy(self.moduli, &volumes, &began);
                    sums.enter(stored, &batch);
                }
                let work = step_work(
                    &geometry,
                    rates.step,
                    &volumes,
                    &stresses,
                    &strain_rates,
                    before,
                );
                if by_law {
                    sums.add(work, &energy, &batch);
                } else {
                    sums.leave(work, energy.sum.stored, &batch);
                }
                // Hourglass energy is lost as its stiffness falls: half of the fall times the product of the
                // deformations before and after the step.
                let before = if enters { one } else { share_before };
                share.store(&mut previous.shares[of_share..]);
                let fallen = before - share;
                if fallen.any(zero.less(fallen.abs())) {
                    let moved = times(&modal_rates, L::splat(token, rates.step));
                    let began = less(&modes, &moved);
                    let product = product(self.kernel, geometry, whole, [&modes, &began, &moved]);
                    sums.release(fallen * product * fallen.constant(0.5), &batch);
                }
            }
            let lambda = L::splat(token, rates.damping * self.moduli.lambda);
            let shear = L::splat(token, rates.damping * self.moduli.shear);
            let mut shares = [one; P];
            if let (Some(remaining), true) = (&remaining, rates.damping != 0.0) {
                for p in 0..P {
                    let resisted = Stress::elastic(lambda, shear, &strain_rates[p]);
                    shares[p] =
                        damped_share(&remaining[p], &resisted, &strain_rates[p], rates.step);
                }
            }
            let mut damping_stresses = [Stress([zero; 6]); P];
            for p in 0..P {
                let whole = Stress::elastic(lambda, shear, &strain_rates[p]);
                for i in 0..6 {
                    damping_stresses[p].0[i] = whole.0[i] * shares[p];
                }
                stresses[p] = stresses[p] + damping_stresses[p];
            }
            if let (Some(bookkeeping), true) = (&mut rates.bookkeeping, rates.damping != 0.0) {
                let (previous, sums) = (&mut bookkeeping.previous, &mut *bookkeeping.sums);
                let stored = &mut previous.damping_stresses[index * 6 * P * L::WIDTH..];
                if previous.damped {
                    let mut power = zero;
                    for p in 0..P {
                        let mut both = damping_stresses[p];
                        for i in 0..6 {
                            let before = L::load(token, &stored[(6 * p + i) * L::WIDTH..]);
                            both.0[i] = both.0[i] + before;
                        }
                        let both = both.work(&strain_rates[p]);
                        power = both.mul_add(volumes[p], power);
                    }
                    if !previous.velocity.is_empty() {
                        let velocity = self.batches.connectivity.over(previous.velocity);
                        let velocity = velocity.elements(batch.first, L::WIDTH);
                        gather::<f64, L, N>(token, velocity, &mut nodal);
                        let modal_before = self.kernel.modes(&nodal);
                        let change = less(&modal_rates, &modal_before);
                        let still = times(&modal_rates, zero);
                        let mixed = [&modal_rates, &modal_before, &change];
                        let mixed = product(self.kernel, geometry, whole, mixed);
                        let own = [&modal_rates, &modal_rates, &still];
                        let own = product(self.kernel, geometry, whole, own);
                        let both = share_before.mul_add(mixed, share * own);
                        power = both.mul_add(L::splat(token, rates.damping), power);
                    }
                    sums.damp(power * power.constant(0.5 * rates.step), &batch);
                }
                write_all(&damping_stresses, stored);
                share.store(&mut previous.shares[of_share..]);
            }
            let damping = L::splat(token, rates.damping);
            for a in 0..N {
                for i in 0..3 {
                    modes[a][i] = modal_rates[a][i].mul_add(damping, modes[a][i]);
                }
            }
        }
        for p in 0..P {
            check.add(&stresses[p]);
        }
        let forces = self.kernel.forces(geometry, &stresses, modulus, &modes);
        let forces = self.kernel.nodal_forces(&forces);
        if let Some(out) = self.out.as_deref_mut() {
            let mut out = self.batches.connectivity.over_sums(out);
            scatter::<A, L, N>(&forces, &batch, rows, out.elements(batch.first, L::WIDTH));
        }
    }

    /// Evaluates the law for successive batches, whose strains are in the exchange buffers, with the required
    /// output; writes new history variables. Returns whether energies are required and the law has them.
    #[inline(always)]
    fn evaluate<L: BatchLane<Scalar = S>>(
        &mut self,
        first: usize,
        count: usize,
        required: Required,
    ) -> bool {
        let initial = self.state.initial;
        let PointBuffers {
            strains,
            stresses,
            energies,
            remaining,
        } = self.exchange.of_points(P * count, L::WIDTH);
        let remaining = if required.damping || required.hourglass {
            Some(RemainingOutput {
                numbers: remaining,
                all: required.damping,
            })
        } else {
            None
        };
        self.law.evaluate(
            self.lanes,
            Evaluation {
                first,
                points: P,
                strains,
                initial: (!initial.is_empty()).then(|| &initial[6 * first * L::WIDTH..]),
                extents: self.state.extents,
                locations: self.locations,
                history: &mut self.history,
                stresses,
                energies: if required.energy {
                    Some(energies)
                } else {
                    None
                },
                remaining,
            },
        )
    }
}

/// Energies of a batch in a step (J).
pub(super) struct Energy<L> {
    /// Energies of all points of an element.
    pub(super) sum: LawEnergy<L>,
    /// Whether they are the law's own; otherwise they are the stored energy of an undamaged medium.
    pub(super) of_law: bool,
}

impl<L: BatchLane> Energy<L> {
    /// Integrates the energies of the points, or computes those of an undamaged medium with these stresses.
    /// Without closures, which could be compiled on their own, without the instructions of the lane.
    #[inline(always)]
    fn over<const P: usize>(
        points: Option<&[LawEnergy<L>; P]>,
        moduli: Moduli,
        volumes: &[L; P],
        stresses: &[Stress<L>; P],
    ) -> Self {
        let zero = volumes[0].constant(0.0);
        let mut sum = LawEnergy::stored(zero);
        match points {
            Some(points) => {
                for (point, &volume) in points.iter().zip(volumes) {
                    sum.stored = point.stored.mul_add(volume, sum.stored);
                    sum.plastic = point.plastic.mul_add(volume, sum.plastic);
                    sum.damage = point.damage.mul_add(volume, sum.damage);
                    sum.recovered = point.recovered.mul_add(volume, sum.recovered);
                }
            }
            None => sum.stored = complementary_energy(moduli, volumes, stresses),
        }
        Self {
            sum,
            of_law: points.is_some(),
        }
    }
}
