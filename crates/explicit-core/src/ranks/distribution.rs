//! Distribution of the blocks of a partition to ranks.

use powerhouse_model::{EngineError, Mesh, Vec3};

use crate::partition::Partition;

/// Rank of each block of a [`Partition`]: the blocks of a rank are close to each other, and the ranks have about the same
/// cost.
///
/// It is a function of the partition and the number of ranks alone. The order of the blocks, and with it every sum of
/// forces, does not depend on it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Distribution {
    /// Rank of each block, in the order of the blocks.
    pub rank_of_block: Vec<u32>,
    /// Number of ranks.
    pub ranks: usize,
}

/// A block with what it is divided by.
#[derive(Clone, Copy)]
struct Placed {
    block: u32,
    centre: Vec3,
    cost: f64,
}

impl Distribution {
    /// Distributes blocks by recursive bisection across the longest extent of their centres, in the ratio of the numbers
    /// of ranks on both sides.
    ///
    /// # Errors
    /// [`EngineError::TooManyRanks`] for more ranks than blocks, with the largest block size that would do, and
    /// [`EngineError::MoreRanksThanElements`] if none would.
    pub fn new(partition: &Partition, mesh: &Mesh, ranks: usize) -> Result<Self, EngineError> {
        let ranks = ranks.max(1);
        let blocks = &partition.blocks;
        if ranks > blocks.len() {
            return Err(too_many(partition, ranks));
        }
        let mut placed: Vec<Placed> = (0..)
            .zip(blocks)
            .map(|(number, block)| {
                let centres = block.elements.iter().map(|&e| mesh.centroid(e));
                Placed {
                    block: number,
                    centre: centres.sum::<Vec3>() / block.elements.len() as f64,
                    cost: block.cost(),
                }
            })
            .collect();
        let mut rank_of_block = vec![0; blocks.len()];
        bisect(&mut placed, 0..ranks as u32, &mut rank_of_block);
        Ok(Self {
            rank_of_block,
            ranks,
        })
    }

    /// Relative cost of a step of each rank: the sum of the [costs](crate::PartitionBlock::cost) of its blocks.
    pub fn costs(&self, partition: &Partition) -> Vec<f64> {
        let mut costs = vec![0.0; self.ranks];
        for (&rank, block) in self.rank_of_block.iter().zip(&partition.blocks) {
            costs[rank as usize] += block.cost();
        }
        costs
    }
}

/// Divides blocks among a range of ranks, of which there are no more than blocks.
fn bisect(blocks: &mut [Placed], ranks: core::ops::Range<u32>, rank_of_block: &mut [u32]) {
    let count = ranks.len();
    if count <= 1 {
        for block in blocks {
            rank_of_block[block.block as usize] = ranks.start;
        }
        return;
    }
    let first = blocks[0].centre;
    let (low, high) = blocks.iter().fold((first, first), |(low, high), block| {
        (low.inf(&block.centre), high.sup(&block.centre))
    });
    let axis = (high - low).imax();
    blocks.sort_by(|a, b| {
        let along = a.centre[axis].total_cmp(&b.centre[axis]);
        along.then(a.block.cmp(&b.block))
    });
    let half = count / 2;
    let total: f64 = blocks.iter().map(|block| block.cost).sum();
    let wanted = total * half as f64 / count as f64;
    // Each side has at least one block for each of its ranks.
    let (least, most) = (half, blocks.len() - (count - half));
    let mut before: f64 = blocks[..least].iter().map(|block| block.cost).sum();
    let mut middle = least;
    while middle < most && before + 0.5 * blocks[middle].cost <= wanted {
        before += blocks[middle].cost;
        middle += 1;
    }
    let (left, right) = blocks.split_at_mut(middle);
    let border = ranks.start + half as u32;
    bisect(left, ranks.start..border, rank_of_block);
    bisect(right, border..ranks.end, rank_of_block);
}

