//! Observer of joints: histories, pair tables and outcomes.

use powerhouse_model::{
    Bond, Cadence, ContactState, Fields, Flow, HistoryKind, HistoryVariable, JointPair,
    JointRecord, JointView, ModelError, Observer, Reach, StateError, StepView,
};
use serde::{Deserialize, Serialize};

use super::envelope::PeakField;
use super::{HistoryTable, ObserveError, Recording, check_cadence, table_cadence};

/// Node pairs of a joint with their state at the last observed time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct JointTable {
    /// Name of the joint.
    pub name: String,
    /// Name of its contact law, such as `bonded-coulomb`.
    pub law: String,
    /// Nodes, local axes and areas of the pairs, in the order of the joint.
    pub pairs: Vec<JointPair>,
    /// Contact states, peak values and energies, which count every step since the joint's last re-initialisation, not the
    /// observed steps alone; what earlier stages left is included.
    pub records: Vec<JointRecord>,
    /// Names, units and kinds of the history variables of the law; empty for a law without any.
    pub variables: Vec<HistoryVariable>,
    /// Values of the history variables, those of a pair side by side.
    pub history: Vec<f64>,
    /// Extreme tractions at the observed steps.
    pub tractions: TractionPeaks,
    /// Greatest number of sweeps that a group of connected pairs took in a step, of all joints with which it is
    /// computed; zero where one pass sufficed.
    pub most_sweeps: u32,
    /// Largest relative change of motion in the last sweep over a group of connected pairs, of all steps and of all
    /// joints with which it is computed (1).
    pub worst_residual: f64,
}

/// Extreme tractions of each pair (Pa) and their times, at the observed steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TractionPeaks {
    /// Greatest normal traction (Pa), tension positive.
    pub greatest_normal: PeakField,
    /// Least normal traction (Pa): the greatest pressure, where negative.
    pub least_normal: PeakField,
    /// Greatest magnitude of the shear traction (Pa).
    pub greatest_shear: PeakField,
}

/// Selection of the quantities that a [`JointWatch`] records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JointQuantities {
    /// Shares of the area that slide, are open, and whose bond has broken: `sliding`, `open`,
    /// `broken`.
    pub state: bool,
    /// Largest accumulated slip of any pair (m): `slip`.
    pub slip: bool,
    /// Largest opening of any pair at the time (m), negative where all overlap: `opening`.
    pub opening: bool,
    /// Largest opening of any pair so far (m): `peak_opening`.
    pub peak_opening: bool,
    /// Means over the area of normal traction, tension positive, and of the size of shear traction
    /// (Pa): `normal`, `shear`.
    pub traction: bool,
    /// Energy dissipated by friction so far (J): `friction`.
    pub friction: bool,
    /// Energy dissipated by breaking bonds (J): `bond`.
    pub bond: bool,
    /// Kinetic energy lost by impact of the sides (J): `impact`.
    pub impact: bool,
    /// History variables of the law, by their names: means over the area, of flags all that a pair has.
    pub history: bool,
}

impl JointQuantities {
    /// All quantities.
    pub const ALL: Self = Self {
        state: true,
        slip: true,
        opening: true,
        peak_opening: true,
        traction: true,
        friction: true,
        bond: true,
        impact: true,
        history: true,
    };

    /// Names and units of the columns, but for those of history variables.
    fn columns(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let wanted = self.wanted();
        COLUMNS
            .into_iter()
            .zip(wanted)
            .filter_map(|(column, wanted)| wanted.then_some(column))
    }
    /// Whether each of [`COLUMNS`] is recorded.
    fn wanted(&self) -> [bool; 11] {
        [
            self.state,
            self.state,
            self.state,
            self.slip,
            self.opening,
            self.peak_opening,
            self.traction,
            self.traction,
            self.friction,
            self.bond,
            self.impact,
        ]
    }
}

/// Names and units of all columns but those of history variables.
const COLUMNS: [(&str, &str); 11] = [
    ("sliding", "1"),
    ("open", "1"),
    ("broken", "1"),
    ("slip", "m"),
    ("opening", "m"),
    ("peak_opening", "m"),
    ("normal", "Pa"),
    ("shear", "Pa"),
    ("friction", "J"),
    ("bond", "J"),
    ("impact", "J"),
];

