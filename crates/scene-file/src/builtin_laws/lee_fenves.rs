//! Concrete damaged plasticity of Lubliner, Lee and Fenves.

use powerhouse_material_damage::{LeeFenves, LeeFenvesParameters};
use powerhouse_model::ModelError;
use schemars::JsonSchema;
use serde::Deserialize;

use super::preset::{self, Preset};
use super::{ElasticKeys, RESIDUAL_STIFFNESS, elastic_medium, missing, placed};
use crate::Registry;
use crate::spec::{NonNegative, PoissonRatio, Positive, Share};
use powerhouse_laws::Material;

pub(super) fn register(registry: &mut Registry) {
    registry.add_law("lee-fenves", LeeFenvesKeys::build);
}

/// Concrete damaged plasticity: yield surface of Lubliner et al. (1989) with hardening and softening, and damage in
/// tension and compression (Lee & Fenves 1998).
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LeeFenvesKeys {
    /// Preset: name of a published concrete whose parameters are the defaults of the other keys.
    preset: Option<Preset>,
    /// Young's modulus (Pa), above 0.
    young: Option<Positive>,
    /// Poisson's ratio (dimensionless), above -1 and below 0.5.
    poisson: Option<PoissonRatio>,
    /// Mass density (kg/m3), above 0.
    density: Option<Positive>,
    /// Uniaxial tensile strength (Pa), above 0.
    tensile_strength: Option<Positive>,
    /// Uniaxial compressive strength (Pa), at least the tensile strength.
    compressive_strength: Option<Positive>,
    /// Uniaxial compressive stress at initial yield (Pa), 0.1 to 1 times the compressive strength; 1 by default.
    compressive_limit: Option<Positive>,
    /// Ratio of equibiaxial to uniaxial compressive strength (dimensionless), 1 to 1.5; 1.16 by default.
    biaxial_ratio: Option<Positive>,
    /// Meridian ratio K_c: radius of the yield surface on the tensile over that on the compressive meridian
    /// (dimensionless), 0.55 to 1; 2/3 by default.
    meridian_ratio: Option<Positive>,
    /// Dilation angle in the plane of mean and equivalent stress (degrees), 1 or above; 36 by default.
    dilation: Option<Positive>,
    /// Softening and damage in tension (cracking).
    tension: Option<BandKeys>,
    /// Softening and damage in compression (crushing).
    compression: Option<BandKeys>,
    /// Stiffness recovery: share of tensile damage that vanishes when cracks close (dimensionless), 0 to 1; 1 by
    /// default.
    stiffness_recovery: Option<NonNegative>,
    /// Residual stiffness: share that remains at full damage (dimensionless), 0.001 by default.
    residual_stiffness: Option<Share>,
}

/// Softening in a band of cracking or crushing.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct BandKeys {
    /// Fracture energy per area of the band (N/m), above 0, independent of the element size; that of the preset
    /// by default.
    fracture_energy: Option<Positive>,
    /// Share of damage in softening (dimensionless), 0 (plastic softening alone) to 1 (damage alone, constant
    /// effective strength); that of the preset, or 1 in tension and 0.5 in compression.
    damage: Option<NonNegative>,
}

impl LeeFenvesKeys {
    fn build(self) -> Result<Material, ModelError> {
        let preset = self.preset.map(Preset::lee_fenves).transpose()?;
        let of_preset = |of: fn(&LeeFenvesParameters) -> f64| preset.as_ref().map(of);
        let elastic = ElasticKeys {
            young: self.young,
            poisson: self.poisson,
            density: self.density,
        };
        let medium = elastic_medium(elastic, preset.map(|preset| preset.medium))?;
        let strength = |own: Option<Positive>, of, key| {
            let own = own.map(Positive::get);
            own.or(of_preset(of)).ok_or(missing(key))
        };
        let usual = |own: Option<Positive>, of, usual: f64| {
            let own = own.map(Positive::get);
            own.or(of_preset(of)).unwrap_or(usual)
        };
        let energy = |band: Option<BandKeys>, of, key| {
            let own = band.and_then(|band| band.fracture_energy);
            own.map(Positive::get).or(of_preset(of)).ok_or(missing(key))
        };
        let damage = |band: Option<BandKeys>, of, usual: f64| {
            let own = band.and_then(|band| band.damage).map(NonNegative::get);
            own.or(of_preset(of)).unwrap_or(usual)
        };
        let compression_strength = strength(
            self.compressive_strength,
            |p| p.compression_strength,
            "compressive_strength",
        )?;
        // The limit of a preset is given as a share of its strength.
        let limit_share = of_preset(|p| p.compression_limit / p.compression_strength);
        let limit = self.compressive_limit.map(Positive::get);
        let recovery = self.stiffness_recovery.map(NonNegative::get);
        let residual = self.residual_stiffness.map(Share::get);
        let law = LeeFenves::new(LeeFenvesParameters {
            medium,
            tension_strength: strength(
                self.tensile_strength,
                |p| p.tension_strength,
                "tensile_strength",
            )?,
            compression_strength,
            compression_limit: limit.unwrap_or(compression_strength * limit_share.unwrap_or(1.0)),
            biaxial_ratio: usual(self.biaxial_ratio, |p| p.biaxial_ratio, 1.16),
            meridian_ratio: usual(self.meridian_ratio, |p| p.meridian_ratio, 2.0 / 3.0),
            dilation: usual(self.dilation, |p| p.dilation, 36.0),
            tension_energy: energy(
                self.tension,
                |p| p.tension_energy,
                "tension.fracture_energy",
            )?,
            compression_energy: energy(
                self.compression,
                |p| p.compression_energy,
                "compression.fracture_energy",
            )?,
            tension_damage: damage(self.tension, |p| p.tension_damage, 1.0),
            compression_damage: damage(self.compression, |p| p.compression_damage, 0.5),
            stiffness_recovery: recovery
                .or(of_preset(|p| p.stiffness_recovery))
                .unwrap_or(1.0),
            residual_stiffness: residual
                .or(of_preset(|p| p.residual_stiffness))
                .unwrap_or(RESIDUAL_STIFFNESS),
        });
        let law = law.map_err(placed)?;
        let warnings = law.findings();
        preset::damped(self.preset, Material::from(law).with_warnings(warnings))
    }
}
