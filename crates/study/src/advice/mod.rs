//! Selection of the absorbing boundary of a scene for a permitted error, and of the extent of its mesh.
//!
//! # What is predicted
//! The error of a boundary is the relative L2 difference `sqrt(sum |x - y|^2 / sum |y|^2)` over the run between
//! the motion `x` with the boundary and the motion `y` in a mesh so large that no reflection arrives within the
//! run. It is the larger of the errors of displacement and velocity at the worst recorded point; under loads that
//! of displacement alone, since the velocity under a sudden load is that of the shortest waves of the mesh. A run
//! of the scene and one of the same mesh [extended](fn@crate::grown) measure it
//! ([`probe_errors`](crate::probe_errors)).
//!
//! It is predicted by running a small substitute model: a circular opening with the radius and the depth of the
//! structure, in a plane-strain slice of the scene's ground with the distances of its nearest faces, under the
//! scene's waves. A pulse excites all frequencies, which are weighted by the spectrum of the scene's motion. Loads
//! are replaced by a pressure step in the opening, or in a spherical cavity where waves spread spherically.
//!
//! # Why so
//! *By a run, not by a formula.* Closed forms give the reflection of a plane wave at an angle. They do not give
//! how much of the motion is scattered, at which angles it arrives, how surface waves are reflected (most of the
//! motion that returns to a shallow opening) and how strongly the reflections act at the structure. A slice of
//! some thousand elements computes all of it in seconds.
//!
//! *Conservative by its choice of model, not by factors.* An opening scatters at least as much as a structure of
//! its size; waves in a slice decay with the root of the distance, those of a compact structure with the distance;
//! all faces are as near as the nearest. Waves shorter than the slice resolves are left out; springs reflect them
//! less than the longer ones.
//!
//! *A body under weight, or after construction stages, needs static stiffness at its boundary*: dashpots alone,
//! with which it drifts, are not compared for it.
//!
//! *Costs are equal.* All of these boundaries are springs and dashpots in the velocity solve of their nodes: they
//! differ in their reflections, not in their cost, and among those of equal cost the one with the least error is
//! recommended. A field that enters through a layer (`region` in a scene) is not compared: the reflections of its
//! boundary do not depend on the input.

mod band;
mod candidate;
mod opening;
mod report;
mod room;
mod setting;
mod shell;

pub use band::Band;
pub use candidate::{BoundaryKind, RegisteredBoundary, Surroundings};
pub(crate) use room::{Bounds, BoxReduction, kind_of};
pub use room::{BoxAdvice, NearerFaces, Obstacle, advise_box};
pub(crate) use setting::inner_free_surface;
pub use setting::{ArrivingWave, BoundaryProblem, Excitation};

use std::sync::Arc;

use powerhouse::boundary::Spreading;
use powerhouse::model::{AbsorbingBoundary, ModelError, ParameterError};
use powerhouse::{Error, FileScene, Scene};

use crate::StudyError;
use opening::{Opening, Source};
use shell::Shell;

/// Time (ns) of springs and dashpots per node and step (example `boundary_price`), and of the input of a wave with
/// its reflections from the surface, below and past the critical angle (`cargo bench --bench boundary`); one
/// thread, double precision.
const NODE_NANOSECONDS: f64 = 40.0;
const WAVE_NANOSECONDS: [f64; 2] = [24.0, 38.0];
/// Time (ns) of an elastic hexahedron and step (`cargo bench --bench step`).
const ELEMENT_NANOSECONDS: f64 = 31.0;
/// Greatest product of elements and steps of the reference of a substitute model, for one wave.
pub(crate) const MOST_WORK: f64 = 1e9;
/// Factors on the distances of the faces that are tried where no boundary meets the permitted error.
const FARTHER: [f64; 2] = [1.5, 2.0];

