//! Records from files, treated as their scene says.

use std::collections::BTreeMap;

use powerhouse_io::{AccelerationUnit, CountRule, RecordOptions, read_record};
use powerhouse_wavefield::{
    BaselineCorrection, BaselineReport, EndDisplacement, InputConvention, RecordReport,
    SurfaceComponent, TimeHistory, WaveError,
};

use super::unique;
use crate::fault::{Fault, SceneText};
use crate::format::{
    Baseline, Component, Convention, Count, Finite, NonNegative, Positive, Record, SceneFile,
    Share, Units,
};

/// A record ready to drive waves.
pub(super) struct PreparedRecord {
    pub(super) history: TimeHistory,
    /// Lasting displacement (m).
    pub(super) end: f64,
    pub(super) convention: InputConvention,
    /// Time that the record gained before its former start (s).
    pub(super) lead: f64,
    /// Where its convention stands in the scene file.
    pub(super) place: core::ops::Range<usize>,
    pub(super) report: RecordReport,
    pub(super) baseline: Option<BaselineReport>,
    /// What was taken differently from what the file declares.
    pub(super) doubts: Vec<String>,
}

/// Reads and treats all records, by name.
pub(super) fn records(
    text: &SceneText,
    file: &SceneFile,
) -> Result<BTreeMap<String, PreparedRecord>, Fault> {
    let mut records = BTreeMap::new();
    for table in &file.records {
        let record = record(text, table)?;
        unique("record", &table.name, &mut records, record)?;
    }
    Ok(records)
}

fn record(text: &SceneText, table: &Record) -> Result<PreparedRecord, Fault> {
    let name = table.name.span();
    let (mut history, doubts) = read(text, table)?;
    if let Some(cut) = &table.cut {
        let taper = table.taper.map_or(0.0, NonNegative::get);
        history = cut_out(&history, cut.map(NonNegative::get), taper)
            .map_err(|error| Fault::refused(cut.span(), error))?;
    }
    let mut baseline = None;
    let correction = correction(&table.baseline);
    if correction != BaselineCorrection::None {
        let (corrected, report) = history
            .corrected(correction)
            .map_err(|error| Fault::refused(table.baseline.span(), error))?;
        (history, baseline) = (corrected, Some(report));
    }
    if let Some(peak) = table.peak {
        history = history
            .scaled_to_peak(peak.get())
            .map_err(|error| Fault::refused(name.clone(), error))?;
    }
    let end = table.end_displacement.map_or(0.0, Finite::get);
    // A record that does not come to rest is refused here, where its name stands.
    let signal = history.clone().into_signal(EndDisplacement::Declared(end));
    let report = signal
        .map_err(|error| Fault::refused(name, error))?
        .report();
    Ok(PreparedRecord {
        history,
        end,
        convention: convention(&table.convention),
        lead: baseline.map_or(0.0, |report| report.leading_pad),
        place: table.convention.span(),
        report,
        baseline,
        doubts,
    })
}

/// The part of a history between two times (s).
fn cut_out(
    history: &TimeHistory,
    [start, end]: [f64; 2],
    taper: f64,
) -> Result<TimeHistory, WaveError> {
    let first = (start / history.step()).round() as usize;
    let samples = history.acceleration();
    let from_start = samples.get(first..).unwrap_or_default().to_vec();
    TimeHistory::new(history.step(), from_start)?.first(end - start, taper)
}

fn correction(baseline: &Baseline) -> BaselineCorrection {
    match *baseline {
        Baseline::None => BaselineCorrection::None,
        Baseline::Mean {} => BaselineCorrection::Mean,
        Baseline::AccelerationPolynomial { order } => {
            BaselineCorrection::AccelerationPolynomial { order }
        }
        Baseline::LeastVelocity { order } => BaselineCorrection::LeastVelocity { order },
        Baseline::VelocityPolynomial { order } => BaselineCorrection::VelocityPolynomial { order },
        Baseline::HighPass { corner, order } => BaselineCorrection::HighPass {
            corner: corner.get(),
            order,
        },
    }
}

fn convention(convention: &Convention) -> InputConvention {
    let surface = InputConvention::SurfaceComponent;
    match convention {
        Convention::Incident => InputConvention::Incident,
        Convention::Outcrop => InputConvention::Outcrop,
        Convention::SurfaceX => surface(SurfaceComponent::X),
        Convention::SurfaceY => surface(SurfaceComponent::Y),
        Convention::SurfaceZ => surface(SurfaceComponent::Z),
        Convention::Within(within) => InputConvention::Within {
            depth: within.depth.get(),
            component: match within.component {
                Component::X => SurfaceComponent::X,
                Component::Y => SurfaceComponent::Y,
                Component::Z => SurfaceComponent::Z,
            },
            regularisation: within.regularisation.map_or(0.05, Share::get),
        },
    }
}

/// Reads a record's file; what was taken differently from what it declares comes beside it.
fn read(text: &SceneText, table: &Record) -> Result<(TimeHistory, Vec<String>), Fault> {
    let path = text.folder().join(&*table.file);
    let options = RecordOptions {
        unit: table.units.map(|units| match units {
            Units::MetrePerSecondSquared => AccelerationUnit::MetrePerSecondSquared,
            Units::CentimetrePerSecondSquared => AccelerationUnit::Gal,
            Units::Gravity => AccelerationUnit::Gravity,
        }),
        step: table.time_step.map(Positive::get),
        count: match table.count {
            Count::AsDeclared => CountRule::AsDeclared,
            Count::AsFound => CountRule::AsFound,
        },
    };
    let place = table.file.span();
    let record =
        read_record(&path, &options).map_err(|error| Fault::refused(place.clone(), error))?;
    let history = TimeHistory::new(record.step, record.samples)
        .map_err(|error| Fault::refused(place, error))?;
    Ok((history, record.warnings))
}
