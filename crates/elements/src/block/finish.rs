//! Forces, summaries and energy bookkeeping of a batch with its stresses.

use powerhouse_model::{ElementKernel, Geometry, Hourglass, KernelArithmetic, Stress};

use super::law::HistoryAccess;
use super::memory::as_lanes;
use super::operations::{BatchStress, Energy, Material, Response};
use super::own::OwnHistory;
use super::pore_water::pressures;
use super::remaining::{damped_share, less, product, times};
use super::survey::{FiniteCheck, each_lane, earlier, step_work, write_all, write_mean};
use super::transfer::{gather, gather_view, scatter};
use crate::lanes::{BatchLane, BatchScalar, MOST_LANES};

impl<K, S, const N: usize, const P: usize> Material<'_, K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: BatchScalar,
{
    /// Whether a batch had energy bookkeeping at the previous step.
    #[inline(always)]
    fn was_balanced(&self, batch: usize) -> bool {
        let rates = self.rates.as_ref();
        let bookkeeping = rates.and_then(|rates| rates.bookkeeping.as_ref());
        bookkeeping.is_some_and(|bookkeeping| bookkeeping.previous.balanced[batch])
    }

    /// Forces, summaries and energy bookkeeping of a batch with its changes of stress.
    #[inline(always)]
    pub(super) fn finish<L: BatchLane<Scalar = S>>(
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
            own,
        } = stress;
        let token = stresses[0].0[0].token();
        let (zero, one) = (L::splat(token, 0.0), L::splat(token, 1.0));
        // Remaining share of the hourglass stiffness.
        let mut share = one;
        if let (Some(remaining), true) = (&remaining, self.moduli.resist()) {
            share = remaining[0].hourglass;
            for point in &remaining[1..] {
                share = share + point.hourglass;
            }
            share = share * share.constant(1.0 / P as f64);
            share = share.max(share.constant(self.kernel.least_hourglass_share()));
        }
        let whole = self.moduli.hourglass::<L>(token);
        let moduli = [whole[0] * share, whole[1] * share, whole[2] * share];
        let batch = (self.batches).batch(index, L::WIDTH, self.kernel.geometry_len());
        let geometry = Geometry::new(token, as_lanes::<L>(token, batch.geometry));
        let by_law = !matches!(response, Response::Elastic);
        let own = if by_law {
            let step = (&modes, &stresses, remaining.as_ref());
            self.own_history(index, &batch, geometry, own, step)
        } else {
            OwnHistory::zero(zero)
        };
        let hourglass = Hourglass::new(moduli).with_history(own.after());
        if let HistoryAccess::Write(history) = &mut self.history {
            history.revert_absent(index, &batch);
        }
        let volumes = self.kernel.volumes(geometry);
        let works = matches!(response, Response::LawWithWork);
        let points = match response {
            Response::LawWithEnergies(energies, are_all) => Some((energies, are_all)),
            Response::Elastic if self.was_balanced(index) => Some((None, false)),
            Response::Elastic | Response::Law | Response::LawWithWork => None,
        };
        let energy = match &points {
            None if works => Some(Energy::not_required(zero)),
            Some((Some(points), are_all)) => Some(Energy::over(points, *are_all, &volumes)),
            Some((None, _)) => {
                let moduli = self.moduli;
                let water = if moduli.water == 0.0 {
                    None
                } else {
                    let strains = self.kernel.strains(geometry, &modes);
                    pressures(self.history.get(), moduli, index, &strains)
                };
                let water = water.as_ref();
                Some(Energy::of_stresses(moduli, &volumes, &stresses, water))
            }
            None => None,
        };
        if let (Some(survey), Some(energy)) = (&mut self.survey, &energy) {
            let survey = &mut *survey.out;
            write_mean(&volumes, &stresses, &batch, survey);
            each_lane(energy.sum.stored, &batch, |e, energy| {
                survey[e].elastic = energy;
            });
            let energy = (self.kernel).hourglass_energy(geometry, &hourglass, &modes);
            if let Some(energy) = energy {
                each_lane(energy, &batch, |e, energy| survey[e].hourglass = energy);
            }
        }
        if let Some(rates) = &mut self.rates
            && (rates.damping != 0.0 || (rates.bookkeeping.is_some() && energy.is_some()))
        {
            let velocity = (rates.velocity, batch.first);
            let mut nodal = [[zero; 3]; N];
            gather_view::<L, N>(token, self.batches.connectivity, velocity, &mut nodal);
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
                    let strains = earlier(rates.step, &strains, &strain_rates);
                    let lambda = L::splat(token, self.moduli.skeleton);
                    let shear = L::splat(token, self.moduli.shear);
                    let mut began = [Stress([zero; 6]); P];
                    for p in 0..P {
                        began[p] = Stress::elastic(lambda, shear, &strains[p]);
                    }
                    let water = pressures(self.history.get(), self.moduli, index, &strains);
                    if let Some(pressures) = &water {
                        for p in 0..P {
                            for i in 0..3 {
                                began[p].0[i] = began[p].0[i] - pressures[p];
                            }
                        }
                    }
                    let water = water.as_ref();
                    let energy = Energy::of_stresses(self.moduli, &volumes, &began, water);
                    write_all(&began, before);
                    sums.enter(energy.sum.stored, &batch);
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
                let (fallen, flowed) = (before - share, own.changed());
                if flowed || fallen.any(zero.less(fallen.abs())) {
                    let moved = times(&modal_rates, L::splat(token, rates.step));
                    let start = less(&modes, &moved);
                    let change = own.sum(-1.0, 1.0);
                    let change = own.known(&change);
                    let (began, ended) = ((&start, own.before()), (&modes, own.after()));
                    let pair = [ended, began, (&moved, change)];
                    let product = product(self.kernel, geometry, whole, pair);
                    let lost = fallen * product * fallen.constant(0.5);
                    sums.release(lost, self.kernel.hourglass_is_bending(), &batch);
                    if flowed {
                        // The mean of the forces works on what became plastic.
                        let parts = [
                            own.plastic_work(self.kernel, geometry, whole, (&start, false)),
                            own.plastic_work(self.kernel, geometry, whole, (&modes, true)),
                        ];
                        let both = before.mul_add(parts[0], share * parts[1]);
                        sums.flow(both * both.constant(0.5), &batch);
                    }
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
                        let mixed = [
                            (&modal_rates, &[][..]),
                            (&modal_before, &[]),
                            (&change, &[]),
                        ];
                        let mixed = product(self.kernel, geometry, whole, mixed);
                        let own = [(&modal_rates, &[][..]), (&modal_rates, &[]), (&still, &[])];
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
        let forces = (self.kernel).forces(geometry, &stresses, &hourglass, &modes);
        let forces = self.kernel.nodal_forces(&forces);
        if let Some(out) = &mut self.out {
            scatter::<L, N>(&forces, &batch, rows, (self.batches.connectivity, out));
        }
    }
}
