//! A law that may depend on time, in a motion whose steps have one length.

use std::sync::Arc;

use powerhouse_model::ElasticDomain;

use super::law::BatchLaw;

/// A law, and what becomes of it in steps of one length; nothing for linear laws, of which the
/// moduli say everything.
pub(super) struct Stepping<S> {
    of_rest: Option<Arc<dyn BatchLaw<S>>>,
    in_step: Option<InStep<S>>,
}

struct InStep<S> {
    /// Length of the steps (s).
    length: f64,
    law: Arc<dyn BatchLaw<S>>,
    /// Where it is not asked.
    domain: Option<ElasticDomain>,
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
        let known = self
            .in_step
            .as_ref()
            .is_some_and(|now| now.length == length);
        if !known {
            self.in_step = self.of_rest.as_ref().map(|law| {
                let law = law.for_step(length);
                InStep {
                    length,
                    domain: law.elastic_domain(),
                    law,
                }
            });
        }
    }
    /// Whether the last forces belong to a motion in steps, and not to a static state.
    pub(super) fn is_stepping(&self) -> bool {
        self.in_step.as_ref().is_some_and(|now| now.length > 0.0)
    }
    /// The law of the static state.
    pub(super) fn of_rest(&self) -> Option<&dyn BatchLaw<S>> {
        self.of_rest.as_deref()
    }
    /// The law of the last steps, if there were any.
    pub(super) fn now(&self) -> Option<&dyn BatchLaw<S>> {
        match &self.in_step {
            Some(now) => Some(now.law.as_ref()),
            None => self.of_rest(),
        }
    }
    /// Stresses under which the law of the last steps need not be asked.
    pub(super) fn elastic_domain(&self) -> Option<&ElasticDomain> {
        self.in_step.as_ref()?.domain.as_ref()
    }
    /// Whether the law relaxes in steps.
    pub(super) fn relaxes(&self) -> bool {
        self.now().is_some_and(|law| law.relaxes())
    }
}
