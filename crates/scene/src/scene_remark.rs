//! Remarks about implausible values and combinations in a scene.

use core::fmt;
use std::path::PathBuf;

use crate::high_damping::HighDamping;
use crate::magnitude::Magnitude;
use crate::{FibreChoice, FirstOfSet, StiffPart, WetJoint};

/// Warning about an implausible value or combination in a scene that can be computed nevertheless, or a fact, such as
/// [`MeshFile`](Self::MeshFile).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SceneRemark {
    /// The fibres of the scene; a warning if the step falls short of that requested.
    Fibres(Box<FibreChoice>),
    /// Warning: a quantity is outside its usual range, in a scene that allows such quantities.
    Magnitude(Magnitude),
    /// Fact: viscosity of a part at the highest frequencies of its elements.
    HighDamping(HighDamping),
    /// Water in a joint, or a warning about water beside a dry one.
    WetJoint(WetJoint),
    /// Warning: P waves of a part of a slice with delayed sides are faster than the motion along y, or nearly so.
    StiffPart(StiffPart),
    /// Warning: bodies under gravity that nothing restrains along it (no support, prescribed motion or boundary spring
    /// with a component along gravity), in a scene without stages, user constraints and boundary elements: they fall
    /// freely. Parts that share nodes, joints or periodic pairs are one body.
    UnsupportedBody {
        /// Element sets of the parts with an element in such a body.
        sets: Vec<String>,
    },
    /// Warning: gravity acts on a supported body from the start of the run, in a scene without a stage in which the body
    /// reaches static equilibrium: it oscillates about its equilibrium. Gravity that grows from zero is no warning.
    SuddenGravity,
    /// Warning: supports restrain nodes in a direction in which the free field moves with more than 1 % of its largest
    /// velocity during the run, and reflect waves.
    RestrainedField {
        /// Largest velocity of the field along restrained directions over its largest velocity (1).
        share: f64,
        /// Number of the node with this velocity in the mesh file.
        node: u64,
    },
    /// Supports on a plane about which the free field is not symmetric: its traction there, in the directions that they
    /// leave free, acts on no element of the model.
    AsymmetricField {
        /// Largest such traction of the free field over the wave stress: impedance of S waves times largest velocity.
        share: f64,
        /// Number of the node with this traction in the mesh file.
        node: u64,
        /// Least apparent speed of the plane waves along the normal of the plane (m/s); none for other fields, and
        /// for waves that travel along the plane.
        speed: Option<f64>,
    },
    /// Periodic pairs whose two nodes move differently in the free field.
    PeriodicField {
        /// Largest difference of the velocities of the free field over its largest velocity.
        share: f64,
        /// Largest strain of the free field along a pair (difference of displacements over distance) over the wave
        /// strain: largest velocity over speed of S waves.
        strain: f64,
        /// Numbers of the nodes of the pair with the largest difference in the mesh file.
        nodes: [u64; 2],
        /// Distance of these nodes (m).
        distance: f64,
        /// Least apparent speed of the plane waves along the pair (m/s); none for other fields, and for waves that
        /// travel across the pair.
        speed: Option<f64>,
    },
    /// Warning: an absorbing face has a facet on or above the free surface of the half-space, where waves should be
    /// reflected.
    AbsorbingSurface {
        /// Facet set of the face.
        face: String,
    },
    /// Warning: a joint slides with friction, and a part beside it has no damping of high frequencies: oscillations of sliding
    /// bodies grow by themselves at any time step.
    UndampedFriction {
        /// Name of the joint.
        joint: String,
        /// Coefficient of friction of a sliding pair (1).
        friction: f64,
        /// Element sets of the parts.
        sets: Vec<String>,
    },
    /// Warning: a prescribed displacement is not that of the body at rest when the run begins.
    PrescribedJump {
        /// Number of nodes.
        nodes: usize,
        /// Number of the first of them.
        node: u64,
        /// Displacement at the start (m).
        displacement: f64,
    },
    /// Warning: a prescribed displacement begins with a velocity.
    PrescribedVelocity {
        /// Number of nodes.
        nodes: usize,
        /// Number of the first of them.
        node: u64,
        /// Velocity at the start (m/s).
        velocity: f64,
        /// That velocity over the greatest of the run (1).
        share: f64,
    },
    /// Warning: segments of bolts are too long for their grout.
    CoarseBolts {
        /// Name of the bolts.
        bolts: String,
        /// Relative error of the greatest force in ground that is stretched uniformly (1).
        error: f64,
    },
    /// Warning: construction stages without in-situ stress and without loads, in which nothing happens.
    IdleStages,
    /// Warning: the in-situ stress of stages grows with depth as that of ground under its weight, but no gravity acts.
    WeightlessGround,
    /// Warning: bolts without grout cross a joint, whose opening and slip do not stretch them.
    CutBolts {
        /// Name of the bolts.
        bolts: String,
        /// Name of the joint.
        joint: String,
        /// Number of bolts that cross it.
        crossing: usize,
    },
    /// Scatterer above the body.
    ScattererAbove {
        /// Height z of the scatterer (m).
        height: f64,
        /// Greatest height z of the body (m).
        top: f64,
    },
    /// Springs for spherical spreading of scattered waves on a model that stands for a long body.
    SphericalSpreading {
        /// What makes the model one of a long body.
        ends: &'static str,
    },
    /// Warning: the requested sampling interval of an output is shorter than the time step, so that every step is recorded;
    /// found when the step of the run is determined.
    ShortInterval {
        /// Kind of output: `histories`, `energies`, `envelopes` or `snapshots`.
        what: &'static str,
        /// Requested interval (s).
        interval: f64,
        /// Time step (s).
        step: f64,
    },
    /// Warning: the requested sampling interval of an output is longer than the run, so that its start and end alone are
    /// recorded; found when the step of the run is determined.
    LongInterval {
        /// Kind of output: `histories`, `energies`, `envelopes` or `snapshots`.
        what: &'static str,
        /// Requested interval (s).
        interval: f64,
        /// Duration of the run (s).
        duration: f64,
    },
    /// Warning: the requested number of threads is above that of the machine.
    Threads {
        /// Requested number.
        wanted: usize,
        /// Number of the machine, which is used.
        available: usize,
    },
    /// Warning: the engine computes no balance of energies, by which a run would be checked.
    NoEnergyBalance {
        /// Name of the engine.
        engine: String,
    },
    /// Warning: a rim covers the whole part, so that its law or damping acts nowhere.
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
    /// Fact: keys of the scene file that were changed for this scene, such as by `--set`.
    ChangedKeys {
        /// The changes, each as `KEY=VALUE`.
        changes: Vec<String>,
    },
    /// Fact: a scene with a set of records has, where it is no case of the set, the motion of the first of these cases.
    FirstOfRecordSet(FirstOfSet),
    /// Warning: the mesh file of which a packed mesh was made was changed since.
    OldPackedMesh {
        /// Path of the packed mesh.
        packed: PathBuf,
        /// Path of the mesh file.
        source: PathBuf,
    },
    /// Fact: the mesh file has nodes and elements that were left out of the mesh, or that belong to no physical group.
    MeshFile {
        /// Number of nodes without elements.
        nodes: usize,
        /// Number of lines, facets and points without physical group.
        dropped: usize,
        /// Number of solids and bars without physical group or element set, which are in the set `all` or `ungrouped`.
        ungrouped: usize,
    },
    /// Fact: the mesh file has its content in another form than the mesh.
    MeshContent {
        /// Number of lines of physical curves that no part names.
        curves: usize,
        /// Number of solids with repeated nodes, which are wedges, pyramids and tetrahedra.
        collapsed: usize,
        /// Name of each of several instances, and what was added to its numbers of nodes and elements.
        instances: Vec<(String, u64)>,
    },
    /// Warning: the mesh file has what the mesh cannot have.
    MeshLeftOut {
        /// Springs, dashpots, masses and the like: type and number.
        left_out: Vec<(String, usize)>,
        /// Number of elements with temperatures or pore pressures as further unknowns.
        coupled: usize,
        /// Number of nodes with coordinates that are omitted, and taken as zero.
        omitted: usize,
    },
    /// Fact: the surface of the body is not flat, while the free field is that of flat ground, as it is at the absorbing faces.
    Relief {
        /// Height z of the surface of the flat ground (m).
        surface: f64,
        /// Lowest height z of the surface of the body (m).
        lowest: f64,
        /// Greatest height z of the surface of the body (m).
        highest: f64,
    },
    /// Fact: keywords of an Abaqus input file that were skipped, since they do not describe the mesh.
    MeshKeywords {
        /// Names of the keywords, such as `*MATERIAL`, in alphabetical order.
        skipped: Vec<String>,
    },
    /// Fact: elements of second order that are computed by their corners alone, or whose curved edges are computed as straight.
    MeshOrder {
        /// Number of elements of the file of which the corners alone are computed.
        lowered: usize,
        /// Number of nodes on curved edges, which were left out or moved to the midpoints.
        curved: usize,
        /// Largest distance of such a node from the midpoint (m), in the coordinates of the file.
        largest: f64,
    },
}

