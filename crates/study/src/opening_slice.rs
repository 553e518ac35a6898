//! Mesh generator: vertical slice of ground with a circular opening.

use powerhouse::model::{Axis, ElementKind, Mesh, MeshError, ParameterError, Vec3};

use crate::StudyError;

/// Mesh generator of a plane-strain slice of ground, one element thick, across a long circular opening.
///
/// ```text
///   z = 0  --------------------------------   `top`
///          |  |  |  | |\|_|_|/| |  |  |  |
///          |  |  |  | |-( ) -|| |  |  |  |   opening at depth `depth`; around it
///          |--|--|--|-|/|-|-|\|-|--|--|--|   rings of bricks from the circle to a square
///          |  |  |  | | | | | | |  |  |  |
///  `left`  |--|--|--|-|-|-|-|-|-|--|--|--|  `right`
///          --------------------------------  `bottom`
///      x = -half_width      0        half_width
/// ```
///
/// Elements have edges of length `fine` around the opening and on the surface above it; from there each row is longer
/// than the one before by the factor `growth`, up to `coarse`. The numerical dispersion of steeply incident waves
/// depends on the height of the elements, not on their width, so that elements may be longer to the sides than below.
/// All elements are in the set `rock`; facet sets
/// are `left`, `right`, `bottom`, `top`, the wall `opening`, and the cuts `front` (y = 0) and
/// `back` (y = `fine`). With both cuts on rollers along y the slice is in plane strain.
///
/// The nodes of the wall lie on the circle; elements inscribe a polygon in it.
///
/// ```
/// use powerhouse_study::OpeningSlice;
/// let slice = OpeningSlice {
///     radius: 2.0,
///     depth: 3.0,
///     half_width: 12.0,
///     height: 10.0,
///     fine: 0.4,
///     coarse: [1.0, 0.8],
///     growth: 1.1,
/// };
/// let mesh = slice.mesh()?;
/// assert!(mesh.check()?.least_scaled_jacobian > 0.6);
/// assert_eq!(mesh.bounding_box().0.z, -10.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpeningSlice {
    /// Radius of the opening (m), 0.001 to 1e6.
    pub radius: f64,
    /// Depth of the centre of the opening below the surface z = 0 (m), at least 1.05 radii.
    pub depth: f64,
    /// Distance from the centre to the left and right ends (m).
    pub half_width: f64,
    /// Distance from the surface to the bottom (m).
    pub height: f64,
    /// Edge length of the elements around the opening, and thickness of the slice (m), at most half the radius.
    pub fine: f64,
    /// Longest edges of the elements far to the sides and far below (m).
    pub coarse: [f64; 2],
    /// Ratio of element lengths of consecutive rows, from 1 to 1.5.
    pub growth: f64,
}

/// Half the side of the square around a deep opening, over its radius; the square around a shallow
/// one reaches up to the surface.
const SQUARE: f64 = 2.0;
/// Greatest depth of a shallow opening, over its radius.
const SHALLOW: f64 = 2.5;
/// Least depth of the centre, over the radius.
const LEAST_DEPTH: f64 = 1.05;

impl OpeningSlice {
    /// Generates the mesh.
    ///
    /// # Errors
    /// A length out of its range, or a mesh with too many nodes.
    pub fn mesh(&self) -> Result<Mesh, StudyError> {
        self.check()?;
        let grid = Grid::around(self);
        Ok(grid.mesh(self).map_err(powerhouse::Error::from)?)
    }

