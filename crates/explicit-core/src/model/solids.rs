//! Element blocks of the mesh.
//!
//! # Why so
//! *In mixed precision a few elements are computed in double precision*: those whose natural
//! frequency `w` is far above the mean of the body, such as those of a lining in rock. The rounding error of single
//! precision is a share of the element's force that varies from step to step. It
//! accelerates an undamped element by `w^2` times its relative displacement times the rounding, and after
//! `n` steps its oscillations have grown as the root of `n`: relative to a slow motion the error of
//! acceleration grows as `w` to the power 1.5 and stays in the element and its neighbours.

use powerhouse_model::{
    BlockPart, ElementBlock, EngineError, Mesh, ModelError, NodalView, Precision, StateError,
    decode, encode,
};
use rayon::prelude::*;

use super::builder::ElementSet;
use super::start::{ElementSubset, InitialState};
use crate::partition::{ElementSets, Partition};
use crate::ranks::{Communicator, Distribution, rank_failure};

/// Multiple of the volume mean of natural frequencies in sets of single precision above which an element is computed
/// in double precision, and the largest share of such elements.
const STIFF: f64 = 2.0;
const MOST_STIFF: f64 = 0.1;

/// Partition of the mesh, and an element block for each of its blocks that this rank computes.
pub(super) struct Solids {
    pub(super) partition: Partition,
    /// Rank of each block of the partition, and name of its element set.
    pub(super) ranks: Vec<u32>,
    pub(super) labels: Vec<String>,
    pub(super) blocks: Vec<Box<dyn ElementBlock>>,
}

/// Divides the elements and builds the blocks.
pub(super) fn build_blocks(
    mesh: &Mesh,
    sets: &[ElementSet],
    start: &InitialState,
    block_size: usize,
    team: &Communicator,
) -> Result<Solids, ModelError> {
    let absent = start.absent(mesh)?;
    let subsets = start.subsets(mesh, sets, &absent)?;
    let whole = build_subsets(mesh, (sets, &subsets), (start, &absent), block_size, team);
    let whole = team.agree(whole)?;
    let stiff = team.agree(stiff_elements(mesh, sets, &subsets, &whole, team))?;
    if stiff.is_empty() {
        return Ok(whole);
    }
    let subsets = with_double_precision(subsets, sets, &stiff);
    let divided = build_subsets(mesh, (sets, &subsets), (start, &absent), block_size, team);
    team.agree(divided)
}

