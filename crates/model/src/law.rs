//! What a material does: stress from strain and history.

use std::sync::Arc;

use crate::{ElasticDomain, ElasticMedium, Extents, Lane, ModelError, Strain, Stress};

/// How results show a history variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HistoryKind {
    /// An amount, such as damage: elements show the mean over their points, envelopes the greatest.
    Amount,
    /// A component of a tensor: elements show the mean over their points.
    Component,
    /// A whole number whose bits are flags, such as a yield state: elements show every flag that
    /// one of their points has.
    Flags,
}

/// One named number that a law keeps at every integration point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HistoryVariable {
    /// The name in results, such as `equivalent_plastic_strain_tension`.
    pub name: &'static str,
    /// Its unit, `1` if it has none.
    pub unit: &'static str,
    /// How results show it.
    pub kind: HistoryKind,
}

impl HistoryVariable {
    /// An amount.
    pub const fn amount(name: &'static str, unit: &'static str) -> Self {
        Self {
            name,
            unit,
            kind: HistoryKind::Amount,
        }
    }
    /// A component of a tensor.
    pub const fn component(name: &'static str, unit: &'static str) -> Self {
        Self {
            name,
            unit,
            kind: HistoryKind::Component,
        }
    }
    /// A whole number whose bits are flags.
    pub const fn flags(name: &'static str) -> Self {
        Self {
            name,
            unit: "1",
            kind: HistoryKind::Flags,
        }
    }

    /// What an element shows of the values at its points.
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

/// What a point holds, and what the step to its present state cost (J/m3).
///
/// With the work `sigma : de` of the *change* of stress, an elastic law with plastic strain `p`
/// and damage `D` has
///
/// `stored = (1 - D) psi(s) - psi(sigma0) - sigma0 : e`, `plastic = (1 - D) s : dp`, `damage =
/// psi(s) dD`
///
/// where `psi(s) = s : C^-1 : s / 2` and `s` is the effective stress, initial stress included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawEnergy<L> {
    /// Energy that is held, less the work of the initial stress, zero at the start.
    pub stored: L,
    /// Taken by plastic flow in the step, not negative.
    pub plastic: L,
    /// Taken by growing damage in the step, not negative.
    pub damage: L,
    /// Given back in the step, not negative: the energy of stiffness that closing cracks regain.
    pub recovered: L,
}

