//! Results folder of a run.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

use powerhouse_io::{
    IoError, TableColumn, free_space, write_noted_table, write_summary, write_table, write_whole,
};
use powerhouse_model::{Mesh, StageReport};
use powerhouse_observe::{Column, HistoryTable, Snapshot, SnapshotSink};

#[cfg(feature = "pictures")]
use crate::drawing;
use crate::joints::JointFacets;
use crate::lock::{FolderLock, TRIES, unique};
use crate::running::RunningTables;
use crate::stages::{NoStages, StageFiles};
use crate::summary::{BegunSummary, RunSummary};
use crate::{result_files, vtu};
#[cfg(feature = "pictures")]
use powerhouse_scene::ResultTable;
use powerhouse_scene::{
    Error, FolderError, Results, RunNotes, Simulation, StageSink, TableForm, file_name,
};

/// Results folder: writes the result files of a run.
///
/// | file | content |
/// |---|---|
/// | `NAME.csv`, `NAME/NAME.csv` and their plots | tables and lists of the [items](powerhouse_scene::OutputItem) of a program |
/// | `summary.json` | steps, step, wall time, peaks, energies at the end, warnings and remarks, the names of all files; written last, `incomplete` until then |
/// | `histories.csv` | histories and relative displacements |
/// | `accelerations.csv` | accelerations of the histories up to the band, at short even intervals: the source of peaks and spectra |
/// | `sections.csv` | section forces |
/// | `rings/NAME.csv`, `plots/ring-NAME.svg` | forces of the sections around a lining against their angle: at the start, least and greatest |
/// | `capacity/NAME.csv`, `plots/capacity-NAME.svg` | normal forces and moments that a reinforced section bears; with those of the run |
/// | `energies.csv` | energy balance |
/// | `joints.csv` | contact state, slip, opening, tractions and energies of joints and of zones of them |
/// | `joints/NAME.vtu` | facets of a joint at the end: contact state, slip, opening, energies, times of first slip and crack, greatest tractions |
/// | `plots/NAME.svg`, `plots/joint-NAME.svg` | plot of each history |
/// | `envelope.vtu` | greatest values with their times |
/// | `state.vtu` | envelopes of the history variables of laws, such as damage, with times; damage type and yield state at the end |
/// | `pictures/NAME.png` | picture of each envelope on the body, sectioned in the middle |
/// | `pictures/NAME-structure.png` | the same, of the surroundings of the parts that touch no absorbing face |
/// | `pictures/joint-NAME-WHAT.png` | picture of the facets of a joint: final contact state and bond, contact states reached in the run, slip and peak opening if there were any |
/// | `stages/NUMBER-NAME.vtu` | body at the end of a stage: displacement, stress, history variables of laws, active elements; also the facets of joints (`-JOINT.vtu`) and the axial forces of bolts (`-BOLTS.csv`) |
/// | `bolts.csv`, `plots/bolts-NAME.svg` | greatest axial force of each bolt group against time |
/// | `bolts/NAME.csv` | axial forces of a bolt group at the end and their greatest values over the run, by segment |
/// | `snapshots.pvd` and a folder beside it | snapshots of fields and of the facets of joints, for ParaView |
/// | `scene.toml` | scene file of the run |
///
/// Inactive elements (excavated, or not yet cast) are left out of pictures; in VTU files the field `present` is 0 (1
/// for active ones) and all other fields are NaN or -1 (see [`powerhouse_io::VtuWriter`]).
///
/// Every file is written completely or not at all, but for the tables of histories during the run, which
/// [grow](Self::tables) by whole lines. Before a run, [`lock`](Self::lock) excludes other runs,
/// [`prove`](Self::prove) checks that all files can be written, and [`clear`](Self::clear) removes the results of an
/// earlier run.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    path: PathBuf,
}

