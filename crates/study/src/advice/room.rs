//! Reduction of the mesh: how near the absorbing faces may come to the scatterer.

use core::fmt;

use powerhouse::model::{AbsorbingBoundary, BoundarySite, Facet, Mesh, ParameterError, Vec3};
use powerhouse::{Scene, keys};

use super::{BoundaryKind, BoundaryProblem, MOST_WORK, predicted_error};
use crate::StudyError;
use crate::recorded::Recorded;

/// Factors on the distances of the faces that are tried, until the predicted error exceeds the permitted one.
const SHARES: [f64; 7] = [0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3];

/// Predicted error and number of elements with the absorbing faces moved towards the scatterer.
#[derive(Clone, Debug, PartialEq)]
pub struct NearerFaces {
    /// Factor on the distances of the scene's faces from the scatterer, below 1.
    pub share: f64,
    /// Predicted relative error; never below that of faces farther away.
    pub predicted: f64,
    /// Least and greatest coordinate (m) of the reduced box along x, y and z; `None` along an axis without absorbing
    /// faces.
    pub within: [Option<[f64; 2]>; 3],
    /// Number of elements with their centroids in the reduced box.
    pub elements: usize,
}

/// The smallest box of ground of a scene within a permitted error.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxAdvice {
    /// Title of the scene.
    pub title: String,
    /// Permitted relative error, above 0 and at most 1.
    pub error: f64,
    /// Predicted relative error with the faces unchanged.
    pub unchanged: f64,
    /// Number of elements of the scene.
    pub elements: usize,
    /// The nearest faces, of the factors tried, that meet the permitted error and have no obstacle; `None` if no nearer
    /// ones do.
    pub nearer: Option<NearerFaces>,
    /// Reason other than the error why the faces cannot come nearer, if there is one.
    pub obstacle: Option<Obstacle>,
}

impl BoxAdvice {
    /// The `[mesh]` table with the key `within` that cuts the scene's mesh to the recommended box; `None` without nearer
    /// faces.
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
            "  unchanged: {} elements, predicted error {:.2} % (permitted: {:.2} %)",
            self.elements,
            per_cent(self.unchanged),
            per_cent(self.error)
        )?;
        let Some(nearer) = &self.nearer else {
            return match &self.obstacle {
                None => writeln!(f, "  no nearer faces meet the permitted error"),
                Some(obstacle) => writeln!(f, "  no nearer faces are possible: {obstacle}"),
            };
        };
        writeln!(
            f,
            "  faces at {} of their distance: {} elements ({:.0} %), predicted error {:.2} % of displacement and velocity; the errors of small relative displacements, such as closures, and of accelerations may be larger",
            nearer.share,
            nearer.elements,
            per_cent(nearer.elements as f64 / self.elements as f64),
            per_cent(nearer.predicted)
        )?;
        let table = self.table().unwrap_or_default();
        write!(f, "\n{table}")
    }
}

/// The kind of a scene's boundary, for the prediction of its error.
pub(crate) fn kind_of(condition: &dyn AbsorbingBoundary) -> BoundaryKind {
    if condition.name() == keys::VISCOUS {
        return BoundaryKind::Viscous;
    }
    let ratios = condition.speed_ratios().unwrap_or([1.0; 3]);
    // The ratio of the faces with the largest reflection at normal incidence.
    let worst = ratios
        .into_iter()
        .max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()));
    BoundaryKind::Springs {
        speed_ratio: worst.unwrap_or(1.0),
    }
}

/// Steps per metre to which coordinates are rounded outwards: millimetres.
const DIGITS: f64 = 1e3;

/// Least and greatest coordinate (m) along x, y and z; `None` along an unbounded axis.
pub(crate) type Bounds = [Option<[f64; 2]>; 3];

/// A scene's mesh with the nodes, elements and points that a reduced box must contain.
pub(crate) struct BoxReduction<'a> {
    scene: &'a Scene,
    pub(crate) problem: BoundaryProblem,
    /// Nodes of the scatterer.
    scatterers: Vec<u32>,
    recorded: Recorded,
}

impl<'a> BoxReduction<'a> {
    /// Collects what the box of a scene must contain.
    ///
    /// # Errors
    /// As [`BoundaryProblem::of`].
    pub(crate) fn of(scene: &'a Scene) -> Result<Self, StudyError> {
        let (problem, scatterers) = BoundaryProblem::with_scatterers(scene)?;
        Ok(Self {
            scene,
            problem,
            scatterers,
            recorded: Recorded::of(scene),
        })
    }

    /// Adds nodes that the box must contain.
    pub(crate) fn with_nodes(mut self, nodes: impl IntoIterator<Item = u32>) -> Self {
        self.recorded.nodes.extend(nodes);
        self
    }

