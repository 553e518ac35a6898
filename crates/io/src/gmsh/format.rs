//! Header of a file: version, text or binary, byte order.

use super::cursor::is_blank;
use super::error::{GmshFault, Located, snippet};

/// Supported versions of the Gmsh MSH format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GmshVersion {
    /// Versions MSH 2 to 2.2.
    Two,
    /// Version MSH 4.1.
    Four,
}

/// Byte order of binary numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ByteOrder {
    /// Little-endian: lowest byte first.
    Little,
    /// Big-endian: highest byte first.
    Big,
}

/// Encoding of the numbers of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Text with decimal digits.
    Text,
    /// Binary numbers of a byte order.
    Binary(ByteOrder),
}

/// Content of `$MeshFormat`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Format {
    pub(super) version: GmshVersion,
    pub(super) encoding: Encoding,
    /// Width of a `size_t` in binary files of version 4.1 (bytes).
    pub(super) size_width: usize,
}

const SECTION: &str = "$MeshFormat";

/// Reads the content of `$MeshFormat`, which starts at `at`; returns the offset of its end.
pub(super) fn read(bytes: &[u8], at: usize) -> Result<(Format, usize), Located> {
    let fault = |offset, fault: GmshFault| Located::new(SECTION, offset, fault);
    let blanks = bytes[at..].iter().take_while(|byte| is_blank(**byte));
    let at = at + blanks.count();
    let rest = &bytes[at..];
    let length = rest.iter().position(|byte| *byte == b'\n').ok_or_else(|| {
        let section = SECTION.into();
        fault(at, GmshFault::NotEnded { section })
    })?;
    let line = &rest[..length];
    let words: Vec<&[u8]> = line
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .collect();
    let expected = || {
        let (what, found) = ("version, file type and data size", snippet(line));
        fault(at, GmshFault::Expected { what, found })
    };
    let [version, file_type, data_size] = words[..] else {
        return Err(expected());
    };
    let number = |word: &[u8]| std::str::from_utf8(word).ok()?.parse::<i64>().ok();
    let file_type = number(file_type).ok_or_else(expected)?;
    let data_size = number(data_size)
        .and_then(|size| u64::try_from(size).ok())
        .ok_or_else(expected)?;
    // Files of versions 2 and 2.1 have the same content; some programs write the version with more digits.
    let value = std::str::from_utf8(version)
        .ok()
        .and_then(|word| word.parse::<f64>().ok());
    let version = match value {
        Some(2.0..=2.2) => GmshVersion::Two,
        Some(4.1) => GmshVersion::Four,
        _ => {
            let version = snippet(version);
            return Err(fault(at, GmshFault::Version { version }));
        }
    };
    let permitted = match version {
        GmshVersion::Two if data_size != 8 => Some("8"),
        GmshVersion::Four if data_size != 4 && data_size != 8 => Some("4 or 8"),
        _ => None,
    };
    if let Some(permitted) = permitted {
        let found = data_size;
        return Err(fault(at, GmshFault::DataSize { found, permitted }));
    }
    let mut end = at + length + 1;
    let encoding = match file_type {
        0 => Encoding::Text,
        1 => {
            let what = "the byte order mark";
            let mark = *bytes[end..]
                .first_chunk::<4>()
                .ok_or_else(|| fault(end, GmshFault::Truncated { what }))?;
            let found = u32::from_le_bytes(mark);
            let order = match (found, found.swap_bytes()) {
                (1, _) => ByteOrder::Little,
                (_, 1) => ByteOrder::Big,
                _ => return Err(fault(end, GmshFault::ByteOrder { found })),
            };
            end += 4;
            Encoding::Binary(order)
        }
        found => return Err(fault(at, GmshFault::FileType { found })),
    };
    let size_width = if data_size == 4 { 4 } else { 8 };
    let format = Format {
        version,
        encoding,
        size_width,
    };
    Ok((format, end))
}
