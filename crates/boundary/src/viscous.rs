//! Viscous boundary: dashpots alone.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{AbsorbingBoundary, BoundaryParts, BoundarySite, ModelError};

use crate::coefficients::{FaceCoefficients, ShareCoefficients, check_delayed, nodal_impedance};
use crate::input::{InputMode, input_loads};

/// Viscous boundary: dashpots with the impedance of P and S waves.
///
/// Exact for waves that leave along the normal. Without springs nothing holds the model: it drifts
/// under a static load.
///
/// Source: Lysmer & Kuhlemeyer (1969), "Finite dynamic model for infinite media".
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "keys", derive(Deserialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(deny_unknown_fields))]
pub struct Viscous {
    /// Part of the free field that enters through the boundary: as key `full-field` (the default),
    /// `{ incident-only = [faces] }` or `nothing`.
    #[cfg_attr(feature = "keys", serde(default))]
    pub input: InputMode,
}

impl AbsorbingBoundary for Viscous {
    fn name(&self) -> &str {
        "viscous"
    }
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
        check_delayed(site)?;
        let coefficients: ShareCoefficients = site
            .nodes
            .iter()
            .map(|node| {
                let media = node.faces.iter().map(|share| &share.medium);
                let of_medium = |medium| {
                    let plain = FaceCoefficients::viscous(medium);
                    plain.with_dashpots_matched(medium, site.slowness, 1.0)
                };
                media.map(of_medium).collect()
            })
            .collect();
        Ok(BoundaryParts::default()
            .with_impedance(nodal_impedance(site, &coefficients))
            .with_loads(input_loads(site, &coefficients, &self.input)?))
    }
}
