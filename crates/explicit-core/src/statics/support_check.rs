//! Check for unrestrained rigid body motion.

use nalgebra::{Matrix3x6, Matrix6, Vector6};
use powerhouse_model::{DisjointSets, Mat3, StaticError, Vec3};

use super::joints::ConnectedPairs;
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
    pub(super) fn check_static(&self, connected: ConnectedPairs) -> Result<(), StaticError> {
        self.check_joints(connected)?;
        let count = self.mesh.node_count();
        let mut parts = DisjointSets::new(count);
        for block in &self.blocks {
            for &element in block.elements() {
                if (element as usize) < self.mesh.element_count() {
                    let nodes = self.mesh.nodes_of(element);
                    nodes.iter().for_each(|&node| parts.join(nodes[0], node));
                }
            }
        }
        self.each_connected_pair(connected, |a, b| parts.join(a, b));
        let of_mesh = |engine: u32| self.subdomain.numbering.mesh_of[engine as usize];
        let known = |node: u32| (node as usize) < count;
        for group in &self.groups.groups {
            let lead = of_mesh(group.members[0]);
            for &member in &group.members {
                let member = of_mesh(member);
                if known(lead) && known(member) {
                    parts.join(lead, member);
                }
            }
        }

        let (low, high) = self.mesh.bounding_box();
        let (middle, size) = (
            0.5 * (low + high),
            (high - low).amax().max(f64::MIN_POSITIVE),
        );
        let position = |node: u32| (self.mesh.positions()[node as usize] - middle) / size;
        let mut resistance = std::collections::BTreeMap::<u32, Matrix6<f64>>::new();
        for group in &self.groups.groups {
            let lead = of_mesh(group.members[0]);
            if !known(lead) {
                continue;
            }
            let own = rigid(&position(lead));
            let sum = resistance.entry(parts.root(lead)).or_default();
            for direction in group.condition.directions() {
                let row = direction.transpose() * own;
                *sum += row.transpose() * row;
            }
            let stiffness = group.spring.amax();
            if stiffness > 0.0 {
                *sum += own.transpose() * (group.spring / stiffness) * own;
            }
            for &member in &group.members[1..] {
                let member = of_mesh(member);
                if known(member) {
                    let relative = rigid(&position(member)) - own;
                    *sum += relative.transpose() * relative;
                }
            }
        }

        let mut first_of = std::collections::BTreeMap::<u32, (u32, usize)>::new();
        for element in 0..self.mesh.element_count() as u32 {
            let (block, _) = self.subdomain.block_of_element[element as usize];
            if block as usize >= self.blocks.len() {
                continue;
            }
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
            let (block, _) = self.subdomain.block_of_element[element as usize];
            let set = self.blocks.get(block as usize);
            return Err(StaticError::Floating {
                element: self.element_tag(element),
                set: set.map_or_else(String::new, |block| block.label().into()),
                elements,
                motion: motion(&eigen.eigenvectors.column(least).into_owned()),
            });
        }
        Ok(())
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
