//! Added mass of water.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{At, Finite, Positive};

/// Added mass of water beside a facet set: it moves with the body in the dynamic run, normal to the facets, and has no
/// weight. Its pressure at rest is a load of kind `water`.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum AddedMass {
    /// Basin before a wall (Westergaard 1933): 7/8 of density times the root of the depth of the basin times the depth
    /// below the level, per area.
    Westergaard {
        /// Facet set beside the water.
        set: At<String>,
        /// Height z of the water level (m).
        level: Finite,
        /// Depth of the basin at the wall (m), above 0. Either this or `bottom` is given.
        depth: Option<At<Positive>>,
        /// Height z of the bottom of the basin (m), below the level.
        bottom: Option<At<Finite>>,
        /// Density of the water (kg/m3), above 0, 1000 by default.
        density: Option<Positive>,
    },
    /// Circular conduit full of water, which moves with it across its axis: density times half the diameter, per area.
    Conduit {
        /// Facet set beside the water, the inner side of the conduit.
        set: At<String>,
        /// Inner diameter (m), above 0; that by the angles between the facets may differ by 20 %.
        diameter: At<Positive>,
        /// Density of the water (kg/m3), above 0, 1000 by default.
        density: Option<Positive>,
    },
    /// Mass per area by depth, linear between the rows.
    Table {
        /// Facet set beside the water.
        set: At<String>,
        /// Height z of the water level (m).
        level: Finite,
        /// Depths below the level (m), rising from 0; no facet may be deeper than the last one.
        depths: At<Vec<Finite>>,
        /// Mass per area (kg/m2), not negative, at each depth.
        masses: At<Vec<Finite>>,
    },
}

impl AddedMass {
    /// Facet set beside the water.
    pub fn set(&self) -> &At<String> {
        match self {
            Self::Westergaard { set, .. } | Self::Conduit { set, .. } | Self::Table { set, .. } => {
                set
            }
        }
    }
}
