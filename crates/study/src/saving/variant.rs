//! Changes of a scene's file, and what the changed scene costs.

use std::path::PathBuf;

use powerhouse::{Scene, Simulation};
use toml::Table;

use super::{Change, PredictedError, Saving};
use crate::trade::{Factor, factors};
use crate::{cost, registry};

/// A change of a level of a factor: the change, the factor and the level; the error is measured or
/// follows from the level itself.
static CHANGES: [(Change, &str, &str); 3] = [
    (Change::Mixed, "precision", "mixed"),
    (Change::OnePoint, "kernel", "hex8-one-point"),
    (Change::FlatDamping, "damping", "flat"),
];
/// The relative L2 error of histories of a cube under an SV wave stays below this (tests of trades).
const MIXED_ERROR: f64 = 1.0e-4;
/// The same of the worst history, an acceleration, of `data/scenes/cavern_small.toml` against bricks of
/// 2x2x2 points, as `powerhouse trade data/scenes/cavern_small.toml` prints it.
const ONE_POINT_ERROR: f64 = 7.1e-2;

/// A scene with one change.
pub(super) struct Variant {
    change: Change,
    text: String,
    path: PathBuf,
    duration: f64,
    threads: Option<usize>,
}

impl Variant {
    /// The changes that a scene's file allows; none of a scene that has no file, or that is a case.
    pub(super) fn all(scene: &Scene) -> Vec<Self> {
        let (Some(source), None) = (scene.source(), scene.case()) else {
            return Vec::new();
        };
        let Ok(mut file) = source.text.parse::<Table>() else {
            return Vec::new();
        };
        file.remove("case");
        let factors = factors(scene, &file);
        let allowed = CHANGES.iter().filter_map(|(change, factor, level)| {
            let factor = factors.iter().find(|other| other.name == *factor)?;
            let text = with_level(&file, factor, level)?;
            Some(Self {
                change: change.clone(),
                text,
                path: source.path.clone(),
                duration: scene.run_duration(),
                threads: scene.thread_count(),
            })
        });
        allowed.collect()
    }

    /// What the change saves of so many steps of the scene as it stands; nothing if the changed scene
    /// cannot be run.
    pub(super) fn saving(self, own: &mut Simulation, steps: u64) -> Option<Saving> {
        let scene = Scene::from_toml(self.text, self.path, &registry()).ok()?;
        let scene = scene.duration(self.duration);
        let scene = match self.threads {
            Some(threads) => scene.threads(threads),
            None => scene,
        };
        let deviation = deviation(&scene);
        let mut simulation = scene.prepare().ok()?;
        let step = simulation.step().ok()?;
        let steps = ((self.duration / step).ceil() + 1.0) / steps as f64;
        let of_step = cost::ratio_of_steps(&mut simulation, own).ok()?;
        let error = match self.change {
            Change::Mixed => PredictedError {
                share: MIXED_ERROR,
                of: "histories, at most",
                source: "the trade of a cube under an SV wave",
            },
            Change::OnePoint => PredictedError {
                share: ONE_POINT_ERROR,
                of: "the worst history, against bricks of 2x2x2 points",
                source: "`powerhouse trade data/scenes/cavern_small.toml`",
            },
            _ => PredictedError {
                share: deviation,
                of: "the damping ratio within its band",
                source: "the spectrum of its mechanisms",
            },
        };
        Some(Saving {
            change: self.change,
            steps,
            elements: 1.0,
            time: steps * of_step,
            error,
        })
    }
}

/// A scene's file with another level of a factor, if that is less accurate than its own.
fn with_level(file: &Table, factor: &Factor, level: &str) -> Option<String> {
    let place = factor.levels.iter().position(|other| other.name == level)?;
    if place <= factor.own {
        return None;
    }
    let mut changed = file.clone();
    factor.levels[place].apply(&mut changed);
    toml::to_string(&changed).ok()
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
