//! Frictional plasticity: Mohr-Coulomb, Drucker-Prager, and a two-surface law through given strengths.

use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, Finding, MohrCoulomb,
    MohrCoulombParameters, SofteningPlasticity, SofteningPlasticityParameters, StrengthFall,
    TwoSurface, TwoSurfaceParameters,
};
use powerhouse_model::{ElasticMedium, ModelError};
use schemars::JsonSchema;
use serde::Deserialize;

use super::preset::{self, Preset};
use super::{ElasticKeys, KeysError, elastic_medium, missing, placed, refused};
use crate::Registry;
use crate::spec::{NonNegative, Positive, Share};
use powerhouse_laws::Material;

pub(super) fn register(registry: &mut Registry) {
    registry.add_law("mohr-coulomb", |keys: MohrCoulombKeys| {
        let (surface, warnings) = keys.frictional()?.mohr_coulomb()?;
        let material = match keys.softening {
            None => Material::from(ElastoPlastic::new(surface)),
            Some(keys) => Material::from(keys.law(surface)?),
        };
        preset::damped(keys.preset, material.with_warnings(warnings))
    });
    registry.add_law("drucker-prager", |keys: DruckerPragerKeys| {
        let (surface, warnings) = keys.frictional()?.drucker_prager(keys.fit)?;
        let material = Material::from(ElastoPlastic::new(surface)).with_warnings(warnings);
        preset::damped(keys.preset, material)
    });
    registry.add_law("two-surface", |keys: TwoSurfaceKeys| {
        let (surface, warnings) = keys.frictional()?.two_surface()?;
        let material = Material::from(ElastoPlastic::new(surface)).with_warnings(warnings);
        preset::damped(keys.preset, material)
    });
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

/// Fit of a Drucker-Prager cone to a Mohr-Coulomb surface.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Fit {
    /// Inscribed cone, tangent to all faces of the Mohr-Coulomb pyramid.
    Inscribed,
    /// Cone through the edges of triaxial compression; too strong for other stress paths.
    Circumscribed,
    /// Cone with the failure load of Mohr-Coulomb in plane strain.
    PlaneStrain,
}

/// Parameters of a frictional law: those of Mohr-Coulomb, and the compressive strength that is given beside them.
pub(super) struct Frictional {
    pub(super) surface: MohrCoulombParameters,
    /// Uniaxial compressive strength (Pa).
    pub(super) compression: Option<f64>,
}

impl Frictional {
    pub(super) fn mohr_coulomb(&self) -> Result<(MohrCoulomb, Vec<Finding>), ModelError> {
        let surface = MohrCoulomb::new(self.surface).map_err(placed)?;
        let findings = surface.findings(self.compression);
        Ok((surface, findings))
    }
    pub(super) fn drucker_prager(
        &self,
        fit: Option<Fit>,
    ) -> Result<(DruckerPrager, Vec<Finding>), ModelError> {
        let own = &self.surface;
        let surface = DruckerPrager::new(DruckerPragerParameters {
            medium: own.medium,
            friction: own.friction,
            dilation: own.dilation,
            cohesion: own.cohesion,
            fit: match fit {
                Some(Fit::Circumscribed) => ConeFit::Circumscribed,
                Some(Fit::PlaneStrain) => ConeFit::PlaneStrain,
                Some(Fit::Inscribed) | None => ConeFit::Inscribed,
            },
        });
        let surface = surface.map_err(placed)?;
        let findings = surface.findings([own.tension_strength, self.compression]);
        Ok((surface, findings))
    }
    pub(super) fn two_surface(&self) -> Result<(TwoSurface, Vec<Finding>), ModelError> {
        let own = &self.surface;
        let surface = TwoSurface::new(TwoSurfaceParameters {
            medium: own.medium,
            friction: own.friction,
            dilation: own.dilation,
            cohesion: own.cohesion,
            tension_strength: own.tension_strength.ok_or(missing("tensile_strength"))?,
            compression_strength: (self.compression).ok_or(missing("compressive_strength"))?,
        });
        let surface = surface.map_err(placed)?;
        let findings = surface.findings();
        Ok((surface, findings))
    }
}

