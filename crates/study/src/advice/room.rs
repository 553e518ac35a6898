//! How near the faces of a scene may come.

use core::fmt;

use powerhouse::boundary::ViscousSpring;
use powerhouse::model::{AbsorbingBoundary, BoundarySite, Facet, Mesh, ParameterError, Vec3};
use powerhouse::{Scene, keys};

use super::{BoundaryKind, Setting, predicted_error};
use crate::StudyError;
use crate::recorded::Recorded;

/// Shares of their distance at which faces are looked at, until one errs too much.
const SHARES: [f64; 7] = [0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3];

/// Faces that are nearer to what scatters.
#[derive(Clone, Debug, PartialEq)]
pub struct NearerFaces {
    /// Their share of the scene's distances.
    pub share: f64,
    /// The error that is predicted there, at least that of farther faces.
    pub predicted: f64,
    /// Least and greatest coordinate (m) of the box along x, y and z; none where no face absorbs.
    pub within: [Option<[f64; 2]>; 3],
    /// Elements with their centroids in it.
    pub elements: usize,
}

/// How much of its ground a scene needs for a stated error.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxAdvice {
    /// The scene's title.
    pub title: String,
    /// The stated error.
    pub error: f64,
    /// The error that is predicted with the faces where they are.
    pub as_it_stands: f64,
    /// Elements of the scene.
    pub elements: usize,
    /// The nearest faces that meet the stated error, if any nearer ones do.
    pub nearer: Option<NearerFaces>,
    /// What keeps faces from coming nearer still, beside the error.
    pub obstacle: Option<Obstacle>,
}

impl BoxAdvice {
    /// The key of `[mesh]` by which a scene has these faces.
    #[must_use]
    pub fn table(&self) -> Option<String> {
        let within = self.nearer.as_ref()?.within.iter();
        let named = within.zip(["x", "y", "z"]);
        let pairs = named.filter_map(|(pair, name)| {
            let [low, high] = (*pair)?;
            Some(format!("{name} = [{low:.3}, {high:.3}]"))
        });
        let pairs: Vec<String> = pairs.collect();
        Some(format!("[mesh]\nwithin = {{ {} }}\n", pairs.join(", ")))
    }
}

impl fmt::Display for BoxAdvice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        let per_cent = |share: f64| 100.0 * share;
        writeln!(
            f,
            "  as it stands: {} elements, predicted to err by {:.2} % (stated: {:.2} %)",
            self.elements,
            per_cent(self.as_it_stands),
            per_cent(self.error)
        )?;
        let Some(nearer) = &self.nearer else {
            return match &self.obstacle {
                None => writeln!(f, "  no nearer faces meet the stated error"),
                Some(obstacle) => writeln!(f, "  no nearer faces are possible: {obstacle}"),
            };
        };
        writeln!(
            f,
            "  faces at {} of their distance: {} elements ({:.0} %), predicted to err by {:.2} % in displacement and velocity; small differences between places, such as closures, and accelerations may err by more",
            nearer.share,
            nearer.elements,
            per_cent(nearer.elements as f64 / self.elements as f64),
            per_cent(nearer.predicted)
        )?;
        let table = self.table().unwrap_or_default();
        write!(f, "\n{table}")
    }
}

/// The kind of a scene's boundary, as predictions have it.
pub(crate) fn kind_of(condition: &dyn AbsorbingBoundary) -> BoundaryKind {
    if condition.name() == keys::VISCOUS {
        return BoundaryKind::Viscous;
    }
    let known = condition.as_any();
    let known = known.and_then(|any| any.downcast_ref::<ViscousSpring>());
    let default = ViscousSpring::default();
    let ratios = (known.unwrap_or(&default).axes).map(|axis| axis.speed_ratio);
    // That of the faces which return most straight on.
    let worst = ratios
        .into_iter()
        .max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()));
    BoundaryKind::Springs {
        speed_ratio: worst.unwrap_or(1.0),
    }
}

/// Coordinates are told to a millimetre, outwards.
const DIGITS: f64 = 1e3;

/// Least and greatest coordinate (m) along x, y and z; none where nothing bounds.
pub(crate) type Bounds = [Option<[f64; 2]>; 3];

