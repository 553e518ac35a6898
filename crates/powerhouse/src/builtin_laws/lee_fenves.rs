//! Concrete damaged plasticity after Lubliner, Lee and Fenves.

use powerhouse_material_damage::{LeeFenves, LeeFenvesParameters};
use powerhouse_model::ModelError;
use schemars::JsonSchema;
use serde::Deserialize;

use super::preset::Preset;
use super::{ElasticKeys, RESIDUAL_STIFFNESS, elastic_medium, missing, placed};
use crate::format::{NonNegative, PoissonRatio, Positive, Share};
use crate::{Material, Registry};

pub(super) fn register(registry: &mut Registry) {
    registry.add_law("lee-fenves", LeeFenvesKeys::build);
}

/// Concrete damaged plasticity: a surface of Lubliner et al. (1989) that softens, and damage in
/// tension and compression, after Lee & Fenves (1998).
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LeeFenvesKeys {
    /// A published concrete; other keys replace its parameters one by one.
    preset: Option<Preset>,
    /// Young's modulus (Pa).
    young: Option<Positive>,
    /// Poisson's ratio.
    poisson: Option<PoissonRatio>,
    /// Mass density (kg/m3).
    density: Option<Positive>,
    /// Uniaxial tensile strength (Pa).
    tensile_strength: Option<Positive>,
    /// Uniaxial compressive strength (Pa), at least the tensile one.
    compressive_strength: Option<Positive>,
    /// Uniaxial compressive stress at first flow (Pa), a tenth of the strength to the whole of it;
    /// the whole by default.
    compressive_limit: Option<Positive>,
    /// Strength in equal biaxial over that in uniaxial compression, 1 to 1.5; 1.16 by default.
    biaxial_ratio: Option<Positive>,
    /// K_c, radius of the surface on the tensile over that on the compressive meridian, 0.55 to 1;
    /// 2/3 by default.
    meridian_ratio: Option<Positive>,
    /// Dilation angle in the plane of mean and equivalent stress (degrees), from 1 on; 36 by
    /// default.
    dilation: Option<Positive>,
    /// Cracking.
    tension: Option<BandKeys>,
    /// Crushing.
    compression: Option<BandKeys>,
    /// The share of tensile damage that heals when cracks close, 0 to 1; 1 by default.
    stiffness_recovery: Option<NonNegative>,
    /// The share of stiffness that no damage takes away, 0.001 by default.
    residual_stiffness: Option<Share>,
}

/// A band of cracking or crushing.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct BandKeys {
    /// Energy per area of the band (N/m), whatever the size of the elements; that of the preset.
    fracture_energy: Option<Positive>,
    /// The share of damage in softening, 0 (all strain stays) to 1 (the effective strength stays);
    /// that of the preset, or 1 in tension and 0.5 in compression.
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
        // A preset's limit is a share of its own strength.
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
        let doubts = law.findings();
        Ok(Material::from(law).with_doubts(doubts))
    }
}
