//! Conversion of the content of a file into a mesh with its sets.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap, HashSet};

use powerhouse_model::{Mesh, MeshBuilder, MeshError, Vec3};

use super::error::{GmshFault, Located};
use super::raw::{RawElement, RawMesh};
use super::report::{GmshGroup, GmshReport};
use super::{Encoding, GmshVersion};
use crate::MeshOptions;
use crate::second_order::CurvedNodes;

/// Name of the set of all solids, if no solid of the file belongs to a physical group.
pub(super) const ALL: &str = "all";
/// Name of the set of the solids that belong to no physical group, if others do.
pub(super) const UNGROUPED: &str = "ungrouped";

/// Use of a file's element in the mesh.
#[derive(Clone, Copy, PartialEq)]
enum ElementUse {
    /// Element of the mesh, with this set in addition to those of its groups.
    Element(Option<&'static str>),
    Facet,
    Point,
    Dropped,
    /// Line of a group that is no bar.
    Curve,
}

/// Name of a physical group.
fn group_name(raw: &RawMesh, dimension: usize, group: i32) -> String {
    match raw.names.get(&(dimension, group)) {
        Some(name) if !name.is_empty() => name.clone(),
        _ => format!("physical_{dimension}_{group}"),
    }
}

/// Whether a group of an element is one of these bars.
fn is_named(raw: &RawMesh, bars: Option<&[&str]>, element: &RawElement) -> bool {
    let groups = raw.lists.groups(element.groups).iter();
    let mut names = groups.map(|group| group_name(raw, element.shape.dimension(), *group));
    bars.is_some_and(|bars| names.any(|name| bars.contains(&name.as_str())))
}

struct Assembly<'a> {
    raw: &'a RawMesh,
    /// Number of elements in each group.
    groups: BTreeMap<(usize, i32), usize>,
    uses: Vec<ElementUse>,
    used: HashSet<u64>,
}

impl<'a> Assembly<'a> {
    fn new(raw: &'a RawMesh, bars: Option<&[&str]>) -> Self {
        let elements = &raw.elements.elements;
        let top = elements.iter().map(|e| e.shape.dimension()).max();
        let top = top.unwrap_or(0);
        let grouped = |e: &RawElement| e.shape.dimension() == top && !e.groups.is_none();
        let beside = if elements.iter().any(grouped) {
            UNGROUPED
        } else {
            ALL
        };
        let is_bar = |e: &RawElement| match bars {
            None => e.shape.element().is_some(),
            Some(_) => is_named(raw, bars, e),
        };
        let element_use = |e: &RawElement| match (e.shape.dimension(), e.groups.is_none()) {
            (dimension, true) if dimension == top && e.shape.element().is_some() => {
                ElementUse::Element(Some(beside))
            }
            (_, true) => ElementUse::Dropped,
            (2, false) => ElementUse::Facet,
            (0, false) => ElementUse::Point,
            (1, false) if !is_bar(e) => ElementUse::Curve,
            (_, false) => ElementUse::Element(None),
        };
        let uses: Vec<ElementUse> = elements.iter().map(element_use).collect();
        let mut groups: BTreeMap<(usize, i32), usize> =
            raw.names.keys().map(|key| (*key, 0)).collect();
        let mut used = HashSet::new();
        for (element, element_use) in elements.iter().zip(&uses) {
            for &group in raw.lists.groups(element.groups) {
                *groups
                    .entry((element.shape.dimension(), group))
                    .or_default() += 1;
            }
            if matches!(element_use, ElementUse::Element(_)) {
                used.extend(raw.elements.nodes_of(element));
            }
        }
        Self {
            raw,
            groups,
            uses,
            used,
        }
    }

    /// Refuses elements of second order that are neither finite elements nor sides of one, unless they are dropped.
    fn check_order(&self) -> Result<(), Located> {
        let elements = self.raw.elements.elements.iter();
        let top = elements.clone().map(|e| e.shape.dimension()).max();
        for (element, element_use) in elements.zip(&self.uses) {
            if !element.shape.is_only_lowered() || *element_use == ElementUse::Curve {
                continue;
            }
            let is_top = Some(element.shape.dimension()) == top;
            if is_top || !element.groups.is_none() {
                let fault = GmshFault::SecondOrder {
                    name: element.shape.name(),
                    element: element.tag,
                };
                return Err(Located::new("$Elements", element.offset, fault));
            }
        }
        Ok(())
    }

