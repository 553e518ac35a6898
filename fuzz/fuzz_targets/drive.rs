//! Strain and stress paths of single-point tests (TOML), for each law of the corpus: materials and path in one text,
//! separated by a line of `---`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use powerhouse::{PointPath, Registry};
use powerhouse_fuzz::limited;

/// Steps of a path that is followed to its end; longer ones are only read.
const STEPS: usize = 2_000;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = str::from_utf8(bytes) else {
        return;
    };
    let Some((materials, path)) = text.split_once("\n---\n") else {
        return;
    };
    let registry = Registry::default();
    let material = limited(bytes.len(), || {
        registry.material_of_text(materials, "law.toml", None)
    });
    let path = limited(bytes.len(), || PointPath::from_toml(path, "path.toml"));
    let (Ok(material), Ok(path)) = (material, path) else {
        return;
    };
    if path.steps() > STEPS {
        return;
    }
    match path.drive(&material) {
        Ok(test) => {
            let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
            assert!(test.records.iter().all(|point| finite(&point.stress.0)));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
