//! Envelopes (maxima over time) of the history variables of laws.

use powerhouse_model::{
    Cadence, Fields, Flow, HistoryKind, HistoryVariable, Mesh, ModelError, Observer, Reach,
    Selection, StateError, StepView,
};
use serde::{Deserialize, Serialize};

use super::{ObserveError, PeakField, Recording, check_cadence};

/// Envelopes of history variables, as a [`StatePeaks`] has observed them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StateTable {
    /// Mesh indices of the elements that the fields are of, in the order of their values.
    pub elements: Vec<u32>,
    /// Maximum over time of each variable of kind [`HistoryKind::Amount`], with its time; zero in elements whose law has
    /// no such variable.
    pub peaks: Vec<(HistoryVariable, PeakField)>,
    /// Last values of the variables of kind [`HistoryKind::Flags`], whole numbers whose bits are flags.
    pub flags: Vec<(HistoryVariable, Vec<f64>)>,
}

/// Observer of the envelopes of the laws' history variables, element by element: scalar amounts such as damage and
/// equivalent plastic strain, and the last values of flags. Components of tensors are left out.
///
/// The last step is always observed, which suffices for amounts that never decrease, as most do.
///
/// Memory: 16 bytes per element and amount, 8 per element and number of flags.
pub struct StatePeaks {
    cadence: Cadence,
    element_tags: Vec<u64>,
    recording: Recording<StateTable>,
}

impl StatePeaks {
    /// An observer of some history variables in elements, given by mesh indices.
    ///
    /// # Errors
    /// A cadence out of range, an index beyond the mesh.
    pub fn new(
        mesh: &Mesh,
        elements: &[u32],
        variables: &[HistoryVariable],
        cadence: Cadence,
    ) -> Result<Self, ObserveError> {
        check_cadence(cadence)?;
        let tag = |&element: &u32| {
            let tag = mesh.element_tags().get(element as usize).copied();
            tag.ok_or_else(|| ObserveError::NoSuchElement {
                name: "state".into(),
                element: u64::from(element),
            })
        };
        let of_kind = |kind: HistoryKind| variables.iter().filter(move |v| v.kind == kind);
        let amounts = of_kind(HistoryKind::Amount);
        let flags = of_kind(HistoryKind::Flags);
        let table = StateTable {
            elements: elements.to_vec(),
            peaks: amounts
                .map(|variable| (*variable, PeakField::new(elements.len(), 0.0)))
                .collect(),
            flags: flags
                .map(|variable| (*variable, vec![0.0; elements.len()]))
                .collect(),
        };
        Ok(Self {
            cadence,
            element_tags: elements.iter().map(tag).collect::<Result<_, _>>()?,
            recording: Recording::new(table),
        })
    }
    /// Shared access to the results.
    pub fn recording(&self) -> Recording<StateTable> {
        self.recording.clone()
    }
}

impl Observer for StatePeaks {
    fn name(&self) -> &str {
        "state"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn reach(&self) -> Reach {
        let table = self.recording.lock();
        let peaks = table.peaks.iter().map(|peak| peak.0.name);
        let variables = peaks.chain(table.flags.iter().map(|flags| flags.0.name));
        Reach::NONE
            .with_elements(Selection::These(table.elements.clone()))
            .with_variables(variables)
    }
    fn cadence(&self) -> Cadence {
        self.cadence
    }
    fn save_state(&self) -> Result<Vec<u8>, StateError> {
        self.recording.save()
    }
    fn restore_state(&mut self, saved: &[u8]) -> Result<(), StateError> {
        self.recording.restore(saved, |found, here| {
            StateError::expect_same("the list of elements", &found.elements, &here.elements)?;
            let variables = |table: &StateTable| -> Vec<HistoryVariable> {
                let peaks = table.peaks.iter().map(|peak| peak.0);
                peaks
                    .chain(table.flags.iter().map(|flags| flags.0))
                    .collect()
            };
            StateError::expect_same("the list of variables", variables(found), variables(here))
        })
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let time = view.time();
        let mut guard = self.recording.lock();
        let StateTable {
            elements,
            peaks,
            flags,
        } = &mut *guard;
        for (variable, peak) in peaks {
            for (index, &element) in elements.iter().enumerate() {
                let Some(value) = view.history(element, variable.name) else {
                    continue;
                };
                if !value.is_finite() {
                    return Err(ObserveError::NotFinite {
                        what: variable.name,
                        place: "element",
                        number: self.element_tags[index],
                        time,
                    }
                    .into());
                }
                peak.raise(index, value, time);
            }
        }
        for (variable, values) in flags {
            for (value, &element) in values.iter_mut().zip(elements.iter()) {
                *value = view.history(element, variable.name).unwrap_or(0.0);
            }
        }
        Ok(Flow::Continue)
    }
}
