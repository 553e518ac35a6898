//! Pairing of the nodes of two sides.

use std::collections::{HashMap, HashSet};

use powerhouse_model::{Mesh, Vec3};

use crate::ContactError;

/// Node pairs of two sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Pairing {
    /// Mesh indices of each pair, the node of the first side first; in the order of the first side.
    pub pairs: Vec<[u32; 2]>,
    /// Largest distance between the nodes of a pair (m).
    pub worst_gap: f64,
    /// Pair with that distance (mesh indices).
    pub worst_pair: [u32; 2],
}

/// Pairs each node of one side (mesh indices) with the coincident node of the other side.
///
/// `tolerance` (m) bounds the distance of a pair. Both sides must pair completely: a node left
/// over would be a hole in the joint. A node of both sides (the tip of a joint) makes no pair.
///
/// # Errors
/// [`ContactError::NoPartner`], [`ContactError::Ambiguous`], [`ContactError::Empty`] or
/// [`ContactError::Tolerance`].
///
/// # Panics
/// If a node does not belong to the mesh.
pub fn pair_nodes(
    mesh: &Mesh,
    first: &[u32],
    second: &[u32],
    tolerance: f64,
) -> Result<Pairing, ContactError> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(ContactError::Tolerance { tolerance });
    }
    let (first, second) = (without(first, second), without(second, first));
    if first.is_empty() || second.is_empty() {
        return Err(ContactError::Empty);
    }
    let pairs = partners(mesh, &first, &second, tolerance)?;
    partners(mesh, &second, &first, tolerance)?;
    let gap =
        |[i, j]: [u32; 2]| (mesh.positions()[j as usize] - mesh.positions()[i as usize]).norm();
    let worst_pair = pairs
        .iter()
        .copied()
        .max_by(|a, b| gap(*a).total_cmp(&gap(*b)))
        .ok_or(ContactError::Empty)?;
    Ok(Pairing {
        worst_gap: gap(worst_pair),
        worst_pair,
        pairs,
    })
}

/// Nodes that are not on the other side too.
fn without(nodes: &[u32], other: &[u32]) -> Vec<u32> {
    let other: HashSet<u32> = other.iter().copied().collect();
    let own = nodes.iter().copied();
    own.filter(|node| !other.contains(node)).collect()
}

