//! Accelerograms in text of one or more columns, or of several values in a row.

use crate::channel::sample;
use crate::times::{UNIFORMITY, is_swapped, is_uniform, uniform_step};
use crate::title::Title;
use crate::{Record, RecordError, RecordFault, RecordOptions};

/// Lines of a file that a message shows.
const SHOWN: usize = 4;
/// Samples after the first one with which it is compared.
const COMPARED: usize = 20;

pub(crate) const NAME: &str = "columns of text";

/// A row of numbers.
struct Row<'t> {
    /// Number of the line, from 1.
    line: usize,
    text: &'t str,
}

/// Text with its rows, and how to split them.
struct Table<'t> {
    title: Title<'t>,
    rows: Vec<Row<'t>>,
    /// Whether a comma is the decimal sign.
    decimal_comma: bool,
}

/// Where the accelerations are in a row.
#[derive(Clone, Copy, PartialEq)]
enum Layout {
    /// Columns of time and acceleration (index) among this many.
    Columns {
        time: Option<usize>,
        acceleration: usize,
        width: usize,
    },
    /// This many successive samples, each behind its time or not.
    Successive { values: usize, timed: bool },
}

/// Numbers in front of the samples.
#[derive(Default)]
struct Leader {
    step: Option<f64>,
    note: Option<String>,
}

pub(crate) fn read(text: &str, options: &RecordOptions) -> Result<Record, RecordError> {
    let content = |fault| RecordError::content(0, 0, fault);
    if let Some(wanted) = &options.channel {
        let (wanted, channels) = (wanted.clone(), "of text, which `columns` chooses".into());
        return Err(content(RecordFault::NoSuchChannel { wanted, channels }));
    }
    let mut table = Table::new(text, options.skip.unwrap_or(0));
    if table.rows.is_empty()
        && let Some(text) = table
            .title
            .names
            .map(|(_, line)| line.trim().chars().take(40).collect())
    {
        return Err(RecordError::content(1, 0, RecordFault::NoNumbers { text }));
    }
    let mut notes = Vec::new();
    let leader = table.leader(text, options)?;
    notes.extend(leader.note);
    let mut layout = table.layout(text, options, leader.step.is_some())?;
    let (mut times, mut samples) = table.numbers(layout)?;
    if is_swapped(&times, &samples, options) {
        std::mem::swap(&mut times, &mut samples);
        notes.push("column 1 is the acceleration, column 2 the time".into());
        layout = Layout::Columns {
            time: Some(1),
            acceleration: 0,
            width: 2,
        };
    }
    let (width, column) = match layout {
        Layout::Columns {
            width,
            acceleration,
            ..
        } => (width, acceleration),
        Layout::Successive { .. } => (0, 0),
    };
    let unit = match (table.title.unit(width, column)?, options.unit) {
        (Some((line, found)), Some(declared)) if found != declared => {
            let (found, declared) = (found.name(), declared.name());
            return Err(RecordError::content(
                line,
                0,
                RecordFault::UnitConflict { found, declared },
            ));
        }
        (found, declared) => found.map(|(_, unit)| unit).or(declared),
    };
    let unit = unit.ok_or_else(|| content(RecordFault::NoUnit))?;
    let lines: Vec<usize> = table.lines_of(layout).collect();
    let timed: Vec<(usize, f64)> = lines.into_iter().zip(times).collect();
    let step = table.step(
        uniform_step(&timed)?.or(leader.step),
        samples.len(),
        options,
    )?;
    let found = samples.len();
    let step = match step {
        Some(step) => step,
        None if found < 2 => return Err(content(RecordFault::TooShort { found })),
        None => return Err(content(RecordFault::NoStep)),
    };
    match layout {
        Layout::Columns {
            width: 3..,
            time,
            acceleration,
        } => {
            let time = time.map_or(String::new(), |time| {
                format!(", column {} the time", time + 1)
            });
            notes.push(format!(
                "column {} is the acceleration{time}",
                acceleration + 1
            ));
        }
        Layout::Successive { values, .. } if values > 1 => {
            notes.push(format!("{values} successive values in a row"));
        }
        _ => {}
    }
    if table.decimal_comma {
        notes.push("commas are decimal signs".into());
    }
    let start = timed.first().filter(|(_, start)| *start != 0.0);
    let warnings =
        start.map(|(_, start)| format!("the time {start} s of the first row is taken as zero"));
    samples.iter_mut().for_each(|value| *value *= unit.factor());
    Ok(Record {
        format: NAME,
        title: table.title.text(),
        unit,
        step,
        samples,
        notes,
        warnings: warnings.into_iter().collect(),
        ..Record::default()
    })
}

