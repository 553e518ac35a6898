//! Text format of AFAD's strong motion network (Turkey) until 2018: lines of `KEY : value`, then three components in
//! gal.

use crate::channel::{
    Channel, behind, contains, declared, find, first_behind, leading, missing, sample, whole,
};
use crate::number::fixed_width;
use crate::{AccelerationUnit, RecordError, RecordFault};

pub(crate) const NAME: &str = "AFAD text";

const MARK: &str = "STRONG GROUND MOTION RECORDS OF TURK";

pub(crate) fn recognises(text: &str) -> bool {
    text.lines().next().is_some_and(|line| contains(line, MARK))
}

pub(crate) fn channels(text: &str) -> Result<Vec<Channel>, RecordError> {
    let lines: Vec<&str> = text.lines().collect();
    let head = &lines[..30.min(lines.len())];
    let (line, count) = declared(head, 0, "NUMBER OF DATA")?;
    let (_, step) = declared(head, 0, "SAMPLING INTERVAL (sec)")?;
    let count = whole(line, count)?;
    let peaks = find(head, 0, "PGA VALUES (").ok_or_else(|| missing(1, "RAW PGA VALUES (gal)"))?;
    let unit = behind(lines[peaks], "VALUES (").unwrap_or_default();
    let unit = unit.split(')').next().unwrap_or_default();
    let unit = AccelerationUnit::from_name(unit).ok_or_else(|| {
        let found = unit.chars().take(40).collect();
        RecordError::content(peaks + 1, 0, RecordFault::UnknownUnit { found })
    })?;
    let names = find(head, peaks + 1, "U-D");
    let names = names.ok_or_else(|| missing(peaks + 1, "the names of the components"))?;
    let components: Vec<&str> = lines[names].split_whitespace().collect();
    let mut columns = vec![Vec::new(); components.len()];
    for (row, line) in lines[names + 1..].iter().enumerate() {
        let at = names + row + 2;
        let cells = fixed_width(line);
        if cells.is_empty() {
            continue;
        }
        if contains(line, MARK) {
            let last = at - 1;
            return Err(RecordError::content(
                at,
                0,
                RecordFault::SecondRecord { last },
            ));
        }
        if cells.len() != components.len() {
            let (found, expected) = (cells.len(), components.len());
            return Err(RecordError::content(
                at,
                0,
                RecordFault::RowLength { found, expected },
            ));
        }
        for (column, (place, word)) in columns.iter_mut().zip(cells) {
            column.push(sample(word, at, place)?);
        }
    }
    let text = |key: &str| {
        let found = first_behind(head, key).unwrap_or_default();
        found.trim_start_matches([':', ' ', '\t']).trim()
    };
    let channel = |(name, samples): (&&str, Vec<f64>)| Channel {
        line,
        component: name.to_string(),
        station: text("STATION ID").into(),
        event: text("EARTHQUAKE DATE").into(),
        start: text("RECORD TIME").into(),
        step,
        unit,
        count,
        peak: behind(lines[peaks], &format!("({name})"))
            .and_then(leading)
            .map(|(peak, _)| peak.abs()),
        samples,
        ..Channel::default()
    };
    Ok(components.iter().zip(columns).map(channel).collect())
}
