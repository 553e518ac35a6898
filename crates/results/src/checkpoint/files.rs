//! Files of the checkpoints of a run.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use powerhouse_io::{FileSection, IoError, read_sections, write_sections};
use powerhouse_model::{SavedRun, SavedSection, StateError, decode, encode};

use super::RunInputs;
use powerhouse_scene::{CheckpointError, EquilibratedBody, StageSolution};

/// Subfolder of the results folder.
const FOLDER: &str = "checkpoint";
/// The last state of the dynamic run, and the one before it.
const RUNS: [&str; 2] = ["latest.run", "previous.run"];
/// The body after the last stage in static equilibrium, and the one before it.
pub(super) const BODIES: [&str; 2] = ["latest.stage", "previous.stage"];
/// The state of the static solution of a stage, and the one before it.
const SOLUTIONS: [&str; 2] = ["latest.solution", "previous.solution"];
/// Kinds and versions of the files; a version changes with the content.
pub(super) const RUN: (&str, u32) = ("checkpoint of a run", 7);
const BODY: (&str, u32) = ("checkpoint of a stage", 5);
const SOLUTION: (&str, u32) = ("checkpoint of a static solution", 5);
/// Section of the index of a stage.
const STAGE: &str = "stage";
/// Sections of the inputs, and of step and time.
const INPUTS: &str = "inputs";
const HEAD: &str = "head";

/// State from which a run is resumed.
#[derive(Debug)]
#[non_exhaustive]
pub struct ResumedRun {
    /// Inputs of the run.
    pub inputs: RunInputs,
    /// The body after the last stage in static equilibrium; none without stages, or before the first is computed.
    pub body: Option<EquilibratedBody>,
    /// State of the static solution of the next stage; none if it has not begun, or is complete.
    pub solution: Option<StageSolution>,
    /// State of the dynamic run; none if it has not begun.
    pub run: Option<SavedRun>,
    /// Checkpoints that were not used, each with its reason.
    pub unused: Vec<String>,
}

/// The checkpoint files of a results folder: two generations of the state of the dynamic run, and of the body at the end
/// of a stage. Every file is written completely or not at all, and on the disk before it replaces an older one.
#[derive(Clone, Debug)]
pub struct CheckpointFiles {
    results: PathBuf,
}

