//! What a run will cost.

use std::time::Duration;

use powerhouse::OutputPlan;
use powerhouse::engine::observe::Motion;
use powerhouse::model::Mesh;

/// What a run will cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// Steps.
    pub steps: u64,
    /// Length of a step (s).
    pub step: f64,
    /// Wall time, from some steps that were timed; without output.
    pub wall_time: Duration,
    /// Memory (bytes), within a third.
    pub memory: u64,
    /// Files (bytes), at most.
    pub output: u64,
}

/// Bytes per node: position, displacement, velocity and forces (32 each), mass, numbers.
const NODE_BYTES: u64 = 260;
/// Bytes per element: geometry, connectivity, masses, tags and sets.
const ELEMENT_BYTES: u64 = 700;
/// Bytes of a program that does nothing yet.
const BASE_BYTES: u64 = 12 << 20;

/// Memory of a model in double precision (bytes).
pub(crate) fn memory(mesh: &Mesh) -> u64 {
    BASE_BYTES + NODE_BYTES * mesh.node_count() as u64 + ELEMENT_BYTES * mesh.element_count() as u64
}

/// Size of the files of a plan over a duration (s), in bytes.
pub(crate) fn output(plan: &OutputPlan, mesh: &Mesh, duration: f64) -> u64 {
    /// Of a number in a CSV file.
    const NUMBER: u64 = 23;
    let (nodes, elements) = (mesh.node_count() as u64, mesh.element_count() as u64);
    let rows = |every: f64| (duration / every).ceil() as u64 + 2;
    let vectors = |motion: Motion| {
        [motion.displacement, motion.velocity, motion.acceleration]
            .iter()
            .filter(|wanted| **wanted)
            .count() as u64
    };
    let columns: u64 = plan
        .histories
        .iter()
        .map(|wish| 3 * vectors(wish.motion))
        .sum();
    let columns = columns
        + 9 * plan.stresses.len() as u64
        + 4 * plan.relative.len() as u64
        + 9 * plan.cuts.len() as u64;
    let mut bytes = columns * rows(plan.every) * NUMBER;
    // What does not change is in every file too: positions, numbers, connectivity, sets.
    let fixed = 16 * nodes + elements * (20 + mesh.element_sets().len() as u64 / 8);
    if let Some(snapshots) = &plan.snapshots {
        let stress = if snapshots.fields.stress {
            24 * elements
        } else {
            0
        };
        let one = fixed + 12 * vectors(snapshots.fields.motion) * nodes + stress;
        bytes += one * rows(snapshots.every);
    }
    if let Some(envelope) = &plan.envelope {
        let stress = if envelope.stress { 16 * elements } else { 0 };
        bytes += fixed + 8 * vectors(envelope.motion) * nodes + stress;
    }
    bytes
}
