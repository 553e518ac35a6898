//! PEER's AT2 format, whose header has several layouts.

use crate::channel::sample;
use crate::number::{fixed_width, number};
use crate::{
    AccelerationUnit, CountRule, Record, RecordError, RecordFault, RecordOptions, check_step,
};

/// Number of lines that are searched for `NPTS`.
const HEADER_LINES: usize = 12;

/// Content of the header.
pub(crate) struct Header {
    /// Index of the line with the count.
    line: usize,
    count: u64,
    step: f64,
    unit: Option<AccelerationUnit>,
    title: String,
}

/// Finds the header, if there is one: a line among the first twelve with `NPTS`, either as
/// `NPTS= 4000, DT= .005 SEC` or as `4000 .005 NPTS, DT`. Comments belong to columns of text.
pub(crate) fn header(text: &str) -> Result<Option<Header>, RecordError> {
    let mut above = Vec::new();
    for (line, content) in text.lines().take(HEADER_LINES).enumerate() {
        let upper = content.to_ascii_uppercase();
        let comment = upper.starts_with(['#', '%']);
        if comment || !upper.contains("NPTS") {
            above.push(content.trim());
            continue;
        }
        let missing = |what| RecordError::content(line + 1, 0, RecordFault::Header { what });
        let (count, step) = match (assigned(&upper, "NPTS"), assigned(&upper, "DT")) {
            (Some(count), Some(step)) => (count, step),
            (Some(_), None) => return Err(missing("DT")),
            _ => {
                let mut numbers = upper
                    .split([' ', '\t', ','])
                    .filter(|word| word.starts_with(|c: char| c.is_ascii_digit() || c == '.'));
                let count = numbers.next().ok_or_else(|| missing("NPTS"))?;
                (count, numbers.next().ok_or_else(|| missing("DT"))?)
            }
        };
        let count = count
            .trim_end_matches('.')
            .parse()
            .map_err(|_| RecordError::content(line + 1, 0, not_a_number(count)))?;
        let step = number(step, line + 1, 0)?;
        check_step(step).map_err(|fault| RecordError::content(line + 1, 0, fault))?;
        let unit = unit(&above)?;
        above.retain(|line| !line.is_empty());
        return Ok(Some(Header {
            line,
            count,
            step,
            unit,
            title: above.join("; "),
        }));
    }
    Ok(None)
}

fn not_a_number(text: &str) -> RecordFault {
    RecordFault::NotANumber {
        text: text.chars().take(40).collect(),
    }
}

/// Number after `KEY =`.
fn assigned<'a>(upper: &'a str, key: &str) -> Option<&'a str> {
    let behind = upper[upper.find(key)? + key.len()..].trim_start();
    let value = behind.strip_prefix('=')?.trim_start();
    let end = value.find(|c: char| !(c.is_ascii_digit() || "+-.ED".contains(c)));
    Some(&value[..end.unwrap_or(value.len())]).filter(|value| !value.is_empty())
}

/// Unit that the first lines of the file declare, if they do.
fn unit(lines: &[&str]) -> Result<Option<AccelerationUnit>, RecordError> {
    for (line, content) in lines.iter().enumerate() {
        let upper = content.to_ascii_uppercase();
        for key in ["UNITS OF ", "UNITS: "] {
            let Some(offset) = upper.find(key) else {
                continue;
            };
            let behind = &upper[offset + key.len()..];
            let word = behind.trim_start().split([' ', ',', ';']).next();
            let word = word.unwrap_or_default().trim_matches(['(', ')', '.']);
            return AccelerationUnit::from_name(word).map(Some).ok_or_else(|| {
                let found = word.chars().take(40).collect();
                RecordError::content(line + 1, offset + 1, RecordFault::UnknownUnit { found })
            });
        }
    }
    Ok(None)
}

/// Whether a line starts with a word, and no line after it starts with a number.
fn is_last(text: &str, line: usize) -> bool {
    let starts_with_number = |content: &str| {
        let words = fixed_width(content);
        words
            .first()
            .is_some_and(|&(column, word)| number(word, 0, column).is_ok())
    };
    !text.lines().skip(line).any(starts_with_number)
}

/// Refuses a second header in the lines behind the samples.
fn check_trailer(text: &str, line: usize) -> Result<(), RecordError> {
    let is_header = |content: &str| content.to_ascii_uppercase().contains("NPTS");
    match text.lines().skip(line).position(is_header) {
        Some(offset) => {
            let second = RecordFault::SecondRecord { last: line };
            Err(RecordError::content(line + offset + 1, 0, second))
        }
        None => Ok(()),
    }
}

/// Reads the samples after the header.
pub(crate) fn read(
    text: &str,
    header: &Header,
    options: &RecordOptions,
) -> Result<Record, RecordError> {
    let line = header.line + 1;
    let fault = |fault| RecordError::content(line, 0, fault);
    let unit = match (header.unit, options.unit) {
        (Some(found), Some(declared)) if found != declared => {
            return Err(fault(RecordFault::UnitConflict {
                found: found.name(),
                declared: declared.name(),
            }));
        }
        (found, declared) => found
            .or(declared)
            .ok_or_else(|| fault(RecordFault::NoUnit))?,
    };
    if let Some(declared) = options.step
        && (declared - header.step).abs() > 1e-6 * header.step
    {
        return Err(fault(RecordFault::StepConflict {
            found: header.step,
            declared,
        }));
    }
    let mut samples = Vec::new();
    'lines: for (line, content) in text.lines().enumerate().skip(header.line + 1) {
        for (column, word) in fixed_width(content) {
            match sample(word, line + 1, column) {
                Ok(value) => samples.push(value * unit.factor()),
                // Words after the last sample are a trailer.
                Err(_) if samples.len() as u64 >= header.count => {
                    check_trailer(text, line)?;
                    break 'lines;
                }
                Err(_) if options.count == CountRule::AsFound && is_last(text, line) => {
                    break 'lines;
                }
                Err(error) => return Err(error),
            }
        }
    }
    let mut warnings = Vec::new();
    if samples.len() as u64 != header.count {
        let mismatch = RecordFault::Count {
            declared: header.count,
            found: samples.len(),
        };
        match options.count {
            CountRule::AsDeclared => return Err(fault(mismatch)),
            CountRule::AsFound => warnings.push(mismatch.to_string()),
        }
    }
    Ok(Record {
        format: "PEER AT2",
        title: header.title.clone(),
        unit,
        step: header.step,
        samples,
        warnings,
        ..Record::default()
    })
}
