//! Pieces of a section that do not touch each other.

use std::collections::HashMap;

use powerhouse_model::{DisjointSets, Mesh, Vec3};

use super::plane::{Plane, PlaneArea};

/// Share of the area of a section below which a piece is a corner or an edge that the plane only grazes.
const GRAZED: f64 = 1e-6;
/// Direction along which few nodes of a regular mesh have the same coordinate.
const OBLIQUE: [f64; 3] = [0.613, 0.571, 0.546];

/// Piece of a section: cut elements that share nodes, or have nodes at the same point as on the two sides of a joint.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SectionPiece {
    /// Elements of the piece (mesh indices) that the plane intersects.
    pub elements: Vec<u32>,
    /// Area (m2).
    pub area: f64,
    /// Centroid (m).
    pub centroid: Vec3,
    /// Extent (m) along the section's `along`.
    pub width: f64,
    /// Extent (m) along the section's `across`.
    pub depth: f64,
}

/// Pieces of the intersection of a plane with elements, in the order of their first elements.
pub(super) fn pieces(
    mesh: &Mesh,
    plane: &Plane,
    cut: &[u32],
    [along, across]: [Vec3; 2],
) -> Vec<SectionPiece> {
    let mut sets = connected(mesh, cut, plane.tolerance);
    let mut of_root: HashMap<u32, usize> = HashMap::new();
    let mut found: Vec<(Vec<u32>, PlaneArea)> = Vec::new();
    for (index, &element) in cut.iter().enumerate() {
        let piece = *of_root.entry(sets.root(index as u32)).or_insert_with(|| {
            found.push(Default::default());
            found.len() - 1
        });
        let (elements, polygons) = &mut found[piece];
        let nodes = mesh.nodes_of(element).iter();
        let corners: Vec<Vec3> = nodes.map(|&node| mesh.positions()[node as usize]).collect();
        elements.push(element);
        polygons.add(plane, mesh.kind(element), &corners);
    }
    let whole: f64 = found.iter().map(|(_, polygons)| polygons.area).sum();
    (found.into_iter())
        .filter(|(_, polygons)| polygons.area > GRAZED * whole)
        .map(|(elements, polygons)| SectionPiece {
            elements,
            area: polygons.area,
            centroid: polygons.first_moment / polygons.area,
            width: polygons.extent(&along),
            depth: polygons.extent(&across),
        })
        .collect()
}

/// Sets of the indices of elements that share nodes, and for each node the index of the first element that has it.
pub(super) fn joined_by_nodes(mesh: &Mesh, elements: &[u32]) -> (DisjointSets, HashMap<u32, u32>) {
    let mut sets = DisjointSets::new(elements.len());
    let mut first_of: HashMap<u32, u32> = HashMap::new();
    for (index, &element) in elements.iter().enumerate() {
        for &node in mesh.nodes_of(element) {
            let first = *first_of.entry(node).or_insert(index as u32);
            sets.join(first, index as u32);
        }
    }
    (sets, first_of)
}

/// Sets of the indices of elements that are connected by common nodes, or by nodes within a distance (m) of each other.
pub(super) fn connected(mesh: &Mesh, elements: &[u32], tolerance: f64) -> DisjointSets {
    let (mut sets, first_of) = joined_by_nodes(mesh, elements);
    let oblique = Vec3::from(OBLIQUE);
    let place = |(node, index): (u32, u32)| {
        let position = mesh.positions()[node as usize];
        (oblique.dot(&position), position, index)
    };
    let mut places: Vec<(f64, Vec3, u32)> = first_of.into_iter().map(place).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (number, (height, position, index)) in places.iter().enumerate() {
        let next = places[number + 1..].iter();
        for (_, other, of) in next.take_while(|(above, ..)| above - height <= tolerance) {
            if (other - position).norm() <= tolerance {
                sets.join(*index, *of);
            }
        }
    }
    sets
}
