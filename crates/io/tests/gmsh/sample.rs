//! A small mesh, and files of it in every format that is read.

use std::collections::BTreeMap;

use powerhouse_io::gmsh::{ByteOrder, GmshFault, GmshPlace};
use powerhouse_io::{GmshError, parse_gmsh};
use powerhouse_model::{ElementKind, Mesh, Vec3};

/// A format of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Format {
    Text2,
    Binary2(ByteOrder),
    Text4,
    /// With the width of a `size_t`.
    Binary4(ByteOrder, usize),
}

pub(crate) const FORMATS: [Format; 8] = [
    Format::Text2,
    Format::Binary2(ByteOrder::Little),
    Format::Binary2(ByteOrder::Big),
    Format::Text4,
    Format::Binary4(ByteOrder::Little, 8),
    Format::Binary4(ByteOrder::Big, 8),
    Format::Binary4(ByteOrder::Little, 4),
    Format::Binary4(ByteOrder::Big, 4),
];

impl Format {
    pub(crate) fn is_text(self) -> bool {
        matches!(self, Self::Text2 | Self::Text4)
    }
    fn is_two(self) -> bool {
        matches!(self, Self::Text2 | Self::Binary2(_))
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub(crate) tag: u64,
    /// The type's number in the format.
    pub(crate) type_number: i32,
    pub(crate) dimension: i32,
    pub(crate) entity: i32,
    pub(crate) groups: Vec<i32>,
    pub(crate) nodes: Vec<u64>,
}

/// Content of a file, unchecked.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sample {
    /// Dimension, number and name.
    pub(crate) names: Vec<(i32, i32, String)>,
    pub(crate) nodes: Vec<(u64, [f64; 3])>,
    pub(crate) elements: Vec<Element>,
    /// Another total than the true one.
    pub(crate) stated_nodes: Option<u64>,
    pub(crate) stated_elements: Option<u64>,
}

const KINDS: [(i32, i32, Option<ElementKind>); 7] = [
    (15, 0, None),
    (1, 1, Some(ElementKind::Bar2)),
    (2, 2, None),
    (3, 2, None),
    (4, 3, Some(ElementKind::Tet4)),
    (5, 3, Some(ElementKind::Hex8)),
    (6, 3, Some(ElementKind::Wedge6)),
];

impl Sample {
    pub(crate) fn element(&mut self, type_number: i32, entity: i32, groups: &[i32], nodes: &[u64]) {
        let kind = KINDS.iter().find(|kind| kind.0 == type_number).unwrap();
        let tag = self.elements.iter().map(|e| e.tag).max().unwrap_or(10) + 3;
        self.elements.push(Element {
            tag,
            type_number,
            dimension: kind.1,
            entity,
            groups: groups.to_vec(),
            nodes: nodes.to_vec(),
        });
    }

    /// A tower of two hexes, a wedge and a tet; a bar, faces and a point; a node
    /// of no element. Node numbers are sparse and in no order.
    pub(crate) fn tower() -> Self {
        let mut sample = Self::default();
        for (dimension, group, name) in [
            (3, 1, "rock mass"),
            (3, 2, "tête"),
            (2, 1, "base"),
            (1, 9, "bolt"),
            (0, 4, "tip"),
        ] {
            sample.names.push((dimension, group, name.into()));
        }
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        for level in 0..3_u64 {
            for (corner, [x, y]) in square.into_iter().enumerate() {
                let tag = 100 * (3 - level) + 7 * corner as u64;
                sample.nodes.push((tag, [x, y, level as f64 + 0.1 * x]));
            }
        }
        for (corner, [x, y]) in square.into_iter().take(3).enumerate() {
            sample.nodes.push((50 + corner as u64, [x, y, 3.25]));
        }
        sample.nodes.push((2, [0.5, 0.25, 4.0]));
        sample.nodes.push((1, [-9.0, 0.0, 1e-300]));
        sample.nodes.swap(0, 9);
        sample.nodes.swap(3, 14);
        sample.element(15, 1, &[4], &[2]);
        sample.element(1, 1, &[9], &[300, 214]);
        sample.element(3, 1, &[1], &[300, 307, 314, 321]);
        sample.element(2, 2, &[5], &[50, 51, 52]);
        sample.element(5, 1, &[1], &[300, 307, 314, 321, 200, 207, 214, 221]);
        sample.element(5, 2, &[1, 2], &[200, 207, 214, 221, 100, 107, 114, 121]);
        sample.element(6, 3, &[2], &[100, 107, 114, 50, 51, 52]);
        sample.element(4, 3, &[2], &[50, 51, 52, 2]);
        sample
    }

