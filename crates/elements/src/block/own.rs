//! History of elements as a whole: what a kernel keeps beside the history variables of its law.

use powerhouse_model::{
    ElementKernel, Geometry, KernelArithmetic, Lane, OwnStep, RemainingStiffness, Strain, Stress,
};

use super::batches::Batch;
use super::law::HistoryAccess;
use super::memory::as_lanes;
use super::operations::{Material, Required};
use super::remaining::{less, product, times};
use super::transfer::{gather, gather_view};
use crate::lanes::{BatchLane, BatchScalar};

/// Most numbers of an element's own history.
pub(super) const MOST_OWN: usize = 12;

/// Most corrections of an own history in one evaluation of a static state.
const MOST_ITERATIONS: usize = 16;

/// Own history of a batch before and after a step.
pub(super) struct OwnHistory<L> {
    before: [L; MOST_OWN],
    after: [L; MOST_OWN],
    /// Number of its numbers; none if it is zero.
    count: usize,
}

impl<L: BatchLane> OwnHistory<L> {
    /// None, or all zero.
    #[inline(always)]
    pub(super) fn zero(zero: L) -> Self {
        Self {
            before: [zero; MOST_OWN],
            after: [zero; MOST_OWN],
            count: 0,
        }
    }
    /// Before the step; empty if it is zero.
    #[inline(always)]
    pub(super) fn before(&self) -> &[L] {
        &self.before[..self.count]
    }
    /// After the step; empty if it is zero.
    #[inline(always)]
    pub(super) fn after(&self) -> &[L] {
        &self.after[..self.count]
    }
    /// Whether any number of any lane changed in the step.
    #[inline(always)]
    pub(super) fn changed(&self) -> bool {
        self.count > 0 && differ(&self.before, &self.after)
    }
    /// Sum of both histories times factors.
    #[inline(always)]
    pub(super) fn sum(&self, before: f64, after: f64) -> [L; MOST_OWN] {
        let mut sum = self.before;
        for h in 0..MOST_OWN {
            let of_after = self.after[h] * sum[h].constant(after);
            sum[h] = sum[h].mul_add(sum[h].constant(before), of_after);
        }
        sum
    }
    /// The numbers that a history has; none if it is zero.
    #[inline(always)]
    pub(super) fn known<'a>(&self, numbers: &'a [L; MOST_OWN]) -> &'a [L] {
        &numbers[..self.count]
    }
    /// Work of the whole hourglass forces at the end or the start of the step on what became plastic in it.
    #[inline(always)]
    pub(super) fn plastic_work<K, const N: usize, const P: usize>(
        &self,
        kernel: &K,
        geometry: Geometry<L>,
        moduli: [L; 3],
        (modes, ended): (&[[L; 3]; N], bool),
    ) -> L
    where
        K: ElementKernel<N, P>,
    {
        // A history less than zero is a strain.
        let still = times(modes, moduli[0].constant(0.0));
        let flowed = self.sum(1.0, -1.0);
        let (forces, rest) = if ended {
            (self.after, self.sum(-1.0, 2.0))
        } else {
            (self.before, self.after)
        };
        let pair = [
            (modes, self.known(&forces)),
            (&still, self.known(&flowed)),
            (modes, self.known(&rest)),
        ];
        product(kernel, geometry, moduli, pair)
    }
}

/// Modal displacements, stresses and remaining stiffness at the end of a step.
type FinishedStep<'a, L, const N: usize, const P: usize> = (
    &'a [[L; 3]; N],
    &'a [Stress<L>; P],
    Option<&'a [RemainingStiffness<L>; P]>,
);

/// Whether any lane of two histories differs.
#[inline(always)]
fn differ<L: BatchLane>(a: &[L; MOST_OWN], b: &[L; MOST_OWN]) -> bool {
    let zero = a[0].constant(0.0);
    let mut sum = zero;
    for h in 0..MOST_OWN {
        sum = sum + (a[h] - b[h]).abs();
    }
    zero.any(zero.less(sum))
}

