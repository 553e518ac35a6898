//! Response spectra of a set of records, and the one to which they are brought.

use powerhouse::model::ModelError;
use powerhouse::wavefield::{DesignSpectrum, TimeHistory, WaveError};
use serde::{Deserialize, Serialize};

use crate::StudyError;

/// Damping ratio of the oscillators of a set without a target.
const DAMPING: f64 = 0.05;
/// Shortest and longest period (s) of the spectra.
const PERIODS: [f64; 2] = [0.04, 4.0];
/// Number of periods, at equal ratios.
const COUNT: usize = 61;
/// Shares of the Arias intensity between which the significant duration is.
const SIGNIFICANT: [f64; 2] = [0.05, 0.95];

/// Response spectra of the records of a set at scale 1, with their peaks, intensities and durations. Of two horizontal components values are
/// geometric means.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SetSpectra {
    /// Damping ratio of the oscillators.
    pub damping: f64,
    /// Periods (s).
    pub periods: Vec<f64>,
    /// Records in the order of their names.
    pub records: Vec<SpectrumOfRecord>,
    /// Spectrum to which the records are brought, if any.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub target: Option<TargetSpectrum>,
}

/// Response spectrum of a record of a set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpectrumOfRecord {
    /// Name of the record.
    pub record: String,
    /// Pseudo-accelerations at the periods (m/s2).
    pub accelerations: Vec<f64>,
    /// Peak acceleration (m/s2).
    pub peak: f64,
    /// Arias intensity (m/s).
    pub arias: f64,
    /// Time from 5 to 95 % of it (s).
    pub duration: f64,
}

/// Spectrum to which the records of a set are brought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetSpectrum {
    /// Name of the code or table.
    pub name: String,
    /// Shortest and longest period of the band (s).
    pub band: [f64; 2],
    /// Pseudo-accelerations at the periods of the set (m/s2); none where it is not defined.
    pub accelerations: Vec<Option<f64>>,
}

impl SetSpectra {
    /// Spectra of records, each a name, a scale and its horizontal components at that scale.
    pub(super) fn of<'r>(
        records: impl Iterator<Item = (&'r str, f64, Vec<&'r TimeHistory>)>,
        target: Option<&(DesignSpectrum, [f64; 2])>,
    ) -> Result<Self, StudyError> {
        let [shortest, longest] = PERIODS;
        let share = |index: usize| index as f64 / (COUNT - 1) as f64;
        let period = |index: usize| shortest * (longest / shortest).powf(share(index));
        let periods: Vec<f64> = (0..COUNT).map(period).collect();
        let damping = target.map_or(DAMPING, |(target, _)| target.damping());
        let records = records.map(|(name, scale, components)| -> Result<_, WaveError> {
            let share = 1.0 / components.len().max(1) as f64;
            let mean = |of: &dyn Fn(&TimeHistory) -> f64| {
                let product: f64 = components.iter().map(|history| of(history)).product();
                product.powf(share)
            };
            let mut accelerations = vec![1.0; COUNT];
            for history in &components {
                let spectrum = history.response_spectrum(damping, &periods);
                for (product, of) in accelerations.iter_mut().zip(spectrum?) {
                    *product *= of.pseudo_acceleration();
                }
            }
            let [from, to] = SIGNIFICANT;
            let mut duration = 0.0_f64;
            for history in &components {
                duration = duration.max(history.significant_duration(from, to)?);
            }
            Ok(SpectrumOfRecord {
                record: name.into(),
                accelerations: accelerations
                    .iter()
                    .map(|a| a.powf(share) / scale)
                    .collect(),
                peak: mean(&|history| history.report().peak_acceleration) / scale,
                arias: mean(&TimeHistory::arias_intensity) / (scale * scale),
                duration,
            })
        });
        let records = records.collect::<Result<_, WaveError>>();
        let refused = |error| powerhouse::Error::from(ModelError::from(error));
        Ok(Self {
            damping,
            records: records.map_err(refused)?,
            target: target.map(|(target, band)| TargetSpectrum {
                name: target.name().into(),
                band: *band,
                accelerations: periods
                    .iter()
                    .map(|&period| target.acceleration(period))
                    .collect(),
            }),
            periods,
        })
    }
}
