//! The glossary names what exists.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use super::manifests::workspace;
use super::sources::rust_files;

/// Whether a line has a name as a whole identifier.
fn has_name(line: &str, name: &str) -> bool {
    line.split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .any(|identifier| identifier == name)
}

/// The cells of the tables in a page, row by row, without heads and rules.
fn rows(page: &str) -> Vec<Vec<&str>> {
    let rows = page
        .lines()
        .filter_map(|line| line.strip_prefix('|')?.strip_suffix('|'));
    rows.map(|row| row.split('|').map(str::trim).collect())
        .filter(|cells: &Vec<&str>| !cells[0].starts_with("---") && cells[0] != "term")
        .collect()
}

/// The names in a cell: what is between backticks, taken apart at `::` and without brackets.
fn code_names(cell: &str) -> Vec<String> {
    let spans = cell.split('`').skip(1).step_by(2);
    spans
        .flat_map(|span| span.split("::"))
        .map(|name| name.trim_matches(|c| "[]() ".contains(c)).to_owned())
        .collect()
}

/// The glossary has 60 to 80 terms, each once and with a meaning, and every name of code in its last column
/// occurs in the sources.
#[test]
fn the_glossary_names_what_exists() {
    let page = fs::read_to_string(workspace().join("docs/words.md")).unwrap();
    let sources: Vec<(PathBuf, String)> = rust_files()
        .into_iter()
        .filter(|(path, _)| path.starts_with(workspace().join("crates")))
        .collect();
    let occurs = |name: &str| {
        // Files and tables of scenes have a point in their name, and so have no identifier.
        let by_key = |name: &str| sources.iter().any(|(_, text)| has_name(text, name));
        let is_file = sources
            .iter()
            .any(|(_, text)| text.contains(&format!("{name}\"")));
        by_key(name) || is_file || (name.starts_with("output.") && name.split('.').all(by_key))
    };
    let rows = rows(&page);
    let mut wrong = Vec::new();
    let mut terms = BTreeSet::new();
    for cells in &rows {
        if cells.len() != 4 || cells[1].is_empty() || !terms.insert(cells[0]) {
            wrong.push(format!("not one row of four cells: {cells:?}"));
            continue;
        }
        for name in code_names(cells[3]) {
            if !occurs(&name) {
                wrong.push(format!("'{}': no source names `{name}`", cells[0]));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!((60..=90).contains(&rows.len()), "{} terms", rows.len());
}
