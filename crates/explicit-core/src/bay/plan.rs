//! Bays of a model: check of their pairs, matrices, inertia.

use powerhouse_model::{
    Constraint, DelayedPairs, ElementBlock, EngineError, ForceTerms, Mat3, Mesh, Operator, Vec3,
};

use super::skew::Skew;
use super::{Bay, BayMotion, Copies};
use crate::delayed::{pairs_of_nodes, slowest};
use crate::node_group::NodeGroup;
use crate::subdomain::{Numbering, Subdomain};

/// Least share of the mass of a node that the slowness may leave, and that of a node of elements that are not linear: the less is left the more
/// iterations a step takes.
const LEAST_SHARE: f64 = 0.05;
const LEAST_SHARE_OF_LAWS: f64 = 0.19;

/// Refuses pairs that are not those of the two ends of a bay.
///
/// # Errors
/// [`EngineError::DelayedNode`] for a node in several pairs, or at an end of the bay in none; [`EngineError::DelayedPair`] for a pair that is not
/// along y, or of another distance than others; [`EngineError::DelayedWith`] for stiff elements.
pub(crate) fn check_bay(mesh: &Mesh, delayed: &DelayedPairs) -> Result<(), EngineError> {
    let (nodes, tags) = (mesh.positions(), mesh.node_tags());
    let count = pairs_of_nodes(mesh, delayed)?;
    let (low, high) = mesh.bounding_box();
    let length = high.y - low.y;
    for &(a, b) in &delayed.pairs {
        let [at_a, at_b] = [a, b].map(|node| nodes[node as usize]);
        let apart = at_b - at_a;
        let apart = apart * apart.y.signum();
        if (apart - Vec3::new(0.0, length, 0.0)).norm() > DelayedPairs::AT_END * length {
            return Err(EngineError::DelayedPair {
                first: tags[a as usize],
                second: tags[b as usize],
                expected: [0.0, length, 0.0],
            });
        }
    }
    for (node, position) in nodes.iter().enumerate() {
        let at_end = (position.y - low.y).min(high.y - position.y) <= DelayedPairs::AT_END * length;
        if count[node] != usize::from(at_end) {
            return Err(EngineError::DelayedNode {
                node: tags[node],
                count: count[node],
            });
        }
    }
    if !delayed.stiff.is_empty() {
        return Err(EngineError::DelayedWith {
            what: "elements in which P waves are faster than the motion along y".into(),
            way: "take a smaller incidence, or an azimuth nearer to x",
        });
    }
    Ok(())
}

/// Refuses constraints that cannot correct a step several times from the same state.
///
/// # Errors
/// [`EngineError::DelayedWith`] for one that has a state without joints.
pub(crate) fn check_constraints(constraints: &[Box<dyn Constraint>]) -> Result<(), EngineError> {
    for constraint in constraints {
        if constraint.saved().is_some() && constraint.jointed().is_none() {
            let name = constraint.name();
            return Err(EngineError::DelayedWith {
                what: format!("constraint '{name}', which has a state without joints"),
                way: "give it `Constraint::jointed`, whose state is kept and taken back",
            });
        }
    }
    Ok(())
}

/// What a bay has before its groups are known.
pub(crate) struct BayPlan {
    slowness: f64,
    /// Distance along y of each engine node from the middle of its element (m).
    offset: Vec<f64>,
    /// `s^2 A` of each engine node along each axis (kg).
    pub(crate) lost: Vec<Vec3>,
}

impl BayPlan {
    /// From the elements of a model and the lumped masses (kg) of its engine nodes, each of which has one element.
    pub(crate) fn new(
        copies: &Copies,
        slowness: f64,
        numbering: &Numbering,
        (blocks, nodes_of_blocks): (&[Box<dyn ElementBlock>], &[Vec<u32>]),
        mass: &[f64],
    ) -> Self {
        let positions = copies.mesh.positions();
        let offset = |&node: &u32| {
            let element = copies.element_of.get(node as usize).copied();
            let Some(element) = element.filter(|element| *element != u32::MAX) else {
                return 0.0;
            };
            let own = copies.mesh.nodes_of(element);
            let sum: f64 = own.iter().map(|node| positions[*node as usize].y).sum();
            positions[node as usize].y - sum / own.len() as f64
        };
        let offset: Vec<f64> = numbering.mesh_of.iter().map(offset).collect();
        let mut lost = vec![Vec3::zeros(); offset.len()];
        for (block, nodes) in blocks.iter().zip(nodes_of_blocks) {
            block.each_matrix(Operator::Elastic, &mut |local, matrix| {
                let own: Vec<usize> = local.iter().map(|n| nodes[*n as usize] as usize).collect();
                let mut whole = Vec3::zeros();
                for_pairs(matrix, own.len(), |i, j, block| {
                    whole += block.diagonal() * (offset[own[i]] * offset[own[j]]);
                });
                let of_element: f64 = own.iter().map(|node| mass[*node]).sum();
                if whole == Vec3::zeros() {
                    // An embedded element.
                    return;
                }
                for &node in &own {
                    lost[node] += whole * (slowness * slowness * mass[node] / of_element);
                }
            });
        }
        Self {
            slowness,
            offset,
            lost,
        }
    }

