//! What a block does to all of its batches at a step.

use powerhouse_model::{
    ElasticDomain, ElementKernel, Geometry, LawEnergy, Quad, RemainingStiffness, Strain, Stress,
};

use super::account::{Kept, StepSums};
use super::batches::Batches;
use super::exchange::Exchange;
use super::law::{BatchLaw, Memory, Question, Wanted};
use super::numbers::Aligned;
use super::remaining::{LEAST_RESISTANCE, damped_share, less, product, times};
use super::survey::{
    Summary, complementary_energy, each_lane, earlier, linear_energy, step_work, write_all,
    write_mean,
};
use super::transfer::{gather, scatter};
use crate::lanes::{BatchLane, BatchOperation, BatchScalar, Lanes, MOST_LANES};

/// Elastic constants of the undamaged material (Pa).
#[derive(Clone, Copy, Debug)]
pub(super) struct Moduli {
    pub(super) lambda: f64,
    pub(super) shear: f64,
    /// What hourglass resistance is proportional to, zero if there is none.
    pub(super) hourglass: f64,
}

/// Zero as long as every stress seen is a number, NaN afterwards.
#[derive(Clone, Copy)]
struct Watch<L>(L);

impl<L: BatchLane> Watch<L> {
    #[inline(always)]
    fn see(&mut self, stress: &Stress<L>) {
        let sum = stress.0[0] + stress.0[1] + stress.0[2];
        self.0 = sum.mul_add(sum.constant(0.0), self.0);
    }
    #[inline(always)]
    fn all_finite(self) -> bool {
        let mut lanes = [L::Scalar::default(); MOST_LANES];
        self.0.store(&mut lanes);
        lanes.iter().all(|&lane| lane == L::Scalar::default())
    }
}

/// Elastic forces of a displacement by place; yields whether all is finite.
pub(super) struct Elastic<'a, K, A: BatchScalar, S, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) batches: Batches<'a, S, N>,
    pub(super) moduli: Moduli,
    pub(super) nodes: &'a [Quad<f64>],
    /// By place, if wanted.
    pub(super) out: Option<&'a mut [Quad<A>]>,
    /// One per element, if wanted.
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
        let mut watch = Watch(L::splat(token, 0.0));
        let nodes = self.batches.places.over(self.nodes);
        for index in 0..self.batches.count(L::WIDTH) {
            let batch = self
                .batches
                .batch(index, L::WIDTH, self.kernel.geometry_len());
            let geometry = Geometry::<L>::new(token, batch.geometry);
            gather::<f64, L, N>(token, nodes.elements(batch.first, L::WIDTH), &mut nodal);
            let modes = self.kernel.modes(&nodal);
            let strains = self.kernel.strains(geometry, &modes);
            let mut stresses = [Stress::zero(token); P];
            for p in 0..P {
                stresses[p] = Stress::elastic(lambda, shear, &strains[p]);
                watch.see(&stresses[p]);
            }
            let forces = self.kernel.forces(geometry, &stresses, modulus, &modes);
            let forces = self.kernel.nodal_forces(&forces);
            if let Some(out) = self.out.as_deref_mut() {
                scatter::<A, L, N>(&forces, &batch, &mut rows.0, out);
            }
            if let Some(survey) = self.survey.as_deref_mut() {
                let volumes = self.kernel.volumes(geometry);
                write_mean(&volumes, &stresses, &batch, survey);
                let energy = linear_energy(&volumes, &stresses, &strains);
                each_lane(energy, &batch, |e, energy| survey[e].elastic = energy);
                if let Some(energy) = self.kernel.hourglass_energy(geometry, modulus, &modes) {
                    each_lane(energy, &batch, |e, energy| survey[e].hourglass = energy);
                }
            }
        }
        watch.all_finite()
    }
}

/// What a law is told besides strain, for whole batches.
#[derive(Clone, Copy)]
pub(super) struct LawState<'a, S> {
    /// Six numbers per element, or empty.
    pub(super) initial: &'a [S],
    /// Six numbers per element, or those of one batch if all elements are alike.
    pub(super) extents: &'a [S],
}

/// Velocities, for damping and for the work of a step.
pub(super) struct Rates<'a, A: BatchScalar, S> {
    /// Length of the step (s).
    pub(super) step: f64,
    /// By place (m/s).
    pub(super) velocity: &'a [Quad<A>],
    /// Stiffness damping coefficient (s).
    pub(super) damping: f64,
    /// The account of the step, if one is kept.
    pub(super) books: Option<EnergyBookkeeping<'a, S>>,
}

