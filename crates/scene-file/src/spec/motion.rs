//! Recorded motion of three components, and the waves of which it is the sum.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{At, Azimuth, Component, Finite, Incidence, Positive};

/// Recorded motion of up to three components at one point of the site: it is split into incident P, SV and SH waves whose
/// sum is the record at that point. Their motions are superposed with those of other motions and waves.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Name of a record with components, which are motions along the axes x, y and z of the mesh. Its convention is
    /// `surface`, `outcrop` (the free surface of the half-space without layers), or `within` with a depth alone.
    pub record: At<String>,
    /// Components that move; all of `["x", "y", "z"]` by default. One that is left out does not move.
    pub components: Option<At<Vec<Component>>>,
    /// Angles of incidence of the waves from the vertical, in the half-space (degrees).
    pub incidence: At<MotionIncidence>,
    /// Azimuth of all waves: horizontal direction of travel, from +x towards +y (degrees), -360 to 360, 0 by default.
    pub azimuth: Option<Azimuth>,
    /// Horizontal coordinates x and y of the record's point (m); those of the middle of the mesh by default.
    pub at: Option<At<[Finite; 2]>>,
    /// Frequency band (Hz), the lower frequency first, in which the condition number of the split must not be above 20;
    /// 0.1 to 15 by default.
    pub band: Option<At<[Positive; 2]>>,
    /// Time at which the record begins at its point (s); by default as early as lets the first wave reach the body at
    /// the start of the run.
    pub arrival: Option<At<Finite>>,
    /// Factor on the motion (dimensionless), 1 by default.
    pub factor: Option<Finite>,
}

/// Angles of incidence of the waves that a motion is split into. P and SV are given together, if the motion has a component along
/// the direction of travel or upwards; SH if it has one across it.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct MotionIncidence {
    /// Angle of incidence of P waves (degrees), below 90.
    pub p: Option<Incidence>,
    /// Angle of incidence of SV waves (degrees), below the critical angle.
    pub sv: Option<Incidence>,
    /// Angle of incidence of SH waves (degrees), below 90.
    pub sh: Option<Incidence>,
}
