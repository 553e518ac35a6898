//! Duration, time step, integration scheme and precision.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{At, Fibres, Finite, InitialMotion, Positive, Share, is_default};
use powerhouse_model::keys::words_or_number;

/// Time integration of the dynamic run: duration, start, step and scheme.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Duration of the run (s), above 0.
    pub duration: Positive,
    /// Start time of the run (s), 0 by default; it does not shift the arrival times of waves.
    pub start: Option<At<Finite>>,
    /// Initial motion of the body: `rest` (the default) or `field`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub initial: At<InitialMotion>,
    /// Time step: `"auto"` (the stable step times `safety`; the default) or a number above 0 (s). A number above
    /// the stable step is an error.
    #[serde(default, skip_serializing_if = "is_default")]
    pub step: At<Step>,
    /// Factor on the stable step for `"auto"`, above 0 and at most 1, 1 by default; the stable step is a safe
    /// estimate already.
    pub safety: Option<Share>,
    /// Fibres: added inertia of the motion across thin parts, for a longer step; weight and static solutions do not know it.
    /// `"none"` (the default), the requested factor on the stable step in all parts that are thinner than a fifth of the
    /// shortest wavelength that their mesh resolves, or `{ factor = 2, sets = ["lining"] }`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub fibres: At<Fibres>,
    /// Largest permitted decrease of a frequency as high as that of the input by fibres, above 0 and at most 1, 0.01 by
    /// default: more, as estimated before the run, is an error.
    pub fibre_shift: Option<Share>,
    /// Integration scheme: `leapfrog` (the default) or `one-sided`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub scheme: At<Scheme>,
}

/// Time step of the dynamic run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Step {
    /// Stable step times the safety factor.
    #[default]
    Auto,
    /// Given step (s), above 0.
    Seconds(f64),
}

words_or_number! {
    Step { "auto" => Auto, number => Seconds }
    "\"auto\" or a number of seconds above 0", |x| x > 0.0, { "type": "number", "exclusiveMinimum": 0 }
}

/// Time integration scheme.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Central difference method in leapfrog form, with implicit dashpots.
    #[default]
    Leapfrog,
    /// Explicit scheme with one-sided velocity of Wang, Chen & Xiao (2019), Eqs. (14)-(17). An error unless the
    /// stiffness damping coefficient is at least half a step.
    OneSided,
}
