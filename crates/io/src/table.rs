//! Tables as comma-separated columns.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::fs::OpenOptions;
use std::io::{Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use crate::{IoError, write_whole};

/// Column of a table, with name and unit.
#[derive(Clone, Debug, PartialEq)]
pub struct TableColumn {
    /// Name, without line breaks and other control characters.
    pub name: String,
    /// Unit, `1` for a dimensionless quantity.
    pub unit: String,
    /// One number per row.
    pub values: Vec<f64>,
}

impl TableColumn {
    /// Column of a name, a unit and its values.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            values,
        }
    }
}

/// Writes a table as CSV: a header `name [unit]` per column, then one line per row, each
/// number with as many digits as reproduce the double.
///
/// # Errors
/// If the columns have unequal lengths, a name has control characters, a number is not finite, or the
/// file cannot be written.
pub fn write_table(file: &Path, columns: &[TableColumn]) -> Result<(), IoError> {
    write_noted_table(file, &[], columns)
}

/// Writes a table as CSV with notes: lines above the header that begin with `#`, such as a warning about
/// the numbers. [`read_table`] skips them, as most programs can (`comment='#'` in pandas).
///
/// # Errors
/// As [`write_table`].
pub fn write_noted_table(
    file: &Path,
    notes: &[String],
    columns: &[TableColumn],
) -> Result<(), IoError> {
    let rows = columns.first().map_or(0, |column| column.values.len());
    let mut text = String::new();
    for line in notes.iter().flat_map(|note| note.lines()) {
        let _ = writeln!(text, "# {line}");
    }
    for column in columns {
        if column.values.len() != rows {
            return Err(IoError::Length {
                file: file.into(),
                what: column.name.clone(),
                found: column.values.len(),
                expected: rows,
            });
        }
        check_names(file, [&column.name, &column.unit])?;
        if let Some(index) = column.values.iter().position(|value| !value.is_finite()) {
            return Err(IoError::NotFinite {
                file: file.into(),
                what: column.name.clone(),
                index,
                value: column.values[index],
            });
        }
    }
    write_head(
        &mut text,
        columns.iter().map(|column| (&*column.name, &*column.unit)),
    );
    for row in 0..rows {
        write_row(&mut text, columns.iter().map(|column| column.values[row]));
    }
    write_whole(file, text.as_bytes())
}

fn check_names(file: &Path, names: [&str; 2]) -> Result<(), IoError> {
    match names.iter().find(|name| name.contains(char::is_control)) {
        Some(&name) => Err(IoError::Name {
            file: file.into(),
            name: name.into(),
        }),
        None => Ok(()),
    }
}

/// Writes the line of column headers, each a name with its unit.
fn write_head<'a>(text: &mut String, columns: impl Iterator<Item = (&'a str, &'a str)>) {
    for (index, (name, unit)) in columns.enumerate() {
        let separator = if index == 0 { "" } else { "," };
        let _ = write!(text, "{separator}{}", csv_cell(&format!("{name} [{unit}]")));
    }
    text.push('\n');
}

/// Writes the line of a row.
fn write_row(text: &mut String, values: impl Iterator<Item = f64>) {
    for (index, value) in values.enumerate() {
        let separator = if index == 0 { "" } else { "," };
        let _ = write!(text, "{separator}{value:e}");
    }
    text.push('\n');
}

/// Column of a table that grows: the values so far.
#[derive(Clone, Copy, Debug)]
pub struct GrowingColumn<'a> {
    /// Name.
    pub name: &'a str,
    /// Unit.
    pub unit: &'a str,
    /// Values of all rows so far.
    pub values: &'a [f64],
}

/// Table (CSV) on disk that grows while a run goes on: new rows are appended in whole lines, so that a program that is
/// killed loses no more than the rows since the last call. The lines are those of [`write_table`].
///
/// ```
/// use powerhouse_io::{GrowingColumn, GrowingTable, read_table};
/// let file = std::env::temp_dir().join(format!("growing-{}.csv", std::process::id()));
/// let mut table = GrowingTable::new(&file);
/// let rows = |values| [GrowingColumn { name: "time", unit: "s", values }];
/// table.append(&rows(&[0.0, 0.1]))?;
/// table.append(&rows(&[0.0, 0.1, 0.2]))?;
/// assert_eq!(read_table(&file)?[0].values, [0.0, 0.1, 0.2]);
/// # std::fs::remove_file(&file)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct GrowingTable {
    file: PathBuf,
    /// Rows and bytes on disk.
    rows: usize,
    bytes: u64,
}

