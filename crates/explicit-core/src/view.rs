//! Read access of observers to a model within a step.

use std::cell::OnceCell;

use powerhouse_model::{
    EFFECTIVE_STRESS, JointView, NodalView, PORE_PRESSURE, Quad, StepView, Stress, Vec3,
    effective_stress,
};

use crate::Model;
use crate::nodes::with_nodes;

/// Read access to a model between its velocity and displacement update; values are computed on demand.
pub(crate) struct View<'a> {
    model: &'a Model,
    step: f64,
    energies: &'a [(&'static str, f64)],
    /// Displacements (m) of the nodes of each block, copied at the first access.
    displacements: Vec<OnceCell<Vec<Quad<f64>>>>,
    /// Mean element stresses of each block, computed at the first access.
    stresses: Vec<OnceCell<Vec<Stress>>>,
}

impl<'a> View<'a> {
    pub(crate) fn new(model: &'a Model, step: f64, energies: &'a [(&'static str, f64)]) -> Self {
        Self {
            model,
            step,
            energies,
            displacements: vec![OnceCell::new(); model.blocks.len()],
            stresses: vec![OnceCell::new(); model.blocks.len()],
        }
    }

    /// Displacement (m) of the nodes of a block, in the block's order.
    fn displacement_of_block(&self, block: usize) -> &[Quad<f64>] {
        self.displacements[block].get_or_init(|| self.model.displacement_of_block(block))
    }
}

impl StepView for View<'_> {
    fn number(&self) -> u64 {
        self.model.number
    }
    fn time(&self) -> f64 {
        self.model.time
    }
    fn step(&self) -> f64 {
        self.step
    }
    fn node_count(&self) -> usize {
        self.model.mesh.node_count()
    }
    fn displacement(&self, node: u32) -> Vec3 {
        let start = self.model.stage_start.get(node as usize);
        self.model.displacement(node) - start.copied().unwrap_or_default()
    }
    fn velocity(&self, node: u32) -> Vec3 {
        let (before, after) = self.model.velocities_around(self.model.engine(node));
        (before + after) * 0.5
    }
    fn acceleration(&self, node: u32) -> Vec3 {
        let (before, after) = self.model.velocities_around(self.model.engine(node));
        (after - before) / self.step
    }
    fn stress(&self, element: u32) -> Stress {
        let model = self.model;
        let Some((block, index)) = model.subdomain.block_of(element) else {
            return Stress::default();
        };
        let Some(known) = self.stresses.get(block) else {
            return Stress::default();
        };
        let stresses =
            known.get_or_init(|| model.stresses_of(block, self.displacement_of_block(block)));
        let change = stresses[index];
        model.initial.stress(element) + change
    }
    fn stress_at(&self, element: u32, natural: &Vec3) -> Option<Stress> {
        let mut stress = self.stress(element);
        let model = self.model;
        let Some((block, index)) = model.subdomain.block_of(element) else {
            return Some(stress);
        };
        let displacement = NodalView::F64(self.displacement_of_block(block));
        let output = model.blocks[block].output();
        let linear = output.and_then(|output| output.surface_stresses(index, displacement));
        if let Some(linear) = linear {
            for (part, coordinate) in linear.iter().zip(natural.iter()) {
                for i in 0..6 {
                    stress.0[i] += part.0[i] * coordinate;
                }
            }
        }
        Some(stress)
    }
    fn element_forces(&self, element: u32, out: &mut [Vec3]) -> bool {
        let model = self.model;
        let Some((block, index)) = model.subdomain.block_of(element) else {
            out.fill(Vec3::zeros());
            return true;
        };
        let initial = model.initial.stress(element);
        let displacement = NodalView::F64(self.displacement_of_block(block));
        let forces = model.blocks[block].output();
        let forces = forces.and_then(|output| output.element_forces());
        if let Some(forces) = forces {
            forces.write_forces(index, displacement, &initial, out);
        }
        (model.initial).add_forces_of_slope(&model.mesh, element, out);
        forces.is_some()
    }
    fn energies(&self) -> &[(&'static str, f64)] {
        self.energies
    }
    fn history(&self, element: u32, variable: &str) -> Option<f64> {
        let (block, index) = self.model.subdomain.block_of(element)?;
        let shown = |name: &str| self.model.blocks[block].shown_history(index, name);
        let mut components = EFFECTIVE_STRESS.iter();
        let Some(component) = components.position(|effective| effective.name == variable) else {
            return shown(variable);
        };
        let pressure = shown(PORE_PRESSURE.name)?;
        Some(effective_stress(self.stress(element), pressure).0[component])
    }
    fn embedded(&self, block: &str, variable: &str) -> Option<Vec<f64>> {
        self.model.embedded_values(block, variable)
    }
    fn joints(&self) -> Vec<JointView<'_>> {
        self.model.joints().collect()
    }
}

impl Model {
    /// Mean stress change (Pa) of each element of a block against its initial stress, at a displacement (m) of the
    /// block's nodes.
    pub(crate) fn stresses_of(&self, block: usize, displacement: &[Quad<f64>]) -> Vec<Stress> {
        let block = &self.blocks[block];
        let mut out = vec![Stress::default(); block.elements().len()];
        block.add_stress(NodalView::F64(displacement), &mut out);
        out
    }
    /// Velocities (m/s) of a local node half a step before and after the present time, between
    /// kick and drift.
    pub(crate) fn velocities_around(&self, node: usize) -> (Vec3, Vec3) {
        let of_slice = self.delayed.as_ref();
        if let Some(around) = of_slice.and_then(|slice| slice.velocities_around(node)) {
            return around;
        }
        match self.groups.if_kicked(self.group_of[node]) {
            Some(group) => (
                self.groups.motion.previous[group as usize],
                self.groups.motion.next[group as usize],
            ),
            None => with_nodes!(&self.nodes, arrays => {
                (arrays.velocity[node].to_vector(), arrays.next_velocity(&self.subdomain.slots, &self.groups.motion, node))
            }),
        }
    }
}
