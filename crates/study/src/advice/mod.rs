//! Which absorbing boundary a scene needs for a stated error, and how much ground.
//!
//! # What is predicted
//! The error of a boundary is by how much displacement and velocity differ from those with so much more
//! ground around that nothing comes back from its faces in time: `sqrt(sum |x - y|^2 / sum |y|^2)` over
//! the run, the larger of both at the worst place that is recorded; under loads displacement alone, since
//! the velocity under a sudden load is that of the shortest waves of the mesh. A run of the scene and one of the
//! same mesh [`grown`](fn@crate::grown) measure it ([`probe_errors`](crate::probe_errors)).
//!
//! It is predicted by running a small model of the same question: in place of the structure a circular
//! opening of its radius, at its depth, in a slice of ground one element thick with the scene's ground
//! and the distances of its nearest faces, under the scene's waves. One pulse carries all frequencies;
//! spectra weigh them as the scene's own motion has them. Loads become a sudden, lasting pressure in the
//! opening, or in a sphere where waves spread to all sides.
//!
//! # Why so
//! *By a run, not by a formula.* Closed forms tell what a face returns of a plane wave at an angle. How
//! much of the motion scatters, at which angles it arrives, what surface waves do at a face (they carry
//! most of what comes back to a shallow opening, and have no closed form there), and how much of what
//! is returned is felt at the structure: a slice of some thousand elements knows all of it in seconds.
//!
//! *On the safe side by its kind, not by factors.* An opening scatters at least as much as a structure
//! of its size; waves in a slice decay with the root of the distance, those of a compact structure with
//! the distance; the nearest face stands for all. Shorter waves than the slice carries are left out,
//! of which springs return less than of the longer ones.
//!
//! *A body under weight, or one that went through stages, must be held*: dashpots alone, which let it drift,
//! are no candidate for it.
//!
//! *Costs are alike.* All of these boundaries are springs and dashpots in the velocity solve of their
//! nodes: they differ in what they return, not in what they cost, and the one that errs least among
//! those of one cost is named. A field that enters through a layer (`region` in a scene) is not among
//! them: its boundary returns what it returns with any input.

mod band;
mod candidate;
mod opening;
mod report;
mod room;
mod setting;
mod shell;

pub use band::Band;
pub use candidate::{BoundaryKind, RegisteredBoundary, Standing};
pub(crate) use room::{Bounds, Room, kind_of};
pub use room::{BoxAdvice, NearerFaces, Obstacle, advise_box};
pub(crate) use setting::inner_free_surface;
pub use setting::{ArrivingWave, Drive, Setting};

use std::sync::Arc;

use powerhouse::boundary::Spreading;
use powerhouse::model::{AbsorbingBoundary, ModelError, ParameterError};
use powerhouse::{Error, Scene};

use crate::StudyError;
use opening::{Mover, Opening};
use shell::Shell;

/// Nanoseconds of springs and dashpots per node and step (example `boundary_price`), and of the input of
/// a wave with what the surface reflects of it, below and past the critical angle (`cargo bench --bench
/// boundary`); one thread, double precision.
const NODE_NANOSECONDS: f64 = 40.0;
const WAVE_NANOSECONDS: [f64; 2] = [24.0, 38.0];
/// Nanoseconds of an elastic brick and step (`cargo bench --bench step`).
const ELEMENT_NANOSECONDS: f64 = 31.0;
/// So many times farther are the faces moved where no boundary is good enough.
const FARTHER: [f64; 2] = [1.5, 2.0];

/// What a boundary is predicted to return and to cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The boundary.
    pub kind: BoundaryKind,
    /// The error that it is predicted to make: see the module.
    pub predicted: f64,
    /// Nanoseconds per absorbing node and step, with the waves that come in.
    pub nanoseconds: f64,
    /// The same of all nodes over an elastic step of the scene's elements.
    pub share_of_step: f64,
    /// Elements that it adds.
    pub extra_elements: usize,
    /// The stable step with it over that without: dashpots and springs stand in the velocity solve.
    pub stable_step: f64,
    /// Shares of P and SV waves that come straight on at the mean frequency which it returns at the
    /// nearest face, by the closed form.
    pub returned: [f64; 2],
}

/// Faces that are farther away.
#[derive(Clone, Debug, PartialEq)]
pub struct FartherFaces {
    /// The boundary on them.
    pub kind: BoundaryKind,
    /// So many times as far as the scene's.
    pub times: f64,
    /// The error that is predicted there.
    pub predicted: f64,
}

/// A registered boundary that is no candidate.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LeftOut {
    /// Its name in the registry.
    pub name: String,
    /// Why it is none.
    pub reason: String,
}

impl LeftOut {
    fn new(name: &str, reason: &str) -> Self {
        Self {
            name: name.into(),
            reason: reason.into(),
        }
    }
}

