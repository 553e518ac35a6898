//! Materials, parts and their damping.

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::{At, Finite, NonNegative, Parameters, Positive, ReferenceFrequency, Share};

/// Material: a constitutive law of the registry and its parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
pub struct Material {
    /// Name to which parts refer.
    pub name: At<String>,
    /// Constitutive law: its name in the registry, such as `elastic`.
    pub law: At<String>,
    /// Water that fills the pores: the law sees effective stress. Dry by default. The density of the material is that of
    /// grains and water together.
    pub pore_water: Option<At<PoreWater>>,
    /// All other keys of the table: parameters of the law.
    #[serde(skip_deserializing, flatten)]
    #[schemars(skip)]
    pub parameters: Parameters,
}

/// Water in the pores of a material: drained in construction stages, with hydrostatic pressure below a level; in the run it
/// cannot flow, and its pressure grows by bulk modulus over porosity times the decrease of volume.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct PoreWater {
    /// Share of the pores in the volume, above 0 and at most 1.
    pub porosity: Share,
    /// Height z of the water level (m), for which the scene must have an in-situ stress, of total stresses; without it
    /// there is no pressure at the start of the run. Above it the pores are full, too, without pressure at the start.
    pub level: Option<At<Finite>>,
    /// Pressures by height in place of a level: pairs of height z (m) and pressure (Pa, 0 or above) from the top downwards, two or
    /// more, with straight lines between. The table reaches over the centres of all elements of the material.
    pub pressures: Option<At<Vec<[Finite; 2]>>>,
    /// Bulk modulus of the water (Pa), above 0; 2.2e9 by default, less where there is gas in it.
    pub bulk_modulus: Option<At<Positive>>,
    /// Density of the water (kg/m3), above 0; 1000 by default.
    pub density: Option<Positive>,
    /// Permeability of the ground for water (hydraulic conductivity, m/s), above 0: from it `check` states how far pressures spread
    /// during the run, in which no water flows, and warns where that is wrong. Unknown by default.
    pub permeability: Option<Positive>,
}

/// Part: an element set with its material, element kernel and damping.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Element set of the mesh.
    pub set: At<String>,
    /// Name of the material.
    pub material: At<String>,
    /// Element kernel: its name in the registry, such as `hex8-one-point`. Elements of a kind for which the
    /// kernel is not made have the default kernel of their kind, as have all elements by default.
    pub kernel: Option<At<String>>,
    /// Material damping, or `"none"`. By default, where waves are incident, that of the preset of the material: then the
    /// elements of the part that touch an absorbing face are its `elastic_rim`. A part whose material has no preset is
    /// not damped by default. Rock along an absorbing face should be undamped, because the free field is elastic:
    /// give a part with damping of its own an `elastic_rim`.
    pub damping: Option<At<Damping>>,
    /// Width of the elastic, undamped zone along the absorbing faces (m), 0 or above: elements that touch a
    /// face, and elements with a node closer than this, have no damping and the elastic law, as the free field.
    /// 0: only elements that touch a face, the default of a part with the damping of a preset; otherwise no rim by
    /// default.
    pub elastic_rim: Option<At<NonNegative>>,
}

/// Material damping of a part.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind", transform = or_none)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Damping {
    /// No damping, whatever the material has by default; written as the text `"none"`.
    #[schemars(skip)]
    None,
    /// Rayleigh damping `C = mass M + stiffness K` with a given damping ratio at two frequencies, less between
    /// and more outside of them. The stiffness part reduces the stable step; where a law yields or cracks it
    /// is proportional to the degraded stiffness. Its stress is not contained in any output.
    Rayleigh {
        /// Damping ratio (share of critical damping) at both frequencies, above 0 and at most 1; 0.05 for 5 %.
        ratio: Share,
        /// The two frequencies (Hz), above 0, the lower one first.
        frequencies: [Positive; 2],
    },
    /// Rayleigh damping `C = mass M + stiffness K` with given coefficients.
    Coefficients {
        /// Mass-proportional coefficient (1/s), 0 or above.
        mass: NonNegative,
        /// Stiffness-proportional coefficient (s), 0 or above; where a law yields or cracks it multiplies the
        /// degraded stiffness.
        stiffness: NonNegative,
    },
    /// Frequency-independent damping in a band, by relaxation mechanisms (a generalised Maxwell body) in series
    /// with the law. Wave speeds become frequency-dependent, and the stable step is reduced slightly: by 9 % for
    /// a ratio of 0.05 from 0.5 to 20 Hz.
    Flat {
        /// Damping ratio (share of critical damping) within the band, above 0 and at most 0.2.
        ratio: At<Positive>,
        /// Lowest and highest frequency of the band (Hz), the second 1.5 to 1000 times the first.
        band: At<[Positive; 2]>,
        /// Number of relaxation mechanisms, 2 to 4, 3 by default: a wider band needs more; each has six history
        /// variables per integration point.
        mechanisms: Option<At<usize>>,
        /// Reference frequency at which the moduli, and with them the wave speeds, are those of the material: a
        /// number (Hz), `"centre"` (geometric centre of the band; the default) or `"static"` (zero frequency).
        reference: Option<At<ReferenceFrequency>>,
        /// Damping ratio at the highest natural frequency of the part's elements, above 0 and at most 1, by a viscosity beside the
        /// mechanisms, as of the kind `high`; none by default.
        high: Option<Share>,
    },
    /// Viscosity proportional to stiffness that damps the highest frequencies alone, which cracks, joints and yielding excite on
    /// single elements: next to nothing at the frequencies of earthquakes. Where a law yields or cracks it is proportional to the
    /// degraded stiffness; its stress is not contained in any output. The stable step is `sqrt(1 + r^2) - r` of that without it.
    High {
        /// Damping ratio `r` (share of critical damping) at the highest natural frequency of the part's elements, above 0 and at
        /// most 1; 0.03 to 0.06 are usual.
        ratio: Share,
    },
}

impl Damping {
    /// Whether it is the absence of damping.
    pub fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }
}

/// Adds the text `"none"` to the forms of a damping.
fn or_none(schema: &mut Schema) {
    if let Some(Value::Array(forms)) = schema.get_mut("oneOf") {
        forms.push(json!({ "const": "none", "description": "No damping." }));
    }
}
