//! Construction stages before a dynamic run.

use thiserror::Error;

use crate::{
    Engine, EngineModel, HourglassShare, Mesh, ModelError, ModelSpec, Renewal, State, StaticError,
    StaticOptions, StaticProgress, StaticReport,
};

/// A function that completes the specification of a stage's model, which has the mesh and the initial state.
pub type StageModel<'a> = dyn Fn(ModelSpec<'_>) -> Result<ModelSpec<'_>, ModelError> + 'a;

/// A construction stage: elements excavated or cast, and the complete model that is then brought into static
/// equilibrium.
///
/// Each stage defines its materials, supports, loads, joints and bolts anew, so that anything may
/// change from one stage to the next; the state carries stresses, displacements and history variables. The forces
/// that the changes leave unbalanced are applied in the increments of the static solution.
pub struct Stage<'a> {
    name: String,
    excavated: Vec<u32>,
    cast: Vec<u32>,
    renewed: Vec<(String, Renewal)>,
    options: StaticOptions,
    build: Box<StageModel<'a>>,
}

impl<'a> Stage<'a> {
    /// A stage with a name for reports and a function that completes the specification of its
    /// model, which starts with the state of the stage before.
    pub fn new(
        name: impl Into<String>,
        build: impl Fn(ModelSpec<'_>) -> Result<ModelSpec<'_>, ModelError> + 'a,
    ) -> Self {
        Self {
            name: name.into(),
            excavated: Vec::new(),
            cast: Vec::new(),
            renewed: Vec::new(),
            options: StaticOptions::default(),
            build: Box::new(build),
        }
    }
    /// The same stage with elements (mesh indices) excavated (deactivated) first. The forces that they carried are
    /// released in increments, to the share [`StaticOptions::release`].
    #[must_use]
    pub fn excavate(mut self, elements: &[u32]) -> Self {
        self.excavated.extend_from_slice(elements);
        self
    }
    /// The same stage with elements (mesh indices) cast (activated) first, free of stress in the deformed body.
    #[must_use]
    pub fn cast(mut self, elements: &[u32]) -> Self {
        self.cast.extend_from_slice(elements);
        self
    }
    /// The same stage with joints (by name) reset at the present displacement: grouted, or
    /// released from a tie. Their former state is discarded; opening and slip are measured from this displacement.
    /// A joint that is not part of the stage is reset when a later stage has it.
    #[must_use]
    pub fn renew_joints<N: Into<String>>(
        mut self,
        joints: impl IntoIterator<Item = (N, Renewal)>,
    ) -> Self {
        let named = joints.into_iter().map(|(name, how)| (name.into(), how));
        self.renewed.extend(named);
        self
    }
    /// Sets the options of the static solution: method, tolerance, increments, release factor.
    #[must_use]
    pub fn options(mut self, options: StaticOptions) -> Self {
        self.options = options;
        self
    }
    /// Name of the stage.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The model of the stage, before equilibration.
    fn model<E: Engine + ?Sized>(
        &self,
        engine: &E,
        mesh: &Mesh,
        mut state: State,
    ) -> Result<Box<dyn EngineModel>, StageError> {
        let mut absent = vec![false; mesh.element_count()];
        for &element in &state.absent {
            if let Some(flag) = absent.get_mut(element as usize) {
                *flag = true;
            }
        }
        for (elements, wanted, what) in [
            (&self.excavated, false, "excavated, but is not active"),
            (&self.cast, true, "cast, but is active already"),
        ] {
            // An element may be excavated and cast in one stage: it is replaced.
            let replaced = |element: &u32| wanted && self.excavated.contains(element);
            let invalid = |e: &&u32| absent.get(**e as usize) != Some(&wanted) && !replaced(e);
            if let Some(&element) = elements.iter().find(invalid) {
                let tag = mesh.element_tags().get(element as usize).copied();
                return Err(StageError::Elements {
                    stage: self.name.clone(),
                    element: tag.unwrap_or(u64::from(element)),
                    what,
                });
            }
        }
        if !self.excavated.is_empty() {
            state.remove(&self.excavated);
        }
        if !self.cast.is_empty() {
            state.cast(&self.cast);
        }
        let renewed = |name: &String| self.renewed.iter().any(|(renewed, _)| renewed == name);
        (state.joints).retain(|joint| !renewed(&joint.name));
        let built = (self.build)(ModelSpec::new(mesh).start(state));
        let built = built.and_then(|spec| engine.build(spec));
        let mut model = built.map_err(|source| StageError::Model {
            stage: self.name.clone(),
            source,
        })?;
        if let Some(stateful) = model.stateful() {
            for (joint, renewal) in &self.renewed {
                stateful.renew_joint(joint, *renewal);
            }
        }
        Ok(model)
    }
}

/// Report of a construction stage.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StageReport {
    /// Name of the stage.
    pub name: String,
    /// Number of elements that were excavated (deactivated) in the stage.
    pub excavated: usize,
    /// Number of elements that were cast (activated) in the stage.
    pub cast: usize,
    /// Report of the static solution: numbers of operations and the residual that is left.
    pub solution: StaticReport,
    /// Largest displacement of a node from the start to the end of this stage (m), and the node's number.
    pub largest_displacement: (f64, u64),
    /// Stored hourglass and internal energy (J) of each element set at the end of the stage.
    pub hourglass: Vec<HourglassShare>,
}

