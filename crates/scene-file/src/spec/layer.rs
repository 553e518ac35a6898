//! Layers of the ground.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{At, Damping, Finite, NonNegative, Positive, Share};

/// Horizontal layer of the ground in which the incident waves travel. Layers are given from the uppermost down;
/// the last one, without `bottom`, is the half-space below the others, in which the waves are incident.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Layer {
    /// Name of the material whose elastic medium the layer has. Elements along the absorbing faces must have the
    /// medium of the layer that they lie in.
    pub material: At<String>,
    /// Height z of the lower end of the layer (m): a plane of the mesh, as far as the mesh reaches. Off by at most
    /// a thousandth of the layer it is moved to the plane. Not given for the last layer.
    pub bottom: Option<At<Finite>>,
    /// Damping of the layer, of kind `flat`: the field then decays as in a part with the same damping. None by
    /// default; not permitted in the half-space, where incident waves would grow with depth.
    pub damping: Option<At<Damping>>,
    /// Curves of shear modulus and damping against shear strain: by the equivalent linear method the layer, and the parts of its
    /// material, have the modulus and the damping of the strain that the motion causes. The material is `elastic`, with
    /// the moduli of small strain. None by default; not permitted in the half-space.
    pub strain_curves: Option<At<StrainCurves>>,
}

/// Curves of the secant shear modulus and the damping ratio of a soil against its cyclic shear strain.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum StrainCurves {
    /// Curves by their points.
    Points {
        /// Amplitudes of the engineering shear strain (dimensionless: 1e-4 is 0.01 %), above 0, rising, at most 0.2.
        strain: Vec<Positive>,
        /// Secant shear modulus over that of small strain at each (dimensionless), 0.001 to 1, not rising, at least 0.9 at the
        /// first.
        modulus: Vec<Share>,
        /// Damping ratio at each (share of critical damping: 0.05 is 5 %), not negative and below 1.
        damping_ratio: Vec<NonNegative>,
    },
    /// Curves of Darendeli (2001) for a state of the soil, at strains up to 1 %.
    Darendeli {
        /// Plasticity index (percent), 0 to 200.
        plasticity: NonNegative,
        /// Mean effective pressure (Pa), 1e3 to 1e7.
        pressure: Positive,
        /// Overconsolidation ratio (dimensionless), 1 to 50; 1 by default.
        overconsolidation: Option<Positive>,
        /// Frequency of the cycles (Hz), 0.1 to 100; 1 by default.
        frequency: Option<Positive>,
        /// Number of cycles, 1 to 1000; 10 by default.
        cycles: Option<Positive>,
    },
}

/// Settings of the equivalent linear method, for layers with `strain_curves`.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct EquivalentLinear {
    /// Effective strain over the greatest one (dimensionless), above 0 and at most 1; 0.65 by default.
    pub strain_ratio: Option<Share>,
    /// Change of modulus and damping in an iteration, over their values, at which it ends (dimensionless), above 0 and at most
    /// 1; 0.01 by default.
    pub tolerance: Option<Share>,
    /// Greatest number of iterations, at least 1; 30 by default.
    pub iterations: Option<At<usize>>,
    /// Lowest and highest frequency (Hz) between which the damping is that of the curves; 0.5 and 20 by default.
    pub band: Option<At<[Positive; 2]>>,
}
