//! Energy bookkeeping: dissipation and other work that is accumulated step by step.

use powerhouse_model::{BlockContext, BlockEnergy, ElementKernel, Quad, StateError};
use serde::{Deserialize, Serialize};

use super::batches::Batch;
use super::numbers::AlignedNumbers;
use super::operations::Energy;
use super::saved::{Numbers, Places};
use super::survey::each_lane;
use super::transfer::NodeScalar;
use super::{Block, in_double, is_read};
use crate::lanes::{BatchLane, BatchScalar};

/// Energy bookkeeping of a block: accumulated energies, and the state at the last step.
#[derive(Debug)]
pub(super) struct Account<S> {
    /// Number of the last step; none if the next one does not continue it.
    number: Option<u64>,
    /// Velocity of that step (m/s), by local node index, where its product with the next one is required; empty
    /// if there was no damping.
    velocity: Vec<Quad<f64>>,
    /// Elastic and hourglass energy of that velocity taken as a displacement.
    velocity_energy: f64,
    /// Stresses at that step (Pa) of the batches with energy bookkeeping, for nonlinear laws.
    stress: AlignedNumbers<S>,
    /// Whether each batch had energy bookkeeping at that step.
    balanced: Vec<bool>,
    /// Whether the law has energies of its own.
    has_energies: bool,
    /// Share of hourglass stiffness of each batch at that step, for nonlinear laws.
    shares: AlignedNumbers<S>,
    /// Stresses of stiffness damping at that step (Pa), for nonlinear laws with damping; empty without.
    damping_stress: AlignedNumbers<S>,
    /// Whether stiffness damping acted at that step.
    damped: bool,
    /// Energy stored in these batches at that step (J).
    stored: f64,
    /// Of laws whose relaxed energy [telescopes](super::law_forms::LawForms::telescopes): what was stored and relaxed when the
    /// bookkeeping began, and the work since (J). What is not stored of it is relaxed.
    given: f64,
    /// Energies accumulated so far (J).
    spent: BlockEnergy,
}

impl<S: BatchScalar> Default for Account<S> {
    fn default() -> Self {
        Self {
            number: None,
            velocity: Vec::new(),
            velocity_energy: 0.0,
            stress: AlignedNumbers::zeros(0),
            balanced: Vec::new(),
            has_energies: false,
            shares: AlignedNumbers::zeros(0),
            damping_stress: AlignedNumbers::zeros(0),
            damped: false,
            stored: 0.0,
            given: 0.0,
            spent: BlockEnergy::default(),
        }
    }
}

impl<S: BatchScalar> Account<S> {
    /// Declares that the next step does not continue the last one.
    pub(super) fn restart(&mut self) {
        self.number = None;
    }
    /// Energies accumulated so far (J).
    pub(super) fn spent(&self) -> BlockEnergy {
        self.spent
    }
    /// State at the previous step, for a number of elements, points per element, and batches; `damped` if stiffness
    /// damping acts.
    pub(super) fn previous_step(
        &mut self,
        (elements, points): (usize, usize),
        batches: usize,
        damped: bool,
    ) -> PreviousStep<'_, S> {
        let numbers = 6 * elements * points;
        if self.stress.as_slice().len() != numbers {
            self.stress = AlignedNumbers::zeros(numbers);
            self.shares = AlignedNumbers::zeros(elements);
            self.balanced = vec![false; batches];
            self.number = None;
        }
        if damped && self.damping_stress.as_slice().len() != numbers {
            self.damping_stress = AlignedNumbers::zeros(numbers);
            self.damped = false;
        }
        PreviousStep {
            stresses: self.stress.as_mut_slice(),
            shares: self.shares.as_mut_slice(),
            damping_stresses: self.damping_stress.as_mut_slice(),
            damped: self.damped,
            balanced: &mut self.balanced,
            velocity: &self.velocity,
        }
    }
}