/// The ground of a scene, as far as it may be cut off.
pub(crate) struct Room<'a> {
    scene: &'a Scene,
    pub(crate) setting: Setting,
    /// Nodes of what scatters.
    scatterers: Vec<u32>,
    recorded: Recorded,
}

impl<'a> Room<'a> {
    /// # Errors
    /// As [`Setting::of`].
    pub(crate) fn of(scene: &'a Scene) -> Result<Self, StudyError> {
        let (setting, scatterers) = Setting::with_scatterers(scene)?;
        Ok(Self {
            scene,
            setting,
            scatterers,
            recorded: Recorded::of(scene),
        })
    }

    /// The same where more nodes are needed.
    pub(crate) fn with_nodes(mut self, nodes: impl IntoIterator<Item = u32>) -> Self {
        self.recorded.nodes.extend(nodes);
        self
    }

    /// The box of the faces at a share of their distances, along the axes where some absorb, and the elements with
    /// their centroids in it.
    ///
    /// # Errors
    /// [`Obstacle`].
    pub(crate) fn at(&self, share: f64) -> Result<(Bounds, Vec<u32>), Obstacle> {
        let within = box_at(self.scene, &self.setting, share);
        let (low, high) = corners(&within);
        let inside =
            |position: &Vec3| (0..3).all(|i| low[i] <= position[i] && position[i] <= high[i]);
        let (mesh, recorded) = (self.scene.mesh(), &self.recorded);
        let scatterers = self.scatterers.iter();
        let mut structure = scatterers.map(|&node| &mesh.positions()[node as usize]);
        if !structure.all(inside) || !recorded.points.iter().all(inside) {
            return Err(Obstacle::Needed);
        }
        let kept = mesh.elements_in_box(&low, &high);
        let nodes = mesh.nodes_of_elements(&kept);
        let holds = |all: &[u32], needed: &[u32]| {
            let mut needed = needed.iter();
            needed.all(|one| all.binary_search(one).is_ok())
        };
        let is_whole = holds(&kept, &recorded.elements) && holds(&nodes, &recorded.nodes);
        if !is_whole || kept.is_empty() {
            return Err(Obstacle::Needed);
        }
        self.accept((&low, &high))?;
        Ok((within, kept))
    }

    /// Sees that the mesh in a box has plane absorbing faces where the scene has some, on which its boundary
    /// can stand.
    fn accept(&self, (low, high): (&Vec3, &Vec3)) -> Result<(), Obstacle> {
        let (scene, setting) = (self.scene, &self.setting);
        let faces = scene.absorbing_facets().unwrap_or_default();
        let cut = scene
            .mesh()
            .within(low, high)
            .map_err(|_| Obstacle::Needed)?;
        let mut left = Vec::with_capacity(faces.len());
        for (face, before) in &faces {
            let facets = cut.facet_set(face).unwrap_or_default();
            let is_plane = flatness(scene.mesh(), before) - flatness(&cut, facets) < STEPPED;
            if facets.is_empty() || !is_plane {
                return Err(Obstacle::Steps {
                    face: (*face).to_owned(),
                });
            }
            left.push((*face, facets));
        }
        let site = BoundarySite::from_mesh(&cut, &left, |_| setting.medium, setting.centre, None);
        let condition = scene.boundary().map(|b| b.condition.build(&site));
        match condition {
            Some(Err(reason)) => Err(Obstacle::Refused {
                reason: reason.to_string(),
            }),
            _ => Ok(()),
        }
    }
}

/// Why faces cannot stand where a box would put them.
#[derive(Clone, Debug, PartialEq)]
pub enum Obstacle {
    /// Something that scatters or is recorded would not lie within.
    Needed,
    /// The elements do not stand in plane layers before a face: cut by their centroids it would have steps.
    Steps {
        /// The face.
        face: String,
    },
    /// The boundary cannot stand there.
    Refused {
        /// What it says.
        reason: String,
    },
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Needed => write!(f, "what scatters or is recorded would not lie within"),
            Self::Steps { face } => write!(
                f,
                "the elements before the face '{face}' do not stand in plane layers: cut by their centroids it would have steps"
            ),
            Self::Refused { reason } => write!(f, "the boundary cannot stand there: {reason}"),
        }
    }
}

