//! Points at which a field is evaluated for checks alone.

use std::collections::BTreeSet;

use powerhouse_model::MeshError;

use crate::Scene;

/// Heights of a check beside those at which the field enters the body.
const OTHERS: usize = 8;
/// Difference of heights that are one, over the diagonal of the mesh.
const ROUNDING: f64 = 1e-9;

/// Heights at which a field is evaluated for a check: any, but of waves in layers, which take time and memory for each height,
/// those at which they enter the body, and a few others.
pub struct CheckHeights {
    kept: Option<BTreeSet<i64>>,
    unit: f64,
}

impl CheckHeights {
    /// Heights for the field of a scene.
    ///
    /// # Errors
    /// A set that does not exist.
    pub fn of(scene: &Scene) -> Result<Self, MeshError> {
        let (low, high) = scene.mesh.bounding_box();
        let mut heights = Self {
            kept: None,
            unit: ROUNDING * (high - low).norm(),
        };
        if scene.layered_waves().is_empty() {
            return Ok(heights);
        }
        let of = |node: u32| heights.key(scene.mesh.positions()[node as usize].z);
        let region = scene.boundary.as_ref().and_then(|b| b.region.as_deref());
        let mut kept = BTreeSet::new();
        match region {
            Some(region) => {
                kept.extend(scene.mesh.nodes_of_elements(region).into_iter().map(of));
            }
            None => {
                for (_, facets) in scene.absorbing_facets()? {
                    kept.extend(scene.mesh.nodes_of_facets(facets).into_iter().map(of));
                }
            }
        }
        let all = (0..scene.mesh.node_count() as u32).map(of);
        let others: BTreeSet<i64> = all.filter(|height| !kept.contains(height)).collect();
        let stride = others.len().div_ceil(OTHERS).max(1);
        kept.extend(others.into_iter().step_by(stride));
        heights.kept = Some(kept);
        Ok(heights)
    }

    /// Evenly spaced items of a list at these heights, at most a number of them; where none is at these heights, the first and
    /// the last.
    pub fn sample<T>(&self, mut items: Vec<T>, most: usize, height: impl Fn(&T) -> f64) -> Vec<T> {
        if let Some(kept) = &self.kept {
            let is_kept = |item: &T| kept.contains(&self.key(height(item)));
            if items.iter().any(is_kept) {
                items.retain(is_kept)
            } else {
                let stride = items.len().saturating_sub(1).max(1);
                items = items.into_iter().step_by(stride).collect();
            }
        }
        let stride = items.len().div_ceil(most).max(1);
        items.into_iter().step_by(stride).collect()
    }

    fn key(&self, height: f64) -> i64 {
        (height / self.unit).round() as i64
    }
}
