//! Widths of elements.

use nalgebra::SymmetricEigen;

use crate::{ElementKind, Lane, Mat3, Vec3};

/// Widths of an element in all directions (m), from the second moments of its volume.
///
/// ```text
/// H^2 = (12 / V) integral of (x - c)(x - c)^T dV,   h(n) = sqrt(n . H^2 n)
/// ```
/// with the volume `V` and its centroid `c`. The widths of a box along its axes are its edges, in any
/// orientation; a cube has the same width in all directions, and a regular tetrahedron of edge `a` has
/// `0.55 a`. A crack band in the element is as wide as the element along the normal of the crack.
///
/// The numbers are the components of the symmetric tensor `H^2` (m2), components xx yy zz xy yz zx, shears
/// not doubled.
///
/// Sources: J. Oliver, A consistent characteristic length for smeared cracking models, Int. J. Numer.
/// Meth. Engng 28 (1989) 461-474; S. Govindjee, G. J. Kay, J. C. Simo, Anisotropic modelling and
/// numerical simulation of brittle damage in concrete, Int. J. Numer. Meth. Engng 38 (1995) 3611-3633.
///
/// ```
/// use powerhouse_model::{ElementKind, Extents, Vec3};
/// let corners = ElementKind::Hex8.natural_corners();
/// let corners: Vec<Vec3> = corners.iter().map(|&[x, y, z]| Vec3::new(x, 2.0 * y, 0.5 * z)).collect();
/// let extents = Extents::of_element(ElementKind::Hex8, &corners);
/// assert!((extents.along(&[0.0, 1.0, 0.0]) - 4.0).abs() < 1e-12);
/// assert!((extents.principal()[2] - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extents<L>(pub [L; 6]);

impl<L: Lane> Extents<L> {
    /// Widths of an element that is equally wide in all directions (m).
    #[inline(always)]
    pub fn uniform(size: L) -> Self {
        let (square, zero) = (size * size, size.constant(0.0));
        Self([square, square, square, zero, zero, zero])
    }
    /// Width along a unit vector (m).
    #[inline(always)]
    pub fn along(&self, &[x, y, z]: &[L; 3]) -> L {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        let a = xx.mul_add(x, xy.mul_add(y, zx * z));
        let b = xy.mul_add(x, yy.mul_add(y, yz * z));
        let c = zx.mul_add(x, yz.mul_add(y, zz * z));
        let square = a.mul_add(x, b.mul_add(y, c * z));
        square.sqrt()
    }
}

/// Points and weights of Gauss on [-1, 1], exact to the fifth degree.
const LINE: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// Points and weights of a quadrature on the reference element of a kind.
fn rule(kind: ElementKind) -> Vec<(Vec3, f64)> {
    let cube = LINE.iter().flat_map(|&(x, a)| {
        LINE.iter()
            .flat_map(move |&(y, b)| LINE.map(|(z, c)| (Vec3::new(x, y, z), a * b * c)))
    });
    match kind {
        ElementKind::Hex8 | ElementKind::Pyramid5 => cube.collect(),
        // A square or cube of which a side or face is collapsed: the map of Duffy (1982).
        ElementKind::Wedge6 => cube
            .map(|(p, weight)| {
                let (r, s) = (0.5 * (1.0 + p.x), 0.5 * (1.0 + p.y));
                (Vec3::new(r, s * (1.0 - r), p.z), 0.25 * weight * (1.0 - r))
            })
            .collect(),
        ElementKind::Tet4 | ElementKind::Tet10 => cube
            .map(|(p, weight)| {
                let [r, s, t] = [p.x, p.y, p.z].map(|x| 0.5 * (1.0 + x));
                let (across, deep) = (1.0 - r, (1.0 - r) * (1.0 - s));
                (
                    Vec3::new(r, s * across, t * deep),
                    0.125 * weight * across * deep,
                )
            })
            .collect(),
        ElementKind::Bar2 => LINE.map(|(x, a)| (Vec3::new(x, 0.0, 0.0), a)).to_vec(),
    }
}

