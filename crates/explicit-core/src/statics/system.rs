//! The static equilibrium equations of a model in the displacements of its free nodes.

use powerhouse_model::{ElementBlock, Mat3, Operator, Quad, StaticError, StaticMethod, Vec3};
use rayon::prelude::*;

use super::Increment;
#[cfg(feature = "direct")]
use super::freedoms::DegreesOfFreedom;
use super::joints::Smooth;
use super::sliding::Sliding;
use crate::Model;
use crate::model::ElementAt;
use crate::node_group::NodeGroup;
use crate::node_ranges::NodeSums;
use crate::nodes::{Storage, with_nodes};
use crate::ranks::ABSENT;
use crate::subdomain::Subdomain;

/// The static equilibrium equations of a model, with the inverse nodal diagonals of its elastic operator.
///
/// Vectors have an entry per node, by local node. In a reduced vector the entry of a group's lead node
/// holds the free components of the group, and the entries of the other members are zero.
pub(super) struct System<'a> {
    model: &'a mut Model,
    /// The model's groups, with groups connected by ties and closed joints merged.
    groups: Vec<NodeGroup>,
    /// Closed pairs without friction, while joints are merged.
    sliding: Sliding,
    smooth: Smooth,
    /// Nodal 3 x 3 diagonals of the elastic operator (N/m).
    diagonal: Vec<Mat3>,
    /// Inverses of the diagonals, zero at fixed nodes (m/N).
    inverse: Vec<Mat3>,
    linear: bool,
}

impl<'a> System<'a> {
    /// The equations of a model, whose velocities are set to zero.
    pub(super) fn new(model: &'a mut Model, smooth: Smooth) -> Result<Self, StaticError> {
        model.groups.motion.invalidate();
        with_nodes!(&mut model.nodes, arrays => arrays.velocity.fill(Quad::default()));
        let of_blocks = model.blocks.par_iter().enumerate().map(|(index, block)| {
            let mut own = vec![Mat3::zeros(); model.subdomain.nodes_of(index).len()];
            block.diagonal(Operator::Static, &mut own);
            own
        });
        let of_blocks: Vec<Vec<Mat3>> = of_blocks.collect();
        let checked = refuse_without_stiffness(model, &of_blocks);
        model.agreed(checked)?;
        let diagonal = model.assembled_matrices(&of_blocks);
        let linear = model.blocks.iter().all(|block| block.history().is_empty());
        let linear = model.on_all_ranks(linear);
        let mut system = Self {
            model,
            groups: Vec::new(),
            sliding: Sliding::default(),
            smooth,
            diagonal,
            inverse: Vec::new(),
            linear,
        };
        system.merge_joints()?;
        Ok(system)
    }

    /// Treats closed pairs of joints and ties as one node each.
    pub(super) fn merge_joints(&mut self) -> Result<(), StaticError> {
        let groups = self.model.agreed(self.model.merged_groups(self.smooth))?;
        let regrouped = self.regroup(groups);
        self.model.agreed(regrouped)?;
        if self.smooth == Smooth::Sliding {
            self.sliding = Sliding::new(&self.model.smooth_pairs(), &self.groups);
        }
        Ok(())
    }

    /// Treats the nodes of all pairs of constraints as separate.
    pub(super) fn separate_joints(&mut self) -> Result<(), StaticError> {
        self.sliding = Sliding::default();
        let regrouped = self.regroup(self.model.groups.groups.clone());
        self.model.agreed(regrouped)
    }

    fn regroup(&mut self, groups: Vec<NodeGroup>) -> Result<(), StaticError> {
        let model = &*self.model;
        let mut diagonal = self.diagonal.clone();
        let mut group_of = vec![None; model.mass.len()];
        for group in &groups {
            let members = group.members.iter();
            let sum: Mat3 = members.map(|&node| diagonal[node as usize]).sum();
            for &node in &group.members {
                diagonal[node as usize] = Mat3::zeros();
                group_of[node as usize] = Some(group);
            }
            diagonal[group.members[0] as usize] = sum + group.spring;
        }
        let mut inverse = Vec::with_capacity(diagonal.len());
        for (node, diagonal) in diagonal.iter().enumerate() {
            let group = group_of[node];
            if group.is_some_and(|group| group.members[0] as usize != node) {
                inverse.push(Mat3::zeros());
                continue;
            }
            let massless = match group {
                Some(group) => group.mass == 0.0,
                None => model.mass[node] == 0.0,
            };
            if massless {
                inverse.push(Mat3::zeros());
                continue;
            }
            let found = diagonal.try_inverse();
            let found = found.ok_or_else(|| StaticError::NoStiffness {
                node: model.node_tag(node),
                set: model.element_at(node).set,
            })?;
            inverse.push(match group {
                Some(group) => group.condition.project(&found).0,
                None => found,
            });
        }
        self.groups = groups;
        self.inverse = inverse;
        Ok(())
    }

