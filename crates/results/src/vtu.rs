//! VTU and PVD files for ParaView.

use std::path::{Path, PathBuf};

use powerhouse_contact::JointSurface;
#[cfg(feature = "pictures")]
use powerhouse_io::PictureField;
use powerhouse_io::{FieldPrecision, IoError, PvdCollection, VtuField, VtuNumbers, VtuWriter};
use powerhouse_model::{
    HistoryKind, HistoryVariable, Mesh, StateError, Stress, Vec3, decode, encode,
};
use powerhouse_observe::{EnvelopeTable, PeakField, Snapshot, SnapshotSink, StateTable};

use crate::joints::{JointFacets, JointFields, scalars as scalars_of_joint};
use powerhouse_scene::file_name;

/// Writer of a mesh with the given active elements (`None`: all).
fn writer(file: &Path, mesh: &Mesh, present: Option<&[bool]>) -> Result<VtuWriter, IoError> {
    let writer = VtuWriter::new(mesh, FieldPrecision::Single);
    let mut writer = writer.map_err(|source| IoError::File {
        file: file.into(),
        source,
    })?;
    if let Some(present) = present {
        writer.set_present(mesh, present);
    }
    Ok(writer)
}

/// Unit of a history variable in files; empty for dimensionless ones.
pub(crate) fn unit(unit: &'static str) -> &'static str {
    if unit == "1" { "" } else { unit }
}

/// Number format of a history variable: integers for flags, reals for amounts and components.
pub(crate) fn numbers(variable: &HistoryVariable) -> VtuNumbers {
    match variable.kind {
        HistoryKind::Flags => VtuNumbers::Whole,
        _ => VtuNumbers::Real,
    }
}

/// Snapshot writer: one VTU file per snapshot, one per joint, and a PVD collection of all.
pub(crate) fn snapshots(
    file: PathBuf,
    (mesh, present): (&Mesh, Option<&[bool]>),
    surfaces: &[(String, JointSurface)],
) -> Result<Box<dyn SnapshotSink>, IoError> {
    let writer = writer(&file, mesh, present)?;
    let mut joints = Vec::new();
    for (name, surface) in surfaces {
        if let Some(facets) = JointFacets::new(&file, mesh, surface, present)? {
            joints.push((name.clone(), facets));
        }
    }
    Ok(Box::new(SnapshotFiles {
        joints,
        collection: PvdCollection::new(file, writer),
    }))
}

/// Writer of snapshots.
struct SnapshotFiles {
    collection: PvdCollection,
    /// Facets of the joints, by name.
    joints: Vec<(String, JointFacets)>,
}

impl SnapshotSink for SnapshotFiles {
    fn take(&mut self, shot: &Snapshot) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let vectors =
            |values: &[Vec3]| -> Vec<f64> { values.iter().flat_map(|v| [v.x, v.y, v.z]).collect() };
        let nodal = [
            (("displacement", "m"), vectors(shot.displacement)),
            (("velocity", "m/s"), vectors(shot.velocity)),
            (("acceleration", "m/s2"), vectors(shot.acceleration)),
        ];
        let at_nodes: Vec<VtuField> = nodal
            .iter()
            .filter(|(_, values)| !values.is_empty())
            .map(|((name, unit), values)| VtuField {
                name,
                components: 3,
                numbers: VtuNumbers::Real,
                unit,
                values,
            })
            .collect();
        let stress: Vec<f64> = shot.stress.iter().flat_map(|Stress(s)| *s).collect();
        let stress = (!stress.is_empty()).then_some(VtuField {
            name: "stress",
            components: 6,
            numbers: VtuNumbers::Real,
            unit: "Pa",
            values: &stress,
        });
        let state = shot.state.iter().map(|(variable, values)| VtuField {
            name: variable.name,
            components: 1,
            numbers: numbers(variable),
            unit: unit(variable.unit),
            values,
        });
        let in_elements: Vec<VtuField> = stress.into_iter().chain(state).collect();
        let mut joints: Vec<(String, &VtuWriter, JointFields)> = Vec::new();
        for (name, facets) in &self.joints {
            if let Some(view) = shot.joints.iter().find(|joint| joint.name == name) {
                let fields =
                    facets.fields((view.pairs, view.records), (view.variables, view.history));
                joints.push((file_name(name), &facets.writer, fields));
            }
        }
        let fields: Vec<Vec<VtuField>> = joints.iter().map(|(.., f)| scalars_of_joint(f)).collect();
        let parts: Vec<(&str, &VtuWriter, &[VtuField])> = (joints.iter().zip(&fields))
            .map(|((name, writer, _), fields)| (name.as_str(), *writer, &fields[..]))
            .collect();
        self.collection
            .add_with(shot.time, &at_nodes, &in_elements, &parts)?;
        Ok(())
    }
    fn finish(&mut self) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        Ok(self.collection.keep_existing()?)
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        encode(&(self.collection.len(), self.collection.entries()))
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        let (instants, entries) = decode(saved)?;
        self.collection.restore(instants, entries);
        Ok(())
    }
}