    /// Mesh of the file.
    pub(crate) fn mesh(&self) -> Mesh {
        let kind_of = |e: &Element| KINDS.iter().find(|kind| kind.0 == e.type_number).unwrap().2;
        let name = |dimension: i32, group: i32| {
            let named = self.names.iter().find(|n| n.0 == dimension && n.1 == group);
            named.map_or(format!("physical_{dimension}_{group}"), |n| n.2.clone())
        };
        let mut builder = Mesh::builder();
        for (tag, position) in &self.nodes {
            let mut solids = self.elements.iter().filter(|e| kind_of(e).is_some());
            if solids.any(|element| element.nodes.contains(tag)) {
                builder.node(*tag, Vec3::from(*position));
            }
        }
        for element in &self.elements {
            let groups = element.groups.iter();
            let sets: Vec<String> = groups.map(|&g| name(element.dimension, g)).collect();
            if let Some(kind) = kind_of(element) {
                builder.element(element.tag, kind, &element.nodes, &sets);
                continue;
            }
            for set in sets {
                if element.dimension == 2 {
                    builder.facet(&set, &element.nodes);
                } else {
                    builder.node_set(&set, &element.nodes);
                }
            }
        }
        builder.build().unwrap()
    }

    /// The file.
    pub(crate) fn file(&self, format: Format) -> Vec<u8> {
        let mut file = File {
            bytes: Vec::new(),
            format,
        };
        file.head();
        file.names(&self.names);
        if format.is_two() {
            file.nodes_two(self);
            file.elements_two(self);
        } else {
            file.entities_four(self);
            file.nodes_four(self);
            file.elements_four(self);
        }
        file.bytes
    }
}

/// Writer of a file.
struct File {
    bytes: Vec<u8>,
    format: Format,
}

