//! Slices with delayed sides in place of long bodies under waves along them.

use powerhouse::Scene;
use powerhouse::model::Axis;

use super::shape::{is_crossed, is_same_along};
use super::{BY_COUNT, Change, PredictedError, Saving};
use crate::StudyError;

/// Stable step of a slice over that of a body without delayed ends, by the speed of P waves over that of the motion along y, from the tests of
/// slices.
const STEPS: [[f64; 2]; 7] = [
    [0.0, 1.0],
    [0.2, 0.99],
    [0.4, 0.97],
    [0.6, 0.92],
    [0.8, 0.82],
    [0.9, 0.67],
    [0.95, 0.48],
];
/// The same of a bay, from the tests of bays.
const STEPS_OF_BAY: [[f64; 2]; 7] = [
    [0.0, 1.0],
    [0.2, 0.995],
    [0.4, 0.93],
    [0.6, 0.82],
    [0.8, 0.61],
    [0.9, 0.45],
    [0.95, 0.32],
];
/// Cost of a step per element over that of a body without delayed ends, about: a slice of linear elements adds products of matrices, others
/// evaluate their laws twice.
const COST: [f64; 2] = [1.5, 2.0];
/// The same of a bay, at least: it solves for its motion in each step.
const COST_OF_BAY: [f64; 2] = [6.0, 8.0];

/// Saving by a slice with delayed sides, of a bay or of a body without delayed ends; none where such slices do not take what the scene has, or
/// the body is one layer thick.
pub(super) fn slice(scene: &Scene) -> Result<Option<Saving>, StudyError> {
    let Some(ratio) = scene.ratio_in_delayed_slice() else {
        return Ok(None);
    };
    let mesh = scene.mesh();
    let (low, high) = mesh.bounding_box();
    if is_crossed(scene)? || !is_same_along(mesh, Axis::Y) {
        return Ok(None);
    }
    let Ok(layer) = mesh.plane_slice(Axis::Y, 0.5 * (low.y + high.y)) else {
        return Ok(None);
    };
    // The middle of the layer: a plane between two layers is in either of them.
    let (low, high) = layer.bounding_box();
    let at = 0.5 * (low.y + high.y);
    let elements = layer.element_count() as f64 / mesh.element_count() as f64;
    let is_linear = scene.parts().iter().all(|part| part.material.is_linear());
    let has_ends = scene.delayed_sides().is_some();
    let (of_body, cost_of_body) = if has_ends {
        (step(&STEPS_OF_BAY, ratio), COST_OF_BAY)
    } else {
        (1.0, [1.0, 1.0])
    };
    let steps = of_body / step(&STEPS, ratio);
    let law = usize::from(!is_linear);
    let source = if has_ends {
        "it has none of its own, every section moves as the one before it did; its times are those at this y, not those in the middle of the bay"
    } else {
        "it has none of its own, every section moves as the one before it did; that of the ends of the body is gone"
    };
    Ok((elements < 1.0).then(|| Saving {
        change: Change::DelayedSlice { at, has_ends },
        steps,
        elements,
        time: elements * steps * COST[law] / cost_of_body[law],
        timed: BY_COUNT,
        error: PredictedError {
            share: None,
            least: None,
            of: "histories".into(),
            source: source.into(),
        },
    }))
}

/// Stable step over that of a body without delayed ends, at a ratio of speeds: on straight lines between known ones.
fn step(known: &[[f64; 2]; 7], ratio: f64) -> f64 {
    let pairs = known.windows(2);
    let mut around = pairs.filter(|pair| ratio <= pair[1][0]);
    around.next().map_or(known[6][1], |pair| {
        let [[from, before], [to, after]] = [pair[0], pair[1]];
        before + (after - before) * (ratio - from) / (to - from)
    })
}
