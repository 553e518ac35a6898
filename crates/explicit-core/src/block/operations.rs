//! What a block does to all of its batches at a step.

use powerhouse_model::{ConstitutiveLaw, ElementKernel, Geometry, LawInput, Quad, Strain, Stress};

use super::batches::{Batch, Batches};
use super::survey::{
    Summary, complementary_energy, each_lane, linear_energy, step_work, write_mean,
};
use super::transfer::{gather, scatter};
use crate::lanes::{BatchLane, BatchOperation, BatchScalar, MOST_LANES};

/// Elastic constants of the undamaged material (Pa).
#[derive(Clone, Copy, Debug)]
pub(super) struct Moduli {
    pub(super) lambda: f64,
    pub(super) shear: f64,
}

impl Moduli {
    /// `lambda + 2 G`, which hourglass resistance is measured in.
    pub(super) fn constrained(self) -> f64 {
        self.lambda + 2.0 * self.shear
    }
}

/// Forces turned to rows. The alignment is that of a register, which makes the compiler align the
/// whole stack frame: registers that it spills would straddle cache lines otherwise.
#[repr(align(64))]
struct Turned<T>(T);

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
    pub(super) nodes: &'a [Quad<A>],
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
        let modulus = L::splat(token, self.moduli.constrained());
        let mut rows = Turned([[[S::default(); 4]; MOST_LANES]; N]);
        let mut nodal = [[L::splat(token, 0.0); 3]; N];
        let mut watch = Watch(L::splat(token, 0.0));
        let nodes = self.batches.places.over(self.nodes);
        for index in 0..self.batches.count(L::WIDTH) {
            let batch = self
                .batches
                .batch(index, L::WIDTH, self.kernel.geometry_len());
            let geometry = Geometry::<L>::new(token, batch.geometry);
            gather::<A, L, N>(token, nodes.elements(batch.first, L::WIDTH), &mut nodal);
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
    /// One number per element.
    pub(super) size: &'a [S],
    /// Numbers per point and element.
    pub(super) variables: usize,
    /// The committed history: variables of the points of a batch.
    pub(super) history: &'a [S],
}

/// Velocities, for damping and for the work of a step.
pub(super) struct Rates<'a, A: BatchScalar, S> {
    /// By place (m/s).
    pub(super) velocity: &'a [Quad<A>],
    /// Stiffness damping coefficient (s).
    pub(super) damping: f64,
    /// Length of the step (s).
    pub(super) step: f64,
    /// Stresses of the step before, six numbers per point, if work is accounted for.
    pub(super) stored: Option<&'a mut [S]>,
}

/// Forces of a law that is not linear; yields whether all is finite.
pub(super) struct Material<'a, K, M, A: BatchScalar, S, const N: usize, const P: usize> {
    pub(super) kernel: &'a K,
    pub(super) law: &'a M,
    pub(super) batches: Batches<'a, S, N>,
    pub(super) moduli: Moduli,
    pub(super) state: LawState<'a, S>,
    pub(super) nodes: &'a [Quad<A>],
    pub(super) rates: Option<Rates<'a, A, S>>,
    /// Where the new history goes, if it is wanted.
    pub(super) new_history: Option<&'a mut [S]>,
    /// By place, if wanted.
    pub(super) out: Option<&'a mut [Quad<A>]>,
    /// One per element, if wanted.
    pub(super) survey: Option<&'a mut [Summary]>,
}

impl<K, M, A, S, const N: usize, const P: usize> BatchOperation<S>
    for Material<'_, K, M, A, S, N, P>
