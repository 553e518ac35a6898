//! Mesh generator: one eighth of a spherical shell.

use powerhouse::model::{Axis, ElementKind, Mesh, MeshError, ParameterError, Vec3};

use crate::StudyError;

/// Mesh generator of one eighth of a spherical shell around the origin, between the planes x = 0, y = 0 and z = 0.
///
/// Three patches of `around` by `around` elements, one around each axis, meet on the diagonal; along the radius the
/// lengths of the elements grow geometrically. All elements are in the set `rock`;
/// facet sets are the cuts `left` (x = 0), `front` (y = 0) and `bottom` (z = 0), and `wall` and
/// `outside`. Roller supports along the normals of the
/// cuts make them symmetry planes of the whole shell.
///
/// ```
/// use powerhouse_study::ShellOctant;
/// let mesh = ShellOctant { inner: 10.0, outer: 20.0, around: 4, rings: 5 }.mesh()?;
/// assert_eq!(mesh.element_count(), 3 * 4 * 4 * 5);
/// assert!(mesh.check()?.least_scaled_jacobian > 0.8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShellOctant {
    /// Inner radius, of the wall of the cavity (m).
    pub inner: f64,
    /// Outer radius (m), at least 1.01 of the inner one.
    pub outer: f64,
    /// Number of elements along each side of a patch; each edge of the octant has two patches.
    pub around: usize,
    /// Number of elements along the radius.
    pub rings: usize,
}

/// Greatest number of elements along an edge.
const MOST: f64 = 1.0e4;

impl ShellOctant {
    /// Generates the mesh.
    ///
    /// # Errors
    /// A radius or a number of elements out of its range, or a mesh with too many nodes.
    pub fn mesh(&self) -> Result<Mesh, StudyError> {
        for (name, value, least, most) in [
            ("inner", self.inner, 1.0e-3, 1.0e6),
            ("outer", self.outer, 1.01 * self.inner, 1.0e6 * self.inner),
            ("around", self.around as f64, 1.0, MOST),
            ("rings", self.rings as f64, 1.0, MOST),
        ] {
            ParameterError::check(name, value, least, most).map_err(powerhouse::Error::from)?;
        }
        Ok(self.built().map_err(powerhouse::Error::from)?)
    }

    /// The number of a node on the ray through a grid point on the faces of a cube.
    fn node(&self, point: [usize; 3], ring: usize) -> u64 {
        let along = self.around + 1;
        let index = point.iter().fold(0, |index, i| index * along + i);
        1 + (index * (self.rings + 1) + ring) as u64
    }

    fn built(&self) -> Result<Mesh, MeshError> {
        let n = self.around;
        let growth = self.outer / self.inner;
        let mut builder = Mesh::builder();
        let on_faces = |point: &[usize; 3]| point.contains(&n);
        let points =
            (0..(n + 1).pow(3)).map(|i| [i / (n + 1).pow(2), i / (n + 1) % (n + 1), i % (n + 1)]);
        for point in points.filter(on_faces) {
            // Equal angles from the axes; exactly zero on the cuts.
            let along = point.map(|i| match i {
                _ if i == n => 1.0,
                _ => (core::f64::consts::FRAC_PI_4 * i as f64 / n as f64).tan(),
            });
            let direction = Vec3::from(along).normalize();
            for ring in 0..=self.rings {
                let radius = self.inner * growth.powf(ring as f64 / self.rings as f64);
                builder.node(self.node(point, ring), radius * direction);
            }
        }
        let mut tag = 0;
        for axis in 0..3 {
            for i in 0..n {
                for j in 0..n {
                    // The two axes after this one, so that the corners turn counter-clockwise seen from outside.
                    let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|[i, j]| {
                        let mut point = [n; 3];
                        (point[(axis + 1) % 3], point[(axis + 2) % 3]) = (i, j);
                        point
                    });
                    for ring in 0..self.rings {
                        tag += 1;
                        let quad = |ring| corners.map(|point| self.node(point, ring));
                        let nodes = [quad(ring), quad(ring + 1)].concat();
                        builder.element(tag, ElementKind::Hex8, &nodes, &["rock"]);
                    }
                    builder.facet("wall", &corners.map(|point| self.node(point, 0)));
                    builder.facet(
                        "outside",
                        &corners.map(|point| self.node(point, self.rings)),
                    );
                }
            }
        }
        let mut mesh = builder.build()?;
        for (name, axis) in [("left", Axis::X), ("front", Axis::Y), ("bottom", Axis::Z)] {
            let facets = mesh.facets_on_plane(axis, 0.0, 0.0);
            mesh.set_facet_set(name, facets)?;
        }
        Ok(mesh)
    }
}
