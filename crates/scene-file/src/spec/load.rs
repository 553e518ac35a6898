//! Supports and loads.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{At, Finite, Function, Positive};
use powerhouse_scene::internal::GRAVITY;

/// Displacement boundary condition on a node, facet or element set of the mesh.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Support {
    /// Fixed: zero displacement in all directions.
    Fixed {
        /// Node, facet or element set.
        set: At<String>,
    },
    /// Roller: zero displacement along one direction, free across it.
    Roller {
        /// Node, facet or element set.
        set: At<String>,
        /// Direction of zero displacement, a vector of any length; by default the normal of a plane facet set.
        normal: Option<At<[Finite; 3]>>,
    },
    /// Symmetry plane: the half of the body that is not modelled moves as the mirror image of the modelled one.
    /// Zero displacement along the normal. An error if the waves are not symmetric about the plane.
    Symmetry {
        /// Node, facet or element set on a plane that has the body on one side.
        set: At<String>,
        /// Normal of the plane, a vector of any length; by default that of a plane facet set.
        normal: Option<At<[Finite; 3]>>,
    },
    /// Antisymmetry plane: the half of the body that is not modelled moves as the mirror image of the modelled
    /// one with the opposite sign. Zero displacement in the plane. An error if the waves are not antisymmetric
    /// about the plane, or if a material or joint is not elastic.
    Antisymmetry {
        /// Node, facet or element set on a plane that has the body on one side.
        set: At<String>,
        /// Normal of the plane, a vector of any length; by default that of a plane facet set.
        normal: Option<At<[Finite; 3]>>,
    },
    /// Periodic pair: two opposite faces with equal displacements, as in a slice of a long tunnel.
    Periodic {
        /// Node, facet or element set of the first face.
        from: At<String>,
        /// Node, facet or element set of the second face: the first one, translated.
        to: At<String>,
    },
    /// Delayed sides: the two sides of a slice along y, for a structure that is long along y under waves of any azimuth. The
    /// side of larger y moves as the other one, later by the travel time of the waves along y; in construction stages both
    /// move as one. All waves need one slowness along y, below that of P waves in the ground; of a structure in which it is above, up to
    /// 1.6 times, a part of the inertia is moved to the ground.
    Delayed {
        /// Node, facet or element set of the first side.
        from: At<String>,
        /// Node, facet or element set of the second side: the first one, translated along y.
        to: At<String>,
    },
    /// Prescribed motion along one direction, free across it.
    Prescribed {
        /// Node, facet or element set.
        set: At<String>,
        /// Direction of the motion, a vector of any length.
        direction: At<[Finite; 3]>,
        /// Displacement along the direction (m). Either this or `record` is given.
        displacement: Option<Finite>,
        /// Name of the record (with a component: `name.x`) that gives the displacement; its first sample is at
        /// t = 0. Where the lead that a filter adds before it is not negligible at the start of the run, the
        /// records of all prescribed motions are delayed by the same time, which the run reports.
        record: Option<At<String>>,
        /// Function of time by which the motion is multiplied (dimensionless); constant one by default.
        function: Option<Function>,
    },
}

impl Support {
    /// Sets to which the support applies.
    pub fn sets(&self) -> Vec<&At<String>> {
        match self {
            Self::Fixed { set }
            | Self::Roller { set, .. }
            | Self::Symmetry { set, .. }
            | Self::Antisymmetry { set, .. }
            | Self::Prescribed { set, .. } => vec![set],
            Self::Periodic { from, to } | Self::Delayed { from, to } => vec![from, to],
        }
    }
}

/// External load.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Load {
    /// Gravity: weight of all parts, along -z.
    Gravity {
        /// Gravitational acceleration (m/s2), above 0, 9.81 by default.
        acceleration: Option<Positive>,
        /// Function of time by which the load is multiplied (dimensionless); constant one by default.
        function: Option<Function>,
    },
    /// Pressure on a facet set, positive towards the body (compression).
    Pressure {
        /// Facet set on which the load acts.
        set: At<String>,
        /// Pressure (Pa), multiplied by the function.
        pressure: Finite,
        /// Function of time by which the load is multiplied (dimensionless); constant one by default.
        function: Option<Function>,
        /// Name of the construction stage that removes the load, in the increments of that stage; never by
        /// default.
        removed_in: Option<At<String>>,
    },
    /// Hydrostatic pressure of water on a facet set, proportional to the depth below the water level.
    Water {
        /// Facet set on which the load acts.
        set: At<String>,
        /// Height z of the water level (m).
        level: Finite,
        /// Density of the water (kg/m3), above 0, 1000 by default.
        density: Option<Positive>,
        /// Function of time by which the load is multiplied (dimensionless); constant one by default.
        function: Option<Function>,
        /// Name of the construction stage that removes the load, in the increments of that stage; never by
        /// default.
        removed_in: Option<At<String>>,
    },
    /// Traction vector on a facet set.
    Traction {
        /// Facet set on which the load acts.
        set: At<String>,
        /// Traction (Pa): x, y, z, multiplied by the function.
        traction: [Finite; 3],
        /// Height z of zero traction (m), below which the traction grows linearly with depth; `traction` is then
        /// its gradient (Pa/m). Uniform traction by default.
        level: Option<Finite>,
        /// Function of time by which the load is multiplied (dimensionless); constant one by default.
        function: Option<Function>,
        /// Name of the construction stage that removes the load, in the increments of that stage; never by
        /// default.
        removed_in: Option<At<String>>,
    },
    /// Equal force at every node of a node, facet or element set; the total grows with the number of nodes, as in a
    /// refined mesh.
    Nodal {
        /// Node, facet or element set.
        set: At<String>,
        /// Force at each node (N): x, y, z, multiplied by the function.
        force: [Finite; 3],
        /// Function of time by which the load is multiplied (dimensionless); constant one by default.
        function: Option<Function>,
        /// Name of the construction stage that removes the load, in the increments of that stage; never by
        /// default.
        removed_in: Option<At<String>>,
    },
}

/// Density of water (kg/m3), 1000 by default.
pub(crate) fn water_density(given: Option<Positive>) -> f64 {
    given.map_or(1000.0, Positive::get)
}
/// Weight per volume (N/m3) of water of a density, of the default one without.
pub(crate) fn water_weight(density: Option<Positive>) -> f64 {
    water_density(density) * GRAVITY
}
/// Default bulk modulus of water (Pa).
pub(crate) const WATER_BULK_MODULUS: f64 = 2.2e9;

impl Load {
    /// Set on which the load acts; `None` for all parts.
    pub fn set(&self) -> Option<&At<String>> {
        match self {
            Self::Gravity { .. } => None,
            Self::Pressure { set, .. }
            | Self::Water { set, .. }
            | Self::Traction { set, .. }
            | Self::Nodal { set, .. } => Some(set),
        }
    }
    /// Name of the construction stage that removes the load, if any.
    pub fn removed_in(&self) -> Option<&At<String>> {
        match self {
            Self::Gravity { .. } => None,
            Self::Pressure { removed_in, .. }
            | Self::Water { removed_in, .. }
            | Self::Traction { removed_in, .. }
            | Self::Nodal { removed_in, .. } => removed_in.as_ref(),
        }
    }
    /// Function of time of the load, if one is given.
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
