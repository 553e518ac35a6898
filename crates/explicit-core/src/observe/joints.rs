//! What becomes of joints.

use powerhouse_model::{
    Cadence, ContactState, Fields, Flow, JointPair, JointRecord, ModelError, Observer, StepView,
};

use super::{Column, HistoryTable, ObserveError, Recording, check_cadence};

/// One joint at the last time that was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTable {
    /// The joint's name.
    pub name: String,
    /// The name of its law.
    pub law: String,
    /// Its pairs.
    pub pairs: Vec<JointPair>,
    /// What has become of them; slip, peaks, energies and first times are those of the whole run.
    pub records: Vec<JointRecord>,
    /// The most sweeps that connected pairs took in a step.
    pub most_sweeps: u32,
    /// The largest relative change of an impulse that their solution left.
    pub worst_residual: f64,
}

/// All joints of a body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointTables {
    /// The last time that was seen (s).
    pub time: f64,
    /// The joints then.
    pub joints: Vec<JointTable>,
    /// For each joint NAME against time: `NAME.sliding` and `NAME.open`, shares of its area;
    /// `NAME.slip` and `NAME.opening`, the largest of any pair so far (m); `NAME.friction`,
    /// `NAME.bond` and `NAME.impact`, what it took from the motion so far (J).
    pub history: HistoryTable,
}

/// Columns of a joint, with their units.
const COLUMNS: [(&str, &str); 7] = [
    ("sliding", "1"),
    ("open", "1"),
    ("slip", "m"),
    ("opening", "m"),
    ("friction", "J"),
    ("bond", "J"),
    ("impact", "J"),
];

impl JointTable {
    /// The values of its columns in [`JointTables::history`].
    fn row(&self) -> [f64; 7] {
        let area: f64 = self.pairs.iter().map(|pair| pair.area).sum();
        let mut row = [0.0; 7];
        for (pair, record) in self.pairs.iter().zip(&self.records) {
            match record.state.contact {
                ContactState::Slide => row[0] += pair.area / area,
                ContactState::Open => row[1] += pair.area / area,
                ContactState::Stick => {}
            }
            row[2] = record.state.slip.max(row[2]);
            row[3] = record.peak_opening.max(row[3]);
            row[4] += record.friction;
            row[5] += record.bond_energy;
            row[6] += record.impact;
        }
        row
    }
}

/// Keeps the joints' shares of area, greatest slips and openings and energies against time, and
/// every pair as it was at the last time seen.
///
/// Memory: 56 bytes per joint and row, some 300 per pair.
pub struct JointHistories {
    cadence: Cadence,
    recording: Recording<JointTables>,
}

impl JointHistories {
    /// Histories of all joints.
    ///
    /// # Errors
    /// A cadence out of range.
    pub fn new(cadence: Cadence) -> Result<Self, ObserveError> {
        check_cadence(cadence)?;
        Ok(Self {
            cadence,
            recording: Recording::default(),
        })
    }
    /// What it fills.
    pub fn recording(&self) -> Recording<JointTables> {
        self.recording.clone()
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
        let joints: Vec<JointTable> = view
            .joints()
            .into_iter()
            .map(|joint| JointTable {
                name: joint.name.into(),
                law: joint.law.into(),
                pairs: joint.pairs.to_vec(),
                records: joint.records.to_vec(),
                most_sweeps: joint.most_sweeps,
                worst_residual: joint.worst_residual,
            })
            .collect();
        let mut tables = self.recording.lock();
        if tables.history.columns.is_empty() {
            for joint in &joints {
                for (quantity, unit) in COLUMNS {
                    tables.history.columns.push(Column {
                        name: format!("{}.{quantity}", joint.name),
                        unit,
                        values: Vec::new(),
                    });
                }
            }
        }
        let row = joints.iter().flat_map(JointTable::row);
        for (column, value) in tables.history.columns.iter_mut().zip(row) {
            column.values.push(value);
        }
        tables.history.times.push(view.time());
        (tables.time, tables.joints) = (view.time(), joints);
        Ok(Flow::Continue)
    }
}