/// Energy bookkeeping of a step: the increments of energy of the elements that may dissipate.
///
/// Batches that are surely elastic, and were so a step before, are not in it: of them the work of a step
/// is what they hold more after it.
pub(super) struct EnergyBookkeeping<'a, S> {
    /// What is kept of the step before.
    pub(super) kept: Kept<'a, S>,
    /// What the elements in the account did in the step.
    pub(super) sums: &'a mut StepSums,
}

/// How a batch was answered.
enum Answered<L, const P: usize> {
    /// By Hooke's law.
    Elastic,
    /// By its law, without energies.
    Plain,
    /// By its law, with energies if it told them.
    WithEnergies(Option<[LawEnergy<L>; P]>),
}

/// Forces of a law that is not linear; yields whether all is finite.
pub(super) struct Material<'a, K, A: BatchScalar, S, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) law: &'a dyn BatchLaw<S>,
    /// Stresses under which it need not be asked.
    pub(super) domain: Option<&'a ElasticDomain>,
    pub(super) lanes: Lanes,
    pub(super) batches: Batches<'a, S, N>,
    pub(super) moduli: Moduli,
    pub(super) state: LawState<'a, S>,
    pub(super) history: Memory<'a, S>,
    pub(super) exchange: &'a mut Exchange<S>,
    pub(super) nodes: &'a [Quad<f64>],
    pub(super) rates: Option<Rates<'a, A, S>>,
    /// By place, if wanted.
    pub(super) out: Option<&'a mut [Quad<A>]>,
    /// One per element, if wanted.
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
        let mut watch = Watch(L::splat(token, 0.0));
        let wants_energy = self.survey.is_some()
            || (self.rates.as_ref()).is_some_and(|rates| rates.books.is_some());
        let damped = (self.rates.as_ref()).is_some_and(|rates| rates.damping != 0.0);
        let wants_remaining = damped || self.moduli.hourglass != 0.0;
        let at_once = self.exchange.prepare(N, P, L::WIDTH);
        let count = self.batches.count(L::WIDTH);
        // How many of the last batches the law is still to be asked for.
        let mut kept = 0;
        for index in 0..count {
            let (modes, strains) = self.deformed::<L>(token, index);
            let elastic = self.elastic_answer::<L>(index, &strains);
            let mut end = index;
            if elastic.is_none() {
                self.exchange.keep::<L, N, P>(token, kept, &modes, &strains);
                kept += 1;
                end += 1;
            }
            if kept == at_once || (kept > 0 && (elastic.is_some() || end == count)) {
                let first = end - kept;
                let wanted = (wants_energy, wants_remaining.then_some(damped));
                let told = self.ask::<L>(first, kept, wanted);
                for place in 0..kept {
                    let modes = self.exchange.modes::<L, N>(token, place);
                    let (stresses, energies) = self.exchange.answer::<L, P>(token, place, told);
                    let answered = if wants_energy {
                        Answered::WithEnergies(energies)
                    } else {
                        Answered::Plain
                    };
                    let remaining = if wants_remaining {
                        Some(self.exchange.remaining::<L, P>(token, place))
                    } else {
                        None
                    };
                    let answer = (stresses, answered, remaining);
                    self.finish::<L>(first + place, modes, answer, &mut rows.0, &mut watch);
                }
                kept = 0;
            }
            if let Some(stresses) = elastic {
                let answer = (stresses, Answered::Elastic, None);
                self.finish::<L>(index, modes, answer, &mut rows.0, &mut watch);
            }
        }
        watch.all_finite()
    }
}