/// Name of the copy of the scene.
pub(crate) const SCENE: &str = "scene.toml";
/// Name of the snapshot collection file.
pub(crate) const SNAPSHOTS: &str = "snapshots.pvd";
/// Name of the subfolder of stages.
pub(crate) const STAGES: &str = "stages";
/// Name of the summary file, which marks a results folder.
pub(crate) const SUMMARY: &str = "summary.json";
/// Name of the envelope file.
pub(crate) const ENVELOPE: &str = "envelope.vtu";
/// Name of the file of history variable envelopes.
pub(crate) const STATE: &str = "state.vtu";
/// End of the names of pictures of the structure.
pub(crate) const CLOSE_UP: &str = "structure";
/// Subfolders of results with the start and the end of the names of their files, and whether these are removed without a summary.
const FOLDERS: [(&str, &str, &str, bool); 9] = [
    ("snapshots", "snapshots_", ".vtu", true),
    (STAGES, "", ".vtu", true),
    (STAGES, "", ".csv", true),
    ("plots", "", ".svg", false),
    ("pictures", "", ".png", false),
    ("joints", "", ".vtu", false),
    ("bolts", "", ".csv", false),
    ("capacity", "", ".csv", false),
    ("rings", "", ".csv", false),
];
/// Start of the names of test files.
const PROBE: &str = ".writable";

