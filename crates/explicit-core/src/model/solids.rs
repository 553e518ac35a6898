//! The elements of the mesh as blocks.
//!
//! # Why so
//! *Few elements of a body whose elements are in single precision are computed in double precision*: those whose natural
//! frequency `w` is far above what is usual in the body, such as those of a lining in rock. Arithmetic in
//! single precision errs by a share of the element's force that differs from step to step. Such an error
//! accelerates an undamped element by `w^2` times its relative displacement times the rounding, and after
//! `n` steps its oscillations have grown as the root of `n`: relative to a slow motion the error of
//! acceleration grows as `w` to the power 1.5 and stays in the element and its neighbours.

use powerhouse_model::{ElementBlock, Mesh, ModelError, NodalView, Numbering};
use rayon::prelude::*;

use super::builder::ElementSet;
use super::start::{Piece, Start};
use crate::partition::partition;
use crate::{BlockPart, EngineError, Precision};

/// Elements of single precision are computed in double precision if their natural frequency is above this
/// multiple of the mean over the volume of such sets, but no more than this share of them.
const FAST: f64 = 2.0;
const MOST_FAST: f64 = 0.1;

/// The elements of the mesh as blocks.
pub(super) struct Solids {
    pub(super) numbering: Numbering,
    pub(super) blocks: Vec<Box<dyn ElementBlock>>,
    /// Engine nodes whose elements are all absent, in rising order.
    pub(super) orphans: Vec<u32>,
}

/// Numbers the nodes and makes the blocks.
pub(super) fn build_blocks(
    mesh: &Mesh,
    sets: &[ElementSet],
    start: &Start,
    part_size: usize,
) -> Result<Solids, ModelError> {
    let absent = start.absent(mesh)?;
    let pieces = start.pieces(mesh, sets, &absent)?;
    let whole = build_pieces(mesh, (sets, &pieces), (start, &absent), part_size)?;
    let fast = fast_elements(mesh, sets, &pieces, &whole.blocks);
    if fast.is_empty() {
        return Ok(whole);
    }
    let pieces = apart(pieces, sets, &fast);
    build_pieces(mesh, (sets, &pieces), (start, &absent), part_size)
}

/// Numbers the nodes and makes the blocks of some pieces.
fn build_pieces(
    mesh: &Mesh,
    (sets, pieces): (&[ElementSet], &[Piece]),
    (start, absent): (&Start, &[bool]),
    part_size: usize,
) -> Result<Solids, ModelError> {
    let lists: Vec<&[u32]> = pieces.iter().map(|piece| &*piece.elements).collect();
    let factory = |piece: usize| sets[pieces[piece].set].1.as_ref();
    let labels: Vec<&str> = (0..pieces.len()).map(|i| factory(i).label()).collect();
    let division = partition(mesh, &labels, &lists, absent, part_size)?;
    for (piece, elements) in lists.iter().enumerate() {
        let factory = factory(piece);
        let other = elements.iter().find(|&&e| mesh.kind(e) != factory.kind());
        if let Some(&element) = other {
            return Err(EngineError::ElementKind {
                element: mesh.element_tags()[element as usize],
                set: factory.label().into(),
                found: mesh.kind(element).name(),
                expected: factory.kind().name(),
            }
            .into());
        }
    }
    let engine_of = &division.numbering.engine_of;
    let references: Vec<_> = pieces
        .iter()
        .map(|piece| piece.cast.map(|cast| start.reference(cast, engine_of)))
        .collect();
    let blocks: Result<Vec<_>, ModelError> = division
        .parts
        .par_iter()
        .map(|part| {
            let (elements, nodes) = (&part.elements, &part.nodes);
            let part_of_mesh = BlockPart::new(mesh, elements, &division.numbering, nodes)
                .in_double(pieces[part.set].double);
            let mut block = factory(part.set).build(&part_of_mesh)?;
            if let Some(reference) = &references[part.set] {
                block.set_reference_displacement(NodalView::F64(reference));
            }
            Ok(block)
        })
        .collect();
    Ok(Solids {
        blocks: blocks?,
        numbering: division.numbering,
        orphans: division.orphans,
    })
}

fn is_single(sets: &[ElementSet], piece: &Piece) -> bool {
    sets[piece.set].1.options().precision != Precision::F64
}

/// Mesh indices, in rising order, of the elements of single precision whose arithmetic is to be in double
/// precision.
fn fast_elements(
    mesh: &Mesh,
    sets: &[ElementSet],
    pieces: &[Piece],
    blocks: &[Box<dyn ElementBlock>],
) -> Vec<u32> {
    let mut single = vec![false; mesh.element_count()];
    for piece in pieces.iter().filter(|piece| is_single(sets, piece)) {
        for &element in piece.elements.iter() {
            single[element as usize] = true;
        }
    }
    let mut frequencies: Vec<(f64, u32)> = (blocks.iter())
        .flat_map(|block| block.frequency_bounds())
        .map(|bound| (bound.frequency, bound.element))
        .filter(|&(_, element)| single.get(element as usize) == Some(&true))
        .collect();
    let (mut volume, mut sum) = (0.0, 0.0);
    for &(frequency, element) in &frequencies {
        let own = mesh.volume(element);
        volume += own;
        sum += own * frequency;
    }
    let limit = FAST * sum / volume;
    let most = (MOST_FAST * frequencies.len() as f64) as usize;
    frequencies.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let fast = frequencies.iter().take(most);
    let fast = fast.take_while(|(frequency, _)| *frequency > limit);
    let mut fast: Vec<u32> = fast.map(|&(_, element)| element).collect();
    fast.sort_unstable();
    fast
}

/// The same pieces with the elements that are to be computed in double precision in pieces of their own.
fn apart<'a>(pieces: Vec<Piece<'a>>, sets: &[ElementSet], fast: &[u32]) -> Vec<Piece<'a>> {
    let mut divided = Vec::new();
    for piece in pieces {
        if !is_single(sets, &piece) {
            divided.push(piece);
            continue;
        }
        for double in [false, true] {
            let own = piece.elements.iter().copied();
            let own = own.filter(|element| fast.binary_search(element).is_ok() == double);
            let elements: Vec<u32> = own.collect();
            if !elements.is_empty() {
                divided.push(Piece {
                    set: piece.set,
                    elements: elements.into(),
                    cast: piece.cast,
                    double,
                });
            }
        }
    }
    divided
}

/// Block of each mesh element, and its place in the block; no block for elements that are absent.
pub(super) fn places(mesh: &Mesh, blocks: &[Box<dyn ElementBlock>]) -> Vec<(u32, u32)> {
    let mut places = vec![(u32::MAX, 0); mesh.element_count()];
    for (b, block) in blocks.iter().enumerate() {
        for (place, &element) in block.elements().iter().enumerate() {
            if let Some(entry) = places.get_mut(element as usize) {
                *entry = (b as u32, place as u32);
            }
        }
    }
    places
}
