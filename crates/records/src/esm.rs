//! ASCII format of the Engineering Strong Motion database (ESM), of ITACA and of AFAD's newer files: lines of `KEY:
//! value`, then one sample in each line (header format DYNA).

use crate::channel::{Channel, Fields, leading, missing, numbers, whole};
use crate::number::number;
use crate::{AccelerationUnit, RecordError, RecordFault};

pub(crate) const NAME: &str = "ESM or ITACA ASCII";

pub(crate) fn recognises(text: &str) -> bool {
    text.trim_start().starts_with("EVENT_NAME:") && text.contains("\nSAMPLING_INTERVAL_S:")
}

pub(crate) fn channels(text: &str) -> Result<Vec<Channel>, RecordError> {
    let lines: Vec<&str> = text.lines().collect();
    let is_key = |line: &&&str| line.trim().is_empty() || line.contains(':');
    let length = lines.iter().take_while(is_key).count();
    let value = |key: &'static str| {
        let keys = lines[..length].iter().zip(1..);
        let mut values = keys.filter_map(|(line, number)| {
            let value = line.trim().strip_prefix(key)?.strip_prefix(':')?;
            Some((number, value.trim()))
        });
        values.next().ok_or_else(|| missing(1, key))
    };
    let text = |key| value(key).map_or("", |(_, value)| value);
    let (line, kind) = value("DATA_TYPE").unwrap_or((1, "ACCELERATION"));
    if kind != "ACCELERATION" {
        let found = kind.to_lowercase();
        return Err(RecordError::content(
            line,
            0,
            RecordFault::Quantity { found },
        ));
    }
    let (line, unit) = value("UNITS")?;
    let unit = AccelerationUnit::from_name(unit).ok_or_else(|| {
        let found = unit.chars().take(40).collect();
        RecordError::content(line, 0, RecordFault::UnknownUnit { found })
    })?;
    let (line, step) = value("SAMPLING_INTERVAL_S")?;
    let step = number(step, line, 0)?;
    let (line, count) = value("NDATA")?;
    let count = whole(line, number(count, line, 0)?)?;
    let (samples, end) = numbers(&lines, length, Fields::Separated, None)?;
    crate::nothing_follows(&lines, end, |line| line.contains("EVENT_NAME:"))?;
    // The key names the unit of the peak, with which samples in another one must agree.
    let gal = AccelerationUnit::Gal.factor() / unit.factor();
    let peak = leading(text("PGA_CM/S^2")).map(|(peak, _)| peak.abs() * gal);
    Ok(vec![Channel {
        line,
        component: text("STREAM").into(),
        station: format!("{} {}", text("NETWORK"), text("STATION_CODE"))
            .trim()
            .into(),
        event: format!("{} {}", text("EVENT_NAME"), text("EVENT_DATE_YYYYMMDD"))
            .trim()
            .into(),
        start: text("DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS").into(),
        step,
        unit,
        count,
        peak,
        samples,
        ..Channel::default()
    }])
}
