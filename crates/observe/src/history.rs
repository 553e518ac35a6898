//! Histories of motion, stress and history variables.

use std::sync::Arc;

use powerhouse_model::{
    Cadence, Fields, Flow, HistoryVariable, Mesh, ModelError, Observer, Reach, Selection,
    StateError, StepView, Stress, Vec3,
};

use super::place::{ActiveElements, Probe, elements, probes};
use super::sampler::{Sampled, reach_of_both};
use super::{
    AccelerationRule, BandLimited, HistorySampler, HistoryTable, Motion, MotionPeaks,
    ObservationPoint, ObserveError, Place, Recording, StressPlace, check_cadence,
    principal_stresses, table_cadence,
};

/// Observer of histories: motion at locations, relative motion of two locations, and stress and history variables of
/// elements, against time.
///
/// Columns of a motion called `crown` are `crown.ux`, `crown.uy`, `crown.uz` (m), `crown.vx` ... (m/s)
/// and `crown.ax` ... (m/s2), which are means over the interval of the rows, or instants by
/// [request](HistoryBuilder::accelerations). A relative motion is that of the second location less that of the
/// first; with displacements comes `crown.apart` (m), its component along the line from the first
/// location to the second, positive for increasing distance. Columns of a stress called `lining` are
/// `lining.xx`, `.yy`, `.zz`, `.xy`, `.yz`, `.zx` and the principal stresses `lining.s1` >=
/// `lining.s2` >= `lining.s3` (Pa, mean over the element, initial stress included). Columns of a state
/// called `lining` are the history variables of the element's law, `lining.damage` and so on.
///
/// Memory: 8 bytes per column and row.
///
/// ```
/// use powerhouse_observe::{History, Motion, Place};
/// use powerhouse_model::{Cadence, Mesh, Observer, Vec3};
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(10.0), [5, 5, 5], "rock")?;
/// let (crown, floor) = (Vec3::new(5.0, 5.0, 8.3), Vec3::new(5.0, 5.0, 1.7));
/// let history = History::builder(Cadence::Seconds(0.01))
///     .motion("crown", crown, Motion::ALL)
///     .relative("closure", floor, crown, Motion::DISPLACEMENT)
///     .motion("corner", Place::Node(1), Motion::ACCELERATION)
///     .stress("roof", Vec3::new(5.0, 5.0, 9.0))
///     .build(&mesh)?;
/// let recording = history.recording();
/// assert!(history.fields().acceleration && history.fields().stress);
/// assert_eq!(recording.read(|table| table.columns.len()), 9 + 4 + 3 + 9);
/// # Ok::<(), powerhouse_observe::ObserveError>(())
/// ```
pub struct History {
    cadence: Cadence,
    probes: Vec<Probe>,
    /// Mesh indices and natural coordinates.
    elements: Vec<(u32, Vec3)>,
    channels: Vec<Channel>,
    /// Index of the first column of each channel.
    first_columns: Vec<usize>,
    /// Whether accelerations are means.
    has_means: bool,
    row: Vec<f64>,
    recording: Recording<HistoryTable>,
}

/// One output request; numbers are indices in the lists of probes and elements.
#[derive(Clone, Debug)]
pub(super) enum Channel {
    Motion {
        name: String,
        probe: usize,
        motion: Motion,
    },
    Relative {
        name: String,
        from: usize,
        to: usize,
        motion: Motion,
        /// Unit vector from the first location to the second, zero where they coincide.
        direction: Vec3,
    },
    Stress {
        name: String,
        element: usize,
        /// Whether it is that at the point, or the mean over the element.
        at_point: bool,
    },
    State {
        name: String,
        element: usize,
        variables: Vec<HistoryVariable>,
    },
    Sampled {
        name: String,
        sampler: Sampled,
    },
}

/// Builder of a [`History`]: its output requests and cadence.
#[derive(Clone, Debug)]
pub struct HistoryBuilder {
    cadence: Cadence,
    places: Vec<(String, Place)>,
    stress_places: Vec<(String, StressPlace)>,
    channels: Vec<Channel>,
    active: Option<Vec<bool>>,
    accelerations: AccelerationRule,
}