/// Request for histories and the outcome of some pairs of a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointWatch {
    /// Name of the request, under which its columns and its outcome are found in results.
    pub name: String,
    /// Name of the joint that the pairs are of.
    pub joint: String,
    /// Indices of the pairs among those of the joint.
    pub pairs: Vec<usize>,
    /// Quantities that are recorded of the pairs against time.
    pub quantities: JointQuantities,
}

/// Final contact state and peak values of observed node pairs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointOutcome {
    /// Name of the request, under which its columns and its outcome are found in results.
    pub name: String,
    /// Name of the joint that the pairs are of.
    pub joint: String,
    /// Number of observed node pairs.
    pub pairs: usize,
    /// Sum of the tributary areas of the observed pairs (m2), to which the shares refer.
    pub area: f64,
    /// Time of the first slip of any pair (s), and the index of that pair among those of the joint; `None` if none has
    /// slipped.
    pub first_slip: Option<(f64, usize)>,
    /// Time at which any pair was first open (s), and the index of that pair; pairs with an initial gap count.
    pub first_crack: Option<(f64, usize)>,
    /// Share of the area that ever slid (1).
    pub slipped: f64,
    /// Share of the area that was ever open (1).
    pub opened: f64,
    /// Share of the area that never had a bond (1).
    pub never_bonded: f64,
    /// Share of the area whose bond has broken (1).
    pub broken: f64,
    /// Largest accumulated slip (m), and the index of the first pair that has it.
    pub slip: (f64, usize),
    /// Largest opening so far (m), and the index of the first pair that had it.
    pub peak_opening: (f64, usize),
    /// Energy dissipated by friction so far (J), the sum over the pairs.
    pub friction: f64,
    /// Energy dissipated by breaking bonds so far (J), the sum over the pairs.
    pub bond: f64,
    /// Kinetic energy lost by impact of the sides so far (J), the sum over the pairs.
    pub impact: f64,
}

/// Results of all joints of a body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointTables {
    /// Time of the last observed step (s), at which the states of `joints` are given.
    pub time: f64,
    /// States of the node pairs of each joint at that time.
    pub joints: Vec<JointTable>,
    /// Final contact state and peak values of every [`JointWatch`].
    pub outcomes: Vec<JointOutcome>,
    /// Columns of every [`JointWatch`], named `NAME.slip` and so on.
    pub history: HistoryTable,
}

/// Observer of joints: histories of selected pairs, and the state of every pair of every joint at the last
/// observed time, with its extreme tractions.
///
/// Memory: 8 bytes per column and row, some 400 per pair.
///
/// ```
/// use powerhouse_observe::{JointHistories, JointQuantities, JointWatch};
/// use powerhouse_model::Cadence;
/// let crown = JointWatch {
///     name: "crown".into(),
///     joint: "lining".into(),
///     pairs: vec![12, 13],
///     quantities: JointQuantities { slip: true, opening: true, ..Default::default() },
/// };
/// let histories = JointHistories::new(Cadence::Seconds(0.01), vec![crown])?;
/// let recording = histories.recording();
/// assert_eq!(recording.read(|tables| tables.history.columns.len()), 2);
/// # Ok::<(), powerhouse_observe::ObserveError>(())
/// ```
pub struct JointHistories {
    cadence: Cadence,
    watches: Vec<JointWatch>,
    recording: Recording<JointTables>,
}

impl JointHistories {
    /// Observer with requests for some pairs.
    ///
    /// # Errors
    /// A cadence out of range, a name that occurs twice.
    pub fn new(cadence: Cadence, watches: Vec<JointWatch>) -> Result<Self, ObserveError> {
        check_cadence(cadence)?;
        let mut tables = JointTables::default();
        for watch in &watches {
            for (quantity, unit) in watch.quantities.columns() {
                let name = format!("{}.{quantity}", watch.name);
                tables.history.add_column(name, unit)?;
            }
        }
        Ok(Self {
            cadence,
            watches,
            recording: Recording::new(tables),
        })
    }
    /// Results, which are complete after the run.
    pub fn recording(&self) -> Recording<JointTables> {
        self.recording.clone()
    }
    /// Inserts the columns of history variables after the other columns of their request.
    fn add_history_columns(
        &self,
        joints: &[JointView],
        table: &mut HistoryTable,
    ) -> Result<(), ObserveError> {
        let others = core::mem::take(&mut table.columns);
        let mut others = others.into_iter();
        for watch in &self.watches {
            let own = watch.quantities.columns().count();
            table.columns.extend(others.by_ref().take(own));
            for variable in watch.variables(joints) {
                let name = format!("{}.{}", watch.name, variable.name);
                table.add_variable(name, variable)?;
            }
        }
        Ok(())
    }
}

