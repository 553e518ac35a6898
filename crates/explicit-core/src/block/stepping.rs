//! A law that may depend on time, in a motion whose steps have one length.

use std::sync::Arc;

use super::law::BatchLaw;

/// A law, and what becomes of it in steps of one length; nothing for linear laws, of which the
/// moduli say everything.
pub(super) struct Stepping<S> {
    of_rest: Option<Arc<dyn BatchLaw<S>>>,
    in_step: Option<(f64, Arc<dyn BatchLaw<S>>)>,
}

impl<S> Stepping<S> {
    pub(super) fn new(law: Option<Arc<dyn BatchLaw<S>>>) -> Self {
        Self {
            of_rest: law,
            in_step: None,
        }
    }
    /// From now on steps have a length (s).
    pub(super) fn prepare(&mut self, length: f64) {
        let known = self.in_step.as_ref().is_some_and(|(old, _)| *old == length);
        if !known {
            let law = self.of_rest.as_ref();
            self.in_step = law.map(|law| (length, law.for_step(length)));
        }
    }
    /// Whether the last forces belong to a motion in steps, and not to a static state.
    pub(super) fn is_stepping(&self) -> bool {
        matches!(self.in_step, Some((length, _)) if length > 0.0)
    }
    /// The law of the static state.
    pub(super) fn of_rest(&self) -> Option<&dyn BatchLaw<S>> {
        self.of_rest.as_deref()
    }
    /// The law of the last steps, if there were any.
    pub(super) fn now(&self) -> Option<&dyn BatchLaw<S>> {
        match &self.in_step {
            Some((_, law)) => Some(law.as_ref()),
            None => self.of_rest(),
        }
    }
    /// Whether the law relaxes in steps.
    pub(super) fn relaxes(&self) -> bool {
        self.now().is_some_and(|law| law.relaxes())
    }
}