impl ResultFolder {
    /// Results folder at a path; it is created with its first file or by [`create`](Self::create).
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }
    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Creates the folder, and checks that files can be written in it.
    ///
    /// # Errors
    /// File that could not be written.
    pub fn create(&self) -> Result<(), Error> {
        probe(&self.path.join(PROBE))
    }

    /// Checks without a trace that the folder exists and files can be written in it, or that it can be created.
    ///
    /// # Errors
    /// [`FolderError::Unwritable`].
    pub fn check_writable(&self) -> Result<(), Error> {
        // A folder that another run removes between two operations is sought again.
        let mut tries = 0..TRIES;
        let probed = loop {
            let mut existing =
                std::path::absolute(&self.path).unwrap_or_else(|_| self.path.clone());
            while !existing.exists() && existing.pop() {}
            let file = existing.join(format!("{PROBE}-{}", unique()));
            match fs::write(&file, b"").and_then(|()| fs::remove_file(&file)) {
                Err(source) if source.kind() == ErrorKind::NotFound && tries.next().is_some() => {}
                probed => break probed,
            }
        };
        probed.map_err(|source| {
            let folder = self.path.clone();
            FolderError::Unwritable { folder, source }.into()
        })
    }

    /// Locks the folder for one run until the lock is dropped; creates the folder if there is none.
    ///
    /// # Errors
    /// [`FolderError::Busy`] if another run holds the lock; the file that could not be written.
    pub fn lock(&self) -> Result<FolderLock, Error> {
        FolderLock::take(&self.path)
    }

    /// Path of the copy of the scene among the results.
    pub fn scene(&self) -> PathBuf {
        self.path.join(SCENE)
    }

    /// Checks that the copy of a scene among the results would not take the place of the scene file itself.
    ///
    /// # Errors
    /// [`FolderError::OfScene`].
    pub fn keep_scene(&self, scene: &Path) -> Result<(), Error> {
        match (scene.canonicalize(), self.scene().canonicalize()) {
            (Ok(file), Ok(copy)) if file == copy => {
                let scene = scene.to_path_buf();
                Err(FolderError::OfScene { scene }.into())
            }
            _ => Ok(()),
        }
    }

    /// Checks that a run can write all its files: that no folder has the path of a file, that the system permits the
    /// lengths of their names, and that the free disk space is at least their size (bytes), if the system reports
    /// it. No test file remains, and files of earlier runs are kept.
    ///
    /// # Errors
    /// [`FolderError::InTheWay`], [`FolderError::NoRoom`], or the file that could not be written.
    pub fn prove(&self, simulation: &Simulation, size: u64) -> Result<(), Error> {
        let mut longest: BTreeMap<PathBuf, usize> = BTreeMap::new();
        for name in result_files(simulation) {
            let file = self.path.join(name);
            if file.is_dir() {
                return Err(FolderError::InTheWay { file }.into());
            }
            let length = file.file_name().map_or(0, |name| name.len());
            let folder = file.parent().unwrap_or(&self.path).to_path_buf();
            let known = longest.entry(folder).or_default();
            *known = length.max(*known);
        }
        for (folder, length) in longest {
            let was_there = folder.is_dir();
            // A test file with a name as long as the longest, which no other file has.
            probe(&folder.join(format!("{PROBE:x<length$}")))?;
            if !was_there {
                // The folder remains if a file was put there meanwhile.
                let _ = fs::remove_dir(&folder);
            }
        }
        match free_space(&self.path) {
            Some(free) if free < size => {
                let (folder, needed) = (self.path.clone(), size);
                Err(FolderError::NoRoom {
                    folder,
                    needed,
                    free,
                }
                .into())
            }
            _ => Ok(()),
        }
    }

    /// Removes the results of an earlier run: its snapshots and stages, and, if there is a summary of this software, the
    /// summary, tables, envelopes, plots, pictures and the files of joints and bolts. All other files are kept, including
    /// a scene; a folder without results is left as it is.
    ///
    /// # Errors
    /// File that could not be removed.
    pub fn clear(&self) -> Result<(), Error> {
        let mut old = vec![self.path.join(SNAPSHOTS)];
        let of_results = self.files_of_results();
        for (folder, start, end, is_own) in FOLDERS {
            if is_own || of_results.is_some() {
                old.extend(self.files_in(folder, start, end));
            }
        }
        if let Some(files) = of_results {
            old.extend(files.into_iter().map(|file| self.path.join(file)));
            old.extend([ENVELOPE, STATE].map(|file| self.path.join(file)));
            // The summary is removed last, so that the removal can be repeated after a failure.
            old.push(self.path.join(SUMMARY));
        }
        for file in old {
            remove(&file)?;
        }
        Ok(())
    }

    /// Removes the unfinished files that a killed run has left: temporary and test files, whose names no result has.
    ///
    /// # Errors
    /// File that could not be removed.
    pub fn remove_unfinished(&self) -> Result<(), Error> {
        let mut folders: BTreeSet<String> = ["", "checkpoint"].map(String::from).into();
        folders.extend(FOLDERS.map(|(folder, ..)| folder.into()));
        let of_results = self.files_of_results().unwrap_or_default();
        let parents = of_results.iter().filter_map(|file| file.rsplit_once('/'));
        folders.extend(parents.map(|(folder, _)| folder.to_owned()));
        for folder in &folders {
            for file in self.files_in(folder, "", "") {
                let name = file.file_name().unwrap_or_default().to_string_lossy();
                if name.starts_with(PROBE) || is_unfinished(&name) {
                    remove(&file)?;
                }
            }
        }
        Ok(())
    }

    /// The files that a summary of this software in the folder lists, but for the scene; none without one.
    fn files_of_results(&self) -> Option<Vec<String>> {
        let text = fs::read(self.path.join(SUMMARY)).ok()?;
        let summary: serde_json::Value = serde_json::from_slice(&text).ok()?;
        let software = summary["software"].as_str()?;
        let is_below = |file: &&str| {
            let mut parts = Path::new(file).components();
            !["", SCENE].contains(file) && parts.all(|part| matches!(part, Component::Normal(_)))
        };
        let files = ["files", "tables"].map(|key| summary[key].as_array());
        let files = files.into_iter().flatten().flatten();
        let files = files.filter_map(|file| file.as_str()).filter(is_below);
        let files = files.map(str::to_owned).collect();
        software.starts_with("powerhouse ").then_some(files)
    }

    /// Files of a subfolder whose names have the given start and end.
    fn files_in(&self, folder: &str, start: &str, end: &str) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.path.join(folder)).into_iter().flatten();
        let files = entries.flatten().filter(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            name.starts_with(start) && name.ends_with(end)
        });
        files.map(|entry| entry.path()).collect()
    }

    /// Marks the folder as that of a run that has begun: a summary without results, of the state `incomplete`, which
    /// remains if the run is killed. It lists the tables that grow.
    ///
    /// # Errors
    /// File that could not be written.
    pub fn begin(&self, simulation: &Simulation) -> Result<(), Error> {
        let mut summary = BegunSummary::new(simulation.title());
        summary.tables = simulation.tables().map(TableForm::file).collect();
        write_summary(&self.path.join(SUMMARY), &summary)?;
        Ok(())
    }

    /// Marks the folder as that of a run that was interrupted in a construction stage, before the motion: a summary of the
    /// state `stopped` with the completed stages, given by their reports.
    ///
    /// # Errors
    /// File that could not be written.
    pub fn interrupt(
        &self,
        title: &str,
        stage: &str,
        completed: &[StageReport],
    ) -> Result<(), Error> {
        self.end_before_motion(BegunSummary::stopped(title, stage), completed)
    }

    /// Marks the folder as that of a run that failed before the motion, in a stage or in the transfer to the run: a summary
    /// of the state `failed` with the error and the completed stages, given by their reports.
    ///
    /// # Errors
    /// File that could not be written.
    pub fn fail(&self, title: &str, error: &Error, completed: &[StageReport]) -> Result<(), Error> {
        self.end_before_motion(BegunSummary::failed(title, &error.to_string()), completed)
    }

    fn end_before_motion(
        &self,
        summary: BegunSummary,
        completed: &[StageReport],
    ) -> Result<(), Error> {
        let files = match completed {
            [] => Vec::new(),
            _ => self.names(&self.files_of_stages()),
        };
        let summary = summary.with_stages(completed, files);
        write_summary(&self.path.join(SUMMARY), &summary)?;
        Ok(())
    }

    /// Paths of the files of stages, in order.
    fn files_of_stages(&self) -> Vec<PathBuf> {
        let mut files = self.files_in(STAGES, "", ".vtu");
        files.extend(self.files_in(STAGES, "", ".csv"));
        files.sort();
        files
    }

    /// Paths relative to the folder.
    fn names(&self, files: &[PathBuf]) -> Vec<String> {
        let below = files.iter();
        below
            .filter_map(|file| file.strip_prefix(&self.path).ok())
            .map(|file| file.to_string_lossy().replace('\\', "/"))
            .collect()
    }

    /// Tables of histories, which grow in the folder while the run goes on.
    pub fn tables(&self) -> RunningTables {
        RunningTables::new(&self.path)
    }

    /// Snapshot writer for the body and the sides of its joints: VTU files and a PVD collection. That of a simulation
    /// without requests of snapshots writes nothing.
    ///
    /// # Errors
    /// Mesh that VTU files cannot represent.
    pub fn snapshots(&self, simulation: &Simulation) -> Result<Box<dyn SnapshotSink>, Error> {
        if simulation.output().snapshots.is_none() {
            return Ok(Box::new(|_: &Snapshot| Ok(())));
        }
        let body = (&**simulation.mesh(), simulation.present());
        let file = self.path.join(SNAPSHOTS);
        Ok(vtu::snapshots(file, body, simulation.joint_surfaces())?)
    }

    /// Stage writer: state of the body, joints and bolts at the end of every construction stage. That of a simulation
    /// without stages writes nothing.
    ///
    /// # Errors
    /// Mesh that VTU files cannot represent.
    pub fn stages(&self, simulation: &Simulation) -> Result<Box<dyn StageSink>, Error> {
        let (mesh, joints) = (simulation.mesh(), simulation.joint_surfaces());
        if simulation.stages().is_empty() {
            return Ok(Box::new(NoStages));
        }
        let files = StageFiles::new(self.path.join(STAGES), mesh, joints)?;
        Ok(Box::new(files))
    }

    /// Writes the results, and the text of the scene if there is one; returns the paths of all files, including those
    /// of snapshots and stages written during the run. All other files are written even if one fails. The summary
    /// has the state `incomplete` until all other files are written.
    ///
    /// # Errors
    /// First file that could not be written.
    pub fn write(
        &self,
        (title, mesh): (&str, &Mesh),
        results: &Results,
        notes: &RunNotes,
        scene: Option<&str>,
    ) -> Result<Vec<PathBuf>, Error> {
        let mut files = Files {
            folder: &self.path,
            written: Vec::new(),
            failure: None,
        };
        let mut summary = RunSummary::new(title, mesh, results, notes);
        let ended = summary.interrupt("its files are not all written");
        files.write(SUMMARY, |file| write_summary(file, &summary));
        files.written.clear();
        if let Some(text) = scene {
            files.write(SCENE, |file| write_whole(file, text.as_bytes()));
        }
        write_tables(&mut files, results, notes);
        let present = results.present.as_deref();
        let envelope = results.envelope.as_ref();
        let envelope = envelope.map(|envelope| vtu::EnvelopeFields::new(envelope, mesh));
        let state = results.state.as_ref();
        let state = state.map(|state| vtu::EnvelopeFields::of_state(state, mesh));
        let time = results.run.time;
        #[cfg(feature = "pictures")]
        let shown = drawing::Shown {
            title,
            mesh,
            present,
            time,
        };
        #[cfg(feature = "pictures")]
        let close_up = drawing::close_up(mesh, results.structure);
        for (name, fields) in [(ENVELOPE, envelope), (STATE, state)] {
            let Some(fields) = fields else {
                continue;
            };
            files.write(name, |file| fields.write(file, (mesh, present), time));
            #[cfg(feature = "pictures")]
            for (name, field, unit) in fields.peaks() {
                let plain = file_name(name);
                files.write(&format!("pictures/{plain}.png"), |file| {
                    shown.picture(file, (name, unit), field, None)
                });
                if let Some(close_up) = close_up {
                    files.write(&format!("pictures/{plain}-{CLOSE_UP}.png"), |file| {
                        shown.picture(file, (name, unit), field, Some(close_up))
                    });
                }
            }
        }
        for (surface, table) in results.joint_surfaces.iter().zip(&results.joints) {
            let plain = file_name(&table.name);
            let name = format!("joints/{plain}.vtu");
            let facets = JointFacets::new(&self.path.join(&name), mesh, surface, present)?;
            let Some(facets) = facets else {
                continue;
            };
            files.write(&name, |file| facets.write(file, table, results.run.time));
            #[cfg(feature = "pictures")]
            for picture in facets.pictures(table) {
                let what = file_name(picture.name);
                files.write(&format!("pictures/joint-{plain}-{what}.png"), |file| {
                    drawing::joint_picture(file, mesh, &table.name, &picture)
                });
            }
        }
        if results.snapshots > 0 {
            files.written.push(self.path.join(SNAPSHOTS));
        }
        if !results.stages.is_empty() {
            files.written.extend(self.files_of_stages());
        }
        // Written last, so that a complete summary implies that all files exist.
        if files.failure.is_none() {
            summary.complete(ended, self.names(&files.written));
        }
        files.write(SUMMARY, |file| write_summary(file, &summary));
        match files.failure {
            Some(failure) => Err(failure.into()),
            None => Ok(files.written),
        }
    }
}

