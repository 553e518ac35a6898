//! Slices with delayed sides in place of long bodies under waves along them.

use powerhouse::Scene;
use powerhouse::model::Axis;

use super::shape::{is_crossed, is_same_along};
use super::{BY_COUNT, Change, PredictedError, Saving};
use crate::StudyError;

/// Stable step of a slice over that of the body, by the speed of P waves over that of the motion along y, from the tests of slices.
const STEPS: [[f64; 2]; 7] = [
    [0.0, 1.0],
    [0.2, 0.99],
    [0.4, 0.97],
    [0.6, 0.92],
    [0.8, 0.82],
    [0.9, 0.67],
    [0.95, 0.48],
];
/// Cost of a step per element over that of the body, about: a slice of linear elements adds products of matrices, others
/// evaluate their laws twice.
const COST: [f64; 2] = [1.5, 2.0];

/// Saving by a slice with delayed sides; none where such slices do not take what the scene has, or the body is one layer thick.
pub(super) fn slice(scene: &Scene) -> Result<Option<Saving>, StudyError> {
    let Some(ratio) = scene.ratio_in_delayed_slice() else {
        return Ok(None);
    };
    let mesh = scene.mesh();
    let (low, high) = mesh.bounding_box();
    let at = 0.5 * (low.y + high.y);
    if is_crossed(scene)? || !is_same_along(mesh, Axis::Y) {
        return Ok(None);
    }
    let Ok(layer) = mesh.plane_slice(Axis::Y, at) else {
        return Ok(None);
    };
    let elements = layer.element_count() as f64 / mesh.element_count() as f64;
    let is_linear = scene.parts().iter().all(|part| part.material.is_linear());
    let steps = 1.0 / step(ratio);
    Ok((elements < 1.0).then(|| Saving {
        change: Change::DelayedSlice { at },
        steps,
        elements,
        time: elements * steps * COST[usize::from(!is_linear)],
        timed: BY_COUNT,
        error: PredictedError {
            share: None,
            least: None,
            of: "histories".into(),
            source: "it has none of its own, every section moves as the one before it did; that of the ends of the body is gone".into(),
        },
    }))
}

/// Stable step of a slice over that of the body, at a ratio of speeds: on straight lines between known ones.
fn step(ratio: f64) -> f64 {
    let pairs = STEPS.windows(2);
    let mut around = pairs.filter(|pair| ratio <= pair[1][0]);
    around.next().map_or(STEPS[6][1], |pair| {
        let [[from, before], [to, after]] = [pair[0], pair[1]];
        before + (after - before) * (ratio - from) / (to - from)
    })
}
