//! Names, documentation and messages use the standard terms of the field.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::manifests::workspace;
use super::sources::{files_below, rust_files};

/// How an expression is compared with a text.
#[derive(Clone, Copy, PartialEq)]
enum By {
    /// Word by word, in any case, across line ends; names are taken apart at `_` and at capitals.
    Words,
    /// As a whole identifier, in this case: the words are in use outside of names.
    Name,
}

/// An expression of this project's own and the standard term in its place.
struct Private {
    by: By,
    expressions: &'static [&'static str],
    standard: &'static str,
}

const fn words(expressions: &'static [&'static str], standard: &'static str) -> Private {
    Private {
        by: By::Words,
        expressions,
        standard,
    }
}

const fn names(expressions: &'static [&'static str], standard: &'static str) -> Private {
    Private {
        by: By::Name,
        expressions,
        standard,
    }
}

/// Expressions that are not used, with the standard term.
const PRIVATE: &[Private] = &[
    words(
        &["remember", "remembers", "remembered", "remembering"],
        "history (internal state) variables; keeps",
    ),
    words(
        &[
            "what has become of",
            "what became of",
            "what becomes of",
            "what is left when all is gone",
        ],
        "state, outcome or result of",
    ),
    words(
        &[
            "yields whether",
            "yields how",
            "yields what",
            "yields which",
            "yields if",
        ],
        "returns; to yield is to flow plastically",
    ),
    words(
        &[
            "tells",
            "is told",
            "are told",
            "was told",
            "were told",
            "be told",
            "been told",
            "told of",
            "told by",
            "tell of",
            "does not tell",
        ],
        "returns, reports, states, warns of; is passed to; input of",
    ),
    words(
        &[
            "law is asked",
            "laws are asked",
            "law answers",
            "laws answer",
            "asks the law",
        ],
        "the law is evaluated; the law returns",
    ),
    words(
        &[
            "come to rest",
            "comes to rest",
            "came to rest",
            "coming to rest",
            "bring to rest",
            "brings to rest",
            "brought to rest",
            "bring the body to rest",
            "brings the body to rest",
            "brings a body to rest",
            "of rest",
            "unrest",
            "restless",
        ],
        "static equilibrium; reaches static equilibrium; equilibrated",
    ),
    names(&["BodyAtRest"], "EquilibratedBody"),
    words(&["wish", "wishes", "wished"], "request, requested; goal"),
    words(&["hearing"], "progress callback, cancellation flag"),
    words(&["outlook"], "prediction"),
    names(&["Bench"], "comparison runs"),
    words(
        &["books", "booked", "in the account"],
        "energy bookkeeping; accounted for",
    ),
    words(&["hanging"], "embedded (interpolated)"),
    words(&["ghost", "ghosts"], "orphan node; pseudo-mass"),
    words(&["lasting"], "staged load; permanent (displacement)"),
    names(&["Driven"], "prescribed motion"),
    names(&["Acting"], "applied loads"),
    words(&["slider", "sliders"], "roller-supported node"),
    words(&["stands"], "is; remains; occurs"),
    names(
        &["Stand"],
        "state of a batch of elements: trial, committed, changed",
    ),
    words(&["doubt", "doubts", "doubtful"], "warning"),
    names(
        &["Stepping"],
        "rate-independent (static) and time-discretised (dynamic) form of a law",
    ),
    names(&["Told"], "report, message"),
    words(&["in vain"], "without result"),
    words(
        &["audience", "between its kick and its drift"],
        "time loop with output callbacks, between velocity and displacement update",
    ),
    words(
        &["the greatest of it"],
        "envelope (maximum over time) of internal state variables",
    ),
    words(
        &["need more than a mass", "needs more than a mass"],
        "nodes with constraints or boundary impedance",
    ),
    words(
        &["over the least of one with some"],
        "pseudo-mass ratio of orphan nodes",
    ),
    words(
        &["nothing but a commit follows", "nor a question about it"],
        "in-place update of state variables is permitted",
    ),
    words(
        &["put in when the body had already moved"],
        "elements activated (birth) with a stress-free reference configuration",
    ),
    words(
        &["act beside the loads"],
        "nodal forces of reactions and residuals carried over from the static stage",
    ),
    words(
        &["in a motion whose steps have one length"],
        "time-discretised (dynamic) form of a law",
    ),
    words(
        &["no choice repeats", "unrepeated", "larger by a millionth"],
        "not reproducible; perturbation test",
    ),
    names(&["NUDGE", "NUDGED"], "perturbation"),
    words(
        &["who may stop a case", "how it goes"],
        "progress callback and cancellation flag",
    ),
    words(
        &["idle kernel", "idle kernels"],
        "kernel that is named for a part without elements of its kind",
    ),
];

/// A use of an expression that is right, and why.
struct Permitted {
    /// End of the path of the file; empty for every file.
    file: &'static str,
    expression: &'static str,
    /// What a text has there, in words, from the expression on.
    as_in: &'static str,
}

