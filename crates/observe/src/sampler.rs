//! Quantities of a program's own in histories.

use core::fmt;
use std::sync::Arc;

use powerhouse_model::{Fields, ModelError, Reach, Selection, StepView};

/// Quantity of a program's own, such as the shear stress of a fault or the drift of a storey, computed from the state of
/// the body at each sample of the [histories](crate::History).
///
/// It has no state, so that a resumed run goes on with it.
///
/// ```
/// use powerhouse_observe::{History, HistorySampler};
/// use powerhouse_model::{Cadence, Mesh, ModelError, Reach, Selection, StepView, Vec3};
/// use std::sync::Arc;
/// /// Greatest speed among some nodes.
/// struct Fastest(Vec<u32>);
/// impl HistorySampler for Fastest {
///     fn columns(&self) -> Vec<(String, &'static str)> {
///         vec![("speed".into(), "m/s")]
///     }
///     fn reach(&self) -> Reach {
///         Reach::NONE.with_nodes(Selection::These(self.0.clone()))
///     }
///     fn sample(&self, view: &dyn StepView, row: &mut Vec<f64>) -> Result<(), ModelError> {
///         let speeds = self.0.iter().map(|&node| view.velocity(node).norm());
///         row.push(speeds.fold(0.0, f64::max));
///         Ok(())
///     }
/// }
/// let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(10.0), [2, 2, 2], "rock")?;
/// let history = History::builder(Cadence::Seconds(0.01))
///     .sampled("corners", Arc::new(Fastest(vec![0, 26])))
///     .build(&mesh)?;
/// assert_eq!(history.recording().read(|table| table.columns[0].name.clone()), "corners.speed");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait HistorySampler: Send + Sync {
    /// Names of the columns, to follow that of the request, and their units; the same throughout a run.
    fn columns(&self) -> Vec<(String, &'static str)>;
    /// Fields that it reads beside displacement and velocity; none by default.
    fn fields(&self) -> Fields {
        Fields::default()
    }
    /// Nodes, elements and other parts of the body that it reads.
    fn reach(&self) -> Reach;
    /// Appends the values of all columns, in their order, to a row.
    ///
    /// # Errors
    /// Any error, which fails the run.
    fn sample(&self, view: &dyn StepView, row: &mut Vec<f64>) -> Result<(), ModelError>;
}

/// A shared sampler.
#[derive(Clone)]
pub(super) struct Sampled(pub(super) Arc<dyn HistorySampler>);

impl fmt::Debug for Sampled {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_list().entries(self.0.columns()).finish()
    }
}

/// What two observers read together.
pub(super) fn reach_of_both(one: Reach, other: Reach) -> Reach {
    let both = |one, other| match (one, other) {
        (Selection::These(mut one), Selection::These(other)) => {
            one.extend(other);
            Selection::These(one)
        }
        _ => Selection::All,
    };
    let mut all = one;
    all.nodes = both(all.nodes, other.nodes);
    all.elements = both(all.elements, other.elements);
    all.variables.extend(other.variables);
    all.element_forces |= other.element_forces;
    all.embedded |= other.embedded;
    all.joints |= other.joints;
    all
}
