//! Axial forces of bolts.

use powerhouse_explicit_core::BoltSet;
use powerhouse_explicit_core::observe::PeakField;
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
    /// The greatest of them in a run (N), with its time (s), if one was watched.
    pub greatest: Option<PeakField>,
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
            greatest: None,
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
    /// The greatest force of a run (N, tension positive) and its time (s), with the bolt that bore it.
    pub fn greatest_of_run(&self) -> Option<(usize, f64, f64)> {
        let PeakField { values, times } = self.greatest.as_ref()?;
        let all = self.bolts.iter().zip(values.iter().zip(times));
        let all = all.map(|(&bolt, (&value, &time))| (bolt, value, time));
        all.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    pub(super) fn columns(&self) -> Vec<TableColumn> {
        let bolts = self.bolts.iter().map(|&bolt| bolt as f64 + 1.0);
        let elements = self.elements.iter().map(|&element| element as f64);
        let end = |i: usize| self.ends.iter().map(|ends| ends[i]).collect();
        let mut columns = vec![
            TableColumn::new("bolt", "1", bolts.collect()),
            TableColumn::new("element", "1", elements.collect()),
            TableColumn::new("from", "m", end(0)),
            TableColumn::new("to", "m", end(1)),
            TableColumn::new("axial force", "N", self.forces.clone()),
        ];
        if let Some(PeakField { values, times }) = &self.greatest {
            columns.push(TableColumn::new("greatest force", "N", values.clone()));
            columns.push(TableColumn::new("time of it", "s", times.clone()));
        }
        columns
    }
}
