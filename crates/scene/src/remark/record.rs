//! Remarks about records and their use as waves.

use powerhouse_model::Vec3;
use powerhouse_wavefield::{BaselineReport, InputConversion, RecordReport, SplitReport, WaveKind};

use super::{Item, Kind, LARGE_MISFIT, RecordSpectrumReport};
use crate::Topic;

/// Standard gravity (m/s2).
const STANDARD_GRAVITY: f64 = 9.806_65;
/// Peak ground acceleration above which the unit is probably wrong (m/s2).
const LARGE_PEAK: f64 = 1.5 * STANDARD_GRAVITY;
/// Condition number of the split of a motion above which it is warned of.
const LARGE_CONDITION: f64 = 5.0;

/// Fact: peaks of a processed ground motion record; a warning if its peak acceleration is above 1.5 g.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Name of the record.
    pub name: String,
    /// Peaks and end values of the processed record.
    pub report: RecordReport,
    /// Report of the baseline correction, before the record was scaled.
    pub baseline: Option<BaselineReport>,
}

impl Item for Record {
    fn kind(&self) -> Kind {
        Kind::warning_if(self.report.peak_acceleration > LARGE_PEAK, Topic::Input)
    }
    fn text(&self) -> String {
        let (name, report) = (&self.name, &self.report);
        let mut text = format!(
            "record '{name}': PGA {:.3} m/s2 ({:.3} g), PGV {:.4} m/s, PGD {:.4} m; ends at {:.2e} m/s, {:.2e} m",
            report.peak_acceleration,
            report.peak_acceleration / STANDARD_GRAVITY,
            report.peak_velocity,
            report.peak_displacement,
            report.end_velocity,
            report.end_displacement
        );
        if report.peak_acceleration > LARGE_PEAK {
            text += ", which hardly any record has ever reached: check the unit of the record";
        }
        if let Some(baseline) = &self.baseline {
            text += &format!(
                "; baseline correction {} changed it by at most {:.2e} m/s2, before it ended at {:.2e} m/s, {:.2e} m",
                baseline.correction.name(),
                baseline.largest_change,
                baseline.before.end_velocity,
                baseline.before.end_displacement
            );
            let pad = baseline.leading_pad;
            if pad > 0.0 {
                text += &format!("; the filter extends it by {pad:.3} s before its original start");
            }
        }
        text
    }
}

remark! {
    /// Fact: format, station, component and time of a record, and what was concluded from the content of its file.
    pub struct RecordSource {
        /// Name of the record.
        pub name: String,
        /// The facts, in words.
        pub source: String,
    }
    Fact(Input),
    "record '{name}': {source}"
}

remark! {
    /// Warning: a record file was read differently from its declaration, as with another number of samples.
    pub struct RecordFile {
        /// Name of the record.
        pub name: String,
        /// Difference from the declaration, in words.
        pub warning: String,
    }
    Warning(Input),
    "record '{name}': {warning}"
}

/// Fact: the spectrum to which a record was scaled or matched, and how near it came; a warning where the factor is beyond 4 or
/// wavelets changed the record much.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordSpectrum {
    /// Name of the record.
    pub name: String,
    /// What was reached.
    pub report: Box<RecordSpectrumReport>,
}

impl Item for RecordSpectrum {
    fn kind(&self) -> Kind {
        Kind::warning_if(self.report.is_warning(), Topic::Input)
    }
    fn text(&self) -> String {
        format!("record '{}': {}", self.name, self.report)
    }
}

remark! {
    /// Warning: the baseline correction changes a record more than it does an accelerogram.
    pub struct LargeCorrection {
        /// Name of the record.
        pub name: String,
        /// Largest change of the acceleration over its peak.
        pub share: f64,
        /// Displacement at the end before the correction (m).
        pub drift: f64,
    }
    Warning(Input),
    "record '{name}': the baseline correction changes it by {:.0} % of its peak, and takes an end displacement of {drift:.3} m, where it is about 1 % of accelerograms: it may be a velocity or a displacement, have another time step or an offset of the instrument",
    100.0 * share
}

/// Warning: the peak of a record is weak for a design motion, so that its unit is probably another one.
#[derive(Clone, Debug, PartialEq)]
pub struct WeakRecord {
    /// Name of the record.
    pub name: String,
    /// Peak acceleration of the processed record (m/s2).
    pub peak: f64,
    /// Key that fixes the peak: `peak`, or `units` of the file.
    pub key: &'static str,
}

impl Item for WeakRecord {
    fn kind(&self) -> Kind {
        Kind::Warning(Topic::Input)
    }
    fn text(&self) -> String {
        let Self { name, peak, key } = self;
        let shown = |value: f64| (1e4 * value).round() / 1e4;
        let way = match *key {
            "peak" => format!(
                "`peak` is in m/s2, and {} g would be {:.3}",
                shown(*peak),
                peak * STANDARD_GRAVITY
            ),
            _ => "if the file is in g, give `units = \"g\"`".to_owned(),
        };
        format!(
            "record '{name}': its peak of {} m/s2 (by the key `{key}`) is {:.3} g, weak for a design motion; {way}",
            shown(*peak),
            peak / STANDARD_GRAVITY
        )
    }
}