/// By so much less a face with steps is flat.
const STEPPED: f64 = 1e-3;

/// The size of the vector area of facets over their area: 1 for plane ones.
fn flatness(mesh: &Mesh, facets: &[Facet]) -> f64 {
    let areas = facets
        .iter()
        .map(|&facet| mesh.facet_geometry(facet).vector_area);
    let (sum, all) = areas.fold((Vec3::zeros(), 0.0), |(sum, all), area| {
        (sum + area, all + area.norm())
    });
    if all > 0.0 { sum.norm() / all } else { 0.0 }
}

/// The box of a scene's faces at a share of their distances, along the axes where some absorb.
fn box_at(scene: &Scene, setting: &Setting, share: f64) -> Bounds {
    let (least, greatest) = scene.mesh().bounding_box();
    [0, 1, 2].map(|axis| {
        let [below, above] = setting.distances[axis];
        let centre = setting.centre[axis];
        let low = below.map_or(least[axis], |way| centre - share * way);
        let high = above.map_or(greatest[axis], |way| centre + share * way);
        let outwards = [(low * DIGITS).floor(), (high * DIGITS).ceil()];
        (below.is_some() || above.is_some()).then_some(outwards.map(|end| end / DIGITS))
    })
}

/// The corners of a box, without end where it has no bounds.
fn corners(within: &Bounds) -> (Vec3, Vec3) {
    let end = |end: usize, otherwise: f64| {
        Vec3::from(within.map(|pair| pair.map_or(otherwise, |pair| pair[end])))
    };
    (end(0, f64::NEG_INFINITY), end(1, f64::INFINITY))
}

/// How near the absorbing faces of a scene may come to what scatters, all by one share of their distances,
/// for an error that is predicted as [`advise_boundary`](super::advise_boundary) predicts it, of dashpots or of
/// springs. What scatters, and what is recorded, stay within; the faces of the mesh that is left
/// stand within half an element of the box.
///
/// # Errors
/// As [`advise_boundary`](super::advise_boundary).
///
/// ```no_run
/// use powerhouse::Scene;
/// let scene = Scene::from_file("data/scenes/cavern_small.toml")?;
/// let advice = powerhouse_study::advise_box(&scene, 0.05)?;
/// println!("{}", advice.table().unwrap_or_default());
/// # Ok::<(), powerhouse_study::StudyError>(())
/// ```
pub fn advise_box(scene: &Scene, error: f64) -> Result<BoxAdvice, StudyError> {
    ParameterError::check("error", error, f64::MIN_POSITIVE, 1.0)?;
    let room = Room::of(scene)?;
    let setting = &room.setting;
    let boundary = scene.boundary().ok_or(StudyError::NoBoundary)?;
    let kind = kind_of(boundary.condition.as_ref());
    let mut advice = BoxAdvice {
        title: scene.title().to_owned(),
        error,
        as_it_stands: predicted_error(setting, 1.0, &kind)?,
        elements: scene.mesh().element_count(),
        nearer: None,
        obstacle: None,
    };
    if advice.as_it_stands > error || setting.radius.is_none() {
        return Ok(advice);
    }
    for share in SHARES {
        let (within, elements) = match room.at(share) {
            Ok(found) => found,
            Err(obstacle) => {
                advice.obstacle = Some(obstacle);
                break;
            }
        };
        // What leaves no room for a prediction is too near.
        let Ok(predicted) = predicted_error(setting, share, &kind) else {
            break;
        };
        // Waves that return may happen to cancel: nearer faces are not taken to err less than farther ones.
        let farther = (advice.nearer.as_ref()).map_or(advice.as_it_stands, |found| found.predicted);
        let predicted = if predicted < farther {
            farther
        } else {
            predicted
        };
        if !predicted.is_finite() || predicted > error {
            break;
        }
        advice.nearer = Some(NearerFaces {
            share,
            predicted,
            within,
            elements: elements.len(),
        });
    }
    Ok(advice)
}
