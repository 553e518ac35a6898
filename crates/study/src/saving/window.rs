//! Error of a change of a scene in its histories, measured over the first part of the run.
//!
//! # Why so
//! *The scene itself is run, unchanged and changed*, over as many steps as a share of the run's wall time permits, and
//! all its histories are compared: elements, motion, boundary and output requests are its own.
//!
//! *Rounding errors grow with the run.* Each step adds an independent error in proportion to the current strain or
//! velocity, and so to the velocity of the ground. Undamped elements keep these errors, so that the variance of the
//! error is the sum over all earlier steps. The incident field at the structure, which is known for the whole run,
//! gives the ratios of these sums, and of the motion, between window and run. Without such a field the motion is taken
//! to be stationary. Where parts are damped, earlier errors decay; the rate follows from the errors of the window and
//! of its first half.
//!
//! *Number formats are compared with the same step*, slightly shorter than the stable one: their stable steps differ in
//! the last digits of the iteration, and accelerations at different instants are no error of a format.
//!
//! *The errors of other changes are those of the window*: their growth is unknown.

use std::time::Duration;

use powerhouse::io::TableColumn;
use powerhouse::model::{FieldMotion, Vec3};
use powerhouse::{Error, FileScene, Registry, RunHooks, Scene, SceneSpec, Simulation, TimeStep};

use super::RunTiming;
use crate::trade::{Misfit, columns, misfits};

/// Share of a run's wall time that is spent on its window, and least wall time of all windows together.
const SHARE: f64 = 0.015;
const LEAST: Duration = Duration::from_millis(1200);
/// Greatest wall time of a window: a check of a run of days is to end within minutes.
const MOST: Duration = Duration::from_secs(60);
/// Instants at which the incident field is sampled.
const INSTANTS: usize = 4000;
/// Time step of windows over that of the run; the stable steps of number formats differ by less.
const SHORTER: f64 = 0.998;
/// Least share of the run's error variance and motion within a window from which the run can be predicted.
const LEAST_SHARE: f64 = 1e-9;
/// Least velocity of the incident field in a window over that in the run, below which the histories of a window are those
/// of a body that does not move yet.
const LEAST_MOTION: f64 = 1e-4;
const QUIET: &str = "the waves hardly reach the structure in the computed part of the run";

/// Scene with settings that replace those of its file.
#[derive(Clone)]
pub(crate) struct WindowScene {
    pub(crate) spec: SceneSpec,
    pub(crate) duration: f64,
    pub(crate) threads: Option<usize>,
    /// The names that the scene was read with.
    pub(crate) registry: Registry,
}

impl WindowScene {
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
        let scene = FileScene::from_spec(self.spec.clone(), &self.registry)?.into_scene();
        let scene = scene.with_duration(duration);
        Ok(match self.threads {
            Some(threads) => scene.with_threads(threads),
            None => scene,
        })
    }
}

/// Growth of errors after a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ErrorGrowth {
    /// Unknown growth.
    Unknown,
    /// Growth of accumulated rounding errors.
    OfRounding,
}

/// Largest relative L2 error among the histories of a scene, measured over the first part of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredError {
    /// Relative L2 error: of the whole run if the window is the whole run or the error is
    /// [`predicted`](Self::predicted), otherwise of the window. If it may be [`amplified`](Self::amplified), the error
    /// of the run may be larger.
    pub share: f64,
    /// Name of the history with the largest error.
    pub history: String,
    /// Duration of the computed first part of the run (s).
    pub window: f64,
    /// Duration of the whole run (s).
    pub duration: f64,
    /// Whether the error of the whole run is predicted from that of the window.
    pub predicted: bool,
    /// Whether yielding, cracking or joints may amplify the error after the window.
    pub amplified: bool,
}

impl MeasuredError {
    /// The source of the error as text.
    pub(crate) fn source(&self) -> String {
        let Self {
            window, duration, ..
        } = self;
        let mut source = if self.window >= self.duration {
            format!("measured over the whole run of {duration} s")
        } else if self.predicted {
            format!(
                "predicted for {duration} s from the first {window:.3} s, run with and without the change"
            )
        } else {
            format!("measured over the first {window:.3} s of {duration} s")
        };
        if self.amplified {
            source += "; later yielding, cracking or slip may amplify it many times, which only a whole run shows";
        }
        source
    }
}

/// First part of a scene's run, as the reference of changed runs.
pub(crate) struct Window {
    file: WindowScene,
    length: f64,
    /// Time step of the reference (s).
    step: f64,
    field: Option<Intensities>,
    amplifies: bool,
    damped: bool,
    reference: Result<Tables, &'static str>,
}

/// Tables of the first part of a run.
struct Tables {
    histories: Vec<TableColumn>,
    /// The same with section forces and moments.
    with_sections: Vec<TableColumn>,
}

