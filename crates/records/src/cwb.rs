//! Text format of the strong motion network of Taiwan (TSMIP, of the Central Weather Bureau): lines of `#Key: value`,
//! then the time and three components.

use crate::channel::{Channel, leading, missing, sample, whole};
use crate::number::{fixed_width, number};
use crate::unit::always_gal;
use crate::{RecordError, RecordFault};

pub(crate) const NAME: &str = "CWB or TSMIP text";

pub(crate) fn recognises(text: &str) -> bool {
    let mut header = text.lines().take(40);
    header.any(|line| line.starts_with("#StationCode:")) && text.contains("\n#DataSequence:")
}

pub(crate) fn channels(text: &str) -> Result<Vec<Channel>, RecordError> {
    let lines: Vec<&str> = text.lines().collect();
    let is_header = |line: &&&str| line.trim().is_empty() || line.starts_with('#');
    let length = lines.iter().take_while(is_header).count();
    let value = |key: &'static str| {
        let keys = lines[..length].iter().zip(1..);
        let mut found = keys.filter_map(|(line, number)| {
            let value = line.strip_prefix('#')?.strip_prefix(key)?;
            Some((number, value.split_once(':')?.1.trim()))
        });
        found.next().ok_or_else(|| missing(1, key))
    };
    let quantity = |key| {
        let (line, text) = value(key)?;
        let found = leading(text).filter(|(value, _)| *value > 0.0);
        Ok((line, found.ok_or_else(|| missing(line, key))?.0))
    };
    let (line, rate) = quantity("SampleRate")?;
    let (_, duration) = quantity("RecordLength")?;
    let (unit_line, unit) = value("AmplitudeUnit")?;
    let word = unit.split_whitespace().next().unwrap_or_default();
    let unit = always_gal(word.trim_end_matches('.'), unit)
        .map_err(|fault| RecordError::content(unit_line, 0, fault))?;
    let (sequence_line, sequence) = value("DataSequence")?;
    let names: Vec<&str> = sequence
        .split([';', ' '])
        .filter_map(|word| word.split('(').next())
        .filter(|name| !name.is_empty() && *name != "Time")
        .collect();
    if names.is_empty() || !sequence.starts_with("Time") {
        return Err(missing(sequence_line, "DataSequence"));
    }
    let mut columns = vec![Vec::new(); names.len()];
    let step = 1.0 / rate;
    let mut first = None;
    for (row, line) in lines[length..].iter().enumerate() {
        let number_of_line = length + row + 1;
        let cells = fixed_width(line);
        if cells.is_empty() {
            continue;
        }
        if line.starts_with('#') {
            let last = number_of_line - 1;
            return Err(RecordError::content(
                number_of_line,
                0,
                RecordFault::SecondRecord { last },
            ));
        }
        if cells.len() != names.len() + 1 {
            let (found, expected) = (cells.len(), names.len() + 1);
            return Err(RecordError::content(
                number_of_line,
                0,
                RecordFault::RowLength { found, expected },
            ));
        }
        let time = number(cells[0].1, number_of_line, 1)?;
        let start = *first.get_or_insert(time);
        let expected = start + columns[0].len() as f64 * step;
        if (time - expected).abs() > 0.01 * step + 6e-4 {
            return Err(RecordError::content(
                number_of_line,
                1,
                RecordFault::NotUniform { time, expected },
            ));
        }
        for (column, (at, word)) in columns.iter_mut().zip(&cells[1..]) {
            column.push(sample(word, number_of_line, *at)?);
        }
    }
    let mut count = whole(line, (duration * rate).round())?;
    // Both ends of the duration may be sampled.
    if columns[0].len() as u64 == count + 1 {
        count += 1;
    }
    let text = |key| value(key).map_or("", |(_, value)| value);
    let channel = |(name, samples): (&&str, Vec<f64>)| Channel {
        line,
        component: name.to_string(),
        station: text("StationCode").into(),
        event: text("Origin Time").into(),
        start: text("StartTime").into(),
        step,
        unit,
        count,
        peak: peak(&lines[..length], name),
        samples,
        ..Channel::default()
    };
    Ok(names.iter().zip(columns).map(channel).collect())
}

/// Declared peak of a component, as `#AmplitudeMAX. U:    0.658~   -0.837`.
fn peak(header: &[&str], name: &str) -> Option<f64> {
    let key = format!("#AmplitudeMAX. {name}:");
    let values = header.iter().find_map(|line| line.strip_prefix(&key))?;
    let values = values
        .split('~')
        .filter_map(|text| Some(leading(text)?.0.abs()));
    values.reduce(f64::max)
}
