//! Presets: published materials, by their names in scenes.

use powerhouse_material_damage::{
    DampingBand, LeeFenvesParameters, MohrCoulomb, MohrCoulombParameters, PlasticDamage,
    ReferenceFrequency, RelaxationSpectrum, YieldSurface, presets,
};
use powerhouse_model::ModelError;
use schemars::JsonSchema;
use serde::Deserialize;

use super::{KeysError, placed, refused};
use powerhouse_laws::{Damping, Material};

/// Preset: published material.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
pub(super) enum Preset {
    /// Rock of Wang, Chen & Xiao (2019), Table 1. Its cohesion and friction do not correspond to the strengths
    /// that the table lists beside them: with the laws mohr-coulomb, drucker-prager and plastic-damage it
    /// yields at 0.935 MPa in uniaxial tension and at 4.72 MPa in uniaxial compression, not at 1.3 and
    /// 35 MPa. law = "two-surface" with this preset has the listed strengths; so does plastic-damage
    /// with surface = "two-surface".
    #[serde(rename = "paper-rock")]
    PaperRock,
    /// Concrete C25 of Wang, Chen & Xiao (2019), Table 1. Its cohesion and friction do not correspond to the
    /// strengths that the table lists beside them: with the laws mohr-coulomb, drucker-prager and
    /// plastic-damage it yields at 1.006 MPa in uniaxial tension and at 6.72 MPa in uniaxial compression,
    /// not at 1.27 and 16.7 MPa. The laws two-surface, lee-fenves and mazars with this preset have the
    /// listed strengths, and plastic-damage with surface = "two-surface"; the presets C20 to C40 agree with
    /// their own strengths in every law.
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

/// Frequencies (Hz) between which materials of presets are damped by default: those of strong motion and of the response
/// of floors.
const BAND: [f64; 2] = [0.5, 20.0];
/// Damping ratio of reinforced concrete below yielding, US NRC Regulatory Guide 1.61 (2007), Table 1; what cracks and
/// yields dissipates by its law besides.
const OF_CONCRETE: f64 = 0.04;
/// Damping ratio of jointed hard rock: a quality factor of 25.
const OF_ROCK: f64 = 0.02;
/// Number of relaxation mechanisms.
const MECHANISMS: usize = 3;

/// A material with the default damping of its preset. Moduli hold at the centre of the band, so that forces and wave
/// speeds of strong motion are those of the material without damping.
pub(super) fn damped(preset: Option<Preset>, material: Material) -> Result<Material, ModelError> {
    let Some(preset) = preset else {
        return Ok(material);
    };
    let ratio = match preset {
        Preset::PaperRock => OF_ROCK,
        _ => OF_CONCRETE,
    };
    let [lowest, highest] = BAND;
    let spectrum = RelaxationSpectrum::fit(DampingBand {
        ratio,
        lowest,
        highest,
        mechanisms: MECHANISMS,
    })?;
    Ok(material.with_default_damping(Damping::Flat {
        spectrum,
        reference: ReferenceFrequency::Centre,
    }))
}

impl Preset {
    /// Characteristic compressive strength of a concrete of Eurocode 2 (MPa).
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
    /// Plastic-damage law of a concrete preset; `None` for rock.
    pub(super) fn concrete(self) -> Result<Option<PlasticDamage<MohrCoulomb>>, ModelError> {
        let concrete = match (self, self.strength()) {
            (Self::PaperC25, _) => Some(presets::paper_concrete()),
            (_, Some(strength)) => Some(presets::eurocode_concrete(strength)),
            _ => None,
        };
        concrete.transpose().map_err(placed)
    }
    /// Parameters of the Mohr-Coulomb surface, and listed uniaxial compressive strength (Pa).
    pub(super) fn surface(self) -> Result<(MohrCoulombParameters, f64), ModelError> {
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
    /// Parameters of the Lee-Fenves law of a concrete preset.
    pub(super) fn lee_fenves(self) -> Result<LeeFenvesParameters, ModelError> {
        match (self, self.strength()) {
            (Self::PaperC25, _) => Ok(presets::PAPER_CONCRETE_LEE_FENVES),
            (_, Some(strength)) => presets::eurocode_lee_fenves(strength).map_err(placed),
            _ => Err(refused("preset", KeysError::Preset)),
        }
    }
}