/// Which boundary a scene needs.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryAdvice {
    /// The scene's title.
    pub title: String,
    /// What decides.
    pub setting: Setting,
    /// The stated error.
    pub error: f64,
    /// All candidates, the best first: those that meet the error by cost and then by error, the others
    /// by error.
    pub candidates: Vec<Candidate>,
    /// Without one that meets it: how far the faces would have to be, as far as was tried.
    pub farther: Option<FartherFaces>,
    /// Elements of the model that was run, and of its enlarged twin; none if nothing scatters.
    pub model: Option<[usize; 2]>,
    /// The highest frequency that it carried (Hz).
    pub highest: f64,
    /// Boundaries of the scene's registry that are no candidates, and why.
    pub left_out: Vec<LeftOut>,
    /// Names of the faces of the bottom.
    bottom: Vec<String>,
    faces: Vec<String>,
    standing: Standing,
}

impl BoundaryAdvice {
    /// The boundary that is named: the cheapest whose predicted error is the stated one or less.
    #[must_use]
    pub fn named(&self) -> Option<&Candidate> {
        let first = self.candidates.first();
        first.filter(|first| first.predicted <= self.error)
    }

    /// A candidate as the scene would have it.
    ///
    /// # Errors
    /// None but for faces at the structure itself.
    pub fn condition(&self, kind: &BoundaryKind) -> Result<Arc<dyn AbsorbingBoundary>, StudyError> {
        let condition = kind.condition(&self.standing, &self.bottom);
        Ok(condition.map_err(Error::from)?)
    }
}

/// The cheapest absorbing boundary of a scene that is predicted to err by no more than a share.
///
/// # Errors
/// A scene without a boundary, or in which nothing moves; a field that is not known to be made of plane
/// waves ([`Scene::with_plane_waves`] says so); faces that leave no room for a prediction.
pub fn advise_boundary(scene: &Scene, error: f64) -> Result<BoundaryAdvice, StudyError> {
    ParameterError::check("error", error, f64::MIN_POSITIVE, 1.0)?;
    let setting = Setting::of(scene)?;
    let faces = scene.boundary().map_or(Vec::new(), |b| b.faces.clone());
    let bottom = bottom_faces(scene)?;
    // What lasts would push the body away.
    let holds = |kind: &BoundaryKind| kind.holds() || !scene.is_loaded_for_good();
    let mut kinds: Vec<BoundaryKind> = (BoundaryKind::BUILT_IN.into_iter())
        .filter(|kind| *kind != BoundaryKind::IncidentOnly || has_reflections(&setting, &bottom))
        .filter(holds)
        .collect();
    let mut found = predictions(&setting, 1.0, &kinds)?;
    let distances = setting.least_distances();
    let standing = Standing {
        medium: setting.medium,
        spreading: setting.spreading,
        distances,
    };
    let mut left_out = Vec::new();
    for name in scene
        .registry()
        .iter()
        .flat_map(|all| all.added_boundary_names())
    {
        match registered(scene, name, &setting, &standing) {
            Ok((kind, error)) if holds(&kind) => {
                kinds.push(kind);
                found.errors.push(error);
            }
            Ok(_) => left_out.push(LeftOut::new(name, "it does not hold the body")),
            Err(error) => left_out.push(LeftOut::new(name, &error.to_string())),
        }
    }
    let nearest = distances.into_iter().fold(f64::INFINITY, f64::min);
    let mean = match &setting.drive {
        Drive::Waves { band, .. } => band.mean(),
        Drive::Loads { .. } => found.highest,
    };
    let nanoseconds = NODE_NANOSECONDS + input_nanoseconds(&setting);
    let nodes = setting.absorbing_nodes as f64;
    let share_of_step = nodes * nanoseconds / (setting.elements as f64 * ELEMENT_NANOSECONDS);
    let mut candidates = Vec::with_capacity(kinds.len());
    for (kind, predicted) in kinds.iter().zip(&found.errors) {
        candidates.push(Candidate {
            kind: kind.clone(),
            predicted: *predicted,
            nanoseconds,
            share_of_step,
            extra_elements: 0,
            stable_step: 1.0,
            returned: kind
                .returned(&standing, nearest, mean)
                .map_err(Error::from)?,
        });
    }
    rank(&mut candidates, error);
    let mut advice = BoundaryAdvice {
        title: scene.title().to_owned(),
        error,
        candidates,
        farther: None,
        model: found.model,
        highest: found.highest,
        left_out,
        bottom,
        faces,
        standing,
        setting,
    };
    if advice.named().is_none() {
        advice.farther = farther(&advice)?;
    }
    Ok(advice)
}

/// A registered boundary, and the error that it is predicted to make.
fn registered(
    scene: &Scene,
    name: &str,
    setting: &Setting,
    standing: &Standing,
) -> Result<(BoundaryKind, f64), StudyError> {
    let condition = (scene.registry())
        .and_then(|registry| registry.boundary_without_keys(name))
        .ok_or_else(|| ModelError::refused(name, "it needs keys of its own"))
        .map_err(Error::from)?;
    let boundary = RegisteredBoundary::new(name, condition, standing).map_err(Error::from)?;
    let kind = BoundaryKind::Registered(boundary);
    let predicted = predicted_error(setting, 1.0, &kind)?;
    Ok((kind, predicted))
}

