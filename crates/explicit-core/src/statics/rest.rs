//! What holds a body at rest, and the hand-over to a dynamic stage.

use powerhouse_model::{BlockContext, Quad, StepTime, Vec3};
use rayon::prelude::*;

use super::StaticError;
use crate::Model;
use crate::applied::split;
use crate::model::block_forces;
use crate::nodes::{Storage, with_nodes};
use crate::spectrum::norm;

/// What a dynamic stage started from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandOverReport {
    /// Norm of the forces (N) that hold the body beside its loads.
    pub standing: f64,
    /// By how much they differ from those that held it in the stage before, relative to its
    /// internal forces: the digits of another precision, no more.
    pub difference: f64,
}

/// A length of step (s) at which laws that relax differ from themselves at rest.
const SOME_STEP: f64 = 1.0e-3;
/// How much internal forces may depend on the length of the step.
const SAME: f64 = 1.0e-6;

impl Model {
    /// Makes the state that the model [started](crate::ModelBuilder::start) from the start of a
    /// dynamic stage: without input the body stays still.
    ///
    /// Velocities are zero, springs and blocks of boundaries are measured from the present
    /// displacement, and so is the displacement that observers see. What the internal forces, as
    /// the kernels and lanes of this model compute them, and the loads leave out of balance stays
    /// on as standing forces: reactions of supports that are gone, what the initial stress asks for,
    /// the residual under the gate of the static solution. Loads of boundaries count as input.
    ///
    /// # Errors
    /// [`StaticError::NotHeld`] if these forces are not those that held the body in the stage
    /// before, to `tolerance` of its internal forces: a load, an element or a bolt is missing or
    /// has come in. [`StaticError::Relaxes`] if a law would forget the static stress.
    pub fn hand_over(&mut self, tolerance: f64) -> Result<HandOverReport, StaticError> {
        powerhouse_model::ParameterError::check("tolerance", tolerance, 0.0, 1.0)?;
        self.in_pool(|model| {
            model.settle();
            model.commit();
            model.groups.motion.forget();
            with_nodes!(&mut model.nodes, arrays => arrays.velocity.fill(Quad::default()));
            model.begin_stage();
            model.refuse_relaxing()?;
            let mut before = model.loads.standing().to_vec();
            before.resize(model.mass.len(), Vec3::zeros());
            let (lacking, scale) = model.lacking(Loads::Own)?;
            let mut change: Vec<Vec3> = (lacking.iter().zip(&before))
                .map(|(now, before)| now - before)
                .collect();
            model.gather_members(&mut change);
            model.reduce(&mut change);
            let scale = scale.max(norm(&before)).max(f64::MIN_POSITIVE);
            let report = HandOverReport {
                standing: norm(&lacking),
                difference: norm(&change) / scale,
            };
            // A difference that is no number is one, too.
            if !report.difference.is_finite() || report.difference > tolerance {
                let sizes = change.iter().map(|force| force.norm());
                let worst = sizes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
                return Err(StaticError::NotHeld {
                    difference: report.difference,
                    tolerance,
                    node: model.node_tag(worst.map_or(0, |(node, _)| node)),
                });
            }
            model.set_standing(lacking);
            Ok(report)
        })
    }

    /// Lets what the model lacks to be at rest act from now on as standing forces.
    pub(super) fn hold(&mut self) -> Result<(), StaticError> {
        let (lacking, _) = self.lacking(Loads::All)?;
        self.set_standing(lacking);
        Ok(())
    }

    /// Forces (N, engine numbering) that would have to act beside the loads at the present time for
    /// the body to be at rest, and the norm of the internal forces.
    ///
    /// Nodes that a joint holds together share what they, and those tied to them, lack as a whole; the
    /// joint does the rest.
    fn lacking(&mut self, which: Loads) -> Result<(Vec<Vec3>, f64), StaticError> {
        self.forces_at_rest(0.0)?;
        let count = self.mass.len();
        let mut lacking = self.internal_forces();
        let size = norm(&lacking);
        for (group, origin) in self.groups.groups.iter().zip(&self.groups.origin) {
            let lead = group.members[0] as usize;
            lacking[lead] += group.spring * (self.displacement_of(lead) - origin);
        }
        let mut loads = vec![Vec3::zeros(); count];
        match which {
            Loads::All => self.loads.add_all(self.time, &mut loads),
            Loads::Own => self.loads.add_own(self.time, &mut loads),
        }
        for (lacking, load) in lacking.iter_mut().zip(&loads) {
            *lacking -= load;
        }
        let asked = self.forces_of_initial_stress();
        for together in self.joined_nodes() {
            let of_group = |values: &[Vec3], node: u32| -> Vec3 {
                let members = self.members(&node).iter();
                members.map(|&member| values[member as usize]).sum()
            };
            let nodes = together.iter();
            let sum: Vec3 = nodes
                .map(|&node| of_group(&lacking, node) + of_group(&asked, node))
                .sum();
            for node in &together {
                for &member in self.members(node) {
                    lacking[member as usize] = Vec3::zeros();
                }
                let share = sum / together.len() as f64;
                lacking[*node as usize] = share - of_group(&asked, *node);
            }
        }
        for &orphan in &self.orphans {
            lacking[orphan as usize] = Vec3::zeros();
        }
        Ok((lacking, size))
    }

