//! Incident waves of a scene file, as reports name them.

use powerhouse_wavefield::WaveKind;

use crate::spec::{Azimuth, Finite, Incidence, Motion, SceneSpec, Wave};

/// Incident wave of a scene file in a few words and numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WaveOverview {
    /// Kind of body wave.
    pub kind: WaveKind,
    /// Angle of incidence from the vertical (degrees).
    pub incidence: f64,
    /// Direction of travel from +x towards +y (degrees).
    pub azimuth: f64,
    /// Record and component, or pulse, in words that differ where the motion does.
    pub motion: String,
    /// Factor that multiplies the motion (1).
    pub factor: f64,
}

impl WaveOverview {
    fn of(wave: &Wave) -> Self {
        Self {
            kind: wave.kind,
            incidence: wave.incidence.get(),
            azimuth: wave.azimuth.map_or(0.0, Azimuth::get),
            motion: motion(wave),
            factor: wave.factor.map_or(1.0, Finite::get),
        }
    }
}

/// The waves that a motion is split into.
fn waves_of(motion: &Motion) -> impl Iterator<Item = WaveOverview> {
    let incidence = *motion.incidence;
    let kinds = [
        (WaveKind::P, incidence.p),
        (WaveKind::SV, incidence.sv),
        (WaveKind::SH, incidence.sh),
    ];
    kinds.into_iter().filter_map(|(kind, incidence)| {
        Some(WaveOverview {
            kind,
            incidence: incidence.map(Incidence::get)?,
            azimuth: motion.azimuth.map_or(0.0, Azimuth::get),
            motion: format!("{} split", *motion.record),
            factor: motion.factor.map_or(1.0, Finite::get),
        })
    })
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

/// Incident waves of a scene file, and how the scene differs from others of the file if it is a case.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct InputOverview {
    /// The incident waves, in the order of the file.
    pub waves: Vec<WaveOverview>,
    /// Description of the one parameter in which the case differs from the case that it is compared with (key `varies`);
    /// `None` for the scene itself and for cases without this key.
    pub varies: Option<String>,
    /// Whether the case leaves out some of the scene's joints (key `continuous`).
    pub continuous: bool,
}

impl InputOverview {
    /// The overview of a file that is already as the case has it.
    pub(crate) fn of(spec: &SceneSpec) -> Self {
        let case = spec.of_case.as_ref();
        Self {
            waves: (spec.waves.iter().map(WaveOverview::of))
                .chain(spec.motions.iter().flat_map(waves_of))
                .collect(),
            varies: case.and_then(|case| case.varies.clone()),
            continuous: case.is_some_and(|case| case.continuous),
        }
    }
}
