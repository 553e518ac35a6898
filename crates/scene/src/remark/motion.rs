//! Remarks about waves and prescribed motions.

use powerhouse_wavefield::LayeredReport;

use super::{Item, Kind};
use crate::Topic;

remark! {
    /// Fact: an SV wave is past the critical angle.
    pub struct PastCritical {
        /// Name of the wave.
        pub wave: String,
        /// Critical angle (degrees).
        pub critical: f64,
        /// Largest displacement that a taper removed from the start of the field, over its peak; none without taper.
        pub removed: Option<f64>,
    }
    Fact(Input),
    "{wave} is past the critical angle of {critical:.2} degrees (asin of the speed of S waves over that of P waves): the reflected P wave travels along the surface and decays with depth, and the ground moves before the incident wave arrives{}",
    removed.map_or_else(String::new, |removed| format!(
        "; a taper removes the beginning of this motion, so that the body starts at rest: the input differs from the record by {:.1} % of its peak displacement",
        100.0 * removed
    ))
}

/// Fact: a wave travels in layered ground, whose motion is kept in tables of height and time.
#[derive(Clone, Debug, PartialEq)]
pub struct Layered {
    /// Name of the wave.
    pub wave: String,
    /// Form of the field.
    pub report: LayeredReport,
    /// Memory of the field (bytes): before the scene is prepared, of tables at the heights of the absorbing faces, at most;
    /// then of all that were made.
    pub bytes: usize,
}

impl Item for Layered {
    fn kind(&self) -> Kind {
        Kind::Fact(Topic::Input)
    }
    fn text(&self) -> String {
        let (wave, tables) = (&self.wave, &self.report.tables);
        let megabytes = self.bytes as f64 / 1e6;
        let mut text = format!(
            "{wave}: tables of the motion at {} heights, every {:.3e} s, and its spectra take {megabytes:.1} MB",
            tables.heights, self.report.step
        );
        if let Some((heights, [displacement, velocity, stress])) = tables.between_heights {
            text += &format!(
                "; they are at {heights} heights, between which cubics err by at most {displacement:.1e} of the peak displacement, {velocity:.1e} of the peak velocity and {stress:.1e} of the peak stress"
            );
        }
        if !self.report.causal {
            text += "; waves decay with depth in the half-space or in a layer, and the ground moves before the incident wave arrives";
        }
        text
    }
}

/// Fact: all waves were delayed by the same time, and those past the critical angle tapered, so that the body
/// starts at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct QuietStart {
    /// Delay of all waves (s).
    pub padding: f64,
    /// Names of the waves that are not below 1e-4 of their peak at the start, with the delay of each alone.
    pub waves: Vec<(String, powerhouse_wavefield::QuietStart)>,
}

impl Item for QuietStart {
    fn kind(&self) -> Kind {
        Kind::Fact(Topic::Run)
    }
    fn text(&self) -> String {
        let mut text = format!(
            "all waves are delayed by {:.3} s so that the body starts at rest; the duration is unchanged",
            self.padding
        );
        for (wave, start) in &self.waves {
            text += &format!(
                "; {wave} needs {:.3} s, starts with at most {:.1e} of its peak, and a taper removed {:.1e} of the peak",
                start.padding,
                start.level.largest(),
                start.removed
            );
        }
        text
    }
}

/// Fact: the records of prescribed motions were delayed by the same time, so that the body starts at rest; a
/// warning if the waves have another delay.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayedMotion {
    /// Delay of all prescribed motions (s).
    pub padding: f64,
    /// Records that needed a delay, with their motion at the start of the run over its peak: the larger ratio
    /// of displacement and velocity.
    pub records: Vec<(String, f64)>,
    /// Delay of the waves of the scene (s), if there are any.
    pub waves: Option<f64>,
}

impl DelayedMotion {
    /// Delay of the waves (s), if it is another one.
    fn other_delay(&self) -> Option<f64> {
        self.waves.filter(|waves| *waves != self.padding)
    }
}

impl Item for DelayedMotion {
    fn kind(&self) -> Kind {
        Kind::warning_if(self.other_delay().is_some(), Topic::Input)
    }
    fn text(&self) -> String {
        let mut text = format!(
            "prescribed motions are delayed by {:.3} s so that the body starts at rest; the duration is unchanged",
            self.padding
        );
        for (name, level) in &self.records {
            text += &format!(
                "; record '{name}', extended by its filter, would be at {level:.1e} of its peak at the start of the run"
            );
        }
        if let Some(waves) = self.other_delay() {
            text += &format!(
                "; the waves are delayed by {waves:.3} s, so that the two are no longer synchronous"
            );
        }
        text
    }
}

remark! {
    /// Warning: a prescribed displacement is not that of the body at rest when the run begins.
    pub struct PrescribedJump {
        /// Number of nodes.
        pub nodes: usize,
        /// Number of the first of them.
        pub node: u64,
        /// Displacement at the start (m).
        pub displacement: f64,
    }
    Warning(Input),
    "the displacement prescribed at {nodes} nodes (the first is {node}) jumps by {displacement:.3e} m when the run begins: the first time step covers it, an impact whose stress grows as the step shortens; let it begin at zero, such as by `function = {{ kind = \"ramp\", duration = ... }}`"
}

remark! {
    /// Warning: a prescribed displacement begins with a velocity.
    pub struct PrescribedVelocity {
        /// Number of nodes.
        pub nodes: usize,
        /// Number of the first of them.
        pub node: u64,
        /// Velocity at the start (m/s).
        pub velocity: f64,
        /// That velocity over the greatest of the run (1).
        pub share: f64,
    }
    Warning(Input),
    "the velocity prescribed at {nodes} nodes (the first is {node}) jumps by {velocity:.3e} m/s when the run begins, {:.0} % of its greatest: a front of stress, impedance times this velocity, with frequencies above those that the mesh carries; let it begin with a horizontal tangent, such as by a `table`",
    100.0 * share
}
