//! The rate-independent (static) form of a law, and its form discretised in time for steps of one length.

use std::sync::Arc;

use powerhouse_model::{ElasticDomain, Scalar};

use super::law::BatchLaw;

/// Static form of a law, and its form discretised in time for steps of one length; neither for linear laws,
/// which their moduli define.
pub(super) struct LawForms<S: Scalar> {
    static_form: Option<Arc<dyn BatchLaw<S>>>,
    dynamic_form: Option<DynamicForm<S>>,
}

/// A law discretised in time for steps of one length.
struct DynamicForm<S: Scalar> {
    /// Length of the steps (s).
    length: f64,
    law: Arc<dyn BatchLaw<S>>,
    /// Its elastic domain, in which it is not evaluated.
    domain: Option<ElasticDomain>,
}

impl<S: Scalar> LawForms<S> {
    pub(super) fn new(law: Option<Arc<dyn BatchLaw<S>>>) -> Self {
        Self {
            static_form: law,
            dynamic_form: None,
        }
    }
    /// Prepares the form for steps of a length (s).
    pub(super) fn prepare(&mut self, length: f64) {
        let known = self
            .dynamic_form
            .as_ref()
            .is_some_and(|form| form.length == length);
        if !known {
            self.dynamic_form = self.static_form.as_ref().map(|law| {
                let law = law.for_step(length);
                DynamicForm {
                    length,
                    domain: law.elastic_domain(),
                    law,
                }
            });
        }
    }
    /// Whether the last forces are those of a dynamic step, and not of a static state.
    pub(super) fn is_stepping(&self) -> bool {
        self.dynamic_form
            .as_ref()
            .is_some_and(|form| form.length > 0.0)
    }
    /// The static form; none for linear laws.
    pub(super) fn static_form(&self) -> Option<&dyn BatchLaw<S>> {
        self.static_form.as_deref()
    }
    /// The form of the last forces; the static form before any.
    pub(super) fn current(&self) -> Option<&dyn BatchLaw<S>> {
        match &self.dynamic_form {
            Some(form) => Some(form.law.as_ref()),
            None => self.static_form(),
        }
    }
    /// Elastic domain of the form of the last forces, in which it need not be evaluated.
    pub(super) fn elastic_domain(&self) -> Option<&ElasticDomain> {
        self.dynamic_form.as_ref()?.domain.as_ref()
    }
    /// Whether the law is viscoelastic in dynamic steps.
    pub(super) fn relaxes(&self) -> bool {
        self.current().is_some_and(|law| law.relaxes())
    }
    /// Whether the law is viscoelastic and stored energy is the only one that it has: what it relaxes is then the work less the
    /// increase of the stored energy over any number of steps.
    pub(super) fn telescopes(&self) -> bool {
        self.current()
            .is_some_and(|law| law.relaxes() && law.only_stores())
    }
}
