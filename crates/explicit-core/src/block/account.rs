//! Work that no state function gives, booked step by step.

use powerhouse_model::{BlockContext, BlockEnergy, ElementKernel, Quad};

use super::batches::Batch;
use super::numbers::AlignedNumbers;
use super::operations::Energy;
use super::survey::each_lane;
use super::transfer::NodeScalar;
use super::{Block, by_place};
use crate::lanes::{BatchLane, BatchScalar};

/// History variables of a block with which it accounts for damping and its law.
#[derive(Debug)]
pub(super) struct Account<S> {
    /// The step that the rest belongs to.
    number: Option<u64>,
    /// Velocity before that step (m/s), by place; empty if there was no damping.
    velocity: Vec<Quad<f64>>,
    /// Elastic and hourglass energy of that velocity taken as a displacement.
    velocity_energy: f64,
    /// Stress at that step (Pa) of the batches in its account, for laws that are not linear.
    stress: AlignedNumbers<S>,
    /// Which batches are in its account.
    booked: Vec<bool>,
    /// Whether the law tells what it takes.
    told: bool,
    /// The share of stiffness damping at each point of a batch at that step and that of its hourglass
    /// stiffness, for laws that are not linear.
    left: AlignedNumbers<S>,
    /// What the points of these batches held at that step (J).
    stored: f64,
    /// What the steps took so far (J).
    spent: BlockEnergy,
}

impl<S: BatchScalar> Default for Account<S> {
    fn default() -> Self {
        Self {
            number: None,
            velocity: Vec::new(),
            velocity_energy: 0.0,
            stress: AlignedNumbers::zeros(0),
            booked: Vec::new(),
            told: false,
            left: AlignedNumbers::zeros(0),
            stored: 0.0,
            spent: BlockEnergy::default(),
        }
    }
}

impl<S: BatchScalar> Account<S> {
    /// Forgets the last step: what follows does not continue it.
    pub(super) fn rest(&mut self) {
        self.number = None;
    }
    /// What the steps took so far (J).
    pub(super) fn spent(&self) -> BlockEnergy {
        self.spent
    }
    /// What is kept of the step before, for so many elements of so many points in so many batches.
    pub(super) fn of_batches(
        &mut self,
        (elements, points): (usize, usize),
        batches: usize,
    ) -> Kept<'_, S> {
        let numbers = 6 * elements * points;
        if self.stress.as_slice().len() != numbers {
            self.stress = AlignedNumbers::zeros(numbers);
            self.left = AlignedNumbers::zeros(elements * (points + 1));
            self.booked = vec![false; batches];
            self.number = None;
        }
        Kept {
            stresses: self.stress.as_mut_slice(),
            left: self.left.as_mut_slice(),
            booked: &mut self.booked,
            velocity: &self.velocity,
        }
    }
}

/// What an account keeps of the step before.
pub(super) struct Kept<'a, S> {
    /// Stresses, six numbers per point, of the batches that were in its account; those of this step
    /// afterwards.
    pub(super) stresses: &'a mut [S],
    /// Shares of stiffness damping, one per point, and of hourglass stiffness, likewise.
    pub(super) left: &'a mut [S],
    /// Which batches were in its account; which are in this one afterwards.
    pub(super) booked: &'a mut [bool],
    /// The velocity of the step before (m/s), by place; empty if there was no damping.
    pub(super) velocity: &'a [Quad<f64>],
}

/// What the elements in the account of a block did in a step (J).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepSums {
    /// Work of the stresses.
    work: f64,
    /// Held at the end of the step.
    stored: f64,
    /// Held at its start by those that came into the account in it, and at its end by those that left.
    entered: f64,
    left: f64,
    plastic: f64,
    damage: f64,
    recovered: f64,
    /// Taken by stiffness damping.
    damping: f64,
    /// Held by hourglass resistance that fell.
    resisted: f64,
    /// Whether the law told what it took.
    told: bool,
}

impl StepSums {
    /// Notes what a batch held when it came into the account.
    #[inline(always)]
    pub(super) fn enter<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        held: L,
        batch: &Batch<S, N>,
    ) {
        each_lane(held, batch, |_, held| self.entered += held);
    }

    /// Adds what stiffness damping took of a batch.
    #[inline(always)]
    pub(super) fn damp<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        taken: L,
        batch: &Batch<S, N>,
    ) {
        each_lane(taken, batch, |_, taken| self.damping += taken);
    }

    /// Adds what a batch held by hourglass resistance that fell in the step.
    #[inline(always)]
    pub(super) fn release<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        held: L,
        batch: &Batch<S, N>,
    ) {
        each_lane(held, batch, |_, held| self.resisted += held);
    }

    /// Adds the last step of a batch that leaves the account, with what it holds after it.
    #[inline(always)]
    pub(super) fn leave<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        work: L,
        held: L,
        batch: &Batch<S, N>,
    ) {
        each_lane(work, batch, |_, work| self.work += work);
        each_lane(held, batch, |_, held| self.left += held);
    }

    /// Adds a batch, element after element, whatever its width.
    #[inline(always)]
    pub(super) fn add<L: BatchLane<Scalar = S>, S: BatchScalar, const N: usize>(
        &mut self,
        work: L,
        energy: &Energy<L>,
        batch: &Batch<S, N>,
    ) {
        let sum = &energy.sum;
        self.told = energy.told;
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
    /// Accounts for the work of the step that ends at the context.
    ///
    /// With the velocity `v` of that step, `v_0` of the step before and the elastic form
    /// `a(x, y) = x . K y`, damping takes `1/2 (a(v_0, v) + a(v, v)) beta dt`. With `E(x) =
    /// a(x, x) / 2`, summed element by element, `a(v_0, v) = E(v_0) + E(v) - E(v - v_0)`. Of a law that is
    /// not linear the elements tell what it takes, with what is left of their stiffness.
    ///
    /// The stresses of other laws do the work `1/2 (sigma_0 + sigma_1) : de V` on the strain
    /// increment. What a law does not account for is booked apart; of laws that tell nothing it
    /// counts as plastic.
    pub(super) fn book_step(&mut self, context: &BlockContext, sums: &StepSums) {
        let damping = self.coefficient(context);
        if self.is_linear() && damping == 0.0 {
            return;
        }
        let mut account = core::mem::take(&mut self.account);
        let follows = context.number > 0 && account.number == Some(context.number - 1);

        if damping != 0.0 {
            let velocity = by_place(&self.nodes.numbers, context.velocity);
            let continues = follows && account.velocity.len() == velocity.len();
            let mut energy = 0.0;
            if self.is_linear() {
                energy = self.elastic_form(&velocity);
            } else if continues {
                account.spent.damping += sums.damping;
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
            account.told |= sums.told;
            if follows {
                let spent = &mut account.spent;
                spent.plastic += sums.plastic;
                spent.damage += sums.damage;
                spent.recovery -= sums.recovered;
                spent.hourglass += sums.resisted;
                let gained = sums.stored + sums.left - sums.entered - account.stored;
                let told = gained + sums.plastic + sums.damage - sums.recovered;
                let rest = sums.work - told;
                if account.told && self.law.relaxes() {
                    spent.relaxation += rest;
                } else if account.told {
                    spent.integration += rest;
                } else {
                    spent.plastic += rest;
                }
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
