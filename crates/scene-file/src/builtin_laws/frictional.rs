//! Frictional plasticity: Mohr-Coulomb, Drucker-Prager, and a two-surface law through given strengths.

use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, Finding, MohrCoulomb,
    MohrCoulombParameters, SofteningPlasticity, SofteningPlasticityParameters, StrengthFall,
    TwoSurface, TwoSurfaceParameters,
};
use powerhouse_model::ModelError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::preset::{self, Preset};
use super::{KeysError, placed, refused};
use crate::Registry;
use crate::spec::{Positive, Share};
use powerhouse_laws::Material;

pub(super) fn register(registry: &mut Registry) {
    let preset = Preset::frictional;
    preset::add(registry, "mohr-coulomb", preset, |keys: MohrCoulombKeys| {
        let (surface, warnings) = keys.frictional.mohr_coulomb()?;
        let material = match keys.softening {
            None => Material::from(ElastoPlastic::new(surface)),
            Some(keys) => Material::from(keys.law(surface)?),
        };
        Ok(material.with_warnings(warnings))
    });
    preset::add(
        registry,
        "drucker-prager",
        preset,
        |keys: DruckerPragerKeys| {
            let (surface, warnings) = keys.frictional.drucker_prager(keys.fit)?;
            Ok(Material::from(ElastoPlastic::new(surface)).with_warnings(warnings))
        },
    );
    preset::add(
        registry,
        "two-surface",
        preset,
        |p: TwoSurfaceParameters| {
            let surface = TwoSurface::new(p).map_err(placed)?;
            let warnings = surface.findings();
            Ok(Material::from(ElastoPlastic::new(surface)).with_warnings(warnings))
        },
    );
}

/// Keys of a frictional law: parameters of Mohr-Coulomb, and the compressive strength that is given beside them.
#[derive(Clone, Copy, Deserialize, Serialize, JsonSchema)]
pub(super) struct Frictional {
    #[serde(rename = "+")]
    #[schemars(flatten)]
    pub(super) surface: MohrCoulombParameters,
    /// Uniaxial compressive strength (Pa), above 0; a warning is given where the yield surface of the law implies another
    /// one.
    #[serde(with = "Positive", default, skip_serializing_if = "Option::is_none")]
    pub(super) compressive_strength: Option<f64>,
}

impl Frictional {
    pub(super) fn mohr_coulomb(&self) -> Result<(MohrCoulomb, Vec<Finding>), ModelError> {
        let surface = MohrCoulomb::new(self.surface).map_err(placed)?;
        let findings = surface.findings(self.compressive_strength);
        Ok((surface, findings))
    }
    pub(super) fn drucker_prager(
        &self,
        fit: ConeFit,
    ) -> Result<(DruckerPrager, Vec<Finding>), ModelError> {
        let own = &self.surface;
        let surface = DruckerPrager::new(DruckerPragerParameters {
            medium: own.medium,
            friction: own.friction,
            dilation: own.dilation,
            cohesion: own.cohesion,
            fit,
        });
        let surface = surface.map_err(placed)?;
        let findings = surface.findings([own.tension_strength, self.compressive_strength]);
        Ok((surface, findings))
    }
    pub(super) fn two_surface(&self) -> Result<(TwoSurface, Vec<Finding>), ModelError> {
        let own = &self.surface;
        let missing = |key: &str| refused("", KeysError::Missing(key.into()));
        let surface = TwoSurface::new(TwoSurfaceParameters {
            medium: own.medium,
            friction: own.friction,
            dilation: own.dilation,
            cohesion: own.cohesion,
            tension_strength: own
                .tension_strength
                .ok_or_else(|| missing("tensile_strength"))?,
            compression_strength: (self.compressive_strength)
                .ok_or_else(|| missing("compressive_strength"))?,
        });
        let surface = surface.map_err(placed)?;
        let findings = surface.findings();
        Ok((surface, findings))
    }
}

/// Mohr-Coulomb plasticity with tension cut-off and non-associated flow.
#[derive(Deserialize, JsonSchema)]
struct MohrCoulombKeys {
    #[serde(rename = "+")]
    #[schemars(flatten)]
    frictional: Frictional,
    /// Softening of cohesion and tension cut-off with plastic strain; none (perfect plasticity) by default.
    softening: Option<StrengthFallKeys>,
}

/// Softening: reduction of the strength with plastic shortening, defined by `fracture_energy` or by `rate`.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct StrengthFallKeys {
    /// Fracture energy: energy per area of a localisation band above that of the residual strength (N/m), above
    /// 0; independent of the element size.
    fracture_energy: Option<Positive>,
    /// Softening rate b with plastic shortening (dimensionless), above 0; the dissipated energy then depends on
    /// the element size.
    rate: Option<Positive>,
    /// Residual strength as a share of the initial one (dimensionless), 0.001 to 1.
    residual: Share,
}

impl StrengthFallKeys {
    /// Softening plasticity on a Mohr-Coulomb surface.
    fn law(self, surface: MohrCoulomb) -> Result<SofteningPlasticity<MohrCoulomb>, ModelError> {
        let fall = match (self.fracture_energy, self.rate) {
            (Some(energy), None) => StrengthFall::FractureEnergy {
                energy: energy.get(),
            },
            (None, Some(rate)) => StrengthFall::Rate(rate.get()),
            _ => return Err(refused("softening", KeysError::Fall)),
        };
        let law = SofteningPlasticity::new(SofteningPlasticityParameters {
            surface,
            fall,
            residual_strength: self.residual.get(),
        });
        law.map_err(placed)
    }
}

/// Drucker-Prager plasticity with non-associated flow.
#[derive(Deserialize, JsonSchema)]
struct DruckerPragerKeys {
    #[serde(rename = "+")]
    #[schemars(flatten)]
    frictional: Frictional,
    /// Fit of the cone to the Mohr-Coulomb surface; `inscribed` by default.
    #[serde(default)]
    fit: ConeFit,
}
