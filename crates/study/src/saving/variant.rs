//! Changes of a scene's file, and what the changed scene costs.

use powerhouse::Scene;
use toml::Table;

use super::window::{Growth, SceneFile, Window};
use super::{Change, PredictedError, Saving};
use crate::cost::Clock;
use crate::trade::{Factor, factors};

/// A change of a level of a factor: the change, the factor and the level.
static CHANGES: [(Change, &str, &str); 3] = [
    (Change::Mixed, "precision", "mixed"),
    (Change::OnePoint, "kernel", "hex8-one-point"),
    (Change::FlatDamping, "damping", "flat"),
];

/// The files of a scene that can be read again: as it stands and changed.
pub(super) struct Files {
    pub(super) own: SceneFile,
    /// The same in double precision.
    pub(super) double: SceneFile,
    pub(super) variants: Vec<Variant>,
}

/// A scene with one change.
pub(super) struct Variant {
    change: Change,
    file: SceneFile,
}

impl Files {
    /// Those of a scene; none of a scene that has no file, or that is a case.
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
                duration: scene.duration(),
                threads: scene.threads(),
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
    /// What the change saves of the scene as it stands, of which a run has so many steps; nothing if the
    /// changed scene cannot be run, or either run has too few steps to be timed.
    pub(super) fn saving(
        self,
        (own, steps): (&mut Clock, u64),
        of_step: core::time::Duration,
        window: &Window,
    ) -> Option<Saving> {
        let duration = self.file.duration;
        let scene = self.file.scene(duration)?;
        let (deviation, still) = (deviation(&scene), scene.stages().is_empty());
        let nonlinear = scene.parts().iter().any(|part| !part.material.is_linear());
        let mut simulation = scene.prepare().ok()?;
        let step = simulation.step().ok()?;
        let steps = ((duration / step).ceil() + 1.0) / steps as f64;
        let mut clock = Clock::of(&mut simulation).ok()?;
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
                    Change::Mixed => Growth::OfRounding,
                    _ => Growth::Unknown,
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
            timed: match (still, nonlinear) {
                (true, false) => "timed side by side",
                (true, true) => "timed side by side before anything yields",
                (false, _) => "timed side by side without the stages and before anything yields",
            },
            error,
        })
    }
}

/// A scene's file with another level of a factor, if that is less accurate than its own.
fn with_level(file: &Table, factor: &Factor, level: &str) -> Option<Table> {
    let place = factor.levels.iter().position(|other| other.name == level)?;
    if place <= factor.own {
        return None;
    }
    let mut changed = file.clone();
    factor.levels[place].apply(&mut changed);
    Some(changed)
}

/// The largest deviation of flat damping from its ratio within its band, among all parts.
fn deviation(scene: &Scene) -> f64 {
    let parts = scene.parts().iter();
    let deviations = parts.filter_map(|part| match &part.damping {
        powerhouse::Damping::Flat { spectrum, .. } => Some(spectrum.deviation()),
        _ => None,
    });
    deviations.fold(0.0, f64::max)
}
