//! What a run has given.

use std::time::Duration;

use powerhouse_explicit_core::RunReport;
use powerhouse_explicit_core::observe::{
    CutSource, EnergyHistory, Envelope, EnvelopeTable, History, HistoryTable, Motion, PeakTable,
    Place, Recording, SectionForces, SectionGeometry, StressPlace,
};
use powerhouse_model::{Cadence, Mesh, ModelError, Observer};

use super::OutputPlan;
use crate::Error;

/// What a run has given.
#[derive(Clone, Debug)]
pub struct Results {
    /// Steps, step, end.
    pub run: RunReport,
    /// How long it took.
    pub wall_time: Duration,
    /// Histories and relative displacements.
    pub histories: HistoryTable,
    /// Section forces.
    pub sections: HistoryTable,
    /// Shapes of the sections.
    pub section_geometry: Vec<SectionGeometry>,
    /// The columns of the energy ledger.
    pub energies: HistoryTable,
    /// Greatest values.
    pub envelope: Option<EnvelopeTable>,
}

impl Results {
    /// The greatest values of all histories, section forces and envelopes.
    pub fn peaks(&self, mesh: &Mesh) -> PeakTable {
        let mut peaks = PeakTable::default();
        peaks.add_history(&self.histories);
        peaks.add_history(&self.sections);
        if let Some(envelope) = &self.envelope {
            peaks.add_envelope("envelope", envelope, mesh);
        }
        peaks
    }
}

/// What the observers of a plan collect.
pub(crate) struct Recordings {
    histories: Option<Recording<HistoryTable>>,
    sections: Option<Recording<HistoryTable>>,
    section_geometry: Vec<SectionGeometry>,
    energies: Option<Recording<HistoryTable>>,
    envelope: Option<Recording<EnvelopeTable>>,
}

impl Recordings {
    /// The observers of a plan, and where they put what they see.
    pub(crate) fn observe(
        plan: &OutputPlan,
        mesh: &Mesh,
        sources: &[CutSource],
    ) -> Result<(Self, Vec<Box<dyn Observer>>), Error> {
        let mut observers: Vec<Box<dyn Observer>> = Vec::new();
        let mut recordings = Self {
            histories: None,
            sections: None,
            section_geometry: Vec::new(),
            energies: None,
            envelope: None,
        };
        if !(plan.histories.is_empty() && plan.relative.is_empty()) {
            let history = histories(plan, mesh)?;
            recordings.histories = Some(history.recording());
            observers.push(Box::new(history));
        }
        if !plan.cuts.is_empty() {
            let mut forces = SectionForces::new(Cadence::Seconds(plan.every)).map_err(model)?;
            for wish in &plan.cuts {
                let set = mesh.element_set(&wish.set)?;
                let inside: Vec<Vec<u32>> = sources
                    .iter()
                    .map(|source| {
                        let of_set = |e: &u32| set.binary_search(e).is_ok();
                        source.elements.iter().copied().filter(of_set).collect()
                    })
                    .collect();
                let of_cut: Vec<CutSource> = sources
                    .iter()
                    .zip(&inside)
                    .filter(|(_, elements)| !elements.is_empty())
                    .map(|(source, elements)| CutSource {
                        elements,
                        ..*source
                    })
                    .collect();
                forces.add_cut(mesh, &wish.cut, &of_cut).map_err(model)?;
            }
            recordings.section_geometry = forces.geometries().cloned().collect();
            recordings.sections = Some(forces.recording());
            observers.push(Box::new(forces));
        }
        if let Some(every) = plan.energies {
            let energies = EnergyHistory::new(Cadence::Seconds(every)).map_err(model)?;
            recordings.energies = Some(energies.recording());
            observers.push(Box::new(energies));
        }
        if let Some(wish) = &plan.envelope {
            let mut elements = Vec::new();
            if wish.sets.is_empty() {
                elements.extend(0..mesh.element_count() as u32);
            }
            for set in &wish.sets {
                elements.extend_from_slice(mesh.element_set(set)?);
            }
            let nodes = mesh.nodes_of_elements(&elements);
            let stressed: &[u32] = if wish.stress { &elements } else { &[] };
            let cadence = Cadence::Seconds(wish.every);
            let envelope =
                Envelope::new(mesh, &nodes, wish.motion, stressed, cadence).map_err(model)?;
            recordings.envelope = Some(envelope.recording());
            observers.push(Box::new(envelope));
        }
        Ok((recordings, observers))
    }

    pub(crate) fn finish(self, run: RunReport, wall_time: Duration) -> Results {
        let table = |recording: Option<Recording<HistoryTable>>| {
            recording.map(|r| r.copy()).unwrap_or_default()
        };
        Results {
            run,
            wall_time,
            histories: table(self.histories),
            sections: table(self.sections),
            section_geometry: self.section_geometry,
            energies: table(self.energies),
            envelope: self.envelope.map(|recording| recording.copy()),
        }
    }
}

fn histories(plan: &OutputPlan, mesh: &Mesh) -> Result<History, Error> {
    let mut builder = History::builder(Cadence::Seconds(plan.every));
    for wish in &plan.histories {
        if wish.motion != Motion::default() {
            builder = builder.motion(&wish.name, wish.place.clone(), wish.motion);
        }
        if let (true, Place::Spot(spot)) = (wish.stress, &wish.place) {
            builder = builder.stress(&wish.name, StressPlace::Spot(spot.clone()));
        }
    }
    for wish in &plan.relative {
        let (from, at) = (wish.from.clone(), wish.at.clone());
        builder = builder.relative(&wish.name, from, at, Motion::DISPLACEMENT);
    }
    builder.build(mesh).map_err(model)
}

fn model(error: impl Into<ModelError>) -> Error {
    Error::Model(error.into())
}
