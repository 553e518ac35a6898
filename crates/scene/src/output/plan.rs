//! Output requests.

use core::fmt;
use std::sync::Arc;

use powerhouse_observe::{
    AccelerationRule, CrossSection, HistorySampler, JointQuantities, Motion, ObservationPoint,
    Place, SectionReinforcement, SnapshotFields, StressPlace,
};

use super::{ITEMS, OutputItem, RingRequest};
use crate::JointZone;

/// Request for the motion at a place against time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct HistoryRequest {
    /// Name of the request, with which its columns and plots begin (`NAME.ux`).
    pub name: String,
    /// Location: a node, a set of nodes (the mean of their motion) or a point.
    pub place: Place,
    /// Which of displacement, velocity and acceleration are recorded.
    pub motion: Motion,
}

impl HistoryRequest {
    /// Request for some motions at a place, under a name.
    pub fn new(name: impl Into<String>, place: impl Into<Place>, motion: Motion) -> Self {
        Self {
            name: name.into(),
            place: place.into(),
            motion,
        }
    }
}

/// Request for the mean stress of an element, or for the history variables of its law, against time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StressRequest {
    /// Name of the request, with which its columns and plots begin (`NAME.ux`).
    pub name: String,
    /// An element by its number, or around a point.
    pub place: StressPlace,
    /// Whether a stress is that at the point, which in bricks that bend as their material is linear, or the mean over the
    /// element.
    pub at_point: bool,
}

impl StressRequest {
    /// Request for an element, by number or around a point, under a name.
    pub fn new(name: impl Into<String>, place: impl Into<StressPlace>) -> Self {
        Self {
            name: name.into(),
            place: place.into(),
            at_point: false,
        }
    }
    /// Request for the stress at a point itself, under a name.
    pub fn at_point(name: impl Into<String>, point: impl Into<ObservationPoint>) -> Self {
        Self {
            name: name.into(),
            place: StressPlace::Point(point.into()),
            at_point: true,
        }
    }
}

/// Request for the displacement of a place relative to another, against time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RelativeRequest {
    /// Name of the request, with which its columns and plots begin (`NAME.ux`).
    pub name: String,
    /// The place whose displacement is recorded.
    pub at: Place,
    /// The place to which the displacement is relative.
    pub from: Place,
}

impl RelativeRequest {
    /// Request for the displacement of the place `at` relative to the place `from`, under a name.
    pub fn new(name: impl Into<String>, at: impl Into<Place>, from: impl Into<Place>) -> Self {
        Self {
            name: name.into(),
            at: at.into(),
            from: from.into(),
        }
    }
}

/// Request for quantities of a program's own, against time.
#[derive(Clone)]
#[non_exhaustive]
pub struct SampledRequest {
    /// Name of the request, with which its columns and plots begin.
    pub name: String,
    /// What computes the quantities.
    pub sampler: Arc<dyn HistorySampler>,
}

impl SampledRequest {
    /// Request for the quantities of a sampler, under a name.
    pub fn new(name: impl Into<String>, sampler: Arc<dyn HistorySampler>) -> Self {
        let name = name.into();
        Self { name, sampler }
    }
}

/// Requests of one name are equal if they share a sampler.
impl PartialEq for SampledRequest {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && Arc::ptr_eq(&self.sampler, &other.sampler)
    }
}

impl fmt::Debug for SampledRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "SampledRequest({:?}, {:?})",
            self.name,
            self.sampler.columns()
        )
    }
}

/// Request for the section forces of a cut through an element set, against time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SectionRequest {
    /// The plane, its axes and its extent.
    pub cut: CrossSection,
    /// The element set that is cut.
    pub set: String,
    /// Elements of the set (mesh indices) to which the cut is confined; all of it without them.
    pub elements: Option<Vec<u32>>,
    /// Reinforcement of the section, by which its utilisation is computed; none without one.
    pub reinforcement: Option<SectionReinforcement>,
}

