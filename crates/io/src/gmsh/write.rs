//! Writing of meshes as Gmsh files.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use powerhouse_model::Mesh;

use super::error::GmshError;
use super::shape::Shape;
use crate::write_whole;

/// Writes a mesh as a Gmsh file of version 4.1 in text form, atomically as [`write_whole`].
///
/// Nodes and elements keep their numbers and their order; every named set becomes a physical
/// group. In this format an element belongs to one entity and an entity to any number of groups,
/// so the elements of each combination of sets make an entity of their own.
///
/// Limits of the format: an empty set is lost; a facet set with one of the two facets of an interior
/// face is read back with both; elements of no set are read back in the set `all` or `ungrouped`;
/// nodes of no element are lost.
///
/// # Errors
/// [`GmshError::UnwritableName`], [`GmshError::NumbersExhausted`],
/// [`GmshError::UnwritableElement`], [`GmshError::File`].
pub fn write_gmsh(path: impl AsRef<Path>, mesh: &Mesh) -> Result<(), GmshError> {
    let path = path.as_ref();
    let mut content = FileContent::default();
    content.points(path, mesh)?;
    content.facets(path, mesh)?;
    content.number(path, mesh)?;
    content.elements(path, mesh)?;
    Ok(write_whole(path, content.text(mesh).as_bytes())?)
}

/// One element of the file.
struct FileElement {
    number: u64,
    nodes: Vec<u64>,
}

/// Consecutive elements of one type and entity.
struct Block {
    entity: (usize, usize),
    shape: Shape,
    elements: Vec<FileElement>,
}

/// Content of the file.
#[derive(Default)]
struct FileContent {
    /// Names of the groups of each dimension; a group's number is its index plus one.
    names: [Vec<String>; 4],
    /// Groups of the entities of each dimension; an entity's number is its index plus one.
    entities: [Vec<Vec<usize>>; 4],
    blocks: Vec<Block>,
}

/// Number of a value in a list, from 1; the value is appended if it is new.
fn number_in<T: PartialEq>(list: &mut Vec<T>, value: T) -> usize {
    let found = list.iter().position(|known| *known == value);
    1 + found.unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}

impl FileContent {
    fn group(&mut self, path: &Path, dimension: usize, name: &str) -> Result<usize, GmshError> {
        if name.is_empty() || name.contains(['"', '\n', '\r']) {
            return Err(GmshError::UnwritableName {
                file: path.into(),
                name: name.into(),
            });
        }
        Ok(number_in(&mut self.names[dimension], name.into()))
    }

    fn push(&mut self, shape: Shape, groups: Vec<usize>, element: FileElement) {
        let dimension = shape.dimension();
        let entity = (dimension, number_in(&mut self.entities[dimension], groups));
        match self.blocks.last_mut() {
            Some(block) if block.entity == entity && block.shape == shape => {
                block.elements.push(element);
            }
            _ => self.blocks.push(Block {
                entity,
                shape,
                elements: vec![element],
            }),
        }
    }

    fn points(&mut self, path: &Path, mesh: &Mesh) -> Result<(), GmshError> {
        let mut groups_of: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (name, nodes) in mesh.node_sets() {
            let group = self.group(path, 0, name)?;
            for &node in nodes {
                groups_of.entry(node).or_default().push(group);
            }
        }
        for (node, groups) in groups_of {
            let nodes = vec![mesh.node_tags()[node as usize]];
            self.push(Shape::Point, groups, FileElement { number: 0, nodes });
        }
        Ok(())
    }

    fn facets(&mut self, path: &Path, mesh: &Mesh) -> Result<(), GmshError> {
        // By sorted nodes: the nodes in order, and the groups.
        let mut sides: BTreeMap<Vec<u32>, (Vec<u64>, Vec<usize>)> = BTreeMap::new();
        for (name, facets) in mesh.facet_sets() {
            let group = self.group(path, 2, name)?;
            for facet in facets {
                let of_element = mesh.nodes_of(facet.element);
                let side = mesh.kind(facet.element).sides()[facet.side as usize];
                let nodes = side.iter().map(|&local| of_element[local as usize]);
                let mut key: Vec<u32> = nodes.clone().collect();
                key.sort_unstable();
                let tags = || nodes.map(|node| mesh.node_tags()[node as usize]).collect();
                let (_, groups) = sides.entry(key).or_insert_with(|| (tags(), Vec::new()));
                if groups.last() != Some(&group) {
                    groups.push(group);
                }
            }
        }
        for (nodes, groups) in sides.into_values() {
            let (shape, nodes) = match nodes[..] {
                // Midpoints follow the corners.
                [a, ab, b, bc, c, ca] => (Shape::Triangle6, vec![a, b, c, ab, bc, ca]),
                [_, _, _] => (Shape::Triangle3, nodes),
                _ => (Shape::Quadrilateral4, nodes),
            };
            self.push(shape, groups, FileElement { number: 0, nodes });
        }
        Ok(())
    }

