//! Fields of the body after a run: pictures, animations and values along a line from the snapshots in a result folder, or
//! from any VTU file that a run has written.

mod line;
mod picture;
mod quantity;

use std::path::{Path, PathBuf};

use powerhouse::io::{VtkHdf, VtuGrid, available_memory, read_pvd, read_vtu};
use serde_json::Value;

pub use line::{FieldLine, LineTable};
pub use picture::{Animation, DeformationFactor, FieldPicture};
pub use quantity::{FieldPart, FieldQuantity, ScalarField};

use powerhouse_study::StudyError;
use powerhouse_study::internal::read_json;

/// Collection of the snapshots in a result folder.
const SNAPSHOTS: &str = "snapshots.pvd";
/// Title of a run in its summary.
const SUMMARY: &str = "summary.json";

/// Fields of a body at one or more times, in VTU files: the snapshots of a run, or one file.
#[derive(Clone, Debug)]
pub struct RecordedFields {
    title: String,
    folder: PathBuf,
    /// Time (s), if it is known before the file is read, and file, in rising order.
    instants: Vec<(Option<f64>, PathBuf)>,
}

impl RecordedFields {
    /// The snapshots in a result folder, or the one instant of a VTU file.
    ///
    /// # Errors
    /// [`StudyError::NoSnapshots`]; a collection that cannot be read.
    pub fn at(path: impl Into<PathBuf>) -> Result<Self, StudyError> {
        let mut path = path.into();
        // The list of the snapshots, and the folder of their files, stand for the folder of the results.
        let list = path.with_file_name(SNAPSHOTS);
        if list.exists() && (path == list || path == list.with_extension("")) {
            path = match path.parent() {
                Some(folder) if !folder.as_os_str().is_empty() => folder.into(),
                _ => ".".into(),
            };
        }
        if !path.is_dir() {
            return Ok(Self::of_file(path));
        }
        let list = path.join(SNAPSHOTS);
        let entries = if list.exists() {
            read_pvd(&list).map_err(powerhouse::Error::from)?
        } else {
            Vec::new()
        };
        // Part 0 is the body, others are its joints.
        let body = entries.into_iter().filter(|entry| entry.part == 0);
        let mut instants: Vec<(Option<f64>, PathBuf)> =
            body.map(|entry| (Some(entry.time), entry.file)).collect();
        if instants.is_empty() {
            return Err(StudyError::NoSnapshots { folder: path });
        }
        instants.sort_by(|(a, _), (b, _)| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        Ok(Self {
            title: title(&path).unwrap_or_default(),
            folder: path,
            instants,
        })
    }

    /// The one instant of a file; its time is known if it is one of the snapshots.
    fn of_file(path: PathBuf) -> Self {
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        // Files of stages and snapshots are a folder deeper.
        let above = folder.parent().unwrap_or(Path::new("")).to_path_buf();
        let title = title(&folder).or_else(|| title(&above));
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let snapshots = read_pvd(&above.join(SNAPSHOTS)).unwrap_or_default();
        let own = snapshots.iter().find(|entry| entry.file == path);
        Self {
            title: title.map_or_else(|| name.clone().into(), |title| format!("{title}, {name}")),
            folder,
            instants: vec![(own.map(|entry| entry.time), path)],
        }
    }

    /// Title of the run.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Folder of the results.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Number of instants.
    pub fn len(&self) -> usize {
        self.instants.len()
    }

    /// Whether there is no instant, which does not occur.
    pub fn is_empty(&self) -> bool {
        self.instants.is_empty()
    }

    /// Times of the instants (s) as far as they are known before files are read: of snapshots all, of one file none.
    pub fn times(&self) -> impl Iterator<Item = f64> + '_ {
        self.instants.iter().filter_map(|(time, _)| *time)
    }

    /// Index of the instant nearest to a time (s); without a time, or of one file, of the last one.
    pub fn nearest(&self, time: Option<f64>) -> usize {
        let distance = |index: &usize| match (time, self.instants[*index].0) {
            (Some(wanted), Some(time)) => (time - wanted).abs(),
            _ => 0.0,
        };
        let nearest = (0..self.len()).rev();
        let nearest = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.unwrap_or(0)
    }

    /// Indices of the instants between two times (s), both included; without a time, from the first or to the last.
    pub fn between(&self, from: Option<f64>, to: Option<f64>) -> Vec<usize> {
        let is_within = |index: &usize| {
            self.instants[*index].0.is_none_or(|time| {
                from.is_none_or(|from| time >= from) && to.is_none_or(|to| time <= to)
            })
        };
        (0..self.len()).filter(is_within).collect()
    }

    /// Mesh and fields of an instant; its time is that of a snapshot, none for other files.
    ///
    /// # Errors
    /// A file that cannot be read.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn read(&self, index: usize) -> Result<VtuGrid, StudyError> {
        let (time, file) = &self.instants[index];
        let mut grid = read_vtu(file).map_err(powerhouse::Error::from)?;
        // The time of other files is the end of the run, or the number of a stage.
        grid.time = *time;
        Ok(grid)
    }

    /// Writes all instants as one VTKHDF file. Their fields have to fit into memory.
    ///
    /// # Errors
    /// A file that cannot be read or written; instants with other meshes or fields than the first; a file that is no
    /// snapshot; [`StudyError::Memory`] with more fields than the memory that is available.
    pub fn write_vtkhdf(&self, file: &Path) -> Result<(), StudyError> {
        let fault = |error| StudyError::from(powerhouse::Error::from(error));
        let mut all = VtkHdf::new(self.read(0)?, self.file(0)).map_err(fault)?;
        let needed = all.memory(self.len());
        if let Some(available) = available_memory().filter(|available| needed > *available) {
            return Err(StudyError::Memory { needed, available });
        }
        for index in 1..self.len() {
            all.add(&self.read(index)?, self.file(index))
                .map_err(fault)?;
        }
        all.write(file).map_err(fault)
    }

    /// Path of a new file about the fields: in a folder below the results, or beside the one file.
    pub fn place(&self, below: &str, name: &str) -> PathBuf {
        // The files of snapshots are a folder deeper than the results.
        if self.instants[0].1.parent() == Some(&self.folder) {
            self.folder.join(name)
        } else {
            self.folder.join(below).join(name)
        }
    }

    /// File of an instant.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn file(&self, index: usize) -> &Path {
        &self.instants[index].1
    }
}

/// Title of a run, from the summary in its folder.
fn title(folder: &Path) -> Option<String> {
    let summary: Value = read_json(&folder.join(SUMMARY)).ok()?;
    Some(summary["title"].as_str()?.to_owned())
}