/// Event in the solution of stages, passed to the callback of [`Engine::run_stages`].
#[non_exhaustive]
pub enum StageEvent<'a> {
    /// Progress of the static solution of a stage; many times in a stage.
    Progress {
        /// Name of the stage.
        stage: &'a str,
        /// Progress of its static solution.
        progress: StaticProgress,
    },
    /// A stage has reached static equilibrium; its results can be written. Once for each stage.
    Equilibrated {
        /// The model in static equilibrium.
        model: &'a dyn EngineModel,
        /// Report of the stage.
        report: &'a StageReport,
    },
}

/// Failure of a construction stage.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StageError {
    /// An element to be excavated that is absent, or to be cast that is active and not excavated in the same stage.
    #[error("stage '{stage}': element {element} is to be {what}")]
    Elements {
        /// Name of the stage.
        stage: String,
        /// Number of the element.
        element: u64,
        /// The intended change and the conflicting state, in words.
        what: &'static str,
    },
    /// A model of a stage that cannot be built.
    #[error("stage '{stage}': {source}")]
    Model {
        /// Name of the stage.
        stage: String,
        /// Cause of the failure.
        source: ModelError,
    },
    /// A body that does not reach static equilibrium, or whose solution was cancelled ([`StaticError::Interrupted`]).
    #[error("stage '{stage}': {source}")]
    NotEquilibrated {
        /// Name of the stage.
        stage: String,
        /// Cause of the failure.
        source: StaticError,
    },
}

/// The final state and the reports of a sequence of stages, see [`Engine::run_stages`].
pub(crate) fn run_stages<E: Engine + ?Sized>(
    engine: &E,
    mesh: &Mesh,
    first: State,
    stages: &[Stage],
    watch: &mut (dyn FnMut(StageEvent) + Send),
) -> Result<(State, Vec<StageReport>), StageError> {
    let nodes = mesh.node_count();
    let mut state = first;
    let mut reports = Vec::new();
    for stage in stages {
        let before = state.displacement.clone();
        let mut model = stage.model(engine, mesh, state.next_stage(nodes))?;
        let name = stage.name.as_str();
        let mut progress = |progress| {
            watch(StageEvent::Progress {
                stage: name,
                progress,
            });
        };
        let solution = match model.statics() {
            Some(statics) => statics.equilibrate(&stage.options, &mut progress),
            None => Err(StaticError::NoMethod {
                engine: engine.name().into(),
                method: stage.options.method.name(),
            }),
        };
        let solution = solution.map_err(|source| StageError::NotEquilibrated {
            stage: stage.name.clone(),
            source,
        })?;
        let stateful = model.stateful().ok_or_else(|| StageError::Model {
            stage: stage.name.clone(),
            source: ModelError::lacking("states"),
        })?;
        state = stateful.state();
        let moved = state.displacement.iter().zip(&before);
        let moved = moved.take(nodes).map(|(now, before)| (now - before).norm());
        let farthest = moved.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        let (node, size) = farthest.unwrap_or_default();
        let report = StageReport {
            name: stage.name.clone(),
            excavated: stage.excavated.len(),
            cast: stage.cast.len(),
            solution,
            largest_displacement: (size, mesh.node_tags().get(node).copied().unwrap_or(0)),
            hourglass: model
                .output()
                .map_or_else(Vec::new, |output| output.hourglass_shares()),
        };
        watch(StageEvent::Equilibrated {
            model: &*model,
            report: &report,
        });
        reports.push(report);
    }
    Ok((state.next_stage(nodes), reports))
}
