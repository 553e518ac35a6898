//! Plausibility check of a scene file: repeated list entries, bands with the higher frequency first, invalid
//! names, and quantities outside their usual range.
//!
//! It checks the parsed text, in which every value has its byte range, including tables of registered laws and
//! all cases.

mod magnitudes;

use core::ops::Range;

use super::node::{Node, Table, Value};
use powerhouse_scene::magnitude::Magnitude;
use powerhouse_scene::{Fault, Problem};

/// Largest number of characters of a name: files are named after it, and most systems permit 255 bytes.
const LONGEST_NAME: usize = 100;
/// Largest number of characters of a title.
const LONGEST_TITLE: usize = 1000;
/// Key of two frequencies, the lower one first. A damping band is checked where its mechanisms are fitted.
const FREQUENCIES: &str = "frequencies";

/// Checks the tables of a scene and returns the quantities outside their usual range, each with its byte range.
///
/// # Errors
/// The first fault of another kind.
pub(super) fn survey(tables: &Node) -> Result<Vec<(Magnitude, Range<usize>)>, Fault> {
    let mut survey = Survey::default();
    survey.value(tables, ("", ""))?;
    Ok(survey.magnitudes)
}

#[derive(Default)]
struct Survey {
    magnitudes: Vec<(Magnitude, Range<usize>)>,
}

impl Survey {
    fn table(&mut self, table: &Table, of: &str) -> Result<(), Fault> {
        for (key, entry) in table.iter() {
            if let ("name" | "title", Some(text)) = (key, entry.node.as_text()) {
                check_text(key, text, entry.node.span.clone())?;
            }
            self.value(&entry.node, (of, key))?;
        }
        Ok(())
    }

    /// Checks a value under a key of a table; `of` is the key of the table.
    fn value(&mut self, node: &Node, (of, key): (&str, &str)) -> Result<(), Fault> {
        match &node.value {
            Value::Table(table) => self.table(table, key)?,
            Value::List(entries) => {
                check_repeats(entries, (of, key))?;
                if let ([low, high], true) = (&entries[..], key == FREQUENCIES) {
                    check_band(low.as_number(), high.as_number(), node.span.clone())?;
                }
                for entry in entries {
                    self.value(entry, (of, key))?;
                }
            }
            _ => {
                if let Some(number) = node.as_number()
                    && let Err(magnitude) = magnitudes::of(of, key).check(key, number)
                {
                    self.magnitudes.push((magnitude, node.span.clone()));
                }
            }
        }
        Ok(())
    }
}

/// Rejects a name or title that is empty, too long, or contains control characters.
fn check_text(key: &str, text: &str, span: Range<usize>) -> Result<(), Fault> {
    let longest = match key {
        "title" => LONGEST_TITLE,
        _ => LONGEST_NAME,
    };
    let length = text.chars().count();
    let found = if text.trim().is_empty() {
        "nothing".to_owned()
    } else if let Some(control) = text.chars().find(|c| c.is_control()) {
        format!("a control character, U+{:04X}", u32::from(control))
    } else if length > longest {
        format!("{length} characters")
    } else {
        return Ok(());
    };
    let expected = format!("a {key} of 1 to {longest} characters in one line");
    Err(Fault::new(span, Problem::Value { found, expected }))
}

/// Rejects two frequencies of which the first is the higher one.
fn check_band(low: Option<f64>, high: Option<f64>, span: Range<usize>) -> Result<(), Fault> {
    match (low, high) {
        (Some(low), Some(high)) if low > high => {
            let found = format!("{low} Hz before {high} Hz");
            let expected = "the lower frequency first".into();
            Err(Fault::new(span, Problem::Value { found, expected }))
        }
        _ => Ok(()),
    }
}

/// Rejects a list with a repeated text, table or list. Tables with names are checked where the names are
/// resolved, except those that change other tables.
fn check_repeats(entries: &[Node], (of, key): (&str, &str)) -> Result<(), Fault> {
    for (index, entry) in entries.iter().enumerate() {
        let before = &entries[..index];
        let span = entry.span.clone();
        let repeated = |entry: &str| Problem::Repeated {
            list: key.to_owned(),
            entry: entry.to_owned(),
        };
        match &entry.value {
            Value::Text(text) if before.contains(entry) => {
                return Err(Fault::new(span, repeated(text)));
            }
            Value::Table(table) => {
                let name = name_of(table);
                let changes = of == "case" || (of, key) == ("stage", "part");
                if let (Some(name), true) = (name, changes) {
                    let is_named = |other: &Node| other.as_table().and_then(name_of) == Some(name);
                    if before.iter().any(is_named) {
                        return Err(Fault::new(span, repeated(name)));
                    }
                } else if table.get("name").is_none() && key != "part" && before.contains(entry) {
                    let list = key.to_owned();
                    return Err(Fault::new(span, Problem::SameEntry { list }));
                }
            }
            Value::List(_) if before.contains(entry) => {
                let list = key.to_owned();
                return Err(Fault::new(span, Problem::SameEntry { list }));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Identifier of a table: its name or its set.
fn name_of(table: &Table) -> Option<&str> {
    table.get("name").or_else(|| table.get("set"))?.as_text()
}
