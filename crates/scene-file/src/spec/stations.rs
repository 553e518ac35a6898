//! Motions of a regional model at the nodes of a reduction layer.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{At, Finite, Positive};

/// File of motions at stations, such as those of a regional model, which enter through the layer of elements around the
/// `region` in place of waves. Every node of the layer needs a station; stations elsewhere have no effect.
#[derive(Clone, Debug, Deserialize, JsonSchema, Serialize, PartialEq)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Stations {
    /// Path of the file, relative to the scene file: H5DRM (`.h5drm`, `.h5` or `.hdf5`), which a program reads that was
    /// compiled with `--features h5drm`; else a table (CSV) of a row for each station and sample, station by station, with the
    /// columns `x [m]`, `y [m]`, `z [m]`, `inner [1]`, `time [s]`, `ux [m]`, `uy [m]`, `uz [m]` and, if wanted, `vx [m/s]`,
    /// `vy [m/s]`, `vz [m/s]`.
    pub file: At<PathBuf>,
    /// Metres in a unit of the file's coordinates, above 0: 1000 by default for H5DRM, 1 for a table.
    pub scale: Option<At<Positive>>,
    /// Directions of the file's three coordinates in the mesh: `["y", "x", "-z"]` by default for H5DRM (north, east and down, in
    /// a mesh whose x points east and y north), `["x", "y", "z"]` for a table.
    pub axes: Option<At<[StationAxis; 3]>>,
    /// Directions in the mesh of the three rows of motions of a station: `["x", "y", "-z"]` by default for H5DRM (east, north
    /// and down), `["x", "y", "z"]` for a table.
    pub rows: Option<At<[StationAxis; 3]>>,
    /// Point of the mesh (m) at the origin of the file: of the box of stations (`drmbox_x0`) for H5DRM, of the coordinates for
    /// a table. [0, 0, 0] by default.
    pub origin: Option<At<[Finite; 3]>>,
    /// Greatest distance (m) of a node from its station, above 0; 0.001 by default.
    pub tolerance: Option<At<Positive>>,
    /// Factor on the motions (dimensionless), 1 by default.
    pub factor: Option<Finite>,
    /// Interpolation between samples: `cubic` through displacements and velocities (the default, if the file has
    /// velocities), or `linear` between displacements.
    pub interpolation: Option<At<Interpolation>>,
}

/// Direction along an axis of the mesh.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
pub enum StationAxis {
    /// Along the first horizontal axis.
    #[serde(rename = "x")]
    X,
    /// Along the second horizontal axis.
    #[serde(rename = "y")]
    Y,
    /// Upwards.
    #[serde(rename = "z")]
    Z,
    /// Against the first horizontal axis.
    #[serde(rename = "-x")]
    MinusX,
    /// Against the second horizontal axis.
    #[serde(rename = "-y")]
    MinusY,
    /// Downwards.
    #[serde(rename = "-z")]
    MinusZ,
}

impl StationAxis {
    /// Index of the axis, and the sign of the direction.
    pub fn direction(self) -> (usize, f64) {
        match self {
            Self::X => (0, 1.0),
            Self::Y => (1, 1.0),
            Self::Z => (2, 1.0),
            Self::MinusX => (0, -1.0),
            Self::MinusY => (1, -1.0),
            Self::MinusZ => (2, -1.0),
        }
    }
    /// Name of the direction.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::MinusX => "-x",
            Self::MinusY => "-y",
            Self::MinusZ => "-z",
        }
    }
}

/// Interpolation between the samples of a station.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, Serialize, PartialEq, Eq)]
#[non_exhaustive]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// Cubic through displacements and velocities.
    Cubic,
    /// Straight line between displacements.
    Linear,
}
