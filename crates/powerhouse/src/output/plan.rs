//! Output requests.

use powerhouse_explicit_core::observe::{
    CrossSection, JointQuantities, Motion, Place, SnapshotFields, StressPlace,
};

use crate::JointZone;

/// Motion at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryRequest {
    /// The name in results.
    pub name: String,
    /// Where.
    pub place: Place,
    /// Which motions.
    pub motion: Motion,
}

/// The stress of an element.
#[derive(Clone, Debug, PartialEq)]
pub struct StressRequest {
    /// The name in results.
    pub name: String,
    /// Where.
    pub place: StressPlace,
}

/// The displacement of a place relative to another.
#[derive(Clone, Debug, PartialEq)]
pub struct RelativeRequest {
    /// The name in results.
    pub name: String,
    /// The place.
    pub at: Place,
    /// The place to which its displacement is relative.
    pub from: Place,
}

/// A cut whose section forces are wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionRequest {
    /// The plane.
    pub cut: CrossSection,
    /// The element set that is cut.
    pub set: String,
}

/// Greatest values over a run.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvelopeRequest {
    /// Which motions.
    pub motion: Motion,
    /// Whether principal stresses are tracked.
    pub stress: bool,
    /// The element sets; all elements if none is named.
    pub sets: Vec<String>,
    /// Time between looks (s).
    pub every: f64,
}

/// What becomes of some pairs of a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointRequest {
    /// The name in results.
    pub name: String,
    /// The joint's name.
    pub joint: String,
    /// Which of its pairs.
    pub zone: JointZone,
    /// What is recorded of them.
    pub quantities: JointQuantities,
}

/// Whole fields at a cadence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SnapshotRequest {
    /// What they hold.
    pub fields: SnapshotFields,
    /// Time between them (s).
    pub every: f64,
}

/// What is wanted of the history variables of laws: plastic strains, damage, yield states. The greatest of every
/// amount and the last of all flags are kept anyway.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StateRequest {
    /// Histories of elements; their motion and stress are asked for apart.
    pub places: Vec<StressRequest>,
    /// Time between looks at the greatest values (s); without one they are looked at when the run
    /// ends.
    pub every: Option<f64>,
    /// Whether snapshots hold all variables.
    pub snapshots: bool,
}

/// What is wanted of a run.
///
/// ```
/// use powerhouse::engine::observe::Motion;
/// use powerhouse::model::Vec3;
/// use powerhouse::OutputPlan;
/// let mut plan = OutputPlan::default();
/// plan.every = 0.01;
/// let (crown, floor) = (Vec3::new(0.0, 0.0, -60.0), Vec3::new(0.0, 0.0, -92.0));
/// let plan = plan
///     .history("crown", crown, Motion::ALL)
///     .relative("closure", crown, floor);
/// assert_eq!(plan.histories.len(), 1);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OutputPlan {
    /// Time between samples of histories, relative displacements and section forces (s).
    pub every: f64,
    /// Histories.
    pub histories: Vec<HistoryRequest>,
    /// Histories of stress.
    pub stresses: Vec<StressRequest>,
    /// Relative displacements.
    pub relative: Vec<RelativeRequest>,
    /// Cuts.
    pub cuts: Vec<SectionRequest>,
    /// Joints, or parts of them, beside what is recorded of every joint as a whole.
    pub joints: Vec<JointRequest>,
    /// Time between looks at the energies (s).
    pub energies: Option<f64>,
    /// Greatest values.
    pub envelope: Option<EnvelopeRequest>,
    /// Whole fields.
    pub snapshots: Option<SnapshotRequest>,
    /// History variables of laws.
    pub state: StateRequest,
}

impl Default for OutputPlan {
    /// Nothing; samples would be 5 ms apart.
    fn default() -> Self {
        Self {
            every: 0.005,
            histories: Vec::new(),
            stresses: Vec::new(),
            relative: Vec::new(),
            cuts: Vec::new(),
            joints: Vec::new(),
            energies: None,
            envelope: None,
            snapshots: None,
            state: StateRequest::default(),
        }
    }
}

impl OutputPlan {
    /// Adds the motion at a place.
    #[must_use]
    pub fn history(mut self, name: &str, place: impl Into<Place>, motion: Motion) -> Self {
        self.histories.push(HistoryRequest {
            name: name.into(),
            place: place.into(),
            motion,
        });
        self
    }
    /// Adds the stress of an element, by its number or around a point.
    #[must_use]
    pub fn stress(mut self, name: &str, place: impl Into<StressPlace>) -> Self {
        self.stresses.push(StressRequest {
            name: name.into(),
            place: place.into(),
        });
        self
    }
    /// Adds the history variables of an element's law, by its number or around a point.
    #[must_use]
    pub fn state(mut self, name: &str, place: impl Into<StressPlace>) -> Self {
        self.state.places.push(StressRequest {
            name: name.into(),
            place: place.into(),
        });
        self
    }
    /// Adds the displacement of a place relative to another.
    #[must_use]
    pub fn relative(mut self, name: &str, at: impl Into<Place>, from: impl Into<Place>) -> Self {
        self.relative.push(RelativeRequest {
            name: name.into(),
            at: at.into(),
            from: from.into(),
        });
        self
    }
    /// Adds what becomes of some pairs of a joint.
    #[must_use]
    pub fn joint(
        mut self,
        name: &str,
        joint: &str,
        zone: JointZone,
        quantities: JointQuantities,
    ) -> Self {
        self.joints.push(JointRequest {
            name: name.into(),
            joint: joint.into(),
            zone,
            quantities,
        });
        self
    }
    /// Adds the forces of a cut through an element set.
    #[must_use]
    pub fn cut(mut self, set: &str, cut: CrossSection) -> Self {
        self.cuts.push(SectionRequest {
            cut,
            set: set.into(),
        });
        self
    }
}
