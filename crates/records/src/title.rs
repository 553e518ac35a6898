//! What lines above columns of numbers declare: unit, step, names of columns.

use crate::channel::contains;
use crate::number::number;
use crate::unit::is_of_other_motion;
use crate::{AccelerationUnit, RecordError, RecordFault};

const BRACKETS: [char; 4] = ['(', ')', '[', ']'];

/// Words behind which a number is the step (s).
const STEPS: [&str; 10] = [
    "time step",
    "timestep",
    "time_step",
    "time interval",
    "sampling interval",
    "sample interval",
    "delta t",
    "delta",
    "dt",
    "sampling period",
];
/// Words behind which a number is the number of samples in a second.
const RATES: [&str; 5] = [
    "sampling rate",
    "sample rate",
    "sampling frequency",
    "sampling freq",
    "samplerate",
];

/// Step that a line declares.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DeclaredStep {
    /// Number of the line, from 1.
    pub(crate) line: usize,
    /// Step (s).
    pub(crate) step: f64,
    /// Half of its last digit (s), if it may be rounded.
    pub(crate) tolerance: f64,
}

/// What the lines above the numbers declare.
#[derive(Debug, Default)]
pub(crate) struct Title<'t> {
    /// Lines with their numbers, from 1.
    pub(crate) lines: Vec<(usize, &'t str)>,
    /// The last of them, if it is not a comment and may name the columns.
    pub(crate) names: Option<(usize, &'t str)>,
}

impl Title<'_> {
    /// The lines without signs of comments, in one.
    pub(crate) fn text(&self) -> String {
        let lines = self
            .lines
            .iter()
            .map(|(_, line)| line.trim_start_matches(['#', '%']).trim());
        let names = self.names.map(|(number, _)| number);
        let title = self.lines.iter().zip(lines);
        let title = title.filter(|((number, _), line)| Some(*number) != names && !line.is_empty());
        title.map(|(_, line)| line).collect::<Vec<_>>().join("; ")
    }

    /// Names of the columns, if the last line has as many.
    pub(crate) fn columns(&self, width: usize) -> Option<(usize, Vec<String>)> {
        let &(number, line) = self.lines.last()?;
        let line = line.trim_start_matches(['#', '%']);
        let marks = ['\t', ';', ','];
        let cells: Vec<String> = match marks.into_iter().find(|mark| line.contains(*mark)) {
            Some(mark) => line
                .split(mark)
                .map(|cell| cell.trim().trim_matches('"').into())
                .collect(),
            None => glued(line),
        };
        (cells.len() == width).then_some((number, cells))
    }

    /// Unit of acceleration, with its line, of the column of this index or of any line.
    pub(crate) fn unit(
        &self,
        width: usize,
        column: usize,
    ) -> Result<Option<(usize, AccelerationUnit)>, RecordError> {
        if let Some((line, names)) = self.columns(width) {
            let name = &names[column];
            let lower = name.to_lowercase();
            let mut words = lower.split(|c: char| !c.is_alphabetic());
            let is_other = words
                .any(|word| word.starts_with("vel") || word.starts_with("displ") || word == "disp");
            let quantity = || {
                let found = name.chars().take(40).collect();
                RecordError::content(line, 0, RecordFault::Quantity { found })
            };
            if is_other && !lower.contains("acc") {
                return Err(quantity());
            }
            if let Some(inner) = within(name) {
                if let Some(unit) = AccelerationUnit::from_name(inner) {
                    return Ok(Some((line, unit)));
                }
                if is_of_other_motion(inner) {
                    return Err(quantity());
                }
                if inner.contains(['/', '^', '²']) && !inner.contains(' ') {
                    let found = inner.chars().take(40).collect();
                    return Err(RecordError::content(
                        line,
                        0,
                        RecordFault::UnknownUnit { found },
                    ));
                }
            }
            if let Some(unit) = suffix(&lower) {
                return Ok(Some((line, unit)));
            }
        }
        for &(line, text) in &self.lines {
            if let Some(unit) = of_line(text) {
                return Ok(Some((line, unit)));
            }
            let is_other = ["velocity", "displacement"]
                .iter()
                .any(|word| contains(text, word));
            if is_other && !contains(text, "acc") && inners(text).any(is_of_other_motion) {
                let found = text
                    .trim_start_matches(['#', '%'])
                    .trim()
                    .chars()
                    .take(40)
                    .collect();
                return Err(RecordError::content(
                    line,
                    0,
                    RecordFault::Quantity { found },
                ));
            }
        }
        Ok(None)
    }

    /// Step that some line declares.
    pub(crate) fn step(&self) -> Option<DeclaredStep> {
        self.lines.iter().find_map(|&(line, text)| {
            let lower = text.to_ascii_lowercase();
            let step = STEPS.iter().find_map(|key| behind(&lower, key));
            let (step, tolerance) = match step {
                Some((value, tolerance, "ms")) => (value / 1000.0, tolerance / 1000.0),
                Some((value, tolerance, _)) => (value, tolerance),
                None => {
                    let (rate, tolerance, _) = RATES.iter().find_map(|key| behind(&lower, key))?;
                    (1.0 / rate, tolerance / (rate * rate))
                }
            };
            (step.is_finite() && step > 0.0).then_some(DeclaredStep {
                line,
                step,
                tolerance,
            })
        })
    }
}

