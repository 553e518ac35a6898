//! The files of a run.

use std::path::{Path, PathBuf};

use powerhouse_explicit_core::observe::{HistoryTable, SnapshotSink};
use powerhouse_io::{IoError, TableColumn, write_summary, write_table, write_whole};
use powerhouse_model::Mesh;

use super::summary::Summary;
use super::{Results, drawing, vtu};
use crate::{Error, Remark};

/// A folder that takes the files of a run.
///
/// | file | what |
/// |---|---|
/// | `summary.json` | steps, step, wall time, peaks, energies at the end, remarks |
/// | `histories.csv` | histories and relative displacements |
/// | `sections.csv` | section forces |
/// | `energies.csv` | the energy ledger |
/// | `plots/NAME.svg` | each of them drawn |
/// | `envelope.vtu` | greatest values with their times |
/// | `pictures/NAME.png` | each of them on the body, cut open in its middle |
/// | `snapshots.pvd` and a folder beside it | whole fields, for ParaView |
/// | `scene.toml` | the scene as it was run |
///
/// Every file is written whole or not at all.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    path: PathBuf,
}

/// The collection of snapshots.
const SNAPSHOTS: &str = "snapshots.pvd";

impl ResultFolder {
    /// A folder, which is made with its first file.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }
    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A sink that writes snapshots of a mesh as VTU files and a PVD collection.
    ///
    /// # Errors
    /// A mesh that VTU files cannot hold.
    pub fn snapshots(&self, mesh: &Mesh) -> Result<Box<dyn SnapshotSink>, Error> {
        Ok(vtu::snapshots(self.path.join(SNAPSHOTS), mesh)?)
    }

    /// Writes the results, and the scene's text if there is one; returns the files written, the
    /// collection of snapshots among them.
    ///
    /// # Errors
    /// The file that could not be written.
    pub fn write(
        &self,
        (title, mesh): (&str, &Mesh),
        results: &Results,
        remarks: &[Remark],
        scene: Option<&str>,
    ) -> Result<Vec<PathBuf>, Error> {
        let mut files = Files {
            folder: &self.path,
            written: Vec::new(),
        };
        let summary = Summary::new(title, mesh, results, remarks);
        files.write("summary.json", |file| write_summary(file, &summary))?;
        if let Some(text) = scene {
            files.write("scene.toml", |file| write_whole(file, text.as_bytes()))?;
        }
        for (name, table) in [
            ("histories.csv", &results.histories),
            ("sections.csv", &results.sections),
            ("energies.csv", &results.energies),
        ] {
            if !table.times.is_empty() {
                let columns = columns(table);
                files.write(name, |file| write_table(file, &columns))?;
            }
        }
        for table in [&results.histories, &results.sections] {
            for (name, plot) in drawing::plots(&columns(table)) {
                files.write(&format!("plots/{name}.svg"), plot)?;
            }
        }
        if !results.energies.times.is_empty() {
            let columns = columns(&results.energies);
            files.write("plots/energies.svg", |file| {
                drawing::plot(file, "energies", &columns)
            })?;
        }
        if let Some(envelope) = &results.envelope {
            let fields = vtu::EnvelopeFields::new(envelope, mesh);
            files.write("envelope.vtu", |file| {
                fields.write(file, mesh, results.run.time)
            })?;
            for (name, field, unit) in fields.peaks() {
                files.write(
                    &format!("pictures/{}.png", drawing::file_name(name)),
                    |file| drawing::picture(file, mesh, (name, unit), field),
                )?;
            }
        }
        if self.path.join(SNAPSHOTS).exists() {
            files.written.push(self.path.join(SNAPSHOTS));
        }
        Ok(files.written)
    }
}

/// Keeps account of what is written.
struct Files<'a> {
    folder: &'a Path,
    written: Vec<PathBuf>,
}

impl Files<'_> {
    fn write(
        &mut self,
        name: &str,
        write: impl FnOnce(&Path) -> Result<(), IoError>,
    ) -> Result<(), IoError> {
        let file = self.folder.join(name);
        write(&file)?;
        self.written.push(file);
        Ok(())
    }
}

fn columns(table: &HistoryTable) -> Vec<TableColumn> {
    let times = TableColumn::new("time", "s", table.times.clone());
    let columns = table.columns.iter();
    let columns = columns.map(|c| TableColumn::new(c.name.clone(), c.unit, c.values.clone()));
    core::iter::once(times).chain(columns).collect()
}
