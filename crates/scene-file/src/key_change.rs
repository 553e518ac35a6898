//! Changes of single keys of scene files, as from a command line.

use core::fmt;
use core::str::FromStr;

use powerhouse_scene::KeyChangeError;
use toml_edit::{ArrayOfTables, DocumentMut, Item, Key, TableLike, Value};

use crate::spec::NAMED;

/// Change of a key of a scene file, such as `time.duration=5` or `part.lining.kernel=hex8-eas`.
///
/// Before the equals sign are the tables and the key, with points between them. Of several tables of one kind its
/// `name` says which is meant, or its `set`, or its position from 1; a single table needs neither. After it is a
/// value of TOML; texts need no quotes. A key that the file does not have is added.
///
/// ```
/// use powerhouse_scene_file::KeyChange;
/// let change: KeyChange = "wave.1.incidence=30".parse()?;
/// assert_eq!(change.to_string(), "wave.1.incidence=30");
/// assert!("duration".parse::<KeyChange>().is_err());
/// # Ok::<(), powerhouse_scene::KeyChangeError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyChange {
    /// Names of tables and entries of lists on the way to the key.
    way: Vec<String>,
    key: String,
    /// Value, as it was given.
    value: String,
    text: String,
}

impl FromStr for KeyChange {
    type Err = KeyChangeError;
    fn from_str(text: &str) -> Result<Self, KeyChangeError> {
        let refused = || KeyChangeError::Syntax { text: text.into() };
        let (keys, value) = split(text).ok_or_else(refused)?;
        let keys = Key::parse(keys).map_err(|_| refused())?;
        let mut way: Vec<String> = keys.iter().map(|key| key.get().to_owned()).collect();
        let (key, value) = (way.pop().ok_or_else(refused)?, value.trim().to_owned());
        if value.is_empty() {
            return Err(refused());
        }
        let text = text.trim().into();
        Ok(Self {
            way,
            key,
            value,
            text,
        })
    }
}

impl fmt::Display for KeyChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl KeyChange {
    /// Another duration of the run (s).
    pub fn duration(seconds: f64) -> Self {
        let [table, key] = ["time", "duration"].map(String::from);
        let value = format!("{seconds:?}");
        Self {
            text: format!("{table}.{key}={value}"),
            way: vec![table],
            key,
            value,
        }
    }

    /// The text of a scene file with changed keys, those that a case of it has for itself included; comments and the order of
    /// keys are kept. Text that is not TOML comes back as it is.
    ///
    /// # Errors
    /// Tables on the way that do not exist or are not tables.
    pub fn apply(
        text: &str,
        case: Option<&str>,
        changes: &[Self],
    ) -> Result<String, KeyChangeError> {
        let document = text.parse::<DocumentMut>();
        let Ok(mut document) = document else {
            return Ok(text.to_owned());
        };
        for change in changes {
            change.make(document.as_table_mut())?;
            if let Some(own) = case.and_then(|case| own_table(&mut document, case)) {
                change.make_in_case(own)?;
            }
        }
        Ok(document.to_string())
    }

    /// Changes a key of a case, as far as the case has the table for itself.
    fn make_in_case(&self, case: &mut toml_edit::Table) -> Result<(), KeyChangeError> {
        let Some(section) = self
            .way
            .first()
            .filter(|section| case.contains_key(section))
        else {
            return Ok(());
        };
        match self.make(case) {
            // Of these the case has those alone that it changes.
            Err(KeyChangeError::NoSuchTable { .. })
                if NAMED.iter().any(|(of, _)| of == section) =>
            {
                Ok(())
            }
            made => made,
        }
    }

    fn make(&self, root: &mut toml_edit::Table) -> Result<(), KeyChangeError> {
        let mut table: &mut dyn TableLike = root;
        let mut way = self.way.iter().peekable();
        while let Some(key) = way.next() {
            let item = table.entry(key).or_insert_with(toml_edit::table);
            if let Item::Value(Value::Array(_)) = item {
                as_tables(item);
            }
            table = match item {
                Item::ArrayOfTables(tables) => {
                    let named = way.peek().and_then(|name| position(tables, name));
                    let place = match (named, tables.len()) {
                        (Some(place), _) => {
                            way.next();
                            place
                        }
                        (None, 1)
                            if way.peek().is_none_or(|next| next.parse::<usize>().is_err()) =>
                        {
                            0
                        }
                        (None, count) => {
                            return Err(KeyChangeError::NoSuchTable {
                                text: self.text.clone(),
                                key: key.clone(),
                                names: tables.iter().filter_map(name).map(String::from).collect(),
                                count,
                            });
                        }
                    };
                    match tables.get_mut(place) {
                        Some(table) => table,
                        None => return Err(self.not_a_table(key)),
                    }
                }
                other => match other.as_table_like_mut() {
                    Some(table) => table,
                    None => return Err(self.not_a_table(key)),
                },
            };
        }
        let mut value = (self.value.parse::<Value>()).unwrap_or_else(|_| Value::from(&*self.value));
        match table.get_mut(&self.key) {
            Some(Item::Value(old)) => {
                *value.decor_mut() = old.decor().clone();
                *old = value;
            }
            _ => {
                table.insert(&self.key, Item::Value(value));
            }
        }
        Ok(())
    }

    fn not_a_table(&self, key: &str) -> KeyChangeError {
        KeyChangeError::NotATable {
            text: self.text.clone(),
            key: key.into(),
        }
    }
}

/// The table of a case.
fn own_table<'d>(document: &'d mut DocumentMut, case: &str) -> Option<&'d mut toml_edit::Table> {
    let cases = document.get_mut("case")?;
    if let Item::Value(Value::Array(_)) = cases {
        as_tables(cases);
    }
    let cases = cases.as_array_of_tables_mut()?;
    cases.iter_mut().find(|table| name(table) == Some(case))
}

/// The text before and after the first equals sign that is not in quotes.
fn split(text: &str) -> Option<(&str, &str)> {
    let mut quote = None;
    for (place, letter) in text.char_indices() {
        match (quote, letter) {
            (None, '=') => return Some((&text[..place], &text[place + 1..])),
            (None, '"' | '\'') => quote = Some(letter),
            (Some(open), _) if open == letter => quote = None,
            _ => {}
        }
    }
    None
}

/// Turns a list of tables in braces into a list of tables under headings, which has the same meaning.
fn as_tables(item: &mut Item) {
    let old = core::mem::take(item);
    *item = match old.into_array_of_tables() {
        Ok(tables) => Item::ArrayOfTables(tables),
        Err(old) => old,
    };
}

/// Name of a table of a list: of parts that of their element set.
fn name(table: &toml_edit::Table) -> Option<&str> {
    ["name", "set"]
        .into_iter()
        .find_map(|key| table.get(key)?.as_str())
}

/// Index of the table with a name, or at a position from 1.
fn position(tables: &ArrayOfTables, wanted: &str) -> Option<usize> {
    let mut named = (tables.iter().enumerate()).filter(|(_, table)| name(table) == Some(wanted));
    match (named.next(), named.next()) {
        (Some((place, _)), None) => Some(place),
        (Some(_), Some(_)) => None,
        (None, _) => {
            let place = wanted.parse::<usize>().ok()?.checked_sub(1)?;
            (place < tables.len()).then_some(place)
        }
    }
}
