//! The extent of the mesh as a factor of a trade study.

use std::path::Path;

use powerhouse::{Registry, Remark, Scene, keys};
use toml::Table;

use super::factor::{Factor, Level, sets_acted_on};
use crate::advice::BoxReduction;

/// Factors on the distances of the absorbing faces from the scatterer, and greatest share of the elements of the
/// previous box that a box may keep.
const NEARER: [f64; 3] = [0.75, 0.5, 0.35];
const WORTHWHILE: f64 = 0.85;
/// Keys of a boundary that set the distances of its springs.
const DISTANCES: [&str; 4] = [keys::DISTANCE, keys::AXES[0], keys::AXES[1], keys::AXES[2]];

/// The whole mesh and reduced boxes that contain the scatterer and all recorded, loaded and moved nodes; `None` if no
/// box is smaller or the boundary depends on the extent of the mesh.
pub(super) fn ground(
    scene: &Scene,
    (file, path): (&Table, &Path),
    registry: &Registry,
) -> Option<Factor> {
    let boundary = file.get("boundary")?.as_table()?;
    let is_given = |key: &&str| boundary.contains_key(*key);
    // The padding of waves past the critical angle, and the arrival of a recorded motion, depend on the box.
    let is_padded = |remark: &Remark| matches!(remark, Remark::QuietStart { .. });
    if boundary.contains_key(keys::REGION)
        || file.contains_key("motion")
        || DISTANCES.iter().any(is_given)
        || scene.remarks().iter().any(is_padded)
    {
        return None;
    }
    let acted_on = sets_acted_on(file);
    let acted_on = acted_on
        .into_iter()
        .flat_map(|set| scene.mesh().nodes_of_set(set).unwrap_or_default());
    let reduction = BoxReduction::of(scene).ok()?.with_nodes(acted_on);
    let waves = scene.plane_waves().iter();
    let references = waves.map(|wave| wave.parameters().reference.into());
    let references: Vec<[f64; 3]> = references.collect();
    let mut levels = vec![Level::own("unchanged")];
    let mut least = scene.mesh().element_count();
    for share in NEARER {
        let Ok((within, elements)) = reduction.at(share) else {
            break;
        };
        if elements.len() as f64 > WORTHWHILE * least as f64 {
            continue;
        }
        let name = format!("faces at {share} of their distance");
        let level = Level::less_ground(name, within, references.clone());
        if !is_whole(scene, &level, (file, path), registry) {
            break;
        }
        least = elements.len();
        levels.push(level);
    }
    (levels.len() > 1).then(|| Factor::new("ground", levels, 0))
}

/// Whether a scene with a level is valid and none of its sets has become empty.
fn is_whole(
    scene: &Scene,
    level: &Level,
    (file, path): (&Table, &Path),
    registry: &Registry,
) -> bool {
    let mut changed = file.clone();
    level.apply(&mut changed);
    let Ok(text) = toml::to_string(&changed) else {
        return false;
    };
    let Ok(less) = Scene::from_toml(text, path, registry) else {
        return false;
    };
    let of_empty = |remark: &&Remark| matches!(remark, Remark::EmptySet { .. });
    let empty = |scene: &Scene| scene.remarks().iter().filter(of_empty).count();
    empty(&less) == empty(scene)
}