/// Saved energy bookkeeping of a block, in the order of its elements.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct SavedAccount {
    number: Option<u64>,
    velocity: Vec<[f64; 3]>,
    velocity_energy: f64,
    /// Stresses of the elements with energy bookkeeping.
    stress: Option<Numbers>,
    shares: Option<Numbers>,
    damping_stress: Option<Numbers>,
    has_energies: bool,
    damped: bool,
    stored: f64,
    given: f64,
    spent: BlockEnergy,
}

impl<S: BatchScalar> Account<S> {
    /// Whether the step of a number follows the last one of the bookkeeping.
    pub(super) fn is_followed_by(&self, number: u64) -> bool {
        number > 0 && self.number == Some(number - 1)
    }
    /// Whether each batch had energy bookkeeping at the last step; empty before any.
    pub(super) fn balanced(&self) -> &[bool] {
        &self.balanced
    }

    /// State between two steps, for a number of integration points per element.
    pub(super) fn saved(
        &self,
        places: Places,
        points: usize,
        balanced: impl Fn(usize) -> bool,
    ) -> SavedAccount {
        let kept = |numbers: &AlignedNumbers<S>| !numbers.as_slice().is_empty();
        let stress = kept(&self.stress).then(|| {
            let store = self.stress.as_slice();
            places.take(store, 6 * points, balanced)
        });
        let shares = kept(&self.shares).then(|| places.take(self.shares.as_slice(), 1, |_| true));
        let damping_stress = kept(&self.damping_stress).then(|| {
            let store = self.damping_stress.as_slice();
            places.take(store, 6 * points, |_| true)
        });
        SavedAccount {
            number: self.number,
            velocity: self.velocity.iter().map(|v| v.to_vector().into()).collect(),
            velocity_energy: self.velocity_energy,
            stress,
            shares,
            damping_stress,
            has_energies: self.has_energies,
            damped: self.damped,
            stored: self.stored,
            given: self.given,
            spent: self.spent,
        }
    }

    /// Restores a saved state; `of_batches` says which batches had energy bookkeeping, `balanced` which elements.
    pub(super) fn restore(
        &mut self,
        saved: SavedAccount,
        places: Places,
        points: usize,
        of_batches: Vec<bool>,
        balanced: impl Fn(usize) -> bool,
    ) -> Result<(), StateError> {
        let store = |numbers: &Option<Numbers>, count: usize, chosen: &dyn Fn(usize) -> bool| {
            let Some(numbers) = numbers else {
                return Ok(AlignedNumbers::zeros(0));
            };
            let mut store = AlignedNumbers::zeros(count * places.padded);
            places.put(numbers, store.as_mut_slice(), count, chosen)?;
            Ok::<_, StateError>(store)
        };
        let (stress, shares) = (&saved.stress, &saved.shares);
        let velocity = saved.velocity.iter().map(|&[x, y, z]| Quad::new(x, y, z));
        *self = Self {
            number: saved.number,
            velocity: velocity.collect(),
            velocity_energy: saved.velocity_energy,
            balanced: if stress.is_some() {
                of_batches
            } else {
                Vec::new()
            },
            stress: store(stress, 6 * points, &balanced)?,
            has_energies: saved.has_energies,
            shares: store(shares, 1, &|_| true)?,
            damping_stress: store(&saved.damping_stress, 6 * points, &|_| true)?,
            damped: saved.damped,
            stored: saved.stored,
            given: saved.given,
            spent: saved.spent,
        };
        Ok(())
    }
}

/// State of the batches at the previous step, replaced by that of the present one.
pub(super) struct PreviousStep<'a, S> {
    /// Stresses, six numbers per point, of the batches with energy bookkeeping.
    pub(super) stresses: &'a mut [S],
    /// Share of hourglass stiffness of each batch, in lanes.
    pub(super) shares: &'a mut [S],
    /// Stresses of stiffness damping, six numbers per point; empty without damping.
    pub(super) damping_stresses: &'a mut [S],
    /// Whether stiffness damping acted, so that these stresses are those of the previous step.
    pub(super) damped: bool,
    /// Whether each batch had energy bookkeeping.
    pub(super) balanced: &'a mut [bool],
    /// Velocity (m/s), by local node index; empty if there was no damping, and where hourglass forces do not act.
    pub(super) velocity: &'a [Quad<f64>],
}

