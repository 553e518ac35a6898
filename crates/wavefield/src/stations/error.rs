//! Errors of motions at stations.

use core::fmt;

use powerhouse_model::{ModelError, ParameterError};
use thiserror::Error;

/// Errors of building or sampling a [`StationField`](crate::StationField). Stations have indices from 0, in the order of the
/// file.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StationError {
    /// A parameter is outside its permitted range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A list has not one entry for each station, or there is no station.
    #[error("{found} entries of the list '{what}' are not those of {stations} stations")]
    Count {
        /// What the list has of each station: its side, or the numbers of its motion.
        what: &'static str,
        /// Number of entries.
        found: usize,
        /// Number of stations.
        stations: usize,
    },
    /// A number of a motion is not finite.
    #[error("sample {sample} of station {station} is not a finite number")]
    NotFinite {
        /// Index of the station.
        station: usize,
        /// Index of the sample.
        sample: usize,
    },
    /// Two stations are so near to each other that a point may belong to both.
    #[error(
        "stations {first} and {second} at {} m are {distance:.3e} m apart, not more than twice the tolerance of {tolerance} m",
        Point(position)
    )]
    Twice {
        /// Index of the first station.
        first: usize,
        /// Index of the second station.
        second: usize,
        /// Position of the first (m).
        position: [f64; 3],
        /// Distance between both (m).
        distance: f64,
        /// Tolerance of the field (m).
        tolerance: f64,
    },
    /// Points at which the field is needed have no station.
    #[error(
        "{count} of {of} nodes have no station within {tolerance} m: the node at {} m is {distance:.4} m from the nearest one, at {} m{}",
        Point(node), Point(nearest), extents(*count == *of, lengths)
    )]
    NoStation {
        /// Number of points without a station.
        count: usize,
        /// Number of points.
        of: usize,
        /// Position of the first such point (m).
        node: [f64; 3],
        /// Position of the station nearest to it (m).
        nearest: [f64; 3],
        /// Distance between both (m).
        distance: f64,
        /// Tolerance of the field (m).
        tolerance: f64,
        /// Edges of the bounding boxes of the stations and of the points (m).
        lengths: Box<[[f64; 3]; 2]>,
    },
    /// A node of the layer is on another side than its station.
    #[error(
        "the node at {} m is on the {} side of the layer, its station on the {} side ({count} such nodes)",
        Point(node), side(*inner), side(!*inner)
    )]
    OtherSide {
        /// Position of the first such node (m).
        node: [f64; 3],
        /// Whether the node is on the inner side.
        inner: bool,
        /// Number of such nodes.
        count: usize,
    },
    /// Velocities are not the derivatives of the displacements: of other units or components.
    #[error(
        "the velocity of station {station} is not that of its displacement: they differ by {share:.2} of the peak; are they of one unit, and their components in one order?"
    )]
    OtherVelocity {
        /// Index of the station at which they differ most.
        station: usize,
        /// Difference over the peak velocity (1).
        share: f64,
    },
}

/// Position in messages.
struct Point<'a>(&'a [f64; 3]);

impl fmt::Display for Point<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let [x, y, z] = self.0;
        write!(formatter, "({x:.4}, {y:.4}, {z:.4})")
    }
}

fn side(inner: bool) -> &'static str {
    if inner { "inner" } else { "outer" }
}

/// Edges of both bounding boxes, if no point has a station.
fn extents(none: bool, [stations, points]: &[[f64; 3]; 2]) -> String {
    const UNITS: core::ops::Range<f64> = 500.0..2000.0;
    if !none {
        return String::new();
    }
    let longest = |lengths: &[f64; 3]| lengths.iter().fold(0.0_f64, |a, b| a.max(*b));
    let ratio = longest(stations) / longest(points);
    let unit = if UNITS.contains(&ratio) || UNITS.contains(&ratio.recip()) {
        ", a thousand times as much: are coordinates in km taken as m, or the other way round?"
    } else {
        ""
    };
    let edges = |lengths: &[f64; 3]| lengths.map(|length| format!("{length:.4}")).join(" x ");
    format!(
        "; the stations extend over {} m, the nodes over {} m{unit}",
        edges(stations),
        edges(points)
    )
}

impl From<StationError> for ModelError {
    fn from(error: StationError) -> Self {
        Self::refused("motions at stations", error)
    }
}
