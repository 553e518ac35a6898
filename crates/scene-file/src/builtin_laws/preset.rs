//! Presets: published materials, by their names in scenes.

use powerhouse_laws::{Damping, Material};
use powerhouse_material_damage::{
    DampingBand, MohrCoulomb, PlasticDamage, ReferenceFrequency, RelaxationSpectrum, YieldSurface,
    presets,
};
use powerhouse_model::ModelError;
use powerhouse_scene::{Fault, Problem};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use toml::Table;

use super::frictional::Frictional;
use super::{KeysError, refused};
use crate::Registry;
use crate::registry::placed;
use crate::spec::Parameters;

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

/// Adds a law of which presets give keys: as they would be in a table.
pub(super) fn add<P, F>(
    registry: &mut Registry,
    name: &str,
    table: fn(Preset) -> Result<Table, ModelError>,
    build: F,
) where
    P: DeserializeOwned + JsonSchema,
    F: Fn(P) -> Result<Material, ModelError> + Send + Sync + 'static,
{
    let build = move |parameters: &Parameters| {
        let mut own = parameters.clone();
        own.retain(|key| key == PRESET);
        let OfPreset { preset } = own.decode()?;
        let refused = |error| placed(parameters, error);
        let defaults = preset.map(table).transpose().map_err(refused)?;
        own.clone_from(parameters);
        own.retain(|key| key != PRESET);
        let read = own.decode_by_schema(&defaults.unwrap_or_default());
        let read = read.map_err(|fault| match fault.problem() {
            Problem::MissingKey { key } if fault.span() == parameters.span_of("") => {
                Fault::refused(fault.span(), KeysError::Missing(key.clone()))
            }
            _ => fault.with_permitted(&[PRESET]),
        });
        let material = build(read?).map_err(refused)?;
        Ok(match preset {
            Some(preset) => material.with_default_damping(preset.damping().map_err(refused)?),
            None => material,
        })
    };
    registry.add_law_of_table(name, build, schema::<P>);
}

/// Schema of the keys of a law with presets, of which none is required.
fn schema<P: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    let mut schema = P::json_schema(generator);
    schema.remove("required");
    let preset = OfPreset::json_schema(generator)
        .pointer("/properties/preset")
        .cloned();
    let keys = schema
        .pointer_mut("/properties")
        .and_then(Value::as_object_mut);
    if let (Some(keys), Some(preset)) = (keys, preset) {
        keys.insert(PRESET.into(), preset);
    }
    schema
}

/// Key of the preset.
const PRESET: &str = "preset";

/// The preset of a table.
#[derive(Deserialize, JsonSchema)]
struct OfPreset {
    /// Preset: name of a published material whose parameters are the defaults of the other keys.
    preset: Option<Preset>,
}

/// Parameters as keys of a table.
fn keys(parameters: &impl Serialize) -> Result<Table, ModelError> {
    let table = Table::try_from(parameters);
    table
        .map(joined)
        .map_err(|error| ModelError::refused(PRESET, error))
}

/// A table with the keys of fields that take theirs from the same table.
fn joined(table: Table) -> Table {
    let mut all = Table::new();
    for (key, value) in table {
        match value {
            toml::Value::Table(within) if key == "+" => all.extend(joined(within)),
            value => _ = all.insert(key, value),
        }
    }
    all
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
    /// Default damping of the material. Moduli hold at the centre of the band, so that forces and wave speeds of strong
    /// motion are those of the material without damping.
    fn damping(self) -> Result<Damping, ModelError> {
        let ratio = match self {
            Self::PaperRock => OF_ROCK,
            _ => OF_CONCRETE,
        };
        let [lowest, highest] = BAND;
        let spectrum = RelaxationSpectrum::fit(DampingBand {
            ratio,
            lowest,
            highest,
            mechanisms: MECHANISMS,
        })?;
        Ok(Damping::Flat {
            spectrum,
            reference: ReferenceFrequency::Centre,
        })
    }
    /// Plastic-damage law of a concrete preset; `None` for rock.
    fn concrete(self) -> Result<Option<PlasticDamage<MohrCoulomb>>, ModelError> {
        let concrete = match (self, self.strength()) {
            (Self::PaperC25, _) => Some(presets::paper_concrete()),
            (_, Some(strength)) => Some(presets::eurocode_concrete(strength)),
            _ => None,
        };
        concrete.transpose().map_err(super::placed)
    }
    /// Mohr-Coulomb parameters, and listed uniaxial compressive strength.
    fn listed(self) -> Result<Frictional, ModelError> {
        let (surface, strength) = match (self, self.concrete()?) {
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
        };
        let compressive_strength = Some(strength);
        Ok(Frictional {
            surface,
            compressive_strength,
        })
    }
    /// Keys of a frictional law.
    pub(super) fn frictional(self) -> Result<Table, ModelError> {
        keys(&self.listed()?)
    }
    /// Keys of a plastic-damage law.
    pub(super) fn plastic_damage(self) -> Result<Table, ModelError> {
        let listed = self.listed()?;
        match self.concrete()? {
            Some(concrete) => keys(&concrete.parameters().with_surface(listed)),
            None => keys(&listed),
        }
    }
    /// Keys of a Mazars law.
    pub(super) fn mazars(self) -> Result<Table, ModelError> {
        match self {
            Self::PaperC25 => keys(&presets::PAPER_CONCRETE_MAZARS),
            _ => Err(refused(PRESET, KeysError::Preset)),
        }
    }
    /// Keys of a Lee-Fenves law of a concrete preset. The compressive limit is that of the strength, whatever this is.
    pub(super) fn lee_fenves(self) -> Result<Table, ModelError> {
        let mut table = match (self, self.strength()) {
            (Self::PaperC25, _) => keys(&presets::PAPER_CONCRETE_LEE_FENVES),
            (_, Some(strength)) => {
                keys(&presets::eurocode_lee_fenves(strength).map_err(super::placed)?)
            }
            _ => Err(refused(PRESET, KeysError::Preset)),
        }?;
        table.remove("compressive_limit");
        Ok(table)
    }
}