impl Tables {
    /// Those that tell the error of a change.
    fn of_change(&self, change: Compared) -> &[TableColumn] {
        match change {
            Compared::Histories => &self.histories,
            Compared::WithSections => &self.with_sections,
        }
    }
}

/// What is compared with and without a change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Compared {
    /// Histories of motion, stress and state.
    Histories,
    /// The same with section forces and moments.
    WithSections,
}

impl Window {
    /// The first part of the run of a scene's file with steps of a timing; it will be compared with so many
    /// others.
    pub(crate) fn of(
        file: WindowScene,
        facts: &SceneFacts,
        timing: &RunTiming,
        others: usize,
    ) -> Self {
        let RunTiming { of_step, step, .. } = *timing;
        let duration = file.duration;
        let run = of_step.mul_f64((duration / step).ceil());
        let least = LEAST.div_f64((others + 1) as f64);
        let spent = run.mul_f64(SHARE).max(least).min(MOST);
        let steps = spent.as_secs_f64() / of_step.as_secs_f64().max(1e-12);
        let length = duration.min((steps.ceil() * step).max(step));
        let reference = match facts.obstacle {
            Some(obstacle) => Err(obstacle),
            None if others == 0 => Err("there is no run to compare with"),
            // Before any window is run.
            None if length < duration && facts.is_quiet(length / duration) => Err(QUIET),
            None => tables(&file, length, Some(SHORTER * step)).ok_or("the scene cannot be run"),
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

    /// The error of a changed scene, or the reason why it is unknown.
    pub(crate) fn error_of(
        &self,
        changed: &WindowScene,
        growth: ErrorGrowth,
        compared: Compared,
    ) -> Result<MeasuredError, &'static str> {
        let reference = self.reference.as_ref().map_err(|reason| *reason)?;
        let found = tables(changed, self.length, self.step_for(growth))
            .ok_or("the changed scene cannot be run")?;
        let [reference, found] = [reference, &found].map(|tables| tables.of_change(compared));
        self.largest(reference, found, growth)
    }

    /// The error of the unchanged scene against a more accurate one, or the reason why it is unknown.
    pub(crate) fn error_against(
        &self,
        accurate: &WindowScene,
        growth: ErrorGrowth,
    ) -> Result<MeasuredError, &'static str> {
        let found = self.reference.as_ref().map_err(|reason| *reason)?;
        let reference = tables(accurate, self.length, self.step_for(growth))
            .ok_or("the changed scene cannot be run")?;
        self.largest(&reference.histories, &found.histories, growth)
    }

    /// The step of a compared run (s), if it must be that of the reference.
    fn step_for(&self, growth: ErrorGrowth) -> Option<f64> {
        (growth == ErrorGrowth::OfRounding).then_some(self.step)
    }

