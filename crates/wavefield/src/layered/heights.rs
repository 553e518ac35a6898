//! Heights with tables, between which the motion of many points is interpolated.

use super::ground::Ground;
use super::tables::{LayeredTables, Table};
use crate::WaveError;

/// Most heights of the points of one sampler that have a table each.
pub(crate) const MOST_HEIGHTS: usize = 1000;
/// Permitted errors of displacement, velocity and stress, over their peaks, at twice the final distance between heights, where
/// they are measured: sixteen times those at the final one.
const PERMITTED: [f64; 3] = [1e-4, 1e-3, 1e-3];
/// Intervals of a layer at first, and at most.
const FIRST: usize = 4;
const MOST: usize = 1 << 12;
/// Samples of a table from one comparison to the next.
const STRIDE: usize = 3;
/// Points of the interpolating polynomial.
const POINTS: usize = 4;

/// Heights with tables in each layer, from its top downwards, that follow the motion by cubics.
#[derive(Debug)]
pub(crate) struct Heights {
    /// Keys of the heights of each layer and of the half-space.
    layers: Vec<Vec<i64>>,
    /// Largest errors of displacement, velocity and stress over their peaks, measured at twice the distance (1).
    pub(crate) errors: [f64; 3],
}

impl Heights {
    /// Heights down to the lowest, divided until cubics between every other one meet those between them.
    pub(crate) fn new(
        tables: &LayeredTables,
        ground: &Ground,
        lowest: f64,
    ) -> Result<Self, WaveError> {
        let mut layers = Vec::new();
        let mut worst = [0.0_f64; 3];
        for index in 0..=ground.layers().len() {
            let [top, bottom] = ground.extent(index);
            let (top, bottom) = (tables.key(top), tables.key(bottom.max(lowest)));
            if bottom - top < 2 * FIRST as i64 {
                // Below the lowest height, or as thin as the rounding of heights.
                layers.push(Vec::new());
                continue;
            }
            let mut intervals = FIRST;
            let errors = loop {
                let coarse = uniform(top, bottom, intervals);
                let fine = uniform(top, bottom, 2 * intervals);
                tables.make(fine.iter().copied(), [])?;
                let mut errors = [0.0_f64; 3];
                for middle in fine.iter().skip(1).step_by(2) {
                    let found = missed(tables, &coarse, *middle)?;
                    for (error, found) in errors.iter_mut().zip(found) {
                        *error = error.max(found);
                    }
                }
                let is_met = errors.iter().zip(PERMITTED).all(|(e, most)| *e <= most);
                if is_met {
                    layers.push(fine);
                    break errors;
                }
                intervals *= 2;
                if intervals > MOST {
                    return Err(tables.too_large(2 * intervals));
                }
            };
            for (worst, error) in worst.iter_mut().zip(errors) {
                *worst = worst.max(error);
            }
        }
        Ok(Self {
            layers,
            errors: worst,
        })
    }

    /// Number of heights.
    pub(crate) fn count(&self) -> usize {
        self.layers.iter().map(Vec::len).sum()
    }

    /// Keys and weights of the tables for a depth in a layer, in units of keys.
    pub(crate) fn around(&self, layer: usize, depth: f64) -> [(i64, f64); POINTS] {
        // At the lowest height a layer may have no extent.
        let upwards = self.layers[..=layer].iter().rev();
        let mut known = upwards.chain(&self.layers).filter(|keys| !keys.is_empty());
        weights(known.next().expect("a layer with heights"), depth)
    }
}

/// Keys at equal distances.
fn uniform(top: i64, bottom: i64, intervals: usize) -> Vec<i64> {
    let length = (bottom - top) as f64;
    let keys = 0..=intervals;
    keys.map(|i| top + (length * i as f64 / intervals as f64).round() as i64)
        .collect()
}

/// The four keys around a depth, with the weights of Lagrange.
fn weights(keys: &[i64], depth: f64) -> [(i64, f64); POINTS] {
    let after = keys.partition_point(|key| (*key as f64) <= depth);
    let first = after.saturating_sub(POINTS / 2).min(keys.len() - POINTS);
    let own = &keys[first..first + POINTS];
    core::array::from_fn(|i| {
        let others = own.iter().enumerate().filter(|(j, _)| *j != i);
        let weight = others.fold(1.0, |weight, (_, key)| {
            weight * (depth - *key as f64) / (own[i] - key) as f64
        });
        (own[i], weight)
    })
}

/// Errors of displacement, velocity and stress at a key, interpolated between the tables of others, over their peaks.
fn missed(tables: &LayeredTables, keys: &[i64], key: i64) -> Result<[f64; 3], WaveError> {
    let exact = tables.at(key)?;
    let mut others = Vec::with_capacity(POINTS);
    for (other, weight) in weights(keys, key as f64) {
        // The time of a table is that after the incident wave passes its height.
        let later = tables.advance(other) - tables.advance(key);
        others.push((tables.at(other)?, weight, later));
    }
    let n = tables.stack.order;
    let mut worst = [0.0_f64; 3];
    for sample in (0..exact.samples(n)).step_by(STRIDE) {
        let time = exact.start + sample as f64 / exact.per_step;
        let of = |table: &Table, time: f64| table.state(n, time);
        let (Some(own), Some(mixed)) = (
            of(&exact, time),
            others
                .iter()
                .try_fold([0.0; 6], |sum: [f64; 6], (table, weight, later)| {
                    let state = of(table, time + later)?;
                    Some(core::array::from_fn(|k| sum[k] + weight * state[k]))
                }),
        ) else {
            continue;
        };
        for k in 0..6 {
            worst[k / 2] = worst[k / 2].max((own[k] - mixed[k]).abs());
        }
    }
    Ok(core::array::from_fn(|k| {
        if tables.peaks[k] > 0.0 {
            worst[k] / tables.peaks[k]
        } else {
            0.0
        }
    }))
}
