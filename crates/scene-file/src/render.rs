//! Faults of scene files as text with the lines concerned.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use powerhouse_scene::{Problem, SceneFault};

/// Drawing of a fault of a scene file.
pub trait RenderFault {
    /// Message of the fault with the lines of the file concerned, the permitted values and the nearest match; `colours`
    /// adds terminal colours.
    fn render(&self, colours: bool) -> String;
}

impl RenderFault for SceneFault {
    fn render(&self, colours: bool) -> String {
        let text = self.text();
        let path = text.path.display().to_string();
        let span = self.span();
        let start = span.start.min(text.text.len());
        let mut end = span.end.clamp(start, text.text.len());
        // The byte range of a table may span many lines: only its first line is shown.
        if let Some(line) = text.text[start..end].find('\n') {
            end = start + line;
        }
        let snippet = Snippet::source(text.text.as_str())
            .path(path)
            .annotation(AnnotationKind::Primary.span(start..end));
        let mut group = Level::ERROR.primary_title(self.title()).element(snippet);
        if let Some((name, what, items)) = permitted(self.problem()) {
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
        if let Some(help) = self.help() {
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

/// Rejected name, title of the list of permitted names, and the list.
fn permitted(problem: &Problem) -> Option<(&str, &str, &[String])> {
    match problem {
        Problem::UnknownKey { key, permitted } => Some((key, "keys permitted here", permitted)),
        Problem::UnknownChoice { found, permitted } => Some((found, "permitted here", permitted)),
        Problem::NoSuchName {
            name, available, ..
        } => Some((name, "available", available)),
        _ => None,
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
