//! The files of a run.

use std::path::{Path, PathBuf};

use powerhouse_explicit_core::observe::{
    EnvelopeTable, HistoryTable, PeakField, Snapshot, SnapshotSink,
};
use powerhouse_io::{
    FieldPrecision, IoError, PvdCollection, TableColumn, VtuField, VtuWriter, write_summary,
    write_table, write_whole,
};
use powerhouse_model::{Mesh, Stress, Vec3};

use super::Results;
use super::summary::Summary;
use crate::{Error, Remark};

/// A folder that takes the files of a run.
///
/// | file | what |
/// |---|---|
/// | `summary.json` | steps, step, wall time, peaks, energies at the end, remarks |
/// | `histories.csv` | histories and relative displacements |
/// | `sections.csv` | section forces |
/// | `energies.csv` | the energy ledger |
/// | `envelope.vtu` | greatest values with their times |
/// | `snapshots.pvd` and a folder beside it | whole fields, for ParaView |
/// | `scene.toml` | the scene as it was run |
///
/// Every file is written whole or not at all.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    path: PathBuf,
}

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
        let file = self.path.join("snapshots.pvd");
        let writer = vtu(&file, mesh)?;
        Ok(Box::new(SnapshotFiles(PvdCollection::new(file, writer))))
    }

    /// Writes the results, and the scene's text if there is one; returns the files written.
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
        let mut files = Vec::new();
        let mut written = |name: &str, result: Result<(), IoError>| -> Result<(), Error> {
            result?;
            files.push(self.path.join(name));
            Ok(())
        };
        for (name, table) in [
            ("histories.csv", &results.histories),
            ("sections.csv", &results.sections),
            ("energies.csv", &results.energies),
        ] {
            if !table.columns.is_empty() {
                written(name, write_table(&self.path.join(name), &columns(table)))?;
            }
        }
        if let Some(envelope) = &results.envelope {
            let name = "envelope.vtu";
            let file = self.path.join(name);
            written(
                name,
                write_envelope(&file, &vtu(&file, mesh)?, mesh, envelope, results),
            )?;
        }
        if let Some(text) = scene {
            let name = "scene.toml";
            written(name, write_whole(&self.path.join(name), text.as_bytes()))?;
        }
        let name = "summary.json";
        let summary = Summary::new(title, mesh, results, remarks);
        written(name, write_summary(&self.path.join(name), &summary))?;
        Ok(files)
    }
}

fn vtu(file: &Path, mesh: &Mesh) -> Result<VtuWriter, Error> {
    VtuWriter::new(mesh, FieldPrecision::Single).map_err(|source| {
        Error::Write(IoError::File {
            file: file.into(),
            source,
        })
    })
}

fn columns(table: &HistoryTable) -> Vec<TableColumn> {
    let times = TableColumn::new("time", "s", table.times.clone());
    let columns = table.columns.iter();
    let columns = columns.map(|c| TableColumn::new(c.name.clone(), c.unit, c.values.clone()));
    core::iter::once(times).chain(columns).collect()
}

/// Writes snapshots as they come.
struct SnapshotFiles(PvdCollection);

impl SnapshotSink for SnapshotFiles {
    fn take(&mut self, shot: &Snapshot) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let vectors =
            |values: &[Vec3]| -> Vec<f64> { values.iter().flat_map(|v| [v.x, v.y, v.z]).collect() };
        let nodal = [
            ("displacement", vectors(shot.displacement)),
            ("velocity", vectors(shot.velocity)),
            ("acceleration", vectors(shot.acceleration)),
        ];
        let at_nodes: Vec<VtuField> = nodal
            .iter()
            .filter(|(_, values)| !values.is_empty())
            .map(|(name, values)| VtuField {
                name,
                components: 3,
                values,
            })
            .collect();
        let stress: Vec<f64> = shot.stress.iter().flat_map(|Stress(s)| *s).collect();
        let in_elements = VtuField {
            name: "stress",
            components: 6,
            values: &stress,
        };
        let in_elements = if stress.is_empty() {
            &[][..]
        } else {
            &[in_elements]
        };
        Ok(self.0.add(shot.time, &at_nodes, in_elements)?)
    }
}

/// Peaks and their times as fields over the whole mesh, zero where nothing was tracked.
fn write_envelope(
    file: &Path,
    writer: &VtuWriter,
    mesh: &Mesh,
    envelope: &EnvelopeTable,
    results: &Results,
) -> Result<(), IoError> {
    let spread = |indices: &[u32], values: &[f64], count: usize| {
        let mut all = vec![0.0; count];
        for (&index, &value) in indices.iter().zip(values) {
            all[index as usize] = value;
        }
        all
    };
    let both = |name: &str, indices: &[u32], field: &PeakField, count: usize| {
        [
            (name.to_owned(), spread(indices, &field.values, count)),
            (
                format!("time of {name}"),
                spread(indices, &field.times, count),
            ),
        ]
    };
    let collect = |fields: &[(&str, &PeakField)], indices: &[u32], count: usize| {
        let wanted = fields.iter().filter(|(_, field)| !field.values.is_empty());
        let pairs = wanted.flat_map(|(name, field)| both(name, indices, field, count));
        pairs.collect::<Vec<(String, Vec<f64>)>>()
    };
    let nodal = collect(
        &[
            ("largest displacement", &envelope.displacement),
            ("largest velocity", &envelope.velocity),
            ("largest acceleration", &envelope.acceleration),
        ],
        &envelope.nodes,
        mesh.node_count(),
    );
    let elemental = collect(
        &[
            ("greatest principal stress", &envelope.greatest_stress),
            ("least principal stress", &envelope.least_stress),
        ],
        &envelope.elements,
        mesh.element_count(),
    );
    let (at_nodes, in_elements) = (scalars(&nodal), scalars(&elemental));
    writer.write(file, results.run.time, &at_nodes, &in_elements)
}

fn scalars(fields: &[(String, Vec<f64>)]) -> Vec<VtuField<'_>> {
    fields
        .iter()
        .map(|(name, values)| VtuField {
            name,
            components: 1,
            values,
        })
        .collect()
}
