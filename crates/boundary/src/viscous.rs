//! Dashpots.

use powerhouse_model::{AbsorbingBoundary, BoundaryParts, BoundarySite, ModelError};

use crate::coefficients::{FaceCoefficients, ShareCoefficients, nodal_impedance};
use crate::input::{InputMode, input_loads};

/// Dashpots with the impedance of each wave.
///
/// Exact for waves that leave along the normal. Without springs nothing holds the model: a lasting
/// force lets it drift.
///
/// Source: Lysmer & Kuhlemeyer (1969), "Finite dynamic model for infinite media".
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Viscous {
    /// What comes in through the boundary.
    pub input: InputMode,
}

impl AbsorbingBoundary for Viscous {
    fn name(&self) -> &str {
        "viscous"
    }
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
        let coefficients: ShareCoefficients = site
            .nodes
            .iter()
            .map(|node| {
                let media = node.faces.iter().map(|share| &share.medium);
                media.map(FaceCoefficients::viscous).collect()
            })
            .collect();
        Ok(BoundaryParts::default()
            .with_impedance(nodal_impedance(site, &coefficients))
            .with_loads(input_loads(site, &coefficients, &self.input)?))
    }
}
