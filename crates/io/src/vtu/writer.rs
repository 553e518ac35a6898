//! One instant as an unstructured grid.

use std::fmt::Write as _;
use std::path::Path;

use powerhouse_model::{ElementKind, Mesh, Vec3};

use super::encode::{compressed, float_bytes, whole_bytes};
use crate::xml::escaped;
use crate::{IoError, write_whole};

/// The number format of result fields in a file; positions are always doubles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FieldPrecision {
    /// Four bytes per number: seven digits, enough to look at.
    #[default]
    Single,
    /// Eight bytes per number: what the solver had.
    Double,
}

/// What the numbers of a field are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VtuNumbers {
    /// Reals, in the precision of the file.
    #[default]
    Real,
    /// Whole numbers, such as flags: written as 32-bit integers, so that filters can select them
    /// exactly.
    Whole,
}

/// A named field: one group of `components` numbers per node or per element, in the mesh's order.
#[derive(Clone, Copy, Debug)]
pub struct VtuField<'a> {
    /// The name, without quotes, `<`, `>` or `&`.
    pub name: &'a str,
    /// 1 for a scalar, 3 for a vector, 6 for a symmetric tensor (xx yy zz xy yz zx).
    pub components: usize,
    /// What they are.
    pub numbers: VtuNumbers,
    /// The numbers, group after group.
    pub values: &'a [f64],
}

/// Writes files of one mesh; what does not change in time is compressed once.
///
/// Nodes and elements stand in the mesh's order; their numbers of the input file are the fields
/// `node_tag` and `element_tag`, the element sets a field of zeros and ones each.
pub struct VtuWriter {
    nodes: usize,
    elements: usize,
    precision: FieldPrecision,
    points: Vec<u8>,
    cells: [Vec<u8>; 3],
    point_static: Arrays,
    cell_static: Arrays,
}

/// VTK's number of a kind of cell, and the order of its nodes there.
fn cell(kind: ElementKind) -> Option<(u8, &'static [usize])> {
    Some(match kind {
        ElementKind::Hex8 => (12, &[0, 1, 2, 3, 4, 5, 6, 7]),
        ElementKind::Tet4 => (10, &[0, 1, 2, 3]),
        // VTK wants the first triangle to face away from the second.
        ElementKind::Wedge6 => (13, &[0, 2, 1, 3, 5, 4]),
        ElementKind::Bar2 => (3, &[0, 1]),
        _ => return None,
    })
}

