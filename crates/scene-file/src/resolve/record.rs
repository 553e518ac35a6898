//! Ground motion records: reading and processing.

use super::draft::Draft;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use powerhouse_records::{
    AccelerationUnit, CountRule, LengthRule, RecordColumns, RecordOptions, common_length,
    read_record,
};
use powerhouse_wavefield::{
    BaselineCorrection, BaselineReport, EndDisplacement, InputConvention, RecordReport,
    RecordSignal, RecordedAt, SurfaceComponent, TimeHistory, WaveError,
};

use super::{one_of, ordered, unique};
use crate::Registry;
use crate::spec::{
    At, Baseline, Component, Convention, Count, Finite, Length, NonNegative, Positive, Record,
    SceneSpec, Share, Units, WaveAxis,
};
use powerhouse_scene::{Fault, Problem, RecordSpectrumReport, Remark, SceneText, remark};

use super::target::SpectrumOfRecord;

/// Processed record, ready for waves and prescribed motions.
pub(super) struct PreparedRecord {
    pub(super) history: TimeHistory,
    /// Its motion.
    signal: Arc<RecordSignal>,
    /// Permanent displacement at the end (m).
    end: f64,
    pub(super) convention: At<Convention>,
    /// Lead (s): extension by a filter before the original start, and at the end.
    pub(super) lead: f64,
    /// Byte range of its name in the scene file.
    pub(super) name: core::ops::Range<usize>,
    pub(super) report: RecordReport,
    pub(super) baseline: Option<BaselineReport>,
    /// Key that fixes a peak that is weak for a design motion.
    pub(super) weak: Option<&'static str>,
    /// Differences of the file from its declaration.
    pub(super) warnings: Vec<String>,
    /// What the file is, and what was concluded from its content; none of a record in memory.
    pub(super) source: Option<String>,
    /// What scaling or matching to a spectrum did.
    pub(super) spectrum: Option<RecordSpectrumReport>,
}

impl PreparedRecord {
    /// Its motion, multiplied by a factor.
    pub(super) fn signal(&self, factor: f64) -> Result<Arc<RecordSignal>, WaveError> {
        if factor == 1.0 {
            return Ok(self.signal.clone());
        }
        let end = EndDisplacement::Declared(factor * self.end);
        Ok(Arc::new(self.history.scaled(factor)?.into_signal(end)?))
    }
}

/// Peak ground acceleration (m/s2) of about 0.1 g below which a record is weak for a design motion, and its peak may be
/// a number of g.
const WEAK_PEAK: f64 = 1.0;
/// Peak (m/s2) below which a record in cm/s2, of which there are many of weak motions, may be one in g.
const WEAK_IN_CENTIMETRES: f64 = 0.02;
/// Share of the largest peak of the components of a record from which on a component counts as the largest.
const ALMOST_ALL: f64 = 0.999_999;

/// Reads and processes all records, by name.
pub(super) fn records(
    text: &SceneText,
    file: &SceneSpec,
    registry: &Registry,
) -> Result<BTreeMap<String, PreparedRecord>, Fault> {
    let mut records = BTreeMap::new();
    for table in &file.records {
        for (name, record) in processed((text, registry), table)? {
            unique(
                "record",
                &At::new(name, table.name.span()),
                &mut records,
                record,
            )?;
        }
    }
    Ok(records)
}

/// Histories of all records, by name.
pub(crate) fn processed_records(
    text: &SceneText,
    file: &SceneSpec,
    registry: &Registry,
) -> Result<BTreeMap<String, TimeHistory>, Fault> {
    let records = records(text, file, registry)?.into_iter();
    Ok(records
        .map(|(name, record)| (name, record.history))
        .collect())
}