impl<'t> Table<'t> {
    fn new(text: &'t str, skip: usize) -> Self {
        let mut title = Title::default();
        let mut rows: Vec<Row> = Vec::new();
        for (index, content) in text.lines().enumerate() {
            let line = index + 1;
            let data = without_comment(content);
            let marks = |c: char| c.is_whitespace() || c == ',' || c == ';';
            let first = data.split(marks).find(|cell| !cell.is_empty());
            let is_row = index >= skip && first.is_some_and(|cell| !is_name(cell));
            if is_row || (!rows.is_empty() && first.is_some()) {
                rows.push(Row { line, text: data });
            } else if rows.is_empty() && !content.trim().is_empty() {
                if index >= skip && first.is_some() {
                    title.names = Some((line, content));
                }
                title.lines.push((line, content));
            }
        }
        // Words without a digit behind the last row.
        while rows.last().is_some_and(|row| is_trailer(row.text)) {
            rows.pop();
        }
        let decimal_comma = has_decimal_commas(&rows);
        Self {
            title,
            rows,
            decimal_comma,
        }
    }

    fn cells(&self, row: &Row<'t>) -> Vec<(usize, &'t str)> {
        let start = row.text.as_ptr() as usize;
        let is_mark = |c: char| c.is_whitespace() || c == ';' || (c == ',' && !self.decimal_comma);
        let parts = row.text.split(is_mark).filter(|cell| !cell.is_empty());
        let placed = parts.map(|cell| (cell.as_ptr() as usize - start + 1, cell.trim_matches('"')));
        placed.collect()
    }

    fn value(&self, row: &Row<'t>, (column, cell): (usize, &str)) -> Result<f64, RecordError> {
        if self.decimal_comma {
            sample(&cell.replacen(',', ".", 1), row.line, column)
        } else {
            sample(cell, row.line, column)
        }
    }

    /// Recognises a count, a step, or both in front of the samples, and takes them away.
    fn leader(&mut self, text: &str, options: &RecordOptions) -> Result<Leader, RecordError> {
        let none = Leader::default();
        if options.skip.is_some() || options.columns.is_some() || self.rows.len() < 3 {
            return Ok(none);
        }
        let [first, second] = [self.cells(&self.rows[0]), self.cells(&self.rows[1])];
        let values: Result<Vec<f64>, _> = first
            .iter()
            .map(|&cell| self.value(&self.rows[0], cell))
            .collect();
        let Ok(values) = values else { return Ok(none) };
        let whole = |value: f64| (value.fract() == 0.0 && value >= 2.0).then_some(value as usize);
        let line = self.rows[0].line;
        let uncertain = |found: &str| {
            let (found, lines) = (found.into(), shown(text));
            RecordError::content(line, 0, RecordFault::Leader { found, lines })
        };
        let rest = &self.rows[1..];
        match (&values[..], second.len()) {
            ([count, step], width) if *step > 0.0 && *step <= 1.0 && whole(*count).is_some() => {
                let numbers: usize = rest.iter().map(|row| self.cells(row).len()).sum();
                let matches = |found: usize| whole(*count) == Some(found);
                let has_times = width == 2 && self.first_times_have(*step);
                let (count, step) = (*count, *step);
                if width == 2 && !has_times && !matches(numbers) {
                    return Ok(none);
                }
                if !(matches(numbers) || (has_times && matches(rest.len()))) {
                    return Err(uncertain(&format!("{count} and {step}")));
                }
                self.rows.remove(0);
                let note = format!("line {line} has the number of samples and the step {step} s");
                Ok(Leader {
                    step: Some(step),
                    note: Some(note),
                })
            }
            (&[value], 1) => {
                if rest.len() >= 10 && whole(value) == Some(rest.len()) {
                    self.rows.remove(0);
                    let note = Some(format!("line {line} is the number of samples"));
                    return Ok(Leader { step: None, note });
                }
                let declared = options.step.or(self.title.step().map(|step| step.step));
                if declared == Some(value) && self.is_apart(first[0].1, value) {
                    self.rows.remove(0);
                    let note = Some(format!("line {line} is the step {value} s"));
                    return Ok(Leader {
                        step: Some(value),
                        note,
                    });
                }
                let is_step = value > 0.0 && value <= 0.1;
                if (is_step || whole(value).is_some()) && self.is_apart(first[0].1, value) {
                    return Err(uncertain(first[0].1));
                }
                Ok(none)
            }
            _ => Ok(none),
        }
    }

