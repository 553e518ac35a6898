//! Periodic boundary conditions.

use std::collections::HashMap;

use crate::{EngineError, Mesh, ParameterError, Vec3};

/// Periodic boundary conditions: pairs of tied nodes, with a common motion under the sum of their masses and forces.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PeriodicPairs {
    /// The node pairs, by mesh index.
    pub pairs: Vec<(u32, u32)>,
}

impl PeriodicPairs {
    /// Pairs of matching nodes of two faces (mesh indices) that differ by a translation, to a `tolerance` (m).
    ///
    /// The translation is that of the lowest corners of the bounding boxes of the two faces. Where a joint crosses
    /// the faces several nodes coincide: each is paired with the one at which the body lies on the same
    /// side of it, by the surface of the mesh.
    ///
    /// # Errors
    /// [`EngineError::PeriodicMismatch`] with the node farthest from its partner; [`EngineError::PeriodicSides`] with a node
    /// among coincident ones whose sides do not tell them apart; [`EngineError::UnknownNode`].
    pub fn by_translation(
        mesh: &Mesh,
        from: &[u32],
        to: &[u32],
        tolerance: f64,
    ) -> Result<Self, EngineError> {
        ParameterError::check("tolerance", tolerance, 0.0, f64::MAX)?;
        let position = |node: u32| {
            let found = mesh.positions().get(node as usize).copied();
            found.ok_or(EngineError::UnknownNode {
                part: "a periodic pair".into(),
                node,
                count: mesh.node_count(),
            })
        };
        let low = |nodes: &[u32]| -> Result<Vec3, EngineError> {
            let mut low = Vec3::repeat(f64::INFINITY);
            for &node in nodes {
                low = low.inf(&position(node)?);
            }
            Ok(low)
        };
        let translation = low(to)? - low(from)?;
        let (mut partners, worst_from) = nearest(mesh, from, to, translation);
        let (_, worst_to) = nearest(mesh, to, from, -translation);
        let worst = if worst_from.1 >= worst_to.1 {
            worst_from
        } else {
            worst_to
        };
        if worst.1 <= tolerance && from.len() == to.len() && taken_twice(&partners).is_some() {
            partners = on_the_same_side(mesh, from, to, (translation, worst.1));
        }
        let tag = |node: u32| mesh.node_tags().get(node as usize).copied().unwrap_or(0);
        if worst.1 > tolerance || from.len() != to.len() {
            return Err(EngineError::PeriodicMismatch {
                from: from.len(),
                to: to.len(),
                node: tag(worst.0),
                distance: worst.1,
                tolerance,
            });
        }
        if let Some(node) = taken_twice(&partners) {
            return Err(EngineError::PeriodicSides { node: tag(node) });
        }
        Ok(Self {
            pairs: from.iter().copied().zip(partners).collect(),
        })
    }

    /// Lead node of each tied node (mesh indices): the lowest index among the nodes that some periodic pairs connect with
    /// it, itself included.
    pub fn leads<'p>(ties: impl IntoIterator<Item = &'p Self>) -> HashMap<u32, u32> {
        fn root(leads: &HashMap<u32, u32>, mut node: u32) -> u32 {
            while let Some(&lead) = leads.get(&node).filter(|&&lead| lead != node) {
                node = lead;
            }
            node
        }
        let mut leads = HashMap::new();
        for &(a, b) in ties.into_iter().flat_map(|ties| &ties.pairs) {
            for node in [a, b] {
                leads.entry(node).or_insert(node);
            }
            let (a, b) = (root(&leads, a), root(&leads, b));
            leads.insert(a.max(b), a.min(b));
        }
        let nodes: Vec<u32> = leads.keys().copied().collect();
        let found = nodes.iter().map(|&node| (node, root(&leads, node)));
        found.collect()
    }
}

/// A node that is the partner of several.
fn taken_twice(partners: &[u32]) -> Option<u32> {
    let mut sorted = partners.to_vec();
    sorted.sort_unstable();
    let twice = sorted.windows(2).find(|pair| pair[0] == pair[1]);
    twice.map(|pair| pair[0])
}

