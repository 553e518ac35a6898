//! Packed mesh files: the arrays of a mesh as they lie in memory.
//!
//! A packed mesh (extension `.phm`) is mapped into memory in place of being read: its numbers are taken from the file
//! when they are used, the system keeps one copy of them for all processes of a machine, and gives their memory to others
//! when it is short. Reading needs neither the text of a mesh nor tables of its numbers.
//!
//! | bytes | content |
//! |---|---|
//! | 128 | head: name of the format, version, byte order, numbers of nodes, elements, corners and bytes of sets, checksum |
//! | 24 a node | coordinates (m) |
//! | 8 a node, 8 an element | numbers of nodes and elements in the user's files |
//! | 4 an element, and 4 | place of its first corner among all corners |
//! | 4 a corner | index of its node |
//! | 1 an element | kind |
//! | | sets: what they have, name, and indices; the mesh file that was packed, with its length and checksum |
//!
//! Each array begins at a multiple of 8 bytes. Numbers are little-endian.
//!
//! # Why so
//! *A mapped file in place of one for each rank.* Ranks have a share of the elements and need some facts of all: blocks, surfaces,
//! points. With one file for all of them any number of ranks can use it, each reads what it needs by the code of one process,
//! and what it has read is no memory of its own.

mod map;
mod source;

use core::ops::Range;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use powerhouse_model::{Checksum, ElementKind, Facet, Mesh, MeshArrays, MeshError};
use thiserror::Error;

use crate::IoError;
use crate::atomic::write_whole_by;
use map::{MappedFile, Slice};
pub use source::PackedSource;

/// Name of the format.
const MAGIC: &[u8; 16] = b"powerhouse mesh\n";
/// Version of the format.
const VERSION: u32 = 2;
/// Length of the head (bytes).
const HEAD: usize = 128;
/// Place of the checksum in the head; it is that of all bytes, with zeros here.
const CHECKSUM: Range<usize> = 56..64;
/// Unit of lengths (bytes): each array begins at a multiple of it.
const UNIT: usize = 8;
/// Kinds of sets, and the entry of the mesh file that was packed.
const SETS: [&str; 4] = ["node", "element", "facet", "source"];

/// Number of the entry of the mesh file that was packed.
const SOURCE: u32 = 3;

/// Why a packed mesh file cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PackedMeshFault {
    /// The operating system's error.
    #[error("{0}")]
    File(std::io::Error),
    /// A file of another kind.
    #[error("this is no packed mesh, which begins with 'powerhouse mesh'")]
    NotPacked,
    /// A folder, pipe or device.
    #[error("this is no file")]
    NoFile,
    /// A file whose content was changed in place while it was in use.
    #[error(
        "the packed mesh was changed while it was in use: what is computed and written with it since then is wrong; another file may take its place under the same name, as by `powerhouse pack` or `mv`, but not by `cp`"
    )]
    Changed,
    /// A file of another version of the format.
    #[error(
        "a packed mesh of version {found}; this program reads version {VERSION}: convert the mesh again"
    )]
    Version {
        /// Version of the file.
        found: u32,
    },
    /// A machine with another byte order than the file has.
    #[error("a packed mesh can be mapped on machines with little-endian numbers alone")]
    ByteOrder,
    /// A file that is shorter or longer than its head says.
    #[error("the file has {found} bytes instead of {expected}: it was written or copied in part")]
    Length {
        /// Bytes of the file.
        found: u64,
        /// Bytes according to its head.
        expected: u64,
    },
    /// Content that has changed since it was written.
    #[error("the content has the checksum {found} instead of {expected}: the file is damaged")]
    Checksum {
        /// Checksum of the content.
        found: Checksum,
        /// Checksum in its head, in the same form.
        expected: String,
    },
    /// Content that is no mesh.
    #[error("{0}")]
    Content(#[from] MeshError),
    /// Sets or kinds of elements that are no such.
    #[error("the {what} cannot be read")]
    Unreadable {
        /// What cannot be read.
        what: &'static str,
    },
}

/// Error of reading a packed mesh file.
#[derive(Debug, Error)]
#[error("{}: {fault}", file.display())]
pub struct PackedMeshError {
    /// The file.
    pub file: PathBuf,
    /// What is wrong with it.
    pub fault: PackedMeshFault,
}

/// Numbers of a mesh in the head of a file.
#[derive(Clone, Copy)]
struct Counts {
    nodes: u64,
    elements: u64,
    corners: u64,
    set_bytes: u64,
}

