//! Constitutive laws: stress from strain and history variables at an integration point.

use crate::{ElasticDomain, ElasticMedium, Lane, LawInput, ModelError, Stress};

/// Kind of a history variable: how the values at the integration points become one value per element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum HistoryKind {
    /// A scalar amount, such as damage: the element value is the mean over its integration points, an
    /// envelope is the maximum over time.
    Amount,
    /// A component of a tensor: the element value is the mean over its integration points.
    Component,
    /// A whole number whose bits are flags, such as a yield state: the element value has every flag
    /// that is set at one of its integration points.
    Flags,
}

/// History variable (internal state variable) of a constitutive law: name, unit and kind of one number
/// per integration point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct HistoryVariable {
    /// Name in results, such as `equivalent_plastic_strain_tension`.
    pub name: &'static str,
    /// Unit of the values in SI, such as `Pa`; `1` for a dimensionless number.
    pub unit: &'static str,
    /// How element values are formed from values at integration points.
    pub kind: HistoryKind,
}

/// With names that are kept for the life of the process, see [`interned`](crate::interned).
#[cfg(feature = "serde")]
mod encoding {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::{HistoryKind, HistoryVariable};
    use crate::interned;

    impl Serialize for HistoryVariable {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            (self.name, self.unit, self.kind).serialize(serializer)
        }
    }

    impl<'de> Deserialize<'de> for HistoryVariable {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            let (name, unit, kind) = <(String, String, HistoryKind)>::deserialize(deserializer)?;
            Ok(Self {
                name: interned(&name),
                unit: interned(&unit),
                kind,
            })
        }
    }
}

impl HistoryVariable {
    /// A history variable of kind [`HistoryKind::Amount`], with its name and unit.
    pub const fn amount(name: &'static str, unit: &'static str) -> Self {
        Self {
            name,
            unit,
            kind: HistoryKind::Amount,
        }
    }
    /// A history variable of kind [`HistoryKind::Component`], with its name and unit.
    pub const fn component(name: &'static str, unit: &'static str) -> Self {
        Self {
            name,
            unit,
            kind: HistoryKind::Component,
        }
    }
    /// A dimensionless history variable of kind [`HistoryKind::Flags`], with its name.
    pub const fn flags(name: &'static str) -> Self {
        Self {
            name,
            unit: "1",
            kind: HistoryKind::Flags,
        }
    }

    /// The element value of the variable from its values at the integration points of the element.
    ///
    /// ```
    /// use powerhouse_model::HistoryVariable;
    /// let (damage, state) = (HistoryVariable::amount("damage", "1"), HistoryVariable::flags("state"));
    /// assert_eq!(damage.of_element([0.0, 0.5].into_iter()), 0.25);
    /// assert_eq!(state.of_element([1.0, 2.0].into_iter()), 3.0);
    /// ```
    pub fn of_element(&self, points: impl ExactSizeIterator<Item = f64>) -> f64 {
        match self.kind {
            HistoryKind::Flags => f64::from(points.fold(0_u32, |all, flags| all | flags as u32)),
            HistoryKind::Amount | HistoryKind::Component => {
                let count = points.len();
                points.sum::<f64>() / count as f64
            }
        }
    }
}

/// Energy density (J/m3) of an integration point after a step: stored energy, and energy dissipated and
/// recovered in the step.
///
/// With the work `sigma : de` of the *change* of stress, an elastic law with plastic strain `p`
/// and damage `D` has
///
/// `stored = (1 - D) psi(s) - psi(sigma0) - sigma0 : e`, `plastic = (1 - D) s : dp`, `damage =
/// psi(s) dD`
///
/// where `psi(s) = s : C^-1 : s / 2` and `s` is the effective stress, initial stress included.
///
/// ```
/// use powerhouse_model::LawEnergy;
/// let energy = LawEnergy::stored(3.0).with_plastic(1.0);
/// assert_eq!((energy.stored, energy.plastic, energy.damage), (3.0, 1.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LawEnergy<L> {
    /// Stored (recoverable) energy at the end of the step less the work of the initial stress, zero at
    /// the start.
    pub stored: L,
    /// Energy dissipated by plastic flow in the step, not negative.
    pub plastic: L,
    /// Energy dissipated by growth of damage in the step, not negative.
    pub damage: L,
    /// Energy of stiffness that closing cracks regain in the step, not negative.
    pub recovered: L,
}

