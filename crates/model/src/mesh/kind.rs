//! Element kinds.

/// Geometric kind of a finite element, with its nodes in Gmsh's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum ElementKind {
    /// Eight-node hexahedron: bottom 0 1 2 3 counter-clockwise seen from above, top 4 5 6 7.
    Hex8,
    /// Four-node tetrahedron.
    Tet4,
    /// Six-node wedge: triangles 0 1 2 and 3 4 5.
    Wedge6,
    /// Two-node bar.
    Bar2,
}

const HEX_SIDES: [&[u8]; 6] = [
    &[0, 3, 2, 1],
    &[4, 5, 6, 7],
    &[0, 1, 5, 4],
    &[1, 2, 6, 5],
    &[2, 3, 7, 6],
    &[3, 0, 4, 7],
];
const TET_SIDES: [&[u8]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];
const WEDGE_SIDES: [&[u8]; 5] = [
    &[0, 2, 1],
    &[3, 4, 5],
    &[0, 1, 4, 3],
    &[1, 2, 5, 4],
    &[2, 0, 3, 5],
];

/// Local nodes at each corner: the corner itself and its three neighbours along edges, right-handed.
const HEX_CORNERS: [[u8; 4]; 8] = [
    [0, 1, 3, 4],
    [1, 2, 0, 5],
    [2, 3, 1, 6],
    [3, 0, 2, 7],
    [4, 7, 5, 0],
    [5, 4, 6, 1],
    [6, 5, 7, 2],
    [7, 6, 4, 3],
];
const TET_CORNERS: [[u8; 4]; 4] = [[0, 1, 2, 3], [1, 2, 0, 3], [2, 0, 1, 3], [3, 0, 2, 1]];
const WEDGE_CORNERS: [[u8; 4]; 6] = [
    [0, 1, 2, 3],
    [1, 2, 0, 4],
    [2, 0, 1, 5],
    [3, 5, 4, 0],
    [4, 3, 5, 1],
    [5, 4, 3, 2],
];

impl ElementKind {
    /// Number of nodes of an element of this kind.
    pub fn node_count(self) -> usize {
        match self {
            Self::Hex8 => 8,
            Self::Tet4 => 4,
            Self::Wedge6 => 6,
            Self::Bar2 => 2,
        }
    }
    /// Name of the kind in messages and scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hex8 => "hex8",
            Self::Tet4 => "tet4",
            Self::Wedge6 => "wedge6",
            Self::Bar2 => "bar2",
        }
    }
    /// Whether the kind is a solid (three-dimensional) element.
    pub fn is_solid(self) -> bool {
        !matches!(self, Self::Bar2)
    }
    /// Local nodes of each side, counter-clockwise seen from outside; none for bars.
    pub fn sides(self) -> &'static [&'static [u8]] {
        match self {
            Self::Hex8 => &HEX_SIDES,
            Self::Tet4 => &TET_SIDES,
            Self::Wedge6 => &WEDGE_SIDES,
            Self::Bar2 => &[],
        }
    }
    /// Local nodes at each corner: the corner and its three neighbours, whose edges form a right-handed
    /// triad in a valid element; empty for bars.
    pub fn corners(self) -> &'static [[u8; 4]] {
        match self {
            Self::Hex8 => &HEX_CORNERS,
            Self::Tet4 => &TET_CORNERS,
            Self::Wedge6 => &WEDGE_CORNERS,
            Self::Bar2 => &[],
        }
    }
}
