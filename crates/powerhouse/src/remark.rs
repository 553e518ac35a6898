//! What was found while a scene was composed.

use core::fmt;

use powerhouse_wavefield::{BaselineReport, QuietStart, RecordReport};

/// Something that a user should know of a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Remark {
    /// What became of a record.
    Record {
        /// Its name in the scene.
        name: String,
        /// Peaks and end values as it enters the wave.
        report: RecordReport,
        /// What the baseline correction did, before the record was scaled.
        baseline: Option<BaselineReport>,
    },
    /// A record's file was read otherwise than it declares.
    RecordFile {
        /// The record's name in the scene.
        name: String,
        /// What was taken differently.
        doubt: String,
    },
    /// A wave was delayed and tapered so that the body may start at rest.
    QuietStart {
        /// The field's name.
        wave: String,
        /// What it took.
        start: QuietStart,
    },
    /// A full space without an absorbing boundary on top, where the stress of its waves does not
    /// vanish.
    OpenTop,
    /// A damped part touches an absorbing face, behind which the free field is elastic.
    DampedRim {
        /// The part's set.
        set: String,
    },
}

impl Remark {
    /// Whether it is a doubt about the result, not only a fact.
    pub fn is_warning(&self) -> bool {
        match self {
            Self::DampedRim { .. } | Self::RecordFile { .. } | Self::OpenTop => true,
            Self::Record { .. } | Self::QuietStart { .. } => false,
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Record {
                name,
                report,
                baseline,
            } => {
                write!(
                    f,
                    "record '{name}': PGA {:.3} m/s2, PGV {:.4} m/s, PGD {:.4} m; ends at {:.2e} m/s, {:.2e} m",
                    report.peak_acceleration,
                    report.peak_velocity,
                    report.peak_displacement,
                    report.end_velocity,
                    report.end_displacement
                )?;
                if let Some(baseline) = baseline {
                    write!(
                        f,
                        "; baseline {} took at most {:.2e} m/s2 from it, it had ended at {:.2e} m/s, {:.2e} m",
                        baseline.correction.name(),
                        baseline.largest_change,
                        baseline.before.end_velocity,
                        baseline.before.end_displacement
                    )?;
                }
                Ok(())
            }
            Self::RecordFile { name, doubt } => write!(f, "record '{name}': {doubt}"),
            Self::QuietStart { wave, start } => write!(
                f,
                "{wave}: arrives {:.3} s later so that the body may start at rest; the field then stands at {:.1e} of its peak, {:.1e} of it was tapered away",
                start.padding,
                start.level.largest(),
                start.removed
            ),
            Self::OpenTop => write!(
                f,
                "the waves travel in a full space, but the top of the mesh has no absorbing boundary: their stress does not vanish there"
            ),
            Self::DampedRim { set } => write!(
                f,
                "part '{set}' is damped and touches an absorbing face: the free field is elastic, so its waves are reflected there in part; leave an undamped rim"
            ),
        }
    }
}
