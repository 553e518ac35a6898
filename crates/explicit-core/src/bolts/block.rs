//! Bolts as a block.

use std::sync::Arc;

use powerhouse_model::{
    BlockContext, BlockEnergy, ElementBlock, ElementFault, FrequencyBound, HistoryField, Mat3,
    NodalView, NodalViewMut, Numbering, Operator, Quad, Stress, Vec3,
};

use super::BoltSet;
use super::bar::{Bar, BarState};
use super::embedding::HostPoint;

/// The name of the axial force in a state, behind that of the set.
pub(super) const AXIAL_FORCE: &str = "axial_force";
const PLASTIC: &str = "plastic_elongation";
const SLIP: &str = "grout_slip";
const REFERENCE: &str = "installed_at";

/// A point of a bolt: places of nodes in the block, and weights.
#[derive(Debug)]
struct Point(Vec<(u32, f64)>);

/// One bolt.
struct Bolt {
    direction: Vec3,
    bar: Bar,
    points: Vec<[Point; 2]>,
    /// Mesh index of the element that each segment is in.
    hosts: Vec<u32>,
    /// Axial displacements (m) at which it was installed.
    reference: Vec<[f64; 2]>,
    committed: BarState,
    latest: BarState,
    /// Forces (N) of the last evaluation.
    forces: Vec<[f64; 2]>,
}

/// All bolts of a set.
pub(super) struct BoltBlock {
    name: Arc<str>,
    nodes: Vec<u32>,
    bolts: Vec<Bolt>,
}