/// Pairs of each node with the only candidate within the tolerance.
fn partners(
    mesh: &Mesh,
    nodes: &[u32],
    candidates: &[u32],
    tolerance: f64,
) -> Result<Vec<[u32; 2]>, ContactError> {
    let position = |node: u32| mesh.positions()[node as usize];
    let tag = |node: u32| mesh.node_tags()[node as usize];
    // Cells as wide as the tolerance: whatever is close enough lies in one of 27.
    let cell = |p: Vec3| [p.x, p.y, p.z].map(|x| (x / tolerance).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for &candidate in candidates {
        cells
            .entry(cell(position(candidate)))
            .or_default()
            .push(candidate);
    }
    let mut pairs = Vec::with_capacity(nodes.len());
    for &node in nodes {
        let here = position(node);
        let mut near = neighbours(cell(here))
            .filter_map(|c| cells.get(&c))
            .flatten()
            .copied()
            .filter(|&candidate| (position(candidate) - here).norm() <= tolerance);
        match (near.next(), near.next()) {
            (Some(partner), None) => pairs.push([node, partner]),
            (Some(one), Some(other)) => {
                return Err(ContactError::Ambiguous {
                    node: tag(node),
                    first: tag(one),
                    second: tag(other),
                    tolerance,
                });
            }
            (None, _) => {
                let distance = |candidate: u32| (position(candidate) - here).norm();
                let nearest = candidates
                    .iter()
                    .copied()
                    .min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
                    .ok_or(ContactError::Empty)?;
                return Err(ContactError::NoPartner {
                    node: tag(node),
                    nearest: tag(nearest),
                    distance: distance(nearest),
                    tolerance,
                });
            }
        }
    }
    Ok(pairs)
}

/// A cell and the 26 around it.
pub(crate) fn neighbours([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |i| {
        [
            x.saturating_add(i % 3 - 1),
            y.saturating_add(i / 3 % 3 - 1),
            z.saturating_add(i / 9 - 1),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use powerhouse_model::ElementKind;

    /// Two unit tetrahedra that face each other across the plane z = 0, the upper one shifted
    /// along x by `shift`.
    fn two_tetrahedra(shift: f64) -> Mesh {
        let mut builder = Mesh::builder();
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        for (i, [x, y]) in corners.into_iter().enumerate() {
            builder.node(11 + i as u64, Vec3::new(x, y, 0.0));
            builder.node(21 + i as u64, Vec3::new(x + shift, y, 0.0));
        }
        builder.node(14, Vec3::new(0.0, 0.0, -1.0));
        builder.node(24, Vec3::new(0.0, 0.0, 1.0));
        builder.element(1, ElementKind::Tet4, &[14, 11, 12, 13], &["lower"]);
        builder.element(2, ElementKind::Tet4, &[21, 22, 23, 24], &["upper"]);
        builder.node_set("lower side", &[11, 12, 13]);
        builder.node_set("upper side", &[23, 21, 22]);
        builder.build().unwrap()
    }

    fn pair(mesh: &Mesh, tolerance: f64) -> Result<Pairing, ContactError> {
        let side = |name| mesh.node_set(name).unwrap();
        pair_nodes(mesh, side("lower side"), side("upper side"), tolerance)
    }

    /// Nodes pair by place whatever the order of the lists, and the worst gap is named.
    #[test]
    fn nodes_pair_by_place() {
        let mesh = two_tetrahedra(1.0e-4);
        let pairing = pair(&mesh, 1.0e-3).unwrap();
        assert_eq!(pairing.pairs.len(), 3);
        for [i, j] in &pairing.pairs {
            let tag = |node: &u32| mesh.node_tags()[*node as usize];
            assert_eq!(tag(i) + 10, tag(j));
        }
        assert!((pairing.worst_gap - 1.0e-4).abs() < 1e-15);
        assert!(pairing.pairs.contains(&pairing.worst_pair));
    }

    /// A node without a partner is refused with its number, the nearest node and the distance.
    #[test]
    fn a_node_without_partner_is_named() {
        let error = pair(&two_tetrahedra(0.25), 1.0e-3).unwrap_err();
        let ContactError::NoPartner {
            node,
            nearest,
            distance,
            ..
        } = error
        else {
            panic!("{error}");
        };
        assert_eq!((node, nearest), (11, 21));
        assert!((distance - 0.25).abs() < 1e-15);
    }

    /// A tolerance that reaches two nodes is refused: either could be the partner.
    #[test]
    fn an_ambiguous_tolerance_is_refused() {
        let error = pair(&two_tetrahedra(0.0), 1.1).unwrap_err();
        assert!(
            matches!(error, ContactError::Ambiguous { node: 11, .. }),
            "{error}"
        );
    }

    /// Both sides must pair completely, nodes on both sides are one node already, and empty or
    /// senseless input is refused.
    #[test]
    fn sides_must_pair_completely() {
        let mesh = two_tetrahedra(0.0);
        let lower = mesh.node_set("lower side").unwrap();
        let upper = mesh.node_set("upper side").unwrap();
        let error = pair_nodes(&mesh, &lower[..2], upper, 1e-6).unwrap_err();
        assert!(
            matches!(error, ContactError::NoPartner { node: 23, .. }),
            "{error}"
        );
        let tip = [lower, &upper[..1]].concat();
        assert_eq!(
            pair_nodes(&mesh, &tip[1..], upper, 1e-6)
                .unwrap()
                .pairs
                .len(),
            2
        );
        assert_eq!(
            pair_nodes(&mesh, &[], upper, 1e-6),
            Err(ContactError::Empty)
        );
        assert_eq!(
            pair_nodes(&mesh, lower, upper, 0.0),
            Err(ContactError::Tolerance { tolerance: 0.0 })
        );
    }
}