/// Processed record of a table, or its components, each with its name.
fn processed(
    source: (&SceneText, &Registry),
    table: &Record,
) -> Result<Vec<(String, PreparedRecord)>, Fault> {
    let name = table.name.span();
    let target = SpectrumOfRecord::of(table)?;
    // Wavelets match a record that has its baseline already, so that little is left to be corrected behind them; a filter
    // comes once.
    let has_wavelets = target.as_ref().is_some_and(SpectrumOfRecord::has_wavelets);
    let is_first = has_wavelets && !correction(&table.baseline).is_filter();
    let mut read = Vec::new();
    for (part, file) in files(source, table)? {
        let source = described(&file);
        let history = TimeHistory::new(file.step, file.samples)
            .map_err(|error| Fault::refused(part.file.span(), error))?;
        let history = cut(table, history)?;
        let (history, baseline) = if is_first {
            corrected(table, history)?
        } else {
            (history, None)
        };
        read.push((part.name, history, (file.warnings, source, baseline)));
    }
    let matched = match &target {
        Some(target) => target.matched(read.iter().map(|(name, history, _)| (&**name, history)))?,
        None => vec![None; read.len()],
    };
    let mut parts = Vec::new();
    for ((name, history, facts), matched) in read.into_iter().zip(matched) {
        let (warnings, source, first) = facts;
        let (history, mut wavelets) = match matched {
            Some((matched, report)) => (matched, report),
            None => (history, None),
        };
        let (mut history, baseline) = corrected(table, history)?;
        let mut baseline = followed(first, baseline);
        // What the correction takes from the match of a short record comes back by further wavelets.
        let target = target.as_ref().filter(|_| first.is_some());
        if let (Some(target), Some(report)) = (target, &mut wavelets) {
            for _ in 1..MOST_MATCHES {
                let Some((matched, again)) = target.matched_again(&history)? else {
                    break;
                };
                let (corrected, next) = corrected(table, matched)?;
                (history, baseline) = (corrected, followed(baseline, next));
                *report = report.followed_by(&again);
            }
        }
        parts.push((name, history, baseline, ((warnings, source), wavelets)));
    }
    let factor = match &target {
        Some(target) => {
            target.factor(parts.iter().map(|(name, history, ..)| (&**name, history)))?
        }
        None => 1.0,
    };
    let peak = |history: &TimeHistory| {
        let samples = history.acceleration().into_iter();
        samples.fold(0.0_f64, |most, a| most.max(a.abs()))
    };
    let present = parts.iter().map(|(_, history, ..)| peak(history));
    let present = present.fold(0.0, f64::max);
    let end = table.end_displacement.map_or(0.0, Finite::get);
    let weak = match (table.peak, table.units) {
        _ if target.is_some() => None,
        (Some(peak), _) => (peak.get() < WEAK_PEAK).then_some("peak"),
        (None, Some(Units::MetrePerSecondSquared)) => (present < WEAK_PEAK).then_some("units"),
        (None, Some(Units::CentimetrePerSecondSquared)) => {
            (present < WEAK_IN_CENTIMETRES).then_some("units")
        }
        (None, _) => None,
    };
    let mut processed = Vec::new();
    for (part, mut history, baseline, ((warnings, source), wavelets)) in parts {
        let refused = |error: WaveError| Fault::refused(name.clone(), error);
        if let Some(peak) = table.peak {
            if present == 0.0 {
                return Err(refused(WaveError::ZeroPeak));
            }
            history = history.scaled(peak.get() / present).map_err(refused)?;
        }
        let spectrum = match &target {
            Some(target) => {
                history = history.scaled(factor).map_err(refused)?;
                Some(target.report(&history, factor, wavelets)?)
            }
            None => None,
        };
        let is_largest = peak(&history) >= table.peak.map_or(present, Positive::get) * ALMOST_ALL;
        let mut end = end;
        if let Some(factor) = table.factor.map(Positive::get) {
            history = history.scaled(factor).map_err(refused)?;
            end *= factor;
        }
        // A record that does not end at rest is rejected here, at its name.
        let signal = history.clone().into_signal(EndDisplacement::Declared(end));
        let signal = signal.map_err(|error| without_rest(name.clone(), error))?;
        let record = PreparedRecord {
            weak: weak.filter(|_| is_largest),
            history,
            name: name.clone(),
            end,
            convention: table.convention.clone(),
            lead: baseline.map_or(0.0, |report: BaselineReport| report.leading_pad),
            report: signal.report(),
            signal: Arc::new(signal),
            baseline,
            warnings,
            source,
            spectrum,
        };
        processed.push((part, record));
    }
    Ok(processed)
}

