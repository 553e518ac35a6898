//! Reading of the sections of a file.

use super::cursor::Cursor;
use super::error::{GmshFault, Located, snippet};
use super::format::{self, Encoding, Format, GmshVersion};
use super::msh4::{ElementLayout, EntityGroups, NodeLayout, Partitions};
use super::raw::{RawElements, RawMesh, RawNodes};
use super::section::{self, Marker};
use super::{msh2, msh4, values};

/// Content of the sections read so far.
#[derive(Default)]
struct Sections {
    raw: RawMesh,
    named: bool,
    groups: Option<EntityGroups>,
    node_layout: Option<NodeLayout>,
    element_layout: Option<ElementLayout>,
    nodes: Option<RawNodes>,
    elements: Option<RawElements>,
    /// Entities of a partitioned mesh, with the place of their section.
    partitions: Option<(Partitions, usize)>,
}

/// Reads the header of the file.
pub(super) fn head(bytes: &[u8]) -> Result<(Format, usize), Located> {
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(Located::new("", 0, GmshFault::Empty));
    }
    // A byte order mark of UTF-8 is no text.
    let start = if bytes.starts_with(b"\xef\xbb\xbf") {
        3
    } else {
        0
    };
    let not_gmsh = || {
        let found = snippet(bytes[start..].trim_ascii_start());
        let known = crate::known_format(bytes);
        Located::new("", 0, GmshFault::NotGmsh { found, known })
    };
    let marker = section::next(bytes, start).map_err(|_| not_gmsh())?;
    let marker = marker.ok_or_else(not_gmsh)?;
    match marker.name {
        b"$MeshFormat" => {}
        b"$NOD" => {
            let version = "1".into();
            let fault = GmshFault::Version { version };
            return Err(Located::new("", marker.offset, fault));
        }
        _ => return Err(not_gmsh()),
    }
    let (format, at) = format::read(bytes, marker.body)?;
    let end = marker.end_at(bytes, at).ok_or_else(|| marker.not_ended())?;
    Ok((format, end.after))
}

/// Reads all sections after the header, in any order.
pub(super) fn body(bytes: &[u8], format: Format, start: usize) -> Result<RawMesh, Located> {
    let mut sections = Sections::default();
    let mut at = start;
    while let Some(marker) = section::next(bytes, at)? {
        at = sections.take(bytes, format, marker)?;
    }
    sections.finish(bytes, format)
}

fn repeated(marker: &Marker<'_>, section: &'static str) -> Located {
    Located::new(section, marker.offset, GmshFault::Repeated { section })
}

impl Sections {
    /// Reads one section and returns the offset of the byte after it.
    fn take(&mut self, bytes: &[u8], format: Format, marker: Marker<'_>) -> Result<usize, Located> {
        let four = format.version == GmshVersion::Four;
        match marker.name {
            b"$MeshFormat" => Err(repeated(&marker, "$MeshFormat")),
            b"$PhysicalNames" => {
                if std::mem::replace(&mut self.named, true) {
                    return Err(repeated(&marker, "$PhysicalNames"));
                }
                let end = marker.end(bytes)?;
                self.raw.names = section::names(bytes, marker.body, end.start)?;
                Ok(end.after)
            }
            b"$Entities" if four => {
                let lists = &mut self.raw.lists;
                let (groups, after) =
                    walk(bytes, format, marker, "$Entities", "entity", |cursor| {
                        msh4::entities(cursor, lists)
                    })?;
                put(&mut self.groups, groups, &marker, "$Entities")?;
                Ok(after)
            }
            b"$Nodes" if four => {
                let (layout, after) = walk(bytes, format, marker, "$Nodes", "node", msh4::nodes)?;
                put(&mut self.node_layout, layout, &marker, "$Nodes")?;
                Ok(after)
            }
            b"$Nodes" => {
                let (nodes, after) = walk(bytes, format, marker, "$Nodes", "node", msh2::nodes)?;
                put(&mut self.nodes, nodes, &marker, "$Nodes")?;
                Ok(after)
            }
            b"$Elements" if four => {
                let (layout, after) = walk(
                    bytes,
                    format,
                    marker,
                    "$Elements",
                    "element",
                    msh4::elements,
                )?;
                put(&mut self.element_layout, layout, &marker, "$Elements")?;
                Ok(after)
            }
            b"$Elements" => {
                let lists = &mut self.raw.lists;
                let (elements, after) =
                    walk(bytes, format, marker, "$Elements", "element", |cursor| {
                        msh2::elements(cursor, lists)
                    })?;
                put(&mut self.elements, elements, &marker, "$Elements")?;
                Ok(after)
            }
            b"$ParametricNodes" => Err(Located::new(
                "$ParametricNodes",
                marker.offset,
                GmshFault::Parametric,
            )),
            b"$PartitionedEntities" if four => {
                let lists = &mut self.raw.lists;
                let section = "$PartitionedEntities";
                let (found, after) = walk(bytes, format, marker, section, "entity", |cursor| {
                    msh4::partitions(cursor, lists)
                })?;
                put(
                    &mut self.partitions,
                    (found, marker.offset),
                    &marker,
                    section,
                )?;
                Ok(after)
            }
            _ => {
                let end = match format.encoding {
                    Encoding::Text => marker.end(bytes)?,
                    Encoding::Binary(_) => marker.end_anywhere(bytes)?,
                };
                self.raw.skipped.push(marker.text());
                Ok(end.after)
            }
        }
    }

