//! The frequencies of what comes in.

use core::f64::consts::TAU;

use powerhouse::Scene;

use crate::StudyError;
use crate::resolution::incoming;

/// The band ends where this share of the energy of velocity is below.
const SHARE: f64 = 0.99;
/// Frequencies that stand for all.
const LINES: usize = 40;

/// The frequencies of the motion that comes in, as it moves the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Frequencies (Hz), rising, and the energy of velocity at each; the energies add up to one.
    pub lines: Vec<(f64, f64)>,
    /// Below this frequency (Hz) lie 99 % of the energy of velocity.
    pub highest: f64,
}

impl Band {
    /// The band of a scene's field.
    ///
    /// # Errors
    /// A field that does not move the surface in the time of the run.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        let duration = scene.duration();
        let spectrum = incoming(scene)?.unwrap_or_default();
        // Energies of velocity; what is longer than the run is not motion of it.
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

    /// Some lines that stand for all up to a frequency (Hz).
    fn gathered(lines: &[(f64, f64)], highest: f64) -> Self {
        let mut sums = [(0.0, 0.0); LINES];
        for &(frequency, energy) in lines.iter().filter(|line| line.0 <= highest) {
            let place = (frequency / highest * LINES as f64) as usize;
            let (moment, sum) = &mut sums[place.min(LINES - 1)];
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

    /// The same up to a frequency (Hz).
    #[must_use]
    pub fn up_to(&self, highest: f64) -> Self {
        if highest >= self.highest {
            return self.clone();
        }
        Self::gathered(&self.lines, highest)
    }

    /// The mean frequency (Hz), by energy.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.lines
            .iter()
            .map(|(frequency, energy)| frequency * energy)
            .sum()
    }
}