    fn build(&self) -> Result<Mesh, Located> {
        let raw = self.raw;
        let has_elements = self
            .uses
            .iter()
            .any(|f| matches!(f, ElementUse::Element(_)));
        let has_only_facets = self.uses.contains(&ElementUse::Facet)
            && raw
                .elements
                .elements
                .iter()
                .all(|e| e.shape.dimension() < 3);
        if !has_elements || has_only_facets {
            let of = |dimension: usize| {
                let elements = raw.elements.elements.iter();
                elements
                    .filter(|e| e.shape.dimension() == dimension)
                    .count()
            };
            let (facets, lines, points) = (of(2), of(1), of(0));
            let fault = GmshFault::NoSolids {
                facets,
                lines,
                points,
            };
            return Err(Located::new("$Elements", raw.elements.start, fault));
        }
        let names: BTreeMap<(usize, i32), String> = (self.groups.keys())
            .map(|&(dimension, group)| ((dimension, group), group_name(self.raw, dimension, group)))
            .collect();
        let mut builder = Mesh::builder();
        for (tag, position) in raw.nodes.tags.iter().zip(&raw.nodes.positions) {
            if self.used.contains(tag) {
                builder.node(*tag, *position);
            }
        }
        let mut sets: Vec<&str> = Vec::new();
        for (element, element_use) in raw.elements.elements.iter().zip(&self.uses) {
            sets.clear();
            let dimension = element.shape.dimension();
            let groups = raw.lists.groups(element.groups);
            sets.extend(
                groups
                    .iter()
                    .map(|group| names[&(dimension, *group)].as_str()),
            );
            sets.sort_unstable();
            sets.dedup();
            self.add(&mut builder, element, *element_use, &mut sets)?;
        }
        builder.build().map_err(|error| self.locate(error))
    }

