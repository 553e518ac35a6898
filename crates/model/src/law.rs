//! What a material does: stress from strain and history.

use std::sync::Arc;

use crate::{ElasticMedium, Lane, Strain, Stress};

/// One named number that a law keeps at every integration point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HistoryVariable {
    /// The name in results, such as `equivalent_plastic_strain_tension`.
    pub name: &'static str,
    /// Its unit, `1` if it has none.
    pub unit: &'static str,
}

/// What a law is told. Later fields do not break laws.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct LawInput<'a, L: Lane> {
    /// Total strain since the reference configuration.
    pub strain: Strain<L>,
    /// The initial stress (Pa) at zero strain.
    pub initial: Stress<L>,
    /// The committed history, in the order of [`ConstitutiveLaw::history`].
    pub history: &'a [L],
    /// The width of the element that a crack band runs through (m).
    pub size: L,
}

impl<'a, L: Lane> LawInput<'a, L> {
    /// An input without initial stress and of unit size.
    #[inline(always)]
    pub fn new(strain: Strain<L>, history: &'a [L]) -> Self {
        let token = strain.0[0].token();
        Self {
            strain,
            initial: Stress::zero(token),
            history,
            size: L::splat(token, 1.0),
        }
    }
    /// The same with an initial stress (Pa).
    #[inline(always)]
    #[must_use]
    pub fn with_initial(mut self, initial: Stress<L>) -> Self {
        self.initial = initial;
        self
    }
    /// The same with a crack band width (m).
    #[inline(always)]
    #[must_use]
    pub fn with_size(mut self, size: L) -> Self {
        self.size = size;
        self
    }
}

/// A constitutive law, generic over the lane: a pure map from old history and strain to new
/// history and stress.
///
/// The law never commits: the caller decides whether the new history becomes the old one, so
/// that a static solver can try a strain and take it back. It returns the *change* of stress
/// against [`LawInput::initial`]: an initial stress of megapascals does not eat the digits of a
/// small wave, in single precision least of all.
///
/// A linear law without history:
/// ```
/// use powerhouse_model::{ConstitutiveLaw, ElasticMedium, HistoryVariable, Lane, LawInput, Strain, Stress};
///
/// #[derive(Clone)]
/// struct Linear(ElasticMedium);
///
/// impl ConstitutiveLaw for Linear {
///     const LINEAR: bool = true;
///     fn name(&self) -> &str { "linear" }
///     fn medium(&self) -> ElasticMedium { self.0 }
///     fn history(&self) -> &'static [HistoryVariable] { &[] }
///     fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
///         let one = input.strain.0[0].constant(1.0);
///         Stress::elastic(one.constant(self.0.lambda()), one.constant(self.0.shear()), &input.strain)
///     }
/// }
///
/// let law = Linear(ElasticMedium::new(2.5, 0.25, 1.0)?);
/// let strain = Strain([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
/// assert_eq!(law.stress_change(&LawInput::new(strain, &[]), &mut []).0[0], 3.0);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
pub trait ConstitutiveLaw: Clone + Send + Sync + 'static {
    /// Whether the change of stress is always `lambda tr(e) I + 2 G e` of
    /// [`medium`](Self::medium); engines then use closed forms and never ask the law.
    const LINEAR: bool = false;

    /// The law's name in reports.
    fn name(&self) -> &str;
    /// The elastic medium of the undamaged material.
    fn medium(&self) -> ElasticMedium;
    /// The history variables at a point, all zero at the start.
    fn history(&self) -> &'static [HistoryVariable];
    /// The change of stress (Pa) against the initial stress; writes the new history.
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L>;
    /// Whether the law is [`LINEAR`](Self::LINEAR).
    fn is_linear(&self) -> bool {
        Self::LINEAR
    }
    /// The tangent `d stress / d strain` (Pa, 6 x 6, rows of stress) at a point, if the law offers
    /// one.
    fn tangent(&self, _input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        None
    }
}

/// A constitutive law for one point in double precision, object-safe: a user's first law.
///
/// [`PointAdapter`] makes a [`ConstitutiveLaw`] of it, lane by lane and slower.
/// ```
/// use powerhouse_model::{ElasticMedium, HistoryVariable, LawInput, PointLaw, Stress};
///
/// struct NoTension(ElasticMedium);
/// impl PointLaw for NoTension {
///     fn name(&self) -> &str { "no-tension" }
///     fn medium(&self) -> ElasticMedium { self.0 }
///     fn history(&self) -> &'static [HistoryVariable] { &[] }
///     fn stress_change(&self, input: &LawInput<f64>, _new: &mut [f64]) -> Stress {
///         let stress = Stress::elastic(self.0.lambda(), self.0.shear(), &input.strain);
///         if stress.mean() > 0.0 { Stress([0.0; 6]) } else { stress }
///     }
/// }
/// ```
pub trait PointLaw: Send + Sync {
    /// The law's name in reports.
    fn name(&self) -> &str;
    /// The elastic medium of the undamaged material.
    fn medium(&self) -> ElasticMedium;
    /// The history variables at a point, all zero at the start.
    fn history(&self) -> &'static [HistoryVariable];
    /// The change of stress (Pa) against the initial stress; writes the new history.
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress;
}

/// Runs a [`PointLaw`] behind the socket of a [`ConstitutiveLaw`].
#[derive(Clone)]
pub struct PointAdapter(Arc<dyn PointLaw>);

impl PointAdapter {
    /// Wraps a law for one point.
    pub fn new(law: impl PointLaw + 'static) -> Self {
        Self(Arc::new(law))
    }
}

impl core::fmt::Debug for PointAdapter {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "PointAdapter({})", self.0.name())
    }
}

impl ConstitutiveLaw for PointAdapter {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn medium(&self) -> ElasticMedium {
        self.0.medium()
    }
    fn history(&self) -> &'static [HistoryVariable] {
        self.0.history()
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let token = input.strain.0[0].token();
        let count = input.history.len();
        let mut stress = [[0.0; 6]; 64];
        let mut history = vec![0.0; L::WIDTH * count];
        assert!(L::WIDTH <= stress.len(), "a lane has at most 64 numbers");
        for lane in 0..L::WIDTH {
            let old: Vec<f64> = input.history.iter().map(|h| h.extract(lane)).collect();
            let point = LawInput {
                strain: Strain(input.strain.0.map(|x| x.extract(lane))),
                initial: Stress(input.initial.0.map(|x| x.extract(lane))),
                history: &old,
                size: input.size.extract(lane),
            };
            let new = &mut history[lane * count..(lane + 1) * count];
            stress[lane] = self.0.stress_change(&point, new).0;
        }
        for (i, value) in new_history.iter_mut().enumerate() {
            *value = L::build(token, |lane| history[lane * count + i]);
        }
        Stress(core::array::from_fn(|i| {
            L::build(token, |lane| stress[lane][i])
        }))
    }
}
