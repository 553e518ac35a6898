//! Doubts about what a scene holds, beyond records and waves.

use core::fmt;

use crate::magnitude::Magnitude;

/// Something in a scene that can hardly be meant, though it can be computed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SceneDoubt {
    /// A quantity beyond what is usual, which the scene allows.
    Magnitude(Magnitude),
    /// A body under gravity that no support, no boundary with springs and no stage holds: it falls.
    Unheld {
        /// The element sets of its parts.
        sets: Vec<String>,
    },
    /// Gravity that comes on a body at the start of a run, without a stage in which it reaches equilibrium.
    SuddenWeight,
    /// Supports that hold nodes in a direction in which the free field moves.
    HeldField {
        /// The largest velocity of the field along held directions over its largest velocity.
        share: f64,
        /// The user's number of the node where it is largest.
        node: u64,
    },
    /// An absorbing face on the free surface of the field's half-space: the surface reflects nothing.
    AbsorbingSurface {
        /// The face.
        face: String,
    },
    /// An interval of output shorter than the time step.
    ShortInterval {
        /// What is recorded at the interval.
        what: &'static str,
        /// The interval (s).
        interval: f64,
        /// The time step (s).
        step: f64,
    },
    /// An interval of output longer than the run.
    LongInterval {
        /// What is recorded at the interval.
        what: &'static str,
        /// The interval (s).
        interval: f64,
        /// The run's duration (s).
        duration: f64,
    },
    /// More threads than the machine has.
    Threads {
        /// As the scene says.
        wanted: usize,
        /// What the machine has, and the run takes.
        available: usize,
    },
    /// A rim that is the whole part.
    WholeRim {
        /// The part's set.
        set: String,
    },
    /// Nodes and elements of the mesh's file that are not in the mesh, or in no group.
    MeshFile {
        /// Nodes that no element uses.
        nodes: usize,
        /// Lines, facets and points of no physical group.
        dropped: usize,
        /// Solids and bars of no physical group, which are in the set `all` or `ungrouped`.
        ungrouped: usize,
    },
}

impl SceneDoubt {
    /// Whether it is a doubt about the result, not only a fact.
    pub fn is_warning(&self) -> bool {
        !matches!(self, Self::MeshFile { .. })
    }
}

impl fmt::Display for SceneDoubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magnitude(magnitude) => magnitude.fmt(f),
            Self::Unheld { sets } => write!(
                f,
                "nothing holds the body of {} under gravity: it falls; give it supports, or a stage in which it reaches equilibrium",
                quoted(sets)
            ),
            Self::SuddenWeight => write!(
                f,
                "gravity comes on the body all at once at the start of the run, and it swings about its equilibrium: a stage brings it there before"
            ),
            Self::HeldField { share, node } => write!(
                f,
                "the supports hold node {node} in a direction in which the free field moves with {:.1} % of its largest velocity: they reflect the incident waves",
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
                "{what} are asked for every {interval} s, which is less than the step of {step:.3e} s: they are recorded at every step"
            ),
            Self::LongInterval {
                what,
                interval,
                duration,
            } => write!(
                f,
                "{what} are asked for every {interval} s, which is longer than the run of {duration} s: nothing between its start and its end is recorded"
            ),
            Self::Threads { wanted, available } => write!(
                f,
                "threads = {wanted}, but the machine has {available}: the run takes {available}"
            ),
            Self::WholeRim { set } => write!(
                f,
                "the rim of part '{set}' is the whole part: all of it is elastic and undamped"
            ),
            Self::MeshFile {
                nodes,
                dropped,
                ungrouped,
            } => {
                let mut found = Vec::new();
                if *nodes > 0 {
                    found.push(format!(
                        "{nodes} nodes that no element of the mesh uses were left out"
                    ));
                }
                if *dropped > 0 {
                    found.push(format!(
                        "{dropped} lines, facets and points of no physical group were left out"
                    ));
                }
                if *ungrouped > 0 {
                    found.push(format!(
                        "{ungrouped} elements of no physical group are in the set 'all' or 'ungrouped'"
                    ));
                }
                write!(f, "mesh: {}", found.join("; "))
            }
        }
    }
}

/// Names in quotes, one after the other.
fn quoted(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    names.join(", ")
}
