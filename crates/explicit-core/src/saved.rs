//! State of a run between two steps: of the body, of every block, constraint, load and observer, and of the energy
//! balance.
//!
//! Each part encodes its own state, in one section. What follows from the model alone is not saved: it is computed
//! again to the same bits, but for the highest frequency, which costs some tens of force evaluations.

use std::collections::HashMap;

use powerhouse_model::{
    Constraint, HistoryField, HourglassShare, JointHistory, Observer, Precision, RunError,
    SavedRun, SavedSection, State, StateError, StaticError, decode, encode, interned,
};
use serde::{Deserialize, Deserializer, Serialize};

use crate::Model;
use crate::ledger::SavedLedger;
use crate::stable_step::Spectrum;

/// Section of the state of the run itself.
const RUN: &str = "run";
/// Section of the motion of the body.
const BODY: &str = "body";

/// Section of the motion of a slice whose sides are delayed against each other.
const SLICE: &str = "slice";
/// Section of the motion of a bay of an endless row.
const BAY: &str = "bay";

/// Readings of the energy ledger so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Readings {
    /// Last reading, by column (J).
    #[serde(deserialize_with = "columns")]
    pub(crate) energies: Columns,
    /// Largest residual.
    pub(crate) residual: f64,
    pub(crate) hourglass: Vec<HourglassShare>,
    /// Largest kinetic energy of the added inertia of fibres, and of their masses (J).
    pub(crate) fibres: [f64; 2],
}

/// Columns of the energy balance (name, J).
type Columns = Vec<(&'static str, f64)>;

fn columns<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Columns, D::Error> {
    let columns = Vec::<(String, f64)>::deserialize(deserializer)?;
    let named = columns.iter();
    Ok(named
        .map(|(name, energy)| (interned(name), *energy))
        .collect())
}

/// Saved state of the run itself, and properties of its model that must be the same.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RestoredRun {
    precision: u8,
    /// Fingerprint of the partition of the elements into blocks.
    partition: u64,
    /// Fingerprint of the fibres.
    fibres: u64,
    pub(crate) readings: Readings,
    spectrum: Option<Spectrum>,
    ledger: Option<SavedLedger>,
}

/// Kinds of the sections of blocks and constraints, with a state of their own or without, and of parts of constraints.
const BLOCK: &str = "block";
const HISTORY: &str = "history";
const CONSTRAINT: &str = "constraint";
const JOINTS: &str = "joints";
const PART: &str = "part";

/// Name of the section of a part.
fn name(kind: &str, index: usize, label: &str) -> String {
    format!("{kind} {index}: {label}")
}

/// Fault of the state of a part.
#[derive(Debug)]
pub(crate) struct PartFault {
    part: String,
    source: StateError,
}

impl From<PartFault> for RunError {
    fn from(PartFault { part, source }: PartFault) -> Self {
        Self::State { part, source }
    }
}

impl From<PartFault> for StaticError {
    fn from(PartFault { part, source }: PartFault) -> Self {
        Self::State { part, source }
    }
}

/// Restores what belongs to the parts of a constraint from the state of a constraint of some parts.
fn restore_parts(constraint: &mut dyn Constraint, saved: &[u8]) -> Result<(), StateError> {
    match constraint.restricted() {
        Some(restricted) => restricted.restore_parts(saved),
        None => Err(StateError::Unexpected),
    }
}

fn of_part(part: &str) -> impl FnOnce(StateError) -> PartFault {
    move |source| PartFault {
        part: part.into(),
        source,
    }
}

/// Adds a section with the state of a part.
pub(crate) fn add(
    saved: &mut SavedRun,
    name: String,
    bytes: Result<Vec<u8>, StateError>,
) -> Result<(), PartFault> {
    let bytes = bytes.map_err(of_part(&name))?;
    saved.sections.push(SavedSection { name, bytes });
    Ok(())
}

/// Sections of a saved run by name, without those that were taken.
pub(crate) struct Sections<'a>(HashMap<&'a str, &'a [u8]>);

