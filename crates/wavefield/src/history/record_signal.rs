//! Records that end at rest, as the signals of waves.

use super::{Node, RecordReport, TimeHistory};
use crate::{Signal, SignalMotion, SignalSupport, WaveError};

/// Declared displacement of the ground at the end of a record.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum EndDisplacement {
    /// No permanent displacement.
    #[default]
    Zero,
    /// Permanent displacement of this value (m).
    Declared(f64),
}

/// Record that ends at rest at a declared displacement, as the signal of a wave.
///
/// After the last sample a closing segment of 5 % of the duration (three steps at least) is added:
/// the acceleration, linear between the thirds of that time, goes to zero and removes the rest of the
/// velocity and of the difference from the declared displacement, both within 1 % of their peaks.
/// After that the displacement is exactly the declared one.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordSignal {
    history: TimeHistory,
    report: RecordReport,
    end: f64,
    /// Nodes of the history, between one at rest before them and the last, which is at rest too.
    table: Vec<Node>,
}

impl TimeHistory {
    /// Record as the signal of a wave, if its end velocity and end displacement permit it.
    ///
    /// # Errors
    /// [`WaveError::EndVelocity`] if the end velocity is above 1 % of the peak velocity;
    /// [`WaveError::EndDisplacement`] if the end displacement differs from the declared one by
    /// more than 1 % of the peak displacement. The displacement acts on the springs of a boundary,
    /// where either would cause drift.
    pub fn into_signal(self, end: EndDisplacement) -> Result<RecordSignal, WaveError> {
        const PERMITTED_SHARE: f64 = 0.01;
        let report = self.report();
        let declared = match end {
            EndDisplacement::Zero => 0.0,
            EndDisplacement::Declared(value) => value,
        };
        let limit = PERMITTED_SHARE * report.peak_velocity;
        if report.end_velocity.abs() > limit {
            return Err(WaveError::EndVelocity {
                velocity: report.end_velocity,
                limit,
            });
        }
        let limit = PERMITTED_SHARE * report.peak_displacement;
        let difference = declared - report.end_displacement;
        if difference.is_nan() || difference.abs() > limit {
            return Err(WaveError::EndDisplacement {
                displacement: report.end_displacement,
                declared,
                limit,
            });
        }
        let samples = self.acceleration();
        let step = self.step();
        let third = (samples.len() - 1).div_ceil(60);
        let samples = closing_segment(samples, step, third, report.end_velocity, difference);
        let mut history = Self::new(step, samples)?;
        // Rounding errors of the end values are removed from the last sample.
        if let Some(last) = history.nodes.last_mut() {
            last.displacement = declared;
            last.velocity = 0.0;
        }
        let at_rest = Node {
            displacement: 0.0,
            velocity: 0.0,
            acceleration: 0.0,
            slope: 0.0,
        };
        let mut table = vec![at_rest];
        table.extend(&history.nodes);
        if let Some(last) = table.last_mut() {
            *last = Node {
                displacement: declared,
                ..at_rest
            };
        }
        Ok(RecordSignal {
            end: history.duration(),
            table,
            history,
            report,
        })
    }
}

/// Appends three segments of `third` steps after which acceleration and velocity are zero and
/// the displacement has grown by `distance`.
///
/// With the accelerations a, p, q, 0 at the ends of segments of length h:
/// `v + h (a/2 + p + q) = 0` and `3 h v + h^2 (4 a/3 + 2 p + q) = distance`, since a hat of area
/// h centred at time s adds h (3 h - s) to the displacement, and half a hat at zero h/2 (3 h - h/3).
fn closing_segment(
    mut samples: Vec<f64>,
    step: f64,
    third: usize,
    velocity: f64,
    distance: f64,
) -> Vec<f64> {
    let a = samples.last().copied().unwrap_or(0.0);
    let h = third as f64 * step;
    let sum = -velocity / h - 0.5 * a;
    let p = (distance - 3.0 * h * velocity) / (h * h) - 4.0 / 3.0 * a - sum;
    let q = sum - p;
    let knots = [a, p, q, 0.0];
    for pair in knots.windows(2) {
        for i in 1..=third {
            let part = i as f64 / third as f64;
            samples.push(pair[0] + part * (pair[1] - pair[0]));
        }
    }
    samples
}

impl RecordSignal {
    /// Peak and end values of the record without its closing segment.
    pub fn report(&self) -> RecordReport {
        self.report
    }
    /// Time history with the closing segment.
    pub fn history(&self) -> &TimeHistory {
        &self.history
    }
}

impl Signal for RecordSignal {
    #[inline]
    fn motion(&self, time: f64) -> SignalMotion {
        self.history.motion(time)
    }
    /// Branch-free form: times outside the table map to its nodes at rest.
    #[inline]
    fn sample(&self, times: &[f64], displacement: &mut [f64], velocity: &mut [f64]) {
        /// Added to a number below 2^31, it leaves the rounded integer in the lowest bits.
        const ROUNDING: f64 = (1u64 << 52) as f64;
        let last = self.table.len() - 1;
        let (step, per_step) = (self.history.step, self.history.per_step);
        let outputs = displacement.iter_mut().zip(velocity);
        for (time, (displacement, velocity)) in times.iter().zip(outputs) {
            // The first node is one step before time zero; a number that is none counts as that.
            let position = (time * per_step + 1.0).max(0.0).min(last as f64);
            let rounded = (position - 0.5).max(0.0) + ROUNDING;
            let index = (rounded.to_bits() as u32) as usize;
            let local = (position - (rounded - ROUNDING)) * step;
            let motion = self.table[index.min(last)].motion(local);
            *displacement = motion.displacement;
            *velocity = motion.velocity;
        }
    }
    /// Interval of the record and its closing segment, at a quarter of the record's step.
    fn support(&self) -> SignalSupport {
        SignalSupport {
            start: 0.0,
            end: self.end,
            step: 0.25 * self.history.step(),
        }
    }
}
