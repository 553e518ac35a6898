//! Check of the sampling intervals of accelerations.

use powerhouse_observe::{Column, EnvelopeTable, HistoryTable};

use crate::Remark;
use crate::magnitude::rounded;

/// Number of samples before and after the peak that are evaluated.
const AROUND: usize = 8;
/// Threshold of the roughness: squares of differences between samples over squares of samples around the peak; 1 for
/// a sinusoid with six samples per period, 2 for noise.
const ROUGH: f64 = 1.0;
/// Least ratio of the greatest acceleration of every second sample to that of all samples for a sufficient sampling
/// interval: that of a sinusoid with seven samples per period.
const OF_ALTERNATE_LOOKS: f64 = 0.9;

/// Warnings about accelerations with too long sampling intervals.
pub(super) fn warnings(histories: &HistoryTable, envelope: Option<&EnvelopeTable>) -> Vec<Remark> {
    let mut warnings: Vec<Remark> = Vec::new();
    if let [first, .., last] = histories.times[..] {
        let interval = rounded((last - first) / (histories.times.len() - 1) as f64);
        let rough = |motion: &&[Column]| roughness(motion).is_some_and(|share| share > ROUGH);
        let motions = histories
            .columns
            .chunk_by(|a, b| motion_of(a) == motion_of(b));
        warnings.extend(motions.filter(rough).map(|motion| Remark::Undersampled {
            name: motion_of(&motion[0]).0.into(),
            interval,
        }));
    }
    let share = envelope.and_then(EnvelopeTable::share_of_alternate_samples);
    let sparse = share.filter(|share| *share < OF_ALTERNATE_LOOKS);
    warnings.extend(sparse.map(|share| Remark::SparseEnvelope { share }));
    warnings
}

/// Name of a column without its component, and its unit, which identify one motion.
fn motion_of(column: &Column) -> (&str, &str) {
    let name = column.name.rsplit_once('.');
    (name.map_or(&*column.name, |(name, _)| name), column.unit)
}

/// Roughness of an acceleration around its peak: squares of the differences between samples over squares of the
/// samples; `None` for another quantity, or without motion.
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

    /// The roughness of a sinusoid follows from its samples per period, whatever its direction; a spike of one sample is
    /// rough, a wide one is not.
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
