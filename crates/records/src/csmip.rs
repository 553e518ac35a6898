//! Volumes 1 and 2 of the California Strong Motion Instrumentation Program (CSMIP, CDMG; `.v1`, `.v2`), and of others
//! that use them: lines of text, integers, reals, then blocks of samples behind a line that describes them; channels
//! one after the other.

use crate::channel::{
    Channel, Fields, behind, contains, find, first_behind, leading, missing, numbers, whole,
};
use crate::{AccelerationUnit, RecordError, RecordFault};

pub(crate) const NAME: &str = "CSMIP volume 1 or 2";

pub(crate) fn recognises(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default();
    let title = contains(first, "corrected accelerogram");
    title && text.lines().take(80).any(|line| block(line).is_some())
}

/// What the line above a block says.
struct Block<'t> {
    is_acceleration: bool,
    count: f64,
    step: f64,
    /// Text behind the step.
    rest: &'t str,
}

/// Reads `15050 points of accel data equally spaced at  .020 sec, in cm/sec2. (8f10.6)` (volume 2) or `13200
/// Accelerogram points at 200 pts/sec in units of g .  Format: (8f9.6)` (volume 1).
fn block(line: &str) -> Option<Block<'_>> {
    if !line.trim_start().starts_with(|c: char| c.is_ascii_digit()) || !contains(line, "points") {
        return None;
    }
    let (count, words) = leading(line)?;
    let is_acceleration = contains(words, "accel");
    if let Some((step, rest)) = behind(words, "equally spaced at").and_then(leading) {
        let rest = contains(rest, "sec").then_some(rest)?;
        return Some(Block {
            is_acceleration,
            count,
            step,
            rest,
        });
    }
    let (rate, rest) = behind(words, "points at").and_then(leading)?;
    let is_rate = contains(rest, "pts/sec") && rate > 0.0;
    is_rate.then_some(Block {
        is_acceleration,
        count,
        step: 1.0 / rate,
        rest,
    })
}

/// Unit that a text names behind `in` or `units`.
fn unit(text: &str) -> Option<AccelerationUnit> {
    let words = |key| behind(text, key).and_then(|text| text.split_whitespace().next());
    let of_word = |word: &str| AccelerationUnit::from_name(word.trim_end_matches(['.', ',', ')']));
    ["units of ", "units:", " in "]
        .into_iter()
        .filter_map(words)
        .find_map(of_word)
}

pub(crate) fn channels(text: &str) -> Result<Vec<Channel>, RecordError> {
    let lines: Vec<&str> = text.lines().collect();
    let mut channels = Vec::new();
    let mut header = 0;
    let mut at = 0;
    while let Some(line) = lines.get(at) {
        if line.starts_with("/&") || contains(line, "end of data for chan") {
            header = at + 1;
        }
        let Some(found) = block(line) else {
            at += 1;
            continue;
        };
        let count = whole(at + 1, found.count)?;
        let fields = Fields::of_format(found.rest);
        // The line of the next block starts with a number, too.
        let next = lines
            .iter()
            .skip(at + 1)
            .position(|line| block(line).is_some());
        let next = next.map_or(lines.len(), |offset| at + 1 + offset);
        let (samples, end) = numbers(&lines[..next], at + 1, fields, None)?;
        if found.is_acceleration {
            let above = &lines[header..at];
            let peak_line = above
                .iter()
                .find(|line| contains(line, "peak acceleration"));
            let of_peak = peak_line.and_then(|line| leading(behind(line, "=")?));
            let by_peak = of_peak
                .and_then(|(_, unit)| AccelerationUnit::from_name(unit.split_whitespace().next()?));
            let unit = unit(found.rest).or(by_peak);
            let unit = unit.ok_or_else(|| RecordError::content(at + 1, 0, RecordFault::NoUnit))?;
            channels.push(Channel {
                line: at + 1,
                step: found.step,
                unit,
                count,
                peak: of_peak.map(|(peak, _)| peak.abs()),
                samples,
                ..described(above)
            });
        } else if samples.len() as u64 != count {
            let (declared, found) = (count, samples.len());
            return Err(RecordError::content(
                at + 1,
                0,
                RecordFault::Count { declared, found },
            ));
        }
        at = end;
    }
    if channels.is_empty() {
        return Err(missing(1, "points of accel data"));
    }
    Ok(channels)
}

/// Component, station, event and time of a channel, from its lines of text.
fn described(header: &[&str]) -> Channel {
    let text = |key: &str| first_behind(header, key).unwrap_or_default();
    let component = header.iter().find_map(|line| {
        let (_, name) = behind(line, "chan ")?.split_once(':')?;
        Some(
            name.split("  ")
                .find(|part| !part.trim().is_empty())?
                .trim(),
        )
    });
    let component = component.unwrap_or_default();
    let degrees = component.strip_suffix("Deg").unwrap_or(component);
    let station = find(header, 0, "station no.").or(find(header, 0, "station id."));
    let name = station
        .and_then(|at| header.get(at + 1))
        .map_or("", |line| line);
    let name = name.trim().split("  ").next().unwrap_or_default();
    let record = header
        .iter()
        .find(|line| contains(line, "record of") || contains(line, "rcrd of"));
    let event = record.map_or("", |line| {
        line.trim().split("  ").next().unwrap_or_default()
    });
    Channel {
        component: degrees.trim().into(),
        station: name.into(),
        event: event.into(),
        start: text("start time:")
            .split("  ")
            .next()
            .unwrap_or_default()
            .into(),
        ..Channel::default()
    }
}
