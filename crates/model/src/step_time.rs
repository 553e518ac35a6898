//! The time step that a computation belongs to.

/// Number, start time (s) and length (s) of a time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTime {
    /// Number of the step, counted from 0.
    pub number: u64,
    /// Time at the start of the step (s).
    pub time: f64,
    /// Length of the step (s).
    pub step: f64,
}
