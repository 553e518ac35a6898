//! Public interfaces can grow, and parameters have names.

use std::path::Path;

use super::manifests::workspace;
use super::sources::rust_files;

/// Public structures and enumerations that are to get further fields and variants without breaking users: the
/// files that declare them, and their names.
const OPEN: [(&str, &[&str]); 12] = [
    (
        "model/src/boundary.rs",
        &["BoundarySite", "BoundaryParts", "NodalImpedance"],
    ),
    (
        "model/src/engine.rs",
        &["MassDampingRule", "Fields", "Cadence"],
    ),
    ("model/src/state.rs", &["State", "HistoryField"]),
    ("model/src/run.rs", &["EnergyCheck", "RunOptions"]),
    ("scene/src/simulation.rs", &["RunHooks"]),
    (
        "scene/src/output/plan.rs",
        &[
            "OutputPlan",
            "HistoryRequest",
            "StressRequest",
            "RelativeRequest",
            "SectionRequest",
            "EnvelopeRequest",
            "JointRequest",
            "SnapshotRequest",
            "StateRequest",
        ],
    ),
    ("scene/src/output/results.rs", &["Results"]),
    ("scene/src/message.rs", &["RunNotes"]),
    ("scene/src/stage/overview.rs", &["StageOverview"]),
    ("scene/src/stage/rest.rs", &["CompletedStage"]),
    (
        "scene-file/src/overview.rs",
        &["InputOverview", "WaveOverview"],
    ),
    ("study/src/advice/candidate.rs", &["BoundaryKind"]),
];

/// Whether the attributes before a declaration, without a blank line between, contain one.
fn has_attribute(text: &str, declaration: usize, attribute: &str) -> bool {
    let before = text[..declaration].rsplit("\n\n").next().unwrap_or("");
    before.lines().any(|line| line.trim() == attribute)
}

/// What must grow is open to growth.
#[test]
fn structures_that_must_grow_are_open() {
    for (file, names) in OPEN {
        let path = workspace().join("crates").join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        for name in names {
            let is_it = |rest: &str| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_');
            let found = ["struct", "enum"].iter().find_map(|kind| {
                let start = format!("pub {kind} {name}");
                let mut places = text.match_indices(&start);
                places.find(|(place, _)| is_it(&text[place + start.len()..]))
            });
            let (place, _) = found.unwrap_or_else(|| panic!("{file} declares no {name}"));
            assert!(
                has_attribute(&text, place, "#[non_exhaustive]"),
                "{name} in {file} is closed"
            );
        }
    }
}

/// The text between an opening bracket and its closing one.
fn bracketed(text: &str) -> &str {
    let mut depth = 0;
    for (place, letter) in text.char_indices() {
        match letter {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return &text[1..place];
        }
    }
    text
}

/// Parts between the separators that stand in no brackets, arrows and comparisons aside.
fn parts(text: &str, separator: char) -> Vec<&str> {
    let (mut parts, mut depth, mut start, mut before) = (Vec::new(), 0, 0, ' ');
    for (place, letter) in text.char_indices() {
        match letter {
            '(' | '[' | '{' | '<' => depth += 1,
            '>' if before == '-' || before == '=' => {}
            ')' | ']' | '}' | '>' => depth -= 1,
            _ if letter == separator && depth == 0 => {
                parts.push(&text[start..place]);
                start = place + letter.len_utf8();
            }
            _ => {}
        }
        before = letter;
    }
    parts.push(&text[start..]);
    parts.retain(|part| !part.trim().is_empty());
    parts
}

/// Whether a type is a tuple of three or more, or a reference to one.
fn is_long_tuple(of_type: &str) -> bool {
    let mut of_type = of_type.trim().trim_start_matches('&').trim_start();
    if of_type.starts_with('\'') {
        of_type = of_type.split_once(' ').map_or("", |(_, rest)| rest);
    }
    let of_type = of_type.trim_start_matches("mut ").trim_start();
    of_type.starts_with('(') && parts(bracketed(of_type), ',').len() > 2
}

/// Parameters of the functions of a text that are tuples of three or more, with their lines.
fn long_tuples(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (place, word) in text.match_indices("fn ") {
        let before = text[..place].chars().next_back();
        let is_word = before.is_none_or(char::is_whitespace);
        let rest = &text[place + word.len()..];
        let name: usize = rest
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .map(char::len_utf8)
            .sum();
        if !is_word || name == 0 {
            continue;
        }
        let mut rest = &rest[name..];
        if rest.starts_with('<') {
            // Past the generics.
            let (mut depth, mut before) = (0, ' ');
            let end = rest.char_indices().find(|&(_, letter)| {
                match letter {
                    '<' => depth += 1,
                    '>' if before != '-' => depth -= 1,
                    _ => {}
                }
                before = letter;
                depth == 0
            });
            rest = end.map_or("", |(end, _)| &rest[end + 1..]);
        }
        if !rest.starts_with('(') {
            continue;
        }
        let line = 1 + text[..place].matches('\n').count();
        for parameter in parts(bracketed(rest), ',') {
            let typed = parts(parameter, ':');
            if typed.len() == 2 && is_long_tuple(typed[1]) {
                found.push((
                    line,
                    parameter.split_whitespace().collect::<Vec<_>>().join(" "),
                ));
            }
        }
    }
    found
}

/// A function has parameters with names: none is a tuple of three or more values, whose order has no names.
#[test]
fn parameters_have_names() {
    let mut tuples = Vec::new();
    for (path, text) in rust_files() {
        let relative = path.strip_prefix(workspace()).unwrap_or(Path::new(""));
        let found = long_tuples(&text).into_iter();
        tuples.extend(
            found.map(|(line, parameter)| format!("{}:{line}: {parameter}", relative.display())),
        );
    }
    assert!(tuples.is_empty(), "{tuples:#?}");
}

/// What counts as a tuple of three or more, and what does not.
#[test]
fn long_tuples_are_seen() {
    let head = "fn ";
    let function = |parameters: &str| format!("{head}go<T: Fn() -> u8>({parameters}) {{}}");
    for long in [
        "(a, b, c): (f64, Vec<(u8, u8)>, u8)",
        "&self, all: &'a (f64, f64, f64)",
        "first: u8,\n    (a, b, c): (\n        f64,\n        f64,\n        f64,\n    ),\n",
    ] {
        assert_eq!(long_tuples(&function(long)).len(), 1, "{long}");
    }
    for short in [
        "a: f64, b: f64, c: f64",
        "(a, b): (f64, (u8, u8, u8))",
        "of: impl Fn(f64, f64, f64) -> f64, all: &[(u8, u8, u8)]",
    ] {
        assert!(long_tuples(&function(short)).is_empty(), "{short}");
    }
}