/// Format, station, component and time of a record, and what was concluded from the content of its file.
fn described(read: &powerhouse_records::Record) -> Option<String> {
    if read.format.is_empty() {
        return None;
    }
    let mut parts = vec![read.format.to_string()];
    let labels = [
        ("station ", &read.station),
        ("component ", &read.component),
        ("event ", &read.event),
        ("from ", &read.start),
    ];
    let given = labels.into_iter().filter(|(_, text)| !text.is_empty());
    parts.extend(given.map(|(label, text)| format!("{label}{text}")));
    parts.push(format!(
        "{} samples at {} s in {}",
        read.samples.len(),
        read.step,
        read.unit.name()
    ));
    parts.extend(read.notes.iter().cloned());
    Some(parts.join("; "))
}

/// File of a record, or a channel of one.
struct Part<'t> {
    name: String,
    file: &'t At<PathBuf>,
    channel: Option<String>,
}

/// Samples of the files of a record, with a common length.
fn files<'t>(
    source: (&SceneText, &Registry),
    table: &'t Record,
) -> Result<Vec<(Part<'t>, powerhouse_records::Record)>, Fault> {
    let name = table.name.to_string();
    let letters = [Component::X, Component::Y, Component::Z].map(Component::letter);
    let of_letters = |span: core::ops::Range<usize>, found: Vec<Part<'t>>| {
        if found.is_empty() {
            Err(Fault::new(span, Problem::MissingKey { key: "x".into() }))
        } else {
            Ok(found)
        }
    };
    let channel = table.channel.as_ref().map(|channel| channel.to_string());
    let parts: Vec<Part> = match (&table.file, &table.components, &table.channels) {
        (Some(_), None, Some(channels)) if channel.is_some() => {
            let keys = &["channel", "channels"];
            return Err(one_of(channels.span(), keys, &[true, true]));
        }
        (Some(file), None, Some(channels)) => {
            let own = [&channels.x, &channels.y, &channels.z];
            let part = |(letter, channel): (char, &Option<String>)| {
                Some(Part {
                    name: format!("{name}.{letter}"),
                    file,
                    channel: Some(channel.clone()?),
                })
            };
            of_letters(
                channels.span(),
                letters.into_iter().zip(own).filter_map(part).collect(),
            )?
        }
        (Some(file), None, None) => {
            if let Some(length) = &table.length {
                let key = "components".into();
                return Err(Fault::new(length.span(), Problem::MissingKey { key }));
            }
            vec![Part {
                name,
                file,
                channel,
            }]
        }
        (None, Some(components), None) => {
            let files = [&components.x, &components.y, &components.z];
            let part = |(letter, file): (char, &'t Option<At<PathBuf>>)| {
                Some(Part {
                    name: format!("{name}.{letter}"),
                    file: file.as_ref()?,
                    channel: channel.clone(),
                })
            };
            of_letters(
                components.span(),
                letters.into_iter().zip(files).filter_map(part).collect(),
            )?
        }
        (file, components, channels) => {
            let given = [file.is_some(), components.is_some()];
            return Err(match (components, channels) {
                (Some(_), Some(channels)) => {
                    one_of(channels.span(), &["components", "channels"], &[true, true])
                }
                _ => one_of(table.name.span(), &["file", "components"], &given),
            });
        }
    };
    let read = parts.iter().map(|part| read(source, table, part));
    let mut read: Vec<powerhouse_records::Record> = read.collect::<Result<_, _>>()?;
    let span = table.components.as_ref().map(At::span);
    if let Some(span) = span.or(table.channels.as_ref().map(At::span)) {
        let rule = match table.length.as_deref() {
            Some(Length::Cut) => LengthRule::Cut,
            Some(Length::Pad) | None => LengthRule::Pad,
        };
        common_length(&mut read, rule).map_err(|e| Fault::refused(span, e))?;
    }
    Ok(parts.into_iter().zip(read).collect())
}

