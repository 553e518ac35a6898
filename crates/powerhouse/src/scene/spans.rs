//! Where in a scene's file stands what is only built, and perhaps refused, after it was read.

use core::ops::Range;
use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse_explicit_core::observe::ObserveError;
use powerhouse_explicit_core::{EngineError, StageError};
use powerhouse_model::{ModelError, RunError};

use crate::{Error, Fault, MagnitudeOf, SceneFault, SceneText};

/// What puts a body at rest in a moving field right.
pub(crate) const NOT_AT_REST: &str =
    "an earlier `start`, a later `arrival`, or `initial = \"field\"`";

/// Where stages stand, and what they name.
#[derive(Clone, Debug, Default)]
pub(crate) struct StageSpans {
    /// The names of the stages, in their order.
    pub(crate) names: Vec<(String, Range<usize>)>,
    /// Values by stage (none for what stands outside of stages), key and value.
    pub(crate) items: BTreeMap<(Option<String>, &'static str, String), Range<usize>>,
}

impl StageSpans {
    /// The place of a value of a key; the stage's name without one, the first stage's without that.
    fn find(
        &self,
        stage: Option<&str>,
        (key, value): (&'static str, &str),
    ) -> Option<Range<usize>> {
        let own = (stage.map(str::to_owned), key, value.to_owned());
        let item = self.items.get(&own).cloned();
        // The later one of two of a name.
        let mut names = self.names.iter().rev();
        let named = names.find(|(name, _)| Some(name.as_str()) == stage);
        item.or_else(|| named.or(self.names.first()).map(|(_, place)| place.clone()))
    }
    fn last(&self) -> Option<Range<usize>> {
        self.names.last().map(|(_, place)| place.clone())
    }
}

/// The stage that an error of the engine concerns.
fn stage_of(error: &StageError) -> Option<&str> {
    match error {
        StageError::Elements { stage, .. }
        | StageError::Model { stage, .. }
        | StageError::NotEquilibrated { stage, .. } => Some(stage),
        _ => None,
    }
}

/// Bytes of the scene's file.
#[derive(Clone, Debug, Default)]
pub(crate) struct SceneSpans {
    /// The mesh's file.
    pub(crate) mesh: Range<usize>,
    /// Records and their components, by name.
    pub(crate) records: BTreeMap<String, Range<usize>>,
    /// The kind of the boundary.
    pub(crate) boundary: Range<usize>,
    /// Its first face.
    pub(crate) faces: Range<usize>,
    /// The region around which the field enters.
    pub(crate) region: Range<usize>,
    /// Planes of symmetry, one by one.
    pub(crate) mirrors: Vec<Range<usize>>,
    /// The first wave.
    pub(crate) field: Range<usize>,
    /// The start of the run.
    pub(crate) start: Range<usize>,
    /// The time step.
    pub(crate) step: Range<usize>,
    /// The scheme.
    pub(crate) scheme: Range<usize>,
    /// Histories and relative displacements by name.
    pub(crate) histories: BTreeMap<String, Range<usize>>,
    /// Cuts by name.
    pub(crate) cuts: BTreeMap<String, Range<usize>>,
    /// Materials of parts, by their set.
    pub(crate) materials: BTreeMap<String, Range<usize>>,
    /// Rims of parts, by their set.
    pub(crate) rims: BTreeMap<String, Range<usize>>,
    /// Stages: names and what stands in them.
    pub(crate) stages: StageSpans,
    /// Prescribed motions, with the user's numbers of their nodes.
    pub(crate) prescribed: Vec<(Range<usize>, Vec<u64>)>,
}

impl SceneSpans {
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
        if let Error::Magnitude { magnitude, .. } = error {
            let fault = Fault::of_magnitude(place, *magnitude);
            return SceneFault::new(text.clone(), fault).into();
        }
        let at_rest = matches!(error, Error::NotAtRest { .. });
        let mut fault = Fault::refused(place, error);
        if at_rest {
            fault = fault.with_help(NOT_AT_REST);
        }
        SceneFault::new(text.clone(), fault).into()
    }

    /// The place of an error, if it is known.
    pub(crate) fn of(&self, error: &Error) -> Option<Range<usize>> {
        let place = match error {
            Error::NotAtRest { .. } => self.start.clone(),
            Error::ForeignMedium { .. } | Error::InnerFacet { .. } | Error::SharedFacet { .. } => {
                self.faces.clone()
            }
            Error::Magnitude { of, .. } => match of {
                MagnitudeOf::Part(set) => return self.materials.get(set).cloned(),
                MagnitudeOf::Mesh => self.mesh.clone(),
                MagnitudeOf::Record(name) => return self.records.get(name).cloned(),
                MagnitudeOf::Scene => return None,
            },
            Error::UnusedField { .. } => self.field.clone(),
            Error::IdleRim { set, .. } => return self.rims.get(set).cloned(),
            Error::Staging { stage, source } => {
                return self.stages.find(stage.as_deref(), source.item());
            }
            Error::Stage(error) => return self.stages.find(Some(stage_of(error)?), ("", "")),
            Error::HandOver { .. } => return self.stages.last(),
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
            Some(
                ObserveError::EmptySection { section, .. }
                | ObserveError::NoDirection { section, .. },
            ) => self.cuts.get(section).cloned(),
            Some(ObserveError::InactiveLocation { name, .. }) => self.histories.get(name).cloned(),
            _ => None,
        }
    }
}
