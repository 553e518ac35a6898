//! Constitutive laws for one integration point.

use std::sync::Arc;

use crate::{
    ConstitutiveLaw, ElasticMedium, Extents, HistoryVariable, Lane, LawEnergy, LawInput,
    ModelError, Strain, Stress,
};

/// A constitutive law for one integration point in double precision, object-safe: the simplest way to
/// write a law.
///
/// [`PointAdapter`] makes a [`ConstitutiveLaw`] of it, which is evaluated lane by lane and slower. As there, the law is a
/// pure function of its input, evaluated at every integration point and step from several threads at once, in static
/// solutions many times with trial strains; the caller keeps the history variables.
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
    /// The elastic medium of the undamaged material, as [`ConstitutiveLaw::medium`]: mass, stable step, stiffness
    /// damping and hourglass stiffness follow from it; of a stiffness that varies in space the stiffest.
    fn medium(&self) -> ElasticMedium;
    /// The history variables of an integration point, all zero at the start.
    fn history(&self) -> &[HistoryVariable];
    /// Whether the law reads [`LawInput::position`] or [`LawInput::elements`], as
    /// [`ConstitutiveLaw::uses_location`]; false by default.
    fn uses_location(&self) -> bool {
        false
    }
    /// The change of stress (Pa) against the initial stress, as [`ConstitutiveLaw::stress_change`]; writes
    /// every new history variable.
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress;
    /// Energy density (J/m3) after a step, as [`ConstitutiveLaw::energy`]; none by default.
    fn energy(&self, _input: &LawInput<f64>, _new_history: &[f64]) -> Option<LawEnergy<f64>> {
        None
    }
    /// Checks a width of an element (m), as [`ConstitutiveLaw::accept_size`]; every width is accepted by
    /// default.
    ///
    /// # Errors
    /// The reason of a refusal.
    fn accept_size(&self, _size: f64) -> Result<(), ModelError> {
        Ok(())
    }
}

/// A [`ConstitutiveLaw`] that evaluates a [`PointLaw`] lane by lane in double precision.
#[derive(Clone)]
pub struct PointAdapter(Arc<dyn PointLaw>);

impl PointAdapter {
    /// A law for lanes from a law for one integration point.
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
    fn history(&self) -> &[HistoryVariable] {
        self.0.history()
    }
    fn uses_location(&self) -> bool {
        self.0.uses_location()
    }
    fn is_in_lanes(&self) -> bool {
        false
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let token = input.strain.0[0].token();
        let count = input.history.len();
        let mut stress = [[0.0; 6]; MOST_LANES];
        let mut history = vec![0.0; L::WIDTH * count];
        assert!(L::WIDTH <= MOST_LANES, "a lane has at most 64 numbers");
        for lane in 0..L::WIDTH {
            let new = &mut history[lane * count..(lane + 1) * count];
            stress[lane] = at_lane(input, lane, |point| self.0.stress_change(point, new)).0;
        }
        for (i, value) in new_history.iter_mut().enumerate() {
            *value = L::build(token, |lane| history[lane * count + i]);
        }
        Stress(core::array::from_fn(|i| {
            L::build(token, |lane| stress[lane][i])
        }))
    }
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        let token = input.strain.0[0].token();
        let mut numbers = [[0.0; 4]; MOST_LANES];
        assert!(L::WIDTH <= MOST_LANES, "a lane has at most 64 numbers");
        for lane in 0..L::WIDTH {
            let new: Vec<f64> = new_history.iter().map(|h| h.extract(lane)).collect();
            let energy = at_lane(input, lane, |point| self.0.energy(point, &new))?;
            let LawEnergy {
                stored,
                plastic,
                damage,
                recovered,
            } = energy;
            numbers[lane] = [stored, plastic, damage, recovered];
        }
        let [stored, plastic, damage, recovered] =
            core::array::from_fn(|i| L::build(token, |lane| numbers[lane][i]));
        Some(LawEnergy {
            stored,
            plastic,
            damage,
            recovered,
        })
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        self.0.accept_size(size)
    }
}

/// An upper bound on the width of lanes.
const MOST_LANES: usize = 64;

/// Calls a function with one lane of an input.
fn at_lane<L: Lane, T>(
    input: &LawInput<L>,
    lane: usize,
    evaluate: impl FnOnce(&LawInput<f64>) -> T,
) -> T {
    let old: Vec<f64> = input.history.iter().map(|h| h.extract(lane)).collect();
    let location = input.location().map(|location| location.of_lane(lane));
    let strain = Strain(input.strain.0.map(|x| x.extract(lane)));
    let point = LawInput::new(strain, &old)
        .with_initial(Stress(input.initial.0.map(|x| x.extract(lane))))
        .with_extents(Extents(input.extents.0.map(|x| x.extract(lane))));
    evaluate(&match &location {
        Some(location) => point.with_location(location),
        None => point,
    })
}
