//! Changes of a scene, and the cost of the changed scene.

use powerhouse::spec::Precision;
use powerhouse::{FileScene, Scene, SceneSpec};

use super::window::{Compared, ErrorGrowth, Window, WindowScene};
use super::{Change, PredictedError, RefusedChange, RunTiming, Saving};
use crate::StudyError;
use crate::cost::StepTimer;
use crate::trade::{Factor, factor, factors};

/// A change, with the factor and the level of it that a trade has.
struct ChangeOfLevel {
    change: Change,
    factor: &'static str,
    level: &'static str,
}

/// The changes that are made in a scene.
fn changes() -> [ChangeOfLevel; 4] {
    let of = |change, factor, level| ChangeOfLevel {
        change,
        factor,
        level,
    };
    [
        of(Change::Mixed, factor::PRECISION, factor::MIXED),
        of(Change::OnePoint, factor::KERNEL, factor::one_point()),
        of(Change::FlatDamping, factor::DAMPING, factor::FLAT),
        of(Change::Fibres, factor::FIBRES, factor::TWICE),
    ]
}

/// Whether a body with delayed ends under waves along y takes a change.
fn is_taken(scene: &Scene, of: &ChangeOfLevel) -> bool {
    match of.change {
        Change::Mixed | Change::Fibres => false,
        Change::FlatDamping => scene.is_bay(),
        _ => true,
    }
}

/// A scene, unchanged and with single changes.
pub(super) struct Variants {
    pub(super) own: WindowScene,
    /// The scene in double precision.
    pub(super) double: WindowScene,
    pub(super) changed: Vec<ChangedScene>,
}

/// A scene with one change.
pub(super) struct ChangedScene {
    change: Change,
    scene: WindowScene,
}

impl Variants {
    /// The variants of a scene; `None` for a scene that was composed in Rust, and for a case.
    pub(super) fn of(scene: &FileScene) -> Option<Self> {
        let (Some(spec), None) = (scene.spec(), scene.case()) else {
            return None;
        };
        let registry = scene.registry()?;
        let with = |spec: SceneSpec| WindowScene {
            spec,
            duration: scene.duration(),
            threads: scene.threads(),
            registry: registry.clone(),
        };
        let factors = factors(scene, spec);
        let is_taken = |of: &ChangeOfLevel| scene.slowness_along_y() == 0.0 || is_taken(scene, of);
        let changed = changes().into_iter().filter(is_taken).filter_map(|of| {
            let factor = factors.iter().find(|other| other.name == of.factor)?;
            Some(ChangedScene {
                change: of.change,
                scene: with(with_level(spec, factor, of.level)?),
            })
        });
        let mut double = spec.clone();
        double.precision = Precision::default();
        Some(Self {
            changed: changed.collect(),
            own: with(spec.clone()),
            double: with(double),
        })
    }
}

impl ChangedScene {
    /// The saving by the change against the unchanged scene; `None` if either run has too few steps to be timed.
    ///
    /// # Errors
    /// The change with the reason, if the changed scene is refused.
    pub(super) fn saving(
        self,
        own: &mut StepTimer,
        timing: &RunTiming,
        window: &Window,
    ) -> Result<Option<Saving>, RefusedChange> {
        let change = self.change.clone();
        let found = self.timed(own, timing, window);
        found.map_err(|error| RefusedChange::new(change, &error))
    }

    /// The change, refused for a reason.
    pub(super) fn refused(&self, reason: &str) -> RefusedChange {
        RefusedChange {
            change: self.change.clone(),
            reason: reason.into(),
        }
    }

    fn timed(
        self,
        own: &mut StepTimer,
        timing: &RunTiming,
        window: &Window,
    ) -> Result<Option<Saving>, StudyError> {
        let duration = self.scene.duration;
        let scene = self.scene.scene(duration)?;
        let (deviation, unstaged) = (deviation(&scene), scene.stages().is_empty());
        let nonlinear = scene.parts().iter().any(|part| !part.material.is_linear());
        let mut simulation = scene.prepare()?;
        let step = simulation.step()?;
        let steps = ((duration / step).ceil() + 1.0) / timing.steps as f64;
        let ratio = StepTimer::of(&mut simulation)?.ratio_to(own, timing.of_step)?;
        // No third model is held beside the next one.
        drop(simulation);
        let Some(ratio) = ratio else {
            return Ok(None);
        };
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
                let compared = match change {
                    Change::Fibres => Compared::WithSections,
                    _ => Compared::Histories,
                };
                match window.error_of(&self.scene, growth, compared) {
                    Ok(error) => PredictedError::measured(&error),
                    Err(reason) => PredictedError::unknown(reason),
                }
            }
        };
        Ok(Some(Saving {
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
        }))
    }
}

/// A scene with another level of a factor, if that is less accurate than the scene's.
fn with_level(spec: &SceneSpec, factor: &Factor, level: &str) -> Option<SceneSpec> {
    let index = factor.levels.iter().position(|other| other.name == level)?;
    if index <= factor.own {
        return None;
    }
    let mut changed = spec.clone();
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
