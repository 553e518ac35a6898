//! Plastic-damage law, Eq. (25) of Wang, Chen & Xiao (2019).

use powerhouse_material_damage::{
    Finding, PlasticDamage, PlasticDamageParameters, Softening, YieldSurface,
};
use powerhouse_model::ModelError;
use schemars::JsonSchema;
use serde::Deserialize;

use super::frictional::{Fit, frictional_keys};
use super::preset::{self, Preset};
use super::{KeysError, RESIDUAL_STIFFNESS, placed, refused};
use crate::Registry;
use crate::spec::{NonNegative, Positive, Share};
use powerhouse_laws::Material;

pub(super) fn register(registry: &mut Registry) {
    registry.add_law("plastic-damage", PlasticDamageKeys::build);
}

/// Yield surface of the effective stress.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum SurfaceKey {
    /// Mohr-Coulomb surface with tension cut-off.
    MohrCoulomb,
    /// Drucker-Prager surface.
    DruckerPrager,
    /// Two surfaces through the given uniaxial tensile and compressive strengths.
    TwoSurface,
}

frictional_keys! {
    /// Plasticity coupled with damage in tension and compression, Eq. (25) of Wang, Chen & Xiao (2019).
    PlasticDamageKeys {
        /// Yield surface of the effective stress; `mohr-coulomb` by default.
        surface: Option<SurfaceKey>,
        /// Fit of a Drucker-Prager surface to Mohr-Coulomb; `inscribed` by default.
        fit: Option<Fit>,
        /// Damage evolution in tension (opening of cracks); that of the preset, or no damage.
        tension: Option<SofteningKeys>,
        /// Damage evolution in compression (crushing and shear); that of the preset, or no damage.
        compression: Option<SofteningKeys>,
        /// Stiffness recovery: share of tensile damage that vanishes when cracks close (dimensionless), 0 to 1;
        /// 1 by default.
        stiffness_recovery: Option<NonNegative>,
        /// Residual stiffness: share that remains at full damage (dimensionless), 0.001 by default.
        residual_stiffness: Option<Share>,
    }
}

/// Damage evolution: either `fracture_energy`, or `rate` and `share` as in Eq. (25).
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SofteningKeys {
    /// Fracture energy per area of a crack or crushing band (N/m), above 0; independent of the element size.
    fracture_energy: Option<Positive>,
    /// Parameter B (dimensionless), above 0; the dissipated energy then depends on the element size.
    rate: Option<Positive>,
    /// Parameter A (dimensionless), above 0 and at most 1, 1 by default.
    share: Option<NonNegative>,
    /// Damage threshold: equivalent plastic strain at first damage (dimensionless), 0 or above, 0 by default.
    threshold: Option<NonNegative>,
}

impl SofteningKeys {
    fn softening(self, key: &'static str) -> Result<Softening, ModelError> {
        let threshold = self.threshold.map_or(0.0, NonNegative::get);
        match (self.fracture_energy, self.rate, self.share) {
            (Some(energy), None, None) => Ok(Softening::FractureEnergy {
                energy: energy.get(),
                threshold,
            }),
            (None, Some(rate), share) => Ok(Softening::Rates {
                share: share.map_or(1.0, NonNegative::get),
                rate: rate.get(),
                threshold,
            }),
            _ => Err(refused(key, KeysError::Softening)),
        }
    }
}

impl PlasticDamageKeys {
    fn build(self) -> Result<Material, ModelError> {
        let frictional = self.frictional()?;
        let is_cone = matches!(self.surface, Some(SurfaceKey::DruckerPrager));
        if self.fit.is_some() && !is_cone {
            return Err(refused("fit", KeysError::Fit));
        }
        match self.surface.unwrap_or(SurfaceKey::MohrCoulomb) {
            SurfaceKey::MohrCoulomb => self.on(frictional.mohr_coulomb()?),
            SurfaceKey::DruckerPrager => self.on(frictional.drucker_prager(self.fit)?),
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
        let preset = self.preset.map(Preset::concrete).transpose()?.flatten();
        let preset = preset.as_ref().map(PlasticDamage::parameters);
        let softening = |own: Option<SofteningKeys>, of: Option<Softening>, key| match own {
            Some(own) => own.softening(key),
            None => Ok(of.unwrap_or(Softening::None)),
        };
        let recovery = self.stiffness_recovery.map(NonNegative::get);
        let residual = self.residual_stiffness.map(Share::get);
        let law = PlasticDamage::new(PlasticDamageParameters {
            surface,
            tension: softening(self.tension, preset.map(|p| p.tension), "tension")?,
            compression: softening(
                self.compression,
                preset.map(|p| p.compression),
                "compression",
            )?,
            stiffness_recovery: recovery
                .or(preset.map(|p| p.stiffness_recovery))
                .unwrap_or(1.0),
            residual_stiffness: residual
                .or(preset.map(|p| p.residual_stiffness))
                .unwrap_or(RESIDUAL_STIFFNESS),
        });
        let material = Material::from(law.map_err(placed)?).with_warnings(findings);
        preset::damped(self.preset, material)
    }
}
