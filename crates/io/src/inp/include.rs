//! Files that a file includes, in the place of their keyword lines.

use std::borrow::Cow;
use std::path::{Component, Path, PathBuf};

use super::error::{InpError, InpFault, Located};
use super::keyword::Keyword;
use super::line::Lines;
use crate::IoError;

pub(super) const INCLUDE: &str = "*INCLUDE";
/// Files within files, at most.
const DEEPEST: usize = 16;
/// Byte order mark of UTF-8.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Part of the content that comes from one place of one file.
#[derive(Debug)]
struct Segment {
    /// Offset of its first byte in the content.
    start: usize,
    file: Option<PathBuf>,
    /// Number of the line of its first byte in its file, from 1.
    line: usize,
}

/// Content of a file with those that it includes.
#[derive(Debug)]
pub(super) struct Content<'b> {
    pub(super) bytes: Cow<'b, [u8]>,
    segments: Vec<Segment>,
}

fn line_feeds(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| **byte == b'\n').count()
}

impl<'b> Content<'b> {
    /// The content of a file that is in memory, without files that it may include.
    pub(super) fn of_bytes(bytes: &'b [u8], file: Option<PathBuf>) -> Self {
        let bytes = bytes.strip_prefix(MARK).unwrap_or(bytes);
        let (start, line) = (0, 1);
        Self {
            bytes: bytes.into(),
            segments: vec![Segment { start, file, line }],
        }
    }

    /// The content of a file with all files that it includes, which are in its folder or below it; `largest` is the
    /// greatest size of all (bytes).
    pub(super) fn read(bytes: &'b [u8], file: &Path, largest: u64) -> Result<Self, InpError> {
        let own = Self::of_bytes(bytes, Some(file.into()));
        if next_include(&own.bytes, 0).is_none() {
            return Ok(own);
        }
        let mut content = Self {
            bytes: Cow::Owned(Vec::new()),
            segments: Vec::new(),
        };
        let folder = file.parent().unwrap_or(Path::new(""));
        content.append(&own.bytes, file, (folder, DEEPEST), largest)?;
        Ok(content)
    }

    fn append(
        &mut self,
        bytes: &[u8],
        file: &Path,
        (folder, depth): (&Path, usize),
        largest: u64,
    ) -> Result<(), InpError> {
        let bytes = bytes.strip_prefix(MARK).unwrap_or(bytes);
        let own = Content::of_bytes(bytes, Some(file.into()));
        let mut done = 0;
        loop {
            let include = next_include(bytes, done);
            let end = include.unwrap_or(bytes.len());
            self.segments.push(Segment {
                start: self.bytes.len(),
                file: Some(file.into()),
                line: 1 + line_feeds(&bytes[..done]),
            });
            self.bytes.to_mut().extend_from_slice(&bytes[done..end]);
            let Some(offset) = include else { return Ok(()) };
            let mut lines = Lines::new(bytes, offset);
            let Some(line) = lines.next() else {
                return Ok(());
            };
            let keyword = Keyword::read(line, &mut lines);
            done = lines.offset();
            let name = included(&keyword).map_err(|fault| own.complete(fault))?;
            let refused = |fault| own.complete(keyword.fault(fault));
            if depth == 0 {
                return Err(refused(InpFault::IncludedTooDeep { most: DEEPEST }));
            }
            let inner = folder.join(name);
            let content = crate::read_whole(&inner, largest).map_err(IoError::file(&inner))?;
            if (self.bytes.len() + content.len()) as u64 > largest {
                return Err(refused(InpFault::IncludedTooMuch { most: largest }));
            }
            self.append(&content, &inner, (folder, depth - 1), largest)?;
            if !self.bytes.ends_with(b"\n") {
                self.bytes.to_mut().push(b'\n');
            }
        }
    }

    /// Error with the file and line of a fault.
    pub(super) fn complete(&self, located: Located) -> InpError {
        let offset = located.offset().min(self.bytes.len());
        let last = self
            .segments
            .partition_point(|segment| segment.start <= offset);
        let segment = &self.segments[last.max(1) - 1];
        let line = segment.line + line_feeds(&self.bytes[segment.start..offset]);
        located.complete(segment.file.clone(), line)
    }
}

/// Offset of the next line that includes a file.
fn next_include(bytes: &[u8], from: usize) -> Option<usize> {
    let mut at = from;
    while let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) {
        let end = rest.iter().position(|byte| *byte == b'\n');
        let line = rest[..end.unwrap_or(rest.len())].trim_ascii_start();
        let name = line.get(..INCLUDE.len()).unwrap_or_default();
        if name.eq_ignore_ascii_case(INCLUDE.as_bytes()) {
            return Some(at);
        }
        at += end? + 1;
    }
    None
}

/// Name of the file that a keyword line includes, below the folder of the file.
fn included(keyword: &Keyword<'_>) -> Result<PathBuf, Located> {
    let parameters = keyword.only(&["INPUT"])?;
    let name = parameters
        .required("INPUT")?
        .trim_matches('"')
        .replace('\\', "/");
    let path = PathBuf::from(&name);
    let is_below = path
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if is_below {
        Ok(path)
    } else {
        Err(keyword.fault(InpFault::IncludedElsewhere { name }))
    }
}