/// Declares the keys of a frictional law: the common ones and those of the law.
macro_rules! frictional_keys {
    (
        $(#[$doc:meta])* $name:ident {
            $($(#[$own_doc:meta])* $own:ident: $type:ty,)*
        }
    ) => {
        $(#[$doc])*
        #[derive(serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields)]
        struct $name {
            /// Preset: name of a published material whose parameters are the defaults of the other keys.
            preset: Option<$crate::builtin_laws::preset::Preset>,
            /// Young's modulus (Pa), above 0.
            young: Option<$crate::spec::Positive>,
            /// Poisson's ratio (dimensionless), above -1 and below 0.5.
            poisson: Option<$crate::spec::PoissonRatio>,
            /// Mass density (kg/m3), above 0.
            density: Option<$crate::spec::Positive>,
            /// Friction angle (degrees), 0 to 75.
            friction: Option<$crate::spec::NonNegative>,
            /// Dilation angle (degrees), 0 to the friction angle; that of the preset, or 0.
            dilation: Option<$crate::spec::NonNegative>,
            /// Cohesion (Pa), 0 or above.
            cohesion: Option<$crate::spec::NonNegative>,
            /// Uniaxial tensile strength (Pa), 0 or above.
            tensile_strength: Option<$crate::spec::NonNegative>,
            /// Uniaxial compressive strength (Pa), above 0; a warning is given where the yield surface of the
            /// law implies another one.
            compressive_strength: Option<$crate::spec::Positive>,
            $($(#[$own_doc])* $own: $type,)*
        }

        impl $name {
            /// The keys, completed by those of the preset.
            fn frictional(
                &self,
            ) -> Result<$crate::builtin_laws::frictional::Frictional, powerhouse_model::ModelError> {
                use $crate::spec::{NonNegative, Positive};
                let preset = $crate::builtin_laws::frictional::OfPreset::new(self.preset)?;
                let elastic = $crate::builtin_laws::ElasticKeys {
                    young: self.young,
                    poisson: self.poisson,
                    density: self.density,
                };
                let tension = self.tensile_strength.map(NonNegative::get);
                let compression = self.compressive_strength.map(Positive::get);
                let dilation = preset.or(self.dilation, |p| p.dilation, "dilation");
                Ok($crate::builtin_laws::frictional::Frictional {
                    surface: powerhouse_material_damage::MohrCoulombParameters {
                        medium: preset.medium(elastic)?,
                        friction: preset.or(self.friction, |p| p.friction, "friction")?,
                        dilation: dilation.unwrap_or(0.0),
                        cohesion: preset.or(self.cohesion, |p| p.cohesion, "cohesion")?,
                        tension_strength: tension.or(preset.tension()),
                    },
                    compression: compression.or(preset.compression),
                })
            }
        }
    };
}
pub(super) use frictional_keys;

/// Parameters of the preset of a frictional law, if it has one.
pub(super) struct OfPreset {
    surface: Option<MohrCoulombParameters>,
    /// Listed uniaxial compressive strength (Pa).
    pub(super) compression: Option<f64>,
}

impl OfPreset {
    pub(super) fn new(preset: Option<Preset>) -> Result<Self, ModelError> {
        let found = preset.map(Preset::surface).transpose()?;
        let (surface, compression) = found.unzip();
        Ok(Self {
            surface,
            compression,
        })
    }
    pub(super) fn medium(&self, keys: ElasticKeys) -> Result<ElasticMedium, ModelError> {
        elastic_medium(keys, self.surface.map(|surface| surface.medium))
    }
    pub(super) fn tension(&self) -> Option<f64> {
        self.surface.and_then(|surface| surface.tension_strength)
    }
    /// A given value, or that of the preset.
    pub(super) fn or(
        &self,
        given: Option<NonNegative>,
        of: fn(&MohrCoulombParameters) -> f64,
        key: &'static str,
    ) -> Result<f64, ModelError> {
        let given = given.map(NonNegative::get);
        given.or(self.surface.as_ref().map(of)).ok_or(missing(key))
    }
}

frictional_keys! {
    /// Mohr-Coulomb plasticity with tension cut-off and non-associated flow.
    MohrCoulombKeys {
        /// Softening of cohesion and tension cut-off with plastic strain; none (perfect plasticity) by default.
        softening: Option<StrengthFallKeys>,
    }
}

frictional_keys! {
    /// Drucker-Prager plasticity with non-associated flow.
    DruckerPragerKeys {
        /// Fit of the cone to the Mohr-Coulomb surface; `inscribed` by default.
        fit: Option<Fit>,
    }
}

frictional_keys! {
    /// Two-surface plasticity: yield surfaces through the given uniaxial strengths, with the friction of
    /// Mohr-Coulomb under confinement.
    TwoSurfaceKeys {}
}