/// Predicted error, reflection and cost of one absorbing boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Kind of boundary.
    pub kind: BoundaryKind,
    /// Predicted relative error of the motion, as the [module](self) defines it.
    pub predicted: f64,
    /// Estimated wall time (ns) per absorbing node and step, with the input of the incident waves: a sum of measured
    /// constants, not timed on the present machine.
    pub nanoseconds: f64,
    /// Estimated time of all absorbing nodes over that of an elastic step of all elements.
    pub share_of_step: f64,
    /// Number of elements that the boundary adds to the mesh.
    pub extra_elements: usize,
    /// Stable time step with the boundary over that without it; 1, since dashpots and springs are implicit in the
    /// velocity solve.
    pub stable_step: f64,
    /// Amplitude reflection coefficients of P and SV waves at normal incidence on the nearest face, at the mean
    /// frequency of the motion, by the closed form.
    pub reflected: [f64; 2],
}

/// Predicted error with the absorbing faces moved outwards.
#[derive(Clone, Debug, PartialEq)]
pub struct FartherFaces {
    /// Kind of boundary on these faces.
    pub kind: BoundaryKind,
    /// Factor on the distances of the scene's faces from the scatterer, above 1.
    pub times: f64,
    /// Predicted relative error at these distances.
    pub predicted: f64,
}

/// A boundary of a program's registry that is not compared by advice.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LeftOut {
    /// Name of the boundary in the registry.
    pub name: String,
    /// Reason in words: it needs keys, has elements of its own, does not hold a body that its boundary must hold, or the
    /// error with which it was refused.
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

/// Comparison of absorbing boundaries for a scene, with the recommended one.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryAdvice {
    /// Title of the scene.
    pub title: String,
    /// Input of the prediction: ground, scatterer, distances and excitation.
    pub problem: BoundaryProblem,
    /// Permitted relative error, above 0 and at most 1.
    pub error: f64,
    /// All compared boundaries, the best first: those that meet the permitted error by cost and then by error, then
    /// the others by error.
    pub candidates: Vec<Candidate>,
    /// Distances at which the best boundary meets the permitted error, if none does at the scene's and one of those
    /// tried (1.5 and 2 times) does.
    pub farther: Option<FartherFaces>,
    /// Numbers of elements of the substitute model and of its extended reference; `None` if nothing scatters.
    pub model: Option<[usize; 2]>,
    /// Highest frequency of the prediction (Hz): under waves that of the scene's motion, or the highest that the
    /// substitute model resolves if that is lower; under loads the shear wave speed over the scatterer's radius; without
    /// a scatterer over the least distance of a face.
    pub highest: f64,
    /// Boundaries of the scene's registry that are no candidates, and why.
    pub left_out: Vec<LeftOut>,
    /// Names of the bottom faces.
    bottom: Vec<String>,
    faces: Vec<String>,
    surroundings: Surroundings,
}

impl BoundaryAdvice {
    /// The recommended boundary: the cheapest whose predicted error is at most the permitted one.
    #[must_use]
    pub fn recommended(&self) -> Option<&Candidate> {
        let first = self.candidates.first();
        first.filter(|first| first.predicted <= self.error)
    }

    /// Builds one of the compared boundaries for the scene.
    ///
    /// # Errors
    /// A face at the scatterer itself, where the distance is zero.
    pub fn condition(&self, kind: &BoundaryKind) -> Result<Arc<dyn AbsorbingBoundary>, StudyError> {
        let condition = kind.condition(&self.surroundings, &self.bottom);
        Ok(condition.map_err(Error::from)?)
    }
}