impl GrowingTable {
    /// Table at a path, which is created with the first rows, in place of an earlier file.
    pub fn new(file: impl Into<PathBuf>) -> Self {
        Self {
            file: file.into(),
            rows: 0,
            bytes: 0,
        }
    }

    /// Appends the rows that are not on disk yet; nothing if there are none. After an error the next call tries again.
    ///
    /// # Errors
    /// A name with control characters; the file that could not be written.
    pub fn append(&mut self, columns: &[GrowingColumn<'_>]) -> Result<(), IoError> {
        // A row is complete when all its values are there.
        let rows = columns.iter().map(|column| column.values.len()).min();
        let rows = rows.unwrap_or(0);
        if rows <= self.rows {
            return Ok(());
        }
        // A file that was removed or cut off meanwhile is written anew.
        let found = std::fs::metadata(&self.file).map_or(0, |file| file.len());
        if found < self.bytes {
            (self.rows, self.bytes) = (0, 0);
        }
        let mut text = String::new();
        if self.rows == 0 {
            for column in columns {
                check_names(&self.file, [column.name, column.unit])?;
            }
            let heads = columns.iter().map(|column| (column.name, column.unit));
            write_head(&mut text, heads);
        }
        for row in self.rows..rows {
            write_row(&mut text, columns.iter().map(|column| column.values[row]));
        }
        let written = self.write_from_end(text.as_bytes());
        written.map_err(IoError::file(&self.file))?;
        self.rows = rows;
        self.bytes += text.len() as u64;
        Ok(())
    }

    /// Writes after the rows on disk, in place of what an append that failed has left of its lines.
    fn write_from_end(&self, text: &[u8]) -> std::io::Result<()> {
        if let Some(folder) = self.file.parent() {
            std::fs::create_dir_all(folder)?;
        }
        let mut file = OpenOptions::new()
            .write(true)
            .create(true)
            .truncate(false)
            .open(&self.file)?;
        file.set_len(self.bytes)?;
        file.seek(SeekFrom::End(0))?;
        file.write_all(text)
    }
}

/// Cell of a CSV file: in quotes, with quotes doubled, if it has a comma, a quote or a line break
/// (RFC 4180).
///
/// ```
/// assert_eq!(powerhouse_io::csv_cell("crown"), "crown");
/// assert_eq!(powerhouse_io::csv_cell("crown, \"left\""), "\"crown, \"\"left\"\"\"");
/// ```
pub fn csv_cell(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\"")).into()
    } else {
        text.into()
    }
}

/// Cells of a line of a CSV file, without their quotes.
fn cells_of(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let (mut quoted, mut characters) = (false, line.chars().peekable());
    while let Some(character) = characters.next() {
        let cell = cells.last_mut().expect("one cell at least");
        match character {
            '"' if quoted && characters.peek() == Some(&'"') => {
                characters.next();
                cell.push('"');
            }
            '"' if quoted || cell.is_empty() => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            other => cell.push(other),
        }
    }
    cells
}

/// Largest size of a table (bytes).
const LARGEST: u64 = 4 << 30;

/// Reads a table that [`write_table`] wrote.
///
/// # Errors
/// [`IoError::File`] for a file that cannot be read; [`IoError::Table`], with the line: an empty file, a column header
/// without unit, a row with another number of columns, or a number that cannot be parsed.
pub fn read_table(file: &Path) -> Result<Vec<TableColumn>, IoError> {
    let bytes = crate::read_whole(file, LARGEST).map_err(IoError::file(file))?;
    parse_table(&bytes, file)
}

