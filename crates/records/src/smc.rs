//! SMC format of the U. S. Geological Survey: 11 lines of text, 48 integers, 50 reals, comments, samples in cm/s2.

use crate::channel::{Channel, Fields, first_behind, missing, numbers, whole};
use crate::{AccelerationUnit, RecordError, RecordFault};

pub(crate) const NAME: &str = "USGS SMC";

/// Lines of text, of integers and of reals.
const LINES: [usize; 3] = [11, 6, 10];
/// A number of the reals that stands for none.
const NO_REAL: f64 = 1e38;

pub(crate) fn recognises(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default();
    let kind = first.trim_start();
    let of_kinds = [
        "1 UNCORRECTED",
        "2 CORRECTED",
        "3 VELOCITY",
        "4 DISPLACEMENT",
        "5 RESPONSE",
    ];
    of_kinds.iter().any(|start| kind.starts_with(start))
        && text
            .lines()
            .nth(1)
            .is_some_and(|line| line.starts_with('*'))
}

pub(crate) fn channels(text: &str) -> Result<Vec<Channel>, RecordError> {
    let lines: Vec<&str> = text.lines().collect();
    let title = lines[0].trim();
    if !title.contains("ACCELEROGRAM") {
        let found = title.get(2..).unwrap_or_default().to_lowercase();
        return Err(RecordError::content(1, 0, RecordFault::Quantity { found }));
    }
    let [text_lines, integer_lines, real_lines] = LINES;
    let (integers, behind_integers) = numbers(&lines, text_lines, Fields::Width(10), Some(48))?;
    let (reals, mut at) = numbers_of_reals(&lines, behind_integers)?;
    if integers.len() != 48 || behind_integers != text_lines + integer_lines {
        return Err(missing(text_lines + 1, "48 integers"));
    }
    if reals.len() != 50 || at != behind_integers + real_lines {
        return Err(missing(behind_integers + 1, "50 reals"));
    }
    while lines.get(at).is_some_and(|line| line.starts_with('|')) {
        at += 1;
    }
    let line = text_lines + 3;
    let count = whole(line, integers[16])?;
    let rate = reals[1];
    if !(rate > 0.0 && rate < NO_REAL) {
        return Err(missing(behind_integers + 1, "samples per second"));
    }
    let (samples, end) = numbers(&lines, at, Fields::Width(10), None)?;
    crate::nothing_follows(&lines, end, |line| line.contains("ACCELEROGRAM"))?;
    let extremes = [reals[29], reals[31]].map(f64::abs).into_iter();
    let of_text = |key| first_behind(&lines[..text_lines], key);
    let station = of_text("station =").unwrap_or_default();
    let component = of_text("component=").unwrap_or_default();
    Ok(vec![Channel {
        line,
        component: component.into(),
        station: station
            .split("component=")
            .next()
            .unwrap_or_default()
            .trim()
            .into(),
        event: lines[3].split_whitespace().collect::<Vec<_>>().join(" "),
        start: start(&integers),
        step: 1.0 / rate,
        unit: AccelerationUnit::Gal,
        count,
        peak: extremes.filter(|peak| *peak < NO_REAL).reduce(f64::max),
        samples,
        ..Channel::default()
    }])
}

/// The reals, of which those that stand for none are not fillers of samples.
fn numbers_of_reals(lines: &[&str], from: usize) -> Result<(Vec<f64>, usize), RecordError> {
    let mut found = Vec::new();
    let end = (from + LINES[2]).min(lines.len());
    for (at, line) in lines[..end].iter().enumerate().skip(from) {
        for (column, word) in crate::number::fixed_width(line) {
            found.push(crate::number::number(word, at + 1, column)?);
        }
    }
    Ok((found, end))
}

/// Year, day of the year and time of the first sample.
fn start(integers: &[f64]) -> String {
    let part = |index: usize| integers.get(index).copied().filter(|value| *value >= 0.0);
    match (part(1), part(2), part(3), part(4)) {
        (Some(year), Some(day), Some(hour), Some(minute)) => {
            let seconds = part(5).unwrap_or(0.0) + part(6).unwrap_or(0.0) / 1000.0;
            format!("{year} day {day}, {hour}:{minute:02}:{seconds:06.3}")
        }
        _ => String::new(),
    }
}
