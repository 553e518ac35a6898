//! Response spectra of a set of records, and the one to which they are brought.

use core::fmt;

use powerhouse::model::ModelError;
use powerhouse::wavefield::{DesignSpectrum, TimeHistory, WaveError};
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::rounded::rounded;

/// Damping ratio of the oscillators of a set without a target.
const DAMPING: f64 = 0.05;
/// Shortest and longest period (s) of the spectra.
const PERIODS: [f64; 2] = [0.04, 4.0];
/// Number of periods, at equal ratios.
const COUNT: usize = 61;
/// Shares of the Arias intensity between which the significant duration is.
const SIGNIFICANT: [f64; 2] = [0.05, 0.95];

/// Response spectra of the records of a set at scale 1, with their peaks, intensities and durations. Of two horizontal components
/// values are geometric means, durations the longer ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SetSpectra {
    /// Number of horizontal components of each record; zero in statistics that were written before they had it.
    #[serde(default)]
    pub components: usize,
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
        let mut most = 0;
        let records = records.map(|(name, scale, components)| -> Result<_, WaveError> {
            most = most.max(components.len());
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
        let records = records.map_err(refused)?;
        Ok(Self {
            components: most,
            damping,
            records,
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

    /// Least and greatest ratio of the mean of the records to the target within its band; none without a target, or where it is not
    /// defined in the band.
    #[must_use]
    pub fn fit(&self) -> Option<[FitAtPeriod; 2]> {
        let target = self.target.as_ref()?;
        let [from, to] = target.band;
        let count = self.records.len() as f64;
        let all = self.periods.iter().zip(&target.accelerations).enumerate();
        let in_band = all.filter(|(_, (period, _))| (from..=to).contains(*period));
        let fits = in_band.filter_map(|(index, (&period, target))| {
            let own = self
                .records
                .iter()
                .map(|record| record.accelerations[index]);
            let ratio = own.sum::<f64>() / count / (*target)?;
            ratio.is_finite().then_some(FitAtPeriod { period, ratio })
        });
        let by_ratio = |a: &FitAtPeriod, b: &FitAtPeriod| a.ratio.total_cmp(&b.ratio);
        let least = fits.clone().min_by(by_ratio)?;
        Some([least, fits.max_by(by_ratio)?])
    }
}

/// Mean of the spectra of records over the target at a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitAtPeriod {
    /// Period (s).
    pub period: f64,
    /// Mean pseudo-acceleration of the records over that of the target (1).
    pub ratio: f64,
}

/// The fit of the records of a set to their target, in a sentence; empty without a target.
impl fmt::Display for SetSpectra {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Some(target), Some([least, greatest])) = (&self.target, self.fit()) else {
            return Ok(());
        };
        let [from, to] = target.band.map(rounded);
        let of = match self.components {
            2 => " (of two components the geometric mean)",
            _ => "",
        };
        write!(
            f,
            "mean of the spectra of {} records{of} over that of {}, from {from} to {to} s: {} at {} s to {} at {} s",
            self.records.len(),
            target.name,
            rounded(least.ratio),
            rounded(least.period),
            rounded(greatest.ratio),
            rounded(greatest.period),
        )
    }
}
