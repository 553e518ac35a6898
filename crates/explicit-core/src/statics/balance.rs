//! Forces that balance a body in static equilibrium, and the transition to a dynamic stage.

use powerhouse_model::{
    DisjointSets, HandOverReport, JointView, Quad, StaticError, StepTime, Vec3,
};
use rayon::prelude::*;

use crate::Model;
use crate::model::{BlockTerms, block_forces};
use crate::nodes::with_nodes;
use crate::ranks::Ranked;
use crate::subdomain::NodalMotion;

/// Length of step (s) at which the stress in motion is compared with the static one: that of a viscoelastic law differs.
const SOME_STEP: f64 = 1.0e-3;
/// Relative difference of internal forces between two lengths of step that counts as rounding.
const SAME: f64 = 1.0e-6;

impl Model {
    /// Begins a dynamic stage from the static state that the model [started](powerhouse_model::ModelSpec::start) with; without
    /// input the body stays at rest.
    ///
    /// Velocities are set to zero. Springs and blocks of boundaries, and the displacement that observers receive, refer
    /// to the present displacement. The difference between the internal forces of this model and its loads is stored
    /// as carried forces: reactions of former supports, forces of the initial stress,
    /// and the residual of the static solution. Loads of absorbing boundaries count as input and are not included.
    ///
    /// # Errors
    /// [`StaticError::CarriedForcesChanged`] if the carried forces differ from those of the stage before by more than
    /// `tolerance` (0 to 1) times the internal forces: a load, an element or a bolt is missing or
    /// new; with 1 nothing is compared, as where elements take another material. [`StaticError::StressChanges`] if a law
    /// would relax the static stress.
    pub fn hand_over(&mut self, tolerance: f64) -> Result<HandOverReport, StaticError> {
        powerhouse_model::ParameterError::check("tolerance", tolerance, 0.0, 1.0)?;
        self.in_pool(|model| {
            model.complete_kick();
            model.commit();
            model.groups.motion.invalidate();
            with_nodes!(&mut model.nodes, arrays => arrays.velocity.fill(Quad::default()));
            model.begin_stage();
            let refused = model.refuse_changed_stress()?;
            model.agreed(refused)?;
            let mut before = model.loads.carried().to_vec();
            before.resize(model.mass.len(), Vec3::zeros());
            let (carried, scale) = model.balancing_forces(Loads::Own, Some(&before))?;
            let mut change: Vec<Vec3> = (carried.iter().zip(&before))
                .map(|(now, before)| now - before)
                .collect();
            model.gather_members(&mut change);
            model.reduce(&mut change);
            let norm = |forces: &[Vec3]| model.node_sums().norm(forces);
            let scale = scale.max(norm(&before)).max(f64::MIN_POSITIVE);
            let report = HandOverReport {
                carried_forces: norm(&carried),
                difference: norm(&change) / scale,
            };
            // NaN counts as a difference too.
            let is_known = report.difference.is_finite();
            if !is_known || (tolerance < 1.0 && report.difference > tolerance) {
                let (node, _) = model.largest_at(&change);
                return Err(StaticError::CarriedForcesChanged {
                    difference: report.difference,
                    tolerance,
                    node,
                });
            }
            model.set_carried_forces(carried);
            Ok(report)
        })
    }

    /// Stores the forces that balance the model in addition to its loads as carried forces.
    pub(super) fn store_carried_forces(&mut self) -> Result<(), StaticError> {
        let (carried, _) = self.balancing_forces(Loads::All, None)?;
        self.set_carried_forces(carried);
        Ok(())
    }

