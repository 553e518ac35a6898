//! Version 4.1: scanner of the sections.
//!
//! It reads every number, stores those that mshio drops or does not check (node numbers, counts,
//! ranges, types, groups) and the offset of each record.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

use super::cursor::{Cursor, RecordSize};
use super::error::{GmshFault, Located};
use super::raw::{GroupList, GroupLists, NodeOffsets};
use super::shape::{Shape, TypeOfNumber};

/// Physical groups of each entity by dimension and number.
pub(super) type EntityGroups = HashMap<(usize, i32), GroupList>;

/// Block of nodes or elements of one entity.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub(super) dimension: usize,
    pub(super) entity: i32,
    pub(super) count: usize,
    /// Number of the element type, 0 for nodes.
    pub(super) type_number: i32,
}

/// Layout of `$Nodes` found by the scanner.
#[derive(Debug)]
pub(super) struct NodeLayout {
    pub(super) body: Range<usize>,
    pub(super) blocks: Vec<Block>,
    pub(super) tags: Vec<u64>,
    pub(super) offsets: Vec<NodeOffsets>,
}

/// Layout of `$Elements` found by the scanner.
#[derive(Debug)]
pub(super) struct ElementLayout {
    pub(super) body: Range<usize>,
    pub(super) blocks: Vec<Block>,
    pub(super) shapes: Vec<Option<Shape>>,
    pub(super) tags: Vec<u64>,
    pub(super) offsets: Vec<usize>,
}

/// Entities of a partitioned mesh.
#[derive(Debug)]
pub(super) struct Partitions {
    count: u64,
    /// Physical groups of the entities.
    groups: EntityGroups,
    /// Partitions of each volume.
    of_volumes: HashMap<i32, Vec<i32>>,
}

impl Partitions {
    /// The groups of all entities, after a check that every volume has elements.
    pub(super) fn merged(
        self,
        mut entities: EntityGroups,
        blocks: &[Block],
    ) -> Result<EntityGroups, GmshFault> {
        let volumes = blocks.iter();
        let volumes = volumes.filter(|block| block.dimension == 3 && block.count > 0);
        let filled: BTreeSet<i32> = volumes.map(|block| block.entity).collect();
        // A file of some partitions has the volumes of all of them, but the elements of its own alone.
        if self
            .of_volumes
            .keys()
            .any(|volume| !filled.contains(volume))
        {
            let of_filled = filled
                .iter()
                .filter_map(|volume| self.of_volumes.get(volume));
            let found: BTreeSet<i32> = of_filled.flatten().copied().collect();
            return Err(GmshFault::PartOfMesh {
                found: found.into_iter().collect(),
                count: Some(self.count),
            });
        }
        for (key, list) in self.groups {
            if entities.insert(key, list).is_some() {
                let (dimension, entity) = key;
                return Err(GmshFault::RepeatedEntity { dimension, entity });
            }
        }
        Ok(entities)
    }
}

/// Reads `$Entities`.
pub(super) fn entities(
    cursor: &mut Cursor<'_>,
    lists: &mut GroupLists,
) -> Result<EntityGroups, Located> {
    let mut groups = EntityGroups::new();
    records(
        cursor,
        lists,
        |_| Ok(()),
        |_, key, list| groups.insert(key, list).is_none(),
    )?;
    Ok(groups)
}

/// Reads `$PartitionedEntities`.
pub(super) fn partitions(
    cursor: &mut Cursor<'_>,
    lists: &mut GroupLists,
) -> Result<Partitions, Located> {
    let pair = RecordSize {
        integers: 2,
        ..RecordSize::default()
    };
    let count = cursor.size("the number of partitions")?;
    for _ in 0..cursor.count(pair, "entities beside partitions")? {
        cursor.integer("the number of an entity beside a partition")?;
        cursor.integer("the partition beside an entity")?;
    }
    let (mut groups, mut of_volumes) = (EntityGroups::new(), HashMap::new());
    let tag = RecordSize {
        integers: 1,
        ..RecordSize::default()
    };
    let owners = |cursor: &mut Cursor<'_>| {
        cursor.integer("the dimension of a parent entity")?;
        cursor.integer("the number of a parent entity")?;
        let number = cursor.count(tag, "partitions of an entity")?;
        (0..number)
            .map(|_| cursor.integer("a partition of an entity"))
            .collect()
    };
    records(cursor, lists, owners, |owners: Vec<i32>, key, list| {
        if key.0 == 3 {
            of_volumes.insert(key.1, owners);
        }
        groups.insert(key, list).is_none()
    })?;
    Ok(Partitions {
        count,
        groups,
        of_volumes,
    })
}