impl<L: Lane> LawEnergy<L> {
    /// Stored energy (J/m3) of a step without dissipation.
    #[inline(always)]
    pub fn stored(stored: L) -> Self {
        let zero = stored.constant(0.0);
        Self {
            stored,
            plastic: zero,
            damage: zero,
            recovered: zero,
        }
    }
    /// Sets the energy dissipated by plastic flow (J/m3), not negative.
    #[inline(always)]
    #[must_use]
    pub fn with_plastic(mut self, plastic: L) -> Self {
        self.plastic = plastic;
        self
    }
    /// Sets the energy dissipated by growth of damage (J/m3), not negative.
    #[inline(always)]
    #[must_use]
    pub fn with_damage(mut self, damage: L) -> Self {
        self.damage = damage;
        self
    }
    /// Sets the energy of regained stiffness (J/m3), not negative.
    #[inline(always)]
    #[must_use]
    pub fn with_recovered(mut self, recovered: L) -> Self {
        self.recovered = recovered;
        self
    }
}

/// Shares of the elastic stiffness that remain at an integration point after a step of damage and plastic
/// flow, for stiffness damping and hourglass stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RemainingStiffness<L> {
    /// Share that damage leaves, `1 - D`, from 0 to 1. Stiffness damping acts with it and with the elastic
    /// share of the step's strain.
    pub undamaged: L,
    /// Share with which the hourglass stiffness acts in elements that have fewer integration points than
    /// modes, from 0 to 1.
    ///
    /// It must never rise, or hourglass resistance makes energy. It is what damage leaves; plastic flow
    /// leaves all of it: hourglass forces grow with the whole displacement, and a stiffness that falls with
    /// plastic flow softens the element, so that static solutions do not converge, or to different states.
    pub hourglass: L,
    /// Increment of plastic strain in the step, components xx yy zz xy yz zx, engineering shears.
    pub plastic_strain_increment: [L; 6],
}

impl<L: Lane> RemainingStiffness<L> {
    /// The whole elastic stiffness, without plastic flow, in the lanes of any value at hand.
    #[inline(always)]
    pub fn whole(any: L) -> Self {
        let (zero, one) = (any.constant(0.0), any.constant(1.0));
        Self {
            undamaged: one,
            hourglass: one,
            plastic_strain_increment: [zero; 6],
        }
    }
    /// The same with the share of the stiffness that damage leaves, `1 - D`, set to `share`, 0 to 1.
    #[inline(always)]
    #[must_use]
    pub fn with_undamaged(mut self, share: L) -> Self {
        self.undamaged = share;
        self
    }
    /// The same with the share with which the hourglass stiffness acts set to `share`, 0 to 1.
    #[inline(always)]
    #[must_use]
    pub fn with_hourglass(mut self, share: L) -> Self {
        self.hourglass = share;
        self
    }
    /// Sets the plastic strain increment of the step, which stiffness damping leaves out: components xx yy zz xy yz
    /// zx, engineering shears.
    #[inline(always)]
    #[must_use]
    pub fn with_plastic_strain_increment(mut self, increment: [L; 6]) -> Self {
        self.plastic_strain_increment = increment;
        self
    }
}

