//! States of a run at given times, which are kept after it and from which variants of it start.

use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;

use powerhouse_io::{IoError, read_sections, write_sections, write_whole};
use powerhouse_model::{SavedRun, encode};

use super::files::{BODIES, RUN, decoded, read_body, remove, run_of, sections_of, sections_with};
use super::incident::{IncidentMotion, are_equal};
use super::inputs::{is_motion, may_vary};
use super::{CheckpointFiles, RunInputs};
use powerhouse_scene::{CheckpointError, EquilibratedBody, Scene};

/// Subfolder of the results folder.
const FOLDER: &str = "kept";
/// The body at the end of the stages.
const STAGES: &str = "stages.body";
/// End of the names of files of states; their start is the time.
const ENDING: &str = "s.run";
/// Section of the incident motion at the time of the state.
const MOTION: &str = "incident motion";

/// State of a run at a given time, from which a variant of the run starts: with other output, another duration, or other
/// waves later on.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct KeptState {
    /// Inputs of the run.
    pub inputs: RunInputs,
    /// The body after the last stage in static equilibrium; none without stages.
    pub body: Option<EquilibratedBody>,
    /// State of the dynamic run.
    pub run: SavedRun,
    file: PathBuf,
    motion: Vec<f64>,
}

impl KeptState {
    /// Accepts a scene with its inputs as a variant of the run; returns the inputs, whose [origin](RunInputs::origin) names this state
    /// and what has changed since.
    ///
    /// # Errors
    /// [`CheckpointError::Variant`] for a change that acts before the state, [`CheckpointError::Ended`] for a run that
    /// ends before it, [`CheckpointError::Waves`] for waves that differ at its time.
    pub fn variant(
        &self,
        scene: &Scene,
        mut here: RunInputs,
    ) -> Result<RunInputs, CheckpointError> {
        let changes = self.inputs.differences(&here);
        let prescribed = !scene.prescribed.is_empty();
        let refused = |name: &String| !may_vary(name) || (prescribed && is_motion(name));
        let what: Vec<String> = changes
            .iter()
            .filter(|name| refused(name))
            .cloned()
            .collect();
        if !what.is_empty() {
            return Err(CheckpointError::Variant {
                file: self.file.clone(),
                what: what.join(", "),
            });
        }
        let (time, end) = (self.run.time, scene.start_time() + scene.duration());
        if end <= time {
            return Err(CheckpointError::Ended { time, end });
        }
        let motion = IncidentMotion::of(scene).at(time);
        let motion = motion.map_err(CheckpointError::Motion)?;
        if !are_equal(&self.motion, &motion) {
            let file = self.file.clone();
            return Err(CheckpointError::Waves { file, time });
        }
        let changed = if changes.is_empty() {
            "nothing".into()
        } else {
            changes.join(", ")
        };
        here.origin = Some(format!(
            "starts from the state at t = {time} s in {}; changed since: {changed}; tables, envelopes and snapshots begin \
             there",
            self.file.display()
        ));
        Ok(here)
    }
}

impl CheckpointFiles {
    fn kept(&self, name: &str) -> PathBuf {
        self.results().join(FOLDER).join(name)
    }

    /// Writes the state of a dynamic run to be kept, under a time (s) that was requested, and the body after the stages
    /// beside it.
    pub(super) fn write_kept(
        &self,
        time: f64,
        inputs: &RunInputs,
        incident: &IncidentMotion,
        saved: &SavedRun,
    ) -> Result<(), CheckpointError> {
        let body = self.kept(STAGES);
        let latest = self.path(BODIES[0]);
        if latest.is_file() && !body.is_file() {
            let bytes = fs::read(&latest).map_err(IoError::file(&latest))?;
            write_whole(&body, &bytes)?;
        }
        let motion = incident.at(saved.time).map_err(CheckpointError::Motion)?;
        let motion = encode(&motion).map_err(CheckpointError::State)?;
        let own = sections_of(inputs, saved)?;
        let sections = sections_with(&own, saved).chain([(MOTION, motion.as_slice())]);
        Ok(write_sections(&self.kept(&name(time)), RUN, sections)?)
    }

    /// Times (s) of the states that were kept, in rising order; empty if there are none.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn kept_times(&self) -> Result<Vec<f64>, IoError> {
        let folder = self.results().join(FOLDER);
        let entries = match fs::read_dir(&folder) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries.map_err(IoError::file(&folder))?,
        };
        let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        let mut times: Vec<f64> = names.filter_map(|name| time_of(&name)).collect();
        times.sort_by(f64::total_cmp);
        Ok(times)
    }

    /// Reads the state that was kept at a time (s).
    ///
    /// # Errors
    /// [`CheckpointError::NoState`] with the times of the states that exist; a file that cannot be read.
    pub fn read_kept(&self, time: f64) -> Result<KeptState, CheckpointError> {
        let available = self.kept_times()?;
        let near = |kept: &&f64| (*kept - time).abs() <= 1e-9 * kept.abs();
        let Some(&found) = available.iter().find(near) else {
            return Err(CheckpointError::NoState {
                folder: self.results().into(),
                time,
                available,
            });
        };
        let file = self.kept(&name(found));
        let mut sections = read_sections(&file, RUN)?;
        let motion = decoded(&file, &sections, MOTION)?;
        sections.retain(|section| section.name != MOTION);
        let (inputs, run) = run_of(&file, sections)?;
        let stages = self.kept(STAGES);
        let body = if stages.is_file() {
            Some(read_body(&stages)?.1)
        } else {
            None
        };
        Ok(KeptState {
            inputs,
            body,
            run: run.without_observers(),
            file,
            motion,
        })
    }

    /// Removes the states that an earlier run in the folder has kept.
    pub(super) fn remove_kept(&self) -> Result<(), IoError> {
        let states = self.kept_times()?.into_iter().map(name);
        for file in states.chain([STAGES.into()]).map(|name| self.kept(&name)) {
            remove(&file)?;
        }
        // Other files of the user's in the folder keep it.
        let _ = fs::remove_dir(self.results().join(FOLDER));
        Ok(())
    }
}

/// Name of the file of a state at a time (s).
fn name(time: f64) -> String {
    format!("{time}{ENDING}")
}

fn time_of(name: &str) -> Option<f64> {
    name.strip_suffix(ENDING)?.parse().ok()
}