    /// Refuses laws whose stress depends on the length of the step, though nothing moves.
    fn refuse_relaxing(&mut self) -> Result<(), StaticError> {
        self.forces_at_rest(SOME_STEP)?;
        let moving = self.force_buffers();
        self.forces_at_rest(0.0)?;
        for ((block, moving), still) in self.blocks.iter().zip(moving).zip(self.force_buffers()) {
            let change: Vec<Vec3> = moving.iter().zip(&still).map(|(a, b)| a - b).collect();
            if norm(&change) > SAME * norm(&still) {
                return Err(StaticError::Relaxes {
                    set: block.label().into(),
                });
            }
        }
        Ok(())
    }

    /// The forces (N) that each block computed last.
    fn force_buffers(&self) -> Vec<Vec<Vec3>> {
        let mut start = 0;
        with_nodes!(&self.nodes, arrays => {
            let own = |&length: &usize| {
                let buffer = &arrays.forces[start..start + length];
                start += length;
                buffer.iter().map(|force| force.to_vector()).collect()
            };
            self.lengths.iter().map(own).collect()
        })
    }

    /// Computes the internal forces at the present displacement, in steps of a length (s).
    pub(super) fn forces_at_rest(&mut self, step: f64) -> Result<(), StaticError> {
        let when = StepTime {
            number: self.number,
            time: self.time,
            step,
        };
        let (blocks, lengths) = (&mut self.blocks, &self.lengths);
        let fault = with_nodes!(&mut self.nodes, arrays => {
            let context = BlockContext::new(
                when,
                Storage::view(&arrays.displacement),
                Storage::view(&arrays.velocity),
            );
            block_forces(blocks, split(&mut arrays.forces, lengths), &context, false)
        });
        match fault {
            None => Ok(()),
            Some((set, fault)) => Err(StaticError::Element {
                element: self.element_tag(fault.element),
                set,
                reason: fault.reason,
            }),
        }
    }

    /// The internal forces (N) that the blocks computed last, by engine node.
    pub(super) fn internal_forces(&self) -> Vec<Vec3> {
        let (slots, count) = (&self.slots, self.mass.len());
        with_nodes!(&self.nodes, arrays => {
            (0..count).into_par_iter().map(|node| arrays.internal(slots, node)).collect()
        })
    }

    /// Gives the leads of groups the sum of their members' entries.
    pub(super) fn gather_members(&self, vector: &mut [Vec3]) {
        for group in &self.groups.groups {
            let sum: Vec3 = group.members.iter().map(|&m| vector[m as usize]).sum();
            vector[group.members[0] as usize] = sum;
        }
    }

    /// The engine nodes that move as one with an engine node, itself among them.
    pub(super) fn members<'a>(&'a self, node: &'a u32) -> &'a [u32] {
        let group = self.group_of[*node as usize].map(|g| &self.groups.groups[g as usize]);
        group.map_or(std::slice::from_ref(node), |group| &group.members)
    }

    /// Engine nodes that joints and ties connect, each list in rising order.
    fn joined_nodes(&self) -> Vec<Vec<u32>> {
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for bound in &self.constraints {
            pairs.extend(bound.constraint.ties());
            let joints = bound.constraint.joints();
            let of_joints = joints.iter().flat_map(|joint| joint.pairs);
            pairs.extend(of_joints.map(|pair| pair.nodes));
        }
        let pairs = pairs.into_iter();
        let pairs: Vec<[u32; 2]> = pairs
            .map(|pair| pair.map(|node| self.engine(node) as u32))
            .collect();
        let mut nodes: Vec<u32> = pairs.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: u32| nodes.partition_point(|&other| other < node) as u32;
        let mut parts = super::Parts::new(nodes.len());
        for [a, b] in pairs {
            parts.join(place(a), place(b));
        }
        let mut lists = std::collections::BTreeMap::<u32, Vec<u32>>::new();
        for (place, &node) in nodes.iter().enumerate() {
            let root = parts.root(place as u32);
            lists.entry(root).or_default().push(node);
        }
        lists.into_values().collect()
    }
}

/// Which loads count.
#[derive(Clone, Copy, Debug)]
enum Loads {
    /// All of them.
    All,
    /// Those that no boundary brought.
    Own,
}
