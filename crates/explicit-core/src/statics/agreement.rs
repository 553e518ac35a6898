//! Static solutions on several ranks: sums over the blocks of all of them, and failures on which they agree.

use powerhouse_model::{Mat3, Quad, StaticError, Vec3, decode, encode};

use crate::Model;
use crate::model::ElementAt;

/// Key of a rank that has not failed.
const NONE: u64 = u64::MAX;

/// Set, number and reason of a failed element, or the message of another error.
type Sent = (Option<(u64, String, String)>, String);

impl Model {
    /// The result of work on every rank: a failure of one of them is one on all. Of several, that with the least `order` of a
    /// rank is taken, then that of the lowest rank.
    pub(super) fn agreed_by<T>(
        &self,
        result: Result<T, StaticError>,
        order: u64,
    ) -> Result<T, StaticError> {
        let team = &self.ranks.team;
        if team.is_single() {
            return result;
        }
        let least = team.least(if result.is_err() { order } else { NONE });
        team.check()?;
        if least == NONE {
            return result;
        }
        let is_first = result.is_err() && order == least;
        let rank = team.rank() as u64;
        let first = team.least(if is_first { rank } else { NONE }) as usize;
        let sent: Option<Sent> = result.as_ref().err().map(|error| match error {
            StaticError::Element {
                element,
                set,
                reason,
            } => {
                let place = (*element, set.clone(), reason.clone());
                (Some(place), String::new())
            }
            other => (None, other.to_string()),
        });
        let sent = encode(&sent.unwrap_or_default()).unwrap_or_default();
        let received = team.of_rank(first, sent);
        team.check()?;
        if first == team.rank() {
            return result;
        }
        let (place, message) = decode::<Sent>(&received).unwrap_or_default();
        Err(match place {
            Some((element, set, reason)) => StaticError::Element {
                element,
                set,
                reason,
            },
            None => StaticError::OnRank {
                rank: first,
                message,
            },
        })
    }

    /// The result of work on every rank: a failure of one of them, the lowest one, is one on all.
    pub(super) fn agreed<T>(&self, result: Result<T, StaticError>) -> Result<T, StaticError> {
        self.agreed_by(result, 0)
    }

    /// Whether something is true on every rank.
    pub(super) fn on_all_ranks(&self, own: bool) -> bool {
        self.ranks.team.least(u64::from(own)) == 1
    }

    /// Sums at each node of the vectors that blocks give their nodes, in the global order of the blocks; `of_block` returns
    /// those of a block by its local index.
    pub(crate) fn assembled(&mut self, of_block: impl Fn(&Self, usize) -> Vec<Vec3>) -> Vec<Vec3> {
        let mut sums = vec![Vec3::zeros(); self.mass.len()];
        if self.ranks.is_single() {
            for block in 0..self.blocks.len() {
                let own = of_block(self, block);
                for (&node, vector) in self.subdomain.nodes_of(block).iter().zip(own) {
                    sums[node as usize] += vector;
                }
            }
            return sums;
        }
        let mut entries: Vec<Quad<f64>> = Vec::with_capacity(self.ranks.exchange.slots);
        for block in 0..self.blocks.len() {
            entries.extend(of_block(self, block).iter().map(Quad::from_vector));
        }
        entries.resize(self.ranks.exchange.slots, Quad::default());
        self.ranks.exchange.swap(&self.ranks.team, &mut entries);
        for (node, sum) in sums.iter_mut().enumerate() {
            for &slot in self.subdomain.slots.of(node) {
                *sum += entries[slot as usize].to_vector();
            }
        }
        sums
    }

    /// The same of matrices.
    pub(super) fn assembled_matrices(&mut self, of_blocks: &[Vec<Mat3>]) -> Vec<Mat3> {
        let columns = [0, 1, 2].map(|column| {
            self.assembled(|_, block| {
                let own = of_blocks[block].iter();
                own.map(|matrix| matrix.column(column).into_owned())
                    .collect()
            })
        });
        let node = |node: usize| {
            let [first, second, third] = &columns;
            Mat3::from_columns(&[first[node], second[node], third[node]])
        };
        (0..self.mass.len()).map(node).collect()
    }

    /// Of all ranks, the node with the largest vector, a vector that is not finite counting as the largest: its number, and the
    /// element there with the highest frequency bound.
    pub(super) fn largest_at(&self, vectors: &[Vec3]) -> (u64, ElementAt) {
        let size = |vector: &Vec3| match vector.norm() {
            size if size.is_finite() => size,
            _ => f64::INFINITY,
        };
        let mut worst = (0, -1.0);
        for (node, vector) in vectors.iter().enumerate() {
            let size = size(vector);
            if size > worst.1 {
                worst = (node, size);
            }
        }
        let team = &self.ranks.team;
        let most = team.most_of(worst.1.max(0.0));
        let own = if worst.1 == most {
            self.ranks.engine(worst.0) as u64
        } else {
            NONE
        };
        self.named_node(team.least(own))
    }

    /// Number of an engine node of any rank, and the element there with the highest frequency bound, on all ranks.
    pub(super) fn named_node(&self, engine: u64) -> (u64, ElementAt) {
        let local = self.ranks.local(engine as u32) as usize;
        let is_here = local < self.mass.len();
        let own = if is_here { self.node_tag(local) } else { NONE };
        let tag = self.ranks.team.least(own);
        (tag, self.element_of_all(engine))
    }

    /// Name of the element set of an active element (mesh index) of any rank, on all ranks.
    pub(super) fn set_of_all(&self, element: u32) -> String {
        let block = self.subdomain.block_of(element);
        let block = block.map(|(block, _)| &self.blocks[block]);
        let team = &self.ranks.team;
        let rank = team.least(if block.is_some() {
            team.rank() as u64
        } else {
            NONE
        });
        if rank == NONE {
            return String::new();
        }
        let own = block.map_or("", |block| block.label());
        let name = team.of_rank(rank as usize, own.as_bytes().to_vec());
        String::from_utf8_lossy(&name).into_owned()
    }
}
