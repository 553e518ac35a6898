//! Added mass of water beside faces.

use std::collections::BTreeMap;

use powerhouse_model::{AddedMass, EngineError, Facet, Mat3, Mesh, ParameterError, Vec3};

use super::face::check_sides;
use super::quadrature::{DepthPoint, points_between};

/// Tolerance of depths, over the depth to which a mass is defined.
const ROUNDING_OF_DEPTH: f64 = 1e-6;
/// Largest permitted relative difference between the diameter of a conduit and that of its facets, which polygons of few
/// sides make uncertain.
const OF_DIAMETER: f64 = 0.2;
/// Angle between facets (rad) below which they count as one plane.
const PLANE: f64 = 1e-6;

/// Mass per area of face (kg/m2) of the water that moves with it along its normal.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum WaterMass {
    /// Basin before a wall: `7/8 rho sqrt(H y)` at the depth `y` below the level, with the depth `H` of the basin
    /// (Westergaard 1933, for a rigid vertical wall, an endless basin and water that is not compressed).
    Westergaard {
        /// Density of the water (kg/m3).
        density: f64,
        /// Elevation of the level (m).
        level: f64,
        /// Depth of the basin at the wall (m).
        depth: f64,
    },
    /// Circular conduit full of water that moves across its axis: `rho d / 2`.
    ///
    /// Where the conduit moves as a rigid section with the acceleration `a` across its axis, the water has the pressure
    /// `-rho a . x` (`x` from the axis) and moves as the section does: at the wall, whose normal acceleration is
    /// `a_n = a cos(theta)`, that is `rho r a_n`. All around, `integral of rho r cos^2(theta) r dtheta = rho pi r^2`: the mass of
    /// the water. Where the section is deformed with `n` waves around, potential flow gives `rho r / n` (Lamb 1932): the mass
    /// is too great by that factor.
    Conduit {
        /// Density of the water (kg/m3).
        density: f64,
        /// Inner diameter (m).
        diameter: f64,
    },
    /// Mass by depth, linear between the rows of a table.
    Table {
        /// Elevation of the level (m).
        level: f64,
        /// Depths below the level (m), rising from zero.
        depths: Vec<f64>,
        /// Mass per area (kg/m2) at each depth.
        masses: Vec<f64>,
    },
}

impl WaterMass {
    fn check(&self) -> Result<(), ParameterError> {
        let positive =
            |name, value| ParameterError::check(name, value, f64::MIN_POSITIVE, f64::MAX);
        let finite = |name, value| ParameterError::check(name, value, f64::MIN, f64::MAX);
        match self {
            Self::Westergaard {
                density,
                level,
                depth,
            } => {
                positive("density", *density)?;
                finite("level", *level)?;
                positive("depth", *depth)
            }
            Self::Conduit { density, diameter } => {
                positive("density", *density)?;
                positive("diameter", *diameter)
            }
            Self::Table {
                level,
                depths,
                masses,
            } => {
                finite("level", *level)?;
                let rows = depths.len() as f64;
                ParameterError::check("number of depths", rows, 2.0, f64::MAX)?;
                ParameterError::check("number of masses", masses.len() as f64, rows, rows)?;
                ParameterError::check("first depth", depths[0], 0.0, 0.0)?;
                for pair in depths.windows(2) {
                    ParameterError::check("depth", pair[1], pair[0].next_up(), f64::MAX)?;
                }
                let mut all = masses.iter();
                all.try_for_each(|mass| ParameterError::check("mass", *mass, 0.0, f64::MAX))
            }
        }
    }

    /// Elevation of the level (m); none where the water has none.
    fn level(&self) -> Option<f64> {
        match *self {
            Self::Conduit { .. } => None,
            Self::Westergaard { level, .. } | Self::Table { level, .. } => Some(level),
        }
    }

    /// Depths between which the mass per area is smooth, and the greatest at which it is defined.
    fn bands(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Westergaard { depth, .. } => vec![[0.0, depth * (1.0 + ROUNDING_OF_DEPTH)]],
            Self::Conduit { .. } => vec![[f64::NEG_INFINITY, f64::INFINITY]],
            Self::Table { depths, .. } => {
                let mut bands: Vec<[f64; 2]> =
                    depths.windows(2).map(|pair| [pair[0], pair[1]]).collect();
                if let Some([_, last]) = bands.last_mut() {
                    *last *= 1.0 + ROUNDING_OF_DEPTH;
                }
                bands
            }
        }
    }

    /// Mass per area (kg/m2) at a depth (m) within a band.
    fn at(&self, depth: f64, band: usize) -> f64 {
        match self {
            Self::Westergaard {
                density, depth: of, ..
            } => 0.875 * density * (of * depth).sqrt(),
            Self::Conduit { density, diameter } => 0.5 * density * diameter,
            Self::Table { depths, masses, .. } => {
                let share = (depth - depths[band]) / (depths[band + 1] - depths[band]);
                masses[band] + share * (masses[band + 1] - masses[band])
            }
        }
    }
}

/// Added mass of the water beside facets, normal to them, at their nodes.
///
/// ```
/// use powerhouse_elements::{FaceMass, WaterMass};
/// use powerhouse_model::{Mesh, Vec3};
/// let wall = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(1.0, 3.0, 20.0), [1, 3, 20], "wall")?;
/// let water = WaterMass::Westergaard { density: 1000.0, level: 20.0, depth: 20.0 };
/// let added = FaceMass::new(&wall, wall.facet_set("left")?, &water)?;
/// // 7/12 rho H^2 per metre of width.
/// let exact = 7.0 / 12.0 * 1000.0 * 20.0 * 20.0 * 3.0;
/// assert!((added.total() / exact - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FaceMass {
    masses: Vec<AddedMass>,
    total: f64,
    area: f64,
}

