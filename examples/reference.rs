//! Reference solutions from `data/reference`.

use std::path::Path;

use crate::Outcome;

/// Table of numbers with named columns; words are read as NaN.
#[derive(Clone, Debug)]
pub struct ReferenceTable {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl ReferenceTable {
    /// Reads a file of `data/reference`.
    ///
    /// # Errors
    /// A missing or invalid file.
    pub fn read(file: &str) -> Outcome<Self> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/reference");
        let text = std::fs::read_to_string(folder.join(file))?;
        let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<String>>();
        let mut lines = text
            .lines()
            .filter(|line| !line.starts_with('#'))
            .map(cells);
        let names = lines.next().ok_or("an empty table")?;
        let rows: Vec<_> = lines.collect();
        if rows.iter().any(|row| row.len() != names.len()) {
            return Err(format!("{file} has rows of unequal length").into());
        }
        Ok(Self { names, rows })
    }

    /// The rows that begin with a word.
    #[must_use]
    pub fn rows_of(&self, word: &str) -> Self {
        let rows = self.rows.iter().filter(|row| row[0] == word);
        Self {
            names: self.names.clone(),
            rows: rows.cloned().collect(),
        }
    }

    /// The values of a column.
    ///
    /// # Errors
    /// If there is no such column, or something else in it.
    pub fn column(&self, name: &str) -> Outcome<Vec<f64>> {
        let index = self.names.iter().position(|other| other == name);
        let index = index.ok_or_else(|| format!("no column '{name}'"))?;
        let numbers = self.rows.iter().map(|row| row[index].parse());
        Ok(numbers.collect::<Result<_, _>>()?)
    }
}
