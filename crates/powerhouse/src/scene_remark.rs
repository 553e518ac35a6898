//! Remarks about implausible values and combinations in a scene.

use core::fmt;

use crate::magnitude::Magnitude;

/// Implausible value or combination in a scene that can be computed nevertheless.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SceneRemark {
    /// Quantity outside its usual range, in a scene that allows such quantities.
    Magnitude(Magnitude),
    /// Body under gravity without supports, boundary springs or stages, which falls freely.
    UnsupportedBody {
        /// Element sets of the body's parts.
        sets: Vec<String>,
    },
    /// Gravity applied suddenly at the start of the run, without a stage in which the body reaches static equilibrium.
    SuddenGravity,
    /// Supports that restrain nodes in a direction in which the free field moves.
    RestrainedField {
        /// Largest velocity of the field along restrained directions over its largest velocity.
        share: f64,
        /// Number of the node with this velocity in the mesh file.
        node: u64,
    },
    /// Absorbing face on the free surface of the half-space, where waves should be reflected.
    AbsorbingSurface {
        /// Facet set of the face.
        face: String,
    },
    /// Output interval shorter than the time step.
    ShortInterval {
        /// Kind of output.
        what: &'static str,
        /// Requested interval (s).
        interval: f64,
        /// Time step (s).
        step: f64,
    },
    /// Output interval longer than the run.
    LongInterval {
        /// Kind of output.
        what: &'static str,
        /// Requested interval (s).
        interval: f64,
        /// Duration of the run (s).
        duration: f64,
    },
    /// Number of threads above that of the machine.
    Threads {
        /// Requested number.
        wanted: usize,
        /// Number of the machine, which is used.
        available: usize,
    },
    /// Rim that covers the whole part.
    WholeRim {
        /// Element set of the part.
        set: String,
    },
    /// Fact: key of the scene file that has another name now, and is read under both.
    FormerKey {
        /// Table of the key, such as `output.section`.
        table: &'static str,
        /// Name in the file.
        former: &'static str,
        /// Name that replaces it.
        present: &'static str,
    },
    /// Fact: nodes and elements of the mesh file that were left out of the mesh, or belong to no physical group.
    MeshFile {
        /// Number of nodes without elements.
        nodes: usize,
        /// Number of lines, facets and points without physical group.
        dropped: usize,
        /// Number of solids and bars without physical group, which are in the set `all` or `ungrouped`.
        ungrouped: usize,
    },
}

impl SceneRemark {
    /// Returns whether this is a warning (`true`) or a fact (`false`).
    pub fn is_warning(&self) -> bool {
        !matches!(self, Self::MeshFile { .. } | Self::FormerKey { .. })
    }
}

impl fmt::Display for SceneRemark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magnitude(magnitude) => magnitude.fmt(f),
            Self::UnsupportedBody { sets } => write!(
                f,
                "the body of {} is under gravity and has no support: it falls; give it supports, or a stage in which it reaches static equilibrium",
                quoted(sets)
            ),
            Self::SuddenGravity => write!(
                f,
                "gravity is applied suddenly at the start of the run, and the body oscillates about its static equilibrium; add a stage, in which it reaches equilibrium before"
            ),
            Self::RestrainedField { share, node } => write!(
                f,
                "the supports restrain node {node} in a direction in which the free field moves with {:.1} % of its largest velocity: they reflect the incident waves",
                100.0 * share
            ),
            Self::AbsorbingSurface { face } => write!(
                f,
                "the absorbing face '{face}' lies on the free surface of the half-space: scattered waves leave through it instead of being reflected"
            ),
            Self::ShortInterval {
                what,
                interval,
                step,
            } => write!(
                f,
                "{what} are requested every {interval} s, which is shorter than the time step of {step:.3e} s: they are recorded at every step"
            ),
            Self::LongInterval {
                what,
                interval,
                duration,
            } => write!(
                f,
                "{what} are requested every {interval} s, which is longer than the run of {duration} s: they are recorded at its start and end only"
            ),
            Self::Threads { wanted, available } => write!(
                f,
                "threads = {wanted}, but the machine has {available}: the run uses {available}"
            ),
            Self::WholeRim { set } => write!(
                f,
                "the rim of part '{set}' covers the whole part: all of it is elastic and undamped"
            ),
            Self::FormerKey {
                table,
                former,
                present,
            } => write!(
                f,
                "the key '{former}' of [{table}] is called '{present}' now; it is read under both names"
            ),
            Self::MeshFile {
                nodes,
                dropped,
                ungrouped,
            } => {
                let mut found = Vec::new();
                if *nodes > 0 {
                    found.push(format!("{nodes} nodes without elements were left out"));
                }
                if *dropped > 0 {
                    found.push(format!(
                        "{dropped} lines, facets and points without physical group were left out"
                    ));
                }
                if *ungrouped > 0 {
                    found.push(format!(
                        "{ungrouped} elements without physical group are in the set 'all' or 'ungrouped'"
                    ));
                }
                write!(f, "mesh: {}", found.join("; "))
            }
        }
    }
}

/// Comma-separated list of quoted names.
fn quoted(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    names.join(", ")
}