/// Words of a line; a text in brackets belongs to the word before it.
fn glued(line: &str) -> Vec<String> {
    let mut cells: Vec<String> = Vec::new();
    let mut open = false;
    for word in line.split_whitespace() {
        match cells.last_mut() {
            Some(last) if open || word.starts_with(['(', '[']) => {
                last.push(' ');
                last.push_str(word);
            }
            _ => cells.push(word.trim_matches('"').into()),
        }
        if let Some(at) = word.rfind(BRACKETS) {
            open = word[at..].starts_with(['(', '[']);
        }
    }
    cells
}

/// Text in the first brackets.
fn within(name: &str) -> Option<&str> {
    let start = name.find(['(', '['])? + 1;
    let end = name.rfind([')', ']'])?;
    name.get(start..end).map(str::trim)
}

/// Unit at the end of a column's name, as `accel_m_s2`.
fn suffix(name: &str) -> Option<AccelerationUnit> {
    let (word, unit) = name.split_once('_')?;
    let is_acceleration = word.starts_with("acc") || word == "a";
    AccelerationUnit::from_name(&unit.replace('_', "/")).filter(|_| is_acceleration)
}

/// Texts in brackets.
fn inners(line: &str) -> impl Iterator<Item = &str> {
    line.split(BRACKETS).skip(1).step_by(2)
}

/// Unit that a line declares: behind the word `unit`, in brackets, behind `acc...:`, or behind `acceleration in`.
fn of_line(line: &str) -> Option<AccelerationUnit> {
    let parts = |c: char| c.is_whitespace() || ",;:=\"#".contains(c) || BRACKETS.contains(&c);
    let mut words = line.split(parts).map(|word| word.trim_end_matches('.'));
    let is_key = |word: &str| ["unit", "units"].contains(&word.to_ascii_lowercase().as_str());
    if words.any(is_key) {
        return words.find_map(AccelerationUnit::from_name);
    }
    if let Some(unit) = inners(line).find_map(AccelerationUnit::from_name) {
        return Some(unit);
    }
    let lower = line.to_lowercase();
    let rest = lower.find("acc").map(|at| &lower[at..])?;
    let mut words = rest.split(parts).filter(|word| !word.is_empty()).skip(1);
    match words.next()? {
        "in" => words.next().and_then(AccelerationUnit::from_name),
        word if rest.contains(':') => AccelerationUnit::from_name(word),
        _ => None,
    }
}

/// Number behind a key that is a word, half of its last digit, and the word behind it.
fn behind<'t>(lower: &'t str, key: &str) -> Option<(f64, f64, &'t str)> {
    let at = lower.find(key)?;
    let before = lower[..at].chars().next_back();
    if before.is_some_and(|c| c.is_alphanumeric() || c == '_') {
        return None;
    }
    let mut rest = lower[at + key.len()..].trim_start();
    if let Some(inner) = rest.strip_prefix(['(', '[']) {
        rest = inner.split_once([')', ']'])?.1.trim_start();
    }
    rest = rest.trim_start_matches(['=', ':']).trim_start();
    let end = rest.find(|c: char| !(c.is_ascii_digit() || "+-.ed".contains(c)));
    let word = rest[..end.unwrap_or(rest.len())].trim_end_matches(['e', 'd', '+', '-']);
    let value = number(word, 0, 0).ok()?;
    let mantissa = word.split(['e', 'd']).next().unwrap_or_default();
    let decimals = mantissa.split_once('.').map_or(0, |(_, part)| part.len());
    let exponent: i32 = word
        .split_once(['e', 'd'])
        .map_or(0, |(_, e)| e.parse().unwrap_or(0));
    let digits = mantissa.trim_start_matches(['0', '.', '+', '-']);
    // A step of one or two digits is meant as it is written.
    let tolerance = match digits.len() {
        0..=2 => 0.0,
        _ => 0.5 * 10f64.powi(exponent.clamp(-300, 300) - decimals.min(300) as i32),
    };
    let unit = rest[word.len()..].trim_start();
    let unit = unit
        .split(|c: char| !c.is_alphanumeric())
        .next()
        .unwrap_or_default();
    Some((value, tolerance, unit))
}
