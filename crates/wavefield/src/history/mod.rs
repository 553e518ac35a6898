//! Recorded motion: uniformly sampled acceleration with its exact integrals.

mod baseline;
mod edit;
mod record_signal;

pub use baseline::{BaselineCorrection, BaselineReport};
pub use record_signal::{EndDisplacement, RecordSignal};

use powerhouse_model::ParameterError;

use crate::{SignalMotion, WaveError};

/// Motion at the start of one interval and slope of its acceleration: half a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
struct Node {
    displacement: f64,
    velocity: f64,
    acceleration: f64,
    slope: f64,
}

impl Node {
    /// Motion `local` seconds into the interval, by Taylor's series, which is finite here.
    #[inline(always)]
    fn motion(&self, local: f64) -> SignalMotion {
        SignalMotion {
            displacement: self.displacement
                + local
                    * (self.velocity
                        + local * (0.5 * self.acceleration + local * (self.slope / 6.0))),
            velocity: self.velocity + local * (self.acceleration + local * (0.5 * self.slope)),
            acceleration: self.acceleration + local * self.slope,
        }
    }
}

/// Peak and end values of a time history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordReport {
    /// Largest magnitude of acceleration (m/s2), the PGA.
    pub peak_acceleration: f64,
    /// Largest magnitude of velocity (m/s), the PGV, also between samples.
    pub peak_velocity: f64,
    /// Largest magnitude of displacement (m), the PGD, also between samples.
    pub peak_displacement: f64,
    /// Velocity at the last sample (m/s).
    pub end_velocity: f64,
    /// Displacement at the last sample (m).
    pub end_displacement: f64,
}

/// Acceleration time history, given by uniform samples and linear between them, with the velocity
/// and displacement that follow from rest at time zero.
///
/// In each interval the velocity is a parabola and the displacement a cubic, both exact; a
/// value is one look-up. Before time zero the history is at rest. After its last sample
/// displacement is held and velocity and acceleration are zero, which is a jump unless the record
/// ends at rest: a wave therefore takes a [`RecordSignal`], which is only made from a record
/// that does.
///
/// Operations return new histories and take effect in the order in which they are called.
/// ```
/// use powerhouse_wavefield::{BaselineCorrection, EndDisplacement, TimeHistory};
/// let samples = (0..400).map(|i| (0.1 * i as f64).sin()).collect();
/// let history = TimeHistory::new(0.01, samples)?.truncated(3.0, 0.2)?;
/// let (history, report) = history.corrected(BaselineCorrection::VelocityPolynomial { order: 4 })?;
/// assert!(report.after.end_velocity.abs() < 1e-12);
/// let signal = history.scaled_to_peak(1.7)?.into_signal(EndDisplacement::Zero)?;
/// assert!((signal.report().peak_acceleration - 1.7).abs() < 1e-12);
/// # Ok::<(), powerhouse_wavefield::WaveError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TimeHistory {
    step: f64,
    per_step: f64,
    nodes: Vec<Node>,
}

impl TimeHistory {
    /// History of samples of acceleration (m/s2) at intervals of `step` seconds, the first at
    /// time zero.
    ///
    /// # Errors
    /// If the step is not above zero, if there are fewer than two samples, or one is not finite
    /// or beyond 1e12 in magnitude.
    pub fn new(step: f64, acceleration: Vec<f64>) -> Result<Self, WaveError> {
        ParameterError::check("step", step, 1e-9, 1e6)?;
        if acceleration.len() < 2 {
            return Err(WaveError::TooFewSamples {
                operation: "a history",
                given: acceleration.len(),
                least: 2,
            });
        }
        if let Some(index) = acceleration
            .iter()
            .position(|a| !a.is_finite() || a.abs() > 1e12)
        {
            return Err(WaveError::SampleNotFinite {
                index,
                value: acceleration[index],
            });
        }
        let mut nodes: Vec<Node> = Vec::with_capacity(acceleration.len());
        let (mut velocity, mut displacement) = (0.0, 0.0);
        for (i, &a) in acceleration.iter().enumerate() {
            let slope = match acceleration.get(i + 1) {
                Some(next) => (next - a) / step,
                None => 0.0,
            };
            let node = Node {
                displacement,
                velocity,
                acceleration: a,
                slope,
            };
            let end = node.motion(step);
            (displacement, velocity) = (end.displacement, end.velocity);
            nodes.push(node);
        }
        Ok(Self {
            step,
            per_step: 1.0 / step,
            nodes,
        })
    }

    /// Interval between samples (s).
    pub fn step(&self) -> f64 {
        self.step
    }
    /// Number of samples, at least two.
    pub fn samples(&self) -> usize {
        self.nodes.len()
    }
    /// Time of the last sample (s).
    pub fn duration(&self) -> f64 {
        self.step * (self.nodes.len() - 1) as f64
    }
    /// Samples of acceleration (m/s2).
    pub fn acceleration(&self) -> Vec<f64> {
        self.nodes.iter().map(|node| node.acceleration).collect()
    }
    /// Motion at every sample.
    pub fn sample_motions(&self) -> impl Iterator<Item = SignalMotion> {
        self.nodes.iter().map(|node| node.motion(0.0))
    }

