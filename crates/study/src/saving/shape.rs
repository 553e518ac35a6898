//! Smaller bodies with the same response: halves, slices, nearer faces.

use std::collections::{HashMap, HashSet};

use powerhouse::Scene;
use powerhouse::model::{Axis, Mesh, Vec3};
use powerhouse::wavefield::WaveKind;

use super::{BY_COUNT, Change, PredictedError, Saving, delayed};
use crate::StudyError;
use crate::advice::{
    BoundaryKind, BoundaryProblem, BoxReduction, Excitation, kind_of, predicted_error,
};

/// Distance of coincident nodes over the diagonal of the mesh.
const TOLERANCE: f64 = 1e-6;
/// Distance of centroids, projected along an axis, of elements of one column, over the diagonal of the mesh.
const COLUMN: f64 = 1e-5;
/// Component of the direction of travel below which a wave travels normal to an axis.
const ACROSS: f64 = 1e-9;
/// Factor on the distances of the faces.
const NEARER: f64 = 0.75;
/// Relative difference between slice and whole body, measured in the example `plane_slice`; the time ratio is that of
/// the elements within a quarter.
const SLICE_ERROR: f64 = 1e-10;
/// Relative difference between half and whole body, measured in the tests of symmetry planes.
const HALF_ERROR: f64 = 1e-10;

/// Least product of elements and steps that the prediction of nearer faces may take: that of some seconds.
const LEAST_WORK: f64 = 3e7;

/// The savings by halves and slices that the scene allows.
pub(super) fn savings(scene: &Scene) -> Result<Vec<Saving>, StudyError> {
    let mut savings = Vec::new();
    for axis in [Axis::X, Axis::Y] {
        savings.extend(slice(scene, axis)?);
        savings.extend(half(scene, axis)?);
    }
    if !savings.iter().any(is_slice_along_y) {
        savings.extend(delayed::slice(scene)?);
    }
    Ok(savings)
}

fn is_slice_along_y(saving: &Saving) -> bool {
    matches!(saving.change, Change::Slice { axis: Axis::Y, .. })
}

fn of_elements(change: Change, elements: f64, error: PredictedError) -> Saving {
    Saving {
        change,
        steps: 1.0,
        elements,
        time: elements,
        timed: BY_COUNT,
        error,
    }
}

/// Whether all waves are P and SV waves that travel normal to an axis; false for a field that is not declared as a sum
/// of plane waves.
fn travels_across(scene: &Scene, axis: Axis) -> bool {
    let waves = scene.plane_waves();
    let known = scene.field().is_none() || !waves.is_empty();
    known
        && waves.iter().all(|wave| {
            let parameters = wave.parameters();
            let along = parameters.direction()[axis.index()].abs() < ACROSS;
            along && parameters.kind != WaveKind::SH
        })
}

/// Whether an absorbing face is normal to an axis.
fn absorbs_along(scene: &Scene, axis: Axis) -> Result<bool, StudyError> {
    let mesh = scene.mesh();
    let faces = scene.absorbing_facets().map_err(powerhouse::Error::from)?;
    let mut facets = faces.iter().flat_map(|(_, facets)| facets.iter());
    Ok(facets.any(|facet| mesh.facet_geometry(*facet).normal().iamax() == axis.index()))
}

/// Whether there are joints or bolts.
pub(super) fn is_crossed(scene: &Scene) -> Result<bool, StudyError> {
    let stages = scene.stage_overviews()?;
    let bolted = stages.iter().any(|stage| !stage.bolts.is_empty());
    Ok(scene.joints().count() > 0 || bolted)
}

/// Saving by one layer of a body with a constant section along an axis; none with joints or bolts.
fn slice(scene: &Scene, axis: Axis) -> Result<Option<Saving>, StudyError> {
    if is_crossed(scene)? || absorbs_along(scene, axis)? || !travels_across(scene, axis) {
        return Ok(None);
    }
    let mesh = scene.mesh();
    let (low, high) = mesh.bounding_box();
    let at = 0.5 * (low + high)[axis.index()];
    let Ok(layer) = mesh.plane_slice(axis, at) else {
        return Ok(None);
    };
    if !is_same_along(mesh, axis) {
        return Ok(None);
    }
    let elements = layer.element_count() as f64 / mesh.element_count() as f64;
    Ok((elements < 1.0).then(|| {
        let error = PredictedError {
            share: Some(SLICE_ERROR),
            least: None,
            of: "histories".into(),
            source: "not measured on this scene, measured in the example `plane_slice`".into(),
        };
        of_elements(Change::Slice { axis, at }, elements, error)
    }))
}

/// The indices of the element sets to which each element belongs.
fn sets_of_elements(mesh: &Mesh) -> Vec<Vec<usize>> {
    let mut sets = vec![Vec::new(); mesh.element_count()];
    for (index, elements) in mesh.element_sets().values().enumerate() {
        for &element in elements {
            sets[element as usize].push(index);
        }
    }
    sets
}

/// Whether all elements of each column along an axis belong to the same sets.
pub(super) fn is_same_along(mesh: &Mesh, axis: Axis) -> bool {
    let sets = sets_of_elements(mesh);
    let (low, high) = mesh.bounding_box();
    let cell = COLUMN * (high - low).norm();
    let mut columns: HashMap<[i64; 2], &[usize]> = HashMap::new();
    (0..mesh.element_count() as u32).all(|element| {
        let scaled = (mesh.centroid(element) - low) / cell;
        let [a, b] = [(axis.index() + 1) % 3, (axis.index() + 2) % 3];
        let column = [a, b].map(|across| scaled[across].round() as i64);
        let own = &sets[element as usize][..];
        *columns.entry(column).or_insert(own) == own
    })
}