    /// Whether all laws are linear, so that one correction suffices.
    pub(super) fn is_linear(&self) -> bool {
        self.linear
    }

    /// Displacement (m) of every node.
    pub(super) fn displacement(&self) -> Vec<Vec3> {
        self.model.displacements()
    }

    /// Applied forces at the present time less the forces of the initial stress, with the norms of both.
    pub(super) fn external(&mut self) -> External {
        let model = &mut *self.model;
        let mut forces = vec![Vec3::zeros(); model.mass.len()];
        model.loads.add_all(model.time, &mut forces);
        let mut initial = model.forces_of_initial_stress();
        let borne = self.norm(&forces).max(self.norm(&initial));
        self.reduce(&mut forces);
        self.reduce(&mut initial);
        let size = self.norm(&forces).max(self.norm(&initial));
        (forces.par_iter_mut().zip(&initial)).for_each(|(force, initial)| *force -= initial);
        External {
            forces,
            size,
            borne,
        }
    }

    /// Norm of the last internal forces (N) of all nodes, held ones included.
    pub(super) fn internal(&self) -> f64 {
        self.norm(&self.model.internal_forces())
    }

    /// The nodes of groups with a prescribed motion, and their remaining prescribed displacement (m).
    pub(super) fn prescribed_change(&self, u: &[Vec3]) -> Vec<(usize, Vec3)> {
        let motions = self.model.prescribed_values();
        let is_prescribed = |group: &&NodeGroup| !group.condition.prescribed.is_empty();
        let change = |group: &NodeGroup| {
            let lead = group.members[0] as usize;
            let rest: Vec<f64> = (group.condition.prescribed.iter())
                .map(|&(direction, motion)| motions[motion] - direction.dot(&u[lead]))
                .collect();
            let along = group.condition.along(&rest);
            let members = group.members.iter();
            members
                .map(|&node| (node as usize, along))
                .collect::<Vec<_>>()
        };
        let groups = self.groups.iter().filter(is_prescribed);
        groups.flat_map(change).collect()
    }

    /// Fails if the cancellation flag of any rank is set.
    pub(super) fn check_stop(&self) -> Result<(), StaticError> {
        let goes_on = self.model.on_all_ranks(!self.model.is_stopped());
        self.model.ranks.team.check()?;
        if goes_on {
            Ok(())
        } else {
            Err(StaticError::Interrupted)
        }
    }

    /// Computes the internal forces and trial history variables of a displacement (m).
    pub(super) fn forces(&mut self, u: &[Vec3]) -> Result<(), StaticError> {
        self.check_stop()?;
        with_nodes!(&mut self.model.nodes, arrays => put(&mut arrays.displacement, u));
        self.model.compute_static_forces(0.0)
    }

    /// Unbalanced forces (N): applied forces less the last internal forces and the forces of springs, reduced.
    pub(super) fn residual(&self, applied: &[Vec3], u: &[Vec3]) -> Vec<Vec3> {
        let model = &*self.model;
        let mut internal = model.internal_forces();
        for (group, origin) in model.groups.groups.iter().zip(&model.groups.origin) {
            let lead = group.members[0] as usize;
            internal[lead] += group.spring * (u[lead] - origin);
        }
        let mut rest = internal;
        (rest.par_iter_mut().zip(applied)).for_each(|(r, f)| *r = f - *r);
        self.reduce(&mut rest);
        rest
    }

    /// Product of the elastic operator, springs included, with a reduced vector.
    pub(super) fn product(&mut self, vector: &[Vec3]) -> Vec<Vec3> {
        let mut spread = vector.to_vec();
        self.spread(&mut spread);
        let mut product = self
            .model
            .elastic_product(Operator::Static, &spread, &|_| 1.0);
        for group in &self.groups {
            let lead = group.members[0] as usize;
            product[lead] += group.spring * vector[lead];
        }
        self.reduce(&mut product);
        product
    }

    /// Product of the inverse nodal diagonals with a reduced vector.
    pub(super) fn precondition(&self, vector: &[Vec3]) -> Vec<Vec3> {
        let pairs = self.inverse.par_iter().zip(vector);
        let mut product: Vec<Vec3> = pairs.map(|(inverse, x)| inverse * x).collect();
        self.sliding.project(&mut product);
        product
    }

