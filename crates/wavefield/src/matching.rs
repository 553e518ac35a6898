//! Records scaled and matched to the spectra of codes.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use powerhouse_model::ParameterError;

use crate::spectrum::March;
use crate::{DesignSpectrum, RecordReport, TimeHistory, WaveError};

/// How far a response spectrum is from the one that it is to have, over a band of periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralMisfit {
    /// Mean of the ratio of spectra.
    pub mean: f64,
    /// Least ratio.
    pub least: f64,
    /// Greatest ratio.
    pub greatest: f64,
}

/// What matching did to a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchReport {
    /// Factor by which the record was multiplied first.
    pub factor: f64,
    /// Ratio of spectra of the record that was multiplied.
    pub before: SpectralMisfit,
    /// Ratio of spectra of the matched record.
    pub after: SpectralMisfit,
    /// Peaks and ends of the record that was multiplied.
    pub motion_before: RecordReport,
    /// Peaks and ends of the matched record: its velocity and displacement at the end are the drift.
    pub motion_after: RecordReport,
    /// Arias intensity (m/s) before and after.
    pub arias: [f64; 2],
    /// Greatest difference of the two over that of the matched record, of acceleration.
    pub changed: f64,
    /// Iterations.
    pub iterations: usize,
}

impl MatchReport {
    /// Report of two matches between which the baseline was corrected; the changes add up.
    #[must_use]
    pub fn followed_by(self, second: &Self) -> Self {
        Self {
            factor: self.factor * second.factor,
            before: self.before,
            motion_before: self.motion_before,
            arias: [self.arias[0], second.arias[1]],
            changed: self.changed + second.changed,
            iterations: self.iterations + second.iterations,
            ..*second
        }
    }
}

/// Periods between which spectra are compared, and where matching ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralBand {
    /// Shortest period (s), above four steps of the record.
    pub shortest: f64,
    /// Longest period (s), at most the duration of the record.
    pub longest: f64,
    /// Misfit (relative) at which iterations end, 1e-4 to 0.5.
    pub tolerance: f64,
}

/// Wavelets of neighbouring periods overlap: ratio of their periods.
const SPACING: f64 = 1.04;
/// Greatest number of iterations.
const MOST_ITERATIONS: usize = 40;
/// Iterations without progress after which the best is taken.
const PATIENCE: usize = 8;

impl TimeHistory {
    /// Factor by which histories, taken together, come nearest to a spectrum: the mean of the logarithm of the ratio of the
    /// geometric mean of their pseudo-accelerations is zero over the band. A pair of horizontal components keeps its proportion.
    ///
    /// # Errors
    /// If there is no history, one is zero throughout, or the band is not within the spectrum and the records.
    pub fn factor_to_spectrum(
        histories: &[&TimeHistory],
        target: &DesignSpectrum,
        band: &SpectralBand,
    ) -> Result<f64, WaveError> {
        let mut sum = 0.0;
        let mut count = 0;
        for history in histories {
            let problem = Matching::new(history, target, band)?;
            for peak in problem.peaks(&history.acceleration(), &problem.dense) {
                if peak.value == 0.0 {
                    return Err(WaveError::ZeroPeak);
                }
                sum += (peak.target / peak.value.abs()).ln();
                count += 1;
            }
        }
        if count == 0 {
            return Err(WaveError::TooFewSamples {
                operation: "scaling to a spectrum",
                given: 0,
                least: 1,
            });
        }
        Ok((sum / f64::from(count)).exp())
    }