    fn finish(mut self, bytes: &[u8], format: Format) -> Result<RawMesh, Located> {
        let missing =
            |section| move || Located::new("", bytes.len(), GmshFault::Missing { section });
        match format.version {
            GmshVersion::Four => {
                let nodes = self.node_layout.ok_or_else(missing("$Nodes"))?;
                let elements = self.element_layout.ok_or_else(missing("$Elements"))?;
                let mut groups = self.groups.unwrap_or_default();
                if let Some((partitions, offset)) = self.partitions {
                    let merged = partitions.merged(groups, &elements.blocks);
                    groups = merged
                        .map_err(|fault| Located::new("$PartitionedEntities", offset, fault))?;
                }
                (self.raw.nodes, self.raw.elements) =
                    values::read(bytes, format, nodes, elements, &groups)?;
            }
            GmshVersion::Two => {
                self.raw.nodes = self.nodes.ok_or_else(missing("$Nodes"))?;
                self.raw.elements = self.elements.ok_or_else(missing("$Elements"))?;
            }
        }
        self.raw.collapse();
        self.raw.validate()?;
        if format.version == GmshVersion::Two {
            self.raw.merged = msh2::merge(&mut self.raw.elements, &mut self.raw.lists);
        }
        Ok(self.raw)
    }
}

fn put<T>(
    slot: &mut Option<T>,
    value: T,
    marker: &Marker<'_>,
    section: &'static str,
) -> Result<(), Located> {
    match slot.replace(value) {
        None => Ok(()),
        Some(_) => Err(repeated(marker, section)),
    }
}

/// Reads the numbers of a section and checks that its end follows them.
fn walk<T>(
    bytes: &[u8],
    format: Format,
    marker: Marker<'_>,
    section: &'static str,
    what: &'static str,
    read: impl FnOnce(&mut Cursor<'_>) -> Result<T, Located>,
) -> Result<(T, usize), Located> {
    // In a text the end is located first, so that no number is read from beyond it.
    let end = match format.encoding {
        Encoding::Text => Some(marker.end(bytes)?),
        Encoding::Binary(_) => None,
    };
    let mut cursor = Cursor {
        bytes,
        at: marker.body,
        end: end.map_or(bytes.len(), |end| end.start),
        encoding: format.encoding,
        size_width: format.size_width,
        section,
    };
    let value = read(&mut cursor)?;
    let after = match end {
        Some(end) => {
            cursor.skip_blanks();
            (cursor.at == end.start).then_some(end.after)
        }
        None => marker.end_at(bytes, cursor.at).map(|end| end.after),
    };
    let after = after.ok_or_else(|| {
        let found = snippet(&bytes[cursor.at..cursor.end]);
        cursor.fault(cursor.at, GmshFault::Surplus { what, found })
    })?;
    Ok((value, after))
}