/// Reads a table from memory, as [`read_table`]. `file` is used in messages.
///
/// # Errors
/// [`IoError::Table`], as [`read_table`], and for bytes that are not UTF-8.
pub fn parse_table(bytes: &[u8], file: &Path) -> Result<Vec<TableColumn>, IoError> {
    let fault = |line: usize, reason: String| IoError::Table {
        file: file.into(),
        line,
        reason,
    };
    let text = str::from_utf8(bytes).map_err(|error| {
        let valid = &bytes[..error.valid_up_to()];
        let line = valid.iter().filter(|&&byte| byte == b'\n').count() + 1;
        fault(line, "a byte is not UTF-8 text".into())
    })?;
    let mut lines = (text.lines().enumerate()).skip_while(|(_, line)| line.starts_with('#'));
    let (_, header) = lines
        .next()
        .ok_or_else(|| fault(1, "the file is empty".into()))?;
    let mut columns = Vec::new();
    for cell in cells_of(header) {
        let (name, unit) = cell
            .strip_suffix(']')
            .and_then(|cell| cell.rsplit_once(" ["))
            .ok_or_else(|| {
                fault(
                    1,
                    format!("the column header {cell:?} has no unit in brackets"),
                )
            })?;
        columns.push(TableColumn::new(name, unit, Vec::new()));
    }
    for (index, line) in lines {
        let cells: Vec<&str> = line.split(',').collect();
        if cells.len() != columns.len() {
            let reason = format!("{} cells instead of {}", cells.len(), columns.len());
            return Err(fault(index + 1, reason));
        }
        for (column, cell) in columns.iter_mut().zip(cells) {
            let value = cell
                .parse()
                .map_err(|_| fault(index + 1, format!("{cell:?} is not a number")))?;
            column.values.push(value);
        }
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn temporary(name: &str) -> std::path::PathBuf {
        std::env::temp_dir().join(format!("powerhouse-{}-{name}", std::process::id()))
    }

    /// A table is read back bit for bit.
    #[test]
    fn a_table_survives_the_round_trip() {
        let file = temporary("table.csv");
        let columns = vec![
            TableColumn::new("time", "s", vec![0.0, 0.1, 0.30000000000000004]),
            TableColumn::new(
                "crown uz",
                "m",
                vec![-1.0e-300, 5e-324, 1.7976931348623157e308],
            ),
        ];
        write_table(&file, &columns).unwrap();
        assert_eq!(read_table(&file).unwrap(), columns);
        std::fs::remove_file(file).unwrap();
    }

    /// Names with commas, quotes and brackets are quoted by RFC 4180, and read back unchanged; plain
    /// names are written without quotes.
    #[test]
    fn names_are_quoted() {
        let file = temporary("quoted.csv");
        let names = ["crown, left.ux", "\"a\" [b].uy", "plain", "\"", "a,\"b\",c"];
        let columns = names.map(|name| TableColumn::new(name, "m", vec![1.0]));
        write_table(&file, &columns).unwrap();
        assert_eq!(read_table(&file).unwrap(), columns);
        let text = std::fs::read_to_string(&file).unwrap();
        let head = "\"crown, left.ux [m]\",\"\"\"a\"\" [b].uy [m]\",plain [m],";
        assert!(text.starts_with(head), "{text}");
        std::fs::remove_file(file).unwrap();
    }

    /// A number that is not finite, a short column and an invalid name are errors with their name.
    #[test]
    fn faults_are_named() {
        let file = temporary("bad.csv");
        let nan = [TableColumn::new("uz", "m", vec![0.0, f64::NAN])];
        let message = write_table(&file, &nan).unwrap_err().to_string();
        assert!(
            message.contains("'uz'") && message.contains("index 1"),
            "{message}"
        );
        let short = [
            TableColumn::new("time", "s", vec![0.0, 1.0]),
            TableColumn::new("uz", "m", vec![0.0]),
        ];
        assert!(matches!(
            write_table(&file, &short),
            Err(IoError::Length {
                found: 1,
                expected: 2,
                ..
            })
        ));
        let broken = [TableColumn::new("u\nz", "m", vec![])];
        assert!(matches!(
            write_table(&file, &broken),
            Err(IoError::Name { .. })
        ));
        assert!(!file.exists());
        std::fs::write(&file, "time [s],uz [m]\n1,2\n3\n").unwrap();
        let message = read_table(&file).unwrap_err().to_string();
        assert!(message.contains(":3: 1 cells"), "{message}");
        std::fs::remove_file(file).unwrap();
    }
}
