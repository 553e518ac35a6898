//! Element types of the format.

use powerhouse_model::ElementKind;

/// Element type that is read.
#[derive(Debug)]
pub(super) struct Shape {
    /// Name in the format.
    pub(super) name: &'static str,
    /// Number of its nodes in the file.
    pub(super) nodes: usize,
    /// Kind of finite element, if it is one; else it is read by its corners alone.
    pub(super) element: Option<ElementKind>,
    /// Kind with the same corners, which are its first nodes in the same order.
    pub(super) corners: ElementKind,
    /// Ends of the edges whose midpoints follow the corners, in the order of the file.
    pub(super) edges: &'static [[u8; 2]],
}

const TETRAHEDRON: &[[u8; 2]] = &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
const WEDGE: &[[u8; 2]] = &[
    [0, 1],
    [1, 2],
    [2, 0],
    [3, 4],
    [4, 5],
    [5, 3],
    [0, 3],
    [1, 4],
    [2, 5],
];
const HEXAHEDRON: &[[u8; 2]] = &[
    [0, 1],
    [1, 2],
    [2, 3],
    [3, 0],
    [4, 5],
    [5, 6],
    [6, 7],
    [7, 4],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

/// An element type of first order.
const fn first(name: &'static str, nodes: usize, kind: ElementKind) -> Shape {
    Shape {
        name,
        nodes,
        element: Some(kind),
        corners: kind,
        edges: &[],
    }
}

/// A tetrahedron of ten nodes.
const fn ten(name: &'static str) -> Shape {
    Shape {
        name,
        nodes: 10,
        element: Some(ElementKind::Tet10),
        corners: ElementKind::Tet4,
        edges: TETRAHEDRON,
    }
}

/// An element type of second order that is read by its corners alone.
const fn lowered(
    name: &'static str,
    nodes: usize,
    corners: ElementKind,
    edges: &'static [[u8; 2]],
) -> Shape {
    Shape {
        name,
        nodes,
        element: None,
        corners,
        edges,
    }
}

const SHAPES: [Shape; 12] = [
    first("C3D8", 8, ElementKind::Hex8),
    first("C3D8R", 8, ElementKind::Hex8),
    first("C3D8I", 8, ElementKind::Hex8),
    first("C3D6", 6, ElementKind::Wedge6),
    first("C3D5", 5, ElementKind::Pyramid5),
    first("C3D4", 4, ElementKind::Tet4),
    ten("C3D10"),
    ten("C3D10M"),
    first("T3D2", 2, ElementKind::Bar2),
    lowered("C3D20", 20, ElementKind::Hex8, HEXAHEDRON),
    lowered("C3D20R", 20, ElementKind::Hex8, HEXAHEDRON),
    lowered("C3D15", 15, ElementKind::Wedge6, WEDGE),
];

/// Names of the types that are read, for messages.
pub(super) const NAMES: &str = "C3D8, C3D8R, C3D8I, C3D6, C3D5, C3D4, C3D10, C3D10M and T3D2; C3D20, C3D20R and C3D15 with `order = 1`";

impl Shape {
    /// The type of a name, in capitals or small letters.
    pub(super) fn of_name(name: &str) -> Option<&'static Self> {
        SHAPES
            .iter()
            .find(|shape| shape.name.eq_ignore_ascii_case(name))
    }
    /// Kind of the element in the mesh.
    pub(super) fn kind(&self, first_order: bool) -> ElementKind {
        match self.element {
            Some(kind) if !first_order => kind,
            _ => self.corners,
        }
    }
    /// Nodes in the order of the mesh, from those in the order of the file.
    pub(super) fn in_mesh_order(&self, nodes: &[u64], first_order: bool) -> Vec<u64> {
        let kind = self.kind(first_order);
        let corners = self.corners.node_count();
        let mut ordered = nodes[..corners].to_vec();
        for ends in kind.edges_with_midpoint() {
            let has = |own: &&[u8; 2]| own.contains(&ends[0]) && own.contains(&ends[1]);
            let middle = self.edges.iter().zip(&nodes[corners..]);
            ordered.extend(middle.filter(|(own, _)| has(own)).map(|(_, node)| *node));
        }
        ordered
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every type is named in messages, and its corners and midpoints are all its nodes.
    #[test]
    fn the_table_is_consistent() {
        for shape in &SHAPES {
            assert!(NAMES.contains(shape.name), "{}", shape.name);
            assert_eq!(
                shape.corners.node_count() + shape.edges.len(),
                shape.nodes,
                "{}",
                shape.name
            );
            let nodes: Vec<u64> = (1..=shape.nodes as u64).collect();
            for first_order in [false, true] {
                let ordered = shape.in_mesh_order(&nodes, first_order);
                assert_eq!(ordered.len(), shape.kind(first_order).node_count());
            }
        }
    }

    /// Edges of types of second order are those between adjacent corners of the sides of the kind, each once.
    #[test]
    fn edges_are_those_of_the_sides() {
        for name in ["C3D10", "C3D15", "C3D20"] {
            let shape = Shape::of_name(name).unwrap();
            let sorted = |mut edge: [u8; 2]| {
                edge.sort_unstable();
                edge
            };
            let sides = shape.corners.sides().iter();
            let mut of_sides: Vec<[u8; 2]> = sides
                .flat_map(|side| (0..side.len()).map(|i| [side[i], side[(i + 1) % side.len()]]))
                .map(sorted)
                .collect();
            of_sides.sort_unstable();
            of_sides.dedup();
            let mut own: Vec<[u8; 2]> = shape.edges.iter().copied().map(sorted).collect();
            own.sort_unstable();
            assert_eq!(own, of_sides, "{name}");
        }
    }
}