/// Deviatoric elastic part of strain increments over the whole, mean over the points.
#[inline(always)]
pub(super) fn elastic_share<L: Lane, const P: usize>(
    remaining: &[RemainingStiffness<L>; P],
    increments: &[Strain<L>; P],
) -> L {
    let (zero, one) = (
        increments[0].0[0].constant(0.0),
        increments[0].0[0].constant(1.0),
    );
    let mut sum = zero;
    for p in 0..P {
        let mut elastic = increments[p];
        for i in 0..6 {
            elastic.0[i] = elastic.0[i] - remaining[p].plastic_strain_increment[i];
        }
        let (part, whole) = (deviator(&elastic), deviator(&increments[p]));
        let some = zero.less(whole);
        let share = (part / whole.select(some, one)).sqrt();
        sum = sum + share.min(one).select(some, one);
    }
    sum * sum.constant(1.0 / P as f64)
}

/// Share of differences of stress that plastic flow at the points leaves, mean over the points.
#[inline(always)]
pub(super) fn kept<L: Lane, const P: usize>(
    remaining: &[RemainingStiffness<L>; P],
    changes: &[Stress<L>; P],
    initial: &Stress<L>,
    shear: L,
) -> L {
    let (zero, one) = (shear.constant(0.0), shear.constant(1.0));
    let mut sum = zero;
    for p in 0..P {
        let mut stress = *initial + changes[p];
        for shear in &mut stress.0[3..] {
            *shear = *shear + *shear;
        }
        let size = deviator(&Strain(stress.0)).sqrt();
        let flow = deviator(&Strain(remaining[p].plastic_strain_increment)).sqrt();
        let whole = (shear + shear).mul_add(flow, size);
        let some = zero.less(flow);
        sum = sum + (size / whole.select(some, one)).select(some, one);
    }
    sum * sum.constant(1.0 / P as f64)
}

/// Square of the deviator of a strain with engineering shears.
#[inline(always)]
fn deviator<L: Lane>(strain: &Strain<L>) -> L {
    let [xx, yy, zz, xy, yz, zx] = strain.0;
    let mean = (xx + yy + zz) * xx.constant(1.0 / 3.0);
    let (x, y, z) = (xx - mean, yy - mean, zz - mean);
    let shear = xy.mul_add(xy, yz.mul_add(yz, zx * zx));
    let normal = x.mul_add(x, y.mul_add(y, z * z));
    shear.mul_add(shear.constant(0.5), normal)
}

/// Whether any lane flows plastically.
#[inline(always)]
pub(super) fn flows<L: Lane, const P: usize>(remaining: &[RemainingStiffness<L>; P]) -> bool {
    let zero = remaining[0].hourglass.constant(0.0);
    let mut sum = zero;
    for point in remaining {
        for increment in &point.plastic_strain_increment {
            sum = sum + increment.abs();
        }
    }
    zero.any(zero.less(sum))
}

impl<K, S, const N: usize, const P: usize> Material<'_, K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: BatchScalar,
{
    /// Own history of a batch with which a step begins, or after the last forces where new ones are not stored.
    #[inline(always)]
    pub(super) fn own_at_start<L: BatchLane<Scalar = S>>(
        &self,
        zero: L,
        batch: usize,
    ) -> [L; MOST_OWN] {
        let mut own = [zero; MOST_OWN];
        let count = self.kernel.own_history();
        if count == 0 {
            return own;
        }
        let (numbers, starts) = match &self.history {
            HistoryAccess::Read(history) => (history.own(batch), false),
            HistoryAccess::Write(history) => (history.committed_own(batch), true),
        };
        if let Some(numbers) = numbers {
            for h in 0..count {
                own[h] = L::load(zero.token(), &numbers[h * L::WIDTH..]);
            }
        }
        if starts {
            self.kernel.own_at_start(&mut own[..count]);
        }
        own
    }