/// The partner of each node, and the node farthest from its partner with that distance (m).
fn nearest(mesh: &Mesh, from: &[u32], to: &[u32], translation: Vec3) -> (Vec<u32>, (u32, f64)) {
    let position = |node: u32| mesh.positions()[node as usize];
    let extent = to.iter().fold(
        (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
        |(low, high), &node| (low.inf(&position(node)), high.sup(&position(node))),
    );
    let axis = (extent.1 - extent.0).imax();
    let mut sorted: Vec<(f64, u32)> = to.iter().map(|&n| (position(n)[axis], n)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut worst = (from.first().copied().unwrap_or(0), 0.0);
    let partners = from
        .iter()
        .map(|&node| {
            let target = position(node) + translation;
            let middle = sorted.partition_point(|&(x, _)| x < target[axis]);
            let mut best = (node, f64::INFINITY);
            let mut closer = |&(x, candidate): &(f64, u32)| {
                let distance = (position(candidate) - target).norm();
                if distance < best.1 {
                    best = (candidate, distance);
                }
                (x - target[axis]).abs() <= best.1
            };
            let _ = sorted[middle..].iter().all(&mut closer);
            let _ = sorted[..middle].iter().rev().all(&mut closer);
            if best.1 > worst.1 {
                worst = (node, best.1);
            }
            best.0
        })
        .collect();
    (partners, worst)
}

/// The side of each of some nodes on which the body lies, across the translation: the sum of the angles of the facets of
/// the surface at the node times their normals. It is known from the surface alone, so that elements may differ.
fn sides(mesh: &Mesh, translation: Vec3, nodes: impl Iterator<Item = u32>) -> HashMap<u32, Vec3> {
    let axis = translation.try_normalize(0.0).unwrap_or_default();
    let mut sides: HashMap<u32, Vec3> = nodes.map(|node| (node, Vec3::zeros())).collect();
    for facet in mesh.boundary_facets() {
        let ring = mesh.facet_nodes(facet);
        if !ring.iter().any(|node| sides.contains_key(node)) {
            continue;
        }
        let normal = mesh.facet_geometry(facet).normal();
        let normal = normal - axis * axis.dot(&normal);
        let at = |index: usize| mesh.positions()[ring[index % ring.len()] as usize];
        for (index, node) in ring.iter().enumerate() {
            if let Some(side) = sides.get_mut(node) {
                let [before, after] = [ring.len() - 1, 1].map(|next| at(index + next) - at(index));
                *side += normal * before.angle(&after);
            }
        }
    }
    sides
}

/// The partner of each node among coincident candidates: the one at which the body lies most nearly on the same side.
fn on_the_same_side(
    mesh: &Mesh,
    from: &[u32],
    to: &[u32],
    (translation, tolerance): (Vec3, f64),
) -> Vec<u32> {
    let position = |node: u32| mesh.positions()[node as usize];
    let sides = sides(mesh, translation, from.iter().chain(to).copied());
    let side = |node: u32| sides[&node];
    let along = translation.iamin();
    let mut sorted: Vec<u32> = to.to_vec();
    sorted.sort_by(|&a, &b| position(a)[along].total_cmp(&position(b)[along]));
    let partner = |&node: &u32| {
        let target = position(node) + translation;
        let reach = 2.0 * tolerance + f64::EPSILON * target.amax();
        let first = sorted.partition_point(|&n| position(n)[along] < target[along] - reach);
        let near = sorted[first..]
            .iter()
            .copied()
            .take_while(|&n| position(n)[along] <= target[along] + reach)
            .filter(|&n| (position(n) - target).norm() <= reach);
        let difference = |n: u32| (side(n) - side(node)).norm();
        near.min_by(|&a, &b| difference(a).total_cmp(&difference(b)))
            .unwrap_or(node)
    };
    from.iter().map(partner).collect()
}
