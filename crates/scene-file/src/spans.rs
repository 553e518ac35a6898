//! Byte ranges in the scene file of items that are checked only when the model is built.

use core::ops::Range;
use std::collections::BTreeMap;
use std::sync::Arc;

use powerhouse_model::{EngineError, ModelError, RunError, StageError};
use powerhouse_observe::ObserveError;
use powerhouse_wavefield::StationError;

use powerhouse_scene::{
    DelayedError, Error, Fault, MagnitudeOf, Places, SceneFault, SceneText, Subject,
};

/// Hint on a field that is not negligible at the start of a body at rest.
pub(crate) const NOT_AT_REST: &str =
    "an earlier `start`, a later `arrival`, or `initial = \"field\"`";

/// Byte ranges of stages and of the values in them.
#[derive(Clone, Debug, Default)]
pub(crate) struct StageSpans {
    /// Names of the stages with their byte ranges, in order.
    pub(crate) names: Vec<(String, Range<usize>)>,
    /// Byte ranges by stage (`None` outside of stages), key and value.
    pub(crate) items: BTreeMap<(Option<String>, &'static str, String), Range<usize>>,
}

impl StageSpans {
    /// Byte range of a value of a key; by default that of the stage's name, or of the first stage.
    fn find(
        &self,
        stage: Option<&str>,
        (key, value): (&'static str, &str),
    ) -> Option<Range<usize>> {
        let own = (stage.map(str::to_owned), key, value.to_owned());
        let item = self.items.get(&own).cloned();
        // Of two stages of the same name, the later one.
        let mut names = self.names.iter().rev();
        let named = names.find(|(name, _)| Some(name.as_str()) == stage);
        item.or_else(|| named.or(self.names.first()).map(|(_, place)| place.clone()))
    }
    fn last(&self) -> Option<Range<usize>> {
        self.names.last().map(|(_, place)| place.clone())
    }
}

/// Name of the stage that an engine error concerns.
fn stage_of(error: &StageError) -> Option<&str> {
    match error {
        StageError::Elements { stage, .. }
        | StageError::Model { stage, .. }
        | StageError::NotEquilibrated { stage, .. } => Some(stage),
        _ => None,
    }
}

/// Byte ranges of items in the scene file.
#[derive(Clone, Debug, Default)]
pub(crate) struct SceneSpans {
    /// Path of the mesh file.
    pub(crate) mesh: Range<usize>,
    /// Names of records and their components.
    pub(crate) records: BTreeMap<String, Range<usize>>,
    /// Kind of the absorbing boundary.
    pub(crate) boundary: Range<usize>,
    /// First absorbing face.
    pub(crate) faces: Range<usize>,
    /// Domain reduction region.
    pub(crate) region: Range<usize>,
    /// Symmetry planes.
    pub(crate) mirrors: Vec<Range<usize>>,
    /// First wave.
    pub(crate) field: Range<usize>,
    /// Delayed ends.
    pub(crate) delayed: Range<usize>,
    /// Start of the run.
    pub(crate) start: Range<usize>,
    /// Time step.
    pub(crate) step: Range<usize>,
    /// Integration scheme.
    pub(crate) scheme: Range<usize>,
    /// Histories and relative displacements, by name.
    pub(crate) histories: BTreeMap<String, Range<usize>>,
    /// Sections, by name.
    pub(crate) cuts: BTreeMap<String, Range<usize>>,
    /// Reinforcements of sections and of rings, by name.
    pub(crate) reinforcements: BTreeMap<String, Range<usize>>,
    /// Materials of parts, by element set.
    pub(crate) materials: BTreeMap<String, Range<usize>>,
    /// Rims of parts, by element set.
    pub(crate) rims: BTreeMap<String, Range<usize>>,
    /// Stages and the values in them.
    pub(crate) stages: StageSpans,
    /// Name of the case of the scene.
    pub(crate) case: Option<String>,
    /// Facet sets of added masses, by name.
    pub(crate) added_masses: BTreeMap<String, Range<usize>>,
    /// Prescribed motions, with their node numbers in the mesh file.
    pub(crate) prescribed: Vec<(Range<usize>, Vec<u64>)>,
}

/// Byte ranges of a scene in the text of its file.
pub(crate) struct FilePlaces {
    pub(crate) text: Arc<SceneText>,
    pub(crate) spans: SceneSpans,
}

impl Places for FilePlaces {
    fn placed(&self, subject: Subject, error: Error) -> Error {
        let place = match subject {
            Subject::Boundary => Some(self.spans.boundary.clone()),
            Subject::Region => Some(self.spans.region.clone()),
            Subject::Mirror(index) => self.spans.mirrors.get(index).cloned(),
            _ => self.spans.of(&error),
        };
        let placed = match place {
            Some(place) => self.put_at(place, error),
            None => error,
        };
        placed.in_case(self.spans.case.as_deref())
    }
}

impl FilePlaces {
    fn put_at(&self, place: Range<usize>, error: Error) -> Error {
        if let Error::Magnitude { magnitude, .. } = error {
            let fault = Fault::of_magnitude(place, *magnitude);
            return SceneFault::new(self.text.clone(), fault).into();
        }
        let at_rest = matches!(error, Error::NotAtRest { .. });
        let mut fault = Fault::refused(place, error);
        if at_rest {
            fault = fault.with_help(NOT_AT_REST);
        }
        SceneFault::new(self.text.clone(), fault).into()
    }
}

impl SceneSpans {
    /// Byte range of an error, if it is known.
    pub(crate) fn of(&self, error: &Error) -> Option<Range<usize>> {
        let place = match error {
            Error::NotAtRest { .. } => self.start.clone(),
            Error::ForeignMedium { .. }
            | Error::Layers(_)
            | Error::InnerFacet { .. }
            | Error::SharedFacet { .. } => self.faces.clone(),
            Error::Magnitude { of, .. } => match of {
                MagnitudeOf::Part(set) => return self.materials.get(set).cloned(),
                MagnitudeOf::Mesh => self.mesh.clone(),
                MagnitudeOf::Record(name) => return self.records.get(name).cloned(),
                _ => return None,
            },
            Error::UnusedField { .. } => self.field.clone(),
            Error::Delayed(error) => return self.of_delayed(error),
            Error::Water(error) => return self.added_masses.get(error.set()).cloned(),
            Error::EmptyRim { set, .. } => return self.rims.get(set).cloned(),
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

    fn of_delayed(&self, error: &DelayedError) -> Option<Range<usize>> {
        let place = match error {
            DelayedError::Fast { set, .. } => return self.materials.get(set).cloned(),
            DelayedError::OtherField { .. }
            | DelayedError::Slownesses { .. }
            | DelayedError::PastCritical { .. } => &self.field,
            _ => &self.delayed,
        };
        Some(place.clone()).filter(|place| !place.is_empty())
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
        if let Some(
            EngineError::DelayedNode { .. }
            | EngineError::DelayedPair { .. }
            | EngineError::DelayedWith { .. }
            | EngineError::DelayedMass { .. },
        ) = source.downcast_ref()
        {
            return Some(self.delayed.clone()).filter(|place| !place.is_empty());
        }
        if source.is::<StationError>() {
            return Some(self.field.clone()).filter(|place| !place.is_empty());
        }
        match source.downcast_ref() {
            Some(
                ObserveError::EmptySection { section, .. }
                | ObserveError::NoDirection { section, .. },
            ) => self.cuts.get(section).cloned(),
            Some(ObserveError::Reinforcement { section, .. }) => {
                // Sections of a ring have its name, and their angle behind a hyphen.
                let of_ring = section.rsplit_once('-').map(|(ring, _)| ring);
                let mut names = [section.as_str()].into_iter().chain(of_ring);
                names.find_map(|name| self.reinforcements.get(name).cloned())
            }
            Some(ObserveError::InactiveLocation { name, .. }) => self.histories.get(name).cloned(),
            _ => None,
        }
    }
}
