//! VTU files: one instant as an unstructured grid.

use std::fmt::Write as _;
use std::path::Path;

use powerhouse_model::{ElementKind, Mesh, Vec3};

use super::encode::{compressed, float_bytes, whole_bytes};
use crate::xml::escaped;
use crate::{IoError, write_whole};

/// Precision of result fields in a file; positions are always in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FieldPrecision {
    /// Single precision, four bytes per number: seven digits.
    #[default]
    Single,
    /// Double precision, eight bytes per number, as computed.
    Double,
}

/// Number type of a field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VtuNumbers {
    /// Reals, in the precision of the file.
    #[default]
    Real,
    /// Integers, such as flags: written with 32 bits, so that filters can select them exactly.
    Whole,
}

/// Named field: one group of `components` numbers per node or per element, in the mesh's order.
#[derive(Clone, Copy, Debug)]
pub struct VtuField<'a> {
    /// Name, without quotes, `<`, `>` or `&`.
    pub name: &'a str,
    /// Number of components: 1 for a scalar, 3 for a vector, 6 for a symmetric tensor (xx yy zz xy yz zx).
    pub components: usize,
    /// Type of the numbers.
    pub numbers: VtuNumbers,
    /// Unit, such as `Pa`; empty for a dimensionless quantity. It is written as VTK's key `UNITS_LABEL` of
    /// the field, and with all others in a comment.
    pub unit: &'a str,
    /// Numbers, group after group.
    pub values: &'a [f64],
}

/// Writer of VTU files of one mesh; data that are constant in time are compressed only once.
///
/// Nodes and elements are in the order of the mesh; their numbers in the input file are the fields
/// `node_tag` and `element_tag`, each element set is a field of zeros and ones.
///
/// If some elements are inactive (see [`set_present`](Self::set_present)), files have the
/// field `present`, 1 for active elements. Fields of inactive elements are not written: reals are NaN,
/// integers -1. The same holds of fields of one component at nodes of inactive elements alone; vectors
/// are zero there, so that a body can be drawn deformed.
pub struct VtuWriter {
    nodes: usize,
    elements: usize,
    precision: FieldPrecision,
    /// Active nodes and elements, unless all are active.
    present: Option<[Vec<bool>; 2]>,
    points: Vec<u8>,
    cells: [Vec<u8>; 3],
    point_static: Arrays,
    cell_static: Arrays,
}

