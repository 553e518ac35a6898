//! What a case is a case of.

use powerhouse::InputOverview;
use powerhouse::wavefield::WaveKind;
use serde::{Deserialize, Serialize};

/// A wave of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseWave {
    /// `sv`, `sh` or `p`.
    pub kind: String,
    /// Angle of incidence from the vertical (degrees).
    pub incidence: f64,
    /// Direction of travel from +x towards +y (degrees).
    pub azimuth: f64,
    /// What moves it: its record and component, or its pulse.
    pub motion: String,
    /// By what that is multiplied.
    pub factor: f64,
}

impl CaseWave {
    /// Whether it comes in as another one, whatever moves them.
    pub(crate) fn arrives_as(&self, other: &Self) -> bool {
        let of = |wave: &Self| (wave.kind.clone(), wave.incidence, wave.azimuth);
        of(self) == of(other)
    }
}

/// What comes in, and what a case varies: by this reports tell cases apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseInput {
    /// Its waves.
    pub waves: Vec<CaseWave>,
    /// The one choice by which it differs from the case that it is compared with.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub varies: Option<String>,
    /// Whether it has some of the scene's joints no more.
    pub continuous: bool,
}

impl CaseInput {
    /// The input of a scene that is already as the case has it.
    pub(super) fn of(input: &InputOverview) -> Self {
        let waves = input.waves.iter().map(|wave| CaseWave {
            kind: match wave.kind {
                WaveKind::P => "p",
                WaveKind::SV => "sv",
                WaveKind::SH => "sh",
            }
            .into(),
            incidence: wave.incidence,
            azimuth: wave.azimuth,
            motion: wave.motion.clone(),
            factor: wave.factor,
        });
        Self {
            waves: waves.collect(),
            varies: input.varies.clone(),
            continuous: input.continuous,
        }
    }

    /// The kind and the angle (degrees) of the one wave that comes in along x; none if there are others.
    pub fn wave(&self) -> Option<(&str, f64)> {
        match &self.waves[..] {
            [wave] if wave.azimuth == 0.0 => Some((&wave.kind, wave.incidence)),
            _ => None,
        }
    }
}
