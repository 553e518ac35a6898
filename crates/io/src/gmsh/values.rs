//! Version 4.1: values, parsed by mshio from sections that the scanner has accepted.

use mshio::error::MshParserErrorKind;
use mshio::{MshFile, MshParserError};
use powerhouse_model::Vec3;

use super::error::{GmshFault, Located, snippet};
use super::format::{ByteOrder, Encoding, Format};
use super::msh4::{Block, ElementLayout, EntityGroups, NodeLayout};
use super::raw::{GroupList, RawElement, RawElements, RawNodes};

/// File for mshio: the header and the non-empty sections.
struct Excerpt {
    bytes: Vec<u8>,
    /// Of each section: offset in the excerpt, offset in the file, length (bytes) and name.
    parts: Vec<(usize, usize, usize, &'static str)>,
}

impl Excerpt {
    fn new(format: Format) -> Self {
        let mut bytes = Vec::new();
        let file_type = u8::from(format.encoding != Encoding::Text);
        let head = format!("$MeshFormat\n4.1 {file_type} {}\n", format.size_width);
        bytes.extend_from_slice(head.as_bytes());
        match format.encoding {
            Encoding::Text => {}
            Encoding::Binary(ByteOrder::Little) => bytes.extend_from_slice(&1_i32.to_le_bytes()),
            Encoding::Binary(ByteOrder::Big) => bytes.extend_from_slice(&1_i32.to_be_bytes()),
        }
        bytes.extend_from_slice(b"\n$EndMeshFormat\n");
        let parts = Vec::new();
        Self { bytes, parts }
    }
    fn add(&mut self, name: &'static str, file: &[u8], body: std::ops::Range<usize>) {
        self.bytes.extend_from_slice(format!("{name}\n").as_bytes());
        let (start, origin, length) = (self.bytes.len(), body.start, body.len());
        self.parts.push((start, origin, length, name));
        self.bytes.extend_from_slice(&file[body]);
        let end = format!("\n$End{}\n", &name[1..]);
        self.bytes.extend_from_slice(end.as_bytes());
    }
    /// Position in the file at which mshio stopped.
    fn locate(&self, error: &MshParserError<&[u8]>) -> Located {
        let left = error.backtrace.first().map_or(0, |first| first.0.len());
        let at = self.bytes.len() - left;
        let part = self.parts.iter().rev().find(|part| part.0 <= at);
        let (section, offset) = match part {
            Some(&(start, origin, length, name)) => (name, origin + (at - start).min(length)),
            None => ("", 0),
        };
        let fault = match error.first_msh_error() {
            // The scanner accepts a word as a number, mshio does not: one with a plus sign, for example.
            None
            | Some(
                MshParserErrorKind::InvalidTag
                | MshParserErrorKind::InvalidNodeDefinition
                | MshParserErrorKind::InvalidElementDefinition
                | MshParserErrorKind::Context(_),
            ) => GmshFault::Expected {
                what: "a number",
                found: snippet(&self.bytes[at..]),
            },
            Some(kind) => GmshFault::Values {
                reason: kind.to_string(),
            },
        };
        Located::new(section, offset, fault)
    }
}

/// Parses nodes and elements.
pub(super) fn read(
    file: &[u8],
    format: Format,
    nodes: NodeLayout,
    elements: ElementLayout,
    groups: &EntityGroups,
) -> Result<(RawNodes, RawElements), Located> {
    let mut excerpt = Excerpt::new(format);
    // With zero nodes or elements mshio subtracts 1 from 0.
    if !nodes.tags.is_empty() {
        excerpt.add("$Nodes", file, nodes.body.clone());
    }
    if !elements.tags.is_empty() {
        excerpt.add("$Elements", file, elements.body.clone());
    }
    let parsed = mshio::parse_msh_bytes(&excerpt.bytes).map_err(|error| excerpt.locate(&error))?;
    let raw_nodes = take_nodes(&parsed, nodes)?;
    let raw_elements = take_elements(&parsed, elements, groups)?;
    Ok((raw_nodes, raw_elements))
}

fn disagreement(section: &str, offset: usize, what: &'static str) -> Located {
    Located::new(section, offset, GmshFault::Disagreement { what })
}

fn same(block: &Block, dimension: i32, entity: i32, type_number: i32, count: usize) -> bool {
    block.dimension as i32 == dimension
        && block.entity == entity
        && block.type_number == type_number
        && block.count == count
}

fn take_nodes(parsed: &MshFile<u64, i32, f64>, layout: NodeLayout) -> Result<RawNodes, Located> {
    let blocks = parsed
        .data
        .nodes
        .iter()
        .flat_map(|nodes| &nodes.node_blocks);
    let blocks: Vec<_> = blocks.collect();
    let mut positions = Vec::with_capacity(layout.tags.len());
    for (block, scanned) in blocks.iter().zip(&layout.blocks) {
        let (dimension, entity) = (block.entity_dim, block.entity_tag);
        if !same(scanned, dimension, entity, 0, block.nodes.len()) {
            return Err(disagreement("$Nodes", layout.body.start, "node blocks"));
        }
        positions.extend(
            block
                .nodes
                .iter()
                .map(|node| Vec3::new(node.x, node.y, node.z)),
        );
    }
    if positions.len() != layout.tags.len() {
        return Err(disagreement("$Nodes", layout.body.start, "nodes"));
    }
    Ok(RawNodes {
        tags: layout.tags,
        positions,
        offsets: layout.offsets,
    })
}

fn take_elements(
    parsed: &MshFile<u64, i32, f64>,
    layout: ElementLayout,
    groups: &EntityGroups,
) -> Result<RawElements, Located> {
    let blocks = parsed.data.elements.iter();
    let blocks: Vec<_> = blocks
        .flat_map(|elements| &elements.element_blocks)
        .collect();
    let wrong = |offset| disagreement("$Elements", offset, "elements");
    let mut raw = RawElements {
        start: layout.body.start,
        ..RawElements::default()
    };
    raw.elements.reserve(layout.tags.len());
    for ((block, scanned), shape) in blocks.iter().zip(&layout.blocks).zip(&layout.shapes) {
        let (dimension, entity) = (block.entity_dim, block.entity_tag);
        let type_number = block.element_type as i32;
        if !same(
            scanned,
            dimension,
            entity,
            type_number,
            block.elements.len(),
        ) {
            return Err(wrong(layout.body.start));
        }
        let Some(shape) = *shape else { continue };
        let key = (scanned.dimension, entity);
        let list = groups.get(&key).copied().unwrap_or(GroupList::NONE);
        for element in &block.elements {
            let index = raw.elements.len();
            let offset = layout
                .offsets
                .get(index)
                .copied()
                .unwrap_or(layout.body.start);
            let agrees = layout.tags.get(index) == Some(&element.element_tag)
                && element.nodes.len() == shape.node_count();
            if !agrees {
                return Err(wrong(offset));
            }
            raw.elements.push(RawElement {
                tag: element.element_tag,
                shape,
                entity,
                groups: list,
                first: raw.nodes.len(),
                offset,
            });
            raw.nodes.extend_from_slice(&element.nodes);
        }
    }
    if raw.elements.len() != layout.tags.len() {
        return Err(wrong(layout.body.start));
    }
    Ok(raw)
}