/// A constitutive law, generic over the lane: a pure map from strain and committed history variables to
/// stress and new history variables.
///
/// The law is evaluated at every integration point and step, from several threads at once, and keeps nothing itself. It
/// never commits: the caller decides whether the new history variables become the committed ones,
/// so that a static solver can evaluate a trial strain and discard it. The law returns the *change* of
/// stress against [`LawInput::initial`], so that an initial stress of megapascals does not round away the
/// stress of a small wave, in single precision least of all.
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
    /// Whether the change of stress is always `lambda tr(e) I + 2 G e` of [`medium`](Self::medium);
    /// engines then use closed forms and never evaluate the law.
    const LINEAR: bool = false;

    /// The law's name in reports.
    fn name(&self) -> &str;
    /// The elastic medium of the undamaged material: mass, stable time step, stiffness damping and
    /// hourglass stiffness follow from it.
    ///
    /// A law whose stiffness varies in space returns its stiffest medium, and one density for all points.
    fn medium(&self) -> ElasticMedium;
    /// The history variables of an integration point, all zero at the start.
    fn history(&self) -> &[HistoryVariable];
    /// Whether the law reads [`LawInput::position`] or [`LawInput::elements`]; false by default.
    ///
    /// Engines store and pass the location of every integration point for laws that return true, and
    /// spend nothing on it for the others.
    ///
    /// A stiffness that grows with depth, in one law for a whole element set:
    /// ```
    /// use powerhouse_model::{ConstitutiveLaw, ElasticMedium, HistoryVariable, Lane, LawInput, PointLocation, Strain, Stress};
    ///
    /// /// Soil with the stiffness of `stiffest` at a depth and below, less above it.
    /// #[derive(Clone)]
    /// struct Graded { stiffest: ElasticMedium, depth: f64 }
    ///
    /// impl ConstitutiveLaw for Graded {
    ///     fn name(&self) -> &str { "graded" }
    ///     fn medium(&self) -> ElasticMedium { self.stiffest }
    ///     fn history(&self) -> &[HistoryVariable] { &[] }
    ///     fn uses_location(&self) -> bool { true }
    ///     #[inline(always)]
    ///     fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
    ///         let [_, _, z] = input.position();
    ///         let share = (z * z.constant(-1.0 / self.depth)).min(z.constant(1.0));
    ///         let (lambda, shear) = (z.constant(self.stiffest.lambda()), z.constant(self.stiffest.shear()));
    ///         Stress::elastic(lambda, shear, &input.strain) * share
    ///     }
    /// }
    ///
    /// let soil = Graded { stiffest: ElasticMedium::new(2.5, 0.25, 1.0)?, depth: 20.0 };
    /// let location = PointLocation::new([0.0, 0.0, -5.0], &[17]);
    /// let input = LawInput::new(Strain([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]), &[]).with_location(&location);
    /// assert_eq!(soil.stress_change(&input, &mut []).0[0], 0.25 * 3.0);
    /// # Ok::<(), powerhouse_model::ParameterError>(())
    /// ```
    fn uses_location(&self) -> bool {
        false
    }
    /// Whether the law computes with lanes alone, so that a [`Program`](crate::Program) of it can be recorded; true by
    /// default. A law that evaluates its points one by one returns false, as [`PointAdapter`](crate::PointAdapter) does, and
    /// so does a law within which there is one.
    fn is_in_lanes(&self) -> bool {
        true
    }
    /// The change of stress (Pa) against the initial stress; writes every new history variable.
    ///
    /// The values that `new_history` holds before the call have no meaning.
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L>;
    /// The law discretised in time for steps of a length (s), for laws that depend on time; the law itself
    /// by default.
    ///
    /// Engines evaluate the result in dynamic steps and commit the history variables at the end of each.
    /// The law itself is the static one, in which nothing relaxes.
    #[must_use]
    fn for_step(&self, _length: f64) -> Self {
        self.clone()
    }
    /// Whether the law is linear elastic, [`LINEAR`](Self::LINEAR).
    fn is_linear(&self) -> bool {
        Self::LINEAR
    }
    /// Energy density (J/m3) after the step to `input` and `new_history`, for the energy balance; none by
    /// default.
    ///
    /// Without it the energy that elastic unloading would return counts as stored, `sigma : C^-1 : sigma / 2`
    /// of the change of stress, and all other work as plastic dissipation. A law returns it always or never.
    #[inline(always)]
    fn energy<L: Lane>(&self, _input: &LawInput<L>, _new_history: &[L]) -> Option<LawEnergy<L>> {
        None
    }
    /// Remaining share of the elastic stiffness after the step to `input` and `new_history`, which ended at a
    /// change of stress (Pa). Engines scale stiffness damping and hourglass stiffness by it.
    ///
    /// By default the share for stiffness damping is the work of the change of stress on the strain over that
    /// of the stress of the undamaged medium, between 0 and 1; hourglass stiffness stays whole, and there is
    /// no plastic strain.
    #[inline(always)]
    fn remaining_stiffness<L: Lane>(
        &self,
        input: &LawInput<L>,
        _new_history: &[L],
        change: &Stress<L>,
    ) -> RemainingStiffness<L> {
        let medium = self.medium();
        let first = input.strain.0[0];
        let (zero, one) = (first.constant(0.0), first.constant(1.0));
        let (lambda, shear) = (medium.lambda(), medium.shear());
        let elastic = Stress::elastic(first.constant(lambda), first.constant(shear), &input.strain);
        let whole = elastic.work(&input.strain);
        let some = zero.less(whole);
        let share = change.work(&input.strain) / whole.select(some, one);
        let share = share.min(one).max(zero).select(some, one);
        RemainingStiffness::whole(first).with_undamaged(share)
    }
    /// Whether the law is viscoelastic: work that [`energy`](Self::energy) does not account for is stored or
    /// dissipated by relaxation mechanisms, and has a column of its own in the energy balance.
    fn relaxes(&self) -> bool {
        false
    }
    /// Whether stored energy is the only [`energy`](Self::energy) of the law, so that nothing is plastic, damaged or recovered.
    ///
    /// Engines then evaluate the energies in steps alone in which the energy balance is read.
    fn only_stores(&self) -> bool {
        false
    }
    /// Checks a width of an element along the normal of a crack (m) before a run; every width is accepted by
    /// default.
    ///
    /// Engines check the greatest and the least width of all directions ([`Extents::principal`](crate::Extents::principal)) of every
    /// element; a law that accepts both accepts all between.
    ///
    /// # Errors
    /// The reason of a refusal, with the permitted widths.
    fn accept_size(&self, _size: f64) -> Result<(), ModelError> {
        Ok(())
    }
    /// Elastic domain of the virgin material: total stresses, initial stress included, that are certainly
    /// elastic as long as all history variables are zero; unknown by default.
    ///
    /// Inside it engines use [`Stress::elastic`] of [`medium`](Self::medium) instead of the law, which must
    /// return the same bits there and leave its history variables zero. For a law that varies in space it is
    /// the elastic domain of the weakest point, and its stiffness must be that of `medium` everywhere.
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        None
    }
    /// Tangent stiffness `d stress / d strain` (Pa, 6 x 6, rows of stress); none by default, where engines
    /// form it by central differences.
    fn tangent(&self, _input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        None
    }
}

/// Change of stress (Pa) at one integration point in double precision, by
/// [`ConstitutiveLaw::stress_change`].
///
/// Laws are inlined where they are evaluated; this function is one compiled copy of a law that all
/// evaluations of single points share.
#[inline(never)]
pub fn point_stress_change<M: ConstitutiveLaw>(
    law: &M,
    input: &LawInput<f64>,
    new_history: &mut [f64],
) -> Stress {
    law.stress_change(input, new_history)
}

/// Energy density (J/m3) at one integration point in double precision, by [`ConstitutiveLaw::energy`];
/// one compiled copy of it, as [`point_stress_change`].
#[inline(never)]
pub fn point_energy<M: ConstitutiveLaw>(
    law: &M,
    input: &LawInput<f64>,
    new_history: &[f64],
) -> Option<LawEnergy<f64>> {
    law.energy(input, new_history)
}
