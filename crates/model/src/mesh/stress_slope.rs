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

    /// In one element of any kind, stretched and bent, the forces of a slope are those of the tractions on its sides
    /// less those of its weight: they sum to minus the volume times what the slope has across z, and do the work of
    /// the stress on every linear displacement, the slope times the moment of the volume, by sums over small boxes.
    #[test]
    fn forces_do_the_work_of_the_stress() {
        let slope = Stress([1.0, -0.7, 0.4, 0.3, -0.2, 0.9]);
        for kind in [
            ElementKind::Hex8,
            ElementKind::Wedge6,
            ElementKind::Pyramid5,
            ElementKind::Tet10,
            ElementKind::Tet4,
        ] {
            let mut builder = Mesh::builder();
            let corners: Vec<Vec3> = (kind.natural_corners().iter())
                .map(|&[r, s, t]| Vec3::new(r + 0.2 * t, s - 0.1 * r + 0.3 * t, 1.3 * t + 0.4 * s))
                .collect();
            let tags: Vec<u64> = (1..=corners.len() as u64).collect();
            for (tag, corner) in tags.iter().zip(&corners) {
                builder.node(*tag, *corner);
            }
            builder.element(1, kind, &tags, &["rock"]);
            let mesh = builder.build().unwrap();
            let mut forces = vec![Vec3::zeros(); corners.len()];
            mesh.add_forces_of_slope(0, &slope, &mut forces);
            let sum: Vec3 = forces.iter().sum();
            assert!(sum.norm() < 1e-13, "{kind:?}: {sum}");
            // A linear displacement has the same gradient everywhere: only the first moment of height counts.
            let mean = mean_height(kind, &corners) - mesh.centroid(0).z;
            let gradient = Mat3::new(0.3, 0.5, -0.2, 0.1, 0.7, 0.4, -0.6, 0.2, 0.9);
            let work: f64 = (forces.iter().zip(&corners))
                .map(|(force, corner)| force.dot(&(gradient * corner)))
                .sum();
            let [xx, yy, zz, xy, yz, zx] = slope.0;
            let stress = Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
            let expected = stress.dot(&gradient) * mean * mesh.volume(0);
            assert!(
                (work - expected).abs() < 1e-4,
                "{kind:?}: {work} {expected}"
            );
        }
    }

    /// Mean height of an affine image of the reference element, by small boxes.
    fn mean_height(kind: ElementKind, corners: &[Vec3]) -> f64 {
        const CELLS: usize = 64;
        let mut values = vec![0.0; corners.len()];
        let (mut sum, mut volume) = (0.0, 0.0);
        let middle = |i: usize| (2.0 * i as f64 + 1.0) / CELLS as f64 - 1.0;
        for i in 0..CELLS * CELLS * CELLS {
            let [r, s, t] = [i % CELLS, i / CELLS % CELLS, i / CELLS / CELLS].map(middle);
            let (inside, weight) = match kind {
                ElementKind::Hex8 => (true, 1.0),
                ElementKind::Wedge6 => (r >= 0.0 && s >= 0.0 && r + s <= 1.0, 1.0),
                // The cross section shrinks with height.
                ElementKind::Pyramid5 => (true, (1.0 - t) * (1.0 - t)),
                _ => (r >= 0.0 && s >= 0.0 && t >= 0.0 && r + s + t <= 1.0, 1.0),
            };
            if inside {
                kind.shape_functions(&Vec3::new(r, s, t), &mut values);
                let height: f64 = values.iter().zip(corners).map(|(v, c)| v * c.z).sum();
                sum += weight * height;
                volume += weight;
            }
        }
        sum / volume
    }
}