impl HistoryBuilder {
    /// Records the motion at a node, the mean of a set of nodes, or a point: columns `NAME.ux`, `NAME.vx` and so on.
    #[must_use]
    pub fn motion(mut self, name: &str, place: impl Into<Place>, motion: Motion) -> Self {
        self.channels.push(Channel::Motion {
            name: name.into(),
            probe: self.places.len(),
            motion,
        });
        self.places.push((name.into(), place.into()));
        self
    }
    /// Adds the motion of the location `to` relative to the location `from`.
    #[must_use]
    pub fn relative(
        mut self,
        name: &str,
        from: impl Into<Place>,
        to: impl Into<Place>,
        motion: Motion,
    ) -> Self {
        self.channels.push(Channel::Relative {
            name: name.into(),
            from: self.places.len(),
            to: self.places.len() + 1,
            motion,
            direction: Vec3::zeros(),
        });
        self.places.push((name.into(), from.into()));
        self.places.push((name.into(), to.into()));
        self
    }
    /// Records the mean stress of an element (Pa), by number or around a point: columns `NAME.xx` to `NAME.zx`, and
    /// the principal stresses `NAME.s1` to `NAME.s3`.
    #[must_use]
    pub fn stress(mut self, name: &str, place: impl Into<StressPlace>) -> Self {
        self.channels.push(Channel::Stress {
            name: name.into(),
            element: self.stress_places.len(),
            at_point: false,
        });
        self.stress_places.push((name.into(), place.into()));
        self
    }
    /// Records the stress at a point (Pa), such as the surface of a lining: that of its element, which in bricks that bend
    /// as their material is linear; columns as those of [`stress`](Self::stress).
    #[must_use]
    pub fn stress_at(mut self, name: &str, point: impl Into<ObservationPoint>) -> Self {
        self.channels.push(Channel::Stress {
            name: name.into(),
            element: self.stress_places.len(),
            at_point: true,
        });
        self.stress_places
            .push((name.into(), StressPlace::Point(point.into())));
        self
    }
    /// Adds the history variables (internal state variables) of an element's law.
    #[must_use]
    pub fn state(mut self, name: &str, place: impl Into<StressPlace>) -> Self {
        self.channels.push(Channel::State {
            name: name.into(),
            element: self.stress_places.len(),
            variables: Vec::new(),
        });
        self.stress_places.push((name.into(), place.into()));
        self
    }
    /// Records quantities of a program's own: columns `NAME.` with the names of the [sampler](HistorySampler).
    #[must_use]
    pub fn sampled(mut self, name: &str, sampler: Arc<dyn HistorySampler>) -> Self {
        self.channels.push(Channel::Sampled {
            name: name.into(),
            sampler: Sampled(sampler),
        });
        self
    }
    /// Sets the rule of the accelerations at rows of an interval in seconds. Rows at a cadence in steps have the accelerations of
    /// their steps.
    #[must_use]
    pub fn accelerations(mut self, rule: AccelerationRule) -> Self {
        self.accelerations = rule;
        self
    }
    /// Sets the active elements of the mesh, one flag per element: points are located among them alone, and
    /// locations without active elements are refused.
    #[must_use]
    pub fn among(mut self, active: &[bool]) -> Self {
        self.active = Some(active.to_vec());
        self
    }
    /// Locates all points in the mesh and builds the observer, without history variables of laws.
    ///
    /// # Errors
    /// As [`build_with`](Self::build_with).
    pub fn build(self, mesh: &Mesh) -> Result<History, ObserveError> {
        self.build_with(mesh, |_| Vec::new())
    }
    /// Locates all points in the mesh and builds the observer; `variables_of` returns the history variables of the law of
    /// an element (mesh index).
    ///
    /// # Errors
    /// A location or set that does not exist or has no active elements, a duplicate name, a cadence or tolerance out of
    /// range.
    pub fn build_with(
        mut self,
        mesh: &Mesh,
        variables_of: impl Fn(u32) -> Vec<HistoryVariable>,
    ) -> Result<History, ObserveError> {
        check_cadence(self.cadence)?;
        let active = ActiveElements(self.active.as_deref());
        let probes = probes(mesh, &self.places, active)?;
        let elements = elements(mesh, &self.stress_places, active)?;
        let mut table = HistoryTable::default();
        let mut first_columns = Vec::with_capacity(self.channels.len());
        for channel in &mut self.channels {
            if let Channel::Relative {
                from,
                to,
                direction,
                ..
            } = channel
            {
                let at = |probe: usize| probes[probe].value(|n| mesh.positions()[n as usize]);
                let line = at(*to) - at(*from);
                *direction = line.try_normalize(0.0).unwrap_or_default();
            }
            if let Channel::State {
                element, variables, ..
            } = channel
            {
                *variables = variables_of(elements[*element].0);
            }
            first_columns.push(table.columns.len());
            for (name, unit) in channel.columns() {
                table.add_column(name, unit)?;
            }
            if channel.motion().acceleration && self.accelerations == AccelerationRule::Mean {
                table.take_means(first_columns[first_columns.len() - 1]);
            }
            if let Channel::State {
                name, variables, ..
            } = channel
            {
                for variable in variables {
                    table.add_variable(format!("{name}.{}", variable.name), variable)?;
                }
            }
        }
        Ok(History {
            cadence: self.cadence,
            probes,
            elements,
            channels: self.channels,
            first_columns,
            has_means: table.has_means(),
            row: Vec::with_capacity(table.columns.len()),
            recording: Recording::new(table),
        })
    }
}

