//! Buffers between kernels and laws.

use core::ops::Range;

use powerhouse_model::{LawEnergy, RemainingStiffness, Strain, Stress};

use super::memory::{as_lanes, as_lanes_mut};
use super::numbers::AlignedNumbers;
use super::own::MOST_OWN;
use crate::lanes::{BatchLane, BatchScalar};

/// Number of integration points of successive batches for which a law is evaluated in one call.
///
/// A call has a cost, and history variables that are read and written in long rows arrive sooner: with flat
/// damping by three mechanisms a step of 110,592 elements takes 58 ns per element with 4 points per call
/// and 52 with 32, in mixed precision 47 and 41.
pub(super) const POINTS: usize = 32;

/// Buffers of the strains of successive batches, and of the stresses and energies of their law, in lanes,
/// batch by batch and point by point.
#[derive(Debug, Default)]
pub(super) struct Exchange<S> {
    /// Three modal displacements of each node.
    modes: AlignedNumbers<S>,
    /// Own history of each element, with which its step began.
    own: AlignedNumbers<S>,
    /// Six strains per point.
    strains: AlignedNumbers<S>,
    /// Six stresses per point (Pa).
    stresses: AlignedNumbers<S>,
    /// Four energies per point (J/m3).
    energies: AlignedNumbers<S>,
    /// [`REMAINING`] numbers of the remaining stiffness per point.
    remaining: AlignedNumbers<S>,
}

/// Buffers of a number of integration points: strains as input of a law, the others as its output.
pub(super) struct PointBuffers<'a, S> {
    pub(super) strains: &'a [S],
    pub(super) stresses: &'a mut [S],
    pub(super) energies: &'a mut [S],
    pub(super) remaining: &'a mut [S],
}

/// Number of the numbers of a [`RemainingStiffness`], in its order.
pub(super) const REMAINING: usize = 8;

