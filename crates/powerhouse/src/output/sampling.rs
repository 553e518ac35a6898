//! Whether accelerations were recorded often enough.

use powerhouse_explicit_core::observe::{Column, EnvelopeTable, HistoryTable};

use crate::Remark;
use crate::magnitude::rounded;

/// Samples before and behind the peak that are looked at.
const AROUND: usize = 8;
/// Squares of differences from sample to sample over squares of samples, around the peak: 1 for a sinusoid of
/// six samples a period, 2 for noise.
const ROUGH: f64 = 1.0;
/// What every second look of an envelope finds of its greatest acceleration at least if it looks often enough:
/// that of a sinusoid of seven looks a period.
const OF_ALTERNATE_LOOKS: f64 = 0.9;

/// Doubts about accelerations that vary faster than they were recorded.
pub(super) fn doubts(histories: &HistoryTable, envelope: Option<&EnvelopeTable>) -> Vec<Remark> {
    let mut doubts: Vec<Remark> = Vec::new();
    if let [first, .., last] = histories.times[..] {
        let interval = rounded((last - first) / (histories.times.len() - 1) as f64);
        let rough = |motion: &&[Column]| roughness(motion).is_some_and(|share| share > ROUGH);
        let motions = histories
            .columns
            .chunk_by(|a, b| place_of(a) == place_of(b));
        doubts.extend(motions.filter(rough).map(|motion| Remark::Undersampled {
            name: place_of(&motion[0]).0.into(),
            interval,
        }));
    }
    let share = envelope.and_then(EnvelopeTable::share_of_alternate_samples);
    let rare = share.filter(|share| *share < OF_ALTERNATE_LOOKS);
    doubts.extend(rare.map(|share| Remark::RareLooks { share }));
    doubts
}

/// The name of a column without its component, and its unit: those of one motion share both.
fn place_of(column: &Column) -> (&str, &str) {
    let name = column.name.rsplit_once('.');
    (name.map_or(&*column.name, |(name, _)| name), column.unit)
}

/// Squares of the differences from sample to sample over squares of the samples of an acceleration around its
/// peak; none for another quantity, or without motion.
fn roughness(motion: &[Column]) -> Option<f64> {
    if motion[0].unit != "m/s2" {
        return None;
    }
    let square = |sample: usize, before: Option<usize>| -> f64 {
        let change = |column: &Column| {
            let old = before.map_or(0.0, |before| column.values[before]);
            (column.values[sample] - old).powi(2)
        };
        motion.iter().map(change).sum()
    };
    let count = motion[0].values.len();
    let peak = (0..count).max_by(|a, b| square(*a, None).total_cmp(&square(*b, None)))?;
    let (first, last) = (peak.saturating_sub(AROUND), (peak + AROUND).min(count - 1));
    let size: f64 = (first..=last).map(|sample| square(sample, None)).sum();
    let changes = (first + 1..=last).map(|sample| square(sample, Some(sample - 1)));
    (size > 0.0 && last > first).then(|| changes.sum::<f64>() / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The roughness of a sinusoid is that of its samples per period, whatever its direction; a lone spike is
    /// rough, one that lasts is not.
    #[test]
    fn roughness_is_that_of_samples_per_period() {
        let column = |name: &str, value: &dyn Fn(usize) -> f64| Column {
            name: name.into(),
            unit: "m/s2",
            values: (0..200).map(value).collect(),
        };
        for (samples, rough) in [(3.0, true), (5.0, true), (7.0, false), (40.0, false)] {
            let wave = |i: usize| (core::f64::consts::TAU * i as f64 / samples + 0.3).sin();
            let motion = [
                column("a.ax", &|i| 0.6 * wave(i)),
                column("a.ay", &|_| 0.0),
                column("a.az", &|i| -0.8 * wave(i)),
            ];
            let found = roughness(&motion).unwrap();
            let expected = 4.0 * (core::f64::consts::PI / samples).sin().powi(2);
            assert!((found / expected - 1.0).abs() < 0.15, "{samples}: {found}");
            assert_eq!(found > ROUGH, rough, "{samples}");
        }
        let spike = |width: f64| {
            let motion = [column("a.ax", &|i| {
                (-((i as f64 - 90.0) / width).powi(2)).exp()
            })];
            roughness(&motion).unwrap()
        };
        assert!(spike(0.3) > ROUGH && spike(4.0) < ROUGH);
        assert_eq!(roughness(&[column("a.ax", &|_| 0.0)]), None);
    }
}
