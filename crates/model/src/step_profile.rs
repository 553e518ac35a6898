//! Wall time of the parts of time steps.

/// Wall time of one part of the time steps of a run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ProfileRow {
    /// Part of the step, such as `elements of 'rock': law`, `joint 'rock-lining'` or `nodes`.
    pub part: String,
    /// Wall time (s) of all steps. Of work that several threads share, it is the wall time times the share of the
    /// processor time.
    pub seconds: f64,
}

impl ProfileRow {
    /// A row of a part and its wall time (s).
    pub fn new(part: impl Into<String>, seconds: f64) -> Self {
        Self {
            part: part.into(),
            seconds,
        }
    }
}

/// Profile of the time steps of a run: the wall time of their parts, measured in the run itself.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StepProfile {
    /// Number of steps.
    pub steps: u64,
    /// Wall time (s) of all steps, without the extra evaluations by which the parts of elements were separated.
    pub seconds: f64,
    /// Parts in falling order of their time.
    pub rows: Vec<ProfileRow>,
}

impl StepProfile {
    /// A profile of some steps with a wall time (s), and its rows in falling order.
    pub fn new(steps: u64, seconds: f64, mut rows: Vec<ProfileRow>) -> Self {
        rows.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        Self {
            steps,
            seconds,
            rows,
        }
    }
    /// Sum of the rows over the wall time of the steps: one if no part was missed or counted twice.
    pub fn covered(&self) -> f64 {
        let sum: f64 = self.rows.iter().map(|row| row.seconds).sum();
        if self.seconds > 0.0 {
            sum / self.seconds
        } else {
            1.0
        }
    }
}