impl CheckpointFiles {
    /// The checkpoint files of a results folder.
    pub fn of(results: impl Into<PathBuf>) -> Self {
        Self {
            results: results.into(),
        }
    }
    pub(super) fn results(&self) -> &Path {
        &self.results
    }
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.results.join(FOLDER).join(name)
    }

    /// Makes the last generation of a file the one before, and returns the path of the last.
    fn next(&self, [latest, previous]: [&str; 2]) -> Result<PathBuf, IoError> {
        let latest = self.path(latest);
        match fs::rename(&latest, self.path(previous)) {
            Err(source) if source.kind() != ErrorKind::NotFound => {
                Err(IoError::file(&latest)(source))
            }
            _ => Ok(latest),
        }
    }

    /// Writes the state of a dynamic run.
    ///
    /// # Errors
    /// A file that cannot be written; the last state remains as the one before.
    pub fn write_run(&self, inputs: &RunInputs, saved: &SavedRun) -> Result<(), CheckpointError> {
        let own = sections_of(inputs, saved)?;
        Ok(write_sections(
            &self.next(RUNS)?,
            RUN,
            sections_with(&own, saved),
        )?)
    }

    /// Writes the state of the static solution of a stage.
    ///
    /// # Errors
    /// A file that cannot be written; the last state remains as the one before.
    pub fn write_solution(
        &self,
        inputs: &RunInputs,
        solution: &StageSolution,
    ) -> Result<(), CheckpointError> {
        let own = sections_of(inputs, &solution.saved)?;
        let stage = encode(&solution.stage).map_err(CheckpointError::State)?;
        let sections = sections_with(&own, &solution.saved).chain([(STAGE, stage.as_slice())]);
        Ok(write_sections(&self.next(SOLUTIONS)?, SOLUTION, sections)?)
    }

    /// Writes the body at the end of a stage, whose solution is then no longer needed.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_body(
        &self,
        inputs: &RunInputs,
        body: &EquilibratedBody,
    ) -> Result<(), CheckpointError> {
        let inputs = encode(inputs).map_err(CheckpointError::State)?;
        let [state, stages] = body.sections().map_err(CheckpointError::State)?;
        let names = EquilibratedBody::SECTIONS;
        let sections = [
            (INPUTS, inputs.as_slice()),
            (names[0], state.as_slice()),
            (names[1], stages.as_slice()),
        ];
        write_sections(&self.next(BODIES)?, BODY, sections)?;
        for name in SOLUTIONS {
            remove(&self.path(name))?;
        }
        Ok(())
    }

    /// Reads the newest checkpoint that is whole: of the dynamic run, and of the last stage.
    ///
    /// # Errors
    /// [`CheckpointError::None`] if there is none, and the reasons for which those that exist cannot be used.
    pub fn read(&self) -> Result<ResumedRun, CheckpointError> {
        let mut unused = Vec::new();
        let run = newest(RUNS.map(|name| self.path(name)), read_run, &mut unused)?;
        let body = newest(BODIES.map(|name| self.path(name)), read_body, &mut unused)?;
        let files = SOLUTIONS.map(|name| self.path(name));
        let solution = newest(files, read_solution, &mut unused)?;
        let own = [
            run.as_ref().map(|(inputs, _)| inputs),
            body.as_ref().map(|(inputs, _)| inputs),
            solution.as_ref().map(|(inputs, _)| inputs),
        ];
        let Some(inputs) = own.into_iter().flatten().next().cloned() else {
            return Err(CheckpointError::None {
                folder: self.results.clone(),
            });
        };
        let completed = body.as_ref().map_or(0, |(_, body)| body.stages().len());
        let solution = solution.map(|(_, solution)| solution);
        Ok(ResumedRun {
            inputs,
            solution: solution.filter(|solution| solution.stage == completed),
            body: body.map(|(_, body)| body),
            run: run.map(|(_, run)| run),
            unused,
        })
    }

    /// Accepts the inputs of a run that is to be resumed.
    ///
    /// # Errors
    /// [`CheckpointError::OtherRun`] with the inputs that have changed.
    pub fn check(&self, found: &RunInputs, here: &RunInputs) -> Result<(), CheckpointError> {
        let changed = found.differences(here);
        if changed.is_empty() {
            Ok(())
        } else {
            Err(CheckpointError::OtherRun {
                file: self.results.join(FOLDER),
                what: changed.join(", "),
            })
        }
    }

    /// Removes all checkpoint files and the states that were kept, as before a new run.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn clear(&self) -> Result<(), IoError> {
        self.remove()?;
        self.remove_kept()
    }

    /// Removes the checkpoint files, as when the run is complete; states that were kept remain.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn remove(&self) -> Result<(), IoError> {
        for name in RUNS.into_iter().chain(BODIES).chain(SOLUTIONS) {
            remove(&self.path(name))?;
        }
        // Other files of the user's in the folder keep it.
        let _ = fs::remove_dir(self.results.join(FOLDER));
        Ok(())
    }
}

/// Removes a file if it exists.
pub(super) fn remove(file: &Path) -> Result<(), IoError> {
    match fs::remove_file(file) {
        Err(source) if source.kind() != ErrorKind::NotFound => Err(IoError::file(file)(source)),
        _ => Ok(()),
    }
}

/// Encoded inputs of a run, and number of steps, time and step of its state.
pub(super) fn sections_of(
    inputs: &RunInputs,
    saved: &SavedRun,
) -> Result<[Vec<u8>; 2], CheckpointError> {
    let inputs = encode(inputs).map_err(CheckpointError::State)?;
    let head = encode(&(saved.done, saved.time, saved.step)).map_err(CheckpointError::State)?;
    Ok([inputs, head])
}

