//! COSMOS format (v1.20, 2001): per data set lines of text, integers, reals, comments, and samples behind a line that
//! describes them; several data sets one after the other.

use crate::channel::{
    Channel, Fields, behind, contains, find, first_behind, leading, missing, numbers, whole,
};
use crate::number::{fixed_width, number};
use crate::{AccelerationUnit, RecordError, RecordFault};

pub(crate) const NAME: &str = "COSMOS";

/// Index of the step among the reals (ms), of the peak (in the unit of the samples), and of their number.
const STEP: usize = 61;
const PEAK: usize = 63;
/// A number of the reals that stands for none.
const NONE: f64 = -999.0;

pub(crate) fn recognises(text: &str) -> bool {
    is_title(text.lines().next().unwrap_or_default())
}

/// Whether a line starts a data set, as `Corrected acceleration    (Format v01.20 with 13 text lines)`.
fn is_title(line: &str) -> bool {
    contains(line, "(format v") && contains(line, "text lines")
}

pub(crate) fn channels(text: &str) -> Result<Vec<Channel>, RecordError> {
    let lines: Vec<&str> = text.lines().collect();
    let mut channels = Vec::new();
    let mut other = None;
    let mut at = 0;
    while at < lines.len() {
        if !is_title(lines[at]) {
            let ends = lines[at].trim().is_empty() || contains(lines[at], "end-of-data");
            if !ends {
                let text = lines[at].chars().take(40).collect();
                return Err(RecordError::content(
                    at + 1,
                    0,
                    RecordFault::NotANumber { text },
                ));
            }
            at += 1;
            continue;
        }
        let title = lines[at];
        let (channel, end) = data_set(&lines, at)?;
        if contains(title, "acceleration") {
            channels.push(channel)
        } else {
            other = other.or(Some((at, title.split('(').next().unwrap_or_default())))
        }
        at = end;
    }
    match (channels.is_empty(), other) {
        (true, Some((at, title))) => {
            let found = title.trim().to_lowercase();
            Err(RecordError::content(
                at + 1,
                0,
                RecordFault::Quantity { found },
            ))
        }
        _ => Ok(channels),
    }
}

/// Reads the data set of a title; also returns the index of the line behind it.
fn data_set(lines: &[&str], start: usize) -> Result<(Channel, usize), RecordError> {
    let is_block = |line: &&str| contains(line, " pts, approx") && contains(line, "units=");
    let at = lines.iter().skip(start).position(is_block);
    let at = start + at.ok_or_else(|| missing(start + 1, "points, as `pts, approx`"))?;
    let header = &lines[start..at];
    let line = lines[at];
    let (count, rest) = leading(line).ok_or_else(|| missing(at + 1, "number of points"))?;
    let count = whole(at + 1, count)?;
    let reals = find(header, 0, "real-header values").map(|offset| start + offset);
    let reals = reals.ok_or_else(|| missing(start + 1, "real-header values"))?;
    let mut values = Vec::new();
    let (declared, _) = leading(lines[reals]).unwrap_or_default();
    for (row, line) in lines[..at].iter().enumerate().skip(reals + 1) {
        if values.len() as f64 >= declared {
            break;
        }
        for (column, word) in fixed_width(line) {
            values.push(number(word, row + 1, column)?);
        }
    }
    let real = |index: usize| values.get(index).copied().filter(|value| *value != NONE);
    let step = real(STEP).filter(|step| *step > 0.0);
    let step = step.ok_or_else(|| missing(reals + 1, "real 62, the step in ms"))? / 1000.0;
    // The line of the samples has the duration, too, rounded to seconds.
    let approximate = behind(rest, "approx").and_then(leading);
    let (duration, _) =
        approximate.ok_or_else(|| missing(at + 1, "duration, as `approx N secs`"))?;
    if (count as f64 * step - duration).abs() > 1.0 + step {
        let found = duration / count.max(1) as f64;
        let conflict = RecordFault::StepConflict {
            found,
            declared: step,
        };
        return Err(RecordError::content(at + 1, 0, conflict));
    }
    let unit = behind(line, "units=").unwrap_or_default();
    let unit_name = unit.split(['(', ',']).next().unwrap_or_default().trim();
    let is_acceleration = contains(lines[start], "acceleration");
    let unit = AccelerationUnit::from_name(unit_name);
    if is_acceleration && unit.is_none() {
        let found = unit_name.chars().take(40).collect();
        return Err(RecordError::content(
            at + 1,
            0,
            RecordFault::UnknownUnit { found },
        ));
    }
    let (samples, end) = numbers(lines, at + 1, Fields::of_format(line), None)?;
    if !is_acceleration && samples.len() as u64 != count {
        let (declared, found) = (count, samples.len());
        return Err(RecordError::content(
            at + 1,
            0,
            RecordFault::Count { declared, found },
        ));
    }
    let text = |key: &str| first_behind(header, key).unwrap_or_default();
    let component = text("sta chan")
        .split_once(':')
        .map_or("", |(_, name)| name);
    let component = component.split('(').next().unwrap_or_default().trim();
    let station = text("code:").split("  ").next().unwrap_or_default();
    let channel = Channel {
        line: at + 1,
        component: component
            .strip_suffix("deg")
            .unwrap_or(component)
            .trim()
            .into(),
        station: station.into(),
        event: header.get(1).map_or("", |line| line.trim()).into(),
        start: text("start time:")
            .split('(')
            .next()
            .unwrap_or_default()
            .trim()
            .into(),
        step,
        unit: unit.unwrap_or_default(),
        count,
        peak: real(PEAK).map(f64::abs),
        samples,
        ..Channel::default()
    };
    Ok((channel, end))
}
