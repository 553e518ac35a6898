//! Sequences of construction stages.

use powerhouse_model::{Mesh, ModelError, Renewal, State};
use thiserror::Error;

use crate::{
    HourglassShare, Model, ModelBuilder, StaticError, StaticOptions, StaticProgress, StaticReport,
};

/// A function that completes the builder of a stage's model; the builder has the mesh and the initial state.
pub type StageModel<'a> = dyn Fn(ModelBuilder<'_>) -> Result<ModelBuilder<'_>, ModelError> + 'a;

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
    /// A stage with a name for reports and a function that completes its model, from a
    /// builder that starts with the state of the stage before.
    pub fn new(
        name: impl Into<String>,
        build: impl Fn(ModelBuilder<'_>) -> Result<ModelBuilder<'_>, ModelError> + 'a,
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
    fn model(&self, mesh: &Mesh, mut state: State) -> Result<Model, StageError> {
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
        let built = (self.build)(Model::builder(mesh).start(state));
        let built = built.and_then(ModelBuilder::build);
        let mut model = built.map_err(|source| StageError::Model {
            stage: self.name.clone(),
            source,
        })?;
        for (joint, renewal) in &self.renewed {
            model.renew_joint(joint, *renewal);
        }
        Ok(model)
    }
}

/// Report of a construction stage.
#[derive(Clone, Debug, PartialEq)]
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

/// Event in the solution of stages, passed to the callback of [`run_stages`].
#[derive(Debug)]
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
        model: &'a Model,
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

/// Solves a sequence of construction stages from an initial state, such as
/// [`State::at_rest`] with an initial stress; returns the final state, from which a dynamic
/// model [starts](ModelBuilder::start) with [`Model::hand_over`], and a report of each
/// stage.
///
/// A column of rock under its weight loses its upper half:
/// ```
/// use powerhouse_elements::{Hex8OnePoint, solid};
/// use powerhouse_explicit_core::*;
/// use powerhouse_model::*;
/// # #[derive(Clone)]
/// # struct Linear(ElasticMedium);
/// # impl ConstitutiveLaw for Linear {
/// #     const LINEAR: bool = true;
/// #     fn name(&self) -> &str { "linear" }
/// #     fn medium(&self) -> ElasticMedium { self.0 }
/// #     fn history(&self) -> &'static [HistoryVariable] { &[] }
/// #     fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
/// #         let one = input.strain.0[0].constant(1.0);
/// #         Stress::elastic(one.constant(self.0.lambda()), one.constant(self.0.shear()), &input.strain)
/// #     }
/// # }
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::new(1.0, 1.0, 8.0), [1, 1, 8], "rock")?;
/// let upper = mesh.elements_in_box(&Vec3::new(0.0, 0.0, 4.0), &Vec3::new(1.0, 1.0, 8.0));
/// let law = Linear(ElasticMedium::new(9.0e9, 0.0, 2750.0)?);
/// let bottom = mesh.nodes_of_facets(mesh.facet_set("bottom")?);
/// let body: Box<StageModel> = Box::new(|builder| {
///     let rock = solid("rock", Hex8OnePoint::default(), law.clone(), BlockOptions::default());
///     Ok(builder.elements("rock", rock)
///         .support(Support::fixed(bottom.clone()))
///         .gravity(Vec3::new(0.0, 0.0, -9.81), Box::new(|_: f64| 1.0)))
/// });
/// let stages = [
///     Stage::new("weight", &body),
///     Stage::new("excavation", &body).excavate(&upper),
/// ];
/// let first = State::at_rest(mesh.node_count());
/// let (state, reports) = run_stages(&mesh, first, &stages, &mut |_| {})?;
/// assert_eq!((state.absent.len(), reports[1].excavated), (4, 4));
/// // Heave by the removed weight of four metres of rock over the four metres that remain.
/// let risen = 2750.0 * 9.81 * 4.0 * 4.0 / 9.0e9;
/// assert!((reports[1].largest_displacement.0 / risen - 1.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The error of the first stage that fails, see [`StageError`].
pub fn run_stages(
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
        let mut model = stage.model(mesh, state.next_stage(nodes))?;
        let name = stage.name.as_str();
        let mut progress = |progress| {
            watch(StageEvent::Progress {
                stage: name,
                progress,
            });
        };
        let solution = model
            .equilibrate(&stage.options, &mut progress)
            .map_err(|source| StageError::NotEquilibrated {
                stage: stage.name.clone(),
                source,
            })?;
        state = model.state();
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
            hourglass: model.hourglass_shares(),
        };
        watch(StageEvent::Equilibrated {
            model: &model,
            report: &report,
        });
        reports.push(report);
    }
    Ok((state.next_stage(nodes), reports))
}