/// VTK's number of a kind of cell, and its order of the nodes.
pub(super) fn cell(kind: ElementKind) -> Option<(u8, &'static [usize])> {
    Some(match kind {
        ElementKind::Hex8 => (12, &[0, 1, 2, 3, 4, 5, 6, 7]),
        ElementKind::Tet4 => (10, &[0, 1, 2, 3]),
        // In VTK the first triangle faces away from the second.
        ElementKind::Wedge6 => (13, &[0, 2, 1, 3, 5, 4]),
        ElementKind::Bar2 => (3, &[0, 1]),
        ElementKind::Pyramid5 => (14, &[0, 1, 2, 3, 4]),
        // Of the midpoints at the fourth corner VTK has that of edge 13 before that of edge 23.
        ElementKind::Tet10 => (24, &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        _ => return None,
    })
}

/// Elements of a mesh as VTK's cells.
pub(super) struct Cells {
    /// Nodes of the cells, one cell after the other.
    pub(super) connectivity: Vec<i64>,
    /// Number of nodes in the list up to the end of each cell.
    pub(super) ends: Vec<i64>,
    pub(super) types: Vec<u8>,
}

impl Cells {
    /// # Errors
    /// If VTK has no cell for a kind of element of the mesh.
    pub(super) fn of(mesh: &Mesh) -> std::io::Result<Self> {
        let (mut connectivity, mut ends, mut types) = (Vec::new(), Vec::new(), Vec::new());
        for element in 0..mesh.element_count() as u32 {
            let kind = mesh.kind(element);
            let (number, order) = cell(kind).ok_or_else(|| {
                std::io::Error::other(format!("no VTK cell for elements of kind {}", kind.name()))
            })?;
            let nodes = mesh.nodes_of(element);
            connectivity.extend(order.iter().map(|&index| i64::from(nodes[index])));
            ends.push(connectivity.len() as i64);
            types.push(number);
        }
        Ok(Self {
            connectivity,
            ends,
            types,
        })
    }
}

impl VtuWriter {
    /// Writer of the files of a mesh.
    ///
    /// # Errors
    /// If the compressor fails, or VTK has no cell for a kind of element of the mesh.
    pub fn new(mesh: &Mesh, precision: FieldPrecision) -> std::io::Result<Self> {
        let Cells {
            connectivity,
            ends,
            types,
        } = Cells::of(mesh)?;
        let [connectivity, offsets] = [connectivity, ends].map(|numbers| -> Vec<u8> {
            let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
            bytes.collect()
        });
        let tags =
            |tags: &[u64]| -> Vec<u8> { tags.iter().flat_map(|t| t.to_le_bytes()).collect() };
        let array = |attributes: String, bytes: &[u8]| -> std::io::Result<Array> {
            let (unit, bytes) = (String::new(), compressed(bytes)?);
            Ok(Array {
                attributes,
                unit,
                bytes,
            })
        };
        let element_tags = tags(mesh.element_tags());
        let [of_nodes, of_elements] = TAGS.map(|name| format!(r#"type="UInt64" Name="{name}""#));
        let mut cell_static = vec![array(of_elements, &element_tags)?];
        for (name, elements) in mesh.element_sets() {
            let mut inside = vec![0_u8; mesh.element_count()];
            for &element in elements {
                inside[element as usize] = 1;
            }
            let attributes = format!(r#"type="UInt8" Name="{SET}{}""#, escaped(name));
            cell_static.push(array(attributes, &inside)?);
        }
        let positions = mesh.positions().iter().flat_map(|p| [p.x, p.y, p.z]);
        Ok(Self {
            nodes: mesh.node_count(),
            elements: mesh.element_count(),
            precision,
            present: None,
            points: compressed(&float_bytes(positions, true))?,
            cells: [
                compressed(&connectivity)?,
                compressed(&offsets)?,
                compressed(&types)?,
            ],
            point_static: vec![array(of_nodes, &tags(mesh.node_tags()))?],
            cell_static,
        })
    }

    /// Writer of the files of a surface: positions (m), and for each facet its three or four corners, or corners
    /// and midpoints in turn, as indices among them.
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
                // A triangle with midpoints, as the polygon around which its nodes are.
                6 => 7,
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
            present: None,
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

    /// Sets the active elements of the mesh for the files from now on, one flag per element.
    ///
    /// # Panics
    /// If the number of flags is not that of the elements.
    pub fn set_present(&mut self, mesh: &Mesh, present: &[bool]) {
        assert_eq!(present.len(), self.elements, "a flag for each element");
        // Nodes without any element stay active.
        let mut nodes = vec![true; self.nodes];
        for is_there in [false, true] {
            let elements = 0..self.elements as u32;
            for element in elements.filter(|&element| present[element as usize] == is_there) {
                for &node in mesh.nodes_of(element) {
                    nodes[node as usize] = is_there;
                }
            }
        }
        self.present = Some([nodes, present.to_vec()]);
    }

    /// Writes the fields of one instant at nodes and in elements.
    ///
    /// # Errors
    /// If a field has the wrong length, a number is not finite or, where required, not an integer, or the
    /// file cannot be written; each with the file's path.
    pub fn write(
        &self,
        file: &Path,
        time: f64,
        at_nodes: &[VtuField],
        in_elements: &[VtuField],
    ) -> Result<(), IoError> {
        let [nodes, elements] = match &self.present {
            Some([nodes, elements]) => [Some(&nodes[..]), Some(&elements[..])],
            None => [None, None],
        };
        let nodal = self.encode(file, at_nodes, (self.nodes, nodes))?;
        let mut elemental = self.encode(file, in_elements, (self.elements, elements))?;
        if let Some(elements) = elements {
            let flags: Vec<f64> = elements.iter().map(|&is| f64::from(u8::from(is))).collect();
            let field = VtuField {
                name: PRESENT,
                components: 1,
                numbers: VtuNumbers::Whole,
                unit: "",
                values: &flags,
            };
            elemental.extend(self.encode(file, &[field], (self.elements, None))?);
        }
        let mut units = String::new();
        for field in at_nodes.iter().chain(in_elements) {
            let _ = match field.unit {
                "" => Ok(()),
                unit => writeln!(units, "{}: {unit}{}", field.name, order(field.components)),
            };
        }
        let content = self.document((time, &units), &nodal, &elemental);
        write_whole(file, &content)
    }

    fn encode(
        &self,
        file: &Path,
        fields: &[VtuField],
        (count, present): (usize, Option<&[bool]>),
    ) -> Result<Arrays, IoError> {
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
            let absent = |index: &usize| {
                present.is_some_and(|present| !present[index / field.components.max(1)])
            };
            let mut finite = field.values.iter().enumerate();
            if let Some((index, &value)) =
                finite.find(|(index, value)| !value.is_finite() && !absent(index))
            {
                return Err(IoError::NotFinite {
                    file: file.into(),
                    what: field.name.into(),
                    index,
                    value,
                });
            }
            let blank = match field.numbers {
                _ if field.components == 3 => 0.0,
                VtuNumbers::Real => f64::NAN,
                VtuNumbers::Whole => -1.0,
            };
            let shown = || {
                let values = field.values.iter().enumerate();
                values.map(|(index, &value)| if absent(&index) { blank } else { value })
            };
            let (kind, bytes) = match field.numbers {
                VtuNumbers::Real if double => ("Float64", float_bytes(shown(), true)),
                VtuNumbers::Real => ("Float32", float_bytes(shown(), false)),
                VtuNumbers::Whole => {
                    let values: Vec<f64> = shown().collect();
                    let bytes = whole_bytes(&values).map_err(|index| IoError::NotWhole {
                        file: file.into(),
                        what: field.name.into(),
                        index,
                        value: values[index],
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
            let bytes = compressed(&bytes).map_err(IoError::file(file))?;
            encoded.push(Array {
                attributes,
                unit: field.unit.into(),
                bytes,
            });
        }
        Ok(encoded)
    }

    fn document(
        &self,
        (time, units): (f64, &str),
        at_nodes: &Arrays,
        in_elements: &Arrays,
    ) -> Vec<u8> {
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
        body.group("Points", [(positions, "m", self.points.as_slice())]);
        let names = [
            r#"type="Int64" Name="connectivity""#,
            r#"type="Int64" Name="offsets""#,
            r#"type="UInt8" Name="types""#,
        ];
        let cells = self.cells.iter().map(Vec::as_slice);
        let arrays = names.into_iter().zip(cells);
        body.group("Cells", arrays.map(|(name, bytes)| (name, "", bytes)));
        body.finish(time, units)
    }
}

/// Name of the field of active elements.
pub(super) const PRESENT: &str = "present";
/// Names of the numbers of nodes and elements in the input file.
pub(super) const TAGS: [&str; 2] = ["node_tag", "element_tag"];
/// Beginning of the names of the fields of element sets.
pub(super) const SET: &str = "set ";
/// Key of VTK of the unit of a field.
pub(super) const UNIT_KEY: &str = "UNITS_LABEL";

/// Data array.
struct Array {
    attributes: String,
    /// Unit; empty for none.
    unit: String,
    /// Compressed data.
    bytes: Vec<u8>,
}

type Arrays = Vec<Array>;

fn borrowed(arrays: &Arrays) -> impl Iterator<Item = (&str, &str, &[u8])> {
    arrays
        .iter()
        .map(|array| (&*array.attributes, &*array.unit, &*array.bytes))
}

/// XML part and, after it, the bytes to which it refers.
#[derive(Default)]
struct Body {
    xml: String,
    appended: Vec<u8>,
}

impl Body {
    fn open(&mut self, tag: &str) {
        let _ = writeln!(self.xml, "<{tag}>");
    }
    /// Adds arrays by attributes, unit and compressed bytes.
    fn group<'a>(
        &mut self,
        tag: &str,
        arrays: impl IntoIterator<Item = (&'a str, &'a str, &'a [u8])>,
    ) {
        let _ = writeln!(self.xml, "<{tag}>");
        for (attributes, unit, bytes) in arrays {
            let offset = self.appended.len();
            let start = format!(r#"<DataArray {attributes} format="appended" offset="{offset}""#);
            let _ = match unit {
                "" => writeln!(self.xml, "{start}/>"),
                unit => writeln!(
                    self.xml,
                    r#"{start}><InformationKey name="{UNIT_KEY}" location="vtkDataArray">{}</InformationKey></DataArray>"#,
                    escaped(unit)
                ),
            };
            self.appended.extend_from_slice(bytes);
        }
        let _ = writeln!(self.xml, "</{tag}>");
    }
    fn finish(self, time: f64, units: &str) -> Vec<u8> {
        let mut out = format!(
            concat!(
                r#"<?xml version="1.0"?>"#,
                "\n",
                r#"<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" "#,
                r#"header_type="UInt64" compressor="vtkZLibDataCompressor">"#,
                "\n<UnstructuredGrid>\n<FieldData>\n",
                r#"<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">"#,
                "{time}</DataArray>\n{units}</FieldData>\n{xml}</Piece>\n</UnstructuredGrid>\n",
                r#"<AppendedData encoding="raw">"#,
                "\n_"
            ),
            time = time,
            units = comment("units", units),
            xml = self.xml
        )
        .into_bytes();
        out.extend_from_slice(&self.appended);
        out.extend_from_slice(b"\n</AppendedData>\n</VTKFile>\n");
        out
    }
}

/// Names of the components of a vector or a symmetric tensor, in order.
pub(super) fn components_of(components: usize) -> &'static [&'static str] {
    match components {
        3 => &["x", "y", "z"],
        6 => &["xx", "yy", "zz", "xy", "yz", "zx"],
        _ => &[],
    }
}

/// Order of the components as a text.
fn order(components: usize) -> String {
    match components_of(components) {
        [] => String::new(),
        names => format!(" ({})", names.join(" ")),
    }
}

/// Text for people as a comment of a file; empty for no text. An array of text would be one that some programs, such as
/// meshio, do not read.
fn comment(name: &str, text: &str) -> String {
    match text.trim_end() {
        "" => String::new(),
        // A comment has no two dashes in succession.
        text => format!(
            "<!-- {name}\n{} -->\n",
            text.replace("--", "\u{2010}\u{2010}")
        ),
    }
}

fn component_names(components: usize) -> String {
    let named = components_of(components).iter().enumerate();
    named.fold(String::new(), |mut text, (index, name)| {
        let _ = write!(text, r#" ComponentName{index}="{name}""#);
        text
    })
}
