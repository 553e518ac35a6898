//! A law that may depend on time, in a motion whose steps have one length.

use powerhouse_model::ConstitutiveLaw;

/// A law, and what becomes of it in steps of one length.
pub(super) struct Stepping<M> {
    of_rest: M,
    in_step: Option<(f64, M)>,
}

impl<M: ConstitutiveLaw> Stepping<M> {
    pub(super) fn new(law: M) -> Self {
        Self {
            of_rest: law,
            in_step: None,
        }
    }
    /// From now on steps have a length (s).
    pub(super) fn prepare(&mut self, length: f64) {
        let known = self.in_step.as_ref().is_some_and(|(old, _)| *old == length);
        if !(M::LINEAR || known) {
            self.in_step = Some((length, self.of_rest.for_step(length)));
        }
    }
    /// The law of the static state.
    pub(super) fn of_rest(&self) -> &M {
        &self.of_rest
    }
    /// The law of the last steps, if there were any.
    pub(super) fn now(&self) -> &M {
        self.in_step.as_ref().map_or(&self.of_rest, |(_, law)| law)
    }
}