    fn check(&self) -> Result<(), StudyError> {
        let half_square = self.half_square();
        let most = 1.0e6 * self.radius;
        let ranges = [
            ("radius", self.radius, 1.0e-3, 1.0e6),
            ("depth", self.depth, LEAST_DEPTH * self.radius, most),
            (
                "half_width",
                self.half_width,
                half_square + self.coarse[0],
                most,
            ),
            (
                "height",
                self.height,
                self.depth + half_square + self.coarse[1],
                most,
            ),
            ("fine", self.fine, 1.0e-3 * self.radius, 0.5 * self.radius),
            ("coarse", self.coarse[0], self.fine, most),
            ("coarse", self.coarse[1], self.fine, most),
            ("growth", self.growth, 1.0, 1.5),
        ];
        /// Relative rounding error of a sum of lengths.
        const ROUNDING: f64 = 1e-12;
        for (name, value, least, most) in ranges {
            let least = least * (1.0 - ROUNDING);
            ParameterError::check(name, value, least, most).map_err(powerhouse::Error::from)?;
        }
        Ok(())
    }

    /// Half the side of the square around the opening (m).
    fn half_square(&self) -> f64 {
        if self.depth <= SHALLOW * self.radius {
            self.depth
        } else {
            SQUARE * self.radius
        }
    }

    /// Distances from 0 to `length` that grow from `fine` to an edge of `coarse`.
    fn graded(&self, length: f64, coarse: f64) -> Vec<f64> {
        let mut distances = vec![0.0];
        let (mut reached, mut edge) = (0.0, self.fine);
        while reached < length - 0.5 * edge {
            reached += edge;
            distances.push(reached);
            edge = (edge * self.growth).min(coarse);
        }
        if distances.len() == 1 {
            distances.push(length);
            reached = length;
        }
        distances.iter_mut().for_each(|d| *d *= length / reached);
        distances
    }
}

/// Lines of a grid with a square hole that is filled with rings around a circle.
struct Grid {
    /// Coordinates of the lines across x and z (m), rising.
    x: Vec<f64>,
    z: Vec<f64>,
    /// Indices of the lines across x and z on which the square begins.
    corner: [usize; 2],
    /// Cells along a side of the square.
    along: usize,
    /// Rings between circle and square.
    rings: usize,
}

impl Grid {
    fn around(slice: &OpeningSlice) -> Self {
        let half = slice.half_square();
        // Even, so that there is a line through the centre.
        let along = 2 * (half / slice.fine).round().max(2.0) as usize;
        let across = |i: usize| half * (2.0 * i as f64 / along as f64 - 1.0);
        let outwards = slice.graded(slice.half_width - half, slice.coarse[0]);
        let x = (outwards[1..].iter().rev())
            .map(|d| -half - d)
            .chain((0..=along).map(across))
            .chain(outwards[1..].iter().map(|d| half + d))
            .collect();
        let downwards = slice.graded(slice.height - slice.depth - half, slice.coarse[1]);
        let below = downwards.len() - 1;
        let mut z: Vec<f64> = (downwards[1..].iter().rev())
            .map(|d| -slice.depth - half - d)
            .chain((0..=along).map(|k| across(k) - slice.depth))
            .collect();
        let above = slice.depth - half;
        if above > 0.0 {
            let cells = (above / slice.fine).ceil();
            z.extend((1..=cells as usize).map(|k| -above * (1.0 - k as f64 / cells)));
        }
        // Mean distance from the circle to the square.
        let distance = 0.5 * (1.0 + core::f64::consts::SQRT_2) * half - slice.radius;
        Self {
            x,
            z,
            corner: [outwards.len() - 1, below],
            along,
            rings: (distance / slice.fine).round().max(2.0) as usize,
        }
    }

    /// The grid indices of a point on the outline of the square, counted counter-clockwise from its lower right
    /// corner.
    fn outline(&self, point: usize) -> [usize; 2] {
        let [x, z] = self.corner;
        let n = self.along;
        let along = point % n;
        match point / n % 4 {
            0 => [x + n, z + along],
            1 => [x + n - along, z + n],
            2 => [x, z + n - along],
            _ => [x + along, z],
        }
    }

    fn is_inside(&self, i: usize, k: usize) -> bool {
        let within = |line: usize, first: usize| line > first && line < first + self.along;
        within(i, self.corner[0]) && within(k, self.corner[1])
    }

