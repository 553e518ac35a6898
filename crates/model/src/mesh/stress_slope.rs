//! Nodal forces of a stress that varies with height within an element.

use super::{ElementKind, Mesh};
use crate::{Mat3, Stress, Vec3};

/// Weight and natural coordinates of an integration point.
type Point = (f64, Vec3);

/// Coordinate of the 2 Gauss points of a line.
const GAUSS: f64 = 0.577_350_269_189_625_8;

impl Mesh {
    /// Adds the internal forces (N) of a stress that is zero at the [centroid](Self::centroid) of an element (mesh index)
    /// and grows with height `z` by `slope` (Pa/m), one per node of the element,
    ///
    /// `f_a = integral of (slope (z - z_c)) grad N_a dV`
    ///
    /// with the [shape functions](ElementKind::shape_functions), whose integrals are the lumped masses. With those of
    /// the stress at the centroid they balance the weight of a body under its geostatic stress, to rounding, whatever the
    /// mesh.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn add_forces_of_slope(&self, element: u32, slope: &Stress, forces: &mut [Vec3]) {
        let kind = self.kind(element);
        let nodes = self.nodes_of(element).iter();
        let corners: Vec<Vec3> = nodes.map(|&n| self.positions[n as usize]).collect();
        let centre = self.centroid(element).z;
        let [xx, yy, zz, xy, yz, zx] = slope.0;
        let slope = Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
        let mut values = vec![0.0; corners.len()];
        let mut gradients = vec![Vec3::zeros(); corners.len()];
        for (weight, natural) in points(kind) {
            kind.shape_functions(&natural, &mut values);
            kind.shape_gradients(&natural, &mut gradients);
            let height: f64 = (values.iter().zip(&corners))
                .map(|(value, corner)| value * (corner.z - centre))
                .sum();
            let jacobian: Mat3 = (gradients.iter().zip(&corners))
                .map(|(gradient, corner)| gradient * corner.transpose())
                .sum();
            // The determinant times the inverse, which a flat element does not have.
            let [r, s, t] = [0, 1, 2].map(|i| jacobian.row(i).transpose());
            let cofactors = Mat3::from_columns(&[s.cross(&t), t.cross(&r), r.cross(&s)]);
            for (force, gradient) in forces.iter_mut().zip(&gradients) {
                *force += slope * (cofactors * gradient) * (weight * height);
            }
        }
    }
}

/// Integration points of a kind, exact for the product of a gradient with a linear function; none where that has no
/// integral.
fn points(kind: ElementKind) -> Vec<Point> {
    let line = [-GAUSS, GAUSS];
    match kind {
        ElementKind::Hex8 | ElementKind::Pyramid5 => (0..8)
            .map(|i| {
                (
                    1.0,
                    Vec3::new(line[i & 1], line[(i >> 1) & 1], line[i >> 2]),
                )
            })
            .collect(),
        ElementKind::Wedge6 => {
            let (near, far) = (1.0 / 6.0, 2.0 / 3.0);
            let triangle = [[near, near], [far, near], [near, far]];
            let of_layer = |t: f64| triangle.map(|[r, s]| (1.0 / 6.0, Vec3::new(r, s, t)));
            line.into_iter().flat_map(of_layer).collect()
        }
        ElementKind::Tet10 => {
            // Centroids of its twelve tetrahedra: at each corner, and on both sides of the face that cuts it off.
            let parts = [
                (1.0 / 8.0, 0.625),
                (1.0 / 16.0, 0.4375),
                (1.0 / 16.0, 0.0625),
            ];
            let of_part = |(share, own): (f64, f64)| {
                (0..4).map(move |corner| {
                    let mut coordinates = [(1.0 - own) / 3.0; 4];
                    coordinates[corner] = own;
                    let [_, r, s, t] = coordinates;
                    (share / 6.0, Vec3::new(r, s, t))
                })
            };
            parts.into_iter().flat_map(of_part).collect()
        }
        ElementKind::Tet4 | ElementKind::Bar2 => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In one element of any kind, stretched and sheared, the forces of a slope are in equilibrium, and do on a linear
    /// displacement the work of the mean stress: the slope times the height of the centroid of the volume above that of
    /// the nodes, which differ in pyramids alone.
    #[test]
    fn forces_do_the_work_of_the_stress() {
        let slope = Stress([1.0, -0.7, 0.4, 0.3, -0.2, 0.9]);
        let [xx, yy, zz, xy, yz, zx] = slope.0;
        let stress = Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
        let gradient = Mat3::new(0.3, 0.5, -0.2, 0.1, 0.7, 0.4, -0.6, 0.2, 0.9);
        for (kind, middle) in [
            (ElementKind::Hex8, [0.0, 0.0, 0.0]),
            (ElementKind::Wedge6, [1.0 / 3.0, 1.0 / 3.0, 0.0]),
            (ElementKind::Pyramid5, [0.0, 0.0, -0.5]),
            (ElementKind::Tet4, [0.25; 3]),
            (ElementKind::Tet10, [0.25; 3]),
        ] {
            let place = |[r, s, t]: [f64; 3]| {
                Vec3::new(r + 0.2 * t, s - 0.1 * r + 0.3 * t, 1.3 * t + 0.4 * s)
            };
            let corners: Vec<Vec3> = kind.natural_corners().iter().copied().map(place).collect();
            let tags: Vec<u64> = (1..=corners.len() as u64).collect();
            let mut builder = Mesh::builder();
            for (tag, corner) in tags.iter().zip(&corners) {
                builder.node(*tag, *corner);
            }
            builder.element(1, kind, &tags, &["rock"]);
            let mesh = builder.build().unwrap();
            let mut forces = vec![Vec3::zeros(); corners.len()];
            mesh.add_forces_of_slope(0, &slope, &mut forces);
            let sum: Vec3 = forces.iter().sum();
            assert!(sum.norm() < 1e-13, "{kind:?}: {sum}");
            let work: f64 = (forces.iter().zip(&corners))
                .map(|(force, corner)| force.dot(&(gradient * corner)))
                .sum();
            let above = place(middle).z - mesh.centroid(0).z;
            let expected = stress.dot(&gradient) * above * mesh.volume(0);
            assert_eq!(
                above.abs() > 1e-3,
                kind == ElementKind::Pyramid5,
                "{kind:?}"
            );
            assert!(
                (work - expected).abs() < 1e-12,
                "{kind:?}: {work} {expected}"
            );
        }
    }
}
