//! Supports and loads.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Finite, Function, Positive};

/// A support. Sets are node, facet or element sets of the mesh.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Support {
    /// Held in all directions.
    Fixed {
        /// The set.
        set: At<String>,
    },
    /// Held in one direction, free across it.
    Roller {
        /// The set.
        set: At<String>,
        /// The direction that is held, of any length; by default the normal of a
        /// plane facet set.
        normal: Option<At<[Finite; 3]>>,
    },
    /// A plane of symmetry: the other half of the body moves as the mirror image of this one. Held
    /// along the normal. Refused where the waves are not symmetric about it.
    Symmetry {
        /// The set, on a plane with the body on one side.
        set: At<String>,
        /// The normal of the plane, of any length; by default that of a plane facet set.
        normal: Option<At<[Finite; 3]>>,
    },
    /// A plane of antisymmetry: the other half moves as the mirror image of this one with the opposite
    /// sign. Held across the normal. Refused where the waves are not antisymmetric about it, or where
    /// something is not elastic.
    Antisymmetry {
        /// The set, on a plane with the body on one side.
        set: At<String>,
        /// The normal of the plane, of any length; by default that of a plane facet set.
        normal: Option<At<[Finite; 3]>>,
    },
    /// Two opposite faces that move alike, as in a slice of a long tunnel.
    Periodic {
        /// One face.
        from: At<String>,
        /// The other face: the first, shifted.
        to: At<String>,
    },
    /// Moved along one direction as given, free across it.
    Prescribed {
        /// The set.
        set: At<String>,
        /// The direction, of any length.
        direction: At<[Finite; 3]>,
        /// Displacement along it (m). Either this or a record is given.
        displacement: Option<Finite>,
        /// The record, by name (and component, as `name.x`), whose displacement it is; its first
        /// sample comes at t = 0. If what a filter puts before that is not quiet when the run starts,
        /// the records of all prescribed motions come later by the same time, and the run says so.
        record: Option<At<String>>,
        /// Function of time by which either is multiplied, one at all times by default.
        function: Option<Function>,
    },
}

impl Support {
    /// The sets that it names.
    pub fn sets(&self) -> Vec<&At<String>> {
        match self {
            Self::Fixed { set }
            | Self::Roller { set, .. }
            | Self::Symmetry { set, .. }
            | Self::Antisymmetry { set, .. }
            | Self::Prescribed { set, .. } => vec![set],
            Self::Periodic { from, to } => vec![from, to],
        }
    }
}

/// A load.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Load {
    /// Weight of all parts, downwards.
    Gravity {
        /// Acceleration (m/s2), 9.81 by default.
        acceleration: Option<Positive>,
        /// Function of time, one at all times by default.
        function: Option<Function>,
    },
    /// Pressure on a facet set, positive towards the body.
    Pressure {
        /// The facet set.
        set: At<String>,
        /// Pressure (Pa), times the function.
        pressure: Finite,
        /// Function of time, one at all times by default.
        function: Option<Function>,
        /// The stage that takes the load off again, in its increments; without it the load stays for
        /// good.
        removed_in: Option<At<String>>,
    },
    /// Still water on a facet set: the pressure grows with the depth below its level.
    Water {
        /// The facet set.
        set: At<String>,
        /// Height of the water level (m).
        level: Finite,
        /// Density of the water (kg/m3), 1000 by default.
        density: Option<Positive>,
        /// Function of time, one at all times by default.
        function: Option<Function>,
        /// The stage that takes the load off again, in its increments; without it the load stays for
        /// good.
        removed_in: Option<At<String>>,
    },
    /// Traction on a facet set.
    Traction {
        /// The facet set.
        set: At<String>,
        /// Traction (Pa) in x, y and z, times the function.
        traction: [Finite; 3],
        /// If given, the traction grows with the depth below this height (m), where it starts from
        /// zero; `traction` is then its increase per metre (Pa/m).
        level: Option<Finite>,
        /// Function of time, one at all times by default.
        function: Option<Function>,
        /// The stage that takes the load off again, in its increments; without it the load stays for
        /// good.
        removed_in: Option<At<String>>,
    },
    /// The same force at every node of a node or facet set; a refined mesh has more of them.
    Nodal {
        /// The set.
        set: At<String>,
        /// Force (N) in x, y and z at each node, times the function.
        force: [Finite; 3],
        /// Function of time, one at all times by default.
        function: Option<Function>,
        /// The stage that takes the load off again, in its increments; without it the load stays for
        /// good.
        removed_in: Option<At<String>>,
    },
}

/// Default acceleration of gravity (m/s2).
pub(crate) const GRAVITY: f64 = 9.81;
/// Default density of water (kg/m3).
pub(crate) const WATER_DENSITY: f64 = 1000.0;

impl Load {
    /// The set that it acts on; all parts if none.
    pub fn set(&self) -> Option<&At<String>> {
        match self {
            Self::Gravity { .. } => None,
            Self::Pressure { set, .. }
            | Self::Water { set, .. }
            | Self::Traction { set, .. }
            | Self::Nodal { set, .. } => Some(set),
        }
    }
    /// The stage that takes it off again, if one does.
    pub fn removed_in(&self) -> Option<&At<String>> {
        match self {
            Self::Gravity { .. } => None,
            Self::Pressure { removed_in, .. }
            | Self::Water { removed_in, .. }
            | Self::Traction { removed_in, .. }
            | Self::Nodal { removed_in, .. } => removed_in.as_ref(),
        }
    }
    /// The load's function of time, if it is not constant.
    pub fn function(&self) -> Option<&Function> {
        match self {
            Self::Gravity { function, .. }
            | Self::Pressure { function, .. }
            | Self::Water { function, .. }
            | Self::Traction { function, .. }
            | Self::Nodal { function, .. } => function.as_ref(),
        }
    }
}