impl FaceMass {
    /// Added mass of water beside facets: the lumped matrices `integral of N_a m n n^T dA` of their parts below the level,
    /// `m` the mass per area and `n` the normal. On facets that are plane parallelograms or triangles with two corners of one
    /// depth the integral is exact, on others to 1e-5.
    ///
    /// # Errors
    /// A parameter out of its range; [`EngineError::BothSides`] for facets inside a body that are listed from both sides;
    /// [`EngineError::TooDeep`] for a facet that is deeper than the mass is defined; [`EngineError::DryFacets`] if none is
    /// below the level; [`EngineError::OtherDiameter`] if facets are not those of the conduit.
    ///
    /// # Panics
    /// If a facet does not belong to the mesh.
    pub fn new(mesh: &Mesh, facets: &[Facet], water: &WaterMass) -> Result<Self, EngineError> {
        water.check()?;
        check_sides(mesh, facets)?;
        if let WaterMass::Conduit { diameter, .. } = water {
            check_diameter(mesh, facets, *diameter)?;
        }
        let (level, bands) = (water.level(), water.bands());
        let most = bands.last().map_or(0.0, |band| band[1]);
        let mut sums: BTreeMap<u32, Mat3> = BTreeMap::new();
        let (mut total, mut wet) = (0.0, 0.0);
        for &facet in facets {
            let nodes = mesh.facet_nodes(facet);
            let corners: Vec<Vec3> = nodes
                .iter()
                .map(|&n| mesh.positions()[n as usize])
                .collect();
            // Without a level all points have one depth.
            let depths: Vec<f64> = match level {
                Some(level) => corners.iter().map(|corner| level - corner.z).collect(),
                None => vec![1.0; corners.len()],
            };
            let deepest = depths.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            if deepest > most {
                return Err(EngineError::TooDeep {
                    element: mesh.element_tags()[facet.element as usize],
                    depth: deepest,
                    most: most / (1.0 + ROUNDING_OF_DEPTH),
                });
            }
            for (index, &band) in bands.iter().enumerate() {
                for DepthPoint { shape, area, depth } in points_between(&corners, &depths, band) {
                    let size = area.norm();
                    let mass = water.at(depth, index);
                    total += mass * size;
                    wet += size;
                    // A facet without extent there has none.
                    if size > 0.0 {
                        let tensor = area * area.transpose() * (mass / size);
                        for (&node, share) in nodes.iter().zip(&shape) {
                            *sums.entry(node).or_insert_with(Mat3::zeros) += tensor * *share;
                        }
                    }
                }
            }
        }
        if let (Some(level), true) = (level, wet == 0.0) {
            return Err(EngineError::DryFacets {
                count: facets.len(),
                level,
            });
        }
        let masses = sums.into_iter();
        let masses = masses.filter(|(_, mass)| *mass != Mat3::zeros());
        Ok(Self {
            masses: masses
                .map(|(node, mass)| AddedMass::new(node, mass))
                .collect(),
            total,
            area: wet,
        })
    }

    /// Masses of the nodes, in rising order of nodes.
    pub fn masses(&self) -> &[AddedMass] {
        &self.masses
    }
    /// Integral of the mass per area over the facets (kg).
    pub fn total(&self) -> f64 {
        self.total
    }
    /// Area of the facets below the level (m2).
    pub fn area(&self) -> f64 {
        self.area
    }
    /// Mass (kg) of a motion of all facets along a coordinate axis: x, y, z.
    pub fn along_axes(&self) -> [f64; 3] {
        let sum: Mat3 = self.masses.iter().map(|node| node.mass).sum();
        [sum[(0, 0)], sum[(1, 1)], sum[(2, 2)]]
    }
}

/// Refuses facets that do not curve around water as a conduit of a diameter (m) does: the angle between neighbours, over the
/// distance of their middles.
fn check_diameter(mesh: &Mesh, facets: &[Facet], diameter: f64) -> Result<(), EngineError> {
    let mut beside: BTreeMap<[u32; 2], (Vec3, Vec3)> = BTreeMap::new();
    let (mut arc, mut turned) = (0.0, 0.0);
    for &facet in facets {
        let geometry = mesh.facet_geometry(facet);
        let (middle, normal) = (geometry.centroid, geometry.normal());
        let corners = mesh.facet_corners(facet);
        for (i, &from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            let edge = [from.min(to), from.max(to)];
            let Some((other, other_normal)) = beside.insert(edge, (middle, normal)) else {
                continue;
            };
            let [a, b] = edge.map(|node| mesh.positions()[node as usize]);
            let along = b - a;
            let angle = normal
                .cross(&other_normal)
                .norm()
                .atan2(normal.dot(&other_normal));
            if angle < PLANE {
                continue;
            }
            let between = other - middle;
            let across = between - along * (between.dot(&along) / along.norm_squared());
            // Normals of a conduit, which point into the water, approach each other.
            let sign = (other - middle).dot(&normal).signum();
            arc += across.norm() * along.norm();
            // The chord between the middles is that of a circle that touches both facets.
            turned += sign * 2.0 * (0.5 * angle).sin() * along.norm();
        }
    }
    let found = 2.0 * arc / turned;
    // Plane facets have no diameter.
    if arc > 0.0 && found > 0.0 && (found / diameter - 1.0).abs() <= OF_DIAMETER {
        return Ok(());
    }
    Err(EngineError::OtherDiameter {
        found: if arc > 0.0 { found } else { f64::INFINITY },
        given: diameter,
    })
}
