//! Channels of a file of an agency, and the choice of one.

use crate::number::{fixed_width, number};
use crate::{
    AccelerationUnit, CountRule, Record, RecordError, RecordFault, RecordOptions, check_step,
};

/// Relative excess of the peak of the samples over that of the header from which on samples are damaged.
const PEAK: f64 = 0.02;

/// One component in a file, in the unit of the file.
#[derive(Debug, Default)]
pub(crate) struct Channel {
    /// Number of the line that declares the samples, from 1.
    pub(crate) line: usize,
    pub(crate) component: String,
    pub(crate) station: String,
    pub(crate) event: String,
    pub(crate) start: String,
    /// Step (s).
    pub(crate) step: f64,
    pub(crate) unit: AccelerationUnit,
    /// Factor of the samples to the unit; `None` is 1.
    pub(crate) scale: Option<f64>,
    /// Whether the offset of the instrument is a part of the samples.
    pub(crate) has_offset: bool,
    /// Declared number of samples.
    pub(crate) count: u64,
    /// Declared greatest absolute value in the unit.
    pub(crate) peak: Option<f64>,
    pub(crate) samples: Vec<f64>,
}

/// How the numbers of a row are separated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fields {
    /// By blanks, commas or signs.
    Separated,
    /// Likewise, and of integers of which each may be a sample.
    Counts,
    /// By their width.
    Width(usize),
}

impl Fields {
    /// Width of the numbers of a format of Fortran in brackets, such as `(8f10.6)` or `(1E15.6)`.
    pub(crate) fn of_format(line: &str) -> Self {
        let inner = line.rfind('(').map_or("", |at| &line[at..]);
        let letter = |c: char| "fFeEiIdDgG".contains(c);
        let width = inner.rfind(letter).and_then(|at| {
            let digits = &inner[at + 1..];
            let end = digits
                .find(|c: char| !c.is_ascii_digit())
                .unwrap_or(digits.len());
            digits[..end].parse().ok()
        });
        match width {
            Some(width @ 1..=40) => Self::Width(width),
            _ => Self::Separated,
        }
    }

    /// Numbers of a row with their columns, from 1.
    fn of_row(self, row: &str) -> Vec<(usize, &str)> {
        let Self::Width(width) = self else {
            return fixed_width(row);
        };
        let row = row.trim_end();
        if !row.is_ascii() {
            return vec![(1, row)];
        }
        let starts = (0..row.len()).step_by(width);
        starts
            .map(|start| (start + 1, row[start..(start + width).min(row.len())].trim()))
            .collect()
    }
}

/// Whether a row may start with a number.
fn is_numeric(row: &str) -> bool {
    let start = row.trim_start();
    start.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) && !start.starts_with("--")
}

/// Numbers of the rows from line `from` (index) on, up to one that does not start with a number or, if there is a
/// limit, to the row that contains the last of that many; and the index of the line behind them.
pub(crate) fn numbers(
    lines: &[&str],
    from: usize,
    fields: Fields,
    limit: Option<u64>,
) -> Result<(Vec<f64>, usize), RecordError> {
    let mut found = Vec::new();
    let mut at = from;
    while let Some(row) = lines.get(at) {
        if !is_numeric(row) || limit.is_some_and(|limit| found.len() as u64 >= limit) {
            break;
        }
        for (column, word) in fields.of_row(row) {
            found.push(match fields {
                Fields::Counts => number(word, at + 1, column)?,
                _ => sample(word, at + 1, column)?,
            });
        }
        at += 1;
    }
    Ok((found, at))
}

