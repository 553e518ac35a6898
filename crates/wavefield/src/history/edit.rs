//! Truncation, scaling, resampling and padding of histories.

use powerhouse_model::ParameterError;

use super::TimeHistory;
use crate::WaveError;
use crate::fourier::Fourier;

/// Greatest number of samples of a history after any operation.
pub(crate) const MOST_SAMPLES: usize = 1 << 24;

impl TimeHistory {
    /// History truncated to its first `duration` seconds, to the nearest sample. Over the last `taper`
    /// seconds that remain the acceleration falls to zero with half a cosine; zero means no taper.
    ///
    /// # Errors
    /// If the duration is not between one step and that of the record, or the taper is longer than
    /// the duration.
    pub fn truncated(&self, duration: f64, taper: f64) -> Result<Self, WaveError> {
        ParameterError::check(
            "duration",
            duration,
            self.step,
            self.duration() + 0.5 * self.step,
        )?;
        ParameterError::check("taper", taper, 0.0, duration)?;
        let intervals = ((duration / self.step).round() as usize).min(self.samples() - 1);
        let end = intervals as f64 * self.step;
        let samples = self.nodes[..=intervals].iter().enumerate();
        let samples = samples.map(|(i, node)| {
            let left = end - i as f64 * self.step;
            if left >= taper {
                node.acceleration
            } else {
                node.acceleration * 0.5 * (1.0 - (std::f64::consts::PI * left / taper).cos())
            }
        });
        Self::new(self.step, samples.collect())
    }

    /// History with every sample multiplied by a factor.
    ///
    /// # Errors
    /// If the factor is not finite, or a sample leaves the permitted range.
    pub fn scaled(&self, factor: f64) -> Result<Self, WaveError> {
        ParameterError::check("factor", factor, -1e12, 1e12)?;
        let samples = self.nodes.iter().map(|node| factor * node.acceleration);
        Self::new(self.step, samples.collect())
    }

    /// History scaled so that the largest magnitude of acceleration is `peak` (m/s2).
    ///
    /// # Errors
    /// [`WaveError::ZeroPeak`] if the history is zero throughout.
    pub fn scaled_to_peak(&self, peak: f64) -> Result<Self, WaveError> {
        ParameterError::check("peak", peak, 0.0, 1e12)?;
        let present = self.nodes.iter().map(|node| node.acceleration.abs());
        let present = present.fold(0.0, f64::max);
        if present == 0.0 {
            return Err(WaveError::ZeroPeak);
        }
        self.scaled(peak / present)
    }

    /// History of the same piecewise-linear acceleration, sampled at a smaller step (s).
    ///
    /// The motion is unchanged if the old step is a multiple of the new one; otherwise the corners
    /// at the old samples are cut. A larger step would lose content and is an error.
    ///
    /// # Errors
    /// If the step is above the present one, or so small that there are too many samples.
    pub fn resampled(&self, step: f64) -> Result<Self, WaveError> {
        ParameterError::check("step", step, 1e-9, self.step * (1.0 + 1e-12))?;
        let intervals = self.duration() / step;
        WaveError::check_samples("resampling", intervals, MOST_SAMPLES)?;
        let intervals = (intervals * (1.0 - 1e-12)).ceil() as usize;
        let duration = self.duration();
        let samples = (0..=intervals).map(|i| {
            // The last sample may fall past the end by less than a step: there it is the end value.
            let time = (i as f64 * step).min(duration);
            self.motion(time).acceleration
        });
        Self::new(step, samples.collect())
    }

    /// History of the same band-limited motion at intervals a power of two shorter: the sum of the sinusoids of its samples up to
    /// half of their frequency, which straight lines between them lower. The motion is taken as zero beyond both ends.
    ///
    /// # Errors
    /// If `times` is no power of two, or there are too many samples.
    pub fn refined(&self, times: usize) -> Result<Self, WaveError> {
        let power = (times as f64).log2();
        ParameterError::check("times, as a power of two,", power.fract(), 0.0, 0.0)?;
        WaveError::check_samples(
            "refining",
            (2 * times * self.samples()) as f64,
            MOST_SAMPLES,
        )?;
        let coarse = Fourier::new(2 * self.samples());
        let fine = Fourier::new(times * coarse.len());
        let mut spectrum = coarse.forward(&self.acceleration());
        // Half of the line at the end is of the negative frequencies.
        if let Some(end) = spectrum.last_mut().filter(|_| times > 1) {
            *end *= 0.5;
        }
        let zeros = std::iter::repeat(crate::Complex::default());
        let spectrum = spectrum.into_iter().map(|line| line * times as f64);
        let mut samples = fine.inverse_of(spectrum.chain(zeros));
        samples.truncate(times * (self.samples() - 1) + 1);
        Self::new(self.step / times as f64, samples)
    }

    /// History with zero acceleration added before and after (s, to the nearest sample). The record's
    /// time zero moves back by the length that is added before it.
    ///
    /// # Errors
    /// If a length is negative or there are too many samples.
    pub fn padded(&self, before: f64, after: f64) -> Result<Self, WaveError> {
        let most = MOST_SAMPLES as f64 * self.step;
        ParameterError::check("before", before, 0.0, most)?;
        ParameterError::check("after", after, 0.0, most)?;
        let count = |length: f64| (length / self.step).round() as usize;
        let total = self.samples() + count(before) + count(after);
        WaveError::check_samples("padding", total as f64, MOST_SAMPLES)?;
        let mut samples = vec![0.0; count(before)];
        samples.extend(self.nodes.iter().map(|node| node.acceleration));
        samples.resize(total, 0.0);
        Self::new(self.step, samples)
    }
}
