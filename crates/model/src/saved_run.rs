//! State of a run between two steps, from which it is resumed.

use crate::{ModelError, Progress};

/// State of one part of a run, encoded by that part.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SavedSection {
    /// Name of the part, unique in its run, such as `observer 2: envelope`.
    pub name: String,
    /// The state, in an encoding that this part alone reads.
    pub bytes: Vec<u8>,
}

/// State of a dynamic run between two steps: that of the body, and of everything else that the run keeps from step to
/// step, such as the energy balance, joints and what observers have recorded.
///
/// An engine makes it for a [`CheckpointSink`] and goes on from it as [`RunOptions::resume`](crate::RunOptions::resume).
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SavedRun {
    /// Number of steps done since the start of the run.
    pub done: u64,
    /// Time of the displacement (s).
    pub time: f64,
    /// Length of a step (s).
    pub step: f64,
    /// States of the parts of the run, in an order of the engine's.
    pub sections: Vec<SavedSection>,
    /// Whether the run that goes on has observers of its own, which begin at this state, and an energy balance only if it
    /// asks for one; otherwise its observers are those of the saved run.
    pub new_observers: bool,
}

impl SavedRun {
    /// The state of a run after a number of steps, at a time (s), with a length of step (s), without sections.
    pub fn new(done: u64, time: f64, step: f64) -> Self {
        Self {
            done,
            time,
            step,
            sections: Vec::new(),
            new_observers: false,
        }
    }
    /// The same state for a run with [observers of its own](Self::new_observers).
    #[must_use]
    pub fn without_observers(mut self) -> Self {
        self.new_observers = true;
        self
    }
    /// The section of a part, by name; none if there is no such section.
    pub fn section(&self, name: &str) -> Option<&SavedSection> {
        self.sections.iter().find(|section| section.name == name)
    }
}

/// Receiver of the states of a run between two steps, such as a writer of checkpoint files.
///
/// Its methods are called one after the other, by the thread of the run, which waits for their return.
///
/// ```
/// use powerhouse_model::{CheckpointSink, ModelError, Progress, SavedRun};
/// use std::sync::Mutex;
/// /// Keeps the state after every hundredth step.
/// #[derive(Debug, Default)]
/// struct Last(Mutex<Option<SavedRun>>);
/// impl CheckpointSink for Last {
///     fn is_due(&self, progress: &Progress) -> bool { progress.done % 100 == 0 }
///     fn take(&self, saved: SavedRun) -> Result<(), ModelError> {
///         *self.0.lock().unwrap() = Some(saved);
///         Ok(())
///     }
/// }
/// ```
pub trait CheckpointSink: Send + Sync + core::fmt::Debug {
    /// Whether the state after a step is to be saved; called after every step but the last one.
    fn is_due(&self, progress: &Progress) -> bool;
    /// Processes a state.
    ///
    /// # Errors
    /// Any error, which ends the run.
    fn take(&self, saved: SavedRun) -> Result<(), ModelError>;
}

#[cfg(feature = "serde")]
pub use encoding::{decode, encode, interned};

#[cfg(feature = "serde")]
mod encoding {
    use std::collections::BTreeSet;
    use std::sync::{Mutex, PoisonError};

    use crate::StateError;

    /// Encodes a value in the format of saved states (postcard), every number to its last bit.
    ///
    /// ```
    /// use powerhouse_model::{decode, encode};
    /// let bytes = encode(&(-0.0_f64, "crown"))?;
    /// let (zero, name): (f64, String) = decode(&bytes)?;
    /// assert_eq!((zero.to_bits(), name.as_str()), ((-0.0_f64).to_bits(), "crown"));
    /// # Ok::<(), powerhouse_model::StateError>(())
    /// ```
    ///
    /// # Errors
    /// [`StateError::Unencodable`].
    pub fn encode<T: serde::Serialize + ?Sized>(value: &T) -> Result<Vec<u8>, StateError> {
        postcard::to_allocvec(value).map_err(|error| StateError::Unencodable {
            reason: error.to_string(),
        })
    }

    /// Decodes a value that was [encoded](encode) from all of the bytes.
    ///
    /// # Errors
    /// [`StateError::Unreadable`] for bytes that do not encode such a value, or more than one.
    pub fn decode<T: serde::de::DeserializeOwned>(bytes: &[u8]) -> Result<T, StateError> {
        let unreadable = |reason: String| StateError::Unreadable { reason };
        let decoded = postcard::take_from_bytes(bytes);
        let (value, rest) = decoded.map_err(|error| unreadable(error.to_string()))?;
        match rest {
            [] => Ok(value),
            rest => Err(unreadable(format!("{} bytes too many", rest.len()))),
        }
    }

    /// Names that were decoded, each once, for the life of the process.
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

    /// The same name with the life of the process, as names of history variables and units have it. Each different name
    /// takes its memory once.
    pub fn interned(name: &str) -> &'static str {
        let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = names.get(name) {
            return known;
        }
        let name: &'static str = Box::leak(name.into());
        names.insert(name);
        name
    }
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use super::*;
    use crate::{HistoryVariable, StateError};

    /// Numbers keep their bits, and bytes that are cut short or too long are refused.
    #[test]
    fn numbers_keep_their_bits() {
        let numbers = [-0.0, f64::NAN, f64::MIN_POSITIVE / 8.0, f64::NEG_INFINITY];
        let bytes = encode(&numbers).unwrap();
        let found: [f64; 4] = decode(&bytes).unwrap();
        assert_eq!(found.map(f64::to_bits), numbers.map(f64::to_bits));
        for wrong in [&bytes[..bytes.len() - 1], &[&bytes[..], &[0]].concat()] {
            let refused = decode::<[f64; 4]>(wrong);
            assert!(matches!(refused, Err(StateError::Unreadable { .. })));
        }
    }

    /// A decoded history variable is the same, and its name takes memory once.
    #[test]
    fn names_are_kept_once() {
        let variable = HistoryVariable::amount("damage", "1");
        let bytes = encode(&variable).unwrap();
        let [a, b]: [HistoryVariable; 2] = [(); 2].map(|()| decode(&bytes).unwrap());
        assert_eq!(a, variable);
        assert!(core::ptr::eq(a.name, b.name));
    }
}
