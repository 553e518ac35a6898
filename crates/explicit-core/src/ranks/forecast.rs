//! What several ranks would compute and send, from a model on one rank.

use powerhouse_model::{EngineError, Precision, RankForecast};

use super::distribution::Distribution;
use super::layout::{AllBlocks, Layout};
use crate::Model;
use crate::nodes::Storage;

impl Model {
    /// Elements, nodes and messages of each of some ranks that would share this model, which has all blocks.
    ///
    /// # Errors
    /// As [`Distribution::new`], and [`EngineError::OneRankOnly`] for a model that is itself a part.
    pub fn rank_forecast(&self, ranks: usize) -> Result<Vec<RankForecast>, EngineError> {
        if !self.ranks.is_single() {
            return Err(self.ranks.one_rank_only("a forecast"));
        }
        let ranks = ranks.max(1);
        let distribution = Distribution::new(self.partition(), self.mesh(), ranks)?;
        let mut rank_of = distribution.rank_of_block;
        let solids = rank_of.len();
        let nodes: Vec<Vec<u32>> = (0..self.blocks.len())
            .map(|block| self.subdomain.nodes_of(block).to_vec())
            .collect();
        for (_, host) in self.embedded_hosts() {
            rank_of.push(host.map_or(0, |host| rank_of[host as usize]));
        }
        for block in rank_of.len()..nodes.len() {
            let mut wanted = nodes[block].clone();
            wanted.sort_unstable();
            let has = |own: &Vec<u32>| own.iter().any(|node| wanted.binary_search(node).is_ok());
            let beside = nodes[..block].iter().position(has);
            rank_of.push(beside.map_or(0, |beside| rank_of[beside]));
        }
        let local = |nodes: &[u32]| -> Vec<u32> {
            let nodes = nodes.iter();
            nodes.map(|&node| self.engine(node) as u32).collect()
        };
        let parts: Vec<Vec<u32>> = self.constraint_parts().iter().map(local).collect();
        let parts = powerhouse_model::ConstraintParts::merged(parts.iter().map(|part| &part[..]));
        let all = AllBlocks {
            node_count: self.mass.len(),
            nodes: &nodes,
            ranks: &rank_of,
            parts: &parts,
        };
        let number = match self.precision {
            Precision::F32 => <f32 as Storage>::BYTES,
            _ => <f64 as Storage>::BYTES,
        };
        let total: f64 = self
            .partition()
            .blocks
            .iter()
            .map(|block| block.cost())
            .sum();
        let of_rank = |rank: u32| {
            let layout = Layout::new(&all, rank, ranks);
            let own = (self.partition().blocks.iter().zip(&rank_of[..solids]))
                .filter(|(_, owner)| **owner == rank);
            let (mut elements, mut work, mut inner_work) = (0, 0.0, 0.0);
            for (number, (block, _)) in own.enumerate() {
                let share = block.cost() / total;
                elements += block.elements.len();
                work += share;
                if !layout.exchange.is_at_border(number) {
                    inner_work += share;
                }
            }
            let (shared, messages, slots) = layout.exchange.planned();
            RankForecast::new(elements, layout.present.len(), shared)
                .with_traffic(messages, messages + slots * 3 * number)
                .with_work(work, inner_work)
        };
        Ok((0..ranks as u32).map(of_rank).collect())
    }
}