/// Parses a sample; a number of nines that stands for a missing one is refused.
pub(crate) fn sample(word: &str, line: usize, column: usize) -> Result<f64, RecordError> {
    let value = number(word, line, column)?;
    let digits = word.trim_start_matches(['+', '-']);
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    let nines = |text: &str| text.bytes().all(|byte| byte == b'9');
    let filled = part.bytes().all(|byte| byte == b'0') || nines(part);
    let decimals = if nines(part) { part.len() } else { 0 };
    let is_filler = whole.len() >= 4 && nines(whole) && filled && whole.len() + decimals >= 5;
    if is_filler || value.abs() > 1e30 {
        let text = word.into();
        return Err(RecordError::content(
            line,
            column,
            RecordFault::Filler { text },
        ));
    }
    Ok(value)
}

/// Index of the first line from `from` on that contains a text, in capitals or small letters.
pub(crate) fn find(lines: &[&str], from: usize, text: &str) -> Option<usize> {
    let found = lines
        .iter()
        .skip(from)
        .position(|line| contains(line, text));
    found.map(|offset| from + offset)
}

/// Whether a line contains a text, in capitals or small letters.
pub(crate) fn contains(line: &str, text: &str) -> bool {
    position(line, text).is_some()
}

fn position(line: &str, text: &str) -> Option<usize> {
    let (line, text) = (line.as_bytes(), text.as_bytes());
    line.windows(text.len())
        .position(|part| part.eq_ignore_ascii_case(text))
}

/// Text behind a key in a line, trimmed.
pub(crate) fn behind<'t>(line: &'t str, key: &str) -> Option<&'t str> {
    let at = position(line, key)? + key.len();
    line.get(at..).map(str::trim)
}

/// Text behind a key in the first of some lines that has it, trimmed.
pub(crate) fn first_behind<'t>(lines: &[&'t str], key: &str) -> Option<&'t str> {
    lines.iter().find_map(|line| behind(line, key))
}

/// First number of a text, with its unit behind it.
pub(crate) fn leading(text: &str) -> Option<(f64, &str)> {
    let text = text.trim_start_matches(|c: char| c.is_whitespace() || c == '=' || c == ':');
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)));
    let (mut word, _) = text.split_at(end.unwrap_or(text.len()));
    word = word.trim_end_matches(['e', 'E', '+', '-']);
    let value = number(word, 0, 0).ok()?;
    Some((value, text[word.len()..].trim_start()))
}

/// The error of a header that declares no such quantity.
pub(crate) fn missing(line: usize, what: &'static str) -> RecordError {
    RecordError::content(line, 0, RecordFault::Header { what })
}

/// Number behind a key in some of the lines, or the error that it is missing.
pub(crate) fn declared(
    lines: &[&str],
    first: usize,
    key: &'static str,
) -> Result<(usize, f64), RecordError> {
    for (offset, line) in lines.iter().enumerate() {
        if let Some((value, _)) = behind(line, key).and_then(leading) {
            return Ok((first + offset + 1, value));
        }
    }
    Err(missing(first + 1, key))
}

/// A declared count as an integer.
pub(crate) fn whole(line: usize, value: f64) -> Result<u64, RecordError> {
    let text = value.to_string();
    let whole = value >= 0.0 && value.fract() == 0.0 && value <= 9e15;
    let fault = || RecordError::content(line, 0, RecordFault::NotANumber { text });
    whole.then_some(value as u64).ok_or_else(fault)
}

