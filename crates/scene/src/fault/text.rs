//! Faults with the text of their scene file.

use core::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

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
    /// The problem in words, with the case in which it was found.
    pub fn title(&self) -> String {
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
    /// The text that the fault was found in.
    pub fn text(&self) -> &Arc<SceneText> {
        &self.text
    }
    /// Byte range of the fault in the text.
    pub fn span(&self) -> Range<usize> {
        self.fault.span.clone()
    }
    /// Hint on how to correct the fault.
    pub fn help(&self) -> Option<&'static str> {
        self.fault.help
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