where
    K: ElementKernel<N, P>,
    M: ConstitutiveLaw,
    A: BatchScalar,
    S: BatchScalar,
{
    type Output = bool;
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(mut self, token: L::Token) -> bool {
        let modulus = L::splat(token, self.moduli.constrained());
        let mut rows = Turned([[[S::default(); 4]; MOST_LANES]; N]);
        let mut nodal = [[L::splat(token, 0.0); 3]; N];
        let mut watch = Watch(L::splat(token, 0.0));
        let mut old = vec![L::splat(token, 0.0); self.state.variables];
        let mut new = old.clone();
        let nodes = self.batches.places.over(self.nodes);
        for index in 0..self.batches.count(L::WIDTH) {
            let batch = self
                .batches
                .batch(index, L::WIDTH, self.kernel.geometry_len());
            let geometry = Geometry::<L>::new(token, batch.geometry);
            gather::<A, L, N>(token, nodes.elements(batch.first, L::WIDTH), &mut nodal);
            let mut modes = self.kernel.modes(&nodal);
            let strains = self.kernel.strains(geometry, &modes);
            let mut stresses = self.ask::<L>(token, index, &strains, (&mut old, &mut new));
            if let (Some(new), true) = (self.new_history.as_deref_mut(), batch.active.is_some()) {
                keep_history::<L, S, N>(&self.state, &batch, index, P, new);
            }
            if let Some(survey) = self.survey.as_deref_mut() {
                let volumes = self.kernel.volumes(geometry);
                write_mean(&volumes, &stresses, &batch, survey);
                let energy = complementary_energy(self.moduli, &volumes, &stresses);
                each_lane(energy, &batch, |e, energy| survey[e].elastic = energy);
                if let Some(energy) = self.kernel.hourglass_energy(geometry, modulus, &modes) {
                    each_lane(energy, &batch, |e, energy| survey[e].hourglass = energy);
                }
            }
            if let Some(rates) = &mut self.rates {
                let velocity = self.batches.places.over(rates.velocity);
                let velocity = velocity.elements(batch.first, L::WIDTH);
                gather::<A, L, N>(token, velocity, &mut nodal);
                let modal_rates = self.kernel.modes(&nodal);
                let strain_rates = self.kernel.strains(geometry, &modal_rates);
                if let (Some(survey), Some(stored)) =
                    (self.survey.as_deref_mut(), rates.stored.as_deref_mut())
                {
                    let volumes = self.kernel.volumes(geometry);
                    let numbers = 6 * P * L::WIDTH;
                    let stored = &mut stored[index * numbers..(index + 1) * numbers];
                    let work = step_work(
                        &geometry,
                        rates.step,
                        &volumes,
                        &stresses,
                        &strain_rates,
                        stored,
                    );
                    each_lane(work, &batch, |e, work| survey[e].work = work);
                }
                let lambda = L::splat(token, rates.damping * self.moduli.lambda);
                let shear = L::splat(token, rates.damping * self.moduli.shear);
                for p in 0..P {
                    stresses[p] = stresses[p] + Stress::elastic(lambda, shear, &strain_rates[p]);
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
                scatter::<A, L, N>(&forces, &batch, &mut rows.0, out);
            }
        }
        watch.all_finite()
    }
}

impl<K, M, A, S, const N: usize, const P: usize> Material<'_, K, M, A, S, N, P>
where
    M: ConstitutiveLaw,
    A: BatchScalar,
    S: BatchScalar,
{
    /// Stresses at the points of a batch; writes the new histories.
    #[inline(always)]
    fn ask<L: BatchLane<Scalar = S>>(
        &mut self,
        token: L::Token,
        index: usize,
        strains: &[Strain<L>; P],
        (old, new): (&mut [L], &mut [L]),
    ) -> [Stress<L>; P] {
        let state = &self.state;
        let mut initial = Stress::zero(token);
        if !state.initial.is_empty() {
            for i in 0..6 {
                initial.0[i] = L::load(token, &state.initial[(6 * index + i) * L::WIDTH..]);
            }
        }
        let size = L::load(token, &state.size[index * L::WIDTH..]);
        let mut stresses = [initial; P];
        for p in 0..P {
            let place = (index * P + p) * state.variables;
            for h in 0..state.variables {
                old[h] = L::load(token, &state.history[(place + h) * L::WIDTH..]);
            }
            let input = LawInput::new(strains[p], old)
                .with_initial(initial)
                .with_size(size);
            stresses[p] = self.law.stress_change(&input, new);
            if let Some(new_history) = self.new_history.as_deref_mut() {
                for h in 0..state.variables {
                    new[h].store(&mut new_history[(place + h) * L::WIDTH..]);
                }
            }
        }
        stresses
    }
}

/// Takes the history of inactive elements back.
#[inline(always)]
fn keep_history<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
    state: &LawState<S>,
    batch: &Batch<S, N>,
    index: usize,
    points: usize,
    new_history: &mut [S],
) {
    let numbers = points * state.variables;
    for lane in 0..L::WIDTH {
        if batch.has(batch.arrangement.element_in[lane]) {
            continue;
        }
        for number in 0..numbers {
            let place = (index * numbers + number) * L::WIDTH + lane;
            new_history[place] = state.history[place];
        }
    }
}
