//! Location of points in elements (inverse isoparametric map).

use super::select::lies_in;
use super::{ElementKind, Mesh, MeshError};
use crate::{Mat3, Vec3};

/// Location of a point in a mesh: element, natural coordinates and interpolation weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Located {
    /// Mesh index of the element.
    pub element: u32,
    /// Natural coordinates in the element, see [`ElementKind::shape_functions`].
    pub natural: Vec3,
    /// Mesh indices of the element's nodes.
    pub nodes: Vec<u32>,
    /// Values of the shape functions of these nodes at the point; they add up to one.
    pub weights: Vec<f64>,
    /// Distance by which the point was moved into the element (m); zero if it lies in it.
    pub moved: f64,
}

impl Located {
    /// Interpolated value of a nodal field at the point, exact for fields that are linear in space.
    pub fn interpolate(&self, field: impl Fn(u32) -> Vec3) -> Vec3 {
        let terms = self.nodes.iter().zip(&self.weights);
        terms.map(|(&node, &weight)| field(node) * weight).sum()
    }
}

/// Tolerance of natural coordinates, so that rounding excludes no point between two elements.
const SLACK: f64 = 1e-10;

impl Mesh {
    /// Locates points (m) in the solid elements.
    ///
    /// A point outside by no more than 1e-6 of the diagonal of the nearest element's box is moved
    /// to that element's surface. On a side or node shared by elements, the first of them is returned.
    /// Newton's method inverts the isoparametric map; the weights reproduce the point to rounding.
    /// The work is one pass over the elements, the memory that of the points alone.
    ///
    /// # Errors
    /// [`MeshError::PointOutside`] names the first such point and the nearest element,
    /// [`MeshError::PointNotFinite`] the first that is not finite; [`MeshError::Empty`] if there
    /// are no solid elements.
    ///
    /// ```
    /// use powerhouse_model::{Mesh, Vec3};
    /// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(10.0), [5, 5, 5], "rock")?;
    /// let probe = &mesh.locate(&[Vec3::new(3.0, 1.0, 9.5)])?[0];
    /// let displacement = probe.interpolate(|node| mesh.positions()[node as usize] * 1e-3);
    /// assert!((displacement - Vec3::new(3e-3, 1e-3, 9.5e-3)).norm() < 1e-15);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn locate(&self, points: &[Vec3]) -> Result<Vec<Located>, MeshError> {
        let all = 0..self.element_count() as u32;
        locate(self, points, all, |diagonal| 1e-6 * diagonal)
    }

    /// Locates points (m) in some of the elements, such as those on one side of a joint; points may lie outside
    /// by up to `tolerance` (m), such as the distance of a round wall from its chord.
    ///
    /// # Errors
    /// As [`locate`](Self::locate).
    ///
    /// # Panics
    /// If an element does not belong to the mesh.
    pub fn locate_among(
        &self,
        elements: &[u32],
        points: &[Vec3],
        tolerance: f64,
    ) -> Result<Vec<Located>, MeshError> {
        locate(self, points, elements.iter().copied(), |_| tolerance)
    }
}

fn locate(
    mesh: &Mesh,
    points: &[Vec3],
    elements: impl Iterator<Item = u32> + Clone,
    tolerance: impl Fn(f64) -> f64,
) -> Result<Vec<Located>, MeshError> {
    if let Some(point) = points.iter().find(|p| p.iter().any(|x| !x.is_finite())) {
        return Err(MeshError::PointNotFinite {
            point: (*point).into(),
        });
    }
    let solid = elements.filter(|&element| mesh.kind(element).is_solid());
    let buckets = PointBuckets::new(points);
    let mut best: Vec<Option<Candidate>> = vec![None; points.len()];
    for element in solid.clone() {
        let (low, high) = element_box(mesh, element);
        let tolerance = tolerance((high - low).norm());
        let margin = Vec3::repeat(tolerance.max(SLACK * (high - low).norm()));
        buckets.for_each_in(&(low - margin), &(high + margin), |index| {
            if best[index].is_none_or(|found| found.moved > 0.0) {
                let candidate = closest(mesh, element, &points[index]);
                if candidate.moved <= tolerance
                    && best[index].is_none_or(|found| candidate.moved < found.moved)
                {
                    best[index] = Some(candidate);
                }
            }
        });
    }
    let located = points.iter().zip(best).map(|(point, found)| match found {
        Some(found) => Ok(found.located(mesh)),
        None => Err(outside(mesh, solid.clone(), point, &tolerance)),
    });
    located.collect()
}