    /// The number of a node of the grid, on the cut y = 0.
    fn grid_node(&self, [i, k]: [usize; 2]) -> u64 {
        1 + (k * self.x.len() + i) as u64
    }

    /// The number of a node on a ring from the circle (0) to the square.
    fn ring_node(&self, point: usize, ring: usize) -> u64 {
        let around = 4 * self.along;
        if ring == self.rings {
            return self.grid_node(self.outline(point));
        }
        let after_grid = self.x.len() * self.z.len();
        1 + (after_grid + ring * around + point % around) as u64
    }

    fn mesh(&self, slice: &OpeningSlice) -> Result<Mesh, MeshError> {
        let around = 4 * self.along;
        // Numbers of the second cut follow those of the first.
        let behind = (self.x.len() * self.z.len() + self.rings * around) as u64;
        let mut builder = Mesh::builder();
        for (thickness, shift) in [(0.0, 0), (slice.fine, behind)] {
            let at = |x: f64, z: f64| Vec3::new(x, thickness, z);
            for (k, &z) in self.z.iter().enumerate() {
                for (i, &x) in self.x.iter().enumerate() {
                    if !self.is_inside(i, k) {
                        builder.node(shift + self.grid_node([i, k]), at(x, z));
                    }
                }
            }
            for ring in 0..self.rings {
                let share = ring as f64 / self.rings as f64;
                for point in 0..around {
                    let angle =
                        core::f64::consts::FRAC_PI_2 * (point as f64 / self.along as f64 - 0.5);
                    let [i, k] = self.outline(point);
                    let (sine, cosine) = angle.sin_cos();
                    let (x, z) = (slice.radius * cosine, slice.radius * sine - slice.depth);
                    let (dx, dz) = (self.x[i] - x, self.z[k] - z);
                    let position = at(x + share * dx, z + share * dz);
                    builder.node(shift + self.ring_node(point, ring), position);
                }
            }
        }
        let mut tag = 0;
        let mut brick = |corners: [u64; 4]| {
            tag += 1;
            let nodes = [corners, corners.map(|node| node + behind)].concat();
            builder.element(tag, ElementKind::Hex8, &nodes, &["rock"]);
        };
        for k in 0..self.z.len() - 1 {
            for i in 0..self.x.len() - 1 {
                let is_hole =
                    |line: usize, first: usize| (first..first + self.along).contains(&line);
                if is_hole(i, self.corner[0]) && is_hole(k, self.corner[1]) {
                    continue;
                }
                let corners = [[i, k], [i, k + 1], [i + 1, k + 1], [i + 1, k]];
                brick(corners.map(|point| self.grid_node(point)));
            }
        }
        for ring in 0..self.rings {
            for point in 0..around {
                let next = point + 1;
                let corners = [
                    (point, ring),
                    (next, ring),
                    (next, ring + 1),
                    (point, ring + 1),
                ];
                brick(corners.map(|(point, ring)| self.ring_node(point, ring)));
            }
        }
        for point in 0..around {
            let edge = [self.ring_node(point, 0), self.ring_node(point + 1, 0)];
            let facet = [edge[0], edge[1], edge[1] + behind, edge[0] + behind];
            builder.facet("opening", &facet);
        }
        let mut mesh = builder.build()?;
        let tolerance = 1.0e-6 * slice.fine;
        for (name, axis, value) in [
            ("left", Axis::X, -slice.half_width),
            ("right", Axis::X, slice.half_width),
            ("bottom", Axis::Z, -slice.height),
            ("top", Axis::Z, 0.0),
            ("front", Axis::Y, 0.0),
            ("back", Axis::Y, slice.fine),
        ] {
            let facets = mesh.facets_on_plane(axis, value, tolerance);
            mesh.set_facet_set(name, facets)?;
        }
        Ok(mesh)
    }
}