impl VtuWriter {
    /// Prepares the files of a mesh.
    ///
    /// # Errors
    /// If the compressor fails, or the mesh has a kind of element that VTK has no cell for.
    pub fn new(mesh: &Mesh, precision: FieldPrecision) -> std::io::Result<Self> {
        let (mut connectivity, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
        let mut end = 0_i64;
        for element in 0..mesh.element_count() as u32 {
            let kind = mesh.kind(element);
            let (number, order) = cell(kind).ok_or_else(|| {
                std::io::Error::other(format!("no VTK cell for elements of kind {}", kind.name()))
            })?;
            let nodes = mesh.nodes_of(element);
            for &place in order {
                connectivity.extend_from_slice(&i64::from(nodes[place]).to_le_bytes());
            }
            end += order.len() as i64;
            offsets.extend_from_slice(&end.to_le_bytes());
            types.push(number);
        }
        let tags =
            |tags: &[u64]| -> Vec<u8> { tags.iter().flat_map(|t| t.to_le_bytes()).collect() };
        let mut cell_static = vec![(
            r#"type="UInt64" Name="element_tag""#.into(),
            compressed(&tags(mesh.element_tags()))?,
        )];
        for (name, elements) in mesh.element_sets() {
            let mut inside = vec![0_u8; mesh.element_count()];
            for &element in elements {
                inside[element as usize] = 1;
            }
            let attributes = format!(r#"type="UInt8" Name="set {}""#, escaped(name));
            cell_static.push((attributes, compressed(&inside)?));
        }
        let positions = mesh.positions().iter().flat_map(|p| [p.x, p.y, p.z]);
        Ok(Self {
            nodes: mesh.node_count(),
            elements: mesh.element_count(),
            precision,
            points: compressed(&float_bytes(positions, true))?,
            cells: [
                compressed(&connectivity)?,
                compressed(&offsets)?,
                compressed(&types)?,
            ],
            point_static: vec![(
                r#"type="UInt64" Name="node_tag""#.into(),
                compressed(&tags(mesh.node_tags()))?,
            )],
            cell_static,
        })
    }

    /// Prepares the files of a surface: positions (m), and for each facet its three or four corners
    /// among them.
    ///
    /// # Errors
    /// If the compressor fails, or a facet has another number of corners.
    pub fn of_facets(
        positions: &[Vec3],
        facets: &[Vec<u32>],
        precision: FieldPrecision,
    ) -> std::io::Result<Self> {
        let (mut connectivity, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
        let mut end = 0_i64;
        for facet in facets {
            types.push(match facet.len() {
                3 => 5,
                4 => 9,
                other => {
                    let text = format!("no VTK cell for facets of {other} corners");
                    return Err(std::io::Error::other(text));
                }
            });
            for &corner in facet {
                connectivity.extend_from_slice(&i64::from(corner).to_le_bytes());
            }
            end += facet.len() as i64;
            offsets.extend_from_slice(&end.to_le_bytes());
        }
        let numbers = positions.iter().flat_map(|p| [p.x, p.y, p.z]);
        Ok(Self {
            nodes: positions.len(),
            elements: facets.len(),
            precision,
            points: compressed(&float_bytes(numbers, true))?,
            cells: [
                compressed(&connectivity)?,
                compressed(&offsets)?,
                compressed(&types)?,
            ],
            point_static: Vec::new(),
            cell_static: Vec::new(),
        })
    }

    /// Writes one instant: fields at nodes and in elements.
    ///
    /// # Errors
    /// A field of the wrong length, a number that is not finite or, where it should be, not whole, or
    /// the operating system's error, each with the file's path.
    pub fn write(
        &self,
        file: &Path,
        time: f64,
        at_nodes: &[VtuField],
        in_elements: &[VtuField],
    ) -> Result<(), IoError> {
        let nodal = self.encode(file, at_nodes, self.nodes)?;
        let elemental = self.encode(file, in_elements, self.elements)?;
        let content = self.document(time, &nodal, &elemental);
        write_whole(file, &content)
    }

    fn encode(&self, file: &Path, fields: &[VtuField], count: usize) -> Result<Arrays, IoError> {
        let double = self.precision == FieldPrecision::Double;
        let mut encoded = Vec::with_capacity(fields.len());
        for field in fields {
            let expected = count * field.components;
            if field.values.len() != expected {
                return Err(IoError::Length {
                    file: file.into(),
                    what: field.name.into(),
                    found: field.values.len(),
                    expected,
                });
            }
            if let Some(place) = field.values.iter().position(|value| !value.is_finite()) {
                return Err(IoError::NotFinite {
                    file: file.into(),
                    what: field.name.into(),
                    place,
                    value: field.values[place],
                });
            }
            let values = field.values;
            let (kind, bytes) = match field.numbers {
                VtuNumbers::Real if double => {
                    ("Float64", float_bytes(values.iter().copied(), true))
                }
                VtuNumbers::Real => ("Float32", float_bytes(values.iter().copied(), false)),
                VtuNumbers::Whole => {
                    let bytes = whole_bytes(values).map_err(|place| IoError::NotWhole {
                        file: file.into(),
                        what: field.name.into(),
                        place,
                        value: values[place],
                    })?;
                    ("Int32", bytes)
                }
            };
            let components = component_names(field.components);
            let attributes = format!(
                r#"type="{kind}" Name="{}" NumberOfComponents="{}"{components}"#,
                escaped(field.name),
                field.components
            );
            encoded.push((attributes, compressed(&bytes).map_err(IoError::file(file))?));
        }
        Ok(encoded)
    }

    fn document(&self, time: f64, at_nodes: &Arrays, in_elements: &Arrays) -> Vec<u8> {
        let mut body = Body::default();
        body.open(&format!(
            r#"Piece NumberOfPoints="{}" NumberOfCells="{}""#,
            self.nodes, self.elements
        ));
        body.group(
            "PointData",
            borrowed(at_nodes).chain(borrowed(&self.point_static)),
        );
        body.group(
            "CellData",
            borrowed(in_elements).chain(borrowed(&self.cell_static)),
        );
        let positions = r#"type="Float64" Name="Points" NumberOfComponents="3""#;
        body.group("Points", [(positions, self.points.as_slice())]);
        let names = [
            r#"type="Int64" Name="connectivity""#,
            r#"type="Int64" Name="offsets""#,
            r#"type="UInt8" Name="types""#,
        ];
        let cells = self.cells.iter().map(Vec::as_slice);
        body.group("Cells", names.into_iter().zip(cells));
        body.finish(time)
    }
}

/// Attributes and compressed bytes of data arrays.
type Arrays = Vec<(String, Vec<u8>)>;

fn borrowed(arrays: &Arrays) -> impl Iterator<Item = (&str, &[u8])> {
    arrays
        .iter()
        .map(|(attributes, bytes)| (attributes.as_str(), bytes.as_slice()))
}

/// The XML part and, after it, the bytes that it points into.
#[derive(Default)]
struct Body {
    xml: String,
    appended: Vec<u8>,
}

impl Body {
    fn open(&mut self, tag: &str) {
        let _ = writeln!(self.xml, "<{tag}>");
    }
    fn group<'a>(&mut self, tag: &str, arrays: impl IntoIterator<Item = (&'a str, &'a [u8])>) {
        let _ = writeln!(self.xml, "<{tag}>");
        for (attributes, bytes) in arrays {
            let offset = self.appended.len();
            let _ = writeln!(
                self.xml,
                r#"<DataArray {attributes} format="appended" offset="{offset}"/>"#
            );
            self.appended.extend_from_slice(bytes);
        }
        let _ = writeln!(self.xml, "</{tag}>");
    }
    fn finish(self, time: f64) -> Vec<u8> {
        let mut out = format!(
            concat!(
                r#"<?xml version="1.0"?>"#,
                "\n",
                r#"<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" "#,
                r#"header_type="UInt64" compressor="vtkZLibDataCompressor">"#,
                "\n<UnstructuredGrid>\n<FieldData>\n",
                r#"<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">"#,
                "{time}</DataArray>\n</FieldData>\n{xml}</Piece>\n</UnstructuredGrid>\n",
                r#"<AppendedData encoding="raw">"#,
                "\n_"
            ),
            time = time,
            xml = self.xml
        )
        .into_bytes();
        out.extend_from_slice(&self.appended);
        out.extend_from_slice(b"\n</AppendedData>\n</VTKFile>\n");
        out
    }
}

fn component_names(components: usize) -> String {
    let names: &[&str] = match components {
        3 => &["x", "y", "z"],
        6 => &["xx", "yy", "zz", "xy", "yz", "zx"],
        _ => &[],
    };
    let named = names.iter().enumerate();
    named.fold(String::new(), |mut text, (index, name)| {
        let _ = write!(text, r#" ComponentName{index}="{name}""#);
        text
    })
}
