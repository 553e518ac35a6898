//! Materials and the parts made of them.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, NonNegative, Parameters, Positive, Share};

/// A material: a law of the registry and its parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub struct Material {
    /// The name that parts refer to.
    pub name: At<String>,
    /// The law's name in the registry, such as `elastic`.
    pub law: At<String>,
    /// All other keys: what the law wants.
    #[serde(skip)]
    pub parameters: Parameters,
}

/// An element set, its material and its element kernel.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// The element set of the mesh.
    pub set: At<String>,
    /// The material's name.
    pub material: At<String>,
    /// The element kernel by its name in the registry, such as `hex8-one-point`. Elements of a kind
    /// that the kernel does not serve, and all elements if no kernel is given, take the default of
    /// their kind.
    pub kernel: Option<At<String>>,
    /// Damping; none by default. Rock that touches an absorbing face stays undamped, because the
    /// free field is elastic.
    pub damping: Option<At<Damping>>,
}

/// Damping of a part.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Damping {
    /// Rayleigh damping `C = mass M + stiffness K` that has a ratio at two frequencies, less in
    /// between and more outside. Its stiffness part shortens the stable step.
    Rayleigh {
        /// Share of critical damping at both frequencies, 0.05 for 5 %.
        ratio: Share,
        /// The two frequencies (Hz).
        frequencies: [Positive; 2],
    },
    /// Rayleigh damping by its coefficients.
    Coefficients {
        /// Mass coefficient (1/s).
        mass: NonNegative,
        /// Stiffness coefficient (s).
        stiffness: NonNegative,
    },
}
