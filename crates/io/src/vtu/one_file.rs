//! VTKHDF files: all instants of a run in one file.
//!
//! The form is that of unstructured grids with steps of version 2.0 of
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/index.html>: mesh and sets are there once, and the offsets
//! of the steps point to them; fields are there once for each step.

use std::path::Path;

use hdf5_pure::{AttrValue, DatasetBuilder, FileBuilder, FinishedGroup, GroupBuilder};
use powerhouse_model::Mesh;

use super::reader::{FieldNumbers, FieldOfFile, VtuGrid};
use super::writer::{Cells, PRESENT, SET, TAGS, components_of};
use crate::{IoError, write_whole};

const ROOT: &str = "VTKHDF";
const VERSION: [i64; 2] = [2, 0];
const KIND: &str = "UnstructuredGrid";
/// Level of compression of the fields: the fastest one, as noise in the last digits does not shrink.
const DEFLATE: u32 = 1;
/// Attributes of a field: its unit and the names of its components.
const UNIT: &str = "units";
const COMPONENTS: &str = "components";

/// Mesh and fields of all instants of a run, to be written as one VTKHDF file.
///
/// The fields are kept until the file is written, and the file as a whole before it is written:
/// [`memory`](Self::memory) has what it takes.
pub struct VtkHdf {
    mesh: Mesh,
    times: Vec<f64>,
    at_nodes: Vec<Kept>,
    in_elements: Vec<Kept>,
    /// Whether elements are active, of each instant that states it.
    present: Vec<Option<Vec<bool>>>,
}

/// Values of a field at all instants, in the type of its file.
struct Kept {
    /// The field at the first instant, without its values.
    form: FieldOfFile,
    values: Values,
}

enum Values {
    Single(Vec<f32>),
    Double(Vec<f64>),
    Whole(Vec<i32>),
}

impl Kept {
    fn new(mut form: FieldOfFile) -> Self {
        let values = core::mem::take(&mut form.values);
        let empty = match form.numbers {
            FieldNumbers::Single => Values::Single(Vec::new()),
            FieldNumbers::Double => Values::Double(Vec::new()),
            FieldNumbers::Whole => Values::Whole(Vec::new()),
        };
        let mut kept = Self {
            form,
            values: empty,
        };
        kept.add(&values);
        kept
    }

    fn add(&mut self, more: &[f64]) {
        match &mut self.values {
            Values::Single(values) => values.extend(more.iter().map(|&value| value as f32)),
            Values::Double(values) => values.extend_from_slice(more),
            Values::Whole(values) => values.extend(more.iter().map(|&value| value as i32)),
        }
    }

    /// Number of values, and size of each (bytes).
    fn size(&self) -> (usize, usize) {
        match &self.values {
            Values::Single(values) => (values.len(), 4),
            Values::Double(values) => (values.len(), 8),
            Values::Whole(values) => (values.len(), 4),
        }
    }

    /// Whether a field of another instant is the same but for its values.
    fn is_one_with(&self, other: &FieldOfFile) -> bool {
        let form = |field: &FieldOfFile| (field.components, field.numbers);
        let of_names = (&self.form.name, &self.form.unit) == (&other.name, &other.unit);
        of_names && form(&self.form) == form(other)
    }
}

impl VtkHdf {
    /// The first instant, with the file from which it was read for errors.
    ///
    /// # Errors
    /// [`IoError::Grid`] without a time.
    pub fn new(first: VtuGrid, file: &Path) -> Result<Self, IoError> {
        let time = time(&first, file)?;
        Ok(Self {
            mesh: first.mesh,
            times: vec![time],
            at_nodes: first.at_nodes.into_iter().map(Kept::new).collect(),
            in_elements: first.in_elements.into_iter().map(Kept::new).collect(),
            present: vec![first.present],
        })
    }

    /// Memory (bytes) that the fields of a number of instants and the file of them take together, at most.
    pub fn memory(&self, instants: usize) -> u64 {
        let fields = self.at_nodes.iter().chain(&self.in_elements);
        let of_first = fields.map(|field| {
            let (count, size) = field.size();
            count / self.times.len() * size
        });
        // Kept, in the form of the file, and compressed.
        3 * (of_first.sum::<usize>() * instants) as u64
    }

