//! The extent of the mesh as a factor of a trade study.

use powerhouse::{FileScene, Registry, Remark, Scene, SceneSpec, keys};

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
pub(super) fn ground(scene: &Scene, spec: &SceneSpec, registry: &Registry) -> Option<Factor> {
    let boundary = spec.boundary.as_ref()?;
    let is_given = |key: &&str| boundary.parameters.get(key).is_some();
    // The padding of waves past the critical angle, and the arrival of a recorded motion, depend on the box.
    let is_padded = |remark: &Remark| matches!(remark, Remark::QuietStart(_));
    if boundary.region.is_some()
        || !spec.motions.is_empty()
        || DISTANCES.iter().any(is_given)
        || scene.remarks().iter().any(is_padded)
    {
        return None;
    }
    let acted_on = sets_acted_on(spec);
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
        if !is_whole(scene, &level, spec, registry) {
            break;
        }
        least = elements.len();
        levels.push(level);
    }
    (levels.len() > 1).then(|| Factor::new("ground", levels, 0))
}

/// Whether a scene with a level is valid and none of its sets has become empty.
fn is_whole(scene: &Scene, level: &Level, spec: &SceneSpec, registry: &Registry) -> bool {
    let mut changed = spec.clone();
    level.apply(&mut changed);
    let Ok(less) = FileScene::from_spec(changed, registry) else {
        return false;
    };
    let of_empty = |remark: &&Remark| matches!(remark, Remark::EmptySet(_));
    let empty = |scene: &Scene| scene.remarks().iter().filter(of_empty).count();
    empty(&less) == empty(scene)
}
