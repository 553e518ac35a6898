//! The element block of a set of bolts.

use std::sync::Arc;

use powerhouse_model::{
    AXIAL_FORCE, BlockContext, BlockEnergy, ElementBlock, ElementFault, FrequencyBound,
    HistoryField, Mat3, NodalView, NodalViewMut, Operator, Quad, Stress, Vec3,
};

use super::BoltSet;
use super::bar::{Bar, BarState};
use super::interpolation::Interpolation;

const PLASTIC: &str = "plastic_elongation";
const SLIP: &str = "grout_slip";
const REFERENCE: &str = "installed_at";
const GROUT: &str = "grout_force";
/// Energy dissipated by each bolt (J), stored at its first segment.
const DISSIPATED: &str = "dissipated_by_bolt";

/// One bolt.
struct Bolt {
    bar: Bar,
    interpolation: Interpolation,
    /// Mesh index of the host element of each segment.
    hosts: Vec<u32>,
    /// Axial displacements (m) of the segment ends at installation.
    reference: Vec<[f64; 2]>,
    /// Elongation (m) of the segments by the reference displacements.
    reference_elongation: Vec<f64>,
    committed: BarState,
    /// Trial state of the last forces.
    trial: BarState,
    /// Whether the trial state is valid and not committed.
    pending: bool,
}

/// Failure of a bolt, with the index of the segment.
enum Failure {
    /// A displacement is not finite.
    NotFinite(usize),
    /// The equilibrium of bar and grout does not converge.
    NotConverged(usize),
}

/// Element block of all bolts of a set.
pub(super) struct BoltBlock {
    name: Arc<str>,
    /// Mesh indices of the nodes of the host elements, in rising order.
    nodes: Vec<u32>,
    bolts: Vec<Bolt>,
    workspace: Workspace,
}

/// Reusable buffers.
#[derive(Default)]
struct Workspace {
    sums: Vec<Vec3>,
    line: Vec<f64>,
    moved: Vec<[f64; 2]>,
    forces: Vec<[f64; 2]>,
    elongations: Vec<f64>,
}

impl Workspace {
    /// Sets the forces on `nodes` nodes to zero.
    fn clear(&mut self, nodes: usize) {
        self.sums.clear();
        self.sums.resize(nodes, Vec3::zeros());
    }
    /// Sets the forces at the ends of `segments` segments to zero.
    fn clear_bolt(&mut self, segments: usize) {
        self.forces.clear();
        self.forces.resize(segments, [0.0; 2]);
    }
}

