//! Reader of VTU files as [`VtuWriter`](super::VtuWriter) writes them.

use std::path::Path;
use std::str::FromStr;

use powerhouse_model::{ElementKind, Mesh, Vec3};
use roxmltree::{Document, Node};

use super::decode::{NumberType, decompressed};
use super::writer::{PRESENT, SET, TAGS, UNIT_KEY, cell};
use crate::{IoError, read_whole};

/// Greatest size of a file (bytes).
const MOST: u64 = 1 << 36;
/// Beginning of the element that holds the data.
const APPENDED: &[u8] = b"<AppendedData";
/// Kinds of elements that have a cell.
const KINDS: [ElementKind; 6] = [
    ElementKind::Hex8,
    ElementKind::Tet4,
    ElementKind::Wedge6,
    ElementKind::Bar2,
    ElementKind::Pyramid5,
    ElementKind::Tet10,
];
/// Attributes of the files that are read, with their values.
const FORM: [(&str, &str); 4] = [
    ("type", "UnstructuredGrid"),
    ("byte_order", "LittleEndian"),
    ("header_type", "UInt64"),
    ("compressor", "vtkZLibDataCompressor"),
];

/// Field of a VTU file: one group of `components` numbers per node or element.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FieldOfFile {
    /// Name.
    pub name: String,
    /// Unit, such as `Pa`; empty for a dimensionless quantity or none stated.
    pub unit: String,
    /// Number of components: 1 for a scalar, 3 for a vector, 6 for a symmetric tensor (xx yy zz xy yz zx).
    pub components: usize,
    /// Numbers, group after group; NaN, or -1 of integers, where an element is inactive.
    pub values: Vec<f64>,
    /// Type of the numbers in the file.
    pub numbers: FieldNumbers,
}

/// Type of the numbers of a field in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldNumbers {
    /// Reals in single precision.
    Single,
    /// Reals in double precision.
    Double,
    /// Integers, such as those of a yield state.
    Whole,
}

/// Mesh and fields of one instant, read from a VTU file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct VtuGrid {
    /// Time (s), if the file states it.
    pub time: Option<f64>,
    /// Mesh with the numbers of its nodes and elements and its element sets.
    pub mesh: Mesh,
    /// Active elements, one flag per element; `None`: all are.
    pub present: Option<Vec<bool>>,
    /// Fields at nodes.
    pub at_nodes: Vec<FieldOfFile>,
    /// Fields in elements.
    pub in_elements: Vec<FieldOfFile>,
}

/// Reads a VTU file of elements as [`VtuWriter::write`](super::VtuWriter::write) writes it: compressed by zlib behind the
/// XML. Files of facets, and other forms of VTK's format, are refused.
///
/// # Errors
/// [`IoError::File`]; [`IoError::Grid`] with the reason.
pub fn read_vtu(file: &Path) -> Result<VtuGrid, IoError> {
    let bytes = read_whole(file, MOST).map_err(IoError::file(file))?;
    grid(&bytes).map_err(|reason| IoError::Grid {
        file: file.into(),
        reason,
    })
}

/// Data array that is not decompressed yet.
struct Stored<'a> {
    node: Node<'a, 'a>,
    data: &'a [u8],
}

