//! State of a static solution between two load increments, or between two steps of a dynamic relaxation.

use std::sync::Arc;

use powerhouse_model::{
    CheckpointSink, JointHistory, Progress, SavedRun, StateError, StaticError, StaticReport, Vec3,
    encode,
};
use serde::{Deserialize, Serialize};

use crate::Model;
use crate::saved::{Sections, add};

/// Section of the state of the solution itself.
const STATICS: &str = "statics";

/// State of a dynamic relaxation between two steps.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SavedRelaxation {
    /// State of the joints at the start of the increment.
    pub(super) before: Vec<JointHistory>,
    /// Displacement (m) and velocity (m/s).
    pub(super) u: Vec<Vec3>,
    pub(super) velocity: Vec<Vec3>,
    /// Unbalanced forces (N) of the step before, if it moved the body.
    pub(super) last: Option<Vec<Vec3>>,
    pub(super) damping: f64,
    pub(super) step: u32,
    pub(super) is_still: bool,
}

/// State of a static solution; blocks and constraints have sections of their own.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SavedStatics {
    precision: u8,
    /// Fingerprint of the partition of the elements into blocks.
    partition: u64,
    pub(super) position: Position,
    pub(super) relaxation: Option<SavedRelaxation>,
}

/// Position of a static solution: load factor reached, length of the next increment, displacement (m) there, and report.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Position {
    pub(super) done: f64,
    pub(super) share: f64,
    pub(super) u: Vec<Vec3>,
    pub(super) report: StaticReport,
}

/// Receiver of the states of a static solution, with the position that they have in common.
pub(super) struct Checkpoints<'a> {
    pub(super) sink: Option<&'a Arc<dyn CheckpointSink>>,
    pub(super) position: Position,
    /// Largest number of steps of a dynamic relaxation.
    pub(super) most_steps: u32,
}

impl Checkpoints<'_> {
    /// Saves the state if the receiver asks for one, or the solution is about to be cancelled.
    pub(super) fn take(
        &self,
        model: &Model,
        report: &StaticReport,
        relaxation: impl FnOnce() -> Option<SavedRelaxation>,
    ) -> Result<(), StaticError> {
        let Some(sink) = self.sink else {
            return Ok(());
        };
        let done = self.position.done;
        let progress = Progress::new(report.steps, self.most_steps.into(), done);
        if !model.is_stopped() && !sink.is_due(&progress) {
            return Ok(());
        }
        let mut saved = SavedRun::new(report.steps, done, 0.0);
        let statics = SavedStatics {
            precision: model.precision_number(),
            partition: model.partition().fingerprint(&model.mesh),
            position: Position {
                report: *report,
                ..self.position.clone()
            },
            relaxation: relaxation(),
        };
        add(&mut saved, STATICS.into(), encode(&statics))?;
        model.save_parts(&mut saved)?;
        sink.take(saved).map_err(|error| StaticError::Checkpoint {
            reason: error.to_string(),
        })
    }
}

impl SavedStatics {
    /// Restores the states of blocks and constraints; returns the state of the solution of an equal model.
    pub(super) fn restore(saved: &SavedRun, model: &mut Model) -> Result<Self, StaticError> {
        let mut sections = Sections::of(saved);
        let statics: Self = sections.decode(STATICS)?;
        let expected = model.partition().fingerprint(&model.mesh);
        let same =
            StateError::expect_same("the precision", statics.precision, model.precision_number());
        let same = same.and_then(|()| {
            let what = "the fingerprint of the blocks of elements";
            StateError::expect_same(what, statics.partition, expected)
        });
        let same = same.and_then(|()| {
            let found = statics.position.u.len();
            StateError::expect_same("the number of nodes", found, model.mass.len())
        });
        same.map_err(|source| StaticError::State {
            part: STATICS.into(),
            source,
        })?;
        model.restore_parts(&mut sections)?;
        Ok(statics)
    }
}
