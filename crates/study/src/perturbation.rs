//! Perturbation of the waves of a scene, which shows the sensitivity of its results to the input.

use powerhouse::spec::Finite;
use powerhouse::{Scene, SceneSpec};

/// Relative increase of the waves; records are accurate to a thousandth at best.
pub(crate) const PERTURBATION: f64 = 1e-6;

/// Whether laws or joints of a scene have history variables, so that results depend on the load path.
pub(crate) fn is_path_dependent(scene: &Scene) -> bool {
    let is_nonlinear = || scene.parts().iter().any(|part| !part.material.is_linear());
    scene.joints().next().is_some() || is_nonlinear()
}

/// Enlarges the factors of the waves and motions of a scene by a share; returns their number.
pub(crate) fn enlarge_waves(spec: &mut SceneSpec, share: f64) -> usize {
    let of_waves = spec.waves.iter_mut().map(|wave| &mut wave.factor);
    let of_motions = spec.motions.iter_mut().map(|motion| &mut motion.factor);
    let mut waves = 0;
    for factor in of_waves.chain(of_motions) {
        *factor = Finite::new(factor.map_or(1.0, Finite::get) * (1.0 + share));
        waves += 1;
    }
    waves
}
