//! Check for unrestrained rigid body motion.

use nalgebra::{Matrix3x6, Matrix6, Vector6};
use powerhouse_model::{DisjointSets, Mat3, StaticError, Vec3};
use serde::{Deserialize, Serialize};

use crate::Model;

/// Share of the greatest resistance below which a rigid motion counts as unrestrained.
const FREE: f64 = 1.0e-10;

/// Displacement of a position by the six rigid motions, rotations in units of one over the size of the mesh.
fn rigid(position: &Vec3) -> Matrix3x6<f64> {
    let mut matrix = Matrix3x6::zeros();
    matrix
        .fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&Mat3::identity());
    let turn = -position.cross_matrix();
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&turn);
    matrix
}

impl Model {
    /// Refuses constraints without a static form, and connected parts with a rigid motion that supports, springs and ties
    /// do not restrain.
    pub(super) fn check_static(&self) -> Result<(), StaticError> {
        self.agreed(self.check_constraints())?;
        let count = self.mesh.node_count();
        let mut parts = DisjointSets::new(count);
        let partition = self.partition();
        for &element in partition.blocks.iter().flat_map(|block| &block.elements) {
            let nodes = self.mesh.nodes_of(element);
            nodes.iter().for_each(|&node| parts.join(nodes[0], node));
        }
        let restraints = self.restraints();
        let sent = self.ranks.team.all(&restraints);
        let restraints = sent.map_err(|error| StaticError::OnRank {
            rank: self.ranks.team.rank(),
            message: error.to_string(),
        })?;
        for &[a, b] in restraints.iter().flat_map(|of_rank| &of_rank.connected) {
            parts.join(a, b);
        }
        let mut resistances: Vec<&Resistance> = (restraints.iter())
            .flat_map(|of_rank| &of_rank.resistances)
            .collect();
        resistances.sort_by_key(|(engine, ..)| *engine);
        let mut resistance = std::collections::BTreeMap::<u32, Matrix6<f64>>::new();
        for (_, node, own) in resistances {
            *resistance.entry(parts.root(*node)).or_default() += own;
        }

        let mut first_of = std::collections::BTreeMap::<u32, (u32, usize)>::new();
        let mut active: Vec<u32> = (partition.blocks.iter())
            .flat_map(|block| block.elements.iter().copied())
            .collect();
        active.sort_unstable();
        for element in active {
            let root = parts.root(self.mesh.nodes_of(element)[0]);
            first_of.entry(root).or_insert((element, 0)).1 += 1;
        }
        for (root, (element, elements)) in first_of {
            let held = resistance.get(&root).copied().unwrap_or_default();
            let eigen = held.symmetric_eigen();
            let least = eigen.eigenvalues.imin();
            if eigen.eigenvalues[least] > FREE * eigen.eigenvalues.max() {
                continue;
            }
            return Err(StaticError::Floating {
                element: self.element_tag(element),
                set: self.set_of_all(element),
                elements,
                motion: motion(&eigen.eigenvectors.column(least).into_owned()),
            });
        }
        Ok(())
    }
}

/// Resistance of a group of nodes to the rigid motions: engine number and mesh index of its lead node, and the matrix.
type Resistance = (u32, u32, Matrix6<f64>);

/// What restrains the nodes of a rank.
#[derive(Serialize, Deserialize)]
struct Restraints {
    /// Nodes (mesh indices) that move together.
    connected: Vec<[u32; 2]>,
    resistances: Vec<Resistance>,
}

impl Model {
    /// Connections of the nodes of this rank, and the resistances of the groups that it owns.
    fn restraints(&self) -> Restraints {
        let count = self.mesh.node_count();
        let mut restraints = Restraints {
            connected: Vec::new(),
            resistances: Vec::new(),
        };
        self.each_connected_pair(|a, b| restraints.connected.push([a, b]));
        let (low, high) = self.mesh.bounding_box();
        let (middle, size) = (
            0.5 * (low + high),
            (high - low).amax().max(f64::MIN_POSITIVE),
        );
        let position = |node: u32| (self.mesh.positions()[node as usize] - middle) / size;
        let of_mesh = |local: u32| self.subdomain.numbering.mesh_of[local as usize];
        let known = |node: u32| (node as usize) < count;
        for group in &self.groups.groups {
            let first = group.members[0] as usize;
            let lead = of_mesh(group.members[0]);
            if !known(lead) || !self.subdomain.node_ranges.has(first) {
                continue;
            }
            let own = rigid(&position(lead));
            let mut sum = Matrix6::zeros();
            for direction in group.condition.directions() {
                let row = direction.transpose() * own;
                sum += row.transpose() * row;
            }
            let stiffness = group.spring.amax();
            if stiffness > 0.0 {
                sum += own.transpose() * (group.spring / stiffness) * own;
            }
            for &member in &group.members[1..] {
                let member = of_mesh(member);
                if known(member) {
                    restraints.connected.push([lead, member]);
                    let relative = rigid(&position(member)) - own;
                    sum += relative.transpose() * relative;
                }
            }
            let engine = self.ranks.engine(first) as u32;
            restraints.resistances.push((engine, lead, sum));
        }
        restraints
    }
}

/// Description of a rigid motion, as a translation or rotation.
fn motion(free: &Vector6<f64>) -> String {
    let (shift, turn) = (free.fixed_rows::<3>(0), free.fixed_rows::<3>(3));
    let (what, vector) = if turn.norm() > 1.0e-6 {
        ("rotate about", turn)
    } else {
        ("move along", shift)
    };
    let vector = vector.normalize();
    format!(
        "{what} ({:.3}, {:.3}, {:.3})",
        vector[0], vector[1], vector[2]
    )
}