    /// Forces (N, engine numbering) that balance the body in addition to the loads at the present time,
    /// and the norm of the internal forces.
    ///
    /// Each node of a joint has its own, less the force of the joint, which keeps its tractions. Nodes connected by ties share
    /// their common force equally; the tie transmits the difference.
    ///
    /// Of joints that are new, without tractions, as where a tie was removed, the nodes keep the forces of the stage `before`,
    /// and share equally what these lack: the joint then finds the traction of the tie.
    fn balancing_forces(
        &mut self,
        which: Loads,
        before: Option<&[Vec3]>,
    ) -> Result<(Vec<Vec3>, f64), StaticError> {
        self.compute_static_forces(0.0)?;
        let count = self.mass.len();
        let mut forces = self.internal_forces();
        let size = self.node_sums().norm(&forces);
        for (group, origin) in self.groups.groups.iter().zip(&self.groups.origin) {
            let lead = group.members[0] as usize;
            forces[lead] += group.spring * (self.displacement_of(lead) - origin);
        }
        let mut loads = vec![Vec3::zeros(); count];
        match which {
            Loads::All => self.loads.add_all(self.time, &mut loads),
            Loads::Own => self.loads.add_own(self.time, &mut loads),
        }
        for (force, load) in forces.iter_mut().zip(&loads) {
            *force -= load;
        }
        for bound in &self.constraints {
            let Some(jointed) = bound.constraint.jointed() else {
                continue;
            };
            let mut of_joints = vec![Vec3::zeros(); bound.nodes().len()];
            jointed.add_joint_forces(&mut of_joints);
            for (&node, of_joints) in bound.nodes().iter().zip(&of_joints) {
                forces[node as usize] -= of_joints;
            }
        }
        let initial = self.forces_of_initial_stress();
        let of_group = |values: &[Vec3], node: u32| -> Vec3 {
            let members = self.members(&node).iter();
            members.map(|&member| values[member as usize]).sum()
        };
        let new_pairs = before.map_or_else(Vec::new, |_| self.pairs_of_new_joints());
        for together in self.connected_sets(new_pairs) {
            let before = before.unwrap_or_default();
            let of_nodes = together.iter();
            let lacking: Vec3 = of_nodes
                .map(|&node| of_group(&forces, node) - of_group(before, node))
                .sum();
            for node in &together {
                for &member in self.members(node) {
                    forces[member as usize] = Vec3::zeros();
                }
                let share = lacking / together.len() as f64;
                forces[*node as usize] = of_group(before, *node) + share;
            }
        }
        let ties = self.constraints.iter();
        let ties = ties.flat_map(|bound| bound.constraint.ties()).collect();
        for together in self.connected_sets(ties) {
            let nodes = together.iter();
            let sum: Vec3 = nodes
                .map(|&node| of_group(&forces, node) + of_group(&initial, node))
                .sum();
            for node in &together {
                for &member in self.members(node) {
                    forces[member as usize] = Vec3::zeros();
                }
                let share = sum / together.len() as f64;
                forces[*node as usize] = share - of_group(&initial, *node);
            }
        }
        for &orphan in &self.subdomain.orphans {
            forces[orphan as usize] = Vec3::zeros();
        }
        Ok((forces, size))
    }

    /// Refuses, as the inner result of this rank, sets whose internal forces at zero velocity are not the static ones, as of
    /// a viscoelastic law.
    fn refuse_changed_stress(&mut self) -> Result<Result<(), StaticError>, StaticError> {
        let size = |forces: &[Vec3]| forces.iter().map(Vec3::norm_squared).sum::<f64>().sqrt();
        self.compute_static_forces(SOME_STEP)?;
        let moving = self.force_buffers();
        self.compute_static_forces(0.0)?;
        for ((block, moving), still) in self.blocks.iter().zip(moving).zip(self.force_buffers()) {
            let change: Vec<Vec3> = moving.iter().zip(&still).map(|(a, b)| a - b).collect();
            let (change, all) = (size(&change), size(&still));
            if change > SAME * all {
                return Ok(Err(StaticError::StressChanges {
                    set: block.label().into(),
                    difference: change / all,
                }));
            }
        }
        Ok(Ok(()))
    }

    /// The last forces (N) of each block.
    fn force_buffers(&self) -> Vec<Vec<Vec3>> {
        with_nodes!(&self.nodes, arrays => {
            let own = |block| {
                let forces = self.subdomain.forces_of(block, &arrays.forces).iter();
                forces.map(|force| force.to_vector()).collect()
            };
            (0..self.blocks.len()).map(own).collect()
        })
    }