/// The error that names the element nearest to a point.
fn outside(
    mesh: &Mesh,
    elements: impl Iterator<Item = u32>,
    point: &Vec3,
    tolerance: impl Fn(f64) -> f64,
) -> MeshError {
    let mut nearest: Option<Candidate> = None;
    for element in elements {
        let (low, high) = element_box(mesh, element);
        let to_box = (point - point.sup(&low).inf(&high)).norm();
        if nearest.is_none_or(|found| to_box < found.moved) {
            let candidate = closest(mesh, element, point);
            if nearest.is_none_or(|found| candidate.moved < found.moved) {
                nearest = Some(candidate);
            }
        }
    }
    nearest.map_or(MeshError::Empty, |nearest| {
        let (low, high) = element_box(mesh, nearest.element);
        MeshError::PointOutside {
            point: (*point).into(),
            element: mesh.element_tags[nearest.element as usize],
            distance: nearest.moved,
            tolerance: tolerance((high - low).norm()),
        }
    })
}

fn element_box(mesh: &Mesh, element: u32) -> (Vec3, Vec3) {
    let infinite = Vec3::repeat(f64::INFINITY);
    let nodes = mesh.nodes_of(element).iter();
    nodes.fold((infinite, -infinite), |(low, high), &node| {
        let position = &mesh.positions[node as usize];
        (low.inf(position), high.sup(position))
    })
}

/// A position in an element, and its distance (m) from the point to be located.
#[derive(Clone, Copy)]
struct Candidate {
    element: u32,
    natural: Vec3,
    moved: f64,
}

impl Candidate {
    fn located(self, mesh: &Mesh) -> Located {
        let nodes = mesh.nodes_of(self.element).to_vec();
        let mut weights = vec![0.0; nodes.len()];
        mesh.kind(self.element)
            .shape_functions(&self.natural, &mut weights);
        Located {
            element: self.element,
            natural: self.natural,
            nodes,
            weights,
            moved: self.moved,
        }
    }
}

/// The position of a point in an element; for a point outside, the position with the natural
/// coordinates clamped to their range.
fn closest(mesh: &Mesh, element: u32, point: &Vec3) -> Candidate {
    // Edges are straight: midpoints do not change the map.
    let kind = mesh.kind(element).first_order();
    let map = InverseMap::new(mesh, element, point);
    let centre = kind.natural_centre();
    let mut nearest = Candidate {
        element,
        natural: centre,
        moved: f64::INFINITY,
    };
    // Start at the centre; then near each corner if the result is outside, as it may be in
    // strongly distorted elements.
    let corners = kind.natural_corners().iter();
    let starts = corners.map(|&corner| centre + 0.8 * (Vec3::from(corner) - centre));
    for start in core::iter::once(centre).chain(starts) {
        let natural = map.solve(start);
        let range = kind.into_range(natural);
        let inside = (range - natural).amax() <= SLACK;
        let clamped = if inside { natural } else { range };
        let distance = map.residual(&clamped).norm();
        let reached = inside && distance <= 1e-12 * map.size;
        let moved = if reached { 0.0 } else { distance };
        if moved < nearest.moved {
            nearest = Candidate {
                element,
                natural: clamped,
                moved,
            };
        }
        // The map of a tetrahedron is affine; those of other kinds may have a second solution outside.
        if reached || kind == ElementKind::Tet4 {
            break;
        }
    }
    nearest
}

/// The isoparametric map of one element relative to the point to be located:
/// differences of positions keep their digits however far the mesh is from the origin.
struct InverseMap {
    kind: ElementKind,
    /// Positions of the nodes relative to the point (m).
    offsets: [Vec3; MOST_NODES],
    /// Largest distance of a node from the first (m).
    size: f64,
}

/// Largest number of corners of any kind of element.
const MOST_NODES: usize = 8;

impl InverseMap {
    fn new(mesh: &Mesh, element: u32, point: &Vec3) -> Self {
        let mut offsets = [Vec3::zeros(); MOST_NODES];
        for (offset, &node) in offsets.iter_mut().zip(mesh.nodes_of(element)) {
            *offset = mesh.positions[node as usize] - point;
        }
        let kind = mesh.kind(element).first_order();
        let others = &offsets[1..kind.node_count()];
        Self {
            kind,
            offsets,
            size: others
                .iter()
                .fold(0.0, |size, offset| (offset - offsets[0]).norm().max(size)),
        }
    }

    /// Mapped position of natural coordinates relative to the point (m).
    fn residual(&self, natural: &Vec3) -> Vec3 {
        let mut values = [0.0; MOST_NODES];
        self.kind.shape_functions(natural, &mut values);
        let terms = self.offsets.iter().zip(values);
        terms.map(|(offset, value)| offset * value).sum()
    }