impl Stored<'_> {
    fn attribute(&self, name: &str) -> Result<&str, String> {
        let value = self.node.attribute(name);
        value.ok_or_else(|| format!("{} lacks the attribute '{name}'", self.named()))
    }
    fn named(&self) -> String {
        let name = self.node.attribute("Name").unwrap_or("without a name");
        format!("the array '{name}'")
    }
    fn components(&self) -> Result<usize, String> {
        match self.node.attribute("NumberOfComponents") {
            Some(text) => whole(text, "NumberOfComponents"),
            None => Ok(1),
        }
    }
    /// Type and bytes of a number of groups.
    fn bytes(&self, groups: Option<usize>) -> Result<(NumberType, Vec<u8>), String> {
        let kind = self.attribute("type")?;
        let kind = NumberType::named(kind)
            .ok_or_else(|| format!("{} has numbers of type {kind}", self.named()))?;
        let offset = whole(self.attribute("offset")?, "offset")?;
        let bytes = decompressed(self.data, offset)
            .ok_or_else(|| format!("{} is damaged or ends early", self.named()))?;
        let per_group = self.components()?.checked_mul(kind.size());
        let expected = groups.map(|groups| per_group.and_then(|size| size.checked_mul(groups)));
        match expected {
            Some(expected) if expected != Some(bytes.len()) => Err(format!(
                "{} has {} bytes instead of {}",
                self.named(),
                bytes.len(),
                expected.map_or("a number that is too large".into(), |n| n.to_string())
            )),
            _ => Ok((kind, bytes)),
        }
    }
    fn wholes(&self, groups: Option<usize>) -> Result<Vec<u64>, String> {
        let (kind, bytes) = self.bytes(groups)?;
        let wholes = kind.wholes(&bytes);
        wholes.ok_or_else(|| format!("{} has numbers that are not whole", self.named()))
    }
    fn field(&self, groups: usize) -> Result<FieldOfFile, String> {
        let (kind, bytes) = self.bytes(Some(groups))?;
        let mut keys = self.node.children();
        let unit = keys.find(|key| key.attribute("name") == Some(UNIT_KEY));
        Ok(FieldOfFile {
            name: self.attribute("Name")?.into(),
            unit: unit.and_then(|key| key.text()).unwrap_or_default().into(),
            components: self.components()?,
            values: kind.reals(&bytes),
            numbers: kind.numbers(),
        })
    }
}

fn grid(bytes: &[u8]) -> Result<VtuGrid, String> {
    let cut = bytes
        .windows(APPENDED.len())
        .position(|window| window == APPENDED)
        .ok_or(
            "there is no appended data: the file is not a VTU file with raw data, or is cut off",
        )?;
    let data = bytes[cut..].iter().position(|byte| *byte == b'_');
    let data = &bytes[cut + data.map_or(0, |start| start + 1)..];
    let xml = std::str::from_utf8(&bytes[..cut]).map_err(|error| error.to_string())?;
    let xml = format!("{xml}</VTKFile>");
    let document = Document::parse(&xml).map_err(|error| error.to_string())?;
    let root = document.root_element();
    for (name, expected) in FORM {
        let found = root.attribute(name).unwrap_or_default();
        if found != expected {
            return Err(format!("{name} is \"{found}\" instead of \"{expected}\""));
        }
    }
    let find = |name: &str| root.descendants().find(|node| node.has_tag_name(name));
    let group = |name: &str| -> Result<Vec<Stored>, String> {
        let group = find(name).ok_or_else(|| format!("there is no element <{name}>"))?;
        let arrays = group
            .children()
            .filter(|node| node.has_tag_name("DataArray"));
        Ok(arrays.map(|node| Stored { node, data }).collect())
    };
    let piece = find("Piece").ok_or("there is no element <Piece>")?;
    let count = |name: &str| whole(piece.attribute(name).unwrap_or_default(), name);
    let (nodes, elements) = (count("NumberOfPoints")?, count("NumberOfCells")?);
    let time = group("FieldData")?
        .iter()
        .find(|array| array.node.attribute("Name") == Some("TimeValue"))
        .and_then(|array| array.node.text())
        .and_then(|text| text.trim().parse().ok());

    let mut contents = Contents::default();
    for array in group("PointData")? {
        match array.attribute("Name")? {
            name if name == TAGS[0] => contents.node_tags = Some(array.wholes(Some(nodes))?),
            _ => contents.at_nodes.push(array.field(nodes)?),
        }
    }
    for array in group("CellData")? {
        match array.attribute("Name")? {
            name if name == TAGS[1] => contents.element_tags = Some(array.wholes(Some(elements))?),
            PRESENT => {
                let flags = array.wholes(Some(elements))?;
                contents.present = Some(flags.iter().map(|flag| *flag != 0).collect());
            }
            name => match name.strip_prefix(SET) {
                Some(set) => contents
                    .sets
                    .push((set.into(), array.wholes(Some(elements))?)),
                None => contents.in_elements.push(array.field(elements)?),
            },
        }
    }
    let points = group("Points")?;
    let points = points.first().ok_or("there are no positions of nodes")?;
    let positions = points.field(nodes)?;
    if positions.components != 3 {
        return Err(format!(
            "positions have {} components",
            positions.components
        ));
    }
    let cells = group("Cells")?;
    let cell_array = |name: &str, groups: Option<usize>| {
        let found = cells
            .iter()
            .find(|array| array.node.attribute("Name") == Some(name));
        found
            .ok_or_else(|| format!("the cells have no array '{name}'"))?
            .wholes(groups)
    };
    let cells = Cells {
        ends: cell_array("offsets", Some(elements))?,
        types: cell_array("types", Some(elements))?,
        nodes: cell_array("connectivity", None)?,
    };
    let mesh = contents.mesh(&positions.values, &cells)?;
    Ok(VtuGrid {
        time,
        mesh,
        present: contents.present,
        at_nodes: contents.at_nodes,
        in_elements: contents.in_elements,
    })
}