    fn add(
        &self,
        builder: &mut MeshBuilder,
        element: &RawElement,
        element_use: ElementUse,
        sets: &mut Vec<&str>,
    ) -> Result<(), Located> {
        let nodes = self.raw.elements.nodes_of(element);
        match (element_use, element.shape.element()) {
            (ElementUse::Element(beside), Some(kind)) => {
                sets.extend(beside);
                builder.element(element.tag, kind, nodes, sets);
            }
            (ElementUse::Facet, _) => {
                for set in sets.iter() {
                    builder.facet(set, nodes);
                }
            }
            (ElementUse::Curve, _) => {
                let there = nodes.iter().filter(|node| self.used.contains(*node));
                let there: Vec<u64> = there.copied().collect();
                // A surface or volume of the name is what a scene means by it.
                let is_free = |set: &&&str| {
                    let mut groups = self.groups.keys().filter(|(dimension, _)| *dimension > 1);
                    !groups
                        .any(|&(dimension, group)| group_name(self.raw, dimension, group) == ***set)
                };
                for set in sets.iter().filter(is_free).filter(|_| !there.is_empty()) {
                    builder.node_set(set, &there);
                }
            }
            (ElementUse::Point, _) => {
                for set in sets.iter() {
                    if let Some(&node) = nodes.iter().find(|node| !self.used.contains(node)) {
                        let group = (*set).into();
                        let fault = GmshFault::PointWithoutElement { group, node };
                        return Err(Located::new("$Elements", element.offset, fault));
                    }
                    builder.node_set(set, nodes);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Adds the position in the file to an error of the mesh.
    fn locate(&self, error: MeshError) -> Located {
        let elements = &self.raw.elements;
        let element = match &error {
            MeshError::CoincidentElements { second: tag, .. }
            | MeshError::Inverted { element: tag, .. }
            | MeshError::CurvedEdge { element: tag, .. }
            | MeshError::SidesDoNotFit { element: tag, .. }
            | MeshError::NoLength { element: tag } => {
                elements.elements.iter().find(|e| e.tag == *tag)
            }
            MeshError::FacetWithoutElement { nodes, .. } => {
                (elements.elements.iter()).find(|e| elements.nodes_of(e) == nodes)
            }
            _ => None,
        };
        let offset = element.map_or(elements.start, |element| element.offset);
        Located::new("$Elements", offset, error)
    }
}

/// Takes the corners alone of all elements of second order, if `first_order` is true, of their number; finds curved edges.
fn lower(raw: &mut RawMesh, first_order: bool) -> (usize, CurvedNodes) {
    let mut curved = CurvedNodes::default();
    let mut lowered = 0;
    let has_edges = |element: &RawElement| !element.shape.edges().is_empty();
    if !raw.elements.elements.iter().any(has_edges) {
        return (lowered, curved);
    }
    let tags = raw.nodes.tags.iter().copied();
    let positions: HashMap<u64, Vec3> = tags.zip(raw.nodes.positions.iter().copied()).collect();
    for element in &mut raw.elements.elements {
        let Some(first) = element.shape.first_order() else {
            continue;
        };
        let nodes = &raw.elements.nodes[element.first..][..element.shape.node_count()];
        let edges = (first.node_count(), element.shape.edges());
        curved.add(nodes, edges, |node| {
            positions.get(&node).copied().unwrap_or_default()
        });
        if first_order {
            element.shape = first;
            lowered += 1;
        }
    }
    (lowered, curved)
}

/// Makes one line of those of several groups that have the same nodes; returns the number of the others.
fn merge_lines(raw: &mut RawMesh) -> usize {
    let mut first_of: HashMap<[u64; 2], usize> = HashMap::new();
    let mut others: HashSet<usize> = HashSet::new();
    for at in 0..raw.elements.elements.len() {
        let element = raw.elements.elements[at];
        if element.shape.dimension() != 1 || element.groups.is_none() {
            continue;
        }
        let nodes = raw.elements.nodes_of(&element);
        let (a, b) = (nodes[0].min(nodes[1]), nodes[0].max(nodes[1]));
        match first_of.entry([a, b]) {
            Entry::Vacant(vacant) => {
                vacant.insert(at);
            }
            Entry::Occupied(occupied) => {
                let first = *occupied.get();
                let old = raw.lists.groups(raw.elements.elements[first].groups);
                let new = raw.lists.groups(element.groups);
                // A second line of one group is reported as a duplicate.
                if new.iter().all(|group| old.contains(group)) {
                    continue;
                }
                let both: Vec<i32> = old.iter().chain(new).copied().collect();
                raw.elements.elements[first].groups = raw.lists.intern(both);
                others.insert(at);
            }
        }
    }
    if !others.is_empty() {
        let mut at = 0..;
        raw.elements
            .elements
            .retain(|_| at.next().is_none_or(|at| !others.contains(&at)));
    }
    others.len()
}

/// Builds the mesh and checks the shapes of its elements.
pub(super) fn assemble(
    mut raw: RawMesh,
    version: GmshVersion,
    encoding: Encoding,
    options: MeshOptions<'_>,
) -> Result<(Mesh, GmshReport), Located> {
    let (lowered_elements, curved) = lower(&mut raw, options.first_order);
    raw.merged += merge_lines(&mut raw);
    let raw = &raw;
    let assembly = Assembly::new(raw, options.bars);
    assembly.check_order()?;
    let mesh = assembly.build()?;
    let mesh = if options.straighten {
        mesh.with_straight_edges()
    } else {
        mesh
    };
    let quality = mesh.check().map_err(|error| assembly.locate(error))?;
    let uses = |wanted: fn(&ElementUse) -> bool| assembly.uses.iter().filter(|f| wanted(f)).count();
    let report = GmshReport {
        version,
        encoding,
        nodes: raw.nodes.tags.len(),
        elements: raw.elements.elements.len() + raw.merged,
        merged_elements: raw.merged,
        dropped_elements: uses(|element_use| *element_use == ElementUse::Dropped),
        curve_elements: uses(|element_use| *element_use == ElementUse::Curve),
        collapsed_elements: raw.collapsed,
        ungrouped_elements: uses(|element_use| matches!(element_use, ElementUse::Element(Some(_)))),
        dropped_nodes: raw.nodes.tags.len() - mesh.node_count(),
        lowered_elements,
        curved_nodes: curved.count(),
        largest_curve: curved.largest(),
        groups: (assembly.groups.iter())
            .map(|(&(dimension, number), &elements)| GmshGroup {
                name: group_name(raw, dimension, number),
                dimension,
                number,
                elements,
            })
            .collect(),
        skipped_sections: raw.skipped.clone(),
        quality,
    };
    Ok((mesh, report))
}
