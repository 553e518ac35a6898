//! Isoparametric shape functions.

use super::ElementKind;
use super::kind::TET_EDGES;
use crate::Vec3;

/// Natural coordinates of the corners of the hexahedron.
const HEX_SIGNS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];
const TET_CORNERS: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
];
const WEDGE_CORNERS: [[f64; 3]; 6] = [
    [0.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
];
const PYRAMID_CORNERS: [[f64; 3]; 5] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [0.0, 0.0, 1.0],
];
const TET10_NODES: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
];
/// Signs of the corner coordinates in the coordinates along the diagonals of the octahedron between the midpoints of a
/// tetrahedron, and the local nodes at their positive and negative ends.
const DIAGONALS: [([f64; 4], [usize; 2]); 3] = [
    ([1.0, 1.0, -1.0, -1.0], [4, 8]),
    ([1.0, -1.0, 1.0, -1.0], [6, 9]),
    ([1.0, -1.0, -1.0, 1.0], [7, 5]),
];
const BAR_ENDS: [[f64; 3]; 2] = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];

impl ElementKind {
    /// Natural coordinates of the nodes of the element kind, in the order of the nodes.
    pub fn natural_corners(self) -> &'static [[f64; 3]] {
        match self {
            Self::Hex8 => &HEX_SIGNS,
            Self::Tet4 => &TET_CORNERS,
            Self::Wedge6 => &WEDGE_CORNERS,
            Self::Bar2 => &BAR_ENDS,
            Self::Pyramid5 => &PYRAMID_CORNERS,
            Self::Tet10 => &TET10_NODES,
        }
    }

    /// Values of the shape functions at natural coordinates, one per node.
    ///
    /// Hexahedra: `N_a = (1 + r_a r)(1 + s_a s)(1 + t_a t) / 8` on `[-1, 1]^3`. Tetrahedra:
    /// `1 - r - s - t, r, s, t`. Wedges: `(1 - r - s, r, s)` times `(1 -+ t) / 2`, triangle
    /// coordinates `r, s` and `t` in `[-1, 1]`. Bars: `(1 -+ r) / 2`, `r` in `[-1, 1]`. Pyramids: hexahedra whose top is one
    /// node. Tetrahedra with midpoints: linear in each of twelve tetrahedra, four at the corners and eight around the
    /// centroid, whose value is the mean of those at the midpoints.
    ///
    /// # Panics
    /// If `values` is shorter than [`node_count`](Self::node_count).
    pub fn shape_functions(self, natural: &Vec3, values: &mut [f64]) {
        let (r, s, t) = (natural.x, natural.y, natural.z);
        match self {
            Self::Hex8 => {
                for (value, [ra, sa, ta]) in values[..8].iter_mut().zip(HEX_SIGNS) {
                    *value = 0.125 * (1.0 + ra * r) * (1.0 + sa * s) * (1.0 + ta * t);
                }
            }
            Self::Tet4 => values[..4].copy_from_slice(&[1.0 - r - s - t, r, s, t]),
            Self::Wedge6 => {
                for (a, triangle) in [1.0 - r - s, r, s].into_iter().enumerate() {
                    values[a] = 0.5 * (1.0 - t) * triangle;
                    values[a + 3] = 0.5 * (1.0 + t) * triangle;
                }
            }
            Self::Bar2 => values[..2].copy_from_slice(&[0.5 * (1.0 - r), 0.5 * (1.0 + r)]),
            Self::Pyramid5 => {
                for (value, [ra, sa, _]) in values[..4].iter_mut().zip(PYRAMID_CORNERS) {
                    *value = 0.125 * (1.0 + ra * r) * (1.0 + sa * s) * (1.0 - t);
                }
                values[4] = 0.5 * (1.0 + t);
            }
            Self::Tet10 => {
                let corners = [1.0 - r - s - t, r, s, t];
                let values = &mut values[..10];
                values.fill(0.0);
                if let Some(a) = corners.iter().position(|&corner| corner > 0.5) {
                    values[a] = 2.0 * corners[a] - 1.0;
                    for (i, ends) in TET_EDGES.iter().enumerate() {
                        if let Some(b) = other_end(ends, a) {
                            values[4 + i] = 2.0 * corners[b];
                        }
                    }
                    return;
                }
                // On each diagonal the nearer end has the coordinate; what is left, the centroid, the mean of all.
                let mut left = 1.0;
                for (signs, ends) in DIAGONALS {
                    let along: f64 = signs.iter().zip(corners).map(|(sign, c)| sign * c).sum();
                    values[ends[usize::from(along < 0.0)]] = along.abs();
                    left -= along.abs();
                }
                for value in &mut values[4..] {
                    *value += left / 6.0;
                }
            }
        }
    }

    /// Derivatives of the [shape functions](Self::shape_functions) by the natural coordinates.
    ///
    /// # Panics
    /// If `gradients` is shorter than [`node_count`](Self::node_count).
    pub fn shape_gradients(self, natural: &Vec3, gradients: &mut [Vec3]) {
        let (r, s, t) = (natural.x, natural.y, natural.z);
        match self {
            Self::Hex8 => {
                for (gradient, [ra, sa, ta]) in gradients[..8].iter_mut().zip(HEX_SIGNS) {
                    let (fr, fs, ft) = (1.0 + ra * r, 1.0 + sa * s, 1.0 + ta * t);
                    *gradient = Vec3::new(ra * fs * ft, fr * sa * ft, fr * fs * ta) * 0.125;
                }
            }
            Self::Tet4 => {
                gradients[..4].copy_from_slice(&[
                    Vec3::repeat(-1.0),
                    Vec3::x(),
                    Vec3::y(),
                    Vec3::z(),
                ]);
            }
            Self::Wedge6 => {
                let triangle = [(1.0 - r - s, -1.0, -1.0), (r, 1.0, 0.0), (s, 0.0, 1.0)];
                for (a, (value, by_r, by_s)) in triangle.into_iter().enumerate() {
                    let (low, high) = (0.5 * (1.0 - t), 0.5 * (1.0 + t));
                    gradients[a] = Vec3::new(by_r * low, by_s * low, -0.5 * value);
                    gradients[a + 3] = Vec3::new(by_r * high, by_s * high, 0.5 * value);
                }
            }
            Self::Bar2 => {
                gradients[..2].copy_from_slice(&[-0.5 * Vec3::x(), 0.5 * Vec3::x()]);
            }
            Self::Pyramid5 => {
                for (gradient, [ra, sa, _]) in gradients[..4].iter_mut().zip(PYRAMID_CORNERS) {
                    let (fr, fs, ft) = (1.0 + ra * r, 1.0 + sa * s, 1.0 - t);
                    *gradient = Vec3::new(ra * fs * ft, fr * sa * ft, -fr * fs) * 0.125;
                }
                gradients[4] = 0.5 * Vec3::z();
            }
            Self::Tet10 => {
                let corners = [1.0 - r - s - t, r, s, t];
                let of_corner = [Vec3::repeat(-1.0), Vec3::x(), Vec3::y(), Vec3::z()];
                let gradients = &mut gradients[..10];
                gradients.fill(Vec3::zeros());
                if let Some(a) = corners.iter().position(|&corner| corner > 0.5) {
                    gradients[a] = 2.0 * of_corner[a];
                    for (i, ends) in TET_EDGES.iter().enumerate() {
                        if let Some(b) = other_end(ends, a) {
                            gradients[4 + i] = 2.0 * of_corner[b];
                        }
                    }
                    return;
                }
                let mut left = Vec3::zeros();
                for (signs, ends) in DIAGONALS {
                    let terms = signs.iter().zip(corners);
                    let along: f64 = terms.map(|(sign, corner)| sign * corner).sum();
                    let terms = signs.iter().zip(of_corner);
                    let slope: Vec3 = terms.map(|(sign, slope)| slope * *sign).sum();
                    let slope = if along < 0.0 { -slope } else { slope };
                    gradients[ends[usize::from(along < 0.0)]] = slope;
                    left -= slope;
                }
                for gradient in &mut gradients[4..] {
                    *gradient += left / 6.0;
                }
            }
        }
    }

    /// Natural coordinates of the centroid of the element kind.
    pub fn natural_centre(self) -> Vec3 {
        match self {
            Self::Hex8 | Self::Bar2 => Vec3::zeros(),
            Self::Tet4 | Self::Tet10 => Vec3::repeat(0.25),
            Self::Pyramid5 => Vec3::new(0.0, 0.0, -0.5),
            Self::Wedge6 => Vec3::new(1.0 / 3.0, 1.0 / 3.0, 0.0),
        }
    }

    /// Natural coordinates clamped to the range of the element.
    pub(super) fn into_range(self, natural: Vec3) -> Vec3 {
        let clamp = |value: f64| value.clamp(-1.0, 1.0);
        match self {
            Self::Hex8 | Self::Pyramid5 => natural.map(clamp),
            Self::Bar2 => Vec3::new(clamp(natural.x), 0.0, 0.0),
            Self::Tet4 | Self::Tet10 => {
                let positive = natural.map(|value| value.max(0.0));
                positive / positive.sum().max(1.0)
            }
            Self::Wedge6 => {
                let (r, s) = (natural.x.max(0.0), natural.y.max(0.0));
                let sum = (r + s).max(1.0);
                Vec3::new(r / sum, s / sum, clamp(natural.z))
            }
        }
    }
}

/// The other end of an edge of a tetrahedron that has a corner as one end.
fn other_end(ends: &[u8; 2], corner: usize) -> Option<usize> {
    let ends = ends.map(usize::from);
    match ends {
        [a, b] if a == corner => Some(b),
        [a, b] if b == corner => Some(a),
        _ => None,
    }
}
