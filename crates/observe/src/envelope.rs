//! Envelopes: extreme values over time, with their times.

use powerhouse_model::{
    Cadence, Fields, Flow, Mesh, ModelError, Observer, Reach, Selection, StateError, StepView,
    Vec3, decode, encode,
};
use serde::{Deserialize, Serialize};

use super::{AccelerationRule, Motion, ObserveError, Recording, check_cadence, principal_stresses};

/// Envelope of a field: the extreme value at each node or element, with its time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PeakField {
    /// Extreme values, in the order of the nodes or elements.
    pub values: Vec<f64>,
    /// Times of the extreme values (s), in the order of `values`.
    pub times: Vec<f64>,
}

impl PeakField {
    pub(super) fn new(count: usize, start: f64) -> Self {
        Self {
            values: vec![start; count],
            times: vec![0.0; count],
        }
    }
    /// Sets an entry.
    pub(super) fn set(&mut self, index: usize, value: f64, time: f64) {
        (self.values[index], self.times[index]) = (value, time);
    }
    pub(super) fn raise(&mut self, index: usize, value: f64, time: f64) {
        if value > self.values[index] {
            self.values[index] = value;
            self.times[index] = time;
        }
    }
    pub(super) fn lower(&mut self, index: usize, value: f64, time: f64) {
        if value < self.values[index] {
            self.values[index] = value;
            self.times[index] = time;
        }
    }
}

/// Results of an [`Envelope`]. Fields that were not requested are empty; before the first
/// [observation](Self::observations) all values are zero.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnvelopeTable {
    /// Mesh indices of the nodes that the fields of motion are of, in the order of their values.
    pub nodes: Vec<u32>,
    /// Largest magnitude of displacement (m).
    pub displacement: PeakField,
    /// Largest magnitude of velocity (m/s).
    pub velocity: PeakField,
    /// Largest magnitude of acceleration (m/s2), of [means](AccelerationRule::Mean) over the interval before an observation.
    pub acceleration: PeakField,
    /// Mesh indices of the elements that the fields of stress are of, in the order of their values.
    pub elements: Vec<u32>,
    /// Greatest (most tensile) principal stress (Pa).
    pub greatest_stress: PeakField,
    /// Least (most compressive) principal stress (Pa).
    pub least_stress: PeakField,
    /// Number of time steps at which the envelope was evaluated.
    pub observations: u64,
    /// Greatest acceleration of all nodes (m/s2) over the odd and over the even observations; of means over one and over two
    /// intervals.
    pub alternate_acceleration: [f64; 2],
}

impl EnvelopeTable {
    /// Greatest acceleration with every second observation alone, of means over intervals twice as long, over that with all
    /// observations: a share far below one shows that the envelope depends on its cadence. None without accelerations or before two observations.
    pub fn share_of_alternate_samples(&self) -> Option<f64> {
        let [first, second] = self.alternate_acceleration;
        let greatest = first.max(second);
        (self.observations > 1 && greatest > 0.0).then(|| first.min(second) / greatest)
    }
}

/// Observer of envelopes: largest motion of nodes, and greatest and least principal stress of elements.
///
/// Peaks between observed steps are missed: with `n` observations per period of the highest
/// relevant frequency the peak of a sinusoid is underestimated by at most `1 - cos(pi / n)`, 0.5 % at 31. Accelerations are means
/// over the interval before each observation, or instants by [request](Self::accelerations).
///
/// Memory: 4 bytes per node and 16 per node and kind of motion, 24 per node with mean accelerations, 36 per element.
///
/// ```
/// use powerhouse_observe::{Envelope, Motion};
/// use powerhouse_model::{Cadence, Mesh, Vec3};
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(10.0), [5, 5, 5], "rock")?;
/// let rock = mesh.element_set("rock")?;
/// let surface = mesh.nodes_of_facets(mesh.facet_set("top")?);
/// let envelope = Envelope::new(&mesh, &surface, Motion::ALL, rock, Cadence::Seconds(0.005))?;
/// let recording = envelope.recording();
/// assert_eq!(recording.read(|table| table.acceleration.values.len()), 36);
/// # Ok::<(), powerhouse_observe::ObserveError>(())
/// ```
pub struct Envelope {
    cadence: Cadence,
    motion: Motion,
    node_tags: Vec<u64>,
    element_tags: Vec<u64>,
    rule: AccelerationRule,
    /// Times of the last two observations (s), the last one first, and the velocities of the nodes behind them (m/s), of mean
    /// accelerations.
    before: Vec<(f64, Vec<Vec3>)>,
    recording: Recording<EnvelopeTable>,
}

impl Envelope {
    /// An observer of nodes and elements, given by mesh indices; either list may be empty.
    ///
    /// # Errors
    /// A cadence out of range, an index beyond the mesh.
    pub fn new(
        mesh: &Mesh,
        nodes: &[u32],
        motion: Motion,
        elements: &[u32],
        cadence: Cadence,
    ) -> Result<Self, ObserveError> {
        check_cadence(cadence)?;
        let node_tags = tags(mesh.node_tags(), nodes).map_err(|node| ObserveError::NoSuchNode {
            name: "envelope".into(),
            node,
        })?;
        let element_tags =
            tags(mesh.element_tags(), elements).map_err(|element| ObserveError::NoSuchElement {
                name: "envelope".into(),
                element,
            })?;
        // Zeros, whose memory is not taken before the first observation: there is none on other ranks than 0.
        let of_nodes = |wanted: bool| PeakField::new(if wanted { nodes.len() } else { 0 }, 0.0);
        let table = EnvelopeTable {
            nodes: nodes.to_vec(),
            displacement: of_nodes(motion.displacement),
            velocity: of_nodes(motion.velocity),
            acceleration: of_nodes(motion.acceleration),
            elements: elements.to_vec(),
            greatest_stress: PeakField::new(elements.len(), 0.0),
            least_stress: PeakField::new(elements.len(), 0.0),
            observations: 0,
            alternate_acceleration: [0.0; 2],
        };
        Ok(Self {
            cadence,
            motion,
            node_tags,
            element_tags,
            rule: AccelerationRule::default(),
            before: Vec::new(),
            recording: Recording::new(table),
        })
    }
    /// Sets the rule of the accelerations.
    #[must_use]
    pub fn accelerations(mut self, rule: AccelerationRule) -> Self {
        self.rule = rule;
        self
    }
    /// Shared access to the results.
    pub fn recording(&self) -> Recording<EnvelopeTable> {
        self.recording.clone()
    }
}