impl SectionRequest {
    /// A request for a cut through an element set.
    pub fn new(set: impl Into<String>, cut: CrossSection) -> Self {
        Self {
            cut,
            set: set.into(),
            elements: None,
            reinforcement: None,
        }
    }
    /// The same with a reinforcement of the section. Its thickness is the extent across of the cut in the mesh.
    #[must_use]
    pub fn with_reinforcement(mut self, reinforcement: SectionReinforcement) -> Self {
        self.reinforcement = Some(reinforcement);
        self
    }
}

/// Request for greatest values over the run (envelopes) of motions and principal stresses.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EnvelopeRequest {
    /// Which of displacement, velocity and acceleration are recorded.
    pub motion: Motion,
    /// Whether the greatest and least principal stress of each element are recorded.
    pub stress: bool,
    /// Element sets whose elements and nodes are recorded; all elements if none is named.
    pub sets: Vec<String>,
    /// Time between two evaluations (s): peaks between them are missed.
    pub every: f64,
}

impl EnvelopeRequest {
    /// Envelopes of all motions of all elements, without stresses, from samples every so many seconds.
    pub fn new(every: f64) -> Self {
        Self {
            motion: Motion::ALL,
            stress: false,
            sets: Vec::new(),
            every,
        }
    }
    /// The same of these kinds of motion, in place of all three.
    #[must_use]
    pub fn with_motion(mut self, motion: Motion) -> Self {
        self.motion = motion;
        self
    }
    /// The same with or without the greatest and least principal stresses of the elements.
    #[must_use]
    pub fn with_stress(mut self, stress: bool) -> Self {
        self.stress = stress;
        self
    }
    /// The same of these element sets, in place of all elements.
    #[must_use]
    pub fn with_sets(mut self, sets: Vec<String>) -> Self {
        self.sets = sets;
        self
    }
}

/// Request for states, openings, slips and tractions of node pairs of a joint, against time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct JointRequest {
    /// Name of the request, with which its columns and plots begin (`NAME.ux`).
    pub name: String,
    /// Name of the joint that the pairs are of.
    pub joint: String,
    /// The node pairs among those of the joint.
    pub zone: JointZone,
    /// The quantities that are recorded.
    pub quantities: JointQuantities,
}

impl JointRequest {
    /// A request under a name, of some pairs of a joint.
    pub fn new(
        name: impl Into<String>,
        joint: impl Into<String>,
        zone: JointZone,
        quantities: JointQuantities,
    ) -> Self {
        Self {
            name: name.into(),
            joint: joint.into(),
            zone,
            quantities,
        }
    }
}

/// Request for fields of the whole body at equal intervals of time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SnapshotRequest {
    /// Fields of each snapshot, beside the history variables that [`StateRequest::snapshots`] requests.
    pub fields: SnapshotFields,
    /// Time between snapshots (s).
    pub every: f64,
}

impl SnapshotRequest {
    /// Snapshots of the default fields every so many seconds.
    pub fn new(every: f64) -> Self {
        Self {
            fields: SnapshotFields::default(),
            every,
        }
    }
    /// The same with these fields, in place of the default ones.
    #[must_use]
    pub fn with_fields(mut self, fields: SnapshotFields) -> Self {
        self.fields = fields;
        self
    }
}

/// Request for history variables (internal state variables) of laws: plastic strains, damage, yield states.
///
/// The greatest value of every amount and the last value of all flags are recorded without a request.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StateRequest {
    /// Elements whose variables are recorded against time; their motion and stress are requests of their
    /// own.
    pub places: Vec<StressRequest>,
    /// Time between samples of the greatest values (s); without one only the last step is sampled, which suffices for
    /// variables that never decrease.
    pub every: Option<f64>,
    /// Whether snapshots, if requested, have the history variables of all elements.
    pub snapshots: bool,
}

