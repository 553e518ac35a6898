//! Mapping of a file into memory: the only unsafe code of the crate.
//!
//! Gain: the mesh of 729,000 bricks is no memory of the processes that use it, and is opened in the time of its checksum.
#![expect(unsafe_code)]

use std::fs::File;
use std::marker::PhantomData;
use std::sync::Arc;

use bytemuck::Pod;
use memmap2::Mmap;
use powerhouse_model::SharedArray;

/// A range of bytes in a file.
#[derive(Clone, Copy)]
pub(super) struct Slice {
    pub(super) start: usize,
    pub(super) length: usize,
}

/// A file in memory, for reading.
#[derive(Clone, Debug)]
pub(super) struct MappedFile(Arc<Mmap>);

impl MappedFile {
    /// Maps a file.
    pub(super) fn of(file: &File) -> std::io::Result<Self> {
        // SAFETY: the mapping is for reading, and every value of the types that are read from it is sound (`Pod`). The
        // rest is a promise of the user, in the documentation of the reader: nobody changes the file while it is mapped.
        // This package never does: it writes another file and renames it.
        let map = unsafe { Mmap::map(file)? };
        Ok(Self(Arc::new(map)))
    }

    /// All bytes of the file.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// Some bytes of the file; none if it does not have them.
    pub(super) fn slice(&self, slice: Slice) -> &[u8] {
        let end = slice.start + slice.length;
        self.0.get(slice.start..end).unwrap_or_default()
    }

    /// A range of the file as numbers; none if it is not aligned.
    pub(super) fn array<T: Pod + Send + Sync>(&self, slice: Slice) -> SharedArray<T> {
        Arc::new(MappedArray {
            file: self.clone(),
            slice,
            numbers: PhantomData,
        })
    }
}

/// Numbers in a mapped file.
struct MappedArray<T> {
    file: MappedFile,
    slice: Slice,
    numbers: PhantomData<T>,
}

impl<T: Pod> AsRef<[T]> for MappedArray<T> {
    fn as_ref(&self) -> &[T] {
        bytemuck::try_cast_slice(self.file.slice(self.slice)).unwrap_or_default()
    }
}
