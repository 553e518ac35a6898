//! What a change of a scene's file does to its histories, measured over the first part of the run.
//!
//! # Why so
//! *The scene itself is run, as it stands and changed*, over as many steps as a share of the run's time
//! permits, and all its histories are compared: elements, motion, boundary and output requests are its own.
//!
//! *Rounding grows with the run.* Each step adds an error that does not depend on the last, proportional to
//! the strain or the velocity of the moment and so to the velocity of the ground; undamped elements keep
//! what they got, so that the variance of the error at a time is the sum over all steps before. What the field that comes in does at the structure, known for the whole run, gives the
//! ratio of these sums, and of the motion that they are relative to, between window and run. Without such a
//! field motion and rounding are taken to be as strong all along. Where damping takes the error away the
//! whole run errs by less.
//!
//! *Number formats are compared at one step*, a little shorter than the stable one: theirs differ in the last
//! digits that the power iteration finds, and accelerations at instants that differ are no error of a format.
//!
//! *The errors of other changes are those of the window*: nothing says how they go on.

use std::path::PathBuf;
use std::time::Duration;

use powerhouse::io::TableColumn;
use powerhouse::model::{FieldMotion, Vec3};
use powerhouse::{RunHooks, Scene, Simulation, TimeStep};

use crate::registry;
use crate::trade::{columns, misfits};

/// The share of a run that is spent on a window of it, and the least time of all windows together.
const SHARE: f64 = 0.04;
const LEAST: Duration = Duration::from_millis(1200);
/// Instants at which the field that comes in is looked at.
const INSTANTS: usize = 4000;
/// The step of windows over that of the run: the stable steps of number formats differ by less.
const SHORTER: f64 = 0.998;
/// A window in which less than this share of the run's noise or motion arises tells nothing of the run.
const TELLING: f64 = 1e-9;

/// A scene's file as text, to be read several times.
#[derive(Clone, Debug)]
pub(crate) struct SceneFile {
    pub(crate) text: String,
    pub(crate) path: PathBuf,
    pub(crate) duration: f64,
    pub(crate) threads: Option<usize>,
}

impl SceneFile {
    /// The scene for some time (s), ready to run; none if it is refused.
    pub(crate) fn prepare(&self, duration: f64) -> Option<Simulation> {
        self.scene(duration)?.prepare().ok()
    }

    pub(crate) fn scene(&self, duration: f64) -> Option<Scene> {
        let scene = Scene::from_toml(self.text.clone(), self.path.clone(), &registry()).ok()?;
        let scene = scene.duration(duration);
        Some(match self.threads {
            Some(threads) => scene.threads(threads),
            None => scene,
        })
    }
}

/// What errors do after a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Growth {
    /// Nothing is known.
    Unknown,
    /// They add up as those of rounding do.
    OfRounding,
}

/// The largest relative L2 error among the histories of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredError {
    /// Its size over the whole run, as far as it is known: measured if the window is the run, predicted
    /// from the window where [`predicted`](Self::predicted) says so, that of the window otherwise. Where it may
    /// be [`amplified`](Self::amplified) the run errs by more.
    pub share: f64,
    /// The history.
    pub history: String,
    /// The first part of the run that was computed (s).
    pub window: f64,
    /// The whole run (s).
    pub duration: f64,
    /// Whether the error after the window is predicted.
    pub predicted: bool,
    /// Whether yielding, cracks or joints may amplify it after the window.
    pub amplified: bool,
}

impl MeasuredError {
    /// How it is known.
    pub(crate) fn source(&self) -> String {
        let Self {
            window, duration, ..
        } = self;
        let mut source = if self.window >= self.duration {
            format!("measured over the whole run of {duration} s")
        } else if self.predicted {
            format!("predicted for {duration} s from the first {window:.3} s, run both ways")
        } else {
            format!("measured over the first {window:.3} s of {duration} s")
        };
        if self.amplified {
            source += "; what yields, cracks or slips later may amplify it many times, which only a run shows";
        }
        source
    }
}