impl<'a> Sections<'a> {
    pub(crate) fn of(saved: &'a SavedRun) -> Self {
        let sections = saved.sections.iter();
        Self(
            sections
                .map(|s| (s.name.as_str(), s.bytes.as_slice()))
                .collect(),
        )
    }
    fn take(&mut self, name: &str) -> Option<&'a [u8]> {
        self.0.remove(name)
    }
    fn take_starting(&mut self, start: &str) -> Option<&'a [u8]> {
        let mut names = self.0.keys().copied();
        let name = names.find(|name| name.starts_with(start))?;
        self.take(name)
    }
    fn expect(&mut self, name: &str) -> Result<&'a [u8], PartFault> {
        let found = self.take(name).ok_or(StateError::Missing);
        found.map_err(of_part(name))
    }
    pub(crate) fn decode<T: serde::de::DeserializeOwned>(
        &mut self,
        name: &str,
    ) -> Result<T, PartFault> {
        decode(self.expect(name)?).map_err(of_part(name))
    }
    /// The sections of the parts of a constraint that ranks have saved, in the order of the ranks.
    fn take_parts(&mut self, whole: &str) -> Vec<&'a [u8]> {
        let start = format!("{PART} ");
        let end = format!(" of {whole}");
        let rank = |name: &str| -> Option<usize> {
            let rank = name.strip_prefix(&start)?.strip_suffix(&end)?;
            rank.parse().ok()
        };
        let names = self.0.keys().copied();
        let mut parts: Vec<(usize, &str)> =
            names.filter_map(|name| Some((rank(name)?, name))).collect();
        parts.sort_unstable();
        let parts = parts.into_iter();
        parts.filter_map(|(_, name)| self.0.remove(name)).collect()
    }
    /// Accepts sections of observers alone, and with `parts` those of blocks and constraints of other ranks.
    fn expect_observers(self, parts: bool) -> Result<(), PartFault> {
        let mut names: Vec<&str> = self.0.into_keys().collect();
        names.retain(|name| !name.starts_with(OBSERVER));
        if parts {
            let of_parts = [BLOCK, HISTORY, CONSTRAINT, JOINTS, PART];
            names.retain(|name| !of_parts.iter().any(|kind| name.starts_with(kind)));
        }
        names.sort_unstable();
        match names.first() {
            None => Ok(()),
            Some(name) => Err(of_part(name)(StateError::Unexpected)),
        }
    }
}

/// Start of the names of sections of observers.
const OBSERVER: &str = "observer";

impl Model {
    pub(crate) fn precision_number(&self) -> u8 {
        match self.precision {
            Precision::F64 => 0,
            Precision::Mixed => 1,
            Precision::F32 => 2,
        }
    }

    /// State of a run after a number of steps with a length (s); on several ranks rank 0 has that of the whole body, and
    /// the others that of a part.
    pub(crate) fn save_run(
        &mut self,
        (done, step): (u64, f64),
        readings: &Readings,
        observers: &[Box<dyn Observer>],
    ) -> Result<SavedRun, RunError> {
        let body = self.body_state();
        let mut saved = SavedRun::new(done, self.time, step);
        let run = RestoredRun {
            precision: self.precision_number(),
            partition: self.partition().fingerprint(&self.mesh),
            fibres: self.groups.fibres.fingerprint(),
            readings: readings.clone(),
            spectrum: self.spectrum,
            ledger: (self.ledger.as_ref()).map(|ledger| ledger.saved(&self.ranks)),
        };
        add(&mut saved, RUN.into(), encode(&run))?;
        add(&mut saved, BODY.into(), encode(&body))?;
        drop(body);
        if let Some(slice) = &self.delayed {
            add(
                &mut saved,
                SLICE.into(),
                encode(&(&slice.motion, &slice.work)),
            )?;
        }
        if let Some(bay) = &self.bay {
            add(&mut saved, BAY.into(), encode(&bay.motion))?;
        }
        let mut parts = SavedRun::default();
        let own = self
            .save_parts(&mut parts)
            .and_then(|()| self.save_loads(&mut parts));
        saved
            .sections
            .extend(self.ranks.sections_of_all(parts.sections));
        own?;
        for (index, observer) in observers.iter().enumerate() {
            let own = name(OBSERVER, index, observer.name());
            add(&mut saved, own, observer.save_state())?;
        }
        Ok(saved)
    }

