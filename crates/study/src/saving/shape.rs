//! Smaller bodies of the same question.

use std::collections::{HashMap, HashSet};

use powerhouse::Scene;
use powerhouse::model::{Axis, Mesh, Vec3};
use powerhouse::wavefield::WaveKind;

use super::{BY_COUNT, Change, PredictedError, Saving};
use crate::StudyError;
use crate::advice::{Room, kind_of, predicted_error};

/// Nodes that are closer than this share of the mesh's diagonal are at one place.
const TOLERANCE: f64 = 1e-6;
/// Elements whose centres are closer than this share of it, seen along an axis, are behind each other.
const COLUMN: f64 = 1e-5;
/// Waves whose direction has less than this along a normal travel across it.
const ACROSS: f64 = 1e-9;
/// The share of their distance to which faces are moved.
const NEARER: f64 = 0.75;
/// By how much a slice differs from the whole, which takes its elements' share of the time within a quarter:
/// example `plane_slice`.
const SLICE_ERROR: f64 = 1e-10;
/// By how much half a body differs from the whole (tests of symmetry planes).
const HALF_ERROR: f64 = 1e-10;

/// What halves, slices and nearer faces save, as far as the scene allows them.
pub(super) fn savings(scene: &Scene) -> Result<Vec<Saving>, StudyError> {
    let mut savings = Vec::new();
    for axis in [Axis::X, Axis::Y] {
        savings.extend(slice(scene, axis)?);
        savings.extend(half(scene, axis)?);
    }
    savings.extend(nearer_faces(scene)?);
    Ok(savings)
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

/// Whether all waves are P and SV waves that travel across an axis; not so if it is not known of what
/// waves the field is made.
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

/// Whether an absorbing face looks along an axis.
fn absorbs_along(scene: &Scene, axis: Axis) -> Result<bool, StudyError> {
    let mesh = scene.mesh();
    let faces = scene.absorbing_facets().map_err(powerhouse::Error::from)?;
    let mut facets = faces.iter().flat_map(|(_, facets)| facets.iter());
    Ok(facets.any(|facet| mesh.facet_geometry(*facet).normal().iamax() == axis.index()))
}

/// One layer of a body that is the same all along an axis. Joints and bolts, which have places of their own
/// along it, forbid it.
fn slice(scene: &Scene, axis: Axis) -> Result<Option<Saving>, StudyError> {
    let stages = scene.stage_overviews()?;
    let bolted = stages.iter().any(|stage| !stage.bolts.is_empty());
    let held = scene.joints().count() > 0 || bolted || absorbs_along(scene, axis)?;
    if held || !travels_across(scene, axis) {
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
            source: "not measured on this scene, that of the example `plane_slice`".into(),
        };
        of_elements(Change::Slice { axis, at }, elements, error)
    }))
}

/// The sets to which each element belongs, by their places.
fn sets_of_elements(mesh: &Mesh) -> Vec<Vec<usize>> {
    let mut sets = vec![Vec::new(); mesh.element_count()];
    for (place, elements) in mesh.element_sets().values().enumerate() {
        for &element in elements {
            sets[element as usize].push(place);
        }
    }
    sets
}

/// Whether elements behind each other along an axis belong to the same sets.
fn is_same_along(mesh: &Mesh, axis: Axis) -> bool {
    let sets = sets_of_elements(mesh);
    let (low, high) = mesh.bounding_box();
    let cell = COLUMN * (high - low).norm();
    let mut columns: HashMap<[i64; 2], &[usize]> = HashMap::new();
    (0..mesh.element_count() as u32).all(|element| {
        let place = (mesh.centroid(element) - low) / cell;
        let [a, b] = [(axis.index() + 1) % 3, (axis.index() + 2) % 3];
        let column = [a, b].map(|across| place[across].round() as i64);
        let own = &sets[element as usize][..];
        *columns.entry(column).or_insert(own) == own
    })
}

/// Half of a body whose mesh, element sets, absorbing faces and waves have a mirror image. Joints, whose sides are
/// at one place, forbid it.
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
        source: "not measured on this scene, that of halves of cubes run beside the whole".into(),
    };
    Ok(Some(of_elements(
        Change::Half { axis, at },
        elements,
        error,
    )))
}

/// The node at the mirror image of each, if there is one of all.
fn images(mesh: &Mesh, axis: Axis, at: f64) -> Option<Vec<u32>> {
    let (low, high) = mesh.bounding_box();
    let cell = TOLERANCE * (high - low).norm();
    let key = |position: &Vec3| {
        let place = (position - low) / cell;
        [place.x, place.y, place.z].map(|x| x.round() as i64)
    };
    let places: HashMap<[i64; 3], u32> = (0..)
        .zip(mesh.positions())
        .map(|(n, x)| (key(x), n))
        .collect();
    let image = |position: &Vec3| {
        let mut image = *position;
        image[axis.index()] = 2.0 * at - image[axis.index()];
        let [x, y, z] = key(&image);
        // Rounding may fall on either side.
        let beside = [-1, 0, 1].into_iter().flat_map(|i| {
            [-1, 0, 1]
                .into_iter()
                .flat_map(move |j| [-1, 0, 1].map(move |k| [x + i, y + j, z + k]))
        });
        beside
            .filter_map(|place| places.get(&place))
            .next()
            .copied()
    };
    mesh.positions().iter().map(image).collect()
}

/// Faces that come nearer to what scatters, with the error that a slice of the same ground predicts.
fn nearer_faces(scene: &Scene) -> Result<Option<Saving>, StudyError> {
    let Some(boundary) = scene.boundary() else {
        return Ok(None);
    };
    let kind = kind_of(boundary.condition.as_ref());
    // What advice refuses has no prediction.
    let Ok(room) = Room::of(scene) else {
        return Ok(None);
    };
    let setting = &room.setting;
    if setting.radius.is_none() {
        return Ok(None);
    }
    let Ok(predicted) = predicted_error(setting, NEARER, &kind) else {
        return Ok(None);
    };
    // Nor is that offered which the mesh does not allow.
    let Ok((_, left)) = room.at(NEARER) else {
        return Ok(None);
    };
    let left = left.len() as f64;
    let error = PredictedError {
        share: Some(predicted),
        least: None,
        of: "displacement and velocity, that of the boundary as a whole".into(),
        source: "not measured on this scene, predicted by an opening in a slice of its ground, as `powerhouse advise boundary` has it".into(),
    };
    let change = Change::NearerFaces { share: NEARER };
    let all = scene.mesh().element_count() as f64;
    Ok(predicted
        .is_finite()
        .then(|| of_elements(change, left / all, error)))
}
