//! Cursor over the numbers of a section, in text or binary form.

use super::error::{GmshFault, Located, snippet};
use super::format::{ByteOrder, Encoding};

/// Reader of numbers in a range of bytes of a file.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    /// First byte after the range.
    pub(super) end: usize,
    pub(super) encoding: Encoding,
    /// Width of a `size_t` in binary files (bytes): 4 or 8.
    pub(super) size_width: usize,
    pub(super) section: &'static str,
}

/// Least number of values of each kind in a record.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RecordSize {
    pub(super) integers: usize,
    pub(super) sizes: usize,
    pub(super) reals: usize,
}

pub(super) fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n')
}

impl<'a> Cursor<'a> {
    pub(super) fn fault(&self, offset: usize, fault: impl Into<GmshFault>) -> Located {
        Located::new(self.section, offset, fault)
    }
    fn is_text(&self) -> bool {
        self.encoding == Encoding::Text
    }
    /// Offset of the next number.
    pub(super) fn offset(&mut self) -> usize {
        if self.is_text() {
            self.skip_blanks();
        }
        self.at
    }
    pub(super) fn skip_blanks(&mut self) {
        while self.at < self.end && is_blank(self.bytes[self.at]) {
            self.at += 1;
        }
    }
    /// Next word of a text.
    fn word(&mut self, what: &'static str) -> Result<(usize, &'a [u8]), Located> {
        self.skip_blanks();
        let start = self.at;
        while self.at < self.end && !is_blank(self.bytes[self.at]) {
            self.at += 1;
        }
        if self.at == start {
            return Err(self.fault(start, GmshFault::Truncated { what }));
        }
        Ok((start, &self.bytes[start..self.at]))
    }
    /// Next bytes, in little-endian order.
    fn raw<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], Located> {
        let found = self.bytes[self.at..self.end].first_chunk::<N>();
        let mut raw = *found.ok_or_else(|| self.fault(self.at, GmshFault::Truncated { what }))?;
        if self.encoding == Encoding::Binary(ByteOrder::Big) {
            raw.reverse();
        }
        self.at += N;
        Ok(raw)
    }
    fn parsed<T: std::str::FromStr>(&mut self, what: &'static str) -> Result<T, Located> {
        let (start, word) = self.word(what)?;
        let number = std::str::from_utf8(word).ok();
        number.and_then(|w| w.parse().ok()).ok_or_else(|| {
            let found = snippet(word);
            self.fault(start, GmshFault::Expected { what, found })
        })
    }
    /// Next number as a `size_t`.
    pub(super) fn size(&mut self, what: &'static str) -> Result<u64, Located> {
        match (self.is_text(), self.size_width) {
            (true, _) => self.parsed(what),
            (false, 4) => Ok(u32::from_le_bytes(self.raw(what)?).into()),
            (false, _) => Ok(u64::from_le_bytes(self.raw(what)?)),
        }
    }
    /// Next number as an `int`.
    pub(super) fn integer(&mut self, what: &'static str) -> Result<i32, Located> {
        if self.is_text() {
            self.parsed(what)
        } else {
            Ok(i32::from_le_bytes(self.raw(what)?))
        }
    }
    /// Next number as a `double`.
    pub(super) fn real(&mut self, what: &'static str) -> Result<f64, Located> {
        if self.is_text() {
            self.parsed(what)
        } else {
            Ok(f64::from_le_bytes(self.raw(what)?))
        }
    }
    /// Skips `double`s. In a text each is parsed, so that two numbers without a blank between them are
    /// found at their position.
    pub(super) fn skip_reals(&mut self, count: usize, what: &'static str) -> Result<(), Located> {
        (0..count).try_for_each(|_| self.real(what).map(drop))
    }
    /// Skips `size_t`s, as [`skip_reals`](Self::skip_reals).
    pub(super) fn skip_sizes(&mut self, count: usize, what: &'static str) -> Result<(), Located> {
        (0..count).try_for_each(|_| self.size(what).map(drop))
    }
    /// Checks that a number of records fits into the rest of the section.
    pub(super) fn fits(
        &self,
        offset: usize,
        count: u64,
        record: RecordSize,
        what: &'static str,
    ) -> Result<usize, Located> {
        let room = self.end - self.at;
        let width = if self.is_text() {
            // At least a digit and a blank each.
            2 * (record.integers + record.sizes + record.reals)
        } else {
            4 * record.integers + self.size_width * record.sizes + 8 * record.reals
        };
        match usize::try_from(count) {
            Ok(fitting) if fitting <= room / width.max(1) => Ok(fitting),
            _ => Err(self.fault(offset, GmshFault::Count { what, count, room })),
        }
    }
    /// Reads a count of records and checks that they fit into the rest of the section.
    pub(super) fn count(
        &mut self,
        record: RecordSize,
        what: &'static str,
    ) -> Result<usize, Located> {
        let offset = self.offset();
        let count = self.size(what)?;
        self.fits(offset, count, record, what)
    }
}
