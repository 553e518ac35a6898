//! Ground motion records, incident waves, the free-field site and the absorbing boundary.

use core::num::NonZeroU32;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    At, Azimuth, EquivalentLinear, Finite, Incidence, NonNegative, Parameters, Positive, Pulse,
    RecordSpectrum, Share, Stations, WaveKind, is_default,
};

/// Ground motion record (accelerogram) and its processing, in this order: units, cut, baseline correction, scaling
/// to a peak, factor.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Name to which waves and prescribed motions refer.
    pub name: At<String>,
    /// Path of the file, relative to the scene file: PEER AT2, K-NET, KiK-net, COSMOS, CSMIP, GeoNet, ESM, ITACA,
    /// SMC, CWB, CSMNC, AFAD, or text in one column (acceleration, with `time_step`), two columns (time in s,
    /// acceleration) or other shapes. A record has either a file or components.
    pub file: Option<At<PathBuf>>,
    /// Number (from 1) or name of the channel of a file that has several.
    pub channel: Option<At<String>>,
    /// Channels of the file that are the components of one station, by number or name; in the place of `components`.
    pub channels: Option<At<Channels>>,
    /// Files of up to three components of one station; a wave refers to one of them, a `[[motion]]` to all. All are processed
    /// alike: one length, one cut, one scale factor.
    pub components: Option<At<Components>>,
    /// Treatment of components of unequal length: `pad` (zeros are added; the default) or `cut`.
    pub length: Option<At<Length>>,
    /// Unit of the accelerations in the file: `m/s2`, `cm/s2` or `g`. Required for text files that do not declare it;
    /// others declare their own.
    pub units: Option<Units>,
    /// Treatment of a file whose declared number of samples differs from the number it contains: `as-declared`
    /// (an error; the default) or `as-found` (a warning).
    #[serde(default, skip_serializing_if = "is_default")]
    pub count: Count,
    /// Sampling interval of a text file without times (s), above 0.
    pub time_step: Option<Positive>,
    /// Number of first lines of a text file that are left out, such as titles that start with a number.
    pub skip: Option<u32>,
    /// Columns of a text file with more than two: the time, if there is one, and the acceleration.
    pub columns: Option<At<Columns>>,
    /// Number of successive accelerations in each row of a text file, with or without a time before each.
    pub values_in_a_row: Option<NonZeroU32>,
    /// Time window of the record that is used: start and end (s); all by default.
    pub cut: Option<At<[NonNegative; 2]>>,
    /// Duration of the taper at the end of the cut (s), over which the acceleration falls to zero; 0 (no taper)
    /// by default.
    pub taper: Option<At<NonNegative>>,
    /// Baseline correction, which removes drift of velocity and displacement; none by default.
    #[serde(default, skip_serializing_if = "is_default")]
    pub baseline: At<Baseline>,
    /// Peak ground acceleration to which the processed record is scaled (m/s2), above 0; with components, the
    /// peak of the largest one. No scaling by default.
    pub peak: Option<Positive>,
    /// Spectrum of a code to which the record is scaled or matched, in the place of `peak`.
    pub spectrum: Option<At<RecordSpectrum>>,
    /// Factor on the record after all other processing, above 0, such as a level of an incremental analysis; 1 by default.
    pub factor: Option<Positive>,
    /// Permanent displacement at the end of the record (m), before `factor`, 0 by default. A record that ends with another
    /// displacement, or with a velocity, is an error.
    pub end_displacement: Option<Finite>,
    /// Type of the motion that the record describes, which fixes its ratio to the incident wave.
    pub convention: At<Convention>,
}

/// Component files of a record, each of a format permitted for `file`. The names are labels to which waves refer;
/// they imply no direction of the motion.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Components {
    /// Path of the file of the first horizontal component.
    pub x: Option<At<PathBuf>>,
    /// Path of the file of the second horizontal component.
    pub y: Option<At<PathBuf>>,
    /// Path of the file of the vertical component.
    pub z: Option<At<PathBuf>>,
}

/// Channels of a file, by their numbers (from 1) or names; the keys are labels as those of the components of a record.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Channels {
    /// Channel of the first horizontal component.
    pub x: Option<String>,
    /// Channel of the second horizontal component.
    pub y: Option<String>,
    /// Channel of the vertical component.
    pub z: Option<String>,
}

