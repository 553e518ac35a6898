//! Built-in constitutive laws of rock and concrete.

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
use crate::spec::{PoissonRatio, Positive};

pub(crate) fn register(registry: &mut Registry) {
    frictional::register(registry);
    hoek_brown::register(registry);
    plastic_damage::register(registry);
    lee_fenves::register(registry);
    mazars::register(registry);
}

/// Default residual stiffness at full damage (dimensionless).
const RESIDUAL_STIFFNESS: f64 = 1.0e-3;

/// Error in the combination of keys of a law.
#[derive(Debug, Error)]
enum KeysError {
    #[error("the key '{0}' is missing; give it, or a preset that contains it")]
    Missing(&'static str),
    #[error("either fracture_energy, or rate with optional share, must be given")]
    Softening,
    #[error("either fracture_energy or rate must be given")]
    Fall,
    #[error("the key 'fit' is permitted with surface = \"drucker-prager\" only")]
    Fit,
    #[error("the preset contains no parameters of this law")]
    Preset,
}

/// Error at a key, or at the whole table for an empty key.
fn refused(key: &'static str, error: KeysError) -> ModelError {
    ModelError::refused(key, error)
}

/// Error of a key that neither the table nor a preset gives.
fn missing(key: &'static str) -> ModelError {
    refused("", KeysError::Missing(key))
}

/// Translates a material error into an error at the key concerned.
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

/// Elastic medium of the given keys, completed by those of a preset.
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