/// Divides some element subsets and builds their blocks.
fn build_subsets(
    mesh: &Mesh,
    (sets, subsets): (&[ElementSet], &[ElementSubset]),
    (start, absent): (&InitialState, &[bool]),
    block_size: usize,
    team: &Communicator,
) -> Result<Solids, ModelError> {
    let lists: Vec<&[u32]> = subsets.iter().map(|subset| &*subset.elements).collect();
    let factory = |subset: usize| sets[subsets[subset].set].1.as_ref();
    let labels: Vec<&str> = (0..subsets.len()).map(|i| factory(i).label()).collect();
    let costs = (0..subsets.len()).map(|i| factory(i).relative_cost());
    // A factory of a user may return anything.
    let is_sound = |cost: f64| cost.is_finite() && cost > 0.0;
    let costs: Vec<f64> = costs
        .map(|cost| if is_sound(cost) { cost } else { 1.0 })
        .collect();
    let sets_of_elements = ElementSets {
        labels: &labels,
        elements: &lists,
        costs: &costs,
        absent,
    };
    let partition = team.of_first(|| Ok(Partition::new(mesh, sets_of_elements, block_size)?))?;
    for (subset, elements) in lists.iter().enumerate() {
        let factory = factory(subset);
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
    let ranks = if team.is_single() {
        vec![0; partition.blocks.len()]
    } else {
        Distribution::new(&partition, mesh, team.count())?.rank_of_block
    };
    let own = (0..ranks.len()).filter(|&block| ranks[block] as usize == team.rank());
    let own: Vec<usize> = own.collect();
    let blocks: Result<Vec<_>, ModelError> = (own.par_iter())
        .map(|&block| {
            let block = &partition.blocks[block];
            let subset = &subsets[block.set];
            let part = BlockPart::new(mesh, &block.elements, &block.nodes).in_double(subset.double);
            let mut built = factory(block.set).build(&part)?;
            if let Some(cast) = subset.cast {
                let reference = start.reference(cast, &block.nodes);
                built.set_reference_displacement(NodalView::F64(&reference));
            }
            Ok(built)
        })
        .collect();
    Ok(Solids {
        blocks: blocks?,
        ranks,
        labels: (partition.blocks.iter())
            .map(|block| labels[block.set].into())
            .collect(),
        partition,
    })
}

fn is_single(sets: &[ElementSet], subset: &ElementSubset) -> bool {
    sets[subset.set].1.options().precision != Precision::F64
}

/// Mesh indices, in rising order, of the elements of single precision to be computed in double
/// precision.
fn stiff_elements(
    mesh: &Mesh,
    sets: &[ElementSet],
    subsets: &[ElementSubset],
    solids: &Solids,
    team: &Communicator,
) -> Result<Vec<u32>, ModelError> {
    if !subsets.iter().any(|subset| is_single(sets, subset)) {
        return Ok(Vec::new());
    }
    let mut single = vec![false; mesh.element_count()];
    for subset in subsets.iter().filter(|subset| is_single(sets, subset)) {
        for &element in subset.elements.iter() {
            single[element as usize] = true;
        }
    }
    let bounds = all_frequency_bounds(solids, team)?;
    let mut frequencies: Vec<(f64, u32)> = (bounds.into_iter())
        .flatten()
        .filter(|&(_, element)| single.get(element as usize) == Some(&true))
        .collect();
    let (mut volume, mut sum) = (0.0, 0.0);
    for &(frequency, element) in &frequencies {
        let own = mesh.volume(element);
        volume += own;
        sum += own * frequency;
    }
    let limit = STIFF * sum / volume;
    let most = (MOST_STIFF * frequencies.len() as f64) as usize;
    frequencies.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let stiff = frequencies.iter().take(most);
    let stiff = stiff.take_while(|(frequency, _)| *frequency > limit);
    let mut stiff: Vec<u32> = stiff.map(|&(_, element)| element).collect();
    stiff.sort_unstable();
    Ok(stiff)
}

/// Bounds on the frequency (rad/s) of the elements of each block of the partition, on whatever rank it is.
fn all_frequency_bounds(
    solids: &Solids,
    team: &Communicator,
) -> Result<Vec<Vec<(f64, u32)>>, ModelError> {
    let of_blocks = solids.blocks.iter().map(|block| {
        let bounds = block.frequency_bounds().into_iter();
        bounds
            .map(|bound| (bound.frequency, bound.element))
            .collect()
    });
    let own: Vec<Vec<(f64, u32)>> = of_blocks.collect();
    if team.is_single() {
        return Ok(own);
    }
    let undecodable = |error: StateError| ModelError::refused("ranks", error);
    let sent = team.of_all(&encode(&own).map_err(undecodable)?);
    team.check().map_err(|failure| rank_failure(&failure))?;
    let mut of_ranks = Vec::with_capacity(sent.len());
    for bytes in sent {
        let bounds: Vec<Vec<(f64, u32)>> = decode(&bytes).map_err(undecodable)?;
        of_ranks.push(bounds.into_iter());
    }
    let next = |&rank: &u32| of_ranks.get_mut(rank as usize)?.next();
    Ok(solids.ranks.iter().filter_map(next).collect())
}

/// Divides the subsets so that the elements to be computed in double precision are in subsets of their own.
fn with_double_precision<'a>(
    subsets: Vec<ElementSubset<'a>>,
    sets: &[ElementSet],
    stiff: &[u32],
) -> Vec<ElementSubset<'a>> {
    let mut divided = Vec::new();
    for subset in subsets {
        if !is_single(sets, &subset) {
            divided.push(subset);
            continue;
        }
        for double in [false, true] {
            let own = subset.elements.iter().copied();
            let own = own.filter(|element| stiff.binary_search(element).is_ok() == double);
            let elements: Vec<u32> = own.collect();
            if !elements.is_empty() {
                divided.push(ElementSubset {
                    set: subset.set,
                    elements: elements.into(),
                    cast: subset.cast,
                    double,
                });
            }
        }
    }
    divided
}
