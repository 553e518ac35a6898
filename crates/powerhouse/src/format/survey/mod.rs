//! Plausibility check of a scene file: repeated list entries, bands with the higher frequency first, invalid
//! names, and quantities outside their usual range.
//!
//! It checks the parsed text, in which every value has its byte range, including tables of registered laws and
//! all cases.

mod magnitudes;

use core::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::fault::{Fault, Problem};
use crate::magnitude::Magnitude;

/// Largest number of characters of a name: files are named after it, and most systems permit 255 bytes.
const LONGEST_NAME: usize = 100;
/// Largest number of characters of a title.
const LONGEST_TITLE: usize = 1000;
/// Key of two frequencies, the lower one first. A damping band is checked where its mechanisms are fitted.
const FREQUENCIES: &str = "frequencies";

/// Checks the text of a scene and returns the quantities outside their usual range, each with its byte range.
///
/// # Errors
/// The first fault of another kind.
pub(crate) fn survey(text: &str) -> Result<Vec<(Magnitude, Range<usize>)>, Fault> {
    let root = DeTable::parse(text).map_err(Fault::from_toml)?;
    let mut survey = Survey::default();
    survey.table(root.get_ref(), "")?;
    Ok(survey.magnitudes)
}

#[derive(Default)]
struct Survey {
    magnitudes: Vec<(Magnitude, Range<usize>)>,
}

impl Survey {
    fn table(&mut self, table: &DeTable, of: &str) -> Result<(), Fault> {
        for (key, value) in table {
            let key = &**key.get_ref();
            if let ("name" | "title", DeValue::String(text)) = (key, value.get_ref()) {
                check_text(key, text, value.span())?;
            }
            self.value(value, (of, key))?;
        }
        Ok(())
    }

    /// Checks a value under a key of a table; `of` is the key of the table.
    fn value(&mut self, value: &Spanned<DeValue>, (of, key): (&str, &str)) -> Result<(), Fault> {
        match value.get_ref() {
            DeValue::Table(table) => self.table(table, key)?,
            DeValue::Array(entries) => {
                check_repeats(entries, (of, key))?;
                if let ([low, high], true) = (&entries[..], key == FREQUENCIES) {
                    check_band(number(low.get_ref()), number(high.get_ref()), value.span())?;
                }
                for entry in entries {
                    self.value(entry, (of, key))?;
                }
            }
            other => {
                if let Some(number) = number(other)
                    && let Err(magnitude) = magnitudes::of(of, key).check(key, number)
                {
                    self.magnitudes.push((magnitude, value.span()));
                }
            }
        }
        Ok(())
    }
}

/// Numerical value of an integer or float.
fn number(value: &DeValue) -> Option<f64> {
    match value {
        DeValue::Integer(digits) => {
            let digits = (digits.as_str(), digits.radix());
            i128::from_str_radix(digits.0, digits.1)
                .ok()
                .map(|number| number as f64)
        }
        DeValue::Float(digits) => digits.as_str().parse().ok(),
        _ => None,
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
fn check_repeats(entries: &[Spanned<DeValue>], (of, key): (&str, &str)) -> Result<(), Fault> {
    for (index, entry) in entries.iter().enumerate() {
        let value = entry.get_ref();
        let before = entries[..index].iter().map(Spanned::get_ref);
        match value {
            DeValue::String(text) if before.clone().any(|other| same(other, value)) => {
                let problem = Problem::Repeated {
                    list: key.to_owned(),
                    entry: text.to_string(),
                };
                return Err(Fault::new(entry.span(), problem));
            }
            DeValue::Table(table) => {
                let name = name_of(table);
                let changes = of == "case" || (of, key) == ("stage", "part");
                if let (Some(name), true) = (name, changes) {
                    let is_named = |other: &DeValue| {
                        let table = other.as_table();
                        table.and_then(name_of).is_some_and(|other| other == name)
                    };
                    if before.into_iter().any(is_named) {
                        let problem = Problem::Repeated {
                            list: key.to_owned(),
                            entry: name.to_owned(),
                        };
                        return Err(Fault::new(entry.span(), problem));
                    }
                } else if table.get("name").is_none()
                    && key != "part"
                    && before.into_iter().any(|other| same(other, value))
                {
                    let list = key.to_owned();
                    return Err(Fault::new(entry.span(), Problem::SameEntry { list }));
                }
            }
            DeValue::Array(_) if before.into_iter().any(|other| same(other, value)) => {
                let list = key.to_owned();
                return Err(Fault::new(entry.span(), Problem::SameEntry { list }));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Identifier of a table: its name or its set.
fn name_of<'t>(table: &'t DeTable) -> Option<&'t str> {
    let named = table.get("name").or_else(|| table.get("set"))?;
    named.get_ref().as_str()
}

/// Returns whether two values are equal, regardless of their byte ranges.
fn same(a: &DeValue, b: &DeValue) -> bool {
    match (a, b) {
        (DeValue::Array(a), DeValue::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a.get_ref(), b.get_ref()))
        }
        (DeValue::Table(a), DeValue::Table(b)) => {
            a.len() == b.len()
                && a.iter().all(|(key, value)| {
                    let other = b.get(&**key.get_ref());
                    other.is_some_and(|other| same(value.get_ref(), other.get_ref()))
                })
        }
        _ => match (number(a), number(b)) {
            (Some(a), Some(b)) => a == b,
            (None, None) => a.as_str() == b.as_str() && a.as_bool() == b.as_bool(),
            _ => false,
        },
    }
}
