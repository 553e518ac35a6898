//! Records that come to rest, and may therefore drive a wave.

use super::{Node, RecordReport, TimeHistory};
use crate::{Signal, SignalMotion, Support, WaveError};

/// Where a record leaves the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum EndDisplacement {
    /// Where it was.
    #[default]
    Zero,
    /// Displaced for good by this much (m).
    Declared(f64),
}

/// A record that ends at rest at a declared displacement: the signal of a wave.
///
/// After the last sample the record runs down over 5 % of its duration (three steps at least):
/// the acceleration, linear between the thirds of that time, goes to zero and takes with it what is
/// left of velocity and of the difference from the declared displacement, both within 1 % of
/// their peaks. From then on displacement is exactly the declared one.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordSignal {
    history: TimeHistory,
    report: RecordReport,
    end: f64,
    /// The history's nodes between one at rest before them and the last, which is at rest too.
    table: Vec<Node>,
}

impl TimeHistory {
    /// The record as a signal, if it comes to rest.
    ///
    /// # Errors
    /// [`WaveError::EndVelocity`] if the end velocity is above 1 % of the peak velocity;
    /// [`WaveError::EndDisplacement`] if the end displacement differs from the declared one by
    /// more than 1 % of the peak displacement. The displacement enters the springs of a boundary,
    /// so neither can be let pass.
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
        let samples = run_down(samples, step, third, report.end_velocity, difference);
        let mut history = Self::new(step, samples)?;
        // What rounding leaves of the rest is taken off its last sample.
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

/// Appends three stretches of `third` steps after which acceleration and velocity are zero and
/// the displacement has grown by `distance`.
///
/// With the accelerations a, p, q, 0 at the ends of stretches of length h:
/// `v + h (a/2 + p + q) = 0` and `3 h v + h^2 (4 a/3 + 2 p + q) = distance`, since a hat of area
/// h centred at time s adds h (3 h - s) to the displacement, and half a hat at zero h/2 (3 h - h/3).
fn run_down(
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
    /// Peaks and end values of the record before its run-down.
    pub fn report(&self) -> RecordReport {
        self.report
    }
    /// The record with its run-down.
    pub fn history(&self) -> &TimeHistory {
        &self.history
    }
}

impl Signal for RecordSignal {
    #[inline]
    fn motion(&self, time: f64) -> SignalMotion {
        self.history.motion(time)
    }
    /// Without a branch: times outside fall on the nodes at rest, whatever their distance from them.
    #[inline]
    fn sample(&self, times: &[f64], displacement: &mut [f64], velocity: &mut [f64]) {
        /// Added to a number below 2^31, leaves it rounded in the lowest bits.
        const ROUNDING: f64 = (1u64 << 52) as f64;
        let last = self.table.len() - 1;
        let (step, per_step) = (self.history.step, self.history.per_step);
        let outputs = displacement.iter_mut().zip(velocity);
        for (time, (displacement, velocity)) in times.iter().zip(outputs) {
            // The first node is one step before time zero; a number that is none counts as that.
            let place = (time * per_step + 1.0).max(0.0).min(last as f64);
            let rounded = (place - 0.5).max(0.0) + ROUNDING;
            let index = (rounded.to_bits() as u32) as usize;
            let local = (place - (rounded - ROUNDING)) * step;
            let motion = self.table[index.min(last)].motion(local);
            *displacement = motion.displacement;
            *velocity = motion.velocity;
        }
    }
    /// Four steps of the table to a step of the record.
    fn support(&self) -> Support {
        Support {
            start: 0.0,
            end: self.end,
            step: 0.25 * self.history.step(),
        }
    }
}
