//! What a change of a scene's file does to its histories, measured over the first part of the run.
//!
//! # Why so
//! *The scene itself is run, as it stands and changed*, over as many steps as a share of the run's time
//! permits, and all its histories are compared: elements, motion, boundary and output requests are its own.
//!
//! *Rounding grows with the run.* Each step adds an error that does not depend on the last, proportional to
//! the strain or the velocity of the moment and so to the velocity of the ground; undamped elements keep
//! what they got, so that the variance of the error at a time is the sum over all steps before. What the field
//! that comes in does at the structure, known for the whole run, gives the ratio of these sums, and of the
//! motion that they are relative to, between window and run. Without such a field motion and rounding are taken
//! to be as strong all along. Where parts are damped the errors of earlier steps fade; how fast shows in how
//! much more the window errs than its first half.
//!
//! *Number formats are compared at one step*, a little shorter than the stable one: theirs differ in the last
//! digits that the power iteration finds, and accelerations at instants that differ are no error of a format.
//!
//! *The errors of other changes are those of the window*: nothing says how they go on.

use std::path::PathBuf;
use std::time::Duration;

use powerhouse::io::TableColumn;
use powerhouse::model::{FieldMotion, Vec3};
use powerhouse::{Error, Registry, RunHooks, Scene, Simulation, TimeStep};

use super::RunTiming;
use crate::trade::{Misfit, columns, misfits};

/// The share of a run that is spent on a window of it, and the least time of all windows together.
const SHARE: f64 = 0.02;
const LEAST: Duration = Duration::from_millis(1200);
/// Instants at which the field that comes in is looked at.
const INSTANTS: usize = 4000;
/// The step of windows over that of the run: the stable steps of number formats differ by less.
const SHORTER: f64 = 0.998;
/// A window in which less than this share of the run's noise or motion arises tells nothing of the run.
const TELLING: f64 = 1e-9;

/// A scene's file as text, to be read several times.
#[derive(Clone)]
pub(crate) struct SceneFile {
    pub(crate) text: String,
    pub(crate) path: PathBuf,
    pub(crate) duration: f64,
    pub(crate) threads: Option<usize>,
    /// The names that the scene was read with.
    pub(crate) registry: Registry,
}

impl SceneFile {
    /// The scene for some time (s), ready to run.
    ///
    /// # Errors
    /// A scene that is refused.
    pub(crate) fn prepare(&self, duration: f64) -> Result<Simulation, Error> {
        self.scene(duration)?.prepare()
    }

