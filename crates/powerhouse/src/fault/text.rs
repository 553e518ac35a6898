//! Faults with the text of their scene file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

#[cfg(feature = "scene-files")]
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::{Fault, Problem};

/// Text of a scene and its path.
#[derive(Default)]
pub struct SceneText {
    /// Path of the file; of a scene that was given as text, the path that it was given under.
    pub path: PathBuf,
    /// Text of the scene.
    pub text: String,
}

impl core::fmt::Debug for SceneText {
    /// The path alone: the text is that of a whole file.
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("SceneText")
            .field("path", &self.path)
            .finish_non_exhaustive()
    }
}

impl SceneText {
    /// Line and column of a byte offset, both from one; columns count characters.
    pub fn position(&self, byte: usize) -> (usize, usize) {
        let before = &self.text[..self.text.floor_char_boundary(byte)];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        (
            before.matches('\n').count() + 1,
            before[line_start..].chars().count() + 1,
        )
    }
    /// Folder to which paths in the scene are relative.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }
}

/// Fault of a scene file with path, line and column.
pub struct SceneFault {
    text: Arc<SceneText>,
    fault: Fault,
    /// Name of the case with whose keys the scene was read.
    case: Option<String>,
}

impl core::fmt::Debug for SceneFault {
    /// The message, as a program prints it that returns the error from `main`.
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        core::fmt::Display::fmt(self, f)
    }
}

impl SceneFault {
    /// Fault together with the text that it was found in, from which line and column are counted.
    pub fn new(text: Arc<SceneText>, fault: Fault) -> Self {
        Self {
            text,
            fault,
            case: None,
        }
    }
    /// The fault as that of a case of the scene, unless it is that of a case already.
    #[must_use]
    pub fn in_case(mut self, case: &str) -> Self {
        self.case.get_or_insert_with(|| case.into());
        self
    }
    /// Name of the case of the scene in which the fault was found, if it was one.
    pub fn case(&self) -> Option<&str> {
        self.case.as_deref()
    }
    /// The problem, with the case in which it was found.
    fn title(&self) -> String {
        match &self.case {
            Some(case) => format!("in the case '{case}': {}", self.problem()),
            None => self.problem().to_string(),
        }
    }
    /// Type of the fault.
    pub fn problem(&self) -> &Problem {
        &self.fault.problem
    }
    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.text.path
    }
    /// Line and column of the fault, both from one.
    pub fn position(&self) -> (usize, usize) {
        self.text.position(self.fault.span.start)
    }
    #[cfg(feature = "scene-files")]
    /// Formatted message with the lines of the file concerned, the permitted values and the nearest match;
    /// `colours` adds terminal colours.
    pub fn render(&self, colours: bool) -> String {
        let path = self.text.path.display().to_string();
        let title = self.title();
        let start = self.fault.span.start.min(self.text.text.len());
        let mut end = self.fault.span.end.clamp(start, self.text.text.len());
        // The byte range of a table may span many lines: only its first line is shown.
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
            self.title()
        )
    }
}

impl std::error::Error for SceneFault {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.fault.problem.source()
    }
}

impl Problem {
    /// Rejected name, title of the list of permitted names, and the list.
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

/// Nearest name by Levenshtein distance, if the distance is small.
fn nearest<'a>(name: &str, items: &'a [String]) -> Option<&'a str> {
    items
        .iter()
        .map(|item| (distance(name, item), item.as_str()))
        .min()
        .filter(|&(distance, item)| distance <= 1 + name.len().min(item.len()) / 3)
        .map(|(_, item)| item)
}

/// Levenshtein distance.
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
