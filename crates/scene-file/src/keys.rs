//! Names of built-in boundaries and of their keys, for programs that edit scene files.
//!
//! Registry, advice and trades take them from here, and a test compares them with the keys that scene files
//! have: a name that changes does so in one place.

/// Keys of every `[boundary]` table, whatever its kind: kind, faces, scatterer, through, region, stations.
pub const BOUNDARY: [&str; 6] = [KIND, FACES, "scatterer", THROUGH, REGION, "stations"];
/// Name of the table of the boundary.
pub const BOUNDARY_TABLE: &str = "boundary";
/// Key of a `[boundary]` table: the name of the boundary in the registry.
pub const KIND: &str = "kind";
/// Key of a `[boundary]` table: the facet sets that absorb.
pub const FACES: &str = "faces";
/// Key of a `[boundary]` table: the parts of a structure that run through the faces.
pub const THROUGH: &str = "through";
/// Key of a `[boundary]` table: the region around which the field enters (domain reduction).
pub const REGION: &str = "region";

/// Boundary of springs and dashpots (Wang, Chen & Xiao 2019).
pub const VISCOUS_SPRING: &str = "viscous-spring";
/// Boundary of dashpots alone (Lysmer & Kuhlemeyer 1969).
pub const VISCOUS: &str = "viscous";

/// Key of both built-in boundaries: the motion that enters.
pub const INPUT: &str = "input";
/// Value of [`INPUT`]: the full free field on every face.
pub const FULL_FIELD: &str = "full-field";
/// Key of a table under [`INPUT`]: the faces on which the incident wave alone enters.
pub const INCIDENT_ONLY: &str = "incident-only";

/// Key of `viscous-spring`: A, the ratio of the amplitudes of plane and scattered waves.
pub const AMPLITUDE_RATIO: &str = "amplitude_ratio";
/// Key of `viscous-spring`: B, the ratio of physical to apparent wave speed.
pub const SPEED_RATIO: &str = "speed_ratio";
/// Key of `viscous-spring`: distance from the scatterer to all faces, or to those across one axis (m).
pub const DISTANCE: &str = "distance";
/// Keys of `viscous-spring` that hold tables with own `a`, `b` and `distance` for the faces normal to x, y and z.
pub const AXES: [&str; 3] = ["x", "y", "z"];
/// Key of `viscous-spring`: how scattered waves spread.
pub const SPREADING: &str = "spreading";
/// Value of [`SPREADING`]: as cylinders, from a long structure.
pub const CYLINDRICAL: &str = "cylindrical";
