//! Accelerograms in one or two columns of text.

use super::number::number;
use super::{AccelerationUnit, Record, RecordError, RecordFault, RecordOptions};

/// Largest deviation of a time from the uniform one, in steps.
const UNIFORMITY: f64 = 0.01;

pub(super) fn read(text: &str, options: &RecordOptions) -> Result<Record, RecordError> {
    if let Some(text) = no_numbers(text) {
        return Err(RecordError::content(1, 0, RecordFault::NoNumbers { text }));
    }
    let unit = match (declared_unit(text), options.unit) {
        (Some((line, found)), Some(declared)) if found != declared => {
            let (found, declared) = (found.name(), declared.name());
            let fault = RecordFault::UnitConflict { found, declared };
            return Err(RecordError::content(line, 0, fault));
        }
        (found, declared) => found
            .map(|(_, unit)| unit)
            .or(declared)
            .ok_or_else(|| RecordError::content(0, 0, RecordFault::NoUnit))?,
    };
    let mut title = Vec::new();
    let mut named = false;
    let mut width = 0;
    let mut times: Vec<(usize, f64)> = Vec::new();
    let mut samples = Vec::new();
    for (index, content) in text.lines().enumerate() {
        let line = index + 1;
        let (data, comment) = content.split_at(content.find(['#', '%']).unwrap_or(content.len()));
        let comment = comment.trim_start_matches(['#', '%']).trim();
        if samples.is_empty() && !comment.is_empty() {
            title.push(comment);
        }
        let cells = cells(data);
        let Some(first) = cells.first() else { continue };
        if !named && samples.is_empty() && is_name(first.1) {
            named = true;
            continue;
        }
        if width == 0 {
            width = cells.len();
        }
        if cells.len() != width || width > 2 {
            let fault = RecordFault::Columns {
                found: cells.len(),
                expected: match width {
                    1 => "one",
                    2 => "two",
                    _ => "one or two",
                },
            };
            return Err(RecordError::content(line, 0, fault));
        }
        if let [time, _] = cells[..] {
            times.push((line, number(time.1, line, time.0)?));
        }
        let (column, word) = cells[width - 1];
        samples.push(number(word, line, column)? * unit.factor());
    }
    let step = match (uniform_step(&times)?, options.step) {
        (Some(found), Some(declared))
            if (found - declared).abs() * times.len() as f64 > UNIFORMITY * found =>
        {
            let fault = RecordFault::StepConflict { found, declared };
            return Err(RecordError::content(0, 0, fault));
        }
        (found, declared) => declared.or(found),
    };
    let step = match (step, samples.len()) {
        (Some(step), _) => step,
        (None, found @ 0..2) => {
            return Err(RecordError::content(0, 0, RecordFault::TooShort { found }));
        }
        (None, _) => return Err(RecordError::content(0, 0, RecordFault::NoStep)),
    };
    let start = times.first().filter(|(_, start)| *start != 0.0);
    let warnings =
        start.map(|(_, start)| format!("the time {start} s of the first row is taken as zero"));
    Ok(Record {
        title: title.join("; "),
        step,
        samples,
        warnings: warnings.into_iter().collect(),
    })
}

/// Unit of acceleration that comments or column names above the numbers declare, with the line: after the
/// word `unit`, or in brackets.
fn declared_unit(text: &str) -> Option<(usize, AccelerationUnit)> {
    let is_above = |line: &&str| match cells(line).first() {
        None => true,
        Some((_, cell)) => cell.starts_with(['#', '%']) || is_name(cell),
    };
    let brackets = ['(', ')', '[', ']'];
    let of_line = |line: &str| {
        let parts = |c: char| c.is_whitespace() || ",;:=\"#%".contains(c) || brackets.contains(&c);
        let mut words = line.split(parts);
        let is_key = |word: &str| ["unit", "units"].contains(&word.to_ascii_lowercase().as_str());
        if words.any(is_key) {
            return words.find_map(AccelerationUnit::from_name);
        }
        let mut within = line.split(brackets).skip(1).step_by(2);
        within.find_map(AccelerationUnit::from_name)
    };
    let above = text.lines().take_while(is_above).zip(1..);
    let mut found = above.filter_map(|(line, number)| Some((number, of_line(line)?)));
    found.next()
}

/// First line of a text in which no line starts with a possible number.
fn no_numbers<'t>(text: &'t str) -> Option<String> {
    let data = |line: &'t str| line.split(['#', '%']).next().unwrap_or_default();
    let rows: Vec<&str> = (text.lines().map(data))
        .filter(|row| !cells(row).is_empty())
        .collect();
    // One line of words may name the columns of numbers that follow.
    let first = rows.first()?;
    let only_words = rows.iter().all(|row| is_name(cells(row)[0].1));
    only_words.then(|| first.trim().chars().take(40).collect())
}

/// Cells with their columns, from 1, separated by commas, semicolons, tabs or blanks.
fn cells(data: &str) -> Vec<(usize, &str)> {
    let start = data.as_ptr() as usize;
    data.split(|c: char| c.is_whitespace() || c == ',' || c == ';')
        .filter(|cell| !cell.is_empty())
        .map(|cell| (cell.as_ptr() as usize - start + 1, cell))
        .collect()
}

/// Whether a cell of the first line is a column's name and not a malformed number.
fn is_name(cell: &str) -> bool {
    let lower = cell.to_ascii_lowercase();
    lower.starts_with(|c: char| c.is_alphabetic() || c == '"')
        && !["nan", "inf", "infinity"].contains(&lower.as_str())
}

/// Compares each time with the one before it and the median step, which a gap does not change: so the
/// error names the gap, and not the row at which the mean step first fails.
fn check_gaps(times: &[(usize, f64)]) -> Result<(), RecordError> {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1].1 - pair[0].1).collect();
    let middle = steps.len() / 2;
    let (_, &mut median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    for pair in times.windows(2) {
        let ((_, before), (line, time)) = (pair[0], pair[1]);
        let expected = before + median;
        // Both ends of a step are rounded.
        if (time - expected).abs() > 2.0 * UNIFORMITY * median.abs() {
            let fault = RecordFault::NotUniform { time, expected };
            return Err(RecordError::content(line, 1, fault));
        }
    }
    Ok(())
}

/// Step of a time column; `None` if there is no such column.
fn uniform_step(times: &[(usize, f64)]) -> Result<Option<f64>, RecordError> {
    let ([(_, first), .., (last_line, last)], count) = (times, times.len()) else {
        return Ok(None);
    };
    let step = (last - first) / (count - 1) as f64;
    if !(step.is_finite() && step > 0.0) {
        return Err(RecordError::content(
            *last_line,
            0,
            RecordFault::Step { value: step },
        ));
    }
    check_gaps(times)?;
    for (index, &(line, time)) in times.iter().enumerate() {
        let expected = first + index as f64 * step;
        if (time - expected).abs() > UNIFORMITY * step {
            return Err(RecordError::content(
                line,
                1,
                RecordFault::NotUniform { time, expected },
            ));
        }
    }
    // Printed times are rounded; a step of few digits is the intended one.
    let rounded = format!("{step:.6e}").parse().unwrap_or(step);
    Ok(Some(rounded))
}
