//! The atlas as a table, computed and stored.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::cell::{Cell, Row};
use super::column::Column;

/// File of the atlas.
const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/extremes.md");

/// All cells of some rows.
///
/// # Panics
/// With all cells that are neither stable nor refused before their first step.
pub(super) fn fill(rows: &[Row]) -> Vec<Vec<Cell>> {
    let next = AtomicUsize::new(0);
    let found = Mutex::new(Vec::new());
    let lock = || found.lock().unwrap_or_else(PoisonError::into_inner);
    let work = || {
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let (row, column) = (place / Column::ALL.len(), place % Column::ALL.len());
            let Some(row) = rows.get(row) else { break };
            let cell = (row.cell)(&Column::ALL[column]);
            lock().push((place, cell));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(work);
        }
    });
    let mut found = std::mem::take(&mut *lock());
    found.sort_by_key(|(place, _)| *place);
    let mut faults = Vec::new();
    let mut cells = Vec::new();
    for (place, cell) in found {
        let row = &rows[place / Column::ALL.len()].name;
        let column = Column::ALL[place % Column::ALL.len()].name;
        match cell {
            Ok(cell) => cells.push(cell),
            Err(fault) => faults.push(format!("{row} | {column}: {fault}")),
        }
    }
    assert!(
        faults.is_empty(),
        "{} cells:\n{}",
        faults.len(),
        faults.join("\n")
    );
    cells.chunks(Column::ALL.len()).map(<[_]>::to_vec).collect()
}

/// A message without its numbers, which may differ in their last digits from machine to machine.
fn without_numbers(message: &str) -> String {
    let word = |word: &str| {
        let bare = word.trim_matches(|c: char| "(),;:[]%".contains(c));
        match bare.parse::<f64>() {
            Ok(_) => word.replace(bare, "…"),
            Err(_) => word.to_owned(),
        }
    };
    message.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// The table under a heading, with the reasons of refusals below it.
fn table(heading: &str, rows: &[Row], cells: &[Vec<Cell>]) -> String {
    let columns = Column::ALL.map(|column| column.name);
    let mut reasons: Vec<String> = Vec::new();
    let mut text = format!("## {heading}\n\n| | {} |\n", columns.join(" | "));
    text += &format!("|---|{}\n", "---|".repeat(columns.len()));
    for (row, cells) in rows.iter().zip(cells) {
        let cells: Vec<String> = (cells.iter())
            .map(|cell| match cell {
                Cell::Stable => "stable".into(),
                Cell::Refused(reason) => {
                    let reason = without_numbers(reason);
                    let known = reasons.iter().position(|other| *other == reason);
                    let place = known.unwrap_or_else(|| {
                        reasons.push(reason);
                        reasons.len() - 1
                    });
                    format!("refused ({})", place + 1)
                }
            })
            .collect();
        text += &format!("| {} | {} |\n", row.name, cells.join(" | "));
    }
    text += "\n";
    for (place, reason) in reasons.iter().enumerate() {
        text += &format!("{}. {reason}\n", place + 1);
    }
    text
}

/// Compares a table with the stored one under its heading, or writes it there if the environment variable is
/// set.
///
/// # Panics
/// If they differ.
pub(super) fn compare(heading: &str, rows: &[Row], cells: &[Vec<Cell>]) {
    let fresh = table(heading, rows, cells);
    let file = Path::new(FILE);
    let text = std::fs::read_to_string(file).expect("the atlas in the documentation");
    let start = text.find(&format!("## {heading}\n")).expect("its heading");
    let length = text[start + 3..].find("\n## ").map(|next| next + 4);
    let end = length.map_or(text.len(), |length| start + length);
    if std::env::var("POWERHOUSE_ATLAS").is_ok_and(|mode| mode == "write") {
        let gap = if end < text.len() { "\n" } else { "" };
        let whole = format!("{}{fresh}{gap}{}", &text[..start], &text[end..]);
        std::fs::write(file, whole).expect("the atlas is written");
        return;
    }
    assert_eq!(
        text[start..end].trim_end(),
        fresh.trim_end(),
        "the atlas in docs/extremes.md is another one; POWERHOUSE_ATLAS=write writes it anew"
    );
}
