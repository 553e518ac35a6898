//! Perturbation of the waves of a scene, which shows the sensitivity of its results to the input.

use powerhouse::Scene;
use toml::{Table, Value};

use crate::trade::factor::{number, tables};

/// Relative increase of the waves; records are accurate to a thousandth at best.
pub(crate) const PERTURBATION: f64 = 1e-6;

/// Whether laws or joints of a scene have history variables, so that results depend on the load path.
pub(crate) fn is_path_dependent(scene: &Scene) -> bool {
    let is_nonlinear = || scene.parts().iter().any(|part| !part.material.is_linear());
    scene.joints().next().is_some() || is_nonlinear()
}

/// Tables of scenes, and of cases, from which waves come.
pub(crate) const OF_WAVES: [&str; 2] = ["wave", "motion"];

/// Enlarges the factors of the waves and motions of a scene, or of a case, by a share; returns their number.
pub(crate) fn enlarge_waves(file: &mut Table, share: f64) -> usize {
    let mut waves = 0;
    for table in OF_WAVES {
        for wave in tables(file, table) {
            let own = wave.get("factor").and_then(number).unwrap_or(1.0);
            wave.insert("factor".into(), Value::Float(own * (1.0 + share)));
            waves += 1;
        }
    }
    waves
}