/// The error of more ranks than blocks, with the largest block size that gives enough of them.
fn too_many(partition: &Partition, ranks: usize) -> EngineError {
    let mut of_sets: Vec<usize> = Vec::new();
    for block in &partition.blocks {
        if of_sets.len() <= block.set {
            of_sets.resize(block.set + 1, 0);
        }
        of_sets[block.set] += block.elements.len();
    }
    let elements: usize = of_sets.iter().sum();
    if ranks > elements {
        return EngineError::MoreRanksThanElements { ranks, elements };
    }
    let blocks = |size: usize| of_sets.iter().map(|own| own.div_ceil(size)).sum::<usize>();
    // The number of blocks falls with their size: enough at one element, too few at all of them.
    let (mut enough, mut too_large) = (1, elements + 1);
    while too_large - enough > 1 {
        let size = enough.midpoint(too_large);
        if blocks(size) >= ranks {
            enough = size;
        } else {
            too_large = size;
        }
    }
    EngineError::TooManyRanks {
        ranks,
        blocks: partition.blocks.len(),
        block_size: enough,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::partition::ElementSets;

    /// A flat body in two sets.
    fn body() -> Mesh {
        let size = Vec3::new(24.0, 10.0, 3.0);
        Mesh::box_of_hexes(Vec3::zeros(), size, [24, 10, 3], "rock").unwrap()
    }

    fn divided(mesh: &Mesh, size: usize) -> Partition {
        let all: Vec<u32> = (0..mesh.element_count() as u32).collect();
        with_costs(mesh, size, [&all[..200], &all[200..]], [1.0, 1.0])
    }

    fn with_costs(mesh: &Mesh, size: usize, elements: [&[u32]; 2], costs: [f64; 2]) -> Partition {
        let sets = ElementSets {
            labels: &["lower", "upper"],
            elements: &elements,
            costs: &costs,
            absent: &vec![false; mesh.element_count()],
        };
        Partition::new(mesh, sets, size).unwrap()
    }

    /// Every rank has blocks, in a compact region, and no rank has much more than its share.
    #[test]
    fn ranks_have_their_share_of_the_cost() {
        let mesh = body();
        let partition = divided(&mesh, 10);
        for ranks in [1, 2, 3, 4, 7, 16] {
            let distribution = Distribution::new(&partition, &mesh, ranks).unwrap();
            assert_eq!(
                distribution,
                Distribution::new(&partition, &mesh, ranks).unwrap()
            );
            let costs = distribution.costs(&partition);
            let share = mesh.element_count() as f64 / ranks as f64;
            // At each of the bisections half a block may be too many on one side.
            let halvings = (ranks as f64).log2().ceil();
            for cost in costs {
                assert!(
                    cost > 0.0 && (cost - share).abs() <= 5.0 * halvings,
                    "{ranks}: {cost}"
                );
            }
        }
        // The first cut is across the longest extent: the two ranks overlap by the thickness of a block at most.
        let two = Distribution::new(&partition, &mesh, 2).unwrap();
        for (block, &rank) in partition.blocks.iter().zip(&two.rank_of_block) {
            let beyond =
                |e: &u32| (mesh.centroid(*e).x - 12.0) * (2.0 * f64::from(rank) - 1.0) > -4.0;
            assert!(block.elements.iter().all(beyond));
        }
        let every = Distribution::new(&partition, &mesh, partition.blocks.len()).unwrap();
        let mut ranks = every.rank_of_block;
        ranks.sort_unstable();
        assert!((0..).zip(ranks).all(|(expected, rank)| rank == expected));
    }

    /// Where elements of one set cost seven times as much as others, a rank has fewer of them.
    #[test]
    fn ranks_share_the_cost_and_not_the_elements() {
        let mesh = body();
        let all = 0..mesh.element_count() as u32;
        let (left, right): (Vec<u32>, Vec<u32>) = all.partition(|&e| mesh.centroid(e).x < 8.0);
        let partition = with_costs(&mesh, 10, [&left, &right], [7.0, 1.0]);
        let total = 7.0 * 240.0 + 480.0;
        for ranks in [2, 3, 5] {
            let distribution = Distribution::new(&partition, &mesh, ranks).unwrap();
            let costs = distribution.costs(&partition);
            assert_eq!(costs.iter().sum::<f64>(), total);
            let halvings = (ranks as f64).log2().ceil();
            for cost in &costs {
                let share = total / ranks as f64;
                assert!(
                    (cost - share).abs() <= 35.0 * halvings,
                    "{ranks}: {costs:?}"
                );
            }
            let mut elements = vec![0; ranks];
            for (&rank, block) in distribution.rank_of_block.iter().zip(&partition.blocks) {
                elements[rank as usize] += block.elements.len();
            }
            let (least, most) = (elements.iter().min(), elements.iter().max());
            assert!(
                most > least.map(|least| least + 100).as_ref(),
                "{elements:?}"
            );
        }
    }

    /// More ranks than blocks are refused with the block size that would do, and that one does.
    #[test]
    fn more_ranks_than_blocks_are_refused_with_a_remedy() {
        let mesh = body();
        for ranks in [9, 50, 719, 720] {
            let refused = Distribution::new(&divided(&mesh, 100), &mesh, ranks).unwrap_err();
            let EngineError::TooManyRanks { block_size, .. } = refused else {
                panic!("{refused}");
            };
            let partition = divided(&mesh, block_size);
            assert!(Distribution::new(&partition, &mesh, ranks).is_ok());
            let partition = divided(&mesh, block_size + 1);
            assert!(Distribution::new(&partition, &mesh, ranks).is_err());
        }
        let refused = Distribution::new(&divided(&mesh, 100), &mesh, 721).unwrap_err();
        let (ranks, elements) = (721, 720);
        assert_eq!(
            refused,
            EngineError::MoreRanksThanElements { ranks, elements }
        );
    }
}
