//! Laws of rock and concrete that every registry holds from the start.

use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, Finding, MaterialError, Mazars,
    MazarsParameters, MazarsTension, MohrCoulomb, MohrCoulombParameters, PlasticDamage,
    PlasticDamageParameters, Softening, TwoSurface, TwoSurfaceParameters, YieldSurface, presets,
};
use powerhouse_model::{ElasticMedium, ModelError};
use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

use crate::format::{NonNegative, PoissonRatio, Positive, Share};
use crate::{Material, Registry};

pub(crate) fn register(registry: &mut Registry) {
    registry.add_law("mohr-coulomb", |keys: MohrCoulombKeys| {
        let (surface, doubts) = keys.frictional()?.mohr_coulomb()?;
        Ok(Material::new(ElastoPlastic::new(surface)).with_doubts(doubts))
    });
    registry.add_law("drucker-prager", |keys: DruckerPragerKeys| {
        let (surface, doubts) = keys.frictional()?.drucker_prager(keys.fit)?;
        Ok(Material::new(ElastoPlastic::new(surface)).with_doubts(doubts))
    });
    registry.add_law("two-surface", |keys: TwoSurfaceKeys| {
        let (surface, doubts) = keys.frictional()?.two_surface()?;
        Ok(Material::new(ElastoPlastic::new(surface)).with_doubts(doubts))
    });
    registry.add_law("plastic-damage", PlasticDamageKeys::build);
    registry.add_law("mazars", MazarsKeys::build);
}