    /// Whether the first column behind the first row has about this step.
    fn first_times_have(&self, step: f64) -> bool {
        let time = |row: &Row<'t>| self.value(row, *self.cells(row).first()?).ok();
        let times = [&self.rows[1], &self.rows[2]].map(time);
        matches!(times, [Some(a), Some(b)] if (b - a - step).abs() <= UNIFORMITY * step)
    }

    /// Whether the first value of a column is written unlike the next ones, or is far from them.
    fn is_apart(&self, word: &str, value: f64) -> bool {
        let rows = self.rows.iter().skip(1).take(COMPARED);
        let next: Vec<(&str, f64)> = rows
            .filter_map(|row| {
                let cell = *self.cells(row).first()?;
                Some((cell.1, self.value(row, cell).ok()?))
            })
            .collect();
        if next.len() < 5 {
            return false;
        }
        let decimals = |word: &str| {
            let part = word.split_once(if self.decimal_comma { ',' } else { '.' });
            part.map_or(0, |(_, part)| {
                part.split(['e', 'E', 'd', 'D']).next().map_or(0, str::len)
            })
        };
        let own = decimals(next[0].0);
        let alike = own > 0 && next.iter().all(|(word, _)| decimals(word) == own);
        let jumps = next.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs());
        let largest = jumps.fold(0.0, f64::max);
        (alike && decimals(word) != own)
            || (value - next[0].1).abs() > 10.0 * largest.max(next[0].1.abs())
    }

    fn layout(
        &self,
        text: &str,
        options: &RecordOptions,
        is_counted: bool,
    ) -> Result<Layout, RecordError> {
        let Some(row) = self.rows.first() else {
            return Ok(Layout::Columns {
                time: None,
                acceleration: 0,
                width: 1,
            });
        };
        let cells = self.cells(row);
        let width = cells.len();
        let at = |fault| RecordError::content(row.line, 0, fault);
        if let Some((_, cell)) = cells.iter().skip(1).find(|(_, cell)| is_name(cell)) {
            let text = cell.chars().take(40).collect();
            return Err(at(RecordFault::TitleRow { text }));
        }
        if let Some(columns) = options.columns {
            let index = |column: usize| {
                let inside = (1..=width).contains(&column);
                inside
                    .then(|| column - 1)
                    .ok_or_else(|| at(RecordFault::NoSuchColumn { column, width }))
            };
            let time = columns.time.map(index).transpose()?;
            let acceleration = index(columns.acceleration)?;
            return Ok(Layout::Columns {
                time,
                acceleration,
                width,
            });
        }
        if let Some(values) = options.values_in_a_row {
            return match width {
                _ if width == values || (self.rows.len() == 1 && width < values) => {
                    Ok(Layout::Successive {
                        values,
                        timed: false,
                    })
                }
                _ if width == 2 * values => Ok(Layout::Successive {
                    values,
                    timed: true,
                }),
                found => Err(at(RecordFault::RowLength {
                    found,
                    expected: values,
                })),
            };
        }
        let names = self
            .title
            .columns(width)
            .map(|(_, names)| names)
            .unwrap_or_default();
        let of = |word: &str| {
            let mut found = (0..names.len()).filter(|&at| names[at].to_lowercase().contains(word));
            found.next().filter(|_| found.next().is_none())
        };
        match (width, of("time"), of("acc")) {
            (_, time, Some(acceleration)) if width > 1 && time.is_some() => Ok(Layout::Columns {
                time,
                acceleration,
                width,
            }),
            (1, ..) => Ok(Layout::Columns {
                time: None,
                acceleration: 0,
                width,
            }),
            (2, ..) if !is_counted || self.first_times_have_a_step() => Ok(Layout::Columns {
                time: Some(0),
                acceleration: 1,
                width,
            }),
            _ if is_counted => Ok(Layout::Successive {
                values: width,
                timed: false,
            }),
            _ if self.has_pairs(width) => Ok(Layout::Successive {
                values: width / 2,
                timed: true,
            }),
            _ => Err(at(RecordFault::Layout {
                width,
                lines: shown(text),
            })),
        }
    }

    fn first_times_have_a_step(&self) -> bool {
        let time = |row: &Row<'t>| self.value(row, *self.cells(row).first()?).ok();
        let times: Option<Vec<f64>> = self.rows.iter().take(3).map(time).collect();
        let times = times.unwrap_or_default();
        matches!(times[..], [a, b, c] if b > a && (c - b - (b - a)).abs() <= UNIFORMITY * (b - a))
    }

    /// Whether every other number of the first two rows is a time of one step.
    fn has_pairs(&self, width: usize) -> bool {
        let rows = self.rows.iter().take(2);
        let cells = rows.flat_map(|row| {
            let cells = self.cells(row).into_iter().step_by(2);
            cells
                .map(|cell| self.value(row, cell).ok())
                .collect::<Vec<_>>()
        });
        let times: Option<Vec<f64>> = cells.collect();
        width.is_multiple_of(2)
            && times.is_some_and(|times| times.len() == width && is_uniform(&times))
    }

    /// Times and accelerations.
    fn numbers(&self, layout: Layout) -> Result<(Vec<f64>, Vec<f64>), RecordError> {
        let (mut times, mut samples) = (Vec::new(), Vec::new());
        let last = self.rows.len().saturating_sub(1);
        for (index, row) in self.rows.iter().enumerate() {
            let cells = self.cells(row);
            let expected = match layout {
                Layout::Columns { width, .. } => width,
                Layout::Successive { values, timed } => values * (1 + usize::from(timed)),
            };
            let found = cells.len();
            let wrong =
                || RecordError::content(row.line, 0, RecordFault::RowLength { found, expected });
            match layout {
                Layout::Columns {
                    time, acceleration, ..
                } => {
                    if found != expected {
                        return Err(wrong());
                    }
                    if let Some(time) = time {
                        times.push(self.value(row, cells[time])?);
                    }
                    samples.push(self.value(row, cells[acceleration])?);
                }
                Layout::Successive { timed, .. } => {
                    let may_end = index == last && found < expected && !(timed && found % 2 == 1);
                    if found != expected && !may_end {
                        return Err(wrong());
                    }
                    for (place, &cell) in cells.iter().enumerate() {
                        let is_time = timed && place % 2 == 0;
                        let value = self.value(row, cell)?;
                        if is_time {
                            times.push(value)
                        } else {
                            samples.push(value)
                        }
                    }
                }
            }
        }
        Ok((times, samples))
    }

    /// Line of each sample.
    fn lines_of(&self, layout: Layout) -> impl Iterator<Item = usize> {
        let each = match layout {
            Layout::Columns { .. } => 1,
            Layout::Successive { values, .. } => values,
        };
        self.rows
            .iter()
            .flat_map(move |row| std::iter::repeat_n(row.line, each))
    }

    /// The step of the file, the title and the caller, which must agree.
    fn step(
        &self,
        found: Option<f64>,
        count: usize,
        options: &RecordOptions,
    ) -> Result<Option<f64>, RecordError> {
        let conflict = |line, found, declared| {
            Err(RecordError::content(
                line,
                0,
                RecordFault::StepConflict { found, declared },
            ))
        };
        if let (Some(found), Some(declared)) = (found, options.step)
            && (found - declared).abs() * count as f64 > UNIFORMITY * found
        {
            return conflict(0, found, declared);
        }
        let step = options.step.or(found);
        let Some(title) = self.title.step() else {
            return Ok(step);
        };
        match step {
            Some(step) if (step - title.step).abs() > title.tolerance.max(1e-6 * step) => {
                conflict(title.line, title.step, step)
            }
            _ => Ok(step.or(Some(title.step))),
        }
    }
}

