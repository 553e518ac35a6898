//! Axial forces of bolts.

use powerhouse_elements::BoltSet;
use powerhouse_model::{Mesh, State};
use powerhouse_observe::PeakField;

/// Axial forces of a bolt group, one value per segment, from head to toe, bolt after bolt.
#[derive(Clone, Debug, PartialEq)]
pub struct BoltForces {
    /// Name of the bolt group.
    pub name: String,
    /// Index of the bolt of each segment, from zero.
    pub bolts: Vec<usize>,
    /// Number of the element around each segment in the mesh file.
    pub elements: Vec<u64>,
    /// Distances of the ends of each segment from the head (m).
    pub ends: Vec<[f64; 2]>,
    /// Axial force of each segment (N), tension positive.
    pub forces: Vec<f64>,
    /// Envelope over the samples of the dynamic run: greatest axial force of each segment (N, tension positive) and its
    /// time (s); `None` for the forces in a stage, or if the run failed at its start.
    pub greatest: Option<PeakField>,
}

impl BoltForces {
    /// Axial forces in a state; `None` if the state does not contain these bolts.
    pub fn of(bolts: &BoltSet, mesh: &Mesh, state: &State) -> Option<Self> {
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

    /// Index of the bolt with the greatest axial force of [`forces`](Self::forces), and this force (N, tension positive);
    /// `None` without segments.
    pub fn greatest(&self) -> Option<(usize, f64)> {
        let all = self.bolts.iter().copied().zip(self.forces.iter().copied());
        all.max_by(|a, b| a.1.total_cmp(&b.1))
    }
    /// Index of the bolt with the greatest axial force over the run, this force (N, tension positive) and its time
    /// (s); `None` without an envelope or segments.
    pub fn greatest_of_run(&self) -> Option<(usize, f64, f64)> {
        let PeakField { values, times } = self.greatest.as_ref()?;
        let all = self.bolts.iter().zip(values.iter().zip(times));
        let all = all.map(|(&bolt, (&value, &time))| (bolt, value, time));
        all.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}
