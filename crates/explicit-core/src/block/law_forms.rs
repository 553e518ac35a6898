//! The rate-independent (static) form of a law, and its form discretised in time for steps of one length.

use std::sync::Arc;

use powerhouse_model::ElasticDomain;

use super::law::BatchLaw;

/// The static form of a law and its form in time steps of one length; none of linear laws, which their
/// moduli define.
pub(super) struct LawForms<S> {
    static_form: Option<Arc<dyn BatchLaw<S>>>,
    dynamic_form: Option<InStep<S>>,
}

struct InStep<S> {
    /// Length of the steps (s).
    length: f64,
    law: Arc<dyn BatchLaw<S>>,
    /// Where it is not asked.
    domain: Option<ElasticDomain>,
}

impl<S> LawForms<S> {
    pub(super) fn new(law: Option<Arc<dyn BatchLaw<S>>>) -> Self {
        Self {
            static_form: law,
            dynamic_form: None,
        }
    }
    /// From now on steps have a length (s).
    pub(super) fn prepare(&mut self, length: f64) {
        let known = self
            .dynamic_form
            .as_ref()
            .is_some_and(|now| now.length == length);
        if !known {
            self.dynamic_form = self.static_form.as_ref().map(|law| {
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
        self.dynamic_form
            .as_ref()
            .is_some_and(|now| now.length > 0.0)
    }
    /// The law of the static state.
    pub(super) fn static_form(&self) -> Option<&dyn BatchLaw<S>> {
        self.static_form.as_deref()
    }
    /// The law of the last steps, if there were any.
    pub(super) fn now(&self) -> Option<&dyn BatchLaw<S>> {
        match &self.dynamic_form {
            Some(now) => Some(now.law.as_ref()),
            None => self.static_form(),
        }
    }
    /// Stresses under which the law of the last steps need not be asked.
    pub(super) fn elastic_domain(&self) -> Option<&ElasticDomain> {
        self.dynamic_form.as_ref()?.domain.as_ref()
    }
    /// Whether the law relaxes in steps.
    pub(super) fn relaxes(&self) -> bool {
        self.now().is_some_and(|law| law.relaxes())
    }
}
