//! Scenes (TOML), with the meshes and records that they name in `data/`.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use powerhouse::{Registry, Scene, FileScene};
use powerhouse_fuzz::limited;

/// Bytes of the largest mesh that a scene of the corpus names, which is an input, too.
const MESH: usize = 1_400_000;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = str::from_utf8(bytes) else {
        return;
    };
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/scenes/fuzzed.toml");
    let registry = Registry::default();
    let read = limited(bytes.len() + MESH, || {
        FileScene::from_toml(text, &scene, &registry)
    });
    if let Err(error) = read {
        assert!(!error.to_string().is_empty());
    }
});
