//! Tables of a scene file that nothing uses.

use std::collections::BTreeSet;

use crate::spec::{At, Motion, SceneSpec, Support, Wave};
use powerhouse_scene::{Remark, remark};

/// Warnings about records that neither a wave nor a prescribed motion uses, in any component, nor one of a case.
pub(super) fn records(file: &SceneSpec) -> Vec<Remark> {
    let mut used = of_input(&file.waves, &file.motions, &file.supports);
    for case in &file.cases {
        let supports = case.supports.as_deref().unwrap_or_default();
        used.extend(of_input(&case.waves, &case.motions, supports));
    }
    let is_unused = |name: &str| {
        let component = format!("{name}.");
        !used
            .iter()
            .any(|used| used.as_str() == name || used.starts_with(&component))
    };
    let records = file.records.iter().map(|record| record.name.to_string());
    records
        .filter(|name| is_unused(name))
        .map(|name| Remark::from(remark::UnusedRecord { name }))
        .collect()
}

/// Names of the records of waves, motions and supports.
fn of_input(waves: &[Wave], motions: &[Motion], supports: &[At<Support>]) -> Vec<At<String>> {
    let of_waves = waves.iter().filter_map(|wave| wave.record.as_ref());
    let of_supports = supports.iter().filter_map(|support| match &**support {
        Support::Prescribed { record, .. } => record.as_ref(),
        _ => None,
    });
    let of_motions = motions.iter().map(|motion| &motion.record);
    of_waves
        .chain(of_supports)
        .chain(of_motions)
        .cloned()
        .collect()
}

/// Warnings about materials that no part, no layer and no stage uses, nor a part or a layer of a case.
pub(super) fn materials(file: &SceneSpec) -> Vec<Remark> {
    let of_cases = file.cases.iter().flat_map(|case| &case.parts);
    let of_cases = of_cases.filter_map(|part| part.material.as_deref());
    let of_parts = file.parts.iter().map(|part| part.material.as_str());
    let of_stages = file.stages.iter().flat_map(|stage| &stage.parts);
    let of_stages = of_stages.map(|part| part.material.as_str());
    let layers = file.layers.iter();
    let layers = layers.chain(file.cases.iter().flat_map(|case| &case.layers));
    let of_layers = layers.map(|layer| layer.material.as_str());
    let used: BTreeSet<&str> = of_parts
        .chain(of_stages)
        .chain(of_layers)
        .chain(of_cases)
        .collect();
    let materials = file.materials.iter().map(|material| &material.name);
    let unused = materials.filter(|name| !used.contains(name.as_str()));
    unused
        .map(|name| {
            Remark::from(remark::UnusedMaterial {
                name: name.to_string(),
            })
        })
        .collect()
}
