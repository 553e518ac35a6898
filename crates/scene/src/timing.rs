//! Start and duration of the dynamic run of a scene.

use crate::{InitialMotion, Remark, Scene};

impl Scene {
    /// Sets the duration of the dynamic run (s), above 0. The remark that the duration before ends within the strong
    /// motion of a record is gone, and not replaced by one about the new duration.
    #[must_use]
    pub fn with_duration(mut self, duration: f64) -> Self {
        self.duration = duration;
        let is_of_duration = |remark: &Remark| matches!(remark, Remark::TruncatedRecord(_));
        self.remarks.retain(|remark| !is_of_duration(remark));
        self
    }
    /// Sets the time at which the dynamic run starts (s); arrival times of waves are not shifted.
    #[must_use]
    pub fn with_start_time(mut self, time: f64) -> Self {
        self.start = time;
        self
    }
    /// Sets the motion of the body at the start of the run: rest, or that of the incident field (not with stages).
    #[must_use]
    pub fn with_initial_motion(mut self, motion: InitialMotion) -> Self {
        self.initial = motion;
        self
    }
}
