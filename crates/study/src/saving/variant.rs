//! Changes of a scene's file, and the cost of the changed scene.

use powerhouse::Scene;
use toml::Table;

use super::window::{ErrorGrowth, SceneFile, Window};
use super::{Change, PredictedError, Saving};
use crate::cost::StepTimer;
use crate::trade::{Factor, factors};

/// Changes as levels of factors of a trade study: change, factor and level.
static CHANGES: [(Change, &str, &str); 3] = [
    (Change::Mixed, "precision", "mixed"),
    (Change::OnePoint, "kernel", "hex8-one-point"),
    (Change::FlatDamping, "damping", "flat"),
];

/// The files of a scene, unchanged and with single changes.
pub(super) struct Files {
    pub(super) own: SceneFile,
    /// The scene in double precision.
    pub(super) double: SceneFile,
    pub(super) variants: Vec<Variant>,
}

/// A scene with one change.
pub(super) struct Variant {
    change: Change,
    file: SceneFile,
}

impl Files {
    /// The files of a scene; `None` for a scene without a file or a case.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let (Some(source), None) = (scene.source(), scene.case()) else {
            return None;
        };
        let mut table = source.text.parse::<Table>().ok()?;
        table.remove("case");
        let file = |table: &Table| {
            Some(SceneFile {
                text: toml::to_string(table).ok()?,
                path: source.path.clone(),
                duration: scene.run_duration(),
                threads: scene.thread_count(),
            })
        };
        let factors = factors(scene, &table);
        let variants = CHANGES.iter().filter_map(|(change, factor, level)| {
            let factor = factors.iter().find(|other| other.name == *factor)?;
            let changed = with_level(&table, factor, level)?;
            Some(Variant {
                change: change.clone(),
                file: file(&changed)?,
            })
        });
        let variants = variants.collect();
        let own = file(&table)?;
        table.remove("precision");
        Some(Self {
            own,
            double: file(&table)?,
            variants,
        })
    }
}

impl Variant {
    /// The saving by the change, against a scene with a timer and a number of steps; `None` if the changed scene cannot
    /// be run, or either run has too few steps to be timed.
    pub(super) fn saving(
        self,
        (own, steps): (&mut StepTimer, u64),
        of_step: core::time::Duration,
        window: &Window,
    ) -> Option<Saving> {
        let duration = self.file.duration;
        let scene = self.file.scene(duration)?;
        let (deviation, unstaged) = (deviation(&scene), scene.stages().is_empty());
        let nonlinear = scene.parts().iter().any(|part| !part.material.is_linear());
        let mut simulation = scene.prepare().ok()?;
        let step = simulation.step().ok()?;
        let steps = ((duration / step).ceil() + 1.0) / steps as f64;
        let mut clock = StepTimer::of(&mut simulation).ok()?;
        let ratio = clock.ratio_to(own, of_step).ok()??;
        let error = match self.change {
            Change::FlatDamping => PredictedError {
                share: Some(deviation),
                least: None,
                of: "the damping ratio within its band".into(),
                source: "computed from the spectrum of its mechanisms".into(),
            },
            ref change => {
                let growth = match change {
                    Change::Mixed => ErrorGrowth::OfRounding,
                    _ => ErrorGrowth::Unknown,
                };
                match window.error_of(&self.file, growth) {
                    Ok(error) => PredictedError::measured(&error),
                    Err(reason) => PredictedError::unknown(reason),
                }
            }
        };
        Some(Saving {
            change: self.change,
            steps,
            elements: 1.0,
            time: steps * ratio,
            timed: match (unstaged, nonlinear) {
                (true, false) => "timed alternately",
                (true, true) => "timed alternately before anything yields",
                (false, _) => "timed alternately without the stages and before anything yields",
            },
            error,
        })
    }
}

/// A scene's file with another level of a factor, if that is less accurate than the scene's.
fn with_level(file: &Table, factor: &Factor, level: &str) -> Option<Table> {
    let index = factor.levels.iter().position(|other| other.name == level)?;
    if index <= factor.own {
        return None;
    }
    let mut changed = file.clone();
    factor.levels[index].apply(&mut changed);
    Some(changed)
}

/// Largest deviation of flat damping from its nominal ratio within its band, among all parts.
fn deviation(scene: &Scene) -> f64 {
    let parts = scene.parts().iter();
    let deviations = parts.filter_map(|part| match &part.damping {
        powerhouse::Damping::Flat { spectrum, .. } => Some(spectrum.deviation()),
        _ => None,
    });
    deviations.fold(0.0, f64::max)
}