    /// History whose response spectrum is that of a code over a band of periods, by wavelets that are added in time (L. Al Atik
    /// and N. Abrahamson (2010), Earthquake Spectra 26(3)), after a factor as of [`TimeHistory::factor_to_spectrum`].
    ///
    /// Each period has a tapered cosine in phase with its oscillator's greatest response; the amplitudes follow from the responses
    /// of all oscillators to all wavelets, again and again, since the greatest responses move. The best iterate is
    /// returned, with what was reached. Velocity and displacement may drift where wavelets meet the start of
    /// the record: correct the baseline of the result and look at its spectrum again ([`TimeHistory::misfit`]).
    ///
    /// # Errors
    /// As [`TimeHistory::factor_to_spectrum`].
    pub fn matched_to_spectrum(
        &self,
        target: &DesignSpectrum,
        band: &SpectralBand,
    ) -> Result<(TimeHistory, MatchReport), WaveError> {
        let factor = Self::factor_to_spectrum(&[self], target, band)?;
        let scaled = self.scaled(factor)?;
        let problem = Matching::new(&scaled, target, band)?;
        let start = scaled.acceleration();
        let mut current = start.clone();
        let mut best = (problem.misfit(&start), start.clone());
        let before = best.0;
        let (mut iterations, mut idle, mut share) = (0, 0, 1.0);
        while best.0.worst() > band.tolerance && iterations < MOST_ITERATIONS && idle < PATIENCE {
            problem.improve(&mut current, share);
            let misfit = problem.misfit(&current);
            iterations += 1;
            idle += 1;
            if misfit.worst() < best.0.worst() {
                best = (misfit, current.clone());
                idle = 0;
            } else if idle % 3 == 0 {
                // Greatest responses jump to and fro: shorter steps from the best.
                current.clone_from(&best.1);
                share *= 0.5;
            }
        }
        let (after, samples) = best;
        let peak = samples.iter().fold(0.0, |peak: f64, a| peak.max(a.abs()));
        let moved = start
            .iter()
            .zip(&samples)
            .map(|(old, new)| (new - old).abs());
        let changed = moved.fold(0.0, f64::max) / peak;
        let matched = TimeHistory::new(self.step(), samples)?;
        let report = MatchReport {
            factor,
            before,
            after,
            motion_before: scaled.report(),
            motion_after: matched.report(),
            arias: [scaled.arias_intensity(), matched.arias_intensity()],
            changed,
            iterations,
        };
        Ok((matched, report))
    }

    /// Ratio of the response spectrum (pseudo-acceleration) to that of a code over a band of periods.
    ///
    /// # Errors
    /// If the band is not within the spectrum and the record.
    pub fn misfit(
        &self,
        target: &DesignSpectrum,
        band: &SpectralBand,
    ) -> Result<SpectralMisfit, WaveError> {
        Ok(Matching::new(self, target, band)?.misfit(&self.acceleration()))
    }
}

impl SpectralMisfit {
    /// Greatest distance of the ratio from one.
    pub fn worst(&self) -> f64 {
        (self.greatest - 1.0).max(1.0 - self.least)
    }
}

/// Greatest response of one oscillator.
#[derive(Clone, Copy)]
struct Peak {
    period: f64,
    target: f64,
    /// Instant, in parts of a step of the record.
    instant: usize,
    parts: usize,
    /// Pseudo-acceleration with its sign (m/s2).
    value: f64,
}

struct Matching {
    step: f64,
    damping: f64,
    /// Periods of the wavelets, with the target (m/s2).
    periods: Vec<(f64, f64)>,
    /// Periods at which spectra are compared: three times as many.
    dense: Vec<(f64, f64)>,
}

impl Matching {
    fn new(
        history: &TimeHistory,
        target: &DesignSpectrum,
        band: &SpectralBand,
    ) -> Result<Self, WaveError> {
        const PERIODS_PER_WAVELET: usize = 3;
        let (first, last) = target.periods();
        let least = first.max(4.0 * history.step());
        let most = last.min(history.duration());
        ParameterError::check("shortest", band.shortest, least, most)?;
        ParameterError::check("longest", band.longest, band.shortest, most)?;
        ParameterError::check("tolerance", band.tolerance, 1e-4, 0.5)?;
        let ratio = band.longest / band.shortest;
        let count = (ratio.ln() / SPACING.ln()).ceil() as usize + 1;
        let grid = |count: usize| {
            let intervals = count.saturating_sub(1).max(1) as f64;
            let period = |i: usize| band.shortest * ratio.powf(i as f64 / intervals);
            (0..count)
                .map(|i| period(i).clamp(band.shortest, band.longest))
                .filter_map(|period| Some((period, target.acceleration(period)?)))
                .collect()
        };
        Ok(Self {
            step: history.step(),
            damping: target.damping(),
            periods: grid(count),
            dense: grid(PERIODS_PER_WAVELET * (count - 1) + 1),
        })
    }

