//! Diagonal coefficients of groups of one node.

use powerhouse_model::Vec3;

use crate::node_group::{Coefficients, NodeGroup, is_diagonal};

/// Diagonal form of the coefficients of a group of one node, valid where all its matrices are diagonal, as on the
/// faces of a box; it takes two cache lines instead of eight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DiagonalGroup {
    pub(crate) lead: u32,
    pub(crate) is_diagonal: bool,
    /// Whether the group has a prescribed motion.
    pub(crate) is_prescribed: bool,
    /// Whether it has a mass only.
    pub(crate) is_bare: bool,
    pub(crate) carry: Vec3,
    /// `P` times the step (s/kg).
    pub(crate) response: Vec3,
    /// Spring (N/m), dashpot (N s/m) and mass damping (kg/s).
    pub(crate) spring: Vec3,
    pub(crate) dashpot: Vec3,
    pub(crate) mass_damping: f64,
}

impl DiagonalGroup {
    /// That of a group with its coefficients, for a step (s).
    pub(crate) fn new(group: &NodeGroup, matrices: &Coefficients, step: f64) -> Self {
        let all = [
            &matrices.carry,
            &matrices.inverse,
            &group.spring,
            &group.dashpot,
        ];
        Self {
            lead: group.members[0],
            is_diagonal: group.members.len() == 1 && all.into_iter().all(is_diagonal),
            carry: matrices.carry.diagonal(),
            response: matrices.inverse.diagonal() * step,
            spring: group.spring.diagonal(),
            dashpot: group.dashpot.diagonal(),
            mass_damping: group.mass_damping,
            is_prescribed: !group.condition.prescribed.is_empty(),
            is_bare: group.is_bare(),
        }
    }
}
