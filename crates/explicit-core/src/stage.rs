//! Construction stages before the dynamic run.

use powerhouse_model::{Engine, Mesh, Stage, StageError, StageEvent, StageReport, State};

use crate::Explicit;

/// Solves a sequence of construction stages from an initial state, such as
/// [`State::at_rest`] with an initial stress; returns the final state, from which a dynamic
/// model [starts](powerhouse_model::ModelSpec::start) with [`Model::hand_over`](crate::Model::hand_over), and a report of each
/// stage.
///
/// A column of rock under its weight loses its upper half:
/// ```
/// use powerhouse_elements::SolidKernel;
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
///     let rock = SolidKernel::ONE_POINT.factory("rock", law.clone(), BlockOptions::default());
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
    Explicit.run_stages(mesh, first, stages, watch)
}
