//! Decoding of data arrays of compressed blocks.

use std::io::Read as _;

use flate2::read::ZlibDecoder;

use super::reader::FieldNumbers;

/// Size of a word of the header (bytes).
const WORD: usize = 8;

/// Array in the layout of `vtkZLibDataCompressor` (see [`compressed`](super::encode::compressed)) that begins at an
/// offset; `None` if it ends early or a block has another size than stated.
///
/// Memory grows with what is decompressed, never with a stated size.
pub(super) fn decompressed(data: &[u8], offset: usize) -> Option<Vec<u8>> {
    let word = |index: usize| -> Option<usize> {
        let start = index.checked_mul(WORD)?.checked_add(offset)?;
        let bytes = data.get(start..start.checked_add(WORD)?)?;
        usize::try_from(u64::from_le_bytes(bytes.try_into().ok()?)).ok()
    };
    let (blocks, size, last) = (word(0)?, word(1)?, word(2)?);
    let mut start = (3_usize.checked_add(blocks)?)
        .checked_mul(WORD)?
        .checked_add(offset)?;
    let mut out = Vec::new();
    for block in 0..blocks {
        let end = start.checked_add(word(block.checked_add(3)?)?)?;
        let stated = if block + 1 == blocks && last > 0 {
            last
        } else {
            size
        };
        let before = out.len();
        let decoder = ZlibDecoder::new(data.get(start..end)?);
        let most = (stated as u64).checked_add(1)?;
        decoder.take(most).read_to_end(&mut out).ok()?;
        if out.len() - before != stated {
            return None;
        }
        start = end;
    }
    Some(out)
}

/// Type of the numbers of an array, by VTK's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberType {
    Float32,
    Float64,
    Int32,
    Int64,
    UInt8,
    UInt64,
}

impl NumberType {
    /// The type of a name; `None` for a type that is not written.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "Float32" => Self::Float32,
            "Float64" => Self::Float64,
            "Int32" => Self::Int32,
            "Int64" => Self::Int64,
            "UInt8" => Self::UInt8,
            "UInt64" => Self::UInt64,
            _ => return None,
        })
    }

    /// The type as that of a field.
    pub(super) fn numbers(self) -> FieldNumbers {
        match self {
            Self::Float32 => FieldNumbers::Single,
            Self::Float64 => FieldNumbers::Double,
            Self::Int32 | Self::Int64 | Self::UInt8 | Self::UInt64 => FieldNumbers::Whole,
        }
    }

    /// Size of a number (bytes).
    pub(super) fn size(self) -> usize {
        match self {
            Self::UInt8 => 1,
            Self::Float32 | Self::Int32 => 4,
            Self::Float64 | Self::Int64 | Self::UInt64 => 8,
        }
    }

    /// Numbers as reals; integers above 2^53 are rounded.
    pub(super) fn reals(self, bytes: &[u8]) -> Vec<f64> {
        match self {
            Self::Float32 => numbers(bytes, |b| f64::from(f32::from_le_bytes(b))),
            Self::Float64 => numbers(bytes, f64::from_le_bytes),
            Self::Int32 => numbers(bytes, |b| f64::from(i32::from_le_bytes(b))),
            Self::Int64 => numbers(bytes, |b| i64::from_le_bytes(b) as f64),
            Self::UInt8 => numbers(bytes, |[b]| f64::from(b)),
            Self::UInt64 => numbers(bytes, |b| u64::from_le_bytes(b) as f64),
        }
    }

    /// Numbers as integers without a sign; `None` if one has a sign, or the type is that of reals.
    pub(super) fn wholes(self, bytes: &[u8]) -> Option<Vec<u64>> {
        let wholes = match self {
            Self::Float32 | Self::Float64 => return None,
            Self::UInt8 => numbers(bytes, |[b]| Some(u64::from(b))),
            Self::UInt64 => numbers(bytes, |b| Some(u64::from_le_bytes(b))),
            Self::Int32 => numbers(bytes, |b| u64::try_from(i32::from_le_bytes(b)).ok()),
            Self::Int64 => numbers(bytes, |b| u64::try_from(i64::from_le_bytes(b)).ok()),
        };
        wholes.into_iter().collect()
    }
}

/// Numbers of `N` bytes each; bytes behind the last whole number are ignored.
fn numbers<const N: usize, T>(bytes: &[u8], number: impl Fn([u8; N]) -> T) -> Vec<T> {
    let (chunks, _) = bytes.as_chunks::<N>();
    chunks.iter().map(|chunk| number(*chunk)).collect()
}
