//! What becomes of joints.

use powerhouse_model::{
    Bond, Cadence, ContactState, Fields, Flow, JointPair, JointRecord, JointView, ModelError,
    Observer, StepView,
};

use super::envelope::PeakField;
use super::{HistoryTable, ObserveError, Recording, check_cadence};

/// One joint at the last time that was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTable {
    /// The joint's name.
    pub name: String,
    /// The name of its law.
    pub law: String,
    /// Its pairs.
    pub pairs: Vec<JointPair>,
    /// Contact states and peak values; slip, peaks, energies and first times are those of the whole run.
    pub records: Vec<JointRecord>,
    /// The greatest tractions that were seen.
    pub tractions: TractionPeaks,
    /// The most sweeps that connected pairs took in a step.
    pub most_sweeps: u32,
    /// The largest relative change of motion that their solution left.
    pub worst_residual: f64,
}

/// Extreme tractions of each pair (Pa) and their times, at the steps that were seen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TractionPeaks {
    /// Greatest normal traction, tension positive.
    pub greatest_normal: PeakField,
    /// Least normal traction: the greatest pressure, where negative.
    pub least_normal: PeakField,
    /// Greatest shear traction.
    pub greatest_shear: PeakField,
}

/// Which columns a [`JointWatch`] has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JointQuantities {
    /// Shares of the area that slide, are open, and whose bond has broken: `sliding`, `open`,
    /// `broken`.
    pub state: bool,
    /// The largest accumulated slip of any pair (m): `slip`.
    pub slip: bool,
    /// The largest opening of any pair at the time (m), negative where all overlap: `opening`.
    pub opening: bool,
    /// The largest opening of any pair so far (m): `peak_opening`.
    pub peak_opening: bool,
    /// Means over the area of normal traction, tension positive, and of the size of shear traction
    /// (Pa): `normal`, `shear`.
    pub traction: bool,
    /// Dissipated by friction so far (J): `friction`.
    pub friction: bool,
    /// Dissipated where bonds broke (J): `bond`.
    pub bond: bool,
    /// Lost where sides met (J): `impact`.
    pub impact: bool,
}

impl JointQuantities {
    /// All of them.
    pub const ALL: Self = Self {
        state: true,
        slip: true,
        opening: true,
        peak_opening: true,
        traction: true,
        friction: true,
        bond: true,
        impact: true,
    };

    /// Names and units of the columns.
    fn columns(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let wanted = self.wanted();
        COLUMNS
            .into_iter()
            .zip(wanted)
            .filter_map(|(column, wanted)| wanted.then_some(column))
    }
    /// Whether each of [`COLUMNS`] is wanted.
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

/// All columns, with their units.
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

/// Pairs of a joint that are watched together.
#[derive(Clone, Debug, PartialEq)]
pub struct JointWatch {
    /// The name in results.
    pub name: String,
    /// The joint's name.
    pub joint: String,
    /// Places of the pairs among the joint's.
    pub pairs: Vec<usize>,
    /// What is recorded of them.
    pub quantities: JointQuantities,
}

/// Final contact state and peak values of observed node pairs.
#[derive(Clone, Debug, PartialEq)]
pub struct JointOutcome {
    /// The name in results.
    pub name: String,
    /// The joint's name.
    pub joint: String,
    /// How many pairs they are.
    pub pairs: usize,
    /// Their area (m2).
    pub area: f64,
    /// When the first of them slid (s), and which, by its place among the joint's pairs.
    pub first_slip: Option<(f64, usize)>,
    /// When the first of them opened (s), and which.
    pub first_crack: Option<(f64, usize)>,
    /// Share of the area that ever slid.
    pub slipped: f64,
    /// Share of the area that ever opened.
    pub opened: f64,
    /// Share of the area that never had a bond.
    pub never_bonded: f64,
    /// Share of the area whose bond has broken.
    pub broken: f64,
    /// The largest accumulated slip (m), and the first of the pairs that have it.
    pub slip: (f64, usize),
    /// The largest opening (m), and the first of the pairs that had it.
    pub peak_opening: (f64, usize),
    /// Dissipated by friction (J).
    pub friction: f64,
    /// Dissipated where bonds broke (J).
    pub bond: f64,
    /// Lost where sides met (J).
    pub impact: f64,
}

/// All joints of a body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointTables {
    /// The last time that was seen (s).
    pub time: f64,
    /// The joints then.
    pub joints: Vec<JointTable>,
    /// Final contact state and peak values of what was observed.
    pub outcomes: Vec<JointOutcome>,
    /// The columns of every [`JointWatch`], named `NAME.slip` and so on.
    pub history: HistoryTable,
}

/// Keeps what becomes of joints: columns of the pairs that are watched against time, and every pair
/// of every joint as it was at the last time seen, with its greatest tractions.
///
/// Memory: 8 bytes per column and row, some 350 per pair.
///
/// ```
/// use powerhouse_explicit_core::observe::{JointHistories, JointQuantities, JointWatch};
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
/// # Ok::<(), powerhouse_explicit_core::observe::ObserveError>(())
/// ```
pub struct JointHistories {
    cadence: Cadence,
    watches: Vec<JointWatch>,
    recording: Recording<JointTables>,
}

impl JointHistories {
    /// Histories of some pairs.
    ///
    /// # Errors
    /// A cadence out of range, a name that stands twice.
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
    /// What it fills.
    pub fn recording(&self) -> Recording<JointTables> {
        self.recording.clone()
    }
}

impl JointWatch {
    /// Its pairs in the joints of a body.
    fn look<'v>(
        &'v self,
        joints: &'v [JointView<'v>],
    ) -> Result<impl Iterator<Item = (&'v JointPair, &'v JointRecord)> + Clone, ObserveError> {
        let joint = joints.iter().find(|joint| joint.name == self.joint);
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

    /// The values of its columns, and what has become of its pairs.
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
        let placed = || self.pairs.iter().copied().zip(pairs.clone());
        let first = |time: &dyn Fn(&JointRecord) -> Option<f64>| -> Option<(f64, usize)> {
            let times = placed().filter_map(|(place, (_, record))| Some((time(record)?, place)));
            times.reduce(|least, next| if next.0 < least.0 { next } else { least })
        };
        let most = |value: &dyn Fn(&JointRecord) -> f64| -> (f64, usize) {
            let none = (f64::NEG_INFINITY, 0);
            let values = placed().map(|(place, (_, record))| (value(record), place));
            values.fold(none, |most, next| if next.0 > most.0 { next } else { most })
        };
        let (slip, peak_opening) = (most(&|r| r.state.slip), most(&|r| r.peak_opening));
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
        Ok((row.collect(), outcome))
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
    fn cadence(&self) -> Cadence {
        self.cadence
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
                tractions,
                most_sweeps: joint.most_sweeps,
                worst_residual: joint.worst_residual,
            });
        }
        tables.history.push(time, &row);
        (tables.time, tables.outcomes) = (time, outcomes);
        Ok(Flow::Continue)
    }
}
