//! Element types of the format.

use powerhouse_model::ElementKind;

/// Supported element types.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Shape {
    Point,
    Line2,
    Triangle3,
    Quadrilateral4,
    Tet4,
    Hex8,
    Wedge6,
}

/// Names of known unsupported types, by number.
const UNSUPPORTED: [(i64, &str); 26] = [
    (7, "pyramid5"),
    (8, "line3"),
    (9, "triangle6"),
    (10, "quadrilateral9"),
    (11, "tet10"),
    (12, "hex27"),
    (13, "wedge18"),
    (14, "pyramid14"),
    (16, "quadrilateral8"),
    (17, "hex20"),
    (18, "wedge15"),
    (19, "pyramid13"),
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
        match number {
            1 => TypeOfNumber::Read(Self::Line2),
            2 => TypeOfNumber::Read(Self::Triangle3),
            3 => TypeOfNumber::Read(Self::Quadrilateral4),
            4 => TypeOfNumber::Read(Self::Tet4),
            5 => TypeOfNumber::Read(Self::Hex8),
            6 => TypeOfNumber::Read(Self::Wedge6),
            15 => TypeOfNumber::Read(Self::Point),
            _ if (1..=LAST_NUMBER).contains(&number) => TypeOfNumber::Unsupported(
                UNSUPPORTED
                    .iter()
                    .find(|known| known.0 == number)
                    .map_or("rare high-order type", |known| known.1),
            ),
            _ => TypeOfNumber::Unknown,
        }
    }
    pub(super) fn number(self) -> i32 {
        match self {
            Self::Line2 => 1,
            Self::Triangle3 => 2,
            Self::Quadrilateral4 => 3,
            Self::Tet4 => 4,
            Self::Hex8 => 5,
            Self::Wedge6 => 6,
            Self::Point => 15,
        }
    }
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Point => "a point",
            Self::Line2 => "a line",
            Self::Triangle3 => "a triangle",
            Self::Quadrilateral4 => "a quadrilateral",
            Self::Tet4 => "a tet4",
            Self::Hex8 => "a hex8",
            Self::Wedge6 => "a wedge6",
        }
    }
    pub(super) fn dimension(self) -> usize {
        match self {
            Self::Point => 0,
            Self::Line2 => 1,
            Self::Triangle3 | Self::Quadrilateral4 => 2,
            Self::Tet4 | Self::Hex8 | Self::Wedge6 => 3,
        }
    }
    pub(super) fn node_count(self) -> usize {
        match self {
            Self::Point => 1,
            Self::Line2 => 2,
            Self::Triangle3 => 3,
            Self::Quadrilateral4 | Self::Tet4 => 4,
            Self::Wedge6 => 6,
            Self::Hex8 => 8,
        }
    }
    /// Kind of finite element, if it is one.
    pub(super) fn element(self) -> Option<ElementKind> {
        match self {
            Self::Line2 => Some(ElementKind::Bar2),
            Self::Tet4 => Some(ElementKind::Tet4),
            Self::Hex8 => Some(ElementKind::Hex8),
            Self::Wedge6 => Some(ElementKind::Wedge6),
            Self::Point | Self::Triangle3 | Self::Quadrilateral4 => None,
        }
    }
    pub(super) fn of_element(kind: ElementKind) -> Option<Self> {
        match kind {
            ElementKind::Hex8 => Some(Self::Hex8),
            ElementKind::Tet4 => Some(Self::Tet4),
            ElementKind::Wedge6 => Some(Self::Wedge6),
            ElementKind::Bar2 => Some(Self::Line2),
            _ => None,
        }
    }
}
