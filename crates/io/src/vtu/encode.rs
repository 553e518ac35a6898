//! Encoding of data arrays as compressed blocks.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::ZlibEncoder;

/// Uncompressed size of a block (bytes).
const BLOCK: usize = 1 << 18;

/// Array in the layout of `vtkZLibDataCompressor`: number of blocks, block size, size of the
/// last block if it is shorter (else zero), compressed sizes, all as 64-bit words; then the blocks.
pub(super) fn compressed(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let blocks: Vec<Vec<u8>> = bytes
        .chunks(BLOCK)
        .map(|block| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(block)?;
            encoder.finish()
        })
        .collect::<std::io::Result<_>>()?;
    let mut header = vec![blocks.len(), BLOCK, bytes.len() % BLOCK];
    header.extend(blocks.iter().map(Vec::len));
    let mut out = Vec::new();
    for word in header {
        out.extend_from_slice(&(word as u64).to_le_bytes());
    }
    for block in blocks {
        out.extend_from_slice(&block);
    }
    Ok(out)
}

/// Reals as little-endian bytes, in double or single precision.
pub(super) fn float_bytes(values: impl Iterator<Item = f64>, double: bool) -> Vec<u8> {
    if double {
        values.flat_map(f64::to_le_bytes).collect()
    } else {
        values
            .flat_map(|value| (value as f32).to_le_bytes())
            .collect()
    }
}

/// Integers as little-endian bytes of 32 bits; the index of the first value that is not one.
pub(super) fn whole_bytes(values: &[f64]) -> Result<Vec<u8>, usize> {
    let mut bytes = Vec::with_capacity(4 * values.len());
    for (index, &value) in values.iter().enumerate() {
        let whole = value as i32;
        if f64::from(whole) != value {
            return Err(index);
        }
        bytes.extend_from_slice(&whole.to_le_bytes());
    }
    Ok(bytes)
}