    /// Adds the next instant.
    ///
    /// # Errors
    /// [`IoError::Grid`] for an instant without a time or not after the one before, of another mesh, or with other fields.
    pub fn add(&mut self, next: &VtuGrid, file: &Path) -> Result<(), IoError> {
        let fault = |reason: String| IoError::Grid {
            file: file.into(),
            reason,
        };
        let time = time(next, file)?;
        if let Some(last) = self.times.last().filter(|last| **last >= time) {
            return Err(fault(format!("its time {time} s is not after {last} s")));
        }
        if !is_same(&self.mesh, &next.mesh) {
            return Err(fault("its mesh is not that of the first file".into()));
        }
        let pairs = [
            (&mut self.at_nodes, &next.at_nodes),
            (&mut self.in_elements, &next.in_elements),
        ];
        for (all, next) in &pairs {
            let is_same = all.len() == next.len();
            if !(is_same
                && all
                    .iter()
                    .zip(*next)
                    .all(|(all, next)| all.is_one_with(next)))
            {
                return Err(fault("its fields are not those of the first file".into()));
            }
        }
        for (all, next) in pairs {
            for (all, next) in all.iter_mut().zip(next) {
                all.add(&next.values);
            }
        }
        self.times.push(time);
        self.present.push(next.present.clone());
        Ok(())
    }

    /// Writes the file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), IoError> {
        let cells = Cells::of(&self.mesh).map_err(IoError::file(file))?;
        let bytes = self.bytes(cells).map_err(|error| IoError::Grid {
            file: file.into(),
            reason: error.to_string(),
        })?;
        write_whole(file, &bytes)
    }

    fn bytes(&self, cells: Cells) -> Result<Vec<u8>, hdf5_pure::Error> {
        let mut out = FileBuilder::new();
        let mut root = out.create_group(ROOT);
        root.set_attr("Version", AttrValue::I64Array(VERSION.to_vec()));
        root.set_attr("Type", AttrValue::AsciiString(KIND.into()));
        self.put_mesh(&mut root, cells);
        let [nodes, elements] = [self.mesh.node_count(), self.mesh.element_count()];
        let mut starts = [Vec::new(), Vec::new()];
        let groups = [
            ("PointData", &self.at_nodes, nodes, self.node_constants()),
            (
                "CellData",
                &self.in_elements,
                elements,
                self.element_constants(),
            ),
        ];
        for ((name, fields, count, constants), starts) in groups.into_iter().zip(&mut starts) {
            let mut group = root.create_group(name);
            for field in fields {
                let name = link(&field.form.name, starts);
                put_field(group.create_dataset(&name), field, count);
                starts.push((name, count));
            }
            for (name, values) in constants {
                let name = link(&name, starts);
                let data = group.create_dataset(&name).with_i64_data(&values);
                compressed(data, &[values.len()]);
                starts.push((name, 0));
            }
            if name == "CellData" && self.present.iter().any(Option::is_some) {
                let of_step = |present: &Option<Vec<bool>>| match present {
                    Some(flags) => flags.iter().map(|&flag| u8::from(flag)).collect(),
                    None => vec![1; elements],
                };
                let flags: Vec<u8> = self.present.iter().flat_map(of_step).collect();
                compressed(
                    group.create_dataset(PRESENT).with_u8_data(&flags),
                    &[elements],
                );
                starts.push((PRESENT.into(), elements));
            }
            root.add_group(group.finish());
        }
        let steps = self.steps(root.create_group("Steps"), &starts);
        root.add_group(steps);
        out.add_group(root.finish());
        out.finish()
    }

    /// Nodes and elements.
    fn put_mesh(&self, root: &mut GroupBuilder, cells: Cells) {
        let Cells {
            connectivity,
            ends,
            types,
        } = cells;
        let offsets: Vec<i64> = [0].into_iter().chain(ends).collect();
        let positions: Vec<f64> = (self.mesh.positions().iter())
            .flat_map(|p| [p.x, p.y, p.z])
            .collect();
        let nodes = self.mesh.node_count();
        for (name, count) in [
            ("NumberOfPoints", nodes),
            ("NumberOfCells", types.len()),
            ("NumberOfConnectivityIds", connectivity.len()),
        ] {
            root.create_dataset(name).with_i64_data(&[count as i64]);
        }
        let points = root.create_dataset("Points").with_f64_data(&positions);
        compressed(points.with_shape(&[nodes as u64, 3]), &[nodes, 3]);
        let lists = [("Connectivity", &connectivity), ("Offsets", &offsets)];
        for (name, numbers) in lists {
            compressed(
                root.create_dataset(name).with_i64_data(numbers),
                &[numbers.len()],
            );
        }
        let count = types.len();
        compressed(root.create_dataset("Types").with_u8_data(&types), &[count]);
    }

    /// Fields at nodes that do not change: their numbers in the input file.
    fn node_constants(&self) -> Vec<(String, Vec<i64>)> {
        vec![(TAGS[0].into(), numbers(self.mesh.node_tags()))]
    }

    /// Fields in elements that do not change: their numbers in the input file, and the element sets.
    fn element_constants(&self) -> Vec<(String, Vec<i64>)> {
        let mut all = vec![(TAGS[1].into(), numbers(self.mesh.element_tags()))];
        for (name, elements) in self.mesh.element_sets() {
            let mut inside = vec![0; self.mesh.element_count()];
            for &element in elements {
                inside[element as usize] = 1;
            }
            all.push((format!("{SET}{name}"), inside));
        }
        all
    }

    /// Times, and where the parts of each step begin: one mesh for all, and the fields one step after the other, of which
    /// `starts` has the numbers of nodes or elements in a step.
    fn steps(&self, mut group: GroupBuilder, starts: &[Vec<(String, usize)>; 2]) -> FinishedGroup {
        let steps = self.times.len();
        group.set_attr("NSteps", AttrValue::I64(steps as i64));
        group.create_dataset("Values").with_f64_data(&self.times);
        let zeros = vec![0; steps];
        for name in ["PartOffsets", "PointOffsets"] {
            group.create_dataset(name).with_i64_data(&zeros);
        }
        let parts = vec![1; steps];
        group.create_dataset("NumberOfParts").with_i64_data(&parts);
        for name in ["CellOffsets", "ConnectivityIdOffsets"] {
            let data = group.create_dataset(name).with_i64_data(&zeros);
            data.with_shape(&[steps as u64, 1]);
        }
        for (name, fields) in ["PointDataOffsets", "CellDataOffsets"].iter().zip(starts) {
            let mut of_fields = group.create_group(name);
            for (field, length) in fields {
                let starts: Vec<i64> = (0..steps).map(|step| (step * length) as i64).collect();
                of_fields.create_dataset(field).with_i64_data(&starts);
            }
            group.add_group(of_fields.finish());
        }
        group.finish()
    }
}

