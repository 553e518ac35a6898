//! Constitutive laws for all integration points of an element block at once.

use crate::{ElasticMedium, Extents, HistoryVariable, ModelError, Strain, Stress};

/// Input of a [`BlockLaw`]: some integration points of an element block, in the same order in every list.
///
/// Fields may be added.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct BlockLawInput<'a> {
    /// Total strain since the reference configuration (1), engineering shears.
    pub strains: &'a [Strain],
    /// Initial stress (Pa), the stress at zero strain.
    pub initial: &'a [Stress],
    /// Committed history variables, in the order of [`BlockLaw::history`], those of a point after those of the one before.
    pub history: &'a [f64],
    /// Widths of the element of each point in all directions (m).
    pub extents: &'a [Extents<f64>],
    /// Positions in the reference configuration (m); empty unless the law [uses locations](BlockLaw::uses_location).
    pub positions: &'a [[f64; 3]],
    /// The user's number of the element of each point; empty likewise.
    pub elements: &'a [u64],
}

impl<'a> BlockLawInput<'a> {
    /// Input of points with strains, initial stresses (Pa), committed history variables and widths (m), without locations.
    ///
    /// # Panics
    /// If the lists are not of as many points.
    pub fn new(
        strains: &'a [Strain],
        initial: &'a [Stress],
        history: &'a [f64],
        extents: &'a [Extents<f64>],
    ) -> Self {
        let points = strains.len();
        let alike = initial.len() == points && extents.len() == points;
        assert!(
            alike && history.len().checked_rem(points).unwrap_or(0) == 0,
            "every list is of {points} points"
        );
        Self {
            strains,
            initial,
            history,
            extents,
            positions: &[],
            elements: &[],
        }
    }
    /// The same with positions (m) and the user's element numbers of the points.
    ///
    /// # Panics
    /// If the lists are not of as many points.
    #[must_use]
    pub fn with_locations(mut self, positions: &'a [[f64; 3]], elements: &'a [u64]) -> Self {
        let points = self.strains.len();
        assert!(
            positions.len() == points && elements.len() == points,
            "every list is of {points} points"
        );
        (self.positions, self.elements) = (positions, elements);
        self
    }
    /// Number of points.
    pub fn len(&self) -> usize {
        self.strains.len()
    }
    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.strains.is_empty()
    }
    /// Committed history variables of a point, in the order of [`BlockLaw::history`].
    ///
    /// # Panics
    /// If there is no such point.
    pub fn history_of(&self, point: usize) -> &'a [f64] {
        let variables = self.history.len() / self.strains.len();
        &self.history[point * variables..][..variables]
    }
}

/// A constitutive law for many integration points at once in double precision, object-safe: for laws whose call is costly
/// whatever the number of points, such as those of another language or of a table in another process.
///
/// The law is a pure function of each point, as [`PointLaw`](crate::PointLaw) is, and equal for a point whatever the others
/// are. In forces of a step or of a static state it is evaluated once for all points of an element block, from several
/// threads at once, one for a block; the last batch of a block repeats points of its last element, and elements that are
/// not active are among them. For stresses of single elements, as section forces need them, it is evaluated for one point.
///
/// Compared with a [`ConstitutiveLaw`](crate::ConstitutiveLaw) it lacks energies of its own (elastic unloading is stored,
/// all else is plastic dissipation), plastic strain for the histories of element kernels, an elastic domain, and a tangent:
/// static solutions iterate with the stiffness of the medium.
///
/// ```
/// use powerhouse_model::{BlockLaw, BlockLawInput, ElasticMedium, Extents, HistoryVariable, Strain, Stress};
///
/// struct NoTension(ElasticMedium);
/// impl BlockLaw for NoTension {
///     fn name(&self) -> &str { "no-tension" }
///     fn medium(&self) -> ElasticMedium { self.0 }
///     fn history(&self) -> &[HistoryVariable] { &[] }
///     fn stress_changes(&self, points: &BlockLawInput, stresses: &mut [Stress], _new_history: &mut [f64]) {
///         for (strain, stress) in points.strains.iter().zip(stresses) {
///             let elastic = Stress::elastic(self.0.lambda(), self.0.shear(), strain);
///             *stress = if elastic.mean() > 0.0 { Stress([0.0; 6]) } else { elastic };
///         }
///     }
/// }
///
/// let law = NoTension(ElasticMedium::new(2.5, 0.25, 1.0)?);
/// let strains = [Strain([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0]), Strain([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])];
/// let (initial, widths) = ([Stress([0.0; 6]); 2], [Extents::uniform(1.0); 2]);
/// let mut stresses = initial;
/// law.stress_changes(&BlockLawInput::new(&strains, &initial, &[], &widths), &mut stresses, &mut []);
/// assert_eq!((stresses[0].0[0], stresses[1].0[0]), (-3.0, 0.0));
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
pub trait BlockLaw: Send + Sync {
    /// The law's name in reports.
    fn name(&self) -> &str;
    /// The elastic medium of the undamaged material, as [`ConstitutiveLaw::medium`](crate::ConstitutiveLaw::medium): of a
    /// stiffness that varies in space the stiffest.
    fn medium(&self) -> ElasticMedium;
    /// The history variables of an integration point, all zero at the start.
    fn history(&self) -> &[HistoryVariable];
    /// Whether the law reads [`BlockLawInput::positions`] or [`BlockLawInput::elements`]; false by default.
    fn uses_location(&self) -> bool {
        false
    }
    /// The changes of stress (Pa) of the points against their initial stress; writes every stress and every new history
    /// variable, whose order is that of [`BlockLawInput::history`].
    ///
    /// What both lists hold before the call has no meaning. A law that fails, such as one in another process, writes
    /// stresses that are not finite, which end the run at its step.
    fn stress_changes(
        &self,
        points: &BlockLawInput,
        stresses: &mut [Stress],
        new_history: &mut [f64],
    );
    /// Checks a width of an element (m), as [`ConstitutiveLaw::accept_size`](crate::ConstitutiveLaw::accept_size); every
    /// width is accepted by default.
    ///
    /// # Errors
    /// The reason of a refusal.
    fn accept_size(&self, _size: f64) -> Result<(), ModelError> {
        Ok(())
    }
}