impl Channel {
    /// Names and units of the columns that do not depend on a law.
    pub(super) fn columns(&self) -> Vec<(String, &'static str)> {
        let vectors = |name: &str, motion: &Motion| {
            let kinds = [
                (motion.displacement, 'u', "m"),
                (motion.velocity, 'v', "m/s"),
                (motion.acceleration, 'a', "m/s2"),
            ];
            let wanted = kinds.into_iter().filter(|kind| kind.0);
            wanted
                .flat_map(|(_, letter, unit)| {
                    ["x", "y", "z"].map(|axis| (format!("{name}.{letter}{axis}"), unit))
                })
                .collect::<Vec<_>>()
        };
        match self {
            Self::Motion { name, motion, .. } => vectors(name, motion),
            Self::Relative { name, motion, .. } => {
                let mut columns = vectors(name, motion);
                if motion.displacement {
                    columns.push((format!("{name}.apart"), "m"));
                }
                columns
            }
            Self::Stress { name, .. } => ["xx", "yy", "zz", "xy", "yz", "zx", "s1", "s2", "s3"]
                .map(|component| (format!("{name}.{component}"), "Pa"))
                .into(),
            // Those of its variables depend on the law.
            Self::State { .. } => Vec::new(),
            Self::Sampled { name, sampler } => (sampler.0.columns().into_iter())
                .map(|(column, unit)| (format!("{name}.{column}"), unit))
                .collect(),
        }
    }

    /// Value of a nodal field at the place of a motion, of a relative motion the difference; zero for other quantities.
    pub(super) fn value(&self, probes: &[Probe], field: &dyn Fn(u32) -> Vec3) -> Vec3 {
        match self {
            Self::Motion { probe, .. } => probes[*probe].value(field),
            Self::Relative { from, to, .. } => {
                probes[*to].value(field) - probes[*from].value(field)
            }
            Self::Stress { .. } | Self::State { .. } | Self::Sampled { .. } => Vec3::zeros(),
        }
    }

    /// Appends the values of a motion in a step to a row; nothing for other quantities.
    pub(super) fn push_motion(&self, probes: &[Probe], view: &dyn StepView, row: &mut Vec<f64>) {
        let motion = self.motion();
        let mut push = |field: &dyn Fn(u32) -> Vec3| {
            row.extend_from_slice(self.value(probes, field).as_slice());
        };
        if motion.displacement {
            push(&|node| view.displacement(node));
        }
        if motion.velocity {
            push(&|node| view.velocity(node));
        }
        if motion.acceleration {
            push(&|node| view.acceleration(node));
        }
        if let (true, Self::Relative { direction, .. }) = (motion.displacement, self) {
            let displacement = self.value(probes, &|node| view.displacement(node));
            row.push(displacement.dot(direction));
        }
    }

    fn sampler(&self) -> Option<&dyn HistorySampler> {
        match self {
            Self::Sampled { sampler, .. } => Some(sampler.0.as_ref()),
            _ => None,
        }
    }

    pub(super) fn motion(&self) -> Motion {
        match self {
            Self::Motion { motion, .. } | Self::Relative { motion, .. } => *motion,
            Self::Stress { .. } | Self::State { .. } | Self::Sampled { .. } => Motion::default(),
        }
    }
}