/// Best first; sorting keeps the simpler of equals first.
fn rank(candidates: &mut [Candidate], error: f64) {
    candidates.sort_by(|a, b| {
        let misses = |c: &Candidate| c.predicted.is_nan() || c.predicted > error;
        let by_cost = match misses(a) {
            true => core::cmp::Ordering::Equal,
            false => a.nanoseconds.total_cmp(&b.nanoseconds),
        };
        (misses(a).cmp(&misses(b)))
            .then(by_cost)
            .then(a.predicted.total_cmp(&b.predicted))
    });
}

/// What was found of some boundaries.
struct Predictions {
    errors: Vec<f64>,
    model: Option<[usize; 2]>,
    /// The highest frequency (Hz).
    highest: f64,
}

/// The errors of boundaries on faces so many times as far as the setting's.
fn predictions(
    setting: &Setting,
    farther: f64,
    kinds: &[BoundaryKind],
) -> Result<Predictions, StudyError> {
    let Some(radius) = setting.radius else {
        // Nothing scatters: the body moves as the field does, and faces carry nothing.
        return Ok(Predictions {
            errors: vec![0.0; kinds.len()],
            model: None,
            highest: setting.medium.s_speed() / setting.least_distances()[0],
        });
    };
    // Waves as long as what they come from.
    let of_radius = setting.medium.s_speed() / radius;
    match &setting.drive {
        Drive::Loads { duration } => {
            let (errors, model) = match setting.spreading {
                Spreading::Spherical => Shell::of(setting, farther, *duration)?.errors(kinds)?,
                Spreading::Cylindrical => {
                    let band = Band {
                        lines: Vec::new(),
                        highest: of_radius,
                    };
                    Opening::of(setting, farther, &band)?.errors(Mover::Pressure, kinds)?
                }
            };
            Ok(Predictions {
                errors,
                model: Some(model),
                highest: of_radius,
            })
        }
        Drive::Waves { waves, band } => {
            let opening = Opening::of(setting, farther, band)?;
            let mut worst = vec![0.0_f64; kinds.len()];
            let mut model = None;
            for wave in waves {
                let (errors, counts) = opening.errors(Mover::Wave(*wave), kinds)?;
                for (worst, error) in worst.iter_mut().zip(errors) {
                    // What is no number is worse than anything.
                    *worst = if error <= *worst { *worst } else { error };
                }
                model = Some(counts);
            }
            Ok(Predictions {
                errors: worst,
                model,
                highest: opening.highest(),
            })
        }
    }
}

/// The error that a boundary is predicted to make on faces so many times as far as the setting's.
///
/// # Errors
/// Faces that leave no room for a prediction.
pub(crate) fn predicted_error(
    setting: &Setting,
    farther: f64,
    kind: &BoundaryKind,
) -> Result<f64, StudyError> {
    let kind = core::slice::from_ref(kind);
    Ok(predictions(setting, farther, kind)?.errors[0])
}

/// The least distance tried at which the best boundary meets the stated error.
fn farther(advice: &BoundaryAdvice) -> Result<Option<FartherFaces>, StudyError> {
    let Some(best) = advice.candidates.first() else {
        return Ok(None);
    };
    for times in FARTHER {
        let predicted = predicted_error(&advice.setting, times, &best.kind)?;
        if predicted <= advice.error {
            return Ok(Some(FartherFaces {
                kind: best.kind.clone(),
                times,
                predicted,
            }));
        }
    }
    Ok(None)
}

/// Nanoseconds of the waves that come in, per node and step.
fn input_nanoseconds(setting: &Setting) -> f64 {
    let Drive::Waves { waves, .. } = &setting.drive else {
        return 0.0;
    };
    let of_wave = |wave: &ArrivingWave| {
        let ratio = setting.medium.p_speed() * wave.incidence.radians().sin();
        let is_past =
            wave.kind == powerhouse::wavefield::WaveKind::SV && ratio > setting.medium.s_speed();
        WAVE_NANOSECONDS[usize::from(is_past)]
    };
    waves.iter().map(of_wave).sum()
}

/// Whether the surface reflects waves onto a bottom, so that the choice of its input matters.
fn has_reflections(setting: &Setting, bottom: &[String]) -> bool {
    match &setting.drive {
        Drive::Waves { waves, .. } => !bottom.is_empty() && waves.iter().all(|w| !w.full_space),
        Drive::Loads { .. } => false,
    }
}

/// The names of absorbing faces that look down everywhere.
fn bottom_faces(scene: &Scene) -> Result<Vec<String>, StudyError> {
    let mesh = scene.mesh();
    let mut names = Vec::new();
    for (face, facets) in scene.absorbing_facets().map_err(Error::from)? {
        let looks_down = |facet: &_| mesh.facet_geometry(*facet).normal().z < -0.999;
        if !facets.is_empty() && facets.iter().all(looks_down) {
            names.push(face.to_owned());
        }
    }
    Ok(names)
}
