//! Records, waves and the boundary through which they come in.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, Azimuth, Finite, Incidence, NonNegative, Parameters, Positive, Pulse, Share};

/// A ground motion record and what is done with it, in this order: units, cut, baseline, peak.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// The name that waves refer to.
    pub name: At<String>,
    /// The file, relative to the scene file: PEER AT2, or text in one column (with `time_step`) or
    /// two columns (time in s, acceleration). A record has either a file or components.
    pub file: Option<At<PathBuf>>,
    /// The files of up to three components of one station; a wave takes one of them. They are
    /// treated alike: one length, one cut, one factor to the peak.
    pub components: Option<At<Components>>,
    /// How components of unequal length get a common one; `pad` by default.
    pub length: Option<At<Length>>,
    /// Units of the accelerations in the file. PEER AT2 files say it themselves; for text files it
    /// must be given.
    pub units: Option<Units>,
    /// What to do if a file declares another number of samples than it holds; it is refused by
    /// default.
    #[serde(default)]
    pub count: Count,
    /// Time step of a one-column text file (s).
    pub time_step: Option<Positive>,
    /// Start and end of what is used of the record (s).
    pub cut: Option<At<[NonNegative; 2]>>,
    /// Over this time before the cut's end the acceleration falls to zero (s); 0 by default, a
    /// plain cut.
    pub taper: Option<At<NonNegative>>,
    /// How drift of velocity and displacement is taken out; not at all by default.
    #[serde(default)]
    pub baseline: At<Baseline>,
    /// The peak acceleration to which the record is scaled at last (m/s2), of components that of
    /// the largest.
    pub peak: Option<Positive>,
    /// Lasting displacement at the record's end (m), 0 by default. A record that ends elsewhere,
    /// or in motion, is refused.
    pub end_displacement: Option<Finite>,
    /// What the record is.
    pub convention: At<Convention>,
}

/// The components of a record, each a file like that of a record. The names say what waves refer
/// to; they turn nothing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Components {
    /// The first horizontal component.
    pub x: Option<At<PathBuf>>,
    /// The second horizontal component.
    pub y: Option<At<PathBuf>>,
    /// The vertical component.
    pub z: Option<At<PathBuf>>,
}

/// How components get a common length.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Length {
    /// The shortest cuts the others.
    Cut,
    /// Zeros make all as long as the longest.
    Pad,
}

/// Units of acceleration.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
pub enum Units {
    /// Metres per second squared.
    #[serde(rename = "m/s2")]
    MetrePerSecondSquared,
    /// Centimetres per second squared.
    #[serde(rename = "cm/s2")]
    CentimetrePerSecondSquared,
    /// Standard gravity, 9.80665 m/s2.
    #[serde(rename = "g")]
    Gravity,
}

/// How strictly a declared number of samples is taken.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Count {
    /// A file that holds another number is refused.
    #[default]
    AsDeclared,
    /// The samples that are there are taken, with a warning.
    AsFound,
}

/// Baseline correction.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Baseline {
    /// The record stays as it is.
    #[default]
    None,
    /// Takes the mean from the acceleration: the end velocity vanishes.
    Mean {},
    /// Takes from the acceleration the polynomial that fits it best.
    AccelerationPolynomial {
        /// Order of the polynomial, 0 to 8.
        order: usize,
    },
    /// Takes from the acceleration the polynomial that leaves the least mean square velocity;
    /// order 2 is the parabolic baseline of Berg and Housner (1961).
    LeastVelocity {
        /// Order of the polynomial, 0 to 8.
        order: usize,
    },
    /// Takes from the velocity the polynomial that leaves the least mean square velocity among
    /// those that bring end velocity and end displacement to zero.
    VelocityPolynomial {
        /// Order of the polynomial, 2 to 9.
        order: usize,
    },
    /// Butterworth filter, run forwards and backwards. The record grows by 1.5 order / corner at
    /// both ends.
    HighPass {
        /// Corner frequency (Hz).
        corner: Positive,
        /// Order, 1 to 8.
        order: usize,
    },
}

/// What a record is, which says how large the incident wave is.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    /// The incident wave itself.
    Incident,
    /// The motion of an outcrop, twice the incident wave.
    Outcrop,
    /// The component of the free surface's motion along the wave's horizontal direction of travel,
    /// which its azimuth gives: not the x of the mesh where the wave has another azimuth than 0.
    SurfaceAlong,
    /// The component of the free surface's motion across that direction, horizontally, to its left: not
    /// the y of the mesh where the wave has another azimuth than 0.
    SurfaceAcross,
    /// The same as `surface-along`; where the azimuth is not 0 the run warns that it is not the x of the
    /// mesh.
    SurfaceX,
    /// The same as `surface-across`; where the azimuth is not 0 the run warns that it is not the y of
    /// the mesh.
    SurfaceY,
    /// The vertical component of the free surface's motion.
    SurfaceZ,
    /// The motion inside the half-space.
    Within(Within),
}

