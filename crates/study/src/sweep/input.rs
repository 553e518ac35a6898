//! Input of a case.

use powerhouse::format::{Azimuth, Finite, SceneFile, Wave, WaveKind};
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
    /// Factor on the motion.
    pub factor: f64,
}

impl CaseWave {
    /// Whether another wave has the same type and direction, with any motion.
    pub(crate) fn arrives_as(&self, other: &Self) -> bool {
        let of = |wave: &Self| (wave.kind.clone(), wave.incidence, wave.azimuth);
        of(self) == of(other)
    }
}

/// Description of the motion of a wave, which differs for different motions.
fn motion(wave: &Wave) -> String {
    let source = match (&wave.record, &wave.pulse) {
        (Some(record), _) => record.to_string(),
        (None, Some(pulse)) => format!("{:?}", **pulse),
        (None, None) => String::new(),
    };
    let component = wave.component.as_ref();
    let component = component.map_or(String::new(), |component| format!(" {:?}", **component));
    source + &component
}

/// Input of a case: its waves and the parameter that it varies. Reports group cases by it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseInput {
    /// Incident waves.
    pub waves: Vec<CaseWave>,
    /// Description of the parameter in which the case differs from its base case; `None` for an unvaried case.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub varies: Option<String>,
    /// Whether some joints of the scene are replaced by continuous material.
    pub continuous: bool,
}

impl CaseInput {
    /// The input of a case, from the scene file with the keys of the case applied.
    pub(super) fn of(scene: &SceneFile, name: &str) -> Self {
        let case = scene.cases.iter().find(|case| *case.name == name);
        let waves = scene.waves.iter().map(|wave| CaseWave {
            kind: match wave.kind {
                WaveKind::P => "p",
                WaveKind::Sv => "sv",
                WaveKind::Sh => "sh",
            }
            .into(),
            incidence: wave.incidence.get(),
            azimuth: wave.azimuth.map_or(0.0, Azimuth::get),
            motion: motion(wave),
            factor: wave.factor.map_or(1.0, Finite::get),
        });
        Self {
            waves: waves.collect(),
            varies: case.and_then(|case| case.varies.clone()),
            continuous: case.is_some_and(|case| !case.continuous.is_empty()),
        }
    }

    /// Type and angle of incidence (degrees) of the single wave along x; `None` if there are other waves.
    pub fn wave(&self) -> Option<(&str, f64)> {
        match &self.waves[..] {
            [wave] if wave.azimuth == 0.0 => Some((&wave.kind, wave.incidence)),
            _ => None,
        }
    }
}
