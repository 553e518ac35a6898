//! Joints between parts.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Parameters, Positive};

/// A joint: where two parts touch, and the law of its tractions with the law's parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub struct JointSection {
    /// The name in results.
    pub name: At<String>,
    /// Two element sets that share nodes: the mesh is cut open along their common facets. A joint
    /// has either this or `facets`.
    pub between: Option<At<[String; 2]>>,
    /// Two facet sets that face each other, of a mesh that is meshed apart there.
    pub facets: Option<At<[String; 2]>>,
    /// Largest distance of nodes that face each other (m); by default a millionth of the mesh's
    /// diagonal.
    pub tolerance: Option<Positive>,
    /// Largest angle (degrees) between facets that count as one smooth patch, 40 by default.
    /// Beyond it nodes on the edge have a pair for each side of it.
    pub corner: Option<At<Positive>>,
    /// The law's name in the registry, such as `bonded-coulomb`.
    pub law: At<String>,
    /// All other keys: what the law wants.
    #[serde(skip)]
    pub parameters: Parameters,
}