/// Columns of a text file, by their numbers from 1.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Columns {
    /// Column of the times (s).
    pub time: Option<NonZeroU32>,
    /// Column of the accelerations.
    pub acceleration: NonZeroU32,
}

/// Treatment of components of unequal length.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum Length {
    /// All are cut to the length of the shortest.
    Cut,
    /// All are extended with zeros to the length of the longest.
    Pad,
}

/// Unit of acceleration.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
pub enum Units {
    /// Metres per second squared.
    #[serde(rename = "m/s2")]
    MetrePerSecondSquared,
    /// Centimetres per second squared.
    #[serde(rename = "cm/s2", alias = "gal")]
    CentimetrePerSecondSquared,
    /// Standard gravity, 9.80665 m/s2.
    #[serde(rename = "g")]
    Gravity,
}

/// Treatment of a declared number of samples that differs from the number in the file.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum Count {
    /// A file with another number of samples is an error.
    #[default]
    AsDeclared,
    /// The samples in the file are used, with a warning.
    AsFound,
}

/// Method of baseline correction of an accelerogram.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[schemars(tag = "kind")]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Baseline {
    /// No correction.
    #[default]
    None,
    /// Subtraction of the mean acceleration: the end velocity becomes zero.
    Mean {},
    /// Subtraction of the least-squares polynomial of the acceleration.
    AccelerationPolynomial {
        /// Degree of the polynomial, 0 to 8.
        order: usize,
    },
    /// Subtraction of the acceleration polynomial that minimises the mean square velocity; order 2 is the
    /// parabolic baseline of Berg and Housner (1961).
    LeastVelocity {
        /// Degree of the polynomial, 0 to 8.
        order: usize,
    },
    /// Subtraction of the velocity polynomial that minimises the mean square velocity, subject to zero end
    /// velocity and zero end displacement.
    VelocityPolynomial {
        /// Degree of the polynomial, 2 to 9.
        order: usize,
    },
    /// High-pass Butterworth filter, applied forwards and backwards (zero phase). The record is extended by
    /// `1.5 order / corner` (s) at both ends.
    HighPass {
        /// Corner frequency (Hz), above 0.
        corner: Positive,
        /// Order of the filter, 1 to 8.
        order: usize,
    },
}

/// Type of motion that a record describes; it fixes the ratio of the incident wave to the record.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    /// Motion of the incident wave itself.
    Incident,
    /// Outcrop motion: twice the incident wave; for a `[[motion]]` that of the free surface of the half-space.
    Outcrop,
    /// Free-surface motion: horizontal component along the wave's direction of travel, which its azimuth gives
    /// (the x axis of the mesh only for an azimuth of 0).
    SurfaceAlong,
    /// Free-surface motion: horizontal component across that direction, to its left (the y axis of the mesh only
    /// for an azimuth of 0).
    SurfaceAcross,
    /// Same as `surface-along`; if the azimuth is not 0, a warning states that this is not the x axis of the
    /// mesh.
    SurfaceX,
    /// Same as `surface-across`; if the azimuth is not 0, a warning states that this is not the y axis of the
    /// mesh.
    SurfaceY,
    /// Free-surface motion: vertical component.
    SurfaceZ,
    /// Free-surface motion, all components along the axes of the mesh, for a `[[motion]]`.
    Surface,
    /// Within motion: a component of the motion at a depth in the ground, or all of them for a `[[motion]]`.
    Within(Within),
}

/// Within motion: the motion at a depth below the free surface.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Within {
    /// Depth below the free surface (m), above 0.
    pub depth: Positive,
    /// Component: along the wave's horizontal direction of travel, across it, or vertical. Not given for a `[[motion]]`,
    /// which takes all components.
    pub component: Option<WaveAxis>,
    /// Regularisation of the division by the transfer function (dimensionless), 0.001 to 0.5. By default that of a wave in
    /// layers is exact, where nothing moves before the wave arrives; elsewhere 0.05.
    pub regularisation: Option<Share>,
}

/// Component of motion in the coordinate system of a wave.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum WaveAxis {
    /// Horizontal, along the direction of travel.
    Along,
    /// Horizontal, across the direction of travel, to its left.
    Across,
    /// Same as `along`; if the azimuth is not 0, a warning states that this is not the x axis of the mesh.
    X,
    /// Same as `across`; if the azimuth is not 0, a warning states that this is not the y axis of the mesh.
    Y,
    /// Vertical, upwards.
    Z,
}