    /// The bay of groups, whose inertia is reduced.
    pub(crate) fn finish(
        self,
        mesh: &Mesh,
        (groups, group_of): (&mut [NodeGroup], &[Option<u32>]),
        (copies, subdomain): (&Copies, &Subdomain),
        blocks: &[Box<dyn ElementBlock>],
    ) -> Result<Bay, EngineError> {
        let numbering = &subdomain.numbering;
        let original = |node: u32| {
            let of_mesh = copies.originals()[numbering.mesh_of[node as usize] as usize];
            numbering.local_of[of_mesh as usize]
        };
        let mut is_linear = true;
        let mut least_of = vec![LEAST_SHARE; subdomain.node_count()];
        for (index, block) in blocks.iter().enumerate() {
            let nodes = subdomain.nodes_of(index);
            if nodes
                .iter()
                .all(|node| self.lost[*node as usize] == Vec3::zeros())
            {
                // Embedded elements have no delay.
                continue;
            }
            let stiffness = block.stiffness();
            if !stiffness.is_some_and(|stiffness| stiffness.is_linear_elastic()) {
                is_linear = false;
                for &node in nodes {
                    least_of[node as usize] = LEAST_SHARE_OF_LAWS;
                }
            }
        }
        let (mut leads, mut taken) = (Vec::new(), Vec::new());
        let mut place = vec![(0, 0.0); subdomain.node_count()];
        for (index, group) in (0..).zip(groups.iter_mut()) {
            for &node in &group.members {
                place[node as usize] = (index, self.offset[node as usize]);
            }
            let own = group.members.iter();
            let of_group: f64 = own.map(|node| self.lost[*node as usize].max()).sum();
            let lead = original(group.members[0]);
            let share = 1.0 - of_group / group.mass;
            let least = group.members.iter().map(|node| least_of[*node as usize]);
            let least = least.fold(LEAST_SHARE, f64::max);
            if group.mass > 0.0 && (share.is_nan() || share < least) {
                return Err(EngineError::DelayedMass {
                    node: mesh.node_tags()[numbering.mesh_of[lead as usize] as usize],
                    slowness: self.slowness,
                    share,
                    least,
                    most: slowest(self.slowness, share, least),
                });
            }
            // The axes along which less is lost have the rest as a mass of their own.
            group.mass -= of_group;
            leads.push(lead);
            taken.push(of_group);
        }
        let skew = self.skew(groups, group_of, (subdomain, blocks));
        Ok(Bay {
            mesh: copies.mesh.clone(),
            slowness: self.slowness,
            leads,
            place,
            skew,
            inertia: (None, Vec::new()),
            taken,
            is_linear,
            motion: BayMotion::default(),
            solution: super::Solution::default(),
            terms: ForceTerms::PLAIN,
        })
    }

    /// The matrix `D` of all elements and of the coupling of boundaries.
    fn skew(
        &self,
        groups: &[NodeGroup],
        group_of: &[Option<u32>],
        (subdomain, blocks): (&Subdomain, &[Box<dyn ElementBlock>]),
    ) -> Skew {
        let mut elements = Vec::new();
        let each = |visit: &mut VisitElement| {
            for (index, block) in blocks.iter().enumerate() {
                let nodes = subdomain.nodes_of(index);
                block.each_matrix(Operator::Elastic, &mut |local, matrix| {
                    let own: Vec<u32> = local.iter().map(|n| nodes[*n as usize]).collect();
                    let groups = own.iter().filter_map(|node| group_of[*node as usize]);
                    visit(groups.collect(), &own, matrix);
                });
            }
        };
        each(&mut |groups, _, _| elements.push(groups));
        Skew::new(groups.len(), &elements, |add| {
            each(&mut |groups, nodes, matrix| {
                for_pairs(matrix, nodes.len(), |i, j, block| {
                    let [a, b] = [i, j].map(|k| self.offset[nodes[k] as usize]);
                    add([groups[i], groups[j]], &(block * (self.slowness * (a - b))));
                });
            });
            for (index, group) in (0..).zip(groups) {
                if group.gyroscopic != Mat3::zeros() {
                    add([index, index], &group.gyroscopic);
                }
            }
        })
    }
}

/// What is done with an element: from the groups of its nodes, the nodes and its matrix.
type VisitElement<'v> = dyn FnMut(Vec<u32>, &[u32], &[f64]) + 'v;

/// Calls a function with the block of a matrix, three rows and columns per node, of each pair of nodes.
fn for_pairs(matrix: &[f64], nodes: usize, mut visit: impl FnMut(usize, usize, Mat3)) {
    let size = 3 * nodes;
    for i in 0..nodes {
        for j in 0..nodes {
            visit(
                i,
                j,
                Mat3::from_fn(|c, d| matrix[(3 * i + c) * size + 3 * j + d]),
            );
        }
    }
}
