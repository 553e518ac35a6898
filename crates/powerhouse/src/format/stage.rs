//! What happens to the body before it moves: stress of the ground, bolts, stages.

use core::num::NonZeroU32;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Finite, Load, NonNegative, Positive, Share};

/// The stress of the ground before the first stage. Elements that are cast later have none.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum InSituStress {
    /// That of ground under its own weight (9.81 m/s2), none above its surface.
    Ground {
        /// Height of the ground's surface (m).
        level: Finite,
        /// Density of the ground (kg/m3).
        density: Positive,
        /// Horizontal over vertical stress (K0), along x.
        lateral: NonNegative,
        /// The same along y, if it is another.
        lateral_y: Option<NonNegative>,
    },
    /// Any stress.
    Linear {
        /// Height from which the depth counts (m).
        level: Finite,
        /// Stress there (Pa), tension positive: xx, yy, zz, xy, yz, zx; none by default.
        stress: Option<[Finite; 6]>,
        /// Its change per metre of depth (Pa/m).
        gradient: [Finite; 6],
    },
    /// One for each element, from a table.
    Elements {
        /// The file, relative to the scene's: columns `element [1]`, `xx [Pa]`, `yy [Pa]`, `zz [Pa]`,
        /// `xy [Pa]`, `yz [Pa]`, `zx [Pa]` (kPa and MPa, too), tension positive, a row for each element
        /// of the mesh.
        file: At<PathBuf>,
    },
}

/// Rock bolts of one make: bars embedded in the elements that they cross.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bolt {
    /// The name in stages and results.
    pub name: At<String>,
    /// Bolts from head to toe (m), `[[x, y, z], [x, y, z]]` each. Either these or a pattern are given.
    pub lines: Option<At<Vec<[[Finite; 3]; 2]>>>,
    /// Bolts in rows on a wall or an arch.
    pub pattern: Option<At<Pattern>>,
    /// Diameter of the bar (m). Either this or the section is given.
    pub diameter: Option<At<Positive>>,
    /// Section of the bar (m2).
    pub section: Option<At<Positive>>,
    /// Young's modulus (Pa), 200 GPa by default.
    pub young: Option<At<Positive>>,
    /// Axial force (N) at which the bar flows, in tension and compression; without it it never does.
    pub yield_force: Option<At<Positive>>,
    /// Axial force (N) that is locked in when the bolts are installed, 0 by default. In grout it needs
    /// an anchored head and toe.
    pub pretension: Option<At<NonNegative>>,
    /// Grout that gives way; without it the bar is tied to the rock all along.
    pub grout: Option<At<Grout>>,
    /// Longest segment (m), where elements are larger: slip in grout is linear within a segment.
    pub longest_segment: Option<At<Positive>>,
}

/// Bolts normal to a surface, in rows across an opening.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pattern {
    /// The facet set. Of its facets those count that are on the surface of the body when the bolts
    /// are installed.
    pub facets: At<String>,
    /// The direction of the opening, of any length.
    pub along: At<[Finite; 3]>,
    /// Distance of bolts around the opening and along it (m).
    pub spacing: [Positive; 2],
    /// Length of the bolts (m).
    pub length: Positive,
}

/// Grout in which a bolt may slip.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grout {
    /// Shear force per length and slip (N/m2).
    pub stiffness: Positive,
    /// Greatest shear force per length (N/m), at which it slips on; without it it never does.
    pub strength: Option<Positive>,
    /// How the head holds; by the grout alone by default.
    #[serde(default)]
    pub head: BoltEnd,
    /// How the toe holds; by the grout alone by default.
    #[serde(default)]
    pub toe: BoltEnd,
}

/// How the end of a bolt holds.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum BoltEnd {
    /// By the grout alone.
    #[default]
    Free,
    /// Fixed to the rock at its place, by a plate or an expansion shell.
    Anchored,
}

