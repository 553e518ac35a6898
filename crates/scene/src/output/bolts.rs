//! Axial forces of bolts.

use powerhouse_elements::BoltSet;
use powerhouse_io::TableColumn;
use powerhouse_model::{Mesh, State};
use powerhouse_observe::{BoltHistories, PeakField};

use super::{
    OutputItem, OutputPrice, OutputScale, OutputSite, Recorder, TableForm, TablePeaks, TablePlots,
    file_name, model,
};
use crate::Error;

/// Axial forces of bolts against time, and of each segment.
#[derive(Debug)]
pub(super) struct Bolts;

/// Name of the table.
pub(super) const BOLTS: &str = "bolts";

impl OutputItem for Bolts {
    fn record(&self, site: &OutputSite, into: &mut Recorder) -> Result<(), Error> {
        if site.bolts.is_empty() {
            return Ok(());
        }
        let bolts = site.bolts.iter().copied();
        let histories = BoltHistories::new(site.cadence(), bolts).map_err(model)?;
        let form = TableForm::new(BOLTS, TablePlots::of_names("bolts-"), TablePeaks::All);
        let recording = histories.recording();
        into.table(form, recording.clone(), |tables| &tables.history);
        into.observe(histories);
        into.end(move |results| {
            let tables = recording.copy();
            // A run that failed at its start has no samples.
            let has_samples = !tables.history.times.is_empty();
            for peaks in tables.peaks.into_iter().filter(|_| has_samples) {
                let mut bolts = results.bolts.iter_mut();
                if let Some(bolts) = bolts.find(|bolts| bolts.name == peaks.name) {
                    bolts.greatest = Some(peaks.greatest);
                }
            }
        });
        for name in site.bolts.iter().map(|set| set.name().to_owned()) {
            into.list(
                format!("bolts/{}", file_name(&name)),
                None,
                move |results| {
                    let forces = results.bolts.iter().find(|bolts| bolts.name == name)?;
                    Some((forces.columns(), None))
                },
            );
        }
        Ok(())
    }
    fn price(&self, scale: &OutputScale) -> OutputPrice {
        scale.table(scale.bolts as f64, scale.plan.every)
    }
}

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

    /// Table of the segments: forces, and their greatest values over the run if there are any.
    pub fn columns(&self) -> Vec<TableColumn> {
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
