//! Start and end of sections, and `$PhysicalNames`, which both versions share.

use super::cursor::is_blank;
use super::error::{GmshFault, Located, snippet};
use super::raw::GroupNames;

/// Start of a section.
#[derive(Clone, Copy, Debug)]
pub(super) struct Marker<'a> {
    /// Name with the dollar sign.
    pub(super) name: &'a [u8],
    /// Offset of the dollar sign (bytes).
    pub(super) offset: usize,
    /// Offset of the line after the name (bytes).
    pub(super) body: usize,
}

/// End of a section.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    /// Offset of the dollar sign (bytes).
    pub(super) start: usize,
    /// Offset of the byte after the word.
    pub(super) after: usize,
}

/// Next section at or after an offset; `None` at the end of the file.
pub(super) fn next(bytes: &[u8], at: usize) -> Result<Option<Marker<'_>>, Located> {
    let blanks = bytes[at..].iter().take_while(|byte| is_blank(**byte));
    let offset = at + blanks.count();
    let rest = &bytes[offset..];
    if rest.is_empty() {
        return Ok(None);
    }
    let length = line_length(rest);
    let name = rest[..length].trim_ascii_end();
    let word = name.strip_prefix(b"$").unwrap_or_default();
    if word.is_empty() || !word.iter().all(u8::is_ascii_alphanumeric) {
        let found = snippet(rest);
        return Err(Located::new("", offset, GmshFault::Stray { found }));
    }
    Ok(Some(Marker {
        name,
        offset,
        body: (offset + length + 1).min(bytes.len()),
    }))
}

fn line_length(bytes: &[u8]) -> usize {
    let end = bytes.iter().position(|byte| *byte == b'\n');
    end.unwrap_or(bytes.len())
}

impl Marker<'_> {
    pub(super) fn text(&self) -> String {
        String::from_utf8_lossy(self.name).into_owned()
    }
    /// End of the section if it is at this offset, after blanks.
    pub(super) fn end_at(&self, bytes: &[u8], at: usize) -> Option<End> {
        let blanks = bytes[at..].iter().take_while(|byte| is_blank(**byte));
        let start = at + blanks.count();
        let rest = bytes[start..].strip_prefix(b"$End")?;
        let rest = rest.strip_prefix(&self.name[1..])?;
        let after = bytes.len() - rest.len();
        rest.first()
            .is_none_or(|byte| is_blank(*byte))
            .then_some(End { start, after })
    }
    /// End of the section, on a line of its own.
    ///
    /// # Errors
    /// [`GmshFault::NotEnded`] if there is none.
    pub(super) fn end(&self, bytes: &[u8]) -> Result<End, Located> {
        let mut at = self.body;
        while at < bytes.len() {
            let length = line_length(&bytes[at..]);
            let line = bytes[at..at + length].trim_ascii_start();
            if line.starts_with(b"$End")
                && let Some(end) = self.end_at(bytes, at)
            {
                return Ok(end);
            }
            at += length + 1;
        }
        Err(self.not_ended())
    }
    /// End of the section anywhere, for content of unknown structure.
    ///
    /// # Errors
    /// [`GmshFault::NotEnded`] if there is none.
    pub(super) fn end_anywhere(&self, bytes: &[u8]) -> Result<End, Located> {
        (self.body..bytes.len())
            .filter(|&at| bytes[at] == b'$')
            .find_map(|at| self.end_at(bytes, at))
            .ok_or_else(|| self.not_ended())
    }
    pub(super) fn not_ended(&self) -> Located {
        let section = self.text();
        Located::new(&self.text(), self.offset, GmshFault::NotEnded { section })
    }
}

const NAMES: &str = "$PhysicalNames";

/// Names of physical groups, which are text in binary files too: a count, then lines of
/// dimension, number and name in quotes.
pub(super) fn names(bytes: &[u8], body: usize, end: usize) -> Result<GroupNames, Located> {
    let mut names = GroupNames::new();
    let mut at = body;
    let mut stated = None;
    while at < end {
        let length = line_length(&bytes[at..end]);
        let line = &bytes[at..at + length];
        let trimmed = line.trim_ascii();
        let expected = |what| {
            let found = snippet(line);
            Located::new(NAMES, at, GmshFault::Expected { what, found })
        };
        if trimmed.is_empty() {
            at += length + 1;
            continue;
        }
        if stated.is_none() {
            let count = str::from_utf8(trimmed).ok().and_then(|w| w.parse().ok());
            stated = Some(count.ok_or_else(|| expected("the number of names"))?);
        } else {
            let (dimension, group, name) = name(trimmed)
                .ok_or_else(|| expected("dimension, number and UTF-8 name in quotes"))?;
            if names.insert((dimension, group), name).is_some() {
                let fault = GmshFault::RepeatedGroup { dimension, group };
                return Err(Located::new(NAMES, at, fault));
            }
        }
        at += length + 1;
    }
    let found = names.len() as u64;
    match stated {
        Some(stated) if stated == found => Ok(names),
        Some(stated) => {
            let what = "names";
            let fault = GmshFault::Total {
                what,
                stated,
                found,
            };
            Err(Located::new(NAMES, body, fault))
        }
        None => {
            let what = "the number of names";
            Err(Located::new(NAMES, body, GmshFault::Truncated { what }))
        }
    }
}

fn name(line: &[u8]) -> Option<(usize, i32, String)> {
    let line = str::from_utf8(line).ok()?;
    let (numbers, quoted) = line.split_once('"')?;
    let name = quoted.strip_suffix('"')?;
    let mut numbers = numbers.split_ascii_whitespace();
    let dimension = numbers.next()?.parse().ok().filter(|d| *d <= 3)?;
    let group: i32 = numbers.next()?.parse().ok()?;
    (numbers.next().is_none()).then(|| (dimension, group.saturating_abs(), name.into()))
}