/// What is wrong with the keys of a law as a whole.
#[derive(Debug, Error)]
enum KeysError {
    #[error("the key '{0}' is missing; a preset would give it")]
    Missing(&'static str),
    #[error("either fracture_energy, or rate and perhaps share must be given")]
    Softening,
    #[error("only a Drucker-Prager surface has a fit")]
    Fit,
    #[error("the preset has no parameters of this law")]
    Preset,
}

/// Refused at the place of a key, or of the whole table.
fn refused(key: &'static str, error: KeysError) -> ModelError {
    ModelError::refused(key, error)
}

/// What a material refuses, under the key that is at fault.
fn placed(error: MaterialError) -> ModelError {
    match error {
        MaterialError::Parameter(mut parameter) => {
            parameter.name = match parameter.name {
                "tension_strength" => "tensile_strength",
                "compression_strength" => "compressive_strength",
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

/// Published materials.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
enum Preset {
    /// The rock of Wang, Chen & Xiao (2019), Table 1.
    #[serde(rename = "paper-rock")]
    PaperRock,
    /// The concrete C25 of Wang, Chen & Xiao (2019), Table 1.
    #[serde(rename = "paper-c25")]
    PaperC25,
    /// Concrete C20/25 of Eurocode 2.
    C20,
    /// Concrete C25/30 of Eurocode 2.
    C25,
    /// Concrete C30/37 of Eurocode 2.
    C30,
    /// Concrete C35/45 of Eurocode 2.
    C35,
    /// Concrete C40/50 of Eurocode 2.
    C40,
}

impl Preset {
    /// The characteristic strength (MPa) of a concrete of Eurocode 2.
    fn strength(self) -> Option<f64> {
        match self {
            Self::PaperRock | Self::PaperC25 => None,
            Self::C20 => Some(20.0),
            Self::C25 => Some(25.0),
            Self::C30 => Some(30.0),
            Self::C35 => Some(35.0),
            Self::C40 => Some(40.0),
        }
    }
    /// The plastic-damage concrete, if the preset is one.
    fn concrete(self) -> Result<Option<PlasticDamage<MohrCoulomb>>, ModelError> {
        let concrete = match (self, self.strength()) {
            (Self::PaperC25, _) => Some(presets::paper_concrete()),
            (_, Some(strength)) => Some(presets::eurocode_concrete(strength)),
            _ => None,
        };
        concrete.transpose().map_err(placed)
    }
    /// Surface and listed compressive strength (Pa).
    fn surface(self) -> Result<(MohrCoulombParameters, f64), ModelError> {
        Ok(match (self, self.concrete()?) {
            (Self::PaperC25, _) => {
                let listed = presets::PAPER_CONCRETE_LISTED.compression_strength;
                (presets::PAPER_CONCRETE, listed)
            }
            (_, Some(concrete)) => {
                let surface = concrete.parameters().surface;
                (*surface.parameters(), surface.uniaxial_compression())
            }
            (_, None) => {
                let listed = presets::PAPER_ROCK_LISTED.compression_strength;
                (presets::PAPER_ROCK, listed)
            }
        })
    }
}

/// To which stresses of Mohr and Coulomb a cone is fitted.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum Fit {
    /// Touches all faces from within.
    Inscribed,
    /// Through the edges of triaxial compression; too strong elsewhere.
    Circumscribed,
    /// Fails in plane strain where Mohr-Coulomb does.
    PlaneStrain,
}

/// Elastic medium, friction and strengths.
struct Frictional {
    medium: ElasticMedium,
    friction: f64,
    dilation: f64,
    cohesion: f64,
    tension: Option<f64>,
    compression: Option<f64>,
}

impl Frictional {
    fn mohr_coulomb(&self) -> Result<(MohrCoulomb, Vec<Finding>), ModelError> {
        let surface = MohrCoulomb::new(MohrCoulombParameters {
            medium: self.medium,
            friction: self.friction,
            dilation: self.dilation,
            cohesion: self.cohesion,
            tension_strength: self.tension,
        });
        let surface = surface.map_err(placed)?;
        let findings = surface.findings(self.compression);
        Ok((surface, findings))
    }
    fn drucker_prager(
        &self,
        fit: Option<Fit>,
    ) -> Result<(DruckerPrager, Vec<Finding>), ModelError> {
        let surface = DruckerPrager::new(DruckerPragerParameters {
            medium: self.medium,
            friction: self.friction,
            dilation: self.dilation,
            cohesion: self.cohesion,
            fit: match fit {
                Some(Fit::Circumscribed) => ConeFit::Circumscribed,
                Some(Fit::PlaneStrain) => ConeFit::PlaneStrain,
                Some(Fit::Inscribed) | None => ConeFit::Inscribed,
            },
        });
        let surface = surface.map_err(placed)?;
        let findings = surface.findings([self.tension, self.compression]);
        Ok((surface, findings))
    }
    fn two_surface(&self) -> Result<(TwoSurface, Vec<Finding>), ModelError> {
        let missing = |key| refused("", KeysError::Missing(key));
        let surface = TwoSurface::new(TwoSurfaceParameters {
            medium: self.medium,
            friction: self.friction,
            dilation: self.dilation,
            cohesion: self.cohesion,
            tension_strength: self.tension.ok_or(missing("tensile_strength"))?,
            compression_strength: (self.compression).ok_or(missing("compressive_strength"))?,
        });
        let surface = surface.map_err(placed)?;
        let findings = surface.findings();
        Ok((surface, findings))
    }
}

/// Declares the keys of a law with friction, and some of its own.
macro_rules! frictional_keys {
    (
        $(#[$doc:meta])* $name:ident {
            $($(#[$own_doc:meta])* $own:ident: $type:ty,)*
        }
    ) => {
        $(#[$doc])*
        #[derive(Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        struct $name {
            /// A published material; other keys replace its parameters one by one.
            preset: Option<Preset>,
            /// Young's modulus (Pa).
            young: Option<Positive>,
            /// Poisson's ratio.
            poisson: Option<PoissonRatio>,
            /// Mass density (kg/m3).
            density: Option<Positive>,
            /// Friction angle (degrees), at most 75.
            friction: Option<NonNegative>,
            /// Dilation angle (degrees), at most the friction angle; that of the preset, or 0.
            dilation: Option<NonNegative>,
            /// Cohesion (Pa).
            cohesion: Option<NonNegative>,
            /// Uniaxial tensile strength (Pa).
            tensile_strength: Option<NonNegative>,
            /// Uniaxial compressive strength (Pa); surfaces that do not depend on it are checked
            /// against it.
            compressive_strength: Option<Positive>,
            $($(#[$own_doc])* $own: $type,)*
        }

        impl $name {
            fn frictional(&self) -> Result<Frictional, ModelError> {
                let preset = self.preset.map(Preset::surface).transpose()?;
                let given = |own: Option<f64>, of: fn(&MohrCoulombParameters) -> f64, key| {
                    own.or(preset.as_ref().map(|(preset, _)| of(preset)))
                        .ok_or(refused("", KeysError::Missing(key)))
                };
                let young = given(self.young.map(Positive::get), |p| p.medium.young, "young")?;
                let poisson = self.poisson.map(PoissonRatio::get);
                let poisson = given(poisson, |p| p.medium.poisson, "poisson")?;
                let density = self.density.map(Positive::get);
                let density = given(density, |p| p.medium.density, "density")?;
                let angle = self.friction.map(NonNegative::get);
                let cohesion = self.cohesion.map(NonNegative::get);
                let dilation = self.dilation.map(NonNegative::get);
                let tension = self.tensile_strength.map(NonNegative::get);
                let compression = self.compressive_strength.map(Positive::get);
                Ok(Frictional {
                    medium: ElasticMedium::new(young, poisson, density)?,
                    friction: given(angle, |p| p.friction, "friction")?,
                    dilation: given(dilation, |p| p.dilation, "dilation").unwrap_or(0.0),
                    cohesion: given(cohesion, |p| p.cohesion, "cohesion")?,
                    tension: tension.or(preset.as_ref().and_then(|(p, _)| p.tension_strength)),
                    compression: compression.or(preset.as_ref().map(|(_, listed)| *listed)),
                })
            }
        }
    };
}

frictional_keys! {
    /// Mohr-Coulomb plasticity with tension cut-off and dilation.
    MohrCoulombKeys {}
}

frictional_keys! {
    /// Drucker-Prager plasticity.
    DruckerPragerKeys {
        /// The fit of the cone to Mohr-Coulomb; inscribed by default.
        fit: Option<Fit>,
    }
}

frictional_keys! {
    /// Plasticity that honours listed uniaxial strengths, with the friction of Mohr-Coulomb under
    /// confinement.
    TwoSurfaceKeys {}
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
    ) -> Result<Material, ModelError> {
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
        Ok(Material::new(law.map_err(placed)?).with_doubts(findings))
    }
}

/// The share of stiffness that no damage takes away, unless a scene says otherwise.
const RESIDUAL_STIFFNESS: f64 = 1.0e-3;

/// Damage in total strain after Mazars (1986).
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MazarsKeys {
    /// A published material, `paper-c25`; other keys replace its parameters one by one.
    preset: Option<Preset>,
    /// Young's modulus (Pa).
    young: Option<Positive>,
    /// Poisson's ratio.
    poisson: Option<PoissonRatio>,
    /// Mass density (kg/m3).
    density: Option<Positive>,
    /// Equivalent strain at first damage.
    threshold: Option<Positive>,
    /// Softening in tension.
    tension: Option<MazarsTensionKeys>,
    /// Softening in compression.
    compression: Option<MazarsCompressionKeys>,
    /// The share of stiffness that no damage takes away, 0.001 by default.
    residual_stiffness: Option<Share>,
}

/// How damage grows in tension: either `fracture_energy`, or `rate` and `share`.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MazarsTensionKeys {
    /// Energy per area of crack (N/m).
    fracture_energy: Option<Positive>,
    /// B, at least the inverse of the threshold.
    rate: Option<Positive>,
    /// A, 1 by default.
    share: Option<Share>,
}

/// How damage grows in compression.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MazarsCompressionKeys {
    /// B.
    rate: Positive,
    /// A, 0 to 2.
    share: NonNegative,
}

impl MazarsKeys {
    fn build(self) -> Result<Material, ModelError> {
        let preset = match self.preset {
            None => None,
            Some(Preset::PaperC25) => Some(presets::PAPER_CONCRETE_MAZARS),
            Some(_) => return Err(refused("preset", KeysError::Preset)),
        };
        let missing = |key| refused("", KeysError::Missing(key));
        let given = |own: Option<f64>, of: fn(&MazarsParameters) -> f64, key| {
            own.or(preset.as_ref().map(of)).ok_or(missing(key))
        };
        let young = given(self.young.map(Positive::get), |p| p.medium.young, "young")?;
        let poisson = self.poisson.map(PoissonRatio::get);
        let poisson = given(poisson, |p| p.medium.poisson, "poisson")?;
        let density = self.density.map(Positive::get);
        let density = given(density, |p| p.medium.density, "density")?;
        let tension = match self.tension {
            Some(MazarsTensionKeys {
                fracture_energy: Some(energy),
                rate: None,
                share: None,
            }) => MazarsTension::FractureEnergy {
                energy: energy.get(),
            },
            Some(MazarsTensionKeys {
                fracture_energy: None,
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
        let medium = ElasticMedium::new(young, poisson, density)?;
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
        let doubts = Finding::of_medium(&medium);
        Ok(Material::new(law.map_err(placed)?).with_doubts(doubts))
    }
}