/// The channel that the options name, as a record.
pub(crate) fn record(
    format: &'static str,
    channels: Vec<Channel>,
    options: &RecordOptions,
) -> Result<Record, RecordError> {
    let count = channels.len();
    let all = channels.iter().enumerate();
    let names: Vec<String> = all
        .map(|(at, c)| format!("{} ({})", at + 1, c.component))
        .collect();
    let wrong = |fault| RecordError::content(0, 0, fault);
    let index = match &options.channel {
        None if count == 1 => 0,
        None => {
            let channels = names.join(", ");
            return Err(wrong(RecordFault::Channels { channels }));
        }
        Some(wanted) => {
            let number = wanted
                .parse()
                .ok()
                .filter(|number| (1..=count).contains(number));
            let named = |channel: &Channel| channel.component.eq_ignore_ascii_case(wanted.trim());
            let mut of_name = (0..count).filter(|&at| named(&channels[at]));
            let by_name = of_name.next().filter(|_| of_name.next().is_none());
            number
                .map(|number: usize| number - 1)
                .or(by_name)
                .ok_or_else(|| {
                    let (wanted, channels) = (wanted.clone(), names.join(", "));
                    wrong(RecordFault::NoSuchChannel { wanted, channels })
                })?
        }
    };
    // Damage of another channel is damage of the file.
    for channel in &channels {
        let found = channel.samples.len();
        if found as u64 != channel.count && options.count == CountRule::AsDeclared {
            let declared = channel.count;
            let mismatch = RecordFault::Count { declared, found };
            return Err(RecordError::content(channel.line, 0, mismatch));
        }
    }
    let mut notes = Vec::new();
    if count > 1 {
        notes.push(format!("channel {} of {count}", names[index]));
    }
    let channel = channels.into_iter().nth(index).unwrap_or_default();
    converted(format, channel, options, notes)
}

/// Samples of a channel in m/s2, compared with what the header and the caller declare.
fn converted(
    format: &'static str,
    mut channel: Channel,
    options: &RecordOptions,
    mut notes: Vec<String>,
) -> Result<Record, RecordError> {
    let at = |fault| RecordError::content(channel.line, 0, fault);
    check_step(channel.step).map_err(at)?;
    if let Some(declared) = options.unit
        && declared != channel.unit
    {
        let (found, declared) = (channel.unit.name(), declared.name());
        return Err(at(RecordFault::UnitConflict { found, declared }));
    }
    let found = channel.step;
    if let Some(declared) = options.step
        && (declared - found).abs() > 1e-6 * found
    {
        return Err(at(RecordFault::StepConflict { found, declared }));
    }
    let mut warnings = Vec::new();
    if channel.samples.len() as u64 != channel.count {
        let mismatch = RecordFault::Count {
            declared: channel.count,
            found: channel.samples.len(),
        };
        warnings.push(mismatch.to_string());
    }
    let mut samples = std::mem::take(&mut channel.samples);
    if let Some(scale) = channel.scale {
        samples.iter_mut().for_each(|value| *value *= scale);
    }
    let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
    let largest = |offset: f64| {
        samples
            .iter()
            .fold(0.0_f64, |most, a| most.max((a - offset).abs()))
    };
    if let Some(declared) = channel.peak.filter(|peak| *peak > 0.0) {
        // A header may have the peak before or behind the subtraction of the offset.
        let peaks = [largest(0.0), largest(mean)];
        let near = |found: &f64| (found - declared).abs() <= PEAK * declared + 1e-3;
        let found = if channel.has_offset {
            peaks[1]
        } else {
            peaks[0]
        };
        let unit = channel.unit.name();
        if !peaks.iter().any(near) {
            let mismatch = RecordFault::Peak {
                declared,
                found,
                unit,
            };
            if found > declared {
                return Err(at(mismatch));
            } else {
                warnings.push(mismatch.to_string())
            }
        }
    }
    if channel.has_offset {
        let unit = channel.unit.name();
        notes.push(format!(
            "the mean of {mean:.4} {unit}, the offset of the instrument, is subtracted"
        ));
        samples.iter_mut().for_each(|value| *value -= mean);
    }
    let factor = channel.unit.factor();
    samples.iter_mut().for_each(|value| *value *= factor);
    let parts = [&channel.event, &channel.station, &channel.component];
    let title = parts.iter().filter(|part| !part.is_empty());
    Ok(Record {
        format,
        title: title
            .map(|part| part.as_str())
            .collect::<Vec<_>>()
            .join("; "),
        station: channel.station,
        event: channel.event,
        component: channel.component,
        start: channel.start,
        unit: channel.unit,
        step: channel.step,
        samples,
        notes,
        warnings,
    })
}
