//! Check of the sampling intervals of accelerations.

use powerhouse_observe::{Column, EnvelopeTable, HistoryTable};

use crate::magnitude::rounded;
use crate::{Remark, remark};

/// Threshold of [`Column::roughness`]: that of a sinusoid with six samples per period.
const ROUGH: f64 = 1.0;
/// Greatest acceleration of a body at rest (m/s2), a ten-millionth of gravity: what moves it is rounding, which is rough
/// whatever the interval.
const REST: f64 = 1e-6;
/// Least share of the greatest sample of an acceleration in its peak.
const OF_PEAK: f64 = 0.95;
/// Rows of band-limited accelerations to a period of the band.
const ROWS_OF_BAND: f64 = 5.0;
/// Least ratio of the greatest acceleration of every second sample to that of all samples for a sufficient sampling
/// interval: that of a sinusoid with seven samples per period.
const OF_ALTERNATE_LOOKS: f64 = 0.9;

/// Warnings about accelerations with too long sampling intervals: of histories, and of those of a band, if there are any.
pub(super) fn warnings(
    histories: &HistoryTable,
    of_band: &HistoryTable,
    envelope: Option<&EnvelopeTable>,
) -> Vec<Remark> {
    let mut warnings: Vec<Remark> = Vec::new();
    let interval = |table: &HistoryTable| match table.times[..] {
        [first, .., last] => Some((last - first) / (table.times.len() - 1) as f64),
        _ => None,
    };
    if let Some(interval_of_rows) = interval(histories) {
        let band = interval(of_band).map(|interval| rounded(1.0 / (ROWS_OF_BAND * interval)));
        let rough = |motion: &&[Column]| {
            let roughness = Column::roughness(motion).filter(|_| motion[0].unit == "m/s2");
            let peak = |column: &Column| match of_band.column(&column.name) {
                Some(limited) => limited.peak(&of_band.times),
                None => column.peak(&histories.times),
            };
            let (sampled, greatest) = peaks_of(motion, peak);
            greatest > REST
                && roughness
                    .is_some_and(|roughness| roughness > ROUGH || sampled / greatest < OF_PEAK)
        };
        let motions = histories
            .columns
            .chunk_by(|a, b| motion_of(a) == motion_of(b));
        warnings.extend(motions.filter(rough).map(|motion| {
            Remark::from(remark::Undersampled {
                name: motion_of(&motion[0]).0.into(),
                interval: rounded(interval_of_rows),
                band: band.filter(|_| of_band.column(&motion[0].name).is_some()),
            })
        }));
    }
    let share = envelope.and_then(EnvelopeTable::share_of_alternate_samples);
    let sparse = share.filter(|share| *share < OF_ALTERNATE_LOOKS);
    warnings.extend(sparse.map(|share| Remark::from(remark::SparseEnvelope { share })));
    warnings
}

/// Greatest sample of the components of a motion, and their greatest peak.
fn peaks_of(motion: &[Column], peak: impl Fn(&Column) -> Option<(f64, f64)>) -> (f64, f64) {
    let greatest = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(0.0_f64, |most, value| most.max(value.abs()))
    };
    let sampled = greatest(
        &mut motion
            .iter()
            .flat_map(|column| column.values.iter().copied()),
    );
    let peaks = motion.iter().filter_map(peak);
    (sampled, greatest(&mut peaks.map(|(peak, _)| peak)))
}

/// Name of a column without its component, and its unit, which identify one motion.
fn motion_of(column: &Column) -> (&str, &str) {
    let name = column.name.rsplit_once('.');
    (name.map_or(&*column.name, |(name, _)| name), column.unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples that turn at each row are warned of in every unit of a motion, down to a millionth of gravity; what rounding makes
    /// of a body at rest is not.
    #[test]
    fn rounding_is_no_motion() {
        let warned = |amplitude: f64| {
            let times: Vec<f64> = (0..50).map(|row| 0.01 * f64::from(row)).collect();
            let turning = |row: usize| amplitude * (1.0 - 2.0 * (row % 2) as f64);
            let column = Column::new("crown.ax", "m/s2", (0..50).map(turning).collect());
            let histories = HistoryTable::new(times, vec![column]);
            let none = HistoryTable::new(Vec::new(), Vec::new());
            !warnings(&histories, &none, None).is_empty()
        };
        for amplitude in [9.81e-6, 1e-3, 30.0] {
            assert!(warned(amplitude), "{amplitude}");
        }
        for amplitude in [1e-7, 1e-13] {
            assert!(!warned(amplitude), "{amplitude}");
        }
    }
}
