//! All instances at their places, as one mesh.

use powerhouse_model::MeshError;

use super::blocks::{Placed, RawElement, RawMesh, RawPart, SetKind, Source};
use super::error::{InpFault, Located};
use super::parts::{Instance, Parts};

/// Puts the parts together: the file itself, or the instances of the assembly. The numbers of the nodes and elements
/// of the second instance, the third and so on are larger by one, two and so on times a power of ten that no number
/// reaches.
pub(super) fn all(parts: &Parts, mut contents: Vec<RawPart>) -> Result<RawMesh, Located> {
    let mut raw = RawMesh::default();
    let instances = &parts.instances;
    if instances.is_empty() {
        // A single part is where it was drawn.
        let names: Vec<usize> = parts.names().map(|(_, index)| *index).collect();
        let own = match names[..] {
            [] => 0,
            [part] => part,
            _ => {
                let parts = names.len();
                return Err(Located::new("", 0, InpFault::NoInstances { parts }));
            }
        };
        let of_assembly = if own == 0 {
            Vec::new()
        } else {
            std::mem::take(&mut contents[0].sets)
        };
        let part = std::mem::take(&mut contents[own]);
        (raw.nodes, raw.elements, raw.sets) = (part.nodes, part.elements, part.sets);
        raw.sets.extend(of_assembly);
        return Ok(raw);
    }
    for instance in instances {
        let is_moved = instance.placing.is_some();
        let own = &contents[instance.own];
        if is_moved && !(own.nodes.tags.is_empty() && own.elements.elements.is_empty()) {
            let name = instance.name.text.clone();
            let fault = InpFault::MovedContent { name };
            return Err(Located::new("*INSTANCE", instance.offset, fault));
        }
    }
    raw.numbers = power_above(&contents, instances)?;
    for (index, instance) in instances.iter().enumerate() {
        let shift = raw.numbers.checked_mul(index as u64);
        let shift = shift.filter(|shift| shift.checked_add(raw.numbers).is_some());
        let fault = InpFault::Numbers { most: raw.numbers };
        let shift = shift.ok_or_else(|| Located::new("*INSTANCE", instance.offset, fault))?;
        let first = raw.elements.elements.len() as u32;
        for part in [instance.part, instance.own] {
            // The content of a part is moved where no other instance needs it.
            let needed = instances[index + 1..]
                .iter()
                .any(|other| other.part == part);
            let part = if needed {
                contents[part].clone()
            } else {
                std::mem::take(&mut contents[part])
            };
            add(&mut raw, part, instance, (index, shift))?;
        }
        raw.instances.push(Placed {
            name: instance.name.clone(),
            shift,
            elements: first..raw.elements.elements.len() as u32,
        });
    }
    raw.sets.append(&mut contents[0].sets);
    Ok(raw)
}

/// Least power of ten above all numbers of the instances.
fn power_above(contents: &[RawPart], instances: &[Instance]) -> Result<u64, Located> {
    let used = instances
        .iter()
        .flat_map(|instance| [instance.part, instance.own]);
    let of_part = |index: usize| {
        let part = &contents[index];
        let elements = part.elements.elements.iter().map(|element| element.tag);
        let outside = part.elements.outside.iter().copied();
        part.nodes
            .tags
            .iter()
            .copied()
            .chain(elements)
            .chain(outside)
            .max()
    };
    let most = used.filter_map(of_part).max().unwrap_or(0);
    let mut power: u64 = 10;
    while power <= most {
        let fault = || Located::new("*INSTANCE", instances[0].offset, InpFault::Numbers { most });
        power = match power.checked_mul(10) {
            Some(power) => power,
            // A single instance needs no other numbers.
            None if instances.len() == 1 => return Ok(u64::MAX),
            None => return Err(fault()),
        };
    }
    Ok(power)
}

/// Adds the content of a part or an instance.
fn add(
    raw: &mut RawMesh,
    mut part: RawPart,
    instance: &Instance,
    (index, shift): (usize, u64),
) -> Result<(), Located> {
    let (first_node, first_element) = (
        raw.nodes.tags.len() as u32,
        raw.elements.elements.len() as u32,
    );
    if let Some(placing) = instance.placing {
        part.nodes
            .positions
            .iter_mut()
            .for_each(|position| *position = placing.of(*position));
    }
    for mut block in std::mem::take(&mut part.sets) {
        block.scope = Some(index as u32);
        if let Source::Defined(range) = block.source {
            let by = match block.kind {
                SetKind::Nodes => first_node,
                _ => first_element,
            };
            block.source = Source::Defined(range.start + by..range.end + by);
        }
        raw.sets.push(block);
    }
    if first_node == 0 && first_element == 0 && shift == 0 {
        (raw.nodes, raw.elements) = (part.nodes, part.elements);
        return Ok(());
    }
    for (tag, position) in part.nodes.tags.into_iter().zip(part.nodes.positions) {
        let next = raw.nodes.tags.len() as u32;
        if raw.nodes.index.insert(tag + shift, next).is_some() {
            let fault = MeshError::DuplicateNode { node: tag };
            return Err(Located::new("*INSTANCE", instance.offset, fault));
        }
        raw.nodes.tags.push(tag + shift);
        raw.nodes.positions.push(position);
    }
    let elements = &mut raw.elements;
    for element in &part.elements.elements {
        let fault = |fault: MeshError| Err(Located::new("*ELEMENT", element.offset, fault));
        // A number that no node of the part has must not become that of another instance.
        for &node in part.elements.nodes_of(element) {
            if node >= raw.numbers {
                return fault(MeshError::DanglingNode {
                    element: element.tag,
                    node,
                });
            }
        }
        let next = elements.elements.len() as u32;
        let first = elements.nodes.len();
        if elements.index.insert(element.tag + shift, next).is_some() {
            return fault(MeshError::DuplicateElement {
                element: element.tag,
            });
        }
        let nodes = part.elements.nodes_of(element).iter();
        elements.nodes.extend(nodes.map(|node| node + shift));
        let tag = element.tag + shift;
        elements.elements.push(RawElement {
            tag,
            first,
            ..*element
        });
    }
    let outside = part.elements.outside.into_iter();
    elements
        .outside
        .extend(outside.map(|number| number + shift));
    Ok(())
}
