//! Mazars damage in total strain.

use powerhouse_material_damage::{Finding, Mazars, MazarsParameters, MazarsTension, presets};
use powerhouse_model::ModelError;
use schemars::JsonSchema;
use serde::Deserialize;

use super::preset::{self, Preset};
use super::{ElasticKeys, KeysError, RESIDUAL_STIFFNESS, elastic_medium, missing, placed, refused};
use crate::Registry;
use crate::spec::{NonNegative, PoissonRatio, Positive, Share};
use powerhouse_laws::Material;

pub(super) fn register(registry: &mut Registry) {
    registry.add_law("mazars", MazarsKeys::build);
}

/// Isotropic damage in total strain of Mazars (1986).
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MazarsKeys {
    /// Preset `paper-c25`, whose parameters are the defaults of the other keys.
    preset: Option<Preset>,
    /// Young's modulus (Pa), above 0.
    young: Option<Positive>,
    /// Poisson's ratio (dimensionless), above -1 and below 0.5.
    poisson: Option<PoissonRatio>,
    /// Mass density (kg/m3), above 0.
    density: Option<Positive>,
    /// Damage threshold: equivalent strain at first damage (dimensionless), above 0.
    threshold: Option<Positive>,
    /// Damage evolution in tension.
    tension: Option<MazarsTensionKeys>,
    /// Damage evolution in compression.
    compression: Option<MazarsCompressionKeys>,
    /// Residual stiffness: share that remains at full damage (dimensionless), 0.001 by default, 1e-6 or above. An open crack
    /// bears this share of E times its opening over the width of the element.
    residual_stiffness: Option<Share>,
}

/// Quantity that decreases exponentially after first damage.
#[derive(Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum Falling {
    /// Damage term of Mazars; element sizes are permitted within a factor of five.
    #[default]
    Damage,
    /// Stress; all element sizes without snap-back are permitted.
    Stress,
}

/// Damage evolution in tension: either `fracture_energy` with optional `falling`, or `rate` with optional `share`.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MazarsTensionKeys {
    /// Fracture energy per area of crack (N/m), above 0.
    fracture_energy: Option<Positive>,
    /// Exponentially decreasing quantity: `damage` (the default) or `stress`.
    falling: Option<Falling>,
    /// Parameter B of the evolution (dimensionless), at least the inverse of the threshold.
    rate: Option<Positive>,
    /// Parameter A of the evolution (dimensionless), above 0 and at most 1, 1 by default.
    share: Option<Share>,
}

/// Damage evolution in compression.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MazarsCompressionKeys {
    /// Parameter B of the evolution (dimensionless), above 0.
    rate: Positive,
    /// Parameter A of the evolution (dimensionless), 0 to 2.
    share: NonNegative,
}

impl MazarsKeys {
    fn build(self) -> Result<Material, ModelError> {
        let preset = match self.preset {
            None => None,
            Some(Preset::PaperC25) => Some(presets::PAPER_CONCRETE_MAZARS),
            Some(_) => return Err(refused("preset", KeysError::Preset)),
        };
        let given = |own: Option<f64>, of: fn(&MazarsParameters) -> f64, key| {
            own.or(preset.as_ref().map(of)).ok_or(missing(key))
        };
        let elastic = ElasticKeys {
            young: self.young,
            poisson: self.poisson,
            density: self.density,
        };
        let medium = elastic_medium(elastic, preset.as_ref().map(|preset| preset.medium))?;
        let tension = match self.tension {
            Some(MazarsTensionKeys {
                fracture_energy: Some(energy),
                falling,
                rate: None,
                share: None,
            }) => {
                let energy = energy.get();
                match falling.unwrap_or_default() {
                    Falling::Damage => MazarsTension::FractureEnergy { energy },
                    Falling::Stress => MazarsTension::FallingStress { energy },
                }
            }
            Some(MazarsTensionKeys {
                fracture_energy: None,
                falling: None,
                rate: Some(rate),
                share,
            }) => MazarsTension::Rates {
                share: share.map_or(1.0, Share::get),
                rate: rate.get(),
            },
            Some(_) => return Err(refused("tension", KeysError::Softening)),
            None => preset.ok_or(missing("tension"))?.tension,
        };
        let crushed = |of: fn(&MazarsCompressionKeys) -> f64| self.compression.as_ref().map(of);
        let law = Mazars::new(MazarsParameters {
            medium,
            threshold: given(
                self.threshold.map(Positive::get),
                |p| p.threshold,
                "threshold",
            )?,
            tension,
            compression_share: given(
                crushed(|own| own.share.get()),
                |p| p.compression_share,
                "compression",
            )?,
            compression_rate: given(
                crushed(|own| own.rate.get()),
                |p| p.compression_rate,
                "compression",
            )?,
            residual_stiffness: self
                .residual_stiffness
                .map_or(RESIDUAL_STIFFNESS, Share::get),
        });
        let warnings = Finding::of_medium(&medium);
        let material = Material::from(law.map_err(placed)?).with_warnings(warnings);
        preset::damped(self.preset, material)
    }
}