impl JointWatch {
    /// Its joint among those of a body.
    fn joint<'v>(&self, joints: &'v [JointView<'v>]) -> Option<&'v JointView<'v>> {
        joints.iter().find(|joint| joint.name == self.joint)
    }

    /// Its pairs in the joints of a body.
    fn look<'v>(
        &'v self,
        joints: &'v [JointView<'v>],
    ) -> Result<impl Iterator<Item = (&'v JointPair, &'v JointRecord)> + Clone, ObserveError> {
        let joint = self.joint(joints);
        let last = self.pairs.iter().max();
        match joint {
            Some(joint) if last.is_none_or(|&last| last < joint.pairs.len()) => {
                let at = |&pair: &usize| (&joint.pairs[pair], &joint.records[pair]);
                Ok(self.pairs.iter().map(at))
            }
            _ => Err(ObserveError::NoSuchPairs {
                name: self.name.clone(),
                joint: self.joint.clone(),
                pair: last.copied().unwrap_or(0),
            }),
        }
    }

    /// History variables that it records.
    fn variables<'v>(&self, joints: &'v [JointView<'v>]) -> &'v [HistoryVariable] {
        let joint = self.joint(joints).filter(|_| self.quantities.history);
        joint.map_or(&[][..], |joint| joint.variables)
    }

    /// Value of a history variable, by its index: the mean over the area; of flags, all that a pair has.
    fn history_value(&self, joint: &JointView, variable: usize) -> f64 {
        let count = joint.variables.len();
        let value = |&pair: &usize| joint.history[pair * count + variable];
        if joint.variables[variable].kind == HistoryKind::Flags {
            let flags = self.pairs.iter().map(value);
            return f64::from(flags.fold(0_u32, |all, flags| all | flags as u32));
        }
        let area = |pair: &usize| joint.pairs[*pair].area;
        let sum: f64 = self.pairs.iter().map(|pair| area(pair) * value(pair)).sum();
        sum / self.pairs.iter().map(area).sum::<f64>()
    }

    /// Values of its columns, and outcome of its pairs.
    fn row(&self, joints: &[JointView]) -> Result<(Vec<f64>, JointOutcome), ObserveError> {
        let pairs = self.look(joints)?;
        let area: f64 = pairs.clone().map(|(pair, _)| pair.area).sum();
        let share = |is: &dyn Fn(&JointRecord) -> bool| -> f64 {
            let of = pairs.clone().filter(|(_, record)| is(record));
            // From zero: a sum of nothing is -0.
            of.fold(0.0, |sum, (pair, _)| sum + pair.area) / area
        };
        let mean = |value: &dyn Fn(&JointRecord) -> f64| -> f64 {
            let values = pairs
                .clone()
                .map(|(pair, record)| pair.area * value(record));
            values.sum::<f64>() / area
        };
        let sum = |value: &dyn Fn(&JointRecord) -> f64| -> f64 {
            pairs.clone().map(|(_, record)| value(record)).sum()
        };
        let indexed = || self.pairs.iter().copied().zip(pairs.clone());
        let first = |time: &dyn Fn(&JointRecord) -> Option<f64>| -> Option<(f64, usize)> {
            let times = indexed().filter_map(|(index, (_, record))| Some((time(record)?, index)));
            times.reduce(|least, next| if next.0 < least.0 { next } else { least })
        };
        let most = |value: &dyn Fn(&JointRecord) -> f64| -> (f64, usize) {
            let none = (f64::NEG_INFINITY, 0);
            let values = indexed().map(|(index, (_, record))| (value(record), index));
            values.fold(none, |most, next| if next.0 > most.0 { next } else { most })
        };
        let (slip, peak_opening) = (most(&JointRecord::slip), most(&|r| r.peak_opening));
        let friction = sum(&|r| r.friction);
        let bond = sum(&|r| r.bond_energy);
        let impact = sum(&|r| r.impact);
        let values = [
            share(&|r| r.state.contact == ContactState::Slide),
            share(&|r| r.state.contact == ContactState::Open),
            share(&|r| r.state.bond == Bond::Broken),
            slip.0,
            most(&|r| r.opening).0,
            peak_opening.0,
            mean(&|r| r.traction.x),
            mean(&|r| r.traction.y.hypot(r.traction.z)),
            friction,
            bond,
            impact,
        ];
        let wanted = self.quantities.wanted().into_iter().zip(values);
        let row = wanted.filter_map(|(wanted, value)| wanted.then_some(value));
        let variables = 0..self.variables(joints).len();
        let joint = self.joint(joints).into_iter();
        let history = joint.flat_map(|j| variables.clone().map(move |v| self.history_value(j, v)));
        let row: Vec<f64> = row.chain(history).collect();
        let outcome = JointOutcome {
            name: self.name.clone(),
            joint: self.joint.clone(),
            pairs: self.pairs.len(),
            area,
            first_slip: first(&|r| r.first_slip),
            first_crack: first(&|r| r.first_crack),
            slipped: share(&|r| r.first_slip.is_some()),
            opened: share(&|r| r.first_crack.is_some()),
            never_bonded: share(&|r| r.state.bond == Bond::Never),
            broken: share(&|r| r.state.bond == Bond::Broken),
            slip,
            peak_opening,
            friction,
            bond,
            impact,
        };
        Ok((row, outcome))
    }
}