impl Extents<f64> {
    /// Widths of an element from its corners (m), in the order of its kind.
    ///
    /// Integrated by three points along each axis of the reference element, exact but for warped wedges,
    /// where the error is below a thousandth. A bar has its length along its axis and zero width across it.
    ///
    /// # Panics
    /// If there are fewer corners than the kind has.
    pub fn of_element(kind: ElementKind, corners: &[Vec3]) -> Self {
        let kind = kind.first_order();
        let count = kind.node_count();
        let mut values = vec![0.0; count];
        let mut gradients = vec![Vec3::zeros(); count];
        let origin = corners[0];
        let (mut volume, mut first, mut second) = (0.0, Vec3::zeros(), Mat3::zeros());
        for (point, weight) in rule(kind) {
            kind.shape_functions(&point, &mut values);
            kind.shape_gradients(&point, &mut gradients);
            let (mut position, mut slope) = (Vec3::zeros(), Mat3::zeros());
            for a in 0..count {
                let corner = corners[a] - origin;
                position += corner * values[a];
                slope += corner * gradients[a].transpose();
            }
            let part = match kind {
                ElementKind::Bar2 => slope.column(0).norm(),
                _ => slope.determinant(),
            };
            let part = part * weight;
            volume += part;
            first += position * part;
            second += position * position.transpose() * part;
        }
        let centre = first / volume;
        let square = (second / volume - centre * centre.transpose()) * 12.0;
        Self([
            square[(0, 0)],
            square[(1, 1)],
            square[(2, 2)],
            square[(0, 1)],
            square[(1, 2)],
            square[(2, 0)],
        ])
    }
    /// Principal widths (m): the greatest, the intermediate and the least width of all directions.
    pub fn principal(&self) -> [f64; 3] {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        let square = Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
        let mut widths = [0.0; 3];
        for (width, square) in widths
            .iter_mut()
            .zip(&SymmetricEigen::new(square).eigenvalues)
        {
            *width = square.max(0.0).sqrt();
        }
        widths.sort_by(|a, b| b.total_cmp(a));
        widths
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    fn corners(kind: ElementKind, map: impl Fn(Vec3) -> Vec3) -> Vec<Vec3> {
        let corners = kind.natural_corners().iter();
        corners.map(|&corner| map(Vec3::from(corner))).collect()
    }

    /// A box of any aspect, turned anyhow and far from the origin, is as wide along each of its axes
    /// as its edges are long, and along a slanting direction as the root of the sum of squares says.
    #[test]
    fn boxes_are_as_wide_as_their_edges() {
        for (edges, turn) in [
            ([1.0, 1.0, 1.0], [0.0, 0.0, 0.0]),
            ([10.0, 1.0, 1.0], [0.3, -1.1, 0.4]),
            ([0.4, 1.5, 4.0], [2.0, 0.7, -0.2]),
        ] {
            let turn = Rotation3::from_euler_angles(turn[0], turn[1], turn[2]);
            let half = Vec3::from(edges) * 0.5;
            let map =
                |natural: Vec3| turn * natural.component_mul(&half) + Vec3::new(3e2, -5e2, 2e2);
            let extents = Extents::of_element(ElementKind::Hex8, &corners(ElementKind::Hex8, map));
            for (axis, edge) in edges.iter().enumerate() {
                let normal = turn * Vec3::ith(axis, 1.0);
                let width = extents.along(&normal.into());
                assert!((width / edge - 1.0).abs() < 1e-11, "{width} of {edge}");
            }
            let slanting = Vec3::new(1.0, 2.0, -2.0) / 3.0;
            let expected = slanting.component_mul(&Vec3::from(edges)).norm();
            let width = extents.along(&(turn * slanting).into());
            assert!((width / expected - 1.0).abs() < 1e-11);
            let mut sorted = edges;
            sorted.sort_by(|a, b| b.total_cmp(a));
            for (width, edge) in extents.principal().iter().zip(sorted) {
                assert!((width / edge - 1.0).abs() < 1e-11);
            }
        }
    }

    /// Wedges and tetrahedra have the second moments of their closed forms: `V sum (x_a - c)(x_a -
    /// c)^T / 20` of a tetrahedron, `A L^2 / 36`-like ones of a prism; both of two halves of a box are
    /// those of the box.
    #[test]
    fn wedges_and_tetrahedra_have_the_moments_of_their_closed_forms() {
        let skew = Mat3::new(1.0, 0.3, -0.2, 0.1, 2.0, 0.4, 0.0, -0.5, 0.7);
        let map = |natural: Vec3| skew * natural + Vec3::new(4.0, 5.0, 6.0);
        let tetrahedron = corners(ElementKind::Tet4, map);
        let centre = tetrahedron.iter().sum::<Vec3>() / 4.0;
        let mut closed = Mat3::zeros();
        for corner in &tetrahedron {
            closed += (corner - centre) * (corner - centre).transpose() * (12.0 / 20.0);
        }
        let found = Extents::of_element(ElementKind::Tet4, &tetrahedron);
        for normal in [Vec3::x(), Vec3::y(), Vec3::new(0.6, 0.0, -0.8)] {
            let expected = normal.dot(&(closed * normal)).sqrt();
            assert!((found.along(&normal.into()) / expected - 1.0).abs() < 1e-12);
        }
        // A prism: 12 times the moments 1/18, 1/18 and -1/36 of the unit triangle, and the height.
        let mut prism = Mat3::new(
            12.0 / 18.0,
            -12.0 / 36.0,
            0.0,
            -12.0 / 36.0,
            12.0 / 18.0,
            0.0,
            0.0,
            0.0,
            4.0,
        );
        prism = skew * prism * skew.transpose();
        let found = Extents::of_element(ElementKind::Wedge6, &corners(ElementKind::Wedge6, map));
        for normal in [Vec3::x(), Vec3::z(), Vec3::new(0.6, 0.0, -0.8)] {
            let expected = normal.dot(&(prism * normal)).sqrt();
            assert!((found.along(&normal.into()) / expected - 1.0).abs() < 1e-12);
        }
    }
}