impl<S: BatchScalar> Exchange<S> {
    /// Makes room for batches with a number of nodes and points per element, of so many points at once; returns the number
    /// of batches.
    #[inline(always)]
    pub(super) fn prepare(
        &mut self,
        (nodes, points): (usize, usize),
        width: usize,
        at_once: usize,
    ) -> usize {
        let batches = (at_once / points).max(1);
        self.modes.grow(3 * nodes * batches * width);
        self.own.grow(MOST_OWN * batches * width);
        self.strains.grow(6 * points * batches * width);
        self.stresses.grow(6 * points * batches * width);
        self.energies.grow(4 * points * batches * width);
        self.remaining.grow(REMAINING * points * batches * width);
        batches
    }
    /// Stores modal displacements and strains of a batch.
    #[inline(always)]
    pub(super) fn store<L: BatchLane<Scalar = S>, const N: usize, const P: usize>(
        &mut self,
        token: L::Token,
        batch: usize,
        modes: &[[L; 3]; N],
        strains: &[Strain<L>; P],
    ) {
        let range = numbers_of(batch, 3 * N * L::WIDTH);
        let stored = as_lanes_mut::<L>(token, &mut self.modes.as_mut_slice()[range]);
        for (stored, modes) in stored.as_chunks_mut().0.iter_mut().zip(modes) {
            *stored = *modes;
        }
        let range = numbers_of(batch, 6 * P * L::WIDTH);
        let stored = as_lanes_mut::<L>(token, &mut self.strains.as_mut_slice()[range]);
        for (stored, strain) in stored.as_chunks_mut().0.iter_mut().zip(strains) {
            *stored = strain.0;
        }
    }
    /// Stores the own history of a batch with which its step began.
    #[inline(always)]
    pub(super) fn store_own<L: BatchLane<Scalar = S>>(
        &mut self,
        token: L::Token,
        batch: usize,
        own: &[L; MOST_OWN],
    ) {
        let range = numbers_of(batch, MOST_OWN * L::WIDTH);
        as_lanes_mut::<L>(token, &mut self.own.as_mut_slice()[range]).copy_from_slice(own);
    }
    /// Own history of a batch with which its step began.
    #[inline(always)]
    pub(super) fn own<L: BatchLane<Scalar = S>>(
        &self,
        token: L::Token,
        batch: usize,
    ) -> [L; MOST_OWN] {
        let mut own = [L::splat(token, 0.0); MOST_OWN];
        let range = numbers_of(batch, MOST_OWN * L::WIDTH);
        own.copy_from_slice(as_lanes::<L>(token, &self.own.as_slice()[range]));
        own
    }
    /// Modal displacements of a batch.
    #[inline(always)]
    pub(super) fn modes<L: BatchLane<Scalar = S>, const N: usize>(
        &self,
        token: L::Token,
        batch: usize,
    ) -> [[L; 3]; N] {
        let mut modes = [[L::splat(token, 0.0); 3]; N];
        let range = numbers_of(batch, 3 * N * L::WIDTH);
        let stored = as_lanes::<L>(token, &self.modes.as_slice()[range]);
        for (modes, stored) in modes.iter_mut().zip(stored.as_chunks().0) {
            *modes = *stored;
        }
        modes
    }
    /// The buffers of a number of points.
    pub(super) fn of_points(&mut self, points: usize, width: usize) -> PointBuffers<'_, S> {
        PointBuffers {
            strains: &self.strains.as_slice()[..6 * points * width],
            stresses: &mut self.stresses.as_mut_slice()[..6 * points * width],
            energies: &mut self.energies.as_mut_slice()[..4 * points * width],
            remaining: &mut self.remaining.as_mut_slice()[..REMAINING * points * width],
        }
    }
    /// Remaining stiffness at the points of a batch; numbers that were not required are arbitrary.
    #[inline(always)]
    pub(super) fn remaining<L: BatchLane<Scalar = S>, const P: usize>(
        &self,
        token: L::Token,
        batch: usize,
    ) -> [RemainingStiffness<L>; P] {
        let mut remaining = [RemainingStiffness::whole(L::splat(token, 1.0)); P];
        let range = numbers_of(batch, REMAINING * P * L::WIDTH);
        let stored = as_lanes::<L>(token, &self.remaining.as_slice()[range]);
        for (remaining, stored) in remaining.iter_mut().zip(stored.as_chunks::<REMAINING>().0) {
            remaining.undamaged = stored[0];
            remaining.hourglass = stored[1];
            (remaining.plastic_strain_increment).copy_from_slice(&stored[2..8]);
        }
        remaining
    }
    /// Stresses at the points of a batch, and energies if the law has them.
    #[inline(always)]
    pub(super) fn response<L: BatchLane<Scalar = S>, const P: usize>(
        &self,
        token: L::Token,
        batch: usize,
        has_energies: bool,
    ) -> ([Stress<L>; P], Option<[LawEnergy<L>; P]>) {
        let zero = L::splat(token, 0.0);
        let mut stresses = [Stress::zero(token); P];
        let range = numbers_of(batch, 6 * P * L::WIDTH);
        let stored = as_lanes::<L>(token, &self.stresses.as_slice()[range]);
        for (stress, stored) in stresses.iter_mut().zip(stored.as_chunks().0) {
            *stress = Stress(*stored);
        }
        if !has_energies {
            return (stresses, None);
        }
        let mut energies = [LawEnergy::stored(zero); P];
        let range = numbers_of(batch, 4 * P * L::WIDTH);
        let stored = as_lanes::<L>(token, &self.energies.as_slice()[range]);
        for (energy, numbers) in energies.iter_mut().zip(stored.as_chunks().0) {
            let [stored, plastic, damage, recovered] = *numbers;
            *energy = LawEnergy::stored(stored)
                .with_plastic(plastic)
                .with_damage(damage)
                .with_recovered(recovered);
        }
        (stresses, Some(energies))
    }
}

/// Range of the numbers of a batch, given how many each batch has.
#[inline(always)]
fn numbers_of(batch: usize, numbers: usize) -> Range<usize> {
    batch * numbers..(batch + 1) * numbers
}

/// Exchange buffers in both scalar types.
#[derive(Debug, Default)]
pub(super) struct Exchanges {
    pub(super) double: Exchange<f64>,
    pub(super) single: Exchange<f32>,
}