/// Writes the tables and their plots.
fn write_tables(files: &mut Files, results: &Results, notes: &RunNotes) {
    for table in &results.tables {
        if !table.rows.times.is_empty() {
            let heads = table.form.topic.map(|topic| notes.about(topic));
            let columns = columns(&table.rows);
            files.write(&table.form.file(), |file| {
                write_noted_table(file, &heads.unwrap_or_default(), &columns)
            });
        }
    }
    for list in &results.lists {
        files.write(&format!("{}.csv", list.name), |file| {
            write_table(file, &list.columns)
        });
        #[cfg(feature = "pictures")]
        if let Some((name, plot)) = &list.plot {
            files.write(name, |file| drawing::list_plot(file, plot));
        }
    }
    #[cfg(feature = "pictures")]
    for ResultTable { form, rows, .. } in &results.tables {
        for plot in form.plots(rows) {
            if !rows.times.is_empty() {
                let columns = with_times(rows, plot.columns);
                files.write(&plot.file, |file| {
                    drawing::table_plot(file, &plot.title, &columns)
                });
            }
        }
    }
}

/// Whether a file has the name of an incomplete one: `NAME.PROCESS.part`.
fn is_unfinished(name: &str) -> bool {
    let start = name
        .strip_suffix(".part")
        .and_then(|start| start.rsplit_once('.'));
    start.is_some_and(|(_, process)| {
        !process.is_empty() && process.bytes().all(|byte| byte.is_ascii_digit())
    })
}

