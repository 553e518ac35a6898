//! A model as a system of equations in the displacements of its free nodes.

use powerhouse_model::{BlockContext, Mat3, Operator, Quad, Vec3};
use rayon::prelude::*;

use super::StaticError;
use crate::Model;
use crate::applied::split;
use crate::nodes::{Storage, with_nodes};

/// A model at rest, with the inverse nodal diagonals of its elastic operator.
///
/// Vectors have an entry per node, in the engine's numbering; of nodes that move as one only the
/// lead's counts, in the free directions, the others are zero.
pub(super) struct System<'a> {
    model: &'a mut Model,
    /// Inverse of the diagonal, zero where nothing is free (m/N).
    inverse: Vec<Mat3>,
    linear: bool,
}

impl<'a> System<'a> {
    /// The model brought to rest.
    pub(super) fn new(model: &'a mut Model) -> Result<Self, StaticError> {
        with_nodes!(&mut model.nodes, arrays => arrays.velocity.fill(Quad::default()));
        let mut diagonal = vec![Mat3::zeros(); model.mass.len()];
        for block in &model.blocks {
            let mut own = vec![Mat3::zeros(); block.nodes().len()];
            block.diagonal(Operator::Elastic, &mut own);
            for (&node, own) in block.nodes().iter().zip(own) {
                diagonal[node as usize] += own;
            }
        }
        for group in &model.groups.groups {
            let members = group.members.iter();
            let sum: Mat3 = members.map(|&node| diagonal[node as usize]).sum();
            for &node in &group.members {
                diagonal[node as usize] = Mat3::zeros();
            }
            diagonal[group.members[0] as usize] = sum + group.spring;
        }
        let mut inverse = Vec::with_capacity(diagonal.len());
        for (node, diagonal) in diagonal.iter().enumerate() {
            let group = model.group_of[node].map(|g| &model.groups.groups[g as usize]);
            if group.is_some_and(|group| group.members[0] as usize != node) {
                inverse.push(Mat3::zeros());
                continue;
            }
            let found = diagonal.try_inverse();
            let found = found.ok_or_else(|| StaticError::NoStiffness {
                node: model.node_tag(node),
            })?;
            inverse.push(match group {
                Some(group) => group.condition.project(&found).0,
                None => found,
            });
        }
        let linear = model.blocks.iter().all(|block| block.history().is_empty());
        Ok(Self {
            model,
            inverse,
            linear,
        })
    }

    /// Whether one correction suffices.
    pub(super) fn is_linear(&self) -> bool {
        self.linear
    }

    /// The displacement of every node (m).
    pub(super) fn displacement(&self) -> Vec<Vec3> {
        let nodes = 0..self.model.mass.len();
        nodes.map(|node| self.model.displacement_of(node)).collect()
    }

    /// The applied forces at the present time (N).
    pub(super) fn external(&mut self) -> Vec<Vec3> {
        let model = &mut *self.model;
        model.loads.evaluate(model.time);
        let mut sums = vec![Quad::<f64>::default(); model.mass.len()];
        model.loads.sums.write_plain(&mut sums);
        let mut forces: Vec<Vec3> = sums.iter().map(|sum| sum.to_vector()).collect();
        for (g, group) in model.groups.groups.iter().enumerate() {
            forces[group.members[0] as usize] = model.loads.sums.on_group(g);
        }
        model.reduce(&mut forces);
        forces
    }

    /// The leads of groups with a prescribed motion, and what they have yet to move (m).
    pub(super) fn prescribed_change(&self, u: &[Vec3]) -> Vec<(usize, Vec3)> {
        let model = &*self.model;
        let motions = model.prescribed_values();
        let change = |&g: &u32| {
            let group = &model.groups.groups[g as usize];
            let lead = group.members[0] as usize;
            let rest: Vec<f64> = (group.condition.prescribed.iter())
                .map(|&(direction, motion)| motions[motion] - direction.dot(&u[lead]))
                .collect();
            (lead, group.condition.along(&rest))
        };
        model.groups.driven.iter().map(change).collect()
    }

