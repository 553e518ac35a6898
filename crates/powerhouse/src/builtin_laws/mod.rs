//! Laws of rock and concrete that every registry holds from the start.

mod frictional;
mod hoek_brown;
mod lee_fenves;
mod mazars;
mod plastic_damage;
mod preset;

use powerhouse_material_damage::MaterialError;
use powerhouse_model::{ElasticMedium, ModelError};
use thiserror::Error;

use crate::Registry;
use crate::format::{PoissonRatio, Positive};

pub(crate) fn register(registry: &mut Registry) {
    frictional::register(registry);
    hoek_brown::register(registry);
    plastic_damage::register(registry);
    lee_fenves::register(registry);
    mazars::register(registry);
}

/// The share of stiffness that no damage takes away, unless a scene says otherwise.
const RESIDUAL_STIFFNESS: f64 = 1.0e-3;

/// What is wrong with the keys of a law as a whole.
#[derive(Debug, Error)]
enum KeysError {
    #[error("the key '{0}' is missing; a preset would give it")]
    Missing(&'static str),
    #[error("either fracture_energy, or rate and perhaps share must be given")]
    Softening,
    #[error("either fracture_energy or rate must be given")]
    Fall,
    #[error("only a Drucker-Prager surface has a fit")]
    Fit,
    #[error("the preset has no parameters of this law")]
    Preset,
}

/// Refused at the place of a key, or of the whole table.
fn refused(key: &'static str, error: KeysError) -> ModelError {
    ModelError::refused(key, error)
}

/// A key that neither the table nor a preset gives.
fn missing(key: &'static str) -> ModelError {
    refused("", KeysError::Missing(key))
}

/// What a material refuses, under the key that is at fault.
fn placed(error: MaterialError) -> ModelError {
    match error {
        MaterialError::Parameter(mut parameter) => {
            parameter.name = match parameter.name {
                "tension_strength" => "tensile_strength",
                "compression_strength" => "compressive_strength",
                "compression_limit" => "compressive_limit",
                "tension_damage" => "tension",
                "compression_damage" => "compression",
                "residual_strength" => "softening",
                name => name,
            };
            parameter.into()
        }
        MaterialError::Dilation { .. } => ModelError::refused("dilation", error),
        MaterialError::StrengthRatio { .. } => ModelError::refused("compressive_strength", error),
        MaterialError::Hardening { .. } => ModelError::refused("tension", error),
        other => other.into(),
    }
}

/// The elastic keys of a material, as far as they are given.
#[derive(Clone, Copy)]
struct ElasticKeys {
    /// Young's modulus (Pa).
    young: Option<Positive>,
    poisson: Option<PoissonRatio>,
    /// Mass density (kg/m3).
    density: Option<Positive>,
}

/// The elastic medium of some keys, those of a preset where they are not given.
fn elastic_medium(
    keys: ElasticKeys,
    preset: Option<ElasticMedium>,
) -> Result<ElasticMedium, ModelError> {
    let given = |own: Option<f64>, of: fn(&ElasticMedium) -> f64, key| {
        own.or(preset.as_ref().map(of)).ok_or(missing(key))
    };
    Ok(ElasticMedium::new(
        given(keys.young.map(Positive::get), |m| m.young, "young")?,
        given(
            keys.poisson.map(PoissonRatio::get),
            |m| m.poisson,
            "poisson",
        )?,
        given(keys.density.map(Positive::get), |m| m.density, "density")?,
    )?)
}
