//! Version 2.2, which mshio does not support.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};

use powerhouse_model::Vec3;

use super::cursor::{Cursor, RecordSize};
use super::error::{GmshFault, Located};
use super::format::Encoding;
use super::raw::{GroupLists, NodeOffsets, RawElement, RawElements, RawNodes};
use super::shape::{Shape, TypeOfNumber};

/// Count at the start of a section, which is text in binary files too.
fn count(
    cursor: &mut Cursor<'_>,
    record: RecordSize,
    what: &'static str,
) -> Result<usize, Located> {
    let encoding = std::mem::replace(&mut cursor.encoding, Encoding::Text);
    let offset = cursor.offset();
    let count = cursor.size(what);
    cursor.encoding = encoding;
    let count = count?;
    if encoding != Encoding::Text {
        // The binary numbers start right after the line.
        for blank in [b'\r', b'\n'] {
            if cursor.bytes[cursor.at..cursor.end].first() == Some(&blank) {
                cursor.at += 1;
            }
        }
    }
    cursor.fits(offset, count, record, what)
}

/// Number of a node or element: an `int`, but of any size in text; not 0.
fn number(cursor: &mut Cursor<'_>, what: &'static str) -> Result<u64, Located> {
    let offset = cursor.offset();
    let number = if cursor.encoding == Encoding::Text {
        cursor.size("a number")?
    } else {
        let number = cursor.integer("a number")?;
        u64::try_from(number).map_err(|_| {
            let (what, found) = ("a number", number.to_string());
            cursor.fault(offset, GmshFault::Expected { what, found })
        })?
    };
    if number == 0 {
        return Err(cursor.fault(offset, GmshFault::Zero { what }));
    }
    Ok(number)
}

/// Count among the integers of an element.
fn small(
    cursor: &mut Cursor<'_>,
    record: RecordSize,
    what: &'static str,
) -> Result<usize, Located> {
    let offset = cursor.offset();
    let number = cursor.integer(what)?;
    let count = u64::try_from(number).map_err(|_| {
        let found = number.to_string();
        cursor.fault(offset, GmshFault::Expected { what, found })
    })?;
    cursor.fits(offset, count, record, what)
}

/// Reads `$Nodes`.
pub(super) fn nodes(cursor: &mut Cursor<'_>) -> Result<RawNodes, Located> {
    let record = RecordSize {
        integers: 1,
        reals: 3,
        ..RecordSize::default()
    };
    let count = count(cursor, record, "nodes")?;
    let mut nodes = RawNodes::default();
    for _ in 0..count {
        let at = cursor.offset();
        nodes.tags.push(number(cursor, "node")?);
        let position = cursor.offset();
        nodes.positions.push(Vec3::new(
            cursor.real("a coordinate")?,
            cursor.real("a coordinate")?,
            cursor.real("a coordinate")?,
        ));
        nodes.offsets.push(NodeOffsets { tag: at, position });
    }
    Ok(nodes)
}

const INTEGER: RecordSize = RecordSize {
    integers: 1,
    sizes: 0,
    reals: 0,
};

/// Checks that the partitions with elements are the first ones, at least two of them: how many there are the file does not
/// say.
fn complete(found: &BTreeSet<i32>) -> Result<(), GmshFault> {
    if found.len() > 1 && found.iter().copied().eq(1..=found.len() as i32) {
        Ok(())
    } else {
        Err(GmshFault::PartOfMesh {
            found: found.iter().copied().collect(),
            count: None,
        })
    }
}

/// Reads `$Elements`, and checks that they are those of a whole mesh.
pub(super) fn elements(
    cursor: &mut Cursor<'_>,
    lists: &mut GroupLists,
) -> Result<RawElements, Located> {
    let start = cursor.offset();
    let raw = all_elements(cursor, lists)?;
    if !raw.partitions.is_empty() {
        complete(&raw.partitions).map_err(|fault| cursor.fault(start, fault))?;
    }
    Ok(raw)
}

