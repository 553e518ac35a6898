//! Records that are scaled or matched to the spectrum of a code.

use powerhouse_scene::{Fault, Problem, RecordSpectrumReport};
use powerhouse_wavefield::{
    Asce7, ChineseSite, DesignSpectrum, Eurocode8, Eurocode8Ground, Eurocode8Type, MatchReport,
    Nb35047, SpectralBand, TimeHistory, WaveError, characteristic_period,
};

use super::{one_of, ordered};
use crate::spec::{
    At, Ground8, NonNegative, Positive, Record, RecordSpectrum, SceneSpec, Share, Site,
    SpectrumMeans, Target,
};

/// Damping ratio of a spectrum that names none.
const DAMPING: f64 = 0.05;
/// Distance of the ratio of spectra from 1 at which wavelets are enough.
const TOLERANCE: f64 = 0.05;

/// History of a part of a record that has been scaled, and for a horizontal one what wavelets did.
type Matched = (TimeHistory, Option<MatchReport>);

/// Spectrum of a record's table with its band; none where it has no such key.
pub(super) struct SpectrumOfRecord<'t> {
    table: &'t At<RecordSpectrum>,
    target: DesignSpectrum,
    band: SpectralBand,
}

impl<'t> SpectrumOfRecord<'t> {
    pub(super) fn of(table: &'t Record) -> Result<Option<Self>, Fault> {
        let Some(spectrum) = &table.spectrum else {
            return Ok(None);
        };
        if table.peak.is_some() {
            return Err(one_of(
                spectrum.span(),
                &["peak", "spectrum"],
                &[true, true],
            ));
        }
        let [shortest, longest] = spectrum.periods.map(Positive::get);
        ordered(spectrum.periods.span(), [shortest, longest])?;
        Ok(Some(Self {
            table: spectrum,
            target: design_spectrum(&spectrum.target)?,
            band: SpectralBand {
                shortest,
                longest,
                tolerance: spectrum.tolerance.map_or(TOLERANCE, Share::get),
            },
        }))
    }

    /// Whether wavelets are added to the record.
    pub(super) fn has_wavelets(&self) -> bool {
        self.table.by == SpectrumMeans::Wavelets
    }

    fn refused(&self, error: WaveError) -> Fault {
        Fault::refused(self.table.periods.span(), error)
    }

    /// The parts of a record, before their baselines are corrected: all have one factor, and the horizontal ones are matched by
    /// wavelets. `None` for each where the record gets a factor alone, which it gets afterwards.
    pub(super) fn matched<'p>(
        &self,
        parts: impl ExactSizeIterator<Item = (&'p str, &'p TimeHistory)> + Clone,
    ) -> Result<Vec<Option<Matched>>, Fault> {
        if !self.has_wavelets() {
            return Ok(vec![None; parts.len()]);
        }
        let factor = self.common_factor(parts.clone())?;
        let count = parts.len();
        let part = |(name, history): (&str, &TimeHistory)| {
            let matched = if is_horizontal(name, count) {
                let matched = history.matched_to_spectrum(&self.target, &self.band);
                matched.map(|(matched, report)| (matched, Some(report)))
            } else {
                history.scaled(factor).map(|scaled| (scaled, None))
            };
            matched.map(Some).map_err(|error| self.refused(error))
        };
        parts.map(part).collect()
    }

    /// A record whose match has been spoilt by the correction of its baseline, matched again; `None` where the spectrum is within the
    /// tolerance.
    pub(super) fn matched_again(
        &self,
        history: &TimeHistory,
    ) -> Result<Option<(TimeHistory, MatchReport)>, Fault> {
        let refused = |error| self.refused(error);
        let misfit = history.misfit(&self.target, &self.band).map_err(refused)?;
        let is_reached = misfit.worst() <= self.band.tolerance;
        let matched = || history.matched_to_spectrum(&self.target, &self.band);
        (!is_reached).then(matched).transpose().map_err(refused)
    }

    /// Factor for all parts of a record whose baselines are corrected: 1 where wavelets have been added.
    pub(super) fn factor<'p>(
        &self,
        parts: impl ExactSizeIterator<Item = (&'p str, &'p TimeHistory)>,
    ) -> Result<f64, Fault> {
        match self.table.by {
            SpectrumMeans::Factor => self.common_factor(parts),
            SpectrumMeans::Wavelets => Ok(1.0),
        }
    }

    /// Factor that brings the horizontal parts, taken together, to the spectrum.
    fn common_factor<'p>(
        &self,
        parts: impl ExactSizeIterator<Item = (&'p str, &'p TimeHistory)>,
    ) -> Result<f64, Fault> {
        let count = parts.len();
        let horizontal = parts.filter(|(name, _)| is_horizontal(name, count));
        let histories: Vec<&TimeHistory> = horizontal.map(|(_, history)| history).collect();
        TimeHistory::factor_to_spectrum(&histories, &self.target, &self.band)
            .map_err(|error| self.refused(error))
    }

    /// What is said of the processed record.
    pub(super) fn report(
        &self,
        history: &TimeHistory,
        factor: f64,
        wavelets: Option<MatchReport>,
    ) -> Result<RecordSpectrumReport, Fault> {
        let misfit = history.misfit(&self.target, &self.band);
        let motion = history.report();
        Ok(RecordSpectrumReport {
            target: self.target.clone(),
            band: [self.band.shortest, self.band.longest],
            misfit: misfit.map_err(|error| self.refused(error))?,
            factor: wavelets.map_or(factor, |report| report.factor),
            arias: history.arias_intensity(),
            motion,
            end: history.acceleration().last().map_or(0.0, |last| last.abs())
                / motion.peak_acceleration,
            wavelets,
        })
    }
}