/// Energies of the elements with energy bookkeeping in one step (J).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepSums {
    /// Work of the stresses.
    work: f64,
    /// Stored energy at the end of the step.
    stored: f64,
    /// Stored energy at the start of the step of batches whose bookkeeping begins in it.
    entered: f64,
    /// Stored energy at the end of the step of batches whose bookkeeping ends in it.
    left: f64,
    plastic: f64,
    damage: f64,
    recovered: f64,
    /// Dissipation by stiffness damping.
    damping: f64,
    /// Hourglass energy lost with hourglass stiffness.
    hourglass_loss: f64,
    /// Energy of bending lost with its stiffness, and in plastic flow.
    bending_damage: f64,
    bending_plastic: f64,
    /// Whether the law has energies of its own.
    has_energies: bool,
    /// Whether the stored energy is required in the step, or the work alone.
    pub(super) requires_stored: bool,
}

impl StepSums {
    /// Begins the bookkeeping of a batch with its stored energy.
    #[inline(always)]
    pub(super) fn enter<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        stored: L,
        batch: &Batch<S, N>,
    ) {
        each_lane(stored, batch, |_, stored| self.entered += stored);
    }

    /// Adds the dissipation of a batch by stiffness damping.
    #[inline(always)]
    pub(super) fn damp<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        dissipated: L,
        batch: &Batch<S, N>,
    ) {
        each_lane(dissipated, batch, |_, energy| self.damping += energy);
    }

    /// Adds the hourglass energy that a batch lost with its hourglass stiffness in the step; that of bending is energy
    /// of damage.
    #[inline(always)]
    pub(super) fn release<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        lost: L,
        of_bending: bool,
        batch: &Batch<S, N>,
    ) {
        let sum = if of_bending {
            &mut self.bending_damage
        } else {
            &mut self.hourglass_loss
        };
        each_lane(lost, batch, |_, lost| *sum += lost);
    }

    /// Adds the plastic energy of bending of a batch in the step.
    #[inline(always)]
    pub(super) fn flow<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        plastic: L,
        batch: &Batch<S, N>,
    ) {
        each_lane(plastic, batch, |_, plastic| self.bending_plastic += plastic);
    }

    /// Ends the bookkeeping of a batch with the work of the step and its stored energy after it.
    #[inline(always)]
    pub(super) fn leave<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        work: L,
        stored: L,
        batch: &Batch<S, N>,
    ) {
        each_lane(work, batch, |_, work| self.work += work);
        each_lane(stored, batch, |_, stored| self.left += stored);
    }

    /// Adds the work and the energies of a batch, element after element, for any width.
    #[inline(always)]
    pub(super) fn add<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        work: L,
        energy: &Energy<L>,
        batch: &Batch<S, N>,
    ) {
        let sum = &energy.sum;
        self.has_energies = energy.of_law;
        each_lane(work, batch, |_, work| self.work += work);
        each_lane(sum.stored, batch, |_, stored| self.stored += stored);
        let spent = sum.plastic + sum.damage + sum.recovered;
        let none = spent.constant(0.0);
        if spent.any(none.less(spent)) {
            each_lane(sum.plastic, batch, |_, plastic| self.plastic += plastic);
            each_lane(sum.damage, batch, |_, damage| self.damage += damage);
            each_lane(sum.recovered, batch, |_, energy| self.recovered += energy);
        }
    }
}

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    /// Sums of a step that are zero yet. Stored energy is required where the state may be read after the forces, where
    /// the bookkeeping begins, and of laws that have others in every step.
    pub(super) fn sums_of(&self, context: &BlockContext) -> StepSums {
        let begins = !self.account.is_followed_by(context.number);
        StepSums {
            requires_stored: is_read(context) || begins || !self.law.telescopes(),
            ..StepSums::default()
        }
    }

    /// Accumulates the energies of the step that ends at the context.
    ///
    /// With the velocity `v` of that step, `v_0` of the previous step and the elastic form
    /// `a(x, y) = x . K y`, stiffness damping dissipates `1/2 (a(v_0, v) + a(v, v)) beta dt`. With
    /// `E(x) = a(x, x) / 2`, summed element by element, `a(v_0, v) = E(v_0) + E(v) - E(v - v_0)`. For nonlinear
    /// laws the sum comes from the elements, with their remaining stiffness.
    ///
    /// The stresses of nonlinear laws do the work `1/2 (sigma_0 + sigma_1) : de V` on the strain increment.
    /// Work beyond the energies of the law is accumulated apart; for laws without energies it counts as
    /// plastic.
    pub(super) fn book_step(&mut self, context: &BlockContext, sums: &StepSums) {
        let damping = self.coefficient(context);
        if self.is_linear() && damping == 0.0 {
            return;
        }
        let mut account = core::mem::take(&mut self.account);
        let follows = account.is_followed_by(context.number);

        if damping != 0.0 {
            let continues = follows && account.damped;
            if continues {
                account.spent.damping += sums.damping;
            }
            account.damped = true;
        } else {
            account.damped = false;
        }
        if damping != 0.0 && (self.is_linear() || self.moduli.resist()) {
            let velocity = in_double(context.velocity);
            let continues = follows && account.velocity.len() == velocity.len();
            let mut energy = 0.0;
            if self.is_linear() {
                energy = self.elastic_form(&velocity);
            }
            if continues && self.is_linear() {
                let change: Vec<Quad<f64>> = velocity
                    .iter()
                    .zip(&account.velocity)
                    .map(|(v, before)| Quad::from_vector(&(v.to_vector() - before.to_vector())))
                    .collect();
                let mixed = account.velocity_energy + energy - self.elastic_form(&change);
                account.spent.damping += 0.5 * damping * context.step * (mixed + 2.0 * energy);
            }
            account.velocity_energy = energy;
            account.velocity = velocity;
        } else {
            account.velocity.clear();
        }

        if !self.is_linear() {
            account.has_energies |= sums.has_energies;
            if follows {
                let spent = &mut account.spent;
                spent.plastic += sums.plastic;
                spent.damage += sums.damage;
                spent.recovery -= sums.recovered;
                spent.hourglass += sums.hourglass_loss;
                spent.damage += sums.bending_damage;
                spent.plastic += sums.bending_plastic;
                let gained = sums.stored + sums.left - sums.entered - account.stored;
                let of_law = gained + sums.plastic + sums.damage - sums.recovered;
                let rest = sums.work - of_law;
                if self.law.telescopes() {
                    account.given += sums.work + sums.entered - sums.left;
                    if sums.requires_stored {
                        spent.relaxation = account.given - sums.stored;
                    }
                } else if account.has_energies && self.law.relaxes() {
                    spent.relaxation += rest;
                } else if account.has_energies {
                    spent.integration += rest;
                } else {
                    spent.plastic += rest;
                }
            }
            if !follows {
                account.given = account.spent.relaxation + sums.stored;
            }
            account.stored = sums.stored;
        }

        account.number = Some(context.number);
        self.account = account;
    }

    /// Elastic and hourglass energy of a nodal vector under the initial stiffness (J).
    fn elastic_form(&self, nodes: &[Quad<f64>]) -> f64 {
        let mut sum = 0.0;
        for summary in self.elastic_survey(nodes) {
            sum += summary.elastic + summary.hourglass;
        }
        sum
    }
}
