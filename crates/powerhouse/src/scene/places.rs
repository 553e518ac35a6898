//! Where in a scene's file stands what is only built, and perhaps refused, after it was read.

use core::ops::Range;
use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse_explicit_core::EngineError;
use powerhouse_explicit_core::observe::ObserveError;
use powerhouse_model::{ModelError, RunError};

use crate::{Error, Fault, SceneFault, SceneText};

/// What puts a body at rest in a moving field right.
pub(crate) const NOT_AT_REST: &str =
    "an earlier `start`, a later `arrival`, or `initial = \"field\"`";

/// Bytes of the scene's file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Places {
    /// The kind of the boundary.
    pub(crate) boundary: Range<usize>,
    /// Its first face.
    pub(crate) faces: Range<usize>,
    /// The first wave.
    pub(crate) field: Range<usize>,
    /// The start of the run.
    pub(crate) start: Range<usize>,
    /// The time step.
    pub(crate) step: Range<usize>,
    /// The scheme.
    pub(crate) scheme: Range<usize>,
    /// Cuts by name.
    pub(crate) cuts: BTreeMap<String, Range<usize>>,
    /// Materials of parts, by their set.
    pub(crate) materials: BTreeMap<String, Range<usize>>,
    /// Rims of parts, by their set.
    pub(crate) rims: BTreeMap<String, Range<usize>>,
    /// Prescribed motions, with the user's numbers of their nodes.
    pub(crate) prescribed: Vec<(Range<usize>, Vec<u64>)>,
}

impl Places {
    /// An error at its place in the scene's file, if the scene has one and the place is known.
    pub(crate) fn put(&self, source: &Option<Arc<SceneText>>, error: Error) -> Error {
        match self.of(&error) {
            Some(place) => Self::put_at(source, place, error),
            None => error,
        }
    }

    /// An error at a place in the scene's file, if the scene has one.
    pub(crate) fn put_at(
        source: &Option<Arc<SceneText>>,
        place: Range<usize>,
        error: Error,
    ) -> Error {
        let Some(text) = source else {
            return error;
        };
        let at_rest = matches!(error, Error::NotAtRest { .. });
        let mut fault = Fault::refused(place, error);
        if at_rest {
            fault = fault.with_help(NOT_AT_REST);
        }
        SceneFault::new(text.clone(), fault).into()
    }

    fn of(&self, error: &Error) -> Option<Range<usize>> {
        let place = match error {
            Error::NotAtRest { .. } => self.start.clone(),
            Error::ForeignMedium { .. } | Error::InnerFacet { .. } => self.faces.clone(),
            Error::UnusedField { .. } => self.field.clone(),
            Error::IdleRim { set, .. } => return self.rims.get(set).cloned(),
            Error::Run(RunError::TooLittleDamping { .. }) => self.scheme.clone(),
            Error::Run(RunError::UnstableStep { .. }) => self.step.clone(),
            Error::Model(ModelError::Refused { source, .. }) => {
                return self.of_source(source.as_ref());
            }
            _ => return None,
        };
        Some(place)
    }

    fn of_source(
        &self,
        source: &(dyn std::error::Error + Send + Sync + 'static),
    ) -> Option<Range<usize>> {
        if let Some(EngineError::SupportConflict { node }) = source.downcast_ref() {
            let of_node = self
                .prescribed
                .iter()
                .rev()
                .find(|(_, nodes)| nodes.contains(node));
            return of_node.map(|(place, _)| place.clone());
        }
        if let Some(EngineError::ElementSize { set, .. }) = source.downcast_ref() {
            return self.materials.get(set).cloned();
        }
        match source.downcast_ref() {
            // What looks at elements may be the first to build them.
            Some(ObserveError::Refused {
                source: ModelError::Refused { source, .. },
                ..
            }) if matches!(source.downcast_ref(), Some(EngineError::ElementSize { .. })) => {
                self.of_source(source.as_ref())
            }
            Some(
                ObserveError::EmptyCut { cut }
                | ObserveError::NoDirection { cut, .. }
                | ObserveError::Refused { cut, .. },
            ) => self.cuts.get(cut).cloned(),
            _ => None,
        }
    }
}
