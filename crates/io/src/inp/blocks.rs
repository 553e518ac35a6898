//! Content of a file after the first pass: nodes, elements, and where the lines of each set are.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::ops::Range;

use powerhouse_model::{ElementKind, Vec3};

use super::shape::Shape;
use crate::degenerate::Collapsed;

/// Name of a set, which is the same in capitals and small letters unless it is in quotation marks.
#[derive(Clone, Debug)]
pub(super) struct Name {
    /// The name as it is compared.
    pub(super) key: String,
    /// The name as it is written, without quotation marks.
    pub(super) text: String,
}

impl Name {
    pub(super) fn new(text: &str) -> Self {
        let inner = text.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
        match inner {
            Some(inner) => Self {
                key: inner.into(),
                text: inner.into(),
            },
            None => Self {
                key: text.to_uppercase(),
                text: text.into(),
            },
        }
    }
}

/// Nodes in the order of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct RawNodes {
    pub(super) tags: Vec<u64>,
    pub(super) positions: Vec<Vec3>,
    /// Index of each number.
    pub(super) index: HashMap<u64, u32>,
}

/// One element of the file; its nodes are in [`RawElements::nodes`].
#[derive(Clone, Copy, Debug)]
pub(super) struct RawElement {
    pub(super) tag: u64,
    pub(super) shape: &'static Shape,
    /// Index of its first node.
    pub(super) first: usize,
    pub(super) offset: usize,
}

/// Elements in the order of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct RawElements {
    pub(super) elements: Vec<RawElement>,
    /// Nodes by their numbers, in the order of the file.
    pub(super) nodes: Vec<u64>,
    /// Index of each number.
    pub(super) index: HashMap<u64, u32>,
    /// Numbers of elements that are left out, such as springs.
    pub(super) outside: HashSet<u64>,
    /// Solids with repeated nodes, by index: what they are, and the kind and nodes that they have in the file.
    pub(super) collapsed: HashMap<u32, (Collapsed, ElementKind, [u64; 8])>,
}

impl RawElements {
    pub(super) fn nodes_of(&self, element: &RawElement) -> &[u64] {
        &self.nodes[element.first..element.first + element.shape.nodes]
    }
}

/// What a set consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SetKind {
    Nodes,
    Elements,
    Faces,
}

/// Where the members of a set are.
#[derive(Clone, Debug)]
pub(super) enum Source {
    /// Consecutive nodes or elements of the file, by index.
    Defined(Range<u32>),
    /// Lines of data from this offset on (bytes), of numbers that are generated or not.
    Lines { at: usize, generate: bool },
}

/// Members that a passage of the file adds to a set.
#[derive(Clone, Debug)]
pub(super) struct SetBlock {
    pub(super) kind: SetKind,
    pub(super) name: Name,
    pub(super) source: Source,
    /// The instance to which the set belongs, by index; none of a set of the assembly or a flat input.
    pub(super) scope: Option<u32>,
    /// The instance whose numbers a set of the assembly has, by index; none if it has none, or of another set.
    pub(super) instance: Option<u32>,
    /// Whether it is in the assembly, where numbers may be those of nodes and elements of the assembly itself.
    pub(super) in_assembly: bool,
    /// Whether the file calls it internal.
    pub(super) internal: bool,
    /// Name and offset (bytes) of the keyword line.
    pub(super) keyword: &'static str,
    pub(super) offset: usize,
}

/// Nodes, elements and sets of a part, of an instance, or of the file itself.
#[derive(Clone, Debug, Default)]
pub(super) struct RawPart {
    pub(super) nodes: RawNodes,
    pub(super) elements: RawElements,
    pub(super) sets: Vec<SetBlock>,
}

impl RawPart {
    pub(super) fn is_empty(&self) -> bool {
        self.nodes.tags.is_empty() && self.elements.elements.is_empty() && self.sets.is_empty()
    }
}

/// Instance in the mesh.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub(super) name: Name,
    /// What is added to the numbers of its nodes and elements.
    pub(super) shift: u64,
    /// Its elements, by index.
    pub(super) elements: Range<u32>,
}

/// What is counted while the file is read.
#[derive(Debug, Default)]
pub(super) struct Counts {
    /// Elements that are left out, by type.
    pub(super) left_out: BTreeMap<String, usize>,
    /// Elements with temperatures or pore pressures as further unknowns.
    pub(super) coupled: usize,
    /// Nodes with fewer than three coordinates.
    pub(super) omitted: usize,
    /// Names of the skipped keywords.
    pub(super) skipped: BTreeSet<String>,
}

/// Content of a file after the first pass, with all instances at their places.
#[derive(Debug, Default)]
pub(super) struct RawMesh {
    pub(super) nodes: RawNodes,
    pub(super) elements: RawElements,
    pub(super) sets: Vec<SetBlock>,
    pub(super) instances: Vec<Placed>,
    /// Least shift of an instance but the first: no number is as large.
    pub(super) numbers: u64,
    /// Nodes of the assembly itself, of which no element is made.
    pub(super) points: HashSet<u64>,
    /// Elements of the assembly itself that are left out.
    pub(super) outside: HashSet<u64>,
    pub(super) counts: Counts,
}
