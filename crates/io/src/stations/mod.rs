//! Motions of stations: H5DRM files, and tables.

mod error;
#[cfg(feature = "h5drm")]
mod h5drm;
// Tables have names of components.
#[cfg(any(feature = "h5drm", test))]
mod order;
mod table;

use std::path::Path;

pub use error::{StationFileError, StationFileFault};

/// Endings of the names of H5DRM files.
const H5DRM: [&str; 3] = ["h5drm", "h5", "hdf5"];

/// Motions of the stations of a regional model, in the axes and the length unit of their file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StationMotions {
    /// Form of the file.
    pub form: StationForm,
    /// Coordinates of the stations, in the unit of the file.
    pub positions: Vec<[f64; 3]>,
    /// Whether each station is on the inner side of its layer.
    pub inner: Vec<bool>,
    /// Coordinates of the origin of the box of stations, in the unit of the file.
    pub origin: [f64; 3],
    /// Time of the first sample (s).
    pub start: f64,
    /// Time between two samples (s), above zero.
    pub step: f64,
    /// Number of samples of each station, at least two.
    pub samples: usize,
    /// Whether there are velocities.
    pub has_velocity: bool,
    /// Motions, station by station and sample by sample: three components of displacement (m), then, if there are any,
    /// three of velocity (m/s), in the order of the file.
    pub motion: Vec<f64>,
    /// Order of the components of the stations in which they resemble those of the control point, if that is another one:
    /// component `i` of the control point is component `order[i]` of the stations. None if theirs is the order, or if it
    /// cannot be found.
    pub other_order: Option<[usize; 3]>,
    /// Warnings of differences between the motions and the declarations of their file.
    pub warnings: Vec<String>,
}

/// Form of a file of motions of stations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StationForm {
    /// H5DRM, as ShakerMaker writes it and OpenSees reads it: coordinates north, east, down in km.
    H5drm,
    /// Table (CSV) of a row for each station and sample: coordinates x, y, z in m.
    Table,
}

/// Reads the motions of stations: an H5DRM file by the ending `.h5drm`, `.h5` or `.hdf5` of its name, else a table.
///
/// A table has a header of names with units, as [`read_table`](crate::read_table) reads it, and a row for each station and sample,
/// station by station, at uniform times: `x`, `y`, `z` (`[m]` or `[km]`), `inner [1]` (1 on the inner side of the layer, 0 on the
/// outer one), `time [s]`, `ux`, `uy`, `uz` (`[m]`, `[cm]` or `[mm]`) and, if wanted, `vx`, `vy`, `vz` (`[m/s]`, `[cm/s]` or
/// `[mm/s]`).
///
/// `most` is the memory (bytes) that the motions may take; a file that needs more is refused before it is taken.
///
/// # Errors
/// [`StationFileError`], with the file and its fault. Without the feature `h5drm` every H5DRM file.
pub fn read_station_motions(file: &Path, most: u64) -> Result<StationMotions, StationFileError> {
    let ending = file.extension().and_then(|ending| ending.to_str());
    let is_h5drm = ending.is_some_and(|ending| H5DRM.contains(&ending.to_lowercase().as_str()));
    let motions = if is_h5drm {
        of_h5drm(file, most)
    } else {
        table::read(file, most)
    };
    motions.map_err(|fault| StationFileError {
        file: file.into(),
        fault,
    })
}

#[cfg(feature = "h5drm")]
fn of_h5drm(file: &Path, most: u64) -> Result<StationMotions, StationFileFault> {
    h5drm::read(file, most)
}

#[cfg(not(feature = "h5drm"))]
fn of_h5drm(_file: &Path, _most: u64) -> Result<StationMotions, StationFileFault> {
    Err(StationFileFault::NoReader)
}

/// Checks that the motions of stations fit into a given memory (bytes).
fn check_memory(
    stations: u64,
    samples: u64,
    width: u64,
    most: u64,
) -> Result<(), StationFileFault> {
    let numbers = u128::from(stations) * u128::from(samples) * u128::from(width);
    let needed = u64::try_from(8 * numbers).unwrap_or(u64::MAX);
    if needed <= most {
        Ok(())
    } else {
        Err(StationFileFault::Memory {
            stations,
            samples,
            needed,
            most,
        })
    }
}
