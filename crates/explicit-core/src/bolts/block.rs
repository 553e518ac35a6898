//! Bolts as a block.

use std::sync::Arc;

use powerhouse_model::{
    BlockContext, BlockEnergy, ElementBlock, ElementFault, FrequencyBound, HistoryField, Mat3,
    NodalView, NodalViewMut, Numbering, Operator, Quad, Stress, Vec3,
};

use super::BoltSet;
use super::bar::{Bar, BarState};
use super::hanging::Hanging;

/// The name of the axial force in a state, behind that of the set.
pub(crate) const AXIAL_FORCE: &str = "axial_force";
const PLASTIC: &str = "plastic_elongation";
const SLIP: &str = "grout_slip";
const REFERENCE: &str = "installed_at";
const GROUT: &str = "grout_force";
/// Of each bolt, at its first segment (J).
const SPENT: &str = "dissipated_by_bolt";

/// One bolt.
struct Bolt {
    bar: Bar,
    hanging: Hanging,
    /// Mesh index of the element that each segment is in.
    hosts: Vec<u32>,
    /// Axial displacements (m) at which it was installed.
    reference: Vec<[f64; 2]>,
    /// How much longer (m) its segments were then than without them.
    slack: Vec<f64>,
    committed: BarState,
    /// That of the last forces, if it is not committed yet.
    latest: BarState,
    pending: bool,
}

/// Why a bolt has no forces, and at which of its segments.
enum Stop {
    NotFinite(usize),
    NoBalance(usize),
}

/// All bolts of a set.
pub(super) struct BoltBlock {
    name: Arc<str>,
    nodes: Vec<u32>,
    bolts: Vec<Bolt>,
    room: Room,
}

/// What is computed in from bolt to bolt.
#[derive(Default)]
struct Room {
    sums: Vec<Vec3>,
    line: Vec<f64>,
    moved: Vec<[f64; 2]>,
    forces: Vec<[f64; 2]>,
    elongations: Vec<f64>,
}

impl Room {
    /// No forces yet on so many nodes.
    fn clear(&mut self, nodes: usize) {
        self.sums.clear();
        self.sums.resize(nodes, Vec3::zeros());
    }
    /// No forces yet at the points of so many segments.
    fn clear_bolt(&mut self, segments: usize) {
        self.forces.clear();
        self.forces.resize(segments, [0.0; 2]);
    }
}

