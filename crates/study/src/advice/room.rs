//! How near the faces of a scene may come.

use core::fmt;

use powerhouse::Scene;
use powerhouse::model::{AbsorbingBoundary, ParameterError, Vec3};

use super::{BoundaryKind, Setting, predicted_error};
use crate::StudyError;

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

/// The elements of a scene with their centroids in the box of its faces at a share of their distances, and
/// that box.
pub(crate) fn at_share(scene: &Scene, setting: &Setting, share: f64) -> NearerFaces {
    let mesh = scene.mesh();
    let (least, greatest) = mesh.bounding_box();
    let within = [0, 1, 2].map(|axis| {
        let [below, above] = setting.distances[axis];
        let centre = setting.centre[axis];
        let low = below.map_or(least[axis], |way| centre - share * way);
        let high = above.map_or(greatest[axis], |way| centre + share * way);
        (below.is_some() || above.is_some()).then_some([low, high])
    });
    let bound = |end: usize, otherwise: f64| {
        Vec3::from(within.map(|pair| pair.map_or(otherwise, |pair| pair[end])))
    };
    let (low, high) = (bound(0, f64::NEG_INFINITY), bound(1, f64::INFINITY));
    NearerFaces {
        share,
        predicted: f64::NAN,
        within,
        elements: mesh.elements_in_box(&low, &high).len(),
    }
}

/// How near the absorbing faces of a scene may come to what scatters, all by one share of their distances,
/// for an error that is predicted as [`advise_boundary`](super::advise_boundary) predicts it.
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
    let setting = Setting::of(scene)?;
    let boundary = scene.absorbing_boundary().ok_or(StudyError::NoBoundary)?;
    let kind = kind_of(boundary.condition.as_ref());
    let mut advice = BoxAdvice {
        title: scene.title().to_owned(),
        error,
        as_it_stands: predicted_error(&setting, 1.0, kind)?,
        elements: scene.mesh().element_count(),
        nearer: None,
    };
    if advice.as_it_stands > error {
        return Ok(advice);
    }
    for share in SHARES {
        // What leaves no room for a prediction is too near.
        let Ok(predicted) = predicted_error(&setting, share, kind) else {
            break;
        };
        if !predicted.is_finite() || predicted > error {
            break;
        }
        advice.nearer = Some(NearerFaces {
            predicted,
            ..at_share(scene, &setting, share)
        });
    }
    Ok(advice)
}
