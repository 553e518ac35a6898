//! Static analysis before the dynamic run: in-situ stress, bolts, construction stages.

use core::num::NonZeroU32;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{At, BoltEnd, Finite, Load, NonNegative, Positive, Share, is_default};

/// In-situ stress of the ground before the first construction stage. Elements that are cast later are free of it.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum InSituStress {
    /// Geostatic stress of ground under its own weight (9.81 m/s2), zero above the ground surface.
    Ground {
        /// Height z of the ground surface (m).
        level: Finite,
        /// Density of the ground (kg/m3), above 0.
        density: Positive,
        /// Coefficient of lateral stress K0 along x: horizontal over vertical stress, 0 or above.
        lateral: NonNegative,
        /// Coefficient of lateral stress K0 along y, 0 or above; that along x by default.
        lateral_y: Option<NonNegative>,
        /// Water in the pores of the ground, between whose effective stresses the coefficients hold. Stresses are total
        /// ones; the density is that of ground and water together.
        water: Option<GroundWater>,
    },
    /// Geostatic stress of horizontal layers of ground under their own weight (9.81 m/s2), zero above the ground
    /// surface.
    Layers {
        /// Height z of the ground surface (m).
        level: Finite,
        /// Layers from the top downwards.
        layers: At<Vec<StressLayer>>,
        /// Water in the pores of the layers, as in ground of one layer.
        water: Option<GroundWater>,
    },
    /// Stress that varies linearly with depth.
    Linear {
        /// Height z from which depth is measured (m).
        level: Finite,
        /// Stress at that height (Pa), tension positive: xx, yy, zz, xy, yz, zx; zero by default.
        stress: Option<[Finite; 6]>,
        /// Stress gradient with depth (Pa/m): xx, yy, zz, xy, yz, zx.
        gradient: [Finite; 6],
    },
    /// Stress of each element, from a table.
    Elements {
        /// Path of the CSV file, relative to the scene file: columns `element [1]`, `xx [Pa]`, `yy [Pa]`,
        /// `zz [Pa]`, `xy [Pa]`, `yz [Pa]`, `zx [Pa]` (or kPa, MPa), tension positive, one row for each element of
        /// the mesh.
        file: At<PathBuf>,
    },
}

/// Water at rest in the pores of ground under its own weight, or in a joint.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct GroundWater {
    /// Height z of the water level (m), below which the pressure is hydrostatic, or a table of `pressures`; a joint without either has
    /// no pressure.
    pub level: Option<At<Finite>>,
    /// Pressures by height in place of a level: pairs of height z (m) and pressure (Pa, 0 or above) from the top downwards, two or
    /// more, with straight lines between.
    pub pressures: Option<At<Vec<[Finite; 2]>>>,
    /// Density of the water (kg/m3) below a level, above 0; 1000 by default.
    pub density: Option<Positive>,
}

/// Layer of ground under its own weight.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct StressLayer {
    /// Height z of the lower end of the layer (m), below that of the layer above. The last layer has none: it reaches to
    /// any depth.
    pub bottom: Option<At<Finite>>,
    /// Density of the layer (kg/m3), above 0.
    pub density: Positive,
    /// Coefficient of lateral stress K0 along x: horizontal over vertical stress, 0 or above.
    pub lateral: NonNegative,
    /// Coefficient of lateral stress K0 along y, 0 or above; that along x by default.
    pub lateral_y: Option<NonNegative>,
}

/// Group of rock bolts with equal properties: bars embedded in the elements that they cross.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Bolt {
    /// Name of the group in stages and results.
    pub name: At<String>,
    /// Axes of the bolts, from head to toe (m): `[[x, y, z], [x, y, z]]` each. Either this or `pattern` is given.
    pub lines: Option<At<Vec<[[Finite; 3]; 2]>>>,
    /// Regular pattern of bolts on a wall or an arch.
    pub pattern: Option<At<Pattern>>,
    /// Diameter of the bar (m), above 0. Either this or `section` is given.
    pub diameter: Option<At<Positive>>,
    /// Cross-sectional area of the bar (m2), above 0.
    pub section: Option<At<Positive>>,
    /// Young's modulus (Pa), above 0; 2e11 by default.
    pub young: Option<At<Positive>>,
    /// Axial yield force of the bar in tension and compression (N), above 0; elastic by default.
    pub yield_force: Option<At<Positive>>,
    /// Pretension: axial force when the bolts are installed (N), 0 or above, 0 by default. With `grout` it needs
    /// an anchored head and toe.
    pub pretension: Option<At<NonNegative>>,
    /// Deformable grout with slip; by default the bar has perfect bond to the rock along its length.
    pub grout: Option<At<Grout>>,
    /// Largest length of a segment (m), above 0, where elements are larger: slip in grout is linear within a
    /// segment. By default, in grout, a quarter of the bolt and the length `sqrt(E A / stiffness)` at most.
    pub longest_segment: Option<At<Positive>>,
}

/// Regular pattern of bolts normal to a surface of an opening.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Pattern {
    /// Facet set of the heads; only facets on the surface of the body when the bolts are installed are used.
    pub facets: At<String>,
    /// Axis of the opening, a vector of any length.
    pub along: At<[Finite; 3]>,
    /// Spacing of the bolts around the opening and along it (m), above 0.
    pub spacing: [Positive; 2],
    /// Length of the bolts (m), above 0.
    pub length: Positive,
}

/// Elastic-perfectly plastic grout between bolt and rock.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Grout {
    /// Shear stiffness: shear force per length of bolt and slip (N/m2), above 0.
    pub stiffness: Positive,
    /// Shear strength per length of bolt (N/m), above 0; unlimited by default.
    pub strength: Option<Positive>,
    /// End condition of the head: `free` (grout alone; the default) or `anchored`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub head: BoltEnd,
    /// End condition of the toe: `free` (grout alone; the default) or `anchored`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub toe: BoltEnd,
}

