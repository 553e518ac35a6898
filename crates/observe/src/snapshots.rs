//! Snapshots: whole fields at one time.

use std::error::Error;

use powerhouse_model::{
    Cadence, Fields, Flow, HistoryVariable, JointView, Mesh, ModelError, Observer, Reach,
    Selection, StateError, StepView, Stress, Vec3, decode, encode,
};

use super::{Motion, ObserveError, check_cadence};

/// Selection of the fields of a snapshot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SnapshotFields {
    /// Nodal motions that a snapshot has: displacement, velocity, acceleration.
    pub motion: Motion,
    /// Whether mean element stresses are included.
    pub stress: bool,
}

/// A snapshot: fields of the whole body at one time. Fields that were not requested are empty.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Snapshot<'a> {
    /// Index of the snapshot, from 0.
    pub index: u64,
    /// Number of time steps taken since the start of the run.
    pub step: u64,
    /// Time at which the displacement is given (s), on the clock of the run.
    pub time: f64,
    /// Displacement (m), one per mesh node.
    pub displacement: &'a [Vec3],
    /// Velocity (m/s), one per mesh node.
    pub velocity: &'a [Vec3],
    /// Acceleration (m/s2), one per mesh node.
    pub acceleration: &'a [Vec3],
    /// Mean stress (Pa), initial stress included, one per mesh element.
    pub stress: &'a [Stress],
    /// Joints of the body with the states of their node pairs at this time.
    pub joints: &'a [JointView<'a>],
    /// History variables of laws, one value per mesh element, zero where the law has no such variable.
    pub state: &'a [(HistoryVariable, Vec<f64>)],
}

/// Receiver of snapshots, such as a writer of files. Closures implement it.
///
/// ```
/// use powerhouse_observe::{Snapshot, SnapshotSink};
/// /// Keeps the largest displacement of each snapshot (m).
/// #[derive(Default)]
/// struct Largest(Vec<f64>);
/// impl SnapshotSink for Largest {
///     fn take(&mut self, shot: &Snapshot) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
///         self.0.push(shot.displacement.iter().map(|u| u.norm()).fold(0.0, f64::max));
///         Ok(())
///     }
/// }
/// ```
pub trait SnapshotSink: Send {
    /// Processes a snapshot, which is valid during the call; the run waits for its return.
    ///
    /// # Errors
    /// Any error, which ends the run.
    fn take(&mut self, snapshot: &Snapshot) -> Result<(), Box<dyn Error + Send + Sync>>;
    /// Completes the output; called once after the last step, also of a stopped or failed run.
    ///
    /// # Errors
    /// Any error, which fails the run.
    fn finish(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(())
    }
    /// State of the receiver between two steps as bytes, such as the list of the files written so far, from which an
    /// equal receiver goes on in a resumed run; empty by default.
    ///
    /// # Errors
    /// A state that cannot be saved.
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        Ok(Vec::new())
    }
    /// Restores a state that an equal receiver [saved](Self::save_state).
    ///
    /// # Errors
    /// A state of another receiver; by default every state that is not empty.
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        StateError::expect_none(saved)
    }
}

impl<F> SnapshotSink for F
where
    F: FnMut(&Snapshot) -> Result<(), Box<dyn Error + Send + Sync>> + Send,
{
    fn take(&mut self, snapshot: &Snapshot) -> Result<(), Box<dyn Error + Send + Sync>> {
        self(snapshot)
    }
}

/// Observer that passes snapshots of the body to a [`SnapshotSink`].
///
/// Memory: 24 bytes per node and kind of motion, 48 per element for stress, reused from snapshot to
/// snapshot.
///
/// ```
/// use powerhouse_observe::{Motion, Snapshot, SnapshotFields, Snapshots};
/// use powerhouse_model::{Cadence, Mesh, Vec3};
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(10.0), [5, 5, 5], "rock")?;
/// let fields = SnapshotFields { motion: Motion::VELOCITY, stress: true };
/// let snapshots = Snapshots::new(&mesh, fields, Cadence::Seconds(0.1), |shot: &Snapshot| {
///     println!("{} s: {} velocities", shot.time, shot.velocity.len());
///     Ok(())
/// })?;
/// # Ok::<(), powerhouse_observe::ObserveError>(())
/// ```
pub struct Snapshots {
    cadence: Cadence,
    fields: SnapshotFields,
    elements: usize,
    taken: u64,
    displacement: Vec<Vec3>,
    velocity: Vec<Vec3>,
    acceleration: Vec<Vec3>,
    stress: Vec<Stress>,
    state: Vec<(HistoryVariable, Vec<f64>)>,
    sink: Box<dyn SnapshotSink>,
}

