//! Built-in constitutive laws of rock and concrete.

mod frictional;
mod plastic_damage;
mod preset;

use powerhouse_laws::Material;
use powerhouse_material_damage::{
    ElastoPlastic, Finding, HoekBrown, HoekBrownParameters, LeeFenves, MaterialError, Mazars,
    MazarsParameters,
};
use powerhouse_model::ModelError;
use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

use crate::Registry;
use crate::spec::{NonNegative, Positive};
use preset::Preset;

pub(crate) fn register(registry: &mut Registry) {
    frictional::register(registry);
    plastic_damage::register(registry);
    registry.add_law("hoek-brown", |keys: HoekBrownKeys| {
        let surface = HoekBrown::new(keys.surface).map_err(placed)?;
        let listed = [
            keys.tensile_strength.map(NonNegative::get),
            keys.compressive_strength.map(Positive::get),
        ];
        let warnings = surface.findings(listed);
        Ok(Material::from(ElastoPlastic::new(surface)).with_warnings(warnings))
    });
    preset::add(registry, "mazars", Preset::mazars, |p: MazarsParameters| {
        let warnings = Finding::of_medium(&p.medium);
        let law = Mazars::new(p).map_err(placed)?;
        Ok(Material::from(law).with_warnings(warnings))
    });
    preset::add(registry, "lee-fenves", Preset::lee_fenves, |p| {
        let law = LeeFenves::new(p).map_err(placed)?;
        let warnings = law.findings();
        Ok(Material::from(law).with_warnings(warnings))
    });
}

/// Hoek-Brown plasticity of a rock mass (Hoek, Carranza-Torres & Corkum 2002).
#[derive(Deserialize, JsonSchema)]
struct HoekBrownKeys {
    #[serde(rename = "+")]
    #[schemars(flatten)]
    surface: HoekBrownParameters,
    /// Uniaxial tensile strength of the rock mass (Pa), with which that of the yield surface is compared.
    tensile_strength: Option<NonNegative>,
    /// Uniaxial compressive strength of the rock mass (Pa), with which that of the yield surface is compared.
    compressive_strength: Option<Positive>,
}

/// Error in the combination of keys of a law.
#[derive(Debug, Error)]
enum KeysError {
    #[error("the key '{0}' is missing; give it, or a preset that contains it")]
    Missing(String),
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
