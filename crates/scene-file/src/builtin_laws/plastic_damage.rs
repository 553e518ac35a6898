//! Plastic-damage law, Eq. (25) of Wang, Chen & Xiao (2019).

use powerhouse_material_damage::{
    ConeFit, Finding, PlasticDamage, PlasticDamageParameters, YieldSurface,
};
use powerhouse_model::ModelError;
use schemars::JsonSchema;
use serde::Deserialize;

use super::frictional::Frictional;
use super::preset::{self, Preset};
use super::{KeysError, placed, refused};
use crate::Registry;
use powerhouse_laws::Material;

pub(super) fn register(registry: &mut Registry) {
    preset::add(
        registry,
        "plastic-damage",
        Preset::plastic_damage,
        PlasticDamageKeys::build,
    );
}

/// Yield surface of the effective stress.
#[derive(Clone, Copy, Default, Deserialize, JsonSchema, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum SurfaceKey {
    /// Mohr-Coulomb surface with tension cut-off.
    #[default]
    MohrCoulomb,
    /// Drucker-Prager surface.
    DruckerPrager,
    /// Two surfaces through the given uniaxial tensile and compressive strengths.
    TwoSurface,
}

/// Plasticity coupled with damage in tension and compression, Eq. (25) of Wang, Chen & Xiao (2019).
#[derive(Deserialize, JsonSchema)]
struct PlasticDamageKeys {
    #[serde(rename = "+")]
    #[schemars(flatten)]
    damage: PlasticDamageParameters<Frictional>,
    /// Yield surface of the effective stress; `mohr-coulomb` by default.
    #[serde(rename = "surface", default)]
    kind: SurfaceKey,
    /// Fit of a Drucker-Prager surface to Mohr-Coulomb; `inscribed` by default.
    fit: Option<ConeFit>,
}

impl PlasticDamageKeys {
    fn build(self) -> Result<Material, ModelError> {
        if self.fit.is_some() && self.kind != SurfaceKey::DruckerPrager {
            return Err(refused("fit", KeysError::Fit));
        }
        let frictional = &self.damage.surface;
        match self.kind {
            SurfaceKey::MohrCoulomb => self.on(frictional.mohr_coulomb()?),
            SurfaceKey::DruckerPrager => {
                self.on(frictional.drucker_prager(self.fit.unwrap_or_default())?)
            }
            SurfaceKey::TwoSurface => self.on(frictional.two_surface()?),
        }
    }
    /// Plastic-damage law with a yield surface.
    fn on<S: YieldSurface>(
        &self,
        (surface, findings): (S, Vec<Finding>),
    ) -> Result<Material, ModelError>
    where
        Material: From<PlasticDamage<S>>,
    {
        let law = PlasticDamage::new(self.damage.with_surface(surface)).map_err(placed)?;
        Ok(Material::from(law).with_warnings(findings))
    }
}
