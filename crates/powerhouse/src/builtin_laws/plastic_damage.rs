//! Plasticity with damage: Eq. (25) of Wang, Chen & Xiao (2019).

use powerhouse_material_damage::{
    Finding, PlasticDamage, PlasticDamageParameters, Softening, YieldSurface,
};
use powerhouse_model::ModelError;
use schemars::JsonSchema;
use serde::Deserialize;

use super::frictional::{Fit, frictional_keys};
use super::preset::Preset;
use super::{KeysError, RESIDUAL_STIFFNESS, placed, refused};
use crate::format::{NonNegative, Positive, Share};
use crate::{Material, Registry};

pub(super) fn register(registry: &mut Registry) {
    registry.add_law("plastic-damage", PlasticDamageKeys::build);
}

/// The surface at which effective stresses flow.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum SurfaceKey {
    /// Mohr-Coulomb with cut-off.
    MohrCoulomb,
    /// Drucker-Prager.
    DruckerPrager,
    /// Through both listed uniaxial strengths.
    TwoSurface,
}

frictional_keys! {
    /// Plasticity with damage in tension and compression after Eq. (25) of Wang, Chen & Xiao (2019).
    PlasticDamageKeys {
        /// The surface at which effective stresses flow; Mohr-Coulomb by default.
        surface: Option<SurfaceKey>,
        /// The fit of a Drucker-Prager surface; inscribed by default.
        fit: Option<Fit>,
        /// Damage by the opening of cracks; that of the preset, or none.
        tension: Option<SofteningKeys>,
        /// Damage by crushing and shear; that of the preset, or none.
        compression: Option<SofteningKeys>,
        /// The share of tensile damage that heals when cracks close, 0 to 1; 1 by default.
        stiffness_recovery: Option<NonNegative>,
        /// The share of stiffness that no damage takes away, 0.001 by default.
        residual_stiffness: Option<Share>,
    }
}

/// How damage grows: either `fracture_energy`, or `rate` and `share` as they stand in Eq. (25).
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SofteningKeys {
    /// Energy per area of crack or crushing band (N/m), whatever the size of the elements.
    fracture_energy: Option<Positive>,
    /// B; the energy then depends on the mesh.
    rate: Option<Positive>,
    /// A, 1 by default.
    share: Option<NonNegative>,
    /// Equivalent plastic strain at first damage, 0 by default.
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
    /// The law on a surface.
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
        Ok(Material::from(law.map_err(placed)?).with_doubts(findings))
    }
}