    /// Adds sections with the states of all loads that act on this rank.
    fn save_loads(&self, saved: &mut SavedRun) -> Result<(), PartFault> {
        let loads = self.loads.all().iter().zip(self.loads.here());
        for (index, (load, here)) in loads.enumerate() {
            // A load that acts nowhere has its first state, which rank 0 has too.
            if *here || self.ranks.team.rank() == 0 {
                add(saved, name("load", index, load.name()), load.save_state())?;
            }
        }
        Ok(())
    }

    /// Start of the names of the sections of constraints: of a part of them where there are other ranks.
    fn part(&self, kind: &str) -> String {
        if self.ranks.is_single() {
            kind.into()
        } else {
            format!("{PART} {} of {kind}", self.ranks.team.rank())
        }
    }

    /// Adds sections with the states of all blocks and constraints.
    pub(crate) fn save_parts(&self, saved: &mut SavedRun) -> Result<(), PartFault> {
        for (block, &index) in self.blocks.iter().zip(&self.ranks.block_numbers) {
            let index = index as usize;
            let own = name(BLOCK, index, block.label());
            match block.saved() {
                Some(state) => add(saved, own, state.save_state())?,
                None => {
                    let own = name(HISTORY, index, block.label());
                    add(saved, own, encode(&block.history()))?;
                }
            }
        }
        let numbers = &self.ranks.constraint_numbers;
        for (bound, &index) in self.constraints.iter().zip(numbers) {
            let (constraint, index) = (&bound.constraint, index as usize);
            match constraint.saved() {
                Some(state) => {
                    let own = name(&self.part(CONSTRAINT), index, constraint.name());
                    add(saved, own, state.save_state())?;
                }
                None => {
                    let joints = bound.joints();
                    let joints: Vec<JointHistory> = joints.iter().map(JointHistory::from).collect();
                    let own = name(&self.part(JOINTS), index, constraint.name());
                    add(saved, own, encode(&joints))?;
                }
            }
        }
        Ok(())
    }

    /// Restores the states of all blocks and constraints from their sections.
    pub(crate) fn restore_parts(&mut self, sections: &mut Sections) -> Result<(), PartFault> {
        for (block, &index) in self.blocks.iter_mut().zip(&self.ranks.block_numbers) {
            let index = index as usize;
            let own = name(BLOCK, index, block.label());
            if let Some(bytes) = sections.take(&own) {
                let restored = match block.saved_mut() {
                    Some(state) => state.restore_state(bytes),
                    None => Err(StateError::Unexpected),
                };
                restored.map_err(of_part(&own))?;
            } else {
                let fields: Vec<HistoryField> =
                    sections.decode(&name(HISTORY, index, block.label()))?;
                block.set_history(&fields);
            }
        }
        let is_single = self.ranks.is_single();
        let mut joints: Vec<(String, Vec<JointHistory>)> = Vec::new();
        let numbers = &self.ranks.constraint_numbers;
        for (bound, &index) in self.constraints.iter_mut().zip(numbers) {
            let (constraint, index) = (&mut bound.constraint, index as usize);
            let own = name(CONSTRAINT, index, constraint.name());
            if let Some(bytes) = sections.take(&own) {
                let restored = if is_single {
                    match constraint.saved_mut() {
                        Some(state) => state.restore_state(bytes),
                        None => Err(StateError::Unexpected),
                    }
                } else {
                    restore_parts(constraint.as_mut(), bytes)
                };
                restored.map_err(of_part(&own))?;
                continue;
            }
            let parts = sections.take_parts(&own);
            for bytes in &parts {
                restore_parts(constraint.as_mut(), bytes).map_err(of_part(&own))?;
            }
            if !parts.is_empty() {
                continue;
            }
            let own = name(JOINTS, index, constraint.name());
            let parts = sections.take_parts(&own);
            let parts = if parts.is_empty() {
                vec![sections.expect(&own)?]
            } else {
                parts
            };
            for bytes in parts {
                joints.push((own.clone(), decode(bytes).map_err(of_part(&own))?));
            }
        }
        for (own, joints) in joints {
            for joint in joints {
                if !self.restore_joint(&joint).unwrap_or(false) {
                    return Err(of_part(&own)(StateError::Unexpected));
                }
            }
        }
        Ok(())
    }