/// A component of the motion at a depth below the free surface.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Within {
    /// Depth below the surface (m).
    pub depth: Positive,
    /// The component: along the wave's horizontal direction of travel, across it, or up.
    pub component: WaveAxis,
    /// Regularisation of the division by the transfer function, 0.001 to 0.5; 0.05 by default.
    pub regularisation: Option<Share>,
}

/// A component of motion in the frame of a wave.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum WaveAxis {
    /// Along the horizontal direction of travel.
    Along,
    /// Across it, horizontally, to its left.
    Across,
    /// The same as `along`; where the wave's azimuth is not 0 the run warns that it is not the x of the
    /// mesh.
    X,
    /// The same as `across`; where the wave's azimuth is not 0 the run warns that it is not the y of the
    /// mesh.
    Y,
    /// Up.
    Z,
}

/// A component of a record.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Component {
    /// The file of the first horizontal component.
    X,
    /// That of the second.
    Y,
    /// That of the vertical one.
    Z,
}

impl Component {
    /// Its name.
    pub fn letter(self) -> char {
        match self {
            Self::X => 'x',
            Self::Y => 'y',
            Self::Z => 'z',
        }
    }
}

/// The ground without the structure. Its medium is that of the elements behind the boundary.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ground {
    /// Half-space under a free surface, or full space.
    #[serde(default)]
    pub space: Space,
    /// Height of the free surface (m), the top of the mesh by default. A mesh whose top at the
    /// absorbing faces lies elsewhere is warned of.
    pub surface: Option<At<Finite>>,
}

/// The space that waves travel in.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Space {
    /// Below a horizontal free surface, which reflects.
    #[default]
    HalfSpace,
    /// Without a surface.
    FullSpace,
}

/// A plane wave.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wave {
    /// The kind of wave.
    pub kind: WaveKind,
    /// Angle of incidence from the vertical (degrees), 0 for a wave straight from below. Under a
    /// free surface a grazing wave is refused; a full space takes angles up to 180.
    pub incidence: At<Incidence>,
    /// Horizontal direction of travel from +x towards +y (degrees), 0 by default.
    pub azimuth: Option<Azimuth>,
    /// The record, by name. A wave has either a record or a pulse.
    pub record: Option<At<String>>,
    /// The component of a record that has some.
    pub component: Option<At<Component>>,
    /// A test pulse.
    pub pulse: Option<At<Pulse>>,
    /// When the record's t = 0 arrives at the reference point (s), 0 by default. If a body at rest
    /// must wait for the field of one wave (past the critical angle, behind a filter's lead, within
    /// the ground), all waves come later by the same time, and the run says so.
    pub arrival: Option<At<Finite>>,
    /// The point where it arrives then (m). By default the corner of the mesh's box that the wave
    /// hits first.
    pub reference: Option<At<[Finite; 3]>>,
    /// Multiplies the motion, 1 by default.
    pub factor: Option<Finite>,
}

/// Kinds of body waves.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum WaveKind {
    /// Compressional.
    P,
    /// Shear, polarised in the vertical plane of travel.
    Sv,
    /// Shear, polarised horizontally.
    Sh,
}

/// Where the mesh ends and the ground goes on: the kind of the registry and its parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub struct BoundarySection {
    /// The boundary's name in the registry, such as `viscous-spring`.
    pub kind: At<String>,
    /// Facet sets on which it stands.
    pub faces: Vec<At<String>>,
    /// The centre of the structure (m), from which springs take their distance; by default the
    /// middle of all parts that touch no absorbing face.
    pub scatterer: Option<At<[Finite; 3]>>,
    /// A region around the structure: the waves enter through the layer of elements around it (domain
    /// reduction, Bielak et al. 2003), and the faces absorb what is scattered. Outside the layer
    /// results hold the scattered motion alone.
    pub region: Option<At<Region>>,
    /// All other keys: what the kind wants.
    #[serde(skip)]
    pub parameters: Parameters,
}

/// A part of the mesh: either an element set or a box.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// The element set.
    pub set: Option<At<String>>,
    /// The lowest and the highest corner (m) of a box; elements whose middle lies in it belong to the
    /// region.
    #[serde(rename = "box")]
    pub corners: Option<[[Finite; 3]; 2]>,
}