impl Snapshots {
    /// An observer of the fields of a mesh with a cadence and a receiver.
    ///
    /// # Errors
    /// A cadence out of range.
    pub fn new(
        mesh: &Mesh,
        fields: SnapshotFields,
        cadence: Cadence,
        sink: impl SnapshotSink + 'static,
    ) -> Result<Self, ObserveError> {
        check_cadence(cadence)?;
        Ok(Self {
            cadence,
            fields,
            elements: mesh.element_count(),
            taken: 0,
            displacement: Vec::new(),
            velocity: Vec::new(),
            acceleration: Vec::new(),
            stress: Vec::new(),
            state: Vec::new(),
            sink: Box::new(sink),
        })
    }
    /// The same observer with these history variables of laws, in place of none: element values, zero in elements whose law
    /// has no such variable.
    #[must_use]
    pub fn with_state(mut self, variables: &[HistoryVariable]) -> Self {
        let variables = variables.iter();
        self.state = variables.map(|variable| (*variable, Vec::new())).collect();
        self
    }
}

fn refill<T>(values: &mut Vec<T>, count: usize, value: impl Fn(u32) -> T) {
    values.clear();
    values.extend((0..count as u32).map(value));
}

impl Observer for Snapshots {
    fn name(&self) -> &str {
        "snapshots"
    }
    fn fields(&self) -> Fields {
        Fields::default()
            .with_acceleration(self.fields.motion.acceleration)
            .with_stress(self.fields.stress)
    }
    fn reach(&self) -> Reach {
        let Motion {
            displacement,
            velocity,
            acceleration,
        } = self.fields.motion;
        let moves = displacement || velocity || acceleration;
        let chosen = |read: bool| {
            if read {
                Selection::All
            } else {
                Selection::NONE
            }
        };
        Reach::NONE
            .with_nodes(chosen(moves))
            .with_elements(chosen(self.fields.stress || !self.state.is_empty()))
            .with_variables(self.state.iter().map(|(variable, _)| variable.name))
            .with_joints()
    }
    fn cadence(&self) -> Cadence {
        self.cadence
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        encode(&(self.taken, self.sink.save_state()?))
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        let (taken, of_sink): (u64, Vec<u8>) = decode(saved)?;
        self.sink.restore_state(&of_sink)?;
        self.taken = taken;
        Ok(())
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let Motion {
            displacement,
            velocity,
            acceleration,
        } = self.fields.motion;
        let nodes = |wanted: bool| if wanted { view.node_count() } else { 0 };
        let elements = if self.fields.stress { self.elements } else { 0 };
        refill(&mut self.displacement, nodes(displacement), |n| {
            view.displacement(n)
        });
        refill(&mut self.velocity, nodes(velocity), |n| view.velocity(n));
        refill(&mut self.acceleration, nodes(acceleration), |n| {
            view.acceleration(n)
        });
        refill(&mut self.stress, elements, |e| view.stress(e));
        for (variable, values) in &mut self.state {
            refill(values, self.elements, |element| {
                view.history(element, variable.name).unwrap_or(0.0)
            });
        }
        let snapshot = Snapshot {
            index: self.taken,
            step: view.number(),
            time: view.time(),
            displacement: &self.displacement,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
            stress: &self.stress,
            joints: &view.joints(),
            state: &self.state,
        };
        let taken = self.sink.take(&snapshot);
        taken.map_err(|error| ModelError::refused("snapshots", error))?;
        self.taken += 1;
        Ok(Flow::Continue)
    }
    fn finish(&mut self) -> Result<(), ModelError> {
        let finished = self.sink.finish();
        finished.map_err(|error| ModelError::refused("snapshots", error))
    }
}
