//! Fields over the body: envelopes, history variables and snapshots.

use powerhouse_model::{Cadence, HistoryKind};
use powerhouse_observe::Envelope;

use super::item::vectors;
use super::{OutputItem, OutputPrice, OutputScale, OutputSite, Recorder, model};
use crate::Error;

/// Envelopes of motion and principal stresses.
#[derive(Debug)]
pub(super) struct Envelopes;

/// Envelopes of the history variables of laws.
#[derive(Debug)]
pub(super) struct StateEnvelopes;

/// Snapshots of the body and the facets of joints.
#[derive(Debug)]
pub(super) struct SnapshotFiles;

/// Bytes of a picture, and of the canvas on which it is drawn.
const PICTURE_BYTES: f64 = 4e5;
const CANVAS_BYTES: f64 = 32e6;

impl OutputItem for Envelopes {
    fn record(&self, site: &OutputSite, into: &mut Recorder) -> Result<(), Error> {
        let (mesh, plan) = (site.mesh, site.plan);
        let Some(request) = &plan.envelope else {
            return Ok(());
        };
        let mut elements = Vec::new();
        if request.sets.is_empty() {
            elements.extend(0..mesh.element_count() as u32);
        }
        for set in &request.sets {
            elements.extend_from_slice(mesh.element_set(set)?);
        }
        let nodes = mesh.nodes_of_elements(&elements);
        let stressed: &[u32] = if request.stress { &elements } else { &[] };
        let cadence = Cadence::Seconds(request.every);
        let envelope =
            Envelope::new(mesh, &nodes, request.motion, stressed, cadence).map_err(model)?;
        let envelope = envelope.accelerations(plan.accelerations);
        let recording = envelope.recording();
        into.observe(envelope);
        into.end(move |results| results.envelope = Some(recording.copy()));
        Ok(())
    }
    fn price(&self, scale: &OutputScale) -> OutputPrice {
        let Some(request) = &scale.plan.envelope else {
            return OutputPrice::default();
        };
        let [nodes, elements] = scale.counts();
        let motions = vectors(request.motion);
        let stresses = if request.stress { 2.0 } else { 0.0 };
        let values = motions * nodes + stresses * elements;
        // A peak and its time, for each quantity.
        OutputPrice {
            memory: 16.0 * values + CANVAS_BYTES,
            files: scale.bytes_of_body() + 8.0 * values + PICTURE_BYTES * (motions + stresses),
        }
    }
}

impl OutputItem for StateEnvelopes {
    fn record(&self, site: &OutputSite, into: &mut Recorder) -> Result<(), Error> {
        if let Some(peaks) = site.state_variables.peaks(site.plan, site.mesh)? {
            let recording = peaks.recording();
            into.observe(peaks);
            into.end(move |results| results.state = Some(recording.copy()));
        }
        Ok(())
    }
    fn price(&self, scale: &OutputScale) -> OutputPrice {
        if scale.laws.variables.is_empty() {
            return OutputPrice::default();
        }
        let [amounts, flags] =
            [HistoryKind::Amount, HistoryKind::Flags].map(|kind| scale.variables(kind));
        let [_, elements] = scale.counts();
        // With the copies while they are written and drawn.
        OutputPrice {
            memory: (32.0 * amounts + 16.0 * flags) * scale.laws.elements as f64,
            files: scale.bytes_of_body()
                + (8.0 * amounts + 4.0 * flags) * elements
                + PICTURE_BYTES * amounts,
        }
    }
}

/// Numbers of fields at a corner of the facets of joints in a snapshot.
const JOINT_FIELDS: f64 = 12.0;

impl OutputItem for SnapshotFiles {
    /// None: their observer has the receiver of the run.
    fn record(&self, _site: &OutputSite, _into: &mut Recorder) -> Result<(), Error> {
        Ok(())
    }
    fn price(&self, scale: &OutputScale) -> OutputPrice {
        let Some(request) = &scale.plan.snapshots else {
            return OutputPrice::default();
        };
        let [nodes, elements] = scale.counts();
        let mut of_element = if request.fields.stress { 24.0 } else { 0.0 };
        if scale.plan.state.snapshots {
            of_element += 4.0 * scale.laws.variables.len() as f64;
        }
        let each = scale.bytes_of_body()
            + 12.0 * vectors(request.fields.motion) * nodes
            + of_element * elements
            + scale.bytes_of_facets(JOINT_FIELDS);
        OutputPrice {
            memory: 0.0,
            files: each * scale.rows(request.every),
        }
    }
}