    /// Computes the internal forces of all blocks at the present displacement with a length of step (s); zero selects the
    /// static form of the laws.
    pub(super) fn compute_static_forces(&mut self, step: f64) -> Result<(), StaticError> {
        let when = StepTime {
            number: self.number,
            time: self.time,
            step,
        };
        let (blocks, subdomain) = (&mut self.blocks, &self.subdomain);
        let fault = with_nodes!(&mut self.nodes, arrays => {
            let motion = NodalMotion {
                displacement: &arrays.displacement,
                velocity: &arrays.velocity,
            };
            let evaluation = BlockTerms::of_statics(when);
            block_forces(subdomain, blocks, motion, &mut arrays.forces, evaluation, None)
        });
        let mut order = 0;
        let computed = match fault {
            None => Ok(()),
            Some((set, fault)) => {
                let block = self.subdomain.block_of(fault.element);
                let number = block.and_then(|(block, _)| self.ranks.block_numbers.get(block));
                order = number.map_or(u64::MAX - 1, |&number| number.into());
                Err(StaticError::Element {
                    element: self.element_tag(fault.element),
                    set,
                    reason: fault.reason,
                })
            }
        };
        self.agreed_by(computed, order)?;
        let Ranked { exchange, team, .. } = &mut self.ranks;
        with_nodes!(&mut self.nodes, arrays => {
            exchange.swap(team, &mut arrays.forces);
        });
        Ok(self.ranks.team.check()?)
    }

    /// The last internal forces (N) by engine node.
    pub(super) fn internal_forces(&self) -> Vec<Vec3> {
        let (slots, count) = (&self.subdomain.slots, self.mass.len());
        with_nodes!(&self.nodes, arrays => {
            (0..count).into_par_iter().map(|node| arrays.internal(slots, node)).collect()
        })
    }

    /// Sums the entries of the members of each group into that of its lead node.
    pub(super) fn gather_members(&self, vector: &mut [Vec3]) {
        for group in &self.groups.groups {
            let sum: Vec3 = group.members.iter().map(|&m| vector[m as usize]).sum();
            vector[group.members[0] as usize] = sum;
        }
    }

    /// The engine nodes of the group of an engine node, itself included.
    pub(super) fn members<'a>(&'a self, node: &'a u32) -> &'a [u32] {
        let group = self.group_of[*node as usize].map(|g| &self.groups.groups[g as usize]);
        group.map_or(std::slice::from_ref(node), |group| &group.members)
    }

    /// Pairs (mesh indices) of joints none of whose pairs has a traction yet.
    fn pairs_of_new_joints(&self) -> Vec<[u32; 2]> {
        let is_new = |joint: &JointView| {
            let mut records = joint.records.iter();
            records.all(|record| record.traction == Vec3::zeros() && record.reference.is_none())
        };
        let joints = self.joints().filter(is_new);
        let pairs = joints.flat_map(|joint| joint.pairs);
        pairs.map(|pair| pair.nodes).collect()
    }

    /// Sets of engine nodes connected by pairs (mesh indices), each in rising order.
    fn connected_sets(&self, pairs: Vec<[u32; 2]>) -> Vec<Vec<u32>> {
        let pairs = pairs.into_iter();
        let pairs: Vec<[u32; 2]> = pairs
            .map(|pair| pair.map(|node| self.engine(node) as u32))
            .collect();
        let mut nodes: Vec<u32> = pairs.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let index = |node: u32| nodes.partition_point(|&other| other < node) as u32;
        let mut sets = DisjointSets::new(nodes.len());
        for [a, b] in pairs {
            sets.join(index(a), index(b));
        }
        let mut lists = std::collections::BTreeMap::<u32, Vec<u32>>::new();
        for (index, &node) in nodes.iter().enumerate() {
            let root = sets.root(index as u32);
            lists.entry(root).or_default().push(node);
        }
        lists.into_values().collect()
    }
}

/// Choice of the loads to be included.
#[derive(Clone, Copy, Debug)]
enum Loads {
    /// All loads.
    All,
    /// All loads but those of absorbing boundaries.
    Own,
}