    /// Copies the entry of each group's lead node to the other members.
    pub(super) fn spread(&self, vector: &mut [Vec3]) {
        for group in &self.groups {
            for &member in &group.members[1..] {
                vector[member as usize] = vector[group.members[0] as usize];
            }
        }
    }

    /// Reduces a vector: sums the members of each group into its lead node, restricts the sum to the free directions
    /// and to those in which pairs without friction slide, and sets the entries of orphan nodes to zero.
    fn reduce(&self, vector: &mut [Vec3]) {
        for &orphan in &self.model.subdomain.orphans {
            vector[orphan as usize] = Vec3::zeros();
        }
        for group in &self.groups {
            let members = group.members.iter();
            let sum: Vec3 = members.map(|&member| vector[member as usize]).sum();
            for &member in &group.members[1..] {
                vector[member as usize] = Vec3::zeros();
            }
            vector[group.members[0] as usize] = group.condition.free(sum);
        }
        self.sliding.project(vector);
    }

    /// Sums over the nodes.
    pub(super) fn sums(&self) -> NodeSums<'_> {
        self.model.node_sums()
    }

    /// The inner product of two vectors.
    pub(super) fn dot(&self, a: &[Vec3], b: &[Vec3]) -> f64 {
        self.sums().dot(a, b)
    }

    /// The Euclidean norm of a vector.
    pub(super) fn norm(&self, a: &[Vec3]) -> f64 {
        self.sums().norm(a)
    }

    /// Number of nodes of all ranks.
    pub(super) fn node_count_of_all(&self) -> usize {
        self.model.subdomain.numbering.local_of.len()
    }

    /// Number of nodes.
    pub(super) fn node_count(&self) -> usize {
        self.inverse.len()
    }

    /// Rows of matrices at the nodes of this rank (local numbers), block by block in the global order of the blocks, from
    /// those of its own blocks: those of other ranks are at nodes that it shares with them.
    pub(super) fn rows_of_all(
        &self,
        own: Vec<Vec<(u32, Vec3)>>,
    ) -> Result<Vec<Vec<(u32, Vec3)>>, StaticError> {
        let ranks = &self.model.ranks;
        if ranks.is_single() {
            return Ok(own);
        }
        let mut shared = vec![false; self.model.mass.len()];
        for slot in ranks.exchange.sent_slots() {
            shared[self.model.subdomain.node_of_slot(slot) as usize] = true;
        }
        type Rows = Vec<(u32, Vec3)>;
        let numbered = ranks.block_numbers.iter().copied().zip(own);
        let mut all: Vec<(u32, Rows)> = numbered.collect();
        let at_border = all.iter().map(|(number, rows)| {
            let rows = rows.iter().filter(|(node, _)| shared[*node as usize]);
            let engine = |&(node, row): &(u32, Vec3)| (ranks.engine(node as usize) as u32, row);
            (*number, rows.map(engine).collect())
        });
        let sent: Vec<(u32, Rows)> = at_border.collect();
        let received = ranks.team.all(&sent).map_err(|error| StaticError::OnRank {
            rank: ranks.team.rank(),
            message: error.to_string(),
        })?;
        for (rank, received) in received.into_iter().enumerate() {
            if rank == ranks.team.rank() {
                continue;
            }
            all.extend(received.into_iter().map(|(number, rows)| {
                let local = |(node, row): (u32, Vec3)| (ranks.local(node), row);
                let here = rows
                    .into_iter()
                    .map(local)
                    .filter(|(node, _)| *node != ABSENT);
                (number, here.collect())
            }));
        }
        all.sort_by_key(|(number, _)| *number);
        Ok(all.into_iter().map(|(_, rows)| rows).collect())
    }

    /// The least positive number of any rank.
    pub(super) fn least_of_all(&self, number: f64) -> f64 {
        self.model.ranks.team.least_of(number)
    }

    /// The model.
    pub(super) fn model(&mut self) -> &mut Model {
        self.model
    }

    /// Commits the history variables of the last forces.
    pub(super) fn commit(&mut self) {
        let blocks = &mut self.model.blocks;
        blocks.par_iter_mut().for_each(|block| block.commit());
    }

    /// Sets the model's displacement (m), and its velocities to zero.
    pub(super) fn finish(&mut self, u: &[Vec3]) {
        with_nodes!(&mut self.model.nodes, arrays => {
            put(&mut arrays.displacement, u);
            arrays.velocity.fill(Quad::default());
        });
    }

    /// Positions of nodes (m); additional nodes of boundaries, whose position is not known, count at the centre of the
    /// mesh.
    #[cfg(feature = "direct")]
    pub(super) fn positions(&self) -> Vec<Vec3> {
        let mesh = &self.model.mesh;
        let (low, high) = mesh.bounding_box();
        let middle = 0.5 * (low + high);
        let of = |&node: &u32| mesh.positions().get(node as usize).copied();
        let nodes = self.model.subdomain.numbering.mesh_of.iter();
        nodes.map(|node| of(node).unwrap_or(middle)).collect()
    }

    /// The element blocks, with the local numbers of their nodes.
    pub(super) fn blocks(&self) -> Blocks<'_> {
        Blocks {
            subdomain: &self.model.subdomain,
            blocks: &self.model.blocks,
        }
    }

    /// The node groups in use.
    pub(super) fn groups(&self) -> &[NodeGroup] {
        &self.groups
    }

    /// The unknown displacements.
    #[cfg(feature = "direct")]
    pub(super) fn freedoms(&self) -> DegreesOfFreedom {
        let moves = |node: usize| self.inverse[node] != Mat3::zeros();
        DegreesOfFreedom::new(&self.groups, moves, self.inverse.len())
    }

    /// The error of a factorisation that failed at a node.
    #[cfg(feature = "direct")]
    pub(super) fn not_definite(&self, node: u32) -> StaticError {
        let ElementAt { element, set, .. } = self.model.element_at(node as usize);
        StaticError::NotDefinite {
            node: self.model.node_tag(node as usize),
            element,
            set,
        }
    }

    /// The error of an increment that did not converge, with the node of the largest unbalanced force.
    pub(super) fn not_converged(
        &self,
        residual: &[Vec3],
        relative: f64,
        increment: &Increment,
    ) -> StaticError {
        let (node, ElementAt { element, set, .. }) = self.model.largest_at(residual);
        StaticError::NotConverged {
            residual: relative,
            share: increment.share,
            node,
            element,
            set,
            advice: match increment.options.method {
                StaticMethod::DynamicRelaxation => {
                    "more steps may converge, if a static equilibrium exists"
                }
                _ => "the method dynamic relaxation may converge where much of the body yields",
            },
        }
    }
}