impl<K, A, S, const N: usize, const P: usize> Material<'_, K, A, S, N, P>
where
    K: ElementKernel<N, P>,
    A: BatchScalar,
    S: BatchScalar,
{
    /// Modes and strains of a batch.
    #[inline(always)]
    fn deformed<L: BatchLane<Scalar = S>>(
        &self,
        token: L::Token,
        index: usize,
    ) -> ([[L; 3]; N], [Strain<L>; P]) {
        let batch = (self.batches).batch(index, L::WIDTH, self.kernel.geometry_len());
        let geometry = Geometry::<L>::new(token, batch.geometry);
        let nodes = self.batches.places.over(self.nodes);
        let mut nodal = [[L::splat(token, 0.0); 3]; N];
        gather::<f64, L, N>(token, nodes.elements(batch.first, L::WIDTH), &mut nodal);
        let modes = self.kernel.modes(&nodal);
        let strains = self.kernel.strains(geometry, &modes);
        (modes, strains)
    }

    /// The changes of stress of a batch that has no history yet and is surely elastic: the law need
    /// not be asked.
    #[inline(always)]
    fn elastic_answer<L: BatchLane<Scalar = S>>(
        &mut self,
        batch: usize,
        strains: &[Strain<L>; P],
    ) -> Option<[Stress<L>; P]> {
        let domain = self.domain?;
        if let Memory::Write(history) = &mut self.history {
            history.retry(batch);
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

    /// Whether a batch was in the account of the step before, if there is one.
    #[inline(always)]
    fn was_booked(&self, batch: usize) -> bool {
        let books = self.rates.as_ref().and_then(|rates| rates.books.as_ref());
        books.is_some_and(|books| books.kept.booked[batch])
    }

    /// Forces and books of a batch with its changes of stress.
    #[inline(always)]
    fn finish<L: BatchLane<Scalar = S>>(
        &mut self,
        index: usize,
        mut modes: [[L; 3]; N],
        (mut stresses, answered, remaining): Answer<L, P>,
        rows: &mut [[[S; 4]; MOST_LANES]; N],
        watch: &mut Watch<L>,
    ) {
        let token = stresses[0].0[0].token();
        let one = L::splat(token, 1.0);
        // What is left of the hourglass stiffness.
        let mut path = one;
        if let (Some(remaining), true) = (&remaining, self.moduli.hourglass != 0.0) {
            path = remaining[0].of_path;
            for point in &remaining[1..] {
                path = path + point.of_path;
            }
            path = path * path.constant(1.0 / P as f64);
            path = path.max(path.constant(LEAST_RESISTANCE));
        }
        let whole = L::splat(token, self.moduli.hourglass);
        let modulus = whole * path;
        let batch = (self.batches).batch(index, L::WIDTH, self.kernel.geometry_len());
        let geometry = Geometry::<L>::new(token, batch.geometry);
        if let (Memory::Write(history), true) = (&mut self.history, batch.active.is_some()) {
            for lane in 0..L::WIDTH {
                if !batch.has(batch.arrangement.element_in[lane]) {
                    history.take_back(index, lane);
                }
            }
        }
        let volumes = self.kernel.volumes(geometry);
        let asked = !matches!(answered, Answered::Elastic);
        let points = match answered {
            Answered::WithEnergies(energies) => Some(energies),
            Answered::Elastic if self.was_booked(index) => Some(None),
            Answered::Elastic | Answered::Plain => None,
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
            let velocity = self.batches.places.over(rates.velocity);
            let velocity = velocity.elements(batch.first, L::WIDTH);
            let mut nodal = [[L::splat(token, 0.0); 3]; N];
            gather::<A, L, N>(token, velocity, &mut nodal);
            let zero = L::splat(token, 0.0);
            let modal_rates = self.kernel.modes(&nodal);
            let strain_rates = self.kernel.strains(geometry, &modal_rates);
            // What was left of the hourglass stiffness a step before.
            let place = (index * (P + 1) + P) * L::WIDTH;
            let mut path_before = one;
            if let Some(books) = &rates.books {
                path_before = L::load(token, &books.kept.left[place..]);
            }
            if let (Some(books), Some(energy)) = (&mut rates.books, energy) {
                let numbers = 6 * P * L::WIDTH;
                let before = &mut books.kept.stresses[index * numbers..(index + 1) * numbers];
                let enters = !core::mem::replace(&mut books.kept.booked[index], asked);
                if enters {
                    // The step began under Hooke's law.
                    let strains = self.kernel.strains(geometry, &modes);
                    let began = earlier(self.moduli, rates.step, &strains, &strain_rates);
                    write_all(&began, before);
                    let held = complementary_energy(self.moduli, &volumes, &began);
                    books.sums.enter(held, &batch);
                }
                let work = step_work(
                    &geometry,
                    rates.step,
                    &volumes,
                    &stresses,
                    &strain_rates,
                    before,
                );
                if asked {
                    books.sums.add(work, &energy, &batch);
                } else {
                    books.sums.leave(work, energy.sum.stored, &batch);
                }
                // Hourglass energy is given up as its stiffness falls: half of the fall times the product
                // of the strains before and after the step.
                let before = if enters { one } else { path_before };
                path.store(&mut books.kept.left[place..]);
                let fallen = before - path;
                if fallen.any(zero.less(fallen.abs())) {
                    let moved = times(&modal_rates, L::splat(token, rates.step));
                    let began = less(&modes, &moved);
                    let product = product(self.kernel, geometry, whole, [&modes, &began, &moved]);
                    books
                        .sums
                        .release(fallen * product * fallen.constant(0.5), &batch);
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
            if let (Some(books), true) = (&mut rates.books, rates.damping != 0.0) {
                let left = &mut books.kept.left[index * (P + 1) * L::WIDTH..];
                if !books.kept.velocity.is_empty() {
                    let velocity = self.batches.places.over(books.kept.velocity);
                    let velocity = velocity.elements(batch.first, L::WIDTH);
                    gather::<f64, L, N>(token, velocity, &mut nodal);
                    let modal_before = self.kernel.modes(&nodal);
                    let rates_before = self.kernel.strains(geometry, &modal_before);
                    let mut power = zero;
                    for p in 0..P {
                        let before = Stress::elastic(lambda, shear, &rates_before[p]);
                        let before = before.work(&strain_rates[p]);
                        let before = before * L::load(token, &left[p * L::WIDTH..]);
                        let both = before + damping_stresses[p].work(&strain_rates[p]);
                        power = both.mul_add(volumes[p], power);
                    }
                    if self.moduli.hourglass != 0.0 {
                        let change = less(&modal_rates, &modal_before);
                        let still = times(&modal_rates, zero);
                        let mixed = [&modal_rates, &modal_before, &change];
                        let mixed = product(self.kernel, geometry, whole, mixed);
                        let own = [&modal_rates, &modal_rates, &still];
                        let own = product(self.kernel, geometry, whole, own);
                        let both = path_before.mul_add(mixed, path * own);
                        power = both.mul_add(L::splat(token, rates.damping), power);
                    }
                    books
                        .sums
                        .damp(power * power.constant(0.5 * rates.step), &batch);
                }
                for p in 0..P {
                    shares[p].store(&mut left[p * L::WIDTH..]);
                }
                path.store(&mut left[P * L::WIDTH..]);
            }
            let damping = L::splat(token, rates.damping);
            for a in 0..N {
                for i in 0..3 {
                    modes[a][i] = modal_rates[a][i].mul_add(damping, modes[a][i]);
                }
            }
        }
        for p in 0..P {
            watch.see(&stresses[p]);
        }
        let forces = self.kernel.forces(geometry, &stresses, modulus, &modes);
        let forces = self.kernel.nodal_forces(&forces);
        if let Some(out) = self.out.as_deref_mut() {
            scatter::<A, L, N>(&forces, &batch, rows, out);
        }
    }

    /// Asks the law for successive batches, whose strains are kept, for energies and for what is left of
    /// the stiffness, all of it or that of the path alone; writes the new histories. Returns whether energies
    /// were wanted and told.
    #[inline(always)]
    fn ask<L: BatchLane<Scalar = S>>(
        &mut self,
        first: usize,
        count: usize,
        (wants_energy, wants_remaining): (bool, Option<bool>),
    ) -> bool {
        let initial = self.state.initial;
        let (strains, stresses, energies, numbers) = self.exchange.of_points(P * count, L::WIDTH);
        let remaining = match wants_remaining {
            Some(all) => Some(Wanted { numbers, all }),
            None => None,
        };
        self.law.answer(
            self.lanes,
            Question {
                first,
                points: P,
                strains,
                initial: (!initial.is_empty()).then(|| &initial[6 * first * L::WIDTH..]),
                extents: self.state.extents,
                memory: &mut self.history,
                stresses,
                energies: if wants_energy { Some(energies) } else { None },
                remaining,
            },
        )
    }
}

/// Changes of stress of a batch, how they were found, and what is left of the stiffness if that is wanted.
type Answer<L, const P: usize> = (
    [Stress<L>; P],
    Answered<L, P>,
    Option<[RemainingStiffness<L>; P]>,
);

/// Energies of a batch in a step (J).
pub(super) struct Energy<L> {
    /// Of all points.
    pub(super) sum: LawEnergy<L>,
    /// Whether the law told them; else there is only what an undamaged medium holds.
    pub(super) told: bool,
}

impl<L: BatchLane> Energy<L> {
    /// Integrates the energies of the points, or takes those of an undamaged medium under these
    /// stresses. No closure tells the latter: it could be compiled on its own, for the oldest processor.
    #[inline(always)]
    fn over<const P: usize>(
        points: Option<&[LawEnergy<L>; P]>,
        moduli: Moduli,
        volumes: &[L; P],
        stresses: &[Stress<L>; P],
    ) -> Self {
        let zero = volumes[0].constant(0.0);
        let mut sum = LawEnergy {
            stored: zero,
            plastic: zero,
            damage: zero,
            recovered: zero,
        };
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
            told: points.is_some(),
        }
    }
}