/// What is done to the body before it moves, until it is at rest again. A stage tells what changes.
///
/// Sets that are taken out or put in, loads, bolts and materials stay so in the stages after it and
/// when the body moves; a load may name a later stage that takes it off. Its supports hold until the
/// body moves: then their reactions stay on as forces, and absorbing faces take their place. Supports
/// and loads of the scene itself act in all stages, with their values at the start of the run, and in
/// the run.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// The name in results.
    pub name: At<String>,
    /// Element sets that are taken out.
    #[serde(default)]
    pub excavate: Vec<At<String>>,
    /// Element sets that are put in, free of stress in the deformed body. What is cast without having
    /// been taken out before is not there until then.
    #[serde(default)]
    pub cast: Vec<At<String>>,
    /// How the body is brought to rest; by conjugate gradients by default.
    pub method: Option<At<StaticMethod>>,
    /// The share of what is out of balance that comes on the body, 1 by default. Less leaves the rest
    /// standing, as a face ahead that still bears, until the next stage.
    pub release: Option<At<Share>>,
    /// Increments in which it comes, more where one does not converge; 1 by default.
    pub increments: Option<At<NonZeroU32>>,
    /// The gate: forces out of balance over those of the load at which the body counts as at rest;
    /// 1e-8 by default.
    pub tolerance: Option<At<Positive>>,
    /// Bolts that are installed, by name.
    #[serde(default)]
    pub bolts: Vec<At<String>>,
    /// Joints that are closed in this stage, by name: their sides are one body whatever their law
    /// admits. In the next stage that does not name it, or when the body moves, a joint starts anew from
    /// where it stands: as it was given, or as after grouting if an earlier stage grouted it.
    #[serde(default)]
    pub tied: Vec<At<String>>,
    /// Joints that are grouted, by name: whatever gap they have is filled and where they slid they stay;
    /// they start anew from there, closed and with the bond of their law everywhere. Opening, slip and
    /// energies count from there.
    #[serde(default)]
    pub bonded: Vec<At<String>>,
    /// Parts that have another material than their own, until a stage casts them or says otherwise, or
    /// the body moves.
    #[serde(rename = "part", default)]
    pub parts: Vec<StagePart>,
    /// Supports until the body moves.
    #[serde(rename = "support", default)]
    pub supports: Vec<At<StageSupport>>,
    /// Loads, which stay unless they name the stage that takes them off.
    #[serde(rename = "load", default)]
    pub loads: Vec<At<Load>>,
}

/// How a body is brought to rest.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum StaticMethod {
    /// Corrections by the elastic operator, by conjugate gradients: without a matrix, and the default.
    /// Joints hold or are refused, as with the next two.
    ConjugateGradients,
    /// Corrections by the elastic operator, by a sparse Cholesky factor: for many corrections of a model
    /// that is not large. In builds with the feature `direct`.
    Cholesky,
    /// Corrections by the consistent tangent, factored anew for each: for much plastic flow. In builds
    /// with the feature `direct`.
    Newton,
    /// Damped steps in a time of its own: for joints that slide and open, for heavy softening, and where much
    /// rock is near its limit.
    DynamicRelaxation,
}

/// A part of the scene and the material that it has in a stage.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StagePart {
    /// The element set of the part.
    pub set: At<String>,
    /// The material's name.
    pub material: At<String>,
}

/// A support until the body moves. Sets are node, facet or element sets of the mesh.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum StageSupport {
    /// Held in all directions.
    Fixed {
        /// The set.
        set: At<String>,
    },
    /// Held in one direction, free across it.
    Roller {
        /// The set.
        set: At<String>,
        /// The direction that is held, of any length; by default the normal of a plane facet set.
        normal: Option<At<[Finite; 3]>>,
    },
}

impl StageSupport {
    /// The set that it names.
    pub fn set(&self) -> &At<String> {
        match self {
            Self::Fixed { set } | Self::Roller { set, .. } => set,
        }
    }
}
