//! Input of the prediction of a boundary's error, taken from a scene.

use powerhouse::boundary::Spreading;
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::{Angle, Site, WaveKind};
use powerhouse::{Error, Scene};

use super::band::Band;
use crate::StudyError;

/// Tolerance for points on a side of the bounding box, over the diagonal of the mesh.
const SIDE_TOLERANCE: f64 = 1e-6;

/// Incident plane wave: kind, angle and site.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArrivingWave {
    /// Wave type: P, SV or SH.
    pub kind: WaveKind,
    /// Angle of incidence from the vertical.
    pub incidence: Angle,
    /// Whether the wave travels in a full space, without a free surface.
    pub full_space: bool,
}

/// Excitation of a scene: incident waves or loads.
#[derive(Clone, Debug, PartialEq)]
pub enum Excitation {
    /// Incident plane waves.
    Waves {
        /// The incident waves.
        waves: Vec<ArrivingWave>,
        /// Frequency band of their sum at the surface.
        band: Band,
    },
    /// Applied loads without incident waves.
    Loads {
        /// Duration of the run (s).
        duration: f64,
    },
}

/// Input of the prediction of a boundary's error: ground, size and position of the scatterer, distances of the
/// faces, and excitation.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryProblem {
    /// Elastic medium behind the absorbing faces.
    pub medium: ElasticMedium,
    /// Centre of the scatterer (m).
    pub centre: Vec3,
    /// Radius (m) of the scatterer around its centre; `None` without one.
    ///
    /// The scatterer are the parts that touch no absorbing face and the free facets inside the bounding box. The
    /// radius is that of the section normal to the horizontal axis along which they are longest.
    pub radius: Option<f64>,
    /// Depth of the centre below the free surface (m); `None` without a free surface.
    pub depth: Option<f64>,
    /// Distances (m) from the centre to the nearest absorbing faces, for x, y and z on the lower and on the upper
    /// side; `None` where no face absorbs.
    pub distances: [[Option<f64>; 2]; 3],
    /// Geometrical spreading of scattered waves: cylindrical if no face normal to one of the horizontal axes absorbs.
    pub spreading: Spreading,
    /// Number of nodes on the absorbing faces.
    pub absorbing_nodes: usize,
    /// Number of elements of the scene.
    pub elements: usize,
    /// Excitation: waves or loads.
    pub excitation: Excitation,
}

impl BoundaryProblem {
    /// Takes the input of the prediction from a scene.
    ///
    /// # Errors
    /// A scene without an absorbing boundary, without absorbing sides, with several media behind its absorbing faces,
    /// with a field that is not declared as a sum of plane waves, or without excitation.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        Ok(Self::with_scatterers(scene)?.0)
    }

    /// The same, with the nodes of the scatterer.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub(super) fn with_scatterers(scene: &Scene) -> Result<(Self, Vec<u32>), StudyError> {
        let media = scene.media_behind_boundary()?;
        let &[medium] = &media[..] else {
            return Err(match media.len() {
                0 => StudyError::NoBoundary,
                _ => StudyError::SeveralMedia {
                    media: scene.media_at_faces()?,
                },
            });
        };
        let mesh = scene.mesh();
        let centre = scene.scatterer()?;
        let mut distances = [[None::<f64>; 2]; 3];
        let mut nodes = Vec::new();
        for (_, facets) in scene.absorbing_facets().map_err(Error::from)? {
            nodes.extend(mesh.nodes_of_facets(facets));
            for &facet in facets {
                let geometry = mesh.facet_geometry(facet);
                let normal = geometry.normal();
                let distance = (geometry.centroid - centre).dot(&normal);
                let axis = normal.iamax();
                let side = &mut distances[axis][usize::from(normal[axis] > 0.0)];
                *side = Some(side.map_or(distance, |other| other.min(distance)));
            }
        }
        nodes.sort_unstable();
        nodes.dedup();
        let absorbs = |axis: usize| distances[axis].iter().any(Option::is_some);
        let excitation = excitation(scene)?;
        if !absorbs(0) && !absorbs(1) {
            let faces = scene.absorbing_facets().map_err(Error::from)?;
            let faces = faces.iter().map(|(face, _)| (*face).to_owned());
            return Err(StudyError::NoSides {
                faces: faces.collect(),
            });
        }
        // The horizontal axis along which the section is constant, if there is one.
        let long = (0..2).find(|&axis| !absorbs(axis));
        let top = mesh.bounding_box().1.z;
        let scatterers = scatterers(scene)?;
        let problem = Self {
            medium,
            centre,
            radius: radius(mesh, &scatterers, &centre, long),
            depth: distances[2][1].is_none().then_some(top - centre.z),
            distances,
            spreading: match long {
                Some(_) => Spreading::Cylindrical,
                None => Spreading::Spherical,
            },
            absorbing_nodes: nodes.len(),
            elements: mesh.element_count(),
            excitation,
        };
        Ok((problem, scatterers))
    }

    /// Distance (m) from the centre to the nearest absorbing face normal to a horizontal axis.
    #[must_use]
    pub fn half_width(&self) -> Option<f64> {
        let sides = self.distances[..2].iter().flatten().flatten();
        sides.copied().reduce(f64::min)
    }

    /// Least distance (m) to an absorbing face along each axis; along an axis without one, the least of all.
    #[must_use]
    pub fn least_distances(&self) -> [f64; 3] {
        let all = self.distances.iter().flatten().flatten();
        let least = all.copied().fold(f64::INFINITY, f64::min);
        self.distances.map(|sides| {
            let nearest = sides.into_iter().flatten().reduce(f64::min);
            nearest.unwrap_or(least)
        })
    }
}

