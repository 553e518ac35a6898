//! Stiffness damping and hourglass stiffness that remain after damage and plastic flow.

use powerhouse_model::{
    ElementKernel, Geometry, Hourglass, KernelArithmetic, Lane, RemainingStiffness, Strain, Stress,
};

use crate::lanes::BatchLane;

/// Share of stiffness damping that acts at a point in a step of a length (s): the share that damage leaves,
/// times the elastic share of the strain increment.
///
/// Without it the velocity of the faces of an opening crack would transmit tension, and plastic flow would
/// overshoot the strength.
#[inline(always)]
pub(super) fn damped_share<L: Lane>(
    remaining: &RemainingStiffness<L>,
    resisted: &Stress<L>,
    rate: &Strain<L>,
    step: f64,
) -> L {
    let (zero, one) = (resisted.0[0].constant(0.0), resisted.0[0].constant(1.0));
    let total = resisted.work(rate) * one.constant(step);
    let plastic = resisted.work(&Strain(remaining.plastic_strain_increment));
    let some = zero.less(total);
    let elastic = one - plastic / total.select(some, one);
    let elastic = elastic.min(one).max(zero).select(some, one);
    remaining.undamaged * elastic
}

/// Modal values times a factor.
#[inline(always)]
pub(super) fn times<L: Lane, const N: usize>(modes: &[[L; 3]; N], factor: L) -> [[L; 3]; N] {
    let mut out = *modes;
    for mode in &mut out {
        for value in mode {
            *value = *value * factor;
        }
    }
    out
}

/// Difference of modal values.
#[inline(always)]
pub(super) fn less<L: BatchLane, const N: usize>(
    modes: &[[L; 3]; N],
    other: &[[L; 3]; N],
) -> [[L; 3]; N] {
    let mut out = *modes;
    for a in 0..N {
        for i in 0..3 {
            out[a][i] = out[a][i] - other[a][i];
        }
    }
    out
}

/// Modal values of a batch, and its own history, from which hourglass forces follow.
pub(super) type Deformation<'a, L, const N: usize> = (&'a [[L; 3]; N], &'a [L]);

/// Bilinear form of the hourglass stiffness of two deformations, given with their difference; that of a
/// deformation with itself is twice its energy.
#[inline(always)]
pub(super) fn product<K, L, const N: usize, const P: usize>(
    kernel: &K,
    geometry: Geometry<L>,
    moduli: [L; 3],
    [a, b, difference]: [Deformation<L, N>; 3],
) -> L
where
    K: ElementKernel<N, P>,
    L: BatchLane,
{
    let mut sum = moduli[0].constant(0.0);
    for ((modes, history), sign) in [(a, 1.0), (b, 1.0), (difference, -1.0)] {
        let hourglass = Hourglass::new(moduli).with_history(history);
        if let Some(energy) = kernel.hourglass_energy(geometry, &hourglass, modes) {
            sum = energy.mul_add(sum.constant(sign), sum);
        }
    }
    sum
}
