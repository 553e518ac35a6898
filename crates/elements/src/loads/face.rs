//! Pressure and traction loads on faces.

use std::collections::BTreeMap;

use powerhouse_model::{EngineError, Facet, Mesh, NodalLoad, ParameterError, TimeFunction, Vec3};

/// Spatial distribution of a pressure or traction over a face.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Profile {
    /// Uniform over the face.
    Uniform,
    /// Linear in the depth below a horizontal level, `gradient * (level - z)`, and zero above it, as hydrostatic
    /// pressure with the gradient `rho g`.
    Depth {
        /// Increase per depth (1/m, so that profile times reference value is a stress;
        /// Pa/m if the reference value is 1).
        gradient: f64,
        /// Elevation of the level (m).
        level: f64,
    },
}

impl Profile {
    /// Hydrostatic pressure of water with its surface at `level` (m): 1000 kg/m3 and 9.81 m/s2.
    pub fn water(level: f64) -> Self {
        Self::Depth {
            gradient: 9810.0,
            level,
        }
    }
    fn at(&self, position: &Vec3) -> f64 {
        match *self {
            Self::Uniform => 1.0,
            Self::Depth { gradient, level } => gradient * (level - position.z).max(0.0),
        }
    }
    fn check(&self) -> Result<(), ParameterError> {
        if let Self::Depth { gradient, level } = *self {
            ParameterError::check("gradient", gradient, f64::MIN, f64::MAX)?;
            ParameterError::check("level", level, f64::MIN, f64::MAX)?;
        }
        Ok(())
    }
}

/// Consistent nodal forces of a load with a time function of one.
#[derive(Debug, Default)]
struct Shares {
    nodes: Vec<u32>,
    forces: Vec<Vec3>,
}

impl Shares {
    /// Consistent nodal forces `integral of N_a t dA` over facets, by Gauss integration; `traction` is the force of a
    /// position with its outward vector area.
    fn integrate(mesh: &Mesh, facets: &[Facet], traction: impl Fn(&Vec3, Vec3) -> Vec3) -> Self {
        let mut sums: BTreeMap<u32, Vec3> = BTreeMap::new();
        for &facet in facets {
            let of_element = mesh.nodes_of(facet.element);
            let side = mesh.kind(facet.element).sides()[facet.side as usize];
            let nodes: Vec<u32> = side.iter().map(|&i| of_element[i as usize]).collect();
            let corners: Vec<Vec3> = nodes
                .iter()
                .map(|&n| mesh.positions()[n as usize])
                .collect();
            for (shape, area) in gauss_points(&corners) {
                let position: Vec3 = corners.iter().zip(&shape).map(|(x, n)| x * *n).sum();
                let force = traction(&position, area);
                for (&node, share) in nodes.iter().zip(&shape) {
                    *sums.entry(node).or_default() += force * *share;
                }
            }
        }
        let (nodes, forces) = sums.into_iter().unzip();
        Self { nodes, forces }
    }

    fn add(&self, factor: f64, forces: &mut [Vec3]) {
        for (force, share) in forces.iter_mut().zip(&self.forces) {
            *force += share * factor;
        }
    }
}

/// Refuses facets that include both sides of a face, as a set inside a body may.
fn check_sides(mesh: &Mesh, facets: &[Facet]) -> Result<(), EngineError> {
    let mut seen: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    let tag = |element: u32| mesh.element_tags()[element as usize];
    for facet in facets {
        let mut nodes = mesh.facet_nodes(*facet);
        nodes.sort_unstable();
        if let Some(element) = seen.insert(nodes, facet.element) {
            return Err(EngineError::BothSides {
                element: tag(element),
                other: tag(facet.element),
            });
        }
    }
    Ok(())
}

/// The triangles of which a triangle with midpoints consists, whose corners and midpoints are in turn.
const PARTS: [[usize; 3]; 4] = [[0, 1, 5], [1, 2, 3], [5, 3, 4], [1, 3, 5]];