fn all_elements(cursor: &mut Cursor<'_>, lists: &mut GroupLists) -> Result<RawElements, Located> {
    let least = RecordSize {
        integers: 2,
        ..RecordSize::default()
    };
    let start = cursor.offset();
    let count = count(cursor, least, "elements")?;
    let mut raw = RawElements {
        start,
        ..RawElements::default()
    };
    if cursor.encoding == Encoding::Text {
        for _ in 0..count {
            let offset = cursor.offset();
            let number = number(cursor, "element")?;
            let type_at = cursor.offset();
            let type_number = cursor.integer("an element type")?;
            let shape = shape(cursor, type_at, type_number, number)?;
            let tags = small(cursor, INTEGER, "tags of an element")?;
            element(cursor, lists, &mut raw, (number, offset), shape, tags)?;
        }
        return Ok(raw);
    }
    while raw.elements.len() < count {
        let type_at = cursor.at;
        let type_number = cursor.integer("an element type")?;
        let follow_at = cursor.at;
        let following = small(cursor, INTEGER, "elements of one type")?;
        if following == 0 || following > count - raw.elements.len() {
            let fault = GmshFault::Total {
                what: "elements",
                stated: count as u64,
                found: (raw.elements.len() + following) as u64,
            };
            return Err(cursor.fault(follow_at, fault));
        }
        let tags = small(cursor, INTEGER, "tags of an element")?;
        for _ in 0..following {
            let offset = cursor.at;
            let number = number(cursor, "element")?;
            let shape = shape(cursor, type_at, type_number, number)?;
            element(cursor, lists, &mut raw, (number, offset), shape, tags)?;
        }
    }
    Ok(raw)
}

fn shape(cursor: &Cursor<'_>, offset: usize, number: i32, element: u64) -> Result<Shape, Located> {
    let number = number.into();
    match Shape::of_number(number) {
        TypeOfNumber::Read(shape) => Ok(shape),
        TypeOfNumber::Unsupported(name) => {
            let fault = GmshFault::UnsupportedElement { name, element };
            Err(cursor.fault(offset, fault))
        }
        TypeOfNumber::Unknown => Err(cursor.fault(offset, GmshFault::ElementType { number })),
    }
}

/// Reads tags and nodes of one element: the physical group, the entity, then tags of a partition.
fn element(
    cursor: &mut Cursor<'_>,
    lists: &mut GroupLists,
    raw: &mut RawElements,
    (tag, offset): (u64, usize),
    shape: Shape,
    tags: usize,
) -> Result<(), Located> {
    let (mut group, mut entity, mut partitions) = (0, 0, 0);
    for index in 0..tags {
        let value = cursor.integer("a tag of an element")?;
        match index {
            0 => group = value,
            1 => entity = value,
            2 => partitions = value,
            // The partition that owns the element; those beside it are negative.
            3 if partitions > 0 => {
                raw.partitions.insert(value);
            }
            _ => {}
        }
    }
    raw.elements.push(RawElement {
        tag,
        shape,
        entity,
        groups: lists.intern((group != 0).then_some(group)),
        first: raw.nodes.len(),
        offset,
    });
    for _ in 0..shape.node_count() {
        raw.nodes.push(number(cursor, "node")?);
    }
    Ok(())
}

/// Merges the copies of an element that the format writes once for each of its groups: the same
/// entity, type and nodes with another group. The number of the first is kept. Returns the number of
/// copies that were removed.
///
/// A second copy in the *same* group remains, and is then reported as a duplicate.
pub(super) fn merge(raw: &mut RawElements, lists: &mut GroupLists) -> usize {
    let mut first_of: HashMap<(Shape, i32, &[u64]), usize> = HashMap::new();
    let mut kept: Vec<RawElement> = Vec::with_capacity(raw.elements.len());
    for element in &raw.elements {
        let nodes = &raw.nodes[element.first..element.first + element.shape.node_count()];
        match first_of.entry((element.shape, element.entity, nodes)) {
            Entry::Vacant(vacant) => {
                vacant.insert(kept.len());
                kept.push(*element);
            }
            Entry::Occupied(occupied) => {
                let first = &mut kept[*occupied.get()];
                let (old, new) = (lists.groups(first.groups), lists.groups(element.groups));
                if new.is_empty() || old.is_empty() || new.iter().all(|group| old.contains(group)) {
                    kept.push(*element);
                } else {
                    let both: Vec<i32> = old.iter().chain(new).copied().collect();
                    first.groups = lists.intern(both);
                }
            }
        }
    }
    let merged = raw.elements.len() - kept.len();
    raw.elements = kept;
    merged
}
