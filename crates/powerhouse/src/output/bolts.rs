//! Axial forces of bolts.

use powerhouse_explicit_core::BoltSet;
use powerhouse_io::TableColumn;
use powerhouse_model::{Mesh, State};

/// The axial forces of the bolts of one make, segment by segment from head to toe, bolt after bolt.
#[derive(Clone, Debug, PartialEq)]
pub struct BoltForces {
    /// The name of the bolts.
    pub name: String,
    /// Which bolt each segment belongs to, from zero.
    pub bolts: Vec<usize>,
    /// The user's number of the element that it is in.
    pub elements: Vec<u64>,
    /// Distances of its ends from the head (m).
    pub ends: Vec<[f64; 2]>,
    /// Axial forces (N), tension positive.
    pub forces: Vec<f64>,
}

impl BoltForces {
    /// The forces of bolts in a state; none if it does not know them.
    pub(crate) fn of(bolts: &BoltSet, mesh: &Mesh, state: &State) -> Option<Self> {
        let mut found = Self {
            name: bolts.name().into(),
            bolts: Vec::new(),
            elements: Vec::new(),
            ends: Vec::new(),
            forces: bolts.axial_forces(state)?,
        };
        for bolt in 0..bolts.len() {
            for segment in bolts.segments(bolt) {
                found.bolts.push(bolt);
                found
                    .elements
                    .push(mesh.element_tags()[segment.element as usize]);
                found
                    .ends
                    .push([segment.start, segment.start + segment.length]);
            }
        }
        Some(found)
    }

    /// The greatest force (N, tension positive), with the bolt that bears it.
    pub fn greatest(&self) -> Option<(usize, f64)> {
        let all = self.bolts.iter().copied().zip(self.forces.iter().copied());
        all.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    pub(super) fn columns(&self) -> [TableColumn; 5] {
        let bolts = self.bolts.iter().map(|&bolt| bolt as f64 + 1.0);
        let elements = self.elements.iter().map(|&element| element as f64);
        let end = |i: usize| self.ends.iter().map(|ends| ends[i]).collect();
        [
            TableColumn::new("bolt", "1", bolts.collect()),
            TableColumn::new("element", "1", elements.collect()),
            TableColumn::new("from", "m", end(0)),
            TableColumn::new("to", "m", end(1)),
            TableColumn::new("axial force", "N", self.forces.clone()),
        ]
    }
}
