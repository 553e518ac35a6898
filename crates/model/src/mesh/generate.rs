//! Structured meshes of boxes, and mapping of node positions.

use super::{Axis, ElementKind, Facet, Mesh, MeshError};
use crate::Vec3;

/// The corners of one element, as corners of its cell.
type Pattern = &'static [u8];

const ONE_HEX: [Pattern; 1] = [&[0, 1, 2, 3, 4, 5, 6, 7]];
/// Both sides of the vertical plane through the corners 0 and 2.
const TWO_WEDGES: [Pattern; 2] = [&[0, 1, 2, 4, 5, 6], &[0, 2, 3, 4, 6, 7]];
/// The six ways from corner 0 to corner 6 along the axes, one tetrahedron each (H. W. Kuhn, 1960);
/// neighbouring cells match.
const SIX_TETS: [Pattern; 6] = [
    &[0, 1, 2, 6],
    &[0, 5, 1, 6],
    &[0, 2, 3, 6],
    &[0, 3, 7, 6],
    &[0, 4, 5, 6],
    &[0, 7, 4, 6],
];

/// The named faces of a box.
const FACES: [(&str, Axis, bool); 6] = [
    ("left", Axis::X, false),
    ("right", Axis::X, true),
    ("front", Axis::Y, false),
    ("back", Axis::Y, true),
    ("bottom", Axis::Z, false),
    ("top", Axis::Z, true),
];

impl Mesh {
    /// A structured mesh of a box of equal eight-node hexahedra between two corners (m), with `cells` elements along x, y,
    /// z.
    ///
    /// All elements are in the element set `elements`; the facet sets are `left` and `right` (least and
    /// greatest x), `front` and `back` (y), `bottom` and `top` (z). Nodes and elements are
    /// numbered from 1, x fastest, then y.
    ///
    /// # Errors
    /// [`MeshError::NoExtent`], [`MeshError::Empty`] for zero cells, [`MeshError::TooLarge`].
    ///
    /// ```
    /// use powerhouse_model::{Mesh, Vec3};
    /// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(20.0, 10.0, 5.0), [4, 2, 1], "rock")?;
    /// assert_eq!((mesh.node_count(), mesh.element_count()), (30, 8));
    /// assert_eq!(mesh.facet_set("top")?.len(), 8);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn box_of_hexes(
        low: Vec3,
        high: Vec3,
        cells: [usize; 3],
        elements: &str,
    ) -> Result<Self, MeshError> {
        box_of(ElementKind::Hex8, &ONE_HEX, low, high, cells, elements)
    }

    /// A structured mesh of a box as [`box_of_hexes`](Self::box_of_hexes), with every cell divided into two wedges by a
    /// vertical plane.
    ///
    /// # Errors
    /// As [`box_of_hexes`](Self::box_of_hexes).
    pub fn box_of_wedges(
        low: Vec3,
        high: Vec3,
        cells: [usize; 3],
        elements: &str,
    ) -> Result<Self, MeshError> {
        box_of(ElementKind::Wedge6, &TWO_WEDGES, low, high, cells, elements)
    }

    /// A structured mesh of a box as [`box_of_hexes`](Self::box_of_hexes), with every cell divided into six tetrahedra
    /// around its diagonal.
    ///
    /// # Errors
    /// As [`box_of_hexes`](Self::box_of_hexes).
    pub fn box_of_tets(
        low: Vec3,
        high: Vec3,
        cells: [usize; 3],
        elements: &str,
    ) -> Result<Self, MeshError> {
        box_of(ElementKind::Tet4, &SIX_TETS, low, high, cells, elements)
    }

    /// A structured mesh of a box as [`box_of_hexes`](Self::box_of_hexes), with every cell divided into six pyramids with
    /// their apex at its centre; nodes at the centres follow all others.
    ///
    /// # Errors
    /// As [`box_of_hexes`](Self::box_of_hexes).
    pub fn box_of_pyramids(
        low: Vec3,
        high: Vec3,
        cells: [usize; 3],
        elements: &str,
    ) -> Result<Self, MeshError> {
        let bricks = Self::box_of_hexes(low, high, cells, elements)?;
        let apexes = bricks.node_count() + bricks.element_count();
        if 5 * 6 * bricks.element_count() >= u32::MAX as usize {
            let (what, count) = ("element corners", 5 * 6 * bricks.element_count());
            return Err(MeshError::TooLarge { what, count });
        }
        let mut mesh = Self {
            positions: bricks.positions.clone(),
            node_tags: (1..=apexes as u64).collect(),
            offsets: vec![0].into(),
            ..Self::default()
        };
        for element in 0..bricks.element_count() as u32 {
            let apex = mesh.positions.len() as u32;
            mesh.positions.push(bricks.centroid(element));
            for side in 0..6 {
                let base = bricks.facet_nodes(Facet { element, side });
                // Counter-clockwise seen from the apex, which is inside.
                mesh.connectivity.extend(base.into_iter().rev());
                mesh.connectivity.push(apex);
                mesh.kinds.push(ElementKind::Pyramid5);
                mesh.offsets.push(mesh.connectivity.len() as u32);
            }
        }
        mesh.element_tags = (1..=mesh.kinds.len() as u64).collect();
        mesh.set_element_set(elements, (0..mesh.kinds.len() as u32).collect())?;
        for (name, facets) in &*bricks.facet_sets {
            let base = |facet: &Facet| Facet {
                element: 6 * facet.element + u32::from(facet.side),
                side: 0,
            };
            mesh.set_facet_set(name, facets.iter().map(base).collect())?;
        }
        Ok(mesh)
    }

    /// The same mesh with node positions mapped by `map` (m to m); sets are kept.
    ///
    /// The shapes of the mapped elements are checked by [`check`](Self::check).
    ///
    /// # Errors
    /// [`MeshError::CoordinateNotFinite`].
    ///
    /// ```
    /// use powerhouse_model::{Mesh, Vec3};
    /// let block = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(1.0), [4, 4, 4], "rock")?;
    /// let sheared = block.map_positions(|p| Vec3::new(p.x + 0.2 * p.z, p.y, p.z))?;
    /// assert!(sheared.check()?.least_scaled_jacobian < 1.0);
    /// # Ok::<(), powerhouse_model::MeshError>(())
    /// ```
    pub fn map_positions(mut self, map: impl Fn(Vec3) -> Vec3) -> Result<Self, MeshError> {
        for (position, &node) in self.positions.iter_mut().zip(self.node_tags.iter()) {
            *position = map(*position);
            for axis in [Axis::X, Axis::Y, Axis::Z] {
                let value = position[axis.index()];
                if !value.is_finite() {
                    return Err(MeshError::CoordinateNotFinite {
                        node,
                        axis: axis.name(),
                        value,
                    });
                }
            }
        }
        Ok(self)
    }
}

