//! Remarks about histories and the intervals of outputs.

use super::{Item, Kind};
use crate::Topic;

remark! {
    /// Warning: a history requests the history variables of an element whose law has none, and records nothing.
    pub struct NoState {
        /// Name of the history.
        pub name: String,
        /// Number of the element in the mesh file.
        pub element: u64,
    }
    Warning(Histories),
    "history '{name}' requests the state of element {element}, whose law has no history variables"
}

remark! {
    /// Warning: a relative displacement is that of two places at different y of a bay with delayed ends, each at a time of its own.
    pub struct RelativeInBay {
        /// Name of the request.
        pub name: String,
        /// Distance along y of the place from the other one (m).
        pub apart: f64,
        /// Time by which the motion of the place is that of later waves than the motion of the other one (s).
        pub delay: f64,
    }
    Warning(Histories),
    "the relative displacement '{name}' is that of two places {:.3} m apart along y in a bay with delayed ends, each at its own time, {:.3} ms apart: it lacks what the waves between the two times add, up to {:.3e} s times the velocity, and between the two ends it is zero; take places at one y, or histories of both, of which the one at the larger y is shifted {} by that time",
    apart.abs(),
    1e3 * delay.abs(),
    delay.abs(),
    if delay * apart < 0.0 { "earlier" } else { "later" }
}

/// Warning after the run: the sampling interval of an acceleration history is too long for its frequencies: fewer than
/// about six samples per period around its peak, or samples that miss a twentieth of the greatest band-limited acceleration, of
/// instants that of all steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Undersampled {
    /// Name of the history.
    pub name: String,
    /// Mean sampling interval (s).
    pub interval: f64,
    /// Band (Hz) of the accelerations from which peaks and spectra are; none if they are from these samples.
    pub band: Option<f64>,
}

impl Item for Undersampled {
    fn kind(&self) -> Kind {
        Kind::Warning(Topic::Histories)
    }
    fn text(&self) -> String {
        let (name, interval) = (&self.name, self.interval);
        match self.band {
            Some(band) => format!(
                "the acceleration of '{name}' has frequencies above those that its means over {interval} s show, as when cracks open or close: spectra, intensities and peaks of the rows of histories.csv are wrong; those of accelerations.csv, from which plots and reports are, hold up to {band} Hz (a shorter `every` shows more)"
            ),
            None => format!(
                "the acceleration of '{name}' has frequencies above those that samples every {interval} s resolve, as when cracks open or close: around its peak they change by more than its own size, or miss it; spectra, Fourier amplitudes and intensities of these samples are aliased, and may be wrong by more than a factor of ten (`band = 100` in [output], with `acceleration = \"mean\"`, records what they can be computed from)"
            ),
        }
    }
}

remark! {
    /// Warning after the run: the sampling interval of an acceleration envelope is too long, so that peaks are missed:
    /// every second sample has less than 0.9 of its greatest acceleration.
    pub struct SparseEnvelope {
        /// Greatest acceleration of every second sample over that of all samples (1).
        pub share: f64,
    }
    Warning(Histories),
    "every second sample of the envelope gives only {:.0} % of its greatest acceleration: its sampling interval is too long and misses peaks; reduce it (`every`)",
    100.0 * share
}

remark! {
    /// Warning: the requested sampling interval of an output is shorter than the time step, so that every step is recorded;
    /// found when the step of the run is determined.
    pub struct ShortInterval {
        /// Kind of output: `histories`, `energies`, `envelopes` or `snapshots`.
        pub what: &'static str,
        /// Requested interval (s).
        pub interval: f64,
        /// Time step (s).
        pub step: f64,
    }
    Warning(Histories),
    "{what} are requested every {interval} s, which is shorter than the time step of {step:.3e} s: they are recorded at every step"
}

remark! {
    /// Warning: the requested sampling interval of an output is longer than the run, so that its start and end alone are
    /// recorded; found when the step of the run is determined.
    pub struct LongInterval {
        /// Kind of output: `histories`, `energies`, `envelopes` or `snapshots`.
        pub what: &'static str,
        /// Requested interval (s).
        pub interval: f64,
        /// Duration of the run (s).
        pub duration: f64,
    }
    Warning(Histories),
    "{what} are requested every {interval} s, which is longer than the run of {duration} s: they are recorded at its start and end only"
}
