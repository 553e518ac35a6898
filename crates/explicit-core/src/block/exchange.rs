//! What passes between kernel and law.

use core::ops::Range;

use powerhouse_model::{LawEnergy, RemainingStiffness, Strain, Stress};

use super::memory::{as_lanes, as_lanes_mut};
use super::numbers::AlignedNumbers;
use crate::lanes::{BatchLane, BatchScalar};

/// Points of successive batches that a law is asked for at once. Asking costs something, and histories
/// that are read and written in long rows come sooner: with flat damping by three mechanisms a step of
/// 110,592 elements takes 58 ns per element where 4 are asked for at once and 52 where 32 are, in mixed
/// precision 47 and 41.
const POINTS: usize = 32;

/// Deformation of successive batches, kept until the law is asked, and its answers: in lanes, batch by
/// batch and point by point.
#[derive(Debug, Default)]
pub(super) struct Exchange<S> {
    /// Three modes of each node.
    modes: AlignedNumbers<S>,
    /// Six per point.
    strains: AlignedNumbers<S>,
    /// Six per point (Pa).
    stresses: AlignedNumbers<S>,
    /// Four per point (J/m3).
    energies: AlignedNumbers<S>,
    /// [`REMAINING`] per point.
    remaining: AlignedNumbers<S>,
}

/// Numbers of a [`RemainingStiffness`], in its order.
pub(super) const REMAINING: usize = 8;

impl<S: BatchScalar> Exchange<S> {
    /// Makes room for batches with so many nodes and points per element; yields for how many.
    #[inline(always)]
    pub(super) fn prepare(&mut self, nodes: usize, points: usize, width: usize) -> usize {
        let batches = (POINTS / points).max(1);
        self.modes.grow(3 * nodes * batches * width);
        self.strains.grow(6 * points * batches * width);
        self.stresses.grow(6 * points * batches * width);
        self.energies.grow(4 * points * batches * width);
        self.remaining.grow(REMAINING * points * batches * width);
        batches
    }
    /// Keeps modes and strains of a batch.
    #[inline(always)]
    pub(super) fn keep<L: BatchLane<Scalar = S>, const N: usize, const P: usize>(
        &mut self,
        token: L::Token,
        place: usize,
        modes: &[[L; 3]; N],
        strains: &[Strain<L>; P],
    ) {
        let range = numbers_of(place, 3 * N * L::WIDTH);
        let kept = as_lanes_mut::<L>(token, &mut self.modes.as_mut_slice()[range]);
        for (kept, modes) in kept.as_chunks_mut().0.iter_mut().zip(modes) {
            *kept = *modes;
        }
        let range = numbers_of(place, 6 * P * L::WIDTH);
        let kept = as_lanes_mut::<L>(token, &mut self.strains.as_mut_slice()[range]);
        for (kept, strain) in kept.as_chunks_mut().0.iter_mut().zip(strains) {
            *kept = strain.0;
        }
    }
    /// The modes of a batch.
    #[inline(always)]
    pub(super) fn modes<L: BatchLane<Scalar = S>, const N: usize>(
        &self,
        token: L::Token,
        place: usize,
    ) -> [[L; 3]; N] {
        let mut modes = [[L::splat(token, 0.0); 3]; N];
        let range = numbers_of(place, 3 * N * L::WIDTH);
        let kept = as_lanes::<L>(token, &self.modes.as_slice()[range]);
        for (modes, kept) in modes.iter_mut().zip(kept.as_chunks().0) {
            *modes = *kept;
        }
        modes
    }
    /// Strains of some points, and where stresses, energies and what is left of the stiffness go.
    pub(super) fn of_points(
        &mut self,
        points: usize,
        width: usize,
    ) -> (&[S], &mut [S], &mut [S], &mut [S]) {
        (
            &self.strains.as_slice()[..6 * points * width],
            &mut self.stresses.as_mut_slice()[..6 * points * width],
            &mut self.energies.as_mut_slice()[..4 * points * width],
            &mut self.remaining.as_mut_slice()[..REMAINING * points * width],
        )
    }
    /// What is left of the stiffness at the points of a batch; of what was not asked for nothing is said.
    #[inline(always)]
    pub(super) fn remaining<L: BatchLane<Scalar = S>, const P: usize>(
        &self,
        token: L::Token,
        place: usize,
    ) -> [RemainingStiffness<L>; P] {
        let one = L::splat(token, 1.0);
        let mut remaining = [RemainingStiffness {
            undamaged: one,
            of_path: one,
            flowed: [one; 6],
        }; P];
        let range = numbers_of(place, REMAINING * P * L::WIDTH);
        let answered = as_lanes::<L>(token, &self.remaining.as_slice()[range]);
        for (remaining, answered) in remaining
            .iter_mut()
            .zip(answered.as_chunks::<REMAINING>().0)
        {
            remaining.undamaged = answered[0];
            remaining.of_path = answered[1];
            remaining.flowed.copy_from_slice(&answered[2..8]);
        }
        remaining
    }
    /// Stresses at the points of a batch, and their energies if they were told.
    #[inline(always)]
    pub(super) fn answer<L: BatchLane<Scalar = S>, const P: usize>(
        &self,
        token: L::Token,
        place: usize,
        told: bool,
    ) -> ([Stress<L>; P], Option<[LawEnergy<L>; P]>) {
        let zero = L::splat(token, 0.0);
        let mut stresses = [Stress::zero(token); P];
        let range = numbers_of(place, 6 * P * L::WIDTH);
        let answered = as_lanes::<L>(token, &self.stresses.as_slice()[range]);
        for (stress, answered) in stresses.iter_mut().zip(answered.as_chunks().0) {
            *stress = Stress(*answered);
        }
        if !told {
            return (stresses, None);
        }
        let mut energies = [LawEnergy {
            stored: zero,
            plastic: zero,
            damage: zero,
            recovered: zero,
        }; P];
        let range = numbers_of(place, 4 * P * L::WIDTH);
        let answered = as_lanes::<L>(token, &self.energies.as_slice()[range]);
        for (energy, answered) in energies.iter_mut().zip(answered.as_chunks().0) {
            let [stored, plastic, damage, recovered] = *answered;
            *energy = LawEnergy {
                stored,
                plastic,
                damage,
                recovered,
            };
        }
        (stresses, Some(energies))
    }
}

/// The numbers of a batch, of so many each.
#[inline(always)]
fn numbers_of(place: usize, numbers: usize) -> Range<usize> {
    place * numbers..(place + 1) * numbers
}

/// An exchange in either scalar.
#[derive(Debug, Default)]
pub(super) struct Exchanges {
    pub(super) double: Exchange<f64>,
    pub(super) single: Exchange<f32>,
}
