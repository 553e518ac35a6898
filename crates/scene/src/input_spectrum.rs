//! Frequency content of the input motion.

use powerhouse_model::{FieldMotion, Vec3};
use powerhouse_wavefield::TimeHistory;

use crate::{Error, Scene};

/// Instants at which the incident motion is sampled.
const INSTANTS: usize = 16_384;
/// Least duration of the taper after the run, over the duration of the run.
const FADING_SHARE: f64 = 0.05;
/// Least duration of the taper (s): a cut-off within a few periods would have energy at all frequencies.
const LEAST_FADING: f64 = 1.0;
/// Share of the energy that is almost all of it.
const ALMOST_ALL: f64 = 0.99;

/// Energy spectrum of acceleration: frequency (Hz) and energy of each line.
pub type EnergySpectrum = Vec<(f64, f64)>;

/// Spectrum of an input that moves.
#[derive(Clone, Debug)]
pub(crate) struct InputSpectrum {
    lines: EnergySpectrum,
    highest: f64,
}

impl InputSpectrum {
    /// None without motion.
    fn new(lines: EnergySpectrum) -> Option<Self> {
        let whole: f64 = lines.iter().map(|(_, energy)| energy).sum();
        let mut below = 0.0;
        let line = lines.iter().find(|(_, energy)| {
            below += energy;
            below >= ALMOST_ALL * whole
        });
        let highest = line.filter(|_| whole > 0.0)?.0;
        Some(Self { lines, highest })
    }

    /// Frequency (Hz) below which it has almost all (99 %) of the energy of its acceleration.
    pub(crate) fn highest(&self) -> f64 {
        self.highest
    }

    /// Root of the mean of the square of a function of frequency (Hz), weighted by the energy of acceleration and by that of
    /// velocity, over the frequencies below which it has almost all of the first.
    pub(crate) fn root_mean_squares(&self, of: impl Fn(f64) -> f64) -> [f64; 2] {
        let of_velocity = |frequency: f64| {
            if frequency > 0.0 {
                frequency.powi(-2)
            } else {
                0.0
            }
        };
        [
            self.root_mean_square(&of, |_| 1.0),
            self.root_mean_square(&of, of_velocity),
        ]
    }

    fn root_mean_square(&self, of: impl Fn(f64) -> f64, weight: impl Fn(f64) -> f64) -> f64 {
        let (mut sum, mut whole) = (0.0, 0.0);
        let within = (self.lines.iter()).take_while(|(frequency, _)| *frequency <= self.highest);
        for &(frequency, energy) in within {
            let energy = energy * weight(frequency);
            sum += energy * of(frequency).powi(2);
            whole += energy;
        }
        (sum / whole.max(f64::MIN_POSITIVE)).sqrt()
    }
}

impl Scene {
    /// The spectrum of the incident field at the middle of the top of the mesh; `None` without a field.
    ///
    /// # Errors
    /// A field that cannot be evaluated there.
    pub fn incident_spectrum(&self) -> Result<Option<EnergySpectrum>, Error> {
        let Some(field) = self.field() else {
            return Ok(None);
        };
        let (low, high) = self.mesh().bounding_box();
        let middle = (low + high) / 2.0;
        let point = Vec3::new(middle.x, middle.y, high.z);
        // Of a field that is given at stations, that next to it.
        let distance = |station: &&Vec3| (**station - point).norm();
        let stations = field.stations().unwrap_or_default().iter();
        let nearest = stations.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let sampler = field.prepare(&[*nearest.unwrap_or(&point)])?;
        let run = self.duration();
        let fading = LEAST_FADING.max(FADING_SHARE * run);
        let interval = (run + fading) / INSTANTS as f64;
        let velocities: Vec<Vec3> = (0..=INSTANTS)
            .map(|instant| {
                let mut motion = [FieldMotion::default()];
                let time = self.start_time() + instant as f64 * interval;
                sampler.add_motion(time, &mut motion);
                motion[0].velocity
            })
            .collect();
        let within = (run / interval) as usize;
        if velocities[..=within].iter().all(|v| *v == Vec3::zeros()) {
            return Ok(Some(vec![(0.0, 0.0)]));
        }
        let mut spectrum = Vec::new();
        for axis in 0..3 {
            let accelerations = velocities.windows(2).enumerate().map(|(instant, pair)| {
                let taper = (instant as f64 * interval - run).max(0.0) / fading;
                let left = 0.5 * (1.0 + (core::f64::consts::PI * taper).cos());
                left * (pair[1][axis] - pair[0][axis]) / interval
            });
            let history = TimeHistory::new(interval, accelerations.collect());
            let history = history.map_err(powerhouse_model::ModelError::from)?;
            let lines = history.fourier_spectrum();
            spectrum.resize(lines.len(), (0.0, 0.0));
            for (sum, line) in spectrum.iter_mut().zip(lines) {
                *sum = (line.frequency, sum.1 + line.amplitude * line.amplitude);
            }
        }
        Ok(Some(spectrum))
    }

    /// Names and spectra of the records.
    pub fn record_spectra(&self) -> impl Iterator<Item = (&str, EnergySpectrum)> {
        self.records().iter().map(|(name, history)| {
            let lines = history.fourier_spectrum().into_iter();
            let energy = lines.map(|line| (line.frequency, line.amplitude * line.amplitude));
            (name.as_str(), energy.collect())
        })
    }

    /// The spectrum of the input with the highest frequencies: the incident field, or of a scene without one its records;
    /// `None` without motion.
    ///
    /// # Errors
    /// As [`incident_spectrum`](Self::incident_spectrum).
    pub(crate) fn input_spectrum(&self) -> Result<Option<InputSpectrum>, Error> {
        let mut spectra: Vec<EnergySpectrum> = self.incident_spectrum()?.into_iter().collect();
        if spectra.is_empty() {
            spectra = self
                .record_spectra()
                .map(|(_, spectrum)| spectrum)
                .collect();
        }
        let moving = spectra.into_iter().filter_map(InputSpectrum::new);
        Ok(moving.max_by(|a, b| a.highest.total_cmp(&b.highest)))
    }
}
