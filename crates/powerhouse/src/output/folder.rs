//! The files of a run.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use powerhouse_explicit_core::observe::{HistoryTable, SnapshotSink};
use powerhouse_io::{
    IoError, TableColumn, free_space, write_noted_table, write_summary, write_table, write_whole,
};
use powerhouse_model::Mesh;

use super::joints::JointFacets;
use super::lock::{FolderError, FolderLock};
use super::stages::StageFiles;
use super::summary::Summary;
use super::{Results, drawing, vtu};
use crate::doubt::{RunNotes, Topic};
use crate::{Error, Simulation, StageSink};

/// A folder that takes the files of a run.
///
/// | file | what |
/// |---|---|
/// | `summary.json` | steps, step, wall time, peaks, energies at the end, warnings and remarks, the names of all files; written last, `incomplete` until then |
/// | `histories.csv` | histories and relative displacements |
/// | `sections.csv` | section forces |
/// | `energies.csv` | the energy ledger |
/// | `joints.csv` | state, slip, opening, tractions and energies of joints and parts of them |
/// | `joints/NAME.vtu` | each joint's facets at the end with state, slip, opening, energies, times of first slip and crack, and greatest tractions |
/// | `plots/NAME.svg`, `plots/joint-NAME.svg` | each of them drawn |
/// | `envelope.vtu` | greatest values with their times |
/// | `state.vtu` | the envelopes of history variables of laws, such as damage, with times; damage type and yield state at the end |
/// | `pictures/NAME.png` | each of them on the body, cut open in its middle |
/// | `pictures/joint-NAME-WHAT.png` | each joint's facets with state and bond at the end, what they did over the run, slip and peak opening if there were any |
/// | `stages/NUMBER-NAME.vtu` | the body at the end of each stage: displacement, stress, the history variables of laws, which elements are there; beside it the facets of joints (`-JOINT.vtu`) and the axial forces of bolts (`-BOLTS.csv`) |
/// | `bolts.csv`, `plots/bolts-NAME.svg` | the greatest axial force of each make of bolts against time |
/// | `bolts/NAME.csv` | axial forces of bolts at the end and the greatest of the run, segment by segment |
/// | `snapshots.pvd` and a folder beside it | whole fields, and the facets of joints, for ParaView |
/// | `scene.toml` | the scene as it was run |
///
/// Where stages have excavated elements, or not cast them, pictures leave these out, and VTU files have the
/// field `present` (1 there, 0 not) and NaN or -1 in all others (see [`powerhouse_io::VtuWriter`]).
///
/// Every file is written whole or not at all. [`lock`](Self::lock), [`prove`](Self::prove) and
/// [`clear`](Self::clear) before a run see to it that its results find their place, and neither those of
/// another run nor older ones beside them.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    path: PathBuf,
}

/// The collection of snapshots.
pub(super) const SNAPSHOTS: &str = "snapshots.pvd";
/// The folder of stages.
pub(super) const STAGES: &str = "stages";
/// The file that marks a folder of results.
pub(super) const SUMMARY: &str = "summary.json";
/// Tables, with a plot of each of their names.
pub(super) const TABLES: [&str; 5] = [
    "histories.csv",
    SECTIONS,
    "energies.csv",
    "joints.csv",
    "bolts.csv",
];
/// Section forces; above their header stand doubts about them.
const SECTIONS: &str = "sections.csv";
/// Greatest values, with a picture of each.
pub(super) const ENVELOPE: &str = "envelope.vtu";
/// The envelopes of the laws' history variables, with a picture of each.
pub(super) const STATE: &str = "state.vtu";
/// The start of the name of a file that is only tried.
const PROBE: &str = ".writable";