impl BoltBlock {
    pub(super) fn new(set: &BoltSet) -> Self {
        let points = set.bolts.iter().flat_map(|bolt| &bolt.segments);
        let hosts = points.flat_map(|segment| &segment.ends);
        let mut nodes: Vec<u32> = hosts.flat_map(|end| end.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let index = |node: u32| nodes.partition_point(|&other| other < node) as u32;
        let bolts = set.bolts.iter().zip(set.bars());
        let bolts = bolts
            .map(|(bolt, bar)| {
                let points = bolt.segments.iter().flat_map(|segment| &segment.ends);
                let hosts = bolt.segments.iter().map(|segment| segment.element);
                let state = bar.installed();
                Bolt {
                    interpolation: Interpolation::new(bolt.direction, points, index),
                    hosts: hosts.collect(),
                    reference: vec![[0.0; 2]; bolt.segments.len()],
                    reference_elongation: vec![0.0; bolt.segments.len()],
                    committed: state.clone(),
                    trial: state,
                    pending: false,
                    bar,
                }
            })
            .collect();
        Self {
            name: set.name.clone(),
            bolts,
            nodes,
            workspace: Workspace::default(),
        }
    }

    /// Sums the internal forces (N) of all bolts for displacements (m) of the block's nodes.
    fn resist(&mut self, displacement: impl Fn(u32) -> Vec3) -> Result<(), ElementFault> {
        let workspace = &mut self.workspace;
        workspace.clear(self.nodes.len());
        for (index, bolt) in self.bolts.iter_mut().enumerate() {
            bolt.resist(&displacement, workspace).map_err(|failure| {
                let (segment, reason) = match failure {
                    Failure::NotFinite(segment) => (
                        segment,
                        format!("the displacement of a node at bolt {index} is not finite"),
                    ),
                    Failure::NotConverged(segment) => (
                        segment,
                        format!("the equilibrium of bolt {index} with its grout does not converge"),
                    ),
                };
                let element = bolt.hosts[segment];
                ElementFault::new(element, reason)
            })?;
        }
        Ok(())
    }

    fn segment_count(&self) -> usize {
        self.bolts.iter().map(|bolt| bolt.hosts.len()).sum()
    }

    /// A history field with `points` values per segment.
    fn field(&self, name: &str, points: usize, values: Vec<f64>) -> HistoryField {
        let segments = (0..self.segment_count() as u32).collect();
        HistoryField::new(format!("{}/{name}", self.name), segments, points, values)
    }

    /// The values of a history field of these bolts in an earlier state, if there are any.
    fn found<'a>(
        &self,
        fields: &'a [HistoryField],
        name: &str,
        points: usize,
    ) -> Option<&'a [f64]> {
        let name = format!("{}/{name}", self.name);
        let field = fields.iter().find(|field| field.name == name)?;
        let whole = field.points == points && field.values.len() == points * self.segment_count();
        whole.then_some(&field.values)
    }
}

impl Bolt {
    /// Calls `show` with each column of the elastic axial stiffness (N/m): the index of a node in the block, and the axial
    /// forces at all nodes of the bolt per unit axial displacement of that node.
    fn each_column(&self, mut show: impl FnMut(u32, &[f64])) {
        let nodes = self.interpolation.nodes();
        let mut unit = vec![0.0; nodes.len()];
        let (mut moved, mut column) = (Vec::new(), Vec::new());
        let mut forces = vec![[0.0; 2]; self.hosts.len()];
        for (own, &node) in nodes.iter().enumerate() {
            unit[own] = 1.0;
            self.interpolation.interpolate(&unit, &mut moved);
            unit[own] = 0.0;
            self.bar.elastic(&moved, &mut forces);
            self.interpolation.gather(&forces, &mut column);
            show(node, &column);
        }
    }

    /// The state of the last forces, committed or not.
    fn present(&self) -> &BarState {
        if self.pending {
            &self.trial
        } else {
            &self.committed
        }
    }

    /// Adds the internal forces (N) for the displacements (m) of the block's nodes.
    fn resist(
        &mut self,
        value: impl Fn(u32) -> Vec3,
        workspace: &mut Workspace,
    ) -> Result<(), Failure> {
        let (old, new) = (&self.committed, &mut self.trial);
        let Some(grout) = self.bar.grout() else {
            let elongations = &mut workspace.elongations;
            (self.interpolation).elongations(value, &mut workspace.line, elongations);
            let references = &self.reference_elongation;
            for (elongation, reference) in elongations.iter_mut().zip(references) {
                *elongation -= reference;
            }
            if let Some(segment) = elongations.iter().position(|e| !e.is_finite()) {
                return Err(Failure::NotFinite(segment));
            }
            self.bar.stretch(elongations, old, new);
            self.pending = true;
            let sums = &mut workspace.sums;
            (self.interpolation).spread_tension(&new.force, &mut workspace.line, sums);
            return Ok(());
        };
        (self.interpolation).axial(value, &mut workspace.line, &mut workspace.moved);
        for (moved, reference) in workspace.moved.iter_mut().zip(&self.reference) {
            *moved = [moved[0] - reference[0], moved[1] - reference[1]];
        }
        let invalid = |ends: &[f64; 2]| ends.iter().any(|u| !u.is_finite());
        if let Some(segment) = workspace.moved.iter().position(invalid) {
            return Err(Failure::NotFinite(segment));
        }
        workspace.clear_bolt(self.hosts.len());
        let (moved, forces) = (&workspace.moved, &mut workspace.forces);
        let found = self.bar.forces(grout, moved, old, new, forces);
        self.pending = found.is_some();
        if found.is_none() {
            let stretch = |ends: &[f64; 2]| (ends[1] - ends[0]).abs();
            let worst = workspace.moved.iter().map(stretch).enumerate();
            let worst = worst.max_by(|a, b| a.1.total_cmp(&b.1));
            let segment = worst.map_or(0, |(segment, _)| segment);
            return Err(Failure::NotConverged(segment));
        }
        let Workspace {
            sums, line, forces, ..
        } = workspace;
        self.interpolation.spread(forces, line, sums);
        Ok(())
    }