impl BoltBlock {
    pub(super) fn new(set: &BoltSet, numbering: &Numbering) -> Self {
        let engine = |node: &u32| numbering.engine_of[*node as usize];
        let points = set.bolts.iter().flat_map(|bolt| &bolt.segments);
        let hosts = points.flat_map(|segment| &segment.ends);
        let mut nodes: Vec<u32> = hosts.flat_map(|end| end.nodes.iter().map(engine)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: &u32| {
            let engine = engine(node);
            nodes.partition_point(|&other| other < engine) as u32
        };
        let point = |host: &HostPoint| {
            let nodes = host.nodes.iter().map(place);
            Point(nodes.zip(host.weights.iter().copied()).collect())
        };
        let bolts = set.bolts.iter().zip(set.bars());
        let bolts = bolts
            .map(|(bolt, bar)| {
                let count = bolt.segments.len();
                let state = bar.installed();
                Bolt {
                    direction: bolt.direction,
                    points: (bolt.segments.iter())
                        .map(|segment| segment.ends.each_ref().map(point))
                        .collect(),
                    hosts: bolt
                        .segments
                        .iter()
                        .map(|segment| segment.element)
                        .collect(),
                    reference: vec![[0.0; 2]; count],
                    committed: state.clone(),
                    latest: state,
                    forces: vec![[0.0; 2]; count],
                    bar,
                }
            })
            .collect();
        Self {
            name: set.name.clone(),
            bolts,
            nodes,
        }
    }

    fn segment_count(&self) -> usize {
        self.bolts.iter().map(|bolt| bolt.points.len()).sum()
    }

    /// A field of so many numbers per segment.
    fn field(&self, name: &str, points: usize, values: Vec<f64>) -> HistoryField {
        HistoryField {
            name: format!("{}/{name}", self.name),
            elements: (0..self.segment_count() as u32).collect(),
            points,
            values,
        }
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
    /// Axial displacements (m) of its points.
    fn axial(&self, value: impl Fn(u32) -> Vec3) -> Vec<[f64; 2]> {
        let along = |point: &Point| -> f64 {
            let nodes = point.0.iter();
            nodes
                .map(|&(place, weight)| weight * self.direction.dot(&value(place)))
                .sum()
        };
        let points = self.points.iter();
        points.map(|ends| ends.each_ref().map(along)).collect()
    }

    /// Places of the nodes that it hangs on, in rising order.
    fn places(&self) -> Vec<u32> {
        let hosts = self.points.iter().flatten().flat_map(|point| &point.0);
        let mut places: Vec<u32> = hosts.map(|&(place, _)| place).collect();
        places.sort_unstable();
        places.dedup();
        places
    }

    /// For each of its places, the axial forces (N/m) at all of them if that one alone moves by one
    /// along the bolt, elastic.
    fn each_column(&self, mut show: impl FnMut(u32, &[(u32, f64)])) {
        let weight = |point: &Point, place: u32| -> f64 {
            let own = point.0.iter().filter(|&&(other, _)| other == place);
            own.map(|&(_, weight)| weight).sum()
        };
        let places = self.places();
        let mut forces = vec![[0.0; 2]; self.points.len()];
        for &moved in &places {
            let unit: Vec<[f64; 2]> = (self.points.iter())
                .map(|ends| ends.each_ref().map(|point| weight(point, moved)))
                .collect();
            self.bar.elastic(&unit, &mut forces);
            let at = |&place: &u32| {
                let points = self.points.iter().flatten().zip(forces.iter().flatten());
                let sum = points.map(|(point, force)| weight(point, place) * force);
                (place, sum.sum())
            };
            let column: Vec<(u32, f64)> = places.iter().map(at).collect();
            show(moved, &column);
        }
    }

    /// Adds axial forces at its points to the nodes.
    fn spread(&self, forces: &[[f64; 2]], out: &mut [Vec3]) {
        for (points, forces) in self.points.iter().zip(forces) {
            for (point, force) in points.iter().zip(forces) {
                for &(place, weight) in &point.0 {
                    out[place as usize] += self.direction * (weight * force);
                }
            }
        }
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
        let mut sums = vec![Vec3::zeros(); self.nodes.len()];
        for (index, bolt) in self.bolts.iter_mut().enumerate() {
            let value = |place: u32| {
                context
                    .displacement
                    .vector(self.nodes[place as usize] as usize)
            };
            let mut moved = bolt.axial(value);
            for (moved, reference) in moved.iter_mut().zip(&bolt.reference) {
                *moved = [moved[0] - reference[0], moved[1] - reference[1]];
            }
            let broken = |ends: &[f64; 2]| ends.iter().any(|u| !u.is_finite());
            if let Some(place) = moved.iter().position(broken) {
                return Err(ElementFault {
                    element: bolt.hosts[place],
                    reason: format!(
                        "a node has a displacement that is not finite where bolt {index} crosses it"
                    ),
                });
            }
            let mut forces = core::mem::take(&mut bolt.forces);
            let (old, new) = (&bolt.committed, &mut bolt.latest);
            let found = bolt.bar.forces(&moved, old, new, &mut forces);
            bolt.forces = forces;
            if found.is_none() {
                let stretch = |ends: &[f64; 2]| (ends[1] - ends[0]).abs();
                let worst = moved.iter().map(stretch).enumerate();
                let worst = worst.max_by(|a, b| a.1.total_cmp(&b.1));
                return Err(ElementFault {
                    element: bolt.hosts[worst.map_or(0, |(place, _)| place)],
                    reason: format!("bolt {index} finds no balance in its grout"),
                });
            }
            bolt.spread(&bolt.forces, &mut sums);
        }
        put(&sums, out);
        Ok(())
    }
    fn commit(&mut self) {
        for bolt in &mut self.bolts {
            bolt.committed.clone_from(&bolt.latest);
        }
    }
    fn apply(&self, _operator: Operator, x: NodalView, out: NodalViewMut) {
        let mut sums = vec![Vec3::zeros(); self.nodes.len()];
        for bolt in &self.bolts {
            let moved = bolt.axial(|place| x.vector(self.nodes[place as usize] as usize));
            let mut forces = vec![[0.0; 2]; moved.len()];
            bolt.bar.elastic(&moved, &mut forces);
            bolt.spread(&forces, &mut sums);
        }
        put(&sums, out);
    }
    fn diagonal(&self, _operator: Operator, out: &mut [Mat3]) {
        for bolt in &self.bolts {
            let across = bolt.direction * bolt.direction.transpose();
            bolt.each_column(|place, forces| {
                let own = forces.iter().find(|(other, _)| *other == place);
                out[place as usize] += across * own.map_or(0.0, |(_, force)| *force);
            });
        }
    }
    fn each_matrix(&self, _operator: Operator, show: &mut dyn FnMut(&[u32], &[f64])) {
        for bolt in &self.bolts {
            let places = bolt.places();
            let size = 3 * places.len();
            let mut matrix = vec![0.0; size * size];
            let across = bolt.direction * bolt.direction.transpose();
            let mut first = 0;
            bolt.each_column(|_, forces| {
                for (row, (_, force)) in forces.iter().enumerate() {
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
        for bolt in &mut self.bolts {
            let value = |place: u32| displacement.vector(self.nodes[place as usize] as usize);
            bolt.reference = bolt.axial(value);
            bolt.committed = bolt.bar.installed();
            bolt.latest = bolt.committed.clone();
        }
    }
    fn set_initial_stress(&mut self, _stress: &[Stress]) {}
    fn add_stress(&self, _displacement: NodalView, _out: &mut [Stress]) {}
    fn energy(&self, _context: &BlockContext) -> BlockEnergy {
        let mut energy = BlockEnergy::default();
        for bolt in &self.bolts {
            energy.elastic += bolt.bar.stored(&bolt.latest);
            energy.plastic += bolt.latest.spent;
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
        let mut start = 0;
        for bolt in &mut self.bolts {
            let end = start + bolt.points.len();
            let pairs = |values: &[f64]| -> Vec<[f64; 2]> {
                let values = values[2 * start..2 * end].chunks_exact(2);
                values.map(|pair| [pair[0], pair[1]]).collect()
            };
            bolt.reference = pairs(reference);
            bolt.committed = bolt.bar.installed();
            bolt.committed.force.copy_from_slice(&force[start..end]);
            bolt.committed.plastic.copy_from_slice(&plastic[start..end]);
            bolt.committed.slip = pairs(slip);
            bolt.latest = bolt.committed.clone();
            start = end;
        }
    }
}