    /// Greatest response at each period.
    fn peaks(&self, samples: &[f64], periods: &[(f64, f64)]) -> Vec<Peak> {
        let peak = |&(period, target): &(f64, f64)| {
            let march = March::new(self.step, self.damping, period);
            let stiffness = (2.0 * PI / period).powi(2);
            let mut peak = Peak {
                period,
                target,
                instant: 0,
                parts: march.parts,
                value: 0.0,
            };
            march.run(samples, |instant, (displacement, _)| {
                let value = stiffness * displacement;
                if value.abs() > peak.value.abs() {
                    (peak.instant, peak.value) = (instant, value);
                }
            });
            peak
        };
        periods.iter().map(peak).collect()
    }

    fn misfit(&self, samples: &[f64]) -> SpectralMisfit {
        let peaks = self.peaks(samples, &self.dense);
        let ratios = peaks.iter().map(|peak| peak.value.abs() / peak.target);
        let mut misfit = SpectralMisfit {
            mean: 0.0,
            least: f64::INFINITY,
            greatest: 0.0,
        };
        for ratio in ratios {
            misfit.mean += ratio / peaks.len() as f64;
            misfit.least = misfit.least.min(ratio);
            misfit.greatest = misfit.greatest.max(ratio);
        }
        misfit
    }

    /// Adds a share of the wavelets that would bring every greatest response to its target, were its instant to stay.
    fn improve(&self, samples: &mut [f64], share: f64) {
        // Off-diagonal responses are lowered: greatest responses move, and the full inverse overshoots.
        const COUPLING: f64 = 0.7;
        let peaks = self.peaks(samples, &self.periods);
        let wavelets: Vec<Vec<f64>> = peaks
            .iter()
            .map(|peak| self.wavelet(peak, samples.len()))
            .collect();
        let count = peaks.len();
        let mut responses = DMatrix::zeros(count, count);
        for (row, peak) in peaks.iter().enumerate() {
            for (column, wavelet) in wavelets.iter().enumerate() {
                let share = if row == column { 1.0 } else { COUPLING };
                responses[(row, column)] = share * self.response(peak, wavelet);
            }
        }
        let missing = peaks
            .iter()
            .map(|peak| share * peak.value.signum() * (peak.target - peak.value.abs()));
        let missing = DVector::from_iterator(count, missing);
        let Some(amplitudes) = responses.lu().solve(&missing) else {
            return;
        };
        for (wavelet, amplitude) in wavelets.iter().zip(amplitudes.iter()) {
            for (sample, value) in samples.iter_mut().zip(wavelet) {
                *sample += amplitude * value;
            }
        }
    }

    /// Samples of the tapered cosine to which an oscillator has its greatest response at a given instant.
    fn wavelet(&self, peak: &Peak, samples: usize) -> Vec<f64> {
        let frequency = 1.0 / peak.period;
        let root = (1.0 - self.damping * self.damping).sqrt();
        let damped = 2.0 * PI * frequency * root;
        let lead = (root / self.damping.max(1e-6)).atan() / damped;
        let width = 1.178 * frequency.powf(-0.93);
        let centre = peak.instant as f64 * self.step / peak.parts as f64 - lead;
        let value = |i: usize| {
            let local = i as f64 * self.step - centre;
            (damped * local).cos() * (-(local / width).powi(2)).exp()
        };
        (0..samples).map(value).collect()
    }

    /// Pseudo-acceleration of an oscillator at an instant under samples.
    fn response(&self, peak: &Peak, samples: &[f64]) -> f64 {
        let march = March::new(self.step, self.damping, peak.period);
        let mut found = 0.0;
        let last = (peak.instant / peak.parts + 2).min(samples.len());
        march.run(&samples[..last], |instant, (displacement, _)| {
            if instant == peak.instant {
                found = (2.0 * PI / peak.period).powi(2) * displacement;
            }
        });
        found
    }
}
