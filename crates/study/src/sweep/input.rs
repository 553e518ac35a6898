//! Input of a case.

use powerhouse::InputOverview;
use powerhouse::wavefield::WaveKind;
use serde::{Deserialize, Serialize};

/// Incident wave of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseWave {
    /// Wave type: `sv`, `sh` or `p`.
    pub kind: String,
    /// Angle of incidence from the vertical (degrees).
    pub incidence: f64,
    /// Azimuth of the direction of travel, from +x towards +y (degrees).
    pub azimuth: f64,
    /// Description of the motion: record and component, or pulse.
    pub motion: String,
    /// Factor on the motion (1).
    pub factor: f64,
}

impl CaseWave {
    /// Whether another wave has the same type and direction, with any motion.
    pub fn arrives_as(&self, other: &Self) -> bool {
        let of = |wave: &Self| (wave.kind.clone(), wave.incidence, wave.azimuth);
        of(self) == of(other)
    }
}

/// What comes in, and what a case varies: by this reports tell cases apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseInput {
    /// Incident waves.
    pub waves: Vec<CaseWave>,
    /// Description of the parameter in which the case differs from its base case (key `varies`); `None` for an unvaried
    /// case.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub varies: Option<String>,
    /// Whether some joints of the scene are replaced by continuous material.
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

    /// Type and angle of incidence (degrees) of the single wave of azimuth 0; `None` for several waves, none, or another
    /// azimuth.
    pub fn wave(&self) -> Option<(&str, f64)> {
        match &self.waves[..] {
            [wave] if wave.azimuth == 0.0 => Some((&wave.kind, wave.incidence)),
            _ => None,
        }
    }
}
