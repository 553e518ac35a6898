//! Elastic, perfectly plastic law of a yield surface.

use powerhouse_model::{
    ConstitutiveLaw, ElasticDomain, ElasticMedium, HistoryVariable, Lane, LawEnergy, LawInput,
    RemainingStiffness, Stress, array,
};

use crate::energy;
use crate::history::{self, PLASTIC_STRAINS, number};
use crate::remaining;
use crate::surface::{Flow, YieldSurface};
use crate::{ElasticInSeries, tangent};

const EQUIVALENT: usize = 6;
const YIELD_STATE: usize = 7;
const HISTORY: [HistoryVariable; 8] = {
    let [xx, yy, zz, xy, yz, zx] = PLASTIC_STRAINS;
    [
        xx,
        yy,
        zz,
        xy,
        yz,
        zx,
        number("equivalent_plastic_strain"),
        history::YIELD_STATE,
    ]
};

/// Elastic, perfectly plastic law of a yield surface.
///
/// `sigma = sigma0 + C (epsilon - epsilon_p)`, and the flow of a step is the implicit one of the
/// surface: the stress is admissible at the end of every step, however large.
///
/// History: the plastic strain (six components, engineering shears), the equivalent plastic
/// strain, the sum of `sqrt(2/3 de_p : de_p)`, and the [`YieldState`](crate::YieldState) of the
/// last step. An initial stress outside the surface is returned to it in the first step.
///
/// [`tangent`](ConstitutiveLaw::tangent) is the consistent tangent, the derivative of the return; at a
/// kink it is that of one side.
///
/// A strain that is not finite, or whose stress is outside the range of numbers, gives a stress
/// that is not finite, for which the engine and the [driver](crate::PointDriver) return an error.
///
/// ```
/// use powerhouse_material_damage::{ElastoPlastic, MohrCoulomb, presets};
/// use powerhouse_model::{ConstitutiveLaw, LawInput, Strain};
///
/// let rock = ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK)?);
/// let strain = Strain([1.0e-3, 0.0, -1.0e-3, 0.0, 0.0, 0.0]);
/// let (old, mut new) = ([0.0; 8], [0.0; 8]);
/// let stress = rock.stress_change(&LawInput::new(strain, &old), &mut new);
/// assert!(new[6] > 0.0, "the point has yielded");
/// assert!(stress.0[0] - stress.0[2] < 4.0e-3 * presets::PAPER_ROCK.medium.shear());
/// # Ok::<(), powerhouse_material_damage::MaterialError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElastoPlastic<S> {
    surface: S,
    lambda: f64,
    shear: f64,
}

impl<S: YieldSurface> ElastoPlastic<S> {
    /// Law of the given yield surface.
    pub fn new(surface: S) -> Self {
        let medium = surface.medium();
        Self {
            surface,
            lambda: medium.lambda(),
            shear: medium.shear(),
        }
    }
    /// Yield surface of the law.
    pub fn surface(&self) -> &S {
        &self.surface
    }
}

impl<S: YieldSurface> ConstitutiveLaw for ElastoPlastic<S> {
    fn name(&self) -> &str {
        self.surface.name()
    }
    #[inline]
    fn medium(&self) -> ElasticMedium {
        self.surface.medium()
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &HISTORY
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let old = input.history;
        let first = input.strain.0[0];
        let elastic = energy::difference(&input.strain.0, old);
        let lambda = first.constant(self.lambda);
        let change = Stress::elastic(lambda, first.constant(self.shear), &elastic);
        let trial = input.initial + change;
        let mut now = history::load::<L, { HISTORY.len() }>(old);
        let Some(flow) = Flow::of_trial(&self.surface, &trial) else {
            now[YIELD_STATE] = first.constant(0.0);
            history::store(&now, new_history);
            return change;
        };
        for i in 0..6 {
            now[i] = now[i] + flow.plastic[i];
        }
        now[EQUIVALENT] = now[EQUIVALENT] + flow.equivalent();
        now[YIELD_STATE] = flow.state;
        history::store(&now, new_history);
        flow.stress_change(&change, &input.initial)
    }
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        self.surface.elastic_domain()
    }
    #[inline(always)]
    fn energy<L: Lane>(&self, input: &LawInput<L>, new_history: &[L]) -> Option<LawEnergy<L>> {
        Some(energy::of_flow(&self.surface.medium(), input, new_history))
    }
    #[inline(always)]
    fn remaining_stiffness<L: Lane>(
        &self,
        input: &LawInput<L>,
        new_history: &[L],
        _change: &Stress<L>,
    ) -> RemainingStiffness<L> {
        remaining::of_flow(input, new_history, None)
    }
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        let elastic = energy::difference(&input.strain.0, input.history);
        Some(tangent::of_flow(&self.surface, input, &elastic))
    }
}

impl<S: YieldSurface> ElasticInSeries for ElastoPlastic<S> {
    fn with_stiffness(&self, factor: f64) -> Self {
        Self::new(self.surface.with_stiffness(factor))
    }
    #[inline(always)]
    fn inelastic_strain<L: Lane>(&self, history: &[L]) -> Option<[L; 6]> {
        Some(array(|i| history[i]))
    }
}