/// First lines of a file, for a message.
fn shown(text: &str) -> String {
    let lines = text
        .lines()
        .filter(|line| !line.trim().is_empty())
        .take(SHOWN);
    lines
        .map(|line| format!("\n  {}", line.chars().take(80).collect::<String>()))
        .collect()
}

/// Line without a comment; `%g` is a unit.
fn without_comment(line: &str) -> &str {
    let bytes = line.as_bytes();
    let is_mark = |at: &usize| {
        bytes[*at] == b'#'
            || (bytes[*at] == b'%' && !matches!(bytes.get(at + 1), Some(b'g' | b'G')))
    };
    line.get(..(0..line.len()).find(is_mark).unwrap_or(line.len()))
        .unwrap_or(line)
}

/// Whether a line ends a file with words, as `*** End Data ***`.
fn is_trailer(line: &str) -> bool {
    let mut words = line.split(|c: char| !c.is_alphabetic());
    !line.contains(|c: char| c.is_ascii_digit())
        && words.any(|word| word.len() > 2)
        && line
            .split_whitespace()
            .all(|word| !["nan", "inf"].contains(&word.to_lowercase().as_str()))
}

/// Whether a cell is a word and not a malformed number.
fn is_name(cell: &str) -> bool {
    let lower = cell.trim_start_matches('"').to_ascii_lowercase();
    lower.starts_with(|c: char| c.is_alphabetic())
        && !["nan", "inf", "infinity"].contains(&lower.trim_end_matches('"'))
}