fn box_of(
    kind: ElementKind,
    patterns: &[Pattern],
    low: Vec3,
    high: Vec3,
    cells: [usize; 3],
    elements: &str,
) -> Result<Mesh, MeshError> {
    for axis in [Axis::X, Axis::Y, Axis::Z] {
        let (low, high) = (low[axis.index()], high[axis.index()]);
        if !low.is_finite() || !high.is_finite() || low >= high {
            return Err(MeshError::NoExtent {
                axis: axis.name(),
                low,
                high,
            });
        }
    }
    if cells.contains(&0) {
        return Err(MeshError::Empty);
    }
    // In floating point, so that no product overflows before it is refused.
    let corners: f64 = cells.iter().map(|&n| n as f64 + 1.0).product::<f64>()
        * (patterns.len() * kind.node_count()) as f64;
    if corners >= f64::from(u32::MAX) {
        return Err(MeshError::TooLarge {
            what: "element corners",
            count: corners as usize,
        });
    }
    let mut mesh = Mesh {
        positions: grid(low, high, cells).into(),
        offsets: vec![0].into(),
        ..Mesh::default()
    };
    let [nx, ny, nz] = cells;
    let node = |i: usize, j: usize, k: usize| ((k * (ny + 1) + j) * (nx + 1) + i) as u32;
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let ring = |k| {
                    [
                        node(i, j, k),
                        node(i + 1, j, k),
                        node(i + 1, j + 1, k),
                        node(i, j + 1, k),
                    ]
                };
                let cell = [ring(k), ring(k + 1)].concat();
                for pattern in patterns {
                    let nodes = pattern.iter().map(|&corner| cell[corner as usize]);
                    mesh.connectivity.extend(nodes);
                    mesh.offsets.push(mesh.connectivity.len() as u32);
                    mesh.kinds.push(kind);
                }
            }
        }
    }
    mesh.node_tags = (1..=mesh.positions.len() as u64).collect();
    mesh.element_tags = (1..=mesh.kinds.len() as u64).collect();
    mesh.set_element_set(elements, (0..mesh.kinds.len() as u32).collect())?;
    let surface = mesh.boundary_facets();
    for (name, axis, far) in FACES {
        let value = if far { high } else { low }[axis.index()];
        let on_face = |facet: &&Facet| {
            let nodes = mesh.facet_nodes(**facet);
            let mut along = nodes
                .iter()
                .map(|&n| mesh.positions[n as usize][axis.index()]);
            along.all(|coordinate| coordinate == value)
        };
        let facets = surface.iter().filter(on_face).copied().collect();
        mesh.set_facet_set(name, facets)?;
    }
    Ok(mesh)
}

/// Positions of a grid, x fastest; the ends are exact.
fn grid(low: Vec3, high: Vec3, cells: [usize; 3]) -> Vec<Vec3> {
    let along = |axis: usize| {
        let n = cells[axis];
        (0..=n).map(move |i| match i {
            _ if i == n => high[axis],
            _ => low[axis] + (high[axis] - low[axis]) * (i as f64 / n as f64),
        })
    };
    let mut positions = Vec::with_capacity(cells.iter().map(|n| n + 1).product());
    for z in along(2) {
        for y in along(1) {
            positions.extend(along(0).map(|x| Vec3::new(x, y, z)));
        }
    }
    positions
}