impl StateRequest {
    /// The same with the history variables of an element against time added.
    #[must_use]
    pub fn with_place(mut self, place: StressRequest) -> Self {
        self.places.push(place);
        self
    }
    /// Sets the time between two evaluations of the greatest values (s).
    #[must_use]
    pub fn with_every(mut self, every: f64) -> Self {
        self.every = Some(every);
        self
    }
    /// The same with or without the history variables of all elements in snapshots.
    #[must_use]
    pub fn with_snapshots(mut self, snapshots: bool) -> Self {
        self.snapshots = snapshots;
        self
    }
}

/// Output requests of a run.
///
/// `with_x` sets the field `x`; [`history`](Self::history) and its kin add one request to a list.
///
/// ```
/// use powerhouse_observe::Motion;
/// use powerhouse_model::Vec3;
/// use powerhouse_scene::OutputPlan;
/// let (crown, floor) = (Vec3::new(0.0, 0.0, -60.0), Vec3::new(0.0, 0.0, -92.0));
/// let plan = OutputPlan::default()
///     .with_every(0.01)
///     .history("crown", crown, Motion::ALL)
///     .relative("closure", crown, floor);
/// assert_eq!(plan.histories.len(), 1);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct OutputPlan {
    /// Time between samples of histories, relative displacements, section forces, joints and bolts (s); 0.005 by default.
    /// First and last step are recorded in any case.
    pub every: f64,
    /// Rule of the accelerations of histories and envelopes: means over the interval of their samples, or instants.
    pub accelerations: AccelerationRule,
    /// Highest frequency (Hz) of the band-limited accelerations of the histories, from which their peaks and spectra are; without one
    /// [`BAND`](Self::BAND), or none on an engine that it would slow down, and of instants.
    pub band: Option<f64>,
    /// Requests for motions at locations against time.
    pub histories: Vec<HistoryRequest>,
    /// Requests for mean stresses of elements against time.
    pub stresses: Vec<StressRequest>,
    /// Requests for relative displacements against time.
    pub relative: Vec<RelativeRequest>,
    /// Requests for quantities of a program's own against time.
    pub sampled: Vec<SampledRequest>,
    /// Requests for section forces against time.
    pub cuts: Vec<SectionRequest>,
    /// Sections among them that go around linings, added by [`ring`](Self::ring).
    pub rings: Vec<RingRequest>,
    /// Requests for joints, or zones of them, beside what is recorded of every joint as a whole.
    pub joints: Vec<JointRequest>,
    /// Time between samples of the energy balance (s); without one it is not recorded, and a check of its residual reads
    /// it every hundredth of the duration.
    pub energies: Option<f64>,
    /// Request for the greatest values over the run, if any.
    pub envelope: Option<EnvelopeRequest>,
    /// Request for snapshots of the whole body, if any; the run needs a receiver
    /// ([`RunHooks::snapshots`](crate::RunHooks::snapshots)).
    pub snapshots: Option<SnapshotRequest>,
    /// Request for history variables of laws.
    pub state: StateRequest,
    /// Items of a program's own, with tables of their own.
    pub items: Vec<Arc<dyn OutputItem>>,
}

impl Default for OutputPlan {
    /// No request; samples would be 5 ms apart.
    fn default() -> Self {
        Self {
            every: 0.005,
            accelerations: AccelerationRule::default(),
            band: None,
            histories: Vec::new(),
            stresses: Vec::new(),
            relative: Vec::new(),
            sampled: Vec::new(),
            cuts: Vec::new(),
            rings: Vec::new(),
            joints: Vec::new(),
            energies: None,
            envelope: None,
            snapshots: None,
            state: StateRequest::default(),
            items: Vec::new(),
        }
    }
}

impl OutputPlan {
    /// Highest frequency (Hz) of band-limited accelerations without a given one.
    pub const BAND: f64 = 100.0;

