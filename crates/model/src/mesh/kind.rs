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
    /// Five-node pyramid: base 0 1 2 3 counter-clockwise seen from the apex 4.
    Pyramid5,
    /// Ten-node tetrahedron with straight edges: corners 0 to 3, and the midpoints of the edges 01, 12, 02, 03, 23, 13.
    Tet10,
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
const PYRAMID_SIDES: [&[u8]; 5] = [
    &[0, 3, 2, 1],
    &[0, 1, 4],
    &[1, 2, 4],
    &[2, 3, 4],
    &[3, 0, 4],
];
/// Corners and midpoints in turn around each side.
const TET10_SIDES: [&[u8]; 4] = [
    &[0, 6, 2, 5, 1, 4],
    &[0, 4, 1, 9, 3, 7],
    &[1, 5, 2, 8, 3, 9],
    &[2, 6, 0, 7, 3, 8],
];
/// Ends of the edges of a tetrahedron, in the order of their midpoints.
pub(super) const TET_EDGES: [[u8; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

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
/// Of the apex each of the four triples of neighbours.
const PYRAMID_CORNERS: [[u8; 4]; 8] = [
    [0, 1, 3, 4],
    [1, 2, 0, 4],
    [2, 3, 1, 4],
    [3, 0, 2, 4],
    [4, 0, 3, 1],
    [4, 1, 0, 2],
    [4, 2, 1, 3],
    [4, 3, 2, 0],
];

impl ElementKind {
    /// All kinds, each at its place for ever: files number them by it.
    pub const ALL: [Self; 6] = [
        Self::Hex8,
        Self::Tet4,
        Self::Wedge6,
        Self::Bar2,
        Self::Pyramid5,
        Self::Tet10,
    ];

    /// Number of nodes of an element of this kind.
    pub fn node_count(self) -> usize {
        match self {
            Self::Hex8 => 8,
            Self::Tet4 => 4,
            Self::Wedge6 => 6,
            Self::Bar2 => 2,
            Self::Pyramid5 => 5,
            Self::Tet10 => 10,
        }
    }
    /// Name of the kind in messages and scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hex8 => "hex8",
            Self::Tet4 => "tet4",
            Self::Wedge6 => "wedge6",
            Self::Bar2 => "bar2",
            Self::Pyramid5 => "pyramid5",
            Self::Tet10 => "tet10",
        }
    }
    /// Whether the kind is a solid (three-dimensional) element.
    pub fn is_solid(self) -> bool {
        !matches!(self, Self::Bar2)
    }
    /// Local nodes of each side, counter-clockwise seen from outside; none for bars. On a side with midpoints, corners and
    /// midpoints are in turn.
    pub fn sides(self) -> &'static [&'static [u8]] {
        match self {
            Self::Hex8 => &HEX_SIDES,
            Self::Tet4 => &TET_SIDES,
            Self::Wedge6 => &WEDGE_SIDES,
            Self::Pyramid5 => &PYRAMID_SIDES,
            Self::Tet10 => &TET10_SIDES,
            Self::Bar2 => &[],
        }
    }
    /// Local nodes at each corner: the corner and its three neighbours, whose edges form a right-handed
    /// triad in a valid element; empty for bars.
    pub fn corners(self) -> &'static [[u8; 4]] {
        match self {
            Self::Hex8 => &HEX_CORNERS,
            Self::Tet4 | Self::Tet10 => &TET_CORNERS,
            Self::Wedge6 => &WEDGE_CORNERS,
            Self::Pyramid5 => &PYRAMID_CORNERS,
            Self::Bar2 => &[],
        }
    }
    /// The kind with the same shape and nodes at the corners alone.
    pub fn first_order(self) -> Self {
        match self {
            Self::Tet10 => Self::Tet4,
            kind => kind,
        }
    }
    /// Local nodes at the ends of each edge that has a midpoint, whose local node is the number of corners plus the index of
    /// the edge; empty for kinds without midpoints.
    pub fn edges_with_midpoint(self) -> &'static [[u8; 2]] {
        match self {
            Self::Tet10 => &TET_EDGES,
            _ => &[],
        }
    }
}