/// Target spectrum of a record of a scene, by its name, with the band of periods (s).
pub(crate) fn target_spectrum(
    file: &SceneSpec,
    record: &str,
) -> Result<Option<(DesignSpectrum, [f64; 2])>, Fault> {
    let Some(table) = file.records.iter().find(|table| *table.name == *record) else {
        return Ok(None);
    };
    let found = SpectrumOfRecord::of(table)?;
    Ok(found.map(|found| (found.target, [found.band.shortest, found.band.longest])))
}

/// Whether a part of a record of several parts is a horizontal component; a record of one part is taken for one.
fn is_horizontal(name: &str, parts: usize) -> bool {
    parts == 1 || !name.ends_with(".z")
}

/// Spectrum of a table.
fn design_spectrum(target: &At<Target>) -> Result<DesignSpectrum, Fault> {
    let damping = |given: &Option<NonNegative>| given.map_or(DAMPING, NonNegative::get);
    let refused = |error: WaveError| Fault::refused(target.span(), error);
    let spectrum = match &**target {
        Target::Eurocode8 {
            r#type,
            ground,
            peak,
            damping_ratio,
        } => DesignSpectrum::eurocode_8(&Eurocode8 {
            kind: match **r#type {
                1 => Eurocode8Type::One,
                2 => Eurocode8Type::Two,
                found => {
                    let (found, expected) = (found.to_string(), "1 or 2".into());
                    return Err(Fault::new(
                        r#type.span(),
                        Problem::Value { found, expected },
                    ));
                }
            },
            ground: match ground {
                Ground8::A => Eurocode8Ground::A,
                Ground8::B => Eurocode8Ground::B,
                Ground8::C => Eurocode8Ground::C,
                Ground8::D => Eurocode8Ground::D,
                Ground8::E => Eurocode8Ground::E,
            },
            peak: peak.get(),
            damping: damping(damping_ratio),
        }),
        Target::Nb35047 {
            peak,
            amplification,
            characteristic_period: period,
            zone,
            site,
            damping_ratio,
        } => {
            let characteristic_period = match (period, zone, site) {
                (Some(period), None, None) => period.get(),
                (None, Some(zone), Some(site)) => {
                    let site = match site {
                        Site::I0 => ChineseSite::I0,
                        Site::I1 => ChineseSite::I1,
                        Site::II => ChineseSite::II,
                        Site::III => ChineseSite::III,
                        Site::IV => ChineseSite::IV,
                    };
                    characteristic_period(zone.get(), site).map_err(refused)?
                }
                (None, Some(_), None) | (None, None, Some(_)) => {
                    let key = if zone.is_some() { "site" } else { "zone" };
                    let problem = Problem::MissingKey { key: key.into() };
                    return Err(Fault::new(target.span(), problem));
                }
                _ => {
                    let given = [period.is_some(), zone.is_some()];
                    let keys = &["characteristic_period", "zone"];
                    return Err(one_of(target.span(), keys, &given));
                }
            };
            DesignSpectrum::nb_35047(&Nb35047 {
                peak: peak.get(),
                amplification: amplification.get(),
                characteristic_period,
                damping: damping(damping_ratio),
            })
        }
        Target::Asce7 {
            short,
            one_second,
            long_period,
        } => DesignSpectrum::asce_7(&Asce7 {
            short: short.get(),
            one_second: one_second.get(),
            long_period: long_period.get(),
        }),
        Target::Table {
            points,
            damping_ratio,
        } => {
            let points: Vec<(f64, f64)> = points
                .iter()
                .map(|[period, acceleration]| (period.get(), acceleration.get()))
                .collect();
            DesignSpectrum::table("table", damping(damping_ratio), &points)
        }
    };
    spectrum.map_err(refused)
}