    /// Restores the state of a run of an equal model, but for the energy ledger and observers.
    pub(crate) fn restore_run(&mut self, saved: &SavedRun) -> Result<RestoredRun, RunError> {
        let mut sections = Sections::of(saved);
        let run: RestoredRun = sections.decode(RUN)?;
        let partition = self.partition().fingerprint(&self.mesh);
        StateError::expect_same("the precision", run.precision, self.precision_number())
            .and_then(|()| {
                let what = "the fingerprint of the blocks of elements";
                StateError::expect_same(what, run.partition, partition)
            })
            .and_then(|()| {
                let what = "the fingerprint of the fibres";
                StateError::expect_same(what, run.fibres, self.groups.fibres.fingerprint())
            })
            .map_err(of_part(RUN))?;
        let body: State = sections.decode(BODY)?;
        self.set_state(&body).map_err(|error| {
            of_part(BODY)(StateError::Refused {
                reason: error.to_string(),
            })
        })?;
        drop(body);
        if let Some(slice) = &mut self.delayed {
            (slice.motion, slice.work) = sections.decode(SLICE)?;
        }
        if let Some(bay) = &mut self.bay {
            bay.motion = sections.decode(BAY)?;
        }
        self.spectrum = run.spectrum;
        self.restore_parts(&mut sections)?;
        for (index, load) in self.loads.all_mut().iter_mut().enumerate() {
            let own = name("load", index, load.name());
            let bytes = match saved.new_observers {
                // A load may have another name by what it does later on, such as a wave more.
                true => sections.take_starting(&name("load", index, "")),
                false => sections.take(&own),
            };
            let bytes = bytes.ok_or(StateError::Missing).map_err(of_part(&own))?;
            load.restore_state(bytes).map_err(of_part(&own))?;
        }
        sections.expect_observers(!self.ranks.is_single())?;
        Ok(run)
    }

    /// Restores the energy ledger, which is open if one was, unless it `may_begin` or end at the state.
    pub(crate) fn restore_ledger(
        &mut self,
        run: &RestoredRun,
        may_begin: bool,
    ) -> Result<(), RunError> {
        let restored = match (&mut self.ledger, &run.ledger) {
            (Some(ledger), Some(saved)) => ledger.restore(saved, &self.ranks),
            (None, None) => Ok(()),
            _ if may_begin => Ok(()),
            (Some(_), None) => Err(StateError::Missing),
            (None, Some(_)) => Err(StateError::Unexpected),
        };
        Ok(restored.map_err(of_part("the energy balance"))?)
    }
}

/// Restores observers, equal to those of the run that was saved and in the same order.
pub(crate) fn restore_observers(
    saved: &SavedRun,
    observers: &mut [Box<dyn Observer>],
) -> Result<(), RunError> {
    let mut sections = Sections::of(saved);
    sections.0.retain(|name, _| name.starts_with(OBSERVER));
    for (index, observer) in observers.iter_mut().enumerate() {
        let own = name(OBSERVER, index, observer.name());
        let bytes = sections.expect(&own)?;
        observer.restore_state(bytes).map_err(of_part(&own))?;
    }
    let mut left: Vec<&str> = sections.0.into_keys().collect();
    left.sort_unstable();
    match left.first() {
        None => Ok(()),
        Some(name) => Err(of_part(name)(StateError::Unexpected).into()),
    }
}