/// Uses that are right.
const PERMITTED: &[Permitted] = &[
    // An abbreviation or symbol stands for what it abbreviates.
    Permitted {
        file: "",
        expression: "stands",
        as_in: "stands for",
    },
    // The name of a section of Gmsh's format.
    Permitted {
        file: "crates/io/src/gmsh/read.rs",
        expression: "ghost",
        as_in: "ghost elements",
    },
];

/// A word of a text and its line; none where a sentence, or a piece of code, ends.
struct Word {
    text: Option<String>,
    line: usize,
}

/// The words of a text in lower case, names taken apart at `_` and before capitals.
fn words_of(text: &str) -> Vec<Word> {
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let mut word = String::new();
        let mut after_small = false;
        for c in line.chars().chain([' ']) {
            let next_part = c.is_uppercase() && after_small;
            if (!c.is_alphanumeric() || next_part) && !word.is_empty() {
                found.push(Word {
                    text: Some(std::mem::take(&mut word)),
                    line: number + 1,
                });
            }
            if ".;!?".contains(c) {
                found.push(Word {
                    text: None,
                    line: number + 1,
                });
            }
            if c.is_alphanumeric() {
                word.extend(c.to_lowercase());
            }
            after_small = c.is_lowercase() || c.is_numeric();
        }
    }
    found
}

/// Whether words begin with those of an expression.
fn begin_with(words: &[Word], expression: &str) -> bool {
    let mut wanted = expression.split(' ');
    let mut given = words.iter();
    wanted.all(|wanted| given.next().and_then(|word| word.text.as_deref()) == Some(wanted))
}

/// Whether a line has a name as a whole identifier.
fn has_name(line: &str, name: &str) -> bool {
    line.split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .any(|identifier| identifier == name)
}

/// Line, expression and standard term of each private expression in a text.
fn private_in(path: &Path, text: &str) -> Vec<(usize, &'static str, &'static str)> {
    let words = words_of(text);
    let mut found = Vec::new();
    for entry in PRIVATE {
        for &expression in entry.expressions {
            let mut lines = BTreeSet::new();
            if entry.by == By::Name {
                let with = text.lines().enumerate();
                let with = with.filter(|(_, line)| has_name(line, expression));
                lines.extend(with.map(|(number, _)| number + 1));
            } else {
                for (first, word) in words.iter().enumerate() {
                    let right = |permitted: &Permitted| {
                        permitted.expression == expression
                            && path.ends_with(permitted.file)
                            && begin_with(&words[first..], permitted.as_in)
                    };
                    if begin_with(&words[first..], expression) && !PERMITTED.iter().any(right) {
                        lines.insert(word.line);
                    }
                }
            }
            found.extend(
                lines
                    .into_iter()
                    .map(|line| (line, expression, entry.standard)),
            );
        }
    }
    found
}

/// Path and text of the sources, of the README, of the pages in `docs/` and of the scenes.
///
/// The changelog is not among them: it names what was renamed.
fn texts() -> Vec<(PathBuf, String)> {
    let mut texts = rust_files();
    // This file names the expressions.
    texts.retain(|(path, _)| !path.ends_with("architecture/words.rs"));
    let root = workspace();
    let mut pages = vec![root.join("README.md")];
    for (folder, extension) in [("docs", "md"), ("data/scenes", "toml")] {
        let files = files_below(&root.join(folder));
        pages.extend(
            files
                .into_iter()
                .filter(|path| path.extension().is_some_and(|e| e == extension)),
        );
    }
    texts.extend(pages.into_iter().map(|path| {
        let text = fs::read_to_string(&path).unwrap();
        (path, text)
    }));
    texts
}

/// Names, comments, documentation, messages, pages and scenes use the standard terms: all
/// exceptions are listed at once, with the term to use.
#[test]
fn texts_use_standard_terms() {
    let mut found = Vec::new();
    for (path, text) in texts() {
        let short = path.strip_prefix(workspace()).unwrap();
        for (line, expression, standard) in private_in(&path, &text) {
            found.push(format!(
                "{}:{line}: '{expression}': {standard}",
                short.display()
            ));
        }
    }
    assert!(
        found.is_empty(),
        "{} private expressions\n{}",
        found.len(),
        found.join("\n")
    );
}

/// The search finds words in any case, across line ends and in names, and not within other words.
#[test]
fn private_expressions_are_found() {
    let lines = |text: &str| -> Vec<(usize, &str)> {
        let found = private_in(Path::new("a.rs"), text);
        found
            .iter()
            .map(|(line, found, _)| (*line, *found))
            .collect()
    };
    assert_eq!(lines("/// What a law\n/// Remembers."), [(2, "remembers")]);
    assert_eq!(
        lines("/// The body comes\n/// to rest."),
        [(1, "comes to rest")]
    );
    assert_eq!(lines("struct HistoryWish;"), [(1, "wish")]);
    assert_eq!(lines("fn wishes_of() {}"), [(1, "wishes")]);
    assert_eq!(lines("struct Stand;"), [(1, "Stand")]);
    assert_eq!(
        lines("// bookkeeping, stepping, a stand; it comes. To rest"),
        []
    );
    assert_eq!(lines("// G stands for the shear modulus"), []);
    assert_eq!(lines("// it stands here"), [(1, "stands")]);
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