/// Construction stage: changes of the model, followed by the computation of static equilibrium.
///
/// Excavated and cast sets, loads and bolts of a stage persist in later stages and in the dynamic run; a load may
/// name a later stage that removes it. Temporary materials and supports of a stage persist in later stages until the
/// dynamic run starts: then the reactions of the supports are kept as nodal forces, and absorbing faces take their
/// place. Supports and loads of the scene itself act in all stages, with their values at the start of the run, and in
/// the run.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// Name of the stage in results.
    pub name: At<String>,
    /// Element sets that are excavated (deactivated).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub excavate: Vec<At<String>>,
    /// Element sets that are cast (activated) without stress in the deformed body. A set that is cast without
    /// having been excavated before is inactive until this stage.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cast: Vec<At<String>>,
    /// Method of the static analysis; `conjugate-gradients` by default.
    pub method: Option<At<StaticMethod>>,
    /// Release factor: share of the unbalanced forces that is applied in this stage, above 0 and at most 1, 1 by
    /// default. The rest is carried until the next stage, as by the support of an advancing tunnel face.
    pub release: Option<At<Share>>,
    /// Number of load increments, 1 or above, 1 by default; an increment that does not converge is subdivided.
    pub increments: Option<At<NonZeroU32>>,
    /// Tolerance of static equilibrium: unbalanced force over the force of the load, above 0; 1e-8 by default.
    pub tolerance: Option<At<Positive>>,
    /// Names of the bolt groups that are installed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bolts: Vec<At<String>>,
    /// Names of joints that are tied in this stage: no relative displacement, whatever their law. In the next
    /// stage that does not tie it, or in the dynamic run, a joint is re-initialised in its current position: as
    /// defined in `[[joint]]`, or as grouted if an earlier stage grouted it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tied: Vec<At<String>>,
    /// Names of joints that are grouted: gaps are filled in the current position, and the joint is re-initialised
    /// closed, with the bond of its law everywhere. Opening, slip and energies are counted from there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub grouted: Vec<At<String>>,
    /// Water levels of ground with `pore_water`, in force in later stages and in the run: the change of the pressure loads the
    /// ground, as dewatering and impounding do. Elements that a stage casts are without pressure until a later stage names a level.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub water: Vec<At<StageWater>>,
    /// Whether the water in pores cannot flow in this stage, as in the run: its pressure rises with the decrease of volume since
    /// the last drained stage, and in the next drained stage that rise is gone; `false` by default. Not beside `water`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undrained: Option<At<bool>>,
    /// Temporary materials of parts, in force until a later stage casts the part or gives it another one, or the
    /// dynamic run starts.
    #[serde(rename = "part", default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<StagePart>,
    /// Supports in force until the dynamic run starts.
    #[serde(rename = "support", default, skip_serializing_if = "Vec::is_empty")]
    pub supports: Vec<At<StageSupport>>,
    /// Loads added in this stage, in force in later stages and in the run unless `removed_in` names a stage.
    #[serde(rename = "load", default, skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<At<Load>>,
}

/// Water level of ground with water in its pores, from a construction stage on.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct StageWater {
    /// Element set; without it all ground with `pore_water` for which the stage has no other level.
    pub set: Option<At<String>>,
    /// Height z of the water level (m), below which the pressure is hydrostatic, zero above; or a table of `pressures`.
    pub level: Option<At<Finite>>,
    /// Pressures by height in place of a level: pairs of height z (m) and pressure (Pa, 0 or above) from the top downwards, two or
    /// more, with straight lines between. The table reaches over the centres of all elements.
    pub pressures: Option<At<Vec<[Finite; 2]>>>,
    /// Density of the water (kg/m3) below a level, above 0; 1000 by default.
    pub density: Option<Positive>,
}

/// Method of computing static equilibrium.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum StaticMethod {
    /// Iterations with the elastic stiffness, solved by preconditioned conjugate gradients without a matrix.
    /// Joints must stick: a joint that would slide or open is an error, as with the next two methods.
    ConjugateGradients,
    /// Iterations with the elastic stiffness, solved by a sparse Cholesky factor: for many iterations of a model
    /// of moderate size. In builds with the feature `direct`.
    Cholesky,
    /// Newton iterations with the consistent tangent, factored in each: for extensive plastic flow. In builds with
    /// the feature `direct`.
    Newton,
    /// Dynamic relaxation, damped motion in pseudo-time: for joints that slide or open, for strong softening, and
    /// for large zones close to failure.
    DynamicRelaxation,
}

/// Temporary material of a part from a construction stage on.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct StagePart {
    /// Element set of the part.
    pub set: At<String>,
    /// Name of the material.
    pub material: At<String>,
}

/// Support of a construction stage, in force in later stages too, until the dynamic run starts; then its reactions are
/// kept as nodal forces, so that the body remains in equilibrium.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum StageSupport {
    /// Fixed: zero displacement increment in all directions.
    Fixed {
        /// Node, facet or element set.
        set: At<String>,
    },
    /// Roller: zero displacement increment along one direction, free across it.
    Roller {
        /// Node, facet or element set.
        set: At<String>,
        /// Direction of zero displacement, a vector of any length; by default the normal of a plane facet set.
        normal: Option<At<[Finite; 3]>>,
    },
}

impl StageSupport {
    /// Set to which the support applies.
    pub fn set(&self) -> &At<String> {
        match self {
            Self::Fixed { set } | Self::Roller { set, .. } => set,
        }
    }
}