/// Whether commas are decimal signs: no number has a point, and each cell between blanks and semicolons has one
/// comma, between digits; a single column of such cells is not one of whole seconds and whole accelerations.
fn has_decimal_commas(rows: &[Row]) -> bool {
    let is_decimal = |cell: &str| {
        let cell = cell.trim_matches('"').trim_start_matches(['+', '-']);
        let parts = cell.split_once(',');
        parts.is_some_and(|(whole, part)| {
            whole.bytes().all(|byte| byte.is_ascii_digit())
                && part.starts_with(|c: char| c.is_ascii_digit())
                && !part.contains([',', '.'])
        })
    };
    let mut width = 0;
    let decimal = rows.iter().all(|row| {
        let marks = |c: char| c.is_whitespace() || c == ';';
        let mut cells = row.text.split(marks).filter(|cell| !cell.is_empty());
        let (mut count, mut some) = (0, false);
        // A whole number has no comma.
        let is_whole = |cell: &str| {
            cell.bytes()
                .all(|byte| byte.is_ascii_digit() || byte == b'-')
        };
        let all = cells.all(|cell| {
            count += 1;
            let decimal = is_decimal(cell);
            some |= decimal;
            decimal || is_whole(cell)
        });
        width = count;
        all && some
    });
    if !decimal || width > 1 {
        return decimal;
    }
    let whole = |row: &Row| {
        row.text
            .trim()
            .split(',')
            .next()
            .and_then(|word| word.parse::<i64>().ok())
    };
    let wholes: Option<Vec<i64>> = rows.iter().map(whole).collect();
    let rises = wholes.is_some_and(|wholes| wholes.windows(2).all(|pair| pair[1] > pair[0]));
    !rises
}