    fn jacobian(&self, natural: &Vec3) -> Mat3 {
        let mut gradients = [Vec3::zeros(); MOST_NODES];
        self.kind.shape_gradients(natural, &mut gradients);
        let terms = self.offsets.iter().zip(gradients);
        terms
            .map(|(offset, gradient)| offset * gradient.transpose())
            .sum()
    }

    /// Newton's method from `start`, with steps halved until the distance decreases; ends where no step
    /// decreases it, or far outside.
    fn solve(&self, start: Vec3) -> Vec3 {
        const STEPS: usize = 50;
        const FAR: f64 = 8.0;
        let mut natural = start;
        let mut distance = self.residual(&natural).norm();
        for _ in 0..STEPS {
            let Some(inverse) = self.jacobian(&natural).try_inverse() else {
                break;
            };
            let mut step = inverse * self.residual(&natural);
            let nearer = (0..8).find_map(|_| {
                let tried = natural - step;
                let reached = self.residual(&tried).norm();
                step *= 0.5;
                (reached < distance).then_some((tried, reached))
            });
            match nearer {
                Some((tried, reached)) if tried.amax() < FAR => {
                    natural = tried;
                    distance = reached;
                }
                _ => break,
            }
        }
        natural
    }
}

/// Points sorted into a regular grid of cells, for fast search of the points in a box.
struct PointBuckets<'a> {
    points: &'a [Vec3],
    low: Vec3,
    high: Vec3,
    /// Cells per metre along each axis.
    density: Vec3,
    cells: [usize; 3],
    /// Where each cell starts in `order`.
    starts: Vec<u32>,
    /// Indices of points, cell by cell.
    order: Vec<u32>,
}

impl<'a> PointBuckets<'a> {
    fn new(points: &'a [Vec3]) -> Self {
        let infinite = Vec3::repeat(f64::INFINITY);
        let (low, high) = points.iter().fold((infinite, -infinite), |(low, high), p| {
            (low.inf(p), high.sup(p))
        });
        let extent = high - low;
        let most = 4 * points.len().max(1);
        let mut size = extent.max() / points.len().max(1) as f64;
        let mut cells = [1; 3];
        if extent.max() > 0.0 {
            loop {
                cells = core::array::from_fn(|i| 1 + (extent[i] / size).min(1e9) as usize);
                if cells
                    .iter()
                    .try_fold(1_usize, |all, &n| all.checked_mul(n))
                    .is_some_and(|all| all <= most)
                {
                    break;
                }
                size *= 1.5;
            }
        }
        let mut buckets = Self {
            points,
            low,
            high,
            density: Vec3::repeat(if size > 0.0 { 1.0 / size } else { 0.0 }),
            cells,
            starts: vec![0; cells.iter().product::<usize>() + 1],
            order: vec![0; points.len()],
        };
        let cell_of: Vec<usize> = points
            .iter()
            .map(|p| buckets.index(buckets.cell(p)))
            .collect();
        for &cell in &cell_of {
            buckets.starts[cell + 1] += 1;
        }
        for cell in 1..buckets.starts.len() {
            buckets.starts[cell] += buckets.starts[cell - 1];
        }
        let mut next = buckets.starts.clone();
        for (point, &cell) in cell_of.iter().enumerate() {
            buckets.order[next[cell] as usize] = point as u32;
            next[cell] += 1;
        }
        buckets
    }

    /// The cell of a position; positions outside belong to the outermost cells.
    fn cell(&self, position: &Vec3) -> [usize; 3] {
        core::array::from_fn(|i| {
            let along = (position[i] - self.low[i]) * self.density[i];
            (along.max(0.0) as usize).min(self.cells[i] - 1)
        })
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.cells[1] + j) * self.cells[0] + i
    }

    fn for_each_in(&self, low: &Vec3, high: &Vec3, mut visit: impl FnMut(usize)) {
        if (0..3).any(|i| high[i] < self.low[i] || low[i] > self.high[i]) {
            return;
        }
        let (first, last) = (self.cell(low), self.cell(high));
        for k in first[2]..=last[2] {
            for j in first[1]..=last[1] {
                let from = self.starts[self.index([first[0], j, k])];
                let to = self.starts[self.index([last[0], j, k]) + 1];
                for &point in &self.order[from as usize..to as usize] {
                    let position = &self.points[point as usize];
                    if lies_in(position, low, high) {
                        visit(point as usize);
                    }
                }
            }
        }
    }
}