/// Ranges of the arrays in a file, in their order.
struct Places {
    positions: Slice,
    node_tags: Slice,
    element_tags: Slice,
    offsets: Slice,
    connectivity: Slice,
    kinds: Slice,
    sets: Slice,
    end: usize,
}

impl Counts {
    /// The arrays' places; none if they are beyond the largest file.
    fn places(self) -> Option<Places> {
        let mut end = HEAD;
        let mut next = |count: u64, size: usize| {
            let start = end;
            let length = usize::try_from(count).ok()?.checked_mul(size)?;
            end = start.checked_add(length)?.checked_next_multiple_of(UNIT)?;
            Some(Slice { start, length })
        };
        Some(Places {
            positions: next(self.nodes, 24)?,
            node_tags: next(self.nodes, 8)?,
            element_tags: next(self.elements, 8)?,
            offsets: next(self.elements.checked_add(1)?, 4)?,
            connectivity: next(self.corners, 4)?,
            kinds: next(self.elements, 1)?,
            sets: next(self.set_bytes, 1)?,
            end,
        })
    }
}

/// Whether a file is a packed mesh by its extension, `.phm`.
pub fn is_packed_mesh(file: &Path) -> bool {
    file.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("phm"))
}

/// Writes a mesh as packed mesh file; with the mesh file that it was read from, if there is one, so that a reader sees
/// whether that was changed since.
///
/// # Errors
/// Those of the operating system.
pub fn write_packed_mesh(
    file: impl AsRef<Path>,
    mesh: &Mesh,
    source: Option<&Path>,
) -> Result<(), IoError> {
    let elements = 0..mesh.element_count() as u32;
    let corners: usize = elements.clone().map(|e| mesh.nodes_of(e).len()).sum();
    let mut sets = bytes_of_sets(mesh);
    if let Some(source) = source {
        if let Some(folder) = file.as_ref().parent() {
            std::fs::create_dir_all(folder).map_err(IoError::file(folder))?;
        }
        let source = PackedSource::of(source, file.as_ref())?;
        put_set(&mut sets, SOURCE, &source.name, &source.numbers());
    }
    let counts = [
        mesh.node_count() as u64,
        mesh.element_count() as u64,
        corners as u64,
        sets.len() as u64,
    ];
    let content = |out: &mut dyn Write| -> std::io::Result<()> {
        let mut out = Padded { out, written: 0 };
        for position in mesh.positions() {
            for coordinate in position {
                out.write(&coordinate.to_le_bytes())?;
            }
        }
        for tag in mesh.node_tags().iter().chain(mesh.element_tags()) {
            out.write(&tag.to_le_bytes())?;
        }
        let mut end = 0_u32;
        out.write(&end.to_le_bytes())?;
        for element in elements.clone() {
            end += mesh.nodes_of(element).len() as u32;
            out.write(&end.to_le_bytes())?;
        }
        out.pad()?;
        for element in elements.clone() {
            for node in mesh.nodes_of(element) {
                out.write(&node.to_le_bytes())?;
            }
        }
        out.pad()?;
        for element in elements.clone() {
            out.write(&[number_of(mesh.kind(element))])?;
        }
        out.pad()?;
        out.write(&sets)?;
        out.pad()
    };
    let mut head = [0; HEAD];
    head[..16].copy_from_slice(MAGIC);
    head[16..20].copy_from_slice(&VERSION.to_le_bytes());
    for (place, number) in head[24..CHECKSUM.start].chunks_mut(8).zip(counts) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    let mut sum = Summed(Checksum::of(&head));
    content(&mut sum).map_err(IoError::file(file.as_ref()))?;
    head[CHECKSUM].copy_from_slice(&sum.0.value().to_le_bytes());
    write_whole_by(file.as_ref(), |out| {
        out.write_all(&head)?;
        content(out)
    })
}

/// Maps a packed mesh file.
///
/// The file must not be changed while the mesh is in use, as [`PackedMesh::check`] finds; a new one may take its place under
/// the same name, as [`write_packed_mesh`] does.
///
/// # Errors
/// [`PackedMeshError`] for a file that is no packed mesh, of another version, shortened or damaged.
pub fn read_packed_mesh(file: impl AsRef<Path>) -> Result<(Mesh, PackedMesh), PackedMeshError> {
    let file = file.as_ref();
    read(file).map_err(|fault| PackedMeshError {
        file: file.into(),
        fault,
    })
}