/// Reads the records of entities: what follows their number by `after_number`, and all of it into `keep`, which says whether the
/// entity is new.
fn records<T>(
    cursor: &mut Cursor<'_>,
    lists: &mut GroupLists,
    after_number: impl Fn(&mut Cursor<'_>) -> Result<T, Located>,
    mut keep: impl FnMut(T, (usize, i32), GroupList) -> bool,
) -> Result<(), Located> {
    let point = RecordSize {
        integers: 1,
        sizes: 1,
        reals: 3,
    };
    let other = RecordSize {
        integers: 1,
        sizes: 2,
        reals: 6,
    };
    let tag = RecordSize {
        integers: 1,
        ..RecordSize::default()
    };
    let counts = [
        cursor.count(point, "points")?,
        cursor.count(other, "curves")?,
        cursor.count(other, "surfaces")?,
        cursor.count(other, "volumes")?,
    ];
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let offset = cursor.offset();
            let entity = cursor.integer("the number of an entity")?;
            let own = after_number(cursor)?;
            let reals = if dimension == 0 { 3 } else { 6 };
            cursor.skip_reals(reals, "a coordinate")?;
            let number = cursor.count(tag, "physical groups")?;
            let mut list = Vec::with_capacity(number);
            for _ in 0..number {
                list.push(cursor.integer("the number of a physical group")?);
            }
            if dimension > 0 {
                let bounding = cursor.count(tag, "bounding entities")?;
                for _ in 0..bounding {
                    cursor.integer("the number of a bounding entity")?;
                }
            }
            if !keep(own, (dimension, entity), lists.intern(list)) {
                let fault = GmshFault::RepeatedEntity { dimension, entity };
                return Err(cursor.fault(offset, fault));
            }
        }
    }
    Ok(())
}

/// Header that `$Nodes` and `$Elements` have in common.
struct Head {
    offset: usize,
    blocks: usize,
    total: u64,
    range: (u64, u64),
}

fn head(cursor: &mut Cursor<'_>, record: RecordSize, what: &'static str) -> Result<Head, Located> {
    let block = RecordSize {
        integers: 3,
        sizes: 1,
        ..RecordSize::default()
    };
    let offset = cursor.offset();
    let blocks = cursor.count(block, "blocks")?;
    let at = cursor.offset();
    let total = cursor.size("the total")?;
    let range = (
        cursor.size("the least number")?,
        cursor.size("the largest number")?,
    );
    cursor.fits(at, total, record, what)?;
    Ok(Head {
        offset,
        blocks,
        total,
        range,
    })
}

impl Head {
    /// Compares the header with the records.
    fn check(&self, cursor: &Cursor<'_>, tags: &[u64], what: &'static str) -> Result<(), Located> {
        let (stated, found) = (self.total, tags.len() as u64);
        if stated != found {
            let fault = GmshFault::Total {
                what,
                stated,
                found,
            };
            return Err(cursor.fault(self.offset, fault));
        }
        if let (Some(&least), Some(&largest)) = (tags.iter().min(), tags.iter().max())
            && self.range != (least, largest)
        {
            let fault = GmshFault::Range {
                what,
                stated: self.range,
                found: (least, largest),
            };
            return Err(cursor.fault(self.offset, fault));
        }
        Ok(())
    }
}

/// Number of a node or element, which is not 0.
fn number(cursor: &mut Cursor<'_>, what: &'static str) -> Result<u64, Located> {
    let offset = cursor.offset();
    match cursor.size("a number")? {
        0 => Err(cursor.fault(offset, GmshFault::Zero { what })),
        number => Ok(number),
    }
}