/// Compares the absorbing boundaries of a scene by their predicted errors and recommends the cheapest one within a
/// permitted relative error (above 0, at most 1).
///
/// # Errors
/// A scene without an absorbing boundary or without excitation; a field that is not declared as a sum of plane
/// waves ([`Scene::with_plane_waves`]); faces too near to the scatterer for the substitute model.
pub fn advise_boundary(scene: &FileScene, error: f64) -> Result<BoundaryAdvice, StudyError> {
    ParameterError::check("error", error, f64::MIN_POSITIVE, 1.0)?;
    let problem = BoundaryProblem::of(scene)?;
    let faces = scene.boundary().map_or(Vec::new(), |b| b.faces.clone());
    let bottom = bottom_faces(scene)?;
    // A static load would make a body on dashpots drift.
    let holds = |kind: &BoundaryKind| kind.resists_static_loads() || !scene.is_loaded_for_good();
    let mut kinds: Vec<BoundaryKind> = (BoundaryKind::BUILT_IN.into_iter())
        .filter(|kind| *kind != BoundaryKind::IncidentOnly || has_reflections(&problem, &bottom))
        .filter(holds)
        .collect();
    let mut found = predictions(&problem, 1.0, &kinds, MOST_WORK)?;
    let distances = problem.least_distances();
    let surroundings = Surroundings {
        medium: problem.medium,
        spreading: problem.spreading,
        distances,
    };
    let mut left_out = Vec::new();
    for name in scene
        .registry()
        .iter()
        .flat_map(|all| all.added_boundary_names())
    {
        match registered(scene, name, &problem, &surroundings) {
            Ok((kind, error)) if holds(&kind) => {
                kinds.push(kind);
                found.errors.push(error);
            }
            Ok(_) => left_out.push(LeftOut::new(name, "it does not hold the body")),
            Err(error) => left_out.push(LeftOut::new(name, &error.to_string())),
        }
    }
    let nearest = distances.into_iter().fold(f64::INFINITY, f64::min);
    let mean = match &problem.excitation {
        Excitation::Waves { band, .. } => band.mean(),
        Excitation::Loads { .. } => found.highest,
    };
    let nanoseconds = NODE_NANOSECONDS + input_nanoseconds(&problem);
    let nodes = problem.absorbing_nodes as f64;
    let share_of_step = nodes * nanoseconds / (problem.elements as f64 * ELEMENT_NANOSECONDS);
    let mut candidates = Vec::with_capacity(kinds.len());
    for (kind, predicted) in kinds.iter().zip(&found.errors) {
        candidates.push(Candidate {
            kind: kind.clone(),
            predicted: *predicted,
            nanoseconds,
            share_of_step,
            extra_elements: 0,
            stable_step: 1.0,
            reflected: kind
                .reflected(&surroundings, nearest, mean)
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
        surroundings,
        problem,
    };
    if advice.recommended().is_none() {
        advice.farther = farther(&advice)?;
    }
    Ok(advice)
}

/// A registered boundary, and the error that it is predicted to make.
fn registered(
    scene: &FileScene,
    name: &str,
    problem: &BoundaryProblem,
    surroundings: &Surroundings,
) -> Result<(BoundaryKind, f64), StudyError> {
    let condition = (scene.registry())
        .and_then(|registry| registry.boundary_without_keys(name))
        .ok_or_else(|| ModelError::refused(name, "it needs keys of its own"))
        .map_err(Error::from)?;
    let boundary = RegisteredBoundary::new(name, condition, surroundings).map_err(Error::from)?;
    let kind = BoundaryKind::Registered(boundary);
    let predicted = predicted_error(problem, 1.0, &kind, MOST_WORK)?;
    Ok((kind, predicted))
}

/// Sorts the candidates, best first; the stable sort keeps the simpler of equal ones first.
fn rank(candidates: &mut [Candidate], error: f64) {
    candidates.sort_by(|a, b| {
        let misses = |c: &Candidate| c.predicted.is_nan() || c.predicted > error;
        let by_cost = if misses(a) {
            core::cmp::Ordering::Equal
        } else {
            a.nanoseconds.total_cmp(&b.nanoseconds)
        };
        (misses(a).cmp(&misses(b)))
            .then(by_cost)
            .then(a.predicted.total_cmp(&b.predicted))
    });
}

/// Predicted errors of several boundaries.
struct Predictions {
    errors: Vec<f64>,
    model: Option<[usize; 2]>,
    /// Highest resolved frequency (Hz).
    highest: f64,
}

/// Predicts the errors of boundaries with the distances of all faces multiplied by `farther`.
fn predictions(
    problem: &BoundaryProblem,
    farther: f64,
    kinds: &[BoundaryKind],
    most_work: f64,
) -> Result<Predictions, StudyError> {
    let Some(radius) = problem.radius else {
        // Without a scatterer the body moves as the free field does, and no wave reaches the faces from within.
        return Ok(Predictions {
            errors: vec![0.0; kinds.len()],
            model: None,
            highest: problem.medium.s_speed() / problem.least_distances()[0],
        });
    };
    // Shear waves as long as the radius of the scatterer.
    let of_radius = problem.medium.s_speed() / radius;
    match &problem.excitation {
        Excitation::Loads { duration } => {
            let (errors, model) = match problem.spreading {
                Spreading::Spherical => Shell::of(problem, farther, *duration)?.errors(kinds)?,
                Spreading::Cylindrical => {
                    let band = Band {
                        lines: Vec::new(),
                        highest: of_radius,
                    };
                    let opening = Opening::of(problem, farther, &band, most_work)?;
                    opening.errors(Source::Pressure, kinds)?
                }
            };
            Ok(Predictions {
                errors,
                model: Some(model),
                highest: of_radius,
            })
        }
        Excitation::Waves { waves, band } => {
            let opening = Opening::of(problem, farther, band, most_work)?;
            let mut worst = vec![0.0_f64; kinds.len()];
            let mut model = None;
            for wave in waves {
                let (errors, counts) = opening.errors(Source::Wave(*wave), kinds)?;
                for (worst, error) in worst.iter_mut().zip(errors) {
                    // A NaN counts as the worst error.
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

/// Predicts the error of one boundary with the distances of all faces multiplied by `farther`.
///
/// # Errors
/// Faces too near to the scatterer for the substitute model; an opening whose elements and steps have a product above
/// `most_work`.
pub(crate) fn predicted_error(
    problem: &BoundaryProblem,
    farther: f64,
    kind: &BoundaryKind,
    most_work: f64,
) -> Result<f64, StudyError> {
    let kind = core::slice::from_ref(kind);
    Ok(predictions(problem, farther, kind, most_work)?.errors[0])
}

/// The least of the tried distances at which the best boundary meets the permitted error.
fn farther(advice: &BoundaryAdvice) -> Result<Option<FartherFaces>, StudyError> {
    let Some(best) = advice.candidates.first() else {
        return Ok(None);
    };
    for times in FARTHER {
        let predicted = predicted_error(&advice.problem, times, &best.kind, MOST_WORK)?;
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

/// Time (ns) of the input of the incident waves per node and step.
fn input_nanoseconds(problem: &BoundaryProblem) -> f64 {
    let Excitation::Waves { waves, .. } = &problem.excitation else {
        return 0.0;
    };
    let of_wave = |wave: &ArrivingWave| {
        let ratio = problem.medium.p_speed() * wave.incidence.radians().sin();
        let is_past =
            wave.kind == powerhouse::wavefield::WaveKind::SV && ratio > problem.medium.s_speed();
        WAVE_NANOSECONDS[usize::from(is_past)]
    };
    waves.iter().map(of_wave).sum()
}

/// Whether waves reflected by the surface arrive at a bottom face, so that its input mode matters.
fn has_reflections(problem: &BoundaryProblem, bottom: &[String]) -> bool {
    match &problem.excitation {
        Excitation::Waves { waves, .. } => {
            !bottom.is_empty() && waves.iter().all(|w| !w.full_space)
        }
        Excitation::Loads { .. } => false,
    }
}

/// The names of the absorbing faces whose outward normals all point down.
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
