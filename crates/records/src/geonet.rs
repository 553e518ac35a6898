//! Volumes 1 and 2 of GeoNet (New Zealand; `.V1A`, `.V2A`): per component 16 lines of text, 4 of integers, 6 of
//! reals, and blocks of acceleration, velocity and displacement in ten columns of eight characters.

use crate::channel::{
    Channel, Fields, behind, contains, declared, first_behind, leading, missing, numbers,
};
use crate::{AccelerationUnit, RecordError, RecordFault};

pub(crate) const NAME: &str = "GeoNet volume 1 or 2";

/// Lines of text, of integers and of reals.
const TEXT: usize = 16;
const INTEGERS: usize = 4;
const REALS: usize = 6;
const WIDTH: Fields = Fields::Width(8);

pub(crate) fn recognises(text: &str) -> bool {
    let mut lines = text.lines();
    let first = lines.next().unwrap_or_default();
    contains(first, "corrected accelerogram")
        && lines.next().is_some_and(|line| line.starts_with("Site "))
        && lines.take(TEXT).any(|line| contains(line, "mm/s/s"))
}

pub(crate) fn channels(text: &str) -> Result<Vec<Channel>, RecordError> {
    let lines: Vec<&str> = text.lines().collect();
    let mut channels = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        if lines[at].trim().is_empty() {
            at += 1;
            continue;
        }
        let (channel, end) = component(&lines, at)?;
        channels.push(channel);
        at = end;
    }
    Ok(channels)
}

fn component(lines: &[&str], start: usize) -> Result<(Channel, usize), RecordError> {
    let header = lines.get(start..start + TEXT).unwrap_or_default();
    if !header
        .first()
        .is_some_and(|line| contains(line, "accelerogram"))
    {
        return Err(missing(start + 1, "component"));
    }
    let value = |key| declared(header, start, key);
    let (_, points) = value("Number of points")?;
    let unit = AccelerationUnit::MillimetrePerSecondSquared;
    let raw = first_behind(header, "in units of");
    if let Some((_, found)) = raw.and_then(leading)
        && !found.starts_with("mm/s/s")
    {
        let found = found.chars().take(40).collect();
        return Err(RecordError::content(
            start + 1,
            0,
            RecordFault::UnknownUnit { found },
        ));
    }
    let scale = raw.and_then(leading).map(|(scale, _)| scale);
    let step = header.iter().find_map(|line| {
        let text = behind(line, "intervals of");
        let before = || behind(line, " at ").filter(|_| contains(line, "sec intervals"));
        leading(text.or_else(before)?).map(|(step, _)| step)
    });
    let step = step.ok_or_else(|| missing(start + 1, "intervals"))?;
    let integers = start + TEXT;
    let (counts, behind_integers) = numbers(lines, integers + 3, WIDTH, Some(10))?;
    let [acceleration, velocity, displacement] = match counts[..] {
        [_, _, _, a, v, d, ..] if behind_integers == integers + INTEGERS => [a, v, d],
        _ => return Err(missing(integers + 1, "numbers of samples")),
    };
    if acceleration != points {
        let (declared, found) = (points.max(0.0) as u64, acceleration.max(0.0) as usize);
        return Err(RecordError::content(
            integers + 4,
            0,
            RecordFault::Count { declared, found },
        ));
    }
    let mut at = integers + INTEGERS + REALS;
    let line = at;
    let mut blocks = Vec::new();
    for count in [acceleration, velocity, displacement] {
        let count = crate::channel::whole(integers + 4, count)?;
        let (samples, end) = numbers(lines, at, WIDTH, Some(count))?;
        if samples.len() as u64 != count && !blocks.is_empty() {
            let (declared, found) = (count, samples.len());
            return Err(RecordError::content(
                at + 1,
                0,
                RecordFault::Count { declared, found },
            ));
        }
        blocks.push((count, samples));
        at = end;
    }
    let (count, samples) = blocks.swap_remove(0);
    // Rows behind the last block are samples that no count declares.
    let (surplus, end) = numbers(lines, at, WIDTH, None)?;
    if !surplus.is_empty() {
        let (declared, found) = (count, samples.len() + surplus.len());
        return Err(RecordError::content(
            at + 1,
            0,
            RecordFault::Count { declared, found },
        ));
    }
    let text = |key: &str| first_behind(header, key).unwrap_or_default();
    let first_word = |text: &str| {
        text.split_whitespace()
            .next()
            .unwrap_or_default()
            .to_string()
    };
    let channel = Channel {
        line,
        component: first_word(text("Component ")),
        station: first_word(text("Site ")),
        event: header[8].trim().into(),
        start: header[7].split_whitespace().collect::<Vec<_>>().join(" "),
        step,
        unit,
        scale: scale.filter(|scale| *scale != 1.0),
        count,
        peak: behind(text("Acceleration:"), "peak")
            .and_then(leading)
            .map(|(peak, _)| peak.abs()),
        samples,
        ..Channel::default()
    };
    Ok((channel, end))
}
