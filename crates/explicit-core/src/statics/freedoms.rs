//! The unknowns of a model: which nodes move, and in which directions.

use powerhouse_model::{Mat3, Vec3};

use crate::groups::Group;
use crate::support::Condition;

/// A node that moves with none.
const HELD: u32 = u32::MAX;

/// The directions in which a node is free.
#[derive(Clone, Copy, Debug)]
pub(super) struct Free {
    /// Orthonormal columns, the first [`count`](Self::count) of them.
    pub(super) directions: Mat3,
    /// How many there are, 0 to 3.
    pub(super) count: usize,
}

impl Free {
    const ALL: Self = Self {
        directions: Mat3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        count: 3,
    };

    /// What a condition leaves: along the axes, if it holds axes.
    fn beside(condition: &Condition) -> Self {
        let mut taken = condition.directions().to_vec();
        let mut free = Self {
            directions: Mat3::zeros(),
            count: 0,
        };
        while taken.len() < 3 {
            // The axis that is least along the directions known.
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

/// Unknown displacements, node by node.
pub(super) struct Freedoms {
    /// The node whose unknowns each node has.
    lead_of: Vec<u32>,
    free: Vec<Free>,
}

impl Freedoms {
    /// Of nodes of which some move as groups and some, which `moves` denies, not at all.
    pub(super) fn new(groups: &[Group], moves: impl Fn(usize) -> bool, count: usize) -> Self {
        let mut lead_of: Vec<u32> = (0..count as u32).collect();
        let mut free = vec![Free::ALL; count];
        for group in groups {
            let lead = group.members[0];
            for &member in &group.members {
                lead_of[member as usize] = lead;
            }
            free[lead as usize] = Free::beside(&group.condition);
        }
        for node in 0..count {
            let lead = lead_of[node] as usize;
            if lead == node && (free[node].count == 0 || !moves(node)) {
                free[node].count = 0;
            }
        }
        for lead in &mut lead_of {
            if free[*lead as usize].count == 0 {
                *lead = HELD;
            }
        }
        Self { lead_of, free }
    }

    /// The node whose unknowns a node has, if it moves.
    pub(super) fn lead(&self, node: u32) -> Option<u32> {
        let lead = self.lead_of[node as usize];
        (lead != HELD).then_some(lead)
    }

    /// The free directions of a lead.
    pub(super) fn free(&self, lead: u32) -> &Free {
        &self.free[lead as usize]
    }

    /// The leads that move, in rising order.
    pub(super) fn leads(&self) -> Vec<u32> {
        let nodes = 0..self.lead_of.len() as u32;
        nodes
            .filter(|&node| self.lead(node) == Some(node))
            .collect()
    }
}
