//! Degrees of freedom of a static model: free nodes and their free directions.

use powerhouse_model::{Mat3, Vec3};

use crate::condition::Condition;
use crate::node_group::NodeGroup;

/// Lead of a node without unknowns.
const FIXED: u32 = u32::MAX;

/// Free directions of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreeDirections {
    /// Orthonormal columns, the first [`count`](Self::count) of them.
    pub(super) directions: Mat3,
    /// Number of free directions, 0 to 3.
    pub(super) count: usize,
}

impl FreeDirections {
    const ALL: Self = Self {
        directions: Mat3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        count: 3,
    };

    /// The directions that a condition leaves free; coordinate axes, if it fixes coordinate axes.
    fn of(condition: &Condition) -> Self {
        let mut taken = condition.directions().to_vec();
        let mut free = Self {
            directions: Mat3::zeros(),
            count: 0,
        };
        while taken.len() < 3 {
            // The coordinate axis with the least components along the directions found so far.
            let rests = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| {
                let once = taken.iter().fold(axis, |rest, q| rest - q * q.dot(&rest));
                taken.iter().fold(once, |rest, q| rest - q * q.dot(&rest))
            });
            let longest = (rests.iter()).fold(rests[0], |long, rest| {
                if rest.norm() > long.norm() {
                    *rest
                } else {
                    long
                }
            });
            let direction = longest.normalize();
            free.directions.set_column(free.count, &direction);
            free.count += 1;
            taken.push(direction);
        }
        free
    }
}

/// Unknown displacements of all nodes.
pub(super) struct DegreesOfFreedom {
    /// The lead node with which each node shares its unknowns.
    lead_of: Vec<u32>,
    free: Vec<FreeDirections>,
}

impl DegreesOfFreedom {
    /// From groups of nodes with a common motion; nodes for which `moves` is false are fixed.
    pub(super) fn new(groups: &[NodeGroup], moves: impl Fn(usize) -> bool, count: usize) -> Self {
        let mut lead_of: Vec<u32> = (0..count as u32).collect();
        let mut free = vec![FreeDirections::ALL; count];
        for group in groups {
            let lead = group.members[0];
            for &member in &group.members {
                lead_of[member as usize] = lead;
            }
            free[lead as usize] = FreeDirections::of(&group.condition);
        }
        for node in 0..count {
            let lead = lead_of[node] as usize;
            if lead == node && (free[node].count == 0 || !moves(node)) {
                free[node].count = 0;
            }
        }
        for lead in &mut lead_of {
            if free[*lead as usize].count == 0 {
                *lead = FIXED;
            }
        }
        Self { lead_of, free }
    }

    /// The lead node with which a node shares its unknowns; none for a fixed node.
    pub(super) fn lead(&self, node: u32) -> Option<u32> {
        let lead = self.lead_of[node as usize];
        (lead != FIXED).then_some(lead)
    }

    /// The free directions of a lead node.
    pub(super) fn free(&self, lead: u32) -> &FreeDirections {
        &self.free[lead as usize]
    }

    /// The lead nodes with unknowns, in rising order.
    pub(super) fn leads(&self) -> Vec<u32> {
        let nodes = 0..self.lead_of.len() as u32;
        nodes
            .filter(|&node| self.lead(node) == Some(node))
            .collect()
    }
}
