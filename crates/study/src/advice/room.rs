//! How near the faces of a scene may come.

use core::fmt;

use powerhouse::Scene;
use powerhouse::model::{AbsorbingBoundary, ParameterError, Vec3};

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
    /// The error that is predicted there.
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
            return writeln!(f, "  no nearer faces meet the stated error");
        };
        writeln!(
            f,
            "  faces at {} of their distance: {} elements ({:.0} %), predicted to err by {:.2} %",
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
    match condition.name() {
        "viscous" => BoundaryKind::Viscous,
        _ => BoundaryKind::Springs { speed_ratio: 1.1 },
    }
}

/// Coordinates are told to a millimetre, outwards.
const DIGITS: f64 = 1e3;

/// Least and greatest coordinate (m) along x, y and z; none where nothing bounds.
pub(crate) type Bounds = [Option<[f64; 2]>; 3];

/// The ground of a scene, as far as it may be cut off.
pub(crate) struct Room<'a> {
    scene: &'a Scene,
    setting: Setting,
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
    /// their centroids in it; none if something that scatters or is recorded would not lie within.
    pub(crate) fn at(&self, share: f64) -> Option<(Bounds, Vec<u32>)> {
        let within = box_at(self.scene, &self.setting, share);
        let (low, high) = corners(&within);
        let inside =
            |position: &Vec3| (0..3).all(|i| low[i] <= position[i] && position[i] <= high[i]);
        let (mesh, recorded) = (self.scene.mesh(), &self.recorded);
        let scatterers = self.scatterers.iter();
        let mut structure = scatterers.map(|&node| &mesh.positions()[node as usize]);
        if !structure.all(inside) || !recorded.points.iter().all(inside) {
            return None;
        }
        let kept = mesh.elements_in_box(&low, &high);
        let nodes = mesh.nodes_of_elements(&kept);
        let holds = |all: &[u32], needed: &[u32]| {
            let mut needed = needed.iter();
            needed.all(|one| all.binary_search(one).is_ok())
        };
        let is_whole = holds(&kept, &recorded.elements) && holds(&nodes, &recorded.nodes);
        (is_whole && !kept.is_empty()).then_some((within, kept))
    }
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

/// How many elements of a scene have their centroids in the box of its faces at a share of their distances.
pub(crate) fn elements_at(scene: &Scene, setting: &Setting, share: f64) -> usize {
    let (low, high) = corners(&box_at(scene, setting, share));
    scene.mesh().elements_in_box(&low, &high).len()
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
    let boundary = scene.absorbing_boundary().ok_or(StudyError::NoBoundary)?;
    let kind = kind_of(boundary.condition.as_ref());
    let mut advice = BoxAdvice {
        title: scene.title().to_owned(),
        error,
        as_it_stands: predicted_error(setting, 1.0, kind)?,
        elements: scene.mesh().element_count(),
        nearer: None,
    };
    if advice.as_it_stands > error || setting.radius.is_none() {
        return Ok(advice);
    }
    for share in SHARES {
        let Some((within, elements)) = room.at(share) else {
            break;
        };
        // What leaves no room for a prediction is too near.
        let Ok(predicted) = predicted_error(setting, share, kind) else {
            break;
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
