//! Fibres: nodes whose motion relative to each other has added inertia.

use crate::{DisjointSets, EngineError, ParameterError};

/// Nodes along a line through a thin part of the body, or around a thin corner, whose motion relative to each other has
/// added inertia: selective mass scaling (Olovsson, Simonsson & Unosson 2005).
///
/// For nodes of masses `m_i` with the sum `s` the inertia in each direction is `diag(m) + a (diag(m) - m m^T / s)`.
/// The mass of their common motion is exact, that of any motion relative to it is `1 + a` times as great; modes in
/// which a thin part changes its thickness become slower and no longer limit the time step. Weight and damping act on
/// the true masses.
#[derive(Clone, Debug, PartialEq)]
pub struct Fibre {
    /// The nodes, mesh indices, two or more.
    pub nodes: Vec<u32>,
    /// Inertia that is added to relative motion, over the mass (1); zero or more.
    pub added: f64,
}

impl Fibre {
    /// Largest permitted [`added`](Self::added) inertia: the step would be a hundred times as long.
    pub const MOST_ADDED: f64 = 1e4;

    /// The fibres of a mesh of `count` nodes, with those that have common nodes merged into one, which has the largest
    /// of their added inertias. Nodes that move as one, given as sets of mesh indices, count as common nodes.
    ///
    /// # Errors
    /// [`EngineError::UnknownNode`]; [`EngineError::Parameter`] for an added inertia outside 0 to
    /// [`MOST_ADDED`](Self::MOST_ADDED).
    pub fn merged<'a>(
        fibres: &[Self],
        tied: impl IntoIterator<Item = &'a [u32]>,
        count: usize,
    ) -> Result<Vec<Self>, EngineError> {
        let mut sets = DisjointSets::new(count);
        for nodes in tied {
            for pair in nodes.windows(2) {
                sets.join(pair[0], pair[1]);
            }
        }
        for fibre in fibres {
            ParameterError::check(
                "added inertia of a fibre",
                fibre.added,
                0.0,
                Self::MOST_ADDED,
            )?;
            if let Some(&node) = fibre.nodes.iter().find(|node| **node as usize >= count) {
                let part = "a fibre".into();
                return Err(EngineError::UnknownNode { part, node, count });
            }
            for pair in fibre.nodes.windows(2) {
                sets.join(pair[0], pair[1]);
            }
        }
        let mut members: Vec<(u32, u32, f64)> = Vec::new();
        for fibre in fibres {
            let own = fibre.nodes.iter();
            members.extend(own.map(|&node| (sets.root(node), node, fibre.added)));
        }
        members.sort_by_key(|member| (member.0, member.1));
        let one = |of: &[(u32, u32, f64)]| {
            let mut nodes: Vec<u32> = of.iter().map(|(_, node, _)| *node).collect();
            nodes.dedup();
            let added = of
                .iter()
                .fold(0.0, |most: f64, (.., added)| most.max(*added));
            Self { nodes, added }
        };
        Ok(members.chunk_by(|a, b| a.0 == b.0).map(one).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fibres with a common node, or with nodes that move as one, are one, with the largest added inertia; others stay
    /// apart.
    #[test]
    fn fibres_with_common_nodes_are_one() {
        let of = |nodes: &[u32], added: f64| Fibre {
            nodes: nodes.to_vec(),
            added,
        };
        let all = [
            of(&[8, 3], 1.0),
            of(&[5, 6], 2.0),
            of(&[3, 4], 4.0),
            of(&[0, 1], 0.5),
        ];
        let merged = Fibre::merged(&all, [&[6, 9][..], &[9, 1]], 10).unwrap();
        assert_eq!(merged, [of(&[0, 1, 5, 6], 2.0), of(&[3, 4, 8], 4.0)]);
        let beyond = Fibre::merged(&[of(&[3, 10], 1.0)], [], 10);
        assert!(matches!(
            beyond,
            Err(EngineError::UnknownNode { node: 10, .. })
        ));
        for added in [-0.1, f64::NAN, 2e4] {
            let refused = Fibre::merged(&[of(&[3, 4], added)], [], 10);
            assert!(matches!(refused, Err(EngineError::Parameter(_))), "{added}");
        }
    }
}
