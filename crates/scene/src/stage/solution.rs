//! State of the static solution of a construction stage, from which it is resumed.

use std::sync::Arc;

use powerhouse_model::{CheckpointSink, ModelError, ModelSpec, Progress, SavedRun};

/// State of the static solution of a construction stage between two load increments, or between two steps of a dynamic
/// relaxation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StageSolution {
    /// Index of the stage, from zero.
    pub stage: usize,
    /// State of the solution.
    pub saved: Arc<SavedRun>,
}

impl StageSolution {
    /// State of the solution of a stage, by its index.
    pub fn new(stage: usize, saved: Arc<SavedRun>) -> Self {
        Self { stage, saved }
    }
}

/// Receiver of the states of the static solutions of construction stages, such as a writer of checkpoint files.
pub trait StageCheckpointSink: Send + Sync + core::fmt::Debug {
    /// Whether the present state is to be saved; called between load increments, and between the steps of a dynamic
    /// relaxation, which `progress` counts.
    fn is_due(&self, progress: &Progress) -> bool;
    /// Processes a state.
    ///
    /// # Errors
    /// Any error, which ends the run.
    fn take(&self, solution: StageSolution) -> Result<(), ModelError>;
}

/// Receiver of the states of one stage.
#[derive(Debug)]
struct OfStage {
    stage: usize,
    sink: Arc<dyn StageCheckpointSink>,
}

impl CheckpointSink for OfStage {
    fn is_due(&self, progress: &Progress) -> bool {
        self.sink.is_due(progress)
    }
    fn take(&self, saved: SavedRun) -> Result<(), ModelError> {
        let solution = StageSolution::new(self.stage, Arc::new(saved));
        self.sink.take(solution)
    }
}

/// Receiver of the states of static solutions, and the state from which the first one goes on.
#[derive(Clone, Debug, Default)]
pub(crate) struct SolutionStates {
    pub(crate) sink: Option<Arc<dyn StageCheckpointSink>>,
    pub(crate) resume: Option<StageSolution>,
}

impl SolutionStates {
    /// Adds them to the specification of the model of a stage.
    pub(super) fn of_stage<'a>(&self, stage: usize, mut spec: ModelSpec<'a>) -> ModelSpec<'a> {
        if let Some(sink) = self.sink.clone() {
            spec = spec.static_checkpoints(Arc::new(OfStage { stage, sink }));
        }
        match &self.resume {
            Some(solution) if solution.stage == stage => {
                spec.resume_statics(solution.saved.clone())
            }
            _ => spec,
        }
    }
}