/// Forces on a body from outside, and of its initial stress.
pub(super) struct External {
    /// Applied forces less those of the initial stress (N), reduced.
    pub(super) forces: Vec<Vec3>,
    /// The larger of the norms of the two (N), each reduced.
    pub(super) size: f64,
    /// The same of all nodes before the reduction: those that are held, or move with others, bear their part.
    pub(super) borne: f64,
}

/// Element blocks with the local numbers of their nodes; shared among threads.
#[derive(Clone, Copy)]
pub(super) struct Blocks<'a> {
    subdomain: &'a Subdomain,
    blocks: &'a [Box<dyn ElementBlock>],
}

impl Blocks<'_> {
    /// Number of blocks.
    pub(super) fn count(self) -> usize {
        self.blocks.len()
    }

    /// Calls a function with every element stiffness matrix of an operator of a block: local numbers of its nodes, and
    /// its entries (N/m), row by row.
    pub(super) fn each_matrix(
        self,
        block: usize,
        operator: Operator,
        mut visit: impl FnMut(&[u32], &[f64]),
    ) {
        let of_block = self.subdomain.nodes_of(block);
        let mut nodes = Vec::new();
        self.blocks[block].each_matrix(operator, &mut |own, matrix| {
            nodes.clear();
            nodes.extend(own.iter().map(|&own| of_block[own as usize]));
            visit(&nodes, matrix);
        });
    }
}

/// Refuses sets whose elements give a node less stiffness than the rounding of the stiffest.
fn refuse_without_stiffness(model: &Model, of_blocks: &[Vec<Mat3>]) -> Result<(), StaticError> {
    let all = of_blocks.iter().flatten().map(Mat3::trace);
    let most = model.ranks.team.most_of(all.fold(0.0, f64::max));
    for (index, (block, own)) in model.blocks.iter().zip(of_blocks).enumerate() {
        if block.elements().is_empty() {
            continue;
        }
        // NaN counts as no stiffness. Orphan nodes need none.
        let without = |(node, own): &(&u32, &Mat3)| {
            let stiff = own.trace() > f64::EPSILON * most;
            model.mass[**node as usize] > 0.0 && !stiff
        };
        let mut nodes = model.subdomain.nodes_of(index).iter().zip(own);
        if let Some((&node, _)) = nodes.find(without) {
            return Err(StaticError::NoStiffness {
                node: model.node_tag(node as usize),
                set: block.label().into(),
            });
        }
    }
    Ok(())
}

fn put<S: Storage>(to: &mut [Quad<S>], from: &[Vec3]) {
    (to.par_iter_mut().zip(from)).for_each(|(to, from)| *to = Quad::from_vector(from));
}