/// Envelopes and their times as fields over the whole mesh, zero where nothing was recorded.
pub(crate) struct EnvelopeFields {
    nodal: Vec<PeakOverMesh>,
    elemental: Vec<PeakOverMesh>,
    /// Integer fields of elements, by name.
    flags: Vec<(&'static str, Vec<f64>)>,
}

/// Envelope of one quantity over the whole mesh.
struct PeakOverMesh {
    name: &'static str,
    unit: &'static str,
    values: Vec<f64>,
    time_name: String,
    times: Vec<f64>,
}

/// Peaks with their name and unit in files.
struct NamedPeaks<'a> {
    name: &'static str,
    unit: &'static str,
    field: &'a PeakField,
}

impl<'a> NamedPeaks<'a> {
    fn new(name: &'static str, unit: &'static str, field: &'a PeakField) -> Self {
        Self { name, unit, field }
    }
}

impl PeakOverMesh {
    /// The peaks of nodes or elements (mesh indices) among so many; none if nothing was tracked.
    fn new(peaks: NamedPeaks, indices: &[u32], count: usize) -> Option<Self> {
        let NamedPeaks { name, unit, field } = peaks;
        let spread = |values: &[f64]| {
            let mut all = vec![0.0; count];
            for (&index, &value) in indices.iter().zip(values) {
                all[index as usize] = value;
            }
            all
        };
        (!field.values.is_empty()).then(|| Self {
            name,
            unit,
            values: spread(&field.values),
            time_name: format!("time of {name}"),
            times: spread(&field.times),
        })
    }
}

/// Names of the quantities of an envelope.
pub(crate) const ENVELOPES: [&str; 5] = [
    "largest displacement",
    "largest velocity",
    "largest acceleration",
    "greatest principal stress",
    "least principal stress",
];

impl EnvelopeFields {
    pub(crate) fn new(envelope: &EnvelopeTable, mesh: &Mesh) -> Self {
        let [displacement, velocity, acceleration, greatest, least] = ENVELOPES;
        let nodal = [
            NamedPeaks::new(displacement, "m", &envelope.displacement),
            NamedPeaks::new(velocity, "m/s", &envelope.velocity),
            NamedPeaks::new(acceleration, "m/s2", &envelope.acceleration),
        ];
        let elemental = [
            NamedPeaks::new(greatest, "Pa", &envelope.greatest_stress),
            NamedPeaks::new(least, "Pa", &envelope.least_stress),
        ];
        let (nodes, elements) = (&envelope.nodes, &envelope.elements);
        let of_nodes = |field| PeakOverMesh::new(field, nodes, mesh.node_count());
        let of_elements = |field| PeakOverMesh::new(field, elements, mesh.element_count());
        Self {
            nodal: nodal.into_iter().filter_map(of_nodes).collect(),
            elemental: elemental.into_iter().filter_map(of_elements).collect(),
            flags: Vec::new(),
        }
    }
    /// Fields of the history variables of laws: envelopes of amounts that were ever above zero, final values of
    /// flags.
    pub(crate) fn of_state(state: &StateTable, mesh: &Mesh) -> Self {
        let (elements, count) = (&state.elements, mesh.element_count());
        let some = |field: &&(HistoryVariable, PeakField)| field.1.values.iter().any(|v| *v > 0.0);
        let peaks = state
            .peaks
            .iter()
            .filter(some)
            .filter_map(|(variable, field)| {
                let peaks = NamedPeaks::new(variable.name, variable.unit, field);
                PeakOverMesh::new(peaks, elements, count)
            });
        let flags = state.flags.iter().map(|(variable, values)| {
            let mut all = vec![0.0; count];
            for (&element, &value) in elements.iter().zip(values) {
                all[element as usize] = value;
            }
            (variable.name, all)
        });
        Self {
            nodal: Vec::new(),
            elemental: peaks.collect(),
            flags: flags.collect(),
        }
    }
    /// Name, field and unit of every envelope.
    #[cfg(feature = "pictures")]
    pub(crate) fn peaks(&self) -> impl Iterator<Item = (&str, PictureField<'_>, &str)> {
        let nodal = self.nodal.iter();
        let nodal = nodal.map(|p| (p.name, PictureField::Nodal(&p.values), p.unit));
        let elemental = self.elemental.iter();
        nodal.chain(elemental.map(|p| (p.name, PictureField::Elemental(&p.values), p.unit)))
    }
    /// Writes the fields as one VTU file with a time (s).
    pub(crate) fn write(
        &self,
        file: &Path,
        (mesh, present): (&Mesh, Option<&[bool]>),
        time: f64,
    ) -> Result<(), IoError> {
        let (nodal, mut elemental) = (scalars(&self.nodal), scalars(&self.elemental));
        elemental.extend(self.flags.iter().map(|(name, values)| VtuField {
            name,
            components: 1,
            numbers: VtuNumbers::Whole,
            unit: "",
            values,
        }));
        writer(file, mesh, present)?.write(file, time, &nodal, &elemental)
    }
}

fn scalars(peaks: &[PeakOverMesh]) -> Vec<VtuField<'_>> {
    let field = |name, unit, values| VtuField {
        name,
        components: 1,
        numbers: VtuNumbers::Real,
        unit,
        values,
    };
    peaks
        .iter()
        .flat_map(|p| {
            [
                field(p.name, unit(p.unit), &p.values),
                field(&p.time_name, "s", &p.times),
            ]
        })
        .collect()
}