impl TractionPeaks {
    fn none(pairs: usize) -> Self {
        Self {
            greatest_normal: PeakField::new(pairs, f64::NEG_INFINITY),
            least_normal: PeakField::new(pairs, f64::INFINITY),
            greatest_shear: PeakField::new(pairs, f64::NEG_INFINITY),
        }
    }
    fn see(&mut self, records: &[JointRecord], time: f64) {
        for (pair, record) in records.iter().enumerate() {
            let shear = record.traction.y.hypot(record.traction.z);
            self.greatest_normal.raise(pair, record.traction.x, time);
            self.least_normal.lower(pair, record.traction.x, time);
            self.greatest_shear.raise(pair, shear, time);
        }
    }
}

impl Observer for JointHistories {
    fn name(&self) -> &str {
        "joints"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn reach(&self) -> Reach {
        Reach::NONE.with_joints()
    }
    fn cadence(&self) -> Cadence {
        table_cadence(self.cadence)
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        self.recording.save()
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        self.recording.restore(saved, |found, here| {
            // The columns of history variables follow in the first observed step.
            let names = found.history.names();
            let has = |name: &String| names.contains(name);
            let all = here.history.names().iter().all(has);
            StateError::expect_same("whether it has all columns", all, true)
        })
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let (joints, time) = (view.joints(), view.time());
        let (mut row, mut outcomes) = (Vec::new(), Vec::new());
        for watch in &self.watches {
            let (values, outcome) = watch.row(&joints)?;
            row.extend(values);
            outcomes.push(outcome);
        }
        let mut guard = self.recording.lock();
        let tables = &mut *guard;
        if tables.history.is_new() {
            // Laws are known from the first view on, and with them the columns of their variables.
            self.add_history_columns(&joints, &mut tables.history)?;
        }
        let mut seen = core::mem::take(&mut tables.joints).into_iter();
        for joint in joints {
            let before = seen.next().map(|table| table.tractions);
            let mut tractions = before.unwrap_or_else(|| TractionPeaks::none(joint.pairs.len()));
            tractions.see(joint.records, time);
            tables.joints.push(JointTable {
                name: joint.name.into(),
                law: joint.law.into(),
                pairs: joint.pairs.to_vec(),
                records: joint.records.to_vec(),
                variables: joint.variables.to_vec(),
                history: joint.history.to_vec(),
                tractions,
                most_sweeps: joint.most_sweeps,
                worst_residual: joint.worst_residual,
            });
        }
        tables.history.see(self.cadence, view, &row);
        (tables.time, tables.outcomes) = (time, outcomes);
        Ok(Flow::Continue)
    }
}