    /// The scene for some time (s).
    ///
    /// # Errors
    /// A scene that is refused.
    pub(crate) fn scene(&self, duration: f64) -> Result<Scene, Error> {
        let scene = Scene::from_toml(self.text.clone(), self.path.clone(), &self.registry)?;
        let scene = scene.with_duration(duration);
        Ok(match self.threads {
            Some(threads) => scene.with_threads(threads),
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
    damped: bool,
    reference: Result<Vec<TableColumn>, &'static str>,
}

impl Window {
    /// The first part of the run of a scene's file with steps of a timing; it will be compared with so many
    /// others.
    pub(crate) fn of(file: SceneFile, facts: &Facts, timing: &RunTiming, others: usize) -> Self {
        let RunTiming { of_step, step, .. } = *timing;
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
            damped: facts.damped,
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

    /// How fast the errors of earlier steps fade (1/duration of the run), from what a history errs by in the
    /// first half of the window and in all of it.
    fn fading(&self, whole: &Misfit, halves: &[Misfit]) -> f64 {
        let half = halves.iter().find(|half| half.name == whole.name);
        match (half, &self.field) {
            (Some(half), Some(field)) if half.difference > 0.0 => field.fading(
                self.length / self.file.duration,
                whole.difference / half.difference,
            ),
            _ => 0.0,
        }
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
        let halves = match self.damped {
            true => misfits(&first_half(reference), found),
            false => Vec::new(),
        };
        let mut worst: Option<(f64, String)> = None;
        for misfit in misfits(reference, found) {
            let factor = match (predicted, &self.field) {
                (false, _) => 1.0,
                (true, None) => (duration / length).sqrt(),
                (true, Some(field)) => field
                    .growth(&misfit.name, length / duration, self.fading(&misfit, &halves))
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

/// The rows of a table in the first half of its time.
fn first_half(table: &[TableColumn]) -> Vec<TableColumn> {
    let times = table.first().map_or(&[][..], |time| &time.values);
    let middle = times.last().map_or(0.0, |end| 0.5 * end);
    let rows = times.partition_point(|time| *time <= middle);
    let half = |column: &TableColumn| {
        let values = column.values[..rows].to_vec();
        TableColumn::new(column.name.clone(), column.unit.clone(), values)
    };
    table.iter().map(half).collect()
}

/// The histories of the first part (s) of a run, with a step (s) of its own unless that is unstable; none if
/// it cannot be run.
fn histories(file: &SceneFile, length: f64, step: Option<f64>) -> Option<Vec<TableColumn>> {
    let mut simulation = file.prepare(length).ok()?;
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
    damped: bool,
    /// What keeps a window from being run.
    pub(super) obstacle: Option<&'static str>,
}

impl Facts {
    pub(crate) fn of(scene: &Scene) -> Self {
        let plan = scene.output();
        let records = !plan.histories.is_empty()
            || !plan.relative.is_empty()
            || !plan.stresses.is_empty()
            || !plan.cuts.is_empty();
        let obstacle = if !records {
            Some("the scene records no histories")
        } else if !scene.stages().is_empty() {
            Some(
                "its stages would have to be gone through first, and where anything yields, cracks or slips rounding may grow to the size of the accelerations",
            )
        } else {
            None
        };
        Self {
            field: match obstacle {
                None => Intensities::of(scene),
                Some(_) => None,
            },
            damped: (scene.parts().iter()).any(|part| part.damping != powerhouse::Damping::None),
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
        let field = scene.field()?;
        let (low, high) = scene.mesh().bounding_box();
        let middle = 0.5 * (low + high);
        let centre = scene.scatterer().unwrap_or(middle).sup(&low).inf(&high);
        let sampler = field.prepare(&[centre]).ok()?;
        let interval = scene.duration() / INSTANTS as f64;
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

    /// The sum over a first part of the run of the variance of an error that every instant adds to in
    /// proportion to the velocity squared, and that fades at a rate (1/duration of the run).
    fn noise(&self, end: usize, fading: f64) -> f64 {
        let kept = (-2.0 * fading / INSTANTS as f64).exp();
        let (mut added, mut noise) = (0.0, 0.0);
        for squares in &self.0[..=end] {
            added = kept * added + squares[1];
            noise += added;
        }
        noise
    }

    /// The rate of fading (1/duration of the run) at which the noise of a share of the run is so many times
    /// that of half of it; zero if it would have to grow.
    fn fading(&self, share: f64, ratio: f64) -> f64 {
        let end = ((share * INSTANTS as f64) as usize).clamp(2, INSTANTS);
        let is_slower = |rate: f64| self.noise(end, rate) / self.noise(end / 2, rate) > ratio;
        // At the fastest one nothing is left after an instant.
        let (mut slow, mut fast) = (0.0, INSTANTS as f64);
        if !is_slower(slow) {
            return 0.0;
        }
        for _ in 0..40 {
            let middle = 0.5 * (slow + fast);
            match is_slower(middle) {
                true => slow = middle,
                false => fast = middle,
            }
        }
        slow
    }

    /// By how much the relative error of a history, that fades at a rate, grows from a share of the run to
    /// the whole; none if too little moves in that share.
    fn growth(&self, history: &str, share: f64, fading: f64) -> Option<f64> {
        let of_signal = if history.ends_with("[m]") {
            0
        } else if history.ends_with("[m/s2]") {
            2
        } else {
            1
        };
        let end = ((share * INSTANTS as f64) as usize).clamp(1, INSTANTS);
        let sums = |end: usize| {
            let signal: f64 = self.0[..=end]
                .iter()
                .map(|squares| squares[of_signal])
                .sum();
            [self.noise(end, fading), signal]
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
            let found = steady.growth("a [m/s2]", share, 0.0);
            let expected = (1.0 / share).sqrt();
            assert!((found.unwrap() / expected - 1.0).abs() < 0.03, "{share}");
        }
        let ends = of(|i| if i < INSTANTS / 10 { 1.0 } else { 0.0 });
        let found = ends.growth("a [m/s2]", 0.1, 0.0).unwrap();
        // A tenth of the run with half of its sum on average, nine tenths with all of it.
        let expected = ((0.05 + 0.9) / 0.05_f64).sqrt();
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
        let late = of(|i| if i > INSTANTS / 2 { 1.0 } else { 0.0 });
        assert_eq!(late.growth("a [m]", 0.4, 0.0), None);
    }

    /// The rate at which noise fades is found again from how it grows within a window, whatever the motion; noise that
    /// fades fast grows with the motion alone.
    #[test]
    fn fading_is_found_from_the_window() {
        for motion in [|_: usize| 1.0, |i: usize| (i as f64).powi(2)] {
            let field = Intensities((0..=INSTANTS).map(|i| [motion(i); 3]).collect());
            for rate in [3.0, 30.0, 200.0] {
                let share = 0.1;
                let end = (share * INSTANTS as f64) as usize;
                let ratio = field.noise(end, rate) / field.noise(end / 2, rate);
                let found = field.fading(share, ratio);
                assert!((found / rate - 1.0).abs() < 1e-6, "{found} {rate}");
            }
            assert_eq!(field.fading(0.1, 1e6), 0.0);
        }
        let steady = Intensities((0..=INSTANTS).map(|_| [1.0; 3]).collect());
        let found = steady.growth("a [m/s2]", 0.1, 1e3).unwrap();
        assert!((found - 1.0).abs() < 0.05, "{found}");
    }
}
