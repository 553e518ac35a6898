//! The elements of the mesh as blocks.

use powerhouse_model::{ElementBlock, Mesh, ModelError, NodalView, Numbering};
use rayon::prelude::*;

use super::builder::ElementSet;
use super::start::Start;
use crate::partition::partition;
use crate::{BlockPart, EngineError};

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
    let lists: Vec<&[u32]> = pieces.iter().map(|piece| &*piece.elements).collect();
    let factory = |piece: usize| sets[pieces[piece].set].1.as_ref();
    let labels: Vec<&str> = (0..pieces.len()).map(|i| factory(i).label()).collect();
    let division = partition(mesh, &labels, &lists, &absent, part_size)?;
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
            let part_of_mesh = BlockPart::new(mesh, elements, &division.numbering, nodes);
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