    /// The box with the distances of the absorbing faces multiplied by `share`, and the elements with their centroids
    /// in it.
    ///
    /// # Errors
    /// [`Obstacle`].
    pub(crate) fn at(&self, share: f64) -> Result<(Bounds, Vec<u32>), Obstacle> {
        let within = box_at(self.scene, &self.problem, share);
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

    /// Checks that the mesh within a box has plane absorbing faces where the scene has some, and that the scene's
    /// boundary can be built on them.
    fn accept(&self, (low, high): (&Vec3, &Vec3)) -> Result<(), Obstacle> {
        let (scene, problem) = (self.scene, &self.problem);
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
        let site = BoundarySite::from_mesh(&cut, &left, |_| problem.medium, problem.centre, None);
        let condition = scene.boundary().map(|b| b.condition.build(&site));
        match condition {
            Some(Err(reason)) => Err(Obstacle::Refused {
                reason: reason.to_string(),
            }),
            _ => Ok(()),
        }
    }
}

/// Reason other than the predicted error why the absorbing faces cannot be moved to a reduced box.
#[derive(Clone, Debug, PartialEq)]
pub enum Obstacle {
    /// A part of the scatterer or a recorded point would lie outside.
    Needed,
    /// The elements before a face are not in plane layers, so that the cut face would have steps.
    Steps {
        /// Name of the face.
        face: String,
    },
    /// The scene's boundary cannot be built on the reduced faces.
    Refused {
        /// Message of the boundary.
        reason: String,
    },
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Needed => write!(
                f,
                "a part of the scatterer or a recorded point would lie outside"
            ),
            Self::Steps { face } => write!(
                f,
                "the elements before the face '{face}' are not in plane layers: cut by their centroids it would have steps"
            ),
            Self::Refused { reason } => write!(f, "the boundary cannot be built there: {reason}"),
        }
    }
}

/// Decrease of [`flatness`] from which on a face counts as stepped.
const STEPPED: f64 = 1e-3;

/// Norm of the vector area of facets over the sum of their areas: 1 for plane facets.
fn flatness(mesh: &Mesh, facets: &[Facet]) -> f64 {
    let areas = facets
        .iter()
        .map(|&facet| mesh.facet_geometry(facet).vector_area);
    let (sum, all) = areas.fold((Vec3::zeros(), 0.0), |(sum, all), area| {
        (sum + area, all + area.norm())
    });
    if all > 0.0 { sum.norm() / all } else { 0.0 }
}

/// The box with the distances of the absorbing faces multiplied by `share`, rounded outwards.
fn box_at(scene: &Scene, problem: &BoundaryProblem, share: f64) -> Bounds {
    let (least, greatest) = scene.mesh().bounding_box();
    [0, 1, 2].map(|axis| {
        let [below, above] = problem.distances[axis];
        let centre = problem.centre[axis];
        let low = below.map_or(least[axis], |way| centre - share * way);
        let high = above.map_or(greatest[axis], |way| centre + share * way);
        let outwards = [(low * DIGITS).floor(), (high * DIGITS).ceil()];
        (below.is_some() || above.is_some()).then_some(outwards.map(|end| end / DIGITS))
    })
}

/// The lower and the upper corner of a box, infinite along unbounded axes.
fn corners(within: &Bounds) -> (Vec3, Vec3) {
    let end = |end: usize, otherwise: f64| {
        Vec3::from(within.map(|pair| pair.map_or(otherwise, |pair| pair[end])))
    };
    (end(0, f64::NEG_INFINITY), end(1, f64::INFINITY))
}

/// Finds the smallest box of ground whose predicted error is within a permitted relative error (above 0, at most 1).
///
/// The distances of all absorbing faces from the scatterer are multiplied by one factor, and the error is predicted
/// as [`advise_boundary`](super::advise_boundary) predicts it, for dashpots or springs. The scatterer and all recorded
/// points stay within; the faces of the reduced mesh lie within half an element of the box.
///
/// # Errors
/// As [`advise_boundary`](super::advise_boundary).
///
/// ```no_run
/// use powerhouse::FileScene;
/// let scene = FileScene::from_file("data/scenes/cavern_small.toml")?;
/// let advice = powerhouse_study::advise_box(&scene, 0.05)?;
/// println!("{}", advice.table().unwrap_or_default());
/// # Ok::<(), powerhouse_study::StudyError>(())
/// ```
pub fn advise_box(scene: &Scene, error: f64) -> Result<BoxAdvice, StudyError> {
    ParameterError::check("error", error, f64::MIN_POSITIVE, 1.0)?;
    let reduction = BoxReduction::of(scene)?;
    let problem = &reduction.problem;
    let boundary = scene.boundary().ok_or(StudyError::NoBoundary)?;
    let kind = kind_of(boundary.condition.as_ref());
    let mut advice = BoxAdvice {
        title: scene.title().to_owned(),
        error,
        unchanged: predicted_error(problem, 1.0, &kind, MOST_WORK)?,
        elements: scene.mesh().element_count(),
        nearer: None,
        obstacle: None,
    };
    if advice.unchanged > error || problem.radius.is_none() {
        return Ok(advice);
    }
    for share in SHARES {
        let (within, elements) = match reduction.at(share) {
            Ok(found) => found,
            Err(obstacle) => {
                advice.obstacle = Some(obstacle);
                break;
            }
        };
        // Faces too near for the substitute model.
        let Ok(predicted) = predicted_error(problem, share, &kind, MOST_WORK) else {
            break;
        };
        // Reflections may cancel by chance: nearer faces are never taken to have a smaller error than farther ones.
        let farther = (advice.nearer.as_ref()).map_or(advice.unchanged, |found| found.predicted);
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
