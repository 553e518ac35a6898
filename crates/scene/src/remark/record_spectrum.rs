//! Spectra to which records were scaled or matched.

use core::fmt;

use powerhouse_wavefield::{DesignSpectrum, MatchReport, RecordReport, SpectralMisfit};

/// Scaling or matching of a record to the spectrum of a code.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordSpectrumReport {
    /// The spectrum.
    pub target: DesignSpectrum,
    /// Shortest and longest period (s) of the band.
    pub band: [f64; 2],
    /// Ratio of the spectrum of the processed record to the target.
    pub misfit: SpectralMisfit,
    /// Factor by which the record was multiplied.
    pub factor: f64,
    /// Arias intensity of the processed record (m/s).
    pub arias: f64,
    /// Peaks and end values of the processed record.
    pub motion: RecordReport,
    /// Acceleration at the end of the processed record over its peak (1).
    pub end: f64,
    /// What wavelets changed, before the baseline was corrected; none where the record got a factor alone.
    pub wavelets: Option<MatchReport>,
}

impl RecordSpectrumReport {
    /// Whether a factor is beyond 4, or wavelets changed the Arias intensity to more than its double or less than its half or are off
    /// by more than a tenth, or leave more than that of the peak at the end.
    pub(super) fn is_warning(&self) -> bool {
        let far = !(0.25..=4.0).contains(&self.factor);
        let forced = self
            .wavelets
            .as_ref()
            .is_some_and(|report| !(0.5..=2.0).contains(&(report.arias[1] / report.arias[0])));
        far || forced || (self.wavelets.is_some() && self.is_off())
    }

    /// Whether the processed record is off its target by more than a tenth, or ends with more than that of its peak.
    fn is_off(&self) -> bool {
        self.misfit.worst() > 0.1 || self.end > 0.1
    }
}

impl fmt::Display for RecordSpectrumReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [shortest, longest] = self.band;
        write!(
            f,
            "spectrum of {}, damping {}, {shortest} to {longest} s: factor {:.4}, ratio {:.3} in the mean, {:.3} to {:.3}",
            self.target.name(),
            self.target.damping(),
            self.factor,
            self.misfit.mean,
            self.misfit.least,
            self.misfit.greatest
        )?;
        let Some(report) = &self.wavelets else {
            return Ok(());
        };
        let (before, after) = (&report.motion_before, &self.motion);
        write!(
            f,
            "; wavelets took the ratio from {:.3} to {:.3}, the peaks from {:.3} to {:.3} m/s2, {:.4} to {:.4} m/s, {:.4} to {:.4} m, the Arias intensity from {:.3} to {:.3} m/s, by up to {:.0} % of the peak; before the last correction of the baseline it ends at {:.1e} m/s, {:.1e} m",
            report.before.least,
            report.before.greatest,
            before.peak_acceleration,
            after.peak_acceleration,
            before.peak_velocity,
            after.peak_velocity,
            before.peak_displacement,
            after.peak_displacement,
            report.arias[0],
            self.arias,
            100.0 * report.changed,
            report.motion_after.end_velocity,
            report.motion_after.end_displacement
        )?;
        if self.end > 0.1 {
            write!(
                f,
                "; it ends with {:.0} % of its peak acceleration",
                100.0 * self.end
            )?;
        }
        if self.is_off() {
            f.write_str(
                "; a longer record, a narrower band of periods or `by = \"factor\"` leave wavelets more room, or need none",
            )?;
        }
        Ok(())
    }
}
