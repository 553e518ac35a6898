//! Inputs of a run of a scene from a file.

use std::path::{Path, absolute};

use crate::{FileScene, RunInputs};

/// The inputs of a run of a scene, by which its checkpoints are recognised: those of the scene itself
/// ([`RunInputs::of_composed`]), and the keys and files of its scene file ([`FileScene::inputs`]).
pub fn run_inputs(scene: &FileScene) -> RunInputs {
    let mut inputs = RunInputs::of_composed(scene).with(scene.inputs());
    let path = |path: &Path| absolute(path).unwrap_or_else(|_| path.into());
    inputs.scene = scene.source().map(|source| path(&source.path));
    inputs.case = scene.case().map(String::from);
    inputs.changes = scene.changes().to_vec();
    inputs
}
