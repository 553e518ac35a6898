//! Strips of tiles of isolated pairs, which threads share. This is hot code.
//!
//! Strips are independent of each other and cut by the number of pairs alone, so that a pass has the same bits for any
//! number of threads.

use core::ops::Range;

use powerhouse_model::{ConstraintWork, ContactLaw, JointRecord, PredictedMotion, Vec3};
use rayon::prelude::*;

use super::history::PairHistories;
use super::isolated::{IsolatedPair, TILE, Tile, TileStep};

/// Number of pairs of a strip.
const STRIP: usize = 16 * TILE;

/// Number of pairs from which the strips of a pass are shared among threads: waking a thread takes as long as
/// some hundred pairs.
const MANY: usize = 4 * STRIP;

/// Consecutive tiles of one law, which a thread computes one after the other.
#[derive(Clone, Debug)]
pub(super) struct Strip {
    tiles: Vec<Tile>,
    /// Ranges of pairs and nodes of the joint in which those of its tiles are; they overlap with those of no other
    /// strip.
    pairs: Range<usize>,
    nodes: Range<usize>,
    /// Committed and new history variables of a tile.
    rows: [Vec<f64>; 2],
}

impl Strip {
    /// Strips of pairs in rising order, for a step (s), of a law with so many history variables.
    pub(super) fn all(pairs: &[IsolatedPair], step: f64, variables: usize) -> Vec<Self> {
        // Joints number their nodes in the order of the pairs, so that ranges of nodes rise with those of pairs.
        let strips = pairs.chunks(STRIP).map(|pairs| {
            let nodes = pairs.iter().flat_map(|pair| pair.nodes);
            let (first, last) = nodes.fold((u32::MAX, 0), |(first, last), node| {
                (first.min(node), last.max(node))
            });
            let bounds = [pairs.first(), pairs.last()].map(|p| p.map_or(0, |p| p.index as usize));
            Self {
                tiles: (pairs.chunks(TILE).map(|pairs| Tile::new(pairs, step))).collect(),
                pairs: bounds[0]..bounds[1] + 1,
                nodes: first as usize..last as usize + 1,
                rows: [0, 1].map(|_| vec![0.0; TILE * variables]),
            }
        });
        strips.collect()
    }

    /// Corrects the motion of its pairs.
    fn correct<L: ContactLaw>(
        &mut self,
        law: &L,
        variables: usize,
        windows: Windows,
        motion: &Step,
    ) {
        // Wider instructions where the processor has them; they change no bit. Laws without history have
        // a pass of their own, which is spared that of the others.
        if variables == 0 {
            pulp::Arch::new().dispatch(Pass::<L, false> {
                law,
                tiles: &self.tiles,
                rows: &mut self.rows,
                windows,
                motion,
            })
        } else {
            pulp::Arch::new().dispatch(Pass::<L, true> {
                law,
                tiles: &self.tiles,
                rows: &mut self.rows,
                windows,
                motion,
            })
        }
    }
}

/// Part of a list from an index on.
pub(super) struct Window<'a, T> {
    first: usize,
    values: &'a mut [T],
}

impl<'a, T> Window<'a, T> {
    #[inline(always)]
    pub(super) fn at(&mut self, index: usize) -> &mut T {
        &mut self.values[index - self.first]
    }
    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> &T {
        &self.values[index - self.first]
    }
    /// Cuts off the part in a range, and what precedes it.
    fn take(&mut self, range: &Range<usize>) -> Window<'a, T> {
        let values = core::mem::take(&mut self.values);
        let (_, from) = values.split_at_mut(range.start - self.first);
        let (own, rest) = from.split_at_mut(range.len());
        (self.first, self.values) = (range.end, rest);
        Window {
            first: range.start,
            values: own,
        }
    }
}

/// Parts of the lists of a joint that a strip changes.
pub(super) struct Windows<'a> {
    pub(super) records: Window<'a, JointRecord>,
    pub(super) work: Window<'a, ConstraintWork>,
    pub(super) velocity: Window<'a, Vec3>,
    pub(super) history: PairHistories<'a>,
}

/// Input of a step that all strips share.
pub(super) struct Step<'a> {
    pub(super) time: f64,
    pub(super) step: f64,
    pub(super) displacement: &'a [Vec3],
    pub(super) previous: &'a [Vec3],
}

/// Corrects the motion of isolated pairs, and sets the work of their forces.
///
/// The stick trial is the traction that ends a step without overlap and without slip,
/// `T = T0 + (w + g / dt) / (dt W A)` with `W = 1/a_i + 1/a_j` (Wang, Chen & Xiao 2019, Eq. 20, for
/// velocities half a step apart and effective masses `a`). The law reduces it to what is admissible.
pub(super) fn correct<L: ContactLaw>(
    law: &L,
    strips: &mut [Strip],
    (records, work): (&mut [JointRecord], &mut [ConstraintWork]),
    history: PairHistories,
    motion: &mut PredictedMotion,
) {
    let variables = history.variables;
    let mut rest = Windows {
        records: Window {
            first: 0,
            values: records,
        },
        work: Window {
            first: 0,
            values: work,
        },
        velocity: Window {
            first: 0,
            values: motion.velocity,
        },
        history,
    };
    let step = Step {
        time: motion.time,
        step: motion.step,
        displacement: motion.displacement,
        previous: motion.previous,
    };
    let in_windows = strips.iter_mut().map(|strip| {
        let windows = Windows {
            records: rest.records.take(&strip.pairs),
            work: rest.work.take(&strip.pairs),
            velocity: rest.velocity.take(&strip.nodes),
            history: rest.history.take(&strip.pairs),
        };
        (strip, windows)
    });
    let compute =
        |(strip, windows): (&mut Strip, Windows)| strip.correct(law, variables, windows, &step);
    if in_windows.len() * STRIP >= MANY && rayon::current_num_threads() > 1 {
        let in_windows: Vec<_> = in_windows.collect();
        in_windows.into_par_iter().for_each(compute);
    } else {
        in_windows.for_each(compute);
    }
}

/// Pass over the tiles of a law with or without history. A type of its own, since a closure passed to
/// the dispatch may end up in a function that is not compiled for the processor at hand.
struct Pass<'a, L, const HISTORY: bool> {
    law: &'a L,
    tiles: &'a [Tile],
    rows: &'a mut [Vec<f64>; 2],
    windows: Windows<'a>,
    motion: &'a Step<'a>,
}

impl<L: ContactLaw, const HISTORY: bool> pulp::NullaryFnOnce for Pass<'_, L, HISTORY> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self {
            law,
            tiles,
            rows,
            mut windows,
            motion,
        } = self;
        let mut step = TileStep::default();
        for tile in tiles {
            tile.predict::<HISTORY>(&mut step, &windows, motion);
            if HISTORY {
                windows.history.gather(tile.pairs(), rows);
            }
            let variables = if HISTORY {
                windows.history.variables
            } else {
                0
            };
            tile.admit(law, &mut step, motion, (variables, rows));
            if HISTORY {
                windows.history.scatter(tile.pairs(), &rows[1]);
            }
            tile.correct(&mut step, motion, &mut windows.velocity);
            let Windows { records, work, .. } = &mut windows;
            tile.update::<L, HISTORY>((law, &step), records, motion, (variables, rows), work);
        }
    }
}