    /// Own history of a batch before and after a step that ends with modal displacements and stresses, and stores the
    /// new one; it does not change where new histories are not stored.
    #[inline(always)]
    pub(super) fn own_history<L: BatchLane<Scalar = S>>(
        &mut self,
        index: usize,
        batch: &Batch<S, N>,
        geometry: Geometry<L>,
        before: [L; MOST_OWN],
        (modes, stresses, remaining): FinishedStep<L, N, P>,
    ) -> OwnHistory<L> {
        let zero = geometry.constant(0.0);
        let count = self.kernel.own_history();
        if count == 0 {
            return OwnHistory::zero(zero);
        }
        let mut own = OwnHistory {
            before,
            after: before,
            count,
        };
        if matches!(self.history, HistoryAccess::Read(_)) {
            return own;
        }
        let mut step = OwnStep::new(&before[..count], modes, stresses);
        let moved;
        match remaining {
            Some(remaining) if self.moduli.resist() => {
                let increments = if flows(remaining) {
                    self.moved::<L>(batch, modes)
                } else {
                    None
                };
                if let Some(increments) = increments {
                    moved = increments;
                    let share = elastic_share(remaining, &self.kernel.strains(geometry, &moved));
                    let initial = self.initial_stress(zero, index);
                    let shear = zero.constant(self.moduli.shear);
                    let kept = kept(remaining, stresses, &initial, shear);
                    let moduli = self.moduli.hourglass::<L>(zero.token());
                    step = step.with_flow(&moved, moduli, [share, kept]);
                    self.kernel
                        .own_history_after(geometry, &step, &mut own.after[..count]);
                }
            }
            _ => {
                self.kernel
                    .own_history_after(geometry, &step, &mut own.after[..count]);
            }
        }
        if let HistoryAccess::Write(history) = &mut self.history {
            let mut committed = [zero; MOST_OWN];
            if let Some(numbers) = history.committed_own(index) {
                for h in 0..count {
                    committed[h] = L::load(zero.token(), &numbers[h * L::WIDTH..]);
                }
            }
            let changed = differ(&committed, &own.after);
            history.store_own(index, &own.after[..count], changed);
        }
        own
    }

    /// Brings the own histories of successive batches, of which the law was evaluated, to equilibrium within their elements.
    #[inline(always)]
    pub(super) fn relax<L: BatchLane<Scalar = S>>(
        &mut self,
        token: L::Token,
        first: usize,
        pending: usize,
        required: Required,
    ) {
        let count = self.kernel.own_history();
        let zero = L::splat(token, 0.0);
        let mut before = vec![[[zero; 2]; MOST_OWN]; pending];
        for (batch, before) in before.iter_mut().enumerate() {
            let own = self.exchange.own::<L>(token, batch);
            for h in 0..MOST_OWN {
                before[h] = [own[h]; 2];
            }
        }
        for _iteration in 0..MOST_ITERATIONS {
            let mut any = false;
            for batch in 0..pending {
                let index = first + batch;
                let geometry = (self.batches).batch(index, L::WIDTH, self.kernel.geometry_len());
                let geometry = Geometry::new(token, as_lanes::<L>(token, geometry.geometry));
                let (stresses, _) = self.exchange.response::<L, P>(token, batch, false);
                let mut own = self.exchange.own::<L>(token, batch);
                let before = &mut before[batch];
                if (self.kernel).relax_own(geometry, &stresses, &mut own[..count], before) {
                    any = true;
                    let modes = self.exchange.modes::<L, N>(token, batch);
                    let mut strains = self.kernel.strains(geometry, &modes);
                    (self.kernel).add_own_strains(geometry, &own[..count], &mut strains);
                    self.exchange
                        .store::<L, N, P>(token, batch, &modes, &strains);
                    self.exchange.store_own::<L>(token, batch, &own);
                }
            }
            if !any {
                return;
            }
            self.evaluate::<L>(first, pending, required);
        }
    }

    /// Increments of the modal displacements of a batch in the step; none if the state before it is not known.
    #[inline(always)]
    fn moved<L: BatchLane<Scalar = S>>(
        &self,
        batch: &Batch<S, N>,
        modes: &[[L; 3]; N],
    ) -> Option<[[L; 3]; N]> {
        let zero = modes[0][0].constant(0.0);
        let mut nodal = [[zero; 3]; N];
        if let Some(rates) = &self.rates {
            let velocity = (rates.velocity, batch.first);
            gather_view::<L, N>(
                zero.token(),
                self.batches.connectivity,
                velocity,
                &mut nodal,
            );
            let rate = self.kernel.modes(&nodal);
            return Some(times(&rate, zero.constant(rates.step)));
        }
        let committed = self.batches.connectivity.over(self.still?);
        let committed = committed.elements(batch.first, L::WIDTH);
        gather::<f64, L, N>(zero.token(), committed, &mut nodal);
        Some(less(modes, &self.kernel.modes(&nodal)))
    }
}