impl History {
    /// A builder without output requests.
    pub fn builder(cadence: Cadence) -> HistoryBuilder {
        HistoryBuilder {
            cadence,
            places: Vec::new(),
            stress_places: Vec::new(),
            channels: Vec::new(),
            active: None,
            accelerations: AccelerationRule::default(),
        }
    }
    /// Whether there are no output requests.
    pub fn is_empty(&self) -> bool {
        self.channels.is_empty()
    }
    /// Shared access to the table.
    pub fn recording(&self) -> Recording<HistoryTable> {
        self.recording.clone()
    }
    /// An observer that raises the [peaks](super::Column::peak) of the motions of the table in every step, also between
    /// rows; none without motions.
    pub fn motion_peaks(&self) -> Option<MotionPeaks> {
        let channels = self.channels.iter().zip(&self.first_columns);
        let motions = channels.filter(|(channel, _)| channel.motion() != Motion::default());
        let motions: Vec<(Channel, usize)> = motions
            .map(|(channel, &first)| (channel.clone(), first))
            .collect();
        let peaks = MotionPeaks::new(motions, self.probes.clone(), self.recording());
        (!peaks.is_empty()).then_some(peaks)
    }
    /// An observer of the accelerations of the table up to a frequency (Hz), at short even intervals; none without
    /// accelerations.
    ///
    /// # Errors
    /// A frequency that is not above 0.
    pub fn band_limited(&self, band: f64) -> Result<Option<BandLimited>, ObserveError> {
        let motions = self.channels.iter().filter(|c| c.motion().acceleration);
        let motions: Vec<Channel> = motions.cloned().collect();
        BandLimited::new(band, motions, self.probes.clone())
    }
}

impl Observer for History {
    fn name(&self) -> &str {
        "history"
    }
    fn fields(&self) -> Fields {
        let channels = || self.channels.iter();
        let sampled = |reads: fn(&Fields) -> bool| {
            let mut samplers = channels().filter_map(Channel::sampler);
            samplers.any(|sampler| reads(&sampler.fields()))
        };
        let acceleration = channels().any(|c| c.motion().acceleration);
        let stress = channels().any(|c| matches!(c, Channel::Stress { .. }));
        Fields::default()
            .with_acceleration(acceleration || sampled(|fields| fields.acceleration))
            .with_stress(stress || sampled(|fields| fields.stress))
            .with_energy(sampled(|fields| fields.energy))
    }
    fn reach(&self) -> Reach {
        let nodes = self.probes.iter().flat_map(Probe::nodes);
        let variables = self.channels.iter().flat_map(|channel| match channel {
            Channel::State { variables, .. } => variables.as_slice(),
            _ => &[],
        });
        let own = Reach::NONE
            .with_nodes(Selection::These(nodes.collect()))
            .with_elements(Selection::These(
                self.elements.iter().map(|(e, _)| *e).collect(),
            ))
            .with_variables(variables.map(|variable| variable.name));
        let samplers = self.channels.iter().filter_map(Channel::sampler);
        samplers.fold(own, |all, sampler| reach_of_both(all, sampler.reach()))
    }
    fn cadence(&self) -> Cadence {
        match self.cadence {
            Cadence::Seconds(interval) if self.has_means => Cadence::Around(0.5 * interval),
            cadence => table_cadence(cadence),
        }
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        self.recording.save()
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        self.recording.restore(saved, |found, here| {
            StateError::expect_same("the list of columns", found.names(), here.names())
        })
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        self.row.clear();
        for channel in &self.channels {
            match channel {
                Channel::Motion { .. } | Channel::Relative { .. } => {
                    channel.push_motion(&self.probes, view, &mut self.row);
                }
                Channel::Stress {
                    name,
                    element,
                    at_point,
                } => {
                    let (element, natural) = &self.elements[*element];
                    let stress: Stress = if *at_point {
                        view.stress_at(*element, natural)
                            .ok_or_else(|| ObserveError::NoStressAtPoint { name: name.clone() })?
                    } else {
                        view.stress(*element)
                    };
                    self.row.extend_from_slice(&stress.0);
                    self.row.extend_from_slice(&principal_stresses(&stress));
                }
                Channel::State {
                    element, variables, ..
                } => {
                    let (element, _) = self.elements[*element];
                    let values = variables.iter().map(|v| view.history(element, v.name));
                    self.row.extend(values.map(|value| value.unwrap_or(0.0)));
                }
                Channel::Sampled { name, sampler } => {
                    let before = self.row.len();
                    sampler.0.sample(view, &mut self.row)?;
                    let (found, expected) = (self.row.len() - before, sampler.0.columns().len());
                    if found != expected {
                        let name = name.clone();
                        let error = ObserveError::SampledColumns {
                            name,
                            found,
                            expected,
                        };
                        return Err(error.into());
                    }
                }
            }
        }
        let mut table = self.recording.lock();
        if self.has_means {
            let moving = self.channels.iter().filter(|c| c.motion().acceleration);
            for channel in moving {
                let velocity = channel.value(&self.probes, &|node| view.velocity(node));
                self.row.extend_from_slice(velocity.as_slice());
            }
        }
        table.see(self.cadence, view, &self.row);
        Ok(Flow::Continue)
    }
    fn finish(&mut self) -> Result<(), ModelError> {
        self.recording.lock().end_means();
        Ok(())
    }
}