/// Time of an instant (s).
fn time(grid: &VtuGrid, file: &Path) -> Result<f64, IoError> {
    grid.time.ok_or_else(|| IoError::Grid {
        file: file.into(),
        reason: "it has no time".into(),
    })
}

/// Whether two meshes have the same nodes, elements and sets.
fn is_same(a: &Mesh, b: &Mesh) -> bool {
    let elements = |mesh: &Mesh| 0..mesh.element_count() as u32;
    a.positions() == b.positions()
        && elements(a).eq(elements(b))
        && elements(a).all(|e| a.kind(e) == b.kind(e) && a.nodes_of(e) == b.nodes_of(e))
        && a.element_sets() == b.element_sets()
}

/// Numbers of nodes or elements in the input file.
fn numbers(tags: &[u64]) -> Vec<i64> {
    tags.iter().map(|&tag| tag as i64).collect()
}

/// Name as that of an object of a file, other than those that there are.
fn link(name: &str, known: &[(String, usize)]) -> String {
    let plain = name.replace('/', "_");
    let is_free = |name: &String| !known.iter().any(|(other, _)| other == name);
    let numbered = (2..).map(|number| format!("{plain}_{number}"));
    let mut names = [plain.clone()].into_iter().chain(numbered);
    names.find(is_free).unwrap_or(plain)
}

/// Writes the values of all steps of a field with a number of nodes or elements.
fn put_field(data: &mut DatasetBuilder, field: &Kept, count: usize) {
    match &field.values {
        Values::Double(values) => data.with_f64_data(values),
        Values::Single(values) => data.with_f32_data(values),
        Values::Whole(values) => data.with_i32_data(values),
    };
    let (length, _) = field.size();
    let field = &field.form;
    let components = field.components.max(1);
    match components {
        1 => compressed(data, &[count]),
        _ => {
            let rows = length / components;
            data.with_shape(&[rows as u64, components as u64]);
            compressed(data, &[count, components]);
        }
    }
    if !field.unit.is_empty() {
        data.set_attr(UNIT, AttrValue::AsciiString(field.unit.clone()));
    }
    let names = components_of(components);
    if !names.is_empty() {
        data.set_attr(COMPONENTS, AttrValue::AsciiString(names.join(" ")));
    }
}

/// Compresses a dataset in pieces of a shape.
fn compressed(data: &mut DatasetBuilder, shape: &[usize]) {
    if shape.contains(&0) {
        return;
    }
    let shape: Vec<u64> = shape.iter().map(|&length| length as u64).collect();
    data.with_chunks(&shape)
        .with_shuffle()
        .with_deflate(DEFLATE);
}