/// Fact: conversion of a record whose convention is not `incident` to the incident wave.
#[derive(Clone, Debug, PartialEq)]
pub struct Conversion {
    /// Name of the wave.
    pub wave: String,
    /// Convention of the record: type of the recorded motion.
    pub convention: &'static str,
    /// Factor, or regularised division by the transfer function.
    pub conversion: InputConversion,
}

impl Item for Conversion {
    fn kind(&self) -> Kind {
        Kind::Fact(Topic::Input)
    }
    fn text(&self) -> String {
        let (wave, convention) = (&self.wave, self.convention);
        let Some(within) = &self.conversion.within else {
            return format!(
                "{wave}: the incident wave is {:.4} of its record ({convention})",
                self.conversion.amplitude.norm()
            );
        };
        let how = match within.regularisation {
            0.0 => "exactly".into(),
            share => format!("with a regularisation of {share}"),
        };
        format!(
            "{wave}: the incident wave was computed from its record ({convention}) by a transfer function, {how}, with a misfit of {:.2e} of the record; its peak is {:.3} of that of the record, and the transfer function is at least {:.3} in the frequency range of the record",
            within.misfit, within.amplification, within.least_transfer
        )
    }
}

/// Fact: a recorded motion was split into incident waves; a warning if their condition number is above 5, or their
/// sum misses the record by more than 1 % of its peak acceleration.
#[derive(Clone, Debug, PartialEq)]
pub struct Split {
    /// Name of the record.
    pub record: String,
    /// Types of the waves, and their angles of incidence (degrees).
    pub waves: Vec<(WaveKind, f64)>,
    /// Azimuth of the waves (degrees).
    pub azimuth: f64,
    /// Quality of the split.
    pub report: SplitReport,
    /// The record's point (m).
    pub place: Vec3,
    /// Time at which the record begins there (s).
    pub arrival: f64,
    /// Letters of the components that do not move.
    pub still: String,
}

impl Item for Split {
    fn kind(&self) -> Kind {
        Kind::warning_if(
            self.report.condition > LARGE_CONDITION || self.report.misfit > LARGE_MISFIT,
            Topic::Input,
        )
    }
    fn text(&self) -> String {
        let (record, report, place, arrival) =
            (&self.record, &self.report, self.place, self.arrival);
        let waves = self.waves.iter();
        let waves: Vec<String> = waves.map(|(k, a)| format!("{k} at {a:.4}")).collect();
        let [least, most] = report.band;
        let mut text = format!(
            "record '{record}' is split into {} degrees, azimuth {:.4}: condition number at most {:.2} between {least} and {most} Hz, at {:.3} Hz; their sum is the record at ({:.3}, {:.3}, {:.3}) m, from {arrival:.3} s on, to {:.1e} of its peak acceleration, and their largest peak is {:.3} of it",
            waves.join(", "),
            self.azimuth,
            report.condition,
            report.frequency,
            place.x,
            place.y,
            place.z,
            report.misfit,
            report.amplification
        );
        if !self.still.is_empty() {
            let letters: Vec<String> = self.still.chars().map(String::from).collect();
            text += &format!("; nothing moves along {}", letters.join(" and "));
        }
        text
    }
}

remark! {
    /// Warning: a record is declared along x or y of a wave whose azimuth is not 0, so that these axes are not those
    /// of the mesh.
    pub struct RotatedAxis {
        /// Name of the record.
        pub record: String,
        /// Convention (or component of a within motion) given in the scene.
        pub convention: &'static str,
        /// Name in the coordinates of the wave that has the same meaning without this warning.
        pub clear: &'static str,
        /// Azimuth of the wave (degrees).
        pub azimuth: f64,
    }
    Warning(Input),
    "record '{record}' has the convention '{convention}' in a wave of azimuth {azimuth} degrees: this component is along or across the direction of travel, not along an axis of the mesh; '{clear}' is the same without this warning"
}

remark! {
    /// Warning: the run ends before 95 % of the Arias intensity of a record of the waves has arrived.
    pub struct TruncatedRecord {
        /// Name of the record.
        pub name: String,
        /// Share of the Arias intensity that arrives before the end of the run, 0 to 0.95.
        pub share: f64,
        /// Time at the end of the run (s).
        pub run: f64,
        /// Time at the end of the record (s), its arrival included, without the extension by a filter.
        pub record: f64,
    }
    Warning(Input),
    "the run ends at {run:.3} s, before record '{name}' ends at {record:.3} s: only {:.1} % of its Arias intensity arrives before",
    100.0 * share
}

remark! {
    /// Warning: a record is used by no wave or prescribed motion.
    pub struct UnusedRecord {
        /// Name of the record.
        pub name: String,
    }
    Warning(Input),
    "record '{name}' is used by no wave and no prescribed motion"
}
