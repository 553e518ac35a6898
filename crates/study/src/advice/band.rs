//! The frequency content of the incident motion.

use core::f64::consts::TAU;

use powerhouse::Scene;

use crate::StudyError;

/// Share of the energy of velocity that lies below the upper end of the band.
const SHARE: f64 = 0.99;
/// Number of frequency intervals into which a spectrum is condensed.
const LINES: usize = 40;

/// Frequency band of the incident motion at the ground surface, as a condensed energy spectrum of its velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Spectral lines: frequency (Hz), rising, and the share of the energy of velocity at it; the shares add up
    /// to one.
    pub lines: Vec<(f64, f64)>,
    /// Upper end of the band (Hz): 99 % of the energy of velocity lie below it.
    pub highest: f64,
}

impl Band {
    /// Computes the frequency band of a scene's incident field at the middle of its surface.
    ///
    /// # Errors
    /// [`StudyError::StillField`] for a field that does not move the surface within the duration of the run.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        let duration = scene.duration();
        let spectrum = scene.incident_spectrum()?.unwrap_or_default();
        // Energies of velocity, without periods longer than the run.
        let velocity: Vec<(f64, f64)> = (spectrum.into_iter())
            .filter(|(frequency, _)| frequency * duration >= 1.0)
            .map(|(frequency, energy)| (frequency, energy / (TAU * frequency).powi(2)))
            .collect();
        let whole: f64 = velocity.iter().map(|(_, energy)| energy).sum();
        if whole.is_nan() || whole <= 0.0 {
            return Err(StudyError::StillField { duration });
        }
        let mut below = 0.0;
        let highest = velocity.iter().find(|(_, energy)| {
            below += energy;
            below >= SHARE * whole
        });
        let highest = highest.or(velocity.last()).map_or(0.0, |line| line.0);
        Ok(Self::gathered(&velocity, highest))
    }

    /// Condenses spectral lines up to a frequency (Hz) into [`LINES`] intervals of equal width.
    fn gathered(lines: &[(f64, f64)], highest: f64) -> Self {
        let mut sums = [(0.0, 0.0); LINES];
        for &(frequency, energy) in lines.iter().filter(|line| line.0 <= highest) {
            let interval = (frequency / highest * LINES as f64) as usize;
            let (moment, sum) = &mut sums[interval.min(LINES - 1)];
            *moment += frequency * energy;
            *sum += energy;
        }
        let whole: f64 = sums.iter().map(|(_, sum)| sum).sum();
        let filled = sums.into_iter().filter(|(_, sum)| *sum > 0.0);
        if whole <= 0.0 {
            let lines = vec![(highest, 1.0)];
            return Self { lines, highest };
        }
        Self {
            lines: filled
                .map(|(moment, sum)| (moment / sum, sum / whole))
                .collect(),
            highest,
        }
    }

    /// The part of the band below a frequency (Hz), its shares normalised to one.
    #[must_use]
    pub fn up_to(&self, highest: f64) -> Self {
        if highest >= self.highest {
            return self.clone();
        }
        Self::gathered(&self.lines, highest)
    }

    /// Mean frequency (Hz), weighted by the energy of velocity.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.lines
            .iter()
            .map(|(frequency, energy)| frequency * energy)
            .sum()
    }
}
