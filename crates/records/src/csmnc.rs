//! Text format of the China Strong Motion Network Center (CSMNC): lines of text, then samples in rows.

use crate::channel::{
    Channel, Fields, behind, contains, declared, find, first_behind, leading, missing, numbers,
    whole,
};
use crate::unit::always_gal;
use crate::{RecordError, RecordFault};

pub(crate) const NAME: &str = "CSMNC text";

/// Lines among which the header is.
const HEADER: usize = 20;
/// The line of the header that has the number of samples and the step.
const POINTS: &str = "NO. OF POINTS:";

pub(crate) fn recognises(text: &str) -> bool {
    let mut header = text.lines().take(HEADER);
    header.any(|line| contains(line, POINTS) && contains(line, "INTERVALS OF"))
}

pub(crate) fn channels(text: &str) -> Result<Vec<Channel>, RecordError> {
    let lines: Vec<&str> = text.lines().collect();
    let header = &lines[..HEADER.min(lines.len())];
    let (line, count) = declared(header, 0, POINTS)?;
    let (_, step) = declared(header, 0, "INTERVALS OF")?;
    let unit_line = find(header, 0, "UNIT:").ok_or_else(|| missing(1, "UNIT"))?;
    let (before, unit) = header[unit_line].split_at(header[unit_line].find("UNIT:").unwrap_or(0));
    let at = |fault| RecordError::content(unit_line + 1, 0, fault);
    if !contains(before, "ACCELERATION") {
        let found = before.trim().to_lowercase();
        return Err(at(RecordFault::Quantity { found }));
    }
    let unit = behind(unit, "UNIT:").unwrap_or_default();
    let word = unit.split_whitespace().next().unwrap_or_default();
    let unit = always_gal(word, unit).map_err(at)?;
    // Lines of words follow the count, then the samples.
    let is_row = |row: &&str| {
        let start = row.trim_start();
        start.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
    };
    let start = lines
        .iter()
        .skip(line)
        .position(is_row)
        .map_or(lines.len(), |at| line + at);
    // The title of another record may start with a number.
    if let Some(second) = find(&lines, start, POINTS) {
        let last = (start..second)
            .rev()
            .find(|&at| is_row(&lines[at]))
            .unwrap_or(start);
        let fault = RecordFault::SecondRecord { last: last + 1 };
        return Err(RecordError::content(second + 1, 0, fault));
    }
    let (samples, end) = numbers(&lines, start, Fields::Separated, None)?;
    crate::nothing_follows(&lines, end, |_| false)?;
    let text = |key: &str| first_behind(header, key).unwrap_or_default();
    let word = |key: &str| {
        text(key)
            .split_whitespace()
            .next()
            .unwrap_or_default()
            .to_string()
    };
    let before_event = text("PRE-EVENT TIME:").trim();
    let time = lines.get(1).map_or("", |line| line.trim());
    Ok(vec![Channel {
        line,
        component: word("COMP."),
        station: word("STATION:"),
        event: lines.get(2).map_or("", |line| line.trim()).into(),
        start: format!("{time} less {before_event}"),
        step,
        unit,
        count: whole(line, count)?,
        peak: leading(text("PEAK VALUE:")).map(|(peak, _)| peak.abs()),
        samples,
        ..Channel::default()
    }])
}
