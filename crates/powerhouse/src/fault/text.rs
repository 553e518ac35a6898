//! A fault shown in its text.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::{Fault, Problem};

/// A scene's text and where it came from.
#[derive(Debug)]
pub struct SceneText {
    /// The file, or a stand-in for a scene that was given as text.
    pub path: PathBuf,
    /// The text.
    pub text: String,
}

impl SceneText {
    /// Line and column of a byte, both from one; columns count characters.
    pub fn position(&self, byte: usize) -> (usize, usize) {
        let before = &self.text[..self.text.floor_char_boundary(byte)];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        (
            before.matches('\n').count() + 1,
            before[line_start..].chars().count() + 1,
        )
    }
    /// The folder that the scene's paths are relative to.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }
}

/// One fault of a scene file, with file, line and column.
#[derive(Debug)]
pub struct SceneFault {
    text: Arc<SceneText>,
    fault: Fault,
}

impl SceneFault {
    /// A fault of a text.
    pub fn new(text: Arc<SceneText>, fault: Fault) -> Self {
        Self { text, fault }
    }
    /// What is wrong.
    pub fn problem(&self) -> &Problem {
        &self.fault.problem
    }
    /// The file.
    pub fn path(&self) -> &Path {
        &self.text.path
    }
    /// Line and column, both from one.
    pub fn position(&self) -> (usize, usize) {
        self.text.position(self.fault.span.start)
    }
    /// The message with the lines of the file that it points at, what is permitted there and the
    /// nearest match; with terminal colours if wanted.
    pub fn render(&self, colours: bool) -> String {
        let path = self.text.path.display().to_string();
        let title = self.problem().to_string();
        let start = self.fault.span.start.min(self.text.text.len());
        let mut end = self.fault.span.end.clamp(start, self.text.text.len());
        // A table's span may run over many lines: its first line tells where it is.
        if let Some(line) = self.text.text[start..end].find('\n') {
            end = start + line;
        }
        let snippet = Snippet::source(self.text.text.as_str())
            .path(path)
            .annotation(AnnotationKind::Primary.span(start..end));
        let mut group = Level::ERROR.primary_title(title).element(snippet);
        if let Some((name, what, items)) = self.problem().permitted() {
            if let Some(near) = nearest(name, items) {
                group = group.element(Level::HELP.message(format!("did you mean '{near}'?")));
            }
            let list = if items.is_empty() {
                "none".into()
            } else {
                items.join(", ")
            };
            group = group.element(Level::NOTE.message(format!("{what}: {list}")));
        }
        if let Some(help) = self.fault.help {
            group = group.element(Level::HELP.message(help));
        }
        let renderer = if colours {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        renderer.render(&[group])
    }
}

impl core::fmt::Display for SceneFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (line, column) = self.position();
        write!(
            f,
            "{}:{line}:{column}: {}",
            self.path().display(),
            self.problem()
        )
    }
}

impl std::error::Error for SceneFault {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.fault.problem.source()
    }
}

impl Problem {
    /// The list that helps to put it right: what it lists, and its items.
    fn permitted(&self) -> Option<(&str, &str, &[String])> {
        match self {
            Self::UnknownKey { key, permitted } => Some((key, "keys permitted here", permitted)),
            Self::UnknownChoice { found, permitted } => Some((found, "permitted here", permitted)),
            Self::NoSuchName {
                name, available, ..
            } => Some((name, "available", available)),
            _ => None,
        }
    }
}

/// The name that is nearest by insertions, deletions and replacements, if it is near.
fn nearest<'a>(name: &str, items: &'a [String]) -> Option<&'a str> {
    items
        .iter()
        .map(|item| (distance(name, item), item.as_str()))
        .min()
        .filter(|&(distance, item)| distance <= 1 + name.len().min(item.len()) / 3)
        .map(|(_, item)| item)
}

/// Levenshtein's distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = i;
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
