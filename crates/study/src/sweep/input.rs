//! What a case is a case of.

use powerhouse::format::{Azimuth, Finite, SceneFile, Wave, WaveKind};
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

/// What moves a wave of a scene, in words that differ where the motion does.
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
    /// What a scene says of one of its cases; the scene is already as the case has it.
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

    /// The kind and the angle (degrees) of the one wave that comes in along x; none if there are others.
    pub fn wave(&self) -> Option<(&str, f64)> {
        match &self.waves[..] {
            [wave] if wave.azimuth == 0.0 => Some((&wave.kind, wave.incidence)),
            _ => None,
        }
    }
}