/// Nodes of the scatterer: of parts that touch no absorbing face, and of free facets inside the bounding box.
fn scatterers(scene: &Scene) -> Result<Vec<u32>, StudyError> {
    let mesh = scene.mesh();
    let behind = scene.parts_behind_boundary()?;
    let mut nodes = Vec::new();
    for (index, part) in scene.parts().iter().enumerate() {
        if !behind.contains(&index) {
            let elements = mesh.element_set(&part.set).map_err(Error::from)?;
            nodes.extend(mesh.nodes_of_elements(elements));
        }
    }
    nodes.extend(inner_free_surface(scene)?);
    Ok(nodes)
}

/// Nodes of free facets inside the bounding box: walls of openings.
pub(crate) fn inner_free_surface(scene: &Scene) -> Result<Vec<u32>, StudyError> {
    let (mesh, mut nodes) = (scene.mesh(), Vec::new());
    let (low, high) = mesh.bounding_box();
    let tolerance = SIDE_TOLERANCE * (high - low).norm();
    let absorbing = scene.absorbing_facets().map_err(Error::from)?;
    let absorbing: std::collections::HashSet<_> = absorbing
        .iter()
        .flat_map(|(_, facets)| facets.iter())
        .collect();
    for facet in mesh.boundary_facets() {
        let of_facet = mesh.facet_nodes(facet);
        let on_side = (0..3).any(|axis| {
            [low, high].iter().any(|corner| {
                let height = |n: &u32| mesh.positions()[*n as usize][axis] - corner[axis];
                of_facet.iter().all(|node| height(node).abs() <= tolerance)
            })
        });
        if !on_side && !absorbing.contains(&facet) {
            nodes.extend(of_facet);
        }
    }
    Ok(nodes)
}

/// Radius of nodes around a centre, normal to the axis of constant section or to the one along which they are longest.
fn radius(mesh: &Mesh, nodes: &[u32], centre: &Vec3, long: Option<usize>) -> Option<f64> {
    let across = |axis: usize| {
        let distance = |&node: &u32| {
            let mut way = mesh.positions()[node as usize] - centre;
            way[axis] = 0.0;
            way.norm()
        };
        nodes.iter().map(distance).reduce(f64::max)
    };
    match long {
        Some(axis) => across(axis),
        None => across(0).into_iter().chain(across(1)).reduce(f64::min),
    }
}

/// The excitation of a scene.
fn excitation(scene: &Scene) -> Result<Excitation, StudyError> {
    let waves = scene.plane_waves();
    if scene.field().is_some() && waves.is_empty() {
        return Err(StudyError::UnknownField);
    }
    let duration = scene.duration();
    if waves.is_empty() {
        return if scene.is_driven() {
            Ok(Excitation::Loads { duration })
        } else {
            Err(StudyError::NoExcitation)
        };
    }
    let arriving = waves.iter().map(|wave| {
        let parameters = wave.parameters();
        ArrivingWave {
            kind: parameters.kind,
            incidence: parameters.incidence,
            full_space: parameters.site == Site::FullSpace,
        }
    });
    Ok(Excitation::Waves {
        waves: arriving.collect(),
        band: Band::of(scene)?,
    })
}