fn dimension(cursor: &mut Cursor<'_>) -> Result<usize, Located> {
    let offset = cursor.offset();
    let dimension = cursor.integer("the dimension of an entity")?;
    let permitted = usize::try_from(dimension).ok().filter(|d| *d <= 3);
    permitted.ok_or_else(|| {
        let fault = GmshFault::Dimension {
            what: "an entity",
            dimension: dimension.into(),
        };
        cursor.fault(offset, fault)
    })
}

/// Scans `$Nodes`.
pub(super) fn nodes(cursor: &mut Cursor<'_>) -> Result<NodeLayout, Located> {
    let start = cursor.at;
    let node = RecordSize {
        sizes: 1,
        reals: 3,
        ..RecordSize::default()
    };
    let head = head(cursor, node, "nodes")?;
    let mut layout = NodeLayout {
        body: start..start,
        blocks: Vec::with_capacity(head.blocks),
        tags: Vec::new(),
        offsets: Vec::new(),
    };
    for _ in 0..head.blocks {
        let dimension = dimension(cursor)?;
        let entity = cursor.integer("the number of an entity")?;
        let at = cursor.offset();
        match cursor.integer("the mark of parametric nodes")? {
            0 => {}
            1 => return Err(cursor.fault(at, GmshFault::Parametric)),
            other => {
                let what = "the mark of parametric nodes, 0 or 1";
                let found = other.to_string();
                return Err(cursor.fault(at, GmshFault::Expected { what, found }));
            }
        }
        let count = cursor.count(node, "nodes")?;
        let first = layout.offsets.len();
        for _ in 0..count {
            let tag = cursor.offset();
            layout.tags.push(number(cursor, "node")?);
            layout.offsets.push(NodeOffsets { tag, position: tag });
        }
        for offsets in &mut layout.offsets[first..] {
            offsets.position = cursor.offset();
            cursor.skip_reals(3, "a coordinate")?;
        }
        layout.blocks.push(Block {
            dimension,
            entity,
            count,
            type_number: 0,
        });
    }
    head.check(cursor, &layout.tags, "nodes")?;
    layout.body.end = cursor.at;
    Ok(layout)
}

/// Scans `$Elements`.
pub(super) fn elements(cursor: &mut Cursor<'_>) -> Result<ElementLayout, Located> {
    let start = cursor.at;
    let least = RecordSize {
        sizes: 2,
        ..RecordSize::default()
    };
    let head = head(cursor, least, "elements")?;
    let mut layout = ElementLayout {
        body: start..start,
        blocks: Vec::with_capacity(head.blocks),
        shapes: Vec::with_capacity(head.blocks),
        tags: Vec::new(),
        offsets: Vec::new(),
    };
    for _ in 0..head.blocks {
        let at = cursor.offset();
        let dimension = dimension(cursor)?;
        let entity = cursor.integer("the number of an entity")?;
        let type_at = cursor.offset();
        let type_number = cursor.integer("an element type")?;
        let shape = match Shape::of_number(type_number.into()) {
            TypeOfNumber::Read(shape) => Some(shape),
            TypeOfNumber::Unsupported(name) => {
                if cursor.count(least, "elements")? > 0 {
                    let element = cursor.size("the number of an element")?;
                    let fault = GmshFault::UnsupportedElement { name, element };
                    return Err(cursor.fault(type_at, fault));
                }
                None
            }
            TypeOfNumber::Unknown => {
                let number = type_number.into();
                return Err(cursor.fault(type_at, GmshFault::ElementType { number }));
            }
        };
        let mut count = 0;
        if let Some(shape) = shape {
            if shape.dimension() != dimension {
                let fault = GmshFault::Dimension {
                    what: shape.name(),
                    dimension: dimension as i64,
                };
                return Err(cursor.fault(at, fault));
            }
            let record = RecordSize {
                sizes: 1 + shape.node_count(),
                ..RecordSize::default()
            };
            count = cursor.count(record, "elements")?;
            for _ in 0..count {
                layout.offsets.push(cursor.offset());
                layout.tags.push(number(cursor, "element")?);
                cursor.skip_sizes(shape.node_count(), "a node of an element")?;
            }
        }
        layout.shapes.push(shape);
        layout.blocks.push(Block {
            dimension,
            entity,
            count,
            type_number,
        });
    }
    head.check(cursor, &layout.tags, "elements")?;
    layout.body.end = cursor.at;
    Ok(layout)
}
