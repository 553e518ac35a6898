//! What of a scene decides how much a boundary costs.

use powerhouse::boundary::Spreading;
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::{Angle, Site, WaveKind};
use powerhouse::{Error, Scene};

use super::band::Band;
use crate::StudyError;

/// What lies within this share of the mesh's diagonal of a side of its box lies on it.
const SIDE_TOLERANCE: f64 = 1e-6;

/// A plane wave that comes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArrivingWave {
    /// Its kind.
    pub kind: WaveKind,
    /// Its angle from the vertical.
    pub incidence: Angle,
    /// Whether it travels without a free surface.
    pub full_space: bool,
}

/// What moves the body.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Plane waves, and the frequencies of their motion.
    Waves {
        /// The waves.
        waves: Vec<ArrivingWave>,
        /// The frequencies of their sum at the surface.
        band: Band,
    },
    /// Loads, for so long (s).
    Loads {
        /// The duration of the run.
        duration: f64,
    },
}

/// What of a scene decides how much a boundary costs: its ground, the size and place of what scatters,
/// how far the faces are, and what comes in.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The ground behind the absorbing faces.
    pub medium: ElasticMedium,
    /// The centre of what scatters (m).
    pub centre: Vec3,
    /// Radius (m) around that centre of all that scatters: of parts that touch no absorbing face, and of
    /// free facets inside the mesh's box. It is that of the section across the horizontal axis along which
    /// the structure is longest: one that is as long as the ground scatters more. None if nothing does.
    pub radius: Option<f64>,
    /// Depth of the centre below the free surface (m); none without a free surface.
    pub depth: Option<f64>,
    /// Distance from the centre to the nearest absorbing face across x, y and z, of each axis the lower
    /// side and the upper one (m); none where nothing absorbs.
    pub distances: [[Option<f64>; 2]; 3],
    /// How scattered waves spread: as cylinders if no face across one of the horizontal axes absorbs.
    pub spreading: Spreading,
    /// Nodes of the absorbing faces.
    pub absorbing_nodes: usize,
    /// Elements of the scene.
    pub elements: usize,
    /// What moves the body.
    pub drive: Drive,
}

impl Setting {
    /// The setting of a scene.
    ///
    /// # Errors
    /// A scene without an absorbing boundary, one without absorbing sides, or whose ground is of several
    /// media; a field that is not known to be made of plane waves; one in which nothing moves.
    pub fn of(scene: &Scene) -> Result<Self, StudyError> {
        Ok(Self::with_scatterers(scene)?.0)
    }

    /// The same, and the nodes of what scatters.
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
        let drive = drive(scene)?;
        if !absorbs(0) && !absorbs(1) {
            let faces = scene.absorbing_facets().map_err(Error::from)?;
            let faces = faces.iter().map(|(face, _)| (*face).to_owned());
            return Err(StudyError::NoSides {
                faces: faces.collect(),
            });
        }
        // The axis along which the body goes on as it is.
        let long = (0..2).find(|&axis| !absorbs(axis));
        let top = mesh.bounding_box().1.z;
        let scatterers = scatterers(scene)?;
        let setting = Self {
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
            drive,
        };
        Ok((setting, scatterers))
    }

    /// Distance to the nearest absorbing face across a horizontal axis (m).
    #[must_use]
    pub fn half_width(&self) -> Option<f64> {
        let sides = self.distances[..2].iter().flatten().flatten();
        sides.copied().reduce(f64::min)
    }

    /// The least distance across each axis (m); where nothing absorbs, the least of all.
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

/// Nodes of what scatters: of parts that touch no absorbing face, and of free facets inside the mesh's box.
fn scatterers(scene: &Scene) -> Result<Vec<u32>, StudyError> {
    let mesh = scene.mesh();
    let behind = scene.parts_behind_boundary()?;
    let mut nodes = Vec::new();
    for (place, part) in scene.parts().iter().enumerate() {
        if !behind.contains(&place) {
            let elements = mesh.element_set(&part.set).map_err(Error::from)?;
            nodes.extend(mesh.nodes_of_elements(elements));
        }
    }
    nodes.extend(inner_free_surface(scene)?);
    Ok(nodes)
}

/// Nodes of facets that are free and lie inside the box of a mesh: of openings.
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

/// How far from a centre that which scatters reaches, across the axis along which it goes on, or across
/// that along which it is longest.
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

/// What moves the body of a scene.
fn drive(scene: &Scene) -> Result<Drive, StudyError> {
    let waves = scene.plane_waves();
    if scene.field().is_some() && waves.is_empty() {
        return Err(StudyError::UnknownField);
    }
    let duration = scene.duration();
    if waves.is_empty() {
        return match scene.is_driven() {
            true => Ok(Drive::Loads { duration }),
            false => Err(StudyError::Undriven),
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
    Ok(Drive::Waves {
        waves: arriving.collect(),
        band: Band::of(scene)?,
    })
}
