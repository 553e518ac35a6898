//! Layers of the ground.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Damping, Finite};

/// Horizontal layer of the ground in which the incident waves travel. Layers are given from the uppermost down;
/// the last one, without `bottom`, is the half-space below the others, in which the waves are incident.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
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
}