    /// Decay rate of the errors of earlier steps (1/duration of the run), from the misfits of a history in the first
    /// half of the window and in all of it.
    fn decay(&self, whole: &Misfit, halves: &[Misfit]) -> f64 {
        let half = halves.iter().find(|half| half.name == whole.name);
        match (half, &self.field) {
            (Some(half), Some(field)) if half.difference > 0.0 => field.decay(
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
        growth: ErrorGrowth,
    ) -> Result<MeasuredError, &'static str> {
        let (length, duration) = (self.length, self.file.duration);
        let whole = length >= duration;
        let predicted = !whole && growth != ErrorGrowth::Unknown;
        let halves = if self.damped {
            misfits(&first_half(reference), found)
        } else {
            Vec::new()
        };
        let mut worst: Option<(f64, String)> = None;
        for misfit in misfits(reference, found) {
            let factor = match (predicted, &self.field) {
                (false, _) => 1.0,
                (true, None) => (duration / length).sqrt(),
                (true, Some(field)) => field
                    .growth(
                        &misfit.name,
                        length / duration,
                        self.decay(&misfit, &halves),
                    )
                    .ok_or(QUIET)?,
            };
            let share = factor * misfit.error;
            if worst.as_ref().is_none_or(|(most, _)| share > *most) && !misfit.error.is_nan() {
                worst = Some((share, misfit.name));
            }
        }
        let (share, history) =
            worst.ok_or("all histories are zero in the computed part of the run")?;
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

/// The tables of the first part (s) of a run, with a given step (s) unless that is unstable; `None` if it cannot be
/// run.
fn tables(file: &WindowScene, length: f64, step: Option<f64>) -> Option<Tables> {
    let mut simulation = file.prepare(length).ok()?;
    if let Some(step) = step
        && step <= simulation.stable_step().ok()?.step
    {
        simulation.set_step(TimeStep::Seconds(step));
    }
    let results = simulation.run(RunHooks::default()).ok()?;
    let histories = columns(results.histories());
    let mut with_sections = histories.clone();
    let sections = columns(results.sections());
    // Both are sampled at the same times, if there are both.
    match histories.len() {
        0 | 1 => with_sections = sections,
        _ => with_sections.extend(sections.into_iter().skip(1)),
    }
    Some(Tables {
        histories,
        with_sections,
    })
}

/// Properties of a scene on which its window depends, collected before it is prepared.
pub(crate) struct SceneFacts {
    field: Option<Intensities>,
    amplifies: bool,
    damped: bool,
    /// Reason why no window can be run.
    pub(super) obstacle: Option<&'static str>,
}

/// Reason why no window of a scene can be run.
pub(super) fn obstacle(scene: &Scene) -> Option<&'static str> {
    let plan = scene.output();
    let records = !plan.histories.is_empty()
        || !plan.relative.is_empty()
        || !plan.sampled.is_empty()
        || !plan.stresses.is_empty()
        || !plan.cuts.is_empty();
    if !records {
        Some("the scene records no histories")
    } else if !scene.stages().is_empty() {
        Some(
            "its construction stages would have to be computed first, and yielding, cracking or slip may amplify rounding to the size of the accelerations",
        )
    } else {
        None
    }
}

impl SceneFacts {
    /// Whether waves have not reached the structure in a first share of the run.
    fn is_quiet(&self, share: f64) -> bool {
        (self.field.as_ref()).is_some_and(|field| !field.has_arrived(share))
    }

    pub(crate) fn of(scene: &Scene) -> Self {
        let obstacle = obstacle(scene);
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

/// Squared displacement, velocity and acceleration of the incident field at the structure, at equal intervals of the
/// run.
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

    /// Whether the field moves the structure in a first share of the run.
    fn has_arrived(&self, share: f64) -> bool {
        let end = ((share * INSTANTS as f64) as usize).clamp(1, INSTANTS);
        let most =
            |instants: &[[f64; 3]]| instants.iter().fold(0.0_f64, |most, of| most.max(of[1]));
        most(&self.0[..=end]) >= LEAST_MOTION * LEAST_MOTION * most(&self.0)
    }

    /// Sum over a first part of the run of the variance of an error that grows at each instant in proportion to the
    /// squared velocity and decays at a rate (1/duration of the run).
    fn variance(&self, end: usize, decay: f64) -> f64 {
        let kept = (-2.0 * decay / INSTANTS as f64).exp();
        let (mut added, mut noise) = (0.0, 0.0);
        for squares in &self.0[..=end] {
            added = kept * added + squares[1];
            noise += added;
        }
        noise
    }

    /// Decay rate (1/duration of the run) for which the error variance of a share of the run has a given ratio to that
    /// of its half; zero if it would have to be negative.
    fn decay(&self, share: f64, ratio: f64) -> f64 {
        let end = ((share * INSTANTS as f64) as usize).clamp(2, INSTANTS);
        let is_slower = |rate: f64| self.variance(end, rate) / self.variance(end / 2, rate) > ratio;
        // With the greatest rate an error vanishes after one instant.
        let (mut slow, mut fast) = (0.0, INSTANTS as f64);
        if !is_slower(slow) {
            return 0.0;
        }
        for _ in 0..40 {
            let middle = 0.5 * (slow + fast);
            if is_slower(middle) {
                slow = middle
            } else {
                fast = middle
            }
        }
        slow
    }

    /// Growth factor of the relative error of a history from a share of the run to the whole, for a decay rate; `None` if
    /// that share contains too little motion.
    fn growth(&self, history: &str, share: f64, decay: f64) -> Option<f64> {
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
            [self.variance(end, decay), signal]
        };
        let (window, run) = (sums(end), sums(INSTANTS));
        let is_enough = window
            .iter()
            .zip(run)
            .all(|(part, all)| *part > LEAST_SHARE * all);
        is_enough.then(|| ((run[0] / window[0]) / (run[1] / window[1])).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The relative rounding error grows with the root of time under a stationary motion; under a motion that ends after
    /// the window it follows the accumulated variance; a window without motion gives no prediction.
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

    /// The decay rate is recovered from the growth of the variance within a window for any motion; with fast decay the
    /// variance grows with the motion alone.
    #[test]
    fn the_decay_rate_is_found_from_the_window() {
        for motion in [|_: usize| 1.0, |i: usize| (i as f64).powi(2)] {
            let field = Intensities((0..=INSTANTS).map(|i| [motion(i); 3]).collect());
            for rate in [3.0, 30.0, 200.0] {
                let share = 0.1;
                let end = (share * INSTANTS as f64) as usize;
                let ratio = field.variance(end, rate) / field.variance(end / 2, rate);
                let found = field.decay(share, ratio);
                assert!((found / rate - 1.0).abs() < 1e-6, "{found} {rate}");
            }
            assert_eq!(field.decay(0.1, 1e6), 0.0);
        }
        let steady = Intensities((0..=INSTANTS).map(|_| [1.0; 3]).collect());
        let found = steady.growth("a [m/s2]", 0.1, 1e3).unwrap();
        assert!((found - 1.0).abs() < 0.05, "{found}");
    }
}