/// The first part of a scene's run, and what is known of the rest.
pub(crate) struct Window {
    file: SceneFile,
    length: f64,
    /// The time step of the reference (s).
    step: f64,
    field: Option<Intensities>,
    amplifies: bool,
    reference: Result<Vec<TableColumn>, &'static str>,
}

impl Window {
    /// The first part of the run of a scene's file of which a step takes `of_step` and is so long (s); it
    /// will be compared with so many others.
    pub(crate) fn of(
        file: SceneFile,
        facts: &Facts,
        (of_step, step): (Duration, f64),
        others: usize,
    ) -> Self {
        let duration = file.duration;
        let run = of_step.mul_f64((duration / step).ceil());
        let spent = run.mul_f64(SHARE).max(LEAST.div_f64((others + 1) as f64));
        let steps = spent.as_secs_f64() / of_step.as_secs_f64().max(1e-12);
        let length = duration.min((steps.ceil() * step).max(step));
        let reference = match facts.obstacle {
            Some(obstacle) => Err(obstacle),
            None if others == 0 => Err("there is nothing to compare"),
            None => histories(&file, length, Some(SHORTER * step)).ok_or("the scene does not run"),
        };
        Self {
            step: SHORTER * step,
            field: facts.field.clone(),
            amplifies: facts.amplifies,
            file,
            length,
            reference,
        }
    }

    /// The error of a changed scene; why it is not known otherwise.
    pub(crate) fn error_of(
        &self,
        changed: &SceneFile,
        growth: Growth,
    ) -> Result<MeasuredError, &'static str> {
        let reference = self.reference.as_ref().map_err(|reason| *reason)?;
        let found = histories(changed, self.length, self.step_for(growth))
            .ok_or("the changed scene does not run")?;
        self.largest(reference, &found, growth)
    }

    /// The error of the scene as it stands, against a more accurate one.
    pub(crate) fn error_against(
        &self,
        accurate: &SceneFile,
        growth: Growth,
    ) -> Result<MeasuredError, &'static str> {
        let found = self.reference.as_ref().map_err(|reason| *reason)?;
        let reference = histories(accurate, self.length, self.step_for(growth))
            .ok_or("the changed scene does not run")?;
        self.largest(&reference, found, growth)
    }

    /// The step of another run (s), if it is to be that of the reference.
    fn step_for(&self, growth: Growth) -> Option<f64> {
        (growth == Growth::OfRounding).then_some(self.step)
    }

    fn largest(
        &self,
        reference: &[TableColumn],
        found: &[TableColumn],
        growth: Growth,
    ) -> Result<MeasuredError, &'static str> {
        let (length, duration) = (self.length, self.file.duration);
        let whole = length >= duration;
        let predicted = !whole && growth != Growth::Unknown;
        let mut worst: Option<(f64, String)> = None;
        for misfit in misfits(reference, found) {
            let factor = match (predicted, &self.field) {
                (false, _) => 1.0,
                (true, None) => (duration / length).sqrt(),
                (true, Some(field)) => field
                    .growth(&misfit.name, length / duration)
                    .ok_or("the waves hardly reach the structure in the part of the run that can be afforded")?,
            };
            let share = factor * misfit.error;
            if worst.as_ref().is_none_or(|(most, _)| share > *most) && !misfit.error.is_nan() {
                worst = Some((share, misfit.name));
            }
        }
        let (share, history) = worst
            .ok_or("nothing that is recorded moves in the part of the run that can be afforded")?;
        Ok(MeasuredError {
            share,
            history,
            window: length,
            duration,
            predicted,
            amplified: self.amplifies && !whole,
        })
    }
}

/// The histories of the first part (s) of a run, with a step (s) of its own unless that is unstable; none if
/// it cannot be run.
fn histories(file: &SceneFile, length: f64, step: Option<f64>) -> Option<Vec<TableColumn>> {
    let mut simulation = file.prepare(length)?;
    if let Some(step) = step
        && step <= simulation.stable_step().ok()?.step
    {
        simulation.set_step(TimeStep::Seconds(step));
    }
    let results = simulation.run(RunHooks::default()).ok()?;
    Some(columns(&results.histories))
}