/// Sections of the file of a state, the encoded ones first.
pub(super) fn sections_with<'a>(
    [inputs, head]: &'a [Vec<u8>; 2],
    saved: &'a SavedRun,
) -> impl Iterator<Item = (&'a str, &'a [u8])> {
    let own = [(INPUTS, inputs.as_slice()), (HEAD, head.as_slice())];
    let parts = saved.sections.iter();
    let parts = parts.map(|section| (section.name.as_str(), section.bytes.as_slice()));
    own.into_iter().chain(parts)
}

/// The last of two generations that can be read; none if neither exists. Adds the reason for which the last is not used.
fn newest<T>(
    files: [PathBuf; 2],
    read: impl Fn(&Path) -> Result<T, CheckpointError>,
    unused: &mut Vec<String>,
) -> Result<Option<T>, CheckpointError> {
    let [latest, previous] = files.map(|file| read(&file));
    match (latest, previous) {
        (Ok(found), _) => Ok(Some(found)),
        (Err(latest), Err(previous)) if latest.is_absent() && previous.is_absent() => Ok(None),
        (Err(latest), Ok(found)) => {
            if !latest.is_absent() {
                unused.push(latest.to_string());
            }
            Ok(Some(found))
        }
        (Err(latest), Err(previous)) if previous.is_absent() => Err(latest),
        (Err(latest), Err(previous)) if latest.is_absent() => Err(previous),
        (Err(latest), Err(previous)) => Err(CheckpointError::Both {
            latest: Box::new(latest),
            previous: Box::new(previous),
        }),
    }
}

/// Decodes the section of a file with a name.
pub(super) fn decoded<T: serde::de::DeserializeOwned>(
    file: &Path,
    sections: &[FileSection],
    name: &str,
) -> Result<T, CheckpointError> {
    let found = sections.iter().find(|section| section.name == name);
    let bytes = found.ok_or(StateError::Missing);
    let value = bytes.and_then(|section| decode(&section.bytes));
    value.map_err(|source| CheckpointError::Section {
        file: file.into(),
        section: name.into(),
        source,
    })
}

fn read_run(file: &Path) -> Result<(RunInputs, SavedRun), CheckpointError> {
    run_of(file, read_sections(file, RUN)?)
}

/// Inputs and state of a run in the sections of a file.
pub(super) fn run_of(
    file: &Path,
    sections: Vec<FileSection>,
) -> Result<(RunInputs, SavedRun), CheckpointError> {
    let inputs = decoded(file, &sections, INPUTS)?;
    let (done, time, step) = decoded(file, &sections, HEAD)?;
    let mut saved = SavedRun::new(done, time, step);
    let parts = sections.into_iter();
    let parts = parts.filter(|section| ![INPUTS, HEAD].contains(&section.name.as_str()));
    saved.sections = parts
        .map(|FileSection { name, bytes }| SavedSection { name, bytes })
        .collect();
    Ok((inputs, saved))
}

fn read_solution(file: &Path) -> Result<(RunInputs, StageSolution), CheckpointError> {
    let mut sections = read_sections(file, SOLUTION)?;
    let stage = decoded(file, &sections, STAGE)?;
    sections.retain(|section| section.name != STAGE);
    let (inputs, saved) = run_of(file, sections)?;
    Ok((inputs, StageSolution::new(stage, Arc::new(saved))))
}

pub(super) fn read_body(file: &Path) -> Result<(RunInputs, EquilibratedBody), CheckpointError> {
    let sections = read_sections(file, BODY)?;
    let inputs = decoded(file, &sections, INPUTS)?;
    let body = EquilibratedBody::of_sections(&sections);
    let body = body.map_err(|source| CheckpointError::Section {
        file: file.into(),
        section: EquilibratedBody::SECTIONS.join(" and "),
        source,
    })?;
    Ok((inputs, body))
}