    /// Motion at a time (s).
    #[inline]
    pub fn motion(&self, time: f64) -> SignalMotion {
        let place = time * self.per_step;
        if place.is_nan() || place < 0.0 {
            return SignalMotion::default();
        }
        let last = self.nodes.len() - 1;
        let index = place as usize;
        if index >= last {
            let end = self.nodes[last].motion(0.0);
            return if place <= last as f64 {
                end
            } else {
                SignalMotion {
                    displacement: end.displacement,
                    ..SignalMotion::default()
                }
            };
        }
        self.nodes[index].motion(time - index as f64 * self.step)
    }

    /// Peak and end values of the history.
    pub fn report(&self) -> RecordReport {
        let last = self.nodes[self.nodes.len() - 1];
        let mut report = RecordReport {
            peak_acceleration: 0.0,
            peak_velocity: 0.0,
            peak_displacement: 0.0,
            end_velocity: last.velocity,
            end_displacement: last.displacement,
        };
        for node in &self.nodes {
            let mut see = |local: f64| {
                let motion = node.motion(local);
                report.peak_acceleration = report.peak_acceleration.max(motion.acceleration.abs());
                report.peak_velocity = report.peak_velocity.max(motion.velocity.abs());
                report.peak_displacement = report.peak_displacement.max(motion.displacement.abs());
            };
            see(0.0);
            for root in interior_extrema(node) {
                if root > 0.0 && root < self.step {
                    see(root);
                }
            }
        }
        report
    }

    /// Arias intensity of the record, `pi / (2 g) int a^2 dt` (m/s), exact for linear interpolation.
    ///
    /// Source: A. Arias (1970); g is 9.80665 m/s2.
    pub fn arias_intensity(&self) -> f64 {
        const STANDARD_GRAVITY: f64 = 9.806_65;
        std::f64::consts::PI / (2.0 * STANDARD_GRAVITY)
            * self.squared_acceleration().last().copied().unwrap_or(0.0)
    }

    /// Share of the Arias intensity of the record before a time (s), of which the nearest sample counts: zero up to the second
    /// sample, and 1 of a record that is zero throughout.
    ///
    /// ```
    /// # use powerhouse_wavefield::TimeHistory;
    /// let record = TimeHistory::new(0.5, vec![0.0, 1.0, 1.0, 1.0, 0.0])?;
    /// assert!((record.arias_share_before(1.0) - 0.5).abs() < 1e-15);
    /// assert_eq!([0.5, 9.0].map(|time| record.arias_share_before(time)), [0.0, 1.0]);
    /// # Ok::<(), powerhouse_wavefield::WaveError>(())
    /// ```
    pub fn arias_share_before(&self, time: f64) -> f64 {
        let sums = self.squared_acceleration();
        let last = sums.len() - 1;
        match sums[last] {
            0.0 => 1.0,
            _ if time <= self.step => 0.0,
            total => sums[((time / self.step).round() as usize).min(last)] / total,
        }
    }

    /// Significant duration: the time (s) in which the Arias intensity rises from one share of its end
    /// value to another, for instance from 0.05 to 0.95, interpolated linearly between samples. Zero for
    /// a record that is zero throughout.
    ///
    /// # Errors
    /// If the shares are not in rising order between 0 and 1.
    pub fn significant_duration(&self, from: f64, to: f64) -> Result<f64, WaveError> {
        ParameterError::check("from", from, 0.0, 1.0)?;
        ParameterError::check("to", to, from, 1.0)?;
        let sums = self.squared_acceleration();
        let total = sums[sums.len() - 1];
        if total == 0.0 {
            return Ok(0.0);
        }
        let reached = |share: f64| {
            let target = share * total;
            let after = sums.partition_point(|sum| *sum < target);
            if after == 0 {
                return 0.0;
            }
            let (low, high) = (sums[after - 1], sums[after.min(sums.len() - 1)]);
            let part = if high > low {
                (target - low) / (high - low)
            } else {
                0.0
            };
            self.step * ((after - 1) as f64 + part)
        };
        Ok(reached(to) - reached(from))
    }

    /// Integral `int_0^t a^2` at the samples.
    fn squared_acceleration(&self) -> Vec<f64> {
        let mut sum = 0.0;
        let mut sums = vec![0.0];
        for pair in self.nodes.windows(2) {
            let (a, b) = (pair[0].acceleration, pair[1].acceleration);
            sum += self.step / 3.0 * (a * a + a * b + b * b);
            sums.push(sum);
        }
        sums
    }
}

/// Local times at which the velocity (one) and the displacement (two) of an interval are
/// stationary; NaN where there is none.
fn interior_extrema(node: &Node) -> [f64; 3] {
    let (v, a, s) = (node.velocity, node.acceleration, node.slope);
    let stationary_velocity = -a / s;
    // v + a t + s t^2 / 2 = 0 without cancellation.
    let q = -(a + a.signum() * (a * a - 2.0 * s * v).sqrt());
    [stationary_velocity, q / s, 2.0 * v / q]
}