    /// Numbers the points and facets, starting above the elements of the mesh.
    fn number(&mut self, path: &Path, mesh: &Mesh) -> Result<(), GmshError> {
        let largest = mesh.element_tags().iter().copied().max().unwrap_or(0);
        let mut last = largest;
        for element in self.blocks.iter_mut().flat_map(|block| &mut block.elements) {
            last = last.checked_add(1).ok_or_else(|| {
                let file = path.into();
                GmshError::NumbersExhausted { file, largest }
            })?;
            element.number = last;
        }
        Ok(())
    }

    fn elements(&mut self, path: &Path, mesh: &Mesh) -> Result<(), GmshError> {
        let count = mesh.element_count() as u32;
        let mut groups_of: Vec<Vec<usize>> = vec![Vec::new(); count as usize];
        let mut shapes = Vec::with_capacity(count as usize);
        for element in 0..count {
            let kind = mesh.kind(element);
            shapes.push(Shape::of_element(kind).ok_or_else(|| {
                let (file, kind) = (path.into(), kind.name());
                GmshError::UnwritableElement { file, kind }
            })?);
        }
        for (name, elements) in mesh.element_sets() {
            for &element in elements {
                let group = self.group(path, shapes[element as usize].dimension(), name)?;
                groups_of[element as usize].push(group);
            }
        }
        for (element, (shape, groups)) in (0..count).zip(shapes.into_iter().zip(groups_of)) {
            let nodes = mesh.nodes_of(element).iter();
            let element = FileElement {
                number: mesh.element_tags()[element as usize],
                nodes: nodes.map(|&node| mesh.node_tags()[node as usize]).collect(),
            };
            self.push(shape, groups, element);
        }
        Ok(())
    }

    fn text(&self, mesh: &Mesh) -> String {
        let mut lines = vec![
            "$MeshFormat".into(),
            "4.1 0 8".into(),
            "$EndMeshFormat".into(),
        ];
        self.write_names(&mut lines);
        self.write_entities(&mut lines, mesh);
        self.write_nodes(&mut lines, mesh);
        self.write_elements(&mut lines);
        lines.push(String::new());
        lines.join("\n")
    }

    fn write_names(&self, lines: &mut Vec<String>) {
        lines.push("$PhysicalNames".into());
        lines.push(self.names.iter().map(Vec::len).sum::<usize>().to_string());
        for (dimension, names) in self.names.iter().enumerate() {
            for (index, name) in names.iter().enumerate() {
                lines.push(format!("{dimension} {} \"{name}\"", index + 1));
            }
        }
        lines.push("$EndPhysicalNames".into());
    }

    fn write_entities(&self, lines: &mut Vec<String>, mesh: &Mesh) {
        let (low, high) = mesh.bounding_box();
        lines.push("$Entities".into());
        lines.push(numbers(self.entities.iter().map(Vec::len)));
        for (dimension, entities) in self.entities.iter().enumerate() {
            for (index, groups) in entities.iter().enumerate() {
                let mut line = format!("{} {:?} {:?} {:?}", index + 1, low.x, low.y, low.z);
                if dimension > 0 {
                    let _ = write!(line, " {:?} {:?} {:?}", high.x, high.y, high.z);
                }
                let _ = write!(line, " {} {}", groups.len(), numbers(groups));
                if dimension > 0 {
                    line.push_str(" 0");
                }
                lines.push(line);
            }
        }
        lines.push("$EndEntities".into());
    }

    fn write_nodes(&self, lines: &mut Vec<String>, mesh: &Mesh) {
        let tags = mesh.node_tags();
        let (dimension, entity) = self.blocks.last().map_or((3, 1), |block| block.entity);
        lines.push("$Nodes".into());
        lines.push(format!("1 {} {}", tags.len(), range(tags.iter().copied())));
        lines.push(format!("{dimension} {entity} 0 {}", tags.len()));
        lines.extend(tags.iter().map(u64::to_string));
        for position in mesh.positions() {
            lines.push(format!(
                "{:?} {:?} {:?}",
                position.x, position.y, position.z
            ));
        }
        lines.push("$EndNodes".into());
    }

    fn write_elements(&self, lines: &mut Vec<String>) {
        let elements = || self.blocks.iter().flat_map(|block| &block.elements);
        lines.push("$Elements".into());
        lines.push(format!(
            "{} {} {}",
            self.blocks.len(),
            elements().count(),
            range(elements().map(|element| element.number))
        ));
        for block in &self.blocks {
            let (dimension, entity) = block.entity;
            let (number, count) = (block.shape.number(), block.elements.len());
            lines.push(format!("{dimension} {entity} {number} {count}"));
            for element in &block.elements {
                lines.push(format!("{} {}", element.number, numbers(&element.nodes)));
            }
        }
        lines.push("$EndElements".into());
    }
}

fn numbers(values: impl IntoIterator<Item = impl ToString>) -> String {
    let words: Vec<String> = values.into_iter().map(|value| value.to_string()).collect();
    words.join(" ")
}

fn range(values: impl Iterator<Item = u64> + Clone) -> String {
    let (least, largest) = (values.clone().min(), values.max());
    format!("{} {}", least.unwrap_or(0), largest.unwrap_or(0))
}
