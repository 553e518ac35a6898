//! Materials and the parts made of them.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, NonNegative, Parameters, Positive, Reference, Share};

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
    /// free field is elastic: give the part a `rim`.
    pub damping: Option<At<Damping>>,
    /// How far from the absorbing faces (m) the part is elastic and undamped, as the free field
    /// behind them is: elements that touch them, and those of which a node is closer. 0: those that
    /// touch them alone. Without this key there is no rim.
    pub rim: Option<At<NonNegative>>,
}

/// Damping of a part.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Damping {
    /// Rayleigh damping `C = mass M + stiffness K` that has a ratio at two frequencies, less in
    /// between and more outside. Its stiffness part shortens the stable step; where a law yields or cracks
    /// it acts with what is left of the stiffness, and its stress is in no output.
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
        /// Stiffness coefficient (s); where a law yields or cracks it acts with what is left of the
        /// stiffness.
        stiffness: NonNegative,
    },
    /// Damping that is the same at all frequencies of a band, by relaxation mechanisms in series
    /// with the law. It makes waves dispersive and shortens the stable step little: 9 % at a ratio
    /// of 0.05 from 0.5 to 20 Hz.
    Flat {
        /// Share of critical damping within the band, above 0 and at most 0.2.
        ratio: At<Positive>,
        /// Lowest and highest frequency (Hz), the second 1.5 to 1000 times the first.
        band: At<[Positive; 2]>,
        /// Relaxation mechanisms, 2 to 4, 3 by default: more follow a wider band, each has six history variables
        /// numbers per point.
        mechanisms: Option<At<usize>>,
        /// The frequency at which waves have the speeds of the material: a number (Hz), `"centre"`
        /// (of the band, geometric; the default) or `"static"`.
        reference: Option<At<Reference>>,
    },
}