/// What damage and plastic flow have left of the elastic stiffness at a point after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemainingStiffness<L> {
    /// The share that damage leaves, `1 - D`. With it, and with the elastic share of the step's strain,
    /// acts stiffness damping.
    pub undamaged: L,
    /// The share with which the hourglass stiffness acts of elements that have fewer points than modes: what
    /// damage leaves. It must never rise, or hourglass resistance makes energy. Plastic flow leaves all of it: hourglass forces grow with the whole displacement, and
    /// a stiffness that falls as a point flows softens the element, so that static solutions do not
    /// converge, or to different states.
    pub of_path: L,
    /// The increment of plastic strain in the step, engineering shears.
    pub flowed: [L; 6],
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
    /// How wide the element is in any direction (m): a crack band is as wide as its element along the
    /// normal of the crack, [`Extents::along`].
    pub extents: Extents<L>,
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
            extents: Extents::uniform(L::splat(token, 1.0)),
        }
    }
    /// The same with another strain.
    #[inline(always)]
    #[must_use]
    pub fn with_strain(mut self, strain: Strain<L>) -> Self {
        self.strain = strain;
        self
    }
    /// The same with another history, such as that of a law within a law.
    #[inline(always)]
    #[must_use]
    pub fn with_history(mut self, history: &'a [L]) -> Self {
        self.history = history;
        self
    }
    /// The same with an initial stress (Pa).
    #[inline(always)]
    #[must_use]
    pub fn with_initial(mut self, initial: Stress<L>) -> Self {
        self.initial = initial;
        self
    }
    /// The same in an element that is equally wide in all directions (m).
    #[inline(always)]
    #[must_use]
    pub fn with_size(self, size: L) -> Self {
        self.with_extents(Extents::uniform(size))
    }
    /// The same in an element of other widths.
    #[inline(always)]
    #[must_use]
    pub fn with_extents(mut self, extents: Extents<L>) -> Self {
        self.extents = extents;
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
    fn history(&self) -> &[HistoryVariable];
    /// The change of stress (Pa) against the initial stress; writes the new history, every variable of
    /// it: what a law finds there means nothing.
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L>;
    /// The law in a motion whose steps have a length (s), for laws that depend on time; itself by
    /// default.
    ///
    /// Engines ask the result in every step and commit the history once per step. The law
    /// itself, of which no step was asked for, is the static one: nothing relaxes.
    #[must_use]
    fn for_step(&self, _length: f64) -> Self {
        self.clone()
    }
    /// Whether the law is [`LINEAR`](Self::LINEAR).
    fn is_linear(&self) -> bool {
        Self::LINEAR
    }
    /// What a point holds after the step to `input` and `new_history`, and what that step cost, for
    /// the energy ledger.
    ///
    /// By default the law says nothing: what its medium would give back by unloading elastically
    /// counts as stored, `sigma : C^-1 : sigma / 2` of the change of stress, and all else as plastic.
    /// Laws answer always or never.
    #[inline(always)]
    fn energy<L: Lane>(&self, _input: &LawInput<L>, _new_history: &[L]) -> Option<LawEnergy<L>> {
        None
    }
    /// What the step to `input` and `new_history`, which ended at a change of stress (Pa), has left of
    /// the elastic stiffness. Engines scale with it what they add to the law's stress: stiffness damping
    /// and hourglass stiffness.
    ///
    /// By default stiffness damping has what the change of stress works on the strain over what that of the
    /// undamaged medium would, between 0 and 1, hourglass stiffness stays whole, and there is no plastic
    /// strain.
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
        RemainingStiffness {
            undamaged: share,
            of_path: one,
            flowed: [zero; 6],
        }
    }
    /// Whether the work that [`energy`](Self::energy) does not tell of is with relaxation
    /// mechanisms, which hold some of it and dissipate the rest.
    fn relaxes(&self) -> bool {
        false
    }
    /// Accepts or refuses elements of a width along the normal of a crack (m), before a run. All are
    /// accepted by default. Engines ask for the greatest and the least width of all directions
    /// ([`Extents::principal`]) of every element; a law that accepts both accepts all between.
    ///
    /// # Errors
    /// Why, with the widths that are permitted.
    fn accept_size(&self, _size: f64) -> Result<(), ModelError> {
        Ok(())
    }
    /// Total stresses, initial stress included, that are surely elastic as long as the history is
    /// zero: engines then take [`Stress::elastic`] of [`medium`](Self::medium) and do not ask. There
    /// the law must give these very bits and leave its history zero. Not known by default.
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        None
    }
    /// The tangent `d stress / d strain` (Pa, 6 x 6, rows of stress) at a point, if the law offers
    /// one.
    fn tangent(&self, _input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        None
    }
}

/// The change of stress of one point in double precision, [`ConstitutiveLaw::stress_change`].
///
/// Laws are inlined where they are asked; this is a copy of a law's code that all may share who ask
/// for single points.
#[inline(never)]
pub fn point_stress_change<M: ConstitutiveLaw>(
    law: &M,
    input: &LawInput<f64>,
    new_history: &mut [f64],
) -> Stress {
    law.stress_change(input, new_history)
}

/// The energy of one point in double precision, [`ConstitutiveLaw::energy`], shared as
/// [`point_stress_change`] is.
#[inline(never)]
pub fn point_energy<M: ConstitutiveLaw>(
    law: &M,
    input: &LawInput<f64>,
    new_history: &[f64],
) -> Option<LawEnergy<f64>> {
    law.energy(input, new_history)
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
    fn history(&self) -> &[HistoryVariable];
    /// As [`ConstitutiveLaw::stress_change`].
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress;
    /// As [`ConstitutiveLaw::energy`].
    fn energy(&self, _input: &LawInput<f64>, _new_history: &[f64]) -> Option<LawEnergy<f64>> {
        None
    }
    /// As [`ConstitutiveLaw::accept_size`].
    ///
    /// # Errors
    /// Why the width is refused.
    fn accept_size(&self, _size: f64) -> Result<(), ModelError> {
        Ok(())
    }
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
    fn history(&self) -> &[HistoryVariable] {
        self.0.history()
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

/// More than any lane is wide.
const MOST_LANES: usize = 64;

/// Shows one lane of an input.
fn at_lane<L: Lane, T>(
    input: &LawInput<L>,
    lane: usize,
    look: impl FnOnce(&LawInput<f64>) -> T,
) -> T {
    let old: Vec<f64> = input.history.iter().map(|h| h.extract(lane)).collect();
    look(&LawInput {
        strain: Strain(input.strain.0.map(|x| x.extract(lane))),
        initial: Stress(input.initial.0.map(|x| x.extract(lane))),
        history: &old,
        extents: Extents(input.extents.0.map(|x| x.extract(lane))),
    })
}