/// Removes a file if it exists.
fn remove(file: &Path) -> Result<(), Error> {
    match fs::remove_file(file) {
        Err(source) if source.kind() != ErrorKind::NotFound => Err(Error::Write(IoError::File {
            file: file.into(),
            source,
        })),
        _ => Ok(()),
    }
}

/// Writes an empty file and removes it.
fn probe(file: &Path) -> Result<(), Error> {
    write_whole(file, b"")?;
    remove(file)
}

/// Paths of the written files, and the first failure.
struct Files<'a> {
    folder: &'a Path,
    written: Vec<PathBuf>,
    failure: Option<IoError>,
}

impl Files<'_> {
    fn write(&mut self, name: &str, write: impl FnOnce(&Path) -> Result<(), IoError>) {
        let file = self.folder.join(name);
        match write(&file) {
            Ok(()) => self.written.push(file),
            Err(failure) => {
                self.failure.get_or_insert(failure);
            }
        }
    }
}

/// Columns of a table, times first.
fn columns(table: &HistoryTable) -> Vec<TableColumn> {
    let columns = table.columns.iter();
    with_times(
        table,
        columns.map(|column| (&*column.name, column)).collect(),
    )
}

/// Some columns of a table under names, times first.
fn with_times(table: &HistoryTable, columns: Vec<(&str, &Column)>) -> Vec<TableColumn> {
    let times = TableColumn::new("time", "s", table.times.clone());
    let columns = columns.into_iter();
    let columns = columns.map(|(name, c)| TableColumn::new(name, c.unit, c.values.clone()));
    core::iter::once(times).chain(columns).collect()
}
