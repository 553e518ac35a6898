//! Hoek-Brown plasticity of rock masses.

use powerhouse_material_damage::{ElastoPlastic, HoekBrown, HoekBrownParameters};
use powerhouse_model::{ElasticMedium, ModelError};
use schemars::JsonSchema;
use serde::Deserialize;

use super::placed;
use crate::Registry;
use crate::spec::{NonNegative, PoissonRatio, Positive};
use powerhouse_laws::Material;

pub(super) fn register(registry: &mut Registry) {
    registry.add_law("hoek-brown", HoekBrownKeys::build);
}

/// Hoek-Brown plasticity of a rock mass (Hoek, Carranza-Torres & Corkum 2002).
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct HoekBrownKeys {
    /// Young's modulus of the rock mass (Pa), above 0.
    young: Positive,
    /// Poisson's ratio of the rock mass (dimensionless), above -1 and below 0.5.
    poisson: PoissonRatio,
    /// Mass density (kg/m3), above 0.
    density: Positive,
    /// Uniaxial compressive strength of the intact rock (Pa), above 0.
    intact_strength: Positive,
    /// Material constant m_i of the intact rock (dimensionless), 1 to 50.
    intact_constant: Positive,
    /// Geological strength index GSI (dimensionless), 5 to 100.
    strength_index: Positive,
    /// Disturbance factor D of blast damage and stress relief (dimensionless), 0 to 1; 0 by default.
    disturbance: Option<NonNegative>,
    /// Dilation as a share of that of associated flow (dimensionless), 0 to 1; 0 by default.
    dilation_share: Option<NonNegative>,
    /// Uniaxial tensile strength of the rock mass (Pa), with which that of the yield surface is compared.
    tensile_strength: Option<NonNegative>,
    /// Uniaxial compressive strength of the rock mass (Pa), with which that of the yield surface is compared.
    compressive_strength: Option<Positive>,
}

impl HoekBrownKeys {
    fn build(self) -> Result<Material, ModelError> {
        let [young, poisson, density] = [self.young.get(), self.poisson.get(), self.density.get()];
        let surface = HoekBrown::new(HoekBrownParameters {
            medium: ElasticMedium::new(young, poisson, density)?,
            intact_strength: self.intact_strength.get(),
            intact_constant: self.intact_constant.get(),
            strength_index: self.strength_index.get(),
            disturbance: self.disturbance.map_or(0.0, NonNegative::get),
            dilation_share: self.dilation_share.map_or(0.0, NonNegative::get),
        });
        let surface = surface.map_err(placed)?;
        let listed = [
            self.tensile_strength.map(NonNegative::get),
            self.compressive_strength.map(Positive::get),
        ];
        let warnings = surface.findings(listed);
        Ok(Material::from(ElastoPlastic::new(surface)).with_warnings(warnings))
    }
}