    /// Computes the internal forces of a displacement, and the history that goes with them.
    pub(super) fn forces(&mut self, u: &[Vec3]) -> Result<(), StaticError> {
        let model = &mut *self.model;
        let when = (model.number, model.time, 0.0);
        let (blocks, lengths) = (&mut model.blocks, &model.lengths);
        let fault = with_nodes!(&mut model.nodes, arrays => {
            put(&mut arrays.displacement, u);
            let context = BlockContext::new(
                when,
                Storage::view(&arrays.displacement),
                Storage::view(&arrays.velocity),
            );
            let buffers = split(&mut arrays.forces, lengths);
            blocks
                .par_iter_mut()
                .zip(buffers)
                .with_max_len(1)
                .find_map_first(|(block, buffer)| {
                    let fault = block.forces(&context, Storage::view_mut(buffer)).err()?;
                    Some((block.label().to_string(), fault))
                })
        });
        match fault {
            None => Ok(()),
            Some((set, fault)) => Err(StaticError::Element {
                element: model.element_tag(fault.element),
                set,
                reason: fault.reason,
            }),
        }
    }

    /// What of the applied forces the last internal forces and the springs do not balance (N).
    pub(super) fn residual(&self, applied: &[Vec3], u: &[Vec3]) -> Vec<Vec3> {
        let model = &*self.model;
        let slots = &model.slots;
        let mut internal: Vec<Vec3> = with_nodes!(&model.nodes, arrays => {
            (0..u.len())
                .into_par_iter()
                .map(|node| arrays.internal(slots, node))
                .collect()
        });
        for (group, origin) in model.groups.groups.iter().zip(&model.groups.origin) {
            let lead = group.members[0] as usize;
            let sum: Vec3 = group.members.iter().map(|&m| internal[m as usize]).sum();
            internal[lead] = sum + group.spring * (u[lead] - origin);
        }
        let mut rest: Vec<Vec3> = (applied.par_iter().zip(&internal))
            .map(|(f, r)| f - r)
            .collect();
        model.reduce(&mut rest);
        rest
    }

    /// The elastic operator, springs included, times a reduced vector.
    pub(super) fn product(&mut self, vector: &[Vec3]) -> Vec<Vec3> {
        let model = &mut *self.model;
        let mut spread = vector.to_vec();
        model.spread(&mut spread);
        let mut product = model.elastic_product(&spread, &|_| 1.0);
        for group in &model.groups.groups {
            let lead = group.members[0] as usize;
            let sum: Vec3 = group.members.iter().map(|&m| product[m as usize]).sum();
            product[lead] = sum + group.spring * vector[lead];
        }
        model.reduce(&mut product);
        product
    }

    /// The inverse nodal diagonals times a reduced vector.
    pub(super) fn precondition(&self, vector: &[Vec3]) -> Vec<Vec3> {
        let pairs = self.inverse.par_iter().zip(vector);
        pairs.map(|(inverse, x)| inverse * x).collect()
    }

    /// Gives the members of groups the entry of their lead.
    pub(super) fn spread(&self, vector: &mut [Vec3]) {
        self.model.spread(vector);
    }

    /// Makes the history of the last forces the committed one.
    pub(super) fn commit(&mut self) {
        let blocks = &mut self.model.blocks;
        blocks.par_iter_mut().for_each(|block| block.commit());
    }

    /// Leaves the model at rest with a displacement.
    pub(super) fn finish(&mut self, u: &[Vec3]) {
        with_nodes!(&mut self.model.nodes, arrays => {
            put(&mut arrays.displacement, u);
            arrays.velocity.fill(Quad::default());
        });
    }

    /// Says where most is out of balance.
    pub(super) fn not_converged(
        &self,
        residual: &[Vec3],
        relative: f64,
        share: f64,
    ) -> StaticError {
        let mut worst = (0, -1.0);
        for (node, rest) in residual.iter().enumerate() {
            let size = rest.norm();
            // The first node that is not finite counts most.
            if size > worst.1 || (!size.is_finite() && worst.1.is_finite()) {
                worst = (node, size);
            }
        }
        let (element, set) = self.model.element_at(worst.0);
        StaticError::NotConverged {
            residual: relative,
            share,
            node: self.model.node_tag(worst.0),
            element,
            set,
        }
    }
}

fn put<S: Storage>(to: &mut [Quad<S>], from: &[Vec3]) {
    (to.par_iter_mut().zip(from)).for_each(|(to, from)| *to = Quad::from_vector(from));
}
