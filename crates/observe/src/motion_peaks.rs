//! Peaks of motions between the rows of their histories.

use powerhouse_model::{Cadence, Fields, Flow, ModelError, Observer, Reach, Selection, StepView};

use super::history::Channel;
use super::place::Probe;
use super::{HistoryTable, Recording};

/// Observer that raises the [peaks](super::Column::peak) of the motions of a [`History`](super::History) in every step that
/// the host takes, so that they do not depend on the interval of its rows; of mean accelerations those of the
/// [instants](super::Column::instant_peak).
///
/// It reads the motion of the nodes of these histories alone, and has no results of its own: the peaks are those of the
/// history's table.
pub struct MotionPeaks {
    /// Motions, each with the index of its first column.
    motions: Vec<(Channel, usize)>,
    probes: Vec<Probe>,
    row: Vec<f64>,
    recording: Recording<HistoryTable>,
}

impl MotionPeaks {
    pub(super) fn new(
        motions: Vec<(Channel, usize)>,
        probes: Vec<Probe>,
        recording: Recording<HistoryTable>,
    ) -> Self {
        Self {
            motions,
            probes,
            row: Vec::new(),
            recording,
        }
    }
    pub(super) fn is_empty(&self) -> bool {
        self.motions.is_empty()
    }
}

impl Observer for MotionPeaks {
    fn name(&self) -> &str {
        "peaks of motions"
    }
    fn fields(&self) -> Fields {
        let mut motions = self.motions.iter();
        Fields::default()
            .with_acceleration(motions.any(|(channel, _)| channel.motion().acceleration))
    }
    fn reach(&self) -> Reach {
        let nodes = self.probes.iter().flat_map(Probe::nodes);
        Reach::NONE.with_nodes(Selection::These(nodes.collect()))
    }
    fn cadence(&self) -> Cadence {
        Cadence::HostSteps
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let time = view.time();
        let mut table = self.recording.lock();
        for (channel, first) in &self.motions {
            self.row.clear();
            channel.push_motion(&self.probes, view, &mut self.row);
            for (column, &value) in table.columns[*first..].iter_mut().zip(&self.row) {
                column.raise_in_step(value, time);
            }
        }
        Ok(Flow::Continue)
    }
}
