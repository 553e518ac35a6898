//! Signals given by samples, and the window of time in which they are transformed.

use crate::fourier::Fourier;
use crate::hermite::Quintic;
use crate::{Complex, Signal, SignalMotion, SignalSupport, WaveError};

/// Signal given by samples with quintic interpolation.
pub(crate) struct SampledSignal {
    start: f64,
    step: f64,
    per_step: f64,
    intervals: Vec<Quintic<f64>>,
}

impl SampledSignal {
    /// Signal of samples of displacement, velocity and acceleration from a time on (s), every `step` (s).
    pub(crate) fn new(start: f64, step: f64, samples: [&[f64]; 3]) -> Self {
        let node = |i: usize| samples.map(|values| values[i]);
        let count = samples[0].len().saturating_sub(1);
        let intervals = (0..count).map(|i| Quintic::new(node(i), node(i + 1), step));
        Self {
            start,
            step,
            per_step: 1.0 / step,
            intervals: intervals.collect(),
        }
    }
}

impl Signal for SampledSignal {
    fn motion(&self, time: f64) -> SignalMotion {
        let position = (time - self.start) * self.per_step;
        if position >= 0.0 && position < self.intervals.len() as f64 {
            let index = position as usize;
            let local = position - index as f64;
            let (displacement, velocity) = self.intervals[index].real_value(local);
            let curvature = self.intervals[index].second_derivative(local);
            return SignalMotion {
                displacement,
                velocity: velocity * self.per_step,
                acceleration: curvature * self.per_step * self.per_step,
            };
        }
        SignalMotion::default()
    }
    fn support(&self) -> SignalSupport {
        SignalSupport {
            start: self.start,
            end: self.start + self.step * self.intervals.len() as f64,
            step: self.step,
        }
    }
}

/// Window of time around a signal that is divided by a transfer function: two lengths of the signal before it and
/// four or more after it, faded out over the outer tenths.
pub(crate) struct SignalWindow {
    fourier: Fourier,
    support: SignalSupport,
}

impl SignalWindow {
    /// Window of a support; the longest travel time to the surface and back (s) is part of the length.
    ///
    /// # Errors
    /// [`WaveError::TooManySamples`] names the operation.
    pub(crate) fn new(
        support: SignalSupport,
        longest_delay: f64,
        operation: &'static str,
    ) -> Result<Self, WaveError> {
        const MOST_SAMPLES: usize = 1 << 20;
        let length = support.end - support.start + longest_delay;
        let needed = 8.0 * length / support.step;
        WaveError::check_samples(operation, needed, MOST_SAMPLES)?;
        Ok(Self {
            fourier: Fourier::new(needed.ceil() as usize),
            support,
        })
    }

    /// Number of samples.
    pub(crate) fn count(&self) -> usize {
        self.fourier.len()
    }

    /// Time between two samples (s).
    pub(crate) fn step(&self) -> f64 {
        self.support.step
    }

    /// Distance of two frequencies of a spectrum (Hz).
    pub(crate) fn bin(&self) -> f64 {
        1.0 / (self.count() as f64 * self.step())
    }

    /// Time of the first sample (s).
    pub(crate) fn start(&self) -> f64 {
        self.support.start - (self.count() / 4) as f64 * self.step()
    }

    /// Displacement, velocity and acceleration of a signal, sample by sample.
    pub(crate) fn samples(&self, signal: &dyn Signal) -> [Vec<f64>; 3] {
        let (count, quarter) = (self.count(), self.count() / 4);
        let mut samples = [(); 3].map(|()| vec![0.0; count]);
        for i in 0..count - quarter {
            let time = self.support.start + i as f64 * self.support.step;
            if time > self.support.end {
                break;
            }
            let motion = signal.motion(time);
            samples[0][quarter + i] = motion.displacement;
            samples[1][quarter + i] = motion.velocity;
            samples[2][quarter + i] = motion.acceleration;
        }
        samples
    }

    /// Spectrum of samples.
    pub(crate) fn spectrum(&self, samples: &[f64]) -> Vec<Complex> {
        self.fourier.forward(samples)
    }

    /// Samples of a spectrum.
    pub(crate) fn inverse(&self, spectrum: &[Complex]) -> Vec<f64> {
        self.fourier.inverse(spectrum)
    }

    /// Fades displacement, velocity and acceleration at both ends, by the product rule.
    pub(crate) fn fade(&self, samples: &mut [Vec<f64>; 3]) {
        fade(samples, self.step());
    }
}

/// Factor that falls from 1 to 0 while x goes from 0 to 1, with two derivatives zero at both ends, and its first two derivatives in
/// time; x grows by `rate` (1/s).
pub(crate) fn falling(x: f64, rate: f64) -> [f64; 3] {
    [
        1.0 - x * x * x * (10.0 + x * (6.0 * x - 15.0)),
        -30.0 * rate * x * x * (1.0 - x) * (1.0 - x),
        -60.0 * rate * rate * x * (1.0 - x) * (1.0 - 2.0 * x),
    ]
}

/// Fades displacement, velocity and acceleration at both ends, by the product rule.
fn fade([displacement, velocity, acceleration]: &mut [Vec<f64>; 3], step: f64) {
    let count = displacement.len();
    let width = (count / 10) as f64;
    for i in 0..count {
        let from_end = i.min(count - 1 - i) as f64;
        if from_end >= width {
            continue;
        }
        let sign = if 2 * i < count { 1.0 } else { -1.0 };
        let x = from_end / width;
        let rate = sign / (width * step);
        // 10 x^3 - 15 x^4 + 6 x^5 rises from 0 to 1 with two derivatives zero at both ends.
        let w = x * x * x * (10.0 + x * (6.0 * x - 15.0));
        let w1 = rate * 30.0 * x * x * (1.0 - x) * (1.0 - x);
        let w2 = rate * rate * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x);
        let (d, v, a) = (displacement[i], velocity[i], acceleration[i]);
        displacement[i] = d * w;
        velocity[i] = v * w + d * w1;
        acceleration[i] = a * w + 2.0 * v * w1 + d * w2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A faded motion is consistent: velocity and acceleration are the derivatives of displacement
    /// and velocity, and the ends are at rest.
    #[test]
    fn a_faded_motion_is_a_motion() {
        let (count, step) = (2000, 0.01);
        let time = |i: usize| step * i as f64;
        let mut motion = [
            (0..count).map(|i| 1.0 + 1e-3 * time(i).powi(2)).collect(),
            (0..count).map(|i| 2e-3 * time(i)).collect(),
            vec![2e-3; count],
        ];
        fade(&mut motion, step);
        let [displacement, velocity, acceleration] = motion;
        for end in [0, count - 1] {
            assert_eq!((displacement[end], velocity[end]), (0.0, 0.0));
        }
        for i in 1..count - 1 {
            let slope = |values: &[f64]| (values[i + 1] - values[i - 1]) / (2.0 * step);
            // The faded ends are 200 steps long; there the third derivative reaches, and where
            // they end it jumps by, 60 / (200 step)^3 of at most 1.4. Differences miss step^2 / 6
            // of the one in velocity, and step / 4 of the other in acceleration.
            assert!((velocity[i] - slope(&displacement)).abs() < 2e-4, "{i}");
            assert!((acceleration[i] - slope(&velocity)).abs() < 0.03, "{i}");
        }
    }
}