/// A packed mesh file in use.
#[derive(Debug)]
pub struct PackedMesh {
    path: PathBuf,
    opened: File,
    /// Length (bytes) and date of the last change when the file was mapped.
    state: (u64, Option<Duration>),
    source: Option<PackedSource>,
    map: MappedFile,
    /// Checksum of the content when the file was mapped.
    sum: u64,
}

impl PackedMesh {
    fn state(opened: &File) -> std::io::Result<(u64, Option<Duration>)> {
        let found = opened.metadata()?;
        Ok((found.len(), source::date(&found)))
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The mesh file that was packed, if the writer named one.
    pub fn source(&self) -> Option<&PackedSource> {
        self.source.as_ref()
    }

    /// Checks that the content of the file was not changed in place since it was mapped. The content is read if the date of
    /// the file has changed.
    ///
    /// # Errors
    /// [`PackedMeshFault::Changed`].
    pub fn check(&self) -> Result<(), PackedMeshError> {
        let fault = match Self::state(&self.opened) {
            Ok(state) if state == self.state => return Ok(()),
            Ok((length, _))
                if length == self.state.0 && sum_of(self.map.bytes()).value() == self.sum =>
            {
                return Ok(());
            }
            Ok(_) => PackedMeshFault::Changed,
            Err(error) => PackedMeshFault::File(error),
        };
        let file = self.path.clone();
        Err(PackedMeshError { file, fault })
    }

    /// The path of the mesh file that was packed, if that was changed since.
    pub fn changed_source(&self) -> Option<PathBuf> {
        self.source.as_ref()?.changed(&self.path, self.state.1)
    }
}

fn read(file: &Path) -> Result<(Mesh, PackedMesh), PackedMeshFault> {
    if cfg!(target_endian = "big") {
        return Err(PackedMeshFault::ByteOrder);
    }
    // Opening a pipe would block.
    if !std::fs::metadata(file)
        .map_err(PackedMeshFault::File)?
        .is_file()
    {
        return Err(PackedMeshFault::NoFile);
    }
    let opened = File::open(file).map_err(PackedMeshFault::File)?;
    let state = PackedMesh::state(&opened).map_err(PackedMeshFault::File)?;
    let length = state.0;
    if length < HEAD as u64 {
        return Err(PackedMeshFault::NotPacked);
    }
    let map = MappedFile::of(&opened).map_err(PackedMeshFault::File)?;
    let bytes = map.bytes();
    let head = bytes.get(..HEAD).ok_or(PackedMeshFault::NotPacked)?;
    if !head.starts_with(MAGIC) {
        return Err(PackedMeshFault::NotPacked);
    }
    let version = head[16..]
        .first_chunk()
        .map_or(0, |b| u32::from_le_bytes(*b));
    if version != VERSION {
        return Err(PackedMeshFault::Version { found: version });
    }
    let number = |index: usize| {
        let bytes = bytes[24 + 8 * index..].first_chunk();
        bytes.map_or(0, |bytes| u64::from_le_bytes(*bytes))
    };
    let counts = Counts {
        nodes: number(0),
        elements: number(1),
        corners: number(2),
        set_bytes: number(3),
    };
    let places = counts.places();
    let expected = places.as_ref().map_or(u64::MAX, |places| places.end as u64);
    let Some(places) = places.filter(|_| length == expected) else {
        return Err(PackedMeshFault::Length {
            found: length,
            expected,
        });
    };
    let sum = sum_of(bytes);
    if sum.value() != number(4) {
        return Err(PackedMeshFault::Checksum {
            found: sum,
            expected: format!("{:016x}", number(4)),
        });
    }
    let kinds = map
        .slice(places.kinds)
        .iter()
        .map(|&number| kind_of(number));
    let kinds: Option<Vec<ElementKind>> = kinds.collect();
    let arrays = MeshArrays {
        positions: map.array(places.positions),
        node_tags: map.array(places.node_tags),
        kinds: kinds.ok_or(PackedMeshFault::Unreadable {
            what: "kinds of the elements",
        })?,
        element_tags: map.array(places.element_tags),
        offsets: map.array(places.offsets),
        connectivity: map.array(places.connectivity),
    };
    let mut mesh = Mesh::from_arrays(arrays)?;
    let source = put_sets(&mut mesh, map.slice(places.sets))?;
    let packed = PackedMesh {
        path: file.into(),
        opened,
        state,
        source,
        map,
        sum: sum.value(),
    };
    packed.check().map_err(|error| error.fault)?;
    Ok((mesh, packed))
}

/// Checksum of the content of a file of at least a head, with zeros in its place.
fn sum_of(bytes: &[u8]) -> Checksum {
    let (head, rest) = bytes.split_at(HEAD.min(bytes.len()));
    let mut head = head.to_vec();
    head[CHECKSUM].fill(0);
    let mut sum = Checksum::of(&head);
    sum.add_bytes(rest);
    sum
}

/// Number of a kind of elements in a file.
fn number_of(kind: ElementKind) -> u8 {
    let place = ElementKind::ALL.iter().position(|&known| known == kind);
    place.map_or(u8::MAX, |place| place as u8)
}

/// Kind of elements of a number in a file.
fn kind_of(number: u8) -> Option<ElementKind> {
    ElementKind::ALL.get(number as usize).copied()
}

/// The sets of a mesh: for each the kind of its members, the length of its name, the number of indices, its name, and the
/// indices; those of a facet are an element and a side.
fn bytes_of_sets(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (what, sets) in [(0, mesh.node_sets()), (1, mesh.element_sets())] {
        for (name, indices) in sets {
            put_set(&mut bytes, what, name, indices);
        }
    }
    for (name, facets) in mesh.facet_sets() {
        let numbers = facets.iter();
        let numbers: Vec<u32> = numbers
            .flat_map(|facet| [facet.element, facet.side.into()])
            .collect();
        put_set(&mut bytes, 2, name, &numbers);
    }
    bytes
}

/// Appends a set to some bytes: the kind of its members, its name and its indices.
fn put_set(bytes: &mut Vec<u8>, what: u32, name: &str, indices: &[u32]) {
    for number in [what, name.len() as u32, indices.len() as u32] {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
    bytes.extend_from_slice(name.as_bytes());
    for index in indices {
        bytes.extend_from_slice(&index.to_le_bytes());
    }
}

/// Adds the sets that [`bytes_of_sets`] wrote to a mesh; returns the mesh file that was packed.
fn put_sets(mesh: &mut Mesh, mut bytes: &[u8]) -> Result<Option<PackedSource>, PackedMeshFault> {
    let mut source = None;
    while !bytes.is_empty() {
        let unreadable = PackedMeshFault::Unreadable { what: "sets" };
        let Some((what, name, indices)) = next_set(&mut bytes) else {
            return Err(unreadable);
        };
        match SETS.get(what as usize).copied() {
            Some("node") => mesh.set_node_set(name, indices)?,
            Some("element") => mesh.set_element_set(name, indices)?,
            Some("source") => {
                source = Some(PackedSource::read(name, &indices).ok_or(unreadable)?);
            }
            Some(_) => {
                let (pairs, _) = indices.as_chunks::<2>();
                let facets = pairs.iter().map(|&[element, side]| Facet {
                    element,
                    side: u8::try_from(side).unwrap_or(u8::MAX),
                });
                mesh.set_facet_set(name, facets.collect())?;
            }
            None => return Err(unreadable),
        }
    }
    Ok(source)
}

/// Takes a set from the beginning of some bytes: the kind of its members, its name and its indices.
fn next_set<'b>(bytes: &mut &'b [u8]) -> Option<(u32, &'b str, Vec<u32>)> {
    let mut number = || {
        let (number, rest) = bytes.split_first_chunk()?;
        *bytes = rest;
        Some(u32::from_le_bytes(*number))
    };
    let (what, length, count) = (number()?, number()?, number()?);
    let (name, rest) = bytes.split_at_checked(length as usize)?;
    let (indices, rest) = rest.split_at_checked((count as usize).checked_mul(4)?)?;
    *bytes = rest;
    let (indices, _) = indices.as_chunks::<4>();
    let indices = indices.iter().map(|index| u32::from_le_bytes(*index));
    Some((what, core::str::from_utf8(name).ok()?, indices.collect()))
}

/// A writer that fills up to the unit of lengths.
struct Padded<'w> {
    out: &'w mut dyn Write,
    written: usize,
}

impl Padded<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.written += bytes.len();
        self.out.write_all(bytes)
    }
    fn pad(&mut self) -> std::io::Result<()> {
        let missing = self.written.next_multiple_of(UNIT) - self.written;
        self.write(&[0; UNIT][..missing])
    }
}

/// A writer of which nothing remains but the checksum.
struct Summed(Checksum);

impl Write for Summed {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.add_bytes(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