/// Saving by half of a body whose mesh, element sets, absorbing faces and waves are symmetric; none with joints, whose
/// nodes coincide.
fn half(scene: &Scene, axis: Axis) -> Result<Option<Saving>, StudyError> {
    if scene.joints().count() > 0 || !travels_across(scene, axis) {
        return Ok(None);
    }
    let mesh = scene.mesh();
    let (low, high) = mesh.bounding_box();
    let at = 0.5 * (low + high)[axis.index()];
    let Some(images) = images(mesh, axis, at) else {
        return Ok(None);
    };
    let sorted = |nodes: &[u32]| {
        let mut nodes = nodes.to_vec();
        nodes.sort_unstable();
        nodes
    };
    let image = |nodes: &[u32]| {
        let nodes: Vec<u32> = nodes.iter().map(|&node| images[node as usize]).collect();
        sorted(&nodes)
    };
    let sets = sets_of_elements(mesh);
    let elements =
        (0..mesh.element_count() as u32).map(|element| (sorted(mesh.nodes_of(element)), element));
    let elements: HashMap<Vec<u32>, u32> = elements.collect();
    let mut kept = 0;
    for element in 0..mesh.element_count() as u32 {
        let nodes = mesh.nodes_of(element);
        let other = elements.get(&image(nodes));
        if other.is_none_or(|&other| sets[other as usize] != sets[element as usize]) {
            return Ok(None);
        }
        let along = nodes
            .iter()
            .map(|&node| mesh.positions()[node as usize][axis.index()] - at);
        let (from, to) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        let across = TOLERANCE * (high - low).norm();
        if from < -across && to > across {
            return Ok(None);
        }
        kept += usize::from(from >= -across);
    }
    let faces = scene.absorbing_facets().map_err(powerhouse::Error::from)?;
    let absorbing: HashSet<Vec<u32>> = (faces.iter())
        .flat_map(|(_, facets)| facets.iter())
        .map(|facet| sorted(&mesh.facet_nodes(*facet)))
        .collect();
    if absorbing
        .iter()
        .any(|facet| !absorbing.contains(&image(facet)))
    {
        return Ok(None);
    }
    let elements = kept as f64 / mesh.element_count() as f64;
    let error = PredictedError {
        share: Some(HALF_ERROR),
        least: None,
        of: "histories".into(),
        source: "not measured on this scene, measured on halves of cubes".into(),
    };
    Ok(Some(of_elements(
        Change::Half { axis, at },
        elements,
        error,
    )))
}

/// The node at the mirror image of each node; `None` if one has none.
fn images(mesh: &Mesh, axis: Axis, at: f64) -> Option<Vec<u32>> {
    let (low, high) = mesh.bounding_box();
    let cell = TOLERANCE * (high - low).norm();
    let key = |position: &Vec3| {
        let scaled = (position - low) / cell;
        [scaled.x, scaled.y, scaled.z].map(|x| x.round() as i64)
    };
    let nodes: HashMap<[i64; 3], u32> = (0..)
        .zip(mesh.positions())
        .map(|(n, x)| (key(x), n))
        .collect();
    let image = |position: &Vec3| {
        let mut image = *position;
        image[axis.index()] = 2.0 * at - image[axis.index()];
        let [x, y, z] = key(&image);
        // A coordinate may be rounded to either side.
        let beside = [-1, 0, 1].into_iter().flat_map(|i| {
            [-1, 0, 1]
                .into_iter()
                .flat_map(move |j| [-1, 0, 1].map(move |k| [x + i, y + j, z + k]))
        });
        beside.filter_map(|key| nodes.get(&key)).next().copied()
    };
    mesh.positions().iter().map(image).collect()
}

/// A body with faces nearer to its scatterer.
pub(super) struct NearerFaces {
    problem: BoundaryProblem,
    kind: BoundaryKind,
    /// Number of elements over that of the scene.
    share: f64,
}

impl NearerFaces {
    /// Nearer faces that the mesh of a scene allows, and whose error a substitute model predicts.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let kind = kind_of(scene.boundary()?.condition.as_ref());
        let reduction = BoxReduction::of(scene).ok()?;
        // Under loads alone `advise box` makes the prediction.
        let has_waves = matches!(reduction.problem.excitation, Excitation::Waves { .. });
        reduction.problem.radius.filter(|_| has_waves)?;
        let (_, left) = reduction.at(NEARER).ok()?;
        Some(Self {
            kind,
            share: left.len() as f64 / scene.mesh().element_count() as f64,
            problem: reduction.problem,
        })
    }

    /// The saving, with the error that the substitute model predicts if that takes no more elements and steps than the
    /// run, whose product of both is given.
    pub(super) fn saving(&self, work_of_run: f64) -> Option<Saving> {
        let most_work = work_of_run.max(LEAST_WORK);
        let error = match predicted_error(&self.problem, NEARER, &self.kind, most_work) {
            Ok(predicted) if predicted.is_finite() => PredictedError {
                share: Some(predicted),
                least: None,
                of: "displacement and velocity, the whole error of the boundary".into(),
                source: "not measured on this scene, predicted by an opening in a slice of its ground as in `powerhouse advise boundary`".into(),
            },
            Err(StudyError::CostlyPrediction { .. }) => PredictedError::unknown(
                "its prediction takes longer than the run, `powerhouse advise box` makes it",
            ),
            Ok(_) | Err(_) => return None,
        };
        let change = Change::NearerFaces { share: NEARER };
        Some(of_elements(change, self.share, error))
    }
}