/// Applies the cut.
fn cut(table: &Record, mut history: TimeHistory) -> Result<TimeHistory, Fault> {
    match (&table.cut, &table.taper) {
        (Some(cut), taper) => {
            ordered(cut.span(), cut.map(NonNegative::get))?;
            let (end, length) = (cut[1].get(), history.duration());
            if end > length + 0.5 * history.step() {
                let found = format!("a cut that ends at {end} s");
                let expected = format!("at most {length} s, the end of the record");
                return Err(Fault::new(cut.span(), Problem::Value { found, expected }));
            }
            let taper = taper.as_ref().map_or(0.0, |taper| taper.get());
            history = cut_out(&history, cut.map(NonNegative::get), taper)
                .map_err(|error| Fault::refused(cut.span(), error))?;
        }
        (None, Some(taper)) => {
            let key = "cut".into();
            return Err(Fault::new(taper.span(), Problem::MissingKey { key }));
        }
        (None, None) => {}
    }
    Ok(history)
}

/// Greatest number of times that a record is matched, each time with a correction of its baseline behind it.
const MOST_MATCHES: usize = 6;

/// Report of a correction after earlier ones.
fn followed(
    first: Option<BaselineReport>,
    second: Option<BaselineReport>,
) -> Option<BaselineReport> {
    match (first, second) {
        (Some(first), Some(second)) => Some(first.followed_by(&second)),
        (first, second) => second.or(first),
    }
}

/// Applies the baseline correction.
fn corrected(
    table: &Record,
    history: TimeHistory,
) -> Result<(TimeHistory, Option<BaselineReport>), Fault> {
    match correction(&table.baseline) {
        BaselineCorrection::None => Ok((history, None)),
        correction => {
            let corrected = history.corrected(correction);
            let (history, report) =
                corrected.map_err(|error| Fault::refused(table.baseline.span(), error))?;
            Ok((history, Some(report)))
        }
    }
}

/// Fault of a record that does not end at rest, with the keys that are the ways out.
fn without_rest(name: core::ops::Range<usize>, error: WaveError) -> Fault {
    let help = match error {
        WaveError::EndVelocity { .. } => {
            "`baseline = { kind = \"velocity-polynomial\", order = 5 }` of the record, or another kind"
        }
        WaveError::EndDisplacement { .. } => {
            "`baseline = { kind = \"velocity-polynomial\", order = 5 }` of the record, or `end_displacement` where the ground stays displaced"
        }
        _ => return Fault::refused(name, error),
    };
    Fault::refused(name, error).with_help(help)
}