impl ResultFolder {
    /// A folder, which is made with its first file or by [`create`](Self::create).
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }
    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Makes the folder, and sees that files can be written in it.
    ///
    /// # Errors
    /// The file that could not be written.
    pub fn create(&self) -> Result<(), Error> {
        probe(&self.path.join(PROBE))
    }

    /// Takes the folder for one run, until the lock is dropped; the folder is made if there is none.
    ///
    /// # Errors
    /// [`FolderError::Busy`] if another run has it; the file that could not be written.
    pub fn lock(&self) -> Result<FolderLock, Error> {
        FolderLock::take(&self.path)
    }

    /// Sees that a run can write all its files at its end: that each has a place and a name of a length that
    /// the system takes, and that there is room for their size (bytes), as far as the system tells. Nothing is
    /// left of what is tried, and files of earlier runs stay.
    ///
    /// # Errors
    /// [`FolderError::InTheWay`], [`FolderError::NoRoom`], or the file that could not be written.
    pub fn prove(&self, simulation: &Simulation, size: u64) -> Result<(), Error> {
        let mut longest: BTreeMap<PathBuf, usize> = BTreeMap::new();
        for name in simulation.result_files() {
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
            // As long as the longest name, and no file of anybody.
            probe(&folder.join(format!("{PROBE:x<length$}")))?;
            if !was_there {
                // It stays if somebody has put something there meanwhile.
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

    /// Removes what an earlier run left: its snapshots and stages, and, if there is a summary that this
    /// software wrote, tables, envelope, plots and pictures. Anything else in the folder stays, a
    /// scene too.
    ///
    /// # Errors
    /// The file that could not be removed.
    pub fn clear(&self) -> Result<(), Error> {
        let mut old = vec![self.path.join(SNAPSHOTS)];
        old.extend(self.files_in("snapshots", "snapshots_", ".vtu"));
        old.extend(self.files_in(STAGES, "", ".vtu"));
        old.extend(self.files_in(STAGES, "", ".csv"));
        if self.has_results() {
            old.extend(TABLES.iter().map(|table| self.path.join(table)));
            old.extend([ENVELOPE, STATE].map(|file| self.path.join(file)));
            old.extend(self.files_in("plots", "", ".svg"));
            old.extend(self.files_in("pictures", "", ".png"));
            old.extend(self.files_in("joints", "", ".vtu"));
            old.extend(self.files_in("bolts", "", ".csv"));
            // The mark goes last, so that a failure on the way can be made good.
            old.push(self.path.join(SUMMARY));
        }
        for file in old {
            remove(&file)?;
        }
        Ok(())
    }

    /// Whether a summary of this software is there.
    fn has_results(&self) -> bool {
        let text = fs::read(self.path.join(SUMMARY)).unwrap_or_default();
        let summary: serde_json::Value = serde_json::from_slice(&text).unwrap_or_default();
        let software = summary["software"].as_str();
        software.is_some_and(|name| name.starts_with("powerhouse "))
    }

    /// Files of a folder below, by the ends of their names.
    fn files_in(&self, folder: &str, start: &str, end: &str) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.path.join(folder)).into_iter().flatten();
        let files = entries.flatten().filter(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            name.starts_with(start) && name.ends_with(end)
        });
        files.map(|entry| entry.path()).collect()
    }

    /// A sink that writes snapshots of a run, and of the sides of its joints, as VTU files and a PVD
    /// collection.
    ///
    /// # Errors
    /// A mesh that VTU files cannot hold.
    pub fn snapshots(&self, simulation: &Simulation) -> Result<Box<dyn SnapshotSink>, Error> {
        let body = (&**simulation.mesh(), simulation.present());
        let file = self.path.join(SNAPSHOTS);
        Ok(vtu::snapshots(file, body, simulation.joint_surfaces())?)
    }

    /// A sink that writes what the stages of a scene leave of its body and of the sides of its joints.
    ///
    /// # Errors
    /// A mesh that VTU files cannot hold.
    pub fn stages(&self, simulation: &Simulation) -> Result<Box<dyn StageSink>, Error> {
        let (mesh, joints) = (simulation.mesh(), simulation.joint_surfaces());
        let files = StageFiles::new(self.path.join(STAGES), mesh, joints)?;
        Ok(Box::new(files))
    }

    /// Writes the results, and the scene's text if there is one; returns the files written, the
    /// collection of snapshots and those of stages, which stand there by then, among them. A file that
    /// cannot be written does not keep the others from it. The summary says that the run is incomplete until
    /// all others are there.
    ///
    /// # Errors
    /// The first file that could not be written.
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
        let mut summary = Summary::new(title, mesh, results, notes);
        let ended = summary.interrupt("its files are not all written");
        files.write(SUMMARY, |file| write_summary(file, &summary));
        files.written.clear();
        if let Some(text) = scene {
            files.write("scene.toml", |file| write_whole(file, text.as_bytes()));
        }
        self.write_tables(&mut files, results, notes);
        let present = results.present.as_deref();
        let envelope = results.envelope.as_ref();
        let envelope = envelope.map(|envelope| vtu::EnvelopeFields::new(envelope, mesh));
        let state = results.state.as_ref();
        let state = state.map(|state| vtu::EnvelopeFields::of_state(state, mesh));
        for (name, fields) in [(ENVELOPE, envelope), (STATE, state)] {
            let Some(fields) = fields else {
                continue;
            };
            let time = results.run.time;
            files.write(name, |file| fields.write(file, (mesh, present), time));
            for (name, field, unit) in fields.peaks() {
                files.write(
                    &format!("pictures/{}.png", drawing::file_name(name)),
                    |file| drawing::picture(file, (mesh, present), (name, unit), field),
                );
            }
        }
        for (surface, table) in results.joint_surfaces.iter().zip(&results.joints) {
            let plain = drawing::file_name(&table.name);
            let name = format!("joints/{plain}.vtu");
            let facets = JointFacets::new(&self.path.join(&name), mesh, surface, present)?;
            let Some(facets) = facets else {
                continue;
            };
            files.write(&name, |file| facets.write(file, table, results.run.time));
            for picture in facets.pictures(table) {
                let what = drawing::file_name(picture.name);
                files.write(&format!("pictures/joint-{plain}-{what}.png"), |file| {
                    drawing::joint_picture(file, mesh, &table.name, &picture)
                });
            }
        }
        if results.snapshots > 0 {
            files.written.push(self.path.join(SNAPSHOTS));
        }
        if !results.stages.is_empty() {
            let mut of_stages = self.files_in(STAGES, "", ".vtu");
            of_stages.extend(self.files_in(STAGES, "", ".csv"));
            of_stages.sort();
            files.written.extend(of_stages);
        }
        // Last, so that who finds it finds the others.
        if files.failure.is_none() {
            summary.complete(ended, files.names());
        }
        files.write(SUMMARY, |file| write_summary(file, &summary));
        match files.failure {
            Some(failure) => Err(failure.into()),
            None => Ok(files.written),
        }
    }

    /// Writes the tables and draws them.
    fn write_tables(&self, files: &mut Files, results: &Results, notes: &RunNotes) {
        let tables = [
            &results.histories,
            &results.sections,
            &results.energies,
            &results.joint_histories,
            &results.bolt_histories,
        ];
        for (name, table) in TABLES.into_iter().zip(tables) {
            if !table.times.is_empty() {
                let columns = columns(table);
                // Doubts about all of a run stand in its summary; these are about the numbers below.
                let heads = match name {
                    SECTIONS => notes.about(Topic::Sections),
                    _ => Vec::new(),
                };
                files.write(name, |file| write_noted_table(file, &heads, &columns));
            }
        }
        for (kind, table) in [
            ("", &results.histories),
            ("", &results.sections),
            ("joint-", &results.joint_histories),
            ("bolts-", &results.bolt_histories),
        ] {
            for (name, plot) in drawing::plots(&columns(table)) {
                files.write(&format!("plots/{kind}{name}.svg"), plot);
            }
        }
        if !results.energies.times.is_empty() {
            let columns = columns(&results.energies);
            files.write("plots/energies.svg", |file| {
                drawing::plot(file, "energies", &columns)
            });
        }
        for bolts in &results.bolts {
            let name = format!("bolts/{}.csv", drawing::file_name(&bolts.name));
            files.write(&name, |file| write_table(file, &bolts.columns()));
        }
    }
}

/// Removes a file, if it is there.
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

/// Keeps account of what is written, and of the first file that could not be.
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

    /// What was written, below the folder.
    fn names(&self) -> Vec<String> {
        let below = self
            .written
            .iter()
            .filter_map(|file| file.strip_prefix(self.folder).ok());
        below
            .map(|file| file.to_string_lossy().replace('\\', "/"))
            .collect()
    }
}

fn columns(table: &HistoryTable) -> Vec<TableColumn> {
    let times = TableColumn::new("time", "s", table.times.clone());
    let columns = table.columns.iter();
    let columns = columns.map(|c| TableColumn::new(c.name.clone(), c.unit, c.values.clone()));
    core::iter::once(times).chain(columns).collect()
}