    /// Sets the rule of the accelerations of histories and envelopes.
    #[must_use]
    pub fn with_accelerations(mut self, rule: AccelerationRule) -> Self {
        self.accelerations = rule;
        self
    }
    /// Sets the highest frequency (Hz) of the band-limited accelerations of the histories.
    #[must_use]
    pub fn with_band(mut self, band: f64) -> Self {
        self.band = Some(band);
        self
    }
    /// Highest frequency (Hz) of the band-limited accelerations on an engine that takes every step on the host, or does not; none
    /// if there are none.
    pub(crate) fn band_on(&self, takes_every_step: bool) -> Option<f64> {
        let own = takes_every_step.then_some(Self::BAND);
        (self.accelerations == AccelerationRule::Mean)
            .then(|| self.band.or(own))
            .flatten()
    }
    /// Sets the time between samples of histories, relative displacements, section forces, joints and bolts (s).
    #[must_use]
    pub fn with_every(mut self, every: f64) -> Self {
        self.every = every;
        self
    }
    /// Sets the time between samples of the energy balance (s), which is recorded then.
    #[must_use]
    pub fn with_energies(mut self, every: f64) -> Self {
        self.energies = Some(every);
        self
    }
    /// Sets the request for envelopes: greatest values over the run.
    #[must_use]
    pub fn with_envelope(mut self, envelope: EnvelopeRequest) -> Self {
        self.envelope = Some(envelope);
        self
    }
    /// Sets the request for snapshots of the whole body.
    #[must_use]
    pub fn with_snapshots(mut self, snapshots: SnapshotRequest) -> Self {
        self.snapshots = Some(snapshots);
        self
    }
    /// Sets the request for history variables of laws, in place of those added by [`state`](Self::state).
    #[must_use]
    pub fn with_state(mut self, state: StateRequest) -> Self {
        self.state = state;
        self
    }
    /// Adds the motion at a place against time, under a name.
    #[must_use]
    pub fn history(mut self, name: &str, place: impl Into<Place>, motion: Motion) -> Self {
        self.histories
            .push(HistoryRequest::new(name, place, motion));
        self
    }
    /// Adds the stress of an element, by its number or around a point.
    #[must_use]
    pub fn stress(mut self, name: &str, place: impl Into<StressPlace>) -> Self {
        self.stresses.push(StressRequest::new(name, place));
        self
    }
    /// Adds the stress at a point itself, such as the surface of a lining.
    #[must_use]
    pub fn stress_at(mut self, name: &str, point: impl Into<ObservationPoint>) -> Self {
        self.stresses.push(StressRequest::at_point(name, point));
        self
    }
    /// Adds the history variables of an element's law, by its number or around a point.
    #[must_use]
    pub fn state(mut self, name: &str, place: impl Into<StressPlace>) -> Self {
        self.state.places.push(StressRequest::new(name, place));
        self
    }
    /// Adds the displacement of a place relative to another.
    #[must_use]
    pub fn relative(mut self, name: &str, at: impl Into<Place>, from: impl Into<Place>) -> Self {
        self.relative.push(RelativeRequest::new(name, at, from));
        self
    }
    /// Adds the quantities of a sampler of a program's own.
    #[must_use]
    pub fn sample(mut self, name: &str, sampler: Arc<dyn HistorySampler>) -> Self {
        self.sampled.push(SampledRequest::new(name, sampler));
        self
    }
    /// Adds an item of a program's own, whose tables are among those of the run.
    #[must_use]
    pub fn item(mut self, item: Arc<dyn OutputItem>) -> Self {
        self.items.push(item);
        self
    }
    /// The items that come with the software, and those of a program.
    pub(super) fn all_items(&self) -> impl Iterator<Item = &dyn OutputItem> {
        let own = self.items.iter().map(|item| &**item);
        ITEMS.into_iter().chain(own)
    }
    /// Adds states, openings, slips and tractions of some node pairs of a joint.
    #[must_use]
    pub fn joint(
        mut self,
        name: &str,
        joint: &str,
        zone: JointZone,
        quantities: JointQuantities,
    ) -> Self {
        self.joints
            .push(JointRequest::new(name, joint, zone, quantities));
        self
    }
    /// Adds the forces of a cut through an element set.
    #[must_use]
    pub fn cut(mut self, set: &str, cut: CrossSection) -> Self {
        self.cuts.push(SectionRequest::new(set, cut));
        self
    }
}
