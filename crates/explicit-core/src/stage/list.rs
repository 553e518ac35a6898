//! Stages one after another.

use powerhouse_model::{Mesh, ModelError, Renewal, State};
use thiserror::Error;

use crate::{
    HourglassShare, Model, ModelBuilder, StaticError, StaticOptions, StaticProgress, StaticReport,
};

/// Makes the model of a stage of a builder that knows the mesh and the state.
pub type StageModel<'a> = dyn Fn(ModelBuilder<'_>) -> Result<ModelBuilder<'_>, ModelError> + 'a;

/// What is done to a body until it is at rest again: elements taken out or put in, and a model of
/// what the body is then made of and what acts on it.
///
/// Each stage says all of it, materials, supports, loads, joints and bolts, so that anything may
/// change from one to the next; what happened so far comes along in the state. What the changes
/// leave out of balance is released in the increments of the static solution.
pub struct Stage<'a> {
    name: String,
    excavated: Vec<u32>,
    cast: Vec<u32>,
    renewed: Vec<(String, Renewal)>,
    options: StaticOptions,
    build: Box<StageModel<'a>>,
}

impl<'a> Stage<'a> {
    /// A stage with a name for reports, and what its model is made of: the closure is given a
    /// builder that starts from the state of the stage before.
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
    /// The same with elements (mesh indices) taken out first. They bear nothing any more; what they
    /// bore comes on the others in increments, as far as [`StaticOptions::release`] says.
    #[must_use]
    pub fn excavate(mut self, elements: &[u32]) -> Self {
        self.excavated.extend_from_slice(elements);
        self
    }
    /// The same with elements (mesh indices) put in first, free of stress in the deformed body.
    #[must_use]
    pub fn cast(mut self, elements: &[u32]) -> Self {
        self.cast.extend_from_slice(elements);
        self
    }
    /// The same with joints (by name) that start anew at the displacement that the body has: grouted, or
    /// released from a tie. Their state before is dropped; opening and slip count from here.
    /// Joints that the stage lacks start anew when a later one has them.
    #[must_use]
    pub fn renew_joints<N: Into<String>>(
        mut self,
        joints: impl IntoIterator<Item = (N, Renewal)>,
    ) -> Self {
        let named = joints.into_iter().map(|(name, how)| (name.into(), how));
        self.renewed.extend(named);
        self
    }
    /// The same with other options of the static solution.
    #[must_use]
    pub fn options(mut self, options: StaticOptions) -> Self {
        self.options = options;
        self
    }
    /// The stage's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The model of the stage, before it comes to rest.
    fn model(&self, mesh: &Mesh, mut state: State) -> Result<Model, StageError> {
        let mut absent = vec![false; mesh.element_count()];
        for &element in &state.absent {
            if let Some(place) = absent.get_mut(element as usize) {
                *place = true;
            }
        }
        for (elements, wanted, what) in [
            (&self.excavated, false, "excavated, but is not there"),
            (&self.cast, true, "cast, but is there already"),
        ] {
            // An element may be excavated and cast in one stage: its place is filled anew.
            let replaced = |element: &u32| wanted && self.excavated.contains(element);
            let odd = |e: &&u32| absent.get(**e as usize) != Some(&wanted) && !replaced(e);
            if let Some(&element) = elements.iter().find(odd) {
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

/// What a stage took and did.
#[derive(Clone, Debug, PartialEq)]
pub struct StageReport {
    /// The stage's name.
    pub name: String,
    /// Elements that were taken out.
    pub excavated: usize,
    /// Elements that were put in.
    pub cast: usize,
    /// The static solution.
    pub solution: StaticReport,
    /// The largest displacement of a node in this stage (m), and the node's number.
    pub largest_displacement: (f64, u64),
    /// What hourglass resistance holds of the internal work of each set at its end.
    pub hourglass: Vec<HourglassShare>,
}

/// What is shown of stages on their way.
#[derive(Debug)]
#[non_exhaustive]
pub enum StageEvent<'a> {
    /// The static solution goes on.
    Progress {
        /// The stage's name.
        stage: &'a str,
        /// How far it is.
        progress: StaticProgress,
    },
    /// A stage has come to rest: the place to write its results.
    AtRest {
        /// The body.
        model: &'a Model,
        /// What the stage took and did.
        report: &'a StageReport,
    },
}

/// A stage that cannot be done.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StageError {
    /// An element that is to go but is gone, or that is to come but is there.
    #[error("stage '{stage}': element {element} is to be {what}")]
    Elements {
        /// The stage.
        stage: String,
        /// The element's number.
        element: u64,
        /// What is wrong with it.
        what: &'static str,
    },
    /// A model that is refused.
    #[error("stage '{stage}': {source}")]
    Model {
        /// The stage.
        stage: String,
        /// Why.
        source: ModelError,
    },
    /// A body that does not come to rest.
    #[error("stage '{stage}': {source}")]
    Rest {
        /// The stage.
        stage: String,
        /// Why.
        source: StaticError,
    },
}

/// Brings a body through stages, from a first state, such as one of
/// [`State::at_rest`] with an initial stress; yields the state in the end, from which a dynamic
/// model [starts](ModelBuilder::start) and is [handed over](Model::hand_over), and a report of each
/// stage.
///
/// A column of rock under its weight loses its upper half:
/// ```
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
/// // It rises by the weight of four metres of rock over four metres.
/// let risen = 2750.0 * 9.81 * 4.0 * 4.0 / 9.0e9;
/// assert!((reports[1].largest_displacement.0 / risen - 1.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The first stage that cannot be done, see [`StageError`].
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
            .map_err(|source| StageError::Rest {
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
        watch(StageEvent::AtRest {
            model: &model,
            report: &report,
        });
        reports.push(report);
    }
    Ok((state.next_stage(nodes), reports))
}