/// Component of a record.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum Component {
    /// First horizontal component.
    X,
    /// Second horizontal component.
    Y,
    /// Vertical component.
    Z,
}

impl Component {
    /// Name of the component, one letter.
    pub fn letter(self) -> char {
        match self {
            Self::X => 'x',
            Self::Y => 'y',
            Self::Z => 'z',
        }
    }
}

/// Free-field site: the ground without the structure. Its medium is that of the elements along the absorbing
/// faces.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Ground {
    /// Half-space below a free surface (the default), or full space.
    #[serde(default, skip_serializing_if = "is_default")]
    pub space: Space,
    /// Height z of the free surface (m), by default that of the upper edge of the absorbing sides of the mesh (of its top, if no
    /// side absorbs). A warning is given if the top of the mesh along the absorbing faces lies elsewhere.
    pub surface: Option<At<Finite>>,
    /// Settings of the equivalent linear method of layers with `strain_curves`.
    pub equivalent_linear: Option<At<EquivalentLinear>>,
}

/// Domain in which the incident waves travel.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum Space {
    /// Half-space below a horizontal free surface, which reflects waves.
    #[default]
    HalfSpace,
    /// Full space, without a free surface.
    FullSpace,
}

/// Incident plane body wave.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Wave {
    /// Wave type: `p`, `sv` or `sh`.
    pub kind: WaveKind,
    /// Angle of incidence from the vertical (degrees), 0 for vertical incidence from below. In a half-space
    /// below 90, grazing incidence being an error; in a full space up to 180.
    pub incidence: At<Incidence>,
    /// Azimuth: horizontal direction of travel, from +x towards +y (degrees), -360 to 360, 0 by default.
    pub azimuth: Option<Azimuth>,
    /// Name of the record of its motion. A wave has either a record or a pulse.
    pub record: Option<At<String>>,
    /// Component of the record (`x`, `y` or `z`), if the record has components.
    pub component: Option<At<Component>>,
    /// Analytic pulse of the incident displacement, in place of a record.
    pub pulse: Option<At<Pulse>>,
    /// Arrival time of the record's t = 0 at the reference point (s), 0 by default. Where the field of a wave is
    /// not negligible at the start of a body at rest (past the critical angle, before the first sample of a
    /// filtered record, for a within motion), all waves are delayed by the same time, which the run reports.
    pub arrival: Option<At<Finite>>,
    /// Reference point of the arrival time (m): x, y, z. By default the corner of the mesh's bounding box that
    /// the wave reaches first.
    pub reference: Option<At<[Finite; 3]>>,
    /// Factor on the motion (dimensionless), 1 by default.
    pub factor: Option<Finite>,
}

/// Absorbing boundary on outer faces of the mesh: its kind in the registry and its parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
pub struct BoundarySection {
    /// Kind of the boundary: its name in the registry, such as `viscous-spring`.
    pub kind: At<String>,
    /// Absorbing faces: facet sets on the surface of the mesh.
    pub faces: Vec<At<String>>,
    /// Centre of the structure as the source of scattered waves (m): boundary springs are computed with the
    /// distance from it. By default the centre of all parts that touch no absorbing face.
    pub scatterer: Option<At<[Finite; 3]>>,
    /// Element sets of parts of a structure that run through absorbing faces, such as the lining of a tunnel or a fault zone.
    /// They absorb there with their own impedance, and take the motion and the stress that the free field has in the
    /// ground at their place; none by default.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub through: Vec<At<String>>,
    /// Interior region of the domain reduction method (Bielak et al. 2003): incident waves enter through the
    /// layer of elements around it, and the absorbing faces absorb the scattered waves. Outside the layer
    /// results are the scattered motion alone. By default waves enter through the absorbing faces.
    pub region: Option<At<Region>>,
    /// Motions at the nodes of that layer from a file, such as those of a regional model, in place of waves; none by default.
    pub stations: Option<At<Stations>>,
    /// All other keys of the table: parameters of the boundary kind.
    #[serde(skip_deserializing, flatten)]
    #[schemars(skip)]
    pub parameters: Parameters,
}

/// Interior region of a domain reduction: either an element set or a box.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Element set of the region.
    pub set: Option<At<String>>,
    /// Lowest and highest corner (m) of a box; elements whose centroids lie in it belong to the region.
    #[serde(rename = "box")]
    pub corners: Option<[[Finite; 3]; 2]>,
}
