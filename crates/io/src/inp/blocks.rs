//! Content of a file after the first pass: nodes, elements, and where the lines of each set are.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

use powerhouse_model::Vec3;

use super::shape::Shape;

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
#[derive(Debug, Default)]
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
#[derive(Debug, Default)]
pub(super) struct RawElements {
    pub(super) elements: Vec<RawElement>,
    /// Nodes by their numbers, in the order of the file.
    pub(super) nodes: Vec<u64>,
    /// Index of each number.
    pub(super) index: HashMap<u64, u32>,
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
    /// Whether it belongs to the assembly, not to the part or to a flat input.
    pub(super) in_assembly: bool,
    /// Whether numbers are those of the instance; always true outside of the assembly.
    pub(super) of_instance: bool,
    /// Whether the file calls it internal.
    pub(super) internal: bool,
    /// Name and offset (bytes) of the keyword line.
    pub(super) keyword: &'static str,
    pub(super) offset: usize,
}

/// Content of a file after the first pass.
#[derive(Debug, Default)]
pub(super) struct RawMesh {
    pub(super) nodes: RawNodes,
    pub(super) elements: RawElements,
    pub(super) sets: Vec<SetBlock>,
    /// Name of the instance.
    pub(super) instance: Option<Name>,
    /// Names of the skipped keywords.
    pub(super) skipped: BTreeSet<String>,
}