impl SceneRemark {
    /// Returns whether this is a warning (`true`) or a fact (`false`).
    pub fn is_warning(&self) -> bool {
        if let Self::Fibres(choice) = self {
            return choice.falls_short();
        }
        if let Self::WetJoint(joint) = self {
            return joint.is_warning();
        }
        !matches!(
            self,
            Self::ChangedKeys { .. }
                | Self::FirstOfRecordSet(_)
                | Self::MeshFile { .. }
                | Self::MeshContent { .. }
                | Self::MeshKeywords { .. }
                | Self::MeshOrder { .. }
                | Self::FormerKey { .. }
                | Self::HighDamping(_)
                | Self::Relief { .. }
        )
    }
}

/// Share of the stable step that keeps the highest frequency of sliding pairs below it, for coefficients of friction above
/// 0.9, beyond which the usual share does not; see "Friction and the step" in `docs/theory.md`.
fn bounded_safety(friction: f64) -> Option<f64> {
    let raised = 0.5 * (1.0 + friction.hypot(1.0));
    (friction > 0.9).then(|| raised.sqrt().recip() / 0.98)
}

impl fmt::Display for SceneRemark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fibres(choice) => choice.fmt(f),
            Self::Magnitude(magnitude) => magnitude.fmt(f),
            Self::HighDamping(high) => high.fmt(f),
            Self::StiffPart(stiff) => stiff.fmt(f),
            Self::WetJoint(joint) => joint.fmt(f),
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
                "the supports restrain node {node} in a direction in which the free field moves with {:.1} % of its largest velocity: they reflect the incident waves{DELAYED}",
                100.0 * share
            ),
            Self::AsymmetricField { share, node, speed } => {
                write!(
                    f,
                    "on the side of node {node} the free field has a traction of {:.1} % of the wave stress (impedance of S waves times largest velocity) in directions that the supports leave free: rollers make that side a plane of symmetry, which the field does not have",
                    100.0 * share
                )?;
                travels(f, *speed, "through that side")?;
                write!(
                    f,
                    "; let the waves travel along that side (`azimuth`), or make it absorbing{DELAYED}"
                )
            }
            Self::PeriodicField {
                share,
                strain,
                nodes: [first, second],
                distance,
                speed,
            } => {
                write!(
                    f,
                    "the free field moves the periodic pair of nodes {first} and {second}, {distance:.3} m apart, differently, by {:.1} % of its largest velocity, and strains it by {:.1} % of the wave strain (largest velocity over speed of S waves), but periodic pairs move as one",
                    100.0 * share,
                    100.0 * strain
                )?;
                travels(f, *speed, "along the pair")?;
                write!(
                    f,
                    "; let the waves travel across the pairs (`azimuth`), or make both sides absorbing{DELAYED}"
                )
            }
            Self::AbsorbingSurface { face } => write!(
                f,
                "the absorbing face '{face}' lies on the free surface of the half-space: scattered waves leave through it instead of being reflected"
            ),
            Self::UndampedFriction {
                joint,
                friction,
                sets,
            } => {
                write!(
                    f,
                    "the joint '{joint}' slides with a friction of {friction:.2} beside parts without damping ({}): oscillations of such bodies grow by themselves at any time step (flutter), from rounding to a visible motion in some {:.0} steps where all pairs slide or are about to; give the parts `damping`",
                    sets.join(", "),
                    700.0 / friction
                )?;
                match bounded_safety(*friction) {
                    Some(safety) => write!(
                        f,
                        "; where it is oblique, `safety = {safety:.2}` in [time] keeps its highest frequency below the stable step"
                    ),
                    None => Ok(()),
                }
            }
            Self::PrescribedJump {
                nodes,
                node,
                displacement,
            } => write!(
                f,
                "the displacement prescribed at {nodes} nodes (the first is {node}) jumps by {displacement:.3e} m when the run begins: the first time step covers it, an impact whose stress grows as the step shortens; let it begin at zero, such as by `function = {{ kind = \"ramp\", duration = ... }}`"
            ),
            Self::PrescribedVelocity {
                nodes,
                node,
                velocity,
                share,
            } => write!(
                f,
                "the velocity prescribed at {nodes} nodes (the first is {node}) jumps by {velocity:.3e} m/s when the run begins, {:.0} % of its greatest: a front of stress, impedance times this velocity, with frequencies above those that the mesh carries; let it begin with a horizontal tangent, such as by a `table`",
                100.0 * share
            ),
            Self::CoarseBolts { bolts, error } => write!(
                f,
                "the segments of the bolts '{bolts}' are too long for their grout: in ground that is stretched uniformly their greatest force errs by {:.0} %; leave `longest_segment` out, or give a shorter one",
                100.0 * error
            ),
            Self::IdleStages => write!(
                f,
                "the stages have neither `[in_situ_stress]` nor loads: nothing deforms in them; the stress of the ground is given by both `[in_situ_stress]` and a [[load]] of kind `gravity`"
            ),
            Self::WeightlessGround => write!(
                f,
                "`[in_situ_stress]` grows with depth, as of ground under its weight, but no [[load]] of kind `gravity` acts: the first stage is out of balance by all of the weight"
            ),
            Self::CutBolts {
                bolts,
                joint,
                crossing,
            } => write!(
                f,
                "{crossing} of the bolts '{bolts}' cross the joint '{joint}' without grout: its opening and slip do not stretch them, and they bear nothing from one side to the other; give the bolts a `grout`"
            ),
            Self::ScattererAbove { height, top } => write!(
                f,
                "`scatterer` is at z = {height} m, above the body, which ends at {top} m: the springs of the boundary take their distance from the centre of the structure"
            ),
            Self::SphericalSpreading { ends } => write!(
                f,
                "the springs of the boundary are those of spherical spreading, but the model is {ends}, from which scattered waves spread as cylinders: give `spreading = \"cylindrical\"`"
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
            Self::NoEnergyBalance { engine } => write!(
                f,
                "the engine '{engine}' computes no balance of energies: the run is not checked by it"
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
            Self::ChangedKeys { changes } => write!(
                f,
                "keys of the scene file that are changed here: {}",
                changes.join(", ")
            ),
            Self::FirstOfRecordSet(first) => write!(f, "{first}"),
            Self::OldPackedMesh { packed, source } => write!(
                f,
                "{} was changed since {} was made of it: pack it again, or name the packed mesh that is meant",
                source.display(),
                packed.display()
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
                        "{ungrouped} elements without physical group or element set are in the set 'all' or 'ungrouped'"
                    ));
                }
                write!(f, "mesh: {}", found.join("; "))
            }
            Self::Relief {
                surface,
                lowest,
                highest,
            } => write!(
                f,
                "the surface of the body lies between z = {lowest:.3} and {highest:.3} m, and that of the ground around it at {surface:.3} m: the waves that come in are those of flat ground, and what the relief scatters leaves through the absorbing faces"
            ),
            Self::MeshContent {
                curves,
                collapsed,
                instances,
            } => {
                let mut found = Vec::new();
                if *curves > 0 {
                    found.push(format!(
                        "{curves} lines of physical curves that no part names are no bars, but sets of their nodes"
                    ));
                }
                if *collapsed > 0 {
                    found.push(format!(
                        "{collapsed} solids with repeated nodes are wedges, pyramids or tetrahedra"
                    ));
                }
                if !instances.is_empty() {
                    let shifts = instances
                        .iter()
                        .map(|(name, shift)| format!("{name} + {shift}"));
                    let shifts: Vec<String> = shifts.collect();
                    found.push(format!(
                        "numbers of nodes and elements: {}",
                        shifts.join(", ")
                    ));
                }
                write!(f, "mesh: {}", found.join("; "))
            }
            Self::MeshLeftOut {
                left_out,
                coupled,
                omitted,
            } => {
                let types = left_out
                    .iter()
                    .map(|(name, count)| format!("{count} {name}"));
                let mut found: Vec<String> = types.collect();
                if !found.is_empty() {
                    found = vec![format!("elements were left out: {}", found.join(", "))];
                }
                if *coupled > 0 {
                    found.push(format!(
                        "{coupled} elements have temperatures or pore pressures, which are left out"
                    ));
                }
                if *omitted > 0 {
                    found.push(format!(
                        "{omitted} nodes have omitted coordinates, which are zero"
                    ));
                }
                write!(f, "mesh: {}", found.join("; "))
            }
            Self::MeshKeywords { skipped } => {
                write!(
                    f,
                    "mesh: keywords of the file that do not describe the mesh were skipped: {}",
                    skipped.join(", ")
                )?;
                match skipped.iter().any(|keyword| keyword == "*TIE") {
                    true => f.write_str(
                        "; a [[joint]] of law `tied`, whose `facets` are the two surfaces, does what *TIE does",
                    ),
                    false => Ok(()),
                }
            }
            Self::MeshOrder {
                lowered,
                curved,
                largest,
            } => {
                let mut found = Vec::new();
                if *lowered > 0 {
                    found.push(format!(
                        "{lowered} elements of second order are computed by their corners alone"
                    ));
                }
                if *curved > 0 {
                    let way = if *lowered > 0 {
                        "left out"
                    } else {
                        "moved to the midpoints"
                    };
                    found.push(format!(
                        "{curved} nodes on curved edges, up to {largest:.3e} off the midpoints, were {way}"
                    ));
                }
                write!(f, "mesh: {}", found.join("; "))
            }
        }
    }
}

/// The way out for slices along y.
const DELAYED: &str = "; both sides of a slice of a long structure along y may be `[[support]] kind = \"delayed\"`, under waves of any azimuth";

/// Writes the apparent speed (m/s) with which a wave travels, if it is known.
fn travels(f: &mut fmt::Formatter<'_>, speed: Option<f64>, way: &str) -> fmt::Result {
    match speed {
        Some(speed) => write!(
            f,
            ", and a wave travels {way} with an apparent speed of {speed:.0} m/s"
        ),
        None => Ok(()),
    }
}

/// Comma-separated list of quoted names.
pub(crate) fn quoted(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    names.join(", ")
}
