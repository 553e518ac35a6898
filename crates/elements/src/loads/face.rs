//! Pressure and traction loads on faces.

use std::collections::BTreeMap;

use powerhouse_model::{EngineError, Facet, Mesh, NodalLoad, ParameterError, TimeFunction, Vec3};

use super::quadrature::{face_points, points_below};

/// Spatial distribution of a pressure or traction over a face.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Profile {
    /// Uniform over the face.
    Uniform,
    /// Linear in the depth below a horizontal level, `gradient * (level - z)`, and zero above it, as hydrostatic
    /// pressure with the gradient `rho g`. A facet that the level cuts is loaded on its part below it.
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
    /// Shape functions and outward vector areas of the Gauss points of a facet with some corners; of one that the level cuts
    /// those of the part below it.
    fn points(&self, corners: &[Vec3]) -> Vec<(Vec<f64>, Vec3)> {
        match *self {
            Self::Uniform => face_points(corners),
            Self::Depth { level, .. } => points_below(corners, level),
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
    /// Consistent nodal forces `integral of N_a t dA` over facets, by Gauss integration; `traction` is the force on an
    /// outward vector area where the profile is one.
    fn integrate(
        mesh: &Mesh,
        facets: &[Facet],
        profile: &Profile,
        traction: impl Fn(Vec3) -> Vec3,
    ) -> Self {
        let mut sums: BTreeMap<u32, Vec3> = BTreeMap::new();
        for &facet in facets {
            let of_element = mesh.nodes_of(facet.element);
            let side = mesh.kind(facet.element).sides()[facet.side as usize];
            let nodes: Vec<u32> = side.iter().map(|&i| of_element[i as usize]).collect();
            let corners: Vec<Vec3> = nodes
                .iter()
                .map(|&n| mesh.positions()[n as usize])
                .collect();
            for (shape, area) in profile.points(&corners) {
                let position: Vec3 = corners.iter().zip(&shape).map(|(x, n)| x * *n).sum();
                let force = traction(area) * profile.at(&position);
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
pub(super) fn check_sides(mesh: &Mesh, facets: &[Facet]) -> Result<(), EngineError> {
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
            shares: Shares::integrate(mesh, facets, &profile, |area| -area),
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
        let of = |area: Vec3| traction * area.norm();
        Ok(Self {
            shares: Shares::integrate(mesh, facets, &profile, of),
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