/// Cells of a file.
struct Cells {
    /// Number of nodes of all cells up to each, itself included.
    ends: Vec<u64>,
    /// VTK's number of the type of each.
    types: Vec<u64>,
    /// Nodes of all cells, one after the other.
    nodes: Vec<u64>,
}

/// Arrays of a file by what they mean.
#[derive(Default)]
struct Contents {
    node_tags: Option<Vec<u64>>,
    element_tags: Option<Vec<u64>>,
    /// Element sets: name and a flag per element.
    sets: Vec<(String, Vec<u64>)>,
    present: Option<Vec<bool>>,
    at_nodes: Vec<FieldOfFile>,
    in_elements: Vec<FieldOfFile>,
}

impl Contents {
    /// The mesh of positions (m) and cells.
    fn mesh(&self, positions: &[f64], cells: &Cells) -> Result<Mesh, String> {
        let (positions, _) = positions.as_chunks::<3>();
        let numbered = |count: usize| (1..=count as u64).collect::<Vec<_>>();
        let node_tags = self.node_tags.clone();
        let node_tags = node_tags.unwrap_or_else(|| numbered(positions.len()));
        let element_tags = self.element_tags.clone();
        let element_tags = element_tags.unwrap_or_else(|| numbered(cells.ends.len()));
        let mut builder = Mesh::builder();
        for (tag, position) in node_tags.iter().zip(positions) {
            builder.node(*tag, Vec3::from(*position));
        }
        let mut start = 0;
        for (element, (&end, &number)) in cells.ends.iter().zip(&cells.types).enumerate() {
            let known =
                |kind: &ElementKind| cell(*kind).is_some_and(|(n, _)| u64::from(n) == number);
            let kind = KINDS.into_iter().find(known).ok_or_else(|| {
                format!("cell {element} is of VTK's type {number}, which is not that of an element")
            })?;
            let (_, order) = cell(kind).ok_or("an element has no cell")?;
            let end = usize::try_from(end).unwrap_or(usize::MAX);
            let cell = (cells.nodes.get(start..end)).filter(|nodes| nodes.len() == order.len());
            let cell = cell.ok_or_else(|| {
                format!(
                    "cell {element} of type {} ends at {end}, not at {}",
                    kind.name(),
                    start + order.len()
                )
            })?;
            start = end;
            let mut nodes = vec![0; order.len()];
            for (&place, &node) in order.iter().zip(cell) {
                let tag = usize::try_from(node)
                    .ok()
                    .and_then(|node| node_tags.get(node));
                nodes[place] = *tag.ok_or_else(|| {
                    format!(
                        "cell {element} names the node {node} of {}",
                        node_tags.len()
                    )
                })?;
            }
            builder.element(element_tags[element], kind, &nodes, &[] as &[&str]);
        }
        let mut mesh = builder.build().map_err(|error| error.to_string())?;
        for (name, flags) in &self.sets {
            let inside = flags.iter().enumerate().filter(|(_, flag)| **flag != 0);
            let inside = inside.map(|(element, _)| element as u32).collect();
            mesh.set_element_set(name, inside)
                .map_err(|error| error.to_string())?;
        }
        Ok(mesh)
    }
}

fn whole<T: FromStr>(text: &str, name: &str) -> Result<T, String> {
    let number = text.parse();
    number.map_err(|_| format!("the attribute '{name}' is \"{text}\" instead of a whole number"))
}
