//! ASCII format of K-NET and KiK-net (NIED, Japan): a header of lines with a key in 18 columns, then counts.

use crate::channel::{Channel, Fields, contains, first_behind, leading, missing, numbers, whole};
use crate::number::number;
use crate::{AccelerationUnit, RecordError, RecordFault};

pub(crate) const NAME: &str = "K-NET or KiK-net ASCII";

/// Lines of the header.
const HEADER: usize = 17;

pub(crate) fn recognises(text: &str) -> bool {
    let mut lines = text.lines();
    lines
        .next()
        .is_some_and(|line| line.starts_with("Origin Time"))
        && lines
            .take(HEADER)
            .any(|line| line.starts_with("Sampling Freq"))
}

pub(crate) fn channels(text: &str) -> Result<Vec<Channel>, RecordError> {
    let lines: Vec<&str> = text.lines().collect();
    let header = &lines[..HEADER.min(lines.len())];
    let value = |key: &'static str| {
        let found = header
            .iter()
            .zip(1..)
            .find(|(line, _)| line.starts_with(key));
        let (line, number) = found.ok_or_else(|| missing(1, key))?;
        Ok((number, line.get(18..).unwrap_or_default().trim()))
    };
    let quantity = |key: &'static str| {
        let (line, text) = value(key)?;
        let (value, unit) = leading(text).ok_or_else(|| missing(line, key))?;
        Ok((line, value, unit))
    };
    let (line, frequency, hertz) = quantity("Sampling Freq")?;
    if !(hertz.eq_ignore_ascii_case("hz") && frequency > 0.0) {
        return Err(missing(line, "Sampling Freq(Hz)"));
    }
    let (duration_line, duration, _) = quantity("Duration Time")?;
    // Gals over counts, as `7845(gal)/8223790`.
    let (scale_line, gals, rest) = quantity("Scale Factor")?;
    let counts = rest
        .strip_prefix("(gal)")
        .and_then(|rest| rest.trim().strip_prefix('/'));
    let counts = counts.ok_or_else(|| {
        let found = rest.chars().take(40).collect();
        RecordError::content(scale_line, 0, RecordFault::UnknownUnit { found })
    })?;
    let counts = number(counts.trim(), scale_line, 0)?;
    if !(counts > 0.0 && gals > 0.0) {
        return Err(missing(scale_line, "Scale Factor"));
    }
    let start = lines
        .iter()
        .take(HEADER + 3)
        .position(|line| line.starts_with("Memo"));
    let start = start.ok_or_else(|| missing(1, "Memo"))? + 1;
    let (samples, end) = numbers(&lines, start, Fields::Counts, None)?;
    crate::nothing_follows(&lines, end, |line| contains(line, "Origin Time"))?;
    let (_, max) = value("Max. Acc").unwrap_or_default();
    let text = |key| value(key).map_or(String::new(), |(_, text)| text.to_string());
    let magnitude = first_behind(header, "Mag.");
    Ok(vec![Channel {
        line: duration_line,
        component: component(&text("Dir.")),
        station: text("Station Code"),
        event: format!(
            "{} JST, magnitude {}",
            text("Origin Time"),
            magnitude.unwrap_or("?")
        ),
        // The time of the header is that of the trigger, behind the delay of the recorder.
        start: format!("{} JST less 15 s", text("Record Time")),
        step: 1.0 / frequency,
        unit: AccelerationUnit::Gal,
        scale: Some(gals / counts),
        has_offset: true,
        count: whole(duration_line, (duration * frequency).round())?,
        peak: leading(max).map(|(peak, _)| peak),
        samples,
    }])
}

/// Name of a component: KiK-net numbers its sensors, of which 1 to 3 are at the bottom of the borehole.
///
/// The names are the endings of the names of its files.
fn component(direction: &str) -> String {
    let name = match direction {
        "1" => "NS1 (borehole)",
        "2" => "EW1 (borehole)",
        "3" => "UD1 (borehole)",
        "4" => "NS2 (surface)",
        "5" => "EW2 (surface)",
        "6" => "UD2 (surface)",
        other => other,
    };
    name.to_string()
}