/// Shape functions and outward vector area of the Gauss points of a triangle (three, exact to the
/// second degree; in each of its four parts if it has midpoints) or a quadrilateral (2 x 2, exact to the third in each direction).
fn gauss_points(corners: &[Vec3]) -> Vec<(Vec<f64>, Vec3)> {
    if corners.len() == 3 {
        let area = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])) * 0.5;
        let point = |i: usize| {
            let mut shape = vec![1.0 / 6.0; 3];
            shape[i] = 2.0 / 3.0;
            (shape, area / 3.0)
        };
        return (0..3).map(point).collect();
    }
    if let [a, _, b, _, c, _] = *corners {
        // Four triangles on which the shape functions are linear.
        let area = (b - a).cross(&(c - a)) * 0.125;
        let points = PARTS.iter().flat_map(|part| {
            (0..3).map(move |near| {
                let mut shape = vec![0.0; 6];
                for (i, &node) in part.iter().enumerate() {
                    shape[node] = if i == near { 2.0 / 3.0 } else { 1.0 / 6.0 };
                }
                (shape, area / 3.0)
            })
        });
        return points.collect();
    }
    const SIGNS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let g = 1.0 / 3.0_f64.sqrt();
    SIGNS
        .iter()
        .map(|&(sr, ss)| {
            let (r, s) = (sr * g, ss * g);
            let shape: Vec<f64> = SIGNS
                .iter()
                .map(|(ra, sa)| 0.25 * (1.0 + ra * r) * (1.0 + sa * s))
                .collect();
            let (mut along_r, mut along_s) = (Vec3::zeros(), Vec3::zeros());
            for (corner, (ra, sa)) in corners.iter().zip(SIGNS) {
                along_r += corner * (0.25 * ra * (1.0 + sa * s));
                along_s += corner * (0.25 * sa * (1.0 + ra * r));
            }
            (shape, along_r.cross(&along_s))
        })
        .collect()
}

/// A pressure load on facets, positive against the outward normal.
///
/// ```
/// use powerhouse_elements::{FacePressure, Profile};
/// use powerhouse_model::{ElementKind, Mesh, NodalLoad, Vec3};
/// let mut builder = Mesh::builder();
/// for (tag, corner) in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].iter().enumerate() {
///     builder.node(tag as u64 + 1, Vec3::from(*corner));
/// }
/// builder.element(1, ElementKind::Tet4, &[1, 2, 3, 4], &["rock"]).facet("floor", &[1, 2, 3]);
/// let mesh = builder.build()?;
/// let mut load = FacePressure::new(&mesh, mesh.facet_set("floor")?, Profile::Uniform, Box::new(|_: f64| 6.0))?;
/// let mut forces = vec![Vec3::zeros(); 3];
/// load.add_forces(0.0, &mut forces);
/// // The outward normal of the floor points down, so the pressure acts upwards: 6 Pa on 0.5 m2.
/// assert!((forces[0].z - 1.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct FacePressure {
    shares: Shares,
    history: Box<dyn TimeFunction>,
}

impl FacePressure {
    /// A pressure (Pa) of `profile` times `history` on facets.
    ///
    /// # Errors
    /// If a number of the profile is not finite; [`EngineError::BothSides`] for facets inside a body
    /// that are listed from both sides.
    ///
    /// # Panics
    /// If a facet does not belong to the mesh.
    pub fn new(
        mesh: &Mesh,
        facets: &[Facet],
        profile: Profile,
        history: Box<dyn TimeFunction>,
    ) -> Result<Self, EngineError> {
        profile.check()?;
        check_sides(mesh, facets)?;
        Ok(Self {
            shares: Shares::integrate(mesh, facets, |x, area| -area * profile.at(x)),
            history,
        })
    }
}

impl NodalLoad for FacePressure {
    fn name(&self) -> &str {
        "face pressure"
    }
    fn nodes(&self) -> &[u32] {
        &self.shares.nodes
    }
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]) {
        self.shares.add(self.history.value(time), forces);
    }
    fn is_constant(&self) -> bool {
        self.history.is_constant()
    }
}

/// A traction load of fixed direction on facets.
pub struct FaceTraction {
    shares: Shares,
    history: Box<dyn TimeFunction>,
}

impl FaceTraction {
    /// A force per area (Pa) of `traction` times `profile` times `history` on facets.
    ///
    /// # Errors
    /// If a number of the profile is not finite; [`EngineError::BothSides`] for facets inside a body
    /// that are listed from both sides.
    ///
    /// # Panics
    /// If a facet does not belong to the mesh.
    pub fn new(
        mesh: &Mesh,
        facets: &[Facet],
        traction: Vec3,
        profile: Profile,
        history: Box<dyn TimeFunction>,
    ) -> Result<Self, EngineError> {
        profile.check()?;
        check_sides(mesh, facets)?;
        let of = |x: &Vec3, area: Vec3| traction * (area.norm() * profile.at(x));
        Ok(Self {
            shares: Shares::integrate(mesh, facets, of),
            history,
        })
    }
}

impl NodalLoad for FaceTraction {
    fn name(&self) -> &str {
        "face traction"
    }
    fn nodes(&self) -> &[u32] {
        &self.shares.nodes
    }
    fn add_forces(&mut self, time: f64, forces: &mut [Vec3]) {
        self.shares.add(self.history.value(time), forces);
    }
    fn is_constant(&self) -> bool {
        self.history.is_constant()
    }
}