impl BoltBlock {
    pub(super) fn new(set: &BoltSet, numbering: &Numbering) -> Self {
        let engine = |node: &u32| numbering.engine_of[*node as usize];
        let points = set.bolts.iter().flat_map(|bolt| &bolt.segments);
        let hosts = points.flat_map(|segment| &segment.ends);
        let mut nodes: Vec<u32> = hosts.flat_map(|end| end.nodes.iter().map(engine)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: u32| {
            let engine = engine(&node);
            nodes.partition_point(|&other| other < engine) as u32
        };
        let bolts = set.bolts.iter().zip(set.bars());
        let bolts = bolts
            .map(|(bolt, bar)| {
                let points = bolt.segments.iter().flat_map(|segment| &segment.ends);
                let hosts = bolt.segments.iter().map(|segment| segment.element);
                let state = bar.installed();
                Bolt {
                    hanging: Hanging::new(bolt.direction, points, place),
                    hosts: hosts.collect(),
                    reference: vec![[0.0; 2]; bolt.segments.len()],
                    slack: vec![0.0; bolt.segments.len()],
                    committed: state.clone(),
                    latest: state,
                    pending: false,
                    bar,
                }
            })
            .collect();
        Self {
            name: set.name.clone(),
            bolts,
            nodes,
            room: Room::default(),
        }
    }

    /// Sums up the forces (N) that resist the displacements (m) of engine nodes.
    fn resist(&mut self, displacement: impl Fn(u32) -> Vec3) -> Result<(), ElementFault> {
        let room = &mut self.room;
        room.clear(self.nodes.len());
        let value = |place: u32| displacement(self.nodes[place as usize]);
        for (index, bolt) in self.bolts.iter_mut().enumerate() {
            bolt.resist(value, room).map_err(|stop| {
                let (segment, reason) = match stop {
                    Stop::NotFinite(segment) => (
                        segment,
                        format!(
                            "a node has a displacement that is not finite where bolt {index} crosses it"
                        ),
                    ),
                    Stop::NoBalance(segment) => {
                        (segment, format!("bolt {index} finds no balance in its grout"))
                    }
                };
                let element = bolt.hosts[segment];
                ElementFault { element, reason }
            })?;
        }
        Ok(())
    }

    fn segment_count(&self) -> usize {
        self.bolts.iter().map(|bolt| bolt.hosts.len()).sum()
    }

    /// A field of so many numbers per segment.
    fn field(&self, name: &str, points: usize, values: Vec<f64>) -> HistoryField {
        let segments = (0..self.segment_count() as u32).collect();
        HistoryField::new(format!("{}/{name}", self.name), segments, points, values)
    }

    /// The values of a field of an earlier state, if it is of these bolts.
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
    /// For each of its places, the axial forces (N/m) at all of them if that one alone moves by one
    /// along the bolt, elastic.
    fn each_column(&self, mut show: impl FnMut(u32, &[f64])) {
        let places = self.hanging.places();
        let mut unit = vec![0.0; places.len()];
        let (mut moved, mut column) = (Vec::new(), Vec::new());
        let mut forces = vec![[0.0; 2]; self.hosts.len()];
        for (own, &place) in places.iter().enumerate() {
            unit[own] = 1.0;
            self.hanging.interpolate(&unit, &mut moved);
            unit[own] = 0.0;
            self.bar.elastic(&moved, &mut forces);
            self.hanging.gather(&forces, &mut column);
            show(place, &column);
        }
    }

    /// The state of the last forces.
    fn present(&self) -> &BarState {
        if self.pending {
            &self.latest
        } else {
            &self.committed
        }
    }

    /// Adds the forces (N) that resist the displacements (m) at places since the installation.
    fn resist(&mut self, value: impl Fn(u32) -> Vec3, room: &mut Room) -> Result<(), Stop> {
        let (old, new) = (&self.committed, &mut self.latest);
        let Some(grout) = self.bar.grout() else {
            let stretched = &mut room.elongations;
            self.hanging.elongations(value, &mut room.line, stretched);
            for (elongation, slack) in stretched.iter_mut().zip(&self.slack) {
                *elongation -= slack;
            }
            if let Some(segment) = stretched.iter().position(|e| !e.is_finite()) {
                return Err(Stop::NotFinite(segment));
            }
            self.bar.stretch(stretched, old, new);
            self.pending = true;
            let sums = &mut room.sums;
            (self.hanging).spread_tension(&new.force, &mut room.line, sums);
            return Ok(());
        };
        self.hanging.axial(value, &mut room.line, &mut room.moved);
        for (moved, reference) in room.moved.iter_mut().zip(&self.reference) {
            *moved = [moved[0] - reference[0], moved[1] - reference[1]];
        }
        let broken = |ends: &[f64; 2]| ends.iter().any(|u| !u.is_finite());
        if let Some(segment) = room.moved.iter().position(broken) {
            return Err(Stop::NotFinite(segment));
        }
        room.clear_bolt(self.hosts.len());
        let found = (self.bar).forces(grout, &room.moved, old, new, &mut room.forces);
        self.pending = found.is_some();
        if found.is_none() {
            let stretch = |ends: &[f64; 2]| (ends[1] - ends[0]).abs();
            let worst = room.moved.iter().map(stretch).enumerate();
            let worst = worst.max_by(|a, b| a.1.total_cmp(&b.1));
            return Err(Stop::NoBalance(worst.map_or(0, |(segment, _)| segment)));
        }
        let sums = &mut room.sums;
        self.hanging.spread(&room.forces, &mut room.line, sums);
        Ok(())
    }

    /// As it is installed, with what was moved before.
    fn install(&mut self, reference: Vec<[f64; 2]>) {
        self.slack = reference.iter().map(|ends| ends[1] - ends[0]).collect();
        self.reference = reference;
        self.committed = self.bar.installed();
        self.latest = self.committed.clone();
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
    fn forces(&mut self, context: &BlockContext, out: NodalViewMut) -> Result<(), ElementFault> {
        match context.displacement {
            NodalView::F64(u) => self.resist(|node| u[node as usize].to_vector())?,
            NodalView::F32(u) => self.resist(|node| u[node as usize].to_vector())?,
        }
        put(&self.room.sums, out);
        Ok(())
    }
    fn commit(&mut self) {
        for bolt in self.bolts.iter_mut().filter(|bolt| bolt.pending) {
            core::mem::swap(&mut bolt.committed, &mut bolt.latest);
            bolt.pending = false;
        }
    }
    fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
        let mut room = Room::default();
        room.clear(self.nodes.len());
        let value = |place: u32| x.vector(self.nodes[place as usize] as usize);
        for bolt in &self.bolts {
            bolt.hanging.axial(value, &mut room.line, &mut room.moved);
            room.clear_bolt(bolt.hosts.len());
            bolt.bar.elastic(&room.moved, &mut room.forces);
            let sums = &mut room.sums;
            bolt.hanging.spread(&room.forces, &mut room.line, sums);
        }
        put(&room.sums, out);
    }
    fn diagonal(&self, _operator: Operator, out: &mut [Mat3]) {
        for bolt in &self.bolts {
            let direction = bolt.hanging.direction();
            let across = direction * direction.transpose();
            let mut own = 0;
            bolt.each_column(|place, forces| {
                out[place as usize] += across * forces[own];
                own += 1;
            });
        }
    }
    fn each_matrix(&self, _operator: Operator, show: &mut dyn FnMut(&[u32], &[f64])) {
        for bolt in &self.bolts {
            let places = bolt.hanging.places();
            let size = 3 * places.len();
            let mut matrix = vec![0.0; size * size];
            let direction = bolt.hanging.direction();
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
            let nodes: Vec<u32> = (places.iter())
                .map(|&place| self.nodes[place as usize])
                .collect();
            show(&nodes, &matrix);
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
        let value = |place: u32| displacement.vector(self.nodes[place as usize] as usize);
        for bolt in &mut self.bolts {
            let mut reference = Vec::new();
            let line = &mut self.room.line;
            bolt.hanging.axial(value, line, &mut reference);
            bolt.install(reference);
        }
    }
    fn set_initial_stress(&mut self, _stress: &[Stress]) {}
    fn add_stress(&self, _displacement: NodalView, _out: &mut [Stress]) {}
    fn energy(&self, _context: &BlockContext) -> BlockEnergy {
        let mut energy = BlockEnergy::default();
        for bolt in &self.bolts {
            energy.elastic += bolt.bar.stored(bolt.present());
            energy.plastic += bolt.present().spent;
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
                SPENT,
                1,
                (states())
                    .flat_map(|s| (0..s.force.len()).map(|k| if k == 0 { s.spent } else { 0.0 }))
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
        let (Some(grout), Some(spent)) = (two(GROUT), one(SPENT)) else {
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
            bolt.committed.spent = spent[start];
            bolt.latest = bolt.committed.clone();
            start = end;
        }
    }
}