/// The user's numbers of indices, or an index out of range.
fn tags(all: &[u64], indices: &[u32]) -> Result<Vec<u64>, u64> {
    indices
        .iter()
        .map(|&i| all.get(i as usize).copied().ok_or(u64::from(i)))
        .collect()
}

/// Updates the envelope of a motion, given by the place of a node in the list, and returns its greatest magnitude.
fn update(
    field: &mut PeakField,
    what: &'static str,
    tags: &[u64],
    (time, is_first): (f64, bool),
    value: impl Fn(usize) -> Vec3,
) -> Result<f64, ObserveError> {
    let mut greatest = 0.0_f64;
    // A field that was not requested has no values.
    for index in 0..field.values.len() {
        let magnitude = value(index).norm();
        if !magnitude.is_finite() {
            return Err(ObserveError::NotFinite {
                what,
                place: "node",
                number: tags[index],
                time,
            });
        }
        if is_first {
            field.set(index, magnitude, time)
        } else {
            field.raise(index, magnitude, time)
        }
        greatest = greatest.max(magnitude);
    }
    Ok(greatest)
}

impl Observer for Envelope {
    fn name(&self) -> &str {
        "envelope"
    }
    fn fields(&self) -> Fields {
        Fields::default()
            .with_acceleration(self.motion.acceleration && !self.node_tags.is_empty())
            .with_stress(!self.element_tags.is_empty())
    }
    fn reach(&self) -> Reach {
        let table = self.recording.lock();
        Reach::NONE
            .with_nodes(Selection::These(table.nodes.clone()))
            .with_elements(Selection::These(table.elements.clone()))
    }
    fn cadence(&self) -> Cadence {
        self.cadence
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        encode(&(&self.before, self.recording.save()?))
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        type Saved = (Vec<(f64, Vec<Vec3>)>, Vec<u8>);
        let (before, table): Saved = decode(saved)?;
        self.recording.restore(&table, |found, here| {
            StateError::expect_same("the list of nodes", &found.nodes, &here.nodes)?;
            StateError::expect_same("the list of elements", &found.elements, &here.elements)?;
            let sizes = |table: &EnvelopeTable| {
                [&table.displacement, &table.velocity, &table.acceleration]
                    .map(|field| field.values.len())
            };
            StateError::expect_same("the size of its fields", sizes(found), sizes(here))
        })?;
        self.before = before;
        Ok(())
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let time = view.time();
        let mut guard = self.recording.lock();
        let table = &mut *guard;
        let (nodes, tags) = (table.nodes.as_slice(), self.node_tags.as_slice());
        let now = (time, table.observations == 0);
        let (moved, moves) = (&mut table.displacement, &mut table.velocity);
        update(moved, "displacement", tags, now, |n| {
            view.displacement(nodes[n])
        })?;
        update(moves, "velocity", tags, now, |n| view.velocity(nodes[n]))?;
        let accelerated = &mut table.acceleration;
        if self.rule == AccelerationRule::Instant {
            let greatest = update(accelerated, "acceleration", tags, now, |n| {
                view.acceleration(nodes[n])
            })?;
            let alternate = &mut table.alternate_acceleration[(table.observations % 2) as usize];
            *alternate = alternate.max(greatest);
        } else if !accelerated.values.is_empty() {
            let behind = |&node: &u32| {
                let half = view.acceleration(node) * (0.5 * view.step());
                view.velocity(node) + half
            };
            let velocities: Vec<Vec3> = nodes.iter().map(behind).collect();
            // Nothing is known before the first observation.
            let still = (time - view.step(), velocities.clone());
            let (before, last) = self.before.first().unwrap_or(&still);
            let greatest = update(accelerated, "acceleration", tags, now, |n| {
                (velocities[n] - last[n]) / (time - before)
            })?;
            let [single, double] = &mut table.alternate_acceleration;
            *single = single.max(greatest);
            if let Some((before, last)) = self.before.get(1) {
                let of_two = velocities.iter().zip(last);
                let of_two = of_two.map(|(now, last)| (now - last).norm() / (time - before));
                *double = of_two.fold(*double, f64::max);
            }
            self.before.truncate(1);
            self.before.insert(0, (time, velocities));
        }
        for (index, &element) in table.elements.iter().enumerate() {
            let [greatest, _, least] = principal_stresses(&view.stress(element));
            if !(greatest.is_finite() && least.is_finite()) {
                return Err(ObserveError::NotFinite {
                    what: "stress",
                    place: "element",
                    number: self.element_tags[index],
                    time,
                }
                .into());
            }
            if table.observations == 0 {
                table.greatest_stress.set(index, greatest, time);
                table.least_stress.set(index, least, time);
            } else {
                table.greatest_stress.raise(index, greatest, time);
                table.least_stress.lower(index, least, time);
            }
        }
        table.observations += 1;
        Ok(Flow::Continue)
    }
}
