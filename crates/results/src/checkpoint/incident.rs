//! Comparison of the incident motion of two scenes at one instant.

use std::sync::Arc;

use powerhouse_model::{FieldMotion, IncidentField, ModelError, Vec3};

use powerhouse_scene::Scene;
use powerhouse_scene::internal::CheckHeights;

/// Number of nodes at which the incident motion is compared.
const POINTS: usize = 100;
/// Largest difference of the incident motion, over its largest value at the instant, that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// Incident motion of a scene at some of its nodes.
#[derive(Clone)]
pub(super) struct IncidentMotion {
    field: Option<Arc<dyn IncidentField>>,
    points: Vec<Vec3>,
}

impl core::fmt::Debug for IncidentMotion {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("IncidentMotion").finish_non_exhaustive()
    }
}

impl IncidentMotion {
    /// The incident motion of a scene at nodes spread over its mesh, or at some of the stations of its field.
    pub(super) fn of(scene: &Scene) -> Self {
        let stations = scene.field().and_then(|field| field.stations());
        let nodes = stations.unwrap_or(scene.mesh().positions()).to_vec();
        let stride = nodes.len().div_ceil(POINTS).max(1);
        Self {
            field: scene.field().cloned(),
            // A scene whose faces do not exist is not run.
            points: match CheckHeights::of(scene) {
                Ok(heights) => heights.sample(nodes, POINTS, |node| node.z),
                Err(_) => nodes.into_iter().step_by(stride).collect(),
            },
        }
    }

    /// Displacement (m), velocity (m/s) and stress (Pa) of every node at a time (s), twelve numbers each; empty without a
    /// field.
    pub(super) fn at(&self, time: f64) -> Result<Vec<f64>, ModelError> {
        let Some(field) = &self.field else {
            return Ok(Vec::new());
        };
        let mut motion = vec![FieldMotion::default(); self.points.len()];
        field.prepare(&self.points)?.add_motion(time, &mut motion);
        let numbers = motion.iter().flat_map(|motion| {
            let FieldMotion {
                displacement,
                velocity,
                stress,
            } = motion;
            let vectors = [displacement, velocity].into_iter().flatten();
            vectors.copied().chain(stress.0).collect::<Vec<f64>>()
        });
        Ok(numbers.collect())
    }
}

/// Whether two incident motions are the same but for rounding.
pub(super) fn are_equal(first: &[f64], second: &[f64]) -> bool {
    let kinds = [0..3, 3..6, 6..12];
    first.len() == second.len()
        && kinds.into_iter().all(|kind| {
            let of = |numbers: &[f64]| -> Vec<f64> {
                let nodes = numbers.chunks(12);
                nodes.flat_map(|node| node[kind.clone()].to_vec()).collect()
            };
            let (first, second) = (of(first), of(second));
            let largest = first.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let mut pairs = first.iter().zip(&second);
            pairs.all(|(a, b)| (a - b).abs() <= ROUNDING * largest)
        })
}