impl File {
    fn line(&mut self, line: &str) {
        self.bytes.extend_from_slice(line.as_bytes());
        self.bytes.push(b'\n');
    }
    /// Ends a line of text.
    fn end_line(&mut self) {
        if self.format.is_text() {
            self.bytes.pop();
            self.bytes.push(b'\n');
        }
    }
    fn put<const N: usize>(&mut self, text: String, mut little: [u8; N]) {
        match self.format {
            Format::Text2 | Format::Text4 => {
                self.bytes.extend_from_slice(text.as_bytes());
                self.bytes.push(b' ');
                return;
            }
            Format::Binary2(ByteOrder::Big) | Format::Binary4(ByteOrder::Big, _) => {
                little.reverse();
            }
            _ => {}
        }
        self.bytes.extend_from_slice(&little);
    }
    fn integer(&mut self, value: i32) {
        self.put(value.to_string(), value.to_le_bytes());
    }
    fn real(&mut self, value: f64) {
        self.put(format!("{value:?}"), value.to_le_bytes());
    }
    /// A `size_t`, in version 2 an `int`; too large ones lose their upper bytes.
    fn size(&mut self, value: u64) {
        match self.format {
            Format::Binary2(_) | Format::Binary4(_, 4) => {
                self.put(value.to_string(), (value as u32).to_le_bytes());
            }
            _ => self.put(value.to_string(), value.to_le_bytes()),
        }
    }
    fn head(&mut self) {
        self.line("$MeshFormat");
        let line = match self.format {
            Format::Text2 => "2.2 0 8",
            Format::Binary2(_) => "2.2 1 8",
            Format::Text4 => "4.1 0 8",
            Format::Binary4(_, 4) => "4.1 1 4",
            Format::Binary4(..) => "4.1 1 8",
        };
        self.line(line);
        if !self.format.is_text() {
            self.integer(1);
            self.line("");
        }
        self.line("$EndMeshFormat");
    }
    fn names(&mut self, names: &[(i32, i32, String)]) {
        self.line("$PhysicalNames");
        self.line(&names.len().to_string());
        for (dimension, group, name) in names {
            self.line(&format!("{dimension} {group} \"{name}\""));
        }
        self.line("$EndPhysicalNames");
    }
    fn end(&mut self, section: &str) {
        if !self.format.is_text() {
            self.line("");
        }
        self.line(section);
    }
    fn nodes_two(&mut self, sample: &Sample) {
        self.line("$Nodes");
        let count = sample.stated_nodes.unwrap_or(sample.nodes.len() as u64);
        self.line(&count.to_string());
        for (tag, position) in &sample.nodes {
            self.size(*tag);
            position.iter().for_each(|value| self.real(*value));
            self.end_line();
        }
        self.end("$EndNodes");
    }
    /// An element is written once for each of its groups, the later times with a number of its own.
    fn elements_two(&mut self, sample: &Sample) {
        let mut largest = sample.elements.iter().map(|e| e.tag).max().unwrap_or(0);
        let mut copies = Vec::new();
        for element in &sample.elements {
            copies.push((element.tag, element.groups.first().copied(), element));
            for &group in element.groups.iter().skip(1) {
                largest += 1;
                copies.push((largest, Some(group), element));
            }
        }
        self.line("$Elements");
        let count = sample.stated_elements.unwrap_or(copies.len() as u64);
        self.line(&count.to_string());
        for run in copies.chunk_by(|a, b| a.2.type_number == b.2.type_number) {
            if !self.format.is_text() {
                self.integer(run[0].2.type_number);
                self.integer(run.len() as i32);
                self.integer(2);
            }
            for (tag, group, element) in run {
                self.size(*tag);
                if self.format.is_text() {
                    self.integer(element.type_number);
                    self.integer(2);
                }
                self.integer(group.unwrap_or(0));
                self.integer(element.entity);
                element.nodes.iter().for_each(|node| self.size(*node));
                self.end_line();
            }
        }
        self.end("$EndElements");
    }
    fn entities_four(&mut self, sample: &Sample) {
        let mut entities: [BTreeMap<i32, &[i32]>; 4] = Default::default();
        for element in &sample.elements {
            entities[element.dimension as usize].insert(element.entity, &element.groups);
        }
        self.line("$Entities");
        entities.iter().for_each(|of| self.size(of.len() as u64));
        self.end_line();
        for (dimension, entities) in entities.iter().enumerate() {
            for (entity, groups) in entities {
                self.integer(*entity);
                (0..if dimension == 0 { 3 } else { 6 }).for_each(|_| self.real(0.5));
                self.size(groups.len() as u64);
                groups.iter().for_each(|group| self.integer(*group));
                if dimension > 0 {
                    self.size(2);
                    self.integer(7);
                    self.integer(-8);
                }
                self.end_line();
            }
        }
        self.end("$EndEntities");
    }
    fn range(&mut self, tags: impl Iterator<Item = u64> + Clone) {
        self.size(tags.clone().min().unwrap_or(0));
        self.size(tags.max().unwrap_or(0));
        self.end_line();
    }
    fn nodes_four(&mut self, sample: &Sample) {
        self.line("$Nodes");
        let blocks: Vec<_> = sample.nodes.chunks(5).collect();
        self.size(blocks.len() as u64 + 1);
        self.size(sample.stated_nodes.unwrap_or(sample.nodes.len() as u64));
        self.range(sample.nodes.iter().map(|node| node.0));
        for block in blocks.into_iter().chain([&[][..]]) {
            [3, 1, 0].into_iter().for_each(|value| self.integer(value));
            self.size(block.len() as u64);
            self.end_line();
            for (tag, _) in block {
                self.size(*tag);
                self.end_line();
            }
            for (_, position) in block {
                position.iter().for_each(|value| self.real(*value));
                self.end_line();
            }
        }
        self.end("$EndNodes");
    }
    fn elements_four(&mut self, sample: &Sample) {
        let key = |e: &Element| (e.dimension, e.entity, e.type_number);
        let runs: Vec<_> = sample.elements.chunk_by(|a, b| key(a) == key(b)).collect();
        self.line("$Elements");
        self.size(runs.len() as u64);
        let count = sample.stated_elements;
        self.size(count.unwrap_or(sample.elements.len() as u64));
        self.range(sample.elements.iter().map(|element| element.tag));
        for run in runs {
            let (dimension, entity, type_number) = key(&run[0]);
            self.integer(dimension);
            self.integer(entity);
            self.integer(type_number);
            self.size(run.len() as u64);
            self.end_line();
            for element in run {
                self.size(element.tag);
                element.nodes.iter().for_each(|node| self.size(*node));
                self.end_line();
            }
        }
        self.end("$EndElements");
    }
}

/// Position and fault of an invalid file.
pub(crate) fn fault(bytes: &[u8]) -> (GmshPlace, GmshFault) {
    match parse_gmsh(bytes) {
        Err(GmshError::Content { place, fault, .. }) => (place, *fault),
        Err(other) => panic!("{other}"),
        Ok(read) => panic!("read without an error: {:?}", read.report),
    }
}

/// Position and fault of the tower's text with one passage replaced.
pub(crate) fn edit(format: Format, from: &str, to: &str) -> (GmshPlace, GmshFault) {
    let text = String::from_utf8(Sample::tower().file(format)).unwrap();
    assert!(text.contains(from), "{from}");
    fault(text.replacen(from, to, 1).as_bytes())
}

/// Pseudo-random numbers, the same in every run (Steele, Lea, Flood 2014, SplitMix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// Below a bound.
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        (self.bits() % bound as u64) as usize
    }
    /// Between 0 and 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.bits() as f64 / u64::MAX as f64
    }
    pub(crate) fn shuffle<T>(&mut self, values: &mut [T]) {
        for last in (1..values.len()).rev() {
            values.swap(last, self.below(last + 1));
        }
    }
}