    /// Installs the bolt at a reference displacement (m) of its segment ends.
    fn install(&mut self, reference: Vec<[f64; 2]>) {
        let elongations = reference.iter().map(|ends| ends[1] - ends[0]);
        self.reference_elongation = elongations.collect();
        self.reference = reference;
        self.committed = self.bar.installed();
        self.trial = self.committed.clone();
        self.pending = false;
    }
}

fn put(sums: &[Vec3], out: NodalViewMut) {
    match out {
        NodalViewMut::F64(out) => {
            for (out, sum) in out.iter_mut().zip(sums) {
                *out = Quad::from_vector(sum);
            }
        }
        NodalViewMut::F32(out) => {
            for (out, sum) in out.iter_mut().zip(sums) {
                *out = Quad::from_vector(sum);
            }
        }
    }
}

impl ElementBlock for BoltBlock {
    fn label(&self) -> &str {
        &self.name
    }
    fn elements(&self) -> &[u32] {
        &[]
    }
    fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    fn reads_velocity(&self, _damping_shift: f64, _ledger: bool) -> bool {
        false
    }
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        match context.displacement {
            NodalView::F64(u) => self.resist(|node| u[node as usize].to_vector())?,
            NodalView::F32(u) => self.resist(|node| u[node as usize].to_vector())?,
        }
        put(&self.workspace.sums, out);
        Ok(())
    }
    fn commit(&mut self) {
        for bolt in self.bolts.iter_mut().filter(|bolt| bolt.pending) {
            core::mem::swap(&mut bolt.committed, &mut bolt.trial);
            bolt.pending = false;
        }
    }
    fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
        let mut workspace = Workspace::default();
        workspace.clear(self.nodes.len());
        let Workspace {
            sums,
            line,
            moved,
            forces,
            ..
        } = &mut workspace;
        let value = |index: u32| x.vector(index as usize);
        for bolt in &self.bolts {
            bolt.interpolation.axial(value, line, moved);
            forces.clear();
            forces.resize(bolt.hosts.len(), [0.0; 2]);
            bolt.bar.elastic(moved, forces);
            bolt.interpolation.spread(forces, line, sums);
        }
        put(sums, out);
    }
    fn diagonal(&self, _operator: Operator, out: &mut [Mat3]) {
        for bolt in &self.bolts {
            let direction = bolt.interpolation.direction();
            let across = direction * direction.transpose();
            let mut own = 0;
            bolt.each_column(|node, forces| {
                out[node as usize] += across * forces[own];
                own += 1;
            });
        }
    }
    fn each_matrix(&self, _operator: Operator, show: &mut dyn FnMut(&[u32], &[f64])) {
        for bolt in &self.bolts {
            let indices = bolt.interpolation.nodes();
            let size = 3 * indices.len();
            let mut matrix = vec![0.0; size * size];
            let direction = bolt.interpolation.direction();
            let across = direction * direction.transpose();
            let mut first = 0;
            bolt.each_column(|_, forces| {
                for (row, force) in forces.iter().enumerate() {
                    for i in 0..3 {
                        for j in 0..3 {
                            matrix[(3 * row + i) * size + first + j] = across[(i, j)] * force;
                        }
                    }
                }
                first += 3;
            });
            show(indices, &matrix);
        }
    }
    fn add_mass(&self, _out: &mut [f64]) {}
    fn frequency_bounds(&self) -> Vec<FrequencyBound> {
        Vec::new()
    }
    fn stiffness_damping(&self) -> f64 {
        0.0
    }
    fn mass_damping(&self) -> f64 {
        0.0
    }
    fn set_active(&mut self, _active: &[bool]) {}
    fn set_reference_displacement(&mut self, displacement: NodalView) {
        let value = |index: u32| displacement.vector(index as usize);
        for bolt in &mut self.bolts {
            let mut reference = Vec::new();
            let line = &mut self.workspace.line;
            bolt.interpolation.axial(value, line, &mut reference);
            bolt.install(reference);
        }
    }
    fn set_initial_stress(&mut self, _stress: &[Stress]) {}
    fn add_stress(&self, _displacement: NodalView, _out: &mut [Stress]) {}
    fn energy(&self, _context: &BlockContext) -> BlockEnergy {
        let mut energy = BlockEnergy::default();
        for bolt in &self.bolts {
            energy.elastic += bolt.bar.stored(bolt.present());
            energy.plastic += bolt.present().dissipated;
        }
        energy
    }
    fn history(&self) -> Vec<HistoryField> {
        let states = || self.bolts.iter().map(|bolt| &bolt.committed);
        let pairs = |pairs: Vec<[f64; 2]>| pairs.into_iter().flatten().collect();
        let references = self.bolts.iter().flat_map(|bolt| bolt.reference.clone());
        vec![
            self.field(
                AXIAL_FORCE,
                1,
                states().flat_map(|s| s.force.clone()).collect(),
            ),
            self.field(
                PLASTIC,
                1,
                states().flat_map(|s| s.plastic.clone()).collect(),
            ),
            self.field(
                SLIP,
                2,
                pairs(states().flat_map(|s| s.slip.clone()).collect()),
            ),
            self.field(REFERENCE, 2, pairs(references.collect())),
            self.field(
                GROUT,
                2,
                pairs(states().flat_map(|s| s.grout.clone()).collect()),
            ),
            self.field(
                DISSIPATED,
                1,
                (states())
                    .flat_map(|s| {
                        (0..s.force.len()).map(|k| if k == 0 { s.dissipated } else { 0.0 })
                    })
                    .collect(),
            ),
        ]
    }
    fn set_history(&mut self, fields: &[HistoryField]) {
        let one = |name| self.found(fields, name, 1);
        let two = |name| self.found(fields, name, 2);
        let (Some(force), Some(plastic), Some(slip), Some(reference)) =
            (one(AXIAL_FORCE), one(PLASTIC), two(SLIP), two(REFERENCE))
        else {
            return;
        };
        let (Some(grout), Some(dissipated)) = (two(GROUT), one(DISSIPATED)) else {
            return;
        };
        let mut start = 0;
        for bolt in &mut self.bolts {
            let end = start + bolt.hosts.len();
            let pairs = |values: &[f64]| -> Vec<[f64; 2]> {
                let values = values[2 * start..2 * end].chunks_exact(2);
                values.map(|pair| [pair[0], pair[1]]).collect()
            };
            bolt.install(pairs(reference));
            bolt.committed.force.copy_from_slice(&force[start..end]);
            bolt.committed.plastic.copy_from_slice(&plastic[start..end]);
            bolt.committed.slip = pairs(slip);
            bolt.committed.grout = pairs(grout);
            bolt.committed.dissipated = dissipated[start];
            bolt.trial = bolt.committed.clone();
            start = end;
        }
    }
}