/// What a scene tells of its window before it is prepared.
pub(crate) struct Facts {
    field: Option<Intensities>,
    amplifies: bool,
    /// What keeps a window from being run.
    pub(super) obstacle: Option<&'static str>,
}

impl Facts {
    pub(crate) fn of(scene: &Scene) -> Self {
        let plan = scene.output_plan();
        let records = !plan.histories.is_empty()
            || !plan.relative.is_empty()
            || !plan.stresses.is_empty()
            || !plan.cuts.is_empty();
        let obstacle = if !records {
            Some("the scene records no histories")
        } else if !scene.stages().is_empty() {
            Some("its stages would have to be gone through first")
        } else {
            None
        };
        Self {
            field: match obstacle {
                None => Intensities::of(scene),
                Some(_) => None,
            },
            amplifies: scene.joints().next().is_some()
                || scene.parts().iter().any(|part| !part.material.is_linear()),
            obstacle,
        }
    }
}

/// Squares of the motion of the field at the structure, at equal intervals of the run: displacement,
/// velocity, acceleration.
#[derive(Clone, Debug)]
struct Intensities(Vec<[f64; 3]>);

impl Intensities {
    fn of(scene: &Scene) -> Option<Self> {
        let field = scene.incident_field()?;
        let (low, high) = scene.mesh().bounding_box();
        let middle = 0.5 * (low + high);
        let centre = scene.scatterer().unwrap_or(middle).sup(&low).inf(&high);
        let sampler = field.prepare(&[centre]).ok()?;
        let interval = scene.run_duration() / INSTANTS as f64;
        let mut before = Vec3::zeros();
        let squares = (0..=INSTANTS).map(|instant| {
            let mut motion = [FieldMotion::default()];
            sampler.add_motion(scene.start_time() + instant as f64 * interval, &mut motion);
            let [motion] = motion;
            let acceleration = (motion.velocity - before) / interval;
            before = motion.velocity;
            [
                motion.displacement.norm_squared(),
                motion.velocity.norm_squared(),
                acceleration.norm_squared(),
            ]
        });
        Some(Self(squares.collect()))
    }

    /// By how much the relative error of a history grows from a share of the run to the whole; none if too
    /// little moves in that share.
    fn growth(&self, history: &str, share: f64) -> Option<f64> {
        let of_signal = if history.ends_with("[m]") {
            0
        } else if history.ends_with("[m/s2]") {
            2
        } else {
            1
        };
        let end = ((share * INSTANTS as f64) as usize).clamp(1, INSTANTS);
        let sums = |end: usize| {
            let (mut added, mut noise, mut signal) = (0.0, 0.0, 0.0);
            for squares in &self.0[..=end] {
                added += squares[1];
                noise += added;
                signal += squares[of_signal];
            }
            [noise, signal]
        };
        let (window, run) = (sums(end), sums(INSTANTS));
        let tells = window
            .iter()
            .zip(run)
            .all(|(part, all)| *part > TELLING * all);
        tells.then(|| ((run[0] / window[0]) / (run[1] / window[1])).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Under a motion of one strength the relative error of rounding grows as the root of the time, under
    /// one that ends after the window as that of what remains, and a window without motion tells nothing.
    #[test]
    fn rounding_grows_as_its_sum_over_the_steps() {
        let of = |motion: fn(usize) -> f64| {
            Intensities((0..=INSTANTS).map(|i| [motion(i); 3]).collect())
        };
        let steady = of(|_| 1.0);
        for share in [0.01_f64, 0.1, 0.5, 1.0] {
            let found = steady.growth("a [m/s2]", share);
            let expected = (1.0 / share).sqrt();
            assert!((found.unwrap() / expected - 1.0).abs() < 0.03, "{share}");
        }
        let ends = of(|i| if i < INSTANTS / 10 { 1.0 } else { 0.0 });
        let found = ends.growth("a [m/s2]", 0.1).unwrap();
        // A tenth of the run with half of its sum on average, nine tenths with all of it.
        let expected = ((0.05 + 0.9) / 0.05_f64).sqrt();
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
        let late = of(|i| if i > INSTANTS / 2 { 1.0 } else { 0.0 });
        assert_eq!(late.growth("a [m]", 0.4), None);
    }
}
