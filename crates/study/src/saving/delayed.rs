//! Slices with delayed sides in place of long bodies under waves along them.

use powerhouse::model::{AbsorbingBoundary, Axis};
use powerhouse::{Damping, Scene};

use super::shape::{is_crossed, is_same_along};
use super::{BY_COUNT, Change, PredictedError, Saving};
use crate::StudyError;

/// Largest ratio of the speed of P waves of a part to that of the motion along y up to which a slice is exact.
const EXACT: f64 = 0.95;
/// Stable step of a slice over that of the body, by that ratio, from the tests of slices.
const STEPS: [[f64; 2]; 7] = [
    [0.0, 1.0],
    [0.2, 0.99],
    [0.4, 0.97],
    [0.6, 0.92],
    [0.8, 0.82],
    [0.9, 0.67],
    [EXACT, 0.48],
];
/// Cost of a step per element over that of the body, about: a slice of linear elements adds products of matrices, others
/// evaluate their laws twice.
const COST: [f64; 2] = [1.5, 2.0];
/// Difference of the slownesses of two waves, over the larger one, that rounding of angles explains.
const SAME: f64 = 1e-6;

/// Saving by a slice with delayed sides; none where such slices do not take what the scene has, or the body is one layer thick.
pub(super) fn slice(scene: &Scene) -> Result<Option<Saving>, StudyError> {
    let Some(slowness) = slowness_along_y(scene) else {
        return Ok(None);
    };
    if scene.delayed_sides().is_some() || is_crossed(scene)? || !is_taken(scene) {
        return Ok(None);
    }
    let speeds = scene.parts().iter();
    let speeds = speeds.map(|part| part.material.medium().p_speed());
    let ratio = slowness.abs() * speeds.fold(0.0, f64::max);
    let mesh = scene.mesh();
    let (low, high) = mesh.bounding_box();
    let at = 0.5 * (low.y + high.y);
    if ratio > EXACT || !is_same_along(mesh, Axis::Y) {
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

/// Slowness along y (s/m) of all waves; none if they travel across it, have several, or are no plane waves in homogeneous ground below their critical
/// angle.
fn slowness_along_y(scene: &Scene) -> Option<f64> {
    let waves = scene.plane_waves();
    let mut all = waves.iter().map(|wave| wave.parameters().slowness().y);
    let first = all.next()?;
    let are_same = all.all(|own| (own - first).abs() <= SAME * first.abs().max(own.abs()));
    let are_causal = waves.iter().all(|wave| wave.is_causal());
    // Across y a slice with rollers or periodic ends does.
    (are_same && are_causal && first != 0.0).then_some(first)
}

/// Whether a slice with delayed sides takes the parts and the boundary of a scene.
fn is_taken(scene: &Scene) -> bool {
    let parts = scene.parts().iter().all(|part| {
        let is_flat = matches!(part.damping, Damping::Flat { .. });
        let stiffness = part.damping.rayleigh().stiffness;
        !is_flat && stiffness == 0.0 && part.high == 0.0 && part.material.pore_water().is_none()
    });
    let boundary = scene.boundary().is_some_and(|boundary| {
        let name = AbsorbingBoundary::name(boundary.condition.as_ref());
        let is_known = ["viscous", "viscous-spring"].contains(&name);
        is_known && boundary.through.is_empty() && boundary.region.is_none()
    });
    parts && boundary
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