/// Part of a history between two times (s).
fn cut_out(
    history: &TimeHistory,
    [start, end]: [f64; 2],
    taper: f64,
) -> Result<TimeHistory, WaveError> {
    let first = (start / history.step()).round() as usize;
    let samples = history.acceleration();
    let from_start = samples.get(first..).unwrap_or_default().to_vec();
    TimeHistory::new(history.step(), from_start)?.truncated(end - start, taper)
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

/// Motion that a record of one component represents, for a wave.
pub(super) fn of_component(convention: &At<Convention>) -> Result<InputConvention, Fault> {
    let surface = InputConvention::SurfaceComponent;
    Ok(match &**convention {
        Convention::Incident => InputConvention::Incident,
        Convention::Outcrop => InputConvention::Outcrop,
        Convention::SurfaceAlong | Convention::SurfaceX => surface(SurfaceComponent::X),
        Convention::SurfaceAcross | Convention::SurfaceY => surface(SurfaceComponent::Y),
        Convention::SurfaceZ => surface(SurfaceComponent::Z),
        Convention::Surface => {
            let found = "all components of the surface for a wave".into();
            let expected =
                "`surface-along`, `surface-across` or `surface-z`, or a [[motion]] in place of the wave"
                    .into();
            return Err(Fault::new(
                convention.span(),
                Problem::Value { found, expected },
            ));
        }
        Convention::Within(within) => InputConvention::Within {
            depth: within.depth.get(),
            component: match within.component {
                Some(WaveAxis::Along | WaveAxis::X) => SurfaceComponent::X,
                Some(WaveAxis::Across | WaveAxis::Y) => SurfaceComponent::Y,
                Some(WaveAxis::Z) => SurfaceComponent::Z,
                None => {
                    let key = "component".into();
                    return Err(Fault::new(convention.span(), Problem::MissingKey { key }));
                }
            },
            regularisation: within.regularisation.map(Share::get),
        },
    })
}

/// Place of a record of three components, for a motion.
pub(super) fn of_components(convention: &At<Convention>) -> Result<RecordedAt, Fault> {
    let found = match &**convention {
        Convention::Surface => return Ok(RecordedAt::Surface),
        Convention::Outcrop => return Ok(RecordedAt::Outcrop),
        Convention::Within(within) if within.component.is_none() => {
            return Ok(RecordedAt::Within {
                depth: within.depth.get(),
                regularisation: within.regularisation.map_or(0.05, Share::get),
            });
        }
        Convention::Incident => "an incident wave for a motion",
        _ => "one component for a motion of all components",
    };
    let expected = "`surface`, `outcrop`, or `within` with a depth and without a component";
    let (found, expected) = (found.into(), expected.into());
    Err(Fault::new(
        convention.span(),
        Problem::Value { found, expected },
    ))
}

/// Share of the peak of a record that a baseline correction may change without a warning: that of genuine
/// accelerograms is about 1 % at most.
const LARGE_CORRECTION: f64 = 0.05;

/// Warning about a correction that changes a record more than it does an accelerogram; a filter is meant to.
pub(super) fn large_correction(name: &str, record: &PreparedRecord) -> Option<Remark> {
    let report = record.baseline?;
    let share = report.largest_change / report.before.peak_acceleration;
    (!report.correction.is_filter() && share > LARGE_CORRECTION).then(|| {
        Remark::from(remark::LargeCorrection {
            name: name.into(),
            share,
            drift: report.before.end_displacement,
        })
    })
}

/// Least share of a record's Arias intensity that a run should contain.
const LEAST_SHARE: f64 = 0.95;

/// Warning about a run that ends before most of the Arias intensity of a record has arrived; `arrival` is the time of
/// the first sample (s).
pub(super) fn cut_short(
    name: &str,
    record: &PreparedRecord,
    arrival: f64,
    scene: &Draft,
) -> Option<Remark> {
    let end = scene.start + scene.duration;
    let history = &record.history;
    let share = history.arias_share_before(end - arrival);
    (share < LEAST_SHARE).then(|| {
        Remark::from(remark::TruncatedRecord {
            name: name.into(),
            share,
            run: end,
            record: arrival + history.duration() - record.lead,
        })
    })
}

/// Reads a file of a record, or takes the record in memory that the registry has in its place.
fn read(
    (text, registry): (&SceneText, &Registry),
    table: &Record,
    part: &Part<'_>,
) -> Result<powerhouse_records::Record, Fault> {
    let file = part.file;
    if let Some(history) = registry.record(file) {
        return in_memory(table, file, history);
    }
    let path = text.folder().join(&**file);
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
        channel: part.channel.clone(),
        skip: table.skip.map(|lines| lines as usize),
        columns: table.columns.as_ref().map(|columns| RecordColumns {
            time: columns.time.map(|column| column.get() as usize),
            acceleration: columns.acceleration.get() as usize,
        }),
        values_in_a_row: table.values_in_a_row.map(|values| values.get() as usize),
    };
    read_record(&path, &options).map_err(|error| Fault::refused(file.span(), error))
}

/// A record in memory; keys about the form of a file are refused.
fn in_memory(
    table: &Record,
    file: &At<PathBuf>,
    history: &TimeHistory,
) -> Result<powerhouse_records::Record, Fault> {
    let refused = |text: &str| Err(Fault::refused(file.span(), text));
    if table.time_step.is_some() {
        return refused("`time_step` is about a file; the record is in memory and has its own");
    }
    if !matches!(table.units, None | Some(Units::MetrePerSecondSquared)) {
        return refused("`units` is about a file; the record is in memory, in m/s2");
    }
    Ok(powerhouse_records::Record {
        title: table.name.to_string(),
        step: history.step(),
        samples: history.acceleration(),
        ..powerhouse_records::Record::default()
    })
}
