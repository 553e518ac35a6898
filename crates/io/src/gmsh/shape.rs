//! Element types of the format.

use powerhouse_model::ElementKind;

/// Supported element types, in the order of [`FACTS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Shape {
    Point,
    Line2,
    Triangle3,
    Quadrilateral4,
    Tet4,
    Hex8,
    Wedge6,
    Pyramid5,
    Line3,
    Triangle6,
    Quadrilateral9,
    Quadrilateral8,
    Tet10,
    Hex27,
    Hex20,
    Wedge18,
    Wedge15,
    Pyramid14,
    Pyramid13,
}

/// Facts about an element type.
struct Facts {
    shape: Shape,
    /// Number of the type in the format.
    number: i32,
    /// Name with its article.
    name: &'static str,
    dimension: usize,
    nodes: usize,
    /// Kind of finite element, if it is one.
    element: Option<ElementKind>,
    /// The type with the same corners, which are its first nodes, and the ends of the edges whose midpoints follow them; for
    /// types of second order.
    first: Option<(Shape, &'static [[u8; 2]])>,
}

const TRIANGLE: &[[u8; 2]] = &[[0, 1], [1, 2], [2, 0]];
const QUADRILATERAL: &[[u8; 2]] = &[[0, 1], [1, 2], [2, 3], [3, 0]];
const TETRAHEDRON: &[[u8; 2]] = &[[0, 1], [1, 2], [2, 0], [3, 0], [2, 3], [1, 3]];
const HEXAHEDRON: &[[u8; 2]] = &[
    [0, 1],
    [0, 3],
    [0, 4],
    [1, 2],
    [1, 5],
    [2, 3],
    [2, 6],
    [3, 7],
    [4, 5],
    [4, 7],
    [5, 6],
    [6, 7],
];
const WEDGE: &[[u8; 2]] = &[
    [0, 1],
    [0, 2],
    [0, 3],
    [1, 2],
    [1, 4],
    [2, 5],
    [3, 4],
    [3, 5],
    [4, 5],
];
const PYRAMID: &[[u8; 2]] = &[
    [0, 1],
    [0, 3],
    [0, 4],
    [1, 2],
    [1, 4],
    [2, 3],
    [2, 4],
    [3, 4],
];

/// An element type of first order.
const fn first(
    shape: Shape,
    number: i32,
    name: &'static str,
    dimension: usize,
    nodes: usize,
    element: Option<ElementKind>,
) -> Facts {
    Facts {
        shape,
        number,
        name,
        dimension,
        nodes,
        element,
        first: None,
    }
}

/// An element type of second order that is read.
const fn second(
    shape: Shape,
    number: i32,
    name: &'static str,
    (dimension, nodes): (usize, usize),
    element: Option<ElementKind>,
    first: (Shape, &'static [[u8; 2]]),
) -> Facts {
    Facts {
        shape,
        number,
        name,
        dimension,
        nodes,
        element,
        first: Some(first),
    }
}

const FACTS: [Facts; 19] = [
    first(Shape::Point, 15, "a point", 0, 1, None),
    first(Shape::Line2, 1, "a line", 1, 2, Some(ElementKind::Bar2)),
    first(Shape::Triangle3, 2, "a triangle", 2, 3, None),
    first(Shape::Quadrilateral4, 3, "a quadrilateral", 2, 4, None),
    first(Shape::Tet4, 4, "a tet4", 3, 4, Some(ElementKind::Tet4)),
    first(Shape::Hex8, 5, "a hex8", 3, 8, Some(ElementKind::Hex8)),
    first(
        Shape::Wedge6,
        6,
        "a wedge6",
        3,
        6,
        Some(ElementKind::Wedge6),
    ),
    first(
        Shape::Pyramid5,
        7,
        "a pyramid5",
        3,
        5,
        Some(ElementKind::Pyramid5),
    ),
    second(
        Shape::Line3,
        8,
        "a line3",
        (1, 3),
        None,
        (Shape::Line2, &[[0, 1]]),
    ),
    second(
        Shape::Triangle6,
        9,
        "a triangle6",
        (2, 6),
        None,
        (Shape::Triangle3, TRIANGLE),
    ),
    second(
        Shape::Quadrilateral9,
        10,
        "a quadrilateral9",
        (2, 9),
        None,
        (Shape::Quadrilateral4, QUADRILATERAL),
    ),
    second(
        Shape::Quadrilateral8,
        16,
        "a quadrilateral8",
        (2, 8),
        None,
        (Shape::Quadrilateral4, QUADRILATERAL),
    ),
    second(
        Shape::Tet10,
        11,
        "a tet10",
        (3, 10),
        Some(ElementKind::Tet10),
        (Shape::Tet4, TETRAHEDRON),
    ),
    second(
        Shape::Hex27,
        12,
        "a hex27",
        (3, 27),
        None,
        (Shape::Hex8, HEXAHEDRON),
    ),
    second(
        Shape::Hex20,
        17,
        "a hex20",
        (3, 20),
        None,
        (Shape::Hex8, HEXAHEDRON),
    ),
    second(
        Shape::Wedge18,
        13,
        "a wedge18",
        (3, 18),
        None,
        (Shape::Wedge6, WEDGE),
    ),
    second(
        Shape::Wedge15,
        18,
        "a wedge15",
        (3, 15),
        None,
        (Shape::Wedge6, WEDGE),
    ),
    second(
        Shape::Pyramid14,
        14,
        "a pyramid14",
        (3, 14),
        None,
        (Shape::Pyramid5, PYRAMID),
    ),
    second(
        Shape::Pyramid13,
        19,
        "a pyramid13",
        (3, 13),
        None,
        (Shape::Pyramid5, PYRAMID),
    ),
];

/// Names of known unsupported types, by number.
const UNSUPPORTED: [(i64, &str); 14] = [
    (20, "triangle9"),
    (21, "triangle10"),
    (22, "triangle12"),
    (23, "triangle15"),
    (24, "triangle15"),
    (25, "triangle21"),
    (26, "line4"),
    (27, "line5"),
    (28, "line6"),
    (29, "tet20"),
    (30, "tet35"),
    (31, "tet56"),
    (92, "hex64"),
    (93, "hex125"),
];
/// Largest number of a type in the format.
const LAST_NUMBER: i64 = 140;

/// Element type of a number, as far as it exists and is supported.
pub(super) enum TypeOfNumber {
    Read(Shape),
    Unsupported(&'static str),
    Unknown,
}

impl Shape {
    pub(super) fn of_number(number: i64) -> TypeOfNumber {
        let known = FACTS.iter().find(|facts| i64::from(facts.number) == number);
        match known {
            Some(facts) => TypeOfNumber::Read(facts.shape),
            None if (1..=LAST_NUMBER).contains(&number) => TypeOfNumber::Unsupported(
                UNSUPPORTED
                    .iter()
                    .find(|known| known.0 == number)
                    .map_or("rare high-order type", |known| known.1),
            ),
            None => TypeOfNumber::Unknown,
        }
    }
    fn facts(self) -> &'static Facts {
        &FACTS[self as usize]
    }
    pub(super) fn number(self) -> i32 {
        self.facts().number
    }
    pub(super) fn name(self) -> &'static str {
        self.facts().name
    }
    pub(super) fn dimension(self) -> usize {
        self.facts().dimension
    }
    pub(super) fn node_count(self) -> usize {
        self.facts().nodes
    }
    /// Kind of finite element, if it is one.
    pub(super) fn element(self) -> Option<ElementKind> {
        self.facts().element
    }
    /// Whether it is of second order and neither a finite element nor a side of one.
    pub(super) fn is_only_lowered(self) -> bool {
        let facts = self.facts();
        facts.first.is_some() && facts.element.is_none() && self != Self::Triangle6
    }
    /// The type with the same corners, which are its first nodes, for types of second order.
    pub(super) fn first_order(self) -> Option<Self> {
        self.facts().first.map(|(first, _)| first)
    }
    /// Local nodes at the ends of the edges, whose midpoints follow the corners; none for types of first order.
    pub(super) fn edges(self) -> &'static [[u8; 2]] {
        self.facts().first.map_or(&[], |(_, edges)| edges)
    }
    pub(super) fn of_element(kind: ElementKind) -> Option<Self> {
        FACTS
            .iter()
            .find(|facts| facts.element == Some(kind))
            .map(|facts| facts.shape)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table is in the order of the types, numbers are those of no other type, and corners, midpoints of edges and
    /// those of sides and volumes make the nodes of a type of second order.
    #[test]
    fn the_table_is_consistent() {
        for (index, shape) in FACTS.iter().map(|facts| facts.shape).enumerate() {
            assert_eq!(shape as usize, index);
            let number = i64::from(shape.number());
            assert!(matches!(Shape::of_number(number), TypeOfNumber::Read(same) if same == shape));
            if let Some(kind) = shape.element() {
                assert_eq!(kind.node_count(), shape.node_count());
                assert_eq!(Shape::of_element(kind), Some(shape));
            }
            if let Some(first) = shape.first_order() {
                assert_eq!(first.dimension(), shape.dimension());
                let more = shape.node_count() - first.node_count() - shape.edges().len();
                assert!([0, 1, 3, 7].contains(&more), "{}", shape.name());
                let corners = shape.edges().as_flattened().iter();
                assert!(
                    corners
                        .clone()
                        .all(|&corner| usize::from(corner) < first.node_count())
                );
                assert_eq!(
                    corners.max().map(|&c| usize::from(c) + 1),
                    Some(first.node_count())
                );
            }
        }
    }

    /// Edges of types of second order are those between adjacent corners of the sides of the kind.
    #[test]
    fn edges_are_those_of_the_sides() {
        for shape in [Shape::Tet10, Shape::Hex20, Shape::Wedge15, Shape::Pyramid13] {
            let sorted = |mut edge: [u8; 2]| {
                edge.sort_unstable();
                edge
            };
            let first = shape.first_order().and_then(Shape::element).unwrap();
            let mut of_sides: Vec<[u8; 2]> = (first.sides().iter())
                .flat_map(|side| (0..side.len()).map(|i| [side[i], side[(i + 1) % side.len()]]))
                .map(sorted)
                .collect();
            of_sides.sort_unstable();
            of_sides.dedup();
            let mut own: Vec<[u8; 2]> = shape.edges().iter().copied().map(sorted).collect();
            own.sort_unstable();
            assert_eq!(own, of_sides, "{}", shape.name());
        }
    }
}
