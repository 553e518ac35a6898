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
    /// Kind with the same corners, which are its first nodes in the same order; none of a facet.
    pub(super) solid: Option<ElementKind>,
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
        solid: Some(kind),
        edges: &[],
    }
}

/// A tetrahedron of ten nodes.
const fn ten(name: &'static str) -> Shape {
    Shape {
        name,
        nodes: 10,
        element: Some(ElementKind::Tet10),
        solid: Some(ElementKind::Tet4),
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
        solid: Some(corners),
        edges,
    }
}

/// A shell or plane element, of which the sides of solids become facets.
const fn facet(name: &'static str, nodes: usize) -> Shape {
    Shape {
        name,
        nodes,
        element: None,
        solid: None,
        edges: &[],
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

/// Shells, membranes and plane elements, without letters behind the number of nodes.
const FACETS: [Shape; 16] = [
    facet("CPS3", 3),
    facet("CPS4", 4),
    facet("CPE3", 3),
    facet("CPE4", 4),
    facet("CAX3", 3),
    facet("CAX4", 4),
    facet("S3", 3),
    facet("S4", 4),
    facet("STRI3", 3),
    facet("M3D3", 3),
    facet("M3D4", 4),
    facet("SFM3D3", 3),
    facet("SFM3D4", 4),
    facet("R3D3", 3),
    facet("R3D4", 4),
    facet("CPS6", 6),
];

/// Starts of the names of types without volume and area, which are left out: springs, dashpots, masses, connectors.
const LEFT_OUT: [&str; 9] = [
    "SPRING", "DASHPOT", "MASS", "ROTARYI", "CONN", "GAP", "DCOUP", "JOINTC", "HEATCAP",
];

/// Names of the types that are read, for messages.
pub(super) const NAMES: &str = "C3D8, C3D8R, C3D8I, C3D6, C3D5, C3D4, C3D10, C3D10M and T3D2, those with the letters R, I, M, H, T, P and S behind them, \
                                and shells and plane elements of three, four and six nodes on sides of solids; C3D20, C3D20R and C3D15 with `order = 1`";

/// What is done with the elements of a type.
pub(super) enum TypeOfName {
    /// They are read; whether they have further unknowns, as temperatures or pore pressures.
    Read(&'static Shape, bool),
    LeftOut,
    Unknown,
}

impl Shape {
    /// The type of a name, in capitals or small letters.
    pub(super) fn of_name(name: &str) -> TypeOfName {
        let known = |name: &str| {
            let mut all = SHAPES.iter().chain(&FACETS);
            all.find(|shape| shape.name.eq_ignore_ascii_case(name))
        };
        if let Some(shape) = known(name) {
            return TypeOfName::Read(shape, false);
        }
        // Letters of integration, hybrid formulation, hourglass control and further unknowns.
        let is_letter = |c: char| "RIHMTPS".contains(c.to_ascii_uppercase());
        let base = name.trim_end_matches(is_letter);
        let letters = name[base.len()..].to_ascii_uppercase();
        match known(base) {
            Some(shape) if letters.len() < 4 => {
                TypeOfName::Read(shape, letters.contains(['T', 'P']))
            }
            _ => {
                let upper = name.to_ascii_uppercase();
                if LEFT_OUT.iter().any(|start| upper.starts_with(start)) {
                    TypeOfName::LeftOut
                } else {
                    TypeOfName::Unknown
                }
            }
        }
    }
    /// The type of first order of a kind.
    pub(super) fn of_kind(kind: ElementKind) -> Option<&'static Self> {
        SHAPES.iter().find(|shape| shape.element == Some(kind))
    }
    pub(super) fn is_facet(&self) -> bool {
        self.solid.is_none()
    }
    /// Number of corners, which are the first nodes.
    pub(super) fn corners(&self) -> usize {
        let of_facet = if self.nodes == 6 { 3 } else { self.nodes };
        self.solid.map_or(of_facet, ElementKind::node_count)
    }
    /// Kind of the element in the mesh; none of a facet.
    pub(super) fn kind(&self, first_order: bool) -> Option<ElementKind> {
        self.element.filter(|_| !first_order).or(self.solid)
    }
    /// Appends the nodes in the order of the mesh, from those in the order of the file.
    pub(super) fn in_mesh_order<T: Copy>(
        &self,
        nodes: &[T],
        first_order: bool,
        ordered: &mut Vec<T>,
    ) {
        let corners = self.corners();
        ordered.extend_from_slice(&nodes[..corners]);
        let kind = self.kind(first_order);
        for ends in kind.map_or(&[][..], ElementKind::edges_with_midpoint) {
            let has = |own: &&[u8; 2]| own.contains(&ends[0]) && own.contains(&ends[1]);
            let middle = self.edges.iter().zip(&nodes[corners..]);
            ordered.extend(middle.filter(|(own, _)| has(own)).map(|(_, node)| *node));
        }
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
                shape.corners() + shape.edges.len(),
                shape.nodes,
                "{}",
                shape.name
            );
            let nodes: Vec<u64> = (1..=shape.nodes as u64).collect();
            for first_order in [false, true] {
                let mut ordered = Vec::new();
                shape.in_mesh_order(&nodes, first_order, &mut ordered);
                assert_eq!(ordered.len(), shape.kind(first_order).unwrap().node_count());
            }
        }
    }

    /// Letters behind a type change no nodes; those of further unknowns are reported, and types without volume are left
    /// out.
    #[test]
    fn names_with_letters_are_known() {
        for (name, nodes, more) in [
            ("C3D8RH", 8, false),
            ("c3d8t", 8, true),
            ("C3D8RP", 8, true),
            ("C3D10MH", 10, false),
            ("C3D4P", 4, true),
            ("CPS4R", 4, false),
            ("S4R", 4, false),
        ] {
            let found = Shape::of_name(name);
            assert!(
                matches!(found, TypeOfName::Read(shape, own) if shape.nodes == nodes && own == more),
                "{name}"
            );
        }
        for name in ["SPRINGA", "Dashpot1", "MASS", "CONN3D2"] {
            assert!(
                matches!(Shape::of_name(name), TypeOfName::LeftOut),
                "{name}"
            );
        }
        for name in ["B31", "C3D", "C3D8RIHTP", "XYZ", "S8R"] {
            assert!(
                matches!(Shape::of_name(name), TypeOfName::Unknown),
                "{name}"
            );
        }
    }

    /// Edges of types of second order are those between adjacent corners of the sides of the kind, each once.
    #[test]
    fn edges_are_those_of_the_sides() {
        for name in ["C3D10", "C3D15", "C3D20"] {
            let TypeOfName::Read(shape, false) = Shape::of_name(name) else {
                panic!("{name}");
            };
            let sorted = |mut edge: [u8; 2]| {
                edge.sort_unstable();
                edge
            };
            let sides = shape.solid.unwrap().sides().iter();
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
